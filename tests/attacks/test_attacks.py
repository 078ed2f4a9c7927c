"""The grader withstands hostile submissions.

No attack gains a point, reveals a secret, leaves anything behind, or touches another student's result.
"""

import contextlib
import json
import os
import re
import resource
import socket
import stat
import struct
import tempfile
import threading
import time
import zipfile
from pathlib import Path

import numpy as np
import pytest

from validate.grading import box, children, expect, marking, plugin, points, remote, submissions
from validate.subject.modules import ROOT, SOLUTIONS

from . import ATTACKS, HONEST, SOLVED
from .integrators import PRETENDED
from .trial import BUDGET, MARK, SEED

SLACK = 60.0                 # time of two runs of pytest beside the student's, on a busy machine [s]
FORBIDDEN = re.compile(
    r"[\x00-\x09\x0b-\x1f\x7f-\x9f"
    r"\u200b-\u200f\u202a-\u202e\u2066-\u2069\ud800-\udfff]"
)


@contextlib.contextmanager
def nothing_left():
    """Assert that the block leaves no process, thread, open file or folder of the grader behind."""
    before = threads(), descriptors(), folders()
    yield
    until = time.monotonic() + SLACK                                    # on an idle machine a hundredth of a second
    while time.monotonic() < until and (processes() or threads() - before[0]):
        time.sleep(0.05)
    assert not processes()
    assert not threads() - before[0]
    assert descriptors() <= before[1]
    assert folders() <= before[2]


def threads():
    return set(threading.enumerate())


def descriptors():
    return len(os.listdir("/proc/self/fd"))


def folders():
    """Folders that sandboxes have made in their own temporary folder."""
    return set(os.listdir(tempfile.gettempdir()))


def processes():
    """Processes that the sandboxes have started and that are still alive."""
    alive = []
    for pid in filter(str.isdigit, os.listdir("/proc")):
        with contextlib.suppress(OSError):
            if MARK.encode() in Path(f"/proc/{pid}/environ").read_bytes():
                alive.append(pid)
    return alive


def graded(text, settings, lesson="integrators"):
    """Grade one file, assert that nothing is left of it, and return the result."""
    file = text.encode() if isinstance(text, str) else text
    with nothing_left():
        began = time.monotonic()
        result = marking.mark(submissions.Submission("mallory", {lesson: file}, (), ""), settings[lesson])
        assert time.monotonic() - began < box.CROWDED * BUDGET + SLACK
    return result


def earned(result):
    """{exercise: points}."""
    return {test["exercise"]: test["earned"] for test in result["tests"]}


def harmless(result):
    """Assert that a result has no control characters and is not too long for a page; return it as JSON."""
    text = json.dumps(result, ensure_ascii=False)
    assert not FORBIDDEN.search(text.replace("\\n", ""))
    assert not re.search(r"\\u00|\\ud|\\t|\\r", text)
    assert len(text) < 40_000
    return text


NOTHING = {"1.1": 0, "1.2": 0, "1.7": 0, "1.9": 0}
EVERYTHING = {"1.1": 4, "1.2": 4, "1.7": 2, "1.9": 4, "1.10": 2}


# ---------------------------------------------------------------------------------------------- files of students

@pytest.mark.long
@pytest.mark.parametrize("case", ATTACKS, ids=lambda case: case.name.replace(" ", "_"))
def test_an_attack_gains_nothing_and_touches_no_other_student(case, trial, settings):
    result = graded(written(case), settings)
    assert earned(result) == {**NOTHING, "1.10": 0 if case.lost else 2}, f"{case.gain}\n{result}"
    text = harmless(result)
    assert not [word for word in case.shows if word in text]
    assert not secrets_in(result, settings["integrators"].manifest)


@pytest.mark.long
def test_honest_files_keep_their_points_among_the_attacks(trial, settings, monkeypatch):
    monkeypatch.setattr(plugin, "BOX_LIMIT", points.BOX_LIMIT)
    assert earned(graded(HONEST, settings)) == {**NOTHING, "1.10": 2}
    assert earned(graded(SOLVED, settings)) == EVERYTHING
    for name in ("answers ahead", "moving the target", "a daemon"):
        graded(written(next(case for case in ATTACKS if name in case.name)), settings)
        assert earned(graded(SOLVED, settings)) == EVERYTHING, f"after {name}"


@pytest.mark.long
@pytest.mark.parametrize("text", PRETENDED.values(), ids=[name.replace(" ", "_") for name in PRETENDED])
def test_lesson_1_gives_no_points_without_an_integrator(text):
    """With its own tests, not those of the trial."""
    place = remote.box_of("integrators", text.encode(), 60.0)
    try:
        place.open()
        score = points.score(points.grade("integrators", remote.lesson_in(place, "integrators"), seed=SEED))
    finally:
        place.close()
    no_step = {exercise: possible for exercise, (_, possible) in score.items() if int(exercise.partition(".")[2]) > 8}
    assert {exercise: earned for exercise, (earned, _) in score.items() if earned} == no_step


TESTS = {"test_euler": 3, "test_midpoint": 3, "test_implicit": 2}


def inputs(seed, test="test_euler"):
    """x, v, p and dt that the trial draws for a test of one step."""
    draw = plugin.Draw(seed, test)
    x, v = draw(-1.0, 1.0, TESTS[test]), draw(-1.0, 1.0, TESTS[test])
    return x, v, draw(1.0, 9.0), draw(0.05, 0.1)


def known():
    """The public inputs with their right answers, which a student can find by reading the tests."""
    x, v, p, dt = inputs(points.PUBLIC)
    moving = x, x + dt * v, v - dt * p * x
    still = [0.4, -0.7, 1.1]
    return repr([tuple(part.tolist() for part in moving), (still, still, still)])


def written(case):
    """The attack's file."""
    public = [0.4, *(inputs(points.PUBLIC, test)[0][0] for test in TESTS)]
    return HONEST + case.text.replace("{KNOWN}", known()).replace("{PUBLIC}", f"np.array({public})")


def secrets_in(result, manifest):
    """Secrets in a result: tests with secret inputs that report more than they may, and digits of those inputs."""
    hidden = [test for test in result["tests"] if test["kind"] == "hidden"]
    hints = {row[3]: row[5] for row in manifest}
    failed = [test for test in hidden if test["status"] == "not yet"]
    more = [test for test in failed if not reports_little(test, hints[test["test"]])]
    text = json.dumps([hidden, result["printed"]])
    numbers = [abs(number) for test in TESTS for part in inputs(SEED, test) for number in np.ravel(part)]
    return more + [number for number in numbers if f"{number:.6f}"[2:] in text or str(int(1e9 * number)) in text]


def reports_little(test, hint):
    """Whether a failed test reports only the quantity, one of the allowed words and the hint of the exercise."""
    return test["says"]["got"] in marking.WORDS and set(test["says"]) == {"quantity", "got"} and test["hint"] == hint


ERRORS = [
    "", "x", "1.2e-03 off", "shape (123, 4)", "a Secret123", "an AttributeError", "not finite", "no error",
    "another value", "Secret123", "ValueError (integrators.py, line 123)", *expect.OFF,
]


@pytest.mark.long
@pytest.mark.parametrize("error", ERRORS)
def test_with_secret_inputs_a_test_says_one_of_few_words(error):
    numbers = "12.3", "12.4", "1.2345e-9"
    o = points.Outcome("1.1", "test_it", 1.0, "not yet", "x after a step", *numbers, "a hint", error, "x = 12.3")
    said = marking.says(o, "hidden")
    assert said == {"quantity": "x after a step", "got": said["got"]}
    assert said["got"] in marking.WORDS and len(marking.WORDS) <= 6


def test_a_program_cannot_call_a_failed_test_with_secret_inputs_not_attempted():
    o = points.Outcome("1.1", "test_it", 1.0, "not attempted", "x after a step", hint="a hint")
    row = ("integrators", "1.1", "euler_step", "test_it", 1.0, "the hint of the exercise")
    outcomes = {
        ("integrators", "visible", "test_it"): o._replace(status="passed"),
        ("integrators", "hidden", "test_it"): o,
    }
    verdict = marking.verdict(row, outcomes, True)
    assert verdict["status"] == "not yet" and verdict["hint"] == "the hint of the exercise"


@pytest.mark.long
@pytest.mark.parametrize(("got", "word"), [(1.001, 0), (1.5, 1), (-0.5, 2), (1e300, 2), (np.array([1.0]), None)])
def test_an_error_has_one_of_three_sizes(got, word):
    size = "shape (1,)" if word is None else expect.OFF[word]
    for compare in (lambda: expect.close("x", got, 1.0, 1e-9), lambda: expect.between("x", got, 1.0, 1.0)):
        with pytest.raises(expect.NotYet) as failure:
            compare()
        assert failure.value.error == size
    with pytest.raises(expect.NotYet) as failure:
        expect.close("residual", np.array([0.0, 1e-3]), np.zeros(2), 1e-9)
    assert failure.value.error == "slightly off"


# ---------------------------------------------------------------------------------------------- time and memory

def honest_air(text=""):
    return "import numpy as np\ndef air_force(v, wind, k_v):\n    return wind - k_v * v\n" + text


ANSWER_TO_1_1 = "return x + dt * v, v + dt * acceleration(t, x, v, p)"
USES_OF_WORKED_FUNCTIONS = {
    "a worked function of a lesson before, asked for days of work": (
        "from solutions.integrators import implicit_euler_step\n"
        "    implicit_euler_step(acceleration, 0.0, np.zeros(20000), np.zeros(20000), 0.1, 1.0)"
    ),
    "each asks the other": (
        "from solutions.integrators import euler_step\n"
        "    def again(*a):\n"
        "        return euler_step(again, *a[:3], 0.1, None)[1]\n"
        "    print('FOUND', again(0.0, x, v, None))"
    ),
    "a worked function for a lesson that has none": (
        "import solutions.springs, lessons.springs\n"
        "    return solutions.springs.implicit_spring_network_step(acceleration, t, x, v, dt, mesh)"
    ),
    "the source of a worked function": (
        "import inspect, solutions.integrators as s\n"
        f"    print('FOUND', [c for c in vars(s) if {ANSWER_TO_1_1!r} in (inspect.getsource(s) or '')])"
    ),
}


def test_the_answer_that_is_looked_for_is_in_the_worked_lesson_only():
    worked, stub = ((folder / "integrators.py").read_text() for folder in (SOLUTIONS, ROOT / "lessons"))
    assert ANSWER_TO_1_1 in worked and ANSWER_TO_1_1 not in stub


@pytest.mark.long
@pytest.mark.parametrize(("name", "body"), USES_OF_WORKED_FUNCTIONS.items())
def test_the_worked_functions_of_earlier_lessons_are_no_hole(name, body, trial, settings):
    step = f"def implicit_spring_network_step(acceleration, t, x, v, dt, mesh):\n    {body}\n    return x, v\n"
    result = graded(honest_air(step), settings, "springs")
    assert earned(result) == {"2.2": 2, "2.13": 0}, name
    assert not re.search(r"FOUND (?!\[\])", harmless(result))


@pytest.mark.long
def test_the_grading_process_has_its_memory_and_its_limits_back(trial, settings):
    before = resource.getrlimit(resource.RLIMIT_AS)
    result = graded(written(next(case for case in ATTACKS if case.name == "broadcasting")), settings)
    assert "MemoryError" in json.dumps([test for test in result["tests"] if test["exercise"] == "1.7"])
    assert resource.getrlimit(resource.RLIMIT_AS) == before


@pytest.mark.long
def test_a_sandbox_that_does_not_start_is_no_zero(trial, settings, monkeypatch):
    start = box.Sandbox.start

    def start_sleeping(self):
        if self.printed:                                               # a second process, after the file was loaded
            self.program = ["/bin/sleep", "60"]
        start(self)

    monkeypatch.setattr(box, "READY_WITHIN", 0.5)
    monkeypatch.setattr(box.Sandbox, "start", start_sleeping)
    text = HONEST + "import os\nprint('loaded', flush=True)\ndef euler_step(*a):\n    os._exit(0)\n"
    unlucky = submissions.Submission("unlucky", {"integrators": text.encode()}, (), "")
    with pytest.raises(RuntimeError, match="cannot start"), nothing_left():
        marking.mark(unlucky, settings["integrators"])


# ---------------------------------------------------------------------------------------------- what is handed in

def zipped(path, entries, packed=zipfile.ZIP_DEFLATED):
    """A zip of {name: bytes}."""
    path.parent.mkdir(parents=True, exist_ok=True)
    with zipfile.ZipFile(path, "w", packed) as archive:
        for name, data in entries.items():
            archive.writestr(name, data)
    return path


def read(path, lessons=("integrators", "springs")):
    with children.reader() as child:
        one = submissions.read(path, path.stem, lessons, child)
    assert not any(FORBIDDEN.search(problem) for problem in one.problems)
    return one


LESSON = b"x = 1\n"


def links(top):
    (top / "lessons").mkdir()
    (top / "lessons" / "integrators.py").symlink_to(ROOT / "solutions" / "integrators.py")
    (top / "lessons" / "springs.py").write_bytes(LESSON)


def linked_folder(top):
    (top / "lessons").symlink_to(ROOT / "solutions")
    (top / "springs.py").write_bytes(LESSON)


def pipes(top):
    os.mkfifo(top / "integrators.py")
    (top / "lessons").mkdir()
    (top / "lessons" / "springs.py").write_bytes(LESSON)


def sockets(top):
    with socket.socket(socket.AF_UNIX) as s:
        here = os.getcwd()
        os.chdir(top)                                                  # a socket's path may have 108 characters
        try:
            s.bind("integrators.py")
        finally:
            os.chdir(here)
    (top / "springs.py").write_bytes(LESSON)


def devices(top):
    if os.geteuid() == 0:
        with contextlib.suppress(OSError):
            os.mknod(top / "integrators.py", 0o644 | stat.S_IFCHR, os.makedev(1, 5))       # /dev/zero
    (top / "springs.py").write_bytes(LESSON)


def folders_as_files(top):
    (top / "integrators.py").mkdir()
    (top / "springs.py").write_bytes(LESSON)


def huge_file(top):
    with open(top / "integrators.py", "wb") as file:
        file.truncate(1 << 40)
    (top / "springs.py").write_bytes(LESSON)


def deep_folders(top):
    deep = top.joinpath(*("d" * 40))
    deep.mkdir(parents=True)
    (deep / "integrators.py").write_bytes(LESSON)
    (top / "springs.py").write_bytes(LESSON)


def evil_names(top):
    (top / "\x1b[2J\n").mkdir()
    (top / "\x1b[2J\n" / "integrators.py").symlink_to("/etc/passwd")
    (top / "springs.py").write_bytes(LESSON)


def a_date_that_no_calendar_has(top):
    (top / "springs.py").write_bytes(LESSON)
    os.utime(top / "springs.py", (2**40, 2**40))


TRICKS_WITH_FILES = [
    links,
    linked_folder,
    pipes,
    sockets,
    devices,
    folders_as_files,
    huge_file,
    deep_folders,
    evil_names,
    a_date_that_no_calendar_has,
]


@pytest.mark.parametrize("make", TRICKS_WITH_FILES)
def test_tricks_with_files_leave_the_other_file_readable(make, tmp_path):
    top = tmp_path / "mallory"
    top.mkdir()
    make(top)
    assert read(top).files == {"springs": LESSON}


@pytest.mark.long
def test_a_date_that_no_calendar_has_is_no_date():
    for seconds in (2.0**60, 0.0):                                     # many file systems cannot keep such a date
        assert submissions.moment(seconds) == ""


@pytest.mark.long
def test_a_submission_that_is_a_link_or_a_pipe_is_not_read(tmp_path):
    (tmp_path / "link").symlink_to(ROOT / "solutions")
    (tmp_path / "link.zip").symlink_to(zipped(tmp_path / "other" / "honest.zip", {"integrators.py": LESSON}))
    os.mkfifo(tmp_path / "pipe.zip")
    for name in ("link", "link.zip", "pipe.zip"):
        assert not read(tmp_path / name).files


def encrypted(path):
    """Write a zip whose entry is flagged as encrypted."""
    data = bytearray(zipped(path, {"integrators.py": LESSON, "springs.py": LESSON}, zipfile.ZIP_STORED).read_bytes())
    data[6] |= 1
    data[data.index(b"PK\x01\x02") + 8] |= 1
    path.write_bytes(data)


def broken_stream(path):
    data = bytearray(zipped(path, {"integrators.py": bytes(100_000), "springs.py": LESSON}).read_bytes())
    begin = data.index(b"integrators.py") + len("integrators.py")
    data[begin:begin + 8] = b"\xff" * 8
    path.write_bytes(data)


def bomb(path):
    zipped(path, {"integrators.py": bytes(200 << 20), "other.bin": bytes(1 << 20), "springs.py": LESSON})


def nested(path):
    inner = zipped(path.with_name("inner.zip"), {"integrators.py": LESSON})
    zipped(path, {"integrators.zip": inner.read_bytes(), "springs.py": LESSON})


def slip(path):
    outside = "../../integrators.py", "/integrators.py", "a/../integrators.py", "..\\integrators.py"
    zipped(path, {**dict.fromkeys(outside, LESSON), "springs.py": LESSON})


def link_inside(path):
    entry = zipfile.ZipInfo("integrators.py")
    entry.external_attr = (stat.S_IFLNK | 0o777) << 16
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr(entry, "/etc/passwd")
        archive.writestr("springs.py", LESSON)


def evil_entries(path):
    zipped(path, {
        "\x1b]0;owned\x07\u202e/integrators.py": bytes(1 << 20),
        "\x1b[2J/\r\n/integrators.py": LESSON * 100_000,
        "springs.py": LESSON,
    })


def packed_by(method):
    def make(path):
        """Write hundreds of megabytes into a kilobyte; Python unpacks them all even to read one byte."""
        with zipfile.ZipFile(path, "w") as archive:
            archive.writestr("springs.py", LESSON)
            with archive.open(zipped_entry("integrators.py", method), "w", force_zip64=True) as file:
                for _ in range(6):
                    file.write(bytes(50 << 20))
    return make


def zipped_entry(name, method):
    entry = zipfile.ZipInfo(name)
    entry.compress_type = method
    return entry


def nul_in_a_name(path):
    """Write an entry whose name ends at a NUL byte for Python, and is that of a picture as a whole."""
    data = zipped(path, {"integrators.py+.png": LESSON, "springs.py": LESSON}, zipfile.ZIP_STORED).read_bytes()
    path.write_bytes(data.replace(b"integrators.py+.png", b"integrators.py\0.png"))


def lies_about_its_size(path):
    """Write an entry of a megabyte whose headers say two bytes."""
    data = bytearray(zipped(path, {"integrators.py": bytes(1 << 20), "springs.py": LESSON}).read_bytes())
    for at in (22, data.index(b"PK\x01\x02") + 24):
        data[at:at + 4] = struct.pack("<I", 2)
    path.write_bytes(data)


TRICKS_WITH_ZIPS = [
    encrypted,
    broken_stream,
    bomb,
    nested,
    slip,
    link_inside,
    evil_entries,
    nul_in_a_name,
    lies_about_its_size,
]


@pytest.mark.long
@pytest.mark.parametrize("make", TRICKS_WITH_ZIPS)
def test_tricks_with_zips_leave_the_other_file_readable(make, tmp_path):
    make(tmp_path / "mallory.zip")
    one = read(tmp_path / "mallory.zip")
    assert one.files == {"springs": LESSON} and (one.problems or make in (nested, slip))
    assert {path.name for path in tmp_path.iterdir()} <= {"mallory.zip", "inner.zip"}


@pytest.mark.long
@pytest.mark.parametrize(("method", "word"), [(zipfile.ZIP_BZIP2, "bzip2"), (zipfile.ZIP_LZMA, "lzma")])
def test_methods_that_unpack_gigabytes_from_a_kilobyte_are_not_read(method, word, tmp_path):
    packed_by(method)(tmp_path / "mallory.zip")
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss        # [KiB]
    problem = f"integrators.py is packed by {word} and not by deflate, as an ordinary zip is, and was not read"
    assert read(tmp_path / "mallory.zip").problems == (problem,)
    assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before < 200_000


def many(path):
    zipped(path, {f"{n}/integrators.py": b"" for n in range(6000)}, zipfile.ZIP_STORED)


def truncated(path):
    path.write_bytes(zipped(path, {"integrators.py": LESSON}).read_bytes()[:-10])


def large(path):
    with open(path, "wb") as file:
        file.truncate(1 << 40)


def numbers_that_lie(path):
    data = bytearray(zipped(path, {"integrators.py": LESSON}).read_bytes())
    end = data.index(b"PK\x05\x06")
    data[end + 12:end + 20] = struct.pack("<II", 0xFFFFFFF0, 0xFFFFFFF0)
    path.write_bytes(data)


def two_bytes(path):
    path.write_bytes(b"PK")


def empty(path):
    path.write_bytes(b"")


@pytest.mark.long
@pytest.mark.parametrize("make", [truncated, numbers_that_lie, two_bytes, empty])
def test_a_zip_that_cannot_be_read_is_reported_in_one_sentence(make, tmp_path):
    make(tmp_path / "mallory.zip")
    one = read(tmp_path / "mallory.zip")
    assert not one.files and len(one.problems) == 1


@pytest.mark.long
@pytest.mark.parametrize("make", [many, large])
def test_too_much_of_a_zip_is_neither_read_nor_a_zero(make, tmp_path):
    make(tmp_path / "mallory.zip")
    with pytest.raises(submissions.Ungraded, match="ask for the lesson files alone"):
        read(tmp_path / "mallory.zip")


def endless_names(path):
    """Write names of the greatest length into a zip of the greatest size; each name is a problem to report."""
    with zipfile.ZipFile(path, "w", zipfile.ZIP_BZIP2) as archive:
        for n in range(200):
            archive.writestr(f"{n}{'x' * 65_000}/integrators.py", b"")


@pytest.mark.long
def test_the_report_about_a_zip_is_short(tmp_path):
    endless_names(tmp_path / "mallory.zip")
    one = read(tmp_path / "mallory.zip")
    assert len(one.problems) == submissions.MOST_PROBLEMS + 1 and one.problems[-1] == "and 180 more of the kind"
    assert max(map(len, one.problems)) < 2 * submissions.LONGEST


@pytest.mark.long
def test_a_large_zip_makes_no_large_result(tmp_path, trial, settings):
    endless_names(tmp_path / "mallory.zip")
    assert (tmp_path / "mallory.zip").stat().st_size > 24 << 20
    harmless(marking.mark(read(tmp_path / "mallory.zip"), settings["integrators"]))


@pytest.mark.long
def test_long_names_in_a_file_make_no_large_result(trial, settings):
    names = [f"{n}{'x' * 15_000}" for n in "abcdefghijkl"]
    text = "".join(f"try:\n    from {name} import x\nexcept ImportError:\n    pass\n" for name in names)
    harmless(graded(HONEST + text, settings))


def many_tasks(kind):
    while kind == "time":
        pass
    return bytearray(2 * children.LITTLE) if kind == "memory" else os._exit(1)


@pytest.mark.long
def test_a_reader_of_archives_has_little_memory_and_time_and_is_replaced_when_it_ends():
    with children.reader() as child:
        with pytest.raises(MemoryError):
            child(many_tasks, "memory")
        with pytest.raises(children.Ended):
            child(many_tasks, "end")
        assert child(os.getpid) not in (child(os.getppid), os.getpid())
        with pytest.raises(TimeoutError):
            child(slow)
        with pytest.raises(TimeoutError):
            child(any, iter(int, 1), patience=1.0)                     # no signal or thread of its own ends this loop
        assert child(os.getpid) != os.getpid()


def slow():
    children.WITHIN = 0.2
    return children.timed(many_tasks, "time")


@pytest.mark.long
def test_hostile_names_do_not_stop_a_class(tmp_path):
    for name in (b"\x1b[2Jmallory", b"\xff\xfe", b"a\nb.zip", "‮evil".encode(), b"honest"):
        os.mkdir(os.fsencode(tmp_path) + b"/" + name)
        (tmp_path / os.fsdecode(name) / "integrators.py").write_bytes(LESSON)
    found = submissions.read_all(tmp_path, ("integrators",)).submissions
    assert len(found) == 5 and not any(FORBIDDEN.search(one.student) for one in found)
    assert [one.files for one in found] == 5 * [{"integrators": LESSON}]
