"""Pictures of lesson 6: distances, times of impact, boxes and polygons."""

import numpy as np

from .marks import Arrow, Disc, Dots, Hull, Level, Links, Note, View, Way
from .pieces import (
    BOTH_WAYS,
    TURN,
    Picture,
    across,
    array,
    axes_of,
    contact,
    in_world,
    part,
    plane_view,
    scaled,
    world_views,
)

ALONG_X = View("along the x axis", np.eye(3)[1:], np.zeros(3), ("y [m]", "z [m]"))
FROM_THE_SIDE = View("from the side", np.eye(3)[::2], np.zeros(3), ("x [m]", "z [m]"))


# ---------------------------------------------------------------------------------------------- points and planes

def beside_plane(_, p, plane):
    return [plane_view("along the plane", across(plane.n, 0.0 * plane.n), plane.n, p,
                       ("along the plane, from p [m]", "along n, from p [m]"))]


def point_and_plane(p, plane):
    size = abs(plane.n @ p + plane.d)
    return [Dots(p[None], "p"), Level(plane.n, -plane.d, p, "plane"), Arrow(p, 0.4 * size * plane.n, "n, from p")]


def foot_of(distance, p, plane):
    distance = float(distance)
    return [Way(np.stack((p, p - distance * plane.n)), f"from p by the distance, {distance:.4g} m, against n")]


def beside_fall(_, t, dt, x_0, x_1, r, plane):
    return [plane_view("along the plane", across(plane.n, x_1 - x_0), plane.n, x_0,
                       ("along the plane, from x_0 [m]", "along n, from x_0 [m]"))]


def flight(t, dt, x_0, x_1, r, *_):
    return [Disc(x_0, r, f"ball at x_0, t = {t:.4g} s"), Disc(x_1, r, f"ball at x_1, t + dt = {t + dt:.4g} s"),
            Way(np.stack((x_0, x_1)), "path of its centre", dots=False)]


def flight_to_plane(t, dt, x_0, x_1, r, plane):
    return [*flight(t, dt, x_0, x_1, r), Level(plane.n, -plane.d, x_1, "plane")]


def ball_at(when, t, dt, x_0, x_1, r, *_):
    """Return the ball at the time of impact."""
    when = float(when)
    if not np.isfinite(when):
        return [Note(f"t* = {'NEVER' if when == np.inf else when}")]
    s = (when - t) / dt
    return [Disc(x_0 + s * (x_1 - x_0), r, f"ball at t* = {when:.6g} s")]


# ---------------------------------------------------------------------------------------------- the cylinder along x

def ring(r, label):
    """Return a circle about the x axis."""
    return Way(r * np.stack((0.0 * TURN, np.cos(TURN), np.sin(TURN)), axis=1), label, True, dots=False)


def cylinder(R, x, half):
    """Return the part of the cylinder about the x axis that is beside x [m]."""
    rim = R * np.stack((0.0 * TURN, np.cos(TURN), np.sin(TURN)), axis=1)
    ends = [rim + np.array([x + side * half, 0.0, 0.0]) for side in BOTH_WAYS]
    return Hull(np.concatenate(ends), f"cylinder, R = {R:.4g} m")


def ball_and_cylinder(x, r, R):
    return [cylinder(R, x[0], R + r), Disc(x, r, f"ball, r = {r:.4g} m")]


def flight_to_cylinder(t, dt, x_0, x_1, r, R):
    return [ring(R, f"cylinder, R = {R:.4g} m"), *flight(t, dt, x_0, x_1, r)]


def cloth_and_cylinder(a, b, c, r, R):
    return [ring(R, f"cylinder, R = {R:.4g} m"), Way(np.stack((a, b, c)), "triangle", True)]


def reach_of_gap(gap, a, b, c, r, R):
    """Return the circle that is as far from the axis as the triangle is by this gap."""
    out = abs(R + r + float(gap))
    label = f"circle of radius R + r + gap = {out:.4g} m"
    return [Dots(np.zeros((1, 3)), label) if out < 1e-9 * R else ring(out, label)]


# ---------------------------------------------------------------------------------------------- segments, triangles

def in_plane(_, p, a, b, *__):
    labels = "along a b, from a [m]", "towards p, from a [m]"
    return [plane_view("in the plane of a, b and p", b - a, p - a, a, labels)]


def point_and_segment(p, a, b):
    return [Way(np.stack((a, b)), "segment a b"), Dots(p[None], "p")]


def nearest_point(q, p, *_):
    q = array(q, len(p))
    return [Way(np.stack((p, q)), f"from p to the nearest point, {np.linalg.norm(p - q):.4g} m")]


def beside_triangle(_, p, a, b, c):
    (e, f), n = axes_of(b - a, c - a), np.cross(b - a, c - a)
    n = n / np.linalg.norm(n) if np.linalg.norm(n) > 0.0 else across(e, f)
    labels = "along a b, from a [m]", "in its plane, from a [m]", "out of its plane [m]"
    return [View("from above", np.stack((e, f)), a, labels[:2]),
            View("from the side", np.stack((e, n)), a, labels[::2])]


def point_and_triangle(p, a, b, c):
    return [Way(np.stack((a, b, c)), "triangle a b c", True), Dots(p[None], "p")]


def corners_of(box):
    """Return the corners (8, 3) of a Box."""
    signs = np.stack(np.meshgrid(*[BOTH_WAYS] * 3), axis=-1).reshape(-1, 3)
    return box.x + signs * box.half @ box.R.T


def in_axes_of_box(_, x, r, box):
    return [View(f"along axis {k} of the box", box.R.T[[i, j]], box.x, (f"along axis {i} [m]", f"along axis {j} [m]"))
            for i, j, k in ((0, 1, 2), (0, 2, 1))]


def ball_and_box(x, r, box):
    return [Hull(corners_of(box), "box"), Disc(x, r, f"ball, r = {r:.4g} m")]


# ---------------------------------------------------------------------------------------------- boxes along the axes

def upright(low, high, label):
    """Return a box along the axes."""
    return Hull(np.stack(np.meshgrid(*zip(low, high)), axis=-1).reshape(-1, len(low)), label)


def moving_box(low, high, move):
    return [upright(low, high, "box"), upright(low + move, high + move, "box after the move"),
            Arrow(0.5 * (low + high), move, "move")]


def around(result, low, high, move):
    found = {name: array(result[k], len(low)) for k, name in enumerate(("low", "high")) if result[k] is not None}
    if len(found) == 2:
        return [upright(*found.values(), "swept box")]
    return [Dots(corner[None], f"{name} corner of the swept box") for name, corner in found.items()]


def edges_of(low, high, label):
    """Return the edges of many boxes (n, d), as one mark."""
    d = low.shape[1]
    ends = np.stack(np.meshgrid(*[[0.0, 1.0]] * d), axis=-1).reshape(-1, d)
    i, j = np.array([(i, j) for i in range(2**d) for j in range(i) if np.sum(ends[i] != ends[j]) == 1]).T
    corners = low[:, None] + ends * (high - low)[:, None]
    return Links(np.stack((corners[:, i], corners[:, j]), axis=2).reshape(-1, 2, d), label)


def links_between(pairs, a, b):
    """Return links between the middles (n, d) of touching boxes."""
    i, j = np.asarray(pairs, dtype=float).reshape(-1, 2).astype(int).T
    return [Links(np.stack((a[i], b[j]), axis=1), f"{len(i)} pairs, joined at the middles of their boxes")
            if len(i) else Note("no pair")]


def linked_boxes(pairs, low, high):
    return links_between(pairs, 0.5 * (low + high), 0.5 * (low + high))


def both_trees(a, b):
    return [edges_of(tree.item_low, tree.item_high, f"{len(tree.item_low)} boxes of {name}")
            for tree, name in ((a, "a"), (b, "b"))]


def linked_trees(pairs, a, b):
    return links_between(pairs, middles(a), middles(b))


def middles(tree):
    """Return the middle of the box of each item, by the item's number."""
    found = np.empty_like(tree.item_low)
    found[tree.order.astype(int)] = 0.5 * (tree.item_low + tree.item_high)
    return found


# ---------------------------------------------------------------------------------------------- polygons, axes, hulls

def both_hulls(a, b):
    return [Hull(a, "a"), Hull(b, "b")]


def best_edge(result, a, b):
    """Return the chosen edge, and the line along it at the distance of the gap."""
    gap, i = result
    i = None if i is None else int(i) % len(a)
    found = [Note(f"gap {gap:.4g} m")] if i is None else [Way(np.stack((a[i], a[(i + 1) % len(a)])), f"edge {i}")]
    if i is None or gap is None:
        return found
    n = (a[(i + 1) % len(a)] - a[i]) @ np.array([(0.0, -1.0), (1.0, 0.0)])
    n = n / np.linalg.norm(n)
    return [*found, Level(n, float(n @ a[i] + gap), a[i], f"line at the gap, {gap:.4g} m, from it")]


def over_polygon(_, y, n, d):
    """Return the plane of a polygon, seen at right angles."""
    longest = (y - y[0])[np.argmax(np.linalg.norm(y - y[0], axis=1))] if len(y) else 0.0 * n
    normal = np.linalg.svd(y - y[0])[2][-1] if len(y) > 2 else 0.0 * n
    return [plane_view("at right angles to the polygon", n - n @ normal * normal, longest, y[0] if len(y) else 0.0 * n,
                       ("across the cut, from y_0 [m]", "along the cut, from y_0 [m]"))]


def polygon_and_cut(y, n, d):
    size = max(np.ptp(y, axis=0).max(), 1e-300) if len(y) else 1.0
    middle = y.mean(axis=0) if len(y) else 0.0 * n
    cut = middle + (d - n @ middle) * n
    return [Way(y, "y", True), Level(n, d, middle, "cut, n · p = d"),
            Arrow(cut, 0.2 * size * n, "n: what lies ahead is cut off")]


def rest_of_polygon(y, *_):
    y = np.asarray(y, dtype=float)
    return [Way(y, f"what is left, {len(y)} corners", True) if y.ndim == 2 and len(y) else Note("nothing is left")]


def across_axes(results, a, b):
    """Return views in which a gap along the axes of the results is seen in full."""
    found = []
    for result, whose in zip(results, ("your", "the expected")):
        n = part(result, "n", 1)
        if n is not None and np.shape(n) == (3,) and np.linalg.norm(n) > 0.0:
            found.append(View(f"across {whose} n", axes_of(n, a.x - b.x), b.x,
                              ("along n, from the middle of b [m]", "across n [m]")))
    return found or world_views(3)


def axis_and_gap(result, a, b):
    """Return the axis, and where a begins if the gap is right."""
    gap, n, k = (result[i] for i in range(3))
    found = [Note(", ".join([f"axis number {k:g}"] * (k is not None) + [f"gap {gap:.4g} m"] * (gap is not None)))]
    found = found if k is not None or gap is not None else []
    if n is None:
        return found
    found.append(Arrow(b.x, 0.7 * np.linalg.norm(a.x - b.x) * array(n, 3), "n, from the middle of b"))
    return found if gap is None else [
        *found, Level(np.asarray(n), float((corners_of(b) @ n).max() + gap), a.x, "plane at the gap from b")]


def both_boxes(a, b):
    return [Hull(corners_of(a), "a"), Hull(corners_of(b), "b")]


# ---------------------------------------------------------------------------------------------- avoidance

def near_obstacle(_, x, centre, radius, *__):
    return [plane_view("in a plane through x and the centre", x - centre, 0.0 * x, centre,
                       ("towards x, from the centre [m]", "across, from the centre [m]"))]


def obstacle(x, centre, radius, reach, k):
    return [Disc(centre, radius, "obstacle"),
            Disc(centre, radius + reach, f"where its field ends, reach {reach:.4g} m"), Dots(x[None], "x")]


def push_away(a, x, centre, radius, *_):
    a = array(a, len(x))
    return [Arrow(x, scaled(a, radius), f"acceleration, {np.linalg.norm(a):.4g} m/s²")]


def passing(x, v, centre):
    """Return the time until x passes the centre [s]; 1 s at rest."""
    return (centre - x) @ v / (v @ v) if v @ v > 0.0 else 1.0


def walk(x, v, centre, radius, ahead):
    straight = np.stack((x, x + passing(x, v, centre) * v))
    return [Disc(centre, radius, "disc in the way"), Way(straight, "path without steering"),
            Arrow(x, scaled(v, 0.6 * radius), f"v, {np.linalg.norm(v):.4g} m/s")]


def steered(a, x, v, centre, radius, ahead):
    """Return the path with a constant acceleration until it passes the centre."""
    a, t = array(a, 2), np.linspace(0.0, passing(x, v, centre), 40)[:, None]
    return [Way(x + t * v + 0.5 * t**2 * a, f"path with the acceleration, {np.linalg.norm(a):.4g} m/s²", dots=False),
            Arrow(x, scaled(a, 0.6 * radius), "direction of the acceleration")]


TOUCHES = "at the right t* the ball just touches; NEVER is right if it does not arrive in this step."
CONTACT = "p_a is on a and p_b is on b, the gap is between them, and n points from b to a."
PICTURES = {
    "6.1": Picture(beside_plane, point_and_plane, foot_of,
                   "with the right signed distance the line from p ends on the plane."),
    "6.2": Picture(beside_fall, flight_to_plane, ball_at, TOUCHES),
    "6.3": Picture(lambda *_: [ALONG_X, FROM_THE_SIDE], ball_and_cylinder, contact, CONTACT),
    "6.4": Picture(lambda *_: [ALONG_X], flight_to_cylinder, ball_at, TOUCHES),
    "6.5": Picture(in_plane, point_and_segment, nearest_point,
                   "the nearest point is on the segment, and no other is nearer to p."),
    "6.6": Picture(lambda *_: [ALONG_X], cloth_and_cylinder, reach_of_gap,
                   "the right circle just touches the triangle; it is a point if the axis passes through the face."),
    "6.7": Picture(beside_triangle, point_and_triangle, nearest_point,
                   "the nearest point is in the triangle, and no other is nearer to p."),
    "6.8": Picture(in_axes_of_box, ball_and_box, contact, CONTACT),
    "6.9": Picture(in_world, moving_box, around, "the swept box just contains the box before and after the move."),
    "6.10": Picture(in_world, lambda low, high: [edges_of(low, high, f"{len(low)} boxes")], linked_boxes,
                    "each pair of boxes with a common point is joined, once."),
    "6.11": Picture(lambda _, a, b: world_views(a.low.shape[1]), both_trees, linked_trees,
                    "each box of a is joined with all boxes of b that it touches."),
    "6.12": Picture(in_world, both_hulls, best_edge,
                    "the line at the gap touches b, which lies beyond it, and no other edge has a greater gap."),
    "6.13": Picture(over_polygon, polygon_and_cut, rest_of_polygon,
                    "what is left is all of y behind the cut, with new corners on the cut."),
    "6.14": Picture(across_axes, both_boxes, axis_and_gap,
                    "the plane at the gap touches a, and no axis has a greater gap."),
    "6.15": Picture(in_world, both_hulls, contact, CONTACT),
    "6.16": Picture(near_obstacle, obstacle, push_away,
                    "the acceleration points away from the centre, and is 0 beyond the reach."),
    "6.17": Picture(in_world, walk, steered,
                    "if it has to steer, the path ends beside the centre, exactly on the rim of the disc, and cuts "
                    "into the disc just before."),
}
