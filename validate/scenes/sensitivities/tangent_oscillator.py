"""A mass on a spring with a damper, and how its place depends on the stiffness and on the damper.

The sensitivities are those to a relative change: k ∂x/∂k and c ∂x/∂c are ten times what a change by 10 % does.
They obey an equation of motion of their own, the tangent of the first one, and our steps advance both together.
 MuJoCo's `mjd_transitionFD` gives the derivatives of one of its steps by differences; they are multiplied from
 step to step.
"""

from functools import partial
from typing import Annotated, NamedTuple

import numpy as np

from solutions.integrators import Oscillator
from validate.check import states
from validate.engines.sensitivities import mujoco_tangents
from validate.methods import IMPLICIT_TANGENTS, TANGENTS
from validate.reference.schemes import SYMPLECTIC_EULER, Motion, advance_linear
from validate.reference.sensitivities import oscillation, oscillator_sensitivities
from validate.scene import EXACT, MUJOCO, ROUND_OFF, Scene, by_order, engine, ours
from validate.scenes._common import check_positives, constantly, floor_of

T = 2.0                      # [s]: three periods
STEPS = (100, 200, 500, 1000, 2000, 5000, 10000, 20000)
APART = 1e-6                 # step of MuJoCo's differences, in the unit of each of its variables [-]


class Params(NamedTuple):
    m: Annotated[float, "mass [kg]"] = 1.0
    k: Annotated[float, "stiffness [N/m]"] = 100.0
    c: Annotated[float, "damper [N s/m]"] = 1.0
    x0: Annotated[float, "initial position, at rest [m]"] = 1.0


CASES = {"under-damped": Params(), "little damping": Params(c=0.01), "soft and heavy": Params(m=5.0, k=40.0, c=4.0)}


def start(p):
    """Return (x, v, dx, dv): the place and the velocity at the start do not depend on k or c."""
    check_positives(p, "m", "k", "c")
    return np.array([p.x0]), np.zeros(1), np.zeros((1, 2)), np.zeros((1, 2))


def oscillator(p):
    """Return the lesson's parameters:  ω = √(k/m),  ζ = c / 2√(km)."""
    return Oscillator(float(np.sqrt(p.k / p.m)), float(0.5 * p.c / np.sqrt(p.k * p.m)))


def run(lessons, step, acceleration, state, p, dt, steps):
    slopes = lessons.sensitivities.oscillator_derivatives
    return lessons.sensitivities.advance_tangents(step, acceleration, slopes, 0.0, *state, dt, steps, oscillator(p))


def observe(state, p):
    """Return the place and its two sensitivities [m]."""
    return np.append(state[0], state[2])


def truth(p, t):
    """x(t), and its closed form differentiated on paper: k ∂x/∂k and c ∂x/∂c.

    Source: any text of mechanics, and the chain rule through δ = c/2m and σ² = k/m − δ².
    """
    by_k, by_c = oscillator_sensitivities(t, p.k, p.c, p.m, p.x0)
    return np.array([oscillation(t, p.k, p.c, p.m, p.x0), p.k * by_k, p.c * by_c])


# ---------------------------------------------------------------------------------------------- errors

def limits(p, dt):
    """A step of first order turns an oscillation by exponents that are off by at most ½ ω² dt, for symplectic
    Euler much less.  After T the motion is off by ½ ω² dt T of itself.  A relative change of k changes ω by
    half of it: the sensitivity, about ½ ω T of the motion, is off by the same share and, because ω² in the
    share changes, by 2/ωT more.
    """
    omega, decay = np.sqrt(p.k / p.m), np.exp(-0.5 * p.c / p.m * T)
    size = 0.5 * omega * T * p.x0 * decay / np.linalg.norm(truth(p, T))
    rounded = by_order(0.0, T, dt)[EXACT]
    return {1: size * (0.5 * omega**2 * dt * T * (1.0 + 2.0 / (omega * T)) + rounded), EXACT: size * rounded}


def differenced_limits(p, dt):
    """MuJoCo's step is linear in each of x, v, k and c alone, so its central differences truncate nothing.

    A difference of two velocities is rounded by a spacing of them, ω x₀ ε, over twice the step of the difference, and
    a relative change of k is k times that.  The place at the end depends on a velocity before it by 1/ω.  Over T/dt
    steps this is a random walk; the limit is three times its size.
    """
    omega, steps = np.sqrt(p.k / p.m), T / dt
    walk = np.sqrt(steps) * ROUND_OFF * p.x0 * max(p.k, p.c * omega) / (2.0 * APART) / np.linalg.norm(truth(p, T))
    return {k: limit + 3.0 * walk for k, limit in limits(p, dt).items()}


def law(p):
    """Return a(t, x, v) of the place and its two sensitivities, (3,): the tangent of the law, on paper."""
    def together(t, x, v):
        a = -(p.k * x + p.c * v) / p.m
        return a - np.array([0.0, p.k * x[0], p.c * v[0]]) / p.m
    return together


def released(p):
    return np.array([p.x0, 0.0, 0.0]), np.zeros(3)


def seen(x, p):
    return x


def implicit_in_velocity(p):
    """Return the step of MuJoCo's `implicit`:  (1 − h a_v) (v⁺ − v) = h a,  x⁺ = x + h v⁺,  and its tangent with it."""
    a_v = -p.c / p.m * np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 0.0, 1.0]])

    def step(law, t, x, v, h):
        v = v + np.linalg.solve(np.eye(3) - h * a_v, h * law(t, x, v))
        return x + h * v, v
    return step


MOTION = Motion(T, law, released, seen, truth, floor_of(limits), advance_linear)
BY_DIFFERENCES = Motion(T, law, released, seen, truth, floor_of(differenced_limits), advance_linear)


def mujoco_make(p, dt, integrator="Euler"):
    return mujoco_tangents(p.m, p.k, p.c, p.x0, dt, APART, integrator)


RUNNERS = (
    ours(TANGENTS, limit=limits, predicted=MOTION.predict(TANGENTS.table)),
    ours(IMPLICIT_TANGENTS, limit=limits, predicted=MOTION.predict(IMPLICIT_TANGENTS.table)),
    engine(MUJOCO, "", mujoco_make, "mjd_transitionFD, central differences; stiffness and damper are the "
           "controls of two actuators; Euler",
           order=1, limit=differenced_limits, predicted=BY_DIFFERENCES.predict(SYMPLECTIC_EULER)),
    engine(MUJOCO, "implicit", partial(mujoco_make, integrator="implicit"), "the same with the integrator `implicit`",
           order=1, limit=differenced_limits, predicted=BY_DIFFERENCES.predict(implicit_in_velocity)),
)


def sanity_checks():
    """Return Findings: the derivatives of the closed form by imaginary parts of k and of c."""
    found, expected = [], []
    for p in CASES.values():
        found += [p.k * oscillation(T, p.k + 1e-30j, p.c, p.m, p.x0).imag / 1e-30,
                  p.c * oscillation(T, p.k, p.c + 1e-30j, p.m, p.x0).imag / 1e-30]
        expected += list(truth(p, T)[1:])
    return (states("k ∂x/∂k and c ∂x/∂c by imaginary parts [m]", found, np.array(expected), 1e-12),)


def points(observed, p):
    """Draw the mass on its spring, and below it where a spring that is 10 % stiffer would have it, to first order."""
    x, by_k, _ = observed
    return np.array([[-2.0, 0.0], [x, 0.0], [-2.0, -0.4], [x + 0.1 * by_k, -0.4]])


SCENE = Scene(
    title="Oscillator with its tangents", lesson="sensitivities",
    link_look="spring and damper",
    cases=CASES, duration=T, steps=STEPS,
    runners=RUNNERS,
    acceleration=lambda lessons: lessons.integrators.oscillator_acceleration,
    start=start, run=run, observe=observe,
    truth=truth, truth_uncertainty=1e-14,
    omitted_methods="pymunk and pybullet have no derivatives of a step",
    sanity_checks=sanity_checks,
    points=points, links=constantly([(0, 1), (2, 3)]),
    uses=("one coordinate", "one step function", "two sensitivities"),
    full_loop="the loop has no sensitivities",
    ablations={"without the sensitivities": "the scene Oscillator of lesson 1 has the motion alone"},
)
