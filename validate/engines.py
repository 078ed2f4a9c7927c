"""The two witnesses, set up to match textbook mechanics, and whether they are here at all.

Both move first-order: pybullet v += a dt, then x += v dt; pymunk x += v dt, then v += a dt.  Started from a velocity half a
step away (−½ a dt in pybullet, +½ a dt in pymunk) they become leapfrog, of second order where forces are smooth.
"""

import ctypes
import importlib
import os
import sys
from importlib.metadata import PackageNotFoundError, version

import numpy as np

from solutions.checks import BadInput

from .scene import World

NAMES = ("pymunk", "pybullet")


def installed(engine):
    """The engine's version, or None.  Raises BadInput for an engine nobody knows."""
    if engine not in NAMES:
        raise BadInput(f"engine {engine!r}", "unknown", f"choose from: {', '.join(NAMES)}")
    try:
        return version(engine)
    except PackageNotFoundError:
        return None


def quiet_import(name):
    """The module, without the line that its C code prints when it is loaded."""
    if name in sys.modules:
        return sys.modules[name]
    sys.stdout.flush()
    sys.stderr.flush()
    kept, nowhere = [os.dup(1), os.dup(2)], os.open(os.devnull, os.O_WRONLY)
    try:
        os.dup2(nowhere, 1)
        os.dup2(nowhere, 2)
        module = importlib.import_module(name)
        ctypes.CDLL(None).fflush(None)               # the line sits in the C library's buffer
        return module
    finally:
        for original, copy in zip((1, 2), kept):
            os.dup2(copy, original)
            os.close(copy)
        os.close(nowhere)


def pymunk_space(gravity=(0.0, 0.0)):
    """A pymunk.Space without damping, its units metres."""
    import pymunk
    space = pymunk.Space()
    space.gravity = tuple(map(float, gravity))
    space.collision_slop = 1e-5                      # the default, 0.1, is a length in pixels
    return space


def pymunk_world(space, dt, read):
    """The World of a space."""
    return World(lambda: space.step(dt), read, lambda: None)


def hidden_damping(acceleration, start):
    """Why a reduced-coordinate body of pybullet departs by default, for a scene's WHY: it feels a − 0.04 v (1 + |v|), |v| the vector's length.

    start(p) → (x, v), each (d,); the law is solved by DOP853.
    *Source:* measured, and in Bullet's btMultiBody.
    """
    def own_law(p, t):
        from scipy.integrate import solve_ivp
        begin = np.concatenate(start(p))
        d = len(begin) // 2

        def slope(t, y):
            return np.concatenate((y[d:], acceleration(t, y[:d], y[d:], p) - 0.04 * y[d:] * (1.0 + np.linalg.norm(y[d:]))))
        return solve_ivp(slope, (0.0, max(t, 1e-9)), begin, method="DOP853", rtol=1e-12, atol=1e-13).y[:d, -1]
    return "its reduced-coordinate bodies carry a hidden damping −0.04 v (1 + |v|)", own_law


_idle = []                           # clients of pybullet that wait for another world


class Bullet:
    """A pybullet client without a window, with the settings that every scene needs.  Bodies have no shape unless given one."""

    def __init__(self, dt, gravity=(0.0, 0.0, 0.0)):
        pybullet = quiet_import("pybullet")
        self.pb, self.client = pybullet, _idle.pop() if _idle else pybullet.connect(pybullet.DIRECT)
        pybullet.setGravity(*map(float, gravity), physicsClientId=self.client)
        pybullet.setTimeStep(dt, physicsClientId=self.client)
        # the residual threshold stops the solver at an absolute velocity, which ruins small steps; the breaking threshold is
        # global to the process and survives reconnecting, so every scene sets it
        pybullet.setPhysicsEngineParameter(solverResidualThreshold=0, contactBreakingThreshold=0.02, physicsClientId=self.client)

    def point_mass(self, m, x, v, default=False):
        """A free body with maximal coordinates: no hidden damping, no velocity clamp.  default: as createMultiBody leaves it."""
        body = self.pb.createMultiBody(m, basePosition=list(map(float, x)), useMaximalCoordinates=0 if default else 1,
                                       physicsClientId=self.client)
        if not default:
            self.pb.changeDynamics(body, -1, linearDamping=0, angularDamping=0, physicsClientId=self.client)
        self.pb.resetBaseVelocity(body, list(map(float, v)), physicsClientId=self.client)
        return body

    def position(self, body):
        return self.pb.getBasePositionAndOrientation(body, physicsClientId=self.client)[0]

    def velocity(self, body):
        return self.pb.getBaseVelocity(body, physicsClientId=self.client)[0]

    def push(self, body, force, x):
        """Apply a force [N] at the centre x [m] during the next step only (pybullet clears it)."""
        self.pb.applyExternalForce(body, -1, force, x, self.pb.WORLD_FRAME, physicsClientId=self.client)

    def step(self):
        self.pb.stepSimulation(physicsClientId=self.client)

    def close(self):
        """Empty the world and keep its client for the next: connecting takes 20 ms."""
        self.pb.resetSimulation(physicsClientId=self.client)
        _idle.append(self.client)
