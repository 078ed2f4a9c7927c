"""Limits of collision detection: lesson 6 at high speed, far away, at grazing angles, for deep overlap and flat bodies.

The experiments throw thousands of balls, or place bodies where floats are coarse.  None of them
compares a formula with itself.
"""

import numpy as np

from solutions import collisions as worked
from solutions.support.simplices import GJK_RELATIVE_GAP, far_enough
from solutions.support.trees import Tree, partition_at_median
from validate.engines.bullet import Bullet
from validate.reference.collisions import anew_steering, depth_of, held_steering, hull_nearest
from validate.reference.schemes import MIDPOINT, VERLET, step_of
from validate.stability.case import (
    DOTS,
    LINE,
    Picture,
    Worst,
    case,
    log_series,
    log_slope,
    random_law,
    refuses,
    relative,
    series,
)

from ..engines.products import PYBULLET

THROWN = 10_000              # balls, each at its own phase of a step
FEW = 60                     # balls in an engine
SPACING = 2.0**-52           # of floats around 1 [-]
RADIUS, WALL, STEP = 0.05, 0.01, 1.0 / 240.0                        # of the ball [m], of the wall [m], of time [s]
ROUND_OFF = 1e-12            # of numbers below 10 after a few hundred roundings


# ---------------------------------------------------------------------------------------------- tunnelling

def passed_discretely(lesson, speed, phases):
    """Return the fraction of balls that pass the wall |z| < WALL/2: missed at every step, or ejected behind it."""
    wall, passed = lesson.Box(np.zeros(3), np.eye(3), np.array([10.0, 10.0, 0.5 * WALL])), 0
    reach, move = RADIUS + 0.5 * WALL, speed * STEP
    for phase in phases:
        z = reach + phase * move  # at the end of the first step that comes within a step of the wall
        caught = False
        while z > -reach:
            z -= move
            contact = lesson.ball_box(np.array([0.1, 0.2, z]), RADIUS, wall)
            if contact.gap < 0.0:
                caught = contact.n[2] > 0.0
                break
        passed += not caught
    return passed / len(phases)


def passed_continuously(lesson, speed, phases):
    """Return the same fraction with the time of impact on the near side of the wall."""
    front, passed = lesson.Plane(np.array([0.0, 0.0, 1.0]), -0.5 * WALL), 0
    reach, move = RADIUS + 0.5 * WALL, np.array([0.0, 0.0, speed * STEP])
    for phase in phases:
        x = np.array([0.0, 0.0, reach]) + phase * move
        moment = lesson.plane_impact_time(0.0, STEP, x, x - move, RADIUS, front)
        where = x[2] - moment / STEP * move[2] if np.isfinite(moment) else np.inf
        passed += not (0.0 <= moment <= STEP and abs(where - reach) < ROUND_OFF * (1.0 + move[2]))
    return passed / len(phases)


def passed_bullet(speed, phases):
    """Return the same fraction in pybullet without continuous detection."""
    bullet = Bullet(STEP)
    pb = bullet.pb
    pb.setPhysicsEngineParameter(contactERP=0, contactSlop=0, restitutionVelocityThreshold=0)
    box = pb.createCollisionShape(pb.GEOM_BOX, halfExtents=[20.0, 10.0, 0.5 * WALL])
    wall = pb.createMultiBody(0.0, box, useMaximalCoordinates=1)
    pb.changeDynamics(wall, -1, restitution=1, contactProcessingThreshold=0)
    ball, balls = pb.createCollisionShape(pb.GEOM_SPHERE, radius=RADIUS), []
    for k, phase in enumerate(phases):
        place = [0.5 * k - 15.0, 0.0, RADIUS + 0.5 * WALL + phase * speed * STEP]
        body = pb.createMultiBody(1.0, ball, basePosition=place, useMaximalCoordinates=1)
        pb.changeDynamics(body, -1, linearDamping=0, angularDamping=0, restitution=1, contactProcessingThreshold=0)
        pb.resetBaseVelocity(body, [0.0, 0.0, -speed])
        balls.append(body)
    for _ in range(8):
        bullet.step()
    passed = np.mean([bullet.position(body)[2] < 0.0 for body in balls])
    bullet.close()
    return float(passed)


def share_missed(speed):
    """Return the fraction that passes: a ball is stopped only within R + w/2 of the middle, on the near side."""
    return np.maximum(0.0, 1.0 - (RADIUS + 0.5 * WALL) / (speed * STEP))


def phases(n):
    """Return n phases of a step on an even grid."""
    return (np.arange(n) + 0.5) / n


@case("tunnelling", "Tunnelling through a thin wall", compiled=False)
def tunnelling(lesson, check):
    """Compare the fraction of balls of radius R that pass a wall of thickness w at v h per step with theory.

    The end of the step is uniformly distributed over v h.  The ball is stopped if the step ends in front of the
    middle of the wall, within R + w/2 of it.  Behind the middle the nearest way out is the far side, and beyond the
    wall there is no
    overlap:  missed = 1 − (R + w/2)/(v h).  Phases on an even grid of N give that fraction to 1/N.  The continuous test
    misses none.
    """
    for speed in (15.0, 50.0, 1000.0):
        law, missed = share_missed(speed), passed_discretely(lesson, speed, phases(THROWN))
        check("The discrete test stops a ball only if a step ends within R + w/2 in front of the wall's middle; "
              "behind the middle the nearest way out is the far side. It misses the share 1 − (R + w/2)/(v h).",
              f"share of 10⁴ balls of {speed:g} m/s that get past a wall of 1 cm, discrete [-]",
              law=law, found=missed, within=1.0 / THROWN,
              saw=f"At {speed:g} m/s {100.0 * missed:.2f} % get past; theory gives {100.0 * law:.2f} %.")
    for speed in (50.0, 1e4):
        missed = passed_continuously(lesson, speed, phases(THROWN))
        check("The continuous test misses no ball at any speed.",
              f"share of 10⁴ balls of {speed:g} m/s that get past, continuous [-]", law=0.0, found=missed, within=0.0,
              saw=f"At {speed:g} m/s {round(THROWN * missed)} of 10⁴ get past the continuous test.")
    check.by(PYBULLET, "pybullet without continuous detection misses the same share.",
             "pybullet: share of 60 balls of 50 m/s that get past [-]", missed_by_pybullet)
    return shares_by_speed(lesson)


def missed_by_pybullet():
    """Return what share of balls gets past a wall in pybullet, for Checks.by."""
    missed = passed_bullet(50.0, phases(FEW))
    return {"law": share_missed(50.0), "found": missed, "within": 1.0 / FEW + 1e-9,
            "saw": f"In pybullet {100.0 * missed:.1f} % of 60 balls of 50 m/s get past."}


def shares_by_speed(lesson):
    """Draw the fraction of balls that pass as a function of their speed."""
    speeds, fine = np.array([14.0, 20.0, 30.0, 45.0, 70.0, 100.0]), np.linspace(10.0, 105.0, 100)
    some = phases(THROWN)[::50]
    drawn = [series("1 − (R + w/2)/(v h), theory", fine, share_missed(fine), LINE),
             series("discrete, measured", speeds, [passed_discretely(lesson, v, some) for v in speeds], DOTS),
             series("continuous, measured", speeds, [passed_continuously(lesson, v, some) for v in speeds], DOTS)]
    if PYBULLET.installed():
        drawn.append(series("pybullet, measured", speeds, [passed_bullet(v, phases(FEW)) for v in speeds], DOTS))
    return Picture(
        "Through a wall of 1 cm", "speed [m/s]", "share that gets past [-]", drawn,
        "A ball of 10 cm (R = 5 cm) can pass the middle of the wall within one step of 1/240 s from 13.2 m/s on, "
        "and is then ejected on the far side. From 26.4 m/s on the discrete test can miss it altogether. The "
        "continuous test lets none pass.")


# ---------------------------------------------------------------------------------------------- loss of digits

@case("far-from-origin", "Collisions far from the origin", compiled=False)
def far_from_origin(lesson, check):
    """Compare the error of GJK far from the origin with the rounding of the corners.

    At a distance D corners are rounded by at most ½ D 2⁻⁵².  GJK works with differences of corners, which are
    exact, so no other error grows: the error of the distance is ∝ D.  D is a power of 2, so the spacing grows with
    it.  The mean square over 64 places is known to 9 %, and the slope over 20 doublings to 0.02.
    """
    rng, beside = np.random.default_rng(61), np.array([2.0, 1.0, 0.5])
    bodies = [(rng.uniform(-0.5, 0.5, (8, 3)), rng.uniform(-0.5, 0.5, (8, 3)) + beside) for _ in range(64)]
    exact = [np.linalg.norm(np.subtract(*hull_nearest(a, b))) for a, b in bodies]
    away, place = 2.0 ** np.arange(11, 32, 4), np.array([0.7, -0.9, 0.6])
    gap = lambda a, b, shift: lesson.gjk(a + shift, b + shift).gap
    squares = lambda D: [(gap(a, b, D * place) - true) ** 2 for (a, b), true in zip(bodies, exact)]
    errors = np.array([np.sqrt(np.mean(squares(D))) for D in away])
    slope, worst = log_slope(away, errors), errors[-1] / (away[-1] * SPACING)
    check("Far from the origin only the rounding of the corners remains: the error grows in proportion to D.",
          "slope of log error over log D, 2 km to 2 million km [-]", law=1.0, found=slope, within=0.05,
          saw=f"The error of GJK's distance grows with the power {slope:.3f} of the distance.")
    check("The error stays below the spacing of floats there.",
          "error at 2 million km over the spacing there [-]", law=0.5, found=worst, within=0.5,
          saw=f"At 2 million km the distance is wrong by {worst:.2f} spacings of floats.")
    return Picture(
        "Distances far from the origin", "log₁₀ of D [m]", "log₁₀ of the error [m]",
        [log_series("½ spacing at D", away, 0.5 * SPACING * away, LINE),
         log_series("GJK, measured", away, errors, DOTS)],
        "Far from the origin the distance is as inaccurate as the coordinates, and no worse. Keep scenes near the "
        "origin.")


def by_school(y, w, rho):
    """Return the first root of |y + s w|² = ρ² from B² − A C and −B − √D, with their cancellation."""
    linear, quadratic = float(np.dot(y, w)), float(np.dot(w, w))
    under_the_root = linear**2 - quadratic * float(np.dot(y, y) - rho**2)
    return (-linear - np.sqrt(max(under_the_root, 0.0))) / quadratic


def grazing_error(root, delta, far):
    """Return the largest error [ρ] of the place of impact of balls from 16 directions.

    root(y, w) → fraction of the path.
    """
    errors = []
    for phi in np.linspace(0.1, 6.2, 16):
        e, across = np.array([np.cos(phi), np.sin(phi)]), np.array([-np.sin(phi), np.cos(phi)])
        y, w = -far * e + (1.0 - delta) * across, 2.0 * far * e
        errors.append(2.0 * far * root(y, w) - (far - np.sqrt(2.0 * delta - delta * delta)))
    return np.max(np.abs(errors))


@case("grazing-impact", "A grazing shot", compiled=False)
def grazing_impact(lesson, check):
    """Compare the error of a grazing impact with the rounding of the coordinates.

    A ball from L = 1000ρ passes the axis at (1 − δ)ρ and touches √(2δ − δ²)ρ before the nearest point.  Coordinates of
    size L are rounded by L 2⁻⁵³, so the offset b is known to twice that, and the root to b/√(ρ² − b²) times as much:
    2·10³·1.1e-16·ρ/√(2δ).  The textbook formula squares L first and knows ρ² − b² only to 10⁶·1.1e-16; at δ = 1e-10 no
    digit is left.
    """
    far = 1e3
    time = lambda y, w: lesson.cylinder_impact_time(0.0, 1.0, np.append(0.0, y), np.append(0.0, y + w), 0.25, 0.75)
    ours = lambda delta: grazing_error(time, delta, far)
    school = lambda delta: grazing_error(lambda y, w: by_school(y, w, 1.0), delta, far)
    limit = lambda delta: 4.0 * far * SPACING * (1.0 + 1.0 / np.sqrt(2.0 * delta))
    for delta in (1e-2, 1e-6, 1e-10):
        check("The place of a grazing impact is as accurate as the coordinates permit.",
              f"error of the place of impact, passing at (1 − {delta:g})ρ [ρ]",
              law=0.0, found=ours(delta), within=limit(delta),
              saw=f"At (1 − {delta:g})ρ the place of impact is wrong by {ours(delta):.1e}ρ; the rounding of the "
                  f"coordinates allows {limit(delta):.1e}ρ.")
    got = school(1e-10)
    check("The textbook formula loses every digit: its error is √(2δ)ρ within a factor of ten, as large as the "
          "result.", "log₁₀ of its error at δ = 1e-10 over √(2δ)ρ [-]",
          law=0.0, found=np.log10(max(got, 1e-300) / np.sqrt(2e-10)), within=1.0,
          saw=f"At δ = 1e-10 the textbook formula is wrong by {got:.1e}ρ of 1.4e-05ρ.")
    deltas = 10.0 ** -np.arange(2.0, 12.0)
    return Picture(
        "A grazing shot from 1000ρ", "log₁₀ of δ", "log₁₀ of the error [ρ]",
        [log_series("rounding of the coordinates", deltas, limit(deltas), LINE),
         log_series("C/(√D − B), measured", deltas, [max(ours(d), 1e-17) for d in deltas], DOTS),
         log_series("textbook formula, measured", deltas, [max(school(d), 1e-17) for d in deltas], DOTS)],
        "The same equation in two forms: one keeps the digits of the coordinates, the other squares a "
        "distance of a thousand radii and loses three more.")


# ---------------------------------------------------------------------------------------------- deep, and flat

HALF = np.array([0.6, 0.4, 0.5])             # edges of a box, halved [m]


@case("deep-overlap", "Deep overlap", compiled=False)
def deep_overlap(lesson, check):
    """Check that the depth inside a box is at most its smallest half edge, and that there is always a unit normal.

    The depth at y is min_i (half_i − |y_i|), at most the smallest half edge (in the middle).
    """
    box = lesson.Box(np.array([0.3, -0.2, 0.5]), np.eye(3), HALF)
    axes = [np.linspace(-0.99, 0.99, 11) * h for h in HALF]
    grid = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
    contacts = [lesson.ball_box(box.x + y, 0.1, box) for y in grid]
    deepest = np.max([-c.gap - 0.1 for c in contacts])
    check("The depth inside a box is at most its smallest half edge.",
          "greatest depth of a centre in a box, on a grid [m]",
          law=HALF.min(), found=deepest, within=ROUND_OFF,
          saw=f"The deepest of {len(grid)} centres is {deepest:.3f} m from a face.")
    out = np.max([abs(np.max(np.abs(c.p_b - box.x) - HALF)) for c in contacts])
    check("The exit point is on the surface.", "greatest distance of p_b from the surface of the box [m]",
          law=0.0, found=out, within=ROUND_OFF, saw=f"All points p_b lie on the box, to {out:.0e} m.")
    for name, n in undefined_normals(lesson).items():
        check("Where all directions are equally good, one is chosen.", f"length of n for {name} [-]",
              law=1.0, found=np.linalg.norm(n), within=ROUND_OFF,
              saw=f"For {name} n has the length {np.linalg.norm(n):.15g}.")
    line = np.linspace(-0.55, 0.55, 45)
    depth = lambda s: -lesson.ball_box(box.x + np.array([s, 0.1, 0.0]), 0.1, box).gap - 0.1
    return Picture(
        "Out of a box of 1.2 × 0.8 × 1.0 m", "place along x, 0.1 m above the middle [m]", "depth [m]",
        [series("least distance to a face", line, np.minimum(0.3, 0.6 - np.abs(line)), LINE),
         series("ball_box, measured", line[::3], [depth(s) for s in line[::3]], DOTS)],
        "In the middle the nearest face is above; near an end it is that end. Where two faces are equally near, the "
        "normal jumps.")


def undefined_normals(lesson):
    """Return the normals {name: n} that the lesson gives where all directions are equally good."""
    x = np.array([0.7, -0.4, 0.2])
    box = lesson.Box(x, np.eye(3), HALF)
    return {
        "two balls with one centre": lesson.ball_contact(x, 0.3, x, 0.5).n,
        "a ball on the axis of a cylinder": lesson.cylinder_contact(np.array([0.7, 0.0, 0.0]), 0.1, 0.5).n,
        "a ball in the middle of a box": lesson.ball_box(x, 0.1, box).n,
        "two boxes with one centre": lesson.box_separation(box, box)[1],
    }


SQUARE = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], dtype=float)
NEEDLE = np.array([[-2, 0, 0], [2, 1e-6, 0], [2, 0, 1e-6], [2, -1e-6, -1e-6]], dtype=float)


def without_volume():
    """Return pairs of bodies without volume: {name: (corners, corners, distance)}."""
    x, y, z = np.eye(3)
    line, twice = np.linspace(0.0, 1.0, 5)[:, None], np.concatenate((SQUARE, SQUARE))
    across = NEEDLE[:, [1, 0, 2]] + 0.5 * z      # an edge of each is nearest, near the middle
    return {
        "two points": (np.zeros((1, 3)), 1.5 * x[None], 1.5),
        "two lines on one line": (line * x, 2.0 * x + line * x, 1.0),
        "two parallel lines": (line * x, 0.3 * y + line * x, 0.3),
        "two crossing lines": (line * x - 0.5 * x, 0.7 * z + line * y - 0.5 * y, 0.7),
        "two squares in one plane": (SQUARE, SQUARE + 1.4 * x, 0.4),
        "two squares face to face": (SQUARE, SQUARE + 0.2 * z, 0.2),
        "all corners twice": (twice, twice + 0.2 * z, 0.2),
        "two needles across": (NEEDLE, across, np.linalg.norm(np.subtract(*hull_nearest(NEEDLE, across)))),
    }


@case("degenerate-shapes", "Bodies without volume", compiled=False)
def degenerate_shapes(lesson, check):
    """Compare GJK on bodies without volume with known distances.

    The bodies are points, lines, flat bodies, bodies with doubled corners, and needles of 10⁻⁶.  GJK stops when the
    distance is known to 1e-14 of the size of the bodies, here below 10 m, and makes a few dozen rounding errors.
    """
    rng = np.random.default_rng(64)
    for name, (a, b, distance) in without_volume().items():
        R = np.linalg.qr(rng.normal(size=(3, 3)))[0]
        got = lesson.gjk(np.ascontiguousarray(a @ R.T), np.ascontiguousarray(b @ R.T)).gap
        check("GJK works for bodies without volume.", f"distance of {name} [m]",
              law=distance, found=got, within=ROUND_OFF, saw=f"GJK finds {got:.12g} m between {name}.")
    gaps, x, z = 10.0 ** -np.arange(0.0, 13.0, 2.0), np.array([1.0, 0.0, 0.0]), np.array([0.0, 0.0, 1.0])
    got = np.array([lesson.gjk(SQUARE, SQUARE + g * z + 0.3 * x).gap for g in gaps])
    worst = np.max(np.abs(got - gaps))
    check("For two squares nearly in one plane the distance is known to round-off.",
          "greatest error for gaps from 1 m to 10⁻¹² m [m]", law=0.0, found=worst, within=1e-14 * 4.0,
          saw=f"For gaps down to 10⁻¹² m the error is at most {worst:.0e} m.")
    return Picture(
        "Two squares face to face", "log₁₀ of the gap [m]", "log₁₀ of the distance found [m]",
        [log_series("theory", gaps, gaps, LINE), log_series("GJK, measured", gaps, np.maximum(got, 1e-17), DOTS)],
        "Corner on corner and face on face, where many simplices are equally near: GJK tries every subset, so it "
        "misses none.")


# ---------------------------------------------------------------------------------------------- avoidance

def nearest_approach(lesson, closing, k, reach, steps=10_000):
    """Return the smallest gap [m] of two bodies that approach head-on at that speed [m/s], and that of theory.

    The run uses Verlet's method.
    """
    radius, turning = 0.1, 1.0 / (1.0 / reach + closing / np.sqrt(2.0 * k))
    p, dt = lesson.make_flock(radius, reach, k, 0.0, 0.0), 2e-3 * turning / closing
    half = 0.5 * (2.0 * radius + turning) + 4.0 * turning
    half = min(half, 0.5 * (2.0 * radius + reach))
    begin = 2.0 * half - 2.0 * radius                               # its potential energy there counts as well
    x = np.array([[-half, 0.0], [half, 0.0]])
    v = np.array([[0.5, 0.0], [-0.5, 0.0]]) * np.sqrt(closing**2 - 2.0 * k * (1.0 / begin - 1.0 / reach) ** 2)
    least, verlet = np.inf, step_of(VERLET)
    law = lambda t, x, v: lesson.flock_acceleration(t, x, v, p)
    for n in range(steps):
        x, v = verlet(law, n * dt, x, v, dt)
        gap = x[1, 0] - x[0, 0] - 2.0 * radius
        if gap > least:
            break
        least = gap
    return least, turning


def steered_past(lesson, distance, offset, anew, steps=4000):
    """Return the smallest distance from the centre of a disc of radius 1 m, and the last speed, of a body of 1 m/s.

    It begins at `distance` before the centre and would pass it at `offset`, both in m, if it did not steer.  It
    steers once and holds that acceleration until it is abreast of the centre, or steers anew in each step until it
    moves away from the centre.  Then the speed is that after the last step that turned it by less than 0.1 rad.
    """
    x, v, centre, dt = np.array([-distance, offset]), np.array([1.0, 0.0]), np.zeros(2), distance / steps
    law, midpoint = lambda t, x, v: lesson.steer(x, v, centre, 1.0, np.inf), step_of(MIDPOINT)
    if not anew:
        a, t = law(0.0, x, v), np.linspace(0.0, distance, steps + 1)[:, None]
        return np.linalg.norm(x + v * t + 0.5 * a * t * t, axis=1).min(), np.linalg.norm(v + a * distance)
    least, speed = np.linalg.norm(x), 1.0
    while x @ v < 0.0:
        if np.linalg.norm(law(0.0, x, v)) * dt < 0.1:
            speed = np.linalg.norm(v)
        x, v = midpoint(law, 0.0, x, v, dt)
        least = min(least, np.linalg.norm(x))
    return least, speed


STEERED = (4.0, 0.0), (4.0, 0.5), (1.5, 0.0), (1.5, 0.5)     # (distance, offset) of bodies past a disc of 1 m [m]


def steering_past_a_disc(lesson, check):
    """Compare a body that holds the acceleration of exercise 6.17, and one that computes it anew, with theory.

    Points on a path are dt = 1/4000 of the distance apart, so they miss the smallest distance by at most dt²/2; the
    midpoint method is of second order as well.  With A before the centre, A² < 2 (1 − B) dt, it turns by more than
    1 rad per step and is wrong.  From there on the distance B changes by A²/2 = (1 − B) dt.  A step that turns it
    by θ < 0.1 rad multiplies its speed by 1 + θ⁴/8; θ grows like 1/A², so all of them together have the effect of
    A/7dt < 13 of the last.
    """
    for distance, offset in STEERED:
        where, dt = f"from {distance:g} radii, offset {offset:g}", distance / 4000
        nearest, faster = held_steering(distance, offset)
        got, speed = steered_past(lesson, distance, offset, False)
        check("A body that holds the acceleration of its steering cuts into the disc before it is abreast.",
              f"closest approach over the radius, {where} [-]", law=nearest, found=got, within=dt**2,
              saw=f"Its closest approach is {got:.4f} radii.")
        check("It ends faster, because its acceleration is normal to its first velocity and not to the present one.",
              f"last speed over the first, {where} [-]", law=faster, found=speed, within=1e-12,
              saw=f"It ends at {speed:.4f} times its speed.")
        nearest = anew_steering(distance, offset)
        got, speed = steered_past(lesson, distance, offset, True)
        check("A body that computes its steering anew at every step comes too close as well, but less so.",
              f"closest approach over the radius, computed anew, {where} [-]",
              law=nearest, found=got, within=10.0 * dt**2 + (1.0 - nearest) * distance / 4000,
              saw=f"Its closest approach is {got:.6f} radii.")
        check("It keeps its speed, because its acceleration is always normal to its velocity.",
              f"speed over the first while steps resolve the turn, computed anew, {where} [-]",
              law=1.0, found=speed, within=2e-4,
              saw=f"As long as a step turns it by less than 0.1 rad, it has {speed:.6f} times its speed.")


@case("head-on-avoidance", "Avoidance head-on", compiled=False)
def head_on_avoidance(lesson, check):
    """Compare the gap at which two members of a flock turn back with  ¼ u² = ½ k (1/g − 1/reach)².

    They approach head-on with the closing speed u; each has the kinetic energy ½ (u/2)².  g = 1/(1/reach + u/√(2k)) is
    positive at any speed.  Verlet's energy error is (dt/τ)² = 4e-6 times a constant for the steepness of the potential,
    at most the fourth power: 4·5/2.  The gap follows the energy with a power below one.

    Steering has no potential, and does not stay outside its disc: see steering_past_a_disc.
    """
    steering_past_a_disc(lesson, check)
    k, reach = 1.0, 1.0
    for closing in (1.0, 10.0, 100.0):
        got, turning = nearest_approach(lesson, closing, k, reach)
        check("A potential that is infinite at contact turns every body back.",
              f"least gap at a closing speed of {closing:g} m/s [m]", law=turning, found=got, within=4e-5 * turning,
              saw=f"At a closing speed of {closing:g} m/s the two come within {got:.6f} m of each other; "
                  f"theory gives {turning:.6f} m.")
    speeds, fine = 10.0 ** np.linspace(-0.5, 2.0, 5), 10.0 ** np.linspace(-0.6, 2.1, 40)
    gaps = [nearest_approach(lesson, u, k, reach)[0] for u in speeds]
    return Picture(
        "Closest approach", "log₁₀ of the closing speed [m/s]", "log₁₀ of the least gap [m]",
        [log_series("1/(1/reach + u/√(2k)), theory", fine, 1.0 / (1.0 / reach + fine / np.sqrt(2.0 * k)), LINE),
         log_series("Verlet, measured", speeds, gaps, DOTS)],
        "Points never touch, but at high speed they come so close that the step must shrink with the gap. Avoidance "
        "does not replace detection.")


# ---------------------------------------------------------------------------------------------- bad input

def undefined(lesson):
    """Return calls that ask for what has no distance: {name: (function, arguments)}."""
    a, b, nan = np.zeros(3), np.ones(3), np.array([[0.0, np.nan]])
    x = np.array([1.0, 0.0, 0.0])
    flat = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 0.0], [0.0, 1.0]])
    flight = lesson.discrete_step, lesson.ball_plane_gap, lesson.ball_plane_time, 0.0, nan, nan, 0.1, 1, ()
    return {
        "a plane with no normal": (lesson.make_plane, ((0.0, 0.0, 0.0, 1.0),)),
        "a plane that is not a number": (lesson.make_plane, ((1.0, np.nan, 0.0, 1.0),)),
        "a segment without length": (lesson.closest_on_segment, (b, a, a)),
        "a capsule without length": (lesson.ball_capsule, (b, 0.1, a, a, 0.2)),
        "a triangle on a line": (lesson.closest_on_triangle, (b, a, x, 2.0 * x)),
        "a triangle in a point": (lesson.ball_triangle, (b, 0.1, a, a, a)),
        "a polygon with a corner twice": (lesson.polygon_contacts, (flat, flat)),
        "a box inside out": (lesson.build_tree, (np.ones((1, 2)), np.zeros((1, 2)))),
        "a box that is not a number": (lesson.tree_pairs, (nan, nan)),
        "no box at all": (lesson.build_tree, (np.zeros((0, 2)), np.zeros((0, 2)))),
        "a place inside an obstacle": (lesson.repulsion, (a, a, 0.5, 1.0, 1.0)),
        "a flight that is not a number": (lesson.advance_projectiles, flight),
        "a flock without reach": (lesson.make_flock, (0.1, 0.0, 1.0, 0.0, 0.0)),
    }


@case("undefined-distance", "Input without a defined distance", compiled=False)
def undefined_distance(lesson, check):
    """Check that input without a defined distance is refused: no area, no length, inverted, not a number, or empty."""
    for name, call in undefined(lesson).items():
        refused = refuses(*call)
        check("Bad input raises a typed error.", f"whether {name} is refused [-]", law=1.0, found=refused, within=0.0,
              saw=f"{name[0].upper() + name[1:]} is {'refused' if refused else 'accepted'}.")
    sizes, corner = 10.0 ** -np.arange(0.0, 12.0), np.zeros(3)
    height = lambda s: lesson.ball_triangle(np.array([0.2 * s, 0.2 * s, 1.0]), 0.25, corner, np.array([s, 0.0, 0.0]),
                                            np.array([0.0, s, 0.0])).gap
    return Picture(
        "A small triangle is not a flat one", "log₁₀ of the size of a triangle [m]", "gap of a ball above it [m]",
        [series("theory", np.log10(sizes), np.full(12, 0.75), LINE),
         series("ball_triangle, measured", np.log10(sizes), [height(s) for s in sizes], DOTS)],
        "A triangle is refused if its area is small for its size. A small triangle is measured like any other.")


# ---------------------------------------------------------------------------------------------- ways out

def inside(box, points):
    """Return the distance [m] from a box to the farthest of these points; negative if all are inside."""
    return np.max([np.max(np.abs(box.R.T @ (x - box.x)) - box.half) for x in points])


def corners_of(box):
    """Return the eight corners (8, 3) of a box."""
    signs = np.array([[i, j, k] for i in (-1.0, 1.0) for j in (-1.0, 1.0) for k in (-1.0, 1.0)])
    return box.x + signs * box.half @ box.R.T


def random_box(rng):
    """Return a box near the origin."""
    x = 0.8 * rng.uniform(-1.0, 1.0, 3)
    R = np.ascontiguousarray(np.linalg.qr(rng.normal(size=(3, 3)))[0])
    return worked.Box(x, R, rng.uniform(0.3, 1.0, 3))


def overlapping(rng, n):
    """Return n pairs of random boxes that overlap by up to about a quarter of their size."""
    pairs = []
    while len(pairs) < n:
        a, b = random_box(rng), random_box(rng)
        if depth_of(corners_of(a), corners_of(b))[0] < 0.0:
            pairs.append((a, b))
    return pairs


def ways_out(lesson, pairs):
    """Return (measured depths [m], true depths, the largest errors) of pairs of boxes that overlap."""
    worst = Worst()
    depths, true = [], []
    for a, b in pairs:
        gap, n, _ = lesson.box_separation(a, b)
        contacts, way = lesson.box_box(a, b), depth_of(corners_of(a), corners_of(b))[0]
        moved = a._replace(x=a.x - gap * n)
        depths.append(-gap)
        true.append(-way)
        worst.keep("depth", abs(gap - way))
        worst.keep("left", abs(lesson.box_separation(moved, b)[0]))
        if len(contacts.gap) == 0:
            worst.keep("outside", np.inf)
            continue
        worst.keep("outside", inside(a, contacts.p_a), inside(b, contacts.p_b))
        worst.keep("deepest", abs(contacts.gap.min() - gap))
        apart = contacts.p_a - contacts.p_b - contacts.gap[:, None] * contacts.n
        worst.keep("apart", np.max(np.abs(apart)))
    return np.array(depths), np.array(true), worst


def boxes_leave_by_the_shortest_way(check, worst):
    """Judge the largest errors of 100 pairs of boxes."""
    room = 2.0 * worked.EDGE_PREFERENCE
    check("The least overlap of 15 axes is the shortest way out.",
          "greatest error of the depth of 100 pairs of boxes [m]", law=0.0, found=worst["depth"], within=room,
          saw="The depth of 100 pairs of boxes equals that of the hull of their differences to "
              f"{worst['depth']:.0e} m.")
    check("Moved out by the gap along n, two boxes just touch.",
          "greatest overlap or gap left, of 100 pairs [m]", law=0.0, found=worst["left"], within=room,
          saw=f"Moved by the gap along n, 100 pairs are left with an overlap or gap of {worst['left']:.0e} m.")
    check("Points of contact lie on both bodies.",
          "distance of the farthest point of contact outside its box, or 0 [m]",
          law=0.0, found=worst["outside"], within=1e-11,
          saw=f"No point of contact of 100 pairs is more than {worst['outside']:.0e} m outside its box.")
    check("The deepest point of contact is as deep as the axis gives.",
          "greatest difference between the deepest contact and the axis [m]",
          law=0.0, found=worst["deepest"], within=1e-11,
          saw=f"The deepest point of contact of 100 pairs is as deep as the axis gives, to {worst['deepest']:.0e} m.")
    check("The two points of a contact are its gap apart, along n.",
          "greatest length of p_a − p_b − gap n, of 100 pairs [m]", law=0.0, found=worst["apart"], within=1e-11,
          saw=f"For 100 pairs p_a − p_b is gap n to {worst['apart']:.0e} m.")


def capsules_are_as_far_apart_as_their_segments(lesson, check, rng):
    """Compare 100 pairs of capsules with the nearest points of their segments."""
    errors = []
    for _ in range(100):
        x = rng.uniform(-1.0, 1.0, (4, 3))
        p, q = hull_nearest(x[:2], x[2:])
        gap = lesson.capsule_capsule(x[0], x[1], 0.1, x[2], x[3], 0.2).gap
        errors.append(abs(gap - (np.linalg.norm(p - q) - 0.3)))
    check("The gap of two capsules is the distance of their segments minus the radii.",
          "greatest error of the gap of 100 pairs of capsules [m]", law=0.0, found=np.max(errors), within=ROUND_OFF,
          saw=f"The gap of 100 pairs of capsules is right to {np.max(errors):.0e} m.")


def random_polygons(rng):
    """Return two convex polygons of five corners near the origin."""
    turns = [np.sort(rng.uniform(0.0, 1.2, 5)) + 1.25 * np.arange(5) for _ in range(2)]
    return [rng.uniform(-0.6, 0.6, 2) + np.stack((np.cos(t), np.sin(t)), axis=1) for t in turns]


def polygons_are_as_deep_as_their_differences(lesson, check, rng):
    """Compare 100 pairs of polygons with the hull of their differences."""
    errors = []
    for _ in range(100):
        a, b = random_polygons(rng)
        contacts, way = lesson.polygon_contacts(a, b), depth_of(a, b)[0]
        if way < 0.0 and len(contacts.gap):
            errors.append(abs(contacts.gap.min() - way))
    worst = np.max(errors) if errors else np.inf
    check("The deepest contact of overlapping polygons is as deep as the hull of their differences gives.",
          "greatest error of the deepest contact of 100 pairs of polygons [m]",
          law=0.0, found=worst, within=ROUND_OFF,
          saw=f"The deepest contact of {len(errors)} pairs of polygons is right to {worst:.0e} m.")


@case("minimum-translation", "The way out of an overlap", compiled=False)
def minimum_translation(lesson, check):
    """Compare the way out of random overlapping boxes and polygons with the shortest one.

    Check that contacts are on both.

    The reference is the hull of all differences.  A box moved by −gap n just touches: the separation is then zero.
    Points of contact lie within both bodies, up to the depth.  Where a face is touched, the deepest point is as deep as
    the axis gives; between two edges p_a − p_b = gap n.  Random capsules are as far apart as their segments, by
    non-negative least squares, minus the radii.  All hold to round-off, except that boxes may leave EDGE_PREFERENCE to
    a face.
    """
    rng = np.random.default_rng(67)
    depths, true, worst = ways_out(lesson, overlapping(rng, 100))
    boxes_leave_by_the_shortest_way(check, worst)
    capsules_are_as_far_apart_as_their_segments(lesson, check, rng)
    polygons_are_as_deep_as_their_differences(lesson, check, rng)
    order = np.argsort(true)
    return Picture(
        "The way out of 100 pairs of boxes", "shortest way out, by the hull of differences [m]", "depth found [m]",
        [series("equal", true[order], true[order], LINE),
         series("separating axes, measured", true[order], depths[order], DOTS)],
        "Fifteen axes are enough: no other direction separates two boxes by a shorter distance.")


# ---------------------------------------------------------------------------------------------- cloths, and steering

def triangles_at_the_axis(rng):
    """Return three triangles (3, 3): any, one with an edge along the x axis, and one with a level edge."""
    a, b, c = rng.normal(size=(3, 3))
    along = rng.permutation((a, a + np.array([1.0, 0.0, 0.0]), b))
    level = np.stack((a, b, c))
    k = rng.integers(1, 3)
    level[1, k] = level[0, k]
    return np.stack((a, b, c)), along, level


def gaps_of_triangles(lesson, check):
    """Compare the gap of triangles and a cylinder with the distance of their projections along its axis from 0."""
    rng, worst, surround = np.random.default_rng(6700), Worst(), 0
    for _ in range(200):
        r, R = rng.uniform((0.01, 0.1), (0.1, 0.5))
        for number, corners in enumerate(triangles_at_the_axis(rng)):
            distance = np.linalg.norm(np.subtract(*hull_nearest(np.zeros((1, 2)), corners[:, 1:])))
            surround += number == 0 and distance < ROUND_OFF
            worst.keep("gap", abs(lesson.triangle_cylinder_gap(*corners, r, R) - (distance - R - r)))
    check.agree(f"A cloth's gap counts corners, edges and faces; here {surround} of 200 faces surround the axis.",
                "gap of a triangle and a cylinder: largest error [m]", worst["gap"], 1e-9)


@random_law("A swept box is the box around the first and the last position.",
            "corners of a swept box: largest error [m]", 1e-12)
def swept_boxes(lesson, rng):
    low, move = rng.normal(size=(2, 3))
    high = low + rng.uniform(0.1, 1.0, 3)
    around = np.array([low, high, low + move, high + move])
    return lesson.swept_box(low, high, move), (around.min(axis=0), around.max(axis=0))


def past_a_disc(rng, share, aside):
    """Return (x, v, centre, radius, ahead, τ) of a body and a disc: after τ the body is abreast of the centre.

    τ is the fraction `share` of `ahead`, and the body passes the centre at `aside` radii.
    """
    x, v = rng.normal(size=(2, 2))
    ahead, radius = rng.uniform((1.0, 0.5), (5.0, 2.0))
    left = np.array([-v[1], v[0]]) / np.hypot(*v)
    return x, v, x + share * ahead * v + aside * radius * left, radius, ahead, share * ahead


@random_law("A body that steers is abreast of the centre at exactly the radius.",
            "distance when it is abreast, over the radius: largest error [-]", 1e-11)
def steering_aside(lesson, rng):
    x, v, centre, radius, ahead, tau = past_a_disc(rng, rng.uniform(0.1, 1.0), rng.uniform(-1.0, 1.0))
    a = np.asarray(lesson.steer(x, v, centre, radius, ahead))
    distance = np.hypot(*(x + v * tau + 0.5 * a * tau**2 - centre))
    along = a @ v / np.hypot(*v) * tau**2
    return (distance / radius, along / radius), (1.0, 0.0)


@random_law("It steers only for obstacles that are ahead, near in time, and on its path.",
            "acceleration for all else [m/s²]", 0.0)
def going_straight(lesson, rng):
    passed, later, beside = ((-rng.uniform(), 0.5), (1.0 + rng.uniform(), 0.5), (0.5, rng.choice((-1.5, 1.5))))
    *disc, _ = past_a_disc(rng, *(passed, later, beside)[rng.integers(3)])
    return np.hypot(*lesson.steer(*disc)), 0.0


@case("cloth-swept-steered", "Triangles of a cloth, swept boxes, steering", compiled=False)
def cloth_swept_steered(lesson, check):
    """Compare a cloth's gap with the distance of its triangle's projection along the cylinder, by least squares.

    A swept box is the box around all corners at the beginning and the end.  A body that steers with a for the time
    τ is then abreast of the centre at exactly the radius: x + v τ + ½ a τ².  The case `head-on-avoidance` examines
    how close it came before.
    """
    gaps_of_triangles(lesson, check)
    check.laws(lesson, (swept_boxes, steering_aside, going_straight), seed=66, times=200)


# ---------------------------------------------------------------------------------------------- nearest features

def nearest_on_triangles(lesson, check):
    """Check q nearest to p: a mean of the corners with weights ≥ 0, and no corner is farther along p − q than q is."""
    rng, worst, regions = np.random.default_rng(6800), Worst(), set()
    for _ in range(300):
        corners, p = rng.normal(size=(3, 3)), 1.5 * rng.normal(size=3)
        q = lesson.closest_on_triangle(p, *corners)
        weights = np.linalg.solve(corners.T, q)
        regions.add(tuple(weights > 1e-9))
        worst.keep("off", abs(weights.sum() - 1.0), -weights.min(), np.max((corners - q) @ (p - q)))
    check.agree(f"A point's nearest on a triangle, in {len(regions)} of its 7 regions.",
                "largest error of the nearest point [m]", worst["off"], 1e-9)


def place_at_a_box(lesson, rng, most):
    """Return a random box, and y (3,): coordinates along its axes, up to `most` half edges."""
    half = rng.uniform(0.5, 2.0, 3)
    box = lesson.make_box(rng.normal(size=3), np.linalg.qr(rng.normal(size=(3, 3)))[0], half)
    return box, rng.uniform(-most, most, 3) * half


@random_law("Outside a box the gap is that to its nearest side, edge or corner.",
            "largest error of the gap outside a box [m]", 1e-9)
def outside_a_box(lesson, rng):
    (box, y), k = place_at_a_box(lesson, rng, 2.0), rng.integers(3)
    y[k] = np.copysign(1.5 * box.half[k], y[k])
    gap = np.linalg.norm(y - np.clip(y, -box.half, box.half)) - 0.1
    return lesson.ball_box(box.x + box.R @ y, 0.1, box).gap, gap


@random_law("Inside a box a ball leaves through the nearest side.",
            "largest error of the way out of a box [m, -]", 1e-9)
def inside_a_box(lesson, rng):
    (box, y), r = place_at_a_box(lesson, rng, 1.0), 0.1
    k = np.argmin(box.half - np.abs(y))
    depth, n, x = box.half[k] - abs(y[k]), np.sign(y[k]) * box.R[:, k], box.x + box.R @ y
    c = lesson.ball_box(x, r, box)
    return (c.n, c.gap, c.p_a, c.p_b), (n, -depth - r, x - r * n, x + depth * n)


def area(y):
    """Return the area of a polygon (k, 2), counter-clockwise."""
    following = np.roll(y, -1, axis=0)
    return 0.5 * np.sum(y[:, 0] * following[:, 1] - y[:, 1] * following[:, 0])


@random_law("A line cuts a polygon into two parts, whose areas add up to that of the polygon.",
            "largest error of the area of both parts [m²]", 1e-9)
def cut_polygons(lesson, rng):
    turns, d = np.sort(rng.uniform(0.0, 2.0 * np.pi, 6)), rng.uniform(-0.5, 0.5)
    polygon = np.stack((np.cos(turns), np.sin(turns)), axis=1)
    n = polygon[0].copy()
    parts = lesson.clip(polygon, n, d), lesson.clip(polygon, -n, -d)
    beyond = np.max(parts[0] @ n - d, initial=0.0)
    return (sum(area(part) for part in parts if len(part)), beyond), (area(polygon), 0.0)


@random_law("A corner on the line belongs to both parts.", "largest error of the number of corners [-]", 1e-9)
def cut_squares(lesson, rng):
    """Cut a square through two of its corners."""
    square = np.roll([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]], rng.integers(4), axis=0)
    return tuple(len(lesson.clip(square, sign * np.array([1.0, -1.0]), 0.0)) for sign in (1.0, -1.0)), (3, 3)


@random_law("A ball that meets no obstacle flies on.", "largest error of the state after a step [m, m/s]", 1e-9)
def free_flights(lesson, rng):
    x, v, dt = rng.normal((0.0, 0.0, 9.0)), rng.normal(size=3), rng.uniform(0.1, 1.0)
    target = lesson.Target(0.1, 0.1, lesson.make_plane((0.0, 0.0, 1.0, 0.0)))
    flown = [step(lesson.ball_plane_gap, lesson.ball_plane_time, 0.0, x, v, dt, target)
             for step in (lesson.discrete_step, lesson.continuous_step)]
    return np.array(flown), 2 * [[x + dt * v, v]]


def random_flock(lesson, rng):
    """Return (flock, x, v, distances) of five members.

    The distance of a member from itself is set to a large number.
    """
    x, v = 0.5 * rng.normal(size=(5, 2)) + 3.0 * np.arange(5)[:, None] * [0.4, 0.2], rng.normal(size=(5, 2))
    apart = np.linalg.norm(x[:, None] - x, axis=2) + 10.0 * np.eye(5)
    least = apart.min()
    return lesson.make_flock(0.2 * least, 1.5 * least, *rng.uniform(0.5, 2.0, 3)), x, v, apart


def potential(x, p):
    """Return the potential energy [J] of a flock at rest, also of complex places."""
    U = 0.5 * p.gather * np.sum((x - x.mean(axis=0)) ** 2)
    for i in range(5):
        for j in range(i):
            g = np.sqrt(np.sum((x[i] - x[j]) ** 2)) - 2.0 * p.radius
            U = U + (0.5 * p.k * (1.0 / g - 1.0 / p.reach) ** 2 if g.real < p.reach else 0.0)
    return U


@random_law("A flock at rest is driven by the derivative of its energy.",
            "largest error of the force and energy, relative [-]", 1e-9)
def flocks_at_rest(lesson, rng):
    p, x, v, _ = random_flock(lesson, rng)
    steps = 1e-20j * np.eye(10).reshape(10, 5, 2)
    force = -np.array([potential(x + step, p).imag for step in steps]).reshape(5, 2) / 1e-20
    return relative((lesson.flock_acceleration(0.0, x, 0.0 * v, p), force),
                    (lesson.flock_energy(x, v, p), 0.5 * np.sum(v * v) + potential(x + 0j, p).real))


@random_law("Its members align with the velocities of those within reach.", "largest error of the alignment [m/s²]",
            1e-9)
def aligned_flocks(lesson, rng):
    p, x, v, apart = random_flock(lesson, rng)
    in_reach = apart < 2.0 * p.radius + p.reach
    adapts = p.align * np.array([np.sum((v - v[i])[in_reach[i]], axis=0) for i in range(5)])
    still, moving = (lesson.flock_acceleration(0.0, x, speed, p) for speed in (0.0 * v, v))
    return moving - still, adapts


@case("nearest-features", "Nearest sides, edges and corners", compiled=False)
def nearest_features(lesson, check):
    """Compare nearest features and flocks with their definitions.

    There are random points around triangles and boxes, polygons cut in two, and a flock whose forces are derivatives of
    energies.  The two parts of a cut polygon have its area together, and a line through two corners cuts off one side.
    """
    nearest_on_triangles(lesson, check)
    check.laws(lesson, (outside_a_box, inside_a_box, cut_polygons, cut_squares, free_flights, flocks_at_rest,
                        aligned_flocks), seed=68, times=100)


# ---------------------------------------------------------------------------------------------- touches

def touching(low_a, high_a, low_b, high_b):
    """Return all pairs (i, j) of boxes of two sets that touch in every coordinate, as a sorted list."""
    both = (low_a[:, None] <= high_b) & (low_b <= high_a[:, None])
    return [tuple(pair) for pair in np.argwhere(np.all(both, axis=2)).tolist()]


def sorted_pairs(pairs):
    """Return pairs (m, 2) as a sorted list."""
    return sorted(map(tuple, pairs.tolist()))


def touching_boxes(lesson):
    """Return whether each method finds all pairs of boxes that just touch: {what: bool}."""
    low = np.stack(np.divmod(np.arange(16), 4), axis=1).astype(float)    # squares of a board
    squares = low, low + 1.0
    neighbours = [(i, j) for i, j in touching(*squares, *squares) if i < j]
    around = np.stack((np.arange(1.0, 13.0), np.arange(12.0, 0.0, -1.0)), axis=1)    # twelve boxes about one point
    everyone = [(i, j) for i in range(12) for j in range(i + 1, 12)]
    return {
        "squares of a board": sorted_pairs(lesson.all_pairs(*squares)) == neighbours,
        "the same, by a tree": sorted_pairs(lesson.tree_pairs(*squares)) == neighbours,
        "boxes about one point": sorted_pairs(lesson.all_pairs(-around, around)) == everyone,
        "the same, by another tree": sorted_pairs(lesson.tree_pairs(-around, around)) == everyone,
    }


def exact_touches(lesson):
    """Return whether bodies that just touch are treated as defined, on numbers without round-off."""
    floor, box = lesson.make_plane((0.0, 0.0, 2.0, -2.0)), lesson.make_box(np.zeros(3), np.eye(3), (1.0, 2.0, 4.0))
    above = lambda z: np.array([3.0, -1.0, z])
    beside = lesson.ball_box(np.array([1.0, 0.5, -0.5]), 0.25, box)
    middle = lesson.ball_box(np.zeros(3), 0.25, box)
    upper = lesson.Box(np.array([0.0, 0.0, 7.5]), np.eye(3), np.array([2.0, 1.0, 4.0]))
    aside = lesson.steer(*np.array(((0.0, 0.0), (2.0, 0.0), (3.0, 0.0))), 1.0, 5.0)
    far, near = np.array([0.0, 3.0, 0.0]), np.array([0.0, 1.0, 0.0])
    return touching_boxes(lesson) | {
        "a ball that ends on a floor": lesson.plane_impact_time(0.25, 0.5, above(3.0), above(1.5), 0.5, floor) == 0.75,
        "a ball that ends on a cylinder": lesson.cylinder_impact_time(0.25, 0.5, far, near, 0.25, 0.75) == 0.75,
        "corners on a floor": len(lesson.points_plane(np.stack((above(1.0), above(0.5), above(1.5))), floor).gap) == 2,
        "a centre on a face": np.array_equal(beside.n, [1.0, 0.0, 0.0]) and beside.gap == -0.25,
        "the centre of a box": np.array_equal(middle.n, [1.0, 0.0, 0.0]) and middle.gap == -1.25,
        "a box on a box": len(lesson.box_box(upper, box).gap) == 4,
        "a disc straight ahead": np.array_equal(np.sign(aside), [0.0, 1.0]),
    }


def unit(n):
    """Return n divided by its length."""
    return n / np.linalg.norm(n)


@random_law("Points of contact are the nearest points, moved outwards by the radii.",
            "largest error of the points [m]", 1e-9)
def points_of_contact(lesson, rng):
    (x, y, normal), (one, two) = rng.normal(size=(3, 3)), rng.normal(size=(2, 2, 3))
    r_a, r_b, d = rng.uniform((0.1, 0.1, -1.0), (0.5, 0.5, 1.0))
    pairs = ((lesson.ball_contact(x, r_a, y, r_b), (x, y)),
             (lesson.ball_capsule(x, r_a, *one, r_b), hull_nearest(x[None], one)),
             (lesson.capsule_capsule(*two, r_a, *one, r_b), hull_nearest(two, one)))
    got = [(c.p_a, c.p_b, c.n) for c, _ in pairs]
    truth = [(p - r_a * unit(p - q), q + r_b * unit(p - q), unit(p - q)) for _, (p, q) in pairs]
    n, height = unit(normal), (normal @ x + d) / np.linalg.norm(normal)
    c = lesson.ball_plane(x, r_a, lesson.make_plane((*normal, d)))
    return (np.ravel(got), c.p_a, c.p_b, c.gap), (np.ravel(truth), x - r_a * n, x - height * n, height - r_a)


@random_law("The nearest points of two hulls are those of least squares.", "largest error of the nearest points [m]",
            1e-6)
def nearest_of_hulls(lesson, rng):
    a, b = rng.normal(size=(5, 3)), rng.normal((8.0, 0.0, 0.0), 1.0, (6, 3))
    c = lesson.gjk(a, b)
    return (c.p_a, c.p_b), hull_nearest(a, b)


def thrown_at(rng, hit, n, share):
    """Return the ends (x_0, x_1) of a step towards a surface with the normal n.

    The step reaches `hit` at that fraction.
    """
    w = rng.normal(size=3)
    way = w - (w @ n + 1.0) * n
    return hit - share * way, hit + (1.0 - share) * way


@random_law("An impact is at its fraction of the step, for any start time of the step.",
            "largest error of the times [s] and places [m]", 1e-9)
def impact_times(lesson, rng):
    x, normal = rng.normal(size=(2, 3))
    r, R, share = rng.uniform(0.1, 0.5, 3)
    t, dt, d = rng.uniform((0.0, 0.1, -1.0), (3.0, 1.0, 1.0))
    moment = t + share * dt

    plane, n = lesson.make_plane((*normal, d)), unit(normal)
    hit = x - ((normal @ x + d) / np.linalg.norm(normal) - r) * n
    ends = thrown_at(rng, hit, n, share)
    flown = lesson.continuous_step(lesson.ball_plane_gap, lesson.ball_plane_time, t, ends[0], (ends[1] - ends[0]) / dt,
                                   dt, lesson.Target(r, R, plane))
    got, truth = (lesson.plane_impact_time(t, dt, *ends, r, plane), *flown), (moment, hit, np.zeros(3))

    out = np.array([0.0, np.cos(2.0 * np.pi * share), np.sin(2.0 * np.pi * share)])
    hit = np.array([x[0], 0.0, 0.0]) + (r + R) * out
    ends = thrown_at(rng, hit, out, share)
    c = lesson.cylinder_hit(t, dt, *ends, r, R)
    return ((*got, lesson.cylinder_impact_time(t, dt, *ends, r, R), c.p_a, c.p_b, c.n, c.gap, c.t),
            (*truth, moment, hit - r * out, hit - r * out, out, 0.0, moment))


@random_law("A segment is cut once.", "largest error of the ends of a segment [m]", 1e-12)
def cut_segments(lesson, rng):
    a, b = rng.normal(size=(2, 3))
    n, cut = unit(b - a), a + rng.uniform(0.1, 0.5) * (b - a)
    parts = [lesson.clip(np.stack((a, b)), sign * n, sign * (n @ cut)) for sign in (1.0, -1.0)]
    return (np.array(parts) if all(len(part) == 2 for part in parts) else np.inf), np.array([(a, cut), (cut, b)])


@random_law("The nearest point is found where the bounds of its distance differ by 1e-14 of the size, at any scale.",
            "bounds of a distance: wrong answers [-]", 0.0)
def bounds_of_a_distance(lesson, rng):
    """Let the bounds |v| and v · w/|v| differ by half of that or by twice that, and let |v| be as small beside |w|."""
    scale, found = 10.0 ** rng.uniform(-80.0, 80.0), []
    for share in (0.5, 2.0):
        n, out = unit(rng.normal(size=3)), rng.normal(size=3)
        v, aside = rng.uniform(0.5, 2.0) * n, out - (out @ n) * n
        size = np.hypot(np.linalg.norm(v), np.linalg.norm(aside))
        w = v + aside - share * GJK_RELATIVE_GAP * size * n
        found += [far_enough(scale * v, scale * w), far_enough(share * GJK_RELATIVE_GAP * size * n * scale, -scale * w)]
    return np.array(found, float), np.array([1.0, 1.0, 0.0, 0.0])


class Counted:
    """Numbers that may be read `most` times.  A search that does not end reads more, and raises AssertionError."""

    def __init__(self, numbers, most):
        self.numbers, self.left = numbers, most

    def __getitem__(self, place):
        self.left -= 1
        assert self.left > 0, "the search takes too long"
        return self.numbers[place]


@random_law("The half of a node's boxes that has the smaller middles comes first.",
            "halves at the median: largest error of the middles, and of the order of other boxes [m, -]", 1e-12)
def halves_at_the_median(lesson, rng):
    """Order some of 20 boxes, whose middles are on both sides of the origin.  Each is read ten times on the average."""
    (low, size), axis = rng.normal(size=(2, 20, 2)), rng.integers(2)
    high, first, count, order = low + np.abs(size), rng.integers(0, 5), rng.integers(2, 15), rng.permutation(20)
    before, half = order.copy(), first + count // 2
    boxes = [Counted(corners, 10 * count) for corners in (low, high)]
    partition_at_median(Tree(*[None] * 5, order, *boxes), first, count, axis)
    middles, sets = 0.5 * (low + high)[:, axis], (slice(first, half), slice(half, first + count))
    ordered = np.sort(middles[before[first:first + count]])
    return ((*(np.sort(middles[order[part]]) for part in sets), order[:first], order[first + count:]),
            (ordered, before[:first], before[first + count:]))


def trees_agree(lesson, rng):
    """Return whether two trees find the pairs of random boxes that brute force finds."""
    corners = rng.uniform(0.0, 4.0, (30, 2)), rng.uniform(0.0, 4.0, (20, 2))
    sets = [(low, low + rng.uniform(0.1, 0.5, low.shape)) for low in corners]
    found = lesson.find_intersections(*(lesson.build_tree(*boxes) for boxes in sets))
    return sorted_pairs(found) == touching(*sets[0], *sets[1])


@case("points-and-times", "Points and times of contact", compiled=False)
def points_and_times(lesson, check):
    """Check that points of contact lie on both bodies, at the nearest places, and that an impact has the right time.

    The nearest points of segments and hulls are those of non-negative least squares.  A ball is thrown so that it
    touches after a known fraction of the step.
    """
    check.laws(lesson, (points_of_contact, nearest_of_hulls, impact_times, cut_segments, bounds_of_a_distance,
                        halves_at_the_median), seed=69, times=50)
    rng = np.random.default_rng(69)
    check.agree("Two trees find the boxes of both that touch.", "trees with other pairs [of 50]",
                sum(not trees_agree(lesson, rng) for _ in range(50)), 0.0)
    exact = exact_touches(lesson)
    others = ", ".join(what for what, right in exact.items() if not right) or "none"
    check("Bodies that just touch are in contact, and ties are resolved as defined.",
          f"touches and ties as defined [of {len(exact)}]",
          law=len(exact), found=sum(map(bool, exact.values())), within=0.0, saw=f"Otherwise: {others}.")


# ---------------------------------------------------------------------------------------------- why?

@case("predicted-tunnelling", "The share that gets past a wall, as predicted", compiled=False)
def predicted_tunnelling(lesson, check):
    """Throw balls at all phases at walls of random thickness, and count those that the discrete test lets past."""
    rng, phases, worst = np.random.default_rng(18), (np.arange(2000) + 0.5) / 2000, 0.0
    for _ in range(200):
        reach, move = rng.uniform(0.05, 0.2), rng.uniform(0.25, 2.0)
        w = rng.uniform(0.01, 0.09)
        ends = phases * move                                  # of the last step in front of the middle
        caught = np.mean(ends < reach)
        worst = np.maximum(worst, abs(lesson.share_past(reach - 0.5 * w, w, move / 0.01, 0.01) - (1.0 - caught)))
    check.agree("The discrete test lets the predicted share past.", "share that gets past: largest error [-]", worst,
                1.0 / 2000)


@case("crossing-crowd", "A crowd that crosses a circle", compiled=False)
def crossing_crowd(lesson, check):
    """Let twelve people cross a circle of 4 m by my_rule; none of them is stuck if the speed is as set."""
    around = np.pi * np.arange(12) / 6.0
    x, v = 4.0 * np.stack((np.cos(around), np.sin(around)), axis=1), np.zeros((12, 2))
    goals = -x
    for _ in range(200):
        v = v + 0.1 * np.array([lesson.my_rule(i, x, v, goals) for i in range(12)])
        x = x + 0.1 * v
    late = np.max(np.linalg.norm(x - goals, axis=1))
    check.agree("All arrive within 20 s.", "largest distance from a goal [m]", late, 0.3)
