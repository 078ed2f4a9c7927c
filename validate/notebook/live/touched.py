"""What live scenes of a single function share: its sliders, its outlines, and the exact motion beside it.

A kind of scene is one class of `kinds.py` or `solids.py`.  It says what is drawn and what the function is called with.
"""

from collections import namedtuple

import numpy as np

from solutions.checks import BadInput, finite_number

from ...subject.loading import part
from .hand import WEIGHT
from .running import Running, Seen, check_found

AROUND = np.linspace(0.0, 2.0 * np.pi, 25)[:-1]      # corners of a disc in a film [rad]


class Touched(Running):
    """One function of a lesson at work.

    A kind defines `lesson`, `method`, `knobs`, `view`, `bodies`, and the methods `begin`, `moved`, `seen` and
    `energy`; with a `rival`, the name of the exact motion beside it, also `exact`.
    """

    measured = "energy", "J", "at the start, plus work of the hand:"     # names and unit of `energy` and `expected`
    method, rival, trail, anywhere, contacts = "", "", -1, -1, False
    links: tuple = ()
    springs: tuple = ()
    planes: tuple = ()

    def __init__(self, folder, method="", start=None):
        super().__init__(folder, tuning_of(self.knobs))
        self.method, self.first = method or self.method, self.begin(start)
        self.moves = [body["moves"] for body in self.bodies]
        self.beside = bool(self.rival)
        self.reset()

    def load_code(self):
        """Take the function, and the lesson that it is from."""
        self.module = self.code.load(self.lesson)
        self.function = part(self.module, self.method)

    def reset(self):
        """Return to the start."""
        self.true, self.engine_state = self.first, None
        super().reset()

    def set(self, **changes):
        """Change the tuning; what is there stays, and the exact motion begins anew from it."""
        tuning, before = checked(self.tuning._replace(**changes), self.knobs), self.energy()
        self.tuning, self.true = tuning, self.state
        self.given += self.energy() - before

    def seek(self, t):
        """Return to the kept moment that is nearest to t; the exact motion begins there anew."""
        super().seek(t)
        self.true = self.state

    def show_beside(self, on):
        """Show the exact motion, from here, or hide it."""
        self.beside, self.true = bool(on and self.rival), self.state
        self.engine_state = self.now() if self.beside else None

    def advance(self):
        """Advance by dt with the learner's function; return (state, work of the hand)."""
        after, work = self.moved(self.state)
        for name, found, before in zip(after._fields, after, self.state, strict=True):
            check_found(f"{name}: number", found, before, self.t)
        after = type(after)(*(np.array(found, float) for found in after))
        self.true = after if self.grip is not None or not self.beside else self.exact(self.true)
        there = self.seen(self.true) if self.beside else None
        self.engine_state = there if there and np.all(np.isfinite(there.x)) else None
        return after, work

    def now(self):
        """Return where everything is that is drawn."""
        return self.seen(self.state)

    def apart(self):
        """Return how far the exact motion is at most from the learner's [m]."""
        if self.engine_state is None:
            return 0.0
        return float(np.max(np.hypot(*(self.now().x - self.engine_state.x).T)))

    def drawn(self):
        """Return what the canvas has to know."""
        names = ("view", "bodies", "links", "knobs", "springs", "planes", "trail", "anywhere", "contacts", "rival")
        says = {**dict(zip(("energy", "unit", "expected"), self.measured, strict=True)), "overlap": ""}
        return {**{name: getattr(self, name) for name in names}, "says": says, "beside": self.rival,
                "engine": bool(self.rival), "weight": WEIGHT}

    def pictures(self):
        """Return (seconds, links, {"mine": [(n, 2), …]}) of what is kept, for a film."""
        outlines, links, starts = [], [], []
        for body in self.bodies:
            points = np.array(body["points"] or [(0.0, 0.0)])
            if body["round"]:
                points = body["round"] * np.column_stack((np.cos(AROUND), np.sin(AROUND)))
            first, n = sum(map(len, outlines)), len(points)
            links += [(first + k, first + (k + 1) % n) for k in range(n if body["closed"] else n - 1)]
            starts.append(first)
            outlines.append(points)
        links += [(starts[a], starts[b]) for a, b in self.links]
        frames = [np.vstack(list(map(placed, outlines, *self.seen(one.state)))) for one in self.past]
        return self.past[-1].t - self.past[0].t, links, {"mine": frames}


def placed(points, x, q):
    """Return the points (n, 2) of an outline whose body is at x and turned by q."""
    c, s = np.cos(q), np.sin(q)
    return x + points @ np.array(((c, s), (-s, c)))


def outline(points, closed=True, fixed=False, moves=True, radius=0.0):
    """Return a body as the canvas draws it; with a radius it is a disc, which can be taken everywhere."""
    return {"points": [list(map(float, one)) for one in points], "closed": closed, "fixed": fixed, "round": radius,
            "moves": moves}


def disc(radius, **more):
    """Return a disc as the canvas draws it."""
    return outline([(0.0, 0.0)], radius=radius, **more)


def rectangle(width, height, **more):
    """Return a rectangle about its centre as the canvas draws it."""
    x, y = 0.5 * width, 0.5 * height
    return outline([(x, y), (-x, y), (-x, -y), (x, -y)], **more)


def seen_at(*places, turns=None):
    """Return Seen of bodies at these places; without turns, none has turned."""
    return Seen(np.array(places, float), np.zeros(len(places)) if turns is None else np.array(turns, float))


def tuning_of(knobs):
    """Return the values of the sliders as a record; a slider of 1/dt gives dt."""
    values = {one["key"]: 1.0 / one["value"] if one.get("inverse") else float(one["value"]) for one in knobs}
    return namedtuple("Tuning", values)(**values)


def checked(tuning, knobs):
    """Return the tuning.  Raises BadInput for a value that its slider does not have."""
    for one in knobs:
        value = finite_number(one["name"], getattr(tuning, one["key"]))
        shown = 1.0 / value if one.get("inverse") and value else value
        if not one["low"] - 1e-9 <= shown <= one["high"] + 1e-9:
            raise BadInput(one["name"], shown, f"choose from {one['low']:g} to {one['high']:g} {one['unit']}".rstrip())
    return tuning
