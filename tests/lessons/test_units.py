"""The same scene in other units gives the same digits: nothing in the lessons knows how long a metre is.

A length, a mass and a time are scaled by powers of two, so a formula gives exactly the same digits.  A tolerance in
metres, such as 1e-9, changes the result of a small scene, and then these tests fail.

UNITS says what an argument of each name is measured in, OTHERWISE where one function means something else, RESULTS what
each function returns.  Records bring their own units: those in brackets after each field.
"""

import functools
import inspect
import re

import numpy as np
import pytest

from solutions.checks import BadInput, Diverged
from validate.subject import modules

from .given_calls import calls_of, calls_of_all

BASE = {"m": (1, 0, 0), "kg": (0, 1, 0), "s": (0, 0, 1), "N": (1, 1, -2), "J": (2, 1, -2),
        "rad": (0, 0, 0), "1": (0, 0, 0), "-": (0, 0, 0)}
POWERS = {"²": 2, "³": 3, "⁴": 4, "⁵": 5}


def exponents(unit):
    """The exponents of metre, kilogram and second in a unit such as "N m/s²" or "1/(kg m²)"; "-" has none."""
    over, _, under = unit.partition("/")
    inner = under[1:-1] if under.startswith("(") else under
    return product_of(over) - (exponents(inner) if under else 0)


def product_of(text):
    total = np.zeros(3, int)
    for word in text.split():
        name, power = (word[:-1], POWERS[word[-1]]) if word[-1] in POWERS else (word, 1)
        total += power * np.array(BASE[name])
    return total


# ---------------------------------------------------------------------------------------------- units of all numbers

# A unit holds for all numbers.  Several, with | between them, repeat along the numbers; "… m" is m for the last number
# of each row and no unit for the others; "rows m | -" has one unit for each row.
UNITS = {
    "s": "t dt duration left ts dts ahead",
    "m": "x x_0 x_1 x_a x_b x_c x_i x_j y r r_a r_b R a b c d p q other_p other_q low high wide_low wide_high "
         "centre radius reach length lengths size about points moved depth phi gap margin near place half goal offsets "
         "towards C move",
    "m/s": "v v_t v_n u u_n u_sep C_rate rate aim fastest",
    "m/s²": "a_n g gravity drive",
    "rad/s": "omega spin hertz align",
    "kg": "m m_a m_b",
    "kg m²": "I I_body inertia",
    "kg m²/s": "L L_a L_b",
    "1/kg": "inv_mass k_n K A weight alpha_scaled",
    "1/(kg m²)": "inv_inertia",
    "kg/m³": "density",
    "N": "F F_N force forces wind",
    "N m": "tau",
    "N s": "J J_old j_n limit",
    "N s²": "Lam",
    "N/m": "k stiffness",
    "N s/m": "k_d k_v damping",
    "m/N": "alpha",
    "J": "energies work",
    "-": "n e mu mu_s mu_k give zeta share theta turn axes q_target q_old q_new t_1 t_2 matrix right gradient "
         "gradients rho pull flipped elbow spread value fold errors sweeps",
    "… m": "planes coefficients",
}

# Where an argument means something else: in all functions of a lesson, or in one.
OTHERWISE = {
    "rotation": {"q": "-", "R": "-"},
    "pbd": {"q": "-", "stiffness": "-"},
    "contact": {"q": "-", "lam": "N s", "b": "m/s"},
    "simulator": {"q": "-"},
    "kinematics": {"q": "-", "J": "m", "sigma": "m", "gain": "1/m²", "damping": "m", "tolerance": "m", "targets": "m",
                   "target": "m", "axes": "-", "low": "-", "high": "-", "rest": "-"},
    "sensitivities": {"a": "m/s²", "a_new": "m/s²", "v_new": "m/s", "dx": "m", "dv": "m/s", "dtau": "s",
                      "gap_x": "-", "gap_v": "s", "gap_s": "m", "R_v": "-", "R_s": "m/s", "e_s": "-"},
    "central_difference": {"s": "m", "h": "m", "p": "-"}, "complex_step": {"s": "m", "h": "m", "p": "-"},
    "best_step": {"value": "J", "third": "J/m³", "round_off": "-"},
    "remainder_orders": {"s": "m", "gradient": "N", "direction": "m", "steps": "-", "p": "-"},
    "aim": {"s": "m/s", "tolerance": "m", "p": "-"}, "checked_search": {"s": "m/s", "tolerance": "m"},
    "throw_miss": {"s": "m/s"},
    "predicted_horizon": {"rate": "1/s", "error": "m", "allowed": "m"},
    "universal_gravity": {"G": "m³/(kg s²)"},
    "angular_spring_forces": {"rest": "-", "k": "N m"},
    "spring_tension": {"rest": "m"},
    "hand_force": {"target": "m", "c": "N s/m"},
    "chain_sag": {"g": "m/s²"},
    "sliding_distance": {"width": "m", "mu_near": "-", "mu_far": "-", "g": "m/s²"},
    "my_friction": {"v_t": "m/s"},
    "rolling_time": {"way": "m", "slope": "-", "g": "m/s²"},
    "my_mesh": {"volume": "m³"},
    "proximal_sweep": {"r": "kg"}, "jacobi_step": {"r": "kg"},
    "fischer_burmeister": {"x": "m/s", "y": "m/s"},
    "forward_difference": {"s": "m", "h": "m", "p": "-"},
    "randomised": {"u": "-"},
    "grid_pairs": {"offsets": ""},
    "apply_blocks": {"block": "N/m"},
    "conjugate_gradients": {"right": "kg m/s", "A": "kg"},
    "apply_step_matrix": {"y": "m/s"},
    "kinetic_friction_step": {"d": "-"},
    "stopping_time": {"d": "-"},
    "tangential": {"y": "m/s"},
    "world_inertia": {"R": "-"},
    "world_inverse_inertia": {"R": "-"},
    "tumbling_rate": {"k": ""},
    "precession_rate": {"mgl": "N m", "tilt": "-", "spin": "rad/s"},
    "my_thrown_body": {"period": "s"},
    "check_over_plane": {"d": ""},
    "make_contacts": {"a": "", "b": ""},
    "skew": {"a": "rad/s"},
    "quaternion_product": {"a": "-", "b": "-"},
    "make_box": {"R": "-"},
    "repulsion": {"k": "m⁴/s²"},
    "make_flock": {"k": "m⁴/s²", "gather": "1/s²"},
    "free_flight": {"a": "m/s²"},
    "advance_to_plane": {"a": "m/s²"},
    "slide_on_plane": {"a": "m/s²"},
    "cross_2d": {"f": "N"},
    "distance_constraint": {"rest": "m"},
    "newton_correction": {"lam": "N"},
    "apply_positional_impulse": {"p": "kg m"},
    "rocking_step": {"x": "-", "v": "rad/s"},
    "advance_rocking": {"x": "-", "v": "rad/s"},
    "velocity_sweep_2d": {"give": "-"},
    "best_relaxation": {"rho": "-"},
    "mass_ratio_contraction": {"r": "-"},
    "gauss_seidel_sweep": {"omega": "-"},
    "contact_forces": {"load": "N | N | N m"},
    "delassus_matrix": {"G": "- | - | m", "w": "1/kg | 1/kg | 1/(kg m²)"},
    "cone_residual": {"J": "N s"},
    "solve_3r": {"target": "m | m | -"},
    "pose_2d": {"target": "m | m | -"},
    "pose_3d": {"target": "m | m | m | - | - | - | -"},
    "point_at": {"p": "m"},
    "share_past": {"w": "m"},
    "my_rule": {"goals": "m"},
    "elastic_rest_time": {"g": "m/s²", "h": "m"},
    "stopping_depth": {"speed": "m/s"},
    "jacobian_3d": {"a": "-"},
}

# Fields of records whose comments have no unit in brackets, and records that have the fields of another one.
UNIT_OF_FIELD = {"planes": "… m"}
LIKE = {"JointedBodies": "Bodies", "Arm3D": "Arm2D"}

# What functions return, in order; a record has the units of its fields.
RESULTS = {
    "integrators": {
        "m; m/s": "euler_step midpoint_step rk4_step average_velocity_step symplectic_euler_step verlet_step "
                  "blanes_moan_step implicit_euler_step implicit_midpoint_step advance advance_adaptive my_step",
        "s; m; m/s": "trajectory",
        "m/s": "difference_step velocity_round_off",
        "m/s²": "oscillator_acceleration",
        "m²": "inner_product",
        "- | s | 1/s | -": "amplification_matrix",
        "-": "growth_per_period newton_matrix solve spectral_radius observed_order"},
    "springs": {
        "N": "universal_gravity air_force spring_tension soft_constraint_force soft_contact_force spring_forces "
             "apply_blocks hand_force",
        "N; N; N": "angular_spring_forces",
        "m/s²": "spring_network_acceleration",
        "m; m/s": "mass_spring_damper_step implicit_spring_network_step",
        "N/m; N s/m": "spring_stiffness",
        "m": "chain_sag",
        "kg m/s": "apply_step_matrix",
        "m/s": "conjugate_gradients",
        "record": "make_spring_network",
        "-": "grid_pairs randomised"},
    "friction": {
        "s; m; m/s": "advance_to_event",
        "N": "normal_force cone_radius static_friction kinetic_friction",
        "N s": "pyramid_impulse friction_impulse particle_contact_impulse my_friction",
        "m/s": "tangential",
        "m/s²": "incline_acceleration driven_acceleration falling_acceleration",
        "m; m/s": "average_sliding_step pyramid_step event_step advance_particle sliding_step kinetic_friction_step "
                  "contact_step position_friction_step",
        "s": "slip_times stopping_time breakaway_time",
        "m; -": "particle_plane_gap particle_bowl_gap",
        "m": "friction_position_correction sliding_distance",
        "record": "make_block",
        "-": "slip_direction"},
    "inertia_tensors": {
        "kg; m": "centre_of_mass",
        "kg m/s": "linear_momentum",
        "s": "rolling_time",
        "m; ": "my_mesh",
        "kg m²/s": "angular_momentum",
        "kg m²": "point_mass_inertia box_inertia sphere_inertia cylinder_inertia capsule_inertia world_inertia "
                 "parallel_axes",
        "1/(kg m²)": "world_inverse_inertia",
        "kg m²; -": "principal_axes",
        "m³; m⁴; m⁵": "mesh_integrals",
        "record": "combine mesh_body",
        "": "check_inertia check_closed"},
    "rotation": {
        "rad/s²": "angular_acceleration",
        "rad/s": "angular_velocity skew tumbling_rate precession_rate",
        "kg m²/s": "body_angular_momentum",
        "-": "axis_angle_update matrix_update quaternion_product quaternion_update rotation_matrix intermediate_axis "
             "midpoint_free_rotation splitting_free_rotation",
        "-; kg m²/s": "compose midpoint_step splitting_step advance_rotation matrix_step axis_angle_step "
                      "quaternion_step gyroscopic_step implicit_gyroscopic_step runge_kutta_step "
                      "composed_splitting_step composed_midpoint_step",
        "s; -; kg m²/s; s; -": "checked_rotation",
        "s; -; kg m²/s": "rotation_trajectory",
        "m; -; m/s; rad/s": "advance_rigid_body rigid_body_step rolling_step average_rolling_step",
        "m/s": "point_velocity",
        "N; N m": "total_load supported_weight",
        "J": "kinetic_energy",
        "N m": "no_torque heavy_top_torque",
        "kg; m; m; rad/s": "my_thrown_body",
        "m/s; rad/s; N; N m": "state_derivative",
        "record": "make_rigid_body",
        "": "check_moments careful_throw_is"},
    "collisions": {
        "record": "ball_contact cylinder_contact make_plane ball_plane cylinder_hit ball_triangle capsule_capsule "
                  "ball_capsule build_tree points_plane against_face polygon_contacts make_box box_box make_flock "
                  "ball_box gjk",
        "m; -; -": "box_separation",
        "m; -": "separating_edge",
        "m": "clip closest_on_segment closest_on_triangle plane_distance ball_plane_gap ball_cylinder_gap "
             "edge_axis_distance triangle_cylinder_gap",
        "m; m": "nearer_pair closest_segments swept_box",
        "s": "cylinder_impact_time plane_impact_time ball_plane_time ball_cylinder_time",
        "m; m/s": "discrete_step continuous_step advance_projectiles",
        "m/s²": "repulsion steer flock_acceleration my_rule",
        "m²/s²": "flock_energy",
        "-": "find_intersections tree_pairs all_pairs share_past",
        "": "barrier_is"},
    "impulses": {
        "record": "apply_impulse apply_impulse_2d",
        "record; m/s": "sequential_impacts solve_impacts",
        "N s": "cone_impulse contact_impulse impulse_size gap_multiplier my_impulse",
        "1/kg": "contact_matrix effective_inverse_mass_2d effective_inverse_mass",
        "m; m/s": "free_flight penalty_step position_projection_discs_step backtracking_discs_step advance_balls "
                  "advance_discs position_projection_step slide_on_plane backtracking_step",
        "m": "gap project_to_plane",
        "s": "impact_time bouncing_time elastic_rest_time",
        "N": "penalty_force",
        "m/s; rad/s": "spinning_impact",
        "m; m/s; rad/s": "position_projection_spin_step backtracking_spin_step advance_spinning_balls",
        "m; m/s; s": "advance_to_plane",
        "m/s; m/s": "disc_impact",
        "m/s": "kinematic_response relative_velocity_2d relative_velocity",
        "m/s²": "falling_acceleration",
        "N m": "cross_2d",
        "kg m²/s; kg m²/s": "angular_momenta",
        "J": "energy_change",
        "": "check_over_plane smooth_rod_is"},
    "pbd": {
        "m; -": "apply_positional_impulse ball_gap constraints floor_gap distance_constraint",
        "N s²": "compliant_multiplier",
        "m; N s²": "compliant_sweep",
        "m": "constraint_correction distance_sweep keep_outside predict fold_sweep pbd_sag",
        "1/kg": "effective_inverse_mass_at",
        "-; 1/m": "fold_constraint",
        "rad/s": "turning_rate",
        "m³; m²": "volume_gradient",
        "m/s": "circling_speed",
        "": "substeps_are",
        "m/s²": "network_gravity",
        "m; m/s": "rattle_step cloth_step balloon_step constraint_projection_step pbd_step xpbd_step",
        "m; -; m/s; rad/s": "pivoted_body_step",
        "m; N": "newton_correction",
        "record": "make_constraint_network"},
    "contact": {
        "-": "has_left_margin stack_contraction mass_ratio_contraction",
        "-; -": "best_relaxation",
        "N s": "kept_impulses gauss_seidel_sweep solve_lcp cone_sweep solve_contacts friction_disc "
               "proximal_sweep jacobi_step normals_first_sweep minimum_map_step minimum_map_step_with_friction "
               "fischer_burmeister_step relaxed_sweep fewer_sweeps",
        "m": "relaxed_gap",
        "m/s; -; -": "fischer_burmeister",
        "m/s; -": "soft_contact contact_targets",
        "m/s; rad/s; N s": "velocity_sweep velocity_sweep_2d",
        "record": "advance_pile_2d advance_pile pile_trajectory make_contacts",
        "record; record": "make_pile_2d make_pile",
        "- | - | m": "contact_rows",
        "1/kg": "delassus_matrix",
        "m/s": "complementarity_residual cone_residual separation_speeds",
        "N; m/s² | m/s² | rad/s²": "contact_forces"},
    "simulator": {
        "record": "contact_step_2d contact_step settled_contact_step_2d mean_contact_step_2d joint_contact_step_2d "
                  "find_contacts advance_contact",
        "m/s; rad/s": "new_velocities_2d new_velocities corner_impact",
        "m; -; m/s; rad/s": "joint_step_2d composed_joint_step_2d free_step_2d free_step carried_step "
                            "exact_rolling_step advance_free",
        "rad/s²": "rods_acceleration swing_acceleration",
        "N; N m": "weight",
        "m/s": "support_velocity",
        "m": "stopping_depth",
        "": "may_be_extrapolated",
        "s": "slip_time",
        "-; rad/s": "rocking_step advance_rocking swinging_step advance_swinging",
        "J": "mechanical_energy gain_without_source",
        "kg m/s; kg m²/s": "momenta"},
    "kinematics": {
        "m": "joint_positions jacobian_2d point_at fabrik_sweep remaining_distance",
        "m; m; -": "velocity_ellipse",
        "-": "solve_2r solve_3r rotation_error angles_of transpose_step pseudo_inverse_step damped_step ccd_step "
             "fabrik_step limited_step null_space_step advance_reach reach_trajectory",
        "m; -; -": "joint_frames",
        "-; m; -": "solve_reach solve_targets",
        "rows m | m | m | - | - | -": "jacobian_3d",
        "m; m": "reach_2d reach_3d",
        "m | m | -; rows m | m | -": "pose_2d",
        "m | m | m | - | - | -; rows m | m | m | - | - | -": "pose_3d",
        "m | m | m | - | - | - | -": "end_pose",
        "": "newton_is",
        "1/m": "pseudo_inverse",
        "-; -": "contraction_factors",
        "record": "make_arm_2d make_arm_3d"},
    "sensitivities": {                                                   # the inputs of most have no unit
        "N": "central_difference forward_difference complex_step",
        "1/s²; 1/s; m/s²": "oscillator_derivatives",
        "m": "best_step",
        "m; m/s; m; m/s": "tangent_step tangent_implicit_step advance_tangents flight fly",
        "s; m; m/s; m; m/s": "tangent_trajectory",
        "s": "event_time_sensitivity predicted_horizon",
        "m; m/s": "saltation checked_tangents",
        "m/s; m; m/s": "bounce",
        "-": "remainder_orders",
        "m/s; m": "aim",
        "m/s; m; -": "checked_search",
        "s; -": "next_impact",
        "m; s": "throw_miss"},
}

UNDERFLOW = 1e-150           # numbers that count as 0, because what is computed from them loses its digits

# Differences over the largest number that are allowed; elsewhere all digits are the same.
ALLOWED = {
    "observed_order": 6e-14,     # logarithms of 1e-40, 92, have a rounding error of 1e-14, and differ by 0.7 or less
    "my_mesh": 1e-14,            # a cube root
    "remainder_orders": 1e-13,   # logarithms, too
    "best_step": 1e-15,          # a cube root
    "solve_lcp": 1e-14,          # rows of A beside rows of the identity matrix: elimination picks other pivots
}

NOT_SCALED = {
    "compare": "it compares two runs that the caller makes",
    "contact_trajectory": "it lists the states of advance_contact, which is in the table",
    "normal_forces": "it sums the impulses of such a list over dt",
    "my_scene": "it takes a number of boxes, whose sizes are its own, in metres",
    "my_body": "its size and its stiffness are its own",
    "my_thrown_body": "its mass and its size are its own",
    "my_rule": "its distances and its pace are those of people, in metres and seconds",
    "joint_impulses_2d": "it needs a step of joint_contact_step_2d, which is in the table",
}

# Tasks of tests that have a place and a direction.  Least squares adds metres and radians there, so the unit counts.
IN_METRES_AND_RADIANS = {"pose"}

# What a law that a test or a caller wrote takes and returns.  It gets its own parameters as they are.
LAWS = {
    "acceleration": (("s", "m", "m/s"), "m/s²"),
    "derivatives": (("s", "m", "m/s"), "1/s²; 1/s; m/s²"),
    "f of central_difference": (("m", "-"), "J"),
    "f of forward_difference": (("m", "-"), "J"),
    "f of complex_step": (("m", "-"), "J"),
    "f of remainder_orders": (("m", "-"), "J"),
    "sweep of fewer_sweeps": (("N s",), "N s"),
    "miss of aim": (("m/s", "-"), "m; s"),
    "torque": (("s", "-", "kg m²/s"), "N m"),
    "load": (("s", "m", "-", "m/s", "rad/s"), "N; N m"),
    "surface": (("m",), "m; -"),
    "gap": (("m",), "m"),
    "impact_time": (("s", "s", "m", "m"), "s"),
    "step of compose": (("", "s", "-", "kg m²/s", "s"), "-; kg m²/s"),
}

# Exponents of two of a length, a mass and a time.  They are even, so that a square root is a power of two, too.
WORLDS = {
    "longer": (20, 0, 0), "shorter": (-20, 0, 0), "heavier": (0, 20, 0), "lighter": (0, -20, 0),
    "slower": (0, 0, 20), "faster": (0, 0, -20), "all three": (-20, 40, 20),
}


# ---------------------------------------------------------------------------------------------- scaling a call

@functools.cache
def record_units():
    """{(record, its fields): {field: unit}} of all records in the lessons; units are in brackets after each field."""
    found = {}
    for path in modules.SOLUTIONS.rglob("*.py"):
        for name, body in re.findall(r"^class (\w+)\(NamedTuple\):\n((?:    .*\n|\n)+)", path.read_text(), re.M):
            fields = re.findall(r"^    (\w+): ([^#\n]*)(?:#(.*))?$", body, re.M)
            found[name, tuple(field for field, *_ in fields)] = {
                field: (re.findall(r"(?<!\w)\[([^]]+)\]", said) or [""])[0]
                for field, kind, said in fields if kind.strip() != "int"}
    of_name = {name: units for (name, _), units in found.items()}
    for (name, _), units in found.items():
        units.update({field: unit for field, unit in of_name.get(LIKE.get(name), {}).items() if field in units})
        units.update({field: UNIT_OF_FIELD[field] for field in units if field in UNIT_OF_FIELD})
    return found


def by_name(argument, lesson, function):
    """The unit of an argument of that name; an empty text if it has none."""
    for place in (function, lesson):
        if argument in OTHERWISE.get(place, {}):
            return OTHERWISE[place][argument]
    return next((unit for unit, names in UNITS.items() if argument in names.split()), "")


def factors(spec, shape, world):
    """The powers of two by which the numbers of an array of that shape are multiplied."""
    units = spec.removeprefix("rows ").removeprefix("… ").split(" | ")
    powers = np.array([2.0 ** int(exponents(unit) @ np.array(world)) for unit in units])
    if spec.startswith("… "):
        powers = np.concatenate((np.ones(shape[-1] - 1), powers))
    if len(powers) == 1:
        return powers[0]
    return np.repeat(powers, shape[1]).reshape(shape) if spec.startswith("rows ") else np.resize(powers, shape)


def scaled(value, spec, world):
    """A value in another world's units: a number, an array, a record, or several of these.

    What is no number or has no unit stays as it is, such as the number of a body.
    """
    if hasattr(value, "_fields"):
        by_names = {name: by_name(name, "", "") for name in value._fields}
        units = record_units().get((type(value).__name__, value._fields), by_names)
        return type(value)(*(scaled(one, units.get(name, ""), world) for name, one in value._asdict().items()))
    if isinstance(value, (tuple, list)) and not all(map(np.isscalar, value)):
        return type(value)(scaled(one, spec, world) for one in value)
    array = np.asarray(value)
    if not spec or array.dtype.kind not in "fic":
        return value
    result = array * factors(spec, array.shape, world)
    return type(value)(result.tolist()) if isinstance(value, (tuple, list)) else result if array.ndim else result.item()


def scaled_results(results, specs, world):
    """What a function returns, in another world's units: as many units as values."""
    if ";" not in specs:
        return scaled(results, specs, world)
    return tuple(scaled(one, spec, world) for one, spec in zip(results, specs.split("; "), strict=True))


def in_world(law, role, record, world):
    """A law of a caller in another world: it gets its own numbers and its own record."""
    arguments, results = LAWS[role]
    back = tuple(-power for power in world)

    def there(*given):
        here = [getattr(one, "here", one) if callable(one) else scaled(one, spec, back)
                for one, spec in zip(given, arguments, strict=False)]            # the last one is the record
        return scaled_results(law(*here, *record), results, world)
    there.here = law
    return there


def is_ours(value):
    """Whether a function or a record is defined in the lessons."""
    return bool(re.search(r"\b(solutions|subject)\b", (value if callable(value) else type(value)).__module__))


def scaled_call(lesson, name, function, call, world):
    """The arguments of a call in another world."""
    parameters = list(inspect.signature(function).parameters)
    record = [one for one in call if hasattr(one, "_fields")][-1:]
    found = []
    for parameter, value in zip(parameters, call, strict=True):
        if callable(value):
            whole = is_ours(value) and all(map(is_ours, record))
            role = next((role for role in (f"{parameter} of {name}", parameter) if role in LAWS), None)
            found.append(value if whole or not role else in_world(value, role, record, world))
        else:
            spec = by_name(parameter, lesson, name)
            if not spec and has_floats(value):
                raise BadInput(f"the unit of {parameter} of {name}", "unknown", "add it to UNITS or to OTHERWISE")
            found.append(scaled(value, spec, world))
    return found


def has_floats(value):
    """Whether a unit is needed: for a number or an array of floats, and not for a record."""
    if isinstance(value, (tuple, list)):
        return not hasattr(value, "_fields") and any(map(has_floats, value))
    return np.asarray(value).dtype.kind == "f"


# ---------------------------------------------------------------------------------------------- the tests

DEFAULT = "springs", "friction", "rotation"  # lessons whose calls take little to record


def result_of(function, call):
    """(result, None), or (None, the class of the error)."""
    with np.errstate(all="ignore"):
        try:
            return function(*call), None
        except (BadInput, Diverged, np.linalg.LinAlgError) as e:
            return None, type(e).__name__


def numbers_of(result):
    """All numbers of a result in one array."""
    if isinstance(result, (tuple, list)):
        return np.concatenate([np.zeros(0), *map(numbers_of, result)])
    return np.zeros(0) if result is None or isinstance(result, str) else np.asarray(result, float).ravel()


def difference(there, expected):
    """The largest difference over the largest number, 0 if all are equal, NaN included, or count as 0."""
    if there.shape != expected.shape:
        return np.inf
    there, expected = (np.where(np.abs(numbers) < UNDERFLOW, 0.0, numbers) for numbers in (there, expected))
    if np.array_equal(there, expected, equal_nan=True):
        return 0.0
    return float(np.max(np.abs(there - expected)) / np.max(np.abs(expected)))


def specs_of(lesson, name):
    """The units of what a function returns; None if RESULTS does not have it."""
    return next((unit for unit, names in RESULTS[lesson].items() if name in names.split()), None)


@pytest.mark.parametrize(("home", "each"), [
    *((name, 3) for name in DEFAULT),
    *(pytest.param(name, 1, marks=pytest.mark.long) for name in modules.lesson_names())])
def test_the_same_scene_in_other_units_gives_the_same_digits(home, each):
    """By default a third of the calls of some lessons, which are drawn alike; the long tests make all of them."""
    faults = []
    for (lesson, name), (function, calls) in calls_of(home).items():
        if name not in NOT_SCALED and inspect.signature(function).parameters:
            faults += [f"{name}, call {k * each}: {fault}" for k, call in enumerate(calls[::each])
                       if not IN_METRES_AND_RADIANS & {getattr(value, "__name__", "") for value in call}
                       for fault in faults_of(lesson, name, function, call)]
    assert not faults, f"{len(faults)}:\n" + "\n".join(faults)


def faults_of(lesson, name, function, call, strength=1):
    """Sentences about the worlds in which a call gives other digits."""
    here, error = result_of(function, call)
    for world, powers in WORLDS.items():
        powers = tuple(strength * power for power in powers)
        there, other = result_of(function, scaled_call(lesson, name, function, call, powers))
        if error != other:
            yield f"{world}: {other or 'a result'}, not {error or 'a result'}"
        elif not error:
            expected = numbers_of(scaled_results(here, specs_of(lesson, name), powers))
            off = difference(numbers_of(there), expected)
            if not off <= ALLOWED.get(name, 0.0):
                yield f"{world}: off by {off:.1e}"


@pytest.mark.long
def test_every_public_function_has_a_unit_and_an_ordinary_call():
    without = [f"{lesson}.{name}" for (lesson, name), (function, calls) in calls_of_all().items()
               if name not in NOT_SCALED and inspect.signature(function).parameters
               and (specs_of(lesson, name) is None or not calls)]
    assert not without, " ".join(without)
