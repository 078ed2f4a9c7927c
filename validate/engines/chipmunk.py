"""pymunk, which wraps Chipmunk2D: the 2D engine."""
from validate.scene import EngineRun


def pymunk_space(gravity=(0.0, 0.0)):
    """A pymunk.Space without damping, its units metres."""
    import pymunk
    space = pymunk.Space()
    space.gravity = tuple(map(float, gravity))
    space.collision_slop = 1e-5                      # the default, 0.1, is a length in pixels
    return space


def pymunk_world(space, dt, read):
    """The EngineRun of a space."""
    return EngineRun(lambda: space.step(dt), read, lambda: None)


def pymunk_ball(space, m, I, radius, x, v, omega, e, mu):
    """A circle; pymunk multiplies e and μ of the two that meet."""
    import pymunk
    body = pymunk.Body(m, I)
    body.position, body.velocity, body.angular_velocity = tuple(map(float, x)), tuple(map(float, v)), float(omega)
    shape = pymunk.Circle(body, radius)
    shape.elasticity, shape.friction = e, mu
    space.add(body, shape)
    return body


def pymunk_floor(space):
    """y = 0, the upper side of a beam 10 m thick, through which nothing falls in a step."""
    import pymunk
    floor = pymunk.Segment(space.static_body, (-1000.0, -5.0), (1000.0, -5.0), 5.0)
    floor.elasticity, floor.friction = 1.0, 1.0
    space.add(floor)
