"""Given.  One rule per record: what its fields must be, alone and beside the state that they belong to.

`make_*` and every loop over steps call check_record.  Steps and sweeps trust what it has checked.
A record is known by the names of its fields, because the lessons of a student have classes of their own.  A record with
other fields, such as one of your own, has no rule; then the loop checks only the fields that it reads itself.
"""

from typing import NamedTuple

import numpy as np

from ..checks import UNIT, BadInput, WrongShape

FLAT_BODY_TOLERANCE = 1e-12  # a flat body has I₁ + I₂ = I₃; round-off may violate that by this share [-]
SMALL = 2000                 # numbers in a state up to which a checked record is remembered [-]
MOST_KNOWN = 64              # records that are remembered [-]
CHECKED: set = set()         # the content of records that were found right
ROUND = 1e-9                 # allowed difference of the moments of a round body, over the largest [-]


class Bound(NamedTuple):
    """What each number of a field must be."""
    holds: object            # function of an array, returns an array of truths
    remedy: str
    types: tuple = (float, int, np.floating, np.integer)


FINITE = Bound(np.isfinite, "give finite numbers only")
POSITIVE = Bound(lambda y: (y > 0.0) & np.isfinite(y), "give a finite number above zero")
NOT_NEGATIVE = Bound(lambda y: (y >= 0.0) & np.isfinite(y), "give a finite number of zero or above")
FRICTION = Bound(lambda y: y >= 0.0, "give a number of zero or above; infinity prevents any slip")
SHARE = Bound(lambda y: (y >= 0.0) & (y <= 1.0), "give a number from 0 to 1")
PART = Bound(lambda y: (y > 0.0) & (y <= 1.0), "give a number above 0, up to 1")
COUNT = Bound(lambda y: y >= 1, "give a whole number of 1 or more, without a decimal point", (int, np.integer))
WHOLE = Bound(lambda y: y >= 0, "give a whole number of 0 or more, without a decimal point", (int, np.integer))
NUMBER = Bound(lambda y: ~np.isnan(y), "give numbers; ±∞ for no limit")


class Field(NamedTuple):
    """The rule of one field."""
    thing: str               # its name and unit, as errors write it
    bound: Bound
    shape: tuple | None      # numbers, or names of sizes that all fields of a record and its state share; None: any


class Row(NamedTuple):
    """The rule of a field that holds the numbers of rows of other arrays."""
    thing: str
    of: str                  # name of the size that all numbers are below; empty: any number of 0 or more
    shape: tuple


class Inner(NamedTuple):
    """The rule of a field that is a record itself."""
    thing: str


class Rule(NamedTuple):
    """The rule of a record."""
    fields: dict
    together: tuple = ()     # functions of (name of the record, record, sizes) for what concerns several fields


def number(thing, bound=FINITE):
    return Field(thing, bound, ())


def vector(thing, size="d"):
    return Field(thing, FINITE, (size,))


# ---------------------------------------------------------------------------------------------- one field

def check_record(p, state):
    """Raise BadInput unless a record p of this workbook is one that can be, and fits the state.

    state: the array whose rows p describes (x; the angles of an arm), or a PileState, which is checked as well.
    Compiled code passes over this call.  validate/subject/modules.py makes it in plain Python before the compiled loop
    starts.  A small record that was found right is known by its content, and is not checked again: the check of a net
    takes longer than ten compiled steps of it.
    """
    known = content(p), state.shape if isinstance(state, np.ndarray) else content(state)
    if known in CHECKED:
        return
    sizes = check_state(p, state)
    beside = known[0], *sizes.items()                        # the same record beside another state of these sizes
    if beside not in CHECKED:
        check_one(p, RULES.get(getattr(p, "_fields", None)), sizes)
    if np.size(getattr(state, "x", state)) <= SMALL:
        if len(CHECKED) >= MOST_KNOWN:
            CHECKED.clear()
        CHECKED.update((known, beside))


def content(value):
    """Return a key for the types and the content of a value.  A record that is edited by hand has another key, and its
    old key again when the edit is undone.
    """
    if isinstance(value, np.ndarray):
        return value.dtype.char, value.shape, value.tobytes()
    if isinstance(value, tuple):
        return type(value), *map(content, value)
    return (type(value), value) if type(value).__hash__ else object()      # a list equals nothing here


def check_state(p, state):
    """Return the sizes that a state gives to the fields of its record.  Raises BadInput for a state that cannot be."""
    sizes = {}
    if hasattr(state, "_fields"):
        check_one(state, RULES.get(state._fields), sizes)
    elif RULES.get(getattr(p, "_fields", None)) is not None:
        sizes = sizes_of(state)
    return sizes


def sizes_of(x):
    """Return the sizes that a state (…, rows, d) gives to the fields of its record."""
    try:
        shape = np.shape(x)
    except ValueError:
        raise BadInput("the state of the first step", "not an array of numbers", "give rows of equal length") from None
    return dict(zip(("d", "rows"), shape[::-1]))


def check_one(p, rule, sizes):
    """Raise BadInput where a record breaks its rule; sizes: those known so far, to which it adds its own."""
    if rule is None:
        return
    for value, field in zip(p, rule.fields.values()):
        if isinstance(field, Inner):
            check_inner(p, value, field, sizes)
        elif not obeys(value, field, sizes):
            explain(f"{field.thing} of a {type(p).__name__}", value, field, sizes)
    for check in rule.together:
        check(type(p).__name__, p, sizes)


def check_inner(p, value, field, sizes):
    """Raise BadInput unless the field of a record is a record that obeys its rule."""
    rule = RULES.get(getattr(value, "_fields", None))
    if rule is None:
        raise BadInput(f"{field.thing} of a {type(p).__name__}", "not a record", "make it as the lesson does")
    check_one(value, rule, sizes)


def obeys(value, field, sizes):
    """Return whether the value of a field obeys its rule.  The first array with a size of a new name sets it."""
    if field.shape == ():
        return isinstance(value, field.bound.types) and field.bound.holds(value)
    if not isinstance(value, np.ndarray) or value.dtype.kind not in ("iu" if isinstance(field, Row) else "f"):
        return False
    if field.shape is not None and value.shape != field.shape:
        if value.ndim != len(field.shape):
            return False
        for size, found in zip(field.shape, value.shape):
            if found != (size if isinstance(size, int) else sizes.setdefault(size, found)):
                return False
    if isinstance(field, Row):
        return bool(((value >= 0) & (value < sizes.get(field.of, np.inf))).all())
    return bool(field.bound.holds(value).all())


def explain(thing, value, field, sizes):
    """Raise the BadInput of a value that breaks the rule of its field."""
    if field.shape == ():
        if not isinstance(value, (float, int, np.floating, np.integer)):
            raise BadInput(thing, "not a number", "give a number")
        raise BadInput(thing, value, field.bound.remedy)
    if not isinstance(value, np.ndarray):
        raise BadInput(thing, "not an array", "wrap it in np.array")
    if value.dtype.kind not in ("iu" if isinstance(field, Row) else "f"):
        meant = "whole numbers" if isinstance(field, Row) else "floats"
        raise BadInput(thing, f"an array of the type {value.dtype}", f"give an array of {meant}")
    if field.shape is not None:
        wanted = tuple(sizes.get(size, size) for size in field.shape)
        if value.shape != wanted:
            raise WrongShape(thing, value.shape, wanted)
    if isinstance(field, Row):
        most = sizes.get(field.of, np.inf) - 1
        right, remedy = (value >= 0) & (value <= most), f"give numbers from 0 to {most}"
    else:
        right, remedy = field.bound.holds(value), field.bound.remedy
    raise BadInput(thing, value[~right][0], remedy)


# ---------------------------------------------------------------------------------------------- several fields

def check_units(thing, vectors):
    """Raise BadInput unless all vectors (…, d) have the length 1."""
    lengths = np.sqrt(np.sum(vectors**2, axis=-1))
    wrong = np.abs(lengths - 1.0) > UNIT
    if np.any(wrong):
        raise BadInput(thing, lengths[wrong].flat[0], "give a unit vector")


def unit(name, thing):
    """Return the check that a field is a unit vector, or that its rows are."""
    def check(record, p, sizes):
        check_units(f"the length of {thing} of a {record} [-]", getattr(p, name))
    return check


def check_principal_moments(moments):
    """Raise BadInput unless these (3,) are moments of a body: positive, none above the sum of the others, and infinite
    for all axes or for none.
    """
    for moment in moments:
        if not moment > 0.0:
            raise BadInput("a principal moment of inertia [kg m²]", moment, "give a number above zero")
        if np.isfinite(moment) and np.any(np.isinf(moments)):
            raise BadInput("moment of inertia beside an infinite one [kg m²]", moment,
                           "make all three infinite, or none")
    for k in range(3):
        moment, others = moments[k], moments[(k + 1) % 3] + moments[(k + 2) % 3]
        if moment > others * (1.0 + FLAT_BODY_TOLERANCE):
            raise BadInput("a principal moment of inertia [kg m²]", moment,
                           "no distribution of mass has it; keep it below the sum of the other two")


def moments_of_a_body(record, p, sizes):
    """Raise BadInput unless I_body are moments that a body can have."""
    check_principal_moments(p.I_body)


def moments_of_a_round_body(record, p, sizes):
    """Raise BadInput unless all moments are the same."""
    if np.ptp(p.I_body) > ROUND * np.max(p.I_body):
        raise BadInput(f"the difference of the moments of a {record} [kg m²]", np.ptp(p.I_body),
                       "a body that rolls in every direction has three equal moments")


def same_about_any_axis(record, p, sizes):
    """Raise BadInput unless the inverse inertia is the same about all axes, and above zero or zero."""
    size = p.inv_inertia[0, 0]
    if not (size >= 0.0 and np.max(np.abs(p.inv_inertia - size * np.eye(3))) <= ROUND * size):
        raise BadInput(f"the inverse inertia of a {record} [1/(kg m²)]", p.inv_inertia.tolist(),
                       "give a number of zero or above times np.eye(3): a ball has the same about any axis")


def rows_of_bodies(record, p, sizes):
    """Raise BadInput unless the rows of a Bodies or a Pile are those of its bodies and of its planes."""
    n, d, planes = sizes["n"], sizes["d"], sizes["planes"]
    if d not in (2, 3):
        raise BadInput(f"the dimension of a {record} [-]", d, "give 2 or 3")
    if p.planes.shape[1] != d + 1:
        raise WrongShape(f"the planes of a {record}", p.planes.shape, (planes, d + 1))
    if n + planes != p.inv_mass.size:
        raise BadInput(f"the number of bodies and planes of a {record} [-]", n + planes,
                       f"its inverse masses are {p.inv_mass.size}: give one row for each")
    wanted = (n + planes,) if d == 2 else (n + planes, 3)
    if p.inv_inertia.shape != wanted:
        raise WrongShape(f"the inverse inertias of a {record}", p.inv_inertia.shape, wanted)
    if sizes.get("firsts", n + 1) != n + 1:
        raise WrongShape("the numbers `first` of the contacts of a state", (sizes["firsts"],), (n + 1,))
    check_inverse_inertia(record, p)
    check_units(f"the length of the normal of a plane of a {record} [-]", p.planes[:, :d])


def check_inverse_inertia(record, p):
    """Raise BadInput unless the inverse moments are those that bodies can have; planes have none, and no mass."""
    n = len(p.half)
    for thing, values in (("mass", p.inv_mass), ("inertia", p.inv_inertia)):
        if np.any(values[n:]):
            raise BadInput(f"inverse {thing} of a plane of a {record}", np.max(values[n:]), "give 0: it never moves")
    if p.inv_inertia.ndim == 2:
        with np.errstate(divide="ignore"):
            moments = 1.0 / p.inv_inertia[:n]
        some = np.isinf(moments).any(axis=1) & ~np.isinf(moments).all(axis=1)
        uneven = 2.0 * moments.max(axis=1) > moments.sum(axis=1) * (1.0 + FLAT_BODY_TOLERANCE)
        for k in np.flatnonzero(some | uneven)[:1]:
            check_principal_moments(moments[k])


def fits_state(record, p, sizes):
    """Raise BadInput unless the orientations and the contacts of a PileState are those of its bodies."""
    rows, d = sizes["rows"], sizes["d"]
    for thing, array, shapes in (("orientation q", p.q, {2: (rows,), 3: (rows, 4)}),
                                 ("angular velocity ω [rad/s]", p.omega, {2: (rows,), 3: (rows, 3)})):
        if d not in shapes:
            raise WrongShape("position x [m]", p.x.shape, "rows of 2 or 3 coordinates")
        if array.shape != shapes[d]:
            raise WrongShape(thing, array.shape, shapes[d])
    first = p.contacts.first
    if not (first.size > 0 and first[0] == 0 and first[-1] == sizes["contacts"] and np.all(np.diff(first) >= 0)):
        raise BadInput("the numbers `first` of the contacts of a state", first.tolist(),
                       "take them from the state that make_* or a loop has returned")


def links_of_a_network(record, p, sizes):
    """Raise BadInput for a link between immovable points or of a point with itself."""
    weight = p.inv_mass[p.i] + p.inv_mass[p.j]
    for s in np.flatnonzero(p.i == p.j)[:1]:
        raise BadInput(f"both ends of link {s} of a {record}", p.i[s], "name two points")
    for s in np.flatnonzero(weight == 0.0)[:1]:
        raise BadInput(f"the inverse mass at link {s} of a {record} [1/kg]", 0.0,
                       "leave out links between immovable points")


def kinetic_below_static(record, p, sizes):
    """Raise BadInput for μ_k above μ_s, which would allow neither rest nor sliding."""
    if p.mu_k > p.mu_s:
        raise BadInput("kinetic friction μ_k [-]", p.mu_k, f"give at most the static μ_s = {p.mu_s}")


def limits_in_order(record, p, sizes):
    """Raise BadInput for a lower limit above the upper one."""
    for low, high in zip(p.low, p.high):
        if not (low <= high and low < np.inf and high > -np.inf):
            raise BadInput("the lower limit of a joint [rad]", low, "keep it below the upper one")


def axis_or_none(record, p, sizes):
    """Raise BadInput unless the axis is a unit vector or zero."""
    if np.any(p.axis):
        unit("axis", "the axis")(record, p, sizes)


def velocity_is_the_input(record, p, sizes):
    """Raise BadInput unless the restitutions of the course have one derivative for each component of the velocity."""
    found, wanted = p.course.e_s.shape, (p.course.e.size, p.x.size)
    if found != wanted:
        raise WrongShape(f"derivatives of the restitutions of a {record}", found, wanted)


def two_bodies_each(record, p, sizes):
    """Raise BadInput for a joint of a body with itself, or of two that cannot move."""
    weight = p.inv_mass[p.joints.a] + p.inv_mass[p.joints.b]
    for k in np.flatnonzero((p.joints.a == p.joints.b) | (weight == 0.0))[:1]:
        raise BadInput(f"the bodies of joint {k}", f"{p.joints.a[k]} and {p.joints.b[k]}",
                       "name two bodies of which one can move")


# ---------------------------------------------------------------------------------------------- the rules

MASS, MU, E = number("mass m [kg]", POSITIVE), number("friction μ [-]", FRICTION), number("restitution e [-]", SHARE)
GRAVITY, NORMAL = vector("gravity [m/s²]"), vector("the normal n [-]")
POINT, UNIT_NORMAL = vector("a point of the plane [m]"), unit("n", "the normal n")
MOMENTS = Field("a moment of inertia [kg m²]", POSITIVE, (3,))
RADIUS = number("radius [m]", POSITIVE)


def bodies(**more):
    """Return the fields of a Bodies, and more after them."""
    return {
        "inv_mass": Field("inverse mass [1/kg]", NOT_NEGATIVE, ("rows",)),
        "inv_inertia": Field("inverse moment of inertia [1/(kg m²)]", NOT_NEGATIVE, None),
        "half": Field("half size of a body [m]", POSITIVE, ("n", "d")),
        "planes": Field("plane", FINITE, ("planes", "plane")), "gravity": GRAVITY, "mu": MU, **more}


def ends(kind):
    """Return the fields i and j of the links of a network."""
    return {"i": Row(f"first end of a {kind}", "rows", (f"{kind}s",)),
            "j": Row(f"second end of a {kind}", "rows", (f"{kind}s",)),
            "rest": Field(f"length of a {kind} [m]", POSITIVE, (f"{kind}s",))}


def limits(**first):
    """Return the fields of an arm after those of its links; d is the number of its joints."""
    return {**first, "low": Field("lower limit [rad]", NUMBER, ("d",)),
            "high": Field("upper limit [rad]", NUMBER, ("d",)), "rest": vector("angle at rest [rad]"),
            "gain": number("gain [1/m²]", NOT_NEGATIVE), "damping": number("damping [m]", NOT_NEGATIVE),
            "pull": number("pull to rest [-]", NOT_NEGATIVE)}


def rolling(**more):
    """Return the fields of a ball on a floor, and more after them."""
    return {"m": MASS, "I_body": MOMENTS, "radius": RADIUS, "mu": MU, "gravity": vector("gravity [m/s²]", 3), **more}


SWEEPS = number("sweeps in a step", COUNT)
SOLVER = {"sweeps": number("number of sweeps", WHOLE), "margin": number("margin [m]", POSITIVE)}
WEIGHTS = {"inv_mass": Field("inverse mass [1/kg]", NOT_NEGATIVE, ("rows",)), "gravity": GRAVITY}

RULES = {tuple(rule.fields): rule for rule in (
    # lesson 1
    Rule({"omega": number("angular frequency ω [rad/s]"), "zeta": number("damping ratio ζ [-]")}),
    # lesson 2
    Rule({**WEIGHTS, "wind": vector("force of the wind [N]"), "k_v": number("viscosity k_v [N s/m]", NOT_NEGATIVE),
          **ends("spring"), "k": Field("stiffness k [N/m]", NOT_NEGATIVE, ("springs",)),
          "k_d": Field("damper k_d [N s/m]", NOT_NEGATIVE, ("springs",))}),
    # lesson 3: Block, ParticleOnPlane, ParticleInBowl
    Rule({"n": NORMAL, "mu_s": number("static friction μ_s [-]", FRICTION),
          "mu_k": number("kinetic friction μ_k [-]", FRICTION), "gravity": GRAVITY,
          "drive": vector("drive over mass [m/s²]"), "omega": number("angular frequency ω [rad/s]")},
         (UNIT_NORMAL, kinetic_below_static)),
    Rule({"m": MASS, "mu": MU, "e": E, "gravity": GRAVITY, "point": POINT, "n": NORMAL}, (UNIT_NORMAL,)),
    Rule({"m": MASS, "mu": MU, "e": E, "gravity": GRAVITY, "centre": vector("centre [m]"), "axis": vector("axis [-]"),
          "radius": RADIUS}, (axis_or_none,)),
    # lesson 5: RigidBody, Top, RollingBall
    Rule({"m": MASS, "I_body": MOMENTS}, (moments_of_a_body,)),
    Rule({"I_body": MOMENTS, "mgl": number("weight times length mgl [N m]")}, (moments_of_a_body,)),
    Rule(rolling(), (moments_of_a_round_body,)),
    # lesson 6: Plane, Target, Flock
    Rule({"n": NORMAL, "d": number("place d of the plane [m]")}, (UNIT_NORMAL,)),
    Rule({"r": number("radius r of the ball [m]", NOT_NEGATIVE),
          "R": number("radius R of the cylinder [m]", NOT_NEGATIVE), "plane": Inner("plane")}),
    Rule({"radius": RADIUS, "reach": number("reach [m]", POSITIVE), "k": number("k [m⁴/s²]", POSITIVE),
          "align": number("align [1/s]"), "gather": number("gather [1/s²]")}),
    # lesson 7: BouncingBall, SpinningBall, Discs
    Rule({"e": E, "gravity": GRAVITY, "point": POINT, "n": NORMAL,
          "stiffness": number("stiffness over mass [1/s²]", NOT_NEGATIVE),
          "damping": number("damping over mass [1/s]", NOT_NEGATIVE)}, (UNIT_NORMAL,)),
    Rule({"e": E, "mu": MU, "inv_mass": number("inverse mass [1/kg]", POSITIVE),
          "inv_inertia": Field("inverse inertia [1/(kg m²)]", FINITE, (3, 3)), "radius": RADIUS, "gravity": GRAVITY,
          "point": POINT, "n": NORMAL}, (UNIT_NORMAL, same_about_any_axis)),
    Rule({"radius": Field("radius of a disc [m]", NOT_NEGATIVE, ("rows",)),
          "inv_mass": Field("inverse mass of a disc [1/kg]", NOT_NEGATIVE, ("rows",)), "e": E}),
    # lesson 8: ConstraintNetwork, Obstacle, Cloth, Balloon
    Rule({**WEIGHTS, **ends("link"), "stiffness": Field("stiffness of a link [-]", PART, ("links",)),
          "alpha": Field("compliance α [m/N]", NOT_NEGATIVE, ("links",)), "sweeps": SWEEPS},
         (links_of_a_network,)),
    Rule({"centre": vector("centre of the ball [m]"), "radius": number("radius of the ball [m]", NOT_NEGATIVE),
          "point": vector("a point of the floor [m]"), "n": NORMAL}, (UNIT_NORMAL,)),
    Rule({"network": Inner("network"), "hinges": Row("corner of a fold", "rows", ("folds", 4)),
          "fold": Field("rest angle of a fold [rad]", FINITE, ("folds",)),
          "stiffness": number("stiffness of the folds [-]", SHARE), "obstacle": Inner("obstacle")}),
    Rule({"network": Inner("network"), "faces": Row("corner of a face", "rows", ("faces", 3)),
          "volume": number("rest volume [m³]"), "alpha": number("compliance α of the air [m³/(N/m²)]", NOT_NEGATIVE),
          "obstacle": Inner("obstacle")}),
    Rule({"m": MASS, "I_body": MOMENTS, "gravity": vector("gravity [m/s²]", 3), "pivot": vector("pivot [m]", 3),
          "arm_body": vector("arm to the pivot [m]", 3), "sweeps": SWEEPS}, (moments_of_a_body,)),
    # lessons 9 and 10: ContactSet, PileState, Pile, Bodies, JointedBodies, Joints, CarriedBall, RockingBlock, rods,
    # a cradle
    Rule({"first": Row("place of the contacts of a body", "", ("firsts",)),
          "a": Row("body of a contact", "rows", ("contacts",)), "b": Row("body of a contact", "rows", ("contacts",)),
          "n": Field("normal of a contact [-]", FINITE, ("contacts", "d")),
          "p": Field("place of a contact [m]", FINITE, ("contacts", "d")),
          "gap": Field("gap of a contact [m]", FINITE, ("contacts",))}, (unit("n", "a normal"),)),
    Rule({"x": Field("position x [m]", FINITE, ("rows", "d")), "q": Field("orientation q", FINITE, None),
          "v": Field("velocity v [m/s]", FINITE, ("rows", "d")),
          "omega": Field("angular velocity ω [rad/s]", FINITE, None), "contacts": Inner("contacts"),
          "J": Field("impulse J [N s]", FINITE, ("contacts", "d"))}, (fits_state,)),
    Rule(bodies(substeps=number("number of substeps", COUNT), hertz=number("hertz of the contacts [1/s]", POSITIVE),
                zeta=number("damping ratio ζ of the contacts [-]", POSITIVE), margin=SOLVER["margin"]),
         (rows_of_bodies,)),
    Rule(bodies(**SOLVER), (rows_of_bodies,)),
    Rule(bodies(**SOLVER, e=E, joints=Inner("joints")), (rows_of_bodies, two_bodies_each)),
    Rule({"a": Row("body of a joint", "rows", ("joints",)), "b": Row("body of a joint", "rows", ("joints",)),
          "r_a": Field("point of a joint [m]", FINITE, ("joints", "d")),
          "r_b": Field("point of a joint [m]", FINITE, ("joints", "d")), "band": number("band", WHOLE),
          "loops": number("loops")}),
    Rule(rolling(centre=vector("centre of the floor [m]", 3), floor_v=vector("velocity of the floor [m/s]", 3),
                 floor_omega=vector("angular velocity of the floor [rad/s]", 3)), (moments_of_a_round_body,)),
    Rule({"m": MASS, "half_width": number("half width [m]", POSITIVE),
          "half_height": number("half height [m]", POSITIVE),
          "inertia": number("moment of inertia [kg m²]", POSITIVE), "g": number("gravity g [m/s²]", POSITIVE)}),
    Rule({"m": MASS, "l": number("length of a rod [m]", POSITIVE),
          "I": number("moment of inertia of a rod [kg m²]", NOT_NEGATIVE), "g": number("gravity g [m/s²]")}),
    Rule({"pitch": number("distance of neighbouring pivots [m]", POSITIVE),
          "L": number("length of a rod [m]", POSITIVE), "R": number("radius of a ball [m]", POSITIVE),
          "inertia": number("moment of inertia about a pivot [m²]", POSITIVE), "g": number("gravity g [m/s²]")}),
    # lesson 11: Arm2D, Arm3D
    Rule(limits(lengths=Field("length of a link [m]", POSITIVE, ("d",))), (limits_in_order,)),
    Rule(limits(axes=Field("axis of a joint [-]", FINITE, ("d", 3)),
                offsets=Field("offset of a joint [m]", FINITE, ("d", 3))), (unit("axes", "an axis"), limits_in_order)),
    # lesson 12: Course, Throw
    Rule({"gravity": GRAVITY, "n": Field("normal of a plane [-]", FINITE, ("planes", "d")),
          "point": Field("a point of a plane [m]", FINITE, ("planes", "d")),
          "e": Field("restitution e [-]", SHARE, ("planes",)),
          "e_s": Field("derivative of a restitution", FINITE, ("planes", "inputs"))}, (unit("n", "a normal"),)),
    Rule({"course": Inner("course"), "x": vector("position x [m]"), "target": vector("target [m]"),
          "duration": number("duration of a throw [s]", NOT_NEGATIVE)}, (velocity_is_the_input,)),
)}
