"""Impulses at their limits: the functions of lesson 7 compared with theory.

Edges are found by bisection of runs or of impacts, never from a formula.
*Source:* Painlevé 1895 for the rod; each case derives the rest.
"""

import numpy as np
from scipy.optimize import minimize_scalar

from solutions.checks import Diverged
from validate.reference.contact import enumerated
from validate.reference.impulses import COPIES
from validate.stability.case import DOTS, EDGE, LINE, Picture, Worst, agreement, bisect, case, finding, refuses, series

G = 9.81                     # [m/s²]
ROUND_OFF = 1e-12            # of numbers below 30 after a few hundred operations, each rounded by 1.1e-16 of its result
UP = np.array([0.0, 1.0, 0.0])
ACROSS = np.array([1.0, 0.0, 0.0])
STEEPEST = np.degrees(np.arctan(2.0))  # the angle at which Painlevé's paradox needs the least friction [°]


# ---------------------------------------------------------------------------------------------- a rod on its tip

def rod(lesson, degrees):
    """Return K (3, 3) of the lower tip of a uniform rod of 2 m and 1 kg that leans at that angle from the floor.

    y is up, and the rod turns about z.  With c, s the cosine and sine:  K = (1 + 3s², −3sc; −3sc, 1 + 3c²) in x and y.
    """
    theta = np.radians(degrees)
    return lesson.contact_matrix(np.array([-np.cos(theta), -np.sin(theta), 0.0]), 1.0, np.diag([0.0, 3.0, 3.0]))


def against_the_first_slip(K, mu, side):
    """Return n · K d [1/kg] for friction against the slip before the impact; that rule's impulse is divided by it."""
    return UP @ (K @ (UP + mu * side * ACROSS))


def edge_of_the_common_rule(lesson):
    """Find the least friction for which friction against the first slip has no solution."""
    near = [rod(lesson, a) for a in (STEEPEST - 1.0, STEEPEST, STEEPEST + 1.0)]
    edge = bisect(lambda mu: min(against_the_first_slip(K, mu, 1.0) for K in near) <= 0.0, 0.1, 10.0)
    return [finding(
        claim="Friction against the first slip has no solution for a leaning rod from μ = 4/3 on.",
        quantity="least friction without a solution, rod of slope 2 [-]",
        predicted=4.0 / 3.0,
        measured=edge,
        tolerance=2.0 * EDGE,
        observation=f"At tan θ = 2 the impulse of that rule has a zero denominator at μ = {edge:.5f}.",
    )]


def impacts_of_all_rods(lesson):
    """Let rods of every slope, friction and slip hit the floor, and judge the worst of these impacts."""
    finite = tried = 0
    gained = wrong = size = 0.0
    for mu in (1.34, 2.0, 10.0, np.inf):
        for degrees in np.linspace(1.0, 89.0, 45):
            K = rod(lesson, degrees)
            for slip in (-3.0, -0.3, 0.0, 0.3, 3.0):
                u = slip * ACROSS - UP
                J = lesson.contact_impulse(u, UP, K, 0.0, mu)
                tried, finite = tried + 1, finite + bool(np.all(np.isfinite(J)))
                gained, wrong = max(gained, lesson.energy_change(u, K, J)), max(wrong, abs(UP @ (u + K @ J)))
                ends = max(np.linalg.norm(np.linalg.solve(K, u)), 1.0 / K[1, 1])
                size = max(size, np.linalg.norm(J) / ends)
    return [
        finding(
            claim="Every impact of every rod ends with a finite impulse.",
            quantity=f"finite impulses [of {tried}]",
            predicted=tried,
            measured=finite,
            tolerance=0.0,
            observation=f"{finite} of {tried} impacts at μ from 1.34 to ∞ end in a finite impulse.",
        ),
        finding(
            claim="No impact with e = 0 gains energy.",
            quantity="largest gain of energy [J]",
            predicted=0.0,
            measured=max(0.0, gained),
            tolerance=ROUND_OFF,
            observation=f"The largest gain of an impact is {max(0.0, gained):.0e} J, of about 5 J.",
        ),
        finding(
            claim="The tip stays on the floor.",
            quantity="largest normal velocity after the impact [m/s]",
            predicted=0.0,
            measured=wrong,
            tolerance=ROUND_OFF,
            observation=f"After the impact the normal velocity of the tip is at most {wrong:.0e} m/s.",
        ),
        finding(
            claim="No impulse exceeds the larger of the frictionless one and the sticking one.",
            quantity="largest impulse over that, or 1 [-]",
            predicted=1.0,
            measured=max(1.0, size),
            tolerance=ROUND_OFF,
            observation=f"The largest impulse is {size:.3f} of that bound.",
        ),
    ]


@case("painleve-rod", "Painlevé's rod", compiled=False)
def painleve_rod(lesson):
    """A rod slides on its tip over a rough floor: friction against the slip drives the tip into the floor.

    With d = n + μ t,  n · K d = 1 + 3c² − 3μ sc.  It is zero first at tan θ = 2, for μ = 4/3.  From there on a rule
    that fixes friction against the first slip divides by zero, or pulls.  cone_impulse puts friction in the
    direction of a sticking impulse.  All J that end the normal motion that way lie on a line from the frictionless
    impulse to the sticking one.  Energy is convex along it, and neither of its ends gains any with e = 0.
    """
    found = edge_of_the_common_rule(lesson) + impacts_of_all_rods(lesson)
    fine = np.linspace(2.0, 88.0, 173)
    naive = np.array([1.0 / against_the_first_slip(rod(lesson, a), 2.0, 1.0) for a in fine])
    flat, steep = (fine < STEEPEST) & (0.0 < naive) & (naive < 4.0), (fine > STEEPEST) & (0.0 < naive) & (naive < 4.0)
    ours = [lesson.contact_impulse(-3.0 * ACROSS - UP, UP, rod(lesson, a), 0.0, 2.0)[1] for a in fine]
    return found, Picture(
        "A rod pushed over a rough floor, μ = 2",
        "angle from the floor [°]",
        "normal impulse over m v [-]",
        [
            series("friction against the first slip, flatter rods", fine[flat], naive[flat], LINE),
            series("friction against the first slip, steeper rods", fine[steep], naive[steep], LINE),
            series("cone_impulse", fine[::6], ours[::6], DOTS),
        ],
        ("Between 37° and 79° the common rule has no solution: its impulse would be infinite, or a pull. The cone's "
         "impulse stays finite."),
    )


# ---------------------------------------------------------------------------------------------- deep overlap

RADIUS, SHORT = 0.5, 0.01    # of the bodies that overlap [m]; a step [s]
OMEGA, TINY = 1000.0, 1e-6   # of the penalty spring [1/s]; the step that resolves it [s]


def ball_over_floor(lesson):
    """Return a ball with e = 0.5 whose penalty spring has ω = 1000/s."""
    return lesson.BouncingBall(0.5, np.array([0.0, -G]), np.zeros(2), np.array([0.0, 1.0]), 1e6, 0.0)


def ball_is_placed_on_its_floor(lesson):
    """Take one projecting step of a ball at rest inside its floor."""
    depth = 0.25 * RADIUS
    x, v = lesson.position_projection_step(lesson.falling_acceleration, 0.0, np.array([0.0, -depth]), np.zeros(2),
                                           SHORT, ball_over_floor(lesson))
    return [
        finding(
            claim="A ball inside the floor is placed on it.",
            quantity="height after one step [m]",
            predicted=0.0,
            measured=x[1],
            tolerance=ROUND_OFF,
            observation=f"A ball {depth} m deep is at {x[1]:g} m after one step.",
        ),
        finding(
            claim="The correction does the work m g times the depth, and no more.",
            quantity="energy gained [J/kg]",
            predicted=G * depth + 0.5 * (0.5 * G * SHORT) ** 2,
            measured=G * (x[1] + depth) + 0.5 * v @ v,
            tolerance=ROUND_OFF,
            observation=(f"The correction has given it {G * (x[1] + depth) + 0.5 * v @ v:.5f} J/kg; g times the depth "
                         f"is {G * depth:.5f}."),
        ),
        finding(
            claim="It gains no speed from the correction: its speed e g dt comes from the fall of that step.",
            quantity="speed after one step [m/s]",
            predicted=0.5 * G * SHORT,
            measured=np.hypot(*v),
            tolerance=ROUND_OFF,
            observation=f"It leaves with {np.hypot(*v):.4f} m/s, which is e g dt.",
        ),
    ]


def speeds_of_ejection(lesson, depths):
    """Return the speeds [m/s] with which the penalty method ejects a ball at rest from these depths [m]."""
    p, speeds = ball_over_floor(lesson), []
    for d in depths:
        x, v, here = np.array([[0.0, -d]]), np.zeros((1, 2)), 0
        while x[0, 1] < 0.0 and here < 1000:
            x, v = lesson.advance_balls(lesson.penalty_step, lesson.falling_acceleration, 0.0, x, v, TINY, 20, p)
            here += 1
        speeds.append(v[0, 1])
    return np.array(speeds)


def overlapping_discs_come_apart(lesson):
    """Let five discs in a row, each a quarter inside the next, be moved apart."""
    discs = lesson.Discs(np.full(5, RADIUS), np.array([1.0, 0.5, 1.0, 2.0, 1.0]), 0.8)
    row = np.stack((0.75 * 2.0 * RADIUS * np.arange(5.0), np.zeros(5)), axis=1)
    apart, still = lesson.advance_discs(lesson.position_projection_discs_step, row[None], np.zeros((1, 5, 2)), SHORT,
                                        400, discs)
    middle = [(1.0 / discs.inv_mass) @ places / np.sum(1.0 / discs.inv_mass) for places in (row, apart[0])]
    overlap = max(0.0, (2.0 * RADIUS - np.diff(apart[0, :, 0])).max())
    return [
        finding(
            claim="Five discs in a row, each a quarter inside the next, come apart.",
            quantity="largest overlap after 400 steps [m]",
            predicted=0.0,
            measured=overlap,
            tolerance=ROUND_OFF,
            observation=f"After 400 steps the largest overlap is {overlap:.0e} m.",
        ),
        finding(
            claim="Not one of them moves then.",
            quantity="largest speed [m/s]",
            predicted=0.0,
            measured=np.abs(still).max(),
            tolerance=0.0,
            observation=f"The fastest of them has {np.abs(still).max():g} m/s.",
        ),
        finding(
            claim="And their centre of mass stays where it was.",
            quantity="way of the centre of mass [m]",
            predicted=0.0,
            measured=np.linalg.norm(middle[1] - middle[0]),
            tolerance=ROUND_OFF,
            observation=f"Their centre of mass has moved by {np.linalg.norm(middle[1] - middle[0]):.0e} m.",
        ),
    ]


def discs_on_one_point_come_apart(lesson):
    """Take one step of two discs without a normal between them."""
    same = np.zeros((1, 2, 2))
    x, _ = lesson.advance_discs(
        lesson.position_projection_discs_step, same, same, SHORT, 1, lesson.Discs(np.full(2, RADIUS), np.ones(2), 0.8)
    )
    return [finding(
        claim="Two discs on one point have no normal between them, and still come apart.",
        quantity="distance after one step [m]",
        predicted=2.0 * RADIUS,
        measured=np.linalg.norm(x[0, 0] - x[0, 1]),
        tolerance=ROUND_OFF,
        observation=f"Two discs on one point are {np.linalg.norm(x[0, 0] - x[0, 1]):g} m apart after one step.",
    )]


@case("deep-overlap", "Deep overlap", compiled=False)
def deep_overlap(lesson):
    """Overlapping bodies are moved apart without gaining speed: the correction does the work m g d and no more.

    A ball at rest at a depth d inside its floor is on the floor after one projecting step, with v = e g dt from the
    fall of that step.  The penalty method stores ½ k d² in its spring instead, and ejects the ball with √(ω² d² − 2
    g d).
    """
    depths = np.linspace(0.05, 0.5, 6) * RADIUS
    speeds, law = speeds_of_ejection(lesson, depths), np.sqrt(OMEGA**2 * depths**2 - 2.0 * G * depths)
    found = ball_is_placed_on_its_floor(lesson)
    found.append(finding(
        claim="The penalty method ejects the same ball, because its spring starts compressed.",
        quantity=f"speed after ejection from a depth of {depths[2]:g} m at ω = 1000/s [m/s]",
        predicted=law[2],
        measured=speeds[2],
        tolerance=law[2] * OMEGA * TINY + G * 20.0 * TINY,
        observation=f"From {depths[2]:g} m the penalty method ejects a ball at rest with {speeds[2]:.1f} m/s.",
    ))
    found += overlapping_discs_come_apart(lesson) + discs_on_one_point_come_apart(lesson)
    return found, Picture(
        "A ball released inside its floor",
        "depth [m]",
        "speed with which it leaves [m/s]",
        [
            series("penalty, theory", depths, law, LINE),
            series("penalty, measured", depths, speeds, DOTS),
            series("projecting: e g dt", depths, np.full(len(depths), 0.5 * G * SHORT), LINE),
        ],
        "A spring that starts compressed ejects the ball; a projection stores no energy.",
    )


# ---------------------------------------------------------------------------------------------- Zeno, and far away

def bouncing(lesson, e, T, steps, place=(0.0, 0.0), copies=1):
    """Return (x, v) of copies released at 1 m over a plane at `place`, each a little earlier than the one before."""
    p = lesson.BouncingBall(e, np.array([0.0, -G]), np.array(place), np.array([0.0, 1.0]), 1.0, 0.0)
    before = 0.01 * np.arange(copies)
    x = np.stack((np.zeros(copies), 1.0 - 0.5 * G * before**2), axis=1) + p.point
    v = np.stack((0.5 * np.ones(copies), -G * before), axis=1)
    return lesson.advance_balls(lesson.backtracking_step, lesson.falling_acceleration, 0.0, x, v, T / steps, steps, p)


@case("zeno-and-far-away", "Zeno's bounce, and far from the origin", compiled=False)
def zeno_and_far_away(lesson):
    """Infinitely many bounces end after √(2h/g) (1 + e)/(1 − e), and far from the origin only floats are coarser.

    At 10⁵ m a position is rounded to half a spacing, twice per step, so N steps add up to an error of N spacings in
    the height at which a ball meets its plane.  A height wrong by δ changes the speed by g δ/v and the time by δ/v
    at an impact with v.  One flight later both have grown by at most (1 + 2/e).  Three impacts make less than
    (1 + 2/e)³ = 43 of it.
    """
    found, es = [], (0.3, 0.5, 0.8, 0.9, 0.95)
    stops = []
    for e in es:
        end = np.sqrt(2.0 / G) * (1.0 + e) / (1.0 - e)
        stops.append(bisect(lambda T, e=e: bouncing(lesson, e, T, 1)[1][0, 1] == 0.0, 0.5, 2.0 * end))
        if e in (0.5, 0.8, 0.95):
            found.append(finding(
                claim="A ball stops bouncing after √(2h/g) (1 + e)/(1 − e).",
                quantity=f"time to the stop for e = {e:g} [s]",
                predicted=end,
                measured=stops[-1],
                tolerance=EDGE * end,
                observation=f"With e = {e:g} a ball dropped from 1 m is at rest from {stops[-1]:.5f} s on.",
            ))
    x, v = bouncing(lesson, 0.8, 5.0, 500)
    found.append(finding(
        claim="The stepped run reaches the same rest, on the plane to the last digit.",
        quantity="height and speed after 5 s in 500 steps [m, m/s]",
        predicted=0.0,
        measured=np.hypot(x[0, 1], v[0, 1]),
        tolerance=ROUND_OFF,
        observation=f"After 500 steps it lies at {x[0, 1]:.0e} m with {v[0, 1]:g} m/s.",
    ))
    steps, near = 190, bouncing(lesson, 0.8, 1.9, 190, copies=COPIES)
    errors, far = [], 10.0 ** np.arange(2, 9)
    for distance in far:
        place = distance * np.array([1.0, -0.8])
        x, v = bouncing(lesson, 0.8, 1.9, steps, place, COPIES)
        errors.append(np.sqrt(np.mean((x - place - near[0]) ** 2)))
    bound = 43.0 * steps * np.spacing(1e5)
    found.append(finding(
        claim="10⁵ m away the error is that of the floats there, summed over the steps.",
        quantity="error of the position at (10⁵, −8·10⁴) m after 190 steps [m]",
        predicted=0.0,
        measured=errors[3],
        tolerance=bound,
        observation=(f"At (10⁵, −8·10⁴) m the position is off by {errors[3]:.1e} m; floats are {np.spacing(1e5):.1e} "
                     "m apart there."),
    ))
    slope = np.polyfit(np.log10(far), np.log10(errors), 1)[0]
    found.append(finding(
        claim="The error grows in proportion to the distance, as the spacing of floats does.",
        quantity="order of its growth from 10² to 10⁸ m [-]",
        predicted=1.0,
        measured=slope,
        tolerance=0.15,
        observation=f"From 10² to 10⁸ m the error grows with the power {slope:.3f} of the distance.",
    ))
    return found, Picture(
        "Far from the origin",
        "log₁₀ of the distance [m]",
        "log₁₀ of the error [m]",
        [
            series("spacing of floats", np.log10(far), np.log10(np.spacing(far)), LINE),
            series("the bound of 190 steps", np.log10(far), np.log10(43.0 * steps * np.spacing(far)), LINE),
            series("measured", np.log10(far), np.log10(errors), DOTS),
        ],
        "The spacing of floats explains the whole error, which follows it over six decades.",
    )


# ---------------------------------------------------------------------------------------------- the penalty's price

def swings_up(lesson, h_omega, zeta, steps=500):
    """Return whether a ball at rest on its penalty spring, disturbed by 10⁻⁹ of its depth, reaches 10⁻³ of it."""
    omega = 100.0
    sag = G / omega**2
    p = lesson.BouncingBall(0.5, np.array([0.0, -G]), np.zeros(2), np.array([0.0, 1.0]), omega**2, 2.0 * zeta * omega)
    x, v = np.array([[0.0, -sag * (1.0 + 1e-9)]]), np.zeros((1, 2))
    try:
        x, v = lesson.advance_balls(lesson.penalty_step, lesson.falling_acceleration, 0.0, x, v, h_omega / omega, steps,
                                    p)
    except Diverged:
        return True
    return max(abs(x[0, 1] + sag), abs(v[0, 1]) / omega) > 1e-3 * sag


@case("penalty-stability", "The price of a penalty", compiled=False)
def penalty_stability(lesson):
    """The penalty's spring is stable for ω dt < 2(√(1 + ζ²) − ζ), and a ball at rest compresses it by m g/k = g/ω².

    Just beyond, at ω dt (1 + ε), an undamped oscillation grows by √(8ε) per step.  500 steps amplify it by 10⁶ from
    ε = 9.5e-5 on, so the edge is found that much late.  With a damper the growth is at least 2ε per step, and 2,000
    steps find the edge at ε = ln 10⁶/4000 = 3.5e-3 at most.
    """
    found, zetas = [], (0.0, 0.1, 0.3, 0.6, 1.0)
    unbounded = lambda y, zeta: swings_up(lesson, y, zeta, 500 if zeta == 0.0 else 2000)
    edges = [bisect(lambda y, zeta=zeta: unbounded(y, zeta), 0.2, 3.0) for zeta in zetas]
    law = lambda zeta: 2.0 * (np.sqrt(1.0 + zeta**2) - zeta)
    for zeta, edge in zip(zetas, edges):
        late = (np.log(1e6) / 500.0) ** 2 / 8.0 if zeta == 0.0 else np.log(1e6) / 4000.0
        found.append(finding(
            claim="A penalty spring needs steps shorter than 2(√(1 + ζ²) − ζ)/ω.",
            quantity=f"largest ω dt that stays bounded, ζ = {zeta:g} [-]",
            predicted=law(zeta),
            measured=edge,
            tolerance=law(zeta) * (late + EDGE),
            observation=(f"At ζ = {zeta:g} the oscillation of a ball on its penalty spring grows from ω dt = "
                         f"{edge:.4f} on."),
        ))
    depths = []
    for omega in (30.0, 100.0, 300.0):
        p = lesson.BouncingBall(0.5, np.array([0.0, -G]), np.zeros(2), np.array([0.0, 1.0]), omega**2, 2.0 * omega)
        still, dt = np.zeros((1, 2)), 0.1 / omega
        x, _ = lesson.advance_balls(lesson.penalty_step, lesson.falling_acceleration, 0.0, still, still, dt, 1000, p)
        depths.append(-x[0, 1])
        found.append(finding(
            claim="A body at rest on a penalty spring sinks in by m g/k.",
            quantity=f"depth at rest, ω = {omega:g}/s [m]",
            predicted=G / omega**2,
            measured=depths[-1],
            tolerance=ROUND_OFF,
            observation=(f"At ω = {omega:g}/s a resting ball is {1e3 * depths[-1]:.3f} mm deep; steps must stay below "
                         f"{2e3 / omega:.1f} ms."),
        ))
    fine = np.linspace(0.0, 1.0, 101)
    return found, Picture(
        "Penalty: the longest step",
        "damping ratio ζ [-]",
        "ω dt [-]",
        [series("theory", fine, law(fine), LINE), series("measured", zetas, edges, DOTS)],
        "A floor twice as stiff needs steps 1.4 times as short, and a damper shortens them further.",
    )


# ---------------------------------------------------------------------------------------------- energy out of nothing

def most_gained(lesson, K, e):
    """Return the largest energy gain [J] of a sticking impact with u_n = −1 m/s and e, over all slips."""
    def lost(slip):
        u = slip * ACROSS - UP
        return -lesson.energy_change(u, K, lesson.contact_impulse(u, UP, K, e, np.inf))
    return -minimize_scalar(lost, bounds=(-5.0, 5.0), method="bounded", options={"xatol": 1e-9}).fun


def least_gaining(K):
    """Return the restitution above which an impact can gain energy:  e* = 1/√(K_nn (K⁻¹)_nn)."""
    return 1.0 / np.sqrt(K[1, 1] * np.linalg.inv(K)[1, 1])


@case("energy-gain", "Energy out of nothing", compiled=False)
def energy_gain(lesson):
    """Newton's restitution with friction gains energy if e > 1/√(K_nn (K⁻¹)_nn), at the wrong slip.

    For the rod that is 2/√((1 + 3c²)(1 + 3s²)).  A sticking J gives ½ (e² u_n² n · K⁻¹n − u · K⁻¹u).  The gain is
    largest where u · K⁻¹u is least for its u_n, at u_n²/K_nn.  Energy is a convex function on the line from the
    frictionless impulse to the sticking one, so no sliding impact gains unless one of the two does.
    """
    found, angles = [], (10.0, 20.0, 30.0, 45.0, 60.0, 75.0)
    edges = [bisect(lambda e, a=a: most_gained(lesson, rod(lesson, a), e) > 0.0, 0.3, 1.0) for a in angles]
    law = lambda a: 2.0 / np.sqrt((1.0 + 3.0 * np.cos(np.radians(a)) ** 2) * (1.0 + 3.0 * np.sin(np.radians(a)) ** 2))
    for a, edge in zip(angles, edges):
        if a in (30.0, 45.0, 75.0):
            found.append(finding(
                claim="A leaning rod can gain energy from e = 2/√((1 + 3cos²θ)(1 + 3sin²θ)) on.",
                quantity=f"least restitution that gains, rod at {a:g}° [-]",
                predicted=law(a),
                measured=edge,
                tolerance=10.0 * EDGE,
                observation=f"A rod at {a:g}° gains energy at some slip from e = {edge:.5f} on.",
            ))
    rng = np.random.default_rng(18)
    broken = gained = dead = 0
    for _ in range(1500):
        r, moments = rng.uniform(-1.0, 1.0, 3), rng.uniform(0.2, 2.0, 3)
        K, u = lesson.contact_matrix(r, 1.0, np.diag(1.0 / moments)), rng.normal(size=3)
        u[1], e, mu = -abs(u[1]) - 0.01, rng.uniform(), rng.uniform(0.0, 2.0)
        more = lesson.energy_change(u, K, lesson.contact_impulse(u, UP, K, e, mu)) > ROUND_OFF
        gained += more
        broken += more and e < least_gaining(K)
        dead += lesson.energy_change(u, K, lesson.contact_impulse(u, UP, K, 0.0, mu)) > ROUND_OFF
    found += [
        finding(
            claim="Below that restitution no impact gains, sliding or sticking, in the plane or in space.",
            quantity="impacts that gain energy below it [of 1500]",
            predicted=0,
            measured=broken,
            tolerance=0.0,
            observation=f"Of 1,500 random impacts {gained} gain energy, {broken} of them below the bound.",
        ),
        finding(
            claim="Without restitution none gains.",
            quantity="impacts with e = 0 that gain energy [of 1500]",
            predicted=0,
            measured=dead,
            tolerance=0.0,
            observation=f"With e = 0 {dead} of 1,500 impacts gain energy.",
        ),
    ]
    K, worst = rod(lesson, 45.0), 0.0
    for e in (0.0, 0.5, 1.0):
        u = 2.0 * ACROSS - UP
        gained = lesson.energy_change(u, K, lesson.contact_impulse(u, UP, K, e, 0.0))
        worst = np.maximum(worst, abs(gained + 0.5 * (1.0 - e * e) / K[1, 1]))
    found.append(finding(
        claim="Without friction an impact loses ½ (1 − e²) u_n²/k.",
        quantity="largest difference for e = 0, ½, 1 [J]",
        predicted=0.0,
        measured=worst,
        tolerance=ROUND_OFF,
        observation=f"Frictionless impacts lose what theory gives, to {worst:.0e} J.",
    ))
    fine = np.linspace(0.0, 90.0, 181)
    return found, Picture(
        "When restitution with friction gains energy",
        "angle of the rod from the floor [°]",
        "restitution e [-]",
        [series("theory: it may gain above", fine, law(fine), LINE), series("measured", angles, edges, DOTS)],
        ("At 45° a sticking impact can gain energy from e = 0.8 on, at one particular slip; upright or flat it never "
         "does."),
    )


# ---------------------------------------------------------------------------------------------- what has no physics

@case("invalid-impacts", "Impacts that have no physics", compiled=False)
def invalid_impacts(lesson):
    """Impossible impacts are refused by name and value; extreme but valid ones are solved."""
    u, n, K, zero = np.array([1.0, -2.0, 0.5]), UP, np.eye(3), np.zeros(3)
    body, r = lesson.BodyState3D(u, zero, 1.0, np.eye(3)), np.zeros((1, 3))
    drop = lesson.BouncingBall(0.5, np.array([0.0, -G]), np.zeros(2), np.array([0.0, 1.0]), 1.0, 0.0)
    fall = (lesson.falling_acceleration, 0.0, np.ones((1, 2)), np.zeros((1, 2)), 0.1, 1)
    pair, discs = np.zeros((1, 2, 2)), lesson.Discs(np.ones(2), np.ones(2), -1.0)
    asked = (
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
    refused = sum(refuses(getattr(lesson, name), arguments, value) for name, arguments, value in asked)
    found = [finding(
        claim=("Restitution outside 0 to 1, negative friction, a missing normal, two immovable bodies and NaN are "
               "refused, and the message gives the value."),
        quantity=f"calls whose error names the value [of {len(asked)}]",
        predicted=len(asked),
        measured=refused,
        tolerance=0.0,
        observation=f"{refused} of {len(asked)} such calls end in a message that names the value.",
    )]
    exponents, worst = np.linspace(-6.0, 8.0, 15), 0.0
    sizes = []
    for y in exponents:
        J = lesson.contact_impulse(10.0**y * u, n, K, 0.5, 0.3)
        sizes.append(np.linalg.norm(J) / 10.0**y)
        worst = np.maximum(worst, abs(n @ (10.0**y * u + K @ J) - 10.0**y) / 10.0**y)
    found.append(finding(
        claim="An impact has no characteristic speed: the same law holds from a micrometre to 10⁸ m per second.",
        quantity="largest error of the rebound, over the speed [-]",
        predicted=0.0,
        measured=worst,
        tolerance=ROUND_OFF,
        observation=f"Over fourteen decades of speed the rebound is right to {worst:.0e}.",
    ))
    J = lesson.contact_impulse(u, n, np.diag([1e6, 1.0, 1e-6]) + 1e-7 * np.ones((3, 3)), 0.5, np.inf)
    found.append(finding(
        claim="Infinite friction gives a finite impulse for any inertias.",
        quantity="rebound with μ = ∞ and inertias over twelve decades [m/s]",
        predicted=1.0,
        measured=n @ (u + (np.diag([1e6, 1.0, 1e-6]) + 1e-7 * np.ones((3, 3))) @ J),
        tolerance=1e-9,
        observation="With μ = ∞ and inertias over twelve decades the impact has the expected rebound.",
    ))
    return found, Picture(
        "The same impact at any speed",
        "log₁₀ of the speed [m/s]",
        "impulse over m v [-]",
        [
            series("theory", exponents, np.full(15, 3.0 * np.hypot(1.0, 0.3)), LINE),
            series("contact_impulse", exponents, sizes, DOTS),
        ],
        "Coulomb's cone and Newton's restitution contain no length and no time.",
    )


def planar_rows(x_a, x_b, p, n):
    """Return the row (6,) of n · (velocity of a's point − velocity of b's): derivatives of positions by hand."""
    r_a, r_b = p - x_a, p - x_b
    return np.array([n[0], n[1], -n[0] * r_a[1] + n[1] * r_a[0], -n[0], -n[1], n[0] * r_b[1] - n[1] * r_b[0]])


# of (v_a, ω_a, v_b, ω_b) what cannot change: nothing, an axle, the floor, a body that does not turn, and likewise for a
HELD = ((), (3, 4), (3, 4, 5), (5,), (0, 1), (2, 3, 4, 5))


@case("two-bodies", "An impact of two free bodies, in the plane and in space", compiled=False)
def two_bodies(lesson):
    """K = G M⁻¹ Gᵀ with the rows G of the contact's velocity; momentum and angular momentum about the origin are kept.

    In space a body's block of M is its inertia tensor in the world, and its part of G is n and r × n.
    What is held has a 0 in M⁻¹: a body on an axle moves as little as the floor, but turns.
    """
    rng = np.random.default_rng(77)
    worst = Worst()
    for trial in range(120):
        x_a, x_b, p, v_a, v_b = rng.normal(size=(5, 2))
        (w_a, w_b), masses, e = rng.normal(size=2), rng.uniform(0.5, 2.0, 4), rng.uniform(0.1, 0.9)
        n = np.array([np.cos(turn := rng.uniform(0.0, 6.28)), np.sin(turn)])
        speed, held = 10.0 ** rng.uniform(-4.0, 0.0), HELD[trial % len(HELD)]
        v_a, v_b, w_a, w_b = speed * v_a, speed * v_b, speed * w_a, speed * w_b
        inverse = 1.0 / masses[[0, 0, 1, 2, 2, 3]]
        inverse[list(held)] = 0.0
        a = lesson.BodyState2D(v_a, w_a, inverse[0], inverse[2])
        b = lesson.BodyState2D(v_b, w_b, inverse[3], inverse[5])
        row, across = planar_rows(x_a, x_b, p, n), planar_rows(x_a, x_b, p, np.array([-n[1], n[0]]))
        state = np.concatenate((v_a, [w_a], v_b, [w_b]))
        u = lesson.relative_velocity_2d(a, b, p - x_a, p - x_b)
        truth = row @ state * n + across @ state * np.array([-n[1], n[0]])
        worst.keep("u", np.max(np.abs(u - truth)))
        k_n = lesson.effective_inverse_mass_2d(a, b, p - x_a, p - x_b, n)
        worst.keep("k_n", abs(k_n - row @ (inverse * row)) / k_n)
        if (u_n := u @ n) > 0.0:
            n, u_n, row = -n, -u_n, -row
        J = lesson.impulse_size(u_n, k_n, e) * n
        a_new, b_new = lesson.apply_impulse_2d(a, p - x_a, J), lesson.apply_impulse_2d(b, p - x_b, -J)
        after = np.concatenate((a_new.v, [a_new.omega], b_new.v, [b_new.omega]))
        worst.keep("rebound", abs(row @ after + e * u_n) / speed)
        change = (after - state) / speed
        worst.keep("held", np.max(np.abs(change + (1.0 + e) * u_n / speed / k_n * inverse * row)))
        if not held:
            P = masses[0] * change[:2] + masses[2] * change[3:5]
            spin = masses[1] * change[2] + masses[3] * change[5]
            spin += masses[0] * (x_a[0] * change[1] - x_a[1] * change[0])
            spin += masses[2] * (x_b[0] * change[4] - x_b[1] * change[3])
            worst.keep("momentum", np.max(np.abs(P)))
            worst.keep("spin", abs(spin))

        r_a, r_b, n3, L_a, L_b, J3 = rng.normal(size=(6, 3))
        n3 /= np.linalg.norm(n3)
        factors = rng.normal(size=(2, 3, 3))
        I_a, I_b = (f @ f.T + np.eye(3) for f in factors)
        turns = [np.linalg.inv(I) for I in (I_a, I_b)]
        v, omega = rng.normal(size=(2, 2, 3))
        bodies = [lesson.BodyState3D(v[k], omega[k], inverse[3 * k], turns[k] * (inverse[3 * k + 2] > 0.0))
                  for k in range(2)]
        W = np.zeros((12, 12))
        for k, block in enumerate((bodies[0].inv_mass * np.eye(3), bodies[0].inv_inertia,
                                   bodies[1].inv_mass * np.eye(3), bodies[1].inv_inertia)):
            W[3 * k:3 * k + 3, 3 * k:3 * k + 3] = block
        G = np.concatenate((n3, np.cross(r_a, n3), -n3, -np.cross(r_b, n3)))
        truth = G @ W @ G
        got = lesson.effective_inverse_mass(*bodies, r_a, r_b, n3)
        worst.keep("space", abs(got - truth) / truth)
        rows = np.concatenate([sign * np.concatenate((np.eye(3), np.cross(r, np.eye(3))), axis=1)
                               for r, sign in ((r_a, 1.0), (r_b, -1.0))], axis=1)    # u along x, y and z
        state = np.concatenate((v[0], omega[0], v[1], omega[1]))
        worst.note("u in space", lesson.relative_velocity(*bodies, r_a, r_b), rows @ state)
        pushed = [lesson.apply_impulse(*one) for one in ((bodies[0], r_a, J3), (bodies[1], r_b, -J3))]
        after = np.concatenate([part for body in pushed for part in (body.v, body.omega)])
        worst.note("pushed", after, state + W @ rows.T @ J3)
        # both bodies touch at one point, so that J and −J have no torque together about the origin
        p3 = rng.normal(size=3)
        new_a, new_b = lesson.angular_momenta(L_a, L_b, r_a, r_b, J3)
        orbital = np.cross(p3 - r_a, J3) - np.cross(p3 - r_b, J3)
        own = np.concatenate((new_a - L_a - np.cross(r_a, J3), new_a + new_b - L_a - L_b + orbital))
        worst.keep("momenta", np.max(np.abs(own)))
    names = (
        ("u", "Two points approach with the velocities of centres and rotations.", "relative velocity [m/s]"),
        ("k_n", "In the plane k_n is G M⁻¹ Gᵀ.", "k_n, relative [-]"),
        ("rebound", "They separate with −e u_n, however slowly they have come.",
         "velocity after the impact, relative [-]"),
        ("held", "What is held keeps its velocity, and all else changes by M⁻¹ Gᵀ j.",
         "change of velocity, relative [-]"),
        ("momentum", "An impact keeps the momentum.", "momentum, relative [kg]"),
        ("spin", "An impact keeps the angular momentum about the origin.", "angular momentum, relative [kg m]"),
        ("space", "In space k_n is G M⁻¹ Gᵀ, too.", "k_n in space, relative [-]"),
        ("u in space", "In space two points approach with u = G v.", "relative velocity in space [m/s]"),
        ("pushed", "In space an impulse changes velocities by M⁻¹ Gᵀ J.", "velocities in space [m/s, rad/s]"),
        ("momenta", "L changes by r × J, and the angular momentum of both stays.", "momenta in space [kg m²/s]"))
    return [agreement(claim, f"largest error of the {quantity}", worst[name], 1e-12)
            for name, claim, quantity in names], None


# ---------------------------------------------------------------------------------------------- each law by itself

TRIED = 50                   # random impacts [-]
FLIGHTS = 400                # summed up [-]: 0.9⁴⁰⁰ is below round-off
CORNERS = np.array([[1.0, 0.0, -1.0], [-0.5, 0.8, -1.0], [-0.5, -0.8, -1.0]])  # under a body, from its centre [m]


def unit_vector(rng, d):
    """Return a random unit vector (d,)."""
    y = rng.normal(size=d)
    return y / np.linalg.norm(y)


def mobility(r, m, I):
    """Return K = 1/m − r* I⁻¹ r*, with the matrix of r × from numpy's products."""
    star = np.cross(np.eye(3), r)
    return np.eye(3) / m + star @ np.linalg.solve(I, star.T)


@case("laws-of-an-impact", "Each law of an impact by itself", compiled=False)
def laws_of_an_impact(lesson):
    """What a surface does to a point, a spring to a ball, Coulomb's cone to a slip, and when a gap closes."""
    rng = np.random.default_rng(78)
    worst = Worst()
    for _ in range(TRIED):
        # a point on a surface: the normal velocity is −e times the old one, or as it was, however slow
        n, along, across = np.linalg.qr(rng.normal(size=(3, 3)))[0]
        (v_n, *v_t), e = rng.normal(size=3) * [10.0 ** rng.uniform(-3.0, 0.0), 1.0, 1.0], rng.uniform()
        slides = v_t[0] * along + v_t[1] * across
        truth = slides + (v_n if v_n > 0.0 else -e * v_n) * n
        worst.note("mirror", lesson.kinematic_response(slides + v_n * n, n, e), truth)
        k, d, deep = rng.uniform(0.5, 2.0, 3)
        part = -k * deep / d                                    # the damper alone would pull as strongly as the spring
        pushes = [lesson.penalty_force(phi, v_n, k, d) for phi, v_n in (
            (-deep, 0.0), (-deep, part), (-deep, -0.5 * part), (-deep, -2.0 * part), (deep, part), (0.0, part))]
        truth = np.array([1.0, 2.0, 0.5, 0.0, 0.0, 0.0]) * k * deep
        worst.keep("spring", np.max(np.abs(pushes - truth)) / (k * deep))

        # a rough impact: at the limit of sticking, a little inside the cone and a little outside
        n, r, m, factor = unit_vector(rng, 3), rng.normal(size=3), rng.uniform(0.5, 2.0), rng.normal(size=(3, 3))
        I = factor @ factor.T + 0.5 * np.eye(3)
        K, u = mobility(r, m, I), rng.normal(size=3)
        worst.keep("matrix", np.max(np.abs(lesson.contact_matrix(r, 1.0 / m, np.linalg.inv(I)) - K)))
        u, u_sep = u - (u @ n + rng.uniform(0.5, 1.5)) * n, rng.uniform(0.0, 0.5)
        stick = np.linalg.solve(K, u_sep * n - u)
        along = stick - (stick @ n) * n
        needs = np.linalg.norm(along) / (stick @ n)             # friction that sticking needs
        for mu in (0.95 * needs, 1.05 * needs) if stick @ n > 0.0 else ():
            J = lesson.cone_impulse(u, n, K, u_sep, mu)
            J_t, after = J - (J @ n) * n, u + K @ J
            worst.keep("normal", abs(after @ n - u_sep))
            lost = abs(np.linalg.norm(J_t) - mu * (J @ n)) if mu < needs else np.linalg.norm(after - u_sep * n)
            worst.keep("cone", lost)
            side = J_t / np.linalg.norm(J_t) - along / np.linalg.norm(along)
            worst.keep("side", np.linalg.norm(side))
        t = K @ n - (n @ K @ n) * n                             # so fast a slip this way that sticking would pull
        lean = 3.0 * (n @ K @ n) / (t @ t)
        for mu in np.array([0.95, 1.05]) * lean * np.linalg.norm(t):
            J = lesson.cone_impulse(u_sep * n - K @ (lean * t - n), n, K, u_sep, mu)
            J_n = (2.0 * (n @ K @ n)) / (n @ K @ n + mu * np.linalg.norm(t))
            worst.note("pulls", J / (J_n * (1.0 + mu)), (n + mu * t / np.linalg.norm(t)) / (1.0 + mu))
        J = rng.normal(size=3)
        v_b, w_b = u - np.cross(omega := rng.normal(size=3), r), omega
        v_a, w_a = v_b + J / m, w_b + np.linalg.solve(I, np.cross(r, J))
        gain = 0.5 * (m * (v_a @ v_a - v_b @ v_b) + w_a @ I @ w_a - w_b @ I @ w_b)
        worst.keep("work", abs(lesson.energy_change(u, K, J) - gain) / (1.0 + abs(gain)))

        # a gap in a step: it stays open by itself, or closes exactly; and when it closes under an acceleration
        phi, k_n, dt = rng.uniform(0.1, 1.0, 3)
        for u_n in (-0.5 * phi / dt, -2.0 * phi / dt):
            left = phi + dt * (u_n + k_n * lesson.gap_multiplier(phi, u_n, k_n, dt))
            worst.keep("gap", abs(left - max(0.0, phi + dt * u_n)))
        v_n, a_n, long = rng.normal(), rng.normal(), 10.0
        roots = np.roots((0.5 * a_n, v_n, phi))
        ahead = [root.real for root in roots if root.imag == 0.0 and 0.0 < root.real < long]
        worst.keep("time", abs(lesson.impact_time(phi, v_n, a_n, long) - min(ahead, default=long)))
        speed, pull = abs(v_n), abs(a_n)                        # from inside: at once, when it comes back, or never
        times = [lesson.impact_time(-phi, *way, long) for way in ((-speed, a_n), (speed, -pull), (speed, pull))]
        worst.note("inside", np.array(times), np.array([0.0, min(2.0 * speed / pull, long), long]))
        bounces = [lesson.bouncing_time(*way, 0.9 * e) for way in ((speed, -pull), (speed, pull), (-speed, -pull))]
        truth = np.array([np.sum((0.9 * e) ** np.arange(FLIGHTS)), np.inf, 0.0])
        worst.note("bounces", np.array(bounces) * pull / (2.0 * speed), truth)

        # a ball on its plane: gravity into it slides the ball, gravity away from it lifts it off
        n, x, v, a = unit_vector(rng, 3), *rng.normal(size=(3, 3))
        pushed = a - min(0.0, a @ n) * n
        truth = np.array([x + dt * (v - (v @ n) * n) + 0.5 * dt * dt * pushed, v - (v @ n) * n + dt * pushed])
        worst.note("slide", lesson.slide_on_plane(x, v, a, dt, n), truth)
        truth = np.array([x + dt * v + 0.5 * dt * dt * a, v + dt * a])
        worst.note("fall", lesson.free_flight(x, v, a, dt), truth)

        # one step over a tilted plane, in coordinates along its normal and along itself
        axes = np.linalg.qr(rng.normal(size=(3, 3)))[0].T
        p = lesson.BouncingBall(e, rng.normal(size=3), rng.normal(size=3), axes[0], 1.0, 0.0)
        place, speeds = rng.normal(size=3) * [0.1, 1.0, 1.0], axes @ (v + dt * p.gravity)
        x = p.point + axes.T @ place
        worst.note("distance", lesson.gap(x, p), place[0])
        place = place + dt * speeds
        if place[0] < 0.0:
            place[0], speeds[0] = 0.0, max(speeds[0], -e * speeds[0])
        soft, deep = p._replace(stiffness=30.0, damping=2.0), p.point - rng.uniform(0.1, 0.5) * axes[0]
        push = max(0.0, 30.0 * (axes[0] @ (p.point - deep)) - 2.0 * (axes[0] @ v))
        _, pushed = lesson.penalty_step(lesson.falling_acceleration, 0.0, deep, v, dt, soft)
        worst.note("pushed", pushed, v + dt * (p.gravity + push * axes[0]))
        worst.note("tilted", lesson.position_projection_step(lesson.falling_acceleration, 0.0, x, v, dt, p),
                   np.array([p.point + axes.T @ place, axes.T @ speeds]))

        # loops far above a plane: each step has the acceleration of its time
        t, high = rng.uniform(0.0, 6.0), p._replace(point=p.point - 1e3 * axes[0])
        swings = lambda t, x, v, p: np.cos(t) * p.gravity
        truth = v + dt * p.gravity * sum(np.cos(t + k * dt) for k in range(4))
        _, end = lesson.advance_balls(lesson.position_projection_step, swings, t, x[None], v[None], dt, 4, high)
        worst.note("times", end[0], truth)
        ball = lesson.SpinningBall(e, 0.3, 1.0 / m, np.eye(3), 0.1, high.gravity, high.point, high.n)
        for step in (lesson.position_projection_spin_step, lesson.backtracking_spin_step):
            _, end, _ = lesson.advance_spinning_balls(step, swings, t, x[None], v[None], r[None], dt, 4, ball)
            worst.note("times", end[0], truth)
        # an impact in the middle of a step of a ball: what is left of the step it flies away, and slips no more
        smooth = ball._replace(mu=0.0, gravity=np.zeros(3), point=x - 0.3 * dt * axes[0])
        there, _, _ = lesson.backtracking_spin_step(lesson.falling_acceleration, t, x, -axes[0], r, dt, smooth)
        worst.note("left", (there - smooth.point) @ axes[0], 0.7 * dt * e)

        # two discs in the plane: in each other they meet now if they approach, else at the first root
        places, speeds, reach = rng.normal(size=(2, 2)), rng.normal(size=(2, 2)), rng.uniform(0.5, 1.5)
        (d, u) = places[0] - places[1], speeds[0] - speeds[1]
        roots = np.roots((u @ u, 2.0 * d @ u, d @ d - reach * reach))
        meets = 0.0 if d @ d < reach * reach else min(root.real for root in roots)
        meets = meets if d @ u < 0.0 and not np.any(roots.imag) else long
        worst.note("meets", lesson.meeting_time(places, speeds, 0, 1, reach, long), min(meets, long))
    names = (
        ("mirror", "A surface reverses what comes, times e, and leaves alone what goes, however slowly.",
         "velocity [m/s]"),
        ("spring", "A penalty spring with its damper pushes while it is compressed, and never pulls.",
         "force, relative [-]"),
        ("matrix", "K = 1/m − r* I⁻¹ r*.", "K [1/kg]"),
        ("normal", "A rough impact ends with the normal velocity that restitution asks for.", "normal velocity [m/s]"),
        ("cone", "5 % inside the cone it sticks, 5 % outside it is on the rim.", "law of Coulomb [N s, m/s]"),
        ("pulls", "Where sticking would pull, the impulse is on the rim, whatever μ is.", "impulse, relative [-]"),
        ("side", "Friction is on the side of the sticking impulse.", "direction of friction [-]"),
        ("work", "The gain of energy is that of ½m v² and ½ω·Iω.", "gain, relative [-]"),
        ("gap", "A gap closes exactly in its step, or stays open without an impulse.", "gap after the step [m]"),
        ("time", "A gap closes at the first root of its parabola.", "time [s]"),
        ("inside", "What is inside touches: it closes at once, when it comes back, or never.", "time from inside [s]"),
        ("bounces", "All bounces last as long as the sum of their flights.", "time of all bounces, relative [-]"),
        ("slide", "A plane pushes and never pulls: what lifts a ball lifts it off.", "state after sliding [m, m/s]"),
        ("fall", "A flight is a parabola.", "state after a flight [m, m/s]"),
        ("distance", "A gap is the distance along the normal, however the plane is tilted.",
         "gap over a tilted plane [m]"),
        ("pushed", "A penalty pushes along the normal, with its damper on the normal velocity.",
         "velocity after a step with a penalty [m/s]"),
        ("times", "Each step of a loop takes the acceleration of its own time.", "velocity after four steps [m/s]"),
        ("left", "After an impact a ball flies for what is left of the step.", "height after an impact [m]"),
        ("meets", "Two discs meet at the first root of their distance, or now.", "time until two discs meet [s]"),
        ("tilted", "A ball that ends inside is moved out along the normal, also if it leaves already.",
         "state after a step over a tilted plane [m, m/s]"))
    return [agreement(claim, f"largest error of the {quantity}", worst[name], 1e-9)
            for name, claim, quantity in names], None


@case("several-points", "Several points hit at once", compiled=False)
def several_points(lesson):
    """Without friction the impulses solve a linear complementarity problem; 0 ≤ λ ⊥ A λ + n · u − u_sep ≥ 0.

    The impact that dissipates most scales the impulses of e = 0 by 1 + e where all points come in: ½ m v² is then a
    parabola in that factor, and 1 − e² of the largest loss is lost.  Its gradient steps converge slowly where a body
    turns easily: after 2,000 sweeps some 1e-6 of 2 m/s are left.
    """
    rng, law, share, inside, alone, before_it = np.random.default_rng(79), 0.0, 0.0, 0.0, 0.0, 0.0
    answers = lesson.contact_matrix, lesson.cone_impulse, lesson.apply_impulse
    for trial in range(6):
        r = CORNERS + rng.uniform(-0.2, 0.2, (3, 3))
        n = np.array([unit_vector(rng, 3) for _ in r]) * 0.3 + [0.0, 0.0, 1.0]
        n /= np.linalg.norm(n, axis=1)[:, None]
        m, factor, e = rng.uniform(0.5, 2.0), rng.normal(size=(3, 3)), rng.uniform(0.1, 0.9)
        I = factor @ factor.T + 0.5 * np.eye(3)
        v, omega = np.array([*rng.normal(size=2), -3.0]), (0.3, 3.0)[trial % 2] * rng.normal(size=3)
        body = lesson.BodyState3D(v, omega, 1.0 / m, np.linalg.inv(I))
        G = np.concatenate((n, np.cross(r, n)), axis=1)
        M = np.zeros((6, 6))
        M[:3, :3], M[3:, 3:] = m * np.eye(3), I
        y = np.concatenate((v, omega))
        u_n = G @ y
        lam = enumerated(G @ np.linalg.solve(M, G.T), u_n - np.maximum(0.0, -e * u_n))
        truth = y + np.linalg.solve(M, G.T @ lam)
        after, _ = lesson.solve_impacts(body, r, n, e, 0.0)
        law = np.maximum(law, np.max(np.abs(np.concatenate((after.v, after.omega)) - truth)))

        before_it = max(before_it, np.max(np.abs(lesson.rebound_speeds(body, r, n, e) - np.maximum(0.0, -e * u_n))))
        leaves = np.linalg.pinv(G) @ (-2.0, -2.0, 0.1)           # the third point leaves, and the impact slows it
        slim = lesson.BodyState3D(leaves[:3], leaves[3:], 1.0 / m, 20.0 * np.linalg.inv(I))
        end, _ = lesson.most_dissipative_impact(*answers, slim, r, n, e, 0.2)
        inside = max(inside, np.max(-G @ np.concatenate((end.v, end.omega))))
        # of one point: J and u⁺ are at right angles, J in Coulomb's cone and u⁺ in the cone dual to it
        mu = rng.uniform(0.2, 2.0)
        end, _ = lesson.most_dissipative_impact(*answers, body, r[:1], n[:1], 0.0, mu)
        J, u = m * (end.v - v), end.v + np.cross(end.omega, r[0])
        J_n, after_n = J @ n[0], u @ n[0]
        alone = max(alone, abs(J @ u), np.linalg.norm(J - J_n * n[0]) - mu * J_n,
                    mu * np.linalg.norm(u - after_n * n[0]) - after_n if J_n > 0.0 else -after_n)

        if np.all(u_n < 0.0):
            mu, before = rng.uniform(0.2, 2.0), 0.5 * (m * v @ v + omega @ I @ omega)
            lost = []
            for restitution in (0.0, e):
                end, _ = lesson.most_dissipative_impact(*answers, body, r, n, restitution, mu)
                lost.append(before - 0.5 * (m * end.v @ end.v + end.omega @ I @ end.omega))
            share = np.maximum(share, abs(lost[1] / lost[0] - (1.0 - e * e)))
    return [agreement("Restitution asks for −e u_n of the points that come in, and for nothing of the others.",
                      "speeds of separation: largest error [m/s]", before_it, 1e-12),
            agreement("The impact that dissipates most moves no point into the other body.",
                      "largest speed of approach after it [m/s]", max(0.0, inside), 1e-4),
            agreement("At one point it is the pair of cones: J in Coulomb's, u in the dual one, J · u = 0.",
                      "largest violation [J, N s, m/s]", max(0.0, alone), 1e-9),
            agreement("Without friction the impulses solve the complementarity problem of all points together.",
                      "velocities after the impact: largest error [m/s, rad/s]", law, 1e-9),
            agreement("The impact that dissipates most loses 1 − e² of what it loses with e = 0.",
                      "share of the loss: largest error [-]", share, 1e-9)], None
