"""How many sweeps does a stack want, how deep does a soft contact sink, and what becomes of contacts that are extreme?

Contraction factors come from runs of the lesson's sweeps, never from its formulas.
*Source:* Young 1971 for the factors; Catto 2011 for soft contacts; each case derives what it adds.
"""

import numpy as np
from scipy.optimize import minimize_scalar

from solutions.checks import BadInput, Diverged
from validate.stability.case import DOTS, EDGE, LINE, Picture, agreement, bisect, case, finding, refuses, series

G = 9.81                     # [m/s²]
THREE_DIGITS = 1e-3          # of what a sweep leaves undone, 1 − ρ [-]
ROUND_OFF = 1e-12            # of numbers around 1 after a few hundred operations
DT = 1.0 / 240.0             # of piles [s]
FLOOR = ((0.0, 1.0, 0.0),)


def column(masses):
    """(A, b, forces) of bodies on each other, the first on the ground, one contact under each, without friction.

    Contact k sees the inverse masses of both its bodies, and its neighbours through the body that they share:
    A_kk = 1/m_k + 1/m_(k−1),  A_k,k+1 = −1/m_k.  Gravity makes only the lowest approach, and k carries all above.
    """
    w = 1.0 / np.array(masses, float)
    A = np.diag(w + np.append(0.0, w[:-1])) - np.diag(w[:-1], 1) - np.diag(w[:-1], -1)
    b = np.zeros(w.size)
    b[0] = -G
    return A, b, G * np.cumsum(1.0 / w[::-1])[::-1]


def errors_of(lesson, masses, omega, sweeps):
    """Error of the forces before the first sweep and after each, over their size, from zero."""
    A, b, forces = column(masses)
    lam, errors = np.zeros(len(b)), [1.0]
    for _ in range(sweeps):
        lam = lesson.gauss_seidel_sweep(A, b, lam, omega)
        errors.append(np.linalg.norm(lam - forces) / np.linalg.norm(forces))
    return np.array(errors)


def sweeps_until(errors, small):
    """Number of sweeps after which an error is at most so small."""
    return int(np.argmax(errors <= small)) if errors[-1] <= small else np.inf


# ---------------------------------------------------------------------------------------------- contraction

@case("contraction-of-a-stack", "Why ten boxes want hundreds of sweeps", compiled=False)
def contraction_of_a_stack(lesson):
    """On n equal bodies, one on the other, a sweep leaves cos²(π/2n) of the error: sin²(π/2n) is done.

    The eigenvalues of a sweep are cos²((2j − 1)π/2n).  The second one dies out by (cos²(3π/2n)/cos²(π/2n))ᵏ, of which
    1e-4 is left in the end; what it does to 1 − ρ is 8 times its share of the first error, which is below a ninth.
    """
    found, sizes, done = [], (2, 3, 5, 10, 20, 50), []
    for n in sizes:
        second = np.cos(1.5 * np.pi / n) ** 2 / np.cos(0.5 * np.pi / n) ** 2 if n > 3 else 0.0
        sweeps = 20 if n <= 3 else int(np.ceil(np.log(1e-4) / np.log(second)))
        errors = errors_of(lesson, np.ones(n), 1.0, sweeps)
        done.append(1.0 - errors[-1] / errors[-2])
        law = np.sin(0.5 * np.pi / n) ** 2
        found.append(finding(
            claim="A sweep over n equal bodies on each other removes sin²(π/2n) of the error.",
            quantity=f"part of the error that a sweep removes, n = {n} [-]",
            predicted=law,
            measured=done[-1],
            tolerance=THREE_DIGITS * law,
            observation=f"With n = {n} a sweep leaves {1.0 - done[-1]:.5f} of the error.",
        ))
    enough = sweeps_until(errors_of(lesson, np.ones(10), 1.0, 320), 1e-3)
    theory = np.log(1e-3) / np.log(np.cos(np.pi / 20.0) ** 2)
    found.append(finding(
        claim="Ten boxes want ln 10⁻³/ln ρ sweeps to a thousandth; the slow part is nearly all of the first error.",
        quantity="sweeps until the forces are right to 10⁻³, ten boxes [-]",
        predicted=theory,
        measured=enough,
        tolerance=0.05 * theory,
        observation=f"Ten boxes need {enough:.0f} sweeps: with 25 of them they do not stand.",
    ))
    fine = np.logspace(np.log10(2.0), 2.0, 60)
    return found, Picture("What a sweep does", "log₁₀ of the number of bodies", "log₁₀ of the part removed", [
        series("theory, sin²(π/2n)", np.log10(fine), 2.0 * np.log10(np.sin(0.5 * np.pi / fine)), LINE),
        series("measured", np.log10(sizes), np.log10(done), DOTS)],
        "Twice as many boxes want four times as many sweeps: each sweep passes a force on to neighbours.")


@case("contraction-of-a-mass-ratio", "Why the heavy one sinks", compiled=False)
def contraction_of_a_mass_ratio(lesson):
    """A body r times as heavy as the one under it: a sweep leaves r/(1 + r) of the error.

    For two contacts the error after the first sweep lies along one direction, so that the ratio is exact from then on.
    What is removed, 1/(1 + r), is a small difference of errors, each rounded by 1.1e-16.
    """
    found, ratios, done = [], (0.1, 1.0, 10.0, 100.0, 1000.0, 1e4), []
    for r in ratios:
        errors = errors_of(lesson, (1.0, r), 1.0, 4)
        done.append(1.0 - errors[-1] / errors[-2])
        found.append(finding(
            claim="A sweep removes 1/(1 + r) of the error of a body r times as heavy as what carries it.",
            quantity=f"part of the error that a sweep removes, r = {r:g} [-]",
            predicted=1.0 / (1.0 + r),
            measured=done[-1],
            tolerance=THREE_DIGITS / (1.0 + r),
            observation=f"A mass ratio of {r:g} leaves {1.0 - done[-1]:.5f} of the error after a sweep.",
        ))
    fine = np.linspace(-1.0, 4.0, 51)
    return found, Picture("Heavy on light", "log₁₀ of the mass ratio", "log₁₀ of the part of the error removed", [
        series("theory, 1/(1 + r)", fine, -np.log10(1.0 + 10.0**fine), LINE),
        series("measured", np.log10(ratios), np.log10(done), DOTS)],
        "A thousand times the mass wants a thousand times the sweeps; light on heavy is no trouble.")


def sweep_radius(lesson, n, omega):
    """Largest size of an eigenvalue of a sweep over n equal bodies: what it does to single errors, where all push."""
    A, b, forces = column(np.ones(n))
    pushed = 10.0 * forces                                               # far from where the projection acts
    base = lesson.gauss_seidel_sweep(A, b, pushed, omega)
    columns = [lesson.gauss_seidel_sweep(A, b, pushed + e, omega) - base for e in np.eye(n)]
    return np.max(np.abs(np.linalg.eigvals(np.stack(columns, axis=1))))


@case("over-relaxation", "The best relaxation", compiled=False)
def over_relaxation(lesson):
    """At ω = 2/(1 + sin(π/2n)) a sweep leaves ω − 1 of the error, and no other ω does better; at ω = 2 none converges.

    All eigenvalues have the size ω − 1 from the best ω on.  There two of them are equal, so that a rounding of 1e-12
    (of forces ten times too large, up to 2,000 N) moves them by its root, 1e-6, and a few times that with 20 bodies.
    """
    found, sizes = [], (5, 10, 20)
    for n in sizes:
        omega = 2.0 / (1.0 + np.sin(0.5 * np.pi / n))
        radius = sweep_radius(lesson, n, omega)
        found.append(finding(
            claim="At the best relaxation a sweep leaves ω − 1 of the error.",
            quantity=f"contraction factor at the best ω, n = {n} [-]",
            predicted=omega - 1.0,
            measured=radius,
            tolerance=1e-5,
            observation=f"With n = {n} and ω = {omega:.4f} a sweep leaves {radius:.5f} of the error.",
        ))
        best = minimize_scalar(lambda w, n=n: sweep_radius(lesson, n, w), bounds=(1.0, 1.99), method="bounded",
                               options={"xatol": 1e-7}).x
        found.append(finding(
            claim="No relaxation does better than ω = 2/(1 + sin(π/2n)).",
            quantity=f"relaxation that converges soonest, n = {n} [-]",
            predicted=omega,
            measured=best,
            tolerance=1e-5,
            observation=f"Of all relaxations {best:.5f} converges soonest for n = {n}.",
        ))
    edge = bisect(lambda w: sweep_radius(lesson, 10, w) > 1.0, 1.0, 3.0)
    found.append(finding(
        claim="From ω = 2 on nothing converges: the product of all eigenvalues is (1 − ω)ⁿ.",
        quantity="relaxation from which a sweep does not contract, n = 10 [-]",
        predicted=2.0,
        measured=edge,
        tolerance=4.0 * EDGE,
        observation=f"Ten bodies lose their forces from ω = {edge:.6f} on.",
    ))
    omega = 2.0 / (1.0 + np.sin(0.05 * np.pi))
    plain, relaxed = errors_of(lesson, np.ones(10), 1.0, 100), errors_of(lesson, np.ones(10), omega, 60)
    sweeps = np.arange(0.0, 101.0)
    fewer, more = sweeps_until(relaxed, 1e-3), round(np.log(1e-3) / np.log(np.cos(0.05 * np.pi) ** 2))
    return found, Picture("Ten bodies: forces from zero", "sweeps", "log₁₀ of the error of the forces", [
        series("theory, ω = 1", sweeps, 2.0 * sweeps * np.log10(np.cos(0.05 * np.pi)), LINE),
        series("ω = 1", sweeps[::5], np.log10(plain[::5]), DOTS),
        series(f"ω = {omega:.3f}", sweeps[:61:3], np.log10(np.maximum(relaxed[::3], 1e-16)), DOTS)],
        f"One number makes {fewer} sweeps out of {more}: the cure that costs nothing.")


# ---------------------------------------------------------------------------------------------- piles

def pile_of(lesson, shape, x, half, masses, angles=0.0, planes=FLOOR, **more):
    """(PileState, Pile) of discs or boxes in the plane, under gravity."""
    x, half, masses = np.array(x, float), np.array(half, float), np.broadcast_to(masses, len(x)).astype(float)
    settings = {"mu": 0.5, "substeps": 4, "hertz": 240.0, "zeta": 10.0, "margin": 0.02, **more}
    inertia = masses * (0.5 * half[:, 0] ** 2 if shape == "disc" else np.sum(half**2, axis=1) / 3.0)
    q = np.broadcast_to(angles, len(x)).astype(float)
    return lesson.make_pile_2d(x, q, masses, inertia, half, np.array(planes, float), (0.0, -G), **settings)


def after(lesson, shape, state, pile, seconds, dt=DT):
    """The PileState so many seconds later."""
    bounds, contacts = lesson.disc_bounds, lesson.round_contacts
    if shape == "box":
        bounds, contacts = lesson.box_bounds_2d, lesson.box_contacts_2d
    return lesson.advance_pile_2d(bounds, contacts, state, dt, round(seconds / dt), pile)


@case("sag-of-a-soft-contact", "How deep it sinks", compiled=False)
def sag_of_a_soft_contact(lesson):
    """A soft contact under a force F comes to rest at a depth of k_n F/(2π hertz)², whatever the step.

    A disc has k_n = 1/m and F = m g; a box on both corners k_n = 1/m + (w/2)²/I = 2.5/m at each, and F = m g/2.  What
    is left of the way to it shrinks at a rate of s²/(h (1 + 2ζs + s²)), s = 2π hertz h, h the substep: 40/s and more,
    which leaves 1e-17 after a second.  The place is rounded: 1.1e-16 of half a metre, over a depth of 40 µm, and some.
    """
    found, drawn, hertzes = [], {}, np.array([30.0, 40.0, 50.0, 65.0, 80.0])
    for name, shape, times in (("a disc", "disc", 1.0), ("a box", "box", 1.25)):
        for dt, substeps in ((1.0 / 60.0, 4), (1.0 / 240.0, 1), (1.0 / 240.0, 4), (1.0 / 1000.0, 1)):
            worst = 0.0
            for hertz in (40.0, 80.0):
                state, pile = pile_of(lesson, shape, [(0.0, 0.5)], [(0.5, 0.5)], 2.0, hertz=hertz, zeta=1.0,
                                      substeps=substeps)
                sag = 0.5 - after(lesson, shape, state, pile, 1.0, dt).x[0, 1]
                worst = max(worst, abs(sag / (times * G / (2.0 * np.pi * hertz) ** 2) - 1.0))
            found.append(finding(
                claim="A soft contact sinks by k_n F/(2π hertz)², whatever the step.",
                quantity=f"relative error of the depth of {name}, 1/{1.0 / dt:.0f} s in {substeps} [-]",
                predicted=0.0,
                measured=worst,
                tolerance=2e-11,
                observation=f"1/{1.0 / dt:.0f} s in {substeps} substeps: {name} sinks as it should, to {worst:.0e}.",
            ))
        drawn[name] = []
        for hertz in hertzes:
            state, pile = pile_of(lesson, shape, [(0.0, 0.5)], [(0.5, 0.5)], 2.0, hertz=hertz, zeta=1.0, substeps=1)
            drawn[name].append(1e3 * (0.5 - after(lesson, shape, state, pile, 1.0).x[0, 1]))
    fine = np.linspace(30.0, 80.0, 51)
    law = lambda times: 1e3 * times * G / (2.0 * np.pi * fine) ** 2
    return found, Picture("How deep a soft contact sinks", "hertz [1/s]", "depth [mm]", [
        series("theory, a disc", fine, law(1.0), LINE), series("theory, a box", fine, law(1.25), LINE),
        series("a disc", hertzes, drawn["a disc"], DOTS), series("a box", hertzes, drawn["a box"], DOTS)],
        "Twice the hertz, a quarter of the depth; smaller steps alone change nothing, but they allow more hertz.")


@case("mass-ratio-of-a-million", "A million to one", compiled=False)
def mass_ratio_of_a_million(lesson):
    """A million on one: sweeps say that they have not got there, and Murty's method solves it in two pivots.

    With ρ = r/(1 + r) the lower contact lacks r g ρ^(k−1) after k sweeps and the upper one ρ times that, which leaves
    the residual g ρᵏ: 0.95 g after 50,000.  The condition of A is 4 · 10⁶, so that solving loses seven of sixteen
    digits: 1e-9.  The pile sweeps, too: it sinks, and is refused.
    """
    found, ratio = [], 1e6
    A, b, forces = column((1.0, ratio))
    error = np.max(np.abs(lesson.solve_lcp(A, b) / forces - 1.0))
    found.append(finding(
        claim="A direct method does not mind the masses.",
        quantity="relative error of the forces by Murty's method [-]",
        predicted=0.0,
        measured=error,
        tolerance=1e-9,
        observation=f"Murty's method is right to {error:.0e} at a mass ratio of a million.",
    ))
    with_tangents = np.kron(A, np.diag([1.0, 0.0])) + np.kron(np.diag(np.diag(A)), np.diag([0.0, 1.0]))
    words = refusal(lambda: lesson.solve_contacts(with_tangents, np.kron(b, [1.0, 0.0]), np.full(2, 0.5)))
    left = float(words.split(" = ")[1].split(":")[0]) if "residual" in words else 0.0
    expected = G * (ratio / (1.0 + ratio)) ** 50_000
    found.append(finding(
        claim="Sweeps that have not converged say so, with their residual.",
        quantity="residual in the refusal of the sweeps [m/s]",
        predicted=expected,
        measured=left,
        tolerance=THREE_DIGITS * expected,
        observation=f"After 50,000 sweeps the refusal names a residual of {left:.4f} m/s.",
    ))
    refused, tried = 0, ((1e6, 2, 120.0), (1e6, 16, 480.0), (1e4, 2, 120.0))
    for r, substeps, hertz in tried:
        state, pile = pile_of(lesson, "box", [(0.0, 0.5), (0.0, 1.5)], [(0.5, 0.5)] * 2, (1.0, r), substeps=substeps,
                              hertz=hertz)
        words = refusal(lambda s=state, p=pile: after(lesson, "box", s, p, 5.0))
        refused += "sink into each other; the residual" in words
    found.append(finding(
        claim="A pile whose light box cannot carry the heavy one ends in Diverged, and not in a picture.",
        quantity=f"piles that are refused [of {len(tried)}]",
        predicted=len(tried),
        measured=refused,
        tolerance=0.0,
        observation=f"{refused} of {len(tried)} piles end in Diverged with the residual of their contacts.",
    ))
    errors = errors_of(lesson, (1.0, ratio), 1.0, 200)
    sweeps = np.arange(201.0)
    return found, Picture("A million on one", "sweeps", "error of the forces, over their size [-]", [
        series("theory", sweeps, (ratio / (1.0 + ratio)) ** sweeps, LINE),
        series("sweeps", sweeps[::20], errors[::20], DOTS),
        series("Murty, at once", [0.0, 200.0], [error, error], LINE)],
        "Two hundred sweeps change nothing that one could see; two pivots do.")


def refusal(run):
    """The words of Diverged or BadInput, in which a run must end; none if it ends without."""
    try:
        run()
    except (Diverged, BadInput) as e:
        return str(e)
    return ""


# ---------------------------------------------------------------------------------------------- extremes

def slope(degrees):
    """A plane through the origin, rising to the right."""
    return (-np.sin(np.radians(degrees)), np.cos(np.radians(degrees)), 0.0)


INSIDE = (                   # shape, centres [m] of bodies with half sizes of ½ m, what they are
    ("disc", [(0.0, 0.5), (0.0, 0.5)], "coincident discs"), ("box", [(0.0, 0.5), (0.0, 0.5)], "coincident boxes"),
    ("disc", [(0.0, 0.2), (0.1, 0.3)], "discs deep in each other"), ("box", [(0.0, -2.0)], "a box deep in the floor"),
    ("box", [(0.0, 0.5), (0.05, 0.6)], "boxes deep in each other"),
)


def parted(lesson, shape, x):
    """(greatest height of a centre [m], overlap left in the end [m]) of bodies that begin inside each other, in 2 s."""
    state, pile = pile_of(lesson, shape, x, [(0.5, 0.5)] * len(x), 1.0)
    highest = -np.inf
    for _ in range(120):
        state = after(lesson, shape, state, pile, 1.0 / 60.0)
        highest = np.maximum(highest, np.max(state.x[:len(x), 1]))
    return highest, max(0.0, -np.min(state.contacts.gap, initial=0.0))


def sliding(lesson, degrees, mu):
    """Speed [m/s] after a second of a box that was put on a slope, and what it has turned [rad]."""
    theta = np.radians(degrees)
    place = 0.5 * np.array(slope(degrees)[:2])
    state, pile = pile_of(lesson, "box", [place], [(0.5, 0.5)], 1.0, theta, [slope(degrees)], mu=mu)
    end = after(lesson, "box", state, pile, 1.0)
    return np.linalg.norm(end.v[0]), end.q[0] - theta


def wedge(lesson, degrees):
    """Forces over the weight, (2,), of a disc between two walls without friction."""
    walls = [slope(degrees), slope(-degrees)]
    height = 0.5 / np.cos(np.radians(degrees))
    state, pile = pile_of(lesson, "disc", [(0.0, height)], [(0.5, 0.5)], 1.0, 0.0, walls, mu=0.0)
    end = after(lesson, "disc", state, pile, 3.0)
    return np.linalg.norm(end.J, axis=1) * pile.substeps / DT / G


def carried(lesson, n, dt, **more):
    """Forces over the weight of one, (n,), under each box of a stack after 3 s."""
    x = np.stack((np.zeros(n), np.arange(n) + 0.5), axis=1)
    state, pile = pile_of(lesson, "box", x, [(0.5, 0.5)] * n, 1.0, **more)
    end = after(lesson, "box", state, pile, 3.0, dt)
    forces = np.zeros(n)
    for a, b, J in zip(end.contacts.a, end.contacts.b, end.J):
        forces[0 if b >= n else max(a, b)] += abs(J[1]) * pile.substeps / dt / G
    return forces


@case("extremes", "What should not be, and what must not happen then", compiled=False)
def extremes(lesson):
    """Deep overlaps part gently, friction 0 and ∞ keeps its law, a wedge of 89° carries 28 weights, 1 : 100 stands.

    A contact asks bodies to part with 3 m/s at most.  Thrown up with that, one would rise by 0.46 m.  The second sweep,
    at rest, takes the speed back within a substep: a tenth of it is allowed to bodies that come apart while pushed.
    On a slope the contacts of a box are there from the first step: its speed is g sin θ t, or 0 with μ = ∞.
    In a wedge sweeps contract by cos² 2θ, slowest at 89°: there 6e-9 of the force was left after 3 s; 1e-7 is allowed.
    A small disc beside a large one sags by g/(2π hertz)² = 4.3 µm, and nothing else happens to it.
    A stack of five sways a little in steps of 1/30 s: 3e-4 weights were measured, and ten times that is allowed.
    """
    found, left = [], 0.0
    for shape, x, name in INSIDE:
        highest, overlap = parted(lesson, shape, x)
        left = np.maximum(left, overlap)
        found.append(finding(
            claim="What begins inside something else comes out, and is not thrown out.",
            quantity=f"height of {name} above the place on top, at most [m]",
            predicted=0.0,
            measured=max(0.0, highest - len(x) + 0.5),
            tolerance=0.046,
            observation=f"With {name} nothing rises above {highest:.3f} m; {1e3 * overlap:.2f} mm overlap at last.",
        ))
    found.append(finding(
        claim="After two seconds they overlap by no more than contacts sag.",
        quantity="largest overlap that is left [m]",
        predicted=0.0,
        measured=left,
        tolerance=1e-4,
        observation=f"After two seconds {1e3 * left:.3f} mm of overlap are left.",
    ))
    for degrees, mu in ((5.0, 0.0), (40.0, 0.0), (80.0, 0.0), (5.0, np.inf), (40.0, np.inf)):
        speed, turned = sliding(lesson, degrees, mu)
        found.append(finding(
            claim="Without friction a box slides with g sin θ t; with infinite friction it stays where it is.",
            quantity=f"speed after 1 s on a slope of {degrees:g}°, μ = {mu:g} [m/s]",
            predicted=0.0 if mu else G * np.sin(np.radians(degrees)),
            measured=speed,
            tolerance=1e-10,
            observation=f"On {degrees:g}° with μ = {mu:g} its speed is {speed:.4g} m/s; it turns by {turned:.0e} rad.",
        ))
    angles = (45.0, 80.0, 89.0)
    forces = [wedge(lesson, degrees) for degrees in angles]
    for degrees, force in zip(angles, forces):
        law = 0.5 / np.cos(np.radians(degrees))
        found.append(finding(
            claim="In a wedge of slope θ each wall carries 1/(2 cos θ) weights.",
            quantity=f"force over the weight of a disc at {degrees:g}° [-]",
            predicted=law,
            measured=force[np.argmax(np.abs(force - law))] if force.size == 2 else np.nan,
            tolerance=1e-7 * law,
            observation=f"At {degrees:g}° the walls carry {' and '.join(f'{f:.4f}' for f in force)} weights.",
        ))
    beside = [(0.0, 1.0)] + [(1.5 + 0.05 * k, 0.01) for k in range(5)]
    sizes = [(1.0, 1.0)] + [(0.01, 0.01)] * 5
    state, pile = pile_of(lesson, "disc", beside, sizes, [1e4] + [1.0] * 5, margin=0.002)
    end = after(lesson, "disc", state, pile, 1.0)
    found.append(finding(
        claim="Discs of 1 cm beside one of 1 m, 10,000 times as heavy, sag like any other.",
        quantity="largest way of a disc in 1 s, sizes 1 : 100 [m]",
        predicted=G / (480.0 * np.pi) ** 2,
        measured=np.max(np.abs(end.x[:6] - state.x[:6])),
        tolerance=1e-12,
        observation=f"They move by {1e6 * np.max(np.abs(end.x[:6] - state.x[:6])):.3f} µm.",
    ))
    error = np.max(np.abs(carried(lesson, 5, 1.0 / 30.0, substeps=8, hertz=80.0) - np.arange(5.0, 0.0, -1.0)))
    found.append(finding(
        claim="Steps of 1/30 s hold a stack, if they have substeps.",
        quantity="largest error of the forces in a stack of five, over a weight [-]",
        predicted=0.0,
        measured=error,
        tolerance=3e-3,
        observation=f"With 1/30 s in 8 substeps the forces of five boxes are right to {error:.0e} of a weight.",
    ))
    found.append(refusals(lesson))
    fine = np.linspace(0.0, 89.0, 90)
    return found, Picture("A disc between two walls", "slope of the walls [°]", "force over the weight [-]", [
        series("theory, 1/(2 cos θ)", fine, 0.5 / np.cos(np.radians(fine)), LINE),
        series("measured", angles, [np.mean(force) for force in forces], DOTS)],
        "Walls that are nearly upright carry many weights: a contact solver must find forces that no load has.")


def refusals(lesson):
    """The Finding on what is no contact and no pile."""
    at, half, still = [(0.0, 0.5)], [(0.5, 0.5)], np.zeros(2)
    pile = lambda **more: pile_of(lesson, "disc", **{"x": at, "half": half, "masses": 1.0, **more})
    move = lambda dt, **more: after(lesson, "disc", *pile(**more), 1.0, dt)
    touch = lambda n, inv_mass: lesson.make_contacts([0], [1], [(0.0, 0.0)], [n], inv_mass)
    asked = (
        (lambda: pile(half=[(-0.5, 0.5)]), "-0.5"), (lambda: pile(half=[(0.0, 0.5)]), "0.0"),
        (lambda: pile(masses=0.0), "0.0"), (lambda: pile(planes=[(0.0, 0.0, 1.0)]), "0.0"),
        (lambda: pile(x=[(np.nan, 0.5)]), "nan"),
        (lambda: pile(substeps=0), "0"), (lambda: pile(mu=-0.5), "-0.5"), (lambda: pile(hertz=-1.0), "-1.0"),
        (lambda: move(DT, hertz=1000.0), "1.04166"), (lambda: move(1.0, hertz=80.0), "20.0"),
        (lambda: touch((0.0, 1.0), still), "0.0"), (lambda: touch((0.0, 2.0), np.ones(2)), "2.0"),
        (lambda: touch((0.0, 0.0), np.ones(2)), "0.0"), (lambda: lesson.solve_lcp(np.ones((2, 2)), -np.ones(2)), "0.0"),
    )
    refused = sum(refuses(function, (), value) for function, value in asked)
    return finding(
        claim="Sizes and masses of none, planes without a normal, hertz that no substep carries and contacts of two "
              "immovable bodies are refused, with their value.",
        quantity=f"calls that name the value in their error [of {len(asked)}]",
        predicted=len(asked),
        measured=refused,
        tolerance=0.0,
        observation=f"{refused} of {len(asked)} such calls end in a sentence that names the value.",
    )


def relaxed_radius(A, omega):
    """Return the spectral radius of a sweep with over-relaxation: (D + ω L)⁻¹ ((1 − ω) D − ω U)."""
    D, L, U = np.diag(np.diag(A)), np.tril(A, -1), np.triu(A, 1)
    return np.max(np.abs(np.linalg.eigvals(np.linalg.solve(D + omega * L, (1.0 - omega) * D - omega * U))))


@case("closed-forms", "Contraction factors, the best relaxation, the disc of friction", compiled=False)
def closed_forms(lesson):
    """Spectral radii from the matrices of the sweep, the best ω by a search over ω, the disc by its variational law.

    At the best ω two eigenvalues meet, so the radius there is known to the root of round-off only, 1e-8.
    P is the point of the disc nearest to J if no q of the disc has (J − P) · (q − P) > 0.
    """
    stacks = {n: column(np.ones(n))[0] for n in (2, 3, 5, 10, 20)}
    radius = max(abs(lesson.stack_contraction(n) - relaxed_radius(A, 1.0)) for n, A in stacks.items())
    ratios = (0.1, 1.0, 10.0, 1000.0)
    heavy = max(abs(lesson.mass_ratio_contraction(r) - relaxed_radius(column((1.0, r))[0], 1.0)) for r in ratios)
    best, left = 0.0, 0.0
    for n, A in stacks.items():
        omega, rho = lesson.best_relaxation(np.cos(0.5 * np.pi / n) ** 2)
        trial = np.linspace(1.0, 1.999, 800)
        at_least = min(relaxed_radius(A, w) for w in trial)
        best = max(best, relaxed_radius(A, omega) - at_least)
        left = max(left, abs(relaxed_radius(A, omega) - rho))
    rng, off = np.random.default_rng(99), 0.0
    for _ in range(100):
        J, limit = rng.normal(size=3), rng.uniform(0.1, 2.0)
        P = np.array(lesson.friction_disc(tuple(J), limit))
        q = rng.normal(size=(50, 3))
        q *= (limit * rng.uniform(0.0, 1.0, 50) / np.linalg.norm(q, axis=1))[:, None]
        q = np.concatenate((q, [limit * J / np.linalg.norm(J)]))
        off = max(off, np.linalg.norm(P) - limit, np.max((q - P) @ (J - P)),
                  np.linalg.norm(P - J) if np.linalg.norm(J) <= limit else 0.0)
    return [
        agreement("The contraction of a stack is the spectral radius of a sweep.",
                  "contraction of a stack: largest error [-]", radius, 1e-12),
        agreement("The contraction of a mass ratio is the spectral radius of a sweep.",
                  "contraction of a mass ratio: largest error [-]", heavy, 1e-12),
        agreement("No relaxation does better than 2/(1 + √(1 − ρ)).", "radius beyond the best of a search [-]", best,
                  1e-7),
        agreement("With it a sweep leaves ω − 1.", "radius at the best relaxation: largest error [-]", left, 1e-7),
        agreement("Friction is the point of the disc nearest to the impulse that would stick.",
                  "largest violation of the law of the nearest point [N² s²]", max(off, 0.0), 1e-12)], None
