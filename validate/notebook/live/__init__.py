"""A live scene below a cell: the learner's own simulator runs in the kernel, and pymunk runs the same Model beside it.

    from validate.notebook.live import live
    live(model)

Bodies can be grabbed and thrown.  A save of lessons/simulator.py, or of a lesson that it calls, is followed at once.
*Left out:* space.
"""

import os

from IPython.display import HTML

from solutions.checks import BadInput, check_not_negative
from solutions.support.model import Model

from .. import attempt, folder, saving
from .canvas import drawn, film_of
from .loops import LOOPS
from .simulation import Simulation, Tuning

FILM_ONLY = "WORKBOOK_LIVE"  # environment variable; "film": show a film, where no kernel will stay, as in the book
FILM_SECONDS = 4.0
BESIDE = {"pymunk": True, None: False}
WITHOUT = ("<p>A live scene needs anywidget: <code>pip install anywidget</code>, then restart the kernel. "
           "Here is a film of it.</p>")


def live(model, beside="pymunk", dt=1.0 / 120.0, sweeps=20, lesson="simulator", view=None, height=380, name="",
         play=True):
    """Return a live scene, which a cell shows if it is its last line; a film where nothing can be live.

    beside    "pymunk" or None;   dt [s];   sweeps over all contacts in a step, at most
    lesson    whose exercises the loop calls: "simulator"; "contact" and "impulses" get the rest as given
    view      (left, right, low, high) [m]; None: all bodies at the start
    height    of the canvas, at most [px];   play: begin at once
    Raises BadInput for a Model that our loop cannot run, and for settings that cannot be.
    """
    if not isinstance(model, Model):
        raise BadInput("the model of a live scene", type(model).__name__, "give what make_model returns")
    if beside not in BESIDE:
        raise BadInput("the engine beside a live scene", repr(beside), 'give "pymunk" or None')
    if lesson not in LOOPS:
        raise BadInput("the lesson of a live scene", repr(lesson), f"choose from: {', '.join(LOOPS)}")
    check_not_negative("the height of the canvas [px]", height)
    simulation = Simulation(model, folder(), Tuning(dt=dt, sweeps=sweeps), BESIDE[beside], lesson)
    if os.environ.get(FILM_ONLY) == "film":
        return film(simulation)
    try:
        from . import widget
    except ImportError:
        return film(simulation, WITHOUT)
    scene = widget.LiveScene(simulation, {**drawn(simulation, name, height, view), "play": bool(play)})
    widget.take_the_place(scene)
    return scene


def film(simulation, first=""):
    """Return the first seconds of a scene as a film; a sentence says what is not written yet."""
    def run():
        for _ in range(round(FILM_SECONDS / simulation.tuning.dt)):
            simulation.step()
            simulation.remember()
        return True
    attempt(run)
    found = film_of(simulation)
    return HTML(first + saving.film_html(found, 300)) if found else HTML(first)
