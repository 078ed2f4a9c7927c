"""Limits of impulses: the functions of lesson 7 compared with theory.

Edges are found by bisection of runs or of impacts, never from a formula.
*Source:* Painlevé 1895 for the rod; each case derives the other numbers.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from scipy.linalg import block_diag
from scipy.optimize import minimize_scalar, nnls

from solutions.checks import Diverged
from solutions.given import impact_modes
from solutions.impulses import cross_2d
from validate.reference.contact import enumerated
from validate.reference.impulses import COPIES, inverse_matrix, point_rows
from validate.stability.case import DOTS, EDGE, LINE, Picture, bisect, case, random_law, refuses, series

G = 9.81                     # [m/s²]
ROUND_OFF = 1e-12            # of numbers below 30 after a few hundred operations, each rounded by 1.1e-16 of its result
UP = np.array([0.0, 1.0, 0.0])
ACROSS = np.array([1.0, 0.0, 0.0])
STEEPEST = np.degrees(np.arctan(2.0))  # the angle at which Painlevé's paradox needs the least friction [°]


def ball(lesson, e, stiffness=1.0, damping=0.0, point=(0.0, 0.0)):
    """Return a BouncingBall over a level floor."""
    return lesson.BouncingBall(e, np.array([0.0, -G]), np.array(point), np.array([0.0, 1.0]), stiffness, damping)


def dropped(lesson, step, x, v, dt, steps, p):
    """Return (x, v), each (copies, 2), of falling balls after this number of steps."""
    return lesson.advance_balls(step, lesson.falling_acceleration, 0.0, x, v, dt, steps, p)


# ---------------------------------------------------------------------------------------------- a rod on its tip

def rod(lesson, degrees):
    """Return K (3, 3) of the lower tip of a uniform rod of 2 m and 1 kg that leans at that angle from the floor.

    y is up, and the rod turns about z.  With c, s the cosine and sine:  K = (1 + 3s², −3sc; −3sc, 1 + 3c²) in x and y.
    """
    theta = np.radians(degrees)
    return lesson.contact_matrix(np.array([-np.cos(theta), -np.sin(theta), 0.0]), 1.0, np.diag([0.0, 3.0, 3.0]))


def against_the_first_slip(K, mu, side):
    """Return n · K d [1/kg] for friction against the slip before the impact, the denominator of that rule's impulse."""
    return UP @ (K @ (UP + mu * side * ACROSS))


def impact_of_a_rod(lesson, K, mu, slip):
    """Return (whether the impact is finite, gain of energy [J], |u_n| after it [m/s], impulse over the bound)."""
    u = slip * ACROSS - UP
    J = lesson.contact_impulse(u, UP, K, 0.0, mu)
    bound = max(np.linalg.norm(np.linalg.solve(K, u)), 1.0 / K[1, 1])
    return np.all(np.isfinite(J)), lesson.energy_change(u, K, J), abs(UP @ (u + K @ J)), np.linalg.norm(J) / bound


def impacts_of_all_rods(lesson, check):
    """Let rods of every slope, friction and slip hit the floor, and judge the worst of these impacts."""
    ended, gains, errors, sizes = np.transpose([
        impact_of_a_rod(lesson, rod(lesson, degrees), mu, slip) for mu in (1.34, 2.0, 10.0, np.inf)
        for degrees in np.linspace(1.0, 89.0, 45) for slip in (-3.0, -0.3, 0.0, 0.3, 3.0)])
    finite, tried = np.sum(ended), len(ended)
    gained, wrong, size = np.maximum(0.0, np.max(gains)), np.max(errors), np.max(sizes)
    check("Every impact of every rod ends with a finite impulse.", f"finite impulses [of {tried}]",
          law=tried, found=finite, within=0.0,
          saw=f"{finite:.0f} of {tried} impacts at μ from 1.34 to ∞ end in a finite impulse.")
    check("No impact with e = 0 gains energy.", "largest gain of energy [J]", law=0.0, found=gained, within=ROUND_OFF,
          saw=f"The largest gain of an impact is {gained:.0e} J, of about 5 J.")
    check("The tip stays on the floor.", "largest normal velocity after the impact [m/s]",
          law=0.0, found=wrong, within=ROUND_OFF,
          saw=f"After the impact the normal velocity of the tip is at most {wrong:.0e} m/s.")
    check("No impulse exceeds the larger of the frictionless one and the sticking one.",
          "largest impulse over that, or 1 [-]", law=1.0, found=np.maximum(1.0, size), within=ROUND_OFF,
          saw=f"The largest impulse is {size:.3f} of that bound.")


@case("painleve-rod", "Painlevé's rod", compiled=False)
def painleve_rod(lesson, check):
    """Compare the paradox of a rod that slides on its tip over a rough floor with theory.

    Friction against the slip drives the tip into the floor.  With d = n + μ t,  n · K d = 1 + 3c² − 3μ sc.  It is
    zero first at tan θ = 2, for μ = 4/3.  From there on a rule that fixes friction against the first slip divides
    by zero, or pulls.  cone_impulse puts friction in the direction of a sticking impulse.  All J that end the
    normal motion that way lie on a line from the frictionless impulse to the sticking one.  Energy is convex along
    it, and neither of its ends gains any with e = 0.
    """
    near = [rod(lesson, a) for a in (STEEPEST - 1.0, STEEPEST, STEEPEST + 1.0)]
    edge = bisect(lambda mu: min(against_the_first_slip(K, mu, 1.0) for K in near) <= 0.0, 0.1, 10.0)
    check("Friction against the first slip has no solution for a leaning rod from μ = 4/3 on.",
          "least friction without a solution, rod of slope 2 [-]", law=4.0 / 3.0, found=edge, within=2.0 * EDGE,
          saw=f"At tan θ = 2 the impulse of that rule has a zero denominator at μ = {edge:.5f}.")
    impacts_of_all_rods(lesson, check)
    fine = np.linspace(2.0, 88.0, 173)
    naive = np.array([1.0 / against_the_first_slip(rod(lesson, a), 2.0, 1.0) for a in fine])
    drawn = (0.0 < naive) & (naive < 4.0)
    flat, steep, some = drawn & (fine < STEEPEST), drawn & (fine > STEEPEST), fine[::6]
    ours = [lesson.contact_impulse(-3.0 * ACROSS - UP, UP, rod(lesson, a), 0.0, 2.0)[1] for a in some]
    return Picture(
        "A rod pushed over a rough floor, μ = 2", "angle from the floor [°]", "normal impulse over m v [-]",
        [series("friction against the first slip, flatter rods", fine[flat], naive[flat], LINE),
         series("friction against the first slip, steeper rods", fine[steep], naive[steep], LINE),
         series("cone_impulse", some, ours, DOTS)],
        "Between 37° and 79° the common rule has no solution: its impulse would be infinite, or a pull. The cone's "
        "impulse stays finite.")


# ---------------------------------------------------------------------------------------------- deep overlap

RADIUS, SHORT = 0.5, 0.01    # of the bodies that overlap [m]; a step [s]
OMEGA, TINY = 1000.0, 1e-6   # of the penalty spring [1/s]; the step that resolves it [s]


def ball_is_placed_on_its_floor(lesson, check):
    """Take one projecting step of a ball at rest inside its floor."""
    depth = 0.25 * RADIUS
    x, v = lesson.position_projection_step(lesson.falling_acceleration, 0.0, np.array([0.0, -depth]), np.zeros(2),
                                           SHORT, ball(lesson, 0.5))
    work, speed = G * (x[1] + depth) + 0.5 * v @ v, np.hypot(*v)
    check("A ball inside the floor is placed on it.", "height after one step [m]",
          law=0.0, found=x[1], within=ROUND_OFF, saw=f"A ball {depth} m deep is at {x[1]:g} m after one step.")
    check("The correction does the work m g times the depth, and no more.", "energy gained [J/kg]",
          law=G * depth + 0.5 * (0.5 * G * SHORT) ** 2, found=work, within=ROUND_OFF,
          saw=f"The correction has given it {work:.5f} J/kg; g times the depth is {G * depth:.5f}.")
    check("The correction adds no speed: the speed e g dt comes from the fall of that step.",
          "speed after one step [m/s]", law=0.5 * G * SHORT, found=speed, within=ROUND_OFF,
          saw=f"It leaves at {speed:.4f} m/s, which is e g dt.")


def speed_of_ejection(lesson, depth):
    """Return the speed [m/s] with which the penalty method ejects a ball at rest from a depth [m]."""
    x, v, p = np.array([[0.0, -depth]]), np.zeros((1, 2)), ball(lesson, 0.5, OMEGA**2)
    for _ in range(1000):
        if x[0, 1] >= 0.0:
            break
        x, v = dropped(lesson, lesson.penalty_step, x, v, TINY, 20, p)
    return v[0, 1]


def overlapping_discs_come_apart(lesson, check):
    """Separate five discs in a row, each a quarter inside the next, and two discs at the same place."""
    step, inverse_masses = lesson.position_projection_discs_step, np.array([1.0, 0.5, 1.0, 2.0, 1.0])
    row = np.stack((0.75 * 2.0 * RADIUS * np.arange(5.0), np.zeros(5)), axis=1)
    apart, still = lesson.advance_discs(step, row[None], np.zeros((1, 5, 2)), SHORT, 400,
                                        lesson.Discs(np.full(5, RADIUS), inverse_masses, 0.8))
    before, after = ((1.0 / inverse_masses) @ places / np.sum(1.0 / inverse_masses) for places in (row, apart[0]))
    overlap, fastest = np.max(2.0 * RADIUS - np.diff(apart[0, :, 0]), initial=0.0), np.abs(still).max()
    way = np.linalg.norm(after - before)
    check("Five discs in a row, each a quarter inside the next, separate.", "largest overlap after 400 steps [m]",
          law=0.0, found=overlap, within=ROUND_OFF, saw=f"After 400 steps the largest overlap is {overlap:.0e} m.")
    check("After that, no disc moves.", "largest speed [m/s]", law=0.0, found=fastest, within=0.0,
          saw=f"The fastest of them moves at {fastest:g} m/s.")
    check("Their centre of mass does not move.", "way of the centre of mass [m]",
          law=0.0, found=way, within=ROUND_OFF, saw=f"Their centre of mass has moved by {way:.0e} m.")
    same = np.zeros((1, 2, 2))
    x, _ = lesson.advance_discs(step, same, same, SHORT, 1, lesson.Discs(np.full(2, RADIUS), np.ones(2), 0.8))
    distance = np.linalg.norm(x[0, 0] - x[0, 1])
    check("Two discs with the same centre have no normal between them, and still separate.",
          "distance after one step [m]",
          law=2.0 * RADIUS, found=distance, within=ROUND_OFF,
          saw=f"Two discs with the same centre are {distance:g} m apart after one step.")


@case("deep-overlap", "Deep overlap", compiled=False)
def deep_overlap(lesson, check):
    """Check that the correction of an overlap adds no speed: it does the work m g d and no more.

    A ball at rest at a depth d inside its floor is on the floor after one projecting step, with v = e g dt from the
    fall of that step.  The penalty method stores ½ k d² in its spring instead, and ejects the ball with √(ω² d² − 2
    g d).
    """
    depths = np.linspace(0.05, 0.5, 6) * RADIUS
    law, speeds = np.sqrt(OMEGA**2 * depths**2 - 2.0 * G * depths), [speed_of_ejection(lesson, d) for d in depths]
    ball_is_placed_on_its_floor(lesson, check)
    check("The penalty method ejects the same ball, because its spring starts compressed.",
          f"speed after ejection from a depth of {depths[2]:g} m at ω = 1000/s [m/s]",
          law=law[2], found=speeds[2], within=law[2] * OMEGA * TINY + G * 20.0 * TINY,
          saw=f"From {depths[2]:g} m the penalty method ejects a ball at rest with {speeds[2]:.1f} m/s.")
    overlapping_discs_come_apart(lesson, check)
    return Picture(
        "A ball released inside its floor", "depth [m]", "speed with which it leaves [m/s]",
        [series("penalty, theory", depths, law, LINE), series("penalty, measured", depths, speeds, DOTS),
         series("projecting: e g dt", depths, np.full(len(depths), 0.5 * G * SHORT), LINE)],
        "A spring that starts compressed ejects the ball; a projection stores no energy.")


# ---------------------------------------------------------------------------------------------- Zeno, and far away

def bouncing(lesson, e, T, steps, place=(0.0, 0.0), copies=1):
    """Return (x, v) of copies released at 1 m over a plane at `place`, each slightly earlier than the one before."""
    before = 0.01 * np.arange(copies)
    x = np.stack((np.zeros(copies), 1.0 - 0.5 * G * before**2), axis=1) + place
    v = np.stack((0.5 * np.ones(copies), -G * before), axis=1)
    return dropped(lesson, lesson.backtracking_step, x, v, T / steps, steps, ball(lesson, e, point=place))


def time_to_rest(lesson, e):
    """Return (theory, bisection) of the time [s] at which a ball dropped from 1 m stops bouncing."""
    end = np.sqrt(2.0 / G) * (1.0 + e) / (1.0 - e)
    return end, bisect(lambda T: bouncing(lesson, e, T, 1)[1][0, 1] == 0.0, 0.5, 2.0 * end)


@case("zeno-and-far-away", "Zeno's bounce, and bounces far from the origin", compiled=False)
def zeno_and_far_away(lesson, check):
    """Check that infinitely many bounces end after √(2h/g) (1 + e)/(1 − e), and bounces far from the origin.

    At 10⁵ m a position is rounded to half a spacing, twice per step, so N steps add up to an error of N spacings in
    the height at which a ball meets its plane.  A height wrong by δ changes the speed by g δ/v and the time by δ/v
    at an impact with v.  One flight later both have grown by at most (1 + 2/e).  Three impacts multiply the error
    by less than (1 + 2/e)³ = 43.
    """
    for e in (0.5, 0.8, 0.95):
        end, stop = time_to_rest(lesson, e)
        check("A ball stops bouncing after √(2h/g) (1 + e)/(1 − e).", f"time to the stop for e = {e:g} [s]",
              law=end, found=stop, within=EDGE * end,
              saw=f"With e = {e:g} a ball dropped from 1 m is at rest from {stop:.5f} s on.")
    x, v = bouncing(lesson, 0.8, 5.0, 500)
    check("The stepped run ends at rest on the plane, to the last digit.",
          "height and speed after 5 s in 500 steps [m, m/s]",
          law=0.0, found=np.hypot(x[0, 1], v[0, 1]), within=ROUND_OFF,
          saw=f"After 500 steps it lies at {x[0, 1]:.0e} m and moves at {v[0, 1]:g} m/s.")
    steps, far = 190, 10.0 ** np.arange(2, 9)
    near, _ = bouncing(lesson, 0.8, 1.9, steps, copies=COPIES)
    errors = []
    for place in far[:, None] * np.array([1.0, -0.8]):
        x, _ = bouncing(lesson, 0.8, 1.9, steps, place, COPIES)
        errors.append(np.sqrt(np.mean((x - place - near) ** 2)))
    check("At a distance of 10⁵ m the error is the rounding of floats there, summed over the steps.",
          "error of the position at (10⁵, −8·10⁴) m after 190 steps [m]",
          law=0.0, found=errors[3], within=43.0 * steps * np.spacing(1e5),
          saw=f"At (10⁵, −8·10⁴) m the position is off by {errors[3]:.1e} m; floats are {np.spacing(1e5):.1e} m apart "
              "there.")
    power = np.polyfit(np.log10(far), np.log10(errors), 1)[0]
    check("The error grows in proportion to the distance, as the spacing of floats does.",
          "order of its growth from 10² to 10⁸ m [-]", law=1.0, found=power, within=0.15,
          saw=f"From 10² to 10⁸ m the error grows with the power {power:.3f} of the distance.")
    return Picture(
        "Far from the origin", "log₁₀ of the distance [m]", "log₁₀ of the error [m]",
        [series("spacing of floats", np.log10(far), np.log10(np.spacing(far)), LINE),
         series("the bound of 190 steps", np.log10(far), np.log10(43.0 * steps * np.spacing(far)), LINE),
         series("measured", np.log10(far), np.log10(errors), DOTS)],
        "The spacing of floats explains the whole error, which follows it over six decades.")


# ---------------------------------------------------------------------------------------------- the penalty's price

def swings_up(lesson, h_omega, zeta):
    """Return whether a ball at rest on its penalty spring, disturbed by 10⁻⁹ of its depth, reaches 10⁻³ of it."""
    omega = 100.0
    sag, p = G / omega**2, ball(lesson, 0.5, omega**2, 2.0 * zeta * omega)
    x, v, steps = np.array([[0.0, -sag * (1.0 + 1e-9)]]), np.zeros((1, 2)), 500 if zeta == 0.0 else 2000
    try:
        x, v = dropped(lesson, lesson.penalty_step, x, v, h_omega / omega, steps, p)
    except Diverged:
        return True
    return max(abs(x[0, 1] + sag), abs(v[0, 1]) / omega) > 1e-3 * sag


@case("penalty-stability", "Longest step and depth of a penalty spring", compiled=False)
def penalty_stability(lesson, check):
    """Compare the longest stable step of a penalty spring with 2(√(1 + ζ²) − ζ)/ω, and its depth at rest with g/ω².

    Just beyond, at ω dt (1 + ε), an undamped oscillation grows by √(8ε) per step.  500 steps amplify it by 10⁶ from
    ε = 9.5e-5 on, so the edge is found that much late.  With a damper the growth is at least 2ε per step, and 2,000
    steps find the edge at ε = ln 10⁶/4000 = 3.5e-3 at most.
    """
    law, edges = lambda zeta: 2.0 * (np.sqrt(1.0 + zeta**2) - zeta), {}
    for zeta in (0.0, 0.1, 0.3, 0.6, 1.0):
        edges[zeta] = bisect(lambda y, zeta=zeta: swings_up(lesson, y, zeta), 0.2, 3.0)
        late = (np.log(1e6) / 500.0) ** 2 / 8.0 if zeta == 0.0 else np.log(1e6) / 4000.0
        check("A penalty spring needs steps shorter than 2(√(1 + ζ²) − ζ)/ω.",
              f"largest ω dt that stays bounded, ζ = {zeta:g} [-]",
              law=law(zeta), found=edges[zeta], within=law(zeta) * (late + EDGE),
              saw=f"At ζ = {zeta:g} the oscillation of a ball on its penalty spring grows from ω dt = "
                  f"{edges[zeta]:.4f} on.")
    for omega in (30.0, 100.0, 300.0):
        still, p = np.zeros((1, 2)), ball(lesson, 0.5, omega**2, 2.0 * omega)
        x, _ = dropped(lesson, lesson.penalty_step, still, still, 0.1 / omega, 1000, p)
        check("A body at rest on a penalty spring sinks in by m g/k.", f"depth at rest, ω = {omega:g}/s [m]",
              law=G / omega**2, found=-x[0, 1], within=ROUND_OFF,
              saw=f"At ω = {omega:g}/s a resting ball is {-1e3 * x[0, 1]:.3f} mm deep; steps must stay below "
                  f"{2e3 / omega:.1f} ms.")
    fine = np.linspace(0.0, 1.0, 101)
    return Picture(
        "Penalty: the longest step", "damping ratio ζ [-]", "ω dt [-]",
        [series("theory", fine, law(fine), LINE), series("measured", edges.keys(), edges.values(), DOTS)],
        "A floor that is twice as stiff needs steps shorter by a factor of 1.4, and a damper shortens them further.")


# ---------------------------------------------------------------------------------------------- gain of energy

def gain(lesson, K, u, e, mu):
    """Return the energy [J] that an impact on UP gains."""
    return lesson.energy_change(u, K, lesson.contact_impulse(u, UP, K, e, mu))


def least_restitution_that_gains(lesson, degrees):
    """Return the smallest e with which a sticking impact of a rod with u_n = −1 m/s gains energy at some slip."""
    K = rod(lesson, degrees)
    lost = lambda slip, e: -gain(lesson, K, slip * ACROSS - UP, e, np.inf)
    least = lambda e: minimize_scalar(lost, bounds=(-5.0, 5.0), args=(e,), method="bounded", options={"xatol": 1e-9})
    return bisect(lambda e: least(e).fun < 0.0, 0.3, 1.0)


def least_gaining(K):
    """Return the restitution above which an impact can gain energy:  e* = 1/√(K_nn (K⁻¹)_nn)."""
    return 1.0 / np.sqrt(K[1, 1] * np.linalg.inv(K)[1, 1])


def count_gains(lesson, tried):
    """Return how many random impacts gain energy, how many of them below e*, and how many gain it with e = 0."""
    rng, gained, broken, dead = np.random.default_rng(18), 0, 0, 0
    for _ in range(tried):
        r, moments = rng.uniform(-1.0, 1.0, 3), rng.uniform(0.2, 2.0, 3)
        K, u = lesson.contact_matrix(r, 1.0, np.diag(1.0 / moments)), rng.normal(size=3)
        u[1], e, mu = -abs(u[1]) - 0.01, rng.uniform(), rng.uniform(0.0, 2.0)
        more = gain(lesson, K, u, e, mu) > ROUND_OFF
        gained += more
        broken += more and e < least_gaining(K)
        dead += gain(lesson, K, u, 0.0, mu) > ROUND_OFF
    return gained, broken, dead


@case("energy-gain", "Energy gained by restitution with friction", compiled=False)
def energy_gain(lesson, check):
    """Check that Newton's restitution with friction gains energy if e > 1/√(K_nn (K⁻¹)_nn), at a certain slip.

    For the rod that is 2/√((1 + 3c²)(1 + 3s²)).  A sticking J gives ½ (e² u_n² n · K⁻¹n − u · K⁻¹u).  The gain is
    largest where u · K⁻¹u is smallest for its u_n, at u_n²/K_nn.  Energy is a convex function on the line from the
    frictionless impulse to the sticking one, so no sliding impact gains unless one of the two does.
    """
    law = lambda a: 2.0 / np.sqrt((1.0 + 3.0 * np.cos(np.radians(a)) ** 2) * (1.0 + 3.0 * np.sin(np.radians(a)) ** 2))
    edges = {a: least_restitution_that_gains(lesson, a) for a in (10.0, 20.0, 30.0, 45.0, 60.0, 75.0)}
    for a in (30.0, 45.0, 75.0):
        check("A leaning rod can gain energy from e = 2/√((1 + 3cos²θ)(1 + 3sin²θ)) on.",
              f"least restitution that gains, rod at {a:g}° [-]", law=law(a), found=edges[a], within=10.0 * EDGE,
              saw=f"A rod at {a:g}° gains energy at some slip from e = {edges[a]:.5f} on.")
    gained, broken, dead = count_gains(lesson, 1500)
    check("Below that restitution no impact gains energy, sliding or sticking, in the plane or in space.",
          "impacts that gain energy below it [of 1500]", law=0, found=broken, within=0.0,
          saw=f"Of 1,500 random impacts {gained} gain energy, {broken} of them below the bound.")
    check("Without restitution no impact gains energy.", "impacts with e = 0 that gain energy [of 1500]",
          law=0, found=dead, within=0.0, saw=f"With e = 0 {dead} of 1,500 impacts gain energy.")
    K, u = rod(lesson, 45.0), 2.0 * ACROSS - UP
    worst = np.max([abs(gain(lesson, K, u, e, 0.0) + 0.5 * (1.0 - e * e) / K[1, 1]) for e in (0.0, 0.5, 1.0)])
    check("Without friction an impact loses ½ (1 − e²) u_n²/k.", "largest difference for e = 0, ½, 1 [J]",
          law=0.0, found=worst, within=ROUND_OFF, saw=f"Frictionless impacts lose what theory gives, to {worst:.0e} J.")
    fine = np.linspace(0.0, 90.0, 181)
    return Picture(
        "When restitution with friction gains energy", "angle of the rod from the floor [°]", "restitution e [-]",
        [series("theory: it may gain above", fine, law(fine), LINE),
         series("measured", edges.keys(), edges.values(), DOTS)],
        "At 45° a sticking impact can gain energy from e = 0.8 on, at one particular slip; upright or flat it never "
        "does.")


# ---------------------------------------------------------------------------------------------- invalid impacts

def invalid_calls(lesson, u):
    """Return ((function, arguments, the value in its message), …) of impacts that have no physics."""
    n, K, zero = UP, np.eye(3), np.zeros(3)
    body, r, drop = lesson.BodyState3D(u, zero, 1.0, np.eye(3)), np.zeros((1, 3)), ball(lesson, 0.5)
    fall = (lesson.falling_acceleration, 0.0, np.ones((1, 2)), np.zeros((1, 2)), 0.1, 1)
    pair, discs = np.zeros((1, 2, 2)), lesson.Discs(np.ones(2), np.ones(2), -1.0)
    return (
        ("impulse_size", (-1.0, 1.0, 1.5), "1.5"),
        ("impulse_size", (-1.0, 1.0, -0.5), "-0.5"),
        ("impulse_size", (-1.0, 0.0, 0.5), "0.0"),
        ("cone_impulse", (u, n, K, 0.0, -0.3), "-0.3"),
        ("cone_impulse", (u, zero, K, 0.0, 0.3), "0.0"),
        ("cone_impulse", (u, n, 0.0 * K, 0.0, 0.3), "0.0"),
        ("cone_impulse", (np.nan * u, n, K, 0.0, 0.3), "nan"),
        ("contact_impulse", (u, n, K, 2.0, 0.3), "2.0"),
        ("gap_multiplier", (0.1, -1.0, 0.0, 0.1), "0.0"),
        ("solve_impacts", (body, r, n[None], 1.25, 0.3), "1.25"),
        ("solve_impacts", (body, r, n[None], 0.5, -0.3), "-0.3"),
        ("advance_balls", (lesson.position_projection_step, *fall, drop._replace(e=1.5)), "1.5"),
        ("advance_balls", (lesson.backtracking_step, *fall, drop._replace(n=np.zeros(2))), "0.0"),
        ("advance_balls", (lesson.backtracking_step, fall[0], 0.0, np.full((1, 2), np.inf), *fall[3:], drop), "inf"),
        ("advance_discs", (lesson.position_projection_discs_step, pair, pair, 0.1, 1, discs), "-1.0"),
    )


@case("invalid-impacts", "Invalid and extreme impacts", compiled=False)
def invalid_impacts(lesson, check):
    """Check that impossible impacts are refused by name and value, and that extreme but valid ones are solved."""
    u, exponents, sizes, errors = np.array([1.0, -2.0, 0.5]), np.linspace(-6.0, 8.0, 15), [], []
    asked = invalid_calls(lesson, u)
    refused = sum(refuses(getattr(lesson, name), arguments, value) for name, arguments, value in asked)
    check("Restitution outside 0 to 1, negative friction, a missing normal, two immovable bodies and NaN are refused, "
          "and the message gives the value.", f"calls whose error names the value [of {len(asked)}]",
          law=len(asked), found=refused, within=0.0,
          saw=f"{refused} of {len(asked)} such calls end in a message that names the value.")
    for speed in 10.0**exponents:
        J = lesson.contact_impulse(speed * u, UP, np.eye(3), 0.5, 0.3)
        sizes.append(np.linalg.norm(J) / speed)
        errors.append(abs(UP @ (speed * u + np.eye(3) @ J) - speed) / speed)
    check("An impact has no characteristic speed: the same law holds from 10⁻⁶ to 10⁸ m/s.",
          "largest error of the rebound, over the speed [-]", law=0.0, found=np.max(errors), within=ROUND_OFF,
          saw=f"Over fourteen decades of speed the rebound is right to {np.max(errors):.0e}.")
    K = np.diag([1e6, 1.0, 1e-6]) + 1e-7 * np.ones((3, 3))
    check("Infinite friction gives a finite impulse for any inertias.",
          "rebound with μ = ∞ and inertias over twelve decades [m/s]",
          law=1.0, found=UP @ (u + K @ lesson.contact_impulse(u, UP, K, 0.5, np.inf)), within=1e-9,
          saw="With μ = ∞ and inertias over twelve decades the impact has the expected rebound.")
    return Picture(
        "The same impact at any speed", "log₁₀ of the speed [m/s]", "impulse over m v [-]",
        [series("theory", exponents, np.full(15, 3.0 * np.hypot(1.0, 0.3)), LINE),
         series("contact_impulse", exponents, sizes, DOTS)],
        "Coulomb's cone and Newton's restitution contain no length and no time.")


# ---------------------------------------------------------------------------------------------- random bodies

TRIED = 100                  # random configurations of each law; a law returns (got, truth) in one of them
NEAR = (0.95, 1.05)          # of what friction can hold [-]


def unit_vector(rng, d=3):
    """Return a random unit vector (d,)."""
    y = rng.normal(size=d)
    return y / np.linalg.norm(y)


def random_inertia(rng):
    """Return a random inertia tensor (3, 3) [kg m²]."""
    factor = rng.normal(size=(3, 3))
    return factor @ factor.T + 0.5 * np.eye(3)


def random_body(rng):
    """Return (1/m [1/kg], I⁻¹ [1/(kg m²)]) of a random body."""
    return 1.0 / rng.uniform(0.5, 2.0), np.linalg.inv(random_inertia(rng))


def response(r, inv_mass, inv_inertia):
    """Return K (3, 3) [1/kg] of the point r of a body."""
    return point_rows(r) @ inverse_matrix(1.0 / inv_mass, inv_inertia) @ point_rows(r).T


def along(y, n):
    """Return the part of y along a surface."""
    return y - (y @ n) * n


# ---------------------------------------------------------------------------------------------- two bodies

class Pair(NamedTuple):
    """Two bodies that touch: their velocities y, and the matrices of u = G y and of the change W Gᵀ J of y."""
    bodies: tuple            # a and b of the lesson
    arms: tuple              # of the contact
    y: np.ndarray            # (v_a, ω_a, v_b, ω_b)
    W: np.ndarray            # inverse masses, square
    G: np.ndarray
    relative_velocity: Callable          # the functions of the lesson
    inverse_mass: Callable
    apply: Callable

    def after(self, J):
        """Return the velocities after J on a and −J on b."""
        hit = [self.apply(body, r, sign * J) for body, r, sign in zip(self.bodies, self.arms, (1.0, -1.0))]
        return np.concatenate([np.append(body.v, body.omega) for body in hit])


# entries of (v_a, ω_a, v_b, ω_b) that are held: none, an axle, the floor, a body that cannot rotate; the same for a
HELD: tuple[list[int], ...] = ([], [3, 4], [3, 4, 5], [5], [0, 1], [2, 3, 4, 5])


def inverse_masses(rng, held):
    """Return (6,): the inverse masses of two bodies in the plane, some of which are held."""
    inverse = 1.0 / rng.uniform(0.5, 2.0, 4)[[0, 0, 1, 2, 2, 3]]
    inverse[HELD[rng.integers(len(HELD))] if held else []] = 0.0
    return inverse


def planar_pair(lesson, rng, held=True):
    """Return a Pair in the plane at any speed:  v + ω × r = (v_x − ω r_y, v_y + ω r_x)."""
    r_a, r_b = rng.normal(size=(2, 2))
    inverse = inverse_masses(rng, held)
    y = 10.0 ** rng.uniform(-4.0, 0.0) * rng.normal(size=6)
    a = lesson.BodyState2D(y[:2], y[2], inverse[0], inverse[2])
    b = lesson.BodyState2D(y[3:5], y[5], inverse[3], inverse[5])
    G = np.array([[1.0, 0.0, -r_a[1], -1.0, 0.0, r_b[1]], [0.0, 1.0, r_a[0], 0.0, -1.0, -r_b[0]]])
    return Pair((a, b), (r_a, r_b), y, np.diag(inverse), G, lesson.relative_velocity_2d,
                lesson.effective_inverse_mass_2d, lesson.apply_impulse_2d)


def spatial_pair(lesson, rng):
    """Return the same in space."""
    r_a, r_b = rng.normal(size=(2, 3))
    y, inverse = rng.normal(size=12), inverse_masses(rng, True)
    turn_a, turn_b = (np.linalg.inv(random_inertia(rng)) * (inverse[k] > 0.0) for k in (2, 5))
    a = lesson.BodyState3D(y[:3], y[3:6], inverse[0], turn_a)
    b = lesson.BodyState3D(y[6:9], y[9:], inverse[3], turn_b)
    W = block_diag(inverse[0] * np.eye(3), turn_a, inverse[3] * np.eye(3), turn_b)
    return Pair((a, b), (r_a, r_b), y, W, np.hstack((point_rows(r_a), -point_rows(r_b))), lesson.relative_velocity,
                lesson.effective_inverse_mass, lesson.apply_impulse)


def relative_velocity(pair):
    """Return the relative velocity of the lesson, and G y."""
    return pair.relative_velocity(*pair.bodies, *pair.arms), pair.G @ pair.y


def inverse_mass_along(pair, n):
    """Return k_n of the lesson over n · G W Gᵀ n, and 1."""
    return pair.inverse_mass(*pair.bodies, *pair.arms, n) / (n @ pair.G @ pair.W @ pair.G.T @ n), 1.0


@random_law("Two points approach with the velocities of centres and rotations.",
            "largest error of the relative velocity [m/s]", 1e-12)
def planar_velocities(lesson, rng):
    return relative_velocity(planar_pair(lesson, rng))


@random_law("In space two points approach with u = G v.",
            "largest error of the relative velocity in space [m/s]", 1e-12)
def spatial_velocities(lesson, rng):
    return relative_velocity(spatial_pair(lesson, rng))


@random_law("In the plane k_n is G M⁻¹ Gᵀ.", "largest error of the k_n, relative [-]", 1e-12)
def planar_masses(lesson, rng):
    return inverse_mass_along(planar_pair(lesson, rng), unit_vector(rng, 2))


@random_law("In space k_n is G M⁻¹ Gᵀ, too.", "largest error of the k_n in space, relative [-]", 1e-12)
def spatial_masses(lesson, rng):
    return inverse_mass_along(spatial_pair(lesson, rng), unit_vector(rng))


@random_law("In space an impulse changes velocities by M⁻¹ Gᵀ J.",
            "largest error of the velocities in space [m/s, rad/s]", 1e-12)
def pushes(lesson, rng):
    pair, J = spatial_pair(lesson, rng), rng.normal(size=3)
    return pair.after(J), pair.y + pair.W @ pair.G.T @ J


def impact(lesson, rng, held=True):
    """Return (Pair, n, −e u_n, change of y, j) of an impact in the plane, over the size of the velocities."""
    pair, n, e = planar_pair(lesson, rng, held), unit_vector(rng, 2), rng.uniform(0.1, 0.9)
    n = -n if n @ pair.G @ pair.y > 0.0 else n
    u_n, size = n @ pair.relative_velocity(*pair.bodies, *pair.arms), np.linalg.norm(pair.y)
    k_n = pair.inverse_mass(*pair.bodies, *pair.arms, n)
    change = pair.after(lesson.impulse_size(u_n, k_n, e) * n) - pair.y
    return pair, n, -e * u_n / size, change / size, -(1.0 + e) * u_n / k_n / size


@random_law("They separate with −e u_n, at any speed of approach.",
            "largest error of the velocity after the impact, relative [-]", 1e-12)
def rebounds(lesson, rng):
    pair, n, u_sep, change, _ = impact(lesson, rng)
    return n @ pair.G @ (pair.y / np.linalg.norm(pair.y) + change), u_sep


@random_law("A held coordinate keeps its velocity, and all others change by M⁻¹ Gᵀ j.",
            "largest error of the change of velocity, relative [-]", 1e-12)
def changes(lesson, rng):
    pair, n, _, change, j = impact(lesson, rng)
    return change, pair.W @ pair.G.T @ n * j


@random_law("An impact keeps the momentum.", "largest error of the momentum, relative [kg]", 1e-12)
def momenta(lesson, rng):
    pair, _, _, change, _ = impact(lesson, rng, held=False)
    P = np.linalg.solve(pair.W, change)
    return P[:2] + P[3:5], np.zeros(2)


@random_law("An impact keeps the angular momentum about the origin.",
            "largest error of the angular momentum, relative [kg m]", 1e-12)
def angular_momenta(lesson, rng):
    pair, _, _, change, _ = impact(lesson, rng, held=False)
    P, place = np.linalg.solve(pair.W, change), rng.normal(size=2)
    return sum(cross_2d(place - r, P[k:k + 2]) + P[k + 2] for k, r in zip((0, 3), pair.arms)), 0.0


@random_law("L changes by r × J, and the total angular momentum is conserved.",
            "largest error of the momenta in space [kg m²/s]", 1e-12)
def angular_momenta_in_space(lesson, rng):
    """Let both bodies touch at one point, so that J and −J together have no torque about the origin."""
    place, r_a, r_b, L_a, L_b, J = rng.normal(size=(6, 3))
    new_a, new_b = lesson.angular_momenta(L_a, L_b, r_a, r_b, J)
    orbital = np.cross(place - r_a, J) - np.cross(place - r_b, J)
    return (new_a - L_a, new_a + new_b + orbital), (np.cross(r_a, J), L_a + L_b)


@case("two-bodies", "An impact of two free bodies, in the plane and in space", compiled=False)
def two_bodies(lesson, check):
    """Compare K with G M⁻¹ Gᵀ, where G are the rows of the contact's velocity, and check both momenta about the origin.

    In space a body's block of M is its inertia tensor in the world, and its part of G is n and r × n.
    A held coordinate has a 0 in M⁻¹: a body on an axle does not move, like the floor, but rotates.
    """
    check.laws(lesson, (planar_velocities, planar_masses, rebounds, changes, momenta, angular_momenta, spatial_masses,
                        spatial_velocities, pushes, angular_momenta_in_space), seed=77, times=TRIED)


# ---------------------------------------------------------------------------------------------- laws of an impact

FLIGHTS = 400                # terms of a sum [-]: 0.9⁴⁰⁰ is below round-off
LONG = 10.0                  # a step [s] within which most gaps close


@random_law("A surface reverses an approaching velocity, times e, and does not change a leaving one, at any speed.",
            "largest error of the velocity [m/s]", 1e-9)
def reflections(lesson, rng):
    n, e = unit_vector(rng), rng.uniform()
    v_n, v_t = 10.0 ** rng.uniform(-3.0, 0.0) * rng.normal(), along(rng.normal(size=3), n)
    return lesson.kinematic_response(v_n * n + v_t, n, e), (v_n if v_n > 0.0 else -e * v_n) * n + v_t


@random_law("A penalty spring with its damper pushes while it is compressed, and never pulls.",
            "largest error of the force, relative [-]", 1e-9)
def springs(lesson, rng):
    """Include the velocity `part` at which the damper alone would pull as strongly as the spring pushes."""
    k, d, deep = rng.uniform(0.5, 2.0, 3)
    part = -k * deep / d
    cases = ((-deep, 0.0), (-deep, part), (-deep, -0.5 * part), (-deep, -2.0 * part), (deep, part), (0.0, part))
    pushes = np.array([lesson.penalty_force(phi, v_n, k, d) for phi, v_n in cases])
    return pushes / (k * deep), np.array([1.0, 2.0, 0.5, 0.0, 0.0, 0.0])


@random_law("K = 1/m − r* I⁻¹ r*.", "largest error of the K [1/kg]", 1e-9)
def responses(lesson, rng):
    r, body = rng.normal(size=3), random_body(rng)
    return lesson.contact_matrix(r, *body), response(r, *body)


def rough_impact(rng):
    """Return (u, n, K, u_sep, sticking J) of an impact whose points stick if the contact is rough enough."""
    n, u, u_sep = unit_vector(rng), rng.normal(size=3), rng.uniform(0.0, 0.5)
    u = along(u, n) - rng.uniform(0.5, 1.5) * n
    K = response(rng.normal(size=3), *random_body(rng))
    stick = np.linalg.solve(K, u_sep * n - u)
    return (u, n, K, u_sep, stick) if stick @ n > 0.0 else rough_impact(rng)


def needed(stick, n):
    """Return the μ that sticking needs."""
    return np.linalg.norm(along(stick, n)) / (stick @ n)


@random_law("A rough impact ends with the normal velocity that restitution requires.",
            "largest error of the normal velocity [m/s]", 1e-9)
def normal_velocities(lesson, rng):
    u, n, K, u_sep, stick = rough_impact(rng)
    J = lesson.cone_impulse(u, n, K, u_sep, rng.choice(NEAR) * needed(stick, n))
    return n @ (u + K @ J), u_sep


@random_law("5 % inside the cone the point sticks, 5 % outside the impulse is on the rim.",
            "largest error of the law of Coulomb [N s, m/s]", 1e-9)
def cones(lesson, rng):
    u, n, K, u_sep, stick = rough_impact(rng)
    share = rng.choice(NEAR)
    mu = share * needed(stick, n)
    J = lesson.cone_impulse(u, n, K, u_sep, mu)
    return (np.linalg.norm(along(J, n)), mu * (J @ n)) if share < 1.0 else (u + K @ J, u_sep * n)


@random_law("Friction has the direction of the sticking impulse.", "largest error of the direction of friction [-]",
            1e-9)
def sides(lesson, rng):
    u, n, K, u_sep, stick = rough_impact(rng)
    J = lesson.cone_impulse(u, n, K, u_sep, rng.choice(NEAR) * needed(stick, n))
    J_t, stick_t = along(J, n), along(stick, n)
    return J_t / np.linalg.norm(J_t), stick_t / np.linalg.norm(stick_t)


@random_law("If a sticking impulse would pull, the impulse is on the rim for any μ.",
            "largest error of the impulse, relative [-]", 1e-9)
def pulls(lesson, rng):
    """Let the point slip so fast that a sticking impulse would pull."""
    n, u_sep = unit_vector(rng), rng.uniform(0.0, 0.5)
    K = response(rng.normal(size=3), *random_body(rng))
    k_n, t = n @ K @ n, along(K @ n, n)
    lean = 3.0 * k_n / (t @ t)
    mu = rng.choice(NEAR) * lean * np.linalg.norm(t)
    J = lesson.cone_impulse(u_sep * n - K @ (lean * t - n), n, K, u_sep, mu)
    J_n = 2.0 * k_n / (k_n + mu * np.linalg.norm(t))
    return J / (J_n * (1.0 + mu)), (n + mu * t / np.linalg.norm(t)) / (1.0 + mu)


@random_law("The gain of energy is that of ½m v² and ½ω·Iω.", "largest error of the gain, relative [-]", 1e-9)
def works(lesson, rng):
    inv_mass, inv_inertia = random_body(rng)
    r, v, omega, J = rng.normal(size=(4, 3))
    energy = lambda v, omega: 0.5 * (v @ v / inv_mass + omega @ np.linalg.solve(inv_inertia, omega))
    gained = energy(v + inv_mass * J, omega + inv_inertia @ np.cross(r, J)) - energy(v, omega)
    change = lesson.energy_change(v + np.cross(omega, r), response(r, inv_mass, inv_inertia), J)
    return change / (1.0 + abs(gained)), gained / (1.0 + abs(gained))


@random_law("A gap closes exactly in its step, or stays open without an impulse.",
            "largest error of the gap after the step [m]", 1e-9)
def gaps(lesson, rng):
    phi, k_n, dt = rng.uniform(0.1, 1.0, 3)
    u_n = -rng.choice((0.5, 2.0)) * phi / dt
    return phi + dt * (u_n + k_n * lesson.gap_multiplier(phi, u_n, k_n, dt)), max(0.0, phi + dt * u_n)


@random_law("A gap closes at the first root of its parabola.", "largest error of the time [s]", 1e-9)
def closing_times(lesson, rng):
    phi, v_n, a_n = rng.uniform(0.1, 1.0), rng.normal(), rng.normal()
    roots = np.roots((0.5 * a_n, v_n, phi))
    ahead = [root.real for root in roots if root.imag == 0.0 and 0.0 < root.real < LONG]
    return lesson.impact_time(phi, v_n, a_n, LONG), min(ahead, default=LONG)


@random_law("A point inside is in contact: its gap closes at once, when it returns, or never.",
            "largest error of the time from inside [s]", 1e-9)
def times_from_inside(lesson, rng):
    phi = rng.uniform(0.1, 1.0)
    speed, pull = abs(rng.normal(size=2))
    ways = (-speed, rng.normal()), (speed, -pull), (speed, pull)
    return tuple(lesson.impact_time(-phi, *way, LONG) for way in ways), (0.0, min(2.0 * speed / pull, LONG), LONG)


@random_law("The duration of all bounces is the sum of their flights.",
            "largest error of the time of all bounces, relative [-]", 1e-9)
def times_of_all_bounces(lesson, rng):
    speed, pull = abs(rng.normal(size=2))
    e = rng.uniform(0.0, 0.9)
    times = [lesson.bouncing_time(*way, e) for way in ((speed, -pull), (speed, pull), (-speed, -pull))]
    return np.array(times) * pull / (2.0 * speed), np.array([np.sum(e ** np.arange(FLIGHTS)), np.inf, 0.0])


@random_law("A plane pushes and never pulls: an upward force lifts a ball off.",
            "largest error of the state after sliding [m, m/s]", 1e-9)
def slides(lesson, rng):
    """Let gravity into a plane slide a ball, and gravity away from it lift the ball off."""
    n, dt = unit_vector(rng), rng.uniform(0.1, 1.0)
    x, v, a = rng.normal(size=(3, 3))
    pushed, v_t = a - min(0.0, a @ n) * n, along(v, n)
    return lesson.slide_on_plane(x, v, a, dt, n), (x + dt * v_t + 0.5 * dt * dt * pushed, v_t + dt * pushed)


@random_law("A flight is a parabola.", "largest error of the state after a flight [m, m/s]", 1e-9)
def flights(lesson, rng):
    dt = rng.uniform(0.1, 1.0)
    x, v, a = rng.normal(size=(3, 3))
    return lesson.free_flight(x, v, a, dt), (x + dt * v + 0.5 * dt * dt * a, v + dt * a)


def tilted_ball(lesson, rng):
    """Return (BouncingBall, axes, place, v, dt) over a tilted plane; axes are its normal and two vectors along it.

    The place is in these coordinates, from the point of the plane.
    """
    axes = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    p = lesson.BouncingBall(rng.uniform(), rng.normal(size=3), rng.normal(size=3), axes[0], 30.0, 2.0)
    return p, axes, rng.normal(size=3) * (0.1, 1.0, 1.0), rng.normal(size=3), rng.uniform(0.1, 1.0)


@random_law("A gap is the distance along the normal, for any tilt of the plane.",
            "largest error of the gap over a tilted plane [m]", 1e-9)
def distances(lesson, rng):
    p, axes, place, _, _ = tilted_ball(lesson, rng)
    return lesson.gap(p.point + place @ axes, p), place[0]


@random_law("A penalty pushes along the normal, with its damper on the normal velocity.",
            "largest error of the velocity after a step with a penalty [m/s]", 1e-9)
def penalties(lesson, rng):
    p, _, place, v, dt = tilted_ball(lesson, rng)
    depth = abs(place[0])
    push = max(0.0, p.stiffness * depth - p.damping * (p.n @ v))
    _, pushed = lesson.penalty_step(lesson.falling_acceleration, 0.0, p.point - depth * p.n, v, dt, p)
    return pushed, v + dt * (p.gravity + push * p.n)


@random_law("A ball that ends inside is moved out along the normal, even if it is already leaving.",
            "largest error of the state after a step over a tilted plane [m, m/s]", 1e-9)
def tilted_steps(lesson, rng):
    p, axes, place, v, dt = tilted_ball(lesson, rng)
    got = lesson.position_projection_step(lesson.falling_acceleration, 0.0, p.point + place @ axes, v, dt, p)
    speeds = axes @ (v + dt * p.gravity)
    place = place + dt * speeds
    if place[0] < 0.0:
        place[0], speeds[0] = 0.0, max(speeds[0], -p.e * speeds[0])
    return got, (p.point + place @ axes, speeds @ axes)


def spinning(lesson, p, mu):
    """Return the same ball as a SpinningBall."""
    return lesson.SpinningBall(p.e, mu, 1.0, np.eye(3), 0.1, p.gravity, p.point, p.n)


@random_law("Each step of a loop takes the acceleration of its own time.",
            "largest error of the velocity after four steps [m/s]", 1e-9)
def steps_in_time(lesson, rng):
    """Run loops far above a plane, under a force that oscillates."""
    p, _, x, v, dt = tilted_ball(lesson, rng)
    t, p = rng.uniform(0.0, 6.0), p._replace(point=p.point - 1e3 * p.n)
    swings = lambda t, x, v, p: np.cos(t) * p.gravity
    _, end = lesson.advance_balls(lesson.position_projection_step, swings, t, x[None], v[None], dt, 4, p)
    ends = [end, *(lesson.advance_spinning_balls(step, swings, t, x[None], v[None], x[None], dt, 4,
                                                 spinning(lesson, p, 0.3))[1]
                   for step in (lesson.position_projection_spin_step, lesson.backtracking_spin_step))]
    return tuple(ends), (v + dt * p.gravity * sum(np.cos(t + k * dt) for k in range(4)),) * 3


@random_law("After an impact a ball flies for the rest of the step.",
            "largest error of the height after an impact [m]", 1e-9)
def rests_of_a_step(lesson, rng):
    """Let a ball without gravity hit after three tenths of a step; it flies away for the other seven."""
    p, _, x, omega, dt = tilted_ball(lesson, rng)
    p = spinning(lesson, p._replace(gravity=np.zeros(3), point=x - 0.3 * dt * p.n), 0.0)
    there, _, _ = lesson.backtracking_spin_step(lesson.falling_acceleration, 0.0, x, -p.n, omega, dt, p)
    return (there - p.point) @ p.n, 0.7 * dt * p.e


@random_law("Two discs meet at the first root of their gap, or at once if they overlap.",
            "largest error of the time until two discs meet [s]", 1e-9)
def meetings(lesson, rng):
    """Let two discs in the plane meet, apart or overlapping at first."""
    places, speeds = rng.normal(size=(2, 2, 2))
    reach = rng.uniform(0.5, 1.5)
    d, u = places[0] - places[1], speeds[0] - speeds[1]
    roots = np.roots((u @ u, 2.0 * d @ u, d @ d - reach * reach))
    meets = 0.0 if d @ d < reach * reach else min(root.real for root in roots)
    meets = meets if d @ u < 0.0 and not np.any(roots.imag) else LONG
    return lesson.meeting_time(places, speeds, 0, 1, reach, LONG), min(meets, LONG)


@case("laws-of-an-impact", "Laws of an impact", compiled=False)
def laws_of_an_impact(lesson, check):
    """Check the laws of a surface, a spring, Coulomb's cone, and the time at which a gap closes."""
    check.laws(lesson, (reflections, springs, responses, normal_velocities, cones, pulls, sides, works, gaps,
                        closing_times, times_from_inside, times_of_all_bounces, slides, flights, distances, penalties,
                        steps_in_time, rests_of_a_step, meetings, tilted_steps), seed=78, times=TRIED)


# ---------------------------------------------------------------------------------------------- several points at once

CORNERS = np.array([[1.0, 0.0, -1.0], [-0.5, 0.8, -1.0], [-0.5, -0.8, -1.0]])  # under a body, from its centre [m]


class Landing(NamedTuple):
    """A body that hits with three points."""
    body: NamedTuple         # the lesson's BodyState3D
    r: np.ndarray            # (3, 3) its points [m]
    n: np.ndarray            # (3, 3) their normals
    e: float                 # restitution [-]
    mu: float                # friction [-]
    y: np.ndarray            # (6,) v and ω
    W: np.ndarray            # (6, 6) inverse masses
    G: np.ndarray            # (3, 6) rows of the normal velocities

    def energy(self, y):
        """Return ½ y · M y [J]."""
        return 0.5 * y @ np.linalg.solve(self.W, y)


def velocities(body):
    """Return (v, ω) of a body, (6,)."""
    return np.concatenate((body.v, body.omega))


def landing(lesson, rng):
    """Return a random Landing of a body that rotates slowly or fast."""
    r, n = CORNERS + rng.uniform(-0.2, 0.2, (3, 3)), np.array([0.3 * unit_vector(rng) for _ in range(3)])
    n[:, 2] += 1.0
    n /= np.linalg.norm(n, axis=1)[:, None]
    inv_mass, inv_inertia = random_body(rng)
    v, omega = np.array([*rng.normal(size=2), -3.0]), rng.choice((0.3, 3.0)) * rng.normal(size=3)
    body = lesson.BodyState3D(v, omega, inv_mass, inv_inertia)
    G = np.array([normal @ point_rows(arm) for normal, arm in zip(n, r)])
    return Landing(body, r, n, rng.uniform(0.1, 0.9), rng.uniform(0.2, 2.0), velocities(body),
                   inverse_matrix(1.0 / inv_mass, inv_inertia), G)


def third_leaves(one, speed):
    """Return the body of a Landing whose first two points approach with 2 m/s; the third leaves at `speed`."""
    y = np.linalg.pinv(one.G) @ (-2.0, -2.0, speed)
    return one.body._replace(v=y[:3], omega=y[3:])


def most_dissipative(lesson, body, r, n, e, mu):
    """Return (v, ω) after the impact that dissipates most."""
    after, _ = lesson.most_dissipative_impact(lesson.contact_matrix, lesson.cone_impulse, lesson.apply_impulse, body, r,
                                              n, e, mu)
    return velocities(after)


@random_law("Restitution requires −e u_n of the approaching points, and nothing of the others.",
            "speeds of separation: largest error [m/s]", 1e-12)
def speeds_of_separation(lesson, rng):
    one = landing(lesson, rng)
    return lesson.rebound_speeds(one.body, one.r, one.n, one.e), np.maximum(0.0, -one.e * one.G @ one.y)


@random_law("The impact of maximal dissipation moves no point into the other body.",
            "largest speed of approach after it [m/s]", 1e-4)
def approaches(lesson, rng):
    """Let the third point leave, so that the impact slows it."""
    one = landing(lesson, rng)
    slim = third_leaves(one, 0.1)._replace(inv_inertia=20.0 * one.body.inv_inertia)
    return np.minimum(0.0, one.G @ most_dissipative(lesson, slim, one.r, one.n, one.e, 0.2)), np.zeros(3)


@random_law("At one point J lies in Coulomb's cone, u in the dual cone, and J · u = 0.",
            "largest violation [J, N s, m/s]", 1e-9)
def pairs_of_cones(lesson, rng):
    """Check at one point that J and u⁺ are orthogonal, J in Coulomb's cone and u⁺ in the cone dual to it."""
    one = landing(lesson, rng)
    n, y = one.n[0], most_dissipative(lesson, one.body, one.r[:1], one.n[:1], 0.0, one.mu)
    J, u = np.linalg.solve(one.W, y - one.y)[:3], point_rows(one.r[0]) @ y
    outside = np.linalg.norm(along(J, n)) - one.mu * (J @ n)
    outside_the_dual = one.mu * np.linalg.norm(along(u, n)) * (J @ n > 0.0) - u @ n
    return np.array([J @ u, *np.maximum(0.0, (outside, outside_the_dual))]), np.zeros(3)


@random_law("Without friction the impulses solve the complementarity problem of all points together.",
            "velocities after the impact: largest error [m/s, rad/s]", 1e-9)
def frictionless_impacts(lesson, rng):
    """Let a body hit with three points, and then with two, while the third leaves: the sweeps must settle the two."""
    one, found, expected = landing(lesson, rng), [], []
    for body in (one.body, third_leaves(one, 20.0)):
        after, _ = lesson.solve_impacts(body, one.r, one.n, one.e, 0.0)
        u_n = one.G @ velocities(body)
        lam = enumerated(one.G @ one.W @ one.G.T, u_n - np.maximum(0.0, -one.e * u_n))
        found.append(velocities(after))
        expected.append(velocities(body) + one.W @ one.G.T @ lam)
    return np.array(found), np.array(expected)


@random_law("The impact of maximal dissipation loses 1 − e² of the energy that it loses with e = 0.",
            "share of the loss: largest error [-]", 1e-9)
def shares_of_the_loss(lesson, rng):
    """Let all points approach."""
    one = landing(lesson, rng)
    while np.any(one.G @ one.y >= 0.0):
        one = landing(lesson, rng)
    lost, least = (one.energy(one.y) - one.energy(most_dissipative(lesson, one.body, one.r, one.n, e, one.mu))
                   for e in (0.0, one.e))
    return least / lost, 1.0 - one.e**2


@random_law("Without friction, maximal dissipation takes 1 + e times the impulses that leave the least energy, or "
            "fewer: a point that leaves does not come back.",
            "a point that leaves: largest error of the velocities [m/s, rad/s]", 1e-5)
def slowed_points(lesson, rng):
    """Two points approach.  The third leaves with `most` times the speed that impulses of least energy take away."""
    slows = 0.0
    while slows < 0.05:
        one = landing(lesson, rng)
        A = one.G @ one.W @ one.G.T
        lam = np.append(enumerated(A[:2, :2], np.array([-2.0, -2.0])), 0.0)
        slows = -(A @ lam)[2]
    most = rng.choice((1.0 + 0.5 * one.e, 1.5 + one.e))
    body = third_leaves(one, most * slows)
    return (most_dissipative(lesson, body, one.r, one.n, one.e, 0.0),
            velocities(body) + min(most, 1.0 + one.e) * one.W @ one.G.T @ lam)


@random_law("A body that sticks with one point is held there against any push at the others.",
            "velocities of its points: largest error [m/s]", 1e-9)
def held_where_it_sticks(lesson, rng):
    """Push the other points, and then stop the one that sticks: K J = u_sep n − u."""
    one, modes = landing(lesson, rng), rng.permutation((impact_modes.STICKS, impact_modes.SLIDES, impact_modes.OPEN))
    impact = impact_modes.impact_of(lesson.contact_matrix, lesson.apply_impulse, one.body, one.r, one.n, one.e, one.mu)
    u, A, _, _ = impact_modes.held_points(impact, modes)
    J, s, y = rng.normal(size=(3, 3)), np.argmax(modes == impact_modes.STICKS), one.y
    J[s] = 0.0
    rows = [point_rows(arm) for arm in one.r]
    for k in range(3):
        y = y + one.W @ rows[k].T @ impact.frames[k].T @ J[k]
    u_sep = max(0.0, -one.e * one.G[s] @ one.y) * one.n[s]
    y = y + one.W @ rows[s].T @ np.linalg.solve(rows[s] @ one.W @ rows[s].T, u_sep - rows[s] @ y)
    return u + A @ J.ravel(), np.concatenate([impact.frames[k] @ rows[k] @ y for k in range(3)])


@random_law("A point that slides is pushed along what would stop its slip, across the normal.",
            "directions of pull: largest error of their cosine and sine [-]", 1e-9)
def directions_against_slip(lesson, rng):
    """Solve K J = −u for the velocity u across the normal at each point."""
    one = landing(lesson, rng)
    impact = impact_modes.impact_of(lesson.contact_matrix, lesson.apply_impulse, one.body, one.r, one.n, one.e, one.mu)
    angles, pulls = impact_modes.directions_of_pull(one.body, one.r, impact), []
    for arm, n, frame in zip(one.r, one.n, impact.frames, strict=True):
        rows = point_rows(arm)
        pull = frame[1:] @ np.linalg.solve(rows @ one.W @ rows.T, -along(rows @ one.y, n))
        pulls.append(pull / np.linalg.norm(pull))
    return np.stack((np.cos(angles), np.sin(angles)), axis=1), np.array(pulls)


@random_law("The first 500 starts of a search fill all directions evenly: cosines of sums of angles have the mean 0.",
            "starts: largest mean of cosines of sums of angles [-]", 0.05)
def starts_are_even(lesson, rng):
    """Add and subtract some of one to four angles."""
    signs = np.append(rng.choice((-1.0, 1.0)), rng.integers(-1, 2, rng.integers(0, 4)))
    rng.shuffle(signs)
    turns = np.array([impact_modes.start_of(number, len(signs)) for number in range(500)]) @ signs
    return (np.mean(np.cos(turns)), np.mean(np.sin(turns))), (0.0, 0.0)


def pushes_of_the_law(body, r, y, u_sep, mu):
    """Return the changes (6, k) of (v, ω) by which the points of a body that stands on z = 0 may push it, after y.

    A point pushes if it leaves with u_sep.  If it slides, it pushes along the rim of its cone, on the side of the
    impulse that would make it stick; if it sticks, anywhere in its cone.
    """
    n, W = np.array([0.0, 0.0, 1.0]), inverse_matrix(1.0 / body.inv_mass, body.inv_inertia)
    turns, changes = 2.0 * np.pi * np.arange(64) / 64, [np.zeros(6)]
    for arm, leaves in zip(r, u_sep, strict=True):
        rows = point_rows(arm)
        u = rows @ y
        if u @ n > leaves + 1e-8:
            continue
        pull = along(np.linalg.solve(rows @ W @ rows.T, leaves * n - u), n)
        slides = np.linalg.norm(along(u, n)) > 1e-8
        sides = [pull / np.linalg.norm(pull)] if slides else [(np.cos(turn), np.sin(turn), 0.0) for turn in turns]
        changes += [W @ rows.T @ (n + mu * np.array(side)) for side in sides]
    return np.array(changes).T


def hit_by_four(lesson, check):
    """Let a body hit z = 0, fast or slowly, with four points for which relaxed sweeps do not settle."""
    r = np.array([(-0.026, -0.26, -0.154), (-0.389, 0.058, -0.538), (0.679, 0.012, -0.378), (-0.481, 0.138, -0.053)])
    inv_inertia = np.array([(6.54, -0.701, -0.874), (-0.701, 7.485, -0.209), (-0.874, -0.209, 5.81)])
    v, omega, e, mu = np.array([0.984, 0.874, -1.64]), np.array([3.453, -4.485, 4.028]), 0.756, 0.3
    body, n = lesson.BodyState3D(v, omega, 1.0, inv_inertia), np.tile((0.0, 0.0, 1.0), (4, 1))
    errors = []
    for scale in (1.0, 1e-5):
        slow = body._replace(v=scale * v, omega=scale * omega)
        y = velocities(lesson.settle_impacts(lesson.contact_matrix, lesson.cone_impulse, lesson.apply_impulse, slow, r,
                                             n, e, mu)[0]) / scale
        rises = [np.array([point_rows(arm)[2] @ one for arm in r]) for one in (velocities(body), y)]
        u_sep = np.maximum(0.0, -e * rises[0])
        left = nnls(pushes_of_the_law(body, r, y, u_sep, mu), y - velocities(body))[1]
        errors.append(max(np.max(u_sep - rises[1]), left, 0.0))
    check.agree("Where sweeps do not settle, impulses that obey Coulomb's law are found by trying which points slide.",
                "a body that hits with four points: largest error of its velocities [m/s, rad/s]", np.max(errors), 1e-8)


@case("several-points", "Impacts at several points at once", compiled=False, in_quick=False)
def several_points(lesson, check):
    """Compare impacts at several points with a linear complementarity problem, 0 ≤ λ ⊥ A λ + n · u − u_sep ≥ 0.

    Without friction the impulses solve it.  The impact of maximal dissipation scales the impulses of e = 0 by 1 + e
    if all points approach: ½ m v² is then a parabola in that factor, and 1 − e² of the largest loss is lost.  Its
    gradient steps converge slowly if a body rotates easily: after 2,000 sweeps some 1e-6 of 2 m/s are left.
    """
    check.laws(lesson, (speeds_of_separation, approaches, pairs_of_cones, frictionless_impacts, shares_of_the_loss,
                        held_where_it_sticks, slowed_points, directions_against_slip, starts_are_even), seed=79,
               times=4)
    hit_by_four(lesson, check)


# ---------------------------------------------------------------------------------------------- why?

@case("elastic-rest", "How long an elastic ball bounces by projections", compiled=False)
def elastic_rest(lesson, check):
    """Throw an elastic ball up from the floor and count its steps until it lies still.

    A ball that leaves the floor at w = (m + f) g dt lands after 2 m steps if 0 < f < ½, and after 2 m + 1 if f > ½: the
    next w are (m − f) g dt, and (m − 1 + f) g dt after it.  So w falls by ½ g dt per flight.  All steps are
    2 w²/(g dt)² + O(w/(g dt)): the relative error is below 4 over the number of flights.
    """
    worst, flights = 0.0, 60.5
    for dt in (0.004, 0.01):
        h = (0.5 * flights * G * dt) ** 2 / (2.0 * G)
        x, v, steps, p = np.zeros(2), np.array([0.0, 0.5 * flights * G * dt]), 0, ball(lesson, 1.0)
        while steps == 0 or ((x[1] != 0.0 or v[1] > 2.0 * G * dt) and steps < 10 * flights**2):
            x, v = lesson.position_projection_step(lesson.falling_acceleration, 0.0, x, v, dt, p)
            steps += 1
        worst = np.maximum(worst, abs(lesson.elastic_rest_time(h, G, dt) / (steps * dt) - 1.0))
    check.agree("An elastic ball lies still after the predicted time.", "time to rest: relative error [-]", worst,
                4.0 / flights)


@case("stored-slip", "An impact that returns its slip", compiled=False)
def stored_slip(lesson, check):
    """Compare the energy of a ball before and after random impacts by my_impulse, from its velocity and its spin."""
    rng, worst = np.random.default_rng(20), -np.inf
    for _ in range(500):
        m, R, v, omega = rng.uniform(0.1, 2.0), rng.uniform(0.02, 0.3), rng.normal(size=3), rng.normal(size=3)
        r, inertia = -R * UP, 0.4 * m * R * R
        u = v + np.cross(omega, r)
        if u @ UP < 0.0:
            J = lesson.my_impulse(u, UP, lesson.contact_matrix(r, 1.0 / m, np.eye(3) / inertia))
            v_new, omega_new = v + J / m, omega + np.cross(r, J) / inertia
            before, after = (0.5 * m * a @ a + 0.5 * inertia * b @ b for a, b in ((v, omega), (v_new, omega_new)))
            worst = np.maximum(worst, after / before - 1.0)
    check.agree("Returned slip brings no energy.", "gain of energy over the energy: largest [-]",
                np.maximum(0.0, worst), ROUND_OFF)
