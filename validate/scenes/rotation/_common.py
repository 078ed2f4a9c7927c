"""Free bodies and rolling balls: initial states, drawings, and the runners that rotate them."""

from functools import cache, partial
from typing import Any

import numpy as np

from solutions.given.rotation import check_moments
from solutions.rotation import RigidBody, RollingBall
from solutions.support.model import Body, make_model, rotation_of
from solutions.support.shapes import Ball, HalfSpace
from validate.reference.orientation import quaternion_matrix
from validate.reference.rotation import EXPLICIT, IMPLICIT, free_limits
from validate.reference.turns import EXPLICIT_TERM, IMPLICIT_TERM, MUNTHE_KAAS
from validate.scene import EXACT, MUJOCO, PYBULLET, engine, in_substeps, ours
from validate.scenes._common import built, measured
from validate.scenes.drawing import axes_links, axes_seen, turned_in_place


def turn_runners(body, methods, limits, in_quick, exact=()):
    """Return the runners of our methods on a TurningBody.

    in_quick: {method in a quick run: its largest number of steps there, or None};    exact: methods with round-off only
    """
    return tuple(ours(m, limit=limits, predicted=body.predict(m.table), order=EXACT if m in exact else m.order,
                      in_quick=m in in_quick, most_in_quick=in_quick.get(m)) for m in methods)


def free_body(p):
    """Make a body of one kilogram with p.moments() and p.omega() that starts at R = 1."""
    return make_model([Body((0.0, 0.0, 0.0), 1.0, inertia=tuple(p.moments()), omega=tuple(p.omega()))], (0.0, 0.0, 0.0))


def read_rotation(state, p):
    """Return R, nine numbers."""
    return rotation_of(state.q[0]).ravel()


free_world = partial(built, model=free_body, read=read_rotation)


def free_engines(body):
    """Return the runners of both kinds of body in pybullet, and of MuJoCo, on a TurningBody that is free."""
    maximal = engine(PYBULLET, "", free_world(PYBULLET), "useMaximalCoordinates=1, no damping",
                     order=1, limit=free_limits(body.T, (IMPLICIT,)), predicted=body.predict(IMPLICIT_TERM))
    return (
        engine(PYBULLET, "reduced coordinates", free_world(PYBULLET, maximal=False),
               "createMultiBody with its defaults, but no damping and no clamp of velocity",
               order=1, limit=free_limits(body.T, (EXPLICIT,)), predicted=body.predict(EXPLICIT_TERM)),
        maximal,
        in_substeps(maximal, 100),
        engine(MUJOCO, "", free_world(MUJOCO), "freejoint; Runge–Kutta 4",
               order=4, limit=free_limits(body.T), predicted=body.predict(MUNTHE_KAAS), most_steps=5000),
    )


def mujoco_default(body):
    """Return the runner of MuJoCo's own default on a free TurningBody."""
    return engine(MUJOCO, "default", free_world(MUJOCO, integrator="Euler"),
                  "freejoint; the semi-implicit Euler step",
                  order=1, limit=free_limits(body.T, (EXPLICIT,)), predicted=body.predict(EXPLICIT_TERM),
                  most_steps=5000)


def observe_rotation(state, p):
    """Return R, nine numbers, in which q and −q are equal."""
    return quaternion_matrix(*state[0]).ravel()


def start_free(p):
    """Return (q, L, RigidBody) of a body with p.moments() and p.omega() that starts at R = 1."""
    check_moments(p.moments())
    return np.array([1.0, 0.0, 0.0, 0.0]), p.moments() * p.omega(), RigidBody(1.0, p.moments())


# the fields that the scenes of a body without a torque share
FREE_BODY: dict[str, Any] = {
    "lesson": "rotation",
    "model": free_body,
    "read": read_rotation,
    "observe": observe_rotation,
    "points": axes_seen,
    "links": axes_links,
    "poses": turned_in_place,
    "uses": ("one orientation", "one angular momentum", "one step function"),
    "ablations": measured("position", "contacts"),
}


# ---------------------------------------------------------------------------------------------- rolling balls

@cache
def ball_on_floor(p):
    """Return the RollingBall with I = shape m R² on a horizontal floor."""
    return RollingBall(p.m, np.full(3, p.shape * p.m * p.R**2), p.R, p.mu, np.array([0.0, 0.0, -p.g]))


def bowled(p, rim=0.0):
    """Return (x, q, v, ω) of a ball that is bowled along x; rim: initial speed of its rim [m/s]."""
    spin = np.array([0.0, rim / p.R, 0.0])
    return np.array([0.0, 0.0, p.R]), np.array([1.0, 0.0, 0.0, 0.0]), np.array([p.v0, 0.0, 0.0]), spin


def observe_rolling(radius):
    """Return observe(state, p) of a ball with radius(p): distance x [m], speed v and rim speed Rω [m/s]."""
    return lambda state, p: np.array([state[0][0], state[2][0], radius(p) * state[3][1]])


def rolls_from(p, rim=0.0):
    """Return the time at which slipping ends [s]: v₀ − μg t = rim + μg t mR²/I."""
    return (p.v0 - rim) / (p.mu * p.g * (1.0 + 1.0 / p.shape))


def rolled(p, t, rim=0.0):
    """Return distance, speed and rim speed of a bowled ball at t."""
    sliding, brake = min(t, rolls_from(p, rim)), p.mu * p.g
    v = p.v0 - brake * sliding
    return np.array([p.v0 * sliding - 0.5 * brake * sliding**2 + v * (t - sliding), v, rim + brake * sliding / p.shape])


def rolling_model(ball, v=0.0, rim=0.0):
    """Make a RollingBall with these first speeds [m/s] on a floor of friction 1, in the plane of x and z."""
    R = ball.radius
    body = Body((0.0, R), ball.m, Ball(R), ball.mu, v=(v, 0.0), omega=-rim / R, inertia=ball.I_body[1])
    return make_model([body, Body((0.0, 0.0), shape=HalfSpace((0.0, 1.0)), mu=1.0, e=1.0)], ball.gravity[::2])


def slips_at_first(p):
    """Return the accelerations (2, 2), (2,) of such a ball and of the floor while the ball slides forwards."""
    brake = p.mu * p.g
    return ((-brake, 0.0), (0.0, 0.0)), (-brake / (p.shape * p.R), 0.0)


def read_rolling(radius):
    """Return read(State, p) of that Model: the same three quantities."""
    return lambda state, p: np.array([state.x[0, 0], state.v[0, 0], -radius(p) * state.omega[0]])
