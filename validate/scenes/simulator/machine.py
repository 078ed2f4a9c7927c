"""A machine of six kinds of parts that runs for ten seconds.

The parts are a hammer on a spring, dominoes, crates, a ramp with a block, a rotating crank, and a floor that is a belt.
No formula for its motion is known.  It is judged by laws that hold for any motion, and each bound is derived.
Where its parts go is compared with a motion on which two codes agree that share nothing: the loop of lesson 10 and
pymunk, each with short steps.  `python -m validate.measure.agreement` computes it and keeps it with its error bar.
"""

from functools import cache
from typing import Annotated, NamedTuple

import numpy as np

from solutions.checks import BadInput, check_friction
from solutions.simulator import (
    make_bodies_2d,
    mechanical_energy_2d,
)
from solutions.support.model import WORLD, Drag, Spring
from validate.check import states
from validate.engines import watched
from validate.methods import LOOP_2D
from validate.reference.stored import agreed
from validate.scene import PYMUNK, Scene, engine, no_limit, ours
from validate.scenes._common import built, check_positives
from validate.scenes.drawing import outlines
from validate.scenes.simulator._common import boxes_on_floor, filmed, physics_of_boxes, reported_by_loop, watched_boxes

T = 10.0                     # [s]
UNKNOWN = "unknown"          # an order
STEPS = (24, 120, 300, 600, 1200, 2400, 4800)
AGREED = 1e-3               # the two codes differ by less, relative to all corners [-]
KEPT = 20                   # pictures per second of the film of the truth
FINEST = {"pymunk": 16_000, "loop": 16_000}     # steps per second of the two codes; the bar has both halved, too
AGREED_CASES = "places",
SWEEPS, MARGIN = 20, 0.02    # of the loop [-], [m]
ITERATIONS = 100             # of pymunk [-]
WATCHED = 300                # steps of the run that the laws of contact judge [-]
SPRING, REST, DAMPER = 20.0, 0.5, 0.5           # of the hammer [N/m], [m], [N s/m]
ANCHOR = np.array([-2.9, 0.3])                  # [m]
DRAG = 0.3                                      # of everything that moves [N s/m]
HAMMER, CRANK, RAMP, FIRST = 0, 1, 2, 3         # numbers of bodies
DOMINOES = 5
HALF = np.array([(0.15, 0.1), (0.25, 0.03), (0.5, 0.03), *[(0.03, 0.2)] * DOMINOES, (0.1, 0.1), (0.1, 0.1),
                 (0.08, 0.08)])
PLACES = np.array([(-2.2, 0.1), (2.6, 0.5), (1.6, 0.35), *[(-1.5 + 0.2 * k, 0.2) for k in range(DOMINOES)], (0.3, 0.1),
                   (0.3, 0.3), (1.3, 0.75)])
ANGLES = np.array([0.0, 0.0, -0.35, *[0.0] * DOMINOES, 0.0, 0.0, -0.35])
MASS = np.array([2.0, np.inf, np.inf, *[0.5] * DOMINOES, 1.0, 1.0, 0.5])                    # [kg]
THICK = 0.06                 # of a domino [m]: overlaps are shares of it
KINDS = ("places", "energy", "overlap", "residual")


class Params(NamedTuple):
    seen: Annotated[str, "what is observed"] = "places"
    blow: Annotated[float, "first speed of the hammer [m/s]"] = 4.0
    crank: Annotated[float, "angular velocity of the crank [rad/s]"] = 1.0
    belt: Annotated[float, "speed of the floor [m/s]"] = 0.1
    mu: Annotated[float, "friction, everywhere [-]"] = 0.4
    g: Annotated[float, "gravity [m/s²]"] = 9.81


CASES = {kind: Params(seen=kind) for kind in KINDS}


class Run(NamedTuple):
    """The machine, and the extremes that its run has reached."""
    now: object              # PileState
    rows: object             # Bodies
    work: float              # of the supports until now [J]
    lowest: float            # energy less work [J]
    gain: float              # largest rise of that so far [J]
    deepest: float           # overlap [m]
    residual: float          # of a step [m/s]


def acceleration(lessons):
    weight, spring_tension = lessons.simulator.weight, lessons.springs.spring_tension

    def load(t, x, q, v, omega, p):
        """Return the load of weight, air, and a spring that pulls the hammer."""
        F, tau = weight(t, x, q, v, omega, p)
        for i in range(x.shape[0]):
            if p.inv_mass[i] > 0.0:
                F[i] = F[i] - DRAG * v[i]
        r = ANCHOR - x[HAMMER]
        length = np.sqrt(r[0] * r[0] + r[1] * r[1])
        rate = -(r[0] * v[HAMMER, 0] + r[1] * v[HAMMER, 1]) / length
        F[HAMMER] = F[HAMMER] + spring_tension(length, rate, REST, SPRING, DAMPER) / length * r
        return F, tau
    return load


def start(p):
    check_positives(p, "blow", "g")
    check_friction(p.mu)
    if p.seen not in KINDS:
        raise BadInput("what is observed", p.seen, f"choose from: {', '.join(KINDS)}")
    now, rows = make_bodies_2d(PLACES, ANGLES, MASS, MASS * np.sum(HALF**2, axis=1) / 3.0, HALF, [(0.0, 1.0, 0.0)],
                               (0.0, -p.g), p.mu, SWEEPS, MARGIN)
    v, omega = now.v.copy(), now.omega.copy()
    v[HAMMER], omega[CRANK], v[-1] = (p.blow, 0.0), p.crank, (p.belt, 0.0)
    now = now._replace(v=v, omega=omega)
    return Run(now, rows, 0.0, energy(now, rows), 0.0, 0.0, 0.0)


def energy(now, rows):
    """Return the energy [J] of all moving bodies, and of the spring."""
    stretch = np.linalg.norm(now.x[HAMMER] - ANCHOR) - REST
    return mechanical_energy_2d(now.x, now.q, now.v, now.omega, rows) + 0.5 * SPRING * stretch**2


def work_of_supports(now, rows):
    """Return the work [J] of rows without inverse mass in the last step: impulse on a body times its velocity."""
    work, c = 0.0, now.contacts
    for a, b, place, J in zip(c.a, c.b, c.p, now.J):
        for body, sign in ((a, -1.0), (b, 1.0)):
            if rows.inv_mass[body] == 0.0:
                r = place - now.x[body]      # the support has moved since, and a rotating one rotates about its centre
                work += sign * J @ (now.v[body] + now.omega[body] * np.array([-r[1], r[0]]))
    return work


def run(lessons, step, acceleration, state, p, dt, steps):
    simulator = lessons.simulator
    shape = simulator.box_bounds_2d, simulator.box_contacts_2d
    if p.seen == "places":
        end = simulator.advance_contact(step, acceleration, *shape, 0.0, state.now, dt, steps, state.rows)
        return state._replace(now=end)
    now, rows, work, lowest, gain, deepest, residual = state
    for _ in range(steps):
        now = simulator.advance_contact(step, acceleration, *shape, 0.0, now, dt, 1, rows)
        work += work_of_supports(now, rows)
        rest = energy(now, rows) - work
        lowest = min(lowest, rest)
        gain = max(gain, rest - lowest)
        deepest = max(deepest, simulator.largest_overlap(now.contacts))
        residual = max(residual, simulator.sweep_residual_2d(now, dt, rows))
    return Run(now, rows, work, lowest, gain, deepest, residual)


def corners(x, angle):
    """Return the corners (8n,) [m] of all boxes."""
    c, s, signs = np.cos(angle)[:, None], np.sin(angle)[:, None], np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)])
    a, b = HALF[:, :1] * signs[:, 0], HALF[:, 1:] * signs[:, 1]
    return np.stack((x[:, :1] + c * a - s * b, x[:, 1:] + s * a + c * b), axis=2).ravel()


def first_energy(p):
    """Return the energy of the hammer and its spring [J], which bounds the energy of the spring."""
    return 0.5 * MASS[HAMMER] * p.blow**2 + 0.5 * SPRING * (np.linalg.norm(PLACES[HAMMER] - ANCHOR) - REST) ** 2


def observe(state, p):
    """Return the corners of all boxes; or a gain of energy, an overlap or a residual, each over its reference value."""
    shares = {"energy": state.gain / first_energy(p), "overlap": state.deepest / THICK,
              "residual": state.residual / p.blow}
    n = len(HALF)
    return corners(state.now.x[:n], state.now.q[:n]) if p.seen == "places" else np.array([shares[p.seen]])


class Motion(NamedTuple):
    """A motion that is known from runs."""
    film: np.ndarray         # (KEPT T + 1, n, 3) places and angles of all boxes [m, m, rad]
    ends: np.ndarray         # (n, 3) the last of them
    bar: float               # how far the ends may be off, relative to all corners [-]


def motion_by_pymunk(p, per_second):
    """Return (film (k, n, 3), ends (n, 3)) by pymunk."""
    every, see = per_second // KEPT, lambda state: np.column_stack((state.x, state.q))[1:]
    film = filmed(model(p), see, 1.0 / per_second, every * round(KEPT * T), every, iterations=200, slop=1e-6,
                  overlap=0.0)
    return film, film[-1]


def motion_by_loop(lessons, step, law, p, per_second):
    """Return the same by the loop of lesson 10."""
    state, film, n = start(p), [], len(HALF)
    for k in range(round(KEPT * T) + 1):
        if k:
            state = run(lessons, step, law, state, p, 1.0 / per_second, per_second // KEPT)
        film.append(np.column_stack((state.now.x[:n], state.now.q[:n])))
    return np.array(film), film[-1]


@cache
def reference(p):
    """Return the Motion on which the two codes agree; where none is kept, that of pymunk with no known error."""
    p = p._replace(seen="places")
    if found := agreed("machine", p):
        return Motion(*(np.array(found[name]) for name in ("film", "ends")), found["bar"])
    return Motion(*motion_by_pymunk(p, 30 * KEPT), np.inf)


def all_corners(places, p):
    """Return the corners of the boxes with these places and angles (n, 3), in one row."""
    return corners(places[:, :2], places[:, 2])


def truth(p, t):
    """No formula and no published motion is known.  Three quantities are compared with 0: energy from no source,
    overlap, and the change that one more sweep would make.

    Places are compared with the mean of two motions that agree: the loop of lesson 10 and pymunk, each with steps of
    1/16,000 s.  The two share no code and differ in method.  The error bar is the largest distance from their mean of
    both, and of both with twice the step.  For other parameters than those of the case the truth is pymunk's run.
    """
    if p.seen != "places":
        return np.zeros(1)
    film, ends, _ = reference(p)
    place = KEPT * t
    k = min(int(place), len(film) - 2)
    return all_corners(ends if t == T else (k + 1 - place) * film[k] + (place - k) * film[k + 1], p)


def limit(p, dt):
    """energy: under symplectic Euler the energy of the spring oscillates by ½ ω dt of itself to both sides, ω² =
    k/m.  It is at most the energy with which the hammer begins.  Everything else dissipates energy, or is counted as
    work of the supports.

    overlap: a step moves a corner along a tangent, but a rotating corner moves on an arc.  Per step it penetrates by
    ½ v ω dt², and nothing pushes it back.  Until it has rotated by a right angle that adds up to ½ v π/2 dt, with the
    speed v of a fall from the highest place, 0.75 m.

    residual: the blow of the hammer runs through five dominoes to the floor: six contacts in a row.  Each sweep leaves
    cos²(π/12) of it.

    places: where dominoes and crates end depends on the order in which they come to rest; no theory says how far a
    run with a given step is from the truth.  The laws of contact judge what a run of 300 steps reports of its steps.
    """
    omega, v = np.sqrt(SPRING / MASS[HAMMER]), np.sqrt(2.0 * p.g * PLACES[:, 1].max())
    limits = {"places": np.inf, "energy": omega * dt, "overlap": 0.25 * np.pi * v * dt / THICK,
              "residual": np.cos(np.pi / 12.0) ** (2 * SWEEPS)}
    return limits[p.seen]


def model(p):
    """Make the machine.  The floor is a belt, the crank a body without mass that turns."""
    v, omega = np.zeros((len(HALF), 2)), np.zeros(len(HALF))
    v[HAMMER], omega[CRANK] = (p.blow, 0.0), p.crank
    spring = Spring(1 + HAMMER, WORLD, (0.0, 0.0), tuple(ANCHOR), REST, SPRING, DAMPER)      # body 0 is the floor
    return boxes_on_floor(PLACES, ANGLES, HALF, MASS, v, omega, p.mu, p.g, p.belt, springs=[spring],
                          loads=[Drag(DRAG)])


def read(state, p):
    return corners(state.x[1:], state.q[1:])


def physics(p):
    return physics_of_boxes(MASS, HALF, p.g, p.mu)


def reports(before, after, p, dt):
    """Return the Step of our loop, with what spring and air give: it takes both from the state before the step."""
    x, v = before.now.x, before.now.v
    way = x[HAMMER] - ANCHOR
    length = np.linalg.norm(way)
    F = -DRAG * v * (physics(p).inv_mass[:, None] > 0.0)
    F[HAMMER] += (SPRING * (REST - length) - DAMPER * (way @ v[HAMMER]) / length) * way / length
    return reported_by_loop(before.now, after.now, dt, physics(p), dt * F)


def pushed(space, p, dt, before, after):
    """Return the impulses (n, 2) [N s] of the spring and of the air on boxes and floor in a step of pymunk.

    The engine reports the impulse of its spring.  It moves the boxes, pulls with the new length of the spring, and
    finds what the damper gives last.  The force of the air is that of the velocity before the step.
    *Source:* Chipmunk's cpDampedSpring.c and cpSpaceStep.c.
    """
    damped, = space.constraints
    J = -DRAG * dt * before.v * (physics(p).inv_mass[:, None] > 0.0)
    way = after.x[HAMMER] - ANCHOR
    J[HAMMER] += damped.impulse * way / np.linalg.norm(way)
    return J


def is_alone(p):
    """Return whether pymunk's run is the truth, because no agreement is kept for these parameters."""
    return p.seen == "places" and reference(p).bar == np.inf


def tells_places(p):
    """Return whether positions are compared: the other numbers are extremes over all steps, which only we collect."""
    return p.seen == "places"


UNPREDICTED = "it depends on the order in which dominoes and crates come to rest, and no theory predicts that"
RUNNERS = (
    # the positions need shorter steps than a quick run has, and are not judged
    ours(LOOP_2D, order=UNKNOWN, limit=limit, predicted=UNPREDICTED, slow_cases=("places",), most_in_quick=120,
         laws=watched.sweeps_rules(SWEEPS), watched=WATCHED),
    engine(PYMUNK, "", built(PYMUNK, model, read, watched_boxes(physics, pushed), iterations=ITERATIONS, overlap=0.0),
           "boxes on a kinematic floor, a DampedSpring, air as a force; 100 iterations, collision_slop 1e-5",
           order=UNKNOWN, limit=no_limit, predicted=UNPREDICTED, most_in_quick=600,
           laws=watched.pymunk_rules(ITERATIONS, rests=False), watched=WATCHED, supports=tells_places,
           is_truth=is_alone),
)


def sanity_checks():
    """Return Findings about the reference."""
    film, _, bar = reference(Params())
    at = np.array([all_corners(places, Params()) for places in film]).reshape(-1, len(HALF), 4, 2)
    fallen = np.abs(at[-1, FIRST:FIRST + DOMINOES, 1, 1] - at[-1, FIRST:FIRST + DOMINOES, 0, 1]) > 0.02
    return (states("error bar of the two codes after 10 s [-]", bar, 0.0, AGREED),
            states("lowest corner [m]", at[:, FIRST:, :, 1].min(), 0.0, 0.01),
            states("angle of the crank after 10 s [rad]", film[-1, CRANK, 2], 10.0, 1e-6),
            states("dominoes that do not lie [-]", DOMINOES - np.sum(fallen), 0, 2))


def points(observed, p):
    """Draw the corners of all boxes, the spring as a zigzag, and the floor; the ratios have no picture of their own."""
    at = np.asarray(observed) if p.seen == "places" else corners(PLACES, ANGLES)
    boxes = at.reshape(-1, 2)
    hammer = boxes[:4].mean(axis=0)
    way, turns = hammer - ANCHOR, np.linspace(0.0, 1.0, 13)[:, None]
    across = np.array([-way[1], way[0]]) / np.linalg.norm(way)
    zigzag = ANCHOR + turns * way + 0.04 * np.array([0.0, *[(-1.0) ** k for k in range(11)], 0.0])[:, None] * across
    return np.round(np.vstack((boxes, zigzag, ((-3.2, 0.0), (3.6, 0.0)))), 4)


def links(p):
    n = 4 * len(HALF)
    return outlines(4, len(HALF)) + [(n + k, n + k + 1) for k in range(12)] + [(n + 13, n + 14)]


SCENE = Scene(
    title="A machine of many parts",
    film_of_truth="two codes that agree",
    lesson="simulator",
    cases=CASES, duration=T, steps=STEPS,
    runners=RUNNERS,
    acceleration=acceleration, start=start, run=run, observe=observe,
    reports=reports, truth=truth, truth_uncertainty=1e-15, model=model, read=read,
    slow_cases=("overlap", "residual"),
    omitted_methods="the machine was not set up in pybullet: its belt and its crank are bodies without mass that carry "
                    "others along, which pybullet has only in reduced coordinates",
    sanity_checks=sanity_checks,
    points=points, links=links,
    uses=("boxes in the plane", "springs with dampers, air", "supports that move", "sweeps with memory"),
    ablations={"pushing overlaps apart": "the soft contacts of lesson 9 do it; here overlaps stay and are judged",
               "restitution": "several impacts at once have no law"},
)
