"""Rods between two points in the composed loop, in the plane and in space, beside joints and contacts."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from solutions.given.compose import Settings, compose, run_parts, state_of
from solutions.given.rods import link_impulses
from solutions.support.model import (
    WORLD,
    Ball,
    BallJoint,
    Body,
    Box,
    Distance,
    HalfSpace,
    Hinge,
    make_model,
    model_energy,
    start_of,
    world_place,
)

G = 9.81                                       # [m/s²]


def down(d):
    return (0.0,) * (d - 1) + (-G,)


def at(d, x, z):
    """Return (x, z) in the plane, or a place in a vertical plane of space that no axis lies in."""
    return (x, z) if d == 2 else (0.6 * x, 0.8 * x, z)


def run(model, T, steps, **settings):
    """Return the State of all bodies after T [s]."""
    loop = compose(model, Settings(**settings))
    return state_of(loop, run_parts(loop, 0.0, loop.state, T / steps, steps))


def stretch(model, state):
    """Return by how much each Distance of a model is longer than at the start [m]."""
    def lengths(s):
        rods = [joint for joint in model.joints if isinstance(joint, Distance)]
        return np.array([np.linalg.norm(world_place(s, rod.a, rod.place_a) - world_place(s, rod.b, rod.place_b))
                         for rod in rods])
    return lengths(state) - lengths(start_of(model))


def test_only_models_with_rods_have_parts_for_them():
    bob, rod = Body((0.0, -1.0), 2.0, Ball(0.1)), Distance(0, WORLD, (0.0, 0.0), (0.0, 0.0))
    names = lambda *model: [part.step.__name__ for part in compose(make_model(*model)).parts]
    assert names([bob], down(2), [rod]) == ["accelerate_half", "close_with_rods", "move_and_turn", "accelerate_rest",
                                            "hold_with_rods"]
    soft = rod._replace(compliance=1e-3)
    assert names([bob], down(2), [soft]) == ["accelerate", "close_with_rods", "move_and_turn", "hold_with_rods"]
    wall = Body((-1.0, 0.0), shape=HalfSpace((1.0, 0.0), 1.0))
    assert names([bob, wall], down(2), [rod])[3] == "contact_impulses_with_rods"
    assert names([bob, wall], down(2), [Hinge(0, WORLD, (0.0, 0.0))])[3] == "contact_impulses_with_joints"


@pytest.mark.parametrize("d", [2, 3])
def test_a_bob_on_a_rod_swings_as_the_pendulum_equation_says_with_second_order(d):
    T, angle = 1.0, 1.2
    bob = Body(at(d, np.sin(angle), -np.cos(angle)), 2.0)
    model = make_model([bob], down(d), [Distance(0, WORLD, (0.0,) * d, (0.0,) * d)])
    truth = solve_ivp(lambda t, y: (y[1], -G * np.sin(y[0])), (0.0, T), (angle, 0.0), rtol=1e-12, atol=1e-12).y[0, -1]
    errors = []
    for steps in (40, 80):
        s = run(model, T, steps)
        assert np.linalg.norm(s.x[0]) == pytest.approx(1.0, rel=1e-13)
        errors.append(np.linalg.norm(s.x[0] - at(d, np.sin(truth), -np.cos(truth))))
    assert errors[0] / errors[1] == pytest.approx(4.0, rel=0.1)
    assert errors[1] < 2e-3


@pytest.mark.parametrize("d", [2, 3])
def test_a_beam_on_two_parallel_rods_moves_like_a_bob(d):
    """A beam that hangs on two equal rods does not turn: its centre swings on a circle.  Its own hinges are rods."""
    T, angle = 0.8, 0.7
    out = np.array(at(d, np.sin(angle), -np.cos(angle)))
    one = np.array(at(d, 0.5, 0.0))
    inertia = 0.3 if d == 2 else (0.3, 0.4, 0.5)
    model = make_model([Body(tuple(out), 1.5, inertia=inertia)], down(d), [
        Distance(0, WORLD, tuple(sign * one), tuple(sign * one)) for sign in (-1.0, 1.0)])
    s = run(model, T, 100)
    truth = solve_ivp(lambda t, y: (y[1], -G * np.sin(y[0])), (0.0, T), (angle, 0.0), rtol=1e-10, atol=1e-10).y[0, -1]
    assert s.x[0] == pytest.approx(np.array(at(d, np.sin(truth), -np.cos(truth))), abs=1e-3)
    assert np.max(np.abs(s.omega)) < 1e-9
    assert np.max(np.abs(stretch(model, s))) < 1e-13


@pytest.mark.parametrize("d", [2, pytest.param(3, marks=pytest.mark.long)])
@pytest.mark.parametrize("compliance", [1e-3, 1e-2])
def test_a_compliant_rod_is_a_spring_of_the_inverse_stiffness_with_first_order(d, compliance):
    """It hangs and is let go unstretched:  x = α m g (1 − cos ω t)  along itself."""
    m, T = 2.0, 0.3
    rate, errors = np.sqrt(1.0 / (compliance * m)), []
    model = make_model([Body(at(d, 0.0, -1.0), m)], down(d),
                       [Distance(0, WORLD, (0.0,) * d, (0.0,) * d, compliance)])
    for steps in (800, 1600):
        fallen = -1.0 - run(model, T, steps).x[0, -1]
        errors.append(abs(fallen - compliance * m * G * (1.0 - np.cos(rate * T))))
    assert errors[0] / errors[1] == pytest.approx(2.0, abs=0.25)
    assert errors[1] < 0.5 * rate * T / 1600 * rate * T * compliance * m * G


def test_a_rod_that_is_as_stiff_as_can_be_stays_calm_and_gives_way_by_alpha_times_its_force():
    m, alpha = 2.0, 1e-9                       # 22,000 oscillations per second, 60 steps per second
    model = make_model([Body((0.0, -1.0), m)], down(2), [Distance(0, WORLD, (0.0, 0.0), (0.0, 0.0), alpha)])
    s = run(model, 1.0, 60)
    assert -1.0 - s.x[0, 1] == pytest.approx(alpha * m * G, rel=1e-3)
    assert np.max(np.abs(s.v)) < 1e-6


@pytest.mark.parametrize("d", [2, 3])
def test_a_compliant_rod_does_not_ask_what_touches_elsewhere(d):
    """A bob on it falls by up to 2 m g α, and as far when a ball rests on a floor far away."""
    bob, place = Body(at(d, 0.0, -1.0), 1.0, inertia=1.0 if d == 2 else (1.0,) * 3), at(d, 0.0, 0.0)
    rod, ball = Distance(0, WORLD, (0.0,) * d, place, 0.01), Body(at(d, 5.0, 0.5), 1.0, Ball(0.5))
    floor = Body((0.0,) * d, shape=HalfSpace(at(d, 0.0, 1.0)), mu=1.0, e=1.0)
    alone, beside = (run(make_model(bodies, down(d), [rod]), 0.3, 300) for bodies in ([bob], [bob, ball, floor]))
    assert beside.x[0] == pytest.approx(alone.x[0], abs=1e-9)
    assert beside.v[0] == pytest.approx(alone.v[0], abs=1e-9)


@pytest.mark.parametrize("d", [2, 3])
def test_a_compliant_rod_and_a_floor_share_a_weight(d):
    """A ball hangs 2 cm above the floor on a rod that would give way by 4 cm: each carries half of it."""
    m, gap = 2.0, 0.02
    place = at(d, 0.0, 1.0)
    model = make_model([Body(at(d, 0.0, 0.1 + gap), m, Ball(0.1)), Body((0.0,) * d, shape=HalfSpace(at(d, 0.0, 1.0)))],
                       down(d), [Distance(0, WORLD, (0.0,) * d, place, 2.0 * gap / (m * G))])
    loop, dt = compose(model), 1e-3
    before, after = loop.state, run_parts(loop, 0.0, loop.state, dt, 1)
    for k in range(1, 500):
        before, after = after, run_parts(loop, k * dt, after, dt, 1)
    assert after.J[0] / dt == pytest.approx(at(d, 0.0, 0.5 * m * G), abs=1e-3 * m * G)
    assert link_impulses(loop.load, 0.499, before, after, dt, loop.p)[-1] / dt == pytest.approx(
        at(d, 0.0, 0.5 * m * G), abs=1e-3 * m * G)


@pytest.mark.parametrize("d", [2, 3])
def test_rods_and_joints_close_a_loop_and_keep_the_energy(d):
    """A crank on a hinge drives a bar by a rod whose other end is on the bar; the bar hangs on a ball joint."""
    axis = {} if d == 2 else {"axis": (0.8, -0.6, 0.0)}
    inertia = 0.05 if d == 2 else (0.05, 0.05, 0.05)
    zero = (0.0,) * d
    crank, bar = Body(at(d, 0.3, 0.0), 1.0, inertia=inertia), Body(at(d, 1.5, -0.5), 2.0, inertia=inertia)
    joints = [Hinge(0, WORLD, zero, **axis), (Hinge if d == 2 else BallJoint)(1, WORLD, at(d, 1.5, 0.0)),
              Distance(0, 1, at(d, 0.3, 0.0), at(d, 0.0, -0.2))]
    model = make_model([crank, bar], down(d), joints)
    s = run(model, 0.5, 100)
    assert np.max(np.abs(stretch(model, s))) < 1e-12
    assert np.linalg.norm(s.v) > 0.5
    assert model_energy(model, s) == pytest.approx(model_energy(model, start_of(model)), abs=2e-3 * G)
    if d == 3:
        assert np.max(np.abs(s.x @ (0.8, -0.6, 0.0))) < 1e-9             # all stays in the plane of the crank


@pytest.mark.parametrize("d", [2, 3])
def test_bodies_on_a_rod_still_collide_and_its_force_is_told(d):
    """A ball hangs on a rod and touches a wall beside it: the rod carries its weight, the wall what leans on it."""
    lean = 0.3
    wall = Body((0.0,) * d, shape=HalfSpace(at(d, 1.0, 0.0)), mu=1.0, e=1.0)
    ball = Body(at(d, 0.2, -1.0), 2.0, Ball(0.2))
    top = at(d, 0.2 - np.tan(lean), 0.0)                               # the rod leans from the wall
    model = make_model([ball, wall], down(d), [Distance(0, WORLD, (0.0,) * d, top)])
    loop = compose(model, Settings(sweeps=500, settled=1e-12))
    before = after = loop.state
    for _ in range(20):
        before, after = after, run_parts(loop, 0.0, after, 1e-2, 1)
    (F,) = link_impulses(loop.load, 0.0, before, after, 1e-2, loop.p) / 1e-2
    weight = 2.0 * G
    assert F == pytest.approx(np.array(at(d, -weight * np.tan(lean), weight)), abs=1e-6 * weight)
    assert after.J[0] / 1e-2 == pytest.approx(np.array(at(d, weight * np.tan(lean), 0.0)), abs=1e-6 * weight)


def test_a_rope_of_rods_carries_a_box_off_the_floor():
    """Rods pull over several bodies: each carries all that is below it."""
    ropes = [Body((0.0, -0.5 * k), 0.2) for k in (1, 2, 3)]
    box = Body((0.0, -2.2), 1.0, Box((0.3, 0.2)), mu=0.5)
    floor = Body((0.0, -3.0), shape=HalfSpace((0.0, 1.0), 3.0), mu=1.0, e=1.0)
    rods = [Distance(0, WORLD, (0.0, 0.0), (0.0, 0.0)), Distance(1, 0, (0.0, 0.0), (0.0, 0.0)),
            Distance(2, 1, (0.0, 0.0), (0.0, 0.0)), Distance(3, 2, (0.0, 0.2), (0.0, 0.0))]
    model = make_model([*ropes, box, floor], down(2), rods)
    loop = compose(model)
    before = run_parts(loop, 0.0, loop.state, 1e-2, 4)
    after = run_parts(loop, 0.0, before, 1e-2, 1)
    F = link_impulses(loop.load, 0.0, before, after, 1e-2, loop.p) / 1e-2
    assert F[:, 1] == pytest.approx(G * np.array([1.6, 1.4, 1.2, 1.0]), abs=1e-6)
