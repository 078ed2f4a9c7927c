"""Ordinary calls of given functions that no grading test calls: {lesson: {function: calls}}."""

import functools
import itertools

import numpy as np

from solutions.support.arms import Arms
from validate.subject import modules

from . import started as scenes
from .ordinary import ordinary_calls

collisions, contact, friction, impulses, pbd = map(
    modules.bind, ("collisions", "contact", "friction", "impulses", "pbd"))
integrators, kinematics, rotation, sensitivities, simulator = map(
    modules.bind, ("integrators", "kinematics", "rotation", "sensitivities", "simulator"))
rng = np.random.default_rng(7)

SHOWN = 40                   # configurations of two shapes [-]: in some of them two axes separate nearly alike


def around(*shape):
    """Numbers from −1 to 1."""
    return rng.uniform(-1.0, 1.0, shape)


TRIANGLE, SEGMENT = tuple(around(3, 3)), tuple(around(4, 3))


def turned():
    """A rotation (3, 3)."""
    q = rng.normal(size=4)
    return rotation.rotation_matrix(q / np.linalg.norm(q))


def boxes_near_each_other():
    """Pairs of boxes of one metre that overlap or are close; every other one is parallel to the other."""
    for k in range(SHOWN):
        R = turned()
        a = collisions.Box(around(3), R, rng.uniform(0.3, 1.0, 3))
        yield a, collisions.Box(a.x + 0.8 * rng.normal(size=3), R if k % 2 else turned(), rng.uniform(0.3, 1.0, 3))


def polygon():
    """Six corners of a convex polygon, counter-clockwise."""
    angles = np.sort(rng.uniform(0.0, 1.0, 6) + np.arange(6))
    return np.stack((np.cos(angles), np.sin(angles)), axis=1) * 0.8 + 0.7 * around(2)


def a_cloth():
    """(positions, Cloth): two triangles with a common edge above a ball and a floor."""
    x = np.array([[0.0, 0.0, 0.3], [1.0, 0.0, 0.3], [0.5, 0.9, 0.4], [0.5, -0.9, 0.5]])
    edges, hinges = pbd.shared_edges(np.array([[0, 1, 2], [1, 0, 3]]))
    network = pbd.make_constraint_network(x, 0.2, [2], edges, 1e-4, 0.8, (0.0, 0.0, -9.81), 3)
    ball = pbd.Obstacle(np.array([0.4, 0.1, 0.1]), 0.35, np.zeros(3), np.array([0.0, 0.0, 1.0]))
    return x, pbd.Cloth(network, hinges, np.array([0.3]), 0.5, ball)


def a_balloon():
    """(positions, Balloon): a tetrahedron full of air above a floor."""
    x, faces = scenes.corners + np.array([0.0, 0.0, 0.01]), scenes.faces
    edges, _ = pbd.shared_edges(faces)
    network = pbd.make_constraint_network(x, 0.2, [], edges, 1e-3, 1.0, (0.0, 0.0, -9.81), 3)
    return x, pbd.Balloon(network, faces, 0.2, 1e-7, a_cloth()[1].obstacle)


def piles_2d():
    """(PileState, Bodies) of boxes in the plane, most of them in contact, half of them turned."""
    for k in range(SHOWN):
        n = 6
        x = np.stack((0.9 * np.arange(n) % 2.7, 0.45 + 0.9 * (np.arange(n) // 3)), axis=1) + 0.05 * around(n, 2)
        state, p = simulator.make_bodies_2d(x, (k % 2) * 0.1 * around(n), 1.0 + 0.5 * around(n), 0.2,
                                            0.45 * np.ones((n, 2)), [(0.0, 1.0, 0.0)], (0.0, -9.81), 0.4, 4, 0.05)
        yield state._replace(v=0.3 * np.concatenate((around(n, 2), np.zeros((1, 2))))), p


def heaps():
    """The same in space."""
    for k in range(SHOWN):
        n = 4
        x = np.stack((0.9 * (np.arange(n) % 2), np.zeros(n), 0.45 + 0.9 * (np.arange(n) // 2)), axis=1)
        q = np.tile(scenes.q, (n, 1)) + (k % 2) * 0.05 * around(n, 4)
        state, p = simulator.make_bodies(x + 0.05 * around(n, 3), q / np.linalg.norm(q, axis=1, keepdims=True), 1.0,
                                         0.2 * np.ones((n, 3)), 0.45 * np.ones((n, 3)), [(0.0, 0.0, 1.0, 0.0)],
                                         scenes.down, 0.4, 4, 0.05)
        yield state._replace(v=0.3 * np.concatenate((around(n, 3), np.zeros((1, 3))))), p


def jointed():
    """(PileState, JointedBodies): three rods in a row, the first one on a plane's body, above a floor."""
    x = np.stack((0.4 * np.arange(3) + 0.2, np.full(3, 0.3)), axis=1)
    state, p = simulator.make_bodies_2d(x, np.zeros(3), 0.5, 0.01, np.tile((0.2, 0.02), (3, 1)), [(0.0, 1.0, 0.0)],
                                        (0.0, -9.81), 0.4, 4, 0.05)
    return state, simulator.make_joints(state, p, [0, 1, 2], [3, 0, 1], [(0.0, 0.3), (0.4, 0.3), (0.8, 0.3)], 0.0)


def contact_steps(worlds, bounds, narrow):
    """Calls of a step with contact."""
    return [(simulator.weight, bounds, narrow, 0.0, state, 0.01, p) for state, p in worlds]


def of_integrators():
    throw = scenes.OSCILLATION
    return {
        "blanes_moan_step": [(throw[0], 0.0, *throw[2:5], throw[6])],
        "inner_product": [(around(3), around(3))],
        "spectral_radius": [(around(2, 2),) for _ in range(4)]}


def of_springs():
    return {"randomised": [(2.0, 0.3, around(4))]}


def of_friction():
    return {
        "average_sliding_step": [(friction.driven_acceleration, 0.0, scenes.still, around(3), 0.1, scenes.block)],
        "pyramid_step": [(friction.driven_acceleration, 0.0, scenes.still, around(3), 0.1, scenes.block)],
        "event_step": [(friction.driven_acceleration, 0.0, scenes.still, v, 0.1, scenes.block)
                       for v in (scenes.still, 0.01 * scenes.block.drive)]}


def of_rotation():
    turn, roll = scenes.TURNS, scenes.ROLLING
    rotating = (*turn[:5], turn[6])
    return {
        **{name: [rotating] for name in (
            "midpoint_step", "splitting_step", "matrix_step", "axis_angle_step", "quaternion_step",
            "gyroscopic_step", "implicit_gyroscopic_step", "runge_kutta_step", "composed_splitting_step",
            "composed_midpoint_step")},
        "supported_weight": [(*roll[1:6], roll[8])],
        "no_torque": [(0.0, scenes.q, scenes.L, turn[6])]}


def of_collisions():
    flight = (*scenes.FLIGHT[:3], scenes.up, -9.0 * scenes.up, 0.1, scenes.FLIGHT[-1])
    flock = collisions.make_flock(0.1, 1.0, 2.0, 0.3, 0.4)
    return {
        "ball_plane": [(around(3), 0.3, scenes.plane)],
        "cylinder_hit": [(0.0, 0.1, 3.0 * around(3), 3.0 * around(3), 0.2, 0.5) for _ in range(8)],
        "ball_plane_gap": [(around(3), flight[-1])],
        "ball_plane_time": [(0.0, 0.1, scenes.up, -scenes.up, flight[-1])],
        "ball_cylinder_gap": [(around(3), flight[-1])],
        "ball_cylinder_time": [(0.0, 0.1, 3.0 * scenes.up, -scenes.up, flight[-1])],
        "discrete_step": [flight], "continuous_step": [flight],
        "ball_triangle": [(around(3), 0.1, *TRIANGLE)],
        "nearer_pair": [tuple(around(4, 3))],
        "closest_segments": [tuple(around(4, 3)) for _ in range(SHOWN)],
        "capsule_capsule": [(*SEGMENT[:2], 0.1, *SEGMENT[2:], 0.2)],
        "ball_capsule": [(around(3), 0.1, *SEGMENT[:2], 0.2)],
        "points_plane": [(around(6, 3), scenes.plane)],
        "against_face": [(around(4, 3), scenes.up, 0.2 * around(3), flipped) for flipped in (False, True)],
        "separating_edge": [(polygon(), polygon()) for _ in range(SHOWN)],
        "polygon_contacts": [(polygon(), polygon()) for _ in range(SHOWN)],
        "box_separation": list(boxes_near_each_other()),
        "box_box": list(boxes_near_each_other()),
        "gjk": [(around(8, 3), around(6, 3) + 1.5 * around(3)) for _ in range(SHOWN)],
        "flock_acceleration": [(0.0, around(5, 2), around(5, 2), flock)],
        "flock_energy": [(2.0 * around(5, 2), around(5, 2), flock)]}


def of_impulses():
    free, spinning, pair = scenes.DROP, scenes.SPIN, scenes.pair[0]
    fall = (free[0], 0.0, 0.1 * scenes.up, -scenes.up, 0.3, scenes.drop)
    spin = (spinning[0], 0.0, 0.1 * scenes.up, -scenes.up + 0.3, np.ones(3), 0.3, scenes.spinner)
    K = impulses.contact_matrix(scenes.arms[0], 1.0, scenes.solid.inv_inertia)
    return {
        "contact_impulse": [(scenes.solid.v, scenes.up, K, 0.5, 0.3)],
        "penalty_step": [fall], "project_to_plane": [(around(3), scenes.drop)],
        "spinning_impact": [(-scenes.up + 0.3, np.ones(3), scenes.spinner)],
        "position_projection_spin_step": [spin], "backtracking_spin_step": [spin],
        "advance_to_plane": [(scenes.up, -scenes.up, scenes.down, 1.0, scenes.drop)],
        "disc_impact": [(pair, -pair, 1, 0, scenes.discs)],
        "position_projection_discs_step": [(pair, -pair, 0.2, scenes.discs)],
        "backtracking_discs_step": [(pair, -pair, 0.2, scenes.discs)],
        "check_over_plane": [(scenes.drop, 3)],
        "relative_velocity": [(scenes.solid, scenes.solid._replace(v=-scenes.up), *scenes.arms)]}


def of_pbd():
    cloth, balloon = a_cloth(), a_balloon()
    rods = pbd.make_constraint_network(scenes.rope, 0.1, [0], scenes.links, 0.0, 1.0, scenes.weight, 4)
    return {
        "rattle_step": [(pbd.network_gravity, 0.0, scenes.rope, 0.0 * scenes.rope, 0.01, rods)],
        "fold_sweep": [cloth],
        "cloth_step": [(pbd.network_gravity, 0.0, cloth[0], 0.0 * cloth[0], 0.01, cloth[1])],
        "balloon_step": [(pbd.network_gravity, 0.0, balloon[0], 0.0 * balloon[0], 0.01, balloon[1])],
        "pivoted_body_step": [(0.0, np.array([0.0, 0.0, -0.5]), scenes.q, np.zeros(3), np.array([0.3, 1.0, 0.2]),
                               0.01, pbd.PivotedBody(1.0, scenes.I_body, scenes.down, np.zeros(3),
                                                     np.array([0.0, 0.0, 0.5]), 3))]}


def of_contact():
    pile = contact.make_pile_2d(*scenes.boxes)
    _, *begin, _, p_boxes = scenes.STARTED["simulator"]["advance_contact"][0]
    touching = simulator.contact_step_2d(*begin, p_boxes).contacts
    m = touching.a.size
    arms = Arms(around(m, 2), around(m, 2), *rng.uniform(1.0, 2.0, (2, m)))
    A, b, mu = np.diag(rng.uniform(1.0, 2.0, 4)) + 0.1, rng.uniform(-1.0, 0.5, 4), np.array([0.3, 0.6])
    problem = (A, b, rng.uniform(0.2, 1.0, 4), mu)
    return {
        **{name: [problem] for name in ("normals_first_sweep", "minimum_map_step_with_friction",
                                        "fischer_burmeister_step", "relaxed_sweep")},
        "jacobi_step": [(*problem, rng.uniform(0.1, 0.3, 4))],
        "contact_targets": [(0.1 * around(m), around(m, 2), touching, arms, rng.uniform(0.0, 1.0, m), 0.004, pile[1])],
        "separation_speeds": [(touching, pile[1])],
        "pile_trajectory": [(contact.advance_pile_2d, *scenes.STARTED["contact"]["advance_pile_2d"][0])]}


def of_simulator():
    state, p = jointed()
    joint = (simulator.weight, 0.0, state.x, state.q, state.v, state.omega, 0.01, p)
    return {
        "contact_step_2d": contact_steps(piles_2d(), simulator.box_bounds_2d, simulator.box_contacts_2d),
        "contact_step": contact_steps(heaps(), simulator.box_bounds, simulator.box_contacts),
        "settled_contact_step_2d": contact_steps(list(piles_2d())[:4], simulator.box_bounds_2d,
                                                 simulator.box_contacts_2d),
        "mean_contact_step_2d": contact_steps(list(piles_2d())[:4], simulator.box_bounds_2d,
                                              simulator.box_contacts_2d),
        "joint_step_2d": [joint], "composed_joint_step_2d": [joint],
        "joint_contact_step_2d": [(simulator.weight, simulator.box_bounds_2d, simulator.box_contacts_2d, 0.0, state,
                                   0.01, p)],
        "swing_acceleration": [(0.0, around(3), around(3), scenes.cradle)],
        "swinging_step": [(integrators.rk4_step, 0.0, np.array([-0.1, 0.0, 0.0]), np.array([0.5, 0.0, 0.0]), dt,
                           scenes.cradle) for dt in (0.05, 0.3)],
        "rods_acceleration": [(0.0, around(3), around(3), simulator.RodsInAngles(0.5, 0.3, 0.004, 9.81))],
        "rocking_step": [(integrators.rk4_step, 0.0, np.array([x]), np.array([-0.5]), 0.05, scenes.rocker)
                         for x in (0.1, 0.01)]}


def of_kinematics():
    plane_arm = kinematics.make_arm_2d(*scenes.arm)
    space_arm = kinematics.make_arm_3d(*scenes.STARTED["kinematics"]["make_arm_3d"][0])
    return {
        "reach_2d": [(scenes.bent, scenes.goal, plane_arm)],
        "pose_2d": [(scenes.bent, np.array([0.9, 0.8, 0.3]), plane_arm)],
        "reach_3d": [(scenes.bent, around(3), space_arm)],
        "pose_3d": [(scenes.bent, np.concatenate((around(3), scenes.q)), space_arm)],
        "end_pose": [(scenes.bent, space_arm)],
        "pseudo_inverse_step": [(kinematics.reach_2d, scenes.bent, scenes.goal, plane_arm)],
        "angles_of": [(around(4, 2),)],
        "fabrik_step": [(kinematics.reach_2d, scenes.bent, scenes.goal, plane_arm)]}


def of_sensitivities():
    x, v, dx, dv = scenes.throw.x, np.array([3.0, 2.0]), np.zeros((2, 2)), np.eye(2)
    return {
        "forward_difference": [(lambda s, p: s * s, 1.5, 1e-3, None)],
        "oscillator_derivatives": [(0.0, x, v, scenes.oscillator)],
        "next_impact": [(x, v, 1.6, scenes.course)],
        "fly": [(x, v, dx, dv, 1.6, scenes.course)],
        "throw_miss": [(v, scenes.throw)],
        "checked_search": [(v, 1e-9, 20)],
        "checked_tangents": [(*scenes.TANGENTS[:3], *scenes.TANGENTS[3:7], scenes.oscillator)]}


def given_calls():
    """{lesson: {function: calls}}."""
    return {
        "integrators": of_integrators(),
        "springs": of_springs(),
        "friction": of_friction(),
        "rotation": of_rotation(),
        "collisions": of_collisions(),
        "impulses": of_impulses(),
        "pbd": of_pbd(),
        "contact": of_contact(),
        "simulator": of_simulator(),
        "kinematics": of_kinematics(),
        "sensitivities": of_sensitivities(),
    }


def calls_of_all():
    """{(lesson, function): (function, calls)} of every public function of all lessons."""
    return calls_of(*modules.lesson_names())


@functools.cache
def calls_of(*lessons):
    """The same for the functions of some lessons: recorded calls, and those written by hand."""
    found = {key: (function, list(calls)) for key, (function, calls) in ordinary_calls(*lessons).items()}
    for written, lesson in itertools.product((scenes.STARTED, given_calls()), lessons):
        for name, calls in written.get(lesson, {}).items():
            function, recorded = found.get((lesson, name), (getattr(modules.bind(lesson), name), []))
            found[lesson, name] = function, [*recorded, *calls]
    return found
