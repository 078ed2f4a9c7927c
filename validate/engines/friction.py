"""A block on a plane, and a particle, in the two engines: the comparison runs of lesson 3.

Both engines hold a resting block by impulses, as our sliding_step does, and differ from it in the order of motion:
pybullet moves with the new velocity, pymunk with the old one.  The contact exists from the first step if the block
begins with the overlap that its engine tolerates.  Otherwise it first falls that far, and friction comes late.
"""

from validate.engines.bullet import Bullet
from validate.engines.chipmunk import pymunk_space, pymunk_world
from validate.reference.friction import HALF
from validate.scene import EngineRun

# half its height [m]: friction acts that far below the centre and shifts the load forward by μ LOW.  With a cube and
# μ = 0.8 nearly all load is on the front edge, and pybullet's friction is up to 0.7 % too large
LOW = 0.1
MASS = 1.0                   # [kg]
INERTIA = MASS * ((2.0 * HALF) ** 2 + (2.0 * LOW) ** 2) / 12.0  # about the normal of pymunk's plane [kg m²]
OVERLAP = 1e-6               # pymunk: inside its collision_slop, 1e-5
SLOP = 1e-5                  # pybullet: the overlap that it tolerates in a contact [m]
# of the contact solvers: the contacts of a flat slab converge by a factor of 2 or more per sweep
SWEEPS = 100


def pymunk_block(gravity, mu, v, dt, read, push=None):
    """Make an EngineRun with a slab on the line y = 0: gravity (2,) tilted like the slope, push(t) → (2,) [N]."""
    import pymunk
    space = pymunk_space(gravity)
    space.iterations = SWEEPS
    floor = pymunk.Segment(space.static_body, (-100.0, 0.0), (100.0, 0.0), 0.0)
    # the engine multiplies the two coefficients
    floor.friction = 1.0
    body = pymunk.Body(MASS, INERTIA)
    body.position, body.velocity = (0.0, LOW - OVERLAP), (float(v), 0.0)
    slab = pymunk.Poly.create_box(body, (2.0 * HALF, 2.0 * LOW))
    slab.friction = mu
    space.add(floor, body, slab)
    world = pymunk_world(space, dt, lambda: read(body.position))
    if push is None:
        return world
    apply = lambda F: body.apply_force_at_world_point(F, body.position)
    return world._replace(step=pushed(world.step, dt, apply, push))


def bullet_block(gravity, mu, v, fastest, dt, read, push=None, pyramid=False):
    """Make an EngineRun with a slab on the floor z = 0: gravity, v (3,); fastest: its largest speed [m/s].

    pyramid: use a body of reduced coordinates, with friction in a box along x and y.
    """
    bullet = Bullet(dt, gravity)
    pb = bullet.pb
    reach = (2.0 * HALF**2 + LOW**2) ** 0.5      # the breaking threshold is relative to it; no step may exceed it
    pb.setPhysicsEngineParameter(numSolverIterations=SWEEPS, enableConeFriction=0 if pyramid else 1,
                                 contactBreakingThreshold=max(0.02, 1.2 * fastest * dt / reach))
    box = lambda m, half, z: pb.createMultiBody(
        m, pb.createCollisionShape(pb.GEOM_BOX, halfExtents=half), basePosition=[0.0, 0.0, z],
        useMaximalCoordinates=0 if pyramid else 1)
    ground = box(0.0, [20.0, 20.0, 1.0], -1.0)
    slab = box(MASS, [HALF, HALF, LOW], LOW - SLOP)
    # the engine multiplies the two coefficients
    pb.changeDynamics(ground, -1, lateralFriction=1.0)
    pb.changeDynamics(slab, -1, lateralFriction=mu, linearDamping=0, angularDamping=0, rollingFriction=0,
                      spinningFriction=0, **({"maxJointVelocity": 1e9} if pyramid else {}))
    pb.resetBaseVelocity(slab, list(map(float, v)))
    step = bullet.step
    if push is not None:
        step = pushed(bullet.step, dt, lambda F: bullet.push(slab, F, bullet.position(slab)), push)
    return EngineRun(step, lambda: read(bullet.position(slab)), bullet.close)


def pushed(step, dt, apply, push):
    """Return the same step with the force push(t) applied at its beginning."""
    clock = [0]

    def with_push():
        apply(push(clock[0] * dt))
        clock[0] += 1
        step()
    return with_push


def bullet_in_hollow(gravity, mu, x, v, fastest, wall, dt):
    """Make an EngineRun with a ball that slides, and cannot turn, inside a round wall.

    wall(x) → (nearest point (3,), inward normal (3,)).  pybullet has no hollow shapes except meshes of facets.
    Before each step its floor is therefore placed as the tangent plane of the wall under the ball.  Normal force
    and friction there are the engine's, and the error of the plane is of second order in v dt.
    """
    bullet, radius = Bullet(dt, gravity), 0.1
    pb = bullet.pb
    pb.setPhysicsEngineParameter(numSolverIterations=SWEEPS, enableConeFriction=1, contactSlop=0,
                                 contactBreakingThreshold=max(0.02, 1.2 * fastest * dt / radius))
    ground = pb.createMultiBody(0.0, pb.createCollisionShape(pb.GEOM_PLANE), useMaximalCoordinates=0)
    ball = pb.createMultiBody(MASS, pb.createCollisionShape(pb.GEOM_SPHERE, radius=radius),
                              basePosition=list(map(float, x)), useMaximalCoordinates=0)
    pb.changeDynamics(ground, -1, lateralFriction=1.0)
    pb.changeDynamics(ball, -1, mass=MASS, localInertiaDiagonal=[1e9] * 3, lateralFriction=mu, linearDamping=0,
                      angularDamping=0, rollingFriction=0, spinningFriction=0, maxJointVelocity=1e9)
    pb.resetBaseVelocity(ball, list(map(float, v)))

    def step():
        point, n = wall(bullet.position(ball))
        below = [float(c - radius * k) for c, k in zip(point, n)]
        # the shortest turn from z to n, as a quaternion (x, y, z, w)
        pb.resetBasePositionAndOrientation(ground, below, [-float(n[1]), float(n[0]), 0.0, 1.0 + float(n[2])])
        bullet.step()
    return EngineRun(step, lambda: bullet.position(ball), bullet.close)
