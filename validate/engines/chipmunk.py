"""pymunk, which wraps Chipmunk2D: the 2D engine."""
from validate.scene import EngineRun

from .switches import made


def pymunk_space(gravity=(0.0, 0.0)):
    """Make a pymunk.Space without damping, its units metres."""
    import pymunk
    space = made(pymunk.Space())
    space.gravity = tuple(map(float, gravity))
    space.collision_slop = 1e-5                      # the default, 0.1, is a length in pixels
    return space


def pymunk_world(space, dt, read):
    """Make the EngineRun of a space."""
    return EngineRun(lambda: space.step(dt), read, lambda: None)


def pymunk_ball(space, m, I, radius, x, v, omega, e, mu):
    """Make a circle; pymunk multiplies e and μ of the two bodies."""
    import pymunk
    body = pymunk.Body(m, I)
    body.position, body.velocity, body.angular_velocity = tuple(map(float, x)), tuple(map(float, v)), float(omega)
    shape = pymunk.Circle(body, radius)
    shape.elasticity, shape.friction = e, mu
    space.add(body, shape)
    return body


def pymunk_floor(space):
    """Make the floor y = 0, the upper side of a beam 10 m thick, which no body passes in one step."""
    import pymunk
    floor = pymunk.Segment(space.static_body, (-1000.0, -5.0), (1000.0, -5.0), 5.0)
    floor.elasticity, floor.friction = 1.0, 1.0
    space.add(floor)
