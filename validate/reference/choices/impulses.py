"""Choices of lesson 7."""

import numpy as np

from . import Choice

INVERSE = np.array([[0.625, 0.375], [0.375, 0.625]])         # K⁻¹ [kg] of a rod of 2 m and 1 kg that leans at 45°
SLIPS = 0.6, 0.3, -0.6                                       # of a tip that sticks; the speed of approach is 1 [m/s]


def energies_of_a_rod():
    """Return the energy at stake after an impact over that before it, against e.

    Before: ½ u · K⁻¹u.  A tip that sticks leaves ½ e² n · K⁻¹n; one without friction loses ½ (1 − e²)/k_n,
    and has the third slip.
    """
    e = np.linspace(0.0, 1.0, 101)
    before = [u @ INVERSE @ u for u in (np.array([slip, -1.0]) for slip in SLIPS)]
    smooth = 1.0 - (1.0 - e * e) * 0.4 / before[2]
    return Choice(e, (*(INVERSE[1, 1] * e * e / one for one in before), smooth), "four impacts of a leaning rod",
                  "restitution e [-]", "energy / energy before [-]")
