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


def traces_of(lesson, answers, orderless=()):
    """{key: {test: results}} of some answers, {key: (exercise, function)}, in the tests of their exercises.

    orderless: exercises in which the order of results does not matter.
    """
    names, module = names_in(lesson), vars(modules.bind(lesson))

    def subject(number, function):
        changed = types.SimpleNamespace(**{**module, names[number]: function})
        return changed, lambda exercise, test: exercise == number
    traces = mistakes.Traces({number: (name, number in orderless) for number, name in names.items()})
    points.grade_each(lesson, {str(key): subject(*answer) for key, answer in answers.items()}, traces=traces)
    return {key: traces.of(str(key), number) for key, (number, _) in answers.items()}


def names_in(lesson):
    """{exercise: name of its function}"""
    return exercises((modules.SOLUTIONS / f"{lesson}.py").read_text(encoding="utf-8"))


def worked_answers(lesson):
    module = modules.bind(lesson)
    return {number: (number, getattr(module, name)) for number, name in names_in(lesson).items()}


def orderless_in(lesson):
    """Exercises with a right answer that returns the same results as the worked one in another order."""
    kept = {k: (m.exercise, m.function) for k, m in enumerate(mutants_of(lesson)) if m.right}
    names = names_in(lesson)
    as_is, sorted_out = (traces_of(lesson, {**worked_answers(lesson), **kept}, orderless) for orderless in ((), names))

    def agrees(traces, k, number):
        return all(mistakes.all_same(traces[k][test], mistakes.stored(right))
                   for test, right in traces[number].items())
    return {number for k, (number, _) in kept.items()
            if agrees(sorted_out, k, number) and not agrees(as_is, k, number)}


def kinds_in(lesson):
    """{exercise: the kind of thing that its worked answer returns}; an empty text where it returns several kinds."""
    kinds = {number: set() for number in names_in(lesson)}

    def noting(number, function):
        def noted(*arguments):
            result = function(*arguments)
            kinds[number].add(mistakes.kind(result))
            return result
        return number, noted
    traces_of(lesson, {number: noting(*answer) for number, answer in worked_answers(lesson).items()})
    return {number: some.pop() if len(some) == 1 else "" for number, some in kinds.items()}


def table_of(lesson):
    """The table of a lesson, as `mistakes.table` reads it."""
    orderless, kept = orderless_in(lesson), mutants_of(lesson)
    wrong = {k: (m.exercise, m.function) for k, m in enumerate(kept) if not m.right}
    traces = traces_of(lesson, {**worked_answers(lesson), **wrong}, orderless)
    table, kinds = {}, kinds_in(lesson)
    for number, name in names_in(lesson).items():
        right = {test: mistakes.stored(results) for test, results in traces[number].items()}
        table[number] = {"function": name, "orderless": number in orderless, "returns": kinds[number],
                         "right": right, "wrong": []}
    for k, (number, _) in wrong.items():
        right = table[number]["right"]
        tests = {test: mistakes.stored(results) for test, results in traces[k].items()
                 if not mistakes.all_same(results, right[test])}
        if tests:                                                    # the others return what a right answer returns
            table[number]["wrong"].append({"idea": kept[k].story, "tests": tests})
    return table


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
