"""Films in a notebook keep their keys from JupyterLab.  Chromium, without a window, runs the film as a page has it."""

import json
import re
import shutil
import subprocess

import pytest

from validate import notebook
from validate.scenes import drawing

CHROMIUM = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)
LONGEST = 120                # of one page [s]
needs_chromium = pytest.mark.skipif(not CHROMIUM, reason="there is no Chromium here: the keys of films stay untested")

# Presses each key in each part of the film that can have the focus, and writes what reached the page around it.
PRESS = """
const film = document.getElementById("cell"), reached = [];
film.addEventListener("keydown", event => reached.push(event.key));
addEventListener("load", () => setTimeout(() => {
  const parts = [...film.querySelectorAll("canvas, button, input, select, [data-space]")];
  for (const part of parts) for (const press of PRESSES)
    part.dispatchEvent(new KeyboardEvent("keydown", {...press, bubbles: true}));
  const said = document.createElement("pre");
  said.id = "said";
  said.textContent = JSON.stringify({parts: parts.map(part => part.tagName), reached});
  document.body.append(said);
}, 100));
"""


def pressed(html, keys, folder):
    """{parts of the film, keys that reached the page}, in a page that has the film in a cell."""
    page = folder / "page.html"
    script = PRESS.replace("PRESSES", json.dumps(keys))
    page.write_text(f'<!doctype html><meta charset="utf-8"><body><div id="cell">{html}</div><script>{script}</script>')
    shown = subprocess.run([CHROMIUM, "--headless", "--no-sandbox", f"--user-data-dir={folder / 'user'}",
                            "--force-prefers-reduced-motion", "--virtual-time-budget=300", "--dump-dom", page.as_uri()],
                           capture_output=True, text=True, timeout=LONGEST).stdout
    found = re.search(r'<pre id="said">(.*?)</pre>', shown, re.S)
    assert found, shown[-2000:]
    return json.loads(found[1])


@pytest.fixture
def shown(monkeypatch):
    """The HTML of what a notebook displays."""
    found = []
    monkeypatch.setattr("validate.notebook.display", lambda one: found.append(one.data))
    return found


def in_the_plane():
    frames = [[[0.0, 0.0]], [[1.0, 0.0]]]
    notebook.play({"truth": frames, "mine": frames}, 1.0)


def in_space():
    poses = [[[x, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0]] for x in (0.0, 1.0)]
    notebook.show3d([drawing.sphere(0.5)], {"mine": poses}, 1.0)


SHORTCUTS = [{"key": key} for key in (*"mxdabcvyz0 .,", "Enter", "ArrowUp")]       # of JupyterLab
OTHERS = [{"key": "s", "ctrlKey": True}, {"key": "s", "metaKey": True}, {"key": "Escape"},
          {"key": "Enter", "shiftKey": True}]


@needs_chromium
def test_only_keys_with_a_modifier_and_those_that_leave_a_film_reach_the_page(shown, tmp_path):
    """Of JupyterLab's, M would turn the cell into text, X would cut it, and two D would delete it."""
    in_the_plane()
    found = pressed(shown[0], [*SHORTCUTS, *OTHERS], tmp_path)
    assert set(found["parts"]) >= {"CANVAS", "BUTTON", "INPUT", "SELECT"}
    assert found["reached"] == ["s", "s", "Escape", "Enter"] * len(found["parts"])


@needs_chromium
def test_no_shortcut_of_jupyterlab_reaches_it_from_a_film_in_space(shown, tmp_path):
    in_space()
    found = pressed(shown[0], SHORTCUTS, tmp_path)
    assert found["parts"] and found["reached"] == []
