"""Owners of files and folders, by their names.  Students, Moodle, Canvas and Gradescope write names.

*Source:* moodle/moodle, `mod/assign/classes/downloader.php` (full name, number of the participant, plugin; a group's
name in place of a person's).  instructure/canvas-lms, `lib/content_zipper.rb` (sortable name in small letters without
blanks, LATE, ID of the student, number of the file, the student's own name of the file; anonymous ones without a
name).  Gradescope's export of submissions (folders `submission_<number>`, and `submission_metadata.yml` beside them).
"""

import json
import re
import unicodedata
from functools import lru_cache
from typing import NamedTuple

from validate.subject import modules

from .classlist import date, identity

METADATA = "submission_metadata.yml"
LARGEST = 1 << 26            # of Gradescope's file [bytes]: it has what the autograder said to all students
MOODLE = re.compile(r"(?P<who>[^_]+)(?:_(?P<number>\d+))?_assignsubmission_[a-z]+(?:_(?P<rest>.*))?", re.DOTALL)
CANVAS = re.compile(r"(?P<who>anon_\w+?|\w+?_(?:late_)?(?P<number>\d+))_\d+_(?P<rest>.+)", re.DOTALL | re.IGNORECASE)
COPY = r"(?: ?\(\d+\)|-\d+)?"    # what browsers and Canvas write where there is a file of that name
ALSO = ("student_id", "email", "login", "sis_id", "canvas_id")        # by what a person is found


class Name(NamedTuple):
    """What a name says."""
    own: str                 # the student's own name of the file, or the whole name
    students: tuple          # for each whose it is: the id of one who is not on the class list, and other names
    number: str = ""         # Canvas's ID of the student
    recorded: bool = False   # in Gradescope's own file
    when: str = ""           # when it was handed in, if the system says so


class Owners(NamedTuple):
    """Whose it is."""
    students: tuple          # ids; several where they handed it in together
    certain: bool            # no student can have chosen that on which this is based, or it is the id itself
    perhaps: tuple = ()      # ids on the class list that fit equally


def of_lesson(stem):
    """Return (student or "", lesson or None) of the name of a bare file: ada_springs is Ada's second lesson."""
    match = lesson_at_the_end().fullmatch(stem)
    return (match[1] or "", match[2].lower()) if match else ("", None)


@lru_cache(maxsize=1)
def lesson_at_the_end():
    """Return the pattern of such a name; it takes time in proportion to the name's length."""
    names = "|".join(modules.lesson_names())
    flags = re.DOTALL | re.IGNORECASE | re.ASCII
    return re.compile(rf"(?:(.*[^ _.-])[ _.-]+)?({names}){COPY}", flags)


def name_of(stem, bare, metadata):
    """Return the information in a name without its suffix.

    bare: it may be a lesson file · metadata: as `from_gradescope` returns it.
    """
    if stem in metadata:
        return metadata[stem]
    if match := MOODLE.fullmatch(stem):
        numbered = "_".join(filter(None, match.group("who", "number")))
        return Name(match["rest"] or "", ((numbered, match["who"]),))
    if match := CANVAS.fullmatch(stem):
        who, number = re.sub(r"_late(?=_\d+$)", "", match["who"], flags=re.IGNORECASE), match["number"] or ""
        return Name(match["rest"], ((who, who.removesuffix(f"_{number}")),), number)
    who = (of_lesson(stem)[0] if bare else "") or stem
    return Name(stem, ((who, re.sub(r" ?\(\d+\)$", "", who)),))                   # "ada (1)", as browsers write it


class People:
    """The class list, as names are looked up in it."""

    def __init__(self, people):
        self.ids, self.numbers, self.names = {*people}, {}, {}
        for student, person in people.items():
            if person.canvas_id:
                self.numbers.setdefault(person.canvas_id, []).append(student)
            first, last = person.first_name, person.last_name
            also = (*(getattr(person, field) for field in ALSO), first + last, last + first)
            for key in {*map(letters, also)} - {""}:
                self.names.setdefault(key, []).append(student)
        for student, person in people.items():                         # Canvas and Moodle know groups by their names
            if key := letters(person.group):
                self.names.setdefault(key, [student])

    def owners(self, name):
        """Return the Owners of something with that Name.  Who is not on the list is known by his name."""
        numbered = self.numbers.get(name.number, ())
        if len(numbered) == 1:
            return Owners((*numbered,), True)
        found, perhaps = {}, []
        for names in name.students:
            fitting = next(filter(None, map(self.fitting, names)), ())
            found[fitting[0] if len(fitting) == 1 else identity(names[0])] = bool(fitting)
            perhaps += fitting if len(fitting) > 1 else ()
        own = unicodedata.normalize("NFC", name.own)
        return Owners((*found,), name.recorded or (own in self.ids and own in found), (*perhaps,))

    def fitting(self, text):
        """Return the ids that a name fits."""
        student = identity(text)
        return (student,) if student in self.ids else self.names.get(letters(text), ())


def letters(text):
    """Return a name for comparison: letters, digits and the sign @, in lower case and one Unicode form."""
    return "".join(c for c in unicodedata.normalize("NFKC", text).casefold() if c.isalnum() or c in "@")


# ---------------------------------------------------------------------------------------------- Gradescope

def from_gradescope(folder):
    """Return {folder: Name} from Gradescope's file in a class folder, if there is one.

    Only its own lines are read: what a program has printed stands deeper in it.
    """
    path = folder / METADATA
    if path.is_symlink() or not path.is_file() or path.stat().st_size > LARGEST:
        return {}
    found, students, inside = {}, [], False
    for line in path.read_text(encoding="utf-8", errors="replace").split("\n"):
        if match := re.fullmatch(r"(submission_\d+):\s*", line):
            students, inside = [], False
            found[match[1]] = about = {"students": students}
        elif found and (match := re.fullmatch(r"  (:\S+): ?(.*)", line)):
            inside = match[1] == ":submitters"
            about[match[1]] = match[2]
        elif inside and (match := re.fullmatch(r"  (- |  ):(name|sid|email): (.*)", line)):
            students.extend([{}] if match[1] == "- " else [])
            students[-1:] = [{**students[-1], match[2]: scalar(match[3])}] if students else []
    return {name: Name(name, tuple(map(known_as, about["students"])), "", True, moment(about.get(":created_at", "")))
            for name, about in found.items() if any(about["students"])}


def known_as(student):
    """Return the names of one who handed something in at Gradescope: his address, his number, his name."""
    return tuple(filter(None, (student.get(key, "") for key in ("email", "sid", "name")))) or ("",)


def scalar(text):
    """Return the text that a line of YAML means, which may be in quotes."""
    text = text.strip()
    if text[:1] == text[-1:] == "'" and len(text) > 1:
        return text[1:-1].replace("''", "'")
    try:
        return str(json.loads(text)) if text[:1] == '"' else text
    except ValueError:
        return text


def moment(text):
    """Return Gradescope's date, 2026-04-26 17:34:00.861687000 Z, in ISO 8601; "" for none."""
    match = re.fullmatch(r"\W*(\d{4}-\d\d-\d\d)[ T](\d\d:\d\d:\d\d)[\d.]* *(Z|[-+]\d\d:?\d\d)?\W*", text)
    return date("{}T{}{}".format(match[1], match[2], match[3] or ""), "the date") if match else ""
