"""A comet on a long ellipse, at most 19 times as far from the sun as at its nearest point, where most error arises."""

from solutions.support.orbits import attraction
from validate.methods import ADAPTIVE, BLANES_MOAN, INTEGRATORS
from validate.reference.integrators import (
    Planet,
    adaptive_errors,
    adaptive_limit,
    kepler_motion,
    kepler_position,
    mean_rate,
)
from validate.scene import Scene, ours
from validate.scenes._common import coordinates
from validate.scenes.integrators._common import PLANET, planet, planet_in_space, planet_runners, sun_and_planet

T = 20.0                     # [s]: three revolutions
STEPS = (100, 200, 500, 1000, 2000, 5000, 10000, 14000, 20000, 50000, 100000, 200000)

CASES = {"e = 0.9": Planet(e=0.9)}


def share(p, dt):
    """Return dt times the mean rate of the motion [-]; an adaptive step is dt where the planet is at the distance a."""
    return dt * mean_rate(p)


def run(lessons, step, acceleration, state, p, dt, steps):
    x, v = state
    if step is lessons.integrators.advance_adaptive:
        return step(lessons.integrators.blanes_moan_step, acceleration, 0.0, x, v, share(p, dt), dt * steps, p)
    return lessons.integrators.advance(step, acceleration, 0.0, x, v, dt, steps, p)


def limit(p, dt):
    """The rate at the nearest point, √(μ/r³), is 32 times the mean, so equal steps are wasted far away.  An adaptive
    step keeps the product of rate and dt the same everywhere.  This product is its share.
    """
    return adaptive_limit(p, T, share(p, dt))


MOTION = kepler_motion(T)
RUNNERS = (
    *planet_runners(MOTION, (*INTEGRATORS, BLANES_MOAN), 50_000),
    ours(ADAPTIVE, limit=limit, predicted=adaptive_errors(MOTION)),
)

SCENE = Scene(
    title="Kepler, near collision", lesson="integrators",
    cases=CASES, duration=T, steps=STEPS,
    runners=RUNNERS,
    acceleration=lambda lessons: attraction, start=planet, run=run, observe=coordinates(2),
    truth=kepler_position, **PLANET,
    truth_uncertainty=1e-12,    # of the reference solution, as in kepler: 1e-13
    published_states=((20.0, (-1.295266251, 0.400393896), 1e-9),),
    points=sun_and_planet,
    film_seconds=12.6,          # two revolutions [s]
    uses=("one point in the plane", "one step function"),
    ablations={"the third dimension": planet_in_space,
              "rotation": "the whole loop of lesson 10 has it, and a full run measures it"},
)
