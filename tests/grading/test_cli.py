"""What an instructor's commands say when something is not as it should be: one sentence, at once, and exit code 2."""

import contextlib
import errno
import os
from pathlib import Path
from types import SimpleNamespace

import pytest

import validate
from validate.grading import __main__ as grade
from validate.grading import autograder, children, ending, local, release, sandbox
from validate.run.processes import alone_in
from validate.subject import modules

pytestmark = pytest.mark.xdist_group("what is handed in")
check_seed = local.check_seed                            # other tests do not wait for it


def run(capsys, program, *arguments):
    """Exit code and what was written to standard output and error."""
    with pytest.raises(SystemExit) as end:
        program.main([*map(str, arguments)])
    said = capsys.readouterr()
    return end.value.code or 0, said.out, said.err


@pytest.fixture
def handed_in(tmp_path, monkeypatch, one_reader):
    """A class of one who handed nothing in, and one whose zip is broken; graded in this process, without a sandbox."""
    def results(jobs, todo, settings):
        return ((s.student, *local.marked(s, settings)) for s in todo)
    monkeypatch.setattr(local, "results", results)
    monkeypatch.setattr(local, "check_seed", lambda settings: None)
    monkeypatch.setattr(sandbox, "unavailable", lambda: "")            # there is no code to run
    (tmp_path / "class" / "cem").mkdir(parents=True)
    (tmp_path / "class" / "bob.zip").write_bytes(b"PK\3\4 no zip")
    return [tmp_path / "class", "--lesson", "integrators", "--out", tmp_path / "grades"]


def test_a_zip_that_cannot_be_read_is_named_on_the_terminal(capsys, handed_in):
    code, said, _ = run(capsys, grade, *handed_in, "--seed", "a secret")
    assert code == 0 and said.count("bob: it cannot be read: BadZipFile\n") == said.count("bob") == 1
    assert "2 could not be read:" in said and "cem: no lesson file is in it\n" in said


def test_without_a_sandbox_nothing_is_graded(capsys, handed_in, monkeypatch):
    monkeypatch.setattr(sandbox, "unavailable", lambda: "bubblewrap is not installed")
    code, said, error = run(capsys, grade, *handed_in)
    assert code == 2 and not said and not handed_in[-1].exists()
    assert error.startswith("grade: the sandbox is not available (bubblewrap is not installed): ")
    assert len(error.splitlines()) == 1


def test_a_seed_that_refuses_a_worked_answer_grades_no_class(capsys, tmp_path, handed_in, monkeypatch):
    """Such a seed would take points from every right answer.  Here a worked answer is wrong in its place."""
    wrong = SimpleNamespace(**vars(modules.bind("integrators")))
    wrong.euler_step = wrong.symplectic_euler_step
    monkeypatch.setattr(modules, "bind", lambda lesson, of="solutions": wrong)
    monkeypatch.setattr(local, "check_seed", check_seed)
    monkeypatch.setattr(children, "Child", lambda *begin: contextlib.nullcontext(lambda f, *given, patience: f(*given)))
    out = tmp_path / "a.zip"
    for program, arguments in ((grade, handed_in), (autograder, ["gradescope", "--dirty", "--out", out])):
        code, _, error = run(capsys, program, *arguments, "--exercises", "1.1,1.2", "--seed", "a secret")
        assert code == 2 and error.endswith(
            ": the secret seed is one with which a test refuses the worked answer of 1.1: "
            "give another --seed, and please report this one\n")
    assert not out.exists() and not [*(tmp_path / "grades" / "results").iterdir()]


@pytest.mark.parametrize("given", ["", "  ", "\n"])
def test_an_empty_secret_is_refused(capsys, tmp_path, handed_in, given):
    code, _, error = run(capsys, grade, *handed_in, "--seed", given)
    assert code == 2 and error == "grade: --seed is empty: give a secret, or leave --seed out\n"
    assert not (tmp_path / "grades" / "seed.txt").exists()
    (tmp_path / "grades" / "seed.txt").write_text(given)
    code, _, error = run(capsys, grade, *handed_in)
    assert code == 2 and "seed.txt' is empty" in error and len(error.splitlines()) == 1
    code, _, error = run(capsys, autograder, "gradescope", "--dirty", "--seed", given, "--out", tmp_path / "a.zip")
    assert code == 2 and "--seed is empty" in error and not (tmp_path / "a.zip").exists()


def test_a_secret_is_kept_and_one_is_made_where_none_is_given(capsys, tmp_path, handed_in):
    assert run(capsys, grade, *handed_in)[0] == 0
    made = (tmp_path / "grades" / "seed.txt").read_text()
    assert len(made.strip()) == 32
    run(capsys, grade, *handed_in)
    assert (tmp_path / "grades" / "seed.txt").read_text() == made


def test_another_secret_keeps_the_one_before(capsys, tmp_path, handed_in):
    folder, seeds = tmp_path / "grades", ["the first", "the second", "the first"]
    said = [" ".join(run(capsys, grade, *handed_in, "--seed", seed)[1].split()) for seed in [*seeds, seeds[-1]]]
    assert ["seed-before.txt" in each for each in said] == [False, True, True, False]
    assert (folder / "seed.txt").read_text() == "the first\n"
    assert (folder / "seed-before.txt").read_text() == "the first\nthe second\n"
    assert os.name != "posix" or mode(folder / "seed-before.txt") == 0o600


def test_lessons_without_any_point_are_named_where_others_have_some():
    def earning(*points):
        return {"tests": [{"lesson": name, "earned": earned}
                          for name, earned in zip(("springs", "pbd", "friction"), points, strict=True)]}
    assert ending.unsolved([earning(0, 0, 0)]) == ending.unsolved([earning(1, 0, 2), earning(0, 1, 0)]) == []
    [told] = ending.unsolved([earning(0, 0, 2), earning(0, 0, 1)])
    assert told.startswith("No submission earns a point in springs, pbd. ") and "--lesson" in told


@pytest.mark.parametrize("program", ["main", "grade", "release", "autograder"])
def test_ctrl_c_during_the_imports_of_a_program_says_interrupted(capsys, monkeypatch, program):
    def interrupted(_):
        raise KeyboardInterrupt
    monkeypatch.setattr(validate.importlib, "import_module", interrupted)
    with pytest.raises(SystemExit) as end:
        getattr(validate, program)()
    assert end.value.code == 130 and capsys.readouterr().err.endswith(": interrupted\n")


def test_a_class_is_graded_once_at_a_time(capsys, tmp_path, handed_in):
    (tmp_path / "grades").mkdir()
    with alone_in(tmp_path / "grades"):
        code, _, error = run(capsys, grade, *handed_in)
    assert code == 2 and "in use by another run" in error and len(error.splitlines()) == 1
    assert run(capsys, grade, *handed_in)[0] == 0


def test_a_full_disk_is_said_in_one_sentence(capsys, handed_in, monkeypatch):
    def full(*_):
        raise OSError(errno.ENOSPC, "No space left on device")
    monkeypatch.setattr(Path, "write_bytes", full)
    code, _, error = run(capsys, grade, *handed_in)
    assert code == 2 and "No space left on device" in error and len(error.splitlines()) == 1


def test_release_finds_its_output_unwritable_before_it_begins(capsys, tmp_path, monkeypatch):
    monkeypatch.setattr(release, "contents", lambda *_: pytest.fail("the zip was made before its folder was looked at"))
    (tmp_path / "file").touch()
    code, _, error = run(capsys, release, "--dirty", "--out", tmp_path / "file" / "workbook.zip")
    assert code == 2 and "not writable" in error and "--out" in error and len(error.splitlines()) == 1


def mode(path):
    return path.stat().st_mode & 0o777


@pytest.mark.skipif(os.name != "posix", reason="modes of files mean nothing here")
@pytest.mark.parametrize("given", [[], ["--seed", "a secret"]])
def test_a_secret_is_read_by_its_owner_only(capsys, tmp_path, handed_in, given):
    (tmp_path / "grades").mkdir()
    (tmp_path / "grades" / ".seed.txt.part").touch(0o666)              # of a run that was killed
    before = os.umask(0)
    try:
        said = run(capsys, grade, *handed_in, *given)[1]
    finally:
        os.umask(before)
    assert mode(tmp_path / "grades" / "seed.txt") == 0o600 and "seed.txt" not in said


@pytest.mark.skipif(os.name != "posix", reason="modes of files mean nothing here")
def test_a_secret_that_others_could_read_is_named_once_and_closed(capsys, tmp_path, handed_in):
    (tmp_path / "grades").mkdir()
    file = tmp_path / "grades" / "seed.txt"
    file.write_text("a secret\n")
    file.chmod(0o644)
    said = " ".join(run(capsys, grade, *handed_in)[1].split())
    assert said.count("seed.txt could be read by others on this machine") == 1
    assert mode(file) == 0o600 and file.read_text() == "a secret\n"
    assert "could be read" not in run(capsys, grade, *handed_in)[1]


@pytest.mark.skipif(os.name != "posix", reason="modes of files mean nothing here")
def test_a_secret_is_closed_before_it_is_written(tmp_path, monkeypatch):
    seen, write = [], Path.write_text
    monkeypatch.setattr(Path, "write_text", lambda file, text: (seen.append(mode(file)), write(file, text)))
    assert grade.secret(tmp_path, "a secret") == "a secret" and seen == [0o600]


def test_days_late_without_a_due_date_are_refused(tmp_path, capsys, handed_in):
    code, _, told = run(capsys, grade, tmp_path / "class", "--out", tmp_path / "out", "--late", "10")
    assert code == 2 and "--late is 10, and nothing has a due date: give --due" in told
