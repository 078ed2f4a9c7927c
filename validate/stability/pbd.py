"""Softness of constraints that should not stretch, and the cost of sweeps and steps: lesson 8 compared with theory.

Most bodies hang straight down or move in a circle.  A sweep is then a linear map with a known closed form.
*Source:* Müller et al. 2006, Macklin et al. 2016 and 2019; each case derives the other numbers.
"""

import itertools

import numpy as np
from scipy.spatial.transform import Rotation

from solutions import integrators
from solutions.checks import Diverged
from solutions.pbd import ConstraintNetwork
from validate.reference.pbd import pendulum_period
from validate.stability.case import DOTS, LINE, Picture, Worst, case, log_series, random_law, refuses, relative, series

G = 9.81                     # [m/s²]
MILLIMETRES = 1e3            # millimetres per metre
ROUND_OFF = 1e-12            # of positions around 1 m after a thousand visits to a link [m]
SETTLED = 1e-10              # a run ends at this distance to rest [m]


def network(masses, stiffness=1.0, alpha=0.0, sweeps=1, g=G):
    """Return a hanging chain: masses [kg] from top to bottom under a fixed point, links of 1 m."""
    n = len(masses)
    return ConstraintNetwork(np.array([0.0, *(1.0 / m for m in masses)]), np.array([0.0, -g]), np.arange(n),
                             np.arange(1, n + 1), np.ones(n), np.full(n, stiffness), np.full(n, alpha), sweeps)


def straight(n):
    """Return the points (n + 1, 2) of such a chain, unstretched."""
    return np.stack((np.zeros(n + 1), -np.arange(n + 1.0)), axis=1)


def settle(lesson, step, p, dt, steps):
    """Return the positions of a chain after this number of steps from rest, or NaN if the run diverges."""
    x = straight(len(p.rest))
    try:
        return integrators.advance(getattr(lesson, step), lesson.network_gravity, 0.0, x, 0.0 * x, dt, steps, p)[0]
    except Diverged:
        return np.full_like(x, np.nan)


def stretch(x):
    """Return the excess length of each link of a chain [m]."""
    return -np.diff(x[:, 1]) - 1.0


def sag(lesson, step, p, dt, steps):
    """Return the distance [m] by which the end of a chain is too low after this number of steps from rest."""
    return stretch(settle(lesson, step, p, dt, steps)).sum()


def millimetres(law, found, within):
    """Return three lengths [m] as the arguments law, found and within of a check, in millimetres."""
    return {"law": MILLIMETRES * law, "found": MILLIMETRES * found, "within": MILLIMETRES * within}


def sweeps_of(n):
    """Return a number of sweeps in words."""
    return f"{n} {'sweep' if n == 1 else 'sweeps'}"


# ---------------------------------------------------------------------------------------------- softness

SOFT_STEPS = 300             # of a weight on a soft link, until it is at rest


@case("stiffness-depends-on-dt", "Softness of PBD and its step", compiled=False)
def stiffness_depends_on_dt(lesson, check):
    """Check that PBD's softness depends on dt: a weight sags by g dt² S/(1 − S), S = (1 − s)ⁿ.

    A step lowers the weight by g dt², and n sweeps leave a fraction S of the error; at rest  S (sag + g dt²) =
    sag.  The recursion y ← S (2y − y_before + g dt²) has roots |z|² = S, so a run converges by √S per step.  300
    steps leave √0.75³⁰⁰ < 1e-18.
    """
    for s, n, dt in ((0.5, 1, 1.0 / 60.0), (0.5, 1, 1.0 / 120.0), (0.5, 3, 1.0 / 60.0), (0.25, 1, 1.0 / 60.0)):
        S = (1.0 - s) ** n
        bound = G * dt * dt * S / (1.0 - S)
        name = f"stiffness {s}, {sweeps_of(n)}, dt = 1/{round(1 / dt)} s"
        got = sag(lesson, "pbd_step", network([1.0], s, 0.0, n), dt, SOFT_STEPS)
        check("PBD's stiffness depends on the step and on the sweeps: a weight sags by g dt² S/(1 − S), S = (1 − s)ⁿ.",
              f"sag, {name} [mm]", **millimetres(bound, got, ROUND_OFF),
              saw=f"With {name} a weight sags by {MILLIMETRES * got:.4f} mm.")
        formula = lesson.pbd_sag(G, dt, s, n)
        check("The lesson's formula gives the same sag.", f"pbd_sag, {name} [mm]",
              **millimetres(bound, formula, ROUND_OFF), saw=f"pbd_sag returns {MILLIMETRES * formula:.4f} mm.")
    heavy = sag(lesson, "pbd_step", network([1000.0], 0.5), 1.0 / 60.0, SOFT_STEPS)
    check("The sag does not depend on the mass, so the link is not a spring.", "sag of a thousand times the mass [mm]",
          **millimetres(G / 3600.0, heavy, ROUND_OFF),
          saw=f"A weight of one tonne sags by {MILLIMETRES * heavy:.4f} mm as well.")
    return Picture(
        "A link that PBD leaves soft", "log₁₀ of dt [s]", "log₁₀ of the sag [mm]",
        soft_link(lesson, 1) + soft_link(lesson, 3),
        "Half the step gives a quarter of the sag: a stiffness of 0.5 has no meaning without the step.")


def soft_link(lesson, n):
    """Return the curves of the sag under n sweeps over the step."""
    fine = np.geomspace(1.0 / 500.0, 1.0 / 20.0, 40)
    dots = np.array([1.0 / 480.0, 1.0 / 240.0, 1.0 / 120.0, 1.0 / 60.0, 1.0 / 30.0])
    sags = [sag(lesson, "pbd_step", network([1.0], 0.5, 0.0, n), dt, SOFT_STEPS) for dt in dots]
    return [log_series(f"{sweeps_of(n)}, theory", fine, MILLIMETRES * (G * fine**2 * 0.5**n / (1.0 - 0.5**n)), LINE),
            log_series(f"{sweeps_of(n)}, measured", dots, MILLIMETRES * np.array(sags), DOTS)]


def chain_of_springs(lesson, check, N=8, alpha=1e-4):
    """Compare the sag of a chain of N springs of 1/α under XPBD with theory, for several sweeps and two steps.

    The rest position does not depend on the velocity that is lost on the way, so each step begins with a tenth of it.
    """
    weights = np.ones(N)
    for sweeps, per_second in ((1, 60), (5, 60), (20, 60), (1, 240)):
        x, dt = straight(N), 1.0 / per_second
        p, v = network(weights, 1.0, alpha, sweeps), 0.0 * x
        for _ in range(10 * per_second):
            x, v = lesson.xpbd_step(lesson.network_gravity, 0.0, x, 0.9 * v, dt, p)
        got = stretch(x).sum()
        check("A chain is as soft as its compliance only when the sweeps have converged; before that it is "
              "softer, by the amount that the theory of Gauss–Seidel iteration gives.",
              f"{N} springs, {sweeps_of(sweeps)} of 1/{per_second} s: sag [mm]",
              **millimetres(left_over(weights, sweeps, dt, alpha).sum(), got, SETTLED),
              saw=f"The end hangs {MILLIMETRES * got:.2f} mm too low; springs would sag by "
                  f"{MILLIMETRES * alpha * G * 0.5 * N * (N + 1):.2f} mm.")


def oscillation(lesson, dt, m, k, steps):
    """Return the stretch (steps + 1,) [m] of a spring by implicit Euler and by XPBD; it begins with 1 m/s downwards."""
    rest, omega = m * G / k, np.sqrt(k / m)
    M = np.array([[1.0, dt], [-dt * omega**2, 1.0]]) / (1.0 + (dt * omega) ** 2)
    x, v, p = straight(1), np.array([[0.0, 0.0], [0.0, -1.0]]), network([m], 1.0, 1.0 / k, 3)
    state, theory, run = np.array([-rest, 1.0]), [0.0], [0.0]
    for _ in range(steps):
        x, v = lesson.xpbd_step(lesson.network_gravity, 0.0, x, v, dt, p)
        state = M @ state
        theory.append(state[0] + rest)
        run.append(stretch(x)[0])
    return np.array(theory), np.array(run)


@case("compliance", "Compliance of XPBD", compiled=False)
def compliance(lesson, check):
    """Check that one spring under XPBD is implicit Euler, and sags by m g/k for any step and any number of sweeps.

    With (s, v) relative to rest and h = dt, implicit Euler is  (s, v) ← ((1, h), (−hω², 1))/(1 + h²ω²).  It decays by
    (1 + h²ω²)^(−1/2) per step.  With hω = 1, 80 steps leave 2⁻⁴⁰ = 1e-12 of the sag, whose 10 cm give SETTLED.

    A chain of springs is as soft as its compliance only when the sweeps have converged: see left_over.
    """
    chain_of_springs(lesson, check)
    m = 2.0
    for dt, n in itertools.product((1.0 / 30.0, 1.0 / 60.0, 1.0 / 240.0), (1, 7)):
        k = m / dt**2
        got = sag(lesson, "xpbd_step", network([m], 1.0, 1.0 / k, n), dt, 80)
        check("A single spring sags by m g/k for any step and any number of sweeps.",
              f"sag, {n} sweeps of dt = 1/{round(1 / dt)} s, k = {k:.0f} N/m [mm]",
              law=MILLIMETRES * m * G / k, found=MILLIMETRES * got, within=MILLIMETRES * SETTLED,
              saw=f"A spring of {k:.0f} N/m under {m:g} kg sags by {MILLIMETRES * got:.5f} mm.")
    drawn, steps = [], 60
    for dt in (0.02, 0.1):
        theory, run = oscillation(lesson, dt, m, 100.0, steps)
        off = np.abs(run - theory).max()
        check("With one linear spring XPBD is implicit Euler.",
              f"largest difference from implicit Euler in {steps} steps of {dt:g} s [m]",
              law=0.0, found=off, within=ROUND_OFF,
              saw=f"In {steps} steps of {dt:g} s a weight on a spring stays within {off:.0e} m of implicit Euler.")
        ts = dt * np.arange(steps + 1)
        drawn += [series(f"implicit Euler, dt = {dt:g} s", ts, MILLIMETRES * theory, LINE),
                  series(f"XPBD, dt = {dt:g} s", ts, MILLIMETRES * run, DOTS)]
    return Picture(
        "A spring under XPBD", "t [s]", "stretch [mm]", drawn,
        "Every step finds the same rest position. How fast the oscillation decays depends on dt, as with implicit "
        "Euler.")


def left_over(masses, sweeps, dt, alpha=0.0):
    """Return the exact stretch [m] of each link of a chain at rest under PBD or XPBD, left by n Gauss–Seidel sweeps.

    Each step falls by g dt², which Λ* (the weight below, times dt²) would remove.  n sweeps solve B Λ = b up to Gⁿ,
    with B = A + α/dt², A = J W Jᵀ, G = 1 − L⁻¹B and B's lower triangle L.  At rest Λ = (1 − Gⁿ) B⁻¹ b equals Λ*,
    and the sweeps leave  b − AΛ* = B (1 − Gⁿ)⁻¹ Gⁿ Λ* + α/dt² Λ*,  of which the last part is Hooke's law.
    """
    n, w = len(masses), 1.0 / np.array(masses, dtype=float)
    A = np.diag(w + np.append(0.0, w[:-1])) - np.diag(w[:-1], 1) - np.diag(w[:-1], -1)
    B = A + alpha / dt**2 * np.eye(n)
    power = np.linalg.matrix_power(np.eye(n) - np.linalg.solve(np.tril(B), B), sweeps)
    load = G * dt * dt * np.cumsum(masses[::-1])[::-1]
    return B @ np.linalg.solve(np.eye(n) - power, power @ load) + alpha / dt**2 * load


def patience(n, sweeps):
    """Return the number of steps after which a chain of n equal weights is at rest to 1e-12 of its initial stretch.

    E ← Gⁿ (2E − E_before)  has roots |z|² = ρ(G)ⁿ.  For this matrix ρ(G) of Gauss–Seidel is the square of Jacobi's,
    cos²(π/(2N + 1)).
    """
    return int(np.ceil(np.log(1e-12) / (sweeps * np.log(np.cos(np.pi / (2.0 * n + 1.0)))))) + 10


# ---------------------------------------------------------------------------------------------- sweeps and steps

LINKS, FRAME = 8, 1.0 / 60.0             # of a chain of equal weights; time of a frame [s]
EQUAL = [1.0] * LINKS


def rest_of_chain(lesson, step, sweeps, dt):
    """Return the stretch (LINKS,) [m] of such a chain at rest."""
    return stretch(settle(lesson, step, network(EQUAL, sweeps=sweeps), dt, patience(LINKS, sweeps)))


@case("unconverged-iterations", "Softness from too few sweeps", compiled=False)
def unconverged_iterations(lesson, check):
    """Compare the stretch of a chain of N weights after too few sweeps with theory.

    After one sweep link k is too long by (N − k) g dt².  The last visit to link k + 1 has moved point k down by the
    error of that link: the weights below k times dt²/m.  In total the end is ½N(N − 1) g dt² too low; n sweeps
    leave less (left_over).  `patience` is the number of steps to rest.
    """
    N, dt = LINKS, FRAME
    for sweeps in (1, 5, 20):
        got = rest_of_chain(lesson, "pbd_step", sweeps, dt)
        check("With too few sweeps a chain is soft, by the amount that the theory of Gauss–Seidel iteration gives.",
              f"{N} links, {sweeps_of(sweeps)} of 1/60 s: end too low by [mm]",
              **millimetres(left_over(EQUAL, sweeps, dt).sum(), got.sum(), SETTLED),
              saw=f"With {sweeps_of(sweeps)} a chain of {N} m hangs {MILLIMETRES * got.sum():.3f} mm too low.")
        if sweeps == 1:
            worst = np.abs(got - G * dt * dt * (N - 1.0 - np.arange(N))).max()
            check("After a single sweep link k is too long by (N − k) g dt².",
                  "largest departure from (N − k) g dt² [mm]", **millimetres(0.0, worst, SETTLED),
                  saw=f"The links are too long by (N − k) g dt², to within {MILLIMETRES * worst:.0e} mm.")
    fine, dots = np.arange(1, 61), (1, 2, 5, 10, 20)
    bounds = [MILLIMETRES * left_over(EQUAL, n, dt).sum() for n in fine]
    low = [MILLIMETRES * rest_of_chain(lesson, "pbd_step", n, dt).sum() for n in dots]
    return Picture(
        "Sweeps and softness", "log₁₀ of the sweeps", "log₁₀ of how much too low [mm]",
        [log_series("theory", fine, bounds, LINE), log_series("PBD, measured", dots, low, DOTS)],
        "The effect of the fixed end travels slowly down the chain. At first twice the sweeps give half the "
        "softness, and a stiff chain needs hundreds.")


def errors_of_sweeps(lesson, r):
    """Return the errors [m] of the upper link before the first sweep and after each; the lower link starts too long.

    The first sweep makes the upper link wrong.  There are at least six sweeps, and more until a thousandth of the
    error is left if that takes only hundreds.
    """
    p, x, errors = network([1.0, r]), straight(2), []
    x[2, 1] -= 0.01
    while len(errors) < 7 or (abs(errors[-1]) > 1e-3 * abs(errors[1]) and r <= 100.0):
        errors.append(stretch(x)[0])
        x = lesson.distance_sweep(x, p)
    return errors


@case("mass-ratio", "Mass ratio of a chain", compiled=False)
def mass_ratio(lesson, check):
    """Check that with M hanging under m, r = M/m, each sweep leaves r/(1 + r) of the error.

    A visit to the upper link moves m by its whole error c, which makes the lower link wrong by c.  The visit to the
    lower link gives the fraction w_m/(w_m + w_M) = r/(1 + r) back to m, and that is the new error of the upper link.

    c is known to 1e-15 of 1 m and begins at 0.01 m.  Over five sweeps the ratio is known to 1e-11 if r ≥ 1.
    """
    ratios, measured = (1.0, 10.0, 100.0, 1e4), []
    for r in ratios:
        errors = errors_of_sweeps(lesson, r)
        contraction, sweeps = (errors[6] / errors[1]) ** 0.2, len(errors) - 1
        measured.append(contraction)
        check("With a heavy weight under a light one each sweep leaves r/(1 + r) of the error.",
              f"share of the error that a sweep leaves at a mass ratio of {r:g} [-]",
              law=r / (1.0 + r), found=contraction, within=1e-11,
              saw=f"At a mass ratio of {r:g} a sweep leaves {contraction:.6f} of the error.")
        if r <= 100.0:
            check("A reduction to a thousandth takes about 6.9 (r + ½) sweeps after the first, which makes the "
                  "upper link wrong.", f"sweeps to a thousandth of the error at a mass ratio of {r:g} [-]",
                  law=1.0 + np.ceil(np.log(1e-3) / np.log(r / (1.0 + r))), found=sweeps, within=0.0,
                  saw=f"At a mass ratio of {r:g} a thousandth of the error is left after {sweeps} sweeps.")
    fine = np.geomspace(1.0, 1e4, 60)
    return Picture(
        "A heavy weight under a light one", "log₁₀ of the mass ratio", "log₁₀ of (1 − share that a sweep leaves)",
        [series("theory: 1/(1 + r)", np.log10(fine), -np.log10(1.0 + fine), LINE),
         log_series("distance_sweep, measured", ratios, 1.0 - np.array(measured), DOTS)],
        "A mass ratio of a hundred needs about sixty times the sweeps of equal masses. If possible, hang the "
        "light weight under the heavy one.")


def circling(lesson, step, turn, steps):
    """Return the angle [rad] of each step of a weight on a string without gravity.

    The weight moves in a circle; its first tangential speed is that angle times the radius per step.
    """
    p, x, v, angles = network([1.0], g=0.0), straight(1), np.array([[0.0, 0.0], [1.0, 0.0]]), []
    for _ in range(steps):
        new, v = getattr(lesson, step)(lesson.network_gravity, 0.0, x, v, turn, p)
        angles.append(np.arctan2(new[1, 0] * -x[1, 1] + new[1, 1] * x[1, 0], new[1] @ x[1]))
        x = new
    return np.array(angles)


@case("projection-dissipation", "Speed lost by projection on a circle", compiled=False)
def projection_dissipation(lesson, check):
    """Compare the loss of speed of a weight that circles on a string without gravity with theory.

    A step goes along the last chord and is projected back radially:  tan β = sin α/(2 − cos α)  for the next angle,
    after tan α = ω dt for the first.  β ≈ α − α³, so 1/α² grows by 2 per step and  ω_N ≈ ω/√(1 + 2N(ω dt)²).  The
    loss is twice that of a curved wall (friction/curved-wall-order).  PBD and the projection method lose the same.
    """
    steps, drawn = 200, []
    n = np.arange(steps)
    for turn in (0.2, 0.05):
        angle = np.arctan(turn)
        for _ in range(steps - 1):
            angle = np.arctan(np.sin(angle) / (2.0 - np.cos(angle)))
        kept = {step: circling(lesson, step, turn, steps) / turn for step in ("pbd_step", "constraint_projection_step")}
        for speeds, label in zip(kept.values(), ("PBD", "constraint_correction"), strict=True):
            check("Projection slows a circling weight: tan β = sin α/(2 − cos α), so 1/ω² grows by nearly 2 dt² "
                  "per step.", f"{label}: speed left after {steps} steps at ω dt = {turn} [-]",
                  law=angle / turn, found=speeds[-1], within=1e-10,
                  saw=f"At ω dt = {turn} {label} keeps {100.0 * speeds[-1]:.2f} % of the speed for {steps} steps.")
        drawn += [series(f"ω dt = {turn}: 1/√(1 + 2N(ω dt)²)", n, 1.0 / np.sqrt(1.0 + 2.0 * n * turn**2), LINE),
                  series(f"ω dt = {turn}: PBD", n[::10], kept["pbd_step"][::10], DOTS)]
    varies = np.ptp(circling(lesson, "rattle_step", 0.2, steps))
    check("With gradients taken at the start of the step no speed is lost.",
          "RATTLE: variation of the angle per step in 200 steps [rad]", law=0.0, found=varies, within=1e-11,
          saw=f"Under RATTLE every step turns by the same angle, to within {varies:.0e} rad.")
    return Picture(
        "A weight that turns on a string", "steps", "speed left [-]", drawn,
        "No force slows this weight: the loss comes from the corners of the polygon that replaces the circle.")


@case("substeps-vs-iterations", "Substeps against sweeps", compiled=False)
def substeps_vs_iterations(lesson, check):
    """Compare n sweeps of one step with n steps of one sweep each, for the same work per frame.

    n sweeps leave a softness of  A (1 − Gⁿ)⁻¹ Gⁿ Λ*, at first about 1/n of that of one sweep.  n substeps leave
    ½N(N − 1) g (dt/n)², which is 1/n² of it.  But sweeps converge: for eight links Gⁿ is the smaller one from some 3 N²
    visits on.
    """
    N, once, drawn = LINKS, 0.5 * LINKS * (LINKS - 1) * G * FRAME**2, []
    runs = {"sweeps": lambda n: rest_of_chain(lesson, "xpbd_step", n, FRAME).sum(),
            "substeps": lambda n: rest_of_chain(lesson, "xpbd_step", 1, FRAME / n).sum()}
    theory = {"sweeps": lambda n: left_over(EQUAL, n, FRAME).sum(), "substeps": lambda n: once / n**2}
    fine, dots = np.arange(1, 31), (1, 2, 5, 10)
    for way, run in runs.items():
        for n in (10, 300):
            got = run(n)
            check("n substeps are n² times as stiff as one step with one sweep, but n sweeps are not, unless they are "
                  "so many that they have converged.", f"{n} {way} per frame: end of {N} links too low by [mm]",
                  **millimetres(theory[way](n), got, SETTLED),
                  saw=f"With {n} {way} per frame a chain of {N} m hangs {MILLIMETRES * got:.2g} mm too low.")
        drawn += [log_series(f"{way}, theory", fine, [MILLIMETRES * theory[way](n) for n in fine], LINE),
                  log_series(f"{way}, measured", dots, [MILLIMETRES * run(n) for n in dots], DOTS)]
    return Picture(
        "Where to spend the visits of a frame", "log₁₀ of the visits to a link", "log₁₀ of how much too low [mm]",
        drawn,
        "For the same work the slope is twice as steep: short steps are worth more than many sweeps, up to some 200 "
        "visits for these eight links.")


# ---------------------------------------------------------------------------------------------- extremes

def impossible(lesson):
    """Return calls for impossible networks."""
    x, three = straight(2), np.zeros((4, 3))
    same, flat_fold, chain = 0.0 * x, np.array([[0.0, 0, 0], [1.0, 0, 0], [0, 1.0, 0], [0, 0, 0]]), network([1.0, 1.0])
    valid = {"x": x, "m": 1.0, "fixed": [0], "pairs": [(0, 1), (1, 2)], "alpha": 0.0, "stiffness": 1.0,
             "gravity": (0.0, -G), "sweeps": 1}
    bad = [{"alpha": -1e-3}, {"alpha": np.nan}, {"fixed": [0, 1]}, {"x": same}, {"x": x * np.nan}, {"m": 0.0},
           {"m": -1.0}, {"stiffness": 0.0}, {"stiffness": 1.5}, {"sweeps": 0}, {"gravity": (0.0, np.inf)}]
    return [(lesson.make_constraint_network, tuple((valid | one).values())) for one in bad] + [
        (lesson.distance_constraint, (x[0], x[0], 1.0)),
        (lesson.constraint_correction, (1.0, np.ones((2, 3)), np.zeros(2))),
        (lesson.constraint_correction, (1.0, np.zeros((2, 3)), np.ones(2))),
        (lesson.distance_sweep, (same, chain)),
        (lesson.compliant_sweep, (same, np.zeros(2), 0.1, chain)),
        (lesson.fold_constraint, (three, 0.0)),
        (lesson.fold_constraint, (flat_fold, 0.0)),
        (lesson.compliant_multiplier, (0.1, 0.0, 1.0, -1e-3)),
        (lesson.compliant_multiplier, (0.1, 0.0, 0.0, 0.0)),
        (lesson.compliant_multiplier, (0.1, 0.0, 1.0, np.nan)),
    ]


def lengths_at_a_million(lesson):
    """Return the excess length [m] of a chain after each of 300 steps of ten sweeps, at a mass ratio of a million."""
    y, p, excess = straight(2), network([1.0, 1e6], 1.0, 0.0, 10), []
    v = 0.0 * y
    for _ in range(300):
        y, v = lesson.pbd_step(lesson.network_gravity, 0.0, y, v, 1.0 / 60.0, p)
        excess.append(stretch(y).sum())
    return excess


@case("extremes", "Extremes of constraints", compiled=False)
def extremes(lesson, check):
    """Check that impossible input is refused, and that extreme but valid input gives the right limit.

    With a compliance of 10¹² m/N the spring has no effect: the weight falls by ½g t(t + dt) in t.  At a mass ratio
    of 10⁶ ten sweeps hardly hold the chain.  A projection can only shorten a link that is too long, so the chain
    falls no faster than freely.
    """
    asked, dt, steps = impossible(lesson), 0.01, 50
    refused = sum(refuses(*call) for call in asked)
    check("Impossible input is refused by name.", f"calls that end in BadInput [of {len(asked)}]",
          law=len(asked), found=refused, within=0.0, saw=f"{refused} of {len(asked)} impossible inputs are refused.")
    fallen = sag(lesson, "xpbd_step", network([1.0], 1.0, 1e12), dt, steps)
    check("A spring of vanishing stiffness lets the weight fall freely.",
          "fall of a weight on a compliance of 10¹² m/N in ½ s [m]",
          law=0.5 * G * steps * dt * (steps + 1) * dt, found=fallen, within=1e-11,
          saw=f"On a compliance of 10¹² m/N a weight falls {fallen:.6f} m in half a second.")
    ends = [settle(lesson, step, network([1.0, 1.0], 1.0, 0.0, 5), dt, steps) for step in ("xpbd_step", "pbd_step")]
    check("Without compliance XPBD is PBD.", "largest difference after 50 steps [m]",
          law=0.0, found=np.abs(ends[0] - ends[1]).max(), within=ROUND_OFF,
          saw="Without compliance XPBD and PBD give the same positions.")
    most = np.max([0.0, *lengths_at_a_million(lesson)])
    check("At a mass ratio of a million the chain is soft but stays stable: it never falls faster than freely.",
          "runs at a mass ratio of 10⁶ that stay below free fall [of 1]",
          law=1, found=most <= 0.5 * G * (301 / 60.0) ** 2, within=0.0,
          saw=f"At a mass ratio of a million 10 sweeps leave a chain {most:.2f} m too long.")
    exponents = np.linspace(-9.0, 0.0, 10)
    sags = [sag(lesson, "xpbd_step", network([1.0], 1.0, 10.0**y, 1), 1.0, 400) for y in exponents]
    return Picture(
        "Any compliance", "log₁₀ of the compliance [m/N]", "log₁₀ of the sag [m]",
        [series("theory: α m g", exponents, np.log10(G) + exponents, LINE),
         series("XPBD, steps of a second", exponents, np.log10(sags), DOTS)],
        "From a nanometre per newton to a metre per newton, with steps of a whole second: no stiffness is too high.")


# ---------------------------------------------------------------------------------------------- larger parts

def out_of_reach(lesson):
    """Return an obstacle that nothing reaches."""
    return lesson.Obstacle(np.full(3, 50.0), 0.0, np.array([0.0, 0.0, -50.0]), np.array([0.0, 0.0, 1.0]))


def fold_reaches_its_angle(lesson, check):
    """Visit one fold of two triangles twelve times."""
    x = np.array([[0.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 0.4, 0.1], [-0.9, 0.6, 0.5]])
    none, no_links = np.zeros(0), np.zeros(0, dtype=np.int64)
    loose = ConstraintNetwork(np.array([1.0, 2.0, 1.0, 0.5]), np.zeros(3), no_links, no_links, none, none, none, 1)
    sheet = lesson.Cloth(loose, np.array([[0, 1, 2, 3]]), np.array([0.2]), 1.0, out_of_reach(lesson))
    centre = x.T @ (1.0 / loose.inv_mass)
    for _ in range(12):
        x = lesson.fold_sweep(x, sheet)
    left = abs(lesson.fold_constraint(x, 0.2)[0])
    check("A fold reaches its rest angle.", "error of the angle after 12 visits [rad]",
          law=0.0, found=left, within=ROUND_OFF, saw=f"After 12 visits the fold is {left:.0e} rad off.")
    shift = np.abs(x.T @ (1.0 / loose.inv_mass) - centre).max()
    check("The correction of a fold exerts no net force.", "displacement of the centre of mass, times the mass [kg m]",
          law=0.0, found=shift, within=ROUND_OFF,
          saw=f"Times the mass, its centre of mass has moved by {shift:.0e} kg m.")


def ball_reaches_its_volume(lesson, check):
    """Fill an octahedron with air; its links are almost infinitely compliant, so that only the air is tested.

    The visits are Newton's method: five of them square the error five times.
    """
    corners = np.concatenate([[axis, -axis] for axis in np.eye(3)])
    faces = np.array([[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]])
    net = lesson.make_constraint_network(corners, 1.0, [], lesson.shared_edges(faces)[0], 1e9, 1.0, np.zeros(3), 5)
    y, v = corners * [1.2, 0.9, 1.0], 0.0 * corners
    ball = lesson.Balloon(net, faces, 2.0, 0.0, out_of_reach(lesson))
    for _ in range(10):
        y, v = lesson.balloon_step(lesson.network_gravity, 0.0, y, v, 0.05, ball)
    volume, drift = lesson.volume_gradient(y, faces)[0], np.abs(v.sum(axis=0)).max()
    check("A ball reaches its rest volume.", "volume [m³]", law=2.0, found=volume, within=1e-9,
          saw=f"The ball holds {volume:.9f} m³.")
    check("Its air exerts no net force.", "momentum of the ball [kg m/s]", law=0.0, found=drift, within=1e-11,
          saw=f"Its momentum is {drift:.0e} kg m/s.")


HALF = 0.3                   # of the rod on a pivot [m]
MOMENT = (2.0 * HALF) ** 2 / 12.0


def quarter_of(theta):
    """Return the quarter period [s] of a compound pendulum with the moment and the length of the rod."""
    return 0.25 * pendulum_period(theta, (MOMENT + HALF**2) / HALF, G)


def quarter_period(lesson, theta, dt):
    """Return the time [s] at which a rod of 1 kg, held at one end and released at θ about y, passes its lowest point.

    The crossing is interpolated linearly between two steps.
    """
    I_body, arm = np.array([MOMENT, MOMENT, 1e-4]), np.array([0.0, 0.0, HALF])
    rod = lesson.PivotedBody(1.0, I_body, np.array([0.0, 0.0, -G]), np.zeros(3), arm, 3)
    q = np.array([np.cos(0.5 * theta), 0.0, -np.sin(0.5 * theta), 0.0])
    x, v, omega, t = HALF * np.array([np.sin(theta), 0.0, -np.cos(theta)]), np.zeros(3), np.zeros(3), 0.0
    while x[0] > 0.0 and t < 2.0:
        before = x[0]
        x, q, v, omega = lesson.pivoted_body_step(t, x, q, v, omega, dt, rod)
        t += dt
    return t - dt * x[0] / (x[0] - before)


def rod_swings(lesson, check):
    """Extrapolate the time that the rod takes to its lowest point."""
    theta, dt = 0.5, 0.002
    bound = quarter_of(theta)
    got = 2.0 * quarter_period(lesson, theta, 0.5 * dt) - quarter_period(lesson, theta, dt)
    check("A rigid rod that hangs from a point swings as a compound pendulum.",
          "quarter period of a rod of 0.6 m, extrapolated [s]",
          law=bound, found=got, within=5.0 * (0.5 * np.pi / bound * dt) ** 2 * bound,
          saw=f"A rod of 0.6 m is at its lowest after {got:.5f} s.")


def cloth_stays_outside(lesson, check):
    """Let a cloth of 16 points fall on a ball and a floor."""
    n = 4
    sheet = np.array([[0.3 * (k % n), 0.3 * (k // n), 0.4] for k in range(n * n)])
    firsts = [r * n + c for r in range(n - 1) for c in range(n - 1)]
    triangles = np.array([t for a in firsts for t in ((a, a + 1, a + n), (a + 1, a + n + 1, a + n))])
    edges, hinges = lesson.shared_edges(triangles)
    thrown = lesson.Obstacle(np.array([0.45, 0.4, 0.0]), 0.3, np.array([0.0, 0.0, -0.25]), np.array([0.0, 0.0, 1.0]))
    weave = lesson.make_constraint_network(sheet, 0.1, [], edges, 0.0, 1.0, (0.0, 0.0, -G), 3)
    cloth = lesson.Cloth(weave, hinges, np.zeros(len(hinges)), 0.1, thrown)
    v, depth = 0.0 * sheet, 0.0
    for _ in range(40):
        sheet, v = lesson.cloth_step(lesson.network_gravity, 0.0, sheet, v, 0.02, cloth)
        over = np.linalg.norm(sheet - thrown.centre, axis=1).min() - 0.3, sheet[:, 2].min() + 0.25
        depth = np.max([depth, *np.negative(over)])
    check("At the end of a step no point of a cloth is inside an obstacle.",
          "greatest depth of a point in 40 steps [m]", law=0.0, found=depth, within=ROUND_OFF,
          saw=f"The points of a cloth that falls on a ball and a floor are never deeper than {depth:.0e} m.")


@case("primitives", "A fold, a ball, a rod and a cloth", compiled=False)
def primitives(lesson, check):
    """Check a fold's angle, a ball's volume, a rod's period, and that no point stays inside an obstacle.

    A weightless fold of stiffness 1 reaches its angle by Newton's method in a few visits.  A ball without gravity
    and with no compliance of its air settles at its volume.  Neither exerts a net external force.  The rod's
    quarter period, extrapolated from steps of dt and dt/2, is off by a few (ω dt)² of its value.
    """
    for part in (fold_reaches_its_angle, ball_reaches_its_volume, rod_swings, cloth_stays_outside):
        part(lesson, check)
    fine, dots = np.linspace(0.1, 2.5, 40), np.array([0.25, 0.5, 1.0, 1.5, 2.0])
    return Picture(
        "A rod on a pivot", "released at [rad]", "time to its lowest point [s]",
        [series("theory", fine, [quarter_of(a) for a in fine], LINE),
         series("pivoted_body_step, 5 ms, measured", dots, [quarter_period(lesson, a, 0.005) for a in dots], DOTS)],
        "To constrain a rigid body, projection needs the generalised inverse mass and nothing else that a point lacks.")


# ---------------------------------------------------------------------------------------------- laws

TRIED = 40                   # random configurations [-]
IMAGINARY = 1e-20            # step of a derivative along the imaginary axis [m]
FACES = np.array([[0, 1, 2], [0, 3, 1], [0, 2, 3], [1, 3, 2]])           # of a tetrahedron


def derivative(function, x):
    """Return the derivatives of function(x) by all entries of x, in the last axes: without truncation error."""
    steps = IMAGINARY * 1j * np.eye(x.size).reshape(x.size, *x.shape)
    return np.moveaxis([np.imag(function(x + step)) / IMAGINARY for step in steps], 0, -1)


def size_of(r):
    """Return |r|, also of complex vectors."""
    return np.sqrt(np.sum(r * r))


def fold_angle(x):
    """Return the angle between the normals of two triangles a b c and b a d, also of complex corners."""
    a, b, c, d = x
    e, N_c, N_d = b - a, np.cross(a - c, b - c), np.cross(b - d, a - d)
    across, along = np.sum(np.cross(N_c, N_d) * e) / size_of(e), np.sum(N_c * N_d)
    return np.arctan(across / along) + (0.0 if along.real > 0.0 else np.copysign(np.pi, across.real))


def volume_of(x, faces):
    """Return the sum of the determinants of the faces over 6."""
    a, b, c = (x[faces[:, k]] for k in range(3))
    return np.sum(a * np.cross(b, c)) / 6.0


def wxyz(rotation):
    """Return the quaternion (w, x, y, z) of one of SciPy's rotations."""
    return np.roll(rotation.as_quat(), 1)


def tangent_turn(phi):
    """Return the rotation by 2 atan ½|φ| about φ."""
    return Rotation.from_rotvec(2.0 * np.arctan(0.5 * size_of(phi)) / size_of(phi) * phi)


def random_points(rng):
    """Return four places x (4, 3) [m], and inverse masses w (4,) [1/kg]."""
    return rng.normal(size=(4, 3)), rng.uniform(0.5, 2.0, 4)


def row_of(lesson, x, w, fixed=(0,), sweeps=1):
    """Return the points as a row of three links, which are as long as they are."""
    return lesson.make_constraint_network(x, 1.0 / w, list(fixed), [(0, 1), (1, 2), (2, 3)], 0.0, 1.0, (0.0, 0.0, -G),
                                          sweeps)


def random_body(rng):
    """Return (m, I_body, rotation) of a rigid body with three different moments and a random orientation."""
    return rng.uniform(0.5, 2.0), rng.uniform(1.0, 1.9, 3), Rotation.random(rng=rng)


def inverse_tensor(I_body, turn):
    """Return I⁻¹ (3, 3) in the world."""
    R = turn.as_matrix()
    return R @ np.diag(1.0 / I_body) @ R.T


@random_law("The gradient of a link is the derivative of its length.", "link: largest error of the link [m, -]", 1e-12)
def link(lesson, rng):
    (a, b), rest = rng.normal(size=(2, 3)), rng.uniform(0.5, 2.0)
    C = lambda end: size_of(end - b) - rest
    return lesson.distance_constraint(a, b, rest), (C(a), derivative(C, a))


@random_law("A correction meets its constraint with the least Σ m |Δx|².",
            "correction: largest error of the correction [m]", 1e-12)
def correction(lesson, rng):
    g, w = random_points(rng)
    C, moved = rng.normal(), w[:, None] * g
    return lesson.constraint_correction(C, g, w), -C * moved / np.sum(moved * g)


def rope_equations(y, chain, goal, dt):
    """Return the residuals of both equations of a row of points: places y[:12] and forces y[12:] of the links."""
    x, lam = y[:12].reshape(4, 3), y[12:]
    r, pull = x[:-1] - x[1:], np.zeros((4, 3), dtype=y.dtype)
    lengths = np.sqrt(np.sum(r * r, axis=1))
    pull[:-1] += lam[:, None] * r / lengths[:, None]
    pull[1:] -= lam[:, None] * r / lengths[:, None]
    moved = x - goal - dt * dt * chain.inv_mass[:, None] * pull
    return np.concatenate((moved.ravel(), lengths - chain.rest))


@random_law("Newton's correction solves both linearised equations, with the curvature of the links.",
            "newton: largest error of the places and forces, relative [-]", 1e-6)
def newton(lesson, rng):
    """Begin with a guess in which the links have wrong lengths; the first point is fixed."""
    x, w = random_points(rng)
    chain, dt, lam = row_of(lesson, x, w), 0.1, rng.normal(size=3)
    guess, goal = x + 0.1 * rng.normal(size=(2, 4, 3))
    guess[0] = goal[0] = x[0]
    left, y = lambda y: rope_equations(y, chain, goal, dt), np.concatenate((guess.ravel(), lam))
    truth = y - np.linalg.solve(derivative(left, y), left(y))
    change, forces = lesson.newton_correction(guess, lam, goal, dt, chain)
    return relative((np.concatenate(((guess + change).ravel(), forces)), truth))


@random_law("The gradient of a fold is the derivative of its angle, which stays within half a turn.",
            "fold: largest error of the angle and gradient, relative [rad, -]", 1e-9)
def fold(lesson, rng):
    (x, _), rest = random_points(rng), rng.uniform(-3.0, 3.0)
    C, slope = fold_angle(x) - rest, derivative(fold_angle, x)
    got_C, got_slope = lesson.fold_constraint(x, rest)
    largest = np.max(np.abs(slope))
    return (got_C, got_slope / largest), (C - 2.0 * np.pi * np.round(C / (2.0 * np.pi)), slope / largest)


@random_law("The normal of a ball is the derivative of the distance.",
            "ball: largest error of the gap and normal [m, -]", 1e-12)
def ball(lesson, rng):
    (x, centre), radius = rng.normal(size=(2, 3)), rng.uniform(0.5, 2.0)
    gap = lambda x: size_of(x - centre) - radius
    obstacle = lesson.Obstacle(centre, radius, np.zeros(3), np.array([0.0, 0.0, 1.0]))
    return lesson.ball_gap(x, obstacle), (gap(x), derivative(gap, x))


@random_law("The gradient of a volume is its derivative, for any origin.",
            "volume: largest error of the volume [m³, m²]", 1e-11)
def volume(lesson, rng):
    """Take the origin outside: some faces count negative."""
    x = rng.normal(size=(4, 3)) + np.array([3.0, -2.0, 4.0])
    V = lambda x: volume_of(x, FACES)
    return lesson.volume_gradient(x, FACES), (V(x), derivative(V, x))


@random_law("A point that cannot move keeps its velocity, and the force at the time of the step acts on all others.",
            "driven: largest error of the predicted place [m]", 1e-12)
def driven(lesson, rng):
    (x, w), v, t, dt = random_points(rng), rng.normal(size=(4, 3)), rng.uniform(0.0, 6.0), 0.1
    force = lambda t, x, v, p: np.sin(t) * x - 0.3 * v + 1.0
    a = force(t, x, v, None) * [[0.0], [1.0], [1.0], [1.0]]
    return lesson.predict(force, t, x, v, dt, row_of(lesson, x, w)), x + dt * v + dt * dt * a


@random_law("Points inside a ball are moved to its surface; a fixed point does not move.",
            "outside: largest error of the place [m]", 1e-12)
def outside(lesson, rng):
    """Put the fixed point inside the ball, too."""
    x, w = random_points(rng)
    obstacle = lesson.Obstacle(x[0] + 0.1, 1.5, np.zeros(3), np.array([0.0, 0.0, 1.0]))
    r = x - obstacle.centre
    out = obstacle.centre + r * np.maximum(1.0, obstacle.radius / np.linalg.norm(r, axis=1))[:, None]
    out[0] = x[0]
    return lesson.keep_outside(lesson.ball_gap, x, row_of(lesson, x, w).inv_mass, obstacle), out


@random_law("After a step of the projection method every link has its length.",
            "exact: largest error of the length [m]", 1e-12)
def exact(lesson, rng):
    (x, w), v = random_points(rng), 3.0 * rng.normal(size=(4, 3))
    chain = row_of(lesson, x, w)
    held, _ = lesson.constraint_projection_step(lesson.network_gravity, 0.0, x, v, 0.01, chain)
    return np.linalg.norm(held[:-1] - held[1:], axis=1), chain.rest


@random_law("A network under a uniform acceleration translates, by the accelerations of both times.",
            "as one: largest error of the state [m, m/s]", 1e-9)
def as_one(lesson, rng):
    """Take a step of RATTLE, which is given, by the mean of both accelerations."""
    (x, w), t, dt = random_points(rng), rng.uniform(0.0, 6.0), 0.1
    v, now, then = np.tile(rng.normal(size=3), (4, 1)), np.cos(t), np.cos(t + dt)
    got = lesson.rattle_step(lambda t, x, v, p: np.cos(t) * np.ones(x.shape), t, x, v, dt, row_of(lesson, x, w, ()))
    return got, (x + dt * v + 0.5 * dt * dt * now, v + 0.5 * dt * (now + then))


def sheet_of(lesson, x, net, share, off=0.0):
    """Return four points as a cloth of one fold, which is off its rest angle by this angle [rad]."""
    return lesson.Cloth(net, np.array([[0, 1, 2, 3]]), np.array([fold_angle(x) - off]), share, out_of_reach(lesson))


@random_law("A visit to a fold conserves the centre of mass, for any numbering of its points.",
            "numbers: largest error of the way [-, kg]", 1e-6)
def numbers(lesson, rng):
    (x, w), share, off = random_points(rng), rng.uniform(0.2, 0.8), 1e-6
    sheet = sheet_of(lesson, x, row_of(lesson, x, w, ()), share, off)
    mixed = np.array([2, 0, 3, 1])                          # the same sheet with other numbers of its points
    others = np.argsort(mixed)
    renamed = sheet._replace(network=row_of(lesson, x[others], w[others], ()), hinges=mixed[None])
    way = (lesson.fold_sweep(x[others], renamed)[mixed] - x) / off
    return (way, np.sum(way / w[:, None], axis=0)), ((lesson.fold_sweep(x, sheet) - x) / off, np.zeros(3))


def random_pair(lesson, rng):
    """Return (x, w, links, r): two links that share no point and have nothing in common, and their vectors r (2, 3)."""
    x, w = random_points(rng)
    rest, stiffness, alpha = rng.uniform((0.5, 0.25, 0.5), (2.0, 1.0, 2.0), (2, 3)).T
    links = lesson.make_constraint_network(x, 1.0 / w, [], [(0, 1), (2, 3)], alpha, stiffness, (0.0, 0.0, -G), 1)
    return x, w, links._replace(rest=rest), x[::2] - x[1::2]


@random_law("A visit leaves 1 − s of a link's error, and conserves the centre of mass.",
            "visit: largest error of the place [m, kg m]", 1e-12)
def visit(lesson, rng):
    x, w, links, r = random_pair(lesson, rng)
    length, swept = np.linalg.norm(r, axis=1), lesson.distance_sweep(x, links)
    wish = (length - links.stiffness * (length - links.rest))[:, None] * r / length[:, None]
    moments = lambda y: (y / w[:, None])[::2] + (y / w[:, None])[1::2]
    return (swept[::2] - swept[1::2], moments(swept)), (wish, moments(x))


@random_law("After a visit each link obeys Hooke's law with its own compliance.",
            "spring: largest error of the place [m]", 1e-9)
def spring(lesson, rng):
    (x, w, links, r), before, dt = random_pair(lesson, rng), rng.normal(size=2), 0.1
    swept, after = lesson.compliant_sweep(x, before, dt, links)
    n = r / np.linalg.norm(r, axis=1)[:, None]
    push = (after - before)[:, None] * n
    new = (links.rest - links.alpha / dt**2 * after)[:, None] * n
    moved = swept - x
    return (swept[::2] - swept[1::2], moved[::2], moved[1::2]), (new, w[::2, None] * push, -w[1::2, None] * push)


@random_law("A point of a body moves by 1/m + (r × n) · I⁻¹ (r × n), in world coordinates.",
            "lever: largest error of the weight [1/kg]", 1e-11)
def lever(lesson, rng):
    (m, I_body, turn), (r, n) = random_body(rng), rng.normal(size=(2, 3))
    arm = np.cross(r, n)
    return (lesson.effective_inverse_mass_at(wxyz(turn), r, n, m, I_body),
            1.0 / m + arm @ inverse_tensor(I_body, turn) @ arm)


@random_law("A positional impulse moves a body by p/m, and rotates it about I⁻¹ (r × p).",
            "impulse: largest error of the place and turn [m, -]", 1e-11)
def impulse(lesson, rng):
    (m, I_body, turn), (x, r, p) = random_body(rng), rng.normal(size=(3, 3))
    after = wxyz(tangent_turn(inverse_tensor(I_body, turn) @ np.cross(r, p)) * turn)
    new_x, new_q = lesson.apply_positional_impulse(x, wxyz(turn), r, p, m, I_body)
    return (new_x, np.sign(new_q @ after) * new_q), (x + p / m, after)


@random_law("The rate of rotation is the inverse of the update, also for large rotations.",
            "rate: largest error of the ω [rad/s]", 1e-9)
def rate(lesson, rng):
    turn, omega, dt = Rotation.random(rng=rng), rng.normal(size=3), rng.uniform(0.2, 0.8)
    q, after = wxyz(turn), wxyz(tangent_turn(dt * omega) * turn)
    return (lesson.turning_rate(q, after, dt), lesson.turning_rate(q, -after, dt)), (omega, omega)


@random_law("A body held at its centre obeys Euler's equation.", "free: largest error of the ω [rad/s]", 1e-9)
def held_body(lesson, rng):
    (m, I_body, turn), (x, omega), dt = random_body(rng), rng.normal(size=(2, 3)), 0.01
    body, R = lesson.PivotedBody(m, I_body, np.zeros(3), x, np.zeros(3), 2), turn.as_matrix()
    *_, got = lesson.pivoted_body_step(0.0, x, wxyz(turn), np.zeros(3), omega, dt, body)
    L = R @ np.diag(I_body) @ R.T @ omega
    return got, omega - dt * inverse_tensor(I_body, turn) @ np.cross(omega, L)


@random_law("A visit to a fold leaves 1 − s of a small error.",
            "bent: largest error of the share of the error that is left [-]", 1e-3)
def bent(lesson, rng):
    (x, w), share, off = random_points(rng), rng.uniform(0.2, 0.8), 1e-6
    sheet = sheet_of(lesson, x, row_of(lesson, x, w, ()), share, off)
    return (fold_angle(lesson.fold_sweep(x, sheet)) - sheet.fold[0]) / off, 1.0 - share


@random_law("A cloth in the air falls without deforming, and its velocity is its displacement over the step.",
            "falls: largest error of the state [m, m/s]", 1e-9)
def falls(lesson, rng):
    (x, w), v, dt = random_points(rng), np.tile(rng.normal(size=3), (4, 1)), 0.01
    sheet = sheet_of(lesson, x, row_of(lesson, x, w, (), sweeps=2), rng.uniform(0.2, 0.8))
    new_v = v - np.array([0.0, 0.0, dt * G])
    return lesson.cloth_step(lesson.network_gravity, 0.0, x, v, dt, sheet), (x + dt * new_v, new_v)


@random_law("Air is a spring for the volume, for any step.",
            "air: largest error of the velocity over the missing volume [1/(m² s)]", 1e-4)
def air(lesson, rng):
    """Compress it slightly: p = (V₀ − V)/α for one implicit step, m v = dt p ∇V, all linear."""
    w, alpha, dt, less = rng.uniform(0.5, 2.0, 4), rng.uniform(0.5, 2.0), rng.uniform(0.1, 0.5), 1e-6
    x = rng.uniform(0.8, 1.2) * np.array([[1, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]])
    faces = FACES if volume_of(x, FACES) > 0.0 else FACES[:, ::-1]
    net = lesson.make_constraint_network(x, 1.0 / w, [], [(0, 1)], 1e12, 1.0, np.zeros(3), 3)
    balloon = lesson.Balloon(net, faces, volume_of(x, faces) + less, alpha, out_of_reach(lesson))
    _, v = lesson.balloon_step(lesson.network_gravity, 0.0, x, 0.0 * x, dt, balloon)
    g = derivative(lambda x: volume_of(x, faces), x).reshape(4, 3)
    pressure = less / (alpha + dt * dt * np.sum(w[:, None] * g * g))
    return v / less, dt * pressure * w[:, None] * g / less


@case("constraints-and-their-gradients", "Constraints, their gradients and corrections", compiled=False)
def constraints_and_gradients(lesson, check):
    """Compare gradients with derivatives of constraints along the imaginary axis, and rotations with SciPy's.

    A correction satisfies its linearised constraint with the least Σ m |Δx|².  Newton's method is compared with a
    dense solution of both equations, linearised along the imaginary axis; its regularisation is 1e-13 of the weights.
    """
    check.laws(lesson, (link, correction, newton, fold, ball, volume, driven, outside, exact, as_one, numbers, visit,
                        spring, lever, impulse, rate, held_body, bent, falls, air), seed=81, times=TRIED)


# ---------------------------------------------------------------------------------------------- inside out

CORNERS = np.array([(0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.3, 0.3, 1.0)])            # [m]
TETRAHEDRON = np.array([(0, 2, 1), (0, 1, 3), (1, 2, 3), (2, 0, 3)])    # faces, counter-clockwise seen from outside


def volume_restored(lesson, x, target):
    """Return the corners of a tetrahedron after Newton's method for V = target, all corners equally heavy."""
    for _ in range(60):
        V, gradient = lesson.volume_gradient(x, TETRAHEDRON)
        x = x + (target - V) / np.sum(gradient * gradient) * gradient
    return x


def length_of_edges(x):
    """Return the six lengths [m] of the edges of a tetrahedron."""
    return np.array([np.linalg.norm(x[i] - x[j]) for i in range(4) for j in range(i)])


def at_height(x, share):
    """Return the tetrahedron with its fourth corner at this fraction of its height above the other three."""
    n = np.cross(x[1] - x[0], x[2] - x[0])
    n /= np.linalg.norm(n)
    moved = x.copy()
    moved[3] += (share - 1.0) * (n @ (x[3] - x[0])) * n
    return moved


@case("inside-out", "A tetrahedron that is inside out", compiled=False)
def inside_out(lesson, check):
    """Check a tetrahedron that is inside out: its volume is negative, and the gradient still points out.

    The mirror image has V → −V, and ∇V, an area times a direction, is mirrored and changes its sign.  So a
    correction along ∇V leads back through the face.  Lengths cannot do that: the mirror image has the same edges.
    A flat body has V = 0 and a ∇V of the areas of its faces, so it can leave this state; only a body that is a line
    has no gradient.
    """
    rng, errors, mirror = np.random.default_rng(31), Worst(), np.diag((1.0, 1.0, -1.0))
    for _ in range(TRIED):
        x = CORNERS + rng.uniform(-0.2, 0.2, (4, 3))
        V, gradient = lesson.volume_gradient(x, TETRAHEDRON)
        errors.note("mirrored", lesson.volume_gradient(x @ mirror, TETRAHEDRON), (-V, -gradient @ mirror))
        errors.note("edges", length_of_edges(x @ mirror), length_of_edges(x))
        for height in (-1.0, 0.0):                         # inside out, and flat
            errors.note(height, volume_of(volume_restored(lesson, at_height(x, height), V), TETRAHEDRON), V)
    line = np.outer(np.arange(4.0), (1.0, 2.0, 3.0))
    errors.note("line", lesson.volume_gradient(line, TETRAHEDRON), (0.0, np.zeros((4, 3))))
    check.agree("The mirror image of a body has the negative volume, and the mirrored gradient with the other sign.",
                "volume and gradient: largest error [m³, m²]", errors["mirrored"], ROUND_OFF)
    check.agree("The mirror image has the same edges, so no length can distinguish it.",
                "edges: largest difference [m]", errors["edges"], ROUND_OFF)
    check.agree("A volume leads a tetrahedron that is inside out back through its own face.",
                "volume in the end, from inside out: largest error [m³]", errors[-1.0], ROUND_OFF)
    check.agree("A flat tetrahedron gets its volume back, too.",
                "volume in the end, from flat: largest error [m³]", errors[0.0], ROUND_OFF)
    check.agree("If all corners lie on a line, both the volume and its gradient are zero.",
                "volume and gradient [m³, m²]", errors["line"], 1e2 * ROUND_OFF)


# ---------------------------------------------------------------------------------------------- why?

@case("circling-weight", "The speed that a circling weight keeps", compiled=False)
def circling_weight(lesson, check):
    """Let a weight circle by pbd_step without gravity: 1/ω² grows by 2 dt² per step, to leading order in ω dt."""
    p, worst = network([1.0], g=0.0), 0.0
    for angle in (0.02, 0.05):
        x = straight(1)
        x, v = integrators.advance(lesson.pbd_step, lesson.network_gravity, 0.0, x, np.array([[0.0, 0.0], [1.0, 0.0]]),
                                   angle, 400, p)
        worst = np.maximum(worst, abs(lesson.circling_speed(1.0, 1.0, angle, 400 * angle) - np.linalg.norm(v[1]))
                           / angle**2)
    check.agree("A circling weight slows down as predicted.", "speed: error over (ω dt)² of the first speed [-]", worst,
                2.0)


# ---------------------------------------------------------------------------------------------- a thing of one's own

def energy_of(x, v, net):
    """Return kinetic energy, potential energy, and energy of the soft links [J]; fixed points have none."""
    free, soft = net.inv_mass > 0.0, net.alpha > 0.0
    C = np.linalg.norm(x[net.i] - x[net.j], axis=1) - net.rest
    kinetic = 0.5 * np.sum(np.sum(v[free] ** 2, axis=1) / net.inv_mass[free])
    return kinetic - np.sum(x[free] @ net.gravity / net.inv_mass[free]) + 0.5 * np.sum(C[soft] ** 2 / net.alpha[soft])


@case("thing-of-ones-own", "A thing of one's own that holds together", compiled=False)
def thing_of_ones_own(lesson, check):
    """Run my_thing for a second by xpbd_step: its rigid links hold, it moves, and the step brings no energy.

    The limits are those of its docstring.  A projection is a plastic impact: it takes energy or leaves it as it is, but
    for the second order of a step.
    """
    x, net, _ = lesson.my_thing()
    start, net = np.array(x, dtype=float), lesson.ConstraintNetwork(*net)
    x, v, rigid, size = start, 0.0 * start, net.alpha == 0.0, np.linalg.norm(np.ptp(start, axis=0))
    energies, off, way = [energy_of(x, v, net)], 0.0, 0.0
    for _ in range(240):
        x, v = lesson.xpbd_step(lesson.network_gravity, 0.0, x, v, 1.0 / 240.0, net)
        length = np.linalg.norm(x[net.i] - x[net.j], axis=1)
        off = np.maximum(off, np.max(abs(length / net.rest - 1.0)[rigid]))
        way, energies = np.maximum(way, np.max(np.linalg.norm(x - start, axis=1))), [*energies, energy_of(x, v, net)]
    weight = np.linalg.norm(net.gravity) * np.sum(1.0 / net.inv_mass[net.inv_mass > 0.0])
    check.agree("The rigid links keep their lengths.", "rigid links: largest error over the length [-]", off, 0.05)
    check.agree("The step brings no energy into the thing.", "rise of the energy over weight and size [-]",
                np.maximum(0.0, np.max(energies) - energies[0]) / (weight * size), 1e-5)
    check("The thing moves.", "farthest way of a point over a tenth of the size, at most 1 [-]", law=1.0,
          found=np.minimum(1.0, way / (0.1 * size)), within=0.0, saw=f"A point moves by {way:.2g} m.")
