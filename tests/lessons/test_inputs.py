"""Constructors and loops take what a person writes: whole numbers and lists are converted, and what has no physics is refused with its value."""

import numpy as np
import pytest

from solutions import collisions, friction, impulses, integrators, pbd, rotation, springs
from solutions.checks import BadInput, Diverged
from validate import modules

UP, DOWN = np.array([0.0, 0.0, 1.0]), np.array([0.0, 0.0, -9.81])
ROPE, PAIRS, WEIGHT = np.array([[0.0, 0.0], [1.0, 0.0], [2.0, 0.0]]), np.array([[0, 1], [1, 2]]), np.array([0.0, -9.81])
ROUND_OFF = 1e-12            # lengths of about a metre, after a few hundred steps that each round by 1e-16


# ---------------------------------------------------------------------------------------------- whole numbers

def test_a_mesh_of_whole_numbers_moves_as_one_of_floats():
    mesh = springs.make_mesh([[0, 0], [1, 0], [2, 0]], 1, [0], [(0, 1), (1, 2)], 50, 1, [0, -10], [0, 0], 0)
    x, v = np.array([[0, 0], [1, 0], [2, 0]]), np.zeros((3, 2), dtype=int)
    for step in (integrators.euler_step, integrators.implicit_euler_step, springs.implicit_mesh_step):
        whole = integrators.advance(step, springs.mesh_acceleration, 0, x, v, 0.01, 20, mesh)
        floats = integrators.advance(step, springs.mesh_acceleration, 0.0, 1.0 * x, 1.0 * v, 0.01, 20, mesh)
        assert np.array_equal(whole, floats) and whole[1].any()


def test_a_rope_of_whole_numbers_falls():
    net = pbd.make_net([[0, 0], [1, 0], [2, 0]], 1, [0], [(0, 1), (1, 2)], 0, 1, [0, -10], 3)
    x, v = np.array([[0, 0], [1, 0], [2, 0]]), np.zeros((3, 2), dtype=int)
    for step in (pbd.pbd_step, pbd.xpbd_step, pbd.projection_step, pbd.rattle_step):
        whole = step(pbd.falling_acceleration, 0.0, x, v, 0.1, net)
        assert np.array_equal(whole, step(pbd.falling_acceleration, 0.0, 1.0 * x, 1.0 * v, 0.1, net)) and whole[0][2, 1] < 0.0


def test_a_ball_dropped_from_a_whole_height_is_where_gravity_takes_it():
    drop = impulses.Drop(0.8, DOWN, np.zeros(3), UP, 1e4, 0.0)
    x, _ = impulses.drop_all(impulses.backtracking_step, impulses.falling_acceleration, 0, np.array([[0, 0, 1]]), np.zeros((1, 3), dtype=int), 0.1, 1, drop)
    assert abs(x[0, 2] - (1.0 - 0.5 * 9.81 * 0.01)) < ROUND_OFF


def test_whole_axes_are_turned_like_any_others():
    """A quarter turn about z takes x to y."""
    turned = rotation.axis_angle_update(np.eye(3, dtype=int), np.array([0.0, 0.0, 0.5 * np.pi]), 1.0)
    assert np.allclose(turned, [[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]], rtol=0.0, atol=ROUND_OFF)


# ---------------------------------------------------------------------------------------------- energy out of nothing

def test_no_loop_starts_with_a_parameter_that_makes_energy():
    ball = friction.OnPlane(1.0, 0.3, 0.8, DOWN, np.zeros(3), UP)
    run = friction.contact_step, friction.falling_acceleration, friction.plane_gap, 0.0, UP, np.zeros(3), 0.001, 100
    for wrong in (ball._replace(n=2.0 * UP), ball._replace(e=1.2), ball._replace(mu=-0.3), ball._replace(m=-1.0), ball._replace(mu=np.nan)):
        with pytest.raises(BadInput):
            friction.contact_motion(*run, wrong)


ROLLING = rotation.Ball(1.0, 0.4 * np.ones(3), 1.0, 0.3, DOWN, 0.01)


def roll(ball, steps=100):
    return rotation.move(rotation.rigid_body_step, rotation.rolling_load, 0.0, np.zeros(3), np.array([1.0, 0.0, 0.0]), np.array([1.0, 0.0, 0.0, 0.0]), np.zeros(3),
                         0.01, steps, ball)


def test_friction_of_a_rolling_ball_is_refused_where_it_would_push():
    for mu in (-0.3, np.nan):
        with pytest.raises(BadInput, match="friction μ"):
            roll(ROLLING._replace(mu=mu))


def test_a_floor_never_pulls():
    """Gravity away from the floor: the ball flies off with g, and keeps its speed along the floor."""
    x, v, _, omega = roll(ROLLING._replace(gravity=-DOWN))
    assert abs(v[2] - 9.81) < 1e-9 and v[0] == 1.0 and not omega.any()


# ---------------------------------------------------------------------------------------------- points that are none

@pytest.mark.parametrize("make", [
    lambda fixed, pairs, gravity: springs.make_mesh(ROPE, 1.0, fixed, pairs, 50.0, 0.0, gravity, np.zeros(2), 0.0),
    lambda fixed, pairs, gravity: pbd.make_net(ROPE, 1.0, fixed, pairs, 0.0, 1.0, gravity, 3)], ids=["mesh", "net"])
@pytest.mark.parametrize("fixed, pairs, gravity, value", [
    ([0], PAIRS, np.array([0.0, 0.0, -9.81]), "(3,)"), ([-1], PAIRS, WEIGHT, "-1"), ([3], PAIRS, WEIGHT, "3"), ([0.5], PAIRS, WEIGHT, "0.5"),
    ([0], [(0, -1)], WEIGHT, "-1"), ([0], [(0, 7)], WEIGHT, "7"), ([0], [(0, 1, 2)], WEIGHT, "(1, 3)"), ([0], [(0, 0)], WEIGHT, "0")])
def test_a_point_or_a_dimension_that_does_not_exist_is_named(make, fixed, pairs, gravity, value):
    with pytest.raises(BadInput) as said:
        make(fixed, pairs, gravity)
    assert value in str(said.value)


# ---------------------------------------------------------------------------------------------- redundant links

@pytest.mark.parametrize("step", [pbd.projection_step, pbd.rattle_step])
@pytest.mark.parametrize("x, links, more", [
    (ROPE[:2], [(0, 1)], [(0, 1)]),                                                        # a link given twice
    (np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]), [(0, 1), (1, 2), (2, 3), (3, 0), (0, 2)], [(1, 3)])], ids=["twice", "both diagonals"])
def test_a_redundant_link_changes_nothing(step, x, links, more):
    """The second truss has the freedom of the first and its constraints: the same motion, to 100 steps of the round-off of λ/TRACE."""
    ends = []
    for pairs in (links, links + more):
        net = pbd.make_net(x, 1.0, [0], pairs, 0.0, 1.0, WEIGHT, 1)
        ends.append(integrators.advance(step, pbd.falling_acceleration, 0.0, x, np.zeros_like(x), 0.01, 100, net))
    assert np.allclose(*ends, rtol=0.0, atol=1e-9) and np.abs(ends[0][0] - x).max() > 0.1


@pytest.mark.parametrize("step", [pbd.projection_step, pbd.rattle_step])
def test_a_rope_that_is_taut_across_its_load_is_refused(step):
    """No finite tension carries a load across a straight rope between two fixed ends."""
    net = pbd.make_net(ROPE, 1.0, [0, 2], PAIRS, 0.0, 1.0, WEIGHT, 1)
    with pytest.raises(Diverged, match="did not converge"):
        step(pbd.falling_acceleration, 0.0, ROPE, np.zeros((3, 2)), 0.01, net)


# ---------------------------------------------------------------------------------------------- sizes

@pytest.mark.parametrize("size", [1e-90, 1e-61, 1e-8, 1.0, 1e8, 1e61, 1e90])
def test_gjk_knows_bodies_of_any_size(size):
    corner = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])
    apart = collisions.gjk(size * corner, size * (corner + np.array([3.0, 0.0, 0.0])))
    assert abs(apart.gap / size - 2.0) < ROUND_OFF
    assert abs(collisions.gjk(size * corner, size * (corner + 0.1)).gap / size) < ROUND_OFF


def test_gjk_refuses_sizes_whose_squares_are_no_numbers():
    corner = np.eye(3)
    for size in (1e-200, 1e200):
        with pytest.raises(BadInput, match="size"):
            collisions.gjk(size * corner, size * (corner + 3.0))


@pytest.mark.parametrize("speed", ["plain", "compiled"])
def test_no_time_at_all_is_refused_by_a_multiplier(speed):
    if speed == "compiled" and not modules.can_compile():
        pytest.skip("numba has no wheel for this machine")
    with pytest.raises(BadInput, match="step dt"):
        modules.bind("impulses", compiled=speed == "compiled").gap_multiplier(0.1, -1.0, 1.0, 0.0)


# ---------------------------------------------------------------------------------------------- impacts at several points

def energy(body):
    return 0.5 * body.v @ body.v / body.inv_mass + 0.5 * body.omega @ np.linalg.solve(body.inv_inertia, body.omega)


def rotation_of(rng):
    Q, R = np.linalg.qr(rng.normal(size=(3, 3)))
    return Q * np.sign(np.diag(R)) * np.sign(np.linalg.det(Q * np.sign(np.diag(R))))


def test_a_ball_that_rolls_and_a_box_that_tips_settle_at_once():
    """Their contact point stands still while the body moves: rounding follows |v| + |ω||r|, and so does the residual."""
    rng = np.random.default_rng(7)
    for _ in range(100):
        radius, v = rng.uniform(0.01, 1.0), np.append(rng.normal(size=2) * 10.0, -(10.0 ** rng.uniform(-6.0, 0.0)))
        ball = impulses.Solid(v, np.cross(UP, v) / radius, 1.0, np.eye(3) / (0.4 * radius**2))
        after, residual = impulses.solve_impacts(ball, -radius * UP[None], UP[None], 0.0, rng.uniform(0.0, 1.0))
        assert residual <= impulses.SETTLED * 2.0 * np.linalg.norm(v) and abs(after.v[2]) <= ROUND_OFF
    for _ in range(40):
        half, R, spin = rng.uniform(0.1, 0.5, 3), rotation_of(rng), rng.uniform(1.0, 20.0)
        edge = np.array([[-1.0, 1.0, -1.0], [-1.0, -1.0, -1.0]]) * half @ R.T               # about which it tips
        omega = spin * R[:, 1]
        push = impulses.Solid(-np.cross(omega, edge[0]) - 1e-3 * R[:, 2], omega, 1.0, R @ np.diag(3.0 / (half @ half - half**2)) @ R.T)
        _, residual = impulses.solve_impacts(push, edge, np.stack((R[:, 2], R[:, 2])), 0.0, 0.5)
        assert residual <= impulses.SETTLED * 2.0 * (np.linalg.norm(push.v) + spin)


def test_where_the_law_of_an_impact_has_no_answer_the_fallback_is_physical_and_says_so():
    """Boxes on two to four of their corners, with friction of 1.5 and more: inside the cone, no energy gained, nothing goes in."""
    rng, fell_back = np.random.default_rng(9), 0
    for _ in range(5):
        half, R = rng.uniform(0.05, 0.5, 3), rotation_of(rng)
        corners = np.array([(a, b, c) for a in (-1.0, 1.0) for b in (-1.0, 1.0) for c in (-1.0, 1.0)])[rng.choice(8, rng.integers(2, 5), replace=False)] * half
        r, n = corners @ R.T, rotation_of(rng)[0]
        body = impulses.Solid(3.0 * rng.normal(size=3) - 3.0 * n, 5.0 * rng.normal(size=3), 1.0, R @ np.diag(3.0 / (half @ half - half**2)) @ R.T)
        e, mu = rng.choice([0.0, 0.5, 1.0]), rng.choice([1.5, 3.0, np.inf])
        after, residual = impulses.solve_impacts(body, r, np.tile(n, (len(r), 1)), e, mu)
        speed = impulses.largest_speed(body, r)
        if residual <= impulses.SETTLED * speed:
            continue
        fell_back += 1
        J, leaves = (after.v - body.v) / body.inv_mass, (after.v + np.cross(after.omega, r)) @ n
        assert energy(after) <= energy(body) * (1.0 + ROUND_OFF)
        assert leaves.min() >= -1e-3 * speed                                                # what 5,000 sweeps leave of the convex problem
        assert np.linalg.norm(J - (J @ n) * n) <= mu * (J @ n) * (1.0 + ROUND_OFF)           # a sum of impulses in cones about one n
    assert fell_back >= 2


def test_two_bodies_that_cannot_be_moved_along_some_direction_are_refused():
    with pytest.raises(BadInput, match="determinant of K"):
        impulses.cone_impulse(-UP, UP, np.diag([0.0, 1.0, 1.0]), 0.0, 0.3)
