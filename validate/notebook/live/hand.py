"""The hand: a spring with a damper from a place on a body to the pointer.

Its spring is taken at the end of the step.  An explicit one is unstable for ordinary steps, because a light box turns
about the place that is held with up to some hundred radians per second.
"""

from typing import NamedTuple

import numpy as np

HERTZ, ZETA = 5.0, 1.0       # of the spring with the body that it holds, and its damping ratio
STRONGEST = 60.0             # force of the hand over the weight of the body [-]: bodies are not pulled through others
WEIGHT = 9.81                # [N/kg] that this ratio refers to, also under another gravity


class Grip(NamedTuple):
    """What the hand holds."""
    body: int                # its number in the Model
    place: tuple             # (2,) of the body, in its coordinates [m]
    target: tuple            # (2,) where the pointer is [m]


def offset(grip, q):
    """Return r (2,) from the centre of a body with angle q to the place that is held [m]."""
    c, s = np.cos(q), np.sin(q)
    return np.array((c * grip.place[0] - s * grip.place[1], s * grip.place[0] + c * grip.place[1]))


def implicit_force(e, u, K, m, dt):
    """Return F (2,) [N] of the hand on a place that moves as a mass m where nothing else holds it.

    F = −k (e + dt u′) − c u′,      u′ = u + dt K F

    e is the way from the pointer to the place that is held, u its velocity, and K F its acceleration.
    """
    rate = 2.0 * np.pi * HERTZ
    k, c = m * rate * rate, 2.0 * ZETA * m * rate
    F = -np.linalg.solve(np.eye(2) + dt * (c + dt * k) * K, k * (e + dt * u) + c * u)
    size, most = np.hypot(*F), STRONGEST * WEIGHT * m
    return F * (most / size) if size > most else F


def hand_force(grip, dt, x, q, v, omega, inv_mass, inv_inertia):
    """Return (F (2,) [N], τ [N m]) of the hand on its body."""
    r = offset(grip, q)
    across = np.array((-r[1], r[0]))
    K = inv_mass * np.eye(2) + inv_inertia * np.outer(across, across)
    F = implicit_force(x + r - np.asarray(grip.target), v + omega * across, K, 1.0 / inv_mass, dt)
    return F, float(r[0] * F[1] - r[1] * F[0])


def pulled(grip, dt, x, q, v, omega, inv_mass, inv_inertia):
    """Return (v, ω, W) of one body after the hand alone has acted for dt; W [J] is its work, exactly.

    The same as a load in the step, so that a compiled step needs no new load.
    """
    F, tau = hand_force(grip, dt, x, q, v, omega, inv_mass, inv_inertia)
    v_new, omega_new = v + dt * inv_mass * F, omega + dt * inv_inertia * tau
    work = dt * (0.5 * F @ (v + v_new) + 0.5 * tau * (omega + omega_new))
    return v_new, omega_new, float(work)


def point_force(x, v, target, k, c, m, dt):
    """Return F (2,) [N] of the hand on a point, by the way to the target and the velocity at the end of the step."""
    _, v_new = np.linalg.solve(((1.0, -dt), (dt * k / m, 1.0 + dt * c / m)), (x - target, v))
    F = m / dt * (v_new - v)
    size, most = np.hypot(*F), STRONGEST * WEIGHT * m
    return F * (most / size) if size > most else F


def pulled_point(target, dt, x, v, m, felt, force=point_force):
    """Return (v, W) of a point of mass m after the hand alone has acted for dt; W [J] is its work, exactly.

    felt is the mass of all that hangs on the point, so that the hand can lift it [kg].  The force may be the learner's.
    """
    rate = 2.0 * np.pi * HERTZ
    F = force(x, v, target, felt * rate * rate, 2.0 * ZETA * felt * rate, m, dt)
    v_new = v + dt / m * F
    return v_new, float(dt * 0.5 * F @ (v + v_new))
