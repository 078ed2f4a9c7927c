"""Constructors and loops convert whole numbers and lists, and refuse impossible values by name."""

import numpy as np
import pytest

from solutions import checks
from solutions.checks import BadInput, Diverged
from validate.subject import modules

collisions, contact, friction, impulses, integrators, pbd, rotation, simulator, springs = map(modules.bind, (
    "collisions", "contact", "friction", "impulses", "integrators", "pbd", "rotation", "simulator", "springs"))
UP, DOWN = np.array([0.0, 0.0, 1.0]), np.array([0.0, 0.0, -9.81])
ROPE, PAIRS = np.array([[0.0, 0.0], [1.0, 0.0], [2.0, 0.0]]), np.array([[0, 1], [1, 2]])
WEIGHT = np.array([0.0, -9.81])
ROUND_OFF = 1e-12            # lengths of about a metre, after a few hundred steps with a round-off of 1e-16 each


# ---------------------------------------------------------------------------------------------- whole numbers

def test_a_mesh_of_whole_numbers_moves_as_one_of_floats():
    mesh = springs.make_spring_network([[0, 0], [1, 0], [2, 0]], 1, [0], [(0, 1), (1, 2)], 50, 1, [0, -10], [0, 0], 0)
    x, v = np.array([[0, 0], [1, 0], [2, 0]]), np.zeros((3, 2), dtype=int)
    for step in (integrators.euler_step, integrators.implicit_euler_step, springs.implicit_spring_network_step):
        whole = integrators.advance(step, springs.spring_network_acceleration, 0, x, v, 0.01, 20, mesh)
        floats = integrators.advance(step, springs.spring_network_acceleration, 0.0, 1.0 * x, 1.0 * v, 0.01, 20, mesh)
        assert np.array_equal(whole, floats) and whole[1].any()


def test_text_is_no_number():
    with pytest.raises(BadInput, match="not a number"):
        checks.finite_number("mass m [kg]", "1")
    assert checks.finite_number("mass m [kg]", np.int64(1)) == 1.0


def test_a_rope_of_whole_numbers_falls():
    net = pbd.make_constraint_network([[0, 0], [1, 0], [2, 0]], 1, [0], [(0, 1), (1, 2)], 0, 1, [0, -10], 3)
    x, v = np.array([[0, 0], [1, 0], [2, 0]]), np.zeros((3, 2), dtype=int)
    for step in (pbd.pbd_step, pbd.xpbd_step, pbd.constraint_projection_step, pbd.rattle_step):
        whole = step(pbd.network_gravity, 0.0, x, v, 0.1, net)
        floats = step(pbd.network_gravity, 0.0, 1.0 * x, 1.0 * v, 0.1, net)
        assert np.array_equal(whole, floats) and whole[0][2, 1] < 0.0


def test_a_ball_dropped_from_a_whole_number_height_falls_under_gravity():
    drop = impulses.BouncingBall(0.8, DOWN, np.zeros(3), UP, 1e4, 0.0)
    x, _ = impulses.advance_balls(impulses.backtracking_step, impulses.falling_acceleration, 0,
                             np.array([[0, 0, 1]]), np.zeros((1, 3), dtype=int), 0.1, 1, drop)
    assert abs(x[0, 2] - (1.0 - 0.5 * 9.81 * 0.01)) < ROUND_OFF


def test_axes_of_whole_numbers_rotate_like_axes_of_floats():
    """A quarter turn about z takes x to y."""
    turned = rotation.axis_angle_update(np.eye(3, dtype=int), np.array([0.0, 0.0, 0.5 * np.pi]), 1.0)
    assert np.allclose(turned, [[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]], rtol=0.0, atol=ROUND_OFF)


def test_one_step_of_whole_numbers_is_that_of_floats():
    """These steps are called without a loop, which would convert the state."""
    oscillator = integrators.Oscillator(3.0, 0.0)
    state, p = two_balls("make_bodies")
    x, q, v = np.array([[0, 0, 1], [0, 0, 2], [0, 0, 0]]), np.tile([1, 0, 0, 0], (3, 1)), np.zeros((3, 3), dtype=int)
    omega = np.array([[1, 2, 3], [3, 0, 1], [0, 0, 0]])
    joined = simulator.make_joints(state._replace(x=1.0 * x), p, [0], [1], [(0.0, 0.0, 1.5)], 0.0)
    for function, before, whole, after in (
            (integrators.blanes_moan_step, (integrators.oscillator_acceleration, 0), (np.array([1]), np.array([0])),
             (0.1, oscillator)),
            (simulator.new_velocities, (simulator.weight, 0), (x, q, v, omega), (0.1, p)),
            (simulator.free_step, (simulator.weight, 0), (x, q, v, omega), (0.1, p)),
            (simulator.joint_step, (simulator.weight, 0), (x, q, v, 0 * omega), (0.01, joined)),
            (simulator.turn_quaternions, (), (q, omega), (0.1,))):
        floats = [1.0 * one for one in whole]
        for found, expected in zip(function(*before, *whole, *after), function(*before, *floats, *after), strict=True):
            assert np.array_equal(found, expected), function.__name__


# ---------------------------------------------------------------------------------------------- no gain of energy

def test_no_loop_starts_with_a_parameter_that_creates_energy():
    ball = friction.ParticleOnPlane(1.0, 0.3, 0.8, DOWN, np.zeros(3), UP)
    run = (friction.contact_step, friction.falling_acceleration, friction.particle_plane_gap, 0.0, UP, np.zeros(3),
           0.001, 100)
    for changed in ({"n": 2.0 * UP}, {"e": 1.2}, {"mu": -0.3}, {"m": -1.0}, {"mu": np.nan}):
        with pytest.raises(BadInput):
            friction.advance_particle(*run, ball._replace(**changed))


ROLLING = rotation.RollingBall(1.0, 0.4 * np.ones(3), 1.0, 0.3, DOWN)


def roll(ball, steps=100):
    return rotation.advance_rigid_body(rotation.rolling_step, rotation.supported_weight, 0.0, np.zeros(3),
                         np.array([1.0, 0.0, 0.0, 0.0]), np.array([1.0, 0.0, 0.0]), np.zeros(3), 0.01, steps, ball)


def test_a_rolling_ball_with_a_negative_friction_is_refused():
    for mu in (-0.3, np.nan):
        with pytest.raises(BadInput, match="friction μ"):
            roll(ROLLING._replace(mu=mu))


def test_a_floor_never_pulls():
    """With gravity away from the floor the ball leaves with g and keeps its tangential speed."""
    _, _, v, omega = roll(ROLLING._replace(gravity=-DOWN))
    assert abs(v[2] - 9.81) < 1e-9 and v[0] == 1.0 and not omega.any()


def test_energies_may_be_a_list_and_one_without_its_work_is_refused():
    assert simulator.gain_without_source([3, 1, 2.5], [0, 0, 0.5]) == 1.0
    for energies, work in (([1.0, 2.0], [0.0]), ([1.0, 2.0], 0.0), (["much", 2.0], [0.0, 0.0]), (None, [0.0]),
                           (np.ones((2, 3)), np.ones((2, 3)))):
        with pytest.raises(BadInput):
            simulator.gain_without_source(energies, work)


# ---------------------------------------------------------------------------------------------- missing points

@pytest.mark.parametrize("make", [
    lambda fixed, pairs, gravity:
        springs.make_spring_network(ROPE, 1.0, fixed, pairs, 50.0, 0.0, gravity, np.zeros(2), 0.0),
    lambda fixed, pairs, gravity:
        pbd.make_constraint_network(ROPE, 1.0, fixed, pairs, 0.0, 1.0, gravity, 3)], ids=["springs", "constraints"])
@pytest.mark.parametrize(("fixed", "pairs", "gravity", "value"), [
    ([0], PAIRS, np.array([0.0, 0.0, -9.81]), "(3,)"),
    ([-1], PAIRS, WEIGHT, "-1"),
    ([3], PAIRS, WEIGHT, "3"),
    ([0.5], PAIRS, WEIGHT, "0.5"),
    ([0], [(0, -1)], WEIGHT, "-1"),
    ([0], [(0, 7)], WEIGHT, "7"),
    ([0], [(0, 1, 2)], WEIGHT, "(1, 3)"),
    ([0], [(0, 0)], WEIGHT, "0")])
def test_a_point_or_a_dimension_that_does_not_exist_is_named(make, fixed, pairs, gravity, value):
    with pytest.raises(BadInput) as said:
        make(fixed, pairs, gravity)
    assert value in str(said.value)


# ---------------------------------------------------------------------------------------------- redundant links

SQUARE = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])


@pytest.mark.parametrize("step", [pbd.constraint_projection_step, pbd.rattle_step])
@pytest.mark.parametrize(("x", "links", "more"), [
    (ROPE[:2], [(0, 1)], [(0, 1)]),                                      # one link given twice
    (SQUARE, [(0, 1), (1, 2), (2, 3), (3, 0), (0, 2)], [(1, 3)])], ids=["twice", "both diagonals"])
def test_a_redundant_link_changes_nothing(step, x, links, more):
    """Both trusses have the same freedom and the same constraints, so they move alike.

    The tolerance is 100 times the round-off of λ/TRACE per step.
    """
    ends = []
    for pairs in (links, links + more):
        net = pbd.make_constraint_network(x, 1.0, [0], pairs, 0.0, 1.0, WEIGHT, 1)
        ends.append(integrators.advance(step, pbd.network_gravity, 0.0, x, np.zeros_like(x), 0.01, 100, net))
    assert np.allclose(*ends, rtol=0.0, atol=1e-9) and np.abs(ends[0][0] - x).max() > 0.1


@pytest.mark.parametrize("step", [pbd.constraint_projection_step, pbd.rattle_step])
def test_a_taut_rope_between_two_fixed_ends_cannot_carry_a_load_across(step):
    """No finite tension carries a load across a straight rope between two fixed ends."""
    net = pbd.make_constraint_network(ROPE, 1.0, [0, 2], PAIRS, 0.0, 1.0, WEIGHT, 1)
    with pytest.raises(Diverged, match="did not converge"):
        step(pbd.network_gravity, 0.0, ROPE, np.zeros((3, 2)), 0.01, net)


# ---------------------------------------------------------------------------------------------- sizes

@pytest.mark.parametrize("size", [1e-90, 1e-61, 1e-8, 1.0, 1e8, 1e61, 1e90])
def test_gjk_is_right_for_bodies_of_any_size(size):
    corner = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])
    apart = collisions.gjk(size * corner, size * (corner + np.array([3.0, 0.0, 0.0])))
    assert abs(apart.gap / size - 2.0) < ROUND_OFF
    assert abs(collisions.gjk(size * corner, size * (corner + 0.1)).gap / size) < ROUND_OFF


def test_gjk_refuses_sizes_whose_squares_overflow_or_vanish():
    corner = np.eye(3)
    for size in (1e-200, 1e200):
        with pytest.raises(BadInput, match="size"):
            collisions.gjk(size * corner, size * (corner + 3.0))


@pytest.mark.parametrize("speed", ["plain", "compiled"])
def test_a_multiplier_refuses_a_step_of_zero(speed):
    if speed == "compiled" and not modules.can_compile():
        pytest.skip("numba has no wheel for this machine")
    with pytest.raises(BadInput, match="step dt"):
        modules.bind("impulses", compiled=speed == "compiled").gap_multiplier(0.1, -1.0, 1.0, 0.0)


# ---------------------------------------------------------------------------------------------- many contacts

SCENES = {                   # what makes a scene, its dimension, and the last of its settings
    "make_pile_2d": (contact.make_pile_2d, 2, {"substeps": 2, "hertz": 60.0, "zeta": 10.0, "margin": 0.02}),
    "make_pile": (contact.make_pile, 3, {"substeps": 2, "hertz": 60.0, "zeta": 10.0, "margin": 0.02}),
    "make_bodies_2d": (simulator.make_bodies_2d, 2, {"sweeps": 4, "margin": 0.02}),
    "make_bodies": (simulator.make_bodies, 3, {"sweeps": 4, "margin": 0.02}),
}
ROUND = {2: (contact.disc_bounds, contact.round_contacts), 3: (contact.ball_bounds, contact.round_contacts)}


def two_balls(name, **changed):
    """The state and the record of two discs or balls above each other, made by that function, with something changed.
    """
    make, d, settings = SCENES[name]
    up = np.eye(d)[-1]
    given = {"x": np.outer([0.5, 1.5], up), "q": np.zeros(2) if d == 2 else np.tile((1.0, 0.0, 0.0, 0.0), (2, 1)),
             "m": 1.0, "inertia": 0.1 if d == 2 else np.full((2, 3), 0.1), "half": np.full((2, d), 0.5),
             "planes": [(*up, 0.0)], "gravity": -9.81 * up, "mu": 0.5, **settings}
    assert changed.keys() <= given.keys()
    return make(*(given | changed).values())


@pytest.mark.parametrize("name", SCENES)
def test_a_scene_with_contacts_refuses_what_no_body_and_no_solver_can_be(name):
    """Sizes, masses and settings that are not above zero, and planes whose normal has no length or not that of 1."""
    _, d, settings = SCENES[name]
    two_balls(name)
    impossible = [("half", np.full((2, d), size), str(size)) for size in (0.0, -0.5)]
    impossible += [("m", value, str(value)) for value in (0.0, -2.0, np.nan)]
    impossible += [("inertia", np.zeros((2, 3)) if d == 3 else 0.0, "0.0"), ("mu", -0.1, "-0.1")]
    impossible += [("planes", [(*length * np.eye(d)[0], 1.0)], str(length)) for length in (0.0, 2.0)]
    impossible += [(setting, value, str(value)) for setting in settings for value in (0, -1)]
    if d == 3:
        impossible.append(("q", np.zeros((2, 4)), "0.0"))
    for field, value, said in impossible:
        with pytest.raises(BadInput) as refused:
            two_balls(name, **{field: value})
        assert said in str(refused.value), (field, value)


@pytest.mark.parametrize("name", ["make_bodies_2d", "make_bodies"])
def test_bodies_may_have_no_plane_and_places_are_rows(name):
    d = SCENES[name][1]
    _, p = two_balls(name, planes=[])
    assert p.planes.shape == (0, d + 1) and p.inv_mass.size == 2
    for field, value, said in (("x", np.zeros(2), "give a list of rows"), ("x", np.zeros((0, d)), "not an empty one"),
                               ("gravity", -9.81, "give a list of numbers")):
        with pytest.raises(BadInput, match=said):
            two_balls(name, **{field: value})


@pytest.mark.parametrize("name", ["make_pile_2d", "make_pile"])
def test_a_pile_refuses_a_changed_record_that_its_substeps_cannot_carry(name):
    """A record is changed by _replace, which checks nothing: each run checks what it divides by."""
    state, pile = two_balls(name)
    advance = contact.advance_pile_2d if name == "make_pile_2d" else contact.advance_pile
    for changed, said in (({"substeps": 0}, "substeps of a Pile is 0"), ({"substeps": -2}, "substeps of a Pile is -2"),
                          ({"hertz": 1000.0}, "times a substep"), ({"hertz": 0.0}, "hertz"), ({"zeta": 0.0}, "ζ")):
        with pytest.raises(BadInput, match=said):
            advance(*ROUND[state.x.shape[1]], state, 1.0 / 240.0, 2, pile._replace(**changed))


@pytest.mark.parametrize("name", ["make_bodies_2d", "make_bodies"])
def test_two_bodies_that_no_impulse_moves_may_overlap_and_stay(name):
    """Both are infinitely heavy, one half inside the other and in the ground: there is no contact, and no motion."""
    d = SCENES[name][1]
    x = np.zeros((2, d))
    x[1, 0] = 0.5
    state, p = two_balls(name, x=x, m=np.inf, inertia=np.full((2, 3) if d == 3 else 2, np.inf))
    step = simulator.contact_step_2d if d == 2 else simulator.contact_step
    end = simulator.advance_contact(step, simulator.weight, *ROUND[d], 0.0, state, 0.01, 5, p)
    assert end.contacts.a.size == 0 and np.array_equal(end.x, state.x) and not end.v.any()


@pytest.mark.parametrize("moments", [(np.inf, 0.2, 0.2), (0.2, np.inf, np.inf), (0.2, 0.2, np.inf)])
def test_a_body_in_space_turns_about_all_axes_or_about_none(moments):
    """With some moments infinite, Euler's equation has infinity minus infinity in it, or is left out as a whole."""
    with pytest.raises(BadInput, match=r"beside an infinite one.*0\.2"):
        two_balls("make_bodies", inertia=np.array([(0.2, 0.2, 0.2), moments]))


def test_a_loop_without_sweeps_ends_in_an_error_that_says_so():
    """No impulse stops the fall.  The loop names the bodies and the sweeps as soon as they are deep in each other."""
    state, p = two_balls("make_bodies_2d")
    with pytest.raises(Diverged, match="with 0 sweeps per step"):
        simulator.advance_contact(simulator.contact_step_2d, simulator.weight, *ROUND[2], 0.0, state, 0.01, 100,
                                  p._replace(sweeps=0))


def test_a_contact_needs_a_normal_of_length_one_and_a_body_that_can_move():
    for n, inv_mass, said in (((0.0, 0.0), [1.0, 1.0], "0.0"), ((0.0, 1.0), [0.0, 0.0], "above zero")):
        with pytest.raises(BadInput, match=said):
            contact.make_contacts([0], [1], [(0.0, 0.0)], [n], inv_mass)


# ---------------------------------------------------------------------------------------------- simultaneous impacts

def energy(body):
    return 0.5 * body.v @ body.v / body.inv_mass + 0.5 * body.omega @ np.linalg.solve(body.inv_inertia, body.omega)


def rotation_of(rng):
    Q, R = np.linalg.qr(rng.normal(size=(3, 3)))
    return Q * np.sign(np.diag(R)) * np.sign(np.linalg.det(Q * np.sign(np.diag(R))))


def test_a_ball_that_rolls_and_a_box_that_tips_settle_at_once():
    """The contact points are at rest while the bodies move. Round-off, and the residual, scale with |v| + |ω||r|."""
    rng = np.random.default_rng(7)
    for _ in range(100):
        radius = rng.uniform(0.01, 1.0)
        v = np.append(rng.normal(size=2) * 10.0, -(10.0 ** rng.uniform(-6.0, 0.0)))
        ball = impulses.BodyState3D(v, np.cross(UP, v) / radius, 1.0, np.eye(3) / (0.4 * radius**2))
        after, residual = impulses.solve_impacts(ball, -radius * UP[None], UP[None], 0.0, rng.uniform(0.0, 1.0))
        assert residual <= impulses.CONVERGED * 2.0 * np.linalg.norm(v) and abs(after.v[2]) <= ROUND_OFF
    for _ in range(40):
        half, R, spin = rng.uniform(0.1, 0.5, 3), rotation_of(rng), rng.uniform(1.0, 20.0)
        edge = np.array([[-1.0, 1.0, -1.0], [-1.0, -1.0, -1.0]]) * half @ R.T    # the edge about which it tips
        omega = spin * R[:, 1]
        push = impulses.BodyState3D(-np.cross(omega, edge[0]) - 1e-3 * R[:, 2], omega,
                              1.0, R @ np.diag(3.0 / (half @ half - half**2)) @ R.T)
        _, residual = impulses.solve_impacts(push, edge, np.stack((R[:, 2], R[:, 2])), 0.0, 0.5)
        assert residual <= impulses.CONVERGED * 2.0 * (np.linalg.norm(push.v) + spin)


def test_the_most_dissipative_impact_is_physical_and_has_a_residual():
    """Boxes on two to four corners, with friction of 1.5 or more: in the cone, no energy gained, no penetration."""
    rng, fell_back = np.random.default_rng(9), 0
    every_corner = np.array([(a, b, c) for a in (-1.0, 1.0) for b in (-1.0, 1.0) for c in (-1.0, 1.0)])
    for _ in range(5):
        half, R = rng.uniform(0.05, 0.5, 3), rotation_of(rng)
        corners = every_corner[rng.choice(8, rng.integers(2, 5), replace=False)] * half
        r, n = corners @ R.T, rotation_of(rng)[0]
        body = impulses.BodyState3D(3.0 * rng.normal(size=3) - 3.0 * n, 5.0 * rng.normal(size=3),
                              1.0, R @ np.diag(3.0 / (half @ half - half**2)) @ R.T)
        e, mu = rng.choice([0.0, 0.5, 1.0]), rng.choice([1.5, 3.0, np.inf])
        answers = impulses.contact_matrix, impulses.cone_impulse, impulses.apply_impulse
        after, residual = impulses.most_dissipative_impact(*answers, body, r, np.tile(n, (len(r), 1)), e, mu)
        speed = impulses.largest_speed(body, r)
        fell_back += residual > 1e-9 * speed
        J = (after.v - body.v) / body.inv_mass
        leaves = (after.v + np.cross(after.omega, r)) @ n
        assert energy(after) <= energy(body) * (1.0 + ROUND_OFF)
        assert leaves.min() >= -1e-11 * speed
        # All cones have the same n, so the sum of the impulses is in the cone.
        assert np.linalg.norm(J - (J @ n) * n) <= mu * (J @ n) * (1.0 + ROUND_OFF)
    assert fell_back >= 2


def test_two_bodies_that_cannot_be_moved_along_some_direction_are_refused():
    with pytest.raises(BadInput, match="determinant of K"):
        impulses.cone_impulse(-UP, UP, np.diag([0.0, 1.0, 1.0]), 0.0, 0.3)
