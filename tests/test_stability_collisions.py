"""Wrong functions of lesson 6 do not have the properties that theory gives."""

import types

import numpy as np
import pytest

from solutions import collisions as worked
from validate import stability


def always_up(x, r, box):
    """The contact normal always points up, however deep the ball is."""
    contact = worked.ball_box(x, r, box)
    return contact._replace(n=np.array([0.0, 0.0, 1.0])) if contact.gap < 0.0 else contact


def only_outside(x, r, box):
    """No case for a centre inside the box."""
    return worked.ball_contact(x, r, box.x + box.R @ np.clip(box.R.T @ (x - box.x), -box.half, box.half), 0.0)


def detects_at_the_end(t, dt, x_0, x_1, r, plane):
    """The end of the step instead of the time of impact."""
    return t + dt if worked.plane_distance(x_1, plane) < r else np.inf


def by_the_textbook_root(t, dt, x_0, x_1, r, R):
    y, w = x_0[1:], x_1[1:] - x_0[1:]
    A, B, C = w @ w, y @ w, y @ y - (R + r) ** 2
    return t + dt * (-B - np.sqrt(max(0.0, B * B - A * C))) / A


def through_the_origin(a, b):
    """Distances computed from squares about the origin, with their round-off."""
    i, j = np.unravel_index(np.argmin(np.sum(a**2, axis=1)[:, None] + np.sum(b**2, axis=1) - 2.0 * a @ b.T),
                            (len(a), len(b)))
    return worked.ball_contact(a[i], 0.0, b[j], 0.0)


def single_precision(a, b):
    return worked.gjk(a.astype(np.float32).astype(float), b.astype(np.float32).astype(float))


def gentle(t, x, v, p):
    """Half of the acceleration."""
    return 0.5 * worked.flock_acceleration(t, x, v, p)


def accepts_everything(*_):
    return np.zeros(3)


def faces_only(a, b):
    """Six axes of fifteen."""
    found = []
    for k in range(6):
        n = worked.candidate_axis(a, b, k)
        gap = abs((a.x - b.x) @ n) - worked.half_width(a, n) - worked.half_width(b, n)
        found.append((gap, n, k))
    gap, n, k = max(found, key=lambda one: one[0])
    return gap, n if n @ (a.x - b.x) >= 0.0 else -n, k


def not_clipped(a, b):
    """All corners of a as contact points."""
    gap, n, _ = worked.box_separation(a, b)
    x = worked.box_corners(a)
    return worked.Contacts(x, x - gap * n, n, np.full(8, gap))


def from_the_ends(a, b, r_a, c, d, r_b):
    """The nearest pair of ends of two capsules."""
    p, q = min(((p, q) for p in (a, b) for q in (c, d)), key=lambda pair: np.linalg.norm(pair[0] - pair[1]))
    return worked.ball_contact(p, r_a, q, r_b)


def edge_of_a(a, b):
    """Polygons separated only by the edges of a."""
    contacts = worked.polygon_contacts(a, b)
    return contacts._replace(gap=np.minimum(contacts.gap, worked.separating_edge(a, b)[0]))


WRONG = [                    # case, function, the function that replaces it
    (16, "ball_box", always_up),
    (16, "plane_impact_time", detects_at_the_end),
    (61, "gjk", through_the_origin),
    (61, "gjk", single_precision),
    (62, "cylinder_impact_time", by_the_textbook_root),
    (63, "ball_box", only_outside),
    (63, "ball_contact", lambda x, r, y, R: worked.ball_contact(x, r, y, R)._replace(n=np.zeros(3))),
    (64, "gjk", through_the_origin),
    (65, "flock_acceleration", gentle),
    (66, "closest_on_segment", accepts_everything),
    (66, "make_plane", accepts_everything),
    (66, "repulsion", accepts_everything),
    (67, "box_separation", faces_only),
    (67, "box_box", not_clipped),
    (67, "capsule_capsule", from_the_ends),
    (67, "polygon_contacts", edge_of_a),
]


@pytest.mark.parametrize(("number", "name", "wrong"), WRONG, ids=[f"{w[0]}-{w[1]}-{k}" for k, w in enumerate(WRONG)])
def test_a_wrong_function_does_not_find_what_theory_says(number, name, wrong):
    lesson = types.SimpleNamespace(**{**vars(stability.lesson_of(number)), name: wrong})
    with np.errstate(all="ignore"):
        found, _ = stability.CASES[number][1](lesson)
    assert not all(f.holds for f in found)
