"""Two stars attract each other and circle their common centre of mass, each on an ellipse of its own."""

from functools import partial
from typing import Annotated, NamedTuple

import numpy as np

from solutions.support.model import Body, Force, make_model
from validate.check import states
from validate.methods import INTEGRATORS
from validate.reference.integrators import kepler_motion, kepler_position
from validate.scene import Scene
from validate.scenes._common import built, check_positives
from validate.scenes.integrators._common import planet, planet_runners

T = 20.0                     # [s]: six revolutions
STEPS = (500, 1000, 2000, 5000, 10000, 20000, 50000)


class Stars(NamedTuple):
    """Two stars that start at their smallest distance, with their centre of mass at rest in the origin."""
    m_a: Annotated[float, "mass of the heavy star [kg]"] = 3.0
    m_b: Annotated[float, "mass of the light star [kg]"] = 1.0
    G: Annotated[float, "constant of gravity [m³/(kg s²)]"] = 1.0
    a: Annotated[float, "half the long axis of the path of one star as seen from the other [m]"] = 1.0
    e: Annotated[float, "eccentricity [-]"] = 0.6

    @property
    def mu(self):
        """Return G (m_a + m_b) [m³/s²]: the relative path of the stars is that of a planet around such a sun."""
        return self.G * (self.m_a + self.m_b)


CASES = {"3 : 1": Stars()}


def both(r, p):
    """Return the rows of a and b (2, 2) that belong to r = x_b − x_a (2,), about the centre of mass."""
    total = p.m_a + p.m_b
    return np.stack((-p.m_b / total * r, p.m_a / total * r))


def acceleration(lessons):
    universal_gravity = lessons.springs.universal_gravity

    def attraction(t, x, v, p):
        """m_a a_a = F,  m_b a_b = −F"""
        F = universal_gravity(x[0], x[1], p.m_a, p.m_b, p.G)
        return np.stack((F / p.m_a, -F / p.m_b))
    return attraction


def start(p):
    check_positives(p, "m_a", "m_b", "G")
    r, v = planet(p)
    return both(r, p), both(v, p)


def run(lessons, step, acceleration, state, p, dt, steps):
    x, v = state
    return lessons.integrators.advance(step, acceleration, 0.0, x, v, dt, steps, p)


def observe(state, p):
    return state[0][:, :2].ravel()


def truth(p, t):
    """x_a = −m_b/(m_a + m_b) r,   x_b = m_a/(m_a + m_b) r,   r̈ = −G (m_a + m_b) r/|r|³

    Forces that are opposite leave the centre of mass at rest.  Dividing by the masses and subtracting gives Kepler's
    law for r.  Every method keeps the centre of mass, so that both stars err like r.
    Source: Newton 1687, Principia, book I, propositions 57 to 60; Goldstein, Classical mechanics, § 3.1.
    """
    return both(kepler_position(p, t), p).ravel()


def seen(r, p):
    return both(np.array([r.real, r.imag]), p).ravel()


# the relative errors are those of one planet, because both paths are similar to that of r
MOTION = kepler_motion(T)._replace(seen=seen, truth=truth)


def model(p):
    """Make both stars, each with its attraction by the other."""
    strength = p.G * p.m_a * p.m_b

    def attraction(r):
        along, up = r
        pull = strength / (along * along + up * up) ** 1.5
        return pull * along, pull * up
    x, v = start(p)
    return make_model([Body(tuple(place), m, v=tuple(speed)) for m, place, speed in zip((p.m_a, p.m_b), x, v)],
                      (0.0, 0.0), loads=[Force(0, attraction, "r", 1), Force(1, attraction, "r", 0)])


def read(state, p):
    """Return the places of both stars."""
    return state.x.ravel()


def points(observed, p):
    """Draw both stars."""
    return np.reshape(observed, (2, 2))


def in_space(p):
    """Return the same motion with an unused z coordinate."""
    return tuple(np.append(rows, np.zeros((2, 1)), axis=1) for rows in start(p)), p


def sanity_checks():
    """Return Findings: the centre of mass, and Kepler's third law for two bodies."""
    p = CASES["3 : 1"]
    period = 2.0 * np.pi * np.sqrt(p.a**3 / (p.G * (p.m_a + p.m_b)))
    x_a, x_b = truth(p, 0.3).reshape(2, 2)
    moved = np.linalg.norm(p.m_a * x_a + p.m_b * x_b) / (p.m_a + p.m_b)
    return (states("distance of the centre of mass from the origin [m]", moved, 0.0, 1e-15),
            states("place of both after a revolution: largest difference [m]",
                   np.max(np.abs(truth(p, period) - truth(p, 0.0))), 0.0, 1e-14))


SCENE = Scene(
    title="Two stars", lesson="springs",
    cases=CASES, duration=T, steps=STEPS,
    runners=planet_runners(MOTION, INTEGRATORS, 20_000, compiled=(), world=partial(built, model=model, read=read)),
    acceleration=acceleration, start=start, run=run, observe=observe,
    truth=truth, truth_uncertainty=1e-12, model=model, read=read,
    sanity_checks=sanity_checks, points=points,
    film_seconds=6.3,                                    # two revolutions
    uses=("two points in the plane", "one force and its reaction", "one step function"),
    ablations={
        "the third dimension": in_space,
        "rotation": "the whole loop of lesson 10 has it, and a full run measures it",
        "a third star": "it has no closed form",
    },
)
