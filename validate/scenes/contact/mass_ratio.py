"""A heavy box on a light one: 10, 100, 1,000 and a million times as heavy.

A sweep leaves r/(1 + r) of the error, so the number of sweeps grows with the mass ratio r.  Four results are
compared: the forces, the depth to which soft contacts sink, the number of sweeps, and whether the boxes stand at all.
At a ratio of a million the sweeps do not converge, and must report it.
"""

from typing import Annotated, NamedTuple

import numpy as np

from solutions.checks import Diverged
from solutions.contact import (
    make_contacts,
    make_pile_2d,
)
from validate.check import Whose, states
from validate.engines.bullet import CONTACT_ERP, WARM
from validate.engines.mujoco import SOFT
from validate.methods import COUNTED_SWEEPS, DIRECT, PILE, SWEEPS
from validate.reference.contact import (
    Settling,
    Towers,
    rounded_force,
    rounded_overlap,
    sway_of_tower,
    sweeps_needed,
    unrest_in_pymunk,
)
from validate.reference.stored import stored
from validate.scene import EXACT, MUJOCO, PYBULLET, PYMUNK, Departure, Scene, engine, ours
from validate.scenes._common import ANSWER, cases_with, check_positives, sole_array
from validate.scenes.contact._common import DT, FROM_ZERO, OVERLAP, WAITING, frictions, in_tower, tower
from validate.scenes.drawing import outlines

T = 1.0
MU = 0.5                     # nothing slides
SMALL = 1e-3                 # sweeps are counted until the forces have this error [-]
ZETA = 10.0                  # damping ratio of the pile's contacts [-]
STANDS = 0.1                 # displacement over the size of a box below which it stands [-]
WHOLE = 1e-15                # error of a whole number, which must be exact [-]
ROUNDED = 1e-12              # of the forces of MuJoCo at rest, relative [-]
FINE = {"iterations": 1000, "slop": 1e-4}                    # of pymunk; slop [m]


class Params(NamedTuple):
    kind: Annotated[str, "forces, overlap, sweeps, relaxed, stands or refused"] = "forces"
    r: Annotated[float, "mass of the upper box over that of the lower one [-]"] = 10.0
    m: Annotated[float, "mass of the lower one [kg]"] = 1.0
    size: Annotated[float, "edge of both [m]"] = 1.0
    g: Annotated[float, "gravity [m/s²]"] = 9.81


CASES = {
    "forces, 10 : 1": Params(), "forces, 100 : 1": Params(r=100.0), "forces, 1,000 : 1": Params(r=1e3),
    "forces, a million : 1": Params(r=1e6),
    "overlap, 10 : 1": Params("overlap"), "overlap, 1,000 : 1": Params("overlap", 1e3),
    "sweeps, 10 : 1": Params("sweeps"), "sweeps, 100 : 1": Params("sweeps", 100.0),
    "sweeps, 1,000 : 1": Params("sweeps", 1e3),
    "relaxed sweeps, 10 : 1": Params("relaxed"), "relaxed sweeps, 1,000 : 1": Params("relaxed", 1e3),
    "relaxed sweeps, a million : 1": Params("relaxed", 1e6),
    "1,000 on 1, standing": Params("stands", 1e3), "a million on 1, refused": Params("refused", 1e6),
}
SOLVERS = {                  # (substeps, hertz [1/s], settling time [s]) of the pile, up to this mass ratio
    10.0: (4, 240.0, 1.5), 100.0: (16, 480.0, 1.0), 1e3: (16, 480.0, 3.0), np.inf: (16, 480.0, 5.0),
}


def solver(p):
    return next(settings for most, settings in SOLVERS.items() if p.r <= most)


def masses(p):
    return p.m * np.array([1.0, p.r])


def start(p):
    """Return (centres (3, 2), inverse masses, inverse moments, contacts from below, load).

    The last body is the ground.
    """
    check_positives(p, "r", "m", "size", "g")
    x = p.size * np.array([(0.0, 0.5), (0.0, 1.5), (0.0, -0.5)])
    inv_mass = np.append(1.0 / masses(p), 0.0)
    places = p.size * np.array([(0.0, 0.0), (0.0, 1.0)])
    contacts = make_contacts([0, 1], [2, 0], places, [(0.0, 1.0)] * 2, inv_mass)
    load = np.zeros((3, 3))
    load[:2, 1] = -masses(p) * p.g
    return x, inv_mass, 6.0 / p.size**2 * inv_mass, contacts, load


def run(lessons, step, acceleration, state, p, dt, steps):
    """Return the quantity that `p.kind` names."""
    if p.kind in ("sweeps", "relaxed"):
        return (np.array([count(lessons, step, state, p)]),)
    if p.kind == "refused":
        return (np.array([refuses(lessons, step, state, p)]),)
    if step is not lessons.contact.advance_pile_2d:
        return (forces_of(lessons, step, state, p),)
    depths, forces = settled(lessons, step, p)
    stands = np.array([1.0 * (np.max(np.abs(depths)) < STANDS * p.size)])
    return ({"forces": forces, "overlap": depths, "stands": stands}[p.kind],)


def normals_only(lessons, state):
    """Return (A, b) of both contacts without friction."""
    contact, (x, inv_mass, inv_inertia, contacts, load) = lessons.contact, state
    G, w = contact.contact_rows(x, contacts)[::2], contact.inverse_masses(inv_mass, inv_inertia)
    return contact.delassus_matrix(G, w), G @ (w * load.ravel())


def forces_of(lessons, step, state, p):
    """Return the forces (2,) by a solver, with one contact in the middle of each joint."""
    if step is lessons.contact.contact_forces:
        return step(*state, np.full(2, MU))[0][:, 0]
    return step(*normals_only(lessons, state))


def count(lessons, step, state, p):
    """Return the number of sweeps from zero until both forces are right to SMALL.

    A wrong sweep ends at ten times the expected number.
    """
    (A, b), lam = normals_only(lessons, state), np.zeros(2)
    forces, omega = weights(p), relaxation(lessons, p)
    most = 10.0 * sweeps_needed(p.r, best(p.r) if p.kind == "relaxed" else 1.0, SMALL)
    done = 0
    while np.max(np.abs(lam / forces - 1.0)) > SMALL and done < most:
        lam, done = step(A, b, lam, omega), done + 1
    return float(done)


def relaxation(lessons, p):
    """Return the lesson's best relaxation, or none."""
    contact = lessons.contact
    return contact.best_relaxation(contact.mass_ratio_contraction(p.r))[0] if p.kind == "relaxed" else 1.0


def refuses(lessons, step, state, p):
    """Return 1 if it ends in Diverged with a residual, else 0."""
    try:
        settled(lessons, step, p) if step is lessons.contact.advance_pile_2d else forces_of(lessons, step, state, p)
    except Diverged as e:
        return 1.0 * ("residual" in str(e))
    return 0.0


def settled(lessons, advance, p):
    """Return (depths [m], forces [N]), both (2,) from below, of boxes stacked as a pile."""
    substeps, hertz, seconds = solver(p)
    half = np.full((2, 2), 0.5 * p.size)
    state, pile = make_pile_2d(start(p)[0][:2], np.zeros(2), masses(p), masses(p) * p.size**2 / 6.0, half,
                               np.array([(0.0, 1.0, 0.0)]), (0.0, -p.g), MU, substeps, hertz, ZETA, 0.02 * p.size)
    shape = lessons.contact.box_bounds_2d, lessons.contact.box_contacts_2d
    end = advance(*shape, state, DT, round(seconds / DT), pile)
    forces = np.zeros(2)
    for b, J in zip(end.contacts.b, end.J):
        forces[0 if b == 2 else 1] += abs(J[1]) * substeps / DT
    return p.size * np.array([0.5, 1.0]) - np.diff(end.x[:2, 1], prepend=0.0), forces


def weights(p):
    """Return the force on each contact [N], from below."""
    return p.m * p.g * np.array([1.0 + p.r, p.r])


def best(r):
    """Return the relaxation at which both eigenvalues of a sweep are equal: z² + (2(ω − 1) − ω² ρ) z + (ω − 1)² = 0."""
    return 2.0 / (1.0 + 1.0 / np.sqrt(1.0 + r))


def truth(p, t):
    """Newton's second law for all bodies above a contact gives the forces: (1 + r) m g and r m g.

    overlap     A soft contact sinks by k_n F/(2π hertz)².  A box of mass M has k_n = 1/M + (w/2)²/I = 2.5/M at each of
                two corners, and each corner carries half.  That gives 1.25 (1 + r) g/(2π hertz)² under both boxes,
                because the upper contact has k_n = 2.5 (1 + 1/r)/m and half of r m g.
    sweeps      A sweep leaves ρ = r/(1 + r) of the error: ln(1/1000)/ln ρ sweeps.  The best relaxation has a double
                eigenvalue ω − 1; the recursion of its two errors is counted to the end.
    stands      1: both boxes stand
    refused     1: the sweeps end in an error, because they cannot find the forces
    Source: Newton; Catto 2011 for soft contacts; Young 1971 for relaxation.
    """
    if p.kind == "overlap":
        return np.full(2, sag(p))
    if p.kind in ("sweeps", "relaxed"):
        return np.array([sweeps_needed(p.r, best(p.r) if p.kind == "relaxed" else 1.0, SMALL)])
    return weights(p) if p.kind == "forces" else np.ones(1)


def sag(p):
    return 1.25 * (1.0 + p.r) * p.g / (2.0 * np.pi * solver(p)[1]) ** 2


def count_limit(p, dt):
    """The number of sweeps is a whole number, and whether boxes stand or are refused is 0 or 1: all must be exact."""
    return WHOLE


def swept_limit(p, dt):
    """forces: sweeps stop when the residual is 1e-13 of the largest (|A||F| + |b|)_k; the error is at most the
    residual over the smallest eigenvalue of A.
    """
    if p.kind != "forces":
        return WHOLE
    A, forces = normal_matrix(p), truth(p, T)
    least = np.linalg.eigvalsh(A)[0]
    return 1e-13 * (np.max(np.abs(A) @ forces) + p.g) / least * np.sqrt(2.0) / np.linalg.norm(forces)


def solved_limit(p, dt):
    """forces: Murty's method solves a linear system: 1.1e-16 times the condition of A, and ten for the operations."""
    values = np.linalg.eigvalsh(normal_matrix(p))
    return 10.0 * 1.1e-16 * values[-1] / values[0]


def pile_limit(p, dt):
    """forces: the pile still rocks slightly when it is read.  The limit is three times the sway that the recursion
    of its sweeps predicts, because the phase of the rocking depends on the places of the corners; the force of a
    rounded gap is added.
    overlap: the upper box slides aside by no more than it sinks, and shifts a corner: a relative change of
    2 (w/2)²/I/k_n times twice that over w, or 2.4 depths over w; the sway of a corner is added, as for the forces.
    """
    if p.kind == "overlap":
        return 2.4 * sag(p) / p.size + sway(p)
    return sway(p) if p.kind == "forces" else WHOLE


def pymunk_limit(p, dt):
    """forces: pymunk rocks, too.  Its limit is three times the sway that the recursion of its sweeps predicts, and the
    rounding errors of Murty's method.
    """
    return 3.0 * unrest(p) + solved_limit(p, dt) if p.kind == "forces" else WHOLE


def pybullet_limit(p, dt):
    """forces: pybullet begins each step with the last impulses, and removes 8 % of an overlap per step.  So only the
    rounding of an overlap remains.
    """
    return rounded_overlap(masses(p), p.size, p.g, CONTACT_ERP, DT) if p.kind == "forces" else WHOLE


def mujoco_limit(p, dt):
    """forces: MuJoCo's contacts are at rest, up to round-off."""
    return ROUNDED


def normal_matrix(p):
    """Return A of the normal impulses, with one contact in the middle of each joint."""
    light, heavy = 1.0 / masses(p)
    return np.array([(light, -light), (-light, light + heavy)])


def unrest(p):
    """Return the relative error of pymunk's forces when they are read."""
    how = Towers(DT, **FINE, overlap=OVERLAP, frictions=frictions(model(p)), seconds=WAITING)
    return stored("mass_ratio", unrest_in_pymunk, tuple(masses(p)), p.size, p.g, how)


def sway(p):
    """Return the largest relative error of the forces of the pile when they are read."""
    substeps, hertz, seconds = solver(p)
    how = Settling(DT, substeps, hertz, ZETA, MU, seconds)
    rocks = stored("mass_ratio", sway_of_tower, tuple(masses(p)), p.size, p.g, how)
    return 3.0 * rocks + rounded_force(masses(p), p.size, p.g, hertz)


# ---------------------------------------------------------------------------------------------- engines

def answer(p, forces, bottoms):
    """Return an engine's result: forces, overlaps, or whether both boxes are still in place.

    An engine never refuses.
    """
    if p.kind == "overlap":
        return -np.diff(bottoms, prepend=0.0)
    if p.kind == "forces":
        return forces
    return np.array([1.0 * (p.kind == "stands" and np.max(np.abs(bottoms)) < STANDS * p.size)])


def model(p, d=2):
    return tower(masses(p), p.size, p.g, MU, d)


def too_few(sweeps):
    """Return the reason why this number of sweeps per step does not carry the heavy box, and no error reports it."""
    steps = sweeps_needed(1e3, 1.0, SMALL) / sweeps
    return Departure(f"a mass ratio of 1,000 already takes 6,912 sweeps, which are {steps:.0f} of its steps. Before "
                     "they are over, the heavy box squeezes the light one out. No error warns of it",
                     lambda p, t: np.zeros(1), Whose.DEFAULT)


NO_REFUSAL = Departure("a mass ratio of a million would take 6.9 million sweeps. It ends each step after its "
                       "iterations, and by default reports no residual",
                       lambda p, t: np.array([1.0 * (p.kind == "stands")]), Whose.DEFAULT)


def up_to(**most):
    """Return the field `supports` of a runner that supports these kinds of questions up to these mass ratios.

    Only Murty's method and the question of refusal run at a ratio of a million.
    """
    of_kind = cases_with("kind", tuple(most), CASES)
    return lambda p: of_kind(p) and p.r <= most[p.kind]


def too_many(p):
    """A million is too much for the sweeps."""
    return "it would take 6.9 million sweeps, and ends in Diverged after 50,000" if p.r > 1e3 else ""


ANY = np.inf
PHASE = "only the size of its rocking is known, because its phase depends on the exact places of the corners"
RUNNERS = (
    ours(DIRECT, limit=solved_limit, order=EXACT, supports=up_to(forces=ANY),
         predicted="it solves a linear system: only round-off is left, and the limit bounds it"),
    ours(SWEEPS, limit=swept_limit, order=EXACT, supports=up_to(forces=ANY, refused=ANY),
         unfinished=lambda p: too_many(p) if p.kind == "forces" else "",
         predicted="its sweeps stop at a residual, and the limit bounds what is left"),
    ours(PILE, limit=pile_limit, order=EXACT, predicted=PHASE,
         supports=up_to(forces=1e3, overlap=ANY, stands=ANY, refused=ANY)),
    ours(COUNTED_SWEEPS, limit=count_limit, order=EXACT, supports=up_to(sweeps=ANY, relaxed=ANY),
         predicted="exact: counts are whole numbers"),
    engine(PYMUNK, "", in_tower(PYMUNK, model, answer, **FINE, overlap=OVERLAP),
           "1,000 iterations, collision_slop 1e-4; 3 s of 1/240 s",
           order=EXACT, limit=pymunk_limit, predicted=PHASE, supports=up_to(forces=1e3, stands=ANY)),
    engine(PYMUNK, "default", in_tower(PYMUNK, model, answer, iterations=10, slop=0.1, overlap=OVERLAP),
           "10 iterations, collision_slop 0.1; 3 s of 1/240 s",
           order=EXACT, limit=count_limit, departure=too_few(10), supports=up_to(stands=ANY, refused=ANY),
           predicted="exact: it is 1 or 0"),
    engine(PYBULLET, "", in_tower(PYBULLET, model, answer, **FROM_ZERO | {"ground": True}, iterations=1000, warm=1.0),
           "maximal coordinates, the floor's too; solverResidualThreshold 0, 1,000 iterations, warmStartingFactor 1; "
           "3 s of 1/240 s",
           order=EXACT, limit=pybullet_limit, supports=up_to(forces=1e3, stands=ANY),
           predicted="only the rounding of an overlap is left, and the limit bounds it"),
    engine(PYBULLET, "default", in_tower(PYBULLET, model, answer, maximal=False, overlap=0.0, slop=1e-5, iterations=50,
                                         residual=1e-7),
           f"reduced coordinates, 50 iterations, warmStartingFactor {WARM}; 3 s of 1/240 s",
           order=EXACT, limit=count_limit, departure=NO_REFUSAL, supports=up_to(stands=ANY, refused=ANY),
           predicted="exact: it is 1 or 0"),
    engine(MUJOCO, "", in_tower(MUJOCO, model, answer), f"{SOFT}; 3 s of 1/240 s",
           order=EXACT, limit=mujoco_limit, supports=up_to(forces=100.0),
           predicted="at rest only roundings are left, and the limit bounds them"),
)


def quantity_names(p):
    return {"forces": ["force under the light box [N]", "force under the heavy box [N]"],
            "overlap": ["overlap under the light box [m]", "overlap under the heavy box [m]"],
            "sweeps": ["sweeps until the forces are right to 10⁻³ [-]"],
            "relaxed": ["sweeps at the best relaxation until the forces are right to 10⁻³ [-]"],
            "stands": ["1: both boxes are where they were put"],
            "refused": ["1: it ends in an error that names the residual"]}[p.kind]


def sanity_checks():
    """Return Findings: the truths by other methods."""
    light = 1.0 - 1.0 / 11.0
    by_hand = next(k for k in range(1, 1000) if light**k <= SMALL)
    omegas = np.linspace(1.5, 1.6, 1001)
    sizes = [max(np.abs(np.roots([1.0, 2.0 * (w - 1.0) - w**2 * light, (w - 1.0) ** 2]))) for w in omegas]
    return (states("sweeps at 10 : 1, by powers of ρ [-]", sweeps_needed(10.0, 1.0, SMALL), by_hand, 0.0),
            states("best relaxation at 10 : 1, by search [-]", omegas[np.argmin(sizes)], best(10.0), 1e-4),
            states("the weight of both over that of the light one [-]", weights(Params())[0] / 9.81, 11.0, 1e-13))


# ---------------------------------------------------------------------------------------------- picture

def points(observed, p):
    """Draw both boxes from the side, and the ground; the heavy box is hatched."""
    square = p.size * np.array([(-0.5, 0.0), (0.5, 0.0), (0.5, 1.0), (-0.5, 1.0)])
    hatching = p.size * np.array([(s, 1.0 + h) for s in (-0.25, 0.0, 0.25) for h in (0.0, 1.0)])
    upper, ground = square + np.array([0.0, p.size]), p.size * np.array([(-1.0, 0.0), (1.0, 0.0)])
    return np.concatenate((square, upper, hatching, ground))


def links(p):
    return outlines(4, 2) + [(8 + 2 * k, 9 + 2 * k) for k in range(4)]


SCENE = Scene(
    title="Mass ratio", lesson="contact",
    cases=CASES, **ANSWER,
    runners=RUNNERS,
    start=start, run=run, observe=sole_array,
    truth=truth, truth_uncertainty=1e-15,
    slow_cases=("forces, 1,000 : 1", "overlap, 1,000 : 1", "sweeps, 1,000 : 1", "relaxed sweeps, a million : 1",
                "1,000 on 1, standing"),
    omitted_methods="at a million, sweeps without relaxation are not counted: it would take 6.9 million of them; the "
                    "engines' default settings are judged only by whether the boxes stand and whether the engine "
                    "refuses, because no law says how far a light box is squeezed out; MuJoCo's contacts have springs "
                    "of their own, so that their overlap is not compared; at 1,000 they would sink by 5 cm, and would "
                    "not settle in the time that the others need",
    quantity_names=quantity_names,
    published_states=((1.0, (107.91, 98.1), 1e-12),),
    sanity_checks=sanity_checks,
    points=points, links=links,
    uses=("rows of both contacts", "masses", "for the pile: contact points, soft contacts and memory"),
    full_loop="forces of bodies at rest: nothing moves, so there is no loop",
    ablations={"friction": "it carries nothing here; it keeps the boxes of the pile from sliding off",
               "rocking": "solvers see one contact in the middle of each joint; the pile and the engines have two"},
)
