"""The name of the mistake in an answer: its results in the grading tests are compared with those of wrong answers.

The grading tests draw the same public inputs for everyone, so the same mistake gives the same numbers.  While a test
runs, a Trace keeps one number for each of the first results of the exercise's function, and for some later ones:
a sum of all numbers in the result, each with a weight of its own.  `<lesson>.json` has these sums for every wrong
answer of the lesson, with a sentence about its idea.  `python -m tests.mutants.traces` writes it.  No answer can be
read from it, because it holds no code and fewer numbers than a result.

With secret inputs nothing is traced.

*Left out:* answers with two mistakes.  They give the numbers of neither.
"""

import functools
import json
import re
from hashlib import sha256
from pathlib import Path

import numpy as np

FIRST = 64                   # of the calls in a test these are kept, and after them number 128, 256, …
EVERY = 4096                 # number of calls that are kept while a table is written
SAME, ROUND_OFF = 1e-6, 1e-9   # two sums are the same within this part of their terms, or within this
VISIBLE = 1e-3               # a result that is off by this part of its own terms is wrong, however small it is
HUGE, LARGE = "huge", 1e6    # is stored in place of a sum that is above this, and about which round-off decides
DIGITS = 8                   # of a stored sum, and of the digest of a text
GOLDEN = 0.6180339887498949  # cubes times it, modulo 1, are spread evenly, and no two differences are the same
MOST = 2                     # number of ideas that are named if several give the same numbers
NOTHING = object()           # the last result where there is none
CHANGED = "has changed its input"
ONE, TWO = "a one-dimensional array", "a two-dimensional array"
FOLDER = Path(__file__).parent


@functools.cache
def table(lesson):
    """Return {exercise: its function, the trace of a right answer, and those of wrong ones}; empty if there is none."""
    file = FOLDER / f"{lesson}.json"
    return json.loads(file.read_text(encoding="utf-8")) if file.is_file() else {}


# ---------------------------------------------------------------------------------------------- what is kept

class Traces:
    """What the functions of the exercises return in a run: found = {(subject, exercise): {test: its Trace}}.

    functions: {exercise: name}, as in the tables if None.  every: keep all calls, for writing a table.
    """

    def __init__(self, functions=None, every=False):
        self.functions, self.every, self.found = functions, every, {}

    def begin(self, subject, lesson, exercise, test):
        """Return the Trace of one test."""
        if self.every:
            trace = Trace(self.functions[exercise], range(1, EVERY + 1))
        else:
            known = table(lesson).get(exercise, {"function": "", "wrong": []})
            later = {mistake["later"][test][0] for mistake in known["wrong"] if test in mistake["later"]}
            trace = Trace(known["function"] if self.functions is None else self.functions[exercise], later)
        self.found.setdefault((subject, exercise), {})[test] = trace
        return trace

    def of(self, subject, exercise):
        """Return {test: Trace} of an exercise."""
        return self.found.get((subject, exercise), {})


class Trace:
    """The calls of one function in one test, each as `summary` has it.

    A test ends where it fails, so the number of calls is kept, too.
    """

    def __init__(self, function, wanted=()):
        self.function, self.wanted, self.calls, self.returned = function, wanted, 0, NOTHING
        self.arguments = ()                                          # of the last call, as they were handed in
        self.results, self.sorted_out, self.kinds = {}, {}, set()    # {number of the call: its summary}
        self.numbers, self.plain = False, set()                      # what there is of them: `is_telling`

    def of_calls(self, orderless):
        """Return {number of the call: its summary}; orderless: whether the order within a result does not matter."""
        return self.sorted_out if orderless else self.results

    def kept(self, orderless):
        """Return the results of the first calls and of some later ones, and the number of calls."""
        return [*(one for call, one in self.of_calls(orderless).items() if is_kept(call)), f"{self.calls} calls"]

    def keep(self, result, orderless):
        self.results[self.calls], self.sorted_out[self.calls] = result, orderless

    def changed_input(self):
        """Note that the last call has changed an array among its arguments."""
        self.keep(CHANGED, CHANGED)

    def watching(self, function):
        """Return the function, which adds its results to this trace."""
        @functools.wraps(function)
        def watched(*arguments, **named):
            self.calls += 1
            kept, self.returned = is_kept(self.calls) or self.calls in self.wanted, NOTHING
            self.arguments = arguments
            try:
                result = function(*arguments, **named)
            except Exception as e:
                if kept:
                    self.keep(type(e).__name__, type(e).__name__)
                    self.plain.add(type(e).__name__)
                raise
            if kept:
                self.keep(summary(result), summary(result, orderless=True))
                self.kinds.add(kind(result))
                if is_plain(result):
                    self.plain.add(str(self.results[self.calls]))
                else:
                    self.numbers = True
            self.returned = result                                   # of the last call, unless it raised: `misshapen`
            return result
        return watched


def is_kept(call):
    """Return whether the result of the call of this number is kept in every trace."""
    return call <= FIRST or call & (call - 1) == 0


def summary(result, orderless=False):
    """Return what is kept of a result: [entries, weighted sum, sum of sizes], or a word where there are no numbers.

    Of a text, such as the letter of a choice, it is a digest, so that no letter can be read in a table.
    """
    if isinstance(result, str):
        return sha256(result.strip().upper().encode()).hexdigest()[:DIGITS]
    try:
        rows = list(result) if orderless and not np.isscalar(result) else [result]
        entries = [np.nan_to_num(np.array(list(leaves(row)), dtype=float), nan=0.7, posinf=1e9, neginf=-1e9)
                   for row in rows]
    except Exception:
        return type(result).__name__
    if not sum(map(len, entries)):
        return "None" if result is None else "empty"
    weighted = [row * (1.0 + GOLDEN * np.arange(1.0, len(row) + 1.0)**3 % 1.0) for row in entries]
    sums = np.array([row.sum() for row in weighted])
    if orderless:                                                    # a sum in which equal rows may change places
        weighted, sums = [sums, sums * np.abs(sums)], sums + sums * np.abs(sums)
    size = float(sum(np.abs(row).sum() for row in weighted))
    return [sum(map(len, entries)), float(sums.sum()), size]


def is_plain(result):
    """Return whether a result is no text, and has no number but 0, 1 and −1: too little to know a mistake by."""
    if isinstance(result, str):
        return False
    try:
        numbers = np.array(list(leaves(result)), dtype=float)
    except Exception:
        return True
    return bool(np.all(~np.isfinite(numbers) | np.isin(numbers, (-1.0, 0.0, 1.0))))


def is_telling(traces):
    """Return whether these traces are more than one and the same plain result: many first tries return zeros."""
    traces = [*traces]
    return any(trace.numbers for trace in traces) or len(set().union(*(trace.plain for trace in traces))) > 1


def kind(value):
    """Return what kind of thing a result is, in words."""
    if value is None or value is NOTHING:
        return "None" if value is None else ""
    if isinstance(value, (bool, np.bool_)):
        return "True or False"
    if isinstance(value, np.ndarray) and value.ndim:
        return {1: ONE, 2: TWO}.get(value.ndim, f"an array of {value.ndim} dimensions")
    if isinstance(value, (int, float, np.number, np.ndarray)):
        return "a number"
    if isinstance(value, tuple) and not hasattr(value, "_fields"):
        return f"{len(value)} values ({', '.join(map(kind, value))})"
    name = type(value).__name__
    return f"{'an' if name[0] in 'aeiou' else 'a'} {name}"


def any_array(kind):
    """Return a kind without the numbers of dimensions of its arrays."""
    return re.sub(rf"{ONE}|{TWO}|an array of \d+ dimensions", "an array", kind)


def common(kinds):
    """Return the kind that all these results have, or "".  It tells no dimensions of arrays where these differ."""
    kinds = kinds if len(kinds) < 2 else set(map(any_array, kinds))
    return next(iter(kinds)) if len(kinds) == 1 else ""


def leaves(value):
    """Return all numbers of a result, in their order."""
    if isinstance(value, np.ndarray):
        yield from value.astype(float).ravel()
    elif isinstance(value, (tuple, list)):
        for part in value:
            yield from leaves(part)
    elif isinstance(value, (set, frozenset)):
        yield from leaves(sorted(value))
    elif isinstance(value, dict):
        for key in sorted(value):
            yield from leaves((key, value[key]))
    elif value is not None:
        yield float(value)


def same(kept, stored):
    """Return whether a result is the stored one, up to round-off.

    None is stored if round-off decides about the result.
    """
    if stored is None:
        return True
    if stored == HUGE and not isinstance(kept, str):
        return kept[2] > LARGE
    if isinstance(kept, str) or isinstance(stored, str):
        return kept == stored
    return kept[0] == stored[0] and abs(kept[1] - stored[1]) <= SAME * kept[2] + ROUND_OFF


def same_size(kept, stored, tolerance):
    """Return whether a result is the stored one up to this part of its own terms, however small they are."""
    if isinstance(kept, str) or isinstance(stored, str):
        return kept == stored
    return kept[0] == stored[0] and abs(kept[1] - stored[1]) <= tolerance * kept[2]


def all_same(kept, stored):
    return len(kept) == len(stored) and all(map(same, kept, stored))


def differ(kept, right):
    """Return whether some result differs from the right one of the same call; the number of calls does not count."""
    return not all(map(same, kept[:-1], right[:-1]))


# ---------------------------------------------------------------------------------------------- what is stored

def stored(results):
    """Return the results of a trace in few digits, as they are written down."""
    return [one if isinstance(one, str) else [one[0], float(f"{one[1]:.{DIGITS}g}")] for one in results]


def first_difference(trace, right, orderless):
    """Return [number of the call, its result, the right one] where a trace first leaves the right one, or None.

    If all results are the same up to round-off, it is a small result that is wrong for its size: the last such one,
    because a test ends with the call that fails.
    """
    found, expected = trace.of_calls(orderless), right.of_calls(orderless)
    both = [call for call in found if call in expected]
    calls = [call for call in both if not same(found[call], expected[call])]
    calls += [call for call in reversed(both) if not same_size(found[call], expected[call], VISIBLE)]
    return [calls[0], *stored([found[calls[0]], expected[calls[0]]])] if calls else None


# ---------------------------------------------------------------------------------------------- looking up

def matching(lesson, exercise, traces):
    """Return the ideas of the wrong answers that return the same in all tests of the exercise.

    traces: {test: Trace} of the answer.  An answer that returns in all tests what a right one returns has none.
    """
    known = table(lesson).get(exercise)
    if not known or traces.keys() != known["right"].keys() or not is_telling(traces.values()):
        return []
    kept = {test: trace.kept(known["orderless"]) for test, trace in traces.items()}
    wrong = {test for test, right in known["right"].items() if not all_same(kept[test], right)}
    seen = any(differ(kept[test], known["right"][test]) for test in wrong)
    found = [mistake["idea"] for mistake in known["wrong"]
             if (seen or mistake["later"])       # a test that ends early tells nothing about the results
             and wrong <= mistake["tests"].keys()          # in the others it may differ, as round-off decides
             and all(all_same(kept[test], results) for test, results in mistake["tests"].items())
             and all(same_size(traces[test].of_calls(known["orderless"]).get(call, ""), result, SAME)
                     for test, (call, result, _) in mistake["later"].items())]
    return list(dict.fromkeys(found))


def misshapen(lesson, exercise, trace):
    """Return (expected, got) if the last result is not of the kind that the exercise's function returns, or None."""
    expected = table(lesson).get(exercise, {}).get("returns", "")
    got = kind(trace.returned) if trace else ""
    return (expected, got) if expected and got and expected not in (got, any_array(got)) else None


def sentence(found):
    """Return what a student reads about these ideas."""
    if not found:
        return ""
    return f"a known mistake gives the same results: {' or '.join(f'“{idea}”' for idea in found[:MOST])}"
