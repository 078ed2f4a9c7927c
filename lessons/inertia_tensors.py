"""Lesson 4.  Resistance to rotation: centre of mass, momenta, and the inertia tensor.

    P = M v        mass resists a change of velocity: one number, the same in all directions
    L = I ω        the tensor resists a change of rotation: a symmetric matrix, different in each direction

Symbols: m [kg] · x [m] position · v [m/s] · X [m] centre of mass · r [m] offset from it · P [kg m/s] linear and
L [kg m²/s] angular momentum · omega [rad/s] · I (3, 3) [kg m²] inertia tensor, I_body in body axes ·
R (3, 3) rotation from body to world: its columns are the body's axes.  Vectors are (3,), float.

    I = ⎡ Ixx  Ixy  Ixz ⎤      Ixx    resistance about x
        ⎢ Ixy  Iyy  Iyz ⎥      Ixy    coupling: rotation about x gives L a component along y
        ⎣ Ixz  Iyz  Izz ⎦

The sign of a coupling is part of the entry, so that L = I ω holds as it stands.  Some texts call the number with the
other sign the product of inertia Ixy, and put −Ixy into the matrix.
*Left out:* bodies that deform; the rotation of a body with this tensor, which is lesson 5.
"""

from typing import NamedTuple

import numpy as np

from solutions.checks import BadInput, check_finite, check_positive
from solutions.vectors import cross, dot, inverse

__all__ = [
    "MOMENT_ROUND_OFF", "MassProperties", "angular_momentum", "box_inertia", "capsule_inertia",
    "centre_of_mass", "check_closed", "check_inertia", "combine", "cylinder_inertia",
    "linear_momentum", "mesh_body", "mesh_integrals", "my_mesh", "parallel_axes", "point_mass_inertia",
    "principal_axes", "rolling_time", "solid_cylinder_is", "sphere_inertia", "world_inertia", "world_inverse_inertia",
]

MOMENT_ROUND_OFF = 1e-14     # accuracy of a moment relative to the largest [-]: a few dozen roundings of 1.1e-16


class MassProperties(NamedTuple):
    """The properties of a body that determine its rigid motion."""
    m: float                  # mass [kg]
    x: np.ndarray             # (3,) centre of mass [m]
    I: np.ndarray             # (3, 3) inertia tensor about the centre of mass [kg m²]


# ---------------------------------------------------------------------------------------------- momenta of points

def centre_of_mass(m, x):
    """Return (M, X): total mass M [kg] and centre of mass X (3,) [m] of n points.

    M = Σ mᵢ,   X = Σ mᵢ xᵢ / M            m (n,), x (n, 3)

    The centre moves like a single point of mass M under the sum of all forces: M Ẍ = F = Σ fᵢ.
    A single mass may be zero, or negative for a hole.
    Raises BadInput unless M is finite and above zero: check_positive("total mass [kg]", M).
    *Source:* first lecture deck, “Center of Mass”.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 4.1: centre_of_mass")


def linear_momentum(m, v):
    """Return P [kg m/s] (3,) of n points: m (n,), v (n, 3).

    P = Σ mᵢ vᵢ = M Ẋ,   dP/dt = F         constant without external forces

    Here and in the following functions, each mass and the sum of all may also be zero or negative.
    *Source:* first lecture deck, “Linear Momentum”.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 4.2: linear_momentum")


def angular_momentum(m, x, v, about):
    """Return L [kg m²/s] (3,) of n points about the point `about` (3,): m (n,), x and v (n, 3).

    L = Σ (xᵢ − about) × mᵢ vᵢ,   dL/dt = τ = Σ (xᵢ − about) × fᵢ

    If the points rotate as one body with ω about their centre of mass, L about the centre is I ω.
    *Source:* first lecture deck, “Angular Momentum”.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 4.3: angular_momentum")


# ---------------------------------------------------------------------------------------------- tensors

def point_mass_inertia(m, r):
    """Return I [kg m²] (3, 3) of n points with masses m (n,) at offsets r (n, 3) [m] from the reference point of I.

    *Find* its entries.  If the points turn rigidly with ω, each has the velocity ω × r, and their angular momentum
    about the reference point is  L = Σ m r × (ω × r).  The tensor is the matrix for which L = I ω for every ω.

    *Source:* first lecture deck, “Inertia Tensor”.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 4.4: point_mass_inertia")


def box_inertia(m, size):
    """Return I_body [kg m²] (3, 3) of a uniform box about its centre; size (3,) [m] is its full edges along x, y, z.

    *Find* it from the volume integral  Ixx = ∫∫∫ ρ (y² + z²) dx dy dz  with ρ = m/(a b c) and a, b, c = size.  The
    other two moments follow by exchanging axes, and every product of inertia is zero by symmetry.

    m < 0 is allowed for this solid and the following ones: a hole is a body of negative mass.  An edge of zero is
    allowed: a plate or a rod.
    *Source:* first lecture deck, “Inertia Tensor”, the volume integral.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 4.5: box_inertia")


def sphere_inertia(m, radius):
    """Return I_body [kg m²] (3, 3) of a uniform ball of this radius [m] about its centre.

    *Find* its moment.  The three moments are equal.  Their sum is  ∫ 2 r² dm,  and this integral over shells of radius
    r is easy.
    *Source:* first lecture deck, “Inertia Tensor”, the volume integral.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 4.6: sphere_inertia")


def cylinder_inertia(m, radius, length):
    """Return I_body [kg m²] (3, 3) of a uniform cylinder about its centre; its axis is z.

    *Find* Izz and Ixx = Iyy by the volume integrals at the top of this file.  `length` is along the axis.

    length = 0 is a disc, radius = 0 a rod: do not divide by either.
    *Source:* any text of mechanics; e.g. Landau and Lifshitz, Mechanics, § 32.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 4.7: cylinder_inertia")


def capsule_inertia(m, radius, length):
    """Return I_body [kg m²] (3, 3) of a uniform capsule about its centre: a cylinder along z with two half balls.

    `length` is that of the cylinder.  The mass is divided in proportion to volume, m_c for the cylinder and m_s
    for the two half balls together:
        m_c = m length/(length + 4/3 radius),   m_s = m − m_c
    *Find* Izz and Ixx = Iyy: add the tensors of all parts about the capsule's centre.  The centre of mass of a half
    ball is not in its flat face.

    length = 0 is a ball, radius = 0 a rod; with both zero there is no body.
    *Source:* the parallel-axis theorem, below; Eberly, “Game physics”, 2003.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 4.8: capsule_inertia")


# ---------------------------------------------------------------------------------------------- from body to world

def world_inertia(I_body, R):
    """Return I [kg m²] (3, 3) in world axes of a body with orientation R.

    *Find* it.  In the body's own axes L = I_body ω.  R converts the components of a vector from body axes to world
    axes, and Rᵀ converts them back.  In world axes L = I ω must hold for the same vectors.

    I_body is constant; I changes whenever the body rotates.
    *Source:* first lecture deck, I(t) = R(t) I_body R(t)ᵀ.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 4.9: world_inertia")


def world_inverse_inertia(I_body, R):
    """Return I⁻¹ [1/(kg m²)] (3, 3) in world axes: it converts a torque to a change of ω.

    *Find* it from the tensor in world axes, and from R⁻¹ = Rᵀ: only I_body, which is constant, needs to be inverted.

    inverse, given in vectors.py, inverts a symmetric matrix.
    *Source:* first lecture deck.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 4.10: world_inverse_inertia")


# ---------------------------------------------------------------------------------------------- composite bodies

def parallel_axes(I, m, d):
    """Return the tensor [kg m²] (3, 3) about a point at the offset d (3,) [m] from the centre, from I about the centre.

    *Find* it.  About that point, the offset of a part of the body is d plus its offset from the centre of mass.  Insert
    this into  Σ m r × (ω × r),  and use that the offsets from the centre of mass, times the masses, add up to zero.

    The sign of d does not matter.  The moments are smallest about the centre of mass.  The same formula with −m leads
    back from the point to the centre.
    *Source:* Huygens 1673; Steiner 1840.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 4.11: parallel_axes")


def combine(m, x, I):
    """Return the MassProperties of n rigidly connected bodies: m (n,), centres x (n, 3), I (n, 3, 3) about these.

    M, X = centre_of_mass,   I = Σ of all Iᵢ, each moved to X by parallel_axes

    A body of negative mass is a hole.  All tensors are in the same axes: use world_inertia first for a rotated part.
    Do not sum about the origin of the world: for a body far away, most digits would be lost.
    Raises BadInput like centre_of_mass; the order of the bodies does not matter.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 4.12: combine")


def principal_axes(I):
    """Return (moments, R): principal moments (3,) [kg m²], ascending, and axes R (3, 3), right-handed columns.

    I = R diag(moments) Rᵀ        L is parallel to ω about these axes; about no others if the moments differ

    np.linalg.eigh(I) returns moments and columns.  The columns can be left-handed, det R = −1; then reverse the sign of
    the last one.  Moments may be negative: those of a hole are.
    *Source:* Euler 1765; Landau and Lifshitz, Mechanics, § 32.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 4.13: principal_axes")


def check_inertia(I):
    """Raise BadInput unless I (3, 3) can be the tensor of a body with thickness.

    I₁ ≤ I₂ ≤ I₃ are its principal moments and ε = MOMENT_ROUND_OFF.  The first argument of BadInput is one of
    "an entry of the inertia tensor [kg m²]"           infinite or NaN: check_finite(thing, I)
    "the asymmetry of an inertia tensor [kg m²]"       max|I − Iᵀ| > ε max|I|
    "the smallest principal moment [kg m²]"            I₁ ≤ ε I₃: no resistance; a line of points has I₁ = 0
    "the largest principal moment [kg m²]"             I₃ > (I₁ + I₂)(1 + ε): impossible, I₁ + I₂ − I₃ = 2 ∫ z² dm ≥ 0

    The second argument, its value, is the entry, the asymmetry or the moment.
    A plate without thickness has I₃ = I₁ + I₂ and is accepted.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 4.14: check_inertia")


# ---------------------------------------------------------------------------------------------- triangle meshes

def mesh_integrals(x, faces):
    """Return integrals over a closed mesh, about the origin: (volume ∫dV, first ∫x dV (3,), second ∫x xᵀ dV (3, 3)).

    x (n, 3) [m] corners; faces (k, 3) numbers of corners, counter-clockwise as seen from outside.

    Each triangle a, b, c and the origin form a tetrahedron of volume w/6,  w = a · (b × c).  If the origin is
    on the outer side of the triangle, w is negative, and the tetrahedron is subtracted.  With s = a + b + c

        volume = Σ w/6,   first = Σ w/24 s,   second = Σ w/120 (a aᵀ + b bᵀ + c cᵀ + s sᵀ)

    The sums are exact, because the integrands are polynomials.
    The worked answer writes out the products in loops: arrays of three numbers for each triangle would take longer.
    *Source:* Mirtich 1996 and Eberly 2002, “Polyhedral mass properties”, do the same with the divergence theorem.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 4.15: mesh_integrals")


def check_closed(count, faces):
    """Raise BadInput unless the triangles close a surface and agree on its outside; count is the number of corners.

    "a triangle's corner"                      a number that is not one of 0 … count − 1
    "a corner on an open edge: number"         the corner i of any edge i → j without a partner

    A triangle (i, j, k) has the edges i → j, j → k, k → i.  In a closed mesh whose triangles are all
    counter-clockwise as seen from outside, every edge i → j has a partner j → i in a neighbour: both occur
    equally often. (Represent an edge i → j by the integer i · count + j.  Then the sorted list of the edges
    equals the sorted list of the reversed edges.)
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 4.16: check_closed")


def mesh_body(density, x, faces):
    """Return the MassProperties of uniform density [kg/m³] inside a closed mesh: corners x (n, 3) [m], faces (k, 3).

    Let (V, S, Q) be the mesh_integrals of x − o, about a point o of the body itself, the first corner:
        m = ρ V,   centre = o + c,  c = S/V,   C = Q − V c cᵀ,   I = ρ (tr C 1 − C)

    If the integrals were about the origin of the world, each tetrahedron would extend from there to its triangle.  At
    the distance D, products of size D³ cancel in w, and squares of size D² multiply what rounding leaves.  A body of
    one metre would lose half of its digits at D = 30 m.

    Raises BadInput unless the density is positive, check_positive("density [kg/m³]", density), the corners are finite
    and the mesh is closed (check_closed).
    Raises it with "the volume inside the mesh [m³]" unless V > ε e³, e = max|x − o| over all coordinates,
    ε = MOMENT_ROUND_OFF: then its triangles are clockwise, or it is flat and its volume only round-off.
    *Source:* as for mesh_integrals.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 4.17: mesh_body")


# ---------------------------------------------------------------------------------------------- why?

def rolling_time(I, m, radius, way, slope, g):
    """Return the time [s] in which a round body rolls down a slope from rest, without slipping.

    *Find* it before you run anything.  The body has the mass m [kg], the radius [m] and the moment I [kg m²] about its
    axis.  It rolls `way` [m] down a slope of the angle `slope` [rad].  What share of its energy goes into its rotation?
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 4.18: rolling_time")


def solid_cylinder_is():
    """Return the letter of the solid cylinder in the figure of the notebook: "A", "B", "C" or "D".

    A solid ball, a hollow ball, a solid cylinder and a hoop roll down the same slope without slipping.  The curves are
    their ways over time.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 4.19: solid_cylinder_is")


def my_mesh(volume):
    """Return the corners x (n, 3) [m] and the faces (k, 3) of a body of your own, a closed mesh.

    *Make it*: each face has the numbers of three corners, counter-clockwise as seen from outside.  Many bodies are
    right.  The judge demands:

    - The mesh is closed, and its volume is `volume` [m³] to 1 %.
    - All three principal moments are equal to 1 %, as those of a ball and of a cube are.
    - They are at least 1.3 times those of a ball of the same mass and volume; a cube has 1.08 times.
    """
    # YOUR CODE HERE
    raise NotImplementedError("Exercise 4.20: my_mesh")
