"""Ten masses on ten springs, hung one below the other and released with the springs unstretched."""

from functools import partial
from typing import Annotated, Any, NamedTuple

import numpy as np

from validate.check import states
from validate.methods import EXPLICIT, IMPLICIT_EULER, IMPLICIT_MESH, RK4
from validate.reference.schemes import NEW_VELOCITY_OLD_FORCE, Model, Motion, advance_modes, nudged
from validate.reference.springs import ReferenceNetwork, by_mode, pymunk_net_model
from validate.scene import LATE_LEAPFROG, MUJOCO, PYMUNK, Scene, engine, ours
from validate.scenes._common import built, floor_of, measured
from validate.scenes.integrators._common import integrator_runners
from validate.scenes.springs._common import DAMPED, ONE_SWEEP, in_space, model_of, net_fields

T = 1.5                      # [s]: two and a half periods of the slowest mode
STEPS = (200, 500, 1000, 2000, 5000, 10000, 20000)
UNCERTAINTY = 1e-13          # 200 radians of the fastest mode, each rounded to 2e-16


class Params(NamedTuple):
    springs: Annotated[int, "N [-]"] = 10
    m: Annotated[float, "each mass [kg]"] = 0.1
    k: Annotated[float, "each spring [N/m]"] = 500.0
    rest: Annotated[float, "its natural length [m]"] = 0.1
    k_d: Annotated[float, "damper beside each spring [N s/m]"] = 0.05
    k_v: Annotated[float, "viscous drag on each mass [N s/m]"] = 0.0
    g: Annotated[float, "gravity [m/s²]"] = 9.81


# k_v = 2 m ω₁ is critical for the slowest mode, and every other mode then decays as fast: e^(−ω₁ T) = 1.3e-7 is left
CASES = {"let go": Params(), "undamped": Params(k_d=0.0), "at rest": Params(k_d=0.0, k_v=2.113)}


def net(p):
    """Return a line of points, downward positive: the ceiling at 0, mass n at n · rest."""
    n = np.arange(p.springs + 1)
    x = p.rest * n[:, None].astype(float)
    pairs = np.stack((n[:-1], n[1:]), axis=1)
    rest = np.full(p.springs, p.rest)
    return ReferenceNetwork(x, 0.0 * x, (0,), pairs, rest, p.m, p.k, p.k_d, p.k_v, np.array([p.g]), np.zeros(1))


def run(lessons, step, acceleration, state, p, dt, steps):
    x, v, network = state
    return *lessons.integrators.advance(step, acceleration, 0.0, x, v, dt, steps, network), network


def observe(state, p):
    """Return the distance of each mass below its place on unstretched springs [m]."""
    return state[0][1:, 0] - p.rest * np.arange(1, p.springs + 1)


def modes(p):
    """Return (omega, c, shapes) of the normal modes.

    ω_j² = 4 k/m sin²(β_j/2),  c_j = (k_d ω_j²/k + k_v/m),  shape_nj = 2/√(2N+1) sin(n β_j)
    β_j = (2j − 1) π/(2N + 1) gives zero tension below the last mass, where there is no spring: sin Nβ = sin (N+1)β.
    """
    n = np.arange(1, p.springs + 1)
    beta = (2 * n - 1) * np.pi / (2 * p.springs + 1)
    omega = 2.0 * np.sqrt(p.k / p.m) * np.sin(0.5 * beta)
    return omega, p.k_d / p.k * omega**2 + p.k_v / p.m, 2.0 / np.sqrt(2 * p.springs + 1) * np.sin(np.outer(n, beta))


def static_extension(p):
    """Return the distances of the rest positions below the unstretched ones [m]; spring i carries N + 1 − i masses."""
    return np.cumsum(p.m * p.g / p.k * np.arange(p.springs, 0, -1))


def truth(p, t):
    """x(t) = x_rest − Σ_j shape_j q_j e^(−δt) (cos σt + δ/σ sin σt),  q = shapesᵀ x_rest,  δ = c_j/2,  σ² = ω_j² − δ².

    Each mode of the chain is a damped oscillator about the static extension m g N(N+1)/2k at the tip.
    Source: normal modes of a chain with one fixed and one free end; e.g. Goldstein, Classical Mechanics, ch. 6.
    """
    omega, c, shapes = modes(p)
    delta = 0.5 * c
    # imaginary where over-damped: cos and sin become cosh and sinh
    sigma = np.sqrt((omega**2 - delta**2).astype(complex))
    shape = np.exp(-delta * t) * (np.cos(sigma * t) + delta * t * np.sinc(sigma * t / np.pi)).real
    return static_extension(p) - shapes @ (shape * (shapes.T @ static_extension(p)))


def limits(p, dt):
    """Each mode errs on its own, because the system is linear.  Without drag pymunk is symplectic Euler: order 1."""
    omega, c, shapes = modes(p)
    amplitude = np.abs(shapes.T @ static_extension(p))
    return by_mode(omega, c, amplitude, np.linalg.norm(truth(p, T)), T, dt, UNCERTAINTY)


def law(p):
    """Return a(t, q, q̇) of all modes at once, about rest."""
    omega, c, _ = modes(p)
    return lambda t, q, rate: -omega * omega * q - c * rate


def released(p):
    """Return (q, q̇) at the start: no spring is stretched."""
    q = -modes(p)[2].T @ static_extension(p)
    return q, 0.0 * q


def from_modes(q, p):
    return static_extension(p) + modes(p)[2] @ q


def pymunk_model(p, h, steps, nudge, ahead=0.0):
    chain = net(p)
    return observe((pymunk_net_model(chain._replace(x=nudged(chain.x, nudge)), h, steps, ahead=ahead),), p)


MOTION = Motion(T, law, released, from_modes, truth, floor_of(limits, 10.0 * UNCERTAINTY), advance_modes)


# sideways nothing moves; a State begins with the places, as the states of our methods do
MODEL: dict[str, Any] = {"model": model_of(lambda p: net(p).padded(2)), "read": observe}
in_pymunk = partial(built, PYMUNK, **MODEL, own_drag=True, iterations=1)
RUNNERS = (
    *integrator_runners(MOTION, limits, compiled=EXPLICIT),
    # in one coordinate springs are linear: one Newton step of the implicit mesh is all of implicit Euler
    ours(IMPLICIT_MESH, limit=limits, predicted=MOTION.predict(IMPLICIT_EULER.table), in_quick=False),
    engine(PYMUNK, "", in_pymunk(), f"DampedSpring between point masses; {ONE_SWEEP}",
           order=1, limit=limits, predicted=MOTION.predict_model(Model(1, pymunk_model))),
    engine(PYMUNK, "leapfrog start", in_pymunk(ahead=0.5), f"the same, first velocities + ½ a dt; {DAMPED}",
           order=LATE_LEAPFROG, limit=lambda p, dt: limits(p, dt)[1],
           predicted=MOTION.predict_model(Model(1, partial(pymunk_model, ahead=0.5)))),
    engine(MUJOCO, "", built(MUJOCO, **MODEL), "point masses on slide joints, tendons as springs; Runge–Kutta 4",
           order=4, limit=limits, predicted=MOTION.predict(RK4.table), most_steps=5000),
    engine(MUJOCO, "leapfrog start", built(MUJOCO, **MODEL, integrator="Euler", ahead=0.5),
           f"the same with Euler, first velocities − ½ a dt; {DAMPED}", order=LATE_LEAPFROG,
           limit=lambda p, dt: limits(p, dt)[1], most_steps=5000,
           predicted=MOTION.predict(NEW_VELOCITY_OLD_FORCE, ahead=-0.5)),
)


def points(observed, p):
    y = -np.concatenate(([0.0], observed + p.rest * np.arange(1, p.springs + 1)))
    return np.stack((np.zeros_like(y), y), axis=1)


def sanity_checks():
    """Return Findings: the numbers of the lecture."""
    p = CASES["at rest"]
    slowest = modes(p)[0][0]
    left = (1.0 + slowest * T) * np.exp(-slowest * T)            # share of the motion left after T, critically damped
    tip = 0.10791                                                # m g N(N+1)/2k [m]
    return (states("the tip's static extension [m]", static_extension(p)[-1], tip, 1e-15),
            states("the tip at T, nearly at rest [m]", truth(p, T)[-1], tip, 2.0 * left * tip))


SCENE = Scene(
    title="Hanging springs",
    **net_fields(net, ("springs", "m", "k", "rest"), observe=observe, points=points, **MODEL,
                 uses=("one coordinate", "springs with dampers", "one step function"),
                 ablations={"the second and third dimension": in_space(net),
                            **measured("rotation", "contact between masses")}),
    cases=CASES, duration=T, steps=STEPS,
    runners=RUNNERS,
    acceleration=lambda lessons: lessons.springs.spring_network_acceleration, run=run,
    truth=truth, truth_uncertainty=UNCERTAINTY,
    sanity_checks=sanity_checks,
)
