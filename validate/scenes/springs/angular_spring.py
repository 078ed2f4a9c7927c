"""A rod on a torsion spring is released at one radian: with the spring, as a pendulum without it, and with both."""

from functools import cache
from typing import Annotated, NamedTuple

import numpy as np
from scipy.integrate import solve_ivp
from scipy.special import ellipj, ellipk

from validate.check import states
from validate.engines import mujoco
from validate.engines.chipmunk import pymunk_space, pymunk_world
from validate.methods import RK4
from validate.reference.schemes import Model, Motion
from validate.scene import MUJOCO, PYMUNK, Scene, by_order, engine
from validate.scenes._common import ONE_LINK, check_positives, coordinates, floor_of, measured
from validate.scenes.integrators._common import integrator_runners

T = 2.5  # [s]: about two periods; no case is then at a turning point, where phase errors are invisible
STEPS = (100, 200, 500, 1000, 2000, 5000, 10000)
# the hinge, and the end of the fixed arm [m]
HINGE = np.zeros(2)
DOWN = np.array([0.0, -1.0])
UNCERTAINTY = 1e-12          # of DOP853, where both act; the closed forms are ten times better


class Params(NamedTuple):
    kappa: Annotated[float, "torsion spring [N m/rad]; 0: no spring"] = 10.0
    g: Annotated[float, "gravity [m/s²]; negative: the rod stands instead of hanging"] = 0.0
    m: Annotated[float, "uniform rod [kg]"] = 1.0
    length: Annotated[float, "[m], hinged at one end"] = 1.0
    theta0: Annotated[float, "initial angle from the vertical, counter-clockwise [rad]"] = 1.0


CASES = {"spring": Params(), "gravity": Params(kappa=0.0, g=9.81), "spring and gravity": Params(g=9.81),
         "standing": Params(g=-9.81), "spring, other side": Params(theta0=-1.0)}


def inertia(p):
    """Return the moment of inertia about the hinge [kg m²]."""
    return p.m * p.length**2 / 3.0


def acceleration(lessons):
    angular_spring_forces = lessons.springs.angular_spring_forces

    def swing(t, x, v, p):
        """θ̈ = (r × F_c − ½ m g length sin θ)/I,  r = length (sin θ, −cos θ),  F_c: the spring's force on the end.

        The other arm hangs straight down and is fixed.  F_c ⊥ r has the moment −κ θ about the hinge for any length
        of the arm.
        """
        r = np.array([p.length * np.sin(x[0]), -p.length * np.cos(x[0])])
        F_c = angular_spring_forces(DOWN, HINGE, r, 0.0, p.kappa)[2]
        moment = r[0] * F_c[1] - r[1] * F_c[0] - 0.5 * p.m * p.g * p.length * np.sin(x[0])
        return np.array([moment * 3.0 / (p.m * p.length * p.length)])
    return swing


def start(p):
    check_positives(p, "m", "length")
    return np.array([p.theta0]), np.zeros(1)


def run(lessons, step, acceleration, state, p, dt, steps):
    x, v = state
    return lessons.integrators.advance(step, acceleration, 0.0, x, v, dt, steps, p)


def truth(p, t):
    """θ(t) of the spring alone, of gravity alone, or of both.

    spring     θ₀ cos ωt,  ω² = κ/I
    gravity    2 arcsin(k sn(K + ωt, k²)),  ω² = m g length/2I,  k = sin ½θ₀
    both       θ̈ = −(κ θ + ½ m g length sin θ)/I, by DOP853 at a relative tolerance of 1e-13
    Source: for gravity, Landau and Lifshitz, Mechanics, § 11, in Jacobi's functions; I = m length²/3.
    """
    if p.g == 0.0:
        return np.array([p.theta0 * np.cos(np.sqrt(p.kappa / inertia(p)) * t)])
    if p.kappa == 0.0 and p.g > 0.0:
        omega, k = np.sqrt(0.5 * p.m * p.g * p.length / inertia(p)), np.sin(0.5 * p.theta0)
        sn = ellipj(ellipk(k * k) + omega * t, k * k)[0]
        return np.array([2.0 * np.arcsin(k * sn)])
    return reference(p)(t)


@cache
def reference(p):
    law = lambda t, y: (y[1], -(p.kappa * y[0] + 0.5 * p.m * p.g * p.length * np.sin(y[0])) / inertia(p))
    run = solve_ivp(law, (0.0, T), (p.theta0, 0.0), method="DOP853", rtol=1e-13, atol=1e-15, dense_output=True)
    return lambda t: (run.y[:, -1] if t == T else run.sol(t))[:1]


def limits(p, dt):
    """The fastest rate is that of spring and gravity together; the error is relative to θ(T), which is smaller than θ₀.

    pymunk moves the centre of the rod and rotates it, then pulls the end back to the hinge: symplectic Euler, order
    1.  The correction of the hinge per step, ½ length θ̇² dt, is of the same order at the same rate: θ̇ ≤ rate θ₀
    and θ₀ ≤ 1.
    """
    rate = np.sqrt((p.kappa + 0.5 * p.m * abs(p.g) * p.length) / inertia(p))
    shrunk = abs(p.theta0 / truth(p, T)[0])
    return {k: shrunk * limit + UNCERTAINTY for k, limit in by_order(rate, T, dt).items()}


def law(p):
    """Return θ̈(t, θ, θ̇), independent of the lesson's."""
    return lambda t, theta, rate: -(p.kappa * theta + 0.5 * p.m * p.g * p.length * np.sin(theta)) / inertia(p)


def released(p):
    return p.theta0, 0.0


def seen(theta, p):
    return [theta]


def pymunk_rod(p, h, steps, nudge):
    """Return θ after steps of Chipmunk: move, rotate, apply spring and gravity, and close the hinge within one step.

    The impulse j at the hinge gives its point the velocity −(its place)/h:  (1/m + r⊥ r⊥ᵀ/I) j = −place/h − velocity,
    in complex numbers with r the hinge seen from the centre, r⊥ = i r.
    """
    theta = p.theta0 + nudge
    centre, v, omega, I = -0.5j * p.length * np.exp(1j * theta), 0j, 0.0, p.m * p.length**2 / 12.0
    for _ in range(steps):
        centre, theta = centre + h * v, theta + h * omega
        omega -= h * p.kappa * theta / I
        v -= 1j * h * p.g
        r = 0.5j * p.length * np.exp(1j * theta)
        across = 1j * r                                          # velocity of the hinge per rate of the rod
        missing = -(centre + r) / h - (v + omega * across)
        K = np.eye(2) / p.m + np.outer((across.real, across.imag), (across.real, across.imag)) / I
        j = complex(*np.linalg.solve(K, (missing.real, missing.imag)))
        v += j / p.m
        omega += (across.conjugate() * j).real / I
    return [theta]


MOTION = Motion(T, law, released, seen, truth, floor_of(limits, 10.0 * UNCERTAINTY))


def pymunk_make(p, dt):
    """Make the rod about its centre, a PivotJoint at its end, and a DampedRotarySpring to the ground.

    Angle 0 is hanging.
    """
    import pymunk
    space = pymunk_space((0.0, -p.g))
    space.iterations = 1
    body = pymunk.Body(p.m, p.m * p.length**2 / 12.0)
    body.position, body.angle = (0.5 * p.length * np.sin(p.theta0), -0.5 * p.length * np.cos(p.theta0)), p.theta0
    hinge = pymunk.PivotJoint(space.static_body, body, (0.0, 0.0), (0.0, 0.5 * p.length))
    hinge.error_bias = 0.0  # all drift is corrected in the next step, which keeps second order
    space.add(body, hinge, pymunk.DampedRotarySpring(space.static_body, body, 0.0, p.kappa, 0.0))
    return pymunk_world(space, dt, lambda: np.array([body.angle]))


def mujoco_make(p, dt):
    """Make the rod on a hinge with a stiffness, which calls nothing from Python: a load of a Model would."""
    about = mujoco.inertial(p.m, np.full(3, p.m * p.length**2 / 12.0), (0.0, 0.0, -0.5 * p.length))
    rod = f'<body><joint type="hinge" axis="0 -1 0" stiffness="{mujoco.text(p.kappa)}"/>{about}</body>'
    model, data = mujoco.world(dt, rod, (0.0, 0.0, -p.g))
    data.qpos[0] = p.theta0
    return mujoco.running(model, data, data.qpos.copy)


RUNNERS = (
    *integrator_runners(MOTION, limits),
    engine(PYMUNK, "", pymunk_make, "DampedRotarySpring and PivotJoint, error_bias 0, 1 iteration",
           order=1, limit=limits, predicted=MOTION.predict_model(Model(1, pymunk_rod))),
    engine(MUJOCO, "", mujoco_make, "hinge with stiffness; Runge–Kutta 4",
           order=4, limit=limits, predicted=MOTION.predict(RK4.table), most_steps=5000),
)


def points(observed, p):
    theta = observed[0]
    return p.length * np.array([[0.0, 0.0], [np.sin(theta), -np.cos(theta)]])


def sanity_checks():
    """Return Findings: special values.

    The period of a pendulum released at one radian is 1.0663 times that of small oscillations: 2K(sin ½)/π.
    """
    p = CASES["gravity"]
    small = 2.0 * np.pi * np.sqrt(2.0 * inertia(p) / (p.m * p.g * p.length))
    period = small * 2.0 / np.pi * ellipk(np.sin(0.5 * p.theta0) ** 2)
    return (states("period over that of small oscillations [-]", period / small, 1.0663, 5e-5),
            states("angle after a period [rad]", truth(p, period)[0], p.theta0, 1e-12),
            states("angle after a quarter [rad]", truth(p, 0.25 * period)[0], 0.0, 1e-12))


SCENE = Scene(
    title="Angular spring", lesson="springs",
    cases=CASES, duration=T, steps=STEPS,
    runners=RUNNERS,
    acceleration=acceleration, start=start, run=run, observe=coordinates(1),
    truth=truth, truth_uncertainty=UNCERTAINTY,
    sanity_checks=sanity_checks, points=points, links=ONE_LINK,
    uses=("one angle", "the moment of its spring", "one step function"),
    ablations={"the hinge as a constraint": "lesson 8 builds it",
              **measured("rotation in space", "detection of contacts")},
)
