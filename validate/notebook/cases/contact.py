"""Pictures of lesson 9: contacts, their forces and their impulses."""

import numpy as np

from .marks import Arrow, Disc, Dots, Links, Note
from .pieces import Picture, array, flat, part, plane_view, scaled, size_of, world_views


def contacts_of(x, contacts, *_):
    """Return the middles of the bodies, the contacts and their normals."""
    size = 0.25 * size_of(contacts.p, x)
    return [Dots(x, "middles of the bodies"), Dots(contacts.p, "contacts"),
            Links(np.stack((contacts.p, contacts.p + size * contacts.n), axis=1), "n, from b to a")]


def normal_rows(G, x, contacts):
    """Return what the normal rows of G multiply the velocities of the bodies with, as arrows at their middles."""
    G, size = array(G, 2 * len(contacts.p), 3 * len(x)), 0.25 * size_of(contacts.p, x)
    parts = [(x[i], row[3 * i:3 * i + 2]) for row in G[::2] for i in range(len(x))]
    arrows = np.array([(at, at + size * row) for at, row in parts])
    return [Links(arrows, "entries of the normal rows of G for v, at each body")]


def loaded(x, inv_mass, inv_inertia, contacts, load, mu):
    size, loads = 0.3 * size_of(contacts.p, x), load[:, :2]
    return [*contacts_of(x, contacts),
            *(Arrow(at, scaled(one, size, *loads), "load") for at, one in zip(x, loads) if np.any(one))]


def forces(result, x, inv_mass, inv_inertia, contacts, load, mu):
    F = array(part(result, "F", 0), len(contacts.p), 2)
    t = np.stack((-contacts.n[:, 1], contacts.n[:, 0]), axis=1)
    on_a, size = F[:, :1] * contacts.n + F[:, 1:] * t, 0.3 * size_of(contacts.p, x)
    return [Arrow(p, scaled(f, size, *load[:, :2], *on_a), "forces on a, on the scale of the largest")
            for p, f in zip(contacts.p, on_a) if np.any(f)] or [Note("no force")]


def in_plane_of_J(_, J, limit):
    labels = "along J [N s]", "across J [N s]"
    return [plane_view("in a plane of J", np.asarray(J), np.zeros(3), np.zeros(3), labels)]


def disc(J, limit):
    J = np.asarray(J, dtype=float)
    return [Disc(np.zeros(3), float(limit), f"disc, limit {limit:.4g} N s"),
            Dots(J[None], f"J, {np.linalg.norm(J):.4g} N s")]


def in_disc(result, J, limit):
    found = array(result, 3)
    return [Dots(found[None], f"impulse of {np.linalg.norm(found):.4g} N s")]


def old_and_new(contacts, old, J_old, near):
    size = 0.3 * size_of(contacts.p, old.p)
    return [Dots(contacts.p, "contacts"), Dots(old.p, "old contacts"),
            *(Arrow(p, scaled(J, size, *J_old), "impulses of the old contacts") for p, J in zip(old.p, J_old)),
            *(Disc(p, near, f"closer than near, {near:.4g} m") for p in contacts.p)]


def taken_over(J, contacts, old, J_old, near):
    J, size = array(J, *contacts.p.shape), 0.3 * size_of(contacts.p, old.p)
    return [Arrow(p, scaled(one, size, *J_old, *J), "impulses to begin with") for p, one in zip(contacts.p, J)
            if np.any(one)] or [Note("no impulse to begin with")]


PICTURES = {
    "9.1": Picture(flat, contacts_of, normal_rows, "a row has n at body a, −n at body b, and nothing at other bodies."),
    "9.11": Picture(flat, loaded, forces,
                    "forces push along n, or lean from it within the cone of friction, and carry the loads."),
    "9.13": Picture(in_plane_of_J, disc, in_disc,
                    "the answer is J itself inside the disc, else the nearest point of the rim."),
    "9.14": Picture(lambda _, contacts, *__: world_views(contacts.p.shape[1]), old_and_new, taken_over,
                    "each contact takes over the impulse of the nearest old one of its pair inside its circle."),
}
