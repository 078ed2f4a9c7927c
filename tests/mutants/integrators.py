"""Lesson 1: the mistakes that students make with a step, and the other ways of writing it."""

import numpy as np

from solutions import integrators as worked
from solutions.checks import Diverged, check_positive
from . import collection, variants

wrong, right, edit, MUTANTS = collection(worked)


# 1.1 ------------------------------------------------------------------------------------------------------------
@wrong("1.1", "moves with the new velocity")
def euler_step(acceleration, t, x, v, dt, p):
    v = v + dt * acceleration(t, x, v, p)
    return x + dt * v, v


@wrong("1.1", "forgets dt in the velocity")
def euler_step(acceleration, t, x, v, dt, p):
    return x + dt * v, v + acceleration(t, x, v, p)


@wrong("1.1", "evaluates at the end of the step")
def euler_step(acceleration, t, x, v, dt, p):
    return x + dt * v, v + dt * acceleration(t + dt, x + dt * v, v, p)


@wrong("1.1", "changes its input")
def euler_step(acceleration, t, x, v, dt, p):
    a = acceleration(t, x, v, p)
    x += dt * v
    v += dt * a
    return x, v


@wrong("1.1", "reads the clock at the end")
def euler_step(acceleration, t, x, v, dt, p):
    return x + dt * v, v + dt * acceleration(t + dt, x, v, p)


@right("1.1", "through one state vector")
def euler_step(acceleration, t, x, v, dt, p):
    y, slope = np.stack([x, v]), np.stack([v, acceleration(t, x, v, p)])
    x, v = y + dt * slope
    return x, v


# 1.2 ------------------------------------------------------------------------------------------------------------
@wrong("1.2", "half a step only")
def midpoint_step(acceleration, t, x, v, dt, p):
    x, v = worked.euler_step(acceleration, t, x, v, 0.5 * dt, p)
    return worked.euler_step(acceleration, t + 0.5 * dt, x, v, 0.5 * dt, p)


@wrong("1.2", "position still with the old velocity")
def midpoint_step(acceleration, t, x, v, dt, p):
    x_mid, v_mid = worked.euler_step(acceleration, t, x, v, 0.5 * dt, p)
    return x + dt * v, v + dt * acceleration(t + 0.5 * dt, x_mid, v_mid, p)


@wrong("1.2", "forgets to move the clock")
def midpoint_step(acceleration, t, x, v, dt, p):
    x_mid, v_mid = worked.euler_step(acceleration, t, x, v, 0.5 * dt, p)
    return x + dt * v_mid, v + dt * acceleration(t, x_mid, v_mid, p)


@right("1.2", "as a difference of two Euler steps")
def midpoint_step(acceleration, t, x, v, dt, p):
    x_mid, v_mid = worked.euler_step(acceleration, t, x, v, 0.5 * dt, p)
    x_end, v_end = worked.euler_step(acceleration, t + 0.5 * dt, x_mid, v_mid, dt, p)
    return x + (x_end - x_mid), v + (v_end - v_mid)


# 1.3 ------------------------------------------------------------------------------------------------------------
@variants
def runge_kutta(nodes=(0, 0.5, 0.5, 1), weights=(1 / 6, 1 / 3, 1 / 3, 1 / 6)):
    """A method as a table: each slope is reached along the slope before it, nodes · dt away."""
    def step(acceleration, t, x, v, dt, p):
        slope, total_x, total_v = (v, acceleration(t, x, v, p)), 0.0, 0.0
        for c, w in zip(nodes, weights):
            v_c = v + c * dt * slope[1]
            slope = v_c, acceleration(t + c * dt, x + c * dt * slope[0], v_c, p)
            total_x, total_v = total_x + w * slope[0], total_v + w * slope[1]
        return x + dt * total_x, v + dt * total_v
    return step


wrong("1.3", "equal weights")(runge_kutta(weights=(1 / 4, 1 / 4, 1 / 4, 1 / 4)))
wrong("1.3", "weights of the middle and the ends swapped")(runge_kutta(weights=(1 / 3, 1 / 6, 1 / 6, 1 / 3)))
wrong("1.3", "last slope in the middle")(runge_kutta(nodes=(0, 0.5, 0.5, 0.5)))
right("1.3", "from its table")(runge_kutta())


@wrong("1.3", "position by Euler, velocity by Runge–Kutta")
def rk4_step(acceleration, t, x, v, dt, p):
    return x + dt * v, worked.rk4_step(acceleration, t, x, v, dt, p)[1]


@wrong("1.3", "the clock stands still")
def rk4_step(acceleration, t, x, v, dt, p):
    return worked.rk4_step(lambda _, x, v, p: acceleration(t, x, v, p), t, x, v, dt, p)


# 1.4 ------------------------------------------------------------------------------------------------------------
@wrong("1.4", "adds the velocities without halving")
def average_velocity_step(acceleration, t, x, v, dt, p):
    v_new = v + dt * acceleration(t, x, v, p)
    return x + dt * (v + v_new), v_new


@wrong("1.4", "new velocity twice")
def average_velocity_step(acceleration, t, x, v, dt, p):
    return worked.symplectic_euler_step(acceleration, t, x, v, dt, p)


@wrong("1.4", "halves the velocity update too")
def average_velocity_step(acceleration, t, x, v, dt, p):
    v_new = v + 0.5 * dt * acceleration(t, x, v, p)
    return x + 0.5 * dt * (v + v_new), v_new


@right("1.4", "as a parabola")
def average_velocity_step(acceleration, t, x, v, dt, p):
    a = acceleration(t, x, v, p)
    return x + dt * v + 0.5 * dt**2 * a, v + dt * a


# 1.5 ------------------------------------------------------------------------------------------------------------
@wrong("1.5", "plain Euler")
def symplectic_euler_step(acceleration, t, x, v, dt, p):
    return worked.euler_step(acceleration, t, x, v, dt, p)


@wrong("1.5", "position first")
def symplectic_euler_step(acceleration, t, x, v, dt, p):
    x = x + dt * v
    return x, v + dt * acceleration(t, x, v, p)


@wrong("1.5", "a flipped sign")
def symplectic_euler_step(acceleration, t, x, v, dt, p):
    v = v - dt * acceleration(t, x, v, p)
    return x + dt * v, v


@right("1.5", "written out")
def symplectic_euler_step(acceleration, t, x, v, dt, p):
    a = acceleration(t, x, v, p)
    return x + dt * v + dt * dt * a, v + dt * a


# 1.6 ------------------------------------------------------------------------------------------------------------
@wrong("1.6", "old acceleration for the whole velocity")
def verlet_step(acceleration, t, x, v, dt, p):
    a = acceleration(t, x, v, p)
    return x + dt * v + 0.5 * dt**2 * a, v + dt * a


@wrong("1.6", "new acceleration with the old velocity")
def verlet_step(acceleration, t, x, v, dt, p):
    a = acceleration(t, x, v, p)
    x_new = x + dt * v + 0.5 * dt**2 * a
    return x_new, v + 0.5 * dt * (a + acceleration(t + dt, x_new, v, p))


@wrong("1.6", "forgets the half in the position")
def verlet_step(acceleration, t, x, v, dt, p):
    a = acceleration(t, x, v, p)
    x_new = x + dt * v + dt**2 * a
    return x_new, v + 0.5 * dt * (a + acceleration(t + dt, x_new, v + dt * a, p))


@wrong("1.6", "new acceleration at the old time")
def verlet_step(acceleration, t, x, v, dt, p):
    a = acceleration(t, x, v, p)
    x_new = x + dt * v + 0.5 * dt**2 * a
    return x_new, v + 0.5 * dt * (a + acceleration(t, x_new, v + dt * a, p))


@right("1.6", "kick, drift, kick")
def verlet_step(acceleration, t, x, v, dt, p):
    half = v + 0.5 * dt * acceleration(t, x, v, p)
    x_new = x + dt * half
    return x_new, half + 0.5 * dt * acceleration(t + dt, x_new, 2.0 * half - v, p)


# 1.7 ------------------------------------------------------------------------------------------------------------
@variants
def implicit_euler(time=1.0, place=1.0, limit=30, corrections=30):
    """Newton's method with the acceleration at a time and place that may be wrong."""
    def implicit_euler_step(acceleration, t, x, v, dt, p):
        w = v.copy()
        for k in range(limit):
            r = w - v - dt * acceleration(t + time * dt, x + place * dt * w, w, p)
            delta = np.linalg.solve(worked.newton_matrix(acceleration, t + dt, x, w, dt, p), r.ravel()).reshape(v.shape)
            w = w - delta
            if np.max(np.abs(delta)) <= 1e-12 * max(1.0, np.max(np.abs(w))) or k + 1 == corrections:
                return x + dt * w, w
        raise Diverged("Newton's method did not converge at dt [s]", dt, "take a smaller step")
    return implicit_euler_step


wrong("1.7", "acceleration at the old time")(implicit_euler(time=0.0))
wrong("1.7", "acceleration at the old place")(implicit_euler(place=0.0))
wrong("1.7", "never gives up: returns whatever it has")(implicit_euler(corrections=30))


@wrong("1.7", "one Euler step instead of an equation")
def implicit_euler_step(acceleration, t, x, v, dt, p):
    w = v + dt * acceleration(t, x, v, p)
    return x + dt * w, v + dt * acceleration(t + dt, x + dt * w, w, p)


@right("1.7", "by SciPy's root finder")
def implicit_euler_step(acceleration, t, x, v, dt, p):
    from scipy.optimize import root
    found = root(lambda w: w - v.ravel() - dt * acceleration(t + dt, x + dt * w.reshape(v.shape), w.reshape(v.shape), p).ravel(),
                 v.ravel(), tol=1e-13)
    if np.max(np.abs(found.fun)) > 1e-10:
        raise Diverged("Newton's method did not converge at dt [s]", dt, "take a smaller step")
    w = found.x.reshape(v.shape)
    return x + dt * w, w


@wrong("1.7", "one linearised step, no loop")
def implicit_euler_step(acceleration, t, x, v, dt, p):
    r = -dt * acceleration(t + dt, x + dt * v, v, p)
    w = v - np.linalg.solve(worked.newton_matrix(acceleration, t + dt, x, v, dt, p), r.ravel()).reshape(v.shape)
    if np.max(np.abs(w - v - dt * acceleration(t + dt, x + dt * w, w, p))) > 1e-3:
        raise Diverged("Newton's method did not converge at dt [s]", dt, "take a smaller step")
    return x + dt * w, w


@wrong("1.7", "stops at a thousandth")
def implicit_euler_step(acceleration, t, x, v, dt, p):
    w = v.copy()
    for _ in range(30):
        r = w - v - dt * acceleration(t + dt, x + dt * w, w, p)
        delta = np.linalg.solve(worked.newton_matrix(acceleration, t + dt, x, w, dt, p), r.ravel()).reshape(v.shape)
        if np.max(np.abs(delta)) <= 1e-3:
            return x + dt * w, w
        w = w - delta
    raise Diverged("Newton's method did not converge at dt [s]", dt, "take a smaller step")


# 1.8 ------------------------------------------------------------------------------------------------------------
@wrong("1.8", "a whole implicit Euler step")
def implicit_midpoint_step(acceleration, t, x, v, dt, p):
    return worked.implicit_euler_step(acceleration, t, x, v, dt, p)


@wrong("1.8", "stops in the middle")
def implicit_midpoint_step(acceleration, t, x, v, dt, p):
    return worked.implicit_euler_step(acceleration, t, x, v, 0.5 * dt, p)


@wrong("1.8", "two half steps of implicit Euler")
def implicit_midpoint_step(acceleration, t, x, v, dt, p):
    x, v = worked.implicit_euler_step(acceleration, t, x, v, 0.5 * dt, p)
    return worked.implicit_euler_step(acceleration, t + 0.5 * dt, x, v, 0.5 * dt, p)


@right("1.8", "the second half explicitly")
def implicit_midpoint_step(acceleration, t, x, v, dt, p):
    x_mid, v_mid = worked.implicit_euler_step(acceleration, t, x, v, 0.5 * dt, p)
    return x + dt * v_mid, v + dt * acceleration(t + 0.5 * dt, x_mid, v_mid, p)


# 1.9 ------------------------------------------------------------------------------------------------------------
@variants
def columns(acceleration=worked.oscillator_acceleration):
    def of(step, omega, zeta, dt):
        p, one, zero = worked.Oscillator(omega, zeta), np.ones(1), np.zeros(1)
        return np.hstack([np.array(step(acceleration, 0.0, *state, dt, p)) for state in ((one, zero), (zero, one))])
    return of


right("1.9", "columns stacked")(columns())
wrong("1.9", "forgets the damping")(columns(lambda t, x, v, p: -p.omega**2 * x))


@wrong("1.9", "rows for columns")
def amplification_matrix(step, omega, zeta, dt):
    return worked.amplification_matrix(step, omega, zeta, dt).T


@wrong("1.9", "the inverse")
def amplification_matrix(step, omega, zeta, dt):
    return np.linalg.inv(worked.amplification_matrix(step, omega, zeta, dt))


# 1.10 -----------------------------------------------------------------------------------------------------------
@wrong("1.10", "slope without logarithms")
def observed_order(dts, errors):
    return np.polyfit(dts, errors, 1)[0]


@wrong("1.10", "only the two ends")
def observed_order(dts, errors):
    return np.log(errors[-1] / errors[0]) / np.log(dts[-1] / dts[0])


@wrong("1.10", "a line through the origin")
def observed_order(dts, errors):
    return np.sum(np.log(dts) * np.log(errors)) / np.sum(np.log(dts) ** 2)


@right("1.10", "polyfit")
def observed_order(dts, errors):
    for dt, error in zip(dts, errors):
        check_positive("step dt [s]", dt)
        check_positive("error [-]", error)
    return np.polyfit(np.log(dts), np.log(errors), 1)[0]


edit("1.10", "leaves runs without error to the logarithm", 'check_positive("error [-]", errors[n])', "pass")
