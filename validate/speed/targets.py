"""Inverse kinematics of lesson 11 compared with pybullet, as ratios of one run: `validate targets [ARM …]`.

Arms: planar (three joints, in the plane), spatial (six joints, a place in space).  Both solve the same targets, drawn
from angles and so within reach, all from the same start, in turn.  Times are CPU times of one thread; of pybullet only
calculateInverseKinematics is timed.  Residuals of both are found with matrices of our own (`spatial_end`).

pybullet's damping of ½ m² is far from the best for these arms, and most of the ratio is that.  The second row of each
arm gives it our damping: then both take as many iterations, and the ratio is one of implementations.
"""

import time

import numpy as np
from rich.console import Console
from rich.table import Table

from solutions.checks import BadInput
from solutions.support.chains import make_arm_2d, make_arm_3d

from ..engines.kinematics import BulletChain
from ..engines.products import PYBULLET
from ..reference.kinematics import spatial_end
from ..scene import check_known
from ..subject import modules

THRESHOLD = 1e-4             # residual that pybullet asks for by default [m]
MOST = 200                   # iterations of either
X, Y, Z = np.eye(3)
ARMS = {                     # {name: (axes, offsets, start, damping λ of ours [m])}
    "planar": (np.stack((Z, Z, Z)), np.outer((1.0, 0.7, 0.4), X), np.array([0.2, 0.6, 0.5]), 0.03),
    "spatial": (np.stack((Z, Y, Y, X, Y, X)),
                np.array([0.4 * Z, 0.6 * X, 0.25 * X, 0.25 * X, 0.1 * X, 0.1 * X]),
                np.array([0.2, -0.4, 0.9, 0.3, 0.5, 0.2]), 0.03),
}
ENGINES = {                  # {label: (whether it gets our damping, goal: least ratio of times, engine over ours)}
    "pybullet, damping ½ m²": (False, "10"),
    "pybullet, damping as ours": (True, "–"),
}


def residuals(thetas, targets, axes, offsets):
    """Return distances [m] from the ends to their targets."""
    ends = np.array([spatial_end(theta, axes, offsets)[0] for theta in thetas])
    return np.linalg.norm(ends - targets, axis=1)


def drawn(name, n):
    """Return n targets (n, 3) that this arm reaches, so near its start that every method finds them."""
    axes, offsets, start, _ = ARMS[name]
    rng = np.random.default_rng(1)
    return np.array([spatial_end(start + rng.uniform(-1.0, 1.0, len(start)), axes, offsets)[0] for _ in range(n)])


def ours(lesson, name, targets, tolerance):
    """Return () → angles (n, joints): a damped search for each target, all in one compiled call."""
    axes, offsets, start, damping = ARMS[name]
    settings = (0.0, damping, -np.inf, np.inf, 0.0, 0.0)
    if name == "planar":
        arm, task, places = make_arm_2d(offsets[:, 0], *settings), lesson.reach_2d, targets[:, :2].copy()
    else:
        arm, task, places = make_arm_3d(axes, offsets, *settings), lesson.reach_3d, targets
    return lambda: lesson.solve_targets(lesson.damped_step, task, start, places, tolerance, MOST, arm)[0]


def theirs(name, targets, our_damping):
    """Return () → the same by pybullet, which stops at THRESHOLD or after MOST iterations."""
    axes, offsets, start, damping = ARMS[name]
    engine, places = BulletChain(axes, offsets), targets.tolist()
    engine.begin(start)
    more = {"maxNumIterations": MOST, "residualThreshold": THRESHOLD}
    if our_damping:
        more["jointDamping"] = [damping**2] * len(axes)
    search, body, last, client = engine.pb.module.calculateInverseKinematics, engine.body, engine.n, engine.client
    return lambda: [search(body, last, place, physicsClientId=client, **more) for place in places]


def cpu_time(work):
    began = time.thread_time()
    work()
    return time.thread_time() - began


def compare(lesson, name, n, rounds):
    """Return rows (label, ratio, low, high, goal, µs, µs, both residuals) of one arm, one per setting of pybullet.

    Ours stops at the median of the residuals that pybullet has reached, so it solves each target at least as well as
    pybullet solves half of them.
    """
    axes, offsets, _, _ = ARMS[name]
    targets = drawn(name, n)
    for label, (our_damping, goal) in ENGINES.items():
        engine = theirs(name, targets, our_damping)
        left = residuals(engine(), targets, axes, offsets)
        search = ours(lesson, name, targets, float(np.median(left)))
        found = residuals(search(), targets, axes, offsets)              # compiles, too
        times = np.array([(cpu_time(search), cpu_time(engine)) for _ in range(rounds)])
        ratios = np.sort(times[:, 1] / times[:, 0])
        yield (label, np.median(ratios), ratios[rounds // 4], ratios[-1 - rounds // 4], goal,
               *(1e6 * np.median(times, axis=0) / n), found, left)


def measure(arms, targets, rounds):
    """Print the races of some arms; of all without names.  Raises BadInput for an unknown arm, or without pybullet."""
    check_known("arm", arms, ARMS)
    if not PYBULLET.installed():
        raise BadInput("engine 'pybullet'", "not installed", "run this where it is: nothing else can be compared")
    lesson = modules.bind("kinematics", compiled=True)
    table = Table("arm", "engine", "time, engine / ours", "middle half", "goal", "ours [µs]", "engine [µs]",
                  "residual, ours [m]", "engine [m]")
    spread = lambda left: f"median {np.median(left):.0e}, worst {np.max(left):.0e}"
    for name in arms or ARMS:
        for row in compare(lesson, name, targets, rounds):
            label, ratio, low, high, goal, *times, found, left = row
            table.add_row(f"{targets} targets, {name}", label, f"{ratio:.1f}", f"{low:.1f}–{high:.1f}",
                          goal, *(f"{one:.2f}" for one in times), spread(found), spread(left))
    Console(width=180).print(table)
