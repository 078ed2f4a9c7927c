"""A block slides down a wedge that slides away under it.  There is no friction, so momentum along the floor stays zero.

The forces at three contacts are constant.  A loop that finds them exactly has exact velocities, and its positions lag
by half a step.  With the mean of the velocities before and after each step the positions are exact, too.  Two
coordinates need no contacts at all: the place of the wedge, and the way of the block along its slope.
"""

from functools import partial
from typing import Annotated, NamedTuple

import numpy as np

from solutions.simulator import make_bodies_2d
from solutions.support.model import Body, make_model
from solutions.support.shapes import Box, HalfSpace
from validate.check import states
from validate.engines.bullet import CONTACT_ERP
from validate.methods import IN_COORDINATES, LOOP_2D, LOOP_WITH_MEANS
from validate.reference.friction import NOTHING_LEFT
from validate.reference.simulator import wedge_pushed_out
from validate.scene import EXACT, PYBULLET, PYMUNK, ROUND_OFF, Prediction, Scene, engine, ours
from validate.scenes._common import FEW, after_few_iterations, built, check_positives, round_off
from validate.scenes.drawing import outlines
from validate.worlds.bullet import WIDE

T = 0.4                      # [s]
STEPS = (8, 16, 40, 80, 160, 400, 800)
SWEEPS = 25                  # [-]; each leaves less than a third of the error
IN_PYMUNK = 20               # iterations [-]
FEWER = 3, 5                 # of pymunk and pybullet in the timed case: as exact there, at up to six times the speed
MARGIN = 0.01                # [m]
OVERLAP = 1e-6               # of the engines' bodies at the start [m]
LONG, THICK = 0.5, 0.3       # half sizes of the box that is the wedge [m]
# pybullet's contactBreakingThreshold [-]: a contact point lags behind by the way of the block in a step
KEPT = 1.0
ABOVE = -0.35                # where the block begins, along the slope from its middle [m]


class Params(NamedTuple):
    degrees: Annotated[float, "slope of the wedge [°]"] = 30.0
    m: Annotated[float, "mass of the block [kg]"] = 1.0
    M: Annotated[float, "mass of the wedge [kg]"] = 2.0
    half: Annotated[float, "half size of the block [m]"] = 0.1
    g: Annotated[float, "gravity [m/s²]"] = 9.81


CASES = {"30°": Params(), "45°, light wedge": Params(degrees=45.0, M=0.5),
         "10°, heavy wedge": Params(degrees=10.0, M=50.0)}


def slope(p):
    return np.radians(p.degrees)


def normal(p):
    return np.array([np.sin(slope(p)), np.cos(slope(p))])


def places(p):
    """Return the centres (2, 2) [m] of the wedge, which is a box on its corner, and of the block on its upper side."""
    n, down = normal(p), np.array([np.cos(slope(p)), -np.sin(slope(p))])
    low = LONG * np.sin(slope(p)) + THICK * np.cos(slope(p))
    wedge = np.array([0.0, low])
    return np.array([wedge, wedge + (THICK + p.half) * n + ABOVE * down])


def start(p):
    """Return (PileState, Bodies), and the two coordinates and their rates.

    The wedge cannot rotate: an infinite moment of inertia replaces its wide foot.
    """
    check_positives(p, "degrees", "m", "M", "half", "g")
    moments, half = np.array([np.inf, 2.0 / 3.0 * p.m * p.half**2]), np.array([(LONG, THICK), (p.half, p.half)])
    bodies = make_bodies_2d(places(p), np.full(2, -slope(p)), np.array([p.M, p.m]), moments, half,
                            np.array([(0.0, 1.0, 0.0)]), np.array([0.0, -p.g]), 0.0, SWEEPS, MARGIN)
    return *bodies, np.zeros(2), np.zeros(2)


def slides(t, q, rates, p):
    """Return the accelerations [m/s²] of X, the way of the wedge, and of s, that of the block along the slope.

    (M + m) Ẍ + m cos θ s̈ = 0,      cos θ Ẍ + s̈ = g sin θ
    *Source:* Lagrange's equations of  ½ M Ẋ² + ½ m (Ẋ² + 2 Ẋ ṡ cos θ + ṡ²) + m g s sin θ.
    """
    theta = np.radians(p.degrees)
    share = p.m * np.cos(theta) / (p.M + p.m)
    along = p.g * np.sin(theta) / (1.0 - share * np.cos(theta))
    return np.array([-share * along, along])


def run(lessons, step, acceleration, state, p, dt, steps):
    """Move the bodies.  A method that moves the two coordinates returns None in place of them."""
    simulator, (now, bodies_here, q, rates) = lessons.simulator, state
    if step is lessons.integrators.verlet_step:
        return None, bodies_here, *lessons.integrators.advance(step, acceleration, 0.0, q, rates, dt, steps, p)
    shape = simulator.box_bounds_2d, simulator.box_contacts_2d
    moved = simulator.advance_contact(step, simulator.weight, *shape, 0.0, now, dt, steps, bodies_here)
    return moved, bodies_here, q, rates


def observe(state, p):
    """Return x of the wedge, x and y of the block [m], and the same of their velocities [m/s]."""
    now, _, q, rates = state
    if now is None:
        x, along = places(p), np.array([np.cos(slope(p)), -np.sin(slope(p))])
        return np.array([q[0], *(x[1] + (q[0], 0.0) + q[1] * along), rates[0], *((rates[0], 0.0) + rates[1] * along)])
    return np.array([now.x[0, 0], now.x[1, 0], now.x[1, 1], now.v[0, 0], now.v[1, 0], now.v[1, 1]])


def accelerations(p):
    """Return the accelerations [m/s²] of the wedge along x, and of the block along x and y.

    With N the force between both: M A = −N sin θ,  m a_x = N sin θ,  m a_y = N cos θ − m g, and the block stays on the
    slope: a_y = −(a_x − A) tan θ.
    """
    s, c = np.sin(slope(p)), np.cos(slope(p))
    A = p.m * p.g * s * c / (p.M + p.m * s * s)
    a_x = p.M / p.m * A
    return np.array([-A, a_x, -(a_x + A) * s / c])


def truth(p, t):
    """Constant accelerations: A = m g sin θ cos θ/(M + m sin²θ) of the wedge.

    Source: `accelerations`; a common exercise, e.g. Morin 2008, Introduction to Classical Mechanics, “Moving plane”.
    """
    a, x = accelerations(p), places(p)
    begin = np.array([x[0, 0], x[1, 0], x[1, 1]])
    return np.concatenate((begin + 0.5 * a * t * t, a * t))


def lag(p, dt):
    """Return ½ a dt T (3,) [m], by which positions with the new velocities lag behind."""
    return 0.5 * accelerations(p) * dt * T


def relative_lag(p, dt):
    return np.linalg.norm(lag(p, dt)) / np.linalg.norm(truth(p, T))


def loop_limit(p, dt):
    """Positions with the new velocities are ahead by ½ a dt T, with the old ones behind by the same.

    Velocities are exact.

    Ours: if a sweep leaves the share ρ of an impulse, 25 sweeps leave ρ²⁵ in the first step.  Later steps, which start
    warm, remove it.
    """
    return 1.001 * relative_lag(p, dt) + contraction(p) ** SWEEPS * dt / T + 1e-9 + T / dt * ROUND_OFF


def mean_limit(p, dt):
    """With mean velocities only the error that the sweeps leave is present.  A gap is rounded, and closed within
    one step: that adds some 1e-12 to the velocities.
    """
    return contraction(p) ** SWEEPS * dt / T + 5e-12 + T / dt * ROUND_OFF


def pymunk_limit(p, dt):
    """pymunk: both overlaps, and what its iterations leave in the first step, which has no warm start."""
    pressed_in, left = 2.0 * OVERLAP / np.linalg.norm(truth(p, T)), contraction(p) ** IN_PYMUNK
    return 1.001 * relative_lag(p, dt) + pressed_in + left * dt / T


def bullet_limit(p, dt):
    """pybullet: both overlaps, and a fraction of them over the first step in the velocities, as long as the block
    moves by less than its half size in a step.  Its contact points are twice as far apart, and it matches those of
    the last step by the nearest place.  With longer steps it may take one point for another.
    """
    pushed = (4.0 + 2.0 * CONTACT_ERP / dt) * OVERLAP / np.linalg.norm(truth(p, T))
    return relative_lag(p, dt) + pushed + turned(p) if carried(p, dt) else np.inf


def is_timed(p):
    """Return whether it is the first case.  On another slope few iterations lose the block in the longest steps."""
    return p == CASES["30°"]


def contraction(p):
    """Return the fraction of an error that a sweep of Gauss–Seidel leaves: the spectral radius of its iteration.

    The contacts are the wedge's corner on the floor and two corners of the block on the wedge.  The block has r²/I =
    1.5/m for the corners of its face; the floor pushes the wedge up, the block pushes it along −n.
    """
    s = -np.cos(slope(p)) / p.M
    own, other = 2.5 / p.m + 1.0 / p.M, -0.5 / p.m + 1.0 / p.M
    A = np.array([(1.0 / p.M, s, s), (s, own, other), (s, other, own)])
    return np.max(np.abs(np.linalg.eigvals(np.linalg.solve(np.tril(A), np.triu(A, 1)))))


def carried(p, dt):
    """Return whether pybullet's block keeps its four contact points."""
    A, a_x, a_y = accelerations(p)
    return np.hypot(a_x - A, a_y) * T * dt < p.half


def turned(p):
    """Return the relative error of pybullet's wedge, which rotates by φ because its moment of inertia is finite.

    The floor carries (M + m) g at one corner, and the block presses with m g.  The moment is at most their sum
    times half of the diagonal.  With φ the places on the wedge move, and the direction of the block's acceleration
    turns.
    """
    reach = np.hypot(LONG, THICK)
    angle = 0.5 * (p.M + 2.0 * p.m) * p.g * reach / WIDE * T**2
    return angle * np.hypot(reach + 0.5 * p.g * T**2, p.g * T) / np.linalg.norm(truth(p, T))


def lag_error(p, dt, sign, limit):
    """The error is +½ a dt T in the positions with the new velocities, −½ a dt T with pymunk's old ones, and zero in
    velocities.  The band is what the solvers leave: the rest of the limit.
    """
    return Prediction(np.append(sign * lag(p, dt), np.zeros(3)), limit(p, dt) - abs(sign) * relative_lag(p, dt))


def bullet_error(p, dt):
    """pybullet removes a fraction of the overlap of each contact per step, by a velocity that it adds.  The recursion
    of both overlaps predicts the end.
    """
    if not carried(p, dt):
        return None
    way, v = wedge_pushed_out((p.M, p.m), slope(p), p.g, OVERLAP, CONTACT_ERP, dt, round(T / dt))
    begin = places(p) - np.array([(0.0, OVERLAP)]) - np.outer((0.0, OVERLAP), normal(p))
    return Prediction(np.delete(np.concatenate((begin.ravel() + way, v)), (1, 5)) - truth(p, T),
                      turned(p) + 1e-14 + T / dt * ROUND_OFF)


def model(p):
    """Make a wedge, which is a box that cannot turn, and a block on it. """
    x, q = places(p), -slope(p)
    return make_model([Body(tuple(x[0]), p.M, Box((LONG, THICK)), q=q, inertia=np.inf),
                       Body(tuple(x[1]), p.m, Box((p.half, p.half)), q=q),
                       Body((0.0, 0.0), shape=HalfSpace((0.0, 1.0)))], (0.0, -p.g))


def read(state, p):
    return np.array([state.x[0, 0], *state.x[1], state.v[0, 0], *state.v[1]])


world = partial(built, model=model, read=read, overlap=OVERLAP)
in_pybullet = partial(world, PYBULLET, slop=0.0, breaking=KEPT)
SETTINGS = f"no residual threshold, no slop, contactBreakingThreshold {KEPT:g}, overlaps of 1e-6 m"
PYMUNK_ERROR = partial(lag_error, sign=-1.0, limit=pymunk_limit)
RUNNERS = (
    ours(LOOP_2D, limit=loop_limit, predicted=partial(lag_error, sign=1.0, limit=loop_limit)),
    ours(LOOP_WITH_MEANS, order=EXACT, limit=mean_limit, predicted=partial(lag_error, sign=0.0, limit=mean_limit)),
    ours(IN_COORDINATES, order=EXACT, limit=round_off(T), predicted=NOTHING_LEFT),
    engine(PYMUNK, "", world(PYMUNK, iterations=IN_PYMUNK),
           f"a box with an infinite moment; {IN_PYMUNK} iterations, collision_slop 1e-5, overlaps of 1e-6 m",
           order=1, limit=pymunk_limit, predicted=PYMUNK_ERROR),
    engine(PYBULLET, "", in_pybullet(maximal=False),
           f"two boxes in reduced coordinates, no damping; 100 iterations, {SETTINGS}",
           order=1, limit=bullet_limit, predicted=bullet_error),
    engine(PYBULLET, "maximal coordinates", in_pybullet(),
           f"the same in maximal coordinates; 100 iterations, {SETTINGS}; a step without gravity beforehand, after "
           "which the moments count", order=1, limit=bullet_limit, predicted=bullet_error),
    engine(PYMUNK, "fewer iterations", world(PYMUNK, iterations=FEWER[0]), f"the same with {FEWER[0]} iterations",
           order=1, limit=after_few_iterations(pymunk_limit), predicted=FEW, supports=is_timed),
    engine(PYBULLET, "fewer iterations", in_pybullet(iterations=FEWER[1]),
           f"maximal coordinates; {FEWER[1]} iterations, {SETTINGS}; a step without gravity beforehand",
           order=1, limit=after_few_iterations(bullet_limit), predicted=FEW, supports=is_timed),
)


def points(observed, p):
    """Draw the wedge as a triangle, the block, and the floor."""
    s, c = np.sin(slope(p)), np.cos(slope(p))
    X, x, y = observed[:3]
    top = np.array([(-LONG, THICK), (LONG, THICK)]) @ np.array([(c, -s), (s, c)]) + np.array([X, places(p)[0, 1]])
    wedge = np.array([top[0], top[1], (top[1, 0], 0.0), (top[0, 0], 0.0)])
    block = np.array([(1, 1), (-1, 1), (-1, -1), (1, -1)]) * p.half @ np.array([(c, -s), (s, c)]) + np.array([x, y])
    return np.vstack((wedge, block, ((-1.5, 0.0), (1.5, 0.0))))


def links(p):
    return [*outlines(4, 2), (8, 9)]


def sanity_checks():
    """Return Findings: the published number, momentum, energy, and the slope."""
    p = Params()
    end, begin = truth(p, T), truth(p, 0.0)
    fall = p.m * p.g * (begin[2] - end[2])
    motion = 0.5 * p.M * end[3] ** 2 + 0.5 * p.m * (end[4] ** 2 + end[5] ** 2)
    way = end[1] - begin[1] - (end[0] - begin[0])
    return (states("acceleration of the wedge [m/s²]", -accelerations(p)[0], 1.8879353802500762, 1e-14),
            states("momentum along the floor [kg m/s]", p.M * end[3] + p.m * end[4], 0.0, 1e-14),
            states("energy of motion over that of the fall [-]", motion / fall, 1.0, 1e-14),
            states("fall over the way along the slope [-]", (begin[2] - end[2]) / way, np.tan(slope(p)), 1e-14))


SCENE = Scene(
    title="A wedge that slides away", lesson="simulator",
    cases=CASES, duration=T, steps=STEPS,
    runners=RUNNERS,
    acceleration=lambda lessons: slides, start=start, run=run, observe=observe,
    truth=truth, truth_uncertainty=1e-15, model=model, read=read,
    slow_cases=("45°, light wedge", "10°, heavy wedge"),
    sanity_checks=sanity_checks,
    points=points, links=links,
    uses=("boxes in the plane", "three contacts", "sweeps with memory"),
    ablations={"friction": "without it momentum along the floor stays, and the motion has a closed form",
               "rotation of the wedge": "a wide foot would carry its moments; ours has an inverse inertia of zero"},
)
