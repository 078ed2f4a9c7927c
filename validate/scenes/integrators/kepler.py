"""A planet orbits its sun almost sixteen times on an ellipse, and the methods are compared by its final position."""

from solutions.support.orbits import attraction
from validate.methods import BLANES_MOAN, INTEGRATORS
from validate.reference.integrators import Planet, kepler_motion, kepler_position
from validate.scene import Scene
from validate.scenes._common import coordinates
from validate.scenes.integrators._common import PLANET, planet, planet_in_space, planet_runners, sun_and_planet

T = 100.0                    # [s]: 15.9 revolutions
STEPS = (500, 1000, 2000, 5000, 10000, 14000, 20000, 50000, 100000, 150000, 200000)
# Euler, average velocity and implicit Euler gain or lose energy at every passage; see drift() in
# validate/reference/integrators.py.  They are drawn, but theory gives no limit for them at any step here.
CASES = {"e = 0.6": Planet()}


def run(lessons, step, acceleration, state, p, dt, steps):
    x, v = state
    return lessons.integrators.advance(step, acceleration, 0.0, x, v, dt, steps, p)


SCENE = Scene(
    title="Kepler", lesson="integrators",
    cases=CASES, duration=T, steps=STEPS,
    runners=planet_runners(kepler_motion(T), (*INTEGRATORS, BLANES_MOAN), 50_000),
    acceleration=lambda lessons: attraction, start=planet, run=run, observe=coordinates(2),
    truth=kepler_position, **PLANET,
    # of the reference solution: round-off in the energy, v²/2 − μ/r, grows like a phase error to 3e-13
    truth_uncertainty=1e-12,
    published_states=((100.0, (-0.104183204, -0.694741716), 1e-9),),   # then v = (1.236177763, 0.564623251) m/s
    points=sun_and_planet,
    film_seconds=12.6,  # two revolutions [s]
    uses=("one point in the plane", "one step function"),
    ablations={
        "the third dimension": planet_in_space,
        "the motion of the sun": "the lighter the planet, the smaller the effect",
        "steps that adapt to the distance": "the scene of the near collision has them",
        "rotation": "the whole loop of lesson 10 has it, and a full run measures it",
    },
)
