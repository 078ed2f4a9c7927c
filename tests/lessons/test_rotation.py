"""Lesson 5: bodies turn as Rodrigues and Euler say, keep L and energy as promised, and flip when theory says."""

import itertools
from typing import NamedTuple

import numpy as np
import pytest

from solutions.checks import BadInput, Diverged
from validate.grading.expect import between, choice, close, raises, truth
from validate.reference import choices
from validate.reference import orientation as orientations
from validate.reference.choices.rotation import BRICK, SPIN
from validate.reference.rotation import freely

exercise = pytest.mark.exercise
EXACT = 1e-12                # a few dozen operations, each with a round-off of 1e-16, on numbers below 100


def orientation(draw):
    """A drawn unit quaternion; before normalisation it is far from 0."""
    q = np.concatenate((draw(0.3, 1.0, 1), draw(-1.0, 1.0, 3)))
    return q / np.linalg.norm(q)


def about(phi):
    """The matrix of a rotation about φ/|φ| by |φ|."""
    angle = np.linalg.norm(phi)
    return orientations.about(phi / angle, angle) if angle > 0.0 else np.eye(3)


def unit_of(y):
    return y / np.linalg.norm(y)


def turn(q):
    """The matrix of a quaternion (w, 𝐪) of any length: a rotation by 2 atan(|𝐪|/w) about 𝐪."""
    return orientations.quaternion_matrix(*(float(q[k]) for k in range(4)))


def moments(draw):
    """Possible principal moments [kg m²] between 1.7 and 4.2, smallest first, no two closer than 0.2."""
    a, b, c = draw(2.0, 2.5), draw(1.2, 1.7), draw(0.5, 1.0)             # Σ m x², Σ m y², Σ m z²
    return np.array([b + c, a + c, a + b])


def spin_of(draw):
    """A drawn angular velocity [rad/s]; the magnitude of each component is between 0.5 and 1.5."""
    return draw(0.5, 1.5, 3) * np.where(draw(-1.0, 1.0, 3) < 0.0, -1.0, 1.0)


SIZES = (1.0, 1e-30, 1e30)   # of vectors: a limit such as 1e-9 shows at one of them
SLOW = (0.03, 1e-4, 1e-7, 1e-9)      # angles of a small turn [rad]; each effect is above EXACT

STILL = np.array([1.0, 0.0, 0.0, 0.0])                               # no rotation


def orientation_of_few(draw):
    """A drawn unit quaternion, some components of which are exactly 0."""
    q = draw.sparse(-1.0, 1.0, 4)
    q[draw.whole(0, 3)] = 1.0
    return unit_of(q)


def round_bodies(draw, flat=False):
    """Moments [kg m²] of three bodies with two equal ones, rods or flat discs, and of a ball."""
    across, along = draw(2.0, 3.0), draw(3.3, 3.9) if flat else draw(1.0, 1.8)
    return *np.where(np.eye(3) > 0.0, along, across), np.full(3, across)


def nearly_round(draw):
    """Moments [kg m²] that differ by one part in 10,000, in a drawn order."""
    return draw(2.0, 3.0) * np.roll([1.0, 1.0001, 1.0002], draw.whole(0, 2))


def few(draw, size):
    """Vectors with components that are exactly 0, and 0 itself."""
    return *draw.sparse(-size, size, (3, 3)), np.zeros(3)


def one_at_zero(vectors):
    """Copies (n, n, 3) of these n vectors; in each, another one is 0."""
    return np.where(np.eye(len(vectors))[:, :, None] > 0.0, 0.0, vectors)


def third_way(omega, dt):
    """The matrix of the quaternion (1, ½dt ω)."""
    return turn(np.concatenate(([1.0], 0.5 * dt * omega)))


def inertia(q, I_body):
    """The matrix R I_body Rᵀ."""
    R = turn(q)
    return R @ np.diag(I_body) @ R.T


# ---------------------------------------------------------------------------------------------- rotational movement

@exercise("5.1", points=1, hint="the first row gives the x component of a × b, a_y b_z − a_z b_y: (0, −a_z, a_y)")
def test_a_skew_matrix_multiplies_like_a_cross_product(lesson, draw):
    b = draw(-2.0, 2.0, 3)
    for a in (draw(-2.0, 2.0, 3), *few(draw, 2.0)):
        matrix = lesson.skew(a)
        close("a* b − a × b", np.asarray(matrix) @ b - np.cross(a, b), np.zeros(3), EXACT, given=f"a = {a}, b = {b}")
        close("a* e for the three axes e, as columns", matrix, np.cross(a, np.eye(3)).T, EXACT, given=f"a = {a}")
        for size in SIZES[1:]:
            close("a* e for the three axes e, over the size of a", np.asarray(lesson.skew(size * a)) / size,
                  np.cross(a, np.eye(3)).T, EXACT, given=f"a = {size * a}")


@exercise("5.2", points=0.5, hint="the point moves with v, plus ω × r because the body rotates, in this order")
def test_a_point_moves_as_the_body_carries_it(lesson, draw):
    general = np.array([draw(-2.0, 2.0, 3), draw(-2.0, 2.0, 3), draw(-1.0, 1.0, 3)])
    h = 1e-4
    for v, omega, r in (general, *one_at_zero(general), *draw.sparse(-1.0, 1.0, (3, 3, 3))):
        before, after = (s * h * v + about(s * h * omega) @ r for s in (-1.0, 1.0))
        # h²/6 |ω|³ |r| < 1e-8/6 · 42 · 1.8 = 1.3e-7
        close("velocity of the point [m/s]", lesson.point_velocity(v, omega, r), (after - before) / (2.0 * h), 2e-7,
              given=f"v = {v}, ω = {omega}, r = {r}")
    v, omega, r = general
    for size in SIZES:
        for moving, turning, arm in ((size * v, 0.0 * omega, r), (0.0 * v, size * omega, r), (0.0 * v, omega, size * r),
                                     (size * v, size * omega, r)):
            close("velocity of the point over the size of v, ω or r [m/s]",
                  np.asarray(lesson.point_velocity(moving, turning, arm)) / size,
                  moving / size + np.cross(turning / size, arm), EXACT,
                  given=f"v = {moving}, ω = {turning}, r = {arm}")


@exercise("5.3", points=1,
          hint="each force adds fᵢ to F and (pᵢ − x) × fᵢ to τ, in this order; x is the centre of mass")
def test_forces_add_up_to_a_force_and_a_torque(lesson, draw):
    many = draw.whole(8, 12)
    x = draw(-1.0, 1.0, 3)
    points, forces = draw(-2.0, 2.0, (many, 3)), draw(-5.0, 5.0, (many, 3))
    kept = points.copy(), forces.copy()
    F, tau = lesson.total_load(x, points, forces)
    close("total force [N]", F, forces.sum(axis=0), EXACT)
    close("torque about the centre of mass [N m]", tau, np.cross(points - x, forces).sum(axis=0), EXACT)
    close("input points and forces after the call: unchanged", np.array((points, forces)), np.array(kept), 0.0)
    F, tau = lesson.total_load(x, points[:2], np.array([forces[0], -forces[0]]))
    close("total force of a couple [N]", F, np.zeros(3), EXACT)
    close("torque of a couple [N m], about any point", tau, np.cross(points[0] - points[1], forces[0]), EXACT)
    F, tau = lesson.total_load(x, points[:1] * 0.0 + x, forces[:1])
    close("torque of a force at the centre of mass [N m]", tau, np.zeros(3), EXACT)
    for size in SIZES[1:]:
        for far, strong in ((size, 1.0), (1.0, size)):
            F, tau = lesson.total_load(far * x, far * points, strong * forces)
            close("total force over the size of the forces [N]", np.asarray(F) / strong, forces.sum(axis=0), EXACT)
            close("torque over the size of points and forces [N m]", np.asarray(tau) / far / strong,
                  np.cross(points - x, forces).sum(axis=0), EXACT)
    for n in (1, 1, 2, 7):
        x, points, forces = draw.sparse(-1.0, 1.0, 3), draw.sparse(-2.0, 2.0, (n, 3)), draw.sparse(-5.0, 5.0, (n, 3))
        forces[:n // 2] = 0.0
        F, tau = lesson.total_load(x, points, forces)
        close("total force, where some forces are 0 [N]", F, forces.sum(axis=0), EXACT)
        close("torque, where some forces are 0 [N m]", tau, np.cross(points - x, forces).sum(axis=0), EXACT)
    x, points, forces = draw(-1.0, 1.0, 3), draw(-2.0, 2.0, (4, 3)), draw(-5.0, 5.0, (4, 3))
    points[draw.whole(0, 2)] = x                                         # the others still have a torque
    F, tau = lesson.total_load(x, points, forces)
    given = f"x = {x}, points {points.tolist()}, forces {forces.tolist()}"
    close("total force, where one force acts at the centre of mass [N]", F, forces.sum(axis=0), EXACT, given=given)
    close("torque, where one force acts at the centre of mass [N m]", tau, np.cross(points - x, forces).sum(axis=0),
          EXACT, given=given)
    F, tau = lesson.total_load(x, points[:0], forces[:0])
    close("total force of no forces [N]", F, np.zeros(3), 0.0)
    close("torque of no forces [N m]", tau, np.zeros(3), 0.0)


@exercise("5.4", points=1,
          hint="Rᵀ transforms L to body coordinates; divide there by I_body, entry by entry; R transforms back")
def test_angular_momentum_gives_back_the_angular_velocity(lesson, draw):
    q, I_body, omega = orientation(draw), moments(draw), draw(-3.0, 3.0, 3)
    L = inertia(q, I_body) @ omega
    got = lesson.angular_velocity(turn(q), L, I_body)
    close("ω of a body with L = I ω [rad/s]", got, omega, EXACT, given=f"ω = {omega}, I_body = {I_body}")
    for size in SIZES[1:]:
        given = f"L = {size * L}, I_body = {I_body}"
        small = np.asarray(lesson.angular_velocity(turn(q), size * L, I_body)) / size
        close("ω of a body with a very small or large L, over its size [rad/s]", small, omega, EXACT, given=given)
        close("ω of a body with very small or large moments and L [rad/s]",
              lesson.angular_velocity(turn(q), size * L, size * I_body), omega, EXACT, given=given)
    close("ω about a principal axis: along it [rad/s]",
          lesson.angular_velocity(np.eye(3), np.array([0.0, 2.0 * I_body[1], 0.0]), I_body), [0.0, 2.0, 0.0], EXACT)
    for I_body in round_bodies(draw):
        for q in (orientation(draw), orientation_of_few(draw)):
            for omega in few(draw, 3.0):
                close("ω of a body with equal moments [rad/s]",
                      lesson.angular_velocity(turn(q), inertia(q, I_body) @ omega, I_body), omega, EXACT,
                      given=f"ω = {omega}, I_body = {I_body}")


@exercise("5.5", points=1,
          hint="ẋ is P over the mass, and Ṙ is skew(ω) R; the other two are F and τ")
def test_the_state_changes_as_newton_and_euler_say(lesson, draw):
    h, m = 1e-4, draw(1.0, 3.0)
    general = np.array([draw(-1.0, 1.0, 3), draw(-2.0, 2.0, 3), spin_of(draw), draw(-2.0, 2.0, 3), draw(-2.0, 2.0, 3)])
    for q, I_body in ((orientation(draw), moments(draw)), (STILL, round_bodies(draw)[0])):
        for x, P, omega, F, tau in (general, *one_at_zero(general), np.zeros((5, 3)),
                                    *draw.sparse(-1.0, 1.0, (2, 5, 3))):
            S, R = lesson.RigidBodyState(x, turn(q), P, inertia(q, I_body) @ omega), turn(q)
            light, heavy = (lesson.state_derivative(S, F, tau, lesson.RigidBody(share * m, I_body))[0]
                            for share in (0.1, 10.0))
            x_rate, R_rate, P_rate, L_rate = lesson.state_derivative(S, F, tau, lesson.RigidBody(m, I_body))
            before, after = (about(s * h * omega) @ R for s in (-1.0, 1.0))
            close("ẋ of a body a tenth, once and ten times as heavy [m/s]", [light, x_rate, heavy],
                  [10.0 * P / m, P / m, 0.1 * P / m], EXACT * 10.0)
            # h²/6 |ω|³ < 1e-8/6 · 18
            close("Ṙ: rate of change of the body's axes [1/s]", R_rate, (after - before) / (2.0 * h), 5e-8,
                  given=f"ω = {omega}")
            close("Ṗ [N]", P_rate, F, 0.0)
            close("L̇ [N m]", L_rate, tau, 0.0)
    x, P, omega, F, tau = general
    for size in SIZES[1:]:
        S = lesson.RigidBodyState(x, turn(q), P, inertia(q, I_body) @ omega)
        body = lesson.RigidBody(size * m, size * I_body)
        got = lesson.state_derivative(S, F, tau, body)
        given = f"m = {size * m}, I_body = {size * I_body}, P = {P}, ω I = {S.L}"
        close("ẋ times the size of the mass [m/s]", size * np.asarray(got[0]), P / m, EXACT, given=given)
        close("Ṙ times the size of the moments [1/s]", size * np.asarray(got[1]), np.cross(omega, turn(q).T).T, EXACT,
              given=given)


# ---------------------------------------------------------------------------------------------- three rotation updates

@exercise("5.6", points=1,
          hint="first R + dt ω* R; then its columns: the first to length 1, the second perpendicular "
               "to the first, the third by a cross product")
def test_the_matrix_update_keeps_a_matrix_orthonormal(lesson, draw):
    general, dt = turn(orientation(draw)), draw(0.1, 0.4)
    kept = general.copy()
    for R in (general, np.eye(3)):
        for omega in (spin_of(draw), *few(draw, 1.5)):
            got = np.asarray(lesson.matrix_update(R, omega, dt))
            Q, upper = np.linalg.qr(R + dt * np.cross(omega, R.T).T)
            close("orientation, compared with a QR factorisation of R + dt ω* R", got, Q * np.sign(np.diag(upper)),
                  EXACT, given=f"ω = {omega}, dt = {dt}")
            close("R Rᵀ of the result", got @ got.T, np.eye(3), EXACT)
    # Columns that have drifted: neither of length 1 nor perpendicular, also for a body at rest.
    drifted = general + draw(-0.1, 0.1, (3, 3))
    for R in (general, drifted):
        for omega in (np.zeros(3), *(angle / dt * unit_of(spin_of(draw)) for angle in (*SLOW, -SLOW[0]))):
            for step in (dt, -dt):
                Q, upper = np.linalg.qr(R + step * np.cross(omega, R.T).T)
                Q = Q * np.sign(np.diag(upper))
                Q[:, 2] = np.cross(Q[:, 0], Q[:, 1])
                close("orientation after a small turn, compared with a QR factorisation",
                      lesson.matrix_update(R, omega, step), Q, EXACT,
                      given=f"R = {R.tolist()}, ω = {omega}, dt = {step}")
    close("input R after the call: unchanged", general, kept, 0.0)
    close("orientation at ω = 0", lesson.matrix_update(general, np.zeros(3), dt), general, EXACT)


@exercise("5.7", points=0.5,
          hint="Rodrigues: r cos θ + (n × r) sin θ + n (n·r)(1 − cos θ), for each column "
               "separately; test for |ω| = 0 before dividing")
def test_the_axis_angle_update_is_exact_at_constant_omega(lesson, draw):
    R, omega, dt = turn(orientation(draw)), spin_of(draw), draw(0.5, 3.0)
    kept = R.copy()
    got = lesson.axis_angle_update(R, omega, dt)
    close("orientation after dt", got, about(dt * omega) @ R, EXACT, given=f"ω = {omega}, dt = {dt}")
    close("input R after the call: unchanged", R, kept, 0.0)
    back = lesson.axis_angle_update(np.asarray(got, dtype=float), omega, -dt)
    close("orientation after dt and −dt: back", back, R, EXACT)
    still = lesson.axis_angle_update(R, np.zeros(3), dt)
    close("orientation at ω = 0: that of R", still, R, 0.0)
    truth("whether this is the array that was handed in: orientation at ω = 0",
          np.shares_memory(np.asarray(still), R), False)
    for R in (turn(orientation(draw)), np.eye(3)):
        for omega in few(draw, 1.5):
            close("orientation after dt, where components of ω are 0", lesson.axis_angle_update(R, omega, dt),
                  about(dt * omega) @ R, EXACT, given=f"ω = {omega}, dt = {dt}")


@exercise("5.7", points=0.5,
          hint="the body is at rest only if |ω| = 0; use the whole angle in sin θ and cos θ, also beyond one turn, for "
               "dt < 0 and for a small turn")
def test_the_axis_angle_update_turns_by_any_angle_at_any_rate(lesson, draw):
    """The angle |ω| dt is below 30 and has a relative error of 1e-16."""
    for quarter in (0, 1, 2, 3, 4, 7, 15):
        for rate in (1.0, 1e-4, 1e-12, 1e6):
            R = turn(orientation(draw))
            n = unit_of(draw(-1.0, 1.0, 3))
            angle = 0.5 * np.pi * (quarter + draw(0.1, 0.9))
            for side in (1.0, -1.0):
                got = lesson.axis_angle_update(R, rate * n, side * angle / rate)
                close("orientation after dt", got, about(side * angle * n) @ R, EXACT,
                      given=f"ω = {rate * n} rad/s, dt = {side * angle / rate} s")
    for angle in SLOW:                                                   # a small turn is a turn
        R, n, rate = turn(orientation(draw)), unit_of(spin_of(draw)), draw(0.5, 2.0)
        close("orientation after a small turn", lesson.axis_angle_update(R, rate * n, angle / rate),
              about(angle * n) @ R, EXACT, given=f"ω = {rate * n} rad/s, dt = {angle / rate} s")


def pauli(q):
    """A quaternion as a complex (2, 2) matrix: matrix products are quaternion products."""
    w, x, y, z = q
    return np.array([[w - 1j * z, -y - 1j * x], [y - 1j * x, w + 1j * z]])


@exercise("5.8", points=1, hint="scalar: a₀b₀ − 𝐚·𝐛; vector: a₀𝐛 + b₀𝐚 + 𝐚×𝐛; i j = k, but j i = −k")
def test_quaternions_multiply_like_paulis_matrices(lesson, draw):
    pairs = np.concatenate((draw(-2.0, 2.0, (10, 2, 4)), draw.sparse(-2.0, 2.0, (6, 2, 4))))
    # Two pairs have no scalar part: the scalar part of the product is −𝐚·𝐛, of either sign.
    pairs[:2, :, 0] = 0.0
    pairs[1, 1] = pairs[1, 0]
    # Two have a factor without a vector part, and two a factor 0.
    pairs[8, 0, 1:], pairs[9, 1, 1:], pairs[10, 0], pairs[11, 1] = 0.0, 0.0, 0.0, 0.0
    # Small and large ones too: a factor below 1e-9 is not 0.
    pairs = np.concatenate((pairs, [[size * pairs[2, 0], pairs[2, 1] / size] for size in SIZES[1:]]))
    for a, b in pairs:
        expected = pauli(a) @ pauli(b)
        got = np.asarray(lesson.quaternion_product(a, b))
        close("the product of two quaternions", got,
              [expected[0, 0].real, -expected[0, 1].imag, expected[1, 0].real, -expected[0, 0].imag], EXACT,
              given=f"a = {a}, b = {b}")
        close("|a b| − |a| |b|", np.linalg.norm(got) - np.linalg.norm(a) * np.linalg.norm(b), 0.0, EXACT)


def small_and_half_turn(draw, angle):
    """The parts (w, 𝐪) of two unit quaternions: a turn by twice this small angle, and by π less than that."""
    n, c, s = unit_of(spin_of(draw)), np.cos(angle), np.sin(angle)
    return ([c], s * n), ([s], c * n)


@exercise("5.9", points=1,
          hint="the terms with w have opposite signs across the diagonal: 2(xy − wz) above it, 2(xy + wz) below")
def test_a_quaternion_turns_as_its_matrix_does(lesson, draw):
    half_turn = np.concatenate(([0.0], unit_of(draw(-1.0, 1.0, 3))))
    for q in (orientation(draw), half_turn, *np.eye(4), orientation_of_few(draw), orientation_of_few(draw),
              *(np.concatenate(pair) for angle in SLOW for pair in small_and_half_turn(draw, angle))):
        close("matrix of the quaternion", lesson.rotation_matrix(q), turn(q), EXACT, given=f"q = {q}")
        close("matrix of its negative: the same", lesson.rotation_matrix(-q), turn(q), EXACT)
    half = np.sqrt(0.5)
    close("x axis after a quarter turn about z",
          np.asarray(lesson.rotation_matrix(np.array([half, 0.0, 0.0, half])))[:, 0], [0.0, 1.0, 0.0], EXACT)


@exercise("5.10", points=0.75,
          hint="the product (0, ω) q, with ω on the left because it is in world "
               "coordinates; times ½ dt; then normalise")
def test_the_quaternion_update_turns_about_omega_by_twice_an_arc_tangent(lesson, draw):
    general, dt = orientation(draw), draw(0.1, 0.5)
    kept = general.copy()
    for q in (general, STILL, orientation_of_few(draw)):
        for omega in (spin_of(draw), *few(draw, 1.5)):
            got = lesson.quaternion_update(q, omega, dt)
            close("length of the new quaternion", np.linalg.norm(got), 1.0, EXACT)
            close("orientation after dt, as a matrix", turn(got), third_way(omega, dt) @ turn(q), EXACT,
                  given=f"ω = {omega}, dt = {dt}")
            close("orientation after dt and −dt: back, as a matrix",
                  turn(lesson.quaternion_update(np.asarray(got, dtype=float), omega, -dt)), turn(q), EXACT)
    for angle in (*SLOW, 5.0, 40.0):
        omega, step = draw(0.5, 2.0) * unit_of(spin_of(draw)), draw(0.1, 5.0)
        omega = angle / step * unit_of(omega)
        got = lesson.quaternion_update((1.0 + 5e-10) * general, omega, step)
        close("length of the new quaternion if the old one is too long by 5e-10", np.linalg.norm(got), 1.0, EXACT)
        close("orientation after a small or large turn, as a matrix", turn(got), third_way(omega, step) @ turn(general),
              EXACT, given=f"q = {general}, ω = {omega}, dt = {step}")
    close("length of the quaternion of a body at rest, if the old one is too long by 5e-10",
          np.linalg.norm(lesson.quaternion_update((1.0 + 5e-10) * general, np.zeros(3), dt)), 1.0, EXACT)
    close("input q after the call: unchanged", general, kept, 0.0)


@exercise("5.10", points=0.25, hint="normalise with unit: it raises BadInput for a quaternion of length zero")
def test_a_quaternion_of_length_zero_is_refused(lesson, draw):
    q, omega = orientation(draw), spin_of(draw)
    close("orientation after 0.1 s, for a q that is not zero", turn(lesson.quaternion_update(q, omega, 0.1)),
          third_way(omega, 0.1) @ turn(q), EXACT, given=f"q = {q}, ω = {omega}")
    raises("q = 0", BadInput, lesson.quaternion_update, np.zeros(4), omega, 0.1)
    raises("q = 0 and ω = 0", BadInput, lesson.quaternion_update, np.zeros(4), np.zeros(3), 0.1)


# ---------------------------------------------------------------------------------------------- the lecture's loop

@exercise("5.11", points=1,
          hint="compute τ, ω and Iω = I_body ω in body coordinates; the "
               "gyroscopic term has a minus sign; rotate the result back")
def test_a_body_speeds_up_as_eulers_equations_say(lesson, draw):
    q = orientation(draw)
    I_body = moments(draw)
    omega, tau = draw(-3.0, 3.0, 3), draw(-2.0, 2.0, 3)
    I = inertia(q, I_body)
    got = lesson.angular_acceleration(q, omega, tau, I_body)
    close("ω̇ [rad/s²]", got, np.linalg.solve(I, tau - np.cross(omega, I @ omega)), EXACT,
          given=f"q = {q}, ω = {omega}, τ = {tau}, I_body = {I_body}")
    along = 2.0 * turn(q)[:, 1]
    small = lesson.angular_acceleration(q, 1e-6 * omega, 1e-12 * tau, I_body)
    close("ω̇ with ω a million and τ a trillion times smaller [1e-12 rad/s²]", 1e12 * np.asarray(small),
          np.asarray(got), EXACT * 10.0)
    close("ω̇ about a principal axis, without torque [rad/s²]",
          lesson.angular_acceleration(q, along, np.zeros(3), I_body), np.zeros(3), EXACT)
    close("ω̇ of a ball [rad/s²]: τ/I", lesson.angular_acceleration(q, omega, tau, 2.0 * np.ones(3)), 0.5 * tau, EXACT)
    simple = *one_at_zero(np.array([omega, tau])), *draw.sparse(-2.0, 2.0, (2, 2, 3))
    for size in SIZES[1:]:
        close("ω̇ of a body with very small or large moments and torque [rad/s²]",
              lesson.angular_acceleration(q, omega, size * tau, size * I_body), got, EXACT * 10.0)
    for some in (I_body, nearly_round(draw), *round_bodies(draw)):
        for r in (q, STILL):
            I = inertia(r, some)
            for omega, tau in simple:
                close("ω̇ where some components are 0, or some moments equal [rad/s²]",
                      lesson.angular_acceleration(r, omega, tau, some),
                      np.linalg.solve(I, tau - np.cross(omega, I @ omega)), EXACT,
                      given=f"q = {r}, ω = {omega}, τ = {tau}, I_body = {some}")


class Driven(NamedTuple):
    """A record with more fields than the step needs."""
    m: float             # [kg]
    I_body: np.ndarray   # (3,) [kg m²]
    push: float          # factor of the load [-]


def swirling_load(t, x, q, v, omega, body):
    """A force and a torque that depend on all arguments, so that an outdated one is detected."""
    F = body.m * body.push * np.array([np.cos(t) - v[0], x[2] - x[0], 1.0 - q[1]])
    return F, body.I_body[0] * np.array([x[1] - omega[0], v[1] + q[0], np.sin(t) - omega[2]])


def check_one_step(lesson, load, t, state, dt, body):
    x, q, v, omega = state
    kept = [a.copy() for a in state]
    x_new, q_new, v_new, omega_new = lesson.rigid_body_step(load, t, x, q, v, omega, dt, body)
    F, tau = load(t, x, q, v, omega, body)
    I = inertia(q, body.I_body)
    faster = v + dt * F / body.m
    turned = omega + dt * np.linalg.solve(I, tau - np.cross(omega, I @ omega))
    given = f"v = {v}, ω = {omega}, F = {F}, τ = {tau}"
    close("v after one step [m/s]", v_new, faster, EXACT, given=given)
    close("x after one step [m]", x_new, x + dt * faster, EXACT, given=given)
    close("ω after one step [rad/s]", omega_new, turned, EXACT, given=given)
    close("length of q after one step", np.linalg.norm(q_new), 1.0, EXACT, given=given)
    close("orientation after one step, as a matrix", turn(q_new), third_way(turned, dt) @ turn(q), EXACT, given=given)
    close("input state after the call: return new arrays", np.concatenate((x, q, v, omega)), np.concatenate(kept), 0.0)


def unloaded(t, x, q, v, omega, body):
    return np.zeros(3), np.zeros(3)


@exercise("5.12", points=0.5,
          hint="evaluate load at the old state, divide F by m; update v and ω; then x and q with the new v and ω")
def test_one_step_of_the_loop_is_velocities_first(lesson, draw):
    for size in (0.01, 1.0, 100.0, 1e-30, 1e30):
        m, I_body = size * draw(1.0, 3.0), size * moments(draw)
        state = draw(-1.0, 1.0, 3), orientation(draw), draw(-1.0, 1.0, 3), spin_of(draw)
        check_one_step(lesson, swirling_load, draw(0.5, 1.5), state, draw(0.1, 0.3), Driven(m, I_body, draw(0.5, 2.0)))
    for pace, dt in ((1.0, draw(2.0, 9.0)), (1.0, -draw(0.1, 0.3)),          # long, and backwards in time
                     (1e-4, draw(0.1, 0.3)), (1e-7, draw(0.1, 0.3))):        # slow
        state = draw(-1.0, 1.0, 3), orientation(draw), pace * draw(-1.0, 1.0, 3), pace * spin_of(draw)
        check_one_step(lesson, unloaded, draw(0.5, 1.5), state, dt, Driven(draw(1.0, 3.0), moments(draw), 1.0))
    general = draw(-1.0, 1.0, (3, 3))
    for x, v, omega in (*one_at_zero(general), *draw.sparse(-1.0, 1.0, (2, 3, 3)), np.zeros((3, 3))):
        for q, I_body in ((orientation(draw), moments(draw)), (STILL, round_bodies(draw)[2])):
            for load in (swirling_load, unloaded):
                state, body = (x, q, v, omega), Driven(draw(1.0, 3.0), I_body, 1.0)
                check_one_step(lesson, load, draw.sparse(0.5, 1.5), state, draw(0.1, 0.3), body)


@exercise("5.12", points=0.5,
          hint="does q turn with the new ω? Is the gyroscopic term there although there is no torque?")
def test_the_loop_converges_to_the_free_motion_of_a_body(lesson, draw):
    q = orientation(draw)
    I_body = moments(draw)
    omega = spin_of(draw)
    v = draw(-1.0, 1.0, 3)
    T = 1.0
    truth, _ = freely(turn(q), turn(q).T @ omega, I_body, T)
    body = lesson.RigidBody(2.0, I_body)
    found = {}
    for n in (100, 200):
        x, q_end, _, _ = lesson.advance_rigid_body(lesson.rigid_body_step, unloaded, 0.0, np.zeros(3), q, v, omega,
                                                   T / n, n, body)
        # Local error ½dt² of |ω̈| and |ω̇| |ω|, which are below 2.6² + 2.6³ = 24: 12 dt after 1 s, growing by e^2.6 = 13.
        close("orientation after a second, as a matrix", turn(q_end), truth, 160.0 / n)
        close("x after a second: moved by v [m]", x, T * v, EXACT)
        found[n] = turn(q_end)
    # First order: half the step, half the error, also in a draw that leaves little of it.  What is of second order
    # remains, about |ω|³ dt²/6 < 3e-4; it was below 5e-5 in 1,200 draws.
    close("twice the orientation of 200 steps less that of 100, as a matrix: the error of first order cancels",
          2.0 * found[200] - found[100], truth, 3e-4)


@exercise("5.13", points=0.5, hint="½ Σ Lₖ²/Iₖ over the components of L in body coordinates: unrotate L first")
def test_kinetic_energy_is_that_of_omega(lesson, draw):
    for I_body in (moments(draw), *round_bodies(draw)):
        for q in (orientation(draw), STILL):
            for omega in (draw(-3.0, 3.0, 3), *few(draw, 3.0)):
                I = inertia(q, I_body)
                close("rotational energy [J]", lesson.kinetic_energy(q, I @ omega, I_body), 0.5 * omega @ I @ omega,
                      1e-11, given=f"ω = {omega}, I_body = {I_body}")
                for size in SIZES[1:]:
                    for heavy, L in ((1.0, size * I @ omega), (size, size * I @ omega)):
                        close("rotational energy over the size of L or of the body [J]",
                              lesson.kinetic_energy(q, L, heavy * I_body) / size / (size / heavy),
                              0.5 * omega @ I @ omega, 1e-11, given=f"L = {L}, I_body = {heavy * I_body}")


@exercise("5.14", points=1,
          hint="(I_k − I_i)(I_j − I_k) is positive only if I_k lies between the "
               "others; if it is negative, the rate is 0")
def test_only_the_middle_axis_tumbles(lesson, draw):
    I_body, near = np.roll(moments(draw), draw.whole(0, 2)), nearly_round(draw)
    spin = draw(1.0, 4.0)
    for k in range(3):
        i, j = (k + 1) % 3, (k + 2) % 3
        # Euler's equations about ω_k = spin: I_i ω̇_i = (I_j − I_k) ω_j spin, and cyclically.
        to_i, to_j = (I_body[j] - I_body[k]) / I_body[i], (I_body[k] - I_body[i]) / I_body[j]
        growth = np.linalg.eigvals(spin * np.array([[0.0, to_i], [to_j, 0.0]]))
        close(f"rate about axis {k} [1/s]", lesson.tumbling_rate(I_body, k, spin), growth.real.max(), 1e-7,
              given=f"I_body = {I_body}, spin = {spin}")
        close(f"rate about axis {k}, rotating the other way [1/s]", lesson.tumbling_rate(I_body, k, -spin),
              growth.real.max(), 1e-7)
        close(f"rate about axis {k} without a spin [1/s]", lesson.tumbling_rate(I_body, k, 0.0), 0.0, 0.0)
        # (I_k − I_i)(I_j − I_k) of nearly equal moments is 1e-8 of their product, with a round-off of 1e-12 of that.
        squared = (near[k] - near[i]) * (near[j] - near[k]) / near[i] / near[j]
        close(f"rate about axis {k} of a body with nearly equal moments, times 10⁴ [1/s]",
              1e4 * lesson.tumbling_rate(near, k, spin), 1e4 * spin * np.sqrt(max(0.0, squared)), 1e-7,
              given=f"I_body = {near}, spin = {spin}")
        for size in SIZES[1:]:
            close(f"rate about axis {k} of a very small or large body [1/s]",
                  lesson.tumbling_rate(size * I_body, k, spin), growth.real.max(), 1e-7, given=f"size {size}")
            close(f"rate about axis {k} at a very small or large spin, over the spin [-]",
                  lesson.tumbling_rate(I_body, k, size * spin) / size, growth.real.max(), 1e-7, given=f"size {size}")
        for equal in round_bodies(draw):
            close(f"rate about axis {k} of a body with equal moments [1/s]", lesson.tumbling_rate(equal, k, spin), 0.0,
                  1e-7, given=f"I_body = {equal}")


@exercise("5.15", points=0.5,
          hint="rotate (0, 0, 1) to find the top's axis; gravity pulls its tip down, "
               "so the torque is horizontal and perpendicular to the axis")
def test_the_torque_on_a_top_is_the_derivative_of_its_energy(lesson, draw):
    inclined = orientation(draw)
    upside_down = np.array([-inclined[1], inclined[0], -inclined[3], inclined[2]])       # by π about its own first axis
    level = np.array([0.5, 0.5, 0.5, 0.5]) * np.where(draw(-1.0, 1.0, 4) < 0.0, -1.0, 1.0)
    for q in (inclined, upside_down, level, *np.eye(4), orientation_of_few(draw)):
        for L in (draw(-1.0, 1.0, 3), *few(draw, 1.0)):
            mgl, h = draw(1.0, 5.0), 1e-4
            tau = lesson.heavy_top_torque(draw.sparse(0.0, 1.0), q, L, lesson.Top(np.array([2.0, 2.0, 1.0]), mgl))
            height = lambda phi, q=q: (about(phi) @ turn(q))[2, 2]
            slope = [-mgl * (height(h * e) - height(-h * e)) / (2.0 * h) for e in np.eye(3)]
            # h²/6 · mgl = 8e-9
            close("torque [N m]: minus the change of Mgl e_z per radian about x, y, z", tau, slope, 2e-8,
                  given=f"q = {q}, L = {L}, Mgl = {mgl}")
    # An axis a little off the vertical, upright or hanging; and tops of any weight.
    for angle in (1e-4, 1e-7):
        for w, v in ((np.cos(angle), np.sin(angle)), (np.sin(angle), np.cos(angle))):
            q, mgl = np.array([w, *v * unit_of([*draw(0.5, 1.0, 2), 0.0])]), draw(1.0, 5.0)
            for size in SIZES:
                tau = lesson.heavy_top_torque(0.0, q, np.ones(3), lesson.Top(np.array([2.0, 2.0, 1.0]), size * mgl))
                close("torque on a nearly vertical top over its size and tilt [N m]", np.asarray(tau) / size / angle,
                      np.cross(turn(q)[:, 2], [0.0, 0.0, -mgl]) / angle, 1e-6, given=f"q = {q}, Mgl = {size * mgl}")


# ---------------------------------------------------------------------------------------------- rotations, composed

def check_turn(lesson, q, omega, I_body, dt):
    """Check that a turn solves its equation and keeps L; return m/I_body, the ω in the body at its middle."""
    L = inertia(q, I_body) @ omega
    q_new = lesson.midpoint_free_rotation(q, L, I_body, dt)
    close("length of the new quaternion", np.linalg.norm(q_new), 1.0, EXACT)
    before, after = turn(q).T @ L, turn(q_new).T @ L
    m = 0.5 * (before + after)
    given = f"q = {q}, ω = {omega}, I_body = {I_body}, dt = {dt}"
    # Newton's last correction is below 1e-12 of |m| < 11, and the remaining error is its square.
    close("ℓ_new − ℓ − dt m × w in body coordinates [kg m²/s]", after - before - dt * np.cross(m, m / I_body),
          np.zeros(3), 1e-11, given=given)
    close("orientation after dt, as a matrix", turn(q_new), turn(q) @ third_way(m / I_body, dt), 1e-11, given=given)
    return m / I_body


@exercise("5.16", points=0.5,
          hint="w = m/I_body with the m of the last iteration; q on the left, (1, ½dt "
               "w) on the right, because w is in body coordinates")
def test_the_midpoint_turn_solves_its_own_equation(lesson, draw):
    q = orientation(draw)
    I_body = moments(draw)
    omega = spin_of(draw)
    dt = draw(0.1, 0.4)
    kept, L = q.copy(), inertia(q, I_body) @ omega
    expected = turn(q) @ third_way(check_turn(lesson, q, omega, I_body, dt), dt)
    # Scaling L and I_body does not change the motion: a correction is small only relative to m.
    for size in (1e6, 1e-6):
        scaled = lesson.midpoint_free_rotation(q, size * L, size * I_body, dt)
        close("orientation of a body a million times as heavy, or as light, as a matrix", turn(scaled), expected, 1e-11,
              given=f"I_body = {size * I_body}, dt = {dt}")
    close("input q after the call: unchanged", q, kept, 0.0)
    long = lesson.midpoint_free_rotation((1.0 + 5e-10) * q, L, I_body, dt)        # check_rotation accepts this length
    close("length of the new quaternion if the old one is too long by 5e-10", np.linalg.norm(long), 1.0, EXACT)
    for angle in SLOW:                                                   # a small turn is a turn
        check_turn(lesson, q, angle * unit_of(spin_of(draw)), I_body, 1.0)
    check_turn(lesson, q, spin_of(draw), I_body, -dt)                    # a step backwards, as `compose` takes one
    for some in (I_body, *round_bodies(draw)):
        for omega in few(draw, 1.5):
            for r in (STILL, orientation(draw)):
                check_turn(lesson, r, omega, some, dt)


@exercise("5.16", points=0.25,
          hint="use Newton's method with the derivative, and allow NEWTON_LIMIT corrections: for long steps "
               "fixed-point iteration does not converge, and ten corrections are too few")
def test_newtons_method_converges_where_fixed_point_iteration_diverges(lesson, draw):
    """About an outer axis k, a fixed-point iteration m ← ℓ + ½dt m × w multiplies a small error by ρ > 1: it diverges.

    ρ = ½dt |spin| √((I_k − I_i)(I_k − I_j)/(I_i I_j)). Newton's method took at most 5 corrections in 200,000 such
    steps.
    """
    for k in (0, 2, 0, 2, 0, 2):
        q = orientation(draw)
        I_body = moments(draw)
        spin, rho = draw(0.5, 1.5), draw(1.5, 2.5)
        omega_body = 0.05 * spin * draw(-1.0, 1.0, 3)
        i, j = (k + 1) % 3, (k + 2) % 3
        omega_body[k] = spin
        dt = 2.0 * rho / spin / np.sqrt((I_body[k] - I_body[i]) * (I_body[k] - I_body[j]) / (I_body[i] * I_body[j]))
        check_long_turn(lesson, q, I_body, omega_body, float(dt))
    for _ in range(2):
        I_body, omega_body, dt = slow_to_solve(draw, 11)
        check_long_turn(lesson, orientation(draw), I_body, omega_body, dt)


def check_long_turn(lesson, q, I_body, omega_body, dt):
    before = I_body * omega_body
    after = turn(lesson.midpoint_free_rotation(q, turn(q) @ before, I_body, dt)).T @ turn(q) @ before
    m = 0.5 * (before + after)
    # The last correction is 1e-12 |m| < 1e-11, times dt |w| < 60, and the rotation adds as much again.
    close("ℓ_new − ℓ − dt m × w after a long step [kg m²/s]", after - before - dt * np.cross(m, m / I_body),
          np.zeros(3), 1e-8, given=f"I_body = {I_body}, ω in the body {omega_body}, dt = {dt}")


def corrections(before, I_body, dt):
    """How many corrections Newton's method needs; 99 if that is more than 24."""
    m = before.copy()
    for n in range(1, 25):
        slope = [e + 0.5 * dt * np.cross(m / I_body - m / I, e) for e, I in zip(np.eye(3), I_body, strict=True)]
        change = np.linalg.solve(np.stack(slope, axis=1), m - before - 0.5 * dt * np.cross(m, m / I_body))
        m = m - change
        if np.max(np.abs(change)) <= 1e-12 * np.max(np.abs(m)):
            return n
    return 99


def slow_to_solve(draw, least):
    """(I_body, ω in the body, dt) of a very long step that Newton's method solves, but not before `least` corrections.

    They are about as many from nearby, so round-off does not matter.
    """
    while True:
        I_body, omega_body, dt = moments(draw), spin_of(draw), draw(5.0, 20.0)
        if least <= corrections(I_body * omega_body, I_body, dt) < 99:
            near = [corrections(I_body * omega_body * (1.0 + draw(-1e-7, 1e-7, 3)), I_body, dt) for _ in range(4)]
            if least <= min(near) and max(near) <= min(near) + 1 < 25:
                return I_body, omega_body, dt


def turn_once(lesson, draw):
    """Check an ordinary turn first.

    An answer that returns its input or always raises would also keep energies and leave a resting body alone.
    """
    q = orientation(draw)
    I_body = moments(draw)
    omega = spin_of(draw)
    dt = draw(0.1, 0.4)
    L = inertia(q, I_body) @ omega
    before, after = turn(q).T @ L, turn(lesson.midpoint_free_rotation(q, L, I_body, dt)).T @ L
    m = 0.5 * (before + after)
    close("ℓ_new − ℓ − dt m × w of an ordinary turn [kg m²/s]", after - before - dt * np.cross(m, m / I_body),
          np.zeros(3), 1e-11, given=f"ω = {omega}, dt = {dt}")


@exercise("5.16", points=0.25,
          hint="does Newton's method continue until the correction is small? Then a "
               "turn changes the energy only by round-off")
def test_the_midpoint_turn_keeps_the_energy_however_often(lesson, draw):
    turn_once(lesson, draw)
    q, I_body, omega = orientation(draw), moments(draw), spin_of(draw)
    L = inertia(q, I_body) @ omega
    dt = 0.3
    energy = lambda q: 0.5 * np.sum((turn(q).T @ L) ** 2 / I_body)
    begin = energy(q)
    for _ in range(200):
        q = np.asarray(lesson.midpoint_free_rotation(q, L, I_body, dt), dtype=float)
    close("energy after 200 turns over energy before", energy(q) / begin, 1.0, 1e-12)


@exercise("5.16", points=0.25, hint="for a body at rest m = 0, and the condition 0 ≤ 0 must end the loop")
def test_the_midpoint_turn_leaves_a_resting_body(lesson, draw):
    turn_once(lesson, draw)
    for q, I_body in ((orientation(draw), moments(draw)), (STILL, round_bodies(draw)[3])):
        close("q of a body at rest", lesson.midpoint_free_rotation(q, np.zeros(3), I_body, 0.1), q, EXACT)


@exercise("5.16", points=0.25,
          hint="if the loop ends without convergence, raise Diverged; do not use the last m")
def test_the_midpoint_turn_solves_its_equation_or_raises_diverged(lesson, draw):
    turn_once(lesson, draw)
    raises("an L that is not a number", Diverged,
           lesson.midpoint_free_rotation, orientation(draw), np.full(3, np.nan), moments(draw), 0.1, naming=[0.1])
    # At ten radians per step and more, Newton's method often fails to converge.
    for _ in range(60):
        q = orientation(draw)
        I_body = moments(draw)
        omega = spin_of(draw)
        dt = draw(5.0, 20.0)
        L = inertia(q, I_body) @ omega
        try:
            with np.errstate(all="ignore"):                              # an overflow is one form of divergence
                q_new = lesson.midpoint_free_rotation(q, L, I_body, dt)
        except NotImplementedError:
            raise
        except Exception as e:
            if type(e).__name__ != "Diverged":
                raise
            continue
        before, after = turn(q).T @ L, turn(q_new).T @ L
        m = 0.5 * (before + after)
        # The last correction is 1e-12 |m| < 1e-11, times dt |w| < 60, and the rotation adds as much again.
        close("ℓ_new − ℓ − dt m × w after a very long step [kg m²/s]", after - before - dt * np.cross(m, m / I_body),
              np.zeros(3), 1e-8, given=f"ω = {omega}, dt = {dt}")


@exercise("5.17", points=0.5,
          hint="b is intermediate_axis(I_body); on the right of q: angles (1/I_a − 1/I_b) L_a dt about a, likewise "
               "about c; on its left: dt/I_b L about L; for two equal moments this is exact")
def test_the_splitting_turn_is_exact_when_two_moments_are_equal(lesson, draw):
    for flat in (False, True):
        check_turns_of_round_bodies(lesson, draw, round_bodies(draw, flat), draw(0.5, 2.0))


def check_turns_of_round_bodies(lesson, draw, bodies, dt):
    """Compare with a turn about L, times a turn about the body's axis: moments of bodies as round_bodies gives them."""
    across = bodies[3][0]
    for omega, q in ((spin_of(draw), orientation(draw)), *zip(few(draw, 1.5), (STILL, *np.eye(4)[1:]), strict=True)):
        for k, I_body in enumerate(bodies):
            e = np.eye(3)[k % 3]
            L = inertia(q, I_body) @ omega
            spin = (1.0 - I_body[k % 3] / across) * (turn(q).T @ omega @ e)
            expected = about(dt / across * L) @ turn(q) @ about(dt * spin * e)
            got = lesson.splitting_free_rotation(q, L, I_body, dt)
            given = f"q = {q}, I_body = {I_body}, ω = {omega}, dt = {dt}"
            close("length of the new quaternion", np.linalg.norm(got), 1.0, EXACT, given=given)
            close("orientation after dt, as a matrix", turn(got), expected, EXACT, given=given)


@exercise("5.17", points=0.5,
          hint="half of a, all of c, half of a: compute each component of L with the current "
               "quaternion; a turn by −dt must undo one by dt")
def test_the_splitting_turn_is_reversible_and_of_second_order(lesson, draw):
    q = orientation(draw)
    I_body = np.roll(moments(draw), draw.whole(0, 2))
    omega = spin_of(draw)
    T = 1.0
    kept = q.copy()
    L = inertia(q, I_body) @ omega
    there = np.asarray(lesson.splitting_free_rotation(q, L, I_body, 0.3), dtype=float)
    back = lesson.splitting_free_rotation(there, L, I_body, -0.3)
    close("orientation after dt and −dt, as a matrix: back", turn(back), turn(q), EXACT)
    # With nearly equal moments the order of the rotations changes less than 1e-8, and their sizes count.
    near = nearly_round(draw)
    b = np.argsort(near)[1]
    for size in (*SIZES, *SLOW[1:3]):
        heavy, pace = (size, 1.0) if size in SIZES else (1.0, size)
        L, ell = pace * inertia(q, near) @ omega, pace * near * (turn(q).T @ omega)
        got = lesson.splitting_free_rotation(q, heavy * L, heavy * near, 1.0)
        close("orientation of a nearly round body, as a matrix, over the size of ω", turn(got) / pace,
              about(L / near[b]) @ turn(q) @ about((1.0 / near - 1.0 / near[b]) * ell) / pace, 3e-8,
              given=f"q = {q}, I_body = {heavy * near}, L = {heavy * L}")
    L = inertia(q, I_body) @ omega
    close("input q after the call: unchanged", q, kept, 0.0)
    long = lesson.splitting_free_rotation((1.0 + 5e-10) * q, L, I_body, 0.3)      # check_rotation accepts this length
    close("length of the new quaternion if the old one is too long by 5e-10", np.linalg.norm(long), 1.0, EXACT)
    truth, _ = freely(turn(q), turn(q).T @ omega, I_body, T)
    errors = []
    for n in (10, 20, 40):
        now = q
        for _ in range(n):
            now = np.asarray(lesson.splitting_free_rotation(now, L, I_body, T / n), dtype=float)
        errors.append(np.abs(turn(now) - truth).max())
    # The error has only even powers of dt: the next term is (|ω| dt)² < 2 % of the first.
    between("error at 20 steps over error at 10", errors[1] / errors[0], 0.22, 0.28)
    between("error at 40 steps over error at 20", errors[2] / errors[1], 0.24, 0.26)


class Growth(NamedTuple):
    rate: float          # [1/s]
    push: float          # [N m]


def bent_step(torque, t, q, L, dt, body):
    """A reversible second-order step for L̇ = rate L + push cos t, with a known result:
    half push, growth, half push.  q turns by 1 rad/s about a fixed axis x, without an error.
    """
    L = L + 0.5 * dt * torque(t, q, L, body)
    L = L * (1.0 + 0.5 * dt * body.rate) / (1.0 - 0.5 * dt * body.rate)
    c, s = np.cos(0.5 * dt), np.sin(0.5 * dt)
    q = np.array([c * q[0] - s * q[1], c * q[1] + s * q[0], c * q[2] - s * q[3], c * q[3] + s * q[2]])
    return q, L + 0.5 * dt * torque(t + dt, q, L, body)


def waves(t, q, L, body):
    return body.push * np.cos(t) * np.ones(3)


@exercise("5.18", points=1,
          hint="the substeps are γ, γ, 1 − 4γ, γ, γ times dt; the third is negative; advance t by each of them")
def test_five_reversible_substeps_make_fourth_order(lesson, draw):
    q = orientation(draw)
    L, t = draw(0.5, 1.5, 3), draw(0.0, 1.0)
    growth = Growth(draw(-1.5, -0.5), draw(0.5, 1.0))
    gamma = 1.0 / (4.0 - 4.0 ** (1.0 / 3.0))
    kept = L.copy()
    for push, L0, q0, sign in ((0.0, L, q, 1.0), (growth.push, L, q, 1.0), (growth.push, np.zeros(3), STILL, 1.0),
                               (growth.push, draw.sparse(0.5, 1.5, 3), orientation_of_few(draw), 1.0),
                               (growth.push, L, q, -1.0)):                         # a step backwards in time
        p, dt = growth._replace(push=push), sign * draw(0.3, 0.6)
        q_new, got = lesson.compose(bent_step, waves, t, q0, L0, dt, p)
        expected, now = L0, t
        for share in (gamma, gamma, 1.0 - 4.0 * gamma, gamma, gamma):
            h = share * dt
            expected = (expected + 0.5 * h * push * np.cos(now)) * (1.0 + 0.5 * h * p.rate) / (1.0 - 0.5 * h * p.rate)
            now += h
            expected = expected + 0.5 * h * push * np.cos(now)
        close(f"L after one composed step {'with' if push else 'without'} a time-dependent push", got,
              expected, EXACT, given=f"t = {t}, dt = {dt}, L = {L0}")
        close("orientation after one composed step, as a matrix", turn(q_new), about(dt * np.eye(3)[0]) @ turn(q0),
              EXACT, given=f"dt = {dt}, q = {q0}")
    close("input L after the call: unchanged", L, kept, 0.0)
    p = growth._replace(push=0.0)
    errors = []
    for dt in (0.4, 0.2):
        _, got = lesson.compose(bent_step, waves, 0.0, q, L, dt, p)
        errors.append(np.abs(np.log(np.asarray(got) / L) - p.rate * dt).max())
    # The logarithm is rate dt + C dt⁵ + C′ dt⁷ + …: only odd powers, because the step is reversible.
    between("error of one step over that of a step half as long: 2⁵", errors[0] / errors[1], 30.0, 34.0)


# ---------------------------------------------------------------------------------------------- why?

def steady_rates(I, mgl, tilt, spin):
    """Both rates of steady precession, smallest first: the roots of (Ω ẑ × L − τ) · y, which is quadratic in Ω."""
    e = np.array([np.sin(tilt), 0.0, np.cos(tilt)])
    tau = np.cross(e, [0.0, 0.0, -mgl])

    def rest(rate):
        turning = np.array([0.0, 0.0, rate])
        across = turning - turning @ e * e
        return (np.cross(turning, I[0] * across + I[2] * spin * e) - tau)[1]

    rates = np.array([-1.0, 0.0, 1.0])
    return sorted(np.roots(np.polyfit(rates, [rest(rate) for rate in rates], 2)), key=abs)


@exercise("5.19", points=1, hint="L stands still in axes that turn with Ω about the vertical: Ω ẑ × L = τ; the part of "
                                 "L across the vertical is (I₃ω₃ − I₁Ω cos θ) sin θ")
def test_a_top_goes_round_as_its_torque_turns_l(lesson, draw):
    for low, high in ((0.3, 1.2), (1.9, 2.8)):
        I_body = np.array([draw(3.0, 6.0)] * 2 + [draw(0.8, 1.5)])
        mgl, tilt = draw(10.0, 30.0), draw(low, high)
        limit = np.sqrt(4.0 * I_body[0] * mgl) / I_body[2]               # a spin above it is enough at each tilt
        for spin in (draw(1.1, 1.5) * limit, -draw(1.1, 1.5) * limit, draw(5.0, 9.0) * limit):
            # np.roots loses a few digits of the small root
            close("rate of steady precession [rad/s]", lesson.precession_rate(I_body, mgl, tilt, spin),
                  steady_rates(I_body, mgl, tilt, spin)[0], 1e-10, given=f"I_body = {I_body}, Mgl = {mgl:.4g} N m, "
                  f"tilt = {tilt:.4g} rad, spin = {spin:.4g} rad/s")
        round_top = np.full(3, I_body[0])
        close("rate of a top with three equal moments [rad/s]", lesson.precession_rate(round_top, mgl, tilt, limit),
              steady_rates(round_top, mgl, tilt, limit)[0], 1e-10, given=f"I_body = {round_top}, Mgl = {mgl:.4g} N m, "
              f"tilt = {tilt:.4g} rad, spin = {limit:.4g} rad/s")
        close("rate of a top that stands on its centre of mass, Mgl = 0 [rad/s]",
              lesson.precession_rate(I_body, 0.0, tilt, limit), 0.0, EXACT, given=f"tilt = {tilt:.4g} rad")
    check_slow_tops(lesson, draw)
    # Tops of any size, nearly vertical, level and fast ones: Ω (I₃ω₃ − I₁Ω cos θ) = Mgl, and Ω is the smaller root.
    for size, tilt, fast in itertools.product(SIZES, (1e-4, 1.0, 0.5 * np.pi - 1e-3, 0.5 * np.pi + 1e-3, 3.1),
                                              (1.5, 30.0, 1e3)):
        spin = fast * limit
        rate = lesson.precession_rate(size * I_body, size * mgl, tilt, spin)
        given = f"I_body = {size * I_body}, Mgl = {size * mgl:.4g} N m, tilt = {tilt} rad, spin = {spin:.4g} rad/s"
        # The usual formula for the roots divides a difference of near numbers by cos θ, which loses so many digits.
        close("torque that turns L at this rate over that of the weight [-]",
              rate * (I_body[2] * spin - I_body[0] * rate * np.cos(tilt)) / mgl, 1.0,
              EXACT + 1e-14 * fast**2 / abs(np.cos(tilt)), given=given)
        between("rate over the mean of both roots [-]", 2.0 * I_body[0] * rate * np.cos(tilt) / (I_body[2] * spin),
                -np.inf, 1.0)
    for spin in (limit, -limit):
        close("rate with a level axis [rad/s]", lesson.precession_rate(I_body, mgl, 0.5 * np.pi, spin),
              mgl / (I_body[2] * spin), 1e-12, given=f"spin = {spin:.4g} rad/s")


def check_slow_tops(lesson, draw):
    """Compare the rate of tops that are too slow to stand upright: a leaning one needs less spin, a hanging one none.
    """
    for low, high, least in ((0.9, 1.2, 1.02), (1.9, 2.8, 0.0)):
        I_body, mgl, tilt = np.array([draw(3.0, 6.0)] * 2 + [draw(0.8, 1.5)]), draw(10.0, 30.0), draw(low, high)
        limit = np.sqrt(4.0 * I_body[0] * mgl) / I_body[2]
        least = max(least * np.sqrt(max(0.0, np.cos(tilt))), 0.1)        # of the limit
        for spin in (draw(least, 0.95) * limit, -draw(least, 0.95) * limit):
            close("rate of a top that is too slow to stand upright [rad/s]",
                  lesson.precession_rate(I_body, mgl, tilt, spin), steady_rates(I_body, mgl, tilt, spin)[0], 1e-10,
                  given=f"I_body = {I_body}, Mgl = {mgl:.4g} N m, tilt = {tilt:.4g} rad, spin = {spin:.4g} rad/s")


@exercise("5.20", points=1, hint="a disturbance grows as e^(λt): how much later does a tenth of it reach the same?")
def test_the_chosen_time_grows_as_a_disturbance_that_grows_exponentially(lesson):
    a, b, c = BRICK
    rate = SPIN * np.sqrt((b - a) * (c - b) / (a * c))
    right = choices.where("rotation", "times_of_a_flip",
                          lambda n, time: abs((time[-1] - time[-11]) * rate - np.log(10.0) * (n[-1] - n[-11])) < 1e-3)
    choice("the letter of a careful throw", lesson.careful_throw_is(), right)


@exercise("5.21", points=1, hint="spin it about its middle axis, a little askew; measure the time between two flips in "
                                 "a run, and multiply ω by what is missing")
def test_a_thrown_body_of_ones_own_turns_over_in_time(lesson, draw):
    period = draw(1.2, 2.5)
    m, x, size, omega = (np.asarray(part, dtype=float) for part in lesson.my_thrown_body(period))
    truth("whether there are at least two boxes", len(m) >= 2, True)
    truth("whether masses and edges are above 0", bool(np.all(m > 0.0) and np.all(size > 0.0)), True)
    I = inertia_of_boxes(m, x, size)
    moments, axes = np.linalg.eigh(I)
    for k in (1, 2):
        between(f"principal moment {k + 1} over moment {k} [-]", moments[k] / moments[k - 1], 1.05, np.inf)
    L = axes.T @ I @ omega
    askew = np.degrees(np.arctan2(np.hypot(L[0], L[2]), abs(L[1])))
    between("angle between L and the middle axis at the start [°]", askew, 0.25, 18.0)
    between("|ω| period [rad]", np.linalg.norm(omega) * period, 0.0, 300.0)
    flips = times_of_flips(I, omega, axes[:, 1], 8.0 * period)
    truth("whether it turns over at least three times in eight periods", len(flips) >= 3, True)
    between("time between two flips over that which was asked for [-]", np.diff(flips).mean() / period, 0.98, 1.02)


def inertia_of_boxes(m, x, size):
    """The tensor about the common centre: boxes along the axes, with their own ∫ r rᵀ dm = m size²/12."""
    r = x - m @ x / m.sum()
    spread = (m[:, None] * r).T @ r + np.diag(m @ size**2) / 12.0
    return np.trace(spread) * np.eye(3) - spread


def times_of_flips(I, omega, axis, T):
    """The times at which L is across an axis of the body, by DOP853 on Euler's equations."""
    from scipy.integrate import solve_ivp
    slope = lambda t, w: np.linalg.solve(I, np.cross(I @ w, w))
    return solve_ivp(slope, (0.0, T), omega, method="DOP853", rtol=1e-9, atol=1e-9,
                     events=lambda t, w: axis @ I @ w).t_events[0]


# ---------------------------------------------------------------------------------------------- given functions

# Orders of convergence.
STEPS = {"matrix": 1, "axis_angle": 1, "quaternion": 1, "gyroscopic": 1, "implicit_gyroscopic": 1, "runge_kutta": 4,
         "midpoint": 2, "splitting": 2, "composed_splitting": 4, "composed_midpoint": 4}
CONSERVING = ("matrix", "axis_angle", "quaternion", "runge_kutta", "midpoint", "splitting", "composed_splitting",
              "composed_midpoint")


@pytest.mark.parametrize("name", STEPS)
def test_every_step_converges_with_its_order_to_a_tilted_heavy_top(lesson, draw, name):
    """The reference solution is DOP853 on R and L in world coordinates, without any function of the lesson."""
    from scipy.integrate import solve_ivp
    q = orientation(draw)
    I_body = moments(draw)
    omega = spin_of(draw)
    mgl = draw(1.0, 2.0)
    T = 1.0

    def slope(t, y):
        R, L = y[:9].reshape(3, 3), y[9:]
        omega = np.linalg.solve(R @ np.diag(I_body) @ R.T, L)
        return np.concatenate((np.cross(omega, R.T).T.ravel(), np.cross(R[:, 2], [0.0, 0.0, -mgl])))

    L = inertia(q, I_body) @ omega
    begin = np.concatenate((turn(q).ravel(), L))
    end = solve_ivp(slope, (0.0, T), begin, method="DOP853", rtol=1e-13, atol=1e-14).y[:, -1]
    top, order = lesson.Top(I_body, mgl), STEPS[name]
    errors = []
    for n in (40, 80):
        q_end, L_end = lesson.advance_rotation(getattr(lesson, f"{name}_step"), lesson.heavy_top_torque, 0.0, q, L,
                                               T / n, n, top)
        errors.append(np.abs(np.concatenate((turn(q_end).ravel(), L_end)) - end).max())
    # The next term of the expansion is dt |ω| < 7 % of the first, or more if the first is small.
    between("order of convergence", np.log2(errors[0] / errors[1]), order - 0.4, order + 0.4)


@pytest.mark.parametrize("name", CONSERVING)
def test_without_torque_angular_momentum_is_kept_to_the_last_digit(lesson, draw, name):
    q, I_body, omega = orientation(draw), moments(draw), spin_of(draw)
    L = inertia(q, I_body) @ omega
    # without gravity
    _, after = lesson.advance_rotation(getattr(lesson, f"{name}_step"), lesson.heavy_top_torque,
                             0.0, q, L, 0.05, 100, lesson.Top(I_body, 0.0))
    close("L after 100 steps [kg m²/s]", after, L, 0.0)


def test_given_conversions_agree_with_those_of_this_file(lesson, draw):
    q, r, phi = orientation(draw), draw(-1.0, 1.0, 3), draw(-3.0, 3.0, 3)
    close("rotate", lesson.rotate(q, r), turn(q) @ r, EXACT)
    close("unrotate", lesson.unrotate(q, r), turn(q).T @ r, EXACT)
    close("body_component", [lesson.body_component(q, r, k) for k in range(3)], turn(q).T @ r, EXACT)
    close("exponential", turn(lesson.exponential(phi)), about(phi), EXACT)
    close("exponential of zero", lesson.exponential(np.zeros(3)), [1.0, 0.0, 0.0, 0.0], 0.0)
    for k in range(3):
        turned = turn(q) @ about(phi[k] * np.eye(3)[k])
        close("about_axis", turn(lesson.about_axis(q, k, phi[k])), turned, EXACT)
    # Near half turns about these axes, each of the four components of q is the largest once.
    for axis in (*np.eye(3), r / np.linalg.norm(r)):
        for angle in (0.1, 3.0):
            R = about(angle * axis)
            close("quaternion_from_matrix", turn(lesson.quaternion_from_matrix(R)), R, EXACT)
    a, b, c = draw(-1.0, 1.0, (3, 3)) + 2.0 * np.eye(3)
    close("solve3", np.stack([a, b, c], axis=1) @ lesson.solve3(a, b, c, r), r, 1e-11)


@pytest.mark.parametrize(("moments", "axis"), [
    ((1.0, 2.0, 3.0), 1), ((2.0, 1.0, 3.0), 0), ((3.0, 1.0, 2.0), 2),
    ((1.0, 1.0, 2.0), (0, 1)), ((2.0, 1.0, 2.0), (0, 2)), ((1.0, 2.0, 2.0), (1, 2))])
def test_the_middle_axis_is_found_wherever_it_is(lesson, moments, axis):
    assert lesson.intermediate_axis(np.array(moments)) in np.atleast_1d(axis)


def refused(lesson, **changed):
    """The message with which advance_rotation refuses a valid run after one of its inputs is changed."""
    valid = {"q": np.array([1.0, 0.0, 0.0, 0.0]), "L": np.ones(3), "dt": 0.1, "I_body": np.array([1.0, 2.0, 2.5])}
    run = {**valid, **changed}
    with pytest.raises(BadInput) as caught:
        lesson.advance_rotation(lesson.splitting_step, lesson.heavy_top_torque, 0.0, run["q"],
                      run["L"], run["dt"], 1, lesson.Top(run["I_body"], 1.0))
    return str(caught.value)


def test_an_invalid_rotation_or_body_is_refused_by_name_and_value(lesson):
    zero = refused(lesson, q=np.zeros(4))
    assert "quaternion" in zero and "0.0" in zero
    assert "1.1" in refused(lesson, q=np.array([1.1, 0.0, 0.0, 0.0]))
    assert "nan" in refused(lesson, q=np.array([np.nan, 0.0, 0.0, 0.0]))
    impossible = refused(lesson, I_body=np.array([1.0, 2.0, 3.5]))
    assert "principal moment" in impossible and "3.5" in impossible
    assert "-1.0" in refused(lesson, I_body=np.array([-1.0, 2.0, 2.0]))
    assert "0.0" in refused(lesson, I_body=np.array([1.0, 0.0, 1.0]))
    assert "inf" in refused(lesson, L=np.array([np.inf, 0.0, 0.0]))
    assert "-0.1" in refused(lesson, dt=-0.1)


def test_flat_and_thin_bodies_are_bodies(lesson):
    for moments in ((1.0, 2.0, 3.0), (1.0, 1.0, 1e-6), (0.1, 0.2, 0.1 + 0.2)):
        lesson.check_moments(np.array(moments))


def test_make_body_checks_mass_and_moments():
    from solutions.given.rotation import make_rigid_body
    assert make_rigid_body(2, (1, 2, 2.5)).m == 2.0
    for m, I_body in ((0.0, (1.0, 1.0, 1.0)), (1.0, (1.0, 1.0, 2.1)), (1.0, (1.0, 1.0, np.nan))):
        with pytest.raises(BadInput):
            make_rigid_body(m, I_body)
