"""Discs, boxes, spheres and bricks, up to a thousand of them, fall between walls and come to rest.

The final place of each body cannot be predicted.  But the laws of a pile at rest are known.  The floor carries the
weight, the walls push equally from all sides, nothing overlaps, no energy was created, and every contact satisfies
the laws of Signorini and Coulomb.
"""

from functools import partial
from typing import Annotated, NamedTuple

import numpy as np

import solutions.contact
from solutions.checks import BadInput
from solutions.support.arms import world_inertia
from solutions.support.broad_phase import near_pairs
from validate.check import states
from validate.engines import watched
from validate.engines.bullet import WARM, WARMER
from validate.engines.contact import DT, KINDS, MU, G, bullet_pile, fallen, inverse_tensors, pymunk_pile
from validate.methods import PILE, PILE_IN_SPACE
from validate.reference.contact import natural_residual
from validate.scene import EXACT, PYBULLET, PYMUNK, Scene, engine, ours
from validate.scenes._common import ANSWER, one_reading
from validate.scenes.drawing import box, outlines, seen, sphere

T = 1.0
BLOCK = 10                   # steps between two evaluations of the energy
QUIET = 1e-2                 # largest imbalance of a pile at rest, over the weight [-]
CREEPING = 2.0 * QUIET       # four numbers of 1 % each [-]
CHAINS = 4.0                 # largest force in a pile over the mean force in a column [-]
PYRAMID = np.sqrt(2.0)       # factor by which pybullet's friction exceeds μ along the diagonals of its pyramid [-]
FALL: dict = {}              # {p: [(x, q), …]} of our last run of a case, block by block, for the film


class Params(NamedTuple):
    kind: Annotated[str, "discs, boxes, spheres or bricks"] = "spheres"
    n: Annotated[int, "how many"] = 12
    across: Annotated[int, "of them side by side at the start"] = 2
    seconds: Annotated[float, "for which they fall and come to rest [s]"] = 2.0
    judged: Annotated[int, "1: with the residual of the contacts"] = 1


CASES = {
    "12 spheres": Params(), "30 discs": Params("discs", 30, 6), "200 discs": Params("discs", 200, 20, 4.0),
    "200 boxes": Params("boxes", 200, 20, 6.0), "200 spheres": Params("spheres", 200, 6, 4.0, 0),
    "200 bricks": Params("bricks", 200, 6, 4.0, 0),
    "200 spheres, judged": Params("spheres", 200, 6, 4.0), "200 bricks, judged": Params("bricks", 200, 6, 6.0),
    **{f"1,000 {name}": Params(name, 1000, kind.across, 4.0, int(name == "discs")) for name, kind in KINDS.items()},
    "1,000 spheres, judged": Params("spheres", 1000, 10, 6.0), "1,000 bricks, judged": Params("bricks", 1000, 10, 8.0),
}


def kind_of(p):
    if p.kind not in KINDS:
        raise BadInput("kind", p.kind, f"choose from: {', '.join(KINDS)}")
    return KINDS[p.kind]._replace(across=p.across)


def start(p):
    """Return (PileState, Pile) on a lattice."""
    if p.n < 1 or p.across < 1:
        raise BadInput("n or across", min(p.n, p.across), "give 1 or more")
    return fallen(kind_of(p), p.n)


def geometry(lessons, p):
    """Return (bounds, contacts) of a kind of pile: given functions of lesson 9, compiled ones for a compiled step."""
    contact = lessons.contact
    return {"discs": (contact.disc_bounds, contact.round_contacts),
            "boxes": (contact.box_bounds_2d, contact.box_contacts_2d),
            "spheres": (contact.ball_bounds, contact.round_contacts),
            "bricks": (contact.box_bounds, contact.box_contacts)}[p.kind]


def run(lessons, step, acceleration, state, p, dt, steps):
    """Run the pile in blocks of BLOCK steps.

    Return its end and the largest rise of its energy from one block to the next.
    """
    (pile_state, pile), shape, energies = state, geometry(lessons, p), []
    FALL[p] = [(pile_state.x, pile_state.q)]
    for _ in range(round(p.seconds / DT / BLOCK)):
        pile_state = step(*shape, pile_state, DT, BLOCK, pile)
        energies.append(energy(pile, pile_state.x, pile_state.q, pile_state.v, pile_state.omega))
        FALL[p].append((pile_state.x, pile_state.q))
    return pile_state, pile, energies


def observe(state, p):
    """Return all observed numbers of the pile at the end; see quantity_names."""
    end, pile, energies = state
    c, h = end.contacts, DT / pile.substeps
    wall = np.sum(end.J[c.b >= p.n], axis=0) / h
    inv_inertia = pile.inv_inertia
    if kind_of(p).d == 3:
        inv_inertia = world_inertia(geometry(solutions, p)[0](end.x, end.q, pile.half)[2], inv_inertia)
    residual = natural_residual((end.x, end.v, end.omega, pile.inv_mass, inv_inertia), (c.a, c.b, c.n, c.p, c.gap),
                                end.J, MU, h)
    return numbers(p, pile, end.x, end.q, wall, energies, residual)


def energy(pile, x, q, v, omega):
    """Return the kinetic and potential energy [J]; x and v have rows for the planes, too."""
    n = len(pile.half)
    m, turned = 1.0 / pile.inv_mass[:n], omega[:n]
    moments = 1.0 / pile.inv_inertia[:n]
    if pile.half.shape[1] == 3:
        inverse = inverse_tensors(q[:n], pile.inv_inertia[:n])
        spin = np.sum(turned * np.linalg.solve(inverse, turned[:, :, None])[:, :, 0])
    else:
        spin = np.sum(moments * turned**2)
    return 0.5 * (np.sum(m[:, None] * v[:n] ** 2) + spin) - np.sum(m[:, None] * x[:n] * pile.gravity)


def numbers(p, pile, x, q, wall, energies, residual):
    """Return the observed numbers, computed from positions, forces, energies and the residual [m/s]."""
    weight = G * np.sum(1.0 / pile.inv_mass[:p.n])
    rise = max(0.0, np.max(np.diff(energies))) / energies[0]
    bounds, contacts = geometry(solutions, p)
    low, high, turn = bounds(x, q, pile.half)
    gap = contacts(x, turn, pile.half, pile.planes, near_pairs(low, high, pile.planes), 0.0).gap
    deep = max(0.0, -np.min(gap, initial=0.0)) / np.min(pile.half)
    found = [wall[-1] / weight, np.linalg.norm(wall[:-1]) / weight, rise, deep]
    return np.array(found + ([] if not p.judged else [residual / (G * DT)]))


def truth(p, t):
    """At rest the floor carries the whole weight: Newton's second law for the sum of the bodies.  The forces of the
    walls balance.  Rigid bodies do not overlap, e = 0 creates no energy, and the natural map has no residual.

    The residual is that of the impulses of the last step, ours or an engine's.  pybullet's friction is a pyramid, which
    reaches √2 μ along its diagonals.  It is judged with √2 μ here, and with μ in a stability case.
    Source: Newton; Signorini and Coulomb.
    """
    return np.array([1.0, 0.0, 0.0, 0.0] + ([] if not p.judged else [0.0]))


def limit(p, dt):
    """A pile at rest still creeps.  The limit is for the size of all differences together: 2 %, as of four numbers that
    are each off by 1 % of the weight, or of g dt, and the sag of a soft contact, k_n F/(2π hertz)².  Between bodies of
    the smallest mass k_n = 2/m, and twice that at corners.  F is 4 times the weight of a column of the heaviest bodies,
    n/across of them, and in space n/across², because forces concentrate in chains.
    """
    kind, corner = kind_of(p), 2.0 if p.kind in ("boxes", "bricks") else 1.0
    columns = p.across ** (kind.d - 1)
    sag = corner * 2.0 * CHAINS * 1.3 * np.ceil(p.n / columns) * G / (2.0 * np.pi * kind.hertz) ** 2 / 0.08
    return CREEPING + sag


def pymunk_limit(p, dt):
    """pymunk lets bodies overlap by its slop, 1e-3 m, over the smallest half size of 0.08 m, and by the same amount
    again where its iterations have not converged.
    """
    return CREEPING + 2.0 * 1e-3 / 0.08


def unknown(p, dt):
    """pymunk's default slop, 0.1 m, is larger than half of the smallest body.  pybullet's iterations leave more than
    its slop.  No theory says how much, so these errors are shown.  The laws of contact judge what the engine reports
    of some of its steps.
    """
    return np.inf


# ---------------------------------------------------------------------------------------------- engines

def make(p, dt, rival, wider=1.0):
    """Make the EngineRun of an engine's pile: its whole run is one long reading."""
    kept = []

    def read():
        state, pile = start(p)
        world, energies, blocks = rival(kind_of(p), state, pile), [], round(p.seconds / DT / BLOCK)
        for block in range(blocks):
            watched.run(world.watching, BLOCK, kept, {BLOCK - 1} if block in watched.watched_steps(blocks) else ())
            energies.append(energy(pile, *world.places(), *world.velocities()))
        residual = 0.0
        if p.judged:
            judged = world.judged()
            residual = natural_residual(*judged, wider * MU, DT)
        found = numbers(p, pile, *world.places(), world.wall_force(), energies, residual)
        world.close()
        return found
    return one_reading(read, watched=lambda: kept)


def flat(p):
    return kind_of(p).d == 2


def solid(p):
    return kind_of(p).d == 3


def few_in_space(p):
    """Return whether few bodies are in space: with many, pybullet's residual stays, and 1,000 take a minute."""
    return solid(p) and p.n <= (12 if p.judged else 200)


CREEPS = "the final place of each body and its creep there are unknown; the limit bounds the creep"
NO_LAW = "no theory says how much its iterations leave"
STILL_CREEPS = "10 iterations per step do not bring a pile to rest"
RUNNERS = (
    ours(PILE_IN_SPACE, limit=limit, predicted=CREEPS, order=EXACT, supports=solid),
    ours(PILE, limit=limit, predicted=CREEPS, order=EXACT, supports=flat),
    engine(PYMUNK, "", partial(make, rival=partial(pymunk_pile, iterations=50, slop=1e-3)),
           "50 iterations, collision_slop 1e-3; steps of 1/240 s",
           order=EXACT, limit=pymunk_limit, predicted=CREEPS, supports=flat),
    engine(PYMUNK, "default", partial(make, rival=partial(pymunk_pile, iterations=10, slop=0.1)),
           "10 iterations, collision_slop 0.1; steps of 1/240 s",
           order=EXACT, limit=unknown, predicted=NO_LAW, supports=flat,
           laws=watched.pymunk_rules(10, STILL_CREEPS)),
    engine(PYBULLET, "", partial(make, rival=partial(bullet_pile, iterations=50), wider=PYRAMID),
           f"maximal coordinates; solverResidualThreshold 0, 50 iterations, warmStartingFactor {WARM}, because with "
           f"{WARMER} twelve spheres do not come to rest; steps of 1/240 s",
           order=EXACT, limit=unknown, predicted=NO_LAW, supports=few_in_space,
           laws=watched.bullet_rules(50, creeps=True)),
    engine(PYBULLET, "default", partial(make, rival=partial(bullet_pile, iterations=50, residual=1e-7), wider=PYRAMID),
           f"maximal coordinates; 50 iterations, warmStartingFactor {WARM}; steps of 1/240 s",
           order=EXACT, limit=unknown, predicted=NO_LAW, supports=few_in_space,
           laws=watched.bullet_rules(50, creeps=True)),
)


def quantity_names(p):
    names = ["floor's force over the weight [-]", "sum of the walls' forces over it [-]",
             "largest rise of the energy over the first [-]", "deepest overlap over the smallest half size [-]"]
    return names + ([] if not p.judged else ["residual of the natural map, all contacts at once, over g dt [-]"])



def judge_of_one_ball(J, mu):
    """Return the residual over g dt of a ball of 1 kg at rest on a floor, whose impulse is J times m g dt."""
    bodies = (np.zeros((2, 3)), np.zeros((2, 3)), np.zeros((2, 3)), np.array([1.0, 0.0]),
              np.array([np.eye(3) / (0.4 * 0.1**2), np.zeros((3, 3))]))
    contact = (np.array([0]), np.array([1]), np.array([(0.0, 0.0, 1.0)]), np.array([(0.0, 0.0, -0.1)]), np.zeros(1))
    return natural_residual(bodies, contact, G * DT * np.array([J]), mu, DT) / (G * DT)


def sanity_checks():
    """Return Findings: the residual detects wrong impulses, and accepts right ones."""
    right = [judge_of_one_ball(J, mu) for J, mu in (((0, 0, 1), 0.5), ((0.3, 0.4, 1), 0.5), ((9, 0, 1), np.inf))]
    # k_n = 1/m; k_t = 2/m + r²/I · 2 = 2 + 5 of a ball
    wrong = [judge_of_one_ball(J, mu) for J, mu in (((0, 0, -1), 0.5), ((0.6, 0.0, 1), 0.5))]
    return (states("residual of impulses that keep the laws [-]", right, 0.0, 1e-12),
            states("of one that pulls, and of friction that is 0.1 too large [-]", wrong, (1.0, 0.7), 1e-12))


# ---------------------------------------------------------------------------------------------- picture

def our_film(p):
    """Return [seconds, poses (n, 7) of every body at each frame] of our last run; only the start if there was none."""
    state = start(p)[0]
    fall = FALL.get(p, [(state.x, state.q)])
    return (len(fall) - 1) * BLOCK * DT, [in_space(x[:p.n], q[:p.n]) for x, q in fall]


def in_space(x, q):
    """Return poses (n, 7) of bodies; those of two dimensions stand upright in the plane x = 0."""
    if x.shape[1] == 2:
        x, q = np.insert(x, 0, 0.0, axis=1), np.stack((np.cos(0.5 * q), np.sin(0.5 * q), 0.0 * q, 0.0 * q), axis=1)
    return np.hstack((x, q))


def bodies(p):
    """Return spheres and boxes; a disc is drawn as a sphere, and a box of two dimensions as thick as it is wide."""
    halves = start(p)[1].half
    if kind_of(p).shape == "round":
        return [sphere(half[0]) for half in halves]
    return [box((half[0], *half) if len(half) == 2 else half) for half in halves]


def walls(p):
    """Return the edges of the container, as high as the initial lattice; in two dimensions its floor and two walls."""
    state, pile = start(p)
    wall, high = pile.planes[1, -1], np.max(state.x[:p.n, -1] + np.max(pile.half, axis=-1))
    if state.x.shape[1] == 2:
        corners = np.array([(0.0, -wall, high), (0.0, -wall, 0.0), (0.0, wall, 0.0), (0.0, wall, high)])
        return np.stack((corners[:-1], corners[1:]), axis=1)
    floor = np.array([(u * wall, v * wall, 0.0) for u, v in ((-1, -1), (1, -1), (1, 1), (-1, 1))])
    rim = floor + np.array((0.0, 0.0, high))
    return [*zip(floor, np.roll(floor, 1, axis=0)), *zip(floor, rim), *zip(rim, np.roll(rim, 1, axis=0))]


SIDES = 16                   # of a circle in the picture


def points(poses, p):
    """Draw the first case: the outline of every sphere, seen obliquely from the front, and the floor."""
    pile, turn = start(p)[1], np.linspace(0.0, 2.0 * np.pi, SIDES + 1)[:-1]
    ring = np.stack((np.cos(turn), np.sin(turn)), axis=1)
    circles = [middle + half[0] * ring for middle, half in zip(seen(poses[:, :3]), pile.half)]
    wall = pile.planes[1, -1]
    floor = seen([(u * wall, v * wall, 0.0) for u, v in ((-1, -1), (1, -1), (1, 1), (-1, 1))])
    return np.round(np.concatenate((*circles, floor)), 4)


def links(p):
    return outlines(SIDES, p.n) + outlines(4, 1, SIDES * p.n)


SCENE = Scene(
    title="Piles", lesson="contact",
    cases=CASES, **ANSWER,
    runners=RUNNERS,
    start=start, run=run, observe=observe,
    truth=truth, truth_uncertainty=1e-15,
    slow_cases=tuple(CASES)[1:],
    omitted_methods="sweeps and Murty's method alone are missing: they move no bodies, and a matrix of 2,000 contacts "
                    "would have 16 million numbers; pybullet's residual stays between 0.3 and 4 g dt with 200 and with "
                    "1,000 bodies, because 50 iterations do not find the forces; the command "
                    "validate piles compares piles of 1,000 bodies",
    quantity_names=quantity_names,
    sanity_checks=sanity_checks,
    points=points, links=links, our_film=our_film,
    bodies=bodies, poses=lambda poses, p: poses, ground=True, walls=walls,
    uses=("a broad phase that looks again only when something has left its widened box", "contact points", "memory",
          "soft contacts with substeps"),
    full_loop="its method is a whole loop itself, of which only the end is seen",
    ablations={"sleeping": "it would hide whether a pile comes to rest",
               "restitution": "e = 0 everywhere: what several impacts at once do with it is a choice, and no law"},
)
