"""Rotation at its limits: energy drift, fast spins, needles, and the spin below which a sleeping top falls.

Every bound here is a closed form; the experiment is a run of the lesson's own steps.
pybullet silently limits a turn to π/4 per step, 785 rad/s at a millisecond, so fast-spin omits it.
*Source:* Euler 1758; Landau and Lifshitz, Mechanics, §§ 33 to 37; Klein and Sommerfeld 1897 for the sleeping top.
"""

import numpy as np

from solutions.checks import Diverged
from validate.methods import TURNS
from validate.reference.orientation import about, cross_matrix, quaternion_matrix, relative_turn
from validate.reference.rotation import symmetric_top
from validate.stability.case import DOTS, EDGE, LINE, Picture, Worst, agreement, bisect, case, finding, series

EPS = 1.2e-16                # relative size of a rounding
LABEL = {method.function: method.label for method in TURNS}
KEEP_L = [m.function for m in TURNS if not m.function.endswith("gyroscopic_step")]
AT_START = np.array([1.0, 0.0, 0.0, 0.0])


def released(lesson, method, I, omega, dt, steps):
    """Return (R, L, energy over its initial value) of a free body that starts at R = 1 with this ω.

    Raises Diverged where the step refuses.
    """
    body = lesson.RigidBody(1.0, np.array(I))
    L = body.I_body * np.array(omega)
    q, end = lesson.advance_rotation(getattr(lesson, method), lesson.no_torque, 0.0, AT_START, L, dt, steps, body)
    energy = lesson.kinetic_energy(q, end, body.I_body) / lesson.kinetic_energy(AT_START, L, body.I_body)
    return quaternion_matrix(*q), end, energy


def tried(lesson, method, I, omega, dt, steps):
    """Return the same, or None where the step refuses, or where its numbers are beyond a linear solver."""
    try:
        return released(lesson, method, I, omega, dt, steps)
    except (Diverged, np.linalg.LinAlgError):
        return None


def energies(lesson, method, I, omega, dt, ts):
    """Return the energy over its initial value at the times ts; NaN where its numbers are beyond a linear solver."""
    body, q, now, found = lesson.RigidBody(1.0, np.array(I)), AT_START, 0.0, []
    L = body.I_body * np.array(omega)
    begin = lesson.kinetic_energy(q, L, body.I_body)
    for t in ts:
        try:
            q, L = lesson.advance_rotation(getattr(lesson, method), lesson.no_torque, now, q, L, dt,
                                           round((t - now) / dt), body)
        except np.linalg.LinAlgError:
            return np.array([*found, *[np.nan] * (len(ts) - len(found))])
        now = t
        found.append(lesson.kinetic_energy(q, L, body.I_body) / begin)
    return np.array(found)


# ---------------------------------------------------------------------------------------------- drift of energy

CYLINDER, SPUN, MS = (0.04, 0.04, 0.02), (2.0, 4.0, 6.0), 1e-3     # moments [kg m²], ω [rad/s], step [s]


def gyroscopic_energy(t, sign):
    """Return E/E₀ of a step that takes the gyroscopic term at its beginning (+1) or its end (−1), exactly.

    ω_⊥² is multiplied by 1 + (Ω dt)² per step, or divided by it.
    """
    I, w = np.array(CYLINDER), np.array(SPUN)
    turn = (I[2] - I[0]) / I[0] * w[2]
    across = I[0] * (w[0] ** 2 + w[1] ** 2) * (1.0 + (turn * MS) ** 2) ** (sign * t / MS)
    return (across + I[2] * w[2] ** 2) / np.sum(I * w * w)


def kept_L_energy(t, times=1.0):
    """Return E/E₀ of a step that keeps L and turns with the first ω, to first order in dt.

    u = L₃² obeys the logistic equation  u̇ = ρ u (L² − u).
    """
    I, L = np.array(CYLINDER), np.array(CYLINDER) * np.array(SPUN)
    squared, u0 = L @ L, L[2] ** 2
    rate = times * MS * (I[0] - I[2]) * squared / (I[0] ** 2 * I[2])
    u = squared / (1.0 + (squared / u0 - 1.0) * np.exp(-rate * t))
    energy = lambda u: squared / (2.0 * I[0]) + 0.5 * (1.0 / I[2] - 1.0 / I[0]) * u
    return energy(u) / energy(u0)


SPUN_STEPS = 2_000           # of 1 ms
SPUN_FOR = SPUN_STEPS * MS   # [s]


def first_order_drift(energy):
    """Judge both gyroscopic steps by ±½ dt ω̇ᵀIω̇; energy: {method: gain in the whole run}."""
    I, w = np.array(CYLINDER), np.array(SPUN)
    w_dot = np.cross(I * w, w) / I
    first = 0.5 * MS * (w_dot @ (I * w_dot)) * SPUN_FOR / (0.5 * w @ (I * w))
    # The tolerance: sinh x = x (1 + x²/6 + …) with x = 2 · drift / share of ω_⊥ in the energy < 0.1.
    return [
        finding(
            claim="A first-order step changes the energy by ±½ dt ω̇ᵀIω̇ per second.",
            quantity=f"half the difference between the two gyroscopic steps after {SPUN_FOR:g} s [-]",
            predicted=first,
            measured=0.5 * (energy["gyroscopic_step"] - energy["implicit_gyroscopic_step"]),
            tolerance=0.1**2 / 5.0 * first,
            observation=(f"{SPUN_FOR:g} s at 1 ms: {100.0 * energy['gyroscopic_step']:+.2f} % and "
                         f"{100.0 * energy['implicit_gyroscopic_step']:+.2f} % of the energy, about "
                         f"±{100.0 * first:.2f} %."),
        ),
    ]


def gyroscopic_drift_in_closed_form(energy):
    """Judge each of them by the factor of ω_⊥²."""
    found = []
    for method, sign, place in (("gyroscopic_step", 1, "beginning"), ("implicit_gyroscopic_step", -1, "end")):
        law = gyroscopic_energy(SPUN_FOR, sign) - 1.0
        found.append(finding(
            claim=f"With the gyroscopic term at the {place} of the step ω_⊥² changes by (1 + (Ω dt)²)^(±1), exactly.",
            quantity=f"{LABEL[method]}: energy gained in {SPUN_FOR:g} s [-]",
            predicted=law,
            measured=energy[method],
            tolerance=20.0 * EPS * SPUN_STEPS,
            observation=(f"With the term at the {place} of the step the energy changes by "
                         f"{100.0 * energy[method]:+.4f} %, as in the closed form."),
        ))
    return found


def drift_of_a_kept_momentum(energy):
    """Judge the steps that keep L by the logistic curve."""
    found = []
    for method, times in (("axis_angle_step", 1.0), ("quaternion_step", 1.0), ("matrix_step", 3.0)):
        law = kept_L_energy(SPUN_FOR, times) - 1.0
        found.append(finding(
            claim="A step that keeps L and turns with its first ω gains energy along a logistic curve.",
            quantity=f"{LABEL[method]}: energy gained in {SPUN_FOR:g} s [-]",
            predicted=law,
            measured=energy[method],
            tolerance=2.0 * np.linalg.norm(SPUN) * MS * law,
            observation=(f"{LABEL[method]}: {100.0 * energy[method]:+.2f} % in {SPUN_FOR:g} s, although L is kept to "
                         "the last digit."),
        ))
    return found


def no_drift(energy):
    """Judge the steps that keep the energy."""
    found = []
    for method in ("midpoint_step", "composed_midpoint_step", "splitting_step", "composed_splitting_step"):
        found.append(finding(
            claim="A step that is exact or preserves quadratic invariants keeps L and the energy.",
            quantity=f"{LABEL[method]}: energy gained in {SPUN_FOR:g} s [-]",
            predicted=0.0,
            measured=energy[method],
            tolerance=5.0 * 20.0 * EPS * SPUN_STEPS,
            observation=f"{LABEL[method]}: {energy[method]:+.0e} of the energy after {SPUN_STEPS:,} steps.",
        ))
    return found


@case("gyroscopic-drift", "Gyroscopic drift", compiled=False)
def gyroscopic_drift(lesson):
    """A first-order step changes the energy by  dE/dt = ±½ dt ω̇ᵀIω̇,  ω̇ in body coordinates.

    For this cylinder that is ±0.95 % in 2 s at 1 ms.  With the gyroscopic term at the beginning,  I Δω = −dt
    ω × Iω,  so ΔE = ½ Δωᵀ I Δω > 0; at the end, minus that.  In body coordinates the cylinder's ω_⊥ turns at
    Ω = (I₃ − I₁)/I₁ ω₃. Explicit Euler multiplies its length by √(1 + (Ω dt)²), and implicit Euler divides it by
    the same. That is exact, because a turn about ω does not change ω.  Where L is kept, ℓ ← e^(−dt ω*) ℓ has the
    same ΔE. Renormalising by columns adds  dt² κ  to the turn, κ = ½(−ω₂ω₃, ω₁ω₃, −ω₁ω₂), and for this cylinder
    twice the drift on top.
    """
    ts, fine = np.linspace(0.0, SPUN_FOR, 11)[1:], np.linspace(0.0, SPUN_FOR, 101)
    runs = {m: energies(lesson, m, CYLINDER, SPUN, MS, ts) - 1.0 for m in LABEL}
    energy = {m: gained[-1] for m, gained in runs.items()}
    found = first_order_drift(energy) + gyroscopic_drift_in_closed_form(energy)
    found += drift_of_a_kept_momentum(energy) + no_drift(energy)
    drawn = [series("theory, gyroscopic", fine, 100.0 * (gyroscopic_energy(fine, 1) - 1.0), LINE),
             series("theory, gyroscopic, implicit", fine, 100.0 * (gyroscopic_energy(fine, -1) - 1.0), LINE),
             series("theory, L kept", fine, 100.0 * (kept_L_energy(fine) - 1.0), LINE),
             series("theory, renormalised", fine, 100.0 * (kept_L_energy(fine, 3.0) - 1.0), LINE)]
    drawn += [
        series(LABEL[m], ts, 100.0 * runs[m], DOTS)
        for m in (
            "gyroscopic_step",
            "implicit_gyroscopic_step",
            "quaternion_step",
            "matrix_step",
            "midpoint_step",
            "splitting_step",
        )
    ]
    return found, Picture(
        "Energy of a thrown cylinder at 1 ms",
        "t [s]",
        "energy gained [%]",
        drawn,
        "First-order steps gain or lose energy, three times as fast if R is renormalised by columns. The midpoint "
        "turn and the splitting keep it.",
    )


# ---------------------------------------------------------------------------------------------- too fast

@case("fast-spin", "Spin 10⁴ rad/s", compiled=False)
def fast_spin(lesson):
    """A cylinder at 10⁴ rad/s with 10 rad per step keeps L, and two equal moments make the splitting exact.

    L does not change where it is the state.  Round-off: an angle of N rad is known to about 16 roundings of N/2⁵³.
    The gyroscopic term at the beginning multiplies ω_⊥ by √(1 + (Ω dt)²) = √17 per step.
    """
    fast, steps = (6000.0, 0.0, 8000.0), 200
    I, L = np.array(CYLINDER), np.array(CYLINDER) * fast
    runs = {m: tried(lesson, m, CYLINDER, fast, MS, steps) for m in LABEL}
    lost = max(np.abs(runs[m][1] - L).max() if runs[m] else np.inf for m in KEEP_L)
    angle = (np.linalg.norm(L) / I[0] + abs(1.0 - I[2] / I[0]) * fast[2]) * steps * MS
    found = [finding(
        claim="A step with L as its state keeps L at any spin.",
        quantity=f"largest change of L in {len(KEEP_L)} steps of the lesson [kg m²/s]",
        predicted=0.0,
        measured=lost,
        tolerance=0.0,
        observation=f"At 10⁴ rad/s and 10 rad per step, {steps:,} steps change no digit of L.",
    )]
    for method in ("splitting_step", "composed_splitting_step"):
        off = relative_turn(runs[method][0], symmetric_top(I, np.array(fast), steps * MS))
        many = 5 if method.startswith("composed") else 1
        found.append(finding(
            claim="With two equal moments the splitting turn is exact at any spin.",
            quantity=f"{LABEL[method]}: error of the orientation after {steps * MS:g} s [rad]",
            predicted=0.0,
            measured=off,
            tolerance=16.0 * EPS * angle * many,
            observation=f"After {angle:,.0f} rad the orientation is off by {off:.0e} rad.",
        ))
    for method in ("midpoint_step", "composed_midpoint_step"):
        gained = runs[method][2] - 1.0 if runs[method] else np.nan
        found.append(finding(
            claim="The midpoint turn keeps the energy at any spin, but not the orientation.",
            quantity=f"{LABEL[method]}: energy gained in {steps * MS:g} s [-]",
            predicted=0.0,
            measured=gained,
            tolerance=5.0 * 20.0 * EPS * steps,
            observation=f"{LABEL[method]}: {gained:+.0e} of the energy at 10 rad per step.",
        ))
    refused = runs["gyroscopic_step"] is None
    found.append(finding(
        claim=("With the gyroscopic term at the beginning ω_⊥ grows by √17 per step: the run must end in an error "
               "instead of a number."),
        quantity="runs that raise Diverged [of 1]",
        predicted=1,
        measured=refused,
        tolerance=0.0,
        observation=f"The lecture's loop {'raises an error' if refused else 'returns a number'}.",
    ))
    spins = np.logspace(1.0, 5.0, 13)
    drawn = [
        series("theory, 16 roundings of the angle", np.log10(spins), np.log10(16.0 * EPS * angle / 1e4 * spins), LINE)
    ]
    for method in ("splitting_step", "midpoint_step", "runge_kutta_step"):
        errors = []
        for spin in spins:
            omega = spin / 1e4 * np.array(fast)
            run = tried(lesson, method, CYLINDER, omega, MS, steps)
            off = max(relative_turn(run[0], symmetric_top(I, omega, steps * MS)), 1e-16) if run else np.pi
            errors.append(np.log10(off))
        drawn.append(series(LABEL[method], np.log10(spins), errors, DOTS))
    return found, Picture(
        "A cylinder at increasing spin, 1 ms per step",
        "log₁₀ of the spin [rad/s]",
        f"log₁₀ of the error after {steps * MS:g} s [rad]",
        drawn,
        ("The splitting loses only the digits that the angle itself loses to rounding. The other steps fail where "
         "they turn by about a radian per step."),
    )


# ---------------------------------------------------------------------------------------------- a needle

NEEDLE, PRICKED = (1.0, 1.0, 1e-6), (1.0, 0.5, 1000.0)


@case("slender-body", "A needle", compiled=False)
def slender_body(lesson):
    """A needle, I₃ = 10⁻⁶ I₁, one radian per step: L₃ = 10⁻³ is a small difference, known to 10⁻¹⁶ |L| per step.

    ω₃ = L₃/I₃.  Any orientation has an energy between L²/2I₁ and L²/2I₃.
    """
    steps, I, w = 2000, np.array(NEEDLE), np.array(PRICKED)
    L = I * w
    size, energy = np.linalg.norm(L), 0.5 * L @ w
    blurred = 4.0 * EPS * steps * size                                   # of L₃, if all roundings have one sign
    runs = {m: tried(lesson, m, NEEDLE, PRICKED, MS, steps) for m in LABEL}
    found = []
    for method in ("midpoint_step", "composed_midpoint_step", "splitting_step", "composed_splitting_step"):
        gained = runs[method][2] - 1.0 if runs[method] else np.nan
        many = 5 if method.startswith("composed") else 1
        found.append(finding(
            claim="The energy of a needle is kept to the accuracy of L₃.",
            quantity=f"{LABEL[method]}: energy gained in {steps * MS:g} s [-]",
            predicted=0.0,
            measured=gained,
            tolerance=many * blurred * w[2] / energy,
            observation=f"{LABEL[method]}: {gained:+.0e} of the energy.",
        ))
    off = relative_turn(runs["splitting_step"][0], symmetric_top(I, w, steps * MS))
    found.append(finding(
        claim="Its spin is ω₃ = L₃/I₃, so the angle is known to T δL₃/2I₃.",
        quantity=f"{LABEL['splitting_step']}: error of the orientation after {steps * MS:g} s [rad]",
        predicted=0.0,
        measured=off,
        tolerance=0.5 * blurred / I[2] * steps * MS,
        observation=f"After {w[2] * steps * MS:,.0f} rad about its axis the needle is off by {off:.0e} rad.",
    ))
    ended = sum(run is None or bool(np.all(np.isfinite(run[0])) and np.isfinite(run[2])) for run in runs.values())
    refused = [LABEL[m] for m, run in runs.items() if run is None]
    found.append(finding(
        claim="A step ends in finite numbers or raises an error.",
        quantity=f"steps that do so [of {len(runs)}]",
        predicted=len(runs),
        measured=ended,
        tolerance=0.0,
        observation=f"Of {len(runs)} steps {len(refused)} refused: {', '.join(refused)}.",
    ))
    bounds = size**2 / (2.0 * I[0]) / energy, size**2 / (2.0 * I[2]) / energy
    inside = sum(
        run is None or (1.0 - 1e-9) * bounds[0] <= run[2] <= (1.0 + 1e-9) * bounds[1]
        for m, run in runs.items()
        if m in KEEP_L
    )
    found.append(finding(
        claim="Where L is kept the energy stays between L²/2I₁ and L²/2I₃, whatever the error of the orientation.",
        quantity=f"steps that stay inside [of {len(KEEP_L)}]",
        predicted=len(KEEP_L),
        measured=inside,
        tolerance=0.0,
        observation=(f"{inside} of {len(KEEP_L)} steps stay between {bounds[0]:.2f} and {bounds[1]:,.0f} times the "
                     "initial energy."),
    ))
    ts = np.linspace(0.0, steps * MS, 21)[1:]
    drawn = [series(LABEL[m], ts, np.log10(energies(lesson, m, NEEDLE, PRICKED, MS, ts)), DOTS)
             for m in ("splitting_step", "midpoint_step", "quaternion_step", "runge_kutta_step")]
    drawn.append(series("greatest possible", (0.0, steps * MS), np.log10((bounds[1], bounds[1])), LINE))
    drawn.append(series("least possible", (0.0, steps * MS), np.log10((bounds[0], bounds[0])), LINE))
    return found, Picture(
        "Energy of a needle, one radian per step",
        "t [s]",
        "log₁₀ of energy over its value at the start [-]",
        drawn,
        "Splitting and midpoint keep the energy; the others vary between the bounds that L sets.",
    )


# ---------------------------------------------------------------------------------------------- a sleeping top

ACROSS, ALONG, MGL = 5.0, 1.0, 20.0                       # I₁, I₃ about the pivot [kg m²], Mgl [N m]
ASLEEP = 1e-7  # initial tilt [rad]: its square is round-off, so it obeys a linear equation
AWAKE = 500.0                # a top has fallen at this multiple of that tilt [-]
WATCHED = 200.0              # duration of a run [s]


def tilts(lesson, spin, tilt, dt, seconds, look):
    """Yield the tilt [rad] of a top released with nothing but its spin: first at the start, then every `look` steps."""
    top = lesson.Top(np.array([ACROSS, ACROSS, ALONG]), MGL)
    q = np.array([np.cos(0.5 * tilt), np.sin(0.5 * tilt), 0.0, 0.0])
    L = ALONG * spin * np.array([0.0, -np.sin(tilt), np.cos(tilt)])
    yield tilt
    for n in range(round(seconds / (dt * look))):
        q, L = lesson.advance_rotation(
            lesson.composed_splitting_step, lesson.heavy_top_torque, n * look * dt, q, L, dt, look, top
        )
        yield 2.0 * np.arctan2(np.hypot(q[1], q[2]), np.hypot(q[0], q[3]))


def falls(lesson, spin):
    """Return whether the top reaches AWAKE times its tilt at any half second."""
    return any(tilt > AWAKE * ASLEEP for tilt in tilts(lesson, spin, ASLEEP, 0.02, WATCHED, 25))


@case("sleeping-top", "A sleeping top")
def sleeping_top(lesson):
    """A sleeping top stands if and only if ω₃² > 4I₁Mgl/I₃²: 20 rad/s here.

    Near the vertical ξ = θ e^(iφ) obeys  I₁ξ̈ − iI₃ω₃ξ̇ − Mgl ξ = 0.  With a = I₃ω₃/2I₁ and λ² = Mgl/I₁ − a²
        |ξ/ξ₀|² = cosh² λt + (a/λ)² sinh² λt                  from rest,
    which reaches AWAKE in time t if  sinh(λt)/λt ≈ AWAKE/at:  for t = 200 s at λ = 0.006, where ω₃ is λ²I₁/2Mgl = 4e-6
    below the edge.  A top that falls from upright falls as far as  cos θ = I₃²ω₃²/2I₁Mgl − 1.
    """
    threshold = np.sqrt(4.0 * ACROSS * MGL) / ALONG
    found_at = bisect(lambda slower: falls(lesson, 2.0 * threshold - slower), 0.8 * threshold, 1.2 * threshold)
    measured = 2.0 * threshold - found_at
    found = [finding(
        claim="A top stands upright while ω₃² > 4 I₁Mgl/I₃².",
        quantity="least spin at which it stands [rad/s]",
        predicted=threshold,
        measured=measured,
        tolerance=threshold * (5e-6 + 1.2 * EDGE),
        observation=f"The top falls below {measured:.4f} rad/s, and stands above.",
    )]
    flips = falls(lesson, 0.999 * threshold) and not falls(lesson, 1.001 * threshold)
    found.append(finding(
        claim="The edge flips within ±0.1 %.",
        quantity="edges that flip [of 1]",
        predicted=1,
        measured=flips,
        tolerance=0.0,
        observation=("A thousandth below the edge it "
                     f"{'falls, a thousandth above it stands' if flips else 'does not behave as above it'}."),
    ))
    for spin in (19.0, 21.0):
        a, seconds = ALONG * spin / (2.0 * ACROSS), 10.0
        rate = np.sqrt(complex(MGL / ACROSS - a * a))
        law = abs(np.cosh(rate * seconds) + 1j * a / rate * np.sinh(rate * seconds))
        leans = np.array(list(tilts(lesson, spin, ASLEEP, 0.01, seconds, 1)))
        # Fourth order at the faster rate a + |λ| < 3 rad/s: 30 (0.03)⁴.  Tilts are below 1e-4 rad, and their
        # squares below 1e-8.

        found.append(finding(
            claim="Its tilt follows a linear equation.",
            quantity=f"tilt after 10 s over its first, at {spin:g} rad/s [-]",
            predicted=law,
            measured=leans[-1] / ASLEEP,
            tolerance=law * (30.0 * 0.03**4 + 1e-8),
            observation=(f"At {spin:g} rad/s the tilt is {leans[-1] / ASLEEP:.5g} times its first after 10 s, and "
                         f"{leans.max() / ASLEEP:.4g} times at most."),
        ))
    reached = fallen(lesson, 19.0)
    lowest = (ALONG * 19.0) ** 2 / (2.0 * ACROSS * MGL) - 1.0
    # Between two samples, 10 ms apart, cos θ changes by at most ½ü (5 ms)² with ü = Mgl/I₁ (1 − u)², u = cos θ.
    # The method adds its fourth-order error, as above, with rate 10.

    found.append(finding(
        claim="A top that falls from upright falls as far as cos θ = I₃²ω₃²/2I₁Mgl − 1.",
        quantity="least cos θ at 19 rad/s [-]",
        predicted=lowest,
        measured=np.cos(reached),
        tolerance=0.5 * MGL / ACROSS * (1.0 - lowest) ** 2 * 0.005**2 + 30.0 * 0.03**4,
        observation=f"At 19 rad/s it falls to {np.degrees(reached):.2f}°, and rises again.",
    ))
    spins, fine = np.linspace(12.0, 24.0, 13), np.linspace(12.0, 24.0, 121)
    deepest = lambda spin: np.degrees(np.arccos(min(1.0, (ALONG * spin) ** 2 / (2.0 * ACROSS * MGL) - 1.0)))
    return found, Picture(
        "How far a sleeping top falls",
        "spin [rad/s]",
        "largest tilt [°]",
        [
            series("theory", fine, [deepest(s) for s in fine], LINE),
            series("measured", spins, [np.degrees(fallen(lesson, s)) for s in spins], DOTS),
        ],
        ("Above 20 rad/s the top stays upright, asleep. Below that it wakes, tilts as far as its energy permits, and "
         "comes back."),
    )


def fallen(lesson, spin):
    """Return the largest tilt [rad] in 40 s from nearly upright: enough for one fall unless within 2 % of the edge."""
    return max(tilts(lesson, spin, 1e-5, 0.01, 40.0, 1))


@case("loads-and-derivatives", "Loads, derivatives, and the tennis racket", compiled=False)
def loads_and_derivatives(lesson):
    """Forces do the same work as their sum and torque on every rigid motion: Σ f · (V + ω × r) = F · V + τ · ω.

    Ṡ is compared with P/M, F, τ and ω × each axis, ω from a linear solve.  The growth rate of a disturbance is the
    largest real part of the eigenvalues of Euler's equations, linearised by differences that are exact for them,
    because they are quadratic.
    """
    rng, worst = np.random.default_rng(55), Worst()
    for _ in range(50):
        x, points, forces = rng.normal(size=3), rng.normal(size=(5, 3)), rng.normal(size=(5, 3))
        F, tau = lesson.total_load(x, points, forces)
        for V, omega in rng.normal(size=(6, 2, 3)):
            work = np.sum(forces * (V + np.cross(omega, points - x)))
            worst.keep("load", abs(F @ V + tau @ omega - work) / np.sum(np.abs(forces)))

        R, _ = np.linalg.qr(rng.normal(size=(3, 3)))
        R *= np.sign(np.linalg.det(R))
        m, I_body = rng.uniform(0.5, 2.0), np.sort(rng.uniform(1.0, 1.9, 3))[rng.permutation(3)]
        P, L, F, tau = rng.normal(size=(4, 3))
        S = lesson.RigidBodyState(x, R, P, L)
        rate = lesson.state_derivative(S, F, tau, lesson.RigidBody(m, I_body))
        omega = np.linalg.solve(R @ np.diag(I_body) @ R.T, L)
        truth = np.concatenate((P / m, np.stack([np.cross(omega, axis) for axis in R.T], axis=1).ravel(), F, tau))
        got = np.concatenate([np.ravel(part) for part in rate])
        worst.keep("derivative", np.linalg.norm(got - truth) / np.linalg.norm(truth))

        k, spin = int(rng.integers(3)), rng.choice([-1.0, 1.0]) * rng.uniform(0.5, 5.0)
        euler = lambda w, I=I_body: np.cross(I * w, w) / I
        about = spin * np.eye(3)[k]
        matrix = np.stack([0.5 * (euler(about + e) - euler(about - e)) for e in np.eye(3)], axis=1)
        growth = max(0.0, np.linalg.eigvals(matrix).real.max())
        worst.keep("rate", abs(lesson.tumbling_rate(I_body, k, spin) - growth) / abs(spin))
    return [
        agreement("A load is what does the same work on every rigid motion.", "power: largest relative error [-]",
                  worst["load"], 1e-12),
        agreement("The state changes by P/M, ω × R, F and τ.", "derivative of the state: largest relative error [-]",
                  worst["derivative"], 1e-12),
        agreement("A rotation about the middle axis is unstable, with the rate of the linearised Euler equations.",
                  "rate of growth over the spin: largest error [-]", worst["rate"], 1e-10)], None


# ---------------------------------------------------------------------------------------------- one step

TRIED = 25                   # random bodies [-]


def turned_by(phi):
    """Return R (3, 3) of a turn by |φ| about φ."""
    angle = np.sqrt(phi @ phi)
    return about(phi / angle, angle)


def cayley(phi):
    """Return R (3, 3) of a turn by 2 atan ½|φ| about φ: what q + ½ (0, φ) q is when it has the length 1."""
    angle = np.sqrt(phi @ phi)
    return about(phi / angle, 2.0 * np.arctan(0.5 * angle))


def gram_schmidt(M):
    """Return the orthonormal columns of M, the first of them parallel to its first."""
    Q, upper = np.linalg.qr(M)
    return Q * np.sign(np.diag(upper))


def tau_of(t, R, a, b):
    """Return a torque (3,) [N m] that depends on time and orientation, a at rest in the world and b in the body."""
    return np.cos(3.0 * t) * a + np.sin(2.0 * t) * (R @ b)


def explicit_step(update, t, R, L, dt, I, a, b):
    L = L + dt * tau_of(t, R, a, b)
    return update(R, R @ ((R.T @ L) / I)), L


def gyroscopic(t, R, L, dt, I, a, b):
    """ω by Euler's equation in the body, with the gyroscopic term at the beginning."""
    w, tau = R.T @ L / I, R.T @ tau_of(t, R, a, b)
    omega = R @ (w + dt * (tau - np.cross(w, I * w)) / I)
    R = cayley(dt * omega) @ R
    return R, R @ (I * (R.T @ omega))


def implicit_gyroscopic(t, R, L, dt, I, a, b):
    """One iteration of Newton's method for I (w' − w) + dt (w' × I w' − τ) = 0 from w; the derivative has no error."""
    w, tau = R.T @ L / I, R.T @ tau_of(t, R, a, b)
    law = lambda new: I * (new - w) + dt * (np.cross(new, I * new) - tau)
    slope = np.stack([np.imag(law(w + 1e-20j * e)) / 1e-20 for e in np.eye(3)], axis=1)
    omega = R @ (w - np.linalg.solve(slope, law(w)))
    R = cayley(dt * omega) @ R
    return R, R @ (I * (R.T @ omega))


def runge_kutta(t, q, L, dt, I, a, b):
    """Runge–Kutta 4 for q̇ = ½ (0, ω) q and L̇ = τ, from its table; in between, R is the orientation of q/|q|."""
    def rate(t, q, L):
        R = quaternion_matrix(*(q / np.linalg.norm(q)))
        omega = R @ ((R.T @ L) / I)
        return 0.5 * np.append(-omega @ q[1:], q[0] * omega + np.cross(omega, q[1:])), tau_of(t, R, a, b)
    stages = []
    for c in (0.0, 0.5, 0.5, 1.0):
        before = stages[-1] if stages else (0.0, 0.0)
        stages.append(rate(t + c * dt, q + c * dt * before[0], L + c * dt * before[1]))
    q, L = (y + dt * sum(weight * stage[k] for weight, stage in zip((1 / 6, 1 / 3, 1 / 3, 1 / 6), stages, strict=True))
            for k, y in enumerate((q, L)))
    return quaternion_matrix(*(q / np.linalg.norm(q))), L


def free_midpoint(R, L, I, dt):
    """The implicit midpoint rule for ℓ = RᵀL, by a fixed point; then the turn by ω of the middle."""
    start = R.T @ L
    middle = start
    for _ in range(100):
        middle = start + 0.5 * dt * np.cross(middle, middle / I)
    return R @ cayley(dt * middle / I)


def free_splitting(R, L, I, dt):
    """Half a turn about axis a, one about c, half about a, and a turn about L; b is the middle axis."""
    b = int(np.argsort(I)[1])
    a, c = (b + 1) % 3, (b + 2) % 3
    for axis, share in ((a, 0.5), (c, 1.0), (a, 0.5)):
        R = R @ about(np.eye(3)[axis], share * dt * (1.0 / I[axis] - 1.0 / I[b]) * (R.T @ L)[axis])
    return turned_by(dt / I[b] * L) @ R


def kicked(free, t, R, L, dt, I, a, b):
    """Half of the angular impulse before, half after a free rotation, at the times of both ends."""
    L = L + 0.5 * dt * tau_of(t, R, a, b)
    R = free(R, L, I, dt)
    return R, L + 0.5 * dt * tau_of(t + dt, R, a, b)


def composed(free, t, R, L, dt, I, a, b):
    """Suzuki's five substeps: their shares add up to 1, and the sum of their cubes vanishes."""
    gamma = 1.0 / (4.0 - np.cbrt(4.0))
    for share in (gamma, gamma, 1.0 - 4.0 * gamma, gamma, gamma):
        R, L = kicked(free, t, R, L, share * dt, I, a, b)
        t += share * dt
    return R, L


def by_matrices(t, q, L, dt, I, a, b):
    """Return {step of the lesson: (R, L) after it}."""
    R = quaternion_matrix(*q)
    given = t, R, L, dt, I, a, b
    return {
        "matrix_step": explicit_step(lambda R, w: gram_schmidt(R + dt * cross_matrix(w) @ R), *given),
        "axis_angle_step": explicit_step(lambda R, w: turned_by(dt * w) @ R, *given),
        "quaternion_step": explicit_step(lambda R, w: cayley(dt * w) @ R, *given),
        "gyroscopic_step": gyroscopic(*given),
        "implicit_gyroscopic_step": implicit_gyroscopic(*given),
        "runge_kutta_step": runge_kutta(t, q, L, dt, I, a, b),
        "midpoint_step": kicked(free_midpoint, *given),
        "splitting_step": kicked(free_splitting, *given),
        "composed_midpoint_step": composed(free_midpoint, *given),
        "composed_splitting_step": composed(free_splitting, *given),
    }


@case("one-step", "One step of each rotation", compiled=False)
def one_step(lesson):
    """A step is its definition by matrices: three unlike moments, any orientation, a torque of time and orientation."""
    rng, errors, parts = np.random.default_rng(56), Worst(), Worst()
    for _ in range(TRIED):
        I = rng.uniform(1.0, 1.9, 3)[rng.permutation(3)]
        q, (L, a, b, r, v) = rng.normal(size=4), rng.normal(size=(5, 3))
        q /= np.linalg.norm(q)
        t, dt, R, body = rng.uniform(), rng.uniform(0.05, 0.3), quaternion_matrix(*q), lesson.RigidBody(1.0, I)
        torque = lambda t, q, L, body, a=a, b=b: tau_of(t, quaternion_matrix(*q), a, b)
        steps = by_matrices(t, q, L, dt, I, a, b)
        for name in LABEL:
            new_q, new_L = getattr(lesson, name)(torque, t, q, L, dt, body)
            errors.note(name, (quaternion_matrix(*new_q), new_L), steps[name])

        # a symmetric body turns about L and about its axis, both at once and exactly
        k, sides = int(rng.integers(3)), np.full(3, I[0])
        sides[k] = I[1]
        own = about(np.eye(3)[k], dt * (1.0 / I[1] - 1.0 / I[0]) * (R.T @ L)[k])
        turned = quaternion_matrix(*lesson.splitting_free_rotation(q, L, sides, dt))
        parts.note("symmetric", turned, turned_by(dt / I[0] * L) @ R @ own)

        # the three updates by themselves: forwards, backwards, and slowly
        for w, h in ((L, dt), (L, -dt), (1e-5 * L, dt)):
            parts.note("update", lesson.matrix_update(R, w, h), gram_schmidt(R + h * cross_matrix(w) @ R))
            parts.note("update", lesson.axis_angle_update(R, w, h), turned_by(h * w) @ R)
            parts.note("update", quaternion_matrix(*lesson.quaternion_update(q, w, h)), cayley(h * w) @ R)

        # a history is that of single steps, each at its own time, and ends where a run of many steps ends
        states = [(R, L)]
        for n in range(3):
            states.append(explicit_step(lambda R, w, dt=dt: cayley(dt * w) @ R, t + n * dt, *states[-1], dt, I, a, b))
        ts, qs, Ls = lesson.rotation_trajectory(lesson.quaternion_step, torque, t, q, L, dt, 3, body)
        end_q, end_L = lesson.advance_rotation(lesson.quaternion_step, torque, t, q, L, dt, 3, body)
        parts.note("history", (ts, Ls), (t + dt * np.arange(4), np.array([L for _, L in states])))
        parts.note("history", np.array([quaternion_matrix(*q) for q in qs]), np.array([R for R, _ in states]))
        parts.note("history", (quaternion_matrix(*end_q), end_L), states[-1])

        p = rng.normal(size=4)
        p /= np.linalg.norm(p)
        product = quaternion_matrix(*lesson.quaternion_product(p, q))
        parts.keep("product", np.max(np.abs(product - quaternion_matrix(*p) @ R)),
                   np.max(np.abs(lesson.rotation_matrix(q) - R)))
        energy = 0.5 * L @ np.linalg.solve(R @ np.diag(I) @ R.T, L)
        parts.keep("energy", abs(lesson.kinetic_energy(q, L, I) - energy))
        tau = np.cross(R[:, 2], [0.0, 0.0, -2.5])
        parts.keep("top", np.max(np.abs(lesson.heavy_top_torque(t, q, L, lesson.Top(I, 2.5)) - tau)))
        parts.keep("velocity", np.max(np.abs(lesson.point_velocity(v, L, r) - v - np.cross(L, r))),
                   np.max(np.abs(lesson.skew(L) - cross_matrix(L))))
    claims = (("update", "Each update turns by its own law: forwards, backwards, and slowly.", "orientation [-]"),
              ("symmetric", "Splitting is exact for a symmetric body.", "orientation of a symmetric body [-]"),
              ("history", "Many steps are single steps, each at its own time.", "history [s, -, kg m²/s]"),
              ("product", "A product of quaternions is the product of their matrices.", "matrix [-]"),
              ("energy", "The energy of rotation is ½ L · I⁻¹ L in the world.", "energy [J]"),
              ("top", "Gravity turns a top about its pivot with l𝐞 × (−Mg ẑ).", "torque [N m]"),
              ("velocity", "A point of a body moves with v + ω × r.", "velocity [m/s]"))
    return [agreement(f"One step of {LABEL[name]} is its definition by matrices.",
                      f"{LABEL[name]}: largest error of a step [-, kg m²/s]", error, 1e-11)
            for name, error in errors.items()] + [
        agreement(claim, f"largest error of the {quantity}", parts[name], 1e-12)
        for name, claim, quantity in claims], None


def looped(t, x, R, v, omega, dt, m, I, f, a):
    """Return (x, R, v, ω) after a step under the force f cos t and the torque a sin t: velocities first."""
    tensor = R @ np.diag(I) @ R.T
    v = v + dt / m * np.cos(t) * f
    omega = omega + dt * np.linalg.solve(tensor, np.sin(t) * a - np.cross(omega, tensor @ omega))
    return x + dt * v, cayley(dt * omega) @ R, v, omega


@case("one-step-of-the-loop", "One step of the lecture's loop, and of a rolling ball", compiled=False)
def one_step_of_the_loop(lesson):
    """A body under a force and a torque of time; a ball of any size whose friction stops its slip within the cone."""
    rng, worst = np.random.default_rng(57), Worst()
    for _ in range(TRIED):
        m, I, dt, t = rng.uniform(0.5, 2.0), rng.uniform(1.0, 1.9, 3), rng.uniform(0.01, 0.1), rng.uniform()
        q, (x, v, omega, f, a) = rng.normal(size=4), rng.normal(size=(5, 3))
        q /= np.linalg.norm(q)
        R = quaternion_matrix(*q)
        load = lambda t, x, q, v, omega, body, f=f, a=a: (np.cos(t) * f, np.sin(t) * a)
        state = x, R, v, omega
        for steps in (1, 2):
            state = looped(t + (steps - 1) * dt, *state, dt, m, I, f, a)
            new_x, new_q, new_v, new_omega = lesson.advance_rigid_body(
                lesson.rigid_body_step, load, t, x, q, v, omega, dt, steps, lesson.make_rigid_body(m, I))
            worst.note("loop", (new_x, quaternion_matrix(*new_q), new_v, new_omega), state)

        (radius, mu, inertia), g = rng.uniform((0.1, 0.2, 0.01), (0.5, 0.5, 0.1)), rng.normal(size=3)
        along = np.array([1.0, 1.0, 0.0])                        # the floor's share of a vector
        for up in (-9.81, 2.0):                                  # gravity presses the ball on the floor, or lifts it
            ball = lesson.RollingBall(m, np.full(3, inertia), radius, mu, np.array([g[0], g[1], up]))
            F, tau = lesson.supported_weight(t, x, q, v, omega, ball)
            rests = m * np.array([g[0], g[1], max(0.0, up)])
            worst.keep("support", np.max(np.abs(F - rests)), np.max(np.abs(tau)))
        ball, r = ball._replace(gravity=np.array([g[0], g[1], -9.81])), np.array([0.0, 0.0, -radius])
        for speed in (1e-3, 3.0):                                # friction stops the first slip, and not the second
            before, limit = speed * v * along, mu * m * 9.81 * dt
            start = before - (np.cross(omega, r) + dt * g) * along
            _, _, end, spin = lesson.rolling_step(lesson.supported_weight, t, x, q, start, omega, dt, ball)
            J = m * (end - start - dt * g * along)
            new_x, new_q, *rates = lesson.average_rolling_step(lesson.supported_weight, t, x, q, start, omega, dt, ball)
            worst.note("means", (new_x, quaternion_matrix(*new_q), *rates),
                       (x + 0.5 * dt * (start + end), turned_by(0.5 * dt * (omega + spin)) @ R, end, spin))
            worst.keep("impulse", np.max(np.abs(inertia * (spin - omega) - np.cross(r, J))))
            after = (end + np.cross(spin, r)) * along
            stops = np.linalg.norm(before) / (1.0 / m + radius**2 / inertia) <= limit
            if stops:
                worst.keep("slip", np.max(np.abs(after)))
            else:
                worst.keep("cone", np.max(np.abs(J + limit * before / np.linalg.norm(before))))
    claims = (("loop", "The loop takes new velocities for positions, and Euler's equation for ω.",
               "state [m, m/s, -, rad/s]"),
              ("means", "The second-order step moves and turns by the means of the old and the new velocities.",
               "state of the ball [m, -, m/s, rad/s]"),
              ("support", "A floor takes what presses on it, and does not hold what is lifted.", "force [N]"),
              ("impulse", "Friction turns the ball by r × J.", "angular momentum [kg m²/s]"),
              ("cone", "A fast slip has the friction μ N against it.", "impulse [N s]"),
              ("slip", "A slow slip is stopped in the step.", "slip that is left [m/s]"))
    return [agreement(claim, f"{name}: largest error of the {quantity}", worst[name], 1e-10)
            for name, claim, quantity in claims], None


# ---------------------------------------------------------------------------------------------- a million steps

LONG_RUN, SHORT_RUN = 10**6, 10**3   # steps: compiled, and in plain Python
THROWN = 3                   # tops, thrown at random


def along_axis(q, L):
    """Return L · (axis 3 of the body), computed in NumPy's extended precision and independent of the length of q."""
    w, x, y, z = q.astype(np.longdouble)
    axis = np.array((2.0 * (x * z + w * y), 2.0 * (y * z - w * x), w * w - x * x - y * y + z * z))
    return axis @ L / (w * w + x * x + y * y + z * z)


def drifts(lesson, n, tops):
    """Return (change of L_z, change of L₃) over |L| of tops after n steps of the splitting."""
    top, changes = lesson.Top(np.array([ACROSS, ACROSS, ALONG]), MGL), []
    for q, L in tops:
        end = lesson.advance_rotation(lesson.splitting_step, lesson.heavy_top_torque, 0.0, q, L, 1.0 / 64.0, n, top)
        changes.append((end[1][2] - L[2], along_axis(*end) - along_axis(q, L)) / np.linalg.norm(L))
    return np.array(changes, float)


@case("a-million-steps", "A million steps of a top")
def a_million_steps(lesson):
    """Gravity has no torque about the vertical, nor about the axis of a symmetric top: L_z and L₃ stay.

    The splitting keeps both, so that rounding alone changes them.  The torque is computed with a vertical component of
    exactly 0, so that L_z keeps every bit.  Each step divides q by its length, which is rounded: that is the same
    deviation again and again, and L₃ drifts by n times it, at most n ε.
    """
    rng, longest = np.random.default_rng(7), LONG_RUN if hasattr(lesson.splitting_step, "py_func") else SHORT_RUN
    places, spins = rng.normal(size=(THROWN, 4)), 10.0 * rng.normal(size=(THROWN, 3))
    tops = [(q / np.linalg.norm(q), L) for q, L in zip(places, spins)]
    counts = [longest // 100, longest // 10, longest]
    vertical, axial = np.moveaxis([drifts(lesson, n, tops) for n in counts], 2, 0)
    sizes = np.sqrt(np.mean(axial**2, axis=1))
    return [
        agreement("The angular momentum about the vertical keeps every bit.",
                  f"change of L_z after {longest:,} steps, over |L| [-]", np.max(np.abs(vertical)), 0.0),
        agreement("Rounding changes the angular momentum about the axis by less than ε per step.",
                  f"change of L₃ after {longest:,} steps, over |L| [-]", np.max(np.abs(axial[-1])), longest * EPS),
    ], Picture(
        "The angular momentum of a top about its axis", "log₁₀ of the steps [-]", "log₁₀ of its change over |L| [-]",
        [series("ε per step", np.log10(counts), np.log10(EPS * np.array(counts)), LINE),
         series("measured", np.log10(counts), np.log10(sizes), DOTS)],
        "Rounding adds up, because every step rounds in the same way. After a million steps eleven digits are left.")
