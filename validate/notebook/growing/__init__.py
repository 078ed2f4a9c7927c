"""One scene that grows through the course: the same short film, without and with the function just written.

    grow("7.4")          # beside each other: the room without impulse_size, and with yours
    grow("7")            # without and with all that the scene has of lesson 7
    show(finished())     # the whole room

`room.py` describes the room as a Model, `actors.py` moves what is in it, `swaps.py` has the exercises that stand in
the place of another one there, and `parts.py` says which exercise writes what.
"""

import base64
import json
import uuid
from functools import cache, partial
from html import escape
from pathlib import Path

import numpy as np
from IPython.display import HTML, display

from solutions.checks import BadInput

from ...report import plots
from ...subject import modules, needs
from .. import _say, attempt, mine, saving, stored
from . import actors, room
from .parts import PARTS, borrowed, lesson_of

SCRIPTS = (Path(plots.__file__).parent / "player.js", Path(__file__).parent / "grow.js")
OFF, ON, ALONE = "#D55E00", "#0072B2", "#009E73"           # colours of what a part moves: without it, with it; one view
FIRST = {"curtain": 1, "ball": 1, "box": 3, "book": 3, "picture": 4, "die": 5, "top": 5, "stack": 9, "parcel": 10,
         "arm": 11}                                # lesson in which a thing comes into the room
MOVES = {"ball": 7, "box": 3, "book": 3, "picture": 4, "die": 5, "top": 5, "stack": 10, "parcel": 10}
                                                   # lesson after which it moves in all later films
WRITER = {"ball": "7.10", "box": "3.7", "book": "3.16", "picture": "4.11", "die": "5.10", "top": "5.15",
          "stack": "10.6", "parcel": "10.6"}       # part whose actor moves it then


def grow(part):
    """Show the scene without and with an exercise of yours, or with all exercises of a lesson that it has.

    Where they are not written yet, only the left film is shown, and a sentence says what it waits for.
    """
    chosen = [number for number, one in PARTS.items()
              if part == number or (one.whole and part == str(lesson_of(number)))]
    if not chosen:
        _say(str(BadInput("a part of the scene", repr(part), f"choose from: {', '.join(PARTS)}")))
        return
    names = {number: needs.table()[number]["function"] for number in chosen}
    lesson = mine(needs.table()[chosen[0]]["lesson"])
    without = moved(chosen, {number: PARTS[number].off for number in chosen})
    functions = {number: getattr(lesson, name) for number, name in names.items()}
    yours = attempt(lambda: checked(moved(chosen, functions), without))
    views = [(PARTS[chosen[0]].without if len(chosen) == 1 else f"without lesson {part}", OFF, without)]
    if yours is not None:
        views.append((f"with your {' and '.join(names.values())}", ON, yours))
    show_views(views, others(lesson_of(chosen[0]), without))


def moved(chosen, functions):
    """Return {thing: places} of all things that the chosen parts move, with these functions in their places."""
    use, found = {**borrowed(lesson_of(chosen[0])), **functions}, {}
    with np.errstate(all="ignore"):
        for actor in dict.fromkeys(PARTS[number].actor for number in chosen):
            found.update(actor(use))
    return found


def checked(found, like):
    """Return what was moved.  Raises ArithmeticError where your function has left no numbers to draw."""
    for thing, places in found.items():
        if np.shape(places) != np.shape(like[thing]) or not np.all(np.isfinite(places)):
            raise ArithmeticError(f"the {thing} is nowhere: your function returns what is no place or no number")
    return found


# ---------------------------------------------------------------------------------------------- the rest of the room

def others(lesson, shown):
    """Return {thing: places} of all things that are in the room by this lesson and that no part here moves."""
    start = at_start()
    there = [thing for thing in FIRST if FIRST[thing] <= lesson and thing not in shown]
    return {thing: recorded(thing) if MOVES.get(thing, lesson) < lesson else start[thing] for thing in there}


def recorded(thing):
    """Return how the worked answers move a thing; in a copy without them, as `release` stored it."""
    kept = stored("00")
    return kept[thing] if kept else by_worked_answers(WRITER[thing])[thing]


@cache
def by_worked_answers(number):
    """Return what the actor of a part moves, with worked answers in the places of all parts."""
    return PARTS[number].actor(worked())


@cache
def worked():
    """Return {exercise: worked answer} of all parts."""
    return {number: getattr(modules.bind(needs.table()[number]["lesson"]), needs.table()[number]["function"])
            for number in PARTS}


@cache
def at_start():
    """Return {thing: places} with one picture of each thing before anything moves."""
    still = {"curtain": actors.flat(room.hung(room.SPREAD))[None], "arm": room.joints(room.REST)[None]}
    for part in ("7.4", "3.7", "3.16", "4.5", "5.10", "5.15", "9.4", "10.1"):
        still.update({thing: places[:1] for thing, places in moved([part], {part: PARTS[part].off}).items()})
    return still


def finished():
    """Return {thing: places} of the whole room, by the worked answers of all lessons."""
    use = worked()
    cloth = partial(actors.constrained, {**use, "8.11": PARTS["8.11"].off})
    found = actors.arm(use, cloth)
    for number in dict.fromkeys(WRITER.values()):
        found.update(by_worked_answers(number))
    return found


# ---------------------------------------------------------------------------------------------- films

def walls():
    """Return the lines of what never moves."""
    sill, rail = room.ROOM.bodies[room.SILL], room.ROOM.bodies[room.RAIL]
    pole = room.CORNER[:2] + np.array([(-0.1, 0.0), (room.COLS * room.CELL, 0.0)])
    board = sill.x + actors.corners(np.array(sill.shape.half))
    bar = rail.x + rail.shape.radius * actors.circle(8)
    chest = [room.LID[0], room.LID[1], (room.LID[0][0], 0.0), room.LID[0]]
    floor = [(room.SIDES[0], 0.0), (room.SIDES[1], 0.0)]
    return [np.round(line, 3).tolist() for line in (floor, pole, [*board, board[0]], [*bar, bar[0]], chest)]


def actor(thing, places, shown):
    """Return a thing as data for a film; far outside of the picture it need not be drawn where it is."""
    frames = np.clip(np.nan_to_num(np.asarray(places, float)), -9.0, 9.0)
    millimetres = np.round(1000.0 * frames).astype("<i2")              # a pixel shows 3 mm or more
    return {"frames": base64.b64encode(millimetres.tobytes()).decode(), "links": actors.LINES[thing], "shown": shown}


def show_views(views, rest, height=300):
    """Show films beside each other: (label, colour, {thing: places}) of each, and {thing: places} of the rest."""
    name = f"g{uuid.uuid4().hex}"
    picture = {"seconds": room.SECONDS, "sides": room.SIDES, "walls": walls(),
               "rest": [actor(thing, places, False) for thing, places in rest.items()],
               "views": [{"label": label, "colour": colour,
                          "actors": [actor(thing, places, True) for thing, places in found.items()]}
                         for label, colour, found in views]}
    said = " Beside it: ".join(f"{label}; it shows {', '.join(found)}." for label, _, found in views)
    canvas = (f'<canvas data-growing="{name}" role="img" aria-label="{escape(f"Film of the room, {said}")}" '
              f'style="width:100%;max-width:46rem;height:{height}px;background:#f6f7f8"></canvas>')
    data = json.dumps(picture, separators=(",", ":"), ensure_ascii=False)
    display(HTML(saving.keeping_keys(canvas) + f'<script type="application/json" id="{name}">{data}</script>'
                 + "".join(f"<script>{script.read_text(encoding='utf-8')}</script>" for script in SCRIPTS)))


def show(found, label="the whole room"):
    """Show one film of {thing: places}."""
    show_views([(label, ALONE, found)], {}, height=480)
