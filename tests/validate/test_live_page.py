"""Live scenes in a real JupyterLab: headless Chromium, driven by playwright, where both are installed.

pip install playwright installs no browser.  These tests take the Chromium of the system.
"""

import contextlib
import json
import os
import shutil
import socket
import subprocess
import sys
import time
import urllib.request

import nbformat
import pytest

from validate.subject.modules import ROOT, SOLUTIONS

from .test_live_films import CHROMIUM

LONGEST = 180_000            # until a page shows something, on a busy machine [ms]
CELL = """import sys
sys.path.insert(0, {root!r})
from solutions.support.model import Body, Box, Ball, HalfSpace, make_model
from validate.notebook.live import live
bodies = [Body((0.0, 0.0), shape=HalfSpace((0.0, 1.0)), mu=1.0, e=1.0)]
bodies += [Body((0.0, 0.1 + 0.2 * k), 1.0, Box((0.15, 0.1)), mu=0.5) for k in range(3)]
live(make_model(bodies, (0.0, -9.81)), name="three boxes", height=300)"""
FIRST_LINE = "    F, tau = load(t, x, q, v, omega, p)\n    return v + dt * p.inv_mass[:, None] * F,"

pytestmark = [pytest.mark.long, pytest.mark.xdist_group("notebooks"),
              pytest.mark.skipif(not CHROMIUM, reason="there is no Chromium here: live scenes stay untested in a page")]


@pytest.fixture(scope="module")
def server(tmp_path_factory):
    """(address of a JupyterLab, folder of the lessons that its kernels use)."""
    folder, lessons = tmp_path_factory.mktemp("lab"), tmp_path_factory.mktemp("lessons")
    for file in SOLUTIONS.glob("*.py"):
        shutil.copy(file, lessons)
    cell = nbformat.v4.new_code_cell(CELL.format(root=str(ROOT)), id="scene")
    about = {"kernelspec": {"name": "python3", "display_name": "Python 3", "language": "python"}}
    nbformat.write(nbformat.v4.new_notebook(cells=[cell], metadata=about), folder / "live.ipynb")
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    command = [sys.executable, "-m", "jupyterlab", f"--ServerApp.port={port}", "--no-browser", "--allow-root",
               "--IdentityProvider.token=", f"--ServerApp.root_dir={folder}", "--ServerApp.disable_check_xsrf=True"]
    environment = {"WORKBOOK_LESSONS": str(lessons), "JUPYTER_CONFIG_DIR": str(folder / ".config"),
                   "JUPYTER_DATA_DIR": str(folder / ".data"), "JUPYTER_RUNTIME_DIR": str(folder / ".run")}
    lab = subprocess.Popen(command, env={**os.environ, **environment}, stdout=subprocess.DEVNULL,
                           stderr=subprocess.DEVNULL)
    try:
        address, until = f"http://127.0.0.1:{port}", time.monotonic() + 1e-3 * LONGEST
        while not answers(address):
            assert time.monotonic() < until and lab.poll() is None, "JupyterLab does not start"
            time.sleep(0.5)
        yield address, lessons
    finally:
        lab.terminate()
        lab.wait(30)


def answers(address):
    with contextlib.suppress(OSError):
        urllib.request.urlopen(f"{address}/api", timeout=5.0).close()
        return True
    return False


@pytest.fixture
def page(server, browser):
    """A page with the notebook, whose cell was run."""
    context = browser.new_context(viewport={"width": 1200, "height": 900})
    page = context.new_page()
    page.faults = []
    page.on("pageerror", lambda error: page.faults.append(str(error)))
    page.goto(f"{server[0]}/lab/workspaces/w{time.time_ns()}/tree/live.ipynb", timeout=LONGEST)
    page.wait_for_selector(".jp-Notebook .jp-Cell", timeout=LONGEST)
    with contextlib.suppress(Exception):                              # "Would you like to receive news?"
        page.get_by_role("button", name="No", exact=True).click(timeout=2000)
    page.get_by_text("| Idle").wait_for(timeout=LONGEST)              # a cell that runs before its kernel does is lost
    run_cell(page)
    yield page
    assert page.faults == []
    context.close()


def run_cell(page):
    page.locator(".jp-Notebook .jp-Cell").first.click()
    page.keyboard.press("Control+Enter")
    page.wait_for_function("+(document.querySelector('.live-scene')?.dataset.t ?? 0) > 0.2", timeout=LONGEST)
    page.locator(".live-scene canvas").first.scroll_into_view_if_needed()


def shown(page, name):
    return page.evaluate("name => document.querySelector('.live-scene').dataset[name]", name)


def until(page, condition):
    page.wait_for_function(f"(() => {{ const scene = document.querySelector('.live-scene'), data = scene.dataset; "
                           f"return {condition}; }})()", timeout=LONGEST)


def place(page, body):
    """Where a body is in the page [px]."""
    return page.evaluate("""k => { const scene = document.querySelector('.live-scene');
        const box = scene.querySelector('canvas').getBoundingClientRect(), [x, y] = scene.where(k);
        return [x + box.left, y + box.top]; }""", body)


def test_a_body_is_thrown_with_the_mouse_and_nothing_is_told_to_jupyterlab_by_keys(page):
    x, y = place(page, 3)
    page.mouse.move(x, y)
    page.mouse.down()
    page.mouse.move(x + 60, y - 60, steps=10)
    until(page, "data.held === '3'")
    until(page, f"scene.where(3)[0] + scene.querySelector('canvas').getBoundingClientRect().left > {x + 20}")
    page.mouse.up()
    until(page, "data.held === '-1'")
    for key in ("m", "x", "d", "d", "b"):                              # they would change or delete the cell
        page.keyboard.press(key)
    assert page.locator(".jp-Notebook .jp-CodeCell").count() >= 1
    assert page.locator(".jp-Notebook .live-scene").count() == 1
    assert "live(make_model" in page.locator(".jp-Notebook .jp-CodeCell").first.inner_text()


def test_keys_take_a_body_pull_it_and_let_it_go_and_step(page):
    page.locator(".live-scene canvas.stage").focus()
    page.keyboard.press("n")
    until(page, "data.held === '1'")
    for _ in range(5):
        page.keyboard.press("ArrowRight")
    page.keyboard.press("Escape")
    until(page, "data.held === '-1'")
    page.keyboard.press(" ")
    until(page, "scene.querySelector('button').title.startsWith('Play')")
    t = float(shown(page, "t"))
    page.keyboard.press(".")
    until(page, f"Math.abs(data.t - {t} - 1 / 120) < 2e-3")
    page.keyboard.press(",")
    until(page, f"data.t < {t}")
    page.keyboard.press("r")
    until(page, "+data.t === 0")


def test_a_save_of_the_lesson_is_followed_and_an_error_is_one_sentence(page, server):
    file = server[1] / "simulator.py"
    good = file.read_text()
    try:
        file.write_text(good.replace(FIRST_LINE, "    1 / 0\n" + FIRST_LINE))
        until(page, "scene.querySelector('.say').textContent.includes('ZeroDivisionError: division by zero')")
        assert "\n" not in page.locator(".live-scene .say").inner_text()
    finally:
        file.write_text(good)
    t = shown(page, "t")
    until(page, f"data.t > {t} && scene.querySelector('.say').textContent === ''")


def test_a_cell_that_runs_twice_has_one_scene_and_a_page_that_is_loaded_again_has_it_too(page):
    page.evaluate("document.querySelector('.live-scene').dataset.first = ''")
    run_cell(page)
    page.wait_for_selector(".live-scene:not([data-first]) canvas", timeout=LONGEST)      # not what the first run showed
    assert page.locator(".live-scene").count() == 1
    with page.expect_response(lambda answer: answer.request.method == "PUT" and answer.ok, timeout=LONGEST):
        page.keyboard.press("Control+s")
    page.reload(timeout=LONGEST)
    page.wait_for_selector(".live-scene canvas", timeout=LONGEST)
    until(page, "+data.frame > 0")
    t = shown(page, "t")
    until(page, f"data.t !== '{t}'")


def test_a_finger_pulls_a_body_in_a_narrow_page_and_nothing_is_cut_off(page):
    page.set_viewport_size({"width": 390, "height": 844})
    page.locator(".jp-Notebook .jp-Cell").first.click()
    page.keyboard.press("Control+b")                                  # without the list of files beside it
    page.locator(".live-scene canvas").first.scroll_into_view_if_needed()
    page.wait_for_timeout(500)
    client, (x, y) = page.context.new_cdp_session(page), place(page, 3)
    touch = lambda kind, *points: client.send("Input.dispatchTouchEvent", {
        "type": kind, "touchPoints": [{"x": x, "y": y} for x, y in points]})
    touch("touchStart", (x, y))
    for k in range(1, 6):
        touch("touchMove", (x + 6 * k, y - 6 * k))
    until(page, "data.held === '3'")
    touch("touchEnd")
    until(page, "data.held === '-1'")
    wide = page.evaluate("""[...document.querySelectorAll('.live-scene, .live-scene *')]
        .map(one => one.scrollWidth - one.clientWidth).reduce((a, b) => Math.max(a, b), 0)""")
    assert wide <= 1


def test_a_film_of_what_was_seen_is_downloaded(page):
    with page.expect_download(timeout=LONGEST) as waited:
        page.get_by_role("button", name="Save the last thirty seconds").click()
    text = waited.value.path().read_text(encoding="utf-8")
    picture = json.loads(text.split('<script type="application/json"')[1].split(">", 1)[1].split("</script>")[0])
    assert [run["label"] for run in picture["films"]] == ["mine", "pymunk"] and picture["seconds"] > 0.1
