"""What students handed in: a folder, a zip or bare lesson files each.

Nothing is unpacked, followed or executed; only the lesson files' bytes are read.  Whatever lies in the class folder
becomes a submission or a sentence: nothing is overlooked in silence.  A zip is read in a child of little memory and
time, and only what is stored or deflated: other ways of packing take gigabytes for a kilobyte.
"""

import csv
import hashlib
import os
import re
import stat
import unicodedata
import zipfile
from datetime import datetime
from pathlib import Path
from typing import NamedTuple

from solutions.checks import BadInput
from validate import modules

from . import children

LARGEST = 1 << 18            # of a lesson file [bytes]: ten times the worked one
DEEPEST = 4                  # folders between the top and the file
MOST_ENTRIES = 5000          # of a zip or a folder [-]: more is not a submission
LARGEST_ZIP = 1 << 25        # [bytes]: its list of entries is read before they can be counted
MOST_PROBLEMS = 20           # of a submission that are told [-]: a hostile zip has thousands
LONGEST = 200                # of a sentence about one [characters]: a name may have 65,535
ARCHIVES = (*".tar.gz .tar.bz2 .tar.xz .tar.zst .tar .tgz .tbz2 .txz .gz .bz2 .xz .zst .7z .rar".split(),)
OPENED = (".zip", ".py", ".ipynb")


class Submission(NamedTuple):
    """One student's files."""
    student: str             # name of the folder or zip: the student's id
    files: dict              # {lesson: bytes}; a lesson that is missing was not handed in
    problems: tuple          # sentences about what could not be read
    # when it was handed in: ISO 8601, from the date of the zip or of its newest lesson file; "" if there is none
    timestamp: str

    def digest(self):
        """Changes when anything changes that is graded."""
        return hashlib.sha256(repr((sorted(self.files.items()), self.problems, self.timestamp)).encode()).hexdigest()


class Intake(NamedTuple):
    """What lies in the folder of a class."""
    submissions: list        # sorted by student
    unclear: dict            # {student: why it is open which files are meant}: neither points nor a zero until then
    overlooked: tuple        # sentences about what is nobody's


def read_all(folder, lessons, people=(), class_list=None):
    """The Intake of a folder.  people: the ids on the class list, class_list: its file.

    Raises BadInput without any.
    """
    folder = Path(folder)
    if not folder.is_dir():
        raise BadInput(f"submissions {str(folder)!r}", "not a folder",
                       "name the folder that holds one folder or zip per student")
    theirs, overlooked = by_student(folder, people, class_list)
    if not theirs:
        own = [path.name for path in folder.glob("*.py") if path.stem in modules.lesson_names()]
        raise BadInput(f"submissions {str(folder)!r}", f"one student's own ({own[0]} lies in it)" if own else "empty",
                       "name the folder above it" if own else "put one folder or zip per student into it")
    found, unclear = [], {}
    with children.reader() as child:
        for student, paths in sorted(theirs.items()):
            try:
                found.append(submission_of(student, paths, lessons, child))
            except Ambiguous as e:
                unclear[student] = str(e)
    return Intake(found, unclear, tuple(overlooked))


class Ambiguous(Exception):
    """It is open which of a student's files are meant."""


def by_student(folder, people, class_list):
    """({student: [paths]}, sentences about what is nobody's) of everything in a class folder that is not hidden."""
    theirs, overlooked, ours = {}, [], class_list and Path(class_list).resolve()
    for path in sorted(folder.iterdir()):
        if path.name.startswith(".") or path.name == "__MACOSX" or path.resolve() == ours:
            continue
        student = owner(path, people)
        if student is None:
            why = "a lesson file without a student's name" if path.stem in modules.lesson_names() else "no submission"
            overlooked.append(f"{shortened(path.name)} is {why}, and was not read")
        else:
            theirs.setdefault(student, []).append(path)
    return theirs, overlooked


def owner(path, people):
    """The id of the student whom something in a class folder belongs to, or None."""
    stem, ending = split(path)
    if ending == ".py":
        student, lesson = of_lesson(stem)
        return None if lesson and not student else identity(student or stem)
    if ending in ("", ".zip", ".ipynb", *ARCHIVES):
        return identity(stem) if ending or path.is_symlink() or path.is_dir() or identity(stem) in people else None
    return next((name for name in map(identity, (path.name, stem)) if name in people), None)


def split(path):
    """(name without its ending, ending in small letters); a folder has none, unless it is called a zip."""
    name = path.name.lower()
    ending = next((e for e in (*OPENED, *ARCHIVES) if name.endswith(e)), path.suffix.lower())
    if ending != ".zip" and path.is_dir():                             # or a link to one
        ending = ""
    return (path.name[:-len(ending)] if ending else path.name), ending


def of_lesson(stem):
    """(student or "", lesson or None) of the name of a bare file: ada_springs is Ada's second lesson."""
    names = "|".join(modules.lesson_names())
    match = re.fullmatch(rf"(?:(.+?)[ _.-]+)?({names})", stem, re.DOTALL)
    return (match[1] or "", match[2]) if match else ("", None)


def identity(text):
    """A student's id as it is compared and shown: one for all Unicode forms of its letters,
    without blanks around it.
    """
    return spelt_out(unicodedata.normalize("NFC", text).strip() or text)


def submission_of(student, paths, lessons, child):
    """A student's Submission from all that is there.  Raises Ambiguous when that is more than one."""
    bare = [path for path in paths if split(path)[1] == ".py"]
    whole = [path for path in paths if split(path)[1] == ".zip"
             or (not split(path)[1] and (path.is_symlink() or path.is_dir()))]
    unread = [path for path in paths if path not in (*bare, *whole)]
    only = lessons[0] if len(lessons) == 1 else None
    lesson_of = {path: of_lesson(split(path)[0])[1] or only for path in bare}
    if len(whole) + bool(bare) > 1 or len({*lesson_of.values()}) < len(bare):
        names = ", ".join(shortened(path.name) for path in (*whole, *bare))
        raise Ambiguous(f"there more than once, as {names}: keep one of them")
    one = read(whole[0], student, lessons, child) if whole else from_bare(lesson_of, student, lessons)
    return one._replace(problems=(*one.problems, *map(why_unread, unread)))


def why_unread(path):
    ending = split(path)[1]
    if ending == ".ipynb":
        return f"{shortened(path.name)} is a notebook, and was not read: the answers belong into the lesson files"
    remedy = "unpack it into a folder, or ask for a zip" if ending in ARCHIVES else "ask for the lesson files"
    return f"{shortened(path.name)} is neither a folder nor a zip, and was not read: {remedy}"


def from_bare(lesson_of, student, lessons):
    """The Submission of {bare file: its lesson, None where that is open}."""
    files, problems, when = {}, [], 0.0
    for path, lesson in lesson_of.items():
        if lesson in lessons:
            when = max(when, take(files, lesson, path, path.name, problems))
        elif lesson:
            problems.append(f"{path.name} is of the lesson {lesson}, which is not graded here")
        else:
            example = f"{path.stem}_{lessons[0]}.py"
            problems.append(f"{path.name} may be of any lesson, and was not read: rename it, to {example} for instance")
    return Submission(student, files, told(problems), moment(when))


def read(path, student, lessons, child):
    """One submission; whatever is wrong with it becomes a sentence, not an error.  child: one of `children.reader`."""
    if path.is_symlink():
        return Submission(student, {}, ("it is a link to somewhere else, which is not followed",), "")
    try:
        if path.is_file():
            files, problems, when = child(children.timed, contents, from_zip, path, lessons, patience=children.PATIENCE)
        else:
            files, problems, when = contents(from_folder, path, lessons)
    except Exception as e:  # BadZipFile, ValueError, MemoryError, zlib.error, struct.error …
        return Submission(student, {}, (f"it cannot be read: {type(e).__name__}",), "")
    return Submission(student, files, problems, moment(when))


def contents(find, path, lessons):
    """What is found there: the files, the first problems, fit to be shown, and the date."""
    files, problems, when = find(path, lessons)
    return files, told(problems), when


def told(problems):
    """The first problems, fit to be shown."""
    more = [f"and {len(problems) - MOST_PROBLEMS} more of the kind"] * (len(problems) > MOST_PROBLEMS)
    return (*map(shortened, problems[:MOST_PROBLEMS]), *more)


def shortened(text):
    """A name or a sentence with one in it, fit to be shown."""
    return spelt_out(text[:LONGEST]) + " …" * (len(text) > LONGEST)


def moment(when):
    """A file's date as text; "" where there is none, or one that no calendar has."""
    try:
        return datetime.fromtimestamp(when).isoformat(timespec="seconds") if when else ""
    except (OSError, ValueError, OverflowError):
        return ""


def spelt_out(text):
    """Text with its control, format and broken characters written as their numbers: names may hold any."""
    return text if text.isprintable() else "".join(c if c.isprintable() else f"\\x{ord(c):02x}" for c in text)


def nearest(candidates, problems):
    """Of {lesson: places}, the one place nearest to the top for each lesson."""
    chosen = {}
    for lesson, places in candidates.items():
        chosen[lesson], *others = sorted(places, key=lambda place: (place.count("/"), place))
        if others and others[0].count("/") == chosen[lesson].count("/"):
            problems.append(f"{lesson}.py is there more than once; {chosen[lesson]} was taken")
    return chosen


def wanted(name, lessons):
    """The lesson whose file this path may be, or None."""
    parts = name.split("/")
    lesson = parts[-1].removesuffix(".py")
    plain = not any(part in ("", ".", "..", "__MACOSX") or part.startswith(".")
                    for part in parts) and len(parts) <= DEEPEST + 1
    return lesson if plain and parts[-1].endswith(".py") and lesson in lessons else None


def resembling(names, lessons, found):
    """Sentences about files that may be meant for lessons that are missing: another spelling, an archive inside."""
    inside = [name for name in names if "__MACOSX" not in name and not os.path.basename(name).startswith(".")]
    for lesson in (lesson for lesson in lessons if lesson not in found):
        pattern = re.compile(rf"(?!test_).*{lesson}.*\.py", re.IGNORECASE | re.DOTALL)
        alike = [name for name in inside if pattern.fullmatch(os.path.basename(name))]
        yield from [f"{lesson}.py is not there, and {name} was not read" for name in alike[:1]]
    if not found:
        packed = [name for name in inside if name.lower().endswith((".zip", *ARCHIVES))]
        remedy = "a folder or zip holds the lesson files themselves"
        yield from [f"{name} lies inside, and was not read: {remedy}" for name in packed]


def from_folder(top, lessons):
    problems, candidates, entries, when, seen = [], {}, 0, 0.0, []
    for here, folders, names in os.walk(top, followlinks=False):
        folders[:] = sorted(f for f in folders if not f.startswith("."))
        inside = Path(here).relative_to(top)
        if len(inside.parts) >= DEEPEST:
            folders.clear()
        entries += len(folders) + len(names)
        if entries > MOST_ENTRIES:
            raise ValueError("too many files")
        for name in names:
            place = str(inside / name)
            seen.append(place)
            if lesson := wanted(place, lessons):
                candidates.setdefault(lesson, []).append(place)
    files = {}
    for lesson, place in nearest(candidates, problems).items():
        when = max(when, take(files, lesson, top / place, place, problems))
    return files, [*problems, *resembling(seen, lessons, candidates)], when


def take(files, lesson, path, name, problems):
    """Read a lesson's file, if it is a regular one; its date."""
    try:
        descriptor = os.open(path, os.O_RDONLY | getattr(os, "O_NOFOLLOW", 0) | getattr(os, "O_NONBLOCK", 0))
        with os.fdopen(descriptor, "rb") as file:
            about = os.fstat(file.fileno())
            if not stat.S_ISREG(about.st_mode):
                raise OSError("not a regular file")
            keep(files, lesson, name, file.read(LARGEST + 1), problems)
            return about.st_mtime
    except OSError:
        problems.append(f"{name} is not a regular file, and was not read")
        return 0.0


def from_zip(path, lessons):
    """Only entries that are wanted are decompressed, and of those no more than a lesson file may have."""
    problems, candidates, files = [], {}, {}
    if path.stat().st_size > LARGEST_ZIP:
        raise ValueError("too large a zip")
    with zipfile.ZipFile(path) as archive:
        entries = archive.infolist()
        if len(entries) > MOST_ENTRIES:
            raise ValueError("too many files")
        for entry in entries:
            name = entry.filename.replace("\\", "/")
            if lesson := wanted(name, lessons):
                if wrong := unfit(entry):
                    problems.append(f"{name} {wrong}, and was not read")
                else:
                    candidates.setdefault(lesson, []).append(name)
        by_name = {entry.filename.replace("\\", "/"): entry for entry in entries}
        for lesson, place in nearest(candidates, problems).items():
            try:
                with archive.open(by_name[place]) as file:
                    keep(files, lesson, place, file.read(LARGEST + 1), problems)
            except Exception as e:  # encrypted, broken, packed in a way that Python does not know
                problems.append(f"{place} cannot be read: {type(e).__name__}")
        problems += resembling(by_name, lessons, {wanted(name, lessons) for name in by_name} - {None})
    return files, problems, path.stat().st_mtime


def unfit(entry):
    """Why an entry of a zip is not read, or ""."""
    if "\0" in entry.orig_filename:
        return "has a name that goes on behind a NUL"
    if stat.S_ISLNK(entry.external_attr >> 16):
        return "is a link"
    if entry.compress_type not in (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED):
        packed = zipfile.compressor_names.get(entry.compress_type, f"method {entry.compress_type}")
        return f"is packed by {packed} and not by deflate, as an ordinary zip is"
    return ""


def keep(files, lesson, place, text, problems):
    if len(text) > LARGEST:
        problems.append(f"{place} is larger than {LARGEST // 1024} KiB, and was not read")
    else:
        files[lesson] = text


class Person(NamedTuple):
    """One line of the class list; what it does not say is empty."""
    student_id: str
    last_name: str = ""
    first_name: str = ""
    email: str = ""
    timestamp: str = ""      # when it was handed in, if that is known better than from the files


def roster(path):
    """{student id: Person} from a CSV file with those columns.  Raises BadInput for a file without student_id."""
    try:
        with open(path, newline="", encoding="utf-8-sig") as file:
            head = file.readline()
            file.seek(0)
            # where the comma is decimal, spreadsheets write semicolons
            reader = csv.DictReader(file, delimiter=max(",;\t", key=head.count))
            if "student_id" not in (reader.fieldnames or ()):
                raise BadInput(f"class list {str(path)!r}",
                               f"without the column student_id ({', '.join(reader.fieldnames or ()) or 'empty'})",
                               f"give it the columns {', '.join(Person._fields)}; all but the first may be missing")
            rows = [Person(**{f: (row.get(f) or "").strip() for f in Person._fields}) for row in reader]
            rows = [person._replace(student_id=identity(person.student_id)) for person in rows if person.student_id]
    except (OSError, UnicodeDecodeError, csv.Error) as e:
        why = e.strerror if isinstance(e, OSError) else "no text" if isinstance(e, UnicodeDecodeError) else e
        raise BadInput(f"class list {str(path)!r}", f"not readable ({why})", "name a CSV file") from None
    people = {person.student_id: person for person in rows}
    for person in rows:
        if people[person.student_id] != person:
            what = f"there twice in {str(path)!r}, with different entries"
            raise BadInput(f"student {person.student_id!r}", what, "keep one of the lines")
    return {student: person._replace(timestamp=handed_in_at(person, path)) for student, person in people.items()}


def handed_in_at(person, path):
    """When a person's work was handed in, as everywhere else; empty when the list does not say."""
    try:
        return datetime.fromisoformat(person.timestamp).isoformat(timespec="seconds") if person.timestamp else ""
    except ValueError:
        raise BadInput(f"timestamp of {person.student_id} in {str(path)!r}", repr(person.timestamp),
                       "write it like 2026-11-30T23:59") from None
