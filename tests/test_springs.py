"""Lesson 2 is right when forces are slopes of an energy, push nothing from outside, and meshes fall, hang and settle."""

import numpy as np
import pytest

from .grading.expect import between, close, raises
from solutions.checks import BadInput, Diverged

exercise = pytest.mark.exercise
H = 1e-5                     # [m] or [rad], step of central differences: cut off after H²/6 f''', blurred by 2e-16 f/H


def slope(f, y, h=H):
    """∂f/∂y by central differences; f may return arrays, whose axes come after those of y."""
    moves = [np.where(np.arange(y.size).reshape(y.shape) == n, h, 0.0) for n in range(y.size)]
    columns = np.array([(f(y + move) - f(y - move)) / (2.0 * h) for move in moves])
    return columns.reshape(y.shape + columns.shape[1:])


# ---------------------------------------------------------------------------------------------- single forces

@exercise("2.1", points=1, hint="x_b − x_a points the right way but has length r: divide it by r³")
def test_gravity_is_the_slope_of_its_potential_and_weighs_us_on_earth(lesson):
    earth, foot, G = np.zeros(3), np.array([0.0, 0.0, 6.371e6]), 6.67430e-11
    force = lesson.universal_gravity(foot, earth, 70.0, 5.972e24, G)
    close("weight of 70 kg at the Earth's surface [N]", force, [0.0, 0.0, -70.0 * 9.8], 0.003 * 70.0 * 9.8)

    a, b = np.array([0.3, -1.0, 0.5]), np.array([1.1, 0.4, -0.2])                        # r = 1.8 m
    expected = -slope(lambda a: -2.0 * 3.0 * 5.0 / np.sqrt(np.sum((b - a) ** 2)), a)
    # H²/6 f''' < H² 30/r⁴ = 3e-10
    close("force on a, minus the slope of −G m_a m_b/r [N]", lesson.universal_gravity(a, b, 3.0, 5.0, 2.0), expected, 1e-8)
    close("force on b [N]: opposite", lesson.universal_gravity(b, a, 5.0, 3.0, 2.0), -expected, 1e-8)


@exercise("2.2", points=1, hint="the wind's force, minus k_v times v; nothing is divided, for k_v may be 0")
def test_air_pushes_points_at_rest_and_lets_go_of_those_that_fly_with_it(lesson):
    wind, k_v = np.array([3.0, -1.0]), 0.5
    v = np.array([[0.0, 0.0], wind / k_v, 2.0 * wind / k_v])
    close("force at v = 0, F_wind/k_v, 2F_wind/k_v [N]", lesson.air_force(v, wind, k_v), [wind, 0.0 * wind, -wind], 1e-14)
    close("force without wind [N]: against the motion", lesson.air_force(v, 0.0 * wind, k_v), -k_v * v, 1e-14)
    close("force on one coordinate [N]", lesson.air_force(4.0, 3.0, 0.5), 1.0, 1e-14)
    close("force without viscosity [N]", lesson.air_force(4.0, 3.0, 0.0), 3.0, 1e-14)


@exercise("2.3", points=1, hint="length minus rest, not the other way round: a stretched spring has a positive tension")
def test_a_spring_carries_a_weight_and_a_damper_a_sinking_one(lesson):
    rest, k, k_d, weight = 0.7, 40.0, 5.0, 2.0
    close("tension at rest [N]", lesson.spring_tension(rest, 0.0, rest, k, k_d), 0.0, 0.0)
    close("tension when mg/k longer [N]", lesson.spring_tension(rest + weight / k, 0.0, rest, k, k_d), weight, 1e-13)
    close("tension when mg/k_d faster [N]", lesson.spring_tension(rest, weight / k_d, rest, k, k_d), weight, 1e-13)
    close("tension of both [N]", lesson.spring_tension(rest - weight / k, -3.0 * weight / k_d, rest, k, k_d), -4.0 * weight, 1e-13)


@exercise("2.4", points=1, hint="one number, −(k C + k_d Ċ), times the vector ∇C as it is: it need not have length 1")
def test_a_soft_constraint_is_the_slope_of_its_energy_and_brakes_across_only(lesson):
    k, k_d, x, gradient = 30.0, 4.0, np.array([0.4, -0.3, 0.5]), np.array([2.0, 1.0, 2.0])
    force = lesson.soft_constraint_force(gradient @ x - 1.0, 0.0, gradient, k, k_d)
    expected = -slope(lambda x: 0.5 * k * (gradient @ x - 1.0) ** 2, x)                   # quadratic: no H² error
    close("force towards the plane 2x + y + 2z = 1 [N], minus the slope of ½kC²", force, expected, 1e-8)

    across, along = gradient.copy(), np.array([1.0, 0.0, -1.0])
    braked = lesson.soft_constraint_force(0.0, gradient @ across, gradient, k, k_d)
    close("force on a point that crosses the plane at ∇C [N]: its power is −k_d Ċ²", braked @ across, -k_d * 81.0, 1e-10)
    close("and it acts along ∇C [N]", np.cross(braked, gradient), np.zeros(3), 1e-10)
    slides = lesson.soft_constraint_force(0.0, gradient @ along, gradient, k, k_d)
    close("force on a point that slides along the plane [N]", slides, np.zeros(3), 0.0)


@exercise("2.5", points=1, hint="first ask whether C < 0; then the bracket −(k C + k_d Ċ) as a whole must not fall below zero")
def test_a_soft_contact_carries_a_weight_and_never_pulls(lesson):
    up, k, k_d, none = np.array([0.0, 2.0]), 50.0, 4.0, np.zeros(2)
    close("force on a point 0.1 m deep [N]", lesson.soft_contact_force(-0.1, 0.0, up, k, k_d), 5.0 * up, 1e-13)
    close("force on one that sinks at 2 m/s [N]: stronger", lesson.soft_contact_force(-0.1, -2.0, up, k, k_d), 13.0 * up, 1e-13)
    close("force on one that leaves at 1 m/s [N]: weaker", lesson.soft_contact_force(-0.1, 1.0, up, k, k_d), 1.0 * up, 1e-13)
    close("force on one that leaves at 2 m/s [N]: not negative", lesson.soft_contact_force(-0.1, 2.0, up, k, k_d), none, 0.0)
    close("force at the surface itself [N]", lesson.soft_contact_force(0.0, -3.0, up, k, k_d), none, 0.0)
    close("force above the surface, sinking [N]", lesson.soft_contact_force(0.1, -3.0, up, k, k_d), none, 0.0)


HINGE = np.array([[1.3, 0.2], [0.1, -0.1], [-0.4, 0.9]])          # a, b, c: arms of 1.2 m and 1.1 m, θ = 1.8 rad


def opened(theta):
    """The hinge with arm c turned to the angle theta [rad] from arm a."""
    a, b, _ = HINGE
    rotation = np.array([[np.cos(theta), -np.sin(theta)], [np.sin(theta), np.cos(theta)]])
    return np.array([a, b, b + 0.9 * rotation @ (a - b)])


def angular_energy(points, rest, k):
    """½k(θ − rest)² [J] with the short way round, by complex numbers: θ is the argument of r_c/r_a."""
    a, b, c = points @ [1.0, 1j]
    return 0.5 * k * np.angle((c - b) / (a - b) * np.exp(-1j * rest)) ** 2


@exercise("2.6", points=1, hint="θ = arctan2(r_a × r_c, r_a · r_c); each end is pushed across its arm, by k(θ − rest)/|r|")
def test_an_angular_spring_is_the_slope_of_its_energy_and_pushes_nothing_from_outside(lesson):
    for rest in (1.0, 2.5):
        force = np.array(lesson.angular_spring_forces(*HINGE, rest, 3.0))
        # forces below 3 N on arms above 1 m: H²/6 f''' < 1e-9, 2e-16 f/H < 1e-10
        expected = -slope(lambda y: angular_energy(y, rest, 3.0), HINGE)
        close(f"forces on a, b, c at θ = 1.8, rest = {rest} [N]", force, expected, 1e-8)
        close("their sum [N]", force.sum(axis=0), np.zeros(2), 1e-13)
        close("their torque [N m]", np.sum(HINGE[:, 0] * force[:, 1] - HINGE[:, 1] * force[:, 0]), 0.0, 1e-13)
    close("forces at rest [N]", np.array(lesson.angular_spring_forces(*opened(2.0), 2.0, 3.0)), np.zeros((3, 2)), 1e-13)


@exercise("2.6", points=0.5, hint="θ − rest may be off by a whole turn: arctan2(sin, cos) of it brings it into (−π, π]")
def test_an_angular_spring_takes_the_short_way_round(lesson):
    for theta, rest in ((-3.0, 3.0), (3.0, -3.0), (0.5, 0.5 + 6.0 * np.pi), (1.0, 1.5 - 2.0 * np.pi)):
        points = opened(theta)
        force = np.array(lesson.angular_spring_forces(*points, rest, 3.0))
        expected = -slope(lambda y: angular_energy(y, rest, 3.0), points)
        close(f"forces at θ = {theta}, rest = {rest:.4g} [N]", force, expected, 1e-8)


@exercise("2.6", points=0.5, hint="when the squared length of either arm is 0.0, raise BadInput before you divide by it")
def test_an_angular_spring_refuses_an_arm_without_length(lesson):
    a, b, c = HINGE
    raises("a = b", BadInput, lesson.angular_spring_forces, b, b, c, 1.0, 3.0)
    raises("c = b", BadInput, lesson.angular_spring_forces, a, b, b, 1.0, 3.0)


# ---------------------------------------------------------------------------------------------- the system

def mesh_of(lesson, inv_mass, springs, gravity, wind=None, k_v=0.0):
    """A Mesh from rows (i, j, rest, k, k_d), without the student's other exercises."""
    table = np.array(springs, dtype=float).reshape(-1, 5).T
    i, j = table[:2].astype(np.int64, order="C")
    rest, k, k_d = np.ascontiguousarray(table[2:])
    gravity = np.array(gravity, dtype=float)
    wind = np.zeros_like(gravity) if wind is None else np.array(wind, dtype=float)
    return lesson.Mesh(np.array(inv_mass, dtype=float), gravity, wind, k_v, i, j, rest, k, k_d)


TETRAHEDRON = np.array([[0.0, 0.0, 0.0], [1.1, 0.1, 0.2], [-0.7, 0.9, -0.1], [0.5, 0.4, 1.0]])     # no two x closer than 0.5 m
SWIRL = np.array([[0.3, -0.2, 0.9], [-1.0, 0.4, 0.1], [0.6, 0.8, -0.7], [0.2, -1.1, 0.5]])         # velocities [m/s]
EDGES = [(0, 1, 0.8, 60.0, 2.0), (2, 0, 1.4, 10.0, 3.0), (0, 3, 0.9, 35.0, 0.5),
         (1, 2, 1.5, 25.0, 1.0), (3, 1, 0.7, 15.0, 4.0), (2, 3, 1.6, 45.0, 2.5)]                   # (i, j, rest, k, k_d)


def tetrahedron(lesson, d):
    """Positions, velocities and mesh of four points, one of them fixed, each joined to each, seen in d dimensions."""
    x, v = np.ascontiguousarray(TETRAHEDRON[:, :d]), np.ascontiguousarray(SWIRL[:, :d])
    return x, v, mesh_of(lesson, [2.0, 0.0, 0.5, 4.0], EDGES, np.zeros(d))


def lengths(x, mesh):
    return np.sqrt(np.sum((x[mesh.j] - x[mesh.i]) ** 2, axis=1))


@exercise("2.7", points=1, hint="T r/l on point i, −T r/l on j, added to what other springs left there; each spring has its own k")
def test_spring_forces_are_the_slope_of_the_elastic_energy(lesson):
    for d in (1, 2, 3):
        x, v, mesh = tetrahedron(lesson, d)
        expected = -slope(lambda x: 0.5 * np.sum(mesh.k * (lengths(x, mesh) - mesh.rest) ** 2), x)
        # l > 0.5 m: three springs at a point have f''' < 3 · 3k rest/l² < 3000 N/m², so H²/6 f''' < 1e-7
        force = lesson.spring_forces(x, 0.0 * v, mesh)
        close(f"forces of springs at rest in {d}D, minus the slope of Σ ½k(l − rest)² [N]", force, expected, 1e-7)


@exercise("2.7", points=1, hint="l̇ = r · (v_j − v_i)/l, and its k_d belongs to the same spring as its ends")
def test_dampers_are_the_slope_of_the_dissipation_and_let_a_mesh_turn_freely(lesson):
    for d in (1, 2, 3):
        x, v, mesh = tetrahedron(lesson, d)
        at_rest = lesson.spring_forces(x, 0.0 * v, mesh)

        def dissipation(v):
            return 0.5 * np.sum(mesh.k_d * ((lengths(x + H * v, mesh) - lengths(x - H * v, mesh)) / (2.0 * H)) ** 2)

        brake = lesson.spring_forces(x, v, mesh) - at_rest
        # quadratic in v, so a wide step costs nothing; the difference inside is good to H²/6 l''' v³ < 1e-9 of k_d v < 10 N
        close(f"forces of dampers in {d}D, minus ∂/∂v of Σ ½k_d l̇² [N]", brake, -slope(dissipation, v, 1.0), 1e-7)
        turn = np.diag(np.arange(1.0, d), 1) - np.diag(np.arange(1.0, d), -1)
        rigid = lesson.spring_forces(x, x @ turn + 2.0, mesh)
        close(f"forces on a mesh that flies and turns as a whole in {d}D [N]", rigid, at_rest, 1e-12)


@exercise("2.7", points=0.5, hint="whatever is added at i is taken from j, whether one of them is fixed or not")
def test_springs_push_nothing_from_outside(lesson):
    for d in (1, 2, 3):
        x, v, mesh = tetrahedron(lesson, d)
        force = lesson.spring_forces(x, v, mesh)
        close(f"sum of all forces in {d}D [N]", force.sum(axis=0), np.zeros(d), 1e-12)
        close(f"torque of all forces in {d}D [N m]", x.T @ force - force.T @ x, np.zeros((d, d)), 1e-12)


@exercise("2.7", points=0.5, hint="when the squared length is 0.0, raise BadInput before you divide by it")
def test_a_spring_without_length_is_refused(lesson):
    x, v, mesh = tetrahedron(lesson, 2)
    x[3] = x[1]
    raises("two ends in one place", BadInput, lesson.spring_forces, x, v, mesh)


@exercise("2.8", points=1, hint="gravity is an acceleration already, the air is a force: over the mass; a = 0 where inv_mass = 0")
def test_points_without_springs_fall_alike_drift_with_the_wind_and_stay_where_fixed(lesson):
    g, x, v = np.array([0.0, -9.81]), np.zeros((4, 2)), np.array([[0.0, 0.0], [1.0, 2.0], [0.0, 0.0], [-3.0, 1.0]])
    mass, inv_mass, free = np.array([[2.0], [0.5], [4.0]]), [0.5, 2.0, 0.0, 0.25], [0, 1, 3]
    a = lesson.mesh_acceleration(0.0, x, v, mesh_of(lesson, inv_mass, [], g))
    close("accelerations without air: g, and 0 where fixed [m/s²]", a, [g, g, [0.0, 0.0], g], 1e-13)

    wind, k_v = np.array([3.0, -1.0]), 0.4
    windy = mesh_of(lesson, inv_mass, [], g, wind, k_v)
    a = lesson.mesh_acceleration(0.0, x, 0.0 * v, windy)
    close("accelerations in the wind, from rest [m/s²]", a[free], g + wind / mass, 1e-13)
    v[free] = (mass * g + wind) / k_v
    a = lesson.mesh_acceleration(0.0, x, v, windy)
    close("accelerations at v = (mg + F_wind)/k_v, and where fixed [m/s²]", a, np.zeros((4, 2)), 1e-12)


@exercise("2.8", points=1, hint="each point's spring force times its own inv_mass: a light end gets faster than a heavy one")
def test_a_mesh_obeys_newton_and_a_weight_hangs_still(lesson):
    g, wind = np.array([0.0, -9.81]), np.array([3.0, 1.0])
    pair = mesh_of(lesson, [0.5, 2.0], [(0, 1, 1.0, 50.0, 2.0)], [0.0, 0.0])
    x, v = np.array([[0.0, 0.0], [1.2, 0.0]]), np.array([[0.0, 1.0], [3.0, 1.0]])          # 50 · 0.2 + 2 · 3 = 16 N
    a = lesson.mesh_acceleration(0.0, x, v, pair)
    close("accelerations of 2 kg and 0.5 kg, pulled by 16 N [m/s²]", a, [[8.0, 0.0], [-32.0, 0.0]], 1e-12)

    pull = 2.0 * g + wind
    hanging = mesh_of(lesson, [0.0, 0.5], [(1, 0, 1.0, 50.0, 2.0)], g, wind, 0.3)
    x = np.array([[0.0, 0.0], (1.0 / np.sqrt(pull @ pull) + 1.0 / 50.0) * pull])
    a = lesson.mesh_acceleration(0.0, x, np.zeros((2, 2)), hanging)
    close("accelerations of a weight that hangs still [m/s²]", a, np.zeros((2, 2)), 1e-12)


@exercise("2.9", points=1, hint="one of the steps of lesson 1 is just this: give it mesh_acceleration, and the mesh as p")
def test_the_lectures_loop_is_exact_in_free_fall_and_settles_where_the_weight_hangs(lesson):
    falling = mesh_of(lesson, [0.5, 0.0], [], [1.0, -9.81])
    x, v = np.zeros((2, 2)), np.array([[2.0, 3.0], [0.0, 0.0]])
    for n in range(10):
        x, v = lesson.mass_spring_damper_step(0.1 * n, x, v, 0.1, falling)
    close("x after 1 s of free fall from v = (2, 3) [m]; the other point is fixed", x, [[2.5, 3.0 - 0.5 * 9.81], [0.0, 0.0]], 1e-13)
    close("v after 1 s of free fall [m/s]", v, [[3.0, 3.0 - 9.81], [0.0, 0.0]], 1e-13)

    on_a_spring = mesh_of(lesson, [0.0, 2.0], [(0, 1, 1.0, 50.0, 2.0)], [0.0, -10.0], k_v=1.0)
    before = np.array([[0.0, 0.0], [0.0, -1.2]]), np.array([[0.0, 0.0], [0.0, -3.0]])
    kept = np.array(before)
    x, v = lesson.mass_spring_damper_step(0.0, *before, 0.1, on_a_spring)                  # a = −10 + (50 · 0.2 + 2 · 3 + 1 · 3)/m
    close("v after one step on a spring [m/s]: −3 + 0.1 · 28", v[1], [0.0, -0.2], 1e-13)
    close("x after that step [m]: −1.2 + 0.1 · (−3 − 0.2)/2", x[1], [0.0, -1.36], 1e-13)
    close("the x and v that were handed in: return new arrays", np.array(before), kept, 0.0)

    pull = 0.5 * np.array([0.0, -9.81]) + np.array([2.0, 0.5])
    hanging = mesh_of(lesson, [0.0, 2.0], [(0, 1, 1.0, 50.0, 5.0)], [0.0, -9.81], [2.0, 0.5], 2.0)
    x, v = np.array([[0.0, 0.0], [1.0, 0.0]]), np.zeros((2, 2))
    for n in range(1200):
        x, v = lesson.mass_spring_damper_step(0.01 * n, x, v, 0.01, hanging)
    # the slowest motion, a pendulum in viscous air, fades as exp(−k_v t/2m) = exp(−24) = 4e-11 in 12 s
    close("where a weight in the wind comes to rest [m]", x[1], (1.0 / np.sqrt(pull @ pull) + 1.0 / 50.0) * pull, 1e-9)
    close("where the fixed point still is [m]", x[0], [0.0, 0.0], 0.0)


# ---------------------------------------------------------------------------------------------- building a mesh

@exercise("2.10", points=1, hint="offsets outside, rows, then columns; number r · cols + c; check r + dr and c + dc separately")
def test_a_small_grid_has_its_threads_in_order_and_a_single_node_none(lesson):
    pairs = lesson.grid_pairs(2, 3, lesson.STRUCTURAL)
    close("pairs along the threads of 2 rows and 3 columns", pairs, [[0, 1], [1, 2], [3, 4], [4, 5], [0, 3], [1, 4], [2, 5]], 0.0)
    close("nodes counted by their first ends: pairs are integers", np.bincount(pairs[:, 0]), [2, 2, 1, 1, 1], 0.0)
    close("pairs across the meshes", lesson.grid_pairs(2, 3, lesson.SHEAR), [[0, 4], [1, 5], [1, 3], [2, 4]], 0.0)
    close("pairs of a single node", lesson.grid_pairs(1, 1, lesson.STRUCTURAL), np.zeros((0, 2)), 0.0)


@exercise("2.10", points=1, hint="a partner beyond the edge does not exist: it must not come round on the other side")
def test_a_large_grid_has_every_thread_diagonal_and_bend_once(lesson):
    rows, cols = 5, 7
    pairs = np.asarray(lesson.grid_pairs(rows, cols, lesson.STRUCTURAL + lesson.SHEAR + lesson.BEND))
    counts = [rows * (cols - 1), (rows - 1) * cols] + 2 * [(rows - 1) * (cols - 1)] + [rows * (cols - 2), (rows - 2) * cols]
    close("shape: one row for each pair", pairs.shape, [sum(counts), 2], 0.0)
    offsets = np.repeat([(0, 1), (1, 0), (1, 1), (1, -1), (0, 2), (2, 0)], counts, axis=0)
    nodes = np.stack([pairs // cols, pairs % cols], axis=2)                                # [pair, end] → row, column
    close("rows and columns from node to partner", nodes[:, 1] - nodes[:, 0], offsets, 0.0)
    close("pairs that are there twice", len(pairs) - len({(i, j) for i, j in pairs.tolist()}), 0.0, 0.0)
    close("nodes outside the grid", np.sum((pairs < 0) | (pairs >= rows * cols)), 0.0, 0.0)


# ---------------------------------------------------------------------------------------------- stiff meshes

@exercise("2.11", points=1, hint="n nᵀ is the outer product of r/l with itself; what is not along the spring is 1 − n nᵀ")
def test_stiffness_of_stretched_springs_is_the_slope_of_their_forces(lesson):
    for d in (1, 2, 3):
        x, v, mesh = tetrahedron(lesson, d)
        mesh = mesh._replace(rest=0.6 * lengths(x, mesh))
        K, D = lesson.spring_stiffness(x, mesh)
        for s, (i, j) in enumerate(zip(mesh.i, mesh.j)):
            def pull(r):
                return mesh.k[s] * (1.0 - mesh.rest[s] / np.sqrt(np.sum(r * r))) * r
            r = x[j] - x[i]
            # f''' < 9k/l² < 2000 N/m³: H²/6 f''' < 1e-7
            close(f"K of spring {s} in {d}D, slope of k(l − rest) r/l [N/m]", K[s], slope(pull, r), 1e-7)
            close(f"D of spring {s} in {d}D: k_d along the spring [N s/m]", D[s] @ r, mesh.k_d[s] * r, 1e-12)
            close(f"D of spring {s} in {d}D: nothing else [N s/m]", np.trace(D[s]), mesh.k_d[s], 1e-12)


@exercise("2.11", points=1, hint="max(0.0, 1 − rest/l) is zero for a compressed spring: only k n nᵀ remains")
def test_stiffness_of_a_compressed_spring_acts_along_it_only(lesson):
    for d in (2, 3):
        x, v, mesh = tetrahedron(lesson, d)
        mesh = mesh._replace(rest=1.5 * lengths(x, mesh))
        K, _ = lesson.spring_stiffness(x, mesh)
        for s, (i, j) in enumerate(zip(mesh.i, mesh.j)):
            r = x[j] - x[i]
            close(f"K along spring {s} in {d}D [N/m]", K[s] @ r, mesh.k[s] * r, 1e-12 * mesh.k[s])
            close(f"trace of K of spring {s} in {d}D: nothing across [N/m]", np.trace(K[s]), mesh.k[s], 1e-12 * mesh.k[s])
            close(f"K of spring {s} in {d}D: symmetric [N/m]", K[s] - K[s].T, np.zeros((d, d)), 1e-12 * mesh.k[s])


def times(y, A):
    return A @ y


@exercise("2.12", points=1, hint="sums run over all entries; begin with a copy of right; raise Diverged when the loop runs out")
def test_conjugate_gradients_solve_positive_systems_and_own_up_to_others(lesson):
    chain = 2.0 * np.eye(20) - np.eye(20, k=1) - np.eye(20, k=-1)                          # of springs, held at both ends
    load = np.ones((20, 1)) * np.array([1.0, -0.5])
    sag = 0.5 * load * (np.arange(1.0, 21.0) * np.arange(20.0, 0.0, -1.0))[:, None]        # a parabola
    right = load.copy()
    # |error| ≤ |A⁻¹| |residual| ≤ 1e-10 |right|/0.022 = 3e-8; steepest descent would need some 2000 rounds, and has 400
    close("sag of a loaded chain of 20", lesson.conjugate_gradients(times, chain, right), sag, 3e-8)
    close("the right-hand side that was handed in: copy it", right, load, 0.0)

    hilbert = 1.0 / (np.arange(7)[:, None] + np.arange(1, 8)[None, :])                     # condition 5e8: 9 rounds for 7 unknowns
    right = hilbert @ np.ones((7, 1))
    y = lesson.conjugate_gradients(times, hilbert, right.copy())
    # residual 1e-10 · |right| = 4e-10 by recursion, plus round-off of numbers below 10
    close("product of Hilbert's matrix with the solution", hilbert @ y, right, 5e-10)

    y = lesson.conjugate_gradients(times, chain, np.zeros((20, 2)))
    close("solution of a right-hand side of zeros", y, np.zeros((20, 2)), 0.0)
    turning = np.array([[1.0, 10.0], [-10.0, 1.0]])                                        # not symmetric: residuals grow
    raises("a matrix that is not symmetric", Diverged, lesson.conjugate_gradients, times, turning, np.ones((2, 1)))


def swaying(t, x, v, mesh):
    """Acceleration of a mesh whose gravity comes and goes as cos t, written without the lesson."""
    force = np.zeros_like(x)
    for s in range(mesh.i.size):
        r = x[mesh.j[s]] - x[mesh.i[s]]
        length = np.sqrt(np.sum(r * r))
        rate = np.sum(r * (v[mesh.j[s]] - v[mesh.i[s]])) / length
        pull = (mesh.k[s] * (length - mesh.rest[s]) + mesh.k_d[s] * rate) / length
        force[mesh.i[s]] += pull * r
        force[mesh.j[s]] -= pull * r
    for n in range(x.shape[0]):
        force[n] = (force[n] + mesh.wind - mesh.k_v * v[n]) * mesh.inv_mass[n]
        if mesh.inv_mass[n] > 0.0:
            force[n] += mesh.gravity * np.cos(t)
    return force


@exercise("2.13", points=1, hint="do not forget dt ∂F/∂x v on the right; the position moves with the new velocity")
def test_the_implicit_step_is_linearly_implicit_euler(lesson):
    t, dt, m, k, k_d, k_v = 0.8, 0.1, 0.5, 60.0, 2.0, 0.7
    weight = mesh_of(lesson, [0.0, 1.0 / m], [(0, 1, 1.0, k, k_d)], [-9.81], [1.5], k_v)
    before = np.array([[0.0], [1.3]]), np.array([[0.0], [-2.0]])
    kept = np.array(before)
    x, v = lesson.implicit_mesh_step(swaying, t, *before, dt, weight)
    steady = 1.0 + (1.5 - 9.81 * m * np.cos(t)) / k                                        # where the weight would hang
    # y⁺ = (1 − dt B)⁻¹ y around the place of rest; conjugate gradients of one unknown leave round-off
    B = np.array([[0.0, 1.0], [-k / m, -(k_d + k_v) / m]])
    expected = np.linalg.solve(np.eye(2) - dt * B, [1.3 - steady, -2.0]) + [steady, 0.0]
    close("x and v of a weight on one spring [m, m/s]", [x[1, 0], v[1, 0]], expected, 1e-12)
    close("the fixed end [m, m/s]", [x[0, 0], v[0, 0]], [0.0, 0.0], 0.0)
    close("the x and v that were handed in: return new arrays", np.array(before), kept, 0.0)

    x, v, mesh = tetrahedron(lesson, 2)
    mesh = mesh._replace(rest=0.6 * lengths(x, mesh), k_d=0.0 * mesh.k_d, k_v=k_v, gravity=np.array([0.3, -9.81]))
    v[1] = 0.0
    x_new, v_new = lesson.implicit_mesh_step(swaying, t, x, v, dt, mesh)
    by_x = slope(lambda x: swaying(t, x, v, mesh), x).reshape(8, 8).T
    by_v = slope(lambda v: swaying(t, x, v, mesh), v).reshape(8, 8).T
    right = dt * (swaying(t, x, v, mesh).ravel() + dt * by_x @ v.ravel())
    jump = np.linalg.solve(np.eye(8) - dt * by_v - dt * dt * by_x, right).reshape(4, 2)
    # |Δv| < 20 m/s: conjugate gradients to 1e-10 of it times condition < 10, slopes to 1e-7/k < 1e-8
    close("v of a stretched mesh, against a dense solution [m/s]", v_new, v + jump, 2e-7)
    close("x of that mesh [m]", x_new, x + dt * v_new, 1e-14)


@exercise("2.13", points=0.5, hint="in the matrix: blocks dt² K + dt D; on its diagonal m + dt k_v, 0 for a fixed point")
def test_the_implicit_step_brings_a_stiff_spring_to_rest_without_gaining_energy(lesson):
    m, k, g, dt = 1.0, 1e8, 9.81, 1.0 / 60.0                                               # ω dt = 167: explicit steps end at 2
    stiff = mesh_of(lesson, [0.0, 1.0 / m], [(0, 1, 1.0, k, 0.0)], [0.0, -g])
    x, v = np.array([[0.0, 0.0], [0.0, -1.1]]), np.array([[0.0, 0.0], [0.0, -5.0]])

    def energy():
        return 0.5 * m * v[1] @ v[1] + 0.5 * k * (-x[1, 1] - 1.0) ** 2 + m * g * x[1, 1]

    last, highest = energy(), 0.0
    for _ in range(20):
        x, v = lesson.implicit_mesh_step(swaying, 0.0, x, v, dt, stiff)
        now = energy()
        highest, last = max(highest, now - last), now
    close("largest gain of energy in a step [J]", highest, 0.0, 1e-10)                     # round-off of 10 J
    # each step shrinks the swing by ω dt; what stays is round-off of the length, 1 m
    close("extension in the end: mg/k [m]", -x[1, 1] - 1.0, m * g / k, 1e-14)
    close("place beside the vertical, speed [m, m/s]", [x[1, 0], v[1, 0], v[1, 1]], np.zeros(3), 1e-12)


@exercise("2.13", points=0.5, hint="M a on the right: each point's mass times its acceleration, all taken at t, x, v")
def test_the_implicit_step_keeps_momentum_and_is_of_first_order(lesson):
    x, v, mesh = tetrahedron(lesson, 2)
    mass, dt = np.array([0.5, 2.0, 1.0, 0.25]), 0.05
    free = mesh._replace(inv_mass=1.0 / mass, gravity=np.array([0.2, -9.81]), wind=np.array([1.0, 2.0]))
    _, v_new = lesson.implicit_mesh_step(swaying, 0.0, x, v, dt, free)
    # what conjugate gradients leave over: 1e-10 of dt F, F < 500 N in all
    impulse = dt * (mass.sum() * free.gravity + 4.0 * free.wind)
    close("change of momentum [N s]: (Σ m g + 4 F_wind) dt", mass @ (v_new - v), impulse, 1e-8)

    end = swaying_truth(x, v, free)
    errors = []
    for n in (80, 160, 320):
        y, w = x, v
        for step in range(n):
            y, w = lesson.implicit_mesh_step(swaying, 0.4 + 0.1 / n * step, y, w, 0.1 / n, free)
        errors.append(max(np.abs(y - end[0]).max(), np.abs(w - end[1]).max()))
    order = np.log2(np.array(errors[:-1]) / errors[1:])
    # nothing is faster than the lightest point, √(Σk/m) < 20/s, Σk_d/m < 30/s: 30 dt < 0.04 moves an order as little
    between("order of convergence over dt = 1/800 … 1/3200 s", order.mean(), 0.9, 1.1)


def swaying_truth(x, v, mesh):
    """x and v of the swaying mesh, 0.1 s after t = 0.4 s, by DOP853 at its tightest tolerance."""
    from scipy.integrate import solve_ivp
    start = np.stack([x, v])

    def slopes(t, y):
        x, v = y.reshape(start.shape)
        return np.stack([v, swaying(t, x, v, mesh)]).ravel()

    return solve_ivp(slopes, (0.4, 0.5), start.ravel(), method="DOP853", rtol=3e-14, atol=1e-14).y[:, -1].reshape(start.shape)
