"""The parts of a step of a pile of discs, timed alone; and what the step would cost without one of its ideas.

Notebook 9 shows both.  A part is called from Python, which takes longer than a small part itself.  So the same call
without contacts (or with one body) is timed, too, and only the difference counts.
"""

import time
from typing import NamedTuple

import numpy as np

ROUNDS, CALLS = 9, 20
STEPS = 60                   # of a run whose ideas are compared [-]


class Part(NamedTuple):
    """A part of a step."""
    name: str
    times: int               # per step [-]
    call: float              # one of them [µs]


def microseconds(function, *arguments, calls=None):
    """Return the time of a call, the least of some rounds of so many calls."""
    function(*arguments)
    best, calls = np.inf, calls or CALLS
    for _ in range(ROUNDS):
        began = time.process_time()
        for _ in range(calls):
            function(*arguments)
        best = min(best, (time.process_time() - began) / calls)
    return 1e6 * best


def difference(function, arguments, without):
    """Return the time of a call less that of the same call without what costs time [µs]."""
    return max(0.0, microseconds(function, *arguments) - microseconds(function, *without))


def copied(arrays):
    """Copy arrays.  It takes the time of reading them once and writing as many numbers."""
    for array in arrays:
        array.copy()


def memory_of(step):
    """Return the arrays that a sweep reads."""
    return step.spread.a, step.spread.b, step.spread.n, *step.arms, step.J, step.aim, step.give


class Step(NamedTuple):
    """What the parts of a step work with."""
    contacts: object         # ContactSet, ordered by body
    spread: object           # the same in the order of a sweep
    arms: object
    J: np.ndarray
    aim: np.ndarray
    give: np.ndarray


def step_of(lesson, state, pile, contacts, dt):
    """Return the Step of these contacts."""
    J = lesson.kept_impulses(contacts, state.contacts, state.J, pile.margin)
    order = lesson.spread_order(contacts.a.size)
    spread, J = lesson.reordered(contacts, order), lesson.sorted_rows(J, order)
    arms = lesson.arms_2d(state.x, pile.inv_mass, pile.inv_inertia, spread)
    fastest = lesson.separation_speeds(spread, pile)
    return Step(contacts, spread, arms, J, *lesson.contact_targets(spread.gap, J, spread, arms, fastest, dt, pile))


def contacts_of(lesson, state, pile, pairs):
    """Return the arguments of round_contacts for these pairs."""
    turn = lesson.disc_bounds(state.x, state.q, pile.half)[2]
    return state.x, turn, pile.half, pile.planes, pairs, 0.5 * pile.margin


def no_pairs(lesson, pairs):
    """Return Pairs of as many bodies, none of which may touch."""
    return type(pairs)(0 * pairs.first, pairs.partner[:0])


def profile(lesson, state, pile, dt):
    """Return [Part] of a step of discs at rest, compiled or plain; a search for pairs and one for contacts are rare."""
    h, x = dt / pile.substeps, state.x
    low, high, _ = lesson.disc_bounds(x, state.q, pile.half)
    wide = low - pile.margin, high + pile.margin
    pairs = lesson.pairs_in_reach(*wide, pile.planes, pile.margin)
    none = no_pairs(lesson, pairs)
    some = step_of(lesson, state, pile, lesson.round_contacts(*contacts_of(lesson, state, pile, pairs)), h)
    empty = step_of(lesson, state, pile, lesson.round_contacts(*contacts_of(lesson, state, pile, none)), h)
    old = (state.contacts, state.J, pile.margin)

    def both(name, times, arguments, of=None):
        return Part(name, times, difference(getattr(lesson, of or name), arguments(some), arguments(empty)))
    sweep = both("velocity_sweep_2d (9.16)", 2 * pile.substeps, lambda s: (
        state.v, state.omega, s.J, s.aim, s.give, s.spread, s.arms, pile), "velocity_sweep_2d")
    memory = Part("copying what a sweep reads", 2 * pile.substeps,
                  difference(copied, (memory_of(some),), (memory_of(empty),)))
    aims = both("soft_contact (9.12)", pile.substeps, lambda s: (
        s.spread.gap, s.J, s.spread, s.arms, s.aim, h, pile), "contact_targets")
    gaps = both("gaps follow velocities", pile.substeps, lambda s: (
        state.v, state.omega, s.spread, s.arms), "normal_velocities_2d")
    warm = both("applying the old impulses", 1, lambda s: (
        state.v.copy(), state.omega.copy(), s.J, s.spread, s.arms, pile.inv_mass, pile.inv_inertia),
        "apply_impulses_2d")
    kept = both("kept_impulses (9.14)", 1, lambda s: (s.contacts, *old), "kept_impulses")
    found = Part("contacts found anew", 1, difference(lesson.round_contacts, contacts_of(lesson, state, pile, pairs),
                                                      contacts_of(lesson, state, pile, none)))
    search = Part("pairs found anew", 1, difference(lesson.pairs_in_reach, (*wide, pile.planes, pile.margin),
                                                    (wide[0][:1], wide[1][:1], pile.planes, pile.margin)))
    return [sweep, memory, aims, warm, gaps, kept, found, search]


def without_ideas(lesson, state, pile, dt, parts):
    """Return {idea: how many times as long a step takes without it}, of a pile of discs at rest.

    The first step of a run finds all pairs and contacts anew.  The price of a call is that of a run of no steps.
    """
    def run(steps):
        return lesson.advance_pile_2d(lesson.disc_bounds, lesson.round_contacts, state, dt, steps, pile)
    first = microseconds(run, 1)
    step = (microseconds(run, 1 + STEPS, calls=1) - first) / STEPS
    anew = first - microseconds(run, 0)
    search = next(part.call for part in parts if part.name == "pairs found anew")
    return {"no kept contacts": (anew - search) / step,
            "pairs for one step only": (step + search) / step}
