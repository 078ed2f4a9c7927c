"""The records that a scene consists of.  They are checked when a scene is loaded, before anything runs.

A scene is a file in `validate/scenes/<lesson>/` that ends with one `SCENE = Scene(...)`.
`validate/scenes/integrators/oscillator.py` is the model.
"""

from collections.abc import Callable
from dataclasses import MISSING, dataclass, field, fields, replace
from typing import NamedTuple, get_args, get_origin, get_type_hints

import numpy as np

from solutions.checks import BadInput

from .check import Allowed, JointsAllowed, Whose
from .engines.products import MUJOCO, PRODUCTS, PYBULLET, PYMUNK, Product  # noqa: F401    scenes take them from here

EXACT = "exact"              # an order: no error but round-off
LATE_LEAPFROG = "1 to 2"     # an order: leapfrog whose first velocity belongs to half a step before or after
ROUND_OFF = 2.3e-16          # spacing of floats around 1, rounded up [-]
LINK_LOOKS = ("rod", "spring", "spring and damper")          # of the links in a picture


class Method(NamedTuple):
    """One of our steps.  All of them stand in `validate/methods.py`."""
    function: str            # its name in the lesson
    label: str               # its name for people
    order: int               # of convergence, where a scene does not say otherwise
    lesson: str
    colour: str
    marker: str
    table: object = None     # the same method in validate/reference: its Tableau, its Turn, or its step


class Engine(NamedTuple):
    """One way to set up an engine."""
    product: Product
    variant: str             # "" for the settings that match textbook physics, else their name
    make: Callable           # (p, dt) → EngineRun
    settings: str            # what was set, and to what, for people
    most_steps: int | None = None            # the largest number of steps that is worth the engine's time
    substeps: int = 1                        # steps in a call from Python: `make` gives a world that makes so many
    recorded_as: str | None = None           # the variant whose recorded runs are bitwise its own

    @property
    def label(self):
        """Return its name for readers."""
        return f"{self.product}, {self.variant}" if self.variant else self.product.name


class EngineRun(NamedTuple):
    """A running engine."""
    step: Callable           # () → None: advance by dt
    read: Callable           # () → what a scene observes
    close: Callable          # () → None: free its resources
    watched: Callable | None = None      # () → [Step, …] of validate/reference/contact_laws.py that it kept
    watched_step: Callable | None = None     # () → Step, or Reading of joint_laws.py: advance by dt, and report this


class Departure(NamedTuple):
    """Why a method or an engine departs from the truth, and the law that it follows instead."""
    reason: str              # the end of a sentence that begins with "because"
    own_law: Callable        # (p, t) → the same quantities as truth(p, t); the truth itself where it does not depart
    whose: Whose             # its law, its default, or our set-up


class Prediction(NamedTuple):
    """The error that theory predicts for one run, with its sign: it must err neither more, nor less, nor elsewhere."""
    error: np.ndarray        # observed − truth, or − own law where the method or the engine has one
    band: float              # the largest distance of the run's error from it, relative to the truth or own law [-]


@dataclass(frozen=True, kw_only=True)
class Runner:
    """One curve of a scene: a method of ours or an engine with its settings, and all that concerns it there."""
    who: Method | Engine
    order: int | str         # of convergence
    limit: Callable          # (p, dt) → largest relative error; or {order: that}, of which it takes its own
    predicted: Callable | str    # (p, dt) → Prediction, or None for a step that is too long; or why there is none
    departure: Departure | None = None   # where it follows another law than the truth
    measured: str = ""                   # what its limit was measured on; empty where theory gives it
    unfinished: Callable | None = None   # (p) → why it does not come to its end in this case, or ""; it is not run then
    supports: Callable | None = None     # (p) → bool: whether it can do this case; without it, it can do all
    laws: Allowed | JointsAllowed | None = None      # where no theory gives its error: laws judge its watched steps
    watched: int | None = None           # the number of steps of the run that is watched; None: of every run
    is_truth: Callable | None = None     # (p) → bool: whether a run of its engine is the truth of this case
    in_quick: bool = True                # False: only --full runs it
    slow_cases: tuple = ()               # names of cases in which only --full runs it
    compiled_in_quick: bool = False      # it takes longer in plain Python than numba does to compile it
    most_in_quick: int | None = None     # its most steps in a quick run
    finer_in_full: tuple = ()            # further steps of the first case in a full run

    def __post_init__(self):
        thing = f"the runner {self.who.label!r}"
        for f in fields(self):
            check_type(f"field {f.name!r} of {thing}", getattr(self, f.name), f.type)
        if self.departure and not isinstance(self.departure.whose, Whose):
            raise BadInput(f"field 'departure' of {thing}", f"of {self.departure.whose!r}",
                           f"choose from: {', '.join(map(str, Whose))}")
        if self.predicted == "":
            raise BadInput(f"field 'predicted' of {thing}", "empty", "predict its error, or say why no theory does")

    @property
    def label(self):
        """Return its name for readers."""
        return self.who.label

    def is_reference(self, p):
        """Return whether the truth of this case is a run of its own engine: such a curve counts nowhere."""
        return self.is_truth is not None and bool(self.is_truth(p))

    @property
    def is_engine(self):
        """Return whether it is an engine, not a method of ours."""
        return isinstance(self.who, Engine)

    def largest_error(self, p, dt):
        """Return the largest relative error that theory allows it with steps of dt."""
        limit = self.limit(p, dt)
        return limit[self.order] if isinstance(limit, dict) else limit

    def judged_by(self, p, steps):
        """Return what laws allow it in its run with so many steps; None where that is not watched."""
        return self.laws if self.watched in (None, steps) and not self.is_reference(p) else None

    def prediction(self, p, dt):
        """Return the Prediction of its error with steps of dt, or None."""
        return self.predicted(p, dt) if callable(self.predicted) else None


def ours(method, *, order=None, **about):
    """Return the Runner of a method of ours; its order is the usual one unless this scene has another."""
    return Runner(who=method, order=method.order if order is None else order, **about)


def engine(product, variant, make, settings, *, most_steps=None, **about):
    """Return the Runner of an engine with these settings."""
    return Runner(who=Engine(product, variant, make, settings, most_steps), **about)


def in_substeps(runner, substeps):
    """Return the same runner of pybullet, whose own loop makes so many steps in a call from Python: `numSubSteps`.

    The motion is bitwise the same, so that one record serves both.  It is a set-up without forces written in Python.
    """
    one = runner.who
    variant = f"{one.variant}, {substeps} substeps" if one.variant else f"{substeps} substeps"
    return replace(runner, who=one._replace(
        variant=variant, make=one.product.adapter.substepped(one.make, substeps), substeps=substeps,
        recorded_as=one.label, settings=f"the same, numSubSteps {substeps}: bitwise the same motion in fewer calls"))


class Exam(NamedTuple):
    """A problem that others have stated, how they judge an answer, and what a full validation runs of it."""
    organiser: str
    problem: str             # its name there
    statement: str           # in two sentences
    source: str
    duration: float          # of the problem, which may be longer than T of the scene [s]
    outputs: int             # number of outputs, at equal times until then, that are judged
    steps: tuple             # numbers of steps over this duration, coarse to fine; multiples of `outputs`
    measure: Callable        # (what is observed at all outputs (outputs, …), the truth there) → the organisers' error
    unit: str                # what that error is, for people
    grade: Callable | None   # (error) → the organisers' class of it, for people, "" for none; None: they have none
    enough: float            # an error at which no finer steps are taken
    gives_up: dict           # {Method or Product: what it cannot do, or leaves to others, in a sentence}
    published: tuple = ()    # ((who, result), …), for people
    note: str = ""           # what we took where the text does not say it, or found beside it


@dataclass(frozen=True, kw_only=True)
class Scene:
    """One physical situation: its truth, and the runners that are compared with it.

    p is one of the `cases`: a NamedTuple of parameters, whose fields are annotated with their meaning and unit.
    """
    title: str
    lesson: str
    cases: dict              # {name: p}; the first is timed and drawn, all are checked
    duration: float          # T, the output time [s]; 1 where nothing moves
    steps: tuple             # numbers of steps over T, coarse to fine: they divide T and span two decades
    start: Callable          # (p) → state, a tuple of arrays; refuses impossible parameters
    run: Callable            # (lessons, step, acceleration, state, p, dt, steps) → state: only this is timed
    observe: Callable        # (state, p) → flat array that is compared with the truth at T
    truth: Callable          # (p, t) → the same quantities
    truth_uncertainty: float  # of the truth, relative [-]
    runners: tuple           # of Runner: ours first
    points: Callable         # (observed, p) → (n, 2) drawing coordinates [m]
    model: Callable | None = None            # (p) → its Model, from which every world is built
    read: Callable | None = None             # (State of the Model, p) → the same quantities as truth(p, t)
    uses: tuple = ()         # what the scene needs, in words
    ablations: dict = field(default_factory=dict)        # {what it omits: p → (state, p) with it put in, or why not}
    full_loop: str = ""      # why the whole loop of lesson 10 cannot stand for a method here; else it is measured
    acceleration: Callable | None = None     # (lessons) → its law, (t, x, v, p) → a [m/s²]
    omitted_methods: str = ""                # why methods or engines that a reader expects are missing
    slow_cases: tuple = ()                   # names of cases that only --full runs
    moves: bool = True                       # False: nothing moves; no start is compared with the truth
    refinement: str = "step dt [s]"  # what dt = T/steps stands for; "" where nothing can be refined: steps is (1,)
    reports: Callable | None = None          # (state, the next one, p, dt) → Step of our loop, for the laws of contact
    quantity_names: Callable | None = None  # (p) → names of what is observed, for a scene that shows a table of numbers
    published_states: tuple = ()             # ((time, observed, tolerance), …) of the first case, from elsewhere
    sanity_checks: Callable | None = None    # () → Findings about the truth alone
    links: Callable | None = None            # (p) → pairs of points that the picture joins
    link_look: str = "rod"                   # how they are drawn: one of LINK_LOOKS
    film_seconds: float | None = None        # how much of the motion the film shows [s]; T without it
    film_of_truth: str = "truth"  # its label in the film, where the truth is not known
    our_film: Callable | None = None         # (p) → (seconds, frames) of our last run, where only its end is judged
    bodies: Callable | None = None           # (p) → shapes of validate/scenes/drawing.py: the film is then shown in 3D
    poses: Callable | None = None            # (observed, p) → (bodies, 7) position and quaternion (w, x, y, z) of each
    arrows: Callable | None = None           # (observed, p) → {name: (from, to)} [m], such as ω and L
    trail: int | None = None                 # number of the body whose path is drawn
    ground: bool = False                     # draw the plane z = 0
    exam: Exam | None = None                 # where the scene is a published benchmark
    walls: Callable | None = None            # (p) → pairs of points in space: edges of what stands still, in 3D
    story: str = ""                          # the module's docstring, filled in when the scene is loaded
    # filled in when the scene is bound to a subject
    lessons: object = None                   # those of the subject, plain or compiled
    law: Callable | None = None              # what `acceleration` makes of them, compiled where they are

    def __post_init__(self):
        for f in fields(self):
            check_type(f"field {f.name!r} of scene {self.title!r}", getattr(self, f.name), f.type)
        for runner in self.runners:
            check_known(f"a case of {runner.label!r} in scene {self.title!r}", runner.slow_cases, self.cases)
        check_known(f"a slow case of scene {self.title!r}", self.slow_cases, self.cases)
        check_known(f"field 'link_look' of scene {self.title!r}", (self.link_look,), LINK_LOOKS)
        if (self.model is None) != (self.read is None):
            raise BadInput(f"fields 'model' and 'read' of scene {self.title!r}", "only one of them", "give both")
        if self.cases and self.bodies and not self.poses:
            raise BadInput(f"field 'poses' of scene {self.title!r}", "missing", "say where each body of `bodies` is")

    @property
    def parameters(self):
        """Return p of the first case."""
        return next(iter(self.cases.values()))

    @property
    def our_runners(self):
        """Return the runners that are methods of ours."""
        return tuple(r for r in self.runners if not r.is_engine)

    @property
    def engine_runners(self):
        """Return the runners that are engines."""
        return tuple(r for r in self.runners if r.is_engine)

    @property
    def refined(self):
        """Return whether the scene can be refined, so that it has an error over dt."""
        return bool(self.refinement)


def check_known(thing, names, known):
    """Raise BadInput for a name that is not known."""
    for name in names:
        if name not in known:
            raise BadInput(f"{thing}, {name!r},", "unknown", f"choose from: {', '.join(map(str, known))}")


def check_type(thing, value, kind):
    """Raise BadInput unless a value has the type that its field was declared with."""
    allowed = get_args(kind) if get_origin(kind) is not None and get_origin(kind) is not Callable else (kind,)
    for one in allowed or (kind,):
        if one is Callable or get_origin(one) is Callable:
            if callable(value):
                return
        elif one is float and isinstance(value, (int, float)) and not isinstance(value, bool):
            return
        elif isinstance(value, one):
            return
    names = " or ".join(getattr(one, "__name__", str(one)) for one in allowed or (kind,))
    raise BadInput(thing, f"of type {type(value).__name__}", f"give {names}")


def field_names(required=False):
    """Return names of the fields of a Scene."""
    return [f.name for f in fields(Scene)
            if not required or (f.default is MISSING and f.default_factory is MISSING)]


def no_limit(p, dt):
    """No theory says how far some curves may be off.  Their errors are shown.  Where the scene has laws of contact or
    of joints for them, these judge what is seen of their steps; all others are not judged.
    """
    return np.inf


def by_order(rate, T, dt):
    """Return {order k: largest relative error at T} of a method whose local error is (rate dt)ᵏ⁺¹ per step.

    rate [1/s] is the fastest rate at which anything in the scene changes.  T/dt steps add up to  rate T (rate dt)ᵏ.
    Round-off adds up to T/dt spacings at worst.  Newton's method stops at 1e-12.
    """
    limits = {k: rate * T * (rate * dt) ** k + 1e-12 + T / dt * ROUND_OFF for k in (1, 2, 4)}
    return {**limits, EXACT: 1e-12 + T / dt * ROUND_OFF}


def parameter_table(p):
    """Return [(name, value, meaning)] of the parameters of a case; the meaning is the annotation of the field."""
    hints = get_type_hints(type(p), include_extras=True)
    return [(name, value, getattr(hints[name], "__metadata__", ("",))[0])
            for name, value in p._asdict().items() if isinstance(value, (int, float, str))]
