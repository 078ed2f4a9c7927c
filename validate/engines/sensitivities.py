"""Derivatives of MuJoCo's step by its own differences, multiplied from step to step."""

import numpy as np

from ..scene import EngineRun
from .mujoco import inertial, module, text, world


def mujoco_tangents(m, k, c, x0, dt, apart, integrator):
    """Make the EngineRun of a mass on a spring k with a damper c, released at x0, and of its sensitivities.

    The forces −k x and −c v are those of two actuators with the gains −x and −v, so k and c are controls, and
    `mjd_transitionFD` differentiates a step with respect to them: (x, v)⁺ = A (x, v) + B (k, c) to first order.
    apart: the step of its central differences.   read: (x, k ∂x/∂k, c ∂x/∂c).
    """
    actuator = lambda gain: f'<general joint="slide" gaintype="affine" gainprm="{text(gain)}" ctrllimited="false"/>'
    more = f"<actuator>{actuator((0.0, -1.0, 0.0))}{actuator((0.0, 0.0, -1.0))}</actuator>"
    body = f'<body><joint name="slide" type="slide" axis="1 0 0"/>{inertial(m, np.ones(3))}</body>'
    model, data = world(dt, body, integrator=integrator, more=more)
    data.qpos[0], data.ctrl[:] = x0, (k, c)
    A, B, S, inputs = np.zeros((2, 2)), np.zeros((2, 2)), np.zeros((2, 2)), np.array([k, c])
    differentiate, advance = module().mjd_transitionFD, module().mj_step

    def step():
        nonlocal S
        differentiate(model, data, apart, True, A, B, None, None)
        S = A @ S + B * inputs
        advance(model, data)
    return EngineRun(step, lambda: np.array([data.qpos[0], *S[0]]), lambda: None)
