"""Lesson 3: a support only pushes, friction removes all the energy its cone allows, and a held block stays at rest."""

import itertools

import numpy as np
import pytest
from scipy.optimize import brentq

from solutions.checks import BadInput
from validate.grading.expect import NotYet, between, choice, close, raises, truth
from validate.reference import choices
from validate.reference.choices.friction import LOAD, MU_K, MU_S

exercise = pytest.mark.exercise
G = 9.81                     # [m/s²]
# All drawn values are below 30 in their unit. A result takes a few dozen operations, each with a round-off of 1.1e-16.
ROUND_OFF = 1e-12
NEW = 0.02                   # a floor of one's own differs from the known ones by this share of its impulses [-]
# Usual, tiny and huge velocities, loads and lengths.  Powers of two: what is exact at one size is exact at the others.
SIZES = (1.0, 2.0**-100, 2.0**100)
BARELY = 1e-9                # this share beyond a threshold, or within it, is far above the round-off of either side


WAYS = ((2, True), (3, True), (2, False), (3, False))     # d and turned of a frame


def smooth_or_rough(draw):
    """Two drawn frictions, one below 1 and one above: steel on steel, and rubber on rubber."""
    return draw(0.2, 0.6), draw(1.1, 2.0)


def frame(draw, d, turned=True):
    """Rows n, t_1 (, t_2): a drawn unit normal and unit tangents in d dimensions.

    turned: none along a coordinate axis; False: all along one
    """
    if not turned:
        return np.roll(np.eye(d), draw.whole(0, d - 1), axis=0)
    turn = draw(0.2, 1.3) + 0.5 * np.pi * draw.whole(0, 3)
    n, t_1 = np.array([-np.sin(turn), np.cos(turn)]), np.array([np.cos(turn), np.sin(turn)])
    if d == 2:
        return np.stack([n, t_1])
    tilt = draw(0.2, 1.3)
    n, t_1 = np.append(np.cos(tilt) * n, np.sin(tilt)), np.append(t_1, 0.0)
    return np.stack([n, t_1, np.cross(n, t_1)])


def along_surface(draw, axes, size):
    """A vector of length `size` along the surface, in a drawn direction."""
    if len(axes) == 2:
        return size * axes[1] * (2 * draw.whole(0, 1) - 1)
    heading = draw(0.0, 2.0 * np.pi)
    return size * (np.cos(heading) * axes[1] + np.sin(heading) * axes[2])


def plain_pairs():
    """Pairs (n, along) of unit vectors (d,), a normal and a direction along its surface, in 2 and 3 dimensions.

    All coordinates of `along` but one are 0, or they add up to exactly 0.  A test for zero that looks at one
    coordinate, or at the sum, the product or the largest of them, takes some of these vectors for zero.
    """
    pairs = []
    for d in (2, 3):
        axes = np.eye(d)
        pairs += [(axes[k], axes[i]) for k, i in itertools.permutations(range(d), 2)]
        pairs += [(axes[k], np.sqrt(0.5) * (axes[k - 2] - axes[k - 1])) for k in range(d) if d == 3]
    pairs.append((np.sqrt([0.5, 0.5]), np.sqrt([0.5, 0.5]) * [1.0, -1.0]))
    return [(n, sign * along) for n, along in pairs for sign in (1.0, -1.0)]


# ---------------------------------------------------------------------------------------------- at rest and sliding

@exercise("3.1", points=1, hint="the part of F against n: −F · n, but never less than zero")
def test_a_support_balances_a_pressing_force_and_exerts_none_on_a_lifted_body(lesson, draw):
    for (d, turned), size in itertools.product(WAYS, SIZES):
        for load, along in ((draw(1.0, 20.0), draw(1.0, 20.0)), (1e-6, draw(1.0, 20.0)), (draw(1.0, 20.0), 0.0),
                            (0.0, 0.0)):
            axes, load = frame(draw, d, turned), size * load
            n, pull = axes[0], along_surface(draw, axes, size * along)
            # The lift first: without the minus sign a formula returns the lift here, and 0 for a load.
            close("normal force when F lifts [N]", lesson.normal_force(pull + load * n, n), 0.0, 0.0,
                  given=f"lift {load} N, n = {n}")
            close("normal force [N]", lesson.normal_force(pull - load * n, n), load, ROUND_OFF * size,
                  given=f"load {load} N, n = {n}")


@exercise("3.2", points=0.25,
          hint="inside the cone friction is −F_t, neither more nor less: F + F_s has no tangential part")
def test_static_friction_balances_a_pull_inside_its_cone(lesson, draw):
    for (d, turned), size in itertools.product(WAYS, SIZES):
        axes, load, mu = frame(draw, d, turned), size * draw(1.0, 20.0), draw(0.2, 1.5)
        for share, friction in (*((share, mu) for share in draw.within()), (draw(2.0, 5.0), np.inf), (0.0, mu),
                                (1.0 - BARELY, mu), (0.0, 0.0)):
            pull = along_surface(draw, axes, share * mu * load)
            got = lesson.static_friction(pull - load * axes[0], axes[0], friction)
            close("friction on a body that holds [N]", got, -pull, ROUND_OFF * size,
                  given=f"pull {pull} N, load {load} N, μ = {friction}")
    load = draw(1.0, 20.0)
    for n, along in plain_pairs():
        pull = draw(0.1, 0.9) * mu * load * along
        close("friction on a body that a pull along an axis or a diagonal does not move [N]",
              lesson.static_friction(pull - load * n, n, mu), -pull, ROUND_OFF,
              given=f"pull {pull} N, load {load} N, n = {n}, μ = {mu}")


@exercise("3.2", points=0.25,
          hint="beyond the cone its magnitude is μ_s F_N, where F_N is the normal force of F; it points against F_t")
def test_static_friction_reaches_its_limit_beyond_its_cone(lesson, draw):
    for (d, turned), size in itertools.product(WAYS, SIZES):
        axes, load, mu = frame(draw, d, turned), size * draw(1.0, 10.0), draw(0.2, 1.0)
        for share, friction in (*((share, mu) for share in (*draw.beyond(3.0), 1.0 + BARELY)), (draw(1.1, 3.0), 0.0)):
            pull = along_surface(draw, axes, share * mu * load)
            got = lesson.static_friction(pull - load * axes[0], axes[0], friction)
            expected = -friction * load * pull / np.linalg.norm(pull)
            close("friction on a body that slips [N]", got, expected, ROUND_OFF * size,
                  given=f"pull {pull} N, load {load} N, μ = {friction}")
    load = draw(1.0, 10.0)
    for n, along in plain_pairs():
        pull = draw(1.1, 3.0) * mu * load * along
        close("friction on a body that a pull along an axis or a diagonal moves [N]",
              lesson.static_friction(pull - load * n, n, mu), -mu * load * along, ROUND_OFF,
              given=f"pull {pull} N, load {load} N, n = {n}, μ = {mu}")


@exercise("3.2", points=0.25,
          hint="without a load there is no friction: cone_radius(mu_s, normal_force(F, n)) is then 0, even for μ_s = ∞")
def test_a_lifted_body_feels_no_friction(lesson, draw):
    axes = frame(draw, 3)
    pull = along_surface(draw, axes, draw(1.0, 5.0))
    close("friction on a body that is pressed [N]", lesson.static_friction(pull - axes[0], axes[0], np.inf),
          -pull, ROUND_OFF, given=f"pull {pull} N, load 1 N, μ = ∞")
    lifting = pull + draw(1.0, 5.0) * axes[0]
    for mu in (draw(0.2, 1.5), np.inf):
        close("friction on a body that is lifted [N]", lesson.static_friction(lifting, axes[0], mu), np.zeros(3), 0.0,
              given=f"F = {lifting} N, μ = {mu}")
        for pull in (np.zeros(2), draw(1.0, 5.0) * np.array([1.0, 0.0])):
            got = lesson.static_friction(pull, np.array([0.0, 1.0]), mu)
            close("friction on a body that is neither pressed nor lifted [N]", got, np.zeros(2), 0.0,
                  given=f"F = {pull} N, μ = {mu}")


@exercise("3.2", points=0.25, hint="let cone_radius compute μ_s F_N: it refuses a negative μ")
def test_negative_friction_is_refused(lesson, draw):
    pull, n = draw(0.5, 1.5), np.array([0.0, 1.0])
    F = np.array([pull, -5.0])
    close("friction with a positive μ_s [N]", lesson.static_friction(F, n, draw(0.4, 1.0)), [-pull, 0.0], ROUND_OFF,
          given=f"F = {F} N")
    raises("a negative μ_s", BadInput, lesson.static_friction, F, n, -draw(0.1, 1.0))


@exercise("3.3", points=0.5, hint="it points against the motion, not against F; its size is μ_k F_N at every speed")
def test_kinetic_friction_opposes_the_motion_with_a_size_independent_of_speed(lesson, draw):
    for d, turned in WAYS:
        axes, load, mu = frame(draw, d, turned), draw(1.0, 10.0), smooth_or_rough(draw)[turned]
        n, F = axes[0], along_surface(draw, axes, draw(1.0, 20.0)) - load * axes[0]
        direction = along_surface(draw, axes, 1.0)
        for speed, sinking in ((1e-12, 0.0), (1e-6, 0.0), (draw(0.5, 9.0), 0.0), (draw(0.5, 9.0), draw(-2.0, 2.0))):
            got = lesson.kinetic_friction(F, speed * direction + sinking * n, n, mu)
            # Friction has the direction of v_t, whose round-off is 1e-16 of v.
            close("friction on a sliding body [N]", got, -mu * load * direction, 1e-8 if speed < 1e-3 else 1e-11,
                  given=f"F = {F} N, speed {speed} m/s, sinking {sinking} m/s, μ = {mu}")
    for (n, along), slow, light in itertools.product(plain_pairs(), SIZES, SIZES):
        v, F = slow * draw(0.5, 9.0) * along, -light * load * n
        got = np.asarray(lesson.kinetic_friction(F, v, n, mu))
        close("friction on a body that slides along an axis or a diagonal, over its load [-]", got / light / load,
              -mu * along, ROUND_OFF, given=f"F = {F} N, v = {v} m/s, n = {n}, μ = {mu}")


@exercise("3.3", points=0.5, hint="where v_t is zero there is no direction to oppose: return zeros before dividing")
def test_kinetic_friction_needs_a_motion_and_a_load(lesson, draw):
    axes, mu = frame(draw, 3), draw(0.2, 1.0)
    F = along_surface(draw, axes, draw(1.0, 9.0))
    still, moving = np.zeros(3), along_surface(draw, axes, draw(1.0, 3.0))
    for pull in (F, draw(0.1, 0.9) * mu / np.linalg.norm(F) * F, 0.0 * F):           # at rest the last two would hold
        close("kinetic friction under a load of 1 N [N]", lesson.kinetic_friction(pull - axes[0], moving, axes[0], mu),
              -mu * moving / np.linalg.norm(moving), 1e-11, given=f"F = {pull - axes[0]} N")
    close("kinetic friction at rest [N]", lesson.kinetic_friction(F - axes[0], still, axes[0], mu), still, 0.0,
          given=f"F = {F} N")
    close("kinetic friction where μ = 0 [N]", lesson.kinetic_friction(F - axes[0], moving, axes[0], 0.0), still, 0.0,
          given=f"F = {F} N")
    close("kinetic friction without any other force [N]", lesson.kinetic_friction(still, moving, axes[0], mu), still,
          0.0, given=f"v = {moving} m/s")
    sinks = draw(-3.0, -1.0) * np.array([0.0, 1.0])
    close("kinetic friction on a body that moves against the support only [N]",
          lesson.kinetic_friction(np.array([1.0, -1.0]), sinks, np.array([0.0, 1.0]), mu), 0.0 * sinks, 0.0,
          given=f"v = {sinks} m/s")
    for friction in (mu, np.inf):
        close("kinetic friction without load [N]", lesson.kinetic_friction(F + axes[0], moving, axes[0], friction),
              still, 0.0, given=f"F = {F} N, μ = {friction}")
    raises("a negative μ_k", BadInput, lesson.kinetic_friction, F - axes[0], moving, axes[0], -mu)


@exercise("3.4", points=0.5,
          hint="static friction decides whether the block starts to slide, kinetic friction acts while it slides")
def test_a_block_slides_when_the_slope_is_steeper_than_the_cone_is_wide(lesson, draw):
    for theta, g in ((draw(0.2, 1.2), draw(1.0, 15.0)), (draw(1.3, 1.4), draw(1.0, 15.0))):     # the second: μ_k > 1
        down, n = np.array([np.cos(theta), -np.sin(theta)]), np.array([np.sin(theta), np.cos(theta)])
        weight = np.array([0.0, -g])
        mu_s, mu_k = draw(0.6, 0.95) * np.tan(theta), draw(0.3, 0.5) * np.tan(theta)
        given = f"θ = {theta} rad, μ_s = {mu_s}, μ_k = {mu_k}, g = {g} m/s²"
        # the force vectors in world coordinates
        expected = weight @ down - mu_k * abs(weight @ n)
        close("acceleration down the slope [m/s²]", lesson.incline_acceleration(theta, mu_s, mu_k, g), expected,
              ROUND_OFF, given=given)
        close("without friction [m/s²]", lesson.incline_acceleration(theta, 0.0, 0.0, g), weight @ down, ROUND_OFF,
              given=given)


@exercise("3.4", points=0.5,
          hint="where sin θ ≤ μ_s cos θ the block holds, even if μ_k alone could not hold it")
def test_a_block_holds_up_to_the_angle_whose_tangent_is_mu(lesson, draw):
    mu, g = draw(0.2, 1.5), draw(1.0, 15.0)
    edge = np.arctan(mu)
    for theta, mu_k in ((0.0, mu), (0.0, 0.0), (draw(0.2, 0.9) * edge, mu), (0.999999 * edge, 0.1 * mu),
                        (draw(0.2, 0.9) * edge, 0.0)):
        close("acceleration of a block that holds [m/s²]", lesson.incline_acceleration(theta, mu, mu_k, g), 0.0, 0.0,
              given=f"θ = {theta}, μ_s = {mu}, μ_k = {mu_k}")
    tiny = draw(1e-9, 2e-9)                              # its sine and its tangent are the same float, its cosine is 1
    close("acceleration where sin θ is exactly μ_s cos θ [m/s²]: the block holds",
          lesson.incline_acceleration(tiny, tiny, 0.5 * tiny, g), 0.0, 0.0, given=f"θ = {tiny}, μ_s = {tiny}")
    for rough, past in itertools.product((mu, 1e-3, 1e-7, 1e-20), (1e-6, BARELY)):       # the last ones are ice
        edge = np.arctan(rough)
        theta = (1.0 + past) * edge
        given = f"θ = {theta}, μ_s = μ_k = {rough}, g = {g} m/s²"
        close("acceleration barely beyond the edge, over that without friction [-]",
              lesson.incline_acceleration(theta, rough, rough, g) / (g * np.sin(theta)),
              1.0 - rough / np.tan(theta), ROUND_OFF, given=given)
        close("acceleration barely before the edge [m/s²]",
              lesson.incline_acceleration((1.0 - past) * edge, rough, 0.5 * rough, g), 0.0, 0.0, given=given)
    for mu_s in (0.0, mu):
        steep = draw(1.1, 1.4) * np.arctan(mu_s) + 0.1
        close("acceleration of a block that slides without friction, μ_k = 0 [m/s²]",
              lesson.incline_acceleration(steep, mu_s, 0.0, g), g * np.sin(steep), ROUND_OFF,
              given=f"θ = {steep}, μ_s = {mu_s}")
    close("acceleration where μ_s = ∞ [m/s²]", lesson.incline_acceleration(1.5, np.inf, mu, g), 0.0, 0.0)
    raises("a negative μ_s", BadInput, lesson.incline_acceleration, 0.3, -mu, 0.0, g)
    raises("a negative μ_k of a block that slides", BadInput, lesson.incline_acceleration, 0.3, 0.0, -mu, g)


# ---------------------------------------------------------------------------------------------- Coulomb's cone

def energies(v, m, impulses):
    """½m|v + J/m|² [J] for rows J."""
    return 0.5 * m * np.sum((v + impulses / m) ** 2, axis=1)


@exercise("3.5", points=1, hint="slide: magnitude μ j_n, against v_t; stop: −m v_t, where that is smaller")
def test_friction_leaves_the_least_energy_that_the_cone_allows(lesson, draw):
    for share in (*draw.within(), *draw.beyond(4.0)):                    # of the impulse that would stop the body
        axes = frame(draw, 3)
        m, mu, speed = draw(0.5, 5.0), draw(0.2, 1.5), draw(0.5, 5.0)
        v = along_surface(draw, axes, speed)
        j_n = share * m * speed / mu
        J = lesson.friction_impulse(v, m, j_n, mu)
        given = f"v_t = {v} m/s, m = {m} kg, j_n = {j_n} N s, μ = {mu}"
        close("normal component of the impulse [N s]", np.asarray(J) @ axes[0], 0.0, ROUND_OFF, given=given)
        between("magnitude of the impulse [N s]: inside the cone", np.linalg.norm(J), 0.0, mu * j_n + ROUND_OFF,
                given=given)
        angle, radius = np.meshgrid(np.linspace(0.0, 2.0 * np.pi, 181), np.linspace(0.0, 1.0, 21))
        along_t_1 = mu * j_n * (radius * np.cos(angle)).ravel()
        along_t_2 = mu * j_n * (radius * np.sin(angle)).ravel()
        allowed = along_t_1[:, None] * axes[1] + along_t_2[:, None] * axes[2]
        left = energies(v, m, np.asarray(J, dtype=float)[None])[0]
        between("remaining kinetic energy [J]: the least that any impulse in the cone leaves", left,
                0.0, energies(v, m, allowed).min() + ROUND_OFF, given=given)
        close("remaining speed [m/s]", np.linalg.norm(v + np.asarray(J) / m), max(0.0, 1.0 - share) * speed, ROUND_OFF,
              given=given)


@exercise("3.5", points=0.5,
          hint="v_t = 0 has no direction: return zeros; μ = 0 gives no friction, μ = ∞ "
               "stops every motion; use −m v_t itself, so that exactly zero is left")
def test_friction_is_exact_in_the_limits_of_rest_and_of_zero_and_infinite_mu(lesson, draw):
    for d in (2, 3):
        # For one vector in seven, unit vector times length differs from the vector in the last digit.
        for v in (*draw(-1.0, 1.0, (40, d)), *draw.sparse(-1.0, 1.0, (10, d))):
            close("remaining velocity of a body that stops [m/s]: exactly zero",
                  v + lesson.friction_impulse(v, 1.0, 10.0, 1.0), 0.0 * v, 0.0, given=f"v_t = {v}, m = 1 kg")
    v, m, j_n = draw(1.0, 3.0, 2), draw(0.5, 5.0), draw(0.1, 2.0)
    still = np.zeros(2)
    for load, mu in itertools.product((0.0, j_n), (0.0, draw(0.2, 1.0), np.inf)):
        close("impulse at rest [N s]: none", lesson.friction_impulse(still, m, load, mu), still, 0.0,
              given=f"j_n = {load} N s, μ = {mu}")
    close("impulse where μ = 0 [N s]", lesson.friction_impulse(v, m, j_n, 0.0), still, 0.0, given=f"v_t = {v}")
    close("impulse where μ = ∞ [N s]: stops the body", lesson.friction_impulse(v, m, j_n, np.inf), -m * v, ROUND_OFF,
          given=f"v_t = {v}, m = {m}")
    for mu in (np.inf, draw(0.2, 1.0)):
        close("impulse where j_n = 0 [N s]", lesson.friction_impulse(v, m, 0.0, mu), still, 0.0,
              given=f"v_t = {v}, μ = {mu}")
    for along in (*(along for _, along in plain_pairs()), np.ones(1), -np.ones(1)):
        v = draw(1.0, 3.0) * along
        close("impulse on a body that slides along an axis or a diagonal [N s]",
              lesson.friction_impulse(v, m, 0.5 * m, 0.8), -0.4 * m * along, ROUND_OFF, given=f"v_t = {v}, m = {m}")
    raises("a negative μ", BadInput, lesson.friction_impulse, v, m, j_n, -1.0)
    check_impulses_of_any_size(lesson, draw)


def check_impulses_of_any_size(lesson, draw):
    """Friction stops or brakes a creeping body under a tiny load as it does a fast one under a huge load."""
    shares = *draw.within(), *draw.beyond(4.0), 1.0 - BARELY, 1.0 + BARELY           # of the load that would stop it
    for d, size, share in itertools.product((2, 3), SIZES, shares):
        speed, m, mu = draw(0.5, 5.0), draw(0.5, 5.0), draw(0.2, 1.5)
        v, j_n = along_surface(draw, frame(draw, d), speed), share * m * speed / mu
        close("impulse over the size [N s]", np.asarray(lesson.friction_impulse(size * v, m, size * j_n, mu)) / size,
              -min(1.0, share) * m * v, ROUND_OFF, given=f"v_t = {size * v}, m = {m}, j_n = {size * j_n}, μ = {mu}")


@exercise("3.6", points=1, hint="treat each tangent separately: −m v_t · t, limited to ±μ j_n")
def test_a_pyramid_leaves_the_least_energy_that_its_square_allows(lesson, draw):
    shares = ((draw(0.1, 0.9), -draw(0.1, 0.9)), (draw(1.1, 4.0), draw(0.1, 0.9)), (-draw(1.1, 4.0), -draw(0.1, 0.9)),
              (draw(0.1, 0.9), -draw(1.1, 4.0)), (0.99, -1.01), (0.0, 0.0), (draw(1.1, 4.0), 0.0),
              (0.0, draw(0.1, 0.9)), (1.0 - BARELY, -1.0 - BARELY), (-draw(1.05, 1.25), draw(0.1, 0.5)),
              (draw(0.1, 0.5), draw(1.05, 1.25)), (-draw(1.1, 4.0), draw(1.1, 4.0)))
    for turned, (first, second) in ((False, shares[1]), (False, shares[6]), *((True, share) for share in shares)):
        n, t_1, t_2 = frame(draw, 3, turned)
        m, limit, mu = draw(0.5, 5.0), draw(0.5, 4.0), draw(0.2, 1.5)
        v = limit / m * (first * t_1 + second * t_2)                     # first, second: stopping impulse over limit
        J = lesson.pyramid_impulse(v, m, limit / mu, mu, t_1, t_2)
        given = f"m v_t = {m * v} N s, μ j_n = {limit} N s, t_1 = {t_1}, t_2 = {t_2}"
        ticks = np.linspace(-1.0, 1.0, 41)
        grid = limit * np.stack(np.meshgrid(ticks, ticks), axis=-1).reshape(-1, 2)
        left = energies(v, m, np.asarray(J, dtype=float)[None])[0]
        between("remaining kinetic energy [J]", left,
                0.0, energies(v, m, grid @ np.stack([t_1, t_2])).min() + ROUND_OFF, given=given)
        expected = [-np.sign(y) * min(abs(y), 1.0) * limit for y in (first, second)]
        close("components of the impulse along t_1, t_2 and n [N s]", np.stack([t_1, t_2, n]) @ J, [*expected, 0.0],
              ROUND_OFF, given=given)
    for normal, first in plain_pairs():
        if len(normal) == 3:
            second = np.cross(normal, first)
            for slip, size in itertools.product((first, second, np.sqrt(0.5) * (first + second)), SIZES):
                got = lesson.pyramid_impulse(size * slip, m, 10.0 * size, 1.0, first, second)
                close("impulse on a body that slides along an axis or a diagonal, and stops, over the size [N s]",
                      np.asarray(got) / size, -m * slip, ROUND_OFF,
                      given=f"v_t = {size * slip} m/s, m = {m} kg, t_1 = {first}, t_2 = {second}")
    for load, friction in ((0.0, np.inf), (0.0, mu), (limit, 0.0)):
        close("impulse where μ or j_n is 0 [N s]", lesson.pyramid_impulse(v, m, load, friction, t_1, t_2), np.zeros(3),
              0.0, given=f"v_t = {v}, j_n = {load}, μ = {friction}")
    raises("a negative μ", BadInput, lesson.pyramid_impulse, v, m, limit, -mu, t_1, t_2)
    close("magnitude over μ j_n where the body slides at 45°, to the pyramid's corner", np.linalg.norm(J) / limit,
          np.sqrt(2.0), ROUND_OFF, given=given)


# ---------------------------------------------------------------------------------------------- a block in time

def block(lesson, n, mu_s, mu_k, gravity, drive=None, omega=0.0):
    """A Block that the lesson has not checked."""
    drive = np.zeros(len(n)) if drive is None else drive
    return lesson.Block(np.array(n, dtype=float), mu_s, mu_k,
                        np.array(gravity, dtype=float), np.array(drive, dtype=float), omega)


def slope(draw, lesson, mu_s_over, mu_k_over, d=3, angles=(0.3, 1.0)):
    """(Block on a drawn slope, unit vector down it, tan θ, g cos θ), with the given ratios of both μ to tan θ."""
    axes, theta = frame(draw, d), draw(*angles)
    down = along_surface(draw, axes, 1.0)
    gravity = G * (np.sin(theta) * down - np.cos(theta) * axes[0])
    p = block(lesson, axes[0], mu_s_over * np.tan(theta), mu_k_over * np.tan(theta), gravity)
    return p, down, np.tan(theta), G * np.cos(theta)


def anchor(p):
    """The place (d,) [m] of a Block where tethered_acceleration has no spring force: above the origin and beside it."""
    return p.n + p.drive


def tethered_acceleration(t, x, v, p):
    """The load of a Block at its anchor; from any other place a strong spring pulls it back there.

    At the origin the spring lifts the block and pulls it along the surface, by far more than the drive does.
    It is compiled, too, and so calls no other function of this file.
    """
    return p.gravity + np.cos(p.omega * t) * p.drive - 1000.0 * (x - (p.n + p.drive))


def resisted_acceleration(t, x, v, p):
    """The load of a Block that a spring pulls to the origin and a fluid slows: each of t, x and v changes it."""
    return p.gravity + np.cos(p.omega * t) * p.drive - 40.0 * x - 0.2 * v


def resisted_slide(p, to, t, x, speed):
    """Return (way, speed) along `to` after τ, as functions of τ, of a slide under resisted_acceleration.

    It is a midpoint step along a straight line, written with numbers in place of vectors.  The height of x over the
    origin is part of the load.
    """
    brake = p.mu_k * (40.0 * (x @ p.n) - p.gravity @ p.n)

    def a(t, s, u):
        return np.cos(p.omega * t) * (p.drive @ to) - 40.0 * s - 0.2 * u - brake

    def halfway(tau):
        return speed + 0.5 * tau * a(t, x @ to, speed)

    def end(tau):
        return speed + tau * a(t + 0.5 * tau, x @ to + 0.5 * tau * speed, halfway(tau))
    return lambda tau: tau * halfway(tau), end


def run(lesson, step, p, x, v, dt, steps, t=0.0):
    for n in range(steps):
        x, v = step(lesson.driven_acceleration, t + n * dt, x, v, dt, p)
    return x, v


@exercise("3.7", points=0.25,
          hint="move the position with the new velocity; when the block stops, v + friction_impulse(…) is exactly zero")
def test_a_sliding_block_stops_at_the_right_distance_and_stays(lesson, draw):
    """Σ dt v is at most ½ v₀ dt below the true distance.

    It is v₀²/2μg − ½ v₀ dt + ½ f(1 − f) μ g dt², where f is the fraction of the last step.
    """
    for d, mu in zip((2, 3), smooth_or_rough(draw), strict=True):
        axes, speed, dt = frame(draw, d), draw(1.0, 4.0), draw(0.01, 0.03)
        p, v0 = block(lesson, axes[0], mu, mu, -G * axes[0]), along_surface(draw, axes, speed)
        x, v = run(lesson, lesson.sliding_step, p, np.zeros(d), v0, dt, int(speed / (mu * G * dt)) + 2)
        given = f"v = {v0} m/s, μ = {mu}, dt = {dt} s"
        exact = speed**2 / (2.0 * mu * G)
        close("final velocity [m/s]: exactly zero", v, np.zeros(d), 0.0, given=given)
        between("distance over the exact distance [-]", (x @ v0) / speed / exact,
                1.0 - 0.5 * speed * dt / exact - ROUND_OFF, 1.0, given=given)
        close("distance from the line of motion [m]", x - (x @ v0) * v0 / speed**2, np.zeros(d), ROUND_OFF, given=given)
        again = run(lesson, lesson.sliding_step, p, x, v, dt, 3)
        close("position three steps later [m]", again[0], x, 0.0, given=given)


@exercise("3.7", points=0.25, hint="use μ_s at rest and μ_k in motion, both with the normal force of this slope")
def test_a_block_on_a_slope_holds_slides_and_keeps_sliding(lesson, draw):
    dt, steps = draw(0.01, 0.05), 20
    held, down_held, _, _ = slope(draw, lesson, 1.0 + BARELY, draw(0.1, 0.5), angles=(0.9, 1.0))       # tan θ > 1
    x, v = run(lesson, lesson.sliding_step, held, np.zeros(3), np.zeros(3), dt, steps)
    close("position of a block that holds [m]", x, np.zeros(3), 0.0, given=f"{held}")
    close("velocity of a block that holds [m/s]", v, np.zeros(3), 0.0, given=f"{held}")
    loose, other, _, _ = slope(draw, lesson, 1.0 - BARELY, draw(0.1, 0.8))
    for p, down, v0 in ((held, down_held, draw(0.5, 2.0)), (loose, other, 0.0)):
        press = -(p.gravity @ p.n)
        # v = v₀ + a t at every step, so Σ dt v = v₀ t + ½ a t (t + dt).
        a, t = p.gravity @ down - p.mu_k * press, steps * dt
        x, v = run(lesson, lesson.sliding_step, p, np.zeros(3), v0 * down, dt, steps)
        close("position of a block that slides down [m]", x, (v0 * t + 0.5 * a * t * (t + dt)) * down, 1e-10,
              given=f"{p}, v = {v0} m/s")
        close("velocity of a block that slides down [m/s]", v, (v0 + a * t) * down, 1e-10, given=f"{p}, v = {v0} m/s")


@exercise("3.7", points=0.25,
          hint="first the pull: v* = v + dt a_t; friction then acts against v*, at most μ_k a_n dt, with a at time t")
def test_friction_shortens_the_velocity_that_the_pull_alone_would_give(lesson, draw):
    axes = frame(draw, 3)
    mu, omega, t, dt = draw(0.2, 0.6), draw(1.0, 3.0), draw(0.5, 1.5), draw(0.01, 0.05)
    drive = along_surface(draw, axes, draw(1.0, 5.0)) - draw(0.5, 2.0) * axes[0]
    p = block(lesson, axes[0], mu, mu, -G * axes[0], drive, omega)
    x = along_surface(draw, axes, 1.0)
    v = along_surface(draw, axes, draw(1.0, 3.0))
    begin, before = x, (x.copy(), v.copy())
    x_new, v_new = lesson.sliding_step(lesson.driven_acceleration, t, x, v, dt, p)
    given = f"{p}, t = {t} s, dt = {dt} s, v = {v} m/s"
    now = drive * np.cos(omega * t)
    free = v + dt * (now - (now @ axes[0]) * axes[0])
    close("velocity × frictionless velocity [m²/s²]: parallel", np.cross(v_new, free), np.zeros(3), ROUND_OFF,
          given=given)
    close("speed lost to friction in a step, over dt [m/s²]", (np.linalg.norm(free) - np.linalg.norm(v_new)) / dt,
          mu * (G - now @ axes[0]), 1e-10, given=given)
    close("displacement over dt [m/s]", (x_new - x) / dt, v_new, 1e-11, given=given)
    close("velocity under the load of its place [m/s]",
          lesson.sliding_step(tethered_acceleration, t, anchor(p), v, dt, p)[1], v_new, ROUND_OFF, given=given)
    x = along_surface(draw, axes, 0.05) + draw(0.05, 0.1) * axes[0]
    a = resisted_acceleration(t, x, v, p)
    free = v + dt * (a - (a @ axes[0]) * axes[0])
    close("velocity where the acceleration depends on t, x and v [m/s]",
          lesson.sliding_step(resisted_acceleration, t, x, v, dt, p)[1],
          free + mu * dt * (a @ axes[0]) * free / np.linalg.norm(free), ROUND_OFF, given=f"{given}, x = {x} m")
    close("input x and v after the call: return new arrays", np.array((begin, v)), np.array(before), 0.0)


@exercise("3.7", points=0.25,
          hint="a block is at rest if every component of v is zero; at |a_t| = μ_s a_n it stays at rest; "
               "a lifted block, a_n = 0, feels no friction")
def test_a_block_that_creeps_or_reverses_or_moves_along_an_axis_is_not_at_rest(lesson, draw):
    pull = lesson.driven_acceleration
    dt = draw(0.01, 0.05)
    up, along = np.array([0.0, 1.0]), np.array([1.0, 0.0])
    level, speed = block(lesson, up, 0.8, 0.3, -G * up), draw(1.0, 3.0)
    v = lesson.sliding_step(pull, 0.0, np.zeros(2), speed * along, dt, level)[1]
    close("velocity of a block on a level floor [m/s]", v, (speed - 0.3 * G * dt) * along, ROUND_OFF,
          given=f"v = {speed * along}, {level}")
    for n, to in plain_pairs():
        floor = block(lesson, n, 0.8, 0.3, -G * n)
        v = lesson.sliding_step(pull, 0.0, 0.0 * n, speed * to, dt, floor)[1]
        close("velocity of a block that slides along an axis or a diagonal [m/s]", v, (speed - 0.3 * G * dt) * to,
              ROUND_OFF, given=f"v = {speed * to} m/s, {floor}")
    between_the_two, down, tangent, press = slope(draw, lesson, 1.5, 0.5)
    for slow in (1e-4, 1e-10, *SIZES[1:2]):
        afloat = block(lesson, up, 0.8, 0.3, 0.0 * up)
        v = lesson.sliding_step(pull, 0.0, up, slow * along, dt, afloat)[1]
        close("velocity of a block without a load, over that before [-]", np.asarray(v) / slow, along, ROUND_OFF,
              given=f"v = {slow * along} m/s, {afloat}")
        v = lesson.sliding_step(pull, 0.0, np.zeros(3), slow * down, dt, between_the_two)[1]
        close("velocity of a block that creeps down a slope [m/s]", v,
              (slow + 0.5 * tangent * press * dt) * down, ROUND_OFF, given=f"v = {slow} m/s down, {between_the_two}")
    v = lesson.sliding_step(pull, 0.0, np.zeros(3), -0.1 * tangent * press * dt * down, dt, between_the_two)[1]
    close("velocity of a block that the pull reverses [m/s]", v, 0.4 * tangent * press * dt * down, ROUND_OFF,
          given=f"{between_the_two}, dt = {dt} s")
    lifted = block(lesson, up, 0.8, 0.3, G * up + 2.0 * along)
    for speed in (0.0, draw(1.0, 3.0)):
        v = lesson.sliding_step(pull, 0.0, np.zeros(2), speed * along, dt, lifted)[1]
        close("velocity of a block that is lifted [m/s]: no friction", v, (speed + 2.0 * dt) * along, ROUND_OFF,
              given=f"v = {speed} m/s, {lifted}")
    for gravity, mu_k in ((0.0 * up, 0.3), (-G * up, 0.0)):
        for v in (0.0 * up, speed * along):
            free = block(lesson, up, 0.8, mu_k, gravity)
            got = lesson.sliding_step(pull, 0.0, up, v, dt, free)
            close("x and v of a block that no friction brakes", np.array(got), np.array((up + dt * v, v)), ROUND_OFF,
                  given=f"v = {v} m/s, {free}")
    edge = block(lesson, up, 0.5, 0.1, 5.0 * along - 10.0 * up)
    close("velocity where |a_t| is μ_s a_n [m/s]: the block holds",
          lesson.sliding_step(pull, 0.0, np.zeros(2), np.zeros(2), dt, edge)[1], np.zeros(2), 0.0, given=f"{edge}")


def on_the_line(draw, lesson, mu, amplitude, omega, turned=True):
    """(Block on a floor, unit vector): along it a force oscillates with `amplitude` times the friction limit.

    turned: in drawn coordinates; False: the floor lies along the x axis
    """
    axes = frame(draw, 2) if turned else np.array([[0.0, 1.0], [1.0, 0.0]])
    to = along_surface(draw, axes, 1.0)
    return block(lesson, axes[0], mu, mu, -G * axes[0], amplitude * mu * G * to, omega), to


@exercise("3.8", points=1,
          hint="a moving block slides along v/|v|; a block at rest slides "
               "along the pull, if the pull exceeds μ_s a_n")
def test_a_block_slides_on_or_breaks_away_along_the_pull_or_stays(lesson, draw):
    steep, down, _, _ = slope(draw, lesson, 1.0 - BARELY, 0.3)
    still, across = np.zeros(3), np.cross(steep.n, down)
    pull = lesson.driven_acceleration
    close("direction from rest on a steep slope [-]", lesson.slip_direction(pull, 0.0, still, still, steep),
          down, ROUND_OFF, given=f"{steep}")
    v = draw(0.5, 3.0) * across
    close("direction of a block that crosses it [-]", lesson.slip_direction(pull, 0.0, still, v, steep),
          across, ROUND_OFF, given=f"{steep}, v = {v}")
    gentle = steep._replace(mu_s=(1.0 + BARELY) * np.tan(np.arcsin(steep.gravity @ down / G)))
    close("direction from rest where it holds [-]: none", lesson.slip_direction(pull, 0.0, still, still, gentle),
          still, 0.0, given=f"{gentle}")
    lifted = gentle._replace(drive=draw(0.1, 0.3) * G * gentle.n)
    close("direction from rest where a drive lifts [-]", lesson.slip_direction(pull, 0.0, still, still, lifted),
          down, ROUND_OFF, given=f"{lifted}")
    close("direction of a block on its way up [-]", lesson.slip_direction(pull, 0.0, still, -v, gentle),
          -across, ROUND_OFF, given=f"{gentle}, v = {-v}")
    check_slips_under_changing_forces(lesson, draw)
    up, along = np.array([0.0, 1.0]), np.array([1.0, 0.0])
    lifted = 5.0 * along + 10.0 * up
    for name, load, mu, expected in (("without pull or friction: none", -10.0 * up, 0.0, 0.0 * up),
                                     ("without any load: none", 0.0 * up, 0.5, 0.0 * up),
                                     ("without friction: along the pull", 5.0 * along - 10.0 * up, 0.0, along),
                                     ("where |a_t| is μ_s a_n: none", 5.0 * along - 10.0 * up, 0.5, 0.0 * up),
                                     ("of a lifted block: along the pull", lifted, 0.9, along),
                                     ("of a lifted block with μ = ∞: along the pull", lifted, np.inf, along)):
        for a in (size * load for size in SIZES):
            got = lesson.slip_direction(pull, 0.0, np.zeros(2), np.zeros(2), block(lesson, up, mu, mu, a))
            close(f"direction from rest {name} [-]", got, expected, 0.0, given=f"a = {a}, n = {up}, μ = {mu}")
        got = lesson.slip_direction(pull, 0.0, 0.0 * up, -2.0 * along, block(lesson, up, mu, mu, load))
        close("direction of a block that moves along an axis [-]", got, -along, 0.0, given=f"a = {load}, μ = {mu}")
    for slow in (1e-4, 1e-10, *SIZES[1:2]):
        got = lesson.slip_direction(pull, 0.0, still, -slow * down, gentle)
        close("direction of a block that creeps [-]", got, -down, ROUND_OFF, given=f"{gentle}, v = {-slow * down}")
    for n, to in plain_pairs():
        tilted = block(lesson, n, 0.5, 0.3, -G * n, 0.6 * G * to)
        for v, expected in ((0.0 * n, to), (-2.0 * to, -to)):
            close("direction of a block that is pulled, or moves, along an axis or a diagonal [-]",
                  lesson.slip_direction(pull, 0.0, 0.0 * n, v, tilted), expected, ROUND_OFF, given=f"{tilted}, v = {v}")


def check_slips_under_changing_forces(lesson, draw):
    """Check slip directions from rest, under forces that depend on t and x."""
    omega = draw(1.0, 3.0)
    p, to = on_the_line(draw, lesson, draw(0.3, 0.9), draw(1.1, 2.0), omega)
    for turn, expected in ((0.0, to), (0.5 * np.pi, 0.0 * to), (np.pi, -to)):
        got = lesson.slip_direction(tethered_acceleration, turn / omega, anchor(p), np.zeros(2), p)
        close("slip direction under an oscillating force, early, in the middle, late in its half-period [-]", got,
              expected, ROUND_OFF, given=f"{p}, t = {turn / omega} s")
    # A spring to the origin: beside it the block is pulled back, and above it pressed down, by more than by the drive.
    for place, turn, expected in ((-draw(1.0, 2.0) * to, 0.5 * np.pi, to), (draw(1.0, 2.0) * p.n, 0.0, 0.0 * to)):
        got = lesson.slip_direction(resisted_acceleration, turn / omega, place, np.zeros(2), p)
        close("slip direction where the acceleration depends on t, x and v [-]", got, expected, ROUND_OFF,
              given=f"{p}, t = {turn / omega} s, x = {place} m")


@exercise("3.9", points=0.25,
          hint="the speed along d becomes zero once: keep the half of the interval that contains this time, HALVINGS "
               "times")
def test_a_sliding_block_stops_after_v_over_mu_g(lesson, draw):
    p, _ = on_the_line(draw, lesson, draw(0.3, 0.9), 0.0, 0.0)
    d, speed = -np.array([p.n[1], -p.n[0]]), draw(0.5, 3.0)
    stop = speed / (p.mu_k * G)
    for dt, expected, tolerance in (*((share * stop, stop, ROUND_OFF) for share in draw.beyond(9.0)),
                                    *((share * stop, None, 0.0) for share in draw.within())):
        got = lesson.stopping_time(lesson.driven_acceleration, 0.0, np.zeros(2), speed * d, dt, d, p)
        close("time to the stop [s], or the whole step if it does not stop", got,
              dt if expected is None else expected, tolerance, given=f"v = {speed} m/s, μ = {p.mu_k}, dt = {dt} s")
    check_stops_early_in_a_long_step(lesson, draw)
    for n, along in ((p.n, d), frame(draw, 3, turned=False)[:2]):
        for brake, expected in ((0.0, stop), (speed / stop, stop), (speed / (0.3 * stop), 0.3 * stop)):
            for gravity in (0.0 * n, -G * n):
                ice = block(lesson, n, 0.5, 0.0, gravity - brake * along)
                got = lesson.stopping_time(lesson.driven_acceleration, 0.0, 0.0 * n, speed * along, stop, along, ice)
                close("time to the stop without friction [s]: by the pull, or not at all", got, expected, ROUND_OFF,
                      given=f"v = {speed} m/s, {ice}, dt = {stop} s")


def check_stops_early_in_a_long_step(lesson, draw):
    """A creeping block stops early: after many halvings; the end of the last interval is where it no longer moves."""
    pull, rest = lesson.driven_acceleration, np.zeros(2)
    for sign, slow in itertools.product((1.0, -1.0), (1.0, 1e-6, 1e-12)):
        p, d, speed = block(lesson, [0.0, 1.0], 0.9, draw(0.3, 0.9), [0.0, -G]), np.array([sign, 0.0]), draw(0.5, 2.0)
        stop = slow * speed / (p.mu_k * G)
        for dt, expected in ((draw(1.0, 2.0), stop), (2.0 * stop, stop), (0.5 * stop, 0.5 * stop)):
            v, given = slow * speed * d, f"v = {slow * speed * d} m/s, {p}, dt = {dt} s"
            tau = float(lesson.stopping_time(pull, 0.0, rest, v, dt, d, p))
            close("time to the stop, or the step, over that which theory gives [-]", tau / expected, 1.0, 1e-4, given)
            left = lesson.kinetic_friction_step(pull, 0.0, rest, v, tau, d, p)[1] @ d
            if expected == stop:
                between("speed along d after a slide over the returned time [m/s]: none but round-off", left, -slow,
                        1e-14 * slow, given)


@exercise("3.9", points=0.25,
          hint="pass acceleration, t, x and τ (as dt) to kinetic_friction_step: it takes the forces at the middle of τ")
def test_a_pushed_block_stops_where_a_slide_of_that_length_ends_at_rest(lesson, draw):
    """Brent's method finds the root of v(τ) = v + τ (drive cos ω(t + ½τ) − μ g), the velocity of a midpoint slide."""
    omega, t = draw(1.0, 2.0), draw(0.1, 0.3)
    p, to = on_the_line(draw, lesson, draw(0.3, 0.6), draw(0.5, 0.9), omega)
    speed, amplitude = draw(0.1, 0.4), p.drive @ to

    def along(tau):
        return speed + tau * (amplitude * np.cos(omega * (t + 0.5 * tau)) - p.mu_k * G)

    stop = brentq(along, 0.0, 4.0, xtol=1e-14)
    got = lesson.stopping_time(lesson.driven_acceleration, t, np.zeros(2), speed * to, 1.5 * stop, to, p)
    # At the root v falls with more than 0.1 μ g > 0.3 m/s² and has an error of 1e-14.
    close("time to the stop under a drive [s]", got, stop, 1e-11, given=f"{p}, v = {speed} m/s, t = {t} s")
    x = draw(0.05, 0.2) * to + draw(0.05, 0.2) * p.n
    _, end = resisted_slide(p, to, t, x, speed)
    stop = brentq(end, 0.0, 0.5, xtol=1e-14)
    got = lesson.stopping_time(resisted_acceleration, t, x, speed * to, 1.5 * stop, to, p)
    close("time to the stop where the acceleration depends on t, x and v [s]", got, stop, 1e-11,
          given=f"{p}, x = {x} m, v = {speed} m/s, t = {t} s")
    part = draw(0.2, 0.9) * stop
    got = lesson.stopping_time(resisted_acceleration, t, x, speed * to, part, to, p)
    close("time of a step that ends before that stop [s]", got, part, 0.0, given=f"{p}, x = {x} m, dt = {part} s")
    from_rest = p._replace(drive=draw(1.25, 2.0) * p.mu_s * G * to)      # it slips at t: cos ωt > cos 0.6 = 0.825
    amplitude, speed = from_rest.drive @ to, 0.0
    stop = brentq(along, 1e-3, 2.0 * (np.pi / omega - t), xtol=1e-14)
    got = lesson.stopping_time(lesson.driven_acceleration, t, np.zeros(2), np.zeros(2), 1.5 * stop, to, from_rest)
    close("time to the stop of a slide that starts at rest [s]", got, stop, 1e-11, given=f"{from_rest}, t = {t} s")


@exercise("3.10", points=1,
          hint="call slip_direction with v = 0 at t + τ, not at t; the block slips if any component is not 0")
def test_a_block_breaks_away_when_the_force_reaches_its_limit(lesson, draw):
    """The block holds from |cos ωt| = 1/amplitude until the reversed force reaches the same size."""
    omega, amplitude = draw(1.0, 3.0), draw(1.1, 2.0)
    holds, slips = np.arccos(1.0 / amplitude) / omega, (np.pi - np.arccos(1.0 / amplitude)) / omega
    t = holds + draw(0.1, 0.5) * (slips - holds)
    rest = np.zeros(2)
    late = slips - t + draw(0.2, 0.8) * (np.pi / omega - slips)
    level, p = (on_the_line(draw, lesson, draw(0.3, 0.9), amplitude, omega, turned)[0] for turned in (False, True))
    for floor, dt, expected, tolerance in ((level, late, slips - t, 1e-13), (p, late, slips - t, 1e-13),
                                           (p, 1.01 * (slips - t), slips - t, 1e-13),
                                           *((p, share * (slips - t), None, 0.0) for share in draw.within())):
        got = lesson.breakaway_time(tethered_acceleration, t, anchor(floor), rest, dt, floor)
        close("time to the slip [s], or the whole step if it holds", got,
              dt if expected is None else expected, tolerance, given=f"{floor}, t = {t} s, dt = {dt} s")
    for still in (level._replace(drive=rest), p._replace(drive=rest, gravity=rest)):
        got = lesson.breakaway_time(lesson.driven_acceleration, 0.0, rest, rest, late, still)
        close("time that a block holds without a pull [s]: the whole step", got, late, 0.0, given=f"{still}")
    for n, to in plain_pairs():
        floor = block(lesson, n, p.mu_s, p.mu_k, -G * n, amplitude * p.mu_s * G * to, omega)
        got = lesson.breakaway_time(tethered_acceleration, t, anchor(floor), 0.0 * n, late, floor)
        close("time to a slip along an axis or a diagonal [s]", got, slips - t, 1e-13, given=f"{floor}, t = {t} s")
    # A spring to the origin, 40/s² times the place, pulls along the surface and presses: both in shares of μ_s g and g.
    back, presses = draw(0.3, 0.5), draw(0.05, 0.2)
    x = (back * p.drive / amplitude + presses * G * p.n) / 40.0
    late_slip = np.arccos((back - 1.0 - presses) / amplitude) / omega
    dt = late_slip - t + draw(0.2, 0.8) * (np.pi / omega - late_slip)
    got = lesson.breakaway_time(resisted_acceleration, t, x, rest, dt, p)
    close("time to the slip where the acceleration depends on t, x and v [s]", got, late_slip - t, 1e-13,
          given=f"{p}, t = {t} s, x = {x} m, dt = {dt} s")
    # At t = 0 a slope's pull and the drive cancel: the block slips where s (1 − cos ωt) = μ_s g.
    s = draw(0.8, 1.5) * level.drive
    first = np.arccos(1.0 - level.mu_s * G / np.linalg.norm(s)) / omega
    got = lesson.breakaway_time(lesson.driven_acceleration, 0.0, rest, rest, 1.2 * first,
                                level._replace(gravity=level.gravity + s, drive=-s))
    close("time from t = 0 to the slip [s]", got, first, 1e-13, given=f"pull {s}, {level}")
    check_slip_under_a_varying_load(lesson, draw, p, omega, amplitude)
    check_slips_at_the_end_of_the_wait(lesson, draw, level, holds, slips, 0.5 * (slips + np.pi / omega))


def check_slips_at_the_end_of_the_wait(lesson, draw, p, holds, slips, end):
    """After the returned time the block slips: else the next search would find it at rest, and wait again."""
    for share in draw(0.1, 0.9, 8):
        t = holds + share * (slips - holds)
        got = float(lesson.breakaway_time(tethered_acceleration, t, anchor(p), np.zeros(2), end - t, p))
        truth("whether the block slips after the returned time: the end of the last interval",
              np.any(lesson.slip_direction(tethered_acceleration, t + got, anchor(p), np.zeros(2), p)), True,
              given=f"{p}, t = {t} s, dt = {end - t} s")


def check_slip_under_a_varying_load(lesson, draw, p, omega, amplitude):
    """Compare the time to the slip with theory where the drive lifts the block, too."""
    # a_n = g − lift cos ωt: the block slips where A |cos| = μ_s (g + lift |cos|), with A = amplitude μ_s g.
    lift = draw(0.2, 0.8) * (amplitude - 1.0) * G
    both = p._replace(drive=p.drive + lift * p.n, mu_k=0.5 * p.mu_s)
    rest, t = np.zeros(2), 0.5 * np.pi / omega
    slips = np.arccos(-1.0 / (amplitude - lift / G)) / omega
    got = lesson.breakaway_time(lesson.driven_acceleration, t, rest, rest, 0.5 * (slips + np.pi / omega) - t, both)
    close("time to the slip under a varying load, with μ_k half of μ_s [s]", got, slips - t, 1e-13,
          given=f"{both}, t = {t} s")


@exercise("3.11", points=0.25,
          hint="slide with kinetic_friction_step(acceleration, t, x, v, τ, d, p), and return τ, not t + τ")
def test_a_slide_obeys_the_acceleration_of_its_time_and_place(lesson, draw):
    """Under a force that depends on t, x and v: to a stop, in a step that ends before it, and from rest.

    Blocks that slide along an axis or a diagonal are among them.
    """
    omega, t = draw(1.0, 2.0), draw(1.0, 2.0)
    frames = [frame(draw, d)[:2] for d in (2, 3)]
    for n, to in (*frames, *plain_pairs()):
        mu, speed = draw(0.3, 0.6), draw(0.1, 0.4)
        p = block(lesson, n, mu, 0.8 * mu, -G * n, draw(0.1, 0.5) * mu * G * to, omega)
        x = draw(0.02, 0.2) * to + draw(0.05, 0.2) * n
        # From rest the spring, 40 s² times the place, must exceed μ (g + 40 height) and the drive: 27 m/s² at most.
        far = x - draw(1.0, 1.5) * to
        stop = brentq(resisted_slide(p, to, t, x, speed)[1], 0.0, 0.5, xtol=1e-14)
        for place, u, dt, tau in ((x, speed, draw(1.1, 2.0) * stop, stop), (x, speed, 0.5 * stop, 0.5 * stop),
                                  (far, 0.0, 0.02, 0.02)):
            way, end = resisted_slide(p, to, t, place, u)
            got, x_new, v_new = lesson.advance_to_event(resisted_acceleration, t, place, u * to, dt, p)
            given = f"{p}, t = {t} s, x = {place} m, v = {u * to} m/s, dt = {dt} s"
            close("time to the stop, or of the step [s]", got, tau, 1e-11, given=given)
            close("displacement meanwhile [m]", x_new - place, way(tau) * to, 1e-11, given=given)
            close("velocity then [m/s]", v_new, end(tau) * to, 1e-11, given=given)
    check_slip_from_rest_to_rest(lesson, draw)


def check_slip_from_rest_to_rest(lesson, draw):
    """In one long step a force makes a block slip at once, and lets it stop: v(τ) = τ (drive cos ω(t + ½τ) − μ g)."""
    omega, t = draw(1.0, 2.0), draw(0.1, 0.3)
    p, to = on_the_line(draw, lesson, draw(0.3, 0.6), draw(1.25, 2.0), omega)        # cos ωt > cos 0.6 = 0.825
    brakes = lambda tau: p.drive @ to * np.cos(omega * (t + 0.5 * tau)) - p.mu_k * G
    stop = brentq(brakes, 0.0, 2.0 * (np.pi / omega - t), xtol=1e-14)
    tau, _, v = lesson.advance_to_event(lesson.driven_acceleration, t, np.zeros(2), np.zeros(2), 1.5 * stop, p)
    given = f"{p}, t = {t} s, dt = {1.5 * stop} s, from rest"
    close("time to the stop of a slide that starts at rest [s]", tau, stop, 1e-11, given=given)
    close("velocity after that stop [m/s]: exactly zero", v, np.zeros(2), 0.0, given=given)


@exercise("3.11", points=0.25,
          hint="after a stop set v to exact zeros: a remaining round-off would count as motion")
def test_a_slide_goes_to_its_stop_and_no_further(lesson, draw):
    p, down, tangent, press = slope(draw, lesson, 1.5, 1.2)
    up, begin = -down, draw(-1.0, 1.0, 3)
    brake = (1.2 + 1.0) * tangent * press
    for long in (draw(1.5, 3.0), 1.1, 1.01, 1.001, 1.0001, 1.0 + BARELY, 1.0 + 1e-11):
        speed = draw(0.5, 3.0)
        stop = speed / brake
        tau, x, v = lesson.advance_to_event(lesson.driven_acceleration, 0.0, begin, speed * up, long * stop, p)
        close("time to the stop, uphill [s]", tau, stop, ROUND_OFF, given=f"{p}, v = {speed} m/s")
        close("displacement until the stop [m]", x - begin, 0.5 * speed * stop * up, ROUND_OFF,
              given=f"{p}, v = {speed} m/s")
        close("velocity after the stop [m/s]: exactly zero", v, np.zeros(3), 0.0)
    for part in (draw(0.2, 0.8), 1.0 - BARELY, 1.0 - 1e-11):
        tau, x, v = lesson.advance_to_event(lesson.driven_acceleration, 0.0, begin, speed * up, part * stop, p)
        given = f"{p}, v = {speed} m/s, dt = {part * stop} s"
        close("time of a step that ends before the stop [s]", tau, part * stop, 0.0)
        close("velocity after that step [m/s]", v, (1.0 - part) * speed * up, ROUND_OFF, given)
        close("displacement in that step [m]", x - begin, (part - 0.5 * part * part) * speed * stop * up, ROUND_OFF,
              given)
    steep, down, tangent, press = slope(draw, lesson, 0.9, 0.5)
    dt, a = draw(0.1, 0.5), 0.5 * tangent * press                        # the block slips at once and accelerates
    tau, x, v = lesson.advance_to_event(lesson.driven_acceleration, 0.0, begin, np.zeros(3), dt, steep)
    close("time of a step that starts at rest on a steep slope [s]", tau, dt, 0.0, given=f"{steep}")
    close("velocity after that step [m/s]", v, a * dt * down, ROUND_OFF, given=f"{steep}, dt = {dt} s")
    close("displacement in that step [m]", x - begin, 0.5 * a * dt * dt * down, ROUND_OFF,
          given=f"{steep}, dt = {dt} s")
    level, along = on_the_line(draw, lesson, draw(0.3, 0.9), 0.0, 0.0, turned=False)
    stop = speed / (level.mu_k * G)
    tau, x, v = lesson.advance_to_event(lesson.driven_acceleration, 0.0, begin[:2], speed * along, 2.0 * stop, level)
    close("time to the stop on a level floor [s]", tau, stop, ROUND_OFF, given=f"{level}, v = {speed} m/s")
    for ice in (level._replace(mu_k=0.0), level._replace(gravity=np.zeros(2))):
        for v0 in (np.zeros(2), speed * along):
            tau, x, v = lesson.advance_to_event(lesson.driven_acceleration, 0.0, begin[:2], v0, dt, ice)
            close("time of a step in which no friction brakes [s]", tau, dt, 0.0, given=f"{ice}, v = {v0} m/s")
            close("x and v after that step", np.array((x, v)), np.array((begin[:2] + dt * v0, v0)), ROUND_OFF,
                  given=f"{ice}, v = {v0} m/s")


@exercise("3.11", points=0.5,
          hint="where slip_direction returns zeros the block does not move: find only the time to the breakaway")
def test_a_block_at_rest_waits_for_its_breakaway(lesson, draw):
    omega, amplitude = draw(1.0, 3.0), draw(1.1, 2.0)
    p, _ = on_the_line(draw, lesson, draw(0.3, 0.9), amplitude, omega)
    slips = (np.pi - np.arccos(1.0 / amplitude)) / omega
    begin = anchor(p)
    t = np.arccos(1.0 / amplitude) / omega * draw(1.05, 1.2)
    t = min(t, 0.5 * np.pi / omega)
    tau, x, v = lesson.advance_to_event(tethered_acceleration, t, begin, np.zeros(2), slips - t + 0.01, p)
    close("time to the breakaway [s]", tau, slips - t, ROUND_OFF, given=f"{p}, t = {t} s")
    close("position and velocity meanwhile", np.array((x, v)), np.array((begin, np.zeros(2))), 0.0,
          given=f"{p}, t = {t} s")
    tau, x, v = lesson.advance_to_event(tethered_acceleration, t, begin, np.zeros(2), 0.5 * (slips - t), p)
    close("time of a step that ends before the breakaway [s]", tau, 0.5 * (slips - t), 0.0, given=f"{p}, t = {t} s")


# ---------------------------------------------------------------------------------------------- particle and surface

def bowl(lesson, draw, axis, d=3, m=1.0, mu=0.0, e=0.0):
    gravity = np.zeros(d)
    gravity[-1] = -G
    return lesson.ParticleInBowl(m, mu, e, gravity, draw(-2.0, 2.0, d), axis, draw(0.5, 3.0))


@exercise("3.12", points=0.5, hint="radius − |r|: positive inside; n points inward, −r/|r|, and is the gradient of φ")
def test_the_gap_of_a_bowl_and_a_trough_is_the_distance_to_the_wall(lesson, draw):
    for (d, turned), trough in (*((way, 0.0) for way in WAYS), ((3, True), 1.0), ((3, False), 1.0)):
        axes = frame(draw, d, turned)
        axis = trough * axes[0]
        p = bowl(lesson, draw, axis, d)
        p = p._replace(centre=p.centre * turned)
        for share in (draw(0.2, 0.9), draw(1.1, 2.0), 1.0):
            out = along_surface(draw, axes, 1.0) if turned else axes[draw.whole(1, d - 1)]
            x = p.centre + share * p.radius * out + 1.7 * axis
            phi, n = lesson.particle_bowl_gap(x, p)
            given = f"{p}, x = {x} m"
            close("gap φ [m]: positive inside, negative beyond the wall", phi, (1.0 - share) * p.radius, ROUND_OFF,
                  given=given)
            close("normal n [-]: inward", n, -out, ROUND_OFF, given=given)
    for across, out in plain_pairs():
        for axis in (0.0 * across, across * (len(out) - 2)):
            p = bowl(lesson, draw, axis, len(out))
            p = p._replace(centre=0.0 * out)
            for x in (0.5 * p.radius * out, 1e-9 * out, 2.0**-100 * out):
                close("normal n at a place along a coordinate axis or a diagonal, however near the centre [-]: inward",
                      lesson.particle_bowl_gap(x, p)[1], -out, ROUND_OFF, given=f"{p}, x = {x} m")


@exercise("3.12", points=0.5, hint="at the centre r = 0: return n = 0 there instead of dividing by zero")
def test_the_normal_is_zero_at_the_centre_of_a_bowl(lesson, draw):
    for d, turned in WAYS:
        axes = frame(draw, d, turned)
        for axis in (0.0 * axes[0], axes[0] * (d - 2)):
            p = bowl(lesson, draw, axis, d)
            x = p.centre if turned else p.centre + 1.7 * axis
            phi, n = lesson.particle_bowl_gap(x, p)
            close("gap at the centre, or on the axis [m]", phi, p.radius, ROUND_OFF, given=f"{p}")
            close("normal at the centre, or on the axis [-]", n, np.zeros(d), 0.0, given=f"{p}")
    out = axes[-1]
    close("normal 1 nm from the centre [-]: the position has an error of 1e-16 m",
          lesson.particle_bowl_gap(p.centre + 1e-9 * out, p)[1], -out, 1e-5, given=f"{p}")


@exercise("3.13", points=1, hint="n · v⁺ = −e n · v: j_n = −(1 + e) m v · n; both impulses contain the mass")
def test_a_particle_leaves_with_e_times_its_normal_speed_and_friction_takes_mu_times_what_that_took(lesson, draw):
    shares = (*draw.within(), *draw.beyond(3.0))                         # of the one that friction stops
    bounces = (0.0, 1.0, draw(0.0, 1.0)) * 2
    for (d, turned), (e, speed) in itertools.product(WAYS, zip(bounces, shares, strict=True)):
        axes = frame(draw, d, turned)
        m, v_n, mu = draw(0.5, 5.0), draw(0.5, 5.0), smooth_or_rough(draw)[turned]
        slip = along_surface(draw, axes, speed * mu * (1.0 + e) * v_n)
        v = slip - v_n * axes[0]
        J = lesson.particle_contact_impulse(v, axes[0], m, e, mu)
        given = f"v = {v} m/s, n = {axes[0]}, m = {m} kg, e = {e}, μ = {mu}"
        after = v + np.asarray(J) / m
        close("normal velocity after [m/s]", after @ axes[0], e * v_n, ROUND_OFF, given=given)
        close("tangential velocity after [m/s]", after - (after @ axes[0]) * axes[0],
              max(0.0, 1.0 - 1.0 / speed) * slip, ROUND_OFF, given=given)
    for n, along in plain_pairs():
        m, e, v_n, mu = draw(0.5, 5.0), draw(0.1, 0.9), draw(0.5, 5.0), draw(0.1, 0.5)
        limit = mu * (1.0 + e) * v_n
        v = draw(1.1, 3.0) * limit * along - v_n * n
        after = v + np.asarray(lesson.particle_contact_impulse(v, n, m, e, mu)) / m
        close("velocity after an impact with a slip along an axis or a diagonal [m/s]", after,
              v + (1.0 + e) * v_n * n - limit * along, ROUND_OFF, given=f"v = {v} m/s, n = {n}, m = {m} kg, e = {e}")


@exercise("3.13", points=1, hint="v · n ≥ 0 means that the particle is leaving: the impulse is then zero")
def test_a_surface_never_pulls_and_without_friction_it_only_reflects(lesson, draw):
    for d, turned in WAYS:
        axes = frame(draw, d, turned)
        m, mu, e = draw(0.5, 5.0), draw(0.1, 1.0), draw(0.0, 1.0)
        for v in (np.zeros(d), draw(0.5, 3.0) * np.eye(d)[0]):
            close("impulse on a particle at rest, or along the surface [N s]",
                  lesson.particle_contact_impulse(v, np.eye(d)[-1], m, e, mu), np.zeros(d), 0.0, given=f"v = {v} m/s")
        leaving = along_surface(draw, axes, draw(0.5, 3.0)) + draw(0.1, 2.0) * axes[0]
        close("impulse on a leaving particle [N s]", lesson.particle_contact_impulse(leaving, axes[0], m, e, mu),
              np.zeros(d), 0.0, given=f"v = {leaving} m/s, n = {axes[0]}")
        v = along_surface(draw, axes, draw(0.5, 3.0)) - draw(0.5, 3.0) * axes[0]
        for bounce in (1.0, e, 0.0):
            after = v + np.asarray(lesson.particle_contact_impulse(v, axes[0], m, bounce, 0.0)) / m
            close("velocity after an impact without friction [m/s]", after,
                  v - (1.0 + bounce) * (v @ axes[0]) * axes[0], ROUND_OFF,
                  given=f"v = {v} m/s, n = {axes[0]}, e = {bounce}")
        for speed in (draw(0.5, 3.0), 1e-6, *SIZES[1:]):
            head_on = -speed * np.eye(d)[-1]
            after = head_on + np.asarray(lesson.particle_contact_impulse(head_on, np.eye(d)[-1], m, e, mu)) / m
            close("velocity after a head-on impact, over that before [-]", after / speed, e * np.eye(d)[-1], ROUND_OFF,
                  given=f"v = {head_on} m/s, e = {e}")
        for grazing in (1e-6, BARELY):
            v = along_surface(draw, axes, 1.0) - grazing * axes[0]
            after = v + np.asarray(lesson.particle_contact_impulse(v, axes[0], m, e, 0.0)) / m
            close("normal velocity after an impact that barely grazes the surface [m/s]", after @ axes[0], e * grazing,
                  ROUND_OFF, given=f"v = {v} m/s, n = {axes[0]}, e = {e}")


def above(lesson, draw, mu, e, theta=0.0, d=3, turned=True):
    """(ParticleOnPlane, unit vector down): a particle of drawn mass above a plane inclined by θ against gravity."""
    axes = frame(draw, d, turned)
    down = along_surface(draw, axes, 1.0)
    gravity = G * (np.sin(theta) * down - np.cos(theta) * axes[0])
    return lesson.ParticleOnPlane(draw(0.5, 5.0), mu, e, gravity, draw(-2.0, 2.0, d), axes[0]), down


def swinging_acceleration(t, x, v, p):
    return np.cos(t) * p.gravity - 10.0 * (x - p.point) - 3.0 * v


def hill_gap(x, p):
    """A surface that is not in the lesson: (φ, n) of a round hill of radius 1 m around `point`; it ignores p.n."""
    r = x - p.point
    distance = np.sqrt(r @ r)
    return distance - 1.0, r / distance


def fly(lesson, step, p, x, v, dt, steps):
    for n in range(steps):
        x, v = step(lesson.falling_acceleration, lesson.particle_plane_gap, n * dt, x, v, dt, p)
    return x, v


@exercise("3.14", points=0.5,
          hint="update the velocity, then the position with the new velocity; evaluate the gap at the new position")
def test_a_particle_falls_hits_and_bounces_with_its_own_restitution(lesson, draw):
    falls(lesson, lesson.contact_step, draw, 0.0)


def falls(lesson, step, draw, grips):
    """With friction or without, and with restitutions from 0 to 1."""
    check_fall(lesson, step, draw, grips, *above(lesson, draw, draw(0.05, 0.3), draw(0.2, 0.9)))
    for (d, turned), rough, e in zip(WAYS, (0.0, 1.0, 1.0, 0.0), (0.0, 1.0, 0.0, 1.0), strict=True):
        mu = rough * draw(0.05, 0.3)
        check_fall(lesson, step, draw, grips, *above(lesson, draw, mu, e, d=d, turned=turned))


def check_fall(lesson, step, draw, grips, p, down):
    """Free flight is symplectic Euler. At the wall v_n becomes −e v_n, and the particle is put back onto the plane.

    grips: 1 if friction also removes μ times the depth from the tangential displacement, 0 if not.
    """
    dt = 0.01
    v = draw(3.0, 5.0) * down - draw(0.5, 1.0) * p.n
    height = draw(1.0, 2.0)
    begin = p.point + height * p.n
    kept = begin.copy(), v.copy()
    x, v_new = fly(lesson, step, p, begin, v, dt, 5)
    close("velocity after 5 steps of free flight [m/s]", v_new, v + 0.05 * p.gravity, ROUND_OFF,
          given=f"{p}, v = {v} m/s")
    close("position after 5 steps of free flight [m]: moved with the new velocity", x,
          begin + 0.05 * v + 0.5 * 0.05 * 0.06 * p.gravity, ROUND_OFF, given=f"{p}, v = {v} m/s")
    close("input x and v after the call: return new arrays", np.array((begin, v)), np.array(kept), 0.0)

    t = draw(0.3, 1.0)
    x, v_new = step(swinging_acceleration, lesson.particle_plane_gap, t, begin, v, dt, p)
    close("velocity where a = g cos t − 10 (x − point) − 3 v [m/s]", v_new,
          v + dt * (np.cos(t) * p.gravity - 10.0 * height * p.n - 3.0 * v), ROUND_OFF,
          given=f"{p}, v = {v} m/s, t = {t} s")
    x, v_new = fly(lesson, step, p, p.point + 5e-4 * p.n, 3.0 * down - 1e-3 * dt * p.gravity, dt * 1e-3, 1)
    close("height of a particle that passes half a millimetre above the plane [m]", (x - p.point) @ p.n, 5e-4, 1e-11,
          given=f"{p}")
    close("velocity of a particle that passes half a millimetre above [m/s]", v_new, 3.0 * down, ROUND_OFF,
          given=f"{p}")

    # With more than 0.5 m/s towards the plane, one step ends below it.
    close_by = p.point + draw(0.1, 0.5) * dt * p.n
    pressed = v - 1.0 * p.n + dt * p.gravity                             # velocity at the wall
    x, v_new = fly(lesson, step, p, close_by, v - 1.0 * p.n, dt, 1)
    arrives, slip = -(pressed @ p.n), pressed @ down
    given = f"{p}, x = {close_by} m, v = {v - p.n} m/s, dt = {dt} s"
    depth = dt * arrives - (close_by - p.point) @ p.n
    close("position after an impact [m]: on the plane", x,
          p.point + (dt * slip - grips * p.mu * depth) * down, ROUND_OFF, given=given)
    close("velocity after an impact [m/s]", v_new,
          p.e * arrives * p.n + (slip - p.mu * (1.0 + p.e) * arrives) * down, ROUND_OFF, given=given)


def check_hill(lesson, step, draw, grips):
    """A particle on a round hill of the test, above and below its top.  p.n is the normal of another surface.

    grips: as in check_fall
    """
    for (d, turned), depth in itertools.product(WAYS, (draw(0.005, 0.01), -draw(0.005, 0.01))):
        p, _ = above(lesson, draw, smooth_or_rough(draw)[turned], draw(0.2, 0.9), d=d, turned=turned)
        axes, dt = frame(draw, d), 0.01
        n, along = axes[0], along_surface(draw, axes, 1.0)
        slip, arrives = draw(8.0, 15.0), draw(1.0, 2.0)                  # so fast that friction does not stop it
        ends = p.point + (1.0 - depth) * n                               # where it would be without the hill
        v_free = slip * along - arrives * n
        x, v = ends - dt * v_free, v_free - dt * p.gravity
        x_new, v_new = step(lesson.falling_acceleration, hill_gap, 0.0, x, v, dt, p)
        given = f"{p}, x = {x} m, v = {v} m/s, dt = {dt} s"
        hits = depth > 0.0
        close("position after a step at a hill of 1 m around the point, a surface of the test [m]", x_new,
              ends + hits * depth * (n - grips * p.mu * along), ROUND_OFF, given=given)
        close("velocity after a step at that hill [m/s]", v_new,
              v_free + hits * (1.0 + p.e) * arrives * (n - p.mu * along), ROUND_OFF, given=given)


@exercise("3.14", points=0.5,
          hint="use φ and n of the surface that is passed in; put the particle back by −φ n even if its velocity "
               "already points out; then do not change its velocity")
def test_a_leaving_particle_inside_is_put_back_and_keeps_its_velocity(lesson, draw):
    check_hill(lesson, lesson.contact_step, draw, 0.0)
    check_way_out(lesson, lesson.contact_step, draw)
    check_just_touching(lesson, lesson.contact_step, draw)
    theta, dt = draw(0.2, 0.8), draw(0.005, 0.02)
    p, down = above(lesson, draw, 1.5 * np.tan(theta), 0.0, theta)
    x, v = fly(lesson, lesson.contact_step, p, p.point, np.zeros(3), dt, 10)
    close("velocity of a particle at rest on a slope [m/s]", v, np.zeros(3), ROUND_OFF,
          given=f"{p}, dt = {dt} s")
    close("artificial displacement over time and dt [m/s²]: g sin θ", (x - p.point) / (10 * dt * dt),
          G * np.sin(theta) * down, 1e-8, given=f"{p}, dt = {dt} s")


def check_just_touching(lesson, step, draw):
    """A particle that ends exactly on the plane, φ = 0, has not penetrated. Whole numbers avoid round-off here."""
    e = draw(0.2, 0.9)
    begin = np.array([float(draw.whole(-3, 3)), 1.0])
    p = lesson.ParticleOnPlane(1.0, 0.5, e, np.zeros(2), np.zeros(2), np.array([0.0, 1.0]))
    for y in (-0.5, 0.5, -(2.0**-30), 2.0**-30, -(2.0**-100)):
        still = np.array([1.0, y])
        x, v_new = fly(lesson, step, p, still, 0.0 * still, 0.5, 1)
        close("position of a particle at rest, without gravity [m]: not inside", x, [1.0, max(0.0, y)], 0.0,
              given=f"x = {still} m")
        close("velocity of a particle at rest, without gravity [m/s]", v_new, np.zeros(2), 0.0, given=f"x = {still} m")
    v = np.array([1.0, -2.0])
    x, v_new = fly(lesson, step, p, begin, v, 0.5, 1)
    close("position of a particle that just touches [m]", x, begin + 0.5 * v, 0.0,
          given=f"x = {begin} m, v = {v} m/s, dt = 0.5 s")
    close("velocity of a particle that just touches [m/s]: unchanged", v_new, v, 0.0,
          given=f"x = {begin} m, v = {v} m/s, dt = 0.5 s")


def check_way_out(lesson, step, draw):
    p, down = above(lesson, draw, draw(0.3, 0.9), draw(0.2, 0.9))
    dt = 0.01
    v = draw(1.0, 2.0) * down + draw(1.0, 2.0) * p.n
    deep = p.point - draw(0.1, 0.5) * p.n
    x, v_new = fly(lesson, step, p, deep, v, dt, 1)
    given = f"{p}, x = {deep} m, v = {v} m/s"
    close("velocity of a leaving particle inside the obstacle [m/s]", v_new, v + dt * p.gravity, ROUND_OFF,
          given=given)
    close("position of a leaving particle inside the obstacle [m]: put back along n", x,
          p.point + dt * (v @ down) * down, ROUND_OFF, given=given)


@exercise("3.15", points=1,
          hint="friction for positions: −s where |s| ≤ μ depth, otherwise μ depth against s; s is tangential")
def test_the_grip_undoes_a_displacement_inside_its_cone(lesson, draw):
    for share, depth in (*((share, draw(0.01, 0.1)) for share in (*draw.within(), *draw.beyond(5.0))), (0.0, 0.1),
                         (draw(0.1, 0.9), draw(1.0, 5.0)), (draw(1.1, 5.0), 1e-9)):
        axes, mu = frame(draw, 3), draw(0.2, 1.5)
        s = along_surface(draw, axes, share * mu * depth)
        got = lesson.friction_position_correction(s - draw(0.5, 2.0) * depth * axes[0], axes[0], depth, mu)
        expected = -s if share <= 1.0 else -s / share
        close("tangential correction [m]", got, expected, ROUND_OFF,
              given=f"s = {s} m, n = {axes[0]}, depth {depth} m, μ = {mu}")
    for moved, depth, friction in ((np.zeros(3), 0.1, mu), (axes[1], 0.0, mu), (axes[1], 0.1, 0.0)):
        close("tangential correction without displacement, depth or friction [m]: none",
              lesson.friction_position_correction(moved, axes[0], depth, friction), np.zeros(3), 0.0,
              given=f"moved by {moved} m, depth {depth} m, μ = {friction}")
    for n, along in plain_pairs():
        for size, expected in ((1.0, 0.05), (0.01, 0.01)):
            got = lesson.friction_position_correction(size * along, n, 0.1, 0.5)
            close("tangential correction of a displacement along an axis or a diagonal [m]", got, -expected * along,
                  ROUND_OFF, given=f"moved by {size * along} m, n = {n}, depth 0.1 m, μ = 0.5")
    for size, (n, along), (depth, expected) in itertools.product(SIZES, plain_pairs(), ((4.0, 1.0), (1.0, 0.5))):
        got = lesson.friction_position_correction(size * along, n, size * depth, 0.5)
        close("tangential correction over the displacement [-]", np.asarray(got) / size, -expected * along, ROUND_OFF,
              given=f"moved by {size * along} m, n = {n}, depth {size * depth} m, μ = 0.5")
    straight = lesson.friction_position_correction(np.array([0.0, -1e-3]), np.array([0.0, 1.0]), 1e-3, 0.5)
    close("tangential correction of a displacement along −n [m]: none", straight, np.zeros(2), 0.0)


@exercise("3.16", points=0.5,
          hint="where φ < 0 and v · n < 0, also correct the tangential displacement of this step, with depth −φ")
def test_a_gripping_particle_stays_put_or_slides_as_a_block_does(lesson, draw):
    theta, dt, steps = draw(0.2, 0.8), draw(0.005, 0.02), 10
    for share in draw.beyond(2.0):
        p, _ = above(lesson, draw, share * np.tan(theta), 0.0, theta)
        x, v = fly(lesson, lesson.position_friction_step, p, p.point, np.zeros(3), dt, steps)
        close("position of a particle at rest on a slope [m]", x, p.point, ROUND_OFF, given=f"{p}, dt = {dt} s")
        close("velocity of a particle at rest on a slope [m/s]", v, np.zeros(3), ROUND_OFF, given=f"{p}, dt = {dt} s")
    for share in draw.within():
        p, down = above(lesson, draw, share * np.tan(theta), 0.0, theta)
        x, v = fly(lesson, lesson.position_friction_step, p, p.point, np.zeros(3), dt, steps)
        a, t = G * (np.sin(theta) - p.mu * np.cos(theta)), steps * dt
        close("velocity of a sliding particle [m/s]", v, a * t * down, ROUND_OFF, given=f"{p}, dt = {dt} s")
        close("displacement of a sliding particle [m]: symplectic Euler's a t(t + dt)/2", x - p.point,
              0.5 * a * t * (t + dt) * down, ROUND_OFF, given=f"{p}, dt = {dt} s")


@exercise("3.16", points=0.5,
          hint="free flight, impact and leaving are as in contact_step, with φ and n of the surface that is passed in; "
               "do not correct the slip of a leaving particle")
def test_a_gripping_particle_flies_and_bounces_like_the_other(lesson, draw):
    falls(lesson, lesson.position_friction_step, draw, 1.0)
    check_hill(lesson, lesson.position_friction_step, draw, 1.0)
    check_way_out(lesson, lesson.position_friction_step, draw)
    check_just_touching(lesson, lesson.position_friction_step, draw)
    level = lesson.ParticleOnPlane(1.0, draw(0.2, 0.9), 0.0, np.zeros(2), np.zeros(2), np.array([0.0, 1.0]))
    deep = np.array([0.0, -draw(0.1, 0.5)])
    for sinks in (1e-6, 2.0**-60):
        v = np.array([draw(10.0, 20.0), -sinks])
        x, _ = fly(lesson, lesson.position_friction_step, level, deep, v, 0.1, 1)
        close("position of a particle inside that slowly goes deeper [m]: friction takes back μ times its depth", x,
              [0.1 * v[0] + level.mu * (deep[1] - 0.1 * sinks), 0.0], ROUND_OFF, f"x = {deep} m, v = {v} m/s, {level}")
    v = np.array([draw(0.5, 2.0), 0.0])                                  # v · n is exactly 0
    x, v_new = fly(lesson, lesson.position_friction_step, level, deep, v, 0.1, 1)
    given = f"x = {deep} m, v = {v} m/s, {level}"
    close("position of a particle inside that moves along the surface [m]: no tangential correction", x, 0.1 * v,
          ROUND_OFF, given=given)
    close("velocity of a particle inside that moves along the surface [m/s]", v_new, v, 0.0, given=given)


# ---------------------------------------------------------------------------------------------- why?

@exercise("3.17", points=1,
          hint="½mv² is used up by μ m g times the way: first by that on the strip, the rest behind it")
def test_a_block_slides_as_far_as_the_times_on_both_materials_allow(lesson, draw):
    shares = (0.0, *draw.within(), *draw.beyond(3.0))                    # of the speed that just crosses the strip
    for share, (near, far) in itertools.product(shares, (smooth_or_rough(draw), smooth_or_rough(draw)[::-1])):
        width, g = draw(0.5, 2.0), draw(1.0, 15.0)
        v = share * np.sqrt(2.0 * near * g * width)
        if share <= 1.0:
            expected = v * (v / (near * g)) - 0.5 * near * g * (v / (near * g)) ** 2
        else:
            # v t − ½ μ g t² = width at the first root; then half the speed that is left, for the time to rest
            crossing = (v - np.sqrt(v * v - 2.0 * near * g * width)) / (near * g)
            slower = v - near * g * crossing
            expected = width + 0.5 * slower * slower / (far * g)
        for size in SIZES:
            way = lesson.sliding_distance(size * v, size**2 * width, near, far, g)
            close("way of a block over two materials, over the size [m]", way / size**2, expected, ROUND_OFF,
                  given=f"v = {size * v:.4g} m/s, width = {size**2 * width:.4g} m, μ = {near:.4g} and {far:.4g}, "
                        f"g = {g:.4g} m/s²")


@exercise("3.18", points=1, hint="what holds a block that nothing pulls? And what is the force on it when it slides?")
def test_the_chosen_friction_balances_the_pull_up_to_its_limit_and_is_kinetic_beyond(lesson):
    def coulomb(pull, friction):
        holds = pull <= MU_S * LOAD
        return np.allclose(friction[holds], pull[holds]) and np.allclose(friction[~holds], MU_K * LOAD)
    right = choices.where("friction", "frictions_of_a_pulled_block", coulomb)
    choice("the letter of Coulomb's friction", lesson.dry_friction_is(), right)


@exercise("3.19", points=1, hint="the new velocity is v_t times a factor from 0 to 1, or each component has its own; "
               "without a load, j_n = 0, there is no friction")
def test_a_floor_of_ones_own_takes_energy_stops_the_block_and_is_new(lesson, draw):
    mu, dt = draw(0.3, 0.6), 0.02
    for m, angle in itertools.product((draw(5.0, 9.0), draw(0.1, 0.3), draw(0.5, 2.0)), np.pi / 3.0 * np.arange(6)):
        v, j_n = 3.0 * np.array([np.cos(angle + mu), np.sin(angle + mu)]), m * G * dt
        for _ in range(200):
            v = slowed(lesson, v, m, j_n, mu)
        close("velocity 4 s after a throw at 3 m/s [m/s]", v, np.zeros(2), ROUND_OFF,
              given=f"m = {m:.4g} kg, μ = {mu:.4g}")
    for speed in (1e-3, 1.0, 30.0):
        slowed(lesson, speed * draw(-1.0, 1.0, 2), m, draw(0.0, 2.0) * j_n, mu)
    for v in (*draw(-3.0, 3.0, (4, 2)), *3.0 * np.eye(2), *-3.0 * np.eye(2), np.zeros(2)):
        close("impulse of your floor without a load, j_n = 0 [N s]", lesson.my_friction(v, m, 0.0, mu), np.zeros(2),
              0.0, given=f"v_t = {v} m/s, μ = {mu}")
    v = draw(1.5, 3.0, 2)
    slips = [size * np.array([np.cos(turn) * v[0] - np.sin(turn) * v[1], np.sin(turn) * v[0] + np.cos(turn) * v[1]])
             for size, turn in ((1.0, 0.0), (0.3, 1.2), (0.6, 2.5))]
    got = np.array([lesson.my_friction(slip, m, j_n, mu) for slip in slips])
    cone = np.array([-mu * j_n * slip / np.linalg.norm(slip) for slip in slips])                # none of them stops
    pyramid = np.array([-mu * j_n * np.sign(slip) for slip in slips])
    for name, other in (("friction_impulse", cone), ("pyramid_impulse", pyramid)):
        times = np.sum(got * other) / np.sum(other * other)
        if np.linalg.norm(got - times * other) < NEW * np.linalg.norm(got):
            raise NotYet("a floor of your own", "another law than those of the lesson", f"{times:.3g} times {name}", "",
                         "no new floor")


def slowed(lesson, v, m, j_n, mu):
    """The velocity after one impulse of the own floor; it must not be larger."""
    after = v + np.asarray(lesson.my_friction(v, m, j_n, mu)) / m
    between("speed after an impulse of your floor, minus that before [m/s]",
            np.linalg.norm(after) - np.linalg.norm(v), -np.inf, ROUND_OFF)
    return after
