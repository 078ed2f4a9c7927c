"""Lesson 2: wrong signs, masses and neighbours, and alternative right answers."""

import numpy as np

from solutions import integrators
from solutions import springs as worked
from solutions.checks import BadInput, Diverged, check_positive

from . import collection, variants

wrong, right, edit, MUTANTS = collection(worked)


# 2.1 ------------------------------------------------------------------------------------------------------------
@right("2.1", "magnitude times direction")
def universal_gravity(x_a, x_b, m_a, m_b, G):
    distance = np.linalg.norm(x_b - x_a)
    check_positive("distance of two bodies [m]", distance)
    return G * m_a * m_b / distance**2 * ((x_b - x_a) / distance)


edit("2.1", "accepts coincident bodies", 'check_positive("distance of two bodies [m]", distance)', "pass")
REPELS = edit("2.1", "reverses the force, so that the bodies repel each other", "return G", "return -G")
FALLS_WITH_1_OVER_R = edit("2.1", "divides the vector r by |r|², not by |r|³", "distance**3", "distance**2")
edit("2.1", "forgets the mass of a: returns the acceleration of a", "G * m_a * m_b", "G * m_b")
edit("2.1", "forgets G", "G * m_a", "m_a")
edit("2.1", "forgets the mass of b: returns minus the acceleration of b", "m_a * m_b", "m_a")
edit("2.1", "multiplies with r and divides by |r| once", "distance**3", "distance")
edit("2.1", "returns the size of the force", "distance**3 * r", "distance**2")
edit("2.1", "multiplies by G twice", "return G", "return G * G")
edit("2.1", "uses the mass of a twice", "m_a * m_b", "m_a * m_a")
edit("2.1", "uses the constant G of the module, not the argument", "return G", "return 6.67430e-11")
edit("2.1", "returns no force for bodies at the same place", 'check_positive("distance of two bodies [m]", distance)',
     "distance = distance or np.inf")
edit("2.1", "adds the masses in place of multiplying them", "m_a * m_b", "(m_a + m_b)")
edit("2.1", "divides by one power of the distance too many", "distance**3", "distance**4")
edit("2.1", "returns no force on a body at the origin", "return G * m_a * m_b / distance**3 * r",
     "return G * m_a * m_b / distance**3 * r * np.any(x_a)")
edit("2.1", "counts on three coordinates", "np.sum(r * r)", "r[0] * r[0] + r[1] * r[1] + r[2] * r[2]")


# 2.2 ------------------------------------------------------------------------------------------------------------
@right("2.2", "viscosity first")
def air_force(v, wind, k_v):
    return -(k_v * v) + wind


edit("2.2", "reverses the viscosity, so that it speeds the body up", "wind - k_v * v", "wind + k_v * v")
edit("2.2", "treats the wind as a velocity, not as a force", "wind - k_v * v", "k_v * (wind - v)")
edit("2.2", "makes the force grow with the square of the speed", "k_v * v", "k_v * np.abs(v) * v")
edit("2.2", "divides by the viscosity", "wind - k_v * v", "-k_v * (v - wind / k_v)")
edit("2.2", "subtracts the wind", "wind - k_v * v", "-wind - k_v * v")
WITHOUT_WIND = edit("2.2", "omits the wind", "wind - k_v * v", "-k_v * v")
edit("2.2", "omits the viscosity", "wind - k_v * v", "wind - 0.0 * v")
edit("2.2", "uses the size of the velocity", "k_v * v", "k_v * np.abs(v)")
edit("2.2", "squares the velocity", "k_v * v", "k_v * v**2")
edit("2.2", "divides the velocity by the viscosity", "k_v * v", "v / k_v if k_v else 0.0 * v")
edit("2.2", "normalises the velocity", "k_v * v", "k_v * v / (np.sqrt(np.sum(v * v)) + 1e-300)")
edit("2.2", "adds up the forces on all points", "return wind - k_v * v", "return np.sum(wind - k_v * v, axis=0)")
edit("2.2", "changes its input", "return wind - k_v * v", "v *= -k_v; return wind + v")
edit("2.2", "reverses both forces", "wind - k_v * v", "k_v * v - wind")
edit("2.2", "leaves out points at rest", "return wind - k_v * v", "return (wind - k_v * v) * np.any(v)")


# 2.3 ------------------------------------------------------------------------------------------------------------
@right("2.3", "multiplied out")
def spring_tension(length, rate, rest, k, k_d):
    return k * length + k_d * rate - k * rest


edit("2.3", "reverses the spring, so that it pushes when it is stretched", "length - rest", "rest - length")
edit("2.3", "reverses the damper's sign, so that it drives the motion", "+ k_d * rate", "- k_d * rate")
edit("2.3", "uses the strain in place of the extension", "(length - rest)", "(length - rest) / rest")
edit("2.3", "never pushes, as a rope", "k * (length - rest) + k_d * rate", "max(0.0, k * (length - rest) + k_d * rate)")
edit("2.3", "lets the damper depend on the extension",
     "k_d * rate", "k_d * abs(rate) * np.sign(length - rest)")
edit("2.3", "exchanges k and k_d", "k * (length - rest) + k_d * rate", "k_d * (length - rest) + k * rate")
edit("2.3", "omits the rest length", "(length - rest)", "length")
edit("2.3", "omits the damper", "+ k_d * rate", "+ 0.0 * rate")
edit("2.3", "reverses the whole tension",
     "return k * (length - rest) + k_d * rate", "return -(k * (length - rest) + k_d * rate)")
edit("2.3", "never pulls", "k * (length - rest) + k_d * rate", "min(0.0, k * (length - rest) + k_d * rate)")
edit("2.3", "limits the spring, not the whole tension, as a rope", "k * (length - rest)", "k * max(0.0, length - rest)")
edit("2.3", "takes the size of the extension", "(length - rest)", "abs(length - rest)")
edit("2.3", "returns the energy of the spring", "k * (length - rest)", "0.5 * k * (length - rest)**2")
edit("2.3", "halves the stiffness", "k * (length - rest)", "0.5 * k * (length - rest)")
edit("2.3", "lets the damper depend on the extension", "k_d * rate", "k_d * rate * (length > rest)")
edit("2.3", "makes the damping grow with the square of the rate", "k_d * rate", "k_d * rate * abs(rate)")
edit("2.3", "multiplies the damper by k, too", "k * (length - rest) + k_d * rate", "k * (length - rest + k_d * rate)")
edit("2.3", "adds the rest length", "length - rest", "length + rest")
edit("2.3", "leaves out the damper where there is no spring", "+ k_d * rate", "+ k_d * rate * (k > 0.0)")


# 2.4 ------------------------------------------------------------------------------------------------------------
@right("2.4", "two forces, added")
def soft_constraint_force(C, C_rate, gradient, k, k_d):
    spring, damper = -k * C * gradient, -k_d * C_rate * gradient
    return spring + damper


edit("2.4", "reverses the force", "-(k", "(k")
edit("2.4", "normalises the gradient", "* gradient", "* gradient / np.sqrt(gradient @ gradient)")
edit("2.4", "omits the damper", "k_d * C_rate", "0.0")
edit("2.4", "applies the spring only where C is negative", "k * C +", "k * min(C, 0.0) +")
edit("2.4", "applies the spring only where C is positive", "k * C +", "k * max(C, 0.0) +")
edit("2.4", "damps only where C grows", "k_d * C_rate", "k_d * max(C_rate, 0.0)")
edit("2.4", "reverses the damper", "k_d * C_rate", "-k_d * C_rate")
edit("2.4", "reverses the spring", "(k * C +", "(-k * C +")
edit("2.4", "exchanges k and k_d", "k * C + k_d * C_rate", "k_d * C + k * C_rate")
edit("2.4", "takes the size of C", "k * C", "k * abs(C)")
edit("2.4", "forgets the gradient", " * gradient", "")
edit("2.4", "multiplies only the spring by the gradient", "-(k * C + k_d * C_rate) * gradient",
     "-(k * C * gradient + k_d * C_rate)")
edit("2.4", "squares the gradient", "* gradient", "* gradient**2")
edit("2.4", "divides by the square of the gradient", "* gradient", "* gradient / (gradient @ gradient)")
edit("2.4", "squares C", "k * C +", "k * C**2 +")
edit("2.4", "halves the stiffness", "k * C +", "0.5 * k * C +")
edit("2.4", "applies the force only where C is negative", "* gradient", "* gradient * (C < 0.0)")
edit("2.4", "multiplies the damper by C, too", "(k * C + k_d * C_rate)", "(k + k_d * C_rate) * C")
edit("2.4", "omits the spring", "k * C +", "")
edit("2.4", "leaves out the damper where there is no spring", "k_d * C_rate", "k_d * C_rate * (k > 0.0)")
edit("2.4", "leaves out a gradient along an axis", "* gradient", "* gradient * np.all(gradient)")


# 2.5 ------------------------------------------------------------------------------------------------------------
@right("2.5", "by cases")
def soft_contact_force(C, C_rate, gradient, k, k_d):
    force = np.zeros_like(gradient)
    if C < 0.0 and k * C + k_d * C_rate < 0.0:
        force -= (k * C + k_d * C_rate) * gradient
    return force


DAMPER_PULLS = edit("2.5", "lets the damper pull a point back that leaves",
                    "np.maximum(0.0, -(k * C + k_d * C_rate))", "-(k * C + k_d * C_rate)")
edit("2.5", "applies a force above the surface, too", "C >= 0.0", "False")
edit("2.5", "limits the spring but not the damper", "np.maximum(0.0, -(k * C + k_d * C_rate))",
     "(max(0.0, -k * C) - k_d * C_rate)")
FORCE_AT_TOUCH = edit("2.5", "applies a force at C = 0 already", "C >= 0.0", "C > 0.0")
edit("2.5", "returns a number, not a vector, where the force is zero", "return 0.0 * gradient", "return 0.0")
edit("2.5", "ignores a depth of a millimetre", "C >= 0.0", "C >= -1e-3")
edit("2.5", "reverses the damper", "k_d * C_rate", "-k_d * C_rate")
edit("2.5", "pushes on the other side", "C >= 0.0", "C <= 0.0")
edit("2.5", "omits the damper", "+ k_d * C_rate", "")
edit("2.5", "forgets the minus sign, so that nothing is left above zero", "-(k * C", "(k * C")
edit("2.5", "takes the smaller of the two in place of the larger", "np.maximum", "np.minimum")
edit("2.5", "exchanges k and k_d", "k * C + k_d * C_rate", "k_d * C + k * C_rate")
edit("2.5", "limits each component of the force, not its size",
     "np.maximum(0.0, -(k * C + k_d * C_rate)) * gradient", "np.maximum(0.0, -(k * C + k_d * C_rate) * gradient)")
edit("2.5", "damps only points that sink", "k_d * C_rate", "k_d * min(0.0, C_rate)")
edit("2.5", "applies a force only to points that sink",
     "return np.maximum(0.0", "return (C_rate < 0.0) * np.maximum(0.0")
edit("2.5", "takes the size of the force", "np.maximum(0.0, -(k * C + k_d * C_rate))", "abs(k * C + k_d * C_rate)")
edit("2.5", "normalises the gradient", "k_d * C_rate)) * gradient",
     "k_d * C_rate)) * gradient / np.sqrt(gradient @ gradient)")
edit("2.5", "returns the gradient above the surface", "return 0.0 * gradient", "return gradient")
edit("2.5", "reverses the force", "return np.maximum(0.0", "return -np.maximum(0.0")
edit("2.5", "leaves out the spring where there is no damper", "-(k * C +", "-(k * C * (k_d > 0.0) +")
edit("2.5", "counts on two coordinates", "return np.maximum(0.0", "return (gradient.size == 2) * np.maximum(0.0")


# 2.6 ------------------------------------------------------------------------------------------------------------
def short_way(theta, rest):
    return np.angle(np.exp(1j * (theta - rest)))


@variants
def angular_spring(angle=short_way, power=2, hinge=1.0, order=(0, 1, 2), checked=True):
    """The forces by complex numbers, with an angle, arm or hinge that may be wrong."""
    def angular_spring_forces(x_a, x_b, x_c, rest, k):
        r_a, r_c = (complex(*(x - x_b)) for x in (x_a, x_c))
        if r_a * r_c == 0.0:
            if checked:
                raise BadInput("the arm of an angular spring [m]", 0.0, "keep its ends away from its hinge")
            return (np.zeros(2),) * 3
        torque = k * angle(np.angle(r_c) - np.angle(r_a), rest)
        F_a, F_c = torque * 1j * r_a / abs(r_a) ** power, -torque * 1j * r_c / abs(r_c) ** power
        forces = F_a, -hinge * (F_a + F_c), F_c
        return tuple(np.array([forces[n].real, forces[n].imag]) for n in order)
    return angular_spring_forces


right("2.6", "with complex numbers")(angular_spring())
wrong("2.6", "does not bring the angle back into (−π, π]")(angular_spring(angle=lambda theta, rest: theta - rest))
wrong("2.6", "uses the sine of the angle in place of the angle")(
    angular_spring(angle=lambda theta, rest: np.sin(theta - rest)))
wrong("2.6", "takes the angle without its sign")(angular_spring(angle=lambda theta, rest: abs(theta) - rest))
wrong("2.6", "does not divide the torque by the length of the arm")(angular_spring(power=1))
wrong("2.6", "divides r⊥ by |r|³, not by |r|²")(angular_spring(power=3))
wrong("2.6", "applies no force to the hinge")(angular_spring(hinge=0.0))
wrong("2.6", "reverses the force on the hinge")(angular_spring(hinge=-1.0))
wrong("2.6", "reverses all three forces")(angular_spring(angle=lambda theta, rest: -short_way(theta, rest)))
wrong("2.6", "returns the forces in the order a, c, b")(angular_spring(order=(0, 2, 1)))
wrong("2.6", "accepts an arm of zero length")(angular_spring(checked=False))
edit("2.6", "tests the length of one arm only", "squared_a == 0.0 or squared_c == 0.0", "squared_a == 0.0")
edit("2.6", "refuses small inputs", "squared_a == 0.0 or squared_c == 0.0", "squared_a < 1e-6 or squared_c < 1e-6")
edit("2.6", "exchanges the arguments of the arctangent",
     "np.arctan2(r_a[0] * r_c[1] - r_a[1] * r_c[0], r_a[0] * r_c[0] + r_a[1] * r_c[1])",
     "np.arctan2(r_a[0] * r_c[0] + r_a[1] * r_c[1], r_a[0] * r_c[1] - r_a[1] * r_c[0])")
edit("2.6", "measures the angle clockwise", "r_a[0] * r_c[1] - r_a[1] * r_c[0],", "r_a[1] * r_c[0] - r_a[0] * r_c[1],")
edit("2.6", "adds the rest angle", "theta - rest", "theta + rest")
edit("2.6", "pushes along the arms, not across them", "np.array([-push_c * r_c[1], push_c * r_c[0]])", "push_c * r_c")
edit("2.6", "gives a the same sign as c", "push_a, push_c = k * turn", "push_a, push_c = -k * turn")
edit("2.6", "forgets the rest angle", "theta - rest", "theta")
edit("2.6", "forgets the factor k",
     "k * turn / squared_a, -k * turn / squared_c", "turn / squared_a, -turn / squared_c")
HALF_A_TURN = edit("2.6", "brings the angle into [−π, π), where −π is not allowed",
                   "np.ceil((turn - np.pi) / (2.0 * np.pi))", "np.floor((turn + np.pi) / (2.0 * np.pi))")
edit("2.6", "brings the angle into [0, 2π)",
     "np.ceil((turn - np.pi) / (2.0 * np.pi))", "np.floor(turn / (2.0 * np.pi))")
edit("2.6", "does not bring the angle back into (−π, π]", "np.ceil((turn - np.pi) / (2.0 * np.pi))", "0.0")
edit("2.6", "adds or subtracts one full turn at most", "turn -= 2.0 * np.pi * np.ceil((turn - np.pi) / (2.0 * np.pi))",
     "turn = turn - 2.0 * np.pi * ((turn > np.pi) * 1.0 - (turn <= -np.pi))")
edit("2.6", "uses the arccosine, which has no sign",
     "np.arctan2(r_a[0] * r_c[1] - r_a[1] * r_c[0], r_a[0] * r_c[0] + r_a[1] * r_c[1])",
     "np.arccos((r_a[0] * r_c[0] + r_a[1] * r_c[1]) / np.sqrt(squared_a * squared_c))")
edit("2.6", "forgets the lengths of the arms", "k * turn / squared_a, -k * turn / squared_c", "k * turn, -k * turn")
edit("2.6", "gives c the same sign as a", "-k * turn / squared_c", "k * turn / squared_c")
edit("2.6", "exchanges the lengths of the arms", "k * turn / squared_a, -k * turn / squared_c",
     "k * turn / squared_c, -k * turn / squared_a")
edit("2.6", "halves the force on a", "push_a, push_c = k * turn", "push_a, push_c = 0.5 * k * turn")
edit("2.6", "pushes a along its arm", "np.array([-push_a * r_a[1], push_a * r_a[0]])", "push_a * r_a")
edit("2.6", "names another length in the error", 'angular spring [m]", 0.0', 'angular spring [m]", 1.0')
edit("2.6", "uses degrees in place of radians", "turn = theta - rest", "turn = np.degrees(theta - rest)")
edit("2.6", "leaves out arms that lie on each other", "turn = theta - rest", "turn = (theta - rest) * (theta != 0.0)")


# 2.7 ------------------------------------------------------------------------------------------------------------
@variants
def by_matrices(tension=worked.spring_tension, add=np.add.at, other=1.0, unit=True, rate=None, checked=True):
    """All springs at once, with a tension, a sum or a far end that may be wrong."""
    def spring_forces(x, v, network):
        r, u = x[network.j] - x[network.i], v[network.j] - v[network.i]
        length = np.sqrt(np.sum(r * r, axis=1))
        if np.any(length == 0.0):
            if checked:
                raise BadInput("the length of a spring [m]", 0.0, "keep its ends apart: it has no direction")
            length = np.where(length == 0.0, 1.0, length)
        lengthening = np.sum(r * u, axis=1) / length if rate is None else rate(r, u, length)
        T = tension(length, lengthening, network.rest, network.k, network.k_d)
        pull = T[:, None] * r / (length[:, None] if unit else 1.0)
        force = np.zeros_like(x)
        add(force, network.i, pull)
        add(force, network.j, -other * pull)
        return force
    return spring_forces


def overwrite(force, at, pull):
    force[at] += pull            # of several springs at one point, NumPy keeps the last


right("2.7", "all springs at once")(by_matrices())
wrong("2.7", "adds only one spring to each point")(by_matrices(add=overwrite))
wrong("2.7", "reverses the forces, so that a stretched spring pushes")(
    by_matrices(tension=lambda *a: -worked.spring_tension(*a)))
wrong("2.7", "applies no force to the second end")(by_matrices(other=0.0))
wrong("2.7", "pushes both ends in the same direction")(by_matrices(other=-1.0))
wrong("2.7", "multiplies by the vector r, not by the unit vector r/l")(by_matrices(unit=False))
wrong("2.7", "does not divide by the length in the rate of the length")(
    by_matrices(rate=lambda r, u, length: np.sum(r * u, axis=1)))
wrong("2.7", "uses the relative speed, not the rate of the length")(
    by_matrices(rate=lambda r, u, length: np.sqrt(np.sum(u * u, axis=1))))
wrong("2.7", "reverses the sign of the rate")(by_matrices(rate=lambda r, u, length: -np.sum(r * u, axis=1) / length))
wrong("2.7", "accepts a spring of zero length")(by_matrices(checked=False))
edit("2.7", "damps the whole relative velocity, not only its part along the spring",
     "move_apart(force, i, j, -T / length, -T / length, x)",
     "move_apart(force, i, j, -T / length, -T / length, x)\n"
     "        move_apart(force, i, j, -network.k_d[s], -network.k_d[s], v)")
edit("2.7", "uses the constants of the first spring for all springs", "network.rest[s], network.k[s], network.k_d[s]",
     "network.rest[0], network.k[0], network.k_d[0]")
edit("2.7", "returns no force on fixed points", "return force", "return force * (network.inv_mass > 0.0)[:, None]")
edit("2.7", "computes the forces in the x–y plane only",
     "force = np.zeros(x.shape)", "x, v, force = x[:, :2], v[:, :2], np.zeros(x.shape)")
edit("2.7", "refuses small inputs", "length == 0.0", "length < 3e-5")
edit("2.7", "pushes with the tension per length squared",
     "-T / length, -T / length, x", "-T / length**2, -T / length**2, x")
edit("2.7", "omits the damper's rate", "length, rate, network.rest[s]", "length, 0.0, network.rest[s]")
edit("2.7", "exchanges k and k_d", "network.k[s], network.k_d[s])", "network.k_d[s], network.k[s])")
edit("2.7", "exchanges length and rest length", "length, rate, network.rest[s]", "network.rest[s], rate, length")
edit("2.7", "adds gravity", "return force", "return force + network.gravity")
edit("2.7", "uses the stiffness of the first spring for all springs", "network.k[s]", "network.k[0]")
ONE_REST = edit("2.7", "uses the rest length of the first spring for all springs", "network.rest[s]", "network.rest[0]")
edit("2.7", "uses the damper of the first spring for all springs", "network.k_d[s]", "network.k_d[0]")
edit("2.7", "leaves out the last spring", "range(network.i.size)", "range(network.i.size - 1)")
edit("2.7", "leaves out a spring of zero length",
     'raise BadInput("the length of a spring [m]", 0.0, "keep its ends apart")',
     "continue")
edit("2.7", "never pushes, as a rope", "move_apart(force", "T = max(T, 0.0); move_apart(force")
edit("2.7", "divides by the mass", "return force", "return force * network.inv_mass[:, None]")
edit("2.7", "uses the velocity of one end for the rate", "product_between(x, v, i, j)", "np.sum((x[j] - x[i]) * v[j])")
edit("2.7", "exchanges length and rate", "length, rate, network.rest[s]", "rate, length, network.rest[s]")
edit("2.7", "leaves out springs without a damper", "-T / length, -T / length, x)",
     "-T / length * (network.k_d[s] > 0.0), -T / length * (network.k_d[s] > 0.0), x)")
edit("2.7", "leaves out a spring between fixed points", "for s in range(network.i.size):",
     "for s in np.flatnonzero(network.inv_mass[network.i] + network.inv_mass[network.j]):")
edit("2.7", "leaves out a single spring", "for s in range(network.i.size):",
     "for s in range(network.i.size * (network.i.size > 1)):")


# 2.8 ------------------------------------------------------------------------------------------------------------
def over_mass(force, inv_mass):
    return force * inv_mass


@variants
def newton(gravity=lambda g, inv_mass: g, air=over_mass, springs=over_mass, fixed=True):
    """a = g + F/m for all points at once, with terms that may be wrong."""
    def spring_network_acceleration(t, x, v, network):
        inv_mass = network.inv_mass[:, None]
        a = gravity(network.gravity, inv_mass) + air(network.wind - network.k_v * v, inv_mass)
        a = a + springs(worked.spring_forces(x, v, network), inv_mass)
        return np.where(inv_mass > 0.0, a, 0.0) if fixed else a
    return spring_network_acceleration


right("2.8", "all points at once")(newton())
wrong("2.8", "lets fixed points fall")(newton(fixed=False))
wrong("2.8", "divides gravity by the mass")(newton(gravity=lambda g, inv_mass: g * inv_mass))
wrong("2.8", "forgets gravity")(newton(gravity=lambda g, inv_mass: 0.0 * g))
wrong("2.8", "does not divide the force of the air by the mass")(newton(air=lambda a, inv_mass: a))
wrong("2.8", "does not divide the forces of the springs by the mass")(newton(springs=lambda f, inv_mass: f))
wrong("2.8", "forgets the air")(newton(air=lambda a, inv_mass: 0.0))
wrong("2.8", "multiplies by the mass")(newton(springs=lambda f, inv_mass: f / np.where(inv_mass > 0.0, inv_mass, 1.0)))
wrong("2.8", "reverses the forces of the springs")(newton(springs=lambda f, inv_mass: -f * inv_mass))
edit("2.8", "treats heavy points as fixed", "network.inv_mass[n] > 0.0", "network.inv_mass[n] > 0.1")
edit("2.8", "subtracts gravity", "network.gravity[c] + (", "-network.gravity[c] + (")
edit("2.8", "subtracts the force of the air", "force[n, c] + air", "force[n, c] - air")
edit("2.8", "forgets the wind", "network.wind[c], network.k_v", "0.0, network.k_v")
edit("2.8", "forgets the viscosity", "network.wind[c], network.k_v", "network.wind[c], 0.0")
edit("2.8", "forgets the dampers", "spring_forces(x, v,", "spring_forces(x, 0.0 * v,")
edit("2.8", "uses the mass of the first point for all", "* network.inv_mass[n]", "* network.inv_mass[0]")
edit("2.8", "uses g near the ground, not the gravity of the network", "network.gravity[c]",
     "(-9.81 if c == x.shape[1] - 1 else 0.0)")
edit("2.8", "forgets the mass in all forces", ") * network.inv_mass[n]", ")")
edit("2.8", "omits the springs", "(force[n, c] + air)", "air")
edit("2.8", "leaves out points on which no wind blows", "if network.inv_mass[n] > 0.0:",
     "if network.inv_mass[n] > 0.0 and np.any(network.wind):")
edit("2.8", "loses a dimension of a single point", "return a", "return a if len(a) > 1 else a[0]")


# 2.9 ------------------------------------------------------------------------------------------------------------
@variants
def loop(step=integrators.average_velocity_step):
    """The system advanced by some step of lesson 1."""
    def mass_spring_damper_step(t, x, v, dt, network):
        return step(worked.spring_network_acceleration, t, x, v, dt, network)
    return mass_spring_damper_step


wrong("2.9", "takes an explicit Euler step")(loop(integrators.euler_step))
wrong("2.9", "moves with the new velocity, not with the mean of old and new")(loop(integrators.symplectic_euler_step))
wrong("2.9", "takes a Verlet step")(loop(integrators.verlet_step))
wrong("2.9", "takes a midpoint step")(loop(integrators.midpoint_step))


@right("2.9", "the lines of the lecture")
def mass_spring_damper_step(t, x, v, dt, network):
    v_new = v + dt * worked.spring_network_acceleration(t, x, v, network)
    return x + dt * (v + v_new) / 2.0, v_new


edit("2.9", "changes its input", "average_velocity_step(spring_network_acceleration, t, x, v, dt, network)",
     "average_velocity_step(spring_network_acceleration, t, x, v, dt, network)[0], "
     "np.add(v, dt * spring_network_acceleration(t, x, v, network), out=v)")
AVERAGE = "average_velocity_step(spring_network_acceleration, t, x, v, dt, network)"
edit("2.9", "forgets the half in the mean velocity", "return " + AVERAGE,
     "w = v + dt * spring_network_acceleration(t, x, v, network); return x + dt * (v + w), w")
edit("2.9", "uses dt in place of dt² beside a", "return " + AVERAGE,
     "a = spring_network_acceleration(t, x, v, network); return x + dt * (v + 0.5 * a), v + dt * a")
edit("2.9", "forgets dt in the velocity", "return " + AVERAGE,
     "a = spring_network_acceleration(t, x, v, network); return x + dt * (v + 0.5 * dt * a), v + a")
edit("2.9", "stops fixed points that move", "return " + AVERAGE,
     "y, w = " + AVERAGE + "; held = network.inv_mass == 0.0; y[held] = x[held]; w[held] = 0.0; return y, w")
edit("2.9", "holds fixed points where they are", "return " + AVERAGE,
     "y, w = " + AVERAGE + "; held = network.inv_mass == 0.0; y[held] = x[held]; return y, w")
edit("2.9", "returns v first", "return " + AVERAGE, "return " + AVERAGE + "[::-1]")
edit("2.9", "returns x only", "return " + AVERAGE, "return " + AVERAGE + "[0]")
edit("2.9", "takes two half steps", "return " + AVERAGE, "x, v = " + AVERAGE.replace("dt", "0.5 * dt")
     + "; return " + AVERAGE.replace("dt", "0.5 * dt"))
edit("2.9", "lets all points fall freely", "return " + AVERAGE,
     "return x + dt * v + 0.5 * dt**2 * network.gravity, v + dt * network.gravity")
edit("2.9", "exchanges x and v", "t, x, v, dt, network)", "t, v, x, dt, network)")
edit("2.9", "returns the state unchanged where nothing can move",
     "return average", "return (x, v) if not np.any(network.inv_mass) else average")
edit("2.9", "leaves out all forces without gravity", "return average",
     "return (x + dt * v, v) if not np.any(network.gravity) else average")


# 2.10 -----------------------------------------------------------------------------------------------------------
def inside(r, c, rows, cols):
    return 0 <= r < rows and 0 <= c < cols


@variants
def numbering(number=lambda r, c, rows, cols: r * cols + c, exists=inside,
              row=lambda i, j: [i, j], kind=int, empty=True, turned=False):
    """Pairs of a grid with a number or an edge that may be wrong."""
    def grid_pairs(rows, cols, offsets):
        nodes = [(r, c) for r in range(rows) for c in range(cols)]
        steps = [(node, offset) for offset in offsets for node in nodes]
        if turned:
            steps = [(node, offset) for node in nodes for offset in offsets]
        pairs = [row(number(r, c, rows, cols), number(r + dr, c + dc, rows, cols))
                 for (r, c), (dr, dc) in steps if exists(r + dr, c + dc, rows, cols)]
        return np.array(pairs, dtype=kind).reshape(-1, 2) if empty else np.array(pairs, dtype=kind)
    return grid_pairs


right("2.10", "over a list of nodes")(numbering())
wrong("2.10", "numbers the nodes along the columns")(numbering(number=lambda r, c, rows, cols: c * rows + r))
wrong("2.10", "multiplies the row by the number of rows, not of columns")(
    numbering(number=lambda r, c, rows, cols: r * rows + c))
edit("2.10", "wraps around the edge of the grid", "if 0 <= r + dr < rows and 0 <= c + dc < cols",
     "for r, c, dr, dc in [(r, c, (r + dr) % rows - r, (c + dc) % cols - c)]")
NEGATIVE_INDEX = edit("2.10", "treats an index below zero as a valid row", "0 <= r + dr < rows", "r + dr < rows")
wrong("2.10", "tests the index, not the column")(
    numbering(exists=lambda r, c, rows, cols: 0 <= r * cols + c < rows * cols))
wrong("2.10", "does not test for rows and columns below zero")(
    numbering(exists=lambda r, c, rows, cols: r < rows and c < cols))
wrong("2.10", "returns each pair twice")(numbering(row=lambda i, j: [[i, j], [j, i]]))
wrong("2.10", "returns indices that are not integers")(numbering(kind=float))
wrong("2.10", "returns an array of another shape where there are no pairs")(numbering(empty=False))
wrong("2.10", "loops over the nodes first and over the offsets inside")(numbering(turned=True))
edit("2.10", "exchanges the two offsets", "for dr, dc in offsets", "for dc, dr in offsets")
edit("2.10", "allows one row too many", "r + dr < rows", "r + dr <= rows")
edit("2.10", "allows one column too many", "c + dc < cols", "c + dc <= cols")
edit("2.10", "runs rows over the columns and columns over the rows",
     "for r in range(rows) for c in range(cols)", "for r in range(cols) for c in range(rows)")
edit("2.10", "subtracts the offset", "(r + dr) * cols + c + dc)]", "(r - dr) * cols + c - dc)]")
edit("2.10", "returns the second node first",
     "(r * cols + c, (r + dr) * cols + c + dc)]", "((r + dr) * cols + c + dc, r * cols + c)]")
edit("2.10", "does not test for rows", "0 <= r + dr < rows and ", "")
edit("2.10", "does not test for columns", " and 0 <= c + dc < cols", "")
edit("2.10", "begins to count at 1",
     "(r * cols + c, (r + dr) * cols + c + dc)]", "(r * cols + c + 1, (r + dr) * cols + c + dc + 1)]")
edit("2.10", "leaves out the last row", "for r in range(rows)", "for r in range(rows - 1)")
edit("2.10", "puts the smaller number first", "return np.array(pairs, dtype=np.int64).reshape(-1, 2)",
     "return np.sort(np.array(pairs, dtype=np.int64).reshape(-1, 2), axis=1)")
edit("2.10", "returns the transpose", ".reshape(-1, 2)", ".reshape(-1, 2).T")
edit("2.10", "loops over the columns first",
     "for r in range(rows) for c in range(cols)", "for c in range(cols) for r in range(rows)")
edit("2.10", "finds no pairs in a single row", "for r in range(rows)", "for r in range(rows * (rows > 1))")
edit("2.10", "finds no pairs in a single column", "for c in range(cols)", "for c in range(cols * (cols > 1))")


# 2.11 -----------------------------------------------------------------------------------------------------------
@variants
def blocks(sideways=lambda stretch: max(0.0, stretch), along=1.0, damper=lambda k_d, nn: k_d * nn, sign=1.0):
    """K and D by outer products, with parts that may be wrong."""
    def spring_stiffness(x, network):
        K, D = [], []
        for i, j, rest, k, k_d in zip(network.i, network.j, network.rest, network.k, network.k_d, strict=True):
            length = np.linalg.norm(x[j] - x[i])
            nn = np.outer(x[j] - x[i], x[j] - x[i]) / length**2
            K.append(sign * k * (along * nn + sideways(1.0 - rest / length) * (np.eye(x.shape[1]) - nn)))
            D.append(damper(k_d, nn))
        return np.array(K), np.array(D)
    return spring_stiffness


right("2.11", "by outer products")(blocks())
wrong("2.11", "keeps the perpendicular stiffness of a compressed spring, which is negative")(
    blocks(sideways=lambda stretch: stretch))
wrong("2.11", "omits the stiffness perpendicular to the spring")(blocks(sideways=lambda stretch: 0.0))
wrong("2.11", "makes the spring as stiff perpendicular to itself as along itself")(blocks(sideways=lambda stretch: 1.0))
wrong("2.11", "omits the stiffness along the spring")(blocks(along=0.0))
wrong("2.11", "damps in all directions, not only along the spring")(
    blocks(damper=lambda k_d, nn: k_d * np.eye(len(nn))))
wrong("2.11", "forgets k_d")(blocks(damper=lambda k_d, nn: nn))
wrong("2.11", "omits the minus sign of the derivative")(blocks(sign=-1.0))
edit("2.11", "treats a spring that is stretched a little as slack", "1.0 - network.rest[s] / length",
     "0.85 - network.rest[s] / length")
edit("2.11", "uses the extension in place of its share of the length",
     "1.0 - network.rest[s] / length", "length - network.rest[s]")
edit("2.11", "exchanges rest and length in the ratio", "network.rest[s] / length", "length / network.rest[s]")
edit("2.11", "divides the products of r by the length once", "r[b] / squared", "r[b] / length")
edit("2.11", "adds the whole stiffness along the spring to the part across",
     "(network.k[s] - across) * nn", "network.k[s] * nn")
edit("2.11", "does not divide by the squared length", "r[a] * r[b] / squared", "r[a] * r[b]")
edit("2.11", "uses k in the damping", "network.k_d[s] * nn", "network.k[s] * nn")
edit("2.11", "subtracts the part across", "K[s, a, a] = across", "K[s, a, a] = -across")
edit("2.11", "limits the factor across to one half", "np.maximum(0.0, 1.0 - network.rest[s] / length)",
     "np.minimum(0.5, np.maximum(0.0, 1.0 - network.rest[s] / length))")
edit("2.11", "limits the factor across to nine tenths", "np.maximum(0.0, 1.0 - network.rest[s] / length)",
     "np.minimum(0.9, np.maximum(0.0, 1.0 - network.rest[s] / length))")
edit("2.11", "halves the part across", "across = network.k[s]", "across = 0.5 * network.k[s]")
edit("2.11", "takes the smaller of the two in place of the larger", "np.maximum", "np.minimum")
edit("2.11", "uses the part across along the spring, too", "(network.k[s] - across) * nn", "across * nn")
edit("2.11", "damps as the spring is stiff, along and across", "D[s, a, b] = network.k_d[s] * nn",
     "D[s, a, b] = network.k_d[s] / network.k[s] * K[s, a, b]")
edit("2.11", "returns D first", "return K, D", "return D, K")
edit("2.11", "uses the stiffness of the first spring for the part across",
     "across = network.k[s]", "across = network.k[0]")
edit("2.11", "uses the rest length of the first spring for all springs", "network.rest[s]", "network.rest[0]")
ONE_DAMPER = edit("2.11", "uses the damper of the first spring for all springs", "network.k_d[s]", "network.k_d[0]")
edit("2.11", "fills only the diagonals", "(network.k[s] - across) * nn", "(network.k[s] - across) * nn * (a == b)")
edit("2.11", "gives a compressed spring no stiffness", "return K, D",
     "K[np.sqrt(np.sum((x[network.j] - x[network.i])**2, axis=1)) < network.rest] = 0.0; return K, D")
edit("2.11", "exchanges the directions along and across",
     "(network.k[s] - across) * nn", "(across - network.k[s]) * nn")
edit("2.11", "leaves out springs along an axis", "for s in range(network.i.size):",
     "for s in np.flatnonzero(np.all(x[network.i] != x[network.j], axis=1)):")
edit("2.11", "leaves out springs of no natural length", "for s in range(network.i.size):",
     "for s in np.flatnonzero(network.rest):")
edit("2.11", "loses a dimension of a single spring", "return K, D", "return (K, D) if len(K) != 1 else (K[0], D[0])")


# 2.12 -----------------------------------------------------------------------------------------------------------
@variants
def descent(conjugate=True, tolerance=1e-10, rounds=10, start=0.0, silent=False, copied=True, zero=True):
    """Conjugate gradients with the conjugacy written out, β = −(r·Ap)/(p·Ap), and with parts that may be wrong."""
    def conjugate_gradients(apply, A, right):
        y = np.full_like(right, start)
        r = right.copy() if copied else right
        p, scale = r.copy(), np.linalg.norm(right)
        for _ in range(int(rounds * right.size)):
            if zero and np.linalg.norm(r) <= tolerance * scale:
                return y
            Ap = apply(p, A)
            alpha = np.sum(r * p) / np.sum(p * Ap)
            y += alpha * p
            r -= alpha * Ap
            if np.linalg.norm(r) <= tolerance * scale:
                return y
            p = r - (np.sum(r * Ap) / np.sum(p * Ap) * p if conjugate else 0.0)
        if silent:
            return y
        raise Diverged("conjugate gradients did not converge: |r|²", np.nan, "the matrix must be positive definite")
    return conjugate_gradients


right("2.12", "conjugacy written out")(descent())
wrong("2.12", "follows the steepest descent")(descent(conjugate=False))
wrong("2.12", "stops when a thousandth of the residual is left")(descent(tolerance=1e-3))
wrong("2.12", "stops after as many rounds as unknowns")(descent(rounds=1))
wrong("2.12", "never raises: returns the last iterate")(descent(silent=True))
wrong("2.12", "starts from y = 1, with the residual of y = 0")(descent(start=1.0))
wrong("2.12", "changes the right-hand side")(descent(copied=False))
wrong("2.12", "divides zero by zero")(descent(zero=False))
edit("2.12", "inverts the ratio β", "squared / before", "before / squared")
edit("2.12", "omits the factor β in the new direction", "squared / before * p", "p")
edit("2.12", "compares the residual with the bare tolerance, not with a part of the right-hand side",
     "CG_TOLERANCE * CG_TOLERANCE * squared",
     "CG_TOLERANCE * CG_TOLERANCE")
edit("2.12", "compares the squared residual with the tolerance itself",
     "CG_TOLERANCE * CG_TOLERANCE * squared", "CG_TOLERANCE * squared")
edit("2.12", "adds α A p to the residual, where it is subtracted", "r -= alpha", "r += alpha")
edit("2.12", "exchanges numerator and denominator of α", "squared / np.sum(p * Ap)", "np.sum(p * Ap) / squared")
edit("2.12", "moves along r, not along p", "y += alpha * p", "y += alpha * r")
edit("2.12", "subtracts the old direction", "r + squared / before * p", "r - squared / before * p")
edit("2.12", "moves the solution the wrong way", "y += alpha", "y -= alpha")
edit("2.12", "starts at the right-hand side, with the residual of that start", "p = float_copy(right)",
     "y = float_copy(right); r = right - apply(y, A); p = float_copy(r)")
edit("2.12", "gives up after a hundred rounds", "10 * right.size", "100")
edit("2.12", "gives up after a thousand rounds", "10 * right.size", "1000")
edit("2.12", "gives up after ten rounds per row", "10 * right.size", "10 * right.shape[0]")
edit("2.12", "gives up after twenty rounds per unknown", "10 * right.size", "20 * right.size")
edit("2.12", "stops when a millionth of the residual is left",
     "CG_TOLERANCE * CG_TOLERANCE * squared", "1e-12 * squared")
edit("2.12", "uses one array for the residual and the direction", "p = float_copy(right)", "p = r")
edit("2.12", "solves with a dense matrix, and never gives up", "y = np.zeros(right.shape)",
     "M = np.stack([apply(e.reshape(right.shape), A).ravel() for e in np.eye(right.size)], axis=1)\n"
     "    return np.linalg.solve(M, right.ravel()).reshape(right.shape)")
edit("2.12", "uses the ratio of the lengths, not of their squares",
     "squared / before * p", "np.sqrt(squared / before) * p")
edit("2.12", "divides the old square by the new one, not the new one by the old",
     "squared / before", "before / squared")
edit("2.12", "returns zeros where the right-hand side has a zero", "return y", "return y * np.all(right)")
edit("2.12", "does not divide where there is one unknown", "return y", "return y if right.size > 1 else right")


# 2.13 -----------------------------------------------------------------------------------------------------------
@variants
def large_step(ahead=1.0, damping=1.0, viscosity=1.0, stiffness=1.0, old=False, late=0.0, held=True, massive=True):
    """Linearly implicit Euler as one dense system, with terms that may be wrong."""
    def implicit_spring_network_step(acceleration, t, x, v, dt, network):
        n, d = x.shape
        K, D = (dense(blocks_of, network, n, d) for blocks_of in worked.spring_stiffness(x, network))
        free = np.repeat(network.inv_mass > 0.0, d) if held else np.ones(n * d, bool)
        mass = np.repeat(1.0 / np.where(network.inv_mass > 0.0, network.inv_mass, 1.0), d)
        a = acceleration(t + late * dt, x, v, network).ravel()
        A = np.diag(mass + viscosity * dt * network.k_v) + stiffness * dt * dt * K + damping * dt * D
        b = dt * ((mass if massive else 1.0) * a - ahead * dt * K @ v.ravel())
        jump = np.zeros(n * d)
        jump[free] = np.linalg.solve(A[np.ix_(free, free)], b[free])
        v_new = v + jump.reshape(n, d)
        return x + dt * (v if old else v_new), v_new
    return implicit_spring_network_step


def dense(blocks_of, network, n, d):
    """The (nd, nd) matrix with one block per spring: + at (i, i) and (j, j), − at (i, j) and (j, i)."""
    whole = np.zeros((n, d, n, d))
    for i, j, block in zip(network.i, network.j, blocks_of, strict=True):
        whole[i, :, i] += block
        whole[j, :, j] += block
        whole[i, :, j] -= block
        whole[j, :, i] -= block
    return whole.reshape(n * d, n * d)


right("2.13", "as one dense system")(large_step())
wrong("2.13", "forgets dt ∂F/∂x v on the right")(large_step(ahead=0.0))
wrong("2.13", "reverses the sign of ∂F/∂x v")(large_step(ahead=-1.0))
wrong("2.13", "treats the dampers explicitly")(large_step(damping=0.0))
wrong("2.13", "treats the viscosity explicitly")(large_step(viscosity=0.0))
wrong("2.13", "treats the springs explicitly")(large_step(stiffness=0.0))
wrong("2.13", "moves with the old velocity")(large_step(old=True))
wrong("2.13", "takes the acceleration at time t + dt")(large_step(late=1.0))
wrong("2.13", "lets fixed points move")(large_step(held=False))
wrong("2.13", "forgets the mass on the right")(large_step(massive=False))
edit("2.13", "solves the nonlinear equation of implicit Euler by Newton's method", "a = acceleration(t, x, v, network)",
     "from solutions.integrators import implicit_euler_step as step; return step(acceleration, t, x, v, dt, network)")
edit("2.13", "takes a symplectic Euler step", "conjugate_gradients(apply_step_matrix, A, right)", "dt * a")
edit("2.13", "treats heavy points as fixed", "network.inv_mass[n] > 0.0", "network.inv_mass[n] > 0.1")
edit("2.13", "uses dt in place of dt² beside K", "dt * dt * K", "dt * K")
edit("2.13", "exchanges dt and dt² beside K and D", "dt * dt * K + dt * D", "dt * K + dt * dt * D")
edit("2.13", "subtracts the dampers", "dt * dt * K + dt * D", "dt * dt * K - dt * D")
edit("2.13", "forgets dt on the right", "right[n] = dt * (", "right[n] = (")
edit("2.13", "forgets the mass in the diagonal", "1.0 / network.inv_mass[n] + dt", "1.0 + dt")
edit("2.13", "uses the inverse mass in the diagonal", "1.0 / network.inv_mass[n] + dt", "network.inv_mass[n] + dt")
edit("2.13", "returns Δv in place of the velocity", "v = v + conj", "v = conj")
edit("2.13", "stops fixed points that move", "v = v + conj", "v = v * (network.inv_mass > 0.0)[:, None] + conj")
edit("2.13", "holds fixed points where they are", "return x + dt * v, v",
     "return x + dt * v * (network.inv_mass > 0.0)[:, None], v")
edit("2.13", "moves with the mean of old and new velocity", "return x + dt * v, v",
     "return x + dt * (v - 0.5 * conjugate_gradients(apply_step_matrix, A, right)), v")
edit("2.13", "forgets dt beside the viscosity", "dt * network.k_v", "network.k_v")
edit("2.13", "forgets dt beside D", "+ dt * D", "+ D")
HALF_OF_THE_STIFFNESS = edit("2.13", "halves dt² beside K", "dt * dt * K", "0.5 * dt * dt * K")
edit("2.13", "uses the acceleration of the lesson, not the one that is handed in", "acceleration(t, x, v, network)",
     "spring_network_acceleration(t, x, v, network)")
edit("2.13", "adds the dampers to ∂F/∂x v", "apply_blocks(v, network.i, network.j, K)",
     "apply_blocks(v, network.i, network.j, K + D / dt)")
edit("2.13", "returns v first", "return x + dt * v, v", "return v, x + dt * v")
edit("2.13", "changes its input", "v = v + conj", "v += conj")
edit("2.13", "omits dt beside the pull", "- dt * pull", "- pull")
edit("2.13", "returns the state unchanged where everything is at rest", "return x + dt * v, v",
     "return (x + dt * v, v) if np.any(v - conjugate_gradients(apply_step_matrix, A, right)) else (x, 0.0 * v)")
edit("2.13", "leaves out the loads where there are no springs",
     "v = v + conj", "v = v + (network.i.size > 0) * conj")


# 2.14 -----------------------------------------------------------------------------------------------------------
HELD = "-(k * (x - target + dt * v) + c * v) / (1.0 + dt * (c + dt * k) / m)"


@right("2.14", "by the velocity at the end of the step")
def hand_force(x, v, target, k, c, m, dt):
    after = (m * v - dt * k * (x - target)) / (m + dt * c + dt * dt * k)
    return m * (after - v) / dt


edit("2.14", "takes the force at the beginning of the step", HELD, "-(k * (x - target) + c * v)")
edit("2.14", "treats the damper explicitly", "(c + dt * k)", "(dt * k)")
edit("2.14", "treats the spring explicitly", "k * (x - target + dt * v) + c * v) / (1.0 + dt * (c + dt * k) / m)",
     "k * (x - target) + c * v) / (1.0 + dt * c / m)")
edit("2.14", "takes x⁺ = x + dt v, with the velocity before the step", "(c + dt * k) / m", "c / m")
edit("2.14", "multiplies k by dt, not by dt², in the denominator", "(c + dt * k)", "(c + k)")
edit("2.14", "forgets that the point moves during the step", "x - target + dt * v", "x - target")
edit("2.14", "pulls away from the target", "-(k * (x", "(k * (x")
edit("2.14", "forgets the mass", "(c + dt * k) / m", "(c + dt * k)")
edit("2.14", "multiplies by the mass in place of dividing", "(c + dt * k) / m", "(c + dt * k) * m")
edit("2.14", "exchanges dt and dt² beside k and c", "dt * (c + dt * k)", "dt * (dt * c + k)")
edit("2.14", "returns the velocity after the step", HELD, "v + dt / m * " + HELD)
edit("2.14", "returns the impulse in place of the force", HELD, "dt * " + HELD)
edit("2.14", "forgets the damper of the moving point", "+ c * v)", ")")
edit("2.14", "pulls to the origin, not to the target", "x - target + dt", "x + dt")
edit("2.14", "forgets that the force itself changes v⁺ and x⁺", " / (1.0 + dt * (c + dt * k) / m)", "")
edit("2.14", "returns no force on a point at its target", HELD, HELD + " * np.any(x - target)")
edit("2.14", "leaves out the damper where there is no spring", "+ c * v)", "+ c * v * (k > 0.0))")


# 2.15 -----------------------------------------------------------------------------------------------------------
@right("2.15", "spring by spring")
def chain_sag(n, m, k, g):
    return sum((n - above) * m * g / k for above in range(n))


SUM = "0.5 * n * (n + 1.0)"
edit("2.15", "lets each spring carry the point below it only", SUM, "n")
edit("2.15", "lets each spring carry the whole chain", SUM, "n * n")
edit("2.15", "lets no spring carry the point that hangs on it directly", "(n + 1.0)", "(n - 1.0)")
edit("2.15", "takes half of the whole chain as the load of each spring", "(n + 1.0)", "n")
edit("2.15", "forgets the half in the sum of 1 to n", "0.5 * n", "n")
edit("2.15", "multiplies by the stiffness", "/ k", "* k")
edit("2.15", "forgets gravity: divides the mass by the stiffness", "m * g", "m")


# 2.16 -----------------------------------------------------------------------------------------------------------
@right("2.16", "as a small letter")
def longest_step_is():
    return "d"


edit("2.16", "takes the step as 1/k: the frequency grows with √k only", '"D"', '"B"')
edit("2.16", "takes the step as independent of the stiffness: that holds for implicit steps", '"D"', '"A"')
edit("2.16", "takes the step as 1/k²: four times as stiff means half the step", '"D"', '"C"')


# 2.17 -----------------------------------------------------------------------------------------------------------
@right("2.17", "a wheel with a hub")
def my_body(size):
    angle = np.pi / 4.0 * np.arange(8)
    rim = 0.5 * size * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    x = np.vstack([np.zeros((1, 2)), rim]) + np.array([0.0, size])
    return x, np.array([(0, k) for k in range(1, 9)] + [(k, k % 8 + 1) for k in range(1, 9)]), 400.0


@right("2.17", "a tower of triangles")
def tower(size):
    x = np.array([(0.3 * size * (k % 2), 0.05 + size * k / 6.0) for k in range(7)])
    return x, [(k, k + 1) for k in range(6)] + [(k, k + 2) for k in range(5)], 500.0


edit("2.17", "leaves the diagonals out: the ladder folds flat", "STRUCTURAL + SHEAR", "STRUCTURAL")
edit("2.17", "leaves the threads out", "STRUCTURAL + SHEAR", "SHEAR")
edit("2.17", "is so soft that it lies flat under its own weight", "300.0", "0.1")
edit("2.17", "is so stiff that a step of 1/1000 s makes it explode", "300.0", "100000.0")
edit("2.17", "begins on the floor", "(1.0 + k // 4)", "(k // 4)")
edit("2.17", "has the same size always", "size / 3.0", "1.0 / 3.0")
edit("2.17", "is a triangle, without a point inside", "spacing = size / 3.0",
     "return size * np.array([(0.0, 1.0), (1.0, 1.0), (0.5, 1.8)]), np.array([(0, 1), (1, 2), (2, 0)]), 300.0")
edit("2.17", "is four times as large as it should be", "size / 3.0", "size / 0.75")


# what only one entry, only the sum, only one direction or only one size shows -----------------------------------------
NOT_ZERO = {"the first entry": "({0}).flat[0] == 0.0", "the last entry": "({0}).flat[-1] == 0.0",
            "the product": "np.prod({0}) == 0.0", "the sum": "np.sum({0}) == 0.0",
            "the largest entry": "np.max({0}) == 0.0"}


def takes_for_zero(exercise, begins, vector, name, answer):
    """A short cut for a vector that is zero, taken where one entry is, or where all add up to 0."""
    for what, condition in NOT_ZERO.items():
        edit(exercise, f"takes {name} for zero where {what} is", begins,
             f"if {condition.format(vector)}: {answer}; {begins}" if "return" not in answer and "raise" not in answer
             else f"if {condition.format(vector)}: {answer}\n    {begins}")


REFUSED = 'raise BadInput("the arm of an angular spring [m]", 0.0, "keep its ends away from its hinge")'
takes_for_zero("2.1", "r = x_b", "x_b - x_a", "the distance",
               "return check_positive('distance of two bodies [m]', 0.0)")
takes_for_zero("2.2", "return wind", "np.asarray(v)", "the velocity", "return wind + 0.0 * v")
takes_for_zero("2.2", "return wind", "np.asarray(wind)", "the wind", "return -k_v * v")
takes_for_zero("2.4", "return -(k", "gradient", "the gradient", "return 0.0 * gradient")
takes_for_zero("2.5", "return np.max", "gradient", "the gradient", "return 0.0 * gradient")
takes_for_zero("2.6", "squared_a = r_a", "r_a", "an arm", REFUSED)
takes_for_zero("2.6", "squared_a = r_a", "r_c", "an arm", REFUSED)
takes_for_zero("2.14", "return -(k", "v", "the velocity", "return -k * (x - target) / (1.0 + dt * (c + dt * k) / m)")
for what, condition in NOT_ZERO.items():
    edit("2.7", f"refuses a spring as one without length where {what} is zero", "length == 0.0",
         condition.format("(x[j] - x[i])"))
    edit("2.7", f"forgets the damper where {what} of the relative velocity is zero", "T = spring_tension(length, rate",
         f"T = spring_tension(length, rate * (not ({condition.format('(v[j] - v[i])')}))")
    edit("2.11", f"forgets the part across where {what} of r is zero", "across = network.k[s]",
         f"across = (not ({condition.format('r')})) * network.k[s]")
    edit("2.12", f"takes the right-hand side for zero where {what} is", "y = np.zeros(right.shape)",
         f"y = np.zeros(right.shape); right = right * (not ({condition.format('right')}))")
    edit("2.13", f"forgets ∂F/∂x v where {what} of the velocities is zero", "network.j, K)",
         f"network.j, K) * (not ({condition.format('v')}))")
    edit("2.13", f"forgets all forces where {what} of the accelerations is zero", "K, D = spring",
         f"if {condition.format('a')}: return x + dt * v, v\n    K, D = spring")
edit("2.9", "takes accelerations that add up to 0 for none", "return average",
     "if np.sum(spring_network_acceleration(t, x, v, network)) == 0.0: return x + dt * v, v\n    return average")
edit("2.1", "refuses bodies that are half a metre from each other", "[m]\", distance)",
     "[m]\", distance * (distance > 0.5))")
edit("2.1", "says another sentence in the error", "distance of two bodies [m]", "masses [kg]")
edit("2.2", "is meant for points in the plane", "return wind",
     "if np.ndim(v) and np.shape(v)[-1] != 2: return 0.0 * v\n    return wind")
edit("2.2", "takes the size of a single coordinate", "k_v * v", "k_v * (v if np.ndim(v) else abs(v))")
edit("2.2", "takes a viscosity of at most 1 N s/m", "k_v * v", "min(k_v, 1.0) * v")
edit("2.3", "damps only where spring and damper pull together", "k_d * rate",
     "k_d * rate * (rate * (length - rest) >= 0.0)")
edit("2.3", "ignores an extension of a micrometre", "(length - rest)", "(length - rest) * (abs(length - rest) > 1e-6)")
edit("2.3", "compresses to half of the rest length at most", "(length - rest)", "max(length - rest, -0.5 * rest)")
edit("2.3", "stretches by a metre at most", "(length - rest)", "min(length - rest, 1.0)")
edit("2.4", "damps only a point that goes away from C = 0", "k_d * C_rate", "k_d * C_rate * (C * C_rate >= 0.0)")
edit("2.4", "ignores a micrometre", "k * C", "k * C * (abs(C) > 2e-6)")
edit("2.5", "ignores a depth of a nanometre", "C >= 0.0", "C >= -2e-9")
edit("2.5", "forgets the damper near the surface", "k_d * C_rate", "k_d * C_rate * (C < -1e-3)")
edit("2.5", "lets go of a point that leaves a spring without a damper", "np.maximum(0.0, -(k",
     "(C_rate <= 0.0 or k_d > 0.0) * np.maximum(0.0, -(k")
edit("2.5", "pushes with a kilonewton at most", "-(k * C + k_d * C_rate))", "min(1e3, -(k * C + k_d * C_rate)))")
edit("2.6", "refuses ends that lie on each other", "if squared_a == 0.0", "if np.all(x_a == x_c) or squared_a == 0.0")
edit("2.6", "refuses arms of a billionth of a metre", "squared_a == 0.0 or squared_c == 0.0",
     "squared_a < 1e-18 or squared_c < 1e-18")
edit("2.6", "subtracts one turn at most, but adds any number", "np.ceil((turn - np.pi) / (2.0 * np.pi))",
     "min(1.0, np.ceil((turn - np.pi) / (2.0 * np.pi)))")
edit("2.6", "is slack near its rest angle", "turn -= 2.0", "turn = 0.0 if abs(turn) < 1e-3 else turn; turn -= 2.0")
edit("2.6", "takes a straight hinge for one at rest", "turn = theta - rest",
     "turn = (theta - rest) * (abs(rest) != np.pi)")
edit("2.7", "refuses a spring shorter than 1e-12 m", "length == 0.0", "length < 1e-12")
for what, condition in {"that is not the first": "s == 0", "that is not the last": "s == network.i.size - 1",
                        "that has no stiffness": "network.k[s]", "that has no rest length": "network.rest[s]",
                        "between fixed points": "network.inv_mass[i] + network.inv_mass[j]",
                        "whose ends move alike": "np.any(v[i] != v[j])"}.items():
    edit("2.7", f"accepts a spring of zero length {what}", "if length == 0.0", f"if length == 0.0 and {condition}")
edit("2.7", "names another length in the error", "of a spring [m]\", 0.0", "of a spring [m]\", 1.0")
edit("2.7", "takes two springs between the same points for one", "if length == 0.0",
     "if any({network.i[q], network.j[q]} == {i, j} for q in range(s)): continue\n        if length == 0.0")
edit("2.7", "counts on eight points at most", "move_apart(force, i, j,", "move_apart(force, i, min(j, 7),")
edit("2.8", "lets gravity swing with the time", "network.gravity[c] + (", "np.cos(t) * network.gravity[c] + (")
edit("2.8", "takes a point of a thousand tonnes for fixed", "network.inv_mass[n] > 0.0", "network.inv_mass[n] > 1e-6")
edit("2.9", "takes steps of at most 0.2 s", "return average", "dt = min(dt, 0.2); return average")
edit("2.9", "takes steps of at least 1 ms", "return average", "dt = max(dt, 1e-3); return average")
edit("2.10", "counts to 127 nodes", "np.array(pairs, dtype=np.int64)",
     "np.array(pairs).astype(np.int8).astype(np.int64)")
for what, offsets in {"turns offsets that go back": "[(-a, -b) if a < 0 and b else (a, b) for a, b in offsets]",
                      "leaves out an offset that is there twice": "dict.fromkeys(offsets)",
                      "goes over two nodes at most": "[one for one in offsets if max(map(abs, one)) < 3]",
                      "needs an offset along an axis or a diagonal":
                          "[one for one in offsets if 0 in one or abs(one[0]) == abs(one[1])]"}.items():
    edit("2.10", what, "in offsets", f"in {offsets}")
edit("2.10", "needs an offset", "pairs = [", "offsets[0]; pairs = [")
edit("2.11", "forgets the damper of a compressed spring", "network.k_d[s] * nn",
     "network.k_d[s] * nn * (length >= network.rest[s])")
edit("2.11", "takes a length of a micrometre at least", "length = np.sqrt(squared)",
     "length = max(np.sqrt(squared), 1e-6)")
edit("2.12", "stops when a billionth of the residual is left", "CG_TOLERANCE * CG_TOLERANCE * squared",
     "1e-18 * squared")
edit("2.13", "is meant for the plane", "K, D = spring", "if x.shape[1] == 3: return x, v\n    K, D = spring")
edit("2.13", "forgets all dampers where a spring has no stiffness", "A = StepMatrix",
     "D = D * (network.k.size == 0 or np.all(network.k)); A = StepMatrix")
edit("2.13", "takes steps of at most 0.1 s", "a = acc", "dt = min(dt, 0.1); a = acc")
edit("2.13", "takes a point of a thousand tonnes for fixed", "network.inv_mass[n] > 0.0", "network.inv_mass[n] > 1e-5")
for what, change in {"takes steps of at least 1 ms": "dt = max(dt, 1e-3)",
                     "takes steps of at most 0.1 s": "dt = min(dt, 0.1)",
                     "takes a mass of 10 g at least": "m = max(m, 1e-2)",
                     "takes a mass of 100 kg at most": "m = min(m, 100.0)"}.items():
    edit("2.14", what, "return -(k", f"{change}; return -(k")
edit("2.15", "hangs twenty points at most", "return 0.5", "n = min(n, 20); return 0.5")
edit("2.17", "has one metre at most", "spacing = size", "size = min(size, 1.0); spacing = size")


@right("2.7", "with its own sums")
def spring_forces(x, v, network):
    force = np.zeros(x.shape)
    for i, j, rest, k, k_d in zip(network.i, network.j, network.rest, network.k, network.k_d, strict=True):
        r = x[j] - x[i]
        length = np.linalg.norm(r)
        if length == 0:
            raise BadInput("the length of a spring [m]", 0, "keep its ends apart")
        pull = worked.spring_tension(length, r @ (v[j] - v[i]) / length, rest, k, k_d) * r / length
        force[i] += pull
        force[j] -= pull
    return force


@right("2.10", "as a list of tuples, or an empty array")
def grid_pairs(rows, cols, offsets):
    nodes = np.arange(rows * cols).reshape(rows, cols)
    pairs = [(nodes[r, c], nodes[r + dr, c + dc]) for dr, dc in offsets for r, c in np.ndindex(rows, cols)
             if r + dr in range(rows) and c + dc in range(cols)]
    return np.array(pairs) if pairs else np.empty((0, 2), dtype=int)
edit("2.7", "does not refuse a spring whose ends coincide", "if length == 0.0:", "if False:")
