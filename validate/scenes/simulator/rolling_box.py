"""A box is pushed askew over the ground and carries 25 balls, which roll on it: a benchmark of engines for robots.

The box slides and the balls roll without slipping, so friction has a closed form.  Engines whose friction is a pyramid
do not move the box at all: askew, their friction is larger than the push.
"""

from functools import cache, partial
from typing import Annotated, Any, NamedTuple

import numpy as np

from solutions.checks import BadInput, check_friction
from solutions.given.compose import Settings
from solutions.support.model import WORLD, Body, Spring, make_model, start_of
from solutions.support.shapes import Ball, Box, HalfSpace
from validate.check import states
from validate.engines import watched
from validate.methods import IN_COORDINATES, PARTS_OF_LOOP
from validate.reference.contact_laws import Physics
from validate.reference.exams import velocity_error
from validate.scene import EXACT, MUJOCO, PYBULLET, ROUND_OFF, Exam, Prediction, Scene, engine, no_limit, ours
from validate.scenes import drawing
from validate.scenes._common import built, check_positives
from validate.scenes.drawing import circle, outlines, pose
from validate.worlds.bullet import OVERLAP

T = 4.0                      # [s]: as long as the published problem lasts
STEPS = (8, 16, 40, 80, 160, 400, 800)
HALF = (10.0, 10.0, 0.5)     # of the box [m]
RADIUS, APART, ROW = 0.5, 2.0, 5         # of the balls [m], between their centres [m], balls in a row [-]
LINE = APART * (np.arange(ROW) - 0.5 * (ROW - 1))
PLACES = np.array([(0.0, 0.0, HALF[2]), *((x, y, 2.0 * HALF[2] + RADIUS) for y in LINE for x in LINE)])   # box, balls
PUSH = 150.0                 # on the box [N]
ALONG = np.array([0.5, np.sqrt(0.75), 0.0])              # as the benchmark's code has its "xy"
FAR = 1e9                    # length of the spring that pushes [m]: its force stays to 1e-8
SWEEPS, SETTLED = 300, 1e-6              # of the loop [-]
ITERATIONS = 100                         # of the engines [-]
FITS = 0.03                  # way in a step up to which pybullet's kept contact points fit, as measured [m]
MARGIN = 0.9                 # a contact counts as the one before if it has moved less [m]: balls are 1 m apart
GROUND, BOX = 0, 1           # numbers of bodies; the row of the box in the loop is 0
PAIR = slice(BOX, BOX + 2)   # of bodies: the box, and the ball in a corner


class Params(NamedTuple):
    mu: Annotated[float, "friction of box and ground [-]"] = 0.4
    grip: Annotated[float, "friction of balls and box [-]"] = 0.8
    M: Annotated[float, "mass of the box [kg]"] = 10.0
    m: Annotated[float, "mass of each ball [kg]"] = 1.0
    g: Annotated[float, "gravity [m/s²]"] = 9.81


CASES = {"published": Params(), "rough ground": Params(mu=0.42)}


def accelerations(p):
    """Return the accelerations of the box and of the balls [m/s²].

    Box:  M a = F − μ (M + n m) g − n f.  Ball:  m b = f  and  ⅖ m R² α = f R  with  a = b + R α = 7/2 b.
    Raises BadInput where the box does not slide, the balls do not roll, or one of them leaves the box: relative to it
    they move by ½ (a − b) T² = 5/4 b T² against the push.
    """
    n = ROW**2
    left = PUSH - p.mu * (p.M + n * p.m) * p.g
    if left <= 0.0:
        raise BadInput("friction of box and ground [-]", p.mu, "give less: the box does not move")
    b = left / (3.5 * p.M + n * p.m)
    if b > p.grip * p.g:
        raise BadInput("friction of balls and box [-]", p.grip, "give more: the balls slip")
    if np.max(ALONG) * 1.25 * b * T * T > HALF[0] - np.max(LINE):
        raise BadInput("friction of box and ground [-]", p.mu, f"give more: within {T:g} s balls roll off the box")
    return 3.5 * b, b


@cache
def model(p):
    """Return the Model.  Friction of a pair is a product, so the box has the μ of the balls, and the ground the rest.

    A long spring pulls with the force of the push.
    """
    balls = [Body(tuple(place), p.m, Ball(RADIUS), 1.0) for place in PLACES[1:]]
    ground = Body((0.0, 0.0, 0.0), shape=HalfSpace((0.0, 0.0, 1.0)), mu=p.mu / p.grip)
    return make_model([ground, Body(tuple(PLACES[0]), p.M, Box(HALF), p.grip), *balls], (0.0, 0.0, -p.g),
                      springs=[Spring(BOX, WORLD, (0.0, 0.0, 0.0), tuple(PLACES[0] + FAR * ALONG), 0.0, PUSH / FAR)])


@cache
def start(p):
    """Return the State of the Model, and ways and speeds of the box and the balls along the push.

    None stands for what our loop needs beside its own state.
    """
    check_positives(p, "M", "m", "g", "grip")
    check_friction(p.mu)
    accelerations(p)
    return start_of(model(p)), None, np.zeros(2), np.zeros(2)


@cache
def composed(simulator, p):
    """Return the state of our loop, and what does not change.  Steps change none of it, so it is made once."""
    loop = simulator.compose(model(p), Settings(SWEEPS, SETTLED, MARGIN))
    return loop.state, loop.p


def slides_and_rolls(t, y, u, p):
    """Return the accelerations (2,) of the box and of the balls along the push."""
    n = ROW * ROW
    b = (PUSH - p.mu * (p.M + n * p.m) * p.g) / (3.5 * p.M + n * p.m)
    return np.array([3.5 * b, b])


def run(lessons, step, acceleration, state, p, dt, steps):
    """Run the two coordinates, or the parts of the loop that the Model needs, in their order."""
    simulator, (now, rows, y, u) = lessons.simulator, state
    if step is lessons.integrators.verlet_step:
        return None, None, *lessons.integrators.advance(step, acceleration, 0.0, y, u, dt, steps, p)
    if rows is None:
        now, rows = composed(simulator, p)
    now = simulator.advance_parts(
        step, simulator.accelerate_in_space, simulator.detect_many, simulator.separate_in_space,
        simulator.contact_impulses_in_space, simulator.move_and_turn_in_space, simulator.leave,
        simulator.first_touch, simulator.model_load_in_space, simulator.rounded_bounds, simulator.rounded_contacts, 0.0,
        now, dt, steps, rows)
    return now, rows, y, u


def seen(x, v, first):
    """Return places and velocities of the box and of the ball in a corner; first: the row of the box."""
    return np.concatenate((x[first], v[first], x[first + 1], v[first + 1]))


def observe(state, p):
    now, rows, y, u = state
    if now is None:
        return seen(PLACES[:2] + np.outer(y, ALONG), np.outer(u, ALONG), 0)
    return seen(now.x, now.v, BOX if rows is None else 0)


def read(state, p):
    return seen(state.x, state.v, BOX)


def truth(p, t):
    """Places and velocities of the box and of a ball: both are accelerated alike from the beginning on."""
    a, b = accelerations(p)
    return np.concatenate([np.concatenate((place + 0.5 * t * t * rate * ALONG, t * rate * ALONG))
                           for place, rate in zip(PLACES[:2], (a, b))])


# ---------------------------------------------------------------------------------------------- errors

def ahead(p, dt):
    """Velocities are exact at every step, and places go with the new ones: they are ahead by ½ a dt T.

    The sweeps of a step end when one changes no impulse by more than 10⁻⁶ of the largest one, which is less than
    a third of the weight times dt.  Each sweep halves what is left, so as much again is missing.
    """
    a, b = accelerations(p)
    off = np.concatenate([np.concatenate((0.5 * rate * dt * T * ALONG, np.zeros(3))) for rate in (a, b)])
    size = np.linalg.norm(truth(p, T))
    left = 2.0 * SETTLED * (p.M + ROW**2 * p.m) * p.g / 3.0 * T / p.m        # of the velocity of a ball [m/s]
    return Prediction(off, left * (1.0 + 0.5 * T) / size)


def limits(p, dt):
    """The rectangle rule is off by ½ a dt T, and what the sweeps leave is far less."""
    return np.linalg.norm(ahead(p, dt).error) / np.linalg.norm(truth(p, T)) + ahead(p, dt).band


def bullet_ahead(p, dt):
    """pybullet's velocities are exact, too, and its places go with the new ones.  The box sinks into the ground by the
    overlap that it allows, and the balls by twice that.  With longer steps the points of contact that it keeps lie
    elsewhere by now.
    """
    if accelerations(p)[0] * T * dt > FITS:
        return None
    return ahead(p, dt)._replace(band=3.0 * OVERLAP / np.linalg.norm(truth(p, T)))


def bullet_limit(p, dt, predict=bullet_ahead):
    """pybullet's error is predicted for steps in which nothing moves by more than 3 cm.  This way was measured.  Longer
    steps have no limit.
    """
    found = predict(p, dt)
    return np.inf if found is None else np.linalg.norm(found.error) / np.linalg.norm(truth(p, T)) + found.band


def bullet_lag(p, dt):
    """With a leapfrog start the places are exact, and the velocities in the end lag by half a step."""
    found = bullet_ahead(p, dt)
    lags = np.concatenate([np.concatenate((np.zeros(3), -0.5 * rate * dt * ALONG)) for rate in accelerations(p)])
    return found and found._replace(error=lags)


def at_first(p):
    """Return the accelerations (27, 3), (27, 3) of the ground, the box and the balls, which are constant."""
    a, b = accelerations(p)
    turn = -(a - b) / RADIUS * np.cross((0.0, 0.0, 1.0), ALONG)
    return np.outer((0.0, a, *[b] * ROW**2), ALONG), np.outer((0.0, 0.0, *[1.0] * ROW**2), turn)


def rounded(p, dt):
    """Verlet's step is exact where the acceleration is constant."""
    return 1e-13 + T / dt * ROUND_OFF


# ---------------------------------------------------------------------------------------------- engines

def physics(p):
    """Return the Physics of the box and the balls.  Friction of a pair is a product, and the ground is the last row."""
    n, mu = ROW**2, np.array([p.grip, *[1.0] * ROW**2, p.mu / p.grip])
    inertia = np.vstack((p.M / 3.0 * (np.sum(np.square(HALF)) - np.square(HALF)),
                         np.full((n, 3), 0.4 * p.m * RADIUS**2)))
    return Physics(np.array([0.0, 0.0, -p.g]), 1.0 / np.array([p.M, *[p.m] * n]), 1.0 / inertia, np.outer(mu, mu))


def pushed(p, dt):
    """Return (Motion before) → impulses (n, 3) [N s] of the long spring in a step, which pulls at the box alone."""
    anchor, k = np.array(model(p).springs[0].place_b), PUSH / FAR
    return lambda before: np.vstack((dt * k * (anchor - before.x[0]), np.zeros((ROW**2, 3))))


def watch_bullet(bullet, p, dt):
    return watched.Bullet(bullet.pb, dt, None, physics(p), pushed(p, dt))


def watch_mujoco(world, p, dt):
    return watched.MuJoCo(world, dt, physics(p), pushed(p, dt))


BULLET: dict[str, Any] = {
    "measured": "that steps fit in which nothing moves by more than 3 cm, on runs of 170 to 800 steps",
    "laws": watched.bullet_rules(ITERATIONS, rests=False, slop=OVERLAP), "most_in_quick": 16}
RUNNERS = (
    ours(IN_COORDINATES, order=EXACT, limit=rounded, predicted=lambda p, dt: Prediction(np.zeros(12), rounded(p, dt))),
    ours(PARTS_OF_LOOP, limit=limits, predicted=ahead, in_quick=False),
    engine(PYBULLET, "", built(PYBULLET, model, read, watch_bullet), "maximal coordinates, no damping, 100 iterations",
           order=1, limit=bullet_limit, predicted=bullet_ahead,
           **BULLET),
    engine(PYBULLET, "leapfrog start", built(PYBULLET, model, read, watch_bullet, at_first),
           "the same, first velocities − ½ a dt", order=1, limit=partial(bullet_limit, predict=bullet_lag),
           predicted=bullet_lag, **BULLET),
    engine(MUJOCO, "", built(MUJOCO, model, read, watch_mujoco), "the exact cone of friction; Euler",
           order=1, limit=no_limit, predicted="its contacts are soft: where friction holds they creep",
           laws=watched.mujoco_rules(ITERATIONS), most_in_quick=16, most_steps=400),
)

EXAM = Exam(
    organiser="SimBenchmark", problem="Rolling, oblique push",
    statement="A box of 10 kg and 20 × 20 × 1 m lies on the ground and carries 25 balls of 1 kg. A force of 150 N "
              "pushes it askew for 4 s, so that it slides and the balls roll on it.",
    source="leggedrobotics.github.io/SimBenchmark, rolling test",
    duration=T, outputs=8, steps=(8, 16, 40, 80, 160, 400, 800, 1600, 4000),
    measure=velocity_error, unit="mean of the squared errors of the velocities of the box and of a ball [m²/s²]",
    grade=None, enough=0.0,
    gives_up={IN_COORDINATES: "everything but this motion: it is told what slides and what rolls",
              PARTS_OF_LOOP: "nothing here: one contact for each ball and four for the box",
              PYBULLET: "velocities at the end of a step, if it has a leapfrog start: they lag by half a step",
              MUJOCO: "rigid contacts, and friction that holds"},
    published=(("Bullet", "5.7e-9 in 0.56 s"), ("RaiSim", "4.1e-7 in 0.31 s"), ("MuJoCo, Newton", "6.9e-3 in 1.67 s"),
               ("ODE and DART", "3.14: with a pyramid of friction nothing moves")),
    note="The benchmark's code pushes 60° from the x axis, where its page shows a diagonal: we do as the code does. It "
         "takes its mean over all steps, and we over eight outputs.")


def sanity_checks():
    """Return Findings about the truth: the published accelerations, and balances that the closed form did not use."""
    p = CASES["published"]
    a, b = accelerations(p)
    weight = (p.M + ROW**2 * p.m) * p.g
    spin = (a - b) / RADIUS
    power = PUSH * a - p.mu * weight * a         # over t [W/s], at t = 1 s
    return (states("published accelerations of box and balls [m/s²]", (a, b), (0.7385, 0.2110), 1e-4),
            states("published error of an engine in which nothing moves, over all times [m²/s²]",
                   (a * a + b * b) * T * T / 3.0, 3.14, 0.01),
            states("momentum gained per second, less push and friction [N]",
                   p.M * a + ROW**2 * p.m * b - (PUSH - p.mu * weight), 0.0, 1e-12),
            states("power of push and friction, less that of motion, after 1 s [W]",
                   power - p.M * a * a - ROW**2 * p.m * (b * b + 0.4 * RADIUS**2 * spin**2), 0.0, 1e-12))


# ---------------------------------------------------------------------------------------------- picture

def points(observed, p):
    """Draw the box and the ball of a corner from above."""
    corners = np.array([(1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0), (1.0, -1.0)]) * HALF[:2]
    return np.vstack((observed[:2] + corners, observed[6:8] + RADIUS * circle(24)))


def links(p):
    return [*outlines(4), *outlines(24, 1, 4)]


def bodies(p):
    return [drawing.box(np.array(HALF)), *[drawing.sphere(RADIUS)] * ROW**2]


def poses(observed, p):
    """Return the box and all balls, which move alike and are drawn without their rotation."""
    shift = observed[6:9] - PLACES[1]
    return [pose(observed[:3], np.eye(3)), *(pose(place + shift, np.eye(3)) for place in PLACES[1:])]


SCENE = Scene(
    title="Balls on a pushed box", lesson="simulator",
    cases=CASES, duration=T, steps=STEPS,
    runners=RUNNERS,
    acceleration=lambda lessons: slides_and_rolls, start=start, run=run, observe=observe,
    truth=truth, truth_uncertainty=1e-15,
    slow_cases=("rough ground",),
    omitted_methods="pymunk is planar: seen from above, nothing lies on the box",
    full_loop="the loop of the Model is a method here",
    sanity_checks=sanity_checks,
    points=points, links=links,
    bodies=bodies, poses=poses,
    uses=("two coordinates", "friction that holds and friction that slides", "no detection"),
    ablations={"contacts": "the loop of the Model has them, and is run beside"},
    exam=EXAM,
)
