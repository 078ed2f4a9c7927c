"""Pictures of lesson 7: velocities before and after an impact, and an impulse in its cone."""

import numpy as np

from .marks import Arrow, Level, Way
from .pieces import BOTH_WAYS, Picture, across, array, plane_view, scaled


def beside_surface(_, v, n, e):
    labels = ("v, x [m/s]", "y [m/s]") if len(n) == 2 else ("along the surface [m/s]", "along n [m/s]")
    return [plane_view("along the surface", across(n, v), n, 0.0 * n, labels)._replace(labels=labels)]


def towards_surface(v, n, e):
    return [Level(n, 0.0, 0.0 * n, "surface"), Arrow(-v, v, f"v before, {np.linalg.norm(v):.4g} m/s"),
            Arrow(0.0 * n, 0.4 * np.linalg.norm(v) * n, "direction of n")]


def velocity_after(result, v, n, e):
    after = array(result, len(n))
    return [Arrow(0.0 * n, after, f"v after, {np.linalg.norm(after):.4g} m/s")]


def in_plane_of_cone(_, u, n, K, u_sep, mu):
    return [plane_view("in the plane of n and u", across(n, u), n, 0.0 * n, ("along u_t [N s]", "along n [N s]"))]


def cone(u, n, K, u_sep, mu):
    """Return the tangent plane and the rim of the cone, on the scale of the impulse that would make it stick."""
    size, t = np.linalg.norm(np.linalg.solve(K, u_sep * n - u)), across(n, u)
    rims = [size * (n + side * mu * t) / np.hypot(1.0, mu) for side in BOTH_WAYS] if np.isfinite(mu) else []
    before = scaled(u, 0.6 * size)
    return [Level(n, 0.0, 0.0 * n, "tangent plane"), Arrow(-before, before, f"u, {np.linalg.norm(u):.4g} m/s"),
            *(Way(np.stack((0.0 * n, rim)), f"rim of the cone, μ = {mu:.4g}", dots=False) for rim in rims)]


def impulse(result, u, n, *_):
    J = array(result, 3)
    return [Arrow(0.0 * n, J, f"J, {np.linalg.norm(J):.4g} N s")]


PICTURES = {
    "7.1": Picture(beside_surface, towards_surface, velocity_after,
                   "the part along n is reversed and e times as large; the part along the surface stays."),
    "7.10": Picture(in_plane_of_cone, cone, impulse, "J stays inside the cone or on its rim, and brakes the slip."),
}
