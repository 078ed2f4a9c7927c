"""pybullet's inverse kinematics of arms.

IK_SDLS is not used, because it ends the process in version 3.2.7.
"""

import numpy as np

from validate.scene import EngineRun

from .bullet import Bullet


class BulletChain(Bullet):
    """An arm with a fixed base, revolute joints and a link without size as its end; axes and offsets as in Arm3D."""

    def __init__(self, axes, offsets):
        super().__init__(1.0)
        n, zero, still = len(axes), [0.0, 0.0, 0.0], [0.0, 0.0, 0.0, 1.0]
        places = [zero, *(list(map(float, offset)) for offset in offsets)]
        directions = [*(list(map(float, axis)) for axis in axes), [0.0, 0.0, 1.0]]
        kinds = [self.pb.JOINT_REVOLUTE] * n + [self.pb.JOINT_FIXED]
        every = range(n + 1)
        self.n, self.body = n, self.pb.createMultiBody(
            0, -1, -1, zero, still, linkMasses=[1.0 for _ in every], linkCollisionShapeIndices=[-1 for _ in every],
            linkVisualShapeIndices=[-1 for _ in every], linkPositions=places, linkOrientations=[still for _ in every],
            linkInertialFramePositions=[zero for _ in every], linkInertialFrameOrientations=[still for _ in every],
            linkParentIndices=list(every), linkJointTypes=kinds, linkJointAxis=directions)

    def begin(self, theta):
        """Set the angles from which every search starts; no search changes them."""
        for k, angle in enumerate(theta):
            self.pb.resetJointState(self.body, k, float(angle))

    def search(self, target, **more):
        """Return the angles that pybullet finds for a target [x, y, z]."""
        return self.pb.calculateInverseKinematics(self.body, self.n, target, **more)


class BulletArm(BulletChain):
    """A planar arm: joints about z, links along x."""

    def __init__(self, lengths):
        super().__init__(np.tile((0.0, 0.0, 1.0), (len(lengths), 1)), np.outer(lengths, (1.0, 0.0, 0.0)))

    def solve(self, theta, target, direction=None, damping=None, iterations=None, threshold=None):
        """Return angles (n,) for a target (2,), from the angles θ; direction [rad] of the last link, damping d [m²]."""
        self.begin(theta)
        more = {}
        if direction is not None:
            more["targetOrientation"] = [0.0, 0.0, float(np.sin(0.5 * direction)), float(np.cos(0.5 * direction))]
        if damping is not None:
            more["jointDamping"] = [float(damping)] * self.n
        if iterations is not None:
            more["maxNumIterations"] = int(iterations)
        if threshold is not None:
            more["residualThreshold"] = float(threshold)
        return np.array(self.search([float(target[0]), float(target[1]), 0.0], **more))


def bullet_reach(lengths, starts, observe, target, direction=None, **settings):
    """Make an EngineRun of searches by a planar arm, one from each start; read: observe(their angles).

    There are no steps: each search runs when it is read.  The settings are those of BulletArm.solve.
    """
    arm = BulletArm(lengths)
    read = lambda: observe([arm.solve(theta, target, direction, **settings) for theta in starts])
    return EngineRun(lambda: None, read, arm.close)
