"""The instructor sees who to look into: what a program tried, how it ended, and whose answers are alike."""

import importlib
import inspect
import re
import textwrap

import pytest

from validate.grading import example, marking, pages, similar, submissions, watch
from validate.subject import modules

from .. import attacks


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
        "open('notes', 'w')",
        "import os; os.open('notes', os.O_CREAT | os.O_RDWR)",
        "import os; os.mkdir('notes')",
        "import os; os.remove('notes')",
        "open(b'notes', 'w')",
        "import os; os.utime('/student/integrators.py')",
    ],
    "read": [
        "open('/etc/passwd')",
        "import os; os.listdir('/')",
        "import pathlib; list(pathlib.Path('/proc').iterdir())",
        "open(b'/usr/bin/env')",
        "open(type('Path', (str,), {})('/usr/bin/env'))",
        "open('/student/../usr/bin/env')",
        "import os; os.listdir()",
        "import os; os.chdir('/usr')",
    ],
    "native": ["import ctypes; ctypes.CDLL(None).getpid()"],
    "signal": ["import os; os.kill(os.getppid(), 0)"],
    "inside": [
        "import gc; gc.get_objects()",
        "import sys; sys.settrace(None)",
        "import sys; sys.addaudithook(print)",
    ],
    "limit": ["import resource; resource.setrlimit(resource.RLIMIT_AS, resource.getrlimit(resource.RLIMIT_AS))"],
    "end": ["import os; os._exit(0)", "import os; os.abort()"],
    "refused": ["import ctypes; ctypes.CDLL(None).setuid(1)"],
    "time": ["while True: pass"],
    "memory": ["bytearray(1 << 40)"],
    "flood": ["import os; os.write(2, b'x' * 50_000)"],
}


@pytest.mark.long
@pytest.mark.parametrize(("code", "body"), [(code, body) for code, bodies in SEEN.items() for body in bodies])
def test_each_forbidden_try_of_a_program_is_seen(code, body, trial, settings):
    seen = watched(attacks.HONEST + IN_A_CALL.format(body), settings)
    assert code in seen and code in watch.SENTENCES, seen


EVERY_DESCRIPTOR = """
from typing import sys
os = sys.modules["os"]
null = os.open(os.devnull, os.O_WRONLY)
for k in range(3, 64):
    try:
        k == null or os.fstat(k).st_ino in {os.fstat(n).st_ino for n in wire} or os.dup2(null, k)
    except OSError:
        pass
"""


@pytest.mark.long
def test_a_program_that_turns_every_descriptor_elsewhere_is_seen_all_the_same(trial, settings):
    """All but those of the conversation, without which it would end at once."""
    wire = 'main = sys.modules["__main__"]\nwire = (main.incoming.fileno(), main.outgoing.fileno())\n'
    blind = EVERY_DESCRIPTOR.replace("null =", f"{wire}null =", 1)
    tries = "\ntry:\n    os.fork()\nexcept OSError:\n    pass\ntry:\n    os.listdir('/')\nexcept OSError:\n    pass\n"
    assert watched(attacks.HONEST + blind + tries, settings) >= {"process", "read"}


INSIDE_THE_HOOK = {
    "by an error": """
for arguments in ((), (None,), ("x", None, None), ("x", None, []), (1.5, 2)):
    try:
        sys.audit("open", *arguments)
    except Exception as e:
        trace = e.__traceback__
        while trace.tb_next:
            trace = trace.tb_next
        frames.append(trace.tb_frame)
""",
    "by a signal": """
import signal
signal.signal(signal.SIGVTALRM, lambda number, frame: frames.append(frame))
signal.setitimer(signal.ITIMER_VIRTUAL, 1e-4, 1e-4)
for _ in range(3000):
    sys.audit("open", 3)
signal.setitimer(signal.ITIMER_VIRTUAL, 0.0)
""",
    "by too deep a call": """
def deep():
    try:
        deep()
    except RecursionError as e:
        trace = e.__traceback__
        while trace.tb_next:
            trace = trace.tb_next
        frames.append(trace.tb_frame)
    sys.audit("open", 3)
deep()
""",
}
TAKE_BACK = """
own = {number for number in range(64) if number > 2} - {main.incoming.fileno(), main.outgoing.fileno()}
for frame in frames:
    for value in frame.f_locals.values():
        for take in (lambda: value.clear(), lambda: value.update(dict.fromkeys(value)), lambda: value.seek(0),
                     lambda: value.__setitem__(slice(None), bytes(len(value)))):
            try:
                take()
            except Exception:
                pass
for number in own:
    try:
        os.close(number)
    except OSError:
        pass
    try:
        os.dup2(2, number)
    except OSError:
        pass
"""


@pytest.mark.long
@pytest.mark.parametrize("reach", INSIDE_THE_HOOK.values(), ids=lambda text: text.split()[0])
def test_a_note_is_not_taken_back_by_who_looks_inside_the_watch(reach, trial, settings):
    """Before the try, and after it: neither keeps the try from being seen."""
    start = 'from typing import sys\nos, main, frames = sys.modules["os"], sys.modules["__main__"], []\n'
    tries = "try:\n    os.fork()\nexcept OSError:\n    pass\nimport ctypes\nctypes.CDLL(None).getpid()\n"
    for body in (reach + TAKE_BACK + tries, tries + reach + TAKE_BACK):
        assert watched(attacks.HONEST + start + body, settings) >= {"process", "native"}


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
def test_noise_does_not_hide_a_try(cover, trial, settings):
    body = (
        "import builtins, os, sys\n"
        "kept = builtins.isinstance\n"
        "try:\n"
        f"    {cover}\n"
        "    try:\n"
        "        os.fork()\n"
        "    except OSError:\n"
        "        pass\n"
        "finally:\n"
        "    builtins.isinstance = kept\n"
    )
    assert "process" in watched(attacks.HONEST + body, settings)


@pytest.mark.long
def test_a_note_of_the_grader_is_not_shown_as_printed_text(trial, settings):
    body = (
        "import os\n"
        "print('before', flush=True)\n"
        "try:\n"
        "    os.fork()\n"
        "except OSError:\n"
        "    pass\n"
        "print('after', flush=True)\n"
    )
    text = attacks.HONEST + body
    submission = submissions.Submission("mallory", {"integrators": text.encode()}, (), "")
    result = marking.mark(submission, settings["integrators"])
    assert result["printed"]["integrators"].split() == ["before", "after"]


@pytest.mark.long
@pytest.mark.parametrize("name", modules.lesson_names())
def test_honest_work_leaves_nothing_to_look_into(name):
    submission = submissions.Submission("ada", {name: example.worked(name).encode()}, (), "")
    result = marking.mark(submission, marking.settings((name,), "a secret"))
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
    second = {**first, "again": [], "watched": {"springs": []}}
    monkeypatch.setattr(marking, "mark", lambda submission, settings: second)
    submission = submissions.Submission("ada", {"springs": b""}, (), "")
    watched = marking.again(submission, None, first)["watched"]
    assert watched == {"integrators": ["end"], "springs": []}


@pytest.mark.long
@pytest.mark.parametrize(
    ("text", "found"),
    [
        (b"import numpy as np\nimport math, abc\n", []),
        (b"from solutions.checks import BadInput\nfrom typing import NamedTuple\n", []),
        (b"import os\n", ["import os"]),
        (b"def f():\n    from ctypes.util import find\n", ["import ctypes"]),
        (b"x = 1; import numpy as np, sys as s\n", ["import sys"]),
        (b"y = __import__('o' + 's')\n", ["use __import__"]),
        (b"eval('1')\nexec ('x')\n", ["use eval", "use exec"]),
        (b"# import os\nevaluate(1)\nreopen(x)\n", []),
        (b"\xff\xfe import\0 os\n", []),
        (b"import " + b"a," * 100_000, ["import a"]),
    ],
    ids=range(10),
)
def test_imports_that_no_lesson_needs_are_found_in_the_text(text, found):
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


def test_the_same_answers_are_found_although_names_blanks_and_comments_differ():
    renamed = OWN.replace("halfway", "mid_time").replace("x_half", "xm")
    renamed = renamed.replace("    ", "  ").replace("a = ", "a =   ") + "# all mine\n\n\n"
    pair = {("ada", "bob", "integrators"), ("bob", "ada", "integrators")}
    assert alike(ada=OWN, bob=OWN, cem=OTHER) == pair
    assert alike(ada=OWN, bob=renamed, cem=OTHER) == pair


@pytest.mark.long
def test_a_copy_with_a_changed_line_or_one_more_function_is_nearly_the_same():
    both = OWN + OTHER
    more = "\ndef more(x):\n    return [3 * n for n in x]\n"
    assert ("bob", "ada", "integrators") in alike(ada=both, bob=both.replace("/ 2.0", "* 0.5") + more)


@pytest.mark.parametrize("useless", ["_ = 1002", "unused: float = 1.0", "pass", "1002", "if 0: pass"])
def test_a_copy_with_useless_lines_is_nearly_the_same(useless):
    lines = [line for line in OWN.splitlines() if line.strip()]
    blanks = [re.match(" *", line)[0] for line in [*lines[1:], ""]]
    copy = "\n".join(f"{line}\n{blank}{useless}" for line, blank in zip(lines, blanks, strict=True))
    pair = {("ada", "bob", "integrators"), ("bob", "ada", "integrators")}
    assert alike(ada=OWN, bob=copy, cem=OTHER) == pair


@pytest.mark.long
def test_right_answers_written_differently_are_not_alike():
    """Three pairs per lesson: the worked answers, and the first and the last right ones written differently."""
    for lesson in modules.lesson_names():
        one, other = {}, {}
        for mutant in importlib.import_module(f"tests.mutants.{lesson}").MUTANTS:
            if mutant.right and mutant.kind == "written out":
                one.setdefault(mutant.exercise, mutant)
                other[mutant.exercise] = mutant
        texts = {"ada": one.values(), "bob": [m for exercise, m in other.items() if m is not one[exercise]]}
        blank = (modules.ROOT / "lessons" / f"{lesson}.py").read_text()
        handed = [submissions.Submission(name, {lesson: "\n".join(
            [blank, *(textwrap.dedent(inspect.getsource(m.function)) for m in mutants)]).encode()}, (), "")
            for name, mutants in texts.items()]
        assert similar.alike(handed, (lesson,)) == {}, lesson


@pytest.mark.long
def test_unfinished_files_and_independent_answers_are_not_alike():
    assert not alike(ada=OWN, bob=OTHER, cem="", dov="")


@pytest.mark.long
def test_a_copy_of_the_worked_answers_is_found():
    first = modules.lesson_names()[0]
    submission = submissions.Submission("ada", {first: example.worked(first).encode()}, (), "")
    ((lesson, other, share),) = similar.alike([submission], (first,))["ada"]
    assert (lesson, other, share) == (first, similar.WORKED, 1.0)


@pytest.mark.long
def test_hostile_texts_take_no_time_and_no_memory():
    wide = b"x = " + b"(" * 200_000
    many = b"\n".join(b"a%d = %d" % (n, n) for n in range(15_000))
    texts = {"a": wide, "b": many, "c": b"\0\xff" * 100_000, "d": b"\n" * 260_000, "e": b"#" * 260_000}
    some = [submissions.Submission(name, {"integrators": text}, (), "") for name, text in texts.items()]
    assert similar.alike(some, ("integrators",)) == {}


@pytest.mark.long
def test_hundreds_of_equal_answers_give_a_short_list_per_student():
    found = similar.alike(handed_in(**{f"s{n}": OWN for n in range(300)}), ("integrators",))
    assert len(found) == 300 and all(len(pairs) <= similar.MOST for pairs in found.values())


# ---------------------------------------------------------------------- the page


@pytest.mark.long
def test_the_example_class_has_students_to_look_into(tmp_path):
    intake = submissions.read_all(example.make(tmp_path / "class"), ("integrators",))
    rules = marking.settings(("integrators",), "a secret")
    sheets = [pages.sheet(marking.mark(one, rules), rules, pages.Terms("", 0.0)) for one in intake.submissions]
    pairs = similar.alike(intake.submissions, ("integrators",))
    looks = {s.student: " ".join(told for _, told in pages.looks(s, pairs)) for s in sheets}
    assert "ended by itself" in looks["eve"] and "imports os" in looks["eve"] and "the same as ada" in looks["dia"]
    assert not looks["cem"]


@pytest.mark.long
def test_nearly_every_hostile_file_is_seen(trial, settings):
    """Try one attack of each family.  Attacks that only return an answer of a strange type leave no trace."""
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
        seen = watched(attacks.HONEST + case.text, settings)
        assert seen & set(watch.SENTENCES), case.name                 # and not only an import in its text
