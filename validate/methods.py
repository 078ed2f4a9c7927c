"""Every method that a scene can name: its function, label, order, lesson, colour and marker.

A new method is one line here.  Colours are those of Okabe and Ito 2008, which colour-blind readers can tell apart,
and a few more.  Every curve has a marker, too.
"""

from .reference import kinematics, schemes, turns
from .scene import Method

# integrators
EULER = Method("euler_step", "Euler", 1, "integrators", "#E69F00", "o", schemes.EULER)
MIDPOINT = Method("midpoint_step", "midpoint", 2, "integrators", "#56B4E9", "^", schemes.MIDPOINT)
RK4 = Method("rk4_step", "Runge–Kutta 4", 4, "integrators", "#009E73", "s", schemes.RK4)
AVERAGE_VELOCITY = Method("average_velocity_step", "average velocity", 1, "integrators", "#CC79A7", "v",
                          schemes.AVERAGE_VELOCITY)
SYMPLECTIC_EULER = Method("symplectic_euler_step", "symplectic Euler", 1, "integrators", "#D55E00", "D",
                          schemes.SYMPLECTIC_EULER)
VERLET = Method("verlet_step", "Verlet", 2, "integrators", "#0072B2", "P", schemes.VERLET)
IMPLICIT_EULER = Method("implicit_euler_step", "implicit Euler", 1, "integrators", "#8C6D31", "<",
                        schemes.IMPLICIT_EULER)
IMPLICIT_MIDPOINT = Method("implicit_midpoint_step", "implicit midpoint", 2, "integrators", "#6A51A3", ">",
                           schemes.IMPLICIT_MIDPOINT)
BLANES_MOAN = Method("blanes_moan_step", "Blanes–Moan", 4, "integrators", "#17A2A2", "h", schemes.BLANES_MOAN)
ADAPTIVE = Method("advance_adaptive", "Blanes–Moan, adaptive", 4, "integrators", "#A6761D", "p")

# springs
IMPLICIT_MESH = Method("implicit_spring_network_step", "implicit mesh", 1, "springs", "#7F7F7F", "h")

# friction
SLIDING = Method("sliding_step", "sliding", 1, "friction", "#0072B2", "o")
AVERAGE_SLIDING = Method("average_sliding_step", "mean velocities", 2, "friction", "#CC79A7", "^")
PYRAMID = Method("pyramid_step", "pyramid", 1, "friction", "#D55E00", "D")
EVENT = Method("event_step", "event", 2, "friction", "#009E73", "s")
CONTACT = Method("contact_step", "contact", 1, "friction", "#E69F00", "v")
GRIPPING = Method("position_friction_step", "gripping", 1, "friction", "#56B4E9", "^")

# inertia_tensors
TRIANGLES = Method("mesh_body", "triangles", 2, "inertia_tensors", "#0072B2", "^")
POINTS = Method("point_mass_inertia", "points", 1, "inertia_tensors", "#E69F00", "o")
PARTS = Method("combine", "parts", 2, "inertia_tensors", "#009E73", "s")

# rotation
MATRIX = Method("matrix_step", "ω*R, renormalised", 1, "rotation", "#8C6D31", "<", turns.MATRIX)
AXIS_ANGLE = Method("axis_angle_step", "axis–angle", 1, "rotation", "#E69F00", "o", turns.AXIS_ANGLE)
QUATERNION = Method("quaternion_step", "quaternion", 1, "rotation", "#CC79A7", "v", turns.QUATERNION)
GYROSCOPIC = Method("gyroscopic_step", "gyroscopic term", 1, "rotation", "#D55E00", "D", turns.GYROSCOPIC)
IMPLICIT_GYROSCOPIC = Method("implicit_gyroscopic_step", "gyroscopic, implicit", 1, "rotation", "#7F7F7F", "h",
                             turns.IMPLICIT_GYROSCOPIC)
RUNGE_KUTTA = Method("runge_kutta_step", "Runge–Kutta 4", 4, "rotation", "#009E73", "s", turns.RUNGE_KUTTA)
MIDPOINT_TURN = Method("midpoint_step", "midpoint turn", 2, "rotation", "#6A51A3", ">", turns.MIDPOINT_TURN)
SPLITTING = Method("splitting_step", "splitting", 2, "rotation", "#56B4E9", "^", turns.SPLITTING)
COMPOSED_SPLITTING = Method("composed_splitting_step", "splitting, composed", 4, "rotation", "#0072B2", "P",
                            turns.COMPOSED_SPLITTING)
COMPOSED_MIDPOINT = Method("composed_midpoint_step", "midpoint, composed", 4, "rotation", "#B07CC6", "d",
                           turns.COMPOSED_MIDPOINT)
ROLLING = Method("rolling_step", "the lecture's loop", 1, "rotation", "#0072B2", "P")
AVERAGE_ROLLING = Method("average_rolling_step", "mean velocities", 2, "rotation", "#009E73", "s")

# collisions
DISCRETE = Method("discrete_step", "discrete", 1, "collisions", "#D55E00", "D")
CONTINUOUS = Method("continuous_step", "continuous", 2, "collisions", "#0072B2", "P")
BRUTE_FORCE = Method("all_pairs", "brute force", 1, "collisions", "#E69F00", "o")
GJK = Method("gjk", "GJK", 1, "collisions", "#CC79A7", "v")
NARROW = Method("ball_contact", "narrow phase", 2, "collisions", "#009E73", "s")
AXES = Method("box_separation", "separating axes", 2, "collisions", "#E69F00", "o")
TREES = Method("tree_pairs", "trees", 2, "collisions", "#0072B2", "P")

# impulses
PENALTY = Method("penalty_step", "penalty", 1, "impulses", "#D55E00", "D")
PROJECTING = Method("position_projection_step", "projecting", 1, "impulses", "#0072B2", "o")
BACKTRACKING = Method("backtracking_step", "backtracking", 2, "impulses", "#009E73", "s")
PROJECTING_SPIN = Method("position_projection_spin_step", "projecting", 1, "impulses", "#0072B2", "o")
BACKTRACKING_SPIN = Method("backtracking_spin_step", "backtracking", 2, "impulses", "#009E73", "s")
PROJECTING_DISCS = Method("position_projection_discs_step", "projecting", 1, "impulses", "#0072B2", "o")
BACKTRACKING_DISCS = Method("backtracking_discs_step", "backtracking", 2, "impulses", "#009E73", "s")
TOGETHER = Method("solve_impacts", "together", 2, "impulses", "#009E73", "s")
IN_TURN = Method("sequential_impacts", "one after the other", 2, "impulses", "#D55E00", "D")

# pbd
PROJECTION = Method("constraint_projection_step", "projection", 1, "pbd", "#E69F00", "o")
PBD = Method("pbd_step", "PBD", 1, "pbd", "#D55E00", "D")
XPBD = Method("xpbd_step", "XPBD", 1, "pbd", "#56B4E9", "^")
RATTLE = Method("rattle_step", "RATTLE", 2, "pbd", "#009E73", "s")
ROPE = Method("rope_step", "rope", 2, "pbd", "#0072B2", "P")
COMPOSED_ROPE = Method("composed_rope_step", "rope, composed", 4, "pbd", "#6A51A3", ">")

# contact
SWEEPS = Method("contact_forces", "sweeps", 2, "contact", "#009E73", "s")
DIRECT = Method("solve_lcp", "Murty", 2, "contact", "#0072B2", "^")
PILE = Method("advance_pile_2d", "pile", 1, "contact", "#D55E00", "o")
PILE_IN_SPACE = Method("advance_pile", "pile in space", 1, "contact", "#CC79A7", "D")
COUNTED_SWEEPS = Method("gauss_seidel_sweep", "sweeps, counted", 2, "contact", "#E69F00", "v")
REFLECTION = Method("gauss_seidel_sweep", "sweep with ω = 2", 2, "contact", "#E69F00", "v")
ONE_BY_ONE = Method("impulse_size", "impulses one by one", 2, "impulses", "#0072B2", "o")

# simulator
LOOP_2D = Method("contact_step_2d", "the whole loop", 1, "simulator", "#D55E00", "D")
LOOP_WITH_MEANS = Method("mean_contact_step_2d", "the loop, mean velocities", 2, "simulator", "#009E73", "s")
SETTLED_LOOP = Method("settled_contact_step_2d", "the loop, sweeps until settled", 1, "simulator", "#009E73", "s")
LOOP = Method("contact_step", "the whole loop", 1, "simulator", "#D55E00", "D")
IN_COORDINATES = Method("verlet_step", "two coordinates", 2, "integrators", "#CC79A7", "v")
PARTS_OF_LOOP = Method("whole_step", "the loop of a Model", 1, "simulator", "#0072B2", "o")
CARRIED = Method("carried_step", "the floor ahead", 2, "simulator", "#009E73", "s")
EXACT_ROLLING = Method("exact_rolling_step", "cut at the event", 2, "simulator", "#CC79A7", "v")
ROCKING = Method("rocking_step", "cut at the impact", 4, "simulator", "#009E73", "s")
JOINTS = Method("joint_step_2d", "joints", 2, "simulator", "#0072B2", "o")
COMPOSED_JOINTS = Method("composed_joint_step_2d", "joints, composed", 4, "simulator", "#6A51A3", "^")
IN_ANGLES = Method("rk4_step", "angles, Runge–Kutta 4", 4, "integrators", "#CC79A7", "v", schemes.RK4)
IN_ANGLE = IN_ANGLES._replace(label="angle, Runge–Kutta 4")
SWINGING = Method("swinging_step", "angles, cut at the impacts", 4, "simulator", "#CC79A7", "v")
JOINTS_IN_SPACE = Method("joint_step", "joints in space", 2, "simulator", "#009E73", "s")
JOINTED_LOOP = Method("joint_contact_step_2d", "the loop with joints", 1, "simulator", "#D55E00", "D")

# kinematics
CLOSED_2R = Method("solve_2r", "closed form", 2, "kinematics", "#009E73", "s")
CLOSED_3R = Method("solve_3r", "closed form", 2, "kinematics", "#009E73", "s")
FACTORS = Method("contraction_factors", "closed form", 2, "kinematics", "#009E73", "s")
TRANSPOSE = Method("transpose_step", "transpose", 1, "kinematics", "#E69F00", "o", kinematics.descended)
PSEUDO_INVERSE = Method("pseudo_inverse_step", "pseudo-inverse", 2, "kinematics", "#D55E00", "D",
                        kinematics.solved_undamped)
DAMPED = Method("damped_step", "damped", 1, "kinematics", "#0072B2", "P", kinematics.solved)
CCD = Method("ccd_step", "CCD", 1, "kinematics", "#CC79A7", "v", kinematics.pointed)
FABRIK = Method("fabrik_step", "FABRIK", 1, "kinematics", "#56B4E9", "^", kinematics.pulled)

# sensitivities
FORWARD_DIFFERENCE = Method("forward_difference", "forward difference", 1, "sensitivities", "#E69F00", "o")
CENTRAL_DIFFERENCE = Method("central_difference", "central difference", 2, "sensitivities", "#D55E00", "D")
COMPLEX_STEP = Method("complex_step", "complex step", 2, "sensitivities", "#009E73", "s")
TANGENTS = Method("tangent_step", "tangents, symplectic Euler", 1, "sensitivities", "#D55E00", "D",
                  schemes.SYMPLECTIC_EULER)
IMPLICIT_TANGENTS = Method("tangent_implicit_step", "tangents, implicit Euler", 1, "sensitivities", "#8C6D31", "<",
                           schemes.IMPLICIT_EULER)
SALTATION = Method("flight", "saltation", 2, "sensitivities", "#CC79A7", "v")
AIMING = Method("aim", "Newton's method", 2, "sensitivities", "#009E73", "s")

INTEGRATORS = (EULER, MIDPOINT, RK4, AVERAGE_VELOCITY, SYMPLECTIC_EULER, VERLET, IMPLICIT_EULER, IMPLICIT_MIDPOINT)
ONE_OF_EACH_ORDER = (SYMPLECTIC_EULER, VERLET, RK4)                  # enough for most quick runs
EXPLICIT = (EULER, MIDPOINT, RK4, AVERAGE_VELOCITY, SYMPLECTIC_EULER, VERLET, BLANES_MOAN)
TURNS = (MATRIX, AXIS_ANGLE, QUATERNION, GYROSCOPIC, IMPLICIT_GYROSCOPIC, RUNGE_KUTTA, MIDPOINT_TURN, SPLITTING,
         COMPOSED_SPLITTING, COMPOSED_MIDPOINT)

VARIANT_LINES = {"": "-", "default": ":"}
# line, marker in place of the engine's own
OTHER_VARIANTS = (("--", ""), ("-.", "s"), (":", "o"), ("--", "D"), ("-.", "^"))


def engine_look(engine, engines):
    """Return (colour, marker, line) of one of a scene's engines; curves of several variants may coincide."""
    colour, marker = engine.product.colour, engine.product.marker
    if engine.variant in VARIANT_LINES:
        return colour, marker, VARIANT_LINES[engine.variant]
    others = [one.variant for one in engines if one.product == engine.product and one.variant not in VARIANT_LINES]
    line, other = OTHER_VARIANTS[others.index(engine.variant) % len(OTHER_VARIANTS)]
    return colour, other or marker, line
