"""A live scene in an event loop, with a page of our own in place of the browser: nothing hangs, nothing leaks."""

import asyncio
import gc
import os
import re
import signal
import time
import weakref

import numpy as np
import pytest

from solutions.checks import BadInput
from solutions.support.model import Ball, Body, Box, HalfSpace, make_model
from validate.notebook.live import FILM_ONLY, canvas, live, widget
from validate.notebook.live.simulation import Simulation, Tuning
from validate.subject.modules import SOLUTIONS

from .test_live_simulation import FIRST_LINE, boxes, learner, with_line  # noqa: F401    learner is a fixture

PATIENCE = 300.0             # [s]: only a scene that hangs takes so long, on the busiest machine, too
HEAD = re.search(r"const HEAD = \[(.*?)\]", (widget.HERE / "live.js").read_text(encoding="utf-8"), re.S)[1]
HEAD = re.findall(r'"(\w+)"', HEAD)


class Page:
    """Shows a scene as live.js does: it acknowledges pictures and says that it is there."""

    def __init__(self, scene, answers=True):
        self.scene, self.answers = scene, answers
        self.frames, self.said, self.printed, self.films = [], [], [], []
        scene.send = self.take
        self.tell(do="hello", play=True)

    def take(self, content, buffers=None):
        kind = content["kind"]
        if kind == "frame":
            self.frames.append(np.frombuffer(buffers[0], "<f4"))
            if self.answers and len(self.frames) % 6 == 0:
                self.tell(do="ack", n=float(self.frames[-1][0]))
        elif kind == "status":
            self.said.append(content["say"])
        else:
            (self.printed if kind == "printed" else self.films).append(content)

    def tell(self, **message):
        self.scene._hear(self.scene, message, [])

    def head(self, name):
        return float(self.frames[-1][HEAD.index(name)])

    async def until(self, happened):
        """Wait until happened() is true, and say in between that the page is there."""
        end = time.monotonic() + PATIENCE
        while not happened():
            assert time.monotonic() < end, (self.said[-3:], len(self.frames))
            if self.answers:
                self.tell(do="here")
            await asyncio.sleep(0.02)

    async def runs(self):
        """Wait until the time of the scene has moved on."""
        t = self.scene.simulation.t
        await self.until(lambda: self.scene.simulation.t > t)


def scene_of(folder=SOLUTIONS, model=None, beside=False):
    simulation = Simulation(model or boxes(), folder, Tuning(), beside)
    return widget.LiveScene(simulation, {**canvas.drawn(simulation, "boxes", 300, None), "play": True})


@pytest.fixture(autouse=True)
def nothing_is_left():
    """No scene plays on after a test, and SIGINT has the handler that it had."""
    before = signal.getsignal(signal.SIGINT)
    yield
    assert not widget.playing and signal.getsignal(signal.SIGINT) is before
    widget.alive.clear()


def in_a_loop(test):
    """Run a coroutine function in a loop, as a kernel does, and close its scenes."""
    async def whole():
        scenes = []

        def opened(*arguments, answers=True, **more):
            scenes.append(scene_of(*arguments, **more))
            return Page(scenes[-1], answers)
        try:
            await test(opened)
        finally:
            for scene in scenes:
                scene.close()
            await asyncio.sleep(0.1)
            assert all(scene.task is None or scene.task.done() for scene in scenes)
    asyncio.run(whole())


# ---------------------------------------------------------------------------------------------- what it shows

def test_a_picture_has_what_live_js_reads():
    async def test(opened):
        page = opened(beside=True)
        await page.until(lambda: len(page.frames) > 3 and page.head("t") > 0.1)
        page.tell(do="pause")
        page.scene._picture()
        simulation, n, frame = page.scene.simulation, 3, page.frames[-1]
        m = int(page.head("forces"))
        assert len(frame) == len(HEAD) + 3 * n * 2 + 4 * m and m >= 2
        poses = frame[len(HEAD):len(HEAD) + 3 * n].reshape(n, 3)
        assert np.allclose(poses[:, :2], simulation.now().x, atol=1e-6)
        forces = frame[-4 * m:].reshape(m, 4)
        assert np.sum(np.abs(forces[:, 3])) == pytest.approx(3 * 9.81, rel=0.02)       # 2 m g on the floor, m g above
        assert page.head("energy") <= page.head("expected") + 1e-5 and page.head("held") == -1.0
    in_a_loop(test)


def test_the_hand_pulls_and_lets_go():
    async def test(opened):
        page = opened()
        page.tell(do="grab", body=2, place=[0.0, 0.0], target=[0.0, 0.8], n=7)
        await page.until(lambda: page.scene.simulation.now().x[2, 1] > 0.7)
        assert page.head("held") == 2.0 and page.head("echo") == 7.0
        page.tell(do="move", target=[0.0, 1.2], n=8)
        await page.until(lambda: page.scene.simulation.now().x[2, 1] > 1.1)
        page.tell(do="release")
        await page.until(lambda: page.scene.simulation.now().x[2, 1] < 0.9)
        assert page.head("held") == -1.0
    in_a_loop(test)


def test_pause_step_back_and_reset():
    async def test(opened):
        page = opened()
        await page.until(lambda: page.scene.simulation.t > 0.3)
        page.tell(do="pause")
        await asyncio.sleep(0.1)
        t = page.scene.simulation.t
        page.tell(do="step")
        assert page.scene.simulation.t == pytest.approx(t + 1 / 120) and not page.scene.runs
        page.tell(do="seek", to=0.1)
        assert page.scene.simulation.t == pytest.approx(0.1, abs=0.034) and page.head("last") > 0.25
        page.tell(do="reset")
        assert page.head("t") == page.head("last") == 0.0
    in_a_loop(test)


def test_a_setting_that_cannot_be_is_refused_in_a_sentence():
    async def test(opened):
        page = opened()
        page.tell(do="set", to={"mu": -1.0})
        assert page.said[-1].startswith("✗ friction μ [-] is -1")
        page.tell(do="grab", body=0, place=[0, 0], target=[0, 0], n=1)
        assert page.said[-1].startswith("✗ the body to grab is 0")
        page.tell(do="set", to={"g": 0.0, "speed": 0.5})
        assert page.scene.simulation.tuning.g == 0.0 and page.scene.speed == 0.5
        await page.runs()
    in_a_loop(test)


def test_a_film_of_what_was_seen_is_a_page():
    async def test(opened):
        page = opened(beside=True)
        page.tell(do="film")
        assert page.said[-1].startswith("Nothing has moved yet")
        await page.until(lambda: page.scene.simulation.t > 0.3)
        page.tell(do="film")
        text = page.films[0]["page"]
        assert text.count('<canvas data-picture="p') == 1 and '"label": "pymunk"' in text
    in_a_loop(test)


# ---------------------------------------------------------------------------------------------- the learner's code

def test_a_save_is_followed_within_half_a_second(learner):      # noqa: F811
    """Of the time that the file takes to load, which a busy machine makes long, only the rest is counted."""
    async def test(opened):
        page = opened(learner.folder, make_model([Body((0.0, 9.0), 1.0, Ball(0.1))], (0.0, -9.81)))
        await page.runs()
        simulation = page.scene.simulation
        load, spent = simulation.follow, []

        def timed():
            began = time.process_time()
            try:
                return load()
            finally:
                spent.append(time.process_time() - began)
        simulation.follow = timed
        learner("simulator", (FIRST_LINE, FIRST_LINE.replace("v + dt", "v - dt")))
        began = time.process_time()
        v = simulation.now().v[0, 1]
        await page.until(lambda: simulation.now().v[0, 1] > v)
        assert widget.LOOK + widget.FRAME < 0.5 and max(spent) < 0.35, (spent, time.process_time() - began)
    in_a_loop(test)


@pytest.mark.parametrize("line", ["1 / 0", "raise SystemExit", 'raise NotImplementedError("Exercise 10.1: a")'])
def test_an_error_is_one_sentence_below_the_canvas_and_the_next_save_goes_on(line, learner):      # noqa: F811
    async def test(opened):
        page = opened(learner.folder)
        await page.runs()
        learner("simulator", with_line(line))
        await page.until(lambda: page.scene.broken)
        assert page.said[-1].endswith("Save the file, and the scene goes on.") and "\n" not in page.said[-1]
        t, shown = page.scene.simulation.t, len(page.frames)
        await asyncio.sleep(0.3)
        assert page.scene.simulation.t == t and len(page.frames) <= shown + 1 and page.scene.runs
        learner("simulator")
        await page.runs()
        assert page.said[-1] == ""
    in_a_loop(test)


ENDLESS = """while True:
        try:
            x = x
        except Exception:
            pass"""


@pytest.mark.parametrize(("loop", "limit"), [(ENDLESS, "LONGEST"), ("__import__('time').sleep(1e6)", "LONGEST_WAIT")])
def test_an_endless_loop_is_stopped_and_told(loop, limit, learner, monkeypatch):      # noqa: F811
    """The limit is short for this loop only: on a busy machine other steps may take as long by the clock."""
    async def test(opened):
        page = opened(learner.folder)
        await page.runs()
        follow = page.scene.simulation.follow
        with monkeypatch.context() as patch:
            def limited():
                changed = follow()
                if changed:
                    patch.setattr(widget, limit, 0.5)
                return changed
            patch.setattr(page.scene.simulation, "follow", limited)
            learner("simulator", with_line(loop))
            await page.until(lambda: page.scene.broken)
        place = r"\(simulator.py, line \d+, in new_velocities_2d\)\."
        assert re.match(rf"✗ a step is still running after 0.5 s {place}", page.said[-1]), page.said
        learner("simulator")
        await page.runs()
    in_a_loop(test)


PRESSED = """import os, signal, threading
    threading.Timer(0.1, os.kill, (os.getpid(), signal.SIGINT)).start()
    while True: pass"""


def test_the_stop_button_ends_a_loop_that_hangs_and_play_goes_on(learner):      # noqa: F811
    """The loop itself lets it be pressed a moment later: then it surely runs."""
    async def test(opened):
        page = opened(learner.folder)
        await page.runs()
        learner("simulator", with_line(PRESSED))
        await page.until(lambda: page.said[-1] == widget.STOPPED)
        learner("simulator")
        page.tell(do="play")
        await page.runs()
    in_a_loop(test)


def test_the_stop_button_pauses_a_scene_between_its_steps():
    async def test(opened):
        page = opened()
        await page.runs()
        os.kill(os.getpid(), signal.SIGINT)
        await page.until(lambda: page.said[-1] == widget.STOPPED)
        assert not page.scene.runs
        page.tell(do="play")
        await page.runs()
    in_a_loop(test)


def test_slow_code_leaves_the_kernel_free_for_other_cells(learner):      # noqa: F811
    """A step of 0.1 s: another cell waits for one step at most, and the scene runs in slow motion."""
    async def test(opened):
        page = opened(learner.folder)
        await page.runs()
        learner("simulator", with_line("__import__('time').sleep(0.1)"))
        await page.until(lambda: page.scene.cost > 0.05)
        for _ in range(5):
            t = page.scene.simulation.t
            await asyncio.sleep(0)
            assert page.scene.simulation.t < t + 1.5 / 120.0
        await page.until(lambda: page.head("pace") < 0.5)
    in_a_loop(test)


def test_what_a_step_prints_is_shown_below_the_scene(learner, capsys):      # noqa: F811
    async def test(opened):
        page = opened(learner.folder)
        await page.runs()
        learner("simulator", with_line("print('t is', t)"))
        await page.until(lambda: page.printed)
        assert "t is" in page.printed[-1]["text"]
    in_a_loop(test)
    assert "t is" not in capsys.readouterr().out


# ---------------------------------------------------------------------------------------------- pages and cells

def test_a_page_that_does_not_answer_gets_no_flood_and_pauses_the_scene(monkeypatch):
    monkeypatch.setattr(widget, "UNSEEN", 1.0)

    async def test(opened):
        page = opened(answers=False)
        await page.until(lambda: not page.scene.runs)
        assert len(page.frames) <= widget.IN_FLIGHT + 1 and page.scene.wanted
        page.answers = True
        page.tell(do="here")                                          # the page is back
        await page.runs()
    in_a_loop(test)


def test_far_away_the_strongest_forces_are_sent_and_no_more_bytes_than_the_budget(monkeypatch):
    """Jupyter stops a kernel that sends more than 1 MB/s."""
    monkeypatch.setattr(widget, "MOST_FORCES", 2)
    monkeypatch.setattr(widget, "PER_SECOND", 400.0)                 # of pictures of some 200 bytes: every half second

    async def test(opened):
        page = opened()
        await page.until(lambda: page.scene.simulation.t > 0.3)
        sent = len(page.frames)
        await page.until(lambda: page.scene.simulation.t > 0.6)
        assert len(page.frames) <= sent + 2 + 0.3 / page.scene.pace
        forces = page.scene.simulation.forces()
        page.tell(do="pause")
        page.scene._picture()
        assert page.head("forces") == 2.0 < len(forces)
        shown = np.hypot(*page.frames[-1][-8:].reshape(2, 4)[:, 2:].T)
        sizes = np.hypot(*page.scene.simulation.forces()[:, 2:].T)
        assert np.allclose(np.sort(shown), np.sort(sizes)[-2:], rtol=1e-5)
    in_a_loop(test)


def test_a_page_that_is_closed_pauses_the_scene_and_one_that_is_loaded_again_gets_a_picture():
    async def test(opened):
        page = opened()
        await page.runs()
        page.tell(do="gone")
        assert not page.scene.runs
        await asyncio.sleep(0.1)
        t, shown = page.scene.simulation.t, len(page.frames)
        page.tell(do="hello", play=False)
        assert page.scene.simulation.t == t and len(page.frames) == shown + 1
        page.tell(do="play")
        await page.runs()
    in_a_loop(test)


def test_a_page_that_is_loaded_again_goes_on_unless_the_reader_has_paused_the_scene():
    async def test(opened):
        page = opened()
        await page.runs()
        page.tell(do="gone")
        page.tell(do="hello", play=True)
        await page.runs()
        assert sum(task.get_coro().__name__ == "_run" for task in asyncio.all_tasks()) == 1
        page.tell(do="pause")
        page.tell(do="gone")
        page.tell(do="hello", play=True)
        assert not page.scene.runs
    in_a_loop(test)


class Shell:
    """As much of IPython as a cell needs to be known by."""

    def __init__(self, cell, request):
        self.parent = {"metadata": {"cellId": cell}, "header": {"msg_id": request}}

    def get_parent(self):
        return self.parent


def test_a_cell_that_runs_twice_has_one_scene(monkeypatch):
    async def test(opened):
        shown = []
        for request in range(3):
            monkeypatch.setattr(widget, "get_ipython", lambda request=request: Shell("cell", request))
            shown.append(opened())
            widget.take_the_place(shown[-1].scene)
            await shown[-1].runs()
        assert [page.scene.runs for page in shown] == [False, False, True]
        assert [page.scene.comm is None for page in shown] == [True, True, False]
        assert len(widget.playing) == 1 and len(widget.alive["cell"]) == 1
    in_a_loop(test)


def test_two_scenes_of_one_cell_both_run(monkeypatch):
    monkeypatch.setattr(widget, "get_ipython", lambda: Shell("cell", "one request"))

    async def test(opened):
        pages = [opened(), opened()]
        for page in pages:
            widget.take_the_place(page.scene)
        for page in pages:
            await page.runs()
    in_a_loop(test)


def test_closed_scenes_leave_nothing_behind():
    kept = []

    async def test(opened):
        for _ in range(3):
            page = Page(scene_of(beside=True))
            page.tell(do="grab", body=1, place=[0, 0], target=[1, 1], n=1)
            await page.runs()
            page.scene.close()
            kept.append(weakref.ref(page.scene.simulation))
            await asyncio.sleep(0.1)
    in_a_loop(test)
    gc.collect()
    assert [one() for one in kept] == [None] * 3


# ---------------------------------------------------------------------------------------------- the function `live`

@pytest.mark.parametrize(("change", "named"), [({"model": [1]}, "the model of a live scene"),
                                               ({"beside": "havok"}, "the engine beside a live scene"),
                                               ({"lesson": "juggling"}, "the lesson of a live scene"),
                                               ({"dt": 0.0}, "dt"), ({"sweeps": 0}, "number of sweeps"),
                                               ({"height": -1}, "the height of the canvas")])
def test_live_refuses_what_cannot_be_in_one_sentence(change, named):
    with pytest.raises(BadInput, match=re.escape(named)):
        live(**{"model": boxes(), **change})


def test_where_no_kernel_stays_a_live_scene_is_a_film(monkeypatch):
    monkeypatch.setenv(FILM_ONLY, "film")
    monkeypatch.setenv("WORKBOOK_LESSONS", str(SOLUTIONS))
    monkeypatch.setattr("validate.notebook.live.FILM_SECONDS", 0.2)
    shown = live(boxes()).data
    assert shown.count('<canvas data-picture="p') == 1 and '"label": "pymunk"' in shown


def test_without_anywidget_a_sentence_says_what_is_missing(monkeypatch):
    monkeypatch.setitem(__import__("sys").modules, "validate.notebook.live.widget", None)
    monkeypatch.delattr("validate.notebook.live.widget")
    monkeypatch.setenv("WORKBOOK_LESSONS", str(SOLUTIONS))
    monkeypatch.setattr("validate.notebook.live.FILM_SECONDS", 0.1)
    assert "pip install anywidget" in live(boxes()).data


def test_the_view_holds_all_bodies_and_the_floor():
    model = make_model([Body((0.0, 0.0), shape=HalfSpace((0.0, 1.0), 0.5)), Body((3.0, 2.0), 1.0, Box((0.2, 0.1)))],
                       (0.0, -9.81))
    left, right, low, high = canvas.view_of(model)
    assert left < 2.8 and right > 3.2 and low < -0.5 and high > 2.1
