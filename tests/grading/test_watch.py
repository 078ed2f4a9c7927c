"""The instructor sees who to look into: what a program tried, how it ended, and whose answers are alike."""


import pytest

from validate import modules

from .. import attacks
from ..attacks.test_attacks import folder, settings, trial  # noqa: F401      the trial tests, with little patience
from . import example, marking, pages, sandbox, similar, submissions, watch


@pytest.fixture(scope="module", autouse=True)
def _sandbox():
    sandbox.for_tests(pytest.skip, pytest.fail)


def watched(text, rules, lesson="integrators"):
    result = marking.mark(submissions.Submission("mallory", {lesson: text.encode()}, (), ""), rules[lesson])
    return set(result["watched"][lesson])


IN_A_CALL = """
def euler_step(acceleration, t, x, v, dt, p):
    try:
        {}
    except OSError:
        pass
    return x, v
"""
SEEN = {
    "process": [
        "import os; os.fork()",
        "import subprocess; subprocess.run(['true'])",
        "import os; os.system('true')",
        "import os; os.posix_spawn('/bin/true', ['true'], {})",
    ],
    "network": ["import socket; socket.socket()", "import socket; socket.getaddrinfo('example.org', 80)"],
    "write": [
        "open('/tmp/notes', 'w')",
        "import os; os.open('/tmp/notes', os.O_CREAT | os.O_RDWR)",
        "import os; os.mkdir('/tmp/notes')",
        "import os; os.remove('/tmp/notes')",
    ],
    "read": [
        "open('/etc/passwd')",
        "import os; os.listdir('/')",
        "import pathlib; list(pathlib.Path('/proc').iterdir())",
    ],
    "native": ["import ctypes; ctypes.CDLL(None).getpid()"],
    "signal": ["import os; os.kill(os.getppid(), 0)"],
    "inside": ["import gc; gc.get_objects()", "import sys; sys.settrace(None)"],
    "limit": ["import resource; resource.setrlimit(resource.RLIMIT_AS, resource.getrlimit(resource.RLIMIT_AS))"],
    "end": ["import os; os._exit(0)", "import os; os.abort()"],
    "refused": ["import ctypes; ctypes.CDLL(None).setuid(1)"],
    "time": ["while True: pass"],
    "memory": ["bytearray(1 << 40)"],
    "flood": ["import os; os.write(2, b'x' * 50_000)"],
}


@pytest.mark.long
@pytest.mark.parametrize("code, body", [(code, body) for code, bodies in SEEN.items() for body in bodies])
def test_what_a_program_tries_is_seen(code, body, trial, settings):
    seen = watched(attacks.HONEST + IN_A_CALL.format(body), settings)
    assert code in seen and code in watch.SENTENCES, seen


@pytest.mark.long
@pytest.mark.parametrize(
    "cover",
    [
        "os.close(2)",
        "os.closerange(0, 3)",
        "sys.stderr.write('x' * 200_000)",
        "os.write(2, bytes(200_000))",
        "builtins.isinstance = None",
    ],
)
def test_what_is_seen_is_not_hidden_by_noise(cover, trial, settings):
    body = (
        "import builtins, os, sys\nkept = builtins.isinstance\ntry:\n    "
        + cover
        + "\n    try:\n        os.fork()\n    except OSError:\n        pass\nfinally:\n    builtins.isinstance = kept\n"
    )
    assert "process" in watched(attacks.HONEST + body, settings)


@pytest.mark.long
def test_a_note_of_ours_is_no_part_of_what_is_printed(trial, settings):
    text = (
        attacks.HONEST
        + "import os\nprint('before', flush=True)\ntry:\n    os.fork()\nexcept OSError:\n    pass\n"
        + "print('after', flush=True)\n"
    )
    result = marking.mark(
        submissions.Submission("mallory", {"integrators": text.encode()}, (), ""), settings["integrators"]
    )
    assert result["printed"]["integrators"].split() == ["before", "after"]


@pytest.mark.long
@pytest.mark.parametrize("name", modules.lesson_names())
def test_honest_work_leaves_nothing_to_look_into(name):
    result = marking.mark(
        submissions.Submission("ada", {name: example.worked(name).encode()}, (), ""),
        marking.settings((name,), "a secret"),
    )
    assert result["watched"] == {name: []} and all(t["status"] == "passed" for t in result["tests"])


@pytest.mark.long
def test_a_second_try_takes_the_place_of_the_first(monkeypatch):
    first = {
        "again": ["springs"],
        "tests": [],
        "printed": {},
        "seconds": 1.0,
        "watched": {"integrators": ["end"], "springs": ["time"]},
    }
    monkeypatch.setattr(
        marking, "mark", lambda submission, settings: {**first, "again": [], "watched": {"springs": []}}
    )
    assert marking.again(submissions.Submission("ada", {"springs": b""}, (), ""), None, first)["watched"] == {
        "integrators": ["end"],
        "springs": [],
    }


@pytest.mark.long
@pytest.mark.parametrize(
    "text, found",
    [
        (
            b"import numpy as np\nfrom solutions.checks import BadInput\nfrom typing import NamedTuple\nimport math, abc\n",
            [],
        ),
        (b"import os\n", ["import os"]),
        (b"def f():\n    from ctypes.util import find\n", ["import ctypes"]),
        (b"x = 1; import numpy as np, sys as s\n", ["import sys"]),
        (b"y = __import__('o' + 's')\n", ["use __import__"]),
        (b"eval('1')\nexec ('x')\n", ["use eval", "use exec"]),
        (b"# import os\nevaluate(1)\nreopen(x)\n", []),
        (b"\xff\xfe import\0 os\n", []),
        (b"import " + b"a," * 100_000, ["import a"]),
    ],
    ids=range(9),
)
def test_what_a_file_imports_that_no_lesson_needs_is_seen_in_its_text(text, found):
    assert watch.in_text(text) == found


# ---------------------------------------------------------------------- answers that are alike

OWN = """
def midpoint_step(acceleration, t, x, v, dt, p):
    halfway = t + 0.5 * dt
    a = acceleration(t, x, v, p)
    x_half = x + 0.5 * dt * v
    v_half = v + 0.5 * dt * a
    a_half = acceleration(halfway, x_half, v_half, p)
    return x + dt * v_half, v + dt * a_half


def order(dts, errors):
    logs = [np.log(dt) for dt in dts]
    tops = [np.log(error) for error in errors]
    slope, offset = np.polyfit(logs, tops, 1)
    return slope
"""
OTHER = """
def midpoint_step(acceleration, t, x, v, dt, p):
    k = acceleration(t, x, v, p)
    return x + dt * (v + k * dt / 2), v + dt * acceleration(t + dt / 2, x + v * dt / 2, v + k * dt / 2, p)


def order(dts, errors):
    return (np.log(errors[-1]) - np.log(errors[0])) / (np.log(dts[-1]) - np.log(dts[0]))


def kinetic(m, v):
    total = 0.0
    for mass, speed in zip(m, v):
        total += mass * speed @ speed
    return total / 2.0
"""


def handed_in(**texts):
    blank = (modules.ROOT / "lessons" / "integrators.py").read_text()
    return [
        submissions.Submission(name, {"integrators": (blank + text).encode()}, (), "") for name, text in texts.items()
    ]


def alike(**texts):
    return {
        (student, other, lesson)
        for student, pairs in similar.alike(handed_in(**texts), ("integrators",)).items()
        for lesson, other, _ in pairs
    }


def test_the_same_answers_are_found_also_when_names_blanks_and_comments_are_changed():
    renamed = (
        OWN.replace("halfway", "mid_time").replace("x_half", "xm").replace("    ", "  ").replace("a = ", "a =   ")
        + "# all mine\n\n\n"
    )
    assert alike(ada=OWN, bob=OWN, cem=OTHER) == {("ada", "bob", "integrators"), ("bob", "ada", "integrators")}
    assert alike(ada=OWN, bob=renamed, cem=OTHER) == {("ada", "bob", "integrators"), ("bob", "ada", "integrators")}


@pytest.mark.long
def test_a_copy_with_a_changed_line_or_one_more_function_is_nearly_the_same():
    assert ("bob", "ada", "integrators") in alike(
        ada=OWN + OTHER, bob=(OWN + OTHER).replace("/ 2.0", "* 0.5") + "\ndef more(x):\n    return [3 * n for n in x]\n"
    )


@pytest.mark.long
def test_those_who_have_not_begun_and_those_who_worked_alone_are_not_alike():
    assert not alike(ada=OWN, bob=OTHER, cem="", dov="")


@pytest.mark.long
def test_the_worked_answers_are_known():
    first = modules.lesson_names()[0]
    ((lesson, other, share),) = similar.alike(
        [submissions.Submission("ada", {first: example.worked(first).encode()}, (), "")], (first,)
    )["ada"]
    assert (lesson, other, share) == (first, similar.WORKED, 1.0)


@pytest.mark.long
def test_hostile_texts_take_no_time_and_no_memory():
    wide = b"x = " + b"(" * 200_000
    many = b"\n".join(b"a%d = %d" % (n, n) for n in range(15_000))
    texts = {"a": wide, "b": many, "c": b"\0\xff" * 100_000, "d": b"\n" * 260_000, "e": b"#" * 260_000}
    found = similar.alike(
        [submissions.Submission(name, {"integrators": text}, (), "") for name, text in texts.items()], ("integrators",)
    )
    assert found == {}


@pytest.mark.long
def test_hundreds_with_one_and_the_same_answer_are_told_in_few_words():
    found = similar.alike(handed_in(**{f"s{n}": OWN for n in range(300)}), ("integrators",))
    assert len(found) == 300 and all(len(pairs) <= similar.MOST for pairs in found.values())


# ---------------------------------------------------------------------- the page


@pytest.mark.long
def test_the_documentations_own_class_has_somebody_to_look_into(tmp_path):
    intake = submissions.read_all(example.make(tmp_path / "class"), ("integrators",))
    rules = marking.settings(("integrators",), "a secret")
    sheets = [pages.sheet(marking.mark(one, rules), rules, pages.Terms("", 0.0)) for one in intake.submissions]
    looks = {
        s.student: " ".join(told for _, told in pages.looks(s, similar.alike(intake.submissions, ("integrators",))))
        for s in sheets
    }
    assert "ended by itself" in looks["eve"] and "imports os" in looks["eve"] and "the same as ada" in looks["dia"]
    assert not looks["cem"]


@pytest.mark.long
def test_nearly_every_hostile_file_is_seen(trial, settings):
    """A sample here, one of each family; a wrong answer of a strange type is only that."""
    names = (
        "a loop in a call",
        "a flood",
        "a daemon",
        "a fork bomb",
        "the parent's end",
        "a full disk",
        "notes for the next run",
        "os._exit at import",
        "gc",
    )
    for name in names:
        case = next(case for case in attacks.ATTACKS if case.name.startswith(name))
        result = marking.mark(
            submissions.Submission("mallory", {"integrators": (attacks.HONEST + case.text).encode()}, (), ""),
            settings["integrators"],
        )
        assert set(result["watched"]["integrators"]) & set(watch.SENTENCES), case.name  # not only by what it imports
