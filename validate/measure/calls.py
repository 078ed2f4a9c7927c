"""The cost of a call of an engine from Python.

A race of ours is one call from Python, and an engine's is one call per step.  So an empty world is stepped twice: by
one call per step, and by a loop of the engine's own.  The difference is the cost of a call.
"""

import time
from collections.abc import Callable
from ctypes import CFUNCTYPE, c_double, c_void_p
from functools import cache
from typing import NamedTuple

import numpy as np

from ..engines.products import MUJOCO, PYBULLET, PYMUNK
from ..subject.modules import can_compile
from .selection import REPEATS

STEPS = 500                  # of an empty world in one repeat


class OwnLoop(NamedTuple):
    """A loop over empty steps that does not return to Python."""
    how: str                 # for people
    run: Callable            # () → None: STEPS empty steps
    close: Callable          # () → None: free its resources


def chipmunk_loop():
    """Return the OwnLoop of pymunk: compiled, over the function of the C library that pymunk calls; None without numba.
    """
    if not can_compile():
        return None
    from numba import njit
    from pymunk import _chipmunk_cffi as chipmunk

    from ..engines.chipmunk import pymunk_space
    ffi = chipmunk.ffi
    address = int(ffi.cast("intptr_t", ffi.addressof(chipmunk.lib, "cpSpaceStep")))
    step, space = CFUNCTYPE(None, c_void_p, c_double)(address), pymunk_space()
    pointer = int(ffi.cast("intptr_t", space._space))

    @njit
    def loop(pointer, steps):
        for _ in range(steps):
            step(pointer, 1e-3)
    loop(pointer, 1)                                                 # compiles it

    def run(space=space):                                            # which would be freed without a name
        loop(pointer, STEPS)
    return OwnLoop("a compiled loop over cpSpaceStep", run, lambda: None)


def bullet_loop():
    """Return the OwnLoop of pybullet: one call with numSubSteps."""
    from ..engines.bullet import Bullet
    bullet = Bullet(1e-3 * STEPS)
    bullet.pb.setPhysicsEngineParameter(numSubSteps=STEPS)

    def close():
        bullet.pb.setPhysicsEngineParameter(numSubSteps=0)           # the next world may be of the same client
        bullet.close()
    return OwnLoop(f"one call with numSubSteps = {STEPS}", bullet.step, close)


def mujoco_loop():
    """Return the OwnLoop of MuJoCo: one call with nstep."""
    from ..engines.mujoco import module, world
    model, data = world(1e-3, "", integrator="Euler")
    return OwnLoop(f"one call with nstep = {STEPS}", lambda: module().mj_step(model, data, STEPS), lambda: None)


OWN_LOOPS = {PYMUNK: chipmunk_loop, PYBULLET: bullet_loop, MUJOCO: mujoco_loop}


@cache
def costs_of_calls(live):
    """Return [{product, seconds, how, called, alone}] of the engines that run here; measured once.

    seconds  the cost of a call from Python, per step [s]; never below zero
    called   repeats of the time per step of an empty world, one call each [s]
    alone    the same in the engine's own loop; empty where there is none, and then `seconds` is the whole empty step
    """
    return [cost_of_calls(product) for product in live]


def cost_of_calls(product):
    """Return the cost of a call of one engine, as in `costs_of_calls`; the two loops take turns."""
    world, own = product.adapter.empty_world(), OWN_LOOPS[product]()
    called, alone = [], []
    try:
        for _ in range(REPEATS):
            called.append(per_step(lambda: one_by_one(world.step)))
            if own:
                alone.append(per_step(own.run))
    finally:
        world.close()
        if own:
            own.close()
    seconds = float(np.median(called) - np.median(alone)) if own else float(np.median(called))
    how = f"an empty step called from Python, without the same step in {own.how}" if own else \
        "an empty step called from Python"
    return {"product": product.name, "seconds": max(0.0, seconds), "how": how, "called": called, "alone": alone}


def one_by_one(step):
    """Take STEPS steps, one call from Python each."""
    for _ in range(STEPS):
        step()


def per_step(run):
    """Return the time of STEPS steps, per step [s]."""
    begin = time.perf_counter()
    run()
    return (time.perf_counter() - begin) / STEPS
