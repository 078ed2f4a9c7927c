"""Piles in space on several threads: groups of one turn share no body that moves, so threads take them in any order.

The result is that of one thread, to the last bit.  Importing this module imports numba.
"""

import types

from numba import njit, prange, set_num_threads

CALLERS = "_substep", "advance_pile"     # of the loops that are shared, from the inside out


def shared_loops(space):
    """Return {name: a loop over groups of lesson 9, with turns that threads share}; space: the lesson's functions."""
    read, write = space["read_velocities"], space["write_velocities"]
    aim, visit, follow = space["_aim_eight"], space["_visit_eight"], space["_follow_eight"]

    def press_in_lanes(v, omega, lanes, h, pile):
        for turn in range(lanes.turns.size - 1):
            for group in prange(lanes.turns[turn], lanes.turns[turn + 1]):
                s = lanes.rows[group]
                read(s, v, omega, lanes, group)
                aim(s, h, pile)
                write(s, v, omega, lanes, group)

    def sweep_in_lanes(v, omega, lanes, pile):
        for turn in range(lanes.turns.size - 1):
            for group in prange(lanes.turns[turn], lanes.turns[turn + 1]):
                s = lanes.rows[group]
                read(s, v, omega, lanes, group)
                visit(s, pile.mu)
                write(s, v, omega, lanes, group)

    def rest_in_lanes(before, spin, v, omega, lanes, h, pile):
        for turn in range(lanes.turns.size - 1):
            for group in prange(lanes.turns[turn], lanes.turns[turn + 1]):
                s = lanes.rows[group]
                read(s, before, spin, lanes, group)
                follow(s, h)
                read(s, v, omega, lanes, group)
                visit(s, pile.mu)
                write(s, v, omega, lanes, group)

    return {f"_{loop.__name__}": njit(parallel=True, error_model="numpy")(loop)
            for loop in (press_in_lanes, sweep_in_lanes, rest_in_lanes)}


def on_threads(lesson, threads):
    """Return advance_pile of the compiled lesson 9, with loops whose turns so many threads share."""
    set_num_threads(threads)
    space = dict(vars(lesson)["advance_pile"].twin.py_func.__globals__)
    space.update(shared_loops(space))
    for name in CALLERS:
        space[name] = njit(error_model="numpy")(types.FunctionType(space[name].py_func.__code__, space))
    return space["advance_pile"]
