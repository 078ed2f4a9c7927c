"""What must hold of the repository itself."""

import contextlib
import io
import re
import tomllib
from hashlib import sha256

from validate.modules import ROOT, SOLUTIONS


def test_the_lock_names_only_the_public_index():
    hosts = set(re.findall(r"https?://([^/\"]+)", (ROOT / "uv.lock").read_text()))
    assert hosts <= {"pypi.org", "files.pythonhosted.org"}
    assert "://" not in (ROOT / "constraints.txt").read_text()


def test_both_locks_hold_the_same_versions():
    locked = {(p["name"], p["version"]) for p in tomllib.loads((ROOT / "uv.lock").read_text())["package"]
              if "registry" in p["source"]}
    pinned = set(re.findall(r"^([\w.-]+)==([^ ;\n]+)", (ROOT / "constraints.txt").read_text(), flags=re.M))
    assert pinned <= locked and len({n for n, _ in pinned}) >= 100


def test_solutions_import_nothing_but_numpy_typing_and_their_siblings():
    for path in SOLUTIONS.rglob("*.py"):
        for line in path.read_text().splitlines():
            if re.match(r"(import|from) ", line):
                assert re.match(r"import numpy as np$|from typing import NamedTuple$|from \.[\w.]+ import ",
                                line), f"{path.name}: {line}"


def test_every_lesson_has_its_notebook_tests_mutants_and_scenes():
    from validate import modules
    for name in modules.lesson_names():
        assert list((ROOT / "notebooks").glob(f"*_{name}.ipynb")), name
        assert (ROOT / "tests" / "lessons" / f"test_{name}.py").is_file()
        assert (ROOT / "tests" / "mutants" / f"{name}.py").is_file()
        assert any(modules.bind_scene(s).lesson == name for s in modules.scene_names())


def test_the_player_in_space_was_built_from_its_source_and_can_stand_inside_a_page():
    folder = ROOT / "validate" / "report"
    bundle = (folder / "player3d.js").read_text()
    sources = (folder / "player3d" / "source.js").read_bytes() + (folder / "player.js").read_bytes()
    assert sha256(sources).hexdigest()[:16] in bundle.splitlines()[0]
    assert "</script" not in bundle and "SPDX-License-Identifier: MIT" in bundle


def test_no_text_names_a_lesson_that_there_is_not():
    from validate import modules
    texts = [(SOLUTIONS / f"{name}.py").read_text() for name in modules.lesson_names()]
    there = {int(re.match(r'"""Lesson (\d+)', text)[1]) for text in texts}
    assert there == set(range(1, len(there) + 1))
    folders = (SOLUTIONS, ROOT / "validate", ROOT / "notebooks", ROOT / "docs", ROOT / "tests")
    files = [ROOT / "README.md", ROOT / "CONTRIBUTING.md"]
    files += [path for folder in folders for path in folder.rglob("*")
              if path.suffix in (".py", ".md", ".ipynb", ".html")]
    for path in files:
        text = path.read_text(encoding="utf-8")
        known = there | {int(number) for number in re.findall(r'^"""Lesson (\d+)', text, re.M)}      # its own example
        for named in re.findall(r"\blessons? (\d+(?:(?:, | and | to |–)\d+)*)", text, re.I):
            assert {int(number) for number in re.findall(r"\d+", named)} <= known, f"{path}: lesson {named}"


def test_the_readme_shows_what_its_example_prints():
    text = (ROOT / "README.md").read_text()
    code, printed = re.search(r"<!-- example -->\n```python\n(.*?)```\n\n```\n(.*?)```", text, re.S).groups()
    said = io.StringIO()
    with contextlib.redirect_stdout(said):
        exec(code, {})
    assert said.getvalue() == printed


def test_no_grading_test_and_no_answer_needs_an_index_of_64_bits():
    """In WebAssembly an index has 32 bits, and np.bincount refuses the 64 bits of our pairs and contacts."""
    for path in (*SOLUTIONS.rglob("*.py"), *(ROOT / "tests" / "lessons").glob("*.py")):
        for call in re.findall(r"np\.bincount\(.*", path.read_text()):
            assert "astype(np.intp)" in call, f"{path.name}: {call}"
