"""`python -m validate.grading.example FOLDER`: make a class of five from the worked answers, and its class list.

ada has everything right (a zip).  bob forgets dt in Euler's method.  cem has not begun (a zip).  dia's second file does
not load.  eve's first file ends the program that imports it.  fay is on the list and hands nothing in.
"""

import os
import zipfile
from datetime import datetime
from pathlib import Path
from typing import Annotated

import typer

from solutions.checks import BadInput
from validate.run.command import start
from validate.subject import generate, modules

PEOPLE = """student_id,last_name,first_name,email
ada,Lovelace,Ada,ada@example.org
bob,Hooke,Bob,bob@example.org
cem,Yilmaz,Cem,cem@example.org
dia,Okafor,Dia,dia@example.org
eve,Novak,Eve,eve@example.org
fay,Tanaka,Fay,fay@example.org
"""
DATE = (2026, 11, 20, 12, 0, 0)


def worked(lesson):
    """Return the text of a lesson with every exercise answered, as a student would hand it in."""
    source = (modules.SOLUTIONS / f"{lesson}.py").read_text()
    return generate.stub(source, solved=generate.exercises(source))


def files():
    """Return {student: {lesson: text}}."""
    first, second, *_ = modules.lesson_names()
    stubs = {name: (modules.ROOT / "lessons" / f"{name}.py").read_text() for name in (first, second)}
    right = {name: worked(name) for name in (first, second)}
    wrong = right[first].replace("v + dt * acceleration(t, x, v, p)\n", "v + acceleration(t, x, v, p)\n", 1)
    return {
        "ada": right,
        "bob": {first: wrong, second: stubs[second]},
        "cem": stubs,
        "dia": {first: right[first], second: right[second] + "\n)(\n"},
        "eve": {first: "import os\n\nos._exit(0)\n"},
    }


def make(folder):
    """Write the class into a new folder.  Raises BadInput when there is something already."""
    folder = Path(folder)
    if folder.exists():
        raise BadInput(f"folder {str(folder)!r}", "there already", "name one that is not")
    folder.mkdir(parents=True)
    for student, lessons in files().items():
        if student in ("ada", "cem"):
            with zipfile.ZipFile(folder / f"{student}.zip", "w") as archive:
                for lesson, text in lessons.items():
                    archive.writestr(zipfile.ZipInfo(f"workbook/lessons/{lesson}.py", DATE), text)
        else:
            (folder / student / "lessons").mkdir(parents=True)
            for lesson, text in lessons.items():
                (folder / student / "lessons" / f"{lesson}.py").write_text(text)
    (folder / "list.csv").write_text(PEOPLE)
    handed_in = datetime(*DATE).timestamp()
    for path in folder.rglob("*"):
        os.utime(path, (handed_in, handed_in))           # before the deadline in docs/grading.md, whenever this runs
    return folder


def main(folder: Annotated[Path, typer.Argument(help="A new folder.")]):
    """Write a class of five submissions, and its list, into a new folder."""
    print(f"a class of five, and its list, in {make(folder)}")


if __name__ == "__main__":
    start("python -m validate.grading.example", main)
