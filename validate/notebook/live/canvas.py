"""What a live scene looks like, as data: the outlines of its bodies, the view, its colours, and its past as a film."""

import re
from base64 import b64encode

import numpy as np

from solutions.support.model import WORLD, Hinge, can_move, own_place, picture_of, start_of
from solutions.support.shapes import Ball, HalfSpace, outline_of

from ... import methods
from ...products import PYMUNK
from ...report import HERE as REPORT
from ..saving import KEEP_KEYS

FILM_NUMBERS = 2_000_000     # of a film as a file, at most
COLOURS = {"ours": methods.LOOP_2D.colour, "engine": PYMUNK.colour, "hand": "#0072B2", "force": "#009E73"}
DARK = dict(re.findall(r"--c-(\w{6}): (#\w{6})", (REPORT / "dark.css").read_text(encoding="utf-8")))


def drawn(simulation, name, height, view):
    """Return all that the canvas has to know and that does not change."""
    model, tuning = simulation.model, simulation.tuning
    moving = [body for body in model.bodies if can_move(body)]
    same = lambda values: values.pop() if len(values) == 1 else None
    return {"name": name, "height": height, "view": list(map(float, view or view_of(model))), "keep": KEEP_KEYS,
            "bodies": [body_drawn(model, k) for k in range(len(model.bodies))],
            "planes": [plane_drawn(body) for body in model.bodies if isinstance(body.shape, HalfSpace)],
            "pins": [(joint.a, *own_place(model, joint.a, joint.place).tolist()) for joint in model.joints
                     if isinstance(joint, Hinge)],
            "springs": [(spring.a, *spring.place_a, spring.b, *spring.place_b) for spring in model.springs],
            "weight": float(np.mean([body.m for body in moving]) * 9.81) if moving else 1.0,
            "beside": "pymunk" if simulation.beside else "", "colours": COLOURS,
            "dark": {f"#{colour}": dark for colour, dark in DARK.items()},
            "knobs": {"g": float(np.hypot(*model.gravity)), "mu": same({body.mu for body in moving}),
                      "e": same({body.e for body in moving}), "dt": tuning.dt, "sweeps": tuning.sweeps}}


def body_drawn(model, k):
    """Return the outline of a body in its own coordinates."""
    body = model.bodies[k]
    if isinstance(body.shape, HalfSpace):
        return {"points": [], "closed": False, "fixed": True, "round": 0.0}
    if body.shape is None:
        places = [own_place(model, k, joint.place).tolist() for joint in model.joints
                  if k in (joint.a, joint.b) and hasattr(joint, "place")] or [[0.0, 0.0]]
        closed = False
    else:
        places, closed = np.round(outline_of(body.shape, 32)[:-1], 6).tolist(), True
    radius = body.shape.radius if isinstance(body.shape, Ball) else 0.0
    return {"points": places, "closed": closed, "fixed": not can_move(body), "round": radius}


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
