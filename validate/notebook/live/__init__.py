"""A live scene below a cell: the learner's own code runs in the kernel, and the pointer is a hand.

    from validate.notebook.live import live
    live(model)                       # bodies, by the learner's simulator; pymunk runs the same Model beside it
    live(network, start=x)            # a net of springs, or links that are projected
    live(arm)                         # an arm that follows the pointer
    live(BallOnSpring)                # a scene of one function, from kinds.py or solids.py

A save of the lesson, or of one that it calls, is followed at once.  *Left out:* space.
"""

import os

from IPython.display import HTML, display

from solutions.checks import BadInput, check_not_negative
from solutions.support.model import Model

from ...engines.products import PYMUNK
from .. import attempt, folder, saving
from .canvas import drawn, film_of
from .loops import LOOPS
from .points import NETWORKS, Arm, Network
from .simulation import Simulation, Tuning
from .touched import Touched

FILM_ONLY = "WORKBOOK_LIVE"  # environment variable; "film": show a film, where no kernel will stay, as in the book
FILM_SECONDS = 4.0
BESIDE = {"pymunk": True, None: False}
WITHOUT = ("<p>A live scene needs anywidget: <code>pip install anywidget</code>, then restart the kernel. "
           "Here is a film of it.</p>")


def live(model, beside="pymunk", dt=1.0 / 120.0, sweeps=20, lesson="simulator", view=None, height=380, name="",
         play=True, start=None, method=""):
    """Return a live scene, which a cell shows if it is its last line; a film where nothing can be live.

    model     a Model; a SpringNetwork or a ConstraintNetwork; an Arm2D; a class of kinds.py or solids.py
    beside    "pymunk" or None;   dt [s];   sweeps over all contacts in a step, at most
    lesson    of a Model: whose exercises the loop calls: "simulator"; "contact" and "impulses" get the rest as given
    view      (left, right, low, high) [m]; None: all bodies at the start
    height    of the canvas, at most [px];   play: begin at once
    start     positions (n, 2) of the points of a network [m]; angles (n,) of an arm [rad]; or None: what the kind has
    method    the name of the learner's function, for all but a Model
    Raises BadInput for a model that the learner's code cannot run, and for settings that cannot be.
    """
    check_not_negative("the height of the canvas [px]", height)
    if isinstance(model, Model):
        simulation = of_model(model, beside, dt, sweeps, lesson)
    elif isinstance(model, type) and issubclass(model, Touched):
        simulation = model(folder(), method, start)
    else:
        simulation = of_points(model, start, method, dt)
    if os.environ.get(FILM_ONLY) == "film":
        return film(simulation)
    try:
        from . import widget
    except ImportError:
        return film(simulation, WITHOUT)
    shown = widget.LiveScene(simulation, {**drawn(simulation, name, height, view), "play": bool(play)})
    widget.take_the_place(shown)
    return shown


def of_model(model, beside, dt, sweeps, lesson):
    """Return the Simulation of a Model.  Raises BadInput for settings that cannot be."""
    if beside not in BESIDE:
        raise BadInput("the engine beside a live scene", repr(beside), 'give "pymunk" or None')
    if lesson not in LOOPS:
        raise BadInput("the lesson of a live scene", repr(lesson), f"choose from: {', '.join(LOOPS)}")
    return Simulation(model, folder(), Tuning(dt=dt, sweeps=sweeps), BESIDE[beside] and there(), lesson)


def there():
    """Return whether pymunk is installed; where it is not, a browser above all, say so."""
    if PYMUNK.installed():
        return True
    display(HTML("<p>pymunk is not installed here, so this scene runs without it.</p>"))
    return False


def of_points(model, start, method, dt):
    """Return the Network or the Arm.  Raises BadInput for anything else."""
    kind = type(model).__name__                    # a notebook may have the record from its own copy of a lesson
    if kind == "Arm2D":
        return Arm(model, start, folder(), method)
    if kind in NETWORKS:
        if start is None:
            raise BadInput("the start of a live network", start, "give the positions of its points")
        return Network(model, start, folder(), method, dt)
    remedy = "give what make_model returns, a network, an Arm2D, or a class of kinds.py or solids.py"
    raise BadInput("the model of a live scene", kind, remedy)


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
