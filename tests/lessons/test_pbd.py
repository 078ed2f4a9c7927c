"""Lesson 8: a projection satisfies its constraint and shares it by mass, and a spring is a spring at any step."""

import numpy as np
import pytest
from scipy.spatial import ConvexHull

from solutions.checks import BadInput, Diverged
from validate.grading.expect import between, choice, close, numbers, raises, truth
from validate.reference import choices

from .brute import solid

exercise = pytest.mark.exercise
G = 9.81                     # [m/s²]
# All drawn values are below 10 in their unit. A result takes a few dozen operations, each with a round-off of 1.1e-16.
ROUND_OFF = 1e-12
SHORT = 2.0**-40             # a length far below those beside it; the differences of whole numbers and it are exact
TINY = 1e-30                 # complex step: its square vanishes beside 1, so a derivative is exact to round-off


def places(draw, d):
    """(size, place) of medium, small and large bodies [m], at the origin and a thousand sizes away from it.

    The smallest size is below the round-off of a metre, so an answer with a fixed threshold fails.
    """
    return [(size, far * size * draw(-1.0, 1.0, d)) for size in (1.0, 1e-20, 1e3) for far in (0.0, 1e3)]


def direction(draw, d):
    """A drawn unit vector (d,)."""
    y = draw(-1.0, 1.0, d)
    while not 0.1 < np.linalg.norm(y) < 1.0:
        y = draw(-1.0, 1.0, d)
    return y / np.linalg.norm(y)


def never_zero(draw, d):
    """Vectors (d,) that are not 0: some with one component, and some whose components add up to exactly 0.

    A test for zero by the sum of the components, or by one of them, takes some of these for 0.  They are multiples of
    ¼, and so are the positions to which they are added: so differences are exact.
    """
    axes = np.eye(d)
    others = [np.roll(axes[0] - axes[1], k) for k in range(d)]
    if d == 3:
        others += [np.roll([1.0, 1.0, -2.0], k) for k in range(3)]
    return [0.25 * draw.whole(1, 8) * sign * y for y in (*axes, *others) for sign in (1.0, -1.0)]


def whole_place(draw, d):
    """A drawn position (d,) [m] in whole numbers."""
    return np.array([float(draw.whole(-3, 3)) for _ in range(d)])


def network(lesson, inv_mass, pairs, rest, d=2, stiffness=1.0, alpha=0.0, sweeps=1, g=G):
    """A ConstraintNetwork that the lesson has not checked; gravity along the negative last axis."""
    pairs = np.array(pairs, dtype=np.int64)
    gravity = np.zeros(d)
    gravity[-1] = -g
    each = lambda y: np.broadcast_to(np.array(y, dtype=float), len(pairs)).copy()
    return lesson.ConstraintNetwork(np.array(inv_mass, dtype=float), gravity, pairs[:, 0].copy(),
                      pairs[:, 1].copy(), each(rest), each(stiffness), each(alpha), sweeps)


def visited_in_order(goal, p, dt, soft):
    """Positions after p.sweeps sweeps over the links in their order, each with its own Λ, written out."""
    y, Lam = goal.copy(), np.zeros(len(p.i))
    for _ in range(p.sweeps):
        for s, (i, j) in enumerate(zip(p.i, p.j, strict=True)):
            r, w = y[i] - y[j], p.inv_mass[i] + p.inv_mass[j]
            C, give = np.linalg.norm(r) - p.rest[s], p.alpha[s] / dt**2
            change = (-C - give * Lam[s]) / (w + give) if soft else -p.stiffness[s] * C / w
            Lam[s] += change
            pull = change * r / np.linalg.norm(r)
            y[i] += p.inv_mass[i] * pull
            y[j] -= p.inv_mass[j] * pull
    return y


def sweeps_of_a_chain(step, lesson, draw, soft):
    """Compare a step of a chain, several sweeps, with visited_in_order.  Twenty links change for hundreds of sweeps."""
    for d, sweeps, links, hard in ((2, draw.whole(2, 4), 3, False), (3, draw.whole(8, 12), 3, False),
                                   (3, draw.whole(8, 12), 3, True), (2, draw.whole(25, 30), 20, True)):
        dt = draw(0.02, 0.1)
        x, p = chain(lesson, draw, links, d)
        alpha, stiffness = draw(0.001, 0.01, links), draw(0.2, 0.8, links)
        p = p._replace(alpha=0.0 * alpha if hard else alpha, stiffness=stiffness, sweeps=sweeps)
        goal = x + dt**2 * np.where(p.inv_mass[:, None] > 0.0, p.gravity, 0.0)
        new, _ = step(lesson.network_gravity, 0.0, x, 0.0 * x, dt, p)
        expected = visited_in_order(goal, p, dt, soft)
        close("positions of a chain after a step of several sweeps [m]", new, expected, ROUND_OFF,
              given=f"x = {x.tolist()} m, dt = {dt} s, {p}")


def chain(lesson, draw, links, d=2, held=True, **more):
    """(x, ConstraintNetwork) of a zigzag of drawn masses whose links have nearly their rest lengths.

    The links run from the last to the first, and every other link has its ends swapped, so that the index of a link is
    not that of a point.
    """
    x = np.cumsum(np.concatenate((np.zeros((1, d)), [draw(0.8, 1.2) * direction(draw, d) for _ in range(links)])),
                  axis=0)
    inv_mass = 1.0 / draw(0.5, 2.0, links + 1)
    if held:
        inv_mass[0] = 0.0
    pairs = [(k, k + 1) if k % 2 else (k + 1, k) for k in reversed(range(links))]
    return x, network(lesson, inv_mass, pairs, draw(0.9, 1.1, links), d, **more)


def without_links(p):
    return p._replace(i=p.i[:0], j=p.j[:0], rest=p.rest[:0], alpha=p.alpha[:0], stiffness=p.stiffness[:0])


def lengths(x, p):
    return np.linalg.norm(x[p.i] - x[p.j], axis=1)


# ---------------------------------------------------------------------------------------------- one constraint

def a_new_array(quantity, got, given):
    """What a function returns must not be the array that it was given, or a caller's change would change both."""
    truth(f"whether this is the array that was handed in: {quantity}", np.shares_memory(np.asarray(got), given), False)


@exercise("8.1", points=0.25,
          hint="C is positive where the points are too far apart; n points from j to i and has length 1")
def test_a_distance_constraint_gives_the_extension_and_its_gradient(lesson, draw):
    for d in (2, 3):
        for r in never_zero(draw, d):
            x_j, rest, length = whole_place(draw, d), draw(0.5, 3.0), np.linalg.norm(r)
            C, gradient = lesson.distance_constraint(x_j + r, x_j, rest)
            given = f"x_i = {x_j + r} m, x_j = {x_j} m, rest = {rest} m"
            close("constraint C of a link that has a length [m]", C, length - rest, ROUND_OFF, given=given)
            close("gradient of C of a link that has a length [-]", gradient, r / length, ROUND_OFF, given=given)
            C, gradient = lesson.distance_constraint(x_j + SHORT * r, x_j, rest)
            given = f"x_i = x_j + {SHORT * r} m, x_j = {x_j} m, rest = {rest} m"
            close("constraint C of a link with all but no length [m]", C, SHORT * length - rest, ROUND_OFF, given=given)
            close("gradient of C of a link with all but no length [-]", gradient, r / length, ROUND_OFF, given=given)
        for n in (direction(draw, d), *np.eye(d), *-np.eye(d)):
            length, rest = draw(0.5, 3.0), draw(0.5, 3.0)
            for x_j in (draw(-2.0, 2.0, d), draw.sparse(-2.0, 2.0, d), np.zeros(d), 0.0 - length * n):
                x_i = x_j + length * n
                C, gradient = lesson.distance_constraint(x_i, x_j, rest)
                given = f"x_i = {x_i} m, x_j = {x_j} m, rest = {rest} m"
                close("constraint C [m]", C, length - rest, ROUND_OFF, given=given)
                close("gradient of C with respect to x_i [-]", gradient, n, ROUND_OFF, given=given)
    # In whole numbers C is 0.
    x_j, turn = np.array([float(draw.whole(-3, 3)), float(draw.whole(-3, 3))]), float(2 * draw.whole(0, 1) - 1)
    C, gradient = lesson.distance_constraint(x_j + turn * np.array([3.0, 4.0]), x_j, 5.0)
    close("constraint C of a link that has its rest length [m]", C, 0.0, ROUND_OFF,
          given="x_i = x_j ± (3, 4) m, rest = 5 m")
    close("gradient of C of a link that has its rest length [-]", gradient, turn * np.array([0.6, 0.8]), ROUND_OFF,
          given=f"x_i - x_j = {turn * np.array([3.0, 4.0])} m, rest = 5 m")


@exercise("8.1", points=0.25, hint="a link of zero length has no direction: raise BadInput before dividing")
def test_a_link_whose_ends_coincide_is_refused(lesson, draw):
    x = draw(-2.0, 2.0, 2)
    n = direction(draw, 2)
    length, rest = draw(0.5, 3.0), draw(0.5, 3.0)
    close("constraint of a link with a length [m]", lesson.distance_constraint(x + length * n, x, rest)[0],
          length - rest, ROUND_OFF, given=f"{length} m long, rest = {rest} m")
    raises("a link whose ends coincide", BadInput, lesson.distance_constraint, x, x.copy(), draw(0.5, 2.0))


@exercise("8.1", points=0.5,
          hint="C has a sign, but n does not depend on it: n points from j to i for long and for short links")
def test_subtracting_C_n_restores_the_rest_length_at_any_size_and_place(lesson, draw):
    """A thousand sizes from the origin, the round-off of positions is 1e-13 sizes."""
    for d in (2, 3):
        for size, place in places(draw, d):
            for share in (0.0, draw(0.1, 0.9), 1.0, draw(1.1, 5.0)):
                x_i = place + size * draw(0.3, 3.0) * direction(draw, d)
                rest = share * size
                C, n = lesson.distance_constraint(x_i, place, rest)
                n = np.asarray(n, dtype=float)
                given = f"x_i = {x_i} m, x_j = {place} m, rest = {rest} m"
                close("length of the link after x_i ← x_i − C n, over the size [-]",
                      np.linalg.norm(x_i - C * n - place) / size, share, ROUND_OFF * 10.0, given)
                close("length of n [-]", n @ n, 1.0, ROUND_OFF, given)
                close("length of the link by n · (x_i − x_j), over the size [-]", n @ (x_i - place) / size,
                      np.linalg.norm(x_i - place) / size, ROUND_OFF, given)


@exercise("8.2", points=0.5,
          hint="Λ = −C/Σ w|∇C|² is the same for all points; each point moves by w Λ along its own gradient")
def test_a_projection_meets_a_linear_constraint_at_once_and_shares_it_by_inverse_mass(lesson, draw):
    for k, d in ((2, 2), (4, 3)):
        gradients, w = draw(-2.0, 2.0, (k, d)), draw(0.2, 2.0, k)
        C = draw(0.5, 2.0) * (2 * draw.whole(0, 1) - 1)
        w[0] = 0.0
        small = np.asarray(lesson.constraint_correction(1e-12 * C, 1e-12 * gradients, 1e-12 * w), dtype=float)
        moved = np.asarray(lesson.constraint_correction(C, gradients, w), dtype=float)
        given = f"C = {C}, ∇C = {gradients.tolist()}, w = {w}"
        close("C + Σ ∇C · Δx: remaining error of a linear constraint", C + np.sum(gradients * moved), 0.0, ROUND_OFF,
              given=given)
        close("corrections if C, ∇C and w are 1e12 times smaller: the same [m]", small, moved, ROUND_OFF * 10.0,
              given=given)
        close("correction of an immovable point [m]", moved[0], np.zeros(d), 0.0, given=given)
        share = moved[1:] / w[1:, None] / gradients[1:]
        close("Δx/(w ∇C): the same for all points and coordinates", share,
              np.full_like(share, share[0, 0]), ROUND_OFF * np.abs(share).max() / np.abs(gradients).min(), given=given)
        close("corrections where the constraint holds [m]", lesson.constraint_correction(0.0, gradients, w),
              0.0 * gradients, 0.0, given=given)
    g, w, C = draw(0.5, 2.0, (1, 3)), draw(0.2, 2.0, 1), draw(0.5, 2.0)
    close("correction of a constraint of one point [m]", lesson.constraint_correction(C, g, w),
          -C / np.sum(g * g) * g, ROUND_OFF, given=f"C = {C}, ∇C = {g.tolist()}, w = {w}")


@exercise("8.2", points=0.5,
          hint="Σ w |∇C|² is a sum of squares: it is above 0 where the gradients add up to 0, as those of a link do")
def test_gradients_that_add_up_to_zero_share_the_correction_too(lesson, draw):
    """The gradients of a link are n and −n.  Truth: Σ Δx²/w is the least, which NumPy's pseudoinverse finds."""
    for d in (2, 3):
        for n in never_zero(draw, d):
            heavy, C = 2.0 ** draw.whole(-2, 2), draw(0.5, 2.0) * (2 * draw.whole(0, 1) - 1)
            ends = np.stack((n, -n))
            for gradients, w in ((ends, (heavy, heavy)), (ends, (0.0, heavy)), (2.0 * ends, draw(0.2, 2.0, 2)),
                                 (np.stack((2.0 * n, -n)), (heavy, 2.0 * heavy)), (n[None], (heavy,)),
                                 (np.stack((n, n, -2.0 * n)), (heavy, heavy, heavy))):
                w = np.array(w)
                root = np.sqrt(w)[:, None]
                least = np.linalg.pinv((root * gradients).reshape(1, -1)).reshape(-1, d)
                close("corrections of points whose gradients, or their components, add up to 0 [m]",
                      lesson.constraint_correction(C, gradients, w), -C * root * least, ROUND_OFF * 10.0,
                      given=f"C = {C}, ∇C = {gradients.tolist()}, w = {w}")


@exercise("8.2", points=0.5, hint="if Σ w|∇C|² is 0 nothing can move: raise BadInput instead of dividing by it")
def test_a_constraint_that_cannot_be_satisfied_is_refused(lesson, draw):
    gradients, C = draw(0.5, 2.0, (2, 3)), draw(0.5, 1.0)
    moved = np.asarray(lesson.constraint_correction(C, gradients, np.ones(2)), dtype=float)
    close("C + Σ ∇C · Δx of a constraint that can be satisfied", C + np.sum(gradients * moved), 0.0, ROUND_OFF,
          given=f"C = {C}, ∇C = {gradients.tolist()}")
    refused = lesson.constraint_correction
    for C in (draw(0.5, 1.0), 0.0):
        raises("a constraint between immovable points", BadInput, refused, C, gradients, np.zeros(2))
    raises("a constraint without a gradient", BadInput, refused, draw(0.5, 1.0), 0.0 * gradients, np.ones(2))
    gradients[1] = 0.0
    moved = np.asarray(lesson.constraint_correction(C, gradients, np.ones(2)), dtype=float)
    close("C + Σ ∇C · Δx where one of two points has no gradient", C + np.sum(gradients * moved), 0.0, ROUND_OFF,
          given=f"C = {C}, ∇C = {gradients.tolist()}")
    raises("a constraint whose only movable point has a zero gradient", BadInput, refused, C, gradients,
           np.array([0.0, draw(0.5, 2.0)]))


# ---------------------------------------------------------------------------------------------- the projection method

def swirl(t, x, v, p):
    """An acceleration that depends on all its arguments."""
    return t * x - 2.0 * v + p.gravity


def growing(t, x, v, p):
    """An acceleration that returns an array of the caller: v itself."""
    return v


@exercise("8.3", points=0.5,
          hint="dt² a at the time t, not ½ dt² a; where inv_mass is 0, omit the acceleration but not the velocity")
def test_free_points_are_predicted_with_and_immovable_ones_without_acceleration(lesson, draw):
    for d in (2, 3):
        x, v = draw(-1.0, 1.0, (4, d)), draw(-1.0, 1.0, (4, d))
        t, dt = draw(0.5, 2.0), draw(0.05, 0.5)
        p = network(lesson, [draw(1.5, 9.0), 0.0, draw(0.1, 0.7), 10.0 ** draw(-300.0, -9.0)], [(0, 1)], 1.0, d)
        free, still = np.array([[1.0], [0.0], [1.0], [1.0]]), np.zeros((4, d))
        cases = [(t, *draw.sparse(-1.0, 1.0, (2, 4, d))), (0.0, x, v), (0.0, still, still), (t, still, v)]
        cases += [(t, x, still), (t, x, v)]
        for t, x, v in cases:
            before = x.copy()
            given = f"1/m = {p.inv_mass} /kg, x = {x.tolist()}, v = {v.tolist()}, t = {t} s, dt = {dt} s"
            expected = x + dt * v + dt * dt * swirl(t, x, v, p) * free
            close("predicted positions [m]", lesson.predict(swirl, t, x, v, dt, p), expected, ROUND_OFF, given=given)
            close("input x after the call: return a new array", x, before, 0.0)
        for k in (0, 1):
            one = slice(k, k + 1)
            alone = without_links(p)._replace(inv_mass=p.inv_mass[one])
            close("predicted position of one point alone [m]", lesson.predict(swirl, t, x[one], v[one], dt, alone),
                  expected[one], ROUND_OFF, given=f"point {k} of {given}")
        expected = x + dt * v + dt * dt * v * free
        close("predicted positions where the acceleration returns v itself [m]",
              lesson.predict(growing, t, x, v, dt, p), expected, ROUND_OFF, given=given)


def equations(x, lam, goal, dt, p):
    """The equations f = 0 of Newton's method: (x − x_pred − dt² W Σ λ∇C, C), also for complex numbers."""
    r = x[p.i] - x[p.j]
    length = np.sqrt(np.sum(r * r, axis=1))
    pull = lam[:, None] * r / length[:, None]
    force = np.zeros_like(pull, shape=x.shape)
    np.add.at(force, p.i, pull)
    np.subtract.at(force, p.j, pull)
    return np.concatenate(((x - goal - dt * dt * p.inv_mass[:, None] * force).ravel(), length - p.rest))


@exercise("8.4", points=0.5,
          hint="both rows of the docstring: the matrix contains −dt² W Σ λ ∇²C "
               "beside 1, and the unknown is the new λ itself")
def test_a_newton_iteration_solves_the_equations_linearised_at_its_guess(lesson, draw):
    """Check f + f'·(Δx, Δλ) = 0, with f' along that direction from a complex step."""
    for d, held, lam in ((2, True, draw(-5.0, 5.0, 3)), (3, False, draw(-5.0, 5.0, 3)), (2, True, np.zeros(3)),
                         (3, False, draw.sparse(-5.0, 5.0, 3))):
        x, p = chain(lesson, draw, 3, d, held)
        goal = x + draw(-0.1, 0.1, x.shape)
        dt = draw(0.1, 0.3)
        change, new = lesson.newton_correction(x, lam, goal, dt, p)
        change, new = np.asarray(change, dtype=float), np.asarray(new, dtype=float)
        given = f"x = {x.tolist()}, λ = {lam}, x_pred = {goal.tolist()}, dt = {dt} s, {p}"
        slope = equations(x + 1j * TINY * change, lam + 1j * TINY * (new - lam), goal, dt, p).imag / TINY
        found = equations(x, lam, goal, dt, p) + slope
        # ε takes its part of the change of λ, which is large where λ nearly buckles the links.
        found[x.size:] -= 1e-13 * (p.inv_mass[p.i] + p.inv_mass[p.j]) * dt**2 * (new - lam)
        # The matrix has entries up to 1/dt² ≤ 100 and mostly a condition number below 1e4.
        close("linearised equations with the correction inserted [m]", found, np.zeros(x.size + 3), 1e-10, given=given)


@exercise("8.4", points=0.25,
          hint="λ is in newtons: divide Λ = dt² λ by dt² at the end; W multiplies Jᵀ from the left, row by row")
def test_links_that_hang_at_rest_carry_what_is_below_them(lesson, draw):
    """The guess is the solution, so REGULARISATION, which acts on the change of λ, has no effect."""
    for links in (1, 3):
        rest, masses = draw(0.5, 1.5, links), draw(0.5, 3.0, links)
        dt = draw(0.01, 0.3)
        x = np.zeros((links + 1, 2))
        x[1:, 1] = -np.cumsum(rest)
        p = network(lesson, [0.0, *(1.0 / masses)], [(k, k + 1) for k in range(links)], rest)
        goal = x.copy()
        below = -G * np.cumsum(masses[::-1])[::-1]
        goal[1:, 1] -= dt * dt * G
        change, lam = lesson.newton_correction(x, below, goal, dt, p)
        given = f"masses {masses} kg, links {rest} m, λ = {below} N, dt = {dt} s"
        close("correction of a chain that hangs at rest [m]", change, np.zeros_like(x), ROUND_OFF, given=given)
        # λ comes from Λ = dt² λ > 1e-3 N s², whose error is 1e-15.
        close("multipliers λ [N]: minus the weight below", lam, below, 1e-9, given=given)


@exercise("8.4", points=0.25,
          hint="each link has ε = REGULARISATION (w_i + w_j), which acts on the change of λ: −ε on "
               "the diagonal, −C − ε dt² λ on the right (for Λ)")
def test_redundant_links_share_a_change_of_their_multipliers_by_the_trace(lesson, draw):
    """Three collinear points, each linked to both others: the multipliers s = (1, 1, −1) move nothing.

    s · (second row of the docstring), with s J = 0 and C = 0, gives Σ s ε (λ_new − λ) = 0.
    ε is 1e-13 of w_i + w_j, whose round-off is 1e-16. So ε is effective to a thousandth, and after a few dozen
    operations to a few per cent.
    """
    # In the second and third the sum of two is neither the larger of both nor twice it.
    for w in ([0.25, 1.0, 4.0], [4.0, 4.0, 0.25], [4.0, 0.25, 4.0]):
        check_redundant_links(lesson, draw, np.array(w))


def check_redundant_links(lesson, draw, w):
    """Compare the multipliers of three collinear points, of these inverse masses, with what their ε select."""
    dt = draw(0.1, 0.3)
    gaps = 2.0 ** np.array([draw.whole(-1, 1), draw.whole(-1, 1)])
    # In powers of two C is exactly 0.
    x = np.array([[0.0, 0.0], [gaps[0], 0.0], [gaps[0] + gaps[1], 0.0]])
    p = network(lesson, w, [(0, 1), (2, 1), (2, 0)], [gaps[0], gaps[1], gaps[0] + gaps[1]])
    pull, lam = draw(-1.0, 1.0, 3), draw(-1.0, 1.0, 3)
    s = np.array([1.0, 1.0, -1.0])
    # The link with the least ε changes most.
    lam[0] = draw(20.0, 40.0)
    # This goal makes x with the multipliers `pull` a solution.
    goal = equations(x, pull, 0.0 * x, dt, p)[:6].reshape(3, 2)
    change, new = lesson.newton_correction(x, lam, goal, dt, p)
    new = np.asarray(new, dtype=float)
    given = f"x = {x.tolist()} m, w = {w} /kg, λ = {lam} N, dt = {dt} s"
    shares = p.inv_mass[p.i] + p.inv_mass[p.j]
    expected = pull - s * np.sum(s * shares * (pull - lam)) / np.sum(shares)
    # ε leaves J Δx = ε dt² (λ_new − λ), up to 3e-12 m for one link. No point moves by more than their sum.
    left = 1e-13 * dt**2 * np.sum(shares * np.abs(expected - lam))
    close("correction of points in equilibrium [m]", change, 0.0 * x, ROUND_OFF + left, given=given)
    close("multipliers λ of redundant links [N]", new, expected, 0.5, given=given)


def carried_along(step, lesson, draw, x, dt, p, left):
    """Check a step of an immovable moving point and a point that hangs from it.

    The immovable point keeps its velocity. The other has its own acceleration. The link keeps the share `left` of its
    error.
    """
    d = x.shape[1]
    v = np.stack((draw(1.0, 2.0, d), draw(-0.5, 0.5, d)))
    t = draw(0.5, 2.0)
    new, v_new = step(swirl, t, x, v, dt, p)
    held = x[0] + dt * v[0]
    r = x[1] + dt * v[1] + dt * dt * swirl(t, x, v, p)[1] - held
    error = np.linalg.norm(r) - p.rest[0]
    expected = np.stack((held, held + (p.rest[0] + left * error) * r / np.linalg.norm(r)))
    given = f"x = {x.tolist()} m, v = {v.tolist()} m/s, t = {t} s, dt = {dt} s, a = t x − 2 v + g, {p}"
    close("positions of an immovable moving point and of an accelerated point that hangs from it [m]", new,
          expected, 1e-11, given=given)
    close("velocities of both points [m/s]", v_new, (expected - x) / dt, 1e-11 / dt, given=given)


@exercise("8.5", points=0.25,
          hint="the velocity is the displacement of the points over dt; "
               "repeat Newton's iterations until nothing changes")
def test_after_a_step_every_link_has_its_length_and_momentum_changes_only_by_gravity(lesson, draw):
    for d in (2, 3):
        check_free_chain(lesson, draw, d)
        dt, length = draw(0.02, 0.1), draw(0.5, 2.0)
        x = np.stack((np.zeros(d), -length * np.eye(d)[-1]))
        for g in (G, 0.0):
            p = network(lesson, [0.0, draw(0.5, 2.0)], [(0, 1)], length, d, g=g)
            carried_along(lesson.constraint_projection_step, lesson, draw, x, dt, p, 0.0)


def check_free_chain(lesson, draw, d):
    """Check lengths, velocity and momentum of a free chain after a step, and its points without their links."""
    x, p = chain(lesson, draw, 3, d, held=False)
    p = p._replace(rest=lengths(x, p))
    v = draw(-1.0, 1.0, x.shape)
    dt = draw(0.02, 0.1)
    new, v_new = lesson.constraint_projection_step(lesson.network_gravity, 0.0, x, v, dt, p)
    new, v_new = np.asarray(new, dtype=float), np.asarray(v_new, dtype=float)
    given = f"x = {x.tolist()} m, v = {v.tolist()} m/s, dt = {dt} s, {p}"
    m = 1.0 / p.inv_mass
    close("lengths of the links after a step [m]", lengths(new, p), p.rest, 1e-11, given=given)
    close("velocity [m/s]: displacement over dt", v_new, (new - x) / dt, 1e-11, given=given)
    close("momentum after a step [kg m/s]: changed only by gravity", m @ v_new, m @ v + dt * m.sum() * p.gravity, 1e-11,
          given=given)
    for free, rest in ((x, 0.0 * v), (x, v), (x[:1], v[:1])):
        new, _ = lesson.constraint_projection_step(lesson.network_gravity, 0.0, free, rest, dt,
                                                   without_links(p)._replace(inv_mass=p.inv_mass[:len(free)]))
        close("positions of points without links after a step [m]", new, free + dt * rest + dt * dt * p.gravity,
              ROUND_OFF, given=f"x = {free.tolist()} m, v = {rest.tolist()} m/s, dt = {dt} s, g = {p.gravity} m/s²")


@exercise("8.5", points=0.25,
          hint="start at x with λ = 0, pass λ from iteration to iteration, allow NEWTON_LIMIT "
               "of them, and compare Δx with the longest link")
def test_fast_points_and_short_links_converge_from_where_the_step_begins(lesson, draw):
    turn = draw(0.0, 2.0 * np.pi)
    R = np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])
    dt = 0.1
    # The ball is thrown through its pivot. Starting at x, Newton finds the solution on the near side.
    x = np.array([[0.0, 0.0], [1.0, 0.0]]) @ R.T
    v = np.array([[0.0, 0.0], [-draw(14.0, 16.0), draw(0.5, 1.5)]]) @ R.T
    goal = x[1] + dt * v[1]
    new, _ = lesson.constraint_projection_step(lesson.network_gravity, 0.0, x, v, dt,
                                    network(lesson, [0.0, draw(0.5, 2.0)], [(0, 1)], 1.0, g=0.0))
    close("positions of a pendulum thrown through its pivot [m]", new, [np.zeros(2), -goal / np.linalg.norm(goal)],
          1e-10, given=f"x = {x.tolist()} m, v = {v.tolist()} m/s, dt = {dt} s, no gravity")
    # This chain takes 13 Newton iterations, in every orientation.
    x = np.array([[0.0, 0.0], [0.08, 0.63], [-0.14, 0.56], [0.57, -0.32]]) @ R.T
    v = np.array([[0.0, 0.0], [18.8, -8.4], [3.6, 15.8], [-19.0, 13.0]]) @ R.T
    p = network(lesson, [0.0, 10.0, 100.0, 0.01], [(0, 1), (1, 2), (2, 3)], np.linalg.norm(x[1:] - x[:-1], axis=1),
                g=0.0)
    new, _ = lesson.constraint_projection_step(lesson.network_gravity, 0.0, x, v, dt, p)
    close("lengths of the links of a fast chain after a step [m]", lengths(np.asarray(new, dtype=float), p),
          p.rest, 1e-11, given=f"x = {x.tolist()} m, v = {v.tolist()} m/s, dt = {dt} s, no gravity, {p}")
    # A short link that flies past its pivot takes 36 or 37 iterations, in every orientation and with every mass.
    for place, speed in (([-0.14, -0.1], [35.0, -1.3]), ([-0.1, -0.01], [12.0, 14.4])):
        x, v = np.array([[0.0, 0.0], place]) @ R.T, np.array([[0.0, 0.0], speed]) @ R.T
        p = network(lesson, [0.0, draw(0.5, 2.0)], [(0, 1)], np.linalg.norm(place), g=0.0)
        new, _ = lesson.constraint_projection_step(lesson.network_gravity, 0.0, x, v, dt, p)
        new, goal = np.asarray(new, dtype=float), x[1] + dt * v[1]
        given = f"x = {x.tolist()} m, v = {v.tolist()} m/s, dt = {dt} s, no gravity, {p}"
        close("length of a short link that flies past its pivot [m]", lengths(new, p), p.rest, 1e-11, given=given)
        close("distance of its end from the line of the prediction [m]",
              (new[1, 0] * goal[1] - new[1, 1] * goal[0]) / np.linalg.norm(goal), 0.0, 1e-11, given=given)
    # One link is a million times shorter than the other. At 50 m the round-off is 7e-15 m, far more than 1e-12 of the
    # short link.
    for rest in ((1e-6, 1.0), (1.0, 1e-6)):
        x = np.array([[50.0, 0.0], [50.0 + rest[0], 0.0], [50.0 + rest[0], rest[1]]]) @ R.T
        p = network(lesson, [0.0, draw(0.5, 2.0), draw(0.5, 2.0)], [(0, 1), (1, 2)], rest, g=1e-4)
        new, _ = lesson.constraint_projection_step(lesson.network_gravity, 0.0, x, 0.0 * x, 0.01, p)
        close("lengths of a long and a short link after a step [m]", lengths(np.asarray(new, dtype=float), p),
              rest, 1e-11, given=f"x = {x.tolist()} m, at rest, dt = 0.01 s, g = 1e-4 m/s², {p}")


def crosswise(draw, d):
    """Two drawn unit vectors (d,) at right angles."""
    n, across = direction(draw, d), direction(draw, d)
    while abs(n @ across) > 0.9:
        across = direction(draw, d)
    across = across - (across @ n) * n
    return n, across / np.linalg.norm(across)


@exercise("8.5", points=0.25,
          hint="test |Δx| of every coordinate of every point: those of two points, or of two coordinates, may cancel")
def test_two_points_turn_until_their_link_is_in_line_with_the_prediction(lesson, draw):
    """The link pulls along its new direction, and both points with the same force.

    So the new ends are on the line of the predicted ones, and their centre of mass is the predicted one.  Where the
    masses are equal and the velocities opposite, the corrections add up to 0.  Where a link turns out of an axis, the
    first correction along that axis is 0.
    """
    for d in (2, 3):
        axes, size = np.eye(d), draw(0.5, 2.0)
        cases = [(a, b, w, 0.0) for a in axes for b in axes if a @ b == 0.0
                 for w in ((1.0, 1.0), (0.0, 1.0), (1.0, 0.0))]
        cases += [(*crosswise(draw, d), w, g)
                  for w, g in (((1.0, 1.0), 0.0), (draw(0.5, 2.0, 2), G), ((0.0, 1.0), G), ((1.0, 0.0), G))]
        if d == 3:                                                       # the coordinates of each point cancel, too
            cases += [(np.roll([1.0, -1.0, 0.0], k) / np.sqrt(2.0), np.roll([0.4, 0.4, -0.8], k), (1.0, 1.0), 0.0)
                      for k in range(3)]
        for n, across, w, g in cases:
            w, dt = np.array(w), draw(0.05, 0.1)
            x, v = 0.5 * size * np.stack((-n, n)), draw(1.0, 3.0) * size * np.stack((-across, across))
            p = network(lesson, w, [(1, 0)], size, d, g=g)
            goal = x + dt * v + dt * dt * np.where(w[:, None] > 0.0, p.gravity, 0.0)
            r = goal[1] - goal[0]
            push = (np.linalg.norm(r) - size) / w.sum() * r / np.linalg.norm(r)
            new, _ = lesson.constraint_projection_step(lesson.network_gravity, 0.0, x, v, dt, p)
            close("two points after a step [m]", new, goal + np.stack((w[0] * push, -w[1] * push)), 1e-11,
                  given=f"x = {x.tolist()} m, v = {v.tolist()} m/s, dt = {dt} s, {p}")


@exercise("8.5", points=0.25,
          hint="raise Diverged if NEWTON_LIMIT iterations were not enough; test every coordinate of Δx")
def test_a_pendulum_goes_where_its_string_is_in_line_with_the_prediction(lesson, draw):
    dt = draw(0.02, 0.1)
    for size in (1e-3, 1.0, 1e6):
        for quarter in range(4):                                         # each coordinate moves up once and down once
            angle = draw(0.1, 1.4) + 0.5 * np.pi * quarter
            length = size * draw(0.5, 2.0)
            out = np.array([np.cos(angle), np.sin(angle)])
            speed = size * draw(2.0, 4.0) * (2 * draw.whole(0, 1) - 1)
            x = np.stack((np.zeros(2), length * out))
            v = np.stack((np.zeros(2), speed * np.array([-out[1], out[0]])))
            p = network(lesson, [0.0, draw(0.5, 2.0)], [(0, 1)], length, g=G * size)
            goal = x[1] + dt * v[1] + dt * dt * p.gravity
            new, _ = lesson.constraint_projection_step(lesson.network_gravity, 0.0, x, v, dt, p)
            close("pendulum after a step, over its size [-]", np.asarray(new) / size,
                  [np.zeros(2), length / size * goal / np.linalg.norm(goal)], 1e-11,
                  given=f"x = {x.tolist()} m, v = {v.tolist()} m/s, dt = {dt} s, g = {G * size} m/s²")
    # After one iteration the link of a bob that hardly moves has its length, but the bob is not yet where it belongs.
    x, v = np.array([[0.0, 0.0], [0.0, -1.0]]), np.array([[0.0, 0.0], [draw(1e-7, 1e-6), 0.0]])
    p = network(lesson, [0.0, draw(0.5, 2.0)], [(0, 1)], 1.0)
    goal = x[1] + 0.1 * v[1] + 0.01 * p.gravity
    new, _ = lesson.constraint_projection_step(lesson.network_gravity, 0.0, x, v, 0.1, p)
    close("way aside of a bob that hardly moves, over that without its string [-]", np.asarray(new)[1, 0] / goal[0],
          1.0 / np.linalg.norm(goal), 1e-6, given=f"v = {v.tolist()} m/s, dt = 0.1 s")
    triangle = np.array([[0.0, 0.0], [1.0, 0.2], [0.3, 0.9]])
    links = [(0, 1), (1, 2), (2, 0)]
    ends = []
    for pairs in (links, [*links, (1, 2)]):
        p = network(lesson, [0.0, 1.0, 2.0], pairs, [np.linalg.norm(triangle[i] - triangle[j]) for i, j in pairs])
        new, _ = lesson.constraint_projection_step(lesson.network_gravity, 0.0, triangle, 0.0 * triangle, dt, p)
        ends.append(new)
    close("a triangle with one link given twice, after a step [m]", ends[1], ends[0], 1e-10,
          given=f"x = {triangle.tolist()} m, dt = {dt} s")
    far = draw(2.2, 3.0)
    between = np.array([[0.0, 0.0], [0.5 * far, draw(0.3, 0.9)], [far, 0.0]])
    short = network(lesson, [0.0, 1.0, 0.0], [(0, 1), (1, 2)], 1.0)
    raises("two links that are too short for their immovable ends", Diverged,
           lesson.constraint_projection_step, lesson.network_gravity, 0.0, between, 0.0 * between, dt, short)
    short.gravity[1] = np.nan
    # Plain Python raises Diverged; in compiled code solve itself refuses NaN.
    raises("positions that become NaN, for which every comparison is false", Exception,
           lesson.constraint_projection_step, lesson.network_gravity, 0.0, between, 0.0 * between, dt, short)


# ---------------------------------------------------------------------------------------------- position-based dynamics

@exercise("8.6", points=1,
          hint="each end moves by its w over w_i + w_j, both times the stiffness; the centre of mass stays")
def test_a_visit_takes_its_share_of_the_error_and_leaves_the_centre_of_mass(lesson, draw):
    begins = [np.stack((draw(-1.0, 1.0, d), draw(2.0, 3.0, d))) for d in (2, 3)]
    # Along an axis, from the origin, where the other coordinates of the ends are equal.
    begins += [np.stack((np.zeros(d), sign * draw(2.0, 3.0) * axis)) for d in (2, 3) for sign in (1.0, -1.0)
               for axis in np.eye(d)]
    begins += [np.stack((y, np.zeros(d))) for d in (2, 3) for y in never_zero(draw, d)]
    for x in begins:
        d, s, w = x.shape[1], draw(0.2, 0.9), draw(0.3, 2.0, 2)
        almost = np.linalg.norm(x[0] - x[1]) * (1.0 + 1e-8 * draw(0.5, 2.0))
        for share, rest in ((1.0, draw(0.3, 0.8)), (s, draw(0.3, 0.8)), (s, draw(8.0, 9.0)), (s, almost)):
            # A visit is a visit, at any number of sweeps and any compliance.
            p = network(lesson, w, [(0, 1)], rest, d, share, draw(0.1, 0.5), draw.whole(2, 5))
            before = x.copy()
            new = np.asarray(lesson.distance_sweep(x, p), dtype=float)
            given = f"x = {x.tolist()} m, w = {w}, rest = {rest} m, stiffness {share}"
            close("length after a visit [m]", lengths(new, p), rest + (1.0 - share) * (lengths(x, p) - rest), ROUND_OFF,
                  given=given)
            close("centre of mass [m]", (1.0 / w) @ new, (1.0 / w) @ x, ROUND_OFF * 10.0, given=given)
            close("input x after the call: return a new array", x, before, 0.0)


@exercise("8.6", points=0.5, hint="visit the links in order: each starts from the positions that the earlier ones left")
def test_a_sweep_visits_one_link_after_the_other_and_leaves_the_immovable_alone(lesson, draw):
    """Points 0 (held), 2, 1 on a line: the second visit starts from the position of point 2 after the first."""
    n = direction(draw, 3)
    begin = draw(-1.0, 1.0, 3)
    share, w = draw(0.3, 1.0, 2), draw(0.5, 2.0, 2)
    gaps, rest = np.array([draw(1.1, 1.5), draw(0.5, 0.9)]), draw(0.8, 1.2, 2)
    x = begin + np.outer([0.0, gaps[0] + gaps[1], gaps[0]], n)
    p = network(lesson, [0.0, *w], [(2, 0), (1, 2)], rest, 3, share)
    first = gaps[0] - share[0] * (gaps[0] - rest[0])
    taken = share[1] * (gaps[0] + gaps[1] - first - rest[1]) / (w[0] + w[1])
    expected = begin + np.outer([0.0, gaps[0] + gaps[1] - w[0] * taken, first + w[1] * taken], n)
    new = lesson.distance_sweep(x, p)
    close("positions after a sweep [m]", new, expected, ROUND_OFF, given=f"x = {x.tolist()} m, {p}")
    close("position of the immovable point [m]", np.asarray(new)[0], x[0], 0.0)
    for size in (1e-7, 1e-20):
        small = lesson.distance_sweep(size * x, p._replace(rest=size * p.rest))
        close("positions of a tiny network, over its size [-]", np.asarray(small) / size, expected, ROUND_OFF * 10.0,
              given=f"size {size} m")
    for r in never_zero(draw, 3):
        squeezed, link = np.stack((SHORT * r, 0.0 * r)), network(lesson, np.ones(2), [(0, 1)], rest[0], 3)
        apart = 0.5 * rest[0] * r / np.linalg.norm(r)
        close("ends of a link with all but no length after a visit [m]", lesson.distance_sweep(squeezed, link),
              np.stack((apart, -apart)), ROUND_OFF * 10.0, given=f"x = {squeezed.tolist()} m, rest = {rest[0]} m")
    still = p._replace(rest=lengths(x, p))
    new = lesson.distance_sweep(x, still)
    close("positions where every link has its rest length [m]", new, x, ROUND_OFF, given=f"x = {x.tolist()} m")
    a_new_array("positions where every link has its rest length", new, x)
    x[2] = x[0]
    raises("a link whose ends coincide", BadInput, lesson.distance_sweep, x, p)


@exercise("8.7", points=1, hint="predict, then network.sweeps sweeps, then the velocity from the displacement")
def test_a_weight_on_one_link_sags_by_what_its_sweeps_leave(lesson, draw):
    for sweeps, s in ((1, draw(0.2, 0.8)), (draw.whole(2, 5), draw(0.2, 0.8)), (draw.whole(8, 12), draw(0.2, 0.8)),
                      (draw.whole(60, 80), draw(0.2, 0.8)), (draw.whole(130, 150), draw(0.01, 0.02)), (1, 1.0),
                      (draw.whole(2, 5), 1.0)):
        dt, length = draw(0.01, 0.1), draw(0.5, 2.0)
        S = (1.0 - s) ** sweeps
        sag = G * dt * dt * S / (1.0 - S)
        x = np.array([[0.0, 0.0], [0.0, -length - sag]])
        p = network(lesson, [0.0, draw(0.2, 5.0)], [(0, 1)], length, 2, s, 0.0, sweeps)
        given = f"x = {x.tolist()} m, dt = {dt} s, {p}"
        new, v = lesson.pbd_step(lesson.network_gravity, 0.0, x, 0.0 * x, dt, p)
        close("weight that starts at its equilibrium, position after a step [m]", new, x, ROUND_OFF, given=given)
        close("weight that starts at its equilibrium, velocity after a step [m/s]", v, 0.0 * x, ROUND_OFF / dt,
              given=given)
        fast = np.array([[0.0, 0.0], [0.0, draw(1.0, 2.0)]])
        new, v = lesson.pbd_step(lesson.network_gravity, 0.0, x, fast, dt, p)
        expected = -length - S * (sag + G * dt * dt - dt * fast[1, 1])
        close("thrown weight, position after a step [m]", np.asarray(new)[1, 1], expected, ROUND_OFF,
              given=f"v = {fast[1]} m/s, {given}")
        close("thrown weight, velocity after a step [m/s]: displacement over dt", np.asarray(v)[1, 1],
              (expected - x[1, 1]) / dt, ROUND_OFF / dt, given=given)
        carried_along(lesson.pbd_step, lesson, draw, x, dt, p, S)
        carried_along(lesson.pbd_step, lesson, draw, x, dt, p._replace(gravity=np.zeros(2)), S)
    sweeps_of_a_chain(lesson.pbd_step, lesson, draw, soft=False)


@exercise("8.8", points=0.5,
          hint="the sweeps leave a fraction S = (1 − s)ⁿ of the error; at rest they remove exactly the fall g dt²")
def test_the_sag_is_where_falling_and_projecting_balance(lesson, draw):
    for sweeps in (1, draw.whole(2, 6), draw.whole(7, 12)):
        g, dt, s = draw(1.0, 20.0), draw(0.01, 0.1), draw(0.2, 0.8)
        sag = 0.0
        for _ in range(400):                                             # each round multiplies the error by S ≤ 0.8
            sag = sag + g * dt * dt
            for _ in range(sweeps):
                sag -= s * sag
        close("sag [m]", lesson.pbd_sag(g, dt, s, sweeps), sag, ROUND_OFF,
              given=f"g = {g} m/s², dt = {dt} s, s = {s}, n = {sweeps}")
    for sweeps in (1, draw.whole(100, 200)):
        g, dt, s = draw(1.0, 20.0), draw(0.01, 0.1), draw(1e-3, 5e-3)
        sag = float(lesson.pbd_sag(g, dt, s, sweeps))
        after = sag + g * dt * dt
        for _ in range(sweeps):
            after -= s * after
        close("sag after another fall and its sweeps, over the fall [-]", after / (g * dt * dt), sag / (g * dt * dt),
              1e-10, given=f"g = {g} m/s², dt = {dt} s, s = {s}, n = {sweeps}")
    for sweeps in (1, 3):
        close("sag with full stiffness [m]", lesson.pbd_sag(g, dt, 1.0, sweeps), 0.0, 0.0)


# ---------------------------------------------------------------------------------------------- folds and obstacles

def folded(draw, phi, height=1.0):
    """(4, 3): two drawn triangles with a common edge, folded by φ, at a drawn position; height scales their heights."""
    e, up = direction(draw, 3), direction(draw, 3)
    up = np.cross(e, up)
    up = up / np.linalg.norm(up)
    side = np.cross(up, e)
    a, length = draw(-1.0, 1.0, 3), draw(0.7, 1.5)
    c = a + draw(0.2, 1.0) * length * e + height * draw(0.5, 1.2) * side
    d = a + draw(-0.3, 0.7) * length * e + height * draw(0.5, 1.2) * (-np.cos(phi) * side - np.sin(phi) * up)
    return np.stack((a, a + length * e, c, d))


def angle(x):
    """The angle of a fold, seen along its edge: how far wing d deviates from being opposite to wing c."""
    e = x[1] - x[0]
    e = e / np.linalg.norm(e)
    c, d = (y - (y @ e) * e for y in (x[2] - x[0], x[0] - x[3]))
    return np.arctan2(np.cross(c, d) @ e, c @ d)


@exercise("8.9", points=0.5,
          hint="flat is 0; atan2 with (N_c × N_d) · e/|e| gives the sign; "
               "reduce C to (−π, π], however far outside it is")
def test_the_fold_constraint_is_the_signed_angle_minus_the_wanted_one(lesson, draw):
    cases = ((draw(0.2, 2.5), draw(-0.5, 0.5)), (-draw(0.2, 2.5), draw(-0.5, 0.5)), (0.0, 0.0),
             (3.0, -draw(0.5, 2.5)), (-3.0, draw(0.5, 2.5)),
             (draw(0.2, 2.5), draw(12.5, 15.0)), (-draw(0.2, 2.5), -draw(12.5, 15.0)),
             (draw(0.2, 2.5), draw(60.0, 70.0)), (-draw(0.2, 2.5), -draw(60.0, 70.0)))
    for phi, wanted in cases:
        x = folded(draw, phi)
        expected = angle(x) - wanted
        while not -np.pi < expected <= np.pi:
            expected -= 2.0 * np.pi * np.sign(expected)
        close("angle constructed by the test [rad]", abs(angle(x)), abs(phi), 1e-11)
        close("C of a fold [rad]", lesson.fold_constraint(x, wanted)[0], expected, 1e-11,
              given=f"corners {x.tolist()} m, wanted {wanted} rad")
    sliver = folded(draw, phi, 1e-3)                                     # the round-off of an angle is 1e-16/1e-3
    close("C of a fold of two thin triangles [rad]", lesson.fold_constraint(sliver, 0.0)[0], angle(sliver), 1e-11,
          given=f"corners {sliver.tolist()} m")
    for wing in (2, 3):
        flat = x.copy()
        flat[wing] = x[0]
        raises("a triangle without area", BadInput, lesson.fold_constraint, flat, 0.0)
        # In whole numbers the area of three corners on one line is exactly 0.
        row = np.array([float(draw.whole(-3, 3)) for _ in range(9)]).reshape(3, 3)
        row[1, 0] = draw.whole(1, 3)
        flat = np.stack((row[0], row[0] + row[1], row[2] + 7.0, row[2] - 7.0))
        flat[wing] = row[0] + draw.whole(2, 4) * row[1]
        raises("a triangle with its corners on one line", BadInput, lesson.fold_constraint, flat, 0.0)
    short = x.copy()
    short[1] = x[0]
    raises("a fold whose edge has no length", BadInput, lesson.fold_constraint, short, 0.0)
    check_half_turns(lesson, draw)


def check_half_turns(lesson, draw):
    """Check C of a flat sheet whose wanted angle is half a turn, a little more and a little less, to both sides."""
    # The angle of this sheet is exactly 0.
    sheet = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, -1.0, 0.0]])
    # Half a turn to either side is the same fold, so both signs are right.
    halves = numbers("C of a flat sheet with a wanted angle of π, or −π [rad]",
                     [lesson.fold_constraint(sheet, turn)[0] for turn in (np.pi, -np.pi)], (2,))
    close("size of C of a flat sheet with a wanted angle of π, or −π [rad]", np.abs(halves), [np.pi, np.pi], ROUND_OFF)
    for past in (draw(1e-6, 1e-3), -draw(1e-6, 1e-3), 1e-11, -1e-11):
        wanted = np.pi + past
        close("C of a flat sheet with a wanted angle near π [rad]", lesson.fold_constraint(sheet, wanted)[0],
              -wanted + 2.0 * np.pi * (past > 0.0), ROUND_OFF * 10.0, given=f"wanted {wanted} rad")
        close("C of a flat sheet with a wanted angle near −π [rad]", lesson.fold_constraint(sheet, -wanted)[0],
              wanted - 2.0 * np.pi * (past > 0.0), ROUND_OFF * 10.0, given=f"wanted {-wanted} rad")


@exercise("8.9", points=0.25,
          hint="each wing changes the angle by |e|/|N| along its normal; the gradient "
               "of the edge follows from the lever arm β and from Σ = 0")
def test_the_gradient_of_a_fold_is_that_of_its_angle_without_net_force_or_torque(lesson, draw):
    for phi in (draw(0.3, 2.0), -draw(0.3, 2.0), 0.0):
        x = folded(draw, phi)
        h = 1e-5
        got = np.asarray(lesson.fold_constraint(x, 0.2)[1], dtype=float)
        slope = np.zeros((4, 3))
        for k in range(12):
            y = np.zeros(12)
            y[k] = h
            slope.flat[k] = (angle(x + y.reshape(4, 3)) - angle(x - y.reshape(4, 3))) / (2.0 * h)
        # Central differences: h²/6 times a third derivative below 1e2, and a round-off of 1e-16/h.
        close("gradient of the angle [rad/m]", got, slope, 1e-8, given=f"corners {x.tolist()} m")
        close("Σ ∇C: no net force", got.sum(axis=0), np.zeros(3), ROUND_OFF * 10.0,
              given=f"corners {x.tolist()} m")
        close("Σ x × ∇C: no net torque", np.cross(x, got).sum(axis=0), np.zeros(3), ROUND_OFF * 10.0,
              given=f"corners {x.tolist()} m")


def smooth_angle(x):
    """The same angle from the tangent of its half, also for complex numbers; not near ±π."""
    e = (x[1] - x[0]) / np.sqrt(np.sum((x[1] - x[0]) ** 2))
    c, d = (y - np.sum(y * e) * e for y in (x[2] - x[0], x[0] - x[3]))
    return 2.0 * np.arctan(np.sum(np.cross(c, d) * e) / (np.sqrt(np.sum(c * c) * np.sum(d * d)) + np.sum(c * d)))


def slope_of_angle(x):
    """The gradient (4, 3) of the angle, by a complex step for each coordinate."""
    moves = np.eye(12).reshape(12, 4, 3)
    return np.array([smooth_angle(x + 1j * TINY * move).imag / TINY for move in moves]).reshape(4, 3)


def upright_folds(draw):
    """Corners (4, 3) in whole numbers: one normal or the other is exactly along an axis, or its components add up to 0.

    So are the normals N_c of a and b with c; the fold turned round has c and d exchanged, and a and b.
    """
    for u, w in ([0, 1, 0], [0, 0, 1]), ([1, 1, 0], [0, 0, 1]), ([0, 0, 1], [1, 1, 0]), ([1, -1, 0], [1, 1, 1]):
        for k in range(3):
            e, wing = (np.roll(np.array(y, dtype=float), k) for y in (u, w))
            N = np.cross(e, wing) * (2 * draw.whole(0, 1) - 1)
            x = whole_place(draw, 3) + np.stack((0.0 * e, e, draw.whole(1, 3) * wing, N - draw.whole(1, 3) * wing))
            yield from (x, x[[1, 0, 3, 2]])


@exercise("8.9", points=0.25,
          hint="beside an obtuse angle β is below 0 or above 1: do not clamp it; a small fold is not degenerate")
def test_folds_with_acute_and_obtuse_wings_have_the_slope_of_their_angle_at_any_size(lesson, draw):
    """The complex step is exact to round-off. tan ½θ is below 15, and the heights are above 0.3 sizes."""
    for x in upright_folds(draw):
        C, gradient = lesson.fold_constraint(x, 0.0)
        close("C of a fold in whole numbers [rad]", C, smooth_angle(x), ROUND_OFF * 10.0, f"corners {x.tolist()} m")
        close("gradient of C of a fold in whole numbers [rad/m]", gradient, slope_of_angle(x), 1e-10,
              f"corners {x.tolist()} m")
    for size, place in places(draw, 3):
        for foot_c in (draw(-1.5, -0.3), draw(0.1, 0.9), draw(1.3, 2.5)):
            for foot_d in (draw(-1.5, -0.3), draw(0.1, 0.9), draw(1.3, 2.5)):
                phi, e = draw(-2.9, 2.9), direction(draw, 3)
                up = np.cross(e, direction(draw, 3))
                up = up / np.linalg.norm(up)
                side = np.cross(up, e)
                beyond = -np.cos(phi) * side - np.sin(phi) * up
                wings = foot_c * e + draw(0.3, 1.5) * side, foot_d * e + draw(0.3, 1.5) * beyond
                x = np.stack((np.zeros(3), e, *wings))
                slope = slope_of_angle(x)
                C, gradient = lesson.fold_constraint(place + size * x, 0.0)
                given = f"corners {(place + size * x).tolist()} m"
                close("C of a fold [rad]", C, smooth_angle(x), 1e-10, given)
                close("gradient of C times the size [rad]", size * np.asarray(gradient), slope, 1e-9, given)


@exercise("8.10", points=0.25,
          hint="|x − centre| − radius: positive outside; n points away from the centre, and is 0 at the centre")
def test_the_gap_of_a_ball_is_the_distance_to_its_surface(lesson, draw):
    for d in (2, 3):
        ball = lesson.Obstacle(draw(-2.0, 2.0, d), draw(0.5, 2.0), np.zeros(d), np.eye(d)[0])
        cases = [(draw(0.1, 0.4), direction(draw, d)), (draw(2.5, 4.0), direction(draw, d))]
        for distance, n in cases + [(draw(0.1, 4.0), sign * axis) for axis in np.eye(d) for sign in (1.0, -1.0)]:
            phi, normal = lesson.ball_gap(ball.centre + distance * n, ball)
            close("gap of a ball [m]", phi, distance - ball.radius, ROUND_OFF, given=f"{ball}, {distance} m along {n}")
            close("normal of a ball [-]", normal, n, ROUND_OFF, given=f"{ball}, {distance} m along {n}")
        exact = ball._replace(centre=whole_place(draw, d))
        for r in never_zero(draw, d):
            phi, normal = lesson.ball_gap(exact.centre + r, exact)
            given = f"{exact}, x − centre {r} m"
            close("gap of a ball [m]", phi, np.linalg.norm(r) - ball.radius, ROUND_OFF, given=given)
            close("normal of a ball [-]", normal, r / np.linalg.norm(r), ROUND_OFF, given=given)
            close("normal of a ball, very near its centre [-]",
                  lesson.ball_gap(exact.centre + SHORT * r, exact)[1], r / np.linalg.norm(r), ROUND_OFF,
                  given=f"{exact}, x − centre {SHORT * r} m")
        phi, normal = lesson.ball_gap(ball.centre, ball)
        close("gap at the centre [m]", phi, -ball.radius, ROUND_OFF)
        close("normal at the centre [-]", normal, np.zeros(d), 0.0)


@exercise("8.10", points=0.25,
          hint="|x − centre| − radius wherever x is, near the centre and far away; a radius of 0 is allowed")
def test_no_point_of_the_surface_is_nearer_than_the_gap(lesson, draw):
    for d in (2, 3):
        for size, place in places(draw, d):
            skin = np.array([direction(draw, d) for _ in range(20)])
            for radius in (0.0, 1.0):
                for distance in (1e-3, draw(0.1, 0.9), 0.99, 1.01, draw(1.1, 3.0)):
                    n = direction(draw, d)
                    ball = lesson.Obstacle(place, radius * size, np.zeros(d), np.eye(d)[0])
                    x = place + size * distance * n
                    phi, normal = lesson.ball_gap(x, ball)
                    normal = np.asarray(normal, dtype=float)
                    given = f"{ball}, x = {x} m"
                    close("gap over the size [-]", phi / size, distance - radius, ROUND_OFF * 10.0, given)
                    close("normal [-]: known to 1e-13 of the distance a thousand sizes away", normal, n, 1e-9,
                          given)
                    close("distance of x − φ n from the centre, over the size [-]: on the surface",
                          np.linalg.norm(x - phi * normal - place) / size, radius, ROUND_OFF * 10.0, given)
                    others = np.linalg.norm(x - place - radius * size * skin, axis=1).min() / size
                    nearer = abs(phi) / size - others
                    between("how much nearer another point of the surface is, over the size [-]", nearer,
                            -1e9, ROUND_OFF * 10.0, given)


def balloon(x, obstacle):
    """A surface that is not in the lesson: (φ, n) of a ball with twice its radius."""
    r = x - obstacle.centre
    distance = np.sqrt(np.sum(r * r))
    return distance - 2.0 * obstacle.radius, r / distance


@exercise("8.11", points=0.5,
          hint="move only movable points with φ < 0, along n by −φ; "
               "use φ and n of the surface that is passed in")
def test_points_inside_are_moved_to_the_surface_and_all_others_stay(lesson, draw):
    n, tangent = direction(draw, 3), direction(draw, 3)
    tangent = np.cross(n, tangent)
    floor = lesson.Obstacle(np.zeros(3), 0.0, draw(-1.0, 1.0, 3), n)
    heights = np.array([-draw(0.1, 0.5), draw(0.1, 0.5), -draw(0.1, 0.5), 0.0])
    x = floor.point + np.outer(heights, n) + np.outer(draw(-1.0, 1.0, 4), tangent)
    before = x.copy()
    w = np.array([draw(0.5, 2.0), 1.0, 0.0, 1.0])
    new = np.asarray(lesson.keep_outside(lesson.floor_gap, x, w, floor), dtype=float)
    given = f"heights {heights} m above the floor {floor}, w = {w}"
    close("new position of a point inside [m]", new[0], x[0] - heights[0] * n, ROUND_OFF, given=given)
    close("positions of points outside, and of immovable points [m]", new[1:3], x[1:3], 0.0, given=given)
    close("position of a point on the surface [m]", new[3], x[3], ROUND_OFF, given=given)
    close("input x after the call: return a new array", x, before, 0.0)
    above = x + 2.0 * n
    a_new_array("positions where all points are outside", lesson.keep_outside(lesson.floor_gap, above, w, floor), above)
    ball = floor._replace(centre=draw(-1.0, 1.0, 3), radius=draw(0.5, 1.0))
    shares = *draw.within(), *draw.beyond(2.0)
    out, distances = np.array([direction(draw, 3) for _ in shares]), 2.0 * ball.radius * np.array(shares)
    x = ball.centre + out * distances[:, None]
    close("points inside and outside a ball of twice the radius, a surface of the test [m]",
          lesson.keep_outside(balloon, x, np.ones(len(shares)), ball),
          ball.centre + out * np.maximum(distances, 2.0 * ball.radius)[:, None], ROUND_OFF * 10.0,
          given=f"x = {x.tolist()} m, {ball}")
    # A level floor through the origin, and points of which some coordinates are 0, alone and together.
    level, low = floor._replace(point=np.zeros(3), n=np.eye(3)[2]), draw.sparse(-1.0, 1.0, (6, 3))
    for x, w in ((low, np.ones(6)), (low, np.zeros(6)), (np.zeros((2, 3)), np.ones(2)),
                 (low[:1] - 2.0 * level.n, np.ones(1))):
        close("points on, above and below a level floor [m]", lesson.keep_outside(lesson.floor_gap, x, w, level),
              np.where((x < 0.0) & (level.n > 0.0) & (w[:, None] > 0.0), 0.0, x), ROUND_OFF,
              given=f"x = {x.tolist()} m, w = {w}, {level}")
    check_slopes(lesson, draw)
    x = ball.centre + np.outer((0.0, 0.5 * ball.radius), n)
    close("a point at the centre of a ball, where n = 0, and one beside it [m]",
          lesson.keep_outside(lesson.ball_gap, x, np.ones(2), ball),
          ball.centre + np.outer((0.0, ball.radius), n), ROUND_OFF * 10.0, given=f"x = {x.tolist()} m, {ball}")


def check_slopes(lesson, draw):
    """Check a point below a slope, and one above; n is along an axis, or its components add up to exactly 0."""
    for d in (2, 3):
        for y in never_zero(draw, d):
            up, depth = y / np.linalg.norm(y), draw(0.1, 1.0)
            slope = lesson.Obstacle(np.zeros(d), 0.0, np.zeros(d), up)
            close("a point below and one above a slope through the origin [m]",
                  lesson.keep_outside(lesson.floor_gap, np.stack((-depth * up, depth * up)), np.ones(2), slope),
                  np.stack((0.0 * up, depth * up)), ROUND_OFF, given=f"{depth} m below and above {slope}")
        for e in np.eye(d):                                              # all differences are exact
            floor = lesson.Obstacle(np.zeros(d), 0.0, np.zeros(d), e)
            place = (1.0 - e) * whole_place(draw, d)
            x = place + np.outer((-1e-9, -SHORT, SHORT), e)
            close("heights of points that are barely below a floor, or barely above, over 1e-12 m [-]",
                  np.asarray(lesson.keep_outside(lesson.floor_gap, x, np.ones(3), floor)) @ e / SHORT,
                  [0.0, 0.0, 1.0], ROUND_OFF, given=f"x = {x.tolist()} m, {floor}")


@exercise("8.11", points=0.5,
          hint="each point has its own φ and n; its mass does not matter, only whether it is movable")
def test_every_point_goes_to_the_nearest_point_outside_however_many_how_deep_and_how_heavy(lesson, draw):
    for d, size, place in [(2, *each) for each in places(draw, 2)] + [(3, *each) for each in places(draw, 3)]:
        n = direction(draw, d)
        floor = lesson.Obstacle(np.zeros(d), 0.0, place, n)
        x = place + size * draw(-2.0, 2.0, (12, d))
        w = 10.0 ** draw(-12.0, 3.0, 12)
        w[draw.whole(0, 11)] = 1e-300
        w[draw.whole(0, 11)] = 0.0
        heights = (x - place) @ n
        new = np.asarray(lesson.keep_outside(lesson.floor_gap, x, w, floor), dtype=float)
        inside = (heights < 0.0) & (w > 0.0)
        given = f"heights {heights} m above the floor {floor}, w = {w}"
        close("points that stay where they are [m]", new[~inside], x[~inside], 0.0, given)
        close("new heights of the other points, over the size [-]", (new[inside] - place) @ n / size,
              np.zeros(inside.sum()), ROUND_OFF * 10.0, given)
        close("displacements over the size [-]: no farther than needed",
              np.linalg.norm(new - x, axis=1)[inside] / size, -heights[inside] / size, ROUND_OFF * 10.0, given)


# ---------------------------------------------------------------------------------------------- XPBD

@exercise("8.12", points=0.5,
          hint="(−C − α̃ Λ)/(weight + α̃), also for α̃ = 0, which is rigid: after the visit C + α̃ Λ is zero")
def test_after_a_visit_a_compliant_constraint_obeys_hookes_law(lesson, draw):
    for alpha, side, other, heavy in ((0.0, 1, 1, 1.0), (0.0, -1, 1, 1.0), (draw(0.001, 0.1), 1, -1, 1.0),
                                      (draw(0.001, 0.1), -1, -1, 1.0), (draw(0.001, 0.1), 0, 1, 1.0),
                                      (1e-20 * draw(0.001, 0.1), 1, -1, 1e20),
                                      (1e-100 * draw(0.001, 0.1), 1, -1, 1e100)):
        C, Lam = side * draw(0.1, 1.0), heavy * other * draw(0.1, 1.0)
        weight, dt = draw(0.2, 2.0) / heavy, draw(0.05, 0.5)
        change = lesson.compliant_multiplier(C, Lam, weight, alpha / dt**2)
        given = f"C = {C} m, Λ = {Lam} N s², weight {weight} /kg, α = {alpha} m/N, dt = {dt} s"
        close("C + α λ after a visit [m]", C + weight * change + alpha * (Lam + change) / dt**2, 0.0, 1e-10,
              given=given)


@exercise("8.12", points=0.5,
          hint="test `not alpha_scaled >= 0.0`, which is also true for NaN; test for a weight of 0 before dividing")
def test_a_negative_compliance_and_a_constraint_without_mass_are_refused(lesson, draw):
    C, alpha = draw(0.1, 1.0), draw(0.001, 0.1)
    change = lesson.compliant_multiplier(C, 0.0, 1.0, alpha / 0.1**2)
    close("C + α λ after an ordinary visit [m]", C + change + alpha * change / 0.1**2, 0.0, 1e-10,
          given=f"C = {C} m, α = {alpha} m/N")
    for alpha in (-draw(0.001, 0.1), -1e-20, -1e-300, np.nan):
        raises("an invalid compliance", BadInput, lesson.compliant_multiplier, 0.1, 0.0, 1.0, alpha)
    for alpha in (0.0, draw(0.001, 0.1)):
        raises("a constraint without movable mass", BadInput, lesson.compliant_multiplier, 0.1, 0.0, 0.0, alpha)


@exercise("8.13", points=0.5,
          hint="Λ of each link continues from its old value; add w ΔΛ n to i and subtract it from j")
def test_after_a_visit_a_spring_satisfies_hookes_law_with_its_total_multiplier(lesson, draw):
    axes = [(d, draw(0.001, 0.1), draw(0.5, 1.0), np.stack((np.zeros(d), sign * draw(2.0, 3.0) * axis)))
            for d in (2, 3) for axis in np.eye(d) for sign in (1.0, -1.0)]               # from the origin along an axis
    axes += [(d, draw(0.001, 0.1), draw(0.5, 1.0), np.stack((y, np.zeros(d)))) for d in (2, 3)
             for y in never_zero(draw, d)]
    for d, alpha, rest, *x in ((2, draw(0.001, 0.1), draw(0.5, 1.0)), (3, draw(0.001, 0.1), draw(8.0, 9.0)),
                               (2, 0.0, draw(0.5, 1.0)), (3, 0.0, draw(8.0, 9.0)),   # α = 0 pulls and pushes, too
                               (2, 1e-8 * draw(0.1, 1.0), draw(0.5, 1.0)), (3, 1e3 * draw(0.1, 1.0), draw(0.5, 1.0)),
               (2, draw(0.001, 0.1), None), *axes):      # at its rest length its old Λ acts alone
        x = x[0] if x else np.stack((draw(-1.0, 1.0, d), draw(2.0, 3.0, d)))
        rest = np.linalg.norm(x[0] - x[1]) if rest is None else rest
        w = draw(0.3, 2.0, 2)
        p = network(lesson, w, [(0, 1)], rest, d, 0.4, alpha, draw.whole(2, 5))
        Lam = np.array([-draw(0.1, 0.5)])
        dt = draw(0.1, 0.4)
        before, kept = x.copy(), Lam.copy()
        new, total = lesson.compliant_sweep(x, Lam, dt, p)
        new, total = np.asarray(new, dtype=float), np.asarray(total, dtype=float)
        given = f"x = {x.tolist()} m, Λ = {Lam}, dt = {dt} s, {p}"
        # where α is large, ΔΛ takes away almost all of the old Λ: what is left has the round-off of α Λ/dt²
        close("C + α λ after a visit [m]", lengths(new, p) - p.rest + p.alpha * total / dt**2, np.zeros(1),
              1e-11 + 1e-15 * np.sum(p.alpha * np.abs(kept)) / dt**2, given=given)
        pull = (total - Lam) * (x[0] - x[1]) / np.linalg.norm(x[0] - x[1])
        close("displacements of both ends [m]: by w and ΔΛ, along the link", new - x,
              np.stack((w[0] * pull, -w[1] * pull)), 1e-11, given=given)
        close("input x after the call: return a new array", x, before, 0.0)
        close("input Λ after the call: return a new array", Lam, kept, 0.0)


@exercise("8.13", points=0.5,
          hint="each link has its own Λ and α, and starts from the positions that the earlier ones left")
def test_springs_are_visited_one_after_the_other(lesson, draw):
    """Points 0 (held), 2, 1 on a line.

    The first visit pulls point 2 towards 0 by −w ΔΛ, which lengthens the second link.
    """
    n = direction(draw, 2)
    begin = draw(-1.0, 1.0, 2)
    dt, w = draw(0.1, 0.4), draw(0.5, 2.0, 2)
    stretch, rest, alpha = draw(0.1, 0.5, 2), draw(0.8, 1.2, 2), draw(0.001, 0.1, 2)
    middle, end = rest[0] + stretch[0], rest.sum() + stretch.sum()
    x = begin + np.outer([0.0, end, middle], n)
    p = network(lesson, [0.0, *w], [(2, 0), (1, 2)], rest, 2, 0.4, alpha, draw.whole(2, 5))
    new, Lam = lesson.compliant_sweep(x, np.zeros(2), dt, p)
    soft = alpha / dt**2
    first = -stretch[0] / (w[1] + soft[0])
    second = -(stretch[1] - w[1] * first) / (w[0] + w[1] + soft[1])
    close("Λ after a sweep [N s²]", Lam, [first, second], 1e-11, given=f"x = {x.tolist()} m, dt = {dt} s, {p}")
    close("positions after a sweep [m]", new,
          begin + np.outer([0.0, end + w[0] * second, middle + w[1] * (first - second)], n), 1e-11,
          given=f"x = {x.tolist()} m, dt = {dt} s, {p}")
    for size in (1e-7, 1e-20):
        small, _ = lesson.compliant_sweep(size * x, np.zeros(2), dt, p._replace(rest=size * p.rest))
        close("positions of a tiny network, over its size [-]", np.asarray(small) / size, np.asarray(new, dtype=float),
              1e-11, given=f"size {size} m")
    swept = lesson.compliant_sweep(x, np.zeros(0), dt, without_links(p))
    for name, got, given in zip(("x", "Λ"), swept, (x, np.zeros(0)), strict=True):
        a_new_array(f"{name} of a network without links", got, given)
    for invalid in (-draw(0.001, 0.1), np.nan):
        raises("an invalid compliance", BadInput, lesson.compliant_sweep, x, np.zeros(2), dt,
               p._replace(alpha=np.array([alpha[0], invalid])))
    raises("a link between two immovable points", BadInput, lesson.compliant_sweep, x, np.zeros(2), dt,
           p._replace(inv_mass=np.array([0.0, w[0], 0.0])))
    x[2] = x[0]
    raises("a link whose ends coincide", BadInput, lesson.compliant_sweep, x, np.zeros(2), dt, p)


@exercise("8.14", points=1,
          hint="α̃ = α/dt² with the whole dt; Λ starts at 0 in every step, and is passed from sweep to sweep within it")
def test_one_spring_is_implicit_euler_for_any_step_and_any_number_of_sweeps(lesson, draw):
    """Implicit Euler of m ÿ = k s − m g along a line: v⁺ = (v + dt (k/m) s − dt g)/(1 + dt² k/m).

    v is the velocity ẏ, and s the stretch of the spring, from which the weight hangs.
    """
    for sweeps in (1, draw.whole(2, 6), draw.whole(8, 12)):
        m, k = draw(0.3, 3.0), draw(10.0, 500.0)
        rest, dt = draw(0.5, 1.5), draw(0.01, 0.2)
        stretch, speed = draw(-0.2, 0.2), draw(-1.0, 1.0)
        x = np.array([[0.0, 0.0], [0.0, -rest - stretch]])
        v = np.array([[0.0, 0.0], [0.0, speed]])
        p = network(lesson, [0.0, 1.0 / m], [(0, 1)], rest, 2, 1.0, 1.0 / k, sweeps)
        given = f"m = {m} kg, k = {k} N/m, dt = {dt} s, stretch {stretch} m, v = {speed} m/s, {sweeps} sweeps"
        new, v_new = lesson.xpbd_step(lesson.network_gravity, 0.0, x, v, dt, p)
        expected = (speed + dt * (k / m * stretch - G)) / (1.0 + dt * dt * k / m)
        close("velocity after a step [m/s]: as by implicit Euler", np.asarray(v_new)[1, 1], expected, 1e-10,
              given=given)
        close("position after a step [m]", np.asarray(new)[1, 1], x[1, 1] + dt * expected, 1e-11, given=given)
        hanging = np.array([[0.0, 0.0], [0.0, -rest - m * G / k]])
        new, _ = lesson.xpbd_step(lesson.network_gravity, 0.0, hanging, 0.0 * v, dt, p)
        close("position of a weight at its equilibrium after a step [m]: m g/k lower", new, hanging, 1e-11, given=given)
        soft = 1.0 / (k * dt * dt)
        for gravity in (p.gravity, np.zeros(2)):
            carried_along(lesson.xpbd_step, lesson, draw, x, dt, p._replace(gravity=gravity), soft / (1.0 / m + soft))
        # Parallel springs: more links than points and than coordinates, each with its own Λ.
        soft = soft * draw(0.5, 2.0, draw.whole(5, 8))
        side_by_side = network(lesson, [0.0, 1.0 / m], [(0, 1)] * soft.size, rest, 2, 1.0, soft * dt * dt)
        carried_along(lesson.xpbd_step, lesson, draw, x, dt, side_by_side, np.prod(soft / (1.0 / m + soft)))
    sweeps_of_a_chain(lesson.xpbd_step, lesson, draw, soft=True)


# ---------------------------------------------------------------------------------------------- rigid bodies

def body(draw):
    """(q, R, m, I_body): a drawn orientation as a quaternion and as a matrix by Rodrigues' formula."""
    axis, turn = direction(draw, 3), draw(0.3, 2.5)
    K = np.array([[0.0, -axis[2], axis[1]], [axis[2], 0.0, -axis[0]], [-axis[1], axis[0], 0.0]])
    R = np.eye(3) + np.sin(turn) * K + (1.0 - np.cos(turn)) * K @ K
    low = draw(0.5, 1.0, 2)
    q = np.append(np.cos(0.5 * turn), np.sin(0.5 * turn) * axis)
    return q, R, draw(0.5, 3.0), np.array([low[0], low[1], draw(0.95, 1.0) * low.sum()])


def levers(draw):
    """Pairs (r, p) of which r × p is exactly along an axis, or has components that add up to exactly 0."""
    for r, p in ([0, 1, 0], [0, 0, 1]), ([1, 1, 0], [0, 0, 1]), ([1, -1, 0], [1, 1, 1]):
        for k in range(3):
            for sign in (0.25, -0.25):
                yield np.roll(sign * draw.whole(1, 4) * np.array(r), k), np.roll(np.array(p, dtype=float), k)


@exercise("8.15", points=1, hint="1/m plus the squares of r × n, in body coordinates, over the moments")
def test_the_generalised_inverse_mass_is_the_response_to_a_unit_impulse(lesson, draw):
    """An impulse n at r gives v = n/m and ω = I⁻¹(r × n), so the point moves along n with n·(v + ω × r)."""
    q, R, mass, I_body = body(draw)
    cases = [(q, R, r, direction(draw, 3), m, I_body) for r, m in (
        (draw(-1.0, 1.0, 3), mass), (np.zeros(3), mass), (1e-4 * direction(draw, 3), mass),
        (draw(-1.0, 1.0, 3), 0.1 * mass),
        (draw(-1.0, 1.0, 3), 10.0 * mass))]
    for at in ((q, R), (np.array([1.0, 0.0, 0.0, 0.0]), np.eye(3))):
        for moments in (I_body, I_body[[0, 0, 1]], I_body[[0, 0, 0]]):   # a top, and a ball
            cases += [(*at, draw(-1.0, 1.0, 3), direction(draw, 3), mass, moments),
                      (*at, draw.sparse(-1.0, 1.0, 3), np.eye(3)[draw.whole(0, 2)], mass, moments)]
    unturned = np.array([1.0, 0.0, 0.0, 0.0]), np.eye(3)
    cases += [(*unturned, r, n / np.linalg.norm(n), mass, I_body[[0, 0, 0]]) for r, n in levers(draw)]
    for q, R, r, n, m, I_body in cases:
        omega = R @ np.diag(1.0 / I_body) @ R.T @ np.cross(r, n)
        close("generalised inverse mass [1/kg]", lesson.effective_inverse_mass_at(q, r, n, m, I_body),
              n @ (n / m + np.cross(omega, r)), ROUND_OFF,
              given=f"q = {q}, r = {r} m, n = {n}, m = {m} kg, I = {I_body}")


def turn_of(q_new, q_old):
    """The rotation matrix from one orientation to another, given as quaternions."""
    def matrix(q):
        w, v = q[0], q[1:]
        K = np.array([[0.0, -v[2], v[1]], [v[2], 0.0, -v[0]], [-v[1], v[0], 0.0]])
        return np.eye(3) + 2.0 * w * K + 2.0 * K @ K
    return matrix(q_new) @ matrix(q_old).T


@exercise("8.16", points=1,
          hint="the rotation vector is I⁻¹(r × p), in world coordinates; quaternion_update(q, turn, 1.0) applies it")
def test_a_push_beside_the_centre_moves_and_turns_a_body(lesson, draw):
    q, R, m, I_body = body(draw)
    x, r, p = draw(-1.0, 1.0, 3), draw(-1.0, 1.0, 3), draw(-1.0, 1.0, 3)
    for other in (0.1 * m, 10.0 * m):
        close("centre of mass of a body with another mass [m]",
              lesson.apply_positional_impulse(x, q, r, p, other, I_body)[0],
              x + p / other, ROUND_OFF * 10.0, given=f"p = {p} kg m, m = {other} kg")
    for arm, push in ((np.zeros(3), p), (0.25 * np.round(4.0 * p), np.round(4.0 * p)), (r, np.zeros(3))):  # r × p is 0
        new, turned = lesson.apply_positional_impulse(x, q, arm, push, m, I_body)
        close("centre of mass after a central push [m]", new, x + push / m, ROUND_OFF * 10.0,
              given=f"r = {arm} m, p = {push} kg m, m = {m} kg")
        close("orientation after a central push [-]", turned, q, ROUND_OFF, given=f"r = {arm} m, p = {push} kg m")
    for share in (1.0, 1e-7, 1e-10):
        check_push(lesson, q, R, x, r, share * p, m, I_body)
    axes = np.roll(np.eye(3), draw.whole(0, 2), axis=0)
    for moments in (I_body, I_body[[0, 0, 1]], I_body[[0, 0, 0]]):       # also of a top and of a ball
        for at in ((q, R), (np.array([1.0, 0.0, 0.0, 0.0]), np.eye(3))):
            check_push(lesson, *at, np.zeros(3), r, p, m, moments)
            check_push(lesson, *at, x, draw(0.1, 1.0) * axes[0], draw(0.1, 1.0) * axes[1], m, moments)
    for arm, push in levers(draw):
        check_push(lesson, np.array([1.0, 0.0, 0.0, 0.0]), np.eye(3), x, arm, push, m, I_body[[0, 0, 0]])


def check_push(lesson, q, R, x, r, p, m, I_body):
    """Compare a push beside the centre with Newton's and Euler's laws; R is the matrix of q."""
    new, turned = lesson.apply_positional_impulse(x, q, r, p, m, I_body)
    given = f"q = {q}, r = {r} m, p = {p} kg m, m = {m} kg, I = {I_body}"
    close("centre of mass [m]", new, x + p / m, ROUND_OFF, given=given)
    turned = np.asarray(turned, dtype=float)
    close("length of the quaternion [-]", np.linalg.norm(turned), 1.0, ROUND_OFF, given=given)
    turn = R @ np.diag(1.0 / I_body) @ R.T @ np.cross(r, p)
    angle = 2.0 * np.arctan(0.5 * np.linalg.norm(turn))
    axis = turn / np.linalg.norm(turn)
    K = np.array([[0.0, -axis[2], axis[1]], [axis[2], 0.0, -axis[0]], [-axis[1], axis[0], 0.0]])
    close("matrix of its rotation [-]", turn_of(turned, q),
          np.eye(3) + np.sin(angle) * K + (1.0 - np.cos(angle)) * K @ K, 1e-11, given=given)


@exercise("8.17", points=0.5, hint="Δq = q_new q̄_old; twice its vector part over its scalar part, over dt")
def test_a_turn_has_the_rate_that_leads_from_one_orientation_to_the_other(lesson, draw):
    q, _, _, _ = body(draw)
    axis = direction(draw, 3)
    dt = draw(0.05, 0.5)
    for still in (q, np.array([1.0, 0.0, 0.0, 0.0])):
        close("angular velocity of a body that does not turn [rad/s]", lesson.turning_rate(still, still.copy(), dt),
              np.zeros(3), ROUND_OFF, given=f"q = {still}, dt = {dt} s")
    # In the first and the last two the scalar part is 1 or −1: only its sign matters.  The others begin at
    # (1, 0, 0, 0).
    angles = 1e-4 * draw(0.5, 1.0), draw(0.1, 2.0), draw(2.9, 3.1), 1e-7 * draw(1.0, 5.0), 1e-10 * draw(1.0, 5.0)
    cases = [(q, axis, angle) for angle in angles]
    cases += [(still, about, draw(0.1, 3.0)) for about in (axis, *np.eye(3))]
    cases += [(still, y / np.linalg.norm(y), draw(0.1, 3.0)) for y in never_zero(draw, 3)]
    for q, axis, angle in cases:
        half, s = np.cos(0.5 * angle), np.sin(0.5 * angle)
        a, v = q[0], q[1:]
        turned = np.append(half * a - s * axis @ v, half * v + a * s * axis + s * np.cross(axis, v))
        for sign in (1.0, -1.0):
            close("angular velocity of a turn [rad/s]", lesson.turning_rate(q, sign * turned, dt),
                  2.0 * np.tan(0.5 * angle) / dt * axis, 1e-12 / (dt * half**2),
                  given=f"q = {q}, {angle} rad about {axis} in {dt} s")


# ---------------------------------------------------------------------------------------------- a soft ball

CUBE = np.array([[0, 2, 1], [1, 2, 3], [4, 5, 6], [5, 7, 6], [0, 1, 4], [1, 5, 4],
                 [2, 6, 3], [3, 6, 7], [0, 4, 2], [2, 4, 6], [1, 3, 5], [3, 7, 5]])


@exercise("8.18", points=0.5,
          hint="a sixth of a · (b × c) for each face; its gradient with respect to a is b × c/6, and so on: add "
               "up all faces")
def test_a_closed_surface_has_the_right_volume_and_volume_gradient(lesson, draw):
    """A box spanned by u, v and w has the volume |u · (v × w)|. The volume is linear in each corner."""
    u, v, w = (np.eye(3)[k] * draw(1.0, 2.0) + draw(-0.3, 0.3, 3) for k in range(3))
    corners = np.array([[k & 1, k >> 1 & 1, k >> 2] for k in range(8)])
    upright = np.diag([float(draw.whole(1, 3)) for _ in range(3)])       # from the origin, along the axes
    # From the origin also along (1, 1, 0) and (1, −1, 0): the components of products of corners add up to 0.
    diagonal = [np.roll([[1.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, -1.0, 0.0]], k, axis=1) for k in range(3)]
    for begin, edges in ((draw(-2.0, 2.0, 3), np.stack((u, v, w))), *((np.zeros(3), y) for y in (upright, *diagonal))):
        x = np.append(begin + corners @ edges, draw(-2.0, 2.0, (1, 3)), axis=0)
        given = f"corners {x.tolist()} m"
        V, gradient = lesson.volume_gradient(x, CUBE)
        close("volume of a box [m³]", V, edges[0] @ np.cross(edges[1], edges[2]), 1e-11, given=given)
        gradient = np.asarray(gradient, dtype=float)
        close("gradient of the volume at corner 8, which is in no face [m²]", gradient[8:], np.zeros((1, 3)), 0.0,
              given=given)
        close("Σ ∇V [m²]: a translation keeps the volume", gradient.sum(axis=0), np.zeros(3), 1e-11, given=given)
        change = draw(-0.5, 0.5, 3)
        for k in (0, 3, 6):
            y = x.copy()
            y[k] += change
            close("change of volume if one corner moves [m³]", gradient[k] @ change,
                  volume(y, CUBE, begin) - volume(x, CUBE, begin), 1e-11, given=f"{given}, corner {k} by {change} m")


def volume(x, faces, o):
    """Σ of the tetrahedra from o to each face [m³], also for complex numbers."""
    a, b, c = (x[faces[:, k]] - o for k in range(3))
    return np.sum(a * np.cross(b, c)) / 6.0


@exercise("8.18", points=0.5,
          hint="keep every sign: an inside-out surface has a negative volume and the opposite gradient")
def test_lumps_small_and_large_and_inside_out_have_the_volume_of_their_hull_and_its_slope(lesson, draw):
    """Brute force: the volume of the convex hull, and a complex step of tetrahedra from the mean of the corners."""
    lumps = [(size, draw(-0.5, 0.5, (10, 3)) + far * draw(-1.0, 1.0, 3)) for size in (1e-6, 1.0, 1e3)
             for far in (0.0, 3.0)]
    lumps.append((1.0, np.array([0.5 * direction(draw, 3) for _ in range(80)])))         # like a ball: 156 faces
    for size, points in lumps:
        x, faces = solid(points)
        middle, moves = x.mean(axis=0), np.eye(x.size).reshape(-1, *x.shape)
        slope = np.array([volume(x + 1j * TINY * move, faces, middle).imag / TINY for move in moves]).reshape(x.shape)
        for name, sign, turned in (("a lump", 1.0, faces),
                                   ("a lump inside-out", -1.0, np.ascontiguousarray(faces[:, ::-1]))):
            V, gradient = lesson.volume_gradient(size * x, turned)
            given = f"corners {(size * x).tolist()} m, triangles {turned.tolist()}"
            close(f"volume of {name}, over its size [-]", V / size**3, sign * ConvexHull(x).volume, 1e-11, given)
            close(f"gradient of the volume of {name}, over its size [-]", np.asarray(gradient) / size**2,
                  sign * slope, 1e-11, given)


# ---------------------------------------------------------------------------------------------- why?

@exercise("8.19", points=1, hint="the next angle per step is δ (1 − δ²): how does 1/δ² grow?")
def test_a_circling_weight_slows_down_as_predicted(lesson, draw):
    for angle, turns in ((draw(0.02, 0.04), 300), (draw(0.05, 0.1), 200), (draw(0.02, 0.1), draw.whole(1, 9)),
                         (draw(0.02, 0.1), 0)):
        length, dt = draw(0.5, 2.0), draw(0.01, 0.05)
        x, v = np.array([0.0, -length]), np.array([angle * length / dt, 0.0])
        begin = np.linalg.norm(v)
        for _ in range(turns):
            goal = x + dt * v
            goal = goal * (length / np.linalg.norm(goal))
            x, v = goal, (goal - x) / dt
        # A step takes δ² s³ of the first speed, where s is the share that is left.  The formula is up to 0.65 steps
        # ahead, and never behind, because the first turn is atan δ, not δ.  It is exact where no step was made.
        left, got = np.linalg.norm(v), lesson.circling_speed(begin, length, dt, turns * dt)
        given = f"v = {begin}, length = {length}, dt = {dt}, {turns} steps"
        if turns == 0:
            close("speed at the start [m/s]", got, begin, ROUND_OFF, given=given)
        step = angle**2 * (left / begin) ** 3 * begin
        # to leading order the recursion of the hint is behind by up to two steps more
        between("speed that is left [m/s]", got, left - 2.7 * step, left + 0.1 * step, given)


@exercise("8.20", points=1, hint="in a step of dt/n a weight falls by g (dt/n)²: how does that depend on n?")
def test_the_chosen_curve_falls_with_the_square_of_the_number_of_substeps(lesson):
    choice("the letter of the substeps", lesson.substeps_are(), choices.where(
        "pbd", "chains_by_visits", lambda n, low: np.allclose(low * n * n, low[0], rtol=1e-12)))


def xpbd_run(x, network, frames):
    """(largest error of a rigid link [-], farthest way of a point [m], highest energy above the start [J])."""
    w, dt, v, start, soft = network.inv_mass, 1.0 / 240.0, 0.0 * x, x, network.alpha > 0.0
    mass = np.where(w > 0.0, 1.0 / np.where(w > 0.0, w, 1.0), 0.0)[:, None]
    links = list(zip(network.i.tolist(), network.j.tolist(), network.rest.tolist(),
                     (network.alpha / dt**2).tolist(), strict=True))

    def seen(x, v):
        C = np.linalg.norm(x[network.i] - x[network.j], axis=1) - network.rest
        energy = 0.5 * np.sum(mass * v * v) - np.sum(mass * x * network.gravity)
        return (np.max(np.abs(C / network.rest)[~soft], initial=0.0), np.linalg.norm(x - start, axis=1).max(),
                energy + 0.5 * np.sum(C[soft] ** 2 / network.alpha[soft]))

    history = [seen(x, v)]
    for _ in range(4 * frames):
        new, lam = x + (w > 0.0)[:, None] * (dt * v + dt * dt * network.gravity), np.zeros(len(links))
        for _ in range(network.sweeps):
            for s, (i, j, rest, alpha) in enumerate(links):
                r = new[i] - new[j]
                length = np.sqrt(r @ r)
                change = -(length - rest + alpha * lam[s]) / (w[i] + w[j] + alpha)
                lam[s] += change
                new[i] += w[i] * change / length * r
                new[j] -= w[j] * change / length * r
        x, v = new, (new - x) / dt
        history.append(seen(x, v))
    worst, way, energy = np.transpose(history)
    return worst.max(), way.max(), energy.max() - energy[0], np.sum(mass)


def one_piece(n, i, j):
    """Whether links join all points."""
    joined = {0}
    for _ in range(n):
        joined |= {b for a, b in (*zip(i, j, strict=True), *zip(j, i, strict=True)) if a in joined}
    return len(joined) == n


@exercise("8.21", points=1,
          hint="begin with links of the right length; more sweeps, lighter loads and shorter chains stretch less")
def test_a_thing_of_ones_own_holds_together_and_moves(lesson):
    x, network, frames = lesson.my_thing()
    *arrays, sweeps = network                                            # lists count, too
    network = lesson.ConstraintNetwork(*map(np.asarray, arrays), sweeps)
    x = np.array(x, dtype=float)
    numbers("the points [m]", x, x.shape if x.ndim == 2 else (6, 2))
    size = np.linalg.norm(np.ptp(x, axis=0))
    between("number of points", len(x), 6, 60)
    between("number of free points", np.count_nonzero(network.inv_mass > 0.0), 3, 60)
    between("sweeps", network.sweeps, 1, 10)
    between("frames", frames, 60, 300)
    between("rigid links, over all links", np.mean(network.alpha == 0.0), 0.5, 1.0)
    truth("whether the links join all points", one_piece(len(x), network.i.tolist(), network.j.tolist()), True)
    worst, way, gain, mass = xpbd_run(x, network, int(frames))
    between("largest error of a rigid link, over its length", worst, 0.0, 0.05)
    between("farthest way of a point, over the size of the thing", way / size, 0.1, np.inf)
    # a hundredth of a millimetre of the whole thing's height
    between("gain of energy, over the weight times the size", gain / (mass * 9.81 * size), -np.inf, 1e-5)
