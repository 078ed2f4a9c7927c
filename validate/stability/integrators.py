"""Stability limits of the integrators: the longest step that theory permits each method, compared with an experiment.

    ẍ = −ω² x − 2ζω ẋ        hω: step times angular frequency [-], ζ: damping ratio [-]

The experiment is always a run of many steps of the lesson's own method, never its formula.  Two oscillators share
one run, from (x, v) = (1, 0) and (0, 1).  Their final states form the (2, 2) matrix M of all N steps together, and
the motion grows per step by |largest eigenvalue of M|^(1/N), independent of the phase at which the run stops.  The
edge of stability is where that factor passes 1, found by bisection on hω.

The first case draws all methods into one picture.
*Source:* Hairer and Wanner 1996, "Solving ordinary differential equations II", IV.2; Hairer, Lubich, Wanner 2006.
"""

from functools import partial
from typing import NamedTuple

import numpy as np
from scipy.integrate import solve_ivp

from solutions.checks import Diverged
from validate.methods import (
    AVERAGE_VELOCITY,
    BLANES_MOAN,
    EULER,
    IMPLICIT_EULER,
    IMPLICIT_MIDPOINT,
    INTEGRATORS,
    MIDPOINT,
    RK4,
    SYMPLECTIC_EULER,
    VERLET,
)
from validate.reference import schemes
from validate.reference.integrators import Planet, adaptive_march, orbit, perihelion
from validate.stability.case import DOTS, EDGE, LINE, Picture, bisect, case, jitted, random_law, refuse, series

OMEGA = 3.0                  # angular frequency of the runs [rad/s]: not 1, so that h mistaken for hω would show
STEPS = 499  # of one run: a prime, so that no run ends at its start, where eigenvalues meet and round-off grows
# accuracy of the measured growth per step: fifty roundings of 1.1e-16, times ω between x and v, rounded up
GROWTH = 1e-13
NEWTON = 1e-12               # accuracy of the velocity of an implicit method, where Newton's method stops [m/s]
# growth below this counts as stable: far above round-off, far below the 2e-5 of Euler 0.1 % beyond its edge
NOISE = 1e-9
# range of hω in which edges are searched
SHORTEST = 0.05
LONGEST = 4.0
CELLS = 120                  # of a map of amplification, in each direction


# ---------------------------------------------------------------------------------------------- the experiment

def growth(lesson, method, h_omega, zeta=0.0, steps=STEPS):
    """Return the factor [-] by which an oscillator's motion grows per step; infinite if the run diverges."""
    step, p = getattr(lesson, method.function), lesson.Oscillator(OMEGA, zeta)
    x, v = np.array([1.0, 0.0]), np.array([0.0, 1.0])
    try:
        end = lesson.advance(step, lesson.oscillator_acceleration, 0.0, x, v, h_omega / OMEGA, steps, p)
    except (Diverged, np.linalg.LinAlgError):
        return np.inf
    factor = float(lesson.spectral_radius(np.array(end))) ** (1.0 / steps)
    return factor if np.isfinite(factor) else np.inf


def growth_curves(lesson, label, method, law, dots, fine, steps=STEPS):
    """Return two curves of the growth per step over hω: law(hω) of theory, and that of runs."""
    rates = [growth(lesson, method, y, steps=steps) for y in dots]
    return [series(f"{label}theory", fine, law(fine), LINE), series(f"{label}measured", dots, rates, DOTS)]


def grows(lesson, method, h_omega, zeta=0.0):
    """Return whether the motion grows by more than noise."""
    return growth(lesson, method, h_omega, zeta) > 1.0 + NOISE


def edge(lesson, method, zeta):
    """Return the hω at which the motion begins to grow, by bisection."""
    return bisect(lambda h_omega: grows(lesson, method, h_omega, zeta), SHORTEST, LONGEST)


def flips(lesson, method, edges):
    """Count the edges {ζ: hω} that flip within ±0.1 %: bounded at 0.999 times that step, growing at 1.001 times."""
    return sum(
        not grows(lesson, method, 0.999 * h, zeta) and grows(lesson, method, 1.001 * h, zeta)
        for zeta, h in edges.items()
    )


def departure(measured, edges):
    """Return the largest relative error of measured edges {ζ: hω}; the absolute error where theory gives 0."""
    return np.max([abs(measured[zeta] - h) / (h or 1.0) for zeta, h in edges.items()])


def turning(lesson, method, h_omega, steps, flatness=1.0):
    """Return the mean angle [rad] by which a step rotates the motion, on an ellipse with axes 1 (x) and flatness (v/ω).

    On a wrong ellipse the angle alternately leads and lags, but the mean over many steps stays the same.
    """
    step, p = getattr(lesson, method.function), lesson.Oscillator(OMEGA, 0.0)
    _, xs, vs = lesson.trajectory(step, lesson.oscillator_acceleration, 0.0, np.ones(1), np.zeros(1),
                                  h_omega / OMEGA, steps, p)
    return np.unwrap(np.arctan2(-vs[:, 0] / (flatness * OMEGA), xs[:, 0]))[-1] / steps


# ---------------------------------------------------------------------------------------------- the theory of edges

def runge_kutta_edge(weights, zeta):
    """Return the smallest hω > 0 with |R(hs)| = 1:  R(z) = Σ weightsₖ zᵏ,  s = −ζ − √(ζ² − 1).

    s is the faster root of s² + 2ζs + 1 = 0.
    """
    s = -zeta - np.sqrt(complex(zeta * zeta - 1.0))
    R = np.array([w * s**k for k, w in enumerate(weights)])[::-1]
    roots = np.roots(np.polysub(np.polymul(R, R.conj()).real, [1.0]))
    return min(
        r.real for r in roots if abs(r.imag) < 1e-6 and r.real > SHORTEST
    )  # 1e-6: a root this near the axis is real


def euler_edge(zeta):
    """Return the hω at which |1 + hs| = 1.

    It is 2ζ for a complex pair, ζ ≤ 1, and 2(ζ − √(ζ² − 1)) for the faster of two real roots.
    """
    return 2.0 * zeta if zeta <= 1.0 else 2.0 * (zeta - np.sqrt(zeta * zeta - 1.0))


def symplectic_euler_edge(zeta):
    """Return the hω at which an eigenvalue reaches −1: 1 + tr A + det A = 4 − 4ζ hω − (hω)² = 0."""
    return 2.0 * (np.sqrt(1.0 + zeta * zeta) - zeta)


def average_velocity_edge(zeta):
    """Return the smaller of two edges.

    det A = 1 − 2ζ hω + ½(hω)² passes 1 at hω = 4ζ;  tr A + det A = 3 − 4ζ hω passes −1 at hω = 1/ζ.
    """
    return 4.0 * zeta if zeta <= 0.5 else 1.0 / zeta


def verlet_edge(zeta):
    """Solve the Jury conditions with the predicted velocity.

    1 + tr A + det A = 4 − 4ζ hω + (4ζ² − 1)(hω)² = 0  for ζ ≤ ½,  1 − tr A + det A = (hω)² (1 − ζ hω) = 0  beyond.
    """
    return 2.0 / (zeta + np.sqrt(1.0 - 3.0 * zeta * zeta)) if zeta <= 0.5 else 1.0 / zeta


EDGES = {
    EULER: euler_edge,
    MIDPOINT: lambda zeta: runge_kutta_edge((1.0, 1.0, 1.0 / 2.0), zeta) if zeta > 0.0 else 0.0,
    RK4: lambda zeta: runge_kutta_edge((1.0, 1.0, 1.0 / 2.0, 1.0 / 6.0, 1.0 / 24.0), zeta),
    AVERAGE_VELOCITY: average_velocity_edge,
    SYMPLECTIC_EULER: symplectic_euler_edge,
    VERLET: verlet_edge,
}
EXPLICIT, IMPLICIT = tuple(EDGES), (IMPLICIT_EULER, IMPLICIT_MIDPOINT)


def edge_picture(title, measured, sentence):
    """Draw theory's edges over ζ as lines and the measured ones as dots: measured = {method: {ζ: hω}}."""
    drawn = []
    for method, edges in measured.items():
        fine = np.linspace(0.0, np.max(list(edges)), 121)
        drawn.append(series(f"{method.label}, theory", fine, [EDGES[method](zeta) for zeta in fine], LINE))
        drawn.append(series(f"{method.label}, measured", edges.keys(), edges.values(), DOTS))
    return Picture(title, "damping ratio ζ [-]", "longest stable hω [-]", drawn, sentence)


# ---------------------------------------------------------------------------------------------- all methods

@case("stability-limits", "Stability limits of the explicit methods")
def stability_limits(lesson, check):
    """Compare the edge of every explicit method with theory; without damping the edge of some is at hω = 0."""
    measured = {}
    for method, law in EDGES.items():
        edges = {zeta: law(zeta) for zeta in (0.0, 0.1, 0.25, 0.5, 0.75, 1.0, 1.5, 2.0)}
        measured[method] = {zeta: edge(lesson, method, zeta) for zeta in edges}
        worst = departure(measured[method], edges)
        never = "" if edges[0.0] > 0.0 else f"; without damping it grows at hω = {SHORTEST} already"
        check(f"The {method.label} method is stable up to the step at which an eigenvalue of one step leaves the unit "
              "circle.", f"{method.label}: largest relative error of the edge over ζ = 0 to 2 [-]",
              law=0.0, found=worst, within=EDGE,
              saw=f"The edge of the {method.label} method agrees with theory to {worst:.1e}{never}.")
    return edge_picture(
        "Where each explicit method is stable", measured,
        "Below its curve a method is stable, above it the motion grows. Implicit Euler and implicit midpoint have no "
        "curve, because they are stable everywhere.")


@case("stable-for-every-step", "Methods that are stable for every step", compiled=False)
def stable_for_every_step(lesson, check):
    """Check that the two implicit methods have no edge: their motion stays bounded for any step.

    There are seven steps: a velocity that is wrong by 1e-12 moves x by h 1e-12 = 3e-10 at the longest step, below
    NOISE.
    """
    tried = [(h_omega, zeta) for h_omega in (0.1, 1.0, 10.0, 100.0, 1000.0) for zeta in (0.0, 0.5)]
    for method in IMPLICIT:
        stable = sum(growth(lesson, method, *oscillator, steps=7) <= 1.0 + NOISE for oscillator in tried)
        check(f"The {method.label} method is stable for every step.",
              f"{method.label}: runs that stay bounded [of {len(tried)}]", law=len(tried), found=stable, within=0.0,
              saw=f"From hω = 0.1 to 1000, undamped and at ζ = 0.5, {stable} of {len(tried)} runs of {method.label} "
                  "stay bounded.")


def amplification(lesson, method, h_omega, zeta):
    """Return the factor [-] by which one step multiplies the motion at most, for arrays of hω and ζ at once.

    Each entry is an oscillator of its own.  One step from (x, v) = (1, 0) and one from (0, 1) give the matrix of the
    step, and its largest eigenvalue is the factor.
    """
    def acceleration(t, x, v, p):
        return -h_omega**2 * x - 2.0 * zeta * h_omega * v

    one, none, step = np.ones_like(h_omega), np.zeros_like(h_omega), getattr(lesson, method.function)
    columns = [np.stack(step(acceleration, 0.0, x, v, 1.0, None), axis=-1) for x, v in ((one, none), (none, one))]
    return np.abs(np.linalg.eigvals(np.stack(columns, axis=-1))).max(axis=-1)


@case("amplification", "Amplification by one step", compiled=False)
def amplification_map(lesson, check):
    """Check that the factor of one step over hω and ζ is at most 1 up to the edge of theory, and above 1 beyond it."""
    hs, zetas = (np.round(high * (np.arange(CELLS) + 0.5) / CELLS, 6) for high in (3.2, 2.0))
    h_omega, zeta = np.meshgrid(hs, zetas)
    fine, maps = np.linspace(0.0, 2.0, 201), []
    for method, law in EDGES.items():
        factors = amplification(lesson, method, h_omega, zeta)
        edges = np.array([law(one) for one in zetas])
        right = int(np.sum((factors <= 1.0 + NOISE) == (h_omega < edges[:, None])))
        check(f"No eigenvalue of a step of the {method.label} method is larger than 1 up to its edge of stability, "
              "and one is beyond it.",
              f"{method.label}: points of the map on the side that theory says [of {factors.size}]",
              law=factors.size, found=right, within=0.0,
              saw=f"{right:,} of {factors.size:,} points of the map of {method.label} are on the right side.")
        maps.append({"label": method.label, "xs": hs, "ys": zetas, "values": np.round(factors, 3),
                     "curve": (np.array([law(one) for one in fine]), fine)})
    return Picture(
        "How much a step amplifies", "hω [-]", "damping ratio ζ [-]", [],
        "Blue: a step shrinks the motion. Red: it grows, and the run will diverge. The black line is theory's edge of "
        "stability; it runs along the border of the colours.", tuple(maps), (0.0, 2.0))


# ---------------------------------------------------------------------------------------------- one method each

def edges_agree(lesson, check, method, edges, claim):
    """Check that the edges {ζ: hω} of a method are those of theory, and that they flip; return the measured edges."""
    measured = {zeta: edge(lesson, method, zeta) for zeta in edges}
    worst, flipped, count = departure(measured, edges), flips(lesson, method, edges), len(edges)
    check(claim, f"largest relative error of the edge at {count} damping ratios [-]", law=0.0, found=worst, within=EDGE,
          saw=f"From ζ = {min(edges):g} to {np.max(list(edges)):g} the measured edge differs from theory by at most "
              f"{worst:.1e}.")
    check("The edge flips within ±0.1 %.", f"edges that flip [of {count}]", law=count, found=flipped, within=0.0,
          saw=f"At {flipped} of {count} damping ratios a run stays bounded 0.1 % below the bound, and grows 0.1 % "
              "above.")
    return measured


@case("explicit-euler", "Explicit Euler")
def explicit_euler(lesson, check):
    """Compare explicit Euler's edge with |1 + hs|² = 1 − 2ζ hω + (hω)² = 1 for ζ ≤ 1.

    It is stable below 2ζ, and below 2(ζ − √(ζ² − 1)) for ζ > 1.
    """
    edges = {zeta: euler_edge(zeta) for zeta in (0.1, 0.25, 0.5, 0.75, 1.0, 1.5, 3.0)}
    tiny, half, over = growth(lesson, EULER, 0.001), edge(lesson, EULER, 0.5), edge(lesson, EULER, 1.5)
    check("Without damping explicit Euler is never stable: the motion grows by √(1 + (hω)²) per step.",
          "growth per step, ζ = 0, hω = 0.001 [-]", law=np.sqrt(1.0 + 1e-6), found=tiny, within=GROWTH,
          saw=f"Even at a thousandth of a radian per step the motion grows, by {tiny - 1.0:.3e} per step.")
    check("For ζ ≤ 1 it is stable up to hω = 2ζ.", "edge hω at ζ = 0.5 [-]", law=1.0, found=half, within=EDGE,
          saw=f"At half the critical damping the run turns from decay to growth at hω = {half:.5f}.")
    check("For ζ > 1 it is stable up to hω = 2(ζ − √(ζ² − 1)).", "edge hω at ζ = 1.5 [-]",
          law=edges[1.5], found=over, within=EDGE * edges[1.5],
          saw=f"At one and a half times the critical damping it turns at hω = {over:.5f}.")
    measured = edges_agree(lesson, check, EULER, edges, "The two formulas hold at every damping ratio.")
    return edge_picture(
        "Explicit Euler: the longest stable step", {EULER: {0.0: edge(lesson, EULER, 0.0), **measured}},
        "Damping raises explicit Euler's limit to hω = 2 at ζ = 1. More damping lowers it again, because the faster "
        "of the two decays becomes too fast for the step.")


@case("symplectic-euler", "Symplectic Euler")
def symplectic_euler(lesson, check):
    """Compare symplectic Euler's edge with hω = 2(√(1 + ζ²) − ζ)."""
    edges = {zeta: symplectic_euler_edge(zeta) for zeta in (0.0, 0.1, 0.25, 0.5, 1.0, 1.5, 3.0)}
    undamped, critical = edge(lesson, SYMPLECTIC_EULER, 0.0), edge(lesson, SYMPLECTIC_EULER, 1.0)
    check("Without damping symplectic Euler is stable up to hω = 2.", "edge hω at ζ = 0 [-]",
          law=2.0, found=undamped, within=2.0 * EDGE,
          saw=f"An undamped oscillator stays bounded up to hω = {undamped:.5f}: about a third of a period per step.")
    check("At critical damping it is stable up to hω = 2(√2 − 1).", "edge hω at ζ = 1 [-]",
          law=edges[1.0], found=critical, within=EDGE,
          saw=f"Critical damping shortens the longest stable step to hω = {critical:.5f}.")
    measured = edges_agree(lesson, check, SYMPLECTIC_EULER, edges, "The formula holds at every damping ratio.")
    return edge_picture(
        "Symplectic Euler: the longest stable step",
        {SYMPLECTIC_EULER: measured, EULER: {zeta: edge(lesson, EULER, zeta) for zeta in edges}},
        "Without damping symplectic Euler is stable where explicit Euler never is. It evaluates damping at the "
        "beginning of the step, so any damping lowers its limit.")


@case("midpoint", "Midpoint: slow growth", compiled=False)
def midpoint(lesson, check):
    """Compare the growth of undamped midpoint with theory:  R(iy) = 1 + iy − ½y²,  |R|² = 1 + ¼y⁴,  y = hω."""
    law = lambda y: np.sqrt(1.0 + y**4 / 4.0)
    for y in (0.05, 0.2, 1.0):
        rate = growth(lesson, MIDPOINT, y)
        check("Without damping the midpoint method always grows, by √(1 + (hω)⁴/4) per step.",
              f"growth per step at hω = {y:g} [-]", law=law(y), found=rate, within=GROWTH,
              saw=f"At hω = {y:g} the motion doubles every {np.log(2.0) / np.log(rate):,.0f} steps.")
    dots, fine = np.linspace(0.1, 1.2, 12), np.linspace(0.0, 1.2, 61)
    return Picture(
        "Midpoint: slow growth", "hω [-]", "growth per step [-]",
        growth_curves(lesson, "midpoint, ", MIDPOINT, law, dots, fine)
        + growth_curves(lesson, "Euler, ", EULER, lambda y: np.sqrt(1.0 + y**2), dots, fine),
        "Both methods grow at every step length, but Euler's growth starts with (hω)²/2 and the midpoint method's "
        "with (hω)⁴/8.")


@case("rk4", "Runge–Kutta 4")
def rk4(lesson, check):
    """Compare Runge–Kutta 4, undamped, with theory:  |R(iy)|² = 1 − y⁶/72 + y⁸/576, stable up to √8.

    On the real axis it is stable up to the root of R(−z) = 1.  The real axis is an over-damped oscillator: at
    ζ = 5/4 it decays with the rates λ = 2ω and ½ω.
    """
    imaginary_edge, real_edge = edge(lesson, RK4, 0.0), 2.0 * edge(lesson, RK4, 1.25)
    real = min(-r.real for r in np.roots((1.0 / 24.0, 1.0 / 6.0, 1.0 / 2.0, 1.0)) if abs(r.imag) < 1e-6)
    flipped = flips(lesson, RK4, {0.0: np.sqrt(8.0), 1.25: real / 2.0})
    lost, at_one = 1.0 - growth(lesson, RK4, 0.2) ** 2, growth(lesson, RK4, 1.0) ** 2
    check("On an undamped oscillator Runge–Kutta 4 is stable up to hω = √8.", "edge hω on the imaginary axis [-]",
          law=np.sqrt(8.0), found=imaginary_edge, within=EDGE * np.sqrt(8.0),
          saw=f"The undamped run turns from decay to growth at hω = {imaginary_edge:.5f}.")
    check("On a pure decay it is stable up to hλ = 2.785294.", "edge hλ on the real axis [-]",
          law=real, found=real_edge, within=EDGE * real,
          saw=f"The over-damped run turns at hλ = {real_edge:.5f}, λ the faster of its two decay rates.")
    check("Both edges flip within ±0.1 %.", "edges that flip [of 2]", law=2, found=flipped, within=0.0,
          saw=f"At {flipped} of 2 edges a run stays bounded 0.1 % below the bound, and grows 0.1 % above.")
    check("Below its edge it damps: an undamped oscillator loses (hω)⁶/72 − (hω)⁸/576 of its energy per step.",
          "energy lost per step at hω = 0.2 [-]", law=0.2**6 / 72.0 - 0.2**8 / 576.0, found=lost, within=2.0 * GROWTH,
          saw=f"At hω = 0.2 a step loses {lost:.3e} of the energy, so half of it is lost in "
              f"{np.log(2.0) / lost:,.0f} steps.")
    check("At a larger step both terms count: |R|² = 1 − (hω)⁶/72 + (hω)⁸/576.", "energy kept per step at hω = 1 [-]",
          law=1.0 - 1.0 / 72.0 + 1.0 / 576.0, found=at_one, within=2.0 * GROWTH,
          saw=f"At hω = 1 a step keeps {100.0 * at_one:.4f} % of the energy.")
    return Picture(
        "Runge–Kutta 4 on an undamped oscillator", "hω [-]", "growth per step [-]",
        growth_curves(lesson, "", RK4, lambda y: np.sqrt(1.0 - y**6 / 72.0 + y**8 / 576.0),
                      np.linspace(0.2, 3.0, 15), np.linspace(0.0, 3.0, 121)),
        "Runge–Kutta 4 loses 0.6 % of the amplitude per step at hω = 1 and half of it at 2.45, where it damps most. "
        "Beyond 2.828 the motion grows.")


@case("implicit-euler", "Implicit Euler: numerical damping", compiled=False)
def implicit_euler(lesson, check):
    """Compare the damping of implicit Euler on an undamped oscillator with  |R(iy)| = (1 + y²)^(−½) per step, y = hω.

    It acts like a damping ratio  ln(1 + y²)/2y ≈ ½y.
    """
    law = lambda y: 1.0 / np.sqrt(1.0 + y * y)
    # few steps: Newton's tolerance of 1e-12 m/s is absolute, so the motion must not vanish
    few = 5
    ten_periods = 628
    for y in (0.1, 1.0, 4.0):
        rate = growth(lesson, IMPLICIT_EULER, y, steps=few)
        check("Implicit Euler damps an undamped oscillator: the motion shrinks by (1 + (hω)²)^(−1/2) per step.",
              f"growth per step at hω = {y:g} [-]", law=law(y), found=rate, within=OMEGA * NEWTON / law(y) ** few,
              saw=f"At hω = {y:g} a step removes {100.0 * (1.0 - rate):.3g} % of the amplitude.")
    ratio = -np.log(growth(lesson, IMPLICIT_EULER, 0.1, steps=few)) / 0.1
    kept = growth(lesson, IMPLICIT_EULER, 0.1, steps=ten_periods) ** ten_periods
    # e^(−ζ hω) per step: a growth known to OMEGA NEWTON in each of few steps, over hω
    check("The decay equals that of a damping ratio of ln(1 + (hω)²)/2hω, nearly ½hω.",
          "numerical damping ratio at hω = 0.1 [-]",
          law=np.log(1.01) / 0.2, found=ratio, within=OMEGA * NEWTON / law(0.1) ** few / 0.1,
          saw=f"At hω = 0.1 implicit Euler acts on an undamped oscillator like ζ = {ratio:.4f}.")
    check("Ten periods at hω = 0.1 leave (1.01)^(−314) of the amplitude.", "amplitude left after 628 steps [-]",
          law=1.01**-314, found=kept, within=OMEGA * NEWTON * ten_periods,
          saw=f"After ten periods at 63 steps per period {100.0 * kept:.2f} % of the amplitude is left.")
    dots, fine = np.linspace(0.25, 4.0, 16), np.linspace(0.0, 4.0, 121)
    return Picture(
        "Implicit Euler: numerical damping", "hω [-]", "growth per step [-]",
        growth_curves(lesson, "implicit Euler, ", IMPLICIT_EULER, law, dots, fine, few)
        + growth_curves(lesson, "implicit midpoint, ", IMPLICIT_MIDPOINT, np.ones_like, dots, fine, few),
        "Under implicit Euler the motion never grows, because it always shrinks. Implicit midpoint is equally stable, "
        "and keeps the "
        "amplitude.")


@case("phase-error", "Phase errors of Verlet and implicit midpoint", compiled=False)
def phase_error(lesson, check):
    """Compare phase errors: Verlet turns the motion by 2 asin(½hω) per step, implicit midpoint by 2 atan(½hω).

    Both keep the energy, but not the phase.  Verlet follows the ellipse  x² (1 − (hω)²/4) + (v/ω)² = const,  implicit
    midpoint the circle  x² + (v/ω)² = const.
    *Source:* cos θ = ½ tr A; Hairer, Lubich, Wanner 2006, I.5.
    """
    verlet = phase_curves(lesson, check, VERLET, np.arcsin, 0.25, GROWTH)
    implicit = phase_curves(lesson, check, IMPLICIT_MIDPOINT, np.arctan, 0.0, OMEGA * NEWTON)
    return Picture("Phase: too fast and too slow", "hω [-]", "error of the frequency [%]", verlet + implicit,
                   "At small steps Verlet leads by (hω)²/24 and implicit midpoint lags by twice as much; neither loses "
                   "energy.")


def phase_curves(lesson, check, method, inverse, flat, known):
    """Check that a method turns by 2 inverse(½hω) per step, on the ellipse 1 − flat (hω)²; return its curves."""
    name, title = method.label, capitalised(method.label)
    law = lambda y: 2.0 * inverse(0.5 * y) / y
    frequency = lambda y, steps: turning(lesson, method, y, steps, np.sqrt(1.0 - flat * y * y)) / y
    for y in (0.1, 0.5, 1.0):
        got = frequency(y, 1000)
        side = "ahead" if got > 1.0 else "behind"
        check(f"{title} oscillates at (2/h) {'asin' if flat else 'atan'}(hω/2) instead of ω.",
              f"{name}: frequency over the true one at hω = {y:g} [-]", law=law(y), found=got, within=known / y,
              saw=f"At hω = {y:g} {name} is a whole period {side} after {1.0 / abs(got - 1.0):,.0f} periods.")
    kept = growth(lesson, method, 0.5)
    check(f"{title} keeps the amplitude.", f"{name}: growth per step at hω = 0.5 [-]",
          law=1.0, found=kept, within=known,
          saw=f"After {STEPS} steps of {name} the amplitude is {kept**STEPS:.10f} of the initial one: the error is all "
              "in the phase.")
    fine, dots = np.linspace(0.02, 1.6, 80), np.linspace(0.2, 1.6, 8)
    return [series(f"{name}, theory", fine, 100.0 * (law(fine) - 1.0), LINE),
            series(f"{name}, measured", dots, [100.0 * (frequency(y, 200) - 1.0) for y in dots], DOTS)]


def capitalised(label):
    """Return a method's label as the first word of a sentence."""
    return label[0].upper() + label[1:]


# ---------------------------------------------------------------------------------------------- stiff systems

class StiffPair(NamedTuple):
    """A wall at 0, then a spring, a mass, a spring, a mass; at rest at x = (1, 2)."""
    k1: float = 750.0        # from the wall to mass 1 [N/m]
    k2: float = 1e20         # between the masses [N/m]
    m: float = 1.0           # of each [kg]
    rest: float = 1.0        # rest length of each spring [m]


PAIR = StiffPair()
SQUEEZED = 0.5               # the first spring at the start [m]
DT, TIMES = 0.002, 500       # a step [s], and their number
SOFT, STIFF = np.sqrt(PAIR.k1 / (2.0 * PAIR.m)), np.sqrt(2.0 * PAIR.k2 / PAIR.m)     # frequencies of both modes [rad/s]
# [m/s]: Newton's tolerance, 1e-12 of the fastest velocity, 9.7 m/s, at every step
NEWTON_OF_THE_PAIR = NEWTON * SOFT * SQUEEZED * TIMES


def stiff_pair(t, x, v, p):
    """Return a₁ = (F − k₁(x₁ − L))/m,  a₂ = −F/m,  F = k₂(x₂ − x₁ − L)."""
    F = p.k2 * (x[1] - x[0] - p.rest)
    return np.array([F - p.k1 * (x[0] - p.rest), -F]) / p.m


def pair_run(lesson, method):
    """Return places and velocities (TIMES + 1, 2) of the pair; NaN from the step on at which the run diverges."""
    xs, vs = np.full((2, TIMES + 1, 2), np.nan)
    x, v = xs[0], vs[0] = np.array([1.0, 2.0]) * PAIR.rest - SQUEEZED, np.zeros(2)
    try:
        for n in range(TIMES):
            x, v = lesson.advance(getattr(lesson, method.function), stiff_pair, n * DT, x, v, DT, 1, PAIR)
            xs[n + 1], vs[n + 1] = x, v
    except (Diverged, np.linalg.LinAlgError):
        pass
    return xs, vs


def soft_mode(lesson, check, method, angle, shrink, loose):
    """Check a run against a method that turns the soft mode by `angle` and multiplies it by `shrink` per step.

    loose    largest stretch that the method leaves in the stiff spring [m]
    """
    name, size = method.label, SQUEEZED * shrink**TIMES
    xs, vs = pair_run(lesson, method)
    middle, velocity = (xs - np.array([1.0, 2.0]) * PAIR.rest).mean(axis=1), vs.mean(axis=1)
    turned = np.unwrap(np.arctan2(velocity / SOFT, -middle))[-1] / (TIMES * DT)
    left = np.hypot(middle[-1], velocity[-1] / SOFT)
    stretch = np.abs(xs[:, 1] - xs[:, 0] - PAIR.rest).max()
    check("The soft mode oscillates at the frequency of the method, as if the stiff spring were a rod.",
          f"{name}: frequency of the soft mode [rad/s]",
          law=angle / DT, found=turned, within=NEWTON_OF_THE_PAIR / (SOFT * size) / (TIMES * DT),
          saw=f"With hω₂ = {DT * STIFF:.1e} {name} oscillates at {turned:.6f} rad/s; the exact value is {SOFT:.6f}.")
    check("Its amplitude is that of the same method on an oscillator without a stiff spring.",
          f"{name}: amplitude of the soft mode after 1 s [m]", law=size, found=left, within=NEWTON_OF_THE_PAIR / SOFT,
          saw=f"After 1 s {name} has {left:.6f} m of {SQUEEZED} m left.")
    check("The stiff spring stays stable and keeps its length.", f"{name}: largest stretch of the stiff spring [m]",
          law=0.0, found=stretch, within=2.0 * DT * loose + np.spacing(2.0),
          saw=f"{capitalised(name)} keeps the stiff spring's length within {stretch:.1e} m; floats are 4.4e-16 m "
              "apart.")
    return series(name, DT * np.arange(TIMES + 1), 1.0 + middle, DOTS)


@case("stiff-pair", "A stiff pair", compiled=False)
def stiff_pair_case(lesson, check):
    """Check a stiff pair, released from x = (0.5, 1.5), which moves as one: ω² = k₁/2m = 375,  ω₂ = √(2k₂/m) = 1.4e10.

    The second spring starts unstretched and must pull with 187.5 N: it stretches by 1.9e-18 m, below a hundredth of
    the spacing of floats there.  Per step the mean of both turns by atan(hω) on a spiral under implicit Euler, and
    by 2 atan(½hω) on a circle under implicit midpoint.  At dt = 10 ms the 1 in  1 + h²k₂  is below round-off, and
    Newton's matrix is singular.  Implicit Euler removes the stiff mode at every step; implicit midpoint keeps the
    part of it that every step leaves.
    """
    y = SOFT * DT
    shrink = 1.0 / np.sqrt(1.0 + y * y)
    euler = soft_mode(lesson, check, IMPLICIT_EULER, np.arctan(y), shrink, NEWTON_OF_THE_PAIR / TIMES)
    midpoint = soft_mode(lesson, check, IMPLICIT_MIDPOINT, 2.0 * np.arctan(0.5 * y), 1.0, NEWTON_OF_THE_PAIR)
    refused = refuse(EXPLICIT, lambda name: lesson.advance(
        getattr(lesson, name), stiff_pair, 0.0, np.array([0.5, 1.5]), np.zeros(2), DT, TIMES, PAIR))
    check("Every explicit method must end in an error, because its step may not exceed about 2/ω₂ = 1.4e-10 s.",
          "explicit methods that raise Diverged [of 6]", law=len(EXPLICIT), found=refused, within=0.0,
          saw=f"At dt = {DT} s {refused} of {len(EXPLICIT)} explicit methods end in an error instead of a number.")
    fine = np.linspace(0.0, TIMES * DT, 241)
    return Picture(
        "A stiff pair: motion of the soft mode", "t [s]", "position of mass 1 [m]",
        [series("truth", fine, 1.0 - SQUEEZED * np.cos(SOFT * fine), LINE), euler, midpoint],
        "The step is ten million times too long for the stiff spring, and both implicit methods follow the soft mode. "
        "Implicit Euler damps the mode; implicit midpoint does not.")


END = 1e11                   # of the reaction [s]
PUBLISHED = np.array([2.08334014970e-8, 8.33336077e-14, 0.99999997917])      # y(10¹¹ s)


def robertson(t, x, v, p):
    """Return ẏ₁ = −0.04 y₁ + 10⁴ y₂ y₃,   ẏ₂ = −ẏ₁ − ẏ₃,   ẏ₃ = 3·10⁷ y₂²,  with y in the place of v; x is unused.

    *Source:* Robertson 1966; Hairer and Wanner 1996, IV.10; values at 10¹¹ s: Mazzia and Magherini, "Test set for
    IVP solvers".
    """
    slow, back, fast = 0.04 * v[0], 1e4 * v[1] * v[2], 3e7 * v[1] * v[1]
    return np.array([back - slow, slow - back - fast, fast])


def fastest_rate(y):
    """Return the largest |eigenvalue| [1/s] of the reaction's Jacobian."""
    slow, fast = [-0.04, 1e4 * y[2], 1e4 * y[1]], [0.0, 6e7 * y[1], 0.0]
    J = np.array([slow, [0.04, -1e4 * y[2] - 6e7 * y[1], -1e4 * y[1]], fast])
    return np.abs(np.linalg.eigvals(J)).max()


def react(lesson, step, ratio):
    """Return times and concentrations of the reaction from 10⁻⁵ s to END; each time is `ratio` times the one before."""
    ts = END * ratio ** np.arange(-round(16.0 / np.log10(ratio)), 1.0)
    t, x, y, ys = 0.0, np.zeros(3), np.array([1.0, 0.0, 0.0]), []
    for end in ts:
        x, y = lesson.advance(getattr(lesson, step), robertson, t, x, y, end - t, 1, ())
        t = end
        ys.append(y)
    return ts, np.array(ys)


def reached(lesson, ratio):
    """Return the end of implicit Euler's run, or NaN if it diverges."""
    try:
        return react(lesson, IMPLICIT_EULER.function, ratio)
    except (Diverged, np.linalg.LinAlgError):
        return np.array([END]), np.full((1, 3), np.nan)


def leaves(lesson, dt):
    """Return whether 1,000 steps of explicit Euler amplify a y₂ that starts 50 % too large.

    y₂ returns to a value that differs by 4·10⁻⁶ of the disturbance, because y₁ has taken up the rest.  Over 1,000
    steps that shifts the edge by 2e-9.
    """
    disturbed = np.array([1.0, 1.5, 1.0]) * PUBLISHED
    try:
        _, y = lesson.advance(lesson.euler_step, robertson, END, np.zeros(3), disturbed, dt, 1000, ())
    except Diverged:
        return True
    return abs(y[1] - PUBLISHED[1]) > 0.5 * PUBLISHED[1]


@case("robertson", "Robertson's reaction", compiled=False)
def robertson_case(lesson, check):
    """Check Robertson's reaction to 10¹¹ s, with steps in a constant ratio.

    For late times y₂ = 4·10⁻⁶ y₁ and  ẏ₁ = −c y₁²,  c = 3·10⁷ (4·10⁻⁶)² = 4.8e-4 /s:  y₁ = 1/ct.
    Implicit Euler with times tₙ₊₁ = q tₙ turns that into  uₙ₊₁ = uₙ − (q − 1) tₙ c uₙ₊₁²,  solved by uₙ = q/(c tₙ).
    Its relative error is q − 1, first order in the step.  The exact solution differs by 3.3e-6 from 1/ct, so the
    error is known to about that.  Explicit Euler is limited by the fast rate |λ| = 0.04 + 10⁴ y₃ + … to steps below
    2/|λ|.
    """
    for per_decade in (50, 100):
        ratio = 10.0 ** (1.0 / per_decade)
        ts, ys = reached(lesson, ratio)
        for name, y, published in zip(("y₁", "y₂"), ys[-1], PUBLISHED):
            error = y / published - 1.0
            check(f"With times in the ratio q implicit Euler is wrong by q − 1 in {name}: first order.",
                  f"relative error of {name} at 10¹¹ s, {per_decade} steps per decade [-]",
                  law=ratio - 1.0, found=error, within=abs(PUBLISHED[0] * 4.8e-4 * END - 1.0),
                  saw=f"{len(ts):,} steps reach 10¹¹ s with {name} {100.0 * error:.4f} % above the published value.")
    total = ys[-1].sum()
    # in a step the terms dt·0.04 y₁ < 2 cancel, each rounded by 1.1e-16 of itself about eight times
    check("The total is conserved: y₁ + y₂ + y₃ = 1.", "sum of the concentrations at 10¹¹ s [-]",
          law=1.0, found=total, within=len(ts) * 16 * 1.1e-16,
          saw=f"After {len(ts):,} steps the sum differs from 1 by {abs(total - 1.0):.0e}.")
    refused = refuse(EXPLICIT, lambda name: react(lesson, name, ratio))
    check("Every explicit method must end in an error for such steps.", "explicit methods that raise Diverged [of 6]",
          law=len(EXPLICIT), found=refused, within=0.0,
          saw=f"{refused} of {len(EXPLICIT)} explicit methods end in an error instead of a number.")
    longest, step = 2.0 / fastest_rate(PUBLISHED), bisect(lambda dt: leaves(lesson, dt), 1e-5, 1e-3)
    check("Explicit Euler is limited to steps of 2/|λ| even at the end, where the concentrations hardly change.",
          "longest step of explicit Euler at 10¹¹ s [s]", law=longest, found=step, within=EDGE * longest,
          saw=f"A disturbance of y₂ grows at steps above {step:.5e} s, so 10¹¹ s would take {END / step:.1e} steps.")
    return reaction_picture(ts, ys, ratio)


def reaction_picture(ts, ys, ratio):
    """Draw the concentrations of a run, their published final values, and the law of late times."""
    late = ts > 1e3
    drawn = [series(f"{name}, implicit Euler", np.log10(ts), np.log10(y), LINE)
             for name, y in zip(("y₁", "y₂", "y₃"), ys.T)]
    drawn += [series("published", [np.log10(END)] * 3, np.log10(PUBLISHED), DOTS),
              series("1/ct", np.log10(ts[late]), -np.log10(4.8e-4 * ts[late]), LINE)]
    return Picture(
        "Robertson's reaction", "log₁₀ of time [s]", "log₁₀ of concentration [-]", drawn,
        f"Sixteen decades of time in {len(ts):,} steps, each {100.0 * (ratio - 1.0):.1f} % longer than the one "
        "before. Implicit Euler ends that much above the published y₁ and y₂; late y₁ follows 1/ct.")


# ---------------------------------------------------------------------------------------------- one step

TRIED = 20                   # random states and forces [-]
ROUNDED = 1e-13              # of a few hundred roundings of 1.1e-16, relative to the state


class Swing(NamedTuple):
    """Two masses under a force that depends on time, position and velocity; matrices couple the two."""
    k: np.ndarray            # (2, 2) [1/s²]
    c: np.ndarray            # (2, 2) [1/s]; 0: the force does not depend on the velocity
    drive: np.ndarray        # (2,) [m/s²]
    omega: float             # of the drive [rad/s]


def swinging(t, x, v, p):
    """Return a = −K sin x − C tanh v + drive cos ωt."""
    return -p.k @ np.sin(x) - p.c @ np.tanh(v) + p.drive * np.cos(p.omega * t)


def random_swing(rng):
    """Return a random Swing, and (t, x, v, dt) of a step."""
    k, c = rng.uniform(-1.0, 1.0, (2, 2, 2))
    x, v, drive = rng.uniform(-1.0, 1.0, (3, 2))
    t, dt, omega = rng.uniform((0.0, 0.1, 2.0), (1.0, 0.3, 4.0))
    return Swing(k, c, drive, omega), t, x, v, dt


def single_step(method, lesson, rng):
    """Compare a step of a method with that of its table."""
    p, *state = random_swing(rng)
    p = p._replace(c=0.0 * p.c) if method is BLANES_MOAN else p
    truth = schemes.step_of(method.table)(lambda t, x, v: swinging(t, x, v, p), *state)
    return getattr(lesson, method.function)(swinging, *state, p), truth


@random_law("Many steps are single steps, each at its own time.",
            "history of Runge–Kutta 4: largest error in three steps [s, m, m/s]", ROUNDED)
def history(lesson, rng):
    """Compare a history, and the end of a run of many steps, with single steps, each at its own time."""
    p, t, x, v, dt = random_swing(rng)
    step, states = schemes.step_of(schemes.RK4), [(x, v)]
    for n in range(3):
        states.append(step(lambda t, x, v: swinging(t, x, v, p), t + n * dt, *states[-1], dt))
    ts, xs, vs = lesson.trajectory(lesson.rk4_step, swinging, t, x, v, dt, 3, p)
    end = lesson.advance(lesson.rk4_step, swinging, t, x, v, dt, 3, p)
    return (ts, np.stack((xs, vs), axis=1), *end), (t + dt * np.arange(4), np.array(states), *states[-1])


@case("one-step", "One step of each method", compiled=False)
def one_step(lesson, check):
    """Compare one step of each method, under a force of t, x and v, with that of its table of coefficients."""
    steps = [random_law(f"One step of {method.label} is that of its published coefficients.",
                        f"{method.label}: largest error of a step [m, m/s]",
                        100.0 * NEWTON if method in IMPLICIT else ROUNDED)(partial(single_step, method))
             for method in (*INTEGRATORS, BLANES_MOAN)]
    check.laws(lesson, (*steps, history), seed=11, times=TRIED)


# ---------------------------------------------------------------------------------------------- adaptive steps

SHARE = 0.1                  # of the adaptive steps [-]
SHAPES = (0.0, 0.3, 0.6, 0.9, 0.99)          # eccentricities [-]
COUNTED = SHARE**2           # the rate lags behind the truth by the square of a step, relative to it [-]


def attracted(t, x, v, p):
    """Return a = −μ x/|x|³."""
    return -p.mu / np.sum(x * x) ** 1.5 * x


def steps_per_revolution(lesson, p):
    """Return how many adaptive steps a revolution takes: those of ten, counted."""
    taken = []

    def step(*arguments):
        taken.append(arguments[1])
        return lesson.blanes_moan_step(*arguments)
    period = 2.0 * np.pi * np.sqrt(p.a**3 / p.mu)
    lesson.advance_adaptive(step, attracted, 0.0, *perihelion(p), SHARE, 10.0 * period, p)
    return len(taken) / 10.0


def counted_by_theory(e):
    """Return ∮ρ dt/share over an ellipse, ∮(1 − e cos E)^(−1/2) dE/share: r = a (1 − e cos E),  n dt = r/a dE."""
    E = np.linspace(0.0, 2.0 * np.pi, 2000, endpoint=False)          # of a periodic function: exact to round-off
    return 2.0 * np.pi * np.mean(1.0 / np.sqrt(1.0 - e * np.cos(E))) / SHARE


@random_law("From any place on its ellipse a planet moves according to the published rule.",
            "positions after some revolutions: largest error, over a [-]", 100.0 * ROUNDED)
def adaptive_run(lesson, rng):
    """Compare a run from any place of an ellipse, anywhere in space, with the published rule in complex numbers."""
    mu, a, e, before, T = rng.uniform((0.5, 0.5, 0.1, 0.0, 1.0), (2.0, 2.0, 0.8, 6.0, 4.0))
    p = Planet(mu, a, e)
    x, v = orbit(*perihelion(p), mu, before)
    axis_1, axis_2, _ = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    plane = np.stack((axis_1, axis_2))
    got, _ = lesson.advance_adaptive(lesson.blanes_moan_step, attracted, before, x @ plane, v @ plane, SHARE, T, p)
    truth = adaptive_march(lambda t, x, v: -mu * x / abs(x) ** 3, complex(*x), complex(*v), SHARE, T)
    return got / a, (truth.real, truth.imag) @ plane / a


@case("adaptive-steps", "Steps that adapt to the distance", compiled=False)
def adaptive_steps(lesson, check):
    """Compare the number of adaptive steps of a revolution with the rule, and check a fall that ends at the sun."""
    check.laws(lesson, (adaptive_run,), seed=13, times=TRIED // 2)
    counts = [steps_per_revolution(lesson, Planet(e=e)) for e in SHAPES]
    theory, equal = counted_by_theory(SHAPES[-1]), 1e3 * 2.0 * np.pi / SHARE
    check("A revolution with the eccentricity 0.99 takes ∮(1 − e cos E)^(−1/2) dE/share steps.",
          "steps per revolution [-]", law=theory, found=counts[-1], within=COUNTED * theory + 0.1,
          saw=f"It takes {counts[-1]:.1f} steps, and a circle {counts[0]:.1f}. Equal steps that are as short near the "
              f"sun would be {equal:,.0f}.")
    p, start = Planet(mu=2.0), np.array([1.5, 0.0])
    fall = np.pi / np.sqrt(8.0) * np.sqrt(start[0]**3 / p.mu)
    ends = lambda T: lambda name: lesson.advance_adaptive(
        getattr(lesson, name), attracted, 0.0, start, np.zeros(2), SHARE, T, p)
    longest = bisect(lambda T: refuse((BLANES_MOAN,), ends(T)) == 1, 0.5 * fall, 2.0 * fall)
    check("A fall from rest reaches the origin after π/√8 √(r³/μ), and no step goes beyond it.",
          "longest run that ends with a number [s]", law=fall, found=longest, within=(SHARE**4 + EDGE) * fall,
          saw=f"A run of {longest:.6f} s ends; a longer one raises Diverged.")
    fine = np.linspace(0.0, 0.995, 100)
    return Picture(
        "How many steps a revolution needs", "eccentricity [-]", "adaptive steps per revolution [-]",
        [series("∮(1 − e cos E)^(−1/2) dE/share", fine, [counted_by_theory(e) for e in fine], LINE),
         series("counted in ten revolutions", SHAPES, counts, DOTS)],
        f"The share is {SHARE:g}: on a circle, the angle of a step. A comet that comes a hundred times nearer to the "
        "sun than a planet needs only about twice as many steps.")


# ---------------------------------------------------------------------------------------------- measures of a method

@random_law("The matrix of a step of Euler is 1 + h J.", "entries of the matrix: largest error [-]", ROUNDED)
def matrix_of_euler(lesson, rng):
    omega, zeta, h = rng.uniform((0.5, 0.1, 0.1), (3.0, 2.0, 1.0))
    truth = np.array([[1.0, h], [-h * omega**2, 1.0 - 2.0 * zeta * omega * h]])
    return lesson.amplification_matrix(lesson.euler_step, omega, zeta, h), truth


@random_law("Newton's matrix is 1 − dt ∂a/∂v, at x + dt v.", "Newton's matrix: largest error [-]", 1e-9)
def matrix_of_newton(lesson, rng):
    p, t, x, v, dt = random_swing(rng)
    slope = -dt * p.k * np.cos(x + dt * v) - p.c / np.cosh(v) ** 2
    return lesson.newton_matrix(swinging, t, x, v, dt, p), np.eye(2) - dt * slope


@random_law("The spectral radius is the largest absolute eigenvalue.", "spectral radius: largest error [-]", 1e-9)
def largest_eigenvalue(lesson, rng):
    matrix = rng.uniform(-1.0, 1.0, (2, 2))
    return lesson.spectral_radius(matrix), np.max(np.abs(np.linalg.eigvals(matrix)))


@random_law("The observed order is the slope of the least squares on logarithmic scales.",
            "order: largest error [-]", 1e-12)
def fitted_order(lesson, rng):
    order, scale = rng.uniform((1.0, 0.1), (4.0, 10.0))
    dts = np.array([0.1, 0.05, 0.02, 0.01])
    errors = scale * dts**order * rng.uniform(0.9, 1.1, 4)
    return lesson.observed_order(dts, errors), np.polyfit(np.log(dts), np.log(errors), 1)[0]


@case("what-measures-methods", "Measures of a method", compiled=False)
def what_measures_methods(lesson, check):
    """Check the matrix of a step, its spectral radius and the order of convergence on examples whose answers are known.

    A central difference of h = 6e-6 errs by h²/6 times a third derivative, and by round-off over h: 2e-10 in all.  Near
    a double eigenvalue the error is the square root of round-off.
    """
    check.laws(lesson, (matrix_of_euler, matrix_of_newton, largest_eigenvalue, fitted_order), seed=12, times=TRIED)


@case("growth-and-a-method-of-ones-own", "Growth of Euler in a period, and a method of one's own", compiled=False)
def growth_and_own_method(lesson, check):
    """Compare the predicted growth of Euler with the power of its matrix, and judge a method of one's own.

    The order is measured by halving a step of 1/32 s, where no rate is above 1/s.
    """
    for steps in (12, 60, 400):
        angle = 2.0 * np.pi / steps
        law = np.linalg.norm(np.linalg.matrix_power(np.array([[1.0, angle], [-angle, 1.0]]), steps)[0])
        found = lesson.growth_per_period(steps)
        check("The predicted growth of Euler in one period is that of as many steps.",
              f"growth of the amplitude with {steps} steps per period [-]", law=law, found=found,
              within=4e-16 * steps * law, saw=f"With {steps} steps per period the amplitude grows {found:.6g} times.")
    errors = [np.linalg.norm(own_run(lesson, steps) - [np.cos(1.0), -np.sin(1.0)]) for steps in (32, 64)]
    order = min(2.0, np.log2(errors[0] / errors[1]))
    check("A method of one's own has second order, or a higher one.", "order of my_step, at most 2 [-]",
          law=2.0, found=order, within=0.05, saw=f"Half the step divides the error by {errors[0] / errors[1]:.3g}.")



def own_run(lesson, steps):
    """Return (x, v) of a unit oscillator after 1 s of the lesson's own method."""
    p, begin = lesson.Oscillator(1.0, 0.0), (np.ones(1), np.zeros(1))
    return np.ravel(lesson.advance(lesson.my_step, lesson.oscillator_acceleration, 0.0, *begin, 1.0 / steps, steps, p))


# ---------------------------------------------------------------------------------------------- a million steps

DYADIC = 1.0 / 64.0          # a step [s] whose products with ½ and with itself are exact: a sum is all that is rounded
CIRCLES = 16                 # planets on the same circle, at other places
SPREAD = 3.0 / np.sqrt(2.0 * CIRCLES)   # three standard deviations of the root mean square of these, over its mean
MANY, FEW = 10**6, 10**4     # steps of a run: compiled, and in plain Python


def attracted_each(t, x, v, p):
    """Return a = −μ x/|x|³ for each row of x (n, 2)."""
    a = np.empty_like(x)
    for k in range(x.shape[0]):
        square = x[k, 0] * x[k, 0] + x[k, 1] * x[k, 1]
        a[k] = -p.mu / (square * np.sqrt(square)) * x[k]
    return a


def discrete_circle(dt, phi):
    """Return (x, v), at the angles phi, of a planet that Verlet keeps on the unit circle about μ = 1.

    xₙ₊₁ − 2xₙ + xₙ₋₁ = −dt² xₙ  turns x by θ with  2 − 2 cos θ = dt²,  and  v = (xₙ₊₁ − xₙ₋₁)/2dt  has length sin θ/dt.
    """
    speed = np.sin(2.0 * np.arcsin(0.5 * dt)) / dt
    return np.stack((np.cos(phi), np.sin(phi)), 1), speed * np.stack((-np.sin(phi), np.cos(phi)), 1)


def walk_of_energy(dt):
    """Return the standard deviation [J/kg] of the energy after one step on that circle, if roundings are independent.

    A sum is rounded by up to half the spacing u of floats, with variance u²/12.  A step makes two sums in x and one
    in v, and the energy ½v² − 1/|x| changes by  x · δx + v · δv  where |x| = 1.
    """
    x, v = discrete_circle(dt, np.linspace(0.0, 2.0 * np.pi, 10000))
    squares = 2.0 * (x * np.spacing(abs(x))) ** 2 + (v * np.spacing(abs(v))) ** 2
    return np.sqrt(np.mean(np.sum(squares, axis=1)) / 12.0)


@case("a-million-steps", "A million steps of a planet", in_quick=False)
def a_million_steps(lesson, check):
    """Check that rounding alone changes the energy of a planet on Verlet's discrete circle, as a random walk.

    After n steps the energy is off by √n times the error of one step (Brouwer's law).  The step is a power of two,
    because a rounded ½dt² would be a systematic error, which grows with n.  *Source:* Brouwer 1937; Hairer,
    McLachlan, Razakarivony 2008, "Achieving Brouwer's law with implicit Runge–Kutta methods".
    """
    fast = hasattr(lesson.verlet_step, "py_func")
    law, longest = (jitted(attracted_each), MANY) if fast else (attracted_each, FEW)
    x, v = discrete_circle(DYADIC, np.arange(1.0, CIRCLES + 1.0))
    energy = lambda x, v: 0.5 * np.sum(v * v, axis=1) - 1.0 / np.sqrt(np.sum(x * x, axis=1))
    counts, share, walks = np.array([longest // 100, longest // 10, longest]), walk_of_energy(DYADIC), []
    for n in counts:
        off = energy(*lesson.advance(lesson.verlet_step, law, 0.0, x, v, DYADIC, int(n), Planet())) - energy(x, v)
        walks.append(np.sqrt(np.mean(off**2)))
        revolutions = n * 2.0 * np.arcsin(0.5 * DYADIC) / (2.0 * np.pi)
        check("Rounding changes the energy of a planet like a random walk, by √n times the error of one step.",
              f"energy after {n:,} steps: root mean square of {CIRCLES} planets [J/kg]",
              law=share * np.sqrt(n), found=walks[-1], within=SPREAD * share * np.sqrt(n),
              saw=f"After {n:,} steps, {revolutions:,.0f} revolutions, the energy is off by {walks[-1]:.1e} J/kg.")
    return Picture(
        "The energy of a planet, rounded a million times", "log₁₀ of the steps [-]",
        "log₁₀ of the energy's error [J/kg]",
        [series("√n times the share of one step", np.log10(counts), np.log10(share * np.sqrt(counts)), LINE),
         series("measured", np.log10(counts), np.log10(walks), DOTS)],
        "A hundred times as many steps make ten times the error. Shorter steps do not help, because more steps are "
        "needed.")


# ---------------------------------------------------------------------------------------------- the limit of prediction

HELD, HORIZON = np.radians([120.0, 120.0]), 0.1      # both arms at the start [rad]; a prediction is lost beyond [rad]
AHEAD, SLICES = 16.0, 50     # duration of the runs [s]; samples per second
EXPONENTS = (2, 4, 6, 8)     # one start is off by ten to minus each of these [rad]
# Where 0.1 rad is reached the growth is no longer quite linear, and the motion turns once per half second.
RIPPLE = 0.1                 # [s]


def double_pendulum(t, x, v, p):
    """Return θ̈ of two arms of 1 m with equal masses at their ends, in each row of x = (θ₁, θ₂) from the vertical.

    2θ̈₁ + c θ̈₂ = −s ω₂² − 2g sin θ₁,    c θ̈₁ + θ̈₂ = s ω₁² − g sin θ₂,    s, c: sine and cosine of θ₁ − θ₂
    """
    s, c = np.sin(x[:, 0] - x[:, 1]), np.cos(x[:, 0] - x[:, 1])
    f = -s * v[:, 1] ** 2 - 2.0 * 9.81 * np.sin(x[:, 0])
    h = s * v[:, 0] ** 2 - 9.81 * np.sin(x[:, 1])
    return np.stack(((f - c * h) / (2.0 - c * c), (2.0 * h - c * f) / (2.0 - c * c)), axis=1)


def true_growth():
    """Return (ts, angles (n, 2), factors (n,)): the motion, and the largest growth of a small error in θ₁ until then.

    An imaginary part of 1e-30 in the start carries the derivative by θ₁ to all digits.
    """
    def rates(t, y):
        return np.concatenate((y[2:], double_pendulum(t, y[None, :2], y[None, 2:], None)[0]))
    ts, tiny = np.arange(AHEAD * SLICES + 1.0) / SLICES, 1e-30
    begin = np.array([*HELD, 0.0, 0.0]) + 1j * tiny * np.array([1.0, 0.0, 0.0, 0.0])
    y = solve_ivp(rates, (0.0, AHEAD), begin, method="DOP853", rtol=1e-13, atol=1e-15, t_eval=ts).y
    return ts, y[:2].real.T, np.maximum.accumulate(np.linalg.norm(y[:2].imag, axis=0)) / tiny


def first_beyond(ts, sizes, limit=HORIZON):
    """Return the first of the times at which a size is beyond the limit; infinite if it never is."""
    beyond = np.flatnonzero(sizes > limit)
    return ts[beyond[0]] if len(beyond) else np.inf


def sampled(lesson, starts, steps):
    """Return the angles (n, k, 2) of runs from these starts, with this number of steps per second, at the times ts."""
    run = lesson.trajectory(lesson.rk4_step, double_pendulum, 0.0, starts, 0.0 * starts, 1.0 / steps,
                            round(AHEAD * steps), None)
    return run[1][::steps // SLICES]


@case("limit-of-prediction", "Limit of prediction of a double pendulum", compiled=False, in_quick=False)
def limit_of_prediction(lesson, check):
    """Check that the motion alone decides the growth of a small error from the method, the start or rounding."""
    ts, truth, factor = true_growth()
    starts = HELD + np.array([[0.0, 0.0], *([10.0**-k, 0.0] for k in EXPONENTS)])
    fine, coarse = (sampled(lesson, starts, steps) for steps in (500, 250))
    drawn = []
    for k, neighbour in zip(EXPONENTS, np.swapaxes(fine[:, 1:], 0, 1)):
        apart, theory = np.linalg.norm(neighbour - fine[:, 0], axis=1), factor * 10.0**-k
        differ = first_beyond(ts, apart)
        check("Two runs that start ε apart differ by ε times the growth of a small error, while that is small.",
              f"time until starts 1e-{k} rad apart differ by {HORIZON:g} rad [s]",
              law=first_beyond(ts, theory), found=differ, within=RIPPLE,
              saw=f"They differ by {HORIZON:g} rad after {differ:.2f} s.")
        drawn += [series(f"1e-{k}, theory", ts[::5], np.log10(np.minimum(10.0, theory[::5])), LINE),
                  series(f"1e-{k}, measured", ts[1::40], np.log10(np.maximum.accumulate(apart)[1::40]), DOTS)]
    lost, lost_by_half = (first_beyond(ts, np.linalg.norm(run[:, 0] - truth, axis=1)) for run in (coarse, fine))
    check("Half the step makes Runge–Kutta 4 sixteen times as accurate. The prediction then lasts until an error has "
          "grown sixteen times larger.", "time until 500 steps per second err by 0.1 rad [s]",
          law=first_beyond(ts, factor / np.interp(lost, ts, factor), 16.0), found=lost_by_half, within=2.0 * RIPPLE,
          saw=f"250 steps per second predict {lost:.2f} s, and 500 predict {lost_by_half:.2f} s.")
    return Picture(
        "How two nearly equal starts part", "t [s]", "log₁₀ of the distance of the two [rad]", drawn,
        f"After {AHEAD:g} s an error is {factor[-1]:.0e} times as large. A thousand times the accuracy buys only a few "
        "seconds. Rounding, which is 1e-16, limits every prediction, that of the truth included.")
