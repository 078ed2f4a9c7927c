"""Submissions that are alike: the same answers, or nearly, apart from names, blanks and comments.

Only lines are compared that the lesson as handed out does not have, each with its variables' names taken away.  Two
lines that follow each other in one file are looked for in the other, where up to BETWEEN lines may have been put
between them.  Lines that do nothing are left out.  Pairs that many have are what the exercise asks for, and say
nothing.
*Source:* Schleimer, Wilkerson, Aiken, Winnowing (SIGMOD 2003).
"""

import re
from collections import Counter, defaultdict
from functools import lru_cache

from validate.subject import modules

from . import example

SHARE = 0.8                  # of one file's lines, in pairs, that another one has make the two nearly the same [-]
BETWEEN = 2                  # lines that may have been put between two others [-]
FEWEST = 8                   # pairs of lines that are compared at least [-]: fewer are alike by chance
COMMON = 20                  # students who have the same pair of lines: more, and it is what the exercise asks for [-]
MOST = 5                     # others that are told of one file [-]
LONGEST, MOST_LINES = 400, 3000      # of a file so much is compared [bytes of a line, lines]
WORKED = "the worked answers"
WORD = re.compile(rb"[A-Za-z_]\w*")
TARGET = re.compile(rb"\s*([A-Za-z_]\w*)\s*(?::[^=]*)?[-+*/]?=(?!=)")                # of an assignment
NOTHING = re.compile(rb"(pass|\.\.\.|[-+.\w]*|\"[^\"]*\"|'[^']*')$")                # a line that does nothing
KEPT = frozenset(b"""
    and as assert break class continue def del elif else except finally for from if import in is lambda not or pass
    raise return try while with yield True False None np
""".split())


def alike(handed_in, lessons):
    """Return {student: [(lesson, another student or WORKED, share of lines in common), …]}, the most alike first."""
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
    """Return the lines of a lesson as handed out, without blanks."""
    text = (modules.ROOT / "lessons" / f"{lesson}.py").read_bytes()
    return frozenset(b"".join(line.split()) for line in text.splitlines())


def own_lines(text, lesson):
    """Return fingerprints of a file's own lines, without handed-out lines, comments, blanks and variables' names."""
    given, kept = handed_out(lesson), []
    lines = [line[:LONGEST] for line in text.splitlines()]
    unread = never_read(lines)
    for line in lines:
        text, target = line.partition(b"#")[0], TARGET.match(line)
        idle = NOTHING.match(text.strip()) or (target and target[1] in unread)
        if not idle and b"".join(line.split()) not in given:
            code = b"".join(WORD.sub(_plain, text).split())
            if len(code) > 3:                                          # not a bracket of its own
                kept.append(code)
    return kept[:MOST_LINES]


def never_read(lines):
    """Return the names that are assigned to and occur nowhere else."""
    words = Counter(word for line in lines for word in WORD.findall(line.partition(b"#")[0]))
    targets = Counter(target[1] for line in lines if (target := TARGET.match(line)))
    return {name for name, count in targets.items() if words[name] == count}


def _plain(word):
    return b" " + word[0] + b" " if word[0] in KEPT else b"n"


def pairs_of(texts):
    """Yield (student, another one, share) of files that are alike, each two once."""
    same = defaultdict(list)
    for student, lines in texts.items():
        if len(lines) > FEWEST:
            same[tuple(lines)].append(student)
    for group in same.values():
        yield from ((a, b, 1.0) for n, a in enumerate(group) for b in group[n + 1:n + 1 + MOST])
        if len(group) > MOST + 1:                                      # the last ones are told of the first
            yield from ((group[0], b, 1.0) for b in group[MOST + 1:])
    yield from nearly_the_same({group[0]: lines for lines, group in same.items()})


def nearly_the_same(texts):
    """Yield (student, another one, share) where one file has most of the pairs of lines of the other."""
    near, following = defaultdict(set), defaultdict(set)              # {pair of lines: who has it}
    for student, lines in texts.items():
        for gap in range(1, BETWEEN + 2):
            for pair in zip(lines, lines[gap:], strict=False):
                near[hash(pair)].add(student)
                if gap == 1:
                    following[hash(pair)].add(student)
    found, counts = Counter(), Counter()
    for pair, students in following.items():
        if len(near[pair]) <= COMMON:
            counts.update(students)
            found.update((a, b) for a in students for b in near[pair] if a != b)
    shares = {pair: number / counts[pair[0]] for pair, number in found.items() if number >= FEWEST}
    for a, b in {tuple(sorted(pair)) for pair in shares}:
        share = max(shares.get((a, b), 0.0), shares.get((b, a), 0.0))
        if share >= SHARE:
            yield a, b, min(share, 0.99)
