"""Given with lesson 3.  Blocks and particles over many steps."""

import numpy as np

from ..checks import (
    BadInput,
    Diverged,
    check_array,
    check_end,
    check_field,
    check_friction,
    check_law,
    check_normal,
    check_restitution,
    check_shape,
    checked_run,
    finite_array,
    finite_number,
    number,
    positive_number,
)
from ..friction import *  # noqa: F403    one import has a lesson and its given functions
from ..friction import (
    Block,
    advance_to_event,
    normal_force,
    pyramid_impulse,
    sliding_step,
    slip_direction,
    tangential,
)
from ..support.records import check_record

MAX_EVENTS = 8               # stops and starts per step [-]; a force that reverses more often needs a shorter step


def make_block(n, mu_s, mu_k, gravity, drive, omega):
    """Given.  Make a Block from lists, tuples or arrays; n may have any length but zero.

    Raises BadInput for a negative μ, for μ_k above μ_s (which would allow neither rest nor sliding), for values that
    are not finite.
    """
    mu_s, mu_k = number("static friction μ_s [-]", mu_s), number("kinetic friction μ_k [-]", mu_k)
    check_friction(mu_s)
    check_friction(mu_k)
    if mu_k > mu_s:
        raise BadInput("kinetic friction μ_k [-]", mu_k, f"give at most the static μ_s = {mu_s}")
    n = finite_array("normal n [-]", n)
    gravity = finite_array("gravity [m/s²]", gravity)
    drive = finite_array("drive over mass [m/s²]", drive)
    check_array("normal n", n, 1)
    length = positive_number("length of the normal n [-]", np.linalg.norm(n))
    for thing, y in (("gravity", gravity), ("drive over mass", drive)):
        check_shape(thing, y, n.shape[:1])
    block = Block(n / length, mu_s, mu_k, gravity, drive, finite_number("angular frequency ω [rad/s]", omega))
    check_record(block, n)
    return block


def average_sliding_step(acceleration, t, x, v, dt, p):
    """Given.  Advance a block by one step: sliding_step, but the position advances with the mean of both velocities.

    Exact while constant forces act on a block that slides.  In the step in which it stops, the position errs by at most
    ⅛ a dt², where a is its deceleration.  If the forces vary, the velocity is first order, and so is the position.
    """
    _, v_new = sliding_step(acceleration, t, x, v, dt, p)
    return x + 0.5 * dt * (v + v_new), v_new


def pyramid_step(acceleration, t, x, v, dt, p):
    """Given.  Advance a block on a horizontal floor, n = (0, 0, 1): sliding_step with the pyramid along x and y."""
    pull = dt * acceleration(t, x, v, p)
    t_1, t_2 = np.array([1.0, 0.0, 0.0]), np.array([0.0, 1.0, 0.0])
    v_free = v + tangential(pull, p.n)
    v_new = v_free + pyramid_impulse(v_free, 1.0, normal_force(pull, p.n), p.mu_k, t_1, t_2)
    return x + dt * v_new, v_new


def event_step(acceleration, t, x, v, dt, p):
    """Given.  Advance a block by one step, through all its stops and starts; second order, exact under constant forces.

    Raises Diverged when MAX_EVENTS stops and starts do not reach the end of the step.
    """
    left = dt
    for _ in range(MAX_EVENTS):
        tau, x, v = advance_to_event(acceleration, t, x, v, left, p)
        t += tau
        left -= tau
        if left <= 0.0:
            return x, v
    raise Diverged("stops and starts without end in a step of dt [s]", dt, "take a smaller step")


def slip_times(acceleration, t, x, v, dt, steps, p):
    """Given.  Return (k, 2) [s]: beginning and end of each slip; a slip that is not over ends with the run."""
    check_record(p, x)
    t, x, v, dt, steps = checked_run(t, x, v, dt, steps)
    check_normal(p.n)
    check_shape("the position x", x, p.n.shape)
    check_law("acceleration [m/s²]", acceleration(t, x, v, p), x.shape)
    finite_array("acceleration at the start [m/s²]", acceleration(t, x, v, p))
    times = np.zeros((MAX_EVENTS * steps, 2))
    k, slipping = 0, False
    for step in range(steps):
        here, left = t + step * dt, dt
        for _ in range(MAX_EVENTS):
            slides = bool(np.any(slip_direction(acceleration, here, x, v, p)))
            if slides and not slipping:
                times[k, 0] = here
                k += 1
            tau, x, v = advance_to_event(acceleration, here, x, v, left, p)
            here += tau
            left -= tau
            slipping = slides and bool(np.any(v))
            if slides:
                times[k - 1, 1] = here
            if left <= 0.0:
                break
    return times[:k]


def advance_particle(step, acceleration, surface, t, x, v, dt, steps, p):
    """Given.  Return the state (x, v) of a particle after `steps` steps of one method.

    Raises BadInput for a mass or a step that is not positive, a negative μ, an e outside 0 … 1, a state that is not
    finite, and a surface whose normal at x is no unit vector; Diverged when the final state is not finite.
    """
    check_record(p, x)
    t, x, v, dt, steps = checked_run(t, x, v, dt, steps)
    positive_number("mass m [kg]", p.m)
    check_friction(number("friction μ [-]", p.mu))
    check_restitution(finite_number("restitution e [-]", p.e))
    check_field("gravity [m/s²]", p.gravity, x.shape)
    phi, n = surface(x, p)
    finite_number("gap at the start [m]", phi)
    check_field("normal at the start [-]", n, x.shape)
    if np.any(n):                                        # in the middle of a bowl there is no normal
        check_normal(n)
    check_law("acceleration [m/s²]", acceleration(t, x, v, p), x.shape)
    for n in range(steps):
        x, v = step(acceleration, surface, t + n * dt, x, v, dt, p)
    check_end(x, v, dt)
    return x, v
