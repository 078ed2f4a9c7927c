"""A house of seven cards, which stands if the cards are rough enough.

It has two tents, a roof across them, and a tent on the roof.  The cards of a tent push each other horizontally,
through a contact that leans as they do: μ ≥ tan of the lean.
"""

from functools import cache, partial
from typing import Annotated, NamedTuple

import numpy as np

from solutions.checks import BadInput, check_friction
from solutions.simulator import make_bodies_2d
from validate.check import states
from validate.engines import watched
from validate.methods import LOOP_2D
from validate.reference.simulator import least_friction
from validate.scene import PYMUNK, Scene, engine, no_limit, ours
from validate.scenes._common import built, check_positives
from validate.scenes.drawing import outlines
from validate.scenes.simulator._common import boxes_on_floor, filmed, physics_of_boxes, reported_by_loop, watched_boxes

T = 1.0                      # [s]
STEPS = (8, 20, 60, 120, 240, 480, 960)
FINE, KEPT = 6_000, 30       # steps of the reference run in T; it keeps one of this many
SWEEPS, MARGIN = 60, 0.01    # of the loop [-], [m]
ITERATIONS = 100             # of pymunk [-]
WATCHED = 120                # steps of the run that the laws of contact judge [-]
HALF_LENGTH, HALF_THICK = 0.2, 0.01             # of a card [m]
ROOF, HALF_ROOF = 4, 0.36    # number of the roof, and half of its length [m]
APART = 0.5                  # of the tents [m]
UNKNOWN = "unknown"          # an order


class Params(NamedTuple):
    rough: Annotated[float, "friction over the least with which it stands [-]"] = 0.5
    degrees: Annotated[float, "lean of the cards [°]"] = 20.0
    g: Annotated[float, "gravity [m/s²]"] = 9.81


CASES = {"too smooth": Params(), "rough enough": Params(rough=1.1), "barely": Params(rough=1.02)}


def lean(p):
    return np.radians(p.degrees)


def turned(angle):
    c, s = np.cos(angle), np.sin(angle)
    return np.array([(c, -s), (s, c)])


def tent(x, y, p):
    """Return the centres of two cards that lean against each other, the right one on (x, y).

    Their height; and x between.
    """
    foot, top = np.array([-HALF_THICK, -HALF_LENGTH]), np.array([-HALF_THICK, HALF_LENGTH])
    R = turned(lean(p))
    right = np.array([x, y]) - R @ foot                  # turned to the left, it stands on its left lower corner
    across = (R @ top + right)[0]                        # of the mirror: the corners at the top meet
    left = np.array([2.0 * across - right[0], right[1]])
    return left, right, (right + R @ np.array([HALF_THICK, HALF_LENGTH]))[1], across


def house(p):
    """Return (centres (7, 2), angles (7,)) of the cards."""
    a_left, a_right, height, a = tent(0.0, 0.0, p)
    b_left, b_right, _, b = tent(APART, 0.0, p)
    c_left, c_right, _, c = tent(0.0, height + 2.0 * HALF_THICK, p)
    roof = np.array([0.5 * (a + b), height + HALF_THICK])
    shift = np.array([roof[0] - c, 0.0])
    leans = lean(p) * np.array([-1.0, 1.0])
    return (np.stack((a_left, a_right, b_left, b_right, roof, c_left + shift, c_right + shift)),
            np.concatenate((leans, leans, [0.5 * np.pi], leans)))


def halves():
    half = np.tile((HALF_THICK, HALF_LENGTH), (7, 1))
    half[ROOF, 1] = HALF_ROOF
    return half


def masses():
    return halves()[:, 1] / HALF_LENGTH


def least(p):
    """Return the smallest friction with which it stands [-]."""
    return np.tan(lean(p))


def start(p):
    check_positives(p, "rough", "degrees", "g")
    if not 5.0 <= p.degrees <= 30.0:
        raise BadInput("degrees", p.degrees, "let the cards lean by 5° to 30°: the roof must reach from tent to tent")
    check_friction(p.rough * least(p))
    x, q = house(p)
    return make_bodies_2d(x, q, masses(), masses() * np.sum(halves()**2, axis=1) / 3.0, halves(), [(0.0, 1.0, 0.0)],
                          (0.0, -p.g), p.rough * least(p), SWEEPS, MARGIN)


def run(lessons, step, acceleration, state, p, dt, steps):
    simulator, (now, rows) = lessons.simulator, state
    shape = simulator.box_bounds_2d, simulator.box_contacts_2d
    return simulator.advance_contact(step, acceleration, *shape, 0.0, now, dt, steps, rows), rows


def corners(x, angle):
    """Return the corners (28 · 2,) [m] of all cards."""
    signs = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)])
    return np.concatenate([(place + (half * signs) @ turned(a).T).ravel()
                           for place, a, half in zip(x, angle, halves())])


def observe(state, p):
    return corners(state[0].x[:7], state[0].q[:7])


def model(p):
    return boxes_on_floor(*house(p), halves(), masses(), np.zeros((7, 2)), np.zeros(7), p.rough * least(p), p.g)


def read(state, p):
    return corners(state.x[1:], state.q[1:])


def by_pymunk(p, steps, every):
    """Return the corners at the start and after every `every` steps by pymunk."""
    return filmed(model(p), partial(read, p=p), T / steps, steps, every, iterations=ITERATIONS, overlap=0.0)


@cache
def reference(p):
    return by_pymunk(p, FINE, KEPT)


def truth(p, t):
    """A house that is rough enough stands: nothing moves.  By symmetry the cards of a tent push each other
    horizontally.  Their contact has the normal of a face, which leans by θ: μ ≥ tan θ.  The feet need less.

    A smoother house falls, and no theory says how; the picture shows pymunk with 6,000 steps per second.
    """
    if not falls(p) or t == 0.0:
        return corners(*house(p))
    film = reference(p)
    return film[min(max(round(t / T * (len(film) - 1)), 0), len(film) - 1)]


def falls(p):
    return p.rough <= 1.0


def limit(p, dt):
    """A house that stands: at first the loop does not know the forces.  60 sweeps leave ρ⁶⁰ of g dt, with ρ =
    cos²(π/14) in the worst case, seven bodies in a row.  Each further step starts warm and leaves the same fraction of
    the rest: g dt² ρ⁶⁰/(1 − ρ⁶⁰) altogether.  A corner of a card that leans by θ moves 1/sin θ as far.  If that is
    more than the margin of 1 cm in the first step, the warm start does not recognise the contact: no limit is known.

    A house that falls: no theory says how far two runs differ.  For pymunk no theory says it either, because its
    contacts must overlap first.  The laws of contact judge these curves by what their run of 120 steps reports.
    """
    left = np.cos(np.pi / 14.0) ** (2 * SWEEPS)
    first = p.g * dt**2 * left / np.sin(lean(p))
    size = np.linalg.norm(corners(*house(p)))
    stands = first / (1.0 - left) * np.sqrt(28.0) / size + 1e-9
    return stands if not falls(p) and first < MARGIN else np.inf


def physics(p):
    return physics_of_boxes(masses(), halves(), p.g, p.rough * least(p))


def reports(before, after, p, dt):
    return reported_by_loop(before[0], after[0], dt, physics(p))


UNPREDICTED = "a standing house has the error of its sweeps, and no theory predicts the motion of a falling one"
RUNNERS = (
    # a house that falls needs short steps
    ours(LOOP_2D, order=UNKNOWN, limit=limit, predicted=UNPREDICTED, slow_cases=("too smooth",), most_in_quick=60,
         laws=watched.sweeps_rules(SWEEPS), watched=WATCHED),
    engine(PYMUNK, "", built(PYMUNK, model, read, watched_boxes(physics), iterations=ITERATIONS, overlap=0.0),
           "boxes; 100 iterations, collision_slop 1e-5",
           order=UNKNOWN, limit=no_limit, predicted=UNPREDICTED, is_truth=falls,
           laws=watched.pymunk_rules(ITERATIONS, rests=False), watched=WATCHED),
)


def at_rest(p):
    """Return (a, b, n, p) of all contacts: feet of the tents on their supports, and corners under their loads."""
    x, q = house(p)
    at = corners(x, q).reshape(7, 4, 2)
    face, up = turned(lean(p)) @ np.array([-1.0, 0.0]), np.array([0.0, 1.0])
    found = []
    for left, right, below in ((0, 1, 7), (2, 3, 7), (5, 6, ROOF)):
        found += [(left, right, face, at[left, 2]), (left, below, up, at[left, 1]), (right, below, up, at[right, 0])]
    found += [(card, ROOF, -up, at[card, np.argmax(at[card, :, 1])]) for card in range(4)]
    return [np.array(values) for values in zip(*found)]


def sanity_checks():
    """Return Findings: the smallest friction by a linear program, and pymunk's house."""
    claims = []
    for degrees in (10.0, 20.0, 30.0):
        p = Params(degrees=degrees)
        found = least_friction(*at_rest(p), house(p)[0], masses() * p.g)
        claims.append(states(f"least friction by a linear program, {degrees:g}° [-]", found, least(p), 1e-6))
    for rough, moves in ((0.98, 1.0), (1.02, 0.0)):
        p = Params(rough=rough)
        end = by_pymunk(p, 1000, 1000)[-1]
        claims.append(states(f"whether a corner moves by a millimetre in pymunk, with {rough:g} of that [-]",
                             float(np.max(np.abs(end - corners(*house(p)))) > 1e-3), moves, 0.0))
    return tuple(claims)


def points(observed, p):
    """Draw the corners of all cards, and the floor."""
    return np.round(np.vstack((np.reshape(observed, (-1, 2)), ((-0.8, 0.0), (1.2, 0.0)))), 4)


def links(p):
    return [*outlines(4, 7), (28, 29)]


SCENE = Scene(
    title="A house of cards", lesson="simulator",
    film_of_truth="pymunk, 6,000 steps per second",
    cases=CASES, duration=T, steps=STEPS,
    runners=RUNNERS,
    acceleration=lambda lessons: lessons.simulator.weight, start=start, run=run, observe=observe,
    reports=reports, truth=truth, model=model, read=read, truth_uncertainty=1e-15,
    slow_cases=("barely",),
    omitted_methods="the house was not set up in pybullet",
    sanity_checks=sanity_checks,
    points=points, links=links,
    uses=("boxes in the plane", "friction that holds", "sweeps with memory"),
    ablations={"bending of the cards": "rigid cards stand or slide",
               "pushing overlapping bodies apart": "the soft contacts of lesson 9 do it"},
)
