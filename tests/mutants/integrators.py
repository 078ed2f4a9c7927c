"""Lesson 1: typical mistakes in a step, and alternative right answers."""

import numpy as np

from solutions import integrators as worked
from solutions.checks import Diverged, check_positive

from . import collection, variants

wrong, right, edit, MUTANTS = collection(worked)


# 1.1 ------------------------------------------------------------------------------------------------------------
@right("1.1", "through one state vector")
def euler_step(acceleration, t, x, v, dt, p):
    y, slope = np.stack([x, v]), np.stack([v, acceleration(t, x, v, p)])
    x, v = y + dt * slope
    return x, v


edit("1.1", "moves the position with the new velocity", "x + dt * v,", "x + dt * (v + dt * acceleration(t, x, v, p)),")
edit("1.1", "forgets dt in the velocity", "v + dt * acceleration", "v + acceleration")
edit("1.1", "takes the acceleration at the new position",
     "acceleration(t, x, v, p)", "acceleration(t, x + dt * v, v, p)")
edit("1.1", "changes its input", "v + dt * acceleration(t, x, v, p)", "np.add(v, dt * acceleration(t, x, v, p), out=v)")
edit("1.1", "takes the acceleration at time t + dt", "acceleration(t, x", "acceleration(t + dt, x")
edit("1.1", "moves the position backwards", "x + dt * v,", "x - dt * v,")
edit("1.1", "subtracts the acceleration", "v + dt * acceleration", "v - dt * acceleration")
edit("1.1", "forgets dt in the position", "x + dt * v,", "x + v,")
edit("1.1", "exchanges x and v in the arguments of the acceleration",
     "acceleration(t, x, v, p)", "acceleration(t, v, x, p)")
edit("1.1", "returns the velocity first",
     "x + dt * v, v + dt * acceleration(t, x, v, p)", "v + dt * acceleration(t, x, v, p), x + dt * v")
edit("1.1", "moves the position with the mean of the old and the new velocity",
     "x + dt * v,", "x + dt * (v + 0.5 * dt * acceleration(t, x, v, p)),")
edit("1.1", "takes the acceleration at the new position and at time t + dt",
     "acceleration(t, x, v, p)", "acceleration(t + dt, x + dt * v, v, p)")
edit("1.1", "returns the state unchanged where nothing accelerates it",
     "return", "if not acceleration(t, x, v, p).any(): return x, v\n    return")


# 1.2 ------------------------------------------------------------------------------------------------------------
@right("1.2", "as a difference of two Euler steps")
def midpoint_step(acceleration, t, x, v, dt, p):
    x_mid, v_mid = worked.euler_step(acceleration, t, x, v, 0.5 * dt, p)
    x_end, v_end = worked.euler_step(acceleration, t + 0.5 * dt, x_mid, v_mid, dt, p)
    return x + (x_end - x_mid), v + (v_end - v_mid)


edit("1.2", "advances by dt/2 only", "x + dt * v_mid, v + dt", "x + 0.5 * dt * v_mid, v + 0.5 * dt")
V_AT_OLD = edit("1.2", "moves the position with the velocity at the start of the step", "x + dt * v_mid", "x + dt * v")
MIDDLE_AT_OLD_TIME = edit("1.2", "evaluates the slope at the middle at time t, not at t + dt/2",
                          "acceleration(t + 0.5 * dt", "acceleration(t")
edit("1.2", "takes the acceleration at the old position", "0.5 * dt, x_mid, v_mid", "0.5 * dt, x, v_mid")
edit("1.2", "takes the acceleration at the old velocity", "0.5 * dt, x_mid, v_mid", "0.5 * dt, x_mid, v")
edit("1.2", "starts the whole step at the midpoint, not at its beginning",
     "return x + dt * v_mid, v + dt", "return x_mid + dt * v_mid, v_mid + dt")
edit("1.2", "takes the velocity at the midpoint after a whole step, not after half of it",
     "v_mid = v + 0.5 * dt", "v_mid = v + dt")
edit("1.2", "takes the position at the midpoint after a whole step, not after half of it",
     "x_mid = x + 0.5 * dt", "x_mid = x + dt")
edit("1.2", "takes the acceleration at time t + dt", "acceleration(t + 0.5 * dt", "acceleration(t + dt")
edit("1.2", "takes an Euler step with the acceleration at its beginning",
     "acceleration(t + 0.5 * dt, x_mid, v_mid, p)", "acceleration(t, x, v, p)")
edit("1.2", "takes the mean of the slopes at both ends, as Heun's method does",
     "v + dt * acceleration(t + 0.5 * dt, x_mid, v_mid, p)", "v + 0.5 * dt * "
     "(acceleration(t, x, v, p) + acceleration(t + dt, x + dt * v, 2.0 * v_mid - v, p))")
edit("1.2", "takes steps of at most 1 s", "x_mid = x", "dt = min(dt, 1.0); x_mid = x")


# 1.3 ------------------------------------------------------------------------------------------------------------
@variants
def runge_kutta(nodes=(0, 0.5, 0.5, 1), weights=(1 / 6, 1 / 3, 1 / 3, 1 / 6), chained=False, own=False):
    """A Runge–Kutta method from its table: each stage starts nodes · dt along the slope of the one before."""
    def step(acceleration, t, x, v, dt, p):
        slope, total_x, total_v = (v, acceleration(t, x, v, p)), 0.0, 0.0
        x_c, v_c = x, v
        for c, w in zip(nodes, weights, strict=True):
            x_0, v_0 = (x_c, v_c) if chained else (x, v)
            v_c = v_0 + c * dt * slope[1]
            x_c = x_0 + c * dt * (v_c if own else slope[0])
            slope = v_c, acceleration(t + c * dt, x_c, v_c, p)
            total_x, total_v = total_x + w * slope[0], total_v + w * slope[1]
        return x + dt * total_x, v + dt * total_v
    return step


wrong("1.3", "gives the four slopes equal weights")(runge_kutta(weights=(1 / 4, 1 / 4, 1 / 4, 1 / 4)))
wrong("1.3", "exchanges the weights of the middle and of the ends")(runge_kutta(weights=(1 / 3, 1 / 6, 1 / 6, 1 / 3)))
wrong("1.3", "takes the fourth slope at the middle of the step, not at its end")(runge_kutta(nodes=(0, 0.5, 0.5, 0.5)))
wrong("1.3", "starts each stage at the stage before it, not at xₙ and vₙ")(runge_kutta(chained=True))
wrong("1.3", "moves each stage with its own velocity, not with that of the stage before it")(runge_kutta(own=True))
right("1.3", "from its table")(runge_kutta())
edit("1.3", "moves the position by an Euler step", "x + dt / 6.0 * (v + 2.0 * v2 + 2.0 * v3 + v4)", "x + dt * v")
edit("1.3", "does not advance t to the midpoint", "acceleration(t + 0.5 * dt, x + 0.5 * dt * v2",
     "acceleration(t, x + 0.5 * dt * v2")
edit("1.3", "does not advance t to the end", "acceleration(t + dt", "acceleration(t")
edit("1.3", "computes the third velocity from the first acceleration",
     "v3 = v + 0.5 * dt * a2", "v3 = v + 0.5 * dt * a1")
edit("1.3", "computes the fourth velocity from the second acceleration", "v4 = v + dt * a3", "v4 = v + dt * a2")
edit("1.3", "takes half a step to the fourth velocity, where a whole one belongs",
     "v4 = v + dt * a3", "v4 = v + 0.5 * dt * a3")
edit("1.3", "takes half a step to the fourth position, where a whole one belongs",
     "x + dt * v3, v4", "x + 0.5 * dt * v3, v4")
THIRD_SLOPE_FROM_FIRST = edit("1.3", "takes the third acceleration at the position that the first velocity reaches",
                              "x + 0.5 * dt * v2, v3", "x + 0.5 * dt * v, v3")
edit("1.3", "takes the fourth acceleration at the position that the second velocity reaches",
     "x + dt * v3, v4", "x + dt * v2, v4")
edit("1.3", "takes the second acceleration at the old position", "x + 0.5 * dt * v, v2", "x, v2")
edit("1.3", "takes the second acceleration at the position that the second velocity reaches",
     "x + 0.5 * dt * v, v2", "x + 0.5 * dt * v2, v2")
edit("1.3", "takes the third acceleration at the position that the third velocity reaches",
     "x + 0.5 * dt * v2, v3", "x + 0.5 * dt * v3, v3")
edit("1.3", "takes the fourth acceleration at the position that the fourth velocity reaches",
     "x + dt * v3, v4", "x + dt * v4, v4")
edit("1.3", "takes a whole step to the second velocity, where half of it belongs", "v2 = v + 0.5 * dt", "v2 = v + dt")
edit("1.3", "takes a whole step to the third velocity, where half of it belongs", "v3 = v + 0.5 * dt", "v3 = v + dt")
edit("1.3", "starts the third velocity from the second one, not from vₙ", "v3 = v + 0.5", "v3 = v2 + 0.5")
edit("1.3", "starts the fourth velocity from the third one, not from vₙ", "v4 = v + dt", "v4 = v3 + dt")
edit("1.3", "gives the third acceleration the weight of one at an end", "2.0 * a2 + 2.0 * a3", "2.0 * a2 + a3")
edit("1.3", "gives the third velocity the weight of one at an end", "2.0 * v2 + 2.0 * v3", "2.0 * v2 + v3")
edit("1.3", "takes the second acceleration at the old velocity", "x + 0.5 * dt * v, v2, p", "x + 0.5 * dt * v, v, p")
edit("1.3", "takes the fourth acceleration at the third velocity", "dt * v3, v4, p", "dt * v3, v3, p")
edit("1.3", "moves the position with the mean of the old and the new velocity", "v + 2.0 * v2 + 2.0 * v3 + v4",
     "3.0 * v + 3.0 * (v + dt / 6.0 * (a1 + 2.0 * a2 + 2.0 * a3 + a4))")
edit("1.3", "takes all four accelerations at time t", "a1 = acceleration(t, x, v, p)",
     "whenever, acceleration = acceleration, lambda _, *rest: whenever(t, *rest); a1 = acceleration(t, x, v, p)")
edit("1.3", "takes steps of at least 1 ms", "a1 = acceleration", "dt = max(dt, 1e-3); a1 = acceleration")


# 1.4 ------------------------------------------------------------------------------------------------------------
@right("1.4", "as a parabola")
def average_velocity_step(acceleration, t, x, v, dt, p):
    a = acceleration(t, x, v, p)
    return x + dt * v + 0.5 * dt**2 * a, v + dt * a


edit("1.4", "adds the velocities without halving", "0.5 * dt", "dt")
edit("1.4", "moves with the new velocity, not with the mean of old and new", "(v + v_new)", "(v_new + v_new)")
edit("1.4", "halves the change of the velocity, too", "v + dt * acc", "v + 0.5 * dt * acc")
edit("1.4", "moves with the old velocity, not with the mean of old and new", "(v + v_new)", "(v + v)")
edit("1.4", "takes the difference of the velocities in place of their mean", "(v + v_new)", "(v_new - v)")
edit("1.4", "subtracts the acceleration", "v + dt * acc", "v - dt * acc")
edit("1.4", "takes the acceleration at time t + dt", "acceleration(t, x", "acceleration(t + dt, x")
edit("1.4", "returns the mean velocity, not the new one", "(v + v_new), v_new", "(v + v_new), 0.5 * (v + v_new)")
edit("1.4", "takes the acceleration at the position that the old velocity reaches",
     "acceleration(t, x, v, p)", "acceleration(t, x + dt * v, v, p)")
edit("1.4", "does not move what nothing accelerates", "(v + v_new)", "(v + v_new) * np.any(v != v_new)")


# 1.5 ------------------------------------------------------------------------------------------------------------
@right("1.5", "written out")
def symplectic_euler_step(acceleration, t, x, v, dt, p):
    a = acceleration(t, x, v, p)
    return x + dt * v + dt * dt * a, v + dt * a


edit("1.5", "takes an explicit Euler step", "v = v + dt * acceleration(t, x, v, p)",
     "v, x = v + dt * acceleration(t, x, v, p), x - dt * dt * acceleration(t, x, v, p)")
edit("1.5", "takes the acceleration at the position that the old velocity reaches",
     "acceleration(t, x, v, p)", "acceleration(t, x + dt * v, v, p)")
edit("1.5", "moves the position first, with the old velocity, and takes the acceleration there",
     "v = v + dt * acceleration(t, x, v, p)",
     "x = x + dt * v; v = v + dt * acceleration(t, x, v, p); return x, v")
edit("1.5", "subtracts the acceleration", "v + dt", "v - dt")
edit("1.5", "moves the position backwards", "return x + dt", "return x - dt")
edit("1.5", "takes the acceleration at time t + dt", "acceleration(t, x", "acceleration(t + dt, x")
edit("1.5", "returns the velocity first", "return x + dt * v, v", "return v, x + dt * v")
edit("1.5", "moves with the mean of the old and the new velocity",
     "return x + dt * v, v", "return x + dt * v - 0.5 * dt * dt * acceleration(t, x, v, p), v")
edit("1.5", "limits the velocity to 1000 m/s", "return", "v = np.clip(v, -1e3, 1e3); return")


# 1.6 ------------------------------------------------------------------------------------------------------------
@right("1.6", "kick, drift, kick")
def verlet_step(acceleration, t, x, v, dt, p):
    half = v + 0.5 * dt * acceleration(t, x, v, p)
    x_new = x + dt * half
    return x_new, half + 0.5 * dt * acceleration(t + dt, x_new, 2.0 * half - v, p)


edit("1.6", "advances the velocity with the old acceleration only", "(a + a_new)", "(a + a)")
LAST_AT_OLD_VELOCITY = edit("1.6", "takes the new acceleration at the old velocity", "v + dt * a, p)", "v, p)")
edit("1.6", "forgets the half in the position", "0.5 * dt * dt * a", "dt * dt * a")
LAST_AT_OLD_TIME = edit("1.6", "takes the new acceleration at the old time", "acceleration(t + dt", "acceleration(t")
edit("1.6", "forgets the half in the velocity", "v + 0.5 * dt * (a + a_new)", "v + dt * (a + a_new)")
edit("1.6", "takes the new acceleration at the old position", "acceleration(t + dt, x_new", "acceleration(t + dt, x")
edit("1.6", "omits the acceleration in the position", "x + dt * v + 0.5 * dt * dt * a", "x + dt * v")
edit("1.6", "uses dt in place of dt² in the position", "0.5 * dt * dt * a", "0.5 * dt * a")
edit("1.6", "advances the velocity with the new acceleration only", "(a + a_new)", "(a_new + a_new)")
VELOCITY_OF_HALF_A_STEP = edit("1.6", "predicts the velocity over half a step", "v + dt * a, p", "v + 0.5 * dt * a, p")
edit("1.6", "takes the new acceleration in the middle of the step", "acceleration(t + dt", "acceleration(t + 0.5 * dt")
edit("1.6", "leaves out the new acceleration where the old one is zero", "(a + a_new)", "(a + a_new * a.any())")


# 1.7 ------------------------------------------------------------------------------------------------------------
@variants
def implicit_euler(time=1.0, place=1.0, enough=lambda k, delta, w, rest: delta <= 1e-12 * np.max(np.abs(w)) + rest,
                   silent=False):
    """Newton's method with an acceleration, a stopping test or an end that may be wrong."""
    def implicit_euler_step(acceleration, t, x, v, dt, p):
        w = v.copy()
        for k in range(worked.NEWTON_LIMIT):
            r = w - v - dt * acceleration(t + time * dt, x + place * dt * w, w, p)
            delta = np.linalg.solve(worked.newton_matrix(acceleration, t + dt, x, w, dt, p), r.ravel()).reshape(v.shape)
            w = w - delta
            if enough(k, np.max(np.abs(delta)), w, worked.velocity_round_off(x, v, dt)):
                return x + dt * w, w
        if silent:
            return x + dt * w, w
        raise Diverged("Newton's method did not converge at dt [s]", dt, "take a smaller step")
    return implicit_euler_step


right("1.7", "with a stopping test")(implicit_euler())
wrong("1.7", "takes the acceleration at the old time")(implicit_euler(time=0.0))
wrong("1.7", "takes the acceleration at the old position")(implicit_euler(place=0.0))
wrong("1.7", "never raises: returns the last iterate")(implicit_euler(silent=True))
wrong("1.7", "takes one Newton iteration only")(implicit_euler(enough=lambda k, delta, w, rest: True))
wrong("1.7", "stops iterating while the correction is still large")(
    implicit_euler(enough=lambda k, delta, w, rest: delta <= 0.1 * np.max(np.abs(w))))
wrong("1.7", "compares the correction with 1e-12 m/s, however fast the body is")(
    implicit_euler(enough=lambda k, delta, w, rest: delta <= 1e-12 + rest))
wrong("1.7", "compares the correction with 1 m/s or more, however slow the body is")(
    implicit_euler(enough=lambda k, delta, w, rest: delta <= 1e-12 * max(1.0, np.max(np.abs(w))) + rest))
edit("1.7", "takes a symplectic Euler step and solves no equation", "w = v.copy()",
     "w = v + dt * acceleration(t, x, v, p); return x + dt * w, w")
edit("1.7", "evaluates the matrix at x + dt w, where newton_matrix adds dt w once more",
     "newton_matrix(acceleration, t + dt, x, w", "newton_matrix(acceleration, t + dt, x + dt * w, w")
edit("1.7", "evaluates the matrix at x + dt v", "newton_matrix(acceleration, t + dt, x, w",
     "newton_matrix(acceleration, t + dt, x + dt * v, w")
edit("1.7", "evaluates the matrix at the old time",
     "newton_matrix(acceleration, t + dt", "newton_matrix(acceleration, t")
edit("1.7", "tests only positive corrections", "np.max(np.abs(delta))", "np.max(delta)")
edit("1.7", "stops when one coordinate has converged", "np.max(np.abs(delta))", "np.min(np.abs(delta))")


@right("1.7", "by SciPy's root finder")
def implicit_euler_step(acceleration, t, x, v, dt, p):
    from scipy.optimize import root

    def residual(flat):
        w = flat.reshape(v.shape)
        return (w - v - dt * acceleration(t + dt, x + dt * w, w, p)).ravel()

    def matrix(flat):
        return worked.newton_matrix(acceleration, t + dt, x, flat.reshape(v.shape), dt, p)

    found = root(residual, v.ravel(), jac=matrix, tol=1e-13)
    if np.max(np.abs(found.fun)) > 1e-6 * np.max(np.abs(found.x)) + 1e3 * worked.velocity_round_off(x, v, dt):
        raise Diverged("Newton's method did not converge at dt [s]", dt, "take a smaller step")
    w = found.x.reshape(v.shape)
    return x + dt * w, w


edit("1.7", "adds the correction δ in place of subtracting it", "w = w - delta", "w = w + delta")
edit("1.7", "moves the position with the old velocity at the end", "return x + dt * w, w", "return x + dt * v, w")
edit("1.7", "builds the matrix at the old velocity",
     "newton_matrix(acceleration, t + dt, x, w", "newton_matrix(acceleration, t + dt, x, v")
edit("1.7", "omits the old velocity in the residual", "w - v - dt", "w - dt")
edit("1.7", "adds the acceleration in the residual", "w - v - dt", "w - v + dt")
edit("1.7", "forgets dt in the residual", "w - v - dt * acceleration", "w - v - acceleration")
edit("1.7", "takes the acceleration at the old velocity", "x + dt * w, w, p)", "x + dt * w, v, p)")
edit("1.7", "takes the acceleration at the position that the old velocity reaches",
     "x + dt * w, w, p)", "x + dt * v, w, p)")
edit("1.7", "moves the position twice: evaluates the acceleration at x + 2 dt w",
     "x + dt * w, w, p)", "x + 2.0 * dt * w, w, p)")
edit("1.7", "forgets the shape of the correction", ".reshape(v.shape)", "")


# 1.8 ------------------------------------------------------------------------------------------------------------
@right("1.8", "the second half explicitly")
def implicit_midpoint_step(acceleration, t, x, v, dt, p):
    x_mid, v_mid = worked.implicit_euler_step(acceleration, t, x, v, 0.5 * dt, p)
    return x + dt * v_mid, v + dt * acceleration(t + 0.5 * dt, x_mid, v_mid, p)


edit("1.8", "takes a whole step of implicit Euler", "0.5 * dt, p)", "dt, p); return x_mid, v_mid")
edit("1.8", "returns the state at the middle of the step", "2.0 * x_mid - x, 2.0 * v_mid - v", "x_mid, v_mid")
edit("1.8", "takes two half steps of implicit Euler", "2.0 * x_mid - x, 2.0 * v_mid - v",
     "implicit_euler_step(acceleration, t + 0.5 * dt, x_mid, v_mid, 0.5 * dt, p)")
edit("1.8", "takes a whole step where half a step belongs", "0.5 * dt, p)", "dt, p)")
edit("1.8", "takes the mean of the start and of a whole step of implicit Euler for the middle", "0.5 * dt, p)",
     "dt, p); x_mid, v_mid = 0.5 * (x + x_mid), 0.5 * (v + v_mid); "
     "return x + dt * v_mid, v + dt * acceleration(t + 0.5 * dt, x_mid, v_mid, p)")
edit("1.8", "takes the explicit midpoint method, and solves no equation",
     "0.5 * dt, p)", "0.5 * dt, p); return midpoint_step(acceleration, t, x, v, dt, p)")
edit("1.8", "starts at the time of the middle of the step",
     "implicit_euler_step(acceleration, t, x", "implicit_euler_step(acceleration, t + 0.5 * dt, x")
edit("1.8", "returns the velocity in the middle", "2.0 * v_mid - v", "v_mid")
edit("1.8", "returns the position in the middle", "return 2.0 * x_mid - x,", "return x_mid,")
edit("1.8", "moves the position with the velocity at the end of the step",
     "2.0 * x_mid - x,", "x + dt * (2.0 * v_mid - v),")
edit("1.8", "returns the state unchanged where nothing accelerates it", "x_mid, v_mid =",
     "if not acceleration(t, x, v, p).any(): return x, v\n    x_mid, v_mid =")


# 1.9 ------------------------------------------------------------------------------------------------------------
@variants
def columns(acceleration=worked.oscillator_acceleration):
    def of(step, omega, zeta, dt):
        p, one, zero = worked.Oscillator(omega, zeta), np.ones(1), np.zeros(1)
        return np.hstack([np.array(step(acceleration, 0.0, *state, dt, p)) for state in ((one, zero), (zero, one))])
    return of


right("1.9", "columns stacked")(columns())
wrong("1.9", "forgets the damping")(columns(lambda t, x, v, p: -p.omega**2 * x))
TRANSPOSE = edit("1.9", "returns the transpose", "[[x1[0], x2[0]], [v1[0], v2[0]]]", "[[x1[0], v1[0]], [x2[0], v2[0]]]")
edit("1.9", "returns the inverse of the matrix", "np.array([[x1[0], x2[0]], [v1[0], v2[0]]])",
     "np.linalg.inv(np.array([[x1[0], x2[0]], [v1[0], v2[0]]]))")
edit("1.9", "exchanges ω and ζ", "Oscillator(omega, zeta)", "Oscillator(zeta, omega)")
edit("1.9", "exchanges the two columns", "[[x1[0], x2[0]], [v1[0], v2[0]]]", "[[x2[0], x1[0]], [v2[0], v1[0]]]")
edit("1.9", "exchanges the two rows", "[[x1[0], x2[0]], [v1[0], v2[0]]]", "[[v1[0], v2[0]], [x1[0], x2[0]]]")
edit("1.9", "starts both columns from x = 1", "0.0, zero, one, dt", "0.0, one, zero, dt")
edit("1.9", "starts the second column from (1, 1)", "0.0, zero, one, dt", "0.0, one, one, dt")
edit("1.9", "exchanges position and velocity in both starts",
     "x1, v1 = step(oscillator_acceleration, 0.0, one, zero", "x1, v1 = step(oscillator_acceleration, 0.0, zero, one")
edit("1.9", "gives the oscillator ω² in place of ω", "Oscillator(omega, zeta)", "Oscillator(omega * omega, zeta)")
edit("1.9", "takes a damping ratio of at most 1", "Oscillator(omega, zeta)", "Oscillator(omega, min(zeta, 1.0))")
edit("1.9", "takes 1 rad/s for a body without a spring", "Oscillator(omega, zeta)", "Oscillator(omega or 1.0, zeta)")


# 1.10 -----------------------------------------------------------------------------------------------------------
@right("1.10", "polyfit")
def observed_order(dts, errors):
    for dt, error in zip(dts, errors, strict=True):
        check_positive("step dt [s]", dt)
        check_positive("error [-]", error)
    return np.polyfit(np.log(dts), np.log(errors), 1)[0]


@right("1.10", "with sums of logarithms, not of their distances from the mean")
def observed_order_2(dts, errors):
    for dt in dts:
        check_positive("step dt [s]", dt)
    for error in errors:
        check_positive("error [-]", error)
    a, b, n = np.log(dts), np.log(errors), len(dts)
    return (n * np.sum(a * b) - np.sum(a) * np.sum(b)) / (n * np.sum(a * a) - np.sum(a) ** 2)


edit("1.10", "accepts an error of zero", 'check_positive("error [-]", errors[n])', "pass")
edit("1.10", "fits a line to the errors, not to their logarithms", "xi = np.log(dts) - np.mean(np.log(dts))",
     "return np.polyfit(dts, errors, 1)[0]")
edit("1.10", "uses the first and the last error only",
     "np.sum(xi * eta) / np.sum(xi * xi)", "(eta[-1] - eta[0]) / (xi[-1] - xi[0])")
edit("1.10", "forgets the mean of log dt", "xi = np.log(dts) - np.mean(np.log(dts))", "xi = np.log(dts)")
edit("1.10", "exchanges steps and errors: the slope of log dt over log error",
     "np.sum(xi * eta) / np.sum(xi * xi)", "np.sum(xi * eta) / np.sum(eta * eta)")
edit("1.10", "returns the reciprocal of the slope",
     "np.sum(xi * eta) / np.sum(xi * xi)", "np.sum(xi * xi) / np.sum(xi * eta)")
edit("1.10", "returns the negative slope", "return np.sum(xi", "return -np.sum(xi")
edit("1.10", "returns the correlation, not the slope",
     "np.sum(xi * xi)", "np.sqrt(np.sum(xi * xi) * np.sum(eta * eta))")
edit("1.10", "divides each logarithm by the other one, and takes the mean",
     "np.sum(xi * eta) / np.sum(xi * xi)", "np.mean(np.log(errors) / np.log(dts))")
edit("1.10", "accepts a step of zero or below", 'check_positive("step dt [s]", dts[n])', "pass")
edit("1.10", "forgets both means, that of log dt and that of log error",
     "np.sum(xi * eta) / np.sum(xi * xi)", "np.sum(np.log(dts) * np.log(errors)) / np.sum(np.log(dts)**2)")
edit("1.10", "checks the last run only", "range(dts.size)", "[dts.size - 1]")
edit("1.10", "returns the size of the slope, without its sign", "np.sum(xi * eta) /", "abs(np.sum(xi * eta)) /")


# 1.11 -----------------------------------------------------------------------------------------------------------
@right("1.11", "step by step")
def growth_per_period(steps):
    factor = 1.0
    for _ in range(steps):
        factor *= np.hypot(1.0, 2.0 * np.pi / steps)
    return factor


edit("1.11", "gives the growth of the energy, which is the square of that of the amplitude", "(0.5 * steps)", "steps")
edit("1.11", "takes the leg ω dt as the growth of a step, not the hypotenuse",
     "(1.0 + angle * angle) ** (0.5 * steps)", "(1.0 + angle) ** steps")
edit("1.11", "gives the growth of a single step", "** (0.5 * steps)", "** 0.5")
edit("1.11", "adds the growth of the steps, where each multiplies the one before",
     "(1.0 + angle * angle) ** (0.5 * steps)", "1.0 + 0.5 * steps * angle * angle")
edit("1.11", "adds the growth of the steps, where each multiplies the one before",
     "(1.0 + angle * angle) ** (0.5 * steps)", "1.0 + steps * (np.sqrt(1.0 + angle * angle) - 1.0)")
edit("1.11", "gives the limit for many steps, e^(2π²/steps)",
     "(1.0 + angle * angle) ** (0.5 * steps)", "np.exp(0.5 * steps * angle * angle)")
edit("1.11", "forgets 2π: a period is 2π/ω, not 1/ω", "2.0 * np.pi / steps", "1.0 / steps")
edit("1.11", "takes a period of π/ω, after which the motion is at the other side", "2.0 * np.pi", "np.pi")
edit("1.11", "says that the amplitude stays", "(1.0 + angle * angle)", "(1.0 + 0.0 * angle)")
edit("1.11", "says that the amplitude shrinks", "(0.5 * steps)", "(-0.5 * steps)")
edit("1.11", "counts at most 100 steps", "angle = 2.0", "steps = min(steps, 100); angle = 2.0")


# 1.12 -----------------------------------------------------------------------------------------------------------
@right("1.12", "as a small letter")
def explicit_euler_is():
    return "a"


edit("1.12", "chooses the average velocity: its energy grows, too, but half as fast as that of explicit Euler",
     '"A"', '"B"')
edit("1.12", "chooses implicit Euler: it takes the slope at the end of the step, and loses energy", '"A"', '"C"')
edit("1.12", "chooses symplectic Euler: it moves with the new velocity, and its energy comes back", '"A"', '"D"')


# 1.13 -----------------------------------------------------------------------------------------------------------
@right("1.13", "two kicks, McLachlan's best")
def my_step(acceleration, t, x, v, dt, p):
    share = 0.1931833275037836
    x = x + share * dt * v
    v = v + 0.5 * dt * acceleration(t + share * dt, x, v, p)
    x = x + (1.0 - 2.0 * share) * dt * v
    v = v + 0.5 * dt * acceleration(t + (1.0 - share) * dt, x, v, p)
    return x + share * dt * v, v


@right("1.13", "Nyström's method of fourth order")
def nystrom_step(acceleration, t, x, v, dt, p):
    a1 = acceleration(t, x, v, p)
    a2 = acceleration(t + 0.5 * dt, x + 0.5 * dt * v + dt * dt / 8.0 * a1, v, p)
    a3 = acceleration(t + dt, x + dt * v + 0.5 * dt * dt * a2, v, p)
    return x + dt * v + dt * dt / 6.0 * (a1 + 2.0 * a2), v + dt / 6.0 * (a1 + 4.0 * a2 + a3)


@right("1.13", "three steps of drift, kick, drift: Forest and Ruth")
def forest_ruth_step(acceleration, t, x, v, dt, p):
    outer = 1.0 / (2.0 - 2.0 ** (1.0 / 3.0))
    for share in (outer, 1.0 - 2.0 * outer, outer):
        h = share * dt
        x = x + 0.5 * h * v
        v = v + h * acceleration(t + 0.5 * h, x, v, p)
        x, t = x + 0.5 * h * v, t + h
    return x, v


@right("1.13", "fifteen kicks of eighth order: as exact as the reference solution")
def kahan_li_step(acceleration, t, x, v, dt, p):
    half = (0.7416703643506129, -0.4091008258000316, 0.1907547102962384, -0.5738624711160822, 0.2990641813036559,
            0.3346249182452982, 0.3152930923967666)
    for share in (*half, 1.0 - 2.0 * sum(half), *half[::-1]):
        h = share * dt
        x = x + 0.5 * h * v
        v = v + h * acceleration(t + 0.5 * h, x, v, p)
        x, t = x + 0.5 * h * v, t + h
    return x, v


edit("1.13", "does not move", "x_mid = x + 0.5 * dt * v", "return x, v")
edit("1.13", "is velocity Verlet", "x_mid = x + 0.5 * dt * v", "return verlet_step(acceleration, t, x, v, dt, p)")
edit("1.13", "is symplectic Euler", "x_mid = x + 0.5 * dt * v",
     "return symplectic_euler_step(acceleration, t, x, v, dt, p)")
edit("1.13", "is the midpoint method, which gains energy", "x_mid = x + 0.5 * dt * v",
     "return midpoint_step(acceleration, t, x, v, dt, p)")
edit("1.13", "is Heun's method, which gains energy", "x_mid = x + 0.5 * dt * v",
     "a = acceleration(t, x, v, p); return x + dt * (v + 0.5 * dt * a), "
     "v + 0.5 * dt * (a + acceleration(t + dt, x + dt * v, v + dt * a, p))")
edit("1.13", "is Runge–Kutta 4", "x_mid = x + 0.5 * dt * v",
     "return rk4_step(acceleration, t, x, v, dt, p)")
edit("1.13", "takes the mean of the steps of Euler and symplectic Euler: of first order in the position",
     "x_mid = x + 0.5 * dt * v", "return average_velocity_step(acceleration, t, x, v, dt, p)")
edit("1.13", "kicks at the old time", "acceleration(t + 0.5 * dt", "acceleration(t")
edit("1.13", "drifts by half a step only", "return x_mid + 0.5 * dt * v_new", "return x_mid")
edit("1.13", "kicks for half a step only", "v + dt * acc", "v + 0.5 * dt * acc")
edit("1.13", "drifts with the old velocity at the end", "x_mid + 0.5 * dt * v_new", "x_mid + 0.5 * dt * v")
edit("1.13", "does not move from rest",
     "x_mid = x + 0.5 * dt * v", "if not v.any(): return x, v\n    x_mid = x + 0.5 * dt * v")


# what only one entry, only the sum, or only one number of axes shows --------------------------------------------------
def takes_for_zero(exercise, begins, shortcuts):
    """A short cut for a vector that is zero, taken where one entry is, or where all add up to 0."""
    for number, (vector, answer) in shortcuts.items():
        for what, condition in (("the first entry", f"({vector}).flat[0] == 0.0"),
                                ("the last entry", f"({vector}).flat[-1] == 0.0"),
                                ("the product", f"np.prod({vector}) == 0.0"), ("the sum", f"np.sum({vector}) == 0.0"),
                                ("the largest entry", f"np.max({vector}) == 0.0")):
            edit(exercise, f"takes all bodies for {number} where {what} is zero", begins,
                 f"if {condition}: return {answer}\n    {begins}")


A = "acceleration(t, x, v, p)"
DRIFT = "x + dt * v, v"
takes_for_zero("1.1", "return", {"free": (A, DRIFT), "at rest": ("v", f"x, v + dt * {A}")})
takes_for_zero("1.2", "x_mid = x", {"free": (A, DRIFT), "at rest": ("v", "euler_step(acceleration, t, x, v, dt, p)")})
takes_for_zero("1.3", "a1 = acc", {"free": (A, DRIFT), "at rest": ("v", "midpoint_step(acceleration, t, x, v, dt, p)")})
takes_for_zero("1.4", "v_new = v", {"free": (A, DRIFT), "at rest": ("v", f"x, v + dt * {A}")})
takes_for_zero("1.5", "v = v + dt", {"free": (A, DRIFT), "at rest": ("v", f"x, v + dt * {A}")})
takes_for_zero("1.6", "a = acc", {"free": (A, DRIFT), "at rest": ("v", "euler_step(acceleration, t, x, v, dt, p)")})
SYMPLECTIC = "symplectic_euler_step(acceleration, t, x, v, dt, p)"
RESTS = {"free": (A, DRIFT), "at rest": ("v", SYMPLECTIC), "at the origin": ("x", SYMPLECTIC)}
takes_for_zero("1.7", "w = v.copy()", RESTS)
takes_for_zero("1.8", "x_mid, v_mid =",
               {"free": (A, DRIFT), "at rest": ("v", "midpoint_step(acceleration, t, x, v, dt, p)")})
takes_for_zero("1.13", "x_mid = x", RESTS)
for exercise, begins in (("1.1", "return"), ("1.2", "x_mid = x"), ("1.3", "a1 = acc"), ("1.4", "v_new = v"),
                         ("1.5", "v = v + dt"), ("1.6", "a = acc"), ("1.7", "w = v.copy()"), ("1.8", "x_mid, v_mid ="),
                         ("1.13", "x_mid = x")):
    edit(exercise, "moves only bodies with one coordinate each", begins,
         f"if x.ndim > 1 and x.shape[1] > 1: return x, v\n    {begins}")
    edit(exercise, "takes one axis for granted", begins, f"x[x.size - 1]; {begins}")
    edit(exercise, "takes a time before 0 for one after it", begins, f"t = abs(t); {begins}")
edit("1.7", "gives up after ten corrections", "NEWTON_LIMIT", "10")
edit("1.7", "forgets the round-off of a position far from the origin", " + round_off", "")
edit("1.7", "stops when the corrections add up to 0", "np.max(np.abs(delta))", "np.abs(np.sum(delta))")
edit("1.7", "stops when the first coordinate has converged", "np.max(np.abs(delta))", "np.abs(delta.flat[0])")
edit("1.7", "uses only the diagonal of the matrix", "solve(matrix,", "solve(np.diag(np.diag(matrix)),")
edit("1.7", "transposes the matrix", "solve(matrix,", "solve(matrix.T,")
edit("1.7", "names another number in the error", "at dt [s]\", dt", "at dt [s]\", 0.0")
edit("1.7", "says another sentence in the error", "Newton's method did not converge at dt [s]", "the step is wrong")
edit("1.8", "goes on with an explicit step where there is no solution", "x_mid, v_mid = implicit",
     "try: implicit_euler_step(acceleration, t, x, v, 0.5 * dt, p)\n"
     "    except Diverged: return midpoint_step(acceleration, t, x, v, dt, p)\n    x_mid, v_mid = implicit")
edit("1.9", "takes a damping ratio of at most 5", "Oscillator(omega, zeta)", "Oscillator(omega, min(zeta, 5.0))")
edit("1.10", "finds no order above 5", "return np.sum(xi * eta) / np.sum(xi * xi)",
     "return min(5.0, np.sum(xi * eta) / np.sum(xi * xi))")
edit("1.10", "keeps one run of each step", "xi = np.log(dts) -",
     "dts, kept = np.unique(dts, return_index=True); errors = errors[kept]; xi = np.log(dts) -")
edit("1.7", "begins with the slope at the start of the step, not with v", "w = v.copy()",
     "w = v + dt * acceleration(t, x, v, p)")
for number, old, new in (("1.1", "dt * v,", "abs(dt) * v,"), ("1.3", "v + 0.5 * dt * a1", "v + 0.5 * abs(dt) * a1"),
                         ("1.6", "x + dt * v +", "x + abs(dt) * v +")):
    edit(number, "takes a step backwards for one forwards", old, new)
