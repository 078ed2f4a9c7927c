"""A box tumbles through the air: a benchmark that compared four physics engines by what a motion must conserve.

It begins to turn almost about its middle axis, so that it turns over.  The benchmark knows no truth for the orientation
and compares angular momentum and energy.  Euler's equations give the orientation, too.
"""

from typing import Annotated, NamedTuple

import numpy as np
from scipy.special import ellipk

from solutions.given.rotation import check_moments
from solutions.rotation import RigidBody
from solutions.support.model import Body, make_model, rotation_of
from validate.check import states
from validate.methods import COMPOSED_SPLITTING, GYROSCOPIC, MIDPOINT_TURN, RUNGE_KUTTA, SPLITTING
from validate.reference.exams import Tossed, all_of, box_error, predict_tossed, tossed, world_rate
from validate.reference.orientation import quaternion_matrix
from validate.reference.turns import EXPLICIT_TERM, IMPLICIT_TERM, MUNTHE_KAAS
from validate.scene import MUJOCO, PYBULLET, Exam, Scene, by_order, engine, ours
from validate.scenes import drawing
from validate.scenes._common import built, check_positives, measured
from validate.scenes.drawing import axes_links, axes_seen, pose

T = 1.0                      # [s]: it has turned over nearly once
STEPS = (50, 100, 200, 500, 1000, 2000, 5000)
WHOLE = 10.0                 # how long the published problem lasts [s]
UNCERTAINTY = 1e-10          # of the truth: DOP853 at 1e-12
SIDES = np.array([0.1, 0.4, 0.9])        # [m]


class Params(NamedTuple):
    m: Annotated[float, "mass [kg]"] = 10.0
    w1: Annotated[float, "initial ω [rad/s]"] = 0.1
    w2: float = 5.0
    w3: float = 0.1
    v1: Annotated[float, "initial velocity [m/s]"] = -2.0
    v2: float = 2.0
    v3: float = 8.0
    g: Annotated[float, "gravity [m/s²]"] = 9.81

    def moments(self):
        return self.m * (np.sum(SIDES**2) - SIDES**2) / 12.0

    def omega(self):
        return np.array([self.w1, self.w2, self.w3])


CASES = {"complex": Params(), "simple": Params(w1=0.5, w2=0.0, w3=0.0, v1=-0.9, v2=0.4, v3=0.1, g=0.0)}


def body(p):
    return Tossed(tuple(map(float, p.moments())), tuple(map(float, p.omega())), (p.v1, p.v2, p.v3), (0.0, 0.0, -p.g))


def start(p):
    """Return (q, L, RigidBody, x, v) at R = 1."""
    check_positives(p, "m")
    check_moments(p.moments())
    return (np.array([1.0, 0.0, 0.0, 0.0]), p.moments() * p.omega(), RigidBody(p.m, p.moments()), np.zeros(3),
            np.array(body(p).v))


def falls(t, x, v, p):
    """Return the acceleration of gravity."""
    return np.array([0.0, 0.0, -p.g])


def run(lessons, step, acceleration, state, p, dt, steps):
    q, L, body_here, x, v = state
    q, L = lessons.rotation.advance_rotation(step, lessons.rotation.no_torque, 0.0, q, L, dt, steps, body_here)
    x, v = lessons.integrators.advance(lessons.integrators.verlet_step, acceleration, 0.0, x, v, dt, steps, p)
    return q, L, body_here, x, v


def observe(state, p):
    R = quaternion_matrix(*state[0])
    return all_of(R, world_rate(R, state[1], p.moments()), state[3], state[4])


def truth(p, t):
    """R, by rows, ω in the world, place and velocity: Euler's equations by DOP853 at 1e-12, and the parabola."""
    return tossed(body(p), t, T if t <= T else WHOLE)


def limits(p, dt):
    """The fastest rate is that of the rotation, |ω| times the ratio of the greatest to the smallest moment.

    Where a run can be predicted, an independent program of the same rotation says how far it errs.
    """
    return by_order(np.linalg.norm(p.omega()) * np.max(p.moments()) / np.min(p.moments()), T, dt)


def floor(p, dt):
    return 10.0 * UNCERTAINTY + 1e-15 * T / dt


def predicted(turn, ahead=0.0):
    return predict_tossed(T, body, turn, ahead, floor)


def model(p):
    return make_model([Body((0.0, 0.0, 0.0), p.m, inertia=tuple(map(float, p.moments())), v=body(p).v,
                            omega=body(p).omega)], body(p).gravity)


def read(state, p):
    return all_of(rotation_of(state.q[0]), state.omega[0], state.x[0], state.v[0])


IN_QUICK = {MIDPOINT_TURN: 500, SPLITTING: 500, COMPOSED_SPLITTING: 500, RUNGE_KUTTA: 200, GYROSCOPIC: 500}
RUNNERS = (
    *(ours(m, limit=limits, predicted=predicted(m.table), most_in_quick=most) for m, most in IN_QUICK.items()),
    engine(PYBULLET, "", built(PYBULLET, model, read), "maximal coordinates, no damping",
           order=1, limit=limits, predicted=predicted(IMPLICIT_TERM, 1.0)),
    engine(PYBULLET, "reduced coordinates", built(PYBULLET, model, read, maximal=False),
           "createMultiBody with its defaults, but no damping", order=1, limit=limits,
           predicted=predicted(EXPLICIT_TERM, 1.0)),
    engine(MUJOCO, "", built(MUJOCO, model, read), "freejoint; Runge–Kutta 4",
           order=4, limit=limits, predicted=predicted(MUNTHE_KAAS), most_steps=2000),
)


# ---------------------------------------------------------------------------------------------- published

def measure(outputs, reference):
    """Return the largest relative error of angular momentum or energy, from those at the start."""
    p = CASES["complex"]
    return box_error(outputs, truth(p, 0.0), p.moments(), p.m, body(p).gravity)


KEPT = "nothing that shows here: what is left is round-off of the fall"
SPLIT = "the energy of a turn, which errs without growing; L is a part of the state and stays as it is"
EXAM = Exam(
    organiser="scpeters/benchmark", problem="A tossed box, complex case",
    statement="A box of 0.1 × 0.4 × 0.9 m and 10 kg is tossed and turns almost about its middle axis. Compared are "
              "angular momentum and energy over 10 s with steps of 1 ms.",
    source="github.com/scpeters/benchmark, boxes; Peters and Hsu 2014",
    duration=WHOLE, outputs=100, steps=(10_000,),
    measure=measure, unit="larger of the largest relative errors of angular momentum and of energy", grade=None,
    enough=0.0,
    gives_up={MIDPOINT_TURN: KEPT, SPLITTING: SPLIT, COMPOSED_SPLITTING: KEPT + ", in five steps in place of one",
              RUNGE_KUTTA: "a little energy in every turn; most of what is left here is round-off of the fall",
              GYROSCOPIC: "L, of which a step of first order keeps neither size nor direction",
              PYBULLET: "the second order, and L", MUJOCO: "energy that stays: it changes a little in every turn"},
    published=(("Simbody", "relative error of angular momentum 0.0064"), ("Bullet", "0.0125; of energy 0.0136"),
               ("ODE", "0.0131"), ("DART", "2.19")),
    note="The published results are those of the engines of that time.")


def period(p):
    """Return the period of ω in the body [s].  Source: Landau and Lifshitz, Mechanics, § 37."""
    low, middle, high = np.sort(p.moments())
    twice_energy, squared = np.sum(p.moments() * p.omega() ** 2), np.sum((p.moments() * p.omega()) ** 2)
    if squared < twice_energy * middle:
        low, high = high, low
    k2 = (middle - low) * (twice_energy * high - squared) / ((high - middle) * (squared - twice_energy * low))
    return 4.0 * ellipk(k2) / np.sqrt((high - middle) * (squared - twice_energy * low) / (low * middle * high))


def rate_in_body(y):
    return y[:9].reshape(3, 3).T @ y[9:12]


def sanity_checks():
    """Return Findings: the published energies, and the period of ω in the body by an elliptic integral."""
    p, simple = CASES["complex"], CASES["simple"]
    rounded = lambda q: np.round(q.moments(), 6)                     # as the published Models have them
    energy = lambda q: 0.5 * q.m * np.dot(body(q).v, body(q).v) + 0.5 * np.sum(rounded(q) * q.omega() ** 2)
    return (states("energy of the simple and of the complex case, as published [J]", (energy(simple), energy(p)),
                   (5.001041625, 368.54641249999997), 1e-12),
            states("ω in the body after a period, by an elliptic integral [rad/s]", rate_in_body(truth(p, period(p))),
                   p.omega(), 1e-8),
            states("ω in the body after 1 s, by Euler's equations alone [rad/s]", rate_in_body(truth(p, T)),
                   (3.42379844, 2.81918544, 3.92838445), 1e-8),
            states("energy and angular momentum gained in 10 s, relative [-]",
                   box_error([truth(p, WHOLE)], truth(p, 0.0), p.moments(), p.m, body(p).gravity), 0.0, 1e-10))


# ---------------------------------------------------------------------------------------------- picture

def points(observed, p):
    return axes_seen(observed[:9], p)


def poses(observed, p):
    return [pose(observed[12:15], observed[:9].reshape(3, 3))]


SCENE = Scene(
    title="Tossed box", lesson="rotation",
    cases=CASES, duration=T, steps=STEPS,
    runners=RUNNERS,
    acceleration=lambda lessons: falls, start=start, run=run, observe=observe,
    truth=truth, truth_uncertainty=UNCERTAINTY,
    sanity_checks=sanity_checks,
    points=points, links=axes_links,
    bodies=lambda p: [drawing.box(0.5 * SIDES)], poses=poses,
    uses=("one orientation", "one angular momentum", "a parabola"),
    ablations={**measured("contacts")},
    exam=EXAM,
)
