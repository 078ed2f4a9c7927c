"""The composed loop in space: closed forms, balances on random machines, and what may be left out."""

from itertools import pairwise

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from solutions.given import simulator
from solutions.given.compose import Part, Settings, compose, run_parts, state_of
from solutions.simulator import momenta
from solutions.support.model import (
    WORLD,
    Ball,
    BallJoint,
    Body,
    Box,
    Capsule,
    Drag,
    HalfSpace,
    Hinge,
    Spring,
    Weld,
    make_model,
    model_energy,
    rotation_of,
    start_of,
)

G = 9.81                                       # [m/s²]
DOWN, NO_GRAVITY = (0.0, 0.0, -G), (0.0, 0.0, 0.0)
GROUND = Body((0.0, 0.0, 0.0), shape=HalfSpace((0.0, 0.0, 1.0)), mu=1.0, e=1.0)
SHAPES = Ball(0.3), Box((0.4, 0.3, 0.2)), Capsule(0.3, 0.2)


def names(model):
    return [part.step.__name__ for part in compose(model).parts]


def run(model, T, steps, **settings):
    """Return the State of all bodies after T [s]."""
    loop = compose(model, Settings(**settings))
    return state_of(loop, run_parts(loop, 0.0, loop.state, T / steps, steps))


def about(axis, angle):
    """Return the unit quaternion of a turn by an angle [rad] about an axis."""
    axis = np.array(axis) / np.linalg.norm(axis)
    return (np.cos(0.5 * angle), *(np.sin(0.5 * angle) * axis))


def total_momenta(model, s):
    """Return momentum and angular momentum of all bodies that can move."""
    loop = compose(model)
    free = np.isfinite([body.m for body in model.bodies])
    p = loop.p._replace(inv_mass=loop.p.inv_mass[loop.row][free], inv_inertia=loop.p.inv_inertia[loop.row][free])
    return momenta(s.x[free], s.q[free], s.v[free], s.omega[free], p)


# ---------------------------------------------------------------------------------------------- what is needed

def test_the_parts_are_those_that_the_model_needs_and_each_has_a_reason():
    ball, box = Body((0.0, 0.0, 2.0), 1.0, Ball(0.5)), Body((0.0, 0.0, 2.0), 1.0, Box((0.5, 0.5, 0.5)), mu=0.5)
    assert names(make_model([ball._replace(shape=None)], NO_GRAVITY)) == ["move"]
    assert names(make_model([ball._replace(omega=(0.0, 0.0, 1.0))], DOWN)) == [
        "accelerate_in_space", "move_and_turn_in_space"]
    assert names(make_model([ball, GROUND], DOWN)) == [
        "accelerate_in_space", "detect_few", "separate_in_space", "contact_impulses_of_centres_in_space", "move"]
    assert names(make_model([box, GROUND], DOWN))[3:] == ["contact_impulses_in_space", "move_and_turn_in_space"]
    joint = [BallJoint(0, WORLD, (0.5, 0.5, 2.5))]
    assert names(make_model([box], DOWN, joint)) == [
        "accelerate_half_in_space", "close_in_space", "move_and_turn_in_space", "accelerate_rest_in_space",
        "hold_in_space"]
    assert names(make_model([box, GROUND], DOWN, joint))[3] == "contact_impulses_with_joints_in_space"
    assert names(make_model([box._replace(x=(3.0 * k, 0.0, 2.0)) for k in range(9)], DOWN))[1] == "detect_many"
    assert all(part.why for part in compose(make_model([box, GROUND], DOWN)).parts)


@pytest.mark.parametrize(("left_out", "fuller"), [
    ("contact_impulses_of_centres_in_space", "contact_impulses_in_space"), ("move", "move_and_turn_in_space"),
    ("contact_impulses_of_centres_in_space", "contact_impulses_with_joints_in_space")])
def test_what_is_left_out_changes_no_motion(left_out, fuller):
    model = make_model([Body((0.0, 0.0, 0.7), 1.0, Ball(0.5), e=0.5, v=(1.0, 0.0, 0.0)), GROUND], DOWN)
    loop, ends = compose(model), []
    for chosen in (left_out, fuller):
        parts = [Part(getattr(simulator, chosen), "") if part.step.__name__ == left_out else part
                 for part in loop.parts]
        ends.append(run_parts(loop._replace(parts=tuple(parts)), 0.0, loop.state, 2e-3, 200))
    assert np.max(np.abs(ends[0].x - ends[1].x)) < 1e-12
    assert np.max(np.abs(ends[0].q - ends[1].q)) < 1e-12


# ---------------------------------------------------------------------------------------------- without contact

def test_a_throw_with_drag_has_its_exponential():
    k, m, T, v = 0.5, 2.0, 1.5, np.array([3.0, -1.0, 4.0])
    model, errors = make_model([Body((0.0, 0.0, 0.0), m, v=tuple(v))], DOWN, loads=[Drag(k)]), []
    for steps in (50, 100):
        rate = m / k
        decay = 1.0 - np.exp(-T / rate)
        end = (v - np.array(DOWN) * rate) * rate * decay + np.array(DOWN) * rate * T
        errors.append(np.max(np.abs(run(model, T, steps).x[0] - end)))
    assert errors[1] < 0.5 * T / 100 * G * T * 1.1                     # symplectic Euler falls ½ dt g T too far
    assert errors[0] / errors[1] == pytest.approx(2.0, abs=0.1)


def test_a_free_asymmetric_body_keeps_its_angular_momentum_and_nearly_its_energy():
    model = make_model([Body((0.0, 0.0, 0.0), 1.0, q=about((1.0, 2.0, 3.0), 0.7), inertia=(1.0, 2.0, 2.5),
                             omega=(0.2, 3.0, 0.4))], NO_GRAVITY)
    start = start_of(model)
    _, L = total_momenta(model, start)
    errors = []
    for steps in (100, 200):
        s = run(model, 2.0, steps)
        assert total_momenta(model, s)[1] == pytest.approx(L, abs=1e-12)
        errors.append(abs(model_energy(model, s) - model_energy(model, start)))
    assert errors[1] < 1e-3 * model_energy(model, start)
    assert errors[0] / errors[1] == pytest.approx(4.0, rel=0.3)        # second order


def test_a_spring_off_the_centre_moves_and_turns_a_body_as_newton_and_euler_say():
    """A spring and a damper between two bodies: momenta stay, and the energy falls by what the damper takes."""
    bodies = [Body((0.0, 0.0, 0.0), 1.0, inertia=(0.1, 0.2, 0.25)),
              Body((1.0, 0.3, -0.2), 2.0, inertia=(0.2, 0.3, 0.2), v=(0.1, 0.2, 0.3), omega=(1.0, 0.0, -1.0))]
    spring = Spring(0, 1, (0.1, 0.2, 0.0), (-0.1, 0.0, 0.2), 0.5, 30.0)
    for c, lost in ((0.0, False), (0.5, True)):
        model = make_model(bodies, NO_GRAVITY, springs=[spring._replace(c=c)])
        before, s = start_of(model), run(model, 1.0, 500)
        assert total_momenta(model, s)[0] == pytest.approx(total_momenta(model, before)[0], abs=1e-12)
        assert total_momenta(model, s)[1] == pytest.approx(total_momenta(model, before)[1], abs=5e-3)  # first order
        change = model_energy(model, s) - model_energy(model, before)
        assert change < -0.1 if lost else abs(change) < 5e-2


# ---------------------------------------------------------------------------------------------- contact

@pytest.mark.parametrize("e", [0.0, 0.5, 1.0])
def test_an_oblique_impact_of_two_balls_keeps_what_is_across(e):
    m, v, n = (1.0, 3.0), np.array([(2.0, 0.0, 0.1), (-1.0, 0.3, 0.0)]), np.array([-0.8, 0.36, 0.48])
    x = np.array([-0.4 * v[0], -n - 0.4 * v[1]])                       # they touch after 0.4 s
    bodies = [Body(tuple(x[k]), m[k], Ball(0.5), e=(e, 1.0)[k], v=tuple(v[k])) for k in (0, 1)]
    s = run(make_model(bodies, NO_GRAVITY), 0.8, 800)
    J = -(1.0 + e) / (1.0 / m[0] + 1.0 / m[1]) * ((v[0] - v[1]) @ n)
    assert s.v == pytest.approx(np.array([v[0] + J / m[0] * n, v[1] - J / m[1] * n]), abs=2e-2)
    assert s.v.T @ m == pytest.approx(v.T @ m, abs=1e-12)


def test_a_box_slides_down_a_plane_by_half_a_t_squared():
    alpha, mu, T, steps = 0.5, 0.3, 0.5, 100
    n, along = np.array([np.sin(alpha), 0.0, np.cos(alpha)]), np.array([np.cos(alpha), 0.0, -np.sin(alpha)])
    body = Body(tuple(0.1 * n), 1.0, Box((0.5, 0.4, 0.1)), mu=mu, q=about((0.0, 1.0, 0.0), alpha))
    s = run(make_model([body, GROUND._replace(shape=HalfSpace(tuple(n)))], DOWN), T, steps, settled=1e-9, sweeps=500)
    a = G * (np.sin(alpha) - mu * np.cos(alpha))
    assert s.x[0] @ along == pytest.approx(0.5 * a * T * (T + T / steps), rel=1e-6)  # symplectic Euler's own end
    assert s.x[0] @ n == pytest.approx(0.1, abs=1e-6)
    assert s.x[0, 1] == pytest.approx(0.0, abs=1e-6)


@pytest.mark.parametrize(("slope", "tips"), [(0.45, False), (0.55, True)])
def test_a_box_on_a_rough_plane_tips_where_its_weight_leaves_its_base(slope, tips):
    """Half as wide as high: it stands up to a slope of ½."""
    alpha = np.arctan(slope)
    n = np.array([np.sin(alpha), 0.0, np.cos(alpha)])
    body = Body(tuple(0.4 * n), 1.0, Box((0.2, 0.3, 0.4)), mu=2.0, q=about((0.0, 1.0, 0.0), alpha))
    s = run(make_model([body, GROUND._replace(shape=HalfSpace(tuple(n)))], DOWN), 0.6, 150, settled=1e-6, sweeps=300)
    leans = np.arccos(np.clip(rotation_of(s.q[0])[:, 2] @ n, -1.0, 1.0))
    assert leans > 0.03 if tips else leans < 1e-4


def test_a_ball_that_slides_rolls_in_the_end_with_five_sevenths_of_its_speed():
    R, mu, v = 0.2, 0.3, np.array([1.2, 0.9, 0.0])
    s = run(make_model([GROUND, Body((0.0, 0.0, R), 2.0, Ball(R), mu=mu, v=tuple(v))], DOWN), 0.4, 400)
    assert s.v[1] == pytest.approx(5.0 / 7.0 * v, abs=1e-9)
    assert s.omega[1] == pytest.approx(np.cross((0.0, 0.0, 1.0), 5.0 / 7.0 * v / R), abs=1e-8)
    stops = 2.0 / 7.0 * np.linalg.norm(v) / (mu * G)                   # the time for which it slides
    way = 5.0 / 7.0 * np.linalg.norm(v) * 0.4 + np.linalg.norm(v) / 7.0 * stops
    assert np.linalg.norm(s.x[1, :2]) == pytest.approx(way, abs=mu * G * stops * 1e-3)


def test_each_pair_has_its_own_friction():
    v, mus = 2.0, (0.0, 0.2, 0.8)
    bodies = [Body((3.0 * k, 0.0, 0.2), 1.0, Box((0.5, 0.5, 0.2)), mu=mu, v=(0.0, v, 0.0)) for k, mu in enumerate(mus)]
    s = run(make_model([*bodies, GROUND], DOWN), 0.3, 150, settled=1e-9, sweeps=500)
    for k, mu in enumerate(mus):
        stops = min(0.3, v / (mu * G) if mu else np.inf)
        assert s.x[k, 1] == pytest.approx(v * stops - 0.5 * mu * G * stops**2, abs=v * 2e-3)


def test_no_friction_beside_an_infinite_one_is_no_friction():
    """On a floor that prevents all slip a ball rolls at once; one without friction slides on."""
    balls = [Body((k, 0.0, 0.2), 1.0, Ball(0.2), mu=0.5 * k, v=(0.0, 1.4, 0.0)) for k in (0.0, 1.0)]
    s = run(make_model([*balls, GROUND._replace(mu=np.inf)], DOWN), 0.1, 50)
    assert s.v[:2, 1] == pytest.approx([1.4, 1.0], abs=1e-9)


@pytest.mark.parametrize("upper", SHAPES, ids=lambda shape: type(shape).__name__)
def test_a_body_of_any_shape_comes_to_rest_on_a_box_that_carries_both_weights(upper):
    model = make_model([GROUND, Body((0.0, 0.0, 0.3), 5.0, Box((1.0, 0.9, 0.3)), mu=0.7),
                        Body((0.1, 0.05, 0.95), 1.0, upper, mu=0.7)], DOWN)
    loop = compose(model)
    end = run_parts(loop, 0.0, loop.state, 1.0 / 240.0, 240)
    s = state_of(loop, end)
    assert np.max(np.abs(s.v)) < 1e-3
    assert s.x[1] == pytest.approx((0.0, 0.0, 0.3), abs=5e-3)
    height = upper.half[2] if isinstance(upper, Box) else upper.radius
    assert s.x[2, 2] == pytest.approx(0.6 + height, abs=5e-3)
    weight = sum(J[2] for b, J in zip(end.contacts.b, end.J, strict=True) if b == 2) * 240.0
    assert weight == pytest.approx(6.0 * G, rel=2e-2)


def test_bodies_that_begin_inside_each_other_part_without_kinetic_energy():
    bodies = [GROUND, Body((0.0, 0.0, 0.4), 1.0, Box((0.5, 0.5, 0.5)), mu=0.5),
              Body((0.2, 0.1, 1.2), 1.0, Ball(0.5), mu=0.5), Body((0.5, 0.1, 0.45), 1.0, Capsule(0.3, 0.2), mu=0.5)]
    loop = compose(make_model(bodies, NO_GRAVITY))
    state = loop.state
    for _ in range(150):
        state = run_parts(loop, 0.0, state, 1.0 / 240.0, 1)
        assert not np.any(state.v) and not np.any(state.omega)
    assert state.contacts.gap.min() > -1.1 * loop.p.slop
    assert np.max(np.abs(loop.state.x - state.x)) > 0.05               # they did move


# ---------------------------------------------------------------------------------------------- joints

def test_a_rod_on_a_hinge_swings_in_its_plane_with_second_order():
    e, out, half, T = np.array([0.6, 0.48, 0.64]), np.array([0.8, -0.36, -0.48]), 0.5, 1.0
    down = np.cross(e, out)                                            # gravity is across the axis
    body = Body(tuple(half * out), 1.0, inertia=(0.02, 0.08, 0.09), q=about(e, 0.3))
    model = make_model([body], tuple(G * down), [Hinge(0, WORLD, (0.0, 0.0, 0.0), tuple(e))])
    axis = rotation_of(np.array(model.bodies[0].q)).T @ e              # not a principal axis: the hinge takes a torque
    assert np.min(np.abs(axis)) > 0.2
    I = np.array(body.inertia) @ axis**2 + half**2
    truth = solve_ivp(lambda t, y: (y[1], -G * half / I * np.sin(y[0])), (0.0, T), (0.5 * np.pi, 0.0), rtol=1e-12,
                      atol=1e-12).y[0, -1]
    errors = []
    for steps in (30, 60):
        x = run(model, T, steps).x[0]
        errors.append(abs(np.arctan2(x @ out, x @ down) - truth))
        assert x @ e == pytest.approx(0.0, abs=1e-12)
        assert np.linalg.norm(x) == pytest.approx(half, rel=1e-12)
    assert errors[0] / errors[1] == pytest.approx(4.0, rel=0.1)


def test_welded_bodies_fly_like_one_body():
    """Two boxes side by side are one box of twice the length; it tumbles about no principal axis."""
    half, omega = (0.5, 0.2, 0.1), np.array([1.0, 2.0, 0.5])
    boxes = [Body((sign * 0.5, 0.0, 0.0), 1.0, Box(half), v=tuple(np.cross(omega, (sign * 0.5, 0.0, 0.0))),
                  omega=tuple(omega)) for sign in (-1.0, 1.0)]
    two = make_model(boxes, NO_GRAVITY, [Weld(0, 1, (0.0, 0.0, 0.0))])
    one = make_model([Body((0.0, 0.0, 0.0), 2.0, Box((1.0, 0.2, 0.1)), omega=tuple(omega))], NO_GRAVITY)
    s, whole = run(two, 0.5, 50), run(one, 0.5, 1000)
    assert s.x.sum(axis=0) == pytest.approx(np.zeros(3), abs=1e-12)
    assert s.x[1] - s.x[0] == pytest.approx(rotation_of(whole.q[0])[:, 0], abs=1e-3)
    assert s.q[0] == pytest.approx(s.q[1], abs=1e-9)
    assert total_momenta(two, s)[1] == pytest.approx(total_momenta(one, whole)[1], abs=1e-9)


def test_a_closed_loop_of_four_hinged_bars_keeps_its_energy():
    """Four hinges in space have 20 rows, of which 17 do not depend on the others."""
    corners = np.array([(0.0, 0.0, 0.0), (0.3, 0.0, 1.0), (1.5, 0.0, 1.3), (1.5, 0.0, 0.0)])
    bars = [Body(tuple(0.5 * (a + b)), 1.0, inertia=float((b - a) @ (b - a)) / 12.0)
            for a, b in pairwise(corners)]
    ends, axis = [(0, WORLD), (1, 0), (2, 1), (2, WORLD)], (0.0, 1.0, 0.0)
    model = make_model(bars, DOWN, [Hinge(a, b, tuple(c), axis) for (a, b), c in zip(ends, corners, strict=True)])
    s = run(model, 0.4, 40)
    assert model_energy(model, s) == pytest.approx(model_energy(model, start_of(model)), abs=5e-3 * G)
    assert np.max(np.abs(s.x[:, 1])) < 1e-9
    assert np.linalg.norm(s.v) > 1.0


# ---------------------------------------------------------------------------------------------- random machines

def machine(rng, gravity):
    """Return a Model of bodies of all shapes, some of them joined or on springs, that will meet."""
    bodies, axis = [], (0.6, 0.0, 0.8)
    for k in range(5):
        x = np.array([0.9 * k, 0.0, 0.0]) + rng.uniform(-0.1, 0.1, 3)
        bodies.append(Body(tuple(x), rng.uniform(0.5, 2.0), SHAPES[k % 3], mu=rng.uniform(0.2, 1.0),
                           e=rng.choice((0.0, 0.8)), q=about(rng.normal(size=3), rng.uniform(0.0, 3.0)),
                           v=tuple(np.array([2.0 - k, 0.0, 0.0]) + rng.uniform(-0.5, 0.5, 3)),
                           omega=tuple(rng.uniform(-2.0, 2.0, 3))))
    middle = tuple(0.5 * np.add(bodies[3].x, bodies[4].x))
    joint = rng.choice(3)
    joints = [(Hinge(3, 4, middle, axis), BallJoint(3, 4, middle), Weld(3, 4, middle))[joint]]
    return make_model(bodies, gravity, joints, [Spring(0, 2, (0.1, 0.0, 0.0), (0.0, 0.1, 0.0), 1.0, 20.0)])


@pytest.mark.parametrize("seed", [0, *(pytest.param(seed, marks=pytest.mark.long) for seed in (1, 2))])
def test_impacts_friction_and_joints_keep_both_momenta_and_gain_no_energy(seed):
    """Also where three bodies meet at once, and with friction: without outer forces both momenta are constant.

    Bodies that are moved out of each other take angular momentum with them, and a spring acts for a step along the line
    of its beginning: both err with the first order, and so does the energy.
    """
    model = machine(np.random.default_rng(seed), NO_GRAVITY)
    begin = start_of(model)
    loop = compose(model)
    P, L = total_momenta(model, begin)
    state, energies, touched = loop.state, [], 0
    for k in range(120):
        state = run_parts(loop, k * 4e-3, state, 4e-3, 1)
        touched += np.count_nonzero(state.J)
        energies.append(model_energy(model, state_of(loop, state)))
    s = state_of(loop, state)
    assert touched > 0
    assert total_momenta(model, s)[0] == pytest.approx(P, abs=1e-10)
    assert total_momenta(model, s)[1] == pytest.approx(L, abs=2e-2 * np.linalg.norm(L))
    gain = np.max(energies - np.minimum.accumulate(energies))
    assert gain < 2e-2 * model_energy(model, begin)


@pytest.mark.parametrize("omega", [100.0, 150.0, 314.16])
def test_a_rod_that_turns_by_a_radian_or_more_in_a_step_hits_what_is_in_its_way(omega):
    """A driven rod throws a ball with e = 1 at 0.9 m from its axis away with twice its speed, at every angle."""
    rod = Body((0.0, 0.0, 0.0), shape=Capsule(1.0, 0.01), mu=1.0, e=1.0, omega=(0.0, 0.0, omega))
    for angle in (0.2, 0.95, 1.2, 2.2):
        ball = Body((0.9 * np.cos(angle), 0.9 * np.sin(angle), 0.0), 1.0, Ball(0.03), e=1.0)
        steps = int(np.ceil(np.pi / omega / 0.01))
        v = run(make_model([rod, ball], (0.0, 0.0, 0.0)), 0.01 * steps, steps).v[1]
        assert np.linalg.norm(v) == pytest.approx(2.0 * 0.9 * omega, rel=5e-3), angle


def test_a_cube_that_falls_flat_does_not_drift():
    """By symmetry it stays over its place; sweeps visit one corner after the other, and end before they are exact."""
    floor = Body((0.0, 0.0, 0.0), shape=HalfSpace((0.0, 0.0, 1.0)), mu=1.0, e=1.0)
    cube = Body((0.0, 0.0, 1.5), 1.0, Box((0.3, 0.3, 0.3)), mu=0.5, e=0.5)
    assert np.max(np.abs(run(make_model([floor, cube], (0.0, 0.0, -G)), 2.0, 480).x[1, :2])) < 1e-3
