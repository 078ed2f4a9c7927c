"""Lesson 12: differences and tangents with a wrong factor, time, place or sign; impacts whose time does not move."""

import numpy as np

from solutions import sensitivities as worked
from solutions.checks import BadInput, Diverged, check_positive

from . import collection, of_variants, variants

wrong, right, edit, MUTANTS = collection(worked)
wrongs, alike = of_variants(wrong)

HOW = {"its sum": "{0}.sum() != 0.0", "its first entry": "{0}.flat[0] != 0.0", "its last entry": "{0}.flat[-1] != 0.0",
       "its largest entry": "{0}.max() > 0.0", "a fixed small number": "np.abs({0}).max() > 1e-8"}


def by_part(exercise, what, y, old, new, hows=tuple(HOW)):
    """Wrong answers that take y for zero by less than all of it; KEPT in `new` is whether they do not."""
    for how in hows:
        edit(exercise, f"takes {what} for zero by {how}", old, new.replace("KEPT", f"({HOW[how].format(y)})"))


def of_another_shape(exercise, whole):
    """Wrong answers that return the derivative `whole` of an array with other axes."""
    for story, other in (("flattens an array", "np.ravel({0}) if np.ndim(f(s, p)) else {0}"),
                         ("flattens an array with two axes", "np.ravel({0}) if np.ndim(f(s, p)) == 2 else {0}"),
                         ("turns an array with two axes over", "np.transpose({0})"),
                         ("returns the first row of an array with two axes",
                          "({0})[0] if np.ndim(f(s, p)) > 1 else {0}"),
                         ("leaves out axes of one entry", "np.squeeze({0}) if np.ndim(f(s, p)) > 1 else {0}")):
        edit(exercise, story, whole, other.format(whole))


TIMES = {"the size of": "abs(t)", "at most 1 for": "min(t, 1.0)", "at least 0 for": "max(t, 0.0)", "0 for": "0.0"}


# 12.1 -----------------------------------------------------------------------------------------------------------
@right("12.1", "as the mean of a difference ahead and one behind")
def central_difference(f, s, h, p):
    here = f(s, p)
    return 0.5 * ((f(s + h, p) - here) / h + (here - f(s - h, p)) / h)


edit("12.1", "divides by h, not by 2h", "(2.0 * h)", "h")
edit("12.1", "takes a forward difference", "(f(s + h, p) - f(s - h, p)) / (2.0 * h)", "(f(s + h, p) - f(s, p)) / h")
edit("12.1", "takes a backward difference", "(f(s + h, p) - f(s - h, p)) / (2.0 * h)", "(f(s, p) - f(s - h, p)) / h")
edit("12.1", "subtracts the value ahead from the one behind", "f(s + h, p) - f(s - h, p)", "f(s - h, p) - f(s + h, p)")
edit("12.1", "divides half a difference by 2h", "f(s + h, p) - f(s - h, p)", "f(s + h, p) - f(s, p)")
edit("12.1", "multiplies by 2h", "/ (2.0 * h)", "* (2.0 * h)")
edit("12.1", "divides by 2 and multiplies by h", "(2.0 * h)", "2.0 * h")
edit("12.1", "takes half of the step", "f(s + h, p) - f(s - h, p)", "f(s + 0.5 * h, p) - f(s - 0.5 * h, p)")
edit("12.1", "adds the two values", "f(s + h, p) - f(s - h, p)", "f(s + h, p) + f(s - h, p)")
edit("12.1", "makes the step relative to s", "(f(s + h, p) - f(s - h, p)) / (2.0 * h)",
     "(f(s + h * s, p) - f(s - h * s, p)) / (2.0 * h * s)")
edit("12.1", "returns one number for an array", "(f(s + h, p) - f(s - h, p))", "np.sum(f(s + h, p) - f(s - h, p))")
edit("12.1", "always takes a very short step", "(f(s + h, p) - f(s - h, p)) / (2.0 * h)",
     "(f(s + 1e-6, p) - f(s - 1e-6, p)) / 2e-6")
edit("12.1", "takes a forward difference at s = 0", "(f(s + h, p) - f(s - h, p)) / (2.0 * h)",
     "(f(s + h, p) - f(s - h, p)) / (2.0 * h) if s != 0.0 else (f(s + h, p) - f(s, p)) / h")
WHOLE = "(f(s + h, p) - f(s - h, p)) / (2.0 * h)"
of_another_shape("12.1", WHOLE)
edit("12.1", "takes no step below a thousandth", WHOLE, WHOLE.replace("h", "max(h, 1e-3)"))
edit("12.1", "takes no step above a thousand", WHOLE, WHOLE.replace("h", "min(h, 1e3)"))
edit("12.1", "never divides by less than 1e-6", "(2.0 * h)", "max(2.0 * h, 1e-6)")
edit("12.1", "takes the size of s", WHOLE, WHOLE.replace("f(s", "f(abs(s)"))
edit("12.1", "rounds what is below 1e-12 to 0", WHOLE, f"np.round({WHOLE}, 12)")


# 12.2 -----------------------------------------------------------------------------------------------------------
@right("12.2", "by logarithms")
def best_step(value, third, round_off):
    if third == 0.0:
        return np.inf
    return np.exp((np.log(3.0) + np.log(round_off) + np.log(abs(value)) - np.log(abs(third))) / 3.0)


@right("12.2", "by a cube root, in another order")
def step_by_cube_root(value, third, round_off):
    return float("inf") if third == 0 else float(np.cbrt(abs(3.0 * value * round_off / third)))


edit("12.2", "makes both errors equal, not their sum small", "3.0 * round_off", "6.0 * round_off")
edit("12.2", "takes the square root, as for a forward difference", "(1.0 / 3.0)", "(1.0 / 2.0)")
edit("12.2", "forgets the factor 3", "3.0 * round_off", "round_off")
edit("12.2", "exchanges f and its third derivative", "np.abs(value) / np.abs(third)", "np.abs(third) / np.abs(value)")
edit("12.2", "forgets the size of f", "* np.abs(value)", "")
edit("12.2", "forgets the third derivative", " / np.abs(third)", "")
edit("12.2", "forgets the sixth in the truncation error", "3.0 * round_off", "0.5 * round_off")
edit("12.2", "takes the truncation error as h² f‴/3", "3.0 * round_off", "1.5 * round_off")
edit("12.2", "takes no root", "** (1.0 / 3.0)", "")
edit("12.2", "needs a positive f", "np.abs(value)", "max(value, 0.0)")
edit("12.2", "needs a positive third derivative", "/ np.abs(third)", "/ max(third, 1e-30)")
for root in ("np.cbrt(3.0 * round_off * value / third)", "(3.0 * round_off * value / third) ** (1.0 / 3.0)"):
    edit("12.2", "takes f and f‴ with their signs",
         "(3.0 * round_off * np.abs(value) / np.abs(third)) ** (1.0 / 3.0)", root)
edit("12.2", "returns 0 where the third derivative is 0", "return np.inf", "return 0.0")
edit("12.2", "returns 1 where the third derivative is 0", "return np.inf", "return 1.0")
edit("12.2", "always uses the round-off of floats", "3.0 * round_off", "3.0 * 2.2e-16")
edit("12.2", "takes the root of the round-off only",
     "(3.0 * round_off * np.abs(value) / np.abs(third)) ** (1.0 / 3.0)", "np.cbrt(round_off)")
for small in (0.05, 1e-3, 1e-6, 1e-9, 1e-12, 1e-15, 1e-30, 1e-80):
    edit("12.2", f"takes a third derivative below {small:g} for 0", "third == 0.0", f"np.abs(third) < {small}")
edit("12.2", "takes a negative third derivative for 0", "third == 0.0", "third <= 0.0")
edit("12.2", "takes a third derivative near 0 for 0", "third == 0.0", "np.isclose(third, 0.0)")
edit("12.2", "adds a small number to the third derivative", "/ np.abs(third)", "/ (np.abs(third) + 1e-15)")
edit("12.2", "adds a small number to f", "* np.abs(value)", "* (np.abs(value) + 1e-15)")
edit("12.2", "takes an f below 1 for 1", "np.abs(value)", "np.maximum(np.abs(value), 1.0)")
edit("12.2", "takes an f above 1000 for 1000", "np.abs(value)", "np.minimum(np.abs(value), 1e3)")
edit("12.2", "takes a third derivative above 1000 for 1000", "/ np.abs(third)", "/ np.minimum(np.abs(third), 1e3)")
edit("12.2", "takes no step above 1", "(3.0 * round_off * np.abs(value) / np.abs(third)) ** (1.0 / 3.0)",
     "min((3.0 * round_off * np.abs(value) / np.abs(third)) ** (1.0 / 3.0), 1.0)")
edit("12.2", "takes no step below 1e-8", "(3.0 * round_off * np.abs(value) / np.abs(third)) ** (1.0 / 3.0)",
     "max((3.0 * round_off * np.abs(value) / np.abs(third)) ** (1.0 / 3.0), 1e-8)")
edit("12.2", "returns a large number where the third derivative is 0", "return np.inf", "return 1e300")


# 12.3 -----------------------------------------------------------------------------------------------------------
@right("12.3", "by the attribute imag")
def complex_step(f, s, h, p):
    return np.asarray(f(complex(s, h), p)).imag / h


edit("12.3", "takes the real part", "np.imag", "np.real")
edit("12.3", "forgets to divide by h", " / h", "")
edit("12.3", "divides by 2h", " / h", " / (2.0 * h)")
edit("12.3", "subtracts i h", "s + 1j * h", "s - 1j * h")
edit("12.3", "multiplies s by i h", "s + 1j * h", "s * 1j * h")
edit("12.3", "takes the absolute value", "np.imag(f(s + 1j * h, p))", "np.abs(f(s + 1j * h, p))")
edit("12.3", "takes the real difference ahead", "np.imag(f(s + 1j * h, p))", "(f(s + h, p) - f(s, p))")
edit("12.3", "subtracts f(s) and takes the absolute value", "np.imag(f(s + 1j * h, p))",
     "np.abs(f(s + 1j * h, p) - f(s, p))")
edit("12.3", "takes the angle of the complex number", "np.imag(f(s + 1j * h, p))", "np.angle(f(s + 1j * h, p))")
edit("12.3", "gives h no unit i: takes a step of (1 + i) h", "s + 1j * h", "s + (1.0 + 1j) * h")
edit("12.3", "always takes the step 1e-20", "np.imag(f(s + 1j * h, p)) / h", "np.imag(f(s + 1e-20j, p)) / 1e-20")
edit("12.3", "returns one number for an array", "np.imag(f(s + 1j * h, p))",
     "np.sum(np.imag(f(s + 1j * h, p)))")
edit("12.3", "takes a real difference at s = 0", "np.imag(f(s + 1j * h, p)) / h",
     "np.imag(f(s + 1j * h, p)) / h if s != 0.0 else (f(s + h, p) - f(s - h, p)) / (2.0 * h)")
WHOLE = "np.imag(f(s + 1j * h, p)) / h"
of_another_shape("12.3", WHOLE)
for most in ("1e-6", "1e3"):
    edit("12.3", f"takes no step above {most}", WHOLE, WHOLE.replace(" h", f" min(h, {most})"))
edit("12.3", "takes no step below 1e-30", WHOLE, WHOLE.replace("* h", "* max(h, 1e-30)"))
edit("12.3", "takes the size of s", "f(s +", "f(abs(s) +")
edit("12.3", "rounds what is below 1e-12 to 0", WHOLE, f"np.round({WHOLE}, 12)")


# 12.4 -----------------------------------------------------------------------------------------------------------
@right("12.4", "with the matrices of the whole step")
def tangent_step(acceleration, derivatives, t, x, v, dx, dv, dt, p):
    a_x, a_v, a_s = derivatives(t, x, v, p)
    one = np.eye(x.size)
    v = v + dt * acceleration(t, x, v, p)
    A = np.block([[one + dt * dt * a_x, dt * (one + dt * a_v)], [dt * a_x, one + dt * a_v]])
    y = A @ np.vstack((dx, dv)) + np.vstack((dt * dt * a_s, dt * a_s))
    return x + dt * v, v, y[:x.size], y[x.size:]


edit("12.4", "moves dx with the old dv", "dx + dt * dv_new, dv_new", "dx + dt * dv, dv_new")
edit("12.4", "leaves out the inputs on which the law itself depends", " + a_s)", ")")
edit("12.4", "leaves out the derivative with respect to v", " + a_v @ dv", "")
edit("12.4", "leaves out the derivative with respect to x", "a_x @ dx + ", "")
edit("12.4", "takes the derivatives at the new state", "v_new = v + dt * acceleration(t, x, v, p)",
     "v_new = v + dt * acceleration(t, x, v, p); a_x, a_v, a_s = derivatives(t, x + dt * v_new, v_new, p)")
edit("12.4", "takes the derivatives at the new velocity", "v_new = v + dt * acceleration(t, x, v, p)",
     "v_new = v + dt * acceleration(t, x, v, p); a_x, a_v, a_s = derivatives(t, x, v_new, p)")
edit("12.4", "takes the derivatives at the new position", "v_new = v + dt * acceleration(t, x, v, p)",
     "v_new = v + dt * acceleration(t, x, v, p); a_x, a_v, a_s = derivatives(t, x + dt * v_new, v, p)")
edit("12.4", "takes the derivatives at the time t + dt", "derivatives(t, x, v, p)", "derivatives(t + dt, x, v, p)")
edit("12.4", "transposes a_x", "a_x @ dx", "a_x.T @ dx")
edit("12.4", "transposes a_v", "a_v @ dv", "a_v.T @ dv")
edit("12.4", "exchanges dx and dv", "a_x @ dx + a_v @ dv", "a_x @ dv + a_v @ dx")
edit("12.4", "multiplies entry by entry", "a_x @ dx", "np.diag(a_x)[:, None] * dx")
edit("12.4", "forgets dt in dv", "dv + dt * (a_x", "dv + (a_x")
edit("12.4", "subtracts the change of dv", "dv + dt * (a_x", "dv - dt * (a_x")
edit("12.4", "multiplies a_s by dt once more", " + a_s)", " + dt * a_s)")
edit("12.4", "returns only the change of dv", "dv_new = dv + dt", "dv_new = dt")
edit("12.4", "returns the sensitivities first", "return x + dt * v_new, v_new, dx + dt * dv_new, dv_new",
     "return dx + dt * dv_new, dv_new, x + dt * v_new, v_new")
edit("12.4", "moves x with the old velocity", "return x + dt * v_new, v_new", "return x + dt * v, v_new")
edit("12.4", "differentiates explicit Euler", "dv + dt * (a_x @ dx + a_v @ dv + a_s)",
     "dv + dt * (a_x @ dx + a_v @ dv + a_s); dx = dx - dt * dt * (a_x @ dx + a_v @ dv + a_s)")
edit("12.4", "leaves the tangents as they are where dx and dv are 0", " + a_s)", " + (dx.any() or dv.any()) * a_s)")
by_part("12.4", "dx", "dx", "a_x @ dx", "KEPT * (a_x @ dx)")
by_part("12.4", "dv", "dv", "a_v @ dv", "KEPT * (a_v @ dv)")
by_part("12.4", "a_s", "a_s", " + a_s)", " + KEPT * a_s)")
by_part("12.4", "a_x", "a_x", "a_x @ dx", "KEPT * (a_x @ dx)")
by_part("12.4", "a_v", "a_v", "a_v @ dv", "KEPT * (a_v @ dv)")
by_part("12.4", "x", "x", "return x + dt", "return KEPT * x + dt")
by_part("12.4", "v", "v", "v_new = v + dt", "v_new = KEPT * v + dt")
by_part("12.4", "the old dx", "dx", "dx + dt * dv_new, dv_new", "KEPT * dx + dt * dv_new, dv_new")
by_part("12.4", "the old dv", "dv", "dv + dt * (a_x", "KEPT * dv + dt * (a_x")
by_part("12.4", "the new velocity", "v_new", "return x + dt * v_new", "return x + KEPT * dt * v_new", ["its sum"])
by_part("12.4", "the acceleration", "acceleration(t, x, v, p)", "dt * acceleration(t, x, v, p)",
        "KEPT * dt * acceleration(t, x, v, p)")
by_part("12.4", "dx and dv together", "(dx + dv)", " + a_s)", " + KEPT * a_s)")
for what, time in TIMES.items():
    edit("12.4", f"takes {what} the time of the derivatives", "derivatives(t,", f"derivatives({time},")
    edit("12.4", f"takes {what} the time of the acceleration", "acceleration(t,", f"acceleration({time},")
edit("12.4", "takes no step below a thousandth", "v_new = v +", "dt = max(dt, 1e-3); v_new = v +")
edit("12.4", "takes the step of the tangents for a thousandth at least", "dv + dt *", "dv + max(dt, 1e-3) *")
edit("12.4", "rounds the tangents to twelve digits", "dv_new = dv + dt * (a_x @ dx + a_v @ dv + a_s)",
     "dv_new = np.round(dv + dt * (a_x @ dx + a_v @ dv + a_s), 12)")
edit("12.4", "moves only the first input", " + a_s)", " + a_s * (np.arange(a_s.shape[1]) == 0))")
edit("12.4", "takes the derivatives at the place at rest", "derivatives(t, x, v, p)", "derivatives(t, x, 0.0 * v, p)")


# 12.5 -----------------------------------------------------------------------------------------------------------
@right("12.5", "as one system for dx and dv")
def tangent_implicit_step(acceleration, derivatives, t, x, v, dx, dv, dt, p):
    d, (x_new, v_new) = x.size, worked.implicit_euler_step(acceleration, t, x, v, dt, p)
    a_x, a_v, a_s = derivatives(t + dt, x_new, v_new, p)
    B = np.block([[np.zeros((d, d)), np.eye(d)], [a_x, a_v]])
    y = np.linalg.solve(np.eye(2 * d) - dt * B, np.vstack((dx, dv + dt * a_s)))
    return x_new, v_new, y[:d], y[d:]


MATRIX = "np.eye(x.size) - dt * a_v - dt * dt * a_x"
edit("12.5", "differentiates an explicit step", f"solve({MATRIX}, dv + dt * (a_x @ dx + a_s))",
     "dv + dt * (a_x @ dx + a_v @ dv + a_s)")
edit("12.5", "takes the derivatives at the old state", "derivatives(t + dt, x_new, v_new, p)",
     "derivatives(t + dt, x, v, p)")
edit("12.5", "takes the derivatives at the old time", "derivatives(t + dt,", "derivatives(t,")
edit("12.5", "takes the derivatives at the old time and state", "derivatives(t + dt, x_new, v_new, p)",
     "derivatives(t, x, v, p)")
edit("12.5", "forgets that the new position depends on the new velocity", " - dt * dt * a_x", "")
edit("12.5", "forgets the derivative with respect to v", " - dt * a_v", "")
edit("12.5", "takes dt, not dt², with a_x", "dt * dt * a_x", "dt * a_x")
edit("12.5", "adds dt² a_x", " - dt * dt * a_x", " + dt * dt * a_x")
edit("12.5", "adds dt a_v", " - dt * a_v", " + dt * a_v")
edit("12.5", "leaves out the inputs on which the law itself depends", " + a_s))", "))")
edit("12.5", "leaves dx out of the right-hand side", "(a_x @ dx + a_s)", "a_s")
edit("12.5", "transposes the matrix", f"solve({MATRIX},", f"solve(({MATRIX}).T,")
edit("12.5", "multiplies by the matrix", f"solve({MATRIX}, dv + dt * (a_x @ dx + a_s))",
     f"({MATRIX}) @ (dv + dt * (a_x @ dx + a_s))")
edit("12.5", "moves dx with the old dv", "dx + dt * dv_new, dv_new", "dx + dt * dv, dv_new")
edit("12.5", "forgets dv on the right-hand side", "dv + dt * (a_x", "dt * (a_x")
edit("12.5", "counts a_v twice, on both sides", "(a_x @ dx + a_s)", "(a_x @ dx + a_v @ dv + a_s)")
edit("12.5", "divides entry by entry", f"solve({MATRIX}, dv + dt * (a_x @ dx + a_s))",
     f"(dv + dt * (a_x @ dx + a_s)) / np.diag({MATRIX})[:, None]")
edit("12.5", "moves the state by an explicit step", "implicit_euler_step(acceleration, t, x, v, dt, p)",
     "x + dt * v, v + dt * acceleration(t, x, v, p)")
edit("12.5", "leaves the tangents as they are where dx and dv are 0", "(a_x @ dx + a_s)",
     "(a_x @ dx + (dx.any() or dv.any()) * a_s)")
RIGHT = "dv + dt * (a_x @ dx + a_s)"
by_part("12.5", "dx", "dx", "a_x @ dx", "KEPT * (a_x @ dx)")
by_part("12.5", "a_s", "a_s", " + a_s))", " + KEPT * a_s))")
by_part("12.5", "dv", "dv", RIGHT, f"KEPT * {RIGHT}")
by_part("12.5", "a_x", "a_x", " - dt * dt * a_x", " - KEPT * dt * dt * a_x")
by_part("12.5", "a_v", "a_v", " - dt * a_v", " - KEPT * dt * a_v")
by_part("12.5", "the right-hand side", f"({RIGHT})", RIGHT, f"KEPT * ({RIGHT})")
by_part("12.5", "dx and dv together", "(dx + dv)", " + a_s))", " + KEPT * a_s))")
by_part("12.5", "the old dx", "dx", "dx + dt * dv_new, dv_new", "KEPT * dx + dt * dv_new, dv_new")
by_part("12.5", "x", "x", "step(acceleration, t, x,", "step(acceleration, t, KEPT * x,", ["its sum", "its last entry"])
by_part("12.5", "v", "v", "step(acceleration, t, x, v,", "step(acceleration, t, x, KEPT * v,",
        ["its sum", "its last entry"])
for what, time in TIMES.items():
    edit("12.5", f"takes {what} the time of the derivatives", "derivatives(t +", f"derivatives({time} +")
    edit("12.5", f"takes {what} the time of the step", "step(acceleration, t,", f"step(acceleration, {time},")
edit("12.5", "takes the size of the time at the end of the step", "derivatives(t + dt,", "derivatives(abs(t + dt),")
edit("12.5", "takes the step of the tangents for a thousandth at least", "    dv_new =",
     "    dt = max(dt, 1e-3); dv_new =")
edit("12.5", "rounds the tangents to twelve digits", "return x_new, v_new, dx + dt * dv_new, dv_new",
     "return x_new, v_new, dx + dt * dv_new, np.round(dv_new, 12)")
edit("12.5", "takes the derivatives at the old velocity", "derivatives(t + dt, x_new, v_new, p)",
     "derivatives(t + dt, x_new, v, p)")
edit("12.5", "takes the derivatives at the old position", "derivatives(t + dt, x_new, v_new, p)",
     "derivatives(t + dt, x, v_new, p)")
edit("12.5", "moves the state where no step is found",
     "x_new, v_new = implicit_euler_step(acceleration, t, x, v, dt, p)",
     "try:\n        x_new, v_new = implicit_euler_step(acceleration, t, x, v, dt, p)\n"
     "    except Diverged:\n        x_new, v_new = x, v")


# 12.6 -----------------------------------------------------------------------------------------------------------
@right("12.6", "one input after the other")
def event_time_sensitivity(gap_x, gap_v, gap_s, v, a, dx, dv):
    terms = np.append(gap_x * v, gap_v * a)
    if abs(terms.sum()) <= 1e-12 * np.abs(terms).sum():
        raise BadInput("rate of the event", terms.sum(), "it only grazes")
    return np.array([-(gap_x @ dx[:, k] + gap_v @ dv[:, k] + gap_s[k]) / terms.sum() for k in range(gap_s.size)])


@right("12.6", "entry by entry, in plain numbers")
def entry_by_entry(gap_x, gap_v, gap_s, v, a, dx, dv):
    rate = sum(float(y * z) for y, z in zip((*gap_x, *gap_v), (*v, *a), strict=True))
    if abs(rate) <= 1e-12 * sum(abs(y * z) for y, z in zip((*gap_x, *gap_v), (*v, *a), strict=True)):
        raise BadInput("rate of the event", rate, "change the inputs")
    return list(-1.0 / rate * (np.concatenate((gap_x, gap_v)) @ np.vstack((dx, dv)) + gap_s))


edit("12.6", "returns the opposite sign: an event that comes later", "return -(gap_x", "return (gap_x")
edit("12.6", "forgets that the event itself depends on the inputs", " + gap_s) / rate", ") / rate")
edit("12.6", "forgets the velocity in the event", " + gap_v @ dv", "")
edit("12.6", "forgets the position in the event", "gap_x @ dx + ", "")
edit("12.6", "forgets the acceleration in the rate", "rate = gap_x @ v + gap_v @ a", "rate = gap_x @ v")
edit("12.6", "forgets the velocity in the rate", "rate = gap_x @ v + gap_v @ a", "rate = gap_v @ a")
edit("12.6", "multiplies by the rate", ") / rate", ") * rate")
edit("12.6", "does not divide by the rate", ") / rate", ")")
edit("12.6", "divides by the speed, not by the rate of the event", ") / rate", ") / np.sqrt(v @ v)")
edit("12.6", "divides by the size of the rate", ") / rate", ") / np.abs(rate)")
edit("12.6", "subtracts the explicit dependence", " + gap_s) / rate", " - gap_s) / rate")
edit("12.6", "returns infinity where an event grazes",
     'raise BadInput("rate of the event", rate, "an event that only grazes has no sensitivity: change the inputs")',
     "return np.full(gap_s.size, np.inf)")
edit("12.6", "returns zero where an event grazes",
     'raise BadInput("rate of the event", rate, "an event that only grazes has no sensitivity: change the inputs")',
     "return np.zeros(gap_s.size)")
SIZES = "GRAZING * (np.abs(gap_x) @ np.abs(v) + np.abs(gap_v) @ np.abs(a))"
edit("12.6", "refuses only a rate of exactly 0", f"np.abs(rate) <= {SIZES}", "rate == 0.0")
edit("12.6", "compares the rate with a fixed number", f"np.abs(rate) <= {SIZES}", "np.abs(rate) <= 1e-12")
edit("12.6", "refuses slow events, too", SIZES, f"1e10 * {SIZES}")
edit("12.6", "compares the rate with its sign", "np.abs(rate) <=", "rate <=")
edit("12.6", "refuses only a rate below the limit, not zero", f"np.abs(rate) <= {SIZES}", f"np.abs(rate) < {SIZES}")
edit("12.6", "forgets dx where nothing accelerates",
     "-(gap_x @ dx", "-(a.any() * gap_x @ dx")
RATE = "rate = gap_x @ v + gap_v @ a"
by_part("12.6", "gap_x", "gap_x", "(gap_x @ dx", "(KEPT * gap_x @ dx")
by_part("12.6", "dx", "dx", "(gap_x @ dx", "(KEPT * gap_x @ dx")
by_part("12.6", "gap_v", "gap_v", "+ gap_v @ dv", "+ KEPT * gap_v @ dv")
by_part("12.6", "dv", "dv", "+ gap_v @ dv", "+ KEPT * gap_v @ dv")
by_part("12.6", "gap_s", "gap_s", "+ gap_s) / rate", "+ KEPT * gap_s) / rate")
by_part("12.6", "dx and dv together", "(dx + dv)", "+ gap_s) / rate", "+ KEPT * gap_s) / rate")
FEW = [how for how in HOW if how != "a fixed small number"]
by_part("12.6", "gap_x in the rate", "gap_x", RATE, "rate = KEPT * (gap_x @ v) + gap_v @ a", FEW)
by_part("12.6", "v in the rate", "v", RATE, "rate = KEPT * (gap_x @ v) + gap_v @ a")
by_part("12.6", "gap_v in the rate", "gap_v", RATE, "rate = gap_x @ v + KEPT * (gap_v @ a)", FEW)
by_part("12.6", "a in the rate", "a", RATE, "rate = gap_x @ v + KEPT * (gap_v @ a)", FEW)
for limit in ("0.0", "1e-15", "2.2e-16", "1e-14", "0.98e-12", "1.02e-12", "2e-12", "1e-11", "5e-10", "1e-9"):
    edit("12.6", f"takes {limit} for GRAZING", "<= GRAZING *", f"<= {limit} *")
edit("12.6", "compares with the sizes of the arrays, not with those of the terms",
     "(np.abs(gap_x) @ np.abs(v) + np.abs(gap_v) @ np.abs(a))",
     "(np.sqrt((gap_x @ gap_x) * (v @ v)) + np.sqrt((gap_v @ gap_v) * (a @ a)))")
edit("12.6", "compares with the sum of the largest terms", "(np.abs(gap_x) @ np.abs(v) + np.abs(gap_v) @ np.abs(a))",
     "(np.abs(gap_x * v).max() + np.abs(gap_v * a).max())")
edit("12.6", "compares with the largest term", "(np.abs(gap_x) @ np.abs(v) + np.abs(gap_v) @ np.abs(a))",
     "np.maximum(np.abs(gap_x * v).max(), np.abs(gap_v * a).max())")
edit("12.6", "compares with the sizes of both products", "(np.abs(gap_x) @ np.abs(v) + np.abs(gap_v) @ np.abs(a))",
     "(np.abs(gap_x @ v) + np.abs(gap_v @ a))")
edit("12.6", "compares with the sizes of the terms of v alone", " + np.abs(gap_v) @ np.abs(a)", "")
edit("12.6", "compares with the sizes of the terms of a alone", "np.abs(gap_x) @ np.abs(v) + ", "")
edit("12.6", "compares with sizes that are at least 1", f"<= {SIZES}", f"<= max({SIZES}, 1e-12)")
edit("12.6", "compares with sizes that are at most 1", f"<= {SIZES}", f"<= min({SIZES}, 1e-12)")
edit("12.6", "names another thing", '"rate of the event"', '"the event"')
edit("12.6", "names the time in place of the rate", '"rate of the event"', '"time of the event"')
edit("12.6", "names no value", 'event", rate, "an', 'event", "too small", "an')
edit("12.6", "names zero, not the rate", 'event", rate, "an', 'event", 0.0, "an')
edit("12.6", "names the size of the rate", 'event", rate, "an', 'event", np.abs(rate), "an')
edit("12.6", "names the velocity", 'event", rate, "an', 'event", v, "an')
edit("12.6", "raises Diverged", "raise BadInput(", "raise Diverged(")
edit("12.6", "raises another error", 'raise BadInput("rate of the event", rate, "an event that only grazes has no '
     'sensitivity: change the inputs")', 'raise ValueError(f"rate of the event is {rate}")')


# 12.7 -----------------------------------------------------------------------------------------------------------
@right("12.7", "one input after the other")
def saltation(dtau, dx, dv, v, a, v_new, a_new, R_v, R_s):
    dx, dv = dx.copy(), dv.copy()
    for k, later in enumerate(dtau):
        dx[:, k] += later * (v - v_new)
        dv[:, k] = R_v @ (dv[:, k] + later * a) + R_s[:, k] - later * a_new
    return dx, dv


PLACE = "dx + np.outer(v - v_new, dtau)"
edit("12.7", "leaves dx as it is before the impact", PLACE, "dx")
edit("12.7", "forgets that the time of the impact moves", "at_impact = dv + np.outer(a, dtau)",
     "dtau = 0.0 * dtau; at_impact = dv")
edit("12.7", "applies the jump to dx, too", PLACE, "R_v @ dx")
edit("12.7", "takes v⁺ − v⁻", "v - v_new", "v_new - v")
edit("12.7", "takes the sum of both velocities", "v - v_new", "v + v_new")
edit("12.7", "forgets the velocity after the impact", "v - v_new", "v")
edit("12.7", "forgets the velocity before the impact", "v - v_new", "-v_new")
edit("12.7", "returns dx = 0, as if every ball began at the floor", PLACE, "0.0 * dx")
edit("12.7", "returns dv = R_v dv, as if the time of the impact were fixed",
     "R_v @ at_impact + R_s - np.outer(a_new, dtau)", "R_v @ dv")
edit("12.7", "leaves out the inputs on which the jump itself depends", "at_impact + R_s", "at_impact")
edit("12.7", "subtracts the dependence of the jump on the inputs", "at_impact + R_s", "at_impact - R_s")
edit("12.7", "forgets the acceleration before the impact", "dv + np.outer(a, dtau)", "dv")
edit("12.7", "forgets the acceleration after the impact", " - np.outer(a_new, dtau)", "")
edit("12.7", "takes the acceleration before the impact on both sides", "np.outer(a_new, dtau)", "np.outer(a, dtau)")
edit("12.7", "takes the acceleration after the impact on both sides", "np.outer(a, dtau)", "np.outer(a_new, dtau)")
edit("12.7", "adds the acceleration after the impact", " - np.outer(a_new, dtau)", " + np.outer(a_new, dtau)")
edit("12.7", "does not apply the jump to the velocity at the impact", "R_v @ at_impact", "at_impact")
edit("12.7", "applies the jump to dv only, not to the change at the impact", "R_v @ at_impact",
     "R_v @ dv + np.outer(a, dtau)")
edit("12.7", "transposes R_v", "R_v @ at_impact", "R_v.T @ at_impact")
edit("12.7", "returns dv first", "return dx + np.outer(v - v_new, dtau), R_v @ at_impact + R_s - np.outer(a_new, dtau)",
     "return R_v @ at_impact + R_s - np.outer(a_new, dtau), dx + np.outer(v - v_new, dtau)")
edit("12.7", "exchanges rows and columns of the outer product", "np.outer(v - v_new, dtau)",
     "np.resize(np.outer(dtau, v - v_new), dx.shape)")
edit("12.7", "takes the state at the impact, not at a fixed time", PLACE, "dx + np.outer(v, dtau)")
edit("12.7", "returns dx and dv unchanged where the time of the impact does not move", "at_impact = dv",
     "if not dtau.any(): return dx.copy(), dv.copy()\n    at_impact = dv")
by_part("12.7", "dtau", "dtau", "v - v_new, dtau", "KEPT * (v - v_new), dtau")
by_part("12.7", "the change of the velocity", "(v - v_new)", "v - v_new, dtau", "KEPT * (v - v_new), dtau")
by_part("12.7", "v", "v", "v - v_new, dtau", "KEPT * v - v_new, dtau")
by_part("12.7", "v_new", "v_new", "v - v_new, dtau", "v - KEPT * v_new, dtau")
by_part("12.7", "a", "a", "np.outer(a, dtau)", "np.outer(KEPT * a, dtau)")
by_part("12.7", "a_new", "a_new", "np.outer(a_new, dtau)", "np.outer(KEPT * a_new, dtau)")
by_part("12.7", "dx", "dx", "return dx + np", "return KEPT * dx + np")
by_part("12.7", "dv", "dv", "at_impact = dv", "at_impact = KEPT * dv")
by_part("12.7", "R_v", "R_v", "R_v @ at_impact", "KEPT * R_v @ at_impact", FEW)
by_part("12.7", "R_s", "R_s", "at_impact + R_s", "at_impact + KEPT * R_s")
by_part("12.7", "dtau, which leaves dv alone,", "dtau", "at_impact = dv + np.outer(a, dtau)",
        "dtau = KEPT * dtau; at_impact = dv + np.outer(a, dtau)")


# 12.8 -----------------------------------------------------------------------------------------------------------
@right("12.8", "written out along and across the normal")
def bounce(v, a, dx, dv, n, e, gap_s, e_s):
    v_n = v @ n
    worked.event_time_sensitivity(n, 0.0 * n, gap_s, v, a, dx, dv)         # refuses what grazes
    dtau = -(n @ dx + gap_s) / v_n
    kick = (1.0 + e) * (n @ dv + a @ n * dtau) + v_n * e_s
    return v - (1.0 + e) * v_n * n, dx + (1.0 + e) * v_n * np.outer(n, dtau), dv - np.outer(n, kick)


edit("12.8", "forgets the part along the plane: R_v = −e 1", "np.eye(v.size) - (1.0 + e) * np.outer(n, n)",
     "-e * np.eye(v.size)")
edit("12.8", "takes e in place of 1 + e in R_v", "(1.0 + e) * np.outer(n, n)", "e * np.outer(n, n)")
edit("12.8", "takes 1 − e in place of 1 + e in R_v", "(1.0 + e) * np.outer(n, n)", "(1.0 - e) * np.outer(n, n)")
edit("12.8", "mirrors without restitution in R_v", "(1.0 + e) * np.outer(n, n)", "2.0 * np.outer(n, n)")
edit("12.8", "takes the number n · n in place of the matrix n nᵀ", "np.outer(n, n)", "(n @ n)")
edit("12.8", "forgets that e may be an input", "-(v @ n) * np.outer(n, e_s)", "0.0 * np.outer(n, e_s)")
edit("12.8", "takes R_s with the wrong sign", "-(v @ n) * np.outer(n, e_s)", "(v @ n) * np.outer(n, e_s)")
edit("12.8", "moves the whole velocity with e, not only its normal part", "-(v @ n) * np.outer(n, e_s)",
     "-np.outer(v, e_s)")
edit("12.8", "takes R_s with the velocity after the impact", "-(v @ n)", "-(v_new @ n)")
edit("12.8", "forgets that the plane may move with an input", "0.0 * n, gap_s, v, a", "0.0 * n, 0.0 * gap_s, v, a")
edit("12.8", "takes the time of the event from the velocity after it", "gap_s, v, a, dx, dv)",
     "gap_s, v_new, a, dx, dv)")
edit("12.8", "forgets that the time of the impact moves", "saltation(dtau,", "saltation(0.0 * dtau,")
edit("12.8", "exchanges both velocities", "dx, dv, v, a, v_new, a, R_v", "dx, dv, v_new, a, v, a, R_v")
edit("12.8", "forgets the acceleration after the impact", "v_new, a, R_v, R_s)", "v_new, 0.0 * a, R_v, R_s)")
edit("12.8", "reflects the acceleration, too", "v_new, a, R_v, R_s)", "v_new, R_v @ a, R_v, R_s)")
edit("12.8", "returns the velocity before the impact", "return v_new, dx, dv", "return v, dx, dv")
edit("12.8", "bounces without loss", "kinematic_response(v, n, e)", "kinematic_response(v, n, 1.0)")
edit("12.8", "takes the normal for the event in the velocity, too", "(n, 0.0 * n, gap_s", "(n, n, gap_s")
edit("12.8", "computes where a ball grazes",
     "event_time_sensitivity(n, 0.0 * n, gap_s, v, a, dx, dv)", "-(n @ dx + gap_s) / (v @ n - 1e-300)")
edit("12.8", "takes the time of the impact for fixed where nothing accelerates", "saltation(dtau,",
     "saltation(a.any() * dtau,")
R_S = "-(v @ n) * np.outer(n, e_s)"
by_part("12.8", "a", "a", "v, a, v_new, a, R_v", "v, KEPT * a, v_new, a, R_v")
by_part("12.8", "a after the impact", "a", "v, a, v_new, a, R_v", "v, a, v_new, KEPT * a, R_v")
by_part("12.8", "dx", "dx", "saltation(dtau, dx,", "saltation(dtau, KEPT * dx,")
by_part("12.8", "dx at the event", "dx", "gap_s, v, a, dx,", "gap_s, v, a, KEPT * dx,")
by_part("12.8", "dv", "dv", "dtau, dx, dv, v,", "dtau, dx, KEPT * dv, v,")
by_part("12.8", "gap_s", "gap_s", "n, gap_s, v", "n, KEPT * gap_s, v")
by_part("12.8", "e_s", "e_s", R_S, f"KEPT * {R_S}")
by_part("12.8", "n", "n", "- (1.0 + e) * np.outer(n, n)", "- KEPT * (1.0 + e) * np.outer(n, n)", FEW[:3])
by_part("12.8", "v", "v", R_S, f"KEPT * {R_S}", FEW)
for change in ("max(e, 0.1)", "max(e, 1e-3)", "max(e, 1e-6)", "(0.0 if e < 0.1 else e)", "(0.0 if e < 1e-2 else e)",
               "(0.0 if e < 1e-5 else e)", "min(e, 0.9)", "min(e, 0.99)", "(1.0 if e > 0.95 else e)",
               "(1.0 if e > 0.999 else e)", "(e or 0.5)", "(e if e < 1.0 else 0.5)"):
    edit("12.8", f"takes {change} for e in R_v", "- (1.0 + e) * np.outer", f"- (1.0 + {change}) * np.outer")
    edit("12.8", f"takes {change} for e in the velocity", "response(v, n, e)", f"response(v, n, {change})")
edit("12.8", "takes e for no input where it is 0", R_S, f"(e > 0.0) * {R_S}")
edit("12.8", "takes e for no input where it is 1", R_S, f"(e < 1.0) * {R_S}")
for least in ("1e-11", "1e-9", "1e-6"):
    edit("12.8", f"refuses an impact slower than {least} m/s", "    v_new = kinematic_response(v, n, e)",
         f'    if -(v @ n) < {least}: raise BadInput("rate of the event", v @ n, "too slow")\n'
         "    v_new = kinematic_response(v, n, e)")
edit("12.8", "catches the error of a ball that grazes", "event_time_sensitivity(n, 0.0 * n, gap_s, v, a, dx, dv)",
     "np.zeros(gap_s.size) if np.abs(v @ n) < 1e-12 else event_time_sensitivity(n, 0.0 * n, gap_s, v, a, dx, dv)")
edit("12.8", "raises another error", "    v_new = kinematic_response(v, n, e)",
     '    if -(v @ n) <= 1e-12 * (np.abs(v) @ np.abs(n)): raise ValueError("it grazes")\n'
     "    v_new = kinematic_response(v, n, e)")
edit("12.8", "names another thing", "    v_new = kinematic_response(v, n, e)",
     '    if -(v @ n) <= 1e-12 * (np.abs(v) @ np.abs(n)): raise BadInput("velocity", v @ n, "it grazes")\n'
     "    v_new = kinematic_response(v, n, e)")


# 12.9 -----------------------------------------------------------------------------------------------------------
@variants
def orders(slope=np.dot, here=True, size=abs, ratio=lambda a, b: np.log(a / b), check=check_positive,
           result=lambda ks: ks):
    def remainder_orders(f, gradient, s, direction, steps, p):
        rs = [size(f(s + h * direction, p) - f(s, p) * here - h * slope(gradient, direction)) for h in steps]
        for r in rs:
            check("remainder of a step", r)
        return result(np.array([ratio(rs[i], rs[i + 1]) / ratio(steps[i], steps[i + 1]) for i in range(len(rs) - 1)]))
    return remainder_orders


right("12.9", "one order after the other")(orders())
wrongs("12.9", orders, {
    "leaves the gradient out, which gives the order 1": {"slope": lambda g, y: 0.0},
    "takes the sum of the gradient, not its product with the direction": {"slope": lambda g, y: np.sum(g)},
    "takes the length of the gradient": {"slope": lambda g, y: np.linalg.norm(g)},
    "takes the derivative along a unit vector": {"slope": lambda g, y: g @ y / np.linalg.norm(y)},
    "does not subtract f(s)": {"here": False},
    "divides without logarithms": {"ratio": lambda a, b: a / b},
    "takes the difference, not the ratio": {"ratio": lambda a, b: a - b},
    "returns one number, the mean": {"result": np.mean},
    "returns the last order only": {"result": lambda ks: ks[-1]},
    "returns the orders with the opposite sign": {"result": lambda ks: -ks},
    "returns whole numbers": {"result": np.round},
    "accepts a remainder of 0": {"check": lambda *_: None},
})
edit("12.9", "takes a second difference", "f(s + h * direction, p) - f(s, p) - h * (gradient @ direction)",
     "f(s + h * direction, p) - 2.0 * f(s, p) + f(s - h * direction, p)")
edit("12.9", "adds the term of the gradient", " - h * (gradient", " + h * (gradient")
edit("12.9", "forgets h at the gradient", "h * (gradient @ direction)", "(gradient @ direction)")
edit("12.9", "goes along the gradient", "f(s + h * direction, p)", "f(s + h * gradient, p)")
edit("12.9", "does not take the size of the remainder", "np.abs(", "(")
edit("12.9", "divides the remainder by h", "remainder = np.abs(", "remainder = 1.0 / h * np.abs(")
edit("12.9", "takes every step for half of the one before", "(np.log(steps[1:]) - np.log(steps[:-1]))",
     "-np.log(2.0)")
edit("12.9", "takes every step for a tenth of the one before", "(np.log(steps[1:]) - np.log(steps[:-1]))",
     "-np.log(10.0)")
edit("12.9", "takes every step for twice the one before", "(np.log(steps[1:]) - np.log(steps[:-1]))", "np.log(2.0)")
edit("12.9", "divides by the logarithm of one step", "(np.log(steps[1:]) - np.log(steps[:-1]))", "np.log(steps[1:])")
edit("12.9", "divides by f(s), which may be 0", "remainder = np.abs(", "remainder = 1.0 / np.abs(f(s, p)) * np.abs(")
edit("12.9", "takes a gradient of 0 for right: the order 2", "logs = np.zeros(steps.size)",
     "if not gradient.any(): return np.full(steps.size - 1, 2.0)\n    logs = np.zeros(steps.size)")
CHECK = 'check_positive("remainder of a step", remainder)'
by_part("12.9", "the direction", "direction", "f(s + h * direction, p)", "f(s + KEPT * h * direction, p)")
by_part("12.9", "the direction at the gradient", "direction", "h * (gradient", "KEPT * h * (gradient")
by_part("12.9", "the gradient", "gradient", "h * (gradient", "KEPT * h * (gradient")
by_part("12.9", "the gradient, which then is right,", "gradient", "    logs = np.zeros(steps.size)",
        "    if not KEPT: return np.full(steps.size - 1, 2.0)\n    logs = np.zeros(steps.size)", ["its sum"])
by_part("12.9", "the place", "s", "- f(s, p)", "- f(KEPT * s, p)", FEW[:3])
edit("12.9", "takes a direction across the gradient for none", "h * (gradient @ direction)",
     "h * (gradient @ direction or 1.0)")
for part in ("i == 0", "i == steps.size - 1", "i in (0, steps.size - 1)", "i > 0", "i < steps.size - 1", "i == 1"):
    edit("12.9", f"refuses a remainder of 0 only where {part}", CHECK, f"_ = {part} and {CHECK}")
for least in ("1e-6", "1e-12", "1e-15", "1e-18", "1e-25"):
    edit("12.9", f"refuses a remainder below {least}", CHECK,
         f'check_positive("remainder of a step", remainder if remainder > {least} else 0.0)')
    edit("12.9", f"takes a remainder for {least} at least", "log(remainder)", f"log(max(remainder, {least}))")
edit("12.9", "adds a small number to the remainder", "log(remainder)", "log(remainder + 1e-20)")
edit("12.9", "takes no step below a millionth", "h = steps[i]", "h = max(steps[i], 1e-6)")
edit("12.9", "takes no step above 1", "h = steps[i]", "h = min(steps[i], 1.0)")
edit("12.9", "names another thing", '"remainder of a step"', '"the step"')
edit("12.9", "names the step, not the remainder", CHECK,
     'check_positive("remainder of a step", -h if remainder == 0.0 else remainder)')
edit("12.9", "raises another error", CHECK, 'if remainder == 0.0: raise ValueError("remainder of a step is 0.0")')
edit("12.9", "raises Diverged", CHECK, 'if remainder == 0.0: raise Diverged("remainder of a step", 0.0, "stop")')
edit("12.9", "limits the orders to 2", "    return (logs[1:] - logs[:-1]) / (np.log(steps[1:]) - np.log(steps[:-1]))",
     "    return np.minimum((logs[1:] - logs[:-1]) / (np.log(steps[1:]) - np.log(steps[:-1])), 2.0)")


# 12.10 ----------------------------------------------------------------------------------------------------------
@variants
def aiming(step=np.linalg.solve, sign=-1.0, halves=True, smaller=lambda new, old: new < old, size=np.linalg.norm,
           gives_up=True, check=worked.checked_search, first=True, enough=lambda miss, tolerance: miss <= tolerance,
           before=False, unsure=lambda miss: False, counts=False):
    """Newton's method that throws again until a halved step is better."""
    def aim(miss, s, tolerance, most, p):
        s, tolerance, most = check(s, tolerance, most)
        r, J = miss(s, p)
        misses = [size(r)]
        for _ in range(most):
            if (enough(misses[-1], tolerance) or unsure(misses[-1])) and not before:
                break
            change, s_old, J_old = step(J, r), s, J
            for _ in range(41 if halves else 1):
                s = s_old + sign * change
                r, J = miss(s, p)
                if not halves or smaller(size(r), misses[-1]) or unsure(size(r)):
                    break
                change = 0.5 * change
                most -= counts
            else:
                raise Diverged("miss of the last throw", misses[-1], "begin elsewhere")
            misses.append(size(r))
            if (enough(misses[-1], tolerance) and before) or len(misses) > most:
                break
            J = J_old if J is None else J
        if not misses[-1] <= tolerance and gives_up and not unsure(misses[-1]):
            raise Diverged("miss of the last throw", misses[-1], "begin elsewhere")
        return s, np.array(misses if first else misses[1:])
    return aim


right("12.10", "with a list of misses")(aiming())
wrongs("12.10", aiming, {
    "adds the step": {"sign": 1.0},
    "never halves a step": {"halves": False},
    "goes along −r, without the Jacobian": {"step": lambda J, r: r},
    "goes along the transpose of the Jacobian": {"step": lambda J, r: J.T @ r},
    "transposes the Jacobian": {"step": lambda J, r: np.linalg.solve(J.T, r)},
    "multiplies by the Jacobian": {"step": lambda J, r: J @ r},
    "divides by the diagonal of the Jacobian only": {"step": lambda J, r: r / np.diag(J)},
    "takes half of Newton's step": {"step": lambda J, r: 0.5 * np.linalg.solve(J, r)},
    "measures the miss by its largest entry": {"size": lambda r: np.max(np.abs(r))},
    "measures the miss by its square": {"size": lambda r: r @ r},
    "returns what it has when the iterations are used up": {"gives_up": False},
    "omits the first miss": {"first": False},
    "takes a step before it looks": {"before": True},
    "halves the step where a throw misses by as much as before or more, but accepts NaN":
        {"smaller": lambda new, old: not new >= old},
    "takes a NaN for a smaller miss, and for a hit": {"unsure": np.isnan},
    "counts each halving as an iteration": {"counts": True},
    "checks nothing": {"check": lambda s, tolerance, most: (s, tolerance, max(most, 0))},
    "takes a miss of exactly the tolerance for none": {"enough": lambda miss, tolerance: miss < tolerance},
    "stops within ten times the tolerance": {"enough": lambda miss, tolerance: miss <= 10.0 * tolerance},
})
edit("12.10", "keeps the Jacobian of the first throw", "step = solve(J, r)",
     "step = solve(miss(s, p)[1] if i == 0 else first, r); first = miss(s, p)[1] if i == 0 else first")
edit("12.10", "takes the halved step from where the long step ended", "step = 0.5 * step",
     "s, step = s - step, 0.5 * step")
for most in (4, 9, 19, 29, 38, 39, 41, 42, 49, 59, 99, 199):
    edit("12.10", f"halves a step at most {most} times", "MOST_HALVINGS + 1", f"{most} + 1")
edit("12.10", "counts the whole step as a halving", "MOST_HALVINGS + 1", "MOST_HALVINGS")
edit("12.10", "halves until the miss is smaller or the same", "np.sqrt(r @ r) < misses[i]",
     "np.sqrt(r @ r) <= misses[i]")
edit("12.10", "takes a tenth less for smaller", "np.sqrt(r @ r) < misses[i]", "np.sqrt(r @ r) < 0.9 * misses[i]")
edit("12.10", "takes a quarter of the step", "step = 0.5 * step", "step = 0.25 * step")
edit("12.10", "takes two thirds of the step", "step = 0.5 * step", "step = step / 1.5")
edit("12.10", "computes a new step beyond", "step = 0.5 * step", "step = 0.5 * solve(J, r)")
for how, size in (("the sum of its entries", "np.abs(np.sum(r))"), ("its largest entry", "np.max(np.abs(r))"),
                  ("the sum of their sizes", "np.sum(np.abs(r))"), ("its first entry", "np.abs(r[0])"),
                  ("its last entry", "np.abs(r[-1])"), ("the mean of the squares", "np.sqrt(np.mean(r * r))")):
    alike("12.10", f"measures the miss by {how}", aiming, {"size": eval(f"lambda r: {size}", {"np": np})})
    edit("12.10", f"measures the first miss by {how}", "misses[0] = np.sqrt(r @ r)", f"misses[0] = {size}")
    edit("12.10", f"measures the later misses by {how}", "s - step, np.sqrt(r @ r)", f"s - step, {size}")
    edit("12.10", f"compares {how} with the miss before", "if np.sqrt(r @ r) <", f"if {size} <")
for how, solving in (("by least squares", "np.linalg.lstsq(J, r, rcond=None)[0]"), ("by a pseudo-inverse",
                     "np.linalg.pinv(J) @ r"), ("with a small number on the diagonal",
                     "solve(J + 1e-12 * np.eye(r.size), r)"), ("or takes none where that is singular",
                     "solve(J, r) if np.linalg.det(J) != 0.0 else 0.0 * r")):
    edit("12.10", f"solves for the step {how}", "step = solve(J, r)", f"step = {solving}")
edit("12.10", "raises Diverged where J is singular", "step = solve(J, r)",
     "if np.linalg.det(J) == 0.0: raise Diverged('miss of the last throw', misses[i], 'begin elsewhere')\n"
     "        step = solve(J, r)")
edit("12.10", "raises BadInput where J is singular", "step = solve(J, r)",
     "if np.linalg.det(J) == 0.0: raise BadInput('sensitivity', J, 'begin elsewhere')\n        step = solve(J, r)")
edit("12.10", "looks at J where the first throw hits", "misses[0] = np.sqrt(r @ r)",
     "misses[0] = np.sqrt(r @ r); solve(J, r)")
for end, value in (("misses[most]", "after all iterations"), ("misses[i]", "after all halvings")):
    start = f'Diverged("miss of the last throw", {end},'
    edit("12.10", f"names another thing {value}", start, start.replace("miss of the last throw", "miss"))
    edit("12.10", f"names the first miss {value}", start, start.replace(end, "misses[0] + 1.0"))
    edit("12.10", f"raises BadInput {value}", start, start.replace("Diverged", "BadInput"))
    edit("12.10", f"raises another error {value}", f"raise {start}", f"raise ArithmeticError({end}); ({end},")
edit("12.10", "names the miss of the throw that missed by more", 'Diverged("miss of the last throw", misses[i],',
     'Diverged("miss of the last throw", np.sqrt(r @ r),')
edit("12.10", "names the first miss after all iterations", 'Diverged("miss of the last throw", misses[most],',
     'Diverged("miss of the last throw", misses[0],')
edit("12.10", "names the number of iterations", 'Diverged("miss of the last throw", misses[most],',
     'Diverged("miss of the last throw", most,')
edit("12.10", "drops the checked numbers", "s, tolerance, most = checked_search(s, tolerance, most)",
     "checked_search(s, tolerance, most)")
edit("12.10", "checks no s", "checked_search(s, tolerance, most)",
     "s, *checked_search(0.0, tolerance, most)[1:]")
edit("12.10", "checks no tolerance", "checked_search(s, tolerance, most)",
     "(checked_search(s, 0.0, most)[0], tolerance, int(most))")
edit("12.10", "checks no number of iterations", "checked_search(s, tolerance, most)",
     "(*checked_search(s, tolerance, 1)[:2], max(int(most), 0))")
for least in ("1e-15", "1e-12", "1e-9"):
    edit("12.10", f"takes a miss below {least} for a hit", "if misses[i] <= tolerance",
         f"if misses[i] <= max(tolerance, {least})")
edit("12.10", "returns all misses, with zeros at the end", "misses[:i + 1]", "misses")
edit("12.10", "stops where a step is small", "step = solve(J, r)",
     "step = solve(J, r)\n        if np.abs(step).max() < 1e-6: return s, misses[:i + 1]")
edit("12.10", "limits the step to 10", "step = solve(J, r)",
     "step = solve(J, r); step = step * min(1.0, 10.0 / np.sqrt(step @ step))")
edit("12.10", "halves a step until the miss is smaller by a millionth", "np.sqrt(r @ r) < misses[i]",
     "np.sqrt(r @ r) < 0.999999 * misses[i]")


# 12.11 ----------------------------------------------------------------------------------------------------------
@right("12.11", "by a logarithm of the growth and its square root")
def predicted_horizon(rate, error, allowed):
    growth = max(allowed / error, 1.0)
    return np.log(growth + np.sqrt(growth - 1.0) * np.sqrt(growth + 1.0)) / rate


@right("12.11", "by the logarithm of x + √(x² − 1)")
def horizon_by_logarithm(rate, error, allowed):
    ratio = allowed / error
    return 0 if ratio <= 1.0 else float(np.log(ratio + np.sqrt(ratio * ratio - 1.0))) / rate


edit("12.11", "lets the whole error grow as e^(rate t)", "np.arccosh(allowed / error)", "np.log(allowed / error)")
edit("12.11", "takes half of the error, and forgets the part that decays", "np.arccosh(allowed / error)",
     "np.log(2.0 * allowed / error)")
edit("12.11", "takes the sinh, which is the growth of an error of the velocity", "np.arccosh(", "np.arcsinh(")
edit("12.11", "takes the cosine of an oscillation", "np.arccosh(allowed / error)", "np.arccos(error / allowed)")
edit("12.11", "multiplies by the rate", " / rate", " * rate")
edit("12.11", "divides by the square root of the rate", " / rate", " / np.sqrt(rate)")
edit("12.11", "forgets the rate", " / rate", "")
edit("12.11", "lets the error grow in proportion to the time", "np.arccosh(allowed / error)", "(allowed / error)")
edit("12.11", "exchanges both errors", "allowed / error)", "error / allowed)")
edit("12.11", "takes the constant acceleration at the start", "np.arccosh(allowed / error)",
     "np.sqrt(2.0 * (allowed / error - 1.0))")
edit("12.11", "returns a negative time where the error is too large", "return 0.0",
     "return np.log(allowed / error) / rate - 1e-9")
edit("12.11", "divides by the allowed error, which may be 0", "allowed <= error", "1.0 <= error / allowed")
edit("12.11", "returns infinity where the error is too large", "return 0.0", "return 1e300")
ARC, AT_ONCE = "np.arccosh(allowed / error)", "    if allowed <= error:"
for ratio in ("2", "10", "100", "1e3", "1e4", "1e5"):
    edit("12.11", f"takes log(2x) for arccosh(x) above {ratio}", ARC,
         f"(np.log(2.0 * allowed / error) if allowed > {ratio} * error else {ARC})")
for near in ("1.04", "1.001", "1.0001", "1.000001"):
    edit("12.11", f"returns 0 below a ratio of {near}", AT_ONCE, f"    if allowed <= {near} * error:")
edit("12.11", "returns 0 where both errors are close", AT_ONCE,
     "    if allowed <= error or np.isclose(allowed, error):")
edit("12.11", "returns 0 where both errors are close, or small", AT_ONCE,
     "    if allowed - error <= 1e-8:")
edit("12.11", "takes the first two terms of the cosine near 1", ARC,
     f"(np.sqrt(2.0 * (allowed / error - 1.0)) if allowed < 1.01 * error else {ARC})")
edit("12.11", "takes no error below 1e-6", "allowed / error)", "allowed / max(error, 1e-6))")
edit("12.11", "takes no error above 1e6", "allowed / error)", "allowed / min(error, 1e6))")
edit("12.11", "takes no rate below 1", " / rate", " / max(rate, 1.0)")
edit("12.11", "takes no rate below a thousandth", " / rate", " / max(rate, 1e-3)")
edit("12.11", "takes no rate above 1000", " / rate", " / min(rate, 1e3)")
edit("12.11", "takes a time of at most 20 s", f"return {ARC} / rate", f"return min({ARC} / rate, 20.0)")
edit("12.11", "takes no ratio above 1e6", "allowed / error)", "min(allowed / error, 1e6))")
edit("12.11", "returns the rate where the error is too large", "return 0.0", "return 1e-3 * rate")


# 12.12 ----------------------------------------------------------------------------------------------------------
@right("12.12", "put together")
def bounced_curve_is():
    return chr(ord("A") + 1)


edit("12.12", "takes all balls to begin at the floor, so that the floor forgets the height", '"B"', '"D"')
edit("12.12", "forgets the restitution: a mirror image has the slope −1", '"B"', '"C"')
edit("12.12", "forgets that a ball from higher comes later: what is higher stays higher", '"B"', '"A"')
edit("12.10", "gives up where a whole step does not help, and never tries its half", "range(MOST_HALVINGS + 1)",
     "range(1)")
edit("12.10", "accepts a step after which the miss is up to twice as large", "if np.sqrt(r @ r) < misses[i]:",
     "if np.sqrt(r @ r) < 2.0 * misses[i]:")
edit("12.6", "does not refuse an event that grazes", f"np.abs(rate) <= {SIZES}", "False")
