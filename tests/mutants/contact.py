"""Lesson 9: contacts that pull, look at the wrong body, forget, forgive, or stop too soon."""

import numpy as np

from solutions import contact as worked
from solutions.checks import Diverged

from . import collection, of_variants, same, variants

wrong, right, edit, MUTANTS = collection(worked)
wrongs, alike = of_variants(wrong)


def edits(exercise, ideas):
    """Wrong answers, {story: (part of a line of the worked answer, what takes its place)}."""
    for story, (old, new) in ideas.items():
        edit(exercise, story, old, new)


# 9.1 ------------------------------------------------------------------------------------------------------------
@variants
def rows(sign_b=-1.0, side=1.0, arm=1.0, swap=False, blocks=False, centre=True, result=same):
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
        return result(G)
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
PRODUCTS_ADDED = edit("9.1", "adds the two products of the arm", "(r_x * d_y - r_y * d_x)", "(r_x * d_y + r_y * d_x)")
wrongs("9.1", rows, {
    "returns the transpose": {"result": np.transpose},
    "returns an array for each contact": {"result": lambda G: G.reshape(-1, 2, G.shape[1])},
    "returns the rows of the normals only": {"result": lambda G: G[::2]},
    "puts all v_x first, then all v_y, then all ω": {"result": lambda G: np.hstack([G[:, c::3] for c in range(3)])},
    "puts ω before v_x and v_y": {"result": lambda G: G.reshape(len(G), -1, 3)[:, :, [2, 0, 1]].reshape(G.shape)},
    "exchanges the columns of v_x and v_y":
        {"result": lambda G: G.reshape(len(G), -1, 3)[:, :, [1, 0, 2]].reshape(G.shape)},
    "leaves out the column of the last body": {"result": lambda G: G[:, :-3]},
    "has no row where there is no contact, and no columns either": {"result": lambda G: G if G.size else np.zeros(0)},
    "rounds the entries": {"result": lambda G: np.round(G, 6)},
    "gives every row the length 1": {"result": lambda G: G / np.linalg.norm(G, axis=1)[:, None]},
    "takes half of the arm": {"arm": 0.5},
    "takes the sizes of all entries": {"result": np.abs},
})
edits("9.1", {
    "leaves out the last contact": ("range(contacts.a.size)", "range(contacts.a.size - 1)"),
    "leaves out the first contact": ("range(contacts.a.size)", "range(1, contacts.a.size)"),
    "omits body b": ("((contacts.a[k], 1.0), (contacts.b[k], -1.0))", "((contacts.a[k], 1.0),)"),
    "omits body a": ("((contacts.a[k], 1.0), (contacts.b[k], -1.0))", "((contacts.b[k], -1.0),)"),
    "uses the arm of b for both bodies": ("contacts.p[k, 0] - x[body, 0], contacts.p[k, 1] - x[body, 1]",
                                          "contacts.p[k] - x[contacts.b[k]]"),
    "takes all arms from body 0": ("contacts.p[k, 0] - x[body, 0], contacts.p[k, 1] - x[body, 1]",
                                   "contacts.p[k] - x[0]"),
    "adds centre and place in the arm": ("contacts.p[k, 0] - x[body, 0], contacts.p[k, 1] - x[body, 1]",
                                         "contacts.p[k] + x[body]"),
    "makes a matrix of whole numbers": ("3 * x.shape[0]))", "3 * x.shape[0]), int)"),
    "writes v_x to the column of the body's number, not to three times that":
        ("G[s, 3 * body] =", "G[s, body] ="),
    "adds up what two bodies write to the same column": ("G[s, 3 * body + 1] =", "G[s, 3 * contacts.a[k] + 1] +="),
    "gives the arms the length 1": ("contacts.p[k, 1] - x[body, 1]",
                                    "contacts.p[k, 1] - x[body, 1]; r_x, r_y = (r_x, r_y) / np.hypot(r_x, r_y)"),
    "takes the size of r × d": ("(r_x * d_y - r_y * d_x)", "abs(r_x * d_y - r_y * d_x)"),
    "omits the rotation of b": ("sign * (r_x", "(sign > 0.0) * (r_x"),
    "omits the rotation of a": ("sign * (r_x", "-(sign < 0.0) * (r_x"),
    "takes r × n in the row of the tangent, too": ("(r_x * d_y - r_y * d_x)", "(r_x * n_y - r_y * n_x)"),
    "omits the rotation in the rows of the tangents": ("sign * (r_x", "(s + 1) % 2 * sign * (r_x"),
    "omits the rotation in the rows of the normals": ("sign * (r_x", "s % 2 * sign * (r_x"),
    "uses the normal of the first contact for all": ("contacts.n[k, 0], contacts.n[k, 1]",
                                                     "contacts.n[0, 0], contacts.n[0, 1]"),
    "uses the place of the first contact for all": ("contacts.p[k, 0] - x[body, 0], contacts.p[k, 1] - x[body, 1]",
                                                    "contacts.p[0] - x[body]"),
    "exchanges the components of the normal": ("contacts.n[k, 0], contacts.n[k, 1]",
                                               "contacts.n[k, 1], contacts.n[k, 0]"),
    "has columns up to the last body in contact only":
        ("3 * x.shape[0]", "3 * (max(contacts.a.max(initial=-1), contacts.b.max(initial=-1)) + 1)"),
    "forgets d_x in r × d": ("(r_x * d_y - r_y * d_x)", "(r_x * d_y - r_y)"),
    "keeps only r_x d_y": ("(r_x * d_y - r_y * d_x)", "(r_x * d_y)"),
    "keeps only r_y d_x": ("(r_x * d_y - r_y * d_x)", "(-r_y * d_x)"),
    "writes v_y to the column of v_x": ("G[s, 3 * body + 1] =", "G[s, 3 * body] ="),
    "leaves out contacts with an open gap": ("G[s, 3 * body] =", "if contacts.gap[k] > 0.0: continue\n"
                                             "                G[s, 3 * body] ="),
})


@right("9.1", "by the velocities that a unit of each coordinate gives")
def contact_rows_2(x, contacts):
    m, n = len(contacts.a), len(x)
    rows = []
    for column in range(3 * n):
        v = np.zeros((n, 3))
        v[column // 3, column % 3] = 1.0
        u = sum(sign * (v[body, :2] + v[body, 2:] * np.stack(((x[body] - contacts.p)[:, 1],
                                                              (contacts.p - x[body])[:, 0]), axis=1))
                for body, sign in ((contacts.a, 1.0), (contacts.b, -1.0)))
        t = contacts.n[:, ::-1] * [-1.0, 1.0]
        rows.append(np.stack((np.sum(contacts.n * u, axis=1), np.sum(t * u, axis=1)), axis=1).ravel())
    return np.reshape(rows, (3 * n, 2 * m)).T


@right("9.1", "by a small matrix for each body of a contact")
def contact_rows_3(x, contacts):
    G = np.zeros((len(contacts.a), 2, len(x), 3))
    for k, (a, b, n, p) in enumerate(zip(contacts.a, contacts.b, contacts.n, contacts.p, strict=True)):
        both = np.array([n, (-n[1], n[0])])
        for body, sign in ((b, -1.0), (a, 1.0)):
            r = p - x[body]
            G[k, :, body] = sign * both @ np.array([[1.0, 0.0, -r[1]], [0.0, 1.0, r[0]]])
    return G.reshape(2 * len(contacts.a), 3 * len(x))


@right("9.1", "from the last contact to the first, by complex numbers")
def contact_rows_4(x, contacts):
    G = np.zeros((2 * len(contacts.a), 3 * len(x)))
    z = x[:, 0] + 1j * x[:, 1]
    for k in reversed(range(len(contacts.a))):
        n = complex(*contacts.n[k])
        for s, d in ((2 * k + 1, 1j * n), (2 * k, n)):
            for body, sign in ((contacts.a[k], 1), (contacts.b[k], -1)):
                r = complex(*contacts.p[k]) - z[body]
                G[s, 3 * body:3 * body + 3] = sign * d.real, sign * d.imag, sign * (r.conjugate() * d).imag
    return G


right("9.1", "as a list of rows")(lambda x, contacts: worked.contact_rows(x, contacts).tolist() if len(contacts.a)
                                  else worked.contact_rows(x, contacts))


edits("9.1", {
    "counts contacts by `first`, which make_contacts leaves at 0": ("range(contacts.a.size)",
                                                                    "range(contacts.first[-1])"),
    "forgets the minus sign of b for v_x": ("= sign * d_x", "= d_x"),
    "turns normals that point from a to b by the numbers of the bodies":
        ("n_x, n_y = contacts.n[k, 0], contacts.n[k, 1]",
         "n_x, n_y = contacts.n[k] * (1.0 if contacts.a[k] < contacts.b[k] else -1.0)"),
    "uses the tangent of the first contact for all": ("-n_y, n_x)", "-contacts.n[0, 1], contacts.n[0, 0])"),
})


edits("9.1", {
    "lets the tangent of a normal along an axis point along x or y": ("(2 * k + 1, -n_y, n_x)",
        "(2 * k + 1, *((-n_y, n_x) if n_x and n_y else (abs(n_y), abs(n_x))))"),
    "leaves out a second contact of the same two bodies":
        ("n_x, n_y = contacts", "if k and contacts.a[k] == contacts.a[k - 1] and contacts.b[k] == contacts.b[k - 1]: "
         "continue\n        n_x, n_y = contacts"),
})


# 9.2 ------------------------------------------------------------------------------------------------------------
@variants
def delassus(masses=same, turned=True, diagonal=False, left=lambda G, w: G @ np.diag(w), result=same):
    def delassus_matrix(G, w):
        A = left(G, masses(w)) @ G.T if turned else G.T @ G
        return result(np.diag(np.diag(A)) if diagonal else A)
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
wrongs("9.2", delassus, {
    "uses the inverse mass in place of the inverse inertia": {"masses": lambda w: np.repeat(w[::3], 3)},
    "uses the inverse inertia in place of the inverse mass": {"masses": lambda w: np.repeat(w[2::3], 3)},
    "uses the inverse mass of body 0 for all": {"masses": lambda w: np.resize(w[:3], len(w))},
    "uses the mean of the inverse masses": {"masses": lambda w: np.full(len(w), np.mean(w))},
    "uses the inverse masses from the last body to the first": {"masses": lambda w: w[::-1]},
    "gives fixed bodies the mass 1": {"masses": lambda w: np.where(w == 0.0, 1.0, w)},
    "treats small numbers as zero": {"masses": lambda w: np.where(w < 1e-12, 0.0, w)},
    "orders the inverse masses by kind, not by body": {"masses": lambda w: w.reshape(-1, 3).T.ravel()},
    "adds 1e-9 to the diagonal": {"result": lambda A: A + 1e-9 * np.eye(len(A))},
    "adds one part in 1e9 to the diagonal": {"result": lambda A: A + 1e-9 * np.diag(np.diag(A))},
    "takes the sizes of all entries": {"result": np.abs},
    "fills the upper half only": {"result": np.triu},
    "fills the lower half only": {"result": np.tril},
    "returns the diagonal as a vector": {"result": np.diag},
    "returns the rows of the normals only": {"result": lambda A: A[::2, ::2]},
    "omits what an impulse along the normal does along the tangent":
        {"result": lambda A: A * (1.0 - (np.add.outer(np.arange(len(A)), np.arange(len(A))) % 2))},
    "omits what contacts do to each other":
        {"result": lambda A: A * np.equal.outer(np.arange(len(A)) // 2, np.arange(len(A)) // 2)},
    "reverses the sign beside the diagonal": {"result": lambda A: 2.0 * np.diag(np.diag(A)) - A},
    "returns the inverse of A": {"result": np.linalg.pinv},
    "returns half of it": {"result": lambda A: 0.5 * A},
    "counts the diagonal twice": {"result": lambda A: A + np.diag(np.diag(A))},
    "adds the transpose": {"result": lambda A: A + A.T},
    "divides by the largest entry": {"result": lambda A: A / np.max(A)},
    "makes a matrix of whole numbers": {"result": lambda A: A.astype(int)},
    "returns a list of all entries": {"result": np.ravel},
    "reverses the order of the rows": {"result": lambda A: A[::-1].copy()},
})
edits("9.2", {
    "keeps only the rotation": ("(G * w)", "(G * w * (np.arange(w.size) % 3 == 2))"),
    "shifts the inverse masses by one coordinate": ("(G * w)", "(G * np.roll(w, 1))"),
    "divides by the trace": ("return (G * w) @ np.ascontiguousarray(G.T)",
                             "A = (G * w) @ G.T; return A / max(np.trace(A), 1e-300)"),
    "takes the sizes of the entries of G": ("(G * w)", "(np.abs(G) * w)"),
    "has no Gᵀ": ("(G * w) @ np.ascontiguousarray(G.T)", "G * w"),
    "changes its input": ("return (G * w)", "G *= w; return G"),
    "solves with the masses as a matrix of m rows": ("(G * w)", "(G * np.sum(w))"),
})
alike("9.2", "divides by the inverse masses", delassus,
      {"left": lambda G, w: G / w}, {"left": lambda G, w: G @ np.diag(1.0 / w)},
      {"left": lambda G, w: G @ np.linalg.inv(np.diag(w))}, {"left": lambda G, w: G @ np.linalg.pinv(np.diag(w))},
      {"left": lambda G, w: G / np.maximum(w, 1e-12)})


right("9.2", "by a sum over all coordinates")(lambda G, w: np.einsum("ri,i,si->rs", G, w, G))
right("9.2", "as a sum of outer products")(lambda G, w: sum(w[i] * np.outer(G[:, i], G[:, i]) for i in range(len(w))))
right("9.2", "with the root of the masses on both sides")(lambda G, w: (G * np.sqrt(w)) @ (G * np.sqrt(w)).T)
right("9.2", "by the diagonal matrix on the right")(lambda G, w: G @ (np.diag(w) @ G.T))


@right("9.2", "fills one half and mirrors it")
def delassus_matrix_2(G, w):
    A = np.zeros((len(G), len(G)))
    for r in range(len(G)):
        for s in range(r + 1):
            A[r, s] = A[s, r] = (G[r] * G[s]) @ w
    return A


wrongs("9.2", delassus, {
    "leaves out the last one of an odd number of rows":
        {"result": lambda A: A * (np.arange(len(A)) < len(A) // 2 * 2)},
})


wrongs("9.2", delassus, {
    "adds one part in 1e6 to the diagonal of a row that another one repeats":
        {"result": lambda A: A + 1e-6 * np.diag([row[k] * any(np.array_equal(row, other) for other in A[:k])
                                                for k, row in enumerate(A)])},
    "has 1 on the diagonal where no body can be moved": {"result": lambda A: A + np.diag(1.0 * (np.diag(A) == 0.0))},
    "takes a body for fixed that is a million times heavier than the lightest one":
        {"masses": lambda w: np.where(w < 1e-6 * np.max(w), 0.0, w)},
    "does not turn a body with an inverse mass of 0":
        {"masses": lambda w: np.where(np.repeat(w[::3], 3) > 0.0, w, 0.0)},
})


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
wrong("9.3", "counts pulling and approach, but not a push at a contact that separates")(
    lcp_residual(size=lambda y: np.maximum(0.0, -y)))
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
edit("9.3", "divides by the diagonal", "np.diag(A) * lam", "lam / np.diag(A)")
wrongs("9.3", lcp_residual, {
    "takes absolute values before the minimum, not after it": {"pair": lambda x, u: np.minimum(np.abs(x), np.abs(u))},
    "uses the diagonal entry of the first contact for all": {"scale": lambda A: A[0, 0]},
    "uses the largest diagonal entry for all": {"scale": lambda A: np.max(np.diag(A))},
    "uses the mean of the diagonal for all": {"scale": lambda A: np.mean(np.diag(A))},
    "uses the sums of the rows of A in place of the diagonal": {"scale": lambda A: A.sum(axis=1)},
    "uses the root of the diagonal": {"scale": lambda A: np.sqrt(np.diag(A))},
    "subtracts b": {"bias": -1.0},
    "returns the mean, not the largest one": {"total": np.mean},
    "returns the length of the vector, not its largest entry": {"total": np.linalg.norm},
    "returns the sum of squares": {"total": lambda y: np.sum(y * y)},
    "returns a number for each contact": {"total": lambda y: y},
    "returns the number of the worst contact": {"total": np.argmax},
    "leaves out the last contact": {"total": lambda y: np.max(y[:-1], initial=0.0)},
    "leaves out the first contact": {"total": lambda y: np.max(y[1:], initial=0.0)},
    "squares the residual": {"total": lambda y: np.max(y) ** 2},
    "returns 0 for a small residual": {"total": lambda y: np.max(y) if np.max(y) > 1e-9 else 0.0},
    "returns at most 1": {"total": lambda y: min(1.0, np.max(y))},
    "returns the median": {"total": np.median},
    "counts the number of contacts that are wrong": {"total": lambda y: np.count_nonzero(y > 1e-12)},
    "returns the root": {"size": lambda y: np.sqrt(np.abs(y))},
    "returns half of it": {"size": lambda y: 0.5 * np.abs(y)},
    "looks at velocities only": {"pair": lambda x, u: u},
    "looks at impulses only": {"pair": lambda x, u: x},
    "looks at approach only, and not at impulses": {"pair": lambda x, u: np.minimum(0.0, u)},
    "looks at pulling only, and not at velocities": {"pair": lambda x, u: np.minimum(0.0, x)},
    "counts contacts that push only": {"pair": lambda x, u: np.where(x > 0.0, np.minimum(x, u), 0.0)},
    "counts contacts that do not push only": {"pair": lambda x, u: np.where(x > 0.0, 0.0, np.minimum(x, u))},
    "takes the velocity of every contact that pushes": {"pair": lambda x, u: np.where(x > 0.0, u, np.minimum(x, u))},
    "takes the velocity of a contact that pushes, else only its approach":
        {"pair": lambda x, u: np.where(x > 0.0, u, np.minimum(0.0, u))},
    "adds impulse and velocity": {"pair": np.add},
    "subtracts the velocity": {"pair": np.subtract},
    "takes the root of the product": {"pair": lambda x, u: np.sqrt(np.abs(x * u))},
    "measures the product where both are positive": {"pair": lambda x, u: np.where((x > 0.0) & (u > 0.0), x * u,
                                                                                np.minimum(x, u))},
})
edits("9.3", {
    "divides the velocity by the diagonal": ("A @ lam + b", "(A @ lam + b) / np.diag(A)"),
    "takes the last contact only": ("np.max(np.abs(np.minimum(np.diag(A) * lam, A @ lam + b)))",
                                    "np.abs(np.minimum(np.diag(A) * lam, A @ lam + b))[-1]"),
    "takes the first contact only": ("np.max(np.abs(np.minimum(np.diag(A) * lam, A @ lam + b)))",
                                     "np.abs(np.minimum(np.diag(A) * lam, A @ lam + b))[0]"),
    "takes pulls for zero in the velocity": ("A @ lam + b", "A @ np.maximum(lam, 0.0) + b"),
    "leaves out the impulses of the other contacts": ("A @ lam + b", "np.diag(A) * lam + b"),
    "omits the impulses in the velocity": ("A @ lam + b", "b"),
    "returns an impulse, not a velocity": ("np.minimum(np.diag(A) * lam, A @ lam + b)",
                                           "np.minimum(lam, (A @ lam + b) / np.diag(A))"),
    "measures against the largest b": ("return np.max", "return 1.0 / np.max(np.abs(b)) * np.max"),
    "changes its input": ("return np.max", "b += A @ lam; b -= A @ lam; lam *= 1.000001; return np.max"),
})
edit("9.3", "returns the largest |λ u|",
     "np.max(np.abs(np.minimum(np.diag(A) * lam, A @ lam + b)))", "np.max(np.abs(lam * (A @ lam + b)))")


right("9.3", "by the projection: |λ − max(0, λ − u/A)| times A")(
    lambda A, b, lam: max(np.diag(A) * np.abs(lam - np.maximum(0.0, lam - (A @ lam + b) / np.diag(A)))))
right("9.3", "by half of sum and size of the difference")(
    lambda A, b, lam: 0.5 * np.linalg.norm((x := np.diag(A) * lam) + (u := A @ lam + b) - np.abs(x - u), np.inf))
right("9.3", "by the larger of the negatives")(
    lambda A, b, lam: float(np.abs(np.maximum(-np.diag(A) * lam, -(b + lam @ A.T))).max()))


@right("9.3", "by cases")
def complementarity_residual_2(A, b, lam):
    worst = 0.0
    for k in range(len(lam)):
        u = sum(A[k, l] * lam[l] for l in range(len(lam))) + b[k]
        x = A[k, k] * lam[k]
        size = abs(x) if x <= u else abs(u)
        if size > worst:
            worst = size
    return worst


edits("9.3", {
    "returns 0 where no contact has an impulse": ("return np.max", "return 0.0 if not np.any(lam) else np.max"),
    "returns the size of the smallest minimum, if that is below zero":
        ("np.abs(np.minimum(np.diag(A) * lam, A @ lam + b))",
         "(lambda y: np.abs(y) if np.min(y) >= 0.0 else -np.min(y))(np.minimum(np.diag(A) * lam, A @ lam + b))"),
    "uses the largest entry of each row in place of the diagonal": ("np.diag(A)", "np.max(np.abs(A), axis=1)"),
    "does not take absolute values of a single contact":
        ("np.abs(np.minimum(np.diag(A) * lam, A @ lam + b))",
         "(np.abs if lam.size > 1 else np.array)(np.minimum(np.diag(A) * lam, A @ lam + b))"),
})


# 9.4 ------------------------------------------------------------------------------------------------------------
@variants
def swept(newest=True, pulls=False, relaxed=True, backwards=False, inside=False, diagonal=True, twice=False,
          result=lambda lam, old: lam):
    def gauss_seidel_sweep(A, b, lam, omega):
        old, lam = lam.copy(), lam.copy()
        order = range(len(lam))
        for k in (reversed(order) if backwards else [*order, *order] if twice else order):
            u = A[k] @ (lam if newest else old) + b[k]
            change = (omega if relaxed else 1.0) * u / (A[k, k] if diagonal else 1.0)
            free = lam[k] - change if not inside else (1.0 - omega) * lam[k] + omega * max(0.0, lam[k] - u / A[k, k])
            lam[k] = free if pulls else max(0.0, free)
        return result(lam, old)
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
wrong("9.4", "relaxes after a pull is cut off, not before")(swept(inside=True))
edit("9.4", "relaxes after a pull is cut off, not before",
     "np.maximum(0.0, lam[k] - omega * (A[k] @ lam + b[k]) / A[k, k])",
     "(1.0 - omega) * lam[k] + omega * np.maximum(0.0, lam[k] - (A[k] @ lam + b[k]) / A[k, k])")
wrong("9.4", "does not divide by the diagonal")(swept(diagonal=False))
wrong("9.4", "makes two sweeps")(swept(twice=True))
edit("9.4", "changes its input", "lam = float_copy(lam)", "pass")
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
edit("9.4", "limits the correction to zero or more, not the impulse: no impulse ever gets smaller",
     "np.maximum(0.0, lam[k] - omega * (A[k] @ lam + b[k]) / A[k, k])",
     "lam[k] + np.maximum(0.0, -omega * (A[k] @ lam + b[k]) / A[k, k])")
edits("9.4", {
    "leaves out the first contact": ("range(lam.size)", "range(1, lam.size)"),
    "leaves out the last contact": ("range(lam.size)", "range(lam.size - 1)"),
    "limits to zero after the sweep, not at each contact":
        ("np.maximum(0.0, lam[k] - omega * (A[k] @ lam + b[k]) / A[k, k])",
         "lam[k] - omega * (A[k] @ lam + b[k]) / A[k, k]\n    lam = np.maximum(0.0, lam)"),
    "takes the size in place of max(0, ·)": ("np.maximum(0.0, lam[k] - omega * (A[k] @ lam + b[k]) / A[k, k])",
                                             "np.abs(lam[k] - omega * (A[k] @ lam + b[k]) / A[k, k])"),
    "returns after the first contact": ("    return lam", "        return lam"),
    "returns the velocities": ("    return lam", "    return A @ lam + b"),
    "multiplies the whole new impulse by ω, the old one too": ("lam[k] - omega * (A[k] @ lam + b[k]) / A[k, k]",
                                              "omega * (lam[k] - (A[k] @ lam + b[k]) / A[k, k])"),
    "leaves out the diagonal in the sum": ("A[k] @ lam + b[k]", "A[k] @ lam - A[k, k] * lam[k] + b[k]"),
    "uses the impulses of earlier contacts only": ("A[k] @ lam + b[k]", "A[k, :k + 1] @ lam[:k + 1] + b[k]"),
    "uses the impulses of later contacts only": ("A[k] @ lam + b[k]", "A[k, k:] @ lam[k:] + b[k]"),
    "uses the old impulses of all others where none is given":
        ("lam = float_copy(lam)", "if not np.any(lam): return np.maximum(0.0, -omega * b / np.diag(A))\n"
         "    lam = float_copy(lam)"),
    "uses the impulses of the neighbours only":
        ("A[k] @ lam + b[k]", "A[k, max(0, k - 1):k + 2] @ lam[max(0, k - 1):k + 2] + b[k]"),
    "corrects only contacts that push": ("lam[k] = np.maximum", "if lam[k] > 0.0: lam[k] = np.maximum"),
    "divides by the first entry of the diagonal": ("/ A[k, k]", "/ A[0, 0]"),
    "divides by the sum of the row": ("/ A[k, k]", "/ np.sum(np.abs(A[k]))"),
    "divides by the largest entry of the diagonal": ("/ A[k, k]", "/ np.max(np.diag(A))"),
    "divides by the root of the diagonal": ("/ A[k, k]", "/ np.sqrt(A[k, k])"),
    "uses b of the first contact for all": ("b[k]) /", "b[0]) /"),
    "limits ω to 1": ("- omega *", "- min(omega, 1.0) *"),
    "limits ω to below 2": ("- omega *", "- min(omega, 1.99) *"),
    "relaxes by 2 − ω": ("- omega *", "- (2.0 - omega) *"),
    "squares ω": ("- omega *", "- omega**2 *"),
    "uses half of ω": ("- omega *", "- 0.5 * omega *"),
    "adds 1 to ω": ("- omega *", "- (1.0 + omega) *"),
    "relaxes b only": ("omega * (A[k] @ lam + b[k])", "(A[k] @ lam + omega * b[k])"),
    "relaxes the sum only, and not b": ("omega * (A[k] @ lam + b[k])", "(omega * (A[k] @ lam) + b[k])"),
    "sets the impulse to zero where its contact separates":
        ("np.maximum(0.0, lam[k] - omega * (A[k] @ lam + b[k]) / A[k, k])",
         "lam[k] - omega * (A[k] @ lam + b[k]) / A[k, k] if A[k] @ lam + b[k] < 0.0 else 0.0"),
    "limits impulses to at most 10": ("lam[k] = np.maximum(0.0, lam[k] - omega * (A[k] @ lam + b[k]) / A[k, k])",
                                      "lam[k] = np.clip(lam[k] - omega * (A[k] @ lam + b[k]) / A[k, k], 0.0, 10.0)"),
    "starts from zero": ("float_copy(lam)", "np.zeros(lam.size)"),
    "makes an array of whole numbers": ("float_copy(lam)", "lam.astype(int)"),
    "sweeps until nothing changes": ("for k in range(lam.size):", "for k in list(range(lam.size)) * 50:"),
    "sweeps there and back": ("for k in range(lam.size):", "for k in [*range(lam.size), *range(lam.size)[::-1]]:"),
    "visits every other contact first": ("for k in range(lam.size):", "for k in [*range(0, lam.size, 2), "
                                         "*range(1, lam.size, 2)]:"),
    "visits the contact that approaches fastest first":
        ("for k in range(lam.size):", "for k in np.argsort(A @ lam + b):"),
    "sorts the impulses": ("    return lam", "    return np.sort(lam)"),
})
wrongs("9.4", swept, {
    "returns the change of λ": {"result": lambda lam, old: lam - old},
    "returns the mean of old and new impulses": {"result": lambda lam, old: 0.5 * (lam + old)},
    "returns the old impulses": {"result": lambda lam, old: old},
    "returns old and new impulses": {"result": lambda lam, old: (old, lam)},
    "returns a row of a matrix": {"result": lambda lam, old: lam[None]},
})


@right("9.4", "leaves the contact's own impulse out of the sum")
def gauss_seidel_sweep_2(A, b, lam, omega):
    lam = list(lam)
    for k in range(len(lam)):
        others = sum(A[k, l] * lam[l] for l in range(len(lam)) if l != k)
        lam[k] = max(0.0, (1.0 - omega) * lam[k] - omega * (others + b[k]) / A[k, k])
    return np.array(lam)


@right("9.4", "earlier contacts from the new array, later ones from the old one")
def gauss_seidel_sweep_3(A, b, lam, omega):
    new = np.zeros(len(lam))
    for k in range(len(lam)):
        u = A[k, :k] @ new[:k] + A[k, k:] @ lam[k:] + b[k]
        new[k] = max(lam[k] - omega * u / A[k, k], 0.0)
    return new


@right("9.4", "by a branch")
def gauss_seidel_sweep_4(A, b, lam, omega):
    lam = np.array(lam, dtype=float)
    for k, row in enumerate(A):
        lam[k] -= omega / row[k] * (row @ lam + b[k])
        if lam[k] < 0.0:
            lam[k] = 0.0
    return lam


right("9.4", "as a list")(lambda A, b, lam, omega: worked.gauss_seidel_sweep(A, b, lam, omega).tolist())


edits("9.4", {
    "starts impulses that pull from zero": ("float_copy(lam)", "np.maximum(0.0, lam)"),
})


edits("9.4", {
    "makes a visit without relaxation where the relaxed one would pull":
        ("lam[k] = np.maximum(0.0, lam[k] - omega", "free = lam[k] - omega * (A[k] @ lam + b[k]) / A[k, k]\n        "
         "lam[k] = np.maximum(0.0, lam[k] - (omega if free >= 0.0 else 1.0)"),
    "ends the sweep at the first contact that is right already":
        ("lam[k] = np.maximum",
         "if k and A[k] @ lam + b[k] == 0.0 and lam[k] > 0.0: break\n        lam[k] = np.maximum"),
})


# 9.5 to 9.7 -----------------------------------------------------------------------------------------------------
@variants
def stack(power=2, half=2.0, shift=0, of=np.cos):
    return lambda n: of(np.pi / (half * (n + shift))) ** power


@right("9.5", "by the double angle")
def stack_contraction(n):
    return 0.5 + 0.5 * np.cos(np.pi / n)


@variants
def stack_rho(formula=lambda n: np.cos(0.5 * np.pi / n) ** 2):
    return lambda n: formula(n)


wrong("9.5", "returns the factor of Jacobi's method")(stack(power=1))
wrong("9.5", "uses twice the angle")(stack(half=1.0))
wrong("9.5", "uses n + 1 in place of n, as for a stack between two walls")(stack(shift=1))
wrong("9.5", "uses the sine in place of the cosine, which gives 1 minus the factor")(stack(of=np.sin))
edit("9.5", "treats a stack above 40 bodies as one of 40", "np.pi / n", "np.pi / min(n, 40)")


@variants
def ratio(power=1.0, turned=False, plus=1.0):
    return lambda r: ((1.0 / r if turned else r) / (plus + (1.0 / r if turned else r))) ** power


@right("9.6", "by the inverse ratio")
def mass_ratio_contraction(r):
    return 1.0 / (1.0 + 1.0 / r)


@variants
def ratio_rho(formula=lambda r: r / (1.0 + r)):
    return lambda r: formula(r)


wrong("9.6", "returns the factor of Jacobi's method")(ratio(power=0.5))
wrong("9.6", "returns 1/(1 + r), which is 1 minus the factor")(ratio(turned=True))
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
edit("9.5", "multiplies the angle by n", "0.5 * np.pi / n", "0.5 * np.pi * n")
edit("9.6", "returns the inverse of the factor", "return r / (1.0 + r)", "return (1.0 + r) / r")
edit("9.6", "squares the factor", "return r / (1.0 + r)", "return (r / (1.0 + r))**2")
edit("9.7", "forgets the 1 in the denominator", "(1.0 + np.sqrt(1.0 - rho))", "np.sqrt(1.0 - rho)")
edit("9.7", "adds ρ under the root", "1.0 - rho)", "1.0 + rho)")
edit("9.7", "subtracts the root", "1.0 + np.sqrt", "1.0 - np.sqrt")
edit("9.7", "returns 1 − ω for the factor", "0.25 * omega * omega * rho", "1.0 - omega")
edit("9.7", "returns the factor first", "return omega, 0.25 * omega * omega * rho", "return omega - 1.0, omega")
edit("9.7", "returns ρ for the factor", "0.25 * omega * omega * rho", "rho")
wrongs("9.5", stack_rho, {story: {"formula": formula} for story, formula in {
    "divides the cosine, not the angle, by n": lambda n: (np.cos(0.5 * np.pi) / n) ** 2,
    "squares the angle, not the cosine": lambda n: np.cos((0.5 * np.pi / n) ** 2),
    "uses 2 n + 1 in place of 2 n": lambda n: np.cos(np.pi / (2 * n + 1)) ** 2,
    "uses 2 n − 1 in place of 2 n": lambda n: np.cos(np.pi / (2 * n - 1)) ** 2,
    "uses n − 1 in place of n": lambda n: np.cos(0.5 * np.pi / (n - 1)) ** 2 if n > 1 else 0.0,
    "returns cos(π/n)": lambda n: np.cos(np.pi / n),
    "uses half of the angle": lambda n: np.cos(0.25 * np.pi / n) ** 2,
    "uses the first two terms of the cosine": lambda n: (1.0 - 0.5 * (0.5 * np.pi / n) ** 2) ** 2,
    "uses 1 − (π/2n)², which is right for high stacks only": lambda n: 1.0 - (0.5 * np.pi / n) ** 2,
    "uses an exponential, which is right for high stacks only": lambda n: np.exp(-((0.5 * np.pi / n) ** 2)),
    "returns 1 − 1/n²": lambda n: 1.0 - 1.0 / n**2,
    "returns 1 − 1/n": lambda n: 1.0 - 1.0 / n,
    "returns n/(1 + n)": lambda n: n / (1.0 + n),
    "forgets to halve 1 + cos(π/n)": lambda n: 1.0 + np.cos(np.pi / n),
    "takes the fourth power": lambda n: np.cos(0.5 * np.pi / n) ** 4,
    "takes the square root of the cosine": lambda n: np.sqrt(np.abs(np.cos(0.5 * np.pi / n))),
    "takes the second largest eigenvalue": lambda n: np.cos(1.5 * np.pi / n) ** 2,
    "takes the tangent": lambda n: np.tan(0.25 * np.pi / n) ** 2,
    "returns the number of sweeps in place of the factor": lambda n: -1.0 / np.log(np.cos(0.5 * np.pi / n) ** 2),
    "returns the logarithm of the factor": lambda n: np.log(np.cos(0.5 * np.pi / n) ** 2 + 1e-300),
    "returns the reciprocal": lambda n: 1.0 / np.cos(0.5 * np.pi / n) ** 2,
    "reverses the sign": lambda n: -np.cos(0.5 * np.pi / n) ** 2,
    "divides by 2 where it should multiply": lambda n: np.cos(np.pi / n / 0.5) ** 2,
    "forgets π": lambda n: np.cos(0.5 / n) ** 2,
    "uses 3.14 for π": lambda n: np.cos(0.5 * 3.14 / n) ** 2,
    "uses 22/7 for π": lambda n: np.cos(11.0 / 7.0 / n) ** 2,
    "uses the hyperbolic cosine": lambda n: np.cosh(0.5 * np.pi / n) ** 2,
    "divides in whole numbers": lambda n: np.cos(np.pi // (2 * n)) ** 2,
    "returns the factor of the best relaxation": lambda n: 2.0 / (1.0 + np.sin(0.5 * np.pi / n)) - 1.0,
    "uses the same factor for every height": lambda n: 0.5,
    "multiplies the factor by n": lambda n: n * np.cos(0.5 * np.pi / n) ** 2,
    "adds the eigenvalues": lambda n: np.sum(np.cos((2.0 * np.arange(1, n + 1) - 1.0) * 0.5 * np.pi / n) ** 2),
    "takes the smallest eigenvalue in size":
        lambda n: np.min(np.abs(np.cos((2.0 * np.arange(1, n + 1) - 1.0) * 0.5 * np.pi / n))) ** 2,
    "rounds the factor": lambda n: np.round(np.cos(0.5 * np.pi / n) ** 2, 3),
    "returns 1 for high stacks": lambda n: np.cos(0.5 * np.pi / n) ** 2 if n < 100 else 1.0,
}.items()})


right("9.5", "by the sine")(lambda n: 1.0 - np.sin(np.pi / (2 * n)) ** 2)
right("9.5", "by the tangent")(lambda n: 1.0 / (1.0 + np.tan(0.5 * np.pi / n) ** 2))
right("9.5", "by the largest of all eigenvalues")(
    lambda n: np.max(np.cos((2.0 * np.arange(1, n + 1) - 1.0) * np.pi / (2 * n)) ** 2))
right("9.5", "by a complex number")(lambda n: np.exp(0.5j * np.pi / n).real ** 2)
wrongs("9.6", ratio_rho, {story: {"formula": formula} for story, formula in {
    "returns r": lambda r: r,
    "returns 1/r": lambda r: 1.0 / r,
    "returns 1 − r": lambda r: 1.0 - r,
    "returns the ratio of difference and sum": lambda r: (r - 1.0) / (r + 1.0),
    "squares the ratio of difference and sum": lambda r: ((r - 1.0) / (r + 1.0)) ** 2,
    "squares the denominator": lambda r: r / (1.0 + r) ** 2,
    "takes twice the ratio": lambda r: 2.0 * r / (1.0 + r),
    "takes half of the ratio": lambda r: 0.5 * r / (1.0 + r),
    "reverses the sign": lambda r: -r / (1.0 + r),
    "squares r": lambda r: r * r / (1.0 + r * r),
    "takes the root of r": lambda r: np.sqrt(r) / (1.0 + np.sqrt(r)),
    "takes the root of r in the denominator": lambda r: r / np.sqrt(1.0 + r * r),
    "limits r to 1": lambda r: min(1.0, r),
    "returns ½, as for two equal bodies": lambda r: 0.5,
    "uses an exponential": lambda r: np.exp(-1.0 / r),
    "uses 1 − exp(−r)": lambda r: 1.0 - np.exp(-r),
    "returns 1 − 1/(1 + r)²": lambda r: 1.0 - 1.0 / (1.0 + r) ** 2,
    "subtracts in the denominator": lambda r: r / (1.0 - r) if r != 1.0 else 0.0,
    "adds 1 in the numerator, too": lambda r: (1.0 + r) / (2.0 + r),
    "counts the upper body twice": lambda r: 2.0 * r / (1.0 + 2.0 * r),
    "forgets the ground: 1/r over 2 + 1/r": lambda r: (1.0 / r) / (2.0 + 1.0 / r),
    "rounds the factor": lambda r: np.round(r / (1.0 + r), 3),
    "divides in whole numbers": lambda r: r // (1.0 + r),
    "returns at most 0.999": lambda r: min(0.999, r / (1.0 + r)),
    "returns the number of sweeps in place of the factor": lambda r: -1.0 / np.log(r / (1.0 + r)),
    "returns the logarithm": lambda r: np.log(r / (1.0 + r)),
    "takes the largest eigenvalue of A": lambda r: np.linalg.eigvalsh([[1.0, -1.0], [-1.0, 1.0 + 1.0 / r]])[1],
    "takes the smallest eigenvalue of A": lambda r: np.linalg.eigvalsh([[1.0, -1.0], [-1.0, 1.0 + 1.0 / r]])[0],
    "takes the entry beside the diagonal over the trace": lambda r: 1.0 / (2.0 + 1.0 / r),
    "divides by one diagonal entry only": lambda r: 1.0,
}.items()})


right("9.6", "by what is missing to 1")(lambda r: 1.0 - 1.0 / (1.0 + r))
right("9.6", "by the entries of A")(
    lambda r: float(np.prod([-1.0, -1.0]) / (np.array([[1.0, -1.0], [-1.0, 1.0 + 1.0 / r]]).diagonal().prod())))
right("9.6", "by the eigenvalues of the iteration")(
    lambda r: np.max(np.abs(np.linalg.eigvals(np.linalg.solve([[1.0, 0.0], [-1.0, 1.0 + 1.0 / r]],
                                                              [[0.0, 1.0], [0.0, 0.0]])))))
right("9.6", "by both masses")(lambda r: (2.0 * r) / (2.0 * r + 2.0))
wrongs("9.7", relaxation, {
    "takes the root of 1 + ρ²": {"of": lambda rho: 1.0 + rho * rho},
    "takes the root of ρ": {"of": lambda rho: rho},
    "subtracts the root of ρ": {"of": lambda rho: 1.0 - np.sqrt(rho)},
    "subtracts 1 under the root": {"of": lambda rho: np.abs(rho - 1.0) + 1e-9},
    "takes the root of 1 − ρ/2": {"of": lambda rho: 1.0 - 0.5 * rho},
    "takes the root of 1 − 2 ρ": {"of": lambda rho: abs(1.0 - 2.0 * rho)},
    "takes the cube root": {"root": np.cbrt},
    "takes the fourth root": {"root": lambda y: y**0.25},
    "squares in place of taking the root": {"root": np.square},
    "takes half of the root": {"root": lambda y: 0.5 * np.sqrt(y)},
    "takes twice the root": {"root": lambda y: 2.0 * np.sqrt(y)},
    "has 4 in place of 2 above": {"two": 4.0},
    "has 1.9 in place of 2 above": {"two": 1.9},
    "returns the root of ω − 1": {"factor": lambda omega: np.sqrt(abs(omega - 1.0))},
    "returns 2 − ω for the factor": {"factor": lambda omega: 2.0 - omega},
    "returns 1 + ω for the factor": {"factor": lambda omega: 1.0 + omega},
    "returns ω for the factor": {"factor": lambda omega: omega},
    "returns 1/ω for the factor": {"factor": lambda omega: 1.0 / omega},
    "returns 1 − 1/ω for the factor": {"factor": lambda omega: 1.0 - 1.0 / omega},
    "returns ω² − 1 for the factor": {"factor": lambda omega: omega**2 - 1.0},
    "returns 0 for the factor": {"factor": lambda omega: 0.0},
    "returns the number of sweeps for the factor": {"factor": lambda omega: -1.0 / np.log(max(omega - 1.0, 1e-300))},
})
edits("9.7", {
    "returns ω only": ("return omega, 0.25 * omega * omega * rho", "return omega"),
    "returns the factor only": ("return omega, 0.25 * omega * omega * rho", "return omega - 1.0"),
    "returns ω (1 − ρ) for the factor": ("0.25 * omega * omega * rho", "omega * (1.0 - rho)"),
    "returns ω ρ for the factor": ("0.25 * omega * omega * rho", "omega * rho"),
    "returns ρ (ω − 1) for the factor": ("0.25 * omega * omega * rho", "rho * (omega - 1.0)"),
    "returns ρ² for the factor": ("0.25 * omega * omega * rho", "rho * rho"),
    "returns the root of ρ for the factor": ("0.25 * omega * omega * rho", "np.sqrt(rho)"),
    "returns 1 − ρ for the factor": ("0.25 * omega * omega * rho", "1.0 - rho"),
    "returns √(1 − ρ) for the factor": ("0.25 * omega * omega * rho", "np.sqrt(1.0 - rho)"),
    "adds the root outside the fraction": ("2.0 / (1.0 + np.sqrt(1.0 - rho))", "2.0 / 1.0 + np.sqrt(1.0 - rho)"),
    "turns the fraction round": ("2.0 / (1.0 + np.sqrt(1.0 - rho))", "(1.0 + np.sqrt(1.0 - rho)) / 2.0"),
    "takes the root of the whole denominator": ("(1.0 + np.sqrt(1.0 - rho))", "np.sqrt(1.0 + 1.0 - rho)"),
    "adds 2 in place of 1": ("(1.0 + np.sqrt", "(2.0 + np.sqrt"),
    "limits ω to 1.9": ("2.0 / (1.0 + np.sqrt(1.0 - rho))", "min(1.9, 2.0 / (1.0 + np.sqrt(1.0 - rho)))"),
    "limits ω to 1.99": ("2.0 / (1.0 + np.sqrt(1.0 - rho))", "min(1.99, 2.0 / (1.0 + np.sqrt(1.0 - rho)))"),
    "rounds ω": ("2.0 / (1.0 + np.sqrt(1.0 - rho))", "round(2.0 / (1.0 + np.sqrt(1.0 - rho)), 3)"),
    "returns 1.5 for every ρ": ("2.0 / (1.0 + np.sqrt(1.0 - rho))", "1.5"),
    "returns 1 + ρ": ("2.0 / (1.0 + np.sqrt(1.0 - rho))", "1.0 + rho"),
    "returns 2 − √(1 − ρ)": ("2.0 / (1.0 + np.sqrt(1.0 - rho))", "2.0 - np.sqrt(1.0 - rho)"),
})


right("9.7", "as an array")(lambda rho: np.array([2.0, 1.0 - np.sqrt(1.0 - rho)]) / (1.0 + np.sqrt(1.0 - rho)))
right("9.7", "by Young's formula with the square of Jacobi's factor")(
    lambda rho: (1.0 + (s := np.sqrt(rho) / (1.0 + np.sqrt(1.0 - rho))) ** 2, s * s))
right("9.7", "by a power")(lambda rho: ((omega := 2.0 * (1.0 + (1.0 - rho) ** 0.5) ** -1), omega - 1.0))
right("9.7", "as a list")(lambda rho: list(worked.best_relaxation(rho)))


edit("9.5", "returns 1 from a thousand bodies on", "np.cos(0.5 * np.pi / n) ** 2",
     "(np.cos(0.5 * np.pi / n) ** 2 if n < 1000 else 1.0)")
edit("9.6", "returns r where that is small", "r / (1.0 + r)", "(r / (1.0 + r) if r > 0.01 else r)")
edit("9.7", "returns ω = 1 where ρ is small", "2.0 / (1.0 + np.sqrt(1.0 - rho))",
     "(2.0 / (1.0 + np.sqrt(1.0 - rho)) if rho > 1e-3 else 1.0)")


edit("9.6", "takes a ratio above a million for a million", "r / (1.0 + r)", "min(r, 1e6) / (1.0 + min(r, 1e6))")
edit("9.7", "divides a difference of nearly equal numbers by a small ρ", "2.0 / (1.0 + np.sqrt(1.0 - rho))",
     "2.0 * (1.0 - np.sqrt(1.0 - rho)) / rho if rho > 0.0 else 1.0")


# 9.8 ------------------------------------------------------------------------------------------------------------
@variants
def murty(check=worked.check_independent, least=True, sides="both", everything=False, rounds=worked.MAX_PIVOTS,
          slack=worked.CONVERGED, size=lambda terms: terms, diagonal=np.diag, most=False, gives_up=True, residual=None,
          start=False):
    def solve_lcp(A, b):
        check(A, b)
        m = len(b)
        on = np.full(m, start or sides.startswith("drops"))
        for _ in range(rounds * m):
            lam = np.zeros(m)
            lam[on] = np.linalg.solve(A[np.ix_(on, on)], -b[on])
            u, epsilon = A @ lam + b, slack * size(np.abs(A) @ np.abs(lam) + np.abs(b))
            bad = np.where(on, (lam < -epsilon / diagonal(A)) & (sides != "on"),
                           (u < -epsilon) & (sides in ("both", "on")))
            wrongs = np.flatnonzero(bad)
            if len(wrongs) == 0:
                return lam
            k = wrongs if everything or sides == "drops all" else wrongs[0] if least else wrongs[-1]
            k = np.argmin(np.where(on, lam, u)) if most else k
            on[k] = ~on[k]
        if not gives_up:
            return lam
        left = worked.complementarity_residual(A, b, lam) if residual is None else residual
        raise Diverged("complementarity residual [m/s]", left, "use projected Gauss–Seidel")
    return solve_lcp


@right("9.8", "by enumeration, where that is possible")
def solve_lcp(A, b):
    return murty()(A, b)


wrong("9.8", "does not call check_independent")(murty(check=lambda A, b: None))
wrong("9.8", "never lets a contact go that pushes once")(murty(sides="on"))
wrong("9.8", "ends with all λ at 0, regardless of b")(murty(sides="off"))
wrong("9.8", "starts with all contacts pushing, drops one that pulls at a time, and takes none back")(
    murty(sides="drops one"))
wrong("9.8", "starts with all contacts pushing, drops all that pull at once, and takes none back")(
    murty(sides="drops all"))
wrong("9.8", "changes the most wrong contact first, which may go round in circles")(murty(most=True))
wrong("9.8", "returns the last guess in place of giving up")(murty(gives_up=False))
wrong("9.8", "names a residual of 0 when it gives up")(murty(residual=0.0))
wrong("9.8", "uses a tolerance of 1e-2")(murty(slack=1e-2))
wrong("9.8", "uses a tolerance a thousand times too large")(murty(slack=1e-10))
wrong("9.8", "uses no tolerance for round-off")(murty(slack=0.0))
wrong("9.8", "lets all wrong contacts change sides at once")(murty(everything=True))
wrong("9.8", "uses the round-off of the largest row for all rows")(murty(size=np.max))
wrong("9.8", "uses an absolute round-off of 1e-13 m/s")(murty(size=np.ones_like))
wrong("9.8", "measures round-off as a velocity, not as an impulse")(murty(diagonal=lambda A: np.ones(len(A))))
edit("9.8", "solves for the impulses of all contacts", "solve(matrix, right)", "solve(A, -b)")
edit("9.8", "reverses the sign of b", "0.0), -b[k]", "0.0), b[k]")
edit("9.8", "checks the matrix only", "check_independent(A, b)", "check_independent(A, np.ones_like(b))")
edit("9.8", "returns velocities", "return lam", "return u")
edit("9.8", "solves for the absolute value: never sees a pull",
     "lam = solve(matrix, right)", "lam = np.abs(solve(matrix, right))")
edits("9.8", {
    "starts with all contacts pushing, and never lets one go":
        ("np.zeros(m, np.bool_), np.zeros(m)", "np.ones(m, np.bool_), np.zeros(m); b = np.minimum(b, 0.0)"),
    "changes the sign of u in the test": ("u[k] < -epsilon[k]", "u[k] > epsilon[k]"),
    "changes the sign of λ in the test": ("lam[k] < -epsilon[k] / A[k, k]", "lam[k] > epsilon[k] / A[k, k]"),
    "does not look at the first contact": ("range(m - 1, -1, -1)", "range(m - 1, 0, -1)"),
    "does not look at the last contact": ("range(m - 1, -1, -1)", "range(m - 2, -1, -1)"),
    "makes the wrong contact push, and never lets it go": ("pushes[wrong] = not pushes[wrong]", "pushes[wrong] = True"),
    "changes the contact after the wrong one": ("pushes[wrong] = not pushes[wrong]",
                                                "pushes[(wrong + 1) % m] = not pushes[(wrong + 1) % m]"),
    "changes the first contact in place of the wrong one": ("pushes[wrong] = not pushes[wrong]",
                                                            "pushes[0] = not pushes[0]"),
    "lets all other contacts go when one is added": ("pushes[wrong] = not pushes[wrong]",
                                                     "pushes[:] = np.arange(m) == wrong"),
    "writes columns in place of rows of A, and of the identity":
        ("matrix[k], right[k] = np.where(pushes, A[k], 0.0), -b[k]", "matrix[:, k], right[k] = A[:, k], -b[k]"),
    "gives all contacts −b on the right": ("np.eye(m), np.zeros(m)", "np.eye(m), -b"),
    "has rows of zeros for contacts that do not push": ("np.eye(m), np.zeros(m)", "1e-9 * np.eye(m), np.zeros(m) + b"),
    "keeps only the diagonal for the contacts that push": ("np.where(pushes, A[k], 0.0)", "np.eye(m)[k] * A[k, k]"),
    "limits λ to zero or more after solving": ("solve(matrix, right)", "np.maximum(0.0, solve(matrix, right))"),
    "stops after MAX_PIVOTS rounds in all": ("range(MAX_PIVOTS * m)", "range(MAX_PIVOTS)"),
    "stops after m rounds": ("range(MAX_PIVOTS * m)", "range(m)"),
    "stops after 2 m rounds": ("range(MAX_PIVOTS * m)", "range(2 * m)"),
    "stops after 10 rounds": ("range(MAX_PIVOTS * m)", "range(10)"),
    "returns b": ("return lam", "return b"),
    "returns which contacts push": ("return lam", "return pushes"),
    "returns impulses and velocities": ("return lam", "return lam, u"),
    "returns the sizes of the impulses": ("return lam", "return np.abs(lam) + 1e-9"),
    "returns −λ": ("return lam", "return -lam"),
    "subtracts b in the velocity": ("A @ lam + b, CONVERGED", "A @ lam - b, CONVERGED"),
    "omits the impulses in the round-off": ("np.abs(A) @ np.abs(lam) + np.abs(b)", "np.abs(b)"),
    "uses the velocity itself for the round-off": ("np.abs(A) @ np.abs(lam) + np.abs(b)", "np.abs(A @ lam + b)"),
    "uses a fixed round-off of 1e-9": ("np.abs(A) @ np.abs(lam) + np.abs(b)), -1",
                                       "np.abs(A) @ np.abs(lam) + np.abs(b)), -1; epsilon[:] = 1e-9"),
    "raises an error where no set fits after m rounds": ("for _ in range(MAX_PIVOTS * m):", "for _ in range(m + 1):"),
    "names the largest velocity when it gives up": ("complementarity_residual(A, b, lam), \"use",
                                                    "np.max(np.abs(A @ lam + b)), \"use"),
    "raises ValueError in place of Diverged": ("raise Diverged(", "raise ValueError("),
    "names another thing when it gives up": ("\"complementarity residual [m/s]\"", "\"residual\""),
    "changes b":
        ("u, epsilon, wrong = A @ lam + b", "b += 0.0 * b + 1e-3 * (b < 0.0); u, epsilon, wrong = A @ lam + b"),
    "checks after it has solved": ("return lam", "check_independent(A, b); return np.round(lam, 9)"),
    "solves by sweeps": ("lam = solve(matrix, right)", "lam = gauss_seidel_sweep(A, b, lam, 1.0)"),
})
for old, new in (
        ("if pushes[k] else (u[k]", "if not pushes[k] else (u[k]"),
        ("(lam[k] < -epsilon[k] / A[k, k]) if pushes[k] else (u[k] < -epsilon[k])", "lam[k] < -epsilon[k] / A[k, k]"),
        (", right[k] = np.where(pushes, A[k], 0.0), -b[k]", " = np.where(pushes, A[k], 0.0)"),
        ("    if wrong < 0:", "    if True:"),
        ("A @ lam + b, CONVERGED", "A @ lam, CONVERGED")):
    edit("9.8", "ends with all λ at 0, regardless of b", old, new)


@right("9.8", "tells pushing contacts by a set, and solves for them only")
def solve_lcp_2(A, b):
    worked.check_independent(A, b)
    on, m = set(), len(b)
    for _ in range(worked.MAX_PIVOTS * m):
        lam, some = np.zeros(m), sorted(on)
        if some:
            lam[some] = np.linalg.solve(A[np.ix_(some, some)], -b[some])
        u, slack = A @ lam + b, worked.CONVERGED * (np.abs(A) @ np.abs(lam) + np.abs(b))
        for k in range(m):
            if (k in on and lam[k] * A[k, k] < -slack[k]) or (k not in on and u[k] < -slack[k]):
                on ^= {k}
                break
        else:
            return lam
    raise Diverged("complementarity residual [m/s]", worked.complementarity_residual(A, b, lam), "no answer")


right("9.8", "changes the wrong contact of greatest index")(murty(least=False))
right("9.8", "starts with all contacts pushing")(murty(start=True))
right("9.8", "by twice as many rounds")(murty(rounds=2 * worked.MAX_PIVOTS))


edits("9.8", {
    "takes a contact for wrong that separates by round-off": ("u[k] < -epsilon[k]", "u[k] < epsilon[k]"),
    "leaves the impulses of contacts that do not push at the round-off of solve":
        ("np.where(pushes, A[k], 0.0)", "A[k]"),
    "names the residual without impulses when it gives up": ("complementarity_residual(A, b, lam)",
                                                             "complementarity_residual(A, b, 0.0 * lam)"),
    "names the largest impulse when it gives up": ("complementarity_residual(A, b, lam)", "np.max(np.abs(lam))"),
})


edits("9.8", {
    "changes the contact with the least of all A_kk λ_k and u_k, which may go round in circles":
        ("        if wrong < 0:", "        worst = np.minimum(np.where(pushes, np.diag(A) * lam, u) + epsilon, 0.0)\n"
         "        wrong = int(np.argmin(worst)) if np.min(worst) < 0.0 else -1\n        if wrong < 0:"),
    "returns 0 where no contact approaches, before it checks the matrix":
        ("check_independent(A, b)", "if np.all(b >= 0.0): return np.zeros(b.size)\n    check_independent(A, b)"),
})


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
wrong("9.9", "returns an impulse: does not multiply by k_n and k_t")(natural(scaled=False))
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
edits("9.9", {
    "adds up all contacts": ("worst = np.maximum(worst,", "worst = worst + np.maximum(0.0,"),
    "limits the friction on the upper side only": (
        "np.minimum(np.maximum(J[t] - u[t] / A[t, t], -limit), limit)", "np.minimum(J[t] - u[t] / A[t, t], limit)"),
    "has a negative limit where the contact pulls": ("mu[n // 2] * J[n] if J[n] > 0.0 else 0.0", "mu[n // 2] * J[n]"),
    "uses μ of number 2k for contact k": ("mu[n // 2]", "mu[min(n, mu.size - 1)]"),
    "looks only at contacts that push": ("J_n = np.maximum(0.0, J[n] - u[n] / A[n, n])",
                                         "J_n = np.maximum(0.0, J[n] - u[n] / A[n, n]) if J[n] > 0.0 else J[n]"),
    "uses the limit of the contact before": ("mu[n // 2] * J[n]", "mu[n // 2 - 1] * J[n]"),
    "uses the mean of μ": ("mu[n // 2] * J[n]", "np.mean(mu) * J[n]"),
    "divides by μ": ("mu[n // 2] * J[n]", "J[n] / mu[n // 2]"),
    "squares μ": ("mu[n // 2] * J[n]", "mu[n // 2] ** 2 * J[n]"),
    "uses half of the limit": ("mu[n // 2] * J[n]", "0.5 * mu[n // 2] * J[n]"),
    "takes the velocity in place of the impulse in the limit": ("mu[n // 2] * J[n]", "mu[n // 2] * abs(u[n])"),
    "takes the friction impulse in the limit": ("mu[n // 2] * J[n]", "mu[n // 2] * abs(J[t])"),
    "limits friction only where J_n ≤ 0": ("else 0.0", "else np.inf"),
    "multiplies by k in place of dividing by it, for the normal": ("u[n] / A[n, n]", "u[n] * A[n, n]"),
    "multiplies by k in place of dividing by it, for the friction": ("u[t] / A[t, t]", "u[t] * A[t, t]"),
    "does not divide by k_n": ("u[n] / A[n, n]", "u[n]"),
    "does not divide by k_t": ("u[t] / A[t, t]", "u[t]"),
    "uses k_n in place of k_t in the step": ("u[t] / A[t, t]", "u[t] / A[n, n]"),
    "uses k_t in place of k_n in the step": ("u[n] / A[n, n]", "u[n] / A[t, t]"),
    "uses k_n in place of k_t in the result": ("A[t, t] * np.abs(J_t", "A[n, n] * np.abs(J_t"),
    "does not scale the friction's part": ("A[t, t] * np.abs(J_t", "np.abs(J_t"),
    "divides by k in the result": ("A[n, n] * np.abs(J_n", "1.0 / A[n, n] * np.abs(J_n"),
    "adds the velocity over k to the friction": ("J[t] - u[t]", "J[t] + u[t]"),
    "takes sizes before it subtracts": ("np.abs(J_t - J[t])", "np.abs(np.abs(J_t) - np.abs(J[t]))"),
    "takes no size of the normal's part": ("np.abs(J_n - J[n])", "(J_n - J[n])"),
    "takes no size of the friction's part": ("np.abs(J_t - J[t])", "(J_t - J[t])"),
    "reverses the normal's part, and takes no size": ("np.abs(J_n - J[n])", "(J[n] - J_n)"),
    "leaves out the first contact": ("range(0, J.size, 2)", "range(2, J.size, 2)"),
    "leaves out the last contact": ("range(0, J.size, 2)", "range(0, J.size - 2, 2)"),
    "looks at the first contact only": ("range(0, J.size, 2)", "range(0, 2, 2)"),
    "takes all normals first, then all tangents": ("t = n + 1", "t = J.size // 2 + n // 2"),
    "returns the residual of the last contact": ("worst = np.maximum(worst, ", "worst = np.maximum(0.0, "),
    "returns the smallest one": ("worst = np.maximum(worst, ", "worst = np.minimum(worst if n else np.inf, "),
    "adds normal and friction of a contact": (
        "np.maximum(A[n, n] * np.abs(J_n - J[n]), A[t, t] * np.abs(J_t - J[t]))",
        "A[n, n] * np.abs(J_n - J[n]) + A[t, t] * np.abs(J_t - J[t])"),
    "takes the length of normal and friction together": (
        "np.maximum(A[n, n] * np.abs(J_n - J[n]), A[t, t] * np.abs(J_t - J[t]))",
        "np.hypot(A[n, n] * np.abs(J_n - J[n]), A[t, t] * np.abs(J_t - J[t]))"),
    "returns a residual for each contact": ("    return worst", "    return np.full(J.size // 2, worst)"),
    "returns 0 for a small residual": ("    return worst", "    return worst if worst > 1e-9 else 0.0"),
    "returns an impulse, not a velocity, for the normal": ("A[n, n] * np.abs(J_n - J[n])", "np.abs(J_n - J[n]) * 1.0"),
    "exchanges normal and tangent": ("t = n + 1", "t = n; n = n + 1"),
    "takes the limits the wrong way round": ("-limit), limit)", "limit), -limit)"),
    "reports a slip wherever it is, even where nothing pushes":
        ("worst = np.maximum(worst, ", "worst = np.maximum(np.maximum(worst, np.abs(u[t]) * (J[n] <= 0.0)), "),
    "checks separation only where the contact does not push": ("J_n = np.maximum(0.0, J[n] - u[n] / A[n, n])",
                                                               "J_n = J[n] if J[n] > 0.0 and u[n] > 0.0 else "
                                                               "np.maximum(0.0, J[n] - u[n] / A[n, n])"),
    "changes its input": ("J_n = np.maximum", "J[n] = J_n = np.maximum"),
    "moves the tangent's limit by the corrected velocity": ("u[t] / A[t, t], -limit)",
                                                            "(u[t] + A[t, n] * (J_n - J[n])) / A[t, t], -limit)"),
})


@right("9.9", "contact by contact, in pairs")
def cone_residual_2(A, b, J, mu):
    u, k = (A @ J + b).reshape(-1, 2), np.diag(A).reshape(-1, 2)
    found = []
    for (J_n, J_t), (u_n, u_t), (k_n, k_t), m in zip(J.reshape(-1, 2), u, k, mu, strict=True):
        limit = m * J_n if J_n > 0.0 else 0.0
        found += [abs(min(k_n * J_n, u_n)), abs(k_t * J_t - sorted((-k_t * limit, k_t * J_t - u_t, k_t * limit))[1])]
    return max(found)


@right("9.9", "normals first, tangents afterwards")
def cone_residual_3(A, b, J, mu):
    u, k, N, T = A @ J + b, np.diag(A), np.s_[::2], np.s_[1::2]
    normal = np.max(np.abs(np.minimum(k[N] * J[N], u[N])))
    limit = np.array([m * size if size > 0.0 else 0.0 for m, size in zip(mu, J[N], strict=True)])
    free = J[T] - u[T] / k[T]
    new = np.where(free > limit, limit, np.where(free < -limit, -limit, free))
    return max(normal, np.max(k[T] * np.abs(new - J[T])))


right("9.9", "from the last contact to the first")(
    lambda A, b, J, mu: worked.cone_residual(*(np.ascontiguousarray(part) for part in (
        np.flip(A.reshape(len(mu), 2, len(mu), 2), (0, 2)).reshape(A.shape), b.reshape(-1, 2)[::-1].ravel(),
        J.reshape(-1, 2)[::-1].ravel(), mu[::-1]))))
right("9.9", "as an array of no dimension")(lambda A, b, J, mu: np.array(worked.cone_residual(A, b, J, mu)))


edits("9.9", {
    "takes μ for at least 0.01": ("mu[n // 2] *", "max(mu[n // 2], 0.01) *"),
    "forgets the normal impulse in the limit": ("mu[n // 2] * J[n]", "mu[n // 2]"),
    "slides against the velocity, not to the side of the impulse that would stick":
        ("np.minimum(np.maximum(J[t] - u[t] / A[t, t], -limit), limit)",
         "J[t] - u[t] / A[t, t] if abs(J[t] - u[t] / A[t, t]) <= limit else -limit * np.sign(u[t])"),
    "slides to the side of the given friction":
        ("np.minimum(np.maximum(J[t] - u[t] / A[t, t], -limit), limit)",
         "J[t] - u[t] / A[t, t] if abs(J[t] - u[t] / A[t, t]) <= limit else limit * np.sign(J[t])"),
    "judges ten contacts at most": ("range(0, J.size, 2)", "range(0, min(J.size, 20), 2)"),
    "takes 99 % of the limit for the limit where a contact slides":
        ("worst = np.maximum(worst", "J_t = J[t] if limit > abs(J[t]) > 0.99 * limit and J[t] * u[t] < 0.0 else J_t\n"
         "        worst = np.maximum(worst"),
    "leaves out contacts that separate": ("limit = mu", "if u[n] > 0.0: continue\n        limit = mu"),
})


# 9.10 -----------------------------------------------------------------------------------------------------------
@variants
def coned(new_limit=True, newest=True, pulls=False, share=1.0, two_sided=True, friction_first=False,
          most=np.inf, by_kind=False, order=same, quiet=0.0, result=lambda J, old: J):
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
        return result(J, old)
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
edit("9.10", "changes its input", "J = float_copy(J)", "pass")
edit("9.10", "multiplies an infinite μ by a normal impulse of zero",
     "mu[n // 2] * J[n] if J[n] > 0.0 else 0.0", "mu[n // 2] * J[n]")
edit("9.10", "adds the correction of the normal impulse", "J[n] - (A[n]", "J[n] + (A[n]")
edit("9.10", "adds the correction of the friction", "J[t] - (A[t]", "J[t] + (A[t]")
edit("9.10", "does not limit the friction",
     "np.minimum(np.maximum(J[t] - (A[t] @ J + b[t]) / A[t, t], -limit), limit)", "J[t] - (A[t] @ J + b[t]) / A[t, t]")
edit("9.10", "omits μ in the limit", "mu[n // 2] * J[n]", "J[n]")
FIRST_FRICTION_ONLY = edit("9.10", "uses the friction coefficient of the first contact for all", "mu[n // 2]", "mu[0]")
edit("9.10", "uses the friction's diagonal for the normal impulse", "/ A[n, n]", "/ A[t, t]")
edit("9.10", "omits b", "A[n] @ J + b[n]", "A[n] @ J")
edit("9.10", "always slides: takes the limit",
     "np.minimum(np.maximum(J[t] - (A[t] @ J + b[t]) / A[t, t], -limit), limit)",
     "limit * np.sign(J[t] - (A[t] @ J + b[t]) / A[t, t])")
edits("9.10", {
    "uses the friction coefficient of the last contact for all": ("mu[n // 2]", "mu[-1]"),
    "has no friction where the cone does not hold it": (
        "J[t] = np.minimum(np.maximum(J[t] - (A[t] @ J + b[t]) / A[t, t], -limit), limit)",
        "stick = J[t] - (A[t] @ J + b[t]) / A[t, t]; J[t] = stick if abs(stick) <= limit else 0.0"),
    "leaves out the first contact": ("range(0, J.size, 2)", "range(2, J.size, 2)"),
    "leaves out the last contact": ("range(0, J.size, 2)", "range(0, J.size - 2, 2)"),
    "takes all normals first, then all tangents, in J": ("t = n + 1", "t = J.size // 2 + n // 2"),
    "exchanges normal and tangent": ("t = n + 1", "t = n; n = n + 1"),
    "starts from zero": ("J = float_copy(J)", "J = np.zeros(J.size)"),
    "makes an array of whole numbers": ("J = float_copy(J)", "J = J.astype(int)"),
    "returns the velocities": ("    return J", "    return A @ J + b"),
    "returns after the first contact": ("    return J", "        return J"),
    "returns pairs": ("    return J", "    return J.reshape(-1, 2)"),
    "does not divide by k_n": ("/ A[n, n])", ")"),
    "does not divide by k_t": ("/ A[t, t], -limit)", ", -limit)"),
    "uses the normal's diagonal for the friction": ("/ A[t, t], -limit)", "/ A[n, n], -limit)"),
    "multiplies by k_n": ("/ A[n, n])", "* A[n, n])"),
    "adds b of the normal to the velocity along the tangent": ("b[t]) / A[t, t]", "b[n]) / A[t, t]"),
    "omits b in the velocity along the tangent": ("(A[t] @ J + b[t])", "(A[t] @ J)"),
    "subtracts b": ("A[n] @ J + b[n]", "A[n] @ J - b[n]"),
    "takes the row of the normal for the velocity along the tangent": ("(A[t] @ J", "(A[n] @ J"),
    "uses the impulses of this contact only": ("(A[n] @ J + b[n])", "(A[n, n:n + 2] @ J[n:n + 2] + b[n])"),
    "omits what the friction does to the normal": ("(A[n] @ J + b[n])", "(A[n, ::2] @ J[::2] + b[n])"),
    "omits what the normals do to the friction": ("(A[t] @ J + b[t])", "(A[t, 1::2] @ J[1::2] + b[t])"),
    "forgets the impulse so far along the normal": ("np.maximum(0.0, J[n] -", "np.maximum(0.0, -"),
    "forgets the impulse so far along the tangent": ("np.maximum(J[t] -", "np.maximum(-"),
    "limits the change of the friction, not the friction":
        ("np.minimum(np.maximum(J[t] - (A[t] @ J + b[t]) / A[t, t], -limit), limit)",
         "J[t] + np.clip(-(A[t] @ J + b[t]) / A[t, t], -limit, limit)"),
    "limits the change of the normal impulse, not the impulse":
        ("np.maximum(0.0, J[n] - (A[n] @ J + b[n]) / A[n, n])",
         "J[n] + np.maximum(0.0, -(A[n] @ J + b[n]) / A[n, n])"),
    "limits the friction on the upper side only":
        ("np.minimum(np.maximum(J[t] - (A[t] @ J + b[t]) / A[t, t], -limit), limit)",
         "np.minimum(J[t] - (A[t] @ J + b[t]) / A[t, t], limit)"),
    "uses the contact's own friction only for its velocity along the tangent": ("(A[t] @ J", "(A[t, t] * J[t]"),
    "uses the contact's own normal impulse only for its normal velocity": ("(A[n] @ J", "(A[n, n] * J[n]"),
    "limits the friction by zero or less": ("-limit), limit)", "-limit), 0.0)"),
    "divides by μ": ("mu[n // 2] * J[n]", "J[n] / mu[n // 2]"),
    "uses the coefficient of the contact before": ("mu[n // 2] * J[n]", "mu[n // 2 - 1] * J[n]"),
    "uses the mean of μ": ("mu[n // 2] * J[n]", "np.mean(mu) * J[n]"),
    "squares μ": ("mu[n // 2] * J[n]", "mu[n // 2] ** 2 * J[n]"),
    "uses the weight of b for the limit": ("mu[n // 2] * J[n]", "mu[n // 2] * abs(b[n])"),
    "uses |J_t| in the limit": ("mu[n // 2] * J[n]", "mu[n // 2] * abs(J[t])"),
    "lets a contact without a normal impulse keep its friction": ("else 0.0", "else np.inf"),
    "skips the friction of a contact that does not push":
        ("limit = mu", "if J[n] <= 0.0: continue\n        limit = mu"),
    "skips a contact that separates":
        ("t = n + 1", "t = n + 1\n        if A[n] @ J + b[n] > 0.0: continue"),
    "has no friction": ("else 0.0", "else 0.0; limit = 0.0"),
    "has the velocity along the tangent from before the normal impulse":
        ("J[n] = np.maximum(0.0, J[n] - (A[n] @ J + b[n]) / A[n, n])",
         "b = b.copy(); J_n = J[n]; J[n] = np.maximum(0.0, J[n] - (A[n] @ J + b[n]) / A[n, n]); "
         "b[t] -= A[t, n] * (J[n] - J_n)"),
    "makes two sweeps": ("for n in range(0, J.size, 2):", "for n in [*range(0, J.size, 2)] * 2:"),
    "sweeps there and back": ("for n in range(0, J.size, 2):",
                              "for n in [*range(0, J.size, 2), *range(0, J.size, 2)[::-1]]:"),
    "stops at the first contact that separates":
        ("limit = mu", "if J[n] <= 0.0: break\n        limit = mu"),
    "takes the size of the normal impulse in place of max(0, ·)":
        ("np.maximum(0.0, J[n] - (A[n] @ J + b[n]) / A[n, n])", "np.abs(J[n] - (A[n] @ J + b[n]) / A[n, n])"),
    "relaxes by 0.9": ("J[n] - (A[n] @ J + b[n])", "J[n] - 0.9 * (A[n] @ J + b[n])"),
    "solves normal and friction of a contact together":
        ("t = n + 1", "t = n + 1; J[n:n + 2] -= np.linalg.solve(A[n:n + 2, n:n + 2], A[n:n + 2] @ J + b[n:n + 2])"),
})
wrongs("9.10", coned, {
    "returns the change of J": {"result": lambda J, old: J - old},
    "returns the old impulses": {"result": lambda J, old: old},
    "returns the mean of old and new impulses": {"result": lambda J, old: 0.5 * (J + old)},
})


@right("9.10", "contact by contact, with pairs")
def cone_sweep_2(A, b, J, mu):
    new = np.array(J, dtype=float).reshape(-1, 2)
    for k, m in enumerate(mu):
        u_n = A[2 * k] @ new.ravel() + b[2 * k]
        new[k, 0] = max(0.0, new[k, 0] - u_n / A[2 * k, 2 * k])
        if new[k, 0] == 0.0:
            new[k, 1] = 0.0
            continue
        u_t = b[2 * k + 1] + np.sum(A[2 * k + 1] * new.ravel())
        new[k, 1] = sorted((-m * new[k, 0], new[k, 1] - u_t / A[2 * k + 1, 2 * k + 1], m * new[k, 0]))[1]
    return new.ravel()


@right("9.10", "earlier contacts from a new array, later ones from the old one")
def cone_sweep_3(A, b, J, mu):
    new = np.empty(len(J))
    for s in range(len(J)):
        u = A[s, :s] @ new[:s] + A[s, s:] @ J[s:] + b[s]
        free = J[s] - u / A[s, s]
        if s % 2 == 0:
            new[s] = free if free > 0.0 else 0.0
        elif new[s - 1] <= 0.0:
            new[s] = 0.0
        else:
            new[s] = np.sign(free) * min(abs(free), mu[s // 2] * new[s - 1])
    return new


@right("9.10", "the diagonal left out of the sum")
def cone_sweep_4(A, b, J, mu):
    J, D = J.copy(), np.diag(A)
    for n in range(0, len(J), 2):
        for s in (n, n + 1):
            free = -(A[s] @ J - D[s] * J[s] + b[s]) / D[s]
            high = np.inf if s == n else mu[n // 2] * J[n] if J[n] > 0.0 else 0.0
            J[s] = min(max(free, 0.0 if s == n else -high), high)
    return J


right("9.10", "as a list")(lambda A, b, J, mu: worked.cone_sweep(A, b, J, mu).tolist())


FREE = "J[t] - (A[t] @ J + b[t]) / A[t, t]"
edits("9.10", {
    "slides against the velocity, not to the side of the impulse that would stick":
        (f"np.minimum(np.maximum({FREE}, -limit), limit)",
         f"{FREE} if abs({FREE}) <= limit else -limit * np.sign(A[t] @ J + b[t])"),
    "uses μ = 10⁶ for infinite friction": ("mu[n // 2] *", "min(mu[n // 2], 1e6) *"),
    "forgets the normal impulse in the limit": ("mu[n // 2] * J[n]", "mu[n // 2]"),
    "subtracts b in the velocity along the tangent": ("A[t] @ J + b[t]", "A[t] @ J - b[t]"),
    "slides to the side of the friction so far": (f"np.minimum(np.maximum({FREE}, -limit), limit)",
                                                  f"{FREE} if abs({FREE}) <= limit else limit * np.sign(J[t])"),
    "takes a large μ for infinite": ("mu[n // 2] *", "(mu[n // 2] if mu[n // 2] < 1000.0 else np.inf) *"),
    "leaves the friction of a contact that separates without pushing":
        ("J[n] = np.maximum", "if J[n] == 0.0 and A[n] @ J + b[n] > 0.0: continue\n        J[n] = np.maximum"),
})


edits("9.10", {
    "cuts off pulls before the sweep": ("J = float_copy(J)", "J = float_copy(J); J[::2] = np.maximum(0.0, J[::2])"),
    "leaves the friction of a contact that has the right normal impulse":
        ("t = n + 1", "t = n + 1\n        if A[n] @ J + b[n] == 0.0 and J[n] > 0.0: continue"),
})


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
wrong("9.11", "returns zero for small accelerations")(
    forces(felt=lambda a: np.where(np.abs(a) < 1e-6, 0.0, a)))
edit("9.11", "uses the inertia of the last body for all", "inverse_masses(inv_mass, inv_inertia)",
     "inverse_masses(inv_mass, np.where(inv_inertia > 0.0, inv_inertia[-1], 0.0))")
edit("9.11", "uses the mass of the last body for all", "inverse_masses(inv_mass, inv_inertia)",
     "inverse_masses(np.where(inv_mass > 0.0, inv_mass[-1], 0.0), inv_inertia)")
edit("9.11", "omits the friction", "@ (w * load.ravel()), mu)", "@ (w * load.ravel()), 0.0 * mu)")
edit("9.11", "subtracts the forces of the contacts",
     "+ np.ascontiguousarray(G.T) @ F)", "- np.ascontiguousarray(G.T) @ F)")
edit("9.11", "does not divide by the masses at the end", "a = w * (load", "a = (load")
wrongs("9.11", forces, {
    "reverses the load": {"pulled": lambda load: -load},
    "omits the load along x": {"pulled": lambda load: load * [0.0, 1.0, 1.0]},
    "omits the load along y": {"pulled": lambda load: load * [1.0, 0.0, 1.0]},
    "takes the load of the first body for all": {"pulled": lambda load: np.resize(load[0], load.shape)},
    "takes the load of the last body for all": {"pulled": lambda load: np.resize(load[-1], load.shape)},
    "adds gravity to the load": {"pulled": lambda load: np.add(load, [0.0, -9.81, 0.0])},
    "doubles the load": {"pulled": lambda load: 2.0 * load},
    "puts the torque first": {"pulled": lambda load: load[:, [2, 0, 1]]},
    "uses half of μ": {"friction": lambda mu: 0.5 * mu},
    "squares μ": {"friction": lambda mu: mu * mu},
    "uses infinite friction": {"friction": lambda mu: np.full(len(mu), np.inf)},
    "uses the largest μ for all": {"friction": lambda mu: np.full(len(mu), np.max(mu))},
    "uses μ from the last contact to the first": {"friction": lambda mu: mu[::-1].copy()},
    "limits μ to 1": {"friction": lambda mu: np.minimum(mu, 1.0)},
    "returns the normal forces only": {"told": lambda F: F[:, 0]},
    "returns the forces as one row": {"told": np.ravel},
    "returns (F_t, F_n)": {"told": lambda F: F[:, ::-1].copy()},
    "returns the forces on b": {"told": lambda F: -F},
    "returns twice the forces": {"told": lambda F: 2.0 * F},
    "returns three numbers for each force": {"told": lambda F: np.hstack((F, 0.0 * F[:, :1]))},
    "returns forces of zero for contacts below 1 µN": {"told": lambda F: np.where(np.abs(F) < 1e-6, 0.0, F)},
    "returns the transpose of the forces": {"told": np.transpose},
    "reverses the accelerations": {"felt": lambda a: -a},
    "omits the angular accelerations": {"felt": lambda a: (a.reshape(-1, 3) * [1.0, 1.0, 0.0]).ravel()},
    "reverses the angular accelerations": {"felt": lambda a: (a.reshape(-1, 3) * [1.0, 1.0, -1.0]).ravel()},
    "orders all a_x first, then all a_y, then all angular ones": {"felt": lambda a: a.reshape(-1, 3).T.ravel()},
    "returns accelerations of zero": {"felt": np.zeros_like},
    "rounds the accelerations": {"felt": lambda a: np.round(a, 6)},
    "omits the load and its sign in b": {"bias": 0.0},
    "uses half of the contact forces in the accelerations": {"push": 0.5},
    "adds the load twice": {"loaded": 2.0},
})
edits("9.11", {
    "adds the gaps to the accelerations": ("G @ (w * load.ravel()), mu",
                                           "G @ (w * load.ravel()) + np.repeat(contacts.gap, 2), mu"),
    "leaves out the acceleration of the last body": (
        "a.reshape(-1, 3)", "a.reshape(-1, 3) * (np.arange(x.shape[0]) < x.shape[0] - 1)[:, None]"),
    "returns forces as one row": ("return F.reshape(-1, 2)", "return F"),
    "reads the loads column by column": ("G @ (w * load.ravel())", "G @ (w * load.T.ravel())"),
    "returns a only": ("    return F.reshape(-1, 2), a.reshape(-1, 3)", "    return a.reshape(-1, 3)"),
    "returns a first": ("F.reshape(-1, 2), a.reshape(-1, 3)", "a.reshape(-1, 3), F.reshape(-1, 2)"),
    "returns accelerations as one row": ("a.reshape(-1, 3)", "a"),
    "exchanges inverse mass and inverse inertia": ("inverse_masses(inv_mass, inv_inertia)",
                                                   "inverse_masses(inv_inertia, inv_mass)"),
    "takes masses for inverse masses":
        ("inverse_masses(inv_mass, inv_inertia)",
         "inverse_masses(1.0 / np.where(inv_mass > 0.0, inv_mass, np.inf), inv_inertia)"),
    "takes moments of inertia for their inverses":
        ("inverse_masses(inv_mass, inv_inertia)",
         "inverse_masses(inv_mass, 1.0 / np.where(inv_inertia > 0.0, inv_inertia, np.inf))"),
    "lets no body rotate": ("inverse_masses(inv_mass, inv_inertia)", "inverse_masses(inv_mass, 0.0 * inv_inertia)"),
    "does not weigh the load at the end": ("w * (load.ravel() + np.ascontiguousarray(G.T) @ F)",
                                           "load.ravel() + w * (np.ascontiguousarray(G.T) @ F)"),
    "does not weigh the contact forces at the end": ("w * (load.ravel() + np.ascontiguousarray(G.T) @ F)",
                                                     "w * load.ravel() + np.ascontiguousarray(G.T) @ F"),
    "solves without friction": ("solve_contacts(delassus_matrix(G, w), G @ (w * load.ravel()), mu)",
                                "np.array([[l, 0.0] for l in solve_lcp(delassus_matrix(G[::2], w) + 1e-12 * "
                                "np.eye(mu.size), G[::2] @ (w * load.ravel()))]).ravel()"),
    "makes one sweep only": ("solve_contacts(delassus_matrix(G, w), G @ (w * load.ravel()), mu)",
                             "cone_sweep(delassus_matrix(G, w), G @ (w * load.ravel()), np.zeros(G.shape[0]), mu)"),
    "presses without a limit, as if all contacts were glued":
        ("solve_contacts(delassus_matrix(G, w), G @ (w * load.ravel()), mu)",
         "np.linalg.lstsq(delassus_matrix(G, w), -G @ (w * load.ravel()), rcond=None)[0]"),
    "changes its input": ("a = w * (load", "load *= 1.5; a = w * (load"),
})


@right("9.11", "body by body at the end")
def contact_forces_2(x, inv_mass, inv_inertia, contacts, load, mu):
    worked.check_scene(x, inv_mass, inv_inertia, contacts, load, mu)
    G = worked.contact_rows(x, contacts)
    w = np.stack((inv_mass, inv_mass, inv_inertia), axis=1)
    F = worked.solve_contacts(worked.delassus_matrix(G, w.ravel()), G @ (w * load).ravel(), mu)
    a = np.array([w[i] * (load[i] + F @ G[:, 3 * i:3 * i + 3]) for i in range(len(x))])
    return [F[k:k + 2] for k in range(0, len(F), 2)], a


@right("9.11", "contact by contact at the end")
def contact_forces_3(x, inv_mass, inv_inertia, contacts, load, mu):
    worked.check_scene(x, inv_mass, inv_inertia, contacts, load, mu)
    G, w = worked.contact_rows(x, contacts), worked.inverse_masses(inv_mass, inv_inertia)
    J = worked.solve_contacts(np.einsum("ri,i,si->rs", G, w, G), np.sum(G * (w * load.ravel()), axis=1), mu)
    total = load.copy()
    for k in range(len(mu)):
        for s in (2 * k, 2 * k + 1):
            total += J[s] * G[s].reshape(-1, 3)
    return np.stack((J[::2], J[1::2]), axis=1), w.reshape(-1, 3) * total


right("9.11", "as tuples of rows")(
    lambda *scene: tuple(tuple(map(tuple, part)) for part in worked.contact_forces(*scene)))
right("9.11", "with zeros for bodies that cannot move")(
    lambda x, inv_mass, inv_inertia, contacts, load, mu: ((F := worked.contact_forces(
        x, inv_mass, inv_inertia, contacts, load, mu))[0], np.where(F[1] == 0.0, 0.0, F[1])))


edits("9.11", {
    "uses its input before it checks it": ("check_scene(x,", "contact_rows(x, contacts); check_scene(x,"),
    "transmits loads on fixed bodies": ("(w * load.ravel())", "(np.where(w > 0.0, w, 1.0) * load.ravel())"),
    "takes infinite friction for all contacts": ("load.ravel()), mu)", "load.ravel()), np.full(mu.size, np.inf))"),
    "uses the inverse mass for the inverse inertia": ("inverse_masses(inv_mass, inv_inertia)",
                                                      "inverse_masses(inv_mass, inv_mass)"),
    "moves the normal forces to the centres": ("contact_rows(x, contacts), inv",
                                               "contact_rows(x, contacts) * np.tile([1.0, 1.0, 0.0], len(x)), inv"),
    "changes the loads on fixed bodies": ("inverse_masses(inv_mass, inv_inertia)",
                                          "inverse_masses(inv_mass, inv_inertia); load *= w.reshape(-1, 3) > 0.0"),
    "does not accelerate bodies without a contact":
        ("a.reshape(-1, 3)", "a.reshape(-1, 3) * np.isin(np.arange(len(x)), np.append(contacts.a, contacts.b))"
                             "[:, None]"),
})


wrongs("9.11", forces, {
    "uses μ = 1000 for infinite friction": {"friction": lambda mu: np.minimum(mu, 1e3)},
    "returns zero for forces below a thousandth of the largest one":
        {"told": lambda F: np.where(np.abs(F) < 1e-3 * np.max(np.abs(F)), 0.0, F)},
})
edits("9.11", {
    "does not turn a body with an inverse mass of 0":
        ("inverse_masses(inv_mass, inv_inertia)", "inverse_masses(inv_mass, inv_inertia * (inv_mass > 0.0))"),
    "has no friction where a gap is open":
        ("(w * load.ravel()), mu)", "(w * load.ravel()), np.where(contacts.gap > 0.0, 0.0, mu))"),
    "calls solve_lcp where no contact has friction, which refuses redundant contacts":
        ("F = solve_contacts(", "A, b = delassus_matrix(G[::2], w), G[::2] @ (w * load.ravel())\n"
         "    F = np.stack((solve_lcp(A, b), 0.0 * b), axis=1).ravel() if not np.any(mu) else solve_contacts("),
    "returns zeros without a load, before it checks the scene":
        ("check_scene(x,", "if not np.any(load): return np.zeros((contacts.a.size, 2)), np.zeros(load.shape)\n    "
         "check_scene(x,"),
})


# 9.12 -----------------------------------------------------------------------------------------------------------
@variants
def soft(angular=2.0 * np.pi, damping=2.0, opens=lambda gap, dt: (-gap / dt, 0.0), sign=-1.0, give=1.0, touches=False,
         law=lambda s, z, gap, dt: (-s * gap / (dt * (2.0 * z + s)), 1.0 / (s * (2.0 * z + s)))):
    def soft_contact(gap, hertz, zeta, dt):
        if (gap >= 0.0) if touches else (gap > 0.0):
            return opens(gap, dt)
        answer = law(angular * hertz * dt, 0.5 * damping * zeta, gap, dt)
        return (-sign * answer[0], give * answer[1]) if isinstance(answer, tuple) else answer
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
wrongs("9.12", soft, {
    "squares the angular frequency once too often": {"law": lambda s, z, gap, dt: (-s * s * gap / (dt * (2.0 * z + s)),
                                                                                    1.0 / (s * (2.0 * z + s)))},
    "uses −gap/dt for an overlap, too": {"law": lambda s, z, gap, dt: (-gap / dt, 1.0 / (s * (2.0 * z + s)))},
    "divides aim by 1 + give": {"law": lambda s, z, gap, dt: (-s * gap / (dt * (2.0 * z + s + 1.0 / s)),
                                                               1.0 / (s * (2.0 * z + s)))},
    "multiplies give by dt": {"law": lambda s, z, gap, dt: (-s * gap / (dt * (2.0 * z + s)), dt / (s * (2.0 * z + s)))},
    "divides give by dt":
        {"law": lambda s, z, gap, dt: (-s * gap / (dt * (2.0 * z + s)), 1.0 / (s * (2.0 * z + s) * dt))},
    "returns the give of a spring without damping": {"law": lambda s, z, gap, dt: (-s * gap / (dt * (2.0 * z + s)),
                                                                                 1.0 / (s * s))},
    "multiplies damping and stiffness in place of adding them":
        {"law": lambda s, z, gap, dt: (-s * gap / (dt * 2.0 * z * s), 1.0 / (s * 2.0 * z * s))},
    "adds 1 to the denominator of give": {"law": lambda s, z, gap, dt: (-s * gap / (dt * (2.0 * z + s)),
                                                                        1.0 / (1.0 + s * (2.0 * z + s)))},
    "adds 1 in both denominators": {"law": lambda s, z, gap, dt: (-s * s * gap / dt / (1.0 + s * (2.0 * z + s)),
                                                                  1.0 / (1.0 + s * (2.0 * z + s)))},
    "subtracts the stiffness": {"law": lambda s, z, gap, dt: (-s * gap / (dt * (2.0 * z - s)),
                                                              1.0 / (s * (2.0 * z - s)))},
    "takes explicit Euler: the force from the old gap":
        {"law": lambda s, z, gap, dt: (-s * gap / (dt * 2.0 * z + 1e-300),
                                                                                      1.0 / (s * 2.0 * z + 1e-300))},
    "puts damping where stiffness is": {"law": lambda s, z, gap, dt: (-2.0 * z * gap / (dt * (2.0 * z + s)),
                                                                      1.0 / (s * (2.0 * z + s)))},
    "forgets s in the numerator of aim": {"law": lambda s, z, gap, dt: (-gap / (dt * (2.0 * z + s)),
                                                                       1.0 / (s * (2.0 * z + s)))},
    "returns give for k_n J_n/dt": {"law": lambda s, z, gap, dt: (-s * gap / (dt * (2.0 * z + s)),
                                                                  dt * dt / (s * (2.0 * z + s)))},
    "returns aim only": {"law": lambda s, z, gap, dt: -s * gap / (dt * (2.0 * z + s))},
    "divides aim by dt twice":
        {"law": lambda s, z, gap, dt: (-s * gap / (dt * dt * (2.0 * z + s)), 1.0 / (s * (2.0 * z + s)))},
    "takes the velocity that the spring gives in a step for aim":
        {"law": lambda s, z, gap, dt: (-s * s * gap / dt, 1.0 / (s * (2.0 * z + s)))},
    "uses no target for an overlap": {"law": lambda s, z, gap, dt: (0.0, 1.0 / (s * (2.0 * z + s)))},
    "uses ζ² in place of ζ": {"law": lambda s, z, gap, dt: (-s * gap / (dt * (2.0 * z * z + s)),
                                                            1.0 / (s * (2.0 * z * z + s)))},
    "takes four times the damping": {"damping": 4.0},
    "uses critical damping for every ζ": {"law": lambda s, z, gap, dt: (-s * gap / (dt * (2.0 + s)),
                                                                          1.0 / (s * (2.0 + s)))},
    "uses π in place of 2π": {"angular": np.pi},
    "divides the frequency by 2π": {"angular": 0.5 / np.pi},
    "uses 6.28 for 2π": {"angular": 6.28},
    "lets an open contact press with the spring's give": {"opens": lambda gap, dt: (-gap / dt, 1.0)},
    "ignores open contacts: returns no target": {"opens": lambda gap, dt: (-1e9, 0.0)},
    "returns a large give for an open contact": {"opens": lambda gap, dt: (-gap / dt, np.inf)},
    "multiplies the gap by dt": {"opens": lambda gap, dt: (-gap * dt, 0.0)},
    "closes half of the gap": {"opens": lambda gap, dt: (-0.5 * gap / dt, 0.0)},
    "returns None for an open contact": {"opens": lambda gap, dt: None},
    "exchanges aim and give of an open contact": {"opens": lambda gap, dt: (0.0, -gap / dt)},
})
edits("9.12", {
    "adds 1 to the denominator of aim": ("(dt * (2.0 * zeta + s))", "(dt * (1.0 + 2.0 * zeta + s))"),
    "aims at a fifth of the gap per step": ("-s * gap / (dt * (2.0 * zeta + s))", "-0.2 * gap / dt"),
    "aims at half of the velocity": ("-s * gap /", "-0.5 * s * gap /"),
    "tolerates an overlap of a centimetre": ("s = 2.0", "gap = min(0.0, gap + 0.01); s = 2.0"),
    "limits aim to 4 m/s": ("return -s * gap / (dt * (2.0 * zeta + s))",
                            "return min(4.0, -s * gap / (dt * (2.0 * zeta + s)))"),
    "turns the condition round": ("if gap > 0.0:", "if gap < 0.0:"),
    "treats every contact as open": ("if gap > 0.0:", "if True:"),
    "treats every contact as an overlap": ("if gap > 0.0:", "if False:"),
    "treats a small overlap as an open gap": ("if gap > 0.0:", "if gap > -1e-3:"),
    "forgets dt in s": ("2.0 * np.pi * hertz * dt", "2.0 * np.pi * hertz"),
    "divides by dt in s": ("hertz * dt", "hertz / dt"),
    "squares s": ("2.0 * np.pi * hertz * dt", "(2.0 * np.pi * hertz * dt)**2"),
})


right("9.12", "with the angular frequency")(
    lambda gap, hertz, zeta, dt: (-gap / dt, 0.0) if gap > 0.0 else (
        -(w := 2.0 * np.pi * hertz) * gap / (2.0 * zeta + w * dt), 1.0 / (dt * w * (2.0 * zeta + dt * w))))
right("9.12", "by the two fractions of Catto's slides")(
    lambda gap, hertz, zeta, dt: (-max(gap, 0.0) / dt - min(gap, 0.0) * (k := (w := 2.0 * np.pi * hertz) ** 2)
                                  / (c := 2.0 * zeta * w + dt * k), 0.0 if gap > 0.0 else 1.0 / (dt * c)))
right("9.12", "as an array")(lambda *given: np.array(worked.soft_contact(*given)))


@right("9.12", "solved for a body of 1 kg")
def soft_contact_2(gap, hertz, zeta, dt):
    if gap > 0.0:
        return -gap / dt, 0.0
    k, c = 4.0 * np.pi**2 * hertz**2, 4.0 * np.pi * zeta * hertz
    give = 1.0 / (dt * dt * k + dt * c)
    return -give * dt * k * gap, give


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
edit("9.13", "limits only impulses that are 1 nN s beyond the rim", "size <= limit", "size <= limit + 1e-9")
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
edits("9.13", {
    "returns zero inside": ("scaled(1.0, J)", "scaled(0.0, J)"),
    "returns a unit vector inside": ("scaled(1.0, J)", "scaled(1.0 / max(size, 1e-300), J)"),
    "doubles what is inside": ("scaled(1.0, J)", "scaled(2.0, J)"),
    "returns an array inside": ("scaled(1.0, J)", "np.array(J)"),
    "returns a list": ("return scaled(1.0, J) if size <= limit else scaled(limit / size, J)",
                       "return list(scaled(1.0, J) if size <= limit else scaled(limit / size, J))"),
    "turns the condition round": ("size <= limit", "size >= limit"),
    "scales by size over limit": ("limit / size", "size / limit"),
    "scales by the root of limit over size": ("limit / size", "np.sqrt(limit / size)"),
    "scales by the square of limit over size": ("limit / size", "(limit / size)**2"),
    "scales by limit over the sum of sizes": ("limit / size", "limit / (abs(J[0]) + abs(J[1]) + abs(J[2]))"),
    "subtracts the limit": ("scaled(limit / size, J)", "scaled(1.0 - limit / size, J)"),
    "takes the size of each component": ("scaled(limit / size, J)", "scaled(limit / size, tuple(map(abs, J)))"),
    "forgets the root in the length": ("np.sqrt(dot(J, J))", "dot(J, J)"),
    "adds up the components for the length": ("np.sqrt(dot(J, J))", "abs(J[0] + J[1] + J[2])"),
    "adds up the sizes of the components for the length": ("np.sqrt(dot(J, J))", "abs(J[0]) + abs(J[1]) + abs(J[2])"),
    "takes the largest component for the length": ("np.sqrt(dot(J, J))", "max(abs(J[0]), abs(J[1]), abs(J[2]))"),
    "takes the first component for the length": ("np.sqrt(dot(J, J))", "abs(J[0])"),
    "leaves out the first component of the length": ("np.sqrt(dot(J, J))", "np.hypot(J[1], J[2])"),
    "leaves out the second component of the length": ("np.sqrt(dot(J, J))", "np.hypot(J[0], J[2])"),
    "adds 1e-9 to the length": ("np.sqrt(dot(J, J))", "np.sqrt(dot(J, J)) + 1e-9"),
    "adds 1e-12 to the length": ("np.sqrt(dot(J, J))", "np.sqrt(dot(J, J)) + 1e-12"),
    "adds 1e-9 to the square of the length": ("np.sqrt(dot(J, J))", "np.sqrt(dot(J, J) + 1e-9)"),
    "takes half of the limit": ("limit / size, J", "0.5 * limit / size, J"),
    "takes the limit times the root of two": ("limit / size, J", "np.sqrt(2.0) * limit / size, J"),
    "limits two components only": ("scaled(limit / size, J)", "(limit / size * J[0], limit / size * J[1], J[2])"),
    "limits the first component only": ("scaled(limit / size, J)", "(limit / size * J[0], J[1], J[2])"),
    "puts all of the limit on the largest component":
        ("scaled(limit / size, J)", "tuple(limit * np.sign(c) * (abs(c) == max(map(abs, J))) for c in J)"),
    "sets the third component to zero": ("scaled(limit / size, J)", "(limit / size * J[0], limit / size * J[1], 0.0)"),
    "returns the limit in each component": ("scaled(limit / size, J)", "(limit, limit, limit)"),
    "returns the limit with the sign of each component": ("scaled(limit / size, J)",
                                                          "tuple(limit * np.sign(c) for c in J)"),
    "returns the factor": ("scaled(limit / size, J)", "limit / size"),
    "returns two components": ("scaled(limit / size, J)", "scaled(limit / size, J)[:2]"),
    "rounds": ("scaled(limit / size, J)", "tuple(round(c, 6) for c in scaled(limit / size, J))"),
    "divides where there is no J and no limit": ("size <= limit", "size < limit"),
    "returns an impulse along z as it is": ("size <= limit", "size <= limit or J[2] == size"),
    "returns J for a limit of zero": ("size <= limit", "size <= limit or limit == 0.0"),
    "overflows: squares large components": ("np.sqrt(dot(J, J))", "np.sqrt(dot(J, J) ** 1.0 * 1e300) / 1e150"),
})


right("9.13", "by the smaller of two factors")(
    lambda J, limit: tuple(min(1.0, limit / size if (size := np.sqrt(J[0]**2 + J[1]**2 + J[2]**2)) > 0.0 else 1.0) * c
                           for c in J))
right("9.13", "by a unit vector")(
    lambda J, limit: tuple(float(c) for c in np.array(J) / np.linalg.norm(J) * limit) if np.linalg.norm(J) > limit
    else tuple(J))
right("9.13", "by a sum")(
    lambda J, limit: (J[0], J[1], J[2]) if (size := sum(c * c for c in J) ** 0.5) <= limit
    else (limit * J[0] / size, limit * J[1] / size, limit * J[2] / size))
right("9.13", "by the larger of size and limit")(
    lambda J, limit: tuple(J) if limit == np.inf or not any(J) else tuple(
        c if (size := np.linalg.norm(J)) <= limit else c * (limit / max(size, limit)) for c in J))


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
edit("9.14", "never finds an old contact, so that all J are 0", "J[k, c] = J_old[s, c]", "pass")
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
edit("9.14", "never finds an old contact, so that all J are 0",
     "old.b[s] == contacts.b[k]", "old.b[s] == contacts.a[k]")
edit("9.14", "copies the impulse of contact k, not of the nearest one",
     "J_old[s, c]", "J_old[min(k, len(J_old) - 1), c]")
edit("9.14", "adds up the impulses of all contacts that are near enough", "J[k, c] = J_old", "J[k, c] += J_old")
edit("9.14", "leaves out the last old contact of a body",
     "range(old.first[i], old.first[i + 1])", "range(old.first[i], old.first[i + 1] - 1)")
wrongs("9.14", kept, {
    "takes the last old contact of the pair": {"take": lambda distance: -1},
    "measures the distance along y only": {"size": lambda r, n: np.abs(r[:, 1])},
    "measures the distance along the normal only": {"size": lambda r, n: np.abs(r @ n)},
    "adds up the sizes of the coordinate differences": {"size": lambda r, n: np.sum(np.abs(r), axis=1)},
    "adds up the coordinate differences": {"size": lambda r, n: np.abs(np.sum(r, axis=1))},
    "takes the mean square of the coordinate differences": {"size": lambda r, n: np.sqrt(np.mean(r * r, axis=1))},
    "accepts up to twice the distance": {"near_enough": lambda d, near: d < 2.0 * near},
    "accepts up to half of the distance": {"near_enough": lambda d, near: d < 0.5 * near},
    "accepts only what lies farther than the limit": {"near_enough": lambda d, near: d > near},
    "accepts only exactly the same place": {"near_enough": lambda d, near: d == 0.0},
    "compares the distance with the square of the limit": {"near_enough": lambda d, near: d < near * near},
    "doubles the impulse": {"share": 2.0},
    "keeps 0.9 of the impulse": {"share": 0.9},
    "reverses the impulse": {"share": -1.0},
    "keeps the part along the new normal only": {"given": lambda J, n, m: (J @ n) * n},
    "keeps the part along the surface only": {"given": lambda J, n, m: J - (J @ n) * n},
    "keeps the part along the old normal only": {"given": lambda J, n, m: (J @ m) * m},
    "drops impulses that would pull": {"given": lambda J, n, m: J if J @ n > 0.0 else 0.0 * J},
    "takes the size of the impulse along the new normal": {"given": lambda J, n, m: np.linalg.norm(J) * n},
    "keeps the first component only": {"given": lambda J, n, m: J * (np.arange(len(J)) == 0)},
    "keeps the first two components only": {"given": lambda J, n, m: J * (np.arange(len(J)) < 2)},
    "keeps the sizes of the components": {"given": lambda J, n, m: np.abs(J)},
    "requires exactly the same normal": {"alike": 1.0 - 1e-9},
})
edits("9.14", {
    "turns the size of the normal impulse into the new normal": (
        "J[k, c] = J_old[s, c]", "J[k, c] = np.dot(J_old[s], old.n[s]) * contacts.n[k, c]"),
    "compares the normals, not the places": ("contacts.p[k, c] - old.p[s, c]", "contacts.n[k, c] - old.n[s, c]"),
    "reads the first old contact of number k, not of body a": (
        "range(old.first[i], old.first[i + 1])",
        "range(old.first[min(k, old.first.size - 2)], old.first[min(k, old.first.size - 2) + 1])"),
    "takes the last old contact that is near enough, not the nearest": ("nearest = squared", "pass"),
    "takes the first old contact that is near enough, not the nearest": ("nearest = squared", "nearest = 0.0"),
    "leaves out the first old contact of a body": ("range(old.first[i], old.first[i + 1])",
                                                   "range(old.first[i] + 1, old.first[i + 1])"),
    "looks at all old contacts, regardless of their a": ("range(old.first[i], old.first[i + 1])", "range(old.a.size)"),
    "never finds an old contact, so that all J are 0": ("old.first[i], old.first[i + 1]",
                                            "old.first[contacts.b[k]], old.first[contacts.b[k] + 1]"),
    "looks at the old contacts of the next body": ("old.first[i], old.first[i + 1]",
                                                   "old.first[i + 1], old.first[min(i + 2, old.first.size - 1)]"),
    "looks at the first old contact of a body only": ("old.first[i], old.first[i + 1]",
                                                      "old.first[i], min(old.first[i] + 1, old.first[i + 1])"),
    "looks at all old contacts up to those of body a": ("range(old.first[i], old.first[i + 1])",
                                                        "range(old.first[i + 1])"),
    "looks at all old contacts from those of body a on": ("range(old.first[i], old.first[i + 1])",
                                                          "range(old.first[i], old.a.size)"),
    "uses contacts.first in place of old.first": ("old.first[i], old.first[i + 1]",
                                                  "contacts.first[i], min(contacts.first[i + 1], old.a.size)"),
    "numbers the new contacts for the old ones": ("old.first[i], old.first[i + 1]", "min(k, old.a.size), "
                                                  "min(k + 1, old.a.size)"),
    "leaves out the first new contact": ("range(contacts.a.size)", "range(1, contacts.a.size)"),
    "leaves out the last new contact": ("range(contacts.a.size)", "range(contacts.a.size - 1)"),
    "never resets the nearest distance": ("i, nearest = contacts.a[k], near * near",
                                          "i, nearest = contacts.a[k], near * near if k == 0 else nearest"),
    "multiplies the differences in place of adding their squares": ("squared += (contacts.p[k, c] - old.p[s, c]) ** 2",
                                                                    "squared = (contacts.p[k, c] - old.p[s, c]) ** 2"),
    "adds the places": ("(contacts.p[k, c] - old.p[s, c])", "(contacts.p[k, c] + old.p[s, c])"),
    "compares the new contact with itself": ("old.p[s, c]) ** 2", "contacts.p[k, c]) ** 2"),
    "takes the place of the old contact of the same number": ("old.p[s, c]) ** 2",
                                                              "old.p[min(k, len(old.p) - 1), c]) ** 2"),
    "does not square the difference": ("old.p[s, c]) ** 2", "old.p[s, c])"),
    "turns the comparison round": ("if squared < nearest", "if squared > nearest"),
    "copies to the place of the old contact": ("J[k, c] = J_old", "J[min(s, len(J) - 1), c] = J_old"),
    "has the shape of the old impulses": ("np.zeros(contacts.p.shape)", "np.zeros(J_old.shape)"),
    "copies the first old impulse": ("J_old[s, c]", "J_old[0, c]"),
    "keeps the old impulses where no contact is found":
        ("np.zeros(contacts.p.shape)", "np.resize(J_old, contacts.p.shape)"
                                                         " * 1.0 if J_old.size else np.zeros(contacts.p.shape)"),
    "copies the first component to all": ("J_old[s, c]", "J_old[s, 0]"),
    "makes an array of whole numbers": ("np.zeros(contacts.p.shape)", "np.zeros(contacts.p.shape, int)"),
    "asks for another b": ("old.b[s] == contacts.b[k]", "old.b[s] != contacts.b[k]"),
    "changes the old impulses": ("J[k, c] = J_old[s, c]", "J[k, c] = J_old[s, c]; J_old[s, c] = 0.0"),
    "returns after the first contact": ("    return J", "        return J"),
    "returns the old impulses themselves": ("    return J", "    return J_old"),
    "has no vector where there was no contact": ("    return J", "    return J if old.a.size else np.zeros(0)"),
})


@variants
def remembered(late=False):
    def kept_impulses(contacts, old, J_old, near):
        J = np.zeros(contacts.p.shape)
        for k, (a, b, p) in enumerate(zip(contacts.a, contacts.b, contacts.p, strict=True)):
            fits = (old.a == a) & (old.b == b)
            far = np.linalg.norm(old.p - p, axis=1)
            s = np.argmin(np.where(fits | late, far, np.inf)) if far.size else -1
            if s >= 0 and fits[s] and far[s] < near:
                J[k] = J_old[s]
        return J
    return kept_impulses


wrong("9.14", "takes the nearest old contact of all bodies, and asks for its bodies afterwards")(remembered(late=True))


@right("9.14", "by a table of all distances")
def kept_impulses_2(contacts, old, J_old, near):
    J = np.zeros(contacts.p.shape)
    if not len(old.a):
        return J
    far = np.sqrt(np.sum((contacts.p[:, None] - old.p) ** 2, axis=2))
    far[(contacts.a[:, None] != old.a) | (contacts.b[:, None] != old.b)] = np.inf
    best = np.argmin(far, axis=1)
    found = far[np.arange(len(J)), best] < near
    J[found] = J_old[best[found]]
    return J


@right("9.14", "by a dictionary of pairs")
def kept_impulses_3(contacts, old, J_old, near):
    pairs = {}
    for s, pair in enumerate(zip(old.a, old.b, strict=True)):
        pairs.setdefault(pair, []).append(s)
    J = []
    for pair, p in zip(zip(contacts.a, contacts.b, strict=True), contacts.p, strict=True):
        there = sorted((np.linalg.norm(old.p[s] - p), s) for s in pairs.get(pair, []))
        J.append(J_old[there[0][1]].copy() if there and there[0][0] < near else 0.0 * p)
    return np.array(J)


@right("9.14", "from the last old contact to the first")
def kept_impulses_4(contacts, old, J_old, near):
    J, best = np.zeros(contacts.p.shape), np.full(len(contacts.a), float(near))
    for s in reversed(range(len(old.a))):
        for k in np.flatnonzero((contacts.a == old.a[s]) & (contacts.b == old.b[s])):
            if (distance := np.sqrt(np.sum((old.p[s] - contacts.p[k]) ** 2))) < best[k]:
                best[k], J[k] = distance, J_old[s]
    return J


right("9.14", "as a list")(lambda contacts, old, J_old, near: worked.kept_impulses(contacts, old, J_old, near).tolist())


SAME_B = "if old.b[s] == contacts.b[k]:"
edits("9.14", {
    "forgets the impulse of a contact that is open now": (SAME_B, f"{SAME_B[:-1]} and contacts.gap[k] <= 0.0:"),
    "forgets the impulse of a contact that was open": (SAME_B, f"{SAME_B[:-1]} and old.gap[s] <= 0.0:"),
    "counts the change of the gap as a distance, too": ("squared = 0.0",
                                                        "squared = (contacts.gap[k] - old.gap[s]) ** 2"),
    "forgets the impulses of planes": (SAME_B, f"{SAME_B[:-1]} and contacts.b[k] < contacts.first.size - 1:"),
    "ends at the first old partner of a greater number":
        (SAME_B, f"if old.b[s] > contacts.b[k]: break\n            {SAME_B}"),
    "forgets the impulses of the last body": (SAME_B, f"{SAME_B[:-1]} and i < old.first.size - 2:"),
})


edits("9.14", {
    "takes all planes for the same body":
        (SAME_B, "last = old.first.size - 1\n            if min(old.b[s], last) == min(contacts.b[k], last):"),
    "squares the places before it subtracts them":
        ("(contacts.p[k, c] - old.p[s, c]) ** 2",
         "contacts.p[k, c] ** 2 - 2.0 * contacts.p[k, c] * old.p[s, c] + old.p[s, c] ** 2"),
})


# 9.15 -----------------------------------------------------------------------------------------------------------
@variants
def leaves(low_side=True, high_side=True, bodies=slice(None), axes=slice(None), all_of=False, nan=True, nan_high=True,
           slack=0.0, endless=False, answer=lambda inside: bool(not inside.all())):
    def has_left_margin(low, high, wide_low, wide_high):
        inside = np.ones(low.shape, bool)
        if low_side:
            inside &= (wide_low <= low + slack) if nan else ~(wide_low > low)
        if high_side:
            inside &= (high <= wide_high + slack) if nan and nan_high else ~(high > wide_high)
        if endless:
            inside |= np.isinf(wide_low)
        inside = inside[bodies, axes]
        return bool(not inside.any()) if all_of else answer(inside)
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
alike("9.15", "allows a small excess", leaves, {"slack": 1e-8}, {"slack": 1e-3})
wrong("9.15", "counts no body as having left a box without a size")(leaves(endless=True))
edit("9.15", "counts the edge itself as outside", "wide_low[i, c] <= low[i, c] and", "wide_low[i, c] < low[i, c] and")
edit("9.15", "returns True if no body has left", "return True", "return False")
edit("9.15", "returns the opposite", "if not (wide", "if (wide")
edit("9.15", "exchanges the boxes",
     "wide_low[i, c] <= low[i, c] and high[i, c] <= wide_high[i, c]",
     "low[i, c] <= wide_low[i, c] and wide_high[i, c] <= high[i, c]")
edit("9.15", "joins the two conditions by or", "low[i, c] and high[i, c] <=", "low[i, c] or high[i, c] <=")
wrongs("9.15", leaves, {
    "omits the first body": {"bodies": slice(1, None)},
    "looks at the first body only": {"bodies": slice(0, 1)},
    "looks at the last body only": {"bodies": slice(-1, None)},
    "omits the first axis": {"axes": slice(1, None)},
    "looks at the first axis only": {"axes": slice(0, 1)},
    "looks at two axes only": {"axes": slice(0, 2)},
    "looks at every other body only": {"bodies": slice(None, None, 2)},
    "allows a small excess": {"slack": 1e-12},
    "requires a distance of 1 nm from the edge": {"slack": -1e-9},
    "requires that a body has left along all axes": {"answer": lambda inside: bool(not (inside.any(axis=1).all()))},
    "requires that all bodies have left along some axis":
        {"answer": lambda inside: bool(not (inside.all(axis=1).any()))},
    "requires that most bodies have left": {"answer": lambda inside: bool(not (np.mean(inside) > 0.5))},
    "requires that two corners have left": {"answer": lambda inside: bool(not (np.count_nonzero(~inside) < 2))},
    "requires that all bodies have left along the same axis":
        {"answer": lambda inside: bool(not (inside.any(axis=0).all()))},
    "returns the opposite, with all at once": {"answer": lambda inside: bool(not (not inside.all()))},
    "always returns True": {"answer": lambda inside: bool(not (False))},
    "always returns False": {"answer": lambda inside: bool(not (True))},
    "returns an answer for each body": {"answer": lambda inside: ~inside.all(axis=1)},
    "returns an answer for each corner": {"answer": lambda inside: ~inside},
    "returns the number of the first body that left": {"answer": lambda inside: int(np.argmin(inside.all(axis=1)))},
    "returns how many bodies have left": {"answer": lambda inside: int(np.count_nonzero(~inside.all(axis=1)))},
    "returns the answer as a word": {"answer": lambda inside: "no" if inside.all() else "yes"},
})
edits("9.15", {
    "returns True where there are no bodies": ("    return False", "    return low.shape[0] == 0"),
    "looks at eight bodies at most": ("range(low.shape[0])", "range(min(8, low.shape[0]))"),
    "does not notice NaN of a single body":
        ("    for i in range(low.shape[0])",
         "    if low.shape[0] == 1: return np.any(low < wide_low) or np.any(high > wide_high)\n"
         "    for i in range(low.shape[0])"),
    "allows an excess of 1 mm on the upper side": ("<= wide_high[i, c]", "<= wide_high[i, c] + 1e-3"),
    "compares high with the lower edge of the widened box": ("high[i, c] <= wide_high", "low[i, c] <= wide_high"),
    "requires that a box has left on both sides": ("if not (wide_low[i, c] <= low[i, c] and high[i, c] <= "
                                                   "wide_high[i, c])",
                                                   "if not (wide_low[i, c] <= low[i, c] or high[i, c] <= "
                                                   "wide_high[i, c])"),
    "requires that a box sticks out on both sides":
        ("if not (wide_low[i, c] <= low[i, c] and high[i, c] <= wide_high[i, c])",
         "if low[i, c] < wide_low[i, c] and high[i, c] > wide_high[i, c]"),
    "compares low with the upper edge": ("wide_low[i, c] <= low[i, c]", "wide_high[i, c] >= low[i, c]"),
    "compares high with the lower edge": ("high[i, c] <= wide_high[i, c]", "high[i, c] >= wide_low[i, c]"),
    "turns the lower comparison round": ("wide_low[i, c] <= low[i, c]", "wide_low[i, c] >= low[i, c]"),
    "turns the upper comparison round": ("high[i, c] <= wide_high[i, c]", "high[i, c] >= wide_high[i, c]"),
    "compares with the box of the first body": ("high[i, c] <= wide_high[i, c]", "high[i, c] <= wide_high[0, c]"),
    "compares with the lower edge of the first body": ("wide_low[i, c] <= low[i, c]", "wide_low[0, c] <= low[i, c]"),
    "returns False after the first axis of a body": ("                return True",
                                                       "                return True\n            return False"),
    "returns False after the first body": ("                return True",
                                           "                return True\n        return False"),
    "has no return where no box has left": ("    return False", "    pass"),
    "returns True where no box has left": ("    return False", "    return True"),
    "counts the upper edge itself as outside": ("high[i, c] <= wide_high[i, c]", "high[i, c] < wide_high[i, c]"),
    "looks whether the box has left the whole widened box: no overlap": (
        "if not (wide_low[i, c] <= low[i, c] and high[i, c] <= wide_high[i, c])",
        "if not (wide_low[i, c] <= high[i, c] and low[i, c] <= wide_high[i, c])"),
    "compares the middles of the boxes": (
        "if not (wide_low[i, c] <= low[i, c] and high[i, c] <= wide_high[i, c])",
        "if not (wide_low[i, c] <= 0.5 * (low[i, c] + high[i, c]) <= wide_high[i, c])"),
    "compares the sizes of the boxes": (
        "if not (wide_low[i, c] <= low[i, c] and high[i, c] <= wide_high[i, c])",
        "if not (high[i, c] - low[i, c] <= wide_high[i, c] - wide_low[i, c])"),
    "takes sizes of the coordinates": ("high[i, c] <= wide_high[i, c]", "abs(high[i, c]) <= abs(wide_high[i, c])"),
    "takes sizes of the lower coordinates": ("wide_low[i, c] <= low[i, c]", "abs(low[i, c]) <= abs(wide_low[i, c])"),
    "uses the number of axes for the number of bodies": ("range(low.shape[0])", "range(low.shape[1])"),
    "exchanges body and axis in the loops": ("range(low.shape[0])", "range(min(low.shape))"),
    "overlooks NaN: asks whether low is below wide_low":
        ("wide_low[i, c] <= low[i, c]", "not low[i, c] < wide_low[i, c]"),
    "returns False for NaN": ("if not (", "if not np.isnan(low[i, c] + high[i, c]) and not ("),
    "raises an error for NaN": ("if not (", "if int(low[i, c]) and False or not ("),
    "returns True for any infinite number": ("if not (", "if np.isinf(wide_low[i, c]) or not ("),
})


right("9.15", "any of the negated conditions")(
    lambda low, high, wide_low, wide_high: np.any(~(wide_low <= low) | ~(high <= wide_high)))
right("9.15", "by counting")(
    lambda low, high, wide_low, wide_high: np.sum((low >= wide_low) & (wide_high >= high)) < low.size)
right("9.15", "by the least distance to an edge")(
    lambda low, high, wide_low, wide_high: not all(a >= b and c <= d for a, b, c, d in zip(
        low.ravel(), wide_low.ravel(), high.ravel(), wide_high.ravel(), strict=True)))
right("9.15", "as a number")(lambda *boxes: int(worked.has_left_margin(*boxes)))


edits("9.15", {
    "takes a widened box that is NaN for all of space":
        ("not (wide_low[i, c] <= low[i, c] and high[i, c] <= wide_high[i, c])",
         "not (low[i, c] >= np.nan_to_num(wide_low[i, c], nan=-np.inf) "
         "and high[i, c] <= np.nan_to_num(wide_high[i, c], nan=np.inf))"),
})


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
edit("9.16", "changes its input", "float_copy(v), float_copy(omega), float_copy(J)", "v, omega, J")
edit("9.16", "uses the mass of a for b", "v[b, 0] -= inv_mass[b] * d_x", "v[b, 0] -= inv_mass[a] * d_x")
edit("9.16", "omits impulses below 1 nN s", "0.0 if J_n <= 0.0", "0.0 if J_n <= 1e-9")
edit("9.16", "limits aim to −1 m/s where a contact does not approach", "(aim[k] - u_n -",
     "((aim[k] if u_n < 0.0 else max(aim[k], -1.0)) - u_n -")
edit("9.16", "omits the softness in the denominator", "k_n * (1.0 + give[k])", "k_n")
edit("9.16", "adds the normal velocity in place of subtracting it", "(aim[k] - u_n -", "(aim[k] + u_n -")
edit("9.16", "has the wrong sign in front of u_t: adds the tangential velocity", "J_t - u_t /", "J_t + u_t /")
edit("9.16", "forgets k_n", "/ (k_n * (1.0 + give[k]))", "/ (1.0 + give[k])")
edit("9.16", "uses k_n for the friction, too", "u_t / arms.k_t[k]", "u_t / k_n")
edit("9.16", "adds the change of the impulse to b, too", "v[b, 0] -= inv_mass[b] * d_x", "v[b, 0] += inv_mass[b] * d_x")
edit("9.16", "applies the whole impulse in every visit, not its change",
     "J_n * n_x - J_t * n_y - J[k, 0], J_n * n_y + J_t * n_x - J[k, 1]", "J_n * n_x - J_t * n_y, J_n * n_y + J_t * n_x")
edit("9.16", "forgets μ", "pile.mu * J_n if", "J_n if")
edit("9.16", "reverses the rotation in the velocity of a's point",
     "v[a, 0] - omega[a] * a_y", "v[a, 0] + omega[a] * a_y")
edit("9.16", "starts each impulse from zero", "J_n += (aim", "J_n = (aim")
edits("9.16", {
    "skips contacts that may approach": ("J_n += (aim[k]", "J_n += 0.0 if aim[k] < 0.0 else (aim[k]"),
    "adds the velocities of a and b": ("- v[b, 0] + omega[b] * b_y", "+ v[b, 0] - omega[b] * b_y"),
    "forgets the impulses so far along normal and tangent": (
        "J_n, J_t = n_x * J[k, 0] + n_y * J[k, 1], n_x * J[k, 1] - n_y * J[k, 0]", "J_n, J_t = 0.0, 0.0"),
    "rubs with the whole limit": ("-limit if J_t < -limit else limit if J_t > limit else J_t",
                                  "-limit if u_t > 0.0 else limit"),
    "returns J before omega": ("return v, omega, J", "return v, J, omega"),
    "reverses the rotation in the velocity of a's point, along y": ("v[a, 1] + omega[a] * a_x",
                                                                    "v[a, 1] - omega[a] * a_x"),
    "reverses the rotation in the velocity of b's point": ("v[b, 0] + omega[b] * b_y", "v[b, 0] - omega[b] * b_y"),
    "reverses the rotation in the velocity of b's point, along y": ("v[b, 1] - omega[b] * b_x",
                                                                    "v[b, 1] + omega[b] * b_x"),
    "omits the rotation in the velocity of b's point": ("v[b, 0] + omega[b] * b_y", "v[b, 0]"),
    "omits the rotation in the velocity of a's point": ("v[a, 0] - omega[a] * a_y", "v[a, 0]"),
    "exchanges r_x and r_y in the velocity of a's point": ("v[a, 0] - omega[a] * a_y", "v[a, 0] - omega[a] * a_x"),
    "uses the centres' velocities only": ("u_n, u_t = n_x", "u_x, u_y = v[a] - v[b]; u_n, u_t = n_x"),
    "reverses ω in the velocities of both points": ("u_n, u_t = n_x", "u_x, u_y = 2.0 * (v[a] - v[b]) - (u_x, u_y); "
                                                    "u_n, u_t = n_x"),
    "takes b's velocity minus a's": ("u_n, u_t = n_x", "u_x, u_y = -u_x, -u_y; u_n, u_t = n_x"),
    "adds the velocities of both points": ("u_n, u_t = n_x", "u_x, u_y = 2.0 * v[a] - (u_x, u_y) + 2.0 * omega[a] * "
                                           "np.array([-a_y, a_x]); u_x, u_y = v[a] + v[b] + omega[a] * "
                                           "np.array([-a_y, a_x]) + omega[b] * np.array([-b_y, b_x]); u_n, u_t = n_x"),
    "exchanges n_x and n_y in u_n": ("n_x * u_x + n_y * u_y", "n_y * u_x + n_x * u_y"),
    "subtracts in u_n": ("n_x * u_x + n_y * u_y", "n_x * u_x - n_y * u_y"),
    "adds in u_t": ("n_x * u_y - n_y * u_x", "n_x * u_y + n_y * u_x"),
    "reverses the tangent in the impulse so far": ("n_x * J[k, 1] - n_y * J[k, 0]", "n_y * J[k, 0] - n_x * J[k, 1]"),
    "takes the first number of J for J_n": ("n_x * J[k, 0] + n_y * J[k, 1]", "J[k, 0]"),
    "takes the numbers of J for J_n and J_t":
        ("u_n, u_t = n_x * u_x + n_y * u_y, n_x * u_y - n_y * u_x",
         "u_n, u_t = n_x * u_x + n_y * u_y, n_x * u_y - n_y * u_x; "
         "J[k] = J[k, 0] * np.array([n_x, n_y]) + J[k, 1] * np.array([-n_y, n_x])"),
    "forgets the impulse so far along the tangent": ("J_t, limit = J_t - u_t", "J_t, limit = -u_t"),
    "reverses the target": ("(aim[k] - u_n", "(-aim[k] - u_n"),
    "adds the softness times the impulse so far": ("- give[k] * k_n * J_n", "+ give[k] * k_n * J_n"),
    "forgets k_n in the softness": ("- give[k] * k_n * J_n", "- give[k] * J_n"),
    "subtracts the softness in the denominator": ("(1.0 + give[k])", "(1.0 - give[k])"),
    "adds the softness to k_n": ("(k_n * (1.0 + give[k]))", "(k_n + give[k])"),
    "forgets the 1 in the denominator, where a contact is soft": ("(1.0 + give[k])", "(give[k] or 1.0)"),
    "multiplies by k_n": ("/ (k_n * (1.0 + give[k]))", "* (k_n * (1.0 + give[k]))"),
    "multiplies by k_t": ("u_t / arms.k_t[k]", "u_t * arms.k_t[k]"),
    "forgets k_t": ("u_t / arms.k_t[k]", "u_t"),
    "limits the increment of the normal impulse to zero or more, not the impulse":
        ("J_n += (aim[k] - u_n - give[k] * k_n * J_n) / (k_n * (1.0 + give[k]))",
         "J_n += max(0.0, (aim[k] - u_n - give[k] * k_n * J_n) / (k_n * (1.0 + give[k])))"),
    "limits the increment of the friction, not the friction":
        ("J_t = -limit if J_t < -limit else limit if J_t > limit else J_t",
         "J_o = n_x * J[k, 1] - n_y * J[k, 0]; J_t = J_o + min(max(J_t - J_o, -limit), limit)"),
    "skips contacts that separate": ("J_n += (aim", "if u_n > aim[k]: continue\n        J_n += (aim"),
    "skips contacts that do not push": ("J_t, limit =", "if J_n <= 0.0: continue\n        J_t, limit ="),
    "leaves out the friction where no normal impulse is left": ("if J_n > 0.0 else 0.0", "if J_n > 0.0 else np.inf"),
    "takes the size of J_n": ("0.0 if J_n <= 0.0 else J_n", "abs(J_n)"),
    "turns the limit to zero or more round": ("0.0 if J_n <= 0.0 else J_n", "J_n if J_n <= 0.0 else 0.0"),
    "limits the friction to zero or more": ("-limit if J_t < -limit", "0.0 if J_t < 0.0"),
    "limits the friction to one side only": ("-limit if J_t < -limit else limit", "limit"),
    "always slides: takes the limit": ("-limit if J_t < -limit else limit if J_t > limit else J_t",
                                       "limit * np.sign(J_t)"),
    "has no friction": ("-limit if J_t < -limit else limit if J_t > limit else J_t", "0.0"),
    "sets the friction to zero beyond the limit": ("-limit if J_t < -limit else limit if J_t > limit else J_t",
                                                   "0.0 if abs(J_t) > limit else J_t"),
    "uses the size of the tangential velocity for the limit": ("pile.mu * J_n if", "pile.mu * abs(u_n) if"),
    "uses half of μ": ("pile.mu * J_n if", "0.5 * pile.mu * J_n if"),
    "squares μ": ("pile.mu * J_n if", "pile.mu**2 * J_n if"),
    "limits μ to 1": ("pile.mu * J_n if", "min(pile.mu, 1.0) * J_n if"),
    "multiplies an infinite μ by a normal impulse of zero": ("pile.mu * J_n if J_n > 0.0 else 0.0", "pile.mu * J_n"),
    "reverses the tangent when it puts J together":
        ("J_n * n_x - J_t * n_y - J[k, 0], J_n * n_y + J_t * n_x - J[k, 1]",
         "J_n * n_x + J_t * n_y - J[k, 0], J_n * n_y - J_t * n_x - J[k, 1]"),
    "returns J as (J_n, J_t)": ("J[k, 0] + d_x, J[k, 1] + d_y", "J_n, J_t"),
    "stores the change of J, not J": ("J[k, 0] + d_x, J[k, 1] + d_y", "d_x, d_y"),
    "does not store J": ("J[k, 0] + d_x, J[k, 1] + d_y", "J[k, 0], J[k, 1]"),
    "subtracts the change from J": ("J[k, 0] + d_x, J[k, 1] + d_y", "J[k, 0] - d_x, J[k, 1] - d_y"),
    "pushes a the wrong way, along x": ("v[a, 0] += inv", "v[a, 0] -= inv"),
    "pushes a the wrong way, along y": ("v[a, 1] += inv", "v[a, 1] -= inv"),
    "adds the change of the impulse to b, too, along y": ("v[b, 1] -= inv", "v[b, 1] += inv"),
    "does not push a": ("inv_mass[a] * d_x", "inv_mass[a] * 0.0"),
    "divides by the inverse mass":
        ("v[a, 0] += inv_mass[a] * d_x", "v[a, 0] += d_x / inv_mass[a] if inv_mass[a] else 0.0"),
    "forgets the mass of a": ("v[a, 0] += inv_mass[a] * d_x", "v[a, 0] += d_x"),
    "forgets the mass of b": ("v[b, 0] -= inv_mass[b] * d_x", "v[b, 0] -= d_x"),
    "reverses the torque on a": ("(a_x * d_y - a_y * d_x)", "(a_y * d_x - a_x * d_y)"),
    "reverses the torque on b": ("(b_x * d_y - b_y * d_x)", "(b_y * d_x - b_x * d_y)"),
    "uses the arm of a for the torque on b": ("(b_x * d_y - b_y * d_x)", "(a_x * d_y - a_y * d_x)"),
    "takes inverse masses for masses": ("v[a, 0] += inv_mass[a] * d_x", "v[a, 0] += d_x / max(inv_mass[a], 1e-9)"),
    "omits the torque on a": ("(a_x * d_y - a_y * d_x)", "0.0"),
    "omits the torque on b": ("(b_x * d_y - b_y * d_x)", "0.0"),
    "adds the products of the torque": ("(a_x * d_y - a_y * d_x)", "(a_x * d_y + a_y * d_x)"),
    "takes r · J for the torque": ("(a_x * d_y - a_y * d_x)", "(a_x * d_x + a_y * d_y)"),
    "uses the inverse mass for the rotation": ("omega[a] += inv_inertia[a]", "omega[a] += inv_mass[a]"),
    "uses the inverse inertia for the velocity": ("v[a, 0] += inv_mass[a]", "v[a, 0] += inv_inertia[a]"),
    "uses the inertia of a for b": ("omega[b] -= inv_inertia[b]", "omega[b] -= inv_inertia[a]"),
    "applies the torque of the whole impulse, not of its change":
        ("omega[a] += inv_inertia[a] * (a_x * d_y - a_y * d_x)",
         "omega[a] += inv_inertia[a] * (a_x * J[k, 1] - a_y * J[k, 0])"),
    "leaves out the first contact": ("range(contacts.a.size)", "range(1, contacts.a.size)"),
    "leaves out the last contact": ("range(contacts.a.size)", "range(contacts.a.size - 1)"),
    "visits the contacts from the last to the first": ("range(contacts.a.size)", "range(contacts.a.size)[::-1]"),
    "makes two sweeps": ("range(contacts.a.size)", "[*range(contacts.a.size)] * 2"),
    "returns J first": ("    return v, omega, J", "    return J, v, omega"),
    "returns velocities only": ("    return v, omega, J", "    return v, omega"),
    "uses the places in place of the arms": ("arms.r_a[k, 0], arms.r_a[k, 1]", "contacts.p[k, 0], contacts.p[k, 1]"),
    "uses the arm of b for both bodies": ("arms.r_a[k, 0], arms.r_a[k, 1]", "arms.r_b[k, 0], arms.r_b[k, 1]"),
    "uses k_t for the normal impulse": ("arms.k_n[k]", "arms.k_t[k]"),
    "uses the normal of the first contact for all": ("contacts.n[k, 0], contacts.n[k, 1]",
                                                     "contacts.n[0, 0], contacts.n[0, 1]"),
    "allows the approach to go on by 1e-9 m/s": ("(aim[k] - u_n", "(aim[k] - 1e-9 - u_n"),
    "pushes by the old normal impulse in the limit of friction":
        ("pile.mu * J_n if J_n > 0.0",
         "pile.mu * (n_x * J[k, 0] + n_y * J[k, 1]) if J_n > 0.0"),
})


edits("9.16", {
    "slides against the velocity, not to the side of the impulse that would stick":
        ("-limit if J_t < -limit else limit if J_t > limit else J_t",
         "(-limit if u_t > 0.0 else limit) if abs(J_t) > limit else J_t"),
    "leaves the impulse of a contact that separates and does not push":
        ("J_n += (aim", "if u_n > aim[k] and J_n <= 0.0: continue\n        J_n += (aim"),
    "does not push b where b cannot turn": ("inv_mass[b] * d_x", "inv_mass[b] * d_x * (inv_inertia[b] > 0.0)"),
    "uses the arm of a for the velocity of b's point": ("- omega[b] * b_x", "- omega[b] * a_x"),
    "uses the spin of a for both bodies": ("+ omega[b] * b_y", "+ omega[a] * b_y"),
    "reverses the tangent in the change along x": ("J_n * n_x - J_t * n_y - J", "J_n * n_x + J_t * n_y - J"),
    "reverses the tangent in the change along y": ("J_n * n_y + J_t * n_x - J", "J_n * n_y - J_t * n_x - J"),
    "limits the target to zero or less": ("(aim[k] - u_n", "(min(aim[k], 0.0) - u_n"),
})


@right("9.16", "by the stick and slip of complex numbers")
def velocity_sweep_2d(v, omega, J, aim, give, contacts, arms, pile):
    v, omega, J = v.copy(), omega.copy(), J.copy()
    for k in range(len(contacts.a)):
        pair = ((contacts.a[k], complex(*arms.r_a[k]), 1.0), (contacts.b[k], complex(*arms.r_b[k]), -1.0))
        n, old = complex(*contacts.n[k]), complex(*J[k])
        u = n.conjugate() * sum(sign * (complex(*v[i]) + 1j * omega[i] * r) for i, r, sign in pair)
        j = n.conjugate() * old
        k_n = arms.k_n[k]
        J_n = max(0.0, j.real + (aim[k] - u.real - give[k] * k_n * j.real) / (k_n * (1.0 + give[k])))
        limit = pile.mu * J_n if J_n > 0.0 else 0.0
        change = n * complex(J_n, np.clip(j.imag - u.imag / arms.k_t[k], -limit, limit)) - old
        J[k] += [change.real, change.imag]
        for i, r, sign in pair:
            v[i] += sign * pile.inv_mass[i] * np.array([change.real, change.imag])
            omega[i] += sign * pile.inv_inertia[i] * (r.conjugate() * change).imag
    return v, omega, J


@right("9.16", "by a matrix for each contact")
def velocity_sweep_2d_2(v, omega, J, aim, give, contacts, arms, pile):
    state, J = np.column_stack((v, omega)), J.copy()
    for k, (a, b) in enumerate(zip(contacts.a, contacts.b, strict=True)):
        basis = np.array([contacts.n[k], (-contacts.n[k, 1], contacts.n[k, 0])])
        G = {i: sign * basis @ [[1.0, 0.0, -r[1]], [0.0, 1.0, r[0]]]
             for i, r, sign in ((a, arms.r_a[k], 1.0), (b, arms.r_b[k], -1.0))}
        u, (J_n, J_t) = sum(G[i] @ state[i] for i in (a, b)), basis @ J[k]
        soft = 1.0 + give[k]
        new_n = max(0.0, (J_n + (aim[k] - u[0]) / arms.k_n[k]) / soft)
        size = abs(new_t := J_t - u[1] / arms.k_t[k])
        if new_n == 0.0:
            new_t = 0.0
        elif size > pile.mu * new_n:
            new_t *= pile.mu * new_n / size
        change = np.array([new_n - J_n, new_t - J_t])
        J[k] += change @ basis
        for i in (b, a):
            state[i] += np.array([pile.inv_mass[i], pile.inv_mass[i], pile.inv_inertia[i]]) * (change @ G[i])
    return state[:, :2], state[:, 2], J


right("9.16", "as a list")(lambda *given: list(worked.velocity_sweep_2d(*given)))
right("9.16", "with arrays that are not contiguous")(
    lambda *given: tuple(np.repeat(part, 2, axis=0)[::2] for part in worked.velocity_sweep_2d(*given)))


edits("9.16", {
    "returns the given arrays themselves where there are no contacts":
        ("v, omega, J = float_copy(v), float_copy(omega), float_copy(J)",
         "v, omega, J = (v, omega, J) if J.size == 0 else (float_copy(v), float_copy(omega), float_copy(J))"),
    "does not turn a body with an inverse mass of 0":
        ("inv_mass, inv_inertia = pile.inv_mass, pile.inv_inertia",
         "inv_mass, inv_inertia = pile.inv_mass, pile.inv_inertia * (pile.inv_mass > 0.0)"),
})


# 9.17 -----------------------------------------------------------------------------------------------------------
edits("9.17", {
    "uses 1/A_kk for the normal, regardless of r": ("J[n] - r[n] * (A[n] @ J + b[n])",
                                                  "J[n] - (A[n] @ J + b[n]) / A[n, n]"),
    "uses 1/A_kk for friction, regardless of r": ("J[t] - r[t] * (A[t] @ J + b[t])",
                                                "J[t] - (A[t] @ J + b[t]) / A[t, t]"),
    "uses the factor of the normal for friction, too": ("r[t] *", "r[n] *"),
    "uses the factor of the first contact for all": ("r[n] *", "r[0] *"),
    "divides by r": ("r[n] * (A[n] @ J + b[n])", "(A[n] @ J + b[n]) / r[n]"),
    "takes r for a share of 1/A_kk": ("r[n] * (A[n] @ J + b[n])", "r[n] * (A[n] @ J + b[n]) / A[n, n]"),
    "moves along the velocity, not against it": ("J[n] - r[n]", "J[n] + r[n]"),
    "lets contacts pull": ("np.maximum(0.0, J[n] - r[n] * (A[n] @ J + b[n]))", "J[n] - r[n] * (A[n] @ J + b[n])"),
    "projects the velocity, not the impulse": ("np.maximum(0.0, J[n] - r[n] * (A[n] @ J + b[n]))",
                                               "J[n] - r[n] * np.minimum(0.0, A[n] @ J + b[n])"),
    "omits b": ("(A[n] @ J + b[n])", "(A[n] @ J)"),
    "limits friction on one side only": ("np.minimum(np.maximum(J[t] - r[t] * (A[t] @ J + b[t]), -limit), limit)",
                                         "np.minimum(J[t] - r[t] * (A[t] @ J + b[t]), limit)"),
    "limits friction by the μ of the first contact": ("mu[n // 2]", "mu[0]"),
    "multiplies the limit of friction by r": ("limit = mu[n // 2] * J[n]", "limit = r[t] * mu[n // 2] * J[n]"),
    "changes its input": ("J = float_copy(J)", "pass"),
    "visits the contacts from the last to the first": ("range(0, J.size, 2)", "range(0, J.size, 2)[::-1]"),
    "makes two sweeps": ("range(0, J.size, 2)", "[*range(0, J.size, 2)] * 2"),
    "leaves out the last contact": ("range(0, J.size, 2)", "range(0, J.size - 2, 2)"),
    "multiplies an infinite μ by a normal impulse of zero": (" if J[n] > 0.0 else 0.0", ""),
    "sticks without a normal impulse where μ is infinite":
        ("if J[n] > 0.0 else 0.0", "if J[n] > 0.0 else np.inf if mu[n // 2] == np.inf else 0.0"),
    "limits μ to 1000": ("mu[n // 2] * J[n]", "min(mu[n // 2], 1e3) * J[n]"),
    "rubs without a limit": ("if J[n] > 0.0 else 0.0", "if J[n] > 0.0 else np.inf"),
    "leaves a contact alone that separates before the sweep and does not push":
        ("for n in range(0, J.size, 2):", "u = A @ J + b\n    for n in range(0, J.size, 2):\n"
         "        if u[n] > 0.0 and J[n] == 0.0:\n            J[n + 1] = 0.0\n            continue"),
    "visits twenty contacts at most": ("range(0, J.size, 2)", "range(0, min(J.size, 40), 2)"),
    "keeps the friction of a contact that pushes and neither approaches nor separates":
        ("t = n + 1", "t = n + 1\n        if J[n] > 0.0 == A[n] @ J + b[n]: continue"),
    "takes an infinite μ for 1e6": ("mu[n // 2] * J[n]", "min(mu[n // 2], 1e6) * J[n]"),
})


@right("9.17", "keeps the velocities up to date")
def proximal_sweep(A, b, J, mu, r):
    J, u = J.copy(), A @ J + b
    for k in range(len(J)):
        size = np.inf if k % 2 == 0 else mu[k // 2] * J[k - 1] if J[k - 1] > 0.0 else 0.0
        change = np.clip(J[k] - r[k] * u[k], -size if k % 2 else 0.0, size) - J[k]
        J[k] += change
        u += change * A[:, k]
    return J


# 9.18 -----------------------------------------------------------------------------------------------------------
edits("9.18", {
    "subtracts the legs from the hypotenuse": ("else x + y - h", "else h - x - y"),
    "loses the digits of a small leg": ("if x > 0.0 and y > 0.0 else", "if False else"),
    "forgets the factor 2": ("2.0 * min(x, y)", "min(x, y)"),
    "uses the form with the product everywhere": (" if x > 0.0 and y > 0.0 else x + y - h", ""),
    "uses the form with the product where one of both is above zero": ("x > 0.0 and y > 0.0", "x > 0.0 or y > 0.0"),
    "returns the smaller one where the other one is a million times larger":
        ("phi = 2.0", "phi = min(x, y) if 0.0 < min(x, y) < 1e-6 * max(x, y) else 2.0"),
    "adds the hypotenuse": ("else x + y - h", "else x + y + h"),
    "has the slopes of the hypotenuse": ("1.0 - x / h, 1.0 - y / h", "x / h, y / h"),
    "exchanges the slopes": ("1.0 - x / h, 1.0 - y / h", "1.0 - y / h, 1.0 - x / h"),
    "takes half of the slopes of the hypotenuse": ("1.0 - x / h, 1.0 - y / h", "1.0 - 0.5 * x / h, 1.0 - 0.5 * y / h"),
    "takes twice the slopes of the hypotenuse": ("1.0 - x / h, 1.0 - y / h", "1.0 - 2.0 * x / h, 1.0 - 2.0 * y / h"),
    "omits the slopes of the legs' sum at (0, 0)": ("return 0.0, 1.0 - np.sqrt(0.5), 1.0 - np.sqrt(0.5)",
                                                    "return 0.0, -np.sqrt(0.5), -np.sqrt(0.5)"),
    "has slopes of 1 at (0, 0)": ("return 0.0, 1.0 - np.sqrt(0.5), 1.0 - np.sqrt(0.5)", "return 0.0, 1.0, 1.0"),
    "has slopes of 0 at (0, 0)": ("return 0.0, 1.0 - np.sqrt(0.5), 1.0 - np.sqrt(0.5)", "return 0.0, 0.0, 0.0"),
    "returns φ alone": ("return phi, 1.0 - x / h, 1.0 - y / h", "return phi"),
    "reverses the signs of the slopes": ("1.0 - x / h, 1.0 - y / h", "x / h - 1.0, y / h - 1.0"),
    "takes the square of the hypotenuse": ("h = np.hypot(x, y)", "h = x * x + y * y"),
    "takes the sum of the legs for the hypotenuse": ("h = np.hypot(x, y)", "h = abs(x) + abs(y)"),
    "takes small numbers for zero": ("if h == 0.0:", "if h < 1e-12:"),
    "takes x = 0 for the kink": ("if h == 0.0:", "if x == 0.0 and y >= 0.0:"),
    "takes x = 0 with y below zero for the kink": ("if h == 0.0:", "if h == 0.0 or x == 0.0 and y < 0.0:"),
    "takes x + y = 0 for the kink": ("if h == 0.0:", "if x + y == 0.0:"),
    "has the slopes of (0, 0) wherever x = y":
        ("return phi, 1.0 - x / h, 1.0 - y / h",
         "return (phi, 1.0 - x / h, 1.0 - y / h) if x != y else (phi, 1.0 - np.sqrt(0.5), 1.0 - np.sqrt(0.5))"),
    "uses the form with the product where both have the same sign": ("x > 0.0 and y > 0.0", "x * y > 0.0"),
    "adds the small leg to the difference of the large one and the hypotenuse":
        ("2.0 * min(x, y) * (max(x, y) / (x + y + h))", "min(x, y) + (max(x, y) - h)"),
    "takes two terms of a series where one number is a thousand times larger":
        ("phi = 2.0", "phi = min(x, y) * (1.0 - 0.5 * min(x, y) / max(x, y)) if 0.0 < min(x, y) < 1e-3 * max(x, y) "
         "else 2.0"),
    "has slopes of 2 where both are below zero and one is a thousand times larger":
        ("return phi, 1.0", "return (phi, 2.0, 2.0) if x < 0.0 and y < 0.0 and max(x / y, y / x) > 1e3 else phi, 1.0"),
})


@right("9.18", "by the angle of the triangle")
def fischer_burmeister(x, y):
    size = np.hypot(x, y)
    if size == 0.0:
        return 0.0, 1.0 - 1.0 / np.sqrt(2.0), 1.0 - 1.0 / np.sqrt(2.0)
    c, s = x / size, y / size
    phi = 2.0 * max(x, y) * min(c, s) / (c + s + 1.0) if min(x, y) > 0.0 else x + y - size
    return phi, 1.0 - c, 1.0 - s


# 9.19 -----------------------------------------------------------------------------------------------------------
edits("9.19", {
    "solves for the contacts that do not push": ("if u[k] < A[k, k] * lam[k]:", "if u[k] > A[k, k] * lam[k]:"),
    "compares a velocity with an impulse": ("if u[k] < A[k, k] * lam[k]:", "if u[k] < lam[k]:"),
    "solves for all contacts that approach": ("if u[k] < A[k, k] * lam[k]:", "if u[k] < 0.0:"),
    "solves for all contacts that have pushed": ("if u[k] < A[k, k] * lam[k]:", "if lam[k] > 0.0:"),
    "solves for all contacts": ("if u[k] < A[k, k] * lam[k]:", "if True:"),
    "reverses the sign of b": ("matrix[k], right[k] = A[k], -b[k]", "matrix[k], right[k] = A[k], b[k]"),
    "omits b": ("matrix[k], right[k] = A[k], -b[k]", "matrix[k] = A[k]"),
    "returns the change, not the impulses": ("return solve(matrix, right)", "return solve(matrix, right) - lam"),
    "adds the solution to the impulses": ("return solve(matrix, right)", "return lam + solve(matrix, right)"),
    "cuts off what pulls": ("return solve(matrix, right)", "return np.maximum(0.0, solve(matrix, right))"),
    "takes the velocities for the right-hand side": ("right[k] = A[k], -b[k]", "right[k] = A[k], -u[k]"),
    "treats each contact as if it were alone": ("matrix[k], right[k] = A[k], -b[k]",
                                                "matrix[k, k], right[k] = A[k, k], -b[k]"),
    "goes half of the way": ("return solve(matrix, right)", "return 0.5 * (lam + solve(matrix, right))"),
    "omits b in the velocities": ("u, matrix, right = A @ lam + b,", "u, matrix, right = A @ lam,"),
    "leaves the impulses of the others as they are": ("np.zeros(b.size)", "float_copy(lam)"),
    "leaves out the last contact": ("range(b.size)", "range(b.size - 1)"),
    "takes half of each row where both are equal":
        ("matrix[k], right[k] = A[k], -b[k]", "matrix[k], right[k] = A[k], -b[k]\n"
         "        elif u[k] == A[k, k] * lam[k]:\n"
         "            matrix[k], right[k] = 0.5 * (A[k] + matrix[k]), -0.5 * b[k]"),
    "keeps the impulse where both are equal":
        ("matrix[k], right[k] = A[k], -b[k]", "matrix[k], right[k] = A[k], -b[k]\n"
         "        elif u[k] == A[k, k] * lam[k]:\n            right[k] = A[k, k] * lam[k]"),
    "solves for contacts without an impulse that approach without impulses":
        ("u[k] < A[k, k] * lam[k]", "u[k] < A[k, k] * lam[k] or (lam[k] == 0.0 > b[k])"),
    "takes almost equal for equal": ("u[k] < A[k, k] * lam[k]", "u[k] < A[k, k] * lam[k] - 1e-6 * abs(u[k])"),
    "goes half of the way where the largest minimum grows":
        ("return solve(matrix, right)",
         "new, d = solve(matrix, right), np.diag(A)\n    return new if b.size == 0 or np.max(np.abs(np.minimum("
         "d * new, A @ new + b))) <= np.max(np.abs(np.minimum(d * lam, u))) else 0.5 * (lam + new)"),
    "looks at ten contacts at most": ("range(b.size)", "range(min(b.size, 10))"),
    "returns no impulses where all pull":
        ("return solve(matrix, right)",
         "return solve(matrix, right) if b.size == 0 or np.any(lam >= 0.0) else np.zeros(b.size)"),
    "solves for all contacts where no impulse is given":
        ("u[k] < A[k, k] * lam[k]", "u[k] < A[k, k] * lam[k] or not np.any(lam)"),
    "lets each contact push alone where no impulse is given":
        ("return solve(matrix, right)",
         "return solve(matrix, right) if np.any(lam) else np.maximum(0.0, -b / np.diag(A))"),
    "leaves out small parts of the solution, as if contacts were redundant":
        ("return solve(matrix, right)", "return np.linalg.pinv(matrix, 1e-3) @ right"),
    "looks for the least velocity, also of no contact": ("u, matrix", "(A @ lam + b).min(); u, matrix"),
})


@right("9.19", "solves for the contacts that push, alone")
def minimum_map_step(A, b, lam):
    on = np.flatnonzero(A @ lam + b <= np.diag(A) * lam)
    new = np.zeros(len(b))
    new[on] = np.linalg.solve(A[np.ix_(on, on)], -b[on])
    return new


@right("9.19", "by the slopes of the minimum map")
def minimum_map_step_2(A, b, lam):
    x, u = np.diag(A) * lam, A @ lam + b
    slopes = np.where((x < u)[:, None], np.diag(np.diag(A)), A)
    return lam - np.linalg.solve(slopes, np.minimum(x, u))


# 9.20 -----------------------------------------------------------------------------------------------------------
edits("9.20", {
    "is below the ground where the block slides back": ("np.abs(v)", "v"),
    "forgets the friction": ("mu * np.abs(v) * dt", "np.abs(v) * dt"),
    "returns a velocity, not a gap": ("mu * np.abs(v) * dt", "mu * np.abs(v)"),
    "forgets the velocity": ("mu * np.abs(v) * dt", "mu * dt"),
    "lifts by half of it, as a mean over the step": ("mu * np.abs(v) * dt", "0.5 * mu * np.abs(v) * dt"),
    "grows with the square of the step": ("mu * np.abs(v) * dt", "mu * np.abs(v) * dt * dt"),
    "takes the way that gravity gives in the step": ("mu * np.abs(v) * dt", "mu * 9.81 * dt * dt"),
    "sinks in place of floating": ("mu * np.abs(v) * dt", "-mu * np.abs(v) * dt"),
    "divides by the friction": ("mu * np.abs(v) * dt", "np.abs(v) * dt / mu if mu else 0.0"),
    "floats nowhere: takes the relaxation for Coulomb's law": ("mu * np.abs(v) * dt", "0.0"),
    "takes the sine of the angle of friction for its tangent": ("mu * np.abs(v) * dt",
                                                                "mu * np.abs(v) * dt / np.sqrt(1.0 + mu * mu)"),
    "squares the friction": ("mu * np.abs(v) * dt", "mu * mu * np.abs(v) * dt"),
    "limits μ to 1": ("mu * np.abs(v) * dt", "min(mu, 1.0) * np.abs(v) * dt"),
    "doubles it": ("mu * np.abs(v) * dt", "2.0 * mu * np.abs(v) * dt"),
    "limits μ to 2": ("mu * np.abs(v)", "min(mu, 2.0) * np.abs(v)"),
    "takes a μ below 0.01 for ice": ("mu * np.abs(v)", "(mu >= 0.01) * mu * np.abs(v)"),
    "limits v to 100 m/s": ("np.abs(v)", "min(np.abs(v), 100.0)"),
    "limits the step to 1/20 s": ("* dt", "* min(dt, 0.05)"),
    "has steps of 0.1 ms at least": ("* dt", "* max(dt, 1e-4)"),
    "floats below a metre only": ("mu * np.abs(v) * dt", "min(1.0, mu * np.abs(v) * dt)"),
})
right("9.20", "by the slope of the cone's edge")(lambda mu, v, dt: np.tan(np.arctan(mu)) * dt * max(v, -v))


# 9.21 -----------------------------------------------------------------------------------------------------------
edits("9.21", {
    "chooses the curve that grows: that solver does not converge, and the relaxation does":
        ("return \"B\"", "return \"C\""),
    "chooses the slow curve: slow sweeps still end where the laws hold, and the relaxation does not":
        ("return \"B\"", "return \"D\""),
    "chooses the curve that falls fastest: Newton's method solves the laws as they are":
        ("return \"B\"", "return \"A\""),
    "gives a number, not a letter": ("return \"B\"", "return 2"),
    "gives a word, not a letter": ("return \"B\"", "return \"the second\""),
})
right("9.21", "as a small letter")(lambda: "b")


# 9.22 -----------------------------------------------------------------------------------------------------------
edits("9.22", {
    "makes plain sweeps": ("if 0.0 < size < before:", "if False:"),
    "makes a sweep more than it may": ("range(calls - 1)", "range(calls)"),
    "makes ten times as many sweeps as it may": ("range(calls - 1)", "range(10 * calls)"),
    "makes one sweep only": ("range(calls - 1)", "range(0)"),
    "divides by zero where a sweep changes nothing": ("if 0.0 < size < before:", "if size <= before:"),
    "ends where the squared change is below 1e-12":
        ("if 0.0 < size < before:", "if size < 1e-12: return swept\n        if 0.0 < size < before:"),
    "ends where the change is below 1e-8 N s": ("size = change @ change", "size = change @ change\n        "
                                               "if np.allclose(swept, J): return swept"),
    "goes back along the direction": ("swept + size", "swept - size"),
    "forgets the change in the direction": ("size / before * p + change", "size / before * p"),
    "goes on as if the changes were zero": ("before = size", "before = np.inf"),
    "changes its input": ("J, p, before = float_copy(J),", "J[:] = sweep(J); J, p, before = J,"),
    "returns no impulses": ("return sweep(J)", "return 0.0 * sweep(J)"),
    "ends with an extrapolation, not with a sweep": ("return sweep(J)", "return J"),
    "goes beyond the last sweep": ("return sweep(J)", "return J + 1.5 * (sweep(J) - J)"),
    "returns the mean of the last two guesses": ("return sweep(J)", "return 0.5 * (J + sweep(J))"),
    "makes plain sweeps of more than 30 impulses":
        ("if 0.0 < size < before:", "if 0.0 < size < before and J.size < 30:"),
    "keeps the direction of the first 20 impulses only":
        ("change = swept - J", "change = swept - J; change[20:] = 0.0"),
    "ends where the change is a millionth of the impulses":
        ("if 0.0 < size", "if size <= 1e-12 * (swept @ swept): return swept\n        if 0.0 < size"),
    "makes plain sweeps unless it begins without impulses":
        ("J, p, before = float", "for _ in range(calls - 1 if np.any(J) else 0): J = sweep(J)\n"
         "    calls = 1 if np.any(J) else calls\n    J, p, before = float"),
    "makes plain sweeps where more than 500 calls are allowed":
        ("if 0.0 < size < before:", "if 0.0 < size < before and calls <= 500:"),
    "makes plain sweeps where fewer than 20 calls are allowed":
        ("if 0.0 < size < before:", "if 0.0 < size < before and calls >= 20:"),
    "begins without impulses where a given one pulls":
        ("float_copy(J), np.zeros", "float_copy(J) * (np.min(J, initial=0.0) >= 0.0), np.zeros"),
    "returns an extrapolation in which all contacts pull":
        ("before = size", "before = size\n        if J.max() < 0.0: return J"),
})


@right("9.22", "keeps a momentum, and forgets it where it leads astray")
def fewer_sweeps(sweep, J, calls):
    ahead, t = J.copy(), 1.0
    for _ in range(calls):
        new = sweep(ahead)
        if (ahead - new) @ (new - J) > 0.0:
            t = 1.0
        following = 0.5 * (1.0 + np.sqrt(1.0 + 4.0 * t * t))
        ahead, J, t = new + (t - 1.0) / following * (new - J), new, following
    return J


@right("9.22", "combines the last five sweeps so that their changes cancel")
def fewer_sweeps_2(sweep, J, calls):
    news, changes = [], []
    for _ in range(calls - 1):
        new = sweep(J)
        news, changes = [*news[-4:], new], [*changes[-4:], new - J]
        J = new
        if len(news) > 1 and np.any(changes[-1]):
            columns = np.stack([changes[-1] - other for other in changes[:-1]], axis=1)
            parts = np.linalg.lstsq(columns, changes[-1], rcond=1e-10)[0]
            J = new - sum(part * (new - other) for part, other in zip(parts, news[:-1], strict=True))
    return sweep(J)


# What a short cut takes for zero, and where an answer stops to follow the law -----------------------------------
edits("9.1", {
    "omits the rotation where the components of the arm add up to 0":
        ("sign * (r_x * d_y - r_y * d_x)", "(r_x + r_y != 0.0) * sign * (r_x * d_y - r_y * d_x)"),
    "omits the rotation where the components of the direction add up to 0":
        ("sign * (r_x * d_y - r_y * d_x)", "(d_x + d_y != 0.0) * sign * (r_x * d_y - r_y * d_x)"),
})
edits("9.3", {
    "takes impulses that add up to 0 for none":
        ("return np.max", "return max(0.0, -b.min()) if lam.sum() == 0.0 else np.max"),
})
edits("9.4", {
    "has a relaxation of 0.5 at least": ("omega *", "max(omega, 0.5) *"),
    "has a relaxation of 0.1 at least": ("omega *", "max(omega, 0.1) *"),
    "leaves contacts of heavy bodies alone": ("lam[k] = ", "lam[k] = lam[k] if A[k, k] < 1e-9 else "),
    "visits ten contacts at most": ("range(lam.size)", "range(min(lam.size, 10))"),
    "leaves impulses alone that add up to 0": ("lam[k] = ", "lam[k] = lam[k] if lam.sum() == 0.0 and lam.any() else "),
})
edits("9.5", {"treats a stack above 100,000 bodies as one of 100,000": ("np.pi / n", "np.pi / min(n, 100_000)")})
edits("9.6", {
    "returns 0 for a ratio below a millionth": ("r / (1.0 + r)", "(r >= 1e-6) * r / (1.0 + r)"),
    "takes a ratio of nearly 1 for 1": ("r / (1.0 + r)", "(0.5 if abs(r - 1.0) < 1e-5 else r / (1.0 + r))"),
})
edits("9.8", {
    "takes velocities that add up to 0 for none":
        ("check_independent(A, b)", "check_independent(A, b); b = 0.0 * b if b.sum() == 0.0 else b"),
    "accepts an infinite velocity": ("check_independent(A, b)", "check_independent(A, np.where(np.isinf(b), 1.0, b))"),
})
edits("9.9", {
    "takes an infinite μ for 1e7": ("mu[n // 2] * J[n]", "min(mu[n // 2], 1e7) * J[n]"),
    "takes a μ below 0.01 for ice": ("mu[n // 2] * J[n]", "(mu[n // 2] >= 1e-2) * min(mu[n // 2], 1e300) * J[n]"),
    "takes a μ below a millionth for ice":
        ("mu[n // 2] * J[n]", "(mu[n // 2] >= 1e-6) * min(mu[n // 2], 1e300) * J[n]"),
})
edits("9.10", {
    "takes a μ below a millionth for ice":
        ("mu[n // 2] * J[n]", "(mu[n // 2] >= 1e-6) * min(mu[n // 2], 1e300) * J[n]"),
    "visits ten contacts at most": ("range(0, J.size, 2)", "range(0, min(J.size, 20), 2)"),
    "leaves contacts of heavy bodies alone": ("t = n + 1", "t = n + 1\n        if A[n, n] < 1e-9: continue"),
    "leaves contacts of light bodies alone": ("t = n + 1", "t = n + 1\n        if A[n, n] > 1e9: continue"),
})
edits("9.11", {
    "takes a load whose components add up to 0 for none":
        ("check_scene(x, inv_mass, inv_inertia, contacts, load, mu)",
         "check_scene(x, inv_mass, inv_inertia, contacts, load, mu); load = load * (load.sum() != 0.0)"),
    "lets light bodies rest": ("a = w * (load", "a = (w.max() < 1e9) * w * (load"),
    "lets heavy bodies rest": ("F = solve", "F = np.zeros(2 * contacts.a.size) if w.max() < 1e-9 else solve"),
    "takes a μ below 0.05 for ice": ("ravel()), mu)", "ravel()), np.where(mu < 0.05, 0.0, mu))"),
    "omits the force of an open contact":
        ("return F.reshape(-1, 2)", "return F.reshape(-1, 2) * (contacts.gap <= 0.01)[:, None]"),
    **{f"accepts {what}": ("check_scene(x, inv_mass, inv_inertia, contacts, load, mu)", f"check_scene({call})")
       for what, call in (
        ("a negative inverse inertia", "x, inv_mass, np.abs(inv_inertia), contacts, load, mu"),
        ("a normal of any length above 0", "x, inv_mass, inv_inertia, contacts._replace(n=contacts.n / "
         "np.maximum(1e-300, np.linalg.norm(contacts.n, axis=1))[:, None]), load, mu"),
        ("a gap that is no number",
         "x, inv_mass, inv_inertia, contacts._replace(gap=np.nan_to_num(contacts.gap)), load, mu"),
        ("a load of too many bodies", "x, inv_mass, inv_inertia, contacts, load[:len(x)], mu"))},
})
edits("9.13", {
    "leaves J alone if its components add up to 0": ("size <= limit", "size <= limit or J[0] + J[1] + J[2] == 0.0"),
})
edits("9.14", {
    "takes an old impulse whose components add up to 0 for none":
        ("J[k, c] = J_old[s, c]", "J[k, c] = J_old[s, c] * (J_old[s].sum() != 0.0)"),
    "accepts all that is nearer than 1 mm": ("near * near", "max(near, 1e-3) ** 2"),
    "accepts nothing beyond 10 m": ("near * near", "min(near, 10.0) ** 2"),
})
edits("9.16", {
    "leaves contacts alone where the components of n add up to 0":
        ("J_n = 0.0 if J_n <= 0.0 else J_n", "J_n = 0.0 if J_n <= 0.0 or n_x + n_y == 0.0 else J_n"),
})
edits("9.17", {
    "takes a μ below 0.01 for ice": ("mu[n // 2] * J[n]", "(mu[n // 2] >= 1e-2) * min(mu[n // 2], 1e300) * J[n]"),
    "limits the factor of the normal to 50 kg": ("r[n] *", "min(r[n], 50.0) *"),
    "limits the factor of friction to 50 kg": ("r[t] *", "min(r[t], 50.0) *"),
    "has a factor of 1 g at least for the normal": ("r[n] *", "max(r[n], 1e-3) *"),
    "has a factor of 1 g at least for friction": ("r[t] *", "max(r[t], 1e-3) *"),
})
edits("9.18", {"takes numbers below 1e-30 for zero": ("if h == 0.0:", "if h < 1e-30:")})
edits("9.19", {
    "leaves impulses alone that add up to 0":
        ("return solve(matrix, right)", "return lam if lam.any() and lam.sum() == 0.0 else solve(matrix, right)"),
    "looks at twenty contacts at most": ("range(b.size)", "range(min(b.size, 20))"),
})


# A velocity b of 0, which λ or J may still change --------------------------------------------------------------------
edits("9.3", {"takes b = 0 for an answer": ("return np", "return 0.0 if not b.any() else np")})
edits("9.4", {"returns 0 where b = 0": ("return lam", "return lam if b.any() else 0.0 * lam")})
edits("9.9", {"takes b = 0 for an answer": ("return worst", "return worst if b.any() else 0.0")})
for number in ("9.10", "9.17"):
    edits(number, {"returns 0 where b = 0": ("return J", "return J if b.any() else 0.0 * J")})
edits("9.16", {
    "changes the velocities by the whole impulse, not by its change":
        ("J[k, 0], J[k, 1] = J[k, 0] + d_x, J[k, 1] + d_y",
         "d_x, d_y = J[k, 0], J[k, 1] = J[k, 0] + d_x, J[k, 1] + d_y"),
    "limits the change of the normal impulse to zero or more, not the impulse":
        ("J_n += (aim[k] - u_n - give[k] * k_n * J_n) / (k_n * (1.0 + give[k]))",
         "J_n += max(0.0, (aim[k] - u_n - give[k] * k_n * J_n) / (k_n * (1.0 + give[k])))"),
    "limits the change of the friction by its cone, not the friction":
        ("J_t = -limit if J_t < -limit else limit if J_t > limit else J_t",
         "J_t += max(-limit, min(limit, -u_t / arms.k_t[k])) + u_t / arms.k_t[k]"),
    "returns the impulses as they are where all bodies are at rest":
        ("for k in range(contacts.a.size)", "for k in range(contacts.a.size if v.any() or omega.any() else 0)"),
    "leaves out contacts of two bodies with an inverse mass of 0, which may turn":
        ("J_n += (aim", "if inv_mass[a] == 0.0 == inv_mass[b]: continue\n        J_n += (aim"),
})
