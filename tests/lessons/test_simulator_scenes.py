"""Scenes without a formula, by the worked answers: dominoes, a machine of many kinds of parts, and a card house.

They are judged by what must hold for any motion: energy never grows without a source, bodies do not sink into each
other, and shorter steps change less and less.
"""

import itertools

import numpy as np
import pytest

from validate.scenes.simulator import card_house, machine
from validate.subject.modules import PLAIN, bind

simulator, LESSONS = bind("simulator"), PLAIN.lessons

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
        energies.append(simulator.mechanical_energy_2d(state.x, state.q, state.v, state.omega, p))
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

@pytest.mark.long
def test_a_machine_runs_for_ten_seconds_and_gains_nothing_without_a_source():
    """The scene's own run, its bounds, and what a belt and a crank would gain if their work were not counted."""
    p, steps = machine.CASES["energy"], 1200
    state, load, energies = machine.start(p), machine.acceleration(LESSONS), []
    for _ in range(steps // 10):
        state = machine.run(LESSONS, simulator.contact_step_2d, load, state, p, machine.T / steps, 10)
        energies.append(machine.energy(state.now, state.rows))
    for kind in ("energy", "overlap", "residual"):
        seen = machine.CASES[kind]
        assert machine.observe(state, seen)[0] < machine.limit(seen, machine.T / steps), kind
    blind = simulator.gain_without_source(np.array(energies), np.zeros(len(energies)))
    assert blind > 2.0 * machine.limit(p, machine.T / steps) * machine.first_energy(p)
    assert np.max(np.abs(state.now.v)) < 5.0
    first = machine.FIRST
    assert np.count_nonzero(np.abs(state.now.q[first:first + machine.DOMINOES]) > 0.5) >= 3


@pytest.mark.long
def test_a_house_of_cards_stands_from_the_friction_on_that_statics_asks_for():
    steps = 240
    for rough, stands in ((0.98, False), (1.02, True)):
        p = card_house.Params(rough=rough)
        state = card_house.run(LESSONS, simulator.contact_step_2d, simulator.weight, card_house.start(p), p,
                               1.0 / steps, steps)
        moved = np.linalg.norm(card_house.observe(state, p) - card_house.truth(p, 0.0))
        limit = card_house.limit(p._replace(rough=1.02), 1.0 / steps)
        assert (moved < limit * np.linalg.norm(card_house.truth(p, 0.0))) == stands, (rough, moved, limit)
