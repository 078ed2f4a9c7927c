"""Theory's bounds of stability are found again by experiment, and a wrong method does not find them."""

import ast
import json
import re
import types
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from solutions.checks import BadInput
from validate.check import states
from validate.engines.products import PYBULLET
from validate.measure.selection import Plan
from validate.methods import EULER
from validate.report import required
from validate.stability import examine as examine_module
from validate.stability import integrators
from validate.stability.case import EDGE, Case, Checks, Examined, NotRun, Worst, bisect
from validate.stability.examine import all_cases, examine, found_by, stored, subject_of
from validate.subject.modules import ROOT

examined = cache(examine)
CASES = {f"{case.lesson}/{case.slug}": case for case in all_cases()}
LISTED = json.loads(required.FILE.read_text(encoding="utf-8"))
LAST = {case.lesson: name for name, case in CASES.items()}           # `validate` examines all; by default one each
LAST |= {"integrators": "integrators/what-measures-methods", "springs": "springs/large-step",        # not a slow one
         "impulses": "impulses/laws-of-an-impact"}


def marks_of(name, case):
    """All of a lesson in one process, where the lesson's own tests compile it; long unless it is the lesson's last."""
    return [pytest.mark.xdist_group(f"compiled test_{case.lesson}"),
            *([] if name in LAST.values() else [pytest.mark.long])]


every_case = pytest.mark.parametrize("case", [
    pytest.param(case, id=name, marks=marks_of(name, case)) for name, case in CASES.items()])


@every_case
def test_experiment_finds_the_bound_that_theory_gives(case):
    lost = [f for f in examined(case).findings if not f.holds]
    assert not lost, "\n".join(f"{f.quantity}: theory {f.predicted}, measured {f.measured}, tolerance {f.tolerance}"
                               for f in lost)


@every_case
def test_a_picture_holds_plain_finite_numbers(case):
    picture = examined(case).picture
    for label, xs, ys, style in picture.series if picture else ():
        assert type(xs) is type(ys) is list and len(xs) == len(ys) and np.all(np.isfinite(xs + ys)), label
        assert style in ("line", "dots")


@every_case
def test_every_finding_says_what_it_claims_in_sentences(case):
    found = examined(case).findings
    for f in found:
        assert f.claim.endswith(".") and f.observation.endswith(".") and f.quantity.endswith("]")
    assert len({f.quantity for f in found}) == len(found)


@every_case
def test_the_list_of_the_audit_has_the_laws_and_tolerances_of_the_code(case):
    found = stored(examined(case))
    wanted = {required.place(found): LISTED["findings"].get(required.place(found), {})}
    assert list(required.missing_findings([found], wanted)) == [], "run: python -m validate.report.required"
    quantities = {one["quantity"] for one in [*found["findings"], *found["not_run"]]}
    assert quantities == set(wanted[required.place(found)]), "run: python -m validate.report.required"


def test_a_finding_of_an_engine_that_is_not_installed_is_not_run_and_is_kept_as_such():
    absent, check = replace(PYBULLET, distribution="no-distribution-has-this-name"), Checks()
    check.by(absent, "It holds.", "share [-]", dict)
    assert check == [] and check.not_run == [NotRun("It holds.", "share [-]", "pybullet is not installed here")]
    kept = stored(Examined("slug", "Title", "contact", check, None, check.not_run))
    assert kept["findings"] == [] and kept["not_run"][0]["why"] == "pybullet is not installed here"


def test_a_quick_validation_leaves_the_cases_that_it_says_and_a_full_one_none(monkeypatch):
    two = {slug: Case(slug, slug, "springs", lambda lesson, check: None, False, slug == "short")
           for slug in ("short", "slow")}
    monkeypatch.setattr(examine_module, "cases_of", lambda lesson: two)
    for quick, slugs in ((True, ["short"]), (False, ["short", "slow"])):
        plan = Plan(quick=quick)
        assert [case["slug"] for case in examine_module.stability_cases("springs", plan)] == slugs
        assert [case.slug for case in examine_module.left_to_full("springs", plan)] == ["slow"] * quick


def test_slugs_can_stand_in_an_address_and_are_unique_within_a_lesson():
    for name, case in CASES.items():
        assert re.fullmatch(r"[a-z0-9]+(-[a-z0-9]+)*", case.slug), name
    assert len(CASES) == len(all_cases())


WRONG = [                         # case, the method that it examines, what is put in its place
    ("integrators/amplification", "verlet_step", "symplectic_euler_step"),
    ("integrators/amplification", "midpoint_step", "average_velocity_step"),
    ("integrators/explicit-euler", "euler_step", "symplectic_euler_step"),
    ("integrators/symplectic-euler", "symplectic_euler_step", "euler_step"),
    ("integrators/midpoint", "midpoint_step", "euler_step"),
    ("integrators/rk4", "rk4_step", "midpoint_step"),
    ("integrators/implicit-euler", "implicit_euler_step", "implicit_midpoint_step"),
    ("integrators/phase-error", "verlet_step", "midpoint_step"),
    ("integrators/phase-error", "implicit_midpoint_step", "implicit_euler_step"),
    ("integrators/stiff-pair", "implicit_euler_step", "symplectic_euler_step"),
    ("integrators/robertson", "implicit_euler_step", "implicit_midpoint_step"),
    ("rotation/gyroscopic-drift", "gyroscopic_step", "implicit_gyroscopic_step"),
    ("rotation/gyroscopic-drift", "matrix_step", "axis_angle_step"),
    ("rotation/gyroscopic-drift", "midpoint_step", "quaternion_step"),
    ("rotation/fast-spin", "splitting_step", "quaternion_step"),
    ("rotation/slender-body", "midpoint_step", "runge_kutta_step"),
    ("rotation/sleeping-top", "composed_splitting_step", "quaternion_step"),
]


SLOW = {"rotation/fast-spin", "rotation/slender-body", "rotation/sleeping-top"}       # they compile loops for seconds


def wrong_methods():
    """By default the first of each case that is not slow; `pytest --long` tries all."""
    for k, (name, method, wrong) in enumerate(WRONG):
        marks = [pytest.mark.xdist_group(f"compiled test_{CASES[name].lesson}"),
                 *[pytest.mark.long] * (name in SLOW or name in [other for other, *_ in WRONG[:k]])]
        yield pytest.param(name, method, wrong, id=f"{name}-{wrong}_as_{method}", marks=marks)


@pytest.mark.parametrize(("name", "method", "wrong"), list(wrong_methods()))
def test_a_wrong_method_does_not_find_the_bound(name, method, wrong):
    lesson = subject_of(CASES[name])
    subject = types.SimpleNamespace(**{**vars(lesson), method: getattr(lesson, wrong)})
    with np.errstate(all="ignore"):
        found, _ = found_by(CASES[name], subject)
    assert not all(f.holds for f in found)


def about_the_world(density, x, faces):
    lesson = subject_of(CASES["inertia_tensors/far-from-origin"])
    V, first, second = lesson.mesh_integrals(x, faces)
    C = second - np.outer(first, first) / V
    return lesson.MassProperties(density * V, first / V, density * (np.trace(C) * np.eye(3) - C))


def without_tolerance(I):
    moments = np.linalg.eigvalsh(I)
    if moments[0] <= 0.0 or moments[2] > moments[0] + moments[1]:
        raise BadInput("a tensor", moments[2], "give another")


@pytest.mark.parametrize(("slug", "method", "function"), [
    ("far-from-origin", "mesh_body", about_the_world), ("thin-bodies", "check_inertia", without_tolerance)])
def test_a_wrong_tensor_does_not_find_the_bound(slug, method, function):
    case = CASES[f"inertia_tensors/{slug}"]
    subject = types.SimpleNamespace(**{**vars(subject_of(case)), method: function})
    assert not all(f.holds for f in found_by(case, subject)[0])


FORMULAS = {
    "springs/forces": ("universal_gravity", "soft_constraint_force", "soft_contact_force"),
    "springs/lecture-step": ("mass_spring_damper_step",),
    "inertia_tensors/momenta": ("linear_momentum", "angular_momentum"),
    "rotation/loads-and-derivatives": ("total_load", "state_derivative", "tumbling_rate"),
    "collisions/cloth-swept-steered": ("triangle_cylinder_gap", "swept_box", "steer"),
    "impulses/two-bodies": ("relative_velocity_2d", "effective_inverse_mass_2d", "apply_impulse_2d", "impulse_size",
                            "effective_inverse_mass", "angular_momenta"),
    "integrators/one-step": ("euler_step", "rk4_step", "verlet_step", "implicit_midpoint_step", "blanes_moan_step"),
    "integrators/adaptive-steps": ("advance_adaptive",),
    "integrators/what-measures-methods": ("amplification_matrix", "newton_matrix", "spectral_radius", "observed_order"),
    "springs/angular-spring-forces": ("angular_spring_forces",),
    "springs/large-step": ("spring_stiffness", "implicit_spring_network_step"),
    "friction/laws-of-friction": ("normal_force", "static_friction", "kinetic_friction", "incline_acceleration",
                                  "friction_impulse", "pyramid_impulse", "sliding_step", "particle_bowl_gap",
                                  "particle_contact_impulse", "contact_step", "friction_position_correction",
                                  "position_friction_step"),
    "friction/times-of-stops-and-starts": ("advance_to_event", "slip_direction", "kinetic_friction_step"),
    "inertia_tensors/bodies-with-holes": ("centre_of_mass", "linear_momentum", "angular_momentum", "principal_axes",
                                          "point_mass_inertia", "combine", "world_inertia", "world_inverse_inertia"),
    "rotation/one-step-of-the-loop": ("rigid_body_step", "supported_weight", "rolling_step"),
    "collisions/nearest-features": ("closest_on_triangle", "ball_box", "clip", "flock_acceleration"),
    "impulses/laws-of-an-impact": ("kinematic_response", "penalty_force", "contact_matrix", "cone_impulse",
                                   "energy_change", "gap_multiplier", "impact_time", "slide_on_plane"),
    "pbd/constraints-and-their-gradients": ("distance_constraint", "constraint_correction", "newton_correction",
                                            "fold_constraint", "ball_gap", "volume_gradient", "turning_rate",
                                            "effective_inverse_mass_at", "apply_positional_impulse"),
    "contact/laws-of-contact": ("contact_rows", "delassus_matrix", "gauss_seidel_sweep", "solve_lcp", "cone_sweep",
                                "cone_residual", "complementarity_residual", "soft_contact", "kept_impulses"),
    "simulator/loop-by-parts": ("free_step_2d", "free_step", "mechanical_energy", "momenta", "gain_without_source",
                                "closing_speeds", "corner_impact", "slip_time", "support_velocity"),
    "kinematics/geometry-of-arms": ("velocity_ellipse", "rotation_error", "limited_step", "null_space_step"),
    "contact/closed-forms": ("stack_contraction", "mass_ratio_contraction", "best_relaxation", "friction_disc"),
}


def scaled(value, factor):
    """The same result, a little larger or smaller: a number, an array, or a tuple of them."""
    if isinstance(value, tuple):
        parts = [scaled(part, factor) for part in value]
        return type(value)(*parts) if hasattr(value, "_fields") else tuple(parts)
    return factor * np.asarray(value) if np.ndim(value) else factor * value


@pytest.mark.long
@pytest.mark.parametrize("factor", [0.999, 1.001])
@pytest.mark.parametrize(("name", "function"), [(name, f) for name, every in FORMULAS.items() for f in every])
def test_a_formula_that_is_a_thousandth_off_is_seen(name, function, factor):
    lesson = subject_of(CASES[name])
    right = getattr(lesson, function)
    wrong = lambda *arguments: scaled(right(*arguments), factor)
    subject = types.SimpleNamespace(**{**vars(lesson), function: wrong})
    assert not all(f.holds for f in found_by(CASES[name], subject)[0])


def test_an_edge_that_is_a_hundredth_off_is_seen_on_the_map_of_amplification(monkeypatch):
    case, edge = CASES["integrators/amplification"], integrators.EDGES[EULER]
    monkeypatch.setitem(integrators.EDGES, EULER, lambda zeta: 1.01 * edge(zeta))
    found, picture = found_by(case, subject_of(case))
    assert [f.holds for f in found] == [False] + 5 * [True]
    assert all(np.shape(one["values"]) == (len(one["ys"]), len(one["xs"])) >= (100, 100) for one in picture.maps)


def test_a_measurement_that_failed_is_a_finding_that_does_not_hold():
    for measured in (np.nan, np.inf):
        assert not states("speed [m/s]", measured, 1.0, 0.1).holds


def test_no_case_takes_its_largest_error_with_a_function_that_drops_a_nan():
    """max([0.0, nan]) is 0.0, and so is max(0.0, nan); np.max and np.maximum give NaN."""
    calls = [(path.name, node) for path in (ROOT / "validate" / "stability").glob("*.py")
             for node in ast.walk(ast.parse(path.read_text(encoding="utf-8")))
             if isinstance(node, ast.Call) and getattr(node.func, "id", "") == "max"]
    dropping = [(name, call.lineno, ast.unparse(call)) for name, call in calls
                if len(call.args) == 1 or any(isinstance(one, ast.Starred) for one in call.args)]
    assert calls and not dropping, dropping


def test_bisection_says_so_when_there_is_no_edge():
    assert bisect(lambda h: True, 0.05, 4.0) == 0.0
    assert bisect(lambda h: False, 0.05, 4.0) == np.inf
    assert bisect(lambda h: h > np.pi, 0.05, 4.0) == pytest.approx(np.pi, rel=EDGE)


def test_the_worst_error_keeps_a_nan_and_asks_for_a_trial():
    worst = Worst()
    assert np.isnan(worst["never tried"])
    worst.keep("law", 1.0, 2.0)
    worst.note("pair", (np.array([1.0, np.inf]), 3.0), (np.array([1.5, np.inf]), 3.0))
    assert worst["law"] == 2.0 and worst["pair"] == 0.5
    for error in (np.nan, 1.0):
        worst.keep("law", error)
    assert np.isnan(worst["law"])
