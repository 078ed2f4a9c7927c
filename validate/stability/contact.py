"""How many sweeps does a stack want, how deep does a soft contact sink, and what becomes of contacts that are extreme?

Contraction factors come from runs of the lesson's sweeps, never from its formulas.
*Source:* Young 1971 for the factors; Catto 2011 for soft contacts; each case derives what it adds.
"""

import numpy as np
from scipy.optimize import minimize_scalar

from solutions.checks import BadInput, Diverged
from solutions.impulses import cross_2d
from validate.engines.contact import DT as ENGINE_DT
from validate.engines.contact import KINDS, MU, BulletPile, PymunkPile, fallen
from validate.reference.contact import enumerated, natural_residual
from validate.stability.case import DOTS, EDGE, LINE, Picture, Worst, agreement, bisect, case, finding, refuses, series

from ..products import PYBULLET

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

@case("contraction-of-a-stack", "Why ten boxes need hundreds of sweeps", compiled=False)
def contraction_of_a_stack(lesson, check):
    """On n equal bodies, one on the other, a sweep leaves cos²(π/2n) of the error: sin²(π/2n) is done.

    The eigenvalues of a sweep are cos²((2j − 1)π/2n).  The second one dies out by (cos²(3π/2n)/cos²(π/2n))ᵏ, of which
    1e-4 is left in the end; what it does to 1 − ρ is 8 times its share of the first error, which is below a ninth.
    """
    sizes, done = (2, 3, 5, 10, 20, 50, 100), []
    for n in sizes:
        second = np.cos(1.5 * np.pi / n) ** 2 / np.cos(0.5 * np.pi / n) ** 2 if n > 3 else 0.0
        sweeps = 20 if n <= 3 else int(np.ceil(np.log(1e-4) / np.log(second)))
        errors = errors_of(lesson, np.ones(n), 1.0, sweeps)
        done.append(1.0 - errors[-1] / errors[-2])
        law = np.sin(0.5 * np.pi / n) ** 2
        check("A sweep over n equal bodies on each other removes sin²(π/2n) of the error.",
              f"part of the error that a sweep removes, n = {n} [-]",
              law=law, found=done[-1], within=THREE_DIGITS * law,
              saw=f"With n = {n} a sweep leaves {1.0 - done[-1]:.5f} of the error.")
    enough = sweeps_until(errors_of(lesson, np.ones(10), 1.0, 320), 1e-3)
    theory = np.log(1e-3) / np.log(np.cos(np.pi / 20.0) ** 2)
    check("Ten boxes need ln 10⁻³/ln ρ sweeps to a thousandth; the slow part is nearly all of the first error.",
          "sweeps until the forces are right to 10⁻³, ten boxes [-]", law=theory, found=enough, within=0.05 * theory,
          saw=f"Ten boxes need {enough:.0f} sweeps: with 25 of them they do not stand.")
    fine = np.logspace(np.log10(2.0), 2.0, 60)
    return Picture("What a sweep does", "log₁₀ of the number of bodies", "log₁₀ of the part removed", [
        series("theory, sin²(π/2n)", np.log10(fine), 2.0 * np.log10(np.sin(0.5 * np.pi / fine)), LINE),
        series("measured", np.log10(sizes), np.log10(done), DOTS)],
        "Twice as many boxes need four times as many sweeps: each sweep passes a force on to neighbours.")


@case("contraction-of-a-mass-ratio", "Why the heavy one sinks", compiled=False)
def contraction_of_a_mass_ratio(lesson, check):
    """A body r times as heavy as the one under it: a sweep leaves r/(1 + r) of the error.

    For two contacts the error after the first sweep lies along one direction, so that the ratio is exact from then on.
    What is removed, 1/(1 + r), is a small difference of errors, each rounded by 1.1e-16.
    """
    ratios, done = (0.1, 1.0, 10.0, 100.0, 1000.0, 1e4), []
    for r in ratios:
        errors = errors_of(lesson, (1.0, r), 1.0, 4)
        done.append(1.0 - errors[-1] / errors[-2])
        check("A sweep removes 1/(1 + r) of the error of a body r times as heavy as what carries it.",
              f"part of the error that a sweep removes, r = {r:g} [-]",
              law=1.0 / (1.0 + r), found=done[-1], within=THREE_DIGITS / (1.0 + r),
              saw=f"A mass ratio of {r:g} leaves {1.0 - done[-1]:.5f} of the error after a sweep.")
    fine = np.linspace(-1.0, 4.0, 51)
    return Picture("Heavy on light", "log₁₀ of the mass ratio", "log₁₀ of the part of the error removed", [
        series("theory, 1/(1 + r)", fine, -np.log10(1.0 + 10.0**fine), LINE),
        series("measured", np.log10(ratios), np.log10(done), DOTS)],
        "A thousand times the mass needs a thousand times the sweeps; light on heavy is no trouble.")


# ---------------------------------------------------------------------------------------------- sweeps that stop early

FRAME = 1.0 / 60.0           # [s], a step of the next three cases
PUSH = 0.2                   # share of an overlap that each step wants back [-]
SAME = 1e-9                  # of two ways to compute a speed or an eigenvalue: round-off, over 1 − T at the worst [-]


def standing(masses):
    """(rows (n, n), inverse masses) of a column: velocities to relative velocities at the contacts."""
    return np.eye(len(masses)) - np.eye(len(masses), k=-1), 1.0 / np.array(masses, float)


def cornered(width, height):
    """(rows (4, 3), inverse masses) of a box of 1 kg with two corners on the ground: normal and tangent of each.

    u_n = v_y + ω r_x and u_t = −v_x + ω r_y, with r from its centre to the corner.
    """
    rows = [row for r_x in (-0.5 * width, 0.5 * width) for row in ((0.0, 1.0, r_x), (-1.0, 0.0, -0.5 * height))]
    return np.array(rows), np.array([1.0, 1.0, 12.0 / (width**2 + height**2)])


def left_by_sweeps(rows, w, m):
    """T: velocities before m sweeps from zero → velocities after them, as long as every contact pushes and sticks.

    A sweep solves with the lower triangle L of A = rows W rowsᵀ and keeps the rest: H = 1 − L⁻¹A.  After m of them the
    impulses are −(1 + H + … + H^(m − 1)) L⁻¹ u.
    """
    A = (rows * w) @ rows.T
    lower = np.linalg.inv(np.tril(A))
    H = np.eye(len(A)) - lower @ A
    S = sum((np.linalg.matrix_power(H, k) for k in range(m)), 0.0 * A) @ lower
    return np.eye(len(w)) - w[:, None] * (rows.T @ S @ rows)


def end_speeds(rows, w, m, pull):
    """The velocities that do not change any more: v = T (v + pull)."""
    T = left_by_sweeps(rows, w, m)
    return np.linalg.solve(np.eye(len(w)) - T, T @ pull)


def swept_speeds(sweep, rows, w, m, pull, steps, remember=False):
    """Velocities after so many steps; in each of them m calls of sweep(A, b, impulses)."""
    A, v, J = (rows * w) @ rows.T, np.zeros(len(w)), np.zeros(len(rows))
    for _ in range(steps):
        v, J = v + pull, J if remember else 0.0 * J
        b = rows @ v
        for _ in range(m):
            J = sweep(A, b, J)
        v = v + w * (rows.T @ J)
    return v


@case("speed-of-sinking", "How fast the heavy one sinks", compiled=False)
def speed_of_sinking(lesson):
    """Each step adds g dt, and m sweeps from zero leave the share ρ^m of all approach: the speed g dt ρ^m/(1 − ρ^m).

    That is exact for the upper one of two bodies.  Of a stack each body has its own speed, (1 − T)⁻¹ T g dt.
    """
    sweep, found, dots = lambda A, b, J: lesson.gauss_seidel_sweep(A, b, J, 1.0), [], []
    for r, m in ((10.0, 5), (10.0, 20), (100.0, 20)):
        rho = r / (1.0 + r)
        speed = -swept_speeds(sweep, *standing([1.0, r]), m, -np.full(2, G * FRAME), 400)[1]
        dots.append((r, m, speed))
        law = G * FRAME * rho**m / (1.0 - rho**m)
        found.append(finding(
            claim="A body that is r times as heavy as what carries it sinks with g dt ρ^m/(1 − ρ^m), ρ = r/(1 + r).",
            quantity=f"speed of the heavy one, r = {r:g}, {m} sweeps per step [m/s]",
            predicted=law,
            measured=speed,
            tolerance=SAME * law,
            observation=f"{r:g} kg on 1 kg sink with {speed:.3g} m/s, because {m} sweeps are too few.",
        ))
    ten, pull = standing(np.ones(10)), -np.full(10, G * FRAME)
    theory, speeds = -end_speeds(*ten, 25, pull), -swept_speeds(sweep, *ten, 25, pull, 400)
    for k, name in ((9, "top"), (0, "lowest")):
        found.append(finding(
            claim="Of a stack of ten each box sinks with its own speed, (1 − T)⁻¹ T g dt.",
            quantity=f"speed of the {name} of ten boxes, 25 sweeps per step [m/s]",
            predicted=theory[k],
            measured=speeds[k],
            tolerance=SAME * theory[k],
            observation=f"The {name} of ten boxes sinks with {speeds[k]:.3f} m/s.",
        ))
    remembered = -swept_speeds(sweep, *ten, 25, pull, 400, remember=True)
    found.append(finding(
        claim="With memory the forces add up from step to step, and nothing sinks in the end.",
        quantity="speed of the top of ten boxes, 25 sweeps per step and memory [m/s]",
        predicted=0.0,
        measured=remembered[9],
        tolerance=ROUND_OFF,
        observation=f"With memory {abs(remembered[9]):.1e} m/s are left.",
    ))
    fine = np.arange(3.0, 41.0)
    lines = [series(f"theory, ratio {r:g}", fine, np.log10(G * FRAME / ((1.0 + 1.0 / r) ** fine - 1.0)), LINE)
             for r in (10.0, 100.0)]
    return found, Picture("How fast the heavy one sinks", "sweeps per step", "log₁₀ of the speed [m/s]", [
        *lines, series("measured", [m for _, m, _ in dots], np.log10([speed for *_, speed in dots]), DOTS)],
        "No law of contact is wrong: the solver stopped too early.  More sweeps, memory or more equal masses help.")


def trembling_step(sweep, m, y, v, lam):
    """(y, v, λ) after a step of ten boxes with memory: y displacements over dt, v velocities, λ impulses."""
    D, _ = standing(np.ones(10))
    b = D @ v + PUSH * (D @ y)
    for _ in range(m):
        lam = sweep(D @ D.T, b, lam, 1.0)
    v = v + D.T @ lam
    return y + v, v, lam


@case("trembling", "Why a stack trembles", compiled=False)
def trembling(lesson):
    """Memory keeps a push after its overlap has gone.  One step multiplies displacements, velocities and impulses by
    one matrix, and where its largest eigenvalue is above 1 the stack trembles.

    Theory writes the matrix down with H = 1 − L⁻¹A of a sweep: λ → H^m λ + (H^m − 1) A⁻¹ (u + PUSH gap/dt).  The
    measured one comes from the lesson's sweeps, column by column, far from where they cut off.
    """
    D, _ = standing(np.ones(10))
    A, one, zero = D @ D.T, np.eye(10), np.zeros((10, 10))
    H, found, radii = one - np.linalg.inv(np.tril(A)) @ A, [], {}
    for m in (4, 7, 8, 12, 20):
        kept = np.linalg.matrix_power(H, m)
        answer = (kept - one) @ np.linalg.inv(A)
        lam = np.hstack((PUSH * answer @ D, answer @ D, kept))
        v = np.hstack((zero, one, zero)) + D.T @ lam
        theory = np.max(np.abs(np.linalg.eigvals(np.vstack((np.hstack((one, zero, zero)) + v, v, lam)))))
        rest = np.zeros(10), np.zeros(10), np.full(10, 1e3)
        base = np.concatenate(trembling_step(lesson.gauss_seidel_sweep, m, *rest))
        columns = [np.concatenate(trembling_step(lesson.gauss_seidel_sweep, m, *(a + e for a, e in zip(rest, np.split(
            unit, 3), strict=True)))) - base for unit in np.eye(30)]
        radii[m] = theory, np.max(np.abs(np.linalg.eigvals(np.stack(columns, axis=1))))
    for m, verb in ((7, "trembles"), (8, "comes to rest")):
        theory, measured = radii[m]
        found.append(finding(
            claim="Memory that keeps pushes makes ten boxes tremble with seven sweeps per step, and not with eight.",
            quantity=f"growth per step, {m} sweeps [-]",
            predicted=theory,
            measured=measured,
            tolerance=SAME,
            observation=f"With {m} sweeps a disturbance is multiplied by {measured:.4f} per step: the stack {verb}.",
        ))
    few = np.array(sorted(radii))
    return found, Picture("Ten boxes with memory and a push", "sweeps per step", "growth per step [-]", [
        series("theory, largest eigenvalue", few, [radii[m][0] for m in few], LINE),
        series("measured", few, [radii[m][1] for m in few], DOTS)],
        "Above 1 the stack trembles.  A sweep at rest after the motion takes the pushes out of the memory.")


@case("creeping", "Why a box slides on a still platform", compiled=False)
def creeping(lesson):
    """A sweep visits the left corner first, which takes more than its share.  So the box turns, and friction comes too
    late: what is left of each step adds up to (1 − T)⁻¹ T g dt, along the floor as well.
    """
    rows, w = cornered(0.5, 1.0)
    mu, found, speeds = np.array([0.6, 0.6]), [], {}
    sweep = lambda A, b, J: lesson.cone_sweep(A, b, J, mu)
    for degrees in (0.0, 15.0):
        slope = np.radians(degrees)
        pull = G * FRAME * np.array([np.sin(slope), -np.cos(slope), 0.0])
        for m in (1, 2, 4, 8):
            speeds[degrees, m] = (end_speeds(rows, w, m, pull)[0],
                                  swept_speeds(sweep, rows, w, m, pull, 400)[0])
        for m in (1, 4):
            theory, speed = speeds[degrees, m]
            found.append(finding(
                claim="A box with enough friction creeps with (1 − T)⁻¹ T g dt, on a level floor, too.",
                quantity=f"speed of a box with μ = 0.6 on {degrees:g}°, sweeps per step: {m} [m/s]",
                predicted=theory,
                measured=speed,
                tolerance=SAME * theory,
                observation=f"On {degrees:g}° it creeps with {1e3 * speed:.3g} mm/s; sweeps per step: {m}.",
            ))
        still = swept_speeds(sweep, rows, w, 1, pull, 400, remember=True)[0]
        found.append(finding(
            claim="With memory it stands, even with one sweep per step.",
            quantity=f"speed of a box with μ = 0.6 on {degrees:g}°, one sweep per step and memory [m/s]",
            predicted=0.0,
            measured=still,
            tolerance=ROUND_OFF,
            observation=f"On {degrees:g}° {abs(still):.1e} m/s are left.",
        ))
    few = np.array([1, 2, 4, 8])
    return found, Picture("A box that should stand", "sweeps per step", "log₁₀ of its speed [m/s]", [
        series(f"{name}, {degrees:g}°", few, np.log10([speeds[degrees, m][k] for m in few]), look)
        for k, name, look in ((0, "theory", LINE), (1, "measured", DOTS)) for degrees in (0.0, 15.0)],
        "The platform does not move: the solver stops before normal and friction of both corners agree.")


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
        f"One number turns {more} sweeps into {fewer}, at no cost.")


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


def rest_of_a_stack(lesson, n, seconds):
    """Return (depths by theory (n,) [m], largest error of the depths [m], largest way sideways [m] or angle [rad])."""
    hertz, substeps, joints = 60.0, 2, np.arange(n)
    weights = (n - joints) * G
    law = np.where(joints == 0, 2.5, 5.0) * 0.5 * weights / (2.0 * np.pi * hertz) ** 2
    x = np.stack((np.zeros(n), joints + 0.5 - np.cumsum(law)), axis=1)
    state, pile = pile_of(lesson, "box", x, [(0.5, 0.5)] * n, 1.0, hertz=hertz, zeta=1.0, substeps=substeps)
    contacts = after(lesson, "box", state, pile, DT).contacts
    upper = np.where(contacts.b == n, contacts.a, np.maximum(contacts.a, contacts.b))
    J = 0.5 * weights[upper, None] * DT / substeps * np.where(contacts.n[:, 1:] > 0.0, 1.0, -1.0) * (0.0, 1.0)
    end = after(lesson, "box", state._replace(contacts=contacts, J=J), pile, seconds)
    depths = 1.0 - np.diff(end.x[:n, 1], prepend=-0.5)
    return law, depths, max(np.max(np.abs(end.x[:n, 0])), np.max(np.abs(end.q)))


@case("stack-at-rest", "How deep stacks of ten and a hundred rest, and whether they drift", compiled=False)
def stack_at_rest(lesson):
    """n boxes of width w rest where theory says, with the impulses of theory, and are left alone.

    Joint k, counted from 0 at the floor, carries (n − k) m g, half of it at each corner, and a corner sinks by
    k_n F/(2π hertz)².  Between two boxes k_n = 2/m + 2 (w/2)²/I = 5/m, at the floor half of that, because I = m w²/6.
    If that is the rest of the pile, nothing moves but by round-off.  A depth is the difference of two places of up to
    n m, each rounded, here and in the pile.  Sideways nothing leads back: in each step four lever arms of
    half a metre are rounded to 1.1e-16 m.  A pile that is put down without an overlap sways first.
    """
    found, drawn = [], []
    for n, seconds in ((10, 2.0), (100, 0.2)):
        law, depths, moved = rest_of_a_stack(lesson, n, seconds)
        error, joints = np.max(np.abs(depths - law)), np.arange(1.0, n + 1.0)
        found += [finding(
            claim="A joint of a stack is k_n F/(2π hertz)² deep, F the weight above it on two corners.",
            quantity=f"largest error of the depths of {n} joints after {seconds:g} s [m]",
            predicted=0.0,
            measured=error,
            tolerance=4.0 * np.spacing(float(n)),
            observation=(f"The joints are {1e3 * law.min():.2f} to {1e3 * law.max():.2f} mm deep, and that to "
                         f"{error:.0e} m."),
        ), finding(
            claim="A stack at rest does not drift, neither sideways nor by turning.",
            quantity=f"largest way sideways or angle of {n} boxes in {seconds:g} s [m, rad]",
            predicted=0.0,
            measured=moved,
            tolerance=4.0 * seconds / DT * np.spacing(0.5),
            observation=f"In {seconds:g} s none of {n} boxes moves sideways or turns by more than {moved:.0e}.",
        )]
        drawn += [series(f"{n} boxes, theory", joints, 1e3 * law, LINE),
                  series(f"{n} boxes, measured", joints, 1e3 * depths, DOTS)]
    return found, Picture("How deep two stacks rest", "joint, from the floor", "depth [mm]", drawn,
        "Each joint carries one box less than the one below it. The floor does not give way, so the lowest joint is "
        "half as deep as its load says.")


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
        claim="A direct method is accurate at any mass ratio.",
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


# ---------------------------------------------------------------------------------------------- the highest hertz

def substep_matrix(masses, c, zeta):
    """M of one substep of a column as theory has it, for errors of (gaps, impulses, velocities) (3n,); all push.

    c is hertz times a substep, s = 2πc, and the substep is 1.  From the lowest body, u_k = v_k − v_(k−1).
        the last impulses:      v_k += (J_k − J_(k+1))/m_k
        a soft sweep:           J_k += (−s gap_k/(2ζ + s) − u_k − k_k J_k/(s (2ζ + s)))/(k_k (1 + 1/(s (2ζ + s))))
        motion:                 gap_k += u_k
        a sweep at rest:        J_k −= u_k/k_k
    with k_k = 1/m_k + 1/m_(k−1).  Each change of J_k acts on v at once.  Contacts are numbered by bodies: that of the
    lowest body with its upper neighbour, with the floor, and then upwards.  Those with the numbers 0, 5, 10, … are
    visited first, then 1, 6, 11, … and so on.
    """
    n, w, s = len(masses), 1.0 / np.array(masses, float), 2.0 * np.pi * c
    k_n, give = w + np.append(0.0, w[:-1]), 1.0 / (s * (2.0 * zeta + s))
    rows = np.eye(n) - np.eye(n, k=-1)
    numbered, columns = [1, 0, *range(2, n)] if n > 1 else [0], []
    order = [k for first in range(5) for k in numbered[first::5]]
    for gap, J, v in np.eye(3 * n).reshape(3 * n, 3, n):
        gap, J, v = 1.0 * gap, 1.0 * J, v + w * (rows.T @ J)
        for aim, soft in ((-s * gap / (2.0 * zeta + s), give), (np.zeros(n), 0.0)):
            for k in order:
                change = (aim[k] - rows[k] @ v - soft * k_n[k] * J[k]) / (k_n[k] * (1.0 + soft))
                J[k], v = J[k] + change, v + w * rows[k] * change
            gap += (soft > 0.0) * (rows @ v)
        columns.append(np.concatenate((gap, J, v)))
    return np.stack(columns, axis=1)


def largest(matrix):
    """The largest size of its eigenvalues."""
    return np.max(np.abs(np.linalg.eigvals(matrix)))


def measured_matrix(lesson, masses, c, zeta):
    """The same from the lesson's pile of discs: what a step of one substep does to single errors of a column at rest.

    Errors are a thousandth of the sag, and the step is so short that the sag is some 1/100 of a disc.
    """
    m, n = np.array(masses, float), len(masses)
    w, forces = 1.0 / m, G * np.cumsum(m[::-1])[::-1]
    sag = (w + np.append(0.0, w[:-1])) * forces / (2.0 * np.pi * c) ** 2             # times the square of the step
    h = np.sqrt(0.01 / np.max(sag))
    heights, still = np.cumsum(1.0 - h**2 * sag) - 0.5, np.zeros((n + 1, 2))
    state, pile = pile_of(lesson, "disc", np.stack((np.zeros(n), heights), axis=1), [(0.5, 0.5)] * n, m, substeps=1,
                          hertz=c / h, zeta=zeta, margin=0.2)
    contacts = after(lesson, "disc", state, pile, h, h).contacts
    upper = np.where(contacts.b == n, contacts.a, np.maximum(contacts.a, contacts.b))
    towards, size = np.sign(contacts.n[:, 1]), 1e-3 * np.min(sag) * h**2

    def step(errors):
        gaps, J, v = errors.reshape(3, n)
        x, v_all, J_all = 1.0 * state.x, 1.0 * still, np.zeros((n, 2))
        x[:n, 1], v_all[:n, 1] = heights + np.cumsum(gaps), v / h
        J_all[:, 1] = towards * (forces * h + J / h)[upper]
        end = after(lesson, "disc", state._replace(x=x, v=v_all, contacts=contacts, J=J_all), pile, h, h)
        J_end = np.zeros(n)
        J_end[upper] = towards * end.J[:, 1]
        return np.concatenate((np.diff(end.x[:n, 1], prepend=-0.5), J_end * h, end.v[:n, 1] * h))
    base = step(np.zeros(3 * n))
    return np.stack([(step(size * error) - base) / size for error in np.eye(3 * n)], axis=1)


@case("highest-hertz", "How stiff may a contact be?", compiled=False)
def highest_hertz(lesson):
    """A column at rest is stable where a substep shrinks all small errors: all eigenvalues of its matrix are below 1.

    Theory writes the substep down as a matrix; the experiment perturbs gaps, impulses and velocities of a real pile.
    With errors of a thousandth of the sag, which is 1/100 of a disc, differences are rounded to 1e-16/1e-5: 1e-9 is
    allowed to eigenvalues that may be double.  Where two of them cross 1, hertz are refined by bisection: its width is
    1e-6, and 1 − ρ changes by some 0.02 per unit there, so that 1e-9 makes 1e-7 more.
    """
    found, most = [], 1.0 / 3.0
    piles = (("five equal discs", np.ones(5), 10.0), ("twenty equal discs", np.ones(20), 10.0),
             ("twenty equal discs, ζ = 1", np.ones(20), 1.0), ("100 on 1", (1.0, 100.0), 10.0))
    for name, masses, zeta in piles:
        theory, rho = (largest(M) for M in (substep_matrix(masses, most, zeta),
                                            measured_matrix(lesson, masses, most, zeta)))
        found.append(finding(
            claim="With hertz of a third of the substeps, the most that a pile accepts, up to twenty are stable.",
            quantity=f"part of an error that a substep leaves, {name} [-]",
            predicted=theory,
            measured=rho,
            tolerance=1e-7,
            observation=f"A third of the substeps, {name}: a substep leaves {rho:.5f} of an error.",
        ))
    for r in (1e3, 1e4):
        theory, edge = (bisect(lambda c, matrix=matrix: largest(matrix(c)) > 1.0, 0.25, 0.4 if exact else most)
                        for exact, matrix in ((True, lambda c, r=r: substep_matrix((1.0, r), c, 10.0)),
                                              (False, lambda c, r=r: measured_matrix(lesson, (1.0, r), c, 10.0))))
        found.append(finding(
            claim="A heavy body on a light one lowers the hertz at which they stand.",
            quantity=f"highest hertz times a substep, {r:g} on 1 [-]",
            predicted=theory,
            measured=edge,
            tolerance=4.0 * EDGE,
            observation=f"{r:g} on 1 stand up to {edge:.5f} hertz per substep rate; above it they tremble.",
        ))
    fine, few = np.linspace(0.02, 0.6, 59), np.linspace(0.02, most, 5)
    curves = [("10 equal discs", np.ones(10)), ("20 equal discs", np.ones(20)), ("1,000 on 1", (1.0, 1e3))]
    return found, Picture("What a substep leaves of an error", "hertz times a substep", "part that is left", [
        *(series(f"theory, {name}", fine, [largest(substep_matrix(masses, c, 10.0)) for c in fine], LINE)
          for name, masses in curves),
        *(series(name, few, [largest(measured_matrix(lesson, masses, c, 10.0)) for c in few], DOTS)
          for name, masses in curves)],
        "Above 1 a pile trembles.  Stiffer contacts settle sooner, but only up to about a third of the substeps.")


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

    Bodies of 1 m part with 2.7 m/s at most.  Thrown up with that, one would rise by 0.37 m.  The second sweep,
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
            tolerance=0.037,
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
        claim="Sizes and masses of zero, planes without a normal, hertz that no substep carries and contacts of two "
              "immovable bodies are refused, with their value.",
        quantity=f"calls that name the value in their error [of {len(asked)}]",
        predicted=len(asked),
        measured=refused,
        tolerance=0.0,
        observation=f"{refused} of {len(asked)} such calls end in a sentence that names the value.",
    )


# ---------------------------------------------------------------------------------------------- in space

UPRIGHT = (1.0, 0.0, 0.0, 0.0)


def pile_in_space(lesson, shape, x, half, masses, q=UPRIGHT, planes=((0.0, 0.0, 1.0, 0.0),), **more):
    """(PileState, Pile) of balls or boxes in space, under gravity."""
    x, half = np.array(x, float), np.array(half, float)
    masses = np.broadcast_to(masses, len(x)).astype(float)
    settings = {"mu": 0.5, "substeps": 4, "hertz": 240.0, "zeta": 10.0, "margin": 0.02, **more}
    squares = half**2
    moments = masses[:, None] * (0.4 * squares if shape == "ball"
                                 else (np.sum(squares, axis=1)[:, None] - squares) / 3.0)
    return lesson.make_pile(x, np.tile(q, (len(x), 1)), masses, moments, half, np.array(planes), (0.0, 0.0, -G),
                            **settings)


def later(lesson, shape, state, pile, seconds, dt=DT):
    """The PileState so many seconds later."""
    bounds, contacts = lesson.ball_bounds, lesson.round_contacts
    if shape == "box":
        bounds, contacts = lesson.box_bounds, lesson.box_contacts
    return lesson.advance_pile(bounds, contacts, state, dt, round(seconds / dt), pile)


def ramp(degrees):
    """A plane through the origin, rising along x."""
    return (-np.sin(np.radians(degrees)), 0.0, np.cos(np.radians(degrees)), 0.0)


INSIDE_IN_SPACE = (          # shape, centres [m] of bodies with half sizes of ½ m, what they are
    ("ball", [(0.0, 0.0, 0.5), (0.0, 0.0, 0.5)], "coincident balls"),
    ("ball", [(0.0, 0.0, 0.2), (0.1, 0.0, 0.3)], "balls deep in each other"),
    ("box", [(0.0, 0.0, 0.5), (0.0, 0.0, 0.5)], "coincident cubes"), ("box", [(0.0, 0.0, -0.5)], "a cube in the floor"),
)


def wedge_in_space(lesson, degrees):
    """Forces over the weight, (2,), of a ball between two walls without friction."""
    state, pile = pile_in_space(lesson, "ball", [(0.0, 0.0, 0.5 / np.cos(np.radians(degrees)))], [(0.5,) * 3], 1.0,
                                mu=0.0, planes=[ramp(degrees), ramp(-degrees)])
    end = later(lesson, "ball", state, pile, 1.0)
    return np.linalg.norm(end.J, axis=1) * pile.substeps / DT / G


@case("extremes-in-space", "The same in space", compiled=False)
def extremes_in_space(lesson):
    """What holds in the plane holds in space: deep overlaps, friction 0 and ∞ on a slope, a wedge, sizes of 1 : 100.

    The bounds are those of the plane.  What parts with 2.7 m/s would rise by 0.37 m; a tenth of that is allowed.
    A ball in a wedge of 80° is held by 1/(2 cos θ) weights on each side; sweeps contract by cos² 2θ = 0.88 there, and
    7e-8 was left after a second: 1e-6 is allowed.  A ball of 1 cm beside one of 1 m sags by g/(2π hertz)².
    """
    found = []
    for shape, x, name in INSIDE_IN_SPACE:
        state, pile = pile_in_space(lesson, shape, x, [(0.5,) * 3] * len(x), 1.0)
        highest = -np.inf
        for _ in range(10):
            state = later(lesson, shape, state, pile, 0.1)
            highest = np.maximum(highest, np.max(state.x[:len(x), 2]))
        overlap = max(0.0, -np.min(state.contacts.gap, initial=0.0))
        found.append(finding(
            claim="What begins inside something else comes out, and is not thrown out.",
            quantity=f"height of {name} above the place on top, at most, and overlap in the end [m]",
            predicted=0.0,
            measured=max(0.0, highest - len(x) + 0.5) + overlap,
            tolerance=0.037,
            observation=f"With {name} nothing rises above {highest:.3f} m; {1e3 * overlap:.2f} mm overlap at last.",
        ))
    for mu in (0.0, np.inf):
        theta = np.radians(40.0)
        q = (np.cos(0.5 * theta), 0.0, -np.sin(0.5 * theta), 0.0)
        state, pile = pile_in_space(lesson, "box", [0.5 * np.array(ramp(40.0)[:3])], [(0.5,) * 3], 1.0, q,
                                    [ramp(40.0)], mu=mu)
        speed = np.linalg.norm(later(lesson, "box", state, pile, 0.25).v[0])
        found.append(finding(
            claim="Without friction a cube slides with g sin θ t; with infinite friction it stays where it is.",
            quantity=f"speed after ¼ s on a slope of 40°, μ = {mu:g} [m/s]",
            predicted=0.0 if mu else 0.25 * G * np.sin(theta),
            measured=speed,
            tolerance=1e-9,
            observation=f"On 40° with μ = {mu:g} its speed is {speed:.4g} m/s after ¼ s.",
        ))
    angles = (30.0, 60.0, 80.0)
    carried_by = [wedge_in_space(lesson, degrees) for degrees in angles]
    for degrees, forces in zip(angles, carried_by):
        law = 0.5 / np.cos(np.radians(degrees))
        found.append(finding(
            claim="In a wedge of slope θ each wall carries 1/(2 cos θ) weights.",
            quantity=f"force over the weight of a ball at {degrees:g}° [-]",
            predicted=law,
            measured=forces[np.argmax(np.abs(forces - law))] if forces.size == 2 else np.nan,
            tolerance=1e-6 * law,
            observation=f"At {degrees:g}° the walls carry {' and '.join(f'{f:.4f}' for f in forces)} weights.",
        ))
    x = [(0.0, 0.0, 1.0), (1.5, 0.0, 0.01), (0.0, 1.5, 0.01)]
    state, pile = pile_in_space(lesson, "ball", x, [(1.0,) * 3] + [(0.01,) * 3] * 2, [1e6, 1.0, 1.0], margin=0.002)
    moved = np.max(np.abs(later(lesson, "ball", state, pile, 0.5).x[:3] - state.x[:3]))
    found.append(finding(
        claim="Balls of 1 cm beside one of 1 m, a million times as heavy, sag like any other.",
        quantity="largest way of a ball in ½ s, sizes 1 : 100 [m]",
        predicted=G / (480.0 * np.pi) ** 2,
        measured=moved,
        tolerance=1e-11,
        observation=f"They move by {1e6 * moved:.3f} µm.",
    ))
    fine = np.linspace(0.0, 85.0, 86)
    return found, Picture("A ball between two walls", "slope of the walls [°]", "force over the weight [-]", [
        series("theory, 1/(2 cos θ)", fine, 0.5 / np.cos(np.radians(fine)), LINE),
        series("measured", angles, [np.mean(forces) for forces in carried_by], DOTS)],
        "In space the same forces hold a ball as hold a disc in the plane.")


# ---------------------------------------------------------------------------------------------- the judge

def judged_by_lesson(lesson, judged, mu):
    """(residual [m/s] of 9.9 for a Judged record in the plane, largest effective inverse mass times impulse [m/s])."""
    (x, v, omega, inv_mass, inv_inertia), (a, b, n, p, gap) = judged.bodies, judged.contacts
    contacts = fallen(KINDS["discs"], 1)[0].contacts._replace(a=a, b=b, n=n, p=p, gap=gap)
    rows = lesson.contact_rows(x, contacts)
    A = lesson.delassus_matrix(rows, lesson.inverse_masses(inv_mass, inv_inertia))
    J_n, J_t = np.sum(judged.J * n, axis=1), judged.J[:, 1] * n[:, 0] - judged.J[:, 0] * n[:, 1]
    J = np.stack((J_n, J_t), axis=1).ravel()
    u = rows @ np.column_stack((v, omega)).ravel()
    u[::2] += np.maximum(gap, 0.0) / ENGINE_DT                           # an open gap may close in this step
    b = u - A @ J
    return lesson.cone_residual(A, b, J, np.full(len(a), mu)), np.max(np.diag(A)[::2] * J_n)


def steepest(judged):
    """The largest |J_t|/J_n of contacts that push with more than a thousandth of the mean."""
    n = judged.contacts[2]
    J_n = np.sum(judged.J * n, axis=1)
    J_t = np.linalg.norm(judged.J - J_n[:, None] * n, axis=1)
    pushing = J_n > 1e-3 * np.mean(J_n)
    return np.max(J_t[pushing] / J_n[pushing])


def pymunk_pile_at_rest(lesson):
    """Return (times [s], residuals over g dt, the last record) of 30 discs that fall and come to rest in pymunk."""
    kind = KINDS["discs"]._replace(across=6)
    state, pile = fallen(kind, 30)
    world, times, seen = PymunkPile(kind, state, pile, 200, 1e-3), [], []
    for _ in range(12):
        world.run(60)
        times.append(0.25 + (times[-1] if times else 0.0))
        seen.append(judged_by_lesson(lesson, world.judged(), MU)[0] / (G * ENGINE_DT))
    return times, seen, world.judged()


def converged_impulses(lesson, record, residual):
    """Judge a record of rest by the lesson, by velocities alone, and with a tenth of the friction."""
    by_reference = natural_residual(*record, MU, ENGINE_DT) / (G * ENGINE_DT)
    strict = judged_by_lesson(lesson, record, 0.1 * MU)[0] / (G * ENGINE_DT)
    return [
        finding(
            claim="Impulses of an engine that has converged have no residual.",
            quantity="residual of pymunk's impulses in 30 discs at rest, over g dt [-]",
            predicted=0.0,
            measured=residual,
            tolerance=1e-7,
            observation=f"pymunk's impulses have a residual of {residual:.0e} g dt after 3 s.",
        ),
        finding(
            claim="The judge without matrices says the same.",
            quantity="residual by velocities alone, over g dt [-]",
            predicted=0.0,
            measured=by_reference,
            tolerance=1e-7,
            observation=f"Without matrices it is {by_reference:.0e} g dt.",
        ),
        finding(
            claim="Friction that is too large for the cone is found.",
            quantity="judgements with a tenth of μ that find more than g dt/100 [of 1]",
            predicted=1,
            measured=strict > 0.01,
            tolerance=0.0,
            observation=f"Judged with μ = {0.1 * MU:g} the same impulses have a residual of {strict:.2f} g dt.",
        ),
    ]


def impulse_left_out(lesson, record):
    """Judge a record without its largest impulse."""
    largest_push = judged_by_lesson(lesson, record, MU)[1]
    k = np.argmax(np.sum(record.J * record.contacts[2], axis=1))
    without = record._replace(J=np.where((np.arange(len(record.J)) == k)[:, None], 0.0, record.J))
    bodies = list(without.bodies)
    v, omega = without_impulse(record, k)
    bodies[1], bodies[2] = v, omega
    left = judged_by_lesson(lesson, without._replace(bodies=tuple(bodies)), MU)[0]
    alone = own_push(record, k)
    return [finding(
        claim="A contact whose impulse is left out has the residual k_n J_n: no residual of the pile is less.",
        quantity="residual without the largest impulse, over k_n J_n, or 1 if that is less [-]",
        predicted=1.0,
        measured=min(1.0, left / alone),
        tolerance=1e-6,
        observation=f"Without it the residual is {left / (G * ENGINE_DT):.2f} g dt; "
                    f"the largest k_n J_n is {largest_push / (G * ENGINE_DT):.2f} g dt.",
    )]


def disc_of_friction(lesson):
    """Let 12 spheres come to rest by the lesson's pile."""
    small = KINDS["spheres"]._replace(across=2)
    state, pile = fallen(small, 12)
    end = later(lesson, "ball", state, pile, 1.0)
    ours = (np.linalg.norm(end.J - np.sum(end.J * end.contacts.n, axis=1)[:, None] * end.contacts.n, axis=1),
            np.sum(end.J * end.contacts.n, axis=1))
    return [finding(
        claim="The pile in space keeps the disc of the cone.",
        quantity="largest |J_t| − μ J_n of 12 spheres, over the largest J_n [-]",
        predicted=0.0,
        measured=max(0.0, np.max(ours[0] - MU * ours[1])) / np.max(ours[1]),
        tolerance=1e-12,
        observation="No contact of our 12 spheres has more friction than the cone allows.",
    )]


def pyramid_of_pybullet():
    """Let 27 spheres roll in pybullet."""
    kind = KINDS["spheres"]._replace(across=3)
    world = BulletPile(kind, *fallen(kind, 27), 50)
    slopes = []
    for _ in range(12):
        world.run(60)
        slopes.append(steepest(world.judged()))
    world.close()
    return [finding(
        claim="pybullet's friction is a pyramid: it reaches √2 μ along the diagonal.",
        quantity="largest |J_t|/(μ J_n) of 27 spheres in pybullet [-]",
        predicted=np.sqrt(2.0),
        measured=max(slopes) / MU,
        tolerance=0.01,
        observation=f"pybullet's friction goes up to {max(slopes) / MU:.4f} μ times the normal force.",
    )]


@case("judge", "A judge for any solver, an engine's included", compiled=False)
def judge(lesson):
    """The residual needs impulses and velocities, and does not mind who found them.

    pymunk's impulses in a pile of discs at rest keep the laws to what its iterations leave, 1e-8 g dt after 3 s with
    200 of them.  Judged with a tenth of the friction, a contact is over the cone: then the residual is no round-off any
    more.

    An impulse that is left out leaves its k_n J_n at its own contact.  The residual is the largest of all, so it is at
    least that; a neighbour can have a little more, depending on the pile.  pybullet's friction goes along two
    directions, each up to μ J_n: √2 μ J_n along the diagonal.
    """
    times, seen, record = pymunk_pile_at_rest(lesson)
    found = converged_impulses(lesson, record, seen[-1]) + impulse_left_out(lesson, record) + disc_of_friction(lesson)
    if PYBULLET.installed():
        found += pyramid_of_pybullet()
    return found, Picture("pymunk's impulses, judged", "time [s]", "log₁₀ of the residual over g dt", [
        series("30 discs, 200 iterations", times, np.log10(np.maximum(seen, 1e-16)), DOTS)],
        "While discs fall and roll, the impulses are not those of rest; then the residual falls to round-off.")


def own_push(record, k):
    """k_n J_n [m/s] of a contact in the plane."""
    (x, _, _, inv_mass, inv_inertia), (a, b, n, p, _) = record.bodies, record.contacts
    k_n = sum(inv_mass[i] + inv_inertia[i] * cross_2d(p[k] - x[i], n[k]) ** 2 for i in (a[k], b[k]))
    return k_n * (record.J[k] @ n[k])


def without_impulse(record, k):
    """(v, ω) of all bodies, had contact k not pushed."""
    (x, v, omega, inv_mass, inv_inertia), (a, b, _, p, _) = record.bodies, record.contacts
    v, omega = 1.0 * v, 1.0 * omega
    for i, sign in ((a[k], -1.0), (b[k], 1.0)):
        v[i] += sign * inv_mass[i] * record.J[k]
        omega[i] += sign * inv_inertia[i] * cross_2d(p[k] - x[i], record.J[k])
    return v, omega


# ---------------------------------------------------------------------------------------------- closed forms

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
        left = np.maximum(left, abs(relaxed_radius(A, omega) - rho))
    rng, off = np.random.default_rng(99), 0.0
    for _ in range(100):
        J, limit = rng.normal(size=3), rng.uniform(0.1, 2.0)
        P = np.array(lesson.friction_disc(tuple(J), limit))
        q = rng.normal(size=(50, 3))
        q *= (limit * rng.uniform(0.0, 1.0, 50) / np.linalg.norm(q, axis=1))[:, None]
        q = np.concatenate((q, [limit * J / np.linalg.norm(J)]))
        off = np.max((off, np.linalg.norm(P) - limit, np.max((q - P) @ (J - P)),
                      np.linalg.norm(P - J) if np.linalg.norm(J) <= limit else 0.0))
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


# ---------------------------------------------------------------------------------------------- each law by itself

def pushes(J, u, k, mu):
    """Return (J_n, J_t) that contacts alone would have: of J (2m,), u (2m,) and the diagonal k (2m,) of A."""
    n, t = slice(0, None, 2), slice(1, None, 2)
    limit = mu * np.maximum(0.0, J[n])
    return np.maximum(0.0, J[n] - u[n] / k[n]), np.clip(J[t] - u[t] / k[t], -limit, limit)


@case("laws-of-contact", "Each law of contact by itself", compiled=False)
def laws_of_contact(lesson):
    """Rows by the velocities of points; sweeps by triangular matrices; complementarity by trying all sets of contacts.

    A sweep takes new impulses for the contacts before, old ones for itself and those behind: tril(A) and triu(A).
    """
    rng = np.random.default_rng(98)
    worst = Worst()

    for _ in range(50):
        x, v, n, p = rng.normal(size=(4, 4, 2))
        n /= np.linalg.norm(n, axis=1)[:, None]
        w, a, b = rng.uniform(0.5, 2.0, 12), np.array([0, 0, 1, 2]), np.array([1, 3, 2, 3])
        contacts = lesson.ContactSet(np.array([0, 2, 3, 4, 4]), a, b, n, p, np.zeros(4))
        omega = rng.normal(size=4)
        arms = p - x[a], p - x[b]
        at = [v[body] + omega[body, None] * np.stack((-r[:, 1], r[:, 0]), axis=1) for body, r in zip((a, b), arms)]
        u, t = at[0] - at[1], np.stack((-n[:, 1], n[:, 0]), axis=1)
        along = np.stack((np.sum(n * u, axis=1), np.sum(t * u, axis=1)), axis=1).ravel()
        G = lesson.contact_rows(x, contacts)
        worst.note("rows", G @ np.column_stack((v, omega)).ravel(), along)
        truth = sum(w_i * np.outer(g, g) for w_i, g in zip(w, G.T, strict=True))
        worst.note("matrix", lesson.delassus_matrix(G, w), truth)

        # a sweep over the same contacts without a matrix: each in turn changes the velocities of all, y, by M⁻¹ Gᵀ
        m_inv, I_inv, mu = rng.uniform(0.5, 2.0, 4), rng.uniform(0.5, 2.0, 4), rng.uniform(0.1, 1.0)
        aim, give, J = rng.normal(size=4), rng.uniform(0.0, 0.5, 4), rng.normal(size=(4, 2))
        held, w = lesson.arms_2d(x, m_inv, I_inv, contacts), np.column_stack((m_inv, m_inv, I_inv)).ravel()
        y, kept, axes = np.column_stack((v, omega)).ravel(), J.copy(), np.stack((n, t), axis=1)
        for k in range(4):
            rows = G[2 * k:2 * k + 2]
            k_n, k_t = np.sum(w * rows * rows, axis=1)
            worst.note("arms", (held.r_a[k], held.r_b[k], held.k_n[k], held.k_t[k]), (arms[0][k], arms[1][k], k_n, k_t))
            (u_n, u_t), (J_n, J_t) = rows @ y, axes[k] @ kept[k]
            J_n = max(0.0, J_n + (aim[k] - u_n - give[k] * k_n * J_n) / (k_n * (1.0 + give[k])))
            new = np.array([J_n, np.clip(J_t - u_t / k_t, -mu * J_n, mu * J_n)]) @ axes[k]
            y, kept[k] = y + w * (rows.T @ (axes[k] @ (new - kept[k]))), new
        pile = lesson.Pile(m_inv, I_inv, np.ones((4, 2)), np.zeros((0, 3)), np.zeros(2), mu, 1, 30.0, 1.0, 0.1)
        swept = lesson.velocity_sweep_2d(v, omega, J, aim, give, contacts, held, pile)
        worst.note("quick", (np.column_stack(swept[:2]), swept[2]), (y, kept))

        factor = rng.normal(size=(8, 8))
        A, b, mu = factor @ factor.T + 0.5 * np.eye(8), rng.normal(size=8), rng.uniform(0.1, 1.0, 4)
        k, old, relaxation = np.diag(A), rng.uniform(0.0, 1.0, 8), rng.uniform(0.5, 1.5)
        new = lesson.gauss_seidel_sweep(A, b, old, relaxation)
        mixed = np.tril(A, -1) @ new + np.triu(A) @ old + b
        worst.note("sweep", new, np.maximum(0.0, old - relaxation * mixed / k))
        size = 10.0 ** rng.uniform(-9.0, 3.0)                               # from dust to rocks
        worst.note("lcp", lesson.solve_lcp(A, size * b) / size, enumerated(A, b))
        u = A @ old + b
        truth = max(abs(min(k[i] * old[i], u[i])) for i in range(8))
        worst.note("judge", lesson.complementarity_residual(A, b, old), truth)

        J = rng.normal(size=8)
        J_n, J_t = pushes(J, A @ J + b, k, mu)
        apart = np.abs(J_n - J[::2]) * k[::2], np.abs(J_t - J[1::2]) * k[1::2]
        worst.note("judge of cones", lesson.cone_residual(A, b, J, mu), np.max(apart))
        new = lesson.cone_sweep(A, b, J, mu)
        u = np.tril(A, -1) @ new + np.triu(A) @ J + b
        limited = np.where(np.arange(8) % 2, J, new)                        # J_t is limited by the new J_n
        J_n, _ = pushes(J, u, k, mu)
        _, J_t = pushes(limited, u, k, mu)
        worst.note("cone", new, np.stack((J_n, J_t), axis=1).ravel())

        # one contact of two bodies in space: along n as in the plane, and across it in the disc of friction
        (n, *_), (x_a, x_b, p), J, y = np.linalg.qr(rng.normal(size=(3, 3)))[0], *(
            rng.normal(size=shape) for shape in ((3, 3), 3, 12))
        factors, light, mu = rng.normal(size=(2, 3, 3)), rng.uniform(0.5, 2.0, 2), rng.uniform(0.1, 1.0)
        turns = factors @ np.swapaxes(factors, 1, 2) + 0.5 * np.eye(3)
        W = np.zeros((12, 12))
        for i, block in enumerate((light[0] * np.eye(3), turns[0], light[1] * np.eye(3), turns[1])):
            W[3 * i:3 * i + 3, 3 * i:3 * i + 3] = block
        rows = np.concatenate([sign * np.concatenate((np.eye(3), np.cross(p - x, np.eye(3))), axis=1)
                               for x, sign in ((x_a, 1.0), (x_b, -1.0))], axis=1)
        K, u, (aim, give) = rows @ W @ rows.T, rows @ y, rng.uniform(0.0, 0.5, 2)
        k_n = n @ K @ n
        J_n = max(0.0, J @ n + (aim - u @ n - give * k_n * (J @ n)) / (k_n * (1.0 + give)))
        stick = J - u / (np.trace(K) - k_n)
        J_t = stick - (stick @ n) * n
        new = J_n * n + min(1.0, mu * J_n / np.linalg.norm(J_t)) * J_t
        contact = lesson.ContactSet(np.array([0, 1, 1]), np.array([0]), np.array([1]), n[None], p[None], np.zeros(1))
        held = lesson.arms_3d(np.array([x_a, x_b]), light, turns, contact)
        swept = lesson.velocity_sweep(y.reshape(2, 2, 3)[:, 0].copy(), y.reshape(2, 2, 3)[:, 1].copy(), J[None],
                                      np.array([aim]), np.array([give]), contact, held, light, turns, mu)
        truth = (y + W @ rows.T @ (new - J)).reshape(2, 2, 3)
        worst.note("in space", swept, (truth[:, 0], truth[:, 1], new))

        # a free body between two substeps: ω − dt I⁻¹ (ω × I ω), with the tensor as a matrix
        turn, omega, light, dt = np.linalg.qr(rng.normal(size=(3, 3)))[0], *rng.normal(size=(1, 3)), rng.uniform(
            0.5, 2.0, 3), rng.uniform(0.01, 0.1)
        turn *= np.linalg.det(turn)
        I = turn @ np.diag(1.0 / light) @ turn.T
        worst.note("turns", lesson.turn_freely(turn[None], omega[None], light[None], dt)[0],
                   omega - dt * np.linalg.solve(I, np.cross(omega, I @ omega)))

        # old contacts of the same bodies and of others, near and far
        near, d = 0.5, 3
        old_b, old_p, J_old = rng.integers(1, 4, 6), rng.uniform(0.0, 1.0, (6, d)), rng.normal(size=(6, d))
        here_b, here_p = rng.integers(1, 4, 5), rng.uniform(0.0, 1.0, (5, d))
        sets = [lesson.ContactSet(np.array([0, len(b_s), len(b_s)]), np.zeros(len(b_s), int), b_s, 0.0 * p_s, p_s,
                                  np.zeros(len(b_s))) for b_s, p_s in ((here_b, here_p), (old_b, old_p))]
        truth = np.zeros((5, d))
        for k in range(5):
            away = np.where(old_b == here_b[k], np.linalg.norm(old_p - here_p[k], axis=1), np.inf)
            truth[k] = J_old[np.argmin(away)] if away.min() < near else 0.0
        worst.note("kept", lesson.kept_impulses(*sets, J_old, near), truth)

        # a spring (2π hertz)² and a damper over 1/k_n, one implicit Euler step: u = u₀ + k_n J, x = gap + dt u
        hertz, zeta, dt, gap, u_0 = rng.uniform((5.0, 0.5, 0.001, 0.001, -1.0), (50.0, 5.0, 0.01, 0.01, 1.0))
        aim, give = lesson.soft_contact(-gap, hertz, zeta, dt)
        impulse = (aim - u_0) / (1.0 + give)                                # k_n J of u = aim − give k_n J
        s = 2.0 * np.pi * hertz
        force = -s * s * (-gap + dt * (u_0 + impulse)) - 2.0 * zeta * s * (u_0 + impulse)
        worst.note("spring", impulse, dt * force)
        worst.note("spring", lesson.soft_contact(gap, hertz, zeta, dt), (-gap / dt, 0.0))
    names = (
        ("rows", "Rows times velocities are the relative velocities of the points.", "relative velocity [m/s]"),
        ("matrix", "The Delassus matrix adds up over all coordinates.", "matrix [1/kg]"),
        ("sweep", "A sweep uses new impulses before, old ones behind, and none pulls.", "impulses of a sweep [N s]"),
        ("lcp", "The direct solver finds the set of contacts that push.", "impulses of the direct solver [N s]"),
        ("judge", "The residual finds contacts that pull, approach, or push while they part.", "residual [m/s]"),
        ("cone", "A sweep with friction limits J_t by the new J_n, with the μ of each contact.",
         "impulses with friction [N s]"),
        ("arms", "Arms and effective inverse masses are those of the rows.", "arms [m, 1/kg]"),
        ("quick", "A sweep without a matrix does what each contact by itself does to all velocities.",
         "state after a quick sweep [m/s, rad/s, N s]"),
        ("in space", "In space a sweep limits friction by the disc of the new J_n.",
         "state after a sweep in space [m/s, rad/s, N s]"),
        ("turns", "A free body of a pile obeys Euler's equation.", "angular velocity [rad/s]"),
        ("judge of cones", "The residual finds too much friction, and too little.", "residual with friction [m/s]"),
        ("kept", "A contact takes over the impulse of the nearest old one between the same two bodies.",
         "impulses that are kept [N s]"),
        ("spring", "A soft contact is an implicit Euler step of a damped spring.", "impulse of a soft contact [m/s]"))
    return [agreement(claim, f"largest error of the {quantity}", worst[name], 1e-9)
            for name, claim, quantity in names] + [stops_in_a_substep(lesson)], None


def stops_in_a_substep(lesson):
    """The Finding on a disc and a sphere that reach their floor in the middle of the last of three substeps.

    A contact with a gap lets them close it, which takes half of their velocity; there is no gravity.
    """
    found, r, h = [], 0.1, DT / 3.0
    for d, make, advance, bounds in ((2, lesson.make_pile_2d, lesson.advance_pile_2d, lesson.disc_bounds),
                                     (3, lesson.make_pile, lesson.advance_pile, lesson.ball_bounds)):
        up = np.eye(d)[-1]
        state, pile = make([(r + 2.5 * h) * up], [0.0] if d == 2 else [UPRIGHT], 1.0, 0.01 if d == 2 else [(0.01,) * 3],
                           [(r,) * d], [(*up, 0.0)], np.zeros(d), 0.3, 3, 30.0, 1.0, 0.1)
        end = advance(bounds, lesson.round_contacts, state._replace(v=np.stack((-up, 0.0 * up))), DT, 1, pile)
        found += [*(end.x[0] - r * up), *(end.v[0] + 0.5 * up)]
    return agreement("What comes with 1 m/s goes down to the floor and not into it: gaps are those of each substep.",
                     "places and velocities: largest error [m, m/s]", np.max(np.abs(found)), 1e-12)
