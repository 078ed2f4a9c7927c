"""Ropes by RATTLE: what no link can change, under a load that grows with time."""

import numpy as np

from validate.stability.case import case, random_law

EXACT = 1e-9                 # of numbers around 1: the same by another sum


def free_rope(lesson, rng):
    """Return (x, v, ConstraintNetwork, masses) of a rope of five points in space that nothing holds.

    The velocities do not stretch it: the rope turns, and each point also moves across both its links in turn.
    """
    m, x = rng.uniform(0.5, 2.0, 5), np.cumsum(rng.normal(size=(5, 3)), axis=0)
    network = lesson.make_constraint_network(x, m, [], [(k, k + 1) for k in range(4)], 0.0, 1.0, (0.0, 0.0, -9.81), 1)
    v = np.zeros((5, 3)) + rng.normal(size=3)
    for k in range(4):                                                   # what lies behind link k turns about its start
        v[k + 1:] += np.cross(rng.normal(size=3), x[k + 1] - x[k])
    return x, v, network, m


def growing(rng):
    """Return (acceleration that is the same everywhere and linear in time, its integral from t to t + dt)."""
    still, grows = rng.normal(size=(2, 3))
    return (lambda t, x, v, p: (still + t * grows) * np.ones((len(x), 1)),
            lambda t, dt: dt * (still + (t + 0.5 * dt) * grows))


@random_law("The links of a rope keep its momentum: it changes by the integral of a load that is linear in time.",
            "rope: largest error of the momentum, and of the velocity along links [kg m/s, m²/s]", EXACT)
def momentum_of_a_rope(lesson, rng):
    """Both steps take the load by the trapezoidal rule, which is exact for it; their links end at rest lengthwise."""
    x, v, network, m = free_rope(lesson, rng)
    (load, impulse), t, dt = growing(rng), rng.uniform(0.0, 1.0), 0.01
    ends = [getattr(lesson, name)(load, t, x, v, dt, network) for name in ("rope_step", "composed_rope_step")]
    P = m @ v + np.sum(m) * impulse(t, dt)
    return (tuple((m @ v_new, np.sum(np.diff(x_new, axis=0) * np.diff(v_new, axis=0), axis=1))[k]
                  for x_new, v_new in ends for k in (0, 1)), (P, np.zeros(4), P, np.zeros(4)))


@random_law("Without a load a rope keeps its angular momentum, and links their lengths to the fourth order in dt.",
            "rope: largest error of the angular momentum and of the lengths over dt⁴ [kg m²/s]", EXACT)
def spin_of_a_rope(lesson, rng):
    x, v, network, m = free_rope(lesson, rng)
    L, found, rest = np.sum(m[:, None] * np.cross(x, v), axis=0), [], np.linalg.norm(np.diff(x, axis=0), axis=1)
    still = lambda t, x, v, p: 0.0 * x
    for name in ("rope_step", "composed_rope_step"):
        end, speed = getattr(lesson, name)(still, 0.0, x, v, 1e-3, network)
        found += [np.sum(m[:, None] * np.cross(end, speed), axis=0), np.linalg.norm(np.diff(end, axis=0), axis=1)]
    return tuple(found), (L, rest, L, rest)


@random_law("Points that nothing joins fly each by itself; a load that is linear in time changes v by its integral.",
            "points without links: largest error of places and velocities [m, m/s]", EXACT)
def points_without_links(lesson, rng):
    """Push each point another way: x' = x + dt v + ½ dt² a(t), and the trapezoidal rule is exact for v'."""
    (x, v, still, grows), t, dt = rng.normal(size=(4, 4, 3)), rng.uniform(0.0, 1.0), rng.uniform(0.01, 0.1)
    network = lesson.make_constraint_network(x, rng.uniform(0.5, 2.0, 4), [], [], 0.0, 1.0, (0.0, 0.0, -9.81), 1)
    end = lesson.rattle_step(lambda t, x, v, p: still + t * grows, t, x, v, dt, network)
    return end, (x + dt * v + 0.5 * dt * dt * (still + t * grows), v + dt * (still + (t + 0.5 * dt) * grows))


@case("ropes", "Ropes in flight", compiled=False)
def ropes(lesson, check):
    """Compare steps of a rope that nothing holds with conserved momenta and with the integral of its load."""
    check.laws(lesson, (momentum_of_a_rope, spin_of_a_rope, points_without_links), seed=36, times=20)
