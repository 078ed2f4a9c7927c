"""Piles in space on several threads: groups of one turn share no body that moves, so threads take them in any order.

The result is that of one thread, to the last bit.  Importing this module imports numba.
"""

import types

from numba import njit, prange, set_num_threads

from solutions.given.contact import _aim_eight, _follow_eight, _visit_eight
from solutions.support.lanes import read_velocities, write_velocities


def press_in_lanes(v, omega, lanes, h, pile):
    """Do what _press_in_lanes of lesson 9 does."""
    for turn in range(lanes.turns.size - 1):
        for group in prange(lanes.turns[turn], lanes.turns[turn + 1]):
            s = lanes.rows[group]
            read_velocities(s, v, omega, lanes, group)
            _aim_eight(s, h, pile)
            write_velocities(s, v, omega, lanes, group)


def sweep_in_lanes(v, omega, lanes, pile):
    """Do what _sweep_in_lanes does."""
    for turn in range(lanes.turns.size - 1):
        for group in prange(lanes.turns[turn], lanes.turns[turn + 1]):
            s = lanes.rows[group]
            read_velocities(s, v, omega, lanes, group)
            _visit_eight(s, pile.mu)
            write_velocities(s, v, omega, lanes, group)


def rest_in_lanes(before, spin, v, omega, lanes, h, pile):
    """Do what _rest_in_lanes does."""
    for turn in range(lanes.turns.size - 1):
        for group in prange(lanes.turns[turn], lanes.turns[turn + 1]):
            s = lanes.rows[group]
            read_velocities(s, before, spin, lanes, group)
            _follow_eight(s, h)
            read_velocities(s, v, omega, lanes, group)
            _visit_eight(s, pile.mu)
            write_velocities(s, v, omega, lanes, group)


LOOPS = {"_press_in_lanes": press_in_lanes, "_sweep_in_lanes": sweep_in_lanes, "_rest_in_lanes": rest_in_lanes}
CALLERS = "_substep", "advance_pile"     # of these loops, from the inside out


def on_threads(lesson, threads):
    """Return advance_pile of the compiled lesson 9, with loops whose turns so many threads share."""
    set_num_threads(threads)
    space = dict(vars(lesson)["advance_pile"].twin.py_func.__globals__, prange=prange)
    for name, loop in LOOPS.items():
        space[name] = njit(parallel=True, error_model="numpy")(types.FunctionType(loop.__code__, space))
    for name in CALLERS:
        space[name] = njit(error_model="numpy")(types.FunctionType(space[name].py_func.__code__, space))
    return space["advance_pile"]
