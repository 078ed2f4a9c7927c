"""A net of two metres at 24 frames per second, with 1 to 256 of the lecture's steps per frame.

With one step per frame it tears; with four its worst node is off by 3 cm, with sixteen by 8 mm.
"""

import numpy as np

from solutions.integrators import advance, amplification_matrix, average_velocity_step
from solutions.springs import spring_network_acceleration as acceleration
from validate.reference.springs import SquareNet, modes, net_limits, net_steps, net_truth, square_net
from validate.scene import Scene
from validate.scenes.springs._common import SQUARE, net_fields, net_points, net_runners, observe_net, start_of

FRAMES_PER_SECOND = 24
SAMPLES = (1, 4, 16, 64, 256)              # steps per frame [-]
T = 1.0                                    # [s]
STEPS = tuple(FRAMES_PER_SECOND * samples for samples in SAMPLES)
UNCERTAINTY = 1e-12

# The lecture's step multiplies a mode by |λ|, |λ|² = 1 − c dt + ½ω² dt².  Dampers give c = τω² with τ = k_d/k = 6 ms.
# Every mode therefore grows if dt > 2τ = 12 ms: with one sample per frame (42 ms), but not with four (10 ms).
CASES = {"net": SquareNet(spacing=0.5, shear=1, k=20.0, k_d=0.12, wind=0.1)}


def run(step, acceleration, state, p, dt, steps):
    x, v, network = state
    return *advance(step, acceleration, 0.0, x, v, dt, steps, network), network


start_net, truth = start_of(square_net, SQUARE), net_truth(T)
RUNNERS = net_runners(
    square_net, net_steps(square_net, T, truth, UNCERTAINTY), net_limits(square_net, T, truth, UNCERTAINTY),
    in_quick=False)


def sanity_checks():
    """Return ((claim, found, expected, tolerance), …): the growth of the fastest mode in one of the lecture's steps.

    |λ₁ λ₂| = det A = (1 − ½ω²dt²)(1 − c dt) + ω² dt (dt − ½c dt²) = 1 − c dt + ½ω² dt²;  |λ|² while the pair is
    complex.
    """
    omega, c = (values[-1] for values in modes(square_net(CASES["net"]))[:2])
    claims = []
    for samples in SAMPLES[:3]:
        dt = 1.0 / (FRAMES_PER_SECOND * samples)
        A = amplification_matrix(average_velocity_step, omega, 0.5 * c / omega, dt)
        expected = 1.0 - c * dt + 0.5 * (omega * dt) ** 2
        claims.append((f"det A, {samples} samples per frame [-]", np.linalg.det(A), expected, 1e-12))
    p, end = CASES["net"], truth(CASES["net"], T)
    for samples, said, digit in ((4, 0.03, 0.005), (16, 0.008, 0.0005)):  # of the docstring, rounded to one digit
        steps = round(FRAMES_PER_SECOND * samples * T)
        off = observe_net(run(average_velocity_step, acceleration, start_net(p), p, T / steps, steps), p) - end
        worst = np.linalg.norm(net_points(off, p), axis=1).max()
        claims.append((f"error of its worst node, {samples} of the lecture's steps per frame [m]", worst, said, digit))
    return tuple(claims)


SCENE = Scene(
    title="1, 4, 16 samples per frame",
    **net_fields(square_net, SQUARE),
    cases=CASES, duration=T, steps=STEPS,
    runners=RUNNERS,
    acceleration=acceleration, run=run,
    truth=truth, truth_uncertainty=UNCERTAINTY,
    sanity_checks=sanity_checks,
)
