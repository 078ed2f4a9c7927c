"""Lesson 7: impacts with a wrong sign, mass, lever arm or case."""

import itertools

import numpy as np

from solutions import impulses as worked
from solutions.checks import Diverged, check_positive
from solutions.rotation import cross, point_velocity, skew

from . import collection, variants

wrong, right, edit, MUTANTS = collection(worked)
tangential = worked.tangential


# 7.1 ------------------------------------------------------------------------------------------------------------
@variants
def response(bounce=lambda e: 1.0 + e, leaves=True, all_of_v=False, sign=-1.0):
    def kinematic_response(v, n, e):
        v_n = v @ n
        if leaves and v_n >= 0.0:
            return v
        return -e * v if all_of_v else v + sign * bounce(e) * v_n * n
    return kinematic_response


@right("7.1", "by parts")
def kinematic_response(v, n, e):
    along, normal = v - np.dot(v, n) * n, np.dot(v, n) * n
    return along - e * normal if np.dot(v, n) < 0.0 else np.array(v)


wrong("7.1", "uses e in place of 1 + e")(response(bounce=lambda e: e))
wrong("7.1", "uses 1 − e in place of 1 + e")(response(bounce=lambda e: 1.0 - e))
wrong("7.1", "pulls back a body that leaves")(response(leaves=False))
wrong("7.1", "reverses all of v")(response(all_of_v=True))
wrong("7.1", "reverses the impulse, which pulls the body in")(response(sign=1.0))
edit("7.1", "changes its input", "v - (1.0 + e) * v_n * n", "np.subtract(v, (1.0 + e) * v_n * n, out=v)")
edit("7.1", "ignores slow approach", "v_n >= 0.0", "v_n >= -1e-3")
edit("7.1", "ignores approach slower than 10 nm/s", "v_n >= 0.0", "v_n >= -1e-8")
edit("7.1", "forgets the normal: subtracts a number from each component", "(1.0 + e) * v_n * n", "(1.0 + e) * v_n")
edit("7.1", "changes only bodies that leave", "v_n >= 0.0", "v_n <= 0.0")
edit("7.1", "reverses the normal velocity without e", "(1.0 + e) * v_n", "2.0 * v_n")
edit("7.1", "returns the normal velocity only", "else v - (1.0 + e) * v_n * n", "else -e * v_n * n")
edit("7.1", "scales the whole velocity by e", "v - (1.0 + e) * v_n * n", "e * (v - 2.0 * v_n * n)")
edit("7.1", "stops the normal velocity: omits e", "(1.0 + e) * v_n * n", "v_n * n")
edit("7.1", "omits the restitution where nothing moves along the surface",
     "return v if", "return -v if v_n < 0.0 and not tangential(v, n).any() else v if")
edit("7.1", "returns the velocity unchanged where one of its components is 0",
     "v_n >= 0.0", "v_n >= 0.0 or not v.all()")


# 7.2 ------------------------------------------------------------------------------------------------------------
@variants
def penalty(spring=-1.0, damper=-1.0, pulls=False, inside=lambda phi: phi < 0.0):
    def penalty_force(phi, v_n, stiffness, damping):
        f = spring * stiffness * phi + damper * damping * v_n
        return (f if pulls else max(0.0, f)) if inside(phi) else 0.0
    return penalty_force


@right("7.2", "by an if")
def penalty_force(phi, v_n, stiffness, damping):
    depth = max(0.0, -phi)
    f = stiffness * depth - damping * v_n
    return f if depth > 0.0 and f > 0.0 else 0.0


wrong("7.2", "pulls a body back that leaves fast")(penalty(pulls=True))
wrong("7.2", "reverses the damper")(penalty(damper=1.0))
wrong("7.2", "omits the damper")(penalty(damper=0.0))
wrong("7.2", "reverses the spring")(penalty(spring=1.0))
edit("7.2", "ignores a depth of a millimetre", "phi >= 0.0", "phi >= -1e-3")
edit("7.2", "damps at φ = 0, too", "phi >= 0.0", "phi > 0.0")
wrong("7.2", "damps outside, too")(penalty(inside=lambda phi: True))
edit("7.2", "ignores a depth of 1 nm", "phi >= 0.0", "phi >= -1e-9")
edit("7.2", "returns no force where the stiffness is zero", "phi >= 0.0", "phi >= 0.0 or stiffness == 0.0")
edit("7.2", "pushes outside only", "phi >= 0.0", "phi <= 0.0")
edit("7.2", "exchanges stiffness and damping", "-stiffness * phi - damping * v_n", "-damping * phi - stiffness * v_n")
edit("7.2", "takes the smaller of the two in place of the larger", "np.maximum", "np.minimum")
edit("7.2", "drops both minus signs", "-stiffness * phi - damping * v_n", "stiffness * phi + damping * v_n")
edit("7.2", "limits the spring, not the sum",
     "np.maximum(0.0, -stiffness * phi - damping * v_n)", "np.maximum(0.0, -stiffness * phi) - damping * v_n")
edit("7.2", "omits the damper for a body that leaves",
     "np.maximum(0.0, -stiffness * phi - damping * v_n)",
     "np.maximum(0.0, -stiffness * phi) + np.maximum(0.0, -damping * v_n)")
edit("7.2", "omits the damper for a body that approaches", "damping * v_n", "damping * np.maximum(0.0, v_n)")


# 7.3 ------------------------------------------------------------------------------------------------------------
@variants
def seen(side=1.0, sign=1.0, turns=1.0, swap=False):
    def relative_velocity_2d(a, b, r_a, r_b):
        r_a, r_b = (r_b, r_a) if swap else (r_a, r_b)
        spin = lambda omega, r: turns * omega * side * np.array([-r[1], r[0]])
        return sign * (a.v + spin(a.omega, r_a) - b.v - spin(b.omega, r_b))
    return relative_velocity_2d


@right("7.3", "in space")
def relative_velocity_2d(a, b, r_a, r_b):
    point = lambda body, r: np.append(body.v, 0.0) + np.cross([0.0, 0.0, body.omega], np.append(r, 0.0))
    return (point(a, r_a) - point(b, r_b))[:2]


wrong("7.3", "takes a positive ω as clockwise")(seen(side=-1.0))
wrong("7.3", "returns the velocity of b relative to a")(seen(sign=-1.0))
wrong("7.3", "omits the rotation")(seen(turns=0.0))
wrong("7.3", "exchanges the arms of the two bodies")(seen(swap=True))
ADDS_ROTATION_OF_B = edit("7.3", "adds the rotation of b in place of subtracting it", "- turn_b", "+ turn_b")
edit("7.3", "takes an immovable body to be at rest", "- b.v", "- (b.v if b.inv_mass else 0.0)")
edit("7.3", "omits the velocities of the centres", "a.v + turn_a - b.v - turn_b", "turn_a - turn_b")
edit("7.3", "adds the velocity of b", "- b.v - turn_b", "+ b.v + turn_b")
edit("7.3", "omits the rotation of b", "- b.v - turn_b", "- b.v")
edit("7.3", "multiplies ω by the arm itself, not by its perpendicular",
     "a.omega * np.array([-r_a[1], r_a[0]])", "a.omega * r_a")
edit("7.3", "exchanges the components of the arm without a sign",
     "np.array([-r_a[1], r_a[0]])", "np.array([r_a[1], r_a[0]])")
edit("7.3", "uses the arm of a for both bodies", "np.array([-r_b[1], r_b[0]])", "np.array([-r_a[1], r_a[0]])")
edit("7.3", "uses the arm of b for both bodies", "np.array([-r_a[1], r_a[0]])", "np.array([-r_b[1], r_b[0]])")
edit("7.3", "takes a body that does not rotate to be at rest", "- b.v", "- (b.v if b.omega else 0.0)")
edit("7.3", "omits the rotation of a body whose centre is at rest", "- turn_b", "- (turn_b if b.v.any() else 0.0)")


# 7.4 ------------------------------------------------------------------------------------------------------------
@variants
def size(bounce=lambda e: 1.0 + e, over=lambda k_n: 1.0 / k_n, leaves=True,
         checks=(worked.check_restitution, worked.check_inverse_mass)):
    def impulse_size(u_n, k_n, e):
        for check in checks:
            check(e if check is worked.check_restitution else k_n)
        return 0.0 if leaves and u_n >= 0.0 else -bounce(e) * u_n * over(k_n)
    return impulse_size


right("7.4", "the checks in a loop")(size())
wrong("7.4", "omits the restitution")(size(bounce=lambda e: 1.0))
wrong("7.4", "uses 1 − e in place of 1 + e")(size(bounce=lambda e: 1.0 - e))
wrong("7.4", "multiplies by the effective inverse mass in place of dividing by it")(size(over=lambda k_n: k_n))
wrong("7.4", "pulls at separating bodies")(size(leaves=False))
wrong("7.4", "accepts any restitution")(size(checks=(worked.check_inverse_mass,)))
edit("7.4", "accepts two immovable bodies", "check_inverse_mass(k_n)", "pass")
edit("7.4", "ignores slow approach", "u_n >= 0.0", "u_n >= -1e-3")
edit("7.4", "accepts any restitution for separating bodies", "check_restitution(e)",
     "if u_n >= 0.0:\n        return 0.0\n    check_restitution(e)")
edit("7.4", "accepts two immovable bodies that separate",
     "check_inverse_mass(k_n)", "if u_n < 0.0:\n        check_inverse_mass(k_n)")
edit("7.4", "ignores approach slower than 10 nm/s", "u_n >= 0.0", "u_n >= -1e-8")
edit("7.4", "omits the restitution of slow bodies", "(1.0 + e) * u_n", "(1.0 + e * (u_n < -1e-7)) * u_n")
edit("7.4", "refuses heavy bodies", "check_inverse_mass(k_n)", "check_inverse_mass(k_n if k_n > 1e-3 else 0.0)")
edit("7.4", "accepts a negative inverse mass", "check_inverse_mass(k_n)", "check_inverse_mass(abs(k_n))")
edit("7.4", "accepts any inverse mass that is not zero or below", "check_inverse_mass(k_n)",
     "if k_n <= 0.0:\n        check_inverse_mass(k_n)")
edit("7.4", "forgets the minus sign", "-(1.0 + e) * u_n / k_n", "(1.0 + e) * u_n / k_n")
edit("7.4", "returns the impulse for separating bodies only", "u_n >= 0.0", "u_n <= 0.0")
edit("7.4", "uses e in place of 1 + e", "(1.0 + e)", "e")
edit("7.4", "forgets the effective inverse mass", " / k_n", "")
edit("7.4", "returns the velocity after the impact", "-(1.0 + e) * u_n / k_n", "-e * u_n")
edit("7.4", "takes the size of the impulse, and so pushes bodies that separate",
     "0.0 if u_n >= 0.0 else -(1.0 + e) * u_n / k_n", "abs((1.0 + e) * u_n / k_n)")


# 7.5 and 7.7 ----------------------------------------------------------------------------------------------------
@variants
def flat_k(power=2, second=True, over=False, arm=lambda r, n: r[0] * n[1] - r[1] * n[0], mass=1.0):
    def effective_inverse_mass_2d(a, b, r_a, r_b, n):
        factor = lambda body: 1.0 / max(body.inv_inertia, 1e-300) if over else body.inv_inertia
        turn = lambda body, r: abs(arm(r, n)) ** power * factor(body)
        return mass * (a.inv_mass + b.inv_mass) + turn(a, r_a) + (turn(b, r_b) if second else 0.0)
    return effective_inverse_mass_2d


right("7.5", "body by body")(flat_k())
wrong("7.5", "does not square the lever arm r × n")(flat_k(power=1))
wrong("7.5", "omits the rotation of b")(flat_k(second=False))
wrong("7.5", "uses the inertia in place of its inverse")(flat_k(over=True))
wrong("7.5", "uses r · n in place of r × n")(flat_k(arm=lambda r, n: r @ n))
wrong("7.5", "forgets the masses")(flat_k(mass=0.0))
edit("7.5", "uses a mass of 1 kg where a is immovable", "a.inv_mass +", "(a.inv_mass or 1.0) +")
edit("7.5", "omits the rotation of a if its mass is infinite",
     "lever_a**2 * a.inv_inertia", "lever_a**2 * (a.inv_mass and a.inv_inertia)")
edit("7.5", "omits the rotation of b if its mass is infinite",
     "lever_b**2 * b.inv_inertia", "lever_b**2 * (b.inv_mass and b.inv_inertia)")
edit("7.5", "omits the mass of a body that cannot rotate", "a.inv_mass +", "(a.inv_inertia and a.inv_mass) +")
edit("7.5", "omits the rotation of a body that does not rotate yet",
     "lever_a**2 * a.inv_inertia", "lever_a**2 * (a.omega and a.inv_inertia)")
edit("7.5", "takes a body at rest to be immovable", "b.inv_mass +", "(b.inv_mass if b.v.any() else 0.0) +")


@variants
def solid_k(second=True, sign=1.0, mass=1.0, arm=lambda r, n: cross(r, n), back=lambda turn, r: cross(turn, r)):
    def effective_inverse_mass(a, b, r_a, r_b, n):
        give = lambda body, r: mass * body.inv_mass + sign * n @ back(body.inv_inertia @ arm(r, n), r)
        return give(a, r_a) + (give(b, r_b) if second else b.inv_mass)
    return effective_inverse_mass


@right("7.7", "as a square: (r × n) · I⁻¹ (r × n)")
def effective_inverse_mass(a, b, r_a, r_b, n):
    give = lambda body, r: body.inv_mass + np.cross(r, n) @ body.inv_inertia @ np.cross(r, n)
    return give(a, r_a) + give(b, r_b)


wrong("7.7", "omits the rotation of b")(solid_k(second=False))
wrong("7.7", "takes r × (…) in place of (…) × r")(solid_k(sign=-1.0))
wrong("7.7", "forgets the masses")(solid_k(mass=0.0))
wrong("7.7", "omits the last cross product with r")(solid_k(back=lambda turn, r: turn))
edit("7.7", "uses the inertia tensor of a in place of its inverse",
     "times(a.inv_inertia,", "times(np.linalg.pinv(a.inv_inertia),")
edit("7.7", "omits the rotation of a where b is immovable", "n @ turn_a", "(n @ turn_a if b.inv_mass else 0.0)")
edit("7.7", "omits the rotation of a if its mass is infinite", "n @ turn_a", "(n @ turn_a if a.inv_mass else 0.0)")
edit("7.7", "omits the mass of a body that cannot rotate", "a.inv_mass +", "a.inv_mass * a.inv_inertia.any() +")
edit("7.5", "omits the rotation of both bodies", "+ lever_a**2 * a.inv_inertia + lever_b**2 * b.inv_inertia", "")
edit("7.5", "uses the reduced mass: adds the masses", "a.inv_mass + b.inv_mass", "1.0 / (a.inv_mass + b.inv_mass)")
edit("7.5", "exchanges the inertias of the two bodies",
     "lever_a**2 * a.inv_inertia + lever_b**2 * b.inv_inertia",
     "lever_a**2 * b.inv_inertia + lever_b**2 * a.inv_inertia")
edit("7.5", "subtracts the rotation of b", "+ lever_b**2 * b.inv_inertia", "- lever_b**2 * b.inv_inertia")
edit("7.5", "subtracts the mass and the rotation of b",
     "b.inv_mass + lever_a**2 * a.inv_inertia + lever_b**2 * b.inv_inertia",
     "lever_a**2 * a.inv_inertia - (b.inv_mass + lever_b**2 * b.inv_inertia)")
edit("7.5", "subtracts the mass of b", "a.inv_mass + b.inv_mass", "a.inv_mass - b.inv_mass")
edit("7.5", "uses the length of the arm in place of r × n",
     "cross_2d(r_a, n), cross_2d(r_b, n)", "np.hypot(r_a[0], r_a[1]), np.hypot(r_b[0], r_b[1])")
edit("7.7", "omits the rotation of both bodies", "+ n @ turn_a + n @ turn_b", "")
edit("7.7", "subtracts the rotation of b", "+ n @ turn_b", "- n @ turn_b")
edit("7.7", "takes n × r in place of r × n", "cross(r_a, n)", "cross(n, r_a)")
edit("7.7", "exchanges the inertias of the two bodies",
     "times(a.inv_inertia, cross(r_a, n))", "times(b.inv_inertia, cross(r_a, n))")
edit("7.7", "uses the arm of a for both bodies",
     "cross(times(b.inv_inertia, cross(r_b, n)), r_b)", "cross(times(b.inv_inertia, cross(r_a, n)), r_a)")
edit("7.7", "forgets the inverse inertia", "times(a.inv_inertia, cross(r_a, n))", "cross(r_a, n)")
edit("7.7", "omits the rotation of a body that does not rotate yet",
     "n @ turn_a", "(n @ turn_a if a.omega.any() else 0.0)")


# 7.6 ------------------------------------------------------------------------------------------------------------
@variants
def pushed(mass=lambda m: m, inertia=lambda i: i, side=1.0, turns=True):
    def apply_impulse_2d(body, r, J):
        torque = side * (r[0] * J[1] - r[1] * J[0]) if turns else 0.0
        return worked.BodyState2D(body.v + mass(body.inv_mass) * J,
                           body.omega + inertia(body.inv_inertia) * torque, body.inv_mass, body.inv_inertia)
    return apply_impulse_2d


right("7.6", "by a torque")(pushed())
wrong("7.6", "multiplies by the mass in place of its inverse")(pushed(mass=lambda m: 1.0 / m if m else 0.0))
wrong("7.6", "multiplies by the inertia in place of its inverse")(pushed(inertia=lambda i: 1.0 / i if i else 0.0))
wrong("7.6", "turns the other way")(pushed(side=-1.0))
wrong("7.6", "omits the change of the rotation")(pushed(turns=False))
edit("7.6", "does not rotate a body whose mass is infinite", "body.inv_inertia * cross_2d",
     "(body.inv_mass and body.inv_inertia) * cross_2d")
edit("7.6", "does not move a body that cannot rotate", "body.inv_mass * J", "(body.inv_inertia and body.inv_mass) * J")
edit("7.6", "subtracts the impulse", "body.v + body.inv_mass * J", "body.v - body.inv_mass * J")
edit("7.6", "forgets the mass", "body.inv_mass * J", "J")
edit("7.6", "uses r · J in place of r × J", "cross_2d(r, J)", "(r @ J)")
edit("7.6", "uses the lengths of r and J in place of r × J", "cross_2d(r, J)", "np.sqrt((r @ r) * (J @ J))")
edit("7.6", "drops the sign of r × J", "cross_2d(r, J)", "abs(cross_2d(r, J))")
edit("7.6", "forgets the inertia", "body.inv_inertia * cross_2d", "cross_2d")
edit("7.6", "uses the inverse mass for the rotation", "body.inv_inertia * cross_2d", "body.inv_mass * cross_2d")
edit("7.6", "uses the inverse inertia for the velocity", "body.inv_mass * J", "body.inv_inertia * J")
edit("7.6", "does not start to rotate a body without rotation", "body.inv_inertia * cross_2d",
     "(body.omega and body.inv_inertia) * cross_2d")
edit("7.6", "does not start to move a body at rest",
     "body.inv_mass * J", "(body.inv_mass if body.v.any() else 0.0) * J")
edit("7.6", "divides by the inverse mass and by the inverse inertia", "return BodyState2D(",
     "v = body.v + (J / body.inv_mass if body.inv_mass else 0.0 * J); "
     "omega = body.omega + (cross_2d(r, J) / body.inv_inertia if body.inv_inertia else 0.0); return BodyState2D(")


# 7.8 ------------------------------------------------------------------------------------------------------------
@variants
def momenta(sign_a=1.0, sign_b=-1.0, arm=lambda r_a, r_b: (r_a, r_b)):
    def angular_momenta(L_a, L_b, r_a, r_b, J):
        r_a, r_b = arm(r_a, r_b)
        return L_a + sign_a * np.cross(r_a, J), L_b + sign_b * np.cross(r_b, J)
    return angular_momenta


@right("7.8", "with skew")
def angular_momenta(L_a, L_b, r_a, r_b, J):
    return L_a + skew(r_a) @ J, L_b + skew(r_b) @ -J


wrong("7.8", "gives b the same change as a")(momenta(sign_b=1.0))
edit("7.8", "takes J × r in place of r × J",
     "L_a + cross(r_a, J), L_b - cross(r_b, J)", "L_a - cross(r_a, J), L_b + cross(r_b, J)")
wrong("7.8", "does not change b")(momenta(sign_b=0.0))
wrong("7.8", "uses the same arm for both bodies")(momenta(arm=lambda r_a, r_b: (r_a, r_a)))
edit("7.8", "exchanges the signs of the two bodies",
     "L_a + cross(r_a, J), L_b - cross(r_b, J)", "L_a - cross(r_a, J), L_b + cross(r_b, J)")
edit("7.8", "exchanges the two arms",
     "L_a + cross(r_a, J), L_b - cross(r_b, J)", "L_a + cross(r_b, J), L_b - cross(r_a, J)")
edit("7.8", "returns the changes only", "L_a + cross(r_a, J), L_b - cross(r_b, J)", "cross(r_a, J), -cross(r_b, J)")
edit("7.8", "adds the impulse itself, not its moment", "L_a + cross(r_a, J), L_b - cross(r_b, J)", "L_a + J, L_b - J")
edit("7.8", "does not change a", "L_a + cross(r_a, J),", "L_a,")
edit("7.8", "does not start to rotate a body without angular momentum",
     "L_a + cross(r_a, J),", "L_a + (cross(r_a, J) if L_a.any() else 0.0 * J),")


# 7.9 ------------------------------------------------------------------------------------------------------------
@variants
def K_of(sign=-1.0, mass=lambda m: m * np.eye(3), turn=lambda r: skew(r), middle=lambda inv: inv):
    def contact_matrix(r, inv_mass, inv_inertia):
        return mass(inv_mass) + sign * turn(r) @ middle(inv_inertia) @ turn(r)
    return contact_matrix


right("7.9", "with skew")(K_of())
wrong("7.9", "adds the rotational part where it is subtracted")(K_of(sign=1.0))
wrong("7.9", "adds 1/m to every entry, not only on the diagonal")(K_of(mass=lambda m: m * np.ones((3, 3))))
wrong("7.9", "forgets the mass")(K_of(mass=lambda m: np.zeros((3, 3))))
edit("7.9", "multiplies by the tensor after both cross products", "cross(times(inv_inertia, cross(r, unit)), r)",
     "times(inv_inertia, cross(cross(r, unit), r))")
wrong("7.9", "replaces the inverse tensor by a number")(K_of(middle=lambda inv: np.trace(inv) / 3.0 * np.eye(3)))
edit("7.9", "omits the rotation if the mass is infinite", "K = np.zeros((3, 3))",
     "K = np.zeros((3, 3))\n    if inv_mass == 0.0:\n        return K")
edit("7.9", "returns zero for a body that cannot rotate", "K = np.zeros((3, 3))",
     "K = np.zeros((3, 3))\n    if not inv_inertia.any():\n        return K")
edit("7.9", "returns zero at the centre of mass", "K = np.zeros((3, 3))",
     "K = np.zeros((3, 3))\n    if not r.any():\n        return K")
edit("7.9", "omits the last cross product with r",
     "cross(times(inv_inertia, cross(r, unit)), r)", "times(inv_inertia, cross(r, unit))")
edit("7.9", "omits the rotation by a point on an axis", "K = np.zeros((3, 3))",
     "K = np.zeros((3, 3))\n    if np.count_nonzero(r) < 2:\n        return inv_mass * np.eye(3)")
edit("7.9", "omits the rotation", "+ cross(times(inv_inertia, cross(r, unit)), r)", "+ 0.0 * r")
edit("7.9", "uses the inertia in place of its inverse",
     "times(inv_inertia, cross", "times(np.linalg.inv(inv_inertia + 1e-300 * np.eye(3)), cross")
edit("7.9", "forgets the inverse inertia", "times(inv_inertia, cross(r, unit))", "cross(r, unit)")
edit("7.9", "uses the mass in place of its inverse", "inv_mass * unit", "(1.0 / inv_mass if inv_mass else 0.0) * unit")
edit("7.9", "adds the inverse inertia itself, without the arms",
     "cross(times(inv_inertia, cross(r, unit)), r)", "times(inv_inertia, unit)")


# 7.10 -----------------------------------------------------------------------------------------------------------
@variants
def cone(check=True, parts=True, enough=lambda u_sep: u_sep, goal=lambda u_sep: u_sep, rim=lambda mu: mu,
         side="stick", clamp="rim", sticks=lambda J_t, J_n, mu: J_t <= mu * J_n):
    def cone_impulse(u, n, K, u_sep, mu):
        if check:
            worked.check_contact(u, n, K, mu)
        if parts and u @ n >= enough(u_sep):
            return np.zeros(3)
        J = np.linalg.solve(K, goal(u_sep) * n - u)
        J_t = tangential(J, n)
        length = np.linalg.norm(J_t)
        if sticks(length, J @ n, mu):
            return J
        if clamp != "rim":                                               # the stick's normal impulse, friction cut down
            return (J @ n) * n + mu * (J @ n if clamp == "cut, or turned round" else max(0.0, J @ n)) / length * J_t
        slip = tangential(u, n)
        t = J_t / length if side == "stick" else -slip / max(np.linalg.norm(slip), 1e-300)
        d = n + rim(mu) * t if mu < 1e9 else t
        return (goal(u_sep) - u @ n) / (n @ K @ d) * d
    return cone_impulse


right("7.10", "by NumPy's solver")(cone())
wrong("7.10", "does not check its input")(cone(check=False))
wrong("7.10", "pulls at separating bodies")(cone(parts=False))
wrong("7.10", "never rebounds")(cone(goal=lambda u_sep: 0.0))
wrong("7.10", "never sticks")(cone(sticks=lambda J_t, J_n, mu: False))
wrong("7.10", "always sticks")(cone(sticks=lambda J_t, J_n, mu: True))
wrong("7.10", "directs friction against the slip before the impact")(cone(side="slip"))
wrong("7.10", "keeps the normal impulse of sticking")(cone(clamp="cut"))
wrong("7.10", "keeps the normal impulse of sticking")(cone(clamp="cut, or turned round"))
wrong("7.10", "pulls where sticking would need a pull")(cone(sticks=lambda J_t, J_n, mu: J_t <= mu * abs(J_n)))
wrong("7.10", "compares all of the impulse with the cone")(
    cone(sticks=lambda J_t, J_n, mu: np.hypot(J_t, J_n) <= mu * J_n))
wrong("7.10", "ignores bodies that separate too slowly")(cone(enough=lambda u_sep: 0.0))
wrong("7.10", "uses half of the friction coefficient")(cone(rim=lambda mu: 0.5 * mu))
edit("7.10", "sticks as if K were a number, not a matrix", "solve3(K[0], K[1], K[2], u_sep * n - u)",
     "(u_sep * n - u) / (n @ times(K, n))")
edit("7.10", "pushes bodies that separate exactly at u_sep", "u @ n >= u_sep", "u @ n > u_sep")
edit("7.10", "does not separate points at rest", "u @ n >= u_sep", "u @ n >= u_sep or not u.any()")
edit("7.10", "ignores bodies up to 1 nm/s below u_sep", "u @ n >= u_sep", "u @ n >= u_sep - 1e-9")
edit("7.10", "treats a small tangential impulse as zero",
     "np.sin(beta) / size", "(np.sin(beta) / size if size > 1e-9 else 0.0)")
edit("7.10", "treats a friction above 10 as infinite", "np.arctan(mu)", "np.arctan(mu if mu < 10.0 else np.inf)")
edit("7.10", "limits the friction to 10", "np.arctan(mu)", "np.arctan(mu if mu > 1e5 else min(mu, 10.0))")
edit("7.10", "sticks with a friction above 10", "size <= mu * (J @ n)",
     "size <= mu * (J @ n) or (mu > 10.0 and J @ n > 0.0)")
edit("7.10", "slides on the rim of the cone, too", "size <= mu * (J @ n)", "size < mu * (J @ n)")
edit("7.10", "always lets heavy bodies stick", "size <= mu * (J @ n)", "size <= mu * (J @ n) or K[0, 0] < 1e-9")
edit("7.10", "accepts a friction that is not a number", "check_contact(u, n, K, mu)",
     "check_contact(u, n, K, 0.0 if mu != mu else mu)")
edit("7.10", "accepts an infinite velocity", "check_contact(u, n, K, mu)",
     "check_contact(np.where(np.isinf(u), 1.0, u), n, K, mu)")
edit("7.10", "accepts a K without an inverse", "check_contact(u, n, K, mu)",
     "check_contact(u, n, K + (n @ K @ n > 0.0) * np.eye(3), mu)")
edit("7.10", "omits the friction where there is no slip before the impact", "J_t = tangential(J, n)",
     "J_t = tangential(J, n)\n"
     "    if not tangential(u, n).any():\n        return (u_sep - u @ n) / (n @ times(K, n)) * n")
edit("7.10", "exchanges sine and cosine of the angle β",
     "np.cos(beta) * n + np.sin(beta) / size * J_t", "np.sin(beta) * n + np.cos(beta) / size * J_t")
edit("7.10", "takes μ for the angle β", "beta = np.arctan(mu)", "beta = mu")
edit("7.10", "directs the friction of sliding the other way",
     "+ np.sin(beta) / size * J_t", "- np.sin(beta) / size * J_t")
edit("7.10", "does not normalise the tangential impulse", "np.sin(beta) / size * J_t", "np.sin(beta) * J_t")
edit("7.10", "adds u in place of subtracting it when it sticks", "u_sep * n - u)", "u_sep * n + u)")
edit("7.10", "forgets K where it slides", "(n @ times(K, d))", "(n @ d)")
edit("7.10", "exchanges the two cases", "size <= mu * (J @ n)", "size > mu * (J @ n)")
edit("7.10", "multiplies by K in place of solving with it",
     "solve3(K[0], K[1], K[2], u_sep * n - u)", "times(K, u_sep * n - u)")
edit("7.10", "reverses the normal velocity when it slides", "(u_sep - u @ n)", "(u_sep + u @ n)")
edit("7.10", "divides by the inverse mass along the normal, not along d", "times(K, d)", "times(K, n)")


# 7.11 -----------------------------------------------------------------------------------------------------------
@variants
def work(half=0.5, sign=1.0, first=1.0):
    def energy_change(u, K, J):
        return sign * (first * J @ u + half * J @ K @ J)
    return energy_change


@right("7.11", "the mean of before and after")
def energy_change(u, K, J):
    return J @ (u + (u + K @ J)) / 2.0


wrong("7.11", "omits the factor ½")(work(half=1.0))
wrong("7.11", "returns the energy lost, not the energy gained")(work(sign=-1.0))
wrong("7.11", "uses the velocity before the impact only")(work(half=0.0))
wrong("7.11", "omits the velocity before the impact")(work(first=0.0))
edit("7.11", "returns a loss for every impact",
     "J @ u + 0.5 * (J @ times(K, J))", "-abs(J @ u + 0.5 * (J @ times(K, J)))")
edit("7.11", "returns a gain for every impact",
     "J @ u + 0.5 * (J @ times(K, J))", "abs(J @ u + 0.5 * (J @ times(K, J)))")
edit("7.11", "counts J · u as a loss, regardless of its sign", "J @ u +", "-abs(J @ u) +")
edit("7.11", "forgets K in the second term", "J @ times(K, J)", "J @ J")
edit("7.11", "subtracts the second term", "J @ u + 0.5", "J @ u - 0.5")
edit("7.11", "halves the first term, too", "J @ u +", "0.5 * (J @ u) +")
edit("7.11", "uses K⁻¹ in place of K", "times(K, J)", "np.linalg.solve(K, J)")
edit("7.11", "says that bodies at rest gain nothing", "return J @ u", "return 0.0 if not u.any() else J @ u")
edit("7.11", "takes the change of ½ u², without the masses", "J @ u + 0.5 * (J @ times(K, J))",
     "0.5 * ((u + times(K, J)) @ (u + times(K, J)) - u @ u)")


# 7.12 -----------------------------------------------------------------------------------------------------------
@variants
def multiplier(gap=1.0, clamp=True, over=lambda k_n: 1.0 / k_n, check=True):
    def gap_multiplier(phi, u_n, k_n, dt):
        if check:
            worked.check_inverse_mass(k_n)
        check_positive("step dt [s]", dt)
        lam = -(gap * phi / dt + u_n) * over(k_n) if k_n else np.inf
        return max(0.0, lam) if clamp else lam
    return gap_multiplier


@right("7.12", "tests first whether the gap stays open")
def gap_multiplier(phi, u_n, k_n, dt):
    worked.check_inverse_mass(k_n)
    check_positive("step dt [s]", dt)
    free = phi + dt * u_n
    return 0.0 if free >= 0.0 else -free / (dt * k_n)


wrong("7.12", "does not use the width of the gap")(multiplier(gap=0.0))
wrong("7.12", "pulls open gaps together")(multiplier(clamp=False))
wrong("7.12", "multiplies by k_n in place of dividing by it")(multiplier(over=lambda k_n: k_n))
wrong("7.12", "accepts two immovable bodies")(multiplier(check=False))
edit("7.12", "accepts a step of zero", 'check_positive("step dt [s]", dt)', "dt = dt or 1.0")
edit("7.12", "accepts a negative step", 'check_positive("step dt [s]", dt)', 'check_positive("step dt [s]", abs(dt))')
edit("7.12", "accepts a step that is not a number", 'check_positive("step dt [s]", dt)',
     'check_positive("step dt [s]", 1.0 if dt != dt else dt)')
edit("7.12", "accepts any step if the gap opens", 'check_positive("step dt [s]", dt)',
     'if u_n >= 0.0:\n        return 0.0\n    check_positive("step dt [s]", dt)')
edit("7.12", "accepts two immovable bodies that do not meet", "check_inverse_mass(k_n)",
     "if phi + dt * u_n > 0.0:\n        return 0.0\n    check_inverse_mass(k_n)")
edit("7.12", "ignores overlaps below 1 nm", "-(phi / dt + u_n) / k_n)",
     "-(phi / dt + u_n) / k_n if phi + dt * u_n <= -1e-9 else 0.0)")
edit("7.12", "waits until the gap is closed", "np.maximum(0.0, -(phi / dt + u_n) / k_n)",
     "max(0.0, -u_n / k_n) if phi <= 0.0 else 0.0")
edit("7.12", "accepts a negative inverse mass", "check_inverse_mass(k_n)", "check_inverse_mass(abs(k_n))")
edit("7.12", "accepts any inverse mass that is not zero or below", "check_inverse_mass(k_n)",
     "if k_n <= 0.0:\n        check_inverse_mass(k_n)")
edit("7.12", "accepts an infinite step", 'check_positive("step dt [s]", dt)',
     'check_positive("step dt [s]", 1.0 if dt == np.inf else dt)')
edit("7.12", "pulls where the gap is closed", "return np.maximum(", "return -u_n / k_n if phi == 0.0 else np.maximum(")
edit("7.12", "multiplies the gap by dt", "phi / dt", "phi * dt")
edit("7.12", "forgets to divide by k_n", "(phi / dt + u_n) / k_n", "(phi / dt + u_n)")
edit("7.12", "forgets the minus sign", "-(phi / dt + u_n)", "(phi / dt + u_n)")
edit("7.12", "subtracts the velocity", "phi / dt + u_n", "phi / dt - u_n")
edit("7.12", "omits the velocity", "phi / dt + u_n", "phi / dt")
edit("7.12", "adds the gap itself, without dt", "phi / dt + u_n", "phi + u_n")
edit("7.12", "takes the smaller of the two in place of the larger", "np.maximum(0.0, -", "np.minimum(0.0, -")
edit("7.12", "stops the approach at once wherever the gap would close", "np.maximum(0.0, -(phi / dt + u_n) / k_n)",
     "-u_n / k_n if phi + dt * u_n < 0.0 else 0.0")


# 7.13 -----------------------------------------------------------------------------------------------------------
@variants
def moment(inside=True, back=True, limit=True, pull=2.0, stable=True):
    def impact_time(phi, v_n, a_n, dt):
        phi = max(0.0, phi) if inside else phi
        squared = v_n * v_n - pull * a_n * phi
        if squared < 0.0 or (v_n >= 0.0 and (a_n >= 0.0 or not back)):
            return dt
        s = np.sqrt(squared)
        with np.errstate(all="ignore"):
            if v_n < 0.0 and stable:
                tau = np.float64(2.0 * phi) / (s - v_n)
            else:
                tau = np.float64(-v_n - s) / a_n
        return min(tau, dt) if limit else tau
    return impact_time


@right("7.13", "2φ/(s − v) for both, but for what comes back from the plane itself")
def impact_time(phi, v_n, a_n, dt):
    phi = max(phi, 0.0)
    if (v_n >= 0.0 and a_n >= 0.0) or v_n**2 < 2.0 * a_n * phi:
        return dt
    s = (v_n**2 - 2.0 * a_n * phi) ** 0.5
    return min(dt, 2.0 * phi / (s - v_n) if v_n < 0.0 else (v_n + s) / -a_n)


wrong("7.13", "does not treat a ball inside as a ball on the plane")(moment(inside=False))
wrong("7.13", "finds no impact for a rising ball")(moment(back=False))
wrong("7.13", "accepts impacts beyond the end of the step")(moment(limit=False))
wrong("7.13", "uses half of the acceleration")(moment(pull=1.0))
wrong("7.13", "divides by a very small acceleration")(moment(stable=False))
edit("7.13", "omits the acceleration", "phi = np.maximum(0.0, phi)", "phi, a_n = max(0.0, phi), 0.0")
edit("7.13", "takes the depth below the surface for a height", "phi = np.maximum(0.0, phi)", "phi = abs(phi)")
edit("7.13", "ignores an immediate impact", "return np.minimum(tau, dt)", "return tau if 0.0 < tau < dt else dt")
edit("7.13", "finds an impact for a resting ball without acceleration", "squared = v_n * v_n",
     "if phi == 0.0 and v_n <= 0.0 and a_n <= 0.0:\n        return 0.0\n    squared = v_n * v_n")
edit("7.13", "treats a micrometre as contact", "np.maximum(0.0, phi)", "phi if phi > 1e-6 else 0.0")
edit("7.13", "misses a grazing touch", "squared < 0.0 or", "squared < 0.0 or (squared == 0.0 and phi > 0.0) or")
edit("7.13", "uses the form for a falling ball for a rising one, too",
     "if v_n < 0.0 else", "if v_n < 0.0 or phi > 0.0 else")
edit("7.13", "adds 2 a φ under the root", "v_n * v_n - 2.0 * a_n * phi", "v_n * v_n + 2.0 * a_n * phi")
edit("7.13", "uses 4 a φ under the root", "v_n * v_n - 2.0 * a_n * phi", "v_n * v_n - 4.0 * a_n * phi")
edit("7.13", "forgets the root", "s = np.sqrt(squared)", "s = squared")
edit("7.13", "returns the other root", "2.0 * phi / (s - v_n)", "2.0 * phi / (-s - v_n)")
edit("7.13", "forgets the 2 in the numerator", "2.0 * phi / (s", "phi / (s")
edit("7.13", "forgets the minus sign for a rising ball", "-(v_n + s) / a_n", "(v_n + s) / a_n")
edit("7.13", "returns the longer of both times", "np.minimum(tau, dt)", "np.maximum(tau, dt)")
edit("7.13", "takes the wrong root for a rising ball", "-(v_n + s) / a_n", "-(v_n - s) / a_n")
edit("7.13", "returns zero if the gap never closes", "return dt", "return 0.0 * dt")


# 7.14 -----------------------------------------------------------------------------------------------------------
@variants
def zeno(flight=2.0, sum=lambda e: 1.0 - e, down=True, endless=True, falls=True):
    def bouncing_time(v_n, a_n, e):
        if down and v_n <= 0.0:
            return 0.0
        if (endless and e == 1.0) or (falls and a_n >= 0.0):
            return np.inf
        return flight * v_n / (-a_n * sum(e)) if sum(e) else 0.0
    return bouncing_time


@right("7.14", "one flight, and e times as much again")
def bouncing_time(v_n, a_n, e):
    if v_n <= 0.0:
        return 0.0
    return 2.0 * v_n / (-a_n) / (1.0 - e) if a_n < 0.0 and e < 1.0 else float("inf")


wrong("7.14", "counts only the way up of each flight")(zeno(flight=1.0))
edit("7.14", "treats nearly elastic bounces as endless", "e == 1.0", "e > 0.99")
edit("7.14", "treats bounces slower than 1 mm/s as no bounces", "v_n <= 0.0", "v_n <= 1e-3")
edit("7.14", "returns infinity for a ball that does not leave", "if v_n <= 0.0:",
     "if a_n >= 0.0 or e == 1.0:\n        return np.inf\n    if v_n <= 0.0:")
edit("7.14", "treats e within 1e-5 of 1 as 1", "e == 1.0", "np.isclose(e, 1.0)")
edit("7.14", "sums 20,000 flights only",
     "-2.0 * v_n / (a_n * (1.0 - e))", "sum(-2.0 * v_n * e**k / a_n for k in range(20_000))")
wrong("7.14", "counts one flight only")(zeno(sum=lambda e: 1.0))
wrong("7.14", "uses 1 + e in place of 1 − e")(zeno(sum=lambda e: 1.0 + e))
wrong("7.14", "returns a negative time")(zeno(down=False))
wrong("7.14", "returns zero for e = 1")(zeno(endless=False))
wrong("7.14", "returns a finite time without acceleration")(zeno(falls=False))
edit("7.14", "treats e within 1e-12 of 1 as 1", "e == 1.0", "e > 1.0 - 1e-12")
edit("7.14", "treats a restitution below 0.01 as zero", "(1.0 - e)", "(1.0 - (e if e > 0.01 else 0.0))")
edit("7.14", "treats bounces slower than 1 nm/s as no bounces", "v_n <= 0.0", "v_n <= 1e-9")
edit("7.14", "treats a weak acceleration as zero", "a_n >= 0.0", "a_n >= -1e-12")
edit("7.14", "counts the flights after the first impact only", "-2.0 * v_n /", "-2.0 * e * v_n /")
RESTITUTION_SQUARED = edit("7.14", "squares the restitution", "(1.0 - e)", "(1.0 - e * e)")
edit("7.14", "multiplies, where the sum of the series divides",
     "-2.0 * v_n / (a_n * (1.0 - e))", "-2.0 * v_n / a_n * (1.0 - e)")
edit("7.14", "forgets the acceleration", "(a_n * (1.0 - e))", "(-1.0 * (1.0 - e))")
edit("7.14", "divides by e", "(a_n * (1.0 - e))", "(a_n * e)")


# 7.15 -----------------------------------------------------------------------------------------------------------
@variants
def project(old=False, back=-1.0, response=worked.kinematic_response, asked="new", once=True, late=False):
    def position_projection_step(acceleration, t, x, v, dt, p):
        v_new = v + (dt if once else 1.0) * acceleration(t, x, v, p)
        x_new = x + dt * (v if old else v_new)
        phi = worked.gap(x if asked == "old" else x_new, p)
        return (x_new + back * phi * p.n, response(v if late else v_new, p.n, p.e)) if phi < 0.0 else (x_new, v_new)
    return position_projection_step


right("7.15", "with new names")(project())
wrong("7.15", "moves with the old velocity")(project(old=True))
wrong("7.15", "moves the ball deeper into the plane")(project(back=1.0))
wrong("7.15", "leaves the ball inside the plane")(project(back=0.0))
wrong("7.15", "does not reflect the velocity")(project(response=lambda v, n, e: tangential(v, n)))
wrong("7.15", "evaluates the gap before it moves")(project(asked="old"))
edit("7.15", "ignores depths below 0.1 mm", "phi < 0.0", "phi < -1e-4")
edit("7.15", "ignores depths below 1 nm", "phi < 0.0", "phi < -1e-9")
edit("7.15", "reverses a leaving ball", "kinematic_response(v, p.n, p.e)", "v - (1.0 + p.e) * (v @ p.n) * p.n")
ONLY_APPROACHING_BALLS = edit("7.15", "moves only an approaching ball back", "phi < 0.0", "phi < 0.0 and v @ p.n < 0.0")
edit("7.15", "uses gravity in place of the acceleration", "acceleration(t, x, v, p)", "p.gravity")
edit("7.15", "takes the acceleration at time t + dt", "acceleration(t, x, v, p)", "acceleration(t + dt, x, v, p)")
edit("7.15", "takes the acceleration at the new position",
     "acceleration(t, x, v, p)", "acceleration(t, x + dt * v, v, p)")
edit("7.15", "takes the acceleration at zero velocity", "acceleration(t, x, v, p)", "acceleration(t, x, 0.0 * v, p)")
wrong("7.15", "forgets dt")(project(once=False))
wrong("7.15", "reflects the velocity before the acceleration")(project(late=True))
edit("7.15", "reflects a ball that is exactly on the plane", "phi < 0.0", "phi <= 0.0")
edit("7.15", "omits the restitution for a ball slower than 2 g dt", "kinematic_response(v, p.n, p.e)",
     "kinematic_response(v, p.n, p.e if v @ p.n < 2.0 * dt * (p.gravity @ p.n) else 0.0)")


@variants
def by_the_old_velocity(counts=lambda v, v_new: v_new):
    def position_projection_step(acceleration, t, x, v, dt, p):
        v_new = v + dt * acceleration(t, x, v, p)
        x_new = x + dt * v_new
        phi = worked.gap(x_new, p)
        if phi >= 0.0:
            return x_new, v_new
        bounces = counts(v, v_new) @ p.n < 0.0
        return x_new - phi * p.n, v_new - (1.0 + p.e) * (v_new @ p.n) * p.n if bounces else v_new
    return position_projection_step


wrong("7.15", "does not reflect what left at the start")(by_the_old_velocity(counts=lambda v, v_new: v))


@right("7.15", "position and velocity from the acceleration")
def position_projection_step(acceleration, t, x, v, dt, p):
    a = acceleration(t, x, v, p)
    place, speed = x + dt * v + dt**2 * a, v + dt * a
    depth = (p.point - place) @ p.n
    return (place + depth * p.n, worked.kinematic_response(speed, p.n, p.e)) if depth > 0.0 else (place, speed)


edit("7.15", "exchanges the signs of the test: corrects outside", "phi < 0.0", "phi > 0.0")
edit("7.15", "moves the ball back by half of the depth", "x = x - phi", "x = x - 0.5 * phi")
edit("7.15", "reflects the position with the restitution, too", "x = x - phi", "x = x - (1.0 + p.e) * phi")
edit("7.15", "mirrors the position at the plane", "x = x - phi", "x = x - 2.0 * phi")
edit("7.15", "subtracts the acceleration", "v = v + dt", "v = v - dt")
edit("7.15", "reverses the normal", "kinematic_response(v, p.n, p.e)", "kinematic_response(v, -p.n, p.e)")
edit("7.15", "forgets dt in the position", "x = x + dt * v", "x = x + v")
edit("7.15", "returns the velocity first", "return x, v", "return v, x")
edit("7.15", "leaves a ball at rest where it is", "v = v + dt * acceleration(t, x, v, p)",
     "if not v.any():\n        return x, v\n    v = v + dt * acceleration(t, x, v, p)")


# 7.16 -----------------------------------------------------------------------------------------------------------
@variants
def back_to(rest=True, goes_on=True, once=False, silent=False, changes=False,
            fly=worked.free_flight, lie=worked.slide_on_plane, bounce=lambda e: e):
    def backtracking_step(acceleration, t, x, v, dt, p):
        a, left, given = acceleration(t, x, v, p), dt, x
        for _ in range(1 if once else worked.MAX_IMPACTS):
            tau = worked.impact_time(worked.gap(x, p), v @ p.n, a @ p.n, left)
            x, v = fly(x, v, a, tau)
            if changes:
                given[:] = x
            left = left - tau
            if left <= 0.0:
                return x, v
            v = worked.kinematic_response(v, p.n, bounce(p.e))
            x = x - worked.gap(x, p) * p.n
            if not goes_on:
                return x, v
            if rest and worked.bouncing_time(v @ p.n, a @ p.n, p.e) <= left:
                return lie(x, v, a, left, p.n)
        if once or silent:
            return fly(x, v, a, left)
        raise Diverged("impacts in a step of dt [s]", dt, "take a smaller one")
    return backtracking_step


right("7.16", "with new names")(back_to())
wrong("7.16", "ends the step at the impact")(back_to(goes_on=False))
wrong("7.16", "never raises Diverged")(back_to(silent=True))
wrong("7.16", "changes its input")(back_to(changes=True))
wrong("7.16", "handles one impact per step only")(back_to(once=True))
wrong("7.16", "omits ½ a t² in the flight")(back_to(fly=lambda x, v, a, t: (x + t * v, v + t * a)))
wrong("7.16", "makes every impact elastic")(back_to(bounce=lambda e: 1.0))
edit("7.16", "projects the position in place of going back to the impact", "a, left = acceleration(t, x, v, p), dt",
     "return position_projection_step(acceleration, t, x, v, dt, p)")
edit("7.16", "lets the ball lie as soon as it is slow",
     "bouncing_time(v @ p.n, a @ p.n, p.e) <= left", "v @ p.n < 1e-3")
edit("7.16", "lets the ball lie below 1 µm/s", "bouncing_time(v @ p.n, a @ p.n, p.e) <= left", "v @ p.n < 1e-6")
edit("7.16", "uses gravity in place of the acceleration", "acceleration(t, x, v, p)", "p.gravity")
edit("7.16", "takes the acceleration at time t + dt", "acceleration(t, x, v, p)", "acceleration(t + dt, x, v, p)")
edit("7.16", "evaluates the acceleration again after each impact", "x = x - gap(x, p) * p.n",
     "x = x - gap(x, p) * p.n\n        a = acceleration(t + dt - left, x, v, p)")
edit("7.16", "does not move a ball back that starts inside", "x = x - gap(x, p) * p.n", "pass")
edit("7.16", "stops a ball that starts inside in place of reflecting it", "a, left = acceleration(t, x, v, p), dt",
     "a, left = acceleration(t, x, v, p), dt\n    if gap(x, p) < 0.0 and v @ p.n < 0.0:\n"
     "        x, v = x - gap(x, p) * p.n, tangential(v, p.n)")
wrong("7.16", "stops the sliding of a resting ball")(back_to(lie=lambda x, v, a, t, n: (x, 0.0 * v)))
edit("7.16", "keeps a resting ball on the plane, also where a force lifts it",
     "return slide_on_plane(x, v, a, left, p.n)",
     "return free_flight(x, tangential(v, p.n), tangential(a, p.n), left)")
edit("7.16", "moves a ball back that starts inside and already leaves", "a, left = acceleration(t, x, v, p), dt",
     "a, left = acceleration(t, x, v, p), dt\n    x = x - min(0.0, gap(x, p)) * p.n")
edit("7.16", "evaluates the acceleration again where the ball lies", "slide_on_plane(x, v, a, left, p.n)",
     "slide_on_plane(x, v, acceleration(t + dt - left, x, v, p), left, p.n)")
edit("7.16", "omits the last nanosecond of the step", "left <= 0.0", "left <= 1e-9")
edit("7.16", "handles at most 1,000 impacts", "range(MAX_IMPACTS)", "range(1000)")
edit("7.16", "uses the size of the acceleration, not its normal part, for the time of bouncing",
     "bouncing_time(v @ p.n, a @ p.n, p.e)",
     "bouncing_time(v @ p.n, -np.sqrt(a @ a), p.e)")
edit("7.16", "treats every acceleration as directed into the plane", "impact_time(gap(x, p), v @ p.n, a @ p.n, left)",
     "impact_time(gap(x, p), v @ p.n, -abs(a @ p.n), left)")
edit("7.16", "does not let the ball lie where bouncing takes no time", "bouncing_time(v @ p.n, a @ p.n, p.e) <= left",
     "0.0 < bouncing_time(v @ p.n, a @ p.n, p.e) <= left")


@right("7.16", "until no time is left, and what lies first")
def backtracking_step(acceleration, t, x, v, dt, p):
    a, left, impacts = acceleration(t, x, v, p), dt, 0
    while True:
        tau = worked.impact_time(worked.gap(x, p), v @ p.n, a @ p.n, left)
        (x, v), left = worked.free_flight(x, v, a, tau), left - tau
        if not left > 0.0:
            return x, v
        x, v = x - worked.gap(x, p) * p.n, worked.kinematic_response(v, p.n, p.e)
        if left >= worked.bouncing_time(v @ p.n, a @ p.n, p.e):
            return worked.slide_on_plane(x, v, a, left, p.n)
        impacts += 1
        if impacts == worked.MAX_IMPACTS:
            raise Diverged("impacts in a step of dt [s]", dt, "take a smaller one")
edit("7.16", "adds the time of flight to what is left", "left -= tau", "left += 0.0 * tau")
edit("7.16", "takes only the last flight off the step", "left -= tau", "left = dt - tau")
edit("7.16", "takes only the last flight off the step", "left -= tau", "left = dt - tau if tau < left else 0.0")
edit("7.16", "flies for the whole rest at once", "free_flight(x, v, a, tau)", "free_flight(x, v, a, left)")
edit("7.16", "looks for the impact within dt, not within the time that is left", "a @ p.n, left)", "a @ p.n, dt)")
edit("7.16", "does not reflect the ball", "v = kinematic_response(v, p.n, p.e)", "pass")
edit("7.16", "moves the ball the wrong way to the plane", "x = x - gap(x, p) * p.n", "x = x + gap(x, p) * p.n")
edit("7.16", "lets the ball lie for the whole step, not for what is left",
     "slide_on_plane(x, v, a, left, p.n)", "slide_on_plane(x, v, a, dt, p.n)")
edit("7.16", "reverses the test of the bouncing time", "p.e) <= left", "p.e) > left")
edit("7.16", "flies with zero acceleration", "free_flight(x, v, a, tau)", "free_flight(x, v, 0.0 * a, tau)")
edit("7.16", "leaves a ball without acceleration where it is", "a, left = acceleration(t, x, v, p), dt",
     "a, left = acceleration(t, x, v, p), dt\n    if not a.any():\n        return x, v")
edit("7.16", "compares the bouncing time with the whole step, not with what is left", "p.e) <= left", "p.e) <= dt")


# 7.17 -----------------------------------------------------------------------------------------------------------
JAMMED = "settle_impacts(contact_matrix, cone_impulse, apply_impulse, body, r, n, e, mu)"


def no_answer(*impact):
    return worked.settle_impacts(worked.contact_matrix, worked.cone_impulse, worked.apply_impulse, *impact)


@variants
def sweeping(sweeps=3000, before=True, takes_back=True, friction=lambda mu: mu, check=worked.check_impacts,
             push=worked.apply_impulse, rebound=lambda e: e, report=lambda residual: residual,
             jammed=no_answer):
    def solve_impacts(body, r, n, e, mu):
        check(body, r, n, e, mu)
        start, speed = body, worked.largest_speed(body, r)
        velocity = lambda body, i: point_velocity(body.v, body.omega, r[i])
        Ks = [worked.contact_matrix(arm, body.inv_mass, body.inv_inertia) for arm in r]
        u_sep = [max(0.0, -rebound(e) * (n[i] @ velocity(body, i))) for i in range(len(r))]
        Js = np.zeros((len(r), 3))
        for _ in range(sweeps):
            worst = 0.0
            for i, K in enumerate(Ks):
                u = velocity(body, i)
                goal = u_sep[i] if before else max(0.0, -e * (n[i] @ u))
                J = worked.cone_impulse(u - (K @ Js[i] if takes_back else 0.0), n[i], K, goal, friction(mu))
                change = J - Js[i] if takes_back else J
                body, Js[i], worst = push(body, r[i], change), Js[i] + change, max(worst, np.abs(K @ change).max())
            if worst <= 1e-14 * speed or sweeps < 10:
                return body, report(worst)
        body, worst = jammed(start, r, n, e, mu)
        return body, report(worst)
    return solve_impacts


right("7.17", "until no impulse changes")(sweeping())
wrong("7.17", "sweeps once only")(sweeping(sweeps=1))
wrong("7.17", "sweeps five times only")(sweeping(sweeps=5))
wrong("7.17", "takes the restitution from the velocities that the sweep has changed already")(sweeping(before=False))
wrong("7.17", "omits the friction")(sweeping(friction=lambda mu: 0.0))
wrong("7.17", "never lets the body rebound")(sweeping(rebound=lambda e: 0.0))
wrong("7.17", "does not rotate")(sweeping(push=lambda body, r, J: body._replace(v=body.v + body.inv_mass * J)))
wrong("7.17", "accepts any restitution")(sweeping(check=lambda *_: None))
wrong("7.17", "returns a residual of zero")(sweeping(report=lambda residual: 0.0))
edit("7.17", "solves the impacts one after the other", "check_impacts(body, r, n, e, mu)",
     "from solutions.given.impulses import sequential_impacts as one; return one(body, r, n, e, mu)")
edit("7.17", "uses the largest separation velocity for all points", "cone_impulse(u, n[i], K, u_sep[i], mu)",
     "cone_impulse(u, n[i], K, u_sep.max(), mu)")
edit("7.17", "omits the restitution", "cone_impulse(u, n[i], K, u_sep[i], mu)", "cone_impulse(u, n[i], K, 0.0, mu)")
edit("7.17", "uses the first normal for all points", "cone_impulse(u, n[i]", "cone_impulse(u, n[0]")
edit("7.17", "takes the restitution from the velocity of the centre of mass",
     "point_velocity(after.v, after.omega, r[i])", "after.v")
edit("7.17", "stops at an absolute 1e-11 m/s", "CONVERGED * speed", "1e-11")
edit("7.17", "returns the body before the impact if the sweeps do not settle",
     JAMMED, "(body, residual)")
edit("7.17", "limits the friction to 1", "u_sep[i], mu)", "u_sep[i], min(mu, 1.0))")
edit("7.17", "returns the result of the last sweep if the sweeps do not settle",
     f"return {JAMMED}", "return after, residual")
edit("7.17", "omits the friction if the sweeps do not settle", "apply_impulse, body, r, n, e, mu)",
     "apply_impulse, body, r, n, e, 0.0)")
edit("7.17", "stops after 100 sweeps", "range(MAX_SWEEPS)", "range(100)")
edit("7.17", "stops after 500 sweeps", "range(MAX_SWEEPS)", "range(500)")
edit("7.17", "measures the change as an impulse, not as a velocity",
     "np.abs(times(K, J - Js[i])).max()", "np.abs(J - Js[i]).max()")
edit("7.17", "estimates the round-off without the rotation", "largest_speed(body, r)", "np.linalg.norm(body.v)")
edit("7.17", "estimates the round-off from the velocities of the points", "largest_speed(body, r)",
     "max([np.linalg.norm(point_velocity(body.v, body.omega, arm)) for arm in r])")
edit("7.17", "omits negative changes from the residual",
     "np.abs(times(K, J - Js[i])).max()", "times(K, J - Js[i]).max()")
edit("7.17", "returns the residual of the last point", "residual = max(residual, ", "residual = max(0.0, ")
edit("7.17", "returns the residual of the first point",
     "residual = max(residual, ", "residual = max(residual, (i == 0) * ")
edit("7.17", "checks the restitution only", "check_impacts(body, r, n, e, mu)", "check_restitution(e)")
edit("7.17", "uses four fifths of the friction", "u_sep[i], mu)", "u_sep[i], 0.8 * mu)")
edit("7.17", "divides the friction among the points if there are more than two",
     "u_sep[i], mu)", "u_sep[i], mu if len(r) < 3 else mu / len(r))")
edit("7.17", "limits the friction to 2", "u_sep[i], mu)", "u_sep[i], min(mu, 2.0))")
edit("7.17", "replaces the inverse tensor by a number", "contact_matrix(r[i], body.inv_mass, body.inv_inertia)",
     "contact_matrix(r[i], body.inv_mass, np.trace(body.inv_inertia) / 3.0 * np.eye(3))")
edit("7.17", "measures the normal changes only", "np.abs(times(K, J - Js[i])).max()", "abs(n[i] @ times(K, J - Js[i]))")
edit("7.17", "uses infinite friction if the sweeps do not settle", "apply_impulse, body, r, n, e, mu)",
     "apply_impulse, body, r, n, e, np.inf)")
edit("7.17", "returns the residual of the sweeps that did not settle", JAMMED, f"({JAMMED}[0], residual)")
edit("7.17", "subtracts the impulse", "apply_impulse(after, r[i], J - Js[i])", "apply_impulse(after, r[i], Js[i] - J)")
edit("7.17", "applies the whole impulse again in every sweep",
     "apply_impulse(after, r[i], J - Js[i])", "apply_impulse(after, r[i], J)")
edit("7.17", "does not remove the point's own impulse from the velocity", "- times(K, Js[i])", "")
edit("7.17", "adds the velocity by the point's own impulse", "- times(K, Js[i])", "+ times(K, Js[i])")
edit("7.17", "takes all velocities before the impact",
     "point_velocity(after.v, after.omega, r[i])", "point_velocity(body.v, body.omega, r[i])")
edit("7.17", "does not store the impulse", "Js[i] = J", "pass")
edit("7.17", "returns the body unchanged where its centre is at rest", "check_impacts(body, r, n, e, mu)",
     "check_impacts(body, r, n, e, mu)\n    if not body.v.any():\n        return body, 0.0")


# 7.18 --------------------------------------------------------------------------------------------------------------
@right("7.18", "flight by flight")
def elastic_rest_time(h, g, dt):
    w, t = np.sqrt(2.0 * g * h), 0.0
    while w > 0.0:
        w, t = w - 0.5 * g * dt, t + 2.0 * w / g
    return t


edit("7.18", "says that a ball loses g dt of its speed per flight, twice what it loses", "4.0", "2.0")
edit("7.18", "forgets that a projection lifts the ball", "4.0 * h", "h")
edit("7.18", "counts the way up only, half of a flight", "4.0 * h", "8.0 * h")
edit("7.18", "returns the number of flights in place of their time",
     "4.0 * h / (g * dt)", "2.0 * np.sqrt(2.0 * h / g) / dt")
edit("7.18", "adds up the flights as if none became shorter", "4.0 * h / (g * dt)", "16.0 * h / (g * dt)")
edit("7.18", "returns the time of the fall", "4.0 * h / (g * dt)", "np.sqrt(2.0 * h / g)")
edit("7.18", "says that an elastic ball bounces for ever", "4.0 * h / (g * dt)", "np.inf + 0.0 * h")


# 7.19 --------------------------------------------------------------------------------------------------------------
@right("7.19", "as a small letter")
def smooth_rod_is():
    return "d"


edit("7.19", "chooses a rod that gains energy: only friction turns slip into normal motion",
     '"D"', '"A"')
edit("7.19", "chooses the rod that gains most energy: restitution alone never gains any",
     '"D"', '"B"')
edit("7.19", "chooses the rod that loses most: at e = 1 only friction can take energy",
     '"D"', '"C"')


# 7.20 --------------------------------------------------------------------------------------------------------------
@right("7.20", "loses a little along the normal and along the slip")
def my_impulse(u, n, K):
    after = -0.9 * (u @ n) * n - 0.8 * (u - (u @ n) * n)
    return np.linalg.solve(K, after - u)


@right("7.20", "separates with a tenth of the speed, to the last bit")
def hardly_separates(u, n, K):
    return np.linalg.solve(K, -0.1 * (u @ n) * n - (u - (u @ n) * n) - u)


@right("7.20", "returns three tenths of the slip, to the last bit")
def hardly_returns(u, n, K):
    return np.linalg.solve(K, -(u @ n) * n - 0.3 * (u - (u @ n) * n) - u)


@right("7.20", "with two inverse masses of the ball")
def by_two_masses(u, n, K):
    normal = (u @ n) * n
    slip = u - normal
    return -1.8 / (n @ K @ n) * normal - 1.7 * slip * (slip @ slip) / max(slip @ K @ slip, 1e-300)


edit("7.20", "stops the slip, as infinite friction does", "-2.0 * u", "-u - (u @ n) * n")
edit("7.20", "leaves the slip as it is: no friction",
     "solve3(K[0], K[1], K[2], -2.0 * u)", "-2.0 * (u @ n) / (n @ (K @ n)) * n")
edit("7.20", "returns more slip than came: gains energy", "-2.0 * u", "-2.2 * u")
edit("7.20", "does nothing", "-2.0 * u", "0.0 * u")
edit("7.20", "turns the slip but does not separate", "-2.0 * u", "-2.0 * u + (u @ n) * n")
edit("7.20", "pushes the other way", "-2.0 * u", "2.0 * u")
edit("7.20", "returns too little of the slip", "-2.0 * u", "-2.0 * u + 0.85 * (u - (u @ n) * n)")
for mu in (0.5, 1.0, 2.0):
    edit("7.20", f"returns twice the impulse within the cone of μ = {mu:g}: a grazing ball slips on",
         "solve3(K[0], K[1], K[2], -2.0 * u)", f"2.0 * cone_impulse(u, n, K, 0.0, {mu})")
edit("7.20", "does nothing where the ball hits without slip",
     "-2.0 * u", "-2.0 * u * (np.abs(u - (u @ n) * n).max() > 0.0)")


def edits(exercise, ideas):
    """Wrong answers, {story: (part of a line of the worked answer, what takes its place)}."""
    for story, (old, new) in ideas.items():
        edit(exercise, story, old, new)


# What a short cut takes for zero, and where an answer stops to follow the law -----------------------------------
edits("7.1", {
    "takes a velocity whose components add up to 0 for none": ("v_n >= 0.0", "v_n >= 0.0 or v.sum() == 0.0"),
    "takes a restitution of nearly 1 for 1": ("(1.0 + e)", "(1.0 + (1.0 if np.isclose(e, 1.0) else e))"),
    "takes a restitution below 0.001 for 0": ("(1.0 + e)", "(1.0 + (e if e > 1e-3 else 0.0))"),
    "knows normals that point to the right and up only, in the plane":
        ("v_n = v @ n", "n = np.abs(n) if len(n) == 2 else n; v_n = v @ n"),
    "limits the speed of approach to 30 m/s": ("(1.0 + e) * v_n", "(1.0 + e) * max(v_n, -30.0)"),
    "ignores approach below a millionth of the speed": ("v_n >= 0.0", "v_n >= -1e-6 * np.sqrt(v @ v)"),
    "ignores approach below 1e-12 of the speed": ("v_n >= 0.0", "v_n >= -1e-12 * np.sqrt(v @ v)"),
    "stops a velocity that leaves slower than 1 mm/s": ("return v if", "return v - (v_n < 1e-3) * v_n * n if"),
})
edits("7.2", {
    "limits the depth to 5 m": ("-stiffness * phi", "-stiffness * max(phi, -5.0)"),
    "limits the force to 1000 N": ("np.maximum(0.0, -stiffness * phi - damping * v_n)",
                                   "min(1e3, np.maximum(0.0, -stiffness * phi - damping * v_n))"),
    "does not damp below 1 nm/s": ("damping * v_n", "damping * (v_n if abs(v_n) > 1e-9 else 0.0)"),
    "damps less where the depth is below a centimetre": ("damping * v_n", "damping * v_n * min(1.0, -100.0 * phi)"),
    "lets go of a body that leaves at 30 m/s": ("phi >= 0.0", "phi >= 0.0 or v_n > 30.0"),
})
edits("7.3", {
    "omits the velocity of a if its components add up to 0": ("a.v + turn_a", "(a.v.sum() != 0.0) * a.v + turn_a"),
    "omits the velocity of b if it is along y": ("- b.v", "- (b.v[0] != 0.0) * b.v"),
    "omits the rotation of a where its arm is along x": ("a.omega *", "(r_a[1] != 0.0) * a.omega *"),
    "omits the rotation of b where the components of its arm add up to 0":
        ("b.omega *", "(sum(r_b) != 0.0) * b.omega *"),
    "drops the sign of the angular velocity of a": ("a.omega *", "abs(a.omega) *"),
    "drops the sign of the angular velocity of b": ("b.omega *", "abs(b.omega) *"),
    "omits a rotation below 0.001 rad/s": ("a.omega *", "(abs(a.omega) > 1e-3) * a.omega *"),
    "takes a to be at rest if it is on an axle": ("a.v + turn_a", "(a.v if a.inv_mass else 0.0 * a.v) + turn_a"),
})
edits("7.4", {
    "limits the speed of approach to 20 m/s": ("(1.0 + e) * u_n", "(1.0 + e) * max(u_n, -20.0)"),
    "limits the inverse mass to a million": ("/ k_n", "/ min(k_n, 1e6)"),
    "accepts an infinite restitution": ("check_restitution(e)", "check_restitution(1.0 if e == np.inf else e)"),
    "accepts a restitution slightly above 1":
        ("check_restitution(e)", "check_restitution(min(e, 1.0) if e < 1.01 else e)"),
    "accepts a restitution slightly below 0":
        ("check_restitution(e)", "check_restitution(max(e, 0.0) if e > -0.01 else e)"),
    "checks nothing where the bodies touch without speed":
        ("check_restitution(e)", "if u_n == 0.0:\n        return 0.0\n    check_restitution(e)"),
})
edits("7.5", {
    "omits the rotation of a where the components of its arm add up to 0":
        ("lever_a**2 * a.inv_inertia", "lever_a**2 * a.inv_inertia * (sum(r_a) != 0.0)"),
    "omits the rotation of a where its arm is along y":
        ("lever_a**2 * a.inv_inertia", "lever_a**2 * a.inv_inertia * (r_a[0] != 0.0)"),
    "omits the rotation of b where its arm is along x":
        ("lever_b**2 * b.inv_inertia", "lever_b**2 * b.inv_inertia * (r_b[1] != 0.0)"),
    "omits the rotation of a body that turns clockwise":
        ("lever_a**2 * a.inv_inertia", "lever_a**2 * a.inv_inertia * (a.omega >= 0.0)"),
    "omits lever arms below a centimetre":
        ("lever_b**2 * b.inv_inertia", "(lever_b**2 * b.inv_inertia if abs(lever_b) > 1e-2 else 0.0)"),
    "omits the mass of a body that is hit in its centre": ("b.inv_mass +", "(b.inv_mass if r_b.any() else 0.0) +"),
})
edits("7.6", {
    "does not turn a body whose arm is along y":
        ("body.inv_inertia * cross_2d", "(r[0] != 0.0) * body.inv_inertia * cross_2d"),
    "does not turn a body where the components of its arm add up to 0":
        ("body.inv_inertia * cross_2d", "(sum(r) != 0.0) * body.inv_inertia * cross_2d"),
    "omits an impulse along x": ("body.inv_mass * J", "(J[1] != 0.0) * body.inv_mass * J"),
    "omits an impulse along y": ("body.inv_mass * J", "(J[0] != 0.0) * body.inv_mass * J"),
    "omits an impulse whose components add up to 0": ("body.inv_mass * J", "(sum(J) != 0.0) * body.inv_mass * J"),
    "omits impulses below 1 mN s": ("body.inv_mass * J", "(np.abs(J).max() > 1e-3) * body.inv_mass * J"),
    "limits the impulse to 10 N s": ("body.inv_mass * J", "body.inv_mass * np.clip(J, -10.0, 10.0)"),
    "does not turn a body that turns clockwise": ("body.inv_inertia * cross_2d",
                                                  "(body.omega >= 0.0) * body.inv_inertia * cross_2d"),
    "limits the arm to 2 m": ("cross_2d(r, J)", "cross_2d(np.clip(r, -2.0, 2.0), J)"),
})
edits("7.7", {
    "omits the rotation of a where the components of its arm add up to 0":
        ("n @ turn_a", "(r_a.sum() != 0.0) * n @ turn_a"),
    "omits the rotation of b where the components of n add up to 0": ("n @ turn_b", "(n.sum() != 0.0) * n @ turn_b"),
    "omits the rotation of b where the components of r × n add up to 0":
        ("n @ turn_b", "(abs(cross(r_b, n).sum()) > 1e-12) * n @ turn_b"),
    "omits the rotation where the normal points down": ("n @ turn_a", "(n[2] >= 0.0) * n @ turn_a"),
    "omits lever arms below 1 mm": ("n @ turn_a", "(np.abs(cross(r_a, n)).max() > 1e-3) * n @ turn_a"),
    "omits the rotation of a body with its axes along those of space":
        ("n @ turn_a", "(a.inv_inertia[0, 1] != 0.0) * n @ turn_a"),
    "omits the mass of a body that is hit in its centre": ("a.inv_mass +", "r_a.any() * a.inv_mass +"),
})
edits("7.8", {
    **{f"omits the moment about {body} where the components of {what} add up to 0":
       (f"cross(r_{body}, J)", f"({vector}.sum() != 0.0) * cross(r_{body}, J)")
       for body in "ab" for what, vector in (("its arm", f"r_{body}"), ("J", "J"))},
    **{f"omits the moment about {body} where component {k} of {what} is 0":
       (f"cross(r_{body}, J)", f"({vector}[{k}] != 0.0) * cross(r_{body}, J)")
       for body, k in itertools.product("ab", range(3))
       for what, vector in (("its arm", f"r_{body}"), ("J", "J"), ("L", f"L_{body}"))},
    "omits impulses below 1 µN s": ("cross(r_a, J)", "(np.abs(J).max() > 1e-6) * cross(r_a, J)"),
    "turns a about one axis more, across the moment, and b back": ("return L_a", "L_a = L_a + cross(cross(r_a, J), J); "
        "L_b = L_b - cross(cross(r_a, J), J); return L_a"),
    "omits the moment of an impulse along an axis": ("cross(r_b, J)", "(np.count_nonzero(J) > 1) * cross(r_b, J)"),
})
edits("7.9", {
    "omits the rotation where the components of the arm add up to 0":
        ("+ cross(times", "+ (r.sum() != 0.0) * cross(times"),
    "omits the rotation where one component of the arm is 0": ("+ cross(times", "+ r.all() * cross(times"),
    "omits the rotation of a body with its axes along those of space":
        ("+ cross(times", "+ (inv_inertia[0, 1] != 0.0) * cross(times"),
    "limits the arm to 3 m": ("+ cross(times", "+ (r @ r < 9.0) * cross(times"),
    "omits the rotation by arms below 1 mm": ("+ cross(times", "+ (r @ r > 1e-6) * cross(times"),
    "omits the rotation of very heavy bodies": ("+ cross(times", "+ (inv_inertia.max() > 1e-9) * cross(times"),
})
edits("7.10", {
    "returns no impulse where the components of n add up to 0": ("u @ n >= u_sep", "u @ n >= u_sep or n.sum() == 0.0"),
    "returns no impulse where the approach is below a millionth of the slip":
        ("u @ n >= u_sep", "u_sep - u @ n < 1e-6 * np.sqrt(u @ u)"),
    "returns no impulse where the approach is below 1e-12 of the slip":
        ("u @ n >= u_sep", "u_sep - u @ n < 1e-12 * np.sqrt(u @ u)"),
    "is content with 99.9 % of u_sep": ("u @ n >= u_sep", "u @ n >= u_sep or u @ n > 0.999 * u_sep > 0.0"),
    "sticks where the components of J_t add up to 0":
        ("size <= mu * (J @ n)", "size <= mu * (J @ n) or J_t.sum() == 0.0"),
    **{f"sticks where component {k} of J_t is 0": ("size <= mu * (J @ n)", f"size <= mu * (J @ n) or J_t[{k}] == 0.0")
       for k in range(3)},
    "sticks with a friction above 10,000":
        ("size <= mu * (J @ n)", "size <= mu * (J @ n) or (mu > 1e4 and J @ n > 0.0)"),
    "allows a pull of 1 mN s with infinite friction":
        ("size <= mu * (J @ n)", "size <= mu * (J @ n) or (mu == np.inf and J @ n > -1e-3)"),
    "sticks slightly outside the cone": ("size <= mu * (J @ n)", "size <= 1.001 * mu * (J @ n)"),
    "takes a friction below 0.01 for none":
        ("J_t = tangential(J, n)", "mu = mu if mu > 1e-2 else 0.0; J_t = tangential(J, n)"),
    "omits a tangential impulse below a millionth of the normal one":
        ("return J", "return J if size > 1e-6 * (J @ n) else (u_sep - u @ n) / (n @ times(K, n)) * n"),
    "accepts a friction slightly below 0": ("check_contact(u, n, K, mu)",
                                            "check_contact(u, n, K, max(mu, 0.0) if mu > -1e-3 else mu)"),
    "accepts a negative infinite friction": ("check_contact(u, n, K, mu)",
                                             "check_contact(u, n, K, np.inf if mu == -np.inf else mu)"),
    "accepts a normal whose length is nearly 1": ("check_contact(u, n, K, mu)",
        "check_contact(u, n / np.sqrt(n @ n) if abs(n @ n - 1.0) < 0.1 else n, K, mu)"),
    "accepts a normal that is shorter than 1": ("check_contact(u, n, K, mu)",
        "check_contact(u, n / np.sqrt(n @ n) if 0.0 < n @ n < 1.0 else n, K, mu)"),
    "accepts a velocity with one component that is infinite": ("check_contact(u, n, K, mu)",
        "check_contact(u if np.isinf(u).all() else np.where(np.isinf(u), 1.0, u), n, K, mu)"),
    "accepts a K that pulls": ("check_contact(u, n, K, mu)", "check_contact(u, n, K if n @ K @ n >= 0.0 else -K, mu)"),
})
edits("7.11", {
    "takes an impulse whose components add up to 0 for none":
        ("return J @ u", "return 0.0 if J.sum() == 0.0 else J @ u"),
    "takes a velocity along an axis for none": ("return J @ u", "return 0.0 if np.count_nonzero(u) == 1 else J @ u"),
    **{f"takes an impulse whose component {k} is 0 for none":
       ("return J @ u", f"return 0.0 if J[{k}] == 0.0 else J @ u") for k in range(3)},
    "omits impulses below 1 mN s": ("return J @ u", "return 0.0 if np.abs(J).max() < 1e-3 else J @ u"),
    "omits the second term of an impulse below 1 mN s": ("0.5 * (J", "(0.5 if np.abs(J).max() > 1e-3 else 0.0) * (J"),
    "limits the gain to 100 J": ("J @ u + 0.5 * (J @ times(K, J))", "min(100.0, J @ u + 0.5 * (J @ times(K, J)))"),
})
edits("7.12", {
    "has steps of 1 ms at least": ("phi / dt", "phi / max(dt, 1e-3)"),
    "has steps of 1/10 s at most": ("phi / dt", "phi / min(dt, 0.1)"),
    "limits the inverse mass to 5": ("/ k_n)", "/ min(k_n, 5.0))"),
    "has an inverse mass of 0.01 at least": ("/ k_n)", "/ max(k_n, 1e-2))"),
    "limits the multiplier to 1000 N s": ("np.maximum(0.0, -(phi / dt + u_n) / k_n)",
                                          "min(1e3, np.maximum(0.0, -(phi / dt + u_n) / k_n))"),
    "checks nothing where the gap does not change":
        ("check_inverse_mass(k_n)", "if u_n == 0.0:\n        return 0.0\n    check_inverse_mass(k_n)"),
    "does not check the step where the gap is closed":
        ('check_positive("step dt [s]", dt)', 'check_positive("step dt [s]", dt if phi > 0.0 else 1.0)'),
    "accepts a negative infinite inverse mass":
        ("check_inverse_mass(k_n)", "check_inverse_mass(1.0 if k_n == -np.inf else k_n)"),
    "accepts a negative inverse mass close to 0":
        ("check_inverse_mass(k_n)", "check_inverse_mass(abs(k_n) if abs(k_n) < 1e-3 else k_n)"),
})
edits("7.13", {
    **{f"takes what misses by {part:g} of v² for a touch":
       ("squared = v_n * v_n - 2.0 * a_n * phi", "squared = v_n * v_n - 2.0 * a_n * phi; "
        f"squared = 0.0 if -{part} * v_n * v_n < squared < 0.0 else squared") for part in (1e-9, 1e-6, 1e-2)},
    "has steps of 1 ms at least": ("np.minimum(tau, dt)", "np.minimum(tau, max(dt, 1e-3))"),
    "finds no impact beyond 1000 s": ("np.minimum(tau, dt)", "min(tau, dt, 1e3)"),
    "subtracts nearly equal numbers where the ball falls from a small height":
        ("if v_n < 0.0 else", "if v_n < 0.0 and a_n > -0.5 else"),
})
edits("7.14", {
    "returns minus infinity": ("return np.inf", "return -np.inf"),
    "limits the speed to 10 m/s": ("-2.0 * v_n", "-2.0 * min(v_n, 10.0)"),
    "limits the acceleration to 100 m/s²": ("(a_n *", "(max(a_n, -100.0) *"),
})
edits("7.15", {
    "does not test for the plane where the velocity is along an axis":
        ("phi < 0.0", "phi < 0.0 and np.count_nonzero(v - dt * p.gravity) != 1"),
    "ignores a depth of a billionth of the way": ("phi < 0.0", "phi < -1e-9 * dt * np.sqrt(v @ v)"),
    "does not reflect a ball that is deeper than 1 m": ("kinematic_response(v, p.n, p.e)",
                                                        "kinematic_response(v, p.n, p.e) if phi > -1.0 else v"),
    "uses gravity in place of the acceleration for a ball that starts inside":
        ("acceleration(t, x, v, p)", "(acceleration(t, x, v, p) if gap(x, p) > 0.0 else p.gravity)"),
    "takes the acceleration at the plane for a ball that starts inside":
        ("acceleration(t, x, v, p)", "acceleration(t, x - min(0.0, gap(x, p)) * p.n, v, p)"),
    "has steps of 1 ms at least": ("v = v + dt", "dt = max(dt, 1e-3); v = v + dt"),
    "limits the speed to 100 m/s": ("x = x + dt * v", "v = np.clip(v, -100.0, 100.0); x = x + dt * v"),
    "works with one stiffness only":
        ("dt * acceleration(t, x, v, p)", "(p.stiffness == 1e4) * dt * acceleration(t, x, v, p)"),
    "works with one damping only": ("kinematic_response(v, p.n, p.e)",
                                    "kinematic_response(v, p.n, p.e if p.damping == 10.0 else 1.0)"),
})
edits("7.16", {
    "uses gravity in place of the acceleration for the time of bouncing":
        ("bouncing_time(v @ p.n, a @ p.n, p.e)", "bouncing_time(v @ p.n, p.gravity @ p.n, p.e)"),
    "omits an impact in the last picosecond of the step": ("left <= 0.0", "left <= 1e-12"),
    "omits an impact in the last billionth of the step": ("left <= 0.0", "left <= 1e-9 * dt"),
    "lets the ball lie a little too early": ("p.e) <= left", "p.e) <= 1.01 * left"),
    "lets the ball lie in the second half of its bounces": ("p.e) <= left", "p.e) <= 1.5 * left"),
    "allows twice as many impacts": ("range(MAX_IMPACTS)", "range(2 * MAX_IMPACTS)"),
    "handles at most 9,000 impacts": ("range(MAX_IMPACTS)", "range(9000)"),
    "moves a ball back by a metre at most": ("x = x - gap(x, p) * p.n", "x = x - max(gap(x, p), -1.0) * p.n"),
    "leaves a ball where it is that starts 1 nm inside":
        ("x = x - gap(x, p) * p.n", "x = x - (gap(x, p) < -1e-9) * gap(x, p) * p.n"),
    "raises Diverged for every step above 100 s":
        ("a, left = acceleration(t, x, v, p), dt",
         "if dt > 100.0:\n        raise Diverged('impacts', dt, 'take less')\n"
         "    a, left = acceleration(t, x, v, p), dt"),
})
edits("7.18", {
    **{f"returns {factor} times h/(g dt)": ("4.0 * h", f"{factor} * h") for factor in (3.9, 3.98, 4.02, 4.1)},
    "adds the time of the first two flights": ("4.0 * h / (g * dt)", "4.0 * h / (g * dt) + np.sqrt(32.0 * h / g)"),
    "has steps of 1 ms at least": ("* dt)", "* max(dt, 1e-3))"),
    "limits the height to 100 m": ("4.0 * h", "4.0 * min(h, 100.0)"),
    "limits gravity to 15 m/s²": ("(g * dt)", "(min(g, 15.0) * dt)"),
    "has gravity of 1 m/s² at least": ("(g * dt)", "(max(g, 1.0) * dt)"),
    "makes an error of one step in every second": ("4.0 * h / (g * dt)", "4.0 * h / (g * dt) * (1.0 + dt)"),
})


def slips_on(exercise, story, where):
    """Wrong answers that do not turn the slip somewhere."""
    edit(exercise, story, "-2.0 * u", f"-2.0 * (u if not {where} else (u @ n) * n)")


slips_on("7.20", "does not turn a slip below 1 mm/s", "np.sqrt(u @ u - (u @ n)**2) < 1e-3")
slips_on("7.20", "does not turn a slip below a tenth of the speed of approach", "u @ u < 1.01 * (u @ n)**2")
slips_on("7.20", "does not turn a slip above 20 times the speed of approach", "u @ u > 401.0 * (u @ n)**2")
slips_on("7.20", "does not turn the slip where the ball comes slower than 0.4 m/s", "u @ n > -0.4")
slips_on("7.20", "does not turn the slip where the ball comes faster than 6 m/s", "u @ n < -6.0")
slips_on("7.20", "does not turn the slip of a heavy ball", "np.trace(K) < 1.0")
slips_on("7.20", "does not turn the slip of a light ball", "np.trace(K) > 1e4")
slips_on("7.20", "does not turn the slip where the components of n add up to 0", "(n.sum() == 0.0)")
edit("7.20", "does nothing where the ball comes slower than 1 mm/s", "-2.0 * u", "-2.0 * (u @ n < -1e-3) * u")
edit("7.20", "takes every ball for a solid one", "solve3(K[0], K[1], K[2], -2.0 * u)",
     "-2.0 * ((u @ n) * n + 2.0 / 7.0 * (u - (u @ n) * n)) / (n @ (K @ n))")
