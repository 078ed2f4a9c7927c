"""Races: the times that an engine and our methods take to the same error, and what their ratio is made of.

A race is run to fixed errors, and to the smallest error at which the engine was timed.  The time to an error is read on
the curve of error against run time, between two runs.  The report says where the coarsest run of a side is accurate
enough already, and where a side never reaches the error.  Only curves that agree with the truth take part: any other
curve reaches an error by luck.
"""

from enum import StrEnum
from math import exp, log
from typing import NamedTuple

from ..check import Verdict
from ..scene import EXACT
from .accuracy import ASYMPTOTIC, HEADLINE

LEVELS = (0.1, HEADLINE, 0.001)     # relative errors of the races [-]
BEST = None                  # the level of the race to the engine's smallest error
ORDERS = (1, 2, 4)
TIE = 2.0                    # a ratio of times below this, and above its inverse, is a tie [-]
NEARLY = 1.05                # times an engine's smallest error: a setting that comes as near may run for it [-]
EXACTLY = 1e-11              # a smaller relative error is round-off, and counts as this [-]


class Outcome(StrEnum):
    """How a race ended, seen from our side."""
    FASTER = "faster"
    TIE = "a tie"                            # less than a factor of TIE, or 1 is within its interval
    SLOWER = "slower"                        # or none of our runs is that accurate
    ENGINE_FAILS = "the engine does not reach it"
    NEITHER = "neither side reaches it"
    UNDECIDED = "undecided"


class Reach(NamedTuple):
    """How one curve gets to an error."""
    label: str
    speed: str               # plain, compiled, engine
    steps: int               # of the cheapest timed run that is accurate enough
    alone: float             # median time of that run [s]
    seconds: float           # to the error, read between that run and a coarser one [s]
    low: float               # the same with the lower ends of the times of both runs [s]
    high: float              # and with the upper ones [s]
    coarsest: bool           # whether already the coarsest timed run is accurate enough


class Race(NamedTuple):
    """One engine against our methods, to one error."""
    product: str
    variant: str             # of the engine's settings that race
    substeps: int            # its steps in a call from Python
    level: float | None      # one of LEVELS, or BEST
    error: float | None      # relative error that both sides must reach; None where the engine has no run to race
    engine: Reach | None
    ours: Reach | None       # our quickest
    same_order: Reach | None  # our quickest of the engine's own order
    order_of_engine: int | None
    outcome: Outcome
    why: str                 # why there is no ratio; empty where there is one
    ratio: float | None      # the engine's time over ours [-]
    low: float | None        # the lowest and the highest ratio that the intervals of both times allow [-]
    high: float | None
    order: float | None      # our time with the engine's order over our quickest [-]
    loop: float | None       # the engine's time over ours with its order [-]
    calls: float | None      # the engine's time over its time without the calls from Python [-]
    plain: float | None      # the engine's time over ours in plain Python; None where no such run is that accurate [-]


class Field(NamedTuple):
    """What takes part in the races of one scene against one engine."""
    product: str
    engines: list            # curves of the engine's settings that agree with the truth
    ours: list               # curves of our methods that do
    undecided: bool          # whether settings of this engine cannot be judged
    rows: list               # timed runs
    quick: bool              # whether the sweeps end early, and most methods were not compiled
    calls: list              # what a call from Python costs, as in `calls.py`


# ---------------------------------------------------------------------------------------------- the time to an error

def reach(rows, error):
    """Return the Reach of an error by the timed runs of one curve; None where none of them is that accurate."""
    good = [row for row in rows if row["error"] <= error]
    if not good:
        return None
    at = min(good, key=lambda row: (row["seconds"], row["error"]))
    between = interpolation(at, rows, error)
    return Reach(at["label"], at["speed"], at["steps"], at["seconds"], *map(between, ("seconds", "low", "high")),
                 at["steps"] == min(row["steps"] for row in rows))


def interpolation(at, rows, error):
    """Return a function of "seconds", "low" or "high": its value where the curve crosses the error, log-log.

    at: the cheapest run that is accurate enough.  The next coarser run is the other end.  No line is drawn to a run
    that is lost, because the curve begins after it.
    """
    beside = max((row for row in rows if row["steps"] < at["steps"]), key=lambda row: row["steps"], default=at)
    if at["error"] <= 0.0 or not error < beside["error"] < ASYMPTOTIC or beside["seconds"] >= at["seconds"]:
        return lambda key: at[key]
    share = log(error / at["error"]) / log(beside["error"] / at["error"])
    return lambda key: exp((1.0 - share) * log(at[key]) + share * log(beside[key]))


def quickest(curves, rows, error):
    """Return the least Reach of an error by any of these curves at any speed, or None."""
    labels = {curve["label"] for curve in curves}
    groups = {}
    for row in rows:
        if row["label"] in labels:
            groups.setdefault((row["label"], row["speed"]), []).append(row)
    found = [one for group in groups.values() if (one := reach(group, error))]
    return min(found, key=lambda one: one.seconds, default=None)


# ---------------------------------------------------------------------------------------------- races

def races(rows, case, live, quick, calls):
    """Return the races of the case that was timed, as plain data: every engine that ran here at every level.

    An engine whose settings all follow laws of their own does not race: to be as wrong as another law is no race.
    """
    timed = [row for row in rows if row["error"] is not None and row["speed"] != "recorded"]
    ours = [curve for curve in case["ours"] if Verdict(curve["verdict"]) is Verdict.AGREES]
    found = []
    for product in live if ours else ():
        mine = [curve for curve in case["engines"] if curve["product"] == product]
        judged = [curve for curve in mine if Verdict(curve["verdict"]) is Verdict.AGREES]
        undecided = any(Verdict(curve["verdict"]) is Verdict.UNDECIDED for curve in mine)
        if judged or undecided:
            field = Field(product, judged, ours, undecided, timed, quick, calls)
            found += [as_data(race(field, level)) for level in (*LEVELS, BEST)]
    return found


def as_data(one):
    """Return a race as a dict that JSON can hold."""
    sides = {name: getattr(one, name) and getattr(one, name)._asdict() for name in ("engine", "ours", "same_order")}
    return {**one._asdict(), **sides}


def race(field, level):
    """Return the Race at one level."""
    theirs = [row for row in field.rows if row["label"] in {curve["label"] for curve in field.engines}]
    error, engine = to_the_best(theirs) if level is BEST else (level, quickest(field.engines, theirs, level))
    ours = None if error is None else quickest(field.ours, field.rows, error)
    outcome, why = why_undecided(field, theirs, error, engine, ours) or outcome_of(engine, ours)
    decided = engine is not None and ours is not None and outcome is not Outcome.UNDECIDED
    setting = next((curve for curve in field.engines if engine and curve["label"] == engine.label), None)
    variant, substeps = (setting["variant"], setting["substeps"]) if setting else ("", 1)
    same, order = in_the_same_order(field, engine, ours, error)
    return Race(field.product, variant, substeps, level, error, engine, ours, same, order, outcome, why,
                *(ratios(engine, ours) if decided else (None,) * 3),
                *(factors(field, engine, substeps, ours, same) if decided else (None,) * 3),
                in_plain_python(field, engine, error))


def in_plain_python(field, engine, error):
    """Return the engine's time over that of our quickest method in plain Python, or None."""
    if engine is None or error is None:
        return None
    slow = quickest(field.ours, [row for row in field.rows if row["speed"] == "plain"], error)
    return slow and engine.seconds / slow.seconds


def to_the_best(rows):
    """Return (the smallest error of an engine, its Reach); (None, None) where all of its timed runs are lost.

    If several settings come as near, the fastest one runs.  An engine that errs by round-off only runs to EXACTLY.
    """
    kept = [row for row in rows if row["error"] < ASYMPTOTIC]
    if not kept:
        return None, None
    error = max(EXACTLY, min(row["error"] for row in kept))
    at = min((row for row in kept if row["error"] <= NEARLY * error), key=lambda row: row["seconds"])
    return error, Reach(at["label"], at["speed"], at["steps"], at["seconds"], at["seconds"], at["low"], at["high"],
                        at["steps"] == min(row["steps"] for row in rows if row["label"] == at["label"]))


def why_undecided(field, theirs, error, engine, ours):
    """Return (Outcome.UNDECIDED, why) where this run cannot decide a race; None where it can.

    Of runs that scatter, because no theory bounds their errors, the most accurate one was lucky.  A quick validation
    leaves most compiling to a full one: plain Python can win a race there and not lose it.
    """
    why = None
    if not field.engines:
        why = "no theory bounds the engine's errors, and the smallest may be luck"
    elif not theirs:
        why = "no run of the engine is short enough to be timed here"
    elif engine is None:
        why = why_not_reached(field.engines, error or ASYMPTOTIC, field.quick, "the engine")
    elif ours is None:
        why = why_not_reached(field.ours, error, field.quick, "a method of ours")
    elif outcome_of(engine, ours)[0] is not Outcome.FASTER:
        compiled = any(row["label"] == ours.label and row["speed"] == "compiled" for row in field.rows)
        why = None if compiled else "our quickest method was timed in plain Python only"
    return why and (Outcome.UNDECIDED, why)


def why_not_reached(curves, error, quick, side):
    """Return why no timed run of these curves reaches an error, where longer runs do or might; None where none does."""
    if any(row["error"] is not None and row["error"] <= error for curve in curves for row in curve["rows"]):
        return f"{side} reaches it, in a run that is too long to be timed here"
    return f"no run of {side} here is that accurate, and a full validation has longer ones" if quick else None


def outcome_of(engine, ours):
    """Return (Outcome, why there is no ratio)."""
    if engine is None:
        return (Outcome.ENGINE_FAILS if ours else Outcome.NEITHER), "none of the engine's runs is that accurate"
    if ours is None:
        return Outcome.SLOWER, "none of our runs is that accurate"
    ratio, low, high = ratios(engine, ours)
    if 1.0 / TIE < ratio < TIE or low < 1.0 < high:
        return Outcome.TIE, ""
    return (Outcome.FASTER if ratio > 1.0 else Outcome.SLOWER), ""


def ratios(engine, ours):
    """Return the ratio of two times, and the lowest and the highest that their intervals allow."""
    return engine.seconds / ours.seconds, engine.low / ours.high, engine.high / ours.low


# ---------------------------------------------------------------------------------------------- what a ratio is made of

def order_of(curve):
    """Return the order of a curve: as theory says; as measured where theory gives no whole number; None if exact."""
    if curve["expected"] in ORDERS:
        return curve["expected"]
    if curve["expected"] == EXACT or curve["order"] is None:
        return None
    return min(ORDERS, key=lambda order: abs(order - curve["order"]))


def in_the_same_order(field, engine, ours, error):
    """Return (our quickest Reach with the engine's order, at the speed of our quickest; that order).

    Either is None where there is none.
    """
    order = engine and next(order_of(curve) for curve in field.engines if curve["label"] == engine.label)
    if not order or ours is None:
        return None, order
    rows = [row for row in field.rows if row["speed"] == ours.speed]
    return quickest([curve for curve in field.ours if order_of(curve) == order], rows, error), order


def factors(field, engine, substeps, ours, same):
    """Return (order, loop, calls) of a ratio: order times loop is the ratio, and calls are a part of loop.

    substeps: the engine's steps in a call;    same: our quickest Reach with the engine's order
    """
    order, loop = (same.seconds / ours.seconds, engine.seconds / same.seconds) if same else (None, None)
    cost = next((one["seconds"] for one in field.calls if one["product"] == field.product), None)
    rest = engine.alone - engine.steps // substeps * cost if cost is not None else 0.0
    return order, loop, engine.alone / rest if rest > 0.0 else None
