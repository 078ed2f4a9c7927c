"""Lesson 8 is right when a projection does what its constraint asks, no more, shares it by mass, and a spring stays a spring at any step."""

import numpy as np
import pytest
from scipy.spatial import ConvexHull

from solutions.checks import BadInput, Diverged

from .brute import solid
from ..grading.expect import between, close, raises

exercise = pytest.mark.exercise
G = 9.81                     # [m/s²]
# Everything drawn is below 10 in its unit, and what is compared takes a few dozen operations, each rounded by 1.1e-16 of that:
ROUND_OFF = 1e-12
TINY = 1e-30                 # a complex step: its square vanishes beside 1, so that a derivative is exact to round-off


def places(draw, d):
    """(size, place) of small, middling and large bodies [m], at the origin and a thousand sizes away from it.

    The smallest is below the round-off of what measures a metre: no fixed threshold lets it through.
    """
    return [(size, far * size * draw(-1.0, 1.0, d)) for size in (1e-20, 1.0, 1e3) for far in (0.0, 1e3)]


def direction(draw, d):
    """A unit vector (d,), drawn."""
    y = draw(-1.0, 1.0, d)
    while not 0.1 < np.linalg.norm(y) < 1.0:
        y = draw(-1.0, 1.0, d)
    return y / np.linalg.norm(y)


def net(lesson, inv_mass, pairs, rest, d=2, stiffness=1.0, alpha=0.0, sweeps=1, g=G):
    """A Net without the lesson's own checks; gravity against the last coordinate."""
    pairs = np.array(pairs, dtype=np.int64)
    gravity = np.zeros(d)
    gravity[-1] = -g
    each = lambda y: np.broadcast_to(np.array(y, dtype=float), len(pairs)).copy()
    return lesson.Net(np.array(inv_mass, dtype=float), gravity, pairs[:, 0].copy(), pairs[:, 1].copy(), each(rest), each(stiffness), each(alpha), sweeps)


def chain(lesson, draw, links, d=2, held=True, **more):
    """(x, Net) of a zigzag of drawn masses whose links are about as long as they should be.

    The links run from the last to the first, and every other one has its ends swapped: the number of a link is not that of a point.
    """
    x = np.cumsum(np.concatenate((np.zeros((1, d)), [draw(0.8, 1.2) * direction(draw, d) for _ in range(links)])), axis=0)
    inv_mass = 1.0 / draw(0.5, 2.0, links + 1)
    if held:
        inv_mass[0] = 0.0
    pairs = [(k, k + 1) if k % 2 else (k + 1, k) for k in reversed(range(links))]
    return x, net(lesson, inv_mass, pairs, draw(0.9, 1.1, links), d, **more)


def lengths(x, p):
    return np.linalg.norm(x[p.i] - x[p.j], axis=1)


# ---------------------------------------------------------------------------------------------- one constraint

@exercise("8.1", points=0.25,
          hint="C is positive where the points are too far apart; n points from j to i, and has length 1")
def test_a_link_knows_how_much_too_long_it_is_and_where_its_ends_should_go(lesson, draw):
    for d in (2, 3):
        x_j, n, length, rest = draw(-2.0, 2.0, d), direction(draw, d), draw(0.5, 3.0), draw(0.5, 3.0)
        C, gradient = lesson.distance_constraint(x_j + length * n, x_j, rest)
        given = f"x_i = {x_j + length * n} m, x_j = {x_j} m, rest = {rest} m"
        close("constraint C [m]", C, length - rest, ROUND_OFF, given=given)
        close("its gradient for i [-]", gradient, n, ROUND_OFF, given=given)


@exercise("8.1", points=0.25, hint="no length, no direction: raise BadInput as the docstring says, before dividing")
def test_a_link_whose_ends_coincide_is_refused(lesson, draw):
    x, n, length, rest = draw(-2.0, 2.0, 2), direction(draw, 2), draw(0.5, 3.0), draw(0.5, 3.0)
    close("constraint of a link with a length [m]", lesson.distance_constraint(x + length * n, x, rest)[0], length - rest, ROUND_OFF, given=f"{length} m long, rest = {rest} m")
    raises("a link whose ends coincide", BadInput, lesson.distance_constraint, x, x.copy(), draw(0.5, 2.0))


@exercise("8.1", points=0.5,
          hint="C keeps its sign, and n does not depend on it: too long or too short, n points from j to i")
def test_taking_C_n_back_makes_a_link_right_be_it_too_long_too_short_small_or_far_away(lesson, draw):
    """A thousand sizes from the origin places are rounded by 1e-13 of the size."""
    for d in (2, 3):
        for size, place in places(draw, d):
            for share in (0.0, draw(0.1, 0.9), 1.0, draw(1.1, 5.0)):
                x_i, rest = place + size * draw(0.3, 3.0) * direction(draw, d), share * size
                C, n = lesson.distance_constraint(x_i, place, rest)
                n, given = np.asarray(n, dtype=float), f"x_i = {x_i} m, x_j = {place} m, rest = {rest} m"
                close("length of the link after x_i ← x_i − C n, over the size [-]",
                      np.linalg.norm(x_i - C * n - place) / size, share, ROUND_OFF * 10.0, given)
                close("length of n [-]", n @ n, 1.0, ROUND_OFF, given)
                close("length of the link by n · (x_i − x_j), over the size [-]", n @ (x_i - place) / size,
                      np.linalg.norm(x_i - place) / size, ROUND_OFF, given)


@exercise("8.2", points=1, hint="Λ = −C/Σ w|∇C|², the same for all points; each point then moves by w Λ along its own gradient")
def test_a_projection_meets_a_linear_constraint_at_once_and_shares_it_by_inverse_mass(lesson, draw):
    for k, d in ((2, 2), (4, 3)):
        gradients, w, C = draw(-2.0, 2.0, (k, d)), draw(0.2, 2.0, k), draw(0.5, 2.0) * (2 * draw.whole(0, 1) - 1)
        w[0] = 0.0
        small = np.asarray(lesson.projection(1e-6 * C, 1e-6 * gradients, 1e-6 * w), dtype=float)
        moved = np.asarray(lesson.projection(C, gradients, w), dtype=float)
        given = f"C = {C}, ∇C = {gradients.tolist()}, w = {w}"
        close("C + Σ ∇C · Δx: what is left of a linear constraint", C + np.sum(gradients * moved), 0.0, ROUND_OFF, given=given)
        close("corrections where C, ∇C and w are a millionth of that: the same [m]", small, moved, ROUND_OFF * 10.0,
              given=given)
        close("correction of an immovable point [m]", moved[0], np.zeros(d), 0.0, given=given)
        share = moved[1:] / w[1:, None] / gradients[1:]
        close("Δx/(w ∇C): one number for all points and coordinates", share, np.full_like(share, share[0, 0]), ROUND_OFF * np.abs(share).max() / np.abs(gradients).min(), given=given)


@exercise("8.2", points=0.5, hint="when Σ w|∇C|² is 0 nothing can move: raise BadInput instead of dividing by it")
def test_a_constraint_that_nothing_can_meet_is_refused(lesson, draw):
    gradients, C = draw(0.5, 2.0, (2, 3)), draw(0.5, 1.0)
    moved = np.asarray(lesson.projection(C, gradients, np.ones(2)), dtype=float)
    close("C + Σ ∇C · Δx of a constraint that can be met", C + np.sum(gradients * moved), 0.0, ROUND_OFF, given=f"C = {C}, ∇C = {gradients.tolist()}")
    raises("a constraint between immovable points", BadInput, lesson.projection, draw(0.5, 1.0), gradients, np.zeros(2))
    raises("a constraint without a gradient", BadInput, lesson.projection, draw(0.5, 1.0), 0.0 * gradients, np.ones(2))
    gradients[1] = 0.0
    raises("a constraint whose only point with a mass has no gradient", BadInput, lesson.projection, C, gradients,
           np.array([0.0, draw(0.5, 2.0)]))


# ---------------------------------------------------------------------------------------------- the projection method

def swirl(t, x, v, p):
    """An acceleration that depends on all that it is given."""
    return t * x - 2.0 * v + p.gravity


def growing(t, x, v, p):
    """An acceleration that is an array of the caller's: v itself."""
    return v


@exercise("8.3", points=0.5, hint="dt² a, not ½ dt² a; where inv_mass is 0 leave the force out, but not the velocity")
def test_points_are_predicted_to_go_on_and_fall_and_immovable_ones_only_to_go_on(lesson, draw):
    for d in (2, 3):
        x, v, t, dt = draw(-1.0, 1.0, (4, d)), draw(-1.0, 1.0, (4, d)), draw(0.5, 2.0), draw(0.05, 0.5)
        p = net(lesson, [draw(1.5, 9.0), 0.0, draw(0.1, 0.7), 10.0 ** draw(-15.0, -9.0)], [(0, 1)], 1.0, d)
        before, free = x.copy(), np.array([[1.0], [0.0], [1.0], [1.0]])
        given = f"1/m = {p.inv_mass} /kg, x = {x.tolist()}, v = {v.tolist()}, t = {t} s, dt = {dt} s"
        close("predicted positions [m]", lesson.predict(swirl, t, x, v, dt, p), x + dt * v + dt * dt * swirl(t, x, v, p) * free, ROUND_OFF, given=given)
        close("the x that was handed in: return a new array", x, before, 0.0)
        expected = x + dt * v + dt * dt * v * free
        close("predicted positions where the acceleration returns v itself [m]", lesson.predict(growing, t, x, v, dt, p), expected, ROUND_OFF, given=given)


def equations(x, lam, goal, dt, p):
    """What Newton's method makes zero: (x − x_pred − dt² W Σ λ∇C, C), of complex numbers as well."""
    r = x[p.i] - x[p.j]
    length = np.sqrt(np.sum(r * r, axis=1))
    pull = lam[:, None] * r / length[:, None]
    force = np.zeros_like(pull, shape=x.shape)
    np.add.at(force, p.i, pull)
    np.subtract.at(force, p.j, pull)
    return np.concatenate(((x - goal - dt * dt * p.inv_mass[:, None] * force).ravel(), length - p.rest))


@exercise("8.4", points=1, hint="both rows of the docstring: the matrix needs −dt² W Σ λ ∇²C beside 1, and the unknown is the new λ itself")
def test_a_newton_round_solves_the_equations_as_they_are_about_its_guess(lesson, draw):
    """f + f'·(Δx, Δλ) = 0 with f' along that direction by a complex step."""
    for d, held in ((2, True), (3, False)):
        x, p = chain(lesson, draw, 3, d, held)
        lam, goal, dt = draw(-5.0, 5.0, 3), x + draw(-0.1, 0.1, x.shape), draw(0.1, 0.3)
        change, new = lesson.newton_correction(x, lam, goal, dt, p)
        change, new = np.asarray(change, dtype=float), np.asarray(new, dtype=float)
        given = f"x = {x.tolist()}, λ = {lam}, x_pred = {goal.tolist()}, dt = {dt} s, {p}"
        slope = equations(x + 1j * TINY * change, lam + 1j * TINY * (new - lam), goal, dt, p).imag / TINY
        # a matrix of numbers up to 1/dt² ≤ 100 of a condition below 1e4
        close("equations about the guess, with the correction put in [m]", equations(x, lam, goal, dt, p) + slope, np.zeros(x.size + 3), 1e-10, given=given)


@exercise("8.4", points=0.5, hint="λ is in newtons: divide Λ = dt² λ by dt² at the end; W stands on the left of Jᵀ, by rows")
def test_links_that_hang_at_rest_carry_what_is_below_them(lesson, draw):
    """The guess is the solution, so that the trace, which acts on the change of λ, is not there."""
    for links in (1, 3):
        rest, masses, dt = draw(0.5, 1.5, links), draw(0.5, 3.0, links), draw(0.01, 0.3)
        x = np.zeros((links + 1, 2))
        x[1:, 1] = -np.cumsum(rest)
        p = net(lesson, [0.0, *(1.0 / masses)], [(k, k + 1) for k in range(links)], rest)
        goal, below = x.copy(), -G * np.cumsum(masses[::-1])[::-1]
        goal[1:, 1] -= dt * dt * G
        change, lam = lesson.newton_correction(x, below, goal, dt, p)
        given = f"masses {masses} kg, links {rest} m, λ = {below} N, dt = {dt} s"
        close("correction of what hangs at rest [m]", change, np.zeros_like(x), ROUND_OFF, given=given)
        # λ comes from Λ = dt² λ > 1e-3 N s², known to 1e-15
        close("multipliers λ [N]: minus the weight below", lam, below, 1e-9, given=given)


@exercise("8.4", points=0.5,
          hint="ε = TRACE (w_i + w_j) of each link, against the change of λ: −ε on the diagonal, −C − ε dt² λ on the right (for Λ)")
def test_links_that_do_the_same_share_a_change_of_their_multipliers_by_the_trace(lesson, draw):
    """Three points on a line, each linked to both others: multipliers s = (1, 1, −1) move nothing.

    s · (second row of the docstring), where s J = 0 and C = 0, leaves Σ s ε (λ_new − λ) = 0.
    ε is 1e-13 beside w_i + w_j, which is rounded by 1e-16: it acts to a thousandth, and a few dozen operations to some per cent.
    """
    dt, w, gaps = draw(0.1, 0.3), np.array([0.25, 1.0, 4.0]), 2.0 ** np.array([draw.whole(-1, 1), draw.whole(-1, 1)])
    x = np.array([[0.0, 0.0], [gaps[0], 0.0], [gaps[0] + gaps[1], 0.0]])          # in powers of two: C is exactly 0
    p = net(lesson, w, [(1, 0), (2, 1), (2, 0)], [gaps[0], gaps[1], gaps[0] + gaps[1]])
    pull, lam, s = draw(-1.0, 1.0, 3), draw(-1.0, 1.0, 3), np.array([1.0, 1.0, -1.0])
    lam[0] = draw(20.0, 40.0)                                                    # the link with the least ε changes most
    goal = equations(x, pull, 0.0 * x, dt, p)[:6].reshape(3, 2)                  # so that x with these multipliers is a solution
    change, new = lesson.newton_correction(x, lam, goal, dt, p)
    new, given = np.asarray(new, dtype=float), f"x = {x.tolist()} m, w = {w} /kg, λ = {lam} N, dt = {dt} s"
    close("correction of what is in balance [m]", change, 0.0 * x, ROUND_OFF, given=given)
    shares = p.inv_mass[p.i] + p.inv_mass[p.j]
    expected = pull - s * np.sum(s * shares * (pull - lam)) / np.sum(shares)
    close("multipliers λ of links that do the same [N]", new, expected, 0.5, given=given)


def carried_along(step, lesson, draw, x, dt, p, left):
    """An immovable point goes on with the velocity that it has; one link pulls the other, whatever accelerates it, and leaves that share of its error."""
    v, t = np.stack((draw(1.0, 2.0, 2), draw(-0.5, 0.5, 2))), draw(0.5, 2.0)
    new, v_new = step(swirl, t, x, v, dt, p)
    held = x[0] + dt * v[0]
    r = x[1] + dt * v[1] + dt * dt * swirl(t, x, v, p)[1] - held
    error = np.linalg.norm(r) - p.rest[0]
    expected = np.stack((held, held + (p.rest[0] + left * error) * r / np.linalg.norm(r)))
    given = f"x = {x.tolist()} m, v = {v.tolist()} m/s, t = {t} s, dt = {dt} s, a = t x − 2 v + g, {p}"
    close("an immovable point that moves, and one that hangs from it and is accelerated by a law of its own [m]", new, expected, 1e-11, given=given)
    close("their velocities [m/s]", v_new, (expected - x) / dt, 1e-11 / dt, given=given)


@exercise("8.5", points=0.5, hint="the velocity is what the points have really moved, over dt; repeat Newton's rounds until nothing changes")
def test_after_a_step_every_link_has_its_length_and_nothing_is_pushed_from_outside(lesson, draw):
    x, p = chain(lesson, draw, 3, 2, held=False)
    p = p._replace(rest=lengths(x, p))
    v, dt = draw(-1.0, 1.0, x.shape), draw(0.02, 0.1)
    new, v_new = lesson.projection_step(lesson.falling_acceleration, 0.0, x, v, dt, p)
    new, v_new = np.asarray(new, dtype=float), np.asarray(v_new, dtype=float)
    given, m = f"x = {x.tolist()} m, v = {v.tolist()} m/s, dt = {dt} s, {p}", 1.0 / p.inv_mass
    close("lengths of the links after a step [m]", lengths(new, p), p.rest, 1e-11, given=given)
    close("velocity [m/s]: what it has moved, over dt", v_new, (new - x) / dt, 1e-11, given=given)
    close("momentum after a step [kg m/s]: what gravity gave", m @ v_new, m @ v + dt * m.sum() * p.gravity, 1e-11, given=given)
    length = draw(0.5, 2.0)
    x, p = np.array([[0.0, 0.0], [0.0, -length]]), net(lesson, [0.0, draw(0.5, 2.0)], [(0, 1)], length)
    carried_along(lesson.projection_step, lesson, draw, x, dt, p, 0.0)


@exercise("8.5", points=0.25,
          hint="begin at x with λ = 0, hand λ on from round to round, allow NEWTON_LIMIT of them, and measure Δx by the longest link")
def test_fast_points_and_short_links_converge_from_where_the_step_begins(lesson, draw):
    turn = draw(0.0, 2.0 * np.pi)
    R, dt = np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]]), 0.1
    # thrown through its pivot: from x Newton finds the place on the near side of it, against the prediction
    x, v = np.array([[0.0, 0.0], [1.0, 0.0]]) @ R.T, np.array([[0.0, 0.0], [-draw(14.0, 16.0), draw(0.5, 1.5)]]) @ R.T
    goal = x[1] + dt * v[1]
    new, _ = lesson.projection_step(lesson.falling_acceleration, 0.0, x, v, dt, net(lesson, [0.0, draw(0.5, 2.0)], [(0, 1)], 1.0, g=0.0))
    close("a pendulum thrown through its pivot, after a step [m]", new, [np.zeros(2), -goal / np.linalg.norm(goal)], 1e-10,
          given=f"x = {x.tolist()} m, v = {v.tolist()} m/s, dt = {dt} s, no gravity")
    # a chain that Newton needs 13 rounds for, from every side
    x = np.array([[0.0, 0.0], [0.08, 0.63], [-0.14, 0.56], [0.57, -0.32]]) @ R.T
    v = np.array([[0.0, 0.0], [18.8, -8.4], [3.6, 15.8], [-19.0, 13.0]]) @ R.T
    p = net(lesson, [0.0, 10.0, 100.0, 0.01], [(0, 1), (1, 2), (2, 3)], np.linalg.norm(x[1:] - x[:-1], axis=1), g=0.0)
    new, _ = lesson.projection_step(lesson.falling_acceleration, 0.0, x, v, dt, p)
    close("lengths of the links of a fast chain after a step [m]", lengths(np.asarray(new, dtype=float), p), p.rest, 1e-11,
          given=f"x = {x.tolist()} m, v = {v.tolist()} m/s, dt = {dt} s, no gravity, {p}")
    # one link is a millionth of the other
    for rest in ((1e-6, 1.0), (1.0, 1e-6)):                                      # at 50 m round-off is 7e-15 m: far above 1e-12 of the short link
        x = np.array([[50.0, 0.0], [50.0 + rest[0], 0.0], [50.0 + rest[0], rest[1]]]) @ R.T
        p = net(lesson, [0.0, draw(0.5, 2.0), draw(0.5, 2.0)], [(0, 1), (1, 2)], rest, g=1e-4)
        new, _ = lesson.projection_step(lesson.falling_acceleration, 0.0, x, 0.0 * x, 0.01, p)
        close("lengths of a long and a short link after a step [m]", lengths(np.asarray(new, dtype=float), p), rest, 1e-11,
              given=f"x = {x.tolist()} m, at rest, dt = 0.01 s, g = 1e-4 m/s², {p}")


@exercise("8.5", points=0.25, hint="raise Diverged when NEWTON_LIMIT rounds were not enough; ask every coordinate of Δx")
def test_a_pendulum_goes_where_its_string_is_in_line_with_the_prediction(lesson, draw):
    dt = draw(0.02, 0.1)
    for size in (1e-3, 1.0, 1e6):
        for quarter in range(4):                     # so that each coordinate once goes up and once down
            angle, length = draw(0.1, 1.4) + 0.5 * np.pi * quarter, size * draw(0.5, 2.0)
            out, speed = np.array([np.cos(angle), np.sin(angle)]), size * draw(2.0, 4.0) * (2 * draw.whole(0, 1) - 1)
            x, v = np.stack((np.zeros(2), length * out)), np.stack((np.zeros(2), speed * np.array([-out[1], out[0]])))
            p = net(lesson, [0.0, draw(0.5, 2.0)], [(0, 1)], length, g=G * size)
            goal = x[1] + dt * v[1] + dt * dt * p.gravity
            new, _ = lesson.projection_step(lesson.falling_acceleration, 0.0, x, v, dt, p)
            close("pendulum after a step, over its size [-]", np.asarray(new) / size,
                  [np.zeros(2), length / size * goal / np.linalg.norm(goal)], 1e-11,
                  given=f"x = {x.tolist()} m, v = {v.tolist()} m/s, dt = {dt} s, g = {G * size} m/s²")
    triangle = np.array([[0.0, 0.0], [1.0, 0.2], [0.3, 0.9]])
    once, twice = ([(0, 1), (1, 2), (2, 0)] + [(1, 2)] * more for more in (0, 1))
    ends = [lesson.projection_step(lesson.falling_acceleration, 0.0, triangle, 0.0 * triangle, dt, p)[0]
            for p in (net(lesson, [0.0, 1.0, 2.0], pairs, [np.linalg.norm(triangle[i] - triangle[j]) for i, j in pairs]) for pairs in (once, twice))]
    close("a triangle with one link given twice, after a step [m]", ends[1], ends[0], 1e-10, given=f"x = {triangle.tolist()} m, dt = {dt} s")
    far = draw(2.2, 3.0)
    between = np.array([[0.0, 0.0], [0.5 * far, draw(0.3, 0.9)], [far, 0.0]])
    short = net(lesson, [0.0, 1.0, 0.0], [(0, 1), (1, 2)], 1.0)
    raises("two links that are too short for the points that hold them", Diverged, lesson.projection_step, lesson.falling_acceleration, 0.0, between, 0.0 * between, dt, short)
    short.gravity[1] = np.nan
    # plain, this is Diverged; compiled, solve itself refuses NaN
    raises("positions that become NaN, which no comparison is true of", Exception, lesson.projection_step, lesson.falling_acceleration, 0.0, between, 0.0 * between, dt, short)


# ---------------------------------------------------------------------------------------------- position-based dynamics

@exercise("8.6", points=1, hint="each end by its own w over w_i + w_j, and both by the link's stiffness; the centre of mass stays")
def test_a_visit_takes_its_share_of_the_error_and_leaves_the_centre_of_mass(lesson, draw):
    for d in (2, 3):
        s, w = draw(0.2, 0.9), draw(0.3, 2.0, 2)
        x = np.stack((draw(-1.0, 1.0, d), draw(2.0, 3.0, d)))
        for share, rest in ((1.0, draw(0.3, 0.8)), (s, draw(0.3, 0.8)), (s, draw(8.0, 9.0))):
            p = net(lesson, w, [(0, 1)], rest, d, share)
            before, new = x.copy(), np.asarray(lesson.distance_sweep(x, p), dtype=float)
            given = f"x = {x.tolist()} m, w = {w}, rest = {rest} m, stiffness {share}"
            close("length after a visit [m]", lengths(new, p), rest + (1.0 - share) * (lengths(x, p) - rest), ROUND_OFF, given=given)
            close("centre of mass [m]", (1.0 / w) @ new, (1.0 / w) @ x, ROUND_OFF * 10.0, given=given)
            close("the x that was handed in: return a new array", x, before, 0.0)


@exercise("8.6", points=0.5, hint="one after the other: a link starts from where the ones before it have put its ends")
def test_a_sweep_visits_one_link_after_the_other_and_leaves_the_immovable_alone(lesson, draw):
    """Points 0 (held), 2, 1 on a line: the second visit starts from where the first has put point 2."""
    n, begin, share, w = direction(draw, 3), draw(-1.0, 1.0, 3), draw(0.3, 1.0, 2), draw(0.5, 2.0, 2)
    gaps, rest = np.array([draw(1.1, 1.5), draw(0.5, 0.9)]), draw(0.8, 1.2, 2)
    x = begin + np.outer([0.0, gaps[0] + gaps[1], gaps[0]], n)
    p = net(lesson, [0.0, *w], [(0, 2), (2, 1)], rest, 3, share)
    first = gaps[0] - share[0] * (gaps[0] - rest[0])
    taken = share[1] * (gaps[0] + gaps[1] - first - rest[1]) / (w[0] + w[1])
    expected = begin + np.outer([0.0, gaps[0] + gaps[1] - w[0] * taken, first + w[1] * taken], n)
    new = lesson.distance_sweep(x, p)
    close("positions after a sweep [m]", new, expected, ROUND_OFF, given=f"x = {x.tolist()} m, {p}")
    close("the immovable point [m]", np.asarray(new)[0], x[0], 0.0)
    small = lesson.distance_sweep(1e-7 * x, p._replace(rest=1e-7 * p.rest))
    close("positions of a net of a ten millionth of the size [1e-7 m]", np.asarray(small) * 1e7, expected,
          ROUND_OFF * 10.0)
    x[2] = x[0]
    raises("a link whose ends coincide", BadInput, lesson.distance_sweep, x, p)


@exercise("8.7", points=1, hint="predict, then net.sweeps sweeps, then the velocity from what was moved")
def test_a_weight_on_one_link_sags_by_what_its_sweeps_leave(lesson, draw):
    for sweeps in (1, draw.whole(2, 5)):
        s, dt, length = draw(0.2, 0.8), draw(0.01, 0.1), draw(0.5, 2.0)
        S = (1.0 - s) ** sweeps
        sag = G * dt * dt * S / (1.0 - S)
        x = np.array([[0.0, 0.0], [0.0, -length - sag]])
        p = net(lesson, [0.0, draw(0.2, 5.0)], [(0, 1)], length, 2, s, 0.0, sweeps)
        given = f"x = {x.tolist()} m, dt = {dt} s, {p}"
        new, v = lesson.pbd_step(lesson.falling_acceleration, 0.0, x, 0.0 * x, dt, p)
        close("a weight where it should rest, after a step [m]", new, x, ROUND_OFF, given=given)
        close("its velocity [m/s]", v, 0.0 * x, ROUND_OFF / dt, given=given)
        fast = np.array([[0.0, 0.0], [0.0, draw(1.0, 2.0)]])
        new, v = lesson.pbd_step(lesson.falling_acceleration, 0.0, x, fast, dt, p)
        expected = -length - S * (sag + G * dt * dt - dt * fast[1, 1])
        close("a weight that was thrown, after a step [m]", np.asarray(new)[1, 1], expected, ROUND_OFF, given=f"v = {fast[1]} m/s, {given}")
        close("its velocity [m/s]: what it has moved, over dt", np.asarray(v)[1, 1], (expected - x[1, 1]) / dt, ROUND_OFF / dt, given=given)
        carried_along(lesson.pbd_step, lesson, draw, x, dt, p, S)


@exercise("8.8", points=0.5, hint="S = (1 − s)ⁿ is what the sweeps leave; the sag is where falling by g dt² and being put back balance")
def test_the_sag_is_where_falling_and_projecting_balance(lesson, draw):
    for sweeps in (1, draw.whole(2, 6), draw.whole(7, 12)):
        g, dt, s, sag = draw(1.0, 20.0), draw(0.01, 0.1), draw(0.2, 0.8), 0.0
        for _ in range(400):                         # it converges by a factor S ≤ 0.8 each time
            sag = sag + g * dt * dt
            for _ in range(sweeps):
                sag -= s * sag
        close("sag [m]", lesson.pbd_sag(g, dt, s, sweeps), sag, ROUND_OFF,
              given=f"g = {g} m/s², dt = {dt} s, s = {s}, n = {sweeps}")
    close("sag of full stiffness [m]", lesson.pbd_sag(g, dt, 1.0, 1), 0.0, 0.0)


# ---------------------------------------------------------------------------------------------- folds and obstacles

def folded(draw, phi):
    """(4, 3): two drawn triangles with a common edge, folded by φ, in a drawn place of space."""
    e, up = direction(draw, 3), direction(draw, 3)
    up = np.cross(e, up)
    up = up / np.linalg.norm(up)
    side = np.cross(up, e)
    a, length = draw(-1.0, 1.0, 3), draw(0.7, 1.5)
    c = a + draw(0.2, 1.0) * length * e + draw(0.5, 1.2) * side
    d = a + draw(-0.3, 0.7) * length * e + draw(0.5, 1.2) * (-np.cos(phi) * side - np.sin(phi) * up)
    return np.stack((a, a + length * e, c, d))


def angle(x):
    """The angle of a fold, by what is seen along its edge: how far wing d is from being opposite to wing c."""
    e = x[1] - x[0]
    e = e / np.linalg.norm(e)
    c, d = (y - (y @ e) * e for y in (x[2] - x[0], x[0] - x[3]))
    return np.arctan2(np.cross(c, d) @ e, c @ d)


@exercise("8.9", points=0.75,
          hint="flat is 0; atan2 with (N_c × N_d) · e/|e| knows which way it is folded; take C into (−π, π], however far outside it is")
def test_a_fold_knows_its_angle_and_its_side(lesson, draw):
    for phi, wanted in ((draw(0.2, 2.5), draw(-0.5, 0.5)), (-draw(0.2, 2.5), draw(-0.5, 0.5)), (0.0, 0.0), (3.0, -draw(0.5, 2.5)), (-3.0, draw(0.5, 2.5)),
                        (draw(0.2, 2.5), draw(12.5, 15.0)), (-draw(0.2, 2.5), -draw(12.5, 15.0))):
        x = folded(draw, phi)
        expected = angle(x) - wanted
        while not -np.pi < expected <= np.pi:
            expected -= 2.0 * np.pi * np.sign(expected)
        close("angle, as the test has made it [rad]", abs(angle(x)), abs(phi), 1e-11)
        close("C of a fold [rad]", lesson.fold_constraint(x, wanted)[0], expected, 1e-11, given=f"corners {x.tolist()} m, wanted {wanted} rad")
    for wing in (2, 3):
        flat = x.copy()
        flat[wing] = x[0]
        raises("a triangle without area", BadInput, lesson.fold_constraint, flat, 0.0)
    # the angle of this sheet is exactly 0
    sheet = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, -1.0, 0.0]])
    close("C of a flat sheet that wants to be folded by π, or by −π [rad]",
          [lesson.fold_constraint(sheet, turn)[0] for turn in (np.pi, -np.pi)], [np.pi, np.pi], 0.0)


@exercise("8.9", points=0.75,
          hint="wings move the angle by |e|/|N| each, along their normals; what the edge does follows from leverage, β, and from Σ = 0")
def test_the_gradient_of_a_fold_is_the_slope_of_its_angle_and_pushes_nothing_from_outside(lesson, draw):
    for phi in (draw(0.3, 2.0), -draw(0.3, 2.0), 0.0):
        x, h = folded(draw, phi), 1e-5
        got = np.asarray(lesson.fold_constraint(x, 0.2)[1], dtype=float)
        slope = np.zeros((4, 3))
        for k in range(12):
            y = np.zeros(12)
            y[k] = h
            slope.flat[k] = (angle(x + y.reshape(4, 3)) - angle(x - y.reshape(4, 3))) / (2.0 * h)
        # central differences: h²/6 of a third derivative below 1e2, and 1e-16/h of round-off
        close("gradient of the angle [rad/m]", got, slope, 1e-8, given=f"corners {x.tolist()} m")
        close("Σ ∇C: no force from outside", got.sum(axis=0), np.zeros(3), ROUND_OFF * 10.0, given=f"corners {x.tolist()} m")
        close("Σ x × ∇C: no torque from outside", np.cross(x, got).sum(axis=0), np.zeros(3), ROUND_OFF * 10.0, given=f"corners {x.tolist()} m")


def smooth_angle(x):
    """The same angle by the tangent of its half, which takes complex numbers as well: away from ±π."""
    e = (x[1] - x[0]) / np.sqrt(np.sum((x[1] - x[0]) ** 2))
    c, d = (y - np.sum(y * e) * e for y in (x[2] - x[0], x[0] - x[3]))
    return 2.0 * np.arctan(np.sum(np.cross(c, d) * e) / (np.sqrt(np.sum(c * c) * np.sum(d * d)) + np.sum(c * d)))


@exercise("8.9", points=0.5,
          hint="beside an obtuse angle β is below 0 or above 1: leave it so; and a small fold is a fold")
def test_folds_with_acute_and_obtuse_wings_have_the_slope_of_their_angle_at_any_size(lesson, draw):
    """The slope by a complex step, exact to round-off; tan ½θ is below 15, heights are above 0.3 of the size."""
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
                slope = np.array([smooth_angle(x + 1j * TINY * move.reshape(4, 3)).imag / TINY
                                  for move in np.eye(12)]).reshape(4, 3)
                C, gradient = lesson.fold_constraint(place + size * x, 0.0)
                given = f"corners {(place + size * x).tolist()} m"
                close("C of a fold [rad]", C, smooth_angle(x), 1e-10, given)
                close("its gradient times the size [rad]", size * np.asarray(gradient), slope, 1e-9, given)


@exercise("8.10", points=0.25,
          hint="|x − centre| − radius: positive outside; n points away from the centre, and is 0 there")
def test_a_ball_knows_how_far_away_its_skin_is(lesson, draw):
    for d in (2, 3):
        ball = lesson.Obstacle(draw(-2.0, 2.0, d), draw(0.5, 2.0), np.zeros(d), np.eye(d)[0])
        for distance in (draw(0.1, 0.4), draw(2.5, 4.0)):
            n = direction(draw, d)
            phi, normal = lesson.ball_gap(ball.centre + distance * n, ball)
            close("gap of a ball [m]", phi, distance - ball.radius, ROUND_OFF, given=f"{ball}, {distance} m along {n}")
            close("normal of a ball [-]", normal, n, ROUND_OFF, given=f"{ball}, {distance} m along {n}")
        phi, normal = lesson.ball_gap(ball.centre, ball)
        close("gap in the middle [m]", phi, -ball.radius, ROUND_OFF)
        close("normal in the middle [-]", normal, np.zeros(d), 0.0)


@exercise("8.10", points=0.25,
          hint="|x − centre| − radius wherever x is, close to the middle and far away; a radius of 0 is no exception")
def test_no_point_of_the_skin_is_nearer_than_the_gap_says(lesson, draw):
    for d in (2, 3):
        for size, place in places(draw, d):
            skin = np.array([direction(draw, d) for _ in range(20)])
            for radius in (0.0, 1.0):
                for distance in (1e-3, draw(0.1, 0.9), draw(1.1, 3.0)):
                    n = direction(draw, d)
                    ball = lesson.Obstacle(place, radius * size, np.zeros(d), np.eye(d)[0])
                    x = place + size * distance * n
                    phi, normal = lesson.ball_gap(x, ball)
                    normal, given = np.asarray(normal, dtype=float), f"{ball}, x = {x} m"
                    close("gap over the size [-]", phi / size, distance - radius, ROUND_OFF * 10.0, given)
                    close("normal, which a thousand sizes away is known to 1e-13 of the distance [-]", normal, n, 1e-9,
                          given)
                    close("x − φ n from the centre, over the size [-]: on the skin",
                          np.linalg.norm(x - phi * normal - place) / size, radius, ROUND_OFF * 10.0, given)
                    others = np.linalg.norm(x - place - radius * size * skin, axis=1).min() / size
                    between("how much nearer another point of the skin is, over the size [-]", abs(phi) / size - others,
                            -1e9, ROUND_OFF * 10.0, given)


def balloon(x, obstacle):
    """A surface that no lesson has: (φ, n) of a ball twice as large as it says."""
    r = x - obstacle.centre
    distance = np.sqrt(np.sum(r * r))
    return distance - 2.0 * obstacle.radius, r / distance


@exercise("8.11", points=0.5, hint="only where φ < 0, only what can move, straight along n by −φ; φ and n are those of the surface that was handed in")
def test_what_has_got_inside_is_put_onto_the_skin_and_the_rest_is_left_alone(lesson, draw):
    n, tangent = direction(draw, 3), direction(draw, 3)
    tangent = np.cross(n, tangent)
    floor = lesson.Obstacle(np.zeros(3), 0.0, draw(-1.0, 1.0, 3), n)
    heights = np.array([-draw(0.1, 0.5), draw(0.1, 0.5), -draw(0.1, 0.5), 0.0])
    x = floor.point + np.outer(heights, n) + np.outer(draw(-1.0, 1.0, 4), tangent)
    before, w = x.copy(), np.array([draw(0.5, 2.0), 1.0, 0.0, 1.0])
    new = np.asarray(lesson.keep_outside(lesson.floor_gap, x, w, floor), dtype=float)
    given = f"heights {heights} m over the floor {floor}, w = {w}"
    close("where a point inside is put [m]", new[0], x[0] - heights[0] * n, ROUND_OFF, given=given)
    close("points outside, and immovable ones [m]", new[1:3], x[1:3], 0.0, given=given)
    close("a point on the skin [m]", new[3], x[3], ROUND_OFF, given=given)
    close("the x that was handed in: return a new array", x, before, 0.0)
    ball = floor._replace(centre=draw(-1.0, 1.0, 3), radius=draw(0.5, 1.0))
    out, distances = np.stack((n, -n, tangent / np.linalg.norm(tangent))), 2.0 * ball.radius * np.array([draw(0.2, 0.9), draw(0.2, 0.9), draw(1.1, 2.0)])
    x = ball.centre + out * distances[:, None]
    close("points in and out of a ball of twice the radius, by a surface of our own [m]", lesson.keep_outside(balloon, x, np.ones(3), ball),
          ball.centre + out * np.maximum(distances, 2.0 * ball.radius)[:, None], ROUND_OFF * 10.0, given=f"x = {x.tolist()} m, {ball}")


@exercise("8.11", points=0.5,
          hint="each point has its own φ and n; how heavy it is does not matter, only whether it can move")
def test_every_point_goes_to_the_nearest_point_outside_however_many_how_deep_and_how_heavy(lesson, draw):
    for size, place in places(draw, 3):
        n = direction(draw, 3)
        floor, x, w = lesson.Obstacle(np.zeros(3), 0.0, place, n), place + size * draw(-2.0, 2.0,
                                                                                       (12, 3)), 10.0 ** draw(-3.0, 3.0,
                                                                                                              12)
        w[draw.whole(0, 11)] = 0.0
        heights = (x - place) @ n
        new = np.asarray(lesson.keep_outside(lesson.floor_gap, x, w, floor), dtype=float)
        inside, given = (heights < 0.0) & (w > 0.0), f"heights {heights} m over the floor {floor}, w = {w}"
        close("points that stay where they are [m]", new[~inside], x[~inside], 0.0, given)
        close("heights of the others afterwards, over the size [-]", (new[inside] - place) @ n / size,
              np.zeros(inside.sum()), ROUND_OFF * 10.0, given)
        close("how far they have moved, over the size [-]: no farther than needed",
              np.linalg.norm(new - x, axis=1)[inside] / size, -heights[inside] / size, ROUND_OFF * 10.0, given)


# ---------------------------------------------------------------------------------------------- XPBD

@exercise("8.12", points=0.5, hint="(−C − α̃ Λ)/(weight + α̃): after the visit C + α̃ Λ is zero")
def test_after_a_visit_a_compliant_constraint_obeys_hookes_law(lesson, draw):
    for alpha, side, other in ((0.0, 1, 1), (0.0, -1, 1), (draw(0.001, 0.1), 1, -1), (draw(0.001, 0.1), -1, -1)):
        C, Lam, weight, dt = side * draw(0.1, 1.0), other * draw(0.1, 1.0), draw(0.2, 2.0), draw(0.05, 0.5)
        change = lesson.compliant_multiplier(C, Lam, weight, alpha / dt**2)
        given = f"C = {C} m, Λ = {Lam} N s², weight {weight} /kg, α = {alpha} m/N, dt = {dt} s"
        close("C + α λ after a visit [m]", C + weight * change + alpha * (Lam + change) / dt**2, 0.0, 1e-10, given=given)


@exercise("8.12", points=0.5, hint="ask `not alpha_scaled >= 0.0`, which NaN answers, too; and a weight of 0 before you divide")
def test_a_negative_compliance_and_a_constraint_without_mass_are_refused(lesson, draw):
    C, alpha = draw(0.1, 1.0), draw(0.001, 0.1)
    change = lesson.compliant_multiplier(C, 0.0, 1.0, alpha / 0.1**2)
    close("C + α λ after an ordinary visit [m]", C + change + alpha * change / 0.1**2, 0.0, 1e-10, given=f"C = {C} m, α = {alpha} m/N")
    for alpha in (-draw(0.001, 0.1), np.nan):
        raises("a compliance that is none", BadInput, lesson.compliant_multiplier, 0.1, 0.0, 1.0, alpha)
    for alpha in (0.0, draw(0.001, 0.1)):
        raises("a constraint with no free mass", BadInput, lesson.compliant_multiplier, 0.1, 0.0, 0.0, alpha)


@exercise("8.13", points=1, hint="Λ of each link goes on from where it was; add w ΔΛ n to i and take it from j")
def test_a_visit_to_a_spring_leaves_it_in_balance_with_what_it_has_pulled(lesson, draw):
    for d in (2, 3):
        x, w = np.stack((draw(-1.0, 1.0, d), draw(2.0, 3.0, d))), draw(0.3, 2.0, 2)
        p = net(lesson, w, [(0, 1)], draw(0.5, 1.0) if d == 2 else draw(8.0, 9.0), d, 0.4, draw(0.001, 0.1))
        Lam, dt, before = np.array([-draw(0.1, 0.5)]), draw(0.1, 0.4), x.copy()
        kept = Lam.copy()
        new, total = lesson.compliant_sweep(x, Lam, dt, p)
        new, total = np.asarray(new, dtype=float), np.asarray(total, dtype=float)
        given = f"x = {x.tolist()} m, Λ = {Lam}, dt = {dt} s, {p}"
        close("C + α λ after a visit [m]", lengths(new, p) - p.rest + p.alpha * total / dt**2, np.zeros(1), 1e-11, given=given)
        pull = (total - Lam) * (x[0] - x[1]) / np.linalg.norm(x[0] - x[1])
        close("how both ends moved [m]: by w and ΔΛ, along the link", new - x, np.stack((w[0] * pull, -w[1] * pull)), 1e-11, given=given)
        close("the x that was handed in: return a new array", x, before, 0.0)
        close("the Λ that was handed in: return a new array", Lam, kept, 0.0)


@exercise("8.13", points=0.5, hint="every link has its own Λ and α, and starts from where the ones before it have put its ends")
def test_springs_are_visited_one_after_the_other(lesson, draw):
    """Points 0 (held), 2, 1 on a line: the first visit pulls point 2 towards 0 by −w ΔΛ, which lengthens the second link."""
    n, begin, dt, w = direction(draw, 2), draw(-1.0, 1.0, 2), draw(0.1, 0.4), draw(0.5, 2.0, 2)
    stretch, rest, alpha = draw(0.1, 0.5, 2), draw(0.8, 1.2, 2), draw(0.001, 0.1, 2)
    middle, end = rest[0] + stretch[0], rest.sum() + stretch.sum()
    x = begin + np.outer([0.0, end, middle], n)
    p = net(lesson, [0.0, *w], [(0, 2), (2, 1)], rest, 2, 0.4, alpha)
    new, Lam = lesson.compliant_sweep(x, np.zeros(2), dt, p)
    soft = alpha / dt**2
    first = -stretch[0] / (w[1] + soft[0])
    second = -(stretch[1] - w[1] * first) / (w[0] + w[1] + soft[1])
    close("Λ after a sweep [N s²]", Lam, [first, second], 1e-11, given=f"x = {x.tolist()} m, dt = {dt} s, {p}")
    close("positions after a sweep [m]", new, begin + np.outer([0.0, end + w[0] * second, middle + w[1] * (first - second)], n), 1e-11,
          given=f"x = {x.tolist()} m, dt = {dt} s, {p}")
    small, _ = lesson.compliant_sweep(1e-7 * x, np.zeros(2), dt, p._replace(rest=1e-7 * p.rest))
    close("positions of a net of a ten millionth of the size [1e-7 m]", np.asarray(small) * 1e7,
          np.asarray(new, dtype=float), 1e-11)
    x[2] = x[0]
    raises("a link whose ends coincide", BadInput, lesson.compliant_sweep, x, np.zeros(2), dt, p)


@exercise("8.14", points=1, hint="Λ begins with a zero for each link at every step, and is handed from sweep to sweep within it")
def test_one_spring_is_implicit_euler_whatever_the_step_and_the_sweeps(lesson, draw):
    """v⁺ = (v − dt (k/m) s + dt (−g))/(1 + dt² k/m),  s the stretch: implicit Euler of m s̈ = −k s − m g, in y; along a line it stays one."""
    for sweeps in (1, draw.whole(2, 6)):
        m, k, rest, dt = draw(0.3, 3.0), draw(10.0, 500.0), draw(0.5, 1.5), draw(0.01, 0.2)
        stretch, speed = draw(-0.2, 0.2), draw(-1.0, 1.0)
        x, v = np.array([[0.0, 0.0], [0.0, -rest - stretch]]), np.array([[0.0, 0.0], [0.0, speed]])
        p = net(lesson, [0.0, 1.0 / m], [(0, 1)], rest, 2, 1.0, 1.0 / k, sweeps)
        given = f"m = {m} kg, k = {k} N/m, dt = {dt} s, stretch {stretch} m, v = {speed} m/s, {sweeps} sweeps"
        new, v_new = lesson.xpbd_step(lesson.falling_acceleration, 0.0, x, v, dt, p)
        expected = (speed + dt * (k / m * stretch - G)) / (1.0 + dt * dt * k / m)
        close("velocity after a step [m/s]: implicit Euler's", np.asarray(v_new)[1, 1], expected, 1e-10, given=given)
        close("position after a step [m]", np.asarray(new)[1, 1], x[1, 1] + dt * expected, 1e-11, given=given)
        hanging = np.array([[0.0, 0.0], [0.0, -rest - m * G / k]])
        new, _ = lesson.xpbd_step(lesson.falling_acceleration, 0.0, hanging, 0.0 * v, dt, p)
        close("where a weight hangs after a step [m]: m g/k lower", new, hanging, 1e-11, given=given)
        soft = 1.0 / (k * dt * dt)
        carried_along(lesson.xpbd_step, lesson, draw, x, dt, p, soft / (1.0 / m + soft))
        # three springs side by side: more links than points, each with a Λ of its own
        soft = soft * draw(0.5, 2.0, 3)
        side_by_side = net(lesson, [0.0, 1.0 / m], [(0, 1)] * 3, rest, 2, 1.0, soft * dt * dt)
        carried_along(lesson.xpbd_step, lesson, draw, x, dt, side_by_side, np.prod(soft / (1.0 / m + soft)))


# ---------------------------------------------------------------------------------------------- rigid bodies

def body(draw):
    """(q, R, m, I_body): a drawn orientation, and R by Rodrigues' formula."""
    axis, turn = direction(draw, 3), draw(0.3, 2.5)
    K = np.array([[0.0, -axis[2], axis[1]], [axis[2], 0.0, -axis[0]], [-axis[1], axis[0], 0.0]])
    R = np.eye(3) + np.sin(turn) * K + (1.0 - np.cos(turn)) * K @ K
    low = draw(0.5, 1.0, 2)
    return np.append(np.cos(0.5 * turn), np.sin(0.5 * turn) * axis), R, draw(0.5, 3.0), np.array([low[0], low[1], draw(0.95, 1.0) * low.sum()])


@exercise("8.15", points=1, hint="r × n in the body's coordinates, squared over the moments; 1/m beside it")
def test_a_point_of_a_body_gives_way_as_an_impulse_there_would_make_it(lesson, draw):
    """An impulse n at r gives v = n/m and ω = I⁻¹(r × n): the point moves along n with n·(v + ω × r)."""
    q, R, m, I_body = body(draw)
    for r, m in ((draw(-1.0, 1.0, 3), m), (np.zeros(3), m), (draw(-1.0, 1.0, 3), 0.1 * m),
                 (draw(-1.0, 1.0, 3), 10.0 * m)):
        n = direction(draw, 3)
        omega = R @ np.diag(1.0 / I_body) @ R.T @ np.cross(r, n)
        close("generalised inverse mass [1/kg]", lesson.generalised_inverse_mass(q, r, n, m, I_body), n @ (n / m + np.cross(omega, r)), ROUND_OFF,
              given=f"q = {q}, r = {r} m, n = {n}, m = {m} kg, I = {I_body}")


def turn_of(q_new, q_old):
    """Matrix by which a body has turned, from two quaternions."""
    def matrix(q):
        w, v = q[0], q[1:]
        K = np.array([[0.0, -v[2], v[1]], [v[2], 0.0, -v[0]], [-v[1], v[0], 0.0]])
        return np.eye(3) + 2.0 * w * K + 2.0 * K @ K
    return matrix(q_new) @ matrix(q_old).T


@exercise("8.16", points=1.5, hint="the turn is I⁻¹(r × p), in the world; quaternion_update(q, turn, 1.0) turns by it and keeps |q| = 1")
def test_a_push_beside_the_centre_moves_and_turns_a_body(lesson, draw):
    q, R, m, I_body = body(draw)
    x, r, p = draw(-1.0, 1.0, 3), draw(-1.0, 1.0, 3), draw(-1.0, 1.0, 3)
    for other in (0.1 * m, 10.0 * m):
        close("centre of mass of a body of another mass [m]", lesson.push_body(x, q, r, p, other, I_body)[0],
              x + p / other, ROUND_OFF * 10.0, given=f"p = {p} kg m, m = {other} kg")
    new, turned = lesson.push_body(x, q, r, p, m, I_body)
    given = f"q = {q}, r = {r} m, p = {p} kg m, m = {m} kg, I = {I_body}"
    close("centre of mass [m]", new, x + p / m, ROUND_OFF, given=given)
    turned = np.asarray(turned, dtype=float)
    close("length of the quaternion [-]", np.linalg.norm(turned), 1.0, ROUND_OFF, given=given)
    turn = R @ np.diag(1.0 / I_body) @ R.T @ np.cross(r, p)
    angle, axis = 2.0 * np.arctan(0.5 * np.linalg.norm(turn)), turn / np.linalg.norm(turn)
    K = np.array([[0.0, -axis[2], axis[1]], [axis[2], 0.0, -axis[0]], [-axis[1], axis[0], 0.0]])
    close("by what matrix it has turned [-]", turn_of(turned, q), np.eye(3) + np.sin(angle) * K + (1.0 - np.cos(angle)) * K @ K, 1e-11, given=given)


@exercise("8.17", points=0.5, hint="Δq = q_new q̄_old; twice its vector over its first number, over dt")
def test_a_turn_has_the_rate_that_leads_from_one_orientation_to_the_other(lesson, draw):
    q, _, _, _ = body(draw)
    axis, angle, dt = direction(draw, 3), draw(0.1, 2.0), draw(0.05, 0.5)
    half, s = np.cos(0.5 * angle), np.sin(0.5 * angle)
    a, v = q[0], q[1:]
    turned = np.append(half * a - s * axis @ v, half * v + a * s * axis + s * np.cross(axis, v))
    for still in (q, np.array([1.0, 0.0, 0.0, 0.0])):
        close("rate of what does not turn [rad/s]", lesson.turning_rate(still, still.copy(), dt), np.zeros(3), ROUND_OFF, given=f"q = {still}, dt = {dt} s")
    for sign in (1.0, -1.0):
        close("rate of a turn [rad/s]", lesson.turning_rate(q, sign * turned, dt), 2.0 * np.tan(0.5 * angle) / dt * axis, 1e-10, given=f"q = {q}, {angle} rad about {axis} in {dt} s")


# ---------------------------------------------------------------------------------------------- a soft ball

CUBE = np.array([[0, 2, 1], [1, 2, 3], [4, 5, 6], [5, 7, 6], [0, 1, 4], [1, 5, 4], [2, 6, 3], [3, 6, 7], [0, 4, 2], [2, 4, 6], [1, 3, 5], [3, 7, 5]])


@exercise("8.18", points=0.5,
          hint="a sixth of a · (b × c) for every face; its slope with a is b × c/6, and so on in turns")
def test_a_closed_surface_knows_its_volume_and_how_its_corners_change_it(lesson, draw):
    """A box between three drawn vectors has the volume |u · (v × w)|; the volume is linear in each coordinate of a corner."""
    u, v, w = (np.eye(3)[k] * draw(1.0, 2.0) + draw(-0.3, 0.3, 3) for k in range(3))
    corners = np.array([[k & 1, k >> 1 & 1, k >> 2] for k in range(8)])
    x = np.append(draw(-2.0, 2.0, 3) + corners @ np.stack((u, v, w)), draw(-2.0, 2.0, (1, 3)), axis=0)
    V, gradient = lesson.volume_gradient(x, CUBE)
    close("volume of a slanting box [m³]", V, u @ np.cross(v, w), 1e-11, given=f"corners {x.tolist()} m")
    gradient = np.asarray(gradient, dtype=float)
    close("slope of the volume with corner 8, which is in no face [m²]", gradient[8:], np.zeros((1, 3)), 0.0, given=f"corners {x.tolist()} m")
    close("Σ ∇V [m²]: pushed as a whole it keeps its volume", gradient.sum(axis=0), np.zeros(3), 1e-11, given=f"corners {x.tolist()} m")
    change = draw(-0.5, 0.5, 3)
    for k in (0, 3, 6):
        y = x.copy()
        y[k] += change
        close("how one corner changes the volume [m³]", gradient[k] @ change, lesson.volume_gradient(y, CUBE)[0] - V, 1e-11, given=f"corners {x.tolist()} m, corner {k} by {change} m")


def volume(x, faces, o):
    """Σ of the tetrahedra from o to each face [m³], of complex numbers as well."""
    a, b, c = (x[faces[:, k]] - o for k in range(3))
    return np.sum(a * np.cross(b, c)) / 6.0


@exercise("8.18", points=0.5,
          hint="keep every sign: a surface turned inside-out has a negative volume and the opposite slope")
def test_lumps_small_and_large_and_inside_out_have_the_volume_of_their_hull_and_its_slope(lesson, draw):
    """Brute force: the volume of the convex hull; its slope by a complex step of tetrahedra about their middle."""
    for size in (1e-6, 1.0, 1e3):
        for far in (0.0, 3.0):
            x, faces = solid(draw(-0.5, 0.5, (10, 3)) + far * draw(-1.0, 1.0, 3))
            middle, moves = x.mean(axis=0), np.eye(x.size).reshape(-1, *x.shape)
            slope = np.array([volume(x + 1j * TINY * move, faces, middle).imag / TINY
                              for move in moves]).reshape(x.shape)
            for what, sign, turned in (("a lump", 1.0, faces),
                                       ("a lump inside-out", -1.0, np.ascontiguousarray(faces[:, ::-1]))):
                V, gradient = lesson.volume_gradient(size * x, turned)
                given = f"corners {(size * x).tolist()} m, triangles {turned.tolist()}"
                close(f"volume of {what}, over its size [-]", V / size**3, sign * ConvexHull(x).volume, 1e-11, given)
                close(f"slope of the volume of {what}, over its size [-]", np.asarray(gradient) / size**2, sign * slope,
                      1e-11, given)
