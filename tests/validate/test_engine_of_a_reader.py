"""validate --engine my_engine.py: the example of docs/engine.md, and files that are none."""

import re

import numpy as np
import pytest

from solutions.support.model import Body, make_model
from validate import __main__ as cli
from validate.engines.products import BOX2D, MUJOCO, PYMUNK, RAPIER
from validate.subject.modules import ROOT
from validate.worlds import conformance
from validate.worlds.described import DESCRIBED

TEXT = (ROOT / "docs" / "engine.md").read_text(encoding="utf-8")
EXAMPLE = re.search(r"```python\n(.*?)```", TEXT, re.S)[1]


def run(capsys, tmp_path, text, *more, name="my_engine.py"):
    """Write an engine, run it, and return (exit code, output, error, page)."""
    path, out = tmp_path / name, tmp_path / "report"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(SystemExit) as end:
        cli.main(["--engine", str(path), "--out", str(out), *more])
    said = capsys.readouterr()
    page = out / f"engine-{path.stem}.html"
    return end.value.code or 0, said.out, said.err, page.read_text(encoding="utf-8") if page.exists() else ""


def verdicts(said):
    """{scene: verdict} of the lines before the table."""
    return dict(re.findall(r"^(\w+): (.+)$", said.partition(" against the truth")[0], re.M))


def of(*scenes):
    return [part for name in scenes for part in ("--scene", name)]


def test_the_example_has_fewer_than_a_hundred_lines():
    assert len(EXAMPLE.splitlines()) < 100


def test_the_example_agrees_where_it_can_and_refuses_the_rest(capsys, tmp_path):
    code, said, error, page = run(capsys, tmp_path, EXAMPLE, "--engine", "pymunk", *of(
        "throw", "linear_drag", "oscillator", "kepler", "cradle", "oblique_discs", "incline", "rod_chain", "heavy_top"))
    assert code == 0 and not error
    assert verdicts(said) == {
        "throw": "agrees", "linear_drag": "agrees", "oscillator": "agrees", "kepler": "shown, not judged",
        "cradle": "agrees", "oblique_discs": "agrees", "incline": "refuses", "rod_chain": "refuses",
        "heavy_top": "refuses"}
    assert "its only shape is the ball" in page and "it has no joints" in page and "error of pymunk" in page
    assert page.count("<tr>") == 10 and "http" not in page


def test_every_described_scene_begins_where_its_truth_does():
    """At a time so short that nothing has moved, the observed start is the truth."""
    for name, one in DESCRIBED.items():
        p = one.scene.parameters
        if name in ("dominoes", "machine"):                  # their truths are runs of pymunk that take seconds
            continue
        seen = np.array(one.observe(conformance.start_of(one.model(p)), p), float)
        truth = np.array(one.scene.truth(p, 1e-9), float)
        assert np.max(np.abs(seen - truth)) <= 1e-6 * max(1.0, np.max(np.abs(truth))), name


@pytest.mark.parametrize(("product", "expected"), [
    (PYMUNK, {"incline": "agrees", "rod_chain": "agrees", "heavy_top": "refuses"}),
    (MUJOCO, {"asymmetric_top": "agrees", "rod_chain": "agrees", "cradle": "refuses"}),
    (BOX2D, {"incline": "agrees", "rod_chain": "departs", "heavy_top": "refuses"}),
    (RAPIER, {"incline": "agrees", "rod_chain": "agrees", "asymmetric_top": "shown, not judged"})], ids=str)
def test_known_engines_get_the_verdicts_of_their_joints(capsys, tmp_path, product, expected):
    """Box2D's joints are soft, so that its chain does not converge to one of rigid rods.  Rapier turns a top in single
    precision: its error grows with the number of steps."""
    if not product.installed():
        pytest.skip(f"{product} is not installed: {product.remedy}")
    text = f"from validate.worlds.{product.file} import build, refuses\n"
    code, said, _, _ = run(capsys, tmp_path, text, "--engine", "pymunk", *of(*expected))
    assert verdicts(said) == expected and code == ("departs" in expected.values())


STILL = "def build(model, dt):\n    from solutions.support.model import start_of\n    return World(start_of(model))\n"
WORLD = ("class World:\n    def __init__(self, s): self.s = s\n    def step(self): pass\n"
         "    def state(self): return self.s\n")


def test_an_engine_that_does_nothing_departs(capsys, tmp_path):
    code, said, _, page = run(capsys, tmp_path, WORLD + STILL, "--engine", "pymunk", *of("slide_then_roll", "throw"))
    assert code == 1 and set(verdicts(said).values()) == {"departs"} and 'class="agrees"' not in page


def test_an_engine_with_a_wrong_law_departs(capsys, tmp_path):
    """One that falls with 1.02 g."""
    text = EXAMPLE.replace("self.model.gravity)", "1.02 * np.array(self.model.gravity))")
    code, said, _, page = run(capsys, tmp_path, text, "--engine", "pymunk", "--full", *of("throw"))
    assert code == 1 and verdicts(said) == {"throw": "departs"} and "converge to another motion, 2.4 % away" in page


@pytest.mark.parametrize(("text", "words"), [
    (None, "not there"), ("def build(:", "SyntaxError"), ("import no_such_module", "no_such_module"),
    ("raise SystemExit(3)", "SystemExit"), ("x = 1", "build(model, dt)"), ("build = 3", "missing or not a function"),
    ("build = print\nrefuses = 3", "refuses(model)"),
])
def test_a_bad_file_gets_one_sentence(capsys, tmp_path, text, words):
    path = tmp_path / "my_engine.py"
    if text is not None:
        path.write_text(text)
    with pytest.raises(SystemExit) as end:
        cli.main(["--engine", str(path), "--out", str(tmp_path / "report")])
    error = capsys.readouterr().err
    assert end.value.code == 2 and words in error and len(error.strip().splitlines()) == 1
    assert not (tmp_path / "report").exists()


def test_an_unknown_scene_and_an_unknown_engine_get_one_sentence(capsys, tmp_path):
    for more, words in ((of("cloth"), "described.py"), (["--engine", "havok"], "choose from: pymunk")):
        code, _, error, _ = run(capsys, tmp_path, EXAMPLE, *more)
        assert code == 2 and words in error and len(error.strip().splitlines()) == 1


LONG = pytest.mark.long      # of the same kind as others: each starts a process


@pytest.mark.parametrize(("text", "words"), [
    ("def build(model, dt): raise ValueError('no\\nmore')", "ValueError: no"),
    ("def build(model, dt): return None", "build(model, dt): BadInput: what it returned is None"),
    (WORLD + "def build(model, dt): return World(3)", "state() is int"),
    pytest.param(WORLD + "def build(model, dt): return World([[0.0]] * 4)", "the shapes of state()", marks=LONG),
    (WORLD + STILL + "def refuses(model): return 1 / 0", "refuses(model): ZeroDivisionError"),
    pytest.param(WORLD + STILL + "import numpy\ndef refuses(model): return numpy.zeros(2)",
                 "refuses(model): ValueError", marks=LONG),
    (WORLD + STILL + "import os\ndef refuses(model): os.kill(os.getpid(), 11)",
     "it ended the process, with signal SIGSEGV"),
    pytest.param(WORLD + STILL + "import os\ndef refuses(model): os._exit(3)",
                 "it ended the process, with code 3", marks=LONG),
    pytest.param(WORLD + STILL + "World.close = lambda self: 1 / 0", "close(): ZeroDivisionError", marks=LONG),
    (WORLD + STILL.replace("start_of(model))", "tuple(a * float('nan') for a in start_of(model)))"), "not finite"),
])
def test_an_engine_that_fails_is_named_with_its_first_line(capsys, tmp_path, text, words):
    code, said, _, page = run(capsys, tmp_path, text, "--engine", "pymunk", *of("throw"))
    assert code == 1 and verdicts(said) == {"throw": "fails"}
    assert words in page.replace("&#x27;", "'")


def test_a_folder_that_cannot_be_written_is_told_before_the_first_run(capsys, tmp_path):
    (tmp_path / "report").write_text("a file")
    code, said, error, _ = run(capsys, tmp_path, WORLD + STILL, *of("throw"))
    assert code == 2 and not said and len(error.strip().splitlines()) == 1


def test_an_engine_that_hangs_is_ended(capsys, tmp_path, monkeypatch):
    monkeypatch.setattr(conformance, "WITHIN", 0.3)
    hangs = (
        "def build(model, dt):\n    while True:\n"
        "        try:\n            1 / 0\n        except Exception:\n            pass\n"
    )
    code, said, _, page = run(capsys, tmp_path, hangs, *of("throw", "cradle"))
    assert code == 1 and verdicts(said) == {"throw": "fails", "cradle": "fails"}
    assert "still running after 0.3 s" in page


def test_an_engine_may_import_its_neighbours_and_closes_its_worlds(capsys, tmp_path):
    (tmp_path / "neighbour_of_mine.py").write_text(EXAMPLE)
    text = ("from neighbour_of_mine import World as Theirs, refuses\nopened = []\nclass World(Theirs):\n"
            "    def close(self): opened.remove(self)\ndef build(model, dt):\n    assert not opened\n"
            "    opened.append(World(model, dt))\n    return opened[0]\n")
    code, said, _, _ = run(capsys, tmp_path, text, "--engine", "pymunk", *of("throw", "oscillator"))
    assert code == 0 and set(verdicts(said).values()) == {"agrees"}


def test_a_name_with_markup_does_no_harm_to_the_page():
    row = conformance.Row("s", "<b>", (1,), (None,), None, conformance.Judgement.FAILS, "<script>", {"pymunk": "<i>"})
    reader = conformance.Reader("<u>", None, None)
    page = conformance.page_of(reader, [row], ["<p>"])
    assert not re.search(r"<(script|b|i|u)>", page)


def test_convergence_is_judged_by_errors_and_by_changes():
    judged = conformance.judged
    assert judged((0.4, 0.2, 0.1, 0.05), (1, 1, 0.05), 1.0, 0.0)[0] == "agrees"
    assert judged((0.05, 0.05, 0.05, 0.05), (1e-3, 1e-3, 1e-3), 0.0, 0.0)[0] == "departs"
    assert judged((0.02, 0.05, 0.03, 0.04), (0.05, 0.03, 0.05), -0.1, 0.0)[0] == "shown, not judged"
    assert judged((1e-12,) * 4, (0.0,) * 3, None, 0.0)[0] == "agrees"
    assert judged((9.0, 5.0, 2.0, 1.0), (1, 1, 1), 1.0, 0.0)[0] == "shown, not judged"


def test_the_state_of_a_reader_is_taken_as_it_is_or_refused():
    model = make_model([Body((0.0, 0.0), 1.0)], (0.0, 0.0))
    state = conformance.checked_state(([[1, 2]], [3], [[4, 5]], [6]), model)
    assert state.x.dtype == float and state.omega.tolist() == [6.0]
