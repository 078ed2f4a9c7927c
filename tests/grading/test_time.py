"""Time limits count the submission's own time.

Other processes cost no points, a call that sleeps or loops is ended, and a submission that timed out is tried once
more, alone.
"""

import contextlib
import os
import subprocess
import sys
import threading
import time
import types

import numpy as np
import pytest

from validate.grading import (
    box,
    children,
    line,
    local,
    marking,
    meter,
    plugin,
    points,
    remote,
    sandbox,
    submissions,
    wire,
)
from validate.subject import loading

from ..attacks import HONEST, SOLVED

pytestmark = pytest.mark.xdist_group("time")
LIMIT = 1.0                  # of the calls of a test here [s]


@pytest.fixture(scope="module", autouse=True)
def _sandbox():
    sandbox.for_tests(pytest.skip, pytest.fail)


@contextlib.contextmanager
def opened(text):
    place = remote.box_of("integrators", (HONEST + text).encode(), 60.0)
    try:
        place.open()
        assert place.broken is None
        yield place
    finally:
        place.close()


@contextlib.contextmanager
def crowd(count=5):
    """Let this process and its children share one core with `count` busy processes."""
    before = os.sched_getaffinity(0)
    os.sched_setaffinity(0, {min(before)})
    busy = [sys.executable, "-S", "-c", "print(flush=True)\nwhile True: pass"]
    hogs = [subprocess.Popen(busy, start_new_session=True, stdout=subprocess.PIPE) for _ in range(count)]
    try:
        for hog in hogs:
            hog.stdout.readline()                                      # it is busy from now on
        yield
    finally:
        for hog in hogs:
            hog.kill()
            hog.communicate()
        os.sched_setaffinity(0, before)


BUSY = """
import time
def observed_order(dts, errors):
    began = time.process_time()
    while time.process_time() - began < {seconds}:
        pass
    return 3.0
"""


@pytest.mark.long
def test_busy_neighbours_take_none_of_a_submissions_time():
    with crowd(), opened(BUSY.format(seconds=0.8)) as place:           # the worker shares the core, too
        began = time.monotonic()
        place.begin(LIMIT)
        assert place.call("lesson:observed_order", (1.0, 1.0)) == 3.0
        assert time.monotonic() - began > LIMIT                        # a limit of wall time would have ended it
        assert 0.8 <= place.meter.used < LIMIT and not place.late


@pytest.mark.long
def test_busy_neighbours_take_none_of_the_time_of_calls_to_and_fro():
    text = (
        "\ndef euler_step(acceleration, t, x, v, dt, p):\n"
        "    for _ in range(300):\n"
        "        x = acceleration(t, x, v, p)\n"
        "    return x, v\n"
    )
    calls = []

    def counted(t, x, v, p):
        calls.append(t)
        return x + 1.0
    with crowd(), opened(text) as place:
        place.begin(LIMIT)
        assert place.call("lesson:euler_step", (counted, 0.0, 0.0, 0.0, 0.1, None))[0] == 300.0
        assert len(calls) == 300 and not place.late


@pytest.mark.long
@pytest.mark.parametrize("body", [
    "time.sleep(60.0)",
    "[time.sleep(0.01) for _ in range(6000)]",
    "os.kill(os.getpid(), signal.SIGSTOP)",
    "threading.Event().wait(60.0)",
    "[None for _ in iter(int, 1)]",
    "[hashlib.sha256(bytes(1000)) and time.sleep(0.001) for _ in range(60_000)]",
])
def test_a_call_that_sleeps_or_loops_is_ended(body):
    imports = "\nimport hashlib, os, signal, threading, time\n"
    with opened(f"{imports}def observed_order(dts, errors):\n    {body}\n") as place:
        place.begin(LIMIT)
        with pytest.raises(box.Lost, match="it took too long"):
            place.call("lesson:observed_order", (1.0, 1.0))
        assert place.overdue and LIMIT <= place.meter.used < 3.0 * LIMIT


TWO_ANSWERS = """
import json, os, struct, sys, time
def observed_order(dts, errors):
    head, out = json.dumps(["value", 1.0, []]).encode(), sys.modules["__main__"].outgoing
    out.write(struct.pack("<4sIQ", b"WBK1", len(head), 0) + head)
    out.flush()
    time.sleep(0.3)
    return 2.0
"""
DEAF = """
import json, struct, sys, time
def observed_order(f, errors):
    main = sys.modules["__main__"]
    head = json.dumps(["call", "test:0", [{"a": ["f8", [100000]]}, 0.5]]).encode()
    for _ in range(50):
        main.outgoing.write(struct.pack("<4sIQ", b"WBK1", len(head), 800000) + head + bytes(800000))
        main.outgoing.flush()
    time.sleep(1e5)
"""


@pytest.mark.long
def test_a_worker_that_does_not_read_the_answers_uses_up_its_own_time():
    with opened(DEAF) as place:
        place.begin(LIMIT)
        with pytest.raises(box.Lost, match="it took too long"):
            place.call("lesson:observed_order", (lambda x, y: x + place.depth, 1.0))
        assert place.overdue and place.meter.used >= LIMIT


@pytest.mark.long
def test_a_worker_that_waits_for_the_disk_uses_up_its_own_time(monkeypatch):
    with opened("\nimport time\ndef observed_order(dts, errors):\n    time.sleep(60.0)\n") as place:
        read = meter.Path.read_text
        monkeypatch.setattr(meter.Path, "read_text", lambda path: read(path).replace(") S ", ") D "))
        place.begin(LIMIT)
        with pytest.raises(box.Lost, match="it took too long"):
            place.call("lesson:observed_order", (1.0, 1.0))
        assert LIMIT <= place.meter.used < 3.0 * LIMIT


@pytest.mark.long
def test_nothing_extends_the_time_of_a_lesson(monkeypatch):
    """Here the meter sees nothing of what the worker does."""
    monkeypatch.setattr(box, "CROWDED", 2.0)
    monkeypatch.setattr(meter.Meter, "look", lambda self, owes: setattr(self, "looked", time.monotonic()))
    sleeper = "\nimport time\ndef observed_order(*_):\n    time.sleep(1e5)\n"
    budget = 8.0
    place = remote.box_of("integrators", (HONEST + sleeper).encode(), budget)
    ends = place.ends
    try:
        place.open()
        for word, limit in (("it took too long", LIMIT), ("the time for the whole submission is used up", budget)):
            place.begin(limit)
            with pytest.raises(box.Lost, match=word):
                place.call("lesson:observed_order", (1.0, 1.0))
        assert place.late and place.ends == ends and place.patience <= ends
    finally:
        place.close()


@pytest.mark.long
@pytest.mark.parametrize(("share", "late"), [(0.2, True), (0.9, False)])
def test_a_second_try_is_for_times_that_depend_on_other_processes(share, late):
    """The worker had `share` of the processor since the test began.  The clock is set: no crowd ensures a share."""
    with opened("\ndef observed_order(dts, errors):\n    while True:\n        pass\n") as place:
        place.begin(LIMIT)
        with pytest.raises(box.Lost, match="it took too long"):
            place.call("lesson:observed_order", (1.0, 1.0))
        place.late, place.began = False, (time.monotonic() - place.meter.used / share, 0.0)
        place.too_long()
        assert place.late == late


@pytest.mark.long
def test_a_program_that_forges_answers_uses_up_its_time():
    with opened(TWO_ANSWERS) as place:
        for _ in range(3):
            place.begin(LIMIT)
            assert place.call("lesson:observed_order", (1.0, 1.0)) == 1.0
        assert place.meter.used >= 2.0 * box.BREACH


@pytest.mark.long
def test_a_loop_without_end_is_waited_for_once(monkeypatch):
    monkeypatch.setattr(plugin, "BOX_LIMIT", LIMIT)
    monkeypatch.setattr(plugin, "AGAIN", 0.2)
    with opened("\ndef euler_step(*arguments):\n    while True:\n        pass\n") as place:
        before, subject = place.meter.used, remote.lesson_in(place, "integrators")
        outcomes = points.grade("integrators", subject, lambda exercise, test: exercise in ("1.1", "1.10"))
        assert LIMIT + 0.2 <= place.meter.used - before < 2.0 * LIMIT
        said = "Lost: it took too long; does one of your loops never end?"
        told = (said, "limit the number of rounds of each loop")       # no hint to the physics
        assert [(o.got, o.hint) for o in outcomes if o.exercise == "1.1"] == [told] * 2
        assert not place.overdue                                       # 1.10 has come after it


@pytest.mark.long
def test_many_short_calls_count_together():
    with opened(BUSY.format(seconds=0.01)) as place:
        def call_often():
            for _ in range(1000):
                place.call("lesson:observed_order", (1.0, 1.0))

        place.begin(LIMIT)
        with pytest.raises(box.Lost, match="it took too long"):
            call_often()
        assert place.overdue and LIMIT <= place.meter.used < 2.0 * LIMIT


@pytest.mark.long
def test_a_callback_of_the_grader_counts_as_time_of_the_submission():
    def slow(t, x, v, p):
        began = time.process_time()
        while time.process_time() - began < 0.1:
            pass
        return x

    text = (
        "\ndef observed_order(f, errors):\n"
        "    for _ in range(60):\n"
        "        f(0.0, 1.0, 1.0, None)\n"
        "    return 3.0\n"
    )
    with opened(text) as place:
        place.begin(LIMIT)
        with pytest.raises(box.Lost, match="it took too long"):
            place.call("lesson:observed_order", (slow, 1.0))
        assert place.overdue and place.meter.used >= 0.9 * LIMIT            # two clocks of one process, read in turn


UNPACKED = """
import json, struct, sys
def observed_order(f, errors):
    main, head = sys.modules["__main__"], json.dumps(["call", "test:0", {arguments}]).encode()
    frame = struct.pack("<4sIQ", b"WBK1", len(head), {size}) + head + bytes({size})
    while True:
        main.outgoing.write(frame)
        main.outgoing.flush()
        main.wire.read(main.incoming)
"""


@pytest.mark.long
@pytest.mark.parametrize(("arguments", "size"), [([[[]] * 60_000], 0), ([{"a": ["f8", [900_000]]}], 7_200_000)],
                         ids=["many", "large"])
def test_what_it_costs_the_grader_to_unpack_calls_counts_as_time_of_the_submission(arguments, size):
    def quick(*_):
        return len(calls)

    calls = []
    with opened(UNPACKED.format(arguments=repr(arguments), size=size)) as place:
        place.begin(LIMIT)
        before, began = place.meter.used, time.thread_time()
        with pytest.raises(box.Lost, match="it took too long"):
            place.call("lesson:observed_order", (quick, 1.0))
        ours = time.thread_time() - began
        assert 0.2 * LIMIT < ours < place.meter.used - before + 0.2


@pytest.mark.long
def test_all_calls_together_have_a_budget():
    with opened(BUSY.format(seconds=0.5)) as place:
        place.budget = place.meter.used + 0.2
        place.begin(LIMIT)
        with pytest.raises(box.Lost, match="the time for the whole submission is used up"):
            place.call("lesson:observed_order", (1.0, 1.0))
        place.begin(LIMIT)
        with pytest.raises(box.Lost, match="the time for the whole submission is used up"):
            place.call("lesson:observed_order", (1.0, 1.0))


# ---------------------------------------------------------------------------------------------- alarms

def loop_for(seconds):
    until = time.monotonic() + seconds
    while time.monotonic() < until:
        pass


@pytest.mark.long
@pytest.mark.parametrize("own", [False, True])
def test_an_alarm_goes_on_after_one_inside_it(own):
    def loop_after_an_alarm():
        with loading.alarm(60.0, box.Late, own):
            pass
        loop_for(60.0)

    with pytest.raises(loading.TooLong), loading.alarm(0.3, loading.TooLong, own):
        loop_after_an_alarm()


@pytest.mark.parametrize("own", [False, True])
def test_an_alarm_rings_inside_a_longer_one(own):
    with pytest.raises(loading.TooLong), loading.alarm(0.3, loading.TooLong, own), loading.alarm(60.0, box.Late, own):
        loop_for(60.0)


@pytest.mark.long
def test_no_alarm_is_left():
    import signal
    with loading.alarm(60.0, loading.TooLong), loading.alarm(60.0, loading.TooLong, own=True):
        pass
    assert signal.getitimer(signal.ITIMER_REAL)[0] == signal.getitimer(signal.ITIMER_PROF)[0] == 0.0
    thread = threading.Thread(target=lambda: loading.alarm(1.0, loading.TooLong).__enter__())
    thread.start()
    thread.join()
    assert signal.getitimer(signal.ITIMER_REAL)[0] == 0.0


@pytest.mark.long
def test_a_callback_leaves_the_tests_own_alarm_as_it_was():
    text = "\ndef observed_order(f, errors):\n    return f(0.0, 1.0, 1.0, None)\n"
    asked = []

    def counted(t, x, v, p):
        asked.append(t)
        return x

    def call_and_loop(place):
        place.begin(LIMIT)
        assert place.call("lesson:observed_order", (counted, 1.0)) == 1.0 and asked == [0.0]
        loop_for(30.0)                                                 # the test itself does not end

    with opened(text) as place, pytest.raises(loading.TooLong), loading.alarm(0.5, loading.TooLong, own=True):
        call_and_loop(place)


# ---------------------------------------------------------------------------------------------- the end of a worker

FLOOD = """
import json, os, struct, sys
def observed_order(dts, errors):
    head, out = json.dumps(["value", 3.0, []]).encode(), sys.modules["__main__"].outgoing
    frame = struct.pack("<4sIQ", b"WBK1", len(head), 0) + head
    while True:
        out.write(1000 * frame)
"""


@pytest.mark.long
def test_a_worker_that_floods_is_ended_and_its_pipes_are_closed():
    with opened(FLOOD) as place:
        place.begin(60.0)
        assert place.call("lesson:observed_order", (1.0, 1.0)) == 3.0
        process = place.process
        place.stop()
        assert place.process is None and process.stdin.closed and process.stdout.closed and process.stderr.closed


@pytest.mark.long
def test_a_worker_that_does_not_listen_is_ended_and_what_waits_is_given_up():
    with opened("\nimport time\ndef observed_order(dts, errors):\n    time.sleep(60.0)\n") as place:
        place.begin(60.0)
        for _ in range(box.MOST_WAITING):
            place.send(bytes(100_000))                                 # more than the pipe holds
        assert place.line.waiting
        process = place.process
        place.stop()
        assert not place.line.waiting and process.stdin.closed


def test_more_than_a_frame_that_no_one_asked_for_breaks_the_rules():
    read, write = os.pipe()
    silent, kept = os.pipe()
    noted, note = os.pipe()
    pipes = [os.fdopen(number, mode, buffering=0) for number, mode in ((write, "wb"), (silent, "rb"), (noted, "rb"))]
    process = types.SimpleNamespace(stdin=pipes[0], stdout=os.fdopen(read, "rb", buffering=0), stderr=pipes[1])
    notes = []
    place = line.Line(process, lambda chunk: None, pipes[2], notes.append)
    place.arrived += bytes(line.LONGEST + 1)
    with pytest.raises(wire.WireError, match="more than anyone asked for"):
        place.pump(0.0)
    place.arrived.clear()
    frame = wire.pack(("value", 1.5, []))
    place.send(frame[:7])
    place.pump(1.0)
    assert place.frame() is None
    place.send(frame[7:] + b"x")
    place.pump(1.0)
    assert wire.unpack(*place.frame()) == ("value", 1.5, ()) and place.frame() is None
    process.stdin.close()
    os.close(kept)
    os.write(note, b"\3")
    os.close(note)
    assert place.drain(5.0) and not place.open
    with pytest.raises(line.Ended):
        place.frame()
    assert b"".join(notes) == b"\3"
    for pipe in (process.stdout, process.stderr, pipes[2]):
        pipe.close()


@pytest.mark.long
def test_a_second_answer_is_seen_however_late_it_comes():
    with opened(TWO_ANSWERS) as place:
        place.begin(LIMIT)
        assert place.call("lesson:observed_order", (1.0, 1.0)) == 1.0
        first = place.process
        place.begin(LIMIT)                                             # the second answer is still to come
        assert place.process is not first and "wire" in place.seen
        assert place.call("lesson:observed_order", (1.0, 1.0)) == 1.0


@pytest.mark.long
def test_an_honest_worker_is_kept_from_test_to_test():
    with opened("") as place:
        first = place.process
        for _ in range(3):
            place.begin(LIMIT)
            place.call("lesson:euler_step", (lambda *a: a[1], 0.0, np.ones(2), np.ones(2), 0.1, None))
        assert place.process is first and not place.seen


# ---------------------------------------------------------------------------------------------- the second try

@pytest.fixture(scope="module")
def settings():
    return marking.settings(("integrators", "springs"), "a secret")


# The system ends a process by SIGKILL without a signal that the process has sent: here it does so for its time.
KILLED_BY_THE_SYSTEM = "resource.setrlimit(resource.RLIMIT_CPU, (1, 1))\nwhile True:\n    pass\n"


def submission(student, text, lesson="integrators"):
    return submissions.Submission(student, {lesson: text.encode()}, (), "")


@pytest.mark.long
def test_what_may_be_others_fault_is_noted(settings):
    lost = marking.mark(submission("ada", "import resource\n" + KILLED_BY_THE_SYSTEM), settings)
    own = marking.mark(submission("bob", "import os\nos._exit(1)\n"), settings)
    sent = marking.mark(submission("eve", "import os, signal\nos.kill(os.getpid(), signal.SIGKILL)\n"), settings)
    assert lost["again"] == ["integrators"] and own["again"] == [] and sent["again"] == []


@pytest.mark.long
def test_a_second_try_replaces_what_timed_out_and_nothing_else(settings):
    first = marking.mark(submission("ada", "raise ValueError\n"), settings)
    first = {**first, "again": ["integrators"], "seconds": 10.0}
    (student, result, why), = alone(first, settings)
    assert student == "ada" and not why
    assert result["again"] == [] and result["digest"] == first["digest"] and result["seconds"] > 10.0
    passed = {t["exercise"] for t in result["tests"] if t["status"] == "passed"}
    assert passed >= {"1.1", "1.2"}
    assert all(t["status"] == "not handed in" for t in result["tests"] if t["lesson"] == "springs")


def alone(first, settings):
    """What local.results makes of that first try."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(local, "together", lambda jobs, todo, settings: [(todo[0], first, "")])
        return [*local.results(1, [submission("ada", SOLVED)], settings)]


class Killer(submissions.Submission):
    """Ends the process that gets to grade it."""

    def __reduce__(self):
        return os._exit, (1,)


@pytest.mark.long
def test_a_submission_that_ends_the_grading_process_harms_no_other(settings):
    honest = [submission(f"s{n}", SOLVED) for n in range(3)]
    killers = [Killer(f"k{n}", {}, (), "") for n in range(2)]
    all_of_them = [killers[0], *honest, killers[1]]
    found = {student: (result, why) for student, result, why in local.results(2, all_of_them, settings)}
    assert {student: why for student, (_, why) in found.items() if why} == {"k0": local.DIED, "k1": local.DIED}
    for one in honest:
        tests = found[one.student][0]["tests"]
        assert "1.1" in {t["exercise"] for t in tests if t["status"] == "passed"}


@pytest.mark.long
def test_a_child_is_replaced_when_it_ends():
    with children.Child(len, ()) as child:
        with pytest.raises(children.Ended):
            child(os._exit, 1)
        assert child(os.getpid) not in (os.getpid(), child(os.getppid))


# ---------------------------------------------------------------------------------------------- a worker that waits

@pytest.mark.long
def test_a_submission_that_waits_again_and_again_ends_as_a_whole():
    """Each test has its own time, but answers compute: what sleeps in all of them ends after ASLEEP seconds."""
    text = "\nimport time\ndef observed_order(dts, errors):\n    time.sleep(60.0)\n"
    with opened(text) as place:
        began = time.monotonic()
        for _ in range(4):
            place.begin(10.0)
            with pytest.raises(box.Lost, match=r"waits and does not compute"):
                place.call("lesson:observed_order", (1.0, 1.0))
        assert place.meter.slept < 2.0 * box.ASLEEP
        assert place.meter.slept <= time.monotonic() - began + box.LAST_WORD_WITHIN


@pytest.mark.long
def test_a_worker_does_not_sleep_while_it_waits_for_our_answer():
    text = (
        "\ndef euler_step(acceleration, t, x, v, dt, p):\n"
        "    for _ in range(40):\n"
        "        x = acceleration(t, x, v, p)\n"
        "    return x, v\n"
    )

    def slow(t, x, v, p):
        until = time.thread_time() + 0.02
        while time.thread_time() < until:
            pass
        time.sleep(0.0)
        return x + 1.0
    with opened(text) as place:
        place.begin(20.0)
        assert place.call("lesson:euler_step", (slow, 0.0, 0.0, 0.0, 0.1, None))[0] == 40.0
        assert place.meter.slept < 0.1


@pytest.mark.long
def test_a_program_reads_no_path_of_the_tests_and_sets_no_limit_of_its_sandbox():
    text = (
        "\nimport resource\n"
        "def euler_step(acceleration, t, x, v, dt, p):\n"
        "    print('file', acceleration.__code__.co_filename)\n"
        "    for process in (1, 2):\n"
        "        try:\n"
        "            print('limit', resource.prlimit(process, resource.RLIMIT_NOFILE, (3, 3)))\n"
        "        except OSError:\n"
        "            pass\n"
        "    return x, v\n"
    )
    with opened(text) as place:
        place.begin(LIMIT)
        place.call("lesson:euler_step", (lambda t, x, v, p: x, 0.0, 0.0, 0.0, 0.1, None))
        place.stop()
        printed = place.printed.decode()
    assert "file <test>" in printed and "limit" not in printed
