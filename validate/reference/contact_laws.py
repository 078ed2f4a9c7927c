"""Laws of contact that hold for every solver, for what an engine itself reports of a step.

An engine reports velocities, places of contacts and impulses.  Balances of momentum, of angular momentum and of energy,
non-adhesion and Coulomb's cone must hold up to round-off, however few iterations a solver makes.  Unfinished iterations
leave a residual, which is a velocity.  It is given over g dt, the speed that a fall gains in a step: a residual of 0.01
means that a contact carries as if gravity were wrong by 1 %.
"""

from typing import NamedTuple

import numpy as np

from ..check import Allowed
from . import laws
from .contact import in_space, inverse_masses_at, natural_parts, relative_motion, turning
from .laws import Law

EPS = 2.3e-16                # spacing of floats around 1, rounded up [-]
ROUNDINGS = 8.0              # of a velocity or an impulse in one visit of a contact: four products and their sums [-]
CLAMPED = 1000.0 * EPS       # of impulses that a solver clamps [-]: reported axes are orthogonal up to some roundings
# the power that early ends of iterations leave, over impulses and g dt [-]: it was measured as 0.048 at most on the
# engines of lesson 9 (1,000 boxes in pymunk); impulses that are 10 % too large give 0.1
GAINED = 0.06
# friction short of Coulomb's limit where contacts slide, over the largest impulse, that early ends of iterations leave:
# it was measured as 0.0063 at most on the engines of lesson 10; friction that is 10 % too small gives 0.02 or more
UNREACHED = 0.01
# mean restitution that early ends of iterations leave: it was measured as 0.013 at most on the engines of lesson 10; a
# restitution of 0.1 gives 0.04 or more, because a step that ends an approach has a gap left
BOUNCED = 0.02
FINISHED = 1e-2              # residual of a solver that has finished, over g dt [-]: forces are then right to 1 %
SLIDES = 2.0                 # times friction at its limit that does not stop a contact which slides [-]
PRESSED = 1e-9               # normal impulse over the largest one, below which nothing presses [-]


class Physics(NamedTuple):
    """What a scene says of its bodies.  An engine is judged by this, however it was set up."""
    gravity: np.ndarray      # (d,) [m/s²]
    inv_mass: np.ndarray     # (n,) [1/kg]; 0: a support, which moves as it likes
    inv_inertia: np.ndarray  # (n,), or (n, 3) about the principal axes [1/(kg m²)]
    mu: float | np.ndarray   # friction of all pairs, or of each: (n + 1, n + 1), the last row is what never moves [-]


class Motion(NamedTuple):
    """Bodies at one moment."""
    x: np.ndarray            # (n, d) [m]
    v: np.ndarray            # (n, d) [m/s]
    omega: np.ndarray        # (n,) or (n, 3) [rad/s]


class Touching(NamedTuple):
    """Contacts of a step, and the impulses that an engine reports of them.  Body n is everything that never moves."""
    a: np.ndarray            # (c,)
    b: np.ndarray            # (c,)
    n: np.ndarray            # (c, d) from b to a
    p_a: np.ndarray          # (c, d) where the impulse acts on a [m]
    p_b: np.ndarray          # (c, d) where it acts on b [m]
    gap: np.ndarray          # (c,) below zero where they overlap [m]
    J: np.ndarray            # (c, d) on a [N s]
    mu: np.ndarray           # (c,) [-]
    ghosts: np.ndarray       # (c, d) the part of J that it counts as applied and has not applied [N s]
    axes: np.ndarray | None = None   # (c, 2, d) of a pyramid of friction; None: Coulomb's cone


class Step(NamedTuple):
    """One step of an engine, as it reports it."""
    dt: float
    gravity: np.ndarray      # (d,) [m/s²]
    inv_mass: np.ndarray     # (n,) [1/kg]
    inv_inertia: np.ndarray  # (n,) or (n, 3, 3), in the world before the step
    before: Motion
    after: Motion
    centres: np.ndarray      # (n, d) of the bodies when it found the contacts [m]
    overlap: float           # the deepest one that its last correction of positions has seen [m]
    touching: Touching
    pushed: np.ndarray | None = None     # (n, d) impulses of springs and air, through the centres [N s]; None: of none

    def in_space(self):
        """Return the same step in space, with a last row for everything that never moves."""
        inverse = turning(self.before.omega, self.inv_inertia)[1]
        moments = [grounded(Motion(in_space(one.x), in_space(one.v), turning(one.omega, self.inv_inertia)[0]))
                   for one in (self.before, self.after)]
        t = self.touching
        vectors = {name: in_space(getattr(t, name)) for name in ("n", "p_a", "p_b", "J", "ghosts")}
        pushed = np.zeros_like(self.centres) if self.pushed is None else self.pushed
        return Step(self.dt, in_space([self.gravity])[0], np.append(self.inv_mass, 0.0), still_below(inverse), *moments,
                    still_below(in_space(self.centres)), self.overlap, t._replace(**vectors),
                    still_below(in_space(pushed)))

    @property
    def moves(self):
        """Return which bodies (n, 1) impulses can move, as 1 and 0: a support moves as it likes."""
        return 1.0 * (self.inv_mass[:, None] > 0.0)


def still_below(rows):
    """Return the rows of the bodies that move, and one of zeros for everything else."""
    return np.concatenate((rows, np.zeros((1, *rows.shape[1:]))))


def grounded(motion):
    """Return a Motion with such a last row."""
    return Motion(*(still_below(rows) for rows in motion))


# ---------------------------------------------------------------------------------------------- balances

def scales(step):
    """Return (g dt [m/s], radii of gyration (n + 1,) [m], the fastest speed of a point [m/s])."""
    fall = step.dt * float(np.linalg.norm(step.gravity))
    around = np.trace(step.inv_inertia, axis1=1, axis2=2)
    gyration = np.sqrt(step.inv_mass / np.where(around > 0.0, around, np.inf))
    speeds = [rows for one in (step.before, step.after) for rows in (one.v, gyration[:, None] * one.omega)]
    return fall, gyration, max(fall, *(float(np.max(np.abs(rows))) for rows in speeds))


def rounding(step, iterations):
    """Return the largest error of a balance that rounding leaves, over g dt [-].

    Each iteration rounds the velocities of a body once per contact, while the reported impulse is rounded on its own.
    So both sides drift apart by  ROUNDINGS · iterations · contacts of a body  spacings of the fastest speed.
    """
    fall, _, fastest = scales(step)
    t = step.touching
    contacts = np.bincount(np.concatenate((t.a, t.b)), minlength=len(step.inv_mass))
    crowd = int(np.max(contacts[step.inv_mass > 0.0], initial=1))
    return ROUNDINGS * iterations * crowd * EPS * fastest / fall


def totals(step, J):
    """Return (impulse, angular impulse about its centre), each (n + 1, 3), of each body."""
    t, (impulse, torque) = step.touching, np.zeros((2, *step.centres.shape))
    for body, sign, place in ((t.a, 1.0, t.p_a), (t.b, -1.0, t.p_b)):
        np.add.at(impulse, body, sign * J)
        np.add.at(torque, body, sign * np.cross(place - step.centres[body], J))
    return impulse, torque


def jumps(step, J):
    """Return (Δv, Δω) (n + 1, 3) that impulses J cause: of the last row, which never moves, they are zero."""
    impulse, torque = totals(step, J)
    return step.inv_mass[:, None] * impulse, np.einsum("nij,nj->ni", step.inv_inertia, torque)


def unexplained(step):
    """Return what the applied impulses leave of the change of velocities, (Δv, Δω), and the rate of gyration [rad/s].

    A free body in space changes ω by −I⁻¹ (ω × I ω) dt; that is the rate of gyration.
    """
    omega, moves = step.before.omega, step.moves
    turns = np.linalg.matrix_rank(step.inv_inertia, hermitian=True) == 3
    L = np.einsum("nij,nj->ni", np.linalg.pinv(step.inv_inertia, hermitian=True), omega)
    spin = step.dt * turns[:, None] * np.einsum("nij,nj->ni", step.inv_inertia, np.cross(omega, L))
    dv, domega = jumps(step, step.touching.J - step.touching.ghosts)
    dv = dv + step.inv_mass[:, None] * step.pushed
    return (moves * (step.after.v - step.before.v - step.dt * step.gravity) - dv,
            moves * (step.after.omega - omega) + spin - domega, spin)


def balances(step):
    """Return {quantity: value} of the balances, and the rates of gyration (n + 1, 3)."""
    fall, gyration, _ = scales(step)
    dv, domega, spin = unexplained(step)
    second_order = step.dt * np.linalg.norm(step.before.omega, axis=1) * np.linalg.norm(spin, axis=1)
    off = np.maximum(0.0, np.linalg.norm(domega, axis=1) - 2.0 * second_order)
    lost = np.linalg.norm(jumps(step, step.touching.ghosts)[0], axis=1)
    return {"momentum": float(np.max(np.linalg.norm(dv, axis=1))) / fall,
            "angular momentum": float(np.max(gyration * off)) / fall, "unapplied": float(np.max(lost)) / fall}, spin


def energy(step, spin):
    """Return the change of the kinetic energy that neither gravity nor applied impulses explain, over its terms [-].

    Impulses between two velocities do the work J · (u + u')/2, exactly.  Of a support, which does work on others, the
    velocities do not count.  Gyration does no work, but a step of it does some: up to |I ω| times
    the change of ω by gyration is left out, with the mean ω of the step.
    """
    moves = step.moves[:-1]
    m = moves / np.where(moves > 0.0, step.inv_mass[:-1, None], 1.0)
    inertia = np.linalg.pinv(step.inv_inertia[:-1], hermitian=True)
    turned = lambda omega: np.einsum("ni,nij,nj->n", omega, inertia, omega)
    mean = 0.5 * (step.before.omega + step.after.omega)[:-1]
    gyration = float(np.sum(np.linalg.norm(np.einsum("nij,nj->ni", inertia, mean), axis=1)
                            * np.linalg.norm(spin[:-1], axis=1)))
    v, v_new, omega, omega_new = (moves * rows[:-1] for one in zip(step.before[1:], step.after[1:]) for rows in one)
    change = 0.5 * (np.sum(m * (v_new**2 - v**2)) + np.sum(turned(omega_new) - turned(omega)))
    by_gravity = 0.5 * step.dt * np.sum(m * step.gravity * (v + v_new))
    twice = sum(motion(step, one._replace(v=step.moves * one.v, omega=step.moves * one.omega))
                for one in (step.before, step.after))
    by_contacts = 0.5 * np.sum((step.touching.J - step.touching.ghosts) * twice)
    by_pushes = 0.5 * np.sum(step.pushed[:-1] * (v + v_new))
    largest = max(abs(change), abs(by_gravity), abs(by_contacts), abs(by_pushes),
                  float(np.sum(m[:, 0] * np.linalg.norm(step.dt * step.gravity) * np.linalg.norm(v + v_new, axis=1))),
                  float(np.sum(m)) * float(np.linalg.norm(step.dt * step.gravity)) ** 2)
    return max(0.0, float(abs(change - by_gravity - by_contacts - by_pushes)) - gyration) / largest


def motion(step, one):
    """Return u (c, 3) of the contacts at one moment."""
    t = step.touching
    return relative_motion((step.centres, one.v, one.omega), t.a, t.b, t.p_a, t.p_b)


def carrying_nothing(step):
    """Return the residual of contacts that carry nothing in a step, over g dt [-]: no iteration can be worse.

    Then a contact moves with its speed before the step, and a fall adds g dt.
    """
    speeds = np.linalg.norm(motion(step, step.before), axis=1)
    return 1.0 + float(np.max(speeds, initial=0.0)) / scales(step)[0]


def shift(step):
    """Return the largest |x' − x − v dt| over what removing overlaps can explain.

    Bodies in a row of n each move aside by the overlaps below them: n times the deepest one.  Engines move either with
    the velocity before a step or with the one after it.
    """
    way = step.after.x - step.before.x
    away = min(float(np.max(np.linalg.norm(way - step.dt * v, axis=1))) for v in (step.before.v, step.after.v))
    deepest = max(step.overlap, float(np.max(-step.touching.gap, initial=0.0)))
    return away / ((len(way) - 1) * deepest + 100.0 * EPS * float(np.max(np.abs(step.after.x))))


# ---------------------------------------------------------------------------------------------- laws of each contact

def laws_of_contacts(step, allowed):
    """Return {quantity: value} of the laws of Signorini and Coulomb for the reported impulses.

    A contact may open by what recovers its overlap in this step, and close by what is left of the slop.  No scene that
    these laws judge has restitution: after a push a contact is closed at the end of the step.
    """
    t, fall = step.touching, scales(step)[0]
    u, gap = motion(step, step.after), t.gap + allowed.slop
    opening = np.clip(np.sum(t.n * u, axis=1), 0.0, allowed.recovers * np.maximum(-gap, 0.0) / step.dt)
    u = u - opening[:, None] * t.n
    inverse, contacts = (step.inv_mass, step.inv_inertia), (t.a, t.b, t.n, t.p_a, t.p_b)
    normal, slip = natural_parts(inverse, step.centres, u, contacts, gap, t.J, t.mu, step.dt, t.axes)
    J_n = np.sum(t.n * t.J, axis=1)
    J_t, most = t.J - J_n[:, None] * t.n, float(np.max(np.abs(t.J), initial=0.0)) or 1.0
    size = (np.linalg.norm(J_t, axis=1) if t.axes is None else
            np.max(np.abs(np.einsum("cad,cd->ca", t.axes, J_t)), axis=1, initial=0.0))
    limit = t.mu * np.maximum(J_n, 0.0)
    closing = np.maximum(0.0, -np.sum(t.n * motion(step, step.before), axis=1))
    parting = np.sum(t.n * u, axis=1) + np.maximum(gap, 0.0) / step.dt
    beyond, pressed = np.maximum(0.0, size - limit) / most, J_n > PRESSED * most
    short = short_of_limit(t, u, J_t, limit, inverse_masses_at(inverse, step.centres, contacts)[1])
    largest = lambda rows: float(np.max(rows, initial=0.0))
    return {"pull": largest(-J_n - tilted(t)) / most, "cone": largest(beyond[pressed]),
            "loose": largest(beyond[~pressed]), "short": largest(short[pressed]) / most,
            "bounce": max(0.0, float(np.sum(J_n * parting))) / (float(np.sum(np.abs(J_n) * (fall + closing))) or 1.0),
            "gain": max(0.0, float(np.sum(t.J * u))) / (float(np.sum(np.abs(J_n))) * fall or 1.0),
            "normal": largest(normal) / fall, "slip": largest(slip[pressed]) / fall}


def tilted(t):
    """Return how much (c,) [N s] of the friction is along the normal.

    An engine that takes an axis of friction from a slow motion does not find it quite across the normal.
    """
    if t.axes is None:
        return 0.0
    along, J = (np.abs(np.einsum("cad,cd->ca", t.axes, rows)) for rows in (t.n, t.J))
    return np.sum(along * J, axis=1)


def short_of_limit(t, u, J_t, limit, k_t):
    """Return by how much (c,) [N s] the friction of a contact that slides is less than its limit; zero of all others.

    A contact slides, however little its solver has finished, where SLIDES times its friction at the limit could not
    stop it.  In a pyramid each axis has its own limit.
    """
    u_t = u - np.sum(t.n * u, axis=1)[:, None] * t.n
    if t.axes is None:
        speed, size = (np.linalg.norm(rows, axis=1)[:, None] for rows in (u_t, J_t))
    else:
        speed, size = (np.abs(np.einsum("cad,cd->ca", t.axes, rows)) for rows in (u_t, J_t))
    slides = speed > SLIDES * (k_t * limit)[:, None]
    return np.max(np.where(slides, limit[:, None] - size, 0.0), axis=1, initial=0.0)


QUANTITIES = {               # as a page shows them, in the order in which they are judged
    "momentum": "balance of momentum, over g dt [-]",
    "angular momentum": "balance of angular momentum, over g dt [-]",
    "unapplied": "impulses reported and not applied, over g dt [-]",
    "energy": "balance of energy, over its largest term [-]",
    "shift": "motion that velocities do not explain, over the overlaps [-]",
    "pull": "impulse that pulls, over the largest impulse [-]",
    "cone": "friction beyond Coulomb's limit, over the largest impulse [-]",
    "loose": "friction without a normal impulse, over the largest impulse [-]",
    "short": "friction of a contact that slides, short of Coulomb's limit, over the largest impulse [-]",
    "bounce": "speed at which pushed contacts part, over their approach and g dt [-]",
    "gain": "power from contacts at the end of a step, over impulses and g dt [-]",
    "normal": "residual of Signorini's law, over g dt [-]",
    "slip": "residual of Coulomb's law, over g dt [-]",
    "rest": "residual of both at the end, where bodies rest, over g dt [-]",
}
# beside the limits of the laws themselves
MEASURED = {QUANTITIES[name]: f"at most {most:g} where a rule of the engine breaks it, from runs in lesson {lesson}"
            for name, lesson, most in (("gain", 9, GAINED), ("short", 10, UNREACHED), ("bounce", 10, BOUNCED))}
MEETING = "short", "bounce"              # judged where bodies meet; their limits were measured on such runs alone
ITERATED = "normal", "slip"              # what iterations that end early leave while bodies move


def values(step, allowed):
    """Return {quantity: value} of one step, the rounding of its balances, and the residual of carrying nothing."""
    step = step.in_space()
    found, spin = balances(step)
    found |= laws_of_contacts(step, allowed)
    found |= {"energy": energy(step, spin), "shift": shift(step)}
    return found, rounding(step, allowed.iterations), carrying_nothing(step)


def judged(steps, allowed: Allowed):
    """Return the Laws of some steps: the largest value of each quantity, and its limit.

    Where bodies rest at the end (`allowed.rests`), the last step has a law of its own; where they do not, sliding and
    parting have.

    The residual of iterations that end early is bounded by a step in which contacts carry nothing.  Friction without a
    normal impulse is at most the largest impulse.  Impulses that are not applied have no bound, but the balances must
    hold to round-off without them.  What soft contacts leave has no bound either; balances and Coulomb's limit hold.
    """
    found, roundings, nothing = zip(*(values(step, allowed) for step in steps))
    rules, early = dict(allowed.rules), dict.fromkeys((*ITERATED, "rest"), max(nothing))
    known = {} if allowed.soft else {"loose": 1.0, "gain": GAINED, "short": UNREACHED, "bounce": BOUNCED, **early}
    within = {**dict.fromkeys(QUANTITIES, max(roundings)), "shift": 1.0,
              **dict.fromkeys(("pull", "cone", "loose", "short"), CLAMPED),
              **dict.fromkeys(("bounce", "gain", *ITERATED, "rest"), FINISHED)}
    found[-1]["rest"] = max(found[-1][name] for name in ITERATED)
    left_out = MEETING if allowed.rests else ("rest",)
    largest = {name: float(np.max([one.get(name, 0.0) for one in found])) for name in QUANTITIES
               if name not in left_out}
    return [Law(QUANTITIES[name], value, within[name], known.get(name) if name in rules else None,
                rules.get(name, "")) for name, value in largest.items()]


def verdict_on(found):
    """Return (Verdict, message) by these Laws."""
    left = max(law.found for law in found if law.quantity in [QUANTITIES[name] for name in ITERATED])
    return laws.verdict_on(found, "contact", f"keeps all laws of contact; its iterations leave {left:.2g} of g dt")
