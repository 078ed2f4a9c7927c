"""The loop that is composed of what a Model needs: closed forms, and what may be left out."""

from itertools import pairwise

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from solutions.checks import BadInput, Diverged
from solutions.given import parts as given_parts
from solutions.given.compose import Part, Settings, compose, run_parts, state_of
from solutions.support.model import (
    WORLD,
    Ball,
    BallJoint,
    Body,
    Box,
    Capsule,
    Distance,
    Drag,
    Force,
    HalfSpace,
    Hinge,
    Polygon,
    Spring,
    Weld,
    make_model,
    model_energy,
    picture_of,
    start_of,
)
from solutions.support.shapes import polygon_centre

G = 9.81                                       # [m/s²]
DOWN = (0.0, -G)
FLOOR = Body((0.0, 0.0), shape=HalfSpace((0.0, 1.0)), mu=1.0, e=1.0)


def names(model):
    return [part.step.__name__ for part in compose(model).parts]


def run(model, T, steps, **settings):
    """Return the State of all bodies after T [s]."""
    loop = compose(model, Settings(**settings))
    return state_of(loop, run_parts(loop, 0.0, loop.state, T / steps, steps))


def energy(model, s):
    """Return the energy of motion and of height [J] of all bodies that can move."""
    total = 0.0
    for body, x, v, omega in zip(model.bodies, s.x, s.v, s.omega, strict=True):
        if np.isfinite(body.m):
            total += body.m * (0.5 * v @ v - np.dot(model.gravity, x))
            total += 0.5 * body.inertia * omega**2 if np.isfinite(body.inertia) else 0.0
    return total


# ---------------------------------------------------------------------------------------------- what is needed

def test_the_parts_are_those_that_the_model_needs_and_each_has_a_reason():
    ball, box = Body((0.0, 2.0), 1.0, Ball(0.5)), Body((0.0, 2.0), 1.0, Box((0.5, 0.5)), mu=0.5)
    assert names(make_model([ball._replace(shape=None)], (0.0, 0.0))) == ["move"]
    assert names(make_model([ball._replace(shape=None)], DOWN)) == ["accelerate", "move"]
    assert names(make_model([ball._replace(omega=1.0)], DOWN)) == ["accelerate", "move_and_turn"]
    assert names(make_model([ball, FLOOR], DOWN)) == ["accelerate", "detect_few", "separate",
                                                  "contact_impulses_of_centres", "move"]
    assert names(make_model([box, FLOOR], DOWN))[1:] == ["detect_few", "separate", "contact_impulses", "move_and_turn"]
    two = [box, box._replace(x=(3.0, 2.0), mu=0.1), FLOOR]
    assert names(make_model(two, DOWN))[3] == "contact_impulses_of_pairs"
    hinge = [Hinge(0, WORLD, (0.5, 2.5))]
    assert names(make_model([box], DOWN, hinge)) == [
        "accelerate_half", "close", "move_and_turn", "accelerate_rest", "hold"]
    assert names(make_model([box, FLOOR], DOWN, hinge))[3] == "contact_impulses_with_joints"
    many = [box._replace(x=(3.0 * k, 2.0)) for k in range(9)]
    assert names(make_model([*many, FLOOR], DOWN))[1] == "detect_many"
    assert all(part.why for part in compose(make_model(two, DOWN)).parts)


BOUNCING = make_model([Body((0.0, 0.9), 1.0, Ball(0.5), e=0.5, v=(1.0, 0.0)), FLOOR], DOWN)
TIPPING = make_model([Body((0.0, 0.9), 1.0, Box((0.5, 0.3)), mu=0.5, q=0.3), FLOOR], DOWN)


@pytest.mark.parametrize(("model", "left_out", "fuller"), [
    (BOUNCING, "contact_impulses_of_centres", "contact_impulses"),
    (BOUNCING, "move", "move_and_turn"),
    (TIPPING, "contact_impulses", "contact_impulses_of_pairs"),
    (TIPPING, "detect_few", "detect_many"),
    (TIPPING, "separate", "leave"),
    (TIPPING, "contact_impulses_of_pairs", "contact_impulses_with_joints"),
], ids=lambda value: value if isinstance(value, str) else "model")
def test_what_is_left_out_changes_no_motion(model, left_out, fuller):
    """A part in its fuller form gives the same motion to round-off."""
    loop = compose(model)
    steps = [part.step.__name__ for part in loop.parts]
    if left_out not in steps:                                          # the fuller one of one pair begins another pair
        steps[steps.index("contact_impulses")] = left_out
    fuller_steps = [fuller if name == left_out else name for name in steps]
    ends = []
    for chosen in (steps, fuller_steps):
        made = loop._replace(parts=tuple(Part(getattr(given_parts, name), "") for name in chosen))
        ends.append(run_parts(made, 0.0, loop.state, 1e-3, 600))
    assert np.max(np.abs(ends[0].x - ends[1].x)) < 1e-11
    assert np.max(np.abs(ends[0].q - ends[1].q)) < 1e-11


# ---------------------------------------------------------------------------------------------- closed forms

def test_a_throw_with_drag_has_its_exponential():
    k, m, T = 0.5, 2.0, 1.5
    model = make_model([Body((0.0, 0.0), m, v=(3.0, 4.0))], DOWN, loads=[Drag(k)])
    errors = []
    for steps in (200, 400):
        x = run(model, T, steps).x[0]
        tau = m / k
        decay = 1.0 - np.exp(-T / tau)
        errors.append(np.abs(x - (3.0 * tau * decay, (4.0 + G * tau) * tau * decay - G * tau * T)).max())
    assert errors[1] < 0.5 * T / 400 * G * T * 1.1                     # symplectic Euler falls ½ dt g T too far
    assert errors[0] / errors[1] == pytest.approx(2.0, abs=0.1)        # first order


def test_a_block_slides_down_a_slope_by_half_a_t_squared():
    alpha, mu, T, steps = 0.5, 0.3, 1.0, 500
    gravity = (G * np.sin(alpha), -G * np.cos(alpha))
    model = make_model([FLOOR, Body((0.0, 0.1), 1.0, Box((1.0, 0.1)), mu=mu)], gravity)
    a = G * (np.sin(alpha) - mu * np.cos(alpha))
    s = run(model, T, steps)
    assert s.x[1, 0] == pytest.approx(0.5 * a * T * (T + T / steps), rel=1e-6)       # symplectic Euler's own end
    assert s.x[1, 1] == pytest.approx(0.1, abs=1e-6)
    assert s.q[1] == pytest.approx(0.0, abs=1e-6)


def test_each_body_has_its_own_friction():
    v, mus, steps = 2.0, (0.1, 0.4, 0.8), 1000
    bodies = [Body((3.0 * k, 0.2), 1.0, Box((1.0, 0.2)), mu=mu, v=(v, 0.0)) for k, mu in enumerate(mus)]
    bodies = [body._replace(x=(10.0 * k, 0.2)) for k, body in enumerate(bodies)]
    s = run(make_model([*bodies, FLOOR], DOWN), 3.0, steps, settled=1e-9, sweeps=500)
    for k, mu in enumerate(mus):
        slid = s.x[k, 0] - 10.0 * k
        assert slid == pytest.approx(v * v / (2.0 * mu * G), abs=v * 3.0 / steps)    # it stops within a step


@pytest.mark.parametrize("e", [0.0, 0.5, 1.0])
def test_each_body_has_its_own_restitution(e):
    """Two discs meet with an offset: momentum along the line of centres, Newton's e, and what is across stays."""
    m, v, offset = (1.0, 3.0), np.array([(2.0, 0.0), (-1.0, 0.3)]), 0.3
    n = np.array([-np.sqrt(1.0 - offset**2), -offset])                 # from b to a at contact: radii of ½
    x = np.array([(-1.0, 0.0), (0.0, 0.0)])
    meet = x[0] + 0.4 * v[0]
    x[1] = meet - n - 0.4 * v[1]                                       # they touch after 0.4 s
    bodies = [Body(tuple(x[k]), m[k], Ball(0.5), e=(e, 1.0)[k], v=tuple(v[k])) for k in (0, 1)]
    s = run(make_model(bodies, (0.0, 0.0)), 0.8, 3200)
    reduced = 1.0 / (1.0 / m[0] + 1.0 / m[1])
    J = -(1.0 + e) * reduced * ((v[0] - v[1]) @ n)
    expected = np.array([v[0] + J / m[0] * n, v[1] - J / m[1] * n])
    assert s.v == pytest.approx(expected, abs=5e-3)                    # the normal turns within the last step


def heights(d, e, dt, T):
    """Return (times, heights (steps,)) [m] of a ball that falls by 1 m and bounces, after each step until T [s]."""
    up = np.array((*(0.0,) * (d - 1), 1.0))
    floor = Body((0.0,) * d, shape=HalfSpace(tuple(up)), e=1.0)
    loop = compose(make_model([Body(tuple(1.5 * up), 1.0, Ball(0.5), e=e), floor], tuple(-G * up)))
    state, found, steps = loop.state, [], round(T / dt)
    for _ in range(steps):
        state = run_parts(loop, 0.0, state, dt, 1)
        found.append(state.x[0, -1] - 0.5)
    return dt * np.arange(1, steps + 1), np.array(found)


@pytest.mark.parametrize("d", [2, 3])
@pytest.mark.parametrize("dt", [0.01, 1 / 240])
def test_an_elastic_ball_neither_climbs_nor_sinks(d, dt):
    """E − ½ g dt v is kept in flight and in an impact, and v is 0 at the top, or within g dt of it."""
    times, height = heights(d, 1.0, dt, 20.0)
    off = 0.5 * dt * np.sqrt(2.0 * G) + 0.5 * G * dt * dt
    for begin in range(0, 20, 2):
        assert np.max(height[(times > begin) & (times <= begin + 2.0)]) == pytest.approx(1.0, abs=off)


@pytest.mark.parametrize(("d", "e"), [(2, 0.9), (2, 0.7), (3, 0.7), (2, 0.5)])
def test_a_ball_that_bounces_comes_to_rest_after_the_time_of_its_geometric_series(d, e):
    """√(2 h/g) (1 + 2 e + 2 e² + …) = √(2 h/g) (1 + e)/(1 − e); flights of a few steps are off by a step each."""
    dt, fall = 1 / 240, np.sqrt(2.0 / G)
    end = fall * (1.0 + e) / (1.0 - e)
    times, height = heights(d, e, dt, 1.4 * end)
    first = (times > fall + dt) & (times < fall * (1.0 + 2.0 * e))
    assert np.max(height[first]) == pytest.approx(e * e, abs=0.5 * dt * np.sqrt(2.0 * G))
    late = height[times > 1.1 * end]
    assert np.ptp(late) < 1e-6 and abs(late[0]) < 1e-3                         # it may rest within the slop


@pytest.mark.parametrize("d", [2, 3])
@pytest.mark.parametrize("dt", [1 / 60, 1 / 240])
def test_balls_that_fall_meet_as_without_gravity_however_slowly(d, dt):
    """The principle of equivalence.  They meet with 5 cm/s, and gravity adds 4 or 16 cm/s in a step, to both alike."""
    rest, balls = (0.0,) * (d - 1), []
    for x, v, e in ((-0.2, 0.03, 1.0), (0.2, -0.02, 0.5)):
        balls.append(Body((x, *rest), 1.0, Ball(0.1), e=e, v=(v, *rest)))
    for g in (0.0, 9.81):
        s = run(make_model(balls, (*rest, -g)), 10.0, round(10.0 / dt))
        assert s.v[:, 0] == pytest.approx([0.5 * (0.01 - 0.025), 0.5 * (0.01 + 0.025)], abs=1e-12)


@pytest.mark.parametrize("gap", [5e-3, 1e-3])
@pytest.mark.parametrize("dt", [0.01, 0.002])
def test_balls_in_a_row_with_gaps_hand_the_velocity_on(gap, dt):
    """One impact after the other, of equal masses with e = 1: the last ball takes all of it."""
    ball = Body((0.0, 0.0), 1.0, Ball(0.1), e=1.0)
    row = [ball._replace(v=(1.0, 0.0)), *(ball._replace(x=(0.1 + k * (0.2 + gap), 0.0)) for k in (1, 2, 3))]
    np.testing.assert_allclose(run(make_model(row, (0.0, 0.0)), 0.6, round(0.6 / dt)).v[:, 0], [0, 0, 0, 1], atol=1e-9)


def test_two_balls_one_above_the_other_bounce_off_the_floor_one_after_the_other():
    """3 kg at −1 m/s comes back with 1 m/s and meets 1 kg at −1 m/s: then they have 0 and 2 m/s."""
    balls = [Body((0.0, 0.3), 3.0, Ball(0.1), e=1.0, v=(0.0, -1.0)),
             Body((0.0, 0.505), 1.0, Ball(0.1), e=1.0, v=(0.0, -1.0))]
    np.testing.assert_allclose(run(make_model([*balls, FLOOR], (0.0, 0.0)), 0.5, 50).v[:2, 1], [0.0, 2.0], atol=1e-9)


@pytest.mark.parametrize("press", [0.0, 400.0, 10_000.0])
def test_a_ball_bounces_off_a_table_however_hard_a_force_presses_that_down(press):
    table = Body((0.0, 0.5), 1.0, Box((1.0, 0.5)), mu=0.3, e=1.0)
    ball, down = Body((0.0, 1.6), 1.0, Ball(0.1), e=0.5), lambda t: (0.0, -press)
    model = make_model([FLOOR._replace(e=0.0), table, ball], DOWN, loads=[Force(1, down, "t")])
    loop = compose(model)
    state, fastest = loop.state, 0.0
    for _ in range(200):
        state = run_parts(loop, 0.0, state, 0.002, 1)
        fastest = max(fastest, state_of(loop, state).v[2, 1])
    assert fastest == pytest.approx(0.5 * np.sqrt(2.0 * G * 0.5), abs=0.02)


@pytest.mark.parametrize("press", [0.0, 1e5])
def test_what_does_not_touch_a_body_does_not_change_its_impact(press):
    """A ball that is pressed on the floor 10 m away had ended the sweeps early: a plank that falls flat turned."""
    plank, ball = Body((0.0, 1.0), 1.0, Box((0.5, 0.1)), mu=0.3, e=0.5), Body((10.0, 0.5), 1.0, Ball(0.5))
    model = make_model([FLOOR, plank, ball], DOWN, loads=[Force(2, lambda t: (0.0, -press), "t")])
    assert abs(run(model, 0.6, 60).omega[1]) < 2e-3


def pressed_by(push, d):
    """Return a bouncy block that a load or a spring presses against a rough wall with 50 N."""
    force = (-50.0, *(0.0,) * (d - 1))
    if push == "load":
        return {"loads": [Force(0, lambda t: force, "t")]}
    away = (2.0, *(0.0,) * (d - 1))
    return {"springs": [Spring(0, WORLD, (0.0,) * d, away, rest=2.5, k=50.0)]}


@pytest.mark.parametrize(("push", "d"), [("load", 2), ("load", 3), ("spring", 2), ("spring", 3)])
@pytest.mark.parametrize("dt", [1 / 60, 1 / 240])
def test_a_block_that_is_pressed_on_a_wall_does_not_bounce_and_stays_there(push, d, dt):
    """Friction holds up to 50 N, the block weighs 9.81 N, and a body at rest has no speed that it could leave with."""
    across = (1.0, *(0.0,) * (d - 1))
    block, wall = Body(0.5 * np.array(across), 1.0, Box((0.5,) * d), mu=1.0, e=0.9), HalfSpace(across)
    down = (*(0.0,) * (d - 1), -G)
    s = run(make_model([block, Body((0.0,) * d, shape=wall, mu=1.0, e=1.0)], down, **pressed_by(push, d)), 1.0,
            round(1.0 / dt))
    np.testing.assert_allclose(s.x[0], block.x, atol=5e-6 * (240.0 * dt) ** 2)
    np.testing.assert_allclose(s.v[0], 0.0, atol=1e-3)


@pytest.mark.parametrize("e", [0.5, 0.9])
def test_a_lever_that_a_joint_presses_on_a_peg_does_not_bounce(e):
    """The peg is under the lever's left end, and a weight hangs on a rod nearer to the hinge: nothing can move.

    Without the peg, the weight would throw the end of the lever down with 25 m/s².
    """
    lever, peg = Body((0.0, 0.0), 1.0, Box((1.0, 0.1)), e=e), Body((-0.9, -0.3), shape=Ball(0.2), e=1.0)
    weight = Body((-0.3, -1.0), 20.0)
    joints = [Hinge(0, WORLD, (0.0, 0.0)), Distance(2, 0, (0.0, 0.0), (-0.3, -0.1))]
    s = run(make_model([lever, peg, weight], DOWN, joints), 0.125, 30)
    np.testing.assert_allclose((s.q[0], s.omega[0]), 0.0, atol=8e-4)


def test_a_ball_that_a_spring_throws_on_a_wall_bounces_with_its_restitution():
    """The spring is slack when the ball touches the wall: it leaves with e times its speed."""
    ball, wall = Body((1.0, 0.0), 1.0, Ball(0.5), e=0.5), Body((0.0, 0.0), shape=HalfSpace((1.0, 0.0)), e=1.0)
    spring = Spring(0, WORLD, (0.0, 0.0), (-1.0, 0.0), rest=1.5, k=100.0)
    s = run(make_model([ball, wall], (0.0, 0.0), springs=[spring]), np.pi / 20.0 + 0.01, 4000)
    assert s.v[0, 0] == pytest.approx(0.5 * 5.0 * np.cos(0.1), rel=2e-3)         # it comes with ω · 0.5 m = 5 m/s


@pytest.mark.parametrize("d", [2, 3])
@pytest.mark.parametrize("dt", [1e-2, 1e-4])
def test_elastic_balls_in_a_row_of_which_two_part_keep_energy_and_momentum(d, dt):
    """A contact that parts may come back at its speed when the next impact turns it round (Moreau); stopped there, it
    would gain 13 % of the energy.  1e-5 is what the sweeps leave.
    """
    still = (0.0,) * (d - 1)
    balls = [Body((x, *still), 1.0, Ball(0.5), e=1.0, v=(v, *still)) for x, v in ((0.0, -1.0), (1.0, 0.0), (2.0, -3.0))]
    model = make_model(balls, (0.0,) * d)
    for steps in (1, 2, 6):
        s = run(model, steps * dt, steps)
        assert np.sum(s.v[:, 0]) == pytest.approx(-4.0, abs=1e-12)
        assert model_energy(model, s) == pytest.approx(5.0, rel=1e-5)
    assert np.all(np.diff(s.v[:, 0]) > -1e-4)


@pytest.mark.parametrize("d", [2, 3])
def test_an_oblique_elastic_impact_without_friction_keeps_the_energy_and_turns_nothing(d):
    """The bodies still overlap in the step after it, with another normal; the impulse that is kept must not rub."""
    still, along = (0.0,) * d, np.eye(d)[0]
    bodies = [Body(still, 1.0, Ball(0.5), e=1.0, v=tuple(2.0 * along + 0.1 * np.eye(d)[1])),
              Body(tuple(1.05 * along + 0.3 * np.eye(d)[1]), 2.0, Ball(0.5), e=1.0, v=tuple(-0.3 * along))]
    model = make_model(bodies, still)
    s, before = run(model, 0.2, 48), model_energy(model, start_of(model))
    assert np.abs(s.v[0] - bodies[0].v).max() > 1.0                    # they did meet
    assert model_energy(model, s) == pytest.approx(before, rel=1e-13)
    assert np.abs(s.omega).max() < 1e-13


@pytest.mark.parametrize("shape", [
    Box((0.4, 0.2)), Ball(0.3), Capsule(0.4, 0.2),
    Polygon(tuple(map(tuple, np.array([(0.5, -0.3), (0.2, 0.4), (-0.5, -0.3)]) - polygon_centre(
        [(0.5, -0.3), (0.2, 0.4), (-0.5, -0.3)]))))])
def test_a_body_of_any_shape_comes_to_rest_on_a_box_that_rests_on_the_floor(shape):
    model = make_model([FLOOR, Body((0.0, 0.5), 5.0, Box((1.0, 0.5)), mu=0.7), Body((0.1, 2.0), 1.0, shape, mu=0.7)],
                       DOWN)
    loop = compose(model)
    end = run_parts(loop, 0.0, loop.state, 1.0 / 240.0, 960)
    s = state_of(loop, end)
    assert np.max(np.abs(s.v)) < 1e-3
    assert s.x[1] == pytest.approx((0.0, 0.5), abs=5e-3)
    assert 1.0 < s.x[2, 1] < 1.6
    weight = sum(J[1] for b, J in zip(end.contacts.b, end.J, strict=True) if b == 2) * 240.0
    assert weight == pytest.approx(6.0 * G, rel=2e-2)                  # the floor carries both


def test_a_body_on_a_spring_swings_with_its_own_frequency():
    k, m, T = 30.0, 2.0, 1.3
    model = make_model([Body((1.2, 0.0), m)], (0.0, 0.0), springs=[Spring(0, WORLD, (0.0, 0.0), (0.0, 0.0), 1.0, k)])
    errors = [abs(run(model, T, steps).x[0, 0] - 1.0 - 0.2 * np.cos(np.sqrt(k / m) * T)) for steps in (400, 800)]
    assert errors[1] < 2e-3
    assert errors[0] / errors[1] == pytest.approx(2.0, abs=0.15)


def test_a_pendulum_of_a_rod_swings_as_its_equation_says_with_second_order():
    length, angle, T = 1.0, 1.0, 2.0
    at = 0.5 * length * np.array([np.sin(angle), -np.cos(angle)])
    model = make_model([Body(tuple(at), 1.0, inertia=length**2 / 12.0)], DOWN, [Hinge(0, WORLD, (0.0, 0.0))])
    truth = solve_ivp(lambda t, y: (y[1], -1.5 * G / length * np.sin(y[0])), (0.0, T), (angle, 0.0), rtol=1e-12,
                      atol=1e-12).y[0, -1]
    errors = []
    for steps in (200, 400):
        x = run(model, T, steps).x[0]
        errors.append(abs(np.arctan2(x[0], -x[1]) - truth))
        assert np.hypot(*x) == pytest.approx(0.5 * length, rel=1e-12)
    assert errors[0] / errors[1] == pytest.approx(4.0, rel=0.1)


def test_a_four_bar_stays_closed_and_keeps_its_energy():
    corners = np.array([(0.0, 0.0), (0.0, 1.0), (1.5, 1.3), (1.5, 0.0)])
    bars = [Body(tuple(0.5 * (a + b)), 1.0, q=float(np.arctan2(*(b - a)[::-1])),
                 inertia=float((b - a) @ (b - a)) / 12.0) for a, b in pairwise(corners)]
    ends = [(0, WORLD), (1, 0), (2, 1), (2, WORLD)]
    model = make_model(bars, DOWN, [Hinge(a, b, tuple(place)) for (a, b), place in zip(ends, corners, strict=True)])
    before, s = energy(model, state_of(compose(model), compose(model).state)), run(model, 1.0, 500)
    assert energy(model, s) == pytest.approx(before, abs=1e-3 * G)


def test_welded_bodies_fly_like_one_body():
    """Two boxes side by side are one box of twice the width: its spin and its centre are those of the whole."""
    half, omega = (0.5, 0.2), 3.0
    boxes = [Body((sign * 0.5, 0.0), 1.0, Box(half), v=(0.0, sign * 0.5 * omega), omega=omega) for sign in (-1.0, 1.0)]
    model = make_model(boxes, (0.0, 0.0), [Weld(0, 1, (0.0, 0.0))])
    s = run(model, 1.0, 400)
    assert s.omega == pytest.approx([omega, omega], rel=1e-9)
    assert s.q == pytest.approx([omega, omega], abs=omega**3 / 400**2)     # second order
    assert s.x[1] - s.x[0] == pytest.approx((np.cos(omega), np.sin(omega)), abs=1e-4)
    assert s.x.sum(axis=0) == pytest.approx((0.0, 0.0), abs=1e-12)


# ---------------------------------------------------------------------------------------------- overlaps

def test_bodies_that_begin_inside_each_other_part_without_kinetic_energy():
    """The worst that may remain is what the loop leaves on purpose, 0.5 % of the smallest body."""
    bodies = [FLOOR, Body((0.0, 0.4), 1.0, Box((0.5, 0.5)), mu=0.5), Body((0.2, 1.2), 1.0, Ball(0.5), mu=0.5),
              Body((0.5, 0.45), 1.0, Capsule(0.3, 0.2), mu=0.5)]
    model = make_model(bodies, (0.0, 0.0))                             # without gravity nothing else could move them
    loop, state, fastest = compose(model), None, 0.0
    state = loop.state
    for _ in range(400):
        state = run_parts(loop, 0.0, state, 1.0 / 240.0, 1)
        fastest = max(fastest, np.max(np.abs(state.v)), np.max(np.abs(state.omega)))
    assert fastest == 0.0
    assert state.contacts.gap.min() > -1.1 * loop.p.slop
    assert np.max(np.abs(loop.state.x - state.x)) > 0.05               # they did move


# ---------------------------------------------------------------------------------------------- refusals

ONE, AT = Body((0.0, 0.0), 1.0, Ball(0.5)), (0.0, 0.0)


def shift(t, x, q, v, omega):
    x += 1.0
    return 0.0 * x, omega


@pytest.mark.parametrize(("parts", "why"), [
    ({"gravity": 9.81}, "shape of gravity"), ({"gravity": [DOWN, DOWN]}, "shape of gravity"),
    ({"bodies": None}, "bodies is a NoneType: give a list"), ({"loads": None}, "loads is a NoneType"),
    ({"bodies": [ONE._replace(m=1e-310)]}, "mass m .* of body 0"),
    ({"bodies": [ONE._replace(inertia=1e-310)]}, "moment of inertia .* of body 0"),
    ({"bodies": [ONE._replace(shape=Ball(1e200))]}, "moment of inertia of the shape of body 0 .*smaller shape"),
    ({"bodies": [ONE._replace(shape=Ball(1e-200))]}, "moment of inertia of the shape of body 0 .*larger shape"),
    ({"bodies": [Body((0.0, 0.0, 0.0), 1.0, Capsule(0.5, 1e-200))], "gravity": (0.0, 0.0, -G)}, "larger shape"),
    ({"bodies": [ONE, FLOOR._replace(inertia=1.0)]}, "body 1 .*leave it out"),
    ({"bodies": [ONE._replace(omega=np.nan)]}, "angular velocity ω .* of body 0 is nan"),
    ({"bodies": [ONE, FLOOR._replace(v=(0.0, 1.0))]}, "surface of body 1 along its normal"),
    ({"bodies": [ONE, FLOOR._replace(omega=1.0)]}, "angular velocity of the surface of body 1"),
    ({"joints": [Distance(0, WORLD, AT, AT)]}, "length of joint 0"),
    ({"springs": [Spring(0, WORLD, AT, AT, 1.0, 2.0)]}, "length of spring 0"),
    ({"loads": [lambda t, x, q, v, omega: None]}, "load 0 is a function that fails at the start"),
    ({"loads": [lambda t, x: (x, t)]}, "load 0 is a function that fails at the start"),
    ({"loads": [lambda t, x, q, v, omega: (x / t, 1 // 0)]}, "load 0 is a function that fails at the start"),
    ({"loads": [Force(0, lambda t: (1.0 / t, 0.0), "t")]}, "the force of load 0 is a function that fails at the start"),
    ({"loads": [Force(0, lambda x: (0.0, 0.0), "xv")]}, "the force of load 0 is a function that fails at the start"),
    ({"loads": [lambda t, x, q, v, omega: (x[0], omega)]}, "shape of F .* of load 0"),
    ({"loads": [lambda t, x, q, v, omega: (x, 1.0)]}, "shape of tau .* of load 0"),
    ({"loads": [lambda t, x, q, v, omega: (x + np.nan, omega)]}, "F .* of load 0 is nan"),
    ({"loads": [shift]}, "changes the state"),
    ({"loads": [Force(0, lambda t: 1.0, "t")]}, "shape of the force of load 0"),
    ({"loads": [Force(0, lambda t: AT, np.zeros(2))]}, "what a Force depends on"),
    ({"loads": [Force(0, lambda t: (np.inf, 0.0), "t")]}, "force of load 0"),
], ids=lambda value: value if isinstance(value, str) else "")
def test_what_no_world_could_run_is_refused_where_it_is_made(parts, why):
    with pytest.raises(BadInput, match=why):
        make_model(**{"bodies": [ONE], "gravity": DOWN} | parts)


@pytest.mark.parametrize(("motion", "why"), [
    ({"v": (1.0, 0.0, 1.0)}, "along its normal"), ({"omega": (1.0, 0.0, 1.0)}, "angular velocity of the surface")])
def test_a_half_space_slides_and_turns_only_so_that_it_stays_where_it_is(motion, why):
    floor = Body((1.0, 2.0, 0.0), shape=HalfSpace((0.0, 0.0, 1.0)), v=(1.0, 2.0, 0.0), omega=(0.0, 0.0, 3.0))
    assert make_model([floor], (0.0, 0.0, -G)).bodies[0].omega == (0.0, 0.0, 3.0)
    with pytest.raises(BadInput, match=why):
        make_model([floor._replace(**motion)], (0.0, 0.0, -G))


@pytest.mark.parametrize("inertia", ["much", ((1.0, 2.0), 3.0), 1e-310, 10**400])
def test_moments_in_space_that_are_no_moments_are_refused(inertia):
    with pytest.raises(BadInput, match=r"moment of inertia .* of body 0"):
        make_model([Body((0.0, 0.0, 0.0), 1.0, inertia=inertia)], (0.0, 0.0, -G))


@pytest.mark.parametrize(("place", "down"), [((0.0, 0.0), DOWN), ((0.0, 0.0, 0.0), (0.0, 0.0, -9.81))])
def test_a_spring_without_a_rest_length_may_begin_with_no_length(place, down):
    """A weight hung on it where it is attached falls by g/ω² (1 − cos ωt)."""
    m, k = 2.0, 50.0
    model = make_model([Body(place, m)], down, springs=[Spring(0, WORLD, place, place, 0.0, k)])
    s, omega = run(model, 0.7, 7000), np.sqrt(k / m)
    fallen = 9.81 / omega**2 * (1.0 - np.cos(0.7 * omega))
    assert s.x[0] @ np.array(down) / 9.81 == pytest.approx(fallen, rel=4e-4)


@pytest.mark.parametrize("place", [(0.0, 0.0), (0.0, 0.0, 0.0)])
def test_a_spring_whose_ends_meet_on_their_way_is_refused(place):
    """With a rest length it has no direction there; it said before that the state was no number, or nothing."""
    right = np.eye(len(place))[0]
    model = make_model([Body(tuple(-0.5 * right), 1.0, v=tuple(right))], 0.0 * right,
                       springs=[Spring(0, WORLD, place, place, 1.0, 1e-300)])
    with pytest.raises(BadInput, match="keep its ends apart"):
        run(model, 1.0, 4)


@pytest.mark.parametrize("settings", [
    {"sweeps": 0}, {"settled": -1.0}, {"margin": -0.1}, {"margin": 0.0}, {"settled": np.nan}])
def test_settings_that_cannot_be_are_refused(settings):
    with pytest.raises(BadInput):
        compose(make_model([Body((0.0, 1.0), 1.0, Ball(0.5)), FLOOR], DOWN), Settings(**settings))


@pytest.mark.parametrize("settings", [None, {"sweeps": 10}, (10, 1e-3, None)])
def test_what_is_no_settings_is_told(settings):
    with pytest.raises(BadInput, match="the settings"):
        compose(make_model([Body((0.0, 1.0), 1.0)], DOWN), settings)


def test_a_state_that_is_not_of_the_loop_is_told():
    """The State that is shown has other rows than the loop works with."""
    loop, other = (compose(make_model([Body((float(k), 1.0), 1.0) for k in range(n)], DOWN)) for n in (1, 3))
    for state in (state_of(loop, loop.state), other.state, None):
        with pytest.raises(BadInput, match=r"the state is .*begin with loop\.state"):
            run_parts(loop, 0.0, state, 0.1, 1)


def test_what_is_no_model_and_no_loop_is_told():
    model = make_model([Body((0.0, 1.0), 1.0)], DOWN)
    for thing in (None, 3, model.bodies, compose(model)):
        with pytest.raises(BadInput, match="the model"):
            compose(thing)
    with pytest.raises(BadInput, match="the loop"):
        run_parts(model, 0.0, compose(model).state, 0.1, 1)


@pytest.mark.parametrize("later", [None, 1.0, (1.0,), np.zeros((3, 2))])
def test_a_load_that_stops_returning_a_pair_is_told(later):
    model = make_model([Body((0.0, 1.0), 1.0)], DOWN, loads=[lambda t, x, q, v, omega: later if t > 0.5 else (x, q)])
    with pytest.raises(BadInput, match="return the pair F, tau"):
        run(model, 1.0, 10)


@pytest.mark.parametrize("settings", [{"sweeps": 10.0}, {"sweeps": np.int64(10)}, {"settled": 1}])
def test_settings_may_be_numbers_of_another_kind(settings):
    assert np.isfinite(run(make_model([Body((0.0, 0.4), 1.0, Ball(0.5)), FLOOR], DOWN), 0.1, 10, **settings).x).all()


@pytest.mark.parametrize("dt", [0.0, -0.01, np.nan, np.inf, "a"])
def test_a_step_that_cannot_be_is_refused(dt):
    for loads in ([], [Drag(1.0)]):
        loop = compose(make_model([Body((0.0, 0.5), 1.0, Ball(0.5)), FLOOR], DOWN, loads=loads))
        with pytest.raises(BadInput, match="step dt"):
            run_parts(loop, 0.0, loop.state, dt, 10)


@pytest.mark.filterwarnings("ignore:overflow", "ignore:invalid value")
def test_a_run_whose_end_is_no_number_is_no_result():
    """A drag of one's own that is too strong for the step lets the speed grow by k dt/m − 1 per step."""
    drag = Force(0, lambda v: (-1000.0 * v[0], -1000.0 * v[1]), "v")
    with pytest.raises(Diverged, match="no longer finite"):
        run(make_model([Body((0.0, 0.0), 1.0, v=(1.0, 0.0))], (0.0, 0.0), loads=[drag]), 10.0, 1000)


def step_matrix(squared, damping, halved):
    """Return the matrix of a step of  x'' = −ω² x − γ x'  in units of dt, from our own kicks and moves."""
    columns = []
    for x, v in np.eye(2):
        kick = 0.5 if halved else 1.0
        v = v - kick * (squared * x + damping * v)
        x = x + v
        columns.append((x, v - kick * (squared * x + damping * v) if halved else v))
    return np.array(columns).T


@pytest.mark.parametrize("halved", [False, True])
@pytest.mark.parametrize("d", [2, 3])
@pytest.mark.parametrize(("k", "c"), [(400.0, 0.0), (100.0, 3.0), (0.0, 5.0)])
def test_a_step_is_refused_exactly_where_a_spring_makes_the_motion_grow(d, halved, k, c):
    """Two bodies on a spring: just below the limit they stay near each other, just above it they are refused.

    A third body on a joint, far away, lets the loop make half kicks.
    *Source:* eigenvalues of the matrix of a step, found anew by bisection.
    """
    zero, right = np.zeros(d), np.eye(d)[0]
    bodies, joints = [Body(tuple(zero), 1.0), Body(tuple(right), 2.0, v=tuple(0.1 * right))], []
    if halved:
        bodies += [Body(tuple(9.0 * right), 1.0, inertia=1.0 if d == 2 else (1.0,) * 3)]
        joints = [(Hinge if d == 2 else BallJoint)(2, WORLD, tuple(9.5 * right))]
    model = make_model(bodies, zero, joints, [Spring(0, 1, tuple(zero), tuple(zero), 0.9, k, c)])
    low, high = 0.0, 10.0
    while high - low > 1e-12:
        dt = 0.5 * (low + high)
        grows = np.max(np.abs(np.linalg.eigvals(step_matrix(1.5 * k * dt * dt, 1.5 * c * dt, halved)))) > 1.0 + 1e-12
        low, high = (low, dt) if grows else (dt, high)
    loop = compose(model)
    s = state_of(loop, run_parts(loop, 0.0, loop.state, 0.99 * low, 2000))
    assert np.abs((s.x[1] - s.x[0]) @ right) < 2.0 if k else np.abs((s.v[1] - s.v[0]) @ right) < 0.1
    with pytest.raises(BadInput, match="spring 0 makes the motion grow"):
        run_parts(loop, 0.0, loop.state, 1.01 * low, 1)


@pytest.mark.parametrize("d", [2, 3])
def test_a_step_is_refused_where_the_drag_makes_the_motion_grow(d):
    """v' = −k v/m: a step leaves (1 − k dt/m) of the velocity."""
    model = make_model([Body((0.0,) * d, 0.5, v=(1.0,) * d), Body((5.0,) * d, 2.0)], (0.0,) * d, loads=[Drag(3.0)])
    s = run(model, 0.33 * 1000, 1000)
    assert np.abs(s.v).max() < 1.0
    with pytest.raises(BadInput, match="the drag makes motions grow"):
        run(model, 0.34, 1)


def test_a_spring_on_a_body_that_a_joint_holds_is_not_refused():
    """The hinge takes what the spring pulls: the body cannot move along it."""
    model = make_model([Body((0.0, 0.0), 1.0, inertia=1.0)], DOWN, [Hinge(0, WORLD, (0.0, 0.0))],
                       [Spring(0, WORLD, (0.0, 0.0), (1.0, 0.0), 0.5, 1e6)])
    assert np.abs(run(model, 1.0, 100).x).max() < 1e-9


@pytest.mark.parametrize("later", [lambda x: x[0], lambda x: 1.0, lambda x: np.zeros((3, 2))])
def test_a_load_whose_answer_changes_its_shape_is_refused(later):
    """It answers as it should at the start."""
    model = make_model([Body((0.0, 0.0), 1.0), Body((1.0, 0.0), 1.0)], DOWN,
                       loads=[lambda t, x, q, v, omega: (later(x) if t > 0.05 else 0.0 * x, 0.0 * omega)])
    with pytest.raises(BadInput, match=r"shape of F .* of a load at t = 0\.06 s"):
        run(model, 0.1, 10)


def test_a_force_whose_answer_changes_its_shape_is_refused():
    model = make_model([Body((0.0, 0.0), 1.0)], DOWN, loads=[Force(0, lambda t: 1.0 if t > 0.05 else (1.0, 0.0), "t")])
    with pytest.raises(BadInput, match=r"shape of the force on body 0 at t = 0\.06 s"):
        run(model, 0.1, 10)


@pytest.mark.parametrize("d", [2, 3])
def test_a_heavy_box_rests_on_a_light_one(d):
    """Each sweep takes a 300th of what is left, so that a change of an impulse is small long before the end."""
    up = np.eye(d)[-1]
    boxes = [Body(tuple(height * up), m, Box((0.05,) * d), mu=0.5) for height, m in ((0.05, 1.0), (0.15, 300.0))]
    model = make_model([*boxes, Body((0.0,) * d, shape=HalfSpace(tuple(up)), mu=1.0, e=1.0)], -G * up)
    s = run(model, 0.15, 30)
    assert s.x == pytest.approx(start_of(model).x, abs=5e-3 * 0.05 * np.sqrt(d))     # the overlap that stays


@pytest.mark.parametrize("d", [2, 3])
def test_a_stack_on_a_belt_stands_as_on_a_floor(d):
    """A law of Galileo: all move alike, however far in a step, so the impulses of the step before are kept."""
    up, along = np.eye(d)[-1], np.eye(d)[0]
    still, carried = (run(make_model(
        [Body((0.0,) * d, shape=HalfSpace(tuple(up)), mu=1.0, e=1.0, v=tuple(v * along))]
        + [Body(tuple((0.5 + k) * up), 1.0, Box((0.5,) * d), mu=0.7, v=tuple(v * along)) for k in range(5)],
        -G * up), 0.1, 24) for v in (0.0, 64.0))
    assert carried.x - 0.1 * 64.0 * along == pytest.approx(still.x, abs=1e-6)
    assert carried.v - 64.0 * along == pytest.approx(still.v, abs=1e-6)


@pytest.mark.parametrize("sweeps", [20, 99, 100])
def test_a_rod_that_lands_aslant_with_much_friction_slips_as_coulomb_says(sweeps):
    """Its end stops along the normal, and slips on:  J_n = −u_n/(K_nn − μ K_nt),  J_t = −μ J_n.

    Plain sweeps would go to and fro between two impulses: the normal and the tangent undo each other in every visit.
    """
    mu, tilt, v = 3.0, 0.5, np.array((3.0, -2.0))
    rod = Body((0.0, 0.5 * np.sin(tilt) + 0.1 + 1e-9), 1.0, Capsule(0.5, 0.1), mu=mu, q=tilt, v=tuple(v))
    model = make_model([rod, FLOOR], (0.0, 0.0))
    inv_inertia, arm = 1.0 / model.bodies[0].inertia, np.array((-0.5 * np.cos(tilt), -0.5 * np.sin(tilt) - 0.1))
    lever_n, lever_t = arm[0], -arm[1]                                    # of an impulse along y and along x
    J_n = -v[1] / (1.0 + inv_inertia * lever_n * (lever_n - mu * lever_t))
    J = np.array((-mu * J_n, J_n))
    s = run(model, 1e-3, 1, sweeps=sweeps)
    assert v[0] + J[0] + inv_inertia * lever_t * (lever_n * J[1] + lever_t * J[0]) > 0.1          # it does slip on
    assert s.v[0] == pytest.approx(v + J, rel=1e-3)
    assert s.omega[0] == pytest.approx(inv_inertia * (lever_n * J[1] + lever_t * J[0]), rel=1e-3)


def test_a_heavy_disc_that_falls_on_a_light_one_stays_on_it():
    """Neither bounces; the light one lies on the floor."""
    discs = [Body((0.0, y), m, Ball(0.5), v=(0.0, v)) for y, m, v in ((0.5, 1.0, 0.0), (1.5, 1000.0, -5.0))]
    model = make_model([*discs, FLOOR], DOWN)
    s = run(model, 0.3, 60)
    assert s.x[:, 1] == pytest.approx([0.5, 1.5, 0.0], abs=5e-3)
    assert np.abs(s.v).max() < 5e-3


def test_contacts_that_sweeps_do_not_solve_are_no_result():
    """A body that a thrust at its corner spins 10⁸ times as easily as it moves has no use for ten thousand sweeps."""
    box = Body((0.0, 0.6), 1.0, Box((0.5, 0.5)), mu=0.5, q=0.3, inertia=1e-9)
    with pytest.raises(Diverged, match="more sweeps"):
        run(make_model([box, FLOOR], DOWN), 0.25, 60)


@pytest.mark.parametrize("shape", [Ball(0.5), Box((0.5, 0.5)), Capsule(0.3, 0.2)])
@pytest.mark.parametrize("across", [0.0, 9.81])
def test_a_body_without_room_between_a_piston_and_a_wall_is_no_result(shape, across):
    """The impulses that hold it grow from step to step, and change by an ever smaller share."""
    wall = Body((0.0, 0.0), shape=HalfSpace((-1.0, 0.0), 1.0), mu=1.0, e=1.0)
    piston = Body((-1.5, 0.0), shape=Box((0.5, 2.0)), mu=1.0, e=1.0, v=(1.0, 0.0))
    body = Body((0.0, 0.5), 1.0, shape, mu=0.5)
    with pytest.raises(Diverged, match="more room"):
        run(make_model([body, piston, wall, FLOOR], (0.0, -across)), 1.5, 180)


@pytest.mark.parametrize("d", [2, 3])
@pytest.mark.parametrize("shape", [Ball, Box, Capsule])
def test_a_body_that_has_no_room_between_two_walls_is_no_result(shape, d):
    """A push that parts it from one wall presses it into the other."""
    across = np.eye(d)[0]
    walls = [Body((0.0,) * d, shape=HalfSpace(tuple(side * across), 0.4)) for side in (1.0, -1.0)]
    solid = {Ball: Ball(0.5), Box: Box((0.5,) * d), Capsule: Capsule(0.3, 0.5)}[shape]
    with pytest.raises(Diverged, match="more room"):
        run(make_model([Body((0.0,) * d, 1.0, solid), *walls], (0.0,) * d), 0.5, 60)


@pytest.mark.parametrize("d", [2, 3])
def test_a_body_that_is_deep_in_one_wall_is_parted_from_it(d):
    across = np.eye(d)[0]
    model = make_model([Body((0.0,) * d, 1.0, Ball(0.5)), Body((0.0,) * d, shape=HalfSpace(tuple(across), -0.2))],
                       (0.0,) * d)
    s = run(model, 1.0, 120)
    assert s.x[0] @ across == pytest.approx(0.7, abs=5e-3)
    assert np.abs(s.v).max() < 1e-12


@pytest.mark.parametrize("rigid", [True, False])
def test_a_beam_on_a_hinge_is_turned_out_of_a_block_and_stays_at_rest(rigid):
    """Bodies that are parted keep their joints closed.  Once they opened, and closing them left a speed.

    The beam turns about its end until its lower edge lies on the left corner of the block, but for the slop of 1.1 mm.
    """
    beam, block = Body((0.5, 0.0), 1.0, Box((0.5, 0.05))), Body((0.8, -0.2), shape=Box((0.1, 0.2)))
    joints = [Hinge(0, WORLD, (0.0, 0.0))] if rigid else [Distance(0, WORLD, (-0.5, 0.0), (0.0, 1.0)),
                                                          Distance(0, WORLD, (-0.5, 0.0), (-1.0, 0.0))]
    model = make_model([beam, block], (0.0, 0.0), joints)
    s = run(model, 0.5, 100)
    assert np.abs(s.v).max() < 1e-12 and np.abs(s.omega).max() < 1e-12
    assert s.x[0] - 0.5 * np.array((np.cos(s.q[0]), np.sin(s.q[0]))) == pytest.approx((0.0, 0.0), abs=1e-9)
    lower = lambda x: np.tan(s.q[0]) * x - 0.05 / np.cos(s.q[0])           # the height of its lower edge
    assert lower(0.7) == pytest.approx(0.0, abs=1.2e-3)


def test_a_step_in_which_a_body_falls_past_all_parts_is_no_result():
    """Each part gains speed anew, so the most parts lead through little of such a step; the rest fell through."""
    with pytest.raises(Diverged, match="most parts"):
        run(make_model([Body((0.0, 0.7), 1.0, Box((0.5, 0.5)), mu=0.5, q=0.3), FLOOR], DOWN), 10.0, 1)


def test_no_friction_beside_an_infinite_one_is_no_friction():
    """A block without friction on a floor that prevents all slip slides as on ice; beside it another block sticks."""
    floor = FLOOR._replace(mu=np.inf)
    block = Body((0.0, 0.2), 1.0, Box((1.0, 0.2)), v=(1.0, 0.0))
    bodies = [floor, block, block._replace(x=(10.0, 0.2), mu=0.5)]
    s = run(make_model(bodies, DOWN), 0.5, 250)
    assert s.x[1, 0] == pytest.approx(0.5, abs=1e-9)
    assert s.v[2, 0] == pytest.approx(0.0, abs=1e-6)


def test_a_rod_without_a_shape_is_drawn_between_its_joints():
    rod = Body((1.5, 0.0), 1.0, inertia=0.1, q=0.3)
    model = make_model([rod, Body((2.0, 0.0), 1.0, Ball(0.1))], DOWN,
                       [Hinge(0, WORLD, (1.0, 0.0)), Hinge(1, 0, (2.0, 0.0))])
    points, links = picture_of(model, start_of(model))
    assert points[:2] == pytest.approx(np.array([(1.0, 0.0), (2.0, 0.0)]))
    assert links[0] == (0, 1)
    assert np.hypot(*(points[2:] - (2.0, 0.0)).T) == pytest.approx(0.1)
