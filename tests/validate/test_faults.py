"""The seeded faults are single faults, the command that plants them tells noticed from missed, and errors are findings.
"""

import io
import tokenize

import numpy as np
import pytest

from tests.faults import Fault, __main__, faults_of, file_of, honest, notice, planted
from tests.faults.drawn import drawn
from validate.measure.accuracy import errors
from validate.measure.selection import Plan
from validate.measure.timing import times
from validate.run import coverage
from validate.stability.examine import cases_of, stability_cases
from validate.subject import modules

pytestmark = pytest.mark.xdist_group("coverage")
LESSONS = modules.lesson_names()
EVERY = [fault for lesson in LESSONS for fault in faults_of(lesson)]


def test_there_are_at_least_eleven_faults_in_every_lesson_and_each_is_one_of_a_kind():
    assert all(len(faults_of(lesson)) >= 11 for lesson in LESSONS) and len(EVERY) >= 120
    assert len({(f.lesson, f.function, f.old, f.new) for f in EVERY}) == len(EVERY)


@pytest.mark.parametrize("name", LESSONS)
def test_a_fault_is_one_replacement_in_a_function_that_the_report_executes(name):
    for fault in faults_of(name):
        compile(planted(fault), fault.name, "exec")
        assert coverage.places()[coverage.defined((fault.lesson, fault.function))], fault.name
        assert fault.old.count("\n") <= 1 and fault.new.count("\n") <= 1, fault.name
        assert fault.wrong and not fault.wrong.endswith("."), fault.name


@pytest.mark.parametrize("old", ["C", "no such text"])
def test_a_fault_that_occurs_twice_or_never_is_refused(old):
    with pytest.raises(ValueError, match="occurs"):
        planted(Fault("springs", "soft_constraint_force", old, "x", ""))


def test_random_faults_are_single_exchanges_in_given_functions_that_the_report_executes():
    faults = drawn(12, seed=1)
    assert faults == drawn(12, seed=1) != drawn(12, seed=2)
    assert len({(f.lesson, f.function) for f in faults}) == 12 and not {f.lesson for f in faults} & set(LESSONS)
    for fault in faults:
        compile(planted(fault), fault.name, "exec")
        assert coverage.places()[coverage.defined((fault.lesson, fault.function))]
        same = [a == b for a, b in zip(words_of(fault.old), words_of(fault.new), strict=True)]
        assert same.count(False) == 1, fault.wrong


def words_of(text):
    return [token.string for token in tokenize.generate_tokens(io.StringIO(text.strip()).readline)
            if token.string.strip()]


HARMLESS = Fault("springs", "air_force", "wind - k_v * v", "-(k_v * v) + wind", "nothing")


@pytest.fixture
def alone(monkeypatch, tmp_path):
    """The command without other processes, and with a file of its own for what it keeps."""
    class Here:
        def each(self, calls, kinds=None, alone=False):
            return ((key, call[0](*call[1:])) for key, call in calls.items())
    monkeypatch.setattr(__main__, "KEPT", tmp_path / "kept" / "faults.json")
    monkeypatch.setattr(coverage, "places", lambda: {("springs", "air_force"): ["stability/springs/lecture-step"]})
    return Here()


def test_wrong_physics_turns_a_finding_and_right_physics_turns_none(alone, capsys):
    wrong = HARMLESS._replace(new="wind - 1.01 * k_v * v", wrong="1 % too viscous")
    assert __main__.seeded([wrong], 300, alone) == 0
    assert "stability/springs/lecture-step" in capsys.readouterr().out
    assert __main__.seeded([wrong, HARMLESS], 300, alone) == 1
    assert "MISSED springs.air_force: nothing" in capsys.readouterr().out


def test_an_interrupted_run_goes_on_where_it_was(alone, monkeypatch):
    assert __main__.seeded([HARMLESS], 300, alone) == 1
    monkeypatch.setattr(__main__, "notice", None)                    # it would fail if it were called
    assert __main__.seeded([HARMLESS], 300, alone) == 1


def test_a_scene_notices_a_fault_on_a_coarse_sweep_and_the_worked_answers_turn_nothing():
    fault = Fault("integrators", "rk4_step", "dt / 6.0 * (a1", "dt / 5.9 * (a1", "velocities change 2 % too much")
    function = fault.lesson, fault.function
    with notice.copy_with({fault.lesson: planted(fault)}) as copy:
        assert "Runge–Kutta 4" in notice.turned_at("linear_drag", copy, function, 300)
    with notice.copy_with({}) as copy:
        assert notice.turned_at("linear_drag", copy, function, 300) == ""


IN_GIVEN = [                      # a fault in a given module; a place that notices it, and what it says
    (Fault("support.shapes", "capsule_moments", "0.75 * h * r", "0.7 * h * r", ""),
     "stability/simulator/loop-from-a-model", "moments"),
    (Fault("given.impulses", "spinning_impact", "+ p.inv_mass * J", "+ 2.0 * p.inv_mass * J", ""),
     "spinning_bounce", "projecting"),
]


@pytest.mark.parametrize(("fault", "place", "words"), IN_GIVEN, ids=[row[0].lesson for row in IN_GIVEN])
def test_a_fault_in_a_given_module_is_seen_while_it_is_there_and_its_own_text_turns_nothing(fault, place, words):
    own = (modules.SOLUTIONS / file_of(fault.lesson)).read_text(encoding="utf-8")
    function = fault.lesson, fault.function
    with notice.copy_with({fault.lesson: own}) as copy:
        assert notice.turned_at(place, copy, function, 300) == ""
    with notice.copy_with({fault.lesson: planted(fault)}) as copy:
        assert words in notice.turned_at(place, copy, function, 300)
    assert notice.turned_at(place, "solutions", function, 300) == ""


def test_honest_runs_differ_and_a_wrong_one_among_them_is_an_alarm(monkeypatch):
    import random
    texts = {honest.varied("springs", random.Random(seed))[0] for seed in range(3)}
    assert len(texts) == 3
    with honest.other_seeds(1000):
        assert np.random.default_rng(1).normal() != np.random.default_rng(2).normal()
    first = np.random.default_rng(1).normal()
    with honest.other_seeds(1000):
        assert np.random.default_rng(1).normal() != first
    wrong = planted(HARMLESS._replace(new="wind + k_v * v"))
    monkeypatch.setattr(honest, "varied", lambda lesson, draw: (wrong, 1))
    monkeypatch.setattr(honest, "places_of", lambda lesson, draw: ["stability/springs/lecture-step"])
    assert list(honest.honest_run(LESSONS.index("springs")).alarms) == ["stability/springs/lecture-step"]


BROKEN = [                        # lesson, a function of it, its first line, and what happens there instead
    ("springs", "spring_tension", "return k", "raise BadInput('a spring', k, 'take another'); return k"),
    ("friction", "particle_bowl_gap", "distance = np.sqrt(r @ r)", "raise SystemExit(3)"),
    ("inertia_tensors", "linear_momentum", "return m @ v", "return None"),
    ("impulses", "gap_multiplier", "return np.maximum", "return 1 // 0 + np.maximum"),
    ("kinematics", "velocity_ellipse", "for k in range(J.shape[1])", "for k in range(J.shape[1] + 1)"),
]


@pytest.mark.parametrize(("of", "function", "old", "new"), BROKEN, ids=[row[1] for row in BROKEN])
def test_an_error_inside_a_stability_case_is_a_finding_and_the_others_run(of, function, old, new, monkeypatch):
    quick = {"forces", "lecture-step", "laws-of-friction", "momenta", "thin-bodies", "laws-of-an-impact", "two-bodies",
             "geometry-of-arms", "extremes", "times-of-stops-and-starts"}
    chosen = {slug: case for slug, case in cases_of(of).items() if slug in quick}
    monkeypatch.setattr("validate.stability.examine.cases_of", lambda lesson: chosen)
    with notice.copy_with({of: planted(Fault(of, function, old, new, ""))}) as copy:
        found = stability_cases(of, Plan(of=str(copy), speeds=("plain",), live=()))
    assert [one["slug"] for one in found] == list(chosen)
    lost = [finding for one in found for finding in one["findings"] if not finding["holds"]]
    assert lost and any(all(finding["holds"] for finding in one["findings"]) for one in found)
    assert any("The case runs without an error" in finding["claim"] for finding in lost)


@pytest.mark.parametrize("new", ["raise BadInput('a spring', 1.0, 'x')", "raise SystemExit(3)", "return 1 // 0"])
def test_an_error_in_a_scene_is_a_departure_and_nothing_is_timed(new):
    text = (modules.SOLUTIONS / "springs.py").read_text(encoding="utf-8").replace("from .", "from solutions.")
    text += f"\n\ndef angular_spring_forces(x_a, x_b, x_c, rest, k):\n    {new}\n"
    with notice.copy_with({"springs": text}) as copy:
        plan = Plan(of=str(copy), speeds=("plain",), live=())
        result = errors("angular_spring", plan)
        assert {c["verdict"] for case in result["cases"].values() for c in case["ours"]} == {"departs"}
        assert times("angular_spring", plan, result)["rows"] == []
