"""The composed loop with convex polyhedra: closed forms, balances, and boxes that are written as polyhedra."""

import numpy as np
import pytest

from solutions.given.compose import Settings, compose, run_parts, state_of
from solutions.simulator import momenta
from solutions.support.model import (
    Ball,
    Body,
    Box,
    Capsule,
    Polyhedron,
    make_model,
    model_energy,
    rotation_of,
)
from solutions.support.shapes import face_planes, hull_faces, polyhedron_of

from .test_compose_space import DOWN, GROUND, NO_GRAVITY, G, about

TETRAHEDRON = 0.2 * np.array([(1.0, 1.0, 1.0), (1.0, -1.0, -1.0), (-1.0, 1.0, -1.0), (-1.0, -1.0, 1.0)])
OCTAHEDRON = 0.3 * np.concatenate((np.eye(3), -np.eye(3)))
IRREGULAR = 0.3 * np.random.default_rng(4).normal(size=(8, 3))
HULLS = TETRAHEDRON, OCTAHEDRON, IRREGULAR
EXACT = {"settled": 1e-10, "sweeps": 2000}     # of impulses that are compared with a closed form


def hull(places, at=(0.0, 0.0, 0.0), m=1.0, **more):
    """Return the Body of the convex hull of places, moved by `at`."""
    shape, x, q = polyhedron_of(np.add(places, at))
    return Body(tuple(x), m, shape, q=tuple(q), **more)


def box_corners(half):
    """Return the corners of a box."""
    return [(x, y, z) for z in (-half[2], half[2]) for y in (-half[1], half[1]) for x in (-half[0], half[0])]


def pyramid(base, height):
    """Return the corners of a square pyramid that stands on z = 0; its centre of mass is at a quarter of its height."""
    return [(x, y, 0.0) for x in (-base, base) for y in (-base, base)] + [(0.0, 0.0, height)]


def history(model, dt, steps, **settings):
    """Return (Loop, [PileState after each step])."""
    loop, states = compose(model, Settings(**settings)), []
    state = loop.state
    for k in range(steps):
        state = run_parts(loop, k * dt, state, dt, 1)
        states.append(state)
    return loop, states


def free_momenta(model, loop, state):
    """Return momentum and angular momentum of all bodies that can move."""
    s, free = state_of(loop, state), np.isfinite([body.m for body in model.bodies])
    p = loop.p._replace(inv_mass=loop.p.inv_mass[loop.row][free], inv_inertia=loop.p.inv_inertia[loop.row][free])
    return momenta(s.x[free], s.q[free], s.v[free], s.omega[free], p)


# ---------------------------------------------------------------------------------------------- balances

@pytest.mark.parametrize("e", [0.0, 0.7])
def test_hulls_that_meet_in_flight_keep_both_momenta_and_gain_no_energy(e):
    """With friction.  A free asymmetric body keeps its energy to the second order of the step only.

    Bodies that overlap move apart and keep their velocities, which changes the angular momentum by some mm kg m/s.
    """
    bodies = [hull(places, (0.8 * k, 0.1 * k, 0.0), 1.0 + k, mu=0.5, e=e, v=(1.5 - 1.5 * k, 0.0, 0.1),
                   omega=(0.5, k, 0.3)) for k, places in enumerate(HULLS)]
    model, touched = make_model(bodies, NO_GRAVITY), 0.0
    loop, states = history(model, 4e-3, 80)
    P, L = free_momenta(model, loop, loop.state)
    energies = [model_energy(model, state_of(loop, state)) for state in (loop.state, *states)]
    for state in states:
        touched += np.sum(np.linalg.norm(state.J, axis=1))
        assert free_momenta(model, loop, state)[0] == pytest.approx(P, abs=1e-12)
        assert free_momenta(model, loop, state)[1] == pytest.approx(L, abs=2e-3)
    assert touched > 0.3
    assert np.max(energies - np.minimum.accumulate(energies)) < 1e-3 * energies[0]


def test_hulls_dropped_without_friction_get_vertical_impulses_only():
    """Momentum: m (v + g t) is the sum of all impulses.  The vertical angular momentum stays.  No energy is gained."""
    bodies = [hull(places, (1.5 * k, 0.0, 0.6), v=(0.2 * k, 0.1, 0.0), omega=(1.0, 0.5, 2.0))
              for k, places in enumerate(HULLS)]
    model, dt, pushed = make_model([*bodies, GROUND], DOWN), 4e-3, np.zeros(3)
    loop, states = history(model, dt, 120)
    P, L = free_momenta(model, loop, loop.state)
    energies = [model_energy(model, state_of(loop, state)) for state in (loop.state, *states)]
    for k, state in enumerate(states):
        pushed = pushed + np.sum(state.J, axis=0)
        momentum, angular = free_momenta(model, loop, state)
        assert momentum == pytest.approx(P + pushed + (k + 1) * dt * 3.0 * np.array(DOWN), abs=1e-11)
        assert angular[2] == pytest.approx(L[2], abs=1e-11)
    assert pushed[2] > 5.0 and np.max(np.abs(pushed[:2])) < 1e-12
    fall = 0.5 * dt * 3.0 * G * dt * 120 * G                   # symplectic Euler's own, ½ dt Σ m g per fall by g t
    assert np.max(energies) < energies[0] + fall
    assert energies[-1] < energies[0] - 3.0


# ---------------------------------------------------------------------------------------------- rest and sliding

def lying(places):
    """Return places turned so that a face of their hull lies on z = 0 and their centre is over it."""
    shape, _, _ = polyhedron_of(places)
    corners, loops = np.array(shape.corners), hull_faces(shape.corners)
    planes = face_planes(corners, loops)
    n = planes[np.argmax(planes[:, 3]), :3]                    # of the face that is nearest to the centre
    side = np.cross(n, np.eye(3)[np.argmin(np.abs(n))])
    side = side / np.linalg.norm(side)
    turned = corners @ np.stack((side, np.cross(-n, side), -n)).T
    return turned - (0.0, 0.0, np.min(turned[:, 2]))


@pytest.mark.parametrize("places", HULLS, ids=["tetrahedron", "octahedron", "irregular"])
def test_a_hull_on_a_face_stays_and_its_contacts_carry_its_weight_without_torque(places):
    m, dt = 2.0, 1.0 / 240.0
    body = hull(lying(places), m=m, mu=0.5)
    loop, states = history(make_model([GROUND, body], DOWN), dt, 120, **EXACT)
    s, last = state_of(loop, states[-1]), states[-1]
    assert s.x[1] == pytest.approx(body.x, abs=1e-7)
    assert 1.0 - abs(s.q[1] @ body.q) < 1e-12
    assert last.contacts.a.size >= 3
    assert np.sum(last.J, axis=0) / dt == pytest.approx((0.0, 0.0, m * G), abs=1e-6)
    torque = np.sum(np.cross(last.contacts.p - s.x[1], last.J), axis=0) / dt
    assert torque == pytest.approx(np.zeros(3), abs=1e-6)


@pytest.mark.parametrize("places", [TETRAHEDRON, OCTAHEDRON], ids=["tetrahedron", "octahedron"])
def test_a_hull_that_slides_stops_where_its_kinetic_energy_is_used_up(places):
    """v²/(2 μ g), and symplectic Euler slides ½ dt v less.  Its weight does not leave its base."""
    v, mu, dt = 1.0, 0.3, 2e-3
    body = hull(lying(places), mu=mu, v=(v, 0.0, 0.0))
    loop, states = history(make_model([GROUND, body], DOWN), dt, 200, **EXACT)
    s = state_of(loop, states[-1])
    assert s.x[1, 0] - body.x[0] == pytest.approx(v * v / (2.0 * mu * G) - 0.5 * dt * v, abs=1e-5)
    assert np.max(np.abs(s.v[1])) < 1e-6
    assert s.x[1, 2] == pytest.approx(body.x[2], abs=1e-6)


@pytest.mark.parametrize(("share", "tips"), [(0.93, False), (1.07, True)])
def test_a_pyramid_tips_where_its_line_of_gravity_leaves_its_base(share, tips):
    """tan α = base/(height/4): its centre of mass is at a quarter of its height."""
    base, height = 0.2, 1.2
    alpha = np.arctan(share * 4.0 * base / height)
    body = hull(np.array(pyramid(base, height)), mu=2.0)
    slope = (G * np.sin(alpha), 0.0, -G * np.cos(alpha))
    loop, states = history(make_model([GROUND, body], slope), 4e-3, 150, settled=1e-6, sweeps=300)
    s = state_of(loop, states[-1])
    moved = np.linalg.norm(s.x[1] - body.x)
    assert moved > 0.01 if tips else moved < 1e-4


# ---------------------------------------------------------------------------------------------- boxes as polyhedra

def test_a_polyhedron_with_the_corners_of_a_box_tumbles_over_a_plane_as_the_box_does():
    half, ends = (0.3, 0.2, 0.1), []
    for shape in (Box(half), Polyhedron(tuple(box_corners(half)))):
        body = Body((0.0, 0.0, 0.5), 1.0, shape, mu=0.4, e=0.5, q=about((1.0, 2.0, 3.0), 0.7), v=(1.0, 0.3, -1.0),
                    omega=(1.0, 5.0, 2.0))
        loop, states = history(make_model([body, GROUND], DOWN), 2e-3, 300)
        ends.append(state_of(loop, states[-1]))
        assert sum(state.contacts.a.size > 0 for state in states) > 50
    for box, solid in zip(*ends, strict=True):
        assert solid == pytest.approx(box, abs=1e-10)


def test_a_tower_of_polyhedra_with_the_corners_of_boxes_stands_as_the_boxes_do():
    """Contacts come in another order, and sweeps that end early tell orders apart: these go on until they settle."""
    half, ends = (0.3, 0.2, 0.1), []
    for shape in (Box(half), Polyhedron(tuple(box_corners(half)))):
        bodies = [Body((0.03 * k, 0.0, 0.1 + 0.2001 * k), 1.0, shape, mu=0.5) for k in range(3)]
        loop, states = history(make_model([GROUND, *bodies], DOWN), 1.0 / 240.0, 20, **EXACT)
        ends.append(state_of(loop, states[-1]))
    assert ends[1].x == pytest.approx(ends[0].x, abs=1e-7)
    assert ends[1].v == pytest.approx(ends[0].v, abs=1e-5)


# ---------------------------------------------------------------------------------------------- several bodies

@pytest.mark.parametrize("upper", [Ball(0.2), Capsule(0.2, 0.1), Box((0.2, 0.15, 0.1)), Polyhedron(tuple(OCTAHEDRON))],
                         ids=lambda shape: type(shape).__name__)
def test_a_body_of_any_shape_comes_to_rest_on_a_prism_that_carries_both_weights(upper):
    """A prism of six sides and 0.4 m.  The octahedron lies on a face."""
    angles = np.arange(6) * np.pi / 3.0
    places = [(0.8 * np.cos(a), 0.8 * np.sin(a), z) for a in angles for z in (0.0, 0.4)]
    height = {Ball: 0.2, Capsule: 0.1, Box: 0.1, Polyhedron: 0.3 / np.sqrt(3.0)}[type(upper)]
    q = about((1.0, -1.0, 0.0), np.arccos(1.0 / np.sqrt(3.0))) if isinstance(upper, Polyhedron) else None
    above = Body((0.1, 0.05, 0.4 + height), 1.0, upper, mu=0.7, q=q)
    loop, states = history(make_model([GROUND, hull(places, m=5.0, mu=0.7), above], DOWN), 1.0 / 240.0, 60)
    s, last = state_of(loop, states[-1]), states[-1]
    assert np.max(np.abs(s.v)) < 1e-3
    assert s.x[1] == pytest.approx((0.0, 0.0, 0.2), abs=2e-3)
    assert s.x[2] == pytest.approx(above.x, abs=2e-3)
    assert sum(J[2] for b, J in zip(last.contacts.b, last.J, strict=True) if b == 2) * 240.0 == pytest.approx(
        6.0 * G, rel=2e-2)


@pytest.mark.long
def test_piles_of_hulls_and_of_boxes_overlap_no_more_than_a_fall_goes_in_a_step():
    """Three drops of four bodies.  The limit is the last step of a free fall that takes as long as the run."""
    deepest, dt, steps = [], 1.0 / 240.0, 240
    for shapes in ((Polyhedron(tuple(OCTAHEDRON)), Polyhedron(tuple(TETRAHEDRON))),
                   (Box((0.2, 0.2, 0.2)), Box((0.3, 0.15, 0.1)))):
        deepest.append(0.0)
        for seed in range(3):
            rng = np.random.default_rng(seed)
            bodies = [Body((*rng.uniform(-0.1, 0.1, 2), 0.4 + 0.72 * k), 1.0, shapes[k % 2], mu=0.5,
                           q=about(rng.normal(size=3), rng.uniform(0.0, 3.0))) for k in range(4)]
            loop, states = history(make_model([GROUND, *bodies], DOWN), dt, steps)
            deepest[-1] = max(deepest[-1], *[np.max(-state.contacts.gap, initial=0.0) for state in states])
    assert max(deepest) < loop.p.slop + G * steps * dt * dt


def test_hulls_that_begin_inside_each_other_part_without_kinetic_energy():
    bodies = [GROUND, hull(OCTAHEDRON, (0.0, 0.0, 0.2), mu=0.5), hull(TETRAHEDRON, (0.1, 0.05, 0.5), mu=0.5),
              Body((0.25, 0.0, 0.2), 1.0, Capsule(0.2, 0.1), mu=0.5)]
    loop = compose(make_model(bodies, NO_GRAVITY))
    state = loop.state
    for _ in range(120):
        state = run_parts(loop, 0.0, state, 1.0 / 240.0, 1)
        assert not np.any(state.v) and not np.any(state.omega)
    assert state.contacts.gap.min() > -1.1 * loop.p.slop
    assert np.max(np.abs(loop.state.x - state.x)) > 0.05               # they did move


def test_a_fast_hull_does_not_pass_through_a_plate():
    plate = Body((0.0, 0.0, 0.0), shape=Box((1.0, 1.0, 0.02)), mu=1.0, e=1.0)
    body = hull(TETRAHEDRON, (0.1, 0.1, 1.0), v=(0.0, 0.0, -100.0))
    loop, states = history(make_model([plate, body], NO_GRAVITY), 0.02, 3)
    assert state_of(loop, states[-1]).x[1, 2] > 0.0


def test_a_polyhedron_turns_about_its_principal_axes_when_it_lies_askew():
    """A hull of places that are moved and turned has the pose that puts its corners back there."""
    R, at = rotation_of(np.array(about((1.0, 2.0, 3.0), 1.0))), np.array((1.0, -2.0, 3.0))
    body = hull(IRREGULAR @ R.T, at)
    back = np.array(body.shape.corners) @ rotation_of(np.array(body.q)).T + body.x
    far = np.min(np.linalg.norm((IRREGULAR @ R.T + at)[:, None] - back, axis=2), axis=0)
    assert np.max(far) < 1e-12
