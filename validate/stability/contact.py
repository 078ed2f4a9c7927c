"""Convergence of stacks, depth of soft contacts, extreme inputs, and the laws of contact.

Contraction factors come from runs of the lesson's sweeps, never from its formulas.
*Source:* Young 1971 for the factors; Catto 2011 for soft contacts; each case derives what it adds.
"""

from typing import NamedTuple

import numpy as np
from numpy.linalg import matrix_power
from scipy.optimize import minimize_scalar
from scipy.spatial.transform import Rotation

from solutions.checks import BadInput, Diverged
from solutions.impulses import cross_2d
from solutions.support.lanes import colours_of
from solutions.support.scenes import HIGHEST
from validate.engines.contact import DT as ENGINE_DT
from validate.engines.contact import KINDS, MU, bullet_pile, fallen, pymunk_pile
from validate.reference.contact import enumerated, least_energy, natural_residual
from validate.stability.case import DOTS, EDGE, LINE, Picture, bisect, case, log_series, random_law, refuses, series

from ..engines.products import PYBULLET

G = 9.81                     # [m/s²]
THREE_DIGITS = 1e-3          # of the part that a sweep removes, 1 − ρ [-]
ROUND_OFF = 1e-12            # of numbers around 1 after a few hundred operations
DT = 1.0 / 240.0             # of piles [s]


def standing(masses):
    """Return (rows (n, n), inverse masses) of stacked bodies.

    Rows map velocities to relative velocities at contacts.
    """
    return np.eye(len(masses)) - np.eye(len(masses), k=-1), 1.0 / np.array(masses, float)


def column(masses):
    """Return (A, b, forces) of stacked bodies without friction, the first on the ground, with one contact under each.

    Contact k has the inverse masses of both its bodies, and is coupled to its neighbours through the body that they
    share: A_kk = 1/m_k + 1/m_(k−1),  A_k,k+1 = −1/m_k.  Gravity makes only the lowest contact approach, and k
    carries all above.
    """
    rows, w = standing(masses)
    return (rows * w) @ rows.T, -G * np.eye(w.size)[0], G * np.cumsum(1.0 / w[::-1])[::-1]


def errors_of(lesson, masses, omega, sweeps):
    """Return the relative error of the forces before the first sweep and after each, starting from zero."""
    A, b, forces = column(masses)
    lam, errors = np.zeros(len(b)), [1.0]
    for _ in range(sweeps):
        lam = lesson.gauss_seidel_sweep(A, b, lam, omega)
        errors.append(np.linalg.norm(lam - forces) / np.linalg.norm(forces))
    return np.array(errors)


def sweeps_until(errors, small):
    """Return the number of sweeps after which the error is at most `small`."""
    return int(np.argmax(errors <= small)) if errors[-1] <= small else np.inf


def largest(matrix):
    """Return the largest size of the eigenvalues of a matrix."""
    return np.max(np.abs(np.linalg.eigvals(matrix)))


# ---------------------------------------------------------------------------------------------- contraction

@case("contraction-of-a-stack", "Contraction of a sweep over a stack", compiled=False)
def contraction_of_a_stack(lesson, check):
    """Check that on n equal stacked bodies a sweep leaves cos²(π/2n) of the error, and so removes sin²(π/2n).

    The eigenvalues of a sweep are cos²((2j − 1)π/2n).  The second one decays by (cos²(3π/2n)/cos²(π/2n))ᵏ, of which
    1e-4 is left in the end.  Its effect on 1 − ρ is 8 times its share of the first error, which is below a ninth.
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
    check("Ten boxes need ln 10⁻³/ln ρ sweeps to a thousandth; the slow mode is nearly all of the first error.",
          "sweeps until the forces are right to 10⁻³, ten boxes [-]", law=theory, found=enough, within=0.05 * theory,
          saw=f"Ten boxes need {enough:.0f} sweeps: with 25 of them they do not stand.")
    fine = np.logspace(np.log10(2.0), 2.0, 60)
    return Picture("What a sweep does", "log₁₀ of the number of bodies", "log₁₀ of the part removed", [
        series("theory, sin²(π/2n)", np.log10(fine), 2.0 * np.log10(np.sin(0.5 * np.pi / fine)), LINE),
        log_series("measured", sizes, done, DOTS)],
        "Twice as many boxes need four times as many sweeps: each sweep passes a force only to neighbours.")


@case("contraction-of-a-mass-ratio", "Contraction of a sweep under a heavy body", compiled=False)
def contraction_of_a_mass_ratio(lesson, check):
    """Check that under a body r times as heavy as the one below it a sweep leaves r/(1 + r) of the error.

    For two contacts the error after the first sweep lies along one direction, so the ratio is exact from then on.
    The removed part, 1/(1 + r), is a small difference of errors, each rounded by 1.1e-16.
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
        log_series("measured", ratios, done, DOTS)],
        "From a ratio of 10 on, ten times the mass needs nearly ten times the sweeps; a light body on a heavy one "
        "converges fast.")


# ---------------------------------------------------------------------------------------------- sweeps that stop early

FRAME = 1.0 / 60.0           # [s], a step of the next three cases
PUSH = 0.2                   # share of an overlap that each step removes [-]
SAME = 1e-9                  # of two ways to compute a speed or an eigenvalue: round-off, over 1 − T at the worst [-]


def cornered(width, height):
    """Return (rows (4, 3), inverse masses) of a box of 1 kg with two corners on the ground: normal and tangent of each.

    u_n = v_y + ω r_x and u_t = −v_x + ω r_y, with r from its centre to the corner.
    """
    rows = [row for r_x in (-0.5 * width, 0.5 * width) for row in ((0.0, 1.0, r_x), (-1.0, 0.0, -0.5 * height))]
    return np.array(rows), np.array([1.0, 1.0, 12.0 / (width**2 + height**2)])


def left_by_sweeps(rows, w, m):
    """Return T, which maps velocities before m sweeps from zero to those after, if every contact pushes and sticks.

    A sweep solves with the lower triangle L of A = rows W rowsᵀ and keeps the rest: H = 1 − L⁻¹A.  After m of them the
    impulses are −(1 + H + … + H^(m − 1)) L⁻¹ u.
    """
    A = (rows * w) @ rows.T
    lower = np.linalg.inv(np.tril(A))
    H = np.eye(len(A)) - lower @ A
    S = sum((np.linalg.matrix_power(H, k) for k in range(m)), 0.0 * A) @ lower
    return np.eye(len(w)) - w[:, None] * (rows.T @ S @ rows)


def end_speeds(rows, w, m, pull):
    """Return the velocities at which the motion becomes steady: v = T (v + pull)."""
    T = left_by_sweeps(rows, w, m)
    return np.linalg.solve(np.eye(len(w)) - T, T @ pull)


def swept_speeds(sweep, rows, w, m, pull, remember=False):
    """Return the velocities after 400 steps, each with m calls of sweep(A, b, impulses)."""
    A, v, J = (rows * w) @ rows.T, np.zeros(len(w)), np.zeros(len(rows))
    for _ in range(400):
        v, J = v + pull, J if remember else 0.0 * J
        b = rows @ v
        for _ in range(m):
            J = sweep(A, b, J)
        v = v + w * (rows.T @ J)
    return v


@case("speed-of-sinking", "The speed at which a heavy body sinks", compiled=False)
def speed_of_sinking(lesson, check):
    """Compare the speed at which a heavy body sinks with g dt ρ^m/(1 − ρ^m).

    Each step adds g dt, and m sweeps from zero leave the fraction ρ^m of the approach.  The speed is exact for the
    upper one of two bodies.  In a stack each body has its own speed, (1 − T)⁻¹ T g dt.
    """
    sweep, dots = lambda A, b, J: lesson.gauss_seidel_sweep(A, b, J, 1.0), []
    for r, m in ((10.0, 5), (10.0, 20), (100.0, 20)):
        rho = r / (1.0 + r)
        law = G * FRAME * rho**m / (1.0 - rho**m)
        speed = -swept_speeds(sweep, *standing([1.0, r]), m, -np.full(2, G * FRAME))[1]
        dots.append((m, np.log10(speed)))
        check("A body that is r times as heavy as its support sinks at g dt ρ^m/(1 − ρ^m), ρ = r/(1 + r).",
              f"speed of the heavy one, r = {r:g}, {m} sweeps per step [m/s]",
              law=law, found=speed, within=SAME * law,
              saw=f"{r:g} kg on 1 kg sink at {speed:.3g} m/s, because {m} sweeps are too few.")
    ten, pull = standing(np.ones(10)), -np.full(10, G * FRAME)
    theory, speeds = -end_speeds(*ten, 25, pull), -swept_speeds(sweep, *ten, 25, pull)
    for k, name in ((9, "top"), (0, "lowest")):
        check("In a stack of ten each box sinks at its own speed, (1 − T)⁻¹ T g dt.",
              f"speed of the {name} of ten boxes, 25 sweeps per step [m/s]",
              law=theory[k], found=speeds[k], within=SAME * theory[k],
              saw=f"The {name} of ten boxes sinks at {speeds[k]:.3f} m/s.")
    remembered = -swept_speeds(sweep, *ten, 25, pull, remember=True)[9]
    check("With memory the forces accumulate over the steps, and finally nothing sinks.",
          "speed of the top of ten boxes, 25 sweeps per step and memory [m/s]",
          law=0.0, found=remembered, within=ROUND_OFF,
          saw=f"With memory the top box sinks at {abs(remembered):.1e} m/s.")
    fine = np.arange(3.0, 41.0)
    return Picture("How fast the heavy one sinks", "sweeps per step", "log₁₀ of the speed [m/s]", [
        *(series(f"theory, ratio {r:g}", fine, np.log10(G * FRAME / ((1.0 + 1.0 / r) ** fine - 1.0)), LINE)
          for r in (10.0, 100.0)),
        series("measured", *zip(*dots, strict=True), DOTS)],
        "No law of contact is wrong: the solver stopped too early.  More sweeps, memory or more equal masses help.")


def trembling_step(sweep, m, state):
    """Return displacements over dt, velocities and impulses (30,) after a step of ten boxes with memory."""
    y, v, lam = np.split(state, 3)
    D, _ = standing(np.ones(10))
    b = D @ v + PUSH * (D @ y)
    for _ in range(m):
        lam = sweep(D @ D.T, b, lam, 1.0)
    v = v + D.T @ lam
    return np.concatenate((y + v, v, lam))


def trembling_matrix(m):
    """Return the matrix of such a step by theory, as long as all boxes push."""
    D, _ = standing(np.ones(10))
    A, one, zero = D @ D.T, np.eye(10), np.zeros((10, 10))
    kept = np.linalg.matrix_power(one - np.linalg.inv(np.tril(A)) @ A, m)
    answer = (kept - one) @ np.linalg.inv(A)
    lam = np.hstack((PUSH * answer @ D, answer @ D, kept))
    v = np.hstack((zero, one, zero)) + D.T @ lam
    return np.vstack((np.hstack((one, zero, zero)) + v, v, lam))


def differences(step, rest, size=1.0):
    """Return the matrix of a step about a state at rest, column by column."""
    base = step(rest)
    return np.stack([(step(rest + size * unit) - base) / size for unit in np.eye(len(rest))], axis=1)


@case("trembling", "A stack that trembles", compiled=False)
def trembling(lesson, check):
    """Compare the growth of disturbances of a stack with memory with the largest eigenvalue of a matrix.

    Memory keeps a push after its overlap has gone.  One step multiplies displacements, velocities and impulses by
    one matrix, and if its largest eigenvalue is above 1 the stack trembles.

    Theory gives the matrix with H = 1 − L⁻¹A of a sweep: λ → H^m λ + (H^m − 1) A⁻¹ (u + PUSH gap/dt).  The
    measured one comes from the lesson's sweeps, column by column, far from where they clamp impulses.
    """
    few, rest = np.array([4, 7, 8, 12, 20]), np.repeat((0.0, 0.0, 1e3), 10)
    theory = {m: largest(trembling_matrix(m)) for m in few}
    measured = {m: largest(differences(lambda state, m=m: trembling_step(lesson.gauss_seidel_sweep, m, state), rest))
                for m in few}
    for m, verb in ((7, "trembles"), (8, "comes to rest")):
        check("If the memory keeps pushes and a gap counts like an overlap, ten boxes tremble with seven sweeps, "
              "but not with eight.",
              f"growth per step, {m} sweeps [-]", law=theory[m], found=measured[m], within=SAME,
              saw=f"With {m} sweeps a disturbance is multiplied by {measured[m]:.4f} per step: the stack {verb}.")
    return Picture("Ten boxes with memory and a push", "sweeps per step", "growth per step [-]", [
        series("theory, largest eigenvalue", few, theory.values(), LINE),
        series("measured", few, measured.values(), DOTS)],
        "Above 1 the stack trembles.  A sweep at rest after the motion removes the pushes from the memory.")


@case("creeping", "A box that creeps on a still platform", compiled=False)
def creeping(lesson, check):
    """Compare the creep of a box on a platform at rest with (1 − T)⁻¹ T g dt.

    A sweep visits the left corner first, so that corner takes more than its share.  The box rotates, and friction
    acts too late.  The errors of all steps add up to (1 − T)⁻¹ T g dt, along the floor as well.
    """
    box, few, theory, speeds = cornered(0.5, 1.0), (1, 2, 4, 8), {}, {}
    sweep = lambda A, b, J: lesson.cone_sweep(A, b, J, np.array([0.6, 0.6]))
    for degrees in (0.0, 15.0):
        pull = G * FRAME * np.array([np.sin(np.radians(degrees)), -np.cos(np.radians(degrees)), 0.0])
        theory[degrees] = {m: end_speeds(*box, m, pull)[0] for m in few}
        speeds[degrees] = {m: swept_speeds(sweep, *box, m, pull)[0] for m in few}
        for m in (1, 4):
            law, speed = theory[degrees][m], speeds[degrees][m]
            check("A box with enough friction creeps at (1 − T)⁻¹ T g dt, on a level floor, too.",
                  f"speed of a box with μ = 0.6 on {degrees:g}°, sweeps per step: {m} [m/s]",
                  law=law, found=speed, within=SAME * law,
                  saw=f"On {degrees:g}° it creeps at {1e3 * speed:.3g} mm/s; sweeps per step: {m}.")
        still = swept_speeds(sweep, *box, 1, pull, remember=True)[0]
        check("With memory the box stands, even with one sweep per step.",
              f"speed of a box with μ = 0.6 on {degrees:g}°, one sweep per step and memory [m/s]",
              law=0.0, found=still, within=ROUND_OFF, saw=f"On {degrees:g}° it moves at {abs(still):.1e} m/s.")
    return Picture("A box that should stand", "sweeps per step", "log₁₀ of its speed [m/s]", [
        series(f"{name}, {degrees:g}°", few, np.log10(list(found[degrees].values())), look)
        for found, name, look in ((theory, "theory", LINE), (speeds, "measured", DOTS)) for degrees in (0.0, 15.0)],
        "The platform does not move: the solver stops before the impulses of both corners agree.")


def sweep_radius(lesson, n, omega):
    """Return the spectral radius of a sweep over n equal bodies, far from where impulses are clamped."""
    A, b, forces = column(np.ones(n))
    return largest(differences(lambda lam: lesson.gauss_seidel_sweep(A, b, lam, omega), 10.0 * forces))


@case("over-relaxation", "The best relaxation", compiled=False)
def over_relaxation(lesson, check):
    """Check that at ω = 2/(1 + sin(π/2n)) a sweep leaves ω − 1 of the error, the optimum, and that ω = 2 diverges.

    All eigenvalues have the size ω − 1 from the best ω on.  There two of them are equal, so a rounding error of
    1e-12 (of forces ten times too large, up to 2,000 N) moves them by its square root, 1e-6, and a few times that
    with 20 bodies.
    """
    for n in (5, 10, 20):
        omega = 2.0 / (1.0 + np.sin(0.5 * np.pi / n))
        radius = sweep_radius(lesson, n, omega)
        check("At the best relaxation a sweep leaves ω − 1 of the error.",
              f"contraction factor at the best ω, n = {n} [-]", law=omega - 1.0, found=radius, within=1e-5,
              saw=f"With n = {n} and ω = {omega:.4f} a sweep leaves {radius:.5f} of the error.")
        best = minimize_scalar(lambda w, n=n: sweep_radius(lesson, n, w), bounds=(1.0, 1.99), method="bounded",
                               options={"xatol": 1e-7}).x
        check("No relaxation does better than ω = 2/(1 + sin(π/2n)).",
              f"relaxation that converges soonest, n = {n} [-]", law=omega, found=best, within=1e-5,
              saw=f"Of all relaxations {best:.5f} converges fastest for n = {n}.")
    edge = bisect(lambda w: sweep_radius(lesson, 10, w) > 1.0, 1.0, 3.0)
    check("From ω = 2 on no sweep converges: the product of all eigenvalues is (1 − ω)ⁿ.",
          "relaxation from which a sweep does not contract, n = 10 [-]", law=2.0, found=edge, within=4.0 * EDGE,
          saw=f"For ten bodies the sweeps diverge from ω = {edge:.6f} on.")
    omega, sweeps = 2.0 / (1.0 + np.sin(0.05 * np.pi)), np.arange(0.0, 101.0)
    plain, relaxed = errors_of(lesson, np.ones(10), 1.0, 100), errors_of(lesson, np.ones(10), omega, 60)
    fewer, more = sweeps_until(relaxed, 1e-3), sweeps_until(errors_of(lesson, np.ones(10), 1.0, 320), 1e-3)
    return Picture("Ten bodies: forces from zero", "sweeps", "log₁₀ of the error of the forces", [
        series("theory, ω = 1", sweeps, 2.0 * sweeps * np.log10(np.cos(0.05 * np.pi)), LINE),
        series("ω = 1", sweeps[::5], np.log10(plain[::5]), DOTS),
        series(f"ω = {omega:.3f}", sweeps[:61:3], np.log10(np.maximum(relaxed[::3], 1e-16)), DOTS)],
        f"To a thousandth of the first error, relaxation reduces {more:.0f} sweeps to {fewer:.0f}, at no cost.")


# ---------------------------------------------------------------------------------------------- piles

class Shape(NamedTuple):
    """Names of the lesson's functions that make and move piles of one shape."""
    make: str
    advance: str
    bounds: str
    contacts: str


DISC = Shape("make_pile_2d", "advance_pile_2d", "disc_bounds", "round_contacts")
BOX = Shape("make_pile_2d", "advance_pile_2d", "box_bounds_2d", "box_contacts_2d")
BALL = Shape("make_pile", "advance_pile", "ball_bounds", "round_contacts")
CUBE = Shape("make_pile", "advance_pile", "box_bounds", "box_contacts")
UPRIGHT = (1.0, 0.0, 0.0, 0.0)


def pile_of(lesson, shape, x, half, masses, q=None, planes=None, **more):
    """Make (PileState, Pile) of bodies of one shape under gravity; they are upright and have a floor by default."""
    x = np.array(x, float)
    n, d = x.shape
    half, masses = np.broadcast_to(half, (n, d)).astype(float), np.broadcast_to(masses, n).astype(float)
    squares, up = half**2, np.eye(d)[-1]
    if d == 2:
        inertia = masses * (0.5 * squares[:, 0] if shape is DISC else np.sum(squares, axis=1) / 3.0)
        q = np.broadcast_to(0.0 if q is None else q, n).astype(float)
    else:
        around = 0.4 * squares if shape is BALL else (np.sum(squares, axis=1)[:, None] - squares) / 3.0
        inertia, q = masses[:, None] * around, np.tile(UPRIGHT if q is None else q, (n, 1))
    planes = np.array([(*up, 0.0)] if planes is None else planes, float)
    settings = {"mu": 0.5, "substeps": 4, "hertz": 240.0, "zeta": 10.0, "margin": 0.02, **more}
    return getattr(lesson, shape.make)(x, q, masses, inertia, half, planes, 0.0 * up - G * up, **settings)


def after(lesson, shape, state, pile, seconds, dt=DT):
    """Return the PileState after this time [s]."""
    advance, bounds, contacts = (getattr(lesson, name) for name in shape[1:])
    return advance(bounds, contacts, state, dt, round(seconds / dt), pile)


def upper_of(contacts, n):
    """Return the upper body of each contact of a column of n bodies; the floor is body n."""
    return np.where(contacts.b == n, contacts.a, np.maximum(contacts.a, contacts.b))


def sag(lesson, shape, hertz, dt, substeps):
    """Return the depth [m] of one disc or box after ¾ s."""
    state, pile = pile_of(lesson, shape, [(0.0, 0.5)], 0.5, 2.0, hertz=hertz, zeta=1.0, substeps=substeps)
    return 0.5 - after(lesson, shape, state, pile, 0.75, dt).x[0, 1]


@case("sag-of-a-soft-contact", "The depth of a soft contact", compiled=False)
def sag_of_a_soft_contact(lesson, check):
    """Check that a soft contact under a force F comes to rest at a depth of k_n F/(2π hertz)² for any step.

    A disc has k_n = 1/m and F = m g; a box on both corners k_n = 1/m + (w/2)²/I = 2.5/m at each, and F = m g/2.
    The remaining distance shrinks at a rate of s²/(h (1 + 2ζs + s²)), s = 2π hertz h, h the substep: 40/s and more,
    which leaves 1e-13 after ¾ s.  The position is rounded: 1.1e-16 of half a metre, over a depth of 50 µm, and
    some.
    """
    curves, hertzes, fine = [], np.array([30.0, 40.0, 50.0, 60.0, 70.0]), np.linspace(30.0, 70.0, 51)
    for name, shape, times in (("a disc", DISC, 1.0), ("a box", BOX, 1.25)):
        for dt, substeps in ((1.0 / 60.0, 4), (1.0 / 240.0, 1), (1.0 / 240.0, 4), (1.0 / 1000.0, 1)):
            theory = lambda hertz, times=times: times * G / (2.0 * np.pi * hertz) ** 2
            worst = np.max([abs(sag(lesson, shape, hertz, dt, substeps) / theory(hertz) - 1.0)
                            for hertz in (40.0, 70.0)])
            check("A soft contact sinks by k_n F/(2π hertz)² for any step.",
                  f"relative error of the depth of {name}, 1/{1.0 / dt:.0f} s in {substeps} [-]",
                  law=0.0, found=worst, within=2e-11,
                  saw=f"1/{1.0 / dt:.0f} s, divided by {substeps}: {name} sinks as predicted, to {worst:.0e}.")
        curves.append((series(f"theory, {name}", fine, 1e3 * times * G / (2.0 * np.pi * fine) ** 2, LINE),
                       series(name, hertzes, [1e3 * sag(lesson, shape, hertz, DT, 1) for hertz in hertzes], DOTS)))
    return Picture("How deep a soft contact sinks", "hertz [1/s]", "depth [mm]",
                   [curve for both in zip(*curves, strict=True) for curve in both],
                   "Twice the hertz gives a quarter of the depth. Smaller steps alone change nothing, but they allow "
                   "more hertz.")


def rest_of_a_stack(lesson, n, seconds):
    """Return (depths by theory (n,) [m], largest error of the depths [m], largest shift [m] or angle [rad])."""
    hertz, substeps, joints = 60.0, 2, np.arange(n)
    weights = (n - joints) * G
    law = np.where(joints == 0, 2.5, 5.0) * 0.5 * weights / (2.0 * np.pi * hertz) ** 2
    x = np.stack((np.zeros(n), joints + 0.5 - np.cumsum(law)), axis=1)
    state, pile = pile_of(lesson, BOX, x, 0.5, 1.0, hertz=hertz, zeta=1.0, substeps=substeps)
    contacts = after(lesson, BOX, state, pile, DT).contacts
    towards = np.where(contacts.n[:, 1:] > 0.0, 1.0, -1.0) * (0.0, 1.0)
    J = 0.5 * weights[upper_of(contacts, n), None] * DT / substeps * towards
    end = after(lesson, BOX, state._replace(contacts=contacts, J=J), pile, seconds)
    depths = 1.0 - np.diff(end.x[:n, 1], prepend=-0.5)
    return law, depths, max(np.max(np.abs(end.x[:n, 0])), np.max(np.abs(end.q)))


@case("stack-at-rest", "Stacks of ten and of a hundred at rest", compiled=False)
def stack_at_rest(lesson, check):
    """Check that n boxes of width w, started at rest with the depths and impulses of theory, do not move.

    Joint k, counted from 0 at the floor, carries (n − k) m g, half of it at each corner, and a corner sinks by k_n
    F/(2π hertz)².  Between two boxes k_n = 2/m + 2 (w/2)²/I = 5/m, at the floor half of that, because I = m w²/6.
    If that is the rest state of the pile, it moves by round-off only.  A depth is the difference of two positions
    of up to n m, each rounded, here and in the pile.  Sideways there is no restoring force: in each step four lever
    arms of half a metre are rounded to 1.1e-16 m.  A pile that is put down without an overlap sways first.
    """
    drawn = []
    for n, seconds in ((10, 0.5), (100, 0.1)):
        law, depths, moved = rest_of_a_stack(lesson, n, seconds)
        error, joints = np.max(np.abs(depths - law)), np.arange(1.0, n + 1.0)
        check("A joint of a stack is k_n F/(2π hertz)² deep, with half of the weight above it as F.",
              f"largest error of the depths of {n} joints after {seconds:g} s [m]",
              law=0.0, found=error, within=4.0 * np.spacing(float(n)),
              saw=f"The joints are {1e3 * law.min():.2f} to {1e3 * law.max():.2f} mm deep, to {error:.0e} m.")
        check("A stack at rest does not drift, neither sideways nor by turning.",
              f"largest way sideways or angle of {n} boxes in {seconds:g} s [m, rad]",
              law=0.0, found=moved, within=4.0 * seconds / DT * np.spacing(0.5),
              saw=f"In {seconds:g} s none of {n} boxes moves sideways or turns by more than {moved:.0e}.")
        drawn += [series(f"{n} boxes, theory", joints, 1e3 * law, LINE),
                  series(f"{n} boxes, measured", joints, 1e3 * depths, DOTS)]
    return Picture("How deep two stacks rest", "joint, from the floor", "depth [mm]", drawn,
                   "Each joint carries one box less than the one below it. The floor does not move, so the lowest "
                   "joint is half as deep as its load suggests.")


# ---------------------------------------------------------------------------------------------- a mass ratio

MILLION = 1e6


@case("mass-ratio-of-a-million", "A mass ratio of a million", compiled=False)
def mass_ratio_of_a_million(lesson, check):
    """Check that at a mass ratio of a million sweeps report failure and Murty's method needs two pivots.

    With ρ = r/(1 + r) the lower contact lacks r g ρ^(k−1) after k sweeps and the upper one ρ times that, which leaves
    the residual g ρᵏ: 0.95 g after 50,000.  The condition of A is 4 · 10⁶, so solving loses seven of sixteen
    digits: 1e-9.  The pile sweeps, too: it sinks, and is refused.
    """
    A, b, forces = column((1.0, MILLION))
    error = np.max(np.abs(lesson.solve_lcp(A, b) / forces - 1.0))
    check("A direct method is accurate at any mass ratio.", "relative error of the forces by Murty's method [-]",
          law=0.0, found=error, within=1e-9,
          saw=f"Murty's method is right to {error:.0e} at a mass ratio of a million.")
    sweeps_that_give_up(lesson, check)
    sweeps, rho = np.arange(201.0), MILLION / (1.0 + MILLION)
    return Picture("A million on one", "sweeps", "error of the forces, over their size [-]", [
        series("theory", sweeps, rho**sweeps, LINE),
        series("sweeps", sweeps[::20], errors_of(lesson, (1.0, MILLION), 1.0, 200)[::20], DOTS),
        series("Murty, at once", [0.0, 200.0], [error, error], LINE)],
        "After two hundred sweeps the error has not visibly changed; two pivots remove it.")


def sweeps_that_give_up(lesson, check):
    """Give sweeps and piles a mass ratio for which they need too many iterations."""
    A, b, _ = column((1.0, MILLION))
    with_tangents = np.kron(A, np.diag([1.0, 0.0])) + np.kron(np.diag(np.diag(A)), np.diag([0.0, 1.0]))
    words = refusal(lambda: lesson.solve_contacts(with_tangents, np.kron(b, [1.0, 0.0]), np.full(2, 0.5)))
    left = float(words.split(" = ")[1].split(":")[0]) if "residual" in words else 0.0
    law = G * (MILLION / (1.0 + MILLION)) ** 50_000
    check("Sweeps that have not converged end in an error that names their residual.",
          "residual in the refusal of the sweeps [m/s]",
          law=law, found=left, within=THREE_DIGITS * law,
          saw=f"After 50,000 sweeps the error names a residual of {left:.4f} m/s.")
    refused, tried = 0, ((1e6, 2, 120.0), (1e6, 16, 480.0), (1e4, 2, 120.0))
    for r, substeps, hertz in tried:
        pile = pile_of(lesson, BOX, [(0.0, 0.5), (0.0, 1.5)], 0.5, (1.0, r), substeps=substeps, hertz=hertz)
        refused += "sink into each other; the residual" in refusal(lambda pile=pile: after(lesson, BOX, *pile, 5.0))
    check.count("A pile whose light box cannot carry the heavy one ends in Diverged instead of a picture.",
                "piles that are refused", refused, len(tried),
                "piles end in Diverged with the residual of their contacts.")


def refusal(run):
    """Return the message of Diverged or BadInput, in which a run must end; none if it ends without an error."""
    try:
        run()
    except (Diverged, BadInput) as e:
        return str(e)
    return ""


# ---------------------------------------------------------------------------------------------- the highest hertz

NUDGE = 1e-4                 # velocity of the top of a tower [m/s]


class Tower(NamedTuple):
    """Bodies that stand on each other: k contacts, and d numbers that describe the velocities of all bodies."""
    normal: np.ndarray       # (k, d): what maps velocities to u_n of each contact
    along: np.ndarray        # (k, t, d) the same for the t components of u_t: 1 in the plane, 0 without friction
    inv_mass: np.ndarray     # (d,) [1/kg, 1/(kg m²)]
    order: list              # in which contacts are visited


def spread(numbered):
    """Return the numbers in the order of a pile: every fifth from the first on, every fifth from the second on, …"""
    return [k for first in range(5) for k in numbered[first::5]]


def column_of_discs(masses):
    """Return the Tower of discs in a column; contact k is below disc k, and velocities are v_y.

    A pile numbers contacts by bodies: that of the lowest body with its upper neighbour, with the floor, then upwards.
    """
    (rows, w), n = standing(masses), len(masses)
    return Tower(rows, np.zeros((n, 0, n)), w, spread([1, 0, *range(2, n)] if n > 1 else [0]))


def tower_of_boxes(n, wide=1.0):
    """Return the Tower of n equal boxes of 1 kg, 1 m high and `wide` m wide; velocities are v_x, v_y and ω of each.

    Contacts 2k and 2k + 1 are at the left and the right corner below box k.  A pile visits the right one first, but at
    the floor the left one.
    """
    normal, along = np.zeros((2, 2 * n, 3 * n))
    for k in range(2 * n):
        i, r_x = 3 * (k // 2), (-0.5, 0.5)[k % 2] * wide
        normal[k, i:i + 3], along[k, i:i + 3] = (0.0, 1.0, r_x), (1.0, 0.0, 0.5)         # u = v + ω × r, r_y = −½
        if i > 0:
            normal[k, i - 3:i], along[k, i - 3:i] = (0.0, -1.0, -r_x), (-1.0, 0.0, 0.5)  # the lower box, r_y = ½
    return Tower(normal, along[:, None], np.tile((1.0, 1.0, 12.0 / (1.0 + wide**2)), n),
                 spread([*[3, 2][:2 * n - 2], 0, 1, *(k for joint in range(2, n) for k in (2 * joint + 1, 2 * joint))]))


def tower_in_space(contacts, n, wide):
    """Return the Tower of n equal boxes of 1 kg, 1 m high and `wide` m wide both ways; velocities are v and ω of each.

    contacts: the ContactSet of a pile of such boxes, whose floor is body n.  Only which corners touch, and the order of
    the visits, are read from it.
    """
    k = contacts.a.size
    rows = np.zeros((k, 3, n + 1, 6))                    # of u in x, y and z; what does not move is left out below
    for body, sign in ((contacts.a, 1.0), (contacts.b, -1.0)):
        r = 0.5 * np.sign(contacts.p - np.outer(body + 0.5, (0.0, 0.0, 1.0))) * (wide, wide, 1.0)
        for axis, e in enumerate(np.eye(3)):             # e · (ω × r) = ω · (r × e)
            rows[np.arange(k), axis, body] += sign * np.column_stack((np.tile(e, (k, 1)), np.cross(r, e)))
    rows = rows[:, :, :n].reshape(k, 3, 6 * n)
    flat, up = 12.0 / (1.0 + wide**2), 6.0 / wide**2
    return Tower(np.sign(contacts.n[:, 2:]) * rows[:, 2], rows[:, :2], np.tile((1.0, 1.0, 1.0, flat, flat, up), n),
                 np.argsort(colours_of(contacts, n), kind="stable"))


def substep_matrix(tower, c, zeta):
    """Return M of one substep, for errors of (gaps, J_n, J_t, velocities), by theory; all push and stick.

    c is hertz times a substep, s = 2πc, and the substep is 1.
        the last impulses:      v += M⁻¹ (normalᵀ J_n + alongᵀ J_t)
        a soft sweep:           J_n += (−s gap/(2ζ + s) − u_n − k_n J_n/(s (2ζ + s)))/(k_n (1 + 1/(s (2ζ + s))))
        motion:                 gap += u_n
        a sweep at rest:        J_n −= u_n/k_n
        in both sweeps:         J_t −= u_t/k_t
    with k_n = row M⁻¹ rowᵀ, and for k_t the sum of that over the rows of `along`.  Each change of an impulse acts on v
    at once.
    """
    (normal, along, w, order), s = tower, 2.0 * np.pi * c
    (contacts, t, d), give = along.shape, 1.0 / (s * (2.0 * zeta + s))
    k_n, k_t = normal**2 @ w, np.sum(along**2 @ w, axis=1)
    errors = np.eye((2 + t) * contacts + d)              # all single errors at once, one in each column
    gap, J_n, J_t, v = np.split(errors, np.cumsum((contacts, contacts, t * contacts)))
    J_t = J_t.reshape(contacts, t, errors.shape[1])
    v = v + w[:, None] * (normal.T @ J_n + np.einsum("ktd,kte->de", along, J_t))
    for aim, soft in ((-s * gap / (2.0 * zeta + s), give), (0.0 * gap, 0.0)):
        for k in order:
            change = (aim[k] - normal[k] @ v - soft * k_n[k] * J_n[k]) / (k_n[k] * (1.0 + soft))
            hold = -(along[k] @ v) / k_t[k]
            J_n[k], J_t[k] = J_n[k] + change, J_t[k] + hold
            v = v + w[:, None] * (np.outer(normal[k], change) + along[k].T @ hold)
        gap = gap + (soft > 0.0) * (normal @ v)
    return np.concatenate((gap, J_n, J_t.reshape(t * contacts, errors.shape[1]), v))


def tower_pile(lesson, shape, n, wide, c):
    """Return (PileState, Pile) of n boxes of 1 kg, 1 m high and `wide` m wide, on each other, with a step of DT."""
    d = 2 if shape is BOX else 3
    x, half = np.zeros((n, d)), np.full(d, 0.5 * wide)
    x[:, -1], half[-1] = np.arange(n) + 0.5, 0.5
    return pile_of(lesson, shape, x, half, 1.0, substeps=1, hertz=c / DT)


def rest_in_space(lesson, n, wide, c):
    """Return (PileState, Pile, Tower) of n boxes in space that rest at the depths and with the forces of theory.

    A pile that settles turns and tilts its boxes a little, and then other corners touch.
    """
    state, pile = tower_pile(lesson, CUBE, n, wide, c)
    contacts = after(lesson, CUBE, state, pile, DT).contacts
    tower, upper = tower_in_space(contacts, n, wide), upper_of(contacts, n)
    forces, depths = 0.25 * (n - upper) * G, np.zeros(n)                 # of the four contacts below each box
    depths[upper] = tower.normal**2 @ tower.inv_mass * forces / (2.0 * np.pi * pile.hertz) ** 2
    state.x[:n, 2] -= np.cumsum(depths)
    J = DT * forces[:, None] * np.sign(contacts.n[:, 2:]) * (0.0, 0.0, 1.0)
    return state._replace(contacts=contacts, J=J), pile, tower


def sway_of_a_pile(lesson, shape, rest, pile, steps):
    """Return v_x of the top of a pile after each number of steps of one substep, over the push that it gets.

    What is left of the pile's own motion is measured without a push, and taken away.  Contacts are kept in a run of the
    pile, so each number of steps is a run of its own.
    """
    top, push = len(pile.half) - 1, np.zeros(rest.v.shape)
    push[top, 0] = NUDGE
    with_push = rest._replace(v=rest.v + push)
    ends = [[after(lesson, shape, begin, pile, k * DT).v[top, 0] for begin in (with_push, rest)] for k in steps]
    return -np.diff(ends)[:, 0] / NUDGE


def sway_by_theory(tower, c, steps):
    """Return the same by theory, for steps that are multiples of steps[0]."""
    few, left = matrix_power(substep_matrix(tower, c, 10.0), steps[0]), {}
    v_x = -3 * tower.along.shape[1]                      # of the top body, which has 3 velocities or 6
    error = np.eye(len(few))[v_x]
    for k in range(steps[0], steps[-1] + 1, steps[0]):
        error = few @ error
        left[k] = error[v_x]
    return np.array([left[k] for k in steps])


def measured_matrix(lesson, masses, c, zeta):
    """Return substep_matrix from the lesson's pile of discs: the effect of a step of one substep on single errors.

    Errors are a thousandth of the sag, and the step is so short that the sag is some 1/100 of a disc.
    """
    m, n = np.array(masses, float), len(masses)
    w, forces = 1.0 / m, G * np.cumsum(m[::-1])[::-1]
    sags = (w + np.append(0.0, w[:-1])) * forces / (2.0 * np.pi * c) ** 2            # times the square of the step
    h = np.sqrt(0.01 / np.max(sags))
    heights, still = np.cumsum(1.0 - h**2 * sags) - 0.5, np.zeros((n + 1, 2))
    state, pile = pile_of(lesson, DISC, np.stack((np.zeros(n), heights), axis=1), 0.5, m, substeps=1, hertz=c / h,
                          zeta=zeta, margin=0.2)
    contacts = after(lesson, DISC, state, pile, h, h).contacts
    upper, towards = upper_of(contacts, n), np.sign(contacts.n[:, 1])

    def step(errors):
        gaps, J, v = errors.reshape(3, n)
        x, v_all, J_all = 1.0 * state.x, 1.0 * still, np.zeros((n, 2))
        x[:n, 1], v_all[:n, 1] = heights + np.cumsum(gaps), v / h
        J_all[:, 1] = towards * (forces * h + J / h)[upper]
        end = after(lesson, DISC, state._replace(x=x, v=v_all, contacts=contacts, J=J_all), pile, h, h)
        J_end = np.zeros(n)
        J_end[upper] = towards * end.J[:, 1]
        return np.concatenate((np.diff(end.x[:n, 1], prepend=-0.5), J_end * h, end.v[:n, 1] * h))
    return differences(step, np.zeros(3 * n), 1e-3 * np.min(sags) * h**2)


@case("highest-hertz", "The highest stable hertz", compiled=False)
def highest_hertz(lesson, check):
    """Compare columns and a tower at the highest hertz with theory: no eigenvalue of a substep is above 1.

    Theory gives the matrix of a substep; the experiment perturbs gaps, impulses and velocities of a real column.
    With errors of a thousandth of the sag, which is 1/100 of a disc, differences are rounded to 1e-16/1e-5.  An
    error of 1e-9 is allowed for eigenvalues that may be double.
    In a tower of boxes friction keeps stresses that nothing removes: some eigenvalues are 1, and a measured one could
    hide there.  So its top gets a push, and its speed is compared.  Boxes sag and tilt, which theory leaves out:
    differences of 8e-4 (squares) and 1.4e-3 (twice as wide) of the push were measured.
    High towers of flat boxes sway more and more at less than the highest hertz.
    """
    left = lambda tower, c, zeta=10.0: largest(substep_matrix(tower, c, zeta))
    seen = lambda masses, c, zeta=10.0: largest(measured_matrix(lesson, masses, c, zeta))
    piles = (("five equal discs", np.ones(5), 10.0), ("twenty equal discs", np.ones(20), 10.0),
             ("twenty equal discs, ζ = 1", np.ones(20), 1.0), ("100 on 1", (1.0, 100.0), 10.0),
             ("10,000 on 1", (1.0, 1e4), 10.0))
    for name, masses, zeta in piles:
        rho = seen(masses, HIGHEST, zeta)
        check(f"At {HIGHEST} of the substep rate, the highest hertz that a pile accepts, columns of discs are stable.",
              f"part of an error that a substep leaves, {name} [-]",
              law=left(column_of_discs(masses), HIGHEST, zeta), found=rho, within=1e-7,
              saw=f"{HIGHEST} of the substep rate, {name}: a substep leaves {rho:.5f} of an error.")
    steps = np.arange(10, 121, 10)
    for wide, name in ((1.0, "squares"), (2.0, "boxes, twice as wide as high")):
        state, pile = tower_pile(lesson, BOX, 6, wide, HIGHEST)
        swayed = sway_of_a_pile(lesson, BOX, after(lesson, BOX, state, pile, 4.0), pile, steps)
        law = sway_by_theory(tower_of_boxes(6, wide), HIGHEST, steps)
        check(f"At {HIGHEST} of the substep rate a tower of six boxes sways as theory says, and less and less.",
              f"largest difference of the speed of the top of six {name}, over the push that it was given [-]",
              law=0.0, found=np.max(np.abs(swayed - law)), within=4e-3,
              saw=f"After 120 substeps the top of six {name} has {swayed[-1]:.3f} of its push, theory {law[-1]:.3f}.")
    fine, few = np.linspace(0.02, 0.4, 39), np.linspace(0.02, HIGHEST, 5)
    columns = [("10 equal discs", np.ones(10)), ("1,000 on 1", (1.0, 1e3))]
    return Picture("What a substep leaves of an error", "hertz times a substep", "part that is left", [
        *(series(f"theory, {name}", fine, [left(column_of_discs(m), c) for c in fine], LINE) for name, m in columns),
        *(series(f"theory, {name}", fine, [left(tower_of_boxes(*tower), c) for c in fine], LINE)
          for name, tower in (("10 squares", (10,)), ("13 boxes, twice as wide as high", (13, 2.0)))),
        *(series(name, few, [seen(m, c) for c in few], DOTS) for name, m in columns)],
        f"Above 1 a pile trembles or sways: towers of 10 squares from 0.308 on, of 13 flat boxes from 0.27 on, and "
        f"others of unequal masses sooner.  A pile accepts {HIGHEST}.  In the plane theory finds no tower of up to "
        "24 equal boxes, one to ten times as wide as high, that sways more and more at 0.25.")


def swaying_from(tower):
    """Return hertz times a substep [-] from which a tower sways more and more, by theory; NaN if it is above ½."""
    edge = bisect(lambda c: largest(substep_matrix(tower, c, 10.0)) > 1.0 + 1e-6, 0.02, 0.5, 1e-3)
    return edge if np.isfinite(edge) else np.nan


@case("highest-hertz-in-space", "The highest stable hertz of towers in space", compiled=False, in_quick=False)
def highest_hertz_in_space(lesson, check):
    """Compare the sway of towers of boxes in space with theory, and show from which hertz on it grows.

    The matrix of a substep is that of the plane, with four contacts between two boxes, two directions of friction in
    each, and for k_t the sum over both directions, as the lesson bounds it.  The top of a tower at rest gets a push.
    Boxes sag and tilt, which theory leaves out: differences of 1e-3 of the push were measured.
    """
    steps = np.array([20, 60, 120])
    for n, wide, c, name in ((4, 1.0, 0.2, "four cubes"), (4, 1.0, HIGHEST, "four cubes"), (5, 1.0, 0.25, "five cubes"),
                             (4, 2.0, 0.2, "four boxes, twice as wide as high")):
        rest, pile, tower = rest_in_space(lesson, n, wide, c)
        swayed, law = sway_of_a_pile(lesson, CUBE, rest, pile, steps), sway_by_theory(tower, c, steps)
        part = largest(substep_matrix(tower, c, 10.0))
        check("A tower of boxes in space sways as theory says, also where it sways more and more.",
              f"{name}, {c:g} of the substep rate: largest difference of the speed of the top, over the push that it "
              "got [-]", law=0.0, found=np.max(np.abs(swayed - law)), within=6e-3,
              saw=f"After 120 substeps at {c:g} of the substep rate the top of {name} has {swayed[-1]:.3f} of its "
                  f"push, theory {law[-1]:.3f}; a substep leaves {part:.4f} of an error.")
    tower = lambda n, wide: rest_in_space(lesson, n, wide, 0.1)[2]
    few = (3, 4, 5, 6, 8, 10, 12)
    many = ("½ m", 0.5), ("1 m: cubes", 1.0), ("4 m", 4.0)

    def edges(name, kind, tower_of):
        """Return a series of those towers of `few` boxes that have an edge at all."""
        found = {n: swaying_from(tower_of(n)) for n in few}
        return series(name, *zip(*((n, edge) for n, edge in found.items() if np.isfinite(edge))), kind)
    return Picture("From which hertz on a tower sways more and more, by theory", "boxes in the tower",
                   "hertz times a substep", [
        *(edges(f"in space, width {name}", DOTS, lambda n, wide=wide: tower(n, wide)) for name, wide in many),
        edges("in the plane, width 1 m", LINE, tower_of_boxes),
        series(f"{HIGHEST}, which a pile accepts", (few[0], few[-1]), (HIGHEST, HIGHEST), LINE)],
        "Above its point a tower never comes to rest.  In space the points lie lower than in the plane.  Towers of "
        f"cubes need less than {HIGHEST}, which a pile accepts: discs, balls and low towers come to rest there.")


# ---------------------------------------------------------------------------------------------- extremes

INSIDE = (                   # shape, centres [m] of bodies with half sizes of ½ m, their name
    (DISC, [(0.0, 0.5), (0.0, 0.5)], "coincident discs"), (BOX, [(0.0, 0.5), (0.0, 0.5)], "coincident boxes"),
    (DISC, [(0.0, 0.2), (0.1, 0.3)], "discs deep in each other"), (BOX, [(0.0, -2.0)], "a box deep in the floor"),
    (BOX, [(0.0, 0.5), (0.05, 0.6)], "boxes deep in each other"),
)
INSIDE_IN_SPACE = (
    (BALL, [(0.0, 0.0, 0.5), (0.0, 0.0, 0.5)], "coincident balls"),
    (BALL, [(0.0, 0.0, 0.2), (0.1, 0.0, 0.3)], "balls deep in each other"),
    (CUBE, [(0.0, 0.0, 0.5), (0.0, 0.0, 0.5)], "coincident cubes"), (CUBE, [(0.0, 0.0, -0.5)], "a cube in the floor"),
)


def slope(degrees, d):
    """Return a plane through the origin of d dimensions, rising along x."""
    normal = np.zeros(d)
    normal[0], normal[-1] = -np.sin(np.radians(degrees)), np.cos(np.radians(degrees))
    return np.append(normal, 0.0)


def parted(lesson, shape, x, looks, pause):
    """Return (largest height of a centre [m], remaining overlap [m]) of bodies that begin inside each other.

    They are observed this number of times, after a pause [s] each.
    """
    state, pile = pile_of(lesson, shape, x, 0.5, 1.0)
    highest = -np.inf
    for _ in range(looks):
        state = after(lesson, shape, state, pile, pause)
        highest = np.maximum(highest, np.max(state.x[:len(x), -1]))
    return highest, np.max(-state.contacts.gap, initial=0.0)


def sliding(lesson, shape, degrees, mu, seconds):
    """Return (speed [m/s] of a box or cube that was put on a slope, change of its angle [rad] or quaternion)."""
    d, half_turn = 2 if shape is BOX else 3, 0.5 * np.radians(degrees)
    plane = slope(degrees, d)
    q = 2.0 * half_turn if d == 2 else np.array([np.cos(half_turn), 0.0, -np.sin(half_turn), 0.0])
    end = after(lesson, shape, *pile_of(lesson, shape, [0.5 * plane[:d]], 0.5, 1.0, q, [plane], mu=mu), seconds)
    return np.linalg.norm(end.v[0]), end.q[0] - q


def wedges(lesson, check, shape, name, angles, within, within_from):
    """Put a disc or a ball between two walls without friction; return the mean forces over the weight.

    angles: {slope [°]: duration [s]};    within, within_from: as in Checks
    """
    d, means = 2 if shape is DISC else 3, []
    for degrees, seconds in angles.items():
        law = 0.5 / np.cos(np.radians(degrees))
        state, pile = pile_of(lesson, shape, [law * np.eye(d)[-1]], 0.5, 1.0,
                              planes=[slope(degrees, d), slope(-degrees, d)], mu=0.0)
        forces = np.linalg.norm(after(lesson, shape, state, pile, seconds).J, axis=1) * pile.substeps / DT / G
        means.append(np.mean(forces))
        check("In a wedge of slope θ each wall carries 1/(2 cos θ) weights.",
              f"force over the weight of a {name} at {degrees:g}° [-]", law=law,
              found=forces[np.argmax(np.abs(forces - law))] if forces.size == 2 else np.nan,
              within=within * law, within_from=within_from,
              saw=f"At {degrees:g}° the walls carry {' and '.join(f'{f:.4f}' for f in forces)} weights.")
    return means


def small_beside_large(lesson, shape, small, mass, seconds):
    """Return the largest displacement [m] of bodies of 1 cm and 1 kg beside one of 1 m and this mass, on a floor."""
    n, d = len(small) + 1, len(small[0])
    sizes = np.append(1.0, np.full(n - 1, 0.01))
    state, pile = pile_of(lesson, shape, [np.eye(d)[-1], *small], np.repeat(sizes[:, None], d, axis=1),
                          np.append(mass, np.ones(n - 1)), margin=0.002)
    return np.max(np.abs(after(lesson, shape, state, pile, seconds).x[:n] - state.x[:n]))


def wedge_picture(title, steepest, angles, means, sentence):
    """Draw the force on a wall as a function of its slope."""
    fine = np.linspace(0.0, steepest, round(steepest) + 1)
    return Picture(title, "slope of the walls [°]", "force over the weight [-]", [
        series("theory, 1/(2 cos θ)", fine, 0.5 / np.cos(np.radians(fine)), LINE),
        series("measured", angles, means, DOTS)], sentence)


def carried(lesson, n, dt, **more):
    """Return the forces over the weight of one, (n,), under each box of a stack after 3 s."""
    x = np.stack((np.zeros(n), np.arange(n) + 0.5), axis=1)
    state, pile = pile_of(lesson, BOX, x, 0.5, 1.0, **more)
    end = after(lesson, BOX, state, pile, 3.0, dt)
    forces = np.zeros(n)
    for a, b, J in zip(end.contacts.a, end.contacts.b, end.J, strict=True):
        forces[0 if b >= n else max(a, b)] += abs(J[1]) * pile.substeps / dt / G
    return forces


@case("extremes", "Deep overlaps, slopes, wedges and other extremes", compiled=False)
def extremes(lesson, check):
    """Check deep overlaps, friction 0 and ∞, a wedge of 89° that carries 28 weights, sizes of 1 : 100, and long steps.

    Bodies of 1 m separate at 2.7 m/s at most.  Thrown up at that speed, one would rise by 0.37 m.  The second sweep,
    at rest, removes the speed within a substep: a tenth of it is allowed to bodies that separate while pushed.
    On a slope the contacts of a box are there from the first step: its speed is g sin θ t, or 0 with μ = ∞.
    In a wedge sweeps contract by cos² 2θ, slowest at 89°: there 6e-9 of the force was left after 3 s; 1e-7 is allowed.
    A small disc beside a large one sags by g/(2π hertz)² = 4.3 µm, and nothing else happens to it.
    A stack of five sways slightly in steps of 1/30 s: 1e-5 weights were measured, and ten times that is allowed.
    """
    left = 0.0
    for shape, x, name in INSIDE:
        highest, overlap = parted(lesson, shape, x, 120, 1.0 / 60.0)
        left = np.maximum(left, overlap)
        check("A body that begins inside another comes out, and is not ejected.",
              f"height of {name} above the place on top, at most [m]",
              law=0.0, found=np.maximum(0.0, highest - len(x) + 0.5), within=0.037,
              saw=f"With {name} nothing rises above {highest:.3f} m; {1e3 * overlap:.2f} mm of overlap remain.")
    check("After two seconds they overlap by no more than contacts sag.", "largest overlap that is left [m]",
          law=0.0, found=left, within=1e-4, saw=f"After two seconds {1e3 * left:.3f} mm of overlap are left.")
    for degrees, mu in ((5.0, 0.0), (40.0, 0.0), (80.0, 0.0), (5.0, np.inf), (40.0, np.inf)):
        speed, turned = sliding(lesson, BOX, degrees, mu, 0.5)
        check("Without friction a box slides at g sin θ t; with infinite friction it does not move.",
              f"speed after ½ s on a slope of {degrees:g}°, μ = {mu:g} [m/s]",
              law=0.0 if mu else 0.5 * G * np.sin(np.radians(degrees)), found=speed, within=1e-10,
              saw=f"On {degrees:g}° with μ = {mu:g} its speed is {speed:.4g} m/s; it turns by {turned:.0e} rad.")
    angles = {45.0: 0.5, 80.0: 1.0, 89.0: 3.0}
    means = wedges(lesson, check, DISC, "disc", angles, 1e-7,
                    within_from="sixteen times the rest of the force that the sweeps left at 89°, 6e-9")
    moved = small_beside_large(lesson, DISC, [(1.5 + 0.05 * k, 0.01) for k in range(5)], 1e4, 1.0)
    check("Discs of 1 cm beside one of 1 m, 10,000 times as heavy, sag like any other.",
          "largest way of a disc in 1 s, sizes 1 : 100 [m]", law=G / (480.0 * np.pi) ** 2, found=moved, within=1e-12,
          saw=f"They move by {1e6 * moved:.3f} µm.")
    error = np.max(np.abs(carried(lesson, 5, 1.0 / 30.0, substeps=8, hertz=72.0) - np.arange(5.0, 0.0, -1.0)))
    check("Steps of 1/30 s hold a stack, if they have substeps.",
          "largest error of the forces in a stack of five, over a weight [-]", law=0.0, found=error, within=1e-4,
          within_from="ten times the sway of this stack, 1e-5 weights",
          saw=f"With 1/30 s in 8 substeps the forces of five boxes are right to {error:.0e} of a weight.")
    refusals(lesson, check)
    return wedge_picture("A disc between two walls", 89.0, angles, means,
                         "Walls that are nearly upright carry many weights: a contact solver must find forces that no "
                         "single load has.")


def refusals(lesson, check):
    """Make calls with invalid contacts and piles."""
    at, half, still = [(0.0, 0.5)], [(0.5, 0.5)], np.zeros(2)
    pile = lambda **more: pile_of(lesson, DISC, **{"x": at, "half": half, "masses": 1.0, **more})
    move = lambda dt, **more: after(lesson, DISC, *pile(**more), 1.0, dt)
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
    check.count("Sizes and masses of zero, planes without a normal, hertz too high for a substep and contacts of two "
                "immovable bodies are refused, with their value.", "calls that name the value in their error",
                sum(refuses(call, (), value) for call, value in asked), len(asked),
                "such calls end in a sentence that names the value.")


@case("extremes-in-space", "Extremes in space", compiled=False, in_quick=False)
def extremes_in_space(lesson, check):
    """Check the same in space: deep overlaps, friction 0 and ∞ on a slope, a wedge, sizes of 1 : 100.

    The bounds are those of the plane.  A body that separates at 2.7 m/s would rise by 0.37 m; a tenth of that is
    allowed.  A ball in a wedge of 80° is held by 1/(2 cos θ) weights on each side; sweeps contract by cos² 2θ =
    0.88 there, and 7e-8 was left after a second: 1e-6 is allowed.  A ball of 1 cm beside one of 1 m sags by g/(2π
    hertz)².
    """
    for shape, x, name in INSIDE_IN_SPACE:
        highest, overlap = parted(lesson, shape, x, 10, 0.1)
        check("A body that begins inside another comes out, and is not ejected.",
              f"height of {name} above the place on top, at most, and overlap in the end [m]",
              law=0.0, found=np.maximum(0.0, highest - len(x) + 0.5) + overlap, within=0.037,
              saw=f"With {name} nothing rises above {highest:.3f} m; {1e3 * overlap:.2f} mm of overlap remain.")
    for mu in (0.0, np.inf):
        speed, _ = sliding(lesson, CUBE, 40.0, mu, 0.25)
        check("Without friction a cube slides at g sin θ t; with infinite friction it does not move.",
              f"speed after ¼ s on a slope of 40°, μ = {mu:g} [m/s]",
              law=0.0 if mu else 0.25 * G * np.sin(np.radians(40.0)), found=speed, within=1e-9,
              saw=f"On 40° with μ = {mu:g} its speed is {speed:.4g} m/s after ¼ s.")
    angles = {30.0: 0.5, 60.0: 0.5, 80.0: 1.0}
    means = wedges(lesson, check, BALL, "ball", angles, 1e-6,
                    within_from="fourteen times the rest of the force that the sweeps left at 80°, 7e-8")
    moved = small_beside_large(lesson, BALL, [(1.5, 0.0, 0.01), (0.0, 1.5, 0.01)], 1e6, 0.5)
    check("Balls of 1 cm beside one of 1 m, a million times as heavy, sag like any other.",
          "largest way of a ball in ½ s, sizes 1 : 100 [m]", law=G / (480.0 * np.pi) ** 2, found=moved, within=1e-11,
          saw=f"They move by {1e6 * moved:.3f} µm.")
    return wedge_picture("A ball between two walls", 85.0, angles, means,
                         "In space a ball is held by the same forces as a disc in the plane.")


# ---------------------------------------------------------------------------------------------- the judge

def judged_by_lesson(lesson, judged, mu):
    """Return (residual [m/s] of 9.9 for a Judged record in the plane, largest inverse mass times impulse [m/s])."""
    (x, v, omega, inv_mass, inv_inertia), (a, b, n, p, gap) = judged.bodies, judged.contacts
    contacts = fallen(KINDS["discs"], 1)[0].contacts._replace(a=a, b=b, n=n, p=p, gap=gap)
    rows = lesson.contact_rows(x, contacts)
    A = lesson.delassus_matrix(rows, lesson.inverse_masses(inv_mass, inv_inertia))
    J_n, J_t = np.sum(judged.J * n, axis=1), judged.J[:, 1] * n[:, 0] - judged.J[:, 0] * n[:, 1]
    J = np.stack((J_n, J_t), axis=1).ravel()
    u = rows @ np.column_stack((v, omega)).ravel()
    u[::2] += np.maximum(gap, 0.0) / ENGINE_DT                           # an open gap may close in this step
    return lesson.cone_residual(A, u - A @ J, J, np.full(len(a), mu)), np.max(np.diag(A)[::2] * J_n)


def normal_and_tangential(J, n):
    """Return (J_n (m,), |J_t| (m,)) of impulses."""
    J_n = np.sum(J * n, axis=1)
    return J_n, np.linalg.norm(J - J_n[:, None] * n, axis=1)


def steepest(judged):
    """Return the largest |J_t|/J_n of contacts that push with more than a thousandth of the mean."""
    J_n, J_t = normal_and_tangential(judged.J, judged.contacts[2])
    pushing = J_n > 1e-3 * np.mean(J_n)
    return np.max(J_t[pushing] / J_n[pushing])


def pymunk_pile_at_rest(lesson):
    """Return (times [s], residuals over g dt, the last record) of 30 discs that fall and come to rest in pymunk."""
    kind, seen = KINDS["discs"]._replace(across=6), []
    world = pymunk_pile(kind, *fallen(kind, 30), 200, 1e-3)
    for _ in range(12):
        world.run(60)
        seen.append(judged_by_lesson(lesson, world.judged(), MU)[0] / (G * ENGINE_DT))
    return 0.25 * np.arange(1.0, 13.0), seen, world.judged()


def converged_impulses(lesson, check, record, residual):
    """Judge a record of rest by the lesson's residual, by velocities alone, and with a tenth of the friction."""
    by_reference = natural_residual(*record, MU, ENGINE_DT) / (G * ENGINE_DT)
    strict = judged_by_lesson(lesson, record, 0.1 * MU)[0] / (G * ENGINE_DT)
    check("The impulses of a converged engine have no residual.",
          "residual of pymunk's impulses in 30 discs at rest, over g dt [-]", law=0.0, found=residual, within=1e-7,
          saw=f"pymunk's impulses have a residual of {residual:.0e} g dt after 3 s.")
    check("The residual without matrices is the same.", "residual by velocities alone, over g dt [-]",
          law=0.0, found=by_reference, within=1e-7, saw=f"Without matrices it is {by_reference:.0e} g dt.")
    check("Friction outside the cone is detected.",
          "judgements with a tenth of μ that find more than g dt/100 [of 1]", law=1, found=strict > 0.01, within=0.0,
          saw=f"Judged with μ = {0.1 * MU:g} the same impulses have a residual of {strict:.2f} g dt.")


def impulse_left_out(lesson, check, record):
    """Judge a record without its largest impulse."""
    _, largest_push = judged_by_lesson(lesson, record, MU)
    k = np.argmax(np.sum(record.J * record.contacts[2], axis=1))
    J = record.J * (np.arange(len(record.J)) != k)[:, None]
    left, _ = judged_by_lesson(lesson, record._replace(bodies=without_impulse(record, k), J=J), MU)
    check("Without the impulse of a contact the residual of the pile is at least that contact's k_n J_n.",
          "residual without the largest impulse, over k_n J_n, or 1 if that is less [-]",
          law=1.0, found=min(1.0, left / own_push(record, k)), within=1e-6,
          saw=f"Without it the residual is {left / (G * ENGINE_DT):.2f} g dt; "
              f"the largest k_n J_n is {largest_push / (G * ENGINE_DT):.2f} g dt.")


def disc_of_friction(lesson, check):
    """Let 12 spheres come to rest by the lesson's pile."""
    end = after(lesson, BALL, *fallen(KINDS["spheres"]._replace(across=2), 12), 0.5)
    J_n, J_t = normal_and_tangential(end.J, end.contacts.n)
    check("The pile in space keeps friction within the cone.",
          "largest |J_t| − μ J_n of 12 spheres, over the largest J_n [-]",
          law=0.0, found=max(0.0, np.max(J_t - MU * J_n)) / np.max(J_n), within=1e-12,
          saw="No contact of our 12 spheres has more friction than the cone allows.")


def pyramid_of_pybullet():
    """Let 27 spheres roll in pybullet; return what it says of friction, for Checks.by."""
    kind, slopes = KINDS["spheres"]._replace(across=3), []
    world = bullet_pile(kind, *fallen(kind, 27), 50)
    for _ in range(12):
        world.run(60)
        slopes.append(steepest(world.judged()))
    world.close()
    return {"law": np.sqrt(2.0), "found": np.max(slopes) / MU, "within": 0.01,
            "saw": f"pybullet's friction goes up to {np.max(slopes) / MU:.4f} μ times the normal force."}


@case("judge", "A judge for any solver, an engine's included", compiled=False)
def judge(lesson, check):
    """Check that the residual judges impulses and velocities of any solver.

    pymunk's impulses in a pile of discs at rest satisfy the laws to what its iterations leave, 1e-8 g dt after 3 s
    with 200 of them.  Judged with a tenth of the friction, a contact is outside the cone, and the residual exceeds
    round-off.

    Without its impulse a contact has the residual k_n J_n.  The residual is the largest of all, so it is at least
    that; a neighbour can have a slightly larger one, depending on the pile.  pybullet's friction acts along two
    directions, each up to μ J_n: √2 μ J_n along the diagonal.
    """
    times, seen, record = pymunk_pile_at_rest(lesson)
    converged_impulses(lesson, check, record, seen[-1])
    impulse_left_out(lesson, check, record)
    disc_of_friction(lesson, check)
    check.by(PYBULLET, "pybullet's friction is a pyramid: it reaches √2 μ along the diagonal.",
             "largest |J_t|/(μ J_n) of 27 spheres in pybullet [-]", pyramid_of_pybullet)
    return Picture("pymunk's impulses, judged", "time [s]", "log₁₀ of the residual over g dt", [
        series("30 discs, 200 iterations", times, np.log10(np.maximum(seen, 1e-16)), DOTS)],
        "While discs fall and roll, the impulses are not those of rest; then the residual falls to round-off.")


def levers(record, k):
    """Return (body, sign, lever arm) of both bodies of a contact in the plane."""
    x, (a, b, _, p, _) = record.bodies[0], record.contacts
    return [(i, sign, p[k] - x[i]) for i, sign in ((a[k], -1.0), (b[k], 1.0))]


def own_push(record, k):
    """Return k_n J_n [m/s] of a contact in the plane."""
    inv_mass, inv_inertia = record.bodies[3:]
    n = record.contacts[2][k]
    k_n = sum(inv_mass[i] + inv_inertia[i] * cross_2d(r, n) ** 2 for i, _, r in levers(record, k))
    return k_n * (record.J[k] @ n)


def without_impulse(record, k):
    """Return the bodies with the velocities that they would have without the impulse of contact k."""
    x, v, omega, inv_mass, inv_inertia = record.bodies
    v, omega = 1.0 * v, 1.0 * omega
    for i, sign, r in levers(record, k):
        v[i] += sign * inv_mass[i] * record.J[k]
        omega[i] += sign * inv_inertia[i] * cross_2d(r, record.J[k])
    return x, v, omega, inv_mass, inv_inertia


# ---------------------------------------------------------------------------------------------- closed forms

def relaxed_radius(A, omega):
    """Return the spectral radius of a sweep with over-relaxation: (D + ω L)⁻¹ ((1 − ω) D − ω U)."""
    D, L, U = np.diag(np.diag(A)), np.tril(A, -1), np.triu(A, 1)
    return largest(np.linalg.solve(D + omega * L, (1.0 - omega) * D - omega * U))


@case("closed-forms", "Contraction factors, the best relaxation, the disc of friction", compiled=False)
def closed_forms(lesson, check):
    """Compare spectral radii, the best ω and the disc of friction with independent computations.

    The radii come from the matrices of the sweep, the best ω from a search over ω, the disc from its variational law.
    At the best ω two eigenvalues meet, so the radius there is known to the square root of round-off only, 1e-8.
    P is the point of the disc nearest to J if no q of the disc has (J − P) · (q − P) > 0.
    """
    stacks = {n: column(np.ones(n))[0] for n in (2, 3, 5, 10, 20)}
    check.agree("The contraction of a stack is the spectral radius of a sweep.",
                "contraction of a stack: largest error [-]",
                np.max([abs(lesson.stack_contraction(n) - relaxed_radius(A, 1.0)) for n, A in stacks.items()]), 1e-12)
    check.agree("The contraction of a mass ratio is the spectral radius of a sweep.",
                "contraction of a mass ratio: largest error [-]",
                np.max([abs(lesson.mass_ratio_contraction(r) - relaxed_radius(column((1.0, r))[0], 1.0))
                        for r in (0.1, 1.0, 10.0, 1000.0)]), 1e-12)
    beyond, off = [0.0], [0.0]
    for n, A in stacks.items():
        omega, rho = lesson.best_relaxation(np.cos(0.5 * np.pi / n) ** 2)
        radius = relaxed_radius(A, omega)
        beyond.append(radius - min(relaxed_radius(A, w) for w in np.linspace(1.0, 1.999, 800)))
        off.append(abs(radius - rho))
    check.agree("No relaxation does better than 2/(1 + √(1 − ρ)).", "radius beyond the best of a search [-]",
                np.max(beyond), 1e-7)
    check.agree("At the best relaxation a sweep leaves ω − 1 of the error.",
                "radius at the best relaxation: largest error [-]", np.max(off), 1e-7)
    nearest_of_the_disc(lesson, check)


def nearest_of_the_disc(lesson, check):
    """Compare the friction of random impulses with all points of the disc."""
    rng, off = np.random.default_rng(99), 0.0
    for _ in range(100):
        J, limit = rng.normal(size=3), rng.uniform(0.1, 2.0)
        P = np.array(lesson.friction_disc(tuple(J), limit))
        q = rng.normal(size=(50, 3))
        q *= (limit * rng.uniform(0.0, 1.0, 50) / np.linalg.norm(q, axis=1))[:, None]
        q = np.concatenate((q, [limit * J / np.linalg.norm(J)]))
        off = np.max((off, np.linalg.norm(P) - limit, np.max((q - P) @ (J - P)),
                      np.linalg.norm(P - J) if np.linalg.norm(J) <= limit else 0.0))
    check.agree("Friction is the point of the disc nearest to the impulse that would stick.",
                "largest violation of the law of the nearest point [N² s²]", max(off, 0.0), 1e-12)


# ---------------------------------------------------------------------- eight solvers of one pile

def hit_pile():
    """Return (A (32, 32), b (32,), μ (16,)) of ten discs in four layers under gravity, of which the top one is hit.

    Each contact gives a hundredth of its own effective inverse mass, so that A has an inverse and only one answer.
    No two contacts have the same friction.
    """
    x = np.array([(k + 0.5 * layer, 0.5 + np.sqrt(0.75) * layer) for layer in range(4) for k in range(4 - layer)])
    touching = [(i, -1) for i in range(4)] + [(i, j) for i in range(10) for j in range(i)
                                              if x[i, 1] > x[j, 1] + 0.1 and np.hypot(*(x[i] - x[j])) < 1.001]
    rows = np.zeros((2 * len(touching), 30))
    for k, (i, j) in enumerate(touching):
        n = x[i] - x[j] if j >= 0 else np.array([0.0, 1.0])
        t = np.array([-n[1], n[0]])
        for axis, row in ((n, 2 * k), (t, 2 * k + 1)):
            for body, side in ((i, 1.0), (j, -1.0)) if j >= 0 else ((i, 1.0),):
                rows[row, 3 * body:3 * body + 3] = *(side * axis), -0.5 * cross_2d(n, axis)
    v = np.tile((0.0, -G * FRAME, 0.0), (10, 1))
    v[-1] += (2.0, -3.0, 0.0)
    A = (rows * np.tile((1.0, 1.0, 8.0), 10)) @ rows.T
    return A + 0.01 * np.diag(np.diag(A)), rows @ v.ravel(), np.linspace(0.4, 0.2, len(touching))


def natural(A, b, J, mu):
    """Return the residual [m/s]: the largest change that a contact alone would make, times k."""
    alone = np.stack(pushes(J, A @ J + b, np.diag(A), mu), axis=1).ravel()
    return np.max(np.diag(A) * np.abs(alone - J))


def eight_solvers(lesson, A, b, mu):
    """Return {name: (step, work of a step in sweeps, steps)} of all but fewer_sweeps, which calls the sweep itself."""
    k, newton = np.diag(A), len(b) / 3.0 + 1.0           # elimination takes n³/3 multiplications, a sweep n²
    return {"Jacobi, r = 0.3/A": (lambda J: lesson.jacobi_step(A, b, J, mu, 0.3 / k), 1.0, 2000),
            "Gauss–Seidel, normals first": (lambda J: lesson.normals_first_sweep(A, b, J, mu), 1.0, 400),
            "cone sweep": (lambda J: lesson.cone_sweep(A, b, J, mu), 1.0, 400),
            "proximal map, r = 1.3/A": (lambda J: lesson.proximal_sweep(A, b, J, mu, 1.3 / k), 1.0, 400),
            "Newton, minimum map": (lambda J: lesson.minimum_map_step_with_friction(A, b, J, mu), newton, 30),
            "Newton, Fischer–Burmeister": (lambda J: lesson.fischer_burmeister_step(A, b, J, mu), newton, 30)}


def residuals_while_called(lesson, A, b, mu, calls):
    """Return the residuals after each sweep that fewer_sweeps asks for."""
    out = [natural(A, b, np.zeros(b.size), mu)]

    def watched(J):
        swept = lesson.cone_sweep(A, b, J, mu)
        out.append(natural(A, b, swept, mu))
        return swept
    lesson.fewer_sweeps(watched, np.zeros(b.size), calls)
    return np.array(out)


def iterates(step, J, steps):
    """Return J after 0, 1, … steps."""
    found = [J]
    for _ in range(steps):
        found.append(step(found[-1]))
    return np.array(found)


@case("eight-solvers", "Eight solvers of one pile", compiled=False)
def eight_solvers_of_one_pile(lesson, check):
    """Compare eight solvers of ten discs with friction by one residual, which is 0 where the laws hold.

    Seven end at round-off.  The convex relaxation ends at the largest μ |u_t| of *its* solution, because there a
    contact that slides opens at μ |u_t|; SciPy's active sets give this solution.
    """
    A, b, mu = hit_pile()
    curves = {}
    for name, (step, work, steps) in eight_solvers(lesson, A, b, mu).items():
        curves[name] = work, np.array([natural(A, b, J, mu) for J in iterates(step, np.zeros(b.size), steps)])
    curves["fewer sweeps"] = 1.0, residuals_while_called(lesson, A, b, mu, 400)
    for name, (_, residuals) in curves.items():
        check.agree("Seven solvers of a pile end at the same law.", f"residual at the end, {name} [m/s]",
                    residuals[-1], 1e-12)
    relaxed = iterates(lambda J: lesson.relaxed_sweep(A, b, J, mu), np.zeros(b.size), 1500)
    law = np.max(mu * np.abs(A @ least_energy(A, b, mu) + b)[1::2])
    curves["convex relaxation"] = 1.0, np.array([natural(A, b, J, mu) for J in relaxed[:401]])
    found = natural(A, b, relaxed[-1], mu)
    check("The convex relaxation misses the laws by μ |u_t| of the contact that slides fastest.",
          "residual at the end, convex relaxation [m/s]", law=law, found=found, within=1e-6 * law,
          saw=f"Its residual ends at {found:.6f} m/s, however long it runs.")
    steps_to_the_answer(lesson, check)
    floating_block(lesson, check)
    return Picture("Ten discs, of which the top one is hit", "work over that of one sweep",
                   "log₁₀ of the residual [m/s]", [
        series(name, work * np.arange(residuals.size)[:int(160 / work):max(1, int(8 / work))],
               np.log10(np.maximum(residuals, 1e-16))[:int(160 / work):max(1, int(8 / work))], DOTS)
        for name, (work, residuals) in curves.items()],
        "Newton's steps are expensive and few; sweeps are cheap and many.  One solver ends at another law.")


def steps_to_the_answer(lesson, check):
    """Check how Newton's two methods end on six contacts without friction, of which four push.

    φ is smooth at a solution at which each contact either pushes or opens.  There the error e of Newton's method obeys
    e' ≤ C e², so the digits double.  The minimum map is linear there: one step is exact.
    """
    rng = np.random.default_rng(17)
    half, truth = rng.normal(size=(6, 9)), np.array([1.0, 0.0, 0.7, 0.0, 0.4, 1.2])
    A = half @ half.T / 9.0
    b = np.where(truth > 0.0, 0.0, 0.5) - A @ truth

    def bent(lam):
        phi = np.array([lesson.fischer_burmeister(x, y) for x, y in zip(np.diag(A) * lam, A @ lam + b, strict=True)])
        return lam - np.linalg.solve(np.diag(phi[:, 1] * np.diag(A)) + phi[:, 2:] * A, phi[:, 0])
    errors = np.max(np.abs(iterates(bent, truth + 0.02 * rng.uniform(-1.0, 1.0, 6), 5) - truth), axis=1)
    kept = errors[1:] > 1e-14
    orders = np.log(errors[2:4] / errors[1:3]) / np.log(errors[1:3] / errors[:2])
    worst = np.max((errors[1:] / errors[:-1] ** 2)[kept])
    check("With Fischer's and Burmeister's function Newton's method converges with order 2.",
          "order of convergence, from three errors in a row [-]", law=2.0, found=orders[0], within=0.35,
          saw=f"The error of a step is at most {worst:.2f}/(N s) times the square of the error before.")
    found = lesson.minimum_map_step(A, b, truth + 0.02 * rng.uniform(-1.0, 1.0, 6))
    check.agree("One step of the minimum map is exact where it is known which contacts push.",
                "error after one step of the minimum map [N s]", np.max(np.abs(found - truth)), ROUND_OFF)


def floating_block(lesson, check):
    """Run blocks on a belt under the given sweep of the relaxation, and compare with their gaps by theory.

    The cone's edge has the slope 1/μ.  In each step the velocity moves, at right angles to the impulse, to
    u_n + gap/dt = μ |u_t|; so the gap after every step is dt μ |u_t|.
    """
    for mu, speed, dt in ((0.3, 2.0, 0.01), (0.8, -5.0, 0.004)):
        gap, u_n, A = abs(speed) * dt, 0.0, np.diag([1.0, 1e-9])         # it falls; the belt hardly feels it
        for _ in range(50):
            J, b = np.zeros(2), np.array([u_n - G * dt + gap / dt, speed])
            for _ in range(60):
                J = lesson.relaxed_sweep(A, b, J, np.array([mu]))
            u_n += J[0] - G * dt
            gap += dt * u_n
        check("Under the convex relaxation a sliding block floats.",
              f"gap over μ |v| dt after 50 steps, μ = {mu}, v = {speed:g} m/s [-]", law=1.0,
              found=gap / (mu * abs(speed) * dt), within=1e-6, saw=f"It floats at {1e3 * gap:.3f} mm.")
        check.agree("The lesson predicts how high a sliding block floats.",
                    f"predicted gap over that of the run, less 1, μ = {mu}, v = {speed:g} m/s [-]",
                    abs(lesson.relaxed_gap(mu, speed, dt) / gap - 1.0), 1e-6)


# ---------------------------------------------------------------------------------------------- laws of contact

def four_contacts(lesson, rng):
    """Return (x, v, ω, ContactSet) of four bodies with four contacts in the plane."""
    x, v, n, p = rng.normal(size=(4, 4, 2))
    n /= np.linalg.norm(n, axis=1)[:, None]
    a, b = np.array([0, 0, 1, 2]), np.array([1, 3, 2, 3])
    return x, v, rng.normal(size=4), lesson.ContactSet(np.array([0, 2, 3, 4, 4]), a, b, n, p, np.zeros(4))


def tangents_of(n):
    """Return the tangents (m, 2) of normals."""
    return np.stack((-n[:, 1], n[:, 0]), axis=1)


@random_law("Rows times velocities are the relative velocities of the points.",
            "largest error of the relative velocity [m/s]", 1e-9)
def rows_of_contacts(lesson, rng):
    x, v, omega, contacts = four_contacts(lesson, rng)
    at = lambda body: v[body] + omega[body, None] * tangents_of(contacts.p - x[body])
    u = at(contacts.a) - at(contacts.b)
    along = [np.sum(axis * u, axis=1) for axis in (contacts.n, tangents_of(contacts.n))]
    return lesson.contact_rows(x, contacts) @ np.column_stack((v, omega)).ravel(), np.stack(along, axis=1)


@random_law("The Delassus matrix adds up over all coordinates.", "largest error of the matrix [1/kg]", 1e-9)
def delassus_matrix(lesson, rng):
    rows, w = rng.normal(size=(8, 12)), rng.uniform(0.5, 2.0, 12)
    return lesson.delassus_matrix(rows, w), sum(w_i * np.outer(g, g) for w_i, g in zip(w, rows.T, strict=True))


def contact_problem(rng):
    """Return (A (8, 8), b (8,)) of four contacts."""
    factor = rng.normal(size=(8, 8))
    return factor @ factor.T + 0.5 * np.eye(8), rng.normal(size=8)


@random_law("A sweep uses new impulses of earlier contacts, old ones of later contacts, and none pulls.",
            "largest error of the impulses of a sweep [N s]", 1e-9)
def sweep_of_normals(lesson, rng):
    A, b = contact_problem(rng)
    old, relaxation = rng.uniform(0.0, 1.0, 8), rng.uniform(0.5, 1.5)
    new = lesson.gauss_seidel_sweep(A, b, old, relaxation)
    mixed = np.tril(A, -1) @ new + np.triu(A) @ old + b
    return new, np.maximum(0.0, old - relaxation * mixed / np.diag(A))


@random_law("The direct solver finds the set of contacts that push.",
            "largest error of the impulses of the direct solver [N s]", 1e-9)
def direct_solver(lesson, rng):
    A, b = contact_problem(rng)
    size = 10.0 ** rng.uniform(-9.0, 3.0)                                # from dust to rocks
    return lesson.solve_lcp(A, size * b) / size, enumerated(A, b)


@random_law("The residual detects contacts that pull, approach, or push while they separate.",
            "largest error of the residual [m/s]", 1e-9)
def residual_of_normals(lesson, rng):
    A, b = contact_problem(rng)
    lam = rng.uniform(0.0, 1.0, 8)
    u = A @ lam + b
    return lesson.complementarity_residual(A, b, lam), np.max(np.abs(np.minimum(np.diag(A) * lam, u)))


def pushes(J, u, k, mu):
    """Return (J_n, J_t) that each contact alone would have: of J (2m,), u (2m,) and the diagonal k (2m,) of A."""
    n, t = slice(0, None, 2), slice(1, None, 2)
    limit = mu * np.maximum(0.0, J[n])
    return np.maximum(0.0, J[n] - u[n] / k[n]), np.clip(J[t] - u[t] / k[t], -limit, limit)


@random_law("A sweep with friction limits J_t by the new J_n, with the μ of each contact.",
            "largest error of the impulses with friction [N s]", 1e-9)
def sweep_with_friction(lesson, rng):
    A, b = contact_problem(rng)
    J, mu = rng.normal(size=8), rng.uniform(0.1, 1.0, 4)
    new = lesson.cone_sweep(A, b, J, mu)
    u = np.tril(A, -1) @ new + np.triu(A) @ J + b
    limited = np.where(np.arange(8) % 2, J, new)                         # J_t is limited by the new J_n
    J_n, _ = pushes(J, u, np.diag(A), mu)
    _, J_t = pushes(limited, u, np.diag(A), mu)
    return new, np.stack((J_n, J_t), axis=1)


@random_law("The residual detects too much friction, and too little.",
            "largest error of the residual with friction [m/s]", 1e-9)
def residual_with_friction(lesson, rng):
    A, b = contact_problem(rng)
    J, mu = rng.normal(size=8), rng.uniform(0.1, 1.0, 4)
    alone = np.stack(pushes(J, A @ J + b, np.diag(A), mu), axis=1).ravel()
    return lesson.cone_residual(A, b, J, mu), np.max(np.abs(alone - J) * np.diag(A))


def held_contacts(lesson, rng):
    """Return (x, v, ω, ContactSet), inverse masses and moments, rows, and the inverse masses of all coordinates."""
    x, v, omega, contacts = four_contacts(lesson, rng)
    inv_mass, inv_inertia = rng.uniform(0.5, 2.0, (2, 4))
    w = np.column_stack((inv_mass, inv_mass, inv_inertia)).ravel()
    return (x, v, omega, contacts), inv_mass, inv_inertia, lesson.contact_rows(x, contacts), w


@random_law("Arms and effective inverse masses are those of the rows.", "largest error of the arms [m, 1/kg]", 1e-9)
def arms(lesson, rng):
    (x, _, _, contacts), inv_mass, inv_inertia, rows, w = held_contacts(lesson, rng)
    held = lesson.arms_2d(x, inv_mass, inv_inertia, contacts)
    k = np.sum(w * rows * rows, axis=1)
    return ((held.r_a, held.r_b, held.k_n, held.k_t),
            (contacts.p - x[contacts.a], contacts.p - x[contacts.b], k[::2], k[1::2]))


@random_law("A sweep without a matrix changes all velocities as one contact after the other does.",
            "largest error of the state after a quick sweep [m/s, rad/s, N s]", 1e-9)
def quick_sweep(lesson, rng):
    (x, v, omega, contacts), inv_mass, inv_inertia, all_rows, w = held_contacts(lesson, rng)
    aim, give, J, mu = rng.normal(size=4), rng.uniform(0.0, 0.5, 4), rng.normal(size=(4, 2)), rng.uniform(0.1, 1.0)
    y, new = np.column_stack((v, omega)).ravel(), J.copy()
    axes = np.stack((contacts.n, tangents_of(contacts.n)), axis=1)
    for k, (axis, rows) in enumerate(zip(axes, all_rows.reshape(4, 2, 12), strict=True)):
        k_n, k_t = np.sum(w * rows * rows, axis=1)
        u_n, u_t = rows @ y
        J_n, J_t = axis @ J[k]
        J_n = max(0.0, J_n + (aim[k] - u_n - give[k] * k_n * J_n) / (k_n * (1.0 + give[k])))
        new[k] = np.array([J_n, np.clip(J_t - u_t / k_t, -mu * J_n, mu * J_n)]) @ axis
        y = y + w * (rows.T @ (axis @ (new[k] - J[k])))
    pile = lesson.Pile(inv_mass, inv_inertia, np.ones((4, 2)), np.zeros((0, 3)), np.zeros(2), mu, 1, 30.0, 1.0, 0.1)
    held = lesson.arms_2d(x, inv_mass, inv_inertia, contacts)
    swept = lesson.velocity_sweep_2d(v, omega, J.copy(), aim, give, contacts, held, pile)
    return (np.column_stack(swept[:2]), swept[2]), (y, new)


@random_law("In space a sweep limits friction by the disc of the new J_n.",
            "largest error of the state after a sweep in space [m/s, rad/s, N s]", 1e-9)
def sweep_in_space(lesson, rng):
    x, v, omega = rng.normal(size=(3, 2, 3))
    p, J, n = rng.normal(size=(3, 3))
    n /= np.linalg.norm(n)
    light, factors = rng.uniform(0.5, 2.0, 2), rng.normal(size=(2, 3, 3))
    turns = factors @ np.swapaxes(factors, 1, 2) + 0.5 * np.eye(3)
    aim, give, mu = rng.uniform((0.0, 0.0, 0.1), (0.5, 0.5, 1.0))

    signs = np.array([1.0, -1.0])
    levers = [sign * np.cross(p - place, np.eye(3)) for sign, place in zip(signs, x, strict=True)]       # u = … ω
    u = sum(signs[i] * v[i] + levers[i] @ omega[i] for i in range(2))
    K = sum(light[i] * np.eye(3) + levers[i] @ turns[i] @ levers[i].T for i in range(2))
    k_n = n @ K @ n
    J_n = max(0.0, J @ n + (aim - u @ n - give * k_n * (J @ n)) / (k_n * (1.0 + give)))
    stick = J - u / (np.trace(K) - k_n)
    J_t = stick - (stick @ n) * n
    new = J_n * n + min(1.0, mu * J_n / np.linalg.norm(J_t)) * J_t
    v_new = v + np.outer(signs * light, new - J)
    omega_new = np.array([omega[i] + turns[i] @ levers[i].T @ (new - J) for i in range(2)])

    contact = lesson.ContactSet(np.array([0, 1, 1]), np.array([0]), np.array([1]), n[None], p[None], np.zeros(1))
    held = lesson.arms_3d(x, light, turns, contact)
    swept = lesson.velocity_sweep(v.copy(), omega.copy(), J[None].copy(), np.array([aim]), np.array([give]), contact,
                                  held, light, turns, mu)
    return swept, (v_new, omega_new, new)


@random_law("A free body of a pile obeys Euler's equation.", "largest error of the angular velocity [rad/s]", 1e-9)
def free_turn(lesson, rng):
    omega, inv_moments, dt = rng.normal(size=3), rng.uniform(0.5, 2.0, 3), rng.uniform(0.01, 0.1)
    turn = Rotation.random(random_state=rng)
    axes, q = turn.as_matrix(), turn.as_quat()[[3, 0, 1, 2]]
    I = axes @ np.diag(1.0 / inv_moments) @ axes.T
    return (lesson.turn_freely(q[None], omega[None].copy(), inv_moments[None], dt)[0],
            omega - dt * np.linalg.solve(I, np.cross(omega, I @ omega)))


@random_law("A contact takes over the impulse of the nearest old one between the same two bodies.",
            "largest error of the impulses that are kept [N s]", 1e-9)
def kept_impulses(lesson, rng):
    near, sets = 0.5, []
    for m in (5, 6):                                                     # contacts now, and those of the step before
        b, p = rng.integers(1, 4, m), rng.uniform(0.0, 1.0, (m, 3))
        sets.append(lesson.ContactSet(np.array([0, m, m]), np.zeros(m, int), b, 0.0 * p, p, np.zeros(m)))
    now, old = sets
    J, truth = rng.normal(size=(6, 3)), np.zeros((5, 3))
    for k in range(5):
        away = np.where(old.b == now.b[k], np.linalg.norm(old.p - now.p[k], axis=1), np.inf)
        truth[k] = J[np.argmin(away)] if away.min() < near else 0.0
    return lesson.kept_impulses(now, old, J, near), truth


@random_law("A soft contact is an implicit Euler step of a damped spring.",
            "largest error of the impulse of a soft contact [m/s]", 1e-9)
def soft_contact(lesson, rng):
    hertz, zeta, dt, gap, u_0 = rng.uniform((5.0, 0.5, 0.001, 0.001, -1.0), (50.0, 5.0, 0.01, 0.01, 1.0))
    aim, give = lesson.soft_contact(-gap, hertz, zeta, dt)
    impulse = (aim - u_0) / (1.0 + give)                                 # k_n J of u = aim − give k_n J
    u, s = u_0 + impulse, 2.0 * np.pi * hertz
    force = -s * s * (-gap + dt * u) - 2.0 * zeta * s * u
    return (impulse, *lesson.soft_contact(gap, hertz, zeta, dt)), (dt * force, -gap / dt, 0.0)


@random_law("A step of Newton's method for the minimum map stops contacts at which u is the smaller number, and frees "
            "all others.", "largest error of a step of the minimum map [N s, m/s]", 1e-9)
def step_of_minimum_map(lesson, rng):
    """Where u < A_kk λ at the start, u is 0 afterwards; at all others λ is."""
    A, b = contact_problem(rng)
    A, before = A * rng.uniform(0.1, 10.0), rng.normal(size=8)
    after, pushes = lesson.minimum_map_step(A, b, before), A @ before + b < np.diag(A) * before
    return np.where(pushes, A @ after + b, after), np.zeros(8)


@case("laws-of-contact", "Laws of contact", compiled=False)
def laws_of_contact(lesson, check):
    """Compare rows, sweeps and complementarity with independent computations.

    The rows are checked by velocities of points, sweeps by triangular matrices, and complementarity by trying all sets
    of contacts.  A sweep takes new impulses for the contacts before, old ones for itself and those behind: tril(A) and
    triu(A).
    """
    check.laws(lesson, (rows_of_contacts, delassus_matrix, sweep_of_normals, direct_solver, residual_of_normals,
                        sweep_with_friction, arms, quick_sweep, sweep_in_space, free_turn, residual_with_friction,
                        kept_impulses, soft_contact, step_of_minimum_map), seed=9, times=50)
    stops_in_a_substep(lesson, check)


def stops_in_a_substep(lesson, check):
    """Drop a disc and a sphere that reach their floor in the middle of the last of three substeps, without gravity.

    A contact with a gap lets them close it, which takes half of their velocity.
    """
    found, r, h = [], 0.1, DT / 3.0
    for shape, d in ((DISC, 2), (BALL, 3)):
        up = np.eye(d)[-1]
        state, pile = pile_of(lesson, shape, [(r + 2.5 * h) * up], r, 1.0, mu=0.3, substeps=3, hertz=30.0, zeta=1.0,
                              margin=0.1)
        pile = pile._replace(gravity=0.0 * up)
        end = after(lesson, shape, state._replace(v=np.stack((-up, 0.0 * up))), pile, DT)
        found += [*(end.x[0] - r * up), *(end.v[0] + 0.5 * up)]
    check.agree("A body that arrives at 1 m/s stops on the floor and not in it: gaps are those of each substep.",
                "places and velocities: largest error [m, m/s]", np.max(np.abs(found)), 1e-12)
