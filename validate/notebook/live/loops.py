"""Which of the learner's exercises a live scene calls: the whole loop of lesson 10, or what is written before it."""

import numpy as np

from solutions.given.compose import Part
from solutions.support.scenes import PileState

MOST_IMPACTS = 4             # rounds over all contacts in one step: a body in a corner meets two walls


def fall(load, bounds, narrow, t, state, dt, p):
    """Return the state after gravity alone has acted for dt: what lesson 10 asks for is given here."""
    falls = (p.inv_mass > 0.0)[:, None]
    return state._replace(v=state.v + dt * falls * p.gravity)


def find(load, bounds, narrow, t, state, dt, p):
    """Return the state with all contacts; no impulse is kept."""
    x, q, v, omega, _, _ = state
    _, _, turn = bounds(x, q, p.half)
    contacts = narrow(x, turn, p.half, p.planes, p.pairs, p.margin)
    return PileState(x, q, v, omega, contacts, np.zeros((contacts.a.size, 2)))


def impacts(impulses):
    """Return the part that lets bodies bounce by the learner's functions of lesson 7."""
    def bounce(load, bounds, narrow, t, state, dt, p):
        """Return the state after an impulse at each closed contact whose points approach, one after the other."""
        x, q, v, omega, contacts, J = state
        v, omega, J = v.copy(), omega.copy(), J.copy()
        for _ in range(MOST_IMPACTS):
            struck = False
            for k in np.flatnonzero(contacts.gap <= 0.0):
                struck = one_impact(impulses, k, x, v, omega, J, contacts, p) or struck
            if not struck:
                break
        return PileState(x, q, v, omega, contacts, J)
    return bounce


def one_impact(impulses, k, x, v, omega, J, contacts, p):
    """Change the velocities of both bodies at contact k, in place; return whether there was an impulse."""
    rows, n = (contacts.a[k], contacts.b[k]), contacts.n[k]
    a, b = (impulses.BodyState2D(v[i].copy(), float(omega[i]), p.inv_mass[i], p.inv_inertia[i]) for i in rows)
    r_a, r_b = (contacts.p[k] - x[i] for i in rows)
    u_n = float(n @ impulses.relative_velocity_2d(a, b, r_a, r_b))
    k_n = impulses.effective_inverse_mass_2d(a, b, r_a, r_b, n)
    j = impulses.impulse_size(u_n, k_n, p.e_of[rows[0]] * p.e_of[rows[1]])
    for i, body, r, sign in ((rows[0], a, r_a, 1.0), (rows[1], b, r_b, -1.0)):
        after = impulses.apply_impulse_2d(body, r, sign * j * n)
        v[i], omega[i] = after.v, after.omega
    J[k] = J[k] + j * n
    return j > 0.0


def of_lesson_7(loop, simulator, impulses):
    """Return the loop of bodies that bounce without friction."""
    return loop._replace(parts=(Part(fall, "gravity"), Part(find, "shapes"), Part(impacts(impulses), "impacts"),
                                Part(simulator.move_and_turn, "what moves and turns")))


def of_lesson_9(loop, simulator, contact):
    """Return the loop whose sweeps and memory are the learner's, and whose forces are given."""
    parts = (Part(fall, "gravity") if part.step is simulator.accelerate else part for part in loop.parts)
    return loop._replace(parts=tuple(parts))


def of_lesson_10(loop, simulator, _):
    """Return the loop as composed."""
    return loop


LOOPS = {"impulses": of_lesson_7, "contact": of_lesson_9, "simulator": of_lesson_10}
