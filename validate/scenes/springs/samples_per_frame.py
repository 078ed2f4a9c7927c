"""A net of two metres at 24 frames per second: a full run takes 1 to 256 steps per frame, a quick one begins with less.

With one of the lecture's steps per frame the run diverges; with four its worst node is off by 3 cm, with sixteen by
8 mm.
"""


from validate.reference.springs import SquareNet, net_limits, net_steps, net_truth, square_net
from validate.scene import Scene
from validate.scenes.springs._common import SQUARE, net_fields, net_runners

FRAMES_PER_SECOND = 24
SAMPLES = (1, 2, 4, 16, 64, 256)           # steps per frame [-]
T = 1.0                                    # [s]
STEPS = tuple(FRAMES_PER_SECOND * samples for samples in SAMPLES)
UNCERTAINTY = 1e-12

# The lecture's step multiplies a mode by |λ|, |λ|² = 1 − c dt + ½ω² dt².  Dampers give c = τω² with τ = k_d/k = 6 ms.
# Every mode therefore grows if dt > 2τ = 12 ms: with one sample per frame (42 ms) and with two (21 ms), but not with
# four (10 ms).
CASES = {"net": SquareNet(spacing=0.5, shear=1, k=20.0, k_d=0.12, wind=0.1)}


def run(lessons, step, acceleration, state, p, dt, steps):
    x, v, network = state
    return *lessons.integrators.advance(step, acceleration, 0.0, x, v, dt, steps, network), network


truth = net_truth(T)
RUNNERS = net_runners(
    square_net, net_steps(square_net, T, truth, UNCERTAINTY), net_limits(square_net, T, truth, UNCERTAINTY),
    in_quick=False)


SCENE = Scene(
    title="1, 4, 16 samples per frame",
    **net_fields(square_net, SQUARE),
    cases=CASES, duration=T, steps=STEPS,
    runners=RUNNERS,
    acceleration=lambda lessons: lessons.springs.spring_network_acceleration, run=run,
    truth=truth, truth_uncertainty=UNCERTAINTY,
)
