"""Lesson 6: distances are the least, times of impact the first, and a hierarchy finds the same pairs as brute force."""

import itertools

import numpy as np
import pytest

from solutions.checks import BadInput
from validate.grading.expect import NotYet, between, choice, close, numbers, raises
from validate.reference import choices

from .brute import area, differences, distance, facets, outline

exercise = pytest.mark.exercise
# Lengths are below 30 m and times below 10 s. A result takes a few dozen operations, each with a round-off of 1.1e-16.
ROUND_OFF = 1e-12
# Error of brute force over the size: 1e-13 at a thousand sizes from the origin, over angles of 0.01 rad, times ten.
KNOWN = 1e-10
EDGE_PREFERENCE = 1e-9          # of the longest half edge [-]: a pair of edges must separate by so much more


# Sizes of medium, small and large bodies [m], the ordinary one first: a student reads of the first case that fails.
# Powers of two: what is exact at one size is exact at the others.
SIZES = (1.0, 2.0**-100, 2.0**100)


def places(draw, d=3):
    """(size, place) of small, medium and large bodies [m], at the origin and a thousand sizes away from it."""
    return [(size, far * size * draw(-1.0, 1.0, d)) for size in SIZES for far in (0.0, 1e3)]


def rotation(draw):
    """A drawn rotation (3, 3): columns n, t_1, t_2, none along a coordinate axis."""
    q = np.concatenate((draw(0.4, 1.0, 1), draw(0.2, 0.6, 3)))
    w, x, y, z = q / np.linalg.norm(q)
    return np.array([[1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
                     [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
                     [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]])


def axes(draw, d):
    """d orthogonal unit vectors as rows."""
    if d == 3:
        return np.ascontiguousarray(rotation(draw).T)
    turn = draw(0.2, 1.3) + 0.5 * np.pi * draw.whole(0, 3)
    return np.array([[np.cos(turn), np.sin(turn)], [-np.sin(turn), np.cos(turn)]])


def frames(draw, d):
    """d orthogonal unit vectors as rows: in general position, and along the coordinate axes, both ways."""
    return [axes(draw, d), *(sign * np.roll(np.eye(d), k, axis=0) for k in range(d) for sign in (1.0, -1.0))]


def directions(d):
    """Whole vectors (d,) with one component that is not 0, in each place, and ones whose components add up to 0.

    A test for zero by one component, or by their sum, errs there.
    """
    rows = [np.array(row) for row in itertools.product((0.0, 1.0, -1.0), repeat=d)]
    rows = [row for row in rows if np.sum(row != 0.0) == 1 or (row.any() and np.sum(row) == 0.0)]
    return rows + [np.roll([1.0, 1.0, -2.0], k) for k in range(3 if d == 3 else 0)]


def never(quantity, got, given=""):
    """The answer must be infinity: there is no impact."""
    if got is None or np.ndim(got) > 0 or np.asarray(got).dtype.kind not in "iuf":
        numbers(quantity, got, (), given)
    if not float(got) == np.inf:
        raise NotYet(quantity, "NEVER", f"{got}", "none: exactly this", "another time", given, (got, np.inf))


def same_contact(got, p_a, p_b, n, gap, tolerance, given=""):
    """Compare all fields of a contact."""
    close("n of the contact: from b to a", got.n, n, tolerance, given)
    close("gap of the contact [m]", got.gap, gap, tolerance, given)
    close("p_a of the contact [m]", got.p_a, p_a, tolerance, given)
    close("p_b of the contact [m]", got.p_b, p_b, tolerance, given)
    close("t of the contact [s]: it is there at once", got.t, 0.0, 0.0, given)


# ---------------------------------------------------------------------------------------------- points and planes

@exercise("6.1", points=1, hint="n · p + d, with the plane's unit normal n and its d")
def test_the_distance_to_a_plane_has_a_sign_for_its_side(lesson, draw):
    for d, size in ((2, 1.0), *((3, size) for size in SIZES)):
        for rows in frames(draw, d):
            for foot in (size * draw(-3.0, 3.0, d), size * draw.sparse(-3.0, 3.0, d), np.zeros(d)):
                plane, height = lesson.Plane(rows[0], float(-rows[0] @ foot)), size * draw(-3.0, 3.0)
                for high, along in ((height, size * draw(-2.0, 2.0)), (0.0, size * draw(-2.0, 2.0)), (height, 0.0),
                                    (1e-10 * size, size * draw(-2.0, 2.0))):
                    p = foot + high * rows[0] + along * rows[1]
                    close("signed distance [m]", lesson.plane_distance(p, plane), high, ROUND_OFF * size,
                          given=f"p = {p}, {plane}")
            close("signed distance of the origin [m]",
                  lesson.plane_distance(np.zeros(d), lesson.Plane(rows[0], height)), height, ROUND_OFF * size)


def fall(lesson, draw, d, r):
    """(t, dt, x_0, x_1, plane, s): a ball that touches a plane after the fraction s of a step."""
    rows, foot = axes(draw, d), draw(-3.0, 3.0, d)
    s = draw(0.1, 0.9)
    move = -draw(1.0, 9.0) * rows[0] + draw(-5.0, 5.0) * rows[1]
    touch = foot + r * rows[0]
    plane = lesson.Plane(rows[0], float(-rows[0] @ foot))
    return draw(1.0, 5.0), draw(0.01, 0.5), touch - s * move, touch + (1.0 - s) * move, plane, s


@exercise("6.2", points=0.25, hint="d₁ and d₂ measure the ball's surface, not its centre: d₁ = E − r, d₂ = r − E")
def test_a_ball_meets_a_plane_when_its_surface_does(lesson, draw):
    for d, r in ((2, draw(0.1, 0.5)), (3, draw(0.1, 0.5)), (3, 0.0)):
        t, dt, x_0, x_1, plane, s = fall(lesson, draw, d, r)
        close("time of impact [s]", lesson.plane_impact_time(t, dt, x_0, x_1, r, plane), t + s * dt, ROUND_OFF,
              given=f"t = {t}, dt = {dt}, {x_0} to {x_1}, r = {r}, {plane}")


@exercise("6.2", points=0.25,
          hint="d₁ ≤ 0: the ball already touches, return t; d₂ < 0: it does not reach the plane, return NEVER")
def test_a_touching_ball_meets_the_plane_at_once_and_one_that_does_not_arrive_never(lesson, draw):
    r = draw(0.1, 0.5)
    t, dt, x_0, x_1, plane, s = fall(lesson, draw, 3, r)
    given = lambda begin, end: f"t = {t}, dt = {dt}, {begin} to {end}, r = {r}, {plane}"
    for what, end in (("if the step ends before it", x_0 + 0.9 * s * (x_1 - x_0)),
                      ("of a ball that flies off", 2.0 * x_0 - x_1)):
        never(f"time of impact {what} [s]", lesson.plane_impact_time(t, dt, x_0, end, r, plane), given(x_0, end))
    sunk = x_0 + s * (x_1 - x_0) - 0.5 * r * plane.n                    # its centre is still above the plane
    for begin, end in ((x_1, x_0), (x_1, 2.0 * x_1 - x_0), (sunk, x_0)):
        close("time of impact of a ball that already overlaps [s]",
              lesson.plane_impact_time(t, dt, begin, end, r, plane), t, 0.0, given(begin, end))


@exercise("6.2", points=0.25,
          hint="d₁ ≤ 0: return t, also of a ball at rest; d₂ < 0: NEVER; else the share of the step is d₁/(d₁ + d₂)")
def test_a_ball_that_rests_slides_or_falls_along_an_axis_meets_a_plane_when_its_gap_is_gone(lesson, draw):
    """Whole numbers and powers of two: no round-off.  Along 4 m, the components of some moves add up to 0."""
    shares = {(2.0, 2.0): np.inf, (0.0, 0.0): 0.0, (-1.0, -1.0): 0.0, (0.0, 2.0): 0.0, (2.0, 0.0): 1.0,
              (2.0, -2.0): 0.5, (6.0, -2.0): 0.75}
    for rows, (gaps, share), along in itertools.product(frames(draw, 3)[1:], shares.items(), (0.0, 3.0, 4.0)):
        t, dt, r = float(draw.whole(-2, 2)), 2.0 ** draw.whole(-20, 6), float(draw.whole(0, 1))
        foot = np.floor(draw.sparse(-4.0, 4.0, 3))
        plane = lesson.Plane(rows[0], float(-rows[0] @ foot))
        x_0, x_1 = foot + (r + gaps[0]) * rows[0], foot + (r + gaps[1]) * rows[0] + along * rows[1]
        got, given = lesson.plane_impact_time(t, dt, x_0, x_1, r, plane), f"t = {t}, dt = {dt}, {x_0} to {x_1}, r = {r}"
        if share == np.inf:
            never("time of impact of a ball that stays above the plane [s]", got, f"{given}, {plane}")
        else:
            close("time of impact [s]", got, t + share * dt, 0.0, f"{given}, {plane}")


@exercise("6.2", points=0.25,
          hint="test d₁ ≤ 0 first, wherever the ball goes; then d₂ < 0; with d₂ = 0 it touches at the end of the step")
def test_a_ball_of_any_size_meets_a_plane_only_if_it_comes_through_from_above(lesson, draw):
    """The gap changes linearly. Both ends are known to 1e-13 of the size and differ by at least 0.4 sizes."""
    for size, place in places(draw):
        for sides in ((1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)):
            rows = axes(draw, 3)
            r = size * draw(0.01, 2.0) * draw.whole(0, 1)                # 0: a point
            t, dt = draw(1.0, 5.0), draw(0.01, 0.5)
            gaps = size * draw(0.2, 3.0, 2) * sides
            plane = lesson.Plane(rows[0], float(-rows[0] @ place))
            x_0, x_1 = (place + (r + gap) * rows[0] + size * draw(-3.0, 3.0) * rows[1] for gap in gaps)
            got = lesson.plane_impact_time(t, dt, x_0, x_1, r, plane)
            given = f"t = {t}, dt = {dt}, gaps {gaps}, {x_0} to {x_1}, r = {r}, {plane}"
            if sides == (1.0, 1.0):
                never("time of impact of a ball that stays above [s]", got, given)
            else:
                share = gaps[0] / (gaps[0] - gaps[1]) if gaps[0] > 0.0 else 0.0
                close("time of impact [s]", got, t + share * dt, 1e-11, given)
    # whole numbers: no round-off
    level, r, x = float(draw.whole(-4, 4)), float(draw.whole(1, 3)), draw(-3.0, 3.0, 2)
    floor = lesson.Plane(np.array([0.0, 0.0, 1.0]), -level)
    above, on = np.array([*x, level + r + 2.0]), np.array([*x, level + r])
    close("time of impact of a ball that touches and leaves [s]",
          lesson.plane_impact_time(3.0, 0.5, on, above, r, floor), 3.0, 0.0)
    close("time of impact at the end of the step [s]", lesson.plane_impact_time(3.0, 0.5, above, on, r, floor), 3.5,
          0.0)
    for size in SIZES:
        floor, on = lesson.Plane(floor.n, -size * level), size * np.array([0.0, 1.0, level + r])
        above = on + 0.5 * size * floor.n
        close("time of impact at the end of the step [s]",
              lesson.plane_impact_time(3.0, 0.5, above, on, size * r, floor), 3.5, 0.0,
              f"{above} to {on}, r = {size * r}, {floor}")
        never("time of impact of a ball that does not quite arrive [s]",
              lesson.plane_impact_time(3.0, 0.5, above, on + 2.0**-30 * size * floor.n, size * r, floor),
              f"{above} to {on}, but for the last 1e-9 of the size, r = {size * r}, {floor}")
        above = on + 2.0**-30 * size * floor.n
        close("time of impact at the very beginning of the step [s]",
              lesson.plane_impact_time(3.0, 0.5, above, on - size * floor.n, size * r, floor), 3.0 + 2.0**-31, 1e-15,
              f"{above} to {on - size * floor.n}, r = {size * r}, {floor}")


# ---------------------------------------------------------------------------------------------- cylinder along x

@exercise("6.3", points=0.5, hint="the nearest point of the axis has the ball's x coordinate, and y = z = 0")
def test_a_ball_and_a_cylinder_are_nearest_across_the_axis(lesson, draw):
    R, r, along = draw(0.5, 1.5), draw(0.1, 0.4), draw(-5.0, 5.0)
    for gap in (draw(0.1, 2.0), -draw(0.05, 0.3), -0.9 * (R + r)):
        phi = draw(0.0, 2.0 * np.pi)
        n, foot = np.array([0.0, np.cos(phi), np.sin(phi)]), np.array([along, 0.0, 0.0])
        x = foot + (R + r + gap) * n
        # The error of n is 1e-16·5/0.06.
        same_contact(lesson.cylinder_contact(x, r, R), x - r * n, foot + R * n,
                     n, gap, 1e-11, f"x = {x}, r = {r}, R = {R}")
    for ball, cylinder, foot in itertools.product((r, 0.0), (R, 0.0), (np.array([along, 0.0, 0.0]), np.zeros(3))):
        reach = ball + cylinder
        for y, z, length in ((0.0, 2.0, 2.0), (-0.5, 0.0, 0.5), (3.0, -4.0, 5.0), (3.0, -3.0, np.sqrt(18.0)),
                             (0.0, -R - r, R + r)):
            x, n = foot + np.array([0.0, y, z]), np.array([0.0, y, z]) / length
            same_contact(lesson.cylinder_contact(x, ball, cylinder), x - ball * n, foot + cylinder * n, n,
                         length - reach, ROUND_OFF, f"x = {x}, r = {ball}, R = {cylinder}")
        c, given = lesson.cylinder_contact(foot, ball, cylinder), f"x = {foot}, r = {ball}, R = {cylinder}"
        n = numbers("n", c.n, (3,), given)
        close("length of n of a ball on the axis", np.linalg.norm(n), 1.0, ROUND_OFF, given)
        close("component of n along the axis there", n[0], 0.0, ROUND_OFF, given)
        same_contact(c, foot - ball * n, foot + cylinder * n, n, -reach, ROUND_OFF, given)


@exercise("6.3", points=0.5,
          hint="of all points (s, 0, 0) of the axis, the nearest to the ball has s = x₀, wherever the ball is")
def test_no_point_of_the_axis_is_nearer_than_the_one_of_the_contact(lesson, draw):
    for size, place in places(draw):
        for phi in (0.0, 0.5 * np.pi, np.pi, draw(0.0, 2.0 * np.pi)):
            out = size * 10.0 ** draw(-2.0, 1.0)
            r, R = size * draw(0.01, 2.0), size * draw(0.01, 2.0)
            x = np.array([place[0], out * np.cos(phi), out * np.sin(phi)])
            axis = np.zeros((201, 3))
            axis[:, 0] = x[0] + out * np.linspace(-1.0, 1.0, 201)        # the middle one is x[0] itself
            q = axis[np.argmin(np.linalg.norm(axis - x, axis=1))]
            n = (x - q) / np.linalg.norm(x - q)
            gap = np.linalg.norm(x - q) - r - R
            c = lesson.cylinder_contact(x, r, R)
            given = f"x = {x}, r = {r}, R = {R}"
            close("n of the contact: from b to a", c.n, n, KNOWN, given)
            close("gap, p_a and p_b of the contact over the size [-]", np.concatenate(([c.gap], c.p_a, c.p_b)) / size,
                  np.concatenate(([gap], x - r * n, q + R * n)) / size, KNOWN, given)


def crossing(draw, rho, beside, far, length, begin=None):
    """(x_0, x_1): a path of `length` across the axis and some way along it.

    It starts at a distance `far` before the axis and passes it at a distance `beside`.
    """
    phi, x = draw(0.0, 2.0 * np.pi), draw(-3.0, 3.0, 2)
    e, across = np.array([np.cos(phi), np.sin(phi)]), np.array([-np.sin(phi), np.cos(phi)])
    y = -far * e + beside * across
    return np.append(x[0], y), np.append(x[1], y + length * e)


@exercise("6.4", points=0.5, hint="take the first of the two roots; the coordinate along the axis does not matter")
def test_the_first_root_is_the_time_of_impact_at_20_m_per_s_and_at_10_km_per_s(lesson, draw):
    """A path at distance `beside` from the axis enters the circle of radius ρ at √(ρ² − beside²) before the axis.

    The round-off of lengths is 1e-16·1000.
    """
    R, r, dt = draw(0.5, 1.5), draw(0.05, 0.3), 0.1
    for speed in (20.0, 100.0, 1e4):
        length, share = speed * dt, draw(-0.9, 0.9)
        far = (R + r) + draw(0.05, 0.2) * (length - 0.5 * (R + r))
        x_0, x_1 = crossing(draw, R + r, share * (R + r), far, length)
        way = far - (R + r) * np.sqrt(1.0 - share**2)
        t, before = draw(1.0, 5.0), x_1.copy()
        got = lesson.cylinder_impact_time(t, dt, x_0, x_1, r, R)
        close("input x_1 after the call: do not change it [m]", x_1, before, 0.0)
        if way < length:
            close("time of impact [s]", got, t + way / speed, 1e-11,
                  given=f"t = {t}, dt = {dt}, {x_0} to {x_1}, r = {r}, R = {R}")
        else:
            never("time of impact after the end of the step [s]", got,
                  given=f"t = {t}, dt = {dt}, {x_0} to {x_1}, r = {r}, R = {R}")


@exercise("6.4", points=0.5,
          hint="C ≤ 0: already touches; B ≥ 0: moves away, or along the axis; D < 0: misses; s > 1: comes later")
def test_a_ball_that_misses_leaves_or_arrives_later_has_no_impact(lesson, draw):
    R, r, t, dt = draw(0.5, 1.5), draw(0.05, 0.3), draw(1.0, 5.0), draw(0.01, 0.2)
    rho = R + r
    for beside in draw.beyond(2.0):
        x_0, x_1 = crossing(draw, rho, beside * rho, draw(3.0, 5.0), 10.0)
        never("time of impact of a ball that misses [s]", lesson.cylinder_impact_time(t, dt, x_0, x_1, r, R),
              f"{x_0} to {x_1}, r = {r}, R = {R}")
    x_0, x_1 = crossing(draw, rho, draw(-0.8, 0.8) * rho, draw(4.0, 6.0), draw(0.5, 1.5))
    never("time of impact of a ball that arrives too late [s]", lesson.cylinder_impact_time(t, dt, x_0, x_1, r, R),
          f"{x_0} to {x_1}, r = {r}, R = {R}")
    never("time of impact of a ball that moves away [s]",
          lesson.cylinder_impact_time(t, dt, x_0, 20.0 * x_0 - 19.0 * x_1, r, R), f"{x_0}, away, r = {r}, R = {R}")
    aside = x_0 + np.array([draw(1.0, 9.0), 0.0, 0.0])
    never("time of impact of a ball that flies along the axis [s]",
          lesson.cylinder_impact_time(t, dt, x_0, aside, r, R),
          f"{x_0} to {aside}")
    inside = np.append(x_0[0], draw(0.1, 0.6, 2) * rho)
    for end in (inside, x_0):
        close("time of impact of a ball that overlaps [s]", lesson.cylinder_impact_time(t, dt, inside, end, r, R),
              t, 0.0, given=f"{inside} to {end}")


@exercise("6.4", points=0.5, hint="D = A ρ² − (y₀ w₁ − y₁ w₀)²: in B² − A C the significant digits cancel")
def test_a_grazing_shot_from_afar_loses_no_digits(lesson, draw):
    """From 1000ρ, the ball passes at (1 − 1e-9)ρ and enters at √(2e-9)ρ = 4.5e-5ρ before the axis.

    The cross product is known to 2e-13ρ, so the entry is known to 2e-13/4.5e-5 = 5e-9ρ.
    """
    for _ in range(5):
        R, r = draw(0.5, 1.5), draw(0.05, 0.3)
        rho = R + r
        x_0, x_1 = crossing(draw, rho, (1.0 - 1e-9) * rho, 1e3 * rho, 2e3 * rho)
        way = 2e3 * rho * lesson.cylinder_impact_time(0.0, 1.0, x_0, x_1, r, R)
        close("distance to the impact over ρ [-]", way / rho, 1e3 - np.sqrt(2e-9 - 1e-18), 5e-8,
              given=f"{x_0} to {x_1}, r = {r}, R = {R}")


def touches_first(draw, got, t, dt, x_0, x_1, rho, size, given):
    """Check `got` with the distance from the axis along the path: its square is convex, so it falls first, then rises.

    |y|² is known to 1e-15 of (10 size)², so |y| near ρ > 0.1 size is known to 1e-12 of the size.
    """
    y, w = x_0[1:], (x_1 - x_0)[1:]
    nearest = y + min(1.0, max(0.0, -(y @ w) / (w @ w))) * w
    if np.linalg.norm(y) <= rho:
        close("time of impact of a ball that already touches [s]", got, t, 0.0, given)
    elif np.linalg.norm(nearest) > rho:
        never("time of impact of a ball that does not come close enough [s]", got, given)
    else:
        s = (float(numbers("time of impact [s]", got, (), given)) - t) / dt
        between("time of impact as a fraction of the step [-]", s, 0.0, 1.0 + 1e-12, given)
        close("distance from the axis then, minus R + r, over the size [-]", (np.linalg.norm(y + s * w) - rho) / size,
              0.0, 1e-11, given)
        between("rate of change of that distance [-]: approaching", (y + s * w) @ w / size**2, -np.inf, 1e-9, given)


@exercise("6.4", points=0.25,
          hint="a radius of 0, a path along an axis or none at all need no case of their own: test C, B, D and s")
def test_a_ball_that_rests_or_flies_along_an_axis_touches_the_cylinder_when_it_arrives(lesson, draw):
    """Both radii together are 2 m.  Along y or z, with whole numbers, only the division rounds.

    Across both, the components of the move add up to 0; what is exactly at the limit is left out there.
    """
    shares = {(6.0, 2.0): 1.0, (6.0, 0.0): 2.0 / 3.0, (6.0, -6.0): 1.0 / 3.0, (6.0, 3.0): np.inf, (6.0, 6.0): np.inf,
              (6.0, 8.0): np.inf, (2.0, 2.0): 0.0, (1.0, 1.0): 0.0, (0.0, 0.0): 0.0, (0.0, 6.0): 0.0, (2.0, 6.0): 0.0}
    for ((begin, end), share), r, k in itertools.product(shares.items(), (0.0, 0.5, 2.0), range(6)):
        e, along = np.append(0.0, directions(2)[k]), np.array([draw.whole(0, 1), 0.0, 0.0])
        if e.all(axis=0, where=[False, True, True]) and 2.0 in (begin, end):
            continue
        e = e / np.linalg.norm(e)
        t, dt = float(draw.whole(-2, 2)), 2.0 ** draw.whole(-20, 6)
        x_0, x_1 = along + begin * e, draw.whole(0, 2) * along + end * e
        got = lesson.cylinder_impact_time(t, dt, x_0, x_1, r, 2.0 - r)
        given = f"t = {t}, dt = {dt}, {x_0} to {x_1}, r = {r}, R = {2.0 - r}"
        if share == np.inf:
            never("time of impact of a ball that does not arrive [s]", got, given)
        else:
            close("time of impact [s]", got, t + share * dt, ROUND_OFF, given)


@exercise("6.4", points=0.25,
          hint="C ≤ 0: it starts inside; B ≥ 0: it moves away; D < 0: it misses; s > 1: it arrives later; s = 1 counts")
def test_any_path_touches_the_cylinder_first_where_it_enters(lesson, draw):
    for size, place in places(draw):
        for _ in range(6):
            r, R = size * draw(0.05, 1.0), size * draw(0.05, 1.0)
            t, dt = draw(0.0, 2.0), draw(0.1, 1.0)
            x_0, x_1 = size * draw(-3.0, 3.0, (2, 3)) + place * np.array([1.0, 0.0, 0.0])
            given = f"t = {t}, dt = {dt}, {x_0} to {x_1}, r = {r}, R = {R}"
            touches_first(draw, lesson.cylinder_impact_time(t, dt, x_0, x_1, r, R), t, dt, x_0, x_1, R + r, size, given)
    rho, m = float(draw.whole(2, 5)), float(draw.whole(2, 5))            # whole numbers: no round-off
    begin, end = np.array([1.0, -m * rho, 0.0]), np.array([3.0, -rho, 0.0])
    close("time of impact at the end of the step [s]",
          lesson.cylinder_impact_time(2.0, 0.5, begin, end, 1.0, rho - 1.0), 2.5, 0.0, f"ρ = {rho}, {begin} to {end}")
    close("time of impact of a ball that touches and leaves [s]",
          lesson.cylinder_impact_time(2.0, 0.5, end, begin, 1.0, rho - 1.0), 2.0, 0.0, f"ρ = {rho}, {end} to {begin}")
    for size in SIZES:
        begin, end = size * np.array([1.0, -rho - 0.5, 0.0]), size * np.array([1.0, -rho, 0.0])
        close("time of impact at the end of a step by half the size [s]",
              lesson.cylinder_impact_time(2.0, 0.5, begin, end, size, size * (rho - 1.0)), 2.5, 0.0,
              f"{begin} to {end}, r = {size}, R = {size * (rho - 1.0)}")
        never("time of impact of a ball that does not quite arrive [s]",
              lesson.cylinder_impact_time(2.0, 0.5, begin, end - size * np.array([0.0, 2.0**-34, 0.0]), size,
                                          size * (rho - 1.0)), f"{begin} to {end}, but for the last 6e-11 of the size")
        nearly = size * np.array([1.0, -rho - 2.0**-30, 0.0])
        close("time of impact at the very beginning of the step [s]",
              lesson.cylinder_impact_time(2.0, 0.5, nearly, nearly + size * np.array([0.0, 0.5, 0.0]), size,
                                          size * (rho - 1.0)), 2.0 + 2.0**-30, 1e-14, f"from {nearly} by half the size")
        # D is exactly 0 here.
        begin, end = size * np.array([1.0, -m, rho]), size * np.array([2.0, m, rho])
        close("time of impact of a ball that only grazes [s]",
              lesson.cylinder_impact_time(2.0, 0.5, begin, end, size, size * (rho - 1.0)), 2.25, ROUND_OFF,
              f"{begin} to {end}, r = {size}, R = {size * (rho - 1.0)}")
        aside = 2.0**-30 * size * np.array([0.0, 0.0, 1.0])
        never("time of impact of a ball that barely misses [s]",
              lesson.cylinder_impact_time(2.0, 0.5, begin + aside, end + aside, size, size * (rho - 1.0)),
              f"{begin + aside} to {end + aside}, r = {size}, R = {size * (rho - 1.0)}")


@exercise("6.5", points=0.25, hint="s = (p − a) · (b − a)/|b − a|², clamped to 0 … 1")
def test_the_nearest_point_of_a_segment_is_its_foot_or_an_end(lesson, draw):
    for d in (2, 3):
        rows, a = axes(draw, d), draw(-3.0, 3.0, d)
        length = draw(0.5, 4.0)
        b = a + length * rows[0]
        aside = draw(0.1, 3.0) * rows[1]
        s = draw(0.1, 0.9)
        on = a + s * (b - a)
        nearly = a + 1e-9 * (b - a), b - 1e-9 * (b - a)                  # inside, but almost at an end
        for p, expected in ((on + aside, on), (a - s * (b - a) + aside, a), (b + s * (b - a) - aside, b), (a, a),
                            *((q + aside, q) for q in nearly)):
            close("nearest point of the segment [m]", lesson.closest_on_segment(p, a, b), expected, ROUND_OFF,
                  given=f"p = {p}, a = {a}, b = {b}")
    for e in (*directions(1), *directions(2), *directions(3)):           # from and to the origin, too
        along = 4.0 * e
        for a, share in itertools.product((0.0 * e, -along, np.floor(draw.sparse(-4.0, 4.0, len(e)))),
                                          (-1.0, 0.0, 0.25, 0.5, 1.0, 2.0)):
            aside = draw.sparse(-3.0, 3.0, len(e))
            p = a + share * along + aside - aside @ e / (e @ e) * e
            close("nearest point of a segment along a simple direction [m]", lesson.closest_on_segment(p, a, a + along),
                  a + min(1.0, abs(share)) * (share > 0.0) * along, ROUND_OFF, f"p = {p}, a = {a}, b = {a + along}")


@exercise("6.5", points=0.25, hint="if a and b are the same point, raise BadInput with the length")
def test_a_segment_without_length_is_refused(lesson, draw):
    for d in (2, 3):
        a = draw(-3.0, 3.0, d)
        raises("a segment from a point to itself", BadInput, lesson.closest_on_segment, draw(-3.0, 3.0, d), a, a.copy())
        for k in range(2 * d):                                           # along each coordinate axis, both directions
            a, b, s = draw(-3.0, 3.0, d), np.zeros(d), draw(0.1, 0.9)
            b[k % d] = draw(0.5, 4.0) * (1.0 if k < d else -1.0)
            aside = np.where(np.arange(d) == k % d, 0.0, draw(-3.0, 3.0, d))
            close("nearest point of a segment along a coordinate axis [m]",
                  lesson.closest_on_segment(a + s * b + aside, a, a + b), a + s * b, ROUND_OFF,
                  f"p = {a + s * b + aside}, a = {a}, b = {a + b}")
        tiny = a + 1e-7
        close("nearest point of a very short segment [m]", lesson.closest_on_segment(tiny + 1.0, a, tiny),
              tiny, ROUND_OFF)
        for size in SIZES:                                               # a million lengths from the origin, exactly
            e = np.eye(d)[draw.whole(0, d - 1)]
            a, length = size * np.floor(draw(1.0, 9.0, d)), 2.0**-40 * size
            b, p = a + length * e, a + 0.25 * length * e + size * (1.0 - e)
            got = numbers("nearest point of a short segment far away [m]", lesson.closest_on_segment(p, a, b), (d,))
            close("nearest point of a short segment far away, from a over its length [-]", (got - a) / length, 0.25 * e,
                  1e-3, f"p = {p}, a = {a}, b = a + {length * e}")


def is_nearest(quantity, q, p, corners, size, given=""):
    """Check that q is the point of the hull nearest to p: q is in the hull, and no corner is beyond q along p − q."""
    q = numbers(f"{quantity} [m]", q, p.shape, given)
    between(f"{quantity}: distance from its body over the size [-]", distance(q[None], corners) / size, 0.0,
            KNOWN, given)
    between(f"{quantity}: how far a corner lies beyond it along p − q, over the size [-]",
            ((corners - q) @ (p - q)).max() / size**2, -1.0, KNOWN, given)


@exercise("6.5", points=0.5,
          hint="at the nearest point q, p − q makes no acute angle with the segment: clamp s to 0 … 1")
def test_no_point_of_a_segment_is_nearer_at_any_size_and_place(lesson, draw):
    for d in (2, 3):
        for size, place in places(draw, d):
            for length in (1e-2, 1.0):
                p, a = place + size * draw(-1.0, 1.0, (2, d))
                b = a + length * size * axes(draw, d)[0]
                is_nearest("nearest point of the segment", lesson.closest_on_segment(p, a, b), p, np.stack((a, b)),
                           size, f"p = {p}, a = {a}, b = {b}")


def seen_along(draw, shadow):
    """Corners (3,) whose coordinates (1, 2) are those of `shadow`, rotated by a drawn angle, with drawn x."""
    phi = draw(0.0, 2.0 * np.pi)
    c, s = np.cos(phi), np.sin(phi)
    return [np.array([draw(-3.0, 3.0), c * y - s * z, s * y + c * z]) for y, z in shadow]


@exercise("6.6", points=0.25,
          hint="all three y_i z_j − z_i y_j have one sign: the axis passes through the face, wherever the corners are")
def test_a_cylinder_that_pierces_a_face_is_found_though_corners_and_edges_are_clear(lesson, draw):
    R, r = draw(0.2, 0.5), draw(0.01, 0.1)
    for order, size in ((order, size) for order in (1, -1) for size in SIZES):
        angles = np.array([0.0, 2.1, 4.2]) + draw(-0.3, 0.3, 3)
        corners = seen_along(draw, [(draw(4.0, 6.0) * np.cos(a), draw(4.0, 6.0) * np.sin(a)) for a in angles])[::order]
        corners = [size * corner for corner in corners]
        close("gap of a pierced face over the size [-]",
              lesson.triangle_cylinder_gap(*corners, size * r, size * R) / size, -R - r, ROUND_OFF,
              f"corners {corners}, r = {size * r}, R = {size * R}")


@exercise("6.6", points=0.25, hint="otherwise the least edge_axis_distance of the three edges, minus R + r")
def test_the_nearest_edge_gives_the_gap_of_a_face_that_is_not_pierced(lesson, draw):
    R, r = draw(0.2, 0.5), draw(0.01, 0.1)
    for height in (draw(0.6, 2.0), draw(0.05, 0.2)):
        wide, high = draw(1.0, 5.0, 2), height + draw(1.0, 3.0)
        edge = [(-wide[0], height), (wide[1], height), (draw(-1.0, 1.0), high)]
        corner = [(0.0, height), (wide[0], high), (-wide[1], high)]
        for shadow in (edge, corner):
            for k in range(3):
                corners = seen_along(draw, shadow[k:] + shadow[:k])
                close("gap of a triangle beside the axis [m]", lesson.triangle_cylinder_gap(*corners, r, R),
                      height - R - r, ROUND_OFF, given=f"corners {corners}, r = {r}, R = {R}")
    for way in np.array([(1.0, 0.0), (0.0, -1.0), (-3.0, 4.0)]):
        # Whole numbers: the triangle's plane contains the axis, and all three y_i z_j − z_i y_j are exactly 0.
        shares = float(draw.whole(1, 4)) * np.array([1.0, 4.0, 2.0])
        corners = [np.array([draw(-3.0, 3.0), *(share * way)]) for share in shares]
        close("gap of a triangle whose plane contains the axis, which does not pass through it [m]",
              lesson.triangle_cylinder_gap(*corners, r, R), shares.min() * np.linalg.norm(way) - R - r, ROUND_OFF,
              f"corners {corners}, r = {r}, R = {R}")
    for e, k in itertools.product(directions(2), range(3)):              # the first edge is the nearest one
        up = np.array([-e[1], e[0]])
        corners = [np.append(draw(-3.0, 3.0), y) for y in np.roll([2.0 * up - 2.0 * e, 2.0 * up + e, 5.0 * up], k, 0)]
        close("gap of a triangle with an edge across the axis [m]", lesson.triangle_cylinder_gap(*corners, r, R),
              2.0 * np.linalg.norm(e) - R - r, ROUND_OFF, f"corners {corners}, r = {r}, R = {R}")
    a = np.array([0.0, height, 0.0])
    corners = a, a + np.array([draw(1.0, 3.0), 0.0, 0.0]), np.array([0.0, height + 1.0, draw(-1.0, 1.0)])
    close("gap of a triangle with an edge along the axis [m]", lesson.triangle_cylinder_gap(*corners, r, R),
          height - R - r, ROUND_OFF, given=f"corners {corners}")


@exercise("6.6", points=0.5,
          hint="the projection along x is a triangle: its distance from 0, minus R + r; 0 if the axis passes through")
def test_a_triangle_is_as_far_from_the_axis_as_its_shadow_is_from_the_origin(lesson, draw):
    """Brute force: non-negative least squares finds the point of the projection nearest to 0."""
    for size, _ in places(draw):
        r, R = size * draw(0.01, 0.5), size * draw(0.1, 1.0)
        corners = size * draw(-2.0, 2.0, (3, 3))
        obtuse, thin, beside = corners.copy(), corners.copy(), corners.copy()
        obtuse[2] = 0.5 * (corners[0] + corners[1]) + 0.1 * (corners[2] - corners[0])
        # seen edge-on
        thin[2] = corners[0] + draw(0.2, 0.8) * (corners[1] - corners[0]) + [size, 0.0, 0.0]
        beside[:, 1] += 3.0 * size
        shifted = corners[::-1] + np.array([0.0, 0.0, size])
        for x in (corners, obtuse, thin, beside, 0.1 * corners, shifted):
            gap = distance(x[:, 1:], np.zeros((1, 2))) - R - r
            got = lesson.triangle_cylinder_gap(*(row.copy() for row in x), r, R)
            close("gap over the size [-]", got / size, gap / size, KNOWN, f"corners {x.tolist()}, r = {r}, R = {R}")
    for _ in range(60):                              # corners on the axis, edges along or through it, parallel planes
        x, r, R = np.floor(draw.sparse(-3.0, 4.0, (3, 3))), draw.sparse(0.01, 0.5), draw.sparse(0.1, 1.0)
        gap = distance(x[:, 1:], np.zeros((1, 2))) - R - r
        close("gap of a triangle with some zeros [m]", lesson.triangle_cylinder_gap(*(row.copy() for row in x), r, R),
              gap, KNOWN, f"corners {x.tolist()}, r = {r}, R = {R}")


# ---------------------------------------------------------------------------------------------- narrow phase

def triangle(draw):
    """(corners, unit normal) of a triangle in a drawn plane, no angle below 0.4 rad."""
    rows, at, size = axes(draw, 3), draw(-3.0, 3.0, 3), draw(0.5, 3.0)
    flat = size * np.array([[0.0, 0.0], [1.0, 0.0], [draw(0.2, 0.8), draw(0.5, 1.0)]])
    return [at + u * rows[0] + w * rows[1] for u, w in flat], rows[2]


@exercise("6.7", points=0.25, hint="the foot point on the plane if it is inside; otherwise compare all three edges")
def test_the_nearest_point_of_a_triangle_is_inside_on_an_edge_or_a_corner(lesson, draw):
    """p = q + y has q as its nearest point exactly when y makes no acute angle with the triangle at q."""
    for side in (1.0, -1.0):
        corners, n = triangle(draw)
        up = side * draw(0.1, 2.0) * n
        share = draw(0.2, 1.0, 3)
        inside = share / share.sum() @ np.stack(corners)
        cases = [(inside + up, inside)]
        for k in range(3):
            a, b, c = (corners[(k + i) % 3] for i in range(3))
            on = a + draw(0.1, 0.9) * (b - a)
            out = np.cross(b - a, n)
            out = -out if out @ (c - a) > 0.0 else out
            away = -(b - a) / np.linalg.norm(b - a) - (c - a) / np.linalg.norm(c - a)
            cases += [(on + draw(0.1, 2.0) * out / np.linalg.norm(out) + up, on), (a + draw(0.1, 2.0) * away + up, a)]
        for p, q in cases:
            close("nearest point of the triangle [m]", lesson.closest_on_triangle(p, *corners), q, ROUND_OFF,
                  given=f"p = {p}, corners {corners}")


@exercise("6.7", points=0.25,
          hint="|N| ≤ DEGENERATE_AREA times the longest edge squared: BadInput; a small triangle is not flat")
def test_a_triangle_without_area_is_refused_and_a_small_one_is_not(lesson, draw):
    a, b, p = draw(-3.0, 3.0, 3), draw(-3.0, 3.0, 3), draw(-3.0, 3.0, 3)
    for c in (a + draw(0.2, 0.8) * (b - a), b.copy(), a + 1.5 * (b - a)):
        raises("three corners on one line", BadInput, lesson.closest_on_triangle, p, a, b, c)
    raises("three corners in one point", BadInput, lesson.closest_on_triangle, p, a, a.copy(), a.copy())
    small = 1e-6 * np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.3, 0.7, 0.0]])
    close("nearest point of a small triangle [m]", lesson.closest_on_triangle(np.array([3e-7, 2e-7, 0.5]), *small),
          [3e-7, 2e-7, 0.0], ROUND_OFF)
    for high in (1e-7, 1e-9):                                            # |N| is high: 1000 DEGENERATE_AREA or more
        needle = [np.array(corner) for corner in ((0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.5, high, 0.0))]
        p = np.array([draw(0.4, 0.6), 0.5 * high, draw(0.5, 2.0)])
        close("nearest point of a needle [m]", lesson.closest_on_triangle(p, *needle), [p[0], p[1], 0.0], ROUND_OFF,
              f"p = {p}, corners {needle}")


@exercise("6.7", points=0.25,
          hint="|N| ≤ DEGENERATE_AREA times the square of the longest of all three edges; |N| is twice the area")
def test_a_triangle_is_flat_by_its_area_over_its_longest_edge_squared(lesson, draw):
    """|N| is exact: one edge is along an axis. In units of its length, the longest edge is 1 or 2 long."""
    flat = 1e-12
    raises("three corners on one line", BadInput, lesson.closest_on_triangle, np.array([0.0, 0.0, 1.0]), np.zeros(3),
           np.array([1.0, 0.0, 0.0]), np.array([-1.0, 0.0, 0.0]))
    for size, (third, longest), turn in itertools.product(SIZES, ((0.5, 1.0), (-1.0, 2.0), (2.0, 2.0)), range(6)):
        for share in (1e-3, 0.7, 0.99, 1.0, 1.01, 1.2, 1e3):
            high = share * flat * longest**2
            corners = size * np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [third, high, 0.0]])
            corners = [corners[k] for k in list(itertools.permutations(range(3)))[turn]]
            p = size * np.array([draw(0.1, 0.4), 0.0, draw(0.5, 2.0)])
            if share <= 1.0:
                raises("a triangle as flat as DEGENERATE_AREA, or flatter", BadInput, lesson.closest_on_triangle, p,
                       *corners, naming=[0.5 * size * size * high])
            else:
                q = np.asarray(lesson.closest_on_triangle(p, *corners))
                close("nearest point of a needle, over its size [-]", q / size, [p[0] / size, 0.0, 0.0], 1e-8,
                      f"p = {p}, corners {corners}")


@exercise("6.7", points=0.25,
          hint="compare all three edges: near an obtuse corner p is outside two of them, and either may be nearer")
def test_no_point_of_a_triangle_is_nearer_be_it_acute_obtuse_or_a_needle(lesson, draw):
    for size, place in places(draw):
        # third corner, in units of the length of a b
        for flat in ((0.5, 0.9), (0.5, 0.1), (-1.0, 0.5), (2.0, 0.5), (0.5, 0.01)):
            rows, turn = axes(draw, 3), draw.whole(0, 2)
            corners = place + size * np.roll([[0.0, 0.0], [1.0, 0.0], flat], turn, axis=0) @ rows[:2]
            for p in place + size * (draw(-2.0, 3.0, (4, 2)) @ rows[:2] + draw(-0.2, 0.2, (4, 1)) * rows[2]):
                q = lesson.closest_on_triangle(p, *(row.copy() for row in corners))
                is_nearest("nearest point of the triangle", q, p, corners, size, f"p = {p}, corners {corners.tolist()}")
    right = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
    for x, turn in itertools.product((2.0**-12, 2.0**-20), range(3)):    # p is barely beyond one of the edges
        for p in np.array([[0.5, -x, 0.5], [-x, 0.5, 0.5], [0.5 + x, 0.5 + x, 0.5]]):
            q = lesson.closest_on_triangle(p, *np.roll(right, turn, axis=0))
            is_nearest("nearest point of the triangle", q, p, right, 1.0, f"p = {p}, corners {right.tolist()}")
    # p at the corners, the middles of the edges, inside and beyond, in the triangle's plane and above a point of it
    shares = np.array([*np.eye(3), *(1.0 - np.eye(3)) / 2.0, [0.25, 0.25, 0.5], [2.0, 0.0, -1.0], [1.5, 1.5, -2.0]])
    balanced = np.array([[[1, 1, 0], [0, 0, 1], [1, -1, 0]], [[1, -1, 0], [1, 1, 1], [1, 1, -2]]], float)
    for k, rows in enumerate([*frames(draw, 3), *balanced]):                # of balanced ones, n adds up to 0
        corners = np.array([[0.0, 0.0], [4.0, 0.0], [0.0, 4.0]]) @ rows[:2]
        corners = corners - shares[k] @ corners                          # one of them is the origin
        for q in shares @ corners:
            for p in (q, q + draw(-2.0, 2.0) * rows[2]):
                got = lesson.closest_on_triangle(p, *(row.copy() for row in corners))
                is_nearest("nearest point of a triangle with a right angle", got, p, corners, 4.0,
                           f"p = {p}, corners {corners.tolist()}")


@exercise("6.8", points=0.125,
          hint="rotate the centre into the box's axes with Rᵀ, clamp it there, and rotate the point back with R")
def test_a_ball_outside_is_nearest_to_the_clamped_point(lesson, draw):
    r = draw(0.1, 0.5)
    for beyond in ((1, 0, 0), (0, -1, 0), (0, 1, 1), (-1, 0, 1), (1, -1, 1)):
        box = lesson.Box(draw(-3.0, 3.0, 3), rotation(draw), draw(0.3, 2.0, 3))
        out = draw(0.2, 1.0, 3) * np.array(beyond)
        local = np.where(np.array(beyond) == 0, draw(-0.9, 0.9, 3), np.array(beyond)) * box.half
        q, away = box.x + box.R @ local, box.R @ out
        n, x = away / np.linalg.norm(away), q + away
        same_contact(lesson.ball_box(x, r, box), x - r * n, q, n,
                     np.linalg.norm(away) - r, 1e-11, f"x = {x}, r = {r}, {box}")


@exercise("6.8", points=0.0625,
          hint="inside, the least half_i − |y_i| determines the face; n points out of it, and p_b lies on it")
def test_a_ball_whose_centre_is_inside_leaves_by_the_nearest_face(lesson, draw):
    for axis in range(3):
        for sign in (1.0, -1.0):
            box = lesson.Box(draw(-3.0, 3.0, 3), rotation(draw), draw(1.0, 2.0, 3))
            r, depth = draw(0.1, 0.5), draw(0.1, 0.4)
            local = draw(-0.4, 0.4, 3)
            local[axis] = sign * (box.half[axis] - depth)
            n, x = sign * box.R[:, axis], box.x + box.R @ local
            same_contact(lesson.ball_box(x, r, box), x - r * n, x + depth * n,
                         n, -depth - r, 1e-11, f"x = {x}, r = {r}, {box}")
    for axis in range(3):
        middle = lesson.ball_box(box.x, r, lesson.Box(box.x, box.R, np.roll([1.0, 2.0, 3.0], axis)))
        close("n of a ball at the centre: along the axis of the shortest half, sign(0) = 1", middle.n,
              box.R[:, axis], 1e-11)
        close("gap of a ball at the centre [m]", middle.gap, -1.0 - r, 1e-11)
    cube = lesson.Box(np.zeros(3), np.eye(3), 0.5 * np.ones(3))
    for axis in range(3):
        for sign in (1.0, -1.0):
            n, off = sign * np.eye(3)[axis], np.array([0.25, 0.125, -0.25])
            for place in (0.5 - 1e-9, 0.5, 0.5 + 1e-9):
                x = np.where(np.arange(3) == axis, sign * place, off)
                given = f"x = {x}, on or beside a face of {cube}"
                same_contact(lesson.ball_box(x, r, cube), x - r * n,
                             x + (0.5 - place) * n, n, place - 0.5 - r, 1e-11, given)


@exercise("6.8", points=0.03125,
          hint="a centre is inside only if |y_i| ≤ half_i for all i, without a tolerance; t of the contact is 0")
def test_a_centre_barely_outside_an_edge_or_a_corner_is_not_inside(lesson, draw):
    """Powers of two: all differences are exact.  Ways out that add up to 0 are among them."""
    signs = np.array(list(itertools.product((0.0, 1.0, -1.0), repeat=3)))
    for beyond in signs[np.count_nonzero(signs, axis=1) > 1]:
        for size, out in itertools.product(SIZES, (2.0**-11, 2.0**-30)):
            cube, way = lesson.Box(np.zeros(3), np.eye(3), size * np.ones(3)), size * out * beyond
            x = size * np.where(beyond == 0.0, 0.25, beyond) + way
            n, gap, r = beyond / np.linalg.norm(beyond), np.linalg.norm(beyond) * out, draw(0.5, 1.5) * size
            c = lesson.ball_box(x, r, cube)
            given = f"x = {x}, r = {r}, {out} of the size outside an edge or a corner of {cube}"
            close("n of the contact: from b to a", c.n, n, 1e-11, given)
            close("gap, p_a and p_b of the contact over the size [-]", np.concatenate(([c.gap], c.p_a, c.p_b)) / size,
                  np.concatenate(([gap * size - r], x - r * n, x - way)) / size, 1e-11, given)
            close("t of the contact [s]: it is there at once", c.t, 0.0, 0.0, given)


@exercise("6.8", points=0.03125,
          hint="compare y and the clamped q in the box's axes: their difference is exactly 0 along two of them; "
               "x and p_b have round-off of their own")
def test_the_normal_of_a_centre_outside_a_face_by_round_off_is_that_of_the_face(lesson, draw):
    """Far from the origin a difference of places has 1e-14 m of round-off, a tenth of the way out."""
    for axis, sign in itertools.product(range(3), (1.0, -1.0)):
        box, r = lesson.Box(draw(50.0, 100.0, 3), rotation(draw), draw(0.3, 2.0, 3)), draw(0.1, 0.5)
        y = draw(-0.5, 0.5, 3) * box.half
        y[axis] = sign * (box.half[axis] + 1e-13)
        x = box.x + box.R @ y
        given = f"x = {x}, r = {r}, {box}, 1e-13 m outside a face"
        c = lesson.ball_box(x, r, box)
        close("n of the contact: that of the face", c.n, sign * box.R[:, axis], 1e-11, given)
        close("gap of the contact [m]", c.gap, -r, 1e-11, given)


def corners_of(box):
    """The eight corners (8, 3) of a box [m]."""
    signs = np.array([[i, j, k] for i in (-1.0, 1.0) for j in (-1.0, 1.0) for k in (-1.0, 1.0)])
    return box.x + signs * box.half @ box.R.T


# rotations by none, a third and a half turn, and by a quarter turn about z
AXIS_TURNS = np.stack([np.eye(3), np.roll(np.eye(3), 1, axis=0), np.diag([1.0, -1.0, -1.0]),
                       np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])])


def touches_box(lesson, x, r, box, size):
    """Check the contact of a ball and a box with the hull of the corners and its facets."""
    corners = corners_of(box)
    normals, offsets = facets(corners - box.x)
    depths, given = -((x - box.x) @ normals.T + offsets), f"x = {x}, r = {r}, {box}"
    c = lesson.ball_box(x, r, box)
    n = numbers("n", c.n, (3,), given)
    if np.any(np.abs(box.R.T @ (x - box.x)) > box.half):
        is_nearest("p_b of a ball outside", c.p_b, x, corners, size, given)
        expected = np.linalg.norm(x - c.p_b)
    else:
        expected = -depths.min()
        between("p_b of a ball inside: distance beyond the surface over the size [-]",
                ((c.p_b - box.x) @ normals.T + offsets).max() / size, -KNOWN, KNOWN, given)
        face = np.argmax(normals @ n)
        close("n of a ball inside: that of a face", n, normals[face], KNOWN, given)
        close("depth below that face, over the size [-]: the least", depths[face] / size, -expected / size, KNOWN,
              given)
    close("gap over the size [-]", c.gap / size, (expected - r) / size, KNOWN, given)
    close("p_a − p_b over the size: gap times n [-]", (np.asarray(c.p_a) - c.p_b) / size, c.gap * n / size, KNOWN,
          given)
    close("p_a over the size: x − r n [-]", (np.asarray(c.p_a) - x) / size, -r * n / size, KNOWN, given)


@exercise("6.8", points=0.25,
          hint="outside: the nearest point of the box; inside: the nearest of the six faces, the least half_i − |y_i|")
def test_a_ball_touches_a_cube_a_plank_or_a_rod_at_its_nearest_point_or_face(lesson, draw):
    """Brute force: the hull of the corners and its facets."""
    for size, place in places(draw):
        for half in ((1.0, 1.0, 1.0), (1.0, 0.05, 0.7), (0.1, 1.0, 0.08)):
            half, r = size * np.array(half) * draw(0.9, 1.1, 3), size * draw(0.01, 1.0)
            box = lesson.Box(place + size * draw(-1.0, 1.0, 3), rotation(draw), half)
            inside = draw(-0.95, 0.95, 3)
            for y in (inside, 1.1 * inside / np.abs(inside).max(), draw(1.1, 3.0, 3) * np.sign(inside),
                      inside * [1.0, 1.0, 0.0] + [0.0, 0.0, 2.0]):
                touches_box(lesson, box.x + box.R @ (y * box.half), r, box, size)
    for k in range(40):                              # whole numbers: exactly on faces, edges, corners and axes
        half, y = np.floor(draw(1.0, 3.0, 3)), np.floor(draw.sparse(-3.0, 4.0, 3))
        y = np.copysign(half, draw(-1.0, 1.0, 3)) if k % 5 == 0 else y
        at = -AXIS_TURNS[k % 4] @ y if k % 5 == 1 else np.floor(draw.sparse(-3.0, 4.0, 3))   # then x is the origin
        box = lesson.Box(at, AXIS_TURNS[k % 4].copy(), half)
        touches_box(lesson, box.x + box.R @ y, np.floor(draw.sparse(1.0, 3.0)), box, 1.0)


# ---------------------------------------------------------------------------------------------- broad phase

@exercise("6.9", points=0.5,
          hint="from the smaller of low and low + move to the larger of high and high + move, per coordinate")
def test_a_swept_box_holds_the_box_at_every_moment_and_no_more(lesson, draw):
    for d in (2, 3):
        low = draw(-3.0, 3.0, d)
        move = draw(0.5, 5.0, d) * np.resize([1.0, -1.0], d) * (2 * draw.whole(0, 1) - 1)       # of mixed signs
        high = low + draw(0.2, 2.0, d)
        for way in (move, np.zeros(d), *directions(d)):                  # some components add up to 0
            s = np.linspace(0.0, 1.0, 5)[:, None]
            got = lesson.swept_box(low, high, way)
            close("low corner of the swept box [m]", got[0], (low + s * way).min(axis=0), ROUND_OFF,
                  given=f"low {low}, high {high}, move {way}")
            close("high corner of the swept box [m]", got[1], (high + s * way).max(axis=0), ROUND_OFF,
                  given=f"low {low}, high {high}, move {way}")
    for d in (1, 1, 1, 2, 2, 2, 3, 3, 3):                                # boxes at the origin, flat ones and points
        at, move, none = draw.sparse(-3.0, 3.0, d), draw.sparse(-5.0, 5.0, d), np.zeros(d)
        for low, high in ((at, at + draw.sparse(0.2, 2.0, d)), (none, none), (-abs(move), none)):
            close("corners of the swept box [m]", np.stack(lesson.swept_box(low, high, move)),
                  [[min(a, a + way) for a, way in zip(low, move, strict=True)],
                   [max(a, a + way) for a, way in zip(high, move, strict=True)]], ROUND_OFF,
                  f"low {low}, high {high}, move {move}")


@exercise("6.9", points=0.5, hint="treat each coordinate separately: one may increase while another decreases or stays")
def test_a_swept_box_is_the_box_around_a_hundred_moments_whichever_way_it_goes(lesson, draw):
    s = np.linspace(0.0, 1.0, 101)[:, None]
    for d in (2, 3):
        for size, place in places(draw, d):
            for ways in np.stack(np.meshgrid(*[[-1.0, 0.0, 1.0]] * d), axis=-1).reshape(-1, d):
                low = place + size * draw(-3.0, 3.0, d)
                move = size * ways * 10.0 ** draw(-2.0, 1.0, d)
                high = low + size * 10.0 ** draw(-2.0, 1.0, d)
                got = lesson.swept_box(low, high, move)
                given = f"low {low}, high {high}, move {move}"
                around = np.stack(((low + s * move).min(axis=0), (high + s * move).max(axis=0)))
                close("corners of the swept box, minus those of the box, over the size [-]",
                      (np.stack(got) - (low, high)) / size, (around - (low, high)) / size, KNOWN, given)


def boxes(draw, n, d, wide):
    """n boxes with whole-number corners, so that some share a face, an edge or a corner exactly; some are flat."""
    low = np.floor(draw(0.0, wide, (n, d)))
    return low, low + np.floor(draw(0.0, 3.5, (n, d)))


def touching(low_a, high_a, low_b, high_b):
    """Index pairs (m, 2) of all boxes of a and b with a point in common, sorted."""
    return np.argwhere(np.all((low_a[:, None] <= high_b[None]) & (low_b[None] <= high_a[:, None]), axis=2))


def same_pairs(quantity, got, expected, given=""):
    """Compare pairs in any order."""
    got = np.asarray(got)
    if got.ndim != 2 or got.shape[1:] != (2,):
        raise NotYet(quantity, "an array of shape (m, 2)", f"shape {got.shape}", "", f"shape {got.shape}", given)
    if len(got) != len(expected):
        raise NotYet(quantity, f"{len(expected)} pairs", f"{len(got)} pairs", "none: exactly these",
                     "a different number of pairs", given, (got, expected))
    close(quantity, got[np.lexsort(got.T[::-1])], expected, 0.0, given)


@exercise("6.10", points=0.25, hint="every i and every j > i; a common face, edge or corner counts as touching")
def test_brute_force_finds_every_pair_once(lesson, draw):
    for n, d, wide in ((30, 2, 12.0), (30, 3, 6.0), (30, 1, 90.0), (240, 3, 12.0)):
        low, high = boxes(draw, n, d, wide)
        expected = touching(low, high, low, high)
        same_pairs("pairs that touch", lesson.all_pairs(low, high), expected[expected[:, 0] < expected[:, 1]],
                   given=f"{n} boxes in {d}D")
    far = 10.0 * np.arange(6.0).reshape(3, 2)
    same_pairs("pairs of boxes that are all apart", lesson.all_pairs(far, far + 1.0), np.zeros((0, 2)))
    raises("boxes that are inside out", BadInput, lesson.all_pairs, far + 1.0, far)
    raises("three lower and two upper corners", BadInput, lesson.all_pairs, far, far[:2] + 1.0)
    for k in range(6):
        one = np.arange(6).reshape(3, 2) == k
        for size in SIZES:
            raises("a box that is inside out in one coordinate", BadInput, lesson.all_pairs,
                   np.where(one, size, 0.0), np.zeros((3, 2)))
        for wrong in (np.nan, np.inf, -np.inf):
            raises("a box with an upper corner that is no finite number", BadInput, lesson.all_pairs, far,
                   np.where(one, wrong, far + 1.0))
            raises("a box with a lower corner that is no finite number", BadInput, lesson.all_pairs,
                   np.where(one, wrong, far), far + 1.0)


def crowds(draw, d):
    """(name, low, high) of sets of boxes: single, nested, tiny, flat, far away, identical, negative."""
    low, high = boxes(draw, 25, d, 8.0)
    middle, half = draw(-3.0, 3.0, d), np.arange(1.0, 13.0)[:, None] * draw(0.1, 1.0, d)
    flat = np.where(np.arange(d) == 0, low, high)
    return [("a single box", low[:1], high[:1]),
            ("two boxes that touch", low[:2], low[:2] + 8.0),
            ("two separate boxes", np.stack((low[0], low[0] + 9.0)), np.stack((low[0] + 1.0, low[0] + 10.0))),
            ("boxes one inside the other", middle - half, middle + half),
            ("tiny boxes", 2.0**-100 * low, 2.0**-100 * high),
            ("flat boxes", low, flat),
            ("boxes far away", low + 2.0**30, high + 2.0**30),
            ("identical boxes", 0.0 * low - 1.0, 0.0 * high + 1.0),
            ("points at the origin", 0.0 * low[:5], 0.0 * low[:5]),
            ("boxes with negative coordinates", low - 20.0, high - 20.0)]


@exercise("6.10", points=0.25,
          hint="loop from the first to the last box, also for one or two; a box inside another touches it")
def test_pairs_of_crowds_of_any_kind_are_those_of_the_definition(lesson, draw):
    for d in (1, 2, 3):
        for name, low, high in crowds(draw, d):
            expected = touching(low, high, low, high)
            same_pairs(f"pairs of {name}", lesson.all_pairs(low, high), expected[expected[:, 0] < expected[:, 1]],
                       f"low {low.tolist()}, high {high.tolist()}")


@exercise("6.11", points=0.25,
          hint="pair both children with the other node; for two leaves: touching_items(a, i, b, j, found)")
def test_two_trees_find_the_pairs_that_brute_force_finds(lesson, draw):
    for d, n, m, wide in ((2, 60, 25, 20.0), (3, 40, 90, 9.0), (3, 3, 70, 5.0)):
        a, b = boxes(draw, n, d, wide), boxes(draw, m, d, wide)
        trees = lesson.build_tree(*a), lesson.build_tree(*b)
        same_pairs("pairs (item of a, item of b)", lesson.find_intersections(*trees), touching(*a, *b),
                   given=f"{n} and {m} boxes in {d}D")
    itself = lesson.build_tree(*b)
    same_pairs("pairs of a tree and itself: (i, j), (j, i) and (i, i)", lesson.find_intersections(itself, itself),
               touching(*b, *b), given="70 boxes in 3D")
    expected = touching(*b, *b)
    same_pairs("result of tree_pairs", lesson.tree_pairs(*b), expected[expected[:, 0] < expected[:, 1]],
               given="70 boxes in 3D")
    apart = lesson.build_tree(a[0] + 100.0, a[1] + 100.0)
    same_pairs("pairs of trees that are apart", lesson.find_intersections(apart, trees[1]), np.zeros((0, 2)))


def displaced(lesson, tree, node, axis, beside):
    """A false tree: the box of one node is flat, and lies at `beside` along an axis [m]."""
    low, high = tree.low.copy(), tree.high.copy()
    low[node, axis] = high[node, axis] = beside
    return lesson.Tree(low, high, tree.child, tree.first, tree.held, tree.order, tree.item_low, tree.item_high)


@exercise("6.11", points=0.25,
          hint="test the boxes of every pair of nodes, leaves too, before you go on: that saves the work")
def test_nodes_that_do_not_touch_are_not_searched(lesson, draw):
    """In a false tree, the box of one node is barely beside the other tree. No item of that node may be found.

    Every node but the root takes its turn, as does each side of the other tree; of a tree of many nodes, a few do.
    """
    for d, n, m, wide, some in ((2, 50, 40, 9.0, 14), (3, 200, 20, 7.0, 6)):
        a, b = boxes(draw, n, d, wide), boxes(draw, m, d, wide)
        true, other = lesson.build_tree(*a), lesson.build_tree(*b)
        pairs, begin = touching(*a, *b), draw.whole(0, 2 * d - 1)
        for k, node in enumerate(np.linspace(true.child.max() + 1, 1, some).astype(int), begin):
            axis, side = k % d, (1.0, -1.0)[k // d % 2]
            beside = (other.high if side > 0.0 else other.low)[0, axis] + side * 2.0**-10
            lying = displaced(lesson, true, node, axis, beside)
            hidden = true.order[true.first[node]:true.first[node] + true.held[node]]
            seen = pairs[~np.isin(pairs[:, 0], hidden)]
            same_pairs("pairs, where the box of one node of tree a is beside tree b",
                       lesson.find_intersections(lying, other), seen, given=f"{n} and {m} boxes, node {node}")
            seen = seen[:, ::-1]
            same_pairs("pairs, where the box of one node of tree b is beside tree a",
                       lesson.find_intersections(other, lying), seen[np.lexsort(seen.T[::-1])],
                       given=f"{m} and {n} boxes, node {node}")


@exercise("6.11", points=0.25,
          hint="a tree may be a single leaf with child 0; compare half_perimeter only if neither node is a leaf")
def test_trees_of_crowds_of_any_kind_find_the_pairs_that_brute_force_finds(lesson, draw):
    for d in (1, 2, 3):
        for name, low, high in crowds(draw, d):
            size, centre = (high - low).max() + np.ptp(low), low.mean(axis=0)
            other_low = centre + size * draw(-0.6, 0.6, (20, d))
            other_high = other_low + 0.3 * size * draw(0.0, 1.0, (20, d))
            trees = lesson.build_tree(low, high), lesson.build_tree(other_low, other_high)
            expected = touching(low, high, other_low, other_high)
            given = f"low {low.tolist()}, high {high.tolist()}"
            same_pairs(f"pairs of {name} and twenty others", lesson.find_intersections(*trees), expected, given)
            single = lesson.build_tree(low[:1].copy(), high[:1].copy())
            same_pairs(f"pairs of {name} and the first of them", lesson.find_intersections(trees[0], single),
                       touching(low, high, low[:1], high[:1]), given)


def rods(draw, n, axis):
    """n rods along axis 0 or 1, far apart across it, each at one of forty heights.

    Few rods along 0 touch rods along 1, but all leaves of their trees do.
    """
    low = np.floor(draw(0.0, 40.0, (n, 3)))
    low[:, 1 - axis], low[:, axis] = 1e3 * draw(0.0, 1.0, n), 0.0
    high = low.copy()
    high[:, axis] = 1e3
    return low, high


@exercise("6.11", points=0.25,
          hint="continue until the list of pairs is empty: no fixed number of rounds is enough for every tree")
def test_trees_of_which_every_leaf_touches_every_other_are_searched_to_the_end(lesson, draw):
    """64 leaves against 128 give 16383 pairs of nodes."""
    a, b = rods(draw, 288, 0), rods(draw, 576, 1)
    got = lesson.find_intersections(lesson.build_tree(*a), lesson.build_tree(*b))
    same_pairs("pairs of rods along x and rods along y", got, touching(*a, *b), given="288 and 576 rods")


# ---------------------------------------------------------------------------------------------- separating axes

def polygon(draw, k):
    """A regular polygon, counter-clockwise, about a drawn centre: corners (k, 2), and the radius of its corners."""
    turn = draw(0.0, 2.0 * np.pi) + 2.0 * np.pi * np.arange(k) / k
    radius = draw(1.0, 2.0)
    return draw(-3.0, 3.0, 2) + radius * np.stack((np.cos(turn), np.sin(turn)), axis=1), radius


@exercise("6.12", points=0.25, hint="for each edge the least n · (b_j − a_i); of all edges the greatest of those")
def test_the_edge_that_separates_best_is_the_one_a_corner_points_at(lesson, draw):
    """Beside the middle of an edge, within a tenth of the size, every other edge gives a smaller gap."""
    for k in (3, 5, 6, 12, 25):
        a, radius = polygon(draw, k)
        for share in (draw(0.02, 0.08), -draw(0.02, 0.08)):
            i = draw.whole(0, k - 1)
            e = a[(i + 1) % k] - a[i]
            n, t = np.array([e[1], -e[0]]) / np.linalg.norm(e), e / np.linalg.norm(e)
            gap = share * radius
            tip = 0.5 * (a[i] + a[(i + 1) % k]) + gap * n
            b = np.stack((tip, tip + draw(0.5, 1.0) * n - 0.3 * t, tip + draw(1.1, 2.0) * n + 0.3 * t)[::-1])
            got = lesson.separating_edge(a, b)
            close("gap along the best separating edge [m]", got[0], gap, ROUND_OFF,
                  given=f"a = {a.tolist()}, b = {b.tolist()}")
            close("number of that edge", got[1], i, 0.0, given=f"a = {a.tolist()}, b = {b.tolist()}")


@exercise("6.12", points=0.25, hint="outward(a, i) refuses an edge of zero length: use it")
def test_an_edge_without_length_is_refused(lesson, draw):
    a, _ = polygon(draw, 4)
    gap, e = draw(0.1, 1.0), a[1] - a[0]
    width = np.linalg.norm(e)
    got = lesson.separating_edge(a, a + (width + gap) * np.array([e[1], -e[0]]) / width)
    close("gap between two squares beside each other [m]", got[0], gap, ROUND_OFF, given=f"a = {a.tolist()}")
    raises("a corner that is there twice", BadInput, lesson.separating_edge, np.stack((a[0], a[1], a[1], a[2])), a)


def shapes(draw):
    """Convex polygons of size 1 [m] around 0, counter-clockwise: random, obtuse, a needle, a square, regular."""
    turn, flat = 2.0 * np.pi * np.arange(7) / 7, axes(draw, 2)
    obtuse = np.array([[-0.5, 0.0], [0.5, 0.0], [draw(0.6, 0.8), 0.1]])
    square = np.array([[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]])
    needle = draw(-0.5, 0.5, (6, 2)) * [1.0, 0.05]
    regular = 0.5 * np.stack((np.cos(turn), np.sin(turn)), axis=1)
    return [outline(points) for points in (draw(-0.5, 0.5, (9, 2)), obtuse @ flat, needle @ flat, square, regular)]


def gaps_of_edges(a, b):
    """(k,) the least n_i · (b_j − a_i) of each edge i of a, computed for all edges and corners at once."""
    e = np.roll(a, -1, axis=0) - a
    n = np.stack((e[:, 1], -e[:, 0]), axis=1) / np.linalg.norm(e, axis=1, keepdims=True)
    return np.min(n @ b.T - np.sum(n * a, axis=1)[:, None], axis=1)


CORNER = np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]])


def best_edge(lesson, a, b, size, given):
    """The greatest gap of the edges of a, checked."""
    gaps = gaps_of_edges(a, b)
    gap, i = lesson.separating_edge(a, b)
    close("greatest gap of all edges over the size [-]", gap / size, gaps.max() / size, KNOWN, given)
    close("gap of the returned edge, over the size [-]", gaps[int(i)] / size, gaps.max() / size, KNOWN, given)
    return gap


def greatest_offset(a, b):
    """The greatest offset [m] of a facet of the hull of all differences of two bodies.

    The hull is that of both bodies beside 0.  A hundred sizes away, round-off of the coordinates turns the normal of a
    short facet by too much.
    """
    normals, offsets = facets(differences(a - a[0], b - b[0]))
    return (offsets - normals @ (a[0] - b[0])).max()


@exercise("6.12", points=0.5,
          hint="take the greatest gap of all edges: not the one nearest to zero, nor the first positive one")
def test_polygons_apart_overlapping_nested_and_far_away_are_separated_as_the_hull_of_all_differences_says(lesson, draw):
    """The facet of the hull of all differences with the greatest offset gives the best edge of both polygons."""
    for size, place in places(draw, 2):
        for apart in (0.0, draw(0.0, 0.3), draw(0.3, 1.0), draw(1.0, 1.5), 1e2):
            a, b = (shapes(draw)[draw.whole(0, 4)] for _ in range(2))
            b = b * (0.2 if draw.whole(0, 3) == 0 else 1.0) + apart * axes(draw, 2)[0]
            a, b = place + size * a, place + size * b
            given = f"a = {a.tolist()}, b = {b.tolist()}"
            found = [best_edge(lesson, *pair, size, given) for pair in ((a, b), (b, a))]
            close("greater gap of both polygons, over the size [-]: that of the hull of all differences",
                  max(found) / size, greatest_offset(a, b) / size, KNOWN, given)
    for _ in range(20):                                                  # whole numbers: common corners and edges
        a, b = (outline(np.append(np.floor(draw.sparse(-3.0, 4.0, (3, 2))), np.floor(draw(-3.0, 4.0, 2)) + CORNER, 0))
                for _ in range(2))
        for first, second in ((a, b), (b, a), (a, a), (a, a + 7.0 * CORNER[1])):
            best_edge(lesson, first, second, 1.0, f"a = {first.tolist()}, b = {second.tolist()}")
    many = [polygon(draw, k)[0] for k in (120, 150)]
    for turn in (0, 50, 100):                                            # what counts may be the last edge, or corner
        first, second = (np.roll(y, turn, axis=0) for y in many)
        best_edge(lesson, first, second, 1.0, f"a = {first.tolist()}, b = {second.tolist()}")


@exercise("6.13", points=0.125, hint="add the crossing y_i + s_i/(s_i − s_j)(y_j − y_i) where an edge changes sides")
def test_a_cut_polygon_has_the_corners_of_what_is_left(lesson, draw):
    """A rectangle with edges l and h: cut at f l, with one corner cut off, not cut, and cut away."""
    for d in (2, 3):
        rows = axes(draw, d)
        at = draw(-3.0, 3.0, d)
        (long, high), f = draw(1.0, 3.0, 2), draw(0.2, 0.8)
        local = lambda corners, at=at, rows=rows: at + np.array(corners) @ rows[:2]
        y = local([(0.0, 0.0), (long, 0.0), (long, high), (0.0, high)])
        level = f * long + float(at @ rows[0])
        slant = (rows[0] + rows[1]) / np.sqrt(2.0)
        off = f * min(long, high)
        left = local([(0, 0), (f * long, 0), (f * long, high), (0, high)])
        right = local([(f * long, 0), (long, 0), (long, high), (f * long, high)])
        corner = local([(0, 0), (off, 0), (0, off)])
        cuts = (("cut across", rows[0], level, left),
                ("cut from the other side", -rows[0], -level, right),
                ("with all but a corner cut off", slant, float(at @ slant) + off / np.sqrt(2.0), corner),
                ("that is not cut", rows[0], level + long, y),
                ("that is cut away", rows[0], level - long, np.zeros((0, d))))
        for name, n, offset, expected in cuts:
            got = numbers(f"corners of a rectangle {name} [m]", lesson.clip(y, n, offset), expected.shape,
                          given=f"y = {y.tolist()}, n = {n}, d = {offset}")
            best = min(range(max(1, len(expected))),
                       key=lambda k: np.abs(np.roll(got, k, axis=0) - expected).max(initial=0.0))
            close(f"corners of a rectangle {name}, in order [m]", np.roll(got, best, axis=0), expected, ROUND_OFF,
                  given=f"y = {y.tolist()}, n = {n}, d = {offset}")


@exercise("6.13", points=0.125,
          hint="a cut may add a corner, and a polygon may have any number: reserve space for all of them")
def test_a_polygon_of_many_corners_loses_one_and_gains_two(lesson, draw):
    """The cut passes through the midpoints of the two edges at the first corner."""
    for k in (3, 7, 9, 12, 15, 20, 40, 300):
        y, _ = polygon(draw, k)
        n = y[0] - y.mean(axis=0)
        n = n / np.linalg.norm(n)
        before, after = 0.5 * (y[0] + y[-1]), 0.5 * (y[0] + y[1])
        given = f"a regular polygon of {k} corners"
        got = numbers("remaining corners [m]", lesson.clip(y, n, float(n @ (0.5 * (before + after)))),
                      (k + 1, 2), given)
        expected = np.concatenate((after[None], y[1:], before[None]))
        first = np.argmin(np.abs(got - expected[0]).sum(axis=1))
        close("remaining corners, in order [m]", np.roll(got, -first, axis=0), expected, ROUND_OFF, given)


def corners_left(quantity, got, d, given):
    """got as rows of d numbers, for any number of corners."""
    return numbers(quantity, got, (len(got) if hasattr(got, "__len__") else 0, d), given)


@exercise("6.13", points=0.25, hint="a corner exactly on the plane, s_i = 0, stays and adds no crossing")
def test_a_corner_on_the_plane_is_kept_once(lesson, draw):
    for d in (2, 3):
        wide, high = float(draw.whole(1, 4)), float(draw.whole(1, 4))    # whole numbers: s is exactly 0
        y, n = np.zeros((4, d)), np.zeros(d)
        y[:, :2] = [(0.0, 0.0), (wide, 0.0), (wide, high), (0.0, high)]
        n[0] = 1.0
        close("corners of a rectangle that only touches the plane [m]", lesson.clip(y, n, wide), y, 0.0,
              given=f"y = {y.tolist()}")
        left = numbers("corners of a rectangle of which one edge remains [m]", lesson.clip(y, n, 0.0), (2, d),
                       given=f"y = {y.tolist()}")
        close("corners of a rectangle of which one edge remains, sorted by position [m]",
              left[np.argsort(left[:, 1])], y[[0, 3]], 0.0, given=f"y = {y.tolist()}")
        for least in (wide * 2.0**-30, wide * 2.0**-45):                 # a sliver is cut off, or left
            for cut, first, last in ((wide - least, 0.0, wide - least), (least, 0.0, least)):
                corners = y.copy()
                corners[:, 0] = np.where(y[:, 0] > 0.0, last, first)
                given = f"y = {y.tolist()}, n = {n}, d = {cut}"
                left = numbers("corners of what a cut near an edge leaves [m]", lesson.clip(y, n, cut), (4, d), given)
                close("corners of what a cut near an edge leaves, over its width [m]", left[:, 0] / last,
                      corners[:, 0] / last, ROUND_OFF, given)
        for place, k, sign in itertools.product((0.0, 3.0), range(d), (1.0, -1.0)):
            e, aside, rows = sign * np.eye(d)[k], np.eye(d)[k - 1], [place * np.ones(d)] * 4
            y, level = np.stack(rows) + np.array([-e, -aside, e, aside]) * wide, sign * place
            cuts = (("that touches the plane by a corner", y, level - wide, [0]),
                    ("cut through two corners", y, level, [0, 1, 3]), ("in the plane", y[[1, 3, 1]], level, [0, 1, 2]),
                    ("segment in the plane", y[[1, 3]], level, [0, 1]), ("point in the plane", y[1:2], level, [0]),
                    ("point at the foot", 0.5 * (y[1:2] + y[3:]), level, [0]),
                    ("segment that ends at the plane", y[[0, 1]], level, [0, 1]),
                    ("segment that begins at the plane", y[[1, 2]], level, [0]))
            for name, shape, offset, kept in cuts:
                given = f"y = {shape.tolist()}, n = {e}, d = {offset}"
                left = numbers(f"corners of a {name} [m]", lesson.clip(shape, e, offset), (len(kept), d), given)
                close(f"corners of a {name}, sorted [m]", left[np.lexsort(left.T)],
                      shape[kept][np.lexsort(shape[kept].T)], 0.0, given)


@exercise("6.13", points=0.25, hint="a segment has one edge: do not return from its second corner to its first")
def test_a_cut_segment_keeps_two_ends(lesson, draw):
    for d in (2, 3):
        rows, a, f = axes(draw, d), draw(-3.0, 3.0, d), draw(0.2, 0.8)
        b = a + draw(1.0, 3.0) * rows[0] + draw(-0.5, 0.5) * rows[1]
        middle = a + f * (b - a)
        for n, first, second in ((rows[0], a, middle), (-rows[0], middle, b)):
            got = numbers("ends of a cut segment [m]", lesson.clip(np.stack((a, b)), n, float(n @ middle)), (2, d),
                          given=f"{a} to {b}")
            close("ends of a cut segment, in its order [m]", got, [first, second], ROUND_OFF, given=f"{a} to {b}")
        for e, side in itertools.product(directions(d), (1.0, -1.0)):    # some components add up to 0
            begin, on, end = np.floor(draw(-4.0, 4.0, d)) + np.array([-e, 0.0 * e, 3.0 * e])
            n = side * e / np.linalg.norm(e)
            close("ends of a cut segment, in its order [m]", lesson.clip(np.stack((begin, end)), n, float(n @ on)),
                  [begin, on] if side > 0.0 else [on, end], ROUND_OFF, f"{begin} to {end}, n = {n}")
        close("a segment that is not cut [m]", lesson.clip(np.stack((a, b)), rows[0], float(rows[0] @ b) + 1.0),
              [a, b], 0.0)
        level = float(rows[0] @ a)
        for y, offset, rows_left in ((np.zeros((0, d)), 1.0, 0), (a[None], level + 1.0, 1), (a[None], level - 1.0, 0)):
            close(f"what remains of {len(y)} corners [m]", lesson.clip(y.copy(), rows[0], offset), y[:rows_left], 0.0,
                  f"y of shape {y.shape}")


@exercise("6.13", points=0.25,
          hint="the two parts on both sides of the plane together must be the whole polygon")
def test_what_two_opposite_cuts_leave_makes_up_the_polygon(lesson, draw):
    """Each part lies in the polygon and on its own side. If both areas add up to the polygon's, nothing is missing."""
    for d in (2, 3):
        for size, place in places(draw, d):
            rows = axes(draw, d)
            for flat in shapes(draw):
                y = place + size * flat @ rows[:2]
                direction = draw(0.0, 2.0 * np.pi)
                n = np.cos(direction) * rows[0] + np.sin(direction) * rows[1]
                across = float(n @ place + size * draw(-0.5, 0.5))
                tip = float((y @ n).max() - 2e-4 * size)                 # a cut here removes almost nothing
                total = 0.0
                offset = tip if draw.whole(0, 2) == 0 else across
                given = f"y = {y.tolist()}, n = {n}, d = {offset}"
                for side in (1.0, -1.0):
                    got = lesson.clip(y, side * n, side * offset)
                    left = corners_left("remaining corners [m]", got, d, given)
                    seen = (left - place) @ rows[:2].T / size
                    for corner in seen:
                        between("remaining corner: distance from the polygon over the size [-]",
                                distance(corner[None], flat), 0.0, KNOWN, given)
                    between("remaining corner: distance beyond the cut over the size [-]",
                            max(side * (left @ n - offset) / size, default=0.0), -10.0, KNOWN, given)
                    total += area(seen)
                close("areas of both parts over that of the polygon [-]", total / area(flat), 1.0, 100.0 * KNOWN, given)


def turned(axis, angle):
    """The rotation about coordinate axis 0, 1 or 2."""
    c, s, R = np.cos(angle), np.sin(angle), np.eye(3)
    i, j = (axis + 1) % 3, (axis + 2) % 3
    R[i, i], R[i, j], R[j, i], R[j, j] = c, -s, s, c
    return R


@exercise("6.14", points=0.25, hint="|r · axis| minus both half_widths; the greatest of all axes; n from b to a")
def test_boxes_are_as_far_apart_as_their_nearest_corner_and_face_or_edges(lesson, draw):
    """A corner above a face, or edge across edge: the distance along that axis is exact, and no axis can give more."""
    Q = rotation(draw)
    a_half, b_half = draw(1.0, 2.0, 3), draw(0.5, 0.8, 3)
    tilted = turned(0, draw(0.55, 0.8)) @ turned(1, draw(0.5, 0.7))      # one corner of b is by far the lowest
    for gap in (draw(0.05, 0.5), -draw(0.005, 0.02)):
        for axis, sign in ((0, 1.0), (2, -1.0)):
            n_local = np.roll(np.array([0.0, 0.0, sign]), axis - 2)
            R_b = np.roll(tilted, axis - 2, axis=0)
            corners = np.array([[i, j, k] for i in (-1, 1) for j in (-1, 1) for k in (-1, 1)]) * b_half @ R_b.T
            tip = corners[np.argmin(corners @ n_local)]
            at = (a_half[axis] + gap) * n_local - tip                    # the corner is above the middle of the face
            a = lesson.Box(draw(-3.0, 3.0, 3), Q, a_half)
            b = lesson.Box(a.x + Q @ at, Q @ R_b, b_half)
            for first, second, way, number in ((a, b, -1.0, axis), (b, a, 1.0, 3 + axis)):
                got = lesson.box_separation(first, second)
                close("gap of a corner above a face [m]", got[0], gap, ROUND_OFF, given=f"{first}, {second}")
                close("normal of a corner above a face, from b to a", got[1], way * Q @ n_local, ROUND_OFF,
                      given=f"{first}, {second}")
                close("number of the separating axis", got[2], number, 0.0, given=f"{first}, {second}")


@exercise("6.14", points=0.25,
          hint="axes 6 to 14 are perpendicular to an edge of each box; parallel edges give a zero axis: skip it")
def test_two_edges_across_each_other_separate_and_equal_axes_leave_it_to_a_face(lesson, draw):
    Q, at, half = rotation(draw), draw(-3.0, 3.0, 3), draw(0.8, 1.5, 3)
    roll_a, roll_b, gap = draw(0.6, 0.9), draw(0.6, 0.9), draw(0.05, 0.5)
    # an edge of a along x on top, an edge of b along y at the bottom
    R_a, R_b = turned(0, roll_a), turned(1, roll_b)
    top = half[1] * np.sin(roll_a) + half[2] * np.cos(roll_a)
    low = half[0] * np.sin(roll_b) + half[2] * np.cos(roll_b)
    y_top = half[1] * np.cos(roll_a) - half[2] * np.sin(roll_a)
    x_low = -half[2] * np.sin(roll_b) + half[0] * np.cos(roll_b)
    for depth in (gap, -0.05 * gap):
        a = lesson.Box(at, Q @ R_a, half)
        # the lowest edge of b is above the middle of the highest edge of a
        b = lesson.Box(at + Q @ np.array([-x_low, y_top, top + low + depth]), Q @ R_b, half)
        got = lesson.box_separation(a, b)
        close("gap of two crossing edges [m]", got[0], depth, ROUND_OFF, given=f"{a}, {b}")
        close("normal of two crossing edges, from b to a", got[1], -Q[:, 2], 1e-11, given=f"{a}, {b}")
        close("number of the axis of two crossing edges: edge 0 of a, edge 1 of b", got[2], 7, 0.0, given=f"{a}, {b}")
    flush = lesson.Box(at, Q, half), lesson.Box(at + Q @ np.array([0.0, 0.0, 2.0 * half[2] + gap]), Q, half)
    got = lesson.box_separation(*flush)
    close("gap of two aligned boxes [m]", got[0], gap, ROUND_OFF, given=f"{flush}")
    close("number of the axis of two aligned boxes: the first of equal ones", got[2], 2, 0.0, given=f"{flush}")
    cube = lesson.Box(np.zeros(3), np.eye(3), np.ones(3))                # powers of two: all gaps are exact
    for k, lead in itertools.product((1, 2), (2.0**-35, 2.0**-50)):
        beside = cube._replace(x=3.0 * np.ones(3) + lead * np.eye(3)[k])
        close("number of the axis of the face that leads, by however little", lesson.box_separation(cube, beside)[2], k,
              0.0, given=f"{cube}, {beside}")


def gaps_of_axes(a, b):
    """(15,) gap of two boxes along each axis, from their corners, −∞ for a zero axis; and the axes (15, 3)."""
    across = np.cross(a.R.T[:, None], b.R.T[None]).reshape(9, 3)
    parallel = np.sum(across**2, axis=1) < 1e-12
    axes = np.concatenate((a.R.T, b.R.T, across / np.where(parallel, 1.0, np.linalg.norm(across, axis=1))[:, None]))
    p, q = (corners_of(a) - b.x) @ axes.T, (corners_of(b) - b.x) @ axes.T
    gaps = np.maximum(p.min(axis=0) - q.max(axis=0), q.min(axis=0) - p.max(axis=0))
    return np.where(np.concatenate((np.zeros(6, bool), parallel)), -np.inf, gaps), axes


def pairs_of_boxes(draw, lesson, size, place):
    """Boxes in general orientation, parallel, nested, side by side, flat, or far apart."""
    R, Q = rotation(draw), rotation(draw)
    quarter = np.ascontiguousarray(R[:, [1, 2, 0]])
    cube, plank, any_half = np.ones(3), np.array([1.0, 0.05, 0.5]), draw(0.3, 1.0, 3)
    cases = [(Q, cube, any_half, draw(0.5, 2.5)), (Q, any_half, plank, draw(0.2, 1.5)),
             (Q, plank, plank, draw(0.0, 0.5)),
             (Q, cube, 0.3 * cube, 0.0), (Q, cube, any_half, 1e3), (quarter, cube, any_half, draw(0.0, 3.0)),
             (R, cube, cube, draw(0.1, 1.0)), (R, any_half, plank, draw(0.0, 1.0)), (R, cube, 0.3 * any_half, 0.1),
             (R, any_half, any_half, 0.0), (R @ turned(2, 1e-8), cube, any_half, draw(0.1, 1.0)),
             (R @ turned(2, 1e-3), cube, any_half, 1.0)]
    for R_b, half_a, half_b, apart in cases:
        a = lesson.Box(place + size * apart * axes(draw, 3)[0], R, size * half_a)
        yield a, lesson.Box(place, np.ascontiguousarray(R_b), size * half_b)
    for high in (0.002, -0.002, 1e-6, -1e-6):                            # plates side by side, one barely the higher
        plate = size * np.array([2.0, 2.0, 0.05])
        yield (lesson.Box(place + size * R @ [draw(0.3, 0.6), draw(-0.6, 0.6), high], R, plate),
               lesson.Box(place, R @ turned(2, draw(0.3, 1.2)), plate))
    for k in range(15 if size == 1.0 else 0):                            # far apart along each axis, the best one
        turns = ((R, Q), (np.eye(3), Q), (R, np.eye(3)))[k % 3]
        a, b = lesson.Box(place, turns[0], cube), lesson.Box(place, turns[1], any_half)
        yield a._replace(x=place + 30.0 * gaps_of_axes(a, b)[1][k]), b


def longest_half_edge(a, b):
    """The longest half edge [m] of two boxes."""
    return max(a.half.max(), b.half.max())


def between_axes(draw, lesson, share):
    """Boxes 30 m apart, and the better two of their axes i < j: j belongs to edges and leads by this share of what it
    must lead by.

    Along an axis the gap is 30 m |direction · axis| − widths.  The direction is found between axis i and axis j.
    """
    for k in range(4):                                                   # a is the longer one, then b
        a, b = (lesson.Box(np.zeros(3), rotation(draw), draw(0.3, 0.6, 3) * twice) for twice in (2 - k % 2, 1 + k % 2))
        widths, candidates = gaps_of_axes(a, b)                          # gaps of boxes in one place: minus both widths
        lead = share * EDGE_PREFERENCE * longest_half_edge(a, b)
        for i, j in ((i, j) for i, j in itertools.combinations(range(15), 2) if j >= 6):
            other = candidates[j] * np.copysign(1.0, candidates[i] @ candidates[j])
            low, high = 0.0, 1.0
            for _ in range(60):
                middle = 0.5 * (low + high)
                direction = (1.0 - middle) * candidates[i] + middle * other
                direction /= np.linalg.norm(direction)
                gaps = 30.0 * np.abs(candidates @ direction) + widths
                low, high = (middle, high) if gaps[j] - gaps[i] < lead else (low, middle)
            if max(np.delete(gaps, (i, j))) < gaps[i] - 1e-6 and abs(gaps[j] - gaps[i] - lead) < 1e-12:
                yield a._replace(x=30.0 * direction), b, i, j


@exercise("6.14", points=0.25,
          hint="two edges must win by EDGE_PREFERENCE times the longest half edge, over faces and over earlier edges")
def test_two_edges_win_only_by_a_billionth_of_the_size_of_the_boxes(lesson, draw):
    """The lead differs from what is required by 0.1 EDGE_PREFERENCE; round-off at 30 sizes is 1e-5 of that."""
    for share in (0.9, 1.1):
        for a, b, i, j in between_axes(draw, lesson, share):
            for size in SIZES:
                at_size = [lesson.Box(size * box.x, box.R, size * box.half) for box in (a, b)]
                close("number of the separating axis, where a later pair of edges leads by about EDGE_PREFERENCE",
                      lesson.box_separation(*at_size)[2], i if share < 1.0 else j, 0.0, given=f"{at_size}")


def well_separated(lesson, a, b, size):
    """Check the separating axis of two boxes with the gaps along all axes, and with the hull of all differences."""
    gap, n, k = lesson.box_separation(a, b)
    gaps, candidates = gaps_of_axes(a, b)
    given = f"{a}, {b}"
    known = KNOWN * (size + np.abs(a.x - b.x).max())
    lead = EDGE_PREFERENCE * longest_half_edge(a, b)
    close("error of the greatest gap over its uncertainty [-]",
          (gap - max(gaps[:6].max(), gaps[6:].max())) / max(known, lead), 0.0, 1.0 + KNOWN, given)
    between("gap minus the best gap of the faces [m]", gap - gaps[:6].max(), -known, np.inf, given)
    n, k = numbers("n", n, (3,), given), int(k)
    between("gap of the returned axis, minus the greatest [m]", gaps[k] - gap, -known, known, given)
    between("gain over all faces, if the returned axis belongs to two edges [m]",
            gaps[k] - gaps[:6].max() if k >= 6 else size, lead - known, np.inf, given)
    close("n · returned axis: parallel, with either sign [-]", np.abs(n @ candidates[k]), 1.0, KNOWN, given)
    close("size of n [-]", n @ n, 1.0, KNOWN, given)
    between("n · r: from b to a [m]", n @ (a.x - b.x), -known, np.inf, given)
    p, q = corners_of(a) - b.x, corners_of(b) - b.x
    hull = facets(differences(p, q) / size)[1].max() * size
    if hull <= 0.0:
        close("depth of overlapping boxes, minus that of the hull of all differences, over its uncertainty [-]",
              (gap - hull) / max(known, lead), 0.0, 1.0 + KNOWN, given)
    else:
        low = hull - max(known, lead)
        between("gap of separate boxes [m]", gap, low, distance(p, q) + known, given)


@exercise("6.14", points=0.25,
          hint="an axis of zeros gives a gap of 0, which is greater than the gap of overlapping boxes: skip it")
def test_boxes_turned_parallel_nested_and_far_apart_are_separated_by_the_best_of_their_axes(lesson, draw):
    """Overlapping boxes are as deep as the nearest facet of the hull of all differences is from 0.

    For separate boxes, the greatest offset of its facets is a lower bound of the gap, their distance an upper bound.
    """
    for size, place in places(draw):
        for a, b in pairs_of_boxes(draw, lesson, size, place):
            well_separated(lesson, a, b, size)
    for k in range(16):                                  # whole numbers: boxes that touch, that coincide, without turns
        a, b = (lesson.Box(np.floor(draw.sparse(-2.0, 3.0, 3)), AXIS_TURNS[j].copy(), np.floor(draw(1.0, 3.0, 3)))
                for j in (k % 4, k // 4))
        well_separated(lesson, a, b, 1.0)
    for k in range(3):                                   # an eighth of a turn: the components of b's axis i add up to 0
        i, j, R = (k + 1) % 3, (k + 2) % 3, np.eye(3)
        R[i, i], R[j, i], R[i, j], R[j, j] = np.sqrt(0.5) * np.array([1.0, -1.0, 1.0, 1.0])
        half = np.floor(draw(1.0, 3.0, (2, 3)))
        b = lesson.Box(np.floor(draw(-3.0, 3.0, 3)), R, half[0])
        for apart in (2.0, -9.0):
            a = lesson.Box(b.x + apart * R[:, i], np.eye(3), half[1])
            well_separated(lesson, a, b, 1.0)
            well_separated(lesson, b, a, 1.0)


# ---------------------------------------------------------------------------------------------- any two convex bodies

def holds(quantity, p, points, given=""):
    """p is in the hull of the points."""
    p = numbers(quantity, p, (points.shape[1],), given)
    between(quantity + ": distance from its body [m]", distance(p[None], points), 0.0, 1e-9, given)


def spiral(count):
    """Points (count, 3) on the unit sphere, evenly distributed on a spiral from pole to pole."""
    k = np.arange(count) + 0.5
    z, phi = 1.0 - 2.0 * k / count, k * np.pi * (3.0 - np.sqrt(5.0))
    return np.stack((np.sqrt(1.0 - z * z) * np.cos(phi), np.sqrt(1.0 - z * z) * np.sin(phi), z), axis=1)


@exercise("6.15", points=0.25,
          hint="v = weights @ (p − q); support of a along −v, of b along v; stop, "
               "or add the new pair and keep the pairs that matter")
def test_the_distance_of_two_bodies_is_proved_by_two_points_and_a_plane(lesson, draw):
    """Two points of the bodies prove an upper bound of the distance, and a slab between the bodies a lower bound."""
    for d, k, m in ((2, 5, 7), (3, 8, 6), (3, 1, 9), (3, 20, 20)):
        way = axes(draw, d)[0]
        a, b = draw(-1.0, 1.0, (k, d)), draw(-1.0, 1.0, (m, d)) + draw(2.5, 6.0) * way * np.sqrt(d)
        c = lesson.gjk(a, b)
        given = f"a = {a.tolist()}, b = {b.tolist()}"
        holds("p_a", c.p_a, a, given)
        holds("p_b", c.p_b, b, given)
        close("p_a − p_b − gap n [m]", np.asarray(c.p_a) - c.p_b - c.gap * np.asarray(c.n),
              np.zeros(d), ROUND_OFF, given)
        close("width of the slab across n between the bodies [m]", (a @ c.n).min() - (b @ c.n).max(),
              c.gap, 1e-11, given)
    for _ in range(3):                                                   # most of these take seven steps or more
        round_ones = draw(-1.0, 1.0, (2, 400, 3))
        a, b = round_ones / np.linalg.norm(round_ones, axis=2, keepdims=True)
        a = a + 2.5 * axes(draw, 3)[0]
        c = lesson.gjk(a, b)
        close("width of the slab between two balls of 400 corners [m]", (a @ c.n).min() - (b @ c.n).max(), c.gap, 1e-11,
              given="centres 2.5 m apart")
    for count, centre in ((600, (1.1, 0.6, -0.6)), (200, (1.002, 0.6, 0.4))):    # these take more than twenty steps
        disc = spiral(count)
        a, b = disc * [0.001, 1.0, 1.0], disc * [1.0, 0.001, 1.0] + np.array(centre)
        c = lesson.gjk(a, b)
        close(f"width of the slab between two flat bodies of {count} corners [m]",
              (a @ c.n).min() - (b @ c.n).max(), c.gap, KNOWN, given="two ellipsoids with axes of 1 m, 1 m and 1 mm")


@exercise("6.15", points=0.25,
          hint="far_enough also detects overlap: v is then 0, and the search ends")
def test_bodies_that_overlap_have_no_distance_and_flat_ones_do_not_confuse(lesson, draw):
    for d in (2, 3):
        a = draw(-1.0, 1.0, (12, d)) + 0.0
        a[:2 * d] = np.concatenate((np.eye(d), -np.eye(d)))              # its hull contains the ball of 1/√3 about 0
        close("distance of bodies that overlap [m]", lesson.gjk(a, draw(-1.0, 1.0, (7, d)) * 0.2 + 0.05).gap,
              0.0, 1e-11, given=f"a = {a.tolist()}")
    rows, gap = axes(draw, 3), draw(0.2, 2.0)
    square = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
    a, b = square @ rows[:2], (square + np.array([1.0 + gap, 0.25])) @ rows[:2]
    close("distance of two squares in one plane [m]", lesson.gjk(a, b).gap, gap, 1e-11, given=f"gap {gap} m")
    close("distance of two squares face to face [m]", lesson.gjk(a, square @ rows[:2] + gap * rows[2]).gap, gap, 1e-11,
          given=f"gap {gap} m")
    close("distance of two squares with a common side [m]",
          lesson.gjk(a, (square + np.array([1.0, 0.0])) @ rows[:2]).gap, 0.0, 1e-11)
    raises("a body with a corner that is not a number", BadInput,
           lesson.gjk, a, np.where(np.arange(12).reshape(4, 3) == 11, np.nan, b))
    raises("bodies whose squared coordinates overflow", BadInput, lesson.gjk, 1e200 * a, 1e200 * b)
    for k, wrong in itertools.product((0, 5, 11), (np.nan, np.inf, -np.inf, 1e200)):
        one = np.arange(12).reshape(4, 3) == k
        raises("a body a with a corner that is no finite number, or too large", BadInput, lesson.gjk,
               np.where(one, wrong, a), b)
        raises("a body b with a corner that is no finite number, or too large", BadInput, lesson.gjk, a,
               np.where(one, wrong, b))
    raises("bodies whose squared coordinates underflow", BadInput, lesson.gjk, 1e-200 * a, 1e-200 * b)


def bodies(draw, d):
    """Points of bodies of size 1 [m] around 0: random, one point, on a line, in a plane, a cube, a needle."""
    cube = np.stack(np.meshgrid(*[[-0.5, 0.5]] * d), axis=-1).reshape(-1, d)
    line = draw(-0.5, 0.5, (5, 1)) * axes(draw, d)[0]
    plane = draw(-0.5, 0.5, (8, 2)) @ axes(draw, d)[:2]
    needle = draw(-0.5, 0.5, (9, d)) * np.linspace(1.0, 0.01, d)
    return [draw(-0.5, 0.5, (10, d)), draw(-0.5, 0.5, (1, d)), line, plane, cube, needle]


@exercise("6.15", points=0.5, hint="the nearest points need not be corners: keep pairs of corners, with weights")
def test_bodies_of_any_kind_are_as_far_apart_as_least_squares_over_all_differences_says(lesson, draw):
    for d in (2, 3):
        for size, place in places(draw, d):
            for apart in (0.0, draw(0.1, 0.8), draw(0.8, 2.0), 1e2):
                a, b = (bodies(draw, d)[draw.whole(0, 5)] for _ in range(2))
                a, b = place + size * a, place + size * (b + apart * axes(draw, d)[0])
                c = lesson.gjk(a, b)
                given = f"a = {a.tolist()}, b = {b.tolist()}"
                expected = distance(a, b) / size
                # |v|² has a round-off of 1e-16 size². For touching bodies the error of |v| is the root of that.
                close("distance over the size [-]", c.gap / size, expected, KNOWN if expected > 0.01 else 1e-8, given)
                close("p_a − p_b over the size: gap times n [-]", (np.asarray(c.p_a) - c.p_b) / size,
                      c.gap * np.asarray(c.n) / size, KNOWN, given)
    for d, k, m in itertools.product((1, 2, 3), (1, 2, 4), (1, 2, 3)):   # whole numbers: common points, points at 0
        one, other = np.floor(draw.sparse(-3.0, 4.0, (k, d))), np.floor(draw.sparse(-3.0, 4.0, (m, d)))
        for a, b in ((one, other), (one, one.copy()), (0.0 * one, other)):
            c, expected, given = lesson.gjk(a, b), distance(a, b), f"a = {a.tolist()}, b = {b.tolist()}"
            close("distance of bodies with whole-number corners [m]", c.gap, expected,
                  KNOWN if expected > 0.01 else 1e-8, given)
            holds("p_a", c.p_a, a, given)
            holds("p_b", c.p_b, b, given)
    for e in (e for d in (2, 3) for e in directions(d)):                 # the first difference has a 0, or adds up to 0
        a, b = np.floor(draw(-3.0, 4.0, (2, 4, len(e)))) + 0.0
        a[0], b[1:, 0] = b[0] + 3.0 * e, 9.0
        c, expected, given = lesson.gjk(a, b), distance(a, b), f"a = {a.tolist()}, b = {b.tolist()}"
        close("distance of bodies with whole-number corners [m]", c.gap, expected, KNOWN if expected > 0.01 else 1e-8,
              given)
        close("t of the contact [s]: it is there at once", c.t, 0.0, 0.0, given)


# ---------------------------------------------------------------------------------------------- avoidance

@exercise("6.16", points=0.5, hint="k (1/g − 1/reach)/g², away from the centre; zero for g ≥ reach")
def test_the_field_is_the_slope_of_its_potential(lesson, draw):
    """Integrate a over 2h by Simpson's rule, at a gap of 0.3 m or more.

    The relative error is h⁴ a⁗/(180 a) with a⁗ ≤ 1.4 · 360 a/g⁴ where g is least: 5.5e-9 for h = 2e-3.
    """
    for d in (2, 3):
        centre = draw(-3.0, 3.0, d)
        radius, reach, k = draw(0.3, 1.0), draw(0.8, 2.0), draw(0.5, 2.0)
        way, g, h = axes(draw, d)[0], draw(0.3, 0.6), 2e-3
        field = [lesson.repulsion(centre + (radius + s) * way, centre, radius, reach, k) for s in (g - h, g, g + h)]
        near, here, far = (numbers("acceleration [m/s²]", a, (d,)) for a in field)
        before, after = (0.5 * k * (1.0 / s - 1.0 / reach) ** 2 for s in (g - h, g + h))
        given = f"gap {g} m, radius {radius} m, reach {reach} m, k = {k}"
        mean = (near + 4.0 * here + far) @ way / 6.0
        close("work over loss of potential [-]", mean * 2.0 * h / (before - after), 1.0, 1e-8, given)
        close("tangential component of the acceleration [m/s²]", here - (here @ way) * way, np.zeros(d), 1e-9, given)
        for beyond in (reach, draw(1.1, 3.0) * reach):
            got = lesson.repulsion(centre + (radius + beyond + 1e-9) * way, centre, radius, reach, k)
            close("acceleration out of reach [m/s²]", got, np.zeros(d), 0.0,
                  f"gap {beyond + 1e-9} m, radius {radius} m, reach {reach} m, k = {k}")


@exercise("6.16", points=0.5,
          hint="the field is undefined where the gap is zero or negative: raise BadInput with the gap")
def test_a_position_inside_an_obstacle_is_refused(lesson, draw):
    centre, radius, gap = draw(-3.0, 3.0, 2), draw(0.3, 1.0), draw(0.3, 0.6)
    way = axes(draw, 2)[0]
    # (1/g − 1)/g² < 26 m/s², and the error of g = |x − centre| − radius is 1e-15 of 0.3.
    close("acceleration outside [m/s²]", lesson.repulsion(centre + (radius + gap) * way, centre, radius, 1.0, 1.0),
          (1.0 / gap - 1.0) / gap**2 * way, 1e-11, given=f"gap {gap} m")
    # exact: sums of two powers of two; a radius of 0 is a point
    for size, e, wide in itertools.product(SIZES, (*np.eye(2), np.eye(3)[1], np.ones(1)), (2.0, 0.0, 2.0**-10)):
        corner, wide = size * np.array([2.0, 0.0, -1.0])[:len(e)], wide * size
        for k in (1.0, 0.0):
            raises("a position on the surface of an obstacle", BadInput,
                   lesson.repulsion, corner + wide * e, corner, wide, size, k)
        for near, k in ((0.5, 1.0), (0.5, 0.0), (2.0**-8, 2.0**-30), (2.0**-8, 2.0**30), (2.0**-20, 1.0),
                        (2.0**-40, 1.0), (1.0 - 2.0**-10, 1.0)):
            g, strength = near * size, (1.0 / near - 1.0) / near**2 / size**3
            for centre in (corner, 0.0 * corner, (wide + g) * e):
                got = lesson.repulsion(centre - (wide + g) * e, centre, wide, size, k)
                close("acceleration near the surface over (1/g − 1/reach)/g² [m⁴/s²]", np.asarray(got) / strength,
                      -k * e, ROUND_OFF * k, f"gap {g} m, radius {wide} m, reach {size} m, k = {k}, centre {centre}")
    for e in (e for d in (2, 3) for e in directions(d)):                 # some components add up to 0
        for x, centre in ((0.0 * e, -e), (e, 0.0 * e)):
            size = np.linalg.norm(e)
            close("acceleration at half the reach from the surface [m/s²]",
                  lesson.repulsion(x, centre, size - 0.5, 1.0, 2.0), 8.0 * e / size, 1e-11,
                  f"x = {x}, centre {centre}, gap 0.5 m, reach 1 m, k = 2")
    centre = draw(-3.0, 3.0, 2)
    for share in (0.0, *draw.within()):
        raises("a position inside the obstacle", BadInput,
               lesson.repulsion, centre + share * radius * axes(draw, 2)[0], centre, radius, 1.0, 1.0)


def nearest_on_the_way(x, v, a, centre, tau):
    """Least distance [m] from the centre until τ: in 2000 steps, and in 2000 steps around the nearest of their ends.

    It is too large by less than (τ |v|/2e6)²/distance, 1e-10 m.
    """
    def apart(t):
        return np.linalg.norm(x + t[:, None] * v + 0.5 * t[:, None] ** 2 * a - centre, axis=1)

    k = np.argmin(apart(np.linspace(0.0, tau, 2001)))
    return apart(tau / 2000.0 * np.linspace(max(0, k - 1), min(2000, k + 1), 2001)).min()


@exercise("6.17", points=0.5, hint="½ a τ² = radius − |y|, away from the side of the centre")
def test_the_steered_body_is_abreast_of_the_centre_at_the_radius_and_was_nearer_before(lesson, draw):
    for side, (from_origin, to_origin) in itertools.product((1.0, -1.0), ((0.0, 0.0), (1.0, 0.0), (1.0, 1.0))):
        rows = axes(draw, 2)
        x, speed, radius = draw(-3.0, 3.0, 2), draw(0.5, 3.0), draw(0.5, 2.0)
        tau, offset = draw(0.5, 3.0), side * draw(0.1, 0.9) * radius
        v = speed * rows[0]
        way = speed * tau * rows[0] + offset * rows[1]
        x = (1.0 - from_origin) * x - to_origin * way
        centre = x + way
        a = numbers("acceleration [m/s²]", lesson.steer(x, v, centre, radius, 4.0), (2,))
        given = f"x = {x}, v = {v}, centre {centre}, radius {radius}"
        close("component of the acceleration along v [m/s²]", a @ rows[0], 0.0, 1e-11, given)
        passed = x + tau * v + 0.5 * tau**2 * a
        close("position relative to the centre when passing it [m]", passed - centre,
              -np.sign(offset) * radius * rows[1], 1e-11, given)
        # The square of the distance at the time t of the path is least where its derivative, a cubic in t, is zero.
        size = 2.0 * (radius - abs(offset)) / tau**2
        cubic = np.poly([tau]) * speed**2, np.polymul([0.5 * size, 0.0, abs(offset)], [size, 0.0])
        roots = np.roots(np.polyadd(*cubic))
        least = min(np.hypot(speed * (t - tau), abs(offset) + 0.5 * size * t * t)
                    for t in roots[abs(roots.imag) < 1e-9].real if 0.0 < t < tau)
        nearest = nearest_on_the_way(x, v, a, centre, tau)
        close("closest approach to the centre on the way, over the radius [-]", nearest / radius, least / radius, 1e-7,
              given)
        between("the same: below 1, and no less than the speed before over the speed afterwards [-]", nearest / radius,
                1.0 / np.hypot(1.0, size * tau / speed), 1.0, given)


@exercise("6.17", points=0.25,
          hint="at rest all components of v are 0, and straight ahead all of y: test |v| and |y|, not a sum")
def test_a_body_whose_velocity_or_offset_adds_up_to_0_steers_like_any_other(lesson, draw):
    for v, tau, offset in itertools.product([*directions(2), np.ones(2)], range(1, 25), (0.5, -0.5)):
        left, x = np.array([-v[1], v[0]]), np.floor(draw(-9.0, 9.0, 2))
        centre, radius = x + tau * v + offset * left, np.linalg.norm(v)
        close("acceleration, times τ² over the radius [-]",
              np.asarray(lesson.steer(x, v, centre, radius, 40.0)) * tau**2 / radius, -2.0 * offset * left / radius,
              1e-11, f"x = {x}, v = {v}, centre {centre}, radius {radius}")


@exercise("6.17", points=0.25,
          hint="obstacle behind, too far ahead, far enough aside, or at rest: 0; straight ahead: turn left")
def test_nothing_swerves_without_need_and_head_on_it_turns_left(lesson, draw):
    rows = axes(draw, 2)
    x, speed, radius = draw(-3.0, 3.0, 2), draw(0.5, 3.0), draw(0.5, 2.0)
    v, left = speed * rows[0], np.array([-rows[0][1], rows[0][0]])
    off = lambda tau, offset: x + speed * tau * rows[0] + offset * rows[1]
    cases = {"an obstacle behind": (off(-1.0, 0.1), v), "an obstacle too far ahead": (off(5.0, 0.1), v),
             "an obstacle far enough aside": (off(1.0, 1.01 * radius), v), "a walker at rest": (off(1.0, 0.1), 0.0 * v),
             "a walker at rest at the centre": (x, 0.0 * v), "a walker at the centre": (x, v)}
    for name, (centre, velocity) in cases.items():
        close(f"acceleration for {name} [m/s²]", lesson.steer(x, velocity, centre, radius, 4.0),
              np.zeros(2), 0.0, given=f"x = {x}, v = {velocity}, centre {centre}")
    for offset in (0.0, 0.1):
        close("acceleration for a disc of radius 0 [m/s²]", lesson.steer(x, v, off(1.0, offset), 0.0, 4.0), np.zeros(2),
              0.0, given=f"x = {x}, v = {v}, centre {off(1.0, offset)}")
    for size, e in ((size, np.roll([turn, 0.0], k)) for size in SIZES for k in range(2) for turn in (1.0, -1.0)):
        # Sums of powers of two: the offset is exact.  Motions along the second axis start at the origin.
        x, v, left = abs(e[0]) * size * np.array([1.0, 2.0]), 2.0 * size * e, np.array([-e[1], e[0]])
        offsets = [0.0] + [s * part for k in (10, 20, 30) for part in (2.0**-k, 1.0 - 2.0**-k) for s in (1, -1)]
        for tau in (0.0, 4.0):                                           # 0 < τ < ahead: at both ends nothing happens
            close("acceleration exactly beside the centre, and exactly at the end of the time ahead [m/s²]",
                  lesson.steer(x, v, x + tau * v + 0.5 * size * left, size, 4.0), np.zeros(2), 0.0,
                  f"x = {x}, v = {v}, radius {size}, τ = {tau} s")
        for tau, part in itertools.product((2.0**-20, 0.25, 2.0, 64.0), (1.0, 0.5)):
            close("acceleration before the time ahead begins [m/s²]",
                  lesson.steer(x, v, x + tau * v, size, part * tau), np.zeros(2), 0.0,
                  f"x = {x}, v = {v}, radius {size}, heads for the centre, τ = {tau} s, ahead {part * tau} s")
        for tau, least in itertools.product((2.0**-20, 0.25, 2.0, 64.0), (0.0, 1e3, np.inf)):
            ahead = max(2.0 * tau, least)
            close("acceleration when heading for the centre, times τ² over the size [-]",
                  np.asarray(lesson.steer(x, v, x + tau * v, size, ahead)) / size * tau**2, 2.0 * left, 1e-12,
                  f"x = {x}, v = {v}, radius {size}, τ = {tau} s, ahead {ahead} s")
        for tau, offset in ((tau, offset) for tau in (2.0**-40, 2.0**-20, 2.0**-5, 0.25, 2.0) for offset in offsets):
            centre = x + tau * v + offset * size * left
            expected = 2.0 * (1.0 - abs(offset)) * (left if offset <= 0.0 else -left)
            close("acceleration when heading for the centre, or slightly beside it, times τ² over the size [-]",
                  np.asarray(lesson.steer(x, v, centre, size, 4.0)) / size * tau**2, expected, 1e-12,
                  f"x = {x}, v = {v}, radius {size}, passes {offset * size} to the right of the centre after {tau} s")


# ---------------------------------------------------------------------------------------------- why?

@exercise("6.18", points=1,
          hint="a ball is sent back only if a step ends inside the wall's reach, in front of its middle")
def test_the_predicted_share_gets_past_when_balls_are_thrown_at_every_phase(lesson, draw):
    phases = (np.arange(4000) + 0.5) / 4000
    radii = draw(0.02, 0.2, 5) * [1.0, 0.0, 1.0, 1e3, 1e-4]
    widths = draw(0.01, 0.1, 5) * [1.0, 1.0, 0.0, 1e3, 1e-4]
    for share, (r, w) in itertools.product(
            (draw(2.0, 4.0), draw(6.0, 12.0), draw(0.3, 0.7), draw(1.1, 1.5), draw(50.0, 90.0), 1e-3),
            zip(radii, widths, strict=True)):
        dt = draw(0.1, 1.0) * 10.0 ** -draw.whole(-2, 4)
        v = share * (r + 0.5 * w) / dt
        z = r + 0.5 * w + phases * v * dt                    # before the first step that may touch
        ahead = z - v * dt
        back = (ahead > 0.0) & (ahead < r + 0.5 * w)         # found in front of the middle at once, or a step later
        later = ahead - v * dt
        back |= (ahead >= r + 0.5 * w) & (later > 0.0)
        given = f"r = {r}, w = {w}, v = {v}, dt = {dt}"
        if share < 1.0:
            close("share that gets past if a step is shorter than r + w/2", lesson.share_past(r, w, v, dt), 0.0, 0.0,
                  given)
        else:                                                # 4000 phases count a share to half a phase at either end
            close("share that gets past", lesson.share_past(r, w, v, dt), 1.0 - np.mean(back), 1.0 / 4000, given)
    close("share of points that get past a plane", lesson.share_past(0.0, 0.0, v, dt), 1.0, 0.0)
    close("share that gets past if a step is as long as r + w/2", lesson.share_past(0.25, 0.5, 4.0, 0.125), 0.0, 0.0)


@exercise("6.19", points=1, hint="a force stops a body if its work up to the wall exceeds the kinetic energy")
def test_the_work_of_the_chosen_force_grows_without_bound(lesson):
    def unbounded(gap, force):
        """Towards the wall the work per octave of the gap, about force · gap, grows."""
        return bool(np.all(np.diff(force * gap)[:20] < 0.0))
    choice("the letter of the force that stops every body", lesson.barrier_is(),
           choices.where("collisions", "forces_against_a_wall", unbounded))


@exercise("6.20", points=1, hint="let all turn to the same side, or look ahead for who comes near and when")
def test_twelve_people_cross_a_circle_without_touching_and_arrive(lesson, draw):
    around = draw(0.0, 1.0) + 2.0 * np.pi * np.arange(12) / 12
    x, nearest, largest = 4.0 * np.stack((np.cos(around), np.sin(around)), axis=1), np.inf, 0.0
    goals, v = -x, np.zeros((12, 2))
    for _ in range(200):
        a = np.array([lesson.my_rule(i, x, v, goals) for i in range(12)])
        numbers("accelerations of all [m/s²]", a, (12, 2))
        largest = max(largest, np.linalg.norm(a, axis=1).max())
        v = v + 0.1 * a
        x = x + 0.1 * v
        nearest = min(nearest, (np.linalg.norm(x[:, None] - x, axis=2) + 9.0 * np.eye(12)).min())
    between("least distance of two people [m]", nearest, 0.5, np.inf)
    between("largest distance from a goal after 20 s [m]", np.linalg.norm(x - goals, axis=1).max(), 0.0, 0.3)
    between("largest acceleration [m/s²]", largest, 0.0, 5.0)
