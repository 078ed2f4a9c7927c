"""Given.  Points and links as arrays, what a matrix of all links needs, and the edges of a mesh."""

import numpy as np

from ..checks import BadInput, Diverged, WrongShape, check_indices, check_positive, one_each

VERLET_STABLE = 2.0          # ω dt up to which Verlet is stable [-]: its step has a trace of 2 − ω² dt²
SUZUKI_STABLE = 2.7209745385 # the same for five Verlet steps with Suzuki's shares: where |trace| is first 2


def inverse_masses(thing, m, fixed, x):
    """Given.  Return 1/m (n,) of points x (n, d), 0 if in `fixed`; m is a number or one each.  Raises BadInput."""
    if x.ndim != 2 or x.size == 0:
        raise WrongShape("the points x", x.shape, "(n, d), a row for each point")
    masses = one_each(thing, m, len(x))
    for mass in masses:
        check_positive(thing, mass)
    inv_mass = 1.0 / masses
    inv_mass[check_indices("the number of a fixed point", fixed, len(x))] = 0.0
    return inv_mass


def pull_per_length(square, along, law):
    """Given.  Return what times the way r from one end of a spring to the other is the force on the first end [N/m].

    square: r · r [m²];    along: r · (velocity of the first end − velocity of the other) [m²/s];    law: rest, k, c
    Where the ends meet, a spring without a rest length pulls with no force.
    Raises BadInput where the ends of any other spring meet, because it has no direction there.
    """
    length = np.sqrt(square)
    if length == 0.0:
        if law[0] * law[1] > 0.0:
            raise BadInput("the length of a spring [m]", 0.0, "keep its ends apart")
        return 0.0
    return -(law[1] * (length - law[0]) + law[2] * along / length) / length


def measured_links(kind, x, pairs):
    """Given.  Return (i, j, length), each (s,), of the links between points x (n, d) with numbers pairs (s, 2).

    Raises BadInput for a number out of range and WrongShape for pairs of another shape.
    """
    pairs = check_indices(f"a point number of a {kind}", pairs, len(x))
    if pairs.size == 0:
        pairs = pairs.reshape(0, 2)
    if pairs.ndim != 2 or pairs.shape[1] != 2:
        raise WrongShape("the pairs", pairs.shape, "(s, 2), two point numbers in each row")
    i, j = np.ascontiguousarray(pairs[:, 0]), np.ascontiguousarray(pairs[:, 1])
    return i, j, np.sqrt(np.sum((x[j] - x[i]) ** 2, axis=1))


def shared_edges(faces):
    """Given.  Return (edges (e, 2), hinges (h, 4)) of triangles (f, 3): every edge once, and the folds.

    A hinge is (a, b, c, d) of an edge that two triangles share: its ends a and b, the other corners c and d.
    """
    found = {}
    for face in np.asarray(faces):
        for k in range(3):
            a, b, c = face[k], face[(k + 1) % 3], face[(k + 2) % 3]
            found.setdefault((min(a, b), max(a, b)), []).append((a, b, c))
    hinges = [(*two[0], two[1][2]) for two in found.values() if len(two) == 2]
    edges = np.array(sorted(found), dtype=np.int64)
    return edges, np.array(hinges, dtype=np.int64).reshape(-1, 4)


def link_delassus_matrix(J, K, network, trace):
    """Given.  Return J W Kᵀ (s, s): the change of each constraint (gradients J) by a push along each gradient of K.

    The trace, times w_i + w_j, is added on the diagonal, so that the matrix of redundant links has an inverse, too.
    The loops visit only the two ends of each link; a product of the whole matrices takes longer.
    """
    d = J.shape[1] // network.inv_mass.size
    A = np.zeros((J.shape[0], K.shape[0]))
    for s in range(J.shape[0]):
        for k in (network.i[s], network.j[s]):                                   # row s is 0 for all other points
            for r in range(K.shape[0]):
                for c in range(k * d, k * d + d):
                    A[s, r] += network.inv_mass[k] * J[s, c] * K[r, c]
        A[s, s] += trace * (network.inv_mass[network.i[s]] + network.inv_mass[network.j[s]])
    return A


def apply_multipliers(J, Lam, network):
    """Given.  Return W JᵀΛ (n, d) [m]: how far the multipliers Λ (s,) move the points.

    The loops visit only the two ends of each link, as above.
    """
    d = J.shape[1] // network.inv_mass.size
    moved = np.zeros((network.inv_mass.size, d))
    for s in range(Lam.size):
        for k in (network.i[s], network.j[s]):
            for c in range(d):
                moved[k, c] += network.inv_mass[k] * J[s, k * d + c] * Lam[s]
    return moved


def constraint_rates(J, v):
    """Given.  Return J v (s,) [m/s]: the rate of change of each constraint."""
    return J @ v.ravel()


def check_taut_points(pulls, dt, stable, network):
    """Given.  Raise Diverged if a point between taut links swings so fast that a step of dt cannot be stable.

    pulls (s,) are τ = T/l [N/m], tension over length of the links.  A point of mass m whose neighbours stay where they
    are swings across its links with ω² = (Σ τ)/m, so the fastest swing of a rope has at least that ω.  RATTLE moves
    it as Verlet does: its amplitude grows by a factor in every step with ω dt > stable.  In such a step the links
    move a point by more than twice their length.
    *Source:* Leimkuhler and Reich 2004, 7.2 (RATTLE is Verlet on the constraint surface).
    """
    total = np.zeros(network.inv_mass.size)
    for s in range(pulls.size):
        total[network.i[s]] += pulls[s]
        total[network.j[s]] += pulls[s]
    k = np.argmax(network.inv_mass * total)
    squared = network.inv_mass[k] * total[k]
    if not dt * dt * squared <= stable * stable:
        ratio = 1.0
        for s in range(pulls.size):
            if k == network.i[s] or k == network.j[s]:
                other = network.j[s] if k == network.i[s] else network.i[s]
                if network.inv_mass[other] > 0.0:
                    ratio = max(ratio, network.inv_mass[k] / network.inv_mass[other])
        raise Diverged("(step dt [s], its stability bound [s], mass ratio of neighbours [-]) of a taut rope",
                       (float(abs(dt)), float(stable / np.sqrt(squared)), float(ratio)),
                       "take a smaller step, or a heavier point")
