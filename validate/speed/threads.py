"""Piles in space on several threads: groups of one turn share no body that moves, so threads take them in any order.

The result is that of one thread, to the last bit.  Importing this module imports numba.
"""

import types

from numba import get_num_threads, njit, prange, set_num_threads

SHARED = "_sweep_in_lanes", "_rest_in_lanes"                             # loops whose parts threads share
CALLERS = "_substep", "advance_pile"                                     # of these loops, from the inside out


def on_threads(lesson, threads):
    """Return advance_pile of the compiled lesson 9, with loops that so many threads share."""
    set_num_threads(threads)
    space = dict(vars(lesson)["advance_pile"].twin.py_func.__globals__)
    space.update(in_any_order=prange, number_of_parts=get_num_threads)
    for name in SHARED + CALLERS:
        function = types.FunctionType(space[name].py_func.__code__, space)
        space[name] = njit(parallel=name in SHARED, error_model="numpy")(function)
    return space["advance_pile"]
