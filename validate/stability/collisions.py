"""Limits of collision detection: lesson 6 at high speed, far away, at a grazing angle, deep inside, and flat.

The experiments throw thousands of balls, or place bodies where floats are coarse.  None of them
compares a formula with itself.
"""

import numpy as np
from scipy.optimize import minimize_scalar

from solutions import collisions as worked
from validate.engines.bullet import Bullet
from validate.reference.collisions import anew_steering, depth_of, held_steering, hull_nearest
from validate.reference.schemes import MIDPOINT, VERLET, step_of
from validate.stability.case import DOTS, LINE, Picture, Worst, agreement, case, finding, log_slope, refuses, series

from ..products import PYBULLET

THROWN = 10_000              # balls, each at its own phase of a step
FEW = 60                     # balls in an engine
SPACING = 2.0**-52           # of floats around 1 [-]
RADIUS, WALL, STEP = 0.05, 0.01, 1.0 / 240.0                        # of the ball [m], of the wall [m], of time [s]
ROUND_OFF = 1e-12            # of numbers below 10 after a few hundred roundings


# ---------------------------------------------------------------------------------------------- tunnelling

def passed_discretely(lesson, speed, phases):
    """Return the share of balls that pass the wall |z| < WALL/2: missed at every step, or ejected on the far side."""
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
    """Return the same share with the time of impact on the wall's near side."""
    front, passed = lesson.Plane(np.array([0.0, 0.0, 1.0]), -0.5 * WALL), 0
    reach, move = RADIUS + 0.5 * WALL, np.array([0.0, 0.0, speed * STEP])
    for phase in phases:
        x = np.array([0.0, 0.0, reach]) + phase * move
        moment = lesson.plane_impact_time(0.0, STEP, x, x - move, RADIUS, front)
        where = x[2] - moment / STEP * move[2] if np.isfinite(moment) else np.inf
        passed += not (0.0 <= moment <= STEP and abs(where - reach) < ROUND_OFF * (1.0 + move[2]))
    return passed / len(phases)


def passed_bullet(speed, phases):
    """Return the same share in pybullet without continuous detection."""
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


def law(speed):
    """Return the share that gets past: a ball is stopped only within R + w/2 of the middle, on the near side."""
    return np.maximum(0.0, 1.0 - (RADIUS + 0.5 * WALL) / (speed * STEP))


@case("tunnelling", "Tunnelling through a thin wall", compiled=False)
def tunnelling(lesson):
    """A ball of radius R moves by v h per step towards a wall of thickness w; the step's end is uniform over v h.

    The ball is stopped if the step ends in front of the middle of the wall, within R + w/2 of it.  Behind the
    middle the nearest way out is the far side, and beyond the wall no overlap is found:  missed = 1 − (R + w/2)/(v
    h).  Phases on an even grid of N give that share to 1/N.  The continuous test misses none.
    """
    found, even = [], (np.arange(THROWN) + 0.5) / THROWN
    for speed in (15.0, 50.0, 1000.0):
        missed = passed_discretely(lesson, speed, even)
        found.append(finding(
            claim=("The discrete test stops a ball only if a step ends within R + w/2 in front of the wall's middle; "
                   "behind the middle the nearest way out is the far side. It misses the share 1 − (R + w/2)/(v h)."),
            quantity=f"share of 10⁴ balls of {speed:g} m/s that get past a wall of 1 cm, discrete [-]",
            predicted=law(speed),
            measured=missed,
            tolerance=1.0 / THROWN,
            observation=f"At {speed:g} m/s {100.0 * missed:.2f} % get past; theory gives {100.0 * law(speed):.2f} %.",
        ))
    for speed in (50.0, 1e4):
        missed = passed_continuously(lesson, speed, even)
        found.append(finding(
            claim="The continuous test misses no ball at any speed.",
            quantity=f"share of 10⁴ balls of {speed:g} m/s that get past, continuous [-]",
            predicted=0.0,
            measured=missed,
            tolerance=0.0,
            observation=f"At {speed:g} m/s {round(THROWN * missed)} of 10⁴ get past the continuous test.",
        ))
    few = (np.arange(FEW) + 0.5) / FEW
    speeds = np.array([14.0, 20.0, 30.0, 45.0, 70.0, 100.0])
    drawn = [series("discrete, measured", speeds, [passed_discretely(lesson, v, even[::50]) for v in speeds], DOTS),
             series("continuous, measured", speeds, [passed_continuously(lesson, v, even[::50]) for v in speeds], DOTS)]
    if PYBULLET.installed():
        missed = passed_bullet(50.0, few)
        found.append(finding(
            claim="pybullet without continuous detection misses the same share.",
            quantity="pybullet: share of 60 balls of 50 m/s that get past [-]",
            predicted=law(50.0),
            measured=missed,
            tolerance=1.0 / FEW + 1e-9,
            observation=f"In pybullet {100.0 * missed:.1f} % of 60 balls of 50 m/s get past.",
        ))
        drawn.append(series("pybullet, measured", speeds, [passed_bullet(v, few) for v in speeds], DOTS))
    fine = np.linspace(10.0, 105.0, 100)
    return found, Picture(
        "Through a wall of 1 cm",
        "speed [m/s]",
        "share that gets past [-]",
        [series("1 − (R + w/2)/(v h), theory", fine, law(fine), LINE), *drawn],
        ("A ball of 10 cm (R = 5 cm) can pass the middle of the wall within one step of 1/240 s from 13.2 m/s on, "
         "and is then ejected on the far side. From 26.4 m/s on the discrete test can miss it altogether. The "
         "continuous test lets none pass."),
    )


# ---------------------------------------------------------------------------------------------- where digits get lost

@case("far-from-origin", "Collisions far from the origin", compiled=False)
def far_from_origin(lesson):
    """Two bodies at a distance D from the origin: their corners are rounded to the floats there, by at most ½ D 2⁻⁵².

    GJK works with differences of corners, which are exact, so no other error grows: the error of the distance
    is ∝ D.  D is a power of 2, so the spacing grows with it.  The mean square over 64 places is known to 9 %, and
    the slope over 20 doublings to 0.02.
    """
    rng = np.random.default_rng(61)
    bodies = [
        (rng.uniform(-0.5, 0.5, (8, 3)), rng.uniform(-0.5, 0.5, (8, 3)) + np.array([2.0, 1.0, 0.5])) for _ in range(64)
    ]
    exact = [np.linalg.norm(np.subtract(*hull_nearest(a, b))) for a, b in bodies]
    away, place = 2.0 ** np.arange(11, 32, 4), np.array([0.7, -0.9, 0.6])
    gap = lambda a, b, shift: lesson.gjk(a + shift, b + shift).gap
    squares = lambda D: [(gap(a, b, D * place) - true) ** 2 for (a, b), true in zip(bodies, exact)]
    errors = np.array([np.sqrt(np.mean(squares(D))) for D in away])
    slope, worst = log_slope(away, errors), errors[-1] / (away[-1] * SPACING)
    found = [
        finding(
            claim="Far from the origin only the rounding of the corners remains: the error grows in proportion to D.",
            quantity="slope of log error over log D, 2 km to 2 million km [-]",
            predicted=1.0,
            measured=slope,
            tolerance=0.05,
            observation=f"The error of GJK's distance grows with the power {slope:.3f} of the distance.",
        ),
        finding(
            claim="The error stays below the spacing of floats there.",
            quantity="error at 2 million km over the spacing there [-]",
            predicted=0.5,
            measured=worst,
            tolerance=0.5,
            observation=f"At 2 million km the distance is wrong by {worst:.2f} spacings of floats.",
        ),
    ]
    return found, Picture(
        "Distances far from the origin",
        "log₁₀ of D [m]",
        "log₁₀ of the error [m]",
        [
            series("½ spacing at D", np.log10(away), np.log10(0.5 * SPACING * away), LINE),
            series("GJK, measured", np.log10(away), np.log10(errors), DOTS),
        ],
        ("Far from the origin the distance is as inaccurate as the coordinates, and no worse. Keep scenes near the "
         "origin."),
    )


def by_school(y, w, rho):
    """Return the first root of |y + s w|² = ρ² from B² − A C and −B − √D, with their cancellation."""
    linear, quadratic = float(np.dot(y, w)), float(np.dot(w, w))
    under_the_root = linear**2 - quadratic * float(np.dot(y, y) - rho**2)
    return (-linear - np.sqrt(max(under_the_root, 0.0))) / quadratic


@case("grazing-impact", "A grazing shot", compiled=False)
def grazing_impact(lesson):
    """A ball from L = 1000ρ passes the axis at (1 − δ)ρ and touches √(2δ − δ²)ρ before the nearest point.

    Coordinates of size L are rounded by L 2⁻⁵³, so the offset b is known to twice that, and the root to
    b/√(ρ² − b²) times as much: 2·10³·1.1e-16·ρ/√(2δ).  The textbook formula squares L first and knows ρ² − b² only
    to 10⁶·1.1e-16; at δ = 1e-10 no digit is left.
    """
    far, rho, found, deltas = 1e3, 1.0, [], 10.0 ** -np.arange(2.0, 12.0)
    turns = np.linspace(0.1, 6.2, 16)

    def errors(root, delta):
        seen = []
        for phi in turns:
            e, across = np.array([np.cos(phi), np.sin(phi)]), np.array([-np.sin(phi), np.cos(phi)])
            y, w = -far * e + (1.0 - delta) * rho * across, 2.0 * far * e
            seen.append(2.0 * far * root(y, w) - (far - np.sqrt(2.0 * delta - delta * delta) * rho))
        return np.max(np.abs(seen))

    ours = lambda y, w: lesson.cylinder_impact_time(
        0.0, 1.0, np.append(0.0, y), np.append(0.0, y + w), 0.25 * rho, 0.75 * rho
    )
    limit = lambda delta: 4.0 * far * SPACING * (1.0 + 1.0 / np.sqrt(2.0 * delta))
    for delta in (1e-2, 1e-6, 1e-10):
        got = errors(ours, delta)
        found.append(finding(
            claim="The place of a grazing impact is known as well as the coordinates permit.",
            quantity=f"error of the place of impact, passing at (1 − {delta:g})ρ [ρ]",
            predicted=0.0,
            measured=got,
            tolerance=limit(delta),
            observation=(f"At (1 − {delta:g})ρ the place of impact is wrong by {got:.1e}ρ; the rounding of the "
                         f"coordinates permits {limit(delta):.1e}ρ."),
        ))
    got = errors(lambda y, w: by_school(y, w, rho), 1e-10)
    found.append(finding(
        claim=("The textbook formula loses every digit: its error is √(2δ)ρ within a factor of ten, as large as the "
               "result."),
        quantity="log₁₀ of its error at δ = 1e-10 over √(2δ)ρ [-]",
        predicted=0.0,
        measured=np.log10(max(got, 1e-300) / np.sqrt(2e-10)),
        tolerance=1.0,
        observation=f"At δ = 1e-10 the textbook formula is wrong by {got:.1e}ρ of 1.4e-05ρ.",
    ))
    return found, Picture(
        "A grazing shot from 1000ρ",
        "log₁₀ of δ",
        "log₁₀ of the error [ρ]",
        [
            series("rounding of the coordinates", np.log10(deltas), np.log10([limit(d) for d in deltas]), LINE),
            series(
                "C/(√D − B), measured", np.log10(deltas), np.log10([max(errors(ours, d), 1e-17) for d in deltas]), DOTS
            ),
            series(
                "textbook formula, measured",
                np.log10(deltas),
                np.log10([max(errors(lambda y, w: by_school(y, w, rho), d), 1e-17) for d in deltas]),
                DOTS,
            ),
        ],
        ("The same equation written in two ways: one keeps the digits of the coordinates, the other squares a "
         "distance of a thousand radii and loses three more."),
    )


@case("deep-overlap", "Deep overlap", compiled=False)
def deep_overlap(lesson):
    """Deep inside a box the way out is at most the least half edge, and there is always one normal of length 1.

    The depth at y is min_i (half_i − |y_i|), at most the least half edge (in the middle).
    """
    half, found = np.array([0.6, 0.4, 0.5]), []
    box = lesson.Box(np.array([0.3, -0.2, 0.5]), np.eye(3), half)
    axes = [np.linspace(-0.99, 0.99, 11) * h for h in half]
    grid = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
    contacts = [lesson.ball_box(box.x + y, 0.1, box) for y in grid]
    depths = np.array([-c.gap - 0.1 for c in contacts])
    found.append(finding(
        claim="The way out of a box is at most its least half edge.",
        quantity="greatest depth of a centre in a box, on a grid [m]",
        predicted=half.min(),
        measured=depths.max(),
        tolerance=ROUND_OFF,
        observation=f"The deepest of {len(grid)} centres is {depths.max():.3f} m from a face.",
    ))
    out = [np.max(np.abs(c.p_b - box.x) - half) for c in contacts]
    found.append(finding(
        claim="The way out ends on the surface.",
        quantity="greatest distance of p_b from the surface of the box [m]",
        predicted=0.0,
        measured=np.abs(out).max(),
        tolerance=ROUND_OFF,
        observation=f"All points p_b lie on the box, to {np.abs(out).max():.0e} m.",
    ))
    x, here = np.array([0.7, -0.4, 0.2]), lesson.Box(np.array([0.7, -0.4, 0.2]), np.eye(3), half)
    normals = {
        "two balls with one centre": lesson.ball_contact(x, 0.3, x, 0.5).n,
        "a ball on the axis of a cylinder": lesson.cylinder_contact(np.array([0.7, 0.0, 0.0]), 0.1, 0.5).n,
        "a ball in the middle of a box": lesson.ball_box(x, 0.1, here).n,
        "two boxes with one centre": lesson.box_separation(here, here)[1],
    }
    for name, n in normals.items():
        found.append(finding(
            claim="Where all directions are equally good, one is chosen.",
            quantity=f"length of n for {name} [-]",
            predicted=1.0,
            measured=np.linalg.norm(n),
            tolerance=ROUND_OFF,
            observation=f"For {name} n has the length {np.linalg.norm(n):.15g}.",
        ))
    line = np.linspace(-0.55, 0.55, 45)
    return found, Picture(
        "Out of a box of 1.2 × 0.8 × 1.0 m",
        "place along x, 0.1 m above the middle [m]",
        "depth [m]",
        [
            series("least distance to a face", line, np.minimum(0.3, 0.6 - np.abs(line)), LINE),
            series(
                "ball_box, measured",
                line[::3],
                [-lesson.ball_box(box.x + np.array([s, 0.1, 0.0]), 0.1, box).gap - 0.1 for s in line[::3]],
                DOTS,
            ),
        ],
        ("In the middle the nearest face is above; near an end it is that end. Where two faces are equally near, the "
         "normal jumps."),
    )


@case("degenerate-shapes", "Bodies without volume", compiled=False)
def degenerate_shapes(lesson):
    """GJK on bodies without volume, at known distances: points, lines, flat bodies, doubled corners, needles of 10⁻⁶.

    GJK stops when the distance is known to 1e-14 of the size of the bodies, here below 10 m, and rounds a few dozen
    times.
    """
    rng, found, line = np.random.default_rng(64), [], np.linspace(0.0, 1.0, 5)[:, None]
    x, y, z = np.eye(3)
    square = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], dtype=float)
    needle = np.array([[-2, 0, 0], [2, 1e-6, 0], [2, 0, 1e-6], [2, -1e-6, -1e-6]], dtype=float)
    known = {                # name: a, b, distance
        "two points": (np.zeros((1, 3)), 1.5 * x[None], 1.5),
        "two lines on one line": (line * x, 2.0 * x + line * x, 1.0),
        "two parallel lines": (line * x, 0.3 * y + line * x, 0.3),
        "two crossing lines": (line * x - 0.5 * x, 0.7 * z + line * y - 0.5 * y, 0.7),
        "two squares in one plane": (square, square + 1.4 * x, 0.4),
        "two squares face to face": (square, square + 0.2 * z, 0.2),
        "all corners twice": (np.concatenate((square, square)), np.concatenate((square, square)) + 0.2 * z, 0.2),
        "two needles across": (needle, needle[:, [1, 0, 2]] + 0.5 * z - 0.0 * x, None),
    }
    for name, (a, b, distance) in known.items():
        # An edge of each is nearest, near the middle: the reference solution gives the distance.
        if distance is None:
            p, q = hull_nearest(a, b)
            distance = np.linalg.norm(p - q)
        R = np.linalg.qr(rng.normal(size=(3, 3)))[0]
        got = lesson.gjk(np.ascontiguousarray(a @ R.T), np.ascontiguousarray(b @ R.T)).gap
        found.append(finding(
            claim="GJK does not need bodies with volume.",
            quantity=f"distance of {name} [m]",
            predicted=distance,
            measured=got,
            tolerance=ROUND_OFF,
            observation=f"GJK finds {got:.12g} m between {name}.",
        ))
    gaps = 10.0 ** -np.arange(0.0, 13.0, 2.0)
    errors = [abs(lesson.gjk(square, square + g * z + 0.3 * x).gap - g) for g in gaps]
    found.append(finding(
        claim="For two squares nearly in one plane the distance is known to round-off.",
        quantity="greatest error for gaps from 1 m to 10⁻¹² m [m]",
        predicted=0.0,
        measured=max(errors),
        tolerance=1e-14 * 4.0,
        observation=f"For gaps down to 10⁻¹² m the error is at most {max(errors):.0e} m.",
    ))
    return found, Picture(
        "Two squares face to face",
        "log₁₀ of the gap [m]",
        "log₁₀ of the distance found [m]",
        [
            series("theory", np.log10(gaps), np.log10(gaps), LINE),
            series(
                "GJK, measured",
                np.log10(gaps),
                np.log10([max(lesson.gjk(square, square + g * z + 0.3 * x).gap, 1e-17) for g in gaps]),
                DOTS,
            ),
        ],
        ("Corner on corner and face on face, where many simplices are equally near: GJK tries every subset, so it "
         "misses none."),
    )


# ---------------------------------------------------------------------- avoidance, and what cannot be

def nearest_approach(lesson, closing, k, reach, steps=10_000):
    """Return the least gap [m] of two bodies that approach head-on at that speed [m/s], and that of theory.

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
    """Return the least distance from the centre of a disc of radius 1 m, and the last speed, of a body of 1 m/s.

    It begins at that distance before the centre and passes it at that offset, both in m, if it does not steer.  It
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


def steering():
    """Return [(distance, offset)] of bodies that steer past a disc of radius 1 m."""
    return (4.0, 0.0), (4.0, 0.5), (1.5, 0.0), (1.5, 0.5)


def steered_findings(lesson):
    """Return how near a body comes that holds the acceleration of exercise 6.17, and one that computes it anew.

    Places on a path are dt = 1/4000 of the distance apart, so they miss the least one by dt²/2 at most; the midpoint
    method is of second order as well.  With A before the centre, A² < 2 (1 − B) dt, it turns by more than 1 rad per
    step and is wrong.  From there on the distance B changes by A²/2 = (1 − B) dt.  A step that turns it by θ < 0.1 rad
    multiplies its speed by 1 + θ⁴/8; θ grows like 1/A², so all of them together do as much as A/7dt < 13 of the last.
    """
    found = []
    for distance, offset in steering():
        where = f"from {distance:g} radii, offset {offset:g}"
        nearest, faster = held_steering(distance, offset)
        got, speed = steered_past(lesson, distance, offset, False)
        found += [finding(
            claim="A body that holds the acceleration of its steering cuts into the disc before it is abreast.",
            quantity=f"closest approach over the radius, {where} [-]", predicted=nearest, measured=got,
            tolerance=(distance / 4000) ** 2,
            observation=f"It comes as near as {got:.4f} radii.",
        ), finding(
            claim="It ends faster: its acceleration is across its first velocity, not across the present one.",
            quantity=f"last speed over the first, {where} [-]", predicted=faster, measured=speed, tolerance=1e-12,
            observation=f"It ends at {speed:.4f} times its speed.",
        )]
        nearest = anew_steering(distance, offset)
        got, speed = steered_past(lesson, distance, offset, True)
        found += [finding(
            claim="A body that computes its steering anew all the time comes too near as well, but less.",
            quantity=f"closest approach over the radius, computed anew, {where} [-]", predicted=nearest, measured=got,
            tolerance=10.0 * (distance / 4000) ** 2 + (1.0 - nearest) * distance / 4000,
            observation=f"It comes as near as {got:.6f} radii.",
        ), finding(
            claim="It keeps its speed, because its acceleration is always across its velocity.",
            quantity=f"speed over the first while steps resolve the turn, computed anew, {where} [-]", predicted=1.0,
            measured=speed, tolerance=2e-4,
            observation=f"As long as a step turns it by less than 0.1 rad, it has {speed:.6f} times its speed.",
        )]
    return found


@case("head-on-avoidance", "Avoidance head-on", compiled=False)
def head_on_avoidance(lesson):
    """Two members of a flock that close head-on with u turn back at a gap g with  ¼ u² = ½ k (1/g − 1/reach)².

    Each has the kinetic energy ½ (u/2)².  g = 1/(1/reach + u/√(2k)) is above zero at any speed.  Verlet's energy
    error is (dt/τ)² = 4e-6 times a constant for the steepness of the potential, at most the fourth power: 4·5/2.
    The gap follows the energy with a power below one.

    Steering has no potential, and does not keep clear of its disc: see steered_findings.
    """
    found, k, reach = steered_findings(lesson), 1.0, 1.0
    for closing in (1.0, 10.0, 100.0):
        got, turning = nearest_approach(lesson, closing, k, reach)
        found.append(finding(
            claim="A potential that is infinite at contact turns every body back.",
            quantity=f"least gap at a closing speed of {closing:g} m/s [m]",
            predicted=turning,
            measured=got,
            tolerance=4e-5 * turning,
            observation=(f"At a closing speed of {closing:g} m/s the two come within {got:.6f} m of each other; "
                         f"theory gives {turning:.6f} m."),
        ))
    speeds = 10.0 ** np.linspace(-0.5, 2.0, 5)
    fine = 10.0 ** np.linspace(-0.6, 2.1, 40)
    return found, Picture(
        "How near do they come?",
        "log₁₀ of the closing speed [m/s]",
        "log₁₀ of the least gap [m]",
        [
            series(
                "1/(1/reach + u/√(2k)), theory",
                np.log10(fine),
                np.log10(1.0 / (1.0 / reach + fine / np.sqrt(2.0 * k))),
                LINE,
            ),
            series(
                "Verlet, measured",
                np.log10(speeds),
                np.log10([nearest_approach(lesson, u, k, reach)[0] for u in speeds]),
                DOTS,
            ),
        ],
        ("The two never touch, but at high speed they come so near that the step must shrink with the gap. Avoidance "
         "does not replace detection."),
    )


@case("undefined-distance", "What has no distance", compiled=False)
def undefined_distance(lesson):
    """Input without a defined distance is refused by name: no area, no length, inverted, not a number, or empty."""
    a, b, nan = np.zeros(3), np.ones(3), np.array([[0.0, np.nan]])
    flat = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 0.0], [0.0, 1.0]])
    asked = {
        "a plane with no normal": (lesson.make_plane, ((0.0, 0.0, 0.0, 1.0),)),
        "a plane that is not a number": (lesson.make_plane, ((1.0, np.nan, 0.0, 1.0),)),
        "a segment without length": (lesson.closest_on_segment, (b, a, a)),
        "a capsule without length": (lesson.ball_capsule, (b, 0.1, a, a, 0.2)),
        "a triangle on a line": (
            lesson.closest_on_triangle,
            (b, a, np.array([1.0, 0.0, 0.0]), np.array([2.0, 0.0, 0.0])),
        ),
        "a triangle in a point": (lesson.ball_triangle, (b, 0.1, a, a, a)),
        "a polygon with a corner twice": (lesson.polygon_contacts, (flat, flat)),
        "a box inside out": (lesson.build_tree, (np.ones((1, 2)), np.zeros((1, 2)))),
        "a box that is not a number": (lesson.tree_pairs, (nan, nan)),
        "no box at all": (lesson.build_tree, (np.zeros((0, 2)), np.zeros((0, 2)))),
        "a place inside an obstacle": (lesson.repulsion, (a, a, 0.5, 1.0, 1.0)),
        "a flight that is not a number": (
            lesson.advance_projectiles,
            (lesson.discrete_step, lesson.ball_plane_gap, lesson.ball_plane_time, 0.0, nan, nan, 0.1, 1, ()),
        ),
        "a flock without reach": (lesson.make_flock, (0.1, 0.0, 1.0, 0.0, 0.0)),
    }
    refused = {name: refuses(*call) for name, call in asked.items()}
    found = [finding(
        claim="Bad input raises a typed error.",
        quantity=f"whether {name} is refused [-]",
        predicted=1.0,
        measured=float(ok),
        tolerance=0.0,
        observation=f"{name[0].upper() + name[1:]} is {'refused' if ok else 'accepted'}.",
    ) for name, ok in refused.items()]
    sizes = 10.0 ** -np.arange(0.0, 12.0)
    heights = [
        lesson.ball_triangle(
            np.array([0.2 * s, 0.2 * s, 1.0]), 0.25, a, np.array([s, 0.0, 0.0]), np.array([0.0, s, 0.0])
        ).gap
        for s in sizes
    ]
    return found, Picture(
        "A small triangle is not a flat one",
        "log₁₀ of the size of a triangle [m]",
        "gap of a ball above it [m]",
        [
            series("theory", np.log10(sizes), np.full(12, 0.75), LINE),
            series("ball_triangle, measured", np.log10(sizes), heights, DOTS),
        ],
        "A triangle is refused if its area is small for its size. A small triangle is measured like any other.",
    )


def inside(box, points):
    """Return how far the farthest of these points is outside a box [m]; below zero if all are inside."""
    return np.max([np.max(np.abs(box.R.T @ (x - box.x)) - box.half) for x in points])


def overlapping(rng, n):
    """Return n pairs of random boxes that overlap by up to about a quarter of their size."""
    pairs = []
    while len(pairs) < n:
        a, b = (
            worked.Box(
                0.8 * rng.uniform(-1.0, 1.0, 3),
                np.ascontiguousarray(np.linalg.qr(rng.normal(size=(3, 3)))[0]),
                rng.uniform(0.3, 1.0, 3),
            )
            for _ in range(2)
        )
        if depth_of(corners_of(a), corners_of(b))[0] < 0.0:
            pairs.append((a, b))
    return pairs


def ways_out(lesson, pairs):
    """Return (depths found [m], true ones, the worst errors) of pairs of boxes that overlap."""
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


def boxes_leave_by_the_shortest_way(worst):
    """Judge the worst errors of 100 pairs of boxes."""
    room = 2.0 * worked.EDGE_PREFERENCE
    return [
        finding(
            claim="The least overlap of 15 axes is the shortest way out.",
            quantity="greatest error of the depth of 100 pairs of boxes [m]",
            predicted=0.0,
            measured=worst["depth"],
            tolerance=room,
            observation=("The depth of 100 pairs of boxes equals that of the hull of their differences to "
                         f"{worst['depth']:.0e} m."),
        ),
        finding(
            claim="Moved out by the gap along n, two boxes just touch.",
            quantity="greatest overlap or gap left, of 100 pairs [m]",
            predicted=0.0,
            measured=worst["left"],
            tolerance=room,
            observation=("Moved by the gap along n, 100 pairs are left with an overlap or gap of "
                         f"{worst['left']:.0e} m."),
        ),
        finding(
            claim="Points of contact lie on both bodies.",
            quantity="distance of the farthest point of contact outside its box, or 0 [m]",
            predicted=0.0,
            measured=worst["outside"],
            tolerance=1e-11,
            observation=(f"No point of contact of 100 pairs is more than {worst['outside']:.0e} m "
                         "outside its box."),
        ),
        finding(
            claim="The deepest point of contact is as deep as the axis gives.",
            quantity="greatest difference between the deepest contact and the axis [m]",
            predicted=0.0,
            measured=worst["deepest"],
            tolerance=1e-11,
            observation=("The deepest point of contact of 100 pairs is as deep as the axis gives, to "
                         f"{worst['deepest']:.0e} m."),
        ),
        finding(
            claim="The points of a contact are apart by its gap, along n.",
            quantity="greatest length of p_a − p_b − gap n, of 100 pairs [m]",
            predicted=0.0,
            measured=worst["apart"],
            tolerance=1e-11,
            observation=f"For 100 pairs p_a − p_b is gap n to {worst['apart']:.0e} m.",
        ),
    ]


def capsules_are_as_far_apart_as_their_segments(lesson, rng):
    """Compare 100 pairs of capsules with the nearest points of their segments."""
    errors = []
    for _ in range(100):
        x = rng.uniform(-1.0, 1.0, (4, 3))
        p, q = hull_nearest(x[:2], x[2:])
        errors.append(abs(lesson.capsule_capsule(x[0], x[1], 0.1, x[2], x[3], 0.2).gap - (np.linalg.norm(p - q) - 0.3)))
    return [finding(
        claim="Two capsules are as far apart as their segments, less the radii.",
        quantity="greatest error of the gap of 100 pairs of capsules [m]",
        predicted=0.0,
        measured=max(errors),
        tolerance=ROUND_OFF,
        observation=f"The gap of 100 pairs of capsules is right to {max(errors):.0e} m.",
    )]


def polygons_are_as_deep_as_their_differences(lesson, rng):
    """Compare 100 pairs of polygons with the hull of their differences."""
    flat = []
    for _ in range(100):
        a, b = (
            rng.uniform(-0.6, 0.6, 2) + np.stack((np.cos(t), np.sin(t)), axis=1)
            for t in (np.sort(rng.uniform(0.0, 1.2, 5)) + 1.25 * np.arange(5) for _ in range(2))
        )
        contacts, way = lesson.polygon_contacts(a, b), depth_of(a, b)[0]
        if way < 0.0 and len(contacts.gap):
            flat.append(abs(contacts.gap.min() - way))
    return [finding(
        claim="The deepest contact of overlapping polygons is as deep as the hull of their differences gives.",
        quantity="greatest error of the deepest contact of 100 pairs of polygons [m]",
        predicted=0.0,
        measured=max(flat, default=np.inf),
        tolerance=ROUND_OFF,
        observation=(f"The deepest contact of {len(flat)} pairs of polygons is right to "
                     f"{max(flat, default=np.inf):.0e} m."),
    )]


@case("minimum-translation", "The way out of an overlap", compiled=False)
def minimum_translation(lesson):
    """Random boxes and polygons that overlap: the way out is the shortest one, and contacts lie on both bodies.

    The reference is the hull of all differences.  A box moved by −gap n just touches: the separation is then zero.
    Points of contact lie within both bodies, up to the depth.  Where a face is touched, the deepest is as deep as
    the axis gives; between two edges p_a − p_b = gap n.  Random capsules are as far apart as their segments, by
    non-negative least squares, less the radii.  All hold to round-off, except that boxes may leave EDGE_PREFERENCE to
    a face.
    """
    rng = np.random.default_rng(67)
    depths, true, worst = ways_out(lesson, overlapping(rng, 100))
    found = boxes_leave_by_the_shortest_way(worst)
    found += capsules_are_as_far_apart_as_their_segments(lesson, rng)
    found += polygons_are_as_deep_as_their_differences(lesson, rng)
    order = np.argsort(true)
    return found, Picture(
        "The way out of 100 pairs of boxes",
        "shortest way out, by the hull of differences [m]",
        "depth found [m]",
        [
            series("equal", true[order], true[order], LINE),
            series("separating axes, measured", true[order], depths[order], DOTS),
        ],
        "Fifteen axes are enough: no other direction is a shorter way out of two boxes.",
    )


def corners_of(box):
    """Return the eight corners (8, 3) of a box."""
    signs = np.array([[i, j, k] for i in (-1.0, 1.0) for j in (-1.0, 1.0) for k in (-1.0, 1.0)])
    return box.x + signs * box.half @ box.R.T


def least_on_edge(a, b):
    """Return the distance of the segment from a to b (2,) from 0, by a search over the segment."""
    return minimize_scalar(lambda s: np.hypot(*(a + s * (b - a))), bounds=(0.0, 1.0), method="bounded",
                           options={"xatol": 1e-12}).fun


def surrounds(corners):
    """Return whether 0 is inside a polygon (n, 2): its edges turn once around it."""
    following = np.roll(corners, -1, axis=0)
    across = corners[:, 0] * following[:, 1] - corners[:, 1] * following[:, 0]
    turns = np.arctan2(across, np.sum(corners * following, axis=1))
    return abs(turns.sum()) > np.pi


@case("cloth-swept-steered", "Triangles of a cloth, swept boxes, steering", compiled=False)
def cloth_swept_steered(lesson):
    """A cloth's gap by a search along its edges and by the winding number of its face about the axis.

    A swept box is the box around all corners at the beginning and the end.  A body that steers with a for the time τ
    is then abreast of the centre at exactly the radius: x + v τ + ½ a τ².  How near it was before is the subject of
    `head-on-avoidance`.
    """
    rng, worst, inside = np.random.default_rng(67), Worst(), 0
    for _ in range(200):
        a, b, c = rng.normal(size=(3, 3))
        r, R = rng.uniform(0.01, 0.1), rng.uniform(0.1, 0.5)
        corners = np.stack((a, b, c))[:, 1:]
        inside += surrounds(corners)
        edges = corners[:2], corners[1:], corners[[2, 0]]
        truth = 0.0 if surrounds(corners) else min(least_on_edge(*edge) for edge in edges)
        worst.keep("gap", abs(lesson.triangle_cylinder_gap(a, b, c, r, R) - (truth - R - r)))
        beside = a + np.array([1.0, 0.0, 0.0])                   # an edge along the axis is a point in this view
        y, along = a[1:], (b - a)[1:]
        truth = np.linalg.norm(y + np.clip(-(y @ along) / (along @ along), 0.0, 1.0) * along)
        got = lesson.triangle_cylinder_gap(*rng.permutation((a, beside, b)), r, R)
        worst.keep("gap", abs(got - (truth - R - r)))
        for k in (1, 2):                                         # one edge at one height, or at one depth
            level = np.stack((a, b, c))
            level[1, k] = level[0, k]
            corners = level[:, 1:]
            edges = corners[:2], corners[1:], corners[[2, 0]]
            truth = 0.0 if surrounds(corners) else min(least_on_edge(*edge) for edge in edges)
            worst.keep("gap", abs(lesson.triangle_cylinder_gap(*level, r, R) - (truth - R - r)))

        low, move = rng.normal(size=3), rng.normal(size=3)
        high = low + rng.uniform(0.1, 1.0, 3)
        around = np.array([low, high, low + move, high + move])
        got = np.array(lesson.swept_box(low, high, move))
        worst.keep("swept", np.max(np.abs(got - [around.min(axis=0), around.max(axis=0)])))

        x, v, centre = rng.normal(size=2), rng.normal(size=2), 3.0 * rng.normal(size=2)
        e, ahead, radius = v / np.hypot(*v), rng.uniform(1.0, 5.0), rng.uniform(0.5, 2.0)
        tau = (centre - x) @ e / np.hypot(*v)
        beside = abs((centre - x) @ np.array([-e[1], e[0]]))
        steered = np.asarray(lesson.steer(x, v, centre, radius, ahead))
        if 0.0 < tau < ahead and beside < radius:
            passing = x + v * tau + 0.5 * steered * tau**2 - centre
            off = abs(np.hypot(*passing) - radius) + abs(steered @ e) * tau**2
            worst.keep("steer", off / radius)
        else:
            worst.keep("straight", np.hypot(*steered))
    return [
        agreement(f"A cloth's gap counts corners, edges and faces; here {inside} of 200 faces surround the axis.",
                  "gap of a triangle and a cylinder: largest error [m]", worst["gap"], 1e-9),
        agreement("A swept box is the box around the first and the last position.",
                  "corners of a swept box: largest error [m]", worst["swept"], 1e-12),
        agreement("A body that steers is abreast of the centre at exactly the radius.",
                  "distance when it is abreast, over the radius: largest error [-]", worst["steer"], 1e-11),
        agreement("It steers only for what is ahead, in time and in its way.", "acceleration for all else [m/s²]",
                  worst["straight"], 0.0)], None


def nearest_of_hull(p, corners):
    """Return the point of a triangle (3, 3) that is nearest to p: the best of its face, its edges and its corners."""
    best = corners[np.argmin(np.sum((corners - p) ** 2, axis=1))]
    for which in ((0, 1), (1, 2), (2, 0), (0, 1, 2)):
        origin, *others = corners[list(which)]
        directions = np.stack(others) - origin
        weights = np.linalg.lstsq(directions.T, p - origin, rcond=None)[0]
        q = origin + weights @ directions
        if np.all(weights >= 0.0) and weights.sum() <= 1.0 and np.sum((q - p) ** 2) < np.sum((best - p) ** 2):
            best = q
    return best


def area(y):
    """Return the area of a polygon (k, 2), counter-clockwise."""
    following = np.roll(y, -1, axis=0)
    return 0.5 * np.sum(y[:, 0] * following[:, 1] - y[:, 1] * following[:, 0])


@case("nearest-features", "Every side, edge and corner can be the nearest", compiled=False)
def nearest_features(lesson):
    """Random points around triangles and boxes; polygons cut in two; a flock whose forces are derivatives of energies.

    The two parts of a cut polygon have its area together, and a line through two corners cuts off what is on one side.
    """
    rng = np.random.default_rng(68)
    worst, seen = Worst(), set()
    for _ in range(300):
        corners, p = rng.normal(size=(3, 3)), 1.5 * rng.normal(size=3)
        truth = nearest_of_hull(p, corners)
        seen.add(tuple(np.abs(np.linalg.solve(corners.T, truth)) > 1e-9))               # which corners have a weight
        worst.note("triangle", lesson.closest_on_triangle(p, *corners), truth)
    for _ in range(100):
        R, half, centre, r = np.linalg.qr(rng.normal(size=(3, 3)))[0], rng.uniform(0.5, 2.0, 3), rng.normal(size=3), 0.1
        box = lesson.make_box(centre, R, half)
        y = rng.uniform(-1.0, 1.0, 3) * half
        depths = np.concatenate((half - y, half + y))
        k = int(np.argmin(depths))
        out = R[:, k % 3] * (1.0 if k < 3 else -1.0)
        c = lesson.ball_box(centre + R @ y, r, box)
        worst.keep("inside", np.max(np.abs(c.n - out)), abs(c.gap + depths[k] + r))
        place = centre + R @ y
        worst.note("inside", (c.p_a, c.p_b), (place - r * out, place + depths[k] * out))
        y = rng.uniform(1.1, 2.0, 3) * half * rng.choice((-1.0, 0.4, 1.0), 3)
        gap = np.linalg.norm(y - np.clip(y, -half, half)) - r
        if gap > -r:
            worst.keep("box", abs(lesson.ball_box(centre + R @ y, r, box).gap - gap))

        turns = np.sort(rng.uniform(0.0, 2.0 * np.pi, 6))
        polygon = np.stack((np.cos(turns), np.sin(turns)), axis=1)
        n, d = np.array([np.cos(turns[0]), np.sin(turns[0])]), rng.uniform(-0.5, 0.5)
        parts = lesson.clip(polygon, n, d), lesson.clip(polygon, -n, -d)
        lost = abs(sum(area(part) for part in parts if len(part)) - area(polygon))
        beyond = np.max(parts[0] @ n - d, initial=0.0)
        worst.keep("cut", lost, beyond)
        x, v, dt = rng.normal((0.0, 0.0, 9.0)), rng.normal(size=3), rng.uniform(0.1, 1.0)
        target = lesson.Target(0.1, 0.1, lesson.make_plane((0.0, 0.0, 1.0, 0.0)))
        for step in (lesson.discrete_step, lesson.continuous_step):
            got = step(lesson.ball_plane_gap, lesson.ball_plane_time, 0.0, x, v, dt, target)
            worst.note("flight", np.array(got), (x + dt * v, v))
    square = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
    for n in (np.array([1.0, -1.0]), np.array([-1.0, 1.0])):                            # through (0, 0) and (1, 1)
        worst.keep("corners", abs(len(lesson.clip(square, n, 0.0)) - 3))
    for _ in range(20):
        x, v = 0.5 * rng.normal(size=(5, 2)) + 3.0 * np.arange(5)[:, None] * [0.4, 0.2], rng.normal(size=(5, 2))
        near = np.linalg.norm(x[:, None] - x, axis=2) + 10.0 * np.eye(5)
        radius, reach, (k, align, gather) = 0.2 * near.min(), 1.5 * near.min(), rng.uniform(0.5, 2.0, 3)
        flock = lesson.make_flock(radius, reach, k, align, gather)

        def energy(x, radius=radius, reach=reach, k=k, gather=gather):
            U = 0.5 * gather * np.sum((x - x.mean(axis=0)) ** 2)
            for i in range(5):
                for j in range(i):
                    g = np.sqrt(np.sum((x[i] - x[j]) ** 2)) - 2.0 * radius
                    U = U + (0.5 * k * (1.0 / g - 1.0 / reach) ** 2 if g.real < reach else 0.0)
            return U

        steps = 1e-20j * np.eye(10).reshape(10, 5, 2)
        force = -np.array([energy(x + step).imag for step in steps]).reshape(5, 2) / 1e-20
        still, moving = (lesson.flock_acceleration(0.0, x, speed, flock) for speed in (0.0 * v, v))
        worst.keep("flock", np.max(np.abs(still - force)) / np.max(np.abs(force)))
        both = 0.5 * np.sum(v * v) + energy(x + 0j).real
        worst.keep("flock", abs(lesson.flock_energy(x, v, flock) - both) / both)
        in_reach = near < 2.0 * radius + reach
        adapts = align * np.array([np.sum((v - v[i])[in_reach[i]], axis=0) for i in range(5)])
        worst.keep("align", np.max(np.abs(moving - still - adapts)))
    names = (
        ("triangle", f"A point's nearest on a triangle, in {len(seen)} of its 7 regions.", "nearest point [m]"),
        ("box", "Outside a box the gap is that to its nearest side, edge or corner.", "gap outside a box [m]"),
        ("inside", "Inside a box a ball leaves through the nearest side.", "way out of a box [m, -]"),
        ("cut", "A line cuts a polygon in two parts, which have its area together.", "area of both parts [m²]"),
        ("corners", "A corner on the line belongs to both parts.", "number of corners [-]"),
        ("flight", "A ball that meets nothing flies on.", "state after a step [m, m/s]"),
        ("flock", "A flock at rest is driven by the derivative of its energy.", "force and energy, relative [-]"),
        ("align", "Its members adapt to the velocities of those in reach.", "alignment [m/s²]"))
    return [agreement(claim, f"largest error of the {quantity}", worst[name], 1e-9)
            for name, claim, quantity in names], None


def touching(low_a, high_a, low_b, high_b):
    """Return all pairs (i, j) of boxes of two sets that touch in every coordinate, as a sorted list."""
    both = (low_a[:, None] <= high_b) & (low_b <= high_a[:, None])
    return [tuple(pair) for pair in np.argwhere(np.all(both, axis=2)).tolist()]


def exact_touches(lesson):
    """Return whether each of these is as defined: numbers without round-off, in which bodies just touch."""
    low = np.stack(np.divmod(np.arange(16), 4), axis=1).astype(float)    # squares of a board
    squares = low, low + 1.0
    neighbours = [(i, j) for i, j in touching(*squares, *squares) if i < j]
    around = np.stack((np.arange(1.0, 13.0), np.arange(12.0, 0.0, -1.0)), axis=1)    # twelve boxes about one point
    everyone = [(i, j) for i in range(12) for j in range(i + 1, 12)]
    floor, box = lesson.make_plane((0.0, 0.0, 2.0, -2.0)), lesson.make_box(np.zeros(3), np.eye(3), (1.0, 2.0, 4.0))
    above = lambda z: np.array([3.0, -1.0, z])
    beside = lesson.ball_box(np.array([1.0, 0.5, -0.5]), 0.25, box)
    middle = lesson.ball_box(np.zeros(3), 0.25, box)
    upper = lesson.Box(np.array([0.0, 0.0, 7.5]), np.eye(3), np.array([2.0, 1.0, 4.0]))
    return {
        "squares of a board": sorted(map(tuple, lesson.all_pairs(*squares).tolist())) == neighbours,
        "the same, by a tree": sorted(map(tuple, lesson.tree_pairs(*squares).tolist())) == neighbours,
        "boxes about one point": sorted(map(tuple, lesson.all_pairs(-around, around).tolist())) == everyone,
        "the same, by another tree": sorted(map(tuple, lesson.tree_pairs(-around, around).tolist())) == everyone,
        "a ball that ends on a floor": lesson.plane_impact_time(0.25, 0.5, above(3.0), above(1.5), 0.5, floor) == 0.75,
        "a ball that ends on a cylinder": lesson.cylinder_impact_time(
            0.25, 0.5, np.array([0.0, 3.0, 0.0]), np.array([0.0, 1.0, 0.0]), 0.25, 0.75) == 0.75,
        "corners on a floor": len(lesson.points_plane(np.stack((above(1.0), above(0.5), above(1.5))), floor).gap) == 2,
        "a centre on a face": np.array_equal(beside.n, [1.0, 0.0, 0.0]) and beside.gap == -0.25,
        "the centre of a box": np.array_equal(middle.n, [1.0, 0.0, 0.0]) and middle.gap == -1.25,
        "a box on a box": len(lesson.box_box(upper, box).gap) == 4,
        "a disc straight ahead": np.array_equal(
            np.sign(lesson.steer(*np.array(((0.0, 0.0), (2.0, 0.0), (3.0, 0.0))), 1.0, 5.0)), [0.0, 1.0]),
    }


def nearest_places(lesson, rng, worst):
    """Note how far the points of contact of one random pair of each kind are from the nearest points."""
    x, y, normal = rng.normal(size=(3, 3))
    r_a, r_b, d = rng.uniform((0.1, 0.1, -1.0), (0.5, 0.5, 1.0))
    n = (x - y) / np.linalg.norm(x - y)
    c = lesson.ball_contact(x, r_a, y, r_b)
    worst.note("points", (c.p_a, c.p_b, c.n), (x - r_a * n, y + r_b * n, n))
    ends = rng.normal(size=(4, 3))
    for one in (x[None], ends[2:]):
        p, q = hull_nearest(one, ends[:2])
        n = (p - q) / np.linalg.norm(p - q)
        c = lesson.ball_capsule(x, r_a, *ends[:2], r_b) if len(one) == 1 else lesson.capsule_capsule(
            *one, r_a, *ends[:2], r_b)
        worst.note("points", (c.p_a, c.p_b, c.n), (p - r_a * n, q + r_b * n, n))
    a, b = rng.normal(size=(5, 3)), rng.normal((8.0, 0.0, 0.0), 1.0, (6, 3))
    c = lesson.gjk(a, b)
    worst.note("hulls", (c.p_a, c.p_b), hull_nearest(a, b))
    n, height = normal / np.linalg.norm(normal), (normal @ x + d) / np.linalg.norm(normal)
    c = lesson.ball_plane(x, r_a, lesson.make_plane((*normal, d)))
    worst.note("points", (c.p_a, c.p_b, np.array([c.gap])), (x - r_a * n, x - height * n, np.array([height - r_a])))


def known_impacts(lesson, rng, worst):
    """Note how far the impacts of one ball on a plane and on a cylinder are from where and when it was aimed at."""
    x, normal, w = rng.normal(size=(3, 3))
    r, R, share = rng.uniform(0.1, 0.5, 3)
    t, dt, d = rng.uniform((0.0, 0.1, -1.0), (3.0, 1.0, 1.0))
    moment = np.array([t + share * dt])

    plane, n = lesson.make_plane((*normal, d)), normal / np.linalg.norm(normal)
    hit, way = x - ((normal @ x + d) / np.linalg.norm(normal) - r) * n, w - (w @ n + 1.0) * n    # towards the plane
    x_0, x_1 = hit - share * way, hit + (1.0 - share) * way
    worst.note("times", lesson.plane_impact_time(t, dt, x_0, x_1, r, plane), moment)
    end = lesson.continuous_step(lesson.ball_plane_gap, lesson.ball_plane_time, t, x_0, way / dt, dt,
                                 lesson.Target(r, R, plane))
    worst.note("times", end, (hit, 0.0 * hit))

    turn = 2.0 * np.pi * share
    out = np.array([0.0, np.cos(turn), np.sin(turn)])
    hit, way = np.array([x[0], 0.0, 0.0]) + (r + R) * out, w - (w @ out + 1.0) * out
    x_0, x_1 = hit - share * way, hit + (1.0 - share) * way
    worst.note("times", lesson.cylinder_impact_time(t, dt, x_0, x_1, r, R), moment)
    c = lesson.cylinder_hit(t, dt, x_0, x_1, r, R)
    worst.note("times", (c.p_a, c.p_b, c.n, np.array([c.gap, c.t])),
               (hit - r * out, hit - r * out, out, np.array([0.0, *moment])))


def cut_segment(lesson, rng, worst):
    """Note how far both parts of a segment, cut at a random place, are from where they should end."""
    ends, share = rng.normal(size=(2, 3)), rng.uniform(0.1, 0.5)
    along = ends[1] - ends[0]
    n, cut = along / np.linalg.norm(along), ends[0] + share * along
    for sign, part in ((1.0, (ends[0], cut)), (-1.0, (cut, ends[1]))):
        got = lesson.clip(ends, sign * n, sign * (n @ cut))
        worst.keep("cut", np.max(np.abs(got - part)) if got.shape == (2, 3) else np.inf)


def trees_agree(lesson, rng):
    """Whether two trees find the pairs of random boxes that brute force finds."""
    corners = rng.uniform(0.0, 4.0, (30, 2)), rng.uniform(0.0, 4.0, (20, 2))
    sets = [(low, low + rng.uniform(0.1, 0.5, low.shape)) for low in corners]
    found = lesson.find_intersections(*(lesson.build_tree(*boxes) for boxes in sets))
    return sorted(map(tuple, found.tolist())) == touching(*sets[0], *sets[1])


@case("points-and-times", "Where bodies touch, and when", compiled=False)
def points_and_times(lesson):
    """Points of contact lie on both bodies, at the nearest places; an impact is at its share of any step.

    The nearest points of segments and hulls are those of non-negative least squares.  A ball is thrown so that it
    touches after a known share of the step.
    """
    rng, worst, wrong = np.random.default_rng(69), Worst(), 0
    for _ in range(50):
        for check in (nearest_places, known_impacts, cut_segment):
            check(lesson, rng, worst)
        wrong += not trees_agree(lesson, rng)
    claims = (("points", "Points of contact are the nearest points, moved out by the radii.", "points [m]", 1e-9),
              ("hulls", "Two hulls are nearest where least squares says.", "nearest points [m]", 1e-6),
              ("times", "An impact is at its share of the step, whenever the step begins.", "times [s] and places [m]",
               1e-9),
              ("cut", "A segment is cut once.", "ends of a segment [m]", 1e-12))
    exact = exact_touches(lesson)
    others = ", ".join(what for what, right in exact.items() if not right) or "none"
    return [agreement(claim, f"largest error of the {quantity}", worst[name], limit)
            for name, claim, quantity, limit in claims] + [
        agreement("Two trees find the boxes of both that touch.", "trees with other pairs [of 50]", wrong, 0.0),
        finding(claim="What just touches is in contact, and ties are resolved as they are defined.",
                quantity=f"touches and ties as defined [of {len(exact)}]", predicted=len(exact),
                measured=sum(map(bool, exact.values())), tolerance=0.0,
                observation=f"Otherwise: {others}.")], None
