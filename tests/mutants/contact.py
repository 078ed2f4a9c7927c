"""Lesson 9: contacts that pull, look at the wrong body, forget, forgive, or stop too soon."""

import numpy as np

from solutions import contact as worked
from solutions.checks import Diverged

from . import collection, variants

wrong, right, edit, MUTANTS = collection(worked)


# 9.1 ------------------------------------------------------------------------------------------------------------
@variants
def rows(sign_b=-1.0, side=1.0, arm=1.0, swap=False, blocks=False, centre=True):
    def contact_rows(x, contacts):
        m, G = len(contacts.a), np.zeros((2 * len(contacts.a), 3 * len(x)))
        for k in range(m):
            n = contacts.n[k]
            t = side * np.array([-n[1], n[0]])
            for s, d in enumerate((t, n) if swap else (n, t)):
                row = s * m + k if blocks else 2 * k + s
                for body, sign in ((contacts.a[k], 1.0), (contacts.b[k], sign_b)):
                    r = contacts.p[k] - (x[body] if centre else 0.0)
                    G[row, 3 * body:3 * body + 2] += sign * d
                    G[row, 3 * body + 2] += sign * arm * (r[0] * d[1] - r[1] * d[0])
        return G
    return contact_rows


@right("9.1", "one motion after the other")
def contact_rows(x, contacts):
    G = np.zeros((2 * len(contacts.a), 3 * len(x)))
    n = contacts.n
    t = np.stack((-n[:, 1], n[:, 0]), axis=1)
    for first, d in ((0, n), (1, t)):
        for bodies, sign in ((contacts.a, 1.0), (contacts.b, -1.0)):
            r, k = contacts.p - x[bodies], first + 2 * np.arange(len(bodies))
            G[k, 3 * bodies] = sign * d[:, 0]
            G[k, 3 * bodies + 1] = sign * d[:, 1]
            G[k, 3 * bodies + 2] = sign * np.cross(np.pad(r, ((0, 0), (0, 1))), np.pad(d, ((0, 0), (0, 1))))[:, 2]
    return G


wrong("9.1", "gives b the same sign as a")(rows(sign_b=1.0))
wrong("9.1", "reverses the tangent")(rows(side=-1.0))
wrong("9.1", "reverses the sign of the torque")(rows(arm=-1.0))
wrong("9.1", "omits the rotation")(rows(arm=0.0))
wrong("9.1", "puts the tangent before the normal")(rows(swap=True))
wrong("9.1", "puts all normals before all tangents")(rows(blocks=True))
wrong("9.1", "takes the arms from the origin")(rows(centre=False))
edit("9.1", "takes body 0 for the ground", "contacts.b[k], -1.0)", "contacts.b[k], -1.0 if contacts.b[k] else 0.0)")
edit("9.1", "takes the arms to the surface of a, not to the middle of the gap", "contacts.p[k, 0] - x",
     "contacts.p[k, 0] + 0.5 * contacts.gap[k] * n_x - x")
edit("9.1", "omits lever arms below 1 µm", "sign * (r_x * d_y - r_y * d_x)",
     "sign * (r_x * d_y - r_y * d_x) * (abs(r_x * d_y - r_y * d_x) > 1e-6)")
edit("9.1", "gives a the minus sign and b the plus sign",
     "(contacts.a[k], 1.0), (contacts.b[k], -1.0)", "(contacts.a[k], -1.0), (contacts.b[k], 1.0)")
edit("9.1", "takes r · d in place of r × d", "(r_x * d_y - r_y * d_x)", "(r_x * d_x + r_y * d_y)")
edit("9.1", "takes the normal for the tangent, too", "(2 * k + 1, -n_y, n_x)", "(2 * k + 1, n_x, n_y)")
edit("9.1", "exchanges the components of the normal for the tangent without a sign",
     "(2 * k + 1, -n_y, n_x)", "(2 * k + 1, n_y, n_x)")
edit("9.1", "uses the arm of a for both bodies",
     "contacts.p[k, 0] - x[body, 0], contacts.p[k, 1] - x[body, 1]",
     "contacts.p[k, 0] - x[contacts.a[k], 0], contacts.p[k, 1] - x[contacts.a[k], 1]")
edit("9.1", "forgets the sign in the rotation of b", "sign * (r_x", "(r_x")
edit("9.1", "adds the two products of the arm", "(r_x * d_y - r_y * d_x)", "(r_x * d_y + r_y * d_x)")


# 9.2 ------------------------------------------------------------------------------------------------------------
@variants
def delassus(masses=lambda w: w, turned=True, diagonal=False):
    def delassus_matrix(G, w):
        A = G @ np.diag(masses(w)) @ G.T if turned else G.T @ G
        return np.diag(np.diag(A)) if diagonal else A
    return delassus_matrix


@right("9.2", "row by row")
def delassus_matrix(G, w):
    return np.array([[np.sum(r * w * s) for s in G] for r in G])


wrong("9.2", "uses the square roots of the inverse masses")(delassus(masses=np.sqrt))
wrong("9.2", "omits the masses")(delassus(masses=np.ones_like))
wrong("9.2", "omits the rotation")(delassus(masses=lambda w: w * np.resize([1.0, 1.0, 0.0], len(w))))
wrong("9.2", "returns a matrix for the bodies, not for the contacts")(delassus(turned=False))
wrong("9.2", "keeps only the diagonal")(delassus(diagonal=True))
wrong("9.2", "gives fixed bodies a small inverse mass")(delassus(masses=lambda w: np.maximum(w, 1e-13)))
edit("9.2", "divides by the inverse masses", "(G * w)", "(G / np.where(w > 0.0, w, np.inf))")
edit("9.2", "squares the inverse masses", "(G * w)", "(G * w * w)")
edit("9.2", "reverses the sign", "return (G", "return -(G")


# 9.3 ------------------------------------------------------------------------------------------------------------
@variants
def lcp_residual(size=np.abs, scale=lambda A: np.diag(A), total=np.max, pair=np.minimum, bias=1.0):
    def complementarity_residual(A, b, lam):
        return total(size(pair(scale(A) * lam, A @ lam + bias * b)))
    return complementarity_residual


@right("9.3", "contact by contact")
def complementarity_residual(A, b, lam):
    worst = 0.0
    for k in range(len(b)):
        worst = max(worst, abs(min(A[k, k] * lam[k], A[k] @ lam + b[k])))
    return worst


wrong("9.3", "does not take absolute values")(lcp_residual(size=lambda y: y))
wrong("9.3", "counts only the speed of approach")(lcp_residual(size=lambda y: np.maximum(0.0, -y)))
wrong("9.3", "compares an impulse with a velocity, without the diagonal of A")(lcp_residual(scale=lambda A: 1.0))
wrong("9.3", "returns the sum, not the largest one")(lcp_residual(total=np.sum))
wrong("9.3", "returns the root mean square, not the largest one")(lcp_residual(total=lambda y: np.sqrt(np.mean(y * y))))
wrong("9.3", "takes the product in place of the minimum")(lcp_residual(pair=np.multiply))
wrong("9.3", "takes the maximum in place of the minimum")(lcp_residual(pair=np.maximum))
wrong("9.3", "omits b")(lcp_residual(bias=0.0))
wrong("9.3", "omits the approach of a contact that pulls")(
    lcp_residual(pair=lambda x, u: np.where(x < 0.0, x, np.minimum(x, u))))
wrong("9.3", "omits the pull of a contact that approaches")(
    lcp_residual(pair=lambda x, u: np.where(u < 0.0, u, np.minimum(x, u))))
wrong("9.3", "adds pull and approach")(
    lcp_residual(pair=lambda x, u: np.where((x < 0.0) & (u < 0.0), x + u, np.minimum(x, u))))


edit("9.3", "uses the whole product A λ in place of the diagonal's", "np.diag(A) * lam,", "A @ lam,")
edit("9.3", "takes the smallest one", "np.max(np.abs", "np.min(np.abs")
edit("9.3", "returns the largest one with its sign",
     "np.max(np.abs(np.minimum(np.diag(A) * lam, A @ lam + b)))", "np.max(np.minimum(np.diag(A) * lam, A @ lam + b))")
edit("9.3", "divides by the diagonal", "np.diag(A) * lam", "lam / np.diag(A)")


# 9.4 ------------------------------------------------------------------------------------------------------------
@variants
def swept(newest=True, pulls=False, relaxed=True, backwards=False, inside=False, diagonal=True, twice=False):
    def gauss_seidel_sweep(A, b, lam, omega):
        old, lam = lam.copy(), lam.copy()
        order = range(len(lam))
        for k in (reversed(order) if backwards else [*order, *order] if twice else order):
            u = A[k] @ (lam if newest else old) + b[k]
            change = (omega if relaxed else 1.0) * u / (A[k, k] if diagonal else 1.0)
            free = lam[k] - change if not inside else (1.0 - omega) * lam[k] + omega * max(0.0, lam[k] - u / A[k, k])
            lam[k] = free if pulls else max(0.0, free)
        return lam
    return gauss_seidel_sweep


@right("9.4", "keeps the velocities up to date")
def gauss_seidel_sweep(A, b, lam, omega):
    lam, u = lam.copy(), A @ lam + b
    for k in range(len(lam)):
        change = max(-lam[k], -omega * u[k] / A[k, k])
        lam[k] += change
        u = u + change * A[:, k]
    return lam


wrong("9.4", "uses the old impulses of all contacts, as Jacobi's method does")(swept(newest=False))
wrong("9.4", "does not limit the impulses to zero or more")(swept(pulls=True))
wrong("9.4", "omits the relaxation")(swept(relaxed=False))
wrong("9.4", "visits the contacts from the last to the first")(swept(backwards=True))
wrong("9.4", "relaxes after the projection, not before")(swept(inside=True))
wrong("9.4", "does not divide by the diagonal")(swept(diagonal=False))
wrong("9.4", "makes two sweeps")(swept(twice=True))
edit("9.4", "changes its input", "lam = lam.copy()", "pass")
edit("9.4", "omits b", "+ b[k]", "")
edit("9.4", "ignores velocities below 1 nm/s", "lam[k] = np.maximum",
     "if abs(A[k] @ lam + b[k]) > 1e-9: lam[k] = np.maximum")
edit("9.4", "adds the correction", "lam[k] - omega", "lam[k] + omega")
edit("9.4", "takes the smaller of the two in place of the larger", "np.maximum(0.0", "np.minimum(0.0")
edit("9.4", "divides by the relaxation", "omega * (A[k]", "1.0 / omega * (A[k]")
edit("9.4", "subtracts b", "A[k] @ lam + b[k]", "A[k] @ lam - b[k]")
edit("9.4", "forgets the impulse so far: starts each from zero",
     "np.maximum(0.0, lam[k] - omega", "np.maximum(0.0, -omega")
edit("9.4", "multiplies by the diagonal", "/ A[k, k]", "* A[k, k]")
edit("9.4", "limits the correction, not the impulse",
     "np.maximum(0.0, lam[k] - omega * (A[k] @ lam + b[k]) / A[k, k])",
     "lam[k] + np.maximum(0.0, -omega * (A[k] @ lam + b[k]) / A[k, k])")


# 9.5 to 9.7 -----------------------------------------------------------------------------------------------------
@variants
def stack(power=2, half=2.0, shift=0, of=np.cos):
    return lambda n: of(np.pi / (half * (n + shift))) ** power


@right("9.5", "by the double angle")
def stack_contraction(n):
    return 0.5 + 0.5 * np.cos(np.pi / n)


wrong("9.5", "returns the factor of Jacobi's method")(stack(power=1))
wrong("9.5", "uses twice the angle")(stack(half=1.0))
wrong("9.5", "uses the angle for a stack between two walls")(stack(shift=1))
wrong("9.5", "uses the sine in place of the cosine")(stack(of=np.sin))
edit("9.5", "treats a stack above 40 bodies as one of 40", "np.pi / n", "np.pi / min(n, 40)")


@variants
def ratio(power=1.0, turned=False, plus=1.0):
    return lambda r: ((1.0 / r if turned else r) / (plus + (1.0 / r if turned else r))) ** power


@right("9.6", "by the inverse ratio")
def mass_ratio_contraction(r):
    return 1.0 / (1.0 + 1.0 / r)


wrong("9.6", "returns the factor of Jacobi's method")(ratio(power=0.5))
wrong("9.6", "puts the heavy body below")(ratio(turned=True))
wrong("9.6", "treats the lower body as two bodies")(ratio(plus=2.0))
edit("9.6", "uses 1 − 1/r, which is right for large mass ratios only", "r / (1.0 + r)", "1.0 - 1.0 / r")


@variants
def relaxation(root=np.sqrt, of=lambda rho: 1.0 - rho, two=2.0, factor=lambda omega: omega - 1.0):
    def best_relaxation(rho):
        omega = two / (1.0 + root(of(rho)))
        return omega, factor(omega)
    return best_relaxation


@right("9.7", "with the root below")
def best_relaxation(rho):
    s = np.sqrt(1.0 - rho)
    return 2.0 / (1.0 + s), (1.0 - s) / (1.0 + s)


wrong("9.7", "omits the square root")(relaxation(root=lambda y: y))
wrong("9.7", "takes ρ for the factor of Jacobi's method")(relaxation(of=lambda rho: 1.0 - rho * rho))
wrong("9.7", "returns half of it")(relaxation(two=1.0))
wrong("9.7", "squares the factor")(relaxation(factor=lambda omega: (omega - 1.0) ** 2))
edit("9.7", "limits ρ to 0.999", "1.0 - rho", "1.0 - min(rho, 0.999)")
wrong("9.7", "returns ω/2 for the factor")(relaxation(factor=lambda omega: 0.5 * omega))
edit("9.5", "uses degrees", "0.5 * np.pi / n", "90.0 / n")
edit("9.5", "uses n + 1 in place of n", "0.5 * np.pi / n", "0.5 * np.pi / (n + 1)")
edit("9.5", "multiplies the angle by n", "0.5 * np.pi / n", "0.5 * np.pi * n")
edit("9.5", "returns 1 minus the factor",
     "return np.cos(0.5 * np.pi / n) ** 2", "return 1.0 - np.cos(0.5 * np.pi / n) ** 2")
edit("9.6", "returns 1 minus the factor", "return r / (1.0 + r)", "return 1.0 / (1.0 + r)")
edit("9.6", "returns the inverse of the factor", "return r / (1.0 + r)", "return (1.0 + r) / r")
edit("9.6", "squares the factor", "return r / (1.0 + r)", "return (r / (1.0 + r))**2")
edit("9.7", "forgets the 1 in the denominator", "(1.0 + np.sqrt(1.0 - rho))", "np.sqrt(1.0 - rho)")
edit("9.7", "adds ρ under the root", "1.0 - rho)", "1.0 + rho)")
edit("9.7", "subtracts the root", "1.0 + np.sqrt", "1.0 - np.sqrt")
edit("9.7", "returns 1 − ω for the factor", "omega - 1.0", "1.0 - omega")
edit("9.7", "returns the factor first", "return omega, omega - 1.0", "return omega - 1.0, omega")
edit("9.7", "returns ρ for the factor", "omega - 1.0", "rho")


# 9.8 ------------------------------------------------------------------------------------------------------------
@variants
def murty(check=worked.check_independent, least=True, sides="both", everything=False, rounds=1000,
          slack=worked.CONVERGED, size=lambda terms: terms, diagonal=np.diag):
    def solve_lcp(A, b):
        check(A)
        m = len(b)
        on = np.zeros(m, bool)
        for _ in range(rounds * m):
            lam = np.zeros(m)
            lam[on] = np.linalg.solve(A[np.ix_(on, on)], -b[on])
            u, epsilon = A @ lam + b, slack * size(np.abs(A) @ np.abs(lam) + np.abs(b))
            bad = np.where(on, (lam < -epsilon / diagonal(A)) & (sides != "on"), (u < -epsilon) & (sides != "off"))
            wrongs = np.flatnonzero(bad)
            if len(wrongs) == 0:
                return lam
            k = wrongs if everything else wrongs[0] if least else wrongs[-1]
            on[k] = ~on[k]
        raise Diverged("complementarity residual [m/s]", worked.complementarity_residual(A, b, lam),
                       "use projected Gauss–Seidel")
    return solve_lcp


@right("9.8", "by enumeration, where that is possible")
def solve_lcp(A, b):
    return murty()(A, b)


wrong("9.8", "accepts redundant contacts")(murty(check=lambda A: None))
wrong("9.8", "never removes a contact from the pushing ones")(murty(sides="on"))
wrong("9.8", "never adds a contact to the pushing ones again")(murty(sides="off"))
wrong("9.8", "uses a tolerance of 1e-2")(murty(slack=1e-2))
wrong("9.8", "uses a tolerance a thousand times too large")(murty(slack=1e-10))
wrong("9.8", "uses no tolerance for round-off")(murty(slack=0.0))
wrong("9.8", "lets all wrong contacts change sides at once")(murty(everything=True))
wrong("9.8", "uses the round-off of the largest row for all rows")(murty(size=np.max))
wrong("9.8", "uses an absolute round-off of 1e-13 m/s")(murty(size=np.ones_like))
wrong("9.8", "measures round-off as a velocity, not as an impulse")(murty(diagonal=lambda A: np.ones(len(A))))
edit("9.8", "solves for the impulses of all contacts", "if pushes[k]:", "if True:")
edit("9.8", "reverses the sign of b", "A[k], -b[k]", "A[k], b[k]")
edit("9.8", "does not check its input", "check_independent(A)", "pass")
edit("9.8", "returns velocities", "return lam", "return u")
edit("9.8", "forgets the minus sign of the right-hand side", "A[k], -b[k]", "A[k], b[k]")
edit("9.8", "solves for the absolute value: never sees a pull",
     "lam = solve(matrix, right)", "lam = np.abs(solve(matrix, right))")


# 9.9 ------------------------------------------------------------------------------------------------------------
@variants
def natural(cone=lambda mu, J: mu * J if J > 0.0 else 0.0, scaled=True, tangents=True, normals=True, two_sided=True,
            total=max, own=True, given=True):
    def cone_residual(A, b, J, mu):
        u, sizes = A @ J + b, [0.0]
        for n in range(0, len(J), 2):
            k_n, k_t, new = A[n, n], A[n + 1, n + 1], max(0.0, J[n] - u[n] / A[n, n])
            limit = cone(mu[n // 2] if own else mu[0], J[n] if given else new)
            off_n = max(0.0, J[n] - u[n] / k_n) - J[n]
            off_t = min(max(J[n + 1] - u[n + 1] / k_t, -limit if two_sided else 0.0), limit) - J[n + 1]
            scale_n, scale_t = (k_n, k_t) if scaled else (1.0, 1.0)
            sizes += [scale_n * abs(off_n)] * normals + [scale_t * abs(off_t)] * tangents
        return total(sizes)
    return cone_residual


@right("9.9", "all at once")
def cone_residual(A, b, J, mu):
    u, k = A @ J + b, np.diag(A)
    free = J - u / k
    with np.errstate(invalid="ignore"):
        limit = np.where(J[::2] > 0.0, mu * J[::2], 0.0)
    free[::2], free[1::2] = np.maximum(0.0, free[::2]), np.clip(free[1::2], -limit, limit)
    return np.max(k * np.abs(free - J))


wrong("9.9", "omits the friction")(natural(cone=lambda mu, J: 0.0))
wrong("9.9", "does not limit the friction")(natural(cone=lambda mu, J: np.inf))
wrong("9.9", "omits μ in the limit")(natural(cone=lambda mu, J: max(J, 0.0)))
wrong("9.9", "compares an impulse with a velocity, without the diagonal of A")(natural(scaled=False))
wrong("9.9", "measures the normals only")(natural(tangents=False))
wrong("9.9", "measures the tangents only")(natural(normals=False))
wrong("9.9", "limits the friction to one side only")(natural(two_sided=False))
wrong("9.9", "returns the sum, not the largest one")(natural(total=sum))
wrong("9.9", "uses the friction coefficient of the first contact for all")(natural(own=False))
wrong("9.9", "uses the limit of the corrected normal impulse, not of the given one")(natural(given=False))
wrong("9.9", "allows friction where the normal impulse is negative")(
    natural(cone=lambda mu, J: mu * abs(J) if J else 0.0))
wrong("9.9", "limits μ to 1")(natural(cone=lambda mu, J: min(mu, 1.0) * J if J > 0.0 else 0.0))
wrong("9.9", "uses μ = 10 for infinite friction")(natural(cone=lambda mu, J: min(mu, 10.0) * J if J > 0.0 else 0.0))
edit("9.9", "allows a little friction without a normal impulse", "else 0.0", "else 1e-9")
edit("9.9", "multiplies an infinite μ by a normal impulse of zero",
     "mu[n // 2] * J[n] if J[n] > 0.0 else 0.0", "mu[n // 2] * np.maximum(0.0, J[n])")
edit("9.9", "omits b", "A @ J + b", "A @ J")
edit("9.9", "adds the velocity over k", "J[n] - u[n] / A[n, n])", "J[n] + u[n] / A[n, n])")
edit("9.9", "subtracts b", "A @ J + b", "A @ J - b")
edit("9.9", "takes the friction's diagonal for the normal", "A[n, n] * np.abs(J_n", "A[t, t] * np.abs(J_n")
edit("9.9", "omits the impulses in the velocity", "A @ J + b", "b")
edit("9.9", "does not limit the normal impulse to zero or more",
     "np.maximum(0.0, J[n] - u[n] / A[n, n])", "J[n] - u[n] / A[n, n]")


# 9.10 -----------------------------------------------------------------------------------------------------------
@variants
def coned(new_limit=True, newest=True, pulls=False, share=1.0, two_sided=True, friction_first=False,
          most=np.inf, by_kind=False, order=lambda contacts: contacts, quiet=0.0):
    def cone_sweep(A, b, J, mu):
        old, J = J.copy(), J.copy()

        def normal(n):
            u = A[n] @ (J if newest else old) + b[n]
            free = J[n] - u / A[n, n] if abs(u) >= quiet else J[n]
            J[n] = free if pulls else max(0.0, free)

        def tangent(n, J_n):
            limit = share * min(mu[n // 2], most) * J_n if J_n > 0.0 else 0.0
            J[n + 1] = min(max(J[n + 1] - (A[n + 1] @ (J if newest else old) + b[n + 1]) / A[n + 1, n + 1],
                               -limit if two_sided else 0.0), limit)
        for n in order(range(0, len(J), 2)):
            before = J[n]
            if friction_first:
                tangent(n, J[n])
            normal(n)
            if not (friction_first or by_kind):
                tangent(n, J[n] if new_limit else before)
        for n in range(0, len(J) if by_kind else 0, 2):
            tangent(n, J[n])
        return J
    return cone_sweep


@right("9.10", "keeps the velocities up to date")
def cone_sweep(A, b, J, mu):
    J, u = J.copy(), A @ J + b
    for k in range(len(J)):
        free = J[k] - u[k] / A[k, k]
        limit = mu[k // 2] * J[k - 1] if k % 2 and J[k - 1] > 0.0 else 0.0
        new = np.clip(free, -limit, limit) if k % 2 else max(0.0, free)
        u, J[k] = u + A[:, k] * (new - J[k]), new
    return J


wrong("9.10", "limits the friction by the old normal impulse")(coned(new_limit=False))
wrong("9.10", "uses the old impulses of all contacts, as Jacobi's method does")(coned(newest=False))
wrong("9.10", "does not limit the normal impulses to zero or more")(coned(pulls=True))
wrong("9.10", "uses half of μ")(coned(share=0.5))
wrong("9.10", "limits the friction to one side only")(coned(two_sided=False))
wrong("9.10", "updates the friction before the normal impulse")(coned(friction_first=True))
wrong("9.10", "updates all normal impulses before all friction")(coned(by_kind=True))
wrong("9.10", "visits the contacts from the last to the first")(coned(order=reversed))
wrong("9.10", "limits μ to 1")(coned(most=1.0))
wrong("9.10", "uses μ = 100 for infinite friction")(coned(most=100.0))
wrong("9.10", "ignores velocities below 1 nm/s")(coned(quiet=1e-9))
edit("9.10", "changes its input", "J = J.copy()", "pass")
edit("9.10", "multiplies an infinite μ by a normal impulse of zero",
     "mu[n // 2] * J[n] if J[n] > 0.0 else 0.0", "mu[n // 2] * J[n]")
edit("9.10", "adds the correction of the normal impulse", "J[n] - (A[n]", "J[n] + (A[n]")
edit("9.10", "adds the correction of the friction", "J[t] - (A[t]", "J[t] + (A[t]")
edit("9.10", "does not limit the friction",
     "np.minimum(np.maximum(J[t] - (A[t] @ J + b[t]) / A[t, t], -limit), limit)", "J[t] - (A[t] @ J + b[t]) / A[t, t]")
edit("9.10", "omits μ in the limit", "mu[n // 2] * J[n]", "J[n]")
edit("9.10", "uses the friction coefficient of the first contact for all", "mu[n // 2]", "mu[0]")
edit("9.10", "uses the friction's diagonal for the normal impulse", "/ A[n, n]", "/ A[t, t]")
edit("9.10", "omits b", "A[n] @ J + b[n]", "A[n] @ J")
edit("9.10", "always slides: takes the limit",
     "np.minimum(np.maximum(J[t] - (A[t] @ J + b[t]) / A[t, t], -limit), limit)",
     "limit * np.sign(J[t] - (A[t] @ J + b[t]) / A[t, t])")


# 9.11 -----------------------------------------------------------------------------------------------------------
@variants
def forces(check=worked.check_scene, bias=1.0, loaded=1.0, push=1.0, weigh=True, pulled=lambda load: load,
           friction=lambda mu: mu, told=lambda F: F, felt=lambda a: a):
    def contact_forces(x, inv_mass, inv_inertia, contacts, load, mu):
        check(x, inv_mass, inv_inertia, contacts, load, mu)
        G, w = worked.contact_rows(x, contacts), worked.inverse_masses(inv_mass, inv_inertia)
        y = pulled(load).ravel()
        F = worked.solve_contacts(worked.delassus_matrix(G, w), bias * (G @ (w * y if weigh else y)), friction(mu))
        return told(F.reshape(-1, 2)), felt(w * (loaded * y + push * (G.T @ F))).reshape(-1, 3)
    return contact_forces


@right("9.11", "accelerations first")
def contact_forces(x, inv_mass, inv_inertia, contacts, load, mu):
    worked.check_scene(x, inv_mass, inv_inertia, contacts, load, mu)
    G, w = worked.contact_rows(x, contacts), worked.inverse_masses(inv_mass, inv_inertia)
    free = w * load.ravel()
    F = worked.solve_contacts(worked.delassus_matrix(G, w), G @ free, mu)
    return F.reshape(len(mu), 2), (free + (F @ G) * w).reshape(len(x), 3)


wrong("9.11", "does not check its input")(forces(check=lambda *scene: None))
wrong("9.11", "reverses the sign of the accelerations by the loads")(forces(bias=-1.0))
wrong("9.11", "uses half of the load")(forces(bias=0.5))
wrong("9.11", "omits the load in the accelerations")(forces(loaded=0.0))
wrong("9.11", "omits the contact forces in the accelerations")(forces(push=0.0))
wrong("9.11", "takes the loads for accelerations")(forces(weigh=False))
wrong("9.11", "omits the torques of the loads")(forces(pulled=lambda load: load * [1.0, 1.0, 0.0]))
wrong("9.11", "reverses the torques of the loads")(forces(pulled=lambda load: load * [1.0, 1.0, -1.0]))
wrong("9.11", "omits loads that lift")(forces(pulled=lambda load: np.minimum(load, [np.inf, 0.0, np.inf])))
wrong("9.11", "uses the friction coefficient of the first contact for all")(
    forces(friction=lambda mu: np.full(len(mu), mu[0])))
wrong("9.11", "uses the mean friction coefficient for all")(forces(friction=lambda mu: np.full(len(mu), np.mean(mu))))
wrong("9.11", "limits μ to 3")(forces(friction=lambda mu: np.minimum(mu, 3.0)))
wrong("9.11", "drops the sign of the friction")(forces(told=np.abs))
wrong("9.11", "returns the friction on b, not on a")(forces(told=lambda F: F * [1.0, -1.0]))
wrong("9.11", "returns zero for accelerations below 1 µm/s²")(
    forces(felt=lambda a: np.where(np.abs(a) < 1e-6, 0.0, a)))
edit("9.11", "uses the inertia of the last body for all", "inverse_masses(inv_mass, inv_inertia)",
     "inverse_masses(inv_mass, np.where(inv_inertia > 0.0, inv_inertia[-1], 0.0))")
edit("9.11", "uses the mass of the last body for all", "inverse_masses(inv_mass, inv_inertia)",
     "inverse_masses(np.where(inv_mass > 0.0, inv_mass[-1], 0.0), inv_inertia)")
edit("9.11", "omits the friction", "@ (w * load.ravel()), mu)", "@ (w * load.ravel()), 0.0 * mu)")
edit("9.11", "subtracts the forces of the contacts",
     "+ np.ascontiguousarray(G.T) @ F)", "- np.ascontiguousarray(G.T) @ F)")
edit("9.11", "does not divide by the masses at the end", "a = w * (load", "a = (load")


# 9.12 -----------------------------------------------------------------------------------------------------------
@variants
def soft(angular=2.0 * np.pi, damping=2.0, opens=lambda gap, dt: (-gap / dt, 0.0), sign=-1.0, give=1.0, touches=False):
    def soft_contact(gap, hertz, zeta, dt):
        if (gap >= 0.0) if touches else (gap > 0.0):
            return opens(gap, dt)
        s = angular * hertz * dt
        return sign * s * gap / (dt * (damping * zeta + s)), give / (s * (damping * zeta + s))
    return soft_contact


@right("9.12", "from stiffness and damper")
def soft_contact(gap, hertz, zeta, dt):
    if gap > 0.0:
        return -gap / dt, 0.0
    stiffness, damper = (2.0 * np.pi * hertz) ** 2, 4.0 * np.pi * hertz * zeta
    both = damper + dt * stiffness
    return -stiffness * gap / both, 1.0 / (dt * both)


wrong("9.12", "uses the frequency in hertz in place of the angular frequency")(soft(angular=1.0))
wrong("9.12", "uses half of the damping")(soft(damping=1.0))
wrong("9.12", "reverses the sign, so that the contact pulls")(soft(sign=1.0))
wrong("9.12", "returns a hard contact, with no softness")(soft(give=0.0))
wrong("9.12", "makes the contact twice as soft")(soft(give=2.0))
wrong("9.12", "does not let a gap close")(soft(opens=lambda gap, dt: (0.0, 0.0)))
wrong("9.12", "closes an open gap by the spring")(soft(opens=lambda gap, dt: (-gap / dt, 0.5)))
wrong("9.12", "treats a gap of zero as open")(soft(touches=True))
SOFT = "-s * gap / (dt * (2.0 * zeta + s))"
edit("9.12", "limits the speed of separation to 10 m/s", SOFT, f"min(10.0, {SOFT})")
edit("9.12", "limits the speed of approach to 100 m/s", "-gap / dt, 0.0", "max(-100.0, -gap / dt), 0.0")
edit("9.12", "limits the stiffness", "s = 2.0", "s = min(5.0, 2.0 * np.pi * hertz * dt); _ = 2.0")
edit("9.12", "uses at least a little damping", "2.0 * zeta + s)),", "2.0 * max(zeta, 0.05) + s)),")
edit("9.12", "treats a gap below 1e-10 m as closed", "gap > 0.0", "gap > 1e-10")
edit("9.12", "allows an overlap of 10 µm", SOFT, SOFT.replace("gap", "min(0.0, gap + 1e-5)"))
edit("9.12", "forgets dt in the closing velocity", "-gap / dt, 0.0", "-gap, 0.0")
edit("9.12", "forgets the minus sign in the closing velocity", "-gap / dt, 0.0", "gap / dt, 0.0")
edit("9.12", "forgets the factor 2 of the damping", "/ (dt * (2.0 * zeta + s))", "/ (dt * (zeta + s))")
edit("9.12", "omits the damping", "(2.0 * zeta + s)), 1.0 / (s * (2.0 * zeta + s))", "s), 1.0 / (s * s)")
edit("9.12", "returns give first",
     "return -s * gap / (dt * (2.0 * zeta + s)), 1.0 / (s * (2.0 * zeta + s))",
     "return 1.0 / (s * (2.0 * zeta + s)), -s * gap / (dt * (2.0 * zeta + s))")
edit("9.12", "returns the reciprocal of give", "1.0 / (s * (2.0 * zeta + s))", "s * (2.0 * zeta + s)")
edit("9.12", "forgets dt in aim", "/ (dt * (2.0 * zeta + s))", "/ (2.0 * zeta + s)")
edit("9.12", "forgets one factor of the frequency in give", "1.0 / (s * (2.0 * zeta + s))", "1.0 / (2.0 * zeta + s)")


# 9.13 -----------------------------------------------------------------------------------------------------------
@variants
def disc(size=lambda J: np.sqrt(J[0] ** 2 + J[1] ** 2 + J[2] ** 2), inside=lambda size, limit: size <= limit,
         scale=1.0):
    def friction_disc(J, limit):
        length = size(J)
        return tuple(J) if inside(length, limit) else tuple(scale * limit / length * y for y in J)
    return friction_disc


@right("9.13", "shortens by a factor")
def friction_disc(J, limit):
    size = float(np.linalg.norm(J))
    return tuple(np.array(J) * (1.0 if size <= limit else limit / size))


edit("9.13", "limits each component by itself, which gives a box", "scaled(limit / size, J)",
     "(min(max(J[0], -limit), limit), min(max(J[1], -limit), limit), min(max(J[2], -limit), limit))")
wrong("9.13", "omits one component in the length")(disc(size=lambda J: np.sqrt(J[0] ** 2 + J[1] ** 2)))
wrong("9.13", "always returns an impulse on the rim")(disc(inside=lambda size, limit: size == 0.0))
wrong("9.13", "does not limit the impulse")(disc(inside=lambda size, limit: True))
wrong("9.13", "returns zero beyond the rim")(disc(scale=0.0))
edit("9.13", "limits only impulses that are 1 nN s beyond the rim", "size > limit", "size > limit + 1e-9")
edit("9.13", "returns zero where the limit is below 1 nN s",
     "scaled(limit / size, J)", "scaled((limit > 1e-9) * limit / size, J)")
edit("9.13", "drops the sign of the first component", "scaled(limit / size, J)",
     "scaled(limit / size, (abs(J[0]), J[1], J[2]))")
edit("9.13", "returns an array, not a tuple", "scaled(limit / size, J)", "np.array(scaled(limit / size, J))")
wrong("9.13", "compares the square of the length with the limit")(disc(inside=lambda size, limit: size * size <= limit))
edit("9.13", "divides by the square of the length", "limit / size, J", "limit / size**2, J")
edit("9.13", "returns a unit vector beyond the rim", "scaled(limit / size, J)", "scaled(1.0 / size, J)")
edit("9.13", "multiplies by the limit, and does not divide by the length",
     "scaled(limit / size, J)", "scaled(limit, J)")
edit("9.13", "reverses the impulse beyond the rim", "scaled(limit / size", "scaled(-limit / size")


# 9.14 -----------------------------------------------------------------------------------------------------------
@variants
def kept(partner=True, near_enough=lambda d, near: d < near, take=np.argmin, share=1.0, flat=False,
         size=lambda r, n: np.linalg.norm(r, axis=1), alike=-2.0, given=lambda J, n, m: J, once=False,
         either=False):
    def kept_impulses(contacts, old, J_old, near):
        J, taken = np.zeros(contacts.p.shape), []
        for k in range(len(contacts.a)):
            same = np.arange(old.first[contacts.a[k]], old.first[contacts.a[k] + 1])
            same = same[old.b[same] == contacts.b[k]] if partner else same
            turned = np.flatnonzero((old.a == contacts.b[k]) & (old.b == contacts.a[k]))
            same = np.append(same, turned) if either else same
            same = same[(old.n[same] @ contacts.n[k] > alike) & ~np.isin(same, taken)]
            distance = size((old.p[same] - contacts.p[k])[:, :1 if flat else None], contacts.n[k])
            if len(same) and near_enough(distance[take(distance)], near):
                s = same[take(distance)]
                J[k] = given(share * J_old[s], contacts.n[k], old.n[s])
                taken += [s] * once
        return J
    return kept_impulses


@right("9.14", "looks at all old contacts")
def kept_impulses(contacts, old, J_old, near):
    J = np.zeros(contacts.p.shape)
    for k in range(len(contacts.a)):
        best = near
        for s in np.flatnonzero((old.a == contacts.a[k]) & (old.b == contacts.b[k])):
            distance = np.linalg.norm(old.p[s] - contacts.p[k])
            if distance < best:
                best, J[k] = distance, J_old[s]
    return J


wrong("9.14", "accepts an old contact of another pair of bodies")(kept(partner=False))
wrong("9.14", "accepts an old contact at any distance")(kept(near_enough=lambda d, near: True))
wrong("9.14", "takes the first old contact of the pair")(kept(take=lambda distance: 0))
wrong("9.14", "takes the farthest old contact")(kept(take=np.argmax))
wrong("9.14", "accepts an old contact with a and b exchanged")(kept(either=True))
wrong("9.14", "keeps half of the impulse")(kept(share=0.5))
wrong("9.14", "measures the distance along x only")(kept(flat=True))
wrong("9.14", "compares the squared distance with the limit")(kept(near_enough=lambda d, near: d * d < near))
edit("9.14", "returns zero impulses", "J[k, c] = J_old[s, c]", "pass")
wrong("9.14", "measures the distance along the surface only")(
    kept(size=lambda r, n: np.linalg.norm(r - np.outer(r @ n, n), axis=1)))
wrong("9.14", "uses the largest coordinate difference for the distance")(
    kept(size=lambda r, n: np.max(np.abs(r), axis=1, initial=0.0)))
wrong("9.14", "measures the distance along x and y only")(kept(size=lambda r, n: np.linalg.norm(r[:, :2], axis=1)))
wrong("9.14", "accepts a contact exactly at the limit")(kept(near_enough=lambda d, near: d <= near))
wrong("9.14", "requires nearly the same normal")(kept(alike=0.9))
wrong("9.14", "requires a normal on the same side")(kept(alike=0.0))
wrong("9.14", "rotates the impulse with the normal")(kept(given=lambda J, n, m: J + (J @ m) * (n - m)))
wrong("9.14", "uses each old impulse once only")(kept(once=True))
edit("9.14", "compares a in place of b", "old.b[s] == contacts.b[k]", "old.b[s] == contacts.a[k]")
edit("9.14", "copies the impulse of contact k, not of the nearest one",
     "J_old[s, c]", "J_old[min(k, len(J_old) - 1), c]")
edit("9.14", "adds up the impulses of all contacts that are near enough", "J[k, c] = J_old", "J[k, c] += J_old")
edit("9.14", "leaves out the last old contact of a body",
     "range(old.first[i], old.first[i + 1])", "range(old.first[i], old.first[i + 1] - 1)")


# 9.15 -----------------------------------------------------------------------------------------------------------
@variants
def leaves(low_side=True, high_side=True, bodies=slice(None), axes=slice(None), all_of=False, nan=True, nan_high=True,
           slack=0.0, endless=False):
    def has_left_margin(low, high, wide_low, wide_high):
        inside = np.ones(low.shape, bool)
        if low_side:
            inside &= (wide_low <= low + slack) if nan else ~(wide_low > low)
        if high_side:
            inside &= (high <= wide_high + slack) if nan and nan_high else ~(high > wide_high)
        if endless:
            inside |= np.isinf(wide_low)
        inside = inside[bodies, axes]
        return bool(not inside.any() if all_of else not inside.all())
    return has_left_margin


@right("9.15", "all at once")
def has_left_margin(low, high, wide_low, wide_high):
    return bool(not (np.all(wide_low <= low) and np.all(high <= wide_high)))


wrong("9.15", "does not test the lower side")(leaves(low_side=False))
wrong("9.15", "does not test the upper side")(leaves(high_side=False))
wrong("9.15", "omits the last body")(leaves(bodies=slice(None, -1)))
wrong("9.15", "omits the last axis")(leaves(axes=slice(None, -1)))
wrong("9.15", "requires that all bodies have left")(leaves(all_of=True))
wrong("9.15", "does not notice NaN")(leaves(nan=False))
wrong("9.15", "does not notice NaN on the upper side")(leaves(nan_high=False))
wrong("9.15", "allows an excess of 10 nm")(leaves(slack=1e-8))
wrong("9.15", "counts no body as having left a box without a size")(leaves(endless=True))
edit("9.15", "counts the edge itself as outside", "wide_low[i, c] <= low[i, c] and", "wide_low[i, c] < low[i, c] and")
edit("9.15", "returns True if no body has left", "return True", "return False")
edit("9.15", "returns the opposite", "if not (wide", "if (wide")
edit("9.15", "exchanges the boxes",
     "wide_low[i, c] <= low[i, c] and high[i, c] <= wide_high[i, c]",
     "low[i, c] <= wide_low[i, c] and wide_high[i, c] <= high[i, c]")
edit("9.15", "joins the two conditions by or", "low[i, c] and high[i, c] <=", "low[i, c] or high[i, c] <=")


# 9.16 -----------------------------------------------------------------------------------------------------------
@variants
def velocity_swept(newest=True, b_too=True, spin=1.0, soft=1.0, aims=1.0, pulls=False, cone=True, old_limit=False,
                   other_arm=False, aim_of=lambda k, a: k, give_of=lambda k, a: k, slips=0.0, gives=0.0,
                   hard_only=False, again=False, most=np.inf):
    def velocity_sweep_2d(v, omega, J, aim, give, contacts, arms, pile):
        v, omega, J = v.copy(), omega.copy(), J.copy()
        v_0, omega_0 = v.copy(), omega.copy()
        for k in range(len(contacts.a)):
            a, b, n, k_n = contacts.a[k], contacts.b[k], contacts.n[k], arms.k_n[k]
            r_a, r_b = arms.r_a[k], (arms.r_a if other_arm else arms.r_b)[k]
            t, turn = np.array([-n[1], n[0]]), lambda r: np.array([-r[1], r[0]])
            w, o = (v, omega) if newest else (v_0, omega_0)
            u = w[a] + o[a] * turn(r_a) - w[b] - o[b] * turn(r_b)
            J_n = J[k] @ n
            aim_k, give_k, k_t = aim[aim_of(k, a)], give[give_of(k, a)], arms.k_t[k]
            new_n = J_n + (aims * aim_k - u @ n - soft * give_k * k_n * J_n) / (k_n * (1.0 + give_k))
            new_n = new_n if pulls else max(0.0, new_n)
            bound = J_n if old_limit else new_n
            limit = min(pile.mu, most) * bound if bound > 0.0 and not (hard_only and give_k > 0.0) else 0.0
            if again:                                                # the velocity that the new J_n leaves
                u = u + (new_n - J_n) * (n * (pile.inv_mass[a] + pile.inv_mass[b])
                                         + pile.inv_inertia[a] * (r_a[0] * n[1] - r_a[1] * n[0]) * turn(r_a)
                                         + pile.inv_inertia[b] * (r_b[0] * n[1] - r_b[1] * n[0]) * turn(r_b))
            J_t = J[k] @ t
            new_t = J_t + (slips * aim_k - u @ t - gives * give_k * k_t * J_t) / (k_t * (1.0 + gives * give_k))
            new = new_n * n + (min(max(new_t, -limit), limit) if cone else new_t) * t
            change, J[k] = new - J[k], new
            for body, r, sign in ((a, r_a, 1.0), (b, r_b, -1.0))[:2 if b_too else 1]:
                v[body] += sign * pile.inv_mass[body] * change
                omega[body] += spin * sign * pile.inv_inertia[body] * (r[0] * change[1] - r[1] * change[0])
        return v, omega, J
    return velocity_sweep_2d


right("9.16", "with vectors")(velocity_swept())
wrong("9.16", "uses the velocities before the sweep for all contacts, as Jacobi's method does")(
    velocity_swept(newest=False))
wrong("9.16", "applies no impulse to b")(velocity_swept(b_too=False))
wrong("9.16", "reverses the change of the spin")(velocity_swept(spin=-1.0))
wrong("9.16", "omits the change of the spin")(velocity_swept(spin=0.0))
wrong("9.16", "omits the softness times the impulse so far")(velocity_swept(soft=0.0))
wrong("9.16", "omits the target velocity")(velocity_swept(aims=0.0))
wrong("9.16", "does not limit the normal impulse to zero or more")(velocity_swept(pulls=True))
wrong("9.16", "does not limit the friction")(velocity_swept(cone=False))
wrong("9.16", "limits the friction by the old normal impulse")(velocity_swept(old_limit=True))
wrong("9.16", "uses the arm of a for both bodies")(velocity_swept(other_arm=True))
wrong("9.16", "uses the target of number a, not of contact k")(velocity_swept(aim_of=lambda k, a: a))
wrong("9.16", "uses the softness of number a, not of contact k")(velocity_swept(give_of=lambda k, a: a))
wrong("9.16", "uses the target of the first contact for all")(velocity_swept(aim_of=lambda k, a: 0))
wrong("9.16", "uses the softness of the first contact for all")(velocity_swept(give_of=lambda k, a: 0))
wrong("9.16", "uses the target for the friction, too")(velocity_swept(slips=1.0))
wrong("9.16", "uses the softness for the friction, too")(velocity_swept(gives=1.0))
wrong("9.16", "omits the friction of soft contacts")(velocity_swept(hard_only=True))
wrong("9.16", "computes the friction from the velocity after the normal impulse")(velocity_swept(again=True))
wrong("9.16", "uses μ = 1000 for infinite friction")(velocity_swept(most=1000.0))
edit("9.16", "changes its input", "v.copy(), omega.copy(), J.copy()", "v, omega, J")
edit("9.16", "uses the mass of a for b", "v[b, 0] -= inv_mass[b] * d_x", "v[b, 0] -= inv_mass[a] * d_x")
edit("9.16", "omits impulses below 1 nN s", "0.0 if J_n <= 0.0", "0.0 if J_n <= 1e-9")
edit("9.16", "omits the softness in the denominator", "k_n * (1.0 + give[k])", "k_n")
edit("9.16", "adds the normal velocity in place of subtracting it", "(aim[k] - u_n -", "(aim[k] + u_n -")
edit("9.16", "adds the tangential velocity", "J_t - u_t /", "J_t + u_t /")
edit("9.16", "forgets k_n", "/ (k_n * (1.0 + give[k]))", "/ (1.0 + give[k])")
edit("9.16", "uses k_n for the friction, too", "u_t / arms.k_t[k]", "u_t / k_n")
edit("9.16", "adds the change of the impulse to b, too", "v[b, 0] -= inv_mass[b] * d_x", "v[b, 0] += inv_mass[b] * d_x")
edit("9.16", "reverses the tangent in the velocity", "n_x * u_y - n_y * u_x", "n_y * u_x - n_x * u_y")
edit("9.16", "applies the whole impulse in every visit, not its change",
     "J_n * n_x - J_t * n_y - J[k, 0], J_n * n_y + J_t * n_x - J[k, 1]", "J_n * n_x - J_t * n_y, J_n * n_y + J_t * n_x")
edit("9.16", "forgets μ", "pile.mu * J_n if", "J_n if")
edit("9.16", "reverses the rotation in the velocity of a's point",
     "v[a, 0] - omega[a] * a_y", "v[a, 0] + omega[a] * a_y")
edit("9.16", "starts each impulse from zero", "J_n += (aim", "J_n = (aim")
