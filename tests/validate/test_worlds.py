"""A Model in every engine: truths, forces, refusals, and what the engines derive from it."""

from itertools import pairwise

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from solutions.checks import BadInput
from solutions.support.model import (
    WORLD,
    BallJoint,
    Body,
    Distance,
    Drag,
    Force,
    Hinge,
    Spring,
    Weld,
    can_move,
    make_model,
    own_place,
    start_of,
    touching_pairs,
    world_place,
)
from solutions.support.shapes import Ball, Box, Capsule, HalfSpace, Polygon, Polyhedron, size_of
from validate.engines.products import BOX2D, BUILDERS, MUJOCO, PYBULLET, PYMUNK, RAPIER
from validate.scene import by_order
from validate.subject import modules
from validate.worlds import chipmunk, derived, ours

G = 9.81                     # [m/s²]
SINGLE = 2e-6                # errors of an engine that computes in single precision: some ten spacings [-]
SOFT = 1e-3                  # most depth of a soft contact under these weights, of MuJoCo and of Box2D [m]
REDUCED = {"maximal": False}
KINDS = [(product, settings) for product in BUILDERS
         for settings in (({}, REDUCED) if product is PYBULLET else ({},))]
every = pytest.mark.parametrize(("product", "settings"), KINDS, ids=[f"{p}{'-reduced' if s else ''}" for p, s in KINDS])
FLOOR = Body((0.0, 0.0), shape=HalfSpace((0.0, 1.0)), mu=1.0, e=1.0)
GROUND = Body((0.0, 0.0, 0.0), shape=HalfSpace((0.0, 0.0, 1.0)), mu=1.0, e=1.0)
TRIANGLE = Polygon(((-0.3, -0.2), (0.3, -0.2), (0.0, 0.4)))
SQUARE = (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0)
SHAPES = (Ball(0.2), Box((0.3, 0.1)), Capsule(0.3, 0.1), TRIANGLE)


def square(half):
    """Make a Polygon."""
    return Polygon(tuple((half * x, half * y) for x, y in SQUARE))


def cube(half):
    """Make a Polyhedron."""
    return Polyhedron(tuple((half * x, half * y, z) for x, y in SQUARE for z in (-half, half)))


def run(product, model, T, steps, **settings):
    """Return the State at T and the pushes of the last step; skip what the engine does not have."""
    if not product.installed():
        pytest.skip(f"{product} is not installed: {product.remedy}")
    why = product.world.refuses(model)
    if why:
        pytest.skip(f"{product} refuses: {why}")
    world = product.world.build(model, T / steps, **settings)
    try:
        for _ in range(steps):
            world.step()
        return world.state(), world.pushes()
    finally:
        world.close()


def spacings(product, steps):
    """Round-off after this many steps [-]."""
    return steps * 1e-15 + (steps * SINGLE if product in (BOX2D, RAPIER) else 1e-12)


def order_of(product):
    """Order of an engine where nothing touches."""
    return 4 if product is MUJOCO else 1


# ---------------------------------------------------------------------------------------------- closed forms

@every
@pytest.mark.parametrize("dt", [0.0, -0.01, np.nan, np.inf, "a"])
def test_a_step_that_cannot_be_is_refused(product, settings, dt):
    """The engines give a state of NaN, go backwards, or stand still."""
    if not product.installed():
        pytest.skip(f"{product} is not installed: {product.remedy}")
    with pytest.raises(BadInput, match="step dt"):
        product.world.build(make_model([Body((0.0, 0.0), 1.0)], (0.0, -G)), dt, **settings)


@every
def test_what_is_no_model_is_told(product, settings):
    if not product.installed():
        pytest.skip(f"{product} is not installed: {product.remedy}")
    for thing in (None, [Body((0.0, 0.0), 1.0)]):
        with pytest.raises(BadInput, match="the model"):
            product.world.build(thing, 0.1, **settings)


@every
@pytest.mark.parametrize("d", [2, 3])
def test_a_thrown_body_errs_by_half_a_step_of_its_velocity_at_most(product, settings, d):
    T, steps, v = 1.0, 100, np.array((1.0, 2.0, 3.0)[3 - d:])
    down = np.eye(d)[-1] * -G
    state, _ = run(product, make_model([Body((0.0,) * d, 2.0, v=tuple(v))], tuple(down)), T, steps, **settings)
    allowed = 0.0 if product is MUJOCO else 0.5 * G * T * T / steps
    noise = spacings(product, steps) * 10.0
    assert np.max(np.abs(state.x[0] - (v * T + 0.5 * down * T * T))) <= allowed + noise
    assert np.max(np.abs(state.v[0] - (v + down * T))) <= noise


@pytest.mark.parametrize("product", [PYMUNK, PYBULLET, BOX2D, RAPIER], ids=str)
def test_a_leapfrog_start_makes_a_throw_exact(product):
    T, steps, v = 1.0, 100, np.array((2.0, 3.0))
    state, _ = run(product, make_model([Body((0.0, 0.0), 2.0, v=tuple(v))], (0.0, -G)), T, steps, ahead=0.5)
    assert np.max(np.abs(state.x[0] - (v * T - (0.0, 0.5 * G * T * T)))) <= spacings(product, steps) * 10.0


@every
def test_drag_and_a_function_load_slow_a_body_as_the_exponential_does(product, settings):
    T, steps, k, m = 1.0, 200, 0.8, 2.0

    def more(t, x, q, v, omega):
        return -k * v, 0.0 * omega
    for loads in ((Drag(2.0 * k),), (Drag(k), more)):
        model = make_model([Body((0.0, 0.0), m, v=(3.0, 1.0))], (0.0, 0.0), loads=loads)
        state, _ = run(product, model, T, steps, **settings)
        allowed = by_order(2.0 * k / m, T, T / steps)[order_of(product)] + spacings(product, steps)
        assert np.linalg.norm(state.v[0] - np.exp(-2.0 * k / m * T) * np.array((3.0, 1.0))) <= allowed * np.sqrt(10.0)


FORCES = {                   # on two kilograms that start at 1 m with 1 m/s, and where they are after t
    "t": (lambda t: 2.0 * np.cos(t), lambda t: 2.0 + t - np.cos(t)),
    "x": (lambda x: -8.0 * x[0], lambda t: np.cos(2.0 * t) + 0.5 * np.sin(2.0 * t)),
    "v": (lambda v: -2.0 * v[0], lambda t: 2.0 - np.exp(-t)),
    "xv": (lambda x, v: -2.0 * x[0] - 4.0 * v[0], lambda t: (1.0 + 2.0 * t) * np.exp(-t)),
    "r": (lambda r: 8.0 * (r[0] + 3.0), lambda t: np.cos(2.0 * t) + 0.5 * np.sin(2.0 * t)),
}


@every
@pytest.mark.parametrize("of", FORCES)
@pytest.mark.parametrize("d", [2, 3])
def test_a_force_of_floats_moves_its_body_as_the_closed_form_says(product, settings, of, d):
    """Also beside other bodies, and on one that could turn."""
    F, truth = FORCES[of]
    T, steps, zero = 1.0, 200, (0.0,) * (d - 1)
    still = np.zeros(d)
    for inertia in (None, 1.0 if d == 2 else (1.0, 2.0, 2.5)):
        bodies = [Body((-3.0, *zero)), Body((5.0, *zero), 1.0, inertia=inertia),
                  Body((1.0, *zero), 2.0, v=(1.0, *zero), inertia=inertia)]
        load = Force(2, lambda *now: (float(F(*now)), *zero), of, 0 if of == "r" else None)
        state, _ = run(product, make_model(bodies, still, loads=[load]), T, steps, **settings)
        allowed = by_order(2.0, T, T / steps)[order_of(product)] + 10.0 * spacings(product, steps)
        assert np.max(np.abs(state.x[2] - (truth(T), *zero))) <= 2.0 * allowed
        assert np.max(np.abs(state.x[1] - (5.0, *zero))) <= spacings(product, steps) * 10.0


@pytest.mark.parametrize("product", [PYMUNK, PYBULLET], ids=str)
def test_with_its_own_drag_an_engine_slows_a_body_exactly(product):
    T, steps, k, m = 1.0, 100, 0.8, 2.0
    model = make_model([Body((0.0, 0.0), m, v=(3.0, 1.0))], (0.0, 0.0), loads=[Drag(0.5 * k), Drag(0.5 * k)])
    state, _ = run(product, model, T, steps, own_drag=True)
    assert state.v[0] == pytest.approx(np.exp(-k / m * T) * np.array((3.0, 1.0)), rel=1e-12)


def test_a_leapfrog_start_of_links_in_pybullet_is_refused():
    if not PYBULLET.installed():
        pytest.skip(f"pybullet is not installed: {PYBULLET.remedy}")
    rod = make_model([Body((0.5, 0.0), 1.0, inertia=0.1)], (0.0, -9.81), [Hinge(0, WORLD, (0.0, 0.0))])
    with pytest.raises(BadInput, match="ahead"):
        PYBULLET.world.build(rod, 0.01, maximal=False, ahead=0.5)
    PYBULLET.world.build(rod, 0.01, ahead=0.5).close()


def test_the_drag_of_a_pymunk_space_is_refused_for_bodies_of_two_masses():
    bodies = [Body((0.0, 0.0), 1.0), Body((1.0, 0.0), 2.0)]
    with pytest.raises(BadInput, match="own_drag"):
        chipmunk.build(make_model(bodies, (0.0, 0.0), loads=[Drag(1.0)]), 0.01, own_drag=True)


@pytest.mark.parametrize(("force", "word"), [
    (Force(0, abs, "x"), "can move"), (Force(2, abs, "x"), "can move"), (Force(True, abs, "x"), "can move"),
    (Force(1, abs, "q"), "depends on"), (Force(1, 3.0, "x"), "F of a Force"),
    (Force(1, abs, "r"), "other body"), (Force(1, abs, "r", 1), "other body"), (Force(1, abs, "r", 2), "other body")])
def test_a_force_that_cannot_be_is_refused(force, word):
    with pytest.raises(BadInput, match=word):
        make_model([Body((0.0, 0.0)), Body((1.0, 0.0), 1.0)], (0.0, 0.0), loads=[force])


@every
@pytest.mark.parametrize("shape", [Box((0.5, 0.1)), Capsule(0.4, 0.1), Polygon(((-0.5, -0.1), (0.5, -0.1), (0.5, 0.1),
                                                                               (-0.5, 0.1)))])
def test_a_body_slides_down_an_incline_with_g_sin_minus_mu_g_cos(product, settings, shape):
    T, steps, theta, mu = 0.5, 500, 0.5, 0.3
    rho = np.array([np.sin(theta), -np.cos(theta)]) * G
    model = make_model([Body((0.0, 0.1), 1.0, shape, mu), FLOOR], tuple(rho))
    state, _ = run(product, model, T, steps, **settings)
    a = rho[0] + mu * rho[1]
    assert abs(state.x[0, 0] - 0.5 * a * T * T) <= 0.5 * a * T * T / steps + mu * SOFT + spacings(product, steps)
    assert abs(state.x[0, 1] - 0.1) <= SOFT and abs(state.q[0]) <= 2.0 * SOFT


@every
def test_friction_of_a_pair_is_the_product(product, settings):
    """While a block slides, also where it hops, friction gives μ times the normal impulse, m (g T + v_y)."""
    T, steps, v = 0.2, 400, 2.0
    for first, second in ((0.8, 0.5), (0.5, 0.8), (0.4, 1.0)):
        model = make_model([Body((0.0, 0.1), 1.0, Box((0.5, 0.1)), first, v=(v, 0.0)), FLOOR._replace(mu=second)],
                           (0.0, -G))
        state, _ = run(product, model, T, steps, **settings)
        assert state.v[0, 0] == pytest.approx(v - 0.4 * (G * T + state.v[0, 1]), abs=0.4 * G * T / steps)


def test_rapiers_friction_takes_a_crate_aside_that_is_pushed_askew():
    """By 4 mm on a way of 1 m.  The way aside does not shrink with the step, so it is a law of its own."""
    T, mu, push = 0.3, 0.3, np.array((25.0, 5.0, 0.0))
    model = make_model([GROUND, Body((0.0, 0.0, 0.1), 0.8, Box((0.2, 0.15, 0.1)), mu)], tuple(push - (0.0, 0.0, G)))
    along = push / np.linalg.norm(push)
    for steps in (150, 600):
        state, _ = run(RAPIER, model, T, steps)
        off = state.x[1] - (0.0, 0.0, 0.1) - 0.5 * T * T * (push - mu * G * along)
        assert abs(np.cross(along, off)[2]) == pytest.approx(4e-3, abs=4e-4)


@every
@pytest.mark.parametrize("d", [2, 3])
def test_a_ball_leaves_the_floor_with_e_times_its_speed(product, settings, d):
    e, h, T, steps = 0.6, 0.5, 0.5, 2000
    model = make_model([Body((0.0,) * (d - 1) + (0.1 + h,), 1.0, Ball(0.1), e=e), FLOOR if d == 2 else GROUND],
                       tuple(np.eye(d)[-1] * -G))
    state, _ = run(product, model, T, steps, **settings)
    fall, v = np.sqrt(2.0 * h / G), np.sqrt(2.0 * h * G)
    # it meets the floor up to dt late, with up to g dt more speed, and moves with one end's velocity in each step
    late = T / steps * ((1.0 + e) * v + G * (T - fall) + 0.5 * G * T)
    assert abs(state.x[0, -1] - (0.1 + e * v * (T - fall) - 0.5 * G * (T - fall) ** 2)) <= late
    assert abs(state.v[0, -1] - (e * v - G * (T - fall))) <= (1.0 + e) * G * T / steps + 1e-4


@every
@pytest.mark.parametrize("d", [2, 3])
def test_two_balls_exchange_the_momentum_of_newtons_impact_law(product, settings, d):
    m, e, v = (1.0, 3.0), 0.5, np.array([2.0, -1.0])
    rest = (0.0,) * (d - 1)
    model = make_model([Body((-0.3, *rest), m[0], Ball(0.1), e=e, v=(v[0], *rest)),
                        Body((0.3, *rest), m[1], Ball(0.1), e=1.0, v=(v[1], *rest))], (0.0,) * d)
    state, _ = run(product, model, 0.4, 400, **settings)
    common = np.dot(m, v) / sum(m)
    assert np.allclose(state.v[:, 0], common - e * (v - common), atol=spacings(product, 400), rtol=0.0)
    assert np.allclose(state.v[:, 1:], 0.0, atol=spacings(product, 400))


def pendulum_angle(rate, start, T, first=0.0):
    """The angle from the vertical after T of θ″ = −rate² sin θ, with the first rate θ′ [rad/s]."""
    return solve_ivp(lambda t, y: (y[1], -rate**2 * np.sin(y[0])), (0.0, T), (start, first), rtol=1e-12,
                     atol=1e-12).y[0, -1]


@every
@pytest.mark.parametrize(("d", "hinges"), [(2, 1), (3, 1), (3, 2)])
def test_a_rod_on_a_hinge_swings_as_the_pendulum_equation_says(product, settings, d, hinges):
    T, half, axis = 1.0, (0.5, 0.05), None
    place, x, gravity = (0.0, 0.0), (0.5, 0.0), (0.0, -G)
    if d == 3:                                               # the same in space, in a plane that no axis lies in
        e = np.array([0.6, 0.48, 0.64])
        place, x, gravity, half = (0.0,) * 3, tuple(0.5 * np.array([0.8, -0.36, -0.48])), tuple(
            np.cross(e, (0.8, -0.36, -0.48)) * -G), (0.05, 0.04, 0.06)
        axis = tuple(e)
    w = -1.5                                                 # it is pushed as it is let go
    spin = w if d == 2 else tuple(w * np.array(axis))
    v = (0.0, w * 0.5) if d == 2 else tuple(np.cross(spin, x))
    more = [Hinge(0, WORLD, tuple(0.2 * np.array(axis)), axis)] if hinges == 2 else []   # on the same axis: a loop
    model = make_model([Body(x, 2.0, Box(half), v=v, omega=spin)], gravity, [Hinge(0, WORLD, place, axis), *more])
    sign = np.sign(np.dot(gravity, v))                       # towards the vertical
    I = (np.array(model.bodies[0].inertia) @ np.square(axis) if d == 3 else model.bodies[0].inertia) + 2.0 * 0.25
    rate, limits = np.sqrt(2.0 * G * 0.5 / I), []
    errors = []
    for steps in (500, 1000):
        state, _ = run(product, model, T, steps, **settings)
        angle = pendulum_angle(rate, 0.5 * np.pi, T, -sign * abs(w))
        down = np.array(gravity) / G
        out = np.array(x) / 0.5
        errors.append(np.linalg.norm(state.x[0] - 0.5 * (np.cos(angle) * down + np.sin(angle) * out)))
        limits.append(0.5 * by_order(rate * np.sqrt(2.0), T, T / steps)[order_of(product)] + spacings(product, steps))
    assert np.all(np.array(errors) <= limits)


@every
def test_two_hinged_rods_that_turn_as_one_go_on_in_a_circle(product, settings):
    """Without gravity.  The second rod has no rate relative to the first."""
    T, steps, w = 1.0, 1000, 2.0
    rods = [Body((x, 0.0), 1.0, Box((0.25, 0.05)), v=(0.0, w * x), omega=w) for x in (0.25, 0.75)]
    model = make_model(rods, (0.0, 0.0), [Hinge(0, WORLD, (0.0, 0.0)), Hinge(1, 0, (0.5, 0.0))])
    state, _ = run(product, model, T, steps, **settings)
    circle = np.outer((0.25, 0.75), (np.cos(w * T), np.sin(w * T)))
    assert np.max(np.abs(state.x - circle)) <= 0.75 * by_order(w, T, T / steps)[1] + spacings(product, steps)
    assert np.allclose(state.omega, w, atol=w * by_order(w, T, T / steps)[1] + spacings(product, steps))


@every
@pytest.mark.parametrize("place", [(0.5, 0.0), (3.0, -2.0)])
def test_two_rods_swing_as_one_that_is_welded_together(product, settings, place):
    """The second rod lies along its second axis, so that the angles differ.  It does not matter where the weld is."""
    T, steps, turn = 0.5, 500, 0.5 * np.pi
    rods = [Body((0.25, 0.0), 1.0, Box((0.25, 0.05))), Body((0.75, 0.0), 1.0, Box((0.05, 0.25)), q=turn)]
    long = Body((0.5, 0.0), 2.0, Box((0.5, 0.05)))
    two = make_model(rods, (0.0, -G), [Hinge(0, WORLD, (0.0, 0.0)), Weld(1, 0, place)])
    one = make_model([long], (0.0, -G), [Hinge(0, WORLD, (0.0, 0.0))])
    first, second = (run(product, model, T, steps, **settings)[0] for model in (two, one))
    rate = np.sqrt(1.5 * G)
    allowed = by_order(rate, T, T / steps)[1] + spacings(product, steps)
    assert np.linalg.norm(0.5 * (first.x[0] + first.x[1]) - second.x[0]) <= allowed
    assert abs(first.q[0] + turn - first.q[1]) <= 2.0 * allowed


@every
@pytest.mark.parametrize("welds", [1, 2])
@pytest.mark.parametrize("d", [2, 3])
def test_a_weld_holds_a_turned_beam_in_the_wall(product, settings, d, welds):
    place = (0.0,) * d
    beam = (Body((0.5, 0.0), 1.0, Box((0.05, 0.5)), q=0.5 * np.pi) if d == 2 else
            Body((0.5, 0.0, 0.0), 1.0, Box((0.05, 0.5, 0.06)), q=(np.sqrt(0.5), 0.0, 0.0, np.sqrt(0.5))))
    model = make_model([beam], tuple(-G * np.eye(d)[-1]), [Weld(0, WORLD, place)] * welds)
    state, _ = run(product, model, 0.5, 500, **settings)
    assert np.max(np.abs(state.x[0] - beam.x)) <= SOFT
    assert np.max(np.abs(state.q[0] - model.bodies[0].q)) <= 2.0 * SOFT


@every
def test_a_rod_without_mass_keeps_its_length_and_the_bob_swings(product, settings):
    T, steps, L = 0.5, 1000, 1.0
    model = make_model([Body((L, 0.0), 1.0, Ball(0.05))], (0.0, -G),
                       [Distance(0, WORLD, (0.0, 0.0), (0.0, 0.0))])
    state, _ = run(product, model, T, steps, **settings)
    rate = np.sqrt(G / L)
    angle = pendulum_angle(rate, 0.5 * np.pi, T)
    allowed = by_order(rate * np.sqrt(2.0), T, T / steps)[1] + spacings(product, steps)
    assert np.linalg.norm(state.x[0] - L * np.array((np.sin(angle), -np.cos(angle)))) <= allowed


@every
@pytest.mark.parametrize("d", [2, 3])
def test_a_spring_with_a_damper_swings_as_its_formula_says(product, settings, d):
    T, steps, k, c, m, rest = 1.0, 1000, 40.0, 0.5, 1.0, 2.0
    zero = (0.0,) * d
    model = make_model([Body((0.3, *zero[1:]), m)], zero,
                       springs=[Spring(0, WORLD, zero, (-rest, *zero[1:]), rest, k, c)])
    state, _ = run(product, model, T, steps, **settings)
    decay = 0.5 * c / m
    rate = np.sqrt(k / m - decay**2)
    x = 0.3 * np.exp(-decay * T) * (np.cos(rate * T) + decay / rate * np.sin(rate * T))
    assert abs(state.x[0, 0] - x) <= 0.3 * by_order(rate, T, T / steps)[order_of(product)] + spacings(product, steps)


@every
@pytest.mark.parametrize("held", [WORLD, 1], ids=["world", "body"])
def test_a_spring_without_a_rest_length_may_begin_with_no_length(product, settings, held):
    """A weight hung on it where it is attached falls by g/ω² (1 − cos ωt)."""
    T, steps, k, m = 0.4, 400, 50.0, 2.0
    bodies, omega = [Body((0.0, 0.0), m), Body((0.0, 0.0))], np.sqrt(k / m)
    model = make_model(bodies, (0.0, -G), springs=[Spring(0, held, (0.0, 0.0), (0.0, 0.0), 0.0, k)])
    state, _ = run(product, model, T, steps, **settings)
    fallen = G / omega**2 * (1.0 - np.cos(omega * T))
    assert abs(state.x[0, 1] + fallen) <= 0.5 * T / steps * G / omega + spacings(product, steps)


@every
def test_a_compliant_distance_is_a_spring_of_the_inverse_stiffness(product, settings):
    T, steps, alpha = 0.5, 500, 0.01
    bob = Body((0.5, 0.0), 1.0, v=(0.0, 1.0))
    ends = (0.0, 0.0), (0.0, 0.0)
    soft = make_model([bob], (0.0, -G), [Distance(0, WORLD, *ends, alpha)])
    spring = make_model([bob], (0.0, -G), springs=[Spring(0, WORLD, *ends, 0.5, 1.0 / alpha)])
    first, second = (run(product, model, T, steps, **settings)[0] for model in (soft, spring))
    assert np.array_equal(first.x, second.x)


@every
def test_a_free_body_turns_as_eulers_equations_say(product, settings):
    T, moments, first = 1.0, np.array([1.0, 2.0, 2.5]), np.array([0.2, 3.0, 0.4])
    model = make_model([Body((0.0, 0.0, 0.0), 1.0, inertia=tuple(moments), omega=tuple(first))], (0.0, 0.0, 0.0))
    spin = np.empty((3, 3))

    def slope(t, y):
        R, w = y[:9].reshape(3, 3), y[9:]
        spin[:] = (0.0, -w[2], w[1]), (w[2], 0.0, -w[0]), (-w[1], w[0], 0.0)
        return np.concatenate(((R @ spin).ravel(), np.cross(moments * w, w) / moments))
    end = solve_ivp(slope, (0.0, T), (*np.eye(3).ravel(), *first), rtol=1e-12, atol=1e-12).y[:9, -1].reshape(3, 3)
    for steps in (500, 1000):
        state, _ = run(product, model, T, steps, **settings)
        w, x, y, z = state.q[0]
        axis = np.array([2.0 * (x * z + w * y), 2.0 * (y * z - w * x), 1.0 - 2.0 * (x * x + y * y)])
        limit = by_order(np.linalg.norm(first), T, T / steps)[order_of(product)]
        assert np.linalg.norm(axis - end[:, 2]) <= limit
        assert np.allclose(state.omega[0], end @ (end.T @ state.omega[0]), atol=1e-9)


@every
def test_a_spring_off_the_centre_turns_a_body_in_space_alike_everywhere(product, settings):
    """Truth: MuJoCo's Runge–Kutta 4, which shares nothing with the others but the Model."""
    T, turned = 0.5, np.array([0.9, 0.3, -0.1, 0.3])
    body = Body((0.0, 0.0, 0.0), 1.0, q=tuple(turned / np.linalg.norm(turned)), inertia=(0.05, 0.08, 0.1),
                omega=(1.0, 0.0, 2.0))
    model = make_model([body], (0.0, 0.0, -G), springs=[
        Spring(0, WORLD, (0.2, 0.1, 0.0), (0.5, 0.4, 1.0), 0.8, 30.0, 0.2),
        Spring(0, WORLD, (-0.1, -0.2, 0.1), (-0.5, -0.4, 1.0), 0.8, 30.0, 0.2)])
    truth, _ = run(MUJOCO, model, T, 2000)
    state, _ = run(product, model, T, 2000, **settings)
    allowed = by_order(15.0, T, T / 2000)[1]                 # the fastest turn: √(60 N/m (0.3 m)² / 0.05 kg m²) < 15/s
    assert np.max(np.abs(state.x - truth.x)) <= allowed
    assert 1.0 - abs(state.q[0] @ truth.q[0]) <= allowed**2
    assert np.max(np.abs(state.omega - truth.omega)) <= 15.0 * allowed


# ---------------------------------------------------------------------------------------------- forces

def roughness(product):
    """Friction of a body whose contacts are asked for forces: Rapier's binding hides where friction points to."""
    return 0.0 if product is RAPIER else 0.5


def at_rest(shape, mu=0.5):
    height = 0.1 if isinstance(shape, Box | Capsule) else 0.2
    return make_model([Body((0.5, height), 3.0, shape, mu), FLOOR], (0.0, -G)), height


@every
@pytest.mark.parametrize("shape", SHAPES, ids=lambda shape: type(shape).__name__)
def test_a_resting_body_stays_and_its_contacts_carry_its_weight(product, settings, shape):
    model, height = at_rest(shape, roughness(product))
    state, pushes = run(product, model, 0.3, 300, **settings)
    assert np.max(np.abs(state.x[0] - (0.5, height))) <= SOFT and abs(state.q[0]) <= 2.0 * SOFT
    assert not np.any(state.x[1]) and not np.any(state.v[1])
    if product is BOX2D:
        assert pushes == []                                  # its binding tells no forces of contacts
        return
    on_body = sum(push.F if push.a == 0 else -push.F for push in pushes)
    assert {frozenset((push.a, push.b)) for push in pushes} == {frozenset((0, 1))}
    assert on_body == pytest.approx([0.0, 3.0 * G], abs=3.0 * G * 1e-3)


@every
@pytest.mark.parametrize("shape", [Ball(0.2), Box((0.2, 0.3, 0.1)), Capsule(0.3, 0.1)],
                         ids=lambda shape: type(shape).__name__)
def test_a_body_rests_on_a_tilted_plane_in_space(product, settings, shape):
    n = np.array([0.6, 0.0, 0.8])
    height = shape.radius if isinstance(shape, Ball | Capsule) else shape.half[2]
    half = 0.5 * np.arctan2(n[0], n[2])
    model = make_model([Body(tuple((height - 0.3) * n), 2.0, shape, 2.0 * roughness(product),
                             q=(np.cos(half), 0.0, np.sin(half), 0.0)),
                        Body((1.0, 2.0, 3.0), shape=HalfSpace(tuple(n), 0.3), mu=1.0, e=1.0,
                             q=(np.sqrt(0.5), 0.0, 0.0, np.sqrt(0.5)))], tuple(-G * n))
    state, pushes = run(product, model, 0.3, 300, **settings)
    assert np.max(np.abs(state.x[0] - model.bodies[0].x)) <= SOFT
    on_body = sum(push.F if push.a == 0 else -push.F for push in pushes)
    assert on_body == pytest.approx(2.0 * G * n, abs=2.0 * G * 1e-2)


def test_rapier_reports_no_force_that_its_binding_does_not_tell():
    """The direction of friction, and the forces of joints."""
    rough, _ = at_rest(Ball(0.2))
    hung = make_model([Body((0.5, 0.0), 2.0, Box((0.5, 0.1)))], (0.0, -G), [Hinge(0, WORLD, (0.0, 0.0))])
    for model in (rough, hung):
        _, pushes = run(RAPIER, model, 0.01, 10)
        assert pushes == []


@every
@pytest.mark.parametrize("d", [2, 3])
def test_a_rod_swings_on_the_floor_as_on_the_world(product, settings, d):
    """The floor is a body with a pose of its own, which engines put elsewhere."""
    lift, ahead = np.eye(d)[-1], np.eye(d)[0]
    floor = Body(tuple(2.0 * ahead - 3.0 * lift), shape=HalfSpace(tuple(0.6 * ahead + 0.8 * lift), 4.0))
    rod = Body(tuple(0.5 * ahead), 1.0, inertia=0.1)
    axis = {} if d == 2 else {"axis": (0.0, -1.0, 0.0)}
    swung = [run(product, make_model([rod, floor], tuple(-G * lift), [Hinge(0, on, (0.0,) * d, **axis)]), 0.5, 250,
                 **settings)[0] for on in (WORLD, 1)]
    assert np.max(np.abs(swung[0].x[0] - swung[1].x[0])) <= 1e-4 and swung[0].x[0, -1] < -0.4


@every
def test_a_force_towards_a_floor_acts_as_one_towards_a_fixed_body(product, settings):
    pull = lambda r: (3.0 * r[0], 3.0 * r[1])
    ends = []
    for shape in (None, HalfSpace((0.0, 1.0), 9.0)):
        model = make_model([Body((0.0, 0.0), 1.0), Body((2.0, -1.0), shape=shape)], (0.0, 0.0),
                           loads=[Force(0, pull, "r", 1)])
        ends.append(run(product, model, 1.0, 100, **settings)[0].x[0])
    assert np.allclose(*ends, atol=1e-6) and ends[0][0] > 1.5


@every
def test_a_world_begins_with_the_angle_of_the_model(product, settings):
    """Box2D's own functions from an angle and to one err by up to 1.5e-3."""
    for q in (0.3, 1.1, 2.5, -2.9):
        body = make_model([Body((0.0, 0.0), 1.0, inertia=1.0, q=q)], (0.0, 0.0))
        found, _ = run(product, body, 1e-3, 1, **settings)
        assert (np.cos(found.q[0]), np.sin(found.q[0])) == pytest.approx((np.cos(q), np.sin(q)), abs=1e-6)


def test_rapier_turns_a_fast_body_by_its_own_law_without_a_limit():
    """By 2 atan(½ ω dt) in each of four substeps; by default it turns a body by π/4 per step at most."""
    found, _ = run(RAPIER, make_model([Body((0.0, 0.0), 1.0, inertia=1.0, omega=100.0)], (0.0, 0.0)), 0.01, 1)
    assert found.q[0] == pytest.approx(4.0 * 2.0 * np.arctan(0.5 * 100.0 * 0.0025), abs=1e-5)


@every
@pytest.mark.parametrize("model", [
    make_model([Body((0.0, 0.0, 0.0), 1.0, inertia=(1.0, 2.0, 2.5), omega=(1.0, 2.0, 3.0))], (0.0, 0.0, 0.0),
               [Hinge(0, WORLD, (0.0, 0.0, 0.0), (0.0, 0.0, 1.0))]),
    make_model([Body((0.0, 0.0), 1.0, inertia=1e13)], (0.0, 0.0)),
    make_model([FLOOR._replace(mu=20.0), Body((0.0, 0.2), 1.0, Ball(0.2), mu=1.0)], (0.0, -G)),
    make_model([Body((0.0, 0.0), 1e-14, Ball(0.1))], (0.0, 0.0)),
    make_model([Body((0.0, 0.0), 2.0 * derived.SINGLE[1])], (0.0, -G)),
    make_model([Body((0.0, 0.0), 1.0, inertia=0.5 * derived.SINGLE[0])], (0.0, -G)),
    make_model([Body((0.0, 0.0), 1.0, square(0.9e-4))], (0.0, -G)),
    make_model([Body((0.0, 0.0, 0.0), 1.0, cube(0.9e-3))], (0.0, 0.0, -G))],
    ids=["spin", "moment", "friction", "mass", "heavy", "light", "corners", "thin"])
def test_what_an_engine_would_drop_is_refused_before_it_builds(product, settings, model, request):
    """An engine that does not refuse it can hold such a motion, moment or friction."""
    if not product.installed():
        pytest.skip(f"{product} is not installed: {product.remedy}")
    why = product.world.refuses(model)
    if why:
        with pytest.raises(BadInput, match="refuses"):
            product.world.build(model, 0.01, **settings)
    refusers = {"spin": (PYMUNK, BOX2D, MUJOCO), "moment": (MUJOCO, PYBULLET), "friction": (PYBULLET,),
                "mass": (MUJOCO,), "heavy": (BOX2D, RAPIER), "light": (BOX2D, RAPIER, MUJOCO), "corners": (BOX2D,),
                "thin": (PYMUNK, BOX2D, RAPIER, PYBULLET)}[request.node.callspec.id.split("-")[0]]
    assert bool(why) == (product in refusers)


@pytest.mark.parametrize("product", [BOX2D, RAPIER], ids=str)
@pytest.mark.parametrize("limit", derived.SINGLE)
@pytest.mark.parametrize("moment", [False, True])
def test_single_precision_carries_the_masses_and_moments_that_are_not_refused(product, limit, moment):
    """A body falls and turns as one of 1 kg does."""
    m, I = (1.0, limit) if moment else (limit, 1.0)
    found, _ = run(product, make_model([Body((0.0, 0.0), m, inertia=I, omega=1.0)], (0.0, -G)), 1.0, 100)
    assert (found.x[0, 1], found.omega[0], found.q[0]) == pytest.approx((-0.5 * G, 1.0, 1.0), rel=5e-3)


@pytest.mark.parametrize(("product", "shape", "support"), [
    (BOX2D, square(1.1e-4), HalfSpace((0.0, 1.0))),
    (RAPIER, cube(5.1e-3), Box((5.1e-3,) * 3)), (RAPIER, cube(5.1e-3), cube(5.1e-3)),
    (PYBULLET, cube(1.1e-3), Box((1.1e-3,) * 3)), (PYBULLET, cube(1.1e-3), cube(1.1e-3))])
def test_the_smallest_shapes_that_are_not_refused_rest_on_others(product, shape, support):
    """It falls by half of its size and stays there.  The engines that overlap do so by less than a fifth of it."""
    d, size = len(shape.corners[0]), abs(shape.corners[0][0])
    up = np.eye(d)[-1]
    below = Body((0.0,) * d if isinstance(support, HalfSpace) else tuple(-size * up), shape=support, mu=1.0)
    model = make_model([Body(tuple(1.5 * size * up), 1e3 * size**3, shape, 1.0), below], tuple(-G * up))
    T = np.sqrt(2.0 * size / G)
    found, _ = run(product, model, 8.0 * T, 400)
    assert found.x[0, -1] == pytest.approx(size, rel=0.2)


@pytest.mark.parametrize("product", [MUJOCO, BOX2D], ids=str)
def test_a_joint_keeps_its_number_beside_a_compliant_rod(product):
    """The rod becomes a spring of the engine, which is no joint there."""
    bodies = [Body((0.0, -1.0), 1.0), Body((0.0, -2.0), 1.0, inertia=0.1)]
    rod, hinge = Distance(0, WORLD, (0.0, 0.0), (0.0, 0.0), 1e-4), Hinge(1, WORLD, (0.0, -1.5))
    for joints in ((rod, hinge), (hinge, rod)):
        _, found = run(product, make_model(bodies, (0.0, -G), joints), 0.01, 10)
        assert [push.joint for push in found] == [joints.index(hinge)]


@pytest.mark.parametrize("product", [MUJOCO, BOX2D], ids=str)
@pytest.mark.parametrize(("ends", "sign"), [((0, WORLD), 1.0), ((0, 1), 1.0), ((1, 0), -1.0)])
def test_a_joint_tells_the_force_of_a_pendulum(product, ends, sign):
    """A hinge carries a quarter of the weight of a rod that is let go level, and 5/2 sin θ of it θ below."""
    wall = Body((-1.0, 0.0))
    model = make_model([Body((0.5, 0.0), 2.0, Box((0.5, 1e-3))), wall], (0.0, -G), [Hinge(*ends, (0.0, 0.0))])
    for steps in (1, 500):
        state, pushes = run(product, model, steps * 1e-3, steps)
        angle = state.q[0]
        out, across = np.array([np.cos(angle), np.sin(angle)]), np.array([-np.sin(angle), np.cos(angle)])
        F = sign * 2.0 * G * (2.5 * np.sin(angle) * out + 0.25 * np.cos(angle) * across)
        assert [(push.a, push.b, push.joint) for push in pushes] == [(*ends, 0)]
        assert pushes[0].F == pytest.approx(F, abs=2.0 * G * 2.5 * (3.9 * 1e-3 + 2e-3))


# ---------------------------------------------------------------------------------------------- many things at once

def box(x, y, half, m, mu=0.5, **more):
    return Body((x, y), m, Box(half), mu, **more)


def mixed_machine():
    """A ball on a ramp, dominoes, a crate on a spring, a see-saw, and a pendulum of a rod and a ball."""
    slope = -0.35
    along, n = np.array([np.cos(slope), np.sin(slope)]), np.array([-np.sin(slope), np.cos(slope)])
    ball = lambda x, r, m, mu: Body(tuple(x), m, Ball(r), mu, inertia=0.4 * m * r * r)
    bodies = [
        FLOOR, Body((-1.75, 0.45), shape=Box((0.6, 0.03)), mu=1.0, e=1.0, q=slope),
        ball(np.array([-1.75, 0.45]) - 0.35 * along + 0.11 * n, 0.08, 1.0, 0.6),
        *[box(-0.6 + 0.16 * k, 0.15, (0.025, 0.15), 0.3, 0.4) for k in range(4)],
        box(0.14, 0.1, (0.1, 0.1), 0.4, 0.2), box(1.5, 0.3, (0.6, 0.02), 0.8, 0.7), ball((1.05, 0.38), 0.06, 0.2, 0.7),
        box(1.95, 0.75, (0.1, 0.08), 1.5, 0.7), Body((3.0, 1.3), 0.2, inertia=0.2 * 0.2**2 / 12.0),
        ball((3.45, 1.3), 0.09, 0.6, 0.3), box(2.55, 0.5, (0.08, 0.5), 0.5)]
    joints = [Hinge(8, WORLD, (1.5, 0.3)), Hinge(11, WORLD, (2.9, 1.3)), Hinge(12, 11, (3.1, 1.3))]
    return make_model(bodies, (0.0, -G), joints, [Spring(7, WORLD, (0.1, 0.0), (0.9, 0.1), 0.66, 60.0, 1.0)])


@pytest.mark.parametrize("product", [PYBULLET, MUJOCO, BOX2D, RAPIER], ids=str)
def test_a_mixed_machine_moves_alike_in_engines_that_share_nothing(product):
    """For 0.2 s, before anything tips.  Two engines of order 1 that fall are up to g T dt apart."""
    model, T, steps = mixed_machine(), 0.2, 800
    truth, _ = run(PYMUNK, model, T, 4 * steps)
    state, _ = run(product, model, T, steps)
    off = np.linalg.norm(state.x - truth.x, axis=1)[[can_move(body) for body in model.bodies]]
    assert np.max(off) <= G * T * (T / steps + T / (4 * steps))


# ---------------------------------------------------------------------------------------------- refusals

SPACE_BOX = Body((0.0, 0.0, 0.0), 1.0, Box((0.1, 0.1, 0.1)))
MOVING = Body((0.0, 0.0), shape=HalfSpace((0.0, 1.0)), v=(1.0, 0.0))
BALL = Body((0.0, 0.1), 1.0, Ball(0.1))
ROD = make_model([BALL], (0.0, -G), [Distance(0, WORLD, (0.0, 0.0), (1.0, 0.0))])
BOUNCY = make_model([BALL._replace(e=0.5), FLOOR], (0.0, -G))
SEVERAL = make_model([BALL._replace(e=0.5), BALL._replace(x=(1.0, 0.1), e=0.8), FLOOR], (0.0, -G))
ROUND = np.linspace(0.0, 2.0 * np.pi, 9, endpoint=False)
NINE = make_model([Body((0.0, 1.0), 1.0, Polygon(tuple(zip(np.cos(ROUND), np.sin(ROUND), strict=True))))], (0.0, -G))
IN_SPACE = make_model([SPACE_BOX], (0.0, 0.0, -G))
REFUSED = [
    (PYMUNK, IN_SPACE, "plane"), (BOX2D, IN_SPACE, "plane"),
    (PYBULLET, make_model([BALL, MOVING], (0.0, -G)), "without mass"), (PYBULLET, ROD, "Distance"),
    (MUJOCO, make_model([BALL, MOVING], (0.0, -G)), "without mass"), (MUJOCO, BOUNCY, "no restitution"),
    (BOX2D, SEVERAL, "restitution"), (BOX2D, NINE, "8 corners"),
    (PYMUNK, make_model([SPACE_BOX], (0.0, 0.0, -G), [BallJoint(0, WORLD, (0.0, 0.0, 0.0))]), "plane"),
    *((product, make_model([Body((3000.0, 0.1), 1.0, Box((0.1, 0.1))), FLOOR], (0.0, -G)), "half-spaces end")
      for product in (PYMUNK, PYBULLET, BOX2D)),
]


@pytest.mark.parametrize("shape", [Ball(0.2), Box((0.3, 0.2))], ids=["ball", "box"])
@pytest.mark.parametrize("place", [40.0, 3000.0])
def test_a_floor_carries_a_body_that_is_far_away_or_is_refused(shape, place):
    """Half-spaces of some engines are boxes, and bodies fell past their ends."""
    model = make_model([Body((place, 0.2), 1.0, shape, 0.5), FLOOR], (0.0, -G))
    worlds = [product for product in BUILDERS if product.installed() and not product.world.refuses(model)]
    assert worlds
    for product in worlds:
        assert abs(run(product, model, 0.5, 50)[0].x[0, 1] - 0.2) < 0.01


@pytest.mark.parametrize(("product", "model", "word"), REFUSED)
def test_what_an_engine_lacks_is_refused_by_name(product, model, word):
    assert word in product.world.refuses(model)


def test_reduced_coordinates_hold_a_ball_joint_by_a_constraint():
    pivot = np.array((0.3, 0.0, 0.2))
    model = make_model([SPACE_BOX], (0.0, 0.0, -G), [BallJoint(0, WORLD, tuple(pivot))])
    state, _ = run(PYBULLET, model, 0.3, 600, **REDUCED)
    assert world_place(state, 0, own_place(model, 0, pivot)) == pytest.approx(pivot, abs=1e-3)
    assert np.linalg.norm(state.x[0] - model.bodies[0].x) > 0.05         # it swings


@pytest.mark.parametrize("product", [PYMUNK, BOX2D, RAPIER], ids=str)
def test_a_belt_carries_a_block_in_engines_that_have_belts(product):
    model = make_model([Body((0.0, 0.1), 1.0, Box((0.2, 0.1)), 0.5), FLOOR._replace(v=(1.0, 0.0))], (0.0, -G))
    state, _ = run(product, model, 0.5, 1000)
    assert state.v[0, 0] == pytest.approx(1.0, abs=1e-3)
    assert state.x[0, 0] == pytest.approx(0.5 - 0.5 / (0.5 * G), abs=2e-3)        # it slides for v / μg


# ---------------------------------------------------------------------------------------------- what worlds derive

def test_the_gap_of_two_shapes_is_their_distance():
    at = lambda shape, x, q=None: make_model([Body(x, 1.0, shape, q=q)], (0.0,) * len(x)).bodies[0]
    for a, b, distance, n in (
            (at(Ball(0.1), (0.0, 0.0)), at(Ball(0.2), (0.0, 1.0)), 0.7, (0.0, -1.0)),
            (at(Box((0.5, 0.5)), (0.0, 0.0)), at(Box((0.5, 0.5)), (1.0 + 0.3, 1.0 + 0.4)), 0.5, (-0.6, -0.8)),
            (at(Box((0.5, 0.5)), (0.0, 0.0)), at(Box((0.5, 0.5)), (0.2, 0.9)), -0.1, (0.0, -1.0)),
            (at(Capsule(1.0, 0.1), (0.0, 0.0), 0.5 * np.pi), at(Ball(0.1), (1.0, 0.5)), 0.8, (-1.0, 0.0)),
            (at(Box((0.5,) * 3), (0.0,) * 3), at(Ball(0.1), (1.5, 1.5, 1.5)), np.sqrt(3.0) - 0.1, (-3**-0.5,) * 3),
            (at(Capsule(1.0, 0.1), (0.0,) * 3), at(Capsule(1.0, 0.2), (0.0, 0.0, 1.0), (np.sqrt(0.5), 0.0, 0.0,
                                                                                       np.sqrt(0.5))), 0.7,
             (0.0, 0.0, -1.0))):
        for one, other, sign in ((a, b, 1.0), (b, a, -1.0)):
            found, way = derived.gap(one, other)
            assert found == pytest.approx(distance, abs=1e-12)
            assert way == pytest.approx(sign * np.array(n), abs=1e-9)


def crowd(rng, d):
    """Return a Model of bodies in a heap, of which some touch exactly, some overlap, and some are joined."""
    def shape():
        half = rng.uniform(0.1, 0.3, d)
        return (Ball(half[0]), Box(tuple(half)), Capsule(half[0], half[1]), None)[rng.integers(4)]
    bodies = [Body(tuple(rng.uniform(-0.8, 0.8, d)), rng.choice([1.0, np.inf]), shape(), rng.choice([0.0, 0.5]),
                   rng.choice([0.0, 0.5])) for _ in range(9)]
    bodies += [Body((2.0 + 0.4 * k, *(0.0,) * (d - 1)), 1.0, Ball(0.2)) for k in range(3)]
    joints = [Weld(0, 1, bodies[0].x)] if np.isfinite(bodies[0].m) or np.isfinite(bodies[1].m) else []
    floor = HalfSpace((*(0.0,) * (d - 1), 1.0), rng.uniform(-0.2, 0.2))
    return make_model([*bodies, Body((0.0,) * d, shape=floor, mu=1.0, e=1.0)], (0.0,) * d, joints)


@pytest.mark.parametrize("d", [2, 3])
def test_what_touches_at_the_start_is_what_trying_all_pairs_finds(d):
    for seed in range(40):
        model = crowd(np.random.default_rng(seed), d)
        pairs, b = touching_pairs(model), model.bodies
        sizes = [size_of(one.shape) if one.shape is not None else np.inf for one in b]
        gaps = [(i, j, *derived.gap(b[i], b[j])) for i, j in pairs]
        found = [(i, j) for i, j, distance, _ in gaps
                 if abs(distance) <= derived.TOUCH * max(size for size in (sizes[i], sizes[j]) if size < np.inf)]
        assert [pair[:2] for pair in derived.contacts_at_start(model)] == found and len(found) >= 2
        assert derived.touches(model) == bool(pairs)
        assert derived.bounces(model) == any(b[i].e * b[j].e > 0.0 for i, j in pairs)
        assert derived.rubs(model) == any(b[i].mu * b[j].mu > 0.0 for i, j in pairs)


def test_a_large_pile_is_built_without_trying_all_pairs(monkeypatch):
    """A body of a lattice is within reach of a few others, and of the floor."""
    tried, n = [], 900
    monkeypatch.setattr(derived, "gap", lambda a, b, gap=derived.gap: tried.append(1) or gap(a, b))
    bodies = [Body((0.5 * (k % 30), 0.5 * (k // 30) + 0.25), 1.0, Box((0.2, 0.2)), 0.5) for k in range(n)]
    chipmunk.build(make_model([*bodies, FLOOR], (0.0, -G)), 1e-3)
    assert len(tried) <= 5 * n


def test_a_tower_is_pressed_in_from_the_floor_upwards():
    model = make_model([*[box(0.0, 0.2 * k + 0.1, (0.1, 0.1), 1.0) for k in range(3)], box(0.5, 0.3, (0.1, 0.1), 1.0),
                        FLOOR], (0.0, -G))
    sunk = start_of(model).x - derived.pressed_in(model, 1e-6)
    assert sunk[:, 1] == pytest.approx([1e-6, 2e-6, 3e-6, 0.0, 0.0], abs=1e-12) and not np.any(sunk[:, 0])


def test_every_body_hangs_on_the_joint_that_leads_to_a_fixed_one():
    bodies = [Body((float(k), 0.0), 1.0) for k in range(4)]
    joints = [Hinge(2, 1, (1.5, 0.0)), Hinge(0, WORLD, (0.0, 0.0)), Hinge(1, 0, (0.5, 0.0)),
              Hinge(2, WORLD, (2.0, 0.0))]
    above, loops = derived.tree(make_model(bodies, (0.0, -G), joints))
    assert above == {0: (WORLD, 1), 1: (0, 2), 2: (1, 0), 3: (WORLD, None)} and loops == [3]


@pytest.mark.parametrize("product", BUILDERS, ids=str)
def test_a_four_bar_stays_closed(product):
    pins = np.array([(0.0, 0.0), (0.0, 0.4), (1.0, 0.9), (1.2, 0.0)])
    rods = [Body(tuple(0.5 * (a + b)), 1.0, inertia=(b - a) @ (b - a) / 12.0) for a, b in pairwise(pins)]
    joints = [Hinge(k, k - 1 if k else WORLD, tuple(pins[k])) for k in range(3)] + [Hinge(2, WORLD, tuple(pins[3]))]
    model = make_model(rods, (0.0, -G), joints)
    T, steps = 0.5, 1000
    state, _ = run(product, model, T, steps)
    c, s = np.cos(state.q[2]), np.sin(state.q[2])
    arm = np.array(pins[3] - rods[2].x)
    assert state.x[2] + (c * arm[0] - s * arm[1], s * arm[0] + c * arm[1]) == pytest.approx(pins[3], abs=SOFT)
    I = np.array([rod.inertia for rod in rods])
    energy = 0.5 * np.sum(state.v**2) + 0.5 * I @ state.omega**2 + G * np.sum(state.x[:, 1] - start_of(model).x[:, 1])
    assert abs(energy) <= 2.0 * G * 3.0 * T / steps * np.max(np.abs(state.v))     # order 1, with weight and speed


# ---------------------------------------------------------------------------------------------- our loop beside them

def belt_machine():
    """Boxes on a plank on a belt, a capsule that falls on them, and a ball on a rod that hits them."""
    bodies = [
        FLOOR._replace(v=(-0.8, 0.0)),
        Body((0.0, 0.05), 3.0, Box((0.6, 0.05)), mu=0.4),
        Body((-0.3, 0.2), 1.0, Box((0.1, 0.1)), mu=0.4),
        Body((0.0, 0.25), 1.0, Box((0.1, 0.15)), mu=0.4),
        Body((0.3, 0.9), 0.5, Capsule(0.12, 0.06), mu=0.4, q=0.4),
        Body((0.9, 0.9), 0.8, Ball(0.1), mu=0.3),
        Body((0.6, 0.9), 0.2, inertia=0.2 * 0.6**2 / 12.0),
    ]
    return make_model(bodies, (0.0, -G), [Hinge(6, WORLD, (0.3, 0.9)), Hinge(5, 6, (0.9, 0.9))],
                      [Spring(2, 3, (0.0, 0.0), (0.0, 0.0), 0.3, 50.0, 1.0)])


def test_our_loop_and_pymunk_agree_the_longer_the_shorter_the_step():
    """Two codes that share nothing but the Model: with a quarter of the step they are at most half as far apart."""
    model, apart = belt_machine(), []
    for rate in (240, 960):
        dt = 1.0 / rate
        worlds = ours.build(model, dt, sweeps=300, settled=1e-6), chipmunk.build(model, dt, ahead=1.0, iterations=300)
        largest = 0.0
        for _ in range(round(0.5 * rate)):
            for world in worlds:
                world.step()
            x, other = (world.state().x[1:] for world in worlds)
            largest = max(largest, np.max(np.hypot(*(x - other).T)))
        apart.append(largest)
    assert apart[1] < 0.03
    assert apart[1] < 0.6 * apart[0]


def test_our_loop_tells_the_forces_of_contacts_and_joints():
    model = make_model([FLOOR, Body((0.0, 0.3), 2.0, Box((0.4, 0.3)), mu=0.5)], (0.0, -G))
    world = ours.build(model, 1e-3, sweeps=1000, settled=1e-12)
    for _ in range(50):
        world.step()
    on_box = sum((push.F if push.a == 1 else -push.F for push in world.pushes()), np.zeros(2))
    assert on_box == pytest.approx((0.0, 2.0 * G), abs=1e-6)
    hung = make_model([Body((0.0, -1.0), 2.0, inertia=0.1)], (0.0, -G), [Hinge(0, WORLD, (0.0, 0.0))])
    world = ours.build(hung, 1e-3)
    world.step()
    (push,) = world.pushes()
    assert (push.a, push.b, push.joint) == (0, WORLD, 0)
    assert push.F == pytest.approx((0.0, 2.0 * G), abs=1e-9)
    welded = make_model([Body((0.0, 0.0), 1.0, Box((0.1, 0.1))), Body((0.5, 0.0), 1.0, Box((0.1, 0.1)))], (0.0, -G),
                        [Weld(0, WORLD, (0.0, 0.0)), Weld(1, 0, (0.25, 0.0))])
    world = ours.build(welded, 1e-3)
    world.step()
    held = sum(push.F for push in world.pushes() if push.joint == 0)
    assert held == pytest.approx((0.0, 2.0 * G), abs=1e-6)


@pytest.mark.parametrize("aside", [(), (0.0,)], ids=["plane", "space"])
def test_a_soft_rod_may_be_far_shorter_than_it_would_be(aside):
    """A body flies past the end of its rod.  Its gap is rounded as the length is, not as the places near the origin."""
    zero = (0.0, 0.0, *aside)
    world = ours.build(make_model([Body((1.0, 1e-3, *aside), 1.0, v=(-20.0, 0.0, *aside))], zero,
                                  [Distance(0, WORLD, zero, zero, 1.0)]), 0.01)
    for _ in range(10):
        world.step()
    assert world.state().x[0, 0] == pytest.approx(-1.0, abs=0.05)


def models_in_the_plane():
    light = Body((0.0, 1.0), 1.0, Ball(0.2), e=0.5)
    return {
        "all parts": belt_machine(),
        "restitution": make_model([light, FLOOR], (0.0, -G)),
        "friction": make_model([light._replace(mu=0.5), light._replace(x=(1.0, 1.0), mu=0.2), FLOOR], (0.0, -G)),
        "a joint": make_model([light._replace(shape=None, inertia=0.1)], (0.0, -G), [Hinge(0, WORLD, (0.5, 1.0))]),
    }


def models_in_space():
    down, ground = (0.0, 0.0, -G), Body((0.0, 0.0, 0.0), shape=HalfSpace((0.0, 0.0, 1.0)), mu=0.5, e=0.2)

    def light(*x):
        return Body(x, 1.0, Ball(0.1), mu=0.4, e=0.3)
    swinging = Body((0.6, 0.0, 0.6), 1.0, Box((0.5, 0.1, 0.1)), mu=0.4)
    links = [light(0.25 * k, 0.02 * k, 0.5) for k in range(4)]
    return {
        "a hinge and contacts": make_model([ground, swinging, light(1.0, 0.02, 1.0)], down,
                                           [Hinge(1, WORLD, (0.1, 0.0, 0.6), (0.0, 1.0, 0.0))]),
        "a rod and contacts": make_model([ground, light(0.0, 0.0, 0.5), light(0.5, 0.1, 0.8)], down,
                                         [Distance(1, 2, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0))]),
        "a chain and contacts": make_model([ground, *links], down, [
            BallJoint(k, k + 1, (0.25 * k - 0.125, 0.02 * k - 0.01, 0.5)) for k in range(1, 4)]),
        "a spring and drag": make_model(
            [light(0.0, 0.0, 1.0), light(0.5, 0.2, 1.0)], down, (),
            [Spring(0, 1, (0.0, 0.0, 0.05), (0.0, 0.05, 0.0), 0.4, 80.0, 1.0)], [Drag(0.3)]),
    }


@pytest.mark.long
@pytest.mark.xdist_group("compiled simulator")
@pytest.mark.parametrize("models", [models_in_the_plane, models_in_space])
def test_our_compiled_loop_runs_every_part_as_the_plain_one_does(models):
    if not modules.can_compile():
        pytest.skip("numba has no wheel for this machine")
    for said, model in models().items():
        worlds = [ours.build(model, 1e-3, compiled=kind) for kind in (False, True)]
        for _ in range(700):
            for world in worlds:
                world.step()
        plain, compiled = (world.state() for world in worlds)
        assert compiled.x == pytest.approx(plain.x, abs=1e-9), said
        assert compiled.q == pytest.approx(plain.q, abs=1e-9), said


# ---------------------------------------------------------------------------------------------- first velocities

@every
@pytest.mark.parametrize("moment", [0.01, np.inf])
@pytest.mark.parametrize("kind", [Weld, Hinge])
def test_an_impulse_of_a_joint_at_the_start_keeps_the_momentum(product, settings, moment, kind):
    """One of two equal bodies moves along their line: both go on with half of its velocity."""
    at_rest, moving = (Body((x, 0.0), 1.0, inertia=moment, v=(v, 0.0)) for x, v in ((0.0, 0.0), (1.0, 1.0)))
    model = make_model([at_rest, moving], (0.0, 0.0), [kind(0, 1, (0.5, 0.0))])
    if settings:
        with pytest.raises(BadInput, match="open a joint"):
            run(product, model, 0.1, 10, **settings)
        return
    found, _ = run(product, model, 0.1, 10)
    np.testing.assert_allclose(found.v, [[0.5, 0.0], [0.5, 0.0]], atol=1e-5)


@every
@pytest.mark.parametrize("joint", [Weld(0, WORLD, (0.0, 0.0)), Weld(0, 1, (0.5, 0.0))])
def test_a_weld_of_bodies_that_nothing_can_turn_holds_them(product, settings, joint):
    bodies = [Body((x, 0.0), 1.0, inertia=np.inf) for x in (0.0, 1.0)]
    found, _ = run(product, make_model(bodies, (0.0, -G if joint.b == WORLD else 0.0), [joint]), 0.1, 10, **settings)
    np.testing.assert_allclose(found.x[0], (0.0, 0.0), atol=1e-4)
    np.testing.assert_allclose(found.q, 0.0, atol=1e-9)


@every
def test_a_body_that_nothing_can_turn_keeps_its_angular_velocity(product, settings):
    model = make_model([Body((0.0, 0.0), 1.0, inertia=np.inf, omega=2.0)], (0.0, 0.0))
    found, _ = run(product, model, 0.5, 50, **settings)
    np.testing.assert_allclose((found.q[0], found.omega[0]), (1.0, 2.0), rtol=1e-4)


def test_the_first_velocities_that_open_a_joint_are_found_in_the_plane_and_in_space():
    def model(spin, v, kind=Hinge):
        bodies = [Body((0.0, 0.0), 1.0, inertia=1.0, omega=2.0), Body((1.0, 0.0), 1.0, inertia=1.0, v=v, omega=spin)]
        return make_model(bodies, (0.0, 0.0), [kind(0, 1, (0.5, 0.0))])
    closed = model(3.0, (0.0, 2.0 * 0.5 + 3.0 * 0.5))
    assert not derived.opens(closed) and derived.opens(model(3.0, (0.0, 2.4)))
    assert derived.opens(model(3.0, (0.0, 2.5), Weld)) and not derived.opens(model(2.0, (0.0, 2.0), Weld))
    rod = Body((0.5, 0.0, 0.0), 1.0, inertia=(0.1, 0.1, 0.1), v=(0.0, 0.5, 0.0), omega=(0.0, 0.0, 1.0))
    held = lambda body: make_model([body], (0.0, 0.0, 0.0), [BallJoint(0, WORLD, (0.0, 0.0, 0.0))])
    assert not derived.opens(held(rod)) and derived.opens(held(rod._replace(omega=(0.0, 0.0, 1.01))))
    turned = lambda *omega: make_model([rod._replace(v=(0.0, 0.0, 0.0), omega=omega)], (0.0, 0.0, 0.0),
                                       [Hinge(0, WORLD, rod.x, (0.6, 0.0, 0.8))])
    assert not derived.opens(turned(0.6, 0.0, 0.8)) and derived.opens(turned(0.6, 1e-3, 0.8))


# ---------------------------------------------------------------------------------------------- what a world reports

@every
def test_the_state_of_a_world_that_is_not_kept_can_be_read(product, settings):
    """Bodies of some engines end with their world: Python had crashed."""
    if not product.installed():
        pytest.skip(f"{product} is not installed: {product.remedy}")
    state = product.world.build(make_model([BALL], (0.0, -G)), 0.01, **settings).state
    np.testing.assert_allclose(state().x[0], BALL.x, atol=1e-6)
    pushes = product.world.build(make_model([BALL], (0.0, -G)), 0.01, **settings).pushes
    assert pushes() == []


@every
def test_contact_forces_carry_the_weight_and_the_load(product, settings):
    block = Body((0.0, 0.1), 2.0, Box((0.2, 0.1)), 0.5)
    model = make_model([FLOOR, block], (0.0, -G), loads=[Force(1, lambda t: (0.0, -3.0), "t")])
    _, pushes = run(product, model, 1.0, 200, **settings)
    if product is BOX2D:
        assert pushes == []                                # its binding does not report them
    elif product is not RAPIER:                            # its binding does not tell where friction points to
        assert sum(p.F[1] * (1 if p.a == 1 else -1) for p in pushes) == pytest.approx(2.0 * G + 3.0, rel=0.01)


@pytest.mark.parametrize("product", [MUJOCO, BOX2D], ids=str)
def test_the_force_of_a_hinge_carries_the_weight_and_the_load(product):
    hanging = make_model([Body((0.0, -0.5), 1.0, inertia=0.1)], (0.0, -G), [Hinge(0, WORLD, (0.0, 0.0))],
                         loads=[Force(0, lambda t: (0.0, -10.0), "t")])
    _, [push] = run(product, hanging, 0.1, 10)
    assert push.F[1] * (1 if push.a == 0 else -1) == pytest.approx(G + 10.0, rel=1e-3)
