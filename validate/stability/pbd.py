"""Softness of constraints that should not stretch, and the cost of sweeps and steps: lesson 8 compared with theory.

Most bodies hang straight down or move in a circle.  A sweep is then a linear map, and its
result is known in closed form.  *Source:* Müller et al. 2006, Macklin et al. 2016 and 2019; each case derives the rest.
"""

import itertools

import numpy as np
from scipy.spatial.transform import Rotation

from solutions import integrators
from solutions.checks import Diverged
from solutions.pbd import ConstraintNetwork
from validate.reference.pbd import pendulum_period
from validate.stability.case import DOTS, LINE, Picture, Worst, agreement, case, finding, flat, refuses, series

G = 9.81                     # [m/s²]
MILLIMETRES = 1e3            # millimetres per metre
ROUND_OFF = 1e-12            # of positions around 1 m after a thousand visits to a link [m]
SETTLED = 1e-10              # distance to rest at which a run ends [m]


def network(masses, stiffness=1.0, alpha=0.0, sweeps=1, g=G, l=1.0):
    """A ConstraintNetwork of one hanging chain: masses [kg] from top to bottom under a fixed point, links of l [m]."""
    n = len(masses)
    return ConstraintNetwork(
        np.array([0.0, *(1.0 / m for m in masses)]),
        np.array([0.0, -g]),
        np.arange(n),
        np.arange(1, n + 1),
        np.full(n, l),
        np.full(n, stiffness),
        np.full(n, alpha),
        sweeps,
    )


def straight(n, l=1.0):
    """(n + 1, 2): such a chain, unstretched."""
    return np.stack((np.zeros(n + 1), -l * np.arange(n + 1.0)), axis=1)


def settle(lesson, step, p, x, dt, steps):
    """Return the positions of a chain after so many steps from rest, or NaN if the run diverges."""
    try:
        return integrators.advance(getattr(lesson, step), lesson.network_gravity, 0.0, x, 0.0 * x, dt, steps, p)[0]
    except Diverged:
        return np.full_like(x, np.nan)


def stretch(x, l=1.0):
    """Return the excess length of each link of a chain [m]."""
    return -np.diff(x[:, 1]) - l


@case("stiffness-depends-on-dt", "PBD is as soft as its step", compiled=False)
def stiffness_depends_on_dt(lesson):
    """PBD's softness depends on dt: a weight sags by g dt² S/(1 − S), S = (1 − s)ⁿ.

    A step lowers the weight by g dt², and n sweeps leave a share S of the error; at rest  S (sag + g dt²) = sag.  The
    recursion y ← S (2y − y_before + g dt²) has roots |z|² = S, so a run converges by √S per step.  300 steps leave
    √0.75³⁰⁰ < 1e-18.
    """
    found, steps = [], 300
    for s, n, dt in ((0.5, 1, 1.0 / 60.0), (0.5, 1, 1.0 / 120.0), (0.5, 3, 1.0 / 60.0), (0.25, 1, 1.0 / 60.0)):
        S = (1.0 - s) ** n
        bound = G * dt * dt * S / (1.0 - S)
        name = f"stiffness {s}, {n} {'sweep' if n == 1 else 'sweeps'}, dt = 1/{round(1 / dt)} s"
        got = stretch(settle(lesson, "pbd_step", network([1.0], s, 0.0, n), straight(1), dt, steps))[0]
        found.append(finding(
            claim=("PBD's stiffness depends on the step and on the sweeps: a weight sags by g dt² S/(1 − S), S = (1 "
                   "− s)ⁿ."),
            quantity=f"sag, {name} [mm]",
            predicted=MILLIMETRES * bound,
            measured=MILLIMETRES * got,
            tolerance=MILLIMETRES * ROUND_OFF,
            observation=f"With {name} a weight sags by {MILLIMETRES * got:.4f} mm.",
        ))
        said = lesson.pbd_sag(G, dt, s, n)
        found.append(finding(
            claim="The lesson's formula gives the same sag.",
            quantity=f"pbd_sag, {name} [mm]",
            predicted=MILLIMETRES * bound,
            measured=MILLIMETRES * said,
            tolerance=MILLIMETRES * ROUND_OFF,
            observation=f"pbd_sag returns {MILLIMETRES * said:.4f} mm.",
        ))
    heavy = stretch(settle(lesson, "pbd_step", network([1000.0], 0.5), straight(1), 1.0 / 60.0, steps))[0]
    found.append(finding(
        claim="The sag does not depend on the mass, so the link is not a spring.",
        quantity="sag of a thousand times the mass [mm]",
        predicted=MILLIMETRES * G / 3600.0,
        measured=MILLIMETRES * heavy,
        tolerance=MILLIMETRES * ROUND_OFF,
        observation=f"A weight of one tonne sags by {MILLIMETRES * heavy:.4f} mm as well.",
    ))
    fine = np.geomspace(1.0 / 500.0, 1.0 / 20.0, 40)
    dots = np.array([1.0 / 480.0, 1.0 / 240.0, 1.0 / 120.0, 1.0 / 60.0, 1.0 / 30.0])
    drawn = []
    for n, name in ((1, "1 sweep"), (3, "3 sweeps")):
        bounds = G * fine**2 * 0.5**n / (1.0 - 0.5**n)
        chains = [settle(lesson, "pbd_step", network([1.0], 0.5, 0.0, n), straight(1), dt, steps) for dt in dots]
        sags = [stretch(x)[0] for x in chains]
        drawn += [
            series(f"{name}, theory", np.log10(fine), np.log10(MILLIMETRES * bounds), LINE),
            series(f"{name}, measured", np.log10(dots), np.log10(MILLIMETRES * np.array(sags)), DOTS),
        ]
    return found, Picture(
        "A link that PBD leaves soft",
        "log₁₀ of dt [s]",
        "log₁₀ of the sag [mm]",
        drawn,
        "Half the step gives a quarter of the sag: a stiffness of 0.5 means nothing unless the step is given.",
    )


def chain_findings(lesson, N=8, alpha=1e-4):
    """Return the sag of a chain of N springs of 1/α under XPBD, for several numbers of sweeps and two steps.

    The rest position does not depend on the velocity that is lost on the way, so a tenth of it is taken in each step.
    """
    found, weights = [], np.ones(N)
    for sweeps, per_second in ((1, 60), (5, 60), (20, 60), (1, 240)):
        x, dt = straight(N), 1.0 / per_second
        p, v = network(weights, 1.0, alpha, sweeps), 0.0 * x
        for _ in range(10 * per_second):
            x, v = lesson.xpbd_step(lesson.network_gravity, 0.0, x, 0.9 * v, dt, p)
        predicted, got = left_over(weights, sweeps, dt, alpha).sum(), stretch(x).sum()
        found.append(finding(
            claim="A chain is as soft as its compliance says only when the sweeps have converged; before that it is "
                  "softer, by the amount that the theory of Gauss–Seidel iteration gives.",
            quantity=f"{N} springs, {sweeps} {'sweep' if sweeps == 1 else 'sweeps'} of 1/{per_second} s: sag [mm]",
            predicted=MILLIMETRES * predicted,
            measured=MILLIMETRES * got,
            tolerance=MILLIMETRES * SETTLED,
            observation=(f"The end hangs {MILLIMETRES * got:.2f} mm too low; the springs themselves would sag by "
                         f"{MILLIMETRES * alpha * G * 0.5 * N * (N + 1):.2f} mm."),
        ))
    return found


@case("compliance", "XPBD: a compliance of its own", compiled=False)
def compliance(lesson):
    """One spring under XPBD is implicit Euler, and sags by m g/k for any step and any number of sweeps.

    With (s, v) relative to rest and h = dt, implicit Euler is  (s, v) ← ((1, h), (−hω², 1))/(1 + h²ω²).  It settles by
    (1 + h²ω²)^(−1/2) per step.  With hω = 1, 80 steps leave 2⁻⁴⁰ = 1e-12 of the sag, whose 10 cm give SETTLED.

    A chain of springs is as soft as its compliance only when the sweeps have converged: see left_over.
    """
    found, m = chain_findings(lesson), 2.0
    for dt in (1.0 / 30.0, 1.0 / 60.0, 1.0 / 240.0):
        for n in (1, 7):
            k = m / dt**2
            got = stretch(settle(lesson, "xpbd_step", network([m], 1.0, 1.0 / k, n), straight(1), dt, 80))[0]
            found.append(finding(
                claim="A single spring sags by m g/k for any step and any number of sweeps.",
                quantity=f"sag, {n} sweeps of dt = 1/{round(1 / dt)} s, k = {k:.0f} N/m [mm]",
                predicted=MILLIMETRES * m * G / k,
                measured=MILLIMETRES * got,
                tolerance=MILLIMETRES * SETTLED,
                observation=f"A spring of {k:.0f} N/m under {m:g} kg sags by {MILLIMETRES * got:.5f} mm.",
            ))
    k, steps = 100.0, 60
    sag, omega = m * G / k, np.sqrt(k / m)
    drawn = []
    for dt in (0.02, 0.1):
        M = np.array([[1.0, dt], [-dt * omega**2, 1.0]]) / (1.0 + (dt * omega) ** 2)
        x, v = straight(1), np.array([[0.0, 0.0], [0.0, -1.0]])
        state, theory, run = np.array([-sag, 1.0]), [0.0], [0.0]
        for _ in range(steps):
            x, v = lesson.xpbd_step(lesson.network_gravity, 0.0, x, v, dt, network([m], 1.0, 1.0 / k, 3))
            state = M @ state
            theory.append(state[0] + sag)
            run.append(stretch(x)[0])
        got = np.abs(np.array(run) - theory).max()
        found.append(finding(
            claim="With one linear spring XPBD is implicit Euler.",
            quantity=f"largest difference from implicit Euler in {steps} steps of {dt:g} s [m]",
            predicted=0.0,
            measured=got,
            tolerance=ROUND_OFF,
            observation=(f"In {steps} steps of {dt:g} s a weight on a spring stays within {got:.0e} m of implicit "
                         "Euler."),
        ))
        drawn += [
            series(f"implicit Euler, dt = {dt:g} s", dt * np.arange(steps + 1), MILLIMETRES * np.array(theory), LINE),
            series(f"XPBD, dt = {dt:g} s", dt * np.arange(steps + 1), MILLIMETRES * np.array(run), DOTS),
        ]
    shown = round(1.2 / 0.02) + 1                # points
    cut = [(label, ts[:shown], ys[:shown], style) for label, ts, ys, style in drawn]
    return found, Picture(
        "A spring under XPBD",
        "t [s]",
        "stretch [mm]",
        cut,
        ("Every step finds the same rest position. How fast the oscillation decays depends on dt, as with implicit "
         "Euler."),
    )


def left_over(masses, sweeps, dt, alpha=0.0):
    """Return the exact stretch [m] of each link of a chain at rest under PBD or XPBD, left by n Gauss–Seidel sweeps.

    Each step falls by g dt², which Λ* (the weight below, times dt²) would undo.  n sweeps solve B Λ = b up to Gⁿ, with
    B = A + α/dt², A = J W Jᵀ, G = 1 − L⁻¹B and B's lower triangle L.  At rest Λ = (1 − Gⁿ) B⁻¹ b equals Λ*, and the
    sweeps leave  b − AΛ* = B (1 − Gⁿ)⁻¹ Gⁿ Λ* + α/dt² Λ*,  of which the last part is Hooke's law.
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


@case("unconverged-iterations", "Too few sweeps look soft", compiled=False)
def unconverged_iterations(lesson):
    """With too few sweeps a chain of N weights stretches: after one sweep link k is too long by (N − k) g dt².

    The last visit to link k + 1 has moved point k down by the error of that link: the weights below k times dt²/m.
    In total the end is ½N(N − 1) g dt² too low; n sweeps leave less (left_over).  `patience` is the number of steps
    to rest.
    """
    found, N, dt = [], 8, 1.0 / 60.0
    x = straight(N)
    for sweeps in (1, 5, 20):
        bound = left_over([1.0] * N, sweeps, dt)
        got = stretch(settle(lesson, "pbd_step", network([1.0] * N, 1.0, 0.0, sweeps), x, dt, patience(N, sweeps)))
        found.append(finding(
            claim="With too few sweeps a chain is soft, by the amount that the theory of Gauss–Seidel iteration gives.",
            quantity=f"{N} links, {sweeps} {'sweep' if sweeps == 1 else 'sweeps'} of 1/60 s: end too low by [mm]",
            predicted=MILLIMETRES * bound.sum(),
            measured=MILLIMETRES * got.sum(),
            tolerance=MILLIMETRES * SETTLED,
            observation=(f"With {sweeps} {'sweep' if sweeps == 1 else 'sweeps'} a chain of {N} m hangs "
                         f"{MILLIMETRES * got.sum():.3f} mm too low."),
        ))
        if sweeps == 1:
            worst = np.abs(got - G * dt * dt * (N - 1.0 - np.arange(N))).max()
            found.append(finding(
                claim="After a single sweep link k is too long by (N − k) g dt².",
                quantity="largest departure from (N − k) g dt² [mm]",
                predicted=0.0,
                measured=MILLIMETRES * worst,
                tolerance=MILLIMETRES * SETTLED,
                observation=f"The links are too long by (N − k) g dt², to within {MILLIMETRES * worst:.0e} mm.",
            ))
    fine, dots = np.arange(1, 61), (1, 2, 5, 10, 20)
    bounds = [left_over([1.0] * N, n, dt).sum() for n in fine]
    low = lambda n: stretch(settle(lesson, "pbd_step", network([1.0] * N, 1.0, 0.0, n), x, dt, patience(N, n))).sum()
    return found, Picture(
        "Sweeps and softness",
        "log₁₀ of the sweeps",
        "log₁₀ of how much too low [mm]",
        [
            series("theory", np.log10(fine), [np.log10(MILLIMETRES * y) for y in bounds], LINE),
            series("PBD, measured", np.log10(dots), [np.log10(MILLIMETRES * low(n)) for n in dots], DOTS),
        ],
        ("The effect of the fixed end travels slowly down the chain. At first twice the sweeps give half the "
         "softness, and a stiff chain needs hundreds."),
    )


@case("mass-ratio", "Mass ratio of a chain", compiled=False)
def mass_ratio(lesson):
    """Mass ratio: M hangs under m, r = M/m, and each sweep leaves r/(1 + r) of the error.

    A visit to the upper link moves m by its whole error c, which makes the lower link wrong by c.  The visit to the
    lower link gives the share w_m/(w_m + w_M) = r/(1 + r) back to m, and that is the new error of the upper link.

    c is known to 1e-15 of 1 m and begins at 0.01 m.  Over five sweeps the ratio is known to 1e-11 where r ≥ 1.
    """
    found, ratios, measured, needed = [], (1.0, 10.0, 100.0, 1e4), [], []
    for r in ratios:
        # The lower link starts too long: the first sweep makes the upper one wrong.

        p = network([1.0, r])
        x = straight(2)
        errors = []
        x[2, 1] -= 0.01
        while len(errors) < 7 or (abs(errors[-1]) > 1e-3 * abs(errors[1]) and r <= 100.0):
            errors.append(stretch(x)[0])
            x = lesson.distance_sweep(x, p)
        contraction = (errors[6] / errors[1]) ** 0.2
        measured.append(contraction)
        found.append(finding(
            claim="With a heavy weight under a light one each sweep leaves r/(1 + r) of the error.",
            quantity=f"share of the error that a sweep leaves at a mass ratio of {r:g} [-]",
            predicted=r / (1.0 + r),
            measured=contraction,
            tolerance=1e-11,
            observation=f"At a mass ratio of {r:g} a sweep leaves {contraction:.6f} of the error.",
        ))
        if r <= 100.0:
            bound = 1.0 + np.ceil(np.log(1e-3) / np.log(r / (1.0 + r)))  # the first sweep makes the upper link wrong
            needed.append(len(errors) - 1)
            found.append(finding(
                claim=("A reduction to a thousandth takes about 6.9 (r + ½) sweeps after the first, which makes the "
                       "upper link wrong."),
                quantity=f"sweeps to a thousandth of the error at a mass ratio of {r:g} [-]",
                predicted=bound,
                measured=len(errors) - 1,
                tolerance=0.0,
                observation=(f"At a mass ratio of {r:g} a thousandth of the error is left after {len(errors) - 1} "
                             "sweeps."),
            ))
    fine = np.geomspace(1.0, 1e4, 60)
    return found, Picture(
        "A heavy weight under a light one",
        "log₁₀ of the mass ratio",
        "log₁₀ of (1 − share that a sweep leaves)",
        [
            series("theory: 1/(1 + r)", np.log10(fine), -np.log10(1.0 + fine), LINE),
            series("distance_sweep, measured", np.log10(ratios), np.log10(1.0 - np.array(measured)), DOTS),
        ],
        ("A mass ratio of a hundred needs about sixty times the sweeps of equal masses. Where you can, hang the "
         "light weight under the heavy one."),
    )


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


@case("projection-dissipation", "What projection takes from what turns", compiled=False)
def projection_dissipation(lesson):
    """Projection slows a weight that circles on a string without gravity.

    A step goes along the last chord and is projected back radially:  tan β = sin α/(2 − cos α)  for the next angle,
    after tan α = ω dt for the first.  β ≈ α − α³, so 1/α² grows by 2 per step and  ω_N ≈ ω/√(1 + 2N(ω dt)²).  The
    loss is twice that of a curved wall (friction/curved-wall-order).  PBD and the projection method lose the same.
    """
    found, steps, drawn = [], 200, []
    for turn in (0.2, 0.05):
        theory = [np.arctan(turn)]
        for _ in range(steps - 1):
            theory.append(np.arctan(np.sin(theory[-1]) / (2.0 - np.cos(theory[-1]))))
        for step, label in (("pbd_step", "PBD"), ("constraint_projection_step", "constraint_correction")):
            got = circling(lesson, step, turn, steps)
            found.append(finding(
                claim=("Projection slows a circling weight: tan β = sin α/(2 − cos α), so 1/ω² grows by nearly 2 dt² "
                       "per step."),
                quantity=f"{label}: speed left after {steps} steps at ω dt = {turn} [-]",
                predicted=theory[-1] / turn,
                measured=got[-1] / turn,
                tolerance=1e-10,
                observation=(f"At ω dt = {turn} {label} keeps {100.0 * got[-1] / turn:.2f} % of the speed for {steps} "
                             "steps."),
            ))
            if label == "PBD":
                drawn += [
                    series(
                        f"ω dt = {turn}: 1/√(1 + 2N(ω dt)²)",
                        np.arange(steps),
                        1.0 / np.sqrt(1.0 + 2.0 * np.arange(steps) * turn**2),
                        LINE,
                    ),
                    series(f"ω dt = {turn}: PBD", np.arange(0, steps, 10), got[::10] / turn, DOTS),
                ]
    rattle = circling(lesson, "rattle_step", 0.2, steps)
    found.append(finding(
        claim="With gradients taken at the start of the step no speed is lost.",
        quantity="RATTLE: variation of the angle per step in 200 steps [rad]",
        predicted=0.0,
        measured=np.ptp(rattle),
        tolerance=1e-11,
        observation=f"Under RATTLE every step turns by the same angle, to within {np.ptp(rattle):.0e} rad.",
    ))
    return found, Picture(
        "A weight that turns on a string",
        "steps",
        "speed left [-]",
        drawn,
        "No force slows this weight: the loss comes from the corners of the polygon that replaces the circle.",
    )


@case("substeps-vs-iterations", "Substeps against sweeps", compiled=False)
def substeps_vs_iterations(lesson):
    """Substeps compared with sweeps: n sweeps of one step, or n steps with one sweep each, for the same work per frame.

    n sweeps leave a softness of  A (1 − Gⁿ)⁻¹ Gⁿ Λ*, at first about 1/n of that of one sweep.  n substeps leave
    ½N(N − 1) g (dt/n)², which is 1/n² of it.  But sweeps converge: from some 3 N² visits on, Gⁿ is the smaller one.
    """
    found, N, frame = [], 8, 1.0 / 60.0
    x, once = straight(N), 0.5 * N * (N - 1) * G * frame**2
    ways = {
        "sweeps": lambda n: settle(lesson, "xpbd_step", network([1.0] * N, sweeps=n), x, frame, patience(N, n)),
        "substeps": lambda n: settle(lesson, "xpbd_step", network([1.0] * N), x, frame / n, patience(N, 1)),
    }
    theory = {"sweeps": lambda n: left_over([1.0] * N, n, frame).sum(), "substeps": lambda n: once / n**2}
    for way, n in itertools.product(ways, (10, 300)):
        got, bound = stretch(ways[way](n)).sum(), theory[way](n)
        found.append(finding(
            claim="n substeps are n² times as stiff as one step with one sweep, and n sweeps are not, unless they are "
                  "so many that they have converged.",
            quantity=f"{n} {way} per frame: end of {N} links too low by [mm]",
            predicted=MILLIMETRES * bound,
            measured=MILLIMETRES * got,
            tolerance=MILLIMETRES * SETTLED,
            observation=f"With {n} {way} per frame a chain of {N} m hangs {MILLIMETRES * got:.2g} mm too low.",
        ))
    fine, dots = np.arange(1, 31), (1, 2, 5, 10)
    drawn = []
    for way in ways:
        bounds = [theory[way](n) for n in fine]
        low = [stretch(ways[way](n)).sum() for n in dots]
        drawn += [
            series(f"{way}, theory", np.log10(fine), np.log10(MILLIMETRES * np.array(bounds)), LINE),
            series(f"{way}, measured", np.log10(dots), np.log10(MILLIMETRES * np.array(low)), DOTS),
        ]
    return found, Picture(
        "Where to spend the visits of a frame",
        "log₁₀ of the visits to a link",
        "log₁₀ of how much too low [mm]",
        drawn,
        ("For the same work the slope is twice as steep: short steps are worth more than many sweeps, up to some 3 N² "
         "visits."),
    )


def impossible_input(lesson):
    """Ask for what no network can be."""
    x = straight(2)
    three = np.zeros((4, 3))
    flat = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 0.0]])
    same, pairs = 0.0 * x, [(0, 1), (1, 2)]
    valid = {
        "x": x,
        "m": 1.0,
        "fixed": [0],
        "pairs": pairs,
        "alpha": 0.0,
        "stiffness": 1.0,
        "gravity": (0.0, -G),
        "sweeps": 1,
    }
    make = lambda **more: lesson.make_constraint_network(*(valid | more).values())
    asked = (
        lambda: make(alpha=-1e-3),
        lambda: make(alpha=np.nan),
        lambda: make(fixed=[0, 1]),
        lambda: make(x=same),
        lambda: make(x=x * np.nan),
        lambda: make(m=0.0),
        lambda: make(m=-1.0),
        lambda: make(stiffness=0.0),
        lambda: make(stiffness=1.5),
        lambda: make(sweeps=0),
        lambda: make(gravity=(0.0, np.inf)),
        lambda: lesson.distance_constraint(x[0], x[0], 1.0),
        lambda: lesson.constraint_correction(1.0, np.ones((2, 3)), np.zeros(2)),
        lambda: lesson.constraint_correction(1.0, np.zeros((2, 3)), np.ones(2)),
        lambda: lesson.distance_sweep(same, network([1.0, 1.0])),
        lambda: lesson.compliant_sweep(same, np.zeros(2), 0.1, network([1.0, 1.0])),
        lambda: lesson.fold_constraint(three, 0.0),
        lambda: lesson.fold_constraint(flat, 0.0),
        lambda: lesson.compliant_multiplier(0.1, 0.0, 1.0, -1e-3),
        lambda: lesson.compliant_multiplier(0.1, 0.0, 0.0, 0.0),
        lambda: lesson.compliant_multiplier(0.1, 0.0, 1.0, np.nan),
    )
    refused = sum(refuses(call) for call in asked)
    return [finding(
        claim="Impossible input is refused by name.",
        quantity=f"calls that end in BadInput [of {len(asked)}]",
        predicted=len(asked),
        measured=refused,
        tolerance=0.0,
        observation=f"{refused} of {len(asked)} impossible inputs are refused.",
    )]


def falls_on_a_very_soft_spring(lesson):
    """Hang a weight on a compliance of 10¹² m/N for half a second."""
    dt, steps = 0.01, 50
    fallen = stretch(settle(lesson, "xpbd_step", network([1.0], 1.0, 1e12), straight(1), dt, steps))[0]
    bound = 0.5 * G * steps * dt * (steps + 1) * dt
    return [finding(
        claim="A spring of vanishing stiffness lets the weight fall freely.",
        quantity="fall of a weight on a compliance of 10¹² m/N in ½ s [m]",
        predicted=bound,
        measured=fallen,
        tolerance=1e-11,
        observation=f"On a compliance of 10¹² m/N a weight falls {fallen:.6f} m in half a second.",
    )]


def without_compliance(lesson):
    """Move a chain by XPBD and by PBD."""
    x, dt, steps = straight(2), 0.01, 50
    stiff, hard = (
        settle(lesson, step, network([1.0, 1.0], 1.0, 0.0, 5), x, dt, steps) for step in ("xpbd_step", "pbd_step")
    )
    return [finding(
        claim="Without compliance XPBD is PBD.",
        quantity="largest difference after 50 steps [m]",
        predicted=0.0,
        measured=np.abs(stiff - hard).max(),
        tolerance=ROUND_OFF,
        observation="Without compliance XPBD and PBD give the same positions.",
    )]


def mass_ratio_of_a_million(lesson):
    """Hang a heavy weight on a light one, with ten sweeps."""
    x = straight(2)
    ratio, dt, lengths = 1e6, 1.0 / 60.0, []
    y, v, p = x, 0.0 * x, network([1.0, ratio], 1.0, 0.0, 10)
    for _ in range(300):
        y, v = lesson.pbd_step(lesson.network_gravity, 0.0, y, v, dt, p)
        lengths.append(max(stretch(y).sum(), 0.0))
    bounded = max(lengths) <= 0.5 * G * (301 * dt) ** 2 and np.all(np.isfinite(y))
    return [finding(
        claim="At a mass ratio of a million the chain is soft but stays stable: it never falls faster than freely.",
        quantity="runs at a mass ratio of 10⁶ that stay below free fall [of 1]",
        predicted=1,
        measured=int(bounded),
        tolerance=0.0,
        observation=f"At a mass ratio of a million 10 sweeps leave a chain {max(lengths):.2f} m too long.",
    )]


@case("extremes", "Extremes of constraints", compiled=False)
def extremes(lesson):
    """Extremes: impossible input is refused, and extreme but valid input gives the right limit.

    With a compliance of 10¹² m/N the spring has no effect: the weight falls by ½g t(t + dt) in t.  At a mass ratio
    of 10⁶ ten sweeps hardly hold the chain.  A projection can only shorten a link that is too long, so the chain
    falls no faster than freely.
    """
    found = impossible_input(lesson) + falls_on_a_very_soft_spring(lesson) + without_compliance(lesson)
    found += mass_ratio_of_a_million(lesson)
    exponents = np.linspace(-9.0, 0.0, 10)
    sags = [
        stretch(settle(lesson, "xpbd_step", network([1.0], 1.0, 10.0**y, 1), straight(1), 1.0, 400))[0]
        for y in exponents
    ]
    return found, Picture(
        "Any compliance",
        "log₁₀ of the compliance [m/N]",
        "log₁₀ of the sag [m]",
        [
            series("theory: α m g", exponents, np.log10(G) + exponents, LINE),
            series("XPBD, steps of a second", exponents, np.log10(sags), DOTS),
        ],
        "From a nanometre per newton to a metre per newton, with steps of a whole second: no stiffness is too high.",
    )


def nowhere(lesson):
    """Return an obstacle that nothing reaches."""
    return lesson.Obstacle(np.array([0.0, 0.0, -9.0]), 0.0, np.array([0.0, 0.0, -9.0]), np.array([0.0, 0.0, 1.0]))


def fold_reaches_its_angle(lesson):
    """Visit one fold of two triangles twelve times."""
    x = np.array([[0.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 0.4, 0.1], [-0.9, 0.6, 0.5]])
    loose = ConstraintNetwork(
        np.array([1.0, 2.0, 1.0, 0.5]),
        np.zeros(3),
        np.zeros(0, dtype=np.int64),
        np.zeros(0, dtype=np.int64),
        np.zeros(0),
        np.zeros(0),
        np.zeros(0),
        1,
    )
    sheet = lesson.Cloth(loose, np.array([[0, 1, 2, 3]]), np.array([0.2]), 1.0, nowhere(lesson))
    centre = x.T @ (1.0 / loose.inv_mass)
    for _ in range(12):
        x = lesson.fold_sweep(x, sheet)
    left = abs(lesson.fold_constraint(x, 0.2)[0])
    shift = np.abs(x.T @ (1.0 / loose.inv_mass) - centre).max()
    return [
        finding(
            claim="A fold reaches its rest angle.",
            quantity="error of the angle after 12 visits [rad]",
            predicted=0.0,
            measured=left,
            tolerance=ROUND_OFF,
            observation=f"After 12 visits the fold is {left:.0e} rad off.",
        ),
        finding(
            claim="Folding exerts no net force.",
            quantity="displacement of the centre of mass, times the mass [kg m]",
            predicted=0.0,
            measured=shift,
            tolerance=ROUND_OFF,
            observation=f"Times the mass, its centre of mass has moved by {shift:.0e} kg m.",
        ),
    ]


def ball_reaches_its_volume(lesson):
    """Fill an octahedron with air; its links are almost infinitely compliant, so that only the air is tested."""
    corners = np.concatenate([[axis, -axis] for axis in np.eye(3)])
    faces = np.array([[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]])
    net_ = lesson.make_constraint_network(corners, 1.0, [], lesson.shared_edges(faces)[0], 1e9, 1.0, np.zeros(3), 5)
    y, v = corners * [1.2, 0.9, 1.0], 0.0 * corners
    # Newton's method: five visits square the error five times.
    ball = lesson.Balloon(net_, faces, 2.0, 0.0, nowhere(lesson))
    for _ in range(10):
        y, v = lesson.balloon_step(lesson.network_gravity, 0.0, y, v, 0.05, ball)
    volume, drift = lesson.volume_gradient(y, faces)[0], np.abs(v.sum(axis=0)).max()
    return [
        finding(
            claim="A ball reaches its rest volume.",
            quantity="volume [m³]",
            predicted=2.0,
            measured=volume,
            tolerance=1e-9,
            observation=f"The ball holds {volume:.9f} m³.",
        ),
        finding(
            claim="Its air exerts no net force.",
            quantity="momentum of the ball [kg m/s]",
            predicted=0.0,
            measured=drift,
            tolerance=1e-11,
            observation=f"Its momentum is {drift:.0e} kg m/s.",
        ),
    ]


HALF = 0.3                   # of the rod on a pivot [m]
MOMENT = (2.0 * HALF) ** 2 / 12.0


def make_rod(lesson):
    """Return a rod of 1 kg that hangs from one of its ends."""
    I_body, arm = np.array([MOMENT, MOMENT, 1e-4]), np.array([0.0, 0.0, HALF])
    return lesson.PivotedBody(1.0, I_body, np.array([0.0, 0.0, -G]), np.zeros(3), arm, 3)


def quarter_of(theta):
    """Return the quarter period [s] of a compound pendulum with the moment and the length of the rod."""
    return 0.25 * pendulum_period(theta, (MOMENT + HALF**2) / HALF, G)


def rod_swings(lesson):
    """Extrapolate the time that the rod takes to its lowest point."""
    theta, rod = 0.5, make_rod(lesson)
    bound = quarter_of(theta)
    quarters = [quarter_period(lesson, rod, HALF, theta, dt) for dt in (0.002, 0.001)]
    got, dt, omega = 2.0 * quarters[1] - quarters[0], 0.002, 0.5 * np.pi / bound
    return [finding(
        claim="A rigid rod that hangs from a point swings as a compound pendulum.",
        quantity="quarter period of a rod of 0.6 m, extrapolated [s]",
        predicted=bound,
        measured=got,
        tolerance=5.0 * (omega * dt) ** 2 * bound,
        observation=f"A rod of 0.6 m is at its lowest after {got:.5f} s.",
    )]


def cloth_stays_outside(lesson):
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
        depth = max(depth, 0.3 - np.linalg.norm(sheet - thrown.centre, axis=1).min(), -0.25 - sheet[:, 2].min())
    return [finding(
        claim="At the end of a step no point of a cloth is inside an obstacle.",
        quantity="greatest depth of a point in 40 steps [m]",
        predicted=0.0,
        measured=max(depth, 0.0),
        tolerance=ROUND_OFF,
        observation=("The points of a cloth that falls on a ball and a floor are never deeper than "
                     f"{max(depth, 0.0):.0e} m."),
    )]


@case("primitives", "A fold, a ball, a rod and a cloth", compiled=False)
def primitives(lesson):
    """Larger parts: a fold keeps its angle, a ball its volume, a rod its period, and no point stays inside an obstacle.

    A weightless fold of stiffness 1 reaches its angle by Newton's method in a few visits.  A ball without gravity
    and with no compliance of its air settles at its volume.  Neither exerts a network external force.  The rod's
    quarter period, extrapolated from steps of dt and dt/2, is off by a few (ω dt)² of its value.
    """
    found = fold_reaches_its_angle(lesson) + ball_reaches_its_volume(lesson) + rod_swings(lesson)
    found += cloth_stays_outside(lesson)
    fine, dots = np.linspace(0.1, 2.5, 40), np.array([0.25, 0.5, 1.0, 1.5, 2.0])
    rod = make_rod(lesson)
    return found, Picture(
        "A rod on a pivot",
        "released at [rad]",
        "time to its lowest point [s]",
        [
            series("theory", fine, [quarter_of(a) for a in fine], LINE),
            series(
                "pivoted_body_step, 5 ms, measured", dots,
                [quarter_period(lesson, rod, HALF, a, 0.005) for a in dots], DOTS
            ),
        ],
        "To constrain a rigid body, projection needs the generalised inverse mass and nothing else that a point lacks.",
    )


def quarter_period(lesson, rod, half, theta, dt):
    """Return the time [s] at which a rod released at the angle θ about y passes its lowest point.

    The crossing is interpolated linearly between two steps.
    """
    q = np.array([np.cos(0.5 * theta), 0.0, -np.sin(0.5 * theta), 0.0])
    x, v, omega, t = half * np.array([np.sin(theta), 0.0, -np.cos(theta)]), np.zeros(3), np.zeros(3), 0.0
    while x[0] > 0.0 and t < 2.0:
        before = x[0]
        x, q, v, omega = lesson.pivoted_body_step(t, x, q, v, omega, dt, rod)
        t += dt
    return t - dt * x[0] / (x[0] - before)


# ---------------------------------------------------------------------------------------------- each part by itself

TRIED = 40                   # random configurations [-]
IMAGINARY = 1e-20            # step of a derivative along the imaginary axis [m]


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


def euler_rate(R, omega, I_body):
    """Return ω̇ of a free body, by matrices in the world."""
    I = R @ np.diag(I_body) @ R.T
    return np.linalg.solve(I, -np.cross(omega, I @ omega))


def wxyz(rotation):
    """Return the quaternion (w, x, y, z) of one of SciPy's rotations."""
    return np.roll(rotation.as_quat(), 1)


@case("constraints-and-their-gradients", "Constraints, their gradients, and what a correction does", compiled=False)
def constraints_and_gradients(lesson):
    """A gradient is the derivative of its constraint, taken along the imaginary axis; rotations are SciPy's.

    A correction satisfies its linearised constraint with the least Σ m |Δx|².  Newton's method is compared with a
    dense solution of both equations, linearised along the imaginary axis; its regularisation is 1e-13 of the weights.
    """
    rng = np.random.default_rng(81)
    nowhere = lesson.Obstacle(np.full(3, 50.0), 0.0, np.array([0.0, 0.0, -50.0]), np.array([0.0, 0.0, 1.0]))
    worst = Worst()

    for _ in range(TRIED):
        x, w, rest = rng.normal(size=(4, 3)), rng.uniform(0.5, 2.0, 4), rng.uniform(0.5, 2.0)
        link = lambda end, other=x[1], rest=rest: size_of(end - other) - rest
        worst.note("link", lesson.distance_constraint(x[0], x[1], rest), (link(x[0]), derivative(link, x[0])))
        C, g = rng.normal(), rng.normal(size=(4, 3))
        least = -C * (w[:, None] * g) / np.sum(w[:, None] * g * g)
        worst.note("correction", lesson.constraint_correction(C, g, w), least)

        fold = rng.uniform(-3.0, 3.0)
        C = fold_angle(x) - fold
        bent = C - 2.0 * np.pi * np.round(C / (2.0 * np.pi))
        slope = derivative(fold_angle, x).reshape(4, 3)
        got_C, got_slope = lesson.fold_constraint(x, fold)
        worst.note("fold", (got_C, got_slope / np.max(np.abs(slope))), (bent, slope / np.max(np.abs(slope))))
        obstacle = lesson.Obstacle(x[1], rest, x[2], np.array([0.0, 0.0, 1.0]))
        worst.note("ball", lesson.ball_gap(x[0], obstacle), (link(x[0]), derivative(link, x[0])))
        faces = np.array([[0, 1, 2], [0, 3, 1], [0, 2, 3], [1, 3, 2]])
        far = x + np.array([3.0, -2.0, 4.0])                     # the origin is outside: some faces count negative
        V = lambda x, faces=faces: volume_of(x, faces)
        worst.note("volume", lesson.volume_gradient(far, faces), (V(x), derivative(V, far)))

        # three links of four points in a row, the first one fixed, from a guess that breaks them
        chain = lesson.make_constraint_network(x, 1.0 / w, [0], [(0, 1), (1, 2), (2, 3)], 0.0, 1.0, (0.0, 0.0, -G), 1)
        (guess, goal), lam, dt = x + 0.1 * rng.normal(size=(2, 4, 3)), rng.normal(size=3), 0.1
        guess[0] = goal[0] = x[0]

        def laws(y, chain=chain, goal=goal, dt=dt):
            here, lam = y[:12].reshape(4, 3), y[12:]
            r, pull = here[:-1] - here[1:], np.zeros((4, 3), dtype=y.dtype)
            lengths = np.sqrt(np.sum(r * r, axis=1))
            pull[:-1] += lam[:, None] * r / lengths[:, None]
            pull[1:] -= lam[:, None] * r / lengths[:, None]
            moved = here - goal - dt * dt * chain.inv_mass[:, None] * pull
            return np.concatenate((moved.ravel(), lengths - chain.rest))

        y = np.concatenate((guess.ravel(), lam))
        truth = y - np.linalg.solve(derivative(laws, y), laws(y))
        change, forces = lesson.newton_correction(guess, lam, goal, dt, chain)
        scale = np.max(np.abs(truth))
        worst.note("newton", np.concatenate(((guess + change).ravel(), forces)) / scale, truth / scale)

        # a law of time, place and velocity; the first point is driven and feels nothing, inside a ball, too
        t, v = rng.uniform(0.0, 6.0), rng.normal(size=(4, 3))
        pushed = np.sin(t) * x - 0.3 * v + 1.0
        pushed[0] = 0.0
        shaken = lesson.predict(lambda t, x, v, p: np.sin(t) * x - 0.3 * v + 1.0, t, x, v, dt, chain)
        worst.note("driven", shaken, x + dt * v + dt * dt * pushed)
        ball = lesson.Obstacle(x[0] + 0.1, 1.5, np.zeros(3), np.array([0.0, 0.0, 1.0]))
        r = x - ball.centre
        out = ball.centre + r * np.maximum(1.0, ball.radius / np.linalg.norm(r, axis=1))[:, None]
        out[0] = x[0]
        worst.note("outside", lesson.keep_outside(lesson.ball_gap, x, chain.inv_mass, ball), out)
        held, _ = lesson.constraint_projection_step(lesson.network_gravity, t, x, 3.0 * v, 0.01, chain)
        worst.note("exact", np.linalg.norm(held[:-1] - held[1:], axis=1), chain.rest)

        # points that all feel the same move as one, by the mean of both accelerations; RATTLE is given
        free, one = chain._replace(inv_mass=w), np.tile(v[:1], (4, 1))
        felt = [np.cos(time) * np.ones((4, 3)) for time in (t, t + dt)]
        got = lesson.rattle_step(lambda t, x, v, p: np.cos(t) * np.ones(x.shape), t, x, one, dt, free)
        worst.note("as one", got, (x + dt * one + 0.5 * dt * dt * felt[0], one + 0.5 * dt * (felt[0] + felt[1])))

        # one visit to each of two links that share no point and have nothing in common
        rests, stiff, alphas = rng.uniform(0.5, 2.0, size=(3, 2))
        pair = lesson.make_constraint_network(x, 1.0 / w, [], [(0, 1), (2, 3)], alphas, 0.5 * stiff, (0.0, 0.0, -G), 1)
        pair, r = pair._replace(rest=rests), x[[0, 2]] - x[[1, 3]]
        lengths, kept = np.linalg.norm(r, axis=1), lambda y, w=w: (y / w[:, None])[[0, 2]] + (y / w[:, None])[[1, 3]]
        wish = (lengths - 0.5 * stiff * (lengths - rests))[:, None] * r / lengths[:, None]
        swept = lesson.distance_sweep(x, pair)
        worst.note("visit", (swept[[0, 2]] - swept[[1, 3]], kept(swept)), (wish, kept(x)))
        before = rng.normal(size=2)
        swept, after = lesson.compliant_sweep(x, before, dt, pair)
        new = swept[[0, 2]] - swept[[1, 3]]
        push = (after - before)[:, None] * r / lengths[:, None]
        truth = (rests - alphas / dt**2 * after)[:, None] * r / lengths[:, None]
        worst.note("spring", (new, (swept - x)[[0, 2]], (swept - x)[[1, 3]]),
                   (truth, w[[0, 2], None] * push, -w[[1, 3], None] * push))

        # rigid bodies with three different moments, turned anyhow
        m, I_body, turn = rng.uniform(0.5, 2.0), rng.uniform(1.0, 1.9, 3), Rotation.random(rng=rng)
        R, q, (r, n, p, omega) = turn.as_matrix(), wxyz(turn), rng.normal(size=(4, 3))
        inverse = R @ np.diag(1.0 / I_body) @ R.T
        lever = np.cross(r, n)
        weight = 1.0 / m + lever @ inverse @ lever
        worst.note("lever", lesson.effective_inverse_mass_at(q, r, n, m, I_body), weight)
        phi = inverse @ np.cross(r, p)
        tan_turn = lambda phi: Rotation.from_rotvec(2.0 * np.arctan(0.5 * size_of(phi)) / size_of(phi) * phi)
        new_x, new_q = lesson.apply_positional_impulse(x[0], q, r, p, m, I_body)
        after = wxyz(tan_turn(phi) * turn)
        worst.note("impulse", (new_x, np.sign(new_q @ after) * new_q), (x[0] + p / m, after))
        dt = rng.uniform(0.2, 0.8)
        after = wxyz(tan_turn(dt * omega) * turn)
        worst.note("rate", (lesson.turning_rate(q, after, dt), lesson.turning_rate(q, -after, dt)), (omega, omega))
        body = lesson.PivotedBody(m, I_body, np.zeros(3), x[0], np.zeros(3), 2)        # held at its centre: it is free
        *_, new_omega = lesson.pivoted_body_step(0.0, x[0], q, np.zeros(3), omega, 0.01, body)
        worst.note("free", new_omega, omega + 0.01 * euler_rate(R, omega, I_body))

        # a fold of half the stiffness goes half of a small way; a cloth in the air falls as one
        share, slight = rng.uniform(0.2, 0.8), np.array([[0, 1, 2, 3]])
        sheet = lesson.Cloth(chain._replace(inv_mass=w), slight, np.array([fold_angle(x) - 1e-6]), share, nowhere)
        left = (fold_angle(lesson.fold_sweep(x, sheet)) - sheet.fold[0]) / 1e-6
        worst.note("bent", left, 1.0 - share)
        mixed = np.array([2, 0, 3, 1])                          # the same sheet with other numbers of its points
        renamed = sheet._replace(network=chain._replace(inv_mass=w[np.argsort(mixed)]), hinges=mixed[None])
        got = lesson.fold_sweep(x[np.argsort(mixed)], renamed)[mixed] - x
        worst.note("numbers", got / 1e-6, (lesson.fold_sweep(x, sheet) - x) / 1e-6)
        worst.note("numbers", np.sum(got / w[:, None], axis=0) / 1e-6, 0.0)
        weave = lesson.make_constraint_network(x, 1.0 / w, [], [(0, 1), (1, 2), (2, 3)], 0.0, 1.0, (0.0, 0.0, -G), 2)
        sheet = lesson.Cloth(weave, slight, np.array([fold_angle(x)]), share, nowhere)
        fallen, v = lesson.cloth_step(lesson.network_gravity, 0.0, x, 0.0 * x + p, 0.01, sheet)
        speed = p - np.array([0.0, 0.0, 0.01 * G])
        worst.note("falls", (fallen, v), (x + 0.01 * speed, 0.0 * x + speed))

        # air that is hardly compressed: p = (V₀ − V)/α for one implicit step, m v = dt p ∇V, all linear
        alpha, less, dt = rng.uniform(0.5, 2.0), 1e-6, rng.uniform(0.1, 0.5)
        corners = rng.uniform(0.8, 1.2) * np.array([[1, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]])
        outside = faces if volume_of(corners, faces) > 0.0 else faces[:, ::-1]
        net = lesson.make_constraint_network(corners, 1.0 / w, [], [(0, 1)], 1e12, 1.0, np.zeros(3), 3)
        g = derivative(lambda x, f=outside: volume_of(x, f), corners).reshape(4, 3)
        _, v = lesson.balloon_step(lesson.network_gravity, 0.0, corners, 0.0 * corners, dt,
                                   lesson.Balloon(net, outside, volume_of(corners, outside) + less, alpha, nowhere))
        pressure = less / (alpha + dt * dt * np.sum(w[:, None] * g * g))
        worst.note("air", v / less, dt * pressure * w[:, None] * g / less)
    claims = (
        ("link", "The gradient of a link is the derivative of its length.", "link [m, -]", 1e-12),
        ("correction", "A correction meets its constraint with the least Σ m |Δx|².", "correction [m]", 1e-12),
        ("newton", "Newton's correction solves both linearised equations, with the curvature of the links.",
         "places and forces, relative [-]", 1e-6),
        ("fold", "The gradient of a fold is the derivative of its angle, which stays within half a turn.",
         "angle and gradient, relative [rad, -]", 1e-9),
        ("ball", "The normal of a ball is the derivative of the distance.", "gap and normal [m, -]", 1e-12),
        ("volume", "The gradient of a volume is its derivative, wherever the origin is.", "volume [m³, m²]", 1e-11),
        ("driven", "A point that cannot move keeps its velocity, and all others feel the force of their time.",
         "predicted place [m]", 1e-12),
        ("outside", "Points inside a ball go to its surface; one that cannot move stays.", "place [m]", 1e-12),
        ("exact", "After a step of the projection method every link has its length.", "length [m]", 1e-12),
        ("as one", "A network that feels the same everywhere moves as one, by the accelerations of both times.",
         "state [m, m/s]", 1e-9),
        ("numbers", "A visit to a fold keeps the centre of mass, however its points are numbered.", "way [-, kg]",
         1e-6),
        ("visit", "A visit leaves 1 − s of a link's error, and the centre of mass where it is.", "place [m, kg m]",
         1e-12),
        ("spring", "After a visit each link obeys Hooke's law with its own compliance.", "place [m]", 1e-9),
        ("lever", "A point of a body moves by 1/m + (r × n) · I⁻¹ (r × n), in world coordinates.", "weight [1/kg]",
         1e-11),
        ("impulse", "A positional impulse moves by p/m, and turns about I⁻¹ (r × p).", "place and turn [m, -]",
         1e-11),
        ("rate", "The rate of turning is the inverse of the update, for long turns, too.", "ω [rad/s]", 1e-9),
        ("free", "A body held at its centre obeys Euler's equation.", "ω [rad/s]", 1e-9),
        ("bent", "A visit to a fold leaves 1 − s of a small error.", "share of the error that is left [-]", 1e-3),
        ("falls", "A cloth in the air falls as one, and its velocity is its way over the step.", "state [m, m/s]",
         1e-9),
        ("air", "Air is a spring for the volume, whatever the step is.", "velocity over the missing volume [1/(m² s)]",
         1e-4))
    return [agreement(claim, f"{name}: largest error of the {quantity}", worst[name], tolerance)
            for name, claim, quantity, tolerance in claims], None


# ---------------------------------------------------------------------------------------------- inside out

CORNERS = np.array([(0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.3, 0.3, 1.0)])            # [m]
TETRAHEDRON = np.array([(0, 2, 1), (0, 1, 3), (1, 2, 3), (2, 0, 3)])    # faces, counter-clockwise seen from outside


def volume_restored(lesson, x, target):
    """Return the corners of a tetrahedron after Newton's method for V = target, all corners equally heavy."""
    for _ in range(60):
        V, gradient = lesson.volume_gradient(x, TETRAHEDRON)
        x = x + (target - V) / np.sum(gradient * gradient) * gradient
    return x


@case("inside-out", "A tetrahedron that is inside out", compiled=False)
def inside_out(lesson):
    """A corner that has passed through the face opposite makes the volume negative, and the gradient still points out.

    The mirror image has V → −V, and ∇V, an area times a direction, is mirrored and changes its sign.  So a correction
    along ∇V leads back through the face.  Lengths cannot do that: the mirror image has the same edges.  Flat, V = 0 and
    ∇V is the areas of the faces, so that a flat body is no obstacle; only a body that is a line has no gradient.
    """
    rng, errors = np.random.default_rng(31), Worst()
    mirror = np.diag((1.0, 1.0, -1.0))
    for _ in range(TRIED):
        x = CORNERS + rng.uniform(-0.2, 0.2, (4, 3))
        V, gradient = lesson.volume_gradient(x, TETRAHEDRON)
        errors.note("mirrored", lesson.volume_gradient(x @ mirror, TETRAHEDRON), (-V, -gradient @ mirror))
        errors.note("edges", length_of_edges(x @ mirror), length_of_edges(x))
        for height in (-1.0, 0.0):                         # of the fourth corner, over its own: inside out, and flat
            bottom = np.cross(x[1] - x[0], x[2] - x[0])
            bottom /= np.linalg.norm(bottom)
            turned = x.copy()
            turned[3] += (height - 1.0) * (bottom @ (x[3] - x[0])) * bottom
            end = volume_restored(lesson, turned, V)
            errors.note(f"restored {height:g}", volume_of(end, TETRAHEDRON), V)
    line = lesson.volume_gradient(np.outer(np.arange(4.0), (1.0, 2.0, 3.0)), TETRAHEDRON)
    return [
        agreement("The mirror image of a body has the negative volume, and the mirrored gradient with the other sign.",
                  "volume and gradient: largest error [m³, m²]", errors["mirrored"], ROUND_OFF),
        agreement("The mirror image has the same edges, so that no length can tell it.",
                  "edges: largest difference [m]", errors["edges"], ROUND_OFF),
        agreement("A volume leads a tetrahedron that is inside out back through its own face.",
                  "volume in the end, from inside out: largest error [m³]", errors["restored -1"], ROUND_OFF),
        agreement("A flat one gets its volume back, too.", "volume in the end, from flat: largest error [m³]",
                  errors["restored 0"], ROUND_OFF),
        agreement("Corners on a line have neither a volume nor a direction in which there would be one.",
                  "volume and gradient [m³, m²]", np.max(np.abs(flat(line))), 1e2 * ROUND_OFF),
    ], None


def length_of_edges(x):
    """Return the six lengths [m] of the edges of a tetrahedron."""
    return np.array([np.linalg.norm(x[i] - x[j]) for i in range(4) for j in range(i)])
