"""A body with three different moments spins about its middle axis, slightly disturbed: it flips like a racket."""

from functools import partial
from typing import Annotated, NamedTuple

import numpy as np

from validate.check import states
from validate.methods import (
    AXIS_ANGLE,
    COMPOSED_SPLITTING,
    GYROSCOPIC,
    IMPLICIT_GYROSCOPIC,
    MATRIX,
    MIDPOINT_TURN,
    QUATERNION,
    RUNGE_KUTTA,
    SPLITTING,
    TURNS,
)
from validate.reference.rotation import FreeTop, free_limits, freely
from validate.reference.turns import free_turning
from validate.scene import Scene
from validate.scenes import drawing
from validate.scenes.drawing import omega_and_L
from validate.scenes.rotation._common import FREE_BODY, free_engines, mujoco_default, start_free, turn_runners

T = 10.0                     # [s]: it flips at 6.06 s, and is about to start the next flip
STEPS = (500, 1000, 2000, 5000, 10000, 20000, 50000)
IN_QUICK = {                 # {method: its most steps in a quick run}
    MATRIX: 5000, AXIS_ANGLE: 5000, QUATERNION: 5000, GYROSCOPIC: 5000, IMPLICIT_GYROSCOPIC: 2000, RUNGE_KUTTA: 2000,
    MIDPOINT_TURN: 2000, SPLITTING: None, COMPOSED_SPLITTING: 2000,
}


class Params(NamedTuple):
    I1: Annotated[float, "principal moments of inertia [kg m²]"] = 1.0
    I2: float = 2.0
    I3: float = 3.0
    w1: Annotated[float, "initial ω in body coordinates [rad/s]"] = 0.01
    w2: float = 2.0
    w3: float = 0.01

    def moments(self):
        return np.array([self.I1, self.I2, self.I3])

    def omega(self):
        return np.array([self.w1, self.w2, self.w3])


CASES = {"one flip": Params(), "stable about the largest moment": Params(w1=0.01, w2=0.02, w3=2.0)}


def run(lessons, step, acceleration, state, p, dt, steps):
    q, L, body = state
    return *lessons.rotation.advance_rotation(step, acceleration, 0.0, q, L, dt, steps, body), body


def truth(p, t):
    """ω by Jacobi's sn, cn, dn, and the rotation about L by Gauss's rule (FreeTop).

    About L the body rotates at |L| (I₁ω₁² + I₂ω₂²)/(I₁²ω₁² + I₂²ω₂²).  If the moments are not in order, or L² < 2E I₂,
    DOP853 is used.
    Source: Landau and Lifshitz, Mechanics, § 37.
    """
    if FreeTop.knows(p.moments(), p.omega()):
        return FreeTop(p.moments(), p.omega()).R(t).ravel()
    return (freely(np.eye(3), p.omega(), p.moments(), t)[0] if t > 0.0 else np.eye(3)).ravel()


# 1 − k² = 5e-5 is known to 2e-16/5e-5, and the time of the flip varies as its logarithm
UNCERTAINTY = 1e-11
BODY = free_turning(T, truth, UNCERTAINTY)
RUNNERS = (*turn_runners(BODY, TURNS, free_limits(T), IN_QUICK), *free_engines(BODY), mujoco_default(BODY))


def bodies(p):
    """Draw a plate of one kilogram with these moments: Iᵢ = m(aⱼ² + aₖ²)/3 for half sizes a; it is drawn thicker."""
    a = np.sqrt(1.5 * np.maximum(0.0, np.sum(p.moments()) - 2.0 * p.moments()))
    return [drawing.box(np.maximum(a, 0.05 * a.max()))]


def sanity_checks():
    p = Params()
    top = FreeTop(p.moments(), p.omega())
    flip = top.flips()[0]
    R, L = freely(np.eye(3), p.omega(), p.moments(), T)
    return (
        states("the flip [s]", flip, 6.06, 5e-3),
        states("ω₂ at the flip [rad/s]", top.omega(flip)[1], 0.0, 1e-10),
        states("R at T, by DOP853", truth(p, T), R.ravel(), 1e-10),
        states("ω in body coordinates at T, by DOP853", top.omega(T), R.T @ L / p.moments(), 1e-10),
    )


SCENE = Scene(
    title="Asymmetric top",
    **FREE_BODY,
    cases=CASES, duration=T, steps=STEPS,
    slow_cases=tuple(CASES)[1:],                         # as long as the first, and without a flip
    runners=RUNNERS,
    acceleration=lambda lessons: lessons.rotation.no_torque, start=start_free, run=run,
    truth=truth, truth_uncertainty=UNCERTAINTY,
    sanity_checks=sanity_checks,
    bodies=bodies, arrows=partial(omega_and_L, reach=4.0),
)
