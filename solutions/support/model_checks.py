"""Given.  Checks of what a Model is made of: each raises BadInput with one sentence that names the record."""

import numpy as np

from ..checks import (
    UNIT,
    BadInput,
    WrongShape,
    check_not_negative,
    check_shape,
    check_unit,
    finite_array,
    finite_number,
    number,
    positive_number,
)
from .records import check_principal_moments
from .shapes import (
    Ball,
    Box,
    Capsule,
    HalfSpace,
    Polygon,
    Polyhedron,
    hull_triangles,
    polygon_centre,
    solid_integrals,
)

CENTRED = 1e-9               # allowed distance of a polygon's centre from the origin, over its size [-]


def one_of(thing, record, kinds):
    """Return a record.  Raises BadInput unless it is one of these."""
    if not isinstance(record, kinds):
        names = ", ".join(kind.__name__ for kind in kinds)
        raise BadInput(thing, f"a {type(record).__name__}", f"give one of: {names}")
    return record


def listed(thing, records):
    """Return records as a tuple.  Raises BadInput unless they are several."""
    try:
        return tuple(records)
    except TypeError:
        raise BadInput(thing, f"a {type(records).__name__}", "give a list; an empty one for none") from None


def vector(thing, values, d):
    """Return values as a tuple of d floats.  Raises BadInput."""
    values = finite_array(thing, values)
    if values.shape != (d,):
        raise WrongShape(thing, values.shape, (d,))
    return tuple(map(float, values))


def orientation(thing, q, d):
    """Return an angle, or a unit quaternion as a tuple.  Raises BadInput."""
    if d == 2:
        return finite_number(thing, 0.0 if q is None else q)
    q = vector(thing, (1.0, 0.0, 0.0, 0.0) if q is None else q, 4)
    check_unit(f"the length of {thing} [-]", np.sqrt(np.dot(q, q)))
    return q


def check_moments(thing, inertia, d):
    """Return a moment, or three.  Raises BadInput for those that no body has."""
    if d == 2:
        inertia = number(thing, inertia)
        if not (inertia > 0.0 and np.isfinite(1.0 / inertia)):
            raise BadInput(thing, inertia, "give a number above zero; ∞ for what does not turn")
        return inertia
    try:
        moments = np.asarray(inertia, float)
    except (TypeError, ValueError, OverflowError):
        raise BadInput(thing, "not a number, nor three", "give one moment, or three") from None
    moments = np.full(3, moments) if moments.ndim == 0 else moments
    if moments.shape != (3,):
        raise WrongShape(thing, moments.shape, (3,))
    check_principal_moments(moments)
    if not np.min(moments) > 1.0 / np.finfo(float).max:
        raise BadInput(thing, moments.tolist(), "give moments that are not so near zero")
    return tuple(map(float, moments))


def check_shape_of(thing, shape, d, fixed):
    """Return a shape with floats.  Raises BadInput for one of the other dimension, or with sizes that cannot be."""
    if isinstance(shape, Ball):
        return Ball(positive_number(f"the radius of {thing} [m]", shape.radius))
    if isinstance(shape, Capsule):
        return Capsule(positive_number(f"the half length of {thing} [m]", shape.half_length),
                       positive_number(f"the radius of {thing} [m]", shape.radius))
    if isinstance(shape, Box):
        half = vector(f"the half sizes of {thing} [m]", shape.half, d)
        return Box(tuple(positive_number(f"a half size of {thing} [m]", size) for size in half))
    if isinstance(shape, HalfSpace):
        if not fixed:
            raise BadInput(thing, "a HalfSpace with a finite mass", "leave its mass out: it has none")
        normal = vector(f"the normal of {thing}", shape.normal, d)
        check_unit(f"the length of the normal of {thing} [-]", np.sqrt(np.dot(normal, normal)))
        return HalfSpace(normal, finite_number(f"the offset of {thing} [m]", shape.offset))
    if isinstance(shape, Polyhedron):
        return check_polyhedron(thing, shape, d)
    if d == 3:
        raise BadInput(thing, "a Polygon in space", "polygons are shapes of the plane")
    return check_polygon(thing, shape)


def check_sliding(thing, shape, v, omega):
    """Raise BadInput where the surface of a HalfSpace, which stays where it is, would move along its normal."""
    n, spin = np.array(shape.normal), np.atleast_1d(omega)
    if abs(n @ v) > UNIT * np.linalg.norm(v):
        raise BadInput(f"the speed of {thing} along its normal [m/s]", float(n @ v),
                       "a HalfSpace can slide along itself only; take a Box for a floor that rises")
    if np.linalg.norm(spin if n.size == 2 else np.cross(spin, n)) > UNIT * np.linalg.norm(spin):
        raise BadInput(f"the angular velocity of {thing} [rad/s]", omega,
                       "a HalfSpace can turn about its normal only; take a Box for a floor that tilts")


def check_polyhedron(thing, shape, d):
    """Return a Polyhedron with floats.  Raises BadInput unless all its corners are corners of its hull, it is centred,
    and its axes of inertia are those of the body.
    """
    if d == 2:
        raise BadInput(thing, "a Polyhedron in the plane", "polyhedra are shapes of space")
    corners = finite_array(f"the corners of {thing} [m]", shape.corners)
    if corners.ndim != 2 or corners.shape[1] != 3 or len(corners) < 4:
        raise WrongShape(f"the corners of {thing} [m]", corners.shape, "four rows of three numbers, or more")
    size, (volume, centre, second) = np.max(np.abs(corners)), solid_integrals(corners)
    used = len(np.unique(hull_triangles(corners)))
    if not volume > CENTRED * size**3 or used < len(corners):
        raise BadInput(f"the number of corners of the hull of {thing} [-]", used,
                       "give the corners of a convex polyhedron only, as polyhedron_of does, which is not flat")
    if np.max(np.abs(centre)) > CENTRED * size or np.max(np.abs(np.triu(second, 1))) > CENTRED * size * size:
        raise BadInput(f"the centre of mass of the corners of {thing} [m]", centre.tolist(),
                       "give corners from the centre along the principal axes, as polyhedron_of does")
    return Polyhedron(tuple(map(tuple, corners.tolist())))


def check_polygon(thing, shape):
    """Return a Polygon with floats.  Raises BadInput unless it is convex, counter-clockwise and centred."""
    corners = finite_array(f"the corners of {thing} [m]", shape.corners)
    if corners.ndim != 2 or corners.shape[1] != 2 or len(corners) < 3:
        raise WrongShape(f"the corners of {thing} [m]", corners.shape, "three rows of two numbers, or more")
    edges = np.roll(corners, -1, axis=0) - corners
    turns = edges[:, 0] * np.roll(edges, -1, axis=0)[:, 1] - edges[:, 1] * np.roll(edges, -1, axis=0)[:, 0]
    around = np.sum(np.arctan2(turns, np.sum(edges * np.roll(edges, -1, axis=0), axis=1)))
    if not (np.all(turns > 0.0) and abs(around - 2.0 * np.pi) < 1e-6):
        raise BadInput(f"a turn between two edges of {thing} [m²]", np.min(turns),
                       "list the corners of a convex polygon counter-clockwise, none of them on a line with its two "
                       "neighbours")
    centre, size = polygon_centre(corners), np.max(np.abs(corners))
    if np.max(np.abs(centre)) > CENTRED * size:
        raise BadInput(f"the centre of mass of the corners of {thing} [m]", centre.tolist(),
                       "subtract it from all corners, and add it to the centre x of the body")
    return Polygon(tuple(map(tuple, corners.tolist())))


def check_ends(thing, a, b, free):
    """Raise BadInput unless a is a body, b is another one or the world, and one of them can move."""
    for k, least in ((a, 0), (b, -1)):
        if not isinstance(k, int | np.integer) or isinstance(k, bool) or not least <= k < len(free):
            raise BadInput(f"a body of {thing}", k, f"give a whole number from 0 to {len(free) - 1}; b may be WORLD")
    if a == b:
        raise BadInput(f"both bodies of {thing}", a, "name two bodies")
    if not (free[a] or (b >= 0 and free[b])):
        raise BadInput(f"the bodies of {thing}", f"{a} and {b}", "name two bodies of which one can move")


def check_joint(k, joint, free, d):
    """Return joint number k with floats.  Raises BadInput."""
    thing, kind = f"joint {k} (a {type(joint).__name__})", type(joint).__name__
    check_ends(thing, joint.a, joint.b, free)
    changed = {name: vector(f"{name} of {thing} [m]", getattr(joint, name), d)
               for name in ("place", "place_a", "place_b") if hasattr(joint, name)}
    if kind == "BallJoint" and d == 2:
        raise BadInput(thing, "in the plane", "take a Hinge, which is the same there")
    if kind == "Hinge":
        if (joint.axis is None) != (d == 2):
            raise BadInput(f"the axis of {thing}", joint.axis, "give one in space, and None in the plane")
        if d == 3:
            axis = vector(f"the axis of {thing}", joint.axis, 3)
            check_unit(f"the length of the axis of {thing} [-]", np.sqrt(np.dot(axis, axis)))
            changed["axis"] = axis
    if kind == "Distance":
        changed["compliance"] = not_negative(f"the compliance of {thing} [m/N]", joint.compliance)
    return joint._replace(a=int(joint.a), b=int(joint.b), **changed)


def check_spring(k, spring, free, d):
    """Return spring number k with floats.  Raises BadInput."""
    thing = f"spring {k}"
    check_ends(thing, spring.a, spring.b, free)
    return spring._replace(
        a=int(spring.a), b=int(spring.b), rest=not_negative(f"the rest length of {thing} [m]", spring.rest),
        place_a=vector(f"place_a of {thing} [m]", spring.place_a, d),
        place_b=vector(f"place_b of {thing} [m]", spring.place_b, d),
        k=not_negative(f"the stiffness k of {thing} [N/m]", spring.k),
        c=not_negative(f"the damper c of {thing} [N s/m]", spring.c))


def check_force(force, free):
    """Raise BadInput unless a Force is a function of "t", "x", "v", "xv", or "r" to another body, on one that can move.
    """
    there = [isinstance(k, int | np.integer) and not isinstance(k, bool) and 0 <= k < len(free)
             for k in (force.a, force.b)]
    if not (there[0] and free[force.a]):
        raise BadInput("the body of a Force", force.a, "name a body that can move by its number")
    if not isinstance(force.of, str) or force.of not in ("t", "x", "v", "xv", "r"):
        raise BadInput("what a Force depends on", repr(force.of), 'choose from: "t", "x", "v", "xv", "r"')
    if force.of == "r" and (not there[1] or force.b == force.a):
        raise BadInput("the other body of a Force", force.b, "name another body by its number")
    if not callable(force.F):
        raise BadInput("F of a Force", type(force.F).__name__, f"give a function of {', '.join(force.of)}")


def not_negative(thing, value):
    """Return value as a float.  Raises BadInput unless it is finite, and zero or more."""
    value = finite_number(thing, value)
    check_not_negative(thing, value)
    return value


def answered(thing, ask, remedy):
    """Return what a function of the user's answers.  Raises BadInput where it raises anything."""
    try:
        return ask()
    except Exception as error:
        raise BadInput(thing, f"a function that fails at the start ({type(error).__name__}: {error})",
                       remedy) from error


def check_own_force(thing, load, start, d):
    """Raise BadInput unless a Force returns d finite numbers at the start."""
    F = answered(thing, lambda: load.now(0.0, start.x, start.v),
                 f"take what of = {load.of!r} names, in this order, and return {d} numbers")
    vector(f"{thing} [N]", F, d)


def check_own_load(thing, load, start):
    """Raise BadInput unless a function returns (F, tau) of these bodies at the start, and leaves the start as it is."""
    given = [rows.copy() for rows in start]

    def ask():
        F, tau = load(0.0, *given)
        return F, tau
    F, tau = answered(thing, ask, "take (t, x, q, v, omega), and return two arrays, F and tau")
    for name, values, like in (("F [N]", F, start.x), ("tau [N m]", tau, start.omega)):
        check_shape(f"{name} of {thing}", finite_array(f"{name} of {thing}", values), like.shape)
    if any(np.any(now != before) for now, before in zip(given, start)):
        raise BadInput(thing, "a function that changes the state it is given", "copy an array before you change it")
