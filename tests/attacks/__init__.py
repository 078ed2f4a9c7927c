"""What hostile students hand in.

Every attack is a text.  It is appended to a file whose rest is as honest as `HONEST` says.  The small tests of
`trial_*.py` grade the file: they draw their inputs, call back, and give 2 points for the honest answer and 14 for those
that are wrong.

gain: what it hopes for.    lost: the file loses its honest points, too, because it does not even load.
shows: words that no reader may see.
"""

import textwrap
from typing import NamedTuple

HONEST = '''
import numpy as np


def observed_order(dts, errors):
    return np.polyfit(np.log(dts), np.log(errors), 1)[0]


def euler_step(acceleration, t, x, v, dt, p):                      # does not move
    return x.copy(), v.copy()


def midpoint_step(acceleration, t, x, v, dt, p):
    return x.copy(), v.copy()


def implicit_euler_step(acceleration, t, x, v, dt, p):
    return x.copy(), v.copy()


def amplification_matrix(step, omega, zeta, dt):
    return np.eye(2)
'''
SOLVED = HONEST + '''

def euler_step(acceleration, t, x, v, dt, p):
    return x + dt * v, v + dt * acceleration(t, x, v, p)


def midpoint_step(acceleration, t, x, v, dt, p):
    a = acceleration(t, x, v, p)
    return x + dt * (v + 0.5 * dt * a), v + dt * acceleration(t + 0.5 * dt, x + 0.5 * dt * v, v + 0.5 * dt * a, p)


def implicit_euler_step(acceleration, t, x, v, dt, p):             # by iteration: the trial is mild
    w = v
    for _ in range(200):
        w = v + dt * acceleration(t + dt, x + dt * w, w, p)
    return x + dt * w, w


def amplification_matrix(step, omega, zeta, dt):
    def pull(t, x, v, p):
        return -omega**2 * x - 2.0 * zeta * omega * v
    columns = [np.ravel(step(pull, 0.0, np.array([x]), np.array([v]), dt, None)) for x, v in ((1.0, 0.0), (0.0, 1.0))]
    return np.stack(columns, axis=1)
'''


class Attack(NamedTuple):
    name: str
    gain: str            # what it hopes for
    text: str
    lost: bool           # the file does not load
    shows: tuple         # words that no reader may see


ATTACKS, LOOKS = [], []


def attack(name, gain, text, lost=False, shows=()):
    ATTACKS.append(Attack(name, gain, text, lost, shows))


def attacks(gain, bodies, before="", shows=()):
    """Three at a time in one file, each as the body of a step of its own: {name: body}."""
    functions = "euler_step", "midpoint_step", "implicit_euler_step"
    for three in [list(bodies.items())[n:n + 3] for n in range(0, len(bodies), 3)]:
        steps = [f"def {step}(acceleration, t, x, v, dt, p):\n{textwrap.indent(body.strip(), '    ')}\n"
                 for step, (_, body) in zip(functions, three, strict=False)]
        attack(" · ".join(name for name, _ in three), gain, "\n\n".join([before, *steps]), shows=shows)


def looks(name, text):
    """An attack that looks around when it is imported, and prints FOUND when there is something.

    All of them are in one file.
    """
    LOOKS.append((name, text))


from . import (  # noqa: E402, F401      each adds its own
    exfiltration,
    introspection,
    process_exit,
    protocol_abuse,
    resource_exhaustion,
    result_tampering,
    system_calls,
)

attack(
    "looks around: " + " · ".join(name for name, _ in LOOKS),
    "the answers, the seed, a way out",
    "\n".join(text for _, text in LOOKS),
    shows=("FOUND",),
)
