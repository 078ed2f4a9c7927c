"""A semicircular arch of loose stones: its smallest thickness and its smallest friction.

An arch stands if *some* forces in its joints hold it.  A linear program searches for them.  The lesson's sweeps find
them, or accelerations if there are none.  The joints are redundant, so the forces are not unique, but the edge
between standing and falling is.
"""

from functools import partial
from typing import Annotated, NamedTuple

import numpy as np

from solutions.checks import BadInput
from solutions.contact import make_contacts
from validate.check import states
from validate.engines import watched
from validate.engines.bullet import UPRIGHT, WARM, WARMER, Rigid
from validate.engines.chipmunk import pymunk_space
from validate.methods import SWEEPS
from validate.reference.contact import arch, bisected, hinged_thickness, least_friction, least_thickness
from validate.scene import EXACT, PYBULLET, PYMUNK, Scene, engine, ours
from validate.scenes._common import ANSWER, check_positives, one_reading, sole_array
from validate.scenes.drawing import outlines

T = 1.0
G = 9.81                     # [m/s²]; no critical number depends on it
AT_REST = 1e-6               # acceleration that counts as none [m/s², rad/s²]
WIDTH = 1e-6                 # relative, at which bisection stops [-]
UNCERTAINTY = 1e-8           # of the linear program
WATCHED = 1.0                # duration of an engine's run [s]
MOVED = 0.02                 # [R]; a stone that has moved less stands: joints of engines close by up to 0.013
OVERLAP = 1e-6               # of pymunk's lowest stones at first [m]: it detects a contact only if bodies overlap
DENSITY = 1000.0             # of the engines' stones, 1 m deep [kg/m²]


class Params(NamedTuple):
    kind: Annotated[str, "thickness or friction: what is searched for"] = "thickness"
    n: Annotated[int, "stones"] = 4
    mu: Annotated[float, "friction, where the thickness is searched for [-]"] = 1.0
    t: Annotated[float, "thickness, where the friction is searched for [R]"] = 0.15


CASES = {
    "least thickness, 4 stones": Params(), "least thickness, 10 stones": Params(n=10),
    "least thickness, 20 stones": Params(n=20),
    "least friction, 4 stones": Params("friction"), "least friction, 10 stones": Params("friction", 10),
    "least friction, 10 thin stones": Params("friction", 10, t=0.108),
}


def start(p):
    check_positives(p, "mu", "t")
    if p.n < 3:
        raise BadInput("n", p.n, "give three stones or more")
    return (np.zeros(1),)


def given(p, number):
    """Return (t, μ), one of which is the number that is searched for."""
    return (number, p.mu) if p.kind == "thickness" else (p.t, number)


# ---------------------------------------------------------------------------------------------- ours

def stands(forces, p, number):
    """Return whether the contact solver finds no acceleration."""
    t, mu = given(p, number)
    stones, n = arch(p.n, t), p.n
    outward = np.stack((np.cos(stones.joints), np.sin(stones.joints)), axis=1)
    normals = np.stack((-outward[:, 1], outward[:, 0]), axis=1)
    places = np.stack([radius * outward for radius in stones.radii], axis=1).reshape(-1, 2)
    a, b = np.append(np.arange(n), n), np.append(n, np.arange(n))        # body n is the ground, at both springings
    inv_mass, inv_inertia = np.append(1.0 / stones.m, 0.0), np.append(1.0 / stones.inertia, 0.0)
    contacts = make_contacts(np.repeat(a, 2), np.repeat(b, 2), places, np.repeat(normals, 2, axis=0), inv_mass)
    load = np.zeros((n + 1, 3))
    load[:n, 1] = -G * stones.m
    x = np.vstack((stones.x, np.zeros(2)))
    _, acceleration = forces(x, inv_mass, inv_inertia, contacts, load, np.full(len(places), mu))
    return np.max(np.abs(acceleration)) < AT_REST


def run(lessons, step, acceleration, state, p, dt, steps):
    expected = truth(p, T)[0]
    return (np.array([bisected(lambda number: stands(step, p, number), 0.8 * expected, 1.3 * expected, WIDTH)]),)


def truth(p, t):
    """The truth is the smallest number for which a linear program finds forces that hold every stone: f_n ≥ 0 and
    |f_t| ≤ μ f_n at both ends of each joint.

    Heyman's safe theorem says that such an arch stands if no joint can slide.  Where a joint is at the limit of
    friction, such forces are necessary and, in theory, not sufficient.  The sanity checks compare the thickness with
    moments about hinges, by hand.
    Source: Couplet 1730, Milankovitch 1907, Heyman 1969; SciPy's linprog.
    """
    return np.array([least_thickness(p.n, p.mu) if p.kind == "thickness" else least_friction(p.n, p.t)])


def limit(p, dt):
    """An arch whose number is below the critical one by the fraction δ falls with about 10 g δ.  An acceleration of
    1e-6 m/s² means δ = 1e-8.  The bisection stops at 1e-6.
    """
    return AT_REST / G + WIDTH + UNCERTAINTY


def unknown(p, dt):
    """Any disturbance brings down an arch near its smallest thickness.  Engines disturb it, because gravity acts for
    a step before the joints carry.  No theory says how much more thickness they need, so their errors are shown.  The
    laws of contact judge what they report of their runs nearest to the edge.
    """
    return np.inf


# ---------------------------------------------------------------------------------------------- engines

def corners(stones, k):
    """Return the corners (4, 2) of stone k, from its centre of mass."""
    ends = [(radius, stones.joints[j]) for radius, j in zip((*stones.radii, *stones.radii[::-1]), (k, k, k + 1, k + 1))]
    return np.array([(radius * np.cos(theta), radius * np.sin(theta)) for radius, theta in ends]) - stones.x[k]


def pymunk_stands(p, number, kept, dt, iterations, slop):
    """Return whether all stones are within MOVED of their positions after WATCHED; kept: gets its watched steps."""
    import pymunk
    (t, mu), space, bodies = given(p, number), pymunk_space((0.0, -G)), []
    space.iterations, space.collision_slop = iterations, slop
    ground = pymunk.Segment(space.static_body, (-5.0, -1.0), (5.0, -1.0), 1.0)
    ground.friction = np.sqrt(mu)                                        # pymunk multiplies the two
    space.add(ground)
    stones = arch(p.n, t)
    for k in range(p.n):
        body = pymunk.Body(DENSITY * stones.m[k], DENSITY * stones.inertia[k])
        body.position = (float(stones.x[k, 0]), float(stones.x[k, 1]) - OVERLAP)
        stone = pymunk.Poly(body, [tuple(map(float, corner)) for corner in corners(stones, k)])
        stone.friction = np.sqrt(mu)
        space.add(body, stone)
        bodies.append(body)
    watched.run(watched.Pymunk(space, dt), round(WATCHED / dt), kept)
    return np.max(np.abs(np.array([body.position for body in bodies]) - stones.x)) < MOVED


def pybullet_stands(p, number, kept, dt, iterations, residual, warm=WARM):
    """Return whether all stones are within MOVED of their positions after WATCHED; kept: gets its watched steps.

    The ground has maximal coordinates, as the stones have: else its contacts would have a cone of friction, and those
    between stones a pyramid.
    """
    (t, mu), bullet, bodies = given(p, number), Rigid(dt, (0.0, 0.0, -G), iterations), []
    pb = bullet.pb
    pb.setPhysicsEngineParameter(solverResidualThreshold=residual, contactSlop=1e-5)
    slab = pb.createCollisionShape(pb.GEOM_BOX, halfExtents=[5.0, 5.0, 1.0])
    ground = pb.createMultiBody(0, slab, basePosition=[0.0, 0.0, -1.0], useMaximalCoordinates=1)
    pb.changeDynamics(ground, -1, lateralFriction=np.sqrt(mu), restitution=0)
    stones = arch(p.n, t)
    for k in range(p.n):
        hull = [[float(c[0]), y, float(c[1])] for c in corners(stones, k) for y in (-0.25, 0.25)]
        moment = DENSITY * stones.inertia[k]
        bodies.append(bullet.body(DENSITY * stones.m[k], (10.0 * moment, moment, 10.0 * moment),
                                  (stones.x[k, 0], 0.0, stones.x[k, 1]), (0.0,) * 3, True, R=UPRIGHT,
                                  shape=pb.createCollisionShape(pb.GEOM_MESH, vertices=hull), mu=np.sqrt(mu)))
    bullet.begin()
    pb.setPhysicsEngineParameter(warmStartingFactor=warm)
    watched.run(watched.Bullet(pb, dt, bullet.gravity), round(WATCHED / dt), kept)
    x = np.array([bullet.position(body) for body in bodies])[:, [0, 2]]
    bullet.close()
    return np.max(np.abs(x - stones.x)) < MOVED


def make(p, dt, holds):
    """Make the EngineRun of an engine in which an arch holds or falls: the bisection is one long reading."""
    tried = watched.NearTheEdge(partial(holds, p))

    def read():
        expected = truth(p, T)[0]
        return np.array([bisected(tried, 0.5 * expected, 2.0 * expected, 1e-3)])
    return one_reading(read, watched=tried.steps)


def thick(p):
    """Return whether the stones are thick and few: in the engines thin stones fall before they slide."""
    return p.t >= 0.15 and p.n <= 10


BISECTED = "its bisection and its sweeps stop at a given accuracy, and the limit bounds the remaining error"
NUDGED = {"order": EXACT, "limit": unknown, "supports": thick,
          "predicted": "no theory says how much more thickness or friction a nudged arch needs"}
RUNNERS = (
    ours(SWEEPS, limit=limit, predicted=BISECTED, order=EXACT),
    engine(PYMUNK, "", partial(make, holds=partial(pymunk_stands, dt=1e-3, iterations=100, slop=1e-5)),
           "polygons; 100 iterations, collision_slop 1e-5; stands if nothing moves by R/50 in 1 s of 1/1000 s",
           laws=watched.pymunk_rules(100), **NUDGED),
    engine(PYMUNK, "default", partial(make, holds=partial(pymunk_stands, dt=1.0 / 240.0, iterations=10, slop=0.1)),
           "polygons; 10 iterations, collision_slop 0.1; 1 s of 1/240 s", laws=watched.pymunk_rules(10), **NUDGED),
    engine(PYBULLET, "",
           partial(make, holds=partial(pybullet_stands, dt=1.0 / 240.0, iterations=200, residual=0, warm=WARMER)),
           f"hulls, maximal coordinates; solverResidualThreshold 0, 200 iterations, warmStartingFactor {WARMER}; "
           "1 s of 1/240 s",
           laws=watched.bullet_rules(200, creeps=True), **NUDGED),
    engine(PYBULLET, "default",
           partial(make, holds=partial(pybullet_stands, dt=1.0 / 240.0, iterations=50, residual=1e-7)),
           f"hulls, maximal coordinates; 50 iterations, warmStartingFactor {WARM}; 1 s of 1/240 s",
           laws=watched.bullet_rules(50, creeps=True), **NUDGED),
)


def quantity_names(p):
    return ["least thickness over the mean radius [-]" if p.kind == "thickness" else "least friction [-]"]


def sanity_checks():
    """Return Findings: hinges by hand, published numbers, and that more friction helps."""
    hinges = [hinged_thickness(n) for n in (4, 10)]
    return (states("least t/R by moments about hinges, 4 and 10 stones [-]", hinges,
                   (least_thickness(4, 1.0), least_thickness(10, 1.0)), 2e-8),
            states("Milankovitch's least t/R, 4,000 stones [-]", hinged_thickness(4000), 0.1075, 5e-5),
            states("least friction at t/R = 0.108 and 0.15 [-]", [least_friction(10, t) for t in (0.108, 0.15)],
                   (0.39465, 0.35025), 5e-6))


# ---------------------------------------------------------------------------------------------- picture

ARC = 6                      # points of each curved side of a stone in the picture


def points(observed, p):
    """Draw the outlines of all stones, and the ground; if the friction is searched for, with the given thickness."""
    stones, outlines = arch(p.n, given(p, float(np.asarray(observed)[0]))[0]), []
    for k in range(p.n):
        theta = np.linspace(stones.joints[k], stones.joints[k + 1], ARC)
        side = np.stack((np.cos(theta), np.sin(theta)), axis=1)
        outlines += [stones.radii[0] * side, stones.radii[1] * side[::-1]]
    return np.round(np.vstack((*outlines, [(-1.4, 0.0), (1.4, 0.0)])), 5)


def links(p):
    m = 2 * ARC
    return [*outlines(m, p.n), (m * p.n, m * p.n + 1)]


SCENE = Scene(
    title="Masonry arch", lesson="contact",
    cases=CASES, **ANSWER,
    runners=RUNNERS,
    start=start, run=run, observe=sole_array,
    truth=truth, truth_uncertainty=UNCERTAINTY,
    slow_cases=tuple(CASES)[1:],
    omitted_methods="Murty's method has no friction; the pile holds boxes, not the stones of an arch",
    quantity_names=quantity_names,
    published_states=((1.0, (0.100861,), 5e-7),),
    sanity_checks=sanity_checks,
    points=points, links=links,
    uses=("rows of all contacts", "the cone of friction in the plane", "sweeps until the residual vanishes"),
    full_loop="nothing moves here, so there is no loop",
    ablations={"motion": "a standing arch does not move; a falling one is not followed",
               "curved stones": "only the ends of the joints touch, and the centre of mass is that of a sector"},
)
