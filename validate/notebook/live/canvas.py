"""What a live scene looks like, as data: the outlines of its bodies, the view, its colours, and its past as a film."""

import re
from base64 import b64encode

import numpy as np

from solutions.support.model import WORLD, Hinge, can_move, own_place, picture_of, start_of
from solutions.support.shapes import Ball, HalfSpace, outline_of

from ... import methods
from ...engines.products import PYMUNK
from ...report import HERE as REPORT
from ..saving import KEEP_KEYS

FILM_NUMBERS = 2_000_000     # of a film as a file, at most
COLOURS = {"ours": methods.LOOP_2D.colour, "engine": PYMUNK.colour, "hand": "#0072B2", "force": "#009E73"}
DARK = dict(re.findall(r"--c-(\w{6}): (#\w{6})", (REPORT / "dark.css").read_text(encoding="utf-8")))


def drawn(simulation, name, height, view):
    """Return all that the canvas has to know and that does not change."""
    found = simulation.drawn()
    return {"name": name, "height": height, "keep": KEEP_KEYS, "colours": COLOURS,
            "dark": {f"#{colour}": dark for colour, dark in DARK.items()}, **NOTHING, **found,
            "view": list(map(float, view or found["view"]))}


NOTHING = {"planes": [], "pins": [], "springs": [], "links": [], "weight": 1.0, "beside": "", "engine": False,
           "contacts": False, "anywhere": -1, "trail": -1, "rival": "pymunk"}
ENERGY = {"energy": "energy", "unit": "J", "overlap": "overlap",
          "expected": "at the start, plus work of hand and belts:"}


def model_drawn(model, tuning, beside):
    """Return what the canvas has to know of a Model."""
    moving = [body for body in model.bodies if can_move(body)]
    same = lambda values: values.pop() if len(values) == 1 else None
    return {"view": view_of(model), "bodies": [body_drawn(model, k) for k in range(len(model.bodies))],
            "planes": [plane_drawn(body) for body in model.bodies if isinstance(body.shape, HalfSpace)],
            "pins": [(joint.a, *own_place(model, joint.a, joint.place).tolist()) for joint in model.joints
                     if isinstance(joint, Hinge)],
            "springs": [(spring.a, *spring.place_a, spring.b, *spring.place_b) for spring in model.springs],
            "weight": float(np.mean([body.m for body in moving]) * 9.81) if moving else 1.0,
            "beside": "pymunk" if beside else "", "engine": bool(PYMUNK.installed()), "contacts": True, "says": ENERGY,
            "knobs": [knob("g", "g", 0, 30, 0.1, float(np.hypot(*model.gravity)), "m/s²"),
                      knob("friction μ", "mu", 0, 1.5, 0.01, same({body.mu for body in moving})),
                      knob("restitution e", "e", 0, 1, 0.01, same({body.e for body in moving})),
                      of_dt(tuning.dt), knob("sweeps", "sweeps", 1, 50, 1, tuning.sweeps)]}


def knob(name, key, low, high, step, value, unit=""):
    """Return a slider; value None: the bodies have several."""
    return {"name": name, "key": key, "low": low, "high": high, "step": step, "value": value, "unit": unit}


def of_dt(dt, high=480):
    """Return the slider of the time step, which shows 1/dt."""
    return {**knob("dt", "dt", 30, high, 10, round(1.0 / dt)), "inverse": True}


def point(fixed, moves):
    """Return a point as the canvas draws it."""
    return {"points": [[0.0, 0.0]], "closed": False, "fixed": bool(fixed), "round": 0.0, "moves": bool(moves)}


def network_drawn(x, network, free, tuning, lesson):
    """Return what the canvas has to know of a net or a rope, whose points can all be taken."""
    low, high = x.min(axis=0), x.max(axis=0)
    middle, half = 0.5 * (low + high), 0.75 * max(*(high - low), 1e-3)
    own = (knob("stiffness ×", "k", 0.1, 10, 0.1, tuning.k) if lesson == "springs" else
           knob("sweeps", "sweeps", 1, 50, 1, tuning.sweeps))
    return {"view": [middle[0] - 1.4 * half, middle[0] + 1.4 * half, low[1] - half, high[1] + 0.3 * half],
            "bodies": [point(not one, True) for one in free],
            "anywhere": int(np.argmin(free)) if np.sum(~free) == 1 else -1,     # it hangs from the pointer
            "links": list(zip(network.i.tolist(), network.j.tolist(), strict=True)),
            "says": ENERGY | {"overlap": "longest error of a link", "expected": "at the start, plus work of the hand:"},
            "knobs": [knob("g", "g", 0, 30, 0.1, tuning.g, "m/s²"), of_dt(tuning.dt, 960), own]}


def arm_drawn(n, reach, tuning):
    """Return what the canvas has to know of an arm with n links; its last point is the target."""
    return {"view": [-1.6 * reach, 1.6 * reach, -1.15 * reach, 1.15 * reach], "anywhere": n + 1,
            "bodies": [point(k == 0, False) for k in range(n + 1)] + [point(False, True)],
            "links": [(k, k + 1) for k in range(n)],
            "says": {"energy": "distance to the target", "unit": "m", "overlap": "",
                     "expected": "the smallest that an arm of this length allows:"},
            "knobs": [knob("damping λ", "damping", 0.01, 3, 0.01, tuning.damping, "m"),
                      knob("gain α", "gain", 0.01, 1, 0.01, tuning.gain, "1/m²"),
                      knob("iterations", "iterations", 1, 20, 1, tuning.iterations)]}


def body_drawn(model, k):
    """Return the outline of a body in its own coordinates."""
    body = model.bodies[k]
    if isinstance(body.shape, HalfSpace):
        return {"points": [], "closed": False, "fixed": True, "round": 0.0, "moves": False}
    if body.shape is None:
        places = [own_place(model, k, joint.place).tolist() for joint in model.joints
                  if k in (joint.a, joint.b) and hasattr(joint, "place")] or [[0.0, 0.0]]
        closed = False
    else:
        places, closed = np.round(outline_of(body.shape, 32)[:-1], 6).tolist(), True
    radius = body.shape.radius if isinstance(body.shape, Ball) else 0.0
    return {"points": places, "closed": closed, "fixed": not can_move(body), "round": radius, "moves": can_move(body)}


def plane_drawn(body):
    """Return (n_x, n_y, d): the points with n · p = d [m]."""
    return [*map(float, body.shape.normal), -float(body.shape.offset)]


def view_of(model):
    """Return (left, right, low, high) [m]: all bodies at the start, with room above them, and floors and walls."""
    shaped = model._replace(bodies=tuple(body for body in model.bodies if not isinstance(body.shape, HalfSpace)),
                            joints=(), springs=())
    points = picture_of(shaped, start_of(shaped))[0] if shaped.bodies else np.zeros((1, 2))
    points = np.concatenate((points, reach_of_joints(model)))
    low, high = points.min(axis=0), points.max(axis=0)
    for body in model.bodies:
        if isinstance(body.shape, HalfSpace):
            for axis, part in enumerate(body.shape.normal):
                if abs(part) > 0.999:
                    place = -part * body.shape.offset
                    low[axis], high[axis] = min(low[axis], place), max(high[axis], place)
    wide, tall = np.maximum(high - low, 0.3 * np.max(high - low) + 1e-3)
    middle = 0.5 * (low + high)
    return middle[0] - 0.56 * wide, middle[0] + 0.56 * wide, low[1] - 0.08 * tall, low[1] + 1.3 * tall


def reach_of_joints(model):
    """Return points (k, 2) around each hinge in the world, as far away as the body that it holds reaches."""
    found = [np.zeros((0, 2))]
    for joint in model.joints:
        if joint.b == WORLD and isinstance(joint, Hinge):
            far = 2.0 * np.hypot(*own_place(model, joint.a, joint.place))
            found.append(np.array(joint.place) + far * np.array([(1, 0), (-1, 0), (0, 1), (0, -1)]))
    return np.concatenate(found)


def film_of(simulation):
    """Return the past of a simulation as a film; None if there is nothing to see."""
    if len(simulation.past) < 2:
        return None
    seconds, links, films = simulation.pictures()
    looks = {"mine": ("ours", methods.LOOP_2D), "pymunk": ("engine", PYMUNK)}
    numbers = sum(points.size for frames in films.values() for points in frames)
    every = -(-numbers // FILM_NUMBERS)
    runs = []
    for label, frames in films.items():
        packed = np.array(frames[::every], "<f4")
        role, look = looks[label]
        runs.append({"label": label, "role": role, "colour": look.colour, "marker": look.marker,
                     "points": packed.shape[1], "frames": b64encode(packed.tobytes()).decode()})
    return {"seconds": seconds, "links": [list(map(int, pair)) for pair in links], "films": runs}
