"""Given with lesson 10.  How to judge a run of bodies in the plane: energy, momenta, work, overlap.

In the plane neither the energy of motion and weight nor the momenta depend on the angles q.
"""

import numpy as np

from ..checks import check_shape, finite_array
from ..contact import velocity_sweep_2d
from ..support.arms import arms_2d


def closing_speeds(gap, dt):
    """Given.  Return the u_n (m,) [m/s] below which no contact may come: −gap/dt closes the gap; 0 if it is closed.

    *Left out:* parting bodies that overlap.  A push would gain energy, and kept_impulses would take it for a load;
    the soft contacts of lesson 9 do it better.
    """
    return np.minimum(-gap / dt, 0.0)


def sweep_residual_2d(state, dt, p):
    """Given.  Return how far [m/s] the last step in the plane is from the laws: what one more sweep changes."""
    x, _, v, omega, contacts, J = state
    arms, aim = arms_2d(x - dt * v, p.inv_mass, p.inv_inertia, contacts), closing_speeds(contacts.gap, dt)
    _, _, better = velocity_sweep_2d(v, omega, J, aim, 0.0 * aim, contacts, arms, p)
    return np.max(np.append(0.0, np.abs(better - J) * np.stack((arms.k_n, arms.k_n), axis=1)))


def mechanical_energy_2d(x, q, v, omega, p):
    """Given.  Return the energy [J] of all bodies in the plane that can move: Σ ½ m v² + ½ I ω² − m g · x.

    What cannot turn has no energy of rotation.  The arguments are those of mechanical_energy.
    """
    energy = 0.0
    for i in range(x.shape[0]):
        if p.inv_mass[i] > 0.0:
            energy += (0.5 * (v[i] @ v[i]) - p.gravity @ x[i]) / p.inv_mass[i]
        if p.inv_inertia[i] > 0.0:
            energy += 0.5 * omega[i] ** 2 / p.inv_inertia[i]
    return energy


def momenta_2d(x, q, v, omega, p):
    """Given.  Return momentum P [kg m/s] (2,) and angular momentum L [kg m²/s] about the origin, of all that can move.

    P = Σ m v,      L = Σ m (x_x v_y − x_y v_x) + I ω
    """
    P, L = np.zeros(2), 0.0
    for i in range(x.shape[0]):
        if p.inv_mass[i] > 0.0:
            P += v[i] / p.inv_mass[i]
            L += (x[i, 0] * v[i, 1] - x[i, 1] * v[i, 0]) / p.inv_mass[i]
        if p.inv_inertia[i] > 0.0:
            L += omega[i] / p.inv_inertia[i]
    return P, L


def work_of_driven_rows(state, dt, p):
    """Given.  Return the work [J] that rows with inv_mass 0 have done in the last step on all that can move.

    W = Σ J · u_s,      J the impulse on the body that can move, u_s = v + ω × r the velocity of the driven row there

    A floor at rest does none; a conveyor belt, a lift and a crank do.  Give its sum over the steps so far to
    gain_without_source.
    *Source:* power is force times velocity of the place at which it acts.
    """
    work, c = 0.0, state.contacts
    for k in range(c.a.size):
        for s, sign in ((c.a[k], -1.0), (c.b[k], 1.0)):
            if p.inv_mass[s] == 0.0:
                r_x = c.p[k, 0] - state.x[s, 0] + dt * state.v[s, 0]     # from where it was when the contact was found
                r_y = c.p[k, 1] - state.x[s, 1] + dt * state.v[s, 1]
                u_x, u_y = state.v[s, 0] - state.omega[s] * r_y, state.v[s, 1] + state.omega[s] * r_x
                work += sign * (state.J[k, 0] * u_x + state.J[k, 1] * u_y)
    return work


def checked_histories(energies, work):
    """Given.  Return energies and work [J] as two arrays (k,), from lists or arrays of numbers.

    Raises BadInput for what is not finite numbers, and for histories of different lengths.
    """
    energies, work = finite_array("an energy [J]", energies), finite_array("a work [J]", work)
    check_shape("the energies [J]", energies, (energies.size,))
    check_shape("the work [J], one number for each energy,", work, energies.shape)
    return energies, work


def overlap_bound_2d(states, dt, p):
    """Given.  Return how deep [m] any two bodies of a run in the plane may be in each other.

    A contact stops approach along its normal at the beginning of a step.  Within the step both bodies turn, and the
    place slides on a face that turns.  So the gap falls short of what was asked for by at most
        dt (aim − u_n)  +  ½ dt² (ω_a² |r_a| + ω_b² |r_b| + 2 (|ω_a| + |ω_b|) |u_t|)
    of which the first part is what the sweeps have left over.  Nothing parts them again: the bound is the sum over the
    steps, for the pair where it is largest, plus the overlap at the beginning.  All but the first part halves with dt.
    It holds as long as nothing approaches by more than p.margin in a step.
    *Source:* second-order terms of n · (p_a − p_b) where a and b are displaced and turned.
    """
    sums = {}
    for state in states[1:]:
        c, v, w = state.contacts, state.v, state.omega
        arms, aim = arms_2d(state.x - dt * v, p.inv_mass, p.inv_inertia, c), closing_speeds(c.gap, dt)
        added = {}
        for k in range(c.a.size):
            a, b, r_a, r_b, n = c.a[k], c.b[k], arms.r_a[k], arms.r_b[k], c.n[k]
            u = v[a] + w[a] * np.array([-r_a[1], r_a[0]]) - v[b] - w[b] * np.array([-r_b[1], r_b[0]])
            slip = abs(n[0] * u[1] - n[1] * u[0])
            bent = w[a] ** 2 * np.hypot(r_a[0], r_a[1]) + w[b] ** 2 * np.hypot(r_b[0], r_b[1])
            more = dt * max(0.0, aim[k] - n @ u) + 0.5 * dt * dt * (bent + 2.0 * (abs(w[a]) + abs(w[b])) * slip)
            pair = int(a), int(b)
            added[pair] = max(added.get(pair, 0.0), more)
            sums.setdefault(pair, max(0.0, -c.gap[k]))
        for pair, more in added.items():
            sums[pair] += more
    return max(sums.values(), default=0.0)
