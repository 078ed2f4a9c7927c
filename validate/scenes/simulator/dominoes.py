"""A row of dominoes, the first of them pushed: impacts, tilting, sliding and leaning all at once.

No formula gives this motion, and nobody published it.  Two codes that share nothing, the lesson's pile and pymunk, must
come to the same motion as their steps shrink; that is the test.  The loop of lesson 10 and pymunk do: with steps of
1/20,000 s they differ by 0.012 %.  The loop sweeps until an impact is finished.  The pile of lesson 9 visits each
contact twice per step, which does not finish an impact that runs through several contacts.  Even with steps of
1/50,000 s it stays ½ to 1 % away: up to 0.07 rad in a late domino.
"""

from functools import cache
from typing import Annotated, NamedTuple

import numpy as np

from solutions.checks import BadInput, check_friction, check_positive
from solutions.contact import box_bounds_2d, box_contacts_2d, make_pile_2d
from solutions.simulator import advance_contact
from solutions.simulator import weight as acceleration
from solutions.support.bodies import Bodies
from validate.engines.bullet import Rigid
from validate.engines.chipmunk import pymunk_floor, pymunk_space, pymunk_world
from validate.methods import PILE, SETTLED_LOOP
from validate.scene import PYBULLET, PYMUNK, Engine, EngineRun, Scene

T = 1.0                      # [s]
STEPS = (10, 20, 50, 100, 200, 500, 1000)
FINE = 50_000                # steps of the reference run in T
KEPT = 1000                  # of its states in T; between them it is interpolated
UNCERTAINTY = 1e-4           # of the limit of pymunk's runs, which are of first order
SWEEPS = 1                   # of the loop, before it looks whether a sweep still changes something
CARRIED = 0.3                # hertz of a soft contact times a step [-]: nearly the stiffest that a pile stands
ZETA, MARGIN = 10.0, 0.01    # damping ratio [-] and margin [m] of the pile


class Params(NamedTuple):
    n: Annotated[int, "dominoes"] = 6
    width: Annotated[float, "of each [m]"] = 0.08
    height: Annotated[float, "of each [m]"] = 0.4
    pitch: Annotated[float, "from one to the next [m]"] = 0.2
    mu: Annotated[float, "friction, everywhere [-]"] = 0.4
    omega: Annotated[float, "with which the first one begins to tilt [rad/s]"] = 4.0
    g: Annotated[float, "gravity [m/s²]"] = 9.81


CASES = {"six": Params(), "fifteen": Params(n=15), "six, smoother": Params(mu=0.25)}
ABOUT_1 = "about 1"          # an order that single runs do not show well
LEVELS_OFF = "1, then none"  # an order, towards another limit than pymunk's
MASS = 1.0                   # of each [kg]; nothing depends on it


def inertia(p):
    return MASS * (p.width**2 + p.height**2) / 12.0


def begin(p):
    """(x (n, 2), v (n, 2), angular velocities (n,)): upright; the first tilts about its lower right corner."""
    x = np.stack((p.pitch * np.arange(p.n), np.full(p.n, 0.5 * p.height)), axis=1)
    v, omega = np.zeros((p.n, 2)), np.zeros(p.n)
    v[0], omega[0] = 0.5 * p.omega * np.array([p.height, p.width]), -p.omega
    return x, v, omega


def start(p):
    for name in ("width", "height", "omega", "g"):
        check_positive(name, getattr(p, name))
    check_positive("gap between dominoes [m]", p.pitch - p.width)
    check_friction(p.mu)
    if p.n < 1:
        raise BadInput("n", p.n, "give one domino or more")
    x, v, omega = begin(p)
    half = np.full((p.n, 2), 0.5) * (p.width, p.height)
    state, pile = make_pile_2d(x, np.zeros(p.n), MASS, inertia(p), half, np.array([(0.0, 1.0, 0.0)]), (0.0, -p.g), p.mu,
                               1, 1.0, ZETA, MARGIN)
    return state._replace(v=np.vstack((v, np.zeros(2))), omega=np.append(omega, 0.0)), pile


def run(step, acceleration, state, p, dt, steps):
    state, pile = state
    if step.__name__ == "advance_pile_2d":
        shape = [getattr(f, "twin", f) for f in (box_bounds_2d, box_contacts_2d)]           # what a compiled step takes
        return step(*shape, state, dt, steps, pile._replace(hertz=CARRIED / dt)), pile
    bodies = Bodies(*(getattr(pile, name) for name in Bodies._fields[:6]), SWEEPS, pile.margin)
    return advance_contact(step, acceleration, box_bounds_2d, box_contacts_2d, 0.0, state, dt, steps, bodies), pile


def corners(x, angle, p):
    """Corners (8n,) [m] of dominoes at x (n, 2) with these angles (n,)."""
    c, s = np.cos(angle)[:, None], np.sin(angle)[:, None]
    a, b = 0.5 * p.width * np.array([-1.0, 1.0, 1.0, -1.0]), 0.5 * p.height * np.array([-1.0, -1.0, 1.0, 1.0])
    return np.stack((x[:, :1] + c * a - s * b, x[:, 1:] + s * a + c * b), axis=2).ravel()


def observe(state, p):
    state, _ = state
    return corners(state.x[:p.n], state.q[:p.n], p)


@cache
def reference(p):
    """(KEPT + 1, 8n): corners at equal intervals up to T, by pymunk with FINE steps."""
    space, dominoes = pymunk_row(p, 200, 1e-6)
    film = [read(dominoes, p)]
    for _ in range(KEPT):
        for _ in range(FINE // KEPT):
            space.step(T / FINE)
        film.append(read(dominoes, p))
    return np.array(film)


def truth(p, t):
    """No closed form is known.  The reference is pymunk with 50,000 steps per second and 200 iterations.

    The lessons share no code with it.  The pile shares no method either: pymunk has rigid contacts and moves before it
    pushes, the pile has soft contacts and pushes before it moves.  This scene tests that all three come to the same
    motion.  The loop does: with 20,000 steps it is within 0.02 %.  The pile stays about 1 % away, because two sweeps
    per step do not finish an impact.
    """
    film, place = reference(p), min(max(t / T, 0.0), 1.0) * KEPT
    k = min(int(place), KEPT - 1)
    return (k + 1 - place) * film[k] + (place - k) * film[k + 1]


def tolerance(p, dt):
    """Each impact of two dominoes is seen up to one step late.  Until then a corner goes v dt too far, with v = ω
    (height + width) of the first domino at most.  Whatever it meets later, it meets as late.  After n impacts each
    corner is off by n v dt: first order.  It is chance where in its step an impact falls.  So errors of single runs
    scatter by a factor of three about a line, and the slope through four of them says little.

    This limit leaves out the impacts that two sweeps do not finish.  At 1/1000 s it is still larger than their effect;
    with shorter steps the pile would depart.

    pybullet does not converge to this motion: its contact points live longer than a step.  No theory says how far it
    stays away, so its errors are shown and not judged.
    """
    size = np.linalg.norm(truth(p, T)) / np.sqrt(4.0 * p.n)
    late = p.n * p.omega * (p.height + p.width) * dt / size + UNCERTAINTY
    return {ABOUT_1: late, "pybullet": np.inf, "pybullet, default": np.inf}


# ---------------------------------------------------------------------------------------------- engines

def pymunk_row(p, iterations, slop):
    """(space, bodies)."""
    import pymunk
    space, dominoes = pymunk_space((0.0, -p.g)), []
    space.iterations, space.collision_slop = iterations, slop
    pymunk_floor(space)
    for x, v, omega in zip(*begin(p)):
        body = pymunk.Body(MASS, inertia(p))
        body.position, body.velocity, body.angular_velocity = tuple(map(float, x)), tuple(map(float, v)), float(omega)
        space.add(body, pymunk.Poly.create_box(body, (p.width, p.height)))
        dominoes.append(body)
    for shape in space.shapes:
        shape.friction, shape.elasticity = np.sqrt(p.mu), 0.0            # pymunk multiplies the two
    return space, dominoes


def read(dominoes, p):
    return corners(np.array([body.position for body in dominoes]), np.array([body.angle for body in dominoes]), p)


def pymunk_make(p, dt, iterations, slop):
    space, dominoes = pymunk_row(p, iterations, slop)
    return pymunk_world(space, dt, lambda: read(dominoes, p))


def pybullet_make(p, dt, iterations, residual):
    bullet = Rigid(dt, (0.0, 0.0, -p.g), iterations)
    pb = bullet.pb
    pb.setPhysicsEngineParameter(solverResidualThreshold=residual, contactSlop=1e-6)
    slab = pb.createCollisionShape(pb.GEOM_BOX, halfExtents=[50.0, 5.0, 1.0])
    ground = pb.createMultiBody(0, slab, basePosition=[0.0, 0.0, -1.0])
    pb.changeDynamics(ground, -1, lateralFriction=np.sqrt(p.mu), restitution=0)
    shape = pb.createCollisionShape(pb.GEOM_BOX, halfExtents=[0.5 * p.width, 0.2, 0.5 * p.height])
    moments = (10.0 * inertia(p), inertia(p), 10.0 * inertia(p))         # it turns about y only
    dominoes = [bullet.body(MASS, moments, (x[0], 0.0, x[1]), (0.0, -omega, 0.0), True, v=(v[0], 0.0, v[1]),
                            shape=shape, mu=np.sqrt(p.mu)) for x, v, omega in zip(*begin(p))]

    def where():
        x = np.array([bullet.position(body) for body in dominoes])[:, [0, 2]]
        turned = np.array([bullet.R(body) for body in dominoes])
        return corners(x, np.arctan2(turned[:, 2, 0], turned[:, 0, 0]), p)
    return EngineRun(bullet.step, where, bullet.close)


ENGINES = (
    Engine(PYMUNK, "", lambda p, dt: pymunk_make(p, dt, 50, 1e-6), ABOUT_1, "50 iterations, collision_slop 1e-6"),
    Engine(PYMUNK, "default", lambda p, dt: pymunk_make(p, dt, 10, 0.1), ABOUT_1, "10 iterations, collision_slop 0.1"),
    Engine(PYBULLET, "", lambda p, dt: pybullet_make(p, dt, 50, 0), LEVELS_OFF,
           "boxes 0.4 m deep, maximal coordinates; solverResidualThreshold 0, contactSlop 1e-6, 50 iterations"),
    Engine(PYBULLET, "default", lambda p, dt: pybullet_make(p, dt, 50, 1e-7), LEVELS_OFF,
           "boxes 0.4 m deep, maximal coordinates; contactSlop 1e-6, 50 iterations"),
)


def energies(p):
    """Energy [J] of the reference at its kept states, but the first and the last, from differences of places."""
    film = reference(p).reshape(KEPT + 1, p.n, 4, 2)
    x, side = film.mean(axis=2), film[:, :, 1] - film[:, :, 0]
    angle = np.unwrap(np.arctan2(side[..., 1], side[..., 0]), axis=0)
    v, omega = ((a[2:] - a[:-2]) * (0.5 * KEPT / T) for a in (x, angle))
    kinetic = 0.5 * MASS * np.sum(v**2, axis=(1, 2)) + 0.5 * inertia(p) * np.sum(omega**2, axis=1)
    return kinetic + MASS * p.g * np.sum(x[1:-1, :, 1], axis=1)


def sanity_checks():
    """((claim, found, expected, tolerance), …): what must hold whatever the motion is."""
    p = CASES["six"]
    first, found = 0.5 * p.omega**2 * (inertia(p) + 0.25 * MASS * (p.width**2 + p.height**2)), energies(p)
    begins, film = MASS * p.g * p.n * 0.5 * p.height + first, reference(p).reshape(KEPT + 1, p.n, 4, 2)
    order = np.diff(film.mean(axis=2)[:, :, 0], axis=1)
    return (("energy of the reference when it has just begun [J]", found[0], begins, 1e-3 * begins),
            ("its largest rise from one kept state to the next, over the first [-]",
             max(0.0, np.max(np.diff(found))) / begins, 0.0, 1e-3),
            ("lowest corner, where it is below the floor [m]", min(0.0, film[..., 1].min()), 0.0, 2e-5),
            ("dominoes that overtake their neighbours [-]", np.sum(order <= 0.0), 0, 0),
            ("angle of the first at 1 s, which leans on the second [rad]",
             np.arctan2(*(film[-1, 0, 1] - film[-1, 0, 0])[::-1]), -1.12, 0.05))


# ---------------------------------------------------------------------------------------------- picture

def points(observed, p):
    """The four corners of each domino, and the floor."""
    end = p.pitch * p.n + p.height
    return np.round(np.vstack((np.asarray(observed).reshape(-1, 2), [(-p.pitch, 0.0), (end, 0.0)])), 4)


def links(p):
    return [(4 * k + i, 4 * k + (i + 1) % 4) for k in range(p.n) for i in range(4)] + [(4 * p.n, 4 * p.n + 1)]


SCENE = Scene(
    title="Dominoes",
    film_of_truth="pymunk, 50,000 steps per second",
    lesson="simulator",
    cases=CASES, duration=T, steps=STEPS,
    methods=(PILE, SETTLED_LOOP),
    acceleration=acceleration, start=start, run=run, observe=observe,
    truth=truth, truth_uncertainty=UNCERTAINTY,
    tolerance=tolerance,
    engines=ENGINES,
    orders={"advance_pile_2d": ABOUT_1, "settled_contact_step_2d": ABOUT_1},
    finer_in_full={"settled_contact_step_2d": (2000, 5000, 10_000, 20_000)},
    shorter_in_quick={"settled_contact_step_2d": 200},
    slow_cases=("fifteen", "six, smoother"),
    omitted_methods="sweeps and Murty's method alone are missing: they find forces and move no bodies",
    sanity_checks=sanity_checks,
    points=points, links=links,
    uses=("contact points of boxes", "soft contacts and memory", "one substep per step"),
    full_loop="its method is a whole loop itself, with soft contacts in place of rigid ones: the motions "
              "are not the same",
    ablations={"restitution": "dominoes of wood bounce a little; no law says how several impacts at once do",
               "substeps": "two or four per step take two or four times as long, and come no nearer to the limit",
               "sweeps that change nothing": "the loop ends its sweeps when they hardly change an impulse any more; "
                                             "with 100 in each step it errs by as much and takes longer"},
)
