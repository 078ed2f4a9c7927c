"""The workflow that publishes the book: its actions, its addresses, and each of its commands.

The long test runs all commands in a fresh clone.  It needs a Pyodide: `WORKBOOK_PYODIDE=pyodide-0.27.7.tar.bz2`.
"""

import inspect
import os
import re
import subprocess
import sys
import tarfile
import time
from pathlib import Path

import pytest
import yaml

from validate.book.__main__ import book
from validate.book.live import pyodide
from validate.grading import autograder
from validate.subject.modules import ROOT

WORKFLOWS = ROOT / ".github" / "workflows"
PUBLISHES = WORKFLOWS / "book.yml"
OLDEST = {"checkout": 5, "setup-python": 6, "upload-pages-artifact": 5, "deploy-pages": 5}    # that run on Node 24
ARCHIVE = f"pyodide-{pyodide.VERSION}.tar.bz2"


def jobs():
    return yaml.safe_load(PUBLISHES.read_text(encoding="utf-8"))["jobs"]


def steps():
    return [step for job in jobs().values() for step in job["steps"]]


def commands():
    return [step["run"] for step in steps() if "run" in step]


def run(command, folder, environment):
    """Run a step as GitHub's runner does."""
    subprocess.run(["bash", "--noprofile", "--norc", "-e", "-o", "pipefail", "-c", command], cwd=folder,
                   env=environment, check=True)


def program(folder, name, text):
    """Write a program that stands in for another one."""
    (folder / name).write_text(f"#!/bin/sh\n{text}\n")
    (folder / name).chmod(0o755)


def test_the_workflow_publishes_the_folder_that_the_book_is_written_to():
    assert jobs()["publish"]["needs"] == "build" and jobs()["publish"]["permissions"]["pages"] == "write"
    used = {step["uses"].split("@")[0] for step in steps() if "uses" in step}
    assert {"actions/upload-pages-artifact", "actions/deploy-pages"} <= used
    given = next(step["with"]["path"] for step in steps() if "upload-pages" in step.get("uses", ""))
    assert Path(given) == inspect.signature(book).parameters["out"].default


def test_the_only_address_is_that_of_the_official_pyodide():
    hosts = re.findall(r"https://[^\s\"]+", "\n".join(commands()))
    assert hosts == ["https://github.com/pyodide/pyodide/releases/download/$version/pyodide-$version.tar.bz2"]


def test_every_action_is_an_official_one_that_a_runner_still_runs():
    """GitHub's runners drop Node 20, and with it the actions that were made for it."""
    texts = [path.read_text(encoding="utf-8") for path in WORKFLOWS.glob("*.yml")] + [inspect.getsource(autograder)]
    for text in texts:
        used = re.findall(r"uses: actions/([\w-]+)@v(\d+)", text)
        assert used and len(used) == text.count("uses: actions/")
        assert not [name for name, version in used if int(version) < OLDEST[name]]
    assert all(step["uses"].startswith("actions/") for step in steps() if "uses" in step)


def test_the_shell_steps_of_the_workflow_run_here(tmp_path):
    """curl, pip and the long commands are replaced: each records its arguments.  What they name must be there."""
    bin_, log = tmp_path / "bin", tmp_path / "log"
    bin_.mkdir()
    real = f'[ "$1" = -c ] && exec "{sys.executable}" "$@"'
    for name, first in (("python", real), ("curl", ""), ("validate", ""), ("pytest", "")):
        program(bin_, name, f'{first}\necho {name} "$@" >> "{log}"')
    environment = {**os.environ, "PATH": f"{bin_}:/usr/bin:/bin", "RUNNER_TEMP": str(tmp_path)}
    for command in commands():
        run(command, ROOT, environment)
    ran = log.read_text().splitlines()
    assert any(line.startswith("curl") and line.endswith(f"/{pyodide.VERSION}/{ARCHIVE}") for line in ran)
    saved = next(re.search(r"-o (\S+)", line)[1] for line in ran if line.startswith("curl"))
    assert f"python -m validate.book --live --pyodide {saved}" in ran
    tests = [path for line in ran for path in re.findall(r"tests/\S+\.py", line)]
    assert len(tests) == 2 and all((ROOT / path).is_file() for path in tests)


@pytest.mark.long
def test_every_command_of_the_workflow_runs_in_a_fresh_clone(tmp_path, capsys):
    """Only downloads are replaced: curl gives the Pyodide that is here, and the browser is that of the system."""
    if "WORKBOOK_PYODIDE" not in os.environ:
        pytest.skip("no Pyodide is given: set WORKBOOK_PYODIDE to its archive, or to the folder that it unpacks to")
    clone, bin_, own = tmp_path / "clone", tmp_path / "bin", tmp_path / "own"
    subprocess.run(["git", "clone", "-q", ROOT, clone], check=True)
    subprocess.run([sys.executable, "-m", "venv", own], check=True)
    bin_.mkdir()
    program(bin_, "curl", f'while [ "$1" != -o ]; do shift; done\ncp "{archive(tmp_path)}" "$2"')
    program(bin_, "python", f'[ "$2 $3" = "playwright install" ] && exit 0\nexec "{own}/bin/python" "$@"')
    environment = {**os.environ, "PATH": f"{bin_}:{own / 'bin'}:{os.environ['PATH']}", "RUNNER_TEMP": str(tmp_path)}
    for name in ("WORKBOOK_PYODIDE", "WORKBOOK_LESSONS", "VIRTUAL_ENV", "PYTHONPATH"):
        environment.pop(name, None)
    for command in commands():
        began = time.monotonic()
        run(command, clone, environment)
        with capsys.disabled():
            print(f"\n{time.monotonic() - began:.0f} s: {command}")


def archive(folder):
    """Return the given Pyodide as the archive of its release: one folder, `pyodide`."""
    given = Path(os.environ["WORKBOOK_PYODIDE"]).resolve()
    if given.is_file():
        return given
    with tarfile.open(folder / ARCHIVE, "w:bz2", compresslevel=1) as packed:
        packed.add(given, "pyodide")
    return folder / ARCHIVE
