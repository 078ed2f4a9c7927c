"""Bodies that begin inside each other: lesson 9 parts them gently, lesson 10 lets them be; neither throws them out."""

import itertools

import numpy as np
import pytest

from solutions.checks import Diverged
from solutions.given.contact import SEPARATION
from solutions.support.scenes import DEEPER
from validate.subject.modules import bind

contact, simulator = bind("contact"), bind("simulator")

G = 9.81                     # [m/s²]
DT = 1.0 / 240.0             # [s]
STEPS = 48
PARTING = 144                # steps after which bodies have begun to part, in any order of the visits
SHAPES = {
    ("round", 2): (contact.disc_bounds, contact.round_contacts),
    ("boxes", 2): (contact.box_bounds_2d, contact.box_contacts_2d),
    ("round", 3): (contact.ball_bounds, contact.round_contacts),
    ("boxes", 3): (contact.box_bounds, contact.box_contacts),
}


def swarm(shape, d, seed):
    """(x, q, half) of five bodies strewn over a metre, some in the ground below 0 and two with the same centre."""
    rng = np.random.default_rng(seed)
    x, half = rng.uniform(-0.5, 0.5, (5, d)), rng.uniform(0.3, 0.6, (5, d))
    x[1] = x[0]
    q = rng.uniform(-3.0, 3.0, 5) if d == 2 else rng.normal(size=(5, 4))
    if d == 3:
        q /= np.linalg.norm(q, axis=1, keepdims=True)
    if shape == "round":
        half[:] = half[:, :1]
    return x, q, half


def put_down(make, shape, d, seed, *settings):
    """What make returns for a swarm of bodies of 1 kg on the ground."""
    x, q, half = swarm(shape, d, seed)
    up = np.eye(d)[-1]
    return make(x, q, 1.0, 0.1 if d == 2 else np.full((5, 3), 0.1), half, [(*up, 0.0)], -G * up, 0.5, *settings)


def deepest(state):
    return max(0.0, -np.min(state.contacts.gap, initial=0.0))


CASES = pytest.mark.parametrize(("shape", "d", "seed"), [
    pytest.param(*key, seed, marks=[pytest.mark.long] if seed or key == ("boxes", 3) else []) for key, seed in
    itertools.product(SHAPES, range(3))])


@CASES
def test_a_pile_parts_its_bodies_by_so_much_per_second_and_throws_none_out(shape, d, seed):
    """Between the ground and a body are five contacts at most, each of which parts by its largest speed and no more.

    What pushes bodies apart is taken back at the end of each substep: the speeds that stay are those of a fall from
    where the push has left a body.  So nothing leaves the height of five bodies on each other.
    """
    make, advance = ((contact.make_pile_2d, contact.advance_pile_2d) if d == 2 else
                     (contact.make_pile, contact.advance_pile))
    state, pile = put_down(make, shape, d, seed, 4, 60.0, 10.0, 0.01)
    highest, begin, deep = np.sum(2.0 * np.linalg.norm(pile.half, axis=1)), state.x, []
    for k in range(PARTING):
        state = advance(*SHAPES[shape, d], state, DT, 1, pile)
        deep.append(deepest(state))
        fastest = 5.0 * SEPARATION * pile.hertz * np.max(pile.half) + G * (k + 1) * DT
        assert np.max(np.linalg.norm(state.v, axis=1)) < fastest
        assert np.max(np.linalg.norm(state.x - begin, axis=1)) < fastest * (k + 1) * DT
        assert np.max(state.x[:5, -1]) < highest
    assert deep[0] > 0.25 and deep[-1] < 0.9 * deep[0] and max(deep) < DEEPER * deep[0]


@CASES
def test_the_loop_of_lesson_10_lets_them_be_and_gains_no_energy(shape, d, seed):
    """A push apart by a tenth of a body in a sixtieth of a second, 3 m/s, would give it 4.5 J.  What sweeps leave over
    is a millionth of that at most.
    """
    make, step, energy = ((simulator.make_bodies_2d, simulator.contact_step_2d, simulator.mechanical_energy_2d)
                          if d == 2 else (simulator.make_bodies, simulator.contact_step, simulator.mechanical_energy))
    state, p = put_down(make, shape, d, seed, 40, 0.01)
    energies, deep = [energy(state.x, state.q, state.v, state.omega, p)], []
    for k in range(STEPS):
        state = simulator.advance_contact(step, simulator.weight, *SHAPES[shape, d], k * DT, state, DT, 1, p)
        energies.append(energy(state.x, state.q, state.v, state.omega, p))
        deep.append(deepest(state))
    assert simulator.gain_without_source(energies, np.zeros(STEPS + 1)) < 4.5e-6
    assert deep[0] > 0.25 and deep[-1] > 0.9 * deep[0] and max(deep) < 1.001 * deep[0]


def test_joints_leave_what_overlaps_as_it_is_too():
    """Two boxes, one half in the other, hang on their own joints: nothing moves but by what sweeps leave over."""
    x = np.array([(0.0, 0.0), (0.2, 0.1)])
    state, p = simulator.make_bodies_2d(x, np.zeros(2), 1.0, 0.03, np.full((2, 2), 0.2), [(0.0, 1.0, 5.0)], (0.0, -G),
                                        0.5, 40, 0.01)
    p = simulator.make_joints(state, p, [0, 1], [2, 2], x + np.array([0.0, 0.2]), 0.0)
    for k in range(STEPS):
        state = simulator.joint_contact_step_2d(simulator.weight, *SHAPES["boxes", 2], k * DT, state, DT, p)
    assert state.contacts.a.size == 2 and deepest(state) > 0.19
    assert np.max(np.abs(state.x[:2] - x)) < 1e-6 and np.max(np.abs(state.v)) < 1e-6


def test_an_overlap_that_grows_ends_in_an_error_that_says_so():
    """A heavy box that begins a quarter inside a light one sinks on: one sweep does not hold it."""
    x, m = [(0.0, 0.5), (0.0, 1.25)], np.array([1.0, 1e7])
    half, floor = np.full((2, 2), 0.5), [(0.0, 1.0, 0.0)]
    state, pile = contact.make_pile_2d(x, np.zeros(2), m, m / 6.0, half, floor, (0.0, -G), 0.5, 1, 60.0, 10.0, 0.02)
    with pytest.raises(Diverged, match="sink into each other"):
        contact.advance_pile_2d(*SHAPES["boxes", 2], state, DT, 960, pile)
    state, p = simulator.make_bodies_2d(x, np.zeros(2), m, m / 6.0, half, floor, (0.0, -G), 0.5, 1, 0.02)
    with pytest.raises(Diverged, match="overlap"):
        simulator.advance_contact(simulator.contact_step_2d, simulator.weight, *SHAPES["boxes", 2], 0.0, state, DT,
                                  960, p)


def test_what_overlaps_at_the_beginning_is_allowed_however_fast_another_body_is():
    """The third one falls on the ground meanwhile."""
    x = [(0.0, 0.0), (0.02, 0.0), (5.0, -8.5)]
    state, pile = contact.make_pile_2d(x, np.zeros(3), 1.0, 0.005, np.full((3, 2), 0.1), [(0.0, 1.0, 9.0)], (0.0, 0.0),
                                       0.3, 2, 60.0, 5.0, 0.01)
    v = state.v.copy()
    v[2] = 0.0, -10.0
    state, slower = state._replace(v=v), []
    for _ in range(2):                                                   # the second run goes on from the first one
        state = contact.advance_pile_2d(*SHAPES["round", 2], state, DT, 20, pile)
        slower.append(state.x[1, 0] - state.x[0, 0])
    assert 0.02 < slower[0] < slower[1] and abs(state.v[2, 1]) < 1.0


@pytest.mark.parametrize("at_once", [True, False])
def test_bodies_that_sink_into_each_other_are_named_in_one_call_and_in_single_steps(at_once):
    """A hundred tonnes on a kilogram."""
    state, pile = contact.make_pile_2d([(0.0, 0.1), (0.0, 0.2999)], np.zeros(2), np.array([1.0, 1e5]),
                                       np.array([0.005, 500.0]), np.full((2, 2), 0.1), [(0.0, 1.0, 0.0)], (0.0, -G),
                                       0.3, 2, 60.0, 5.0, 0.008)

    def run(state):
        for _ in range(1 if at_once else 480):
            state = contact.advance_pile_2d(*SHAPES["round", 2], state, DT, 480 if at_once else 1, pile)
    with pytest.raises(Diverged, match="more equal masses"):
        run(state)
