"""A fast top is tilted slightly and released: its tip draws small arches, which meet in cusps, around the vertical."""

from functools import cache, partial
from typing import Annotated, NamedTuple

import numpy as np

from solutions.checks import BadInput, check_positive
from solutions.given.rotation import check_moments
from solutions.rotation import Top, exponential
from solutions.support.model import WORLD, BallJoint, Body, make_model, rotation_of
from validate.check import states
from validate.methods import COMPOSED_SPLITTING, GYROSCOPIC, QUATERNION, RUNGE_KUTTA, SPLITTING, TURNS
from validate.reference.orientation import about, quaternion
from validate.reference.rotation import HeavyTop, freely, hung_up
from validate.reference.schemes import ErrorLaw
from validate.reference.turns import MUNTHE_KAAS, TurningBody, rotation
from validate.scene import MUJOCO, PYBULLET, ROUND_OFF, Scene, by_order, engine, in_substeps
from validate.scenes import drawing
from validate.scenes._common import ONE_LINK, built, floor_of
from validate.scenes.rotation._common import turn_runners

T = 2.0                      # [s]: nearly three nutations
FINEST = 3200                # steps of the independent program of pybullet: with fewer its expansion is too rough
STEPS = (500, 1000, 2000, 5000, 10000, 20000, 50000)
# {method: its most steps in a quick run}; the asymmetric top has the others
IN_QUICK = {QUATERNION: None, GYROSCOPIC: 5000, RUNGE_KUTTA: 2000, SPLITTING: None, COMPOSED_SPLITTING: 2000}


class Params(NamedTuple):
    I1: Annotated[float, "moment across the axis, about the pivot [kg m²]"] = 5.0
    I3: Annotated[float, "moment about the axis [kg m²]"] = 1.0
    mgl: Annotated[float, "weight times the distance from the pivot to the centre of mass [N m]"] = 20.0
    tilt: Annotated[float, "at the start [rad]"] = 0.05
    spin: Annotated[float, "ω₃ [rad/s]"] = 50.0

    def moments(self):
        return np.array([self.I1, self.I1, self.I3])


CASES = {"fast": Params()}
# for the engines: distance from the pivot to the centre of mass [m], gravity [m/s²]; only Mgl matters
LENGTH, G = 1.0, 9.81


def start(p):
    check_moments(p.moments())
    check_positive("Mgl [N m]", p.mgl)
    if not 0.0 < p.tilt < np.pi:
        raise BadInput("the tilt [rad]", p.tilt, "give a number between 0 and π")
    if not (p.I3 * p.spin / p.I1) ** 2 > 4.0 * p.mgl / p.I1:
        raise BadInput("the spin [rad/s]", p.spin, "let the top spin fast enough to stand, ω₃² > 4 I₁ Mgl/I₃²")
    q = exponential(np.array([p.tilt, 0.0, 0.0]))
    return q, about(np.array([1.0, 0.0, 0.0]), p.tilt) @ np.array([0.0, 0.0, p.I3 * p.spin]), Top(p.moments(), p.mgl)


def run(lessons, step, acceleration, state, p, dt, steps):
    q, L, top = state
    return *lessons.rotation.advance_rotation(step, acceleration, 0.0, q, L, dt, steps, top), top


def observe(state, p):
    """Return the position of the tip seen from above: the horizontal coordinates of the unit vector along the top."""
    w, x, y, z = state[0]
    return np.array([2.0 * (x * z + w * y), 2.0 * (y * z - w * x)])


def truth(p, t):
    """θ by Jacobi's sn and dn, φ by Gauss's rule (HeavyTop): the tip is at sin θ (sin φ, −cos φ).

    Source: Landau and Lifshitz, Mechanics, § 35.
    """
    return HeavyTop(p.I1, p.I3, p.mgl, p.tilt, p.spin).tip(t)


def limits(p, dt):
    """The fastest rate is the spin.

    Near the vertical the tip obeys a linear equation, so its error is proportional to its distance.  Round-off is
    that of q, 1e-16 per step relative to a tip at sin θ₀ at least.
    """
    return {k: limit + T / dt * ROUND_OFF / np.sin(p.tilt) for k, limit in by_order(p.spin, T, dt).items()}


def pybullet_limit(p, dt):
    """pybullet takes the gyroscopic term at the end of the step (maximal coordinates) or at its beginning (reduced),
    about the centre of mass instead of the pivot: I = I₁ − ml².  In body coordinates its tip rotates at
    Ω = (I₃/I − 1) ω₃, and e^(iΩdt) ≈ 1 + iΩdt is too long by ½(Ω dt)² per step.
    """
    turning = (p.I3 / (p.I1 - mass(p) * LENGTH**2) - 1.0) * p.spin
    return limits(p, dt)[1] + 0.5 * turning**2 * dt * T


def pybullet_errors(implicit):
    """Return the field `predicted` of pybullet in maximal coordinates, or in reduced ones."""
    @cache
    def error_law(p):
        I = np.array([p.I1 - mass(p) * LENGTH**2] * 2 + [p.I3])

        def run(steps, nudge):
            R = about(np.array([1.0, 0.0, 0.0]), p.tilt + nudge)
            return hung_up(mass(p), LENGTH, I, G, R, p.spin * R[:, 2], T / steps, steps, implicit)[:2, 2]
        return ErrorLaw(run, truth(p, T), 1, T, FINEST)

    def predicted_error(p, dt):
        """The error of the same step in another program: gravity, the gyroscopic term, and the impulse at the pivot.

        It is taken at the same step where that is coarse, else by its expansion in powers of dt.
        """
        return error_law(p).prediction(dt, floor_of(limits, 1e-11)(p, dt))
    return predicted_error


def released(p):
    """Return the tilt about x as a pair of complex numbers, and L along the axis."""
    spin = p.I3 * p.spin
    return rotation((p.tilt, 0.0, 0.0)), (0.0, -float(np.sin(p.tilt)) * spin, float(np.cos(p.tilt)) * spin)


def weight(p):
    """Return the torque Mgl 𝐞₃ × (−ẑ) from the rows of R."""
    return lambda R: (-p.mgl * R[1][2], p.mgl * R[0][2], 0.0)


def seen(R):
    return [R[0][2], R[1][2]]


def mass(p):
    return p.mgl / (G * LENGTH)


def model(p):
    """Make a body on a ball joint at the origin; moments are about the centre of mass: I₁ − ml²."""
    R, across = about(np.array([1.0, 0.0, 0.0]), p.tilt), p.I1 - mass(p) * LENGTH**2
    body = Body(tuple(LENGTH * R[:, 2]), mass(p), q=tuple(quaternion(R)), v=(0.0, 0.0, 0.0),
                omega=tuple(p.spin * R[:, 2]), inertia=(across, across, p.I3))
    return make_model([body], (0.0, 0.0, -G), [BallJoint(0, WORLD, (0.0, 0.0, 0.0))])


def read(state, p):
    return rotation_of(state.q[0])[:2, 2]


world = partial(built, model=model, read=read)
in_pybullet = partial(world, PYBULLET)
BODY = TurningBody(T, Params.moments, released, weight, seen, truth, floor_of(limits, 1e-11))
SETTINGS = "pivot: JOINT_POINT2POINT, erp 1; no damping"
MAXIMAL = engine(PYBULLET, "", in_pybullet(iterations=2), f"useMaximalCoordinates=1, 2 iterations; {SETTINGS}",
                 order=1, limit=pybullet_limit, predicted=pybullet_errors(implicit=True))
RUNNERS = (
    *turn_runners(BODY, TURNS, limits, IN_QUICK),
    engine(PYBULLET, "reduced coordinates", in_pybullet(iterations=10, maximal=False),
           f"createMultiBody, 10 iterations, no clamp of velocity; {SETTINGS}",
           order=1, limit=pybullet_limit, predicted=pybullet_errors(implicit=False)),
    MAXIMAL,
    in_substeps(MAXIMAL, 100),
    engine(MUJOCO, "", world(MUJOCO), "ball joint; Runge–Kutta 4",
           order=4, limit=limits, predicted=BODY.predict(MUNTHE_KAAS), most_steps=5000),
)


def points(observed, p):
    return np.vstack((np.zeros(2), observed))


def bodies(p):
    """Draw the upper end of the axle, a metre from its point, to show the arches, and a plumb line above the point."""
    reach = np.sin(p.tilt)
    return [drawing.cylinder(0.03 * reach, reach), drawing.sphere(0.07 * reach), drawing.cylinder(0.01 * reach, reach)]


def poses(observed, p):
    """Return the poses rotated out of the vertical by the shortest rotation: the spin of a round axle is invisible."""
    x, y, z = tip = axis(observed)
    q = np.array([1.0 + z, -y, x, 0.0])
    q /= np.linalg.norm(q)
    middle = 0.5 * np.sin(p.tilt)
    return [np.append((1.0 - middle) * tip, q), np.append(tip, q), (0.0, 0.0, 1.0 - middle, 1.0, 0.0, 0.0, 0.0)]


def axis(observed):
    """Return the unit vector (3,) along the top, from its position seen from above."""
    return np.append(observed, np.sqrt(1.0 - observed @ observed))


def arrows(observed, p):
    """Return ω, without the thousandth of it across the axis, and the torque Mgl 𝐳 × 𝐞₃ that pushes L sideways."""
    x, y, _ = tip = axis(observed)
    return {"ω": (tip, tip + np.sin(p.tilt) * tip), "τ": (tip, tip + np.array([-y, x, 0.0]))}


def sanity_checks():
    p = Params()
    top, R = HeavyTop(*p), about(np.array([1.0, 0.0, 0.0]), p.tilt)
    torque = lambda R: np.cross(R[:, 2], [0.0, 0.0, -p.mgl])
    tip = freely(R, np.array([0.0, 0.0, p.spin]), p.moments(), T, torque)[0][:2, 2]
    return (states("energy [J]", 0.5 * p.I3 * p.spin**2 + p.mgl * np.cos(p.tilt), 1269.975, 5e-4),
            states("smallest and largest tilt [°]", np.degrees(np.arccos([top.u0, top.u1])), (2.864789, 3.125582),
                   5e-7),
            states("nutation [s]", top.nutation(), 0.685458497, 5e-10),
            states("the tip at T, by DOP853", truth(p, T), tip, 1e-12))


SCENE = Scene(
    title="Heavy top", lesson="rotation",
    cases=CASES, duration=T, steps=STEPS,
    runners=RUNNERS,
    acceleration=lambda lessons: lessons.rotation.heavy_top_torque, start=start, run=run, observe=observe,
    truth=truth, truth_uncertainty=1e-12, model=model, read=read,
    sanity_checks=sanity_checks,
    points=points, links=ONE_LINK,
    bodies=bodies, poses=poses, arrows=arrows,
    trail=1,  # the tip
    uses=("one orientation", "one angular momentum", "one torque", "one step function"),
    ablations={
        "the pivot's force": "about the pivot it has no torque",
        "friction at the pivot": "lesson 3 has friction",
    },
)
