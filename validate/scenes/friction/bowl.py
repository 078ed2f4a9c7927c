"""A particle slides inside a round bowl: without friction it keeps oscillating, with friction it comes to rest."""

from functools import cache, partial
from typing import Annotated, NamedTuple

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from solutions.friction import ParticleInBowl, check_friction
from validate.check import states
from validate.engines.bullet import CONTACT_ERP
from validate.engines.friction import bullet_in_hollow
from validate.methods import CONTACT, GRIPPING
from validate.reference.schemes import ErrorLaw
from validate.scene import PYBULLET, Scene, by_order, engine, ours
from validate.scenes._common import check_positives, coordinates

T = 2.0                      # [s]: one oscillation; with friction it has come to rest
STEPS = (200, 500, 1000, 2000, 5000, 10000, 20000)
AT_REST = 1e-6               # [m/s]: friction stops a slower particle within 1e-13 m


class Params(NamedTuple):
    mu: Annotated[float, "friction [-]"] = 0.4
    radius: Annotated[float, "[m]"] = 1.0
    degrees: Annotated[float, "released at this angle from the bottom, towards x [°]"] = 53.13
    v0: Annotated[float, "along y, the axis of a trough [m/s]"] = 1.5
    trough: Annotated[float, "1: a trough along y, 0: a bowl"] = 0.0
    g: Annotated[float, "gravity [m/s²]"] = 9.81


CASES = {
    "rough bowl": Params(),
    "smooth bowl": Params(mu=0.0),
    "rough trough": Params(degrees=60.0, v0=0.0, trough=1.0),
    "smooth trough": Params(mu=0.0, trough=1.0),
}


def place(p):
    """Return the initial (x, v), each (3,); the centre is the origin, z up."""
    theta = np.radians(p.degrees)
    return p.radius * np.array([np.sin(theta), 0.0, -np.cos(theta)]), np.array([0.0, p.v0, 0.0])


def start(p):
    check_positives(p, "radius", "g")
    check_friction(p.mu)
    axis = np.array([0.0, p.trough, 0.0])
    return *place(p), ParticleInBowl(1.0, p.mu, 0.0, np.array([0.0, 0.0, -p.g]), np.zeros(3), axis, p.radius)


def run(lessons, step, acceleration, state, p, dt, steps):
    friction, (x, v, bowl) = lessons.friction, state
    x, v = friction.advance_particle(step, acceleration, friction.particle_bowl_gap, 0.0, x, v, dt, steps, bowl)
    return x, v, bowl


def inward(x, p):
    """Return the unit normal of the wall at x, towards the axis or the centre."""
    r = np.array([x[0], 0.0 if p.trough else x[1], x[2]])
    return -r / np.linalg.norm(r)


def support(x, v, p):
    """Return the normal force over mass [m/s²]: gravity, and v²/R for the curved path, without v along a trough."""
    round_ = v[0] ** 2 + v[2] ** 2 + (0.0 if p.trough else v[1] ** 2)
    return round_ / p.radius + p.g * inward(x, p)[2]


@cache
def reference(p):
    """Return [(begin, motion), …] and the rest position, or None.

    DOP853 solves one piece from each start.
    """
    def law(t, y):
        x, v = y[:3], y[3:]
        n, N = inward(x, p), support(x, v, p)
        return np.concatenate((v, (0.0, 0.0, -p.g) + N * n - p.mu * N * v / max(np.linalg.norm(v), 1e-300)))

    def slow(t, y):
        return np.linalg.norm(y[3:]) - AT_REST
    slow.terminal, slow.direction = True, -1

    t, (x, v), pieces = 0.0, place(p), []
    stopped = np.linalg.norm(v) <= AT_REST
    while t < T:
        if p.mu > 0.0 and stopped:
            n = inward(x, p)
            down = np.array([0.0, 0.0, -1.0]) + n[2] * n
            if np.linalg.norm(down) <= p.mu * n[2]:
                return pieces, x
            v = 1.0001 * AT_REST * down / np.linalg.norm(down)
        piece = solve_ivp(law, (t, T), np.concatenate((x, v)), method="DOP853", rtol=1e-12, atol=1e-13,
                          dense_output=True, events=slow if p.mu else None)
        pieces.append((t, piece.sol))
        # The root of `slow` may be rounded to a speed above AT_REST, so the event decides that the mass has stopped.
        t, x, v, stopped = piece.t[-1], piece.y[:3, -1], piece.y[3:, -1], piece.status == 1
    return pieces, None


def truth(p, t):
    """x(t) of  ẍ = g + N n − μ N v/|v|,   N = v²/R − g · n  on the wall, by DOP853 at 1e-12.

    It stays at rest where tan θ ≤ μ.
    Source: Newton's law with the constraint |x| = R.
    """
    pieces, rest = reference(p)
    if rest is not None and t >= pieces[-1][1].t_max:
        return rest
    return [sol for begin, sol in pieces if begin <= t][-1](t)[:3]


def fastest(p):
    """Return a bound of the speed [m/s]: the whole height converted into kinetic energy."""
    return np.sqrt(p.v0**2 + 2.0 * p.g * (p.radius + place(p)[0][2]))


def limits(p, dt):
    """The fastest rates are √(g/R) and the rotation v/R; pybullet is of order 1, like our steps."""
    return by_order(np.sqrt(p.g / p.radius) + fastest(p) / p.radius, T, dt)


def in_steps(p, steps, nudge, gripping=False):
    """Return x at T: fall, move with the new velocity, return to the wall.

    Then remove the velocity into it, and friction.

    Friction removes at most μ times the velocity that the wall stopped.  With `gripping` it also removes at most μ
    times the depth from the displacement along the wall, while the particle moves outwards.
    """
    dt, (x, v) = T / steps, place(p)
    x, fall = x * (1.0 + nudge), np.array([0.0, 0.0, -p.g * T / steps])
    across = np.array([1.0, 0.0 if p.trough else 1.0, 1.0])

    def shortened(a, most):
        size = np.sqrt(a @ a)
        return a * (1.0 - min(1.0, most / size)) if size > 0.0 else a

    for _ in range(steps):
        v = v + fall
        moved = dt * v
        x = x + moved
        r = across * x
        far = np.sqrt(r @ r)
        if far <= p.radius:
            continue
        n, depth = -r / far, far - p.radius
        into = min(0.0, v @ n)
        if gripping and into < 0.0:
            along = moved - (moved @ n) * n
            x = x + shortened(along, p.mu * depth) - along
        x = x + depth * n
        if into < 0.0:
            v = shortened(v - into * n, -p.mu * into)
    return x


def in_bullet(p, steps, nudge):
    """Return x at T of pybullet's ball on the tangent plane: gravity, the plane, its friction, then the motion.

    The plane lets the ball approach by its gap in one step, and pushes a ball inside it out by a fraction of its depth.
    """
    dt, (x, v) = T / steps, place(p)
    x, fall = x * (1.0 + nudge), np.array([0.0, 0.0, -p.g * T / steps])
    across = np.array([1.0, 0.0 if p.trough else 1.0, 1.0])
    for _ in range(steps):
        r = across * x
        far = np.sqrt(r @ r)
        n, gap, v = -r / far, p.radius - far, v + fall
        out = -gap / dt * (1.0 if gap > 0.0 else CONTACT_ERP)
        pushed = max(0.0, out - v @ n)
        v = v + pushed * n
        along = v - (v @ n) * n
        size = np.sqrt(along @ along)
        if size > 0.0:
            v = v - along * min(1.0, p.mu * pushed / size)
        x = x + dt * v
    return x


def errors_of(march):
    """Return the field `predicted` of a Runner that ends where march(p, steps, nudge) ends."""
    @cache
    def error_law(p):
        return ErrorLaw(partial(march, p), np.array(truth(p, T)), 1, T, 800)

    def predicted_error(p, dt):
        """The error, with its sign, of the same rule in plain numbers: gravity, the return to the wall, and
        friction.  It is taken at the same step where that is coarse, else by its expansion in powers of dt.
        pybullet's own step is treated in the same way.
        """
        return error_law(p).prediction(dt, 1e-10)
    return predicted_error


def pybullet_make(p, dt):
    x, v = place(p)

    def wall(x):
        n = inward(x, p)
        along = np.array([0.0, x[1] if p.trough else 0.0, 0.0])
        return along - p.radius * n, n

    return bullet_in_hollow((0.0, 0.0, -p.g), p.mu, x, v, fastest(p), wall, dt)


RUNNERS = (
    # in a full run, until its error is as small as that of pybullet at 20,000 steps
    ours(CONTACT, limit=limits, predicted=errors_of(in_steps), finer_in_full=(50_000, 150_000)),
    ours(GRIPPING, limit=limits, predicted=errors_of(partial(in_steps, gripping=True))),
    engine(PYBULLET, "", pybullet_make,
           "a ball that cannot turn, on the tangent plane of the bowl, placed anew before each step; contactSlop 0, "
           "solverResidualThreshold 0, 1 iteration: it has one contact",
           order=1, limit=limits, predicted=errors_of(in_bullet)),
)


def rest_angle(theta, mu):
    """Return the angle θ [rad] at which a particle stops that is released at rest at θ > 0 and passes the bottom.

    w = θ̇² R/g obeys  dw/dθ = 2μ w + 2 (μ cos θ − sin θ)  on the way down:  w = C e^(2μθ) + A cos θ + B sin θ,
    A = 2(1 − 2μ²)/(1 + 4μ²),   B = 6μ/(1 + 4μ²);   it stops where w is 0 again.
    *Source:* the linear equation for θ̇², as in any text on friction on a curve.
    """
    A, B = 2.0 * (1.0 - 2.0 * mu**2) / (1.0 + 4.0 * mu**2), 6.0 * mu / (1.0 + 4.0 * mu**2)
    C = -(A * np.cos(theta) + B * np.sin(theta)) * np.exp(-2.0 * mu * theta)
    w = lambda y: C * np.exp(2.0 * mu * y) + A * np.cos(y) + B * np.sin(y)
    return brentq(w, -theta, theta - 1e-3, xtol=1e-14)


def sanity_checks():
    """Return Findings: the reference solution compared with closed forms."""
    p, smooth = CASES["rough trough"], CASES["smooth bowl"]
    x = truth(p, T)
    rest = rest_angle(np.radians(p.degrees), p.mu)
    end = reference(smooth)[0][0][1](T)
    begin = np.concatenate(place(smooth))
    energy = [0.5 * y[3:] @ y[3:] + smooth.g * y[2] for y in (begin, end)]
    spin = [y[0] * y[4] - y[1] * y[3] for y in (begin, end)]
    far = [np.arctan(np.hypot(x[0], 0.0 if q.trough else x[1]) / -x[2])
           for q in (CASES["rough bowl"], p) for x in [truth(q, T)]]
    return (states("rest angle in the rough trough [rad]", np.arctan2(x[0], -x[2]), rest, 1e-9),
            states("slope at the rest positions, over μ [-]: at most 1", np.tan(far) / p.mu, 0.5, 0.5),
            states("energy without friction after 2 s [J/kg]", energy[1], energy[0], 1e-9),
            states("angular momentum about z without friction [m²/s]", spin[1], spin[0], 1e-9))


def points(observed, p):
    """Draw the particle, and the rim and the section of the bowl, from the side and slightly from above."""
    around = np.linspace(-np.pi, 0.0, 25)
    wall = p.radius * np.stack([np.cos(around), np.sin(around)], axis=1)
    return np.concatenate((wall, [[observed[0] + 0.35 * observed[1], observed[2] + 0.2 * observed[1]]]))


def links(p):
    return [(n, n + 1) for n in range(24)]


SCENE = Scene(
    title="Particle in a bowl", lesson="friction",
    cases=CASES, duration=T, steps=STEPS,
    runners=RUNNERS,
    acceleration=lambda lessons: lessons.friction.falling_acceleration, start=start, run=run, observe=coordinates(3),
    truth=truth, truth_uncertainty=1e-9,
    omitted_methods=("the sliding and the event step hold a block on one plane; a bowl has a different one at every "
                     "point"),
    sanity_checks=sanity_checks,
    points=points, links=links,
    uses=("three coordinates", "an implicit surface", "one impulse for each contact"),
    full_loop="the loop has no contact with a curved surface that is given by an equation",
    ablations={
        "rotation: it slides and does not roll": "lesson 5 builds it",
        "detection between bodies": "lesson 6 builds it",
    },
)
