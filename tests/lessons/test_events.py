"""Events along a trajectory are found to the order of the method that made it."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from solutions.checks import BadInput
from solutions.support import events, trajectories
from validate.modules import bind

collisions, friction, impulses, integrators, rotation = map(
    bind, ("collisions", "friction", "impulses", "integrators", "rotation"))

G = 9.81
DOWN = np.array([0.0, 0.0, -G])


def pendulum(t, x, v, p):
    return -G * np.sin(x)


def measured(step, steps, find):
    ts, xs, vs = integrators.trajectory(step, pendulum, 0.0, np.array([1.0]), np.array([0.0]), 1.5 / steps, steps, None)
    return find(ts, xs[:, 0], vs[:, 0])


@pytest.fixture(scope="module")
def truth():
    """(time of the first passage through the lowest point, time of the other end and the angle there)."""
    passes = lambda t, y: y[0]
    turns = lambda t, y: y[1] if t > 0.1 else -1.0
    run = solve_ivp(lambda t, y: [y[1], -G * np.sin(y[0])], (0.0, 1.5), [1.0, 0.0], "DOP853", events=[passes, turns],
                    rtol=1e-13, atol=1e-14)
    return run.t_events[0][0], run.t_events[1][0], -1.0          # energy: it ends where it began, on the other side


@pytest.mark.parametrize(("step", "order"), [(integrators.symplectic_euler_step, 1), (integrators.midpoint_step, 2),
                                             (integrators.rk4_step, 4)])
def test_a_zero_has_the_order_of_the_method(step, order, truth):
    errors = [abs(measured(step, n, lambda ts, xs, vs: events.zeros(ts, xs)[0]) - truth[0]) for n in (60, 120, 240)]
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    assert abs(orders[-1] - order) < 0.25, (errors, orders)


@pytest.mark.parametrize(("step", "order"), [(integrators.midpoint_step, 2), (integrators.rk4_step, 4)])
def test_an_extremum_has_the_order_of_the_method(step, order, truth):
    found = [measured(step, n, lambda ts, xs, vs: events.extrema(ts, xs, -1)) for n in (60, 120, 240)]
    errors = np.array([[abs(f[got][0] - truth[1 + got]) for f in found] for got in (0, 1)])
    orders = np.log2(errors[:, 1] / errors[:, 2])
    assert abs(orders[0] - order) < 0.3 and orders[1] > order - 0.3, errors    # the energy may be one order better


def test_a_puck_leaves_a_ball_where_the_force_of_the_ball_ends():
    """It slides without friction from the top: n = g cos θ − v²/R = 0 at cos θ = 2/3, for any R and a small start."""
    R, start = 0.5, 1e-2
    law = lambda t, x, v, p: G / R * np.sin(x)
    ts, xs, vs = integrators.trajectory(integrators.rk4_step, law, 0.0, np.array([start]), np.array([0.0]), 0.005, 400,
                                        None)
    force = G * np.cos(xs[:, 0]) - R * vs[:, 0] ** 2
    t = events.release(ts, force)
    theta = np.interp(t, ts, xs[:, 0])
    assert abs(np.cos(theta) - 2.0 / 3.0 * np.cos(start)) < 1e-4
    assert events.release(ts[:50], force[:50]) == np.inf


def test_random_polynomials_of_degree_five_have_the_roots_that_numpy_finds():
    rng = np.random.default_rng(3)
    for _ in range(200):
        c = rng.normal(size=6)
        ts = np.linspace(-1.0, 1.0, 400)
        roots = np.roots(c)
        real = np.sort(roots[np.abs(roots.imag) < 1e-9].real)
        real = real[np.abs(real) < 0.99]
        slopes = np.abs(np.polyval(np.polyder(c), real))
        if len(real) and (np.min(np.diff(real), initial=1.0) < 0.02 or slopes.min() < 1e-2):
            continue                                                        # two changes within a step may be missed
        got = events.zeros(ts, np.polyval(c, ts))
        assert len(got) == len(real) + np.sum(np.abs(np.abs(roots[np.abs(roots.imag) < 1e-9].real) - 0.995) <= 0.005)
        for root in real:
            assert np.min(np.abs(got - root)) < 1e-10


def test_directions_are_kept_apart():
    ts = np.linspace(0.0, 10.0, 101)
    up, down, both = (events.zeros(ts, np.sin(ts + 1.0), d) for d in (1, -1, 0))
    assert np.allclose(up, [2.0 * np.pi - 1.0], atol=1e-7)
    assert np.allclose(down, [np.pi - 1.0, 3.0 * np.pi - 1.0], atol=1e-7)
    assert np.array_equal(np.sort(np.concatenate((up, down))), both)
    high, low = events.extrema(ts, np.sin(ts + 1.0), 1), events.extrema(ts, np.sin(ts + 1.0), -1)
    assert np.allclose(high[0], [0.5 * np.pi - 1.0, 2.5 * np.pi - 1.0], atol=1e-6) and np.allclose(high[1], 1.0)
    assert np.allclose(low[0], [1.5 * np.pi - 1.0, 3.5 * np.pi - 1.0], atol=1e-6) and np.allclose(low[1], -1.0)


@pytest.mark.parametrize(("ts", "values"), [
    ([0.0, 1.0, 2.0], [0.0, 1.0, 2.0]), (np.arange(8.0), np.arange(7.0)), (np.arange(8.0) ** 2, np.arange(8.0)),
    (np.arange(8.0)[::-1], np.arange(8.0)), (np.arange(8.0), [0, 1, 2, np.nan, 4, 5, 6, 7])])
def test_samples_that_are_none_are_refused(ts, values):
    for find in (events.zeros, events.extrema):
        with pytest.raises(BadInput):
            find(ts, values)


def same(history, end):
    return all(np.allclose(part[-1], last, rtol=1e-14, atol=1e-14) for part, last in zip(history[1:], end, strict=True))


def test_a_trajectory_ends_where_its_loop_ends_and_keeps_the_start():
    x, v, up = np.array([0.0, 0.0, 1.0]), np.array([1.0, 0.5, 0.0]), np.array([0.0, 0.0, 1.0])
    ball = friction.ParticleOnPlane(1.0, 0.3, 0.8, DOWN, np.zeros(3), up)
    particle = (friction.contact_step, friction.falling_acceleration, friction.particle_plane_gap, 0.5, x, v, 0.01, 60,
                ball)
    bouncing = impulses.BouncingBall(0.8, DOWN, np.zeros(3), up, 1e4, 0.0)
    balls = (impulses.backtracking_step, impulses.falling_acceleration, 0.5, x[None], v[None], 0.01, 60, bouncing)
    spinning = impulses.SpinningBall(0.8, 0.3, 1.0, 2.5 * np.eye(3), 0.4, DOWN, np.zeros(3), up)
    spins = (impulses.backtracking_spin_step, impulses.falling_acceleration, 0.5, x[None], v[None], v[None], 0.01, 60,
             spinning)
    target = collisions.Target(0.2, 0.5, collisions.make_plane([0.0, 0.0, 1.0, 0.0]))
    flight = (collisions.continuous_step, collisions.ball_plane_gap, collisions.ball_plane_time, 0.5, x[None],
              np.array([[0.3, 0.2, -3.0]]), 0.01, 60, target)
    rolling = rotation.RollingBall(1.0, 0.1 * np.ones(3), 0.5, 0.3, DOWN)
    body = (rotation.rolling_step, rotation.supported_weight, 0.5, x, np.array([1.0, 0.0, 0.0, 0.0]), v, np.zeros(3),
            0.01, 60, rolling)
    for history, loop, run in (
            (trajectories.particle_trajectory, friction.advance_particle, particle),
            (trajectories.ball_trajectories, impulses.advance_balls, balls),
            (trajectories.spinning_ball_trajectories, impulses.advance_spinning_balls, spins),
            (trajectories.projectile_trajectories, collisions.advance_projectiles, flight),
            (trajectories.rigid_body_trajectory, rotation.advance_rigid_body, body)):
        got = history(*run)
        assert len(got[0]) == 61 and got[0][0] == 0.5 and got[0][-1] == pytest.approx(1.1)
        assert np.array_equal(got[1][0].ravel(), x)
        assert same(got, loop(*run)), history.__name__


def test_disc_trajectories_end_where_their_loop_ends():
    discs = impulses.Discs(np.array([0.1, 0.2]), np.array([1.0, 0.5]), 0.5)
    x, v = np.array([[[0.0, 0.0], [1.0, 0.05]]]), np.array([[[1.0, 0.0], [-0.5, 0.0]]])
    run = (impulses.backtracking_discs_step, x, v, 0.02, 60, discs)
    got = trajectories.disc_trajectories(*run)
    assert same(got, impulses.advance_discs(*run)) and np.array_equal(got[1][0], x)
