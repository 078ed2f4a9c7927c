"""Grade on this machine, several submissions at a time, each in a process of its own while it lasts."""

from concurrent.futures import as_completed
from concurrent.futures.process import BrokenProcessPool

from . import children, marking, sandbox


def results(jobs, todo, settings):
    """(student, result, "") or (student, None, why the grader failed), as they come."""
    waiting = {s.student: s for s in todo}
    for attempt in (1, 2):                               # a grading process that died takes others' work along: once more, one at a time
        with children.Pool(max(1, min(jobs, len(waiting))) if attempt == 1 else 1, sandbox.keep_out, sandbox.private) as pool:
            futures = {pool.submit(marked, s, settings): s.student for s in waiting.values()}
            for future in as_completed(futures):
                try:
                    result, why = future.result()
                except BrokenProcessPool:
                    continue
                waiting.pop(futures[future])
                yield futures[future], result, why
        if not waiting:
            return
    for student in waiting:
        yield student, None, "the grading process ended unexpectedly"


def marked(submission, settings):
    """(result, "") or (None, why the grader failed)."""
    try:
        return marking.mark(submission, settings), ""
    except Exception as e:
        return None, f"{type(e).__name__}: {e}"
