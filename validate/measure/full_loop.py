"""The gain of leaving parts out: the whole loop of lesson 10 compared with the scene's own method.

The whole loop rotates bodies whose rotation is not observed, searches for contacts that cannot occur, and sweeps over
what it finds.  Put in place of a step that it contains, it must give the same motion to round-off.
Both run as plain Python.  A mass on a string is a chain of rods for the loop: each has a joint at its upper end, and
all of its mass at its lower end, so that it does what a string does while it is taut.
"""

from collections.abc import Callable
from functools import partial
from typing import NamedTuple

import numpy as np

from ..check import Verdict, jsonable
from ..methods import DISCRETE, GYROSCOPIC, PENALTY, RATTLE, ROLLING, SLIDING, SYMPLECTIC_EULER
from . import timing
from .accuracy import relative, run_to_end
from .compilation import compilation
from .exams import exam_of
from .our_parts import our_parts, row
from .preparation import preparations
from .selection import select, with_overrides
from .staged import PARTS, lessons_without
from .switches import engine_parts
from .timing import SAME, Timed, interleaved, time_ours

NEAR = 1e-9                  # gap up to which the loop finds contacts [m]
SMALL = 0.01                 # radius of a point over the least distance of two of them, or over 1 m [-]
SWEEPS = 10                  # an engine's usual number; in the plane one contact needs one
IN_SPACE = 60                # of a contact that rubs in space: each leaves half of a slip [-]
GRIP = 100.0                 # friction that stops every contact, however oblique the impact [-]
STOPPED = 1e-14              # speed that is left over the speed before [-]: round-off
SLENDER = 1e-11              # moment of a string's point about itself over m l² [-]: below SAME, far above round-off
LEAST = 50                   # steps of a run
UPRIGHT = np.array([1.0, 0.0, 0.0, 0.0])


def loop(simulator, dim):
    """Return (step, bounds, narrow, make) of round bodies in the plane or in space."""
    if dim == 2:
        return (simulator.contact_step_2d, simulator.disc_bounds, simulator.round_contacts, simulator.make_bodies_2d)
    return simulator.contact_step, simulator.ball_bounds, simulator.round_contacts, simulator.make_bodies


class Whole:
    """The whole loop for n round bodies: it has the record of the bodies and the contacts of the last step.

    lessons: those of the subject.
    """

    def __init__(self, lessons, x, m, inertia, radius, planes, gravity, mu, sweeps=SWEEPS, margin=NEAR):
        n, dim = x.shape
        self.step, self.bounds, self.narrow, make = loop(lessons.simulator, dim)
        q = np.zeros(n) if dim == 2 else np.tile(UPRIGHT, (n, 1))
        half = np.outer(np.broadcast_to(radius, n), np.ones(dim))
        self.state, self.bodies = make(x, q, m, inertia, half, planes, gravity, mu, sweeps, margin)

    def advance(self, load, t, dt, **now):
        """Return the state after dt, from one in which the fields `now` of the bodies (n, …) are these."""
        for name, values in now.items():
            rows = getattr(self.state, name).copy()
            rows[:len(values)] = values
            self.state = self.state._replace(**{name: rows})
        self.state = self.step(load, self.bounds, self.narrow, t, self.state, dt, self.bodies)
        return self.state


def points(lessons):
    """Make the whole loop in place of symplectic_euler_step of lesson 1.

    It has points that touch nothing, in the plane or in space.
    """
    whole = []

    def symplectic_euler_step(acceleration, t, x, v, dt, p):
        place = np.atleast_2d(x)
        n, d = place.shape
        dim = max(d, 2)
        wide = lambda values: np.hstack((np.reshape(values, (n, d)), np.zeros((n, dim - d))))
        if not whole:
            inertia = np.ones(n) if dim == 2 else np.ones((n, 3))
            apart = np.linalg.norm(place[:, None] - place, axis=2) + np.diag(np.full(n, 1.0))
            whole.append(Whole(lessons, wide(x), 1.0, inertia, SMALL * apart.min(), np.zeros((0, dim + 1)),
                               np.zeros(dim), 0.0))

        def load(t, places, q, velocities, omega, _):
            shape = np.shape(x)
            return wide(acceleration(t, places[:, :d].reshape(shape), velocities[:, :d].reshape(shape), p)), 0.0 * omega
        now = whole[0].advance(load, t, dt, x=wide(x), v=wide(v))
        return now.x[:, :d].reshape(np.shape(x)), now.v[:, :d].reshape(np.shape(x))
    return symplectic_euler_step


def sprung_floor(lessons):
    """Make the whole loop in place of penalty_step of lesson 7.

    It has a point over a floor whose spring and damper are forces.
    """
    step, impulses = points(lessons), lessons.impulses

    def penalty_step(acceleration, t, x, v, dt, p):
        def with_floor(t, x, v, p):
            push = impulses.penalty_force(impulses.gap(x, p), v @ p.n, p.stiffness, p.damping)
            return acceleration(t, x, v, p) + push * p.n
        return step(with_floor, t, x, v, dt, p)
    return penalty_step


def stopped_ball(lessons):
    """Make the whole loop in place of discrete_step of lesson 6.

    It has a ball that stops on a plane or, seen along its axis, on a cylinder.  The loop finds a contact at the
    beginning of a step, and the lesson at the end of the step before; between the two nothing moves.  A ball whose
    speed is round-off has stopped: the lesson takes no more steps of it.
    """
    whole = []

    def discrete_step(find_gap, impact_time, t, x, v, dt, p):
        flat = p.R > 0.0
        if not whole and flat:
            whole.append(Whole(lessons, np.stack((x[1:], np.zeros(2))), np.array([1.0, np.inf]), np.inf,
                               np.array([p.r, p.R]), np.zeros((0, 3)), np.zeros(2), GRIP))
        elif not whole:
            plane = np.append(p.plane.n, p.plane.d)[None]
            whole.append(Whole(lessons, x[None], 1.0, np.full((1, 3), np.inf), p.r, plane, np.zeros(3), GRIP, IN_SPACE))
        seen = slice(1, 3) if flat else slice(3)
        now = whole[0].advance(no_load, t, dt, x=x[None, seen], v=v[None, seen])
        place, speed = x + dt * v, v.copy()                        # along the axis of a cylinder nothing acts
        place[seen], speed[seen] = now.x[0], now.v[0]
        return place, 0.0 * v if np.linalg.norm(speed) < STOPPED * np.linalg.norm(v) else speed
    return discrete_step


def no_load(t, x, q, v, omega, p):
    return 0.0 * x, 0.0 * omega


def strings(lessons):
    """Make the whole loop in place of rattle_step of lesson 8 for a pendulum or a rope.

    It has rods with joints, and a search for contacts.
    """
    whole, simulator = [], lessons.simulator

    def rattle_step(acceleration, t, x, v, dt, network):
        turn, rate = link_angles(x, v)
        if not whole:
            m = np.divide(1.0, network.inv_mass, out=np.full(len(x), np.inf), where=network.inv_mass > 0.0)
            one = Whole(lessons, x, m, SLENDER * m * np.max(network.rest) ** 2, SMALL * np.min(network.rest),
                        np.zeros((0, 3)), np.zeros(2), 0.0)
            whole.append((one, simulator.make_joints(one.state, one.bodies, network.j, network.i, x[network.i], 0.0),
                          turn))
        one, rods, first = whole[0]
        low, high, turned = one.bounds(x, turn - first, rods.half)
        found = simulator.find_contacts(one.narrow, x, low, high, turned, rods)
        if simulator.without_joined(found, rods.joints).a.size:
            raise ArithmeticError("the string touches itself")

        def load(t, places, q, velocities, omega, _):
            F = acceleration(t, places, velocities, network)
            return F * np.divide(1.0, network.inv_mass, out=np.zeros(len(x)), where=network.inv_mass > 0.0)[:, None], \
                0.0 * omega
        places, _, velocities, _ = simulator.joint_step_2d(load, t, x, turn - first, v, rate, dt, rods)
        return places, velocities
    return rattle_step


def link_angles(x, v):
    """Return angles (n,) [rad] of the links to points 1 … n − 1 of a chain (n, 2), and their rates; 0 for point 0."""
    link, apart = np.diff(x, axis=0), np.diff(v, axis=0)
    rates = (link[:, 0] * apart[:, 1] - link[:, 1] * apart[:, 0]) / np.sum(link * link, axis=1)
    return np.append(0.0, np.arctan2(link[:, 1], link[:, 0])), np.append(0.0, rates)


def block(lessons):
    """Make the whole loop in place of sliding_step of lesson 3.

    It has a ball that cannot rotate, on a plane.
    """
    whole = []

    def sliding_step(acceleration, t, x, v, dt, p):
        d, size = x.size, 0.1
        if not whole:
            inertia = np.full(1, np.inf) if d == 2 else np.full((1, 3), np.inf)
            whole.append(Whole(lessons, (x + size * p.n)[None], 1.0, inertia, size, np.append(p.n, 0.0)[None],
                               np.zeros(d), p.mu_k, SWEEPS if d == 2 else IN_SPACE, size))

        def load(t, places, q, velocities, omega, _):
            F = np.zeros(places.shape)
            F[0] = acceleration(t, places[0] - size * p.n, velocities[0], p)
            return F, 0.0 * omega
        now = whole[0].advance(load, t, dt, x=(x + size * p.n)[None], v=v[None])
        return now.x[0] - size * p.n, now.v[0]
    return sliding_step


def turning_body(lessons):
    """Make the whole loop in place of gyroscopic_step of lesson 5.

    It has one body in space that touches nothing.
    """
    whole, angular_momentum = [], lessons.rotation.body_angular_momentum

    def gyroscopic_step(torque, t, q, L, dt, body):
        if not whole:
            whole.append(Whole(lessons, np.zeros((1, 3)), 1.0, body.I_body[None], SMALL, np.zeros((0, 4)),
                               np.zeros(3), 0.0))

        def load(t, x, turned, v, omega, _):
            return 0.0 * x, torque(t, turned[0], angular_momentum(turned[0], omega[0], body.I_body), body)[None]
        now = whole[0].advance(load, t, dt, q=q[None], omega=angular_momentum(q, L, 1.0 / body.I_body)[None])
        return now.q[0], angular_momentum(now.q[0], now.omega[0], body.I_body)
    return gyroscopic_step


def rolling_ball(lessons):
    """Make the whole loop in place of rolling_step of lesson 5.

    It has a ball on the plane z = 0, detected at every step.
    """
    whole, weight = [], lessons.simulator.weight

    def rolling_step(load, t, x, q, v, omega, dt, ball):
        if not whole:
            whole.append(Whole(lessons, x[None], ball.m, ball.I_body[None], ball.radius,
                               np.array([(0.0, 0.0, 1.0, 0.0)]), ball.gravity, ball.mu, IN_SPACE, 0.1 * ball.radius))
        now = whole[0].advance(weight, t, dt, x=x[None], v=v[None], q=q[None], omega=omega[None])
        return now.x[0], now.q[0], now.v[0], now.omega[0]
    return rolling_step


FULL = {SYMPLECTIC_EULER: points, SLIDING: block, GYROSCOPIC: turning_body, ROLLING: rolling_ball,
        PENALTY: sprung_floor, DISCRETE: stopped_ball, RATTLE: strings}      # the whole loop in place of each method


def made_when_called(make):
    """Return a step that is made by its first call: a lesson that is missing then fails as a run does."""
    made = []

    def step(*now):
        if not made:
            made.append(make())
        return made[0](*now)
    return step


def time_whole(scene, make, p):
    """Return prepare(steps, dt) for the whole loop, which begins without contacts every time."""
    return lambda steps, dt: time_ours(scene, make(), p)(steps, dt)


def labels_as_expected(result):
    """Return labels of our methods that agree with the truth in the first case, or depart as predicted."""
    first = next(iter(result["cases"].values()))
    return {c["label"] for c in first["ours"] if Verdict(c["verdict"]) in (Verdict.AGREES, Verdict.FOLLOWS_OWN_LAW)}


def steps_that_fail(result, label):
    """Return numbers of steps with which a method does not come to the end in the first case."""
    first = next(iter(result["cases"].values()))
    return {row["steps"] for c in first["ours"] if c["label"] == label for row in c["rows"] if row["failure"]}


class Stand(NamedTuple):
    """A method of ours in a scene for which the whole loop can stand."""
    selection: object        # Selection
    p: object                # the case that is timed
    runner: object           # Runner
    steps: int
    step: Callable           # of the method

    def whole(self, lessons):
        """Return a maker of the whole loop with these lessons."""
        return partial(FULL[self.runner.who], lessons)

    def end(self, step):
        """Return the Outcome of a step after the whole run."""
        return run_to_end(self.selection.scene, step, self.p, self.steps)


def stand(selection, result):
    """Return the Stand of a scene, or a sentence that says why there is none.

    result: the errors of the scene.  A method that departs there is not compared.
    """
    scene, (_, p) = selection.scene, selection.first
    here = [r for r in scene.our_runners if r.who in FULL]
    runner = next((r for r in here if r.label in labels_as_expected(result)), None)
    if scene.full_loop or not here:
        return scene.full_loop
    if selection.plan.quick:
        return "left to --full"
    if runner is None:
        return f"{here[0].label} departs from the truth here"
    steps = next(n for n in scene.steps if n >= LEAST and n not in steps_that_fail(result, runner.label))
    return Stand(selection, p, runner, steps, selection.bound(runner, "plain")[1])


def left_out(name, plan, result):
    """Return what a scene saves: {method, steps, ratio, same, observed, repeats, note}; note: why there is no number.
    """
    nothing = {"method": "", "steps": None, "ratio": None, "same": None, "observed": None, "repeats": None}
    one = stand(select(name, plan), result)
    if isinstance(one, str):
        return {**nothing, "note": one}
    scene = one.selection.scene
    make, dt = one.whole(scene.lessons), scene.duration / one.steps
    full_end, own_end = one.end(made_when_called(make)), one.end(one.step)
    if full_end.observed is None:
        return {**nothing, "note": f"the whole loop does not run here: {full_end.failure}"}
    timed = [Timed("without", "plain", one.steps, dt, time_ours(scene, one.step, one.p)),
             Timed("with", "plain", one.steps, dt, time_whole(scene, make, one.p))]
    (_, lean), (_, full) = interleaved(timed, {"plain": np.inf}, plan.repeats())
    return {"method": one.runner.label, "steps": one.steps, "ratio": full["seconds"] / lean["seconds"],
            "same": relative(full_end.observed, own_end.observed) < SAME,
            "observed": (full_end.observed, own_end.observed),
            "repeats": (full["repeats"], lean["repeats"]), "note": ""}


NOT_COMPILED = "the whole loop of lesson 10 in place of the scene's method, in plain Python"


def whole_parts(selection, result):
    """Return what `our_parts` does for a scene that is no Model: parts are left out of the whole loop of lesson 10."""
    one = stand(selection, result)
    if isinstance(one, str) or one.runner.who is RATTLE:             # a string is no contact_step
        return {"rows": [], "note": ""}
    lessons = selection.scene.lessons
    makers = {None: one.whole(lessons), **{part: one.whole(lessons_without(lessons, part)) for part in PARTS}}
    ends = {part: one.end(made_when_called(make)).observed for part, make in makers.items()}
    if ends[None] is None:
        return {"rows": [], "note": ""}
    items = [Timed(part, "plain", one.steps, selection.scene.duration / one.steps,
                   time_whole(selection.scene, make, one.p)) for part, make in makers.items() if ends[part] is not None]
    times = {item.label: found for item, found in interleaved(items, {"plain": np.inf}, selection.plan.repeats())}
    return {"note": NOT_COMPILED, "rows": [row(part, "plain", one.steps, [times[None], times[part]],
                                               [ends[None], ends[part]]) for part in PARTS if part in times]}


def parts(selection, p, result):
    """Return what each part of our loop costs in a scene, as `our_parts` does."""
    found = our_parts(selection, p)
    more = whole_parts(selection, result) if not found["rows"] else found
    return found if not more["rows"] else jsonable(more)


@with_overrides
def times(name, plan, result):
    """Return everything about a scene that a clock measures.

    These are its run times, its savings by omission, and the cost of each part.
    """
    selection = select(name, plan)
    _, p = selection.first
    timed = timing.times(name, plan, result)
    full = not (plan.quick or plan.most_steps)
    return {**timed, "left_out": jsonable(left_out(name, plan, result)),
            "our_parts": parts(selection, p, result) if full else {"rows": [], "note": "left to --full"},
            "exam": None if plan.most_steps else jsonable(exam_of(selection, p)),
            "engine_parts": engine_parts(selection, p) if full else [],
            "preparations": preparations(selection, p, timed["races"]) if full else [],
            "compilation": compilation(selection, p, timed["races"]) if full else None}
