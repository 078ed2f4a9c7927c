"""A wrong function of lesson 10 does not find the speeds, growths and impacts that theory gives the right one."""

import types

import numpy as np
import pytest

from solutions import simulator as worked
from solutions.given import simulator as given
from solutions.given.compose import compose
from validate.stability.examine import cases_of, found_by, subject_of

from ..mutants.simulator import MUTANTS
from .sampled import wrong_functions


def waits(load, bounds, narrow, t, state, dt, p):
    """Finds a contact when it overlaps, and not before."""
    return worked.contact_step_2d(load, bounds, narrow, t, state, dt, p._replace(margin=1e-9))


def pushes(load, bounds, narrow, t, state, dt, p):
    """Puts what overlaps back on the surface."""
    end = worked.contact_step_2d(load, bounds, narrow, t, state, dt, p)
    x = end.x.copy()
    x[0, 1] = max(x[0, 1], p.half[0, 1])
    return end._replace(x=x)


def floor_ahead(load, bounds, narrow, t, state, dt, p):
    """Takes the floor where the ball will be."""
    v = state.v.copy()
    v[1] = np.cross(state.omega[1], dt * state.v[0])
    end = worked.contact_step(load, bounds, narrow, t, state._replace(v=v), dt, p)
    return end._replace(v=np.stack((end.v[0], np.zeros(3))))


def floor_behind(load, t, x, q, v, omega, dt, ball):
    """Takes the floor where the ball was."""
    return worked.carried_step(load, t, x, q, v, omega, dt, ball._replace(centre=ball.centre + dt * v))


def elastic(step, t, x, v, dt, block):
    """Loses nothing at a corner."""
    heavier = block._replace(inertia=1e3 * block.inertia, m=1e3 * block.m, half_width=1e-3 * block.half_width)
    new = step(worked.rocking_acceleration, t, x, v, dt, block)
    return new if x[0] * new[0][0] > 0.0 or x[0] == 0.0 else worked.rocking_step(step, t, x, v, dt, heavier)


def unchecked(x, q, m, inertia, half, planes, gravity, mu, sweeps, margin):
    """Makes bodies of anything."""
    state, p = worked.make_bodies_2d([(0.0, 0.5)], [0.0], 1.0, 0.1, [(0.5, 0.5)], [(0.0, 1.0, 0.0)], (0.0, -9.81), 0.3,
                                     1, 0.02)
    return state, p._replace(mu=mu, sweeps=sweeps, margin=margin)


def holds_on(states, a, b, dt):
    """Reads the impulses of the step before."""
    forces = worked.normal_forces(states, a, b, dt)
    return np.append(forces[:1], forces[:-1])


def lets_pass(step, load, bounds, narrow, t, state, dt, steps, p):
    """Checks nothing between its steps."""
    for n in range(steps):
        state = step(load, bounds, narrow, t + n * dt, state, dt, p)
    return state


def forgets_the_spin(load, t, x, q, v, omega, p):
    """Leaves out what holds a body on its circle."""
    return worked.joint_forces_2d(load, t, x, q, v, 0.0 * omega, p)


def rocks(load, t, x, q, v, omega, p):
    """Another of the possible forces: two legs bear more, and two less."""
    return worked.joint_forces(load, t, x, q, v, omega, p) + np.outer([1.0, -1.0, 1.0, -1.0], [0.0, 0.0, 1.0])


def both_feet_alike(state, dt):
    """The sum is right."""
    N, T = worked.normal_and_friction(state, dt)
    return 0.0 * N + np.mean(N), T


WRONG = [                    # case, the function that it examines, what is put in its place
    ("margin-and-speed", "contact_step_2d", waits),
    ("margin-and-speed", "contact_step_2d", pushes),
    ("growth-on-a-turntable", "contact_step", floor_ahead),
    ("growth-on-a-turntable", "carried_step", floor_behind),
    ("rocking-to-the-end", "rocking_step", elastic),
    ("rocking-to-the-end", "make_bodies_2d", unchecked),
    ("release-from-a-support", "contact_step_2d", given.mean_contact_step_2d),
    ("release-from-a-support", "normal_forces", holds_on),
    ("turns-through-a-wall", "contact_step_2d", waits),
    ("turns-through-a-wall", "advance_contact", lets_pass),
    ("forces-of-supports", "joint_forces_2d", forgets_the_spin),
    ("forces-of-supports", "joint_forces", rocks),
    ("forces-of-supports", "normal_and_friction", both_feet_alike),
]


@pytest.mark.parametrize(("slug", "name", "wrong"), list(wrong_functions(WRONG)))
def test_a_wrong_function_does_not_find_what_theory_says(slug, name, wrong):
    case = cases_of("simulator")[slug]
    lesson = types.SimpleNamespace(**{**vars(subject_of(case)), name: wrong})
    with np.errstate(all="ignore"):
        found, _ = found_by(case, lesson)
    assert not all(f.holds for f in found)


def scaled(value, factor):
    """The same result, a little larger or smaller: a number, an array, or a tuple of them."""
    return tuple(scaled(part, factor) for part in value) if isinstance(value, tuple) else factor * np.asarray(value)


def slippery(model, settings):
    """Takes 9/10 of each body's friction."""
    bodies = tuple(body._replace(mu=0.9 * body.mu) for body in model.bodies)
    return compose(model._replace(bodies=bodies), settings)


@pytest.mark.long
def test_a_tenth_less_friction_is_seen_on_a_pyramid_that_slides():
    case = cases_of("simulator")["solids-on-a-plane"]
    lesson = types.SimpleNamespace(**{**vars(subject_of(case)), "compose": slippery})
    assert not all(f.holds for f in found_by(case, lesson)[0])


FORMULAS = ("free_step_2d", "free_step", "mechanical_energy", "momenta", "gain_without_source", "compare")


@pytest.mark.parametrize("factor", [0.999, 1.001])
@pytest.mark.parametrize("function", FORMULAS)
def test_a_formula_that_is_a_thousandth_off_is_seen(function, factor):
    case = cases_of("simulator")["flight-and-its-invariants"]
    lesson = subject_of(case)
    right = getattr(lesson, function)
    wrong = lambda *arguments: scaled(right(*arguments), factor)
    found, _ = found_by(case, types.SimpleNamespace(**{**vars(lesson), function: wrong}))
    assert not all(f.holds for f in found)


@pytest.mark.parametrize("mutant", [m for m in MUTANTS if m.right], ids=lambda m: m.exercise)
def test_right_answers_written_differently_pass_part_by_part(mutant):
    case = cases_of("simulator")["loop-by-parts"]
    lesson = types.SimpleNamespace(**{**vars(subject_of(case)), mutant.name: mutant.function})
    assert all(f.holds for f in found_by(case, lesson)[0])
