"""Moving pictures in space: what player3d.js plays.

    bodies    [box(half sizes), sphere(r), cylinder(r, length), capsule(r, length), cone(r, length), mesh(vertices, triangles)]
    poses     (frames, bodies, 7): position x, y, z [m] and unit quaternion w, x, y, z of each body
    arrows    {"ω": (frames, 2, 3): where it begins and where it ends}

The player is three.js and our own player3d/source.js in one file; `npm install && npm run build` in that folder makes it again.
"""

import base64
from pathlib import Path

import numpy as np

from .plots import playable

ARROWS = ("#e69f00", "#cc79a7", "#009e73")      # as in player3d/source.js
PLAYER = Path(__file__).with_name("player3d.js")


def box(half):
    """A box of these half sizes [m] along its own axes."""
    return {"kind": "box", "size": [float(a) for a in half]}


def sphere(r):
    return {"kind": "sphere", "r": float(r)}


def cylinder(r, length):
    """Along its own z."""
    return {"kind": "cylinder", "r": float(r), "length": float(length)}


def capsule(r, length):
    """Along its own z; length between the centres of its two half spheres."""
    return {"kind": "capsule", "r": float(r), "length": float(length)}


def cone(r, length):
    """Along its own z, its tip in the origin: a top on its point."""
    return {"kind": "cone", "r": float(r), "length": float(length)}


def mesh(vertices, triangles):
    """vertices (n, 3) [m], triangles (m, 3) of their numbers."""
    return {"kind": "mesh", "vertices": np.round(np.asarray(vertices, dtype=float), 6).tolist(), "triangles": np.asarray(triangles).tolist()}


def picture(bodies, runs, seconds, arrows=None, trail=None, ground=False):
    """What the player plays: runs {label: poses}, arrows {label: {arrow: (frames, 2, 3)}}, for the runs that have them.

    trail: number of the body whose way is drawn.  ground: draw the plane z = 0.
    """
    arrows = arrows or {}
    names = list(next(iter(arrows.values()), {}))
    colours = playable({"frames": dict.fromkeys(runs, []), "seconds": seconds, "links": []})["colours"]
    packed = []
    for colour, (label, poses) in zip(colours, runs.items()):
        poses = np.asarray(poses, dtype=float).reshape(len(poses), -1)
        own = arrows.get(label)
        pointers = np.zeros((len(poses), 6 * len(names))) if own is None else np.hstack([np.asarray(own[n], dtype=float).reshape(len(poses), 6) for n in names])
        look = "truth" if label == "truth" else "engine" if label.startswith("py") else "ours"
        frames = np.hstack([poses, pointers]).astype("<f4")
        packed.append({"label": label, "look": look, "colour": colour, "frames": base64.b64encode(frames.tobytes()).decode()})
    return {"seconds": float(seconds), "ground": ground, "trail": trail, "arrows": names, "bodies": list(bodies), "runs": packed}
