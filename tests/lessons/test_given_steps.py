"""Steps that are given in the lessons: their orders, and what they conserve."""

from functools import partial

import numpy as np
import pytest

from solutions.checks import BadInput, Diverged
from solutions.support import networks
from validate.reference.integrators import Planet, kepler_position, perihelion
from validate.subject.modules import bind

integrators, friction, pbd, rotation = map(bind, ("integrators", "friction", "pbd", "rotation"))


def attraction(t, x, v, p):
    return -p.mu / (x @ x) ** 1.5 * x


def orbit_error(step, steps, p, T=2.0):
    x, v = perihelion(p)
    x, _ = integrators.advance(step, attraction, 0.0, x, v, T / steps, steps, p)
    return np.linalg.norm(x - kepler_position(p, T))


def test_blanes_and_moan_is_of_fourth_order_and_beats_runge_kutta_at_equal_work():
    p = Planet(mu=1.0, a=1.0, e=0.3)
    errors = [orbit_error(integrators.blanes_moan_step, n, p) for n in (40, 80, 160)]
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    assert np.all(orders > 3.8) and abs(orders[-1] - 4.0) < 0.15, errors
    # seven accelerations in place of four, the first of which could be that of the step before
    assert orbit_error(integrators.blanes_moan_step, 40, p) < 0.01 * orbit_error(integrators.rk4_step, 70, p)


def test_blanes_and_moan_takes_a_force_at_its_time():
    """x = sin 2t under the force −4 sin 2t: the error falls with the fourth power of the step."""
    law = lambda t, x, v, p: np.array([-4.0 * np.sin(2.0 * t)])
    errors = []
    for n in (20, 40, 80):
        x, _ = integrators.advance(integrators.blanes_moan_step, law, 0.5, np.array([np.sin(1.0)]),
                                   np.array([2.0 * np.cos(1.0)]), 3.0 / n, n, None)
        errors.append(abs(x[0] - np.sin(7.0)))
    assert np.all(np.log2(np.array(errors[:-1]) / errors[1:]) > 3.7), errors


def test_blanes_and_moan_runs_backwards_to_where_it_began_and_leaves_its_input_alone():
    p = Planet(mu=1.0, a=1.0, e=0.5)
    x, v = perihelion(p)
    begin = x.copy(), v.copy()
    x_1, v_1 = integrators.blanes_moan_step(attraction, 0.0, x, v, 0.05, p)
    back, v_back = integrators.blanes_moan_step(attraction, 0.05, x_1, v_1, -0.05, p)
    assert np.allclose(back, x, atol=1e-14) and np.allclose(v_back, v, atol=1e-14)
    assert np.array_equal(x, begin[0]) and np.array_equal(v, begin[1])


def test_leapfrog_is_the_simplest_of_the_family(monkeypatch):
    monkeypatch.setattr(integrators, "SPLITTING", ((0.5, 1.0), (0.5, 0.0)))
    p = Planet(mu=1.0, a=1.0, e=0.5)
    x, v = perihelion(p)
    ours = integrators.blanes_moan_step(attraction, 0.0, x, v, 0.05, p)
    verlet = integrators.verlet_step(attraction, 0.0, x, v, 0.05, p)
    assert np.allclose(ours, verlet, atol=1e-15)


def energy_at_far_ends(run, share, p, revolutions):
    """Energies [J/kg] of a planet whenever it has passed its farthest place, by the adaptive run(step, …, duration)."""
    ends = []

    def step(acceleration, t, x, v, dt, p):
        x_new, v_new = integrators.blanes_moan_step(acceleration, t, x, v, dt, p)
        if x @ v >= 0.0 > x_new @ v_new:
            ends.append(0.5 * v_new @ v_new - p.mu / np.linalg.norm(x_new))
        return x_new, v_new
    x, v = perihelion(p)
    run(step, attraction, 0.0, x, v, share, revolutions * 2.0 * np.pi * np.sqrt(p.a**3 / p.mu), p)
    return np.array(ends)


def advance_by_beginnings(step, acceleration, t, x, v, share, duration, p):
    """The rule that is not symmetric: dt = share √(|x|/|a|) at the beginning of each step."""
    end = t + duration
    while t < end:
        dt = min(share * np.sqrt(np.linalg.norm(x) / np.linalg.norm(acceleration(t, x, v, p))), end - t)
        x, v = step(acceleration, t, x, v, dt, p)
        t += dt
    return x, v


def counted_run(share, T, p):
    """Where a planet is at T by adaptive steps, and how many there were."""
    steps = []

    def step(*arguments):
        steps.append(arguments[1])
        return integrators.blanes_moan_step(*arguments)
    return integrators.advance_adaptive(step, attraction, 0.0, *perihelion(p), share, T, p)[0], len(steps)


def test_adaptive_steps_are_of_fourth_order_and_beat_equal_steps_by_far():
    p, T = Planet(mu=2.0, a=1.5, e=0.9), 9.0
    mean = np.sqrt(p.mu / p.a**3)
    errors, work = [], []
    for share in (0.05, 0.025, 0.0125):
        x, steps = counted_run(share, T, p)
        errors.append(np.linalg.norm(x - kepler_position(p, T)))
        work.append(steps)
    assert abs(np.log2(errors[-2] / errors[-1]) - 4.0) < 0.3, errors
    assert errors[0] < 1e-3 * orbit_error(integrators.blanes_moan_step, work[0], p, T)
    assert abs(work[0] - mean * T / 0.05) < 0.5 * work[0]


def test_adaptive_steps_do_not_let_the_energy_drift_and_those_of_the_beginnings_do():
    p, share, revolutions = Planet(mu=1.0, a=1.0, e=0.8), 0.15, 60
    drifts = []
    for run in (integrators.advance_adaptive, advance_by_beginnings):
        energies = energy_at_far_ends(run, share, p, revolutions)
        off = np.abs(energies + 0.5 * p.mu / p.a)
        drifts.append((np.max(off[-10:]), np.max(off[:10])))
    assert drifts[0][0] < 2.0 * drifts[0][1], "the symmetric rule: as large at the end as at the beginning"
    assert drifts[1][0] > 4.0 * drifts[1][1] and drifts[1][0] > 5.0 * drifts[0][0], "the other rule: it grows"


@pytest.mark.parametrize("shape", [(2,), (3,), (1, 2)])
def test_adaptive_steps_take_any_shape_end_in_time_and_leave_their_input_alone(shape):
    p, ends = Planet(mu=1.0, a=1.0, e=0.5), []

    def step(acceleration, t, x, v, dt, p):
        ends.append(t + dt)
        return integrators.blanes_moan_step(acceleration, t, x, v, dt, p)
    x, v = np.zeros(shape), np.zeros(shape)
    x.flat[:2], v.flat[:2] = perihelion(p)
    begin, law = (x.copy(), v.copy()), lambda t, x, v, p: -p.mu / np.sum(x * x) ** 1.5 * x
    end, _ = integrators.advance_adaptive(step, law, 0.5, x, v, 0.02, 3.0, p)
    assert ends[-1] == 3.5 and np.all(np.diff(ends) > 0.0)
    assert np.allclose(end.flat[:2], kepler_position(p, 3.0), atol=1e-7)
    assert np.array_equal(x, begin[0]) and np.array_equal(v, begin[1])
    same = integrators.advance_adaptive(step, law, 0.5, x, v, 0.02, 0.0, p)
    assert np.array_equal(same, begin)


def test_adaptive_steps_that_could_go_on_for_ever_end_with_an_error(monkeypatch):
    p, x, still = Planet(), np.array([1.0, 0.0]), np.zeros(2)
    run = lambda x, v, share, T: integrators.advance_adaptive(
        integrators.blanes_moan_step, attraction, 0.0, x, v, share, T, p)
    with pytest.raises(Diverged, match="leads no further"):
        run(x, still, 0.1, 1.2)                                      # it falls into the origin after π/√8 = 1.11 s
    with pytest.raises(Diverged, match="rate"):
        run(*perihelion(Planet(e=0.9)), 1.5, 20.0)                   # steps so long that ρ is negative
    with pytest.raises(Diverged, match="rate"), np.errstate(all="ignore"):
        run(still, x, 0.1, 1.0)                                      # the rate has no limit at the origin
    monkeypatch.setattr(integrators, "MOST_ADAPTED_STEPS", 50)
    with pytest.raises(Diverged, match="leads no further"):
        run(x, np.array([0.0, 1.0]), 0.1, 6.0)
    for share, T in ((0.0, 1.0), (-1.0, 1.0), (np.nan, 1.0), (0.1, -1.0), (0.1, np.inf)):
        with pytest.raises(BadInput):
            run(x, still, share, T)


@pytest.mark.parametrize("backspin", [0.0, -60.0])
def test_a_ball_with_mean_velocities_is_exact_but_for_the_step_in_which_it_begins_to_roll(backspin):
    """It rolls with (5 v₀ + 2 R ω₀)/7: the momentum about a point of the floor is kept."""
    R, mu, g, v_0, T = 0.1, 0.2, 9.81, 2.0, 2.5
    ball = rotation.RollingBall(2.0, np.full(3, 0.4 * 2.0 * R * R), R, mu, np.array([0.0, 0.0, -g]))
    rolls = (5.0 * v_0 + 2.0 * R * backspin) / 7.0
    t = (v_0 - rolls) / (mu * g)
    truth = v_0 * t - 0.5 * mu * g * t * t + rolls * (T - t)
    errors = []
    for n in (97, 194, 388):
        state = np.zeros(3), np.array([1.0, 0.0, 0.0, 0.0]), np.array([v_0, 0.0, 0.0]), np.array([0.0, backspin, 0.0])
        x, _, v, omega = rotation.advance_rigid_body(rotation.average_rolling_step, rotation.supported_weight, 0.0,
                                                     *state, T / n, n, ball)
        assert abs(v[0] - rolls) < 1e-12 and abs(R * omega[1] - rolls) < 1e-12
        errors.append(abs(x[0] - truth))
        assert errors[-1] <= 0.125 * mu * g * (T / n) ** 2 + 1e-12


def hanging(n, masses):
    """(x, v, network) of n links of different lengths, held at the first point, with a random motion."""
    rng = np.random.default_rng(5)
    turns = rng.uniform(-1.0, 1.0, n)
    links = rng.uniform(0.5, 1.5, n)[:, None] * np.stack((np.sin(turns), -np.cos(turns)), axis=1)
    x = np.concatenate((np.zeros((1, 2)), np.cumsum(links, axis=0)))
    pairs = [(k, k + 1) for k in range(n)]
    network = pbd.make_constraint_network(x, masses, [0], pairs, 0.0, 1.0, (0.0, -9.81), 1)
    spins = rng.uniform(-1.0, 1.0, n)
    across = spins[:, None] * np.stack((-links[:, 1], links[:, 0]), axis=1)
    return x, np.concatenate((np.zeros((1, 2)), np.cumsum(across, axis=0))), network


def energy(x, v, network):
    m = 1.0 / network.inv_mass[1:]
    return np.sum(m * (0.5 * np.sum(v[1:] ** 2, axis=1) + 9.81 * x[1:, 1]))


@pytest.mark.long
@pytest.mark.parametrize(("step", "order"), [(pbd.rope_step, 2), (pbd.composed_rope_step, 4)])
def test_a_rope_converges_to_rattle_with_its_order_and_keeps_links_and_energy(step, order):
    x, v, rope = hanging(5, np.array([1.0, 0.5, 2.0, 0.7, 1.3, 4.0]))
    T = 0.5
    truth, _ = integrators.advance(pbd.composed_rope_step, pbd.network_gravity, 0.0, x, v, T / 4000, 4000, rope)
    by_rattle, _ = integrators.advance(pbd.rattle_step, pbd.network_gravity, 0.0, x, v, T / 2000, 2000, rope)
    assert np.max(np.abs(truth - by_rattle)) < 1e-5                     # of second order, with a full matrix
    ends = [integrators.advance(step, pbd.network_gravity, 0.0, x, v, T / n, n, rope) for n in (100, 200, 400)]
    errors = [np.max(np.abs(end - truth)) for end, _ in ends]
    assert abs(np.log2(errors[1] / errors[2]) - order) < 0.3, errors
    x_end, v_end = ends[-1]
    links = np.diff(x_end, axis=0)
    assert np.max(np.abs(np.linalg.norm(links, axis=1) - rope.rest)) < 1e-5
    assert np.max(np.abs(np.sum(links * np.diff(v_end, axis=0), axis=1))) < 1e-10       # velocities obey the links
    assert abs(energy(x_end, v_end, rope) - energy(x, v, rope)) < 2e-3 * abs(energy(x, v, rope))


def light_bead(ratio):
    """(x, network, ω): a straight tilted rope, 1 kg at its end and a bead of 1/ratio kg in its middle, links of 0.5 m.

    The tension of both links is near m g, so the bead swings across the rope with ω² = 2 (m g/l) ratio/m.
    """
    x = np.array([[0.0, 0.0], [0.15, -0.4770], [0.30, -0.9540]])
    network = pbd.make_constraint_network(x, [1.0, 1.0 / ratio, 1.0], [0], [(0, 1), (1, 2)], 0.0, 1.0, (0.0, -9.81), 1)
    return x, network, np.sqrt(2.0 * 9.81 / network.rest[0] * ratio)


def verlet_is_stable(shares, z):
    """Whether steps of z times these shares are stable for a = −x: |trace| of the product of their matrices ≤ 2."""
    product = np.eye(2)
    for share in shares:
        h = share * z
        product = np.array([[1.0 - 0.5 * h * h, h], [-h + 0.25 * h**3, 1.0 - 0.5 * h * h]]) @ product
    return abs(np.trace(product)) <= 2.0


def test_the_stability_bounds_of_taut_ropes_are_those_of_verlet_and_of_suzuki():
    s = 1.0 / (4.0 - 4.0 ** (1.0 / 3.0))
    for shares, bound in (([1.0], networks.VERLET_STABLE), ([s, s, 1.0 - 4.0 * s, s, s], networks.SUZUKI_STABLE)):
        assert verlet_is_stable(shares, bound * (1.0 - 1e-9)) and not verlet_is_stable(shares, bound * (1.0 + 1e-9))
        assert all(verlet_is_stable(shares, z) for z in np.linspace(0.01, 0.999, 200) * bound)


@pytest.mark.parametrize("ratio", [pytest.param(1e3, marks=pytest.mark.long), 1e6,
                                   pytest.param(1e8, marks=pytest.mark.long)])
@pytest.mark.parametrize(("step", "bound"), [(pbd.rattle_step, 2.0), (pbd.rope_step, 2.0),
                                             (pbd.composed_rope_step, 2.72097)])
def test_a_rope_with_a_light_bead_keeps_its_links_up_to_the_bound_and_raises_beyond(step, bound, ratio):
    """The rope swings, so the tension is m g only within 10 %: at 0.9 of the bound all is well, at 1.1 it is not."""
    x, network, omega = light_bead(ratio)
    run = partial(integrators.advance, step, pbd.network_gravity, 0.0, x, 0.0 * x)
    x_end, v_end = run(0.9 * bound / omega, 3000, network)
    assert np.max(np.abs(np.linalg.norm(np.diff(x_end, axis=0), axis=1) / network.rest - 1.0)) < 1e-6
    gained = 0.5 * v_end[2] @ v_end[2] + 9.81 * (x_end[2, 1] - x[2, 1])
    assert abs(gained) < 1e-5 * 9.81
    dt = 1.1 * bound / omega
    with pytest.raises(Diverged) as raised:
        run(dt, 3000, network)
    if step is not pbd.rattle_step:                     # which says that its projection did not converge
        said = str(raised.value)
        named, largest, mass_ratio = map(float, said.split("= (")[1].split(")")[0].split(","))
        assert abs(named / dt - 1.0) < 1e-9 and abs(mass_ratio / ratio - 1.0) < 1e-9, said
        assert 0.9 < largest * omega / bound < 1.1, said


def test_what_is_not_a_rope_is_refused():
    x = np.array([[0.0, 0.0], [1.0, 0.0], [2.0, 0.0]])
    for pairs in ([(0, 2), (1, 2)], [(1, 2), (0, 1)], [(1, 0), (1, 2)]):
        network = pbd.make_constraint_network(x, 1.0, [0], pairs, 0.0, 1.0, (0.0, -9.81), 1)
        with pytest.raises(BadInput, match="neighbours"):
            pbd.rope_step(pbd.network_gravity, 0.0, x, 0.0 * x, 0.01, network)


def whirled(t, q, L, body):
    return np.array([np.cos(3.0 * t), t, 0.5])


def pushed(t, x, q, v, omega, body):
    return np.array([t, 1.0, 0.0]), whirled(t, q, omega, body)


def blown(t, x, v, p):
    return p.gravity + np.array([np.cos(3.0 * t), 0.0])


BODY = rotation.make_rigid_body(2.0, (1.0, 1.5, 2.0))
UPRIGHT, SPIN = np.array([1.0, 0.0, 0.0, 0.0]), np.array([0.3, 0.2, 0.1])
GRAIN = friction.ParticleOnPlane(1.0, 0.3, 0.5, np.array([0.0, -9.81]), np.zeros(2), np.array([0.0, 1.0]))
FALL = friction.contact_step, blown, friction.particle_plane_gap
HISTORIES = {                     # a history, the loop over steps that it follows, and the state at the start
    "orbit": (lambda *now: integrators.trajectory(integrators.verlet_step, blown, *now, GRAIN),
              lambda *now: integrators.advance(integrators.verlet_step, blown, *now, GRAIN),
              (np.zeros(2), np.ones(2))),
    "rotation": (lambda *now: rotation.rotation_trajectory(rotation.splitting_step, whirled, *now, BODY),
                 lambda *now: rotation.advance_rotation(rotation.splitting_step, whirled, *now, BODY), (UPRIGHT, SPIN)),
}
LOOPS = {
    **{name: (loop, start) for name, (_, loop, start) in HISTORIES.items()},
    "rigid body": (lambda *now: rotation.advance_rigid_body(rotation.rigid_body_step, pushed, *now, BODY),
                   (np.zeros(3), UPRIGHT, np.ones(3), SPIN)),
    "particle": (lambda *now: friction.advance_particle(*FALL, *now, GRAIN), (np.array([0.0, 0.1]), np.ones(2))),
}


@pytest.mark.parametrize("name", HISTORIES)
def test_a_history_has_the_times_of_its_steps_and_the_states_of_runs_that_end_there(name):
    history, loop, start = HISTORIES[name]
    ts, *parts = history(0.7, *start, 0.05, 4)
    assert np.allclose(ts, 0.7 + 0.05 * np.arange(5), rtol=0.0, atol=1e-15)
    for steps in range(5):
        for part, end in zip(parts, loop(0.7, *start, 0.05, steps), strict=True):
            assert np.allclose(part[steps], end, rtol=0.0, atol=1e-13), (name, steps)


@pytest.mark.parametrize("name", LOOPS)
def test_a_loop_takes_each_step_at_its_own_time(name):
    """Two steps at once are one step, and then one that begins later."""
    loop, start = LOOPS[name]
    once = loop(0.7, *start, 0.05, 1)
    for one, two in zip(loop(0.75, *once, 0.05, 1), loop(0.7, *start, 0.05, 2), strict=True):
        assert np.allclose(one, two, rtol=0.0, atol=1e-13)
    assert not np.allclose(np.concatenate(loop(0.0, *start, 0.05, 2)), np.concatenate(loop(0.7, *start, 0.05, 2)))
