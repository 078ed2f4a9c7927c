"""Records of stability cases, the decorator that registers a case, and tools that several lessons' cases share.

A case states the bound that theory gives, finds the bound by experiment and compares the two.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from solutions.checks import BadInput, Diverged

from ..check import Finding

EDGE = 1e-6                  # relative width at which bisection stops [-]
LINE, DOTS = "line", "dots"


class NotRun(NamedTuple):
    """A statement of theory that this machine cannot try."""
    claim: str               # as in Finding
    quantity: str
    why: str                 # the end of a sentence that begins with "because"


class Checks(list):
    """The findings of one case, as it makes them, and those that this machine cannot make."""

    def __init__(self):
        super().__init__()
        self.not_run = []                # of NotRun

    def __call__(self, claim, quantity, *, law, found, within, saw, within_from=""):
        """Add a Finding: theory says `law`, the experiment found `found`, and they may differ by `within`.

        claim, quantity   as in Finding
        saw               the result of the experiment, in one sentence
        within_from       the measurement that `within` was taken from, where it was not derived
        """
        self.append(Finding(claim, quantity, float(law), float(found), float(within), saw, within_from))

    def by(self, product, claim, quantity, experiment):
        """Add what `experiment` says of an engine, {law, found, within, saw}; where it is not installed, a NotRun."""
        if product.installed():
            self(claim, quantity, **experiment())
        else:
            self.not_run.append(NotRun(claim, quantity, f"{product} is not installed here"))

    def agree(self, claim, quantity, error, within):
        """Add a Finding that a function errs by no more than `within`; error is the largest in many random cases."""
        self(claim, quantity, law=0.0, found=error, within=within, saw=f"The largest error is {abs(error):.1e}.")

    def count(self, claim, quantity, done, of, saw):
        """Add a Finding that `done` of `of` trials had the right outcome; `saw` continues "3 of 3 …"."""
        self(claim, f"{quantity} [of {of}]", law=of, found=done, within=0.0, saw=f"{done} of {of} {saw}")

    def laws(self, lesson, laws, *, seed, times):
        """Add a Finding for each Law, tried in `times` random cases with its own seed."""
        for number, law in enumerate(laws, 100 * seed):
            rng, worst = np.random.default_rng(number), Worst()
            for _ in range(times):
                worst.note(law, *law.compare(lesson, rng))
            self.agree(law.claim, law.quantity, worst[law], law.within)


class Law(NamedTuple):
    """A statement about a random case, made by the decorator @random_law."""
    claim: str               # as in Finding
    quantity: str
    within: float
    compare: Callable        # (lesson, rng) → (got, truth) of one case, as in Worst.note


def random_law(claim, quantity, within):
    """Make a Law of a function (lesson, rng) → (got, truth), for Checks.laws."""
    return lambda compare: Law(claim, quantity, within, compare)


class Picture(NamedTuple):
    """Curves to draw: series = [(label, xs, ys, style)], style LINE or DOTS; or maps in their place."""
    title: str
    x_label: str
    y_label: str
    series: list
    sentence: str
    maps: tuple = ()         # of dicts: label, xs, ys, values (a row for each y), curve: (xs, ys) of theory over it
    range: tuple = ()        # the lowest and the highest value of the colour scale of the maps


class Case(NamedTuple):
    """A case before its run."""
    slug: str                # its name in addresses
    title: str
    lesson: str
    examine: Callable        # (lesson, check: Checks) → Picture or None
    compiled: bool           # False for short runs and for runs with an acceleration of their own
    in_quick: bool = True    # False: only --full examines it, because it takes seconds


class Examined(NamedTuple):
    """A case after its run."""
    slug: str
    title: str
    lesson: str
    findings: list
    picture: Picture | None
    not_run: list            # of NotRun


CASES: dict[str, dict[str, Case]] = {}                   # {lesson: {slug: Case}} of the files imported so far


def case(slug, title, compiled=True, in_quick=True):
    """Register a function as a case of the lesson that its file is named after.

    The function is (lesson, check) → Picture or None, where check is the Checks that it fills.
    """
    def register(examine):
        lesson = examine.__module__.rpartition(".")[2]
        CASES.setdefault(lesson, {})[slug] = Case(slug, title, lesson, examine, compiled, in_quick)
        return examine
    return register


def series(label, xs, ys, style):
    """Make one curve of a Picture of plain floats."""
    return (label, [float(x) for x in xs], [float(y) for y in ys], style)


def log_series(label, xs, ys, style):
    """Make one curve of a Picture whose axes are both logarithms to base 10."""
    return series(label, np.log10(xs), np.log10(ys), style)


# ---------------------------------------------------------------------------------------------- experiments

def bisect(too_long, low, high, edge=EDGE):
    """Return the number at which too_long turns from False to True, within this part of it.

    It is 0 if too_long is True at low, and infinite if it is still False at high.
    """
    if too_long(low):
        return 0.0
    if not too_long(high):
        return np.inf
    while high - low > edge * high:
        middle = 0.5 * (low + high)
        low, high = (low, middle) if too_long(middle) else (middle, high)
    return 0.5 * (low + high)


def jitted(law):
    """Compile an acceleration function of a case, for a compiled lesson."""
    from numba import njit
    return njit(error_model="numpy")(law)


def log_slope(sizes, errors):
    """Return the slope of log error over log size, by least squares.

    Exercise 1.10 is the same function of a subject.
    """
    return np.polyfit(np.log(sizes), np.log(errors), 1)[0]


def refuses(function, arguments=(), value=""):
    """Return whether a call raises BadInput with that value in its message."""
    try:
        function(*arguments)
    except BadInput as e:
        return value in str(e)
    return False


def refuse(methods, run):
    """Count the methods that raise Diverged instead of returning a number: run(name) → anything."""
    refused = 0
    for method in methods:
        try:
            run(method.function)
        except Diverged:
            refused += 1
    return refused


class Worst(dict):
    """{law: its largest error in many random cases}.

    NaN is larger than any number, and a law that no case tried has NaN, so their findings do not hold.
    """

    def __missing__(self, law):
        return np.nan

    def keep(self, law, *errors):
        """Keep the largest of these errors and of the earlier ones."""
        self[law] = np.max([self.get(law, 0.0), *errors])

    def note(self, law, got, truth):
        """Note the largest difference of numbers from their truth; both may be tuples of arrays.  Here ∞ equals ∞."""
        got, truth = flat(got), flat(truth)
        with np.errstate(invalid="ignore"):                # ∞ − ∞, which is not used
            self.keep(law, np.max(np.abs(np.where(got == truth, 0.0, got - truth))))


def relative(*pairs):
    """Return (got, truth) of all pairs (got, truth) together, each over the largest number of its truth."""
    sizes = [np.max(np.abs(flat(truth))) for _, truth in pairs]
    got, truths = zip(*pairs, strict=True)
    return tuple(tuple(flat(part) / size for part, size in zip(parts, sizes, strict=True)) for parts in (got, truths))


def flat(numbers):
    """Return all numbers of an array or of a tuple of arrays in one row."""
    parts = numbers if isinstance(numbers, tuple) else (numbers,)
    return np.concatenate([np.ravel(part) for part in parts])


# ---------------------------------------------------------------------------------------------- random configurations

def matrix_of(q):
    """Return the rotation (3, 3) of a unit quaternion: (w² − 𝐪²) 1 + 2 𝐪 𝐪ᵀ + 2 w 𝐪*."""
    w, r = q[0], q[1:]
    return (w * w - r @ r) * np.eye(3) + 2.0 * np.outer(r, r) + 2.0 * w * np.cross(np.eye(3), r)


def turned_by(omega, dt):
    """Return the rotation (3, 3) by 2 atan(½ |ω| dt) about ω."""
    rate = np.linalg.norm(omega)
    half_turn = np.arctan(0.5 * rate * dt)
    return matrix_of(np.array([np.cos(half_turn), *(np.sin(half_turn) * omega / rate)]))


def random_quaternions(rng, n):
    """Return n unit quaternions."""
    q = rng.normal(size=(n, 4))
    return q / np.linalg.norm(q, axis=1)[:, None]


def unlike(found, truth):
    """Return (number of rows found, largest distance of a row from the nearest of the others) of two sets of rows.

    The order of contacts is a choice, and their number is not.
    """
    found, truth = np.asarray(found, float), np.asarray(truth, float)
    if found.size == 0 or truth.size == 0:
        return len(found), 0.0
    apart = np.max(np.abs(found[:, None] - truth), axis=2)
    return len(found), max(np.max(np.min(apart, axis=0)), np.max(np.min(apart, axis=1)))
