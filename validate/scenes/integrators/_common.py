"""Planets, and points in a field of forces: initial states, drawings, and the runners that move them."""

from collections.abc import Callable
from functools import partial
from typing import Any, NamedTuple

import numpy as np

from solutions.checks import BadInput
from solutions.support.model import Body, Force, make_model, start_of
from validate.methods import (
    BLANES_MOAN,
    EXPLICIT,
    IMPLICIT_MIDPOINT,
    INTEGRATORS,
    ONE_OF_EACH_ORDER,
    RK4,
    SYMPLECTIC_EULER,
    VERLET,
)
from validate.reference.integrators import EVEN, FINEST, FINEST_RK4, early_limit, kepler_limits, perihelion
from validate.reference.schemes import NEW_VELOCITY_OLD_FORCE, OLD_VELOCITY_NEW_FORCE, OLD_VELOCITY_OLD_FORCE
from validate.scene import LATE_LEAPFROG, MUJOCO, PYBULLET, PYMUNK, engine, ours
from validate.scenes._common import built, check_positives

BY_DEFAULT = {"maximal": False, "damped": True}      # settings of pybullet that are those of createMultiBody
MOST_OF_ORDER_4 = 20_000     # steps of an engine of order 4 around a sun; half of them in a quick run


def integrator_runners(motion, limits, compiled=()):
    """Return the runners of our integrators on a Motion; a quick run has one of each order, and compiles these."""
    return tuple(ours(m, limit=limits, predicted=motion.predict(m.table), in_quick=m in ONE_OF_EACH_ORDER,
                      compiled_in_quick=m in compiled) for m in INTEGRATORS)


def damped(law):
    """Return the law p → a(t, x, v) of a number x with the default damping of pybullet; see `hidden_damping`."""
    def damped_law(p):
        a = law(p)
        return lambda t, x, v: a(t, x, v) - 0.04 * v * (1.0 + abs(v))
    return damped_law


# ---------------------------------------------------------------------------------------------- points

class Point(NamedTuple):
    """A point of the plane as a Model: its start, and the engines that move it."""
    model: Callable          # p → Model of one body
    d: int = 2               # coordinates that are observed

    def start(self, *positive):
        """Return start(p) → (x, v); it raises BadInput unless these parameters are positive."""
        def start(p):
            check_positives(p, *positive)
            now = start_of(self.model(p))
            return now.x[0, :self.d], now.v[0, :self.d]
        return start

    def in_space(self, p):
        """Return the same motion with unused coordinates."""
        now = start_of(self.model(p))
        return (np.append(now.x[0], 0.0), np.append(now.v[0], 0.0)), p

    def read(self, state, p):
        """Return the coordinates that are observed."""
        return state.x[0, :self.d]

    def built(self, product, **settings):
        """Return make(p, dt) of an engine's runner."""
        return built(product, self.model, self.read, **settings)

    def in_pymunk(self, motion, limits):
        """Return the runner of pymunk."""
        return engine(PYMUNK, "", self.built(PYMUNK), "force applied each step",
                      order=1, limit=limits, predicted=motion.predict(OLD_VELOCITY_OLD_FORCE))

    def in_pybullet(self, motion, limits):
        """Return the runner of pybullet."""
        return engine(PYBULLET, "", self.built(PYBULLET),
                      "useMaximalCoordinates=1, no damping; force applied each step",
                      order=1, limit=limits, predicted=motion.predict(NEW_VELOCITY_OLD_FORCE))

    def leaping_in_pybullet(self, motion, limits):
        """Return the runner of pybullet with a leapfrog start.

        Its error is less than half as large.  The order stays the same, because drag depends on the velocity.  In
        pymunk the error would be larger.
        """
        return engine(PYBULLET, "leapfrog start", self.built(PYBULLET, ahead=0.5),
                      "as in pybullet, first velocity − ½ a dt", order=1, limit=limits,
                      predicted=motion.predict(NEW_VELOCITY_OLD_FORCE, ahead=-0.5))

    def in_mujoco(self, motion, limits, settings="force in mjcb_passive, in every stage"):
        """Return the runner of MuJoCo."""
        return engine(MUJOCO, "", self.built(MUJOCO), f"slide joints, {settings}; Runge–Kutta 4",
                      order=4, limit=limits, predicted=motion.predict(RK4.table))

    def in_default_pybullet(self, motion, limits, departure):
        """Return the runner of pybullet's default body, which is slowed by its own damping."""
        return engine(PYBULLET, "default", self.built(PYBULLET, **BY_DEFAULT),
                      "createMultiBody with its defaults; force applied each step",
                      order=1, limit=limits, departure=departure,
                      predicted=motion.predict(NEW_VELOCITY_OLD_FORCE, damped(motion.law), follows=departure.own_law))


def one_point(observed, p):
    """Draw a point of the plane."""
    return observed[None, :]


def as_pair(x, p):
    """Return the coordinates of a complex number."""
    return [x.real, x.imag]


# ---------------------------------------------------------------------------------------------- planets

def planet(p):
    """Return (x, v) of the planet at its perihelion.  Raises BadInput if the path is not an ellipse."""
    check_positives(p, "mu", "a")
    if not 0.0 <= p.e < 1.0:
        raise BadInput("the eccentricity e", p.e, "give a number from 0 up to, but not including, 1")
    return perihelion(p)


def planet_model(p):
    """Make a planet of one kilogram, which a sun in the origin attracts with −μ x/|x|³."""
    (x, v), strength = planet(p), -p.mu

    def attraction(place):
        x, y = place
        pull = strength / (x * x + y * y) ** 1.5
        return pull * x, pull * y
    return make_model([Body(tuple(x), 1.0, v=tuple(v))], (0.0, 0.0), loads=[Force(0, attraction, "x")])


def read_planet(state, p):
    """Return the place of the planet."""
    return state.x[0]


PLANET: dict[str, Any] = {"model": planet_model, "read": read_planet}       # fields of a Scene, and what `built` takes
planet_world = partial(built, **PLANET)


def planet_in_space(p):
    """Return the same motion with an unused z coordinate."""
    x, v = planet(p)
    return (np.append(x, 0.0), np.append(v, 0.0)), p


def sun_and_planet(observed, p):
    """Draw the sun and the planet."""
    return np.array([[0.0, 0.0], [observed[0], observed[1]]])


def planet_runners(motion, methods, most_steps, compiled=EXPLICIT, world=planet_world):
    """Return the runners of a scene with Kepler's motion: our methods with equal steps, and the engines.

    The engines take the attraction from the position before a step (pybullet) or after it (pymunk).  pybullet is
    symplectic Euler, and with a leapfrog start both engines pass through Verlet's positions.
    most_steps    of an engine of order 1
    compiled      methods that a quick run compiles
    world         (Product, ahead) → make(p, dt) of a runner, whose first velocity is ahead dt too old
    """
    T, limits = motion.T, kepler_limits(motion.T)
    symmetric = (VERLET, IMPLICIT_MIDPOINT, BLANES_MOAN)
    errors = {m: motion.predict(m.table, finest=FINEST_RK4 if m is RK4 else FINEST[m.order],
                                powers=EVEN[m.order] if m in symmetric else None) for m in methods}
    pymunk_errors = motion.predict(OLD_VELOCITY_NEW_FORCE, finest=FINEST[1])
    leapfrog = {"order": 2, "limit": limits, "predicted": errors[VERLET], "most_steps": most_steps}
    return (
        *(ours(m, limit=limits, predicted=errors[m], order=LATE_LEAPFROG if m is SYMPLECTIC_EULER else m.order,
               in_quick=m in (*ONE_OF_EACH_ORDER, BLANES_MOAN), compiled_in_quick=m in compiled) for m in errors),
        engine(PYMUNK, "", world(PYMUNK), "attraction in velocity_func",
               order=LATE_LEAPFROG, limit=early_limit(T), predicted=pymunk_errors, most_steps=most_steps),
        engine(PYMUNK, "leapfrog start", world(PYMUNK, ahead=0.5), "first velocity + ½ a dt", **leapfrog),
        engine(PYBULLET, "", world(PYBULLET), "useMaximalCoordinates=1, no damping; force applied each step",
               order=LATE_LEAPFROG, limit=limits, predicted=errors[SYMPLECTIC_EULER], most_steps=most_steps),
        engine(PYBULLET, "leapfrog start", world(PYBULLET, ahead=0.5), "first velocity − ½ a dt", **leapfrog),
        engine(MUJOCO, "", world(MUJOCO), "slide joints, attraction in mjcb_passive, in every stage; Runge–Kutta 4",
               order=4, limit=limits, predicted=errors[RK4], most_steps=MOST_OF_ORDER_4,
               most_in_quick=MOST_OF_ORDER_4 // 2),
    )
