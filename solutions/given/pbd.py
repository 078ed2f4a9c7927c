"""Given with lesson 8.  Networks, cloth, a balloon and a body on a pivot: what they are made of, and their steps."""

from typing import NamedTuple

import numpy as np

from ..checks import BadInput, Diverged, check_shape, finite_array, float_copy, one_each, whole_number
from ..pbd import *  # noqa: F403    one import has a lesson and its given functions
from ..pbd import (
    NEWTON_LIMIT,
    NEWTON_TOLERANCE,
    REGULARISATION,
    ConstraintNetwork,
    Obstacle,
    angular_acceleration,
    apply_positional_impulse,
    ball_gap,
    compliant_multiplier,
    compliant_sweep,
    constraint_correction,
    constraints,
    distance_sweep,
    effective_inverse_mass_at,
    floor_gap,
    fold_constraint,
    keep_outside,
    predict,
    quaternion_update,
    rotate,
    solve,
    turning_rate,
    volume_gradient,
)
from ..support.networks import apply_multipliers, constraint_rates, inverse_masses, link_delassus_matrix, measured_links
from ..support.records import check_record
from ..vectors import dot

FIRST_REGULARISATION = 1e-10 # the same while gaps still close: redundant links then disagree by more than round-off


class Cloth(NamedTuple):
    """A network whose faces resist folding."""
    network: ConstraintNetwork
    hinges: np.ndarray       # (h, 4) points a, b, c, d of each fold: edge a–b, other corners c and d of its faces
    fold: np.ndarray         # (h,) rest angle of each fold [rad]; 0 is flat
    stiffness: float         # share of the error of a fold that is removed per visit [-]
    obstacle: Obstacle


class Balloon(NamedTuple):
    """A closed network filled with air."""
    network: ConstraintNetwork
    faces: np.ndarray        # (f, 3) corners, counter-clockwise seen from outside
    volume: float            # rest volume [m³]
    alpha: float             # compliance of the air [m³/(N/m²)]; 0 keeps the volume
    obstacle: Obstacle


class PivotedBody(NamedTuple):
    """A rigid body that hangs from a fixed point."""
    m: float                 # mass [kg]
    I_body: np.ndarray       # (3,) principal moments [kg m²]
    gravity: np.ndarray      # (3,) [m/s²]
    pivot: np.ndarray        # (3,) [m]
    arm_body: np.ndarray     # (3,) from the centre of mass to the pivot, in the body's coordinates [m]
    sweeps: int              # projections per step


def network_gravity(t, x, v, network):
    """Given.  Return a (n, d) [m/s²]: gravity for every movable point, 0 for the others."""
    a = np.zeros(x.shape)
    for k in range(x.shape[0]):
        if network.inv_mass[k] > 0.0:
            for c in range(x.shape[1]):
                a[k, c] = network.gravity[c]
    return a


def rattle_step(acceleration, t, x, v, dt, network):
    """Given.  Advance a network by RATTLE: gradients at the start of a step, velocities that obey the links; order 2.

    x' = x + dt v + ½dt² a + W J(x)ᵀΛ  with C(x') = 0,      v' = (x' − x)/dt + ½dt a' + W J(x')ᵀμ  with J(x') v' = 0

    Its energy does not run down.  It is not in the lecture; it serves as the standard for the projection method.
    *Source:* Ryckaert et al. 1977 (SHAKE), Andersen 1983 (RATTLE).
    """
    _, J = constraints(x, network)
    new = x + dt * v + 0.5 * dt * dt * acceleration(t, x, v, network)
    if network.i.size == 0:
        return new, (new - x) / dt + 0.5 * dt * acceleration(t + dt, new, v, network)
    for _ in range(NEWTON_LIMIT):
        C, J_new = constraints(new, network)
        # The next round removes the error of the regularisation.
        Lam = solve(link_delassus_matrix(J_new, J, network, FIRST_REGULARISATION), -C)
        change = apply_multipliers(J, Lam, network)
        new = new + change
        if max(np.max(np.abs(change)), np.max(np.abs(C))) <= NEWTON_TOLERANCE * np.max(network.rest):
            v = (new - x) / dt + 0.5 * dt * acceleration(t + dt, new, v, network)
            _, J = constraints(new, network)
            mu = solve(link_delassus_matrix(J, J, network, REGULARISATION), constraint_rates(J, v))
            return new, v - apply_multipliers(J, mu, network)
    raise Diverged("the projection did not converge at dt [s]", dt, "take a smaller step, or slacken what is taut")


def fold_sweep(x, cloth):
    """Given.  Return the positions after one visit to every fold of a cloth."""
    x = float_copy(x)
    for h in range(cloth.fold.size):
        corners, w = np.zeros((4, 3)), np.zeros(4)
        points = cloth.hinges[h]
        for k in range(4):
            corners[k] = x[points[k]]
            w[k] = cloth.network.inv_mass[points[k]]
        C, gradients = fold_constraint(corners, cloth.fold[h])
        corrections = constraint_correction(cloth.stiffness * C, gradients, w)
        for k in range(4):
            x[points[k]] += corrections[k]
    return x


def cloth_step(acceleration, t, x, v, dt, cloth):
    """Given.  Advance a cloth by one step: pbd_step with folds that resist bending, a ball and a floor."""
    new = predict(acceleration, t, x, v, dt, cloth.network)
    for _ in range(cloth.network.sweeps):
        new = distance_sweep(new, cloth.network)
        new = fold_sweep(new, cloth)
        new = keep_outside(ball_gap, new, cloth.network.inv_mass, cloth.obstacle)
        new = keep_outside(floor_gap, new, cloth.network.inv_mass, cloth.obstacle)
    return new, (new - x) / dt


def pivoted_body_step(t, x, q, v, omega, dt, body):
    """Given.  Advance a PivotedBody body by one step: (x, q, v, ω); first order.

    Its pivot is one constraint, C = |x + r − pivot|.
    """
    new = x + dt * v + dt * dt * body.gravity
    omega_pred = omega + dt * angular_acceleration(q, omega, np.zeros(3), body.I_body)
    turned = quaternion_update(q, omega_pred, dt)
    for _ in range(body.sweeps):
        r = rotate(turned, body.arm_body)
        gap = new + r - body.pivot
        C = np.sqrt(np.sum(gap * gap))
        if C > 0.0:
            w = effective_inverse_mass_at(turned, r, gap / C, body.m, body.I_body)
            new, turned = apply_positional_impulse(new, turned, r, -gap / w, body.m, body.I_body)
    return new, turned, (new - x) / dt, turning_rate(q, turned, dt)


def balloon_step(acceleration, t, x, v, dt, balloon):
    """Given.  Advance a closed network above a floor by one step: xpbd_step with the volume as one more constraint.

    Each sweep visits the links first, then the air, then the floor.
    """
    network = balloon.network
    new, Lam, air = predict(acceleration, t, x, v, dt, network), np.zeros(network.i.size), 0.0
    for _ in range(balloon.network.sweeps):
        new, Lam = compliant_sweep(new, Lam, dt, network)
        V, gradient = volume_gradient(new, balloon.faces)
        weight = 0.0
        for k in range(x.shape[0]):
            weight += network.inv_mass[k] * dot(gradient[k], gradient[k])
        change = compliant_multiplier(V - balloon.volume, air, weight, balloon.alpha / (dt * dt))
        air += change
        for k in range(x.shape[0]):
            new[k] += change * network.inv_mass[k] * gradient[k]
        new = keep_outside(floor_gap, new, network.inv_mass, balloon.obstacle)
    return new, (new - x) / dt


def make_constraint_network(x, m, fixed, pairs, alpha, stiffness, gravity, sweeps):
    """Given.  Make a ConstraintNetwork whose links have their lengths at x as rest lengths.

    x (n, d); m [kg], alpha [m/N] and stiffness [-] are numbers or one each; fixed lists point numbers; pairs (s, 2);
    gravity (d,).
    Raises BadInput for a mass that is not positive, a state that is not finite, a link of zero length or between two
    immovable points, a negative compliance, a stiffness outside 0 … 1 or equal to 0, fewer than one sweep, a point
    number out of range, gravity of another dimension than x.
    """
    x = finite_array("a position of the network [m]", x)
    gravity = finite_array("gravity [m/s²]", gravity)
    inv_mass = inverse_masses("a mass of the network [kg]", m, fixed, x)
    check_shape("gravity", gravity, x.shape[1:])
    i, j, rest = measured_links("link", x, pairs)
    alphas = one_each("compliance α [m/N]", alpha, len(i))
    shares = one_each("stiffness of a link [-]", stiffness, len(i))
    for s in range(len(i)):
        link = f"link {s} from point {i[s]} to {j[s]}"
        if rest[s] == 0.0:
            raise BadInput(f"the length of {link} [m]", 0.0, "move its ends apart")
        if inv_mass[i[s]] + inv_mass[j[s]] == 0.0:
            raise BadInput(f"the inverse mass at {link} [1/kg]", 0.0, "leave out links between immovable points")
        if not 0.0 < shares[s] <= 1.0:
            raise BadInput(f"the stiffness of link {s} [-]", shares[s], "give a number above 0, up to 1")
    sweeps = whole_number("sweeps in a step", sweeps, 1)
    network = ConstraintNetwork(inv_mass, gravity, i, j, rest, shares, alphas, sweeps)
    check_record(network, x)
    return network
