"""What judges a run in the plane: work against closed forms, momenta against those of space, overlap and its bound."""

import numpy as np
import pytest

from solutions.checks import Diverged
from validate.subject.modules import bind

simulator = bind("simulator")

G = 9.81                     # [m/s²]
FLOOR = (0.0, 1.0, 0.0)


def ran(state, p, dt, steps, shape):
    """All states of so many steps."""
    states = [state]
    for k in range(steps):
        states.append(simulator.contact_step_2d(simulator.weight, *shape, k * dt, states[-1], dt, p))
    return states


DISCS = simulator.disc_bounds, simulator.round_contacts
BOXES = simulator.box_bounds_2d, simulator.box_contacts_2d


def worked_on(states, dt, p):
    return sum(simulator.work_of_driven_rows(state, dt, p) for state in states[1:])


def disc_on_floor(v, m=2.0, r=0.3):
    """A disc at rest on a floor that has a velocity."""
    state, p = simulator.make_bodies_2d([(0.0, r)], [0.0], m, 0.5 * m * r * r, [(r, r)], [FLOOR], (0.0, -G), 0.4, 10,
                                        0.02)
    return state._replace(v=np.array([(0.0, 0.0), v])), p


def test_a_belt_works_by_its_speed_times_the_momentum_that_it_gives():
    """The disc ends with belt/3, so the belt has given m belt/3 and worked m belt²/3; half of it is heat."""
    state, p = disc_on_floor((1.5, 0.0))
    states = ran(state, p, 0.01, 40, DISCS)
    end = states[-1]
    before, after = (simulator.mechanical_energy_2d(s.x, s.q, s.v, s.omega, p) for s in (state, end))
    assert worked_on(states, 0.01, p) == pytest.approx(2.0 * 1.5**2 / 3.0, abs=1e-10)
    assert after - before == pytest.approx(2.0 * 1.5**2 / 6.0, abs=1e-10)


def test_a_lift_gives_speed_and_height():
    """m v² for the speed, which is twice its energy, and m g for each metre.  The lift is a box: planes do not rise."""
    state, p = simulator.make_bodies_2d([(0.0, 0.0), (0.0, 0.3)], [0.0, 0.0], [np.inf, 2.0], [np.inf, 0.1],
                                        [(0.5, 0.1), (0.2, 0.2)], np.zeros((0, 3)), (0.0, -G), 0.4, 100, 0.02)
    states = ran(state._replace(v=np.array([(0.0, 0.5), (0.0, 0.0)])), p, 0.01, 50, BOXES)
    assert worked_on(states, 0.01, p) == pytest.approx(2.0 * (0.5**2 + G * 0.25), abs=1e-9)


def test_a_crank_works_by_its_torque_times_its_angle():
    """A wheel that turns evenly rubs a disc that gravity presses on it: μ m g dt along its rim."""
    m, I, r = 1.5, 0.06, 0.25
    state, p = simulator.make_bodies_2d([(0.0, 0.0), (2.0 * r, 0.0)], [0.0, 0.0], [np.inf, m], [np.inf, I],
                                        np.full((2, 2), r), np.zeros((0, 3)), (-G, -0.0), 0.3, 10, 0.02)
    state = state._replace(omega=np.array([2.0, 0.0]))
    states = ran(state, p, 1e-3, 1, DISCS)
    J_t = 0.3 * m * G * 1e-3                                             # it slips: friction is at its limit
    assert worked_on(states, 1e-3, p) == pytest.approx(J_t * 2.0 * r, rel=1e-9)


def test_momenta_in_the_plane_are_those_of_the_same_bodies_in_space():
    rng = np.random.default_rng(1)
    x, v, omega, m, I = rng.normal(size=(3, 2)), rng.normal(size=(3, 2)), rng.normal(size=3), [1.0, 2.0, 3.0], 0.4
    _, flat = simulator.make_bodies_2d(x, np.zeros(3), m, I, np.full((3, 2), 0.1), np.zeros((0, 3)), (0.0, -G), 0.3, 1,
                                       0.02)
    still = np.tile([1.0, 0.0, 0.0, 0.0], (3, 1))
    _, deep = simulator.make_bodies(np.pad(x, ((0, 0), (0, 1))), still, m, np.full((3, 3), I), np.full((3, 3), 0.1),
                                    np.zeros((0, 4)), (0.0, -G, 0.0), 0.3, 1, 0.02)
    spin = np.pad(omega[:, None], ((0, 0), (2, 0)))
    space = np.pad(x, ((0, 0), (0, 1))), still, np.pad(v, ((0, 0), (0, 1))), spin, deep
    P, L = simulator.momenta_2d(x, np.zeros(3), v, omega, flat)
    P_space, L_space = simulator.momenta(*space)
    assert np.allclose(np.append(P, L), [*P_space[:2], L_space[2]], rtol=0.0, atol=1e-12)
    energy = simulator.mechanical_energy_2d(x, np.zeros(3), v, omega, flat)
    assert energy == pytest.approx(simulator.mechanical_energy(*space), abs=1e-12)


@pytest.mark.parametrize("sweeps", [2, 10])
def test_boxes_that_turn_overlap_by_less_than_the_bound(sweeps):
    """Four dominoes; also with so few sweeps that what they leave over counts.  Without the turning part it fails."""
    w, h = 0.04, 0.2
    x = np.stack((0.2 * np.arange(4), np.full(4, h)), axis=1)
    state, p = simulator.make_bodies_2d(x, np.zeros(4), 1.0, (w * w + h * h) / 3.0, np.full((4, 2), (w, h)), [FLOOR],
                                        (0.0, -G), 0.4, sweeps, 0.02)
    v, omega = state.v.copy(), state.omega.copy()
    v[0], omega[0] = 2.0 * np.array([h, w]), -2.0
    state, found = state._replace(v=v, omega=omega), []
    for dt in (1.0 / 60.0, 1.0 / 120.0):
        states = ran(state, p, dt, round(1.2 / dt), BOXES)
        deep = max(simulator.largest_overlap(one.contacts) for one in states)
        found.append((deep, simulator.overlap_bound_2d(states, dt, p)))
        assert 1e-3 < deep < found[-1][1] < 15.0 * deep
    assert found[1][1] < 0.7 * found[0][1]


def test_what_overlaps_at_the_beginning_is_in_the_bound():
    state, p = simulator.make_bodies_2d([(0.0, 0.15)], [0.0], 1.0, 0.01, [(0.2, 0.2)], [FLOOR], (0.0, -G), 0.4, 10,
                                        0.02)
    bound = simulator.overlap_bound_2d(ran(state, p, 0.01, 5, BOXES), 0.01, p)
    assert bound == pytest.approx(0.05, abs=1e-4)                        # and what ten sweeps leave over


def test_bodies_that_sink_are_named_with_time_and_sweeps():
    m = np.array([1.0, 1.0, 1e7])
    x = [(0.0, 0.5), (0.0, 1.5), (0.0, 2.5)]
    state, p = simulator.make_bodies_2d(x, np.zeros(3), m, m / 6.0, np.full((3, 2), 0.5), [FLOOR], (0.0, -G), 0.5, 2,
                                        0.02)
    with pytest.raises(Diverged, match=r"of body 0 and body 1 at t = 5\.25 s, with 2 sweeps per step = 0\.3"):
        simulator.advance_contact(simulator.contact_step_2d, simulator.weight, *BOXES, 5.0, state, 0.01, 400, p)
