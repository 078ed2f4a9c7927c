"""What students handed in: one folder or zip each.  Nothing is unpacked, followed or executed; only the lesson files' bytes are read.

A zip is read in a child of little memory and time, and only what is stored or deflated: other ways of packing take gigabytes for a kilobyte.
"""

import csv
import hashlib
import os
import stat
import zipfile
from datetime import datetime
from pathlib import Path
from typing import NamedTuple

from solutions.checks import BadInput

from . import children

LARGEST = 1 << 18            # of a lesson file [bytes]: ten times the worked one
DEEPEST = 4                  # folders between the top and the file
MOST_ENTRIES = 5000          # of a zip or a folder [-]: more is not a submission
LARGEST_ZIP = 1 << 25        # [bytes]: its list of entries is read before they can be counted
MOST_PROBLEMS = 20           # of a submission that are told [-]: a hostile zip has thousands
LONGEST = 200                # of a sentence about one [characters]: a name may have 65,535


class Submission(NamedTuple):
    """One student's files."""
    student: str             # name of the folder or zip: the student's id
    files: dict              # {lesson: bytes}; a lesson that is missing was not handed in
    problems: tuple          # sentences about what could not be read
    timestamp: str           # when it was handed in: ISO 8601, from the date of the zip or of its newest lesson file; "" if there is none

    def digest(self):
        """Changes when anything changes that is graded."""
        return hashlib.sha256(repr((sorted(self.files.items()), self.problems, self.timestamp)).encode()).hexdigest()


def read_all(folder, lessons):
    """Every submission in a folder, sorted by student.  Raises BadInput when there is none."""
    folder = Path(folder)
    if not folder.is_dir():
        raise BadInput(f"submissions {str(folder)!r}", "not a folder", "name the folder that holds one folder or zip a student")
    found = {}
    with children.reader() as child:
        for path in sorted(folder.iterdir()):
            if path.name.startswith((".", "__")) or not (path.is_symlink() or path.is_dir() or path.suffix.lower() == ".zip"):
                continue
            student = spelt_out(path.stem if path.suffix.lower() == ".zip" else path.name)
            if student in found:
                raise BadInput(f"student {student!r}", "there as a folder and as a zip", "keep one of them")
            found[student] = read(path, student, lessons, child)
    if not found:
        raise BadInput(f"submissions {str(folder)!r}", "empty", "put one folder or zip a student into it")
    return list(found.values())


def read(path, student, lessons, child):
    """One submission; whatever is wrong with it becomes a sentence, not an error.  child: one of `children.reader`."""
    if path.is_symlink():
        return Submission(student, {}, ("it is a link to somewhere else, which is not followed",), "")
    try:
        if path.is_file():
            files, problems, when = child(children.timed, contents, from_zip, path, lessons, patience=children.PATIENCE)
        else:
            files, problems, when = contents(from_folder, path, lessons)
    except Exception as e:                                             # BadZipFile, ValueError, MemoryError, zlib.error, struct.error …
        return Submission(student, {}, (f"it cannot be read: {type(e).__name__}",), "")
    return Submission(student, files, problems, moment(when))


def contents(find, path, lessons):
    """What is found there: the files, the first problems, fit to be shown, and the date."""
    files, problems, when = find(path, lessons)
    told = [spelt_out(problem[:LONGEST]) + " …" * (len(problem) > LONGEST) for problem in problems[:MOST_PROBLEMS]]
    return files, (*told, *[f"and {len(problems) - MOST_PROBLEMS} more of the kind"][:len(problems) > MOST_PROBLEMS]), when


def moment(when):
    """A file's date as text; "" where there is none, or one that no calendar has."""
    try:
        return datetime.fromtimestamp(when).isoformat(timespec="seconds") if when else ""
    except (OSError, ValueError, OverflowError):
        return ""


def spelt_out(text):
    """Text with its control, format and broken characters written as their numbers: names may hold any."""
    return "".join(c if c.isprintable() else f"\\x{ord(c):02x}" for c in text)


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
    plain = not any(part in ("", ".", "..", "__MACOSX") or part.startswith(".") for part in parts) and len(parts) <= DEEPEST + 1
    return lesson if plain and parts[-1].endswith(".py") and lesson in lessons else None


def from_folder(top, lessons):
    problems, candidates, entries, when = [], {}, 0, 0.0
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
            if lesson := wanted(place, lessons):
                candidates.setdefault(lesson, []).append(place)
    files = {}
    for lesson, place in nearest(candidates, problems).items():
        try:
            descriptor = os.open(top / place, os.O_RDONLY | getattr(os, "O_NOFOLLOW", 0) | getattr(os, "O_NONBLOCK", 0))
            with os.fdopen(descriptor, "rb") as file:
                about = os.fstat(file.fileno())
                if not stat.S_ISREG(about.st_mode):
                    raise OSError("not a regular file")
                keep(files, lesson, place, file.read(LARGEST + 1), problems)
                when = max(when, about.st_mtime)
        except OSError:
            problems.append(f"{place} is not a regular file, and was not read")
    return files, problems, when


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
            except Exception as e:                                     # encrypted, broken, packed in a way that Python does not know
                problems.append(f"{place} cannot be read: {type(e).__name__}")
    return files, problems, path.stat().st_mtime


def unfit(entry):
    """Why an entry of a zip is not read, or ""."""
    if "\0" in entry.orig_filename:
        return "has a name that goes on behind a NUL"
    if stat.S_ISLNK(entry.external_attr >> 16):
        return "is a link"
    if entry.compress_type not in (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED):
        return f"is packed by {zipfile.compressor_names.get(entry.compress_type, f'method {entry.compress_type}')} and not by deflate, as an ordinary zip is"
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
            reader = csv.DictReader(file, delimiter=max(",;\t", key=head.count))        # where the comma is decimal, spreadsheets write semicolons
            if "student_id" not in (reader.fieldnames or ()):
                raise BadInput(f"class list {str(path)!r}", f"without the column student_id ({', '.join(reader.fieldnames or ()) or 'empty'})",
                               f"give it the columns {', '.join(Person._fields)}; all but the first may be missing")
            rows = [Person(**{f: (row.get(f) or "").strip() for f in Person._fields}) for row in reader]
    except (OSError, UnicodeDecodeError, csv.Error) as e:
        why = e.strerror if isinstance(e, OSError) else "no text" if isinstance(e, UnicodeDecodeError) else e
        raise BadInput(f"class list {str(path)!r}", f"not readable ({why})", "name a CSV file") from None
    return {person.student_id: person._replace(timestamp=handed_in_at(person, path)) for person in rows if person.student_id}


def handed_in_at(person, path):
    """When a person's work was handed in, as everywhere else; empty when the list does not say."""
    try:
        return datetime.fromisoformat(person.timestamp).isoformat(timespec="seconds") if person.timestamp else ""
    except ValueError:
        raise BadInput(f"timestamp of {person.student_id} in {str(path)!r}", repr(person.timestamp), "write it like 2026-11-30T23:59") from None
