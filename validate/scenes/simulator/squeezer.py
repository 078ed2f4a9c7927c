"""Andrews' squeezing mechanism: seven bodies on ten hinges, three closed loops, a torque and a spring; it takes 0.03 s.

Its answer has been published with 16 digits.  Our joints solve for all hinges at once, loops or not.  Engines sweep
over the hinges, or hold those that close a loop by soft constraints, and the gaps that they leave decide their error.
"""

from functools import cache
from typing import Annotated, NamedTuple

import numpy as np

from solutions.support.model import WORLD, Spring
from validate.check import states
from validate.engines import watched
from validate.methods import COMPOSED_JOINTS, JOINTS
from validate.reference import mechanisms
from validate.reference.exams import (
    EVEN,
    composed,
    digits,
    largest_relative_error,
    rattle_2d,
    squeezer,
    squeezer_motion,
)
from validate.reference.mechanisms import ANDREWS_END, FIXED, REST, STIFFNESS, TORQUE
from validate.reference.schemes import Motion
from validate.scene import MUJOCO, PYBULLET, PYMUNK, Exam, Scene, by_order, engine, no_limit, ours
from validate.scenes._common import built, check_positives, constantly
from validate.scenes.simulator._common import hinged_model, joined_2d, watched_joints

T = 0.03                     # [s]: the crank makes two and a half revolutions
STEPS = (50, 100, 150, 200, 500, 1000, 2000, 5000)   # a film of the fourth has one step for each picture
FASTEST = 1424.0             # published rate of Θ at the end [rad/s]
UNCERTAINTY = 1e-10          # of the truth: two tolerances of DOP853 differ by less
HOOK = (0.02 - 0.01043, -(0.018 - 0.01874))  # of the spring, from the centre of its body along e(γ) and −n(γ) [m]
CX, CY = map(float, FIXED["C"])
PIN_X, PIN_Y = HOOK


class Params(NamedTuple):
    inertia: Annotated[float, "moment of the crank about its centre [kg m²]"] = 2.194e-6


CASES = {"as published": Params()}


@cache
def made(p):
    """Return the Mechanism."""
    published = mechanisms.andrews()
    return published._replace(inertia=np.concatenate(([p.inertia], published.inertia[1:])))


def start(p):
    check_positives(p, "inertia")
    return joined_2d(made(p), (0.0, 0.0))


def driven(t, x, q, v, omega, p):
    """Return the torque on the crank, and what the spring from a fixed point pulls at body 2."""
    F, tau = np.zeros(x.shape), np.zeros(omega.shape)
    c, s = np.cos(q[2]), np.sin(q[2])
    r_x, r_y = c * PIN_X - s * PIN_Y, s * PIN_X + c * PIN_Y
    way_x, way_y = x[2, 0] + r_x - CX, x[2, 1] + r_y - CY
    length = np.sqrt(way_x * way_x + way_y * way_y)
    pull = -STIFFNESS * (length - REST) / length
    F[2, 0], F[2, 1] = pull * way_x, pull * way_y
    tau[0], tau[2] = TORQUE, r_x * F[2, 1] - r_y * F[2, 0]
    return F, tau


def run(lessons, step, acceleration, state, p, dt, steps):
    return *lessons.simulator.advance_free(step, acceleration, 0.0, *state[:4], dt, steps, state[4]), state[4]


def directions(angles):
    """Return (cos θ, sin θ) of the seven bodies, (14,), in which whole turns do not count."""
    return np.stack((np.cos(angles[:7]), np.sin(angles[:7])), axis=1).ravel()


def observe(state, p):
    return directions(state[1])


def truth(p, t):
    """Directions of the seven bodies, from Lagrange's equations in their angles, with multipliers for the three loops.

    DOP853 solves them at 1e-12.  Our joints move bodies on hinges, which is another formulation.  The published digits
    agree with this motion to 2.7e-10 of the angle of body 2.
    """
    return directions(squeezer_motion(p.inertia, T)(t))


def limits(p, dt):
    """The fastest rate is the published one of an angle at the end, 1,424 rad/s.

    Where a run can be predicted, an independent program of the same step says how far it errs: RATTLE on a dense matrix
    that is solved by least squares.
    """
    return by_order(FASTEST, T, dt)


def pushed(p):
    """Return the accelerations (t, y, u) of the independent program; y, u (8, 3), the last body is the world."""
    W = np.stack((1.0 / made(p).m, 1.0 / made(p).m, 1.0 / made(p).inertia), axis=1)

    def law(t, y, u):
        F, tau = mechanisms.andrews_load(t, y[:, :2], y[:, 2], u[:, :2], u[:, 2], None)
        return W * np.column_stack((F, tau))
    return law


def begin(p):
    return np.column_stack((made(p).x, made(p).q)), np.zeros((8, 3))


def floor(p, dt):
    """Each step closes hinges to 1e-14 of their size, an error that grows as the step's own: linearly, and by 1/dt."""
    return UNCERTAINTY + 1e-14 * T / dt


MOTION = Motion(T, pushed, begin, lambda y, p: directions(y[:, 2]), truth, floor)
BY_HINGES = MOTION.predict(lambda p: rattle_2d(made(p)), powers=EVEN[2], finest=400)
BY_FIVE = MOTION.predict(lambda p: composed(rattle_2d(made(p))), powers=EVEN[4], finest=400)


def model(p):
    """Return the Model for the engines: ten hinges, the torque as a load, and the spring."""
    def torque(t, x, q, v, omega):
        tau = np.zeros(omega.shape)
        tau[0] = TORQUE
        return np.zeros(x.shape), tau
    spring = Spring(2, WORLD, (PIN_X, PIN_Y), (CX, CY), REST, STIFFNESS)
    return hinged_model(made(p), (0.0, 0.0), [spring], [torque])


def read(state, p):
    return directions(state.q)


def work_of_torque(before, after):
    """Return the work [J] of the torque on the crank in a step; engines report angles without whole turns."""
    return TORQUE * (np.remainder(after.q[0] - before.q[0] + np.pi, 2.0 * np.pi) - np.pi)


SWEPT = "its sweeps leave hinges open by what no theory predicts, and three loops carry that on"
SOFT = "three hinges that close loops are soft constraints, of which no theory says how far they give way"
FINER = (10_000, 30_000)
HINGES = watched_joints(model, constantly(FASTEST), work_of_torque)
RUNNERS = (
    ours(JOINTS, limit=limits, predicted=BY_HINGES, most_in_quick=100),
    ours(COMPOSED_JOINTS, limit=limits, predicted=BY_FIVE, in_quick=False),
    engine(PYMUNK, "", built(PYMUNK, model, read, HINGES), "PivotJoints, error_bias 0, 100 iterations",
           order=1, limit=no_limit, predicted=SWEPT, laws=watched.sweeps_over_joints(), most_in_quick=200,
           most_steps=1000, finer_in_full=FINER),
    engine(PYBULLET, "", built(PYBULLET, model, read, HINGES),
           "JOINT_POINT2POINT, maximal coordinates, erp 1, 100 iterations",
           order=1, limit=no_limit, predicted=SWEPT, laws=watched.sweeps_over_joints(), most_in_quick=200,
           most_steps=1000),
    engine(MUJOCO, "", built(MUJOCO, model, read, HINGES), "hinges as coordinates, `connect` for loops; Runge–Kutta 4",
           order=1, limit=no_limit, predicted=SOFT, laws=watched.SOFT_LOOPS, most_in_quick=200, most_steps=1000),
)


# ---------------------------------------------------------------------------------------------- published

def angles_of(observed):
    """Return the seven angles of the problem, with the whole turns of the published ones."""
    bodies = np.arctan2(observed[1::2], observed[::2])
    asked = mechanisms.andrews_angles(bodies)
    return asked + 2.0 * np.pi * np.round((ANDREWS_END - asked) / (2.0 * np.pi))


def measure(outputs, reference):
    """Return the largest relative error of the seven angles at the end, against the published digits."""
    return largest_relative_error(angles_of(outputs[-1]), ANDREWS_END)


EXAM = Exam(
    organiser="IFToMM library, A03, and test set for initial value problems of Bari", problem="Andrews' squeezer",
    statement="Seven plane bodies on ten hinges form three closed loops; a constant torque drives the crank, a spring "
              "pulls at another body, and there is no gravity. Asked for are seven angles after 0.03 s.",
    source="Mazzia and Magherini 2008, problem “Andrews”; Hairer and Wanner 1996, VII.7",
    duration=T, outputs=1, steps=(250, 500, 1000, 2000, 4000, 10_000, 30_000),
    measure=measure, unit="largest relative error of the seven angles", grade=digits, enough=5e-9,
    gives_up={
        JOINTS: "only joints: what touches is not looked for",
        COMPOSED_JOINTS: "only joints, and five steps in place of one",
        PYMUNK: "open hinges: it corrects what a step has left open in the next one",
        PYBULLET: "open hinges, as far as its sweeps leave them",
        MUJOCO: "rigid loops: the hinges that close them are springs with dampers"},
    published=(("the test set's reference", "16 digits; an independent solution of ours confirms 9.6 of them"),),
    note="IFToMM and Bari state the same problem. The engines' angles are counted without whole turns.")


def sanity_checks():
    """Return Findings about the truth: the published digits, and that the three loops stay closed."""
    motion = squeezer_motion(CASES["as published"].inertia, T)
    end = motion(T)
    _, E = squeezer()
    gaps = np.abs(E @ (np.exp(1j * end[:7]) - np.exp(1j * motion(0.0)[:7])))
    return (states("angles at the end, over the published ones, largest relative difference [-]",
                   np.max(np.abs(mechanisms.andrews_angles(end[:7]) / ANDREWS_END - 1.0)), 0.0, 5e-10),
            states("gaps of the loops at the end [m]", gaps, 0.0, 1e-13))


# ---------------------------------------------------------------------------------------------- picture

def points(observed, p):
    """Draw the bodies as lines between their hinges, and the spring."""
    e = observed[::2] + 1j * observed[1::2]
    O, A, B, C = (complex(*FIXED[name]) for name in "OABC")
    F, G, H = 0.007 * e[0], A + 0.04 * e[4], A - 0.04j * e[6]
    E, D = F - 0.028 * e[1], B + (0.02 - 0.018j) * e[2]
    drawn = np.array([O, F, E, B, D, G, A, H, C])
    return np.round(np.stack((drawn.real, drawn.imag), axis=1), 6)


SCENE = Scene(
    title="Andrews' squeezer", lesson="simulator",
    cases=CASES, duration=T, steps=STEPS,
    runners=RUNNERS,
    acceleration=lambda lessons: driven, start=start, run=run, observe=observe,
    truth=truth, truth_uncertainty=UNCERTAINTY,
    sanity_checks=sanity_checks,
    points=points, links=constantly([(0, 1), (1, 2), (2, 3), (3, 4), (4, 2), (2, 5), (5, 6), (2, 7), (7, 6), (4, 8)]),
    uses=("bodies that turn", "one matrix for all hinges", "loads", "no detection"),
    ablations={"contact of the bodies": "they lie in different planes and never touch"},
    exam=EXAM,
)
