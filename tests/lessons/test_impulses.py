"""Lesson 7: impulses conserve momentum, rebound with −e u_n, stay in the friction cone, and act when bodies meet."""

import itertools
from decimal import Decimal, localcontext

import numpy as np
import pytest
from scipy.optimize import brentq

from solutions.checks import BadInput, Diverged
from validate.grading.expect import between, choice, close, numbers, raises, truth
from validate.reference import choices

from .brute import not_negative

exercise = pytest.mark.exercise
# All drawn values are below 30 in their unit. A result takes a few dozen operations, each with a round-off of 1.1e-16.
ROUND_OFF = 1e-12
# No law here has a scale: results must also be right with all lengths or velocities smaller by this factor.
TINY = 1e-20
SIZES = (1.0, TINY, 1.0 / TINY)                          # an ordinary case first
STILL = np.zeros(3)


def unit(draw, d):
    """A drawn unit vector that is parallel to no coordinate axis."""
    n = draw(0.3, 1.0, d) * np.array([2 * draw.whole(0, 1) - 1 for _ in range(d)])
    return n / np.linalg.norm(n)


def arrows(draw, d):
    """Drawn vectors (d,) that a short cut may take for zero.

    One or all but one of their components are 0, all have the same sign, or they add up to exactly 0.
    """
    for k in range(d):
        for sign in (1.0, -1.0):
            yield sign * draw(0.3, 1.0) * np.eye(d)[k]
        if d > 2:
            yield draw(0.3, 1.0, d) * (2 * draw.whole(0, 1) - 1) * (1.0 - 2.0 * np.eye(d)[k - 1]) * (1.0 - np.eye(d)[k])
    for sign in (1.0, -1.0):
        yield sign * draw(0.3, 1.0, d)
        first = draw(0.3, 1.0, d - 1)
        yield sign * np.append(first, -np.sum(first))


def normals(draw, d):
    """Unit vectors (d,): along each axis in both directions, in every quadrant, with components that add up to 0."""
    for k in range(d):
        yield from (np.eye(d)[k], -np.eye(d)[k])
    for k in range(2**d):
        n = draw(0.3, 1.0, d) * np.array([1.0 if k & 2**c else -1.0 for c in range(d)])
        yield n / np.linalg.norm(n)
    for sign in (1.0, -1.0):
        yield sign * (np.eye(d)[0] - np.eye(d)[draw.whole(1, d - 1)]) / np.sqrt(2.0)


def across(n, y):
    """The tangential part of y."""
    return y - (y @ n) * n


def flat(draw, lesson):
    """A drawn body in the plane."""
    v = draw(-3.0, 3.0, 2)
    omega = draw(1.0, 5.0) * (2 * draw.whole(0, 1) - 1)
    return lesson.BodyState2D(v, omega, draw(0.3, 2.0), draw(0.5, 5.0))


def inertia(draw):
    """I⁻¹ (3, 3) of a drawn body: eigenvalues between 0.5 and 5, principal axes not along the coordinate axes."""
    Q, _ = np.linalg.qr(draw(-1.0, 1.0, (3, 3)))
    return Q @ np.diag(draw(0.5, 5.0, 3)) @ Q.T


def solid(draw, lesson):
    """A drawn body in space."""
    return lesson.BodyState3D(draw(-3.0, 3.0, 3), draw(-5.0, 5.0, 3), draw(0.3, 2.0), inertia(draw))


def restrained(body):
    """The body free, immovable, on an axle through its centre, and unable to rotate."""
    none = 0.0 * body.inv_inertia
    return (body, body._replace(inv_mass=0.0, inv_inertia=none), body._replace(inv_mass=0.0),
            body._replace(inv_inertia=none))


def at_rest(body):
    """The body without velocity, without rotation, and without both."""
    v, omega = abs(0.0 * body.v), abs(0.0 * body.omega)
    return body._replace(v=v), body._replace(omega=omega), body._replace(v=v, omega=omega)


def answer(r, inv_mass, inv_inertia, J):
    """Velocity change (3,) of the point r of a body to which the impulse J is applied at r."""
    return inv_mass * J + np.cross(inv_inertia @ np.cross(r, J), r)


def contact(draw):
    """(n, K): a drawn normal, and a matrix K that maps an impulse to a change of relative velocity."""
    r, inv_mass = draw(-1.0, 1.0, 3), draw(0.3, 2.0)
    inv_inertia = inertia(draw)
    return unit(draw, 3), np.stack([answer(r, inv_mass, inv_inertia, axis) for axis in np.eye(3)], axis=1)


# ---------------------------------------------------------------------------------------------- response and penalty

@exercise("7.1", points=0.5, hint="only the normal component changes: reverse it and multiply it by e")
def test_a_response_turns_the_normal_velocity_and_keeps_the_rest(lesson, draw):
    for d, e, slow in ((2, draw(0.1, 0.9), 1.0), (3, draw(0.1, 0.9), 1.0), (3, 0.0, 1.0), (2, 1.0, 1.0),
                       (3, draw(0.1, 0.9), 1e-6)):
        n = unit(draw, d)
        v = across(n, draw(-5.0, 5.0, d)) - slow * draw(0.5, 5.0) * n
        got = np.asarray(lesson.kinematic_response(v, n, e))
        close("velocity after the response [m/s]", got, across(n, v) - e * (v @ n) * n, ROUND_OFF,
              given=f"v = {v} m/s, n = {n}, e = {e}")
        got = np.asarray(lesson.kinematic_response(TINY * v, n, e))
        close("velocity after the response, slow particle [m/s]", got, TINY * (across(n, v) - e * (v @ n) * n),
              TINY * ROUND_OFF, given=f"v = {TINY * v} m/s, n = {n}, e = {e}")
        got = np.asarray(lesson.kinematic_response(v / TINY, n, e))
        close("velocity after the response, very fast particle, over its size [-]", TINY * got,
              bounced_off(v, n, e), ROUND_OFF, given=f"v = {v / TINY} m/s, n = {n}, e = {e}")
    for d in (2, 3):
        e = draw(0.1, 0.9)
        vectors = [(v, n) for n in normals(draw, d) for v in (draw(-5.0, 5.0, d), -draw(0.5, 5.0) * n)]
        vectors += [(v, n) for n in (unit(draw, d), np.eye(d)[0]) for v in (*arrows(draw, d), np.zeros(d))]
        for v, n in vectors:
            close("velocity after the response [m/s]", lesson.kinematic_response(v, n, e), bounced_off(v, n, e),
                  ROUND_OFF, given=f"v = {v} m/s, n = {n}, e = {e}")
    for e in (1e-6 * draw(0.1, 0.9), 1.0 - 1e-6 * draw(0.1, 0.9)):       # nearly 0 and nearly 1 are neither
        n = unit(draw, 3)
        close("velocity after the response, with a restitution of nearly 0 or 1 [m/s]",
              lesson.kinematic_response(-n, n, e), e * n, ROUND_OFF, given=f"v = {-n} m/s, n = {n}, e = {e}")
    for k, size in ((k, size) for k in range(1, 16) for size in SIZES):  # along an axis v · n has no round-off
        e, axis, n_and_slip = draw(0.1, 0.9), draw.whole(0, 1), np.eye(2)
        n, v = n_and_slip[axis], size * (draw(1.0, 5.0) * n_and_slip[1 - axis] - 10.0**-k * n_and_slip[axis])
        close("normal velocity after a grazing response, over that before [-]",
              (np.asarray(lesson.kinematic_response(v, n, e)) @ n) / (v @ n), -e, ROUND_OFF,
              given=f"v = {v} m/s, n = {n}, e = {e}")


def bounced_off(v, n, e):
    """v, with its part along −n reversed and multiplied by e."""
    return across(n, v) + (-e if v @ n < 0.0 else 1.0) * (v @ n) * n


@exercise("7.1", points=0.5, hint="where v · n ≥ 0 the particle is already leaving: return v unchanged")
def test_a_response_does_not_change_a_leaving_velocity(lesson, draw):
    for d in (2, 3):
        n = unit(draw, d)
        v = across(n, draw(-5.0, 5.0, d)) + draw(0.1, 3.0) * n
        e = draw(0.1, 0.9)
        got = lesson.kinematic_response(v - 2.0 * (v @ n) * n, n, e)
        close("velocity after the response, approaching particle [m/s]", got, across(n, v) + e * (v @ n) * n, ROUND_OFF)
        for slowly in (1.0, 1e-4, 1e-8, 1e-12, TINY):
            v = across(n, v) + slowly * draw(0.1, 3.0) * n if slowly > 1e-10 else slowly * v
            close("velocity of a leaving particle [m/s]", lesson.kinematic_response(v, n, draw(0.1, 0.9)), v, 0.0,
                  given=f"v = {v} m/s, n = {n}")


@exercise("7.2", points=1,
          hint="the spring acts on the depth −φ, the damper on v_n; the force is never negative, and zero outside")
def test_a_penalty_pushes_inside_only_and_never_pulls(lesson, draw):
    stiffness, damping, depth = draw(5.0, 30.0), draw(0.5, 3.0), draw(0.1, 0.9)
    for tiny in (1e-6, TINY):
        close("penalty force a very small depth inside [N]", lesson.penalty_force(-tiny, 0.0, stiffness, damping),
              tiny * stiffness, tiny * ROUND_OFF * 100.0, given=f"φ = {-tiny} m, {stiffness} N/m")
    # At this outward speed the damper cancels the spring force.
    weak = depth * stiffness / damping
    for v_n in (-draw(0.1, 5.0), 0.0, *(share * weak for share in draw.within())):
        close("penalty force [N]", lesson.penalty_force(-depth, v_n, stiffness, damping),
              stiffness * depth - damping * v_n, 1e-11,
              given=f"φ = {-depth} m, v_n = {v_n} m/s, {stiffness} N/m, {damping} N s/m")
    for share in draw.beyond(3.0):
        close("penalty force where the damper would pull [N]",
              lesson.penalty_force(-depth, share * weak, stiffness, damping), 0.0, 0.0)
    fast = draw(1.0, 5.0)
    close("penalty force of a damper without a spring, and of a spring without a damper [N]",
          [float(lesson.penalty_force(-depth, -fast, 0.0, damping)),
           float(lesson.penalty_force(-depth, -fast, stiffness, 0.0))], [damping * fast, stiffness * depth], 1e-11,
          given=f"φ = {-depth} m, v_n = {-fast} m/s, {stiffness} N/m, {damping} N s/m")
    # share: height as a fraction of the height at which the spring pull would cancel the damper push.
    for share in (draw(0.01, 0.9), draw(1.1, 9.0)):
        above = share * damping * fast / stiffness
        close("penalty force outside [N]", lesson.penalty_force(above, -fast, stiffness, damping), 0.0, 0.0,
              given=f"φ = {above} m")
    close("penalty force at the surface, approaching particle [N]",
          lesson.penalty_force(0.0, -draw(0.1, 5.0), stiffness, damping), 0.0, 0.0)
    for _ in range(60):                                                  # of any size: nothing is limited but the pull
        phi, v_n = -(10.0 ** draw(-12.0, 3.0)), (2 * draw.whole(0, 1) - 1) * 10.0 ** draw(-12.0, 4.0)
        scale = 10.0 ** draw(-6.0, 6.0)
        stiffness, damping = scale / -phi, scale * 10.0 ** draw(-3.0, 1.0) / abs(v_n)
        spring, damper = -stiffness * phi, -damping * v_n
        close("penalty force, over the force of the spring [-]",
              lesson.penalty_force(phi, v_n, stiffness, damping) / scale, max(0.0, spring / scale + damper / scale),
              ROUND_OFF, given=f"φ = {phi} m, v_n = {v_n} m/s, {stiffness} N/m, {damping} N s/m")


# ---------------------------------------------------------------------------------------------- in the plane

def turned(r, angle):
    c, s = np.cos(angle), np.sin(angle)
    return np.array([c * r[0] - s * r[1], s * r[0] + c * r[1]])


@exercise("7.3", points=1,
          hint="a point moves with its body and around its centre: ω (−r_y, r_x); subtract b's velocity from a's")
def test_contact_points_move_as_their_bodies_carry_them(lesson, draw):
    """Compare with complex numbers: ω × r is i ω r.  Once also with central differences over 2h.

    With ω < 5 and r < 2 their error is h² ω³ r/6 = 4e-9, and round-off adds 1e-15/h = 1e-10.
    """
    a, b, h = flat(draw, lesson), flat(draw, lesson), 1e-5
    r_a, r_b = draw(-1.4, 1.4, (2, 2))
    apart = [h * k * (a.v - b.v) + turned(r_a, k * h * a.omega) - turned(r_b, k * h * b.omega) for k in (1, -1)]
    close("relative velocity [m/s]", lesson.relative_velocity_2d(a, b, r_a, r_b), (apart[0] - apart[1]) / (2.0 * h),
          1e-8, given=f"{moving(a, 'a')}, {moving(b, 'b')}, r_a = {r_a} m, r_b = {r_b} m")
    # An immovable wall can still have a velocity, and so can a body on an axle: a or b may be one.
    cases = [(*pair, r_a, r_b) for pair in itertools.product((*restrained(a), *at_rest(a)),
                                                             (*restrained(b), *at_rest(b)))]
    for one, other in ((a, b), (a._replace(omega=-a.omega), b), (a, b._replace(omega=-b.omega))):
        for special in (*arrows(draw, 2), np.zeros(2)):
            cases += [(one, other, special, r_b), (one, other, r_a, special), (one, other, special, special)]
            cases += [(one._replace(v=special), other, r_a, r_b), (one, other._replace(v=special), r_a, r_b)]
    for one, other, r_a, r_b in cases:
        given = f"{moving(one, 'a')}, {moving(other, 'b')}, r_a = {r_a} m, r_b = {r_b} m"
        close("relative velocity [m/s]", lesson.relative_velocity_2d(one, other, r_a, r_b),
              carried(one, r_a) - carried(other, r_b), ROUND_OFF, given=given)
    for size in SIZES[1:]:
        quick = (one._replace(v=size * one.v, omega=size * one.omega) for one in (a, b))
        close("relative velocity of very slow or very fast bodies, over their size [-]",
              np.asarray(lesson.relative_velocity_2d(*quick, r_a, r_b)) / size, carried(a, r_a) - carried(b, r_b),
              ROUND_OFF, given=f"all velocities times {size}")


def moving(body, name):
    return f"v_{name} = {body.v} m/s, ω_{name} = {body.omega} rad/s"


def carried(body, r):
    """Velocity (2,) of a point at the offset r."""
    u = complex(*body.v) + 1j * body.omega * complex(*r)
    return np.array([u.real, u.imag])


@exercise("7.4", points=0.5, hint="j = −(1 + e) u_n/k_n, with k_n = 1/m_a + 1/m_b; and never a negative j")
def test_two_bodies_part_with_e_times_their_speed_and_keep_their_momentum(lesson, draw):
    for e, slow, heavy in ((draw(0.1, 0.9), 1.0, 1.0), (0.0, 1.0, 1.0), (1.0, 1.0, 1.0), (draw(0.1, 0.9), 1e-6, 1.0),
                           (draw(0.1, 0.9), TINY, 1.0), (draw(0.1, 0.9), 1.0, 1e20), (draw(0.1, 0.9), 1.0, TINY),
                           (draw(0.1, 0.9), 1e20, 1.0), (draw(0.1, 0.9), TINY, 1e20)):
        m_a, m_b = heavy * draw(0.5, 5.0), heavy * draw(0.5, 5.0)
        v_a, v_b = slow * draw(-5.0, -1.0), slow * draw(0.5, 5.0)
        j = float(lesson.impulse_size(v_a - v_b, 1.0 / m_a + 1.0 / m_b, e))
        after = v_a + j / m_a - (v_b - j / m_b)
        close("relative velocity after [m/s]", after, e * (v_b - v_a), slow * ROUND_OFF,
              given=f"m = {m_a}, {m_b} kg, v = {v_a}, {v_b} m/s, e = {e}")
    for u_n in (draw(0.1, 3.0), 0.0):
        close("impulse on bodies that separate or touch [N s]", lesson.impulse_size(u_n, 1.0, 0.5), 0.0, 0.0,
              given=f"u_n = {u_n} m/s")


@exercise("7.4", points=0.5, hint="call check_restitution and check_inverse_mass first: they refuse impossible values")
def test_impossible_restitutions_and_two_immovable_bodies_are_refused(lesson, draw):
    e, k = draw(0.1, 0.9), draw(0.5, 2.0)
    close("impulse with a possible restitution [N s]", lesson.impulse_size(-1.0, k, e), (1.0 + e) / k, ROUND_OFF,
          given=f"u_n = -1 m/s, k_n = {k} /kg, e = {e}")
    for u_n in (-1.0, 1.0, 0.0):                                         # approaching, separating, touching
        for impossible in (-draw(0.1, 1.0), draw(1.1, 2.0), np.nan, np.inf, -np.inf, -1e-9, 1.0 + 1e-9):
            raises(f"a restitution outside 0 to 1, with u_n = {u_n} m/s", BadInput,
                   lesson.impulse_size, u_n, k, impossible)
        raises(f"two immovable bodies, with u_n = {u_n} m/s", BadInput, lesson.impulse_size, u_n, 0.0, 0.5)
        for impossible in (-draw(0.5, 2.0), -1e-9, -np.inf, np.inf, np.nan):
            raises(f"an inverse mass that is not positive and finite, with u_n = {u_n} m/s", BadInput,
                   lesson.impulse_size, u_n, impossible, e)


@exercise("7.5", points=1, hint="each body contributes 1/m, and (r × n)²/I because it rotates; add both bodies")
def test_a_unit_impulse_drives_two_flat_bodies_apart_by_k(lesson, draw):
    a, b, r_a, r_b, n = flat(draw, lesson), flat(draw, lesson), *draw(-1.0, 1.0, (2, 2)), unit(draw, 2)
    cases = [(*pair, r_a, r_b, n) for pair in itertools.product((*restrained(a), *at_rest(a)),
                                                                (*restrained(b), *at_rest(b)))]
    cases += [(a._replace(omega=-a.omega), b._replace(omega=-b.omega), r_a, r_b, n)]
    for special in (*arrows(draw, 2), np.zeros(2)):
        cases += [(a, b, special, r_b, n), (a, b, r_a, special, n), (a, b, special, special, n)]
        cases += [(a._replace(v=special), b._replace(v=special), r_a, r_b, n)]
    cases += [(a, b, r_a, r_b, along) for along in normals(draw, 2)]
    for k in range(1, 6):                                                # nearly along n, with a small lever arm
        cases += [(a, b, n + 10.0**-k * np.array([-n[1], n[0]]), -n - 10.0**-k * np.array([-n[1], n[0]]), n)]
    for one, other, r_a, r_b, n in cases:
        given = f"{inert(one, '_a')}, {inert(other, '_b')}, r_a = {r_a} m, r_b = {r_b} m, n = {n}"
        close("k_n [1/kg]", lesson.effective_inverse_mass_2d(one, other, r_a, r_b, n),
              k_between_2d(one, other, r_a, r_b, n), ROUND_OFF, given=given)
    check_k_of_any_size(draw, lesson.effective_inverse_mass_2d, k_between_2d, a, b, n)


def check_k_of_any_size(draw, effective_inverse_mass, k_between, a, b, n):
    """In other units of length or mass the same two bodies have the same k_n, in those units."""
    for size in SIZES[1:]:
        r_a, r_b = draw(-1.0, 1.0, (2, n.size))
        expected = k_between(a, b, r_a, r_b, n)
        small = (one._replace(inv_inertia=one.inv_inertia / size**1.5) for one in (a, b))
        close("k_n of a very small or large body [1/kg]",
              effective_inverse_mass(*small, size**0.75 * r_a, size**0.75 * r_b, n), expected, ROUND_OFF,
              given=f"lengths times {size**0.75}")
        light = (one._replace(inv_mass=size * one.inv_mass, inv_inertia=size * one.inv_inertia) for one in (a, b))
        close("k_n of a very heavy or light body, over its size [-]",
              effective_inverse_mass(*light, r_a, r_b, n) / size, expected, ROUND_OFF,
              given=f"inverse masses and inertias times {size}")


def k_between_2d(a, b, r_a, r_b, n):
    """k_n [1/kg] of two bodies in the plane."""
    return n @ (answer_2d(a, r_a, n) + answer_2d(b, r_b, n))


def inert(body, name=""):
    return f"1/m{name} = {body.inv_mass} 1/kg, 1/I{name} = {body.inv_inertia} 1/(kg m²)"


def answer_2d(body, r, J):
    """Velocity change (2,) of the point r of a body to which the impulse J is applied at r."""
    spin = body.inv_inertia * np.cross([*r, 0.0], [*J, 0.0])[2]
    return body.inv_mass * J + spin * np.array([-r[1], r[0]])


@exercise("7.6", points=0.5, hint="v gains J/m, and ω gains (r_x J_y − r_y J_x)/I")
def test_an_impulse_changes_both_momenta_of_a_flat_body(lesson, draw):
    body, r, J = flat(draw, lesson), draw(-1.0, 1.0, 2), draw(-3.0, 3.0, 2)
    none = np.zeros(2)
    cases = [(body, r, J), (body, r, -J), (body, 5.0 * r, J), (body, r, 10.0 * J), (body, none, J), (body, r, none)]
    cases += [(body._replace(omega=-body.omega), r, J)]
    cases += [(one, r, J) for one in (*restrained(body), *at_rest(body))]
    for special in arrows(draw, 2):
        cases += [(body, special, J), (body, r, special), (body._replace(v=special), r, J), (body, J, special)]
        cases += [(body, r, np.array([-r[1], r[0]])), (body, r, 2.0 * r)]                # J across r, and along it
    for body, r, J in cases:
        after = lesson.apply_impulse_2d(body, r, J)
        given = f"v = {body.v} m/s, ω = {body.omega} rad/s, {inert(body)}, r = {r} m, J = {J} N s"
        close("v after the impulse [m/s]", after.v, body.v + body.inv_mass * J, ROUND_OFF, given=given)
        moment = (complex(*r).conjugate() * complex(*J)).imag
        close("ω after the impulse [rad/s]", after.omega, body.omega + body.inv_inertia * moment, ROUND_OFF, given)
        close("1/m and 1/I after the impulse: as before [1/kg, 1/(kg m²)]", [after.inv_mass, after.inv_inertia],
              [body.inv_mass, body.inv_inertia], 0.0, given=given)
    for size in SIZES[1:]:
        body, J = at_rest(flat(draw, lesson))[2], draw(-3.0, 3.0, 2)
        after = lesson.apply_impulse_2d(body, r, size * J)
        moment = (complex(*r).conjugate() * complex(*J)).imag
        expected = np.append(body.inv_mass * J, body.inv_inertia * moment)
        close("(v_x, v_y, ω) after a very small or large impulse on a body at rest, over its size [-]",
              np.append(after.v, after.omega) / size, expected, ROUND_OFF,
              given=f"{inert(body)}, r = {r} m, J = {size * J} N s")


# ---------------------------------------------------------------------------------------------- in space

@exercise("7.7", points=1,
          hint="n · [(I⁻¹ (r × n)) × r]: an impulse n changes ω by I⁻¹ (r × n), and that moves the point with × r")
def test_a_unit_impulse_drives_two_solid_bodies_apart_by_k(lesson, draw):
    a, b, r_a, r_b, n = solid(draw, lesson), solid(draw, lesson), *draw(-1.0, 1.0, (2, 3)), unit(draw, 3)
    cases = [(*pair, r_a, r_b, n) for pair in itertools.product((*restrained(a), *at_rest(a)),
                                                                (*restrained(b), *at_rest(b)))]
    upright = [one._replace(inv_inertia=np.diag(draw(0.5, 5.0, 3))) for one in (a, b)]   # principal axes along x, y, z
    cases += [(upright[0], b, r_a, r_b, n), (a, upright[1], r_a, r_b, n), (*upright, r_a, r_b, n)]
    for special in (*arrows(draw, 3), STILL):
        cases += [(a, b, special, r_b, n), (a, b, r_a, special, n), (*upright, special, special, n)]
        cases += [(a._replace(v=special), b, r_a, r_b, n), (a, b._replace(omega=special), r_a, r_b, n)]
        cases += [(a._replace(omega=special), b, r_a, r_b, n), (a, b._replace(v=special), r_a, r_b, n)]
    cases += [(*pair, r_a, r_b, along) for along in normals(draw, 3) for pair in ((a, b), upright)]
    for k in range(1, 6):                                                # nearly along n, with a small lever arm
        cases += [(a, b, n + 10.0**-k * across(n, r_a), -n + 10.0**-k * across(n, r_b), n)]
    ones = draw(0.3, 1.0) * np.ones(3)                                   # the components of r × n add up to 0
    cases += [(a, b, ones + k * n, r_b, n) for k in (1.0, -1.0)] + [(a, b, r_a, ones + k * n, n) for k in (1.0, -1.0)]
    for one, other, r_a, r_b, n in cases:
        close("k_n [1/kg]", lesson.effective_inverse_mass(one, other, r_a, r_b, n), k_between(one, other, r_a, r_b, n),
              ROUND_OFF, given=arms(one, other, r_a, r_b, n))
    check_k_of_any_size(draw, lesson.effective_inverse_mass, k_between, a, b, n)


def k_between(a, b, r_a, r_b, n):
    """k_n [1/kg] of two bodies in space."""
    return n @ (answer(r_a, a.inv_mass, a.inv_inertia, n) + answer(r_b, b.inv_mass, b.inv_inertia, n))


def arms(a, b, r_a, r_b, n):
    """What k_n of two bodies in space depends on, in words; the tensors in a few numbers, if they are zero or not."""
    tensors = [f"I⁻¹_{name} " + ("= 0" if not body.inv_inertia.any() else f"= {body.inv_inertia.tolist()}")
               for body, name in ((a, "a"), (b, "b"))]
    return (f"1/m_a = {a.inv_mass} 1/kg, 1/m_b = {b.inv_mass} 1/kg, r_a = {r_a} m, r_b = {r_b} m, n = {n}, "
            + ", ".join(tensors))


@exercise("7.7", points=0.5,
          hint="a central impulse does not change ω; a body with inv_mass = 0 contributes nothing")
def test_bodies_hit_along_their_centres_only_have_their_masses(lesson, draw):
    a, b, n = solid(draw, lesson), solid(draw, lesson), unit(draw, 3)
    r_a, r_b = draw(0.1, 1.0) * n, -draw(0.1, 1.0) * n
    close("k_n of a central impact, with both arms along n [1/kg]", lesson.effective_inverse_mass(a, b, r_a, r_b, n),
          a.inv_mass + b.inv_mass, ROUND_OFF, given=arms(a, b, r_a, r_b, n))
    wall = lesson.BodyState3D(STILL, STILL, 0.0, np.zeros((3, 3)))
    r_b = draw(-1.0, 1.0, 3)
    close("k_n of a central impact of a on an immovable b [1/kg]", lesson.effective_inverse_mass(a, wall, r_a, r_b, n),
          a.inv_mass, ROUND_OFF, given=arms(a, wall, r_a, r_b, n))


@exercise("7.8", points=1, hint="+ r_a × J for a, − r_b × J for b")
def test_an_impulse_between_two_bodies_keeps_the_angular_momentum_of_both_together(lesson, draw):
    drawn = draw(-2.0, 2.0, (5, 3))
    cases = [drawn, *(np.where(np.arange(5)[:, None] == k, special, drawn) for k in range(5)
                      for special in (*arrows(draw, 3), STILL))]
    cases += [np.where(np.arange(5)[:, None] < 2, special, drawn) for special in (*arrows(draw, 3), STILL)]
    for size, (L_a, L_b, r_a, r_b, J) in [(1.0, case) for case in cases] + [(size, drawn) for size in SIZES[1:]]:
        got = [np.asarray(L) / size for L in lesson.angular_momenta(size * L_a, size * L_b, r_a, r_b, size * J)]
        given = f"L_a = {size * L_a}, L_b = {size * L_b}, r_a = {r_a}, r_b = {r_b}, J = {size * J}"
        over = "" if size == 1.0 else ", over its size"
        for name, new, expected in (("a", got[0], L_a + np.cross(r_a, J)), ("b", got[1], L_b + np.cross(J, r_b))):
            close(f"angular momentum of {name} after the impulse{over} [kg m²/s]", new, expected, ROUND_OFF, given)
    L_a, L_b, r_a, r_b, J = drawn
    x_b, x_a = r_a - r_b, STILL                                          # both offsets end at the contact point
    gain_a, gain_b = (np.asarray(L) - old for L, old in zip(lesson.angular_momenta(*drawn), (L_a, L_b), strict=True))
    close("angular momentum gained about one point by both together [kg m²/s]",
          gain_a + np.cross(x_a, J) + gain_b - np.cross(x_b, J), STILL, 1e-11,
          given=f"L_a = {L_a}, L_b = {L_b}, r_a = {r_a}, r_b = {r_b}, J = {J}")


# ---------------------------------------------------------------------------------------------- friction, and energy

@exercise("7.9", points=1,
          hint="apply a unit impulse along each axis: it changes the point's velocity by J/m + (I⁻¹ (r × J)) × r")
def test_an_impulse_moves_its_own_point_by_K_J(lesson, draw):
    arm, free = draw(-1.0, 1.0, 3), solid(draw, lesson)
    upright = free._replace(inv_inertia=np.diag(draw(0.5, 5.0, 3)))      # principal axes along x, y and z
    for body in (*restrained(free), *restrained(upright)):
        inv_mass, inv_inertia = body.inv_mass, body.inv_inertia
        for r in (arm, STILL, *arrows(draw, 3), draw(10.0, 20.0) * arm, *(10.0**-k * arm for k in range(1, 6))):
            J = draw(-3.0, 3.0, 3)
            given = f"r = {r} m, 1/m = {inv_mass} 1/kg, I⁻¹ = {inv_inertia.tolist()}, J = {J} N s"
            K = np.asarray(lesson.contact_matrix(r, inv_mass, inv_inertia))
            transposed = K.T if K.shape == (3, 3) else np.zeros((3, 3))
            size = max(1.0, r @ r)
            close("K [1/kg]: shape and symmetry", K, transposed, size * ROUND_OFF, given=given)
            close("K J [m/s]", K @ J, answer(r, inv_mass, inv_inertia, J), size * ROUND_OFF, given=given)
    for size in SIZES[1:]:
        K = np.asarray(lesson.contact_matrix(arm, size * free.inv_mass, size * free.inv_inertia))
        close("K J of a very heavy or light body, over its size [m/s]", K @ J / size,
              answer(arm, free.inv_mass, free.inv_inertia, J), ROUND_OFF,
              given=f"r = {arm} m, inverse mass and inertia times {size}, J = {J} N s")
    close("K of an immovable body [1/kg]", lesson.contact_matrix(arm, 0.0, np.zeros((3, 3))),
          np.zeros((3, 3)), 0.0, given=f"r = {arm} m")


def meeting(draw, n, slip, u_n):
    """u with normal component u_n and tangential magnitude slip, in a drawn tangential direction."""
    t = across(n, unit(draw, 3))
    return u_n * n + slip / np.linalg.norm(t) * t


def hit_centrally(lesson, draw):
    """Check an ordinary contact first, because an answer that returns zeros or always raises passes the special cases.

    With u = u_sep n − K J, the impulse J = j n is the one that sticks.
    """
    n, K = contact(draw)
    J, u_sep = draw(0.5, 2.0) * n, draw(0.1, 0.5)
    got = lesson.cone_impulse(u_sep * n - K @ J, n, K, u_sep, draw(0.1, 1.0))
    close("impulse of an ordinary contact [N s]", got, J, 1e-11,
          given=f"n = {n}, K = {K.tolist()}, u_sep = {u_sep} m/s")


@exercise("7.10", points=0.125, hint="where n · u ≥ u_sep there is nothing to do: J = 0")
def test_contacts_that_part_fast_enough_get_no_impulse(lesson, draw):
    hit_centrally(lesson, draw)
    n, K = contact(draw)
    just = draw(0.1, 1.0)
    for u_n, u_sep in ((draw(0.5, 2.0), 0.0), (draw(1.1, 2.0), draw(0.1, 1.0)), (1.01 * just, just)):
        got = lesson.cone_impulse(meeting(draw, n, draw(0.5, 3.0), u_n), n, K, u_sep, draw(0.1, 1.0))
        close("impulse on separating bodies [N s]", got, STILL, 0.0, given=f"n · u = {u_n} m/s, u_sep = {u_sep} m/s")
    _, K = contact(draw)
    n = np.eye(3)[draw.whole(0, 2)]                                      # along an axis, n · u is exactly u_sep
    slip = across(n, draw(0.5, 3.0, 3))
    # in the direction in which a sticking impulse would push, not pull
    slip = slip if n @ np.linalg.solve(K, slip) < 0.0 else -slip
    for u_sep in (0.0, draw(0.1, 1.0)):
        got = lesson.cone_impulse(slip + u_sep * n, n, K, u_sep, np.inf)
        close("impulse on bodies that separate at u_sep and slide [N s]", got, STILL, 0.0,
              given=f"u = {slip + u_sep * n} m/s, n = {n}, u_sep = {u_sep} m/s, μ = inf")
    for k in (5, 15, 25, 35):                                            # hardly too slow, in powers of two: an impulse
        u_sep, missing, share = 2.0 ** -draw.whole(0, 3), 2.0**-k, draw(0.1, 0.9)
        for goal, u_n in ((u_sep, u_sep - missing), (0.0, -missing)):
            u = 2.0**10 * slip + u_n * n
            stick = np.linalg.solve(K, goal * n - u)
            size_t = np.linalg.norm(across(n, stick))
            mu = share * min(1.0, size_t / (stick @ n))                  # too little to stick
            rim = n + mu / size_t * across(n, stick)
            close("impulse on bodies that separate a little too slowly, over what they miss [kg]",
                  np.asarray(lesson.cone_impulse(u, n, K, goal, mu)) / missing, rim / (n @ K @ rim), 1e-10,
                  given=f"u = {u} m/s, n = {n}, K = {K.tolist()}, u_sep = {goal} m/s, μ = {mu}")


@exercise("7.10", points=0.125,
          hint="with enough friction the contact sticks: u + K J = u_sep n, so J = K⁻¹ (u_sep n − u)")
def test_enough_friction_leaves_nothing_along_the_surface(lesson, draw):
    for u_sep, mu in ((draw(0.1, 2.0), np.inf), (0.0, 1e6)):
        n, K = contact(draw)
        u = meeting(draw, n, 0.05, -draw(2.0, 4.0))
        stick = np.linalg.solve(K, u_sep * n - u)
        # Only an unusual K makes sticking pull, or hardly push. Then this cone does not contain the impulse.
        if stick @ n <= 1e-3 * np.linalg.norm(stick):
            continue
        # The condition number of K is below 100 here, so K⁻¹ times a vector below 30 has an error below 1e-12.
        close("relative velocity after sticking [m/s]", u + K @ lesson.cone_impulse(u, n, K, u_sep, mu), u_sep * n,
              1e-11,
              given=f"u = {u} m/s, n = {n}, K = {K.tolist()}, u_sep = {u_sep} m/s")


@exercise("7.10", points=0.25,
          hint="slide: |J_t| = μ J_n, J_t in the direction of the sticking J_t, the size such that n · u⁺ = u_sep")
def test_too_little_friction_slides_on_the_rim_of_the_cone(lesson, draw):
    for share, u_sep, size, heavy in ((draw(0.1, 0.9), 0.0, 1.0, 1.0),
                                  (draw(0.1, 0.9), draw(0.1, 2.0), 1.0, 1.0),
                                  (0.99, draw(0.1, 2.0), 1.0, 1.0),
                                  (1.0 - 1e-6, draw(0.1, 2.0), 1.0, 1.0),
                                  *((10.0**-k, draw(0.1, 2.0), 1.0, 1.0) for k in (3, 5, 7)),
                                  (0.0, draw(0.1, 1.0), 1.0, 1.0),
                                  (draw(0.1, 0.9), TINY * draw(0.1, 2.0), TINY, 1.0),
                                  (draw(0.1, 0.9), 0.0, TINY, 1.0),
                                  (draw(0.1, 0.9), draw(0.1, 2.0), 1.0, 1e20)):
        n, K = contact(draw)
        K = K / heavy
        u = size * meeting(draw, n, draw(1.0, 3.0), -draw(0.5, 2.0))
        stick = np.linalg.solve(K, u_sep * n - u)
        size_t = np.linalg.norm(across(n, stick))
        along = across(n, stick) / size_t
        mu = share * (size_t / (stick @ n) if stick @ n > 0.0 else 1.0)
        J = np.asarray(lesson.cone_impulse(u, n, K, u_sep, mu))
        given = f"u = {u} m/s, n = {n}, K = {K.tolist()}, u_sep = {u_sep} m/s, μ = {mu}"
        close("normal velocity after the impact [m/s]", n @ (u + K @ J), u_sep, 1e-11 * size, given=given)
        close("tangential impulse [N s]: μ J_n in the sticking direction", across(n, J), mu * (J @ n) * along,
              1e-10 * size * heavy, given=given)
    for n, J, u_sep in upright_cones(draw):
        k, ratio = 2.0 ** draw.whole(-2, 2), np.linalg.norm(across(n, J)) / (J @ n)
        u = u_sep * n - k * J
        given = f"u = {u} m/s, n = {n}, K = {k} on its diagonal, u_sep = {u_sep} m/s"
        for share in (1.3, 1.0 + 1e-6, 1.0 - 1e-6, draw(0.3, 0.8)):
            close(f"impulse that {'sticks' if share > 1.0 else 'slides'} [N s]",
                  lesson.cone_impulse(u, n, k * np.eye(3), u_sep, share * ratio),
                  (J @ n) * n + min(1.0, share) * across(n, J), 1e-11, given=f"{given}, μ = {share * ratio}")


def upright_cones(draw):
    """(n, J, u_sep): normals along the axes and others, J_t along each axis, and with components that add up to 0.

    In a K of k times 1 with a power of two for k, J_t has no round-off where n is along an axis.
    """
    for n in normals(draw, 3):
        sides = (np.roll(n, 1), np.roll(n, 2)) if np.count_nonzero(n) == 1 else (across(n, unit(draw, 3)),)
        for t in (*sides, -sides[0], sides[0] + sides[-1], sides[0] - 2.0 * sides[-1], sides[-1] - sides[0]):
            if t.any():
                yield n, draw(0.5, 2.0) * n + draw(0.2, 1.0) * t, draw(0.1, 0.5)


def steep(draw, low, high):
    """(n, K, J, ratio): a contact and an impulse with |J_t| = ratio J_n, which drives the bodies apart along n."""
    n, K = contact(draw)
    ratio, t = draw(low, high), across(n, unit(draw, 3))
    t = t / np.linalg.norm(t) * (1.0 if n @ K @ t > 0.0 else -1.0)
    return n, K, draw(0.5, 2.0) * (n + ratio * t), ratio


@exercise("7.10", points=0.125,
          hint="compare |J_t|, not |J|, with μ J_n; where 0 < n · u < u_sep the bodies separate too slowly and need "
               "an impulse")
def test_a_wide_enough_cone_sticks_also_where_bodies_separate_too_slowly(lesson, draw):
    """With u = u_sep n − K J, the sticking impulse is J."""
    for slow, much in itertools.product((False, True), (1.0, 1e-4, 1e-7)):
        n, K = contact(draw)
        rho, t = much * draw(0.05, 0.2), across(n, unit(draw, 3))
        J = draw(0.5, 2.0) * (n + rho * t / np.linalg.norm(t))
        u_sep = n @ K @ J + draw(0.1, 0.5) if slow else draw(0.1, 0.5)
        u = u_sep * n - K @ J
        for mu in (1.01 * rho, 1.3 * rho, (1.0 + 1e-6) * rho):
            got = lesson.cone_impulse(u, n, K, u_sep, mu)
            close("impulse that sticks [N s]", got, J, 1e-11,
                  given=f"u = {u} m/s, n = {n}, K = {K.tolist()}, u_sep = {u_sep} m/s, μ = {mu}")
    # Without slip K still turns a normal impulse into slip, which friction holds as far as it can.
    for comes in (1.0, 0.0):                                             # at 0 both points are at rest, and must part
        _, K = contact(draw)
        n, u_sep = np.eye(3)[draw.whole(0, 2)], draw(0.1, 0.5)
        u = 0.0 - comes * n
        stick = np.linalg.solve(K, (u_sep + comes) * n)
        ratio, less = np.linalg.norm(across(n, stick)) / (stick @ n), draw(0.3, 0.8)
        given = f"u = {u} m/s, n = {n}, K = {K.tolist()}, u_sep = {u_sep} m/s"
        close("impulse that sticks, without slip before [N s]", lesson.cone_impulse(u, n, K, u_sep, 1.3 * ratio), stick,
              1e-11, given=f"{given}, μ = {1.3 * ratio}")
        rim = n + less * across(n, stick) / (stick @ n)
        close("impulse that slides, without slip before [N s]", lesson.cone_impulse(u, n, K, u_sep, less * ratio),
              (u_sep + comes) / (n @ K @ rim) * rim, 1e-11, given=f"{given}, μ = {less * ratio}")
    # Exactly along n there is nothing to hold, and a friction of 0 is enough.
    n, k, u_sep = np.eye(3)[draw.whole(0, 2)], draw(0.5, 2.0), draw(0.1, 0.5)
    close("impulse of a central impact without friction [N s]", lesson.cone_impulse(-n, n, k * np.eye(3), u_sep, 0.0),
          (u_sep + 1.0) / k * n, ROUND_OFF,
          given=f"u = {-n} m/s, n = {n}, K = {k} on its diagonal, u_sep = {u_sep} m/s, μ = 0")


@exercise("7.10", points=0.125, hint="a large μ is still finite: compare |J_t| with μ J_n, and slide with this μ")
def test_much_friction_sticks_or_slides_as_little_friction_does(lesson, draw):
    """K has a condition number below 100, and impulses below 1e3; in the last case 1e6, with round-off of 1e-9."""
    for low, high in ((3.0, 10.0), (20.0, 50.0), (100.0, 200.0), (1e5, 1e6)):
        n, K, J, ratio = steep(draw, low, high)
        u_sep = draw(0.1, 0.5)
        u = u_sep * n - K @ J
        given = f"u = {u} m/s, n = {n}, K = {K.tolist()}, u_sep = {u_sep} m/s"
        close("impulse that sticks [N s]", lesson.cone_impulse(u, n, K, u_sep, 1.01 * ratio), J, 1e-9 * max(1.0, ratio),
              given=f"{given}, μ = {1.01 * ratio}")
        mu = draw(0.7, 0.99) * ratio
        along = n + mu / ratio * (J / (J @ n) - n)
        close("impulse that slides [N s]", lesson.cone_impulse(u, n, K, u_sep, mu),
              (u_sep - u @ n) / (n @ K @ along) * along, 1e-9 * max(10.0, ratio), given=f"{given}, μ = {mu}")


@exercise("7.10", points=0.5,
          hint="a sticking impulse that pulls, J_n < 0, is outside every cone: slide; β = arctan μ also handles μ = ∞")
def test_a_contact_slides_where_sticking_would_have_to_pull(lesson, draw):
    n, K = contact(draw)
    side = across(n, K @ n) / np.linalg.norm(across(n, K @ n))
    for pull, mu in itertools.product((0.5, 1e-4, 1e-8), (draw(0.3, 1.0), 5.0, np.inf)):
        J, u_sep = side - pull * (n @ K @ side) / (n @ K @ n) * n, draw(0.1, 0.5)
        u = u_sep * n - K @ J
        got = np.asarray(lesson.cone_impulse(u, n, K, u_sep, mu))
        given = f"u = {u} m/s, n = {n}, K = {K.tolist()}, u_sep = {u_sep} m/s, μ = {mu}"
        close("normal velocity after the impact [m/s]", n @ (u + K @ got), u_sep, 1e-10, given=given)
        between("normal impulse [N s]: never a pull", got @ n, -ROUND_OFF, 1e3, given=given)
        beta = np.arctan(mu)
        close("impulse perpendicular to the rim of the cone [N s]: none",
              np.cos(beta) * across(n, got) - np.sin(beta) * (got @ n) * side, STILL, 1e-10, given=given)


@exercise("7.10", points=0.25, hint="call check_contact first")
def test_contacts_without_physics_are_refused(lesson, draw):
    hit_centrally(lesson, draw)
    n, K = contact(draw)
    axis = np.eye(3)[draw.whole(0, 2)]
    spoiled = [np.where(np.arange(3) == k, bad, 1.0) for k in range(3) for bad in (np.nan, np.inf, -np.inf)]
    for u_n in (-1.0, 1.0):                                              # approaching, separating
        u = meeting(draw, n, 1.0, u_n)
        refused = {
            "a negative friction": [(u, n, K, 0.0, -mu) for mu in (draw(0.1, 1.0), 1e-9, np.inf)],
            "a friction that is not a number": [(u, n, K, 0.0, np.nan)],
            "a zero normal": [(u, STILL, K, 0.0, 0.3)],
            "a normal whose length is not 1": [(u, size * n, K, 0.0, 0.3) for size in (2.0, 0.5, 1.01, 0.99)],
            "two immovable bodies": [(u, n, np.zeros((3, 3)), 0.0, 0.3)],
            "a K that pulls": [(u, n, -K, 0.0, 0.3)],
            "a K with an entry that is not a number": [(u, n, K * spoiled[3 * k], 0.0, 0.3) for k in range(3)],
            "a K that is not zero along n only": [(u_n * axis, axis, np.diag(axis), 0.0, 0.3)],
            "a velocity with a component that is not finite": [(bad * u, n, K, 0.0, 0.3) for bad in spoiled],
        }
        for case, many in refused.items():
            for arguments in many:
                raises(f"{case}, with n · u = {u_n} m/s", BadInput, lesson.cone_impulse, *arguments)


@exercise("7.11", points=1, hint="J times the mean of the velocities before and after: J · u + ½ J · K J")
def test_the_energy_of_an_impact_is_what_both_bodies_gain(lesson, draw):
    r_a, r_b, drawn = (draw(-1.0, 1.0, 3) for _ in range(3))
    m_a, m_b = draw(0.5, 3.0), draw(0.5, 3.0)
    inverse_a, inverse_b = inertia(draw), inertia(draw)

    def energy(m, v, inv_inertia, omega):
        return 0.5 * m * v @ v + 0.5 * omega @ np.linalg.solve(inv_inertia, omega)

    # The sign of a small J decides gain or loss.
    cases = [(draw(-1.0, 1.0, (4, 3)), share * drawn) for share in (1.0, -1.0, 0.01, -0.01, 0.0)]
    cases += [(np.zeros((4, 3)), drawn), *((draw.sparse(-1.0, 1.0, (4, 3)), draw.sparse(-1.0, 1.0, 3)) for _ in "abc")]
    for (v_a, v_b, w_a, w_b), J in cases:
        after_a = energy(m_a, v_a + J / m_a, inverse_a, w_a + inverse_a @ np.cross(r_a, J))
        after_b = energy(m_b, v_b - J / m_b, inverse_b, w_b - inverse_b @ np.cross(r_b, J))
        gained = after_a - energy(m_a, v_a, inverse_a, w_a) + after_b - energy(m_b, v_b, inverse_b, w_b)
        u = v_a + np.cross(w_a, r_a) - v_b - np.cross(w_b, r_b)
        K = np.stack([answer(r_a, 1.0 / m_a, inverse_a, axis) + answer(r_b, 1.0 / m_b, inverse_b, axis)
                      for axis in np.eye(3)], axis=1)
        close("energy gained [J]", lesson.energy_change(u, K, J), gained, 1e-11,
              given=f"u = {u} m/s, K = {K.tolist()}, J = {J} N s")
    u = draw(-1.0, 1.0, 3)                           # not that of the last case, in which everything may be at rest
    pairs = [(special, drawn) for special in (*arrows(draw, 3), STILL)] + [(u, special) for special in arrows(draw, 3)]
    pairs += [(u, 10.0**-k * drawn) for k in (3, 6, 9)] + [(10.0**k * u, 10.0**k * drawn) for k in (3, 6, 9)]
    pairs += [(size * u, size * drawn) for size in SIZES]
    pairs += [(u, 0.1 * side / np.trace(K) * u) for side in (1.0, -1.0)]           # certainly a gain, and a loss
    for u, J in pairs:                                                   # the work: J times the mean velocity
        size = np.linalg.norm(J) * (np.linalg.norm(u) + np.linalg.norm(J))
        close("energy gained, over |J| (|u| + |J|) [-]", lesson.energy_change(u, K, J) / size,
              J @ (u + (u + K @ J)) / (2.0 * size), 1e-11, given=f"u = {u} m/s, K = {K.tolist()}, J = {J} N s")


# ---------------------------------------------------------------------------------------------- when

def gap_and_multiplier(lesson, draw, closes, size):
    """closes: distance travelled in this step as a fraction of the gap."""
    phi, k, dt = size * draw(0.01, 0.5), draw(0.3, 3.0), draw(0.01, 0.1)
    u_n = -closes * phi / dt
    lam = float(lesson.gap_multiplier(phi, u_n, k, dt))
    given = f"φ = {phi} m, u_n = {u_n} m/s, k_n = {k} 1/kg, dt = {dt} s"
    after = phi + dt * (u_n + k * lam)
    between("multiplier [N s]", lam, 0.0, 1e4, given=given)
    between("gap at the end of the step [m]", after, -ROUND_OFF * size, 1e4, given=given)
    close("multiplier times gap", lam * after, 0.0, 1e-9 * size**2, given=given)                 # λ is below 1,000 here


@exercise("7.12", points=1, hint="either φ + dt u_n stays positive and λ = 0, or λ makes φ + dt (u_n + k_n λ) zero")
def test_gap_and_multiplier_are_never_below_zero_and_one_of_them_is_zero(lesson, draw):
    for share in draw.within():
        gap_and_multiplier(lesson, draw, share, 1.0)
    u_n, k = -draw(0.5, 2.0), draw(0.3, 3.0)
    close("multiplier of a resting contact [N s]", lesson.gap_multiplier(0.0, u_n, k, 0.1), -u_n / k, ROUND_OFF,
          given=f"φ = 0, u_n = {u_n} m/s, k_n = {k} 1/kg, dt = 0.1 s")
    for closes, size in (*((share, 1.0) for share in draw.beyond(5.0)), (draw(1.1, 5.0), TINY), (0.0, 1.0),
                         (-draw(0.5, 2.0), 1.0)):
        gap_and_multiplier(lesson, draw, closes, size)
    for k in range(40):                                                  # of any size: nothing is limited
        phi, k_n, dt = 10.0 ** draw(-12.0, 6.0), 10.0 ** draw(-9.0, 9.0), 10.0 ** draw(-9.0, 2.0)
        closes = draw(1.1, 5.0) if k % 4 else draw(-5.0, 0.9)
        lam = lesson.gap_multiplier(phi, -closes * phi / dt, k_n, dt)
        close("k_n dt/φ times the multiplier [-]", lam * k_n * dt / phi, max(0.0, closes - 1.0), ROUND_OFF * 10.0,
              given=f"φ = {phi} m, u_n = {-closes * phi / dt} m/s, k_n = {k_n} 1/kg, dt = {dt} s")
    close("multiplier of a closed gap that opens [N s]", lesson.gap_multiplier(0.0, draw(0.5, 2.0), 2.0, 0.1), 0.0, 0.0)
    for u_n, gap, phi in ((-draw(2.0, 5.0), "closes", 0.1), (draw(0.5, 2.0), "opens", 0.1), (0.0, "stays", 0.1),
                          (-draw(0.5, 2.0), "is closed", 0.0), (0.0, "stays closed", 0.0)):
        raises(f"two immovable bodies whose gap {gap}", BadInput, lesson.gap_multiplier, phi, u_n, 0.0, 0.1)
        for k in (-draw(0.5, 2.0), -1e-9, -np.inf, np.inf, np.nan):
            raises(f"an inverse mass that is not positive and finite, where the gap {gap}", BadInput,
                   lesson.gap_multiplier, phi, u_n, k, 0.1)
        for dt in (0.0, -0.1, -1e-9, np.inf, -np.inf, np.nan):
            raises(f"a step of {dt} s, where the gap {gap}", BadInput, lesson.gap_multiplier, phi, u_n, 1.0, dt)


def height(phi, v_n, a_n):
    return lambda tau: phi + v_n * tau + 0.5 * a_n * tau * tau


@exercise("7.13", points=0.5,
          hint="take the root at which the gap closes: the first for v_n < 0, the second if the gap opens first; at "
                "most dt, and 0 where φ = 0 and a_n pulls the ball in")
def test_the_moment_of_impact_is_a_root_of_the_gap(lesson, draw):
    phi, speed = draw(0.2, 2.0), draw(0.5, 5.0)
    for v_n, a_n in ((-speed, -draw(1.0, 10.0)),
                     (speed, -draw(1.0, 10.0)),
                     (0.0, -draw(1.0, 10.0)),
                     (-speed, draw(0.1, 0.9) * speed**2 / (2.0 * phi)),
                     (-speed, 0.0)):
        top = v_n / -a_n if a_n < 0.0 and v_n > 0.0 else 0.0
        end = speed / a_n if a_n > 0.0 else 20.0
        expected = brentq(height(phi, v_n, a_n), top, end, xtol=1e-15, rtol=1e-14)
        given = f"φ = {phi} m, v_n = {v_n} m/s, a_n = {a_n} m/s²"
        # The error of the root is that of φ, 1e-16, divided by the speed at the root, which is above 0.1.
        close("time of impact [s]", lesson.impact_time(phi, v_n, a_n, 1e3), expected, 1e-11, given=given)
        close("time of impact with all lengths multiplied by 1e-20 [s]",
              lesson.impact_time(TINY * phi, TINY * v_n, TINY * a_n, 1e3), expected, 1e-11, given=given)
        close("time of impact if the step ends first [s]: dt", lesson.impact_time(phi, v_n, a_n, 0.9 * expected),
              0.9 * expected, ROUND_OFF, given=given)


def nearly_grazing(lesson, draw, phi, speed):
    """Check gaps that just close and just do not, and very small ones; φ and speed are powers of two."""
    # A little more acceleration, and the gap does not close; a little less, and it closes a little earlier.
    for k in (3, 6, 9, 12):
        a_n = 0.5 * speed**2 / phi * (1.0 + 10.0**-k)
        close("time of an impact that just does not come [s]: dt", lesson.impact_time(phi, -speed, a_n, 1e3), 1e3, 0.0,
              given=f"φ = {phi}, v_n = {-speed}, a_n = {a_n}")
        a_n = 0.5 * speed**2 / phi * (1.0 - 2.0 ** (-2 * k))             # s is speed/2ᵏ
        close("time of an almost grazing impact [s]", lesson.impact_time(phi, -speed, a_n, 1e3),
              2.0 * phi / speed / (1.0 + 2.0**-k), 1e-10, given=f"φ = {phi}, v_n = {-speed}, a_n = {a_n}")
    for k in (6, 9, 12):                                 # τ v/φ = 1 − x/2 + x²/2 − …  with  x = |a| φ/v² < 2e-4
        small, pull = 10.0**-k * draw(0.1, 0.9), draw(1.0, 9.0)
        x = pull * small / speed**2
        close("time of impact from a very small height, over φ/v [-]",
              lesson.impact_time(small, -speed, -pull, 1e3) / (small / speed), 1.0 - 0.5 * x + 0.5 * x * x,
              1e-9 if k == 6 else ROUND_OFF, given=f"φ = {small}, v_n = {-speed}, a_n = {-pull}")


@exercise("7.13", points=0.25,
          hint="return dt if the gap never closes; at or below the surface φ counts as 0; do not divide by a tiny a_n")
def test_the_impact_time_is_dt_without_an_impact_and_zero_for_a_ball_pressed_in(lesson, draw):
    phi, speed, dt = draw(0.5, 2.0), draw(0.5, 2.0), draw(5.0, 9.0)
    for v_n, a_n in ((speed, 0.0),
                     (0.0, 0.0),
                     (speed, draw(0.1, 2.0)),
                     (-speed, draw(1.1, 3.0) * speed**2 / (2.0 * phi))):
        for size in (1.0, 1e-3, 1e-6, TINY, 1e6):
            close("time of an impact that never comes [s]: dt", lesson.impact_time(phi, v_n, a_n, size * dt), size * dt,
                  0.0, given=f"φ = {phi}, v_n = {v_n}, a_n = {a_n}, dt = {size * dt}")
    for inside in (0.0, -draw(0.01, 0.1)):
        close("time of impact of a ball that moves inward [s]", lesson.impact_time(inside, -speed, -1.0, dt),
              0.0, 0.0, given=f"φ = {inside}")
        close("time of impact of a ball at rest that is pulled in [s]", lesson.impact_time(inside, 0.0, -1.0, dt),
              0.0, 0.0, given=f"φ = {inside}")
        close("time of impact of a ball at rest without acceleration [s]: dt",
              lesson.impact_time(inside, 0.0, 0.0, dt), dt, 0.0, given=f"φ = {inside}, v_n = 0, a_n = 0, dt = {dt}")
        close("time until a ball thrown from there comes back [s]", lesson.impact_time(inside, speed, -2.0, dt),
              speed, ROUND_OFF, given=f"φ = {inside}, v_n = {speed}")
    close("time of impact where a_n is nearly zero [s]", lesson.impact_time(phi, -speed, -1e-14, dt),
          phi / speed, ROUND_OFF, given=f"φ = {phi}, v_n = {-speed}")
    # In powers of two v_n² − 2 a_n φ is exactly 0: the gap closes for a moment, at the top of its parabola.
    phi, speed = 2.0 ** draw.whole(-2, 2), 2.0 ** draw.whole(-2, 2)
    close("time of a grazing impact [s]", lesson.impact_time(phi, -speed, 0.5 * speed**2 / phi, 1e3),
          2.0 * phi / speed, ROUND_OFF * 100.0, given=f"φ = {phi}, v_n = {-speed}, a_n = {0.5 * speed**2 / phi}")
    nearly_grazing(lesson, draw, phi, speed)
    # A ball that has just left, by less than 1e-9 of its flight, comes back after 2v/|a| (1 + 1e-9).
    phi, speed, pull = 1e-9 * draw(0.1, 0.9), draw(1.0, 2.0), draw(1.0, 2.0)
    close("time until a ball that has just left comes back [s]", lesson.impact_time(phi, speed, -pull, 1e3),
          2.0 * speed / pull + phi / speed, ROUND_OFF, given=f"φ = {phi}, v_n = {speed}, a_n = {-pull}")


@exercise("7.13", points=0.25,
          hint="φ, v_n and a_n may have any sign: draw the parabola and find where it first falls to zero")
def test_the_gap_is_open_until_the_moment_of_impact_and_closes_there_for_all_signs(lesson, draw):
    """Evaluate the parabola at 400 times. Its round-off is 1e-15 of its terms, and 1e-14 of them is allowed."""
    for side in (1.0, 0.0, -1.0):
        for up in (1.0, 0.0, -1.0):
            for pull in (1.0, 1e-12, 0.0, -1e-12, -1.0):
                for dt in 10.0 ** np.append(draw(-2.0, 2.0, 3), (draw(-12.0, -4.0), draw(3.0, 6.0))):
                    phi, v_n, a_n = side * draw(0.1, 2.0), up * draw(0.1, 5.0), pull * draw(0.5, 9.0)
                    tau = float(lesson.impact_time(phi, v_n, a_n, float(dt)))
                    gap = height(max(phi, 0.0), v_n, a_n)
                    given = f"φ = {phi} m, v_n = {v_n} m/s, a_n = {a_n} m/s², dt = {dt} s"
                    known = 1e-14 * (abs(phi) + abs(v_n) * dt + abs(a_n) * dt * dt)
                    between("time of impact [s]", tau, 0.0, dt, given)
                    least = gap(tau * np.linspace(0.0, 1.0, 400)).min()
                    between("least gap before it [m]", least, -known, np.inf, given)
                    if tau < dt:
                        close("gap at that time [m]", gap(tau), 0.0, known, given)
                        rate = v_n + a_n * tau - 1e-9 * abs(a_n) * dt    # round-off may be its sign
                        between("change of the gap shortly after [m/s]", rate, -np.inf, 0.0, given)


def flights_together(e):
    """Times of 2⁶⁴ flights over that of the first one, summed without round-off.

    2ᵏ flights take 1 + e^(2ᵏ⁻¹) times as long as half of them.
    """
    with localcontext(prec=60):
        flights, power = Decimal(1), Decimal(e)
        for _ in range(64):
            flights, power = flights * (1 + power), power * power
    return float(flights)


@exercise("7.14", points=0.5,
          hint="add flights of 2v/|a|, each e times as long as the one before; three cases have no finite sum")
def test_all_bounces_together_take_a_finite_time(lesson, draw):
    for v_n, e in ((1e-6 * draw(0.5, 5.0), draw(0.1, 0.9)), (TINY * draw(0.5, 5.0), draw(0.1, 0.9)),
                   (draw(0.5, 5.0), 1e-6 * draw(0.1, 0.9)), (1e-3 * draw(0.5, 5.0), 0.995),
                   (draw(0.5, 5.0), draw(0.1, 0.9))):
        a_n = -draw(1.0, 10.0)
        total = 2.0 * v_n / -a_n * flights_together(e)
        # at most 400 v_n, with a few round-offs
        close("time of all bounces [s]", lesson.bouncing_time(v_n, a_n, e), total, 1e-11 * v_n,
              given=f"v_n = {v_n} m/s, a_n = {a_n} m/s², e = {e}")
    for size, gravity in itertools.product((1.0, 1e-9, 1e9), repeat=2):
        time = lesson.bouncing_time(size * v_n, gravity * a_n, e) * gravity / size
        close("time of all bounces, over the size of v_n and times that of a_n [s]", time, total, 1e-11 * v_n,
              given=f"v_n = {size * v_n} m/s, a_n = {gravity * a_n} m/s², e = {e}")
    close("time of one flight, as there is no bounce without restitution [s]", lesson.bouncing_time(v_n, a_n, 0.0),
          -2.0 * v_n / a_n, ROUND_OFF, given=f"v_n = {v_n} m/s, a_n = {a_n} m/s², e = 0")
    close("bouncing time of a ball that does not leave [s]",
          [float(lesson.bouncing_time(v, a_n, e)) for v in (0.0, -v_n)], [0.0, 0.0], 0.0,
          given=f"v_n = 0 and {-v_n} m/s, a_n = {a_n} m/s², e = {e}")
    for a, restitution in ((0.0, e), (-a_n, e), (a_n, 1.0)):
        assert_endless(lesson.bouncing_time(v_n, a, restitution), f"v_n = {v_n} m/s, a_n = {a} m/s², e = {restitution}")
        close("bouncing time of a ball that does not leave, where a leaving one bounces forever [s]",
              [float(lesson.bouncing_time(v, a, restitution)) for v in (0.0, -v_n)], [0.0, 0.0], 0.0,
              given=f"v_n = 0 and {-v_n} m/s, a_n = {a} m/s², e = {restitution}")
    nearly_endless(lesson, draw, v_n, a_n)
    close("time of all bounces in very weak gravity, over that of the first flight [-]",
          lesson.bouncing_time(v_n, TINY * a_n, 0.5) / (-2.0 * v_n / (TINY * a_n)), 2.0, ROUND_OFF,
          given=f"v_n = {v_n} m/s, a_n = {TINY * a_n} m/s², e = 0.5")


def nearly_endless(lesson, draw, v_n, a_n):
    """Check bounces with a restitution just below 1."""
    for less in (draw(0.5, 2.0) * 1e-4, draw(1.0, 5.0) * 1e-6, draw(1.0, 5.0) * 1e-10):
        # Without the first flight the sum starts again with e v_n. A sum of 1/less flights has a relative error 1e-15.
        times = np.array([float(lesson.bouncing_time(v, a_n, 1.0 - less)) for v in (v_n, (1.0 - less) * v_n)])
        close("time of all bounces from v_n, less that from e v_n: the time of the first flight [s]",
              times[0] - times[1], 2.0 * v_n / -a_n, 1e-14 * v_n / less,
              given=f"v_n = {v_n} m/s, a_n = {a_n} m/s², e = 1 - {less}")
    for e in (1.0 - 2.0**-40, 1.0 - 2.0**-53):
        close("time of all bounces where e is just below 1, over that of the sum of all flights [-]",
              lesson.bouncing_time(v_n, a_n, e) / (-2.0 * v_n / a_n) / flights_together(e), 1.0, ROUND_OFF,
              given=f"v_n = {v_n} m/s, a_n = {a_n} m/s², e = 1 - {1.0 - e}")


def assert_endless(time, given):
    truth("whether the time of endless bounces is np.inf", float(time) == np.inf, True, given=given)


# ---------------------------------------------------------------------------------------------- a ball above a plane

def drop(draw, lesson, d, e=None):
    """(BouncingBall above a drawn plane, a tangent, gravity along −n, gravity along the tangent)."""
    n, pull, along = unit(draw, d), draw(5.0, 10.0), draw(0.5, 2.0)
    t = across(n, unit(draw, d)[::-1])
    t = t / np.linalg.norm(t)
    e = draw(0.3, 0.9) if e is None else e
    # A penalty spring and damper that no step here uses.
    unused = draw(1e3, 1e5), draw(0.0, 50.0)
    return lesson.BouncingBall(e, along * t - pull * n, draw(-2.0, 2.0, d), n, *unused), t, pull, along


def swaying(t, x, v, p):
    """An acceleration that depends on all its arguments."""
    return np.cos(t) * p.gravity + 0.5 * x - 0.5 * v


@exercise("7.15", points=0.5,
          hint="kinematic_response keeps the velocity of a leaving ball; evaluate "
               "acceleration(t, x, v, p) at the start of the step")
def test_a_projecting_step_puts_back_a_leaving_ball_and_evaluates_the_acceleration(lesson, draw):
    for d in (2, 3):
        p, t, _, along = drop(draw, lesson, d)
        dt, speed, slip, depth = draw(0.01, 0.05), draw(1.0, 5.0), draw(1.0, 3.0), draw(0.5, 1.0)
        x, v = p.point - depth * p.n, slip * t + speed * p.n
        got = lesson.position_projection_step(lesson.falling_acceleration, 0.0, x, v, dt, p)
        given = f"φ = {-depth} m, v = {v} m/s, dt = {dt} s, {p}"
        close("position of a ball that starts inside and leaves [m]", got[0], p.point + dt * (slip + dt * along) * t,
              1e-11, given=given)
        close("velocity of a ball that starts inside and leaves [m/s]", got[1], v + dt * p.gravity, 1e-11, given=given)
        # Gravity turns it round within the step: it leaves, slower than gravity makes it in dt, and ends inside.
        pull = -(p.gravity @ p.n)
        speed = draw(0.2, 0.8) * dt * pull
        x, v = p.point + draw(0.1, 0.9) * dt * (dt * pull - speed) * p.n, slip * t + speed * p.n
        got = lesson.position_projection_step(lesson.falling_acceleration, 0.0, x, v, dt, p)
        given = f"x = {x} m, v = {v} m/s, dt = {dt} s, {p}"
        tangent = slip + dt * along
        moved = x - (x - p.point) @ p.n * p.n + dt * tangent * t
        close("position of a ball that leaves until gravity pulls it back in [m]", got[0], moved, 1e-11, given=given)
        close("velocity of a ball that leaves until gravity pulls it back in [m/s]", got[1],
              tangent * t + p.e * (dt * pull - speed) * p.n, 1e-11, given=given)
        time, x, v = draw(0.5, 1.0), p.point + depth * p.n, slip * t + draw(1.0, 5.0) * p.n
        got = lesson.position_projection_step(swaying, time, x, v, dt, p)
        v_new = v + dt * swaying(time, x, v, p)
        given = f"a = g cos t + x/2 - v/2, t = {time} s, x = {x} m, v = {v} m/s, dt = {dt} s, {p}"
        close("velocity after a step outside [m/s]", got[1], v_new, 1e-11, given=given)
        close("position after a step outside [m]", got[0], x + dt * v_new, 1e-11, given=given)
        for way in (1.0, -1.0):                                          # deep inside, on its way out or in
            x, v = p.point - draw(3.0, 5.0) * p.n, slip * t + way * draw(3.0, 5.0) * p.n
            got = lesson.position_projection_step(swaying, time, x, v, dt, p)
            v_new = v + dt * swaying(time, x, v, p)
            place = x + dt * v_new
            given = f"a = g cos t + x/2 - v/2, t = {time} s, x = {x} m, v = {v} m/s, dt = {dt} s, {p}"
            close("velocity of a ball that starts and ends deep inside [m/s]", got[1], bounced_off(v_new, p.n, p.e),
                  1e-11, given=given)
            close("position of a ball that starts and ends deep inside [m]", got[0],
                  place - ((place - p.point) @ p.n) * p.n, 1e-11, given=given)


def let_go(lesson, draw, d):
    """Check a projecting step from rest above, on and inside a plane through the origin, also without gravity."""
    n, t = np.eye(d)[:2]
    fall, side, dt = draw(5.0, 10.0), draw(0.5, 2.0), draw(0.01, 0.05)
    for e in (0.0, draw(0.1, 0.9), 1.0):
        for pull, along in ((fall, side), (fall, 0.0), (0.0, side), (0.0, 0.0)):
            p = lesson.BouncingBall(e, along * t - pull * n, np.zeros(d), n, 1e4, 10.0)
            for high in (2.0 * dt**2 * fall, 0.0, -2.0 * dt**2 * fall):
                got = lesson.position_projection_step(lesson.falling_acceleration, 0.0, high * n, np.zeros(d), dt, p)
                ends = high - dt**2 * pull
                given = f"φ = {high} m, v = 0, dt = {dt} s, {p}"
                close("position of a ball that starts at rest [m]", got[0], max(0.0, ends) * n + dt**2 * along * t,
                      ROUND_OFF, given=given)
                close("velocity of a ball that starts at rest [m/s]", got[1],
                      dt * (e * pull if ends < 0.0 else -pull) * n + dt * along * t, ROUND_OFF, given=given)


@exercise("7.15", points=0.5,
          hint="first v, then x; if x is then inside, reverse the normal velocity and move x back along n")
def test_a_projecting_step_reflects_and_puts_back_a_ball_that_ends_inside(lesson, draw):
    for d in (2, 3):
        p, t, pull, along = drop(draw, lesson, d)
        dt, speed, slip = draw(0.01, 0.05), draw(1.0, 5.0), draw(1.0, 3.0)
        v = slip * t - speed * p.n
        moved = dt * (speed + dt * pull)                                 # normal distance travelled in this step
        cases = ((draw(0.1, 0.9), True, 1.0), *((share, False, 1.0) for share in draw.beyond(3.0)),
                 (0.99999, True, 1.0), *((share, share < 1.0, size) for size in (TINY, 1e3, 1e6, 1.0 / TINY)
                                         for share in (draw(0.1, 0.9), draw(1.1, 3.0))))
        for share, hits, size in cases:
            x = p.point + share * moved * p.n
            scaled = p._replace(gravity=size * p.gravity, point=size * p.point)
            got = lesson.position_projection_step(lesson.falling_acceleration, 0.0, size * x, size * v, dt, scaled)
            given = f"φ = {size * share * moved} m, v = {size * v} m/s, dt = {dt} s, {scaled}"
            tangent = slip + dt * along
            v_n = p.e * (speed + dt * pull) if hits else -(speed + dt * pull)
            place = p.point + (0.0 if hits else (share - 1.0) * moved) * p.n + dt * tangent * t
            close("position after the step [m]", got[0], size * place, 1e-11 * size, given=given)
            close("velocity after the step [m/s]", got[1], size * (tangent * t + v_n * p.n), 1e-11 * size, given=given)
        # In whole numbers and powers of two it ends exactly on the plane.
        n, dt, speed = np.eye(d)[draw.whole(0, d - 1)], 2.0 ** -draw.whole(3, 6), float(draw.whole(1, 4))
        p = p._replace(n=n, gravity=-8.0 * n, point=np.array([float(draw.whole(-3, 3)) for _ in range(d)]))
        x, v = p.point + dt * (speed + 8.0 * dt) * n, -speed * n
        got = lesson.position_projection_step(lesson.falling_acceleration, 0.0, x, v, dt, p)
        given = f"x = {x} m, v = {v} m/s, dt = {dt} s, {p}"
        close("position of a ball that ends exactly on the plane [m]", got[0], p.point, 0.0, given=given)
        close("velocity of a ball that ends exactly on the plane [m/s]: not below it", got[1], -(speed + 8.0 * dt) * n,
              0.0, given=given)
        x = x - 2.0**-40 * n
        got = lesson.position_projection_step(lesson.falling_acceleration, 0.0, x, v, dt, p)
        close("velocity of a ball that ends 1e-12 m below the plane [m/s]", got[1], p.e * (speed + 8.0 * dt) * n,
              ROUND_OFF, given=f"x = {x} m, v = {v} m/s, dt = {dt} s, {p}")
        let_go(lesson, draw, d)
        any_way(lesson, draw, d)


def any_way(lesson, draw, d):
    """Check a projecting step from above, from on and from inside the plane, with every kind of velocity and step."""
    n = np.eye(d)[0]
    cases = [pair for special in (*arrows(draw, d), np.zeros(d))
             for pair in ((special, draw(-1.0, 1.0, d)), (draw(-1.0, 1.0, d), special), (special, special))]
    for (x, v), dt in itertools.product(cases, (1e-6, 0.1)):
        e, x = draw(0.1, 0.9), dt * x
        p = lesson.BouncingBall(e, draw(-9.0, 9.0, d), np.zeros(d), n, draw(1e3, 1e5), draw(0.0, 50.0))
        got = lesson.position_projection_step(lesson.falling_acceleration, 0.0, x, v, dt, p)
        v_new = v + dt * p.gravity
        ends = x + dt * v_new
        given = f"x = {x} m, v = {v} m/s, dt = {dt} s, {p}"
        close("position after a step, over dt [m/s]", np.asarray(got[0]) / dt,
              np.append(max(0.0, ends[0]), ends[1:]) / dt, ROUND_OFF * 10.0, given=given)
        v_new = bounced_off(v_new, n, e) if ends[0] < 0.0 else v_new
        close("velocity after a step [m/s]", got[1], v_new, ROUND_OFF, given=given)


def bounced(h, t, pull, e):
    """Height and normal velocity of a ball dropped from h, in closed form, flight by flight."""
    v, left = np.sqrt(2.0 * pull * h), t
    if left < v / pull:
        return h - 0.5 * pull * left**2, -pull * left
    left, v = left - v / pull, e * v
    while left > 2.0 * v / pull:
        if v < 1e-13:
            return 0.0, 0.0
        left, v = left - 2.0 * v / pull, e * v
    return v * left - 0.5 * pull * left**2, v - pull * left


@exercise("7.16", points=0.25,
          hint="evaluate the acceleration once, at t, x and v; a ball that starts inside is "
               "put back onto the plane, x − φ n, and bounces")
def test_a_backtracking_step_keeps_its_first_acceleration_and_puts_back_a_ball_inside(lesson, draw):
    for inside, e in ((draw(0.1, 1.0), draw(0.3, 0.9)), (draw(2.0, 5.0), draw(0.3, 0.9)), (draw(5e-10, 9e-10), 0.5),
                      (0.0, draw(0.3, 0.9)), (0.0, 0.0)):
        p, t, _, _ = drop(draw, lesson, 3, e)
        time, dt = draw(0.5, 1.0), draw(0.02, 0.05)
        v = draw(1.0, 3.0) * t - draw(3.0, 5.0) * p.n
        phi = -inside if inside else draw(0.2, 0.7) * dt * -(v @ p.n)
        x = p.point + phi * p.n
        a = swaying(time, x, v, p)
        tau = 0.0 if inside else brentq(height(phi, v @ p.n, a @ p.n), 0.0, dt, xtol=1e-16, rtol=1e-14)
        # The rebound speed, p.e · 2.5 m/s, is more than a takes from it in dt: there is one impact. Without restitution
        # the plane takes what a pulls in.
        hit, left = v + tau * a, dt - tau
        place = p.point + across(p.n, tau * v + 0.5 * tau**2 * a)
        bounce = hit - (1.0 + p.e) * (hit @ p.n) * p.n
        a = a if e > 0.0 else a - min(0.0, a @ p.n) * p.n
        got = lesson.backtracking_step(swaying, time, x, v, dt, p)
        given = f"a = g cos t + x/2 - v/2, t = {time} s, φ = {phi} m, x = {x} m, v = {v} m/s, dt = {dt} s, {p}"
        close("position after one impact [m]", got[0], place + left * bounce + 0.5 * left**2 * a, 1e-11, given=given)
        close("velocity after one impact [m/s]", got[1], bounce + left * a, 1e-11, given=given)


@exercise("7.16", points=0.25,
          hint="impact_time treats a ball inside as one that touches: if it leaves, it flies from its place; "
               "where a_n > 0, slide_on_plane(…) lifts a ball off")
def test_a_ball_that_leaves_from_inside_flies_and_one_that_is_pulled_off_takes_off(lesson, draw):
    for e in (0.0, draw(0.3, 0.8)):
        p, t, pull, along = drop(draw, lesson, 3, e)
        if e == 0.0:                                                     # after the impact v · n is exactly 0
            t, n = np.eye(3)[:2]
            p = p._replace(n=n, gravity=along * t - pull * n)
        speed, slip, depth = draw(1.0, 3.0), draw(1.0, 3.0), draw(0.1, 0.5)
        x, v, flight = p.point - depth * p.n, slip * t + speed * p.n, 2.0 * speed / pull
        for after in (0.0, draw(0.1, 0.9) * e * flight):                 # of its next flight, from the plane
            time = draw(0.1, 0.9) * flight if after == 0.0 else flight + after
            up, v_n = (e * speed * after - 0.5 * pull * after**2, e * speed - pull * after) if after else (
                speed * time - 0.5 * pull * time**2 - depth, speed - pull * time)
            got = lesson.backtracking_step(lesson.falling_acceleration, 0.0, x, v, time, p)
            given = f"φ = {-depth} m, x = {x} m, v = {v} m/s, dt = {time} s, {p}"
            close("position of a ball that starts inside and leaves [m]", got[0],
                  p.point + up * p.n + (slip * time + 0.5 * along * time**2) * t, 1e-11, given=given)
            close("velocity of a ball that starts inside and leaves [m/s]", got[1],
                  v_n * p.n + (slip + along * time) * t, 1e-11, given=given)
        # The acceleration away from the plane is too weak to stop the ball before it hits.
        p = p._replace(gravity=along * t + pull * p.n)
        speed, left = draw(3.0, 8.0), draw(0.1, 0.5)
        for h in (draw(0.2, 0.9) * 0.5 * speed**2 / pull, 0.0):
            speed = speed if h > 0.0 else 0.0                            # and from rest on the plane
            hit = np.sqrt(speed**2 - 2.0 * pull * h)
            time = (speed - hit) / pull + left
            x, v = p.point + h * p.n, slip * t - speed * p.n
            got = lesson.backtracking_step(lesson.falling_acceleration, 0.0, x, v, time, p)
            given = f"φ = {h} m, x = {x} m, v = {v} m/s, dt = {time} s, {p}"
            close("position of a ball that is pulled off the plane [m]", got[0],
                  p.point + (e * hit * left + 0.5 * pull * left**2) * p.n + (slip * time + 0.5 * along * time**2) * t,
                  1e-10, given=given)
            close("velocity of a ball that is pulled off the plane [m/s]", got[1],
                  (e * hit + pull * left) * p.n + (slip + along * time) * t, 1e-10, given=given)


def drifting(lesson, draw):
    """Check a backtracking step without gravity, towards a plane through the origin and along it, and at rest."""
    t, n = np.eye(3)[:2]
    fast, slips, dt = draw(1.0, 5.0), draw(1.0, 3.0), draw(0.5, 1.0)
    for e in (0.0, draw(0.1, 0.9), 1.0):
        p = lesson.BouncingBall(e, STILL, STILL, n, 1e4, 10.0)
        for speed, slip in ((fast, slips), (fast, 0.0), (0.0, slips), (0.0, 0.0)):
            for h in (draw(0.1, 0.9) * dt * fast, 0.0):
                x, v = h * n, slip * t - speed * n + 0.0                 # without −0
                left = dt - h / speed if speed > 0.0 else 0.0
                up = e * speed * left if speed > 0.0 else h
                got = lesson.backtracking_step(lesson.falling_acceleration, 0.0, x, v, dt, p)
                given = f"x = {x} m, v = {v} m/s, dt = {dt} s, {p}"
                close("position without gravity [m]", got[0], up * n + slip * dt * t, ROUND_OFF, given=given)
                close("velocity without gravity [m/s]", got[1], slip * t + e * speed * n, ROUND_OFF, given=given)


@exercise("7.16", points=0.25,
          hint="fly to the impact, bounce, continue with the remaining time; "
               "one step may contain several impacts")
def test_a_backtracking_step_follows_a_bouncing_ball_exactly(lesson, draw):
    drifting(lesson, draw)
    for d, size, steep in ((2, 1.0, False), (3, 1.0, True), (3, 1e-8, False)):
        p, t, pull, along = drop(draw, lesson, d)
        if steep:                                                        # the ball bounces fast along the plane
            along = 3.0 * pull
            p = p._replace(gravity=along * t - pull * p.n, e=draw(0.3, 0.45))
        h, slip = size * draw(0.5, 2.0), draw(1.0, 3.0)
        fall = np.sqrt(2.0 * h / pull)
        second, third = 2.0 * p.e * fall, 2.0 * p.e**2 * fall
        times = (draw(0.3, 0.9) * fall, fall + draw(0.2, 0.8) * second, fall + second + draw(0.2, 0.8) * third)
        for time in times:
            x, v = lesson.backtracking_step(lesson.falling_acceleration, 0.0, p.point + h * p.n, slip * t, time, p)
            up, speed = bounced(h, time, pull, p.e)
            place = p.point + up * p.n + (slip * time + 0.5 * along * time**2) * t
            velocity = speed * p.n + (slip + along * time) * t
            given = f"dropped from {h} m with {slip} m/s along the plane, after {time} s, {p}"
            # Position round-off, 1e-15, is 1e-7 of a height of 1e-8, and so of the speed, 4e-4, and of later heights.
            close("position [m]", x, place, 1e-10 * max(size, 1e-3), given=given)
            close("velocity [m/s]", v, velocity, 1e-10, given=given)
            if size == 1.0:
                scaled = p._replace(gravity=TINY * p.gravity, point=TINY * p.point)
                x, v = lesson.backtracking_step(lesson.falling_acceleration, 0.0,
                                                scaled.point + TINY * h * p.n, TINY * slip * t, time, scaled)
                given = f"dropped from {TINY * h} m with {TINY * slip} m/s along the plane, after {time} s, {scaled}"
                close("position with all lengths tiny [m]", x, TINY * place, TINY * 1e-10, given=given)
                close("velocity with all lengths tiny [m/s]", v, TINY * velocity, TINY * 1e-10, given=given)
                short = np.sqrt(TINY)                                    # with the same gravity times are short, too
                scaled = p._replace(point=TINY * p.point)
                x, v = lesson.backtracking_step(lesson.falling_acceleration, 0.0, scaled.point + TINY * h * p.n,
                                                short * slip * t, short * time, scaled)
                given = f"dropped from {TINY * h} m with {short * slip} m/s along the plane, after {short * time} s"
                close("position with all lengths tiny and all times short [m]", x, TINY * place, TINY * 1e-10,
                      given=f"{given}, {scaled}")
                close("velocity with all lengths tiny and all times short [m/s]", v, short * velocity, short * 1e-10,
                      given=f"{given}, {scaled}")


@exercise("7.16", points=0.125,
          hint="do not change x and v: write x = x + …, not x += …; "
               "after MAX_IMPACTS impacts raise Diverged")
def test_a_backtracking_step_keeps_its_input_and_raises_diverged_after_too_many_impacts(lesson, draw):
    p, t, pull, along = drop(draw, lesson, 2, 1.0)
    x, v = p.point + draw(0.5e-4, 1e-4) * p.n, 0.0 * t
    before, high = x.copy(), p.point + 5.0 * p.n
    flown, _ = lesson.backtracking_step(lesson.falling_acceleration, 0.0, high, v, 0.1, p)
    close("position after 0.1 s of free fall [m]", flown, high + 0.005 * (along * t - pull * p.n), 1e-11, given=f"{p}")
    lesson.backtracking_step(lesson.falling_acceleration, 0.0, x, v, 0.1, p)
    close("input position after the call [m]", x, before, 0.0)
    close("input velocity after the call [m/s]", v, np.zeros(2), 0.0)
    # Without energy loss each flight lasts 2 √(2h/a), and the step may have 10,000 impacts. Where the plane is at the
    # origin and normal to an axis, the round-off of a height is 1e-16 of it. The round-off of 9,500 times adds up.
    h, n = 10.0 ** draw(-4.0, 1.0), np.array([0.0, 1.0])
    upright = p._replace(n=n, gravity=-pull * n, point=0.0 * n)
    half = np.sqrt(2.0 * h / pull)
    late = draw(0.1, 1.9) * half
    flown, _ = lesson.backtracking_step(lesson.falling_acceleration, 0.0, h * n, v, 19_001.0 * half + late, upright)
    close("height after 9,501 impacts without energy loss, over the first one [-]", np.asarray(flown) / h,
          (pull * half * late - 0.5 * pull * late**2) * n / h, 1e-6, given=f"dropped from {h} m, {upright}")
    h = 10.0 ** draw(-8.0, -4.0)                                         # 10,400 impacts do not take long here
    raises("a step with more than MAX_IMPACTS impacts", Diverged, lesson.backtracking_step, lesson.falling_acceleration,
           0.0, h * n, v, 20_800.0 * np.sqrt(2.0 * h / pull), upright)


def on_the_edge(lesson, draw):
    """Check steps that end at an impact, or a little before or after it, and a little before the last of all bounces.

    With lengths and times in powers of two the ball hits at exactly a power of two.
    """
    n, time, pull = np.eye(2)[draw.whole(0, 1)], 2.0 ** draw.whole(-12, -2), 8.0
    e = draw(0.3, 0.7)
    p = lesson.BouncingBall(e, -pull * n, np.zeros(2), n, draw(1e3, 1e5), draw(0.0, 50.0))
    x, hit = 0.5 * pull * time**2 * n, pull * time
    for what, share, v_n in (("at", 0.0, -hit), ("a little before", -(2.0**-40), -hit),
                             *(("a little after", 2.0**-k, e * hit) for k in (20, 30, 40))):
        _, v = lesson.backtracking_step(lesson.falling_acceleration, 0.0, x, 0.0 * n, time * (1.0 + share), p)
        close(f"velocity after a step that ends {what} the impact, over that of the impact [-]", np.asarray(v) / hit,
              v_n / hit * n - share * n, ROUND_OFF, given=f"x = {x} m, v = 0, dt = {time} (1 + {share}) s, {p}")
    p = p._replace(gravity=20.0 * p.gravity)                             # what counts is the acceleration
    for early in (0.3, 0.1, 0.01, 1e-3):
        dt = time * (1.0 + (1.0 - early) * 2.0 * e / (1.0 - e))
        got = lesson.backtracking_step(lambda t, x, v, p: p.gravity / 20.0, 0.0, x, 0.0 * n, dt, p)
        up, v_n = bounced(x @ n, dt, pull, e)
        given = f"a is a twentieth of gravity, dropped from {x} m, dt = {dt} s, {p}"
        close("position a little before the last bounce, over the height [-]", np.asarray(got[0]) / (x @ n),
              up / (x @ n) * n, 1e-10, given=given)
        close("velocity a little before the last bounce, over that of the first impact [-]", np.asarray(got[1]) / hit,
              v_n / hit * n, 1e-10, given=given)


@exercise("7.16", points=0.125,
          hint="if bouncing_time is at most the remaining time, the ball stays on the plane: slide_on_plane(…)")
def test_a_ball_lies_on_the_plane_after_its_last_bounce(lesson, draw):
    on_the_edge(lesson, draw)
    for e, upright in ((0.0, False), (draw(0.3, 0.8), False), (0.0, True)):
        p, t, pull, along = drop(draw, lesson, 3, e)
        if upright:                                                      # after the impact v · n is exactly 0
            t, n = np.eye(3)[:2]
            p = p._replace(n=n, gravity=along * t - pull * n)
        h, slip = draw(0.5, 2.0), draw(1.0, 3.0)
        fall = np.sqrt(2.0 * h / pull)
        rest = fall * (1.0 + e) / (1.0 - e)
        x, v, time = p.point + h * p.n, slip * t, 0.0
        # The second and third steps start at rest. A round-off of the height, up to 4e-14 m, bounces for 1e-6 s.
        for dt in (draw(1.01, 1.5) * rest, draw(0.1, 0.5), 1e-5):
            x, v = lesson.backtracking_step(lesson.falling_acceleration, time, x, v, dt, p)
            time += dt
            given = f"dropped from {h} m, after {time} s, {p}"
            close("position of a ball that lies on the plane [m]", x,
                  p.point + (slip * time + 0.5 * along * time**2) * t, 1e-9, given=given)
            close("velocity of a ball that lies on the plane [m/s]", v, (slip + along * time) * t, 1e-10, given=given)


# ---------------------------------------------------------------------------------------------- several impacts at once

def together(body, r, n, e, rough):
    """(v⁺, ω⁺) from one least-squares system of the conditions at all points; rough: no tangential velocity remains."""
    M = np.zeros((6, 6))
    M[:3, :3], M[3:, 3:] = body.inv_mass * np.eye(3), body.inv_inertia
    rows, wanted = [], []
    for r_i, n_i in zip(r, n, strict=True):
        G = np.hstack((np.eye(3), np.cross(np.eye(3), r_i).T))           # u = v + ω × r
        u = G @ np.concatenate((body.v, body.omega))
        D = np.eye(3) if rough else n_i[None]
        rows.append(D @ G)
        wanted.append(D @ (-e * (n_i @ u) * n_i - u))
    G = np.concatenate(rows)
    J = np.linalg.lstsq(G @ M @ G.T, np.concatenate(wanted), rcond=1e-11)[0]
    return np.concatenate((body.v, body.omega)) + M @ G.T @ J


def falling_box(draw, lesson, points):
    """(BodyState3D, r, n): a falling box that does not rotate and lands on 1, 2 or 4 corners."""
    half, m = draw(0.1, 0.3, 3), draw(0.5, 2.0)
    moments = m / 3.0 * (half @ half - half**2)
    tilt = {1: (draw(0.3, 0.9), draw(0.3, 0.9)), 2: (draw(0.3, 0.9), 0.0), 4: (0.0, 0.0)}[points]
    c, s = np.cos(tilt), np.sin(tilt)
    about_x = np.array([[1.0, 0.0, 0.0], [0.0, c[0], -s[0]], [0.0, s[0], c[0]]])
    about_y = np.array([[c[1], 0.0, s[1]], [0.0, 1.0, 0.0], [-s[1], 0.0, c[1]]])
    R = about_x @ about_y
    corners = np.array([[a, b, z] for a in (-1.0, 1.0) for b in (-1.0, 1.0) for z in (-1.0, 1.0)]) * half @ R.T
    lowest = corners[corners[:, 2] < corners[:, 2].min() + 1e-9]
    body = lesson.BodyState3D(np.array([0.0, 0.0, -draw(1.0, 3.0)]), np.zeros(3), 1.0 / m,
                              R @ np.diag(1.0 / moments) @ R.T)
    return body, lowest, np.tile([0.0, 0.0, 1.0], (points, 1))


def one_point(lesson, draw):
    """Check impacts without friction of one point of a body that is partly or wholly at rest, or cannot rotate."""
    body, r, n = solid(draw, lesson), draw(-1.0, 1.0, 3), unit(draw, 3)
    for e in (0.0, draw(0.1, 0.9), 1.0):
        for still in (*at_rest(body), body._replace(inv_inertia=np.zeros((3, 3)))):
            to = np.copysign(1.0, -(n @ (still.v + np.cross(still.omega, r)))) * n
            got, residual = lesson.solve_impacts(still, r[None], to[None], e, 0.0)
            expected = together(still, r[None], to[None], e, False)
            given = f"r = {r}, n = {to}, e = {e}, μ = 0, {still}"
            close("velocity after an impact of one point [m/s]", got.v, expected[:3], 1e-10, given=given)
            close("angular velocity after an impact of one point [rad/s]", got.omega, expected[3:], 1e-10, given=given)
            between("residual after an impact of one point [m/s]", residual, 0.0, 1e-12, given=given)


@exercise("7.17", points=0.25,
          hint="u_sep comes from the velocities before the impact; at each point take back its old impulse "
               "before computing the new one; sweep until nothing changes")
def test_a_box_that_lands_on_a_corner_an_edge_or_a_face_leaves_as_all_its_points_demand(lesson, draw):
    """Sweeps stop at changes of 1e-14 of 3 m/s. The remaining error is some hundred times that. ω is v over 0.1 m."""
    r, n, J_n = draw(-1.0, 1.0, 3), unit(draw, 3), draw(0.5, 2.0)
    body, t = solid(draw, lesson), across(n, unit(draw, 3))
    t = t / np.linalg.norm(t) * np.sign(n @ answer(r, body.inv_mass, body.inv_inertia, t))
    ratio, e = draw(2.5, 5.0), draw(0.1, 0.9)
    J = J_n * (n + ratio * t)
    change = answer(r, body.inv_mass, body.inv_inertia, J)
    # This velocity makes J the impulse that rebounds with e and sticks.
    held = body._replace(v=e / (1.0 + e) * (n @ change) * n - change, omega=np.zeros(3))
    # With less friction it slides, and J_n is such that it rebounds with e.
    slides = 0.99
    rim = n + slides * ratio * t
    less = (n @ change) / (n @ answer(r, body.inv_mass, body.inv_inertia, rim)) * rim
    for mu, impulse in ((1.01 * ratio, J), (slides * ratio, less)):
        got, _ = lesson.solve_impacts(held, r[None], n[None], e, mu)
        given = f"r = {r}, n = {n}, e = {e}, μ = {mu}, {held}"
        close("velocity of a body that hits with one point [m/s]", got.v, held.v + body.inv_mass * impulse, 1e-10,
              given)
        close("angular velocity of a body that hits with one point [rad/s]", got.omega,
              body.inv_inertia @ np.cross(r, impulse), 1e-10, given)
    one_point(lesson, draw)
    for points in (1, 2, 4):
        for mu, e in ((0.0, draw(0.1, 0.9)), (np.inf, draw(0.1, 0.9)), (np.inf, 0.0)):
            body, r, n = falling_box(draw, lesson, points)
            got, _ = lesson.solve_impacts(body, r, n, e, mu)
            given = f"{points} points, r = {r.tolist()}, e = {e}, μ = {mu}, {body}"
            expected = together(body, r, n, e, mu > 0.0)
            close("velocity after the impact [m/s]", got.v, expected[:3], 1e-10, given=given)
            close("angular velocity after the impact [rad/s]", got.omega, expected[3:], 1e-9, given=given)


def skate(draw, lesson, points):
    """(BodyState3D, r, n, e, μ, v⁺, ω⁺): a body that slides fast along the line of its contact points.

    By symmetry all impulses are in the plane of that line and n. Each point slides along s, so its impulse is
    Jₙ (n − μ s). Any number of points on the line have the resultant of two at its ends, and these leave with −e u_n:
    two equations.
    """
    R, _ = np.linalg.qr(draw(-1.0, 1.0, (3, 3)))
    s, n = R[:, 0], R[:, 2]
    m, half, e, mu = draw(0.5, 2.0), draw(0.1, 0.3), draw(0.1, 0.9), draw(0.05, 0.2)
    moments = m * half**2 * draw(0.5, 1.0, 3)
    x = half * np.append(draw(-0.6, 0.6, points - 2), (1.0, -1.0))
    r = np.outer(x, s) - draw(0.2, 0.5) * half * n
    down = draw(1.0, 2.0)
    body = lesson.BodyState3D(draw(8.0, 12.0) * s - down * n, np.zeros(3), 1.0 / m, R @ np.diag(1.0 / moments) @ R.T)
    unit_answers = np.array([[n @ (body.inv_mass * d + np.cross(body.inv_inertia @ np.cross(at, d), to))
                              for at in r[-2:]] for to in r[-2:] for d in (n - mu * s,)])
    sizes = np.linalg.solve(unit_answers, np.full(2, (1.0 + e) * down))
    J = sizes[:, None] * (n - mu * s)
    v, omega = body.v + body.inv_mass * J.sum(axis=0), body.inv_inertia @ np.cross(r[-2:], J).sum(axis=0)
    return body, r, np.tile(n, (points, 1)), e, mu, v, omega


@exercise("7.17", points=0.25,
          hint="each point slides with μ times its own normal impulse, in the direction of its own sticking impulse")
def test_two_or_four_points_that_slide_brake_with_mu_times_all_that_presses(lesson, draw):
    for points in (2, 4):
        body, r, n, e, mu, v, omega = skate(draw, lesson, points)
        got, residual = lesson.solve_impacts(body, r, n, e, mu)
        given = f"{points} points, r = {r.tolist()}, n = {n[0]}, e = {e}, μ = {mu}, {body}"
        close("velocity after the impact [m/s]", got.v, v, 1e-9, given=given)
        close("angular velocity after the impact [rad/s]", got.omega, omega, 1e-8, given=given)
        between("residual after the sweeps have settled [m/s]", residual, 0.0, 1e-11, given=given)


@exercise("7.17", points=0.125,
          hint="each impulse is inside its cone, in every state of the other points; call check_impacts first")
def test_the_order_of_the_points_does_not_matter_and_sliding_points_slide(lesson, draw):
    body, r, n = falling_box(draw, lesson, 2)
    slide = draw(0.5, 2.0) * np.array([1.0, 0.0, 0.0]) + draw(0.5, 2.0) * np.array([0.0, 1.0, 0.0])
    body = body._replace(v=body.v + slide)
    e, mu = draw(0.1, 0.5), draw(0.05, 0.1)
    (one, _), (other, _) = (lesson.solve_impacts(body, r[order], n, e, mu) for order in ([0, 1], [1, 0]))
    given = f"r = {r.tolist()}, e = {e}, μ = {mu}, {body}"
    close("velocity with the points in the other order [m/s, rad/s]", [*other.v, *other.omega],
          [*one.v, *one.omega], 1e-9, given=given)
    P = (np.asarray(one.v) - body.v) / body.inv_mass
    between("tangential impulse over μ times normal impulse [-]", np.hypot(P[0], P[1]) / (mu * P[2]),
            0.5, 1.0 + 1e-9, given=given)
    for corner in r:
        u = np.asarray(one.v) + np.cross(one.omega, corner)
        close("speed at which each point leaves [m/s]", u[2], -e * body.v[2], 1e-10, given=given)
    raises("a restitution above 1", BadInput, lesson.solve_impacts, body, r, n, 1.0 + draw(0.1, 1.0), mu)
    raises("one point with two normals", BadInput, lesson.solve_impacts, body, r[:1], n, e, mu)


@exercise("7.17", points=0.125,
          hint="compare with largest_speed; the residual is that of the last sweep; "
               "if the sweeps do not settle, return settle_impacts")
def test_the_residual_is_small_exactly_if_the_sweeps_can_settle(lesson, draw):
    """A rolling ball settles at once. A body between two walls can rebound from neither: only v · n = 0 is possible."""
    n = unit(draw, 3)
    radius, along, e = draw(0.05, 0.5), across(n, draw(5.0, 20.0) * unit(draw, 3)), draw(0.2, 0.8)
    v = along - draw(0.05, 0.2) * n
    ball = lesson.BodyState3D(v, np.cross(n, along) / radius, 1.0, np.eye(3) / (0.4 * radius**2))
    got, residual = lesson.solve_impacts(ball, -radius * n[None], n[None], e, draw(0.1, 0.9))
    given = f"a ball of radius {radius} that rolls with v = {v}, n = {n}, e = {e}"
    close("velocity along n after the impact [m/s]", got.v @ n, -e * (v @ n), 1e-12, given)
    between("residual after the sweeps have settled [m/s]", residual, 0.0, 1e-12, given)
    # The walls can press as hard as they like, so friction stops both points. That state has the least energy.
    body = lesson.BodyState3D(v, draw(-5.0, 5.0, 3), 1.0, np.eye(3) / (0.4 * radius**2))
    arms, walls = radius * (np.stack((-n, n)) + 0.2 * draw(-1.0, 1.0, 3)), np.stack((n, -n))
    comes = -(n @ (v + np.cross(body.omega, arms[0])))
    body = body._replace(v=v + (comes - draw(0.5, 2.0)) * n)
    comes = -(n @ (body.v + np.cross(body.omega, arms[0])))
    expected = together(body, arms, walls, 0.0, True)
    order = [0, 1] if draw(0.0, 1.0) < 0.5 else [1, 0]                 # not both: sweeps that do not settle are slow
    got, residual = lesson.solve_impacts(body, arms[order], walls[order], e, draw(0.3, 0.9))
    given = f"a body between two walls, r = {arms[order].tolist()}, n = {walls[order].tolist()}, {body}"
    close("velocity between two walls with friction [m/s]", got.v, expected[:3], 1e-7, given)
    close("angular velocity between two walls [rad/s]", got.omega, expected[3:], 1e-6, given)
    # At rest, the law would still let the first point rebound with e times its speed along n.
    close("residual where the sweeps cannot settle [m/s]", residual, e * comes * np.abs(n).max(), 1e-6, given)
    # Without friction, and with the walls exactly opposite, only n · v changes. The body stops along n.
    got, residual = lesson.solve_impacts(body, radius * np.stack((-n, n)), walls, e, 0.0)
    given = f"a body between two smooth walls, r = ± {radius} n, n = {n}, e = {e}, {body}"
    close("velocity between two smooth walls [m/s]", got.v, across(n, body.v), 1e-9, given)
    close("angular velocity between two smooth walls [rad/s]", got.omega, body.omega, 1e-9, given)
    expected = e * abs(n @ body.v) * np.abs(n).max()                   # while it turns, it may come to either wall
    close("residual between two smooth walls [m/s]", residual, expected, 1e-9, given)


def close_pair(draw, lesson, m, height):
    """(BodyState3D at rest, r (2, 3), d, n, x): points at ±x d, height · x along −n, on a body that hardly turns.

    Each sweep reduces the error by a factor (1 − a)²/(1 + a)², where a = m x²/I: 1,100 to 1,600 sweeps to 1e-14.
    """
    # All components are negative, as are those of the velocity changes.
    n = -np.abs(unit(draw, 3))
    d, x = across(n, unit(draw, 3)), draw(0.05, 0.2)
    d = d / np.linalg.norm(d)
    body = lesson.BodyState3D(STILL, STILL, 1.0 / m, draw(0.0045, 0.006) / (m * x * x) * np.eye(3))
    return body, np.stack((x * d, -x * d)) - height * x * n, d, n, x


@exercise("7.17", points=0.125,
          hint="at most MAX_SWEEPS sweeps; the residual is the largest |component| of Kᵢ (J − Jᵢ) of all "
               "points; compare it with CONVERGED largest_speed(body, r)")
def test_points_close_together_take_many_sweeps_for_any_body_and_any_motion(lesson, draw):
    """Two points stick: u⁺ = u_sep n at both.

    The light body also has points that leave by themselves and change nothing. The second body rolls, so that u is
    small, and some of its points leave slowly. For their five points each, settle_impacts finds no answer: it cannot
    stand in for sweeps that end too early. The third body resists a turn about n only, so that its normal velocities
    settle at once and its tangential ones do not.
    """
    down, e = draw(1.0, 3.0), draw(0.2, 0.8)
    body, sticks, d, n_1, x = close_pair(draw, lesson, 1e-6, 0.0)
    light = body._replace(v=0.1 * down * d - down * n_1, omega=draw(30.0, 60.0) * down / x * d)
    leaves = draw(10.0, 20.0) * x * np.cross(n_1, d)
    with_leaving = np.vstack((leaves, sticks, 1.5 * leaves, 1.2 * leaves))
    body, rolls_on, d, n_2, x = close_pair(draw, lesson, 1.0, 1.0)
    turn = draw(5.0, 10.0) / x
    rolls = body._replace(v=turn * x * np.cross(d, n_2) + 1e-4 * down * (0.3 * d - n_2), omega=turn * d)
    slowly = draw(1e-3, 2e-3) * down / turn * np.cross(n_2, d)
    rolls_on = np.vstack((rolls_on[0] + slowly, rolls_on, rolls_on[1] + slowly, slowly - x * n_2))
    body, _, d, n_3, x = close_pair(draw, lesson, 1.0, 0.0)
    side = np.cross(n_3, d)
    twists = body._replace(v=down * (draw(0.5, 1.0) * side - n_3), omega=draw(0.5, 1.0) * down / x * n_3,
                           inv_inertia=body.inv_inertia + draw(0.5, 1.0) / x**2 * np.outer(side, side))
    steps = x * np.stack((d, -d))
    for body, r, n, stick in ((light, with_leaving, n_1, slice(1, 3)), (rolls, rolls_on, n_2, slice(1, 3)),
                              (twists, steps, n_3, slice(0, 2))):
        normals = np.tile(n, (len(r), 1))
        got, residual = lesson.solve_impacts(body, r, normals, e, np.inf)
        expected = together(body, r[stick], normals[stick], e, True)
        given = f"r = {r.tolist()}, n = {n}, e = {e}, μ = inf, {body}"
        close("velocity after the impact [m/s]", got.v, expected[:3], 1e-9, given)
        close("angular velocity after the impact [rad/s]", got.omega, expected[3:], 1e-8, given)
        between("residual after the sweeps have settled [m/s]", residual, 0.0, 1e-9, given)


def least_change(body, r, n, e):
    """(v⁺, ω⁺) without friction: every point leaves with at least u_sepᵢ, and the change has the least kinetic energy.

    The change is M^½ y, where |y| is the least of all y with A y ≥ h. Non-negative least squares finds it: Lawson and
    Hanson 1974, chapter 23.
    """
    half, G = np.zeros((6, 6)), np.hstack((n, np.cross(r, n)))
    half[:3, :3] = np.sqrt(body.inv_mass) * np.eye(3)
    half[3:, 3:] = np.linalg.cholesky(body.inv_inertia)
    before = np.concatenate((body.v, body.omega))
    u = G @ before
    rows = np.vstack(((G @ half).T, np.maximum(0.0, -e * u) - u))
    goal = np.append(np.zeros(6), 1.0)
    left = rows @ not_negative(rows, goal) - goal
    return before - half @ left[:6] / left[6]


def tumbling(draw, lesson):
    """(BodyState3D, r, n): a rod with one leaving end, boxes that fall and rotate, bodies between surfaces."""
    m, half, down = draw(0.5, 2.0), draw(0.3, 1.0), draw(1.0, 3.0)
    # An impulse at one end drives the other end down by at least a third of its own change.
    up = draw(0.1, 0.4) * down
    moments = m * half**2 / 3.0 * np.array([0.01, 1.0, 1.0])
    v, omega = np.array([0.0, 0.0, 0.5 * (up - down)]), np.array([0.0, 0.5 * (up + down) / half, 0.0])
    rod = lesson.BodyState3D(v, omega, 1.0 / m, np.diag(1.0 / moments))
    yield rod, half * np.array([[1.0, 0.0, -0.01], [-1.0, 0.0, -0.01]]), np.tile([0.0, 0.0, 1.0], (2, 1))
    for points, omega in ((2, draw(-5.0, 5.0, 3)), (4, np.array([draw(15.0, 40.0), 0.0, draw(-5.0, 5.0)]))):
        body, r, n = falling_box(draw, lesson, points)
        yield body._replace(v=body.v + np.append(draw(-2.0, 2.0, 2), 0.0), omega=omega), r, n
    # The points form a triangle, because points close together take many more sweeps.
    for points in (1, 2, 3):
        up, turn = unit(draw, 3), 2.0 * np.pi / 3.0 * np.arange(points)
        side = across(up, unit(draw, 3))
        side = draw(0.5, 1.0) * side / np.linalg.norm(side)
        circle = np.cos(turn)[:, None] * side + np.sin(turn)[:, None] * np.cross(up, side)
        r = circle + 0.1 * draw(-1.0, 1.0, (points, 3))
        n = up + 0.4 * draw(-1.0, 1.0, (points, 3))
        body = solid(draw, lesson)
        yield body._replace(v=body.v - 4.0 * up), r - 0.3 * up, n / np.linalg.norm(n, axis=1, keepdims=True)


@exercise("7.17", points=0.125,
          hint="each point has its own normal and its own u_sepᵢ ≥ 0; afterwards it must separate at u_sepᵢ or faster")
def test_without_friction_a_tumbling_body_changes_no_more_than_all_its_points_demand(lesson, draw):
    """Sweeps stop at changes of 1e-14 of 10 m/s. The error may be a hundred times that. ω is v over 0.1 m."""
    for body, r, n in tumbling(draw, lesson):
        for slow in (1.0, 1e-6):
            e = draw(0.1, 0.9)
            moving = body._replace(v=slow * body.v, omega=slow * body.omega)
            got, _ = lesson.solve_impacts(moving, r, n, e, 0.0)
            expected = least_change(moving, r, n, e)
            given = f"r = {r.tolist()}, n = {n.tolist()}, e = {e}, {moving}"
            close("velocity after the impact [m/s]", got.v, expected[:3], 1e-9 * slow, given)
            close("angular velocity after the impact [rad/s]", got.omega, expected[3:], 1e-8 * slow, given)


# ---------------------------------------------------------------------------------------------- why?

@exercise("7.18", points=1, hint="an impact at the speed w leaves an average of g dt w/2 less of w²/2")
def test_an_elastic_ball_lies_still_after_the_predicted_time(lesson, draw):
    """A ball steps for 150 to 250 flights; and a ball of thousands of flights goes from impact to impact.

    In units of g dt a flight from the speed w takes n = ⌊2w⌋ steps and ends with n − w.  Two flights take 1 off the
    speed m + f, and 4m − 1 steps where f < ½, else 4m + 1.  All together take 2m² + m or 2m² + 3m steps, and the
    formula says 2 (m + f)².  2m is the number of flights, so the phase f makes an error of at most 1/flights.  Over all
    f its mean is zero.
    A sum over the flights may begin with the first or with the second one, which is another 1/flights.
    """
    for _ in range(3):
        g, dt, flights = 10.0 ** draw(-1.0, 2.0), 10.0 ** draw(-4.0, -1.0), draw.whole(150, 250) + draw(0.2, 0.8)
        h = 0.5 * (0.5 * flights * g * dt) ** 2 / g
        x, v, t = 0.0, 0.5 * flights * g * dt, 0.0
        while x != 0.0 or v > 2.0 * g * dt:
            v, t = v - g * dt, t + dt
            x = x + dt * v
            if x < 0.0:
                x, v = 0.0, -v
        close("time until an elastic ball lies still [s]", lesson.elastic_rest_time(h, g, dt), t, 2.5 / flights * t,
              given=f"h = {h}, g = {g}, dt = {dt}")
    for g, dt in 10.0 ** np.array([(k, j) for k in (-3.0, 2.0) for j in (-7.0, -4.0, -1.0)] + draw(0.0, 1.0, (6, 2))):
        m, phases = draw.whole(1000, 1500), (np.arange(20) + draw(0.1, 0.9)) / 20.0
        # The mean of (m + f)² over all phases is (m + mean f)² to a relative 1e-7.
        t, h = dt * np.mean([steps_to_rest(m + f) for f in phases]), 0.5 * (m + np.mean(phases)) ** 2 * g * dt * dt
        close("time until an elastic ball lies still, over its mean over all phases of a step [-]",
              lesson.elastic_rest_time(h, g, dt) / t, 1.0, 1.2 / (2.0 * m), given=f"h = {h}, g = {g}, dt = {dt}")


def steps_to_rest(w):
    """Steps until a ball lies still that leaves at w times g dt."""
    steps = 0
    while w > 2.0:
        n = np.floor(2.0 * w)
        w, steps = n - w, steps + n
    return steps


@exercise("7.19", points=1, hint="without friction an elastic impact, e = 1, keeps the energy")
def test_the_chosen_impact_keeps_its_energy_at_full_restitution(lesson):
    choice("the letter of the impact without friction", lesson.smooth_rod_is(), choices.where(
        "impulses", "energies_of_a_rod", lambda e, energy: abs(energy[-1] - 1.0) < 1e-12))


def of_a_ball(m, R, n, share=0.4):
    """Offset of the contact point, the inverse inertia of a ball, and K there; share: of m R², ⅔ if hollow."""
    r, inverse = -R * n, 1.0 / (share * m * R * R)
    return r, inverse, np.eye(3) / m + inverse * (R * R * np.eye(3) - np.outer(r, r))


def judge_impulse(lesson, u, n, K, slips=True):
    """Check the impulse of one impact.  Who aims at a limit may miss it by round-off: 1e-9 of it is allowed."""
    slip, given = u - (u @ n) * n, f"u = {u} m/s, n = {n}, K = {K.tolist()}"
    J = lesson.my_impulse(u, n, K)
    numbers("impulse [N s]", J, (3,), given)
    J = np.asarray(J, dtype=float)
    after = u + K @ J
    between("speed of separation over that of approach", after @ n / -(u @ n), 0.1 - 1e-9, np.inf, given)
    if slips:
        between("slip after the impact over that before", after @ slip / (slip @ slip), -np.inf, -0.3 + 1e-9, given)
    stake = 0.5 * u @ np.linalg.solve(K, u)
    between("gain of energy over the energy at stake", 0.5 * J @ (u + after) / stake, -1.0 - 1e-9, 1e-12, given)


@exercise("7.20", points=1,
          hint="K⁻¹ (u⁺ − u) is the impulse that leads to u⁺: which u⁺ keeps the energy and turns the slip?")
def test_a_super_ball_returns_its_slip_gains_no_energy_and_comes_back(lesson, draw):
    for k, n in itertools.product(range(4), normals(draw, 3)):
        side = np.roll(n, 1) - np.roll(n, 2)                             # its components add up to 0
        side = across(n, side if k % 2 and side.any() else draw(-1.0, 1.0, 3))
        size, part = 10.0 ** draw(-6.0, 3.0), 10.0 ** draw(-3.0, 3.0)    # slow and fast; grazing, and almost central
        _, _, K = of_a_ball(10.0 ** draw(-6.0, 3.0), 10.0 ** draw(-3.0, 1.0), n, draw(0.3, 0.66))
        side = part * side / np.linalg.norm(side) if k else 0.0
        judge_impulse(lesson, size * (side - n), n, K, k > 0)
    m, R, v, omega = draw(0.05, 0.2), draw(0.03, 0.07), np.array([draw(1.5, 2.5), -5.0, 0.0]), np.zeros(3)
    for side in (1.0, -1.0, 1.0):                            # floor, table, floor
        n = np.array([0.0, side, 0.0])
        r, inverse, K = of_a_ball(m, R, n)
        v[1] = -side * max(1.0, abs(v[1]))                   # gravity, and a ball that comes slowly still comes
        J = lesson.my_impulse(v + np.cross(omega, r), n, K)
        v, omega = v + J / m, omega + inverse * np.cross(r, J)
    between("velocity along the floor after floor, table and floor [m/s]", v[0], -np.inf, 0.0)
