"""Pictures of lesson 4: points and meshes with their centre of mass."""

import numpy as np

from .marks import Dots, Links, Note
from .pieces import Picture, array, in_space, part


def heavy_points(m, x):
    heavy = int(np.argmax(m))
    rest = np.delete(x, heavy, axis=0)
    others = [Dots(rest, "points")] if len(rest) else []
    return [*others, Dots(x[heavy][None], f"the heaviest one, {m[heavy]:.4g} kg")]


def centre(result, *_):
    M, X = part(result, "M", 0), part(result, "X", 1)
    return [Note(f"M = {M:.4g} kg") if X is None else Dots(array(X, 3)[None], "X")]


def mesh(x, faces):
    faces = np.asarray(faces).astype(int)
    edges = np.concatenate([x[faces[:, [i, j]]] for i, j in ((0, 1), (1, 2), (2, 0))])
    return [Links(edges, f"mesh of {len(faces)} triangles"), Dots(np.zeros((1, 3)), "origin")]


def first_over_volume(result, x, faces):
    volume, first = part(result, "volume", 0), part(result, "first", 1)
    if volume is None or first is None:
        return [Note(f"volume {volume:.4g} m³" if first is None else "the first integral: see the numbers")]
    return [Dots((array(first, 3) / float(volume))[None], f"first/volume, volume {volume:.4g} m³")]


def centre_of_body(result, density, x, faces):
    return [Note("mass or tensor: see the numbers") if result.x is None else Dots(array(result.x, 3)[None], "centre")]


PICTURES = {
    "4.1": Picture(in_space, heavy_points, centre,
                   "X lies among the points if all masses are above 0, nearer to the heavy ones."),
    "4.15": Picture(in_space, mesh, first_over_volume, "first/volume is the middle of what is inside the mesh."),
    "4.17": Picture(in_space, lambda density, *corners_and_faces: mesh(*corners_and_faces), centre_of_body,
                    "the centre is the middle of what is inside the mesh."),
}
