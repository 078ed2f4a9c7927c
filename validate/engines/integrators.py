"""A planet: where it starts, how it is drawn, and the same in both engines."""

import numpy as np

from solutions.checks import BadInput, check_positive

from ..reference.integrators import attraction, perihelion
from ..scene import LATE_LEAPFROG, PYBULLET, PYMUNK, Engine, EngineRun
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


KEPLER_ENGINES = (
    Engine(PYMUNK, "", pymunk_planet, LATE_LEAPFROG, "attraction in velocity_func", 50_000),
    Engine(
        PYMUNK, "leapfrog start", lambda p, dt: pymunk_planet(p, dt, ahead=0.5), 2, "first velocity + ½ a dt", 50_000
    ),
    Engine(
        PYBULLET,
        "",
        bullet_planet,
        LATE_LEAPFROG,
        "useMaximalCoordinates=1, no damping; force applied each step",
        50_000,
    ),
    Engine(
        PYBULLET, "leapfrog start", lambda p, dt: bullet_planet(p, dt, ahead=0.5), 2, "first velocity − ½ a dt", 50_000
    ),
)
