"""Thirteen bodies and their inertia tensors: from the lesson, from the volume integral, and from two engines.

Nothing moves here.  pybullet has formulas for balls, boxes and cylinders.  For every other shape it uses the
surrounding box, and the origin of the shape as its centre of mass.  The moment of a capsule is 28 % too large; that
of a dumbbell is 34 % too small across its axis and 67 % too large about it.  The remedy is to set the tensor.
pymunk is right, except for the round ends of its Segment.
"""

from functools import partial
from typing import Annotated, NamedTuple

import numpy as np

from validate.check import Whose, states
from validate.engines.bullet import Bullet
from validate.methods import PARTS, TRIANGLES
from validate.scene import EXACT, PYBULLET, PYMUNK, Departure, EngineRun, Scene, engine, ours
from validate.scenes._common import ANSWER, cases_with, check_positives, one_reading
from validate.scenes.drawing import outlines

T = 1.0


class Params(NamedTuple):
    shape: Annotated[str, "which body"] = "ball"
    m: Annotated[float, "its mass [kg]"] = 2.0
    a: Annotated[float, "radius; or edge, leg along x [m]"] = 0.3
    b: Annotated[float, "length; or edge, leg along y; or the other radius [m]"] = 0.0
    c: Annotated[float, "edge along z; or distance between the centres; or thickness [m]"] = 0.0
    d: Annotated[float, "height [m]"] = 0.0


CASES = {
    "ball": Params(),
    "box": Params("box", 2.0, 0.2, 0.4, 0.6),
    "cylinder": Params("cylinder", 2.0, 0.2, 0.7),
    "capsule": Params("capsule", 2.0, 0.2, 0.7),
    "dumbbell": Params("dumbbell", 2.0, 0.2, 0.2, 1.0),
    "uneven dumbbell": Params("dumbbell", 2.0, 0.2, 0.1, 1.0),
    "turned bar": Params("turned bar", 2.0, 1.0, 0.2, 0.2),
    "angle": Params("angle", 2.0, 0.6, 0.5, 0.1, 0.2),
    "corner of a box": Params("corner", 2.0, 0.4, 0.6, 0.8),
    "ring (2D)": Params("ring", 2.0, 0.3, 0.2),
    "triangle (2D)": Params("triangle", 2.0, 1.0, 0.6),
    "two discs (2D)": Params("two discs", 2.0, 0.2, 0.1, 1.0),
    "bar with round ends (2D)": Params("round bar", 2.0, 0.2, 0.7),
}
# These have one moment, about the axis normal to the plane.
FLAT = ("ring", "triangle", "two discs", "round bar")
TURN = np.pi / 4.0                                             # of the rotated bar about z [rad]
MARGIN = 0.001                                                 # that pybullet adds around a hull [m]


def start(p):
    check_positives(p, "m", "a")
    return (p,)


def quantity_names(p):
    entries = ("I",) if p.shape in FLAT else ("Ixx", "Iyy", "Izz", "Ixy", "Ixz", "Iyz")
    return tuple(f"{entry} [kg m²]" for entry in entries)


def six(I):
    """Return Ixx, Iyy, Izz, Ixy, Ixz, Iyz of a tensor."""
    return np.array([I[0, 0], I[1, 1], I[2, 2], I[0, 1], I[0, 2], I[1, 2]])


# ---------------------------------------------------------------------------------------------- ours

def run(lessons, step, acceleration, state, p, dt, steps):
    """Run the lesson's function on the parts of the body, or on its triangles."""
    body = step(*(mesh(p) if step is lessons.inertia_tensors.mesh_body else parts(lessons, p)))
    return (body.I,)


def observe(state, p):
    return state[0][2, 2:] if p.shape in FLAT else six(state[0])


def parts(lessons, p):
    """Return (m, x, I) of the parts of the body; flat bodies are one metre high, which does not affect z."""
    tensors, z, upright = lessons.inertia_tensors, np.array([0.0, 0.0, 1.0]), np.eye(3)
    whole = lambda I: (np.array([p.m]), np.zeros((1, 3)), np.stack([I]))
    if p.shape == "ball":
        return whole(tensors.sphere_inertia(p.m, p.a))
    if p.shape == "box":
        return whole(tensors.box_inertia(p.m, np.array([p.a, p.b, p.c])))
    if p.shape == "cylinder":
        return whole(tensors.cylinder_inertia(p.m, p.a, p.b))
    if p.shape == "capsule":
        return whole(tensors.capsule_inertia(p.m, p.a, p.b))
    if p.shape == "turned bar":
        R = np.array([[np.cos(TURN), -np.sin(TURN), 0.0], [np.sin(TURN), np.cos(TURN), 0.0], [0.0, 0.0, 1.0]])
        return whole(tensors.world_inertia(tensors.box_inertia(p.m, np.array([p.a, p.b, p.c])), R))
    if p.shape == "dumbbell":
        m = shared(p.m, p.a**3, p.b**3)
        I = np.stack([tensors.sphere_inertia(m[0], p.a), tensors.sphere_inertia(m[1], p.b)])
        return m, np.stack([0.0 * z, p.c * z]), I
    if p.shape == "two discs":
        m = shared(p.m, p.a**2, p.b**2)
        I = np.stack([tensors.cylinder_inertia(m[0], p.a, 1.0), tensors.cylinder_inertia(m[1], p.b, 1.0)])
        return m, np.stack([0.0 * z, p.c * upright[0]]), I
    if p.shape == "ring":                                      # a disc with a hole: a disc of negative mass
        m = shared(p.m, p.a**2, -p.b**2)
        I = np.stack([tensors.cylinder_inertia(m[0], p.a, 1.0), tensors.cylinder_inertia(m[1], p.b, 1.0)])
        return m, np.zeros((2, 3)), I
    if p.shape == "round bar":  # half a disc: from the centre of the disc to its own centre of mass, 4r/3π away
        m = shared(p.m, 2.0 * p.a * p.b, 0.5 * np.pi * p.a**2, 0.5 * np.pi * p.a**2)
        off = 4.0 * p.a / (3.0 * np.pi) * upright[0]
        half = tensors.parallel_axes(tensors.cylinder_inertia(m[1], p.a, 1.0), -m[1], off)
        x = np.stack([0.0 * off, off + 0.5 * p.b * upright[0], -off - 0.5 * p.b * upright[0]])
        return m, x, np.stack([tensors.box_inertia(m[0], np.array([p.b, 2.0 * p.a, 1.0])), half, half])
    boxes = boxes_of_angle(p)                                  # angle
    m = shared(p.m, *(np.prod(size) for size, _ in boxes))
    I = np.stack([tensors.box_inertia(k, size) for k, (size, _) in zip(m, boxes)])
    return m, np.stack([x for _, x in boxes]), I


def shared(m, *volumes):
    """Return the masses, in proportion to the volumes."""
    return m * np.array(volumes) / sum(volumes)


def boxes_of_angle(p):
    """Return (size, centre) of the two boxes of an L: legs a along x and b along y, both c thick, d high."""
    return ((np.array([p.a, p.c, p.d]), np.array([0.5 * p.a, 0.5 * p.c, 0.0])),
            (np.array([p.c, p.b - p.c, p.d]), np.array([0.5 * p.c, 0.5 * (p.b + p.c), 0.0])))


def outline(p):
    """Return the corners (k, 2) of a body that is a prism, counter-clockwise; the first corner sees all others."""
    return np.array({
        "box": [(-0.5 * p.a, -0.5 * p.b), (0.5 * p.a, -0.5 * p.b), (0.5 * p.a, 0.5 * p.b), (-0.5 * p.a, 0.5 * p.b)],
        "triangle": [(0.0, 0.0), (p.a, 0.0), (0.0, p.b)],
        "angle": [(p.c, p.c), (p.c, p.b), (0.0, p.b), (0.0, 0.0), (p.a, 0.0), (p.a, p.c)],
    }[p.shape])


def surface(p):
    """Return corners and triangles of a body with flat faces, and its volume."""
    if p.shape == "corner":
        x = np.array([[0.0, 0.0, 0.0], [p.a, 0.0, 0.0], [0.0, p.b, 0.0], [0.0, 0.0, p.c]])
        return x, np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]), p.a * p.b * p.c / 6.0
    corners, height = outline(p), {"box": p.c, "angle": p.d, "triangle": 1.0}[p.shape]
    k = len(corners)
    x = np.concatenate([np.column_stack([corners, np.full(k, z)]) for z in (-0.5 * height, 0.5 * height)])
    lids = [f for i in range(1, k - 1) for f in ((0, i + 1, i), (k, k + i, k + i + 1))]
    sides = [f for i in range(k) for j in ((i + 1) % k,) for f in ((i, j, k + j), (i, k + j, k + i))]
    area = {"box": p.a * p.b, "angle": p.a * p.c + p.c * (p.b - p.c), "triangle": 0.5 * p.a * p.b}[p.shape]
    return x, np.array(lids + sides), area * height


def mesh(p):
    """Return (density, corners, triangles)."""
    x, faces, volume = surface(p)
    return p.m / volume, x, faces


# ---------------------------------------------------------------------------------------------- truth

def truth(p, t):
    """The volume integral I = ∫ (|r|² 1 − r rᵀ) dm about the centre of mass, by methods that the lesson does not use.

    round about z       slices of squared radius q(z): Izz = ρ π/2 ∫ q² dz,  Ixx = ρ π ∫ (q²/4 + z² q) dz − m Z²;
                        q is piecewise polynomial, so Gauss's quadrature is exact
    of boxes            eight points in each, at ±edge/√12
    corner of a box     ∫x² = V a²/10,  ∫x y = V a b/20
    ring, triangle      ½ m (a² + b²),  m (sum of the squared sides)/36
    two discs           ½ Σ m r² + m₁ m₂/(m₁ + m₂) c²
    bar, round ends     strips across it, by Gauss's quadrature
    Source: any text of mechanics; Stroud 1971 for the quadratures.
    """
    if p.shape in ("ball", "cylinder", "capsule", "dumbbell"):
        return six(revolved(p.m, profile(p)))
    if p.shape == "corner":
        I = [
            [3.0 * (p.b**2 + p.c**2), p.a * p.b, p.a * p.c],
            [p.a * p.b, 3.0 * (p.a**2 + p.c**2), p.b * p.c],
            [p.a * p.c, p.b * p.c, 3.0 * (p.a**2 + p.b**2)],
        ]
        return six(p.m / 80.0 * np.array(I))
    if p.shape == "ring":
        return np.array([0.5 * p.m * (p.a**2 + p.b**2)])
    if p.shape == "triangle":
        return np.array([p.m * 2.0 * (p.a**2 + p.b**2) / 36.0])
    if p.shape == "two discs":
        m_a, m_b = shared(p.m, p.a**2, p.b**2)
        return np.array([0.5 * (m_a * p.a**2 + m_b * p.b**2) + m_a * m_b / p.m * p.c**2])
    if p.shape == "round bar":
        return np.array([round_bar(p)])
    boxes = ((np.array([p.a, p.b, p.c]), np.zeros(3)),) if p.shape in ("box", "turned bar") else boxes_of_angle(p)
    angle = TURN if p.shape == "turned bar" else 0.0
    signs = np.array([[i, j, k] for i in (-1, 1) for j in (-1, 1) for k in (-1, 1)]) / np.sqrt(12.0)
    x = np.concatenate([centre + signs * size for size, centre in boxes])
    c, s = np.cos(angle), np.sin(angle)
    x = np.column_stack([c * x[:, 0] - s * x[:, 1], s * x[:, 0] + c * x[:, 1], x[:, 2]])
    m = np.repeat(shared(p.m, *(np.prod(size) for size, _ in boxes)), 8) / 8.0
    r = x - m @ x / p.m
    return six(sum(k * (y @ y * np.eye(3) - np.outer(y, y)) for k, y in zip(m, r)))


def profile(p):
    """Return the pieces (z_low, z_high, q) of a solid of revolution, q(z) its squared radius."""
    ball = lambda r, z0: (z0 - r, z0 + r, lambda z: r * r - (z - z0) ** 2)
    if p.shape == "ball":
        return [ball(p.a, 0.0)]
    if p.shape == "dumbbell":
        return [ball(p.a, 0.0), ball(p.b, p.c)]
    tube = (-0.5 * p.b, 0.5 * p.b, lambda z: p.a**2 + 0.0 * z)
    if p.shape == "cylinder":
        return [tube]
    low, high = ball(p.a, -0.5 * p.b), ball(p.a, 0.5 * p.b)
    return [(low[0], -0.5 * p.b, low[2]), tube, (0.5 * p.b, high[1], high[2])]


def revolved(m, pieces):
    """Return the tensor of a solid of revolution about its centre of mass."""
    nodes, weights = np.polynomial.legendre.leggauss(6)
    V = first = zz = xx = 0.0
    for low, high, q in pieces:
        z, w = 0.5 * (high + low) + 0.5 * (high - low) * nodes, 0.5 * np.pi * (high - low) * weights
        V = V + w @ q(z)
        first = first + w @ (z * q(z))
        zz = zz + 0.5 * w @ q(z) ** 2
        xx = xx + w @ (0.25 * q(z) ** 2 + z * z * q(z))
    across = m * (xx / V - (first / V) ** 2)
    return np.diag([across, across, m * zz / V])


def round_bar(p):
    """Return ∫ (x² + y²) dm over strips of half width w at x = ½b + a sin θ.

    4 ∫ (x² w + w³/3) dx on one side, w = a cos θ at the end.
    """
    nodes, weights = np.polynomial.legendre.leggauss(40)
    theta, weights = 0.25 * np.pi * (nodes + 1.0), 0.25 * np.pi * weights
    x, w = 0.5 * p.b + p.a * np.sin(theta), p.a * np.cos(theta)
    ends = 4.0 * weights @ ((x * x * w + w**3 / 3.0) * w)
    middle = 4.0 * ((0.5 * p.b) ** 3 / 3.0 * p.a + p.a**3 / 3.0 * 0.5 * p.b)
    return p.m * (ends + middle) / (2.0 * p.a * p.b + np.pi * p.a**2)


def sanity_checks():
    """Return Findings: the numbers of the docstring, and pybullet's centre of mass."""
    capsule, dumbbell, uneven = CASES["capsule"], CASES["dumbbell"], CASES["uneven dumbbell"]
    too_much = lambda p, k: by_bounding_box(p, T)[k] / truth(p, T)[k] - 1.0
    claims = (states("relative excess of a capsule's moment across its axis in pybullet [-]", too_much(capsule, 0),
                     0.28, 0.005),
              states("and along [-]", too_much(capsule, 2), 0.41, 0.005),
              states("the same of a dumbbell [-]", too_much(dumbbell, 0), -0.34, 0.005),
              states("and along [-]", too_much(dumbbell, 2), 0.67, 0.005))
    if not PYBULLET.installed():
        return claims
    bullet = Bullet(1.0)
    body = bullet.pb.createMultiBody(uneven.m, shape_of(bullet.pb, uneven))
    believed = bullet.pb.getDynamicsInfo(body, -1)[3]
    bullet.close()
    return (*claims, states("centre of an uneven dumbbell in pybullet: the origin of the shape [m]", believed,
                            np.zeros(3), 0.0))


def round_off(p, dt):
    """A few dozen operations on numbers of one sign, each rounded by 1.1e-16, give 1e-13, for us and the engines."""
    return 1e-13


# ---------------------------------------------------------------------------------------------- engines

def box_around(m, size, twelfth=1.0 / 12.0):
    """Return the moments of the box around a shape as entries of a tensor."""
    return np.concatenate([m * twelfth * (size @ size - size * size), np.zeros(3)])


def extent(p):
    """Return the edges [m] of the axis-aligned box around the shape."""
    if p.shape == "capsule":
        return np.array([2.0 * p.a, 2.0 * p.a, p.b + 2.0 * p.a])
    if p.shape == "dumbbell":
        wide = 2.0 * max(p.a, p.b)
        return np.array([wide, wide, p.a + p.b + p.c])
    if p.shape == "turned bar":
        along = p.a * np.cos(TURN) + p.b * np.sin(TURN)
        return np.array([along, along, p.c])
    return np.array([p.a, p.b, p.d if p.shape == "angle" else p.c])


def by_bounding_box(p, t):
    """Return m (b² + c²)/12 with the edges of the box around the shape; for a capsule 0.08333333 replaces 1/12.

    Source: Bullet, btCompoundShape::calculateLocalInertia ("approximation: take the inertia from the aabb for now"),
    btCapsuleShape.
    """
    return box_around(p.m, extent(p), 0.08333333 if p.shape == "capsule" else 1.0 / 12.0)


def by_fat_box(p, t):
    """Return the same for a hull, with its margin of 1 mm added three times on each side, and 0.08333333 for 1/12.

    Source: Bullet, btPolyhedralConvexShape: recalcLocalAabb, getNonvirtualAabb and calculateLocalInertia each add it.
    """
    return box_around(p.m, extent(p) + 6.0 * MARGIN, 0.08333333)


def by_nothing(p, t):
    """Return zero: Bullet gives triangle meshes no inertia, so no torque rotates them."""
    return np.zeros(6)


def by_flat_box(p, t):
    """Return m (l² + w²)/12 of the box around the bar.  Source: Chipmunk, cpMomentForSegment."""
    return np.array([p.m * ((p.b + 2.0 * p.a) ** 2 + (2.0 * p.a) ** 2) / 12.0])


def shape_of(pb, p, concave=False):
    """Make the collision shape, as a user would write it."""
    make = lambda kind, **how: pb.createCollisionShape(kind, **how)
    several = lambda kind, at, **how: pb.createCollisionShapeArray(shapeTypes=[kind] * len(at),
                                                                   collisionFramePositions=at, **how)
    if p.shape == "ball":
        return make(pb.GEOM_SPHERE, radius=p.a)
    if p.shape == "box":
        return make(pb.GEOM_BOX, halfExtents=[0.5 * p.a, 0.5 * p.b, 0.5 * p.c])
    if p.shape in ("cylinder", "capsule"):
        return make(pb.GEOM_CYLINDER if p.shape == "cylinder" else pb.GEOM_CAPSULE, radius=p.a, height=p.b)
    if p.shape == "dumbbell":
        return several(pb.GEOM_SPHERE, [[0.0, 0.0, 0.0], [0.0, 0.0, p.c]], radii=[p.a, p.b])
    if p.shape == "turned bar":
        q = [0.0, 0.0, np.sin(0.5 * TURN), np.cos(0.5 * TURN)]
        half = [0.5 * p.a, 0.5 * p.b, 0.5 * p.c]
        return several(pb.GEOM_BOX, [[0.0] * 3], halfExtents=[half], collisionFrameOrientations=[q])
    if p.shape == "angle":
        boxes = boxes_of_angle(p)
        halves = [(0.5 * size).tolist() for size, _ in boxes]
        return several(pb.GEOM_BOX, [x.tolist() for _, x in boxes], halfExtents=halves)
    x, faces, _ = surface(p)
    if concave:
        indices, flags = faces.ravel().tolist(), pb.GEOM_FORCE_CONCAVE_TRIMESH
        return make(pb.GEOM_MESH, vertices=x.tolist(), indices=indices, flags=flags)
    return make(pb.GEOM_MESH, vertices=x.tolist())


def bullet_make(p, dt, concave=False, told=False):
    """Make a body of reduced coordinates; for maximal ones getDynamicsInfo does not return the inertial frame."""
    bullet = Bullet(1.0)
    pb, frame = bullet.pb, {}
    if told:
        moments, R = np.linalg.eigh(tensor_of(truth(p, 1.0)))
        R[:, 2] *= np.linalg.det(R)  # right-handed
        frame = {"baseInertialFrameOrientation": quaternion(R).tolist(),
                 "baseInertialFramePosition": centre(p).tolist()}
    body = pb.createMultiBody(p.m, shape_of(pb, p, concave), **frame)
    if told:
        pb.changeDynamics(body, -1, mass=p.m, localInertiaDiagonal=moments.tolist())

    def read():
        info = pb.getDynamicsInfo(body, -1)
        R = np.array(pb.getMatrixFromQuaternion(info[4])).reshape(3, 3)
        return six(R @ np.diag(info[2]) @ R.T)

    return EngineRun(lambda: None, read, bullet.close)


def centre(p):
    """Return the centre of mass [m] of the bodies for which a user of pybullet must set it."""
    if p.shape == "corner":
        return np.array([p.a, p.b, p.c]) / 4.0
    if p.shape == "angle":
        boxes = boxes_of_angle(p)
        return shared(1.0, *(np.prod(size) for size, _ in boxes)) @ np.stack([x for _, x in boxes])
    return np.array([0.0, 0.0, p.c * p.b**3 / (p.a**3 + p.b**3)]) if p.shape == "dumbbell" else np.zeros(3)


def tensor_of(entries):
    xx, yy, zz, xy, xz, yz = entries
    return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])


def quaternion(R):
    """Return (x, y, z, w), pybullet's order: an eigenvector of a symmetric matrix of R's entries.

    Its eigenvalue is 3 (Bar-Itzhack 2000).
    """
    K = np.array([[R[0, 0] - R[1, 1] - R[2, 2], R[1, 0] + R[0, 1], R[2, 0] + R[0, 2], R[2, 1] - R[1, 2]],
                  [R[1, 0] + R[0, 1], R[1, 1] - R[0, 0] - R[2, 2], R[2, 1] + R[1, 2], R[0, 2] - R[2, 0]],
                  [R[2, 0] + R[0, 2], R[2, 1] + R[1, 2], R[2, 2] - R[0, 0] - R[1, 1], R[1, 0] - R[0, 1]],
                  [R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1], R[0, 0] + R[1, 1] + R[2, 2]]])
    return np.linalg.eigh(K)[1][:, -1]


def pymunk_make(p, dt):
    """Use pymunk's moment_for_ functions; two discs are a body that sums its shapes by density."""
    import pymunk
    if p.shape == "ring":
        moment = pymunk.moment_for_circle(p.m, p.b, p.a)
    elif p.shape == "triangle":
        moment = pymunk.moment_for_poly(p.m, outline(p).tolist(), (-p.a / 3.0, -p.b / 3.0))
    elif p.shape == "round bar":
        moment = pymunk.moment_for_segment(p.m, (-0.5 * p.b, 0.0), (0.5 * p.b, 0.0), p.a)
    else:
        space, body = pymunk.Space(), pymunk.Body()
        shapes = [pymunk.Circle(body, p.a), pymunk.Circle(body, p.b, (p.c, 0.0))]
        for shape in shapes:
            shape.density = p.m / (np.pi * (p.a**2 + p.b**2))
        space.add(body, *shapes)
        moment = body.moment
    return one_reading(lambda: np.array([moment]))


def only(*shapes):
    """Return the field `supports` of a Runner that supports these bodies."""
    return cases_with("shape", shapes, CASES)


PARTS_KNOWN = ("ball", "box", "cylinder", "capsule", "dumbbell", "turned bar", "angle", "ring", "two discs",
               "round bar")
FLAT_FACES = ("box", "angle", "corner", "triangle")            # only they have triangles
BOXED = ("capsule", "dumbbell", "turned bar", "angle")         # for which pybullet uses the surrounding box
EXACTLY = {"order": EXACT, "limit": round_off,
           "predicted": "nothing is refined: only round-off is left, and the limit bounds it"}
RUNNERS = (
    ours(PARTS, supports=only(*PARTS_KNOWN), **EXACTLY),
    ours(TRIANGLES, supports=only(*FLAT_FACES), **EXACTLY),
    engine(PYBULLET, "", bullet_make, "createMultiBody with the shape and a mass; read by getDynamicsInfo",
           supports=only("ball", "box", "cylinder"), **EXACTLY),
    engine(PYBULLET, "automatic", bullet_make, "createMultiBody with its defaults", supports=only(*BOXED), **EXACTLY,
           departure=Departure("it uses the box around the shape, along the axes of the shape, instead of the shape",
                               by_bounding_box, Whose.DEFAULT)),
    engine(PYBULLET, "hull", bullet_make, "GEOM_MESH from corners", supports=only("corner"), **EXACTLY,
           departure=Departure("it uses the box around the hull instead of the hull, and makes it 6 mm larger",
                               by_fat_box, Whose.DEFAULT)),
    engine(PYBULLET, "concave mesh", partial(bullet_make, concave=True), "GEOM_MESH with GEOM_FORCE_CONCAVE_TRIMESH",
           supports=only("corner"), **EXACTLY,
           departure=Departure("it gives triangle meshes no inertia, so that no torque rotates them", by_nothing,
                               Whose.DEFAULT)),
    engine(PYBULLET, "told", partial(bullet_make, told=True),
           "localInertiaDiagonal and mass in one changeDynamics; baseInertialFramePosition and -Orientation: centre "
           "and principal axes",
           supports=only(*BOXED, "corner"), **EXACTLY),
    engine(PYMUNK, "", pymunk_make, "moment_for_circle, moment_for_poly, or shapes with a density",
           supports=only("ring", "triangle", "two discs"), **EXACTLY),
    engine(PYMUNK, "Segment", pymunk_make, "moment_for_segment", supports=only("round bar"), **EXACTLY,
           departure=Departure("it uses the box around the bar instead of the bar", by_flat_box, Whose.LAW)),
)


# ---------------------------------------------------------------------------------------------- picture

def silhouette(p):
    """Return the closed outline (k, 2) [m] of a body: seen from the side if it is round about z, else from above."""
    turns = lambda low, high: np.linspace(low, high, 25)
    arc = lambda r, x, y, low, high: np.array([(x + r * np.cos(t), y + r * np.sin(t)) for t in turns(low, high)])
    if p.shape == "capsule":
        return np.concatenate([arc(p.a, 0.0, 0.5 * p.b, 0.0, np.pi), arc(p.a, 0.0, -0.5 * p.b, np.pi, 2.0 * np.pi)])
    if p.shape == "round bar":
        right = arc(p.a, 0.5 * p.b, 0.0, -0.5 * np.pi, 0.5 * np.pi)
        return np.concatenate([right, arc(p.a, -0.5 * p.b, 0.0, 0.5 * np.pi, 1.5 * np.pi)])
    if p.shape in ("dumbbell", "two discs"):
        far = (0.0, p.c) if p.shape == "dumbbell" else (p.c, 0.0)
        turn = np.arctan2(far[1], far[0]) + np.pi
        first = arc(p.a, 0.0, 0.0, turn - np.pi, turn + np.pi)
        return np.concatenate([first, arc(p.b, *far, turn, turn + 2.0 * np.pi)])
    if p.shape in ("ball", "ring"):
        return arc(p.a, 0.0, 0.0, 0.0, 2.0 * np.pi)
    if p.shape == "cylinder":
        return np.array([(-p.a, -0.5 * p.b), (p.a, -0.5 * p.b), (p.a, 0.5 * p.b), (-p.a, 0.5 * p.b)])
    if p.shape == "turned bar":
        corners = outline(p._replace(shape="box"))
        return corners @ np.array([[np.cos(TURN), np.sin(TURN)], [-np.sin(TURN), np.cos(TURN)]])
    return outline(p._replace(shape="triangle") if p.shape == "corner" else p)


def gallery():
    """Return all outlines, five per row, and the pairs of points that their lines join."""
    drawn, pairs, across, down = [], [], 0.0, 0.0
    for k, p in enumerate(CASES.values()):
        if k % 5 == 0:
            across, down = 0.0, down - 1.4
        shape, first = silhouette(p), sum(map(len, drawn))
        low, high = shape.min(axis=0), shape.max(axis=0)
        drawn.append(shape + np.array([across - low[0], down - 0.5 * (low[1] + high[1])]))
        pairs += outlines(len(shape), 1, first)
        across += high[0] - low[0] + 0.25
    return np.concatenate(drawn), pairs


def points(observed, p):
    return gallery()[0]


def links(p):
    return gallery()[1]


SCENE = Scene(
    title="Inertia tensors", lesson="inertia_tensors",
    cases=CASES, **ANSWER,
    runners=RUNNERS,
    start=start, run=run, observe=observe,
    truth=truth,
    truth_uncertainty=1e-14,  # of sums and quadratures of at most a hundred terms, each rounded by 1.1e-16
    quantity_names=quantity_names,
    published_states=((1.0, (0.072, 0.072, 0.072, 0.0, 0.0, 0.0), 1e-14),),  # ⅖ m R² of the ball
    sanity_checks=sanity_checks,
    points=points, links=links,
    uses=("masses and positions of the parts", "or corners and triangles"),
    full_loop="nothing moves here, so there is no loop",
    ablations={
        "motion": "lesson 5 rotates these bodies",
        "density that varies": "a body of parts can have it",
        "collision": "lesson 6 builds it",
    },
)
