"""Lesson 2: forces are derivatives of an energy, internal forces sum to zero, and networks fall, hang and settle."""

import itertools

import numpy as np
import pytest

from solutions.checks import BadInput, Diverged
from validate.grading.expect import between, choice, close, raises
from validate.reference import choices
from validate.reference.choices.springs import MASS

from .zeros import nearly_zero

exercise = pytest.mark.exercise


def slope(f, y):
    """∂f/∂y by a complex step, f(y + ih) = f + ih f′, without cancellation. The axes of f come after those of y."""
    moves = np.eye(y.size).reshape((y.size, *y.shape))
    columns = np.array([f(y + 1e-30j * move).imag / 1e-30 for move in moves])
    return columns.reshape(y.shape + columns.shape[1:])


# ---------------------------------------------------------------------------------------------- single forces

@exercise("2.1", points=1, hint="x_b − x_a has the right direction but length r: divide it by r³")
def test_gravity_is_the_gradient_of_its_potential_and_gives_our_weight_on_earth(lesson, draw):
    earth, foot, m = np.zeros(3), np.array([0.0, 0.0, 6.371e6]), draw(50.0, 90.0)
    force = lesson.universal_gravity(foot, earth, m, 5.972e24, 6.67430e-11)
    close("weight at the Earth's surface [N]", force, [0.0, 0.0, -m * 9.8], 0.003 * m * 9.8, given=f"{m:.4g} kg")

    m_a, m_b, G = draw(2.0, 6.0), draw(2.0, 6.0), draw(1.0, 3.0)
    far = draw(1.0, 1.2)
    for a, way in ((np.zeros(1), np.array([far])), (np.zeros(2), np.array([0.0, far])),
                   (draw.sparse(-1.0, 1.0, 3), far * np.eye(3)[0]), *((np.zeros(d), far * np.sign(way))
                                                                      for d in (2, 3) for way in nearly_zero(draw, d)),
                   (draw(-1.0, 1.0, 3), draw(0.6, 1.2, 3))):
        b = a + way
        expected = -slope(lambda a, b=b: -G * m_a * m_b / np.sqrt(np.sum((b - a) ** 2)), a)
        # r > 1 m: round-off of forces below 110 N
        close("force on a: minus the gradient of −G m_a m_b/r [N]", lesson.universal_gravity(a, b, m_a, m_b, G),
              expected, 1e-12)
        close("force on b [N]: opposite", lesson.universal_gravity(b, a, m_b, m_a, G), -expected, 1e-12)
    for size in (1e-9, 1e9):                             # F r² is the same however near they are; a power would not be
        close("force times the squared distance, over that of 1 m [-]",
              np.asarray(lesson.universal_gravity(size * a, size * b, m_a, m_b, G)) * size**2, expected, 1e-6)
    raises("two bodies at the same position", BadInput, lesson.universal_gravity, a, a, m_a, m_b, G,
           thing="distance of two bodies")


@exercise("2.2", points=1, hint="the wind force minus k_v v; do not divide by k_v, which may be 0")
def test_air_pushes_resting_points_and_exerts_no_force_on_points_at_wind_speed(lesson, draw):
    wind, k_v, (speed, push) = draw(0.5, 3.0, 2) * [1.0, -1.0], draw(0.3, 0.8), draw(2.0, 5.0, 2)
    v = np.stack([0.0 * wind, wind / k_v, 2.0 * wind / k_v])
    given = f"F_wind = {wind} N, k_v = {k_v:.4g} N s/m"
    # round-off of numbers below 6
    close("force at v = 0, F_wind/k_v, 2F_wind/k_v [N]", lesson.air_force(v, wind, k_v),
          [wind, 0.0 * wind, -wind], 1e-14, given)
    close("force without wind [N]: against the motion", lesson.air_force(v, 0.0 * wind, k_v), -k_v * v, 1e-14, given)
    close("force on one coordinate [N]", lesson.air_force(speed, push, k_v), push - k_v * speed, 1e-14)
    close("force without viscosity [N]", lesson.air_force(speed, push, 0.0), push, 1e-14)
    close("force on one coordinate that moves back [N]", lesson.air_force(-speed, -push, k_v), k_v * speed - push,
          1e-14)
    for shape in ((2, 2), (3,), (1, 3)):
        for one, blows in itertools.product(nearly_zero(draw, int(np.prod(shape))), nearly_zero(draw, shape[-1])):
            expected = [push - k_v * part for part, push in zip(one, np.resize(blows, one.size), strict=True)]
            close("force on points, of which one moves [N]", lesson.air_force(one.reshape(shape), blows, k_v),
                  np.reshape(expected, shape), 1e-14, given=f"v = {one.reshape(shape)}, F_wind = {blows} N")
    for v in (np.zeros((2, 2)), draw.sparse(-3.0, 3.0, (1, 2)), draw.sparse(-3.0, 3.0, (7, 2))):
        for viscosity in (0.0, k_v, draw(3.0, 9.0)):
            drag = [[-viscosity * part for part in row] for row in v]
            close("force on each of the points, without the wind [N]", lesson.air_force(v, wind, viscosity) - wind,
                  drag, 1e-13, given)


@exercise("2.3", points=1, hint="length minus rest, not the other way round: a stretched spring has a positive tension")
def test_a_spring_carries_a_weight_and_a_damper_a_sinking_one(lesson, draw):
    rest, k, k_d = draw(0.5, 1.0), draw(30.0, 60.0), draw(3.0, 8.0)
    weight = draw(1.0, 3.0)
    given = f"rest = {rest:.4g} m, k = {k:.4g} N/m, k_d = {k_d:.4g} N s/m, mg = {weight:.4g} N"
    close("tension at rest [N]", lesson.spring_tension(rest, 0.0, rest, k, k_d), 0.0, 0.0, given)
    # round-off of k · length, below 70 N
    close("tension if longer by mg/k [N]", lesson.spring_tension(rest + weight / k, 0.0, rest, k, k_d),
          weight, 1e-13, given)
    close("tension if lengthening at mg/k_d [N]", lesson.spring_tension(rest, weight / k_d, rest, k, k_d),
          weight, 1e-13, given)
    close("tension if shorter by mg/k and shortening at 3 mg/k_d [N]",
          lesson.spring_tension(rest - weight / k, -3.0 * weight / k_d, rest, k, k_d), -4.0 * weight, 1e-13, given)
    for stiffness, damping, size in ((0.0, k_d, 0.0), (k, 0.0, 0.0), (0.0, k_d, rest), (k, 0.0, rest)):
        close("tension of a spring alone, or a damper alone, if longer by mg/k and lengthening at mg/k_d [N]",
              lesson.spring_tension(size + weight / k, weight / k_d, size, stiffness, damping), weight, 1e-13,
              given=f"rest = {size:.4g} m, k = {stiffness:.4g} N/m, k_d = {damping:.4g} N s/m, mg = {weight:.4g} N")
    for longer, faster in itertools.product((1.0, -1.0, 1e-9, 0.0), repeat=2):           # of either sign, or tiny
        extension, rate = longer * draw(2.0, 3.0), faster * draw(2.0, 3.0)
        close("tension of a spring of 4 m, which may lengthen or shorten [N]",
              lesson.spring_tension(4.0 + extension, rate, 4.0, k, k_d), k * extension + k_d * rate, 1e-12,
              given=f"longer by {extension:.4g} m, lengthening at {rate:.4g} m/s")
    close("tension of a spring without length, rest = 4 m [N]", lesson.spring_tension(0.0, -1.0, 4.0, k, k_d),
          -4.0 * k - k_d, 1e-12)


@exercise("2.4", points=1, hint="the number −(k C + k_d Ċ) times the vector ∇C, which need not have length 1")
def test_a_soft_constraint_is_the_gradient_of_its_energy_and_damps_only_along_the_gradient(lesson, draw):
    k, k_d = draw(20.0, 40.0), draw(3.0, 6.0)
    x, gradient = draw(-0.5, 0.5, 3), draw(1.0, 2.0, 3)
    distance = draw(0.5, 1.5)
    given = f"∇C = {gradient}, k = {k:.4g} N/m, k_d = {k_d:.4g} N s/m"
    # round-off of forces below 400 N, and of a power below 900 W
    for side in (1.0, -1.0):                                             # the value of C [m]
        y = x + (side + distance - gradient @ x) / (gradient @ gradient) * gradient
        force = lesson.soft_constraint_force(gradient @ y - distance, 0.0, gradient, k, k_d)
        expected = -slope(lambda y: 0.5 * k * (gradient @ y - distance) ** 2, y)
        close("force towards a plane ∇C · x = const. [N]: minus the gradient of ½kC²", force, expected, 1e-11, given)

    across, along = gradient.copy(), np.cross(gradient, draw(-1.0, 1.0, 3))
    braked = lesson.soft_constraint_force(0.0, gradient @ across, gradient, k, k_d)
    power = -k_d * (gradient @ gradient) ** 2
    close("force on a point that crosses the plane at ∇C [N]: its power is −k_d Ċ²", braked @ across,
          power, 1e-11, given)
    back = lesson.soft_constraint_force(0.0, -(gradient @ across), gradient, k, k_d)
    close("force on a point that crosses the plane at −∇C [N]: reversed", back, -np.asarray(braked), 1e-12,
          given)
    close("damping force × ∇C [N]: parallel", np.cross(braked, gradient), np.zeros(3), 1e-12, given)
    slides = lesson.soft_constraint_force(0.0, gradient @ along, gradient, k, k_d)
    close("force on a point that slides along the plane [N]", slides, np.zeros(3), 1e-12, given)
    for C, C_rate in itertools.product((1.0, -1.0, 1e-6, -1e-6), (1.0, -1.0)):            # of either sign, and shallow
        C, C_rate = C * draw(0.5, 1.5), C_rate * draw(0.5, 1.5)
        close("force: −(k C + k_d Ċ) ∇C [N]", lesson.soft_constraint_force(C, C_rate, gradient, k, k_d),
              [-k * C * part - k_d * C_rate * part for part in gradient], 1e-12, given=f"C = {C:.4g}, Ċ = {C_rate:.4g}")
    close("force where C = 1e-6 m and Ċ = 0, over C [N/m]",
          np.asarray(lesson.soft_constraint_force(1e-6, 0.0, gradient, k, k_d)) * 1e6, -k * gradient, 1e-9)
    for n in (draw(1.0, 2.0, 1), *nearly_zero(draw, 2), *nearly_zero(draw, 3)):
        x, v = draw(-0.5, 0.5, (2, n.size))
        for k_1, k_2 in ((k, k_d), (0.0, k_d), (k, 0.0)):
            close("force: minus the gradients of ½kC² and ½k_dĊ² [N]",
                  lesson.soft_constraint_force(n @ x, n @ v, n, k_1, k_2),
                  -slope(lambda x, k=k_1, n=n: 0.5 * k * (n @ x) ** 2, x)
                  - slope(lambda v, k=k_2, n=n: 0.5 * k * (n @ v) ** 2, v), 1e-11,
                  given=f"∇C = {n}, k = {k_1:.4g} N/m, k_d = {k_2:.4g} N s/m")


@exercise("2.5", points=1,
          hint="first test C < 0; then limit the whole bracket −(k C + k_d Ċ) to zero or more")
def test_a_soft_contact_carries_a_weight_and_never_pulls(lesson, draw):
    k, k_d = draw(40.0, 60.0), draw(3.0, 6.0)
    deep, fast = draw(0.05, 0.15), draw(1.0, 3.0)
    slow = k * deep / k_d                                                # the damper cancels the spring
    given = f"C = ∓{deep:.4g} m, k = {k:.4g} N/m, k_d = {k_d:.4g} N s/m"
    for up in (draw(1.0, 2.0, 2) * [-1.0, 1.0], draw(1.0, 2.0, 1), *nearly_zero(draw, 2), *nearly_zero(draw, 3)):
        none = 0.0 * up
        force = lambda C, C_rate, up=up: lesson.soft_contact_force(C, C_rate, up, k, k_d)
        # round-off of forces below 60 N
        close("force on a point inside [N]", force(-deep, 0.0), k * deep * up, 1e-13, given)
        close("force on a point a micrometre inside [N]", force(-1e-6, 0.0), 1e-6 * k * up, 1e-13, given)
        close("force on a point a nanometre inside, times 1e9 [N]", np.asarray(force(-1e-9, 0.0)) * 1e9, k * up, 1e-9,
              given)
        close("force on a point a micrometre inside that sinks [N]", force(-1e-6, -fast),
              (1e-6 * k + k_d * fast) * up, 1e-13, given)
        close("force on a point that sinks [N]: larger", force(-deep, -fast), (k * deep + k_d * fast) * up, 1e-13,
              given)
        for share in draw.within():
            close("force on a point that leaves slower than −kC/k_d [N]: smaller", force(-deep, share * slow),
                  (1.0 - share) * k * deep * up, 1e-13, given)
        for share in draw.beyond(1.8):
            close("force on a point that leaves faster [N]: not negative", force(-deep, share * slow), none, 0.0, given)
        close("force exactly at the surface [N]", force(0.0, -fast), none, 0.0, given)
        close("force above the surface, sinking [N]", force(deep, -fast), none, 0.0, given)
        close("force of a spring alone, on a point that sinks: k_d = 0 [N]",
              lesson.soft_contact_force(-deep, -fast, up, k, 0.0), k * deep * up, 1e-13, given)
        close("force of a spring alone, on a point that leaves: k_d = 0 [N]",
              lesson.soft_contact_force(-deep, fast, up, k, 0.0), k * deep * up, 1e-13, given)
        close("force of a hard spring, k = 1e6 N/m [N]", lesson.soft_contact_force(-deep, -fast, up, 1e6, k_d),
              (1e6 * deep + k_d * fast) * up, 1e-9, given)
        close("force of a damper alone, on a point that sinks: k = 0 [N]",
              lesson.soft_contact_force(-deep, -fast, up, 0.0, k_d), k_d * fast * up, 1e-13, given)


def hinge(draw, theta):
    """Drawn a, b, c (3, 2), with arms of 1.0 to 1.5 m and the angle theta [rad] from arm a to arm c."""
    (arm_a, arm_c), turned = draw(1.0, 1.5, 2), draw(-np.pi, np.pi)
    a, c = (arm * np.array([np.cos(angle), np.sin(angle)]) for arm, angle in ((arm_a, turned), (arm_c, turned + theta)))
    return draw(-0.5, 0.5, 2) + np.stack([a, 0.0 * a, c])


def angular_energy(points, rest, k):
    """½k(θ − rest)² [J], with the smaller angle between θ and rest; tan ½θ = sin θ/(1 + cos θ)."""
    r_a, r_c = points[0] - points[1], points[2] - points[1]
    sine, cosine = r_a[0] * r_c[1] - r_a[1] * r_c[0], r_a @ r_c
    both = np.sqrt((r_a @ r_a) * (r_c @ r_c))
    turn = 2.0 * np.arctan(sine / (both + cosine)) - rest
    return 0.5 * k * (turn - 2.0 * np.pi * np.round(turn.real / (2.0 * np.pi))) ** 2


@exercise("2.6", points=1,
          hint="θ = arctan2(r_a × r_c, r_a · r_c); the force on each end is k(θ − rest)/|r|, perpendicular to its arm")
def test_an_angular_spring_is_the_gradient_of_its_energy_without_net_force_or_torque(lesson, draw):
    theta, k = draw(1.0, 2.5), draw(2.0, 4.0)
    for rest in (theta - draw(0.5, 1.5), theta + draw(1.5, 2.5)):
        points = hinge(draw, theta)
        given = f"θ = {theta:.4g}, rest = {rest:.4g}"
        force = np.array(lesson.angular_spring_forces(*points, rest, k))
        expected = -slope(lambda y, rest=rest: angular_energy(y, rest, k), points)
        # round-off of forces below 20 N, with lever arms below 2 m
        close("forces on a, b, c [N]", force, expected, 1e-12, given)
        close("their sum [N]", force.sum(axis=0), np.zeros(2), 1e-13, given)
        close("their torque [N m]", np.sum(points[:, 0] * force[:, 1] - points[:, 1] * force[:, 0]), 0.0, 1e-13, given)
    close("forces at rest [N]", np.array(lesson.angular_spring_forces(*hinge(draw, theta), theta, k)),
          np.zeros((3, 2)), 1e-13)
    for r_a, r_c in itertools.product(nearly_zero(draw, 2), repeat=2):
        if r_a @ r_c > -0.9 * np.sqrt((r_a @ r_a) * (r_c @ r_c)):        # the truth needs an angle that is not straight
            at, rest, stiff = draw(-0.5, 0.5, 2), draw(-1.0, 1.0), draw(0.2, 30.0)
            points = np.stack([at + r_a, at, at + r_c])
            close("forces on a, b, c with arms along axes and diagonals [N]",
                  np.array(lesson.angular_spring_forces(*points, rest, stiff)),
                  -slope(lambda y, rest=rest, k=stiff: angular_energy(y, rest, k), points), 1e-10,
                  given=f"arms {r_a} m and {r_c} m, rest = {rest:.4g}, k = {stiff:.4g} N m/rad")
    p, q = draw(1.0, 1.5, 2)
    for b, c in (((0.0, -p), (0.0, q - p)), ((p, 0.0), (p, q)), ((p, 0.0), (p - q, 0.0)), ((p, q), (0.0, 0.0))):
        for rest in (0.0, 1.0, -1.0):
            points = np.array([(0.0, 0.0), b, c])
            close("forces on a, b, c with arms along the axes, and a at the origin [N]",
                  np.array(lesson.angular_spring_forces(*points, rest, k)),
                  -slope(lambda y, rest=rest: angular_energy(y, rest, k), points), 1e-12, given=f"rest = {rest}")


@exercise("2.6", points=0.5, hint="θ − rest may be off by a full turn: arctan2(sin, cos) of it reduces it to (−π, π]")
def test_an_angular_spring_takes_the_short_way_round(lesson, draw):
    wide, narrow, k = draw(2.6, 2.9), draw(0.2, 1.0), draw(2.0, 4.0)
    turns = ((-wide, wide), (wide, -wide), (narrow, narrow + 6.0 * np.pi), (narrow, 2.0 * narrow - 2.0 * np.pi),
             (narrow, 2.0 * narrow + 22.0 * np.pi), (narrow, 2.0 * narrow - 22.0 * np.pi), (narrow, np.pi),
             (-narrow, np.pi), (narrow, -np.pi))
    for theta, rest in turns:
        points = hinge(draw, theta)
        given = f"θ = {theta:.4g}, rest = {rest:.4g}"
        force = np.array(lesson.angular_spring_forces(*points, rest, k))
        expected = -slope(lambda y, rest=rest: angular_energy(y, rest, k), points)
        # round-off of forces below 5 N, increased about 30 times by 1 + cos θ > 0.03
        close("forces on a, b, c [N]", force, expected, 1e-12, given)
    left, right = draw(0.5, 1.5, 2)                                      # θ − rest = π, which is in (−π, π]; −π is not
    points = np.array([[right, 0.0], [0.0, 0.0], [-left, 0.0]])
    upwards = np.array([np.pi * k / right, -np.pi * k / right - np.pi * k / left, np.pi * k / left])
    close("forces on a, b, c of a straight hinge with rest = 0 [N]",
          np.array(lesson.angular_spring_forces(*points, 0.0, k)), np.outer(upwards, (0.0, 1.0)), 1e-12)


@exercise("2.6", points=0.5,
          hint="if the squared length of either arm is 0.0, raise BadInput before dividing by it")
def test_an_angular_spring_refuses_an_arm_without_length(lesson, draw):
    rest, k = draw(2.2, 2.8), draw(2.0, 4.0)
    a, b, c = points = hinge(draw, draw(1.0, 2.0))
    force = np.array(lesson.angular_spring_forces(a, b, c, rest, k))
    close("forces if both arms have a length [N]", force, -slope(lambda y: angular_energy(y, rest, k), points), 1e-12)
    for what, arms in (("a = b", (b, b, c)), ("c = b", (a, b, b))):
        raises(what, BadInput, lesson.angular_spring_forces, *arms, draw(0.5, 1.5), draw(2.0, 4.0), naming=(0.0,),
               thing="the arm of an angular spring")
    rest, k = draw(0.5, 1.5), draw(2.0, 4.0)
    large, small = (np.array(lesson.angular_spring_forces(*(size * (y - b) for y in (a, b, c)), rest, k))
                    for size in (1.0, 1e-12))
    close("forces in trillions of newtons, if all arms are a trillion times shorter: the same", 1e-12 * small, large,
          1e-12)
    theta = draw(1.0, 2.0)
    points = hinge(draw, theta)
    for off in (1e-6, -1e-6):
        close("forces a millionth of a radian from rest, times 1e6 [N]",
              1e6 * np.array(lesson.angular_spring_forces(*points, theta + off, k)),
              -1e6 * slope(lambda y, rest=theta + off: angular_energy(y, rest, k), points), 1e-7)


# ---------------------------------------------------------------------------------------------- the system

def mesh_of(lesson, inv_mass, springs, gravity, wind=None, k_v=0.0):
    """A SpringNetwork from rows (i, j, rest, k, k_d), independent of the student's other exercises."""
    table = np.array(springs, dtype=float).reshape(-1, 5).T
    i, j = table[:2].astype(np.int64, order="C")
    rest, k, k_d = np.ascontiguousarray(table[2:])
    gravity = np.array(gravity, dtype=float)
    wind = np.zeros_like(gravity) if wind is None else np.array(wind, dtype=float)
    return lesson.SpringNetwork(np.array(inv_mass, dtype=float), gravity, wind, k_v, i, j, rest, k, k_d)


# No two x coordinates are closer than 0.7 m.
TETRAHEDRON = np.array([[0.0, 0.0, 0.0], [1.4, 0.1, 0.2], [-0.7, 0.9, -0.1], [0.7, 0.4, 1.0]])
EDGES = [(0, 1), (2, 0), (0, 3), (1, 2), (3, 1), (2, 3)]


def tetrahedron(lesson, draw, d, low=0.7, high=1.3):
    """Positions, velocities and network of four points, the second fixed, all joined, projected to d dimensions.

    The springs are 0.5 to 2.6 m long, with 10 to 60 N/m, 0.5 to 4 N s/m, and rest lengths of low to high times that.
    """
    x, v = TETRAHEDRON[:, :d] + draw(-0.1, 0.1, (4, d)), draw(-1.0, 1.0, (4, d))
    springs = np.column_stack([EDGES, np.zeros(6), draw(10.0, 60.0, 6), draw(0.5, 4.0, 6)])
    gravity, wind, k_v = draw(-10.0, 10.0, d), draw(-2.0, 2.0, d), draw(0.2, 0.5)
    network = mesh_of(lesson, draw(0.5, 3.0, 4) * [1.0, 0.0, 1.0, 1.0], springs, gravity, wind, k_v)
    return x, v, network._replace(rest=draw(low, high, 6) * lengths(x, network))


def staircases(lesson, draw, d):
    """x, v and networks of 1, 2, 3 and 7 points: a stair from the origin, each spring along an axis and stretched.

    Of the velocities and of the constants about half are 0; or all velocities are, or one of the constants.
    """
    found = []
    for n in (1, 2, 7, 3):
        steps = np.arange(n - 1)
        x = np.zeros((n, d))
        x[steps + 1, steps % d] = draw(1.6, 2.0, n - 1)
        x, v = np.cumsum(x, axis=0), draw.sparse(-1.0, 1.0, (n, d))
        rest, k, k_d = (draw.sparse(low, high, n - 1) for low, high in ((0.5, 1.5), (10.0, 60.0), (0.5, 4.0)))
        network = mesh_of(lesson, draw.sparse(0.5, 3.0, n), np.column_stack([steps, steps + 1, rest, k, k_d]),
                          draw.sparse(-10.0, 10.0, d), draw.sparse(-2.0, 2.0, d), draw(0.2, 0.5))
        all_move = network._replace(inv_mass=draw(0.5, 3.0, n), k=draw(10.0, 60.0, n - 1),
                                    gravity=draw(-10.0, 10.0, d), wind=draw(-2.0, 2.0, d))
        found += [(x, v, network), (x, 0.0 * v, all_move)]
    v, pull = draw(-1.0, 1.0, v.shape), all_move._replace(k_d=draw(0.5, 4.0, 2), rest=draw(0.5, 1.5, 2))
    return found + [(x, v, pull._replace(**{name: 0.0 * getattr(pull, name)}))
                    for name in ("inv_mass", "gravity", "wind", "k_v", "rest", "k", "k_d")]


def lengths(x, network):
    return np.sqrt(np.sum((x[network.j] - x[network.i]) ** 2, axis=1))


@exercise("2.7", points=0.25,
          hint="add T r/l at point i and −T r/l at j to the forces of the other springs; each spring has its own k")
def test_spring_forces_are_the_gradient_of_the_elastic_energy(lesson, draw):
    for d in (1, 2, 3):
        for x, v, network in (tetrahedron(lesson, draw, d), *staircases(lesson, draw, d)):
            energy = lambda x, network=network: 0.5 * np.sum(network.k * (lengths(x, network) - network.rest) ** 2)
            force = lesson.spring_forces(x, 0.0 * v, network)
            # round-off of k l < 160 N, three times
            close(f"forces of springs at rest in {d}D: minus the gradient of Σ ½k(l − rest)² [N]", force,
                  -slope(energy, x), 1e-12)


@exercise("2.7", points=0.5, hint="l̇ = r · (v_j − v_i)/l; k_d belongs to the same spring as the ends")
def test_dampers_are_the_gradient_of_the_dissipation_and_let_a_mesh_rotate_freely(lesson, draw):
    for d in (1, 2, 3):
        for x, v, network in (*staircases(lesson, draw, d), tetrahedron(lesson, draw, d)):
            at_rest = lesson.spring_forces(x, 0.0 * v, network)
            # ∂l/∂x = ∂l̇/∂v: [point, coordinate, spring]
            grow = slope(lambda x, network=network: lengths(x, network), x)
            brake = lesson.spring_forces(x, v, network) - at_rest
            # round-off of forces below 200 N
            expected = -grow @ (network.k_d * np.tensordot(v, grow))
            close(f"forces of dampers in {d}D: minus ∂/∂v of Σ ½k_d l̇² [N]", brake, expected, 1e-12)
        turn = np.triu(draw(-2.0, 2.0, (d, d)), 1)
        rigid = lesson.spring_forces(x, x @ (turn - turn.T) + draw(-2.0, 2.0, d), network)
        close(f"forces on a network that moves and rotates as a rigid body in {d}D [N]", rigid, at_rest, 1e-12)


@exercise("2.7", points=0.25, hint="subtract at j what you add at i, whether or not one of the points is fixed")
def test_springs_exert_no_net_force_and_no_net_torque(lesson, draw):
    for d in (1, 2, 3):
        x, v, network = tetrahedron(lesson, draw, d)
        at_rest, l = lesson.spring_forces(x, 0.0 * v, network), lengths(x, network)
        # If all positions double, the tensions T do the work −Σ T l. Round-off as below, of ten such terms.
        close(f"Σ F · x of springs at rest in {d}D [N m]", np.sum(at_rest * x),
              -np.sum(network.k * (l - network.rest) * l), 1e-11)
        force = lesson.spring_forces(x, v, network)
        # round-off of forces below 200 N, with lever arms of about 2 m
        close(f"sum of all forces in {d}D [N]", force.sum(axis=0), np.zeros(d), 1e-12)
        close(f"torque of all forces in {d}D [N m]", x.T @ force - force.T @ x, np.zeros((d, d)), 1e-12)


@exercise("2.7", points=0.25, hint="if the squared length is 0.0, raise BadInput before dividing by it")
def test_a_spring_without_length_is_refused(lesson, draw):
    x, v, network = tetrahedron(lesson, draw, 2)
    expected = -slope(lambda x: 0.5 * np.sum(network.k * (lengths(x, network) - network.rest) ** 2), x)
    close("forces if all springs have a length [N]", lesson.spring_forces(x, 0.0 * v, network), expected, 1e-12)
    large, small = (np.asarray(lesson.spring_forces(size * x, size * v, network._replace(rest=size * network.rest)))
                    for size in (1.0, 1e-9))
    # round-off of forces below 200 N
    close("forces in nanonewtons, if the network is a billion times smaller: the same", 1e9 * small, large, 1e-11)
    tiny = np.asarray(lesson.spring_forces(1e-13 * x, 1e-13 * v, network._replace(rest=1e-13 * network.rest)))
    close("forces in tenths of a piconewton, if it is 1e13 times smaller: the same", 1e13 * tiny, large, 1e-11)
    for s in (0, draw.whole(1, 4), 5):                                   # any spring, of any material
        y = x.copy()
        y[network.j[s]] = y[network.i[s]]
        alike, none = v.copy(), np.where(np.arange(6) == s, 0.0, 1.0)
        alike[network.j[s]] = alike[network.i[s]]
        for one in (network, network._replace(k=none * network.k), network._replace(rest=none * network.rest),
                    network._replace(inv_mass=0.0 * network.inv_mass)):
            for w in (v, alike):
                raises("a spring whose ends coincide", BadInput, lesson.spring_forces, y, w, one,
                       naming=(0.0,),
                       thing="the length of a spring")


@exercise("2.7", points=0.25, hint="each row of the table is a spring of its own; r and its rate have all coordinates")
def test_springs_in_any_direction_beside_each_other_and_in_long_chains_add_up(lesson, draw):
    for d in (2, 3):
        for r, u in itertools.product(nearly_zero(draw, d), repeat=2):
            x, v = np.stack([0.0 * r, r]), np.stack([0.0 * u, u])
            rest, k, k_d = draw(0.5, 1.5), draw(10.0, 60.0), draw(0.5, 4.0)
            # three rows for the same pair, one of them turned round
            network = mesh_of(lesson, [1.0, 1.0],
                              [(0, 1, rest, k, k_d), (1, 0, rest, k, 0.0), (0, 1, 2.0, 9.0, 0.0)], np.zeros(d))
            close(f"forces of three springs between two points in {d}D [N]", lesson.spring_forces(x, v, network),
                  swaying(0.0, x, v, network), 1e-12, given=f"r = {r} m, velocity {u} m/s")
    n = draw.whole(12, 20)
    steps = np.arange(n - 1)
    springs = np.column_stack([steps, steps + 1, draw(0.5, 1.5, n - 1), draw(10.0, 60.0, n - 1), draw(0.5, 4.0, n - 1)])
    network = mesh_of(lesson, np.ones(n), springs, np.zeros(2))
    x, v = np.cumsum(draw(0.5, 1.0, (n, 2)), axis=0), draw(-1.0, 1.0, (n, 2))
    close("forces of a long chain [N]", lesson.spring_forces(x, v, network), swaying(0.0, x, v, network), 1e-12,
          given=f"{n} points")


@exercise("2.8", points=0.5,
          hint="gravity is already an acceleration; divide the air force by the mass; a = 0 where inv_mass = 0")
def test_points_without_springs_fall_alike_drift_with_the_wind_and_stay_where_fixed(lesson, draw):
    g, x, v = draw(-10.0, 10.0, 2), draw(-1.0, 1.0, (4, 2)), draw(-3.0, 3.0, (4, 2))
    v[0] = 0.0
    free = [0, 1, 3]
    mass = draw(0.5, 4.0, (3, 1)) * [[0.1], [1.0], [20.0]]
    inv_mass, none = np.zeros(4), np.zeros((4, 2))
    inv_mass[free] = 1.0 / mass[:, 0]
    a = lesson.spring_network_acceleration(0.0, x, v, mesh_of(lesson, inv_mass, [], g))
    close("accelerations without air [m/s²]: g, and 0 where fixed", a, [g, g, [0.0, 0.0], g], 1e-13)

    wind, k_v = draw(-3.0, 3.0, 2), draw(0.3, 0.6)
    windy = mesh_of(lesson, inv_mass, [], g, wind, k_v)
    a = lesson.spring_network_acceleration(0.0, x, none, windy)
    # round-off of F_wind/m < 60 m/s², and of k_v v/m < 70 m/s²
    close("accelerations in the wind, from rest [m/s²]", a[free], g + wind / mass, 1e-13)
    v[free] = (mass * g + wind) / k_v
    a = lesson.spring_network_acceleration(0.0, x, v, windy)
    close("accelerations at v = (mg + F_wind)/k_v, and where fixed [m/s²]", a, none, 1e-13)


@exercise("2.8", points=0.5,
          hint="multiply each point's spring force by its own inv_mass: a light end accelerates more than a heavy one")
def test_a_mesh_obeys_newton_and_a_weight_hangs_still(lesson, draw):
    rest, k, k_d = draw(0.8, 1.2), draw(40.0, 60.0), draw(1.0, 3.0)
    (m_a, m_b), angle = draw(0.5, 2.0, 2), draw(-np.pi, np.pi)
    n = np.array([np.cos(angle), np.sin(angle)])
    stretch, fast = draw(0.1, 0.3), draw(1.0, 3.0)
    pair = mesh_of(lesson, [1.0 / m_a, 1.0 / m_b], [(0, 1, rest, k, k_d)], [0.0, 0.0])
    x = draw(-1.0, 1.0, 2) + np.stack([0.0 * n, (rest + stretch) * n])
    v = draw(-1.0, 1.0, 2) + np.stack([0.0 * n, fast * n])
    a = lesson.spring_network_acceleration(0.0, x, v, pair)
    pull = (k * stretch + k_d * fast) * n
    # round-off of k l/m < 180 m/s²
    close("accelerations of two points that move apart on a stretched spring [m/s²]", a, [pull / m_a, -pull / m_b],
          1e-12, given=f"{m_a:.4g} kg and {m_b:.4g} kg, pulled by {k * stretch + k_d * fast:.4g} N")

    g, wind = np.array([0.0, -draw(5.0, 10.0)]), draw(-2.0, 2.0, 2)
    pull = m_b * g + wind
    hanging = mesh_of(lesson, [0.0, 1.0 / m_b], [(1, 0, rest, k, k_d)], g, wind, draw(0.2, 0.4))
    x = np.stack([0.0 * pull, (rest / np.sqrt(pull @ pull) + 1.0 / k) * pull])
    a = lesson.spring_network_acceleration(0.0, x, np.zeros((2, 2)), hanging)
    close("accelerations of a weight at its equilibrium [m/s²]", a, np.zeros((2, 2)), 1e-12)
    for d in (1, 2, 3):
        for x, v, network in staircases(lesson, draw, d):
            # round-off of k l/m < 360 m/s², twice
            close(f"accelerations of {len(x)} points in {d}D [m/s²]",
                  lesson.spring_network_acceleration(draw(1.0, 9.0), x, v, network), swaying(0.0, x, v, network), 1e-12)
    heavy = mesh_of(lesson, draw(1e-9, 2e-9, 2), [], g, wind, 0.0)
    close("accelerations of points of a million tonnes [m/s²]: g",
          lesson.spring_network_acceleration(0.0, x[:2, :2], x[:2, :2], heavy), [g, g], 1e-7)


@exercise("2.9", points=1,
          hint="a step of lesson 1 does this: pass spring_network_acceleration to it, and the network as p")
def test_the_lectures_loop_is_exact_in_free_fall_and_settles_where_the_weight_hangs(lesson, draw):
    falls_freely(lesson, draw)
    m, k, k_d, k_v = draw(0.40, 0.50), draw(40.0, 60.0), draw(4.0, 6.0), draw(2.0, 2.2)
    weight = (m, k, k_d, k_v, draw(0.7, 0.9), draw(9.5, 10.0))
    dt = moves_on_a_spring(lesson, draw, *weight)
    comes_to_rest(lesson, draw, dt, *weight)
    for x, v, network in (*staircases(lesson, draw, 1), *staircases(lesson, draw, 2)):
        x_new, v_new = lesson.mass_spring_damper_step(0.0, x, v, dt, network)
        after = v + dt * swaying(0.0, x, v, network)
        # round-off of numbers below 20
        close(f"v of {len(x)} points after a step [m/s]", v_new, after, 1e-13)
        close(f"x of {len(x)} points after a step [m]", x_new, x + 0.5 * dt * (v + after), 1e-13)
    n, k = np.eye(2)[draw.whole(0, 1)], draw(40.0, 60.0)                 # two points whose accelerations add up to 0
    pair = mesh_of(lesson, [1.0, 1.0], [(0, 1, 1.0, k, 0.0)], [0.0, 0.0])
    x, v, out = draw(0.6, 0.9) * np.stack([-n, n]), np.zeros((2, 2)), np.stack([-n, n])
    for dt in (draw(1e-6, 1e-5), draw(0.3, 0.5)):
        a = -k * (2.0 * np.sqrt(x[1] @ x[1]) - 1.0) * out
        x_new, v_new = lesson.mass_spring_damper_step(0.0, x, v, dt, pair)
        close("gain of velocity of two points over dt [m/s²]", np.asarray(v_new) / dt, a, 1e-12,
              given=f"dt = {dt:.4g} s")
        close("x of two points after a step [m]", x_new, x + 0.5 * dt * dt * a, 1e-14, given=f"dt = {dt:.4g} s")


def falls_freely(lesson, draw):
    """Two points without a spring, one of them fixed: both move as they must."""
    steps = draw.whole(8, 12)
    dt = draw(0.08, 0.12)
    g = np.array([draw(-1.0, 1.0), -draw(5.0, 10.0)])
    v0 = draw(-3.0, 3.0, 2)
    falling = mesh_of(lesson, [draw(0.5, 2.0), 0.0], [], g)
    T = steps * dt
    drawn = draw(-1.0, 1.0, 2)                                           # velocity of the fixed point, which it keeps
    x, v = np.zeros((2, 2)), np.stack([v0, drawn])
    for n in range(steps):
        x, v = lesson.mass_spring_damper_step(n * dt, x, v, dt, falling)
    given = f"{steps} steps of {dt:.4g} s"
    # round-off of numbers below 18, in each of 12 steps
    close("x after a free fall [m]; the other point keeps its velocity", x, [T * v0 + 0.5 * T**2 * g, T * drawn], 1e-13,
          given)
    close("v after a free fall [m/s]", v, [v0 + T * g, drawn], 1e-13, given)


def moves_on_a_spring(lesson, draw, m, k, k_d, k_v, rest, g):
    """One step of a weight on a spring; return the step."""
    deep, fast, dt = draw(0.1, 0.3), draw(1.0, 3.0), draw(0.020, 0.024)
    on_a_spring = mesh_of(lesson, [0.0, 1.0 / m], [(0, 1, rest, k, k_d)], [0.0, -g], k_v=k_v)
    before = np.array([[0.0, 0.0], [0.0, -rest - deep]]), np.array([[0.0, 0.0], [0.0, -fast]])
    kept = np.array(before)
    x, v = lesson.mass_spring_damper_step(0.0, *before, dt, on_a_spring)
    v_new = -fast + dt * ((k * deep + k_d * fast + k_v * fast) / m - g)
    x_new = -rest - deep + 0.5 * dt * (v_new - fast)
    # round-off of numbers below 100
    close("v after one step on a spring [m/s]", v[1], [0.0, v_new], 1e-13)
    close("x after one step on a spring [m]: moved by dt times the mean velocity", x[1], [0.0, x_new], 1e-13)
    close("input x and v after the call: return new arrays", np.array(before), kept, 0.0)
    return dt


def comes_to_rest(lesson, draw, dt, m, k, k_d, k_v, rest, g):
    """The weight in the wind comes to rest in the direction of the pull."""
    wind = np.array([draw(-2.0, 2.0), draw(-0.5, 0.5)])
    pull = wind + np.array([0.0, -m * g])
    hanging = mesh_of(lesson, [0.0, 1.0 / m], [(0, 1, rest, k, k_d)], [0.0, -g], wind, k_v)
    steady = (rest / np.sqrt(pull @ pull) + 1.0 / k) * pull
    x, v = np.stack([np.zeros(2), steady + draw(0.01, 0.02, 2)]), np.zeros((2, 2))
    for n in range(200):
        x, v = lesson.mass_spring_damper_step(n * dt, x, v, dt, hanging)
    # The slowest motion is a pendulum, ω² > (g − 0.5/m)/(rest + 0.15) > 7.8/s², in air with γ = k_v/2m < 2.75/s < ω.
    # It decays with γ − ¼ω² dt > 1.89/s, in 4 s to exp(−7.5) = 6e-4 of 0.03 m · ω/√(ω² − γ²) < 0.045 m.
    close("position at which a weight in the wind comes to rest [m]", x[1], steady, 3e-5)
    close("position of the fixed point [m]", x[0], [0.0, 0.0], 0.0)


# ---------------------------------------------------------------------------------------------- building a network

@exercise("2.10", points=0.5,
          hint="loop over offsets, then rows, then columns; index r · cols + c; test r + dr and c + dc separately")
def test_a_small_grid_has_its_threads_in_order_and_a_single_node_none(lesson, draw):
    rows = draw.whole(2, 5)
    cols = rows + draw.whole(1, 3)
    node = np.arange(rows * cols).reshape(rows, cols)
    given = f"{rows} rows and {cols} columns"

    def joined(*ends):
        return np.concatenate([np.stack([a.ravel(), b.ravel()], axis=1) for a, b in ends])

    threads = joined((node[:, :-1], node[:, 1:]), (node[:-1], node[1:]))
    pairs = lesson.grid_pairs(rows, cols, lesson.STRUCTURAL)
    close("pairs along the threads", pairs, threads, 0.0, given)
    close("nodes that the pairs point at: pairs are integers", node.ravel()[pairs[:, 0]], threads[:, 0], 0.0, given)
    diagonals = joined((node[:-1, :-1], node[1:, 1:]), (node[:-1, 1:], node[1:, :-1]))
    close("pairs across the networks", lesson.grid_pairs(rows, cols, lesson.SHEAR), diagonals, 0.0, given)
    backwards = joined((node[:, 1:], node[:, :-1]), (node[1:], node[:-1]))
    close("pairs of the threads in reverse, offsets (0, −1) and (−1, 0)",
          lesson.grid_pairs(rows, cols, ((0, -1), (-1, 0))), backwards, 0.0, given)
    close("pairs of a single node", lesson.grid_pairs(1, 1, lesson.STRUCTURAL), np.zeros((0, 2)), 0.0)


@exercise("2.10", points=0.25, hint="there is no node beyond the edge: do not wrap around to the other side")
def test_a_large_grid_has_every_thread_diagonal_and_bend_once(lesson, draw):
    m, n = draw.whole(5, 7), draw.whole(8, 11)
    for rows, cols in ((m, n), (1, n), (m, 1), (2, n), (m, 2), (1, 2), (2, 1), (1, 1)):
        given = f"{rows} rows and {cols} columns"
        pairs = np.asarray(lesson.grid_pairs(rows, cols, lesson.STRUCTURAL + lesson.SHEAR + lesson.BEND))
        threads, diagonals = [rows * (cols - 1), (rows - 1) * cols], 2 * [(rows - 1) * (cols - 1)]
        counts = threads + diagonals + [rows * max(0, cols - 2), max(0, rows - 2) * cols]
        close("shape: one row for each pair", pairs.shape, [sum(counts), 2], 0.0, given)
        offsets = np.repeat([(0, 1), (1, 0), (1, 1), (1, -1), (0, 2), (2, 0)], counts, axis=0)
        nodes = np.stack([pairs // cols, pairs % cols], axis=2)          # [pair, end] → row, column
        close("rows and columns from node to partner", nodes[:, 1] - nodes[:, 0], offsets, 0.0, given)
        close("number of repeated pairs", len(pairs) - len({(i, j) for i, j in pairs.tolist()}), 0.0, 0.0, given)
        close("number of nodes outside the grid", np.sum((pairs < 0) | (pairs >= rows * cols)), 0.0, 0.0, given)


@pytest.mark.counts_calls                                            # compiled code takes no empty tuple
@exercise("2.10", points=0.25, hint="offsets may have either sign and any length, or be the same twice, or none at all")
def test_a_grid_has_the_pairs_of_any_offsets(lesson, draw):
    drawn = [(draw.whole(-3, 3), draw.whole(-3, 3)) for _ in range(4)]
    ours = ((1, 2), (-1, 1), (-1, -1), (-2, 1), (0, -2), (1, 2)), ((0, 3), (3, 0), (4, -4), (2, 0))
    for offsets in (*ours, drawn, ()):
        for rows, cols in ((draw.whole(3, 5), draw.whole(6, 8)), (draw.whole(12, 16), 3), (12, 14)):
            pairs = lesson.grid_pairs(rows, cols, tuple(offsets))
            there = [(dr, dc, r, c) for dr, dc in offsets for r, c in np.ndindex(rows, cols)
                     if r + dr in range(rows) and c + dc in range(cols)]
            expected = np.array([(cols * r + c, cols * (r + dr) + c + dc) for dr, dc, r, c in there]).reshape(-1, 2)
            close("pairs of these offsets", pairs, expected, 0.0, given=f"{rows} rows, {cols} columns, {offsets}")


# ---------------------------------------------------------------------------------------------- stiff networks

@exercise("2.11", points=1,
          hint="n nᵀ is the outer product of r/l with itself; 1 − n nᵀ is the part perpendicular to the spring")
def test_stiffness_of_stretched_springs_is_the_slope_of_their_forces(lesson, draw):
    ordinary = [tetrahedron(lesson, draw, d, low, high) for d, low, high in (
        (1, 0.5, 0.7), (2, 0.5, 0.7), (3, 0.5, 0.7), (3, 0.9, 0.99), (3, 0.01, 0.05))]
    pairs = [(np.stack([0.0 * r, r]), r, mesh_of(lesson, [1.0, 1.0], [(0, 1, draw(0.1, 0.4), draw(10.0, 60.0),
                                                                      draw(0.5, 4.0))], 0.0 * r))
             for d in (2, 3) for r in nearly_zero(draw, d)]
    x, v, network = ordinary[2]
    tiny = [(size * x, v, network._replace(rest=size * network.rest)) for size in (1e-9, 1e9)]
    for x, _, network in (*ordinary, *pairs, *tiny, *(one for d in (1, 2, 3) for one in staircases(lesson, draw, d))):
        d = x.shape[1]
        K, D = lesson.spring_stiffness(x, network)
        for s, (i, j) in enumerate(zip(network.i, network.j, strict=True)):
            r = x[j] - x[i]
            pull = lambda r, k=network.k[s], rest=network.rest[s]: k * (1.0 - rest / np.sqrt(np.sum(r * r))) * r
            # round-off of numbers below 60, and below 11
            close(f"K of spring {s} in {d}D: derivative of k(l − rest) r/l [N/m]", K[s], slope(pull, r), 1e-12)
            close(f"D of spring {s} in {d}D: k_d along the spring [N s/m]", D[s] @ r / np.sqrt(r @ r),
                  network.k_d[s] * r / np.sqrt(r @ r), 1e-13)
            close(f"trace of D of spring {s} in {d}D: nothing else [N s/m]", np.trace(D[s]), network.k_d[s], 1e-13)


@exercise("2.11", points=1, hint="max(0.0, 1 − rest/l) is zero for a compressed spring: only k n nᵀ remains")
def test_stiffness_of_a_compressed_spring_acts_along_it_only(lesson, draw):
    ordinary = [tetrahedron(lesson, draw, d, low, high) for d, low, high in (
        (2, 1.3, 1.6), (3, 1.3, 1.6), (3, 1.01, 1.1), (3, 1.0, 1.0))]
    stairs = [(x, v, network._replace(rest=draw(1.0, 1.5) * lengths(x, network), k=draw(10.0, 60.0, network.i.size)))
              for x, v, network in staircases(lesson, draw, 2)]
    pairs = [(np.stack([0.0 * r, r]), r, mesh_of(lesson, [1.0, 1.0], [(0, 1, draw(2.5, 3.0), draw(10.0, 60.0),
                                                                      draw(0.5, 4.0))], 0.0 * r))
             for d in (2, 3) for r in nearly_zero(draw, d)]
    for x, _, network in (*ordinary, *stairs, *pairs):
        d = x.shape[1]
        K, D = lesson.spring_stiffness(x, network)
        for s, (i, j) in enumerate(zip(network.i, network.j, strict=True)):
            r = x[j] - x[i]
            close(f"K along spring {s} in {d}D [N/m]", K[s] @ r, network.k[s] * r, 1e-12 * network.k[s])
            close(f"D of spring {s} in {d}D: k_d along it [N s/m]", D[s], network.k_d[s] * np.outer(r, r) / (r @ r),
                  1e-13)
            close(f"trace of K of spring {s} in {d}D: nothing perpendicular [N/m]", np.trace(K[s]),
                  network.k[s], 1e-12 * network.k[s])
            close(f"K of spring {s} in {d}D: symmetric [N/m]", K[s] - K[s].T, np.zeros((d, d)), 1e-12 * network.k[s])


def times(y, A):
    return A @ y


@exercise("2.12", points=0.5,
          hint="sum over all entries; start with a copy of right; raise Diverged if the loop ends without convergence")
def test_conjugate_gradients_solve_positive_systems_and_raise_diverged_for_others(lesson, draw):
    n = draw.whole(16, 24)
    chain = 2.0 * np.eye(n) - np.eye(n, k=1) - np.eye(n, k=-1)           # of springs, with both ends held
    load = np.ones((n, 1)) * draw(0.5, 1.5, 2)
    place = np.arange(1.0, n + 1.0)[:, None]
    sag = 0.5 * load * place * (n + 1.0 - place)                         # a parabola
    right = load.copy()
    # |error| ≤ |A⁻¹| |residual| ≤ 1e-10 · √(2n) · 1.5 (n + 1)²/π² < 7e-8.
    # Steepest descent needs more than 1000 iterations, and 20 n are allowed.
    close("sag of a loaded chain", lesson.conjugate_gradients(times, chain, right), sag, 7e-8, given=f"of {n} points")
    for size in (1e-12, 1e12):                                           # the tolerance is relative
        y = np.asarray(lesson.conjugate_gradients(times, chain, size * load)) / size
        close("sag over load, with the load a trillion times smaller, or larger", y, sag, 7e-8,
              given=f"of {n} points")
    close("input right-hand side after the call: copy it", right, load, 0.0)

    # After two iterations a few millionths of the residual are left, or 7e-10 of it, and after three nothing.
    for off in (5e-4, 1e-7):
        near, right = np.diag([1.0, 0.01, 0.01 + off]), load[0, 0] * np.array([[1.0], [1e-4], [1e-4]])
        y = lesson.conjugate_gradients(times, near, right.copy())
        close("product of a diagonal matrix, 1 to 0.01, with the solution", near @ y, right, 2e-10)

    # condition number 5e8: about 9 iterations
    hilbert = 1.0 / (np.arange(7)[:, None] + np.arange(1, 8)[None, :])
    right = hilbert @ draw(0.5, 1.5, (7, 1))
    y = lesson.conjugate_gradients(times, hilbert, right.copy())
    # The recursive residual is 1e-10 · |right| < 7e-10, plus round-off of numbers below 10.
    close("product of the Hilbert matrix with the solution", hilbert @ y, right, 7e-10)

    # condition number 1e8, so that another start would have a large first residual
    steep, right = np.diag([1.0, 1e4, 1e8]), draw(0.5, 1.5, (3, 1))
    y = lesson.conjugate_gradients(times, steep, right.copy())
    close("product of a diagonal matrix, 1 to 1e8, with the solution", steep @ y, right, 1e-9)
    y = lesson.conjugate_gradients(times, chain, np.zeros((n, 2)))
    close("solution for a right-hand side of zeros", y, np.zeros((n, 2)), 0.0)
    solves_small_and_sparse_systems(lesson, draw)
    turning = np.eye(2) + draw(8.0, 12.0) * np.array([[0.0, 1.0], [-1.0, 0.0]])     # the residuals grow
    right = draw(0.5, 1.5, (2, 1))
    raises("a matrix that is not symmetric", Diverged, lesson.conjugate_gradients, times, turning, right,
           thing="conjugate gradients did not converge: |r|²")


def solves_small_and_sparse_systems(lesson, draw):
    for n, columns in ((1, 1), (1, 2), (2, 1), (3, 2), (8, 1)):
        factor = draw.sparse(-1.0, 1.0, (n, n))
        A = np.eye(n) + factor @ factor.T
        for right in (*nearly_zero(draw, n * columns)[:12], -draw(0.5, 1.5, n * columns),
                      draw.sparse(0.5, 1.5, n * columns)):
            right = right.reshape(n, columns)
            y = lesson.conjugate_gradients(times, A, right.copy())
            # the residual is below 1e-10 · |right| < 5e-10
            close("product of a matrix with the solution", A @ y, right, 5e-10,
                  given=f"right of shape ({n}, {columns})")


@pytest.mark.counts_calls
@exercise("2.12", points=0.5, hint="give up after 10 · right.size rounds: the size counts all entries, not the rows")
def test_conjugate_gradients_give_up_after_ten_rounds_per_unknown(lesson, draw):
    calls, turn = [], draw(2.0, 3.0)

    def turning(y, A):
        calls.append(0)
        return y + turn * np.stack((-y[:, 1], y[:, 0]), axis=1)          # not symmetric: the residuals grow
    n = draw.whole(3, 4)
    raises("a matrix that is not symmetric", Diverged, lesson.conjugate_gradients, turning, 0.0, draw(0.5, 1.5, (n, 2)))
    between("rounds before it gives up", len(calls), 20 * n, 20 * n + 1, given=f"right of shape ({n}, 2)")


def swaying(t, x, v, network):
    """Acceleration of a network with gravity g cos t, independent of the lesson."""
    force = np.zeros_like(x)
    for s in range(network.i.size):
        r = x[network.j[s]] - x[network.i[s]]
        length = np.sqrt(np.sum(r * r))
        rate = np.sum(r * (v[network.j[s]] - v[network.i[s]])) / length
        pull = (network.k[s] * (length - network.rest[s]) + network.k_d[s] * rate) / length
        force[network.i[s]] += pull * r
        force[network.j[s]] -= pull * r
    for n in range(x.shape[0]):
        force[n] = (force[n] + network.wind - network.k_v * v[n]) * network.inv_mass[n]
        if network.inv_mass[n] > 0.0:
            force[n] += network.gravity * np.cos(t)
    return force


@exercise("2.13", points=0.5, hint="the right-hand side contains dt ∂F/∂x v; the position moves with the new velocity")
def test_the_implicit_step_is_linearly_implicit_euler(lesson, draw):
    for m in (draw(20.0, 50.0), draw(0.4, 1.0)):
        t, dt = draw(0.6, 1.0), draw(0.05, 0.10)
        k, k_d, k_v = draw(40.0, 60.0), draw(1.0, 3.0), draw(0.5, 1.0)
        rest = draw(0.8, 1.2)
        g = -draw(9.0, 10.0)
        wind, x0, v0 = draw(-2.0, 2.0), draw(1.3, 1.6), draw(-3.0, -1.0)
        weight = mesh_of(lesson, [0.0, 1.0 / m], [(0, 1, rest, k, k_d)], [g], [wind], k_v)
        before = np.array([[0.0], [x0]]), np.array([[0.0], [v0]])
        kept = np.array(before)
        x, v = lesson.implicit_spring_network_step(swaying, t, *before, dt, weight)
        # the equilibrium position of the weight
        steady = rest + (wind + m * g * np.cos(t)) / k
        # y⁺ = (1 − dt B)⁻¹ y about the equilibrium. Conjugate gradients of one unknown leave only round-off.
        B = np.array([[0.0, 1.0], [-k / m, -(k_d + k_v) / m]])
        expected = np.linalg.solve(np.eye(2) - dt * B, [x0 - steady, v0]) + np.array([steady, 0.0])
        close("x and v of a weight on one spring [m, m/s]", [x[1, 0], v[1, 0]], expected, 1e-12)
        close("x and v of the fixed end [m, m/s]", [x[0, 0], v[0, 0]], [0.0, 0.0], 0.0)
        close("input x and v after the call: return new arrays", np.array(before), kept, 0.0)

    x, v, network = tetrahedron(lesson, draw, 2, 0.5, 0.7)
    agrees_with_a_dense_solver(lesson, t, x, v, dt, network._replace(k_v=k_v, gravity=np.array([wind, g])))
    for x, v, network in (*staircases(lesson, draw, 2), *staircases(lesson, draw, 1), *staircases(lesson, draw, 3)):
        agrees_with_a_dense_solver(lesson, t, x, v, dt, network)
    x, v, network = staircases(lesson, draw, 2)[5]                       # six springs at rest
    for which in (np.arange(6) == 0, np.arange(6) == 5):                 # one of which has dampers, but no stiffness
        dampers = network._replace(k=np.where(which, 0.0, network.k), k_d=draw(0.5, 4.0, 6), k_v=k_v)
        agrees_with_a_dense_solver(lesson, t, x, 0.0 * v, dt, dampers)
    mirror = mesh_of(lesson, [1.0, 1.0], [(0, 1, draw(0.8, 1.0), k, 0.0)], [0.0, 0.0])
    for u in (draw(0.5, 1.0), 0.0):                                      # forces and velocities add up to 0
        x, v = np.array([[-0.6, -0.8], [0.6, 0.8]]), u * np.array([[1.0, -1.0], [-1.0, 1.0]])
        for step in (dt, draw(0.5, 1.0)):
            agrees_with_a_dense_solver(lesson, t, x, v, step, mirror)
    heavy = mesh_of(lesson, draw(1e-6, 2e-6, 2), [(0, 1, 1.0, k, 0.0)], draw(-9.0, -5.0, 2))
    agrees_with_a_dense_solver(lesson, t, x, draw(-1.0, 1.0, (2, 2)), dt, heavy)
    rests = mirror._replace(rest=np.full(1, 2.0))                        # nothing pulls, but one end moves
    agrees_with_a_dense_solver(lesson, t, x, np.array([[0.0, 0.0], [0.6, 0.8]]), dt, rests)


def agrees_with_a_dense_solver(lesson, t, x, v, dt, network):
    """A step of a stretched network; its dampers are left out where it moves: their ∂F/∂x has no block."""
    if v.any():
        network = network._replace(k_d=0.0 * network.k_d)
    x_new, v_new = lesson.implicit_spring_network_step(swaying, t, x, v, dt, network)
    by_x = slope(lambda x: swaying(t, x, v + 0.0j, network), x).reshape(x.size, x.size).T
    by_v = slope(lambda v: swaying(t, x + 0.0j, v, network), v).reshape(x.size, x.size).T
    right = dt * (swaying(t, x, v, network).ravel() + dt * by_x @ v.ravel())
    jump = np.linalg.solve(np.eye(x.size) - dt * by_v - dt * dt * by_x, right).reshape(x.shape)
    # Conjugate gradients leave 1e-10 of dt F, with a total F < 500 N, over the lightest mass, 1/3 kg.
    given = f"{len(x)} points and {network.i.size} springs"
    close("v of a stretched network, compared with a dense solver [m/s]", v_new, v + jump, 2e-8, given)
    close("x of a stretched network [m]", x_new, x + dt * v_new, 1e-14, given)
    fixed = network.inv_mass == 0.0
    close("v of its fixed points, which keep their velocity [m/s]", v_new[fixed], v[fixed], 0.0, given)


@exercise("2.13", points=0.5,
          hint="the matrix has blocks dt² K + dt D, and m + dt k_v on its diagonal, 0 for a fixed point")
def test_the_implicit_step_brings_a_stiff_spring_to_rest_without_gaining_energy(lesson, draw):
    m, k, g = draw(0.5, 2.0), draw(0.5e8, 2e8), draw(9.0, 10.0)
    dt = draw(1.0 / 80.0, 1.0 / 40.0)
    rest = draw(0.8, 1.2)
    # ω dt > 60, while explicit steps are stable up to 2
    stiff = mesh_of(lesson, [0.0, 1.0 / m], [(0, 1, rest, k, 0.0)], [0.0, -g])
    x = np.array([[0.0, 0.0], [0.0, -rest - draw(0.05, 0.15)]])
    v = np.array([[0.0, 0.0], [0.0, draw(-5.0, 5.0)]])

    def energy():
        return 0.5 * m * v[1] @ v[1] + 0.5 * k * (-x[1, 1] - rest) ** 2 + m * g * x[1, 1]

    energies = [energy()]
    for _ in range(20):
        x, v = lesson.implicit_spring_network_step(swaying, 0.0, x, v, dt, stiff)
        energies.append(energy())
    between("largest gain of energy in a step [J]", np.max(np.diff(energies)), -np.inf, 1e-10)   # round-off of 24 J
    # Each step divides the oscillation by ω dt. The round-off of the length, about 1 m, remains.
    close("final extension: mg/k [m]", -x[1, 1] - rest, m * g / k, 1e-14)
    close("horizontal position and velocity at the end [m, m/s]", [x[1, 0], v[1, 0], v[1, 1]], np.zeros(3), 1e-12)


@exercise("2.13", points=0.5, hint="M a on the right: each point's mass times its acceleration, all at t, x and v")
def test_the_implicit_step_keeps_momentum_and_is_of_first_order(lesson, draw):
    x, v, network = tetrahedron(lesson, draw, 2)
    mass, t, dt = draw(0.5, 2.0, 4), draw(0.3, 0.6), draw(0.03, 0.06)
    free = network._replace(inv_mass=1.0 / mass, gravity=draw(-10.0, 10.0, 2), wind=draw(-2.0, 2.0, 2), k_v=0.0)
    _, v_new = lesson.implicit_spring_network_step(swaying, t, x, v, dt, free)
    # Conjugate gradients leave 1e-10 of dt F, with F < 500 N, and twice that in a sum over four points.
    impulse = dt * (mass.sum() * free.gravity * np.cos(t) + 4.0 * free.wind)
    close("change of momentum [N s]: (Σ m g + 4 F_wind) dt", mass @ (v_new - v), impulse, 1e-8)

    end = reference(t, x, v, free)
    errors = []
    for n in (20, 40, 80):
        y, w = x, v
        for step in range(n):
            y, w = lesson.implicit_spring_network_step(swaying, t + SWAYED / n * step, y, w, SWAYED / n, free)
        errors.append(np.abs(np.stack((y, w)) - end).max())
    # A light point has √(Σk/m) < 19/s and Σk_d/m < 24/s, and two of them twice that. The next term of the expansion is
    # below 50 dt of this one. From dt = 1/400 to 1/1600 s it moves the mean order by less than
    # 50 (1/400 − 1/1600)/(2 ln 2) = 0.07.
    between("order of convergence over two halvings", np.log2(errors[0] / errors[2]) / 2.0, 0.9, 1.1)


SWAYED = 0.05                # how long the network sways in the test above [s]


def reference(t, x, v, network):
    """x and v of the swaying network in the end, by DOP853 at its tightest tolerance."""
    from scipy.integrate import solve_ivp
    start = np.stack([x, v])

    def slopes(t, y):
        x, v = y.reshape(start.shape)
        return np.stack([v, swaying(t, x, v, network)]).ravel()

    end = solve_ivp(slopes, (t, t + SWAYED), start.ravel(), method="DOP853", rtol=3e-14, atol=1e-14).y[:, -1]
    return end.reshape(start.shape)


# ---------------------------------------------------------------------------------------------- the hand

@exercise("2.14", points=0.5, hint="put v⁺ = v + dt F/m and x⁺ = x + dt v⁺ into the law, and solve for F")
def test_the_force_of_the_hand_obeys_its_law_at_the_end_of_the_step(lesson, draw):
    drawn = [(draw(-1.0, 1.0, d), draw(-2.0, 2.0, d), draw(-1.0, 1.0, d)) for d in (1, 2, 3)]
    sparse = [tuple(draw.sparse(-1.0, 1.0, (3, d))) for d in (1, 2, 3)]
    at_rest = [(x, 0.0 * v, target) for x, v, target in drawn]
    there = [(target, v, target) for x, v, target in drawn]
    alone = [(draw(-1.0, 1.0, d), v, draw(-1.0, 1.0, d)) for d in (2, 3) for v in nearly_zero(draw, d)]
    shares = ((1.0, 1.0), (0.0, 1.0), (1.0, 0.0))
    for (x, v, target), (of_k, of_c) in itertools.product(drawn + sparse + at_rest + there + alone, shares):
        d, k, c = x.size, of_k * draw(50.0, 200.0), of_c * draw(2.0, 8.0)
        m, dt = draw(0.3, 3.0), draw(0.02, 0.08)
        kept = np.array((x, v, target))
        F = lesson.hand_force(x, v, target, k, c, m, dt)
        after = v + dt * F / m
        law = -k * (x + dt * after - target) - c * after
        close(f"force with {d} coordinate{'s' * (d > 1)} [N]: −k (x⁺ − target) − c v⁺", F, law, 1e-10,
              given=f"k = {k}, c = {c}, m = {m}, dt = {dt}")
        close("input x, v and target after the call", np.array((x, v, target)), kept, 0.0)
    for second, metre, kilogram in ((2.0**-20, 1.0, 1.0), (2.0**20, 2.0**40, 1.0), (1.0, 2.0**-40, 2.0**-30),
                                    (1.0, 1.0, 2.0**30)):                # powers of two: in other units it is the same
        newton = kilogram * metre / second**2
        F = lesson.hand_force(metre * x, metre / second * v, metre * target, newton / metre * 100.0,
                              newton * second / metre * c, kilogram * m, second * dt)
        F_here = lesson.hand_force(x, v, target, 100.0, c, m, dt)
        close("force in these units [N]", np.asarray(F) / newton, F_here, 1e-10,
              given=f"{second:.4g} s, {metre:.4g} m, {kilogram:.4g} kg")
    away = draw(0.2, 0.6, 2)
    slack = lesson.hand_force(away, away, 0.0 * away, 0.0, 0.0, m, dt)
    # m (v⁺ − v)/dt is as right as the law: a few roundings of v, times m/dt < 150 kg/s
    close("force of a slack hand: k = c = 0 [N]", slack, np.zeros(2), 1e-12)
    k, c = draw(1e10, 2e10), draw(1e3, 2e3)
    after = away + dt * lesson.hand_force(away, away, 0.0 * away, k, c, m, dt) / m
    # of the way, (1 + dt + dt c/m)/(1 + dt (c + dt k)/m) < (m + dt m + dt c)/(dt² k) < 1.1e-5 is left
    close("place after a step of an almost rigid hand: the target [m]", away + dt * after, np.zeros(2), 1e-4)


@exercise("2.14", points=0.5,
          hint="the force at the beginning of the step throws the point past the target: take that at its end")
def test_the_hand_brings_a_point_to_rest_at_the_target_for_every_step(lesson, draw):
    for rate in (draw(0.3, 0.9), draw(2.0, 20.0), draw(100.0, 1000.0)):
        m, dt, target, u = draw(0.05, 5.0), draw(0.01, 0.05), draw(-1.0, 1.0, 2), draw(0.0, 1.0)
        k = m * (rate / dt) ** 2                      # √(k/m) dt = rate: explicit steps end at 2
        c = u * np.sqrt(k * m)
        x, v = draw(-1.0, 1.0, 2), draw(-1.0, 1.0, 2)
        energy = lambda x, v, k=k, m=m, target=target: 0.5 * m * v @ v + 0.5 * k * (x - target) @ (x - target)
        energies = [energy(x, v)]
        for _ in range(60):
            v = v + dt / m * lesson.hand_force(x, v, target, k, c, m, dt)
            x = x + dt * v
            energies.append(energy(x, v))
        gains = np.diff(energies) / energies[0]
        between("largest gain of energy in a step, over the energy at the start", np.max(gains), -np.inf, 1e-14)
        # without damping each step divides the energy by 1 + rate²: (1 / 1.09)^60 = 0.0057
        between("energy that is left after 60 steps, over that at the start", energies[-1] / energies[0], 0.0, 0.0075)


# ---------------------------------------------------------------------------------------------- why?

@exercise("2.15", points=1,
          hint="the uppermost spring carries all n points, the lowest one only the last: add up their stretches")
def test_a_chain_sags_as_far_as_its_equations_of_balance_say(lesson, draw):
    for n in (1, draw.whole(2, 4), draw.whole(8, 15), draw.whole(30, 40)):
        m, k, g = draw(0.01, 0.1), draw(50.0, 200.0), draw(5.0, 15.0)
        balance = k * (2.0 * np.eye(n) - np.eye(n, k=1) - np.eye(n, k=-1))
        balance[-1, -1] = k                                              # no spring below the last point
        sag = np.linalg.solve(balance, np.full(n, m * g))[-1]
        # the condition of the balance is below 4 n² = 6400, and a sag below 25 m
        close("sag of the lowest point [m]", lesson.chain_sag(n, m, k, g), sag, 1e-11,
              given=f"{n} point{'s' * (n > 1)} of {m:.4g} kg, k = {k:.4g} N/m, g = {g:.4g} m/s²")


@exercise("2.16", points=1,
          hint="symplectic Euler is stable while ω dt < 2, and ω is the fastest vibration of the network")
def test_the_chosen_step_keeps_its_ratio_to_the_fastest_period(lesson):
    right = choices.where("springs", "longest_steps", lambda k, dt: np.allclose(dt * np.sqrt(k / MASS), 2.0))
    choice("the letter of the longest stable step", lesson.longest_step_is(), right)


@exercise("2.17", points=1,
          hint="a square of four springs folds flat (0), and a diagonal holds it; a larger k carries more weight, "
               "a smaller k slows the fastest vibration")
def test_a_body_of_ones_own_holds_its_shape_and_its_weight(lesson, draw):
    for size in (draw(0.3, 0.4), draw(0.7, 0.8), draw(1.5, 2.0)):      # one body cannot have all sizes
        x, pairs, k = lesson.my_body(size)
        x, pairs = np.asarray(x, dtype=float), np.asarray(pairs)
        given = f"size = {size:.4g} m"
        between("number of points", len(x), 5, 200)
        between("height of the lowest point [m]", x[:, 1].min(), 1e-9, 10.0, given)
        between("width or height, the larger one, over size [-]", np.ptp(x, axis=0).max() / size, 0.9, 1.1, given)
        squares = squared_frequencies(x, pairs, float(k), 0.02)
        between("slowest vibration over that which carries the weight [-]",
                np.sqrt(max(0.0, squares[3]) / (2.0 * 9.81 / size)), 1.0, np.inf, given)
        between("fastest vibration times a step of 1/1000 s [-]", np.sqrt(squares[-1]) / 1000.0, 0.0, 2.0, given)


def squared_frequencies(x, pairs, k, m):
    """ω² [1/s²] of all vibrations about a shape at rest, in order; the first three are those of a rigid body, 0."""
    n = len(x)
    K = np.zeros((n, 2, n, 2))
    for i, j in pairs:
        along = (x[j] - x[i]) / np.linalg.norm(x[j] - x[i])
        for a, b, sign in ((i, i, 1.0), (j, j, 1.0), (i, j, -1.0), (j, i, -1.0)):
            K[a, :, b] += sign * k * np.outer(along, along)
    return np.linalg.eigvalsh(K.reshape(2 * n, 2 * n)) / m
