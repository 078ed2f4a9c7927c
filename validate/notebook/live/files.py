"""The learner's lessons as saved last, and the sentence about an error in it."""

import traceback
from pathlib import Path

from solutions.checks import BadInput, Diverged

from ...subject import loading, modules
from ...subject.loading import TooLong

HERE, ALARM = Path(__file__).parent, loading.__file__


class Followed:
    """The learner's lessons, bound by the name of their folder, so that a save can be seen."""

    def __init__(self, folder):
        self.folder, self.stamp = Path(folder), None

    def changed(self):
        """Return whether a file was saved since `load`."""
        return self.stamp != self._now()

    def load(self, lesson):
        """Return a lesson as saved now.  A file that cannot be loaded is tried again when it is saved."""
        self.stamp = self._now()
        return modules.bind(lesson, self.folder)

    def _now(self):
        found = []
        for file in sorted(self.folder.glob("*.py")):
            try:
                about = file.stat()
            except OSError:                        # an editor that replaces it
                continue
            found.append((file.name, about.st_mtime_ns, about.st_size))
        return tuple(found)


def sentence(error, folder):
    """Return what a learner reads about an error: one sentence with file, line and function."""
    if isinstance(error, NotImplementedError):
        return f"○ Not attempted yet: {str(error).removeprefix('Exercise ')}."
    if isinstance(error, (BadInput, Diverged)):
        return f"✗ {ended(error)}"
    what = "a step is " if isinstance(error, TooLong) else f"{type(error).__name__}: "
    return f"✗ {what}{ended(error).rstrip('.')}{place_of(error, Path(folder))}."


def ended(error):
    """Return what an error says, in one line; a class of the learner's own may fail at that, too."""
    try:
        words = " ".join(str(error).split())
    except Exception:
        words = ""
    return words or "it gives no reason"


def place_of(error, folder):
    """Return " (simulator.py, line 12, in contact_step_2d)": the innermost line of the learner's files, or of ours.

    An error that the simulation itself has found is of no line.
    """
    frames = [frame for frame in traceback.extract_tb(error.__traceback__) if frame.filename != ALARM]
    own = [frame for frame in frames if Path(frame.filename).parent == folder.resolve()] or frames[-1:]
    if not own or Path(own[-1].filename).parent == HERE:
        return ""
    return f" ({Path(own[-1].filename).name}, line {own[-1].lineno}, in {own[-1].name})"
