"""Rotation at its limits: energy drift, fast spins, needles, and the spin of a sleeping top.

Every bound here is a closed form; the experiment is a run of the lesson's own steps.
pybullet silently limits a rotation to π/4 per step, 785 rad/s at a millisecond, so fast-spin omits it.
*Source:* Euler 1758; Landau and Lifshitz, Mechanics, §§ 33 to 37; Klein and Sommerfeld 1897 for the sleeping top.
"""

from functools import partial
from types import SimpleNamespace

import numpy as np

from solutions.checks import Diverged
from validate import methods
from validate.methods import TURNS
from validate.reference import turns
from validate.reference.orientation import about, cross_matrix, quaternion_matrix, relative_turn
from validate.reference.rotation import FreeTop, symmetric_top
from validate.stability.case import (
    DOTS,
    EDGE,
    LINE,
    Law,
    Picture,
    bisect,
    case,
    log_series,
    random_law,
    relative,
    series,
)

EPS = 1.2e-16                # relative size of a rounding
LABEL = {method.function: method.label for method in TURNS}
TURN = {method.function: method.table for method in TURNS}           # the same steps, written again
KEEP_L = [m.function for m in TURNS if m not in (methods.GYROSCOPIC, methods.IMPLICIT_GYROSCOPIC)]
COMPOSED = [m.function for m in (methods.COMPOSED_MIDPOINT, methods.COMPOSED_SPLITTING)]
KEEP_ENERGY = [m.function for m in (methods.MIDPOINT_TURN, methods.COMPOSED_MIDPOINT, methods.SPLITTING,
                                    methods.COMPOSED_SPLITTING)]
AT_START = np.array([1.0, 0.0, 0.0, 0.0])


def released(lesson, method, I, omega, dt, steps):
    """Return (R, L, energy over its initial value) of a free body that starts at R = 1 with this ω.

    Raises Diverged if the step raises it.
    """
    body = lesson.RigidBody(1.0, np.array(I))
    L = body.I_body * np.array(omega)
    q, end = lesson.advance_rotation(getattr(lesson, method), lesson.no_torque, 0.0, AT_START, L, dt, steps, body)
    energy = lesson.kinetic_energy(q, end, body.I_body) / lesson.kinetic_energy(AT_START, L, body.I_body)
    return quaternion_matrix(*q), end, energy


def tried(lesson, method, I, omega, dt, steps):
    """Return the same, or None if the step raises Diverged, or if its numbers are beyond a linear solver."""
    try:
        return released(lesson, method, I, omega, dt, steps)
    except (Diverged, np.linalg.LinAlgError):
        return None


def energies(lesson, method, I, omega, dt, ts):
    """Return the energy over its initial value at the times ts; NaN if its numbers are beyond a linear solver."""
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


def substeps(method):
    """Return the number of rotations of which a step of a method consists."""
    return 5 if method in COMPOSED else 1


# ---------------------------------------------------------------------------------------------- drift of energy

CYLINDER, SPUN, MS = (0.04, 0.04, 0.02), (2.0, 4.0, 6.0), 1e-3     # moments [kg m²], ω [rad/s], step [s]
SPUN_STEPS = 1_000           # of 1 ms
SPUN_FOR = SPUN_STEPS * MS   # [s]
GAINED = f"energy gained in {SPUN_FOR:g} s [-]"


def gyroscopic_energy(t, sign):
    """Return E/E₀ of a step that takes the gyroscopic term at its beginning (+1) or its end (−1), exactly.

    ω_⊥² is multiplied by 1 + (Ω dt)² per step, or divided by it.
    """
    I, w = np.array(CYLINDER), np.array(SPUN)
    turn = (I[2] - I[0]) / I[0] * w[2]
    across = I[0] * (w[0] ** 2 + w[1] ** 2) * (1.0 + (turn * MS) ** 2) ** (sign * t / MS)
    return (across + I[2] * w[2] ** 2) / np.sum(I * w * w)


def kept_L_energy(t, times=1.0):
    """Return E/E₀ of a step that keeps L and rotates with the first ω, to first order in dt.

    u = L₃² obeys the logistic equation  u̇ = ρ u (L² − u).
    """
    I, L = np.array(CYLINDER), np.array(CYLINDER) * np.array(SPUN)
    squared, u0 = L @ L, L[2] ** 2
    rate = times * MS * (I[0] - I[2]) * squared / (I[0] ** 2 * I[2])
    u = squared / (1.0 + (squared / u0 - 1.0) * np.exp(-rate * t))
    energy = lambda u: squared / (2.0 * I[0]) + 0.5 * (1.0 / I[2] - 1.0 / I[0]) * u
    return energy(u) / energy(u0)


def gyroscopic_drift_of_energy(check, energy):
    """Compare both gyroscopic steps with ±½ dt ω̇ᵀIω̇, and each with the factor of ω_⊥².

    energy: {method: gain in the run}.

    The first tolerance: sinh x = x (1 + x²/6 + …) with x = 2 · drift / share of ω_⊥ in the energy < 0.1.
    """
    I, w = np.array(CYLINDER), np.array(SPUN)
    w_dot = np.cross(I * w, w) / I
    first = 0.5 * MS * (w_dot @ (I * w_dot)) * SPUN_FOR / (0.5 * w @ (I * w))
    begin, end = energy["gyroscopic_step"], energy["implicit_gyroscopic_step"]
    check("A first-order step changes the energy by ±½ dt ω̇ᵀIω̇ per second.",
          f"half the difference between the two gyroscopic steps after {SPUN_FOR:g} s [-]",
          law=first, found=0.5 * (begin - end), within=0.1**2 / 5.0 * first,
          saw=f"{SPUN_FOR:g} s at 1 ms: {100.0 * begin:+.2f} % and {100.0 * end:+.2f} % of the energy, about "
              f"±{100.0 * first:.2f} %.")
    for method, sign, place in (("gyroscopic_step", 1, "beginning"), ("implicit_gyroscopic_step", -1, "end")):
        check(f"With the gyroscopic term at the {place} of the step ω_⊥² changes by (1 + (Ω dt)²)^(±1), exactly.",
              f"{LABEL[method]}: {GAINED}", law=gyroscopic_energy(SPUN_FOR, sign) - 1.0, found=energy[method],
              within=20.0 * EPS * SPUN_STEPS,
              saw=f"With the term at the {place} of the step the energy changes by {100.0 * energy[method]:+.4f} %, "
                  "as in the closed form.")


@case("gyroscopic-drift", "Gyroscopic drift", compiled=False)
def gyroscopic_drift(lesson, check):
    """Compare the change of energy of first-order steps with  dE/dt = ±½ dt ω̇ᵀIω̇,  ω̇ in body coordinates.

    For this cylinder that is ±0.95 % in 2 s at 1 ms.  With the gyroscopic term at the beginning,  I Δω = −dt
    ω × Iω,  so ΔE = ½ Δωᵀ I Δω > 0; at the end, minus that.  In body coordinates the cylinder's ω_⊥ rotates at
    Ω = (I₃ − I₁)/I₁ ω₃.  Explicit Euler multiplies its length by √(1 + (Ω dt)²), and implicit Euler divides it by
    the same.  That is exact, because a rotation about ω does not change ω.  If L is kept, ℓ ← e^(−dt ω*) ℓ has the
    same ΔE.  Renormalising by columns adds  dt² κ  to the rotation, κ = ½(−ω₂ω₃, ω₁ω₃, −ω₁ω₂), and for this cylinder
    twice the drift in addition.
    """
    ts = np.linspace(0.0, SPUN_FOR, 11)[1:]
    runs = {m: energies(lesson, m, CYLINDER, SPUN, MS, ts) - 1.0 for m in LABEL}
    energy = {m: gained[-1] for m, gained in runs.items()}
    gyroscopic_drift_of_energy(check, energy)
    for method, times in (("axis_angle_step", 1.0), ("quaternion_step", 1.0), ("matrix_step", 3.0)):
        law = kept_L_energy(SPUN_FOR, times) - 1.0
        check("A step that keeps L and turns with its first ω gains energy along a logistic curve.",
              f"{LABEL[method]}: {GAINED}", law=law, found=energy[method], within=2.0 * np.linalg.norm(SPUN) * MS * law,
              saw=f"{LABEL[method]}: {100.0 * energy[method]:+.2f} % in {SPUN_FOR:g} s, although L is kept to the last "
                  "digit.")
    for method in KEEP_ENERGY:
        check("A step that is exact or preserves quadratic invariants keeps L and the energy.",
              f"{LABEL[method]}: {GAINED}", law=0.0, found=energy[method], within=5.0 * 20.0 * EPS * SPUN_STEPS,
              saw=f"{LABEL[method]}: {energy[method]:+.0e} of the energy after {SPUN_STEPS:,} steps.")
    return drift_picture(ts, runs)


def drift_picture(ts, runs):
    """Draw the energy gained by six steps, and theory."""
    fine, shown = np.linspace(0.0, SPUN_FOR, 101), ("gyroscopic_step", "implicit_gyroscopic_step", "quaternion_step",
                                                    "matrix_step", "midpoint_step", "splitting_step")
    laws = (("theory, gyroscopic", gyroscopic_energy(fine, 1)),
            ("theory, gyroscopic, implicit", gyroscopic_energy(fine, -1)),
            ("theory, L kept", kept_L_energy(fine)), ("theory, renormalised", kept_L_energy(fine, 3.0)))
    return Picture(
        "Energy of a thrown cylinder at 1 ms", "t [s]", "energy gained [%]",
        [*(series(name, fine, 100.0 * (law - 1.0), LINE) for name, law in laws),
         *(series(LABEL[m], ts, 100.0 * runs[m], DOTS) for m in shown)],
        "First-order steps gain or lose energy, three times as fast if R is renormalised by columns and the axis of "
        "the cylinder is the third one. The midpoint turn keeps the energy, and so does the splitting, because two "
        "moments are equal.")


# ---------------------------------------------------------------------------------------------- too fast

FAST, FAST_STEPS = (6000.0, 0.0, 8000.0), 200        # ω [rad/s]; of 1 ms


def fast_angle():
    """Return the angle [rad] by which the fast cylinder rotates, about L and about its axis together."""
    I, L = np.array(CYLINDER), np.array(CYLINDER) * FAST
    return (np.linalg.norm(L) / I[0] + abs(1.0 - I[2] / I[0]) * FAST[2]) * FAST_STEPS * MS


@case("fast-spin", "Spin at 10⁴ rad/s", compiled=False)
def fast_spin(lesson, check):
    """Check that steps of a cylinder at 10⁴ rad/s with 10 rad per step keep L, and that the splitting is exact.

    L does not change if it is the state.  The splitting is exact because two moments are equal.  An angle of N rad
    is known to about 16 rounding errors of N/2⁵³.  The gyroscopic term at the beginning multiplies ω_⊥ by √(1 + (Ω
    dt)²) = √17 per step.
    """
    I, steps, seconds, angle = np.array(CYLINDER), FAST_STEPS, FAST_STEPS * MS, fast_angle()
    runs = {m: tried(lesson, m, CYLINDER, FAST, MS, steps) for m in LABEL}
    check("A step with L as its state keeps L at any spin.",
          f"largest change of L in {len(KEEP_L)} steps of the lesson [kg m²/s]", law=0.0,
          found=np.max([np.abs(runs[m][1] - I * FAST).max() if runs[m] else np.inf for m in KEEP_L]), within=0.0,
          saw=f"At 10⁴ rad/s and 10 rad per step, {steps:,} steps change no digit of L.")
    for method in ("splitting_step", "composed_splitting_step"):
        off = relative_turn(runs[method][0], symmetric_top(I, np.array(FAST), seconds))
        check("With two equal moments the splitting turn is exact at any spin.",
              f"{LABEL[method]}: error of the orientation after {seconds:g} s [rad]",
              law=0.0, found=off, within=16.0 * EPS * angle * substeps(method),
              saw=f"After {angle:,.0f} rad the orientation is off by {off:.0e} rad.")
    for method in ("midpoint_step", "composed_midpoint_step"):
        gained = runs[method][2] - 1.0 if runs[method] else np.nan
        check("The midpoint turn keeps the energy at any spin, but not the orientation.",
              f"{LABEL[method]}: energy gained in {seconds:g} s [-]",
              law=0.0, found=gained, within=5.0 * 20.0 * EPS * steps,
              saw=f"{LABEL[method]}: {gained:+.0e} of the energy at 10 rad per step.")
    refused = runs["gyroscopic_step"] is None
    check("With the gyroscopic term at the beginning ω_⊥ grows by √17 per step: the run must end in an error "
          "instead of a number.", "runs that raise Diverged [of 1]", law=1, found=refused, within=0.0,
          saw=f"The lecture's loop {'raises an error' if refused else 'returns a number'}.")
    return spin_picture(lesson, I, angle)


def spin_picture(lesson, I, angle):
    """Draw the error of three steps over the spin."""
    spins = np.logspace(1.0, 5.0, 13)
    drawn = [log_series("theory, 16 roundings of the angle", spins, 16.0 * EPS * angle / 1e4 * spins, LINE)]
    for method in ("splitting_step", "midpoint_step", "runge_kutta_step"):
        errors = []
        for omega in spins[:, None] / 1e4 * np.array(FAST):
            run = tried(lesson, method, CYLINDER, omega, MS, FAST_STEPS)
            truth = symmetric_top(I, omega, FAST_STEPS * MS)
            errors.append(max(relative_turn(run[0], truth), 1e-16) if run else np.pi)
        drawn.append(log_series(LABEL[method], spins, errors, DOTS))
    return Picture(
        "A cylinder at increasing spin, 1 ms per step", "log₁₀ of the spin [rad/s]",
        f"log₁₀ of the error after {FAST_STEPS * MS:g} s [rad]", drawn,
        "The splitting loses only the digits that the angle itself loses to rounding. The other steps fail where "
        "they turn by about a radian per step.")


# ---------------------------------------------------------------------------------------------- a needle

NEEDLE, PRICKED = (1.0, 1.0, 1e-6), (1.0, 0.5, 1000.0)
PRICKED_STEPS = 1000         # of 1 ms


@case("slender-body", "A needle", compiled=False)
def slender_body(lesson, check):
    """Compare the energy of a needle, I₃ = 10⁻⁶ I₁, at one radian per step, with the accuracy of L₃.

    L₃ = 10⁻³ is a small difference, known to 10⁻¹⁶ |L| per step.  ω₃ = L₃/I₃.  Any orientation has an energy between
    L²/2I₁ and L²/2I₃.
    """
    I, w, seconds = np.array(NEEDLE), np.array(PRICKED), PRICKED_STEPS * MS
    energy = 0.5 * (I * w) @ w
    blurred = 4.0 * EPS * PRICKED_STEPS * np.linalg.norm(I * w)          # of L₃, if all roundings have one sign
    runs = {m: tried(lesson, m, NEEDLE, PRICKED, MS, PRICKED_STEPS) for m in LABEL}
    for method in KEEP_ENERGY:
        gained = runs[method][2] - 1.0 if runs[method] else np.nan
        check("The energy of a needle is kept to the accuracy of L₃.",
              f"{LABEL[method]}: energy gained in {seconds:g} s [-]",
              law=0.0, found=gained, within=substeps(method) * blurred * w[2] / energy,
              saw=f"{LABEL[method]}: {gained:+.0e} of the energy.")
    off = relative_turn(runs["splitting_step"][0], symmetric_top(I, w, seconds))
    check("Its spin is ω₃ = L₃/I₃, so the angle is known to T δL₃/2I₃.",
          f"{LABEL['splitting_step']}: error of the orientation after {seconds:g} s [rad]",
          law=0.0, found=off, within=0.5 * blurred / I[2] * PRICKED_STEPS * MS,
          saw=f"After {w[2] * PRICKED_STEPS * MS:,.0f} rad about its axis the needle is off by {off:.0e} rad.")
    bounds = np.linalg.norm(I * w) ** 2 / (2.0 * I[0]) / energy, np.linalg.norm(I * w) ** 2 / (2.0 * I[2]) / energy
    needle_stays_finite(check, runs, bounds)
    ts = np.linspace(0.0, seconds, 21)[1:]
    shown = "splitting_step", "midpoint_step", "quaternion_step", "runge_kutta_step"
    drawn = [series(LABEL[m], ts, np.log10(energies(lesson, m, NEEDLE, PRICKED, MS, ts)), DOTS) for m in shown]
    drawn.append(series("greatest possible", (0.0, seconds), np.log10((bounds[1], bounds[1])), LINE))
    drawn.append(series("least possible", (0.0, seconds), np.log10((bounds[0], bounds[0])), LINE))
    return Picture(
        "Energy of a needle, one radian per step", "t [s]", "log₁₀ of energy over its value at the start [-]", drawn,
        "Splitting and midpoint keep the energy; the others vary between the bounds that L sets.")


def needle_stays_finite(check, runs, bounds):
    """Check that runs end in finite numbers or errors, and compare their energies with the bounds that L sets."""
    ended = sum(run is None or bool(np.all(np.isfinite(run[0])) and np.isfinite(run[2])) for run in runs.values())
    refused = [LABEL[m] for m, run in runs.items() if run is None]
    check("A step ends in finite numbers or raises an error.", f"steps that do so [of {len(runs)}]",
          law=len(runs), found=ended, within=0.0,
          saw=f"Of {len(runs)} steps {len(refused)} refused: {', '.join(refused)}.")
    least, most = (1.0 - 1e-9) * bounds[0], (1.0 + 1e-9) * bounds[1]
    inside = sum(runs[m] is None or least <= runs[m][2] <= most for m in KEEP_L)
    check("If L is kept the energy stays between L²/2I₁ and L²/2I₃, for any error of the orientation.",
          f"steps that stay inside [of {len(KEEP_L)}]", law=len(KEEP_L), found=inside, within=0.0,
          saw=f"{inside} of {len(KEEP_L)} steps stay between {bounds[0]:.2f} and {bounds[1]:,.0f} times the "
              "initial energy.")


# ---------------------------------------------------------------------------------------------- a sleeping top

ACROSS, ALONG, MGL = 5.0, 1.0, 20.0                       # I₁, I₃ about the pivot [kg m²], Mgl [N m]
ASLEEP = 1e-7  # initial tilt [rad]: its square is round-off, so it obeys a linear equation
AWAKE = 500.0                # a top has fallen at this multiple of that tilt [-]
WATCHED = 200.0              # duration of a run [s]
STANDS = np.sqrt(4.0 * ACROSS * MGL) / ALONG             # least spin of a sleeping top [rad/s]


def tilts(lesson, spin, tilt, dt, seconds, look):
    """Yield the tilt [rad] of a top released with only its spin: at the start, then every `look` steps."""
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
    """Return whether the tilt of the top is AWAKE times the first one at any multiple of 2 s."""
    return any(tilt > AWAKE * ASLEEP for tilt in tilts(lesson, spin, ASLEEP, 0.02, WATCHED, 100))


def fallen(lesson, spin, look=1):
    """Return the largest tilt [rad] in 40 s from nearly upright: enough for one fall unless within 2 % of the edge."""
    return np.max(list(tilts(lesson, spin, 1e-5, 0.01, 40.0, look)))


def lowest_cosine(spin):
    """Return cos θ at which a top that falls from upright turns back."""
    return (ALONG * spin) ** 2 / (2.0 * ACROSS * MGL) - 1.0


@case("sleeping-top", "A sleeping top", in_quick=False)
def sleeping_top(lesson, check):
    """Check that a sleeping top stands if and only if ω₃² > 4I₁Mgl/I₃²: 20 rad/s here.

    Near the vertical ξ = θ e^(iφ) obeys  I₁ξ̈ − iI₃ω₃ξ̇ − Mgl ξ = 0.  With a = I₃ω₃/2I₁ and λ² = Mgl/I₁ − a²
        |ξ/ξ₀|² = cosh² λt + (a/λ)² sinh² λt                  from rest,
    which reaches AWAKE in time t if  sinh(λt)/λt ≈ AWAKE/at:  for t = 200 s at λ = 0.006, where ω₃ is λ²I₁/2Mgl = 4e-6
    below the edge.  A top that falls from upright falls as far as  cos θ = I₃²ω₃²/2I₁Mgl − 1.
    """
    measured = 2.0 * STANDS - bisect(lambda slower: falls(lesson, 2.0 * STANDS - slower), 0.8 * STANDS, 1.2 * STANDS)
    check("A top stands upright if ω₃² > 4 I₁Mgl/I₃².", "least spin at which it stands [rad/s]",
          law=STANDS, found=measured, within=STANDS * (5e-6 + 1.2 * EDGE),
          saw=f"The top falls below {measured:.4f} rad/s, and stands above.")
    flips = falls(lesson, 0.999 * STANDS) and not falls(lesson, 1.001 * STANDS)
    check("The edge flips within ±0.1 %.", "edges that flip [of 1]", law=1, found=flips, within=0.0,
          saw="A thousandth below the edge the top "
              f"{'falls, a thousandth above it stands' if flips else 'does not behave as above it'}.")
    tilt_of_a_top(lesson, check)
    spins, fine = np.linspace(12.0, 24.0, 13), np.linspace(12.0, 24.0, 121)
    return Picture(
        "How far a sleeping top falls", "spin [rad/s]", "largest tilt [°]",
        [series("theory", fine, np.degrees(np.arccos(np.minimum(1.0, lowest_cosine(fine)))), LINE),
         series("measured", spins, [np.degrees(fallen(lesson, s, 5)) for s in spins], DOTS)],
        "Above 20 rad/s the top stays upright, asleep. Below that it wakes, tilts as far as its energy permits, and "
        "comes back.")


def tilt_of_a_top(lesson, check):
    """Compare small tilts with the linear equation, and the fall of a top with its energy.

    The method is of fourth order at the faster rate a + |λ| < 3 rad/s: 30 (0.03)⁴.  Tilts are below 1e-4 rad, and
    their squares below 1e-8.  Between two samples of a fall, 10 ms apart, cos θ changes by at most ½ü (5 ms)² with
    ü = Mgl/I₁ (1 − u)², u = cos θ; the method adds the same error, with rate 10.
    """
    seconds, fourth = 10.0, 30.0 * 0.03**4
    for spin in (19.0, 21.0):
        a = ALONG * spin / (2.0 * ACROSS)
        rate = np.sqrt(complex(MGL / ACROSS - a * a))
        law = abs(np.cosh(rate * seconds) + 1j * a / rate * np.sinh(rate * seconds))
        leans = np.array(list(tilts(lesson, spin, ASLEEP, 0.01, seconds, 1))) / ASLEEP
        check("Its tilt follows a linear equation.", f"tilt after 10 s over its first, at {spin:g} rad/s [-]",
              law=law, found=leans[-1], within=law * (fourth + 1e-8),
              saw=f"At {spin:g} rad/s the tilt is {leans[-1]:.5g} times its first after 10 s, and "
                  f"{leans.max():.4g} times at most.")
    reached, lowest = fallen(lesson, 19.0), lowest_cosine(19.0)
    check("A top that falls from upright falls as far as cos θ = I₃²ω₃²/2I₁Mgl − 1.",
          "least cos θ at 19 rad/s [-]", law=lowest, found=np.cos(reached),
          within=0.5 * MGL / ACROSS * (1.0 - lowest) ** 2 * 0.005**2 + fourth,
          saw=f"At 19 rad/s it falls to {np.degrees(reached):.2f}°, and rises again.")


# ---------------------------------------------------------------------------------------------- laws

TRIED = 25                   # random bodies [-]


def turned_by(phi):
    """Return R (3, 3) of a rotation by |φ| about φ."""
    angle = np.sqrt(phi @ phi)
    return about(phi / angle, angle)


def cayley(phi):
    """Return R (3, 3) of a rotation by 2 atan ½|φ| about φ: the normalised quaternion q + ½ (0, φ) q."""
    angle = np.sqrt(phi @ phi)
    return about(phi / angle, 2.0 * np.arctan(0.5 * angle))


def gram_schmidt(M):
    """Return the orthonormal columns of M, the first of them parallel to its first."""
    Q, upper = np.linalg.qr(M)
    return Q * np.sign(np.diag(upper))


def random_turn(rng):
    """Return a random orientation, as a unit quaternion and as a matrix."""
    q = rng.normal(size=4)
    q /= np.linalg.norm(q)
    return q, quaternion_matrix(*q)


@random_law("A load does the same work as its forces on every rigid motion.", "power: largest relative error [-]",
            1e-12)
def load(lesson, rng):
    x, points, forces = rng.normal(size=3), rng.normal(size=(5, 3)), rng.normal(size=(5, 3))
    F, tau = lesson.total_load(x, points, forces)
    motions = rng.normal(size=(6, 2, 3))
    work = [np.sum(forces * (V + np.cross(omega, points - x))) for V, omega in motions]
    size = np.sum(np.abs(forces))
    return np.array([F @ V + tau @ omega for V, omega in motions]) / size, np.array(work) / size


@random_law("The state changes by P/M, ω × R, F and τ.", "derivative of the state: largest relative error [-]", 1e-12)
def derivative_of_the_state(lesson, rng):
    (_, R), m, I_body = random_turn(rng), rng.uniform(0.5, 2.0), rng.uniform(1.0, 1.9, 3)
    x, P, L, F, tau = rng.normal(size=(5, 3))
    rate = lesson.state_derivative(lesson.RigidBodyState(x, R, P, L), F, tau, lesson.RigidBody(m, I_body))
    omega = np.linalg.solve(R @ np.diag(I_body) @ R.T, L)
    return relative((tuple(rate), (P / m, cross_matrix(omega) @ R, F, tau)))


@random_law("A rotation about the middle axis is unstable, with the rate of the linearised Euler equations.",
            "rate of growth over the spin: largest error [-]", 1e-10)
def growth(lesson, rng):
    I_body, k = rng.uniform(1.0, 1.9, 3), int(rng.integers(3))
    spin = rng.choice([-1.0, 1.0]) * rng.uniform(0.5, 5.0)
    euler, axis = lambda w: np.cross(I_body * w, w) / I_body, spin * np.eye(3)[k]
    matrix = np.stack([0.5 * (euler(axis + e) - euler(axis - e)) for e in np.eye(3)], axis=1)
    rate = max(0.0, np.linalg.eigvals(matrix).real.max())
    return lesson.tumbling_rate(I_body, k, spin) / abs(spin), rate / abs(spin)


@case("loads-and-derivatives", "Loads, derivatives, and the tennis racket", compiled=False)
def loads_and_derivatives(lesson, check):
    """Compare loads with their power on every rigid motion: Σ f · (V + ω × r) = F · V + τ · ω.

    Ṡ is compared with P/M, F, τ and ω × each axis, ω from a linear solve.  The growth rate of a disturbance is the
    largest real part of the eigenvalues of Euler's equations, linearised by differences that are exact for them,
    because they are quadratic.
    """
    check.laws(lesson, (load, derivative_of_the_state, growth), seed=55, times=50)


@case("going-round-and-over", "Steady precession, and a thrown body of one's own", compiled=False)
def going_round_and_over(lesson, check):
    """Compare the predicted precession with  Ω ẑ × L = τ,  and a thrown body with its time between two flips."""
    I, mgl, spin = np.array([5.0, 5.0, 1.0]), 20.0, 30.0
    for tilt in (0.3, 2.5):
        rate, e = lesson.precession_rate(I, mgl, tilt, spin), np.array([np.sin(tilt), 0.0, np.cos(tilt)])
        turning = np.array([0.0, 0.0, rate])
        L = I[0] * (turning - turning @ e * e) + I[2] * spin * e
        found = np.cross(turning, L)[1] / np.cross(e, [0.0, 0.0, -mgl])[1]
        check("A top goes steadily round as its torque turns L.",
              f"|Ω ẑ × L| over the torque at a tilt of {tilt:g} rad [-]", law=1.0, found=found, within=1e-13,
              saw=f"At a tilt of {tilt:g} rad the top goes round at {rate:.4g} rad/s.")
    m, x, size, omega = lesson.my_thrown_body(1.5)
    r = x - m @ x / m.sum()
    spread = (m[:, None] * r).T @ r + np.diag(m @ size**2) / 12.0
    moments, axes = np.linalg.eigh(np.trace(spread) * np.eye(3) - spread)
    first, second = FreeTop(moments, axes.T @ omega).flips()
    check("A thrown body of one's own turns over in time.", "time between two flips [s]", law=1.5, found=second - first,
          within=0.03, saw=f"It turns over every {second - first:.4g} s.")


# ---------------------------------------------------------------------------------------------- one step

def random_motion(lesson, rng):
    """Return a free body with unequal moments under a torque (t, q, L, body) of time and orientation, and a step of it.

    Its fields are body, q, R, L, t, dt, torque, and tau(t, R) [N m], which has a part at rest in the world and one at
    rest in the body.
    """
    (q, R), (L, a, b) = random_turn(rng), rng.normal(size=(3, 3))
    tau = lambda t, R: np.cos(3.0 * t) * a + np.sin(2.0 * t) * (R @ b)
    return SimpleNamespace(
        body=lesson.RigidBody(1.0, rng.uniform(1.0, 1.9, 3)), q=q, R=R, L=L, t=rng.uniform(), dt=rng.uniform(0.05, 0.3),
        tau=tau, torque=lambda t, q, L, body: tau(t, quaternion_matrix(*q)))


def written_again(method, on, n=1):
    """Return [(R, L)] before and after each of n steps of a motion by the reference.

    The torque of the reference depends on the orientation only.  Its k-th call in a step gets the torque of the k-th
    time in `torques`.
    """
    turn = TURN[method]
    w, x, y, z = on.q
    q, L, states = (complex(w, -z), complex(-y, -x)), tuple(on.L), [(on.R, on.L)]
    for k in range(n):
        clock = iter(on.t + (k + np.array(turn.torques)) * on.dt)
        q, L = turn.step(lambda M, clock=clock: on.tau(next(clock), np.array(M)), q, L, on.body.I_body, on.dt)
        states.append((np.array(turns.matrix(q)), np.array(L)))
    return states


def one_step_of(method, lesson, rng):
    """Compare one step of a method with its independent form."""
    on = random_motion(lesson, rng)
    q, L = getattr(lesson, method)(on.torque, on.t, on.q, on.L, on.dt, on.body)
    return (quaternion_matrix(*q), L), written_again(method, on)[-1]


@random_law("Each update rotates by its own law: forwards, backwards, and slowly.",
            "largest error of the orientation [-]", 1e-12)
def updates(lesson, rng):
    (q, R), omega, dt = random_turn(rng), rng.normal(size=3), rng.uniform(0.05, 0.3)
    got, truth = [], []
    for w, h in ((omega, dt), (omega, -dt), (1e-5 * omega, dt)):
        got += [lesson.matrix_update(R, w, h), lesson.axis_angle_update(R, w, h),
                quaternion_matrix(*lesson.quaternion_update(q, w, h))]
        truth += [gram_schmidt(R + h * cross_matrix(w) @ R), turned_by(h * w) @ R, cayley(h * w) @ R]
    return np.array(got), np.array(truth)


@random_law("Splitting is exact for a symmetric body.",
            "largest error of the orientation of a symmetric body [-]", 1e-12)
def symmetric_bodies(lesson, rng):
    """Rotate the body about L and about its axis, both at once."""
    (q, R), L, dt, k = random_turn(rng), rng.normal(size=3), rng.uniform(0.05, 0.3), int(rng.integers(3))
    across, along = rng.uniform(1.0, 1.9, 2)
    I = np.where(np.arange(3) == k, along, across)
    own = about(np.eye(3)[k], dt * (1.0 / along - 1.0 / across) * (R.T @ L)[k])
    got = quaternion_matrix(*lesson.splitting_free_rotation(q, L, I, dt))
    return got, turned_by(dt / across * L) @ R @ own


@random_law("Many steps are single steps, each at its own time.", "largest error of the history [s, -, kg m²/s]", 1e-12)
def histories(lesson, rng):
    """Compare a history and the end of a run with three single steps."""
    on = random_motion(lesson, rng)
    states = written_again("quaternion_step", on, 3)
    run = lesson.quaternion_step, on.torque, on.t, on.q, on.L, on.dt, 3, on.body
    (ts, qs, Ls), (q, L) = lesson.rotation_trajectory(*run), lesson.advance_rotation(*run)
    truth = [np.array(part) for part in zip(*states, strict=True)]
    return (ts, np.array([quaternion_matrix(*q) for q in qs]), Ls, quaternion_matrix(*q), L), \
        (on.t + on.dt * np.arange(4), *truth, *states[-1])


@random_law("A product of quaternions is the product of their matrices.", "largest error of the matrix [-]", 1e-12)
def products(lesson, rng):
    (p, first), (q, second) = random_turn(rng), random_turn(rng)
    return (quaternion_matrix(*lesson.quaternion_product(p, q)), lesson.rotation_matrix(q)), (first @ second, second)


@random_law("The energy of rotation is ½ L · I⁻¹ L in the world.", "largest error of the energy [J]", 1e-12)
def energy_of_rotation(lesson, rng):
    (q, R), L, I = random_turn(rng), rng.normal(size=3), rng.uniform(1.0, 1.9, 3)
    return lesson.kinetic_energy(q, L, I), 0.5 * L @ np.linalg.solve(R @ np.diag(I) @ R.T, L)


@random_law("The torque of gravity on a top about its pivot is l𝐞 × (−Mg ẑ).", "largest error of the torque [N m]",
            1e-12)
def torque_of_a_top(lesson, rng):
    (q, R), L, I = random_turn(rng), rng.normal(size=3), rng.uniform(1.0, 1.9, 3)
    return lesson.heavy_top_torque(0.0, q, L, lesson.Top(I, 2.5)), np.cross(R[:, 2], [0.0, 0.0, -2.5])


@random_law("A point of a body moves with v + ω × r.", "largest error of the velocity [m/s]", 1e-12)
def velocities(lesson, rng):
    v, omega, r = rng.normal(size=(3, 3))
    return (lesson.point_velocity(v, omega, r), lesson.skew(omega)), (v + np.cross(omega, r), cross_matrix(omega))


@case("one-step", "One step of each rotation", compiled=False)
def one_step(lesson, check):
    """Compare each step with an independent form by complex numbers.

    The moments are unequal, the orientation is random, and the torque depends on time and orientation.  All other
    laws are written with matrices.
    """
    steps = [Law(f"One step of {LABEL[name]} agrees with an independent form in complex numbers.",
                 f"{LABEL[name]}: largest error of a step [-, kg m²/s]", 1e-11, partial(one_step_of, name))
             for name in LABEL]
    check.laws(lesson, (*steps, updates, symmetric_bodies, histories, products, energy_of_rotation, torque_of_a_top,
                        velocities), seed=56, times=TRIED)


# ---------------------------------------------------------------------------------------------- the lecture's loop

@random_law("The loop uses new velocities for positions, and Euler's equation for ω.",
            "loop: largest error of the state [m, m/s, -, rad/s]", 1e-10)
def loop(lesson, rng):
    """Take one step and two under the force f cos t and the torque a sin t."""
    (q, R), m, I = random_turn(rng), rng.uniform(0.5, 2.0), rng.uniform(1.0, 1.9, 3)
    (x, v, omega, f, a), t, dt = rng.normal(size=(5, 3)), rng.uniform(), rng.uniform(0.01, 0.1)
    force = lambda t, x, q, v, omega, body: (np.cos(t) * f, np.sin(t) * a)
    begin, body, got, truth = (x, q, v, omega), lesson.make_rigid_body(m, I), [], []
    for steps in (1, 2):
        now, tensor = t + (steps - 1) * dt, R @ np.diag(I) @ R.T
        v = v + dt / m * np.cos(now) * f
        omega = omega + dt * np.linalg.solve(tensor, np.sin(now) * a - np.cross(omega, tensor @ omega))
        x, R = x + dt * v, cayley(dt * omega) @ R
        end = lesson.advance_rigid_body(lesson.rigid_body_step, force, t, *begin, dt, steps, body)
        got += [end[0], quaternion_matrix(*end[1]).ravel(), *end[2:]]
        truth += [x, R.ravel(), v, omega]
    return tuple(got), tuple(truth)


def random_ball(lesson, rng):
    """Return (ball, m, state) of a ball of any size on a floor; its state is t, x, q, v, ω."""
    m, (radius, mu, inertia) = rng.uniform(0.5, 2.0), rng.uniform((0.1, 0.2, 0.01), (0.5, 0.5, 0.1))
    gravity = np.array([*rng.normal(size=2), -9.81])
    x, v, omega = rng.normal(size=(3, 3))
    ball = lesson.RollingBall(m, np.full(3, inertia), radius, mu, gravity)
    return ball, m, (rng.uniform(), x, random_turn(rng)[0], v, omega)


def rolled(lesson, rng, least, most):
    """Return a ball's step whose slip is between `least` and `most` times the slip that friction can stop in it.

    Its fields: ball, begin (t, x, q, v, ω) and dt; the lever arms r and the slip before, without friction; the largest
    impulse of friction `limit`; the new velocities v and ω, and the impulse J of friction.
    """
    ball, m, (t, x, q, v, omega) = random_ball(lesson, rng)
    dt, along, r = rng.uniform(0.01, 0.1), np.array([1.0, 1.0, 0.0]), np.array([0.0, 0.0, -ball.radius])
    limit = ball.mu * m * 9.81 * dt
    size = rng.uniform(least, most) * limit * (1.0 / m + ball.radius**2 / ball.I_body[0])
    before = size * v * along / np.linalg.norm(v * along)
    start = before - (np.cross(omega, r) + dt * ball.gravity) * along
    _, _, end, spin = lesson.rolling_step(lesson.supported_weight, t, x, q, start, omega, dt, ball)
    return SimpleNamespace(ball=ball, begin=(t, x, q, start, omega), dt=dt, r=r, before=before, limit=limit, v=end,
                           omega=spin, J=m * (end - start - dt * ball.gravity * along))


@random_law("The second-order step moves and turns by the means of the old and the new velocities.",
            "means: largest error of the state of the ball [m, -, m/s, rad/s]", 1e-10)
def means(lesson, rng):
    on = rolled(lesson, rng, 0.0, 3.0)
    _, x, q, v, omega = on.begin
    new_x, new_q, *rates = lesson.average_rolling_step(lesson.supported_weight, *on.begin, on.dt, on.ball)
    R = turned_by(0.5 * on.dt * (omega + on.omega)) @ quaternion_matrix(*q)
    return (new_x, quaternion_matrix(*new_q), *rates), (x + 0.5 * on.dt * (v + on.v), R, on.v, on.omega)


@random_law("A floor supports a ball that presses on it, and does not hold a ball that is lifted.",
            "support: largest error of the force [N]", 1e-10)
def support(lesson, rng):
    ball, m, state = random_ball(lesson, rng)
    forces, truth = [], []
    for up in (-9.81, 2.0):                                      # gravity presses the ball on the floor, or lifts it
        gravity = np.array([*ball.gravity[:2], up])
        forces += lesson.supported_weight(*state, ball._replace(gravity=gravity))
        truth += [m * np.maximum(gravity, [-np.inf, -np.inf, 0.0]), np.zeros(3)]
    return np.array(forces), np.array(truth)


@random_law("Friction changes the angular momentum of the ball by r × J.",
            "impulse: largest error of the angular momentum [kg m²/s]", 1e-10)
def turn_of_friction(lesson, rng):
    on = rolled(lesson, rng, 0.0, 3.0)
    return on.ball.I_body * (on.omega - on.begin[-1]), np.cross(on.r, on.J)


@random_law("Against a fast slip acts the friction μ N.", "cone: largest error of the impulse [N s]", 1e-10)
def fast_slip(lesson, rng):
    on = rolled(lesson, rng, 1.01, 5.0)
    return on.J, -on.limit * on.before / np.linalg.norm(on.before)


@random_law("A slow slip is stopped within the step.", "slip: largest error of the slip that is left [m/s]", 1e-10)
def slow_slip(lesson, rng):
    on = rolled(lesson, rng, 0.0, 0.99)
    return (on.v + np.cross(on.omega, on.r))[:2], np.zeros(2)


@case("one-step-of-the-loop", "One step of the lecture's loop, and of a rolling ball", compiled=False)
def one_step_of_the_loop(lesson, check):
    """Check steps of a body under a force and a torque of time, and of a ball with friction in the cone."""
    check.laws(lesson, (loop, means, support, turn_of_friction, fast_slip, slow_slip), seed=57, times=TRIED)


# ---------------------------------------------------------------------------------------------- a million steps

LONG_RUN, SHORT_RUN = 10**6, 10**3   # steps: compiled, and in plain Python
THROWN = 2                   # tops, thrown at random


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


@case("a-million-steps", "A million steps of a top", in_quick=False)
def a_million_steps(lesson, check):
    """Check that L_z and L₃ of a top are constant: gravity has no torque about the vertical, nor about a symmetry axis.

    The splitting keeps both, so rounding alone changes them.  The torque is computed with a vertical component of
    exactly 0, so L_z keeps every bit.  Each step divides q by its length, which is rounded.  That is the same
    deviation in every step, and L₃ drifts by n times it, at most n ε.
    """
    rng, longest = np.random.default_rng(7), LONG_RUN if hasattr(lesson.splitting_step, "py_func") else SHORT_RUN
    places, spins = rng.normal(size=(THROWN, 4)), 10.0 * rng.normal(size=(THROWN, 3))
    tops = [(q / np.linalg.norm(q), L) for q, L in zip(places, spins)]
    counts = np.array([longest // 100, longest // 10, longest])
    vertical, axial = np.moveaxis([drifts(lesson, n, tops) for n in counts.tolist()], 2, 0)
    check.agree("The angular momentum about the vertical keeps every bit.",
                f"change of L_z after {longest:,} steps, over |L| [-]", np.max(np.abs(vertical)), 0.0)
    check.agree("Rounding changes the angular momentum about the axis by less than ε per step.",
                f"change of L₃ after {longest:,} steps, over |L| [-]", np.max(np.abs(axial[-1])), longest * EPS)
    return Picture(
        "The angular momentum of a top about its axis", "log₁₀ of the steps [-]", "log₁₀ of its change over |L| [-]",
        [log_series("ε per step", counts, EPS * counts, LINE),
         log_series("measured", counts, np.sqrt(np.mean(axial**2, axis=1)), DOTS)],
        "Rounding errors add up, because every step rounds in the same way. After a million steps eleven digits are "
        "left.")
