"""Events along a trajectory are found once each, with the order of the method, wherever they fall between samples."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from solutions.checks import BadInput
from solutions.support import events
from validate.stability.simulator import box_on_a_spring, pushed, supports
from validate.subject.modules import bind

integrators, simulator = bind("integrators"), bind("simulator")

G = 9.81
NEAR = np.concatenate(([0.0], 10.0 ** np.arange(-15.0, -1.0)))       # distances from a sample [steps]
DRAWN, DEFAULT = 300, 60     # polynomials; those of the default run, because a test costs more than its polynomial
PHASES = np.unique(np.concatenate((NEAR, 1.0 - NEAR[1:], np.linspace(0.0, 1.0, 21)[:-1])))

long = pytest.mark.long
seeds = pytest.mark.parametrize("seed", [pytest.param(k, marks=[long] * (k >= DEFAULT)) for k in range(DRAWN)])


# ---------------------------------------------------------------------------------------------- each event, once

def assert_found(got, expected, width, ends):
    """Events (time, direction) agree one to one within `width`; what lies within it of an end may be found or not."""
    inside = lambda one: ends[0] + width < one[0] < ends[1] - width
    there = [one for one in expected if inside(one)]
    unmatched = list(got)
    for time, direction in there:
        matches = [one for one in unmatched if abs(one[0] - time) <= width and one[1] == direction]
        assert len(matches) == 1, (time, direction, got, expected)
        unmatched.remove(matches[0])
    assert all(not inside(one) or one[0] < ends[0] + 2.0 * width or one[0] > ends[1] - 2.0 * width
               for one in unmatched), (unmatched, expected)


def found_zeros(ts, values):
    return [(t, d) for d in (1, -1) for t in events.zeros(ts, values, d)]


def found_extrema(ts, values):
    return [(t, d) for d in (1, -1) for t in events.extrema(ts, values, d)[0]]


def random_roots(rng, steps, most):
    """Roots of a polynomial [steps]: some at samples, or within 1e-15 to 1e-2 of one, the others anywhere."""
    roots = []
    for _ in range(rng.integers(1, most + 1)):
        at = rng.choice([rng.uniform(-2.0, steps + 2.0), rng.integers(0, steps + 1) + rng.choice([-1, 1])
                         * rng.choice(NEAR)])
        if all(abs(at - other) > 0.3 for other in roots):
            roots.append(at)
    return np.sort(roots)


def product(roots, bends, t):
    """Π (t − root), times (t − a)² + b² of each bend: positive."""
    values = np.prod([t - root for root in roots], axis=0)
    for a, b in bends:
        values = values * ((t - a) ** 2 + b * b)
    return values


@seeds
def test_every_root_of_a_polynomial_is_found_once_with_its_direction(seed):
    """Degree 5 at most, so nothing is interpolated.  The roots are 0.3 steps apart at least: several lie in a step."""
    rng = np.random.default_rng(seed)
    steps, sign = int(rng.integers(6, 25)), rng.choice([-1.0, 1.0])
    roots = random_roots(rng, steps, 5)
    bends = [(rng.uniform(0.0, steps), rng.uniform(0.5, 3.0))] if len(roots) <= 3 and rng.random() < 0.5 else []
    ts = np.arange(steps + 1.0)
    values = sign * product(roots, bends, ts)
    rising = sign * (-1.0) ** (len(roots) - 1 - np.arange(len(roots)))
    assert_found(found_zeros(ts, values), list(zip(roots, rising, strict=True)), 1e-7, (0.0, steps))
    for root in roots[(roots == np.round(roots)) & (roots > 0) & (roots < steps)]:
        assert root in events.zeros(ts, values)                              # exactly, as its sample is


@seeds
def test_every_extremum_of_a_polynomial_is_found_once_with_its_value(seed):
    """Roots of the slope, at samples too; the polynomial is the integral of their product."""
    rng = np.random.default_rng(seed)
    steps, sign = int(rng.integers(6, 25)), rng.choice([-1.0, 1.0])
    roots = random_roots(rng, steps, 4)
    ts, middle = np.arange(steps + 1.0), roots[0]                            # powers about it stay small near the roots
    c = sign * np.polyint(np.poly(roots - middle))
    slope = np.polyder(c)
    steep = np.polyval(np.polyder(slope), roots - middle)
    round_off = 1e-14 * np.max(np.abs(np.polyval(c, ts - middle)))
    if np.min(np.abs(steep)) * 1e-3 < 1e3 * round_off:
        pytest.skip("round-off of the samples moves an extremum by a thousandth of a step")
    values = np.polyval(c, ts - middle)
    assert_found(found_extrema(ts, values), list(zip(roots, -np.sign(steep), strict=True)), 1e-3, (0.0, steps))
    for time, value in zip(*events.extrema(ts, values), strict=True):
        assert abs(value - np.polyval(c, time - middle)) <= 100.0 * round_off


@pytest.mark.parametrize("per_period", [4, 8, 50, *(pytest.param(n, marks=long) for n in (4.5, 5, 6, 10, 16, 32))])
def test_every_zero_and_extremum_of_a_sine_is_found_once(per_period):
    """A zero or an extremum lies at every phase of the sample number 10, and exactly there.

    With θ = 2π/per_period the slope at an end is wrong by θ⁷/7, which moves an extremum by θ⁵/7 steps; between the
    samples another tenth of that is possible.  Below eight samples per period the ends are left out.
    """
    ts, half = np.arange(round(4.0 * per_period) + 8.0), 0.5 * per_period
    edge = 3.0 if per_period < 8 else 0.0
    ends, theta = (edge, ts[-1] - edge), 2.0 * np.pi / per_period
    numbers = np.arange(-40, 60)
    rising, highest = np.where(numbers % 2 == 0, 1, -1), np.where(numbers % 2 == 0, -1, 1)
    for phase in PHASES:
        expected = 10.0 + phase + half * numbers
        sine = np.sin(np.pi / half * (ts - 10.0 - phase))
        cosine = -np.cos(np.pi / half * (ts - 10.0 - phase))
        assert_found(found_zeros(ts, sine), list(zip(expected, rising, strict=True)),
                     min(0.3, 0.03 * theta**6 + 1e-13), ends)
        assert_found(found_extrema(ts, cosine), list(zip(expected, highest, strict=True)),
                     min(0.3, 0.16 * theta**5 + 1e-11), ends)


def test_extrema_at_samples_of_a_method_are_found():
    """A period of a whole number of steps: the better the method, the nearer each extremum is to a sample."""
    oscillator = integrators.Oscillator(2.0 * np.pi, 0.0)
    for step, width in ((integrators.verlet_step, 1e-2), (integrators.rk4_step, 1e-4),
                        (integrators.blanes_moan_step, 1e-6)):
        for per_period in (40, 100, 128):
            ts, xs, _ = integrators.trajectory(step, integrators.oscillator_acceleration, 0.0, np.ones(1), np.zeros(1),
                                               1.0 / per_period, 5 * per_period + 7, oscillator)
            times, values = events.extrema(ts, xs[:, 0])
            assert len(times) == 10 and np.allclose(times, 0.5 * np.arange(1.0, 11.0), atol=width)
            assert np.allclose(values, (-1.0) ** np.arange(1, 11), atol=width)


@pytest.mark.parametrize(("values", "expected"), [
    ((np.arange(21.0) - 10.0) ** 2, []), (-(np.arange(21.0) - 10.0) ** 2, []),           # it only touches zero
    ((np.arange(21.0) - 10.0) ** 3, [10.0]), (10.0 - np.arange(21.0), [10.0]),
    (np.arange(21.0) * (20.0 - np.arange(21.0)), []),                                    # it begins and ends there
    (np.zeros(21), []), (np.full(21, -0.3), [])])
def test_a_quantity_that_does_not_change_its_sign_has_no_zero(values, expected):
    assert np.array_equal(events.zeros(np.arange(21.0), values), expected)


def test_both_directions_together_are_all_events_in_order():
    ts = np.linspace(0.0, 30.0, 301)
    for find in (events.zeros, lambda *arguments: events.extrema(*arguments)[0]):
        up, down, both = (find(ts, np.sin(ts * ts / 20.0 + 1.0), d) for d in (1, -1, 0))
        assert np.array_equal(np.sort(np.concatenate((up, down))), both) and len(both) >= 14
        assert np.array_equal(find(ts, np.sin(ts * ts / 20.0 + 1.0)), both)


def test_a_constant_has_no_extremum():
    for value in (0.0, 0.1, -1e300, 5e-324):
        assert len(events.extrema(np.arange(21.0), np.full(21, value))[0]) == 0


# ---------------------------------------------------------------------------------------------- the order

def event_errors(step, order, steps, find, expected):
    """Largest error over all phases of the event in its step; the oscillator begins at x = 1 with v = 0."""
    oscillator, worst = integrators.Oscillator(2.0, 0.0), 0.0
    for phase in PHASES[::3]:
        dt = expected / (steps + phase)
        ts, xs, _ = integrators.trajectory(step, integrators.oscillator_acceleration, 0.0, np.array([1.0]),
                                           np.array([0.0]), dt, steps + 9, oscillator)
        found = find(ts, xs[:, 0])
        worst = max(worst, np.min(np.abs(found - expected)))
    return worst


@pytest.mark.parametrize(("step", "order"), [("symplectic_euler_step", 1), ("midpoint_step", 2), ("rk4_step", 4),
                                             ("blanes_moan_step", 4)])
@pytest.mark.parametrize(("find", "expected"), [
    (events.zeros, 0.75 * np.pi), (lambda ts, xs: events.extrema(ts, xs)[0], 0.5 * np.pi)])
def test_an_event_has_the_order_of_the_method_at_every_phase(step, order, find, expected):
    """x = cos 2t is 0 at ¾π and lowest at ½π."""
    coarse, fine = (event_errors(getattr(integrators, step), order, steps, find, expected) for steps in (40, 80))
    assert abs(np.log2(coarse / fine) - order) < 0.3, (coarse, fine)


@pytest.mark.parametrize(("find", "order", "expected"), [
    (events.zeros, 6, 1.0), (lambda ts, y: events.extrema(ts, y)[0], 5, 1.0 + 0.25 * np.pi)])
def test_interpolation_adds_an_error_of_order_five_or_six(find, order, expected):
    errors = []
    for steps in (16, 32):
        worst = 0.0
        for phase in PHASES:
            ts = expected + (np.arange(-steps, steps + 1.0) - phase) / steps
            worst = max(worst, np.min(np.abs(find(ts, np.sin(2.0 * (ts - 1.0))) - expected)))
        errors.append(worst)
    assert np.log2(errors[0] / errors[1]) > order - 0.3, errors


def test_the_value_at_a_time_is_exact_at_samples_and_for_degree_five_and_of_order_six():
    ts, c = np.linspace(-1.0, 2.0, 16), np.array([0.3, -1.0, 0.7, 2.0, -0.4, 0.1])
    between = np.linspace(-1.0, 2.0, 301)
    assert np.array_equal(events.value_at(ts, np.cos(ts), ts), np.cos(ts))
    assert np.allclose(events.value_at(ts, np.polyval(c, ts), between), np.polyval(c, between), rtol=0.0, atol=1e-12)
    assert events.value_at(ts, np.polyval(c, ts), 0.77) == pytest.approx(np.polyval(c, 0.77), abs=1e-13)
    errors = []
    for n in (30, 60, 120):
        ts = np.linspace(-1.0, 2.0, n + 1)
        errors.append(np.max(np.abs(events.value_at(ts, np.sin(3.0 * ts), between) - np.sin(3.0 * between))))
    assert np.all(np.log2(np.array(errors[:-1]) / errors[1:]) > 5.5), errors


def test_the_value_and_its_slope_have_no_jump_at_a_sample():
    """Noise is interpolated as it is: pieces fit together for any samples."""
    ts, h = np.arange(30.0), 1e-6
    noise = np.random.default_rng(5).normal(size=30)
    before, at, after = (events.value_at(ts, noise, ts[1:-1] + shift) for shift in (-h, 0.0, h))
    assert np.max(np.abs(at - before)) < 1e-4
    assert np.max(np.abs((after - at) - (at - before))) < 1e3 * h * h


def pendulum(t, x, v, p):
    return -G * np.sin(x)


@pytest.mark.parametrize(("step", "order"), [(integrators.symplectic_euler_step, 1), (integrators.midpoint_step, 2),
                                             (integrators.rk4_step, 4)])
def test_a_pendulum_passes_and_turns_when_a_converged_solver_says(step, order):
    passes, turns = lambda t, y: y[0], lambda t, y: y[1] if t > 0.1 else -1.0
    truth = solve_ivp(lambda t, y: [y[1], -G * np.sin(y[0])], (0.0, 1.5), [1.0, 0.0], "DOP853", events=[passes, turns],
                      rtol=1e-13, atol=1e-14)
    errors = []
    for steps in (120, 240):
        ts, xs, _ = integrators.trajectory(step, pendulum, 0.0, np.array([1.0]), np.array([0.0]), 1.5 / steps, steps,
                                           None)
        times, lowest = events.extrema(ts, xs[:, 0], -1)
        errors.append([events.zeros(ts, xs[:, 0])[0] - truth.t_events[0][0], times[0] - truth.t_events[1][0],
                       lowest[0] + 1.0])                 # energy: it turns where it began, on the other side
    orders = np.log2(np.abs(np.array(errors[0]) / errors[1]))
    assert np.all(np.abs(orders[:2] - order) < 0.3) and orders[2] > order - 0.3, errors


# ---------------------------------------------------------------------------------------------- what is refused

@pytest.mark.parametrize(("ts", "values"), [
    ([0.0, 1.0, 2.0], [0.0, 1.0, 2.0]), (np.arange(8.0), np.arange(7.0)), (np.arange(8.0) ** 2, np.arange(8.0)),
    (np.arange(8.0)[::-1], np.arange(8.0)), (np.zeros(8), np.arange(8.0)), (None, np.arange(8.0)),
    (np.arange(8.0), None), (np.arange(8.0), "rising"), (np.arange(8.0), [0, 1, 2, np.nan, 4, 5, 6, 7]),
    (np.arange(8.0), np.full(8, 1e308)), (np.arange(16.0).reshape(8, 2), np.arange(16.0).reshape(8, 2))])
def test_samples_that_are_none_are_refused_in_one_sentence(ts, values):
    for find in (events.zeros, events.extrema, events.release, lambda ts, values: events.value_at(ts, values, 1.0)):
        if find is events.release and np.size(ts) == 3:
            continue                                     # a release needs two forces only
        with pytest.raises(BadInput) as error:
            find(ts, values)
        assert "\n" not in str(error.value) and len(str(error.value)) < 150


@pytest.mark.parametrize("direction", ["rising", 2, 0.5, np.nan, np.inf, None, [1]])
def test_a_direction_is_one_minus_one_or_zero(direction):
    for find in (events.zeros, events.extrema):
        with pytest.raises(BadInput, match="direction of the event"):
            find(np.arange(9.0), np.sin(np.arange(9.0)), direction)


@pytest.mark.parametrize("t", [-0.1, 8.1, np.nan, None, "noon", [1.0, 9.0]])
def test_a_value_outside_the_samples_is_refused(t):
    with pytest.raises(BadInput, match="time t"):
        events.value_at(np.arange(9.0), np.arange(9.0), t)


# ---------------------------------------------------------------------------------------------- release

def test_a_puck_leaves_a_ball_where_the_force_of_the_ball_ends():
    """It slides without friction from the top: n = g cos θ − v²/R = 0 at cos θ = ⅔ cos(start), for any R."""
    R, start = 0.5, 1e-2
    law = lambda t, x, v, p: G / R * np.sin(x)
    ts, xs, vs = integrators.trajectory(integrators.rk4_step, law, 0.0, np.array([start]), np.array([0.0]), 0.005, 400,
                                        None)
    force = G * np.cos(xs[:, 0]) - R * vs[:, 0] ** 2
    t = events.release(ts, force)
    assert abs(np.cos(events.value_at(ts, xs[:, 0], t)) - 2.0 / 3.0 * np.cos(start)) < 1e-7
    assert events.release(ts[:50], force[:50]) == np.inf
    # the same forces as a loop would give them, which knows no negative ones
    assert abs(events.release(ts, np.maximum(force, 0.0)) - t) < 1e-6


@pytest.mark.parametrize("seen", [lambda force: force, lambda force: np.maximum(force, 0.0)])
def test_a_release_has_order_four_at_every_phase_whether_forces_cross_zero_or_end_there(seen):
    """F = 0.6 + sin 2t falls through zero at 2t = π + arcsin 0.6."""
    expected, errors = 0.5 * (np.pi + np.arcsin(0.6)), []
    for steps in (20, 40):
        worst = 0.0
        for phase in PHASES:
            ts = expected + (np.arange(-steps, 9.0) - phase) / steps
            worst = max(worst, abs(events.release(ts, seen(0.6 + np.sin(2.0 * ts))) - expected))
        errors.append(worst)
    assert np.log2(errors[0] / errors[1]) > 3.7, errors


def test_a_release_lies_between_the_last_force_and_the_first_that_is_zero():
    ts = 0.1 * np.arange(6.0)
    assert 0.3 < events.release(ts, [0.4, 0.275, 0.171, 0.065, 0.0, 0.0]) < 0.4
    assert events.release(ts, [0.0, 0.0, 3.0, 3.0, 0.0, 0.0]) == ts[4]       # a support that ends
    assert events.release(ts, [0.0, 0.0, 0.0, 3.0, 0.0, 5.0]) == ts[4]       # an impact
    assert events.release(ts, [0.0, 0.0, 3.0, 2.0, 1.0, 0.5]) == np.inf
    assert events.release(ts, np.zeros(6)) == np.inf
    assert events.release(ts, [3.0, 2.0, 1.0, 0.0, 0.0, 0.0]) == pytest.approx(0.3)
    # what comes before contact does not count
    assert events.release(ts, [0.0, 0.0, 2.0, 0.5, 0.0, 0.0]) == pytest.approx(0.3 + 0.1 / 3.0)
    assert events.release(ts[:2], [1.0, 0.0]) == ts[1]


def release_errors(held, step, ahead, steps):
    """Largest error over several phases of the release in its step; `ahead` is the leapfrog start in steps."""
    expected = held.time(0.0)
    dts = expected / (steps + np.array([0.0, 1e-9, 0.2, 0.5, 0.7, 1.0 - 1e-9]))
    found = [events.release(*pushed(simulator, step, held.scene, dt, ahead, expected)) for dt in dts]
    return np.max(np.abs(np.array(found) - expected))


@pytest.mark.parametrize("held", supports(), ids=lambda held: held.what)
@pytest.mark.parametrize(("step", "ahead", "order"), [
    ("contact_step_2d", 0.5, 2), pytest.param("contact_step_2d", 0.0, 1, marks=long), ("mean_contact_step_2d", 0.0, 1)])
def test_the_release_from_the_impulses_of_a_loop_has_the_order_of_the_run(held, step, ahead, order):
    coarse, fine = (release_errors(held, getattr(simulator, step), ahead, steps) for steps in (40, 80))
    assert abs(np.log2(coarse / fine) - order) < 0.35, (coarse, fine)


def test_a_contact_trajectory_ends_where_its_loop_ends_and_keeps_the_start():
    load, shapes, state, p = box_on_a_spring(simulator, 0.0)
    run = load, *shapes, 0.5, state, 0.01, 30, p
    ts, states = simulator.contact_trajectory(simulator.contact_step_2d, *run)
    assert np.allclose(ts, 0.5 + 0.01 * np.arange(31.0)) and states[0] is state
    end = simulator.advance_contact(simulator.contact_step_2d, *run)
    assert np.array_equal(states[-1].x, end.x) and np.array_equal(states[-1].J, end.J)
    # momentum of the box: what the platform pushes, and the weight
    pushed = 0.01 * simulator.normal_forces(states, 1, 0, 0.01)
    assert np.allclose(np.cumsum(pushed), [0.5 * (one.v[1, 1] + G * (t - 0.5)) for t, one in
                                           zip(ts[1:], states[1:], strict=True)], atol=1e-12)
