"""Four-bar linkages side by side, which pass positions in which they are singular: all cranks lie flat.

There a motion with crossed cranks branches off, and the rows of the hinges depend on each other.  Our joints take the
shortest impulses of all that move the bodies alike, and stay on the motion.  In an engine the gaps that its hinges have
at that moment decide where it goes on.
"""

from typing import Annotated, NamedTuple

import numpy as np

from solutions.checks import BadInput
from validate.check import states
from validate.engines import watched
from validate.methods import COMPOSED_JOINTS, IN_ANGLES, JOINTS
from validate.reference.exams import EVEN, composed, four_bars_angle, four_bars_law, four_bars_step
from validate.reference.mechanisms import four_bars, four_bars_motion
from validate.reference.schemes import Motion
from validate.scene import MUJOCO, PYBULLET, PYMUNK, Scene, by_order, engine, no_limit, ours
from validate.scenes._common import built, check_positives
from validate.scenes.exams import iftomm
from validate.scenes.simulator._common import hinged_model, joined_2d, watched_joints

T = 2.0                      # [s]: the cranks lie flat for the first time after 0.72 s
STEPS = (20, 40, 100, 200, 400, 1000, 2000)
WHOLE = 20.0                 # how long the published problem lasts [s]
UNCERTAINTY = 1e-10          # of the truth: DOP853 at 1e-12


class Params(NamedTuple):
    loops: Annotated[int, "N four-bars, of N + 1 cranks and N couplers [-]"] = 40
    omega: Annotated[float, "with which the upright cranks begin to turn [rad/s]"] = -1.0
    g: Annotated[float, "gravity [m/s²]"] = 9.81


CASES = {"40": Params(), "one": Params(loops=1)}


def start(p):
    check_positives(p, "g")
    if p.loops < 1:
        raise BadInput("four-bars", p.loops, "give 1 or more")
    return *joined_2d(made(p), (0.0, -p.g)), p


def made(p):
    return four_bars(p.loops, 0.5 * np.pi, p.omega)


def cranks_fall(t, angle, omega, p):
    """Return the angular acceleration (1,) of cranks that stay parallel.

    ((N + 1)/3 + N) θ̈ = −((N + 1)/2 + N) g cos θ
    """
    cranks = p.loops + 1.0
    return -(0.5 * cranks + p.loops) / (cranks / 3.0 + p.loops) * p.g * np.cos(angle)


def run(lessons, step, acceleration, state, p, dt, steps):
    if step is lessons.integrators.rk4_step:
        angle, omega = lessons.integrators.advance(step, acceleration, 0.0, state[1][:1], state[3][:1], dt, steps, p)
        x, q, rates = state[0].copy(), state[1].copy(), state[3].copy()
        x[0], q[0], rates[0] = 0.5 * top(angle[0]), angle[0], omega[0]
        return x, q, state[2], rates, *state[4:]
    simulator = lessons.simulator
    return *simulator.advance_free(step, simulator.weight, 0.0, *state[:4], dt, steps, state[4]), *state[4:]


def top(angle):
    """Return the top (2,) [m] of the first crank, whose foot is the origin."""
    return np.array([np.cos(angle), np.sin(angle)])


def observe(state, p):
    return 2.0 * state[0][0]


def truth(p, t):
    """All cranks stay parallel, so one angle tells all:  I θ̈ = −G cos θ,  I = (N + 1)/3 + N,  G = ((N + 1)/2 + N) g.

    DOP853 solves it at 1e-12.  Observed is the top of the first crank.
    """
    return top(four_bars_angle(p.loops, p.g, p.omega, WHOLE)(t)[0])


def limits(p, dt):
    """An independent program of the hinges' step, written for the one angle, predicts the error of our joints."""
    return by_order(fastest(p), T, dt)


def fastest(p):
    """Return the rate [1/s] of the cranks when they hang: ω² = ω₀² + 4 G/I."""
    loops = p.loops
    pull = (0.5 * (loops + 1) + loops) / ((loops + 1) / 3.0 + loops) * p.g
    return np.sqrt(p.omega**2 + 4.0 * pull)


def floor(p, dt):
    """Each step closes hinges to 1e-14 of the size of the mechanism; near the flat position that is amplified."""
    return UNCERTAINTY + 1e-14 * (p.loops + 1) * T / dt


def begin(p):
    return 0.5 * np.pi, p.omega


MOTION = Motion(T, lambda p: four_bars_law(p.loops, p.g), begin, lambda theta, p: top(theta), truth, floor)
BY_HINGES = MOTION.predict(lambda p: four_bars_step(p.loops), powers=EVEN[2], finest=400)
BY_FIVE = MOTION.predict(lambda p: composed(four_bars_step(p.loops)), powers=EVEN[4], finest=200)


def model(p):
    return hinged_model(made(p), (0.0, -p.g))


def read(state, p):
    return 2.0 * state.x[0]


BRANCHES = "where the cranks lie flat, the gaps of its hinges decide on which of two motions it goes on"
FLAT = "where the cranks lie flat, it closes gaps across their line by impulses along it, which have no limit"
HINGES = watched_joints(model, fastest)
SWEEPS = 1210                # of the engines: ten for each of the 121 hinges of forty linkages [-]
RUNNERS = (
    ours(JOINTS, limit=limits, predicted=BY_HINGES, slow_cases=("40",), most_in_quick=100),
    ours(COMPOSED_JOINTS, limit=limits, predicted=BY_FIVE, in_quick=False),
    ours(IN_ANGLES, limit=limits, predicted=MOTION.predict(IN_ANGLES.table)),
    engine(PYMUNK, "", built(PYMUNK, model, read, HINGES, iterations=SWEEPS),
           f"PivotJoints, error_bias 0, {SWEEPS:,} iterations: ten for each hinge of forty linkages",
           order=1, limit=no_limit, predicted=BRANCHES, laws=watched.sweeps_over_joints(FLAT), most_in_quick=40),
    engine(PYBULLET, "", built(PYBULLET, model, read, HINGES, iterations=SWEEPS),
           f"JOINT_POINT2POINT, maximal coordinates, erp 1, {SWEEPS:,} iterations",
           order=1, limit=no_limit, predicted=BRANCHES, laws=watched.sweeps_over_joints(), most_in_quick=40,
           most_steps=400),
    engine(MUJOCO, "", built(MUJOCO, model, read, HINGES), "hinges as coordinates, `connect` for loops; Runge–Kutta 4",
           order=1, limit=no_limit, predicted=BRANCHES, laws=watched.SOFT_LOOPS, most_in_quick=40, most_steps=1000),
)

EXAM = iftomm(
    "A02, 40 four-bar linkages",
    "Forty four-bar linkages stand side by side, with uniform rods of 1 m and 1 kg, and all tops move at 1 m/s at the "
    "start. Asked for is the first top for 20 s, in which the cranks lie flat again and again: there the mechanism is "
    "singular.",
    WHOLE, 400, (400, 800, 2000, 4000, 20_000),
    {JOINTS: "only joints: what touches is not looked for",
     COMPOSED_JOINTS: "only joints, and five steps in place of one",
     IN_ANGLES: "the mechanism itself: it solves one equation, derived for cranks that stay parallel",
     PYMUNK: "the motion, from the first flat position on",
     PYBULLET: "the motion, from the first flat position on",
     MUJOCO: "the motion, from the first flat position on; and rigid loops: springs with dampers close them"},
    note="The library's own reference file was not at hand: the error is against the derived equation.")


def sanity_checks():
    """Return Findings about the truth: its energy, and another program for it."""
    p = CASES["40"]
    theta, omega = four_bars_angle(p.loops, p.g, p.omega, WHOLE)(WHOLE)
    law = four_bars_law(p.loops, p.g)
    energy = lambda angle, rate: 0.5 * rate**2 - law(0.0, 0.0, 0.0) * np.sin(angle)
    return (states("angle at 2 s, by the equation of another file [rad]", four_bars_motion(made(p), p.g, T)[0],
                   four_bars_angle(p.loops, p.g, p.omega, WHOLE)(T)[0], 1e-9),
            states("energy gained in 20 s, over the moment of inertia [1/s²]",
                   energy(theta, omega) - energy(0.5 * np.pi, p.omega), 0.0, 1e-8))


# ---------------------------------------------------------------------------------------------- picture

def points(observed, p):
    """Draw the cranks, parallel to the first one, and the couplers."""
    feet = np.stack((np.arange(p.loops + 1.0), np.zeros(p.loops + 1)), axis=1)
    return np.round(np.concatenate((feet, feet + observed)), 5)


def links(p):
    n = p.loops + 1
    return [*((k, n + k) for k in range(n)), *((n + k, n + k + 1) for k in range(p.loops))]


SCENE = Scene(
    title="Four-bar linkages", lesson="simulator",
    cases=CASES, duration=T, steps=STEPS,
    runners=RUNNERS,
    acceleration=lambda lessons: cranks_fall, start=start, run=run, observe=observe,
    truth=truth, truth_uncertainty=UNCERTAINTY,
    sanity_checks=sanity_checks,
    points=points, links=links,
    uses=("bodies that turn", "one matrix with a narrow band for all hinges", "no detection"),
    ablations={"contact of the rods": "they lie in different planes and never touch"},
    exam=EXAM,
)
