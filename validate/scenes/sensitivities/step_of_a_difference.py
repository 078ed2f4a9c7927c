"""The derivative of an oscillator's place with respect to its stiffness, by differences over a step h of the stiffness.

A longer step truncates the series of the place, a shorter one loses digits by subtraction.  The best error of a forward
difference is about the root of the round-off, that of a central difference about its power 2/3.  The complex step
subtracts nothing, and keeps all digits.
"""

from functools import partial
from typing import Annotated, NamedTuple

import numpy as np

from validate.check import states
from validate.methods import CENTRAL_DIFFERENCE, COMPLEX_STEP, FORWARD_DIFFERENCE
from validate.reference.sensitivities import oscillation, oscillator_sensitivities, power_series
from validate.scene import ROUND_OFF, Prediction, Scene, ours
from validate.scenes._common import check_positives

T = 1.0                      # so that dt is h over the stiffness
STEPS = (10, 100, 1000, 10**4, 10**5, 10**6, 10**8, 10**10, 10**12)
RADIUS = 0.5                 # of the circle for the power series, over the stiffness [-]
POWERS = np.arange(32)


class Params(NamedTuple):
    k: Annotated[float, "stiffness [N/m]"] = 100.0
    m: Annotated[float, "mass [kg]"] = 1.0
    c: Annotated[float, "damper [N s/m]"] = 1.0
    x0: Annotated[float, "initial position, at rest [m]"] = 1.0
    t: Annotated[float, "when its place is asked for [s]"] = 2.0


CASES = {"stiff": Params(), "soft": Params(k=4.0)}


def start(p):
    check_positives(p, "k", "m", "x0", "t")
    return (p,)


def place(k, p):
    """x(t) = e^(−δt) x₀ (cos σt + δ/σ sin σt),  δ = c/2m,  σ² = k/m − δ²;  k may be complex."""
    delta = p.c / (2.0 * p.m)
    sigma = np.sqrt(k / p.m - delta * delta)
    return p.x0 * np.exp(-delta * p.t) * (np.cos(sigma * p.t) + delta / sigma * np.sin(sigma * p.t))


def run(lessons, step, acceleration, state, p, dt, steps):
    """Call the lesson's function once, with h = k/steps."""
    return (step(acceleration, p.k, p.k * dt, p),)


def observe(state, p):
    """Return ∂x/∂k [m²/N]."""
    return np.array([state[0]])


def truth(p, t):
    """∂x/∂k = x₀ e^(−δt) (−t sin σt + δ (t cos σt − sin σt/σ)/σ) / 2mσ

    Source: the closed form of x, differentiated on paper.
    """
    return np.array([oscillator_sensitivities(p.t, p.k, p.c, p.m, p.x0)[0]])


# ---------------------------------------------------------------------------------------------- errors

def sizes(p):
    """Return (A [m], r [m/N], σt [-]): amplitude, rate at which k changes the phase σt, and the phase.

    d(σt)/dk = t/2mσ = r, so the n-th derivative of x is about A rⁿ.
    """
    delta = p.c / (2.0 * p.m)
    sigma = np.sqrt(p.k / p.m - delta * delta)
    return p.x0 * np.exp(-delta * p.t) * (1.0 + delta / sigma), p.t / (2.0 * p.m * sigma), sigma * p.t


def rounded(p, h, values=1.0):
    """Return the round-off of a difference over h, relative to the truth.

    A value of x has a few roundings, and one of the phase σt, which is σt roundings of x.  k ± h is rounded, too.
    values: how many values are subtracted per h; 0 if none is, and then the terms of the derivative are rounded.
    """
    A, r, phase = sizes(p)
    derivative = abs(truth(p, T)[0])
    if values == 0.0:
        return (phase + 4.0) * A * r * ROUND_OFF / derivative
    return values * ((phase + 4.0) * A + p.k * derivative) * ROUND_OFF / (h * derivative)


def limits(p, dt):
    """Truncation is h x″/2 of a forward difference and h² x‴/6 of the others.

    x is A cos(σt + …), and k changes its phase at the rate r = t/2mσ, which falls with k.  Each derivative of x
    brings a factor r and, because r and A fall too, a term that is 1/σt times as large or, from the third on,
    three such terms: |x″| ≤ A r² (1 + 1/σt),  |x‴| ≤ A r³ (1 + 3/σt + 3/(σt)²).  The next terms of the series
    are (rh)/3 or (rh)²/20 as large.
    """
    h = p.k * dt
    A, r, phase = sizes(p)
    derivative = abs(truth(p, T)[0])
    second = 0.5 * h * A * r**2 * (1.0 + 1.0 / phase) * (1.0 + r * h)
    third = h**2 / 6.0 * A * r**3 * (1.0 + 3.0 / phase + 3.0 / phase**2) * (1.0 + (r * h) ** 2)
    return {1: second / derivative + rounded(p, h, 2.0), 2: third / derivative + rounded(p, h)}


def complex_limit(p, dt):
    """The complex step has the truncation of a central difference, and no cancellation."""
    return limits(p, dt)[2] - rounded(p, p.k * dt) + rounded(p, p.k * dt, 0.0)


def series_error(p, dt, signs, values):
    """All derivatives of the place with respect to k are known from values on a circle in the complex plane, so the
    series Σ c_j hʲ⁻¹ of a difference is known as well: every j ≥ 2 of a forward difference, the odd ones of a central
    difference, and the odd ones with alternating signs of a complex step.  Only round-off remains, also that of the
    values on the circle, which are at most as large as the sum of all terms there.
    """
    h = p.k * dt
    c = power_series(lambda k: oscillation(p.t, k, p.c, p.m, p.x0), p.k, RADIUS * p.k)
    terms = (signs * c * h ** (POWERS - 1.0))[2:]
    largest, ratios = np.sum(np.abs(c) * (RADIUS * p.k) ** POWERS), (h / (RADIUS * p.k)) ** POWERS[2:]
    summed = ROUND_OFF * largest * np.sum(ratios) / h / abs(truth(p, T)[0])
    return Prediction(np.array([np.sum(terms)]), rounded(p, h, values) + summed)


ODD = POWERS % 2
RUNNERS = (
    ours(FORWARD_DIFFERENCE, limit=limits, predicted=partial(series_error, signs=np.ones(32), values=2.0)),
    ours(CENTRAL_DIFFERENCE, limit=limits, predicted=partial(series_error, signs=ODD, values=1.0)),
    ours(COMPLEX_STEP, limit=complex_limit,
         predicted=partial(series_error, signs=ODD * (-1.0) ** ((POWERS - 1) // 2), values=0.0)),
)


def sanity_checks():
    """Return Findings: the closed form against an imaginary part, and the series against both."""
    found, expected = [], []
    for p in CASES.values():
        c = power_series(lambda k, p=p: oscillation(p.t, k, p.c, p.m, p.x0), p.k, RADIUS * p.k)
        found += [oscillation(p.t, p.k + 1e-30j, p.c, p.m, p.x0).imag / 1e-30, c[1]]
        expected += 2 * list(truth(p, T))
    return (states("∂x/∂k by an imaginary part and by a power series [m²/N]", found, np.array(expected), 1e-14),)


# ---------------------------------------------------------------------------------------------- picture

def points(observed, p):
    """Draw the place over the stiffness, from half to one and a half times k, with the tangent of the derivative."""
    share = np.linspace(0.5, 1.5, 41)
    curve = np.stack((share, oscillation(p.t, share * p.k, p.c, p.m, p.x0) / p.x0), axis=1)
    here = np.array([1.0, oscillation(p.t, p.k, p.c, p.m, p.x0) / p.x0])
    slope = np.array([1.0, p.k * observed[0] / p.x0])
    return np.concatenate((curve, [here - 0.1 * slope, here + 0.1 * slope]))


def links(p):
    return [*((i, i + 1) for i in range(40)), (41, 42)]


SCENE = Scene(
    title="Step of a difference", lesson="sensitivities",
    cases=CASES, duration=T, steps=STEPS,
    runners=RUNNERS,
    acceleration=lambda lessons: place, start=start, run=run, observe=observe,
    truth=truth, truth_uncertainty=1e-15,
    moves=False,
    refinement="step h over the stiffness [-]",
    omitted_methods="no engine differentiates a formula; its differences are those of its steps, in the next scenes",
    quantity_names=lambda p: ["change of the place per stiffness [m²/N]"],
    sanity_checks=sanity_checks,
    points=points, links=links,
    uses=("a formula that takes complex numbers",),
    ablations={"steps in time": "the scenes with an oscillator and with a ball have them"},
)
