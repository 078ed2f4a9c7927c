"""Grading on this machine: several submissions at a time, each in a process of its own."""

from collections import deque
from concurrent.futures import FIRST_COMPLETED, wait

from solutions.checks import BadInput

from . import children, marking, sandbox

DIED = "the grading process ended unexpectedly, or hung"


def check_seed(settings):
    """Raise BadInput where a test refuses the worked answer of an exercise with the inputs that this seed draws."""
    with children.Child(sandbox.keep_out, sandbox.private) as child:
        refused = child(marking.refused, settings, patience=marking.patience(settings))
    if refused:
        raise BadInput("the secret seed", f"one with which a test refuses the worked answer of {', '.join(refused)}",
                       "give another --seed, and please report this one")


def results(jobs, todo, settings):
    """Yield (student, result, "") or (student, None, why the grader failed), as they come.

    If the time was up or the grader failed, other processes may be the cause: it is tried again at the end, alone.
    """
    again = []
    for submission, result, why in together(jobs, todo, settings):
        if why or result["again"]:
            again.append((submission, result))
        else:
            yield submission.student, result, ""
    with children.Child(sandbox.keep_out, sandbox.private) as child:
        for submission, first in again:
            try:
                patience = marking.patience(settings)
                yield submission.student, *child(marked, submission, settings, first, patience=patience)
            except (children.Ended, TimeoutError):
                yield submission.student, None, DIED


def together(jobs, todo, settings):
    """Generate (submission, result, why the grader failed), in any order.

    A process that dies or hangs ends those of the others, too; new processes do the rest.
    """
    waiting = deque(todo)
    while waiting:
        running = {}
        try:
            with children.Pool(max(1, min(jobs, len(waiting))), sandbox.keep_out, sandbox.private) as pool:
                while waiting or running:
                    while waiting and len(running) < jobs:
                        running[pool.submit(marked, waiting[0], settings)] = waiting[0]
                        waiting.popleft()
                    done = wait(running, timeout=marking.patience(settings), return_when=FIRST_COMPLETED).done
                    if not done:
                        raise children.Ended()
                    for future in done:
                        result, why = future.result()
                        yield running.pop(future), result, why
        except children.Ended:
            for submission in running.values():
                yield submission, None, DIED


def marked(submission, settings, first=None):
    """Return (result, "") or (None, why the grader failed).

    first: the result of a first try, of which a part is done again.
    """
    try:
        return marking.again(submission, settings, first) if first else marking.mark(submission, settings), ""
    except Exception as e:
        return None, f"{type(e).__name__}: {e}"
