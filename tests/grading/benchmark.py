"""`python -m tests.grading.benchmark`: 200 submissions, a tenth of them hostile or broken, against plain pytest on the same files.

A submission's cost is the time of the grading processes, divided by their number; plain pytest's is that of two runs, with the public and
with the secret inputs, two at a time as the grader does it.  Honest and hostile are told apart: a loop that never ends costs its whole budget.
"""

import subprocess
import sys
import tempfile
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from statistics import mean

from rich.console import Console

from tests import attacks
from validate import binding

from . import example, local, marking, sandbox, submissions

CLASS, HOSTILE, JOBS, SAMPLE = 200, 20, 2, 8
LESSONS = ("integrators", "springs")
console = Console()


def write_class(folder):
    """Honest students, each with another part of the work done, and hostile ones."""
    files, texts = example.files(), [a.text for a in attacks.ATTACKS if a.text]
    for n in range(CLASS):
        place = folder / f"s{n:03d}" / "lessons"
        place.mkdir(parents=True)
        if n % (CLASS // HOSTILE) == 0:
            (place / "integrators.py").write_text(attacks.HONEST + texts[n % len(texts)])
            (place / "springs.py").write_text(files["ada"]["springs"])
        else:
            for lesson, text in files[("ada", "ada", "bob", "cem", "dia")[n % 5]].items():
                (place / f"{lesson}.py").write_text(text)


def plain(path):
    """Seconds of two ordinary runs of pytest."""
    began = time.perf_counter()
    for seed in ("public", "a secret"):
        subprocess.run([sys.executable, "-m", "pytest", *(f"tests/test_{lesson}.py" for lesson in LESSONS), f"--of={path}", f"--seed={seed}",
                        "-p", "no:cacheprovider", "--tb=no"], cwd=binding.ROOT, capture_output=True)
    return time.perf_counter() - began


def main():
    if sandbox.unavailable():
        console.print(f"There is nothing to measure: {sandbox.unavailable()}.")
        return 2
    with tempfile.TemporaryDirectory() as scratch:
        folder = Path(scratch)
        write_class(folder)
        handed_in = submissions.read_all(folder, LESSONS).submissions
        rules = marking.settings(LESSONS, "a secret")
        began, results = time.perf_counter(), {}
        for student, result, why in local.results(JOBS, handed_in, rules):
            results[student] = result
            if why:
                console.print(f"{student}: {why}")
        seconds = time.perf_counter() - began
        hostile = {s.student for s in handed_in[::CLASS // HOSTILE]}
        sample = [folder / s.student / "lessons" for s in handed_in if s.student not in hostile][:SAMPLE]
        with ThreadPoolExecutor(JOBS) as pool:
            ordinary = mean(pool.map(plain, sample))
    honest = mean(results[s.student]["seconds"] for s in handed_in if s.student not in hostile and results[s.student])
    evil = mean(results[student]["seconds"] for student in hostile if results[student])
    stolen = sum(t["earned"] for student in hostile for t in results[student]["tests"] if t["lesson"] == "integrators" and t["exercise"] != "1.10")
    console.print(f"{sum(r is not None for r in results.values())} of {CLASS} graded in {seconds:.0f} s by {JOBS} processes")
    console.print(f"an honest one: {honest:.1f} s; plain pytest on the same files: {ordinary:.1f} s; so {honest - ordinary:+.1f} s each")
    console.print(f"a hostile or broken one: {evil:.1f} s, and the {HOSTILE} of them gained {stolen:g} points beside their honest function's")
    return 0


if __name__ == "__main__":
    sys.exit(main())
