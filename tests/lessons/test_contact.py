"""Lesson 9 is right when all contacts obey Signorini and Coulomb at once, a residual says how far they are from it,
and piles come to rest.
"""

import itertools
from decimal import Decimal, localcontext

import numpy as np
import pytest

from solutions.checks import BadInput, Diverged
from validate.grading.expect import between, choice, close, instance, raises, truth
from validate.reference import choices
from validate.reference.contact import enumerated, residual_of_relaxation

exercise = pytest.mark.exercise
G = 9.81                     # [m/s²]
# Everything drawn is below 10 in its unit.  A comparison takes a few dozen operations, each rounded by 1.1e-16 of that.
ROUND_OFF = 1e-12
SOLVED = 1e-9  # of forces that follow from a system with a condition below 1e4, or from sweeps until 1e-13
MIDDLE = np.array([0.0, 1.0])
SIZES = (1.0, 1e-20, 1e20)   # an ordinary case first: of what the laws are proportional to


def unit(draw):
    """A unit vector (2,) along no axis of the coordinates."""
    angle = draw(0.2, 1.3) + 0.5 * np.pi * draw.whole(0, 3)
    return np.array([np.cos(angle), np.sin(angle)])


def balanced(draw, m):
    """A drawn vector (m,) whose components add up to exactly 0, so that a short cut may take it for none."""
    first = draw(0.3, 1.0, m - 1)
    return np.append(first, -np.sum(first))


def contacts_of(lesson, a, b, p, n, gap=None, bodies=None):
    """A ContactSet ordered by a, of so many bodies that every number occurs; with `bodies`, greater ones are planes."""
    a, b = np.array(a, dtype=np.int64), np.array(b, dtype=np.int64)
    bodies = max(a.max(initial=0), b.max(initial=0)) + 1 if bodies is None else bodies
    first = np.searchsorted(a, np.arange(bodies + 1)).astype(np.int64)
    return lesson.ContactSet(first, a, b, np.array(n, float), np.array(p, float),
                             np.zeros(len(a)) if gap is None else np.array(gap, float))


def scene(draw, lesson, fixed=True):
    """(x, inverse masses, inverse inertias, ContactSet): four drawn bodies and five contacts.

    fixed: the last body is fixed, and number 1 cannot turn; with "axle" that one can do nothing else.  With "axles" all
    can turn, and numbers 1 and 2, which touch, can do nothing else.
    """
    a, b = [0, 0, 1, 2, 3], [1, 3, 2, 3, 0]
    p, n = draw(-2.0, 2.0, (5, 2)), [unit(draw) for _ in a]
    n[draw.whole(0, 4)] = np.array([1.0, -1.0]) / np.sqrt(2.0)           # its components add up to exactly 0
    inv_mass, inv_inertia = draw(0.3, 2.0, 4), draw(0.5, 5.0, 4)
    if fixed == "axles":
        inv_mass[1:3] = 0.0
    elif fixed:
        inv_mass[3] = inv_inertia[3] = (inv_mass if fixed == "axle" else inv_inertia)[1] = 0.0
    return draw(-2.0, 2.0, (4, 2)), inv_mass, inv_inertia, contacts_of(lesson, a, b, p, n, draw(-0.5, 0.5, 5))


def velocities_at(x, c, v):
    """Relative velocities (m, 2) of all contacts in x and y, from (v_x, v_y, ω) (n, 3) of all bodies."""
    def point(body):
        r = c.p - x[body]
        return v[body, :2] + v[body, 2:] * np.stack((-r[:, 1], r[:, 0]), axis=1)
    return point(c.a) - point(c.b)


def rows(x, c):
    """G (2m, 3n), column by column: move one coordinate of one body, and look at all contacts."""
    def column(k):
        v = np.zeros(3 * len(x))
        v[k] = 1.0
        u = velocities_at(x, c, v.reshape(-1, 3))
        return np.stack((np.sum(c.n * u, axis=1), c.n[:, 0] * u[:, 1] - c.n[:, 1] * u[:, 0]), axis=1).ravel()
    return np.stack([column(k) for k in range(3 * len(x))], axis=1)


def masses_of(inv_mass, inv_inertia):
    return np.stack((inv_mass, inv_mass, inv_inertia), axis=1).ravel()


def chain(masses):
    """(A, b, forces): bodies above each other on the ground, contact k under body k, b from gravity."""
    w, n = 1.0 / np.array(masses, float), len(masses)
    A = np.diag(w + np.append(0.0, w[:-1])) - np.diag(w[:-1], 1) - np.diag(w[:-1], -1)
    b = np.zeros(n)
    b[0] = -G
    return A, b, G * np.cumsum(np.array(masses, float)[::-1])[::-1]


def positive_definite(draw, m):
    """A (m, m) with eigenvalues from about 0.5 to 10."""
    half = draw(-1.0, 1.0, (m, m))
    return half @ half.T + np.diag(draw(0.5, 1.5, m))


def half_turn(n):
    """ρ of a stack of n, by the double angle."""
    return 0.5 * (1.0 + np.cos(np.pi / n))


def contraction(A, b, solution, sweep, before=400, over=20):
    """Error after a sweep over error before, once the slowest part of the error is all that is left."""
    lam = np.zeros(len(b))
    for _ in range(before):
        lam = np.asarray(sweep(lam))
    early = np.linalg.norm(lam - solution)
    for _ in range(over):
        lam = np.asarray(sweep(lam))
    return (np.linalg.norm(lam - solution) / early) ** (1.0 / over)


# ---------------------------------------------------------------------------------------------- rows and matrix

@exercise("9.1", points=0.5,
          hint="each body adds sign · (d_x, d_y, r × d) in its three columns: + at a, − at b, for n and then for t")
def test_rows_turn_all_velocities_into_those_of_all_contacts(lesson, draw):
    for fixed in (False, True):
        x, _, _, c = scene(draw, lesson, fixed)
        v = draw(-3.0, 3.0, (4, 3))
        u = velocities_at(x, c, v)
        expected = np.stack((np.sum(c.n * u, axis=1), c.n[:, 0] * u[:, 1] - c.n[:, 1] * u[:, 0]), axis=1).ravel()
        got = np.asarray(lesson.contact_rows(x, c))
        close("shape of G [-]", got.shape, (10, 12), 0.0)
        close("G v: relative velocities, (n, t) of one contact after the other [m/s]", got @ v.ravel(), expected,
              ROUND_OFF)
        pairs = np.repeat(np.arange(5), 3)                               # three contacts of each pair of bodies
        many = contacts_of(lesson, c.a[pairs], c.b[pairs], draw(-2.0, 2.0, (15, 2)), [unit(draw) for _ in pairs])
        u = velocities_at(x, many, v)
        close("G v of several contacts of the same two bodies, only their normals [m/s]",
              (np.asarray(lesson.contact_rows(x, many)) @ v.ravel())[::2], np.sum(many.n * u, axis=1), ROUND_OFF)
        behind = lesson.ContactSet(np.zeros(1, np.int64), *(part[::-1].copy() for part in c[1:]))
        close("G v of the same contacts from the last to the first, as of make_contacts [m/s]",
              np.asarray(lesson.contact_rows(x, behind)) @ v.ravel(), expected.reshape(-1, 2)[::-1].ravel(), ROUND_OFF)
        n = np.array([(0.0, 1.0), (-1.0, 0.0), (0.0, -1.0), (1.0, 0.0), (0.0, 1.0)])
        upright = c._replace(n=n, p=x[c.a] - 0.5 * n)
        u = velocities_at(x, upright, v)
        close("G v where normals along the axes go through the centre of a [m/s]",
              np.asarray(lesson.contact_rows(x, upright)) @ v.ravel(),
              np.stack((np.sum(n * u, axis=1), n[:, 0] * u[:, 1] - n[:, 1] * u[:, 0]), axis=1).ravel(), ROUND_OFF)
        whole = np.array([[draw.whole(-3, 3), draw.whole(-3, 3)] for _ in range(4)], float)
        arm = draw.whole(1, 7) / 8.0 * np.array([1.0, -1.0])             # eighths add up without round-off
        slanted = c._replace(n=np.tile(np.array([1.0, -1.0]) / np.sqrt(2.0), (5, 1)))
        for what, some in (("normals whose components add up to 0", slanted),
                           ("arms whose components add up to 0", c._replace(p=whole[c.a] + arm)),
                           ("arms of b whose components add up to 0", c._replace(p=whole[c.b] - arm))):
            u, n = velocities_at(whole, some, v), some.n
            close(f"G v of {what} [m/s]", np.asarray(lesson.contact_rows(whole, some)) @ v.ravel(),
                  np.stack((np.sum(n * u, axis=1), n[:, 0] * u[:, 1] - n[:, 1] * u[:, 0]), axis=1).ravel(), 1e-11)
        for size in SIZES:
            got = np.asarray(lesson.contact_rows(size * x, c._replace(p=size * c.p)))
            close("G v where lengths are very small or large, over their size [1/s]",
                  got @ (v * [size, size, 1.0]).ravel() / size, expected, ROUND_OFF, given=f"size {size} m")


@exercise("9.1", points=0.125,
          hint="G has three columns for every body, also for one without a contact: its shape is (2m, 3n)")
def test_bodies_without_a_contact_have_columns_and_no_contacts_have_no_rows(lesson, draw):
    x, _, _, c = scene(draw, lesson)
    more = np.vstack((x, draw(-2.0, 2.0, (2, 2))))
    got = np.asarray(lesson.contact_rows(more, c))
    close("shape of G of six bodies, two of them without a contact [-]", got.shape, (10, 18), 0.0)
    close("entries for bodies without a contact [-]", got[:, 12:], np.zeros((10, 6)), 0.0)
    close("length of the part for translation [-]", np.linalg.norm(got.reshape(10, 6, 3)[:, :, :2], axis=(1, 2)),
          np.full(10, np.sqrt(2.0)), ROUND_OFF)
    none = contacts_of(lesson, [], [], np.zeros((0, 2)), np.zeros((0, 2)))
    close("shape of G of four bodies without any contact [-]", np.shape(lesson.contact_rows(x, none)), (0, 12), 0.0)


@exercise("9.1", points=0.375, hint="a contact depends on its own two bodies only, and not on a common motion of both")
def test_what_moves_as_one_body_has_no_relative_velocities(lesson, draw):
    x, _, _, c = scene(draw, lesson)
    got = np.asarray(lesson.contact_rows(x, c))
    spin, shift = draw(-3.0, 3.0), draw(-3.0, 3.0, 2)
    together = np.column_stack((shift[0] - spin * x[:, 1], shift[1] + spin * x[:, 0], np.full(4, spin)))
    close("G v of a common motion of all bodies [m/s]", got @ together.ravel(), np.zeros(10), ROUND_OFF)
    close("rows that have entries for more than two bodies [-]", np.count_nonzero(got, axis=1) > 6, np.zeros(10), 0.0)
    close("length of the part for translation [-]", np.sum(got[:, [0, 1, 3, 4, 6, 7, 9, 10]] ** 2, axis=1),
          np.full(10, 2.0), ROUND_OFF)


@exercise("9.2", points=0.5, hint="A = G M⁻¹ Gᵀ: scale the columns of G by w, then multiply by Gᵀ")
def test_a_unit_impulse_at_one_contact_is_felt_at_the_others(lesson, draw):
    for fixed in (False, True):
        x, inv_mass, inv_inertia, c = scene(draw, lesson, fixed)
        G_rows, w = rows(x, c), masses_of(inv_mass, inv_inertia)
        expected = np.array([[np.sum(G_rows[r] * w * G_rows[s]) for s in range(10)] for r in range(10)])
        for size in SIZES:
            close("Delassus matrix over the size of the inverse masses [-]",
                  np.asarray(lesson.delassus_matrix(G_rows, size * w)) / size, expected, ROUND_OFF,
                  given=f"size {size} 1/kg")
        close("Delassus matrix of the five normals only [1/kg]", lesson.delassus_matrix(G_rows[::2].copy(), w),
              expected[::2, ::2], ROUND_OFF)
        close("Delassus matrix of the rows in reverse order [1/kg]", lesson.delassus_matrix(G_rows[::-1].copy(), w),
              expected[::-1, ::-1], ROUND_OFF)
        many = draw(-1.0, 1.0, (40, 12))
        many[[7, 38]] = many[[3, 2]]
        close("Delassus matrix of forty rows, some of which are equal [1/kg]", lesson.delassus_matrix(many, w),
              np.sum(many[:, None] * w * many, axis=2), ROUND_OFF)
        for what, bodies, coordinates, factor in (("on a fixed axle", 0, np.s_[:2], 0.0),
                                                  ("very heavy", 1, np.s_[:], 1e-8),
                                                  ("fixed, as its neighbour", np.s_[2:], np.s_[:], 0.0),
                                                  ("fixed, as all others", np.s_[:], np.s_[:], 0.0)):
            changed = w.reshape(4, 3).copy()
            changed[bodies, coordinates] *= factor
            close(f"Delassus matrix with a body that is {what} [1/kg]",
                  lesson.delassus_matrix(G_rows, changed.ravel()),
                  np.sum(G_rows[:, None] * changed.ravel() * G_rows, axis=2), ROUND_OFF, given=f"w = {changed.ravel()}")


@exercise("9.2", points=0.5,
          hint="bodies couple their contacts: −1/m between neighbours of a stack, 1/m + 1/m on the diagonal")
def test_the_matrix_of_a_stack_is_tridiagonal(lesson, draw):
    n = draw.whole(3, 6)
    masses = draw(0.5, 3.0, n)
    c = contacts_of(lesson, np.arange(1, n + 1), np.arange(n), [(0.0, k) for k in range(n)], [MIDDLE] * n)
    x = np.array([(0.0, k - 0.5) for k in range(n + 1)])
    A = np.asarray(lesson.delassus_matrix(rows(x, c),
                                          masses_of(np.append(0.0, 1.0 / masses), np.append(0.0, draw(1.0, 5.0, n)))))
    close("shape of A [-]", A.shape, (2 * n, 2 * n), 0.0)
    close("normal rows and columns of A [1/kg]", A[::2, ::2], chain(masses)[0], ROUND_OFF, given=f"masses {masses} kg")


@exercise("9.3", points=0.25, hint="min(A_kk λ_k, u_k) of every contact; the largest of their sizes")
def test_each_way_to_break_the_law_counts_with_its_velocity(lesson, draw):
    for m, slow in itertools.product((draw.whole(3, 5), 1), (1.0, 1e-6, *SIZES[1:])):
        a, k, v = draw(0.5, 2.0, m), draw.whole(0, m - 1), slow * draw(0.5, 2.0)
        lam = slow * draw(0.5, 2.0, m) * np.array([draw.whole(0, 1) for _ in range(m)])
        u = np.where(lam > 0.0, 0.0, slow * draw(3.0, 5.0, m))
        for what, lam_k, u_k, expected in (("approaches", 0.0, -v, v), ("pushes and approaches", v, -3.0 * v, 3.0 * v),
                                           ("pulls", -v / a[k], 4.0 * v, v),
                                           ("pulls and approaches faster", -v / a[k], -3.0 * v, 3.0 * v),
                                           ("approaches and pulls harder", -3.0 * v / a[k], -v, 3.0 * v),
                                           ("pushes a little but separates", v / a[k], 4.0 * v,
                                            v), ("pushes but separates a little", 4.0 * v / a[k], v, v)):
            one, speeds = lam.copy(), u.copy()
            one[k], speeds[k] = lam_k, u_k
            close(f"residual where one contact {what} [m/s]",
                  lesson.complementarity_residual(np.diag(a), speeds - a * one, one), expected,
                  slow * ROUND_OFF, given=f"contact {k}, λ = {one} N s, u = {speeds} m/s")
        for u in v * np.array([(-1.0, 3.0), (1.0, -3.0), (3.0, -1.0), (-3.0, 1.0)]):
            lam = np.full(2, 5.0 * v)
            close("residual where one of two contacts that push separates, and one approaches [m/s]",
                  lesson.complementarity_residual(np.eye(2), u - lam, lam), 3.0 * v, slow * ROUND_OFF,
                  given=f"A = 1, λ = {lam} N s, u = {u} m/s")


@exercise("9.3", points=0.25, hint="at the solution every contact has λ = 0 or u = 0, and the residual is round-off")
def test_the_residual_vanishes_at_the_answer_and_nowhere_else(lesson, draw):
    for m in (4, 5, 4, 2, 1):
        scale = 10.0 ** draw(-1.5, 0.0, m)                               # light and heavy bodies side by side
        A, b = positive_definite(draw, m) * np.outer(scale, scale), draw(-3.0, 3.0, m) * scale
        lam = enumerated(A, b)
        for off in (draw(-2.0, 2.0, m) / scale, lam + draw(0.1, 1.0, m) / scale, np.zeros(m), balanced(draw, m),
                    -balanced(draw, m)):
            u = A @ off + b
            expected = max(abs(min(A[k, k] * off[k], u[k])) for k in range(m))
            close("residual beside the answer [m/s]", lesson.complementarity_residual(A, b, off), expected, ROUND_OFF,
                  given=f"A = {A}, b = {b}, λ = {off}")
        close("residual at the answer [m/s]", lesson.complementarity_residual(A, b, lam), 0.0, ROUND_OFF)
        off = draw(-2.0, 2.0, m) / scale
        close("residual where b is 0, but not λ [m/s]", lesson.complementarity_residual(A, 0.0 * b, off),
              np.max(np.abs(np.minimum(np.diag(A) * off, A @ off))), ROUND_OFF, given=f"A = {A}, λ = {off}")
        for k in range(m):                                               # one contact pulls, and all bodies separate
            pull = draw(0.5, 2.0) / A[k, k]
            close("residual where one contact pulls [m/s]",
                  lesson.complementarity_residual(A, np.abs(A[k]) * pull + 0.1, -pull * np.eye(m)[k]), A[k, k] * pull,
                  ROUND_OFF, given=f"A = {A}, contact {k}")


# ---------------------------------------------------------------------------------------------- sweeps

@exercise("9.4", points=0.5,
          hint="in order, each with the newest λ: λ_k − ω u_k/A_kk, never below 0; a lawful λ stays as it is")
def test_a_sweep_leaves_the_answer_and_corrects_what_is_wrong(lesson, draw):
    for n, omega in enumerate((1.0, *draw(0.5, 0.9, 2), *draw(1.1, 1.9, 6))):
        A, b = positive_definite(draw, 4), draw(-3.0, 3.0, 4)
        lam = enumerated(A, b)
        close("λ after a sweep from the answer [N s]", lesson.gauss_seidel_sweep(A, b, lam, omega), lam, 1e-11,
              given=f"ω = {omega}")
        lam, others = draw(-1.0, 2.0, 4) * (n % 3 > 0), [0, 2, 3]        # sweeps often begin from zero
        if n % 2:                                                        # a contact that is right already, exactly
            A[1, others] = A[others, 1] = 0.0
            A[1, 1], lam[1], b[1] = 2.0, 0.5, -1.0
        u, expected = A @ lam + b, lam.copy()
        for k in range(4):
            change = max(-expected[k], -omega * u[k] / A[k, k])
            expected[k] += change
            u = u + change * A[:, k]
        for size in SIZES:
            close("λ after a sweep, over its size [-]",
                  np.asarray(lesson.gauss_seidel_sweep(A, size * b, size * lam, omega)) / size, expected, 1e-11,
                  given=f"A = {A}, b = {size * b}, λ = {size * lam}, ω = {omega}")
    for m, omega, size in itertools.product((4, 30), (1.0, draw(0.01, 0.1), 10.0 ** draw(-6.0, -3.0)), SIZES):
        A, drawn = positive_definite(draw, m), draw(-3.0, 3.0, m)
        for lam, b in ((draw(-1.0, 2.0, m), drawn), (balanced(draw, m), drawn), (draw(-1.0, 2.0, m), np.zeros(m))):
            got = lesson.gauss_seidel_sweep(size * A, b, lam / size, omega)
            close("λ after a sweep, times the size of A [-]", np.asarray(got) * size, relaxed(A, b, lam, omega), 1e-11,
                  given=f"A = {size * A}, b = {b}, λ = {lam / size}, ω = {omega}")


def relaxed(A, b, lam, omega):
    """λ after a sweep with relaxation, with u kept up to date."""
    u, new = A @ lam + b, lam.copy()
    for k in range(len(lam)):
        change = max(-new[k], -omega * u[k] / A[k, k])
        new[k] += change
        u = u + change * A[:, k]
    return new


@exercise("9.4", points=0.5,
          hint="with ω = 2 each visit reverses the velocity of its contact: elastic impacts, one after the other")
def test_two_elastic_balls_and_a_wall_count_the_digits_of_pi(lesson, draw):
    """Galperin 2003: the ball at rest lies between the wall and one of 100^N times its mass;
    they meet exactly ⌊10^N π⌋ times in all.
    """
    for N, expected in ((0, 3), (1, 31), (2, 314)):
        m, speed = draw(0.5, 2.0), draw(0.5, 2.0)
        light, heavy = 1.0 / m, 1.0 / (100.0**N * m)
        A, u, impacts = np.array([[light + heavy, -light], [-light, light]]), np.array([-speed, 0.0]), 0
        for _ in range(400):
            lam = np.asarray(lesson.gauss_seidel_sweep(A, u, np.zeros(2), 2.0))
            # with equal masses the last is round-off
            u, impacts = A @ lam + u, impacts + np.count_nonzero(lam > 1e-6 * m * speed)
        close("number of impacts [-]", impacts, expected, 0.0, given=f"masses {m} and {100.0**N * m} kg")


@exercise("9.4", points=0.5,
          hint="use the impulses that this sweep has already changed; with the old ones it is Jacobi's method")
def test_the_error_shrinks_by_the_factor_of_theory(lesson, draw):
    n, r = draw.whole(5, 9), draw(5.0, 30.0)
    for name, masses, rho in (("a stack of equal bodies", [1.0] * n, half_turn(n)),
                              ("a heavy body on a light one", [1.0, r], 1.0 - 1.0 / (1.0 + r))):
        A, b, forces = chain(masses)
        got = contraction(A, b, forces, lambda lam, A=A, b=b: lesson.gauss_seidel_sweep(A, b, lam, 1.0), 60)
        close(f"contraction factor of {name} [-]", got, rho, 1e-3 * (1.0 - rho), given=f"masses {np.array(masses)}")


def iteration_matrix(A, omega):
    """Errors after a sweep of SOR from errors before it."""
    D, L = np.diag(np.diag(A)), np.tril(A, -1)
    return np.linalg.solve(D + omega * L, (1.0 - omega) * D - omega * np.triu(A, 1))


def spectral_radius(matrix):
    return np.max(np.abs(np.linalg.eigvals(matrix)))


@exercise("9.5", points=0.5, hint="cos²(π/(2n)); for n = 1 it is 0")
def test_a_stack_contracts_by_the_largest_eigenvalue(lesson, draw):
    heights = (draw.whole(4, 9), draw.whole(10, 40), 2, 3)               # of small ones many a wrong formula is right
    # All of them before the first comparison: a wrong formula may return 0 for every odd n, and 1 for every even n.
    for n, found in [(n, lesson.stack_contraction(n)) for n in heights]:
        close("contraction factor of a stack [-]", found,
              spectral_radius(iteration_matrix(chain(np.ones(n))[0], 1.0)), 1e-10, given=f"n = {n}")
    close("contraction factor of a single body [-]", lesson.stack_contraction(1), 0.0, ROUND_OFF)
    n = draw.whole(200, 300)
    A = chain(np.ones(n))[0]
    # The eigenvalues of Gauss–Seidel are the squares of Jacobi's. Scaled by the roots of D, that matrix is symmetric.
    jacobi = np.eye(n) - A / np.sqrt(np.outer(np.diag(A), np.diag(A)))
    close("contraction factor of a high stack [-]", lesson.stack_contraction(n),
          np.max(np.linalg.eigvalsh(jacobi)) ** 2, ROUND_OFF, given=f"n = {n}")
    for n in (draw.whole(10_000, 50_000), draw.whole(300_000, 900_000)):
        close("contraction factor of a very high stack [-]", lesson.stack_contraction(n), half_turn(n), ROUND_OFF,
              given=f"n = {n}")


@exercise("9.6", points=0.5, hint="r/(1 + r): a heavier upper body makes the convergence slower")
def test_a_heavy_body_on_a_light_one_contracts_slowly(lesson, draw):
    for r in (draw(2.0, 50.0), draw(0.01, 0.5), 1.0, 1e6, draw(1e-4, 1e-3), 10.0 ** draw(7.0, 9.0)):
        rho = spectral_radius(iteration_matrix(chain([1.0, r])[0], 1.0))
        close("1 − ρ of a body on another one [-]", 1.0 - lesson.mass_ratio_contraction(r), 1.0 - rho, ROUND_OFF,
              given=f"r = {r}")


    for r in (10.0 ** draw(-12.0, -7.0), 1.0 + draw(1e-6, 9e-6), 1.0 - draw(1e-6, 9e-6)):
        close("ρ over r of a very light body on another one, or of nearly equal ones [-]",
              lesson.mass_ratio_contraction(r) / r, 1.0 / (1.0 + r), 1e-9 if r > 0.5 else 1e-15 / r + 1e-9,
              given=f"r = {r}")


@exercise("9.7", points=0.5,
          hint="return a pair: ω = 2/(1 + √(1 − ρ)), where ρ is that of Gauss–Seidel, and ρ_ω = ω − 1")
def test_the_contraction_factor_at_the_best_relaxation_is_omega_minus_one(lesson, draw):
    """At the best ω two eigenvalues meet: their computed size is known to the root of round-off,
    1e-7 for these matrices.
    """
    for n in (draw.whole(3, 12), 2):
        omega, rho = lesson.best_relaxation(half_turn(n))
        close("best relaxation ω [-]", omega, 2.0 / (1.0 + np.sin(0.5 * np.pi / n)), ROUND_OFF, given=f"a stack of {n}")
        close("its contraction factor [-]", rho,
              spectral_radius(iteration_matrix(chain(np.ones(n))[0], 2.0 / (1.0 + np.sin(0.5 * np.pi / n)))), 1e-6,
              given=f"a stack of {n}")
    close("(ω, ρ_ω) where one sweep is enough [-]", lesson.best_relaxation(0.0), (1.0, 0.0), ROUND_OFF)
    for what, root in (("sweeps hardly help", 2.0**-5), ("sweeps hardly help", 2.0**-10),
                       ("sweeps hardly help", 2.0**-20), ("few sweeps are enough", 1.0 - 2.0**-12)):   # of 1 − ρ
        close(f"(ω, ρ_ω) where {what} [-]", lesson.best_relaxation(1.0 - root**2),
              (2.0 / (1.0 + root), (1.0 - root) / (1.0 + root)), ROUND_OFF, given=f"ρ = 1 − {root**2}")
    for rho in 10.0 ** draw(-11.0, -4.0, 4):                             # ω = 1 + ρ/4 + ρ²/8 + …
        close("(ω, ρ_ω) where the first sweep leaves very little [-]", lesson.best_relaxation(rho),
              (1.0 + rho / 4.0 + rho**2 / 8.0, rho / 4.0 + rho**2 / 8.0), ROUND_OFF, given=f"ρ = {rho}")


@exercise("9.7", points=0.5, hint="a little more or less relaxation must be slower")
def test_any_other_relaxation_is_slower(lesson, draw):
    masses = (np.ones(draw.whole(4, 12)), np.array([1.0, draw(3.0, 40.0)]))
    for A in (chain(m)[0] for m in masses):
        omega, best = lesson.best_relaxation(spectral_radius(iteration_matrix(A, 1.0)))
        # At the best ω two eigenvalues meet: their computed size is known to the root of round-off.
        close("contraction factor at the best ω [-]", spectral_radius(iteration_matrix(A, omega)), best, 1e-6,
              given=f"A = {A}")
        for other in (0.03, -0.03):
            between("contraction factor beside the best ω [-]", spectral_radius(iteration_matrix(A, omega + other)),
                    best + 0.01, 1.0, given=f"A = {A}")


# ---------------------------------------------------------------------------------------------- a direct solver

@exercise("9.8", points=0.125,
          hint="solve for the contacts that push, find the first contact that is wrong, change only that one, "
               "and repeat")
def test_the_direct_solver_finds_the_only_set_of_contacts_that_fits(lesson, draw):
    for b, expected in ((1.0, 0.0), (-1.0, 0.5)):       # it opens; it does not
        close("λ of a single contact [N s]", lesson.solve_lcp(np.array([[2.0]]), np.array([b])), [expected], ROUND_OFF,
              given=f"A = 2, b = {b}")
    for m in (5, 7, 3, 2, 1):
        for _ in range(4):
            A = positive_definite(draw, m)
            for b in (draw(-3.0, 3.0, m), *((balanced(draw, m), -balanced(draw, m)) if m > 1 else ())):
                close("λ [N s]", lesson.solve_lcp(A, b), enumerated(A, b), SOLVED, given=f"A = {A}, b = {b}")
    for little in (draw(1e-6, 1e-3), draw(2e-12, 9e-12)):  # the first contact alone leaves the second one too slow
        c = draw(0.2, 0.8)
        A, b = np.array([[1.0, c], [c, 1.0]]), np.array([-1.0, -c - little])
        close("λ where a second contact hardly pushes [N s]", lesson.solve_lcp(A, b), np.linalg.solve(A, -b), 1e-13,
              given=f"A = {A}, b = {b}")
    c = draw(0.9, 0.95)
    A, b = np.array([[1.0, c], [c, 1.0]]), np.array([-1.0, 1e-13 - c])
    close("λ where a second contact separates by round-off only [N s]", lesson.solve_lcp(A, b), (1.0, 0.0), SOLVED,
          given=f"A = {A}, b = {b}")
    close("λ where all separate [N s]", lesson.solve_lcp(positive_definite(draw, 3), draw(0.1, 3.0, 3)), np.zeros(3),
          0.0)


@exercise("9.8", points=0.125, hint="in each round change only the wrong contact of least index")
def test_the_direct_solver_ends_where_changing_all_wrong_contacts_goes_round_in_circles(lesson, draw):
    """From none, all contacts that are wrong at once would lead to 0, then to 1 and 2, and back.

    Row and column k of A and entry k of b may be scaled: no sign changes.
    """
    A = np.array([[1.0, -0.62, -0.76], [-0.62, 1.0, 0.97], [-0.76, 0.97, 1.0]])
    b = np.array([-2.4, 0.2, 1.6])
    for order, size in itertools.product(itertools.permutations(range(3)), SIZES):
        scale = size * draw(0.5, 2.0, 3)
        A_k, b_k = (A * np.outer(scale, scale))[np.ix_(order, order)], (scale * b)[list(order)]
        close("λ of three contacts over its size [-]", size * np.asarray(lesson.solve_lcp(A_k.copy(), b_k.copy())),
              size * enumerated(A_k, b_k), SOLVED, given=f"A = {A_k}, b = {b_k}")


@exercise("9.8", points=0.125,
          hint="in each round change the wrong contact of least index, not the one that is most wrong")
def test_the_direct_solver_ends_where_changing_the_most_wrong_contact_goes_round_in_circles(lesson, draw):
    """The least of all λ_k and u_k of wrong contacts leads back to a guess after some rounds, here and nearby."""
    A = np.array([[0.01755, -0.02031, 0.02175, -0.50998], [-0.02031, 0.08665, -0.76313, 1.13539],
                  [0.02175, -0.76313, 8.75274, -6.98248], [-0.50998, 1.13539, -6.98248, 19.66070]])
    b = np.array([-0.04589, 0.01006, 0.45900, 1.12469])
    C = np.array([[3, -4, -4], [-4, -4, -3], [3, 3, 3], [-3, -4, -3], [-3, 2, 4]], float)
    five = C @ C.T + 0.01 * np.eye(5), np.array([8.5, -8.5, 3.5, -7.5, -1.5])       # the least of all A_kk λ_k and u_k
    for order in itertools.islice(itertools.permutations(range(5)), 0, None, 17):
        A_k, b_k = five[0][np.ix_(order, order)], five[1][list(order)]
        close("λ of five contacts [N s]", lesson.solve_lcp(A_k.copy(), b_k.copy()), enumerated(A_k, b_k), 1e-7,
              given=f"A = {A_k}, b = {b_k}")
    for order in itertools.permutations(range(4)):
        near = 1.0 + draw(-1e-4, 1e-4, (4, 4))
        A_k, b_k = (A * near * near.T)[np.ix_(order, order)], (b * (1.0 + draw(-1e-4, 1e-4, 4)))[list(order)]
        close("λ of four contacts [N s]", lesson.solve_lcp(A_k.copy(), b_k.copy()), enumerated(A_k, b_k), 1e-7,
              given=f"A = {A_k}, b = {b_k}")


def many_guesses(m, size):
    L = np.triu(np.full((m, m), 2.0), 1) + np.eye(m)
    return L @ L.T, -size * np.ones(m)


@exercise("9.8", points=0.125,
          hint="count the rounds: after MAX_PIVOTS m of them raise Diverged with the residual of λ")
def test_the_direct_solver_gives_up_with_its_residual_after_many_rounds(lesson, draw):
    """L = 1 on the diagonal and 2 above it: least index first makes all 2ᵐ guesses for A = L Lᵀ, another order few.

    With eight contacts that is below MAX_PIVOTS m.  Only the last one pushes: A_kl = 2 there for all others, so its
    impulse of 1/A_ll = 1 separates them.
    """
    size = draw(0.5, 2.0)
    A, b = many_guesses(8, size)
    close("λ of eight contacts that need 256 guesses [N s]", lesson.solve_lcp(A.copy(), b.copy()),
          np.append(np.zeros(7), size), ROUND_OFF, given=f"A = {A}, b = {b}")
    A, b = many_guesses(10, size)
    scale = draw(0.8, 1.25, 10)                                          # no two guesses have the same residual
    A, b = A * np.outer(scale, scale), b * scale
    try:
        lam = lesson.solve_lcp(A.copy(), b.copy())
    except NotImplementedError:
        raise
    except Exception as e:
        raises("more than MAX_PIVOTS m guesses", Diverged, again, e, thing="complementarity residual [m/s] = ")
        named = float(str(e).partition(" = ")[2].partition(":")[0]) / size
        nearest = min(residuals_of_guesses(A, b / size), key=lambda residual: abs(residual - named))
        close("the residual that Diverged names, over that of the nearest guess [-]", named / nearest, 1.0, 1e-6)
    else:
        close("λ [N s]", lam, enumerated(A, b), 1e-6)


def residuals_of_guesses(A, b):
    """Residuals [m/s] of all guesses which contacts push, but for those that have the residual of no impulses."""
    for pushing in itertools.product((False, True), repeat=len(b)):
        on, lam = np.array(pushing), np.zeros(len(b))
        lam[on] = np.linalg.solve(A[np.ix_(on, on)], -b[on])
        residual = max(abs(min(a * push, u)) for a, push, u in zip(np.diag(A), lam, A @ lam + b, strict=True))
        if abs(residual / np.max(-b) - 1.0) > 1e-6 and residual > ROUND_OFF:
            yield residual


def again(error):
    """Raise an error that was caught."""
    raise error


@exercise("9.8", points=0.125, hint="ε_k is computed from the terms of row k: it is not a fixed number")
def test_contacts_of_any_size_are_solved_side_by_side(lesson, draw):
    for _ in range(3):
        A, b = positive_definite(draw, 3), draw(-3.0, 3.0, 3)
        lam = enumerated(A, b)
        for light, fast in itertools.product(SIZES, SIZES):
            got = np.asarray(lesson.solve_lcp(light * A, fast * b)) * (light / fast)
            close("λ over its size [-]", got, lam, SOLVED, given=f"A = {light * A}, b = {fast * b}")
        # A fourth contact of another scene, in which everything is much faster.
        both = np.zeros((4, 4))
        both[:3, :3], both[3, 3] = A, 1.0
        got = lesson.solve_lcp(both, np.append(b, -1e16))
        close("λ of three contacts beside a very fast one [N s]", np.asarray(got)[:3], lam, SOLVED,
              given=f"A = {both}, b = {b} and −1e16")


def beside_open_ones(draw):
    """(A, b) of seven contacts in any order: two push, and they open the next two, the only neighbours of the others.

    b of the other three is 0, and so are their velocities.  All are multiplied by the same size: where A is large,
    elimination exchanges rows, and each λ_k that a row of A decides gets round-off.
    """
    size = 10.0 ** draw(1.0, 4.0)
    A = np.diag(np.append(draw(3.0, 4.0, 2), np.append(draw(8.0, 12.0, 2), draw(2.0, 4.0, 3))))
    A[2:4, :2], A[2:4, 4:] = draw(1.0, 2.0, (2, 2)), draw(-1.0, 1.0, (2, 3))
    A[:2, 2:4], A[4:, 2:4] = A[2:4, :2].T, A[2:4, 4:].T
    b = np.concatenate((-draw(5.0, 9.0, 2), -draw(0.2, 1.0, 2), np.zeros(3)))
    order = np.argsort(draw(0.0, 1.0, 7))
    return size * A[np.ix_(order, order)], size * b[order]


@exercise("9.8", points=0.125,
          hint="ε_k has both parts, Σ_l |A_kl λ_l| and |b_k|; λ of contacts that do not push must be exactly 0: else "
               "round-off changes the guess for ever")
def test_contacts_that_neither_push_nor_separate_do_not_keep_the_solver_busy(lesson, draw):
    for _ in range(40):
        A, lam = positive_definite(draw, 5), np.maximum(0.0, draw(-1.0, 1.0, 5))
        close("λ where some contacts neither push nor separate [N s]", lesson.solve_lcp(A, -A @ lam), lam, SOLVED,
              given=f"A = {A}, λ = {lam}")
    for _ in range(40):                                                  # two push, a third neither; its b is 0
        A, lam = positive_definite(draw, 3), np.append(draw(0.1, 1.0, 2), 0.0)
        A[2, 1] = A[1, 2] = -A[2, 0] * lam[0] / lam[1]
        A[2, 2] += np.sum(A[2, :2] ** 2) * 4.0                           # stays positive definite
        b = np.append(-A[:2, :2] @ lam[:2], 0.0)
        close("λ where the impulses of two contacts cancel at a third [N s]", lesson.solve_lcp(A, b), lam, SOLVED,
              given=f"A = {A}, b = {b}")
    for k in range(160):
        m = 2 + k % 5
        A, b = beside_open_ones(draw) if k % 4 else (positive_definite(draw, m), draw(-3.0, 3.0, m))
        b = b * (draw(0.0, 1.0, len(b)) < 0.5) if k % 8 == 0 else b
        close("λ where b is 0 at some contacts [N s]", lesson.solve_lcp(A, b), enumerated(A, b), SOLVED,
              given=f"A = {A}, b = {b}")


@exercise("9.8", points=0.125,
          hint="solve each guess exactly by elimination, not by sweeps; a contact is wrong only beyond ε_k")
def test_the_direct_solver_does_not_mind_how_heavy_the_top_is(lesson, draw):
    """Condition 4e6: of the forces, (round-off) × (condition) = 1e-9 may be wrong."""
    for masses in ([1.0, 1e6], [*draw(0.5, 2.0, draw.whole(3, 12)), 1e6], np.ones(draw.whole(10, 25))):
        A, b, forces = chain(masses)
        close("force of each contact over its truth [-]", np.asarray(lesson.solve_lcp(A, b)) / forces, np.ones(len(b)),
              1e-8, given=f"masses {np.array(masses)} kg")


@exercise("9.8", points=0.125, hint="check_independent first: it refuses a matrix without an inverse")
def test_redundant_contacts_are_refused(lesson, draw):
    A, b, forces = chain(draw(0.5, 2.0, 3))
    close("forces of independent contacts [N]", lesson.solve_lcp(A, b), forces, SOLVED)
    twice = np.array([0, 1, 1, 2])
    raises("two contacts that say the same", BadInput, lesson.solve_lcp, A[np.ix_(twice, twice)].copy(),
           b[twice].copy())
    raises("two contacts that say the same, and that separate", BadInput, lesson.solve_lcp,
           A[np.ix_(twice, twice)].copy(), np.abs(b)[twice])
    for speed in (-1.0, 1.0):
        raises("a contact that nothing can move", BadInput, lesson.solve_lcp, np.zeros((1, 1)), np.array([speed]))
    for k, bad in itertools.product(range(3), (np.nan, np.inf, -np.inf)):
        one = np.arange(3) == k
        raises(f"a velocity that is {bad}", BadInput, lesson.solve_lcp, A, np.where(one, bad, b))
        raises(f"an entry of A that is {bad}", BadInput, lesson.solve_lcp, np.where(np.outer(one, one), bad, A), b)


# ---------------------------------------------------------------------------------------------- friction

def lawful(draw, m, loose=False):
    """(A, b, J, mu, kinds): impulses that obey all laws by construction:
    each contact separates, sticks, slides one way or the other.
    """
    A, mu = positive_definite(draw, 2 * m), draw(0.1, 0.9, m)
    J, u = np.zeros(2 * m), np.zeros(2 * m)
    kinds = [draw.whole(0, 3) if loose else k % 4 for k in range(m)]
    for k, kind in enumerate(kinds):
        n, t = 2 * k, 2 * k + 1
        if kind == 0:
            u[n], u[t] = draw(0.5, 2.0), draw(-2.0, 2.0)
            continue
        J[n] = draw(0.5, 2.0)
        J[t] = mu[k] * J[n] * (draw(-0.9, 0.9), 1.0, -1.0)[kind - 1]
        u[t] = (0.0, -draw(0.5, 2.0), draw(0.5, 2.0))[kind - 1]
    return A, u - A @ J, J, mu, kinds


@exercise("9.9", points=0.25, hint="J_n' and J_t' as in the docstring; impulses that obey the laws do not change")
def test_lawful_impulses_have_no_residual(lesson, draw):
    for speed in draw(0.1, 2.0, 2):
        A, b = np.diag(draw(0.5, 2.0, 2)), np.array([-speed, 0.0])
        close("residual of one contact that approaches without an impulse [m/s]: its speed",
              lesson.cone_residual(A, b, np.zeros(2), np.zeros(1)), speed, ROUND_OFF, given=f"A = {A}, b = {b}")
    for _ in range(4):
        A, b, J, mu, _ = lawful(draw, 5)
        close("residual of impulses that obey all laws [m/s]", lesson.cone_residual(A, b, J, mu), 0.0, ROUND_OFF)
        mu[1], mu[0] = np.inf, np.inf                                    # one that sticks, one that separates
        close("residual with infinite friction where it sticks [m/s]", lesson.cone_residual(A, b, J, mu), 0.0,
              ROUND_OFF)


@exercise("9.9", points=0.25, hint="the limit is μ times the given J_n, not J_n'; μ may be any number, or infinite")
def test_the_friction_that_may_be_is_that_of_the_given_normal_impulse(lesson, draw):
    for size, (k_n, k_t) in itertools.product(SIZES, (draw(0.5, 2.0, 2), draw(5.0, 9.0, 2), draw(0.1, 0.2, 2))):
        s = draw(0.1, 0.9)
        for what, mu, J, u, expected in (
                ("slides while it approaches", 5.0, (1.0, 5.0), (-s, -9.0), s),
                ("slides back while it approaches", 5.0, (1.0, -5.0), (-s, 9.0), s),
                ("rubs the way it slides", 5.0, (1.0, 5.0), (0.0, 20.0 * k_t), 10.0 * k_t),
                ("rubs the way it slides, on the other side", 5.0, (1.0, -5.0), (0.0, -20.0 * k_t), 10.0 * k_t),
                ("slides, and rubs a little less than it may", 5.0, (1.0, 4.99), (0.0, -9.0), 0.01 * k_t),
                ("slides on ice", 0.0, (1.0, 0.0), (0.0, 9.0), 0.0),
                ("rubs on ice", 0.0, (1.0, 1.0 / k_t), (0.0, 0.0), 1.0),
                ("sticks by high friction", 5.0, (1.0, draw(2.0, 4.9)), (0.0, 0.0), 0.0),
                ("sticks by infinite friction", np.inf, (1.0, draw(1e3, 1e6)), (0.0, 0.0), 0.0),
                ("sticks by infinite friction, with much to hold", np.inf, (1.0, draw(1e9, 1e12)), (0.0, 0.0), 0.0),
                ("rubs the way it slides, by little friction", 1e-3, (1.0, 1e-3), (0.0, 20.0 * k_t), 2e-3 * k_t),
                ("rubs the way it slides, by very little friction", 1e-7, (1.0, 1e-7), (0.0, 20.0 * k_t), 2e-7 * k_t),
                ("pulls and rubs", 9.0, (-s / k_n, 5.0 / k_t), (0.0, 0.0), 5.0),
                ("pulls and rubs back, with infinite friction", np.inf, (-s / k_n, -5.0 / k_t), (0.0, 0.0), 5.0),
                ("slips fast, without a normal impulse", 5.0, (0.0, 0.0), (s, 9.0), 0.0)):
            A, J, u = np.diag((k_n, k_t)), size * np.array(J), size * np.array(u)
            got = lesson.cone_residual(A, u - A @ J, J, np.array([mu]))
            # J of 1e6 N s may be off by a rounding.
            close(f"residual of one contact that {what}, over its size [-]", got / size, expected,
                  1e-8 if J[1] > 10.0 * size else 1e-11, given=f"A = {A}, J = {J} N s, u = {u} m/s, μ = {mu}")


@exercise("9.9", points=0.25, hint="all J' come from the given J and from u = A J + b: nothing is updated in between")
def test_every_contact_is_judged_by_the_given_impulses(lesson, draw):
    for m in (3,) * 20 + (30,) * 5:
        A, mu = positive_definite(draw, 2 * m), draw(0.1, 2.0, m)
        b, J = draw(-3.0, 3.0, 2 * m), draw(-1.0, 2.0, 2 * m)
        for some in (b, 0.0 * b):
            close("residual of drawn impulses [m/s]", lesson.cone_residual(A, some, J, mu), judged(A, some, J, mu),
                  m * ROUND_OFF, given=f"A = {A}, b = {some}, J = {J}, μ = {mu}")


@exercise("9.9", points=0.25, hint="in m/s: k_n |J_n' − J_n| and k_t |J_t' − J_t|, the largest of all contacts")
def test_each_broken_law_is_measured_as_a_velocity(lesson, draw):
    for slow in (1.0, 1e-6):
        A, b, J, mu, _ = lawful(draw, 4)
        b, J = slow * b, slow * J
        u, s = A @ J + b, slow * draw(0.01, 0.1)
        k_n, k_t = np.diag(A)[::2], np.diag(A)[1::2]
        room = k_t[1] * (mu[1] * J[2] + J[3])                            # of contact 1's friction in its cone [m/s]
        for what, place, dJ, du, expected in (
                ("approaches", 0, 0.0, -u[0] - s, s), ("pulls", 0, -s / k_n[0], 0.0, s),
                ("sticks but separates", 2, 0.0, s, s),
                ("sticks but slips", 3, 0.0, s, min(s, room)),
                ("has friction outside its cone", 5, 5.0 * s / k_t[2], 0.0, 5.0 * s),
                ("slips against its friction on the other side", 7, -5.0 * s / k_t[3], 0.0, 5.0 * s),
                ("is separated but rubs", 1, s / k_t[0], 0.0, s), ("slides the wrong way", 5, 0.0, -u[5] + s, s)):
            one, speeds = J.copy(), u.copy()
            one[place] += dJ
            speeds[place] += du
            close(f"residual where one contact {what} [m/s]", lesson.cone_residual(A, speeds - A @ one, one, mu),
                  expected, slow * ROUND_OFF, given=f"J = {one} N s, u = {speeds} m/s, μ = {mu}")
        speeds = u + np.array([-u[0] - s, 0.0, 2.0 * s, 0.0, 0.0, 0.0, 0.0, 0.0])
        close("residual where two contacts are wrong [m/s]", lesson.cone_residual(A, speeds - A @ J, J, mu), 2.0 * s,
              slow * ROUND_OFF)


def judged(A, b, J, mu):
    """The test's own natural-map residual."""
    u, wrong = A @ J + b, []
    for k in range(len(mu)):
        n, t = 2 * k, 2 * k + 1
        limit = mu[k] * max(0.0, J[n])
        wrong += [A[n, n] * abs(max(0.0, J[n] - u[n] / A[n, n]) - J[n]),
                  A[t, t] * abs(np.clip(J[t] - u[t] / A[t, t], -limit, limit) - J[t])]
    return np.max(wrong)                                                 # NaN if one of them is


@exercise("9.10", points=0.25, hint="impulses that obey the laws do not change")
def test_a_sweep_leaves_lawful_impulses_alone(lesson, draw):
    for _ in range(4):
        A, b, J, mu, _ = lawful(draw, 5)
        close("J after a sweep of lawful impulses [N s]", lesson.cone_sweep(A, b, J, mu), J, 1e-11)
    alone = np.diag(draw(0.5, 2.0, 10))                                  # no contact feels another one
    expected = draw(0.5, 2.0, 10) * np.tile([1.0, 1e12], 5)              # infinite friction has much to hold
    got = lesson.cone_sweep(alone, -alone @ expected, J, np.full(5, np.inf))
    close("J after a sweep over contacts that do not feel each other, over its truth [-]", np.asarray(got) / expected,
          np.ones(10), 1e-11)


@exercise("9.10", points=0.25,
          hint="first J_n, then the limit μ J_n from it (0 where J_n = 0, since ∞ · 0 is NaN), then J_t with the "
               "velocity that the new J_n leaves")
def test_friction_is_limited_by_the_new_normal_impulse(lesson, draw):
    A, J = positive_definite(draw, 4), np.array([draw(0.5, 1.0), 0.0, 0.0, 0.0])
    for what, u_n, u_t, mu in (("slides", -draw(1.0, 2.0), draw(5.0, 9.0), 0.2),
                               ("slides back", -draw(1.0, 2.0), -draw(5.0, 9.0), 0.2),
                               ("sticks", -draw(1.0, 2.0), draw(-2.0, 2.0), np.inf),
                               ("slips, but has the right J_n", 0.0, draw(0.5, 2.0), np.inf),
                               ("slides although μ is large", -draw(1.0, 2.0), draw(1e5, 1e6), 2000.0),
                               ("separates", draw(9.0, 12.0), draw(1.0, 2.0), np.inf)):
        b = np.array([u_n, u_t, draw(0.5, 3.0), 1.0]) - A @ J
        got = np.asarray(lesson.cone_sweep(A, b, J, np.array([mu, 0.0])))
        J_n = max(0.0, J[0] - u_n / A[0, 0])
        u_t = u_t + A[1, 0] * (J_n - J[0])
        limit = mu * J_n if J_n > 0.0 else 0.0
        close(f"(J_n, J_t) of a contact that {what} [N s]", got[:2], (J_n, np.clip(-u_t / A[1, 1], -limit, limit)),
              1e-11, given=f"μ = {mu}, u = {b + A @ J} m/s, A = {A}")


def swept(A, b, J, mu):
    """J after a sweep, one impulse after the other."""
    u, new = A @ J + b, J.copy()
    for k in range(len(J)):
        high = np.inf
        if k % 2:
            high = mu[k // 2] * new[k - 1] if new[k - 1] > 0.0 else 0.0
        change = min(max(new[k] - u[k] / A[k, k], -high if k % 2 else 0.0), high) - new[k]
        new[k] += change
        u = u + change * A[:, k]
    return new


@exercise("9.10", points=0.25,
          hint="contact by contact, J_n and then J_t with the newest J of all; contact k has μ[k], not μ[0]")
def test_a_cone_sweep_visits_the_contacts_in_their_order(lesson, draw):
    for size in SIZES:
        A, mu = positive_definite(draw, 8), np.array([draw(0.1, 0.9), np.inf, draw(2.0, 9.0), 0.0])
        J, b = draw(-1.0, 2.0, 8), draw(-3.0, 3.0, 8)
        b[3] = 1e4                                                       # infinite friction has much to hold
        J[4], J[5], b[4] = 0.0, draw(0.5, 2.0), draw(2e4, 3e4)           # one that separates has rubbed
        J[1], J[6] = draw(20.0, 30.0), -draw(0.5, 1.0)                   # more than its new limit; a pull
        b[2] = -draw(200.0, 300.0)                                       # infinite friction of a contact that pushes
        # Impulses up to 1e5 N s.
        got = np.asarray(lesson.cone_sweep(A, size * b, size * J, mu)) / size
        close("J after a sweep, over its size [-]", got, swept(A, b, J, mu), 1e-8,
              given=f"A = {A}, b = {size * b}, J = {size * J}, μ = {mu}")
    for m, size in itertools.product((2, 30), SIZES):
        A, mu = positive_definite(draw, 2 * m), 10.0 ** draw(-7.0, 1.0, m)
        b, J = draw(-3.0, 3.0, 2 * m), draw(-1.0, 2.0, 2 * m)
        for some in (b, 0.0 * b):
            got = np.asarray(lesson.cone_sweep(size * A, some, J / size, mu)) * size
            close("J after a sweep, times the size of A [-]", got, swept(A, some, J, mu), 1e-10,
                  given=f"A = {size * A}, b = {some}, J = {J / size}, μ = {mu}")


SWEEPS = 500                 # that a drawn scene may need [-]


def quickly_solved(lesson, draw):
    """(A, b, μ) of the first drawn scene whose laws hold to 1e-8 m/s after SWEEPS of the test's own sweeps."""
    while True:
        x, inv_mass, inv_inertia, c = scene(draw, lesson, fixed=False)
        G_rows, w = rows(x, c), masses_of(inv_mass, inv_inertia)
        A, b, J, mu = (G_rows * w) @ G_rows.T, G_rows @ draw(-3.0, 3.0, 12), np.zeros(10), draw(0.0, 0.5, 5)
        for _ in range(SWEEPS):
            J = swept(A, b, J, mu)
        if judged(A, b, J, mu) < 1e-8:
            return A, b, mu


@exercise("9.10", points=0.25, hint="use the newest J everywhere, and sweep over all contacts in order")
def test_sweeps_end_where_all_laws_hold(lesson, draw):
    for _ in range(3):
        A, b, mu = quickly_solved(lesson, draw)
        J = np.zeros(10)
        for _ in range(SWEEPS):
            J = np.asarray(lesson.cone_sweep(A, b, J, mu))
        between(f"residual of J after {SWEEPS} sweeps [m/s]", judged(A, b, J, mu), 0.0, 1e-6)


# ---------------------------------------------------------------------------------------------- scenes at rest

def stack_of(lesson, masses, width=1.0):
    """(x, inverse masses, inverse inertias, ContactSet, load) of unit boxes above each other,
    two contact points under each; body 0 is the ground.
    """
    n, places = len(masses), (-0.5 * width, 0.5 * width)
    x = np.array([(0.0, k - 0.5) for k in range(n + 1)])
    c = contacts_of(lesson, np.repeat(np.arange(1, n + 1), 2), np.repeat(np.arange(n), 2),
                    [(s, k) for k in range(n) for s in places], [MIDDLE] * (2 * n))
    load = np.zeros((n + 1, 3))
    load[1:, 1] = -G * np.array(masses)
    load[0] = (3.0, -4.0, 5.0)                                           # the ground does not feel it
    c = c._replace(gap=1e-3 * (-1.0) ** np.arange(2 * n))                # forces do not depend on gaps
    return x, np.append(0.0, 1.0 / np.array(masses)), np.append(0.0, 6.0 / np.array(masses)), c, load


@exercise("9.11", points=0.125,
          hint="return (F, a): rows (F_n, F_t) of F from solve_contacts with b = G M⁻¹ load; a = M⁻¹ (load + Gᵀ F)")
def test_the_kth_contact_of_a_stack_carries_what_lies_above(lesson, draw):
    masses = draw(0.5, 2.0, draw.whole(3, 5))
    x, inv_mass, inv_inertia, c, load = stack_of(lesson, masses)
    F, a = map(np.asarray, lesson.contact_forces(x, inv_mass, inv_inertia, c, load, np.full(c.a.size, 0.5)))
    n, given = len(masses), f"masses {masses} kg"
    close("shape of F [-]", F.shape, (2 * n, 2), 0.0)
    # Sweeps end where u of each contact is below 1e-13 of what it is a sum of.  From box to box a_y grows by u_n at
    # most, the angular acceleration by 2 u_n over the width of 1 m, and a_x by u_t and by what the turning adds.
    G_rows, w = rows(x, c), masses_of(inv_mass, inv_inertia)
    pushes = np.cumsum(masses[::-1])[::-1]
    carried = G * np.repeat(pushes, 4)                                   # no impulse of a contact is larger
    u = 1e-13 * np.max(np.abs((G_rows * w) @ G_rows.T) @ carried + np.abs(G_rows @ (w * load.ravel())))
    close("normal force of both points under each box together [N]", F[0::2, 0] + F[1::2, 0], G * pushes,
          n * u * pushes[0], given=given)
    close("accelerations of a stack at rest [m/s², rad/s²]", a, np.zeros((n + 1, 3)), n * (1 + 2 * n) * u, given=given)


def block_on_incline(lesson, slope, mu, w=1.0, h=1.0, feet=(-0.5, 0.5)):
    """Acceleration (3,) of a block of sizes w and h at rest on an incline, and its contact forces; feet over w."""
    x, m = np.array([(0.0, -1.0), (0.0, 0.5 * h)]), len(feet)
    c = contacts_of(lesson, [1] * m, [0] * m, [(s * w, 0.0) for s in feet], [MIDDLE] * m)
    load = np.array([(0.0, 0.0, 0.0), (G * np.sin(slope), -G * np.cos(slope), 0.0)])
    F, a = lesson.contact_forces(x, np.array([0.0, 1.0]), np.array([0.0, 12.0 / (w * w + h * h)]), c, load,
                                 np.full(m, mu))
    return np.asarray(a)[1], np.asarray(F)


@exercise("9.11", points=0.125, hint="load and contact forces both accelerate: a = M⁻¹ (load + Gᵀ F), torques included")
def test_a_block_on_an_incline_stays_slides_or_topples(lesson, draw):
    """It slides by g (sin θ − μ cos θ) where tan θ > μ.

    Where tan θ > w/h and μ is larger it turns about its lower corner, by the torque of its
    weight about that corner over I + m (w² + h²)/4.
    """
    slope = draw(0.3, 0.6)
    for share in draw.beyond(2.0):
        stays, F = block_on_incline(lesson, slope, share * np.tan(slope))
        close("acceleration of a block that stays [m/s², rad/s²]", stays, np.zeros(3), SOLVED,
              given=f"tan θ = {np.tan(slope)}, μ = {share * np.tan(slope)}")
        close("forces on a block that stays, normal and friction together [N]", np.sum(F, axis=0),
              (G * np.cos(slope), G * np.sin(slope)), SOLVED)
    feet = (-0.5, -draw(0.1, 0.4), draw(0.1, 0.4), 0.5)                  # more than are needed
    for mu, along in ((0.0, G * np.sin(slope)), (2.0 * np.tan(slope), 0.0)):
        moves, F = block_on_incline(lesson, slope, mu, feet=feet)
        close("acceleration of a block with four feet [m/s², rad/s²]", moves, (along, 0.0, 0.0), SOLVED,
              given=f"tan θ = {np.tan(slope)}, μ = {mu}, feet at {feet} m")
        close("forces on a block with four feet, normal and friction together [N]", np.sum(F, axis=0),
              (G * np.cos(slope), G * np.sin(slope) - along), SOLVED)
    w = draw(2.0, 3.0)
    for mu in np.array(draw.within(0.2)) * np.tan(slope):
        close("acceleration of a block that slides [m/s², rad/s²]", block_on_incline(lesson, slope, mu, w)[0],
              (G * (np.sin(slope) - mu * np.cos(slope)), 0.0, 0.0), SOLVED, given=f"tan θ = {np.tan(slope)}, μ = {mu}")
    w, h = draw(0.5, 0.99) * np.tan(slope), 1.0
    spin = -0.5 * G * (h * np.sin(slope) - w * np.cos(slope)) / ((w * w + h * h) / 12.0 + (w * w + h * h) / 4.0)
    close("angular acceleration of a block that topples [rad/s²]", block_on_incline(lesson, slope, 3.0, w)[0][2], spin,
          SOLVED, given=f"tan θ = {np.tan(slope)}, w/h = {w}")


def pushed_block(draw, side):
    """(w, h, m, μ (2,), push, F_n (2,), a_x): a block on the ground that a force side · push at its centre moves.

    Its feet at ∓w/2 have their own friction.  Weight: F₀ + F₁ = m g.  Torque: ½ w (F₁ − F₀) = ½ h side (μ₀ F₀ + μ₁ F₁).
    """
    w, h, m, mu = draw(2.0, 3.0), draw(0.5, 1.0), draw(0.5, 2.0), draw(0.1, 0.9, 2)
    matrix = np.array([[1.0, 1.0], [-w - side * h * mu[0], w - side * h * mu[1]]])
    F_n = np.linalg.solve(matrix, [m * G, 0.0])
    push = draw(1.01, 2.0) * mu @ F_n
    return w, h, m, mu, push, F_n, side * (push - mu @ F_n) / m


@exercise("9.11", points=0.125, hint="every contact has its own μ; F_t, along t = (−n_y, n_x), opposes the motion")
def test_each_foot_of_a_pushed_block_rubs_by_its_own_friction(lesson, draw):
    for side, size, heavy in ((side, *sizes) for side in (1.0, -1.0) for sizes in itertools.product(SIZES, SIZES)):
        w, h, m, mu, push, F_n, a_x = pushed_block(draw, side)
        x = np.array([(0.0, -1.0), (0.0, 0.5 * h)])
        c = contacts_of(lesson, [1, 1], [0, 0], [(-0.5 * w, 0.0), (0.5 * w, 0.0)], [MIDDLE, MIDDLE], (1e-3, -1e-3))
        load = size * np.array([(0.0, 0.0, 0.0), (side * push, -m * G, 0.0)])
        F, a = lesson.contact_forces(x, np.array([0.0, 1.0 / (heavy * m)]),
                                     np.array([0.0, 12.0 / (heavy * m) / (w * w + h * h)]), c, load, mu)
        given = f"w = {w}, h = {h}, m = {heavy * m}, μ = {mu}, load {load[1]}"
        # The friction on the block is −side μ F_n along x, and t = (−1, 0).
        close("forces (F_n, F_t) on the feet, over the size of the load [-]", np.asarray(F) / size,
              np.stack((F_n, side * mu * F_n), axis=1), SOLVED, given)
        close("acceleration of the block, over the sizes of load and inverse mass [-]", np.asarray(a)[1] / size * heavy,
              (a_x, 0.0, 0.0), SOLVED, given)


def pressed_pairs(draw, lesson, held):
    """(x, inverse masses, inverse inertias, ContactSet, load, μ) of five bodies: two pairs are pressed together.

    Those that are held can turn only.  Where k_n is below μ |k_nt|, friction presses a contact on by more than its
    normal force lifts it (Painlevé): it may stick and slide, and sweeps may not end.  Such a scene is drawn again.
    """
    while True:
        x, inv_mass, inv_inertia = draw(-2.0, 2.0, (5, 2)), draw(0.3, 2.0, 5), draw(0.5, 5.0, 5)
        inv_mass[held] = 0.0
        n = [unit(draw), unit(draw)]
        c = contacts_of(lesson, [0, 3], [2, 1], 0.5 * (x[[0, 3]] + x[[2, 1]]) + draw(-0.5, 0.5, (2, 2)), n,
                        draw(-0.5, 0.5, 2))                              # forces do not depend on gaps
        load, mu = draw(-5.0, 5.0, (5, 3)), np.array([draw(0.1, 0.9), 10.0 ** draw(-4.0, -2.0)])
        for k, (a, b) in enumerate(((0, 2), (3, 1))):                    # press the bodies together
            load[a, :2] -= 9.0 * n[k]
            load[b, :2] += 9.0 * n[k]
        G_rows = rows(x, c)
        A = (G_rows * masses_of(inv_mass, inv_inertia)) @ G_rows.T
        if np.all(mu * np.abs(np.diag(A, 1)[::2]) < 0.9 * np.diag(A)[::2]):
            return x, inv_mass, inv_inertia, c, load, mu


@exercise("9.11", points=0.125, hint="every body has its own mass and inertia; both bodies of a contact feel its force")
def test_pairs_of_bodies_of_any_mass_press_and_rub_as_the_laws_say(lesson, draw):
    """Two contacts that share no body, and a body without a contact.  Some bodies have a fixed axle.

    The test's own residual checks the laws, and M a = load + GᵀF the motion.
    """
    for held in [[], [1, 4]] * 3:
        x, inv_mass, inv_inertia, c, load, mu = pressed_pairs(draw, lesson, held)
        G_rows, w = rows(x, c), masses_of(inv_mass, inv_inertia)
        F, a = (np.asarray(part) for part in lesson.contact_forces(x, inv_mass, inv_inertia, c, load, mu))
        given = f"x = {x.tolist()}, inverse masses {inv_mass}, inverse inertias {inv_inertia}, load {load.tolist()}"
        close("shape of F [-]", F.shape, (2, 2), 0.0, given)
        residual = judged((G_rows * w) @ G_rows.T, G_rows @ (w * load.ravel()), F.ravel(), mu)
        close("residual of the forces [m/s²]", residual, 0.0, SOLVED, given)
        expected = (w * (load.ravel() + G_rows.T @ F.ravel())).reshape(5, 3)
        close("accelerations of all bodies [m/s², rad/s²]", a, expected, SOLVED, given)


def check_friction_at_rest(lesson, draw):
    """A force T along x and a torque T/2 about the centre, 1/2 above the contact: F_t = T along t = (−1, 0)."""
    x, c = np.array([(0.0, -1.0), (0.0, 0.5)]), contacts_of(lesson, [1], [0], [(0.0, 0.0)], [MIDDLE])
    for T, mu in itertools.product((draw(1e-4, 9e-4), -draw(1e-4, 9e-4), draw(2e3, 9e3), -draw(2e3, 9e3)),
                                   (np.inf, draw(1e4, 1e5))):
        load, w = np.array([np.zeros(3), (T, -1.0, 0.5 * T)]), np.array([0.0, draw(0.5, 2.0)])
        F, a = lesson.contact_forces(x, w, w, c, load, np.array([mu]))
        close("F_n [N], and F_t over its truth [-]", np.asarray(F)[0] / (1.0, T), np.ones(2), SOLVED,
              given=f"load {load[1]}, μ = {mu}")
        close("acceleration of the body over T [1/kg]", np.asarray(a)[1] / T, np.zeros(3), SOLVED,
              given=f"load {load[1]}, μ = {mu}")


@exercise("9.11", points=0.125, hint="load has three numbers per body: the torque counts, and a load may lift")
def test_torques_shift_the_forces_and_lifted_blocks_fly(lesson, draw):
    for side in (1.0, -1.0):
        w, h, m = draw(1.0, 3.0), draw(0.5, 1.0), draw(0.5, 2.0)
        torque = side * draw(0.1, 0.45) * m * G * w
        x, inv_inertia = np.array([(0.0, -1.0), (0.0, 0.5 * h)]), np.array([0.0, 12.0 / m / (w * w + h * h)])
        c = contacts_of(lesson, [1, 1], [0, 0], [(-0.5 * w, 0.0), (0.5 * w, 0.0)], [MIDDLE, MIDDLE])
        for name, load, F_n, a_1 in (
                ("block that a torque presses on one foot", (0.0, -m * G, torque),
                 (0.5 * m * G + torque / w, 0.5 * m * G - torque / w), np.zeros(3)),
                ("block that is lifted", (side, m * G, 0.0), (0.0, 0.0), np.array([side / m, G, 0.0]))):
            F, a = lesson.contact_forces(x, np.array([0.0, 1.0 / m]), inv_inertia, c, np.array([np.zeros(3), load]),
                                         np.full(2, 0.5))
            given = f"w = {w}, h = {h}, m = {m}, load {load}"
            close(f"normal forces on a {name} [N]", np.asarray(F)[:, 0], F_n, SOLVED, given)
            close(f"acceleration of a {name} [m/s², rad/s²]", np.asarray(a)[1], a_1, SOLVED, given)
    check_friction_at_rest(lesson, draw)
    T, w, mu = 2.0 ** draw.whole(-5, 5), draw(0.5, 2.0), draw(2.0, 9.0)  # a load whose components add up to exactly 0
    F, _ = lesson.contact_forces(np.array([(0.0, -1.0), (0.0, 0.5)]), np.array([0.0, w]), np.array([0.0, w]),
                                 contacts_of(lesson, [1], [0], [(0.0, 0.0)], [MIDDLE]),
                                 np.array([np.zeros(3), (T, -1.5 * T, 0.5 * T)]), np.array([mu]))
    close("(F_n, F_t) over T, under a force (T, −3T/2) and a torque T/2 [-]", np.asarray(F)[0] / T, (1.5, 1.0), SOLVED,
          given=f"T = {T}, μ = {mu}")
    slope = draw(1.35, 1.45)                                             # tan θ from 4.4 to 8.3
    stays, F = block_on_incline(lesson, slope, np.inf, w=20.0)
    close("acceleration of a wide block with infinite friction [m/s², rad/s²]", stays, np.zeros(3), SOLVED)
    close("forces on a wide block with infinite friction, normal and friction together [N]", np.sum(F, axis=0),
          (G * np.cos(slope), G * np.sin(slope)), SOLVED)


@exercise("9.11", points=0.125,
          hint="check_scene first: it refuses negative friction and arrays that do not fit each other")
def test_scenes_without_physics_are_refused(lesson, draw):
    x, inv_mass, inv_inertia, c, load = stack_of(lesson, [draw(0.5, 2.0)])
    mu = np.full(2, 0.5)
    close("normal forces of a single box [N]",
          np.sum(np.asarray(lesson.contact_forces(x, inv_mass, inv_inertia, c, load, mu)[0])[:, 0]), G / inv_mass[1],
          SOLVED)
    one, nan = np.array([0.0, 1.0]), np.array([1.0, np.nan])
    scene = {"x": x, "1/m": inv_mass, "1/I": inv_inertia, "contacts": c, "load": load, "μ": mu}
    refused = {
        "negative friction": [{"μ": -mu}, {"μ": mu - (0.5 + 1e-3) * one}, {"μ": mu * nan}],
        "a negative inverse mass": [{"1/m": -inv_mass}, {"1/m": -inv_mass, "load": 0.0 * load}],
        "a negative inverse inertia": [{"1/I": -size * inv_inertia} for size in (1.0, 1e-3)],
        "a load that is not finite": [{"load": np.nan * load}, {"load": np.where(load == load[1, 1], np.inf, load)}],
        "a place that is not finite": [{"x": x * nan[:, None]}, {"contacts": c._replace(p=c.p * nan[:, None])}],
        "a gap that is not finite": [{"contacts": c._replace(gap=c.gap * nan)}],
        "a normal whose length is not 1": [{"contacts": c._replace(n=size * c.n)} for size in (0.0, 0.99, 1.01, 2.0)],
        "a contact of a body that is none": [{"contacts": c._replace(a=c.a + 5)}, {"contacts": c._replace(b=c.b - 1)}],
        "a contact of a body with itself": [{"contacts": c._replace(a=c.b)}, {"contacts": c._replace(b=c.a)}],
        "friction of one contact for two": [{"μ": mu[:1].copy()}],
        "a load of three bodies for two": [{"load": np.vstack((load, load[1:]))}],
    }
    for what, many in refused.items():
        for part in many:
            raises(what, BadInput, lesson.contact_forces, *(scene | part).values())


# ---------------------------------------------------------------------------------------------- soft contacts

@exercise("9.12", points=0.5,
          hint="s = 2π hertz dt: hertz are turns per second, not rad/s; spring and damper use the new velocity")
def test_a_soft_contact_is_an_implicit_euler_step_of_a_damped_spring(lesson, draw):
    """v' (1 + 2ζωdt + ω²dt²) = v − dt ω² gap;  J = m (v' − v), and the contact asks for v' = aim − give J/m."""
    for _ in range(4):
        hertz, zeta, dt = draw(5.0, 60.0), draw(0.1, 10.0), draw(0.001, 0.02)
        gap, v = -draw(1e-4, 0.1), draw(-2.0, 2.0)
        omega = 2.0 * np.pi * hertz
        new = (v - dt * omega * omega * gap) / (1.0 + 2.0 * zeta * omega * dt + (omega * dt) ** 2)
        aim, give = lesson.soft_contact(gap, hertz, zeta, dt)
        close("velocity after one step of a contact alone [m/s]", (aim + give * v) / (1.0 + give), new, ROUND_OFF,
              given=f"gap {gap} m, {hertz} Hz, ζ = {zeta}, dt = {dt} s, u_n = {v} m/s")


@exercise("9.12", points=0.25, hint="no overlap is tolerated, however small, and no speed is limited here")
def test_soft_contacts_of_any_depth_stiffness_and_damping_are_implicit_euler_steps(lesson, draw):
    for _ in range(40):
        gap, hertz = -(10.0 ** draw(-15.0, 2.0)), 10.0 ** draw(-2.0, 4.0)
        zeta, dt = draw.whole(0, 1) * 10.0 ** draw(-3.0, 3.0), 10.0 ** draw(-6.0, 0.0)
        omega = 2.0 * np.pi * hertz
        aim, give = lesson.soft_contact(gap, hertz, zeta, dt)
        given = f"gap {gap} m, {hertz} Hz, ζ = {zeta}, dt = {dt} s"
        below = 1.0 + 2.0 * zeta * omega * dt + (omega * dt) ** 2
        # From rest, v' = −dt ω² gap/below; without overlap v' = v/below, which is v give/(1 + give).
        close("1 + 1/give, over its truth [-]", (1.0 + 1.0 / give) / below, 1.0, ROUND_OFF, given=given)
        close("velocity after one step from rest, over its truth [-]",
              aim / (1.0 + give) * below / (-dt * omega**2 * gap), 1.0, ROUND_OFF, given=given)
        open_gap = 10.0 ** draw(-15.0, 3.0)
        aim, give = lesson.soft_contact(open_gap, hertz, zeta, dt)
        close("(aim over −gap/dt, give) of an open contact [-]", (aim / (-open_gap / dt), give), (1.0, 0.0), ROUND_OFF,
              given=f"gap {open_gap} m, dt = {dt} s")


@exercise("9.12", points=0.25, hint="at rest aim = give k_n J_n, with J_n = F dt: the step must cancel")
def test_a_soft_contact_sags_by_its_force_for_any_step(lesson, draw):
    hertz, zeta, k_n, F = draw(5.0, 60.0), draw(0.1, 10.0), draw(0.3, 3.0), draw(1.0, 30.0)
    sag = k_n * F / (2.0 * np.pi * hertz) ** 2
    for dt in (draw(0.0005, 0.002), draw(0.01, 0.03)):
        aim, give = lesson.soft_contact(-sag, hertz, zeta, dt)
        close("aim over give k_n F dt where the sag is right [-]", aim / (give * k_n * F * dt), 1.0, ROUND_OFF,
              given=f"{hertz} Hz, ζ = {zeta}, dt = {dt} s")


@exercise("9.12", points=0.5, hint="gap > 0: aim = −gap/dt, and give = 0")
def test_an_open_contact_may_close_its_gap_and_no_more(lesson, draw):
    for gap in (draw(1e-3, 1.0), 1e-9):
        dt = draw(0.001, 0.02)
        close("(aim, give) of an open contact [m/s, -]", lesson.soft_contact(gap, draw(5.0, 60.0), draw(0.1, 10.0), dt),
              (-gap / dt, 0.0), ROUND_OFF * gap / dt, given=f"gap {gap} m, dt = {dt} s")
    aim, give = lesson.soft_contact(0.0, 10.0, 1.0, 0.01)
    s = 0.2 * np.pi
    close("(aim, give) of a contact that just touches [m/s, -]", (aim, give), (0.0, 1.0 / (s * (2.0 + s))), ROUND_OFF)


def tangents(draw):
    """Tangential impulses J (3,), and the unit of each [N s]; with mixed signs and of ordinary size first."""
    every = sorted(itertools.product((1, -1), repeat=3), key=lambda signs: signs != (1, -1, 1))
    for unit, signs in itertools.product(SIZES, every):
        drawn = unit * draw(0.3, 2.0, 3) * signs
        even = signs[0] * unit * np.roll(balanced(draw, 3), signs[1])
        for J in (drawn, drawn * [0.0, 1.0, 1.0], *np.diag(drawn), even):
            yield J, unit


@exercise("9.13", points=0.25, hint="where |J| is at most the limit, J stays as it is")
def test_friction_inside_its_disc_is_left_alone(lesson, draw):
    small = draw(0.1, 0.3, 3)
    for J, limit in ((small, 1.01 * np.linalg.norm(small)), *((J, 1.01 * np.linalg.norm(J)) for J, _ in tangents(draw)),
                     (small, draw(2.0, 9.0)), (small, np.inf), (np.zeros(3), 0.0), (np.zeros(3), 1.0)):
        close("J inside its disc [N s]", lesson.friction_disc(tuple(J), limit), J, 0.0,
              given=f"J = {J} N s, limit {limit} N s")
    instance("the answer", lesson.friction_disc(tuple(small), 1.0), tuple, given=f"J = {small} N s, limit 1 N s")
    close("J outside its disc, for comparison [N s]", lesson.friction_disc(tuple(small), 0.5 * np.linalg.norm(small)),
          0.5 * small, ROUND_OFF, given=f"J = {small} N s, limit half its size")


@exercise("9.13", points=0.25, hint="beyond the limit, scale the whole J to that length: limit/|J| times J")
def test_friction_is_the_nearest_point_of_its_disc(lesson, draw):
    for J, unit in tangents(draw):
        for part in (draw(0.1, 0.9), 0.99, 1.0 - 1e-10):
            limit = part * np.linalg.norm(J)
            close("J outside its disc, over its size [-]", np.array(lesson.friction_disc(tuple(J), limit)) / unit,
                  part * J / unit, ROUND_OFF, given=f"J = {J} N s, limit {part} times its size")
    close("J without normal impulse [N s]", lesson.friction_disc(tuple(J), 0.0), np.zeros(3), 0.0)
    instance("the answer", lesson.friction_disc((3.0, 0.0, 4.0), 1.0), tuple, given="J = (3, 0, 4) N s, limit 1 N s")


# -------------------------------------------------------------------------------------------- memory, and looking again

BODIES = 4                   # of the sets of contacts below; number 4 is a plane


def two_sets(draw, lesson, d):
    """(new ContactSet, old ContactSet, J_old, near): four bodies and a plane, several contacts for some pairs,
    at most 0.3 m apart from where they were.
    """
    pairs = [(0, 1), (0, 1), (0, 4), (1, 4), (1, 2), (1, 4), (3, 4)]
    p = np.array([[draw(-0.2, 0.2) + 3.0 * k for _ in range(d)] for k in range(len(pairs))])
    normals = np.tile(np.eye(d)[0], (len(pairs), 1))
    old = contacts_of(lesson, *zip(*pairs, strict=True), p, normals, draw(-0.1, 0.1, len(pairs)), BODIES)
    moved = p + np.array([draw(-0.1, 0.1, d) for _ in pairs])
    order = [1, 0, 2, 4, 5, 3]  # within a pair in another order; the last pair has parted
    new_pairs = [pairs[k] for k in order] + [(2, 4)]
    new = contacts_of(lesson, *zip(*sorted(new_pairs, key=lambda pair: pair[0]), strict=True),
                      *sort_by_a(new_pairs, np.vstack((moved[order], p[6:]))),
                      np.tile(np.eye(d)[0], (len(new_pairs), 1)), draw(-0.1, 0.1, len(new_pairs)), BODIES)
    return new, old, draw(-2.0, 2.0, (len(pairs), d)), 0.5


def sort_by_a(pairs, p):
    return (p[sorted(range(len(pairs)), key=lambda k: pairs[k][0])],)


def inherited(new, old, J_old, near):
    """What the rule says, contact by contact."""
    J = np.zeros(new.p.shape)
    for k in range(len(new.a)):
        same = np.flatnonzero((old.a == new.a[k]) & (old.b == new.b[k]))
        distance = np.linalg.norm(old.p[same] - new.p[k], axis=1)
        if len(same) and distance.min() < near:
            J[k] = J_old[same[np.argmin(distance)]]
    return J


@exercise("9.14", points=0.125, hint="exactly at the place of an old contact, J is its J_old: the whole vector")
def test_a_contact_that_did_not_move_keeps_its_impulse(lesson, draw):
    for d in (2, 3):
        _, old, J_old, near = two_sets(draw, lesson, d)
        kept = [1, 2, 4, 6]
        some = contacts_of(lesson, old.a[kept], old.b[kept], old.p[kept], old.n[kept], draw(-0.1, 0.1, 4), BODIES)
        close("J of contacts that did not move [N s]", lesson.kept_impulses(some, old, J_old, near), J_old[kept], 0.0)


@exercise("9.14", points=0.125,
          hint="for each contact, take the impulse of the nearest old contact with the same a and b")
def test_a_contact_remembers_the_impulse_of_its_pair_and_place(lesson, draw):
    for d in (2, 3):
        new, old, J_old, near = two_sets(draw, lesson, d)
        close("J to begin with [N s]", lesson.kept_impulses(new, old, J_old, near), inherited(new, old, J_old, near),
              0.0)


@exercise("9.14", points=0.125,
          hint="several old contacts of the pair are near: take the one with the least |p − p_old|, not the "
                "first one found")
def test_of_several_old_contacts_that_are_near_the_nearest_counts(lesson, draw):
    for d in (2, 3):
        new, old, J_old, near = two_sets(draw, lesson, d)
        crowded = old._replace(p=0.01 * old.p)  # both contacts of a pair are near: the nearest counts
        close("J where several old contacts are near [N s]",
              lesson.kept_impulses(new._replace(p=0.01 * new.p), crowded, J_old, near),
              inherited(new._replace(p=0.01 * new.p), crowded, J_old, near), 0.0)
        away = draw(1e6, 9e6, d)
        new, old = new._replace(p=0.01 * new.p + away), old._replace(p=0.01 * old.p + away)
        close("J where several old contacts are near, far from the origin [N s]",
              lesson.kept_impulses(new, old, J_old, near), inherited(new, old, J_old, near), 0.0)


@exercise("9.14", points=0.125,
          hint="the nearest by |p − p_old| in all directions, among old contacts with the same a and the same b")
def test_the_nearest_old_contact_is_found_among_many_with_other_normals(lesson, draw):
    for d in (2, 3):
        pairs = sorted(((k % 3, 3 + k % 2) for k in range(48)), key=lambda pair: pair[0])
        old, new = (contacts_of(lesson, *zip(*pairs, strict=True), draw(-1.0, 1.0, (48, d)), unit_vectors(draw, 48, d),
                                draw(-0.1, 0.1, 48), BODIES) for _ in range(2))
        J_old = draw(-2.0, 2.0, (48, d))
        for near in (0.2, 0.5, 9.0):
            close("J to begin with, of many contacts [N s]", lesson.kept_impulses(new, old, J_old, near),
                  inherited(new, old, J_old, near), 0.0, given=f"near = {near} m")


def unit_vectors(draw, count, d):
    directions = draw(-1.0, 1.0, (count, d))
    return directions / np.linalg.norm(directions, axis=1, keepdims=True)


def beside(draw, lesson, ways):
    """(new ContactSet, old ContactSet, J_old, near): one old contact, and new ones at so many `near` beside it."""
    d = draw.whole(2, 3)
    near = 2.0 ** draw.whole(-30, 20)                                    # powers of two: no round-off
    place, e = near * np.floor(draw(-9.0, 9.0, d)), np.eye(d)[draw.whole(0, d - 1)]
    old, m = contacts_of(lesson, [0], [1], place[None], e[None]), len(ways)
    new = contacts_of(lesson, [0] * m, [1] * m, place + near * np.outer(ways, e), np.tile(e, (m, 1)))
    return new, old, draw(0.5, 2.0, (1, d)) if draw.whole(0, 1) else balanced(draw, d)[None], near


@exercise("9.14", points=0.125, hint="closer than `near`: exactly `near` is too far")
def test_exactly_near_is_too_far(lesson, draw):
    for _ in range(4):
        new, old, J_old, near = beside(draw, lesson, [1.0, -1.0, 1.0 - 2.0**-20])
        close("J of three contacts at ±near and slightly nearer than that [N s]",
              lesson.kept_impulses(new, old, J_old, near), np.array([0.0, 0.0, 1.0])[:, None] * J_old, 0.0,
              given=f"near = {near} m, old contact at {old.p[0]}, new ones at {new.p.tolist()}")


@exercise("9.14", points=0.125, hint="two new contacts may take over the same old impulse, each the whole of it")
def test_one_old_impulse_may_serve_two_contacts(lesson, draw):
    for _ in range(4):
        new, old, J_old, near = beside(draw, lesson, [0.5, -0.5])
        close("J of two contacts at ±near/2 [N s]", lesson.kept_impulses(new, old, J_old, near),
              np.ones((2, 1)) * J_old, 0.0,
              given=f"near = {near} m, old contact at {old.p[0]}, new ones at {new.p.tolist()}")


@exercise("9.14", points=0.125, hint="`near` is a distance: farther than that, or where there was no contact, J is 0")
def test_a_contact_elsewhere_begins_without_impulse(lesson, draw):
    new, old, J_old, near = two_sets(draw, lesson, 2)
    far = np.arange(len(new.p)) % 2 == 1
    close("J [N s], where every second contact lies elsewhere",
          lesson.kept_impulses(new._replace(p=new.p + np.outer(far, (0.0, 1.0))), old, J_old, near),
          np.where(far[:, None], 0.0, inherited(new, old, J_old, near)), 0.0)
    close("J of contacts that are not so near [N s]", lesson.kept_impulses(new, old, J_old, 0.05),
          inherited(new, old, J_old, 0.05), 0.0)
    none = contacts_of(lesson, [], [], np.zeros((0, 2)), np.zeros((0, 2)), bodies=BODIES)
    close("J after a step without contacts [N s]", lesson.kept_impulses(new, none, np.zeros((0, 2)), near),
          np.zeros(new.p.shape), 0.0)


@exercise("9.14", points=0.125,
          hint="the same a and the same b: with another partner, or with a and b exchanged, it is another contact")
def test_a_contact_of_other_bodies_begins_without_impulse(lesson, draw):
    new, old, J_old, near = two_sets(draw, lesson, 2)
    for what, *pairs in (("whose bodies are those of an old one, a and b exchanged", (0, 1), (1, 0)),
                         ("with another plane, at the same place", (0, BODIES), (0, BODIES + 1))):
        one, other = (contacts_of(lesson, [a], [b], [(0.0, 0.0)], [MIDDLE], bodies=BODIES) for a, b in pairs)
        close(f"J of a contact {what} [N s]",
              lesson.kept_impulses(one, other, draw(0.5, 2.0, (1, 2)), near), np.zeros((1, 2)), 0.0)
    swapped = old._replace(b=np.where(old.b == 4, 2, old.b))
    close("J after the partners changed [N s]", lesson.kept_impulses(new, swapped, J_old, near),
          inherited(new, swapped, J_old, near), 0.0)


def widened(draw, d, n=None):
    """(low, high, wide_low, wide_high, margin) of some bodies, or n, in the middle of their widened boxes."""
    n, margin = n or draw.whole(3, 6), draw(0.01, 0.1)
    low = draw(-2.0, 2.0, (n, d))
    high = low + draw(0.1, 1.0, (n, d))
    return low, high, low - margin, high + margin, margin


def some_corners(low, order):
    """Bodies and axes, in words and as an array of 1 and 0: all, one axis of all, one body, then each by itself."""
    n, d = low.shape
    bodies, axes = [*range(n)][::order], [*range(d)][::order]
    places = (("all bodies", np.s_[:, :]), (f"all bodies, coordinate {axes[0]}", np.s_[:, axes[0]]),
              (f"body {bodies[0]}", np.s_[bodies[0], :]),
              *((f"body {i}, coordinate {c}", np.s_[i, c]) for i in bodies for c in axes))
    for given, place in places:
        one = np.zeros((n, d))
        one[place] = 1.0
        yield given, one


@exercise("9.15", points=0.25, hint="a body that stays inside its widened box, edges included, has not left it")
def test_no_box_has_left_while_all_are_inside(lesson, draw):
    for d in (2, 3):
        low, high, *wide, margin = widened(draw, d)
        shift = draw(-0.9, 0.9, low.shape) * margin
        for what, n in (("a single body inside", 1), ("all inside", len(low))):
            truth(f"whether any box has left, {what}",
                  lesson.has_left_margin(*(part[:n] for part in (low + shift, high + shift, *wide))), False)
        for what, parts in (("exactly as low as they may be", (wide[0], high)),
                            ("exactly as high as they may be", (low, wide[1])), ("as wide as they may be", wide)):
            truth(f"whether any box has left, all {what}", lesson.has_left_margin(*parts, *wide), False)
        everywhere = np.full(low.shape, np.inf)
        truth("whether any box has left where the widened boxes are all of space",
              lesson.has_left_margin(low, high, -everywhere, everywhere), False)
        truth("whether any box has left, all moved by 1.01 times the margin", lesson.has_left_margin(
            low + 1.01 * margin, high + 1.01 * margin, *wide), True)
        truth("whether any box has left", lesson.has_left_margin(*(part[:0] for part in (low, high, *wide))), False,
              given=f"no bodies: arrays of shape (0, {d})")


@exercise("9.15", points=0.25, hint="low below wide_low, for one body and one axis, is enough")
def test_one_lower_side_beyond_its_margin_is_enough(lesson, draw):
    for d in (3, 2):
        low, high, *wide, margin = widened(draw, d)
        truth("whether any box has left, all inside", lesson.has_left_margin(low, high, *wide), False)
        for given, one in some_corners(low, 1):
            truth("whether any box has left, some too far to the lower side",
                  lesson.has_left_margin(low - 1.01 * margin * one, high - 1.01 * margin * one, *wide), True, given)
            beyond = np.where(one > 0.0, np.nextafter(wide[0], -np.inf), wide[0])
            truth("whether any box has left, some by a single rounding to the lower side",
                  lesson.has_left_margin(beyond, wide[1], *wide), True, given)
        low, high, *wide, margin = widened(draw, d, 100)
        low[-1] -= 2.0 * margin
        truth("whether any box has left, the last of a hundred too far to the lower side",
              lesson.has_left_margin(low, high, *wide), True)


@exercise("9.15", points=0.25, hint="high above wide_high, for one body and one axis, is enough")
def test_one_upper_side_beyond_its_margin_is_enough(lesson, draw):
    for d in (3, 2):
        low, high, *wide, margin = widened(draw, d)
        truth("whether any box has left, all inside", lesson.has_left_margin(low, high, *wide), False)
        for given, one in some_corners(low, -1):
            truth("whether any box has left, some too far to the upper side",
                  lesson.has_left_margin(low + 1.01 * margin * one, high + 1.01 * margin * one, *wide), True, given)
            beyond = np.where(one > 0.0, np.nextafter(wide[1], np.inf), wide[1])
            truth("whether any box has left, some by a single rounding to the upper side",
                  lesson.has_left_margin(wide[0], beyond, *wide), True, given)


@exercise("9.15", points=0.25,
          hint="ask whether a body is inside, and turn the answer round: a comparison with NaN is False")
def test_a_corner_that_is_no_finite_number_has_left(lesson, draw):
    for d, most in itertools.product((2, 3), (None, 1)):
        low, high, *wide = (part[:most] for part in widened(draw, d)[:4])
        truth("whether any box has left, all inside", lesson.has_left_margin(low, high, *wide), False)
        lost = np.full(low.shape, np.nan)
        truth("whether any box has left where all is NaN", lesson.has_left_margin(lost, lost, *wide), True)
        for nowhere in (np.full(low.shape, np.inf), np.full(low.shape, -np.inf)):
            truth("whether any box has left where all widened boxes are empty, as before the first search",
                  lesson.has_left_margin(low, high, nowhere, nowhere), True)
            truth("whether any box has left where no widened box is known",
                  lesson.has_left_margin(low, high, lost, lost), True)
        for given, one in some_corners(low, 1):
            hole = np.where(one > 0.0, np.nan, 0.0)
            for wide_low, wide_high in ((wide[0] + hole, wide[1]), (wide[0], wide[1] + hole)):
                truth("whether any box has left, some with a widened box that is NaN",
                      lesson.has_left_margin(low, high, wide_low, wide_high), True, given)
            lost, endless = np.where(one > 0.0, np.nan, 0.0), np.where(one > 0.0, np.inf, 0.0)
            for what, *parts in (("NaN in both", low + lost, high + lost), ("NaN below", low + lost, high),
                                 ("NaN above", low, high + lost), ("−∞ below", low - endless, high),
                                 ("∞ above", low, high + endless)):
                truth("whether any box has left, some with a corner that is no finite number",
                      lesson.has_left_margin(*parts, *wide), True, f"{given}: {what}")


# ---------------------------------------------------------------------------------------------- sweeps in arrays

def swept_scene(draw, lesson, mu, fixed=True):
    """(v, omega, J, contacts, arms, pile, x) of drawn bodies in motion, with impulses that were applied before.

    One of them pulls, and two lie outside their cone, as they may where a normal has turned since the last step.
    """
    x, inv_mass, inv_inertia, c = scene(draw, lesson, fixed)
    G_rows, w = rows(x, c), masses_of(inv_mass, inv_inertia)
    k = np.sum(G_rows * w * G_rows, axis=1)
    arms = lesson.Arms(c.p - x[c.a], c.p - x[c.b], k[::2].copy(), k[1::2].copy())
    pile = lesson.Pile(inv_mass, inv_inertia, np.full((3, 2), 0.1), np.array([[0.0, 1.0, 0.0]]), np.array([0.0, -G]),
                       mu, 1, 10.0, 1.0, 0.01)
    along, across = draw(0.1, 1.0, 5) * [1.0, 1.0, -1.0, 1.0, 1.0], draw(-1.0, 1.0, 5) * [20.0, 1.0, 1.0, 20.0, 1.0]
    J = np.stack([s * n + r * min(mu, 1.0) * s * np.array([-n[1], n[0]])
                  for n, s, r in zip(c.n, along, across, strict=True)])
    return draw(-3.0, 3.0, (4, 2)), draw(-3.0, 3.0, 4), J, c, arms, pile, x


def by_hand(lesson, draw):
    """(J, v and ω of body a after one contact with the ground, as found and as expected, and what is given), …

    J is 0 before.  n = (0, 1), so t = (−1, 0).  All that is needed to compute it again is given.
    """
    for mu, give in ((9.0, 0.0), (0.5, 0.0), (0.5, 1.0)):
        r, v, omega, aim = (1.0, -2.0), (draw.whole(1, 3), -draw.whole(1, 3)), draw.whole(1, 3), draw.whole(0, 2)
        inv_mass, inv_inertia = 1.0, 0.5
        k_n, k_t = inv_mass + inv_inertia * r[0] ** 2, inv_mass + inv_inertia * r[1] ** 2
        u_n, u_t = v[1] + omega * r[0], -(v[0] - omega * r[1])
        J_n = max(0.0, (aim - u_n) / (k_n * (1.0 + give)))
        J_t = min(max(-u_t / k_t, -mu * J_n), mu * J_n)
        c = contacts_of(lesson, [0], [1], [r], [MIDDLE])
        arms = lesson.Arms(np.array([r]), np.zeros((1, 2)), np.array([k_n]), np.array([k_t]))
        pile = lesson.Pile(np.array([inv_mass, 0.0]), np.array([inv_inertia, 0.0]), np.full((1, 2), 0.1),
                           np.array([[0.0, 1.0, 0.0]]), np.array([0.0, -G]), mu, 1, 10.0, 1.0, 0.01)
        got = lesson.velocity_sweep_2d(np.array([v, (0.0, 0.0)], float), np.array([omega, 0.0], float),
                                       np.zeros((1, 2)), np.array([aim], float), np.array([give]), c, arms, pile)
        given = (f"a on ground b; n = (0, 1), r_a = {r} m, v = {v} m/s, ω = {omega} rad/s, J = 0, 1/m = {inv_mass}, "
                 f"1/I = {inv_inertia}, k_n = {k_n}, k_t = {k_t}, aim {aim} m/s, give {give}, μ = {mu}")
        found = np.asarray(got[2])[0], np.append(np.asarray(got[0])[0], np.asarray(got[1])[0])
        after = (v[0] - inv_mass * J_t, v[1] + inv_mass * J_n, omega + inv_inertia * (r[0] * J_n + r[1] * J_t))
        yield found, ((-J_t, J_n), after), given


@exercise("9.16", points=0.125, hint="u of a's point; J_n from aim, u_n and give; J_t within μ J_n; J = J_n n + J_t t")
def test_the_impulse_of_one_contact_with_the_ground_by_hand(lesson, draw):
    for found, expected, given in by_hand(lesson, draw):
        close("J of one contact, in x and y [N s]", found[0], expected[0], ROUND_OFF, given)


@exercise("9.16", points=0.125, hint="the change of J acts on a: v + J/m and ω + (r × J)/I, r × J = r_x J_y − r_y J_x")
def test_the_velocities_after_one_contact_with_the_ground_by_hand(lesson, draw):
    for found, expected, given in by_hand(lesson, draw):
        close("v_x, v_y and ω of body a after one contact [m/s, m/s, rad/s]", found[1], expected[1], ROUND_OFF, given)


def check_sweep_by_matrix(lesson, draw, cases):
    """Compare with a sweep over the Delassus matrix; cases (μ, whether the last body is fixed, which are soft), …"""
    for (mu, fixed, soft), pace in itertools.product(cases, (1.0, 0.0)):              # at rest J may be wrong, too
        v, omega, J, c, arms, pile, x = swept_scene(draw, lesson, mu, fixed)
        v, omega = pace * v, pace * omega
        aim, give = pace * soft * draw(-3.0, 6.0, 5), soft * draw(0.1, 2.0, 5)
        if mu == np.inf:                                                 # the first contact has much to hold
            v[0], aim[0] = 1e5 * np.array([-c.n[0, 1], c.n[0, 0]]), 20.0
        G_rows, w = rows(x, c), masses_of(pile.inv_mass, pile.inv_inertia)
        A = (G_rows * w) @ G_rows.T

        def both(J, n=c.n):
            return np.stack((np.sum(n * J, axis=1), n[:, 0] * J[:, 1] - n[:, 1] * J[:, 0]), axis=1).ravel()
        before = np.column_stack((v, omega)).ravel()
        start = both(J)
        b, new = G_rows @ before - A @ start, start.copy()
        for n in range(0, 10, 2):
            u_n, u_t = A[n:n + 2] @ new + b[n:n + 2]
            k = n // 2
            wanted = aim[k] - u_n - give[k] * A[n, n] * new[n]
            new[n] = max(0.0, new[n] + wanted / (A[n, n] * (1.0 + give[k])))
            limit = mu * new[n] if new[n] > 0.0 else 0.0
            new[n + 1] = np.clip(new[n + 1] - u_t / A[n + 1, n + 1], -limit, limit)
        after = (before + w * (G_rows.T @ (new - start))).reshape(-1, 3)
        for size in SIZES:
            got_v, got_omega, got_J = (np.asarray(part) / size for part in lesson.velocity_sweep_2d(
                size * v, size * omega, size * J, size * aim, give, c, arms, pile))
            given, allowed = f"μ = {mu}, aim = {size * aim}, give = {give}", 1e-7 if mu == np.inf else 1e-11
            close("J after the sweep, along n and t of each contact, over its size [-]", both(got_J), new, allowed,
                  given)
            close("velocities after the sweep, over their size [-]", got_v, after[:, :2], allowed, given)
            close("angular velocities after the sweep, over their size [-]", got_omega, after[:, 2], allowed, given)


HARD, LOOSE = np.zeros(5), np.array([1.0, 1.0, 0.0, 1.0, 0.0])           # which of five contacts are soft


@exercise("9.16", points=0.125,
          hint="u from the newest velocities; J_n and J_t from this u; the change acts on both bodies "
               "at once; a body with an inverse mass of 0 may still turn; visit contacts of bodies at rest, too")
def test_a_sweep_over_velocities_does_what_the_matrix_says(lesson, draw):
    check_sweep_by_matrix(lesson, draw, ((draw(0.1, 0.9), True, HARD), (draw(0.1, 0.9), False, HARD),
                                         (0.0, True, HARD), (draw(0.1, 0.9), "axle", HARD),
                                         (draw(0.1, 0.9), "axles", HARD)))


@exercise("9.16", points=0.125,
          hint="aim[k] and give[k] belong to contact k, and to J_n only: friction uses neither")
def test_a_sweep_over_soft_contacts_does_what_the_matrix_says(lesson, draw):
    check_sweep_by_matrix(lesson, draw, ((draw(0.1, 0.9), True, LOOSE), (draw(0.1, 0.9), False, LOOSE),
                                         (draw(2.0, 9.0), False, LOOSE)))


@exercise("9.16", points=0.125, hint="μ = ∞: no limit where J_n > 0, and 0 where J_n = 0; ∞ · 0 is NaN")
def test_a_sweep_with_infinite_friction_does_what_the_matrix_says(lesson, draw):
    check_sweep_by_matrix(lesson, draw, ((np.inf, True, HARD), (np.inf, False, LOOSE)))


@exercise("9.16", points=0.125,
          hint="k_n (1 + give) below, aim − u_n − give k_n J_n above: then u_n = aim − give k_n J_n holds afterwards")
def test_a_contact_alone_gets_what_it_asks_for(lesson, draw):
    # A contact in motion, and one at rest that has pushed and may now close a gap.
    for give, (part, held, more) in itertools.product((0.0, draw(0.1, 2.0)), ((1.0, 0.1, draw(5.0, 9.0)),
                                                                            (0.0, 100.0, -draw(20.0, 25.0)))):
        v, omega, J, c, arms, pile, x = swept_scene(draw, lesson, 0.0)
        v, omega = part * v, part * omega
        only = [c.a[:1], c.b[:1], c.n[:1], c.p[:1], c.gap[:1]]
        alone = lesson.ContactSet(c.first, *(field.copy() for field in only))
        arm = lesson.Arms(*(field[:1].copy() for field in arms))
        aim = np.sum(alone.n * velocities_at(x, alone, np.column_stack((v, omega))), axis=1) + more
        swept = lesson.velocity_sweep_2d(v, omega, held * alone.n, aim, np.array([give]), alone, arm, pile)
        v, omega, J = map(np.asarray, swept)
        u_n = np.sum(alone.n * velocities_at(x, alone, np.column_stack((v, omega))))
        rounded = 1e-15 * held * arm.k_n[0] * (1.0 + give)               # of what the old J_n stands for, up to 5e4 m/s
        close("u_n + give k_n J_n after the visit [m/s]", u_n + give * arm.k_n[0] * np.sum(alone.n * J), aim[0],
              1e-11 + rounded, given=f"aim {aim[0]} m/s, give {give}")


@exercise("9.16", points=0.125, hint="J_n ≥ 0: a contact that separates faster than aim is not pulled back")
def test_a_contact_does_not_pull(lesson, draw):
    v, omega, J, c, arms, pile, x = swept_scene(draw, lesson, 0.5)
    got_v, _, got = lesson.velocity_sweep_2d(v.copy(), omega, 0.0 * J, np.full(5, -200.0), np.zeros(5), c, arms, pile)
    close("J of contacts that may approach as they do [N s]", np.asarray(got), np.zeros((5, 2)), 0.0)
    close("velocities that no impulse changes [m/s]", np.asarray(got_v), v, 0.0)
    v_fast = v + np.array([-1e3, 0.0, 0.0, 0.0])[:, None] * c.n[0]       # body 0 closes a gap too fast
    slowed = lesson.velocity_sweep_2d(v_fast, omega, 0.0 * J, np.where(np.arange(5) == 0, -20.0, -2e4), np.zeros(5), c,
                                      arms, pile._replace(mu=0.0))
    close("speed at the one contact that may approach at 20 m/s at most [m/s]",
          velocities_at(x, c, np.column_stack(slowed[:2]))[0] @ c.n[0], -20.0, 1e-9)
    one = np.where(np.arange(5) == 0, 200.0, -2000.0)
    pushed = lesson.velocity_sweep_2d(v, omega, 0.0 * J, one, np.zeros(5), c, arms, pile._replace(mu=0.0))
    close("speed at the one contact that must separate at 200 m/s [m/s]",
          velocities_at(x, c, np.column_stack(pushed[:2]))[0] @ c.n[0], 200.0, 1e-10)


def a_change(v_new, v):
    """A sweep over bodies that move as they like changes their velocities."""
    between("how much the sweep changes velocities [m/s]", np.linalg.norm(np.asarray(v_new) - v), 0.01, np.inf)


@exercise("9.16", points=0.125,
          hint="J acts on a and −J on b, each at its own offset and with its own mass")
def test_a_sweep_keeps_momentum(lesson, draw):
    for mu in (0.0, draw(0.1, 0.9)):
        v, omega, J, c, arms, pile, x = swept_scene(draw, lesson, mu, fixed=False)
        aim, give = draw(-1.0, 1.0, 5), draw(0.0, 1.0, 5)

        def total(v, omega, x=x, pile=pile):
            orbit = (x[:, 0] * v[:, 1] - x[:, 1] * v[:, 0]) / pile.inv_mass
            return np.append((v / pile.inv_mass[:, None]).sum(axis=0), np.sum(omega / pile.inv_inertia + orbit))

        got = [np.asarray(part) for part in lesson.velocity_sweep_2d(v, omega, J, aim, give, c, arms, pile)]
        close("momentum and angular momentum about the origin [kg m/s, kg m²/s]", total(got[0], got[1]),
              total(v, omega), 1e-11, given=f"μ = {mu}")
        a_change(got[0], v)


@exercise("9.16", points=0.125, hint="J_n ≥ 0, and |J_t| is at most μ times the new J_n; keep both parts of J")
def test_a_sweep_leaves_every_impulse_in_its_cone(lesson, draw):
    for mu in (draw(0.1, 0.9), 0.0):
        v, omega, J, c, arms, pile, _ = swept_scene(draw, lesson, mu, fixed=False)
        aim, give = draw(-1.0, 1.0, 5), draw(0.0, 1.0, 5)
        got_v, _, got = lesson.velocity_sweep_2d(v.copy(), omega.copy(), J.copy(), aim, give, c, arms, pile)
        a_change(got_v, v)
        got, pushed = np.asarray(got), np.zeros_like(v)
        np.add.at(pushed, c.a, got - J)
        np.subtract.at(pushed, c.b, got - J)
        close("velocities that these impulses give [m/s]", got_v, v + pile.inv_mass[:, None] * pushed, 1e-11,
              given=f"μ = {mu}")
        normal, along = np.sum(c.n * got, axis=1), np.abs(c.n[:, 0] * got[:, 1] - c.n[:, 1] * got[:, 0])
        close("impulses that pull, or are outside their cone [-]", (normal < -1e-13) | (along > mu * normal + 1e-12),
              np.zeros(5), 0.0)


@exercise("9.16", points=0.125, hint="a body with an inverse mass and inertia of 0 keeps its velocity")
def test_a_sweep_moves_no_plane(lesson, draw):
    v, omega, J, c, arms, pile, _ = swept_scene(draw, lesson, 0.5)
    got_v, got_omega, _ = lesson.velocity_sweep_2d(v.copy(), omega.copy(), J.copy(), np.zeros(5), np.zeros(5), c, arms,
                                                   pile)
    close("velocity of what cannot be moved [m/s]", np.append(np.asarray(got_v)[3], np.asarray(got_omega)[3]),
          np.append(v[3], omega[3]), 0.0)
    a_change(got_v, v)
    none, no_arms = contacts_of(lesson, [], [], J[:0], J[:0], bodies=4), lesson.Arms(*(part[:0] for part in arms))
    given = v, omega, J[:0].copy()
    got = lesson.velocity_sweep_2d(*given, np.zeros(0), np.zeros(0), none, no_arms, pile)
    for what, new, old in zip(("v", "ω", "J"), got, given, strict=True):
        close(f"{what} without contacts", new, old, 0.0)
        truth(f"whether {what} without contacts is the given array itself", np.shares_memory(np.asarray(new), old),
              False)


# ---------------------------------------------------------------------------------------------- other solvers

def nearest_within(value, low, high):
    """The point within the limits that is nearest to a number."""
    return low if value < low else high if value > high else value


def proximal(A, b, J, mu, r):
    """J after a sweep of the proximal map, row by row with u kept up to date."""
    new, u = J.copy(), A @ J + b
    for k in range(len(J)):
        high = np.inf if k % 2 == 0 else mu[k // 2] * new[k - 1] if new[k - 1] > 0.0 else 0.0
        change = nearest_within(new[k] - r[k] * u[k], -high if k % 2 else 0.0, high) - new[k]
        new[k] += change
        u = u + change * A[:, k]
    return new


@exercise("9.17", points=0.25, hint="J ← the point within the limits that is nearest to J − r u")
def test_the_proximal_map_leaves_lawful_impulses_alone_for_every_factor(lesson, draw):
    for r in (draw(0.1, 2.0), draw(0.01, 0.1), draw(5.0, 50.0), 10.0 ** draw(-5.0, -4.0), 10.0 ** draw(3.0, 4.0)):
        A, u, factors = np.diag(draw(0.5, 2.0, 2)), draw(0.1, 1.0, 2), r * draw(0.5, 1.5, 2)
        J = max(1.0, r) * draw(200.0, 300.0, 2)
        close("J of one contact far from its limits [N s]",
              lesson.proximal_sweep(A, u - A @ J, J, np.array([np.inf]), factors), J - factors * u,
              1e-9 * max(1.0, r * r),
              given=f"A = {A}, u = {u} m/s, J = {J} N s, r = {factors} kg")
        for _ in range(3):
            A, b, J, mu, _ = lawful(draw, 5)
            some = min(r, 0.5) * draw(0.5, 2.0, 10)                      # more would amplify round-off from row to row
            close("J after a sweep of lawful impulses [N s]", lesson.proximal_sweep(A, b, J, mu, some), J, 1e-8,
                  given=f"r = {some} kg")


@exercise("9.17", points=0.25,
          hint="J_t is limited by μ times the new J_n, after its step with r; "
               "μ = ∞ is no limit where J_n > 0, and J_t is 0 where J_n = 0: ∞ · 0 is NaN")
def test_a_proximal_sweep_with_much_friction_holds_what_pushes_and_nothing_else(lesson, draw):
    for (mu, fast), (what, u_n) in itertools.product(((np.inf, 1e3), (np.inf, 1e12), (draw(2e3, 3e3), 1e3)),
                                                     (("pushes", -draw(0.01, 0.02)), ("separates", draw(0.01, 0.02)))):
        r, u_t = draw(0.5, 2.0, 2), fast * draw(1.0, 10.0)
        J_n = max(0.0, -r[0] * u_n)
        J_t = -min(r[1] * u_t, mu * J_n) if J_n > 0.0 else 0.0
        J = lesson.proximal_sweep(np.diag(draw(0.5, 2.0, 2)), np.array([u_n, u_t]), np.zeros(2), np.array([mu]), r)
        close(f"(J_n, J_t) of a contact that {what}, J_t over the size of u_t [N s]", np.asarray(J) / [1.0, fast],
              (J_n, J_t / fast), 1e-10, given=f"μ = {mu}, u = ({u_n}, {u_t}) m/s, r = {r} kg")


@exercise("9.17", points=0.25, hint="with r = 1/A_kk for every row it is cone_sweep: −r u takes the place of −u/k")
def test_the_cone_sweep_is_a_proximal_map_with_one_over_the_diagonal(lesson, draw):
    for size in SIZES:
        A, b, J = positive_definite(draw, 8), draw(-3.0, 3.0, 8), draw(-1.0, 2.0, 8)
        mu = np.array([draw(0.1, 0.9), np.inf, draw(2.0, 9.0), 0.0])
        got = np.asarray(lesson.proximal_sweep(A, size * b, size * J, mu, 1.0 / np.diag(A))) / size
        close("J after a sweep with r = 1/A_kk, over its size [-]", got, swept(A, b, J, mu), 1e-10,
              given=f"A = {A}, b = {size * b}, J = {size * J}, μ = {mu}")


@exercise("9.17", points=0.25, hint="row k has r[k]; each u from the newest J; the limit is μ times the new J_n")
def test_every_impulse_of_a_proximal_sweep_has_its_own_factor(lesson, draw):
    for m, some in itertools.product((4, 4, 30), (draw, draw.sparse)):   # sparse: half of the contacts do not push yet
        A, b, J = positive_definite(draw, 2 * m), draw(-3.0, 3.0, 2 * m), some(-1.0, 2.0, 2 * m)
        mu = draw(0.1, 2.0, m)
        mu[::2] = 10.0 ** draw(-7.0, -1.0, len(mu[::2]))
        r = draw(0.05, 1.9, 2 * m) / np.diag(A)
        for speeds in (b, 0.0 * b):
            close("J after a sweep with other factors [N s]", lesson.proximal_sweep(A, speeds, J, mu, r),
                  proximal(A, speeds, J, mu, r), 1e-10, given=f"A = {A}, b = {speeds}, J = {J}, μ = {mu}, r = {r}")
    A, b = np.diag([1.0, 1.0, 16.0, 1.0]), np.array([-draw(1.0, 2.0), 0.0, draw(0.1, 0.5), draw(0.5, 1.0)])
    A[0, 2] = A[2, 0] = -3.0
    r = draw(0.5, 1.5, 4) / np.diag(A)
    close("J of a contact that approaches and one that does not yet, but then approaches faster [N s]",
          lesson.proximal_sweep(A, b, np.zeros(4), np.ones(2), r), proximal(A, b, np.zeros(4), np.ones(2), r),
          ROUND_OFF, given=f"A = {A}, b = {b}, J = 0, μ = 1, r = {r}")
    J, u, r = draw(2.0, 4.0, 6), np.zeros(6), draw(0.5, 1.0, 6)
    J[1::2], u[1::2] = draw(-1.0, 1.0, 3), draw(-1.0, 1.0, 3)
    close("J of three contacts that neither approach nor separate, but slip [N s]",
          lesson.proximal_sweep(2.0 * np.eye(6), u - 2.0 * J, J, np.ones(3), r), J - r * u, ROUND_OFF,
          given=f"J = {J} N s, u = {u} m/s, r = {r} kg")


@exercise("9.18", points=0.25, hint="h² = x² + y²; the derivative of h by x is x/h, so ∂φ/∂x = 1 − x/h")
def test_the_function_of_fischer_and_burmeister_and_its_slopes(lesson, draw):
    for size, quarter, apart in itertools.product((*SIZES, 1e-100, 1e100), range(4),
                                                (draw(0.1, 1.4), -1e-5 * draw(1.0, 9.0), 1e-5 * draw(1.0, 9.0))):
        angle = 0.5 * np.pi * quarter + apart
        c, s = np.cos(angle), np.sin(angle)
        got = lesson.fischer_burmeister(size * c, size * s)
        close("(φ over the size of x and y, ∂φ/∂x, ∂φ/∂y) [-]", (got[0] / size, got[1], got[2]),
              (c + s - 1.0, 1.0 - c, 1.0 - s), ROUND_OFF, given=f"x = {size * c}, y = {size * s}")
    for i, j in itertools.product((-1.0, 0.0, 1.0), repeat=2):           # on the axes, and where both are equally large
        size, h = draw(0.5, 2.0), np.sqrt(abs(i) + abs(j))
        if h > 0.0:
            close("(φ, ∂φ/∂x, ∂φ/∂y) [-]", lesson.fischer_burmeister(size * i, size * j),
                  (size * (i + j - h), 1.0 - i / h, 1.0 - j / h), ROUND_OFF, given=f"x = {size * i}, y = {size * j}")
    for y, sign in itertools.product(10.0 ** draw(-17.0, -4.0, 4), (-1.0, 1.0)):
        for pair in ((-1.0, sign * y), (sign * y, -1.0)):                # φ = −1 ± y − √(1 + y²)
            close("φ where one number is small, and the other one is below zero [-]",
                  lesson.fischer_burmeister(*pair)[0], sign * y - 0.5 * y**2 - 2.0, ROUND_OFF, given=f"(x, y) = {pair}")


@exercise("9.18", points=0.25,
          hint="x + y − h = 2xy/(x + y + h), since (x + y)² − h² = 2xy; at (0, 0) both slopes are 1 − 1/√2")
def test_no_digit_of_a_small_complementarity_is_lost(lesson, draw):
    # In the first pair the smaller number vanishes in x + y, and still it is as large as the slopes.
    for k, size in ((19, 1e18), *((k, 1.0) for k in range(1, 22))):
        little, large = 10.0**-k * draw(1.0, 10.0), size * draw(0.5, 2.0)
        with localcontext(prec=80):
            x, y = Decimal(large), Decimal(large * little)
            expected = float((x + y - (x * x + y * y).sqrt()) / y)
        for first in (True, False):
            pair = (large, large * little) if first else (large * little, large)
            close("φ over the smaller of x and y [-]", lesson.fischer_burmeister(*pair)[0] / (large * little),
                  expected, 1e-14, given=f"(x, y) = {pair}")
    close("(φ, ∂φ/∂x, ∂φ/∂y) at (0, 0) [-]", lesson.fischer_burmeister(0.0, 0.0),
          (0.0, 1.0 - 0.5**0.5, 1.0 - 0.5**0.5), ROUND_OFF)


@exercise("9.19", points=0.25, hint="u_k = 0 where u_k < A_kk λ_k, and λ_k = 0 elsewhere: one linear system for all λ")
def test_a_newton_step_from_the_right_set_of_contacts_gives_the_answer(lesson, draw):
    close("λ of one contact that approaches [N s]",
          lesson.minimum_map_step(np.array([[2.0]]), np.array([-3.0]), np.array([0.0])), [1.5], ROUND_OFF,
          given="A = 2, b = −3, λ = 0")
    close("λ of one contact that opens [N s]",
          lesson.minimum_map_step(np.array([[2.0]]), np.array([3.0]), np.array([0.5])), [0.0], ROUND_OFF,
          given="A = 2, b = 3, λ = 0.5")
    A, b = np.array([[1.0, -3.0], [-3.0, 16.0]]), np.array([-draw(1.0, 2.0), draw(0.1, 0.5)])
    close("λ of a contact that approaches and one that does not yet, but then approaches faster [N s]",
          lesson.minimum_map_step(A, b, np.zeros(2)), [-b[0], 0.0], ROUND_OFF, given=f"A = {A}, b = {b}, λ = 0")
    for m in (5, 8, 3):
        A, push = positive_definite(draw, m), np.arange(m) % 2 == 0
        lam = np.where(push, draw(0.5, 2.0, m), 0.0)
        b = np.where(push, 0.0, draw(0.5, 2.0, m)) - A @ lam
        near = lam + draw(-1e-3, 1e-3, m)
        close("λ after one step from nearby [N s]", lesson.minimum_map_step(A, b, near), lam, SOLVED,
              given=f"A = {A}, b = {b}, λ = {near}")


def solved_for(A, b, on):
    """λ where u = 0 at the contacts `on`, and λ = 0 at all others: solve for these contacts alone."""
    new = np.zeros(len(b))
    new[on] = np.linalg.solve(A[np.ix_(on, on)], -b[on])
    return new


@exercise("9.19", points=0.25, hint="compare u_k with A_kk λ_k, both in m/s; the result may pull: cut nothing off")
def test_a_newton_step_from_anywhere_solves_for_the_contacts_that_seem_to_push(lesson, draw):
    for m, (some, low, high) in itertools.product((6, 4, 30, 1, 0), (
            (draw, -1.0, 2.0), (draw, 0.0, 0.0), (draw, -2.0, -0.5), (draw, -9.0, 9.0), (draw.sparse, -1.0, 2.0))):
        A, b, lam = positive_definite(draw, m), draw(-3.0, 3.0, m), some(low, high, m)
        lam = balanced(draw, m) if low == -9.0 and m in (4, 30) else lam
        scale = 10.0 ** draw(-1.5, 1.5, m) if low > -9.0 else np.ones(m)
        expected = solved_for(A, b, A @ lam + b < np.diag(A) * lam) / scale
        A, b, lam = A * np.outer(scale, scale), b * scale, lam / scale
        for size in SIZES:                                               # the same contacts push, with another b
            got = np.asarray(lesson.minimum_map_step(A, size * b, size * lam)) / size
            close("λ after one step, over its size [-]", got * scale, expected * scale, 1e-8,
                  given=f"A = {A}, b = {size * b}, λ = {size * lam}")
    for off in (-1e-9, 0.0, 1e-9):                                       # whole numbers: what is equal has no round-off
        A = 2.0 * np.eye(4) - np.eye(4, k=1) - np.eye(4, k=-1)
        lam, tied = np.array([draw.whole(1, 9) for _ in range(4)], float), draw.whole(0, 3)
        b = np.diag(A) * lam - A @ lam + [(-1.0) ** k * draw.whole(1, 9) for k in range(4)]
        b[tied] = A[tied, tied] * lam[tied] - A[tied] @ lam + off
        on = A @ lam + b < np.diag(A) * lam
        either = [solved_for(A, b, np.where(np.arange(4) == tied, way, on)) for way in (True, False)
                  if off == 0.0 or way == (off < 0.0)]
        got = np.asarray(lesson.minimum_map_step(A, b, lam), dtype=float)
        close(f"λ after one step, where u_k − A_kk λ_k of one contact is {off} m/s [N s]", got,
              min(either, key=lambda one, got=got: np.max(np.abs(one - got))), 1e-11,
              given=f"A = {A}, b = {b}, λ = {lam}, contact {tied}")


def slid(mu, v, dt):
    """(gap [m], slip [m/s]) of a block of 1 kg that a force of its own friction has pulled for 300 steps.

    It falls first: from below the gap at which it floats, the cone would throw it up, and it would fly for many steps.
    Each step takes the velocity that is nearest to the one without impulses among those that the
    relaxation allows: u_n + gap/dt ≥ μ |u_t|.  This is what the least ½ J·A J + b·J means for the velocity.
    """
    gap, u_n, u_t = (1.0 + mu) * abs(v) * dt, 0.0, v
    for _ in range(300):
        height, slip = u_n - G * dt + gap / dt, u_t + np.sign(v) * mu * G * dt
        if height < mu * abs(slip):
            along = max(0.0, (abs(slip) + mu * height) / (1.0 + mu * mu))            # the foot on the edge of the cone
            height, slip = mu * along, np.sign(slip) * along
        u_n, u_t, gap = height - gap / dt, slip, dt * height
    return gap, u_t


@exercise("9.20", points=0.5, hint="u_n = 0 and J_t = −μ J_n sign(v): J_n gap/dt = μ J_n |v|, so the gap is μ |v| dt")
def test_a_block_that_slides_under_the_convex_relaxation_floats_at_the_predicted_gap(lesson, draw):
    for mu, v, dt in ((0.5, 2.0, 0.01), (draw(0.1, 1.0), draw(3.0, 9.0), draw(0.001, 0.02)),
                      (draw(0.1, 1.0), -draw(3.0, 9.0), draw(0.001, 0.02)),
                      (draw(1.5, 3.0), draw(3.0, 9.0), draw(0.001, 0.02))):
        gap, slip = slid(mu, v, dt)
        close("gap over that of a block which has been pulled for 300 steps [-]",
              lesson.relaxed_gap(mu, slip, dt) / gap, 1.0, 1e-9, given=f"μ = {mu}, v = {slip} m/s, dt = {dt} s")


@exercise("9.20", points=0.5, hint="a gap is never below zero: it is that of |v|; without slip or friction it is 0")
def test_a_block_that_slides_either_way_is_lifted_and_one_on_ice_is_not(lesson, draw):
    mu, v, dt = draw(0.1, 1.0), draw(0.5, 9.0), draw(0.001, 0.02)
    for size in SIZES:
        close("gap of a block that slides the other way, over that of this one [-]",
              lesson.relaxed_gap(mu, -size * v, dt) / lesson.relaxed_gap(mu, size * v, dt), 1.0, ROUND_OFF,
              given=f"μ = {mu}, v = ±{size * v} m/s, dt = {dt} s")
    for factor, k in itertools.product((0.5, 1e-6, 1e4), range(3)):
        one = np.where(np.arange(3) == k, factor, 1.0) * (mu, v, dt)
        close(f"gap with a factor of {factor} for {('μ', 'v', 'dt')[k]}, over that without it and over this factor [-]",
              lesson.relaxed_gap(*one) / lesson.relaxed_gap(mu, v, dt) / factor, 1.0, ROUND_OFF,
              given=f"(μ, v, dt) = {one}")
    close("gap of a block at rest [m]", lesson.relaxed_gap(mu, 0.0, dt), 0.0, 0.0)
    close("gap on ice [m]", lesson.relaxed_gap(0.0, v, dt), 0.0, 0.0)
    gap, slip = slid(mu, v, dt)
    close("gap over that of a block which has been pulled for 300 steps [-]", lesson.relaxed_gap(mu, slip, dt) / gap,
          1.0, 1e-9, given=f"μ = {mu}, v = {slip} m/s, dt = {dt} s")


@exercise("9.21", points=1,
          hint="the relaxation is solved, but its answer is not that of Coulomb's law: look for a residual that stays")
def test_the_curve_of_the_relaxation_ends_where_its_law_says(lesson):
    """Its residual ends at the largest μ |u_t|, which another solver of the relaxation gives."""
    right = choices.where("contact", "residuals_of_four_solvers",
                          lambda _, curve: abs(curve[-1] / residual_of_relaxation() - 1.0) < 0.01)
    choice("the letter of the convex relaxation", lesson.relaxed_curve_is(), right)


def counted(sweep):
    """(the same sweep, the list of what its calls return)."""
    returned = []

    def counting(J):
        returned.append(sweep(np.array(J, dtype=float)))
        return returned[-1].copy()
    return counting, returned


def of_normals(A, b):
    """(sweep, residual, number of impulses) of a problem without friction."""
    def sweep(lam):
        for k in range(len(lam)):
            lam[k] = max(0.0, lam[k] - (A[k] @ lam + b[k]) / A[k, k])
        return lam

    def left(lam):
        return max(abs(min(A[k, k] * lam[k], A[k] @ lam + b[k])) for k in range(len(b)))
    return sweep, left, len(b)


def left_by(lesson, sweep, residual, J, calls):
    """(residual of the method, J, what the sweep returned) after so many calls of the sweep, and no more."""
    counting, returned = counted(sweep)
    got = lesson.fewer_sweeps(counting, J, calls)
    close("shape of J [-]", np.shape(got), J.shape, 0.0)
    between("number of sweeps that it calls", len(returned), 1, calls)
    J = np.asarray(got, dtype=float)
    return residual(J), J, returned


def beaten(lesson, name, sweep, residual, size, calls=100, most=0.1, J=None):
    """Require so many calls to leave at most this share of the residual that as many sweeps leave, from J or 0."""
    J = np.zeros(size) if J is None else J
    plain = J.copy()
    for _ in range(calls):
        plain = sweep(plain)
    mine, *_ = left_by(lesson, sweep, residual, J, calls)
    between(f"residual after {calls} calls for {name}, over that of {calls} sweeps [-]", mine / residual(plain),
            0.0, most, given="" if not J.any() else f"J = {J}")


def judge_problems(draw, size=1.0):
    """[(name, sweep, residual, number of impulses)]: a stack, and a heavy body on a light one; b times size."""
    problems = {"a stack": draw(0.7, 1.4, draw.whole(10, 14)), "a heavy body on a light one": [1.0, draw(50.0, 200.0)]}
    return [(name, *of_normals(A, size * b)) for name, masses in problems.items() for A, b, _ in [chain(masses)]]


@pytest.mark.counts_calls
@exercise("9.22", points=0.5,
          hint="the change of a sweep takes the place of the gradient: J ← swept J + β p, then p ← β p + change; β is "
               "the ratio of the squared sizes of this change and the last; where it is above 1, forget p")
def test_a_method_of_ones_own_needs_far_fewer_sweeps(lesson, draw):
    for kind, size in itertools.product((0, 1), (*SIZES, 1e-9, 1e-6)):
        beaten(lesson, *judge_problems(draw, size)[kind])
    for n, calls, most in ((4, 100, 0.1), (40, 600, 0.1), (20, 15, 0.95)):
        beaten(lesson, f"a stack of {n}", *of_normals(*chain(draw(0.7, 1.4, n))[:2]), calls, most)
    beaten(lesson, "a stack of 12", *of_normals(*chain(draw(0.7, 1.4, 12))[:2]), J=draw(-20.0, 20.0, 12))


@pytest.mark.counts_calls
@exercise("9.22", points=0.25, hint="forget the direction where the change of a sweep grows, and end with a sweep")
def test_a_method_of_ones_own_obeys_the_cone_of_friction(lesson, draw):
    beaten(lesson, *judge_problems(draw)[0])                             # what it must not lose meanwhile
    x, inv_mass, inv_inertia, c, _ = stack_of(lesson, draw(0.5, 2.0, 2))
    G_rows, w, mu = rows(x, c), masses_of(inv_mass, inv_inertia), np.full(4, 0.5)
    thrown = draw(-0.6, 0.6, 2)
    b = G_rows @ np.array([(0.0, 0.0, 0.0), (thrown[0], -1.0, 0.0), (thrown[1], -1.0, 0.0)]).ravel()
    A = (G_rows * w) @ G_rows.T
    left, J, _ = left_by(lesson, lambda J: swept(A, b, J, mu), lambda J: judged(A, b, J, mu), np.zeros(8), 100)
    between("residual after a hundred calls with friction, over that without impulses [-]",
            left / judged(A, b, np.zeros(8), mu), 0.0, 1e-3, given=f"two boxes, thrown at {thrown} m/s")
    close("impulses that pull, or are outside their cone [-]",
          (J[::2] < 0.0) | (np.abs(J[1::2]) > mu * J[::2] + ROUND_OFF), np.zeros(4), 0.0)


@pytest.mark.counts_calls
@exercise("9.22", points=0.25,
          hint="where a sweep changes nothing, return what it was given: a change of 0 has no direction; only a sweep "
               "cuts off what pulls, so return what a sweep has returned")
def test_a_method_of_ones_own_stays_at_the_answer_and_returns_what_a_sweep_returned(lesson, draw):
    beaten(lesson, *judge_problems(draw)[1])
    for _ in range(5):
        A, lam = positive_definite(draw, 6), np.maximum(0.0, draw(-1.0, 1.0, 6))
        sweep, residual, size = of_normals(A, np.where(lam > 0.0, 0.0, draw(0.1, 1.0, 6)) - A @ lam)
        for calls in (1, 2, 3, 4, 5, 6, 30):
            close("J from the answer [N s]", lesson.fewer_sweeps(counted(sweep)[0], lam, calls), lam, SOLVED,
                  given=f"calls = {calls}, J = {lam}")
            pulling = np.where(lam > 0.0, lam, -1e-8)
            close("J from the answer with a little pull [N s]", lesson.fewer_sweeps(counted(sweep)[0], pulling, calls),
                  lam, 1e-6, given=f"calls = {calls}, J = {pulling}")
            _, J, returned = left_by(lesson, sweep, residual, np.zeros(size), calls)
            nearest = min(returned, key=lambda one, J=J: np.max(np.abs(one - J)))
            close("J, beside the most similar J that a sweep returned [N s]", J, nearest, ROUND_OFF,
                  given=f"calls = {calls}")
    zero = np.zeros(3)
    close("J where no impulses are needed [N s]", lesson.fewer_sweeps(counted(lambda J: 0.0 * J)[0], zero, 5), zero,
          0.0)
    sweep, *_ = of_normals(np.array([[1.0, -0.9], [-0.9, 1.0]]), draw(0.3, 0.5, 2))
    for calls in range(1, 31):
        J = np.asarray(lesson.fewer_sweeps(counted(sweep)[0], np.full(2, draw(1.0, 2.0)), calls))
        close("part that pulls of J of two contacts that separate [N s]", np.minimum(J, 0.0), np.zeros(2), 0.0,
              given=f"calls = {calls}")
