"""Distances, impacts and pairs by other means, and the two engines asked for the same: the witnesses of lesson 6.

Nothing here knows the functions of `solutions`.  Distances of convex bodies are least squares with weights that are not negative (SciPy's
nnls), first roots are SciPy's brentq, pairs are NumPy's comparison of all with all.
"""

import numpy as np
from scipy.optimize import brentq, nnls
from scipy.spatial import ConvexHull

from .engines import Bullet
from .scene import Method, World

DISCRETE = Method("discrete_step", "discrete", 1, "collisions")
CONTINUOUS = Method("continuous_step", "continuous", 2, "collisions")
BRUTE_FORCE = Method("all_pairs", "brute force", 1, "collisions")
GJK = Method("gjk", "GJK", 1, "collisions")
NARROW = Method("ball_contact", "narrow phase", 2, "collisions")
AXES = Method("box_separation", "separating axes", 2, "collisions")
TREES = Method("tree_pairs", "trees", 2, "collisions")

COPIES = 16                  # balls that fly at once, so that their impacts fall on all phases of a step
GOLDEN = 0.5 * (np.sqrt(5.0) - 1.0)
EARLIEST, SPREAD = 0.3, 0.4  # of the output time: when the impacts are
PLACE_APART = 1.0            # metre between two copies along the x axis
SWEPT = 0.8                  # radius that pybullet sweeps over that of the ball [-]: with the whole of it a ball sticks to what it grazes
RAY_ENDS = 1e-2              # how far in front of a round shape pybullet's rays may end [m]: measured, not derived.  They come near from outside,
#                              and twenty that were tried beforehand ended up to 1.2 mm early; this allows eight times that


def impact_times(T):
    """When each copy hits [s]: at EARLIEST + SPREAD {k φ} of T, φ the golden section, which is spread over the steps of any length."""
    return T * (EARLIEST + SPREAD * ((np.arange(COPIES) + 1.0) * GOLDEN % 1.0))


def across(x):
    """The coordinates (1, 2) of places x (n, 3), in one row: nothing ever moves along x."""
    return np.ravel(x[:, 1:])


def first_root(gap, t_0, t_1):
    """The time between t_0 (gap above zero) and t_1 (below) at which gap(t) is zero, to the last digit."""
    return brentq(gap, t_0, t_1, xtol=1e-300, rtol=4.0 * np.finfo(float).eps)


def hull_nearest(a, b, weight=1e3):
    """(p, q): the points of the hulls of a (k, d) and b (m, d) that are nearest: min |Σ α a − Σ β b| over α, β ≥ 0 with Σ α = Σ β = 1.

    The two sums enter as rows of that weight, which leaves a relative error of about 1/weight² (a penalty); so the answer is only the start:
    the points that carry weight span flat parts of the two bodies, and the nearest points of those are a linear system, solved exactly.
    *Source:* Lawson and Hanson 1974, chapter 23.
    """
    one, none = np.ones(len(a)), np.zeros(len(a))
    rows = np.vstack((np.hstack((a.T, -b.T)), weight * np.hstack((one, np.zeros(len(b)))), weight * np.hstack((none, np.ones(len(b))))))
    shares, _ = nnls(rows, np.append(np.zeros(a.shape[1]), [weight, weight]))
    p, q = a[shares[:len(a)] > 1e-9], b[shares[len(a):] > 1e-9]
    span = np.vstack((p[1:] - p[0], q[0] - q[1:]))
    c = np.linalg.lstsq(span.T, q[0] - p[0], rcond=None)[0] if len(span) else np.zeros(0)
    split = len(p) - 1
    return p[0] + c[:split] @ (p[1:] - p[0]), q[0] + c[split:] @ (q[1:] - q[0])


def depth_of(a, b):
    """(gap, n) of two hulls that overlap, from b to a: the face of the hull of all differences a − b that is nearest to 0.

    *Source:* the Minkowski difference; SciPy's ConvexHull (Qhull) for its faces n · y + offset = 0.
    """
    faces = ConvexHull((a[:, None] - b[None]).reshape(-1, a.shape[1])).equations
    nearest = faces[np.argmax(faces[:, -1])]
    return float(nearest[-1]), -nearest[:-1]


def all_touching(low, high):
    """Pairs (m, 2), i < j, of boxes low, high (n, d) that have a point in common, by comparing all with all, 500 rows at a time."""
    found = []
    for first in range(0, len(low), 500):
        part = slice(first, first + 500)
        i, j = np.nonzero(np.all((low[part, None] <= high[None]) & (low[None] <= high[part, None]), axis=2))
        found.append(np.stack((i + first, j), axis=1)[i + first < j])
    return np.concatenate(found)


# ---------------------------------------------------------------------------------------------- pybullet

def target(bullet, p, grown=0.0):
    """The obstacle of a scene as a static body: the plane z = 0, or the cylinder about x, its radius grown by that of the ball."""
    pb, client = bullet.pb, {"physicsClientId": bullet.client}
    if p.R == 0.0:
        shape, turn = pb.createCollisionShape(pb.GEOM_PLANE, **client), [0.0, 0.0, 0.0, 1.0]
    else:
        shape, turn = pb.createCollisionShape(pb.GEOM_CYLINDER, radius=p.R + grown, height=100.0, **client), [0.0, np.sqrt(0.5), 0.0, np.sqrt(0.5)]
    body = pb.createMultiBody(0.0, shape, basePosition=[0.0, 0.0, grown if p.R == 0.0 else 0.0], baseOrientation=turn, useMaximalCoordinates=1, **client)
    pb.changeDynamics(body, -1, lateralFriction=0, restitution=0, **client)
    return body


def bullet_rays(p, x, v, dt):
    """A World of points that fly on by rays, one a step, at an obstacle grown by the radius of the ball; where a ray ends they stay."""
    bullet = Bullet(dt)
    target(bullet, p, p.r)
    at, velocity = np.array(x), np.array(v)

    def step():
        there = at + dt * velocity
        hits = bullet.pb.rayTestBatch(at.tolist(), there.tolist(), physicsClientId=bullet.client)
        for k, (body, _, share, *_) in enumerate(hits):
            moving = np.any(velocity[k])
            at[k] = at[k] + (share if body >= 0 and moving else 1.0) * dt * velocity[k]
            if body >= 0 and moving:
                velocity[k] = 0.0
    return World(step, lambda: across(at), bullet.close)


def bullet_swept(p, x, v, dt):
    """A World of balls of maximal coordinates with continuous detection; each is read where the step left it in which it was found.

    Their velocity changes only in the step after that, so a ball that went less far than v dt with its old velocity was stopped by the
    sweep; one whose velocity has changed was found in contact where it was before.
    """
    bullet = Bullet(dt)
    pb, client = bullet.pb, {"physicsClientId": bullet.client}
    pb.setPhysicsEngineParameter(contactERP=0, contactSlop=0, restitutionVelocityThreshold=0, **client)
    target(bullet, p)
    shape = pb.createCollisionShape(pb.GEOM_SPHERE, radius=p.r, **client)
    at, speed, bodies, done = np.array(x), np.linalg.norm(v[0]), [], [False] * len(x)
    for k in range(len(x)):
        body = pb.createMultiBody(1.0, shape, basePosition=x[k].tolist(), useMaximalCoordinates=1, **client)
        pb.changeDynamics(body, -1, linearDamping=0, angularDamping=0, lateralFriction=0, restitution=0, contactProcessingThreshold=0,
                          ccdSweptSphereRadius=SWEPT * p.r, **client)
        pb.resetBaseVelocity(body, v[k].tolist(), **client)
        bodies.append(body)

    def step():
        pb.stepSimulation(**client)
        for k, body in enumerate(bodies):
            if not done[k]:
                there = np.array(bullet.position(body))
                if np.linalg.norm(np.subtract(bullet.velocity(body), v[k])) > 1e-6 * speed:
                    done[k] = True
                    continue
                done[k] = np.linalg.norm(there - at[k]) < (1.0 - 1e-9) * speed * dt - 1e-12
                at[k] = there
    return World(step, lambda: across(at), bullet.close)


def swept_limit(p, dt):
    """How far from its place of impact [m] a ball may be found by bullet_swept.

    Steps shorter than half the swept radius are not swept: then a ball is found in by at most v dt.  Longer ones end where the swept sphere
    touches, with the ball in by (1 − SWEPT) r, or before, where the ball itself is found in by less.
    *Source:* Bullet: changeDynamics sets the threshold of motion to half the radius; btDiscreteDynamicsWorld::integrateTransforms.
    """
    return p.speed * dt if p.speed * dt < 0.5 * SWEPT * p.r else max((1.0 - SWEPT) * p.r, 0.0)


def bullet_boxes(low, high):
    """A pybullet world with these boxes, standing: (Bullet, their bodies)."""
    bullet, bodies = Bullet(0.01), []
    client = {"physicsClientId": bullet.client}
    for a, b in zip(low, high):
        shape = bullet.pb.createCollisionShape(bullet.pb.GEOM_BOX, halfExtents=(0.5 * (b - a)).tolist(), **client)
        bodies.append(bullet.pb.createMultiBody(0.0, shape, basePosition=(0.5 * (a + b)).tolist(), **client))
    return bullet, bodies


def bullet_closest_pairs(low, high):
    """Pairs (m, 2) of boxes between which pybullet finds points of contact, asked for every pair."""
    bullet, bodies = bullet_boxes(low, high)
    ask = lambda i, j: bullet.pb.getClosestPoints(bodies[i], bodies[j], 0.0, physicsClientId=bullet.client)
    found = [(i, j) for i in range(len(low)) for j in range(i + 1, len(low)) if ask(i, j)]
    bullet.close()
    return np.array(found).reshape(-1, 2)


def bullet_query_pairs(low, high):
    """Pairs (m, 2) as pybullet's broad phase knows them: for every box those whose own are in reach of it.  A step makes it take them in."""
    bullet, bodies = bullet_boxes(low, high)
    bullet.step()
    number, found = {body: k for k, body in enumerate(bodies)}, []
    for k in range(len(low)):
        there = bullet.pb.getOverlappingObjects(low[k].tolist(), high[k].tolist(), physicsClientId=bullet.client) or ()
        found += [(k, number[body]) for body, _ in there if number[body] > k]
    bullet.close()
    return np.array(found).reshape(-1, 2)
