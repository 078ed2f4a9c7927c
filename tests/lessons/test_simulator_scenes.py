"""Scenes without a formula, by the worked answers: dominoes, and a machine of many kinds of parts.

They are judged by what must hold for any motion: energy never grows without a source, bodies do not sink into each
other, and shorter steps change less and less.
"""

import itertools

import numpy as np
import pytest

from solutions.springs import spring_tension
from validate.modules import bind

simulator = bind("simulator")

G = 9.81                     # [m/s²]
FLOOR = (0.0, 1.0, 0.0)


def dominoes(n, dt, seconds, sweeps=20):
    """(times at which each leans by 0.2 rad, energies, largest overlap) of n dominoes of 8 × 40 cm, 20 cm apart."""
    w, h = 0.04, 0.2
    state, p = simulator.make_bodies_2d(np.stack((0.2 * np.arange(n), np.full(n, h)), axis=1), np.zeros(n), 1.0,
                                        (w * w + h * h) / 3.0, np.full((n, 2), (w, h)), [FLOOR], (0.0, -G), 0.4, sweeps,
                                        0.02)
    v, omega, push = state.v.copy(), state.omega.copy(), -2.0
    v[0], omega[0] = push * np.array([-h, -w]), push
    state, times, energies, deepest = state._replace(v=v, omega=omega), np.full(n, np.inf), [], 0.0
    for k in range(round(seconds / dt)):
        before = state.q[:n]
        state = simulator.contact_step_2d(simulator.weight, simulator.box_bounds_2d, simulator.box_contacts_2d, k * dt,
                                          state, dt, p)
        for i in np.flatnonzero((before > -0.2) & (state.q[:n] <= -0.2)):
            times[i] = (k + (before[i] + 0.2) / (before[i] - state.q[i])) * dt
        energies.append(simulator.mechanical_energy_2d(state.x, state.v, state.omega, p))
        deepest = max(deepest, simulator.largest_overlap(state.contacts))
    return times, np.array(energies), deepest


@pytest.mark.long
def test_dominoes_converge_and_only_lose_energy():
    """First order: halving the step halves what it changes, and also what energy gains and how deep corners are."""
    runs = [dominoes(5, dt, 1.3) for dt in (1.0 / 120.0, 1.0 / 240.0, 1.0 / 480.0)]
    for _, energies, deepest in runs:
        assert simulator.gain_without_source(energies, np.zeros(energies.size)) < 1e-4 * energies[0]
        assert deepest < 0.007
    changes = [np.max(np.abs(a[0] - b[0])) for a, b in itertools.pairwise(runs)]
    assert changes[0] < 0.03 and changes[1] < 0.75 * changes[0]
    assert runs[2][2] < 0.6 * runs[0][2]


# ---------------------------------------------------------------------------------------------- a machine

SPRING, REST, DAMPER = 20.0, 0.5, 0.5           # of the hammer [N/m], [m], [N s/m]
ANCHOR = np.array([-2.9, 0.3])                  # [m]
DRAG = 0.3                                      # of everything that moves [N s/m]
HAMMER, CRANK, RAMP, FIRST, CRATE = 0, 1, 2, 3, 8             # numbers of bodies
HALF = np.array([(0.15, 0.1), (0.25, 0.03), (0.5, 0.03), *[(0.03, 0.2)] * 5, (0.1, 0.1), (0.1, 0.1), (0.08, 0.08)])
PLACES = np.array([(-2.2, 0.1), (2.6, 0.5), (1.6, 0.35), *[(-1.5 + 0.2 * k, 0.2) for k in range(5)], (0.3, 0.1),
                   (0.3, 0.3), (1.3, 0.75)])
ANGLES = np.array([0.0, 0.0, -0.35, *[0.0] * 5, 0.0, 0.0, -0.35])


def machine_load(t, x, q, v, omega, p):
    """Weight, air, and a spring that pulls the hammer."""
    F, tau = simulator.weight(t, x, q, v, omega, p)
    moves = (p.inv_mass > 0.0)[:, None]
    F = F - DRAG * v * moves
    r = ANCHOR - x[HAMMER]
    length = np.sqrt(r @ r)
    F[HAMMER] += spring_tension(length, -(r @ v[HAMMER]) / length, REST, SPRING, DAMPER) * r / length
    return F, tau


def machine(sweeps=20):
    """(PileState, Bodies): a hammer on a spring, five dominoes, a stack of crates, a ramp with a block, a crank that
    turns, and a floor that is a conveyor belt.
    """
    m = np.array([2.0, np.inf, np.inf, *[0.5] * 5, 1.0, 1.0, 0.5])
    inertia = m * np.sum(HALF**2, axis=1) / 3.0
    state, p = simulator.make_bodies_2d(PLACES, ANGLES, m, inertia, HALF, [FLOOR], (0.0, -G), 0.4, sweeps, 0.02)
    v, omega = state.v.copy(), state.omega.copy()
    v[HAMMER], omega[CRANK], v[-1] = (4.0, 0.0), 1.0, (0.1, 0.0)
    return state._replace(v=v, omega=omega), p


def work_of_supports(state, p):
    """Work [J] that rows without inverse mass did in the last step: impulse on what moves times velocity there."""
    work, c = 0.0, state.contacts
    for a, b, place, J in zip(c.a, c.b, c.p, state.J):
        for body, sign in ((a, -1.0), (b, 1.0)):
            if p.inv_mass[body] == 0.0:
                # the support has moved since; a turning one does so about its centre, which stays
                r = place - state.x[body]
                work += sign * J @ (state.v[body] + state.omega[body] * np.array([-r[1], r[0]]))
    return work


@pytest.mark.long
def test_a_machine_runs_for_ten_seconds_and_gains_nothing_without_a_source():
    (state, p), dt = machine(), 1.0 / 120.0
    energies, work, done, deepest = [], [], 0.0, 0.0
    for k in range(round(10.0 / dt)):
        state = simulator.contact_step_2d(machine_load, simulator.box_bounds_2d, simulator.box_contacts_2d, k * dt,
                                          state, dt, p)
        stretch = np.linalg.norm(state.x[HAMMER] - ANCHOR) - REST
        done += work_of_supports(state, p)
        work.append(done)
        energies.append(simulator.mechanical_energy_2d(state.x, state.v, state.omega, p) + 0.5 * SPRING * stretch**2)
        deepest = max(deepest, simulator.largest_overlap(state.contacts))
    energies, work = np.array(energies), np.array(work)
    fallen = np.count_nonzero(np.abs(state.q[FIRST:FIRST + 5]) > 0.5)
    blind = simulator.gain_without_source(energies, np.zeros(energies.size))
    print(f"gain {simulator.gain_without_source(energies, work):.3f} J of {energies[0]:.1f} J, work {done:.2f} J, "
          f"{blind:.2f} J if no work is counted, overlap {1e3 * deepest:.1f} mm, {fallen} dominoes have fallen")
    assert np.all(np.isfinite(state.x)) and np.max(np.abs(state.v)) < 5.0
    # the spring's energy swings by ½ ω dt of itself in a step of symplectic Euler: ω = 3.2/s, 9 J
    assert simulator.gain_without_source(energies, work) < 0.02 * 9.0 < blind
    assert deepest < 0.02
    assert fallen >= 3
