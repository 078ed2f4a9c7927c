"""Moving points, swept balls and pairs of boxes in pybullet, and what the scenes of moving points share."""

from functools import partial

import numpy as np

from solutions.checks import check_positive
from solutions.collisions import Plane
from solutions.given.collisions import Target
from validate.engines.bullet import Bullet
from validate.methods import CONTINUOUS, DISCRETE
from validate.reference.collisions import COPIES, ONLY_ROUND_OFF
from validate.scene import EXACT, PYBULLET, EngineRun, engine, ours

PLACE_APART = 1.0            # metre between two copies along the x axis

ENGINE_SPEEDS = (1.0, 1e2, 1e4)  # of the balls in an engine [m/s]: the lowest, the middle, the highest

# radius that pybullet sweeps over that of the ball [-]: with all of it a ball sticks to a surface that it grazes
SWEPT = 0.8
SWEPT_SETTINGS = (f"useMaximalCoordinates, ccdSweptSphereRadius {SWEPT:g} r, contactProcessingThreshold, contactERP "
                  "and contactSlop 0")

# how far in front of a round shape pybullet's rays may end [m]: measured, not derived.  Rays approach from outside;
# twenty tested beforehand ended up to 1.2 mm early, and this permits eight times that
RAY_ENDS = 1e-2


def across(x):
    """Return the coordinates (1, 2) of positions x (n, 3), in one row, because there is no motion along x."""
    return np.ravel(x[:, 1:])


def start_balls(place, positive):
    """Return start(p) of the balls (x, v) = place(p); it raises BadInput unless these parameters are positive."""
    def start(p):
        for name in positive:
            check_positive(name, getattr(p, name))
        return *place(p), Target(p.r, p.R, Plane(np.array([0.0, 0.0, 1.0]), 0.0))
    return start


def observe_balls(state, p):
    """Return the places of the balls that may hit, in one row."""
    return across(state[0][:COPIES])


def target(bullet, p, grown=0.0):
    """Make the static obstacle of a scene: the plane z = 0, or the cylinder about x, its radius larger by `grown`."""
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


def bullet_swept(p, dt, place):
    """Make an EngineRun of balls in maximal coordinates with continuous detection.

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
                          contactProcessingThreshold=0, ccdSweptSphereRadius=SWEPT * p.r)
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


def ball_runners(place, fastest, limits, late, obstacle, rays, swept):
    """Return the runners of a scene of balls that stop at an obstacle: our methods, and pybullet's two ways.

    place(p) → (x, v), each (n, 3)       fastest [m/s] with which the discrete test can deal
    limits, late    of our methods: limits, and the field `predicted` of the discrete test
    obstacle        of the rays, in words
    rays, swept     {field: its value} of the Runner of each way of pybullet
    """
    def slow_enough(p):
        return p.speed <= fastest

    def some_speeds(p):
        return p.speed in ENGINE_SPEEDS
    return (
        ours(CONTINUOUS, limit=limits, predicted=ONLY_ROUND_OFF, order=EXACT),
        ours(DISCRETE, limit=limits, predicted=late, supports=slow_enough),
        engine(PYBULLET, "rays", partial(bullet_rays, place=place), f"one rayTestBatch per step, at a {obstacle}",
               supports=some_speeds, most_steps=100, **rays),
        engine(PYBULLET, "swept", partial(bullet_swept, place=place), SWEPT_SETTINGS,
               supports=some_speeds, most_steps=200, **swept),
    )


def swept_radius(p, dt):
    """Return the radius [m] of the sphere that bullet_swept sweeps in a step; None for steps that are not swept.

    Those are shorter than half of it.  *Source:* Bullet: changeDynamics sets the threshold of motion to half the
    radius; btDiscreteDynamicsWorld::integrateTransforms.
    """
    return SWEPT * p.r if p.speed * dt >= 0.5 * SWEPT * p.r else None


def swept_limit(p, dt):
    """Return the largest distance [m] between the position of bullet_swept and the place of impact.

    Without a sweep a ball is at most v dt deep.  With one it ends where the swept sphere touches, with the ball
    (1 − SWEPT) r deep, or earlier, where the ball itself is found less deep.
    """
    return p.speed * dt if swept_radius(p, dt) is None else (1.0 - SWEPT) * p.r


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
    """Return the pairs (m, 2) of pybullet's broad phase: for every box those whose enlarged boxes overlap it.

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
