"""Laws of bodies on joints that hold for every solver: joints stay closed, and only loads change the energy.

Engines do not report the forces of their joints, so the laws need nothing but places and velocities after each step.
They hold as far as the engine's step allows.  A step of the length dt moves bodies along tangents, and a point at the
lever r leaves its circle by ½ r (ω dt)²; both bodies of a joint do, so that it opens by up to r (ω dt)².  Symplectic
Euler keeps H + ½ dt ω² x·v of an oscillator with the energy H, which therefore swings by up to ½ ω dt of the largest
energy of motion.  A step of second order changes it by (ω dt)².  ω is the fastest rate of the motion.
"""

from typing import NamedTuple

import numpy as np

from ..check import JointsAllowed
from . import laws
from .laws import Law


class Reading(NamedTuple):
    """Bodies on joints after a step of an engine."""
    gap: float               # largest distance of the two points of a joint, over the longest lever [-]
    energy: float            # gained since the start, less the work of loads [J]
    kinetic: float           # energy of motion [J]
    turn: float              # ω dt [rad]


QUANTITIES = {
    "gap": "largest gap of a joint, over the longest lever [-]",
    "energy": "energy gained, less the work of loads, over the largest energy of motion [-]",
}
LOST = 2.0                   # times the law's limit that loops closed by springs and dampers may take of the energy [-]
MEASURED = {QUANTITIES["energy"]: f"at most {LOST:g} (ω dt)² where a rule of MuJoCo breaks it, from runs in lesson 10, "
            "which took up to 1.6"}


def judged(moments, allowed: JointsAllowed):
    """Return the Laws of all steps of a run."""
    gap, energy, kinetic = (np.abs([getattr(one, name) for one in moments]) for name in ("gap", "energy", "kinetic"))
    found = {"gap": np.max(gap), "energy": np.max(energy) / np.max(kinetic)}
    turn = moments[0].turn
    within = {"gap": turn**2, "energy": 0.5 * turn if allowed.order == 1 else turn**2}
    rules = {name: (None if times is None else times * within[name], why) for name, why, times in allowed.rules}
    return [Law(QUANTITIES[name], float(value), within[name], *rules.get(name, (None, "")))
            for name, value in found.items()]


def verdict_on(found):
    """Return (Verdict, message) by these Laws."""
    gap, energy = found
    kept = (f"its joints stay closed to {gap.found:.2g} of their levers, where {gap.allowed:.2g} is allowed, and its "
            f"energy to {energy.found:.2g}, where {energy.allowed:.2g} is allowed")
    return laws.verdict_on(found, "joints", kept)
