"""Moving points, swept balls and pairs of boxes in pybullet."""


import numpy as np

from validate.engines.bullet import Bullet
from validate.reference.collisions import Sweep
from validate.scene import EngineRun

SWEPT_SETTINGS = ("useMaximalCoordinates, ccdSweptSphereRadius {:g} r, contactProcessingThreshold, contactERP and "
                  "contactSlop 0")
# distance at which a ball gets contact points, over its radius [-]: the contactBreakingThreshold is relative to half
# the diagonal of the box around it
REACH = 0.02 * np.sqrt(3.0)
LEAST_WAY = 0.04             # m_allowedCcdPenetration: a sweep ignores what comes nearer by less in a step [m]


def across(x):
    """Return the coordinates (1, 2) of positions x (n, 3), in one row, because there is no motion along x."""
    return np.ravel(x[:, 1:])


def target(bullet, p, grown=0.0):
    """Make the static obstacle of a scene: the plane z = 0, or the cylinder about x with a radius larger by `grown`."""
    pb = bullet.pb
    if p.R == 0.0:
        shape, turn = pb.createCollisionShape(pb.GEOM_PLANE), [0.0, 0.0, 0.0, 1.0]
    else:
        shape = pb.createCollisionShape(pb.GEOM_CYLINDER, radius=p.R + grown, height=100.0)
        turn = [0.0, np.sqrt(0.5), 0.0, np.sqrt(0.5)]
    place = [0.0, 0.0, grown if p.R == 0.0 else 0.0]
    body = pb.createMultiBody(0.0, shape, basePosition=place, baseOrientation=turn, useMaximalCoordinates=1)
    pb.changeDynamics(body, -1, lateralFriction=0, restitution=0)
    return body


def bullet_rays(p, dt, place):
    """Make an EngineRun of points that move by one ray per step, at an obstacle grown by the radius of the ball.

    A point stops where its ray ends.
    """
    bullet, (x, v) = Bullet(dt), place(p)
    target(bullet, p, p.r)
    at, velocity = np.array(x), np.array(v)

    def step():
        there = at + dt * velocity
        hits = bullet.pb.rayTestBatch(at.tolist(), there.tolist())
        for k, (body, _, share, *_) in enumerate(hits):
            moving = np.any(velocity[k])
            at[k] = at[k] + (share if body >= 0 and moving else 1.0) * dt * velocity[k]
            if body >= 0 and moving:
                velocity[k] = 0.0
    return EngineRun(step, lambda: across(at), bullet.close)


def bullet_swept(p, dt, place, share):
    """Make an EngineRun of balls in maximal coordinates with continuous detection.

    share: the radius that Bullet sweeps, over that of the ball [-].  With all of it a ball sticks to a surface that it
    grazes.
    Each ball is read at the end of the step that detected its impact.  Its velocity changes only in the step after
    that.  A ball that moved less than v dt with its old velocity was stopped by the sweep.  A ball whose velocity
    has changed was found in contact at its previous position.
    """
    bullet, (x, v) = Bullet(dt), place(p)
    pb = bullet.pb
    pb.setPhysicsEngineParameter(contactERP=0, contactSlop=0, restitutionVelocityThreshold=0)
    target(bullet, p)
    shape = pb.createCollisionShape(pb.GEOM_SPHERE, radius=p.r)
    at, speed, bodies, done = np.array(x), np.linalg.norm(v[0]), [], [False] * len(x)
    for k in range(len(x)):
        body = pb.createMultiBody(1.0, shape, basePosition=x[k].tolist(), useMaximalCoordinates=1)
        pb.changeDynamics(body, -1, linearDamping=0, angularDamping=0, lateralFriction=0, restitution=0,
                          contactProcessingThreshold=0, ccdSweptSphereRadius=share * p.r)
        pb.resetBaseVelocity(body, v[k].tolist())
        bodies.append(body)

    def step():
        pb.stepSimulation()
        for k, body in enumerate(bodies):
            if not done[k]:
                there = np.array(bullet.position(body))
                if np.linalg.norm(np.subtract(bullet.velocity(body), v[k])) > 1e-6 * speed:
                    done[k] = True
                    continue
                done[k] = np.linalg.norm(there - at[k]) < (1.0 - 1e-9) * speed * dt - 1e-12
                at[k] = there
    return EngineRun(step, lambda: across(at), bullet.close)


def sweep(p, dt, share):
    """Return the Sweep of bullet_swept; None for steps that are shorter than half of the radius that it sweeps.

    *Source:* Bullet: changeDynamics sets the threshold of motion to half the radius; btDiscreteDynamicsWorld:
    integrateTransforms, and needsCollision and addSingleResult of btClosestNotMeConvexResultCallback.
    """
    return Sweep(share * p.r, (1.0 + REACH) * p.r, LEAST_WAY) if p.speed * dt >= 0.5 * share * p.r else None


def bullet_boxes(low, high):
    """Make a pybullet world with these boxes at rest: (Bullet, their bodies)."""
    bullet, bodies = Bullet(0.01), []
    for a, b in zip(low, high):
        shape = bullet.pb.createCollisionShape(bullet.pb.GEOM_BOX, halfExtents=(0.5 * (b - a)).tolist())
        bodies.append(bullet.pb.createMultiBody(0.0, shape, basePosition=(0.5 * (a + b)).tolist()))
    return bullet, bodies


def bullet_closest_pairs(low, high):
    """Return the pairs (m, 2) of boxes between which pybullet finds points of contact, with one query per pair."""
    bullet, bodies = bullet_boxes(low, high)
    ask = lambda i, j: bullet.pb.getClosestPoints(bodies[i], bodies[j], 0.0)
    found = [(i, j) for i in range(len(low)) for j in range(i + 1, len(low)) if ask(i, j)]
    bullet.close()
    return np.array(found).reshape(-1, 2)


def bullet_query_pairs(low, high):
    """Return the pairs (m, 2) of pybullet's broad phase: each box, and those whose enlarged bounds overlap it.

    A step is needed to register the boxes.
    """
    bullet, bodies = bullet_boxes(low, high)
    bullet.step()
    number, found = {body: k for k, body in enumerate(bodies)}, []
    for k in range(len(low)):
        there = bullet.pb.getOverlappingObjects(low[k].tolist(), high[k].tolist()) or ()
        found += [(k, number[body]) for body, _ in there if number[body] > k]
    bullet.close()
    return np.array(found).reshape(-1, 2)
