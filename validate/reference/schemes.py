"""Every method of lesson 1 in an independent form, as a table of numbers, and the error that such a table predicts.

A partitioned Runge–Kutta method has stages i and the weights of its result:

    Xᵢ = x + h Σⱼ αᵢⱼ Vⱼ      Vᵢ = v + h Σⱼ βᵢⱼ Aⱼ      Aᵢ = a(t + cᵢ h, Xᵢ, Vᵢ)
    x ← x + h Σᵢ aᵢ Vᵢ        v ← v + h Σᵢ bᵢ Aᵢ

One loop runs all of them, with forces of validate/reference.  Nothing here is shared with `solutions`.
*Source:* Hairer, Lubich, Wanner 2006, II.1 (Runge–Kutta) and II.2 (partitioned).
"""

from collections.abc import Callable
from functools import cache
from typing import NamedTuple

import numpy as np

from ..scene import ROUND_OFF, Prediction

MOST_ITERATIONS = 200        # of an implicit stage: h times the fastest rate must be well below 1
CLOSE = 1e-5                 # allowed difference of a run from the same table's error at the same step [-]
EXPANDED = 0.01              # and from its expansion, in addition to what the expansion misses [-]
SAFETY = 2.0                 # factor on what an expansion misses in its own check [-]
UNSURE = 0.1                 # if an expansion misses its own check by more, it needs finer runs [-]
MOST_DOUBLINGS = 3
NUDGE = 1e-13                # of a start, relative to what is observed [-]
LARGE = 1e-3                 # a run with a larger error may amplify round-off [-]
PREDICTABLE = 0.1            # larger errors, relative to the truth, are not predicted [-]
FINEST = {1: 800, 2: 400, 4: 200}    # steps that the table is run with, by its order: errors clear of round-off


class Tableau(NamedTuple):
    """A method.  Rows are tuples of (stage, weight)."""
    order: int
    c: tuple
    alpha: tuple             # of the stages' positions
    beta: tuple              # of the stages' velocities
    a: tuple                 # of the new position
    b: tuple                 # of the new velocity


def both(order, c, rows, weights):
    """Return the Tableau of an ordinary Runge–Kutta method, with the same weights for position and velocity."""
    return Tableau(order, c, rows, rows, weights, weights)


def kicks_and_drifts(order, kicks, drifts):
    """Return the Tableau of alternating kicks and drifts.  Stage 2i is before kick i, stage 2i + 1 after it."""
    c, alpha, beta, moved, pushed, t = [], [], [], (), (), 0.0
    for i, (kick, drift) in enumerate(zip(kicks, (*drifts, 0.0), strict=True)):
        c += [t, t]
        alpha += [moved, moved]
        beta += [pushed, (*pushed, (2 * i, kick))]
        pushed, moved, t = beta[-1], (*moved, (2 * i + 1, drift)), t + drift
    return Tableau(order, tuple(c), tuple(alpha), tuple(beta), moved, pushed)


B = (0.0829844064174052, 0.396309801498368, -0.0390563049223486)     # Blanes and Moan 2002, table 3, order 4
A = (0.245298957184271, 0.604872665711080)
END = ((0, 1.0),)

EULER = both(1, (0.0,), ((),), END)
MIDPOINT = both(2, (0.0, 0.5), ((), ((0, 0.5),)), ((1, 1.0),))
RK4 = both(4, (0.0, 0.5, 0.5, 1.0), ((), ((0, 0.5),), ((1, 0.5),), ((2, 1.0),)),
           ((0, 1 / 6), (1, 1 / 3), (2, 1 / 3), (3, 1 / 6)))
AVERAGE_VELOCITY = Tableau(1, (0.0, 1.0), ((), ()), ((), END), ((0, 0.5), (1, 0.5)), END)
SYMPLECTIC_EULER = Tableau(1, (0.0, 1.0), ((), ()), ((), END), ((1, 1.0),), END)
VERLET = Tableau(2, (0.0, 1.0), ((), ((0, 0.5), (1, 0.5))), ((), END), ((0, 0.5), (1, 0.5)), ((0, 0.5), (1, 0.5)))
IMPLICIT_EULER = both(1, (1.0,), (END,), END)
IMPLICIT_MIDPOINT = both(2, (0.5,), (((0, 0.5),),), END)
BLANES_MOAN = kicks_and_drifts(4, (*B, 1.0 - 2.0 * sum(B), *B[::-1]), (*A, 0.5 - sum(A), 0.5 - sum(A), *A[::-1]))
# what engines do: the force from the state before the step, or from the new position and the old velocity
OLD_VELOCITY_OLD_FORCE = EULER
NEW_VELOCITY_OLD_FORCE = SYMPLECTIC_EULER
OLD_VELOCITY_NEW_FORCE = Tableau(1, (0.0, 1.0), ((), END), ((), ()), END, ((1, 1.0),))


def weighted(weights, values):
    total = 0.0
    for stage, weight in weights:
        total += weight * values[stage]
    return total


def stages(tableau):
    """Return [(c, row of α, row of β, weight of the stage itself or None, whether its acceleration is used)]."""
    used = {stage for row in (*tableau.beta, tableau.b) for stage, _ in row}
    return [(c, alpha, beta, dict(beta).get(i), i in used)
            for i, (c, alpha, beta) in enumerate(zip(tableau.c, tableau.alpha, tableau.beta, strict=True))]


def step_of(tableau):
    """Return the function (law, t, x, v, h) → (x, v) of one step; x and v are floats, complex numbers or arrays."""
    rows, a, b = stages(tableau), tableau.a, tableau.b

    def step(law, t, x, v, h):
        V, forces = [], []
        for c, alpha, beta, itself, used in rows:
            if itself is None:
                V.append(v + h * weighted(beta, forces) if beta else v)
                forces.append(law(t + c * h, x + h * weighted(alpha, V) if alpha else x, V[-1]) if used else None)
            else:
                for stage, one in zip((V, forces), implicit_stage(law, t + c * h, x, v, itself * h), strict=True):
                    stage.append(one)
        return x + h * weighted(a, V), v + h * weighted(b, forces)
    return step


def implicit_stage(law, t, x, v, h):
    """Return V = v + h a(t, x + h V, V) and that acceleration, by fixed-point iteration.

    Raises ArithmeticError if it does not converge.
    """
    V = v
    for _ in range(MOST_ITERATIONS):
        force = law(t, x + h * V, V)
        last, V = V, v + h * force
        if np.all(abs(V - last) <= 4.0 * ROUND_OFF * (abs(V) if np.isscalar(V) else np.max(abs(V)))):
            return V, force
    raise ArithmeticError("the stage did not converge")


def advance(scheme, law, x, v, h, steps):
    """Return (x, v) after this number of steps.  A scheme is a Tableau, or a function like those of `step_of`."""
    move = scheme if callable(scheme) else step_of(scheme)
    with np.errstate(all="ignore"):
        for n in range(steps):
            x, v = move(law, n * h, x, v, h)
    return x, v


def advance_modes(scheme, law, x, v, h, steps):
    """Return the same for a law −ω² x − c v of each coordinate on its own, by powers of the (2, 2) matrix of a step."""
    one, none = np.ones_like(x), np.zeros_like(x)
    with np.errstate(all="ignore"):
        columns = [np.stack(advance(scheme, law, *begin, h, 1), axis=-1) for begin in ((one, none), (none, one))]
        after = np.linalg.matrix_power(np.stack(columns, axis=-1), steps) @ np.stack((x, v), axis=-1)[..., None]
    return after[..., 0, 0], after[..., 1, 0]


def advance_linear(scheme, law, x, v, h, steps):
    """Return the same for a law that is linear in x and v and the same at all times, by powers of the matrix of a step.

    A last column holds what a step makes of rest in the origin, as weight does.
    """
    shape, n = np.shape(x), np.size(x)

    def after(y):
        moved = advance(scheme, law, y[:n].reshape(shape), y[n:].reshape(shape), h, 1)
        return np.concatenate([np.ravel(part) for part in moved])

    with np.errstate(all="ignore"):
        added = after(np.zeros(2 * n, np.result_type(x, v, float)))
        columns = [after(unit) - added for unit in np.eye(2 * n, dtype=added.dtype)]
        one = np.eye(2 * n + 1, dtype=added.dtype)
        one[:-1] = np.stack((*columns, added), axis=1)
        end = np.linalg.matrix_power(one, steps)[:-1] @ np.concatenate((np.ravel(x), np.ravel(v), [1.0]))
    return end[:n].reshape(shape), end[n:].reshape(shape)


class ErrorLaw:
    """The error of a method as a function of its step, from a few coarse runs of the same method's table.

    It is exact to round-off as long as the table is run with the same number of steps, up to `finest`.  For more
    steps it is an expansion of three terms, such as  e(h) = C hᵏ + D hᵏ⁺¹ + E hᵏ⁺²,  through the three finest runs
    of the table.  Its uncertainty is the amount by which the expansion through the three runs before misses the
    finest one.
    *Source:* Hairer, Nørsett, Wanner 1993, II.8: the error of a one-step method has an expansion in powers of h.
    """

    def __init__(self, run, law, powers, T, finest, doublings=MOST_DOUBLINGS):
        """Store run(steps, nudge) → what is observed at T.

        nudge [m] moves the start; doublings: how often `finest` may double.
        """
        self.run, self.law, self.T, self.known, self.doublings = run, law, T, {}, doublings
        self.powers = np.array(powers if isinstance(powers, tuple) else (powers, powers + 1, powers + 2))
        self.size = np.linalg.norm(law) or 1.0
        self.finest = max(finest // 8, 1) * 8

    def error(self, steps, nudge=0.0):
        """Return the error of the table's run with this number of steps."""
        if (steps, nudge) not in self.known:
            try:
                with np.errstate(all="ignore"):
                    error = np.array(self.run(steps, nudge), dtype=float) - self.law
            except (ArithmeticError, ValueError, np.linalg.LinAlgError):       # overflow
                error = np.full_like(self.law, np.nan)
            self.known[steps, nudge] = error
        return self.known[steps, nudge]

    def round_off(self, steps):
        """Return a bound of round-off: ten standard deviations of a random walk that grows as a nudged start.

        Only a run with a large error can amplify round-off.
        """
        error = self.error(steps)
        if np.linalg.norm(error) < LARGE * self.size:
            return 0.0
        growth = np.linalg.norm(self.error(steps, NUDGE * self.size) - error) / (NUDGE * self.size)
        return 10.0 * np.sqrt(steps) * ROUND_OFF * growth

    def missed(self, finest):
        """Return the error of the expansion at the finest run if it is fitted to the coarser runs only."""
        return np.linalg.norm(self.expanded(finest, finest // 2) - self.error(finest))

    def settle(self, floor):
        """Take more steps until the expansion is accurate enough."""
        for left in reversed(range(self.doublings + 1)):
            size = np.linalg.norm(self.error(self.finest))
            if size < PREDICTABLE * self.size and self.missed(self.finest) <= max(UNSURE * size, floor * self.size):
                return True
            self.finest *= 2 if left else 1
        return False

    def expanded(self, steps, most):
        """Return the error at `steps` by the expansion through the runs of most/4, most/2 and `most` steps."""
        through = (most // 4, most // 2, most)
        h = np.array([most / n for n in through])[:, None]
        terms = np.linalg.solve(h**self.powers, np.array([self.error(n) for n in through]))
        return (most / steps) ** self.powers @ terms

    def prediction(self, dt, floor):
        """Return the Prediction for a step; None if the error is too large or the expansion too inaccurate."""
        steps = round(self.T / dt)
        settled = steps <= self.finest or self.settle(floor)
        if steps <= self.finest:                                             # settle() may have raised it
            error, share, more = self.error(steps), CLOSE, self.round_off(steps)
        elif settled:
            error, share = self.expanded(steps, self.finest), EXPANDED
            more = SAFETY * self.missed(self.finest) / self.size * (self.finest / steps) ** self.powers[0]
        else:
            return None
        size = np.linalg.norm(error) / self.size
        return Prediction(error, share * size + more + floor) if size + more < PREDICTABLE else None


class Model(NamedTuple):
    """A model of an engine in a scene: its order, and a function that runs it."""
    order: int
    run: object              # (p, h, steps, nudge) → what is observed at the end; nudge [m] moves the start


def table_model(scheme, law, begin, seen, order=1, ahead=0.0, march=advance):
    """Return the Model of a method or an engine that follows a scheme.

    A scheme is a Tableau, or p → a function like those of `step_of`.

    Its first velocity is that of begin(p) plus  ahead h a  at the start.  march: `advance`, or another function for it.
    """
    @cache                                              # a method and an engine may have the same model
    def run(p, h, steps, nudge):
        force, (x, v) = law(p), begin(p)
        rule = scheme(p) if callable(scheme) else scheme
        return seen(march(rule, force, nudged(x, nudge), v + ahead * h * force(0.0, x, v), h, steps)[0], p)
    return Model(order, run)


def nudged(x, nudge):
    """Return x, moved by `nudge` in a direction without symmetry."""
    return x + nudge * (np.cos(np.arange(x.size) ** 2.0).reshape(x.shape) if isinstance(x, np.ndarray) else 1.0)


class Motion(NamedTuple):
    """A scene's description of its motion, written independently of the lesson."""
    T: float                 # the output time [s]
    law: Callable            # p → a(t, x, v)
    begin: Callable          # p → (x, v)
    seen: Callable           # (x, p) → what the scene observes of x
    truth: Callable          # (p, t) → the same
    floor: Callable          # (p, dt) → round-off, relative
    march: Callable = advance            # or advance_linear; or advance_modes for modes that do not touch

    def model(self, scheme, law=None, ahead=0.0):
        """Return the Model of a method or an engine that follows a scheme; law: replaces the law of the scene."""
        order = scheme.order if isinstance(scheme, Tableau) else 1
        return table_model(scheme, law or self.law, self.begin, self.seen, order, ahead, self.march)

    def predict(self, scheme, law=None, follows=None, ahead=0.0, finest=None, powers=None):
        """Return the field `predicted` of a Runner that does what a scheme does, as `predict_model` does."""
        return shared_prediction(self, scheme, law, follows, ahead, finest, powers)

    def predict_model(self, model, follows=None, finest=None, powers=None):
        """Return the field `predicted` of a Runner.

        follows   (p, t) → what it observes with no error: its own law in place of the truth
        finest    steps of the finest run of the table, where they are not those of its order
        powers    the first three powers of dt in the error, where they are not k, k + 1, k + 2 of order k
        """
        @cache
        def error_law(p):
            law = np.array((follows or self.truth)(p, self.T), dtype=float)
            return ErrorLaw(lambda steps, nudge: model.run(p, self.T / steps, steps, nudge), law, powers or model.order,
                            self.T, finest or FINEST[model.order])

        def predicted_error(p, dt):
            """The error, with its sign, of the method's own table of coefficients (Runge–Kutta, partitioned), in a
            program that shares neither steps nor forces with the lesson: with the same step where that is coarse,
            otherwise by an expansion of the error in powers of dt.  A run must agree with it as closely as the
            expansion is known.
            """
            return error_law(p).prediction(dt, self.floor(p, dt))
        return predicted_error


@cache
def shared_prediction(motion, scheme, law, follows, ahead, finest, powers):
    """Return Motion.predict, the same for a method and an engine with one scheme: they share the runs of its table."""
    return motion.predict_model(motion.model(scheme, law, ahead), follows, finest, powers)


def summed(velocity, T, dt, at):
    """Return the displacement [m] of a run with the exact velocity(t) (n,) → (n, …), held for each step.

    at: where in a step, from 0 for the old velocity to 1 for the new one (the rectangle rule); ½ is the midpoint rule
    """
    return dt * np.sum(velocity(dt * (np.arange(round(T / dt)) + at)), axis=0)
