"""Submissions that are alike: the same answers, or nearly, whatever their names, blanks and comments.

Only lines are compared that the lesson as handed out does not have, each with its variables' names taken away, in
pairs with the next line.  Pairs that many have are what the exercise asks for, and say nothing; the rest is compared.
*Source:* Schleimer, Wilkerson, Aiken, Winnowing (SIGMOD 2003).
"""

import re
from collections import Counter, defaultdict
from functools import lru_cache
from itertools import pairwise

from validate import modules

from . import example

SHARE = 0.8                  # of the rarer one's lines, in pairs, make two files nearly the same [-]
FEWEST = 8                   # pairs of lines that are compared at least [-]: fewer are alike by chance
COMMON = 20                  # students who have the same pair of lines: more, and it is what the exercise asks for [-]
MOST = 5                     # others that are told of one file [-]
LONGEST, MOST_LINES = 400, 3000      # of a file so much is compared [bytes of a line, lines]
WORKED = "the worked answers"
WORD = re.compile(rb"[A-Za-z_]\w*")
KEPT = frozenset(b"""
    and as assert break class continue def del elif else except finally for from if import in is lambda not or pass
    raise return try while with yield True False None np
""".split())


def alike(handed_in, lessons):
    """{student: [(lesson, another student or WORKED, share of lines in common), …]}, the most alike first."""
    found = defaultdict(list)
    for lesson in lessons:
        texts = {one.student: own_lines(one.files[lesson], lesson) for one in handed_in if lesson in one.files}
        for one, other, share in pairs_of({WORKED: own_lines(example.worked(lesson).encode(), lesson), **texts}):
            for a, b in ((one, other), (other, one)):
                if a != WORKED:
                    found[a].append((lesson, b, share))
    return {student: sorted(pairs, key=_order)[:MOST] for student, pairs in found.items()}


def _order(pair):
    lesson, other, share = pair
    return -share, lesson, other != WORKED, other


@lru_cache
def handed_out(lesson):
    """The lines of a lesson as handed out, without blanks."""
    text = (modules.ROOT / "lessons" / f"{lesson}.py").read_bytes()
    return frozenset(b"".join(line.split()) for line in text.splitlines())


def own_lines(text, lesson):
    """Fingerprints of a file's own lines: without what was handed out, comments, blanks and variables' names."""
    given, kept = handed_out(lesson), []
    for line in text.splitlines():
        line = line[:LONGEST]
        if b"".join(line.split()) not in given:
            code = b"".join(WORD.sub(_plain, line.partition(b"#")[0]).split())
            if len(code) > 3:                                          # not a bracket of its own
                kept.append(code)
    return kept[:MOST_LINES]


def _plain(word):
    return b" " + word[0] + b" " if word[0] in KEPT else b"n"


def pairs_of(texts):
    """(student, another one, share) of files that are alike, each two once."""
    same = defaultdict(list)
    for student, lines in texts.items():
        if len(lines) > FEWEST:
            same[tuple(lines)].append(student)
    for group in same.values():
        yield from ((a, b, 1.0) for n, a in enumerate(group) for b in group[n + 1:n + 1 + MOST])
        if len(group) > MOST + 1:                                      # the last ones are told of the first
            yield from ((group[0], b, 1.0) for b in group[MOST + 1:])
    having = defaultdict(list)                                       # {pair of lines: the first of each group with it}
    for lines, group in same.items():
        for pair in {*pairwise(lines)}:
            having[hash(pair)].append(group[0])
    common, counts = Counter(), Counter()
    for students in having.values():
        if len(students) <= COMMON:
            counts.update(students)
            common.update((a, b) for n, a in enumerate(students) for b in students[n + 1:])
    for (a, b), number in common.items():
        share = number / min(counts[a], counts[b])
        if number >= FEWEST and share >= SHARE:
            yield a, b, min(share, 0.99)
