"""Choice of the copy of the workbook if there are several in one environment.

An environment is installed from one copy.  A notebook belongs to the copy in whose folder `notebooks` it lies, and uses
that one.  A copy that stands on Python's path is used as it is.
"""

import importlib
import os
import sys
from pathlib import Path

PACKAGES = "lessons", "solutions", "tests", "validate"
ROOT = Path(__file__).resolve().parents[2]


def copy_around(place):
    """Return the copy of the workbook in which a folder lies; None if it lies in none."""
    whole = lambda folder: all((folder / name / "__init__.py").is_file() for name in PACKAGES)
    place = Path(place).resolve()
    return next(filter(whole, (place, *place.parents)), None)


def meant_here(of):
    """Return the folder that a command means by `lessons` if it is not that of this copy.

    It is that of the copy around the working folder.  Every other name is returned unchanged.
    """
    around = copy_around(Path.cwd())
    return str(around / "lessons") if of == "lessons" and around not in (None, ROOT) else of


def doubtful(folder):
    """Return the folder of some lessons if it may be mistaken for another one, else "".

    Such lessons are not those of the copy around the working folder, and no option or variable names them.
    """
    around = copy_around(Path.cwd())
    own = around and around == ROOT and Path(folder).resolve() == ROOT / "lessons"
    return "" if own or os.environ.get("WORKBOOK_LESSONS") else str(folder)


def use_the_one_of_this_notebook():
    """Import `validate` again, from the copy of the workbook whose folder of notebooks is the working folder."""
    here = Path.cwd()
    other = copy_around(here)
    if here.name != "notebooks" or other is None or other in (ROOT, here):
        return
    if ROOT not in [Path(place).resolve() for place in sys.path]:
        sys.path.insert(0, str(other))
        for name in [name for name in sys.modules if name.partition(".")[0] in PACKAGES]:
            del sys.modules[name]
        importlib.import_module("validate")
