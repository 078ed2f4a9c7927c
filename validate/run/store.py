"""The files of a run: results that are written whole or not at all, and one code and one plan for each report."""

import json
import sys
import tempfile
from contextlib import contextmanager
from importlib.metadata import version

from solutions.checks import BadInput

from ..engines.products import PRODUCTS
from ..subject import modules

FORMAT = 3                   # of stored results: raise it when a report of before cannot be read any more
FULL_RUN = modules.ROOT / "validate" / "report" / "full_run.json"        # by `validate summary --keep`
SUBSET = "subset"            # folder, inside the report's, for scenes that cannot join that report


@contextmanager
def whole(path):
    """Yield a draft that replaces `path` when the block ends well.  Raises BadInput where it cannot be written."""
    draft = path.with_name(f".{path.name}.part")
    try:
        yield draft
        draft.replace(path)
    except OSError as e:
        raise BadInput(f"file {str(path)!r}", f"not writable ({e.strerror or e})",
                       "make room there; finished results are kept") from None
    finally:
        draft.unlink(missing_ok=True)


def write_whole(path, value):
    """Write JSON so that a reader never sees half of it."""
    write_text(path, json.dumps(value, ensure_ascii=False, allow_nan=False))


def write_text(path, text):
    """Write a text so that a reader never sees half of it."""
    with whole(path) as draft:
        draft.write_bytes(text.encode())


def read_whole(path, kind, remedy):
    """Read a dict or a list from a JSON file.  Raises BadInput for a damaged file."""
    try:
        value = json.loads(path.read_text(encoding="utf-8"))
    except ValueError as e:
        raise BadInput(f"file {str(path)!r}", f"no JSON ({e})", remedy) from None
    if not isinstance(value, kind):
        raise BadInput(f"file {str(path)!r}", f"not what was written there (no {kind.__name__})", remedy)
    return value


def code_digest(of):
    """Return a fingerprint of everything that a result depends on: code, recorded traces and installed versions."""
    return modules.fingerprint(sources(of), f"{sys.version} {installed_versions()}")


def sources(of):
    """Return the files on which a result depends."""
    package, subject = modules.ROOT / "validate", modules.subject_folder(of)
    return {*package.rglob("*.py"), *package.glob("recorded/*.json"),
            *subject.rglob("*.py"), *modules.SOLUTIONS.rglob("*.py")}


def installed_versions():
    """Return {package: its version or None} of those on which a result depends."""
    return {"numpy": version("numpy"), "scipy": version("scipy"), "numba": modules.numba_version(),
            **{product.name: product.installed() for product in PRODUCTS}}


def store_for(out, plan, names):
    """Begin a run of these scenes in `out`, or in out/SUBSET.

    It is the latter if `out` holds results of other scenes that were measured with other code or another plan.
    """
    stamp = {"plan": list(map(str, plan)), "code": code_digest(plan.of)}
    store = Store(out)
    if store.state["stamp"] != stamp and set(store.scenes()) - set(names):
        store = Store(out / SUBSET)
    store.begin(stamp, names)
    return store


def lessons_of(names):
    """Return the lessons of these scenes, in the order of the course."""
    there = {modules.bind_scene(name).lesson for name in names}
    return [lesson for lesson in modules.lesson_names() if lesson in there]


class Store:
    """Results, one file each, that the same code and the same plan made.

    A run continues what an interrupted run began, and measures anew what a finished run measured.  `state` holds
    stamp: the code and the plan;    begun: scenes of runs that were interrupted;
    todo: their results that are not measured yet (an older result stays until then);    pages: files of the report.
    """

    def __init__(self, out):
        self.out, self.folder = out, out / "results"
        self.mark = self.folder / "run.json"
        self.state = {"stamp": None, "begun": [], "todo": [], "pages": []}
        if self.mark.is_file():
            self.state |= self.read(self.mark)

    def begin(self, stamp, names):
        self.folder.mkdir(parents=True, exist_ok=True)
        for draft in [*self.out.glob(".*.part"), *self.folder.glob(".*.part")]:      # of workers that were killed
            draft.unlink()
        if self.state["stamp"] != stamp:
            for old in self.folder.glob("*.*.json"):
                old.unlink()
            self.note(stamp=stamp, begun=[], todo=[])
        fresh = [name for name in names if name not in self.state["begun"]]
        todo = {f"{name}.{kind}" for name in fresh for kind in ("errors", "times")}
        todo |= {f"{lesson}.stability" for lesson in lessons_of(fresh)}
        self.note(begun=self.state["begun"] + fresh, todo=sorted(todo.union(self.state["todo"])))

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
        """Return the scenes with all of their results, from this run or an earlier one."""
        return [n for n in modules.scene_names()
                if self.path("errors", n).is_file() and self.path("times", n).is_file()]

    def results(self, names):
        return [{**self.get("errors", name), "times": self.get("times", name)} for name in names]

    def stability(self, names):
        lessons = [lesson for lesson in lessons_of(names) if self.path("stability", lesson).is_file()]
        return [case for lesson in lessons for case in self.get("stability", lesson)]

    def measured(self, name):
        """Return the time at which the results of a scene or a lesson were written [ns]."""
        return max(path.stat().st_mtime_ns for path in self.folder.glob(f"{name}.*.json"))

    def finish(self, names, pages):
        """Note that these scenes are done, and remove files that belonged to the last report only."""
        for old in set(self.state["pages"]) - set(pages):
            (self.out / old).unlink(missing_ok=True)
        self.note(begun=[name for name in self.state["begun"] if name not in names], pages=sorted(pages))


def stored_report(folder):
    """Return the content of a report's report.json, of any version.  Raises BadInput for a folder that is none."""
    try:
        report = json.loads((folder / "report.json").read_text(encoding="utf-8"))
        return {"run": dict(report["run"]), "scenes": report["scenes"], "stability": report["stability"]}
    except (OSError, ValueError, KeyError, TypeError):
        raise BadInput(f"folder {str(folder)!r}", "not a report", "name the folder that `validate` wrote") from None


def report_of_this_version(folder):
    """Return the same.  Raises BadInput for a report whose results are stored in another form than today's."""
    report = stored_report(folder)
    if report["run"].get("format") != FORMAT:
        raise BadInput(f"report {str(folder)!r}", "of another version of the workbook", "make it again")
    return report


def full_run():
    """Return what is kept of the last full run, which a quick report shows beside its own; None where nothing is."""
    return read_whole(FULL_RUN, dict, "remove it, or give: validate summary --keep") if FULL_RUN.is_file() else None


def writable(out, option="--out"):
    """Return the output folder, made if need be.  Raises BadInput when nothing can be written there."""
    try:
        out.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=out):
            pass
    except OSError as e:
        raise BadInput(f"output folder {str(out)!r}", f"not writable ({e.strerror})",
                       f"name another with {option}") from None
    return out
