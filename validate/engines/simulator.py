"""Boxes and balls on a floor, in both engines."""

import numpy as np

from validate.engines import watched
from validate.engines.bullet import Rigid
from validate.engines.chipmunk import pymunk_space
from validate.scene import EngineRun

OVERLAP = 1e-6               # with which pymunk's bodies begin [m], because it detects a contact only if bodies overlap
HEAVY = 1e9                  # mass of pybullet's turntable over that of the ball [-]: it falls by 1e-7 m in 5 s
ITERATIONS = 100             # of both engines' contact solvers


def pymunk_floor_space(g, mu):
    """Make a space with a floor y = 0 of that friction; the bodies that stand on it have 1."""
    import pymunk
    space = pymunk_space((0.0, -g))
    space.iterations = ITERATIONS
    floor = pymunk.Segment(space.static_body, (-1000.0, -5.0), (1000.0, -5.0), 5.0)
    floor.friction = mu
    space.add(floor)
    return space


def pymunk_body(space, m, I, x, angle, make):
    """Add a body with the shape make(body), of friction 1."""
    import pymunk
    body = pymunk.Body(m, I)
    body.position, body.angle = tuple(map(float, x)), float(angle)
    shape = make(body)
    shape.friction = 1.0
    space.add(body, shape)
    return body


def pybullet_turntable(ball, x, v, omega, dt):
    """Make an EngineRun of a ball on a very heavy box that rotates; read: x, y and both velocities.

    In maximal coordinates Bullet ignores the velocity of a body without mass.  Gravity is a force on the ball only.
    """
    bullet, half = Rigid(dt, iterations=ITERATIONS), np.array([3.0, 3.0, 0.5])
    shape = bullet.pb.createCollisionShape(bullet.pb.GEOM_BOX, halfExtents=half.tolist())
    bullet.body(HEAVY * ball.m, HEAVY * ball.m * np.ones(3), (0.0, 0.0, -half[2]), ball.floor_omega, True, shape=shape,
                mu=1.0)
    body = bullet.body(ball.m, ball.I_body, x, omega, True, v=v, shape=bullet.ball(ball.radius), mu=ball.mu)
    bullet.begin()
    weight = (ball.m * ball.gravity).tolist()

    def step():
        bullet.push(body, weight, bullet.position(body))
        bullet.step()
    read = lambda: np.array([*bullet.position(body)[:2], *bullet.velocity(body)[:2]])
    return EngineRun(step, read, bullet.close)


def pybullet_box(bullet, m, I, half, x, R, mu):
    """Add a box in maximal coordinates."""
    shape = bullet.pb.createCollisionShape(bullet.pb.GEOM_BOX, halfExtents=list(map(float, half)))
    return bullet.body(m, I, x, np.zeros(3), True, R=R, shape=shape, mu=mu)


def pybullet_slab(bullet):
    """Add a fixed box below z = 0, of friction 1: a plane would give one contact per step only."""
    shape = bullet.pb.createCollisionShape(bullet.pb.GEOM_BOX, halfExtents=[5.0, 5.0, 1.0])
    slab = bullet.pb.createMultiBody(0, shape, basePosition=[0.0, 0.0, -1.0], useMaximalCoordinates=1)
    bullet.pb.changeDynamics(slab, -1, lateralFriction=1.0, rollingFriction=0, spinningFriction=0, restitution=0)


# ---------------------------------------------------------------------------------------------- a machine

class PymunkBoxes:
    """Boxes, some of them without mass, on a floor that may move; a spring to one of them, or None, and air."""

    def __init__(self, parts, dt, iterations, slop):
        import pymunk
        (x, angles, halves, m, v, omega), spring, drag, mu, g, belt = parts
        self.dt, self.space, self.boxes, self.spring, self.drag = dt, pymunk_space((0.0, -g)), [], spring, drag
        self.space.iterations, self.space.collision_slop = iterations, slop
        self.floor = floor = pymunk.Body(body_type=pymunk.Body.KINEMATIC)
        floor.velocity = float(belt), 0.0
        self.space.add(floor, pymunk.Segment(floor, (-1000.0, -5.0), (1000.0, -5.0), 5.0))
        for place, angle, half, mass, speed, spin in zip(x, angles, halves, m, v, omega):
            moves = np.isfinite(mass)
            body = (pymunk.Body(float(mass), float(mass * np.sum(half**2) / 3.0)) if moves else
                    pymunk.Body(body_type=pymunk.Body.KINEMATIC))
            body.position, body.angle = tuple(map(float, place)), float(angle)
            body.velocity, body.angular_velocity = tuple(map(float, speed)), float(spin)
            if moves and drag > 0.0:
                body.velocity_func = lambda body, gravity, damping, dt: pymunk.Body.update_velocity(
                    body, gravity - drag / body.mass * body.velocity, 1.0, dt)
            self.space.add(body, pymunk.Poly.create_box(body, tuple(map(float, 2.0 * half))))
            self.boxes.append(body)
        if spring is not None:
            number, anchor, rest, k, damper = spring
            self.damped = pymunk.DampedSpring(self.space.static_body, self.boxes[number], tuple(map(float, anchor)),
                                              (0.0, 0.0), rest, k, damper)
            self.space.add(self.damped)
        for shape in self.space.shapes:
            shape.friction = np.sqrt(mu)                                 # pymunk multiplies the two

    def read(self, corners):
        return corners(np.array([body.position for body in self.boxes]), np.array([body.angle for body in self.boxes]))

    def run(self, corners, physics):
        """Return the EngineRun; the laws of contact judge it by the Physics of the boxes and the floor."""
        world = watched.Pymunk(self.space, self.dt, [*self.boxes, self.floor], physics,
                               lambda before, after: self.pushed(physics, before, after))
        return EngineRun(lambda: self.space.step(self.dt), lambda: self.read(corners), lambda: None,
                         watched_step=world.watched)

    def pushed(self, physics, before, after):
        """Return the impulses (n, 2) [N s] of the spring and of the air on boxes and floor in a step.

        The engine reports the impulse of its spring.  It moves the boxes, pulls with the new length of the spring, asks
        for the air, and finds what the damper gives last.
        *Source:* Chipmunk's cpDampedSpring.c and cpSpaceStep.c.
        """
        moves, v, J = 1.0 * (physics.inv_mass[:, None] > 0.0), before.v.copy(), np.zeros_like(before.v)
        if self.spring is not None:
            number, anchor, rest, k, _ = self.spring
            way = after.x[number] - anchor
            length = np.linalg.norm(way)
            v[number] += physics.inv_mass[number] * self.dt * k * (rest - length) * way / length
            J[number] = self.damped.impulse * way / length
        return J - self.drag * self.dt * moves * v

    def film(self, steps, every, corners):
        """Return its readings at the start and after every `every` steps."""
        found = [self.read(corners)]
        for n in range(1, steps + 1):
            self.space.step(self.dt)
            if n % every == 0:
                found.append(self.read(corners))
        return found
