"""A mass on a spring with a damper, released at one metre: the standard problem for comparing methods."""

from functools import cache, partial
from typing import Annotated, NamedTuple

import numpy as np

from solutions.integrators import Oscillator, oscillator_acceleration
from solutions.support.model import WORLD, Body, Spring, make_model, start_of
from validate.engines.bullet import hidden_damping
from validate.engines.mujoco import points as points_in_mujoco
from validate.methods import IMPLICIT_EULER, IMPLICIT_MIDPOINT, INTEGRATORS, ONE_OF_EACH_ORDER, RK4
from validate.reference.schemes import NEW_VELOCITY_OLD_FORCE, Motion, advance_linear
from validate.scene import MUJOCO, PYBULLET, PYMUNK, Scene, by_order, engine, ours
from validate.scenes._common import ONE_LINK, built, check_positives, coordinates, floor_of, measured
from validate.scenes.integrators._common import BY_DEFAULT, damped

T = 2.0                      # [s]: three periods
STEPS = (100, 200, 500, 1000, 2000, 5000, 10000, 20000)


class Params(NamedTuple):
    m: Annotated[float, "mass [kg]"] = 1.0
    k: Annotated[float, "stiffness [N/m]"] = 100.0
    c: Annotated[float, "damper [N s/m]"] = 1.0
    x0: Annotated[float, "initial position, at rest [m]"] = 1.0


CASES = {
    "under-damped": Params(),
    "undamped": Params(c=0.0),
    "critically damped": Params(k=1.0, c=2.0),
    "over-damped": Params(k=1.0, c=5.0),
}


@cache
def oscillator(p):
    """Return the lesson's parameters:  ω = √(k/m),  ζ = c / 2√(km)."""
    return Oscillator(float(np.sqrt(p.k / p.m)), float(0.5 * p.c / np.sqrt(p.k * p.m)))


def model(p):
    """Make a mass on a spring whose other end is two metres from its place at rest."""
    return make_model([Body((p.x0, 0.0), p.m)], (0.0, 0.0),
                      springs=[Spring(0, WORLD, (0.0, 0.0), (-2.0, 0.0), 2.0, p.k, p.c)])


def read(state, p):
    return state.x[0, :1]


def start(p):
    check_positives(p, "m", "k")
    now = start_of(model(p))
    return now.x[0, :1], now.v[0, :1]


def run(lessons, step, acceleration, state, p, dt, steps):
    x, v = state
    return lessons.integrators.advance(step, acceleration, 0.0, x, v, dt, steps, oscillator(p))


def truth(p, t):
    """x(t) = e^(−δt) x₀ (cos σt + δ/σ sin σt),  δ = c/2m,  σ² = k/m − δ²;  cosh and sinh when σ² < 0, 1 + δt at σ = 0.

    Source: any text of mechanics; e.g. Landau and Lifshitz, Mechanics, § 25.
    """
    delta = p.c / (2.0 * p.m)
    squared = p.k / p.m - delta**2
    sigma = np.sqrt(abs(squared))
    if squared > 0.0:
        shape = np.cos(sigma * t) + delta / sigma * np.sin(sigma * t)
    elif squared < 0.0:
        shape = np.cosh(sigma * t) + delta / sigma * np.sinh(sigma * t)
    else:
        shape = 1.0 + delta * t
    return np.array([p.x0 * np.exp(-delta * t) * shape])


def limits(p, dt):
    """The fastest rate is ω + c/m.  Errors are relative to x(T), which damping has made e^(δT) times smaller than x₀.

    pymunk and pybullet are symplectic Euler with the damper at one end of the step.  They err like our methods of
    order 1, and MuJoCo like our Runge–Kutta 4.
    """
    rate, shrunk = np.sqrt(p.k / p.m) + p.c / p.m, p.x0 / abs(truth(p, T)[0])
    return {k: shrunk * limit for k, limit in by_order(rate, T, dt).items()}


def leapfrog_limit(p, dt):
    """An engine whose first velocity is that of half a step later (pymunk) or earlier (pybullet) errs like our methods
    of order 2 if no force depends on the velocity.
    """
    return limits(p, dt)[2 if p.c == 0.0 else 1]


def law(p):
    """Return a(t, x, v) of a number x, independent of the lesson's."""
    return lambda t, x, v: -(p.k * x + p.c * v) / p.m


def released(p):
    return p.x0, 0.0


def seen(x, p):
    return [x]


def spring_and_damper(p):
    """Return pymunk's step: move by the old velocity, apply the spring at the new x, then the damper as e^(−c dt/m)."""
    kept = lambda h: np.exp(-p.c * h / p.m)
    return lambda law, t, x, v, h: (x + h * v, (v - h * p.k / p.m * (x + h * v)) * kept(h))


MOTION = Motion(T, law, released, seen, truth, floor_of(limits), advance_linear)
DAMPED_MOTION = Motion(T, damped(law), released, seen, truth, floor_of(limits))
DAMPED = hidden_damping(lambda t, x, v, p: oscillator_acceleration(t, x, v, oscillator(p)), start)
IN_QUICK = {IMPLICIT_EULER: 2000, IMPLICIT_MIDPOINT: 1000}           # most steps of methods slow in plain Python


def mujoco_make(p, dt):
    """Use one slide joint with stiffness: a spring of a Model is a tendon, and a step then costs 17 % more."""
    return points_in_mujoco([p.m], [[p.x0]], [[0.0]], dt, np.ravel, stiffness=p.k, damping=p.c)


world = partial(built, model=model, read=read)
RUNNERS = (
    *(ours(m, limit=limits, predicted=MOTION.predict(m.table), compiled_in_quick=m in ONE_OF_EACH_ORDER,
           most_in_quick=IN_QUICK.get(m)) for m in INTEGRATORS),
    engine(PYMUNK, "", world(PYMUNK, iterations=1), "DampedSpring; 1 iteration: it is one",
           order=1, limit=limits, predicted=MOTION.predict(spring_and_damper)),
    engine(PYMUNK, "leapfrog start", world(PYMUNK, iterations=1, ahead=0.5),
           "first velocity + ½ a dt: second order without a damper",
           order=1, limit=leapfrog_limit, predicted=MOTION.predict(spring_and_damper, ahead=0.5)),
    engine(PYBULLET, "default", world(PYBULLET, **BY_DEFAULT), "createMultiBody with its defaults",
           order=1, limit=limits, departure=DAMPED,
           predicted=DAMPED_MOTION.predict(NEW_VELOCITY_OLD_FORCE, follows=DAMPED.own_law)),
    engine(PYBULLET, "", world(PYBULLET), "useMaximalCoordinates=1, no damping; force applied each step",
           order=1, limit=limits, predicted=MOTION.predict(NEW_VELOCITY_OLD_FORCE)),
    engine(PYBULLET, "leapfrog start", world(PYBULLET, ahead=0.5),
           "first velocity − ½ a dt: second order without a damper",
           order=1, limit=leapfrog_limit, predicted=MOTION.predict(NEW_VELOCITY_OLD_FORCE, ahead=-0.5)),
    engine(MUJOCO, "", mujoco_make, "slide joint with stiffness and damping; Runge–Kutta 4",
           order=4, limit=limits, predicted=MOTION.predict(RK4.table)),
)


def points(observed, p):
    return np.array([[-2.0, 0.0], [observed[0], 0.0]])


def in_space(p):
    """Return the same motion with unused y and z coordinates."""
    return (np.array([p.x0, 0.0, 0.0]), np.zeros(3)), p


SCENE = Scene(
    title="Oscillator",
    link_look="spring and damper",
    lesson="integrators",
    cases=CASES, duration=T, steps=STEPS,
    runners=RUNNERS,
    acceleration=lambda lessons: lessons.integrators.oscillator_acceleration,
    start=start, run=run, observe=coordinates(1),
    truth=truth, truth_uncertainty=1e-14, model=model, read=read,
    points=points, links=ONE_LINK,
    uses=("one coordinate", "one step function"),
    ablations={
        "the second and third dimension": in_space,
        **measured("rotation", "detection of contacts"),
    },
)
