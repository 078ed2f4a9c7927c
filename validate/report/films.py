"""Moving pictures as files of their own, and the still ones of the front page."""

import base64
import json

import numpy as np

from ..check import Role

WIDTH, HEIGHT, MARGIN = 132.0, 84.0, 7.0         # of a still picture [px]
STILL = 0.62                 # the moment of the film that a still picture shows, as a share of its frames
FEW = 3                      # runs with at most this many points leave a trail


def script(result):
    """Return the text of a file with the film of a scene; a page loads it when the film is played."""
    picture = result["picture"]
    films = [{"label": f["label"], "role": f["role"], "colour": f["colour"], "points": len(f["frames"][0]),
              "frames": packed(f["frames"])} for f in picture["films"]]
    film = {"title": result["title"], "seconds": picture["seconds"], "links": picture["links"],
            "look": picture.get("look", "rod"), "films": films, "space": picture["space"]}
    data = json.dumps(film, ensure_ascii=False, separators=(",", ":"))
    return f'(self.films ??= {{}})["{result["scene"]}"] = {data};\n'


def packed(frames):
    """Return frames of points (x, y) as base64 of float32: a difference of two runs may be magnified."""
    return base64.b64encode(np.asarray(frames, dtype="<f4").tobytes()).decode()


def still(picture):
    """Return what a thumbnail draws: [{role, colour, trails, lines, dots}], as paths of an SVG of WIDTH by HEIGHT."""
    runs = [(f, np.asarray(f["frames"], dtype=float)) for f in picture["films"]]
    at = placed(np.concatenate([points.reshape(-1, 2) for _, points in runs]))
    drawn = []
    for film, points in runs:
        k = round(STILL * (len(points) - 1))
        moving = np.ptp(points, axis=0).max(axis=1) > 0.0
        trails = [points[:k + 1, i] for i in np.flatnonzero(moving)] if len(points[0]) <= FEW else []
        now = at(points[k])
        drawn.append({
            "role": Role(film["role"]).value, "colour": film["colour"],
            "trails": " ".join(path(at(trail)) for trail in trails if len(trail) > 1),
            "lines": " ".join(path(now[list(pair)]) for pair in picture["links"]),
            "dots": now if len(now) <= 30 and len(points) > 1 else [],
        })
    return drawn


def placed(points):
    """Return the function from drawing coordinates [m] to those of the thumbnail; both axes have one scale."""
    low, high = points.min(axis=0), points.max(axis=0)
    size = np.maximum(high - low, 0.05 * max(np.max(high - low), 1e-9))
    scale = min((WIDTH - 2 * MARGIN) / size[0], (HEIGHT - 2 * MARGIN) / size[1])
    middle = 0.5 * (low + high)
    return lambda x: (np.asarray(x) - middle) * (scale, -scale) + (0.5 * WIDTH, 0.5 * HEIGHT)


def path(points):
    """Return a broken line in the language of SVG."""
    return "M" + " ".join(f"{x:.1f} {y:.1f}" for x, y in points)
