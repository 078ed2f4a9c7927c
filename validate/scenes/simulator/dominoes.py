"""A row of dominoes, the first of which is pushed: impacts, tilting, sliding and leaning all at once.

No formula gives this motion, and no published value is known.  The truth is what two codes agree on that share
nothing: the loop of lesson 10 and pymunk, each with steps so short that their motions differ by less than a stated
bound.  `python -m validate.measure.agreement` computes it and keeps it with its error bar.  The loop sweeps until an
impact is finished.  The pile of lesson 9 visits each contact twice per step.  That does not finish the last impact,
which runs from the floor back through all six dominoes: with steps of 1/1000 s the pile is still 0.9 % away.
"""

from functools import cache, partial
from typing import Annotated, NamedTuple

import numpy as np

from solutions.checks import BadInput, check_friction, check_positive
from solutions.contact import make_pile_2d
from solutions.given.bodies import Bodies
from solutions.support.model import Body, make_model
from solutions.support.shapes import Box, HalfSpace
from validate.check import states
from validate.engines import watched
from validate.methods import PILE, SETTLED_LOOP
from validate.reference.contact_laws import Physics
from validate.reference.impulses import delays
from validate.reference.simulator import rocking
from validate.reference.stored import agreed
from validate.scene import PYBULLET, PYMUNK, Scene, engine, no_limit, ours
from validate.scenes._common import built, check_positives
from validate.scenes.drawing import outlines

T = 1.0                      # [s]
STEPS = (5, 10, 20, 50, 100, 200, 500)
FINER = (1000,)              # of what finishes its impacts
ROWS = 4                     # each begins at another moment: see limit
WINDOW = 0.04                # of these moments [s]; the first impact is later
KEPT = 250                   # pictures per second of the film of the truth
AGREED = 1e-3                # a motion is judged where the two codes differ by less, relative to all corners [-]
FINEST = {"pymunk": 50_000, "loop": 20_000}  # steps per second of the two codes; the error bar has both halved, too
UNCERTAINTY = 1.2e-4         # the error bar of the first case, rounded up; limits contain that of each case [-]
SWEEPS = 1                   # of the loop, before it looks whether a sweep still changes something
ITERATIONS = 50              # of pybullet [-]
LEFT = 1.6e-3                # of the error, where the last impact takes another course: see limit [-]
WATCHED = 50                 # steps of the run that the laws of contact judge [-]
CARRIED = 0.2                # hertz of a soft contact times a step [-]; a pile takes 0.3 at most
ZETA = 5.0                   # damping ratio of the pile [-]
MARGIN = 0.01                # of the loop [m]
AHEAD = 0.05                 # margin of the pile [m]: half of it is the way of the top of a domino in 1/100 s


class Params(NamedTuple):
    n: Annotated[int, "dominoes"] = 6
    width: Annotated[float, "of each [m]"] = 0.08
    height: Annotated[float, "of each [m]"] = 0.4
    pitch: Annotated[float, "from one to the next [m]"] = 0.2
    mu: Annotated[float, "friction, everywhere [-]"] = 0.4
    omega: Annotated[float, "with which the first one begins to tilt [rad/s]"] = 4.0
    g: Annotated[float, "gravity [m/s²]"] = 9.81


CASES = {"six": Params(), "fifteen": Params(n=15), "six, smoother": Params(mu=0.25)}
AGREED_CASES = tuple(CASES)
SCATTERED = "1 with scatter" # an order that four runs do not show well
LEVELS_OFF = "1, then none"  # an order: of a motion that need not be that of the truth
MASS = 1.0                   # of each [kg]; nothing depends on it


def inertia(p):
    return MASS * (p.width**2 + p.height**2) / 12.0


def begin(p, t):
    """Return (x (n, 2), angles (n,), v (n, 2), angular velocities (n,)) at t, before the first impact.

    The first domino tilts about its lower right corner; the others stand.
    """
    x = np.stack((p.pitch * np.arange(p.n), np.full(p.n, 0.5 * p.height)), axis=1)
    angle, v, omega = np.zeros(p.n), np.zeros((p.n, 2)), np.zeros(p.n)
    tilt, rate, _ = rocking(0.5 * p.width, 0.5 * p.height, p.g, 0.0, t, p.omega)
    c, s = np.cos(tilt), np.sin(tilt)
    r = 0.5 * np.array([p.height * s - p.width * c, p.height * c + p.width * s])           # from the corner
    x[0], angle[0], v[0], omega[0] = (r[0] + 0.5 * p.width, r[1]), -tilt, (rate * r[1], -rate * r[0]), -rate
    return x, angle, v, omega


def moments():
    """Return (ROWS,) times [s] after the push at which the rows begin."""
    return delays(WINDOW)[:ROWS]


def start(p):
    return rows_at(p, moments())


def rows_at(p, begins):
    """Return (PileState, Pile) of a row for each of these moments, one beside the other."""
    check_positives(p, "width", "height", "omega", "g")
    check_positive("gap between dominoes [m]", p.pitch - p.width)
    check_friction(p.mu)
    if p.n < 1:
        raise BadInput("n", p.n, "give one domino or more")
    x, angle, v, omega = beside_each_other(p, begins)
    half, floor = np.full(x.shape, 0.5) * (p.width, p.height), np.array([(0.0, 1.0, 0.0)])
    state, pile = make_pile_2d(x, angle, MASS, inertia(p), half, floor, (0.0, -p.g), p.mu, 1, 1.0, ZETA, AHEAD)
    return state._replace(v=np.vstack((v, np.zeros(2))), omega=np.append(omega, 0.0)), pile


def beside_each_other(p, begins):
    """Return what begin(p, t) returns, for all rows together; each is moved so that they do not meet."""
    x, *others = zip(*(begin(p, t) for t in begins))
    return np.concatenate(x + rows_apart(p, len(begins))), *map(np.concatenate, others)


def rows_apart(p, rows):
    """Return by how much (rows, 1, 2) [m] the rows are moved, so that they do not meet."""
    return np.outer(np.arange(rows), (p.pitch * (p.n + 5), 0.0))[:, None]


def places_of(x, angle, p):
    """Return places and angles (rows, n, 3) of all dominoes, each row moved back to where it is alone."""
    places = np.column_stack((x, angle)).reshape(-1, p.n, 3)
    places[..., :2] -= rows_apart(p, len(places))
    return places


def run(lessons, step, acceleration, state, p, dt, steps):
    rows, pile = state
    shape = lessons.contact.box_bounds_2d, lessons.contact.box_contacts_2d
    if step is lessons.contact.advance_pile_2d:
        return step(*shape, rows, dt, steps, pile._replace(hertz=CARRIED / dt)), pile
    bodies = Bodies(*(getattr(pile, name) for name in Bodies._fields[:6]), SWEEPS, MARGIN)
    return lessons.simulator.advance_contact(step, acceleration, *shape, 0.0, rows, dt, steps, bodies), pile


def corners(x, angle, p):
    """Return the corners (8n,) [m] of n dominoes at x (n, 2) with these angles (n,)."""
    c, s = np.cos(angle)[:, None], np.sin(angle)[:, None]
    a, b = 0.5 * p.width * np.array([-1.0, 1.0, 1.0, -1.0]), 0.5 * p.height * np.array([-1.0, -1.0, 1.0, 1.0])
    return np.stack((x[:, :1] + c * a - s * b, x[:, 1:] + s * a + c * b), axis=2).ravel()


def observe(state, p):
    return all_corners(places_of(state[0].x[:-1], state[0].q[:-1], p), p)


class Motion(NamedTuple):
    """A motion that is known from runs: places and angles (…, n, 3) [m, m, rad] of each domino."""
    film: np.ndarray         # (KEPT (T + WINDOW) + 1, n, 3) of one row, from the push on
    ends: np.ndarray         # (ROWS, n, 3) of all rows at T
    bar: float               # how far the ends may be off, relative to all corners [-]


def by_pymunk(p, begins, dt, steps, every):
    """Return places (steps/every + 1, rows, n, 3) of rows that begin at these moments, by pymunk."""
    world = PYMUNK.world.build(model(p, begins), dt, iterations=200, slop=1e-6, overlap=0.0)
    places = lambda state: places_of(state.x[1:], state.q[1:], p)
    found = [places(world.state())]
    for n in range(1, steps + 1):
        world.step()
        if n % every == 0:
            found.append(places(world.state()))
    return np.array(found)


def by_loop(lessons, step, law, p, begins, dt, steps, every):
    """Return the same by the loop of lesson 10."""
    state, places = rows_at(p, begins), lambda state: places_of(state[0].x[:-1], state[0].q[:-1], p)
    found = [places(state)]
    for _ in range(steps // every):
        state = run(lessons, step, law, state, p, dt, every)
        found.append(places(state))
    return np.array(found)


def motion_by_pymunk(p, per_second):
    """Return (film (k, n, 3), ends (ROWS, n, 3)) by pymunk."""
    film, ends = (by_pymunk(p, *run) for run in two_runs(per_second))
    return film[:, 0], ends[-1]


def motion_by_loop(lessons, step, law, p, per_second):
    """Return the same by the loop of lesson 10."""
    film, ends = (by_loop(lessons, step, law, p, *run) for run in two_runs(per_second))
    return film[:, 0], ends[-1]


@cache
def reference(p):
    """Return the Motion on which the two codes agree; where none is kept, that of pymunk with no known error."""
    if found := agreed("dominoes", p):
        return Motion(*(np.array(found[name]) for name in ("film", "ends")), found["bar"])
    return Motion(*motion_by_pymunk(p, 20 * KEPT), np.inf)


def two_runs(per_second):
    """Return (begins, dt, steps, every) of the run that gives the film, and of the one that gives the ends."""
    every, dt = per_second // KEPT, 1.0 / per_second
    return (np.zeros(1), dt, every * round(KEPT * (T + WINDOW)), every), (moments(), dt, per_second, per_second)


def is_alone(p):
    """Return whether pymunk's run is the truth, because no agreement is kept for these parameters."""
    return reference(p).bar == np.inf


def truth(p, t):
    """No closed form is known.  The truth is the mean of two motions that agree: the loop of lesson 10 and pymunk, with
    steps of 1/20,000 and 1/50,000 s.  The rows begin as they are at four moments after their push, and each moves on
    from there for the time t.

    The two share no code and differ in method: the loop pushes before it moves and sweeps until impulses settle,
    pymunk moves before it pushes and has 200 iterations.  The error bar is the largest distance from their mean of
    both, and of both with twice the step.  For other parameters than those of the cases the truth is pymunk's run.
    """
    if t == T:
        return all_corners(reference(p).ends, p)
    rows = []
    for moment in t + moments():
        if moment <= WINDOW:                             # before the first impact
            x, angle, _, _ = begin(p, moment)
            rows.append(np.column_stack((x, angle)))
        else:
            film, place = reference(p).film, KEPT * moment
            k = min(int(place), len(film) - 2)
            rows.append((k + 1 - place) * film[k] + (place - k) * film[k + 1])
    return all_corners(np.array(rows), p)


def all_corners(places, p):
    """Return the corners of dominoes with these places and angles (…, n, 3), in one row."""
    flat = places.reshape(-1, 3)
    return corners(flat[:, :2], flat[:, 2], p)


@cache
def fastest(p):
    """Return the largest speed of the truth [m/s]: the root mean square over all corners of a row."""
    film = np.array([all_corners(places, p) for places in reference(p).film])
    return KEPT * np.max(np.linalg.norm(np.diff(film, axis=0), axis=1)) / np.sqrt(4.0 * p.n)


def limit(p, dt):
    """Each impact of two dominoes is detected up to one step late, and everything after it happens later by the same
    time.  After n impacts a row is late by n dt at most: first order.  A row that is late is off by that time times its
    speed, for which the largest of the truth is taken.  The phase of an impact in its step is random.  So errors of
    single runs scatter by a factor of three about a line.  Therefore several rows begin at different moments, and
    the error is that of all of them.  From 0.95 s on, the last impact pushes the whole row back.  So the errors at
    1 s decrease unevenly, and the slope through four of them means little.

    The error bar of the truth is added; where it is larger than 0.1 %, nothing is judged.  No theory says how far
    pybullet may be off.  The laws of contact judge what its run of 50 steps reports.

    A part of 0.16 % is measured.  The last impact comes after 0.93 s.  In two of the four rows it takes another course,
    unless the steps are shorter than 1/7000 s.  So the errors of the loop level off at 0.16 %, and the limit has that
    much more.

    The pile, and pymunk with 3 iterations, do not finish each impact.  In the first case their errors level off at
    0.9 %, and at 0.8 to 1.1 %.  The limit does not contain that, so they have no steps below 1/500 s.
    """
    size = np.linalg.norm(truth(p, T)) / np.sqrt(4.0 * p.n * ROWS)
    bar = reference(p).bar
    return p.n * fastest(p) * dt / size + LEFT + bar if bar <= AGREED else np.inf


# ---------------------------------------------------------------------------------------------- engines

def model(p, begins=None):
    """Make a row for each of these moments, one beside the other, on a floor.  Each has √μ: a pair has the product."""
    begins, mu, bodies = moments() if begins is None else begins, float(np.sqrt(p.mu)), []
    floor = Body((0.0, 0.0), shape=HalfSpace((0.0, 1.0)), mu=mu)
    for x, angle, v, omega in zip(*beside_each_other(p, begins)):
        bodies.append(Body(tuple(x), MASS, Box((0.5 * p.width, 0.5 * p.height)), mu, q=angle, v=tuple(v), omega=omega,
                           inertia=inertia(p)))
    return make_model([floor, *bodies], (0.0, -p.g))


def read(state, p):
    return all_corners(places_of(state.x[1:], state.q[1:], p), p)


def physics_in_space(p):
    """Return the Physics of the dominoes of all rows in pybullet."""
    n = ROWS * p.n
    return Physics(np.array([0.0, 0.0, -p.g]), np.full(n, 1.0 / MASS), np.full((n, 3), 1.0 / inertia(p)), p.mu)


def watch(bullet, p, dt):
    return watched.Bullet(bullet.pb, dt, None, physics_in_space(p))


in_pymunk = partial(built, PYMUNK, model, read, overlap=0.0)
in_pybullet = partial(built, PYBULLET, model, read, watch, iterations=ITERATIONS, overlap=0.0)
BY_CHANCE = "the phase of an impact in its step is random, and each impact passes this error on"
LONG_LIVED = "its contact points persist over several steps, and no theory says how far that shifts the motion"
SCATTERS = {"order": SCATTERED, "limit": limit, "predicted": BY_CHANCE,
            "measured": "what the last impact adds, on runs of the first case with up to 8,000 steps per second"}
RUNNERS = (
    ours(PILE, **SCATTERS),
    ours(SETTLED_LOOP, **SCATTERS, most_in_quick=100,
         finer_in_full=(*FINER, 2000, 5000)),              # the error bar has runs with twice and four times as many
    engine(PYMUNK, "", in_pymunk(iterations=50, slop=1e-6), "50 iterations, collision_slop 1e-6",
           **SCATTERS, is_truth=is_alone, finer_in_full=FINER),
    engine(PYMUNK, "fewer iterations", in_pymunk(iterations=3, slop=1e-6), "3 iterations, collision_slop 1e-6",
           **SCATTERS, is_truth=is_alone),
    engine(PYMUNK, "default", in_pymunk(iterations=10, slop=0.1), "10 iterations, collision_slop 0.1",
           **SCATTERS, is_truth=is_alone, finer_in_full=FINER),
    engine(PYBULLET, "", in_pybullet(),
           "boxes 0.4 m deep, maximal coordinates; solverResidualThreshold 0, contactSlop 1e-6, 50 iterations",
           order=LEVELS_OFF, limit=no_limit, predicted=LONG_LIVED,
           laws=watched.bullet_rules(ITERATIONS, rests=False), watched=WATCHED),
    engine(PYBULLET, "default", in_pybullet(residual=1e-7),
           "boxes 0.4 m deep, maximal coordinates; contactSlop 1e-6, 50 iterations",
           order=LEVELS_OFF, limit=no_limit, predicted=LONG_LIVED,
           laws=watched.bullet_rules(ITERATIONS, rests=False), watched=WATCHED),
)


def energies(p):
    """Energy [J] of the truth between two pictures each, from differences of places."""
    film = reference(p).film
    middle, rate = 0.5 * (film[1:] + film[:-1]), KEPT * np.diff(film, axis=0)
    kinetic = 0.5 * MASS * np.sum(rate[..., :2]**2, axis=(1, 2)) + 0.5 * inertia(p) * np.sum(rate[..., 2]**2, axis=1)
    return kinetic + MASS * p.g * np.sum(middle[..., 1], axis=1)


def sanity_checks():
    """Return Findings that hold for every motion, and the error bars."""
    p = CASES["six"]
    first, found = 0.5 * p.omega**2 * (inertia(p) + 0.25 * MASS * (p.width**2 + p.height**2)), energies(p)
    begins, film = MASS * p.g * p.n * 0.5 * p.height + first, reference(p).film
    x, angle, _, _ = begin(p, WINDOW)
    lowest = all_corners(film, p).reshape(-1, 2)[:, 1].min()
    return (*(states(f"{name}: error bar of the two codes at 1 s [-]", reference(q).bar, 0.0, AGREED)
              for name, q in CASES.items()),
            states("places when the last row begins [m], [rad]", film[round(KEPT * WINDOW)],
                   np.column_stack((x, angle)), 1e-4),
            states("energy of the truth when it has just begun [J]", found[0], begins, 1e-3 * begins),
            states("energy gained until the end, over the first [-]", max(0.0, found[-1] / begins - 1.0), 0.0, 0.0),
            states("lowest corner, below the floor by one step at 5 m/s [m]", min(0.0, lowest), 0.0, 2.5e-4),
            states("dominoes that overtake their neighbours [-]", np.sum(np.diff(film[..., 0], axis=1) <= 0.0), 0, 0),
            states("angle of the first at 1 s, which leans on the second [rad]", film[KEPT, 0, 2], -1.12, 0.05))


# ---------------------------------------------------------------------------------------------- picture

def points(observed, p):
    """Draw the four corners of each domino of the first row, and the floor."""
    end = p.pitch * p.n + p.height
    first = np.asarray(observed).reshape(ROWS, -1, 2)[0]
    return np.round(np.vstack((first, [(-p.pitch, 0.0), (end, 0.0)])), 4)


def links(p):
    return [*outlines(4, p.n), (4 * p.n, 4 * p.n + 1)]


SCENE = Scene(
    title="Dominoes",
    film_of_truth="two codes that agree",
    lesson="simulator",
    cases=CASES, duration=T, steps=STEPS,
    runners=RUNNERS,
    acceleration=lambda lessons: lessons.simulator.weight, start=start, run=run, observe=observe,
    truth=truth, truth_uncertainty=UNCERTAINTY, model=model, read=read,
    slow_cases=("fifteen", "six, smoother"),
    omitted_methods="sweeps and Murty's method alone are missing: they find forces and move no bodies",
    sanity_checks=sanity_checks,
    points=points, links=links,
    uses=("contact points of boxes", "soft contacts and memory", "one substep per step"),
    full_loop="its method is a whole loop itself, with soft contacts in place of rigid ones: the motions "
              "are not the same",
    ablations={"restitution": "wooden dominoes bounce slightly; no law says how several impacts at once do",
               "substeps": "two or four per step take 1.2 to 2.6 times as long, and err more",
               "sweeps that change nothing": "the loop ends its sweeps when they hardly change an impulse any more; "
                                             "with 100 in each step it errs by as much and takes longer"},
)
