"""A rope of points on strings is released horizontally; as it falls, its end whips round."""

from typing import Annotated, NamedTuple

import numpy as np

from solutions.checks import BadInput
from solutions.given.pbd import make_constraint_network
from validate.check import states
from validate.engines.bullet import HINGES
from validate.methods import COMPOSED_ROPE, PBD, PROJECTION, RATTLE, RK4, ROPE, SYMPLECTIC_EULER, XPBD
from validate.reference.pbd import (
    Rope,
    RopeMotion,
    chipmunk_rope,
    composed_rope,
    rattle,
    rattle_once,
    rope_energy,
    rope_lag,
    rope_motion,
    rope_places,
    rope_rates,
    rope_slope,
)
from validate.reference.schemes import Motion
from validate.scene import EXACT, MUJOCO, PYBULLET, PYMUNK, Scene, by_order, engine, in_substeps, ours
from validate.scenes._common import built, check_positives
from validate.scenes.pbd._common import in_space, on_hinges, on_strings

T = 1.0                      # [s]
STEPS = (50, 100, 200, 600, 1000, 2000, 5000)
# of pymunk for each link: an impulse travels one link per iteration, in both directions
ITERATIONS = 10
FEWER = 3                    # with these the rope errs up to 20 % more, and is three times as fast


class Params(NamedTuple):
    links: Annotated[int, "N [-]"] = 10
    l: Annotated[float, "length of each [m]"] = 0.1
    m: Annotated[float, "each weight [kg]"] = 0.1
    sweeps: Annotated[int, "of PBD and XPBD per step [-]"] = 10
    g: Annotated[float, "gravity [m/s²]"] = 9.81


CASES = {"10 links": Params(), "50 links": Params(links=50)}


def straight(p):
    """Return (N, 2): the initial positions, with the rope along x."""
    return p.l * np.stack((np.arange(1.0, p.links + 1), np.zeros(p.links)), axis=1)


def start(p):
    check_positives(p, "links", "l", "m", "g")
    if p.sweeps < 1:
        raise BadInput("sweeps in a step", p.sweeps, "give 1 or more")
    x, n = np.concatenate((np.zeros((1, 2)), straight(p))), np.arange(p.links)
    pairs = np.stack((n, n + 1), axis=1)
    return x, 0.0 * x, make_constraint_network(x, p.m, [0], pairs, 0.0, 1.0, (0.0, -p.g), p.sweeps)


def run(lessons, step, acceleration, state, p, dt, steps):
    x, v, network = state
    return *lessons.integrators.advance(step, acceleration, 0.0, x, v, dt, steps, network), network


def observe(state, p):
    return state[0][1:, :2].ravel()


def truth(p, t):
    """Every point follows from the angles of the links, so links keep their length exactly.

    Tensions and angular accelerations follow from Newton's law, integrated by DOP853 at 1e-12.  Nothing is projected.
    """
    theta = rope_motion(p.links, p.l, p.m, p.g, T).sol(t)[:p.links]
    return rope_places(theta, p.l).ravel()


def of(p):
    """Return the arguments of the functions of the reference."""
    return p.links, p.l, p.m, p.g, T


def size(p):
    return np.linalg.norm(truth(p, T))


def beyond(p, dt):
    """Return the second-order part of the limits of order 1 and 2."""
    return rope_rates(*of(p))[1] * dt**2 + by_order(0.0, T, dt)[2]


def limits(p, dt):
    """The first order follows from the modified equation, integrated by DOP853.

    Beyond that a step has an error of (ρ dt)³, dt² ∫ρ³ dt in all, where ρ(t) is the rope's fastest rate at that
    time.  For the fourth order it is dt⁴ ∫ρ⁵ dt.
    """
    first = rope_lag(*of(p), late=1.0, ahead=0.5) / size(p) * dt + beyond(p, dt)
    return {1: first, 2: beyond(p, dt), 4: rope_rates(*of(p))[2] * dt**4 + by_order(0.0, T, dt)[4]}


def unfinished_limit(p, dt):
    """PBD and XPBD stop their sweeps before all links have their length.

    Even a single sweep leaves a link too long by at most the distance that its tension moves a point in one step, T
    dt²/m (the stability case stiffness-depends-on-dt gives it exactly).  Over N links the error of position is N
    times as large.  Links that are too long also change the forces, which adds ∫ρ dt times the same error again.
    """
    one, _, _, pull = rope_rates(*of(p))
    return limits(p, dt)[1] + p.links**1.5 * pull / p.m * dt**2 * (1.0 + one) / size(p)


def pymunk_limit(p, dt):
    """pymunk moves before it pulls, and its modified equation has another first order."""
    return rope_lag(*of(p), ahead=-0.5) / size(p) * dt + beyond(p, dt)


def leapfrog_limit(p, dt):
    """With a leapfrog start the first order is gone."""
    return beyond(p, dt)


def angles_limit(p, dt):
    """The coordinates of pybullet's links and of MuJoCo's are their angles.

    A step of order k errs by (ρ dt)ᵏ⁺¹ at most.  The sum is dt ∫ρ² dt for symplectic Euler, which is at most
    dt √(∫ρ dt ∫ρ³ dt) by Schwarz's inequality, and dt⁴ ∫ρ⁵ dt for Runge–Kutta.
    """
    one, three, five, _ = rope_rates(*of(p))
    floors = by_order(0.0, T, dt)
    return {1: np.sqrt(one * three) * dt + floors[1], 4: five * dt**4 + floors[4]}


def floor(p, dt):
    return by_order(0.0, T, dt)[EXACT] + 1e-10                # of the truth, DOP853 at 1e-12


def rope(p):
    return Rope(np.concatenate((np.zeros((1, 2)), straight(p))), p.l, p.g)


MOTION = RopeMotion(T, rope, lambda x: x[1:].ravel(), truth, floor)


def hanging(p):
    """Return θ̈(t, θ, ω) of all links, θ from straight down."""
    slope = rope_slope(p.l, p.m, p.g)
    return lambda t, theta, omega: slope(t, np.concatenate((theta, omega)))[p.links:]


def released(p):
    return np.full(p.links, 0.5 * np.pi), np.zeros(p.links)


def ends_of(theta, p):
    return rope_places(theta, p.l).ravel()


ANGLES = Motion(T, hanging, released, ends_of, truth, floor)


def short(p):
    """Return whether the rope is short: then the projection matrix is small, and few iterations do not diverge."""
    return p.links <= 20


def model(p):
    """Make the points on rods without mass."""
    return on_strings(straight(p), p.m, p.g)


def hinged(p):
    return on_hinges(straight(p), p.m, p.g)


def read(state, p):
    return state.x.ravel()


def in_pymunk(sweeps, **settings):
    """Return make(p, dt) of pymunk's runner, with so many iterations for each link."""
    return lambda p, dt: built(PYMUNK, model, read, iterations=sweeps * max(p.links, 10), **settings)(p, dt)


IMPLICIT = "it solves for all links together: only the first order of its error is known, and the limit contains it"
SWEPT = "its sweeps stop before all links have their length, and the remaining error is bounded, but not modelled"
FINER = (10_000, 20_000, 50_000)
HINGED = engine(PYBULLET, "", built(PYBULLET, hinged, read, maximal=False), HINGES,
                order=1, limit=angles_limit, predicted=ANGLES.predict(SYMPLECTIC_EULER.table), most_steps=5000,
                finer_in_full=FINER[:1])
RUNNERS = (
    ours(PROJECTION, limit=limits, predicted=IMPLICIT, supports=short, in_quick=False),      # the pendulum shows it
    ours(PBD, limit=unfinished_limit, predicted=SWEPT, compiled_in_quick=True),
    ours(XPBD, limit=unfinished_limit, predicted=SWEPT, compiled_in_quick=True),
    ours(RATTLE, limit=limits, predicted=MOTION.predict(rattle, 2)),
    ours(ROPE, limit=limits, predicted=MOTION.predict(rattle_once, 2)),
    ours(COMPOSED_ROPE, limit=limits, predicted=MOTION.predict(composed_rope, 4)),
    engine(PYMUNK, "", in_pymunk(ITERATIONS),
           f"PinJoints between masses that cannot turn; error_bias 0, {ITERATIONS} iterations for each link",
           order=1, limit=pymunk_limit, predicted=MOTION.predict_unfinished(chipmunk_rope, 1),
           most_steps=5000, finer_in_full=FINER),
    engine(PYMUNK, "leapfrog start", in_pymunk(FEWER, ahead=0.5),
           f"first velocities + ½ g dt; {FEWER} iterations for each link, which is three times as fast", order=2,
           limit=leapfrog_limit, predicted=MOTION.predict_unfinished(chipmunk_rope, 2, 0.5, 1.0), supports=short,
           most_steps=5000),
    HINGED,
    in_substeps(HINGED, 50),
    engine(MUJOCO, "", built(MUJOCO, hinged, read), "hinges; Runge–Kutta 4",
           order=4, limit=angles_limit, predicted=ANGLES.predict(RK4.table), most_steps=5000),
)


def sanity_checks():
    """Return Findings: conditions that the reference solution must meet."""
    claims = []
    for name, p in CASES.items():
        motion = rope_motion(p.links, p.l, p.m, p.g, T)
        energies = [rope_energy(motion.sol(t), p.l, p.m, p.g) for t in np.linspace(0.0, T, 21)]
        gained = np.ptp(energies) / (p.m * p.g * p.l * p.links**2)
        claims.append(states(f"{name}: energy gained over the weight times the length", gained, 0.0, 1e-9))
    p = CASES["10 links"]
    angles = [rope_motion(p.links, p.l, p.m, p.g, T, inertia).y[:p.links, -1] for inertia in (0.0, 1e-9 * p.m * p.l**2)]
    apart = np.abs(angles[0] - angles[1]).max()
    claims.append(states("10 links: from tensions and from Lagrange's equations [rad]", apart, 0.0, 1e-6))
    return tuple(claims)


def points(observed, p):
    return np.round(np.concatenate((np.zeros((1, 2)), observed.reshape(-1, 2))), 4)


def links(p):
    return [(n, n + 1) for n in range(p.links)]


SCENE = Scene(
    title="Rope", lesson="pbd",
    cases=CASES, duration=T, steps=STEPS,
    runners=RUNNERS,
    acceleration=lambda lessons: lessons.pbd.network_gravity, start=start, run=run, observe=observe,
    truth=truth, truth_uncertainty=1e-9, model=model, read=read,
    omitted_methods=("the projection method has a dense matrix of all points and links; a long rope would need a "
                     "sparse one, and pymunk more iterations"),
    # The reference solution alone takes seconds.
    slow_cases=("50 links",),
    sanity_checks=sanity_checks,
    points=points, links=links,
    uses=("two coordinates", "links, in sequence", "one step function"),
    ablations={
        "the third dimension": in_space(start),
        "contact of the rope with itself": "the whole loop of lesson 10 looks for it, and a full run measures it",
        "bending stiffness": "cloth_step of this lesson has it",
    },
)
