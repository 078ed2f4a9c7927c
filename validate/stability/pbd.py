"""How soft is what should not stretch, and what do sweeps and steps cost?  Theory's numbers for lesson 8 against those that runs find.

Cases 9, 12 and 81 to 86.  Nearly everything hangs straight down or turns in a circle, where a sweep is a linear map, and all of it can be said
beforehand.  *Source:* Müller et al. 2006, Macklin et al. 2016 and 2019; each case derives what it adds.
"""

import numpy as np

from solutions import integrators
from solutions.checks import Diverged
from solutions.pbd import Net
from validate.reference.pbd import pendulum_period
from validate.stability.case import DOTS, LINE, Picture, case, finding, refuses, series

G = 9.81                     # [m/s²]
MILLIMETRES = 1e3            # in a metre
ROUND_OFF = 1e-12            # of positions around 1 m, after a thousand visits [m]
SETTLED = 1e-10              # [m]: a run to rest goes on until less than this is left of where it began


def net(masses, stiffness=1.0, alpha=0.0, sweeps=1, g=G, l=1.0):
    """A Net of one hanging chain: masses [kg] from top to bottom under a fixed point, links of l [m]."""
    n = len(masses)
    return Net(np.array([0.0, *(1.0 / m for m in masses)]), np.array([0.0, -g]), np.arange(n), np.arange(1, n + 1), np.full(n, l), np.full(n, stiffness), np.full(n, alpha), sweeps)


def straight(n, l=1.0):
    """(n + 1, 2): such a chain, unstretched."""
    return np.stack((np.zeros(n + 1), -l * np.arange(n + 1.0)), axis=1)


def settle(lesson, step, p, x, dt, steps):
    """Where a chain is after so many steps from rest; not a number where it has not come to its end."""
    try:
        return integrators.advance(getattr(lesson, step), lesson.falling_acceleration, 0.0, x, 0.0 * x, dt, steps, p)[0]
    except Diverged:
        return np.full_like(x, np.nan)


def stretch(x, l=1.0):
    """How much too long each link of a chain is [m]."""
    return -np.diff(x[:, 1]) - l


@case("stiffness-depends-on-dt", "PBD is as soft as its step", compiled=False)
def stiffness_depends_on_dt(lesson):
    """PBD's own softness: a step lowers a weight by g dt², n sweeps leave S = (1 − s)ⁿ of the error; at rest (sag + g dt²) S = sag.

    A run approaches it by √S a step: y ← S (2y − y_before + g dt²) has the roots |z|² = S.  300 steps leave √0.75³⁰⁰ < 1e-18.
    """
    found, steps = [], 300
    for s, n, dt in ((0.5, 1, 1.0 / 60.0), (0.5, 1, 1.0 / 120.0), (0.5, 3, 1.0 / 60.0), (0.25, 1, 1.0 / 60.0)):
        S = (1.0 - s) ** n
        bound = G * dt * dt * S / (1.0 - S)
        name = f"stiffness {s}, {n} {'sweep' if n == 1 else 'sweeps'}, dt = 1/{round(1 / dt)} s"
        got = stretch(settle(lesson, "pbd_step", net([1.0], s, 0.0, n), straight(1), dt, steps))[0]
        found.append(finding(
            claim="PBD's stiffness is a matter of step and sweeps: a weight sags by g dt² S/(1 − S), S = (1 − s)ⁿ.",
            quantity=f"sag, {name} [mm]",
            predicted=MILLIMETRES * bound,
            measured=MILLIMETRES * got,
            tolerance=MILLIMETRES * ROUND_OFF,
            observation=f"With {name} a weight sags by {MILLIMETRES * got:.4f} mm.",
        ))
        said = lesson.pbd_sag(G, dt, s, n)
        found.append(finding(
            claim="The lesson's formula says so.",
            quantity=f"pbd_sag, {name} [mm]",
            predicted=MILLIMETRES * bound,
            measured=MILLIMETRES * said,
            tolerance=MILLIMETRES * ROUND_OFF,
            observation=f"pbd_sag says {MILLIMETRES * said:.4f} mm.",
        ))
    heavy = stretch(settle(lesson, "pbd_step", net([1000.0], 0.5), straight(1), 1.0 / 60.0, steps))[0]
    found.append(finding(
        claim="It does not ask for the weight: what hangs there is not a spring.",
        quantity="sag of a thousand times the mass [mm]",
        predicted=MILLIMETRES * G / 3600.0,
        measured=MILLIMETRES * heavy,
        tolerance=MILLIMETRES * ROUND_OFF,
        observation=f"A weight of a ton sags by {MILLIMETRES * heavy:.4f} mm as well.",
    ))
    fine, dots = np.geomspace(1.0 / 500.0, 1.0 / 20.0, 40), np.array([1.0 / 480.0, 1.0 / 240.0, 1.0 / 120.0, 1.0 / 60.0, 1.0 / 30.0])
    drawn = [part for n in (1, 3) for part in (
        series(f"{n} sweeps, theory" if n > 1 else "1 sweep, theory", np.log10(fine), np.log10(MILLIMETRES * G * fine**2 * 0.5**n / (1.0 - 0.5**n)), LINE),
        series(f"{n} sweeps, measured" if n > 1 else "1 sweep, measured", np.log10(dots),
               [np.log10(MILLIMETRES * stretch(settle(lesson, "pbd_step", net([1.0], 0.5, 0.0, n), straight(1), dt, steps))[0]) for dt in dots], DOTS))]
    return found, Picture("A link that PBD leaves soft", "log₁₀ of dt [s]", "log₁₀ of the sag [mm]", drawn, "Half the step, a quarter of the sag: nobody can say what stiffness 0.5 means without saying the step.")


@case("compliance", "XPBD: a compliance of its own", compiled=False)
def compliance(lesson):
    """XPBD: sag m g/k for any step and sweeps, and one spring is implicit Euler: (s, v) ← ((1, h), (−hω², 1))/(1 + h²ω²), h = dt, beside rest.

    It settles by (1 + h²ω²)^(−1/2) a step; with hω = 1, 80 steps leave 2⁻⁴⁰ = 1e-12 of the sag, and 10 cm of it: SETTLED.
    """
    found, m = [], 2.0
    for dt in (1.0 / 30.0, 1.0 / 60.0, 1.0 / 240.0):
        for n in (1, 7):
            k = m / dt**2
            got = stretch(settle(lesson, "xpbd_step", net([m], 1.0, 1.0 / k, n), straight(1), dt, 80))[0]
            found.append(finding(
                claim=("A compliance is a property of the spring: the weight sags by m g/k, whatever the step and "
                       "the sweeps."),
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
            x, v = lesson.xpbd_step(lesson.falling_acceleration, 0.0, x, v, dt, net([m], 1.0, 1.0 / k, 3))
            state = M @ state
            theory.append(state[0] + sag)
            run.append(stretch(x)[0])
        got = np.abs(np.array(run) - theory).max()
        found.append(finding(
            claim="With one linear spring XPBD is implicit Euler.",
            quantity=f"farthest from implicit Euler in {steps} steps of {dt:g} s [m]",
            predicted=0.0,
            measured=got,
            tolerance=ROUND_OFF,
            observation=(f"In {steps} steps of {dt:g} s a weight on a spring is never farther than {got:.0e} m from "
                         "implicit Euler's."),
        ))
        drawn += [series(f"implicit Euler, dt = {dt:g} s", dt * np.arange(steps + 1), MILLIMETRES * np.array(theory), LINE), series(f"XPBD, dt = {dt:g} s", dt * np.arange(steps + 1), MILLIMETRES * np.array(run), DOTS)]
    cut = [tuple(y[:round(1.2 / 0.02) + 1] if k else y for k, y in enumerate(part[:3])) + (part[3],) for part in drawn]
    return found, Picture("A spring under XPBD", "t [s]", "stretch [mm]", cut, "Every step finds the same rest; how fast the swing dies is up to the step, as with implicit Euler.")


def left_over(masses, sweeps, dt):
    """Stretch [m] of each link of a chain at rest under PBD, exactly: a linear system that n sweeps of Gauss and Seidel leave unsolved.

    Each step falls by g dt², which Λ* (the weight below, times dt²) would undo.  n sweeps solve A Λ = b up to Gⁿ, A = J W Jᵀ,
    G = 1 − L⁻¹A with A's lower triangle L.  At rest Λ = (1 − Gⁿ) A⁻¹ b is Λ*, and what is left is  b − AΛ* = A (1 − Gⁿ)⁻¹ Gⁿ Λ*.
    """
    n, w = len(masses), 1.0 / np.array(masses, dtype=float)
    A = np.diag(w + np.append(0.0, w[:-1])) - np.diag(w[:-1], 1) - np.diag(w[:-1], -1)
    power = np.linalg.matrix_power(np.eye(n) - np.linalg.solve(np.tril(A), A), sweeps)
    return A @ np.linalg.solve(np.eye(n) - power, power @ (G * dt * dt * np.cumsum(masses[::-1])[::-1]))


def patience(n, sweeps):
    """Steps until a chain of n equal weights is at rest but for 1e-12 of where it began:  E ← Gⁿ (2E − E_before),  |z|² = ρ(G)ⁿ.

    For such a matrix ρ(G) of Gauss and Seidel is the square of Jacobi's, cos²(π/(2N + 1)).
    """
    return int(np.ceil(np.log(1e-12) / (sweeps * np.log(np.cos(np.pi / (2.0 * n + 1.0)))))) + 10


@case("unconverged-iterations", "Too few sweeps look soft", compiled=False)
def unconverged_iterations(lesson):
    """Too few sweeps: a chain of N weights whose links should not stretch.  After one sweep link k is too long by (N − k) g dt²:

    the last visit to link k + 1 has moved point k down by what it is short of, the weights below k times dt²/m.  Altogether
    ½N(N − 1) g dt²; with n sweeps less (left_over).  A run of `patience` comes to rest.
    """
    found, N, dt = [], 8, 1.0 / 60.0
    x = straight(N)
    for sweeps in (1, 5, 20):
        bound = left_over([1.0] * N, sweeps, dt)
        got = stretch(settle(lesson, "pbd_step", net([1.0] * N, 1.0, 0.0, sweeps), x, dt, patience(N, sweeps)))
        found.append(finding(
            claim="With too few sweeps a chain is soft, by an amount that Gauss and Seidel know.",
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
                observation=f"The links are too long by (N − k) g dt², up to {MILLIMETRES * worst:.0e} mm.",
            ))
    fine = np.arange(1, 61)
    dots = (1, 2, 5, 10, 20)
    return found, Picture("Sweeps and softness", "log₁₀ of the sweeps", "log₁₀ of how much too low [mm]", [
        series("theory", np.log10(fine), [np.log10(MILLIMETRES * left_over([1.0] * N, n, dt).sum()) for n in fine], LINE),
        series("PBD, measured", np.log10(dots), [np.log10(MILLIMETRES * stretch(settle(lesson, "pbd_step", net([1.0] * N, 1.0, 0.0, n), x, dt, patience(N, n))).sum()) for n in dots], DOTS)],
        "News of the fixed end goes down a chain slowly: at first twice the sweeps give half the softness, and hundreds are needed for a hard chain.")


@case("mass-ratio", "Mass ratio of a chain", compiled=False)
def mass_ratio(lesson):
    """Mass ratio: M under m, r = M/m.  A visit to the upper link moves m by its whole error c, which makes the lower one wrong by c; a
    visit to that gives back the share w_m/(w_m + w_M) = r/(1 + r) to m, and the upper link has it again.

    c is known to 1e-15 of 1 m and begins at 0.01 m: over five sweeps the ratio is known to 1e-11 where r ≥ 1.
    """
    found, ratios, measured, needed = [], (1.0, 10.0, 100.0, 1e4), [], []
    for r in ratios:
        p, x, errors = net([1.0, r]), straight(2), []               # the lower link is too long: the first sweep spoils the upper one
        x[2, 1] -= 0.01
        while len(errors) < 7 or (abs(errors[-1]) > 1e-3 * abs(errors[1]) and r <= 100.0):
            errors.append(stretch(x)[0])
            x = lesson.distance_sweep(x, p)
        contraction = (errors[6] / errors[1]) ** 0.2
        measured.append(contraction)
        found.append(finding(
            claim="A heavy weight under a light one: each sweep leaves r/(1 + r) of the error.",
            quantity=f"what a sweep leaves at a mass ratio of {r:g} [-]",
            predicted=r / (1.0 + r),
            measured=contraction,
            tolerance=1e-11,
            observation=f"Under a mass ratio of {r:g} a sweep leaves {contraction:.6f} of the error.",
        ))
        if r <= 100.0:
            bound = 1.0 + np.ceil(np.log(1e-3) / np.log(r / (1.0 + r)))         # the first sweep is the one that spoils it
            needed.append(len(errors) - 1)
            found.append(finding(
                claim=("So a thousandth takes about 6.9 (r + ½) sweeps, after the first, which makes the upper link "
                       "wrong."),
                quantity=f"sweeps until a thousandth is left at a mass ratio of {r:g} [-]",
                predicted=bound,
                measured=len(errors) - 1,
                tolerance=0.0,
                observation=f"Under a mass ratio of {r:g} a thousandth is left after {len(errors) - 1} sweeps.",
            ))
    fine = np.geomspace(1.0, 1e4, 60)
    return found, Picture("A heavy weight under a light one", "log₁₀ of the mass ratio", "1 − what a sweep leaves, log₁₀", [
        series("theory: 1/(1 + r)", np.log10(fine), -np.log10(1.0 + fine), LINE), series("distance_sweep, measured", np.log10(ratios), np.log10(1.0 - np.array(measured)), DOTS)],
        "A hundred times the mass costs about sixty times the sweeps of equal masses: hang the light one on the heavy one where you can.")


def circling(lesson, step, turn, steps):
    """Angle [rad] of each step of a weight on a string in a circle, no gravity, begun with that angle times a tangential speed."""
    p, x, v, angles = net([1.0], g=0.0), straight(1), np.array([[0.0, 0.0], [1.0, 0.0]]), []
    for _ in range(steps):
        new, v = getattr(lesson, step)(lesson.falling_acceleration, 0.0, x, v, turn, p)
        angles.append(np.arctan2(new[1, 0] * -x[1, 1] + new[1, 1] * x[1, 0], new[1] @ x[1]))
        x = new
    return np.array(angles)


@case("projection-dissipation", "What projection takes from what turns", compiled=False)
def projection_dissipation(lesson):
    """What projection costs: a weight on a string that turns without gravity.  A step goes along the last chord and is put back radially:

    tan β = sin α/(2 − cos α) for the next angle, after tan α = ω dt for the first;  β ≈ α − α³, so that 1/α² grows by 2 at every step:
    ω_N ≈ ω/√(1 + 2N(ω dt)²).  That is twice what a round wall costs (stability case 36).  PBD and the projection method alike.
    """
    found, steps, drawn = [], 200, []
    for turn in (0.2, 0.05):
        theory = [np.arctan(turn)]
        for _ in range(steps - 1):
            theory.append(np.arctan(np.sin(theory[-1]) / (2.0 - np.cos(theory[-1]))))
        for step, label in (("pbd_step", "PBD"), ("projection_step", "projection")):
            got = circling(lesson, step, turn, steps)
            found.append(finding(
                claim=("Projection brakes what turns: tan β = sin α/(2 − cos α), so that 1/ω² grows by nearly 2 dt² "
                       "at every step."),
                quantity=f"{label}: speed left after {steps} steps at ω dt = {turn} [-]",
                predicted=theory[-1] / turn,
                measured=got[-1] / turn,
                tolerance=1e-10,
                observation=(f"At ω dt = {turn} {label} has {100.0 * got[-1] / turn:.2f} % of the speed left after "
                             f"{steps} steps."),
            ))
            if label == "PBD":
                drawn += [series(f"ω dt = {turn}: 1/√(1 + 2N(ω dt)²)", np.arange(steps), 1.0 / np.sqrt(1.0 + 2.0 * np.arange(steps) * turn**2), LINE), series(f"ω dt = {turn}: PBD", np.arange(0, steps, 10), got[::10] / turn, DOTS)]
    rattle = circling(lesson, "rattle_step", 0.2, steps)
    found.append(finding(
        claim="With gradients taken where the step begins nothing is lost.",
        quantity="RATTLE: change of the angle of a step in 200 [rad]",
        predicted=0.0,
        measured=np.ptp(rattle),
        tolerance=1e-11,
        observation=f"Under RATTLE every step turns by the same angle, up to {np.ptp(rattle):.0e} rad.",
    ))
    return found, Picture("A weight that turns on a string", "steps", "speed left [-]", drawn, "Nothing brakes this weight but the corners of the path that the steps make of its circle.")


@case("substeps-vs-iterations", "Substeps against sweeps", compiled=False)
def substeps_vs_iterations(lesson):
    """Substeps against sweeps: a frame has room for n visits to every link; n sweeps of one step, or n steps with one sweep each.

    n sweeps leave  A (1 − Gⁿ)⁻¹ Gⁿ Λ*  of softness, about a share 1/n at first; n substeps leave ½N(N − 1) g (dt/n)²: a share 1/n².
    """
    found, N, frame = [], 8, 1.0 / 60.0
    x, once = straight(N), 0.5 * N * (N - 1) * G * frame**2
    ways = {"sweeps": lambda n: (settle(lesson, "xpbd_step", net([1.0] * N, sweeps=n), x, frame, patience(N, n))), "substeps": lambda n: settle(lesson, "xpbd_step", net([1.0] * N), x, frame / n, patience(N, 1))}
    theory = {"sweeps": lambda n: left_over([1.0] * N, n, frame).sum(), "substeps": lambda n: once / n**2}
    for way in ways:
        got, bound = stretch(ways[way](10)).sum(), theory[way](10)
        found.append(finding(
            claim="n substeps are n² times as hard as one step with one sweep; n sweeps are not.",
            quantity=f"10 {way} a frame: end of {N} links too low by [mm]",
            predicted=MILLIMETRES * bound,
            measured=MILLIMETRES * got,
            tolerance=MILLIMETRES * SETTLED,
            observation=f"With 10 {way} a frame a chain of {N} m hangs {MILLIMETRES * got:.4f} mm too low.",
        ))
    fine, dots = np.arange(1, 31), (1, 2, 5, 10)
    drawn = [part for way in ways for part in (series(f"{way}, theory", np.log10(fine), [np.log10(MILLIMETRES * theory[way](n)) for n in fine], LINE),
                                               series(f"{way}, measured", np.log10(dots), [np.log10(MILLIMETRES * stretch(ways[way](n)).sum()) for n in dots], DOTS))]
    return found, Picture("Where to spend the visits of a frame", "log₁₀ of the visits to a link", "log₁₀ of how much too low [mm]", drawn, "The same work, and a slope twice as steep: short steps are worth more than many sweeps.")


@case("extremes", "Extremes of constraints", compiled=False)
def extremes(lesson):
    """Extremes: what no physics can be done with is refused; what only looks like it gives the right limit.

    A compliance of 10¹² m/N is no spring at all: a weight falls, y = ½g t(t + dt) after t.  At a mass ratio of 10⁶ ten sweeps hardly hold
    anything, but a projection only ever shortens what is too long: the chain falls no faster than freely.
    """
    x = straight(2)
    three = np.zeros((4, 3))
    flat = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 0.0]])
    same, pairs = 0.0 * x, [(0, 1), (1, 2)]
    make = lambda **more: lesson.make_net(*({"x": x, "m": 1.0, "fixed": [0], "pairs": pairs, "alpha": 0.0, "stiffness": 1.0, "gravity": (0.0, -G), "sweeps": 1} | more).values())
    asked = (
        lambda: make(alpha=-1e-3), lambda: make(alpha=np.nan), lambda: make(fixed=[0, 1]), lambda: make(x=same), lambda: make(x=x * np.nan), lambda: make(m=0.0), lambda: make(m=-1.0),
        lambda: make(stiffness=0.0), lambda: make(stiffness=1.5), lambda: make(sweeps=0), lambda: make(gravity=(0.0, np.inf)),
        lambda: lesson.distance_constraint(x[0], x[0], 1.0), lambda: lesson.projection(1.0, np.ones((2, 3)), np.zeros(2)), lambda: lesson.projection(1.0, np.zeros((2, 3)), np.ones(2)),
        lambda: lesson.distance_sweep(same, net([1.0, 1.0])), lambda: lesson.compliant_sweep(same, np.zeros(2), 0.1, net([1.0, 1.0])), lambda: lesson.fold_constraint(three, 0.0), lambda: lesson.fold_constraint(flat, 0.0),
        lambda: lesson.compliant_multiplier(0.1, 0.0, 1.0, -1e-3), lambda: lesson.compliant_multiplier(0.1, 0.0, 0.0, 0.0), lambda: lesson.compliant_multiplier(0.1, 0.0, 1.0, np.nan),
    )
    refused = sum(refuses(call) for call in asked)
    found = [finding(
        claim="What no physics can be done with is refused by name.",
        quantity=f"calls that end in BadInput [of {len(asked)}]",
        predicted=len(asked),
        measured=refused,
        tolerance=0.0,
        observation=f"{refused} of {len(asked)} impossible inputs are refused.",
    )]
    dt, steps = 0.01, 50
    fallen = stretch(settle(lesson, "xpbd_step", net([1.0], 1.0, 1e12), straight(1), dt, steps))[0]
    bound = 0.5 * G * steps * dt * (steps + 1) * dt
    found.append(finding(
        claim="A spring of no stiffness lets fall.",
        quantity="way of a weight on a compliance of 10¹² m/N in ½ s [m]",
        predicted=bound,
        measured=fallen,
        tolerance=1e-11,
        observation=f"On a compliance of 10¹² m/N a weight falls {fallen:.6f} m in half a second.",
    ))
    stiff, hard = (settle(lesson, step, net([1.0, 1.0], 1.0, 0.0, 5), x, dt, steps) for step in ("xpbd_step", "pbd_step"))
    found.append(finding(
        claim="Without compliance XPBD is PBD.",
        quantity="largest difference after 50 steps [m]",
        predicted=0.0,
        measured=np.abs(stiff - hard).max(),
        tolerance=ROUND_OFF,
        observation="Without compliance XPBD and PBD go the same way.",
    ))
    ratio, dt, lengths = 1e6, 1.0 / 60.0, []
    y, v, p = x, 0.0 * x, net([1.0, ratio], 1.0, 0.0, 10)
    for _ in range(300):
        y, v = lesson.pbd_step(lesson.falling_acceleration, 0.0, y, v, dt, p)
        lengths.append(max(stretch(y).sum(), 0.0))
    bounded = max(lengths) <= 0.5 * G * (301 * dt) ** 2 and np.all(np.isfinite(y))
    found.append(finding(
        claim=("A mass ratio of a million makes a chain soft, and nothing is ejected: it never falls faster than "
               "freely."),
        quantity="runs at a mass ratio of 10⁶ that stay below free fall [of 1]",
        predicted=1,
        measured=int(bounded),
        tolerance=0.0,
        observation=f"At a mass ratio of a million 10 sweeps leave a chain {max(lengths):.2f} m too long.",
    ))
    exponents = np.linspace(-9.0, 0.0, 10)
    sags = [stretch(settle(lesson, "xpbd_step", net([1.0], 1.0, 10.0**y, 1), straight(1), 1.0, 400))[0] for y in exponents]
    return found, Picture("Any compliance", "log₁₀ of the compliance [m/N]", "log₁₀ of the sag [m]", [
        series("theory: α m g", exponents, np.log10(G) + exponents, LINE), series("XPBD, steps of a second", exponents, np.log10(sags), DOTS)],
        "From a nanometre a newton to a metre a newton, with steps of a whole second: no stiffness is too stiff.")


@case("primitives", "A fold, a ball, a rod and a cloth", compiled=False)
def primitives(lesson):
    """What the larger pieces must keep: a fold its angle, a ball its air, a rod its period, and nothing is left inside an obstacle.

    A weightless fold of stiffness 1 comes to its angle by Newton's method, in a handful of visits.  A ball without gravity or compliance of
    its air comes to rest at its volume; neither pushes anything from outside.  The rod's quarter period, at steps of dt and dt/2 and
    extrapolated, is off by a few (ω dt)² of it.
    """
    found, quiet = [], np.zeros(3)
    x = np.array([[0.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 0.4, 0.1], [-0.9, 0.6, 0.5]])
    loose = Net(np.array([1.0, 2.0, 1.0, 0.5]), quiet, np.zeros(0, dtype=np.int64), np.zeros(0, dtype=np.int64), np.zeros(0), np.zeros(0), np.zeros(0), 1)
    nowhere = lesson.Obstacle(np.array([0.0, 0.0, -9.0]), 0.0, np.array([0.0, 0.0, -9.0]), np.array([0.0, 0.0, 1.0]))
    sheet, centre = lesson.Cloth(loose, np.array([[0, 1, 2, 3]]), np.array([0.2]), 1.0, nowhere), x.T @ (1.0 / loose.inv_mass)
    for _ in range(12):
        x = lesson.fold_sweep(x, sheet)
    left = abs(lesson.fold_constraint(x, 0.2)[0])
    found.append(finding(
        claim="A fold comes to the angle that it wants.",
        quantity="angle that is left after 12 visits [rad]",
        predicted=0.0,
        measured=left,
        tolerance=ROUND_OFF,
        observation=f"After 12 visits a fold is {left:.0e} rad off.",
    ))
    shift = np.abs(x.T @ (1.0 / loose.inv_mass) - centre).max()
    found.append(finding(
        claim="Folding pushes nothing from outside.",
        quantity="way of the centre of mass, times the mass [kg m]",
        predicted=0.0,
        measured=shift,
        tolerance=ROUND_OFF,
        observation=f"Its centre of mass has moved by {shift:.0e}.",
    ))

    corners = np.array([[1.0, 0.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, 1.0], [0.0, 0.0, -1.0]])
    faces = np.array([[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]])
    net_ = lesson.make_net(corners, 1.0, [], lesson.shared_edges(faces)[0], 1e9, 1.0, quiet, 5)           # links that hardly pull: the air is judged alone
    y, v = corners * [1.2, 0.9, 1.0], 0.0 * corners
    ball = lesson.Balloon(net_, faces, 2.0, 0.0, nowhere)                                          # Newton: five visits square what is left five times
    for _ in range(10):
        y, v = lesson.balloon_step(lesson.falling_acceleration, 0.0, y, v, 0.05, ball)
    volume, drift = lesson.volume_gradient(y, faces)[0], np.abs(v.sum(axis=0)).max()
    found.append(finding(
        claim="A ball comes to the volume that its air wants.",
        quantity="volume [m³]",
        predicted=2.0,
        measured=volume,
        tolerance=1e-9,
        observation=f"The ball holds {volume:.9f} m³.",
    ))
    found.append(finding(
        claim="Its air pushes nothing from outside.",
        quantity="momentum of the ball [kg m/s]",
        predicted=0.0,
        measured=drift,
        tolerance=1e-11,
        observation=f"Its momentum is {drift:.0e} kg m/s.",
    ))

    half, theta = 0.3, 0.5
    moment = (2.0 * half) ** 2 / 12.0
    rod = lesson.Hung(1.0, np.array([moment, moment, 1e-4]), np.array([0.0, 0.0, -G]), quiet, np.array([0.0, 0.0, half]), 3)
    bound = 0.25 * pendulum_period(theta, (moment + half**2) / half, G)
    quarters = [quarter_period(lesson, rod, half, theta, dt) for dt in (0.002, 0.001)]
    got, dt, omega = 2.0 * quarters[1] - quarters[0], 0.002, 0.5 * np.pi / bound
    found.append(finding(
        claim="A rigid rod that hangs from a point swings as a compound pendulum.",
        quantity="quarter period of a rod of 0.6 m, extrapolated [s]",
        predicted=bound,
        measured=got,
        tolerance=5.0 * (omega * dt) ** 2 * bound,
        observation=f"A rod of 0.6 m is at its lowest after {got:.5f} s.",
    ))

    n = 4
    sheet = np.array([[0.3 * (k % n), 0.3 * (k // n), 0.4] for k in range(n * n)])
    triangles = np.array([t for r in range(n - 1) for c in range(n - 1) for a in [r * n + c] for t in ((a, a + 1, a + n), (a + 1, a + n + 1, a + n))])
    edges, hinges = lesson.shared_edges(triangles)
    thrown = lesson.Obstacle(np.array([0.45, 0.4, 0.0]), 0.3, np.array([0.0, 0.0, -0.25]), np.array([0.0, 0.0, 1.0]))
    cloth = lesson.Cloth(lesson.make_net(sheet, 0.1, [], edges, 0.0, 1.0, (0.0, 0.0, -G), 3), hinges, np.zeros(len(hinges)), 0.1, thrown)
    v, depth = 0.0 * sheet, 0.0
    for _ in range(40):
        sheet, v = lesson.cloth_step(lesson.falling_acceleration, 0.0, sheet, v, 0.02, cloth)
        depth = max(depth, 0.3 - np.linalg.norm(sheet - thrown.centre, axis=1).min(), -0.25 - sheet[:, 2].min())
    found.append(finding(
        claim="No weight of a cloth is inside what it falls on at the end of a step.",
        quantity="deepest weight in 40 steps [m]",
        predicted=0.0,
        measured=max(depth, 0.0),
        tolerance=ROUND_OFF,
        observation=f"A cloth that falls on a ball and a floor is never deeper than {max(depth, 0.0):.0e} m.",
    ))
    fine, dots = np.linspace(0.1, 2.5, 40), np.array([0.25, 0.5, 1.0, 1.5, 2.0])
    period = lambda a: 0.25 * pendulum_period(a, (moment + half**2) / half, G)
    return found, Picture("A rod on a pivot", "let go at [rad]", "time to its lowest point [s]", [
        series("theory", fine, [period(a) for a in fine], LINE), series("hung_step, 5 ms, measured", dots, [quarter_period(lesson, rod, half, a, 0.005) for a in dots], DOTS)],
        "A rigid body in a projection: it needs the generalised inverse mass, and nothing else that a point has not.")


def quarter_period(lesson, rod, half, theta, dt):
    """When [s] a rod that is let go at the angle θ about y passes its lowest point, between steps on a straight line."""
    q = np.array([np.cos(0.5 * theta), 0.0, -np.sin(0.5 * theta), 0.0])
    x, v, omega, t = half * np.array([np.sin(theta), 0.0, -np.cos(theta)]), np.zeros(3), np.zeros(3), 0.0
    while x[0] > 0.0 and t < 2.0:
        before = x[0]
        x, v, q, omega = lesson.hung_step(t, x, v, q, omega, dt, rod)
        t += dt
    return t - dt * x[0] / (x[0] - before)
