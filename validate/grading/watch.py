"""Signs that a submission did more than answer: for the instructor to look into, never for points.

The worker notes what a program tries, by Python's audit events, and the parent notes how it ended.  A program that
goes past Python (native code) is noted when it begins to.  What a file imports is read in its text.  None of this
keeps a program in; the sandbox does.
"""

import re

SENTENCES = {
    "time": "its time was up",
    "memory": "it ran out of memory",
    "end": "the program ended by itself",
    "refused": "it made a system call for which the sandbox ends a program",
    "wire": "it sent the grader what is no answer",
    "flood": "it printed very much",
    "process": "it tried to start another process",
    "signal": "it sent a signal to a process",
    "network": "it asked for the network",
    "write": "it tried to write, move or remove files",
    "read": "it looked at files that are not the lesson's",
    "native": "it called native code",
    "inside": "it looked inside the interpreter",
    "limit": "it asked to change its limits",
}
NOTES = ("process", "signal", "network", "write", "read", "native", "inside", "limit")      # by the worker
NEEDED = set("""
    __future__ abc cmath collections dataclasses enum functools itertools lessons math numbers numpy operator
    solutions typing
""".split())
IMPORT = re.compile(
    rb"(?:^|[;:])[ \t]*(?:from[ \t]+([\w.]+)[ \t]+import\b|import[ \t]+([\w. \t,]{1,300}))", re.MULTILINE)
WORDS = re.compile(
    rb"(?<![\w.])(__import__|__builtins__|eval|exec|compile|globals|open)(?=[ \t]*[(\[.])"
    rb"|(?<=\.)(__subclasses__|__globals__|_getframe)\b")
LONGEST = 40                 # of a module's name that are told [characters]: a file may name one of its own length
MOST = 12                    # imports and words of one file that are told [-]


def in_text(text):
    """Return imports and words in a lesson file that no lesson needs: ["import os", "use eval"]."""
    lines = b"\n".join(line for line in text.splitlines() if not line.lstrip().startswith(b"#"))
    names = [name for name in dict.fromkeys(modules_in(lines)) if name not in NEEDED and name.isidentifier()]
    found = [f"import {name[:LONGEST]}" for name in names]
    found += [f"use {(a or b).decode()}" for a, b in dict.fromkeys(WORDS.findall(lines))]
    return found[:MOST]


def modules_in(lines):
    """Yield the top of every module that a text imports."""
    for one, several in IMPORT.findall(lines):
        for name in [one] if one else [part.split()[0] for part in several.split(b",") if part.split()]:
            yield name.partition(b".")[0].decode("ascii", "replace")


def noted(lesson, codes):
    """Return [(what, in words; the same with the lesson and its details), …] of the notes on one lesson."""
    told = [(SENTENCES[code], f"{lesson}: {SENTENCES[code]}") for code in SENTENCES if code in codes]
    verbs = {"import": "it imports what no lesson needs", "use": "it uses functions that no lesson needs"}
    for verb, what in verbs.items():
        names = [code.removeprefix(f"{verb} ") for code in codes if code.startswith(f"{verb} ")]
        told += [(what, f"{lesson}: it {verb}s {', '.join(names)}")][:len(names)]
    return told
