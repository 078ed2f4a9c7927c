"""Lesson 11 is right when arms end where their angles say, Jacobians are derivatives, closed forms find both elbows,
and every method contracts, stays within its limits and uses its freedom as theory says.
"""

import itertools

import numpy as np
import pytest

from solutions.checks import BadInput
from validate.grading.expect import between, choice, close, numbers, raises
from validate.reference import choices
from validate.reference.kinematics import jacobian_of as slopes
from validate.reference.kinematics import joints_of as joints
from validate.reference.orientation import about as turn
from validate.reference.orientation import quaternion_matrix

exercise = pytest.mark.exercise
EDGE = 1e-12                 # as in the lesson
# Everything drawn is below 10 in its unit.  A comparison takes a few dozen operations, each rounded by 1.1e-16 of that.
ROUND_OFF = 1e-12
MANY = 1e-10                 # the same where it is divided by a hundredth
NARROW = {"low": -0.3, "high": 0.3}      # limits that all these arms are beyond: few methods keep any [rad]
FAR = 1.0, 1e-9              # from a target: on the way, and almost there [m]
DIFFERENCE = 1e-5            # of angles in central differences [rad]: leaves its square, and round-off over it
SLOPE = 1e-8                 # of such a difference: 1e-10 times third derivatives below 20, and 1e-14/1e-5
SOLVED = 1e-10               # of linear systems with a condition below 1e5
TINY = 1e-30                 # a size at which every fixed number that stands for zero, or for a bound, is noticed


# ---------------------------------------------------------------------------------------------- arms and their truth

def lengths_of(draw, n):
    return draw(0.5, 2.0, n)


def arm_of(lesson, lengths, gain=0.1, damping=0.5, low=-np.inf, high=np.inf, rest=0.0, pull=0.7):
    """An Arm2D with the settings that a test needs."""
    n = len(lengths)
    low, high, rest = (np.broadcast_to(values, n).astype(float) for values in (low, high, rest))
    return lesson.Arm2D(np.array(lengths, float), low, high, rest, float(gain), float(damping), float(pull))


def reach(theta, target, arm):
    """Task of the tests: e and J of a planar arm, link after link."""
    J, x, y, phi = np.zeros((2, theta.size)), 0.0, 0.0, 0.0
    for k in range(theta.size):
        phi += theta[k]
        along, up = arm.lengths[k] * np.cos(phi), arm.lengths[k] * np.sin(phi)
        x, y = x + along, y + up
        for i in range(k + 1):
            J[0, i] -= up
            J[1, i] += along
    return np.array((target[0] - x, target[1] - y)), J


def three_points(theta, target, arm):
    """Task of the tests: the last two joints and the end of a planar arm at three points; target (6,), J (6, n)."""
    n, phi, e = theta.size, 0.0, target.astype(np.float64)
    J = np.zeros((6, n))
    for k in range(n):
        phi += theta[k]
        along, up = arm.lengths[k] * np.cos(phi), arm.lengths[k] * np.sin(phi)
        for p in range(3):
            if k < n - 2 + p:                                            # link k is between the base and this point
                e[2 * p], e[2 * p + 1] = e[2 * p] - along, e[2 * p + 1] - up
                for i in range(k + 1):
                    J[2 * p, i] -= up
                    J[2 * p + 1, i] += along
    return e, J


TASKS = ((reach, 1), (three_points, 3))                                  # and the number of points that it moves


def pose(theta, target, arm):
    """Task of the tests: place and direction of the end of a planar arm; target (3,), J (3, n)."""
    J, x, y, phi = np.zeros((3, theta.size)), 0.0, 0.0, 0.0
    for k in range(theta.size):
        phi += theta[k]
        along, up = arm.lengths[k] * np.cos(phi), arm.lengths[k] * np.sin(phi)
        x, y = x + along, y + up
        J[2, k] = 1.0
        for i in range(k + 1):
            J[0, i] -= up
            J[1, i] += along
    return np.array((target[0] - x, target[1] - y, target[2] - phi)), J


def linear(theta, target, arm):
    """Task of the tests: as many linear equations as one likes, e = a − J θ; target (m, 1 + n) has the columns a, J."""
    J = target[:, 1:].copy()
    return target[:, 0] - J @ theta, J


def arrived(theta, target, arm):
    """Task of the tests: the end is at the target at all angles."""
    return 0.0 * target, np.zeros((target.size, theta.size))


EQUATIONS = ((8, 1.0), (1, 1.0), (3, TINY), (3, 1e6))                   # their number, and the size of e


def equations(draw, rows, size, n=5):
    """(e over its size, J, target) of that task for θ = 0, where all of e is exact."""
    e, J = draw(0.3, 1.0, rows), draw(-1.0, 1.0, (rows, n))
    return e, J, np.column_stack((size * e, J))


def special_matrices(draw):
    """Matrices with columns of 0, equal or perpendicular ones, or equal rows; one that is symmetric, and square ones.

    In the plane a joint at the end has a column of 0, and joints at one place have equal columns.
    """
    a, b, c = draw(0.3, 1.0, 3)
    square, _ = with_singular_values(draw, draw(0.5, 2.0, 6), 6)
    _, u = with_singular_values(draw, np.ones(3), 3)
    symmetric = (u * draw(0.5, 2.0, 3)) @ u.T
    return (np.array([[a, 0.0, c, c, -b], [b, 0.0, a, a, a]]), np.array([[a, b, c], [a, b, c]]),
            np.array([[a, -2.0 * b], [b, 2.0 * a]]), np.array([[2.0 * a, -b], [2.0 * b, a]]),
            symmetric + symmetric.T, square)


def special_equations(draw):
    """[(e, J, target)] of that task: no error, no joint that moves anything, one joint, dependent rows, and others.

    Some e are no zero, but their sum, their product, their first or their largest number is 0 or below.
    """
    many, one, rank = draw(-1.0, 1.0, (2, 5)), draw(0.3, 1.0, (3, 1)), np.outer((1.0, 0.0, -2.0), draw(0.3, 1.0, 2))
    e = draw(0.3, 1.0, 3)
    signs = np.array([(1.0, -1.0), (0.0, 1.0), (1.0, 0.0), (-1.0, -1.0)])
    pairs = ((0.0 * e[:2], many), (0.0 * e, one), (e[:2], 0.0 * many), (e[:1], np.zeros((1, 1))), (e, one), (e, rank),
             *((e[0] * two, many) for two in signs), *((draw(0.3, 1.0, len(J)), J) for J in special_matrices(draw)))
    return [(e, J, np.column_stack((e, J))) for e, J in pairs]


def posed(draw, n, far=1.0):
    """(lengths, θ, target, e, J) of such a task, with a target that is so far away."""
    lengths, theta, e = lengths_of(draw, n), turned(draw, n), far * draw(0.3, 1.0, 3)
    return (lengths, theta, np.append(joints(theta, lengths)[-1], theta.sum()) + e, e,
            np.vstack((slopes(theta, lengths), np.ones(n))))


def points_of(theta, lengths, count=1):
    """The last so many points of a planar arm, one after the other (2 count,)."""
    return joints(theta, lengths)[-count:].ravel()


def slopes_of(theta, lengths, count):
    """J (2 count, n) of these points."""
    n = len(theta)
    return np.vstack([np.pad(slopes(theta[:m], lengths[:m]), ((0, 0), (0, n - m)))
                      for m in range(n - count + 1, n + 1)])


def bent(draw, n):
    """Angles (n,) of an arm that is far from straight."""
    return np.append(draw(-3.0, 3.0), draw(0.4, 1.2, n - 1))


def turned(draw, n):
    """Angles (n,) of such an arm, the first beyond half a turn."""
    return np.append(draw(3.5, 9.0), draw(0.4, 1.2, n - 1))


def around(theta):
    """Limits between which an arm is, and which its next step leaves."""
    return {"low": theta - 1e-11, "high": theta + 1e-11}


def unit(draw, size=3):
    """A unit vector with no entry near 0."""
    r = draw(0.3, 1.0, size) * np.array([2.0 * draw.whole(0, 1) - 1.0 for _ in range(size)])
    return r / np.linalg.norm(r)


def quaternion(axis, angle):
    return np.append(np.cos(0.5 * angle), np.sin(0.5 * angle) * np.asarray(axis))


def chain(draw, n):
    """(θ, axes, offsets) of an arm in space, with angles beyond half a turn."""
    return draw(-5.0, 5.0, n), np.stack([unit(draw) for _ in range(n)]), draw(-1.0, 1.0, (n, 3))


def machine(draw):
    """(θ, axes, offsets) of an arm as factories have them: its axes and offsets are along those of coordinates.

    Some joints have the axis of the one before, or of the first, or the opposite one, and three are at one place.
    """
    along = np.eye(3)[np.argsort(draw(0.0, 1.0, 3))]
    axes, offsets = along[[0, 1, 1, 0, 2, 1, 0, 0]], draw(0.3, 1.0, (8, 1)) * along[[0, 0, 2, 1, 2, 1, 1, 0]]
    axes[2] *= -1.0
    offsets[3:5] = 0.0
    return draw(-5.0, 5.0, 8), axes, offsets


def frames(theta, axes, offsets):
    """(x, a, R) by matrices: positions, axes in the world, orientation of the last link."""
    x, a, R = [np.zeros(3)], [], np.eye(3)
    for angle, axis, offset in zip(theta, axes, offsets, strict=True):
        a.append(R @ axis)
        R = R @ turn(axis, angle)
        x.append(x[-1] + R @ offset)
    return np.array(x), np.array(a), R


def with_singular_values(draw, sigma, columns):
    """(J, u): a matrix with these singular values, and its directions u as columns."""
    m = len(sigma)
    u, v = np.linalg.qr(draw(-1.0, 1.0, (m, m)))[0], np.linalg.qr(draw(-1.0, 1.0, (columns, columns)))[0]
    return (u * np.asarray(sigma)) @ v[:m], u


# ---------------------------------------------------------------------------------------------- forward, in the plane

@exercise("11.1", points=0.5, hint="add link after link; φ_k is the sum of the angles up to the k-th, its own included")
def test_links_add_up_from_the_base(lesson, draw):
    for n, size in ((1, 1.0), (2, 1.0), (draw.whole(3, 8), 1.0), (12, TINY), (5, 1e6), (9, 1.0)):
        theta, lengths = draw(-5.0, 5.0, n), size * lengths_of(draw, n)   # up to 1000 km
        theta[6:8] = 0.0                                                 # two links that go straight on
        theta[1:3] *= (1e-7, 90.0)[:n - 1]                               # one that hardly turns, and one that winds
        if n == 9:                                                       # along both axes, and folded back
            theta = 0.5 * np.pi * np.array([-1.0, 2.0, 1.0, -2.0, 0.0, 1.0, 4.0, -1.0, 3.0])
        rounded = 1.1e-16 * n * np.sum(np.abs(theta))                    # of n sums of angles, up to 450 rad
        close("positions of the joints and the end [m]", lesson.joint_positions(theta, lengths), joints(theta, lengths),
              size * ROUND_OFF + rounded * np.sum(lengths), given=f"θ = {theta}, lengths {lengths} m")


@exercise("11.1", points=0.5,
          hint="each angle is relative to the link before it: joint k moves only the links after it")
def test_a_joint_turns_all_that_comes_after_it(lesson, draw):
    n, angle = draw.whole(3, 6), draw(0.5, 2.0)
    theta, lengths = draw(-3.0, 3.0, n), lengths_of(draw, n)
    before = joints(theta, lengths)
    for k in range(n):
        turned = theta.copy()
        turned[k] += angle
        c, s = np.cos(angle), np.sin(angle)
        expected = before.copy()
        expected[k:] = before[k] + (before[k:] - before[k]) @ np.array([[c, s], [-s, c]])
        close("positions after one joint has turned [m]", lesson.joint_positions(turned, lengths), expected, ROUND_OFF,
              given=f"joint {k}, by {angle} rad")


@exercise("11.2", points=1, hint="joint k moves the end at right angles to r = x_n − x_k: (−r_y, r_x)")
def test_the_jacobian_turns_rates_of_joints_into_the_velocity_of_the_end(lesson, draw):
    for n in (1, 2, draw.whole(3, 7)):
        theta, lengths, rates = draw(-3.0, 3.0, n), lengths_of(draw, n), draw(-1.0, 1.0, n)
        J = np.asarray(lesson.jacobian_2d(joints(theta, lengths)))
        close("J [m/rad]", J, slopes(theta, lengths), ROUND_OFF, given=f"θ = {theta}, lengths {lengths} m")
        ahead, behind = (joints(theta + s * DIFFERENCE * rates, lengths)[-1] for s in (1.0, -1.0))
        close("velocity of the end [m/s]", J @ rates, 0.5 * (ahead - behind) / DIFFERENCE, n**3 * SLOPE,
              given=f"rates {rates} rad/s")


@exercise("11.2", points=0.5, hint="only the positions matter: x[n] is the end, x[k] the joint, wherever they are")
def test_the_jacobian_needs_no_angles(lesson, draw):
    for rows, size, closed in ((draw.whole(6, 8), 1.0, False), (12, TINY, False), (7, 1e6, False), (2, 1.0, False),
                               (2, 1.0, False), (7, 1.0, True), (2, 1.0, True)):       # up to 1000 km
        x = size * draw(-2.0, 2.0, (rows, 2))
        if rows > 2:
            x[0, 0], x[1, 1], x[3, 0] = -x[-1, 0], x[-1, 1], x[-1, 0]    # joint 1 is as high as the end, 3 is above it
            x[2], x[4] = x[-1], x[3]                                     # joint 2 is there, and two are at one place
        x[0] = x[-1] if closed else x[0]                                 # the end is back at the base
        r = x[-1] - x[:-1]
        close("J of joints in any place [m/rad]", lesson.jacobian_2d(x), np.stack((-r[:, 1], r[:, 0])),
              size * ROUND_OFF, given=f"joints and end at {x} m")


@exercise("11.3", points=0.25, hint="σ₁ from both terms of the root, σ₂ = D/σ₁, and half of atan2(2b, a − c)")
def test_the_ellipse_has_the_singular_values_as_half_axes(lesson, draw):
    for n, size in ((2, 1.0), (draw.whole(3, 6), 1.0), (12, TINY), (4, 1e6)):      # up to 1000 km
        sigma = size * np.array([draw(1.5, 3.0), draw(0.3, 1.2)])
        J, u = with_singular_values(draw, sigma, n)
        for mirror in (1.0, -1.0):                                       # the longer axis points upwards, and downwards
            mirrored, y = J * [[1.0], [mirror]], mirror * u[1, 0]
            longer, shorter, angle = lesson.velocity_ellipse(mirrored)
            close("half axes of the ellipse [m]", (longer, shorter), sigma, size * ROUND_OFF, given=f"J = {mirrored}")
            close("sine of the angle from the longer axis [-]", u[0, 0] * np.sin(angle) - y * np.cos(angle), 0.0,
                  ROUND_OFF, given=f"J = {mirrored}")
    for J in special_matrices(draw)[:4]:
        u, sigma, _ = np.linalg.svd(J)
        longer, shorter, angle = lesson.velocity_ellipse(J)
        close("half axes of the ellipse of special joints [m]", (longer, shorter), sigma, MANY, given=f"J = {J}")
        close("sine of the angle from its longer axis [-]", u[0, 0] * np.sin(angle) - u[1, 0] * np.cos(angle), 0.0,
              MANY, given=f"J = {J}")


def shown(ellipse):
    """(σ₁, σ₂, tangent of the angle): the angle is that of an axis, which has no sense."""
    longer, shorter, angle = ellipse
    return longer, shorter, np.tan(angle)


@exercise("11.3", points=0.125, hint="for a = c the angle is ±45°; σ₂ = D/σ₁ keeps its digits; for one joint D = 0")
def test_the_ellipse_of_joints_that_are_alike_or_alone(lesson, draw):
    """The longer axis of (p, q), (±q, ±p) is at ±45°; a billionth more makes a circle an ellipse."""
    p, q = draw(1.0, 2.0), draw(0.2, 0.8)
    for mirror in (1.0, -1.0):
        J = np.array([[p, q], [mirror * q, mirror * p]])
        close("half axes, and tangent of the angle, of an ellipse at 45° [m, m, -]", shown(lesson.velocity_ellipse(J)),
              (p + q, p - q, mirror), MANY, given=f"J = {J}")
    angle, size = draw(0.3, 1.2), draw(1.0, 2.0)
    along, across = np.array([[np.cos(angle)], [np.sin(angle)]]), np.array([[-np.sin(angle)], [np.cos(angle)]])
    for more, rough in ((1e-4, MANY), (1e-9, 1e-5)):                      # the angle has lost the digits of 1/more
        J = size * np.hstack(((1.0 + more) * along, across))
        close("half axes, and tangent of the angle, of an ellipse that is almost a circle [m, m, -]",
              shown(lesson.velocity_ellipse(J)), ((1.0 + more) * size, size, np.tan(angle)), rough, given=f"J = {J}")
    J = size * along
    close("half axes, and tangent of the angle, for a single joint [m, m, -]", shown(lesson.velocity_ellipse(J)),
          (size, 0.0, np.tan(angle)), MANY, given=f"J = {J}")
    J = size * np.eye(2)
    longer, shorter, angle = lesson.velocity_ellipse(J)
    close("half axes of a circle [m, m]", (longer, shorter), (size, size), MANY, given=f"J = {J}")
    between("angle of a circle, where any is right [rad]", angle, -2.0 * np.pi, 2.0 * np.pi, given=f"J = {J}")
    small = draw(1e-14, 1e-13)                                            # each product of this determinant is exact
    J = np.array([[p, q], [0.0, small]])
    _, shorter, _ = lesson.velocity_ellipse(J)
    close("short half axis over what it should be [-]", shorter * np.hypot(p, q) / (p * small), 1.0, MANY,
          given=f"J = {J}")


@exercise("11.3", points=0.125,
          hint="σ₂ from D, the root of a sum of squares of 2 × 2 determinants: a difference would lose digits")
def test_the_short_axis_keeps_its_digits_where_the_arm_is_nearly_straight(lesson, draw):
    """Both columns are rounded, which changes what is nine digits shorter by 1e-16/1e-9."""
    small, a, b, angle = draw(1e-9, 1e-8), draw(1.5, 2.0), draw(0.5, 1.0), draw(0.3, 1.2)
    along, across = np.array([np.cos(angle), np.sin(angle)]), np.array([-np.sin(angle), np.cos(angle)])
    J, size = np.outer(along, (a, b)) + np.outer(across, (small, small)), np.hypot(a, b)
    longer, shorter, found = lesson.velocity_ellipse(J)
    close("half axes over what they should be [-]", (longer / size, shorter * size / (small * (a - b))), (1.0, 1.0),
          1e-5, given=f"J = {J}")
    close("angle of the longer axis [rad]", np.tan(found), np.tan(angle), 1e-6, given=f"J = {J}")
    for tilt in (small, -small):                                          # tan 2φ = 2 a tilt/(a² − a²/16)
        J = np.array([[a, 0.0], [tilt, 0.25 * a]])
        _, _, found = lesson.velocity_ellipse(J)
        close("tangent of the small angle of a longer axis along x, over its truth [-]", np.tan(found) / tilt,
              16.0 / (15.0 * a), 1e-6, given=f"J = {J}")
    J = np.array([[0.0, 0.0, 0.0], [0.0, a, b]])
    _, shorter, found = lesson.velocity_ellipse(J)
    close("short half axis of an arm that is straight [m]", shorter, 0.0, 1e-15, given=f"J = {J}")
    close("cosine of the angle of a longer axis along y [-]", np.cos(found), 0.0, ROUND_OFF, given=f"J = {J}")


# ---------------------------------------------------------------------------------------------- in closed form

@exercise("11.4", points=0.5,
          hint="θ₂ from the distance, with the sign of elbow; θ₁ is the direction of the target minus the part due to "
               "θ₂")
def test_both_elbows_reach_the_target(lesson, draw):
    for elbow in (1.0, -1.0):
        for trial in range(7):
            lengths, theta = lengths_of(draw, 2), np.array([draw(-3.1, 3.1), elbow * draw(0.1, 3.0)])
            lengths = lengths if trial else lengths[[0, 0]]
            target = joints(theta, lengths)[-1]
            given = f"target {target} m, lengths {lengths} m, elbow {elbow:g}"
            close("θ [rad]", lesson.solve_2r(target, lengths, elbow), theta, SOLVED, given=given)
            other = np.asarray(lesson.solve_2r(target, lengths, -elbow))
            close("end of the arm with the other elbow [m]", joints(other, lengths)[-1], target, SOLVED, given=given)
            close("other elbow [rad]", other[1], -theta[1], SOLVED, given=given)
    # bearing − (the part due to θ₂) is beyond ±π: for a second link of a quarter of the first that part is only 0.18
    for elbow in (1.0, -1.0):
        lengths, bearing, bend = lengths_of(draw, 2), -elbow * draw(3.0, 3.1), elbow * draw(1.0, 2.0)
        way = lengths[0] + lengths[1] * np.exp(1j * bend)
        theta = np.array([bearing - np.angle(way) + elbow * 2.0 * np.pi, bend])
        got = lesson.solve_2r(abs(way) * np.array([np.cos(bearing), np.sin(bearing)]), lengths, elbow)
        close("θ, with a θ₁ that is wrapped [rad]", got, theta, SOLVED, given=f"bearing {bearing} rad, elbow {elbow:g}")


def whole_lengths(draw, size):
    """(long, short): lengths with few binary digits, so that their sum and difference are exact."""
    return tuple(np.round(1024.0 * draw(low, high)) / 1024.0 * size for low, high in ((1.2, 2.0), (0.5, 1.1)))


@exercise("11.4", points=0.25,
          hint="at both edges of the reach there is one answer; beyond them BadInput, with the distance; where that is "
               "less than EDGE (l₁ + l₂), the root of a negative number is 0")
def test_the_edges_of_the_reach_are_reached_and_nothing_beyond(lesson, draw):
    for k, size in enumerate((1.0, 1.0, 2.0**10, 2.0**-100)):            # arms of a metre, of a kilometre, and tiny
        long, short = whole_lengths(draw, size)
        lengths = np.array([short, long] if k % 2 else [long, short])    # either may be the longer one
        bearing = draw(-3.0, 3.0)
        way = np.array([np.cos(bearing), np.sin(bearing)])
        most, least = long + short, long - short
        for edge in (most, least):
            theta = np.asarray(lesson.solve_2r(edge * way, lengths, 1.0))
            close("end of the arm at the edge of its reach, over the reach [-]", joints(theta, lengths)[-1] / most,
                  edge / most * way, SOLVED, given=f"distance {edge} m, lengths {lengths} m")
        for off in (most * draw(1.01, 3.0), least * draw(0.1, 0.99), most * (1.0 + draw(1.01, 1.05) * EDGE),
                    least - draw(1.01, 1.05) * EDGE * most):
            raises("a target out of reach", BadInput, lesson.solve_2r, off * way, lengths, 1.0, naming=(off,),
                   thing="distance of the target")
        elbow = 2.0 * draw.whole(0, 1) - 1.0
        for beyond, straight in ((most * (1.0 + draw(0.95, 0.99) * EDGE), 0.0),
                                 (least - draw(0.95, 0.99) * EDGE * most, elbow * np.pi)):
            close("θ₂ for a target that is out of reach by round-off [rad]",
                  lesson.solve_2r(beyond * way, lengths, elbow)[1], straight, ROUND_OFF,
                  given=f"distance {beyond} m, lengths {lengths} m, elbow {elbow:g}")
    for away in (0.0, 1e-10 * long):
        theta = np.asarray(lesson.solve_2r(away * way, np.array([long, long]), 1.0))
        close("end of an arm that is folded onto its base, over the length of a link [-]",
              joints(theta, (long, long))[-1] / long, away / long * way, ROUND_OFF,
              given=f"target {away * way} m, lengths {long} m and {long} m")
    near = np.array([long, long * (1.0 - 2.0**-17)])                      # these two links are not equal
    raises("a target in the small hole of an arm with nearly equal links", BadInput, lesson.solve_2r,
           draw(0.1, 0.9) * 2.0**-17 * long * way, near, 1.0, thing="distance of the target")


@exercise("11.4", points=0.25,
          hint="the products under the roots, and half the angle, keep the digits of θ₂, the arctangents those of θ₁; "
               "there may be a third length")
def test_the_elbow_keeps_its_digits_where_the_arm_is_nearly_straight_or_folded(lesson, draw):
    """tan²(θ₂/2) is a quotient of four factors.  Each is exact here, so θ₂ is known to its last digits.

    Nearest to the edge an arccosine is wrong by so much that it is known by its numbers.
    """
    for k in range(5):
        long, short = whole_lengths(draw, 1.0)
        third = draw(0.5, 2.0)
        off = np.round(2.0**40 * draw(1e-9, 1e-8)) / 2.0**40 if k else draw.whole(1, 3) / 2.0**50
        lengths = np.array([long, short, third] if k % 2 else [short, long, third])
        for r, straight in ((long + short - off, 0.0), (long - short + off, np.pi))[:1 if k == 0 else 2]:
            target = r * np.array([(1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0)][k % 4])
            outer, inner = (long + short - r) * (long + short + r), (r - long + short) * (r + long - short)
            bend = 2.0 * np.arctan(np.sqrt(min(outer, inner) / max(outer, inner)))
            got = np.asarray(lesson.solve_2r(target, lengths, 1.0))
            close("bend of an arm near the edge of its reach, over the right one [-]", (got[1] - straight) / bend,
                  -1.0 if straight else 1.0, 1e-10,
                  given=f"distance {r} m, lengths {lengths} m")
            close("end of an arm near the edge of its reach [m]", joints(got, lengths[:2])[-1], target, ROUND_OFF,
                  given=f"distance {r} m, lengths {lengths} m")


@exercise("11.5", points=0.5,
          hint="the last link points along φ: put joint 3 at (x, y) − l₃ (cos φ, sin φ), then solve_2r with the same "
               "lengths and elbow; this target is within reach")
def test_three_links_end_in_a_place_with_a_direction(lesson, draw):
    """The first hands are short, and their elbows about right-angled: wherever such a wrist is, it is within reach.

    A hand that is long beside the arm loses two digits of the wrist.
    """
    for hand, bend, size in ((0.2, (1.5, 2.0), 1.0), (1.0, (0.1, 3.0), 1.0), (2.0, (0.1, 3.0), 1.0),
                             (30.0, (0.5, 2.5), 1.0), (1e-8, (0.5, 2.5), 1.0), (1.0, (0.5, 2.5), TINY),
                             (1.0, (0.5, 2.5), 1e6)):
        for elbow in (1.0, -1.0):
            lengths = size * np.append(draw(1.2, 1.5, 2), hand * draw(0.9, 1.1))
            theta = np.array([draw(-3.1, 3.1), elbow * draw(*bend), draw(-3.1, 3.1)])
            for turns in (0, draw.whole(1, 2), -draw.whole(5, 9)):
                target = np.append(joints(theta, lengths)[-1], theta.sum() + 2.0 * np.pi * turns)
                close("θ [rad]", lesson.solve_3r(target, lengths, elbow), theta, SOLVED,
                      given=f"target {target}, lengths {lengths} m, elbow {elbow:g}")
    reach_special_targets(lesson, draw)


def reach_special_targets(lesson, draw):
    """Exercise 11.5 for a target or a wrist at the base, for a target nearer than the hand is long, and for φ = 0."""
    drawn, some = draw(0.8, 1.2, 3), draw(-3.0, 3.0)
    hand = drawn[2] * np.array([np.cos(some), np.sin(some)])
    along = draw(0.1, 0.3) * np.vstack((np.eye(2), -np.eye(2)))
    for lengths, place, phi in ((drawn, np.zeros(2), some), (drawn, 0.3 * hand, some), (drawn[[0, 0, 2]], hand, some),
                                (drawn, draw(0.5, 1.3, 2), 0.0), *((drawn, one, 0.0) for one in along)):
        for elbow in (1.0, -1.0):
            got = np.asarray(lesson.solve_3r(np.append(place, phi), lengths, elbow))
            given = f"target {place} m, φ = {phi}, lengths {lengths} m, elbow {elbow:g}"
            close("end of the arm [m]", joints(got, lengths)[-1], place, SOLVED, given=given)
            close("direction of the end [-]", (np.cos(got.sum()), np.sin(got.sum())), (np.cos(phi), np.sin(phi)),
                  SOLVED, given=given)
            close("sign of θ₂ [-]", np.sign(got[1]), elbow, 0.0, given=given)


@exercise("11.5", points=0.5, hint="both elbows of the first two joints; the third turns the hand back to φ")
def test_links_of_three_two_and_one_reach_four_two_in_two_ways(lesson, draw):
    """Lynch and Park 2017, chapter 6: (0°, 90°, −90°), and by mirroring at the line to the wrist the other one."""
    scale, aside, half = draw(0.3, 3.0), draw(-1.0, 1.0), np.arctan2(2.0, 3.0)
    c, s = np.cos(aside), np.sin(aside)
    target = np.array([scale * (4.0 * c - 2.0 * s), scale * (4.0 * s + 2.0 * c), aside])
    for elbow, expected in ((1.0, (aside, 0.5 * np.pi, -0.5 * np.pi)),
                            (-1.0, (aside + 2.0 * half, -0.5 * np.pi, 0.5 * np.pi - 2.0 * half))):
        close("θ [rad]", lesson.solve_3r(target, scale * np.array([3.0, 2.0, 1.0]), elbow), expected, SOLVED,
              given=f"scale {scale}, rotated by {aside} rad, elbow {elbow:g}")
    theta = np.array([draw(2.0, 3.0), draw(2.0, 3.0), draw(2.0, 2.5)])        # φ goes round more than once
    target = np.append(joints(theta, (3.0, 2.0, 1.0))[-1], theta.sum() - 2.0 * np.pi)
    theta_3 = lesson.solve_3r(target, np.array([3.0, 2.0, 1.0]), 1.0)[2]
    close("θ₃ of a hand that points far round, wrapped [rad]", theta_3, theta[2], SOLVED, given=f"target {target}")
    theta = np.array([draw(-0.5, 0.5), draw(0.5, 2.5), draw(1e-9, 1e-8)])     # the hand hardly turns
    target = np.append(joints(theta, (3.0, 2.0, 1.0))[-1], theta.sum())
    theta_3 = lesson.solve_3r(target, np.array([3.0, 2.0, 1.0]), 1.0)[2]
    close("θ₃ of a hand that hardly turns, over its truth [-]", theta_3 / theta[2], 1.0, 1e-4, given=f"θ = {theta}")
    raises("a wrist out of reach", BadInput, lesson.solve_3r, np.array([6.1 + scale, 0.0, np.pi]),
           np.array([3.0, 2.0, 1.0]), 1.0, naming=(7.1 + scale,), thing="distance of the target")


# ---------------------------------------------------------------------------------------------- forward, in space

@exercise("11.6", points=0.5, hint="the axis by q before its joint turns, the offset by q after it; q ∘ exp(θ axis)")
def test_each_joint_turns_about_an_axis_of_the_link_before_it(lesson, draw):
    for n, size in ((draw.whole(3, 7), 1.0), (9, 1.0), (2, 1.0), (2, 1.0), (1, 1.0), (4, TINY), (4, 1e6), (8, 1.0)):
        theta, axes, offsets = machine(draw) if n == 8 else chain(draw, n)
        offsets *= size
        theta[n // 2] *= 1e-4 if n < 9 else 1e-8                         # this joint hardly turns
        if n == 9:                                                       # these not at all, twice, a half, and back
            theta[:4], theta[6:8] = (0.0, draw(13.0, 20.0), np.pi, -draw(7.0, 12.0)), 0.0
            offsets[:3], offsets[7] = 0.0, 0.0                           # a wrist of three joints at the base
        x, a, q = lesson.joint_frames(theta, axes, offsets)
        x_true, a_true, R = frames(theta, axes, offsets)
        given = f"θ = {theta}"
        close("positions of the joints and the end [m]", x, x_true, size * ROUND_OFF, given=given)
        close("axes of the joints in the world [-]", a, a_true, ROUND_OFF, given=given)
        close("length of the quaternion [-]", np.linalg.norm(q), 1.0, ROUND_OFF, given=given)
        close("axes of the last link [-]", quaternion_matrix(*np.asarray(q)).T, R.T, 1e-7, given=given)


@exercise("11.6", points=0.5,
          hint="with all axes along z it is the planar chain, and q is the rotation about z by the sum of angles")
def test_a_chain_with_parallel_axes_is_planar(lesson, draw):
    n = draw.whole(2, 6)
    theta, lengths, z = draw(-1.0, 1.0, n), lengths_of(draw, n), np.array([0.0, 0.0, 1.0])
    x, a, q = lesson.joint_frames(theta, np.tile(z, (n, 1)), lengths[:, None] * np.array([1.0, 0.0, 0.0]))
    flat = np.column_stack((joints(theta, lengths), np.zeros(n + 1)))
    close("positions of the joints and the end [m]", x, flat, ROUND_OFF, given=f"θ = {theta}, lengths {lengths} m")
    close("axes of the joints in the world [-]", a, np.tile(z, (n, 1)), ROUND_OFF)
    expected = quaternion(z, theta.sum())
    if np.shape(q) == (4,) and np.dot(q, expected) < 0.0:                # −q is the same orientation
        expected = -expected
    close("orientation of the last link [-]", q, expected, ROUND_OFF, given=f"θ = {theta}")


@exercise("11.7", points=1, hint="rows 0 to 2: a_k × (x_n − x_k), rows 3 to 5: a_k")
def test_the_jacobian_in_space_is_a_derivative(lesson, draw):
    for n, size in ((2, 1.0), (3, 1.0), (6, 1.0), (9, 1.0), (1, 1.0), (4, TINY), (4, 1e6), (8, 1.0)):
        theta, axes, offsets = machine(draw) if n == 8 else chain(draw, n)
        offsets *= size                                                  # up to 1000 km
        x, a, R = frames(theta, axes, offsets)
        J = np.asarray(lesson.jacobian_3d(x, a))
        close("shape of J [-]", J.shape, (6, n), 0.0)
        for k in range(n):
            step, given = DIFFERENCE * np.eye(n)[k], f"joint {k} of {n} turns with 1 rad/s"
            (ahead, _, R_ahead), (behind, _, R_behind) = (frames(theta + s * step, axes, offsets) for s in (1.0, -1.0))
            spin = 0.5 * (R_ahead - R_behind) / DIFFERENCE @ R.T
            close("velocity of the end [m/s]", J[:3, k], 0.5 * (ahead[-1] - behind[-1]) / DIFFERENCE, size * SLOPE,
                  given=given)
            close("angular velocity of the last link [rad/s]", J[3:, k], (spin[2, 1], spin[0, 2], spin[1, 0]), SLOPE,
                  given=given)


@exercise("11.7", points=0.5, hint="a × r is perpendicular to both, right-handed; r leads from the joint to the end")
def test_an_axis_through_the_end_moves_it_nowhere(lesson, draw):
    x, a = draw(-2.0, 2.0, (5, 3)), np.stack([unit(draw) for _ in range(4)])
    x[4] = x[1] + draw(0.5, 2.0) * a[1]
    x[3] = x[4]                                                          # the last joint is at the end
    J = np.asarray(lesson.jacobian_3d(x, a))
    close("angular velocity of the last link [rad/s]", J[3:], a.T, ROUND_OFF, given=f"joints and end at {x} m")
    for k in (1, 3):
        close("velocity of an end that is on the axis [m/s]", J[:3, k], np.zeros(3), ROUND_OFF, given=f"axis {a[k]}")
    for k in (0, 2):
        r = x[4] - x[k]
        expected = (a[k, 1] * r[2] - a[k, 2] * r[1], a[k, 2] * r[0] - a[k, 0] * r[2], a[k, 0] * r[1] - a[k, 1] * r[0])
        close("velocity of the end [m/s]", J[:3, k], expected, ROUND_OFF, given=f"axis {a[k]}, end at {r} m from it")
    x, a = draw(-2.0, 2.0, (7, 3)), np.vstack((np.eye(3), -np.eye(3)))
    x[0] = x[6]                                                          # the end is back at the base
    close("J of axes along those of coordinates [m/rad, -]", lesson.jacobian_3d(x, a),
          np.vstack((np.cross(a, x[6] - x[:6]).T, a.T)), ROUND_OFF, given=f"joints and end at {x} m, axes {a}")


@exercise("11.8", points=0.5,
          hint="d = q_target ∘ q̄, not the other way round; 2 atan2(|xyz|, w) keeps its digits up to half a turn")
def test_the_rotation_vector_turns_one_orientation_into_the_other(lesson, draw):
    for sign in (1.0, -1.0):
        for _ in range(6):
            axis, angle, old, about = unit(draw), draw(0.1, 3.1), draw(0.5, 3.0), unit(draw)
            q = quaternion(about, old) * (2.0 * draw.whole(0, 1) - 1.0)       # q and −q are the same orientation
            R = turn(axis, angle) @ turn(about, old)
            new = np.sqrt(max(0.0, 1.0 + np.trace(R)))                        # 2w, of the product of both
            d, b = quaternion(axis, angle), q
            rest = d[0] * b[1:] + b[0] * d[1:] + np.cross(d[1:], b[1:])
            q_target = sign * np.append(d[0] * b[0] - d[1:] @ b[1:], rest)
            assert abs(abs(2.0 * q_target[0]) - new) < 1e-6                   # the test's own two ways agree
            close("rotation vector [rad]", lesson.rotation_error(q, q_target), angle * axis, SOLVED,
                  given=f"q = {q}, q_target = {q_target}")
    turn_between_axes(lesson, draw)


def turn_between_axes(lesson, draw):
    """Exercise 11.8 for orientations that are turned about axes of coordinates: each may be by half a turn."""
    for i, k in itertools.product(range(3), repeat=2):
        for old, new in ((draw(0.5, 3.0), draw(0.5, 3.0)), (np.pi, draw(0.5, 3.0)), (draw(0.5, 3.0), np.pi),
                         (0.0, draw(0.5, 3.0)), (0.5 * np.pi, 0.5 * np.pi), (np.pi, np.pi),
                         (draw(3.5, 6.0), draw(0.5, 3.0)), (draw(0.5, 3.0), draw(3.5, 6.0))):
            q, q_target = quaternion(np.eye(3)[i], old), quaternion(np.eye(3)[k], -new)
            q[0], q_target[0] = (0.0 if angle == np.pi else w for angle, w in ((old, q[0]), (new, q_target[0])))
            phi = np.asarray(lesson.rotation_error(q, q_target))
            given, size = f"q = {q}, q_target = {q_target}", np.linalg.norm(phi)
            between("length of the rotation vector [rad]", size, 0.0, np.pi + ROUND_OFF, given=given)
            close("axes that the rotation vector has turned [-]",
                  turn(phi / (size or 1.0), size) @ quaternion_matrix(*q), quaternion_matrix(*q_target), SOLVED,
                  given=given)


@exercise("11.8", points=0.5,
          hint="take the shorter rotation; atan2 keeps the digits of a small angle, and for 0 the result is 0")
def test_small_and_large_angles_keep_their_digits(lesson, draw):
    axis, q = unit(draw), quaternion(unit(draw), draw(0.5, 3.0))
    still = np.array([1.0, 0.0, 0.0, 0.0])
    for sign in (1.0, -1.0):
        close("rotation vector from an orientation to itself [rad]", lesson.rotation_error(q, sign * q), np.zeros(3),
              1e-15, given=f"q = {q}, q_target = {sign * q}")
        close("rotation vector of no rotation at all [rad]", lesson.rotation_error(still, sign * still), np.zeros(3),
              0.0, given=f"q = {still}, q_target = {sign * still}")
    for least in (3e-8, 1e-9, 1e-13, 1e-18, 1e-5, 1e-3, 1e-2):
        angle = draw(least, 1.3 * least)
        for sign in (1.0, -1.0):                                         # of a quaternion: both are this orientation
            close("rotation vector over its small angle [-]",
                  np.asarray(lesson.rotation_error(still, sign * quaternion(axis, angle))) / angle, axis, ROUND_OFF,
                  given=f"angle {angle} rad, q_target {'with' if sign > 0.0 else 'with −'}cos ½φ")
    angle = np.pi - draw(1e-7, 1e-6)
    close("rotation vector of nearly half a turn [rad]", lesson.rotation_error(still, quaternion(axis, angle)),
          angle * axis, ROUND_OFF, given=f"angle {angle} rad about {axis}")
    got = np.asarray(lesson.rotation_error(still, np.append(0.0, axis)))
    close("rotation vector of half a turn, in one sense or the other [rad]", got * np.sign(got @ axis), np.pi * axis,
          ROUND_OFF, given=f"half a turn about {axis}")
    for w in (draw(1e-12, 1e-11), draw(1e-17, 1e-16)):
        close("rotation vector of hardly more than half a turn [rad]",
              lesson.rotation_error(still, np.append(-w, axis)), (2.0 * w - np.pi) * axis, 1e-14,
              given=f"half a turn, and {2.0 * w} rad more, about {axis}")
    for signs in ((1.0, -1.0, 0.0), (0.0, 1.0, -1.0), (-1.0, 0.0, 1.0), (-1.0, -1.0, -1.0)):
        about, angle = np.array(signs) / np.linalg.norm(signs), draw(0.5, 3.0)
        close("rotation vector about an axis whose numbers add up to zero, or are below it [rad]",
              lesson.rotation_error(still, quaternion(about, angle)), angle * about, SOLVED,
              given=f"angle {angle} rad about {about}")
    angle = draw(3.3, 6.0)
    close("rotation vector by the shorter way [rad]", lesson.rotation_error(still, quaternion(axis, angle)),
          (angle - 2.0 * np.pi) * axis, SOLVED, given=f"angle {angle} rad about {axis}")


# ---------------------------------------------------------------------------------------------- methods with a Jacobian

@exercise("11.9", points=0.5, hint="θ + α Jᵀ e with all rows of e and J, and no limits; e @ J is Jᵀ e")
def test_a_transpose_step_goes_down_the_gradient(lesson, draw):
    for (task, count), n in zip((*TASKS, TASKS[0]), (draw.whole(3, 6), draw.whole(3, 5), 2), strict=True):
        lengths, theta, gain = lengths_of(draw, n), turned(draw, n), draw(0.7, 3.0)
        here, bearing = points_of(theta, lengths, count), draw(-3.0, 3.0, count)
        way = np.stack((np.cos(bearing), np.sin(bearing)), axis=1).ravel()
        for away in (draw(0.1, 1.0), draw(30.0, 40.0)):                  # near, and far beyond the reach
            target = here + away * way
            errors = [[target - points_of(theta + s * d, lengths, count) for s in (1.0, -1.0)]
                      for d in DIFFERENCE * np.eye(n)]
            slope = [0.5 * (ahead @ ahead - behind @ behind) for ahead, behind in errors]
            got = lesson.transpose_step(task, theta, target, arm_of(lesson, lengths, gain=gain, **NARROW))
            close("change of θ over the gain [-]", (np.asarray(got) - theta) / gain,
                  -0.5 * np.array(slope) / DIFFERENCE, 1e-6,
                  given=f"θ = {theta}, target {target} m, α = {gain}, {2 * count} rows")
    for far in FAR:
        lengths, theta, target, e, J = posed(draw, 4, far)
        got = lesson.transpose_step(pose, theta, target, arm_of(lesson, lengths, gain=gain, **around(theta)))
        close("change of θ towards a place and a direction, over the gain [-]", (np.asarray(got) - theta) / gain, e @ J,
              SOLVED, given=f"θ = {theta}, target {target}, α = {gain}, 3 rows")
    close("θ after a step with the gain 0 [rad]",
          lesson.transpose_step(pose, theta, target, arm_of(lesson, lengths, gain=0.0)), theta, 0.0,
          given=f"θ = {theta}, target {target}, α = 0")
    for e, J, target in special_equations(draw):                         # each joint is at both of its limits
        n = J.shape[1]
        got = lesson.transpose_step(linear, np.zeros(n), target,
                                    arm_of(lesson, np.ones(n), gain=gain, low=0.0, high=0.0, rest=1.0))
        close("change of θ for a special linear task, over the gain [-]", np.asarray(got) / gain, e @ J, ROUND_OFF,
              given=f"θ = 0, e = {e}, J = {J}, α = {gain}")
    for (rows, size), small in itertools.product(EQUATIONS, (1.0, 1e-5)):
        (e, J, target), gain = equations(draw, rows, size), small * draw(0.7, 3.0)
        got = lesson.transpose_step(linear, np.zeros(5), target, arm_of(lesson, np.ones(5), gain=gain, **NARROW))
        close("change of θ for a linear task, over the gain and the size of e [-]", np.asarray(got) / (gain * size),
              e @ J, ROUND_OFF, given=f"θ = 0, e = {size * e}, J = {J}, α = {gain}, {rows} rows")


@exercise("11.9", points=0.5,
          hint="the step multiplies the error along u_i by 1 − α σ²: do not scale it in another way")
def test_the_gain_decides_how_fast_the_error_shrinks(lesson, draw):
    lengths, theta = lengths_of(draw, 3), bent(draw, 3)
    u, sigma, v = np.linalg.svd(slopes(theta, lengths), full_matrices=False)
    target = joints(theta, lengths)[-1]
    for part in (draw(0.2, 0.8), draw(1.2, 1.8), draw(2.2, 2.8)):
        arm = arm_of(lesson, lengths, gain=part / sigma[0] ** 2, **NARROW)
        both = [lesson.transpose_step(reach, theta + s * DIFFERENCE * v[0], target, arm) for s in (1.0, -1.0)]
        ends = [u[:, 0] @ joints(np.asarray(one), lengths)[-1] for one in both]
        close("error after a step over the error before it [-]", 0.5 * (ends[0] - ends[1]) / (DIFFERENCE * sigma[0]),
              1.0 - part, 1e-7, given=f"α = {part} over the square of σ")


@exercise("11.10", points=0.5, hint="v_i u_iᵀ/σ_i, added up; the result has as many rows as J has columns")
def test_the_pseudo_inverse_solves_with_the_shortest_answer(lesson, draw):
    for m, n, size in ((2, 5, 1.0), (3, 3, 1.0), (4, 2, 1.0), (8, 9, 1.0), (6, 4, 1.0), (2, 3, TINY),
                       (1, 4, 1.0), (5, 1, 1.0), (1, 1, 1.0)):
        J, _ = with_singular_values(draw, size * draw(0.5, 3.0, min(m, n)), max(m, n))
        J = np.ascontiguousarray(J if m <= n else J.T)
        expected = np.stack([np.linalg.lstsq(J, e, rcond=None)[0] for e in np.eye(m)], axis=1)
        close("J⁺", np.asarray(lesson.pseudo_inverse(J)) * size, size * expected, SOLVED, given=f"J = {J}")
    for one in special_matrices(draw):
        for J in (one, np.ascontiguousarray(one.T)):
            expected = np.stack([np.linalg.lstsq(J, e, rcond=1e-10)[0] for e in np.eye(len(J))], axis=1)
            close("J⁺ of a special J", lesson.pseudo_inverse(J), expected, SOLVED, given=f"J = {J}")
    J = draw(0.5, 2.0) * np.eye(5)[[3, 0, 4]]
    close("J⁺, with singular values that are equal", lesson.pseudo_inverse(J), J.T / np.max(J) ** 2, SOLVED,
          given=f"J = {J}")


@exercise("11.10", points=0.5, hint="leave out every σ_i up to SINGULAR σ₁: 1/σ of a round-off would spoil the answer")
def test_directions_that_no_joint_can_move_are_left_alone(lesson, draw):
    straight = np.array([[0.0, 0.0, 0.0], [4.0, 2.0, 1.0]])
    close("J⁺ of a straight arm along x", lesson.pseudo_inverse(straight), straight.T / 21.0, SOLVED,
          given=f"J = {straight}")
    tall = np.ascontiguousarray(straight.T)
    close("J⁺ of its transpose", lesson.pseudo_inverse(tall), straight / 21.0, SOLVED, given=f"J = {tall}")
    for size, small, n in ((1.0, 0.0, 5), (1.0, draw(1e-14, 1e-12), 3), (1e6, draw(1e-14, 1e-12), 5),
                           (1e-3, draw(9e-11, 9.9e-11), 3)):             # parts of the largest σ, below SINGULAR
        sigma = size * draw(1.0, 3.0) * np.array([1.0, draw(0.5, 0.9), small])
        J, u = with_singular_values(draw, sigma, n)
        got = np.asarray(lesson.pseudo_inverse(J))
        close("J⁺ applied to the lost direction, times σ₁ [-]", sigma[0] * got @ u[:, 2], np.zeros(n), SOLVED,
              given=f"σ = {sigma}")
        close("J J⁺ applied to the others [-]", J @ got @ u[:, :2], u[:, :2], SOLVED, given=f"σ = {sigma}")
    for size, large in ((1.0, 1), (1e-3, 1), (1.0, 4)):                  # four large σ have a larger sum and norm
        sigma = size * np.append(1.0 - 0.1 * np.arange(large), draw(1.01e-10, 1.1e-10))
        J, u = with_singular_values(draw, sigma, large + 2)
        close("J J⁺ of a small σ that is not lost [-]", J @ np.asarray(lesson.pseudo_inverse(J)), np.eye(large + 1),
              1e-4, given=f"σ = {sigma}")
    for m, n in ((2, 3), (1, 1), (1, 4), (5, 1)):
        close("J⁺ of a J of zeros", lesson.pseudo_inverse(np.zeros((m, n))), np.zeros((n, m)), 0.0,
              given=f"{m} rows, {n} columns")


def damped(J, e, damping):
    """The Δθ with the smallest |J Δθ − e|² + λ²|Δθ|², by least squares."""
    n = J.shape[1]
    return np.linalg.lstsq(np.vstack((J, damping * np.eye(n))), np.append(e, np.zeros(n)), rcond=None)[0]


@exercise("11.11", points=0.5,
          hint="λ², not λ, in every row of the diagonal of J Jᵀ; then solve(A, e) @ J, and no limits")
def test_a_damped_step_weighs_the_error_against_the_way(lesson, draw):
    for task, count in TASKS:
        n = draw.whole(3, 6)
        for size in (1.0, TINY, 1e3):                                    # arms of metres, next to nothing, kilometres
            lengths, theta, damping = size * lengths_of(draw, n), turned(draw, n), size * draw(0.5, 1.5)
            target = size * draw(-2.0, 2.0, 2 * count)
            e, J = target - points_of(theta, lengths, count), slopes_of(theta, lengths, count)
            got = lesson.damped_step(task, theta, target, arm_of(lesson, lengths, damping=damping, **NARROW))
            close("θ after a step [rad]", got, theta + damped(J, e, damping), SOLVED,
                  given=f"θ = {theta}, target {target} m, λ = {damping} m")
    for far in FAR:
        lengths, theta, target, e, J = posed(draw, 4, far)
        got = lesson.damped_step(pose, theta, target, arm_of(lesson, lengths, damping=0.7, **around(theta)))
        close("θ after a step towards a place and a direction [rad]", got, theta + damped(J, e, 0.7), 0.01 * SOLVED,
              given=f"θ = {theta}, target {target}, λ = 0.7 m")
    for rows, size in EQUATIONS:
        (e, J, target), damping = equations(draw, rows, size), draw(0.5, 1.0)
        got = lesson.damped_step(linear, np.zeros(5), target, arm_of(lesson, np.ones(5), damping=damping, **NARROW))
        close("change of θ for a linear task, over the size of e [-]", np.asarray(got) / size, damped(J, e, damping),
              SOLVED, given=f"θ = 0, e = {size * e}, J = {J}, λ = {damping}, {rows} rows")
    for e, J, target in special_equations(draw):
        n = J.shape[1]
        got = lesson.damped_step(linear, np.zeros(n), target,
                                 arm_of(lesson, np.ones(n), damping=damping, low=0.0, high=0.0, rest=1.0))
        close("change of θ for a special linear task [-]", got, damped(J, e, damping), SOLVED,
              given=f"θ = 0, e = {e}, J = {J}, λ = {damping}")
    for size in (1.0, TINY):
        lengths, theta, target = size * lengths_of(draw, 2), bent(draw, 2), size * draw(-2.0, 2.0, 2)
        expected = theta + np.linalg.solve(slopes(theta, lengths), target - points_of(theta, lengths))
        got = lesson.damped_step(reach, theta, target, arm_of(lesson, lengths, damping=0.0))
        close("θ after a step without damping [rad]", got, expected, 1e-9,
              given=f"θ = {theta}, λ = 0, lengths {lengths} m")


@exercise("11.11", points=0.5, hint="Jᵀ (J Jᵀ + λ² 1)⁻¹ e is never longer than |e|/(2λ), for any J")
def test_a_damped_step_is_bounded_where_the_arm_is_straight(lesson, draw):
    for damping in (draw(0.05, 0.2), draw(0.5, 1.0)):
        lengths, theta, target = lengths_of(draw, 3), np.array([draw(-3.0, 3.0), 0.0, 0.0]), draw(-9.0, 9.0, 2)
        arm = arm_of(lesson, lengths, damping=damping, **NARROW)
        got = np.asarray(lesson.damped_step(reach, theta, target, arm)) - theta
        e, J = target - joints(theta, lengths)[-1], slopes(theta, lengths)
        sigma = np.linalg.norm(J)                                             # a straight arm has only one above 0
        across = np.array([-np.sin(theta[0]), np.cos(theta[0])])
        close("size of the step of a straight arm [rad]", np.linalg.norm(got),
              abs(across @ e) * sigma / (sigma**2 + damping**2), SOLVED, given=f"θ₁ = {theta[0]}, λ = {damping} m")
    lengths, theta, damping = lengths_of(draw, 3), np.append(draw(-3.0, 3.0), draw(1e-4, 2e-4, 2)), draw(1e-4, 2e-4)
    e, J = draw(0.5, 1.0, 2), slopes(theta, lengths)                          # nearly straight: σ₂ is as small as λ
    got = lesson.damped_step(reach, theta, joints(theta, lengths)[-1] + e, arm_of(lesson, lengths, damping=damping))
    # J Jᵀ is rounded by 1e-15 of 50 m², and σ₂² + λ² is 1e-8 m²
    close("change of θ of an arm that is nearly straight, times λ [m]", damping * (np.asarray(got) - theta),
          damping * damped(J, e, damping), 1e-4, given=f"θ = {theta}, λ = {damping} m")


@exercise("11.12", points=0.5, hint="return 1 − α σ² and λ²/(σ² + λ²) for every σ")
def test_factors_are_what_an_iteration_leaves_of_an_error(lesson, draw):
    drawn, damping = np.sort(draw(0.2, 3.0, 3))[::-1].copy(), draw(0.1, 1.0)
    for gain, sigma in ((draw(0.05, 0.5), drawn), (0.0, drawn), (draw(0.05, 0.5), drawn[[0, 0, 2]])):
        J, u = with_singular_values(draw, sigma, 4)
        stay = [np.eye(3) - J @ P for P in (gain * J.T, np.stack([damped(J, e, damping) for e in np.eye(3)], axis=1))]
        expected = [[one @ u[:, i] @ u[:, i] for i in range(3)] for one in stay]
        got = lesson.contraction_factors(sigma, gain, damping)
        for name, one, factors in zip(("transpose", "damped"), got, expected, strict=True):
            close(f"factors of the {name} [-]", one, factors, SOLVED, given=f"σ = {sigma}, α = {gain}, λ = {damping}")


@exercise("11.12", points=0.5, hint="for σ = 0 both factors are 1; the factor of the transpose may be below 0")
def test_factors_at_the_ends_of_their_range(lesson, draw):
    ratio, small = draw(5.0, 9.0), draw(1e-4, 2e-4)
    for parts, scale in (((0.0, small, 1.0, ratio), 1.0), ((ratio,), 1.0), ((1.0, ratio), TINY), ((1.0, ratio), 1e7)):
        parts, size = np.array(parts), scale * draw(0.3, 3.0)                            # of what α and λ are made of
        factors = lesson.contraction_factors(size * parts, 1.0 / size**2, size)
        for got, expected in zip(factors, (1.0 - parts**2, 1.0 / (1.0 + parts**2)), strict=True):
            close("factors [-]", got, expected, ROUND_OFF, given=f"σ = {size * parts} m, α = 1/λ², λ = {size} m")
    parts = 10.0 ** draw(1.0, 5.0, 6)
    gradient, damping = lesson.contraction_factors(parts, 1.0, 1.0)
    close("factors of the transpose for large σ, over σ² [-]", np.asarray(gradient) / parts**2, 1.0 / parts**2 - 1.0,
          ROUND_OFF, given=f"σ = {parts} m, α = 1/m²")
    close("factors of the damped step for large σ [-]", damping, 1.0 / (1.0 + parts**2), ROUND_OFF,
          given=f"σ = {parts} m, λ = 1 m")


# ---------------------------------------------------------------------------------------------- methods without

def coordinate_descent(theta, target, lengths, low, high):
    """One sweep, with all positions computed again for every joint."""
    theta, goal = np.array(theta), complex(*target)
    for k in reversed(range(len(theta))):
        z = joints(theta, lengths) @ np.array([1.0, 1j])
        change = np.angle((goal - z[k]) * np.conj(z[-1] - z[k]))
        theta[k] = min(max(theta[k] + change, low[k]), high[k])
    return theta


@exercise("11.13", points=1, hint="last joint first; after each joint, turn the end about x_k")
def test_each_joint_points_the_end_at_the_target(lesson, draw):
    for n in (draw.whole(3, 7), 2, 1):
        lengths, theta, target = lengths_of(draw, n), draw(-1.5, 1.5, n), draw(-2.0, 2.0, 2)
        theta[0] += draw(4.0, 6.0)                                       # beyond half a turn
        arm = arm_of(lesson, lengths)
        expected = coordinate_descent(theta, target, lengths, arm.low, arm.high)
        close("θ after a sweep [rad]", lesson.ccd_step(reach, theta, target, arm), expected, 1e-9,
              given=f"θ = {theta}, target {target} m, lengths {lengths} m")
    for n, size, near in ((3, 1.0, 1e-3), (3, 1.0, 1e-6), (9, TINY, 1.0), (4, 1e6, 1.0),
                          (3, 1.0, 30.0)):                               # out of reach
        lengths, theta = size * lengths_of(draw, n), draw(-1.5, 1.5, n)
        theta[0] *= 1e-3
        arm, target = arm_of(lesson, lengths), joints(theta, lengths)[-1] + size * near * unit(draw, 2)
        close("θ after a sweep [rad]", lesson.ccd_step(reach, theta, target, arm),
              coordinate_descent(theta, target, lengths, arm.low, arm.high), 1e-9,
              given=f"θ = {theta}, target {target} m, lengths {lengths} m")
    lengths, theta = lengths_of(draw, 3), draw(-1.5, 1.5, 3)
    arm = arm_of(lesson, lengths)
    got = np.asarray(lesson.ccd_step(reach, theta, np.zeros(2), arm))    # where the first joint is: it may turn anyhow
    expected = coordinate_descent(theta, np.zeros(2), lengths, arm.low, arm.high)
    between("θ₁ for a target at the base [rad]", got[0], -2.0 * np.pi, 2.0 * np.pi, given=f"θ = {theta}")
    close("θ₂ and θ₃ for a target at the base [rad]", got[1:], expected[1:], 1e-9, given=f"θ = {theta}")
    for signs in ((1.0, -1.0), (-1.0, 1.0), (0.0, 1.0), (0.0, -1.0), (1.0, 0.0), (-1.0, -1.0)):
        target = draw(0.5, 2.0) * np.array(signs)                        # as seen from the base
        close("θ after a sweep to a target along an axis or a diagonal [rad]",
              lesson.ccd_step(reach, theta, target, arm), coordinate_descent(theta, target, lengths, arm.low, arm.high),
              1e-9, given=f"θ = {theta}, target {target} m, lengths {lengths} m")
    theta, hardly = np.append(draw(-3.0, 3.0), draw(0.3, 0.6, 2)), 1e-10
    target = joints(theta, lengths)[-1] + hardly * unit(draw, 2)
    close("θ after a sweep to a target at which the end nearly is [rad]", lesson.ccd_step(reach, theta, target, arm),
          coordinate_descent(theta, target, lengths, arm.low, arm.high), 0.01 * hardly,
          given=f"θ = {theta}, target {hardly} m from the end")
    target = draw(-2.0, 2.0, 2)
    close("θ after a sweep, where the task has another end [rad]", lesson.ccd_step(arrived, theta, target, arm),
          coordinate_descent(theta, target, lengths, arm.low, arm.high), 1e-9, given=f"θ = {theta}, target {target} m")


def sweep_special_arms(lesson, draw):
    """The sweep of 11.13 for an end at the target, joints without room, and targets at the base or exactly behind."""
    n = draw.whole(2, 5)
    lengths, theta = np.round(64.0 * lengths_of(draw, n)) / 64.0, np.zeros(n)
    end = np.array([lengths.sum(), 0.0])                                 # of few binary digits: exactly there
    for side in (1.0, -1.0):
        near = side * draw(0.2, 0.8, n)                                  # the limit that all joints are beyond
        for target in (end, *draw(-2.0, 2.0, (5, 2))):                   # joints come to the one limit or the other
            low, high = np.minimum(near, 1.1 * near), np.maximum(near, 1.1 * near)
            got = lesson.ccd_step(reach, theta, target, arm_of(lesson, lengths, low=low, high=high))
            close("θ after a sweep of an arm that is beyond its limits [rad]", got,
                  coordinate_descent(theta, target, lengths, low, high), 1e-9,
                  given=f"θ = {theta}, target {target} m, limits {low} to {high}")
        for target in (end, np.zeros(2), draw(-2.0, 2.0, 2)):
            close("θ after a sweep of joints whose two limits are equal [rad]",
                  lesson.ccd_step(reach, theta, target, arm_of(lesson, lengths, low=near, high=near)), near,
                  ROUND_OFF, given=f"θ = {theta}, target {target} m, limits {near}")
    for parts in (np.ones(1), np.array([1.0, 0.5, 0.75])):               # the last one folds, and then turns as a whole
        lengths, target = draw(0.5, 2.0) * parts, np.array([-draw(0.5, 1.0), 0.0])
        theta, arm = np.zeros(len(parts)), arm_of(lesson, lengths)
        got = np.asarray(lesson.ccd_step(reach, theta, target, arm))
        close("end of an arm along x after a sweep to a target exactly behind [m]", joints(got, lengths)[-1],
              joints(coordinate_descent(theta, target, lengths, arm.low, arm.high), lengths)[-1], 1e-9,
              given=f"lengths {lengths} m, target {target} m")


@exercise("11.13", points=0.5,
          hint="stop each joint at its limit, and turn the end by the actual change of the angle")
def test_limits_stop_a_joint_and_the_others_go_on(lesson, draw):
    for trial in range(12):                                              # both limits of a joint above 0, or both below
        n = draw.whole(3, 6)
        lengths, theta, target = lengths_of(draw, n), draw(-0.3, 0.3, n), draw(-2.0, 2.0, 2)
        around = draw(0.9, 1.5, n) * (-1.0) ** (np.arange(n) + trial)
        around[0] += 2.0 * np.pi * draw.whole(0, 1)
        theta, low, high = theta + around, around + draw(-0.9, -0.3, n), around + draw(0.3, 0.9, n)
        if trial > 3:                                                    # some begin beyond a limit, some have one only
            k = np.arange(n)
            theta = np.where(k % 3 == 0, high + 1.5, theta) if trial % 2 else np.where(k % 3 == 0, low - 1.5, theta)
            low, high = np.where(k % 3 == 1, -np.inf, low), np.where(k % 3 == 2, np.inf, high)
        if trial > 7:                                                    # each begins exactly at a limit
            theta = np.where((low == -np.inf) | (high < np.inf) & (k % 2 == trial % 2), high, low)
        arm = arm_of(lesson, lengths, low=low, high=high)
        got = np.asarray(lesson.ccd_step(reach, theta, target, arm))
        expected = coordinate_descent(theta, target, lengths, arm.low, arm.high)
        close("θ after a sweep between limits [rad]", got, expected, 1e-9,
              given=f"θ = {theta}, target {target} m, limits {arm.low} to {arm.high}")
    theta = np.array([0.0, np.pi, -2.0 * np.pi])                         # folded, so that its end is at its base
    arm = arm_of(lesson, draw(0.5, 2.0) * np.array([1.0, 0.5, 0.5]), low=theta - np.eye(3)[0],
                 high=theta + np.eye(3)[0])
    got = np.asarray(lesson.ccd_step(reach, theta, draw(0.5, 1.0, 2), arm))
    between("θ₁ of a stiff arm whose end is at its base [rad]", got[0], -1.0, 1.0, given=f"θ = {theta}")
    sweep_special_arms(lesson, draw)


def there_and_back(x, target, lengths):
    """A sweep by unit vectors."""
    x, base = [np.array(p) for p in x], np.array(x[0])
    x[-1] = np.array(target)
    for k in reversed(range(len(lengths))):
        r = x[k] - x[k + 1]
        x[k] = x[k + 1] + lengths[k] * r / np.linalg.norm(r)
    x[0] = base
    for k in range(len(lengths)):
        r = x[k + 1] - x[k]
        x[k + 1] = x[k] + lengths[k] * r / np.linalg.norm(r)
    return np.array(x)


@exercise("11.14", points=0.5,
          hint="back: from the target, with the new joint x_k+1; forth: from the base, with the new joint x_k")
def test_a_sweep_projects_there_and_back(lesson, draw):
    for d, far, n, size in ((3, 0.0, draw.whole(3, 6), 1.0), (2, 0.0, draw.whole(7, 9), 1.0),
                            (2, 20.0, draw.whole(3, 6), 1.0),                 # out of reach
                            (2, 0.0, 3, TINY), (2, 0.0, 3, 1e6)):             # of next to nothing, and of 1000 km
        x, target = size * np.cumsum(draw(0.3, 1.0, (n + 1, d)), axis=0), size * (far + draw(-3.0, 3.0, d))
        lengths = size * lengths_of(draw, n)                                  # not what they are before the sweep
        expected = there_and_back(x, target, lengths)
        close("positions after a sweep [m]", lesson.fabrik_sweep(x, target, lengths), expected, size * ROUND_OFF,
              given=f"joints at {x} m, target {target} m, lengths {lengths} m")
    x, lengths = draw(0.3, 1.0, (4, 2)) + np.arange(4.0)[:, None], np.array([3.0, 0.5, 0.5])
    for parts, target in ((4, x[3]), (4, x[0]), (4, x[0] + 0.1), (2, x[3])):  # the end, the base, too near; one link
        got = lesson.fabrik_sweep(x[:parts].copy(), target.copy(), lengths[:parts - 1])
        close("positions after a sweep to a special target [m]", got,
              there_and_back(x[:parts], target, lengths[:parts - 1]), ROUND_OFF,
              given=f"joints at {x[:parts]} m, target {target} m, lengths {lengths[:parts - 1]} m")
    close("base and end of a single link after a sweep to a target at the base [m]",
          lesson.fabrik_sweep(x[:2].copy(), x[0].copy(), lengths[:1]), (x[0], x[0] + (lengths[0], 0.0)), ROUND_OFF,
          given=f"base at {x[0]} m, length {lengths[0]} m")
    size, half = draw(0.5, 2.0), np.sqrt(0.5)                                 # for a target at a joint two points
    last = np.array([-half, 1.0 - half]) / np.hypot(half, 1.0 - half)         # coincide: point_at goes along axis 0
    for way, expected in (((1.0, 0.0), ((0.0, 0.0), (1.0, 0.0), (2.0, 0.0))),
                          ((0.0, 1.0), ((0.0, 0.0), (half, half), (half + last[0], half + last[1])))):
        for d in (2, 3):
            x, there = (np.pad(size * np.array(one), ((0, 0), (0, d - 2)))
                        for one in (np.outer((0.0, 1.0, 2.0), way), expected))
            close("positions after a sweep to a target at a joint [m]",
                  lesson.fabrik_sweep(x, x[1].copy(), np.array([size, size])), there, ROUND_OFF,
                  given=f"joints at {x} m, target {x[1]} m")


@exercise("11.14", points=0.5, hint="every link has its length after the sweep, and the base is where it was")
def test_sweeps_reach_a_target_and_keep_all_lengths(lesson, draw):
    n = draw.whole(3, 5)
    lengths, theta = draw(0.8, 1.2, n), np.append(draw(-1.0, 1.0), draw(0.5, 0.8, n - 1))
    x, base = joints(theta, lengths), draw(-1.0, 1.0, 2)
    goal, x = np.arctan2(x[-1, 1], x[-1, 0]) + draw(-0.8, 0.8), x + base
    target = base + 0.7 * lengths.sum() * np.array([np.cos(goal), np.sin(goal)])
    for _ in range(100):
        x = np.asarray(lesson.fabrik_sweep(x, target, lengths))
        close("lengths of the links [m]", np.linalg.norm(np.diff(x, axis=0), axis=1), lengths, ROUND_OFF)
        close("base [m]", x[0], base, 0.0)
    close("end of the arm after 100 sweeps [m]", x[-1], target, 1e-6, given=f"target {target} m, lengths {lengths} m")


# ---------------------------------------------------------------------------------------------- limits and redundancy

def hold_a_joint_that_nothing_pushes(lesson, draw):
    """The step of 11.15 with a joint at its limit where (Jᵀ e)_1 is 0."""
    size, far = 2.0 ** draw.whole(-1, 1), draw(0.5, 3.0)                      # θ = 0 and whole numbers: (Jᵀ e)_1 is 0
    for side in (1.0, -1.0):
        lengths, theta, e = np.full(3, size), np.zeros(3), side * size * np.array([0.0, far, 0.0, -2.0, 0.0, 1.0])
        free = damped(slopes_of(theta, lengths, 3), e, size)
        low, high = np.where(free > 0.0, (-9.0, 0.0, -9.0), -9.0), np.where(free > 0.0, 9.0, (9.0, 0.0, 9.0))
        arm, target = arm_of(lesson, lengths, damping=size, low=low, high=high), e + points_of(theta, lengths, 3)
        close("θ after a step, with a joint at its limit that Jᵀ e does not push [rad]",
              lesson.limited_step(three_points, theta, target, arm), free, SOLVED, given=f"limits {low} to {high}")


def step_of_special_tasks(lesson, draw):
    """The step of 11.15 for special linear tasks, from θ = 0, which is inside, beyond or at limits, or at their only
    place.
    """
    damping, near = draw(0.5, 1.0), draw(0.2, 0.5)
    limits = np.array([(-np.inf, np.inf), (near, 2.0 * near), (-near, -near), (-2.0 * near, -near), (-near, 0.0),
                       (0.0, np.inf), (near, near)])
    for (e, J, target), first in itertools.product(special_equations(draw), range(len(limits))):
        n, wish = J.shape[1], e @ J
        low, high = limits[(np.arange(n) + first) % len(limits)].T.copy()
        got = lesson.limited_step(linear, np.zeros(n), target,
                                  arm_of(lesson, np.ones(n), damping=damping, low=low, high=high))
        blocked = ((low >= 0.0) & (wish < 0.0)) | ((high <= 0.0) & (wish > 0.0))
        close("change of θ for a special linear task [-]", got,
              np.clip(damped(np.where(blocked, 0.0, J), e, damping), low, high), SOLVED,
              given=f"θ = 0, e = {e}, J = {J}, λ = {damping}, limits {low} to {high}")


@exercise("11.15", points=0.5, hint="a joint inside its limits, or at one but pushed inwards, moves as in damped_step")
def test_limits_that_stop_nothing_change_nothing(lesson, draw):
    for task, count in TASKS:
        n = draw.whole(3, 6)
        lengths, theta, damping = lengths_of(draw, n), turned(draw, n), draw(0.5, 1.0)
        target = draw(-2.0, 2.0, 2 * count)
        J, e = slopes_of(theta, lengths, count), target - points_of(theta, lengths, count)
        wish, free = e @ J, damped(J, e, damping)
        far, up, down = np.full(n, 50.0), (wish > 0.0) & (free > 0.0), (wish < 0.0) & (free < 0.0)
        for low, high in ((-far, far), (np.where(up, theta, -far), np.where(down, theta, far)),
                          (np.where(up, theta + 0.5 * free, -far), np.where(down, theta + 0.5 * free, far))):
            arm = arm_of(lesson, lengths, damping=damping, low=low, high=high)
            got = lesson.limited_step(task, theta, target, arm)
            close("θ after a step [rad]", got, theta + free, SOLVED, given=f"θ = {theta}, limits {low} to {high}")
    for far in FAR:
        lengths, theta, target, e, J = posed(draw, 4, far)
        got = lesson.limited_step(pose, theta, target, arm_of(lesson, lengths, damping=0.7))
        close("θ after a step towards a place and a direction [rad]", got, theta + damped(J, e, 0.7), 0.01 * SOLVED,
              given=f"θ = {theta}, target {target}, λ = 0.7 m")
    for rows, size in EQUATIONS:
        (e, J, target), damping = equations(draw, rows, size), draw(0.5, 1.0)
        wish, first = e @ J, np.arange(5) == 0                                # only the first joint is at a limit
        arm = arm_of(lesson, np.ones(5), damping=damping, low=np.where(first & (wish < 0.0), 0.0, -np.inf),
                     high=np.where(first & (wish > 0.0), 0.0, np.inf))
        got = lesson.limited_step(linear, np.zeros(5), target, arm)
        close("change of θ for a linear task, over the size of e [-]", np.asarray(got) / size,
              damped(np.where(first, 0.0, J), e, damping), SOLVED,
              given=f"θ = 0, e = {size * e}, J = {J}, λ = {damping}, {rows} rows, limits {arm.low} to {arm.high}")
    hold_a_joint_that_nothing_pushes(lesson, draw)
    step_of_special_tasks(lesson, draw)
    J, kept = draw(-1.0, 1.0, (2, 5)), np.zeros((2, 5))
    kept[:] = J                                                               # a task may return an array of its own
    lesson.limited_step(lambda theta, target, arm: (target, J), np.zeros(5), draw(-1.0, 1.0, 2),
                        arm_of(lesson, np.ones(5), damping=1.0, low=np.zeros(5), high=np.zeros(5)))
    close("the J that the task returned, after a step", J, kept, 0.0)


def step_of_stiff_arms(lesson, draw, size):
    """The step of 11.15 on a tiny arm, or one of 1000 km, with joints that have no room, or are beyond it."""
    lengths, theta, e = size * lengths_of(draw, 4), turned(draw, 4), size * draw(-2.0, 2.0, 2)
    J, target = slopes(theta, lengths), e + points_of(theta, lengths)
    wish, stiff = e @ J, np.array([True, False, True, False])                 # these joints have no room at all
    low, high = np.where(stiff, theta, -np.inf), np.where(stiff, theta, np.inf)
    out = np.arange(4) == 3                                                   # and this one is at one of its limits
    low, high = np.where(out & (wish < 0.0), theta, low), np.where(out & (wish > 0.0), theta, high)
    for blocked, above in ((stiff | out, 0.0), (np.full(4, True), 0.1)):
        if above:                                                             # all are beyond one of their limits
            low, high = np.where(wish < 0.0, theta + above, -np.inf), np.where(wish > 0.0, theta - above, np.inf)
        free = theta + damped(np.where(blocked, 0.0, J), e, 0.5 * size)
        close("θ after a step of an arm with stiff joints [rad]",
              lesson.limited_step(reach, theta, target, arm_of(lesson, lengths, 0.1, 0.5 * size, low, high)),
              np.clip(free, low, high), SOLVED, given=f"θ = {theta}, limits {low} to {high}, target {target} m")


@exercise("11.15", points=0.25,
          hint="zeros in the columns of blocked joints, in all rows, so that the others take over; clip at the end")
def test_blocked_joints_leave_their_work_to_the_others(lesson, draw):
    for (task, count), exactly in zip(6 * TASKS, 4 * [False] + 8 * [True], strict=True):
        n = draw.whole(4, 6)
        lengths, theta, damping = lengths_of(draw, n), turned(draw, n), draw(0.5, 1.0)
        blocked, J, wish = np.arange(n) % 2 == draw.whole(0, 1), slopes_of(theta, lengths, count), np.zeros(n)
        while not (np.any(wish[blocked] > 0.0) and np.any(wish[blocked] < 0.0)):     # both limits stop a joint
            target = draw(-2.0, 2.0, 2 * count)
            e = target - points_of(theta, lengths, count)
            wish = e @ J
        low, high = np.full(n, -np.inf), np.full(n, np.inf)                   # most joints have one limit, or none
        beyond = 0.0 if exactly else draw(0.0, 0.2)                           # a joint may begin outside its limits
        high[blocked & (wish > 0.0)] = theta[blocked & (wish > 0.0)] - beyond
        low[blocked & (wish < 0.0)] = theta[blocked & (wish < 0.0)] + beyond
        free = theta + damped(np.where(blocked, 0.0, J), e, damping)
        k = int(np.argmax(np.abs(free - theta)))                              # one that is stopped on its way
        if free[k] > theta[k]:
            high[k] = 0.5 * (free[k] + theta[k])
        else:
            low[k] = 0.5 * (free[k] + theta[k])
        near = int(np.argmin(np.where(blocked | (np.arange(n) == k), np.inf, np.arange(n))))
        if wish[near] > 0.0:                                                  # one that is almost at its limit
            high[near] = theta[near] + 1e-13
        else:
            low[near] = theta[near] - 1e-13
        arm = arm_of(lesson, lengths, damping=damping, low=low, high=high)
        close("θ after a step [rad]", lesson.limited_step(task, theta, target, arm), np.clip(free, low, high), SOLVED,
              given=f"θ = {theta}, limits {low} to {high}, target {target} m")
    for size in (TINY, 1e6):
        step_of_stiff_arms(lesson, draw, size)


@exercise("11.15", points=0.25,
          hint="block only joints that Jᵀ e pushes outwards; a joint that it pulls back must be free")
def test_it_comes_to_rest_where_no_joint_alone_can_come_nearer(lesson, draw):
    for _ in range(3):
        lengths, target = lengths_of(draw, 3), draw(-1.5, 1.5, 2)
        arm = arm_of(lesson, lengths, damping=1.5, low=draw(-0.6, -0.1, 3), high=draw(0.1, 0.6, 3))
        theta = np.array([arm.low[0], arm.high[1], arm.low[2]])
        for _ in range(600):
            theta = np.asarray(lesson.limited_step(reach, theta, target, arm))
        wish = (target - joints(theta, lengths)[-1]) @ slopes(theta, lengths)
        close("way to where each joint alone would go, between its limits [rad]",
              np.clip(theta + 0.1 * wish, arm.low, arm.high), theta, 1e-4,
              given=f"target {target} m, limits {arm.low} to {arm.high}")


def hold_straight_arms(lesson, draw, rest, pull):
    """The step of 11.16 on arms that are straight, hardly bent and nearly straight."""
    for n, bend in ((2, 1e-13), (4, 1e-13), (2, 1.5e-11), (4, 1.5e-11)):      # σ₂ is below SINGULAR σ₁
        lengths, theta = lengths_of(draw, n), np.append(draw(-3.0, 3.0), bend * draw(1.0, 2.0, n - 1))
        e, z = draw(-0.5, 0.5, 2), pull * (rest[:n] - theta)
        sideways, r = np.array([-np.sin(theta[0]), np.cos(theta[0])]), np.cumsum(lengths[::-1])[::-1]
        arm = arm_of(lesson, lengths, rest=rest[:n], pull=pull, **NARROW)
        got = lesson.null_space_step(reach, theta, joints(theta, lengths)[-1] + e, arm)
        close("change of θ of an arm that is straight [rad]", np.asarray(got) - theta,
              z + r * (sideways @ e - r @ z) / (r @ r), 1e-9, given=f"θ = {theta}, rest {rest[:n]}, e = {e} m")
    theta = np.append(draw(-3.0, 3.0), draw(1e-4, 2e-4, 3))              # a little bent
    e, J, z = draw(-0.5, 0.5, 2), slopes(theta, lengths), pull * (rest[:4] - theta)
    got = lesson.null_space_step(reach, theta, joints(theta, lengths)[-1] + e,
                                 arm_of(lesson, lengths, rest=rest[:4], pull=pull))
    close("change of θ of an arm that is hardly bent, times its smallest angle [rad²]",
          1e-4 * (np.asarray(got) - theta), 1e-4 * (z + np.linalg.lstsq(J, e - J @ z, rcond=1e-10)[0]), 1e-8,
          given=f"θ = {theta}, rest {rest[:4]}, e = {e} m")
    theta = np.array([draw(-3.0, 3.0), draw(1e-8, 2e-8)])                # nearly straight: σ₂ is above SINGULAR σ₁
    e, J, arm = draw(0.2, 0.5, 2), slopes(theta, lengths[:2]), arm_of(lesson, lengths[:2], rest=rest[:2], pull=pull)
    change = np.asarray(lesson.null_space_step(reach, theta, joints(theta, lengths[:2])[-1] + e, arm)) - theta
    close("J Δθ of an arm that is nearly straight [m]", J @ change, e, 1e-5, given=f"θ = {theta}, e = {e} m")


@exercise("11.16", points=0.5, hint="z + J⁺ (e − J z) is the same: it cancels the motion of the end due to z")
def test_the_pull_to_rest_does_not_move_the_end(lesson, draw):
    for task, count in TASKS:
        n, pull = draw.whole(7, 8), draw(0.2, 1.0)
        lengths, theta, rest = lengths_of(draw, n), turned(draw, n), draw(-5.0, 5.0, n)
        J, here = slopes_of(theta, lengths, count), points_of(theta, lengths, count)
        arm, z = arm_of(lesson, lengths, rest=rest, pull=pull, **NARROW), pull * (rest - theta)
        for e in (np.zeros(2 * count), draw(-0.5, 0.5, 2 * count), draw(20.0, 30.0, 2 * count)):
            change = np.asarray(lesson.null_space_step(task, theta, here + e, arm)) - theta
            close("Jᵀ (J Δθ − e), zero where |J Δθ − e| is smallest [m²]", J.T @ (J @ change - e), np.zeros(n), 1e-9,
                  given=f"e = {e} m")
            shortest = np.linalg.lstsq(J, e - J @ z, rcond=1e-10)[0]          # from z to the nearest such Δθ
            close("change of θ [rad]", change, z + shortest, 1e-9, given=f"θ = {theta}, rest {rest}, κ = {pull}")
    for far, much in zip((*FAR, 1.0, 1.0), (pull, draw(1.2, 2.0), 0.0, 1e-3), strict=True):
        lengths, theta, target, e, J = posed(draw, 5, far)
        arm, z = arm_of(lesson, lengths, rest=rest[:5], pull=much, **around(theta)), much * (rest[:5] - theta)
        got = np.asarray(lesson.null_space_step(pose, theta, target, arm)) - theta
        close("change of θ towards a place and a direction [rad]", got,
              z + np.linalg.lstsq(J, e - J @ z, rcond=1e-10)[0], SOLVED,
              given=f"θ = {theta}, rest {rest[:5]}, κ = {much}")
    for rows, size in EQUATIONS:                                             # what rest is away has the size of e
        (e, J, target), z = equations(draw, rows, size, 9), draw(0.3, 1.0, 9)
        got = lesson.null_space_step(linear, np.zeros(9), target, arm_of(lesson, np.ones(9), rest=size * z / pull,
                                                                         pull=pull, **NARROW))
        close("change of θ for a linear task, over the size of e [-]", np.asarray(got) / size,
              z + np.linalg.lstsq(J, e - J @ z, rcond=1e-10)[0], 1e-9,
              given=f"θ = 0, e = {size * e}, J = {J}, {rows} rows, κ (rest − θ) = {size * z}")
    for e, J, target in special_equations(draw):
        n = J.shape[1]
        away = np.where(np.arange(n) == 1, 0.0, rest[:n])                # the second joint is at rest
        z, arm = pull * away, arm_of(lesson, np.ones(n), rest=away, pull=pull, low=0.0, high=0.0)
        close("change of θ for a special linear task [-]", lesson.null_space_step(linear, np.zeros(n), target, arm),
              z + np.linalg.lstsq(J, e - J @ z, rcond=1e-10)[0], 1e-9,
              given=f"θ = 0, e = {e}, J = {J}, κ (rest − θ) = {z}")
    pull_to_special_angles(lesson, draw, pull)
    hold_straight_arms(lesson, draw, rest, pull)


def pull_to_special_angles(lesson, draw, pull):
    """The step of 11.16 where angles of rest are 0, or add up to 0, or where the ways there add up to 0."""
    some = draw(0.5, 2.0)
    for signs in ((0, 0, 0, 0, 0), (1, 0, 0, 0, 0), (1, -1, 0, 0, 0), (0, 1, 1, 1, 0), (-1, -1, -1, -1, -1)):
        rest, theta = some * np.array(signs), turned(draw, 5)
        (e, J, target), z = equations(draw, 2, 1.0), pull * (rest - theta)
        target[:, 0] += J @ theta
        got = lesson.null_space_step(linear, theta, target, arm_of(lesson, np.ones(5), rest=rest, pull=pull))
        close("change of θ towards angles of rest of which some are 0 [rad]", np.asarray(got) - theta,
              z + np.linalg.lstsq(J, e - J @ z, rcond=1e-10)[0], SOLVED, given=f"θ = {theta}, rest {rest}")
        got = lesson.null_space_step(linear, 0.0 * theta, np.column_stack((e, J)),
                                     arm_of(lesson, np.ones(5), rest=rest, pull=pull))
        close("change of angles that are 0 towards such angles [rad]", got,
              pull * rest + np.linalg.lstsq(J, e - J @ (pull * rest), rcond=1e-10)[0], SOLVED, given=f"rest {rest}")


@exercise("11.16", points=0.5, hint="among all angles that reach the target, the arm comes to rest near arm.rest")
def test_it_ends_on_the_target_as_near_to_rest_as_it_can(lesson, draw):
    lengths, theta = draw(0.8, 1.2, 4), np.append(draw(-1.0, 1.0), draw(0.4, 0.8, 3))
    target, rest = joints(theta, lengths)[-1], theta + draw(-0.15, 0.15, 4)
    arm = arm_of(lesson, lengths, rest=rest, pull=0.5, **NARROW)
    for _ in range(200):
        theta = np.asarray(lesson.null_space_step(reach, theta, target, arm))
    J = slopes(theta, lengths)
    close("end of the arm [m]", joints(theta, lengths)[-1], target, 1e-9, given=f"target {target} m, rest {rest}")
    along = (rest - theta) - np.linalg.lstsq(J, J @ (rest - theta), rcond=None)[0]
    close("part of the way to rest that the end would allow [rad]", along, np.zeros(4), 1e-6, given=f"rest {rest}")


# ---------------------------------------------------------------------------------------------- why?

def settled(lengths, target, damping, theta, iterations=3000):
    """The distance [m] that damped steps leave, with a Jacobian by hand."""
    for _ in range(iterations):
        phi = np.cumsum(theta)
        ends = np.cumsum(np.stack((lengths * np.cos(phi), lengths * np.sin(phi))), axis=1)
        r = ends[:, -1:] - ends + np.stack((lengths * np.cos(phi), lengths * np.sin(phi)))
        J, e = np.stack((-r[1], r[0])), target - ends[:, -1]
        theta = theta + J.T @ np.linalg.solve(J @ J.T + damping**2 * np.eye(2), e)
    return np.sqrt(e @ e)


def ring(lengths):
    """The least and the largest distance [m] of the end from the base, link after link."""
    least = most = 0.0
    for length in lengths:
        least, most = max(least - length, length - most, 0.0), most + length
    return least, most


def arms_of_all_sizes(draw):
    """Lengths of one to eight links: all alike, or one of them the longest, or from 1 m to 0.1 mm, or of any size."""
    for n, k in ((1, 0), (2, 1), (3, 1), (4, 3), (8, 3)):
        for long in (1.0, n - draw(0.5, 0.9)):
            yield draw(0.5, 2.0) * np.where(np.arange(n) == k, long, 1.0)
    for n, size in itertools.product((2, 3, 5, 8), (TINY, 1.0, 1e3)):
        lengths = size * 10.0 ** draw(-4.0, 0.0, n)
        lengths[draw.whole(0, n - 1)] = 2.0 * size
        yield lengths


@exercise("11.17", points=1, hint="a damped step does not move the arm if Jᵀ e = 0: which place of its reach is that?")
def test_damped_steps_leave_the_predicted_distance(lesson, draw):
    l_1, l_2, l_3 = draw(1.2, 1.4), draw(0.3, 0.5), draw(0.2, 0.4)
    longest_first, longest_last = np.array([l_1, l_2, l_3]), np.array([l_2, l_3, l_1])
    reach, hole, turn = l_1 + l_2 + l_3, l_1 - l_2 - l_3, draw(0.0, 6.0)
    # An arm without a hole reaches every place near its base.
    even, four = draw(0.8, 1.2, 3), draw(0.5, 0.8, 4)
    cases = [(longest_first, away) for away in (draw(1.2, 2.0) * reach, draw(0.5, 0.8) * reach, draw(0.2, 0.7) * hole)]
    cases += [(longest_last, draw(1.2, 1.5) * hole), (longest_last, draw(0.2, 0.7) * hole),
              (even, draw(0.05, 0.2)), (four, draw(0.1, 0.3)), (four, draw(1.2, 2.0) * np.sum(four))]
    for lengths, away in cases:
        damping, target = draw(0.7, 1.2) * reach, away * np.array([np.cos(turn), np.sin(turn)])
        left = settled(lengths, target, damping, np.append(turn + 0.4, np.linspace(0.5, 0.6, len(lengths) - 1)))
        # 3000 iterations are enough for six digits: the slowest error shrinks by a hundredth per iteration
        close("distance that is left [m]", lesson.remaining_distance(lengths, target, damping), left, 1e-6 * reach,
              given=f"lengths {lengths}, {away} m away, λ = {damping}")
    ways = itertools.cycle(((np.cos(turn), np.sin(turn)), (1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0)))
    for lengths in arms_of_all_sizes(draw):
        least, most = ring(lengths)
        for away in np.maximum((0.0, least - 0.03 * most, (1.0 - 1e-6) * least, least + 0.03 * most,
                                (1.0 + 1e-6) * most, draw(20.0, 30.0) * most), 0.0):
            target, damping = away * np.array(next(ways)), 10.0 ** draw(0.0, 3.0) * most      # which changes nothing
            close("distance that is left [m]", lesson.remaining_distance(lengths, target, damping),
                  max(least - away, away - most, 0.0), ROUND_OFF * max(most, away),
                  given=f"lengths {lengths}, target {target} m, λ = {damping}")


@exercise("11.18", points=1,
          hint="the pseudo-inverse is Newton's method: the next error is a multiple of the square of the last")
def test_the_chosen_error_is_squared_by_every_iteration(lesson):
    choice("the letter of the pseudo-inverse", lesson.newton_is(), choices.where(
        "kinematics", "errors_of_four_ways", lambda k, error: np.all(error[1:5] < error[:4] ** 2)))


def followed(lengths, path):
    """(places of the hand [m], angles (pictures, n), σ₂ [m]) of an arm, four damped steps per picture."""
    reach, theta, seen = np.sum(lengths), np.full(len(lengths), 0.6), []

    def at(theta, target):
        phi = np.cumsum(theta)
        links = np.stack((lengths * np.cos(phi), lengths * np.sin(phi)))
        beyond = np.cumsum(links[:, ::-1], axis=1)[:, ::-1]
        return target - np.sum(links, axis=1), np.stack((-beyond[1], beyond[0]))

    for k, target in enumerate(path):
        for _ in range(4 if k else 104):                     # the hand goes to the first point before the film
            e, J = at(theta, target)
            theta = theta + J.T @ np.linalg.solve(J @ J.T + (0.1 * reach) ** 2 * np.eye(2), e)
        e, J = at(theta, target)
        seen.append((target - e, theta, np.linalg.svd(J, compute_uv=False)[1]))
    hands, thetas, thin = zip(*seen, strict=True)
    return np.array(hands), np.array(thetas), np.array(thin)


def between_rows(at, times, rows):
    """Points (m, 2) at other times, on straight lines between rows (k, 2) at these times."""
    return np.stack([np.interp(at, times, column) for column in rows.T], axis=1)


@exercise("11.19", points=1,
          hint="write within the reach, but not at its rim; as wide and as long as the docstring says; and slowly "
               "enough")
def test_an_arm_writes_what_it_is_told_slowly_and_is_never_straight(lesson):
    lengths, points, seconds = lesson.my_writing()
    lengths, points = np.array(lengths, dtype=float), np.array(points, dtype=float)
    between("number of links", lengths.size, 2, 6)
    numbers("the lengths [m]", lengths, (lengths.size,))
    numbers("the points [m]", points, (len(points), 2))
    between("shortest link, over the reach", np.min(lengths) / np.sum(lengths), 0.01, 1.0)
    between("time of the film [s]", seconds, 2.0, 20.0)
    reach, along = np.sum(lengths), np.linspace(0.0, len(points) - 1.0, round(25 * seconds))
    path = between_rows(along, np.arange(len(points)), points)
    drawn = np.sum(np.linalg.norm(np.diff(path, axis=0), axis=1))
    between("length of the path, over the reach", drawn / reach, 1.0, np.inf)
    aside = path - np.mean(path, axis=0)
    across = np.ptp(aside @ np.linalg.svd(aside, full_matrices=False)[2][1])
    between("width of the drawing, over the reach", across / reach, 0.05, np.inf)
    hands, thetas, thin = followed(lengths, path)
    for when, off in (("in a picture", hands - path),                    # the way is straight between these times
                      ("at the time of a point", between_rows(np.arange(len(points)), along, hands) - points)):
        between(f"distance of the hand from the path {when}, over the reach", np.max(np.hypot(*off.T)) / reach, 0.0,
                0.01)
    between("fastest joint [rad/s]", 25.0 * np.max(np.abs(np.diff(thetas, axis=0))), 0.0, 2.0)
    between("least σ₂, over the reach", np.min(thin) / reach, 0.05, np.inf)
