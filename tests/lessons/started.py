"""Ordinary calls of functions that construct or start something: `make_*`, loops over steps, whole problems.

The small scenes in them also serve other calls.
"""

import numpy as np

from solutions.support.orbits import attraction
from validate.reference.integrators import Planet
from validate.subject import modules

collisions, contact, friction, impulses = map(modules.bind, ("collisions", "contact", "friction", "impulses"))
integrators, kinematics, rotation, sensitivities, simulator = map(
    modules.bind, ("integrators", "kinematics", "rotation", "sensitivities", "simulator"))
up, still, down = np.array([0.0, 0.0, 1.0]), np.zeros(3), np.array([0.0, 0.0, -9.81])
q, L, I_body = np.array([1.0, 0.0, 0.0, 0.0]), np.array([0.1, 2.0, 0.2]), np.array([1.0, 2.0, 2.5])
plane, box = collisions.Plane(up, -0.1), collisions.Box(still, np.eye(3), np.array([0.5, 0.6, 0.7]))
square = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
low = np.array([[0.0, 0.0, 0.0], [0.5, 0.5, 0.5], [4.0, 4.0, 4.0]])
corners = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])
faces = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]])
on_plane = friction.ParticleOnPlane(1.0, 0.3, 0.5, down, still, up)
ball = rotation.RollingBall(1.0, 0.1 * np.ones(3), 0.5, 0.3, down)
block = friction.make_block(up, 0.4, 0.3, down, np.array([8.0, 0.0, 0.0]), 2.0)
drop = impulses.BouncingBall(0.8, down, still, up, 1e4, 10.0)
spinner = impulses.SpinningBall(0.8, 0.3, 1.0, 2.5 * np.eye(3), 0.4, down, still, up)
discs = impulses.Discs(np.array([0.3, 0.4]), np.array([1.0, 0.5]), 0.9)
pair = np.array([[[0.0, 0.0], [1.0, 0.1]]])
solid = impulses.BodyState3D(np.array([1.0, 0.5, -2.0]), np.array([0.1, 0.2, 0.3]), 1.0, np.diag([6.0, 7.0, 8.0]))
arms, normals = np.array([[0.1, 0.2, -0.3], [-0.1, 0.2, -0.3]]), np.stack((up, up))
rope, links = np.array([[0.0, 0.0], [1.0, 0.0], [2.0, 0.0]]), np.array([[0, 1], [1, 2]])
weight, calm = np.array([0.0, -9.81]), np.array([0.5, 0.0])
oscillator = integrators.Oscillator(3.0, 0.1)
boxes = (np.array([[0.0, 0.5], [0.2, 1.45]]), np.zeros(2), 1.0, 0.2, 0.5 * np.ones((2, 2)), np.array([[0.0, 1.0, 0.0]]),
         weight, 0.5, 2, 60.0, 10.0, 0.02)
balls = (np.array([[0.0, 0.0, 0.5], [0.1, 0.0, 1.45]]), np.tile(q, (2, 1)), 1.0, 0.1 * np.ones((2, 3)),
         0.5 * np.ones((2, 3)), np.array([[*up, 0.0]]), down, 0.5, 2, 60.0, 10.0, 0.02)
limits = (0.1, 0.3, np.array([-2.0, -2.0]), np.array([2.0, 2.5]), np.array([0.1, 0.2]), 0.5)
arm, bent, goal = (np.array([1.0, 0.8]), *limits), np.array([0.3, 0.7]), np.array([0.9, 0.8])

flat = simulator.make_bodies_2d(*boxes[:-4], 4, 0.02)
heap = simulator.make_bodies(*balls[:-4], 4, 0.02)
cradle = simulator.Cradle(0.12, 1.0, 0.05, 1.001, 9.81)
rocker = simulator.RockingBlock(1.0, 0.1, 0.5, 0.09, 9.81)

course = sensitivities.Course(weight, np.array([[0.0, 1.0], [-1.0, 0.0]]), np.array([[0.0, 0.0], [4.0, 0.0]]),
                              np.array([0.8, 0.6]), np.zeros((2, 2)))
throw = sensitivities.Throw(course, np.array([0.0, 1.5]), np.array([2.5, 1.0]), 1.6)


def oscillator_derivatives(t, x, v, p):
    """Derivatives (a_x, a_v, a_s) of oscillator_acceleration; the inputs are the initial values."""
    one = np.eye(x.size)
    return -p.omega * p.omega * one, -2.0 * p.zeta * p.omega * one, np.zeros((x.size, x.size))


# Arguments that follow the step of each loop.
OSCILLATION = (integrators.oscillator_acceleration, 0.0, np.ones(2), np.zeros(2), 0.1, 3, oscillator)
TANGENTS = (integrators.oscillator_acceleration, oscillator_derivatives, 0.0, np.ones(2), np.zeros(2), np.eye(2),
            np.zeros((2, 2)), 0.1, 3, oscillator)
CONTACT = (friction.falling_acceleration, friction.particle_plane_gap, 0.0, 0.1 * up, -up, 0.05, 5, on_plane)
TURNS = (rotation.no_torque, 0.0, q, L, 0.1, 3, rotation.RigidBody(1.0, I_body))
ROLLING = (rotation.supported_weight, 0.0, still, q, np.array([1.0, 0.2, 0.0]), still, 0.01, 5, ball)
FLIGHT = (collisions.ball_plane_gap, collisions.ball_plane_time, 0.0, up[None], -3.0 * up[None], 0.1, 5,
          collisions.Target(0.1, 1.0, plane))
DROP = (impulses.falling_acceleration, 0.0, up[None], -up[None], 0.1, 5, drop)
SPIN = (impulses.falling_acceleration, 0.0, up[None], -up[None], np.ones((1, 3)), 0.1, 5, spinner)
DISCS = (pair, -pair, 0.1, 3, discs)
IMPACTS = (solid, arms, normals, 0.5, 0.3)

STARTED = {
    "integrators": {
        "advance": [(integrators.rk4_step, *OSCILLATION)],
        "advance_adaptive": [(integrators.verlet_step, attraction, 0.0, np.ones(2), np.array([-0.5, 0.5]), 0.1, 2.0,
                              Planet())],
        "trajectory": [(integrators.verlet_step, *OSCILLATION)]},
    "springs": {"make_spring_network": [(rope, 0.1, [0], links, 50.0, 0.1, weight, calm, 0.2)]},
    "friction": {
        "make_block": [(up, 0.4, 0.3, down, still, 2.0)],
        "slip_times": [(friction.driven_acceleration, 0.0, still, still, 0.1, 3, block)],
        "advance_particle": [(friction.contact_step, *CONTACT), (friction.position_friction_step, *CONTACT)]},
    "inertia_tensors": {},
    "rotation": {
        "make_rigid_body": [(1.0, I_body)],
        "advance_rotation": [(rotation.midpoint_step, *TURNS)],
        "rotation_trajectory": [(rotation.splitting_step, *TURNS)],
        "advance_rigid_body": [(rotation.rigid_body_step, *ROLLING)]},
    "collisions": {
        "make_plane": [(np.array([0.0, 0.6, 0.8, 1.0]),)],
        "make_box": [(up, np.eye(3), 0.5 * np.ones(3))],
        "make_flock": [(0.1, 1.0, 2.0, 0.3, 0.4)],
        "advance_projectiles": [(collisions.continuous_step, *FLIGHT)],
        "build_tree": [(low, low + 1.0)],
        "tree_pairs": [(low, low + 1.0)],
        "all_pairs": [(low, low + 1.0)],
        "gjk": [(corners, corners + 3.0)],
        "polygon_contacts": [(square, square + 0.8)]},
    "impulses": {
        "advance_balls": [(impulses.penalty_step, *DROP), (impulses.position_projection_step, *DROP),
                          (impulses.backtracking_step, *DROP)],
        "advance_spinning_balls": [(impulses.position_projection_spin_step, *SPIN),
                                   (impulses.backtracking_spin_step, *SPIN)],
        "advance_discs": [(impulses.position_projection_discs_step, *DISCS),
                          (impulses.backtracking_discs_step, *DISCS)],
        "solve_impacts": [IMPACTS],
        "sequential_impacts": [IMPACTS]},
    "pbd": {"make_constraint_network": [(rope, 0.1, [0], links, 1e-6, 1.0, weight, 4)]},
    "contact": {
        "make_contacts": [(np.array([1, 2]), np.array([0, 1]), np.array([[0.0, 0.0], [0.0, 1.0]]),
                           np.array([[0.0, 1.0], [0.0, 1.0]]), np.array([0.0, 1.0, 2.0]))],
        "make_pile_2d": [boxes], "make_pile": [balls],
        "advance_pile_2d": [(contact.box_bounds_2d, contact.box_contacts_2d, contact.make_pile_2d(*boxes)[0], 0.004, 2,
                             contact.make_pile_2d(*boxes)[1])],
        "advance_pile": [(contact.ball_bounds, contact.round_contacts, contact.make_pile(*balls)[0], 0.004, 2,
                          contact.make_pile(*balls)[1])]},
    "simulator": {
        "advance_free": [(simulator.free_step_2d, simulator.weight, 0.0, *flat[0][:4], 0.004, 2, flat[1]),
                         (simulator.free_step, simulator.weight, 0.0, *heap[0][:4], 0.004, 2, heap[1])],
        "advance_contact": [(simulator.contact_step_2d, simulator.weight, simulator.box_bounds_2d,
                             simulator.box_contacts_2d, 0.0, flat[0], 0.004, 2, flat[1]),
                            (simulator.contact_step, simulator.weight, simulator.ball_bounds, simulator.round_contacts,
                             0.0, heap[0], 0.004, 2, heap[1])],
        "advance_rocking": [(integrators.rk4_step, 0.0, np.array([0.1]), np.zeros(1), 0.01, 30, rocker)],
        "advance_swinging": [(integrators.rk4_step, 0.0, np.array([-0.1, 0.0, 0.0]), np.zeros(3), 0.1, 8, cradle)]},
    "kinematics": {
        "make_arm_2d": [arm], "make_arm_3d": [(np.stack((up, up)), np.ones((2, 3)), *limits)],
        "advance_reach": [(kinematics.damped_step, kinematics.reach_2d, bent, goal, 3, kinematics.make_arm_2d(*arm))],
        "reach_trajectory": [(kinematics.ccd_step, kinematics.reach_2d, bent, goal, 3, kinematics.make_arm_2d(*arm))],
        "solve_reach": [(kinematics.limited_step, kinematics.reach_2d, bent, goal, 1e-6, 30,
                         kinematics.make_arm_2d(*arm))],
        "solve_targets": [(kinematics.damped_step, kinematics.reach_2d, bent, np.stack((goal, -goal)), 1e-6, 30,
                           kinematics.make_arm_2d(*arm))]},
    "sensitivities": {
        "advance_tangents": [(sensitivities.tangent_step, *TANGENTS)],
        "tangent_trajectory": [(sensitivities.tangent_implicit_step, *TANGENTS)],
        "flight": [(throw.x, np.array([3.0, 2.0]), np.zeros((2, 2)), np.eye(2), 1.6, course)],
        "aim": [(sensitivities.throw_miss, np.array([3.0, 2.0]), 1e-9, 20, throw)]},
}
