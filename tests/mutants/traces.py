"""`python -m tests.mutants.traces [LESSON …]`: write validate/mistakes/<lesson>.json, the traces of all wrong answers.

Without a lesson it writes all of them, which takes some minutes.  Write a lesson's table again after a change of its
grading tests, of its worked answers or of its wrong answers.
"""

import importlib
import json
import sys
import types

from solutions.checks import BadInput
from validate import mistakes, modules
from validate.generate import exercises

from ..grading import points


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
    """The table of a lesson, as `mistakes.table` reads it."""
    kept, names, module = mutants_of(lesson), names_in(lesson), modules.bind(lesson)
    answers = {k: (mutant.exercise, mutant.function) for k, mutant in enumerate(kept)}
    worked = {number: (number, getattr(module, name)) for number, name in names.items()}
    traces, table = traces_of(lesson, {**worked, **answers}, every=True), {}
    for number, name in names.items():
        right = [traces[k] for k, mutant in enumerate(kept) if mutant.right and mutant.exercise == number]
        orderless = in_any_order(traces[number], right)
        kinds = set().union(*(trace.kinds for trace in traces[number].values()))
        table[number] = {"function": name, "orderless": orderless, "returns": kinds.pop() if len(kinds) == 1 else "",
                         "right": {test: stored(trace, orderless) for test, trace in traces[number].items()},
                         "wrong": []}
    for k, mutant in enumerate(kept):
        if not mutant.right:
            table[mutant.exercise]["wrong"] += entry(mutant, traces[k], traces[mutant.exercise], table[mutant.exercise])
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


def write(lesson):
    """Write the table of a lesson; its path."""
    path = mistakes.FOLDER / f"{lesson}.json"
    path.write_text(json.dumps(table_of(lesson), ensure_ascii=False, separators=(",", ":")) + "\n", encoding="utf-8")
    mistakes.table.cache_clear()
    return path


def main(lessons):
    try:
        for lesson in lessons or modules.lesson_names():
            modules.bind(lesson)
            path = write(lesson)
            table = mistakes.table(lesson)
            found = {(number, one["idea"]) for number, exercise in table.items() for one in exercise["wrong"]}
            wrong = [(m.exercise, m.story) for m in mutants_of(lesson) if not m.right]
            print(f"{path.name}: {len(found)} of {len(wrong)} wrong answers, {path.stat().st_size // 1000} kB")
            for exercise, story in (one for one in wrong if one not in found):
                print(f"  in no trace: {exercise} {story}")
    except BadInput as e:
        print(e, file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
