"""A wrong function of lesson 6 does not find what theory says."""

import types

import numpy as np
import pytest

from validate.stability.examine import cases_of, found_by, subject_of
from validate.subject.modules import bind

from .sampled import wrong_functions

worked = bind("collisions")


def always_up(x, r, box):
    """Out through the top, however deep."""
    contact = worked.ball_box(x, r, box)
    return contact._replace(n=np.array([0.0, 0.0, 1.0])) if contact.gap < 0.0 else contact


def only_outside(x, r, box):
    """No case for a centre inside."""
    return worked.ball_contact(x, r, box.x + box.R @ np.clip(box.R.T @ (x - box.x), -box.half, box.half), 0.0)


def looks_afterwards(t, dt, x_0, x_1, r, plane):
    """The end of the step for the time of impact."""
    return t + dt if worked.plane_distance(x_1, plane) < r else np.inf


def by_school(t, dt, x_0, x_1, r, R):
    y, w = x_0[1:], x_1[1:] - x_0[1:]
    A, B, C = w @ w, y @ w, y @ y - (R + r) ** 2
    return t + dt * (-B - np.sqrt(max(0.0, B * B - A * C))) / A


def through_the_origin(a, b):
    """Distances from the origin of the world: the squares are rounded."""
    i, j = np.unravel_index(np.argmin(np.sum(a**2, axis=1)[:, None] + np.sum(b**2, axis=1) - 2.0 * a @ b.T),
                            (len(a), len(b)))
    return worked.ball_contact(a[i], 0.0, b[j], 0.0)


def single_precision(a, b):
    return worked.gjk(a.astype(np.float32).astype(float), b.astype(np.float32).astype(float))


def gentle(t, x, v, p):
    """Half of the field."""
    return 0.5 * worked.flock_acceleration(t, x, v, p)


def takes_all(*_):
    return np.zeros(3)


def faces_only(a, b):
    """Six axes of fifteen."""
    found = [(abs((a.x - b.x) @ n) - worked.half_width(a, n) - worked.half_width(b, n), n, k) for k in range(6)
             for n in [worked.candidate_axis(a, b, k)]]
    gap, n, k = max(found, key=lambda one: one[0])
    return gap, n if n @ (a.x - b.x) >= 0.0 else -n, k


def not_clipped(a, b):
    """All corners of a for points of contact."""
    gap, n, _ = worked.box_separation(a, b)
    x = worked.box_corners(a)
    return worked.Contacts(x, x - gap * n, n, np.full(8, gap))


def from_the_ends(a, b, r_a, c, d, r_b):
    """The nearest of the ends of two capsules."""
    p, q = min(((p, q) for p in (a, b) for q in (c, d)), key=lambda pair: np.linalg.norm(pair[0] - pair[1]))
    return worked.ball_contact(p, r_a, q, r_b)


def edge_of_a(a, b):
    """Polygons that know the edges of a only."""
    contacts = worked.polygon_contacts(a, b)
    return contacts._replace(gap=np.minimum(contacts.gap, worked.separating_edge(a, b)[0]))


WRONG = [                    # case, the function that it examines, what is put in its place
    ("tunnelling", "ball_box", always_up),
    ("tunnelling", "plane_impact_time", looks_afterwards),
    ("far-from-origin", "gjk", through_the_origin),
    ("far-from-origin", "gjk", single_precision),
    ("grazing-impact", "cylinder_impact_time", by_school),
    ("deep-overlap", "ball_box", only_outside),
    ("deep-overlap", "ball_contact", lambda x, r, y, R: worked.ball_contact(x, r, y, R)._replace(n=np.zeros(3))),
    ("degenerate-shapes", "gjk", through_the_origin),
    ("head-on-avoidance", "flock_acceleration", gentle),
    ("head-on-avoidance", "steer", lambda *now: 0.99 * worked.steer(*now)),
    ("undefined-distance", "closest_on_segment", takes_all),
    ("undefined-distance", "make_plane", takes_all),
    ("undefined-distance", "repulsion", takes_all),
    ("minimum-translation", "box_separation", faces_only),
    ("minimum-translation", "box_box", not_clipped),
    ("minimum-translation", "capsule_capsule", from_the_ends),
    ("minimum-translation", "polygon_contacts", edge_of_a),
]


@pytest.mark.parametrize(("slug", "name", "wrong"), list(wrong_functions(WRONG)))
def test_a_wrong_function_does_not_find_what_theory_says(slug, name, wrong):
    case = cases_of("collisions")[slug]
    lesson = types.SimpleNamespace(**{**vars(subject_of(case)), name: wrong})
    with np.errstate(all="ignore"):
        found, _ = found_by(case, lesson)
    assert not all(f.holds for f in found)
