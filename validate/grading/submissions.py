"""Submissions of students: a folder, a zip or bare lesson files each.

Nothing is unpacked, followed or executed; only the lesson files' bytes are read.  What lies in the class folder
becomes a submission or a sentence: nothing is overlooked in silence.  A zip is read in a child of little memory and
time, and only what is stored or deflated: other ways of packing take gigabytes for a kilobyte.
"""

import hashlib
import json
import os
import re
import stat
import zipfile
from datetime import datetime
from pathlib import Path
from types import MappingProxyType
from typing import NamedTuple

from solutions.checks import BadInput
from validate.subject import generate, modules

from . import children, owners
from .classlist import spelt_out

LARGEST = 1 << 18            # of a lesson file [bytes]: ten times the worked one
LARGEST_NOTEBOOK = 1 << 25   # [bytes]: with its films
DEEPEST = 4                  # folders between the top and the file
MOST_ENTRIES = 5000          # of a zip or a folder [-]: more is not a submission
MOST_COPIES = 8              # of a lesson file that are looked at [-]
LARGEST_ZIP = 1 << 30        # [bytes]: with an environment in it
NOT_THEIRS = {"__MACOSX", "__pycache__", "node_modules", "site-packages", "venv", "env"}   # folders of programs
MOST_PROBLEMS = 20           # of a submission that are told [-]: a hostile zip has thousands
LONGEST = 200                # of a sentence about one [characters]: a name may have 65,535
ARCHIVES = (*".tar.gz .tar.bz2 .tar.xz .tar.zst .tar .tgz .tbz2 .txz .gz .bz2 .xz .zst .7z .rar".split(),)
BARE = (".py", ".py.txt", ".ipynb")                    # what one file of a student may be
NOTEBOOK = "{} is a notebook, and was not read: the answers belong into {}"
MARKS = "marks.csv"          # file of a class folder with points by hand


class Submission(NamedTuple):
    """One student's files, or those of students who share them."""
    student: str             # the student's id
    files: dict              # {lesson: bytes}; a lesson that is missing was not handed in
    problems: tuple          # sentences about what could not be read
    # when it was handed in: ISO 8601, from the date of the zip or of its newest lesson file; "" if there is none
    timestamp: str

    def digest(self):
        """Return a text that changes when anything graded changes."""
        return hashlib.sha256(repr((sorted(self.files.items()), self.problems, self.timestamp)).encode()).hexdigest()


class Intake(NamedTuple):
    """What lies in the folder of a class."""
    submissions: list        # sorted by student
    unclear: dict            # {student: why it is open which files are meant}: neither points nor a zero until then
    overlooked: tuple        # sentences about files without an owner
    sharing: dict            # {student of a submission: all whose it is}, where it is several
    dated_by_files: bool     # and not by the system that the files come from

    def owners_of(self, student):
        """Return all owners of a submission."""
        return self.sharing.get(student, (student,))

    def students(self):
        """Return all students who submitted something that is read."""
        return [who for one in self.submissions for who in self.owners_of(one.student)]


class Thing(NamedTuple):
    """One entry of a class folder that has an owner."""
    path: Path
    ending: str              # of its name; "" for a folder
    name: owners.Name
    owners: owners.Owners


class Ungraded(Exception):
    """It is open what is to be graded: there are neither points nor a zero until that is mended."""


def read_all(folder, lessons, people=MappingProxyType({}), class_list=None):
    """Return the Intake of a folder.  people: the class list, class_list: its file.

    Raises BadInput without any.
    """
    folder = Path(folder)
    if not folder.is_dir():
        raise BadInput(f"submissions {str(folder)!r}", "not a folder",
                       "name the folder that holds one folder or zip per student")
    things, overlooked = owned(folder, people, class_list)
    if not things:
        own = [path.name for path in folder.glob("*.py") if path.stem in modules.lesson_names()]
        raise BadInput(f"submissions {str(folder)!r}", f"one student's own ({own[0]} lies in it)" if own else "empty",
                       "name the folder above it" if own else "put one folder or zip per student into it")
    found, unclear, sharing = [], undecided(things), {}
    with children.reader() as child:
        for students, theirs in teams(things, people):
            for student in students:
                unclear.pop(student, None)
            try:
                found.append(submission_of(students[0], theirs, lessons, child))
                sharing.update({students[0]: students} if len(students) > 1 else {})
            except Ungraded as e:
                unclear.update(dict.fromkeys(students, str(e)))
    return Intake(found, unclear, tuple(overlooked), sharing, not all(thing.name.when for thing in things))


# ---------------------------------------------------------------------------------------------- whose it is

def owned(folder, people, class_list):
    """Return (Things, sentences about files without an owner) of a class folder, hidden files left out."""
    things, overlooked, ours = [], [], class_list and Path(class_list).resolve()
    known, metadata = owners.People(people), owners.from_gradescope(folder)
    for path in sorted(folder.iterdir()):
        if path.name.startswith(".") or path.name == "__MACOSX" or path.resolve() == ours:
            continue
        if path.is_file() and path.name in (MARKS, owners.METADATA if metadata else MARKS):
            continue
        stem, ending = split(path)
        name = owners.name_of(stem, ending in BARE, metadata)
        student, lesson = owners.of_lesson(stem) if ending in BARE and name.own == stem else ("", None)
        if lesson and not student:
            overlooked.append(f"{shortened(path.name)} is a lesson file without a student's name, and was not read")
        elif ending in (".zip", *BARE, *ARCHIVES) or (not ending and (path.is_symlink() or path.is_dir())):
            things.append(Thing(path, ending, name, known.owners(name)))
        elif theirs := next((ids for ids in map(known.fitting, (path.name, stem)) if len(ids) == 1), ()):
            things.append(Thing(path, ending, name, owners.Owners((*theirs,), False)))
        else:
            hint = f"; if it is the class list, give --roster {path}" if path.suffix == ".csv" else ""
            overlooked.append(f"{shortened(path.name)} is no submission, and was not read{hint}")
    record = f"{owners.METADATA} is Gradescope's record of who handed in what, and was followed"
    return things, [record] * bool(metadata) + overlooked


def split(path):
    """Return (name without its ending, ending in small letters); a folder has none, unless it is called a zip."""
    name = path.name.lower()
    ending = next((e for e in (".zip", ".py.txt", *ARCHIVES) if name.endswith(e)), path.suffix.lower())
    if ending != ".zip" and path.is_dir():                             # or a link to one
        ending = ""
    return (path.name[:-len(ending)] if ending else path.name), ending


def undecided(things):
    """Return {student: why it is open what is his} of those on the class list whose name others have, too."""
    why = {}
    for thing in things:
        for student in thing.owners.perhaps:
            others = ", ".join(sorted({*thing.owners.perhaps} - {student}))
            why[student] = (f"{shortened(thing.path.name)} may be of this student, or of {others}: rename it to the "
                            "student_id of one of them")
    return why


def teams(things, people):
    """Return [(ids that share a submission, their Things), …]: a group of the class list, or a joint submission."""
    groups, team = {}, {}
    for student, person in people.items():
        groups.setdefault(person.group or (student,), []).append(student)
    for together in (*groups.values(), *(thing.owners.students for thing in things)):
        merged = {*together}.union(*(team.get(student, ()) for student in together))
        team.update(dict.fromkeys(merged, merged))
    found = {}
    for thing in things:
        found.setdefault((*sorted(team[thing.owners.students[0]]),), []).append(thing)
    return sorted(found.items())


# ---------------------------------------------------------------------------------------------- what counts

def submission_of(student, things, lessons, child):
    """Return a student's Submission from all that is there.

    What has the student's id for its name, or a number that the system gave, counts before what only resembles it:
    students may choose such names.  Raises Ungraded where what counts contradicts itself.
    """
    found, problems, barred = {}, [], {}
    for thing in things:
        try:
            found[thing] = delivered(thing, student, lessons, child)
            which = f"{shortened(thing.path.name)}: " if len(things) > 1 else ""
            problems += [which * problem.startswith("it ") + problem for problem in found[thing].problems]
        except Ungraded as e:
            barred[thing] = str(e)
    holding = [thing for thing in things if thing in barred or found[thing].files]
    counting = [thing for thing in holding if thing.owners.certain] or holding
    if stopping := [barred[thing] for thing in counting if thing in barred]:
        raise Ungraded(stopping[0])
    files, dates = {}, {}
    for thing in counting:
        for lesson, text in found[thing].files.items():
            if files.setdefault(lesson, text) != text:
                names = ", ".join(shortened(one.path.name) for one in counting)
                raise Ungraded(f"there more than once, with different contents, as {names}: keep one of them")
            dates.setdefault(lesson, []).append(found[thing].timestamp)
    for thing in holding:
        if thing in barred or {*found[thing].files.items()} - {*files.items()}:
            counts = counting[0].path.name
            problems.append(shortened(f"{thing.path.name} is there, too, and was not graded: {counts} counts"))
    newest = max((min(filter(None, when), default="") for when in dates.values()), default="")
    return Submission(student, files, tuple(problems), newest)


def delivered(thing, student, lessons, child):
    """Return the Submission of one thing."""
    if thing.ending == ".py":
        one = from_bare(thing, student, lessons)
    elif thing.ending in ("", ".zip") and (thing.ending or thing.path.is_symlink() or thing.path.is_dir()):
        one = read(thing.path, student, lessons, child)
    else:
        one = Submission(student, {}, (shortened(why_unread(thing)),), "")
    return one._replace(timestamp=thing.name.when or one.timestamp)


def why_unread(thing):
    name, lesson = thing.path.name, owners.of_lesson(thing.name.own)[1]
    if thing.ending == ".ipynb":
        return NOTEBOOK.format(name, f"lessons/{lesson}.py" if lesson else "the lesson files")
    if thing.ending == ".py.txt":
        return f"{name} is called a text, and was not read: rename it to {name[:-len('.txt')]}"
    remedy = "unpack it into a folder, or ask for a zip" if thing.ending in ARCHIVES else "ask for the lesson files"
    return f"{name} is neither a folder nor a zip, and was not read: {remedy}"


def from_bare(thing, student, lessons):
    """Return the Submission of a bare file, whose name says the lesson unless there is only one."""
    files, problems, path, when = {}, [], thing.path, 0.0
    lesson = owners.of_lesson(thing.name.own)[1] or (lessons[0] if len(lessons) == 1 else None)
    if lesson in lessons:
        when = take(files, lesson, path, path.name, problems)
    elif lesson:
        problems.append(f"{path.name} is of the lesson {lesson}, which is not graded here")
    else:
        example = f"{path.stem}_{lessons[0]}.py"
        problems.append(f"{path.name} may be of any lesson, and was not read: rename it, to {example} for instance")
    return Submission(student, files, told(problems), moment(when))


def read(path, student, lessons, child):
    """Read one folder or zip; a fault in it becomes a sentence, not an error.  child: one of `children.reader`.

    A folder without lesson files may hold a single zip, which is read in its place.  Raises Ungraded where there is too
    much of it.
    """
    if path.is_symlink():
        return Submission(student, {}, ("it is a link to somewhere else, which is not followed",), "")
    try:
        if path.is_file():
            found = child(children.timed, contents, from_zip, path, lessons, patience=children.PATIENCE)
        else:
            found = contents(from_folder, path, lessons)
    except Ungraded:
        raise
    except Exception as e:  # BadZipFile, MemoryError, zlib.error, struct.error …
        return Submission(student, {}, (f"it cannot be read: {type(e).__name__}",), "")
    files, problems, when, notebooks = found
    if not files and (zipped := only_zip(path)):
        return read(zipped, student, lessons, child)
    asked = {place: unanswered(lesson, files.get(lesson, b"")) for lesson, place in notebooks.items()}
    cells = in_child(child, path, asked) if any(asked.values()) else {}
    problems = [one for one in problems if not any(one.startswith(f"{place} is a notebook") for place in cells)]
    return Submission(student, files, (*problems, *cells.values()), moment(when))


def only_zip(path):
    """Return the zip in a folder that holds a single one, or None.  Moodle puts each upload into a folder."""
    files = [one for one in path.iterdir() if not one.is_dir()] if path.is_dir() else []
    found = [one for one in files if one.suffix.lower() == ".zip"]
    return found[0] if len(found) == 1 else None


def contents(find, path, lessons):
    """Return the content of a submission: files, first problems in readable form, date, and {lesson: its notebook}."""
    files, problems, when, names = find(path, lessons)
    notebooks = {}
    for name in sorted(names, key=lambda name: (name.count("/"), name)):
        lesson = re.fullmatch(r"(?:\d\d_)?(.*?)\.ipynb", os.path.basename(name), re.DOTALL)
        if lesson and (found := owners.of_lesson(lesson[1])[1]) in lessons:
            notebooks.setdefault(found, name)
    return files, told(problems), when, notebooks


def told(problems):
    """Return the first problems, fit to be shown."""
    more = [f"and {len(problems) - MOST_PROBLEMS} more of the kind"] * (len(problems) > MOST_PROBLEMS)
    return (*map(shortened, problems[:MOST_PROBLEMS]), *more)


def shortened(text):
    """Return a name or a sentence with one in it, fit to be shown."""
    return spelt_out(text[:LONGEST]) + " …" * (len(text) > LONGEST)


def moment(when):
    """Return a file's date as text; "" where there is none, or one that no calendar has."""
    try:
        return datetime.fromtimestamp(when).isoformat(timespec="seconds") if when else ""
    except (OSError, ValueError, OverflowError):
        return ""


def nearest(candidates, problems):
    """Return, of {lesson: places}, the places nearest to the top for each lesson; its own name takes precedence."""
    chosen = {}
    for lesson, places in candidates.items():
        named = [place for place in places if os.path.basename(place) == f"{lesson}.py"]
        first, *others = sorted(named or places, key=lambda place: (place.count("/"), place))
        also = [place for place in others if place.count("/") == first.count("/")]
        if also and not named:
            told = f"either {first} or {also[0]} may be {lesson}.py, and neither was read"
            problems.append(f"{told}: keep one, and call it {lesson}.py")
            continue
        if not named:
            problems.append(f"{first} was taken for {lesson}.py")
        elif len(named) < len(places):
            left = next(place for place in places if place not in named)
            problems.append(f"{left} was not read: {first} counts")
        chosen[lesson] = [first, *also][:MOST_COPIES]
    return chosen


def fullest(lesson, texts, problems):
    """Return the place of {place: text} with the most answers.  Raises Ungraded where two different texts have them."""
    left = {place: len(unanswered(lesson, text)) for place, text in texts.items()}
    best = [place for place in texts if left[place] == min(left.values())]
    if len({texts[place] for place in best}) > 1:
        raise Ungraded(f"{lesson}.py is there more than once, with different contents, as {shortened(best[0])} and "
                       f"{shortened(best[1])}: keep one of them")
    if len({*texts.values()}) > 1:
        problems.append(f"{lesson}.py is there more than once; {best[0]} was taken, which has the most answers")
    return best[0]


def wanted(name, lessons):
    """Return the lesson whose file this path may be, or None."""
    parts = name.split("/")
    plain = not any(part in ("", ".", "..") or skipped(part) for part in parts) and len(parts) <= DEEPEST + 1
    lesson = owners.of_lesson(parts[-1][:-len(".py")]) if plain and parts[-1].lower().endswith(".py") else ("", None)
    return lesson[1] if not lesson[0] and lesson[1] in lessons else None


def skipped(part):
    """Return whether a part of a path hides what is below: nothing there was written by a student."""
    return part.startswith(".") or part in NOT_THEIRS


def resembling(names, lessons, found):
    """Return sentences about files that may be meant for missing lessons: another spelling, an archive inside."""
    for lesson in (lesson for lesson in lessons if lesson not in found):
        alike = [name for name in names if lesson in (base := os.path.basename(name).lower())
                 and base.endswith((".py", ".pyw", ".txt", ".ipynb")) and not base.startswith("test_")]
        for name in sorted(alike, key=lambda name: name.lower().endswith(".ipynb"))[:1]:
            yield (NOTEBOOK.format(name, f"lessons/{lesson}.py") if name.lower().endswith(".ipynb") else
                   f"{lesson}.py is not there, and {name} was not read: if it is meant, call it {lesson}.py")
    if any(lesson not in found for lesson in lessons):
        packed = [name for name in names if name.lower().endswith((".zip", *ARCHIVES))]
        remedy = "a folder holds lesson files or a single zip, and a zip holds lesson files"
        yield from [f"{name} lies inside, and was not read: {remedy}" for name in packed]


def of_few(entries):
    """Raise Ungraded where there are more entries than a submission has."""
    if entries > MOST_ENTRIES:
        raise Ungraded(f"more than {MOST_ENTRIES} files, of which none was read: ask for the lesson files alone")


def from_folder(top, lessons):
    problems, candidates, when, names, entries = [], {}, 0.0, [], 0
    for here, folders, files in os.walk(top, followlinks=False):
        folders[:] = sorted(f for f in folders if not skipped(f))
        inside = Path(here).relative_to(top)
        if len(inside.parts) >= DEEPEST:
            folders.clear()
        names += [(inside / name).as_posix() for name in files if not skipped(name)]
        entries += len(folders)
        of_few(len(names) + entries)
    for name in names:
        if lesson := wanted(name, lessons):
            candidates.setdefault(lesson, []).append(name)
    files = {}
    for lesson, places in nearest(candidates, problems).items():
        found, dates = {}, {}
        for place in places:
            dates[place] = take(found, place, top / place, place, problems)
        if found:
            best = fullest(lesson, found, problems)
            files[lesson], when = found[best], max(when, dates[best])
    return files, [*problems, *resembling(names, lessons, candidates)], when, names


def take(files, key, path, name, problems):
    """Read a lesson's file into files[key], if it is a regular one; its date."""
    try:
        with regular(path) as file:
            keep(files, key, name, file.read(LARGEST + 1), problems)
            return os.fstat(file.fileno()).st_mtime
    except OSError:
        problems.append(f"{name} is not a regular file, and was not read")
        return 0.0


def regular(path):
    """Open a file of a student's folder.  Raises OSError for links, pipes and devices."""
    descriptor = os.open(path, os.O_RDONLY | getattr(os, "O_NOFOLLOW", 0) | getattr(os, "O_NONBLOCK", 0))
    file = os.fdopen(descriptor, "rb")
    if stat.S_ISREG(os.fstat(descriptor).st_mode):
        return file
    file.close()
    raise OSError("not a regular file")


def from_zip(path, lessons):
    """Decompress only the wanted entries, and of each at most the largest allowed size of a lesson file."""
    problems, candidates, files = [], {}, {}
    if path.stat().st_size > LARGEST_ZIP:
        raise Ungraded(f"larger than {LARGEST_ZIP >> 20} MiB, and was not read: ask for the lesson files alone")
    with zipfile.ZipFile(path) as archive:
        by_name = entries_of(archive)
        names = [name for name in by_name if not any(map(skipped, name.split("/")))]
        of_few(len(names))
        for name in names:
            if lesson := wanted(name, lessons):
                if wrong := unfit(by_name[name]):
                    problems.append(f"{name} {wrong}, and was not read")
                else:
                    candidates.setdefault(lesson, []).append(name)
        for lesson, places in nearest(candidates, problems).items():
            found = {}
            for place in places:
                try:
                    with archive.open(by_name[place]) as file:
                        keep(found, place, place, file.read(LARGEST + 1), problems)
                except Exception as e:  # encrypted, broken, packed in a way that Python does not know
                    problems.append(f"{place} cannot be read: {type(e).__name__}")
            if found:
                files[lesson] = found[fullest(lesson, found, problems)]
        problems += resembling(names, lessons, {wanted(name, lessons) for name in names} - {None})
    return files, problems, path.stat().st_mtime, names


def entries_of(archive):
    return {entry.filename.replace("\\", "/"): entry for entry in archive.infolist()}


def unfit(entry):
    """Return the reason why an entry of a zip is not read, or ""."""
    if "\0" in entry.orig_filename:
        return "has a name that goes on behind a NUL"
    if stat.S_ISLNK(entry.external_attr >> 16):
        return "is a link"
    if entry.compress_type not in (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED):
        packed = zipfile.compressor_names.get(entry.compress_type, f"method {entry.compress_type}")
        return f"is packed by {packed} and not by deflate, as an ordinary zip is"
    return ""


def keep(files, key, place, text, problems):
    lines = text.removeprefix(b"\xef\xbb\xbf").splitlines()
    if len(text) > LARGEST:
        problems.append(f"{place} is larger than {LARGEST // 1024} KiB, and was not read")
    elif all(line.strip().startswith(b"#") or not line.strip() for line in lines):
        problems.append(f"{place} is empty, so it is not graded: was it saved before it was handed in?")
    else:
        files[key] = text


# ---------------------------------------------------------------------------------------------- answers in notebooks

def unanswered(lesson, text):
    """Return the functions of a lesson that its file leaves out, or as they were handed out."""
    functions = generate.exercises((modules.SOLUTIONS / f"{lesson}.py").read_text()).values()
    left = {name.decode() for name in re.findall(rb'NotImplementedError\("Exercise [\d.]+: (\w+)"\)', text)}
    return [name for name in functions if name in left or not re.search(rb"(?m)^def %s\b" % name.encode(), text)]


def in_child(child, path, asked):
    """Return the result of `in_cells`, from a child.

    Nothing if the notebooks cannot be read, because they are not graded.
    """
    try:
        return child(children.timed, in_cells, path, asked, patience=children.PATIENCE)
    except Exception:
        return {}


def in_cells(path, asked):
    """Return {notebook: sentence} of {notebook: functions} whose cells contain answers, which are not graded."""
    told = {}
    for place, functions in asked.items():
        if path.is_file():
            with zipfile.ZipFile(path) as archive, archive.open(entries_of(archive)[place]) as file:
                data = file.read(LARGEST_NOTEBOOK)
        else:
            with regular(path / place) as file:
                data = file.read(LARGEST_NOTEBOOK)
        cells = [cell["source"] for cell in json.loads(data)["cells"] if cell["cell_type"] == "code"]
        text = "\n".join("".join(source) for source in cells)
        found = [name for name in functions if re.search(rf"(?m)^def {name}\b", text)]
        lesson = owners.of_lesson(re.sub(r"^\d\d_|\.ipynb$", "", os.path.basename(place)))[1]
        if found:
            told[place] = shortened(f"answers in the cells of {place} are not graded: move them into "
                                    f"lessons/{lesson}.py ({', '.join(found)})")
    return told
