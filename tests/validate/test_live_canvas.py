"""The canvas of a live scene in a page without a kernel: colours, crowds, narrow pages, and pages that scroll.

Chromium, driven by playwright, shows one picture of a scene that was computed here.
"""

import json
import re
from functools import partial

import numpy as np
import pytest

from solutions.support.model import Body, Box, HalfSpace, make_model
from validate.notebook.live import canvas, widget
from validate.notebook.live.kinds import BallOnSpring
from validate.notebook.live.running import Running
from validate.notebook.live.simulation import Simulation, Tuning
from validate.subject.modules import SOLUTIONS

from .test_live_films import CHROMIUM
from .test_live_points import KINDS, SCENES
from .test_live_simulation import boxes

pytestmark = [pytest.mark.long,
              pytest.mark.skipif(not CHROMIUM, reason="there is no Chromium here: live scenes stay untested in a page")]

PAGE = """<!doctype html><meta charset="utf-8"><style>{css} body {{ margin: 0; color: #1d2429 }}</style>
<body data-jp-theme-light="true"><div id="above"></div><div id="cell"></div><script type="module">
const scene = {scene};
globalThis.numbers = new Float32Array({numbers});
globalThis.told = [];
{script}
let heard;
render({{ el: document.getElementById("cell"), model: {{ get: () => scene, send: message => told.push(message),
  on: (name, does) => {{ heard = does; }}, off: () => {{}} }} }});
globalThis.shows = playing => {{
  heard({{ kind: "status", playing, say: "", tone: "" }}, []);
  heard({{ kind: "frame" }}, [new DataView(numbers.buffer)]);
}};
shows(true);
</script>"""
INK = """name => { const root = document.querySelector(".live-scene"), stage = root.querySelector("canvas.stage");
  const probe = document.createElement("i"); probe.style.color = root.style.getPropertyValue(name); root.append(probe);
  const wanted = getComputedStyle(probe).color.match(/\\d+/g).map(Number); probe.remove();
  const pixels = stage.getContext("2d").getImageData(0, 0, stage.width, stage.height).data;
  let found = 0;
  for (let i = 0; i < pixels.length; i += 4)
    if (pixels[i + 3] > 60 && [0, 1, 2].every(k => Math.abs(pixels[i + k] - wanted[k]) < 40)) found++;
  return found; }"""         # pixels of the stage that have about the colour of that name
COLOUR = "name => document.querySelector('.live-scene').style.getPropertyValue(name)"
HEAD = re.findall(r'"(\w+)"', re.search(r"const HEAD = \[(.*?)\]", widget.LiveScene._esm, re.S)[1])
DRAWN = "document.querySelector('.live-scene')?.dataset.frame === '1'"


@pytest.fixture
def opened(browser, tmp_path):
    """opened(model or what runs, steps, wide): a page of that width that shows the scene after so many steps."""
    pages = []
    yield partial(page_of, browser, tmp_path, pages)
    for page in pages:
        assert page.faults == []
        page.close()


def page_of(browser, folder, pages, scene, steps=2, wide=1200):
    simulation = scene if isinstance(scene, Running) else Simulation(scene, SOLUTIONS, Tuning(), beside=False)
    for _ in range(steps):
        simulation.step()
    shown = widget.LiveScene(simulation, canvas.drawn(simulation, "boxes", 380, None))
    shown.sent = 1
    numbers = np.concatenate((shown._head(), *shown._rows())).tolist()
    text = PAGE.format(css=widget.LiveScene._css, scene=json.dumps(shown.scene), numbers=json.dumps(numbers),
                       script=widget.LiveScene._esm)
    shown.close()
    (folder / "page.html").write_text(text, encoding="utf-8")
    page = browser.new_page(viewport={"width": wide, "height": 800})
    page.faults = []
    page.on("pageerror", lambda error: page.faults.append(str(error)))
    pages.append(page)
    page.goto((folder / "page.html").as_uri())
    page.wait_for_function(DRAWN)
    return page


def test_colours_are_read_at_the_first_drawing_and_follow_the_theme(opened):
    """When `render` is called the canvas is not in the page yet, and has no style."""
    page, ours = opened(boxes()), canvas.COLOURS["ours"]
    dark = canvas.DARK[ours.lower().removeprefix("#")]
    assert page.evaluate(COLOUR, "--ours") == ours and page.evaluate(INK, "--ours") > 100
    page.evaluate("document.body.style.color = '#eee'; document.body.dataset.jpThemeLight = 'false';"
                  "document.documentElement.style.setProperty('--jp-content-font-color1', '#eee')")
    page.wait_for_function("document.querySelector('.live-scene').classList.contains('dark')")
    assert page.evaluate(COLOUR, "--ours") == dark != ours
    page.wait_for_timeout(100)
    assert page.evaluate(INK, "--ours") > 100


def crowd(n=200):
    """Boxes in rows of twenty above each other: each presses on the one below."""
    floor = Body((0.0, 0.0), shape=HalfSpace((0.0, 1.0)), mu=1.0, e=1.0)
    return make_model([floor, *(Body((0.3 * (k % 20), 0.1 + 0.2 * (k // 20)), 1.0, Box((0.12, 0.1)), mu=0.5)
                                for k in range(n))], (0.0, -9.81))


@pytest.mark.parametrize("wide", [1200, 390])
def test_the_forces_of_a_crowd_do_not_hide_its_bodies(opened, wide):
    """Two thirds of the outlines stay, and more; arrows with heads, as few bodies have them, leave half of them."""
    page = opened(crowd(), wide=wide)
    arrows, bodies = page.evaluate(INK, "--force"), page.evaluate(INK, "--ours")
    page.get_by_role("checkbox", name="contact forces").uncheck()
    page.wait_for_timeout(100)
    assert arrows > 0 and page.evaluate(INK, "--force") == 0
    assert bodies > 2.0 / 3.0 * page.evaluate(INK, "--ours")


@pytest.mark.parametrize("wide", [1200, 390])
def test_nothing_is_cut_off(opened, wide):
    page = opened(boxes(), wide=wide)
    over = page.evaluate("""[...document.querySelectorAll('.live-scene, .live-scene *')]
        .map(one => one.scrollWidth - one.clientWidth).reduce((a, b) => Math.max(a, b), 0)""")
    assert over <= 1 and page.evaluate("document.documentElement.scrollWidth") == wide


@pytest.mark.parametrize("of", SCENES)
def test_points_offer_neither_contact_forces_nor_pymunk(opened, of):
    """Points have neither, and the kernel would not know what to do."""
    page = opened(SCENES[of]())
    assert page.get_by_role("checkbox").count() == 0 and page.get_by_role("slider").count() >= 3
    page = opened(boxes())
    assert page.get_by_role("checkbox").count() >= 1


def test_a_scene_out_of_view_pauses_and_goes_on_when_it_is_seen_again(opened):
    page = opened(boxes())
    page.evaluate("told.length = 0; document.getElementById('above').style.height = '3000px'")
    page.wait_for_function("told.some(message => message.do === 'pause')")
    page.evaluate("shows(false); told.length = 0; document.getElementById('above').style.height = '0'")
    page.wait_for_function("told.some(message => message.do === 'play')")


def test_numbers_that_change_with_every_picture_are_shown_four_times_per_second(opened):
    page = opened(boxes())
    changes, seconds = page.evaluate("""async () => { let changes = 0; const began = performance.now();
      new MutationObserver(found => { changes += found.length; })
        .observe(document.querySelector('.live-scene .pace'), { childList: true, characterData: true, subtree: true });
      for (let k = 0; k < 30; k++) { shows(true); await new Promise(done => setTimeout(done, 17)); }
      return [changes, (performance.now() - began) / 1000]; }""")
    assert 1 <= changes <= 1 + seconds / 0.25


@pytest.mark.parametrize("wide", [1440, 390])
@pytest.mark.parametrize("of", KINDS)
def test_a_scene_of_one_function_can_be_touched_by_pointer_and_keys(opened, of, wide):
    scene = KINDS[of](SOLUTIONS)
    page = opened(scene, steps=30, wide=wide)
    assert page.evaluate("document.documentElement.scrollWidth") == wide and page.evaluate(INK, "--ours") > 50
    boxes = [page.get_by_role("checkbox", name=name).count() for name in ("contact forces", scene.rival or "pymunk")]
    assert boxes == [int(scene.contacts), int(bool(scene.rival))]
    assert not scene.rival or page.evaluate(INK, "--engine") > 20
    k = int(np.flatnonzero(scene.moves)[-1])
    x, y = page.evaluate("k => document.querySelector('.live-scene').where(k)", k)
    page.mouse.move(x + 1, y + 1)
    page.mouse.down()
    page.mouse.move(x + 20, y + 10, steps=3)
    page.wait_for_function("told.some(message => message.do === 'move')")
    page.mouse.up()
    page.keyboard.press("n")
    grabbed = page.evaluate("told.filter(message => message.do === 'grab').map(message => message.body)")
    assert grabbed == [k, int(np.flatnonzero(scene.moves)[0])]


def test_the_path_of_a_ball_is_drawn(opened):
    """The ball flies around in forty pictures and ends where it was."""
    page = opened(BallOnSpring(SOLUTIONS))
    before, place = page.evaluate(INK, "--ours"), len(HEAD) + 3
    page.evaluate("""([t, last, x]) => { const [x0, y0] = [numbers[x], numbers[x + 1]];
      for (let k = 1; k <= 40; k++) {
        numbers[t] = numbers[last] = 0.05 * k;
        numbers[x] = x0 * Math.cos(k * Math.PI / 20); numbers[x + 1] = y0 + 0.8 * Math.sin(k * Math.PI / 20);
        shows(true); } }""", [HEAD.index("t"), HEAD.index("last"), place])
    page.wait_for_timeout(200)
    assert page.evaluate(INK, "--ours") > before + 300
