"""Given.  The history of a run for every loop over steps: times and states, with the start.

Each function takes the arguments of its loop, makes one step at a time and keeps every state.  Lesson 1 has
`trajectory`, lesson 5 `rotation_trajectory` and lesson 9 `pile_trajectory`.  `solutions.support.events` finds events
along them.
"""

import numpy as np

from ..checks import whole_number
from ..simulator import advance_contact, advance_free, advance_rocking
from .collisions import advance_projectiles
from .friction import advance_particle
from .impulses import advance_balls, advance_discs, advance_spinning_balls
from .rotation import advance_rigid_body


def histories(advance, t, state, dt, steps, record):
    """Return (ts (steps + 1,), and a history (steps + 1, …) of each part of the state).

    One step is  advance(t, *state, dt, 1, record).
    """
    steps = whole_number("number of steps", steps, 0)
    states = [tuple(np.array(part, dtype=float) for part in state)]
    for n in range(steps):
        states.append(advance(t + n * dt, *states[-1], dt, 1, record))
    return t + dt * np.arange(steps + 1), *(np.stack(parts) for parts in zip(*states, strict=True))


def particle_trajectory(step, acceleration, surface, t, x, v, dt, steps, p):
    """Return (ts, xs, vs) of advance_particle: a particle that may touch a surface."""
    return histories(lambda *now: advance_particle(step, acceleration, surface, *now), t, (x, v), dt, steps, p)


def rigid_body_trajectory(step, load, t, x, q, v, omega, dt, steps, body):
    """Return (ts, xs, qs, vs, ωs) of advance_rigid_body."""
    return histories(lambda *now: advance_rigid_body(step, load, *now), t, (x, q, v, omega), dt, steps, body)


def projectile_trajectories(step, gap, impact_time, t, x, v, dt, steps, p):
    """Return (ts, xs (steps + 1, n, 3), vs) of advance_projectiles: n balls that fly straight and stop at contact."""
    return histories(lambda *now: advance_projectiles(step, gap, impact_time, *now), t, (x, v), dt, steps, p)


def ball_trajectories(step, acceleration, t, x, v, dt, steps, p):
    """Return (ts, xs (steps + 1, copies, d), vs) of advance_balls: copies of a BouncingBall."""
    return histories(lambda *now: advance_balls(step, acceleration, *now), t, (x, v), dt, steps, p)


def spinning_ball_trajectories(step, acceleration, t, x, v, omega, dt, steps, p):
    """Return (ts, xs (steps + 1, copies, 3), vs, ωs) of advance_spinning_balls: copies of a SpinningBall."""
    return histories(lambda *now: advance_spinning_balls(step, acceleration, *now), t, (x, v, omega), dt, steps, p)


def disc_trajectories(step, x, v, dt, steps, p):
    """Return (ts from 0 on, xs (steps + 1, copies, bodies, d), vs) of advance_discs."""
    return histories(lambda _, *now: advance_discs(step, *now), 0.0, (x, v), dt, steps, p)


def free_trajectories(step, load, t, x, q, v, omega, dt, steps, p):
    """Return (ts, xs (steps + 1, n, d), qs, vs, ωs) of advance_free: many bodies without contact."""
    return histories(lambda *now: advance_free(step, load, *now), t, (x, q, v, omega), dt, steps, p)


def rocking_trajectory(step, t, x, v, dt, steps, block):
    """Return (ts, θs (steps + 1, 1), rates) of advance_rocking: a block that changes its corner."""
    return histories(lambda *now: advance_rocking(step, *now), t, (x, v), dt, steps, block)


def contact_trajectory(step, load, bounds, narrow, t, state, dt, steps, p):
    """Return (ts, [state, …]) of advance_contact: all PileStates, the first included."""
    steps, states = whole_number("number of steps", steps, 0), [state]
    for n in range(steps):
        states.append(advance_contact(step, load, bounds, narrow, t + n * dt, states[-1], dt, 1, p))
    return t + dt * np.arange(steps + 1), states
