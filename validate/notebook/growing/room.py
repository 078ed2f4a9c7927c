"""The room of the scene that grows: its bodies as a Model in the plane, and what a Model lacks.

x points to the right and y up, the floor is y = 0, and lengths are in metres.  The curtain, the arm that draws it and
the top move in space or have no body in the plane, so their numbers stand below the Model.
"""

import numpy as np

from solutions.support.chains import make_arm_2d
from solutions.support.model import WORLD, Body, Hinge, make_model
from solutions.support.shapes import Ball, Box, HalfSpace

SECONDS, RATE = 3.0, 30                          # of a film [s]; pictures per second
PICTURES = round(SECONDS * RATE) + 1
FRAME = 1.0 / RATE                               # between two pictures [s]
G = 9.81                                         # [m/s²]
SIDES = (-1.75, 2.95, -0.1, 2.45)                # left, right, low and high end of every picture [m]

# ---------------------------------------------------------------------------------------------- bodies

SILL_TOP, SILL_END = 0.73, 1.3                   # height of the sill, and its right end [m]
NAIL = (1.85, 1.7)                               # from which the picture hangs [m]
HANGS = 0.18                                     # from the nail to the centre of the picture [m]
TILT = 0.45                                      # of the picture at the start [rad]
STACK = 5                                        # boxes that stand on each other
RUBS, BOUNCES = 0.5, 0.8                         # friction and restitution of the bodies that have them [-]
# bodies of the Model, by their place in it
FLOOR, SILL, RAIL, BALL, BOX, PARCEL, PICTURE, PILE = range(8)          # PILE is the lowest box of the stack


def room():
    """Return the Model of the room."""
    half = (0.25, HANGS)
    hung = (NAIL[0] + HANGS * np.sin(TILT), NAIL[1] - HANGS * np.cos(TILT))
    moment = (half[0] ** 2 + half[1] ** 2) / 3.0
    stack = [Body(x=(2.45, 0.08 + 0.16 * k), m=1.0, shape=Box((0.1, 0.08)), mu=RUBS) for k in range(STACK)]
    return make_model((
        Body(x=(0.0, 0.0), shape=HalfSpace((0.0, 1.0), 0.0), mu=1.0, e=1.0),
        Body(x=(0.6, SILL_TOP - 0.03), shape=Box((SILL_END - 0.6, 0.03)), mu=1.0, e=1.0),
        Body(x=(-0.75, 1.15), shape=Ball(0.015), mu=1.0, e=1.0),
        Body(x=(-0.757, 0.338), m=0.2, shape=Ball(0.05), v=(0.0, 6.2), mu=RUBS, e=BOUNCES),
        Body(x=(0.1, SILL_TOP + 0.07), m=1.0, shape=Box((0.09, 0.07)), v=(2.0, 0.0), mu=RUBS),
        Body(x=(1.6, 0.4), m=1.0, shape=Box((0.09, 0.06)), v=(2.2, 2.5), omega=-6.0, mu=RUBS),
        Body(x=hung, m=1.0, q=TILT, inertia=moment),               # no shape: it hangs flat on the wall
        *stack), (0.0, -G), joints=(Hinge(PICTURE, WORLD, NAIL),))


ROOM = room()

# ---------------------------------------------------------------------------------------------- the curtain

ROWS, COLS, CELL = 7, 9, 0.13                    # points down and across, and the distance between neighbours [m]
RINGS = tuple(range(0, COLS, 4))                 # points of the top row by which it hangs
CORNER = np.array([0.1, 1.72, 0.0])              # its upper left corner, on the pole [m]
SPREAD = 0.8                                     # distance of its rings over that of a flat curtain [-]
POINT, K, DAMPING = 0.01, 60.0, 0.02             # a point [kg], a thread [N/m], its damper [N s/m]
AIR, WIND = 0.02, np.array([0.03, 0.0, 0.0])   # drag of the air on a point [N s/m], the wind on it [N]


def beside(steps):
    """Return the pairs (s, 2) of points that are these steps (rows, columns) apart."""
    nodes = np.arange(ROWS * COLS).reshape(ROWS, COLS)
    found = []
    for down, right in steps:
        left = max(0, -right)
        a = nodes[:ROWS - down, left:COLS - max(0, right)]
        found.append(np.stack((a, nodes[down:, left + right:COLS + min(0, right)]), axis=-1).reshape(-1, 2))
    return np.concatenate(found)


SEEN_THREADS = beside(((0, 1), (1, 0)))
THREADS = np.concatenate((SEEN_THREADS, beside(((1, 1), (1, -1)))))


def hung(spread):
    """Return positions (n, 3) of all points, z towards the viewer, of a curtain whose rings are `spread` as far apart.

    It stands in folds, one between two rings, and no thread changes its length.
    """
    across, down = np.tile(np.arange(COLS), ROWS), np.repeat(np.arange(ROWS), COLS)
    depth = np.sqrt(1.0 - spread**2) * np.sin(0.5 * np.pi * across)
    return CORNER + CELL * np.stack((spread * across, -down, depth), axis=1)


LONG = np.linalg.norm(hung(SPREAD)[THREADS[:, 1]] - hung(SPREAD)[THREADS[:, 0]], axis=1)      # threads [m]
FREE = np.ones(ROWS * COLS)
FREE[list(RINGS)] = 0.0                          # 0 at a ring

CUSHION = 0.17                                   # radius of a ball that comes through the curtain [m]


def cushion(t):
    """Return the centre (3,) of that ball [m]: it swings towards the viewer and back."""
    return CORNER + np.array([0.42, -0.5, 0.3 * np.sin(2.0 * np.pi * (t - 0.4) / 2.4) - 0.05])


# ---------------------------------------------------------------------------------------------- arm and top

BASE, LINKS = np.array([1.2, SILL_TOP]), np.array([0.75, 0.6, 0.45])       # of the arm [m]
REST = np.array([0.6, 1.3, 1.4])                 # its angles at the start [rad]
WRIST = 1.25                                     # lower limit of its last angle [rad]
ARM = make_arm_2d(LINKS, 0.5, 0.15, (-np.inf, -np.inf, WRIST), np.inf, 0.0, 0.0)
GRIP, DRAWN = 0.8, 2.4                           # when its hand holds the last ring, and when it stops [s]
OPEN = 0.3                                       # spread of the rings then [-]


def easy(s):
    """Return s from 0 to 1 without a jerk at its ends."""
    s = np.clip(s, 0.0, 1.0)
    return s * s * (3.0 - 2.0 * s)


def wish(t):
    """Return where the hand should be (2,): from its rest to the last ring, and with it along the pole."""
    width = (COLS - 1) * CELL
    along = np.array([width, 0.0])
    ring, end = CORNER[:2] + SPREAD * along, CORNER[:2] + OPEN * along
    rest = joints(REST)[-1]
    return rest + (ring - rest) * easy(t / GRIP) + (end - ring) * easy((t - GRIP) / (DRAWN - GRIP))


def joints(theta):
    """Return the joints and the hand of the arm (4, 2), by complex numbers."""
    z = np.append(0.0, np.cumsum(LINKS * np.exp(1j * np.cumsum(theta))))
    return BASE + np.stack((z.real, z.imag), axis=1)


FOOT, TOP_LENGTH, TOP_RADIUS = np.array([1.3, 0.0]), 0.3, 0.14             # of the top [m]
LEAN, SPIN = 0.4, 60.0                           # of its axis from the vertical [rad]; about its axis [rad/s]
TOP_I = np.array([0.02, 0.02, 0.009])            # moments about its foot [kg m²]
TOP_MGL = 1.0                                    # weight times the distance of its centre from the foot [N m]

SLOPE = np.radians(20.0)                         # of the lid of a chest below the sill
LID = np.array([[0.1, 0.32], [0.1 + 0.32 / np.tan(SLOPE), 0.0]])            # its upper and its lower end [m]
BOOK = np.array([0.07, 0.03])                    # half sizes of the book on it [m]
