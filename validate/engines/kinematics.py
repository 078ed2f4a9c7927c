"""pybullet's inverse kinematics of planar arms.  IK_SDLS is never asked for: it ends the process in 3.2.7."""

import numpy as np

from .bullet import Bullet


class BulletArm(Bullet):
    """A planar arm with a fixed base: revolute joints about z, links along x, and a link without size as the end."""

    def __init__(self, lengths):
        super().__init__(1.0)
        n, zero, still = len(lengths), [0.0, 0.0, 0.0], [0.0, 0.0, 0.0, 1.0]
        places = [zero, *([float(length), 0.0, 0.0] for length in lengths)]
        kinds = [self.pb.JOINT_REVOLUTE] * n + [self.pb.JOINT_FIXED]
        every = range(n + 1)
        self.n, self.body = n, self.pb.createMultiBody(
            0, -1, -1, zero, still, linkMasses=[1.0 for _ in every], linkCollisionShapeIndices=[-1 for _ in every],
            linkVisualShapeIndices=[-1 for _ in every], linkPositions=places, linkOrientations=[still for _ in every],
            linkInertialFramePositions=[zero for _ in every], linkInertialFrameOrientations=[still for _ in every],
            linkParentIndices=list(every), linkJointTypes=kinds, linkJointAxis=[[0.0, 0.0, 1.0] for _ in every])

    def solve(self, theta, target, direction=None, damping=None, iterations=None, threshold=None):
        """Angles (n,) for a target (2,), from the angles θ; direction [rad] of the last link, damping d [m²]."""
        for k, angle in enumerate(theta):
            self.pb.resetJointState(self.body, k, float(angle))
        more = {}
        if direction is not None:
            more["targetOrientation"] = [0.0, 0.0, float(np.sin(0.5 * direction)), float(np.cos(0.5 * direction))]
        if damping is not None:
            more["jointDamping"] = [float(damping)] * self.n
        if iterations is not None:
            more["maxNumIterations"] = int(iterations)
        if threshold is not None:
            more["residualThreshold"] = float(threshold)
        place = [float(target[0]), float(target[1]), 0.0]
        return np.array(self.pb.calculateInverseKinematics(self.body, self.n, place, **more))
