"""A ball dropped from one metre rebounds with e times its speed: each apex is e² times the one before."""

from functools import partial
from itertools import pairwise
from typing import Annotated, NamedTuple

import numpy as np
from scipy.optimize import brentq

from solutions.impulses import BouncingBall, check_restitution
from solutions.support.model import Body
from solutions.support.shapes import Ball
from validate.check import Whose, states
from validate.methods import BACKTRACKING, PENALTY, PROJECTING
from validate.reference.impulses import APART, COPIES, LATE, all_dropped, delays, pushed, rounded_steps, soft_bounce
from validate.scene import EXACT, PYBULLET, PYMUNK, Departure, Prediction, Scene, by_order, ours
from validate.scenes._common import ONE_LINK, built, check_positives, measured
from validate.scenes.impulses._common import above_floor, impact_runners, in_space, over_floor

T = 1.9                      # [s]: in the third flight, clear of impacts
STEPS = (40, 100, 200, 500, 1000, 2500, 10000)
SPREADS = 100.0              # by which an impact on a soft floor multiplies roundings [-]
RADIUS = 0.1                 # of the engines' balls [m]


class Params(NamedTuple):
    e: Annotated[float, "restitution [-]"] = 0.8
    h: Annotated[float, "dropped from here [m]"] = 1.0
    slip: Annotated[float, "velocity along the floor [m/s]"] = 0.5
    space: Annotated[float, "1: three coordinates, 0: two"] = 0.0
    omega: Annotated[float, "√(stiffness/mass) of the penalty's spring [rad/s]"] = 100.0
    g: Annotated[float, "gravity [m/s²]"] = 9.81

    def damping(self):
        """Return the damping ratio ζ of the penalty that leaves e of the speed.

        e = exp(−q (π − 2 atan q)),  q = ζ/√(1 − ζ²).  The penalty ends before its force would pull.
        Source: Schwager and Pöschel 2007.
        """
        q = brentq(lambda q: q * (np.pi - 2.0 * np.arctan(q)) + np.log(max(self.e, 0.2)), 0.0, 10.0, xtol=1e-15)
        return q / np.sqrt(1.0 + q * q)


CASES = {"plane": Params(), "space": Params(space=1.0), "comes to rest": Params(e=0.5)}


def fallen(p):
    """Return the initial (height, speed) (COPIES,): each copy was released slightly earlier than the one before."""
    before = delays(0.15)
    return p.h - 0.5 * p.g * before**2, -p.g * before


def start(p):
    check_positives(p, "h", "g", "omega")
    check_restitution(p.e)
    d = 3 if p.space else 2
    up = np.zeros(d)
    up[-1] = 1.0
    x, v = np.zeros((COPIES, d)), np.zeros((COPIES, d))
    x[:, -1], v[:, -1] = fallen(p)
    v[:, 0] = p.slip
    return x, v, BouncingBall(p.e, -p.g * up, np.zeros(d), up, p.omega**2, 2.0 * p.damping() * p.omega)


def run(lessons, step, acceleration, state, p, dt, steps):
    x, v, drop = state
    return *lessons.impulses.advance_balls(step, acceleration, 0.0, x, v, dt, steps, drop), drop


def observe(state, p):
    """Return the distance along the floor, the height, and both velocities, of each copy."""
    x, v, _ = state
    return np.stack((x[:, 0], x[:, -1], v[:, 0], v[:, -1]), axis=1).ravel()


def impacts(p):
    """Return the times at which a ball dropped at 0 meets the floor, and its speed before each impact."""
    v, t = np.sqrt(2.0 * p.g * p.h), np.sqrt(2.0 * p.h / p.g)
    while v > 1e-15:
        yield t, v
        v *= p.e
        t += 2.0 * v / p.g


def flight(p, t):
    """Return (height, speed) at t after the release."""
    y, v, since = p.h, 0.0, 0.0
    for moment, speed in impacts(p):
        if moment > t:
            since = t - since
            return y + v * since - 0.5 * p.g * since**2, v - p.g * since
        y, v, since = 0.0, p.e * speed, moment
    return 0.0, 0.0


def seen(p, t, each):
    """Return the observed quantities of all copies; each(k) gives the height and speed of one."""
    return np.array([(p.slip * t, *each(k)[:1], p.slip, *each(k)[1:]) for k in range(COPIES)]).ravel()


def truth(p, t):
    """Parabolas from impact to impact.

    The speed after the k-th is eᵏ √(2gh).  From  √(2h/g) (1 + e)/(1 − e)  on it is at rest.

    Source: first lecture deck, coefficient of restitution; the geometric series.
    """
    before = delays(0.15)
    return seen(p, t, lambda k: flight(p, t + before[k]))


def soft(p, t):
    """Return the same over a floor of springs and dampers, in closed form from arc to arc."""
    y, v = fallen(p)
    return seen(p, t, lambda k: soft_bounce(y[k], v[k], t, p.g, p.omega, p.damping()))


def limits(p, dt, kick=0.0):
    """An impact is detected at most 1.5 steps late; a ball that leaves from below takes 1/e of that: L = 1.5 dt/e.

    It leaves with e v, hence the 1/e.  After every impact the speed is off by  s ← e (s + g L),  because the impact
    was detected late, and the time by  τ ← τ + L + 2s/g,  because the next flight is 2s/g longer.  At the end, a time
    a after the last impact, the height is off by |v| τ + s a + ½ g dt a and the speed by g τ + s + g dt.  A ball at
    rest is as deep as its first impact left it, at most v₁ L, or jumps with the speed g dt of a step.
    """
    exact, L = by_order(1.0 / T, T, dt)[EXACT], LATE * dt / p.e
    fast = np.sqrt(2.0 * p.g * p.h)

    def off(before):
        s = tau = since = 0.0
        for moment, speed in impacts(p):
            if moment > T + before:
                a = T + before - since
                return abs(flight(p, T + before)[1]) * tau + s * a + 0.5 * p.g * dt * a, p.g * (tau + dt) + s
            s, since = p.e * (s + p.g * L) + kick * speed, moment
            tau += L + 2.0 * s / p.g
        return (fast * L, p.g * L) if since - before + tau < T else (np.inf, np.inf)

    worst = np.max([np.abs(off(before)) for before in delays(0.15)], axis=0)
    return {1: np.linalg.norm(worst) * np.sqrt(COPIES) / np.linalg.norm(truth(p, T)) + exact, EXACT: exact}


def soft_limit(p, dt):
    """An impact on a soft floor is detected as late as on a hard one, and it also costs some of the speed.  The
    penalty's spring conserves  ½v² + ½ω²x² − ½ω² dt x v,  so entering and leaving at |x| ≤ v dt costs (ω dt)² of it,
    and its damper, evaluated at one end of the step, costs ζω dt.
    """
    return limits(p, dt, kick=(p.omega * dt) ** 2 + p.damping() * p.omega * dt)[1]


def late_impacts(p, dt, rule, far=1.0):
    """Each ball is predicted on its own.  In flight the steps end on a parabola, whose velocity is off by ½ g dt.
    An impact is detected at the first end of a step below the floor.  The lesson's step then sets the ball on the
    floor.  pybullet reverses it in place.  pymunk reverses it and then lifts it by a fraction of its depth per step.
    If round-off decides whether a step ends below the floor, both outcomes are right.
    """
    # largest coordinate [m], for round-off
    law = truth(p, T)
    runs, size = all_dropped(rule, *fallen(p), p.g, p.e, dt, round(T / dt)), np.linalg.norm(law)
    if runs is None:
        return None
    found, ways = runs
    return Prediction(seen(p, T, lambda k: found[k, :2]) - law,
                      1.01 * np.linalg.norm(ways[:, :2]) / size + rounded_steps(T, dt, far * np.sqrt(COPIES) / size))


def pushed_back(p, dt):
    """A soft floor pushes with its force at the start of each step."""
    law = soft(p, T)
    y, v = pushed(*fallen(p), p.g, p.omega**2, 2.0 * p.damping() * p.omega, dt, round(T / dt))
    return Prediction(seen(p, T, lambda k: (y[k], v[k])) - law,
                      rounded_steps(T, dt, SPREADS * COPIES / np.linalg.norm(law)))


def keeps_bouncing(p):
    """Return whether the ball keeps bouncing: at rest it would keep oscillating inside the soft floor."""
    return p.e >= 0.8


def model(p):
    return over_floor([Body((0.0, y + RADIUS), 1.0, Ball(RADIUS), e=p.e, v=(p.slip, v))
                       for y, v in zip(*fallen(p))], p.g)


def read(state, p):
    return observe(above_floor(state, RADIUS), p)


FAR = {"far": APART * COPIES}
world = partial(built, model=model, read=read, iterations=1)
RUNNERS = (
    ours(PENALTY, limit=soft_limit, predicted=pushed_back, supports=keeps_bouncing, most_in_quick=2500,
         departure=Departure("its floor is a spring, which takes 30 ms to reverse the ball, however short a step is",
                             soft, Whose.LAW)),
    *impact_runners(
        (PROJECTING, BACKTRACKING), limits, late_impacts,
        (world(PYMUNK), "circles on a thick segment; 1 iteration, collision_slop 1e-5"),
        (world(PYBULLET), "spheres on a GEOM_PLANE; 1 iteration"),
        pymunk_errs=FAR, bullet_errs=FAR),
)


def sanity_checks():
    p = Params()
    flights = [moment for moment, _ in zip(impacts(p), range(4))]
    apexes = [flight(p, 0.5 * (a + b))[0] for (a, _), (b, _) in pairwise(flights)]
    stiff = soft(p._replace(omega=1e5), T)
    return (
        states("the first three apexes [m]", apexes, (0.64, 0.4096, 0.262144), 1e-14),
        states("it lies from [s]", list(impacts(p))[-1][0], 4.063712769, 5e-10),
        states("at rest from, by the geometric series [s]", np.sqrt(2.0 / p.g) * 1.8 / 0.2, 4.063712769, 5e-10),
        states(
            "a stiff spring is a hard floor, except for the π/ω of an impact: relative error [-]",
            np.linalg.norm(stiff - truth(p, T)) / np.linalg.norm(truth(p, T)),
            0.0,
            1e-3,
        ),
    )


def points(observed, p):
    """Draw the first copy over the floor."""
    return np.array([[-0.2, 0.0], [2.6, 0.0], observed[:2]])


SCENE = Scene(
    title="Bounces", lesson="impulses",
    cases=CASES, duration=T, steps=STEPS,
    runners=RUNNERS,
    acceleration=lambda lessons: lessons.impulses.falling_acceleration, start=start, run=run, observe=observe,
    truth=truth, truth_uncertainty=1e-14, model=model, read=read,
    sanity_checks=sanity_checks,
    points=points, links=ONE_LINK,
    film_seconds=4.5,  # [s]: until it is at rest
    uses=("two coordinates", "one plane", "one number e for each impact"),
    ablations={
        "the third dimension": in_space(start),
        **measured("rotation: the ball has no torque", "detection"),
    },
)
