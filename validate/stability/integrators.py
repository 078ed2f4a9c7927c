"""Stability limits of the integrators: the longest step that theory permits each method, compared with an experiment.

    ẍ = −ω² x − 2ζω ẋ        hω: step times angular frequency [-], ζ: damping ratio [-]

The experiment is always a run of many steps of the lesson's own method, never its formula.  Two oscillators share
one run, from (x, v) = (1, 0) and (0, 1).  Their final states form the (2, 2) matrix M of all N steps together, and
the motion grows per step by |largest eigenvalue of M|^(1/N), independent of the phase at which the run stops.  The
edge of stability is where that factor passes 1, found by bisection on hω.

The first case draws all methods into one picture.
*Source:* Hairer and Wanner 1996, "Solving ordinary differential equations II", IV.2; Hairer, Lubich, Wanner 2006.
"""

from typing import NamedTuple

import numpy as np
from scipy.integrate import solve_ivp

from solutions.checks import Diverged
from validate.methods import BLANES_MOAN, INTEGRATORS
from validate.methods import EXPLICIT as ALL_EXPLICIT
from validate.reference import schemes
from validate.reference.integrators import Planet, adaptive_march, orbit, perihelion
from validate.stability.case import (
    DOTS,
    EDGE,
    LINE,
    Picture,
    Worst,
    agreement,
    bisect,
    case,
    finding,
    jitted,
    refuse,
    series,
)

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

EXPLICIT = tuple(m for m in INTEGRATORS if m in ALL_EXPLICIT)
IMPLICIT = tuple(m for m in INTEGRATORS if m not in EXPLICIT)
LABEL = {method.function: method.label for method in INTEGRATORS}


# ---------------------------------------------------------------------------------------------- the experiment

def growth(lesson, method, h_omega, zeta=0.0, steps=STEPS):
    """Return the factor [-] by which an oscillator's motion grows per step; infinite if the run diverges."""
    p = lesson.Oscillator(OMEGA, zeta)
    x, v = np.array([1.0, 0.0]), np.array([0.0, 1.0])
    try:
        end = lesson.advance(
            getattr(lesson, method), lesson.oscillator_acceleration, 0.0, x, v, h_omega / OMEGA, steps, p
        )
    except (Diverged, np.linalg.LinAlgError):
        return np.inf
    factor = float(lesson.spectral_radius(np.array(end))) ** (1.0 / steps)
    return factor if np.isfinite(factor) else np.inf


def grows(lesson, method, h_omega, zeta=0.0):
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
    return max(abs(measured[zeta] - h) / (h or 1.0) for zeta, h in edges.items())


def turning(lesson, method, h_omega, steps, flatness=1.0):
    """Return the mean angle [rad] by which one step turns the motion, on an ellipse with axes 1 (x) and flatness (v/ω).

    On a wrong ellipse the angle alternately leads and lags, but the mean over many steps stays the same.
    """
    p, x, v = lesson.Oscillator(OMEGA, 0.0), np.ones(1), np.zeros(1)
    angles = np.zeros(steps + 1)
    for n in range(steps):
        x, v = lesson.advance(getattr(lesson, method), lesson.oscillator_acceleration, 0.0, x, v, h_omega / OMEGA, 1, p)
        angles[n + 1] = np.arctan2(-v[0] / (flatness * OMEGA), x[0])
    return np.unwrap(angles)[-1] / steps


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
    """|1 + hs| = 1:  hω = 2ζ for a complex pair, ζ ≤ 1;  2(ζ − √(ζ² − 1)) for the faster of two real roots."""
    return 2.0 * zeta if zeta <= 1.0 else 2.0 * (zeta - np.sqrt(zeta * zeta - 1.0))


def symplectic_euler_edge(zeta):
    """An eigenvalue reaches −1 where 1 + tr A + det A = 4 − 4ζ hω − (hω)² = 0."""
    return 2.0 * (np.sqrt(1.0 + zeta * zeta) - zeta)


def average_velocity_edge(zeta):
    """det A = 1 − 2ζ hω + ½(hω)² passes 1 at hω = 4ζ;  tr A + det A = 3 − 4ζ hω passes −1 at hω = 1/ζ."""
    return 4.0 * zeta if zeta <= 0.5 else 1.0 / zeta


def verlet_edge(zeta):
    """Solve the Jury conditions with the predicted velocity.

    1 + tr A + det A = 4 − 4ζ hω + (4ζ² − 1)(hω)² = 0  for ζ ≤ ½,  1 − tr A + det A = (hω)² (1 − ζ hω) = 0  beyond.
    """
    return 2.0 / (zeta + np.sqrt(1.0 - 3.0 * zeta * zeta)) if zeta <= 0.5 else 1.0 / zeta


EDGES = {
    "euler_step": euler_edge,
    "midpoint_step": lambda zeta: runge_kutta_edge((1.0, 1.0, 1.0 / 2.0), zeta) if zeta > 0.0 else 0.0,
    "rk4_step": lambda zeta: runge_kutta_edge((1.0, 1.0, 1.0 / 2.0, 1.0 / 6.0, 1.0 / 24.0), zeta),
    "average_velocity_step": average_velocity_edge,
    "symplectic_euler_step": symplectic_euler_edge,
    "verlet_step": verlet_edge,
}


def edge_picture(title, measured, sentence):
    """Draw theory's edges over ζ as lines and the measured ones as dots: measured = {method: {ζ: hω}}."""
    drawn = []
    for method, edges in measured.items():
        fine = np.linspace(0.0, max(edges), 121)
        drawn.append(series(f"{LABEL[method]}, theory", fine, [EDGES[method](zeta) for zeta in fine], LINE))
        drawn.append(series(f"{LABEL[method]}, measured", edges.keys(), edges.values(), DOTS))
    return Picture(title, "damping ratio ζ [-]", "longest stable hω [-]", drawn, sentence)


# ---------------------------------------------------------------------------------------------- the cases

@case("stability-limits", "Where each method is stable")
def stability_limits(lesson):
    """Every explicit method has an edge.  Without damping that of some is at hω = 0."""
    zetas, measured, found = (0.0, 0.1, 0.25, 0.5, 0.75, 1.0, 1.5, 2.0), {}, []
    for method, law in EDGES.items():
        measured[method] = {zeta: edge(lesson, method, zeta) for zeta in zetas}
        never = "" if law(0.0) > 0.0 else f"; without damping it grows at hω = {SHORTEST} already"
        worst = departure(measured[method], {zeta: law(zeta) for zeta in zetas})
        found.append(finding(
            claim=(f"The {LABEL[method]} method is stable up to the step at which an eigenvalue of one step leaves "
                   "the unit circle."),
            quantity=f"{LABEL[method]}: largest relative error of the edge over ζ = 0 to 2 [-]",
            predicted=0.0,
            measured=worst,
            tolerance=EDGE,
            observation=f"The edge of the {LABEL[method]} method agrees with theory to {worst:.1e}{never}.",
        ))
    return found, edge_picture(
        "Where each explicit method is stable",
        measured,
        "Below its curve a method is stable, above it the motion grows. Implicit Euler and implicit midpoint have no "
        "curve, because they are stable everywhere.",
    )


@case("stable-for-every-step", "Methods that are stable for every step", compiled=False)
def stable_for_every_step(lesson):
    """The two implicit methods have no edge: their motion stays bounded however long the step is.

    Seven steps: a velocity that is wrong by 1e-12 moves x by h 1e-12 = 3e-10 at the longest step, below NOISE.
    """
    tried, found = [(h_omega, zeta) for h_omega in (0.1, 1.0, 10.0, 100.0, 1000.0) for zeta in (0.0, 0.5)], []
    for method in (m.function for m in IMPLICIT):
        stable = sum(growth(lesson, method, *oscillator, steps=7) <= 1.0 + NOISE for oscillator in tried)
        found.append(finding(
            claim=f"The {LABEL[method]} method is stable for every step.",
            quantity=f"{LABEL[method]}: runs that stay bounded [of {len(tried)}]",
            predicted=len(tried),
            measured=stable,
            tolerance=0.0,
            observation=(f"From hω = 0.1 to 1000, undamped and at ζ = 0.5, {stable} of {len(tried)} runs of "
                         f"{LABEL[method]} stay bounded."),
        ))
    return found, None


def amplification(lesson, method, h_omega, zeta):
    """Return the factor [-] by which one step multiplies the motion at most, for arrays of hω and ζ at once.

    Each entry is an oscillator of its own.  One step from (x, v) = (1, 0) and one from (0, 1) give the matrix of the
    step, and its largest eigenvalue is the factor.
    """
    def acceleration(t, x, v, p):
        return -h_omega**2 * x - 2.0 * zeta * h_omega * v

    one, none, step = np.ones_like(h_omega), np.zeros_like(h_omega), getattr(lesson, method)
    columns = [np.stack(step(acceleration, 0.0, x, v, 1.0, None), axis=-1) for x, v in ((one, none), (none, one))]
    return np.abs(np.linalg.eigvals(np.stack(columns, axis=-1))).max(axis=-1)


@case("amplification", "How much a step amplifies", compiled=False)
def amplification_map(lesson):
    """The factor of one step over hω and ζ is at most 1 up to the edge that theory gives, and above 1 beyond it."""
    hs, zetas = (np.round(high * (np.arange(CELLS) + 0.5) / CELLS, 6) for high in (3.2, 2.0))
    h_omega, zeta = np.meshgrid(hs, zetas)
    fine, found, maps = np.linspace(0.0, 2.0, 201), [], []
    for method in (m.function for m in EXPLICIT):
        factors = amplification(lesson, method, h_omega, zeta)
        edges = np.array([EDGES[method](one) for one in zetas])
        right = int(np.sum((factors <= 1.0 + NOISE) == (h_omega < edges[:, None])))
        found.append(finding(
            claim=(f"A step of the {LABEL[method]} method amplifies no motion up to its edge of stability, and some "
                   "motion beyond it."),
            quantity=f"{LABEL[method]}: points of the map on the side that theory says [of {factors.size}]",
            predicted=factors.size,
            measured=right,
            tolerance=0.0,
            observation=f"{right:,} of {factors.size:,} points of the map of {LABEL[method]} are on the right side.",
        ))
        maps.append({"label": LABEL[method], "xs": hs, "ys": zetas, "values": np.round(factors, 3),
                     "curve": (np.array([EDGES[method](one) for one in fine]), fine)})
    return found, Picture(
        "How much a step amplifies", "hω [-]", "damping ratio ζ [-]", [],
        "Blue: a step shrinks the motion. Red: it grows, and the run will diverge. The black line is theory's edge of "
        "stability; it runs along the border of the colours.",
        tuple(maps), (0.0, 2.0),
    )


@case("explicit-euler", "Explicit Euler")
def explicit_euler(lesson):
    """Explicit Euler:  |1 + hs|² = 1 − 2ζ hω + (hω)² for ζ ≤ 1:  stable below 2ζ;  2(ζ − √(ζ² − 1)) for ζ > 1."""
    step, edges = "euler_step", {zeta: euler_edge(zeta) for zeta in (0.1, 0.25, 0.5, 0.75, 1.0, 1.5, 3.0)}
    measured = {zeta: edge(lesson, step, zeta) for zeta in (0.0, *edges)}
    flipped, worst, tiny = flips(lesson, step, edges), departure(measured, edges), growth(lesson, step, 0.001)
    return [
        finding(
            claim="Without damping explicit Euler is never stable: the motion grows by √(1 + (hω)²) per step.",
            quantity="growth per step, ζ = 0, hω = 0.001 [-]",
            predicted=np.sqrt(1.0 + 1e-6),
            measured=tiny,
            tolerance=GROWTH,
            observation=f"Even at a thousandth of a radian per step the motion grows, by {tiny - 1.0:.3e} per step.",
        ),
        finding(
            claim="For ζ ≤ 1 it is stable up to hω = 2ζ.",
            quantity="edge hω at ζ = 0.5 [-]",
            predicted=1.0,
            measured=measured[0.5],
            tolerance=EDGE,
            observation=(
                f"At half the critical damping the run turns from decay to growth at hω = {measured[0.5]:.5f}."
            ),
        ),
        finding(
            claim="For ζ > 1 it is stable up to hω = 2(ζ − √(ζ² − 1)).",
            quantity="edge hω at ζ = 1.5 [-]",
            predicted=edges[1.5],
            measured=measured[1.5],
            tolerance=EDGE * edges[1.5],
            observation=f"At one and a half times the critical damping it turns at hω = {measured[1.5]:.5f}.",
        ),
        finding(
            claim="The two formulas hold at every damping ratio.",
            quantity="largest relative error of the edge at 7 damping ratios [-]",
            predicted=0.0,
            measured=worst,
            tolerance=EDGE,
            observation=f"From ζ = 0.1 to 3 the measured edge differs from theory by at most {worst:.1e}.",
        ),
        finding(
            claim="The edge flips within ±0.1 %.",
            quantity="edges that flip [of 7]",
            predicted=len(edges),
            measured=flipped,
            tolerance=0.0,
            observation=(
                f"At {flipped} of {len(edges)} damping ratios a run stays bounded 0.1 % below the bound, and "
                "grows 0.1 % above."
            ),
        ),
    ], edge_picture(
        "Explicit Euler: the longest stable step",
        {step: measured},
        "Damping raises explicit Euler's limit to hω = 2 at ζ = 1. More damping lowers it again, because the faster "
        "of the two decays becomes too fast for the step.",
    )


@case("symplectic-euler", "Symplectic Euler")
def symplectic_euler(lesson):
    """Symplectic Euler:  stable below hω = 2(√(1 + ζ²) − ζ)."""
    step = "symplectic_euler_step"
    edges = {zeta: symplectic_euler_edge(zeta) for zeta in (0.0, 0.1, 0.25, 0.5, 1.0, 1.5, 3.0)}
    measured = {zeta: edge(lesson, step, zeta) for zeta in edges}
    beside = {zeta: edge(lesson, "euler_step", zeta) for zeta in edges}
    flipped, worst = flips(lesson, step, edges), departure(measured, edges)
    return [
        finding(
            claim="Without damping symplectic Euler is stable up to hω = 2.",
            quantity="edge hω at ζ = 0 [-]",
            predicted=2.0,
            measured=measured[0.0],
            tolerance=2.0 * EDGE,
            observation=(
                f"An undamped oscillator stays bounded up to hω = {measured[0.0]:.5f}: about a third of a period per "
                "step."
            ),
        ),
        finding(
            claim="At critical damping it is stable up to hω = 2(√2 − 1).",
            quantity="edge hω at ζ = 1 [-]",
            predicted=edges[1.0],
            measured=measured[1.0],
            tolerance=EDGE,
            observation=f"Critical damping shortens the longest stable step to hω = {measured[1.0]:.5f}.",
        ),
        finding(
            claim="The formula holds at every damping ratio.",
            quantity="largest relative error of the edge at 7 damping ratios [-]",
            predicted=0.0,
            measured=worst,
            tolerance=EDGE,
            observation=f"From ζ = 0 to 3 the measured edge differs from theory by at most {worst:.1e}.",
        ),
        finding(
            claim="The edge flips within ±0.1 %.",
            quantity="edges that flip [of 7]",
            predicted=len(edges),
            measured=flipped,
            tolerance=0.0,
            observation=(
                f"At {flipped} of {len(edges)} damping ratios a run stays bounded 0.1 % below the bound, and "
                "grows 0.1 % above."
            ),
        ),
    ], edge_picture(
        "Symplectic Euler: the longest stable step",
        {step: measured, "euler_step": beside},
        "Without damping symplectic Euler is stable where explicit Euler never is. It evaluates damping at the "
        "beginning of the step, so any damping lowers its limit.",
    )


@case("midpoint", "Midpoint: slow growth", compiled=False)
def midpoint(lesson):
    """Midpoint, undamped:  R(iy) = 1 + iy − ½y²,  |R|² = 1 + ¼y⁴,  y = hω."""
    step, law = "midpoint_step", lambda y: np.sqrt(1.0 + y**4 / 4.0)
    found = []
    for y in (0.05, 0.2, 1.0):
        rate = growth(lesson, step, y)
        found.append(finding(
            claim="Without damping the midpoint method always grows, by √(1 + (hω)⁴/4) per step.",
            quantity=f"growth per step at hω = {y:g} [-]",
            predicted=law(y),
            measured=rate,
            tolerance=GROWTH,
            observation=f"At hω = {y:g} the motion doubles every {np.log(2.0) / np.log(rate):,.0f} steps.",
        ))
    dots, fine = np.linspace(0.1, 1.2, 12), np.linspace(0.0, 1.2, 61)
    return found, Picture(
        "Midpoint: slow growth",
        "hω [-]",
        "growth per step [-]",
        [
            series("midpoint, theory", fine, law(fine), LINE),
            series("midpoint, measured", dots, [growth(lesson, step, y) for y in dots], DOTS),
            series("Euler, theory", fine, np.sqrt(1.0 + fine**2), LINE),
            series("Euler, measured", dots, [growth(lesson, "euler_step", y) for y in dots], DOTS),
        ],
        ("Both methods grow at every step length, but Euler's growth starts with (hω)²/2 and the midpoint method's "
         "with (hω)⁴/8."),
    )


@case("rk4", "Runge–Kutta 4")
def rk4(lesson):
    """Runge–Kutta 4, undamped:  |R(iy)|² = 1 − y⁶/72 + y⁸/576, stable up to √8.

    On the real axis it is stable up to the root of R(−z) = 1.  The real axis is an over-damped oscillator: at
    ζ = 5/4 it decays with the rates λ = 2ω and ½ω.
    """
    step, zeta, fast = "rk4_step", 1.25, 2.0
    real = min(-r.real for r in np.roots((1.0 / 24.0, 1.0 / 6.0, 1.0 / 2.0, 1.0)) if abs(r.imag) < 1e-6)
    imaginary_edge, real_edge = edge(lesson, step, 0.0), fast * edge(lesson, step, zeta)
    flipped = flips(lesson, step, {0.0: np.sqrt(8.0), zeta: real / fast})
    y = 0.2
    lost, at_one = 1.0 - growth(lesson, step, y) ** 2, growth(lesson, step, 1.0) ** 2
    law = lambda y: np.sqrt(1.0 - y**6 / 72.0 + y**8 / 576.0)
    dots, fine = np.linspace(0.2, 3.0, 15), np.linspace(0.0, 3.0, 121)
    return [
        finding(
            claim="On an undamped oscillator Runge–Kutta 4 is stable up to hω = √8.",
            quantity="edge hω on the imaginary axis [-]",
            predicted=np.sqrt(8.0),
            measured=imaginary_edge,
            tolerance=EDGE * np.sqrt(8.0),
            observation=f"The undamped run turns from decay to growth at hω = {imaginary_edge:.5f}.",
        ),
        finding(
            claim="On a pure decay it is stable up to hλ = 2.785294.",
            quantity="edge hλ on the real axis [-]",
            predicted=real,
            measured=real_edge,
            tolerance=EDGE * real,
            observation=f"The over-damped run turns at hλ = {real_edge:.5f}, λ the faster of its two decay rates.",
        ),
        finding(
            claim="Both edges flip within ±0.1 %.",
            quantity="edges that flip [of 2]",
            predicted=2,
            measured=flipped,
            tolerance=0.0,
            observation=f"At {flipped} of 2 edges a run stays bounded 0.1 % below the bound, and grows 0.1 % above.",
        ),
        finding(
            claim="Below its edge it damps: an undamped oscillator loses (hω)⁶/72 − (hω)⁸/576 of its energy per step.",
            quantity=f"energy lost per step at hω = {y} [-]",
            predicted=y**6 / 72.0 - y**8 / 576.0,
            measured=lost,
            tolerance=2.0 * GROWTH,
            observation=(f"At hω = {y} a step loses {lost:.3e} of the energy, so half of it is lost in "
                         f"{np.log(2.0) / lost:,.0f} steps."),
        ),
        finding(
            claim="At a larger step both terms count: |R|² = 1 − (hω)⁶/72 + (hω)⁸/576.",
            quantity="energy kept per step at hω = 1 [-]",
            predicted=1.0 - 1.0 / 72.0 + 1.0 / 576.0,
            measured=at_one,
            tolerance=2.0 * GROWTH,
            observation=f"At hω = 1 a step keeps {100.0 * at_one:.4f} % of the energy.",
        ),
    ], Picture(
        "Runge–Kutta 4 on an undamped oscillator",
        "hω [-]",
        "growth per step [-]",
        [
            series("theory", fine, law(fine), LINE),
            series("measured", dots, [growth(lesson, step, y) for y in dots], DOTS),
        ],
        ("Runge–Kutta 4 loses 0.6 % of the amplitude per step at hω = 1 and half of it at 2.45, where it damps most. "
         "Beyond 2.828 the motion grows."),
    )


@case("implicit-euler", "Implicit Euler: numerical damping", compiled=False)
def implicit_euler(lesson):
    """Implicit Euler damps an undamped oscillator:  |R(iy)| = (1 + y²)^(−½) per step, y = hω.

    It acts like a damping ratio  ln(1 + y²)/2y ≈ ½y.
    """
    step, law = "implicit_euler_step", lambda y: 1.0 / np.sqrt(1.0 + y * y)
    # few steps: Newton's tolerance of 1e-12 m/s is absolute, so the motion must not vanish
    few = 5
    ten_periods = 628
    found = []
    for y in (0.1, 1.0, 4.0):
        rate = growth(lesson, step, y, steps=few)
        found.append(finding(
            claim="Implicit Euler damps an undamped oscillator: the motion shrinks by (1 + (hω)²)^(−1/2) per step.",
            quantity=f"growth per step at hω = {y:g} [-]",
            predicted=law(y),
            measured=rate,
            tolerance=OMEGA * NEWTON / law(y) ** few,
            observation=f"At hω = {y:g} a step removes {100.0 * (1.0 - rate):.3g} % of the amplitude.",
        ))
    ratio = -np.log(growth(lesson, step, 0.1, steps=few)) / 0.1
    kept = growth(lesson, step, 0.1, steps=ten_periods) ** ten_periods
    found += [
        # e^(−ζ hω) per step: a growth known to OMEGA NEWTON in each of few steps, over hω
        finding(
            claim="The decay equals that of a damping ratio of ln(1 + (hω)²)/2hω, nearly ½hω.",
            quantity="numerical damping ratio at hω = 0.1 [-]",
            predicted=np.log(1.01) / 0.2,
            measured=ratio,
            tolerance=OMEGA * NEWTON / law(0.1) ** few / 0.1,
            observation=f"At hω = 0.1 implicit Euler acts on an undamped oscillator like ζ = {ratio:.4f}.",
        ),
        finding(
            claim="Ten periods at hω = 0.1 leave (1.01)^(−314) of the amplitude.",
            quantity="amplitude left after 628 steps [-]",
            predicted=1.01**-314,
            measured=kept,
            tolerance=OMEGA * NEWTON * ten_periods,
            observation=f"After ten periods at 63 steps per period {100.0 * kept:.2f} % of the amplitude is left.",
        ),
    ]
    dots, fine = np.linspace(0.25, 4.0, 16), np.linspace(0.0, 4.0, 121)
    return found, Picture(
        "Implicit Euler: numerical damping",
        "hω [-]",
        "growth per step [-]",
        [
            series("implicit Euler, theory", fine, law(fine), LINE),
            series("implicit Euler, measured", dots, [growth(lesson, step, y, steps=few) for y in dots], DOTS),
            series("implicit midpoint, theory", fine, np.ones_like(fine), LINE),
            series(
                "implicit midpoint, measured",
                dots,
                [growth(lesson, "implicit_midpoint_step", y, steps=few) for y in dots],
                DOTS,
            ),
        ],
        ("Implicit Euler never grows because it always shrinks. Implicit midpoint is equally stable, and keeps the "
         "amplitude."),
    )


@case("phase-error", "Verlet and implicit midpoint: phase", compiled=False)
def phase_error(lesson):
    """Verlet turns the motion by 2 asin(½hω) per step, implicit midpoint by 2 atan(½hω): energy is kept, phase is not.

    Verlet follows the ellipse  x² (1 − (hω)²/4) + (v/ω)² = const,  implicit midpoint the circle  x² + (v/ω)² = const.
    *Source:* cos θ = ½ tr A; Hairer, Lubich, Wanner 2006, I.5.
    """
    steps, fine, dots, found, drawn = 1000, np.linspace(0.02, 1.6, 80), np.linspace(0.2, 1.6, 8), [], []
    methods = (("verlet_step", np.arcsin, 0.25, GROWTH), ("implicit_midpoint_step", np.arctan, 0.0, OMEGA * NEWTON))
    for step, inverse, flat, known in methods:
        name = LABEL[step]
        law = lambda y, inverse=inverse: 2.0 * inverse(0.5 * y) / y
        flatness = lambda y, flat=flat: np.sqrt(1.0 - flat * y * y)
        frequency = lambda y, step=step, flatness=flatness: turning(lesson, step, y, steps, flatness(y)) / y
        for y in (0.1, 0.5, 1.0):
            got = frequency(y)
            side = "ahead" if got > 1.0 else "behind"
            found.append(finding(
                claim=(f"{name[0].upper()}{name[1:]} oscillates at (2/h) {'asin' if flat else 'atan'}(hω/2) instead "
                       "of ω."),
                quantity=f"{name}: frequency over the true one at hω = {y:g} [-]",
                predicted=law(y),
                measured=got,
                tolerance=known / y,
                observation=(f"At hω = {y:g} {name} is a whole period {side} after {1.0 / abs(got - 1.0):,.0f} "
                             "periods."),
            ))
        kept = growth(lesson, step, 0.5)
        found.append(finding(
            claim=f"{name[0].upper()}{name[1:]} keeps the amplitude.",
            quantity=f"{name}: growth per step at hω = 0.5 [-]",
            predicted=1.0,
            measured=kept,
            tolerance=known,
            observation=(f"After {STEPS} steps of {name} the amplitude is {kept**STEPS:.10f} of the initial one: the "
                         "error is all in the phase."),
        ))
        drawn += [series(f"{name}, theory", fine, 100.0 * (law(fine) - 1.0), LINE),
                  series(f"{name}, measured", dots, [100.0 * (frequency(y) - 1.0) for y in dots], DOTS)]
    return found, Picture("Phase: too fast and too slow", "hω [-]", "error of the frequency [%]", drawn,
                          "At small steps Verlet leads by (hω)²/24 and implicit midpoint lags by twice as much; "
                          "neither loses energy.")


class StiffPair(NamedTuple):
    """A wall at 0, then a spring, a mass, a spring, a mass; at rest at x = (1, 2)."""
    k1: float = 750.0        # from the wall to mass 1 [N/m]
    k2: float = 1e20         # between the masses [N/m]
    m: float = 1.0           # of each [kg]
    rest: float = 1.0        # rest length of each spring [m]


def stiff_pair(t, x, v, p):
    """a₁ = (F − k₁(x₁ − L))/m,  a₂ = −F/m,  F = k₂(x₂ − x₁ − L)."""
    F = p.k2 * (x[1] - x[0] - p.rest)
    return np.array([F - p.k1 * (x[0] - p.rest), -F]) / p.m


@case("stiff-pair", "A stiff pair", compiled=False)
def stiff_pair_case(lesson):
    """A stiff pair, released at rest from x = (0.5, 1.5), moves as one: ω² = k₁/2m = 375,  ω₂ = √(2k₂/m) = 1.4e10.

    The second spring starts unstretched and must pull with 187.5 N: it stretches by 1.9e-18 m, below a hundredth of the
    spacing of floats there.  Per step the mean of both turns by atan(hω) on a spiral under implicit Euler, and by
    2 atan(½hω) on a circle under implicit midpoint.  At dt = 10 ms the 1 in  1 + h²k₂  is below round-off, and Newton's
    matrix is singular.
    """
    p, dt, steps = StiffPair(), 0.002, 500
    omega, stiff, amplitude = np.sqrt(p.k1 / (2.0 * p.m)), np.sqrt(2.0 * p.k2 / p.m), 0.5
    # [m/s]: Newton's tolerance, 1e-12 of the fastest velocity, 9.7 m/s, at every step
    newton = NEWTON * omega * amplitude * steps
    y = omega * dt
    laws = {"implicit_euler_step": (np.arctan(y), 1.0 / np.sqrt(1.0 + y * y)),
            "implicit_midpoint_step": (2.0 * np.arctan(0.5 * y), 1.0)}
    found, drawn = [], []
    for step, (angle, shrink) in laws.items():
        ts, middle, velocity, stretch = swing(lesson, step, p, dt, steps)
        turned = np.unwrap(np.arctan2(velocity / omega, -middle))[-1] / (steps * dt)
        left = np.hypot(middle[-1], velocity[-1] / omega)
        size = amplitude * shrink**steps
        # implicit Euler removes the stiff mode at every step, implicit midpoint keeps what every step leaves of it
        loose = 2.0 * dt * (newton if shrink == 1.0 else newton / steps) + np.spacing(2.0)
        found += [
            finding(
                claim="The soft mode oscillates at the frequency of the method, as if the stiff spring were a rod.",
                quantity=f"{LABEL[step]}: frequency of the soft mode [rad/s]",
                predicted=angle / dt,
                measured=turned,
                tolerance=newton / (omega * size) / (steps * dt),
                observation=(f"With hω₂ = {dt * stiff:.1e} {LABEL[step]} oscillates at {turned:.6f} rad/s; the exact "
                             f"value is {omega:.6f}."),
            ),
            finding(
                claim="Its amplitude is that of the same method on an oscillator without a stiff spring.",
                quantity=f"{LABEL[step]}: amplitude of the soft mode after 1 s [m]",
                predicted=size,
                measured=left,
                tolerance=newton / omega,
                observation=f"After 1 s {LABEL[step]} has {left:.6f} m of {amplitude} m left.",
            ),
            finding(
                claim="The stiff spring stays stable and keeps its length.",
                quantity=f"{LABEL[step]}: largest stretch of the stiff spring [m]",
                predicted=0.0,
                measured=stretch,
                tolerance=loose,
                observation=(f"{LABEL[step][0].upper()}{LABEL[step][1:]} keeps the stiff spring's length within "
                             f"{stretch:.1e} m; floats are 4.4e-16 m apart."),
            ),
        ]
        drawn.append(series(LABEL[step], ts, 1.0 + middle, DOTS))
    x, v = np.array([0.5, 1.5]), np.zeros(2)
    refused = refuse(EXPLICIT, lambda name: lesson.advance(getattr(lesson, name), stiff_pair, 0.0, x, v, dt, steps, p))
    found.append(finding(
        claim="Every explicit method must refuse: its step may not exceed about 2/ω₂ = 1.4e-10 s.",
        quantity="explicit methods that raise Diverged [of 6]",
        predicted=len(EXPLICIT),
        measured=refused,
        tolerance=0.0,
        observation=(f"At dt = {dt} s {refused} of {len(EXPLICIT)} explicit methods end in an error instead of a "
                     "number."),
    ))
    fine = np.linspace(0.0, steps * dt, 241)
    drawn.insert(0, series("truth", fine, 1.0 - amplitude * np.cos(omega * fine), LINE))
    return found, Picture(
        "A stiff pair: motion of the soft mode",
        "t [s]",
        "position of mass 1 [m]",
        drawn,
        "The step is ten million times too long for the stiff spring, and both implicit methods follow the soft "
        "mode. Implicit Euler damps it, implicit midpoint does not.",
    )


def swing(lesson, step, p, dt, steps):
    """Return times, mean displacement and velocity of the pair, and the stiff spring's largest stretch.

    NaN from the step on at which the run diverges.
    """
    x, v = np.array([0.5, 1.5]), np.zeros(2)
    xs, vs = np.full((steps + 1, 2), np.nan), np.full((steps + 1, 2), np.nan)
    xs[0], vs[0] = x, v
    try:
        for n in range(steps):
            x, v = lesson.advance(getattr(lesson, step), stiff_pair, n * dt, x, v, dt, 1, p)
            xs[n + 1], vs[n + 1] = x, v
    except (Diverged, np.linalg.LinAlgError):
        pass
    at_rest = np.array([1.0, 2.0]) * p.rest
    return (
        dt * np.arange(steps + 1),
        (xs - at_rest).mean(axis=1),
        vs.mean(axis=1),
        np.abs(xs[:, 1] - xs[:, 0] - p.rest).max(),
    )


END = 1e11                   # of the reaction [s]
PUBLISHED = np.array([2.08334014970e-8, 8.33336077e-14, 0.99999997917])      # y(10¹¹ s)


def robertson(t, x, v, p):
    """ẏ₁ = −0.04 y₁ + 10⁴ y₂ y₃,   ẏ₂ = −ẏ₁ − ẏ₃,   ẏ₃ = 3·10⁷ y₂²,  with y in the place of v; x is unused.

    *Source:* Robertson 1966; Hairer and Wanner 1996, IV.10; values at 10¹¹ s: Mazzia and Magherini, "Test set for
    IVP solvers".
    """
    slow, back, fast = 0.04 * v[0], 1e4 * v[1] * v[2], 3e7 * v[1] * v[1]
    return np.array([back - slow, slow - back - fast, fast])


def react(lesson, step, ratio):
    """Return times and concentrations of the reaction from 10⁻⁵ s to END; each time is `ratio` times the one before."""
    ts = END * ratio ** np.arange(-round(16.0 / np.log10(ratio)), 1.0)
    t, x, y, ys = 0.0, np.zeros(3), np.array([1.0, 0.0, 0.0]), []
    for end in ts:
        x, y = lesson.advance(getattr(lesson, step), robertson, t, x, y, end - t, 1, ())
        t = end
        ys.append(y)
    return ts, np.array(ys)


@case("robertson", "Robertson's reaction", compiled=False)
def robertson_case(lesson):
    """Robertson's reaction to 10¹¹ s, with the steps in a constant ratio.

    Late, y₂ = 4·10⁻⁶ y₁ and  ẏ₁ = −c y₁²,  c = 3·10⁷ (4·10⁻⁶)² = 4.8e-4 /s:  y₁ = 1/ct.
    Implicit Euler with times tₙ₊₁ = q tₙ turns that into  uₙ₊₁ = uₙ − (q − 1) tₙ c uₙ₊₁²,  solved by uₙ = q/(c tₙ).
    Its relative error is q − 1, first order in the step.  The exact solution differs by 3.3e-6 from 1/ct, so the
    error is known to about that.  Explicit Euler is limited by the fast rate |λ| = 0.04 + 10⁴ y₃ + … to steps below
    2/|λ|.
    """
    found = []
    beside = abs(PUBLISHED[0] * 4.8e-4 * END - 1.0)
    for per_decade in (50, 100):
        ratio = 10.0 ** (1.0 / per_decade)
        ts, ys = reached(lesson, ratio)
        for k, name in enumerate(("y₁", "y₂")):
            error = ys[-1, k] / PUBLISHED[k] - 1.0
            found.append(finding(
                claim=f"With times in the ratio q implicit Euler is wrong by q − 1 in {name}: first order.",
                quantity=f"relative error of {name} at 10¹¹ s, {per_decade} steps per decade [-]",
                predicted=ratio - 1.0,
                measured=error,
                tolerance=beside,
                observation=(f"{len(ts):,} steps reach 10¹¹ s with {name} {100.0 * error:.4f} % above the published "
                             "value."),
            ))
    # in a step the terms dt·0.04 y₁ < 2 cancel, each rounded by 1.1e-16 of itself about eight times
    total = ys[-1].sum()
    found.append(finding(
        claim="The total is conserved: y₁ + y₂ + y₃ = 1.",
        quantity="sum of the concentrations at 10¹¹ s [-]",
        predicted=1.0,
        measured=total,
        tolerance=len(ts) * 16 * 1.1e-16,
        observation=f"After {len(ts):,} steps the sum differs from 1 by {abs(total - 1.0):.0e}.",
    ))
    refused = refuse(EXPLICIT, lambda name: react(lesson, name, ratio))
    found.append(finding(
        claim="Every explicit method must refuse such steps.",
        quantity="explicit methods that raise Diverged [of 6]",
        predicted=len(EXPLICIT),
        measured=refused,
        tolerance=0.0,
        observation=f"{refused} of {len(EXPLICIT)} explicit methods end in an error instead of a number.",
    ))
    longest = 2.0 / fastest_rate(PUBLISHED)
    step = bisect(lambda dt: leaves(lesson, dt), 1e-5, 1e-3)
    found.append(finding(
        claim="Explicit Euler is limited to steps of 2/|λ| even at the end, where the concentrations hardly change.",
        quantity="longest step of explicit Euler at 10¹¹ s [s]",
        predicted=longest,
        measured=step,
        tolerance=EDGE * longest,
        observation=(f"A disturbance of y₂ grows at steps above {step:.5e} s, so 10¹¹ s would take {END / step:.1e} "
                     "steps."),
    ))
    late = ts > 1e3
    drawn = [
        series(f"{name}, implicit Euler", np.log10(ts), np.log10(y), LINE) for name, y in zip(("y₁", "y₂", "y₃"), ys.T)
    ]
    drawn += [series("published", [np.log10(END)] * 3, np.log10(PUBLISHED), DOTS),
              series("1/ct", np.log10(ts[late]), -np.log10(4.8e-4 * ts[late]), LINE)]
    return found, Picture(
        "Robertson's reaction",
        "log₁₀ of time [s]",
        "log₁₀ of concentration [-]",
        drawn,
        f"Sixteen decades of time in {len(ts):,} steps, each {100.0 * (ratio - 1.0):.1f} % longer than the one "
        "before. Implicit Euler ends that much above the published y₁ and y₂; late y₁ follows 1/ct.",
    )


def reached(lesson, ratio):
    """Return the end of implicit Euler's run, or NaN if it diverges."""
    try:
        return react(lesson, "implicit_euler_step", ratio)
    except (Diverged, np.linalg.LinAlgError):
        return np.array([END]), np.full((1, 3), np.nan)


def fastest_rate(y):
    """Return the largest |eigenvalue| [1/s] of the reaction's Jacobian."""
    J = np.array(
        [[-0.04, 1e4 * y[2], 1e4 * y[1]], [0.04, -1e4 * y[2] - 6e7 * y[1], -1e4 * y[1]], [0.0, 6e7 * y[1], 0.0]]
    )
    return np.abs(np.linalg.eigvals(J)).max()


def leaves(lesson, dt):
    """Return whether 1,000 steps of explicit Euler amplify a y₂ that starts half too large.

    y₂ returns to a value that differs by 4·10⁻⁶ of the disturbance, because y₁ has taken up the rest.  Over 1,000
    steps that shifts the edge by 2e-9.
    """
    disturbed = np.array([1.0, 1.5, 1.0]) * PUBLISHED
    try:
        _, y = lesson.advance(lesson.euler_step, robertson, END, np.zeros(3), disturbed, dt, 1000, ())
    except Diverged:
        return True
    return abs(y[1] - PUBLISHED[1]) > 0.5 * PUBLISHED[1]


# ---------------------------------------------------------------------------------------------- one step

TRIED = 20                   # random states and forces [-]
ROUNDED = 1e-13              # of a few hundred roundings of 1.1e-16, relative to the state


class Swing(NamedTuple):
    """Two masses whose force depends on everything: on time, place and velocity, each across both of them."""
    k: np.ndarray            # (2, 2) [1/s²]
    c: np.ndarray            # (2, 2) [1/s]; 0: the force does not depend on the velocity
    drive: np.ndarray        # (2,) [m/s²]
    omega: float             # of the drive [rad/s]


def swinging(t, x, v, p):
    """a = −K sin x − C tanh v + drive cos ωt."""
    return -p.k @ np.sin(x) - p.c @ np.tanh(v) + p.drive * np.cos(p.omega * t)


@case("one-step", "One step of each method", compiled=False)
def one_step(lesson):
    """A method is its table of coefficients: one step under a force of t, x and v is the same to round-off."""
    rng, worst, history = np.random.default_rng(11), Worst(), 0.0
    for _ in range(TRIED):
        (k, c), (x, v, drive) = rng.uniform(-1.0, 1.0, (2, 2, 2)), rng.uniform(-1.0, 1.0, (3, 2))
        t, h, omega = rng.uniform((0.0, 0.1, 2.0), (1.0, 0.3, 4.0))
        for method in (*INTEGRATORS, BLANES_MOAN):
            p = Swing(k, 0.0 * c if method is BLANES_MOAN else c, drive, omega)
            law, step = lambda t, x, v, p=p: swinging(t, x, v, p), schemes.step_of(method.table)
            truth = step(law, t, x, v, h)
            got = getattr(lesson, method.function)(swinging, t, x, v, h, p)
            worst.keep(method, np.max(np.abs(np.array(got) - truth)))
        # a history is that of single steps, each at its own time, and ends where a run of many steps ends
        p, states, rk4 = Swing(k, c, drive, omega), [(x, v)], lesson.rk4_step
        for n in range(3):
            law = lambda t, x, v, p=p: swinging(t, x, v, p)
            states.append(schemes.step_of(schemes.RK4)(law, t + n * h, *states[-1], h))
        ts, xs, vs = lesson.trajectory(rk4, swinging, t, x, v, h, 3, p)
        end = np.array(lesson.advance(rk4, swinging, t, x, v, h, 3, p))
        errors = np.stack((xs, vs), axis=1) - np.array(states), ts - t - h * np.arange(4), end - states[-1]
        history = np.max((history, *(np.max(np.abs(error)) for error in errors)))
    return [agreement(f"One step of {method.label} is that of its published coefficients.",
                      f"{method.label}: largest error of a step [m, m/s]", error,
                      100.0 * NEWTON if method in IMPLICIT else ROUNDED) for method, error in worst.items()] + [
        agreement("Many steps are single steps, each at its own time.",
                  "history of Runge–Kutta 4: largest error in three steps [s, m, m/s]", history, ROUNDED)], None


# ---------------------------------------------------------------------------------------------- adaptive steps

SHARE = 0.1                  # of the adaptive steps [-]
SHAPES = (0.0, 0.3, 0.6, 0.9, 0.99)          # eccentricities [-]
COUNTED = SHARE**2           # the rate lags behind the truth by the square of a step, relative to it [-]


def attracted(t, x, v, p):
    """a = −μ x/|x|³"""
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


@case("adaptive-steps", "Steps that adapt to the distance", compiled=False)
def adaptive_steps(lesson):
    """A revolution takes as many steps as the rule promises, from any place, and a fall ends where the sun is."""
    counts = np.array([steps_per_revolution(lesson, Planet(e=e)) for e in SHAPES])
    theory = np.array([counted_by_theory(e) for e in SHAPES])
    worst, rng = 0.0, np.random.default_rng(13)
    for _ in range(TRIED // 2):
        mu, a, e, before, T = rng.uniform((0.5, 0.5, 0.1, 0.0, 1.0), (2.0, 2.0, 0.8, 6.0, 4.0))
        p = Planet(mu, a, e)
        x, v = orbit(*perihelion(p), mu, before)
        plane = np.linalg.qr(rng.normal(size=(3, 3)))[0][:2]              # of the ellipse, anywhere in space
        got, _ = lesson.advance_adaptive(lesson.blanes_moan_step, attracted, before, x @ plane, v @ plane, SHARE, T, p)
        truth = adaptive_march(lambda t, x, v, mu=mu: -mu * x / abs(x) ** 3, complex(*x), complex(*v), SHARE, T)
        worst = np.max((worst, np.linalg.norm(got - (truth.real, truth.imag) @ plane) / a))
    p, r = Planet(mu=2.0), 1.5
    fall = np.pi / np.sqrt(8.0) * np.sqrt(r**3 / p.mu)
    start = np.array([r, 0.0]), np.zeros(2)
    found = bisect(lambda T: refuse((BLANES_MOAN,), lambda name: lesson.advance_adaptive(
        getattr(lesson, name), attracted, 0.0, *start, SHARE, T, p)) == 1, 0.5 * fall, 2.0 * fall)
    return [
        agreement("A planet at any place of its ellipse moves as by the published rule.",
                  "positions after some revolutions: largest error, over a [-]", worst, 100.0 * ROUNDED),
        finding(claim="A revolution with the eccentricity 0.99 takes ∮(1 − e cos E)^(−1/2) dE/share steps.",
                quantity="steps per revolution [-]", predicted=theory[-1], measured=counts[-1],
                tolerance=COUNTED * theory[-1] + 0.1,
                observation=f"It takes {counts[-1]:.1f} steps, and a circle {counts[0]:.1f}. Equal steps that are as "
                            f"short near the sun would be {1e3 * 2.0 * np.pi / SHARE:,.0f}."),
        finding(claim="A fall from rest reaches the origin after π/√8 √(r³/μ), and no step leads beyond.",
                quantity="longest run that ends with a number [s]", predicted=fall, measured=found,
                tolerance=(SHARE**4 + EDGE) * fall,
                observation=f"A run of {found:.6f} s ends; a longer one raises Diverged."),
    ], Picture(
        "How many steps a revolution needs", "eccentricity [-]", "adaptive steps per revolution [-]",
        [series("∮(1 − e cos E)^(−1/2) dE/share", curve := np.linspace(0.0, 0.995, 100),
                [counted_by_theory(e) for e in curve], LINE),
         series("counted in ten revolutions", SHAPES, counts, DOTS)],
        f"The share is {SHARE:g}: on a circle, the angle of a step. A comet that comes a hundred times nearer to the "
        "sun than a planet needs only about twice as many steps.")


@case("what-measures-methods", "What measures a method", compiled=False)
def what_measures_methods(lesson):
    """The matrix of a step, its spectral radius and the order of convergence, on examples whose answers are known."""
    rng, errors = np.random.default_rng(12), {"matrix": [], "newton": [], "radius": [], "order": []}
    for _ in range(TRIED):
        omega, zeta, h, order, scale = rng.uniform((0.5, 0.1, 0.1, 1.0, 0.1), (3.0, 2.0, 1.0, 4.0, 10.0))
        euler = np.array([[1.0, h], [-h * omega**2, 1.0 - 2.0 * zeta * omega * h]])
        errors["matrix"].append(np.max(np.abs(lesson.amplification_matrix(lesson.euler_step, omega, zeta, h) - euler)))

        (k, c), (x, v, drive) = rng.uniform(-1.0, 1.0, (2, 2, 2)), rng.uniform(-1.0, 1.0, (3, 2))
        slope = -h * k * np.cos(x + h * v) - c / np.cosh(v) ** 2
        matrix = lesson.newton_matrix(swinging, 0.3, x, v, h, Swing(k, c, drive, 1.0))
        errors["newton"].append(np.max(np.abs(matrix - (np.eye(2) - h * slope))))

        any_matrix = rng.uniform(-1.0, 1.0, (2, 2))
        radius = np.max(np.abs(np.linalg.eigvals(any_matrix)))
        errors["radius"].append(abs(lesson.spectral_radius(any_matrix) - radius))

        dts = np.array([0.1, 0.05, 0.02, 0.01])
        scattered = scale * dts**order * rng.uniform(0.9, 1.1, 4)
        slope = np.polyfit(np.log(dts), np.log(scattered), 1)[0]
        errors["order"].append(abs(lesson.observed_order(dts, scattered) - slope))
    # a central difference of h = 6e-6 errs by h²/6 times a third derivative, and by round-off over h: 2e-10 in all;
    # near a double eigenvalue round-off counts by its root
    return [agreement("The matrix of a step of Euler is 1 + h J.", "entries of the matrix: largest error [-]",
                      max(errors["matrix"]), ROUNDED),
            agreement("Newton's matrix is 1 − dt ∂a/∂v, along x + dt v.", "Newton's matrix: largest error [-]",
                      max(errors["newton"]), 1e-9),
            agreement("The spectral radius is the largest absolute eigenvalue.", "spectral radius: largest error [-]",
                      max(errors["radius"]), 1e-9),
            agreement("The observed order is the slope of the least squares on logarithmic scales.",
                      "order: largest error [-]", max(errors["order"]), 1e-12)], None


# ---------------------------------------------------------------------------------------------- a million steps

DYADIC = 1.0 / 64.0          # a step [s] whose products with ½ and with itself are exact: a sum is all that is rounded
CIRCLES = 16                 # planets on the same circle, at other places
SPREAD = 3.0 / np.sqrt(2.0 * CIRCLES)   # three standard deviations of the root mean square of so many, over its mean
MANY, FEW = 10**6, 10**4     # steps of a run: compiled, and in plain Python


def attracted_each(t, x, v, p):
    """a = −μ x/|x|³ for each row of x (n, 2)"""
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


@case("a-million-steps", "A million steps of a planet")
def a_million_steps(lesson):
    """On its discrete circle Verlet keeps the energy, so that nothing but rounding changes it: a random walk.

    After n steps it is off by √n times one step's share (Brouwer's law).  The step is a power of two, because a rounded
    ½dt² would be a systematic error, which grows by n.
    *Source:* Brouwer 1937; Hairer, McLachlan, Razakarivony 2008, "Achieving Brouwer's law with implicit Runge–Kutta
    methods".
    """
    fast = hasattr(lesson.verlet_step, "py_func")
    law, longest = (jitted(attracted_each), MANY) if fast else (attracted_each, FEW)
    x, v = discrete_circle(DYADIC, np.arange(1.0, CIRCLES + 1.0))
    energy = lambda x, v: 0.5 * np.sum(v * v, axis=1) - 1.0 / np.sqrt(np.sum(x * x, axis=1))
    counts, walks, share = [longest // 100, longest // 10, longest], [], walk_of_energy(DYADIC)
    for n in counts:
        off = energy(*lesson.advance(lesson.verlet_step, law, 0.0, x, v, DYADIC, n, Planet())) - energy(x, v)
        walks.append(np.sqrt(np.mean(off**2)))
    return [finding(
        claim="Rounding changes the energy of a planet like a random walk, by √n times the share of one step.",
        quantity=f"energy after {n:,} steps: root mean square of {CIRCLES} planets [J/kg]",
        predicted=share * np.sqrt(n), measured=walk, tolerance=SPREAD * share * np.sqrt(n),
        observation=f"After {n:,} steps, {n * 2.0 * np.arcsin(0.5 * DYADIC) / (2.0 * np.pi):,.0f} revolutions, the "
                    f"energy is off by {walk:.1e} J/kg.") for n, walk in zip(counts, walks)], Picture(
        "The energy of a planet, rounded a million times", "log₁₀ of the steps [-]",
        "log₁₀ of the energy's error [J/kg]",
        [series("√n times the share of one step", np.log10(counts), np.log10(share * np.sqrt(counts)), LINE),
         series("measured", np.log10(counts), np.log10(walks), DOTS)],
        "A hundred times as many steps make ten times the error. Shorter steps do not help, because more are needed.")


# ---------------------------------------------------------------------------------------------- the limit of prediction

HELD, HORIZON = np.radians([120.0, 120.0]), 0.1      # both arms at the start [rad]; a prediction is lost beyond [rad]
AHEAD, SLICES = 16.0, 50     # duration of the runs [s]; samples per second
EXPONENTS = (2, 4, 6, 8)     # one start is off by ten to minus each of these [rad]
# Where 0.1 rad is reached the growth is no longer quite linear, and the motion turns once per half second.
RIPPLE = 0.1                 # [s]


def double_pendulum(t, x, v, p):
    """θ̈ of two equal arms of 1 m with masses at their ends, in each row of x = (θ₁, θ₂), both from the vertical.

    2θ̈₁ + c θ̈₂ = −s ω₂² − 2g sin θ₁,    c θ̈₁ + θ̈₂ = s ω₁² − g sin θ₂,    s, c: sine and cosine of θ₁ − θ₂
    """
    s, c = np.sin(x[:, 0] - x[:, 1]), np.cos(x[:, 0] - x[:, 1])
    f = -s * v[:, 1] ** 2 - 2.0 * 9.81 * np.sin(x[:, 0])
    h = s * v[:, 0] ** 2 - 9.81 * np.sin(x[:, 1])
    return np.stack(((f - c * h) / (2.0 - c * c), (2.0 * h - c * f) / (2.0 - c * c)), axis=1)


def true_growth():
    """Return (ts, angles (n, 2), factors (n,)): the motion, and what a small error in θ₁ has grown to at most by then.

    An imaginary part of 1e-30 in the start is carried along as the derivative by it, to all digits.
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
    """Return the angles (n, k, 2) of runs from these starts, with so many steps per second, at the times ts."""
    run = lesson.trajectory(lesson.rk4_step, double_pendulum, 0.0, starts, 0.0 * starts, 1.0 / steps,
                            round(AHEAD * steps), None)
    return run[1][::steps // SLICES]


@case("limit-of-prediction", "How long a double pendulum can be predicted", compiled=False)
def limit_of_prediction(lesson):
    """A small error grows by a factor that the motion alone decides, whatever its cause: method, start or rounding."""
    ts, truth, factor = true_growth()
    starts = HELD + np.array([[0.0, 0.0], *([10.0**-k, 0.0] for k in EXPONENTS)])
    fine, coarse = (sampled(lesson, starts, steps) for steps in (500, 250))
    apart = np.linalg.norm(fine[:, 1:] - fine[:, :1], axis=2).T
    lost = [first_beyond(ts, np.linalg.norm(run[:, 0] - truth, axis=1)) for run in (fine, coarse)]
    found = [finding(
        claim="Two starts that differ by ε are apart by ε times the growth of a small error, while that is small.",
        quantity=f"time until starts 1e-{k} rad apart differ by {HORIZON:g} rad [s]",
        predicted=first_beyond(ts, factor * 10.0**-k), measured=first_beyond(ts, sizes), tolerance=RIPPLE,
        observation=f"They differ by {HORIZON:g} rad after {first_beyond(ts, sizes):.2f} s.")
        for k, sizes in zip(EXPONENTS, apart)]
    later = first_beyond(ts, factor / np.interp(lost[1], ts, factor), 16.0)
    found.append(finding(
        claim="Half the step makes Runge–Kutta 4 sixteen times as accurate. The prediction then lasts until an error "
              "has grown sixteen times larger.",
        quantity="time until 500 steps per second err by 0.1 rad [s]", predicted=later, measured=lost[0],
        tolerance=2.0 * RIPPLE,
        observation=f"250 steps per second predict {lost[1]:.2f} s, and 500 predict {lost[0]:.2f} s."))
    every = slice(None, None, 5)
    return found, Picture(
        "How two nearly equal starts part", "t [s]", "log₁₀ of the distance of the two [rad]",
        [line for k, sizes in zip(EXPONENTS, apart) for line in (
            series(f"1e-{k}, theory", ts[every], np.log10(np.minimum(10.0, factor[every] * 10.0**-k)), LINE),
            series(f"1e-{k}, measured", ts[1::40], np.log10(np.maximum.accumulate(sizes)[1::40]), DOTS))],
        f"After {AHEAD:g} s an error is {factor[-1]:.0e} times as large. A thousand times the accuracy buys only a few "
        "seconds. Rounding, which is 1e-16, limits every prediction, that of the truth included.")
