"""Reference solutions for the scenes of lesson 9: many contacts, without the lesson's sweeps, matrices and piles."""

import numpy as np

# ---------------------------------------------------------------------- a heavy body on a light one

def sweeps_needed(r, omega, small):
    """Return the number of relaxed sweeps from zero after which two forces are right to `small`, relative.

    A body of mass r stands on a body of mass 1.  The forces are F = ((1 + r) g, r g), from below.  The errors
    e = λ/F − 1 obey, with the lower contact first,

        e₀' = (1 − ω) e₀ + ω r/(1 + r) e₁,      e₁' = (1 − ω) e₁ + ω e₀'

    and start at −1.  (The upper contact asks for as much as would stop its approach, which is r/(1 + r) of λ₀, and
    F₁ = r/(1 + r) F₀.)  With ω = 1 both are −ρᵏ after k sweeps, with ρ = r/(1 + r): k = ln(small)/ln ρ.
    """
    if omega == 1.0:
        return np.ceil(-np.log(small) / np.log1p(1.0 / r))
    e, done = (-1.0, -1.0), 0
    while max(abs(e[0]), abs(e[1])) > small:
        lower = (1.0 - omega) * e[0] + omega * r / (1.0 + r) * e[1]
        e, done = (lower, (1.0 - omega) * e[1] + omega * lower), done + 1
    return float(done)
