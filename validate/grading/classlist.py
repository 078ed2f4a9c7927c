"""The class list: the students, and the names by which their work is found, dated and handed back."""

import csv
import io
import unicodedata
from datetime import datetime
from typing import NamedTuple

from solutions.checks import BadInput

SAVE = "save it as “CSV UTF-8”"
OFFICE = (b"PK\3\4", b"\xd0\xcf\x11\xe0")         # how .xlsx, .ods and .xls begin


class Person(NamedTuple):
    """One line of the class list; what it does not say is empty."""
    student_id: str
    last_name: str = ""
    first_name: str = ""
    email: str = ""
    timestamp: str = ""      # when it was handed in, if that is known better than from the files
    canvas_id: str = ""      # Canvas's ID
    sis_id: str = ""         # Canvas's SIS User ID, Moodle's ID number
    login: str = ""          # Canvas's SIS Login ID, Moodle's username
    section: str = ""        # Canvas's Section
    due: str = ""            # the student's own due date, in place of the command's
    group: str = ""          # students of one group share one submission


def roster(path, tell=print):
    """Return {student id: Person} from a CSV file with those columns; tell is called with a remark about its encoding.

    Raises BadInput for a file without student_id, and for one that is no CSV.
    """
    text = decoded(path, tell)
    try:
        # where the comma is decimal, spreadsheets write semicolons
        separator = max(",;\t", key=text.partition("\n")[0].count)
        head, *lines = [[cell.strip() for cell in row] for row in
                        csv.reader(io.StringIO(text, newline=""), delimiter=separator)] or [[]]
    except csv.Error as e:
        raise BadInput(f"class list {str(path)!r}", f"not readable ({e})", SAVE) from None
    columns = [name.lower() for name in head]
    if "student_id" not in columns:
        raise BadInput(f"class list {str(path)!r}", f"without the column student_id ({', '.join(head) or 'empty'})",
                       f"give it the columns {', '.join(Person._fields)}; all but the first may be missing")
    cells = [dict(zip(columns, line, strict=False)) for line in lines]
    if unknown := [name for name in head if name and name.lower() not in Person._fields]:
        tell(f"{path} has unknown columns, which were not read: {', '.join(map(spelt_out, unknown))}. "
             f"Known are {', '.join(Person._fields)}")
    rows = [Person(**{f: row.get(f, "") for f in Person._fields}) for row in cells]
    if nameless := sum(not person.student_id and any(row.values()) for person, row in zip(rows, cells, strict=True)):
        tell(f"{path}: lines without a student_id were not read ({nameless})")
    rows = [person._replace(student_id=identity(person.student_id)) for person in rows if person.student_id]
    people = {person.student_id: person for person in rows}
    for person in rows:
        if people[person.student_id] != person:
            what = f"there twice in {str(path)!r}, with different entries"
            raise BadInput(f"student {person.student_id!r}", what, "keep one of the lines")
    return {student: dated(person, path) for student, person in people.items()}


def decoded(path, tell):
    """Return the text of a class list in UTF-8, UTF-16 with its mark, or else the Windows code page.

    The last case is reported by `tell`.
    """
    try:
        data = path.read_bytes()
    except OSError as e:
        raise BadInput(f"class list {str(path)!r}", f"not readable ({e.strerror})", "name a CSV file") from None
    if data.startswith(OFFICE):
        raise BadInput(f"class list {str(path)!r}", "a workbook of a spreadsheet program, and no CSV", SAVE)
    wide = data.startswith((b"\xff\xfe", b"\xfe\xff"))
    try:
        text = data.decode("utf-16" if wide else "utf-8-sig")
    except UnicodeDecodeError:
        text = "" if wide else as_ansi(data)
        sample = next((line for line in text.splitlines() if not line.isascii()), "")
        if sample:
            tell(f"{path} is not in UTF-8, and was read as Windows-1252: if {spelt_out(sample)} is wrong, {SAVE}")
    if (data and not text) or any(c < " " and c not in "\t\r\n" for c in text):
        raise BadInput(f"class list {str(path)!r}", "not readable (no text in UTF-8)", SAVE)
    return text


def as_ansi(data):
    """Return the text in Windows-1252, of which Latin-1 is a part; "" for bytes that are no characters of it."""
    try:
        return data.decode("cp1252")
    except UnicodeDecodeError:
        return ""


def dated(person, path):
    """Return the person with dates as everywhere else."""
    when = date(person.timestamp, f"timestamp of {person.student_id} in {str(path)!r}")
    return person._replace(timestamp=when, due=deadline(person.due, f"due of {person.student_id} in {str(path)!r}"))


def date(text, name):
    """Return a date in ISO 8601 as it is compared and shown; "" for none.  Raises BadInput for what is none."""
    try:
        return datetime.fromisoformat(text).isoformat(timespec="seconds") if text else ""
    except ValueError:
        raise BadInput(name, f"not a date ({text!r})", "write it like 2026-11-30T23:59") from None


def deadline(text, name):
    """Return a due date, which ends with its day where it has no time."""
    when = date(text, name)
    return when.replace("T00:00:00", "T23:59:59") if len(text) in (8, 10) else when


def identity(text):
    """Return a student's id as it is compared and shown: one for all Unicode forms of its letters,
    without blanks around it.
    """
    return spelt_out(unicodedata.normalize("NFC", text).strip() or text)


def spelt_out(text):
    """Return text with its control, format and broken characters written as their numbers: names may hold any."""
    return text if text.isprintable() else "".join(c if c.isprintable() else f"\\x{ord(c):02x}" for c in text)
