"""A planet: where it starts, how it is drawn, and the same in both engines."""

from functools import partial

import numpy as np

from solutions.checks import BadInput, check_positive

from ..methods import (
    BLANES_MOAN,
    EXPLICIT,
    IMPLICIT_MIDPOINT,
    ONE_OF_EACH_ORDER,
    RK4,
    SYMPLECTIC_EULER,
    VERLET,
)
from ..reference.integrators import (
    EVEN,
    FINEST,
    FINEST_RK4,
    attraction,
    early_limit,
    kepler_limits,
    perihelion,
)
from ..reference.schemes import OLD_VELOCITY_NEW_FORCE
from ..scene import LATE_LEAPFROG, PYBULLET, PYMUNK, EngineRun, engine, ours
from .bullet import Bullet
from .chipmunk import pymunk_space, pymunk_world


def planet(p):
    """Return (x, v) of the planet at its perihelion.  Raises BadInput for what is no ellipse."""
    for name in ("mu", "a"):
        check_positive(name, getattr(p, name))
    if not 0.0 <= p.e < 1.0:
        raise BadInput("the eccentricity e", p.e, "give a number from 0 up to, but not including, 1")
    return perihelion(p)


def planet_in_space(p):
    """The same motion with an unused z coordinate."""
    x, v = planet(p)
    return (np.append(x, 0.0), np.append(v, 0.0)), p


def sun_and_planet(observed, p):
    """Draw the sun and the planet."""
    return np.array([[0.0, 0.0], [observed[0], observed[1]]])


def pymunk_planet(p, dt, ahead=0.0):
    """Chipmunk calls velocity_func after it has moved the body, so the attraction is that at the new position.

    A force applied before step() would be that at the old position: forward Euler, which spirals outwards.
    """
    import pymunk
    space = pymunk_space()
    x, v = perihelion(p)
    body = pymunk.Body(1.0, 1.0)
    body.position, body.velocity = tuple(map(float, x)), tuple(map(float, v + ahead * dt * attraction(x, p.mu)))

    def attract(body, gravity, damping, dt):
        x, y = body.position
        pull = -p.mu / (x * x + y * y) ** 1.5
        body.velocity += (pull * x * dt, pull * y * dt)

    body.velocity_func = attract
    space.add(body)
    return pymunk_world(space, dt, lambda: np.array(body.position))


def bullet_planet(p, dt, ahead=0.0):
    """Apply the attraction as a force, from the position before each step.

    By default a body would carry the damping −0.04 v (1 + |v|) and spiral into the sun within 15 s.
    """
    bullet = Bullet(dt)
    x, v = perihelion(p)
    body = bullet.point_mass(1.0, (*x, 0.0), (*(v - ahead * dt * attraction(x, p.mu)), 0.0))

    def step():
        x, y, z = bullet.position(body)
        pull = -p.mu / (x * x + y * y) ** 1.5
        bullet.push(body, (pull * x, pull * y, 0.0), (x, y, z))
        bullet.step()

    return EngineRun(step, lambda: np.array(bullet.position(body)[:2]), bullet.close)


def planet_runners(motion, methods, pymunk_make, bullet_make, most_steps):
    """Return the runners of a scene with Kepler's motion: our methods with equal steps, and the engines.

    The engines take the attraction from the position before a step (pybullet) or after it (pymunk).  pybullet is
    symplectic Euler, and with a leapfrog start both engines pass through Verlet's positions.
    *_make(p, dt, ahead)   makes an engine's world; its first velocity is ahead a dt too large
    most_steps             of an engine
    """
    T, limits = motion.T, kepler_limits(motion.T)
    symmetric = (VERLET, IMPLICIT_MIDPOINT, BLANES_MOAN)
    errors = {m: motion.predict(m.table, finest=FINEST_RK4 if m is RK4 else FINEST[m.order],
                                powers=EVEN[m.order] if m in symmetric else None) for m in methods}
    pymunk_errors = motion.predict(OLD_VELOCITY_NEW_FORCE, finest=FINEST[1])
    leapfrog = {"order": 2, "limit": limits, "predicted": errors[VERLET], "most_steps": most_steps}
    return (
        *(ours(m, limit=limits, predicted=errors[m], order=LATE_LEAPFROG if m is SYMPLECTIC_EULER else m.order,
               in_quick=m in (*ONE_OF_EACH_ORDER, BLANES_MOAN), compiled_in_quick=m in EXPLICIT) for m in errors),
        engine(PYMUNK, "", pymunk_make, "attraction in velocity_func",
               order=LATE_LEAPFROG, limit=early_limit(T), predicted=pymunk_errors, most_steps=most_steps),
        engine(PYMUNK, "leapfrog start", partial(pymunk_make, ahead=0.5), "first velocity + ½ a dt", **leapfrog),
        engine(PYBULLET, "", bullet_make, "useMaximalCoordinates=1, no damping; force applied each step",
               order=LATE_LEAPFROG, limit=limits, predicted=errors[SYMPLECTIC_EULER], most_steps=most_steps),
        engine(PYBULLET, "leapfrog start", partial(bullet_make, ahead=0.5), "first velocity − ½ a dt", **leapfrog),
    )
