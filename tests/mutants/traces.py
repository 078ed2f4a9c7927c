"""`python -m tests.mutants.traces [LESSON …]`: write validate/mistakes/<lesson>.json, the traces of all wrong answers.

Without a lesson it writes all of them, which takes some minutes.  Write a lesson's table again after a change of its
grading tests, of its worked answers or of its wrong answers.

Every table is computed once for each of the PROCESSORS, in a process whose linear algebra rounds as it does there.
Results that differ are decided by round-off, such as the nearest points of two parallel faces.  The table has no number
for them, so that an answer gets the same name on every machine.
"""

import functools
import importlib
import json
import os
import subprocess
import sys
import types
from typing import Annotated

import numpy as np
import typer

from validate import mistakes
from validate.grading import points
from validate.run.command import start
from validate.subject import modules
from validate.subject.generate import exercises

# OpenBLAS rounds differently on each of these kinds of processors.  {kind: whether NumPy uses its wide vectors, too}
PROCESSORS = {"Prescott": False, "Nehalem": True, "Haswell": True, "SkylakeX": True}
WIDEST = "SkylakeX"          # a machine without AVX-512 cannot imitate it: write its tables again on one that has it


def mutants_of(lesson):
    return importlib.import_module(f"tests.mutants.{lesson}").MUTANTS


def traces_of(lesson, answers, every=False, cases=None):
    """{key: {test: Trace}} of some answers, {key: (exercise, function)}, in the tests of their exercises.

    every: keep all calls, as for writing a table.  cases: FailingCases, which keep the calls that fail.
    """
    names, module = names_in(lesson), vars(modules.bind(lesson))

    def subject(number, function):
        changed = types.SimpleNamespace(**{**module, names[number]: function})
        return changed, lambda exercise, test: exercise == number
    traces = mistakes.Traces(names, every)
    points.grade_each(lesson, {str(key): subject(*answer) for key, answer in answers.items()}, traces=traces,
                      cases=cases)
    return {key: traces.of(str(key), number) for key, (number, _) in answers.items()}


def names_in(lesson):
    """{exercise: name of its function}"""
    return exercises((modules.SOLUTIONS / f"{lesson}.py").read_text(encoding="utf-8"))


def table_of(lesson):
    """The table of a lesson, as `mistakes.table` reads it, and with the number of each wrong answer."""
    kept, names, module = mutants_of(lesson), names_in(lesson), modules.bind(lesson)
    answers = {k: (mutant.exercise, mutant.function) for k, mutant in enumerate(kept)}
    worked = {number: (number, getattr(module, name)) for number, name in names.items()}
    traces, table = traces_of(lesson, {**worked, **answers}, every=True), {}
    for number, name in names.items():
        right = [traces[k] for k, mutant in enumerate(kept) if mutant.right and mutant.exercise == number]
        orderless = in_any_order(traces[number], right)
        kinds = set().union(*(trace.kinds for trace in traces[number].values()))
        table[number] = {"function": name, "orderless": orderless, "returns": mistakes.common(kinds),
                         "right": {test: stored(trace, orderless) for test, trace in traces[number].items()},
                         "wrong": []}
    for k, mutant in enumerate(kept):
        if not mutant.right:
            found = entry(mutant, traces[k], traces[mutant.exercise], table[mutant.exercise])
            table[mutant.exercise]["wrong"] += [{**one, "number": k} for one in found]
    return table


def entry(mutant, traces, worked, known):
    """[What is stored of a wrong answer]; nothing where it returns what the worked one returns, as far as it gets."""
    kept = {test: trace.kept(known["orderless"]) for test, trace in traces.items()}
    tests = [test for test in kept if not mistakes.all_same(kept[test], known["right"][test])]
    early = [test for test in tests if mistakes.differ(kept[test], known["right"][test])]
    later = {test: mistakes.first_difference(traces[test], worked[test], known["orderless"])
             for test in tests if test not in early}
    later = {test: found for test, found in later.items() if found}
    stored = {test: mistakes.stored(kept[test]) for test in tests}
    known_by = (early or later) and mistakes.is_telling(traces.values())
    return [{"idea": mutant.story, "tests": stored, "later": later}] if known_by else []


def stored(trace, orderless):
    return mistakes.stored(trace.kept(orderless))


def in_any_order(worked, right):
    """Whether some right answer returns the same results as the worked one in another order."""
    def agrees(traces, orderless):
        return all(mistakes.all_same(trace.kept(orderless), stored(worked[test], orderless))
                   for test, trace in traces.items())
    return any(agrees(traces, True) and not agrees(traces, False) for traces in right)


def tables_of(lesson):
    """The tables of a lesson as each of the PROCESSORS computes it that this machine can imitate."""
    program = f"import json; from tests.mutants.traces import table_of; print(json.dumps(table_of({lesson!r})))"
    found = np.show_config(mode="dicts")["SIMD Extensions"]["found"]
    wide = " ".join(found)
    for kind, vectors in PROCESSORS.items():
        if kind == WIDEST and not any(name.startswith(("AVX512", "X86_V4")) for name in found):
            print(f"{lesson}: without {kind}, because this machine has no AVX-512", file=sys.stderr)
            continue
        rounding = {"OPENBLAS_CORETYPE": kind, "NPY_DISABLE_CPU_FEATURES": "" if vectors else wide}
        said = subprocess.run([sys.executable, "-W", "ignore", "-c", program], cwd=modules.ROOT, check=True, text=True,
                              env={**os.environ, **rounding}, stdout=subprocess.PIPE).stdout
        yield json.loads(said.splitlines()[-1])


def steady(results, elsewhere):
    """The stored results, with None or HUGE for those that differ elsewhere.  All do where the number differs."""
    if len(results) != len(elsewhere):
        return []
    return [both_say(one, other) for one, other in zip(results, elsewhere, strict=True)]


def both_say(one, other):
    """A result that is the same elsewhere, HUGE where both are large, or None."""
    if one == other:
        return one
    if one is None or other is None or isinstance(one, str) or isinstance(other, str) or one[0] != other[0]:
        return None
    if abs(one[1] - other[1]) <= max(mistakes.ROUND_OFF, mistakes.SAME * abs(one[1])):     # no more than `same` allows
        return one
    return mistakes.HUGE if min(abs(one[1]), abs(other[1])) > mistakes.LARGE else None


def agree(results, right):
    """Whether stored results are the right ones, as far as both are known."""
    return len(results) == len(right) and all(
        one == other for one, other in zip(results, right, strict=True) if one and other)


def tells(results, right):
    """Whether a stored result about which round-off does not decide differs from the right one of the same call.

    Otherwise any answer that ends a test after as many calls would have the name.
    """
    return any(one and not mistakes.same(one if isinstance(one, str) else [*one, abs(one[1])], other)
               for one, other in zip(results[:-1], right[:-1], strict=False))


def without_the_unsteady(table, elsewhere):
    """The table without results that differ elsewhere, and without wrong answers that nothing else distinguishes."""
    for number, exercise in table.items():
        other = elsewhere[number]
        right = {test: steady(results, other["right"][test]) for test, results in exercise["right"].items()}
        numbered, kept = {mistake["number"]: mistake for mistake in other["wrong"]}, []    # stories may be the same
        for mistake in exercise["wrong"]:
            there = numbered.get(mistake["number"], {"tests": {}})["tests"]
            tests = {test: steady(results, there.get(test, [])) for test, results in mistake["tests"].items()}
            seen = {test: results for test, results in tests.items()
                    if None in results or not agree(results, right[test])}
            later = {test: found for test, found in mistake["later"].items() if test in seen}
            telling = later or any(tells(results, right[test]) for test, results in seen.items())
            if all(tests.values()) and telling:
                kept.append({**mistake, "tests": seen, "later": later})
        exercise["right"], exercise["wrong"] = right, kept
    return table


def write(lesson):
    """Write the table of a lesson; its path."""
    path = mistakes.FOLDER / f"{lesson}.json"
    table = functools.reduce(without_the_unsteady, tables_of(lesson))
    for exercise in table.values():
        exercise["wrong"] = [{name: mistake[name] for name in ("idea", "tests", "later")}
                             for mistake in exercise["wrong"]]
    path.write_text(json.dumps(table, ensure_ascii=False, separators=(",", ":")) + "\n", encoding="utf-8")
    mistakes.table.cache_clear()
    return path


def main(lesson: Annotated[list[str] | None, typer.Argument(help="Such as springs.")] = None):
    """Write the tables of known mistakes of these lessons, or of all."""
    for name in lesson or modules.lesson_names():
        modules.bind(name)
        path = write(name)
        table = mistakes.table(name)
        found = {(number, one["idea"]) for number, exercise in table.items() for one in exercise["wrong"]}
        wrong = [(m.exercise, m.story) for m in mutants_of(name) if not m.right]
        print(f"{path.name}: {len(found)} of {len(wrong)} wrong answers, {path.stat().st_size // 1000} kB")
        for exercise, story in (one for one in wrong if one not in found):
            print(f"  in no trace: {exercise} {story}")


if __name__ == "__main__":
    start("python -m tests.mutants.traces", main)
