"""A class is graded fairly: right answers get points, others get reasons, and grading again gives the same result."""

import csv
import fractions
import io
import json
import os
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
import pytest

from validate.grading import example, points, remote, sandbox, shipping, wire
from validate.subject import modules

from .test_cli import grade, run

PATIENCE = 600.0             # [s]: only a run that hangs takes so long, on the busiest machine, too


@pytest.fixture(scope="module", autouse=True)
def _sandbox():
    sandbox.for_tests(pytest.skip, pytest.fail)


@pytest.fixture(scope="module")
def top(tmp_path_factory):
    """Holds the example's class, handed in on 15 January 2027."""
    top = tmp_path_factory.mktemp("grading")
    for path in example.make(top / "class").rglob("*"):
        os.utime(path, (1.8e9, 1.8e9))
    return top


@pytest.fixture(scope="module")
def rows(top):
    """The class graded once, into the folder `one`: the lines of its CSV."""
    return graded(top / "class", top / "one", *LATE)


GRADE = (sys.executable, "-m", "validate.grading")
COURSE = ("--lesson", "integrators", "--seed", "a secret")
LATE = ("--due", "2027-01-01T00:00", "--late", "10")
pytestmark = pytest.mark.xdist_group("a graded class")


def graded(submissions, out, *more):
    """Run `grade` as an instructor does; return the rows of its CSV by student."""
    command = [*GRADE, str(submissions), "--out", str(out), *COURSE, *more]
    run = subprocess.run(command, cwd=modules.ROOT, capture_output=True, text=True)
    assert run.returncode == 0, run.stdout + run.stderr
    with open(os.path.join(out, "grades.csv"), newline="") as file:
        return {row["student_id"]: row for row in csv.DictReader(file)}


def test_points_are_given_for_what_is_right_and_reasons_for_the_rest(top, rows):
    assert [rows[s]["raw_score"] for s in ("ada", "bob", "cem", "dia", "eve")] == ["20", "19", "0", "20", "0"]
    assert rows["ada"]["max_score"] == "20" and float(rows["ada"]["late_submission_penalty"]) > 0.0

    def failing(student):
        tests = json.loads((top / "one" / "results" / f"{student}.json").read_text())["tests"]
        return [t for t in tests if t["status"] != "passed"]

    wrong = failing("bob")
    assert {t["exercise"] for t in wrong} == {"1.1"}
    assert wrong[0]["kind"] == "visible" and wrong[0]["says"].keys() >= {"quantity", "expected", "got"}
    assert all(t["status"] == "not attempted" for t in failing("cem"))
    assert all("ended before it answered" in t["says"]["got"] for t in failing("eve"))
    assert sum(t["points"] for t in failing("eve")) == 20             # nothing drops out of the maximum
    for page in ("index.html", *(f"students/{s}.html" for s in ("ada", "bob", "cem", "dia", "eve"))):
        assert "<html" in (top / "one" / page).read_text()


@pytest.mark.long
def test_the_same_class_graded_twice_gives_the_same_bytes_and_only_what_changed_is_graded_again(top, rows, tmp_path):
    graded(top / "class", tmp_path, *LATE, "--jobs", "1")
    for name in ("grades.csv", *(f"students/{path.name}" for path in (tmp_path / "students").iterdir())):
        assert (tmp_path / name).read_bytes() == (top / "one" / name).read_bytes(), name
    for path in (tmp_path / "results").iterdir():                     # the results are equal except for the time
        one, two = (json.loads(file.read_text()) for file in (path, top / "one" / "results" / path.name))
        assert {**one, "seconds": 0} == {**two, "seconds": 0}, path.name

    before = {path.name: path.stat().st_mtime_ns for path in (tmp_path / "results").iterdir()}
    changed = tmp_path / "class"
    shutil.copytree(top / "class", changed)
    (changed / "bob" / "lessons" / "integrators.py").write_text(example.worked("integrators"))
    again = graded(changed, tmp_path, *LATE)
    after = {path.name: path.stat().st_mtime_ns for path in (tmp_path / "results").iterdir()}
    assert {name for name in after if after[name] != before[name]} == {"bob.json"} and again["bob"]["raw_score"] == "20"


@pytest.mark.long
def test_an_interrupted_run_keeps_what_it_has_and_goes_on_from_there(top, tmp_path):
    for student in ("cem", "dan", "eda"):                              # three who have not begun
        (tmp_path / "class").mkdir(exist_ok=True)
        shutil.copy(top / "class" / "cem.zip", tmp_path / "class" / f"{student}.zip")
    command = [*GRADE, str(tmp_path / "class"), "--out", str(tmp_path / "out"), *COURSE, "--jobs", "1"]
    run = subprocess.Popen(command, cwd=modules.ROOT, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    results = tmp_path / "out" / "results"
    deadline = time.monotonic() + PATIENCE
    while not (results.is_dir() and list(results.glob("*.json"))) and time.monotonic() < deadline:
        time.sleep(0.02)
    run.send_signal(2)                                                 # Ctrl-C
    said, _ = run.communicate(timeout=PATIENCE)
    kept = {path.name: path.stat().st_mtime_ns for path in results.glob("*.json")}
    assert run.returncode in (0, 130) and kept and ("goes on from there" in said or run.returncode == 0)
    rows = graded(tmp_path / "class", tmp_path / "out")
    assert len(rows) == 3 and all((results / name).stat().st_mtime_ns == when for name, when in kept.items())


SPY = """
import os, sys
for here, _, names in os.walk(sys.prefix):
    for name in names:
        if name in ("seed.txt", "grades.csv", "ada.json") or "{0}" in here and name.endswith((".py", ".zip")):
            print("FOUND", here, name)
print("LOOKED")
"""


@pytest.mark.long
def test_a_class_below_the_environment_is_not_read_by_its_students(top):
    """In an image that has everything below /usr, answers, seed and other students' files are hidden among Python's."""
    with tempfile.TemporaryDirectory(dir=os.path.join(sys.prefix, "lib")) as place:
        os.chmod(place, 0o755)
        spy = os.path.join(place, "class", "spy")
        os.makedirs(spy)
        shutil.copytree(top / "class" / "bob", os.path.join(place, "class", "bob"))
        with open(os.path.join(spy, "integrators.py"), "w") as file:
            file.write(SPY.replace("{0}", os.path.basename(place)))
        graded(os.path.join(place, "class"), os.path.join(place, "out"))
        with open(os.path.join(place, "out", "results", "spy.json")) as file:
            printed = json.load(file)["printed"]["integrators"]
    assert "LOOKED" in printed and "FOUND" not in printed


@pytest.mark.parametrize(("arguments", "names"), [
    (["no/such/folder"], "no/such/folder"),
    (["{empty}"], "put one folder or zip per student into it"),
    (["{class}", "--lesson", "juggling"], "juggling"),
    (["{class}", "--due", "tomorrow"], "2026-11-30T23:59"),
    (["{class}", "--roster", "{list}"], "student_id"),
    (["{class}", "--out", sys.prefix], "every student's program can read"),
])
def test_bad_input_is_one_sentence_and_exit_code_2(top, tmp_path, capsys, arguments, names):
    (tmp_path / "empty").mkdir()
    (tmp_path / "list.csv").write_text("name\nAda\n")
    places = {"empty": tmp_path / "empty", "list": tmp_path / "list.csv", "class": top / "class"}
    filled = [a.format(**places) for a in arguments]
    out = [] if "--out" in filled else ["--out", str(tmp_path / "out")]
    code, _, error = run(capsys, grade, *out, *filled)
    assert code == 2 and names in error and len(error.strip().splitlines()) == 1
    assert not (tmp_path / "out" / "grades.csv").exists()


@pytest.mark.long
def test_the_sandbox_gives_the_same_points_as_the_same_tests_in_one_process():
    """The solutions are enough to show that the wire loses nothing."""
    for lesson in modules.lesson_names():
        place = remote.box_of(lesson, example.worked(lesson).encode(), 60.0)
        try:
            place.open()
            inside = points.score(points.grade(lesson, remote.lesson_in(place, lesson), seed="another"))
        finally:
            place.close()
        outside = points.score(points.grade(lesson, modules.bind(lesson), seed="another"))
        assert inside == outside, lesson


def test_what_is_given_beside_a_lesson_calls_the_students_exercises():
    """Of lesson 3's companion: event_step, and advance_particle, which gets an exercise as an argument."""
    text = example.worked("friction") + (
        "\n\ndef advance_to_event(acceleration, t, x, v, dt, p):\n    return dt, x + 42.0, v\n"
        "\n\ndef contact_step(acceleration, surface, t, x, v, dt, p):\n    return x + 42.0, v\n"
    )
    place = remote.box_of("friction", text.encode(), 60.0)
    try:
        place.open()
        lesson = remote.lesson_in(place, "friction")
        block = lesson.make_block([0.0, 1.0], 0.5, 0.4, [0.0, -9.81], [0.0, 0.0], 0.0)
        zero = np.zeros(2)
        assert lesson.event_step(lesson.driven_acceleration, 0.0, zero, zero, 0.1, block)[0][0] == 42.0
        particle = lesson.ParticleOnPlane(1.0, 0.5, 0.5, block.gravity, zero, block.n)
        x, _ = lesson.advance_particle(lesson.contact_step, lesson.falling_acceleration, lesson.particle_plane_gap,
                                       0.0, zero, zero, 0.1, 2, particle)
        assert x[0] == 84.0
    finally:
        place.close()


def law_with_a_law_inside(t, x, v, p):
    inner = lambda y: -p * y
    return inner(x)


def test_code_in_the_sandbox_does_not_tell_where_the_tests_lie():
    code, names, values = shipping.parts_of(law_with_a_law_inside)
    assert str(modules.ROOT).encode() not in code.tobytes() and Path(__file__).stem.encode() not in code.tobytes()
    assert shipping.function_of(code, names, values)(0.0, 2.0, 0.0, 3.0) == -6.0


def score_of(lesson, text):
    """The score of a file of answers that is graded in a box."""
    place = remote.box_of(lesson, text.encode(), 60.0)
    try:
        place.open()
        return points.score(points.grade(lesson, remote.lesson_in(place, lesson), seed="another"))
    finally:
        place.close()


def test_a_right_answer_is_right_in_longer_numbers():
    text = example.worked("integrators") + (
        "\n\ndef as_others(function):\n"
        "    return lambda *a: tuple(np.asarray(part, np.longdouble) for part in function(*a))\n\n\n"
        "euler_step, midpoint_step, rk4_step = map(as_others, (euler_step, midpoint_step, rk4_step))\n"
    )
    score = score_of("integrators", text)
    assert all(score[exercise][0] == score[exercise][1] for exercise in ("1.1", "1.2", "1.3"))


@pytest.mark.parametrize(("value", "expected"), [
    (np.longdouble(0.5), 0.5),
    (np.float16(2.0), 2.0),
    (np.uint8(3), 3),
    (np.bool_(True), True),
    (fractions.Fraction(1, 4), 0.25),
    (np.full(3, 0.5, np.longdouble), [0.5] * 3),
    (np.array([1, 2], np.int16), [1, 2]),
    (np.array([2**64 - 1], np.uint64), [2.0**64]),
    (np.array([1.0, fractions.Fraction(1, 2), 3], object), [1.0, 0.5, 3.0]),
    (np.array([1j], np.complex64), [1j]),
    (np.complex64(1.0 + 2.0j), 1.0 + 2.0j),
    (complex(0.5, -1e-20), complex(0.5, -1e-20)),
])
def test_numbers_of_any_kind_go_over_the_wire(value, expected):
    got = wire.unpack(*wire.read(io.BytesIO(wire.pack(value))))
    assert np.array_equal(got, expected)
    assert got.dtype.str[1:] in wire.DTYPES if isinstance(got, np.ndarray) else type(got) is type(expected)


def test_the_vector_form_of_a_product_serves_the_exercises_that_use_it():
    """a₀b₀ − 𝐚·𝐛 and a₀𝐛 + b₀𝐚 + 𝐚×𝐛, as the hint of 5.8 has it, instead of four sums."""
    text = example.worked("rotation") + (
        "\n\ndef product(a, b):\n    vector = a[0] * b[1:] + b[0] * a[1:] + np.cross(a[1:], b[1:])\n"
        "    return np.array([a[0] * b[0] - np.dot(a[1:], b[1:]), *vector])\n")
    assert all(earned == possible for earned, possible in score_of("rotation", text).values())
