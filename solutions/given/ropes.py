"""Given.  A rope by RATTLE with a tridiagonal matrix: link s joins points s and s + 1: Newton's matrix is a band.

One Newton correction per step is enough: it leaves the links off by O(dt⁴), which does not accumulate, because the next
step corrects it.  The work grows with the number of links, where a full matrix costs its third power.
*Source:* Andersen 1983 (RATTLE); Suzuki 1990 (composition); the elimination for a band is Thomas's.
"""

import numpy as np

from ..checks import BadInput
from ..rotation import SUZUKI
from ..support.networks import SUZUKI_STABLE, VERLET_STABLE, check_taut_points


def check_rope(network):
    """Raise BadInput unless link s of a ConstraintNetwork joins the points s and s + 1."""
    for s in range(network.i.size):
        if network.i[s] != s or network.j[s] != s + 1:
            raise BadInput("a link that does not join two neighbours", s, "give links (0, 1), (1, 2), … of one rope")


def link_product(a, r, b, s):
    """Link r of the points a times link s of the points b:  (a_{r+1} − a_r) · (b_{s+1} − b_s)."""
    total = 0.0
    for c in range(a.shape[1]):
        total += (a[r + 1, c] - a[r, c]) * (b[s + 1, c] - b[s, c])
    return total


def move_along_links(y, x, z, right, w):
    """Move y (n, d) along the links of x, in place, so that (link s of z) · (link s of y) grows by right[s].

    w (n,) are the inverse masses.  right becomes the multiples of the links: negative where a link pulls.
    """
    n, ratio = right.size, np.zeros(right.size)
    for s in range(n):
        diagonal = (w[s] + w[s + 1]) * link_product(z, s, x, s)
        if s > 0:
            before = -w[s] * link_product(z, s, x, s - 1)
            diagonal -= before * ratio[s - 1]
            right[s] -= before * right[s - 1]
        if s < n - 1:
            ratio[s] = -w[s + 1] * link_product(z, s, x, s + 1) / diagonal
        right[s] /= diagonal
    for s in range(n - 1, -1, -1):
        if s < n - 1:
            right[s] -= ratio[s] * right[s + 1]
        for c in range(x.shape[1]):
            pull = right[s] * (x[s + 1, c] - x[s, c])
            y[s, c] -= w[s] * pull
            y[s + 1, c] += w[s + 1] * pull


def rope_step(acceleration, t, x, v, dt, network):
    """Advance a rope by one step of RATTLE with one Newton correction; second order; its energy does not run down.

    The first end of a rope may be fixed, or any other point that leaves every link a movable end.
    Raises Diverged where a light point between taut links swings faster than dt allows, ω dt > 2: check_taut_points.
    """
    check_rope(network)
    return taut_rope_step(acceleration, t, x, v, dt, dt, VERLET_STABLE, network)


def taut_rope_step(acceleration, t, x, v, dt, whole, stable, network):
    """The rope_step by dt, as a part of a whole step [s] that is stable up to ω · whole = stable [-]."""
    right = np.zeros(network.rest.size)
    half = v + 0.5 * dt * acceleration(t, x, v, network)                 # the velocity in the middle of the step
    new = x + dt * half
    for s in range(right.size):
        right[s] = 0.5 * (network.rest[s] * network.rest[s] - link_product(new, s, new, s)) / dt
    move_along_links(half, x, new, right, network.inv_mass)
    check_taut_points(-2.0 / dt * right, whole, stable, network)
    new = x + dt * half
    v = half + 0.5 * dt * acceleration(t + dt, new, half, network)
    for s in range(right.size):
        right[s] = -link_product(new, s, v, s)
    move_along_links(v, new, new, right, network.inv_mass)
    return new, v


def composed_rope_step(acceleration, t, x, v, dt, network):
    """Advance a rope by five rope_steps, the third one backwards, as `compose` of lesson 5 does; fourth order.

    Raises Diverged where a light point between taut links swings with ω dt > SUZUKI_STABLE, about 2.72.
    """
    check_rope(network)
    for share in (SUZUKI, SUZUKI, 1.0 - 4.0 * SUZUKI, SUZUKI, SUZUKI):
        x, v = taut_rope_step(acceleration, t, x, v, share * dt, dt, SUZUKI_STABLE, network)
        t = t + share * dt
    return x, v
