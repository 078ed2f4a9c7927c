"""What a run keeps on disk, and how: results whole or not at all, each report by one code and one plan."""

import json
import sys
from contextlib import contextmanager
from importlib.metadata import version

from solutions.checks import BadInput

from . import binding, engines

SUBSET = "subset"            # folder inside a report's for the report of some scenes that does not fit into it


@contextmanager
def whole(path):
    """The path of a draft to write, which takes the place of `path` when the block ends well.  Raises BadInput where it cannot be written."""
    draft = path.with_name(f".{path.name}.part")
    try:
        yield draft
        draft.replace(path)
    except OSError as e:
        raise BadInput(f"file {str(path)!r}", f"not writable ({e.strerror or e})", "make room there; what was finished is kept") from None
    finally:
        draft.unlink(missing_ok=True)


def write_whole(path, value):
    """Write JSON so that a reader never sees half of it."""
    with whole(path) as draft:
        draft.write_bytes(json.dumps(value, ensure_ascii=False, allow_nan=False).encode())


def read_whole(path, kind, remedy):
    """What a JSON file holds, a dict or a list.  Raises BadInput for a file that was damaged."""
    try:
        value = json.loads(path.read_text(encoding="utf-8"))
    except ValueError as e:
        raise BadInput(f"file {str(path)!r}", f"no JSON ({e})", remedy) from None
    if not isinstance(value, kind):
        raise BadInput(f"file {str(path)!r}", f"not what was written there (no {kind.__name__})", remedy)
    return value


def code_digest(of):
    """Fingerprint of all that a result depends on: code, recorded traces, and what is installed."""
    package = binding.ROOT / "validate"
    files = {*package.rglob("*.py"), *package.glob("recorded/*.json"), *binding.SOLUTIONS.glob("*.py"), *binding.subject_folder(of).glob("*.py")}
    installed = [sys.version, version("numpy"), version("scipy"), binding._numba_version(), *map(engines.installed, engines.NAMES)]
    return binding.fingerprint(files, " ".join(map(str, installed)))


def store_for(out, plan, names):
    """Where a run keeps its results: in `out`, unless there are results of other scenes by other code or another plan.  Those stay, and the run goes into SUBSET."""
    stamp = {"plan": list(map(str, plan)), "code": code_digest(plan.of)}
    store = Store(out)
    if store.state["stamp"] != stamp and set(store.scenes()) - set(names):
        store = Store(out / SUBSET)
    store.begin(stamp, names)
    return store


class Store:
    """Results, a file each, all by one code and one plan.  An interrupted run is continued; what a finished one measured is measured anew.

    `state` is kept beside them: the stamp of code and plan; the scenes that runs began and have not finished; what of those is still to be measured
    (an older result by the same code and plan stays until then); and the files of the report.
    """

    def __init__(self, out):
        self.out, self.folder = out, out / "results"
        self.mark = self.folder / "run.json"
        self.state = {"stamp": None, "begun": [], "todo": [], "pages": []} | (self.read(self.mark) if self.mark.is_file() else {})

    def begin(self, stamp, names):
        self.folder.mkdir(parents=True, exist_ok=True)
        self.tidy()
        if self.state["stamp"] != stamp:
            for old in self.folder.glob("*.*.json"):
                old.unlink()
            self.note(stamp=stamp, begun=[], todo=[])
        fresh = [n for n in names if n not in self.state["begun"]]
        todo = {*self.state["todo"], *(f"{n}.{kind}" for n in fresh for kind in ("errors", "times")), *(f"{n}.stability" for n in lessons_of(fresh))}
        self.note(begun=self.state["begun"] + fresh, todo=sorted(todo))

    def note(self, **changes):
        self.state |= changes
        write_whole(self.mark, self.state)

    def path(self, kind, name):
        return self.folder / f"{name}.{kind}.json"

    def has(self, kind, name):
        return f"{name}.{kind}" not in self.state["todo"] and self.path(kind, name).is_file()

    def get(self, kind, name):
        return self.read(self.path(kind, name), list if kind == "stability" else dict)

    def read(self, path, kind=dict):
        return read_whole(path, kind, "remove it, and give the same command again")

    def put(self, kind, name, value):
        write_whole(self.path(kind, name), value)
        self.note(todo=[key for key in self.state["todo"] if key != f"{name}.{kind}"])

    def scenes(self):
        """The scenes of which everything is there, from this run or an earlier one."""
        return [n for n in binding.scene_names() if self.path("errors", n).is_file() and self.path("times", n).is_file()]

    def results(self, names):
        return [{**self.get("errors", name), "times": self.get("times", name)} for name in names]

    def stability(self, names):
        return [case for lesson in lessons_of(names) if self.path("stability", lesson).is_file() for case in self.get("stability", lesson)]

    def measured(self, name):
        """When a scene's or a lesson's results were written [ns]."""
        return max(path.stat().st_mtime_ns for path in self.folder.glob(f"{name}.*.json"))

    def tidy(self):
        """Remove drafts that nobody finishes any more."""
        for draft in [*self.out.glob(".*.part"), *self.folder.glob(".*.part")]:
            draft.unlink()

    def finish(self, names, pages):
        """The report is written: remove what belonged to the last one only."""
        for old in {*self.state["pages"]} - {*pages}:
            (self.out / old).unlink(missing_ok=True)
        self.note(begun=[n for n in self.state["begun"] if n not in names], pages=sorted(pages))


def lessons_of(names):
    """The lessons of these scenes, in the order of the course."""
    there = {binding.bind_scene(name).LESSON for name in names}
    return [lesson for lesson in binding.lesson_names() if lesson in there]
