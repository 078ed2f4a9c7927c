"""The curtain of the notebooks.  Each lesson adds something to it, made of the functions of that lesson.

Positions are (n, 2) arrays [m], x to the right and y up.  The upper left corner of the curtain is the origin.
"""

import numpy as np

ROWS, COLS, CELL = 9, 13, 0.1                    # points down and across, and the distance between neighbours [m]
RINGS = tuple(range(0, COLS, 4))                 # points of the top row by which it hangs
DT, STEPS, FRAMES = 0.004, 8, 100                # step [s], steps per picture, pictures of a film
SECONDS = DT * STEPS * FRAMES                    # of a film [s]


def points():
    """Positions of all points at the start."""
    return np.array([[CELL * column, -CELL * row] for row in range(ROWS) for column in range(COLS)])


def threads(springs):
    """Pairs of points that a thread joins; springs is lesson 2."""
    return springs.grid_pairs(ROWS, COLS, springs.STRUCTURAL + springs.SHEAR)


def network(springs, fixed=RINGS, wind=(0.03, 0.0)):
    """The curtain as a network of springs; springs is lesson 2."""
    return springs.make_spring_network(points(), m=0.01, fixed=fixed, pairs=threads(springs), k=60.0, k_d=0.02,
                                       gravity=(0.0, -9.81), wind=wind, k_v=0.004)


def film(step, law, p, x=None, dt=DT):
    """Pictures of a motion from rest: step is a method of lesson 1, law an acceleration with parameters p."""
    x = points() if x is None else x
    v, t, frames = np.zeros_like(x), 0.0, []
    for _ in range(FRAMES):
        frames.append(x)
        for _ in range(round(DT * STEPS / dt)):
            x, v = step(law, t, x, v, dt, p)
            t += dt
    return frames


def folded(spread):
    """Positions (n, 3) of all points, z towards the viewer, when the rings are `spread` times as far apart as in
    `points`, at most 1: the cloth stands in folds, one between two rings, and no thread changes its length.
    """
    depth = CELL * np.sqrt(1.0 - spread**2)
    x = points()
    return np.stack((spread * x[:, 0], x[:, 1], depth * np.tile(np.sin(0.5 * np.pi * np.arange(COLS)), ROWS)), axis=1)


def drawn(x):
    """Points to draw (n, 2) of positions (n, 3): z comes obliquely towards the viewer, to the lower left."""
    return x[:, :2] + x[:, 2:] * [-0.4, -0.3]


def drawn_aside(step, law, network, spreads):
    """Pictures (n, 3) of a curtain in space; in picture k its rings are spreads[k] times as far apart as in `points`.

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
    """(films, links) for `play`: several films in one picture, each with its own points, links and colour.

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
