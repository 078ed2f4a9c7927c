"""A box falls on a corner, an edge or a face: one, two or four points hit the floor at the same time."""

from typing import Annotated, NamedTuple

import numpy as np

from solutions.impulses import BodyState3D, check_restitution
from solutions.support.model import Body, make_model
from solutions.support.shapes import Box, HalfSpace
from validate.check import Whose, states
from validate.methods import IN_TURN, TOGETHER
from validate.reference.impulses import ONLY_ROUND_OFF, all_at_once, each_in_turn
from validate.reference.orientation import leaning, quaternion
from validate.scene import EXACT, PYBULLET, PYMUNK, Departure, Scene, engine, ours
from validate.scenes._common import ANSWER, built, check_positives

T = 1.0
HALF = np.array([0.1, 0.2, 0.3])       # half sizes [m]
TILT = {"corner": (0.5, 0.7), "edge": (0.5, 0.0), "face": (0.0, 0.0)}                 # about x, then about y [rad]
OVERLAP = 1e-12              # of the engines' bodies [m], so that they detect a contact
BRIEF = 1e-12                # their step [s]: nothing moves in it
ROUGH = 1e6                  # sticking friction in the lesson [-]: any cone is wide enough


class Params(NamedTuple):
    lands: str               # on a corner, an edge or a face; in the plane the last two are the same
    e: float                 # restitution [-]
    rough: float             # 1: it sticks, 0: frictionless
    flat: Annotated[float, "1: in the plane, where y is up"] = 0.0
    m: Annotated[float, "mass [kg]"] = 2.0
    fall: Annotated[float, "speed before [m/s]"] = 2.0


def case_name(p):
    return f"{p.lands}, {'sticks' if p.rough else 'smooth'}, e = {p.e:g}{', in the plane' if p.flat else ''}"


CASES = {
    case_name(p): p
    for flat, places in ((0.0, ("corner", "edge", "face")), (1.0, ("corner", "face")))
    for lands in places
    for rough in (0.0, 1.0)
    for e in (0.0, 0.5, 1.0)
    for p in (Params(lands, e, rough, flat),)
}


def moments(p):
    return p.m / 3.0 * (HALF @ HALF - HALF**2)


def turned(p):
    """Return R (3, 3)."""
    if p.flat:
        c, s = np.cos(TILT[p.lands][0]), np.sin(TILT[p.lands][0])
        return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    return leaning(*TILT[p.lands])


def landing(p):
    """Return (y = (v, ω), n, offsets of the points in contact, I⁻¹ in the world)."""
    up = np.array([0.0, 1.0, 0.0]) if p.flat else np.array([0.0, 0.0, 1.0])
    R = turned(p)
    both, third = (-1.0, 1.0), (0.0,) if p.flat else (-1.0, 1.0)
    corners = np.array([(a, b, c) for a in both for b in both for c in third]) * HALF @ R.T
    low = corners @ up
    y, inv_inertia = np.concatenate((-p.fall * up, np.zeros(3))), R @ np.diag(1.0 / moments(p)) @ R.T
    return y, up, corners[low < low.min() + 1e-9], inv_inertia


def start(p):
    check_positives(p, "m", "fall")
    check_restitution(p.e)
    y, n, r, inv_inertia = landing(p)
    body = BodyState3D(y[:3], y[3:], 1.0 / p.m, np.ascontiguousarray(inv_inertia))
    return body, r, np.tile(n, (len(r), 1)), ROUGH * p.rough


def run(lessons, step, acceleration, state, p, dt, steps):
    body, r, n, mu = state
    after, _ = step(body, r, n, p.e, mu)
    return after, r, n, mu


def observe(state, p):
    """Return the change of velocity and angular velocity."""
    return np.concatenate((state[0].v, state[0].omega)) - landing(p)[0]


def truth(p, t):
    """The changes v⁺ − v and ω⁺ − ω are those with which every point leaves with −e of its own normal velocity.

    A point that sticks also has no velocity along the floor.  The pseudo-inverse solves one linear system for all
    impulses.
    Source: Newton's restitution at every point; Mirtich and Canny 1995 for K.
    """
    y, n, r, inv_inertia = landing(p)
    return all_at_once(p.m, inv_inertia, y, r, n, p.e, p.rough) - y


def in_turn(p, t):
    """Return the same if the points act in sequence, each once."""
    y, n, r, inv_inertia = landing(p)
    return each_in_turn(p.m, inv_inertia, y, r, n, p.e, p.rough) - y


def sweeps_left(p, dt):
    """Sweeps stop when they change less than 1e-14 of 2 m/s; the remaining error is at most a hundred times that.

    The error of ω is larger, because the box is smaller than a metre.  The limit is relative to a change of 2 m/s
    or more.
    """
    return 100.0 * 1e-14 / HALF.min()


def overlap_left(p, dt):
    """The engines' boxes overlap by 1e-12 m, over arms of 0.1 m: ten times that, and a safety factor of ten."""
    return 1e-10


def model(p):
    """Make the box on the floor, in the plane or in space."""
    y, n, r, _ = landing(p)
    d = 2 if p.flat else 3
    q = TILT[p.lands][0] if p.flat else quaternion(turned(p))
    box = Body((-(r[0] @ n + OVERLAP) * n)[:d], p.m, Box(HALF[:d]), np.inf if p.rough else 0.0, p.e, q, y[:d])
    return make_model([box, Body(np.zeros(d), shape=HalfSpace(n[:d]), mu=1.0, e=1.0)], np.zeros(d))


def read(state, p):
    """Return the change of velocity and angular velocity."""
    v, omega = state.v[0], state.omega[0]
    return np.concatenate((v, (0.0, 0.0, 0.0, omega)) if p.flat else (v, omega)) - landing(p)[0]


def world(product, **settings):
    """Return make(p, dt) of an engine's runner.  Its one step is the impact, in which nothing moves."""
    make = built(product, model, read, iterations=2000, **settings)
    return lambda p, dt: make(p, BRIEF)


def flat(p):
    return p.flat == 1.0


def in_space(p):
    return p.flat == 0.0


def several_points(p):
    return p.lands != "corner"


UNTIL_SETTLED = "its sweeps stop at a change of 1e-14 of the speed, and the limit bounds the remaining error"
SMALL_OVERLAP = "its error is what 2,000 iterations and an overlap of 1e-12 m leave, and the limit bounds it"
RUNNERS = (
    ours(TOGETHER, limit=sweeps_left, predicted=UNTIL_SETTLED, order=EXACT),
    ours(IN_TURN, limit=sweeps_left, predicted=ONLY_ROUND_OFF, order=EXACT, supports=several_points,
         departure=Departure("each point sees the body as the previous one left it, so that the order of the points "
                             "counts", in_turn, Whose.LAW)),
    engine(PYMUNK, "", world(PYMUNK, overlap=0.0), "a Poly on a thick Segment, 2,000 iterations",
           order=EXACT, limit=overlap_left, predicted=SMALL_OVERLAP, supports=flat),
    engine(PYBULLET, "", world(PYBULLET, impacts=True), "a box on a box; maximal coordinates; contactERP, contactSlop, "
           "contactProcessingThreshold 0, 2,000 iterations",
           order=EXACT, limit=overlap_left, predicted=SMALL_OVERLAP, supports=in_space),
)


def quantity_names(p):
    return ["Δv_x [m/s]", "Δv_y [m/s]", "Δv_z [m/s]", "Δω_x [rad/s]", "Δω_y [rad/s]", "Δω_z [rad/s]"]


def sanity_checks():
    """Check that a smooth elastic impact keeps the energy, and that sticking points with e = 0 end at rest."""
    energies, left = [], []
    for p in CASES.values():
        y, _, r, inv_inertia = landing(p)
        end = truth(p, T) + y
        v, omega = end[:3], end[3:]
        if p.e == 1.0 and not p.rough:
            energies.append((p.m * v @ v + omega @ np.linalg.solve(inv_inertia, omega)) / (p.m * p.fall**2))
        if p.e == 0.0 and p.rough:
            left += [np.abs(v + np.cross(omega, arm)).max() for arm in r]
    return (
        states("energy after elastic impacts over energy before [-]", energies, 1.0, 1e-12),
        states("speed of points that stick, e = 0 [m/s]", left, 0.0, 1e-12),
        states(
            "velocity of a box that lands flat: e times the initial one [m/s]",
            truth(Params("face", 0.5, 1.0), T),
            (0.0, 0.0, 3.0, 0.0, 0.0, 0.0),
            1e-12,
        ),
    )


def outline(p):
    """Return (points (8, 2), pairs) of the box at the time of the impact, seen from the side."""
    sides = np.array([(a, b, c) for a in (-1.0, 1.0) for b in (-1.0, 1.0) for c in (-1.0, 1.0)])
    x = sides * HALF @ leaning(*TILT[p.lands]).T
    seen = x @ np.array([[0.35, 0.2], [1.0, 0.0], [0.0, 1.0]])
    pairs = [(i, j) for i in range(8) for j in range(i) if np.sum(sides[i] != sides[j]) == 1]
    return seen - (0.0, x[:, 2].min()), pairs


PICTURED = ("corner", "edge", "face")


def points(observed, p):
    return np.concatenate([outline(Params(lands, 0.0, 0.0))[0] + (1.0 * k, 0.0) for k, lands in enumerate(PICTURED)])


def links(p):
    pairs = outline(Params("face", 0.0, 0.0))[1]
    return [(8 * k + i, 8 * k + j) for k in range(len(PICTURED)) for i, j in pairs]


SCENE = Scene(
    title="A box lands", lesson="impulses",
    cases=CASES, **ANSWER,
    runners=RUNNERS,
    start=start, run=run, observe=observe,
    truth=truth, truth_uncertainty=1e-14, model=model, read=read,
    quantity_names=quantity_names,
    sanity_checks=sanity_checks,
    points=points, links=links,
    uses=("one body", "the offsets of the points in contact", "sweeps over them until nothing changes"),
    full_loop="one impact without time: there is no loop",
    ablations={
        "sliding points": ("at a sliding point the engines have laws of their own, which differ by up to 20 % of the "
                           "speed"),
        "time": "an impact takes none",
        "detection of the points": "lesson 6 finds them",
    },
)
