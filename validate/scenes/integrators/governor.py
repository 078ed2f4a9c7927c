"""A flyball governor, stiff: springs of 8 × 10⁵ N/m with dampers tie two rods to a slider on a shaft that turns.

The fastest motion dies out at 12,000 to 18,000 per second, and what is asked for takes a second.  An explicit method
must follow the former.  An implicit one may step over it.
"""

from functools import cache
from typing import Annotated, NamedTuple

import numpy as np

from validate.check import states
from validate.methods import IMPLICIT_EULER, IMPLICIT_MIDPOINT, RK4
from validate.reference.exams import (
    Governor,
    governor_energy,
    governor_law,
    governor_motion,
    iftomm_error,
    implicit_step,
)
from validate.reference.schemes import Motion
from validate.scene import Scene, by_order, ours
from validate.scenes._common import check_positives, constantly
from validate.scenes.exams import iftomm

T = 0.5                      # [s]: the slider sinks by 12 cm
STEPS = (50, 100, 200, 500, 1000, 2000, 5000, 10000)
WHOLE = 10.0                 # how long the published problem lasts [s]
UNCERTAINTY = 1e-8           # of the truth: Radau at 1e-10
STIFF = 14_000.0             # decay of the fastest motion until T [1/s]


class Params(NamedTuple):
    k: Annotated[float, "stiffness of each spring [N/m]"] = 8e5
    c: Annotated[float, "damper of each spring [N s/m]"] = 4e4
    rest: Annotated[float, "length of each spring at rest [m]"] = 0.5
    rod: Annotated[float, "mass of each rod, 1 m long [kg]"] = 0.3
    ball: Annotated[float, "mass in the middle of each rod [kg]"] = 5.0
    slider: Annotated[float, "mass of the slider [kg]"] = 3.0
    still: Annotated[float, "moment of shaft and slider about the axis [kg m²]"] = 0.005005
    b: Annotated[float, "of the rods' hinges, and of the slider's sides, from the axis [m]"] = 0.05
    omega: Annotated[float, "with which the shaft begins [rad/s]"] = 2.0 * np.pi
    g: Annotated[float, "gravity [m/s²]"] = 9.81


CASES = {"as published": Params()}


def start(p):
    """Return (φ, α, s) and their rates: angle of the shaft, of the rods below horizontal, height of the slider."""
    check_positives(p, "k", "rest", "rod", "ball", "slider", "still", "b", "g")
    return np.array([0.0, np.pi / 6.0, 0.5]), np.array([p.omega, 0.0, 0.0])


def governed(t, x, v, p):
    """Lagrange's equations of (φ, α, s).  A point of a rod is at the radius b + u cos α and the height 1 − u sin α.

    (2J + J₀) φ̈ = −2J′ α̇ φ̇,   A α̈ = ½J′ φ̇² + g M₁ cos α + Q_α,   m_s s̈ = −m_s g + 2 T Δz/l
    M₁ = ∫u dm and A = ∫u² dm of one rod with its ball,  J(α) = ∫(b + u cos α)² dm,  T = k (l − l₀) + c l̇
    """
    first, second = 0.5 * p.rod + 0.5 * p.ball, p.rod / 3.0 + 0.25 * p.ball
    c, n = np.cos(x[1]), np.sin(x[1])
    inertia = 2.0 * ((p.rod + p.ball) * p.b**2 + 2.0 * p.b * c * first + c * c * second) + p.still
    slope = -2.0 * p.b * n * first - 2.0 * c * n * second
    out, up = 0.5 * c, 1.0 - 0.5 * n - x[2]              # from the slider's side to the middle of the rod
    length = np.sqrt(out * out + up * up)
    rate = (-out * 0.5 * n * v[1] + up * (-0.5 * c * v[1] - v[2])) / length
    pull = p.k * (length - p.rest) + p.c * rate
    on_alpha = pull * (out * 0.5 * n + up * 0.5 * c) / length
    return np.array((-2.0 * slope * v[1] * v[0] / inertia,
                     (0.5 * slope * v[0] * v[0] + p.g * c * first + on_alpha) / second,
                     -p.g + 2.0 * pull * up / length / p.slider))


def run(lessons, step, acceleration, state, p, dt, steps):
    return lessons.integrators.advance(step, acceleration, 0.0, *state, dt, steps, p)


def observe(state, p):
    return state[0]


@cache
def machine(p):
    return Governor(p.k, p.c, p.rest, p.rod, p.ball, p.slider, p.still, p.b, p.g)


def truth(p, t):
    """Angle of the shaft, angle of the rods, height of the slider: by Radau at 1e-10, from d'Alembert's principle.

    Its equations are written for points of the rods and not for the three coordinates.
    """
    return governor_motion(machine(p), p.omega, T if t <= T else WHOLE)(t)[:3]


def limits(p, dt):
    """The fastest rate is the decay of the springs' own motion, which is 14,000 per second before T.

    No expansion in powers of dt holds for a step that is longer than that allows.  An independent program of the
    implicit methods, with Newton's method and other equations, predicts their errors all the same.
    """
    return by_order(STIFF, T, dt)


MOTION = Motion(T, lambda p: governor_law(machine(p)), start, lambda x, p: x, truth, lambda p, dt: 10.0 * UNCERTAINTY)
RUNNERS = (
    ours(IMPLICIT_MIDPOINT, limit=limits, most_in_quick=100,
         predicted=MOTION.predict(lambda p: implicit_step(0.5), finest=1000, powers=(2, 4, 6))),
    ours(IMPLICIT_EULER, limit=limits, most_in_quick=100,
         predicted=MOTION.predict(lambda p: implicit_step(1.0), finest=1000)),
    ours(RK4, limit=limits, predicted=MOTION.predict(RK4.table, finest=10_000), in_quick=False),
)


def height(outputs, truth):
    """Return the library's error of the slider's height alone."""
    return iftomm_error(outputs[:, 2], truth[:, 2])


EXAM = iftomm(
    "A05, stiff flyball governor",
    "Two rods with balls hang on a shaft that turns, and springs of 8 × 10⁵ N/m with dampers tie them to a slider on "
    "the shaft. Asked for is the height of the slider for 10 s.",
    WHOLE, 1000, (1000, 5000, 20_000, 100_000, 200_000),
    {IMPLICIT_MIDPOINT: "damping of what it steps over: the springs' own motion goes on with alternating sign",
     IMPLICIT_EULER: "the second order: it also damps what it should not",
     RK4: "long steps: it diverges above 1.6 × 10⁻⁴ s"},
    note="The text does not say where the balls and the ends of the springs are. Here the balls are in the middles of "
         "the rods, and the springs go from there to the slider's sides, which makes them exactly as long as at rest. "
         "The library's own reference file was not at hand: the error is against our reference. Models have no joint "
         "that slides, so that no engine takes part.")._replace(measure=height)


def sanity_checks():
    """Return Findings about the truth: numbers of an earlier, independent solution, and the energy."""
    p = CASES["as published"]
    lost = governor_energy(machine(p), p.omega, T)
    return (states("height of the slider at 0.1 s and 0.5 s, by another solution [m]",
                   [truth(p, t)[2] for t in (0.1, 0.5)], (0.4838671096, 0.3841440608), 5e-9),
            states("energy lost until T less what the dampers took, over the first energy [-]", lost, 0.0, 1e-6))


# ---------------------------------------------------------------------------------------------- picture

def points(observed, p):
    """Draw the shaft, both rods in its plane, the springs and the slider; the plane turns with the shaft."""
    _, alpha, s = observed
    c, n = np.cos(alpha), np.sin(alpha)
    side = lambda way: [(way * p.b, 1.0), (way * (p.b + 0.5 * c), 1.0 - 0.5 * n), (way * (p.b + c), 1.0 - n),
                        (way * p.b, s)]
    return np.round(np.array([(0.0, 0.0), (0.0, 1.0), *side(1.0), *side(-1.0)]), 5)


SCENE = Scene(
    title="Flyball governor", lesson="integrators",
    cases=CASES, duration=T, steps=STEPS,
    runners=RUNNERS,
    acceleration=lambda lessons: governed, start=start, run=run, observe=observe,
    truth=truth, truth_uncertainty=UNCERTAINTY,
    omitted_methods=("other explicit methods would need as short steps as Runge–Kutta 4; engines have no slider on a "
                     "shaft in the Models from which they are built"),
    sanity_checks=sanity_checks,
    points=points, links=constantly([(0, 1), (2, 3), (3, 4), (3, 5), (5, 9), (6, 7), (7, 8), (7, 9)]),
    uses=("three coordinates", "one step function"),
    full_loop="its coordinates are two angles and a height, and the loop has bodies",
    ablations={"hinges and a slider": "its three coordinates contain them; the joints of lesson 10 have no slider"},
    exam=EXAM,
)
