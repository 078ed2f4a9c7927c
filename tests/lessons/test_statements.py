"""What the lessons say in words, as numbers: each test would fail if its sentence in the notebook were false."""

import numpy as np
import pytest

from solutions.checks import BadInput
from validate.notebook.live.hand import HERTZ, ZETA
from validate.reference.integrators import Planet, kepler_position, perihelion
from validate.reference.rotation import HeavyTop
from validate.subject.modules import bind

contact, friction, impulses, integrators, kinematics, rotation, sensitivities, springs = map(bind, (
    "contact", "friction", "impulses", "integrators", "kinematics", "rotation", "sensitivities", "springs"))


# ---------------------------------------------------------------------------------------------- 1 integrators

@pytest.mark.parametrize("method", ["symplectic_euler_step", "verlet_step"])
def test_a_method_that_keeps_areas_may_still_gain_energy_without_bound(method):
    """Both have the trace 2 − z² and the determinant 1: beyond z = 2 one eigenvalue is outside the unit circle."""
    for z in (0.5, 1.9, 2.1, 3.0):
        A = integrators.amplification_matrix(getattr(integrators, method), 1.0, 0.0, z)
        half = 0.5 * (2.0 - z * z)
        grows = abs(half) + np.sqrt(half * half - 1.0) if abs(half) > 1.0 else 1.0
        assert abs(np.linalg.det(A) - 1.0) < 1e-12
        assert abs(integrators.spectral_radius(A) - grows) < 1e-7              # a double eigenvalue has half the digits


@pytest.mark.parametrize(("method", "squared"), [
    ("euler_step", lambda z: 1.0 + z**2), ("midpoint_step", lambda z: 1.0 + z**4 / 4.0),
    ("average_velocity_step", lambda z: 1.0 + z**2 / 2.0)])
def test_three_explicit_methods_have_no_stable_step_without_damping(method, squared):
    for z in (0.01, 0.1, 1.0, 2.0):
        A = integrators.amplification_matrix(getattr(integrators, method), 1.0, 0.0, z)
        assert abs(integrators.spectral_radius(A) ** 2 - squared(z)) < 1e-12


def test_verlet_retraces_its_path_unless_the_acceleration_depends_on_the_velocity():
    for zeta in (0.0, 0.2):
        p = integrators.Oscillator(1.0, zeta)
        x, v = np.ones(1), np.zeros(1)
        for dt in (0.1, -0.1):
            for n in range(50):
                x, v = integrators.verlet_step(integrators.oscillator_acceleration, n * dt, x, v, dt, p)
        assert (abs(x[0] - 1.0) < 1e-12) == (zeta == 0.0)


def test_at_one_step_per_frame_symplectic_euler_is_wrong_by_a_tenth_and_verlet_by_one_per_cent():
    """Of the amplitude of a swing at 5 rad/s, during the first swing: the first by up to ω dt/2 as its phase allows."""
    p = integrators.Oscillator(5.0, 0.0)
    for method, least, most in (("symplectic_euler_step", 0.09, 0.12), ("verlet_step", 0.005, 0.012)):
        ts, xs, _ = integrators.trajectory(getattr(integrators, method), integrators.oscillator_acceleration, 0.0,
                                           np.ones(1), np.zeros(1), 1.0 / 24.0, 30, p)
        assert least < np.abs(xs[:, 0] - np.cos(5.0 * ts)).max() < most


@pytest.mark.parametrize(("method", "first", "then"), [("euler_step", 6.0, 10.0), ("midpoint_step", 50.0, 100.0)])
def test_ten_times_the_steps_miss_a_tenth_or_a_hundredth_only_where_steps_are_short(method, first, then):
    """Of v̇ = v after 1 s, in 1, 10 and 100 steps."""
    missed = [np.e - integrators.advance(getattr(integrators, method), lambda t, x, v, p: v, 0.0, np.zeros(1),
                                         np.ones(1), 1.0 / n, n, None)[1][0] for n in (1, 10, 100)]
    assert abs(missed[0] / missed[1] / first - 1.0) < 0.05
    assert abs(missed[1] / missed[2] / then - 1.0) < 0.08


def test_adaptive_steps_miss_a_comet_by_a_millionth_of_what_equal_steps_miss_with_as_much_work():
    comet = Planet(e=0.9)
    begin, end = perihelion(comet), kepler_position(comet, 3.0 * np.pi)
    calls = []

    def pull(t, x, v, p):
        calls.append(t)
        return -x / np.sum(x * x) ** 1.5

    step = integrators.blanes_moan_step
    adaptive = integrators.advance_adaptive(step, pull, 0.0, *begin, 0.1, 3.0 * np.pi, None)[0]
    work = len(calls)
    assert work < 1000
    equal = integrators.advance(step, pull, 0.0, *begin, 3.0 * np.pi / 143, 143, None)[0]
    assert len(calls) - work > 1000
    assert np.linalg.norm(equal - end) > 1e6 * np.linalg.norm(adaptive - end)


# ---------------------------------------------------------------------------------------------- 2 springs

def test_a_push_just_beyond_the_edge_grows_90000_fold_in_100_steps_and_just_below_it_22_fold():
    """Of symplectic Euler at ω dt = 2 (1 ± 0.001), from rest."""
    for z, most in ((2.002, 90e3), (1.998, 22.0)):
        xs = integrators.trajectory(integrators.symplectic_euler_step, integrators.oscillator_acceleration, 0.0,
                                    np.ones(1), np.zeros(1), z, 100, integrators.Oscillator(1.0, 0.0))[1]
        assert abs(np.abs(xs).max() / most - 1.0) < 0.03


def test_a_hand_by_the_force_at_the_beginning_of_a_step_throws_its_node_eight_times_as_fast_the_other_way():
    """A node of 20 g in a net of 36, pulled by the hand of the live scene in steps of 1/240 s."""
    felt, m, dt, rate = 0.02 * 34, 0.02, 1.0 / 240.0, 2.0 * np.pi * HERTZ
    k, c = felt * rate**2, 2.0 * ZETA * felt * rate
    assert abs(c * dt / m - 9.0) < 0.2
    step = np.array([[1.0 - dt * dt * k / m, dt * (1.0 - dt * c / m)], [-dt * k / m, 1.0 - dt * c / m]])
    assert -8.6 < min(np.linalg.eigvals(step)) < -8.0


def ripple_left(k_d, k_v, height, along, dt=5e-4):
    """The share of a half sine along or across a taut string of ten links that is left after 2 s.

    It is the largest within half a swing: 0.1 s along the string, and 0.46 s across it.
    """
    half = 0.1 if along else 0.46
    seconds = 2.0 + 0.5 * half
    flat = np.stack((np.linspace(0.0, 1.0, 11), np.zeros(11)), axis=1)
    pairs = [(k, k + 1) for k in range(10)]
    network = springs.make_spring_network(flat, 0.01, [0, 10], pairs, 100.0, k_d, np.zeros(2), np.zeros(2), k_v)
    shape, way = np.sin(np.pi * flat[:, 0]), np.array([1.0, 0.0] if along else [0.0, 1.0])
    taut = flat * np.array([1.05, 0.0])
    xs = integrators.trajectory(integrators.verlet_step, springs.spring_network_acceleration, 0.0,
                                taut + height * shape[:, None] * way, 0.0 * flat, dt, round(seconds / dt), network)[1]
    sizes = np.abs((xs - taut) @ way @ shape) / (shape @ shape)
    return sizes[-round(half / dt):].max() / height


@pytest.mark.long
def test_a_damper_slows_a_ripple_along_a_string_and_hardly_one_across_it_but_air_slows_both():
    """Across the links the damper acts in second order only; m ẍ = −k_v ẋ leaves exp(−k_v t/2m), here e⁻¹ at 2 s."""
    assert ripple_left(0.5, 0.0, 1e-3, along=True) == pytest.approx(0.0075, rel=0.1)
    assert 0.9999 < ripple_left(0.5, 0.0, 1e-3, along=False) < 1.0
    for along in (True, False):
        assert np.exp(-1.05) < ripple_left(0.0, 0.01, 1e-3, along) < np.exp(-0.9)


# ---------------------------------------------------------------------------------------------- 3 friction

def test_a_projected_particle_in_a_smooth_bowl_loses_height_and_less_with_shorter_steps():
    def reached(dt, seconds):
        """The greatest angle [°] within half a second of that time; half a swing takes more than a second."""
        bowl = friction.ParticleInBowl(1.0, 0.0, 0.0, np.array([0.0, -9.81]), np.zeros(2), np.zeros(2), 1.0)
        x, v, angles = np.array([np.sin(np.pi / 3.0), -np.cos(np.pi / 3.0)]), np.zeros(2), []
        for n in range(round((seconds + 0.5) / dt)):
            x, v = friction.advance_particle(friction.position_friction_step, friction.falling_acceleration,
                                             friction.particle_bowl_gap, n * dt, x, v, dt, 1, bowl)
            angles.append(abs(np.degrees(np.arctan2(x[0], -x[1]))))
        return max(angles[-round(1.0 / dt):])
    assert abs(reached(0.005, 3.0) - 54.0) < 0.5 and abs(reached(0.005, 30.0) - 26.0) < 0.5
    assert reached(0.001, 3.0) > 58.5


# ---------------------------------------------------------------------------------------------- 5 rotation

@pytest.mark.long
def test_the_average_precession_of_a_top_is_larger_than_that_of_the_fast_top():
    for spin, more in ((30.0, 1.13), (50.0, 1.04), (300.0, 1.001)):
        times = np.linspace(0.0, 60.0, 60001)
        x, y = HeavyTop(5.0, 1.0, 20.0, 0.3, spin).tips(times).T
        angle, away = np.unwrap(np.arctan2(y, x)), np.hypot(x, y)
        cusps = np.flatnonzero((away[1:-1] <= away[:-2]) & (away[1:-1] < away[2:])) + 1
        first, last = cusps[0], cusps[-1]
        average = (angle[last] - angle[first]) / (times[last] - times[first])
        assert abs(average / (20.0 / spin) - more) < 0.005, spin


def test_one_step_towards_the_polar_decomposition_keeps_the_columns_nearly_unit_but_not_exactly():
    omega, R = 2.0 * np.array([0.48, 0.6, 0.64]), np.eye(3)
    for _ in range(100):
        R = R + 0.1 * rotation.skew(omega) @ R
        R = 0.5 * R @ (3.0 * np.eye(3) - R.T @ R)
    assert 1e-4 < np.abs(R.T @ R - np.eye(3)).max() < 1e-3


# ---------------------------------------------------------------------------------------------- 4 and 6: inputs

def test_a_mesh_with_narrow_whole_numbers_is_closed_or_refused_as_with_wide_ones():
    """Edges are told apart by products of two numbers, which 8 or 32 bits do not hold."""
    tensors = bind("inertia_tensors")
    for kind, count, faces in ((np.uint8, 128, [[89, 91, 127], [35, 55, 17]]),
                               (np.int32, 50_000, [[46345, 46346, 46347]])):
        with pytest.raises(BadInput, match="open edge"):
            tensors.check_closed(count, np.array(faces, kind))


def test_a_ball_on_the_face_of_a_turned_box_has_the_normal_of_that_face():
    """Also where round-off puts its centre outside."""
    collisions, rng = bind("collisions"), np.random.default_rng(3)
    for _ in range(500):
        R, _ = np.linalg.qr(rng.normal(size=(3, 3)))
        box = collisions.Box(rng.normal(size=3), R, rng.uniform(0.1, 1.0, 3))
        k, side, y = rng.integers(3), rng.choice((-1.0, 1.0)), rng.uniform(-0.8, 0.8, 3) * box.half
        y[k] = side * box.half[k]
        n = collisions.ball_box(box.x + R @ y, rng.choice((0.0, 0.1)), box).n
        assert side * n @ R[:, k] > 1.0 - 1e-12


# ---------------------------------------------------------------------------------------------- 7 impulses

def test_the_kinematic_response_is_the_impulse_of_an_immovable_body_without_friction():
    rng = np.random.default_rng(0)
    for _ in range(1000):
        n, v, e, m = rng.normal(size=3), rng.normal(size=3), rng.random(), rng.uniform(0.1, 9.0)
        n /= np.linalg.norm(n)
        by_impulse = v + impulses.impulse_size(n @ v, 1.0 / m, e) / m * n
        assert np.abs(impulses.kinematic_response(v, n, e) - by_impulse).max() < 1e-14


def process(K, u, mu, e):
    """The impulse (J_t, J_n) of Routh's process in the plane, with Poisson's restitution: friction follows the slip.

    The normal impulse grows until nothing approaches, and then by e times as much.  In between, u changes in
    proportion to it: while it slips one way, while it sticks, or while it slips the other way.
    """
    J, compressed, end = np.zeros(2), False, np.inf
    while J[1] < end:
        if u[0] != 0.0:
            friction_share = -mu * np.sign(u[0])
        else:
            friction_share = np.clip(-K[0, 1] / K[0, 0], -mu, mu)
        way = np.array([friction_share, 1.0])
        rate = K @ way
        to_stick = -u[0] / rate[0] if u[0] * rate[0] < 0.0 else np.inf
        to_rest = -u[1] / rate[1] if not compressed and rate[1] > 0.0 else np.inf
        amount = min(to_stick, to_rest, end - J[1])
        J, u = J + amount * way, u + amount * rate
        if amount == to_stick:
            u = np.array([0.0, u[1]])
        if amount == to_rest:
            compressed, end = True, (1.0 + e) * J[1]
    return J


def test_with_friction_newtons_restitution_gains_energy_and_poissons_does_not():
    """A rod in all positions, thrown in all directions; the work of an impulse is J · ½(u + u⁺)."""
    rng, up, gains, worst = np.random.default_rng(1), np.array([0.0, 1.0, 0.0]), 0, -np.inf
    for _ in range(2000):
        angle, e, mu = rng.uniform(0.1, np.pi - 0.1), rng.uniform(0.5, 1.0), rng.uniform(0.1, 3.0)
        u = np.array([rng.uniform(-3.0, 3.0), -1.0, 0.0])
        K = impulses.contact_matrix(-np.array([np.cos(angle), np.sin(angle), 0.0]), 1.0, np.diag([0.0, 3.0, 3.0]))
        gains += impulses.energy_change(u, K, impulses.contact_impulse(u, up, K, e, mu)) > 1e-9
        J = process(K[:2, :2], u[:2], mu, e)
        worst = max(worst, J @ (u[:2] + 0.5 * K[:2, :2] @ J))
    assert gains == 59 and worst < 1e-12


def test_below_its_bound_restitution_gains_no_energy_with_any_friction_and_above_it_may():
    """e* = 1/√(K_nn (K⁻¹)_nn), for random bodies in space."""
    rng, gains = np.random.default_rng(5), 0
    for _ in range(2000):
        r, n, moments, axes = (rng.normal(size=3), rng.normal(size=3), rng.uniform(0.3, 0.5, 3),
                               np.linalg.qr(rng.normal(size=(3, 3)))[0])
        n /= np.linalg.norm(n)
        K = impulses.contact_matrix(r, 1.0, axes @ np.diag(1.0 / moments) @ axes.T)
        bound = 1.0 / np.sqrt((n @ K @ n) * (n @ np.linalg.solve(K, n)))
        u = rng.normal(size=3)
        u -= (u @ n + 1.0) * n
        mu = rng.choice([0.0, 0.1, 0.5, 1.0, 3.0, np.inf])
        J = impulses.contact_impulse(u, n, K, rng.uniform(0.0, 1.0) * bound, mu)
        assert impulses.energy_change(u, K, J) < 1e-12
        if 1.01 * bound < 1.0:
            u = -K @ n / (n @ K @ n)                                           # the slip at which the bound is sharp
            gains += impulses.energy_change(u, K, impulses.contact_impulse(u, n, K, 1.01 * bound, np.inf)) > 0.0
    assert gains > 100


# ---------------------------------------------------------------------------------------------- 9 contact

def test_the_stiffest_leg_of_a_table_need_not_carry_most():
    """Of all loads in equilibrium the legs take those with the least energy Σ N²/2k; moments make N₁ = N₃, N₂ = N₄."""
    legs = np.array([(1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0), (1.0, -1.0)])
    balance = np.vstack((np.ones(4), legs.T))
    for stiffness in ([10.0, 1.0, 0.1, 1.0], [2.0, 1.0, 0.5, 1.0]):
        give = 1.0 / np.array(stiffness)
        system = np.block([[np.diag(give), balance.T], [balance, np.zeros((3, 3))]])
        loads = np.linalg.solve(system, np.append(np.zeros(4), [1.0, 0.0, 0.0]))[:4]
        first, second = 1.0 / (give[0] + give[2]), 1.0 / (give[1] + give[3])
        expected = 0.5 * np.array([first, second, first, second]) / (first + second)
        assert np.abs(loads - expected).max() < 1e-12
        assert np.argmax(stiffness) == 0 and loads[0] < loads[1]


def test_a_sweep_carries_an_effect_up_the_whole_stack_and_down_by_one_contact():
    n = 10
    A = 2.0 * np.eye(n) - np.eye(n, k=1) - np.eye(n, k=-1)                     # of equal boxes on each other
    A[0, 0] = 1.0
    up = contact.gauss_seidel_sweep(A, np.append(-1.0, np.zeros(n - 1)), np.zeros(n), 1.0)
    assert np.abs(up - 0.5 ** np.arange(n)).max() < 1e-12
    down = contact.gauss_seidel_sweep(A, np.append(np.zeros(n - 1), -1.0), np.zeros(n), 1.0)
    assert np.all(down[:-1] == 0.0) and down[-1] == 0.5
    assert np.flatnonzero(contact.gauss_seidel_sweep(A, np.append(np.zeros(n - 1), -1.0), down, 1.0))[0] == n - 2


def test_the_error_that_a_stack_keeps_longest_is_a_quarter_of_a_cosine_wave():
    """Jacobi's sweep makes each error the mean of its neighbours: the wave shrinks by cos θ, and no other by less."""
    n = 10
    A = 2.0 * np.eye(n) - np.eye(n, k=1) - np.eye(n, k=-1)
    A[0, 0] = 1.0
    jacobi, theta = np.eye(n) - A / np.diag(A)[:, None], 0.5 * np.pi / n
    wave = np.cos(theta * np.arange(n))
    assert np.abs(jacobi @ wave - np.cos(theta) * wave).max() < 1e-12
    sizes = np.sort(np.abs(np.linalg.eigvals(jacobi)))
    assert abs(sizes[-1] - np.cos(theta)) < 1e-12 and abs(sizes[-3] - np.cos(3.0 * theta)) < 1e-12    # in pairs ±
    assert abs(contact.stack_contraction(n) - np.cos(theta) ** 2) < 1e-12


def test_a_heavy_box_on_a_light_one_sinks_by_the_numbers_of_the_table():
    """10 kg on 1 kg, five sweeps per step from zero, 60 steps per second."""
    w, dt = np.array([1.0, 0.1]), 1.0 / 60.0
    A, v, before, after = np.array([[1.0, -1.0], [-1.0, 1.1]]), np.zeros(2), [], []
    for _ in range(60):
        v = v - 9.81 * dt
        before.append(-v[1])
        lam = np.zeros(2)
        for _ in range(5):
            lam = contact.gauss_seidel_sweep(A, np.array([v[0], v[1] - v[0]]), lam, 1.0)
        v = v + w * (lam - np.append(lam[1:], 0.0))
        after.append(-v[1])
    assert np.round([*before[:4], before[-1]], 3).tolist() == [0.164, 0.265, 0.328, 0.367, 0.431]
    assert np.round([*after[:4], after[-1]], 3).tolist() == [0.102, 0.165, 0.204, 0.228, 0.268]


def with_memory(masses, impulses, sweeps, steps, dt=1.0 / 60.0):
    """(impulses over g dt, heights [m]) after each step of bodies on each other that begin at rest."""
    w, v, y, found = 1.0 / np.array(masses), np.zeros(len(masses)), np.zeros(len(masses)), []
    A, lam = np.diag(w + np.append(0.0, w[:-1])), 9.81 * dt * np.array(impulses)
    A -= np.diag(w[:-1], 1) + np.diag(w[:-1], -1)
    for _ in range(steps):
        v = v - 9.81 * dt
        b = np.diff(np.append(0.0, v))
        for _ in range(sweeps):
            lam = contact.gauss_seidel_sweep(A, b, lam, 1.0)
        v = v + w * (lam - np.append(lam[1:], 0.0))
        y = y + dt * v
        found.append((lam / (9.81 * dt), y))
    return map(np.array, zip(*found, strict=True))


@pytest.mark.parametrize(("n", "steps"), [(11, 18), (30, 135)])
def test_with_memory_the_lowest_contact_carries_a_new_crate_after_twice_the_sweeps(n, steps):
    """e_k+1 = h (2 e_k − e_k−1) with h = ρ²⁵, because the motion must be stopped, too: √h per step, and it swings."""
    forces, y = with_memory(np.ones(n), np.arange(n - 1.0, -1.0, -1.0), 25, 2 * steps)
    missing = n - forces[:, 0]
    assert np.flatnonzero(np.abs(missing) > 0.01)[-1] + 1 == steps and missing.min() < -0.1
    assert abs(steps - np.log(0.01) / (12.5 * np.log(contact.stack_contraction(n)))) < 1.0
    if n == 11:
        assert np.round(1e3 * np.array([y[:, -1].min(), y[-1, -1]]), 1).tolist() == [-1.0, -0.7]


@pytest.mark.long
def test_with_memory_a_cabin_on_a_block_needs_6900_steps_of_two_sweeps():
    forces, _ = with_memory([1.0, 1000.0], [0.0, 0.0], 2, 9000)
    assert np.flatnonzero(np.abs(forces[:, 1] - 1000.0) > 1.0)[-1] == pytest.approx(6900, abs=50)


@pytest.mark.parametrize(("substeps", "hertz", "low"), [(16, 480.0, 0.003), (1, 60.0, 0.17)])
def test_a_box_on_one_of_a_thousandth_stands_with_16_substeps_and_sinks_with_one(substeps, hertz, low):
    masses = np.array([1.0, 1000.0])
    state, pile = contact.make_pile_2d([(0.0, 0.5), (0.0, 1.5)], np.zeros(2), masses, masses / 6.0,
                                       np.full((2, 2), 0.5), np.array([(0.0, 1.0, 0.0)]), (0.0, -9.81), 0.5, substeps,
                                       hertz, 10.0, 0.02)
    end = contact.advance_pile_2d(contact.box_bounds_2d, contact.box_contacts_2d, state, 1.0 / 240.0, 720, pile)
    assert float(f"{1.5 - end.x[1, 1]:.{1 if substeps > 1 else 2}g}") == low
    assert (np.abs(end.v).max() < 1e-4) == (substeps == 16)


# ---------------------------------------------------------------------------------------------- 11 kinematics

def test_a_bend_of_a_straight_arm_shortens_it_by_the_length_beyond_the_later_joint():
    lengths, small = np.array([1.0, 0.7, 0.4]), 1e-4
    beyond = np.array([2.1, 1.1, 0.4])

    def reach(theta):
        return kinematics.joint_positions(theta, lengths)[-1, 0]
    for i in range(3):
        for j in range(3):
            a, b = small * np.eye(3)[i], small * np.eye(3)[j]
            bends = (reach(a + b) - reach(a - b) - reach(b - a) + reach(-a - b)) / (4.0 * small**2)
            assert abs(-bends - beyond[max(i, j)]) < 1e-6
    J = kinematics.jacobian_2d(kinematics.joint_positions(np.zeros(3), lengths))
    assert np.abs(J.T @ J - np.outer(beyond, beyond)).max() < 1e-12


def test_the_larger_gain_of_the_ellipse_is_above_its_limit_and_lets_the_error_grow():
    x = kinematics.joint_positions(np.array([0.4, 0.9, 0.7]), np.array([1.0, 0.7, 0.4]))
    largest = np.linalg.svd(kinematics.jacobian_2d(x), compute_uv=False)[0]
    assert round(2.0 / largest**2, 2) == 0.52 and round(1.0 - 0.6 * largest**2, 1) == -1.3


def test_a_straight_arm_of_20_cm_keeps_about_nine_tenths_of_its_error_with_half_a_square_metre():
    for n in (2, 3, 4):
        x = kinematics.joint_positions(np.zeros(n), np.full(n, 0.2 / n))
        largest = np.linalg.svd(kinematics.jacobian_2d(x), compute_uv=False)[0]
        assert 0.86 < 0.5 / (largest**2 + 0.5) < 0.92


@pytest.mark.parametrize(("target", "negative"), [(0.5, True), (2.0, True), (2.2, False), (3.0, False)])
def test_a_straight_arm_is_at_a_saddle_point_where_the_target_is_between_its_base_and_its_tip(target, negative):
    """H = JᵀJ − e · ∂²x, and S = −e · ∂²x has e times the lengths beyond the later joint (see above)."""
    beyond = np.array([2.1, 1.1, 0.4])
    H = np.outer(beyond, beyond) + (target - 2.1) * np.minimum.outer(beyond, beyond)
    assert (np.linalg.eigvalsh(H)[0] < 0.0) == negative and np.linalg.eigvalsh(H)[-1] > 0.0


# ---------------------------------------------------------------------------------------------- 12 sensitivities

def test_more_than_nine_in_ten_throws_of_the_first_picture_hit_and_three_corrections_are_enough():
    lean, places = np.radians(20.0), np.array([(0.0, 0.0), (3.0, 0.0)])
    normals = np.array([(0.0, 1.0), (-np.cos(lean), np.sin(lean))])
    planes = sensitivities.Course(np.array([0.0, -9.81]), normals, places, np.array([0.8, 0.7]), np.zeros((2, 2)))
    throw = sensitivities.Throw(planes, np.array([0.0, 1.0]), np.array([1.5, 0.6]), 1.4)
    velocity, misses = np.array([4.0, 1.0]), []
    for _ in range(6):
        miss, J = sensitivities.throw_miss(velocity, throw)
        misses.append(np.linalg.norm(miss))
        velocity = velocity - np.linalg.solve(J, miss)
    assert 0.9 < misses[0] < 1.0 and misses[3] < 1e-3
    wrong = 0.02 * np.linalg.norm(velocity) * np.random.default_rng(12).normal(size=(200, 2))
    ends = np.array([sensitivities.throw_miss(velocity + one, throw)[0] for one in wrong])
    assert np.mean(np.linalg.norm(ends, axis=1) < 0.12) > 0.9
