"""`python -m tests.grading.benchmark class`: a class with hostile submissions, graded several times.

The honest submissions must have full marks in every run, the hostile ones must gain nothing, and every run must write
the same bytes.  The class is graded by the command `grade` itself, in the lesson that the attacks are written for.
"""

import hashlib
import json
import os
import resource
import subprocess
import sys
import time
from pathlib import Path
from statistics import median
from typing import NamedTuple

from tests import attacks
from validate.grading import example
from validate.subject import modules

LESSON, HONEST_EXERCISE = "integrators", "1.10"      # every hostile file has this exercise right, and no other
HOSTILE = 0.2                # share of the class [-]
HANDED_IN = 1.8e9            # date of every file [s since 1970]
SEED = "a secret of the rehearsal"


class Found(NamedTuple):
    """What one run of the class gave."""
    jobs: int
    wall: float              # by the clock [s]
    cpu: float               # of the processor, by the grader's own processes: the system counts no ended sandbox [s]
    full: int                # honest submissions with full marks [-]
    honest: int              # honest submissions [-]
    gained: float            # points of hostile ones, beyond what they have honestly
    hostile: int             # hostile submissions [-]
    honest_seconds: float    # median of an honest submission, by the clock [s]
    hostile_seconds: float   # the same of a hostile one [s]
    digest: str              # of the CSV and of all students' pages

    def fair(self):
        return self.full == self.honest and not self.gained


def hostile_texts(count):
    """So many hostile files, spread evenly over all kinds; the last kind first, because the first are slow ones."""
    kinds = attacks.ATTACKS[::-1]
    return [attacks.HONEST + kinds[n * len(kinds) // count % len(kinds)].text for n in range(count)]


def make(folder, size):
    """Write the class; the ids of the hostile students."""
    hostile, right = hostile_texts(round(HOSTILE * size)), example.worked(LESSON)
    every, evil = size // max(1, len(hostile)), set()
    for n in range(size):
        place = folder / f"s{n:04d}"
        place.mkdir(parents=True)
        text = f"{right}\n# {place.name}\n"
        if n % every == every - 1 and hostile:
            evil.add(place.name)
            text = hostile.pop(0)
        file = place / f"{LESSON}.py"
        file.write_text(text, encoding="utf-8", errors="surrogatepass")
        os.utime(file, (HANDED_IN, HANDED_IN))
    return evil


def graded(folder, out, jobs, evil):
    """Grade the class once, by the command; what was found."""
    command = [sys.executable, "-m", "validate.grading", str(folder), "--out", str(out), "--lesson", LESSON,
               "--seed", SEED, "--jobs", str(jobs)]
    before, began = used(), time.monotonic()
    run = subprocess.run(command, cwd=modules.ROOT, capture_output=True, text=True)
    wall, cpu = time.monotonic() - began, used() - before
    if run.returncode:
        raise RuntimeError(f"grade ended with {run.returncode}: {run.stdout[-500:]}{run.stderr[-500:]}")
    results = [json.loads(path.read_text()) for path in (out / "results").glob("*.json")]
    honest, hostile = ([r for r in results if (r["student"] in evil) == kind] for kind in (False, True))
    gained = sum(t["earned"] for r in hostile for t in r["tests"] if t["exercise"] != HONEST_EXERCISE)
    full = sum(all(t["status"] == "passed" for t in r["tests"]) for r in honest)
    return Found(jobs, wall, cpu, full, len(honest), gained, len(hostile), middle(honest), middle(hostile), digest(out))


def used():
    """Seconds of the processor that all ended children have had."""
    now = resource.getrusage(resource.RUSAGE_CHILDREN)
    return now.ru_utime + now.ru_stime


def middle(results):
    return median(r["seconds"] for r in results) if results else 0.0


def digest(out):
    """Fingerprint of what students and other programs read."""
    files = [out / "grades.csv", *sorted((out / "students").iterdir())]
    return hashlib.sha256(b"\0".join(file.name.encode() + b"\0" + file.read_bytes() for file in files)).hexdigest()[:12]


def rehearse(scratch, size, runs, jobs):
    """Grade one class so often with each number of jobs, alternately; what each run found, as it comes."""
    evil = make(Path(scratch) / "class", size)
    for run in range(runs):
        for count in jobs:
            yield graded(Path(scratch) / "class", Path(scratch) / f"grades-{run}-{count}", count, evil)
