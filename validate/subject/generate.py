"""Generation of lessons/ from solutions/, the same modules without answers, and of needs.json, the calls in them.

`python -m validate.subject.generate` writes them.  `--check` only says whether they are what it would write, and
`--force` overwrites answers in lessons/, too.
"""

import json
import re
import sys
from pathlib import Path

from solutions.checks import BadInput

from . import needs
from .modules import ROOT, SOLUTIONS, lesson_names

LESSONS = ROOT / "lessons"
ANSWER = re.compile(r"^(?P<indent> *)### BEGIN SOLUTION (?P<exercise>\d+\.\d+)\n"
                    r".*?^ *### END SOLUTION *\n", re.M | re.S)
FUNCTION = re.compile(r"^def (\w+)", re.M)


def stub(source, solved=(), elsewhere=None):
    """Return the text of a lesson with every answer but the solved ones replaced by a NotImplementedError.

    The error names exercise and function.  The text imports the siblings named in `elsewhere` from solutions, and the
    others from beside it; without `elsewhere`, all from solutions.
    """
    def empty(match):
        function = FUNCTION.findall(source, 0, match.start())[-1]
        indent, exercise = match["indent"], match["exercise"]
        if exercise in solved:
            return "".join(match[0].splitlines(keepends=True)[1:-1])
        return f'{indent}# YOUR CODE HERE\n{indent}raise NotImplementedError("Exercise {exercise}: {function}")\n'

    text = ANSWER.sub(empty, source)
    if re.search(r"(BEGIN|END) SOLUTION", text):
        raise BadInput("a solution marker", "unpaired or without its exercise number",
                       "write ### BEGIN SOLUTION 1.2 … ### END SOLUTION")
    def from_where(m):
        given = elsewhere is None or m[1].partition(".")[0] in elsewhere
        return f"from solutions.{m[1]} import" if given else m[0]

    return re.sub(r"^from \.([\w.]+) import", from_where, text, flags=re.M)


def exercises(source):
    """Return {"1.2": "midpoint_step", …} in the order of the text."""
    return {m["exercise"]: FUNCTION.findall(source, 0, m.start())[-1] for m in ANSWER.finditer(source)}


def lessons():
    """Return {file name: text} of everything that belongs into lessons/."""
    texts = {f"{name}.py": stub((SOLUTIONS / f"{name}.py").read_text()) for name in lesson_names()}
    about = "Your copy of the lessons: each function waits for its body.  Start with notebooks/00_start_here.ipynb."
    return {"__init__.py": f'"""{about}"""\n', **texts}


def needs_text():
    """Return the text of needs.json."""
    rows = needs.read_from(SOLUTIONS, lesson_names(), exercises).items()
    lines = (f"{json.dumps(number)}: {json.dumps(one, ensure_ascii=False)}" for number, one in rows)
    return "{\n" + ",\n".join(lines) + "\n}\n"


def differing(folder=None):
    """Return names of the files that are not what the solutions would give, missing and superfluous ones included."""
    texts = lessons()
    there = {path.name: path.read_text() for path in Path(folder or LESSONS).glob("*.py")}
    return sorted(name for name in texts.keys() | there.keys() if texts.get(name) != there.get(name))


def worked_in(folder=None):
    """Return the files that hold an answer: an exercise's function is there, but no longer raises."""
    def answered(path):
        text, solution = path.read_text(), SOLUTIONS / path.name
        numbered = exercises(solution.read_text()).items() if solution.is_file() else ()
        return any(f"def {name}(" in text and f'"Exercise {number}: {name}"' not in text for number, name in numbered)
    return sorted(path.name for path in Path(folder or LESSONS).glob("*.py") if answered(path))


def main(arguments):
    if arguments == ["--help"]:
        print(__doc__)
        return 0
    if arguments not in ([], ["--check"], ["--force"]):
        print(f"{' '.join(arguments)} is not an option here: give --check, --force or nothing", file=sys.stderr)
        return 2
    changed, table = differing(), needs_text()
    other_needs = not needs.FILE.is_file() or needs.FILE.read_text(encoding="utf-8") != table
    if arguments == ["--check"]:
        named = ", ".join(changed + [needs.FILE.name] * other_needs)
        if named:
            print(f"lessons/ is not what solutions/ gives ({named}): run python -m validate.subject.generate",
                  file=sys.stderr)
        return 1 if named else 0
    answered = worked_in()
    if answered and arguments != ["--force"]:
        print(f"lessons/ holds answers ({', '.join(answered)}): move them away, or overwrite them with --force",
              file=sys.stderr)
        return 2
    if other_needs:
        needs.FILE.write_text(table, encoding="utf-8")
        print(needs.FILE.relative_to(ROOT))
    texts = lessons()
    for name in changed:
        if name in texts:
            (LESSONS / name).write_text(texts[name])
        else:
            (LESSONS / name).unlink()
        print(f"lessons/{name}")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
