"""A point in a field of forces, and a planet, in the engines."""

import numpy as np

from ..reference.integrators import attraction, perihelion
from ..scene import EngineRun
from .bullet import Bullet
from .chipmunk import pymunk_space, pymunk_world
from .mujoco import points


def pymunk_point(gravity, m, v, read, dt, force=None, damping=0.0):
    """Make an EngineRun of a point that starts in the origin; gravity and v (2,); read(position).

    force(x, v) → (2,) [N], in floats, is applied before each step.  Chipmunk moves the point first and then applies the
    force.  This is forward Euler, which is harmless if the force depends on v alone, so x is None.
    damping [1/s] is the space's own: it keeps e^(−damping) of the velocity after one second.
    """
    import pymunk
    space, body = pymunk_space(gravity), pymunk.Body(m, 1.0)
    space.damping = np.exp(-damping)
    body.velocity = tuple(map(float, v))
    space.add(body)
    advance = space.step

    def step():
        body.force = force(None, body.velocity)                  # the step clears it
        advance(dt)

    return EngineRun(step if force else lambda: advance(dt), lambda: read(body.position), lambda: None)


def bullet_point(gravity, m, x, v, read, dt, force=None, damping=0.0, default=False):
    """Make an EngineRun of a point; gravity, x and v (3,); read(position).

    force(x, v) → (2,) [N], in floats, is applied along x and y, from the state before each step.
    damping [1/s] is the body's own: it removes the fraction 1 − e^(−damping) of the velocity in one second.
    default: use a body with the defaults of createMultiBody.
    """
    bullet = Bullet(dt, gravity)
    body = bullet.point_mass(m, x, v, default)
    if damping:
        bullet.pb.changeDynamics(body, -1, linearDamping=-np.expm1(-damping))
    position, velocity, push, advance = bullet.position, bullet.velocity, bullet.push, bullet.step

    def step():
        here = position(body)
        along, up = force(here, velocity(body))
        push(body, (along, up, 0.0), here)
        advance()

    return EngineRun(step if force else advance, lambda: read(position(body)), bullet.close)


def pymunk_planet(p, dt, ahead=0.0):
    """Make an EngineRun of a planet whose attraction is set in velocity_func.

    Chipmunk calls velocity_func after it has moved the body, so the attraction is that at the new position.
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


def mujoco_planet(p, dt):
    """Make an EngineRun of a planet; MuJoCo calls the attraction in every stage of Runge–Kutta's step."""
    mu, (x, v) = p.mu, perihelion(p)

    def pull(x, v):
        share = -mu / (x[0] * x[0] + x[1] * x[1]) ** 1.5
        return share * x[0], share * x[1]
    return points([1.0], [x], [v], dt, lambda x: x[0], force=pull)


def bullet_planet(p, dt, ahead=0.0):
    """Make an EngineRun of a planet; the attraction is a force, from the position before each step.

    With its default damping, −0.04 v (1 + |v|), a body would spiral into the sun within 15 s.
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
