"""The curtain of the notebooks.  Each lesson adds something to it, made of the functions of that lesson.

Positions are (n, 2) arrays [m], x to the right and y up.  The upper left corner of the curtain is the origin.
"""

import numpy as np

from ..scenes import drawing

ROWS, COLS, CELL = 9, 13, 0.1                    # points down and across, and the distance between neighbours [m]
RINGS = tuple(range(0, COLS, 4))                 # points of the top row by which it hangs
DT, STEPS, FRAMES = 0.004, 8, 100                # step [s], steps per picture, pictures of a film
SECONDS = DT * STEPS * FRAMES                    # of a film [s]


def points():
    """Return positions of all points at the start."""
    return np.array([[CELL * column, -CELL * row] for row in range(ROWS) for column in range(COLS)])


def threads(springs):
    """Return the pairs of points that a thread joins; springs is lesson 2."""
    return springs.grid_pairs(ROWS, COLS, springs.STRUCTURAL + springs.SHEAR)


def network(springs, fixed=RINGS, wind=(0.03, 0.0)):
    """Return the curtain as a network of springs; springs is lesson 2."""
    return springs.make_spring_network(points(), m=0.01, fixed=fixed, pairs=threads(springs), k=60.0, k_d=0.02,
                                       gravity=(0.0, -9.81), wind=wind, k_v=0.004)


def film(step, law, p, x=None, dt=DT):
    """Return pictures of a motion from rest: step is a method of lesson 1, law an acceleration with parameters p."""
    x = points() if x is None else x
    v, t, frames = np.zeros_like(x), 0.0, []
    for _ in range(FRAMES):
        frames.append(x)
        for _ in range(round(DT * STEPS / dt)):
            x, v = step(law, t, x, v, dt, p)
            t += dt
    return frames


def folded(spread):
    """Return positions (n, 3) of all points, z towards the viewer, of a cloth with other distances of its rings.

    The distances are `spread` ≤ 1 times those in `points`.  The cloth stands in folds, one between two rings, and
    no thread changes its length.
    """
    depth = CELL * np.sqrt(1.0 - spread**2)
    x = points()
    return np.stack((spread * x[:, 0], x[:, 1], depth * np.tile(np.sin(0.5 * np.pi * np.arange(COLS)), ROWS)), axis=1)


def drawn(x):
    """Return points to draw (n, 2) of positions (n, 3): z comes obliquely towards the viewer, to the lower left."""
    return x[:, :2] + x[:, 2:] * [-0.4, -0.3]


def drawn_aside(step, law, network, spreads):
    """Return pictures (n, 3) of a curtain in space.

    In picture k its rings are spreads[k] times as far apart as in `points`.
    step is one of lesson 8, for a network whose immovable points are the rings: they keep the velocity that they get.
    """
    x, rings, frames = folded(spreads[0]), list(RINGS), []
    v = np.zeros_like(x)
    for before, after in zip(spreads, [*spreads[1:], spreads[-1]]):
        frames.append(x)
        for k in range(STEPS):
            spread = before + (after - before) * (k + 1) / STEPS
            v = v.copy()
            v[rings] = (folded(spread)[rings] - x[rings]) / DT
            x, v = step(law, DT * k, x, v, DT, network)
    return frames


def overlaid(films, links, place):
    """Return (films, links) for `play`: several films in one picture, each with its own points, links and colour.

    films is {label: pictures (n, 2)}, links has one list of pairs per film.  In the film of another label the points
    are hidden at `place`, where they move by 10 µm, because points that never move are drawn as nails.
    """
    counts = [len(pictures[0]) for pictures in films.values()]
    starts = np.cumsum([0, *counts])
    joined = {}
    for label in films:
        joined[label] = [np.concatenate([pictures[k] if name == label else
                                         np.tile(np.asarray(place) + 1e-5 * (k % 2), (len(pictures[0]), 1))
                                         for name, pictures in films.items()]) for k in range(len(films[label]))]
    return joined, [(start + i, start + j) for start, pairs in zip(starts, links) for i, j in pairs]


# ---------------------------------------------------------------------------------------------- in space

POLE, POLE_LENGTH = 0.02, 1.5                    # radius and length of the pole of lesson 4 [m]
KNOBS = (0.045, -0.795), (0.055, 0.805)          # radii of the balls at its ends, and their places along it [m]
RING_RADIUS, RING_WIRE = 0.06, 0.011             # of a ring, to the middle of its wire; of the wire [m]
HANG = POLE + RING_WIRE - RING_RADIUS            # height of the centre of a ring over the axis of the pole [m]
TOP = HANG - RING_RADIUS - RING_WIRE             # height of the upper hem of the curtain [m]
BALL = 0.06                                      # radius of the ball that is thrown at the pole [m]
THROW_FROM, THROW = np.array([0.0, -1.575, -0.51]), np.array([0.0, 6.3, 3.3])          # where from [m], and how [m/s]
THROW_DT, GRAVITY = 1.0 / 30.0, np.array([0.0, 0.0, -9.81])          # step [s], and [m/s²]
LEVEL = np.array([1.0, 0.0, 0.0, 0.0])           # the quaternion of a body that is not turned
ALONG_X = np.array([np.sqrt(0.5), 0.0, np.sqrt(0.5), 0.0])           # of a body whose z lies along the pole


def ring_mesh(radius, wire, around=24, across=8):
    """Return corners (n, 3) [m] and faces (k, 3) of a ring about z: a closed mesh, as lesson 4 takes it."""
    i, j = (part.ravel() for part in np.meshgrid(np.arange(around), np.arange(across), indexing="ij"))
    a, b = 2.0 * np.pi * i / around, 2.0 * np.pi * j / across
    out = radius + wire * np.cos(b)
    corner = lambda i, j: i % around * across + j % across
    faces = np.concatenate((np.stack((corner(i, j), corner(i + 1, j), corner(i + 1, j + 1)), axis=1),
                            np.stack((corner(i, j), corner(i + 1, j + 1), corner(i, j + 1)), axis=1)))
    return np.stack((out * np.cos(a), out * np.sin(a), wire * np.sin(b)), axis=1), faces


RING_MESH = ring_mesh(RING_RADIUS, RING_WIRE)
RING = drawing.mesh(*RING_MESH)


def sheet(slipped=False):
    """Return the hanging curtain as a shape about its middle: x lies along the pole, and z points up.

    If its first ring has slipped off, its corner hangs down.
    """
    x, y = points().T
    x, depth, height = x - 0.5 * CELL * (COLS - 1), 0.02 + 0.04 * y / y.min(), y - 0.5 * y.min()
    corner = np.maximum(0.0, 1.0 - (x - x.min()) / (CELL * RINGS[1])) if slipped else 0.0 * x
    height -= 0.22 * corner**2 * (1.0 - 0.5 * y / y.min())
    place = np.stack((x + 0.1 * corner**2, depth * np.sin(3.0 * np.pi * x / x.max()), height), axis=1)
    cells = [COLS * row + column for row in range(ROWS - 1) for column in range(COLS - 1)]
    front = np.array([face for a in cells for face in ((a, a + COLS, a + 1), (a + 1, a + COLS, a + COLS + 1))])
    behind = front[:, ::-1] + len(place)                             # a face is seen from one side only
    return drawing.mesh(np.concatenate((place, place + np.array([0.0, 1e-3, 0.0]))), np.concatenate((front, behind)))


def shapes(rings=RINGS, slipped=False):
    """Return the pole, two balls, the curtain and the rings in space, for show3d."""
    knobs = [drawing.sphere(radius) for radius, _ in KNOBS]
    return [drawing.cylinder(POLE, POLE_LENGTH), *knobs, sheet(slipped), *[RING] * len(rings)]


def still(rings=RINGS):
    """Return their poses (7,): the axis of the pole is the x axis."""
    ends = [np.concatenate(([place, 0.0, 0.0], LEVEL)) for _, place in KNOBS]
    hung = [np.concatenate(([CELL * (ring - 0.5 * (COLS - 1)), 0.0, HANG], ALONG_X)) for ring in rings]
    cloth = np.array([0.0, 0.0, TOP - 0.5 * CELL * (ROWS - 1), *LEVEL])
    return [np.concatenate((np.zeros(3), ALONG_X)), *ends, cloth, *hung]
