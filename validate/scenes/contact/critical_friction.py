"""Critical friction: a ladder, discs, a box and an overhang, at the edge between standing and falling.

A scene stands if the contact solver finds no acceleration.  Its critical number is found by bisection: the smallest
friction, the steepest slope or the longest overhang that stands.  An engine runs for a second instead, and bodies
that have moved by less than a millimetre stand.
"""

from functools import partial
from typing import Annotated, NamedTuple

import numpy as np

from solutions.checks import check_positive
from solutions.contact import make_contacts
from solutions.support.model import Body, make_model
from solutions.support.shapes import Ball, Box, HalfSpace
from validate.check import states
from validate.engines import watched
from validate.engines.bullet import WARM, WARMER
from validate.methods import SWEEPS
from validate.scene import EXACT, PYBULLET, PYMUNK, Scene, engine, ours
from validate.scenes._common import ANSWER, one_reading, sole_array
from validate.scenes.contact._common import DT, WATCHED, stands_in
from validate.scenes.drawing import circle

T = 1.0
G = 9.81                     # [m/s²]; no critical number depends on it
AT_REST = 1e-8               # acceleration that counts as none [m/s², rad/s²]: sweeps leave some 1e-10
WIDTH = 1e-9                 # relative, at which bisection stops [-]
UP, DOWN = (0.0, 1.0), np.array([0.0, -1.0])
MOVED = 1e-3                 # a body that has moved less stands [m]
THIN = 2e-5                  # thickness of the engines' ladder, which is a board [m]
HEIGHT = 0.2                 # of a block of the overhang, over its length [-]


BETWEEN, GROUND = "discs, between", "discs, ground"          # three discs; where their friction is looked for


class Params(NamedTuple):
    kind: Annotated[str, "what stands"] = BETWEEN
    degrees: Annotated[float, "angle of the ladder from the floor [°]"] = 60.0
    mu: Annotated[float, "friction that is given [-]"] = 1.0
    slim: Annotated[float, "width of the box over its height [-]"] = 0.4
    blocks: Annotated[int, "of the overhang"] = 3


DISCS, LADDER, BOX, OVERHANG = ("discs: friction between them", "ladder at 60°", "box that topples",
                                "overhang of three blocks")
CASES = {
    LADDER: Params("ladder"), "ladder at 40°": Params("ladder", degrees=40.0),
    "ladder at 75°": Params("ladder", degrees=75.0),
    DISCS: Params(), "discs: friction at the ground": Params(GROUND),
    BOX: Params("box", mu=0.6), "box that slides": Params("box", mu=0.3),
    OVERHANG: Params("overhang"), "overhang of five blocks": Params("overhang", blocks=5),
}


def start(p):
    for name in ("degrees", "mu", "slim", "blocks"):
        check_positive(name, float(getattr(p, name)))
    return (np.zeros(1),)


def of_discs(p):
    return p.kind in (BETWEEN, GROUND)


# ---------------------------------------------------------------------------------------------- ours

def scene_of(p, number):
    """Return (x, masses, moments, [(a, b, place, normal, friction)], direction of gravity); mass 0 means immovable."""
    if of_discs(p):                                           # radius ½; the lower two do not quite touch
        x, (between, ground) = places_of(p, number), frictions_of(p, number)
        touch = [(1, 0, (-0.5, 0.0), UP, ground), (2, 0, (0.5, 0.0), UP, ground)]
        touch += [(3, k, 0.5 * (x[3] + x[k]), x[3] - x[k], between) for k in (1, 2)]
        return x, np.array([0.0, 1.0, 1.0, 1.0]), np.full(4, 0.125), touch, DOWN
    if p.kind == "ladder":
        end = ladder_end(p)
        touch = [(1, 0, -end, UP, number), (1, 0, end, (-1.0, 0.0), 0.0)]
        return places_of(p, number), np.array([0.0, 1.0]), np.full(2, 1.0 / 12.0), touch, DOWN
    if p.kind == "box":
        touch = [(1, 0, (side, 0.0), UP, p.mu) for side in (-0.5 * p.slim, 0.5 * p.slim)]
        moment = (p.slim**2 + 1.0) / 12.0
        return places_of(p, number), np.array([0.0, 1.0]), np.full(2, moment), touch, leaning(number)
    x, touch = places_of(p, number), []
    for k in range(p.blocks):                                 # from the left end above to the right end below
        for side in (x[k, 0] - 0.5, x[k + 1, 0] + 0.5):
            touch.append((k, k + 1, (side, x[k, 1] - 0.5 * HEIGHT), UP, p.mu))
    moments = np.full(p.blocks + 1, (1.0 + HEIGHT**2) / 12.0)
    return x, np.append(np.ones(p.blocks), 0.0), moments, touch, DOWN


def places_of(p, number):
    """Return the centres [m] of all bodies; those of the overhang from the top, with the table last."""
    if of_discs(p):
        return np.array([(0.0, -1.0), (-0.5, 0.5), (0.5, 0.5), (0.0, 0.5 + np.sqrt(0.75))])
    if p.kind == "ladder":
        return np.array([(0.0, -1.0), (0.0, 0.0)])
    if p.kind == "box":
        return np.array([(0.0, -1.0), (0.0, 0.5)])
    reach = number / harmonic(p.blocks) / (2.0 * np.arange(1, p.blocks + 1))             # of each over the one below it
    heights = HEIGHT * (p.blocks - np.arange(p.blocks + 1) - 0.5)
    return np.stack((-np.cumsum(np.append(0.0, reach)), heights), axis=1)


def frictions_of(p, number):
    """Return (friction between the discs, friction at the ground)."""
    return (number, p.mu) if p.kind == BETWEEN else (p.mu, number)


def ladder_end(p):
    """Return the vector from the centre of the ladder to its upper end [m]."""
    return 0.5 * np.array([np.cos(np.radians(p.degrees)), np.sin(np.radians(p.degrees))])


def leaning(slope):
    """Return the direction of gravity in coordinates in which the slope is horizontal."""
    return np.array([slope, -1.0]) / np.hypot(slope, 1.0)


def harmonic(n):
    """Return ½ Σ 1/k of n blocks."""
    return 0.5 * sum(1.0 / k for k in range(1, n + 1))


def stands(forces, p, number):
    """Return whether no body is accelerated."""
    x, m, moments, touch, down = scene_of(p, number)
    a, b, places, normals, mu = zip(*touch)
    movable = m > 0.0
    inv_mass, inv_inertia = movable / np.where(movable, m, 1.0), movable / moments
    load = np.zeros((len(x), 3))
    load[:, :2] = m[:, None] * G * down
    contacts = make_contacts(a, b, np.array(places), np.array(normals), inv_mass)
    _, acceleration = forces(x, inv_mass, inv_inertia, contacts, load, np.array(mu, float))
    return np.max(np.abs(acceleration)) < AT_REST


def bracket(p):
    """Return (a number with which it falls, one with which it stands)."""
    expected = truth(p, T)[0]
    return (2.0 * expected, 0.3 * expected) if p.kind in ("box", "overhang") else (0.3 * expected, 2.0 * expected)


def edge(holds, p, width):
    """Return the number at which the scene begins to stand, by bisection."""
    falls, safe = bracket(p)
    while abs(safe - falls) > width * safe:
        middle = 0.5 * (falls + safe)
        falls, safe = (falls, middle) if holds(middle) else (middle, safe)
    return np.array([0.5 * (falls + safe)])


def run(lessons, step, acceleration, state, p, dt, steps):
    return (edge(lambda number: stands(step, p, number), p, WIDTH),)


def truth(p, t):
    """The balance of forces and moments gives the edge:

    discs       the forces on a lower disc meet in its contact point with the ground.  The force from above is 15° off
                the normal there: μ = tan 15° = 2 − √3.  The ground carries 1½ weights, an upper contact a third of that
                along the vertical: μ = (2 − √3)/3.
    ladder      moments about its foot: the wall pushes with m g/(2 tan θ), and the floor holds it: μ = 1/(2 tan θ)
    box         it topples when its centre is above its lower edge, tan θ = w/h, and slides at tan θ = μ
    overhang    the centre of the blocks above must be above the edge below: ½ Σ 1/k lengths
    Source: any text of statics.
    """
    if of_discs(p):
        return np.array([(2.0 - np.sqrt(3.0)) / (3.0 if p.kind == GROUND else 1.0)])
    if p.kind == "ladder":
        return np.array([0.5 / np.tan(np.radians(p.degrees))])
    return np.array([min(p.mu, p.slim)]) if p.kind == "box" else np.array([harmonic(p.blocks)])


def limit(p, dt):
    """A number below the critical one by the fraction δ leaves an acceleration of g δ times a lever arm.  With
    lever arms of a tenth and more, 1e-8 m/s² means δ = 10 · 1e-8/g at most.  The bisection stops at 1e-9.
    """
    return 10.0 * AT_REST / G + WIDTH


def moved_limit(p, dt):
    """In an engine that acceleration moves a body by 1 mm in a second: δ = 2 · 1e-3/(g · 1 s²) over the lever arm."""
    return 10.0 * 2.0 * MOVED / (G * WATCHED**2)


def pybullet_limit(p, dt):
    """pybullet lets an overhanging stack sink and lean before it carries.  No theory says by how much, so this error is
    shown, and the laws of contact judge what it reports of its runs nearest to the edge.
    """
    return np.inf if p.kind == "overhang" else moved_limit(p, dt)


def unknown(p, dt):
    """Default settings are coarse, and no theory says how coarse.  These errors are shown.  The laws of contact judge
    what the engine reports of its runs nearest to the edge.
    """
    return np.inf


# ---------------------------------------------------------------------------------------------- engines

def model(p, number):
    """Return the Model of a scene.  Friction of a pair is the product of both."""
    x, ground = places_of(p, number), HalfSpace(UP)
    if of_discs(p):
        between, below = frictions_of(p, number)
        bodies = [Body(tuple(place), 1.0, Ball(0.5), mu) for place, mu in zip(x[1:], (1.0, 1.0, between))]
        return make_model([Body(tuple(x[0]), shape=ground, mu=below), *bodies], G * DOWN)
    if p.kind == "ladder":
        end = ladder_end(p)
        floor, wall = HalfSpace(UP, end[1]), HalfSpace((-1.0, 0.0), end[0])
        board = Body(tuple(THIN * np.array([-end[1], end[0]])), 1.0, Box((0.5, 0.5 * THIN)), 1.0,
                     q=np.radians(p.degrees), inertia=1.0 / 12.0)
        return make_model([Body(tuple(x[0]), shape=floor, mu=number), Body(tuple(x[0]), shape=wall), board], G * DOWN)
    if p.kind == "box":
        box = Body(tuple(x[1]), 1.0, Box((0.5 * p.slim, 0.5)), p.mu)
        return make_model([Body(tuple(x[0]), shape=ground, mu=1.0), box], G * leaning(number))
    grip, right = np.sqrt(p.mu), x[-1, 0] + 0.5
    table = Body((right - 2.0, -2.0), shape=Box((2.0, 2.0)), mu=grip)
    return make_model([table, *(Body(tuple(place), 1.0, Box((0.5, 0.5 * HEIGHT)), grip) for place in x[:-1])],
                      G * DOWN)


def holds(p, number, kept, product, dt, **settings):
    """Return whether no body has moved by a millimetre after a second; kept: gets its watched steps."""
    return stands_in(product, model(p, number), MOVED, kept, dt, **settings)


def make(p, dt, holds):
    """Make the EngineRun of an engine in which a scene holds or falls: the bisection is one long reading."""
    tried = watched.NearTheEdge(partial(holds, p))
    return one_reading(lambda: edge(tried, p, 1e-4), watched=tried.steps)


def boards(p):
    """Return whether there are no discs: pybullet has no discs, and no plane in which spheres would stay."""
    return not of_discs(p)


def low_boards(p):
    """Return whether it is low: by default pybullet's five blocks fall at a third of the overhang, too."""
    return boards(p) and (p.kind != "overhang" or p.blocks <= 3)


AT_ONCE = {"overlap": 0.0, "slop": 1e-5}
BISECTED = "its bisection and its sweeps stop at a given accuracy, and the limit bounds the remaining error"
WATCHING = "a body that moves by less than a millimetre in a second stands, and the limit bounds the error of that"
LEANING = "a body that moves by less than a millimetre stands, and no theory says how far an overhang sinks at first"
COARSE = "no theory says how coarse its default settings are"
RUNNERS = (
    ours(SWEEPS, limit=limit, predicted=BISECTED, order=EXACT),
    engine(PYMUNK, "", partial(make, holds=partial(holds, product=PYMUNK, dt=1e-3, iterations=100)),
           "100 iterations, collision_slop 1e-5; stands if nothing moves by 1 mm in 1 s of 1/1000 s",
           order=EXACT, limit=moved_limit, predicted=WATCHING),
    engine(PYMUNK, "default", partial(make, holds=partial(holds, product=PYMUNK, dt=DT, iterations=10, slop=0.1)),
           "10 iterations, collision_slop 0.1; 1 s of 1/240 s", order=EXACT, limit=unknown, predicted=COARSE,
           laws=watched.pymunk_rules(10)),
    engine(PYBULLET, "",
           partial(make, holds=partial(holds, product=PYBULLET, dt=2e-3, iterations=100, warm=WARMER, **AT_ONCE)),
           f"maximal coordinates; solverResidualThreshold 0, 100 iterations, warmStartingFactor {WARMER}; "
           "1 s of 1/500 s",
           order=EXACT, limit=pybullet_limit, predicted=LEANING, supports=boards,
           laws=watched.bullet_rules(100, creeps=True)),
    engine(PYBULLET, "default",
           partial(make, holds=partial(holds, product=PYBULLET, dt=DT, iterations=50, residual=1e-7, **AT_ONCE)),
           f"maximal coordinates; 50 iterations, warmStartingFactor {WARM}; 1 s of 1/240 s",
           order=EXACT, limit=unknown, predicted=COARSE, supports=low_boards,
           laws=watched.bullet_rules(50, creeps=True)),
)


def quantity_names(p):
    if p.kind in ("box", "overhang"):
        return ["steepest slope, tan θ [-]"] if p.kind == "box" else ["overhang over the length of a block [-]"]
    return ["least friction [-]"]


def sanity_checks():
    """Return Findings: the same numbers by other methods."""
    numbers = {name: truth(p, T)[0] for name, p in CASES.items()}
    return (states("friction between discs [-]", numbers[DISCS], np.tan(np.radians(15.0)), 1e-15),
            states("ladder at 60° [-]", numbers[LADDER], np.sqrt(3.0) / 6.0, 1e-15),
            states("overhang of five [-]", numbers["overhang of five blocks"], 137.0 / 120.0, 1e-15))


# ---------------------------------------------------------------------------------------------- picture

def shapes():
    """Return [(corners (k, 2), closed)]: the discs, the ladder, the box on its slope and the overhang, side by side."""
    drawn = [(x + 0.5 * circle(24), True) for x in places_of(CASES[DISCS], 1.0)[1:]]
    end = ladder_end(CASES[LADDER])
    foot = np.array([2.0 - end[0], 0.0])
    drawn += [(np.stack((foot, foot + 2.0 * end)), False), (np.array([(2.25, 0.0), (2.25, 1.2)]), False)]
    rotation, slim = np.array([(np.cos(0.3), np.sin(0.3)), (-np.sin(0.3), np.cos(0.3))]), CASES[BOX].slim
    box = np.array([(-0.5 * slim, 0.0), (0.5 * slim, 0.0), (0.5 * slim, 1.0), (-0.5 * slim, 1.0)])
    for corners, closed in ((box, True), (np.array([(-0.65, 0.0), (0.65, 0.0)]), False)):
        drawn.append((corners @ rotation + np.array([3.6, 0.2]), closed))
    p = CASES[OVERHANG]
    for x in places_of(p, harmonic(p.blocks))[:-1]:
        block = 0.5 * np.array([(-1.0, -HEIGHT), (1.0, -HEIGHT), (1.0, HEIGHT), (-1.0, HEIGHT)])
        drawn.append((x + np.array([5.9, 0.0]) + block, True))
    edge_of_table = places_of(p, harmonic(p.blocks))[-1, 0] + 0.5 + 5.9
    drawn.append((np.array([(edge_of_table - 0.6, 0.0), (edge_of_table, 0.0), (edge_of_table, -0.4)]), False))
    return [*drawn, (np.array([(-1.2, 0.0), (4.3, 0.0)]), False)]


def points(observed, p):
    """Draw all four scenes side by side in every case."""
    return np.round(np.concatenate([corners for corners, _ in shapes()]), 5)


def links(p):
    joined, first = [], 0
    for corners, closed in shapes():
        n = len(corners)
        joined += [(first + k, first + (k + 1) % n) for k in range(n if closed else n - 1)]
        first += n
    return joined


SCENE = Scene(
    title="Critical friction", lesson="contact",
    cases=CASES, **ANSWER,
    runners=RUNNERS,
    start=start, run=run, observe=sole_array,
    truth=truth, truth_uncertainty=1e-15,
    slow_cases=("ladder at 40°", "ladder at 75°", "overhang of five blocks"),
    omitted_methods="Murty's method has no friction; the discs were not set up in pybullet; with its default settings "
                    "five blocks fall at a third of the overhang, because each step begins with a tenth of the last "
                    "impulses",
    quantity_names=quantity_names,
    published_states=((1.0, (0.288675,), 5e-7),),
    sanity_checks=sanity_checks,
    points=points, links=links,
    uses=("rows of all contacts", "the cone of friction in the plane", "sweeps until the residual vanishes"),
    full_loop="forces of bodies at rest: nothing moves, so there is no loop",
    ablations={"motion": "standing bodies do not move; falling ones are not followed",
               "the stiffness of the bodies": "it decides how four legs share a load, and has no effect here"},
)
