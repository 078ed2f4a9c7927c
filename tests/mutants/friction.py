"""Lesson 3: friction with a wrong sign, mass, step or case."""

import functools

import numpy as np

from solutions import friction as worked

from . import collection, variants

wrong, right, edit, MUTANTS = collection(worked)
tangential, cone_radius = worked.tangential, worked.cone_radius


def size(y):
    return np.linalg.norm(y)


def unit(y):
    return y / size(y) if size(y) > 0.0 else 0.0 * y


def partial_tests(of):
    """(in words, in code): numbers of a vector, the text `of`, that a careless test for zero asks in its place."""
    return [(words, code.format(of)) for words, code in (
        ("its first coordinate", "{}[0]"), ("its last coordinate", "{}[-1]"), ("its largest coordinate", "np.max({})"),
        ("the sum of its coordinates", "np.sum({})"), ("the product of its coordinates", "np.prod({})"))]


# 3.1 ------------------------------------------------------------------------------------------------------------
@right("3.1", "one by one")
def normal_force(F, n):
    total = sum(-a * b for a, b in zip(F, n, strict=True))
    return total if total > 0.0 else 0.0


edit("3.1", "omits the minus sign of F · n", "-(F @ n)", "F @ n")
edit("3.1", "returns a negative normal force where the body is lifted", "np.maximum(0.0, -(F @ n))", "-(F @ n)")
edit("3.1", "takes the size of F for the normal force", "np.maximum(0.0, -(F @ n))", "np.sqrt(F @ F) * (F @ n < 0.0)")
edit("3.1", "uses the last coordinate of F only", "-(F @ n)", "-F[-1]")
edit("3.1", "returns the vector, not its size", "np.maximum(0.0, -(F @ n))", "max(0.0, -(F @ n)) * n")
edit("3.1", "ignores a small load", "np.maximum(0.0, -(F @ n))", "max(0.0, -(F @ n)) * (F @ n < -1e-3)")
HOLDS_WHAT_LIFTS = edit("3.1", "returns the size of the normal part, regardless of its direction",
                        "np.maximum(0.0, -(F @ n))", "np.abs(F @ n)")
edit("3.1", "takes the smaller of the two in place of the larger", "np.maximum", "np.minimum")
edit("3.1", "leaves out a force straight into the support", "-(F @ n))", "-(F @ n)) * np.any(tangential(F, n))")
edit("3.1", "takes a load below 10 nN for none", "return np.maximum",
     "return 0.0 if np.isclose(F @ n, 0.0) else np.maximum")
edit("3.1", "takes a load of at most 100 N", "np.maximum(0.0, -(F @ n))", "np.clip(-(F @ n), 0.0, 100.0)")


# 3.2 ------------------------------------------------------------------------------------------------------------
@variants
def holding(sign=-1.0, rim=True, clamp=True, load=lambda F, n: max(0.0, -(F @ n)), part=tangential, checked=True):
    """Static friction by a clamp, with parts that may be wrong."""
    def static_friction(F, n, mu_s):
        pull, F_N = part(F, n), load(F, n)
        limit = cone_radius(mu_s, F_N) if checked else (mu_s * F_N if F_N > 0.0 else 0.0)
        if size(pull) <= limit or not clamp:
            return sign * pull
        return sign * limit * unit(pull) if rim else 0.0 * pull
    return static_friction


right("3.2", "by a clamp")(holding())
wrong("3.2", "pushes along the applied force, not against it")(holding(sign=1.0))
wrong("3.2", "returns no friction beyond the cone")(holding(rim=False))
wrong("3.2", "does not limit the friction to μ N")(holding(clamp=False))
wrong("3.2", "cancels all of F, its normal part included")(holding(part=lambda F, n: F))
wrong("3.2", "takes the size of F for the normal force")(holding(load=lambda F, n: size(F)))
wrong("3.2", "takes a lifting force for a load")(holding(load=lambda F, n: abs(F @ n)))
wrong("3.2", "accepts a negative μ")(holding(checked=False))
edit("3.2", "multiplies an infinite μ by a normal force of zero",
     "cone_radius(mu_s, normal_force(F, n))", "cone_radius(mu_s, 1.0) * normal_force(F, n)")
edit("3.2", "always returns the largest friction, μ N", "size <= limit", "size == 0.0")
edit("3.2", "exchanges the two cases", "size <= limit", "size > limit")
edit("3.2", "does not divide by |F_t| beyond the limit", "-limit / size * F_t", "-limit * F_t")
edit("3.2", "multiplies F_t by μ in place of the normal force",
     "cone_radius(mu_s, normal_force(F, n))", "cone_radius(mu_s, size)")
edit("3.2", "reverses the normal", "normal_force(F, n)", "normal_force(F, -n)")
edit("3.2", "forgets the minus sign beyond the limit", "else -limit", "else limit")
edit("3.2", "forgets the minus sign while it holds", "return -F_t", "return F_t")
edit("3.2", "forgets μ", "cone_radius(mu_s, normal_force(F, n))", "normal_force(F, n)")
edit("3.2", "compares the squared force with the limit", "np.sqrt(F_t @ F_t)", "F_t @ F_t")
edit("3.2", "compares the squared force with the limit", "size <= limit", "size * size <= limit")
edit("3.2", "compares the size of F, not that of its tangential part, with the limit", "size <= limit",
     "np.sqrt(F @ F) <= limit")
edit("3.2", "holds a body that nothing presses", "size <= limit", "size <= limit or F @ n == 0.0")
for words, test in partial_tests("F_t"):
    edit("3.2", f"takes a pull for none if {words} is 0", "return -", f"return 0.0 * F_t if {test} == 0.0 else -")
    edit("3.2", f"does not limit the friction against a pull if {words} is 0", "size <= limit",
         f"size <= limit or {test} == 0.0")
edit("3.2", "takes a pull below 10 nN for none", "return -F_t", "return 0.0 * F_t if np.allclose(F_t, 0.0) else -F_t")
edit("3.2", "holds a pull that exceeds the limit by a thousandth", "size <= limit", "size <= 1.001 * limit")
edit("3.2", "holds a pull that is close to the limit", "size <= limit", "size <= limit or np.isclose(size, limit)")
edit("3.2", "holds a pull that exceeds the limit by a micronewton", "size <= limit", "size <= limit + 1e-6")


# 3.3 ------------------------------------------------------------------------------------------------------------
@variants
def braking(sign=-1.0, direction=lambda F, v, n: unit(tangential(v, n)),
            load=lambda F, n: max(0.0, -(F @ n)), scale=lambda v: 1.0):
    def kinetic_friction(F, v, n, mu_k):
        return sign * cone_radius(mu_k, load(F, n)) * scale(v) * direction(F, v, n)
    return kinetic_friction


right("3.3", "by a unit vector")(braking())
wrong("3.3", "pushes along the velocity, not against it")(braking(sign=1.0))
wrong("3.3", "acts against the applied force, not against the velocity")(
    braking(direction=lambda F, v, n: unit(tangential(F, n))))
wrong("3.3", "acts against the whole velocity, its normal part included")(braking(direction=lambda F, v, n: unit(v)))
wrong("3.3", "makes the friction grow with the speed")(braking(scale=lambda v: size(v)))
wrong("3.3", "takes the size of F for the normal force")(braking(load=lambda F, n: size(F)))
wrong("3.3", "brakes a lifted body, too")(braking(load=lambda F, n: abs(F @ n)))
edit("3.3", "divides by a speed of zero", "speed > 0.0", "True")
edit("3.3", "treats a slow body as at rest", "speed > 0.0", "speed > 1e-9")
edit("3.3", "accepts a negative μ, and multiplies ∞ by 0", "cone_radius(mu_k, normal_force(F, n))",
     "mu_k * normal_force(F, n)")
edit("3.3", "forgets μ", "cone_radius(mu_k, normal_force(F, n))", "normal_force(F, n)")
edit("3.3", "divides by the square of the speed", "np.sqrt(v_t @ v_t)", "v_t @ v_t")
edit("3.3", "reverses the normal", "normal_force(F, n)", "normal_force(F, -n)")
edit("3.3", "uses the normal velocity as the load", "normal_force(F, n)", "normal_force(v, n)")
edit("3.3", "limits the friction to the force along the surface, as at rest", "cone_radius(mu_k, normal_force(F, n))",
     "min(cone_radius(mu_k, normal_force(F, n)), np.sqrt(tangential(F, n) @ tangential(F, n)))")
edit("3.3", "divides by the speed of the whole motion, not by that along the surface", "-limit / speed",
     "-limit / np.sqrt(v @ v)")
edit("3.3", "divides by zero where the whole motion is along n", "speed > 0.0", "np.any(v)")
for words, test in partial_tests("v_t"):
    edit("3.3", f"takes a slip for none if {words} is 0", "speed > 0.0", f"{test} != 0.0")
edit("3.3", "treats a speed of the size of round-off as rest", "speed > 0.0", "speed > 1e-15")
edit("3.3", "lets the friction grow from zero with the speed, if only up to 1e-15 m/s", "-limit / speed",
     "-limit * np.tanh(1e15 * speed) / speed")


# 3.4 ------------------------------------------------------------------------------------------------------------
@variants
def on_slope(holds=lambda theta, mu_s, mu_k: np.tan(theta) <= mu_s,
             slides=lambda theta, mu_s, mu_k: np.sin(theta) - mu_k * np.cos(theta)):
    def incline_acceleration(theta, mu_s, mu_k, g):
        worked.check_friction(mu_s)
        worked.check_friction(mu_k)
        return 0.0 if holds(theta, mu_s, mu_k) else g * slides(theta, mu_s, mu_k)
    return incline_acceleration


right("3.4", "by the tangent")(on_slope())
wrong("3.4", "uses the static coefficient in motion")(
    on_slope(slides=lambda theta, mu_s, mu_k: np.sin(theta) - mu_s * np.cos(theta)))
wrong("3.4", "uses the kinetic coefficient at rest")(on_slope(holds=lambda theta, mu_s, mu_k: np.tan(theta) <= mu_k))
wrong("3.4", "exchanges sine and cosine")(
    on_slope(slides=lambda theta, mu_s, mu_k: np.cos(theta) - mu_k * np.sin(theta)))
wrong("3.4", "compares sin θ with μ_s, not tan θ")(on_slope(holds=lambda theta, mu_s, mu_k: np.sin(theta) <= mu_s))
wrong("3.4", "never holds")(on_slope(holds=lambda theta, mu_s, mu_k: False))
wrong("3.4", "uses the normal force of level ground, without cos θ")(
    on_slope(slides=lambda theta, mu_s, mu_k: np.sin(theta) - mu_k))
edit("3.4", "accepts a negative μ_s", "cone_radius(mu_s, np.cos(theta))", "mu_s * np.cos(theta)")
edit("3.4", "accepts a negative μ_k", "cone_radius(mu_k, np.cos(theta))", "mu_k * np.cos(theta)")
edit("3.4", "treats the angle as one in degrees",
     "np.sin(theta) <= cone_radius(mu_s, np.cos(theta))",
     "np.sin(np.radians(theta)) <= cone_radius(mu_s, np.cos(np.radians(theta)))")
edit("3.4", "forgets g", "return g * (", "return (")
edit("3.4", "adds the kinetic friction", "np.sin(theta) - cone_radius(mu_k", "np.sin(theta) + cone_radius(mu_k")
edit("3.4", "forgets the kinetic friction",
     "np.sin(theta) - cone_radius(mu_k, np.cos(theta))", "np.sin(theta) - 0.0 * cone_radius(mu_k, np.cos(theta))")
edit("3.4", "exchanges holding and sliding", "<=", ">")
edit("3.4", "returns an acceleration up the slope", "return g", "return -g")
edit("3.4", "reverses the difference: friction minus gravity",
     "np.sin(theta) - cone_radius(mu_k, np.cos(theta))", "cone_radius(mu_k, np.cos(theta)) - np.sin(theta)")
edit("3.4", "compares the angle itself with μ",
     "np.sin(theta) <= cone_radius(mu_s, np.cos(theta))", "theta <= cone_radius(mu_s, 1.0)")
edit("3.4", "takes the static coefficient for a block that slides", "cone_radius(mu_k", "cone_radius(mu_s")
edit("3.4", "slides exactly at the limit of static friction", "<= cone_radius(mu_s", "< cone_radius(mu_s")
edit("3.4", "holds on a slope that is hardly too steep", "<= cone_radius(mu_s, np.cos(theta))",
     "<= cone_radius(mu_s, np.cos(theta)) + 1e-9")
edit("3.4", "holds on a slope that is too steep by a ten-millionth", "<= cone_radius(mu_s, np.cos(theta))",
     "<= (1.0 + 1e-7) * cone_radius(mu_s, np.cos(theta))")
edit("3.4", "holds on ice, if it is nearly level", "np.sin(theta) <=", "theta < 1e-3 or np.sin(theta) <=")


# 3.5 ------------------------------------------------------------------------------------------------------------
@variants
def dissipating(sign=-1.0, stop=lambda m, speed: m * speed, choose=min, limit=cone_radius, exactly=True):
    def friction_impulse(v_t, m, j_n, mu):
        size_J = choose(limit(mu, j_n), stop(m, size(v_t)))
        return sign * m * v_t if exactly and size_J == m * size(v_t) else sign * size_J * unit(v_t)
    return friction_impulse


right("3.5", "by its magnitude")(dissipating())
wrong("3.5", "leaves a round-off velocity")(dissipating(exactly=False))
wrong("3.5", "pushes along the motion, not against it")(dissipating(sign=1.0))
wrong("3.5", "forgets the mass")(dissipating(stop=lambda m, speed: speed))
wrong("3.5", "takes the larger of the two impulses")(dissipating(choose=max))
wrong("3.5", "always slides")(dissipating(choose=lambda limit, stop: limit))
wrong("3.5", "always stops")(dissipating(choose=lambda limit, stop: stop))
wrong("3.5", "forgets μ")(dissipating(limit=lambda mu, j_n: worked.check_friction(mu) or j_n))
wrong("3.5", "accepts a negative μ")(dissipating(limit=lambda mu, j_n: mu * j_n if j_n > 0.0 else 0.0))
edit("3.5", "divides by a speed of zero", "m * speed <= limit", "0.0 < m * speed <= limit")
edit("3.5", "changes its input", "-m * v_t if", "np.multiply(v_t, -m, out=v_t) if")
NO_MASS = edit("3.5", "compares the speed with the limit, without the mass", "m * speed <= limit", "speed <= limit")
edit("3.5", "compares the squared speed", "np.sqrt(v_t @ v_t)", "v_t @ v_t")
edit("3.5", "does not divide by the speed", "/ speed * v_t", "* v_t")
edit("3.5", "forgets the minus sign when it stops the body", "return -m", "return m")
edit("3.5", "exchanges the two cases", "m * speed <= limit", "m * speed > limit")
edit("3.5", "returns a change of velocity, not an impulse, when it stops the body", "return -m * v_t", "return -v_t")
edit("3.5", "divides by the mass", "return -m * v_t", "return -v_t / m")
edit("3.5", "forgets the mass in the minimum", "np.minimum(limit, m * speed)", "np.minimum(limit, speed)")
edit("3.5", "stops all that slides along an axis", "m * speed <= limit", "m * speed <= limit or np.any(v_t == 0.0)")
for words, test in partial_tests("v_t"):
    edit("3.5", f"takes a slip for none if {words} is 0", "return -m",
         f"return 0.0 * v_t if {test} == 0.0 else -m")


@right("3.5", "as a list")
def friction_impulse(v_t, m, j_n, mu):
    return worked.friction_impulse(v_t, m, j_n, mu).tolist()
edit("3.5", "treats a body slower than 1 nm/s as at rest", "return -m", "return 0.0 * v_t if speed < 1e-9 else -m")
edit("3.5", "takes a load below 1 µN s for none", "cone_radius(mu, j_n)", "cone_radius(mu, j_n) * (j_n > 1e-6)")
edit("3.5", "stops a body for which the cone is too narrow by 1 nN s", "m * speed <= limit",
     "m * speed <= limit + 1e-9")
edit("3.5", "stops a body for which the cone is nearly wide enough", "m * speed <= limit",
     "m * speed <= limit or np.isclose(m * speed, limit)")


# 3.6 ------------------------------------------------------------------------------------------------------------
@variants
def square(sign=-1.0, mass=True, clamp=lambda y, limit: np.clip(y, -limit, limit), second=True, width=1.0):
    def pyramid_impulse(v_t, m, j_n, mu, t_1, t_2):
        tangents = np.stack([t_1, t_2 if second else 0.0 * t_2])
        return sign * clamp((m if mass else 1.0) * tangents @ v_t, width * cone_radius(mu, j_n)) @ tangents
    return pyramid_impulse


right("3.6", "both tangents at once")(square())
wrong("3.6", "pushes along the motion, not against it")(square(sign=1.0))
wrong("3.6", "forgets the mass")(square(mass=False))
wrong("3.6", "does not limit the friction from below")(square(clamp=np.minimum))
wrong("3.6", "applies friction along the first tangent only")(square(second=False))
wrong("3.6", "uses a pyramid inside the cone")(square(width=np.sqrt(0.5)))
edit("3.6", "limits the friction by a cone, not by a pyramid",
     "limit = cone_radius(mu, j_n)", "return friction_impulse(v_t, m, j_n, mu)")
edit("3.6", "accepts a negative μ, and multiplies ∞ by 0", "cone_radius(mu, j_n)", "mu * j_n")
edit("3.6", "does not limit the friction along the second tangent from above",
     "np.maximum(-limit, np.minimum(limit, m * (v_t @ t_2)))",
     "max(-limit, m * (v_t @ t_2))")
edit("3.6", "does not limit the friction along the second tangent from below",
     "np.maximum(-limit, np.minimum(limit, m * (v_t @ t_2)))",
     "min(limit, m * (v_t @ t_2))")
edit("3.6", "exchanges the two tangents", "-first * t_1 - second * t_2", "-first * t_2 - second * t_1")
edit("3.6", "applies friction along the second tangent only", "-first * t_1 - second * t_2", "-second * t_2")
edit("3.6", "reverses the impulse along the second tangent",
     "-first * t_1 - second * t_2", "-first * t_1 + second * t_2")
edit("3.6", "reverses the impulse along the first tangent", "-first * t_1 - second * t_2", "first * t_1 - second * t_2")
edit("3.6", "takes the second component along the first tangent", "m * (v_t @ t_2)", "m * (v_t @ t_1)")
edit("3.6", "does not limit the impulse at all",
     "limit = cone_radius(mu, j_n)", "limit = cone_radius(mu, j_n) * 0.0 + np.inf")
edit("3.6", "always slides: takes the full limit along each tangent",
     "np.maximum(-limit, np.minimum(limit, m * (v_t @ t_1)))", "limit * np.sign(v_t @ t_1)")
edit("3.6", "forgets μ", "cone_radius(mu, j_n)", "j_n")
edit("3.6", "divides by the mass in place of multiplying by it",
     "limit = cone_radius(mu, j_n)", "limit, m = cone_radius(mu, j_n), 1.0 / m")
edit("3.6", "forgets the mass along the first tangent", "m * (v_t @ t_1)", "v_t @ t_1")
edit("3.6", "shortens both parts by one factor, where each has its own limit", "limit = cone_radius(mu, j_n)",
     "limit, most = cone_radius(mu, j_n), m * max(abs(v_t @ t_1), abs(v_t @ t_2)); "
     "return -min(1.0, limit / max(most, 1e-300)) * m * v_t")
edit("3.6", "shortens the impulse of the pyramid to the radius of the cone", "return -first * t_1 - second * t_2",
     "return -min(1.0, limit / max(np.hypot(first, second), 1e-300)) * (first * t_1 + second * t_2)")
edit("3.6", "leaves out a body that slides along one of the tangents", "return -first * t_1 - second * t_2",
     "return (-first * t_1 - second * t_2) * (first * second != 0.0)")
for words, test in partial_tests("v_t"):
    edit("3.6", f"takes a slip for none if {words} is 0", "return -first",
         f"return 0.0 * v_t if {test} == 0.0 else -first")
edit("3.6", "stops all that is in the circle around the square", "limit = cone_radius(mu, j_n)",
     "limit = cone_radius(mu, j_n); first, second = m * (v_t @ t_1), m * (v_t @ t_2)\n"
     "    if np.hypot(first, second) <= np.sqrt(2.0) * limit: return -m * v_t")
edit("3.6", "treats a body slower than 10 nm/s as at rest", "return -first",
     "return 0.0 * v_t if np.allclose(v_t, 0.0) else -first")


# 3.7 ------------------------------------------------------------------------------------------------------------
@variants
def block_step(rest=True, at_rest="mu_s", moving="mu_k", late=0.0, old=False, against="new",
               once=True, load=worked.normal_force, speed=1.0, still=lambda v: size(v) == 0.0,
               holds=lambda pull, limit: pull <= limit, turns=True):
    """A step of a block that computes friction as a vector, with terms that may be wrong."""
    def sliding_step(acceleration, t, x, v, dt, p):
        a = acceleration(t + late * dt, x, v, p)
        a_n, a_t = load(a, p.n), tangential(a, p.n)
        if rest and still(v) and holds(size(a_t), cone_radius(getattr(p, at_rest), a_n)):
            return x, v
        free = v + dt * a_t
        limit = (dt if once else 1.0) * cone_radius(getattr(p, moving), a_n)
        direction = unit(free if against == "new" else v if size(v) > 0.0 else a_t)
        v_new = free - direction * (min(limit, size(free)) if speed else limit)
        v_new = 0.0 * v if speed and (size(free) <= limit or (not turns and v_new @ v < 0.0)) else v_new
        return x + dt * (v if old else v_new), v_new
    return sliding_step


right("3.7", "by a unit vector")(block_step())
wrong("3.7", "uses the kinetic coefficient at rest")(block_step(at_rest="mu_k"))
wrong("3.7", "uses the static coefficient in motion")(block_step(moving="mu_s"))
wrong("3.7", "does not test whether static friction holds the block")(block_step(rest=False))
wrong("3.7", "takes the acceleration at t + dt")(block_step(late=1.0))
wrong("3.7", "moves with the old velocity")(block_step(old=True))
edit("3.7", "moves with the velocity before friction", "v = v + friction_impulse(",
     "x = x - dt * friction_impulse(v, 1.0, dt * a_n, p.mu_k); v = v + friction_impulse(")
wrong("3.7", "applies the full friction for the whole step, which can reverse the block")(block_step(speed=0.0))
wrong("3.7", "omits dt in the impulse of friction")(block_step(once=False))
wrong("3.7", "directs friction against the old velocity")(block_step(against="old"))
wrong("3.7", "treats the block as at rest if one coordinate of v is zero")(
    block_step(still=lambda v: bool(np.any(v == 0.0))))
wrong("3.7", "treats a block slower than 1 mm/s as at rest")(block_step(still=lambda v: size(v) <= 1e-3))
wrong("3.7", "treats a block slower than 1 nm/s as at rest")(block_step(still=lambda v: size(v) <= 1e-9))
wrong("3.7", "lets the block slip exactly on the edge of the cone")(block_step(holds=lambda pull, limit: pull < limit))
wrong("3.7", "stops a block that reverses")(block_step(turns=False))
wrong("3.7", "treats a lifted block as loaded")(block_step(load=lambda a, n: abs(a @ n)))
wrong("3.7", "takes the size of a for the load")(block_step(load=lambda a, n: size(a)))
edit("3.7", "changes its input", "v = v + dt * a_t", "v += dt * a_t")
edit("3.7", "forgets dt beside the acceleration", "v + dt * a_t", "v + a_t")
edit("3.7", "adds the whole acceleration, its normal part included", "v + dt * a_t", "v + dt * a")
edit("3.7", "subtracts the acceleration", "v + dt * a_t", "v - dt * a_t")
edit("3.7", "omits the friction", "v = v + friction_impulse(v, 1.0, dt * a_n, p.mu_k)", "pass")
edit("3.7", "returns the impulse as the new velocity", "v = v + friction_impulse", "v = friction_impulse")
edit("3.7", "subtracts the impulse", "v = v + friction_impulse", "v = v - friction_impulse")
edit("3.7", "multiplies the load by dt twice", "dt * a_n, p.mu_k", "dt * dt * a_n, p.mu_k")
edit("3.7", "exchanges holding and sliding", "<= cone_radius", "> cone_radius")
edit("3.7", "computes the friction of the velocity before the forces act", "friction_impulse(v, 1.0",
     "friction_impulse(v - dt * a_t, 1.0")
edit("3.7", "tests whether static friction holds a moving block, too", "not np.any(v) and ", "")
edit("3.7", "exchanges place and velocity in the call of the acceleration", "acceleration(t, x, v, p)",
     "acceleration(t, v, x, p)")
edit("3.7", "returns the state unchanged where there is no load", "if not np.any(v) and",
     "if not np.any(a) or not np.any(v) and")
for words, test in partial_tests("v"):
    edit("3.7", f"takes a block for one at rest if {words} is 0", "not np.any(v)", f"{test} == 0.0")
edit("3.7", "computes the acceleration of a block at rest", "acceleration(t, x, v, p)",
     "acceleration(t, x, 0.0 * v, p)")
edit("3.7", "computes the acceleration at the origin", "acceleration(t, x, v, p)", "acceleration(t, 0.0 * x, v, p)")
edit("3.7", "uses a law of the lesson in place of the one that is passed in", "acceleration(t, x, v, p)",
     "driven_acceleration(t, x, v, p)")
edit("3.7", "treats a block slower than 1 pm/s as at rest", "not np.any(v)", "np.sqrt(v @ v) < 1e-12")
edit("3.7", "holds a block whose pull exceeds the limit by a millionth", "<= cone_radius(p.mu_s, a_n)",
     "<= 1.000001 * cone_radius(p.mu_s, a_n)")
edit("3.7", "stops a block that has become slower than 10 nm/s", "v = v + friction_impulse(v, 1.0, dt * a_n, p.mu_k)",
     "v = v + friction_impulse(v, 1.0, dt * a_n, p.mu_k); v = v * (not np.allclose(v, 0.0))")


# 3.8 ------------------------------------------------------------------------------------------------------------
@variants
def heading(moving=lambda v, a_t: v, limit="mu_s", sign=1.0, scaled=True,
            ask=lambda pull, hold: pull > hold, clock=1.0, load=worked.normal_force,
            least=0.0):
    def slip_direction(acceleration, t, x, v, p):
        a = acceleration(clock * t, x, v, p)
        a_t, a_n = tangential(a, p.n), load(a, p.n)
        if size(v) > least:
            return unit(moving(v, a_t))
        breaks = ask(size(a_t), cone_radius(getattr(p, limit), a_n))
        return sign * (unit(a_t) if scaled else a_t) if breaks else 0.0 * a_t
    return slip_direction


right("3.8", "all cases from one pull")(heading())
wrong("3.8", "returns the direction of the pull for a moving block")(heading(moving=lambda v, a_t: a_t))
wrong("3.8", "uses the kinetic coefficient at rest")(heading(limit="mu_k"))
wrong("3.8", "reverses the direction of the pull")(heading(sign=-1.0))
wrong("3.8", "does not return a unit vector")(heading(scaled=False))
wrong("3.8", "lets the block slip exactly on the edge of the cone")(heading(ask=lambda pull, hold: pull >= hold))
wrong("3.8", "treats a lifted block as loaded")(heading(load=lambda a, n: abs(a @ n)))
wrong("3.8", "treats a block slower than 1 µm/s as at rest")(heading(least=1e-6))
wrong("3.8", "always breaks away")(heading(ask=lambda pull, hold: True))
wrong("3.8", "never breaks away")(heading(ask=lambda pull, hold: False))
wrong("3.8", "does not advance t")(heading(clock=0.0))
edit("3.8", "multiplies an infinite μ by a normal force of zero",
     "cone_radius(p.mu_s, normal_force(a, p.n))", "p.mu_s * normal_force(a, p.n)")
edit("3.8", "uses the whole acceleration, its normal part included", "a_t = tangential(a, p.n)", "a_t = a")
edit("3.8", "returns the direction against the motion", "return v / speed", "return -v / speed")
edit("3.8", "divides by the square of the speed", "np.sqrt(v @ v)", "v @ v")
edit("3.8", "exchanges holding and slipping", "pull > cone", "pull < cone")
edit("3.8", "returns the velocity itself", "return v / speed", "return v")
edit("3.8", "returns zeros for a moving block", "return v / speed", "return 0.0 * v")
edit("3.8", "exchanges place and velocity in the call of the acceleration", "acceleration(t, x, v, p)",
     "acceleration(t, v, x, p)")
GRAVITY = edit("3.8", "takes the normal force of gravity alone", "normal_force(a, p.n)", "normal_force(p.gravity, p.n)")
edit("3.8", "lets the block slip exactly on the edge of the cone", "pull > cone", "pull >= cone")
edit("3.8", "does not break away where there is no friction", "pull > cone", "p.mu_s > 0.0 and pull > cone")
for words, test in partial_tests("v"):
    edit("3.8", f"takes a block for one at rest if {words} is 0", "speed != 0.0", f"{test} != 0.0")
for words, test in partial_tests("a_t"):
    edit("3.8", f"takes a pull for none if {words} is 0", "a_t / pull if", f"a_t / pull if {test} != 0.0 and")
edit("3.8", "uses a law of the lesson in place of the one that is passed in", "acceleration(t, x, v, p)",
     "driven_acceleration(t, x, v, p)")
edit("3.8", "treats a block slower than 1 pm/s as at rest", "speed != 0.0", "speed > 1e-12")
edit("3.8", "holds a block whose pull exceeds the limit by a millionth", "pull > cone", "pull > 1.000001 * cone")
edit("3.8", "takes a pull below 1 nm/s² for none", "pull > cone", "pull > 1e-9 and pull > cone")


# 3.9 ------------------------------------------------------------------------------------------------------------
@variants
def first_stop(halvings=60, whole=True, begin=0.0, length=lambda middle, dt: middle, towards=1.0, end=lambda a, b: b):
    def stopping_time(acceleration, t, x, v, dt, d, p):
        def moves(tau):
            _, v_end = worked.kinetic_friction_step(acceleration, t + begin * tau, x, v, length(tau, dt), d, p)
            return v_end @ d * towards > 0.0
        if whole and moves(dt):
            return dt
        a, b = 0.0, dt
        for _ in range(halvings):
            a, b = (0.5 * (a + b), b) if moves(0.5 * (a + b)) else (a, 0.5 * (a + b))
        return end(a, b)
    return stopping_time


right("3.9", "with its own test")(first_stop())
wrong("3.9", "halves the interval only ten times")(first_stop(halvings=10))
right("3.9", "does not test the whole step: bisection finds its end")(first_stop(whole=False))
wrong("3.9", "evaluates the forces at a later time")(first_stop(begin=1.0))
wrong("3.9", "returns the first half, however late it stops")(first_stop(end=lambda a, b: 0.5 * a))
wrong("3.9", "reverses the sign of the speed")(first_stop(towards=-1.0))
BRAKE = "cone_radius(p.mu_k, normal_force(acceleration(t, x, v, p), p.n))"
edit("3.9", "divides the speed by μ g and omits the drive",
     "moving, stopped = 0.0, dt", f"return min(dt, v @ d / {BRAKE})")
edit("3.9", "assumes the deceleration at t for the whole step", "moving, stopped = 0.0, dt",
     f"return min(dt, v @ d / abs({BRAKE} - acceleration(t, x, v, p) @ d))")
edit("3.9", "tests whether the block moves in any direction, so that it never stops",
     "kinetic_friction_step(acceleration, t, x, v, dt, d, p)[1] @ d > 0.0",
     "np.any(kinetic_friction_step(acceleration, t, x, v, dt, d, p)[1])")
edit("3.9", "exchanges the two halves", "middle, d, p)[1] @ d > 0.0", "middle, d, p)[1] @ d <= 0.0")
edit("3.9", "returns the rest of the step, after the stop", "return stopped", "return dt - stopped")
edit("3.9", "returns zero for a block that goes on", "return dt", "return 0.0")
edit("3.9", "interpolates the speed along a straight line between the ends of the step", "return stopped",
     "return dt * (v @ d) / ((v - kinetic_friction_step(acceleration, t, x, v, dt, d, p)[1]) @ d)")
edit("3.9", "does not stop where there is no friction", "return stopped", "return stopped if p.mu_k > 0.0 else dt")
WHOLE, PART = "acceleration, t, x, v, dt, d, p", "acceleration, t, x, v, middle, d, p"
for story, old, new in (("takes the place of the block to be the origin", "t, x", "t, 0.0 * x"),
                        ("begins at time 0", "t, x", "0.0, x"),
                        ("uses a law of the lesson in place of the one that is passed in", "acceleration",
                         "driven_acceleration")):
    edit("3.9", f"{story}, while it halves", PART, PART.replace(old, new))
edit("3.9", "uses a law of the lesson in place of the one that is passed in, for the whole step", WHOLE,
     f"driven_{WHOLE}")
edit("3.9", "halves the interval 45 times", "range(HALVINGS)", "range(45)")
edit("3.9", "returns the beginning of the last interval, where the block still moves", "return stopped",
     "return moving")
edit("3.9", "stops halving at 1e-14 s", "middle = 0.5 *", "if stopped - moving < 1e-14: break\n        middle = 0.5 *")
edit("3.9", "takes a block for going on that hardly moves back", "acceleration, t, x, v, dt, d, p)[1] @ d > 0.0",
     "acceleration, t, x, v, dt, d, p)[1] @ d > -1e-6")


# 3.10 -----------------------------------------------------------------------------------------------------------
@variants
def first_slip(halvings=60, since=lambda t, tau: t + tau, whole=True, slips=lambda d: size(d) > 0.0):
    def breakaway_time(acceleration, t, x, v, dt, p):
        def breaks(tau):
            return slips(worked.slip_direction(acceleration, since(t, tau), x, v, p))
        if whole and not breaks(dt):
            return dt
        a, b = 0.0, dt
        for _ in range(halvings):
            a, b = (a, 0.5 * (a + b)) if breaks(0.5 * (a + b)) else (0.5 * (a + b), b)
        return b
    return breakaway_time


right("3.10", "with its own test")(first_slip())


wrong("3.10", "halves the interval only ten times")(first_slip(halvings=10))
wrong("3.10", "evaluates the forces as if the step began at time 0")(first_slip(since=lambda t, tau: tau))
wrong("3.10", "tests the pull at t, not at t + τ")(first_slip(since=lambda t, tau: t))
wrong("3.10", "exchanges holding and slipping in the test")(first_slip(slips=lambda d: size(d) == 0.0))
edit("3.10", "uses the kinetic coefficient", "if not np.any", "p = p._replace(mu_s=p.mu_k)\n    if not np.any")
LOAD_OF_NOW = "p._replace(gravity=p.gravity + np.cos(p.omega * t) * (p.drive - along), drive=along)"
edit("3.10", "keeps the load at t for the whole step", "if not np.any",
     f"along = tangential(p.drive, p.n); p = {LOAD_OF_NOW}\n    if not np.any")
edit("3.10", "returns the time, not the duration", "return slips", "return t + slips")
edit("3.10", "exchanges the two halves",
     "if np.any(slip_direction(acceleration, t + middle", "if not np.any(slip_direction(acceleration, t + middle")
edit("3.10", "returns the rest of the step, after the slip", "return slips", "return dt - slips")
edit("3.10", "returns zero if the block still holds", "return dt", "return 0.0")
edit("3.10", "returns infinity if the block still holds", "return dt", "return np.inf")
edit("3.10", "takes a slip along an axis for rest", "if np.any(slip", "if np.all(slip")
edit("3.10", "exchanges place and velocity", "t + middle, x, v, p", "t + middle, v, x, p")
edit("3.10", "holds for the whole step if it begins at t = 0", "return slips", "return slips if t > 0.0 else dt")
for words, test in partial_tests("slip_direction(acceleration, t + middle, x, v, p)"):
    edit("3.10", f"takes a slip for rest if {words} is 0", "np.any(slip_direction(acceleration, t + middle, x, v, p))",
         f"{test} != 0.0")
for words, test in partial_tests("slip_direction(acceleration, t + dt, x, v, p)"):
    edit("3.10", f"takes a slip at the end of the step for rest if {words} is 0",
         "not np.any(slip_direction(acceleration, t + dt, x, v, p))", f"{test} == 0.0")
edit("3.10", "uses a law of the lesson in place of the one that is passed in", "acceleration, t + middle",
     "driven_acceleration, t + middle")
edit("3.10", "returns the beginning of the last interval, where the block still holds", "return slips", "return holds")


# 3.11 -----------------------------------------------------------------------------------------------------------
@variants
def event(exactly=True, whole=False, waits=True, rest=False, moves=True):
    def advance_to_event(acceleration, t, x, v, dt, p):
        d = worked.slip_direction(acceleration, t, x, v, p)
        if size(d) == 0.0:
            return (worked.breakaway_time(acceleration, t, x, v, dt, p) if waits else dt), x, v
        tau = worked.stopping_time(acceleration, t, x, v, dt, d, p)
        x_new, v_new = worked.kinetic_friction_step(acceleration, t, x, v, dt if whole else tau, d, p)
        if (exactly and tau < dt) or rest:
            v_new = np.zeros_like(v)
        return tau, (x_new if moves else x), v_new
    return advance_to_event


right("3.11", "with new names")(event())
edit("3.11", "takes a slip along an axis for rest", "np.any(", "np.all(")
wrong("3.11", "leaves a round-off velocity after a stop")(event(exactly=False))
wrong("3.11", "slides for the whole step")(event(whole=True))
wrong("3.11", "never breaks away")(event(waits=False))
wrong("3.11", "stops at the end of every step")(event(rest=True))
wrong("3.11", "does not move")(event(moves=False))
edit("3.11", "handles a moving block only", "d = slip_direction(acceleration, t, x, v, p)",
     "d = v / max(1e-300, np.sqrt(v @ v))")
edit("3.11", "does not stop near the end of the step", "tau == dt", "tau >= 0.99 * dt")
edit("3.11", "returns the whole step as the time",
     "return tau, x, v if tau == dt else 0.0 * v", "return dt, x, v if tau == dt else 0.0 * v")
edit("3.11", "returns the rest of the step as the time", "return tau, x, v if", "return dt - tau, x, v if")
edit("3.11", "exchanges the two cases", "if not np.any(d)", "if np.any(d)")
edit("3.11", "stops the block that goes on, and lets the other one go on", "tau == dt", "tau != dt")
edit("3.11", "stops a block without friction", "v if tau == dt", "v if tau == dt and p.mu_k > 0.0")
for words, test in partial_tests("d"):
    edit("3.11", f"takes a slip for rest if {words} is 0", "not np.any(d)", f"{test} == 0.0")
edit("3.11", "returns the time of the stop in place of the duration of the slide", "return tau, x", "return t + tau, x")
for name, call in (("stopping_time", "acceleration, t, x, v, dt, d, p"),
                   ("kinetic_friction_step", "acceleration, t, x, v, tau, d, p"),
                   ("slip_direction", "acceleration, t, x, v, p")):
    for story, old, new in (("at time 0", " t,", " 0.0,"), ("at the origin", " x,", " 0.0 * x,"),
                            ("under a law of the lesson, not the one that is passed in", "acc", "driven_acc")):
        edit("3.11", f"calls {name} {story}", f"{name}({call})", f"{name}({call.replace(old, new)})")
edit("3.11", "slides with the deceleration of the start", "kinetic_friction_step(acceleration, t, x, v, tau, d, p)",
     "(lambda b: (x + tau * v + 0.5 * tau * tau * b, v + tau * b))("
     "(kinetic_friction_step(acceleration, t, x, v, 1e-7 * dt, d, p)[1] - v) / (1e-7 * dt))")
edit("3.11", "slides along the motion, with friction of the static coefficient",
     "kinetic_friction_step(acceleration, t, x, v, tau, d, p)",
     "kinetic_friction_step(acceleration, t, x, v, tau, d, p._replace(mu_k=p.mu_s))")
edit("3.11", "lets a block go on that stops barely before the end of the step", "tau == dt", "np.isclose(tau, dt)")
edit("3.11", "stops a block that has become slower than 1 nm/s", "v if tau == dt", "v if np.sqrt(v @ v) > 1e-9")


# 3.12 -----------------------------------------------------------------------------------------------------------
@variants
def hollow(sign=-1.0, inside=1.0, centred=True, axial=True, scaled=True, safe=True):
    def particle_bowl_gap(x, p):
        r = x - p.centre if centred else x
        r = r - (r @ p.axis) * p.axis if axial else r
        distance = size(r)
        with np.errstate(invalid="ignore"):
            n = unit(r) if safe else r / distance
        return inside * (p.radius - distance), sign * (n if scaled else r)
    return particle_bowl_gap


right("3.12", "by a unit vector")(hollow())
wrong("3.12", "returns a normal that points out of the bowl")(hollow(sign=1.0))
wrong("3.12", "reverses the sign of the gap")(hollow(inside=-1.0))
wrong("3.12", "puts the centre of the bowl at the origin")(hollow(centred=False))
wrong("3.12", "treats a trough like a bowl")(hollow(axial=False))
wrong("3.12", "does not return a unit normal")(hollow(scaled=False))
wrong("3.12", "divides by a distance of zero")(hollow(safe=False))
edit("3.12", "treats the bowl as a ball", "p.radius - distance, -r / distance", "distance - p.radius, r / distance")
edit("3.12", "treats a micrometre around the centre as the centre", "distance > 0.0", "distance > 1e-6")
edit("3.12", "returns the distance from the centre as the gap", "p.radius - distance, -r", "distance, -r")
edit("3.12", "divides r by the radius of the wall, not by the length of r, to get the normal",
     "-r / distance if", "-r / p.radius if")
edit("3.12", "adds the centre", "x - p.centre", "x + p.centre")
edit("3.12", "takes the part along the axis in place of the rest",
     "tangential(x - p.centre, p.axis)", "((x - p.centre) @ p.axis) * p.axis")
edit("3.12", "compares the squared distance with the radius", "distance = np.sqrt(r @ r)", "distance = r @ r")
edit("3.12", "divides the normal of a trough by the distance from its centre, not from its axis", "-r / distance if",
     "-r / np.sqrt((x - p.centre) @ (x - p.centre)) if")
edit("3.12", "divides by zero on the axis of a trough", "distance > 0.0", "np.any(x != p.centre)")
for words, test in partial_tests("r"):
    edit("3.12", f"takes a place for the centre if {words} is 0, seen from there", "distance > 0.0", f"{test} != 0.0")
edit("3.12", "treats round-off around the centre as the centre", "distance > 0.0", "distance > 1e-15")


# 3.13 -----------------------------------------------------------------------------------------------------------
@variants
def impact(leaves=True, bounce=lambda e: 1.0 + e, mass=True, slip=tangential,
           sign=1.0, friction=worked.friction_impulse, mass_n=True):
    def particle_contact_impulse(v, n, m, e, mu):
        v_n = v @ n
        if leaves and v_n >= 0.0:
            return np.zeros_like(v)
        j_n = -sign * bounce(e) * (m if mass_n else 1.0) * v_n
        return j_n * n + friction(slip(v, n), m if mass else 1.0, abs(j_n), mu)
    return particle_contact_impulse


right("3.13", "by the same law")(impact())
wrong("3.13", "pulls back a particle that leaves")(impact(leaves=False))
wrong("3.13", "uses e in place of 1 + e")(impact(bounce=lambda e: e))
wrong("3.13", "uses 1 − e in place of 1 + e")(impact(bounce=lambda e: 1.0 - e))
wrong("3.13", "omits the restitution")(impact(bounce=lambda e: 1.0))
wrong("3.13", "reverses the impulse, which pulls the particle in")(impact(sign=-1.0))
wrong("3.13", "forgets the mass in friction")(impact(mass=False))
wrong("3.13", "forgets the mass in the normal impulse")(impact(mass_n=False))
wrong("3.13", "directs friction against all of v, its normal part included")(impact(slip=lambda v, n: v))
wrong("3.13", "omits the friction")(impact(friction=lambda v_t, m, j_n, mu: 0.0 * v_t))
wrong("3.13", "always sticks")(impact(friction=lambda v_t, m, j_n, mu: -m * v_t))
edit("3.13", "limits the friction by the normal impulse for e = 0",
     "tangential(v, n), m, j_n, mu", "tangential(v, n), m, -m * v_n, mu")
edit("3.13", "ignores slow impacts", "v_n >= 0.0", "v_n >= -1e-3")
edit("3.13", "reverses the test of the approach", "v_n >= 0.0", "v_n <= 0.0")
edit("3.13", "reverses the friction", "+ friction_impulse", "- friction_impulse")
edit("3.13", "reverses the normal impulse only", "return j_n * n + f", "return -j_n * n + f")
edit("3.13", "uses the normal velocity for the load of the friction", "m, j_n, mu)", "m, -v_n, mu)")
edit("3.13", "forgets the minus sign of the normal impulse", "j_n = -(", "j_n = (")
edit("3.13", "exchanges e and μ", "(1.0 + e) * m * v_n", "(1.0 + mu) * m * v_n")
edit("3.13", "returns a velocity: divides by the mass",
     "j_n * n + friction_impulse(tangential(v, n), m, j_n, mu)",
     "(j_n * n + friction_impulse(tangential(v, n), m, j_n, mu)) / m")
edit("3.13", "returns the velocity after the impact", "return j_n * n + f", "return v + j_n * n + f")
edit("3.13", "stops a particle that does not bounce", "return j_n * n", "return -m * v if e == 0.0 else j_n * n")
for words, test in partial_tests("tangential(v, n)"):
    edit("3.13", f"omits the friction of a slip if {words} is 0", "+ friction_impulse(tangential(v, n)",
         f"+ ({test} != 0.0) * friction_impulse(tangential(v, n)")
edit("3.13", "takes an approach slower than 10 nm/s for none", "v_n >= 0.0", "v_n >= 0.0 or np.isclose(v_n, 0.0)")
edit("3.13", "takes a particle that barely grazes for leaving", "v_n >= 0.0", "v_n >= -1e-6 * np.sqrt(v @ v)")
edit("3.13", "does not bounce below 0.1 µm/s", "(1.0 + e)", "(1.0 + e * (v_n < -1e-7))")


# 3.14 and 3.16 --------------------------------------------------------------------------------------------------
def particle_step(grip=0.0, old=False, back=-1.0, asked="new", mass=True, only_inwards=False,
                  both_ways=False, doubled=False, reached=0.0, half=1.0, depth=lambda phi: -phi,
                  once=True, clock=1.0, moving=lambda moved, x, v, dt: moved):
    """A step of a particle with contact, with terms that may be wrong."""
    def step(acceleration, surface, t, x, v, dt, p):
        v_free = v + (dt if once else 1.0) * acceleration(clock * t, x, v, p)
        moved = dt * (v if old else v_free)
        x_free = x + moved
        phi, n = surface(x if asked == "old" else x_free, p)
        if phi >= reached:
            return x_free, v_free
        leads_in = v_free @ n < 0.0
        x_new = x_free if only_inwards and not leads_in else x_free + back * half * phi * n
        if grip and (leads_in or both_ways):
            correction = worked.friction_position_correction(moving(moved, x, v, dt), n, max(0.0, depth(phi)), p.mu)
            x_new = x_new + grip * correction
        J = worked.particle_contact_impulse(v_free, n, p.m, p.e, p.mu)
        return x_new, v_free + J / (p.m if mass else 1.0) * (2.0 if doubled else 1.0)
    return step


contact, gripping = variants(particle_step), variants(functools.partial(particle_step, grip=1.0))
for number, particle in (("3.14", contact), ("3.16", gripping)):
    right(number, "with new names")(particle())
    wrong(number, "moves with the old velocity")(particle(old=True))
    wrong(number, "moves the particle deeper into the surface")(particle(back=1.0))
    wrong(number, "does not move the particle back to the surface")(particle(back=0.0))
    wrong(number, "moves the particle only half of the way back")(particle(half=0.5))
    wrong(number, "evaluates the gap before the particle has moved")(particle(asked="old"))
    wrong(number, "forgets to divide by the mass")(particle(mass=False))
    wrong(number, "does not move a particle back that is inside and already leaves")(particle(only_inwards=True))
    wrong(number, "treats every particle as in contact")(particle(reached=np.inf))
    wrong(number, "forgets dt")(particle(once=False))
    wrong(number, "evaluates the acceleration at time 0")(particle(clock=0.0))
    wrong(number, "finds contact within a gap of 1 mm")(particle(reached=1e-3))
wrong("3.14", "also corrects the position for friction, which belongs to 3.16")(contact(grip=1.0))
NO_GRIP = "never corrects the position for friction: v · n < 0 is asked before the impulse, and the depth is −φ"
wrong("3.16", NO_GRIP)(gripping(grip=0.0))
wrong("3.16", NO_GRIP)(gripping(depth=lambda phi: phi))
edit("3.16", NO_GRIP, "if v @ n < 0.0", "if (v + particle_contact_impulse(v, n, p.m, p.e, p.mu) / p.m) @ n < 0.0")
wrong("3.16", "reverses the friction correction of the position")(gripping(grip=-1.0))
wrong("3.16", "applies the correction to a leaving particle, too")(gripping(both_ways=True))
wrong("3.16", "corrects the displacement of the old velocity")(gripping(moving=lambda moved, x, v, dt: dt * v))
edit("3.14", "changes its input", "v = v + dt * acceleration(t, x, v, p)", "v += dt * acceleration(t, x, v, p)")
edit("3.14", "finds contact at φ = 0 already", "phi < 0.0", "phi <= 0.0")
edit("3.16", "finds contact at φ = 0 already", "phi < 0.0", "phi <= 0.0")
edit("3.16", "applies the correction to a particle that moves along the surface", "v @ n < 0.0", "v @ n <= 0.0")
edit("3.14", "exchanges e and μ", "p.m, p.e, p.mu", "p.m, p.mu, p.e")
edit("3.14", "corrects the position only", "v = v + particle_contact_impulse(v, n, p.m, p.e, p.mu) / p.m", "pass")
edit("3.14", "moves the particle back whenever it is outside", "phi < 0.0", "phi > 0.0")
edit("3.14", "subtracts the impulse", "v = v + particle_contact", "v = v - particle_contact")
edit("3.14", "multiplies the impulse by the mass", "p.mu) / p.m", "p.mu) * p.m")
edit("3.14", "returns the impulse over mass as the velocity", "v = v + particle_contact", "v = particle_contact")
edit("3.16", "corrects the position with e in place of μ", "-phi, p.mu)", "-phi, p.e)")
edit("3.16", "exchanges e and μ in the impulse", "p.m, p.e, p.mu", "p.m, p.mu, p.e")
edit("3.16", "takes the velocity for the displacement",
     "friction_position_correction(moved", "friction_position_correction(v")
edit("3.16", "returns the velocity before the impulse",
     "v = v + particle_contact_impulse(v, n, p.m, p.e, p.mu) / p.m", "pass")
edit("3.14", "leaves a particle at rest inside", "if phi < 0.0:", "if phi < 0.0 and np.any(v):")
edit("3.16", "leaves a particle at rest inside", "if phi < 0.0:", "if phi < 0.0 and np.any(v):")
SURFACE = "phi, n = surface(x, p)"
for number in ("3.14", "3.16"):
    edit(number, "always takes the plane, also where another surface is passed in", SURFACE,
         "phi, n = particle_plane_gap(x, p)")
    edit(number, "takes the normal of the plane on every surface", SURFACE, f"{SURFACE}; n = p.n")
    edit(number, "computes the acceleration of a particle at rest", "acceleration(t, x, v, p)",
         "acceleration(t, x, 0.0 * v, p)")
    edit(number, "takes the normal of the plane for the impulse", "particle_contact_impulse(v, n,",
         "particle_contact_impulse(v, p.n,")
edit("3.16", "takes the normal of the plane for the displacement", "friction_position_correction(moved, n",
     "friction_position_correction(moved, p.n")
for number in ("3.14", "3.16"):
    edit(number, "finds no contact where the particle is less than 1 nm inside", "phi < 0.0", "phi < -1e-9")
edit("3.16", "does not correct the displacement of a particle that slowly goes deeper", "v @ n < 0.0", "v @ n < -1e-6")


# 3.15 -----------------------------------------------------------------------------------------------------------
@variants
def grip(sign=-1.0, part=tangential, limit=lambda mu, depth: mu * depth, choose=min):
    def friction_position_correction(moved, n, depth, mu):
        s = part(moved, n)
        return sign * choose(limit(mu, depth), size(s)) * unit(s)
    return friction_position_correction


right("3.15", "by a unit vector")(grip())
wrong("3.15", "reverses the correction")(grip(sign=1.0))


wrong("3.15", "uses all of the displacement, its normal part included")(grip(part=lambda moved, n: moved))
wrong("3.15", "does not limit the correction")(grip(choose=lambda limit, s: s))
wrong("3.15", "always slides")(grip(choose=lambda limit, s: limit))
wrong("3.15", "forgets μ")(grip(limit=lambda mu, depth: depth))
edit("3.15", "uses at most 10 cm of the depth", "1.0, depth", "1.0, min(depth, 0.1)")
edit("3.15", "reverses the depth", "depth, mu)", "-depth, mu)")
edit("3.15", "returns the whole displacement along the surface",
     "friction_impulse(tangential(moved, n), 1.0, depth, mu)", "tangential(moved, n)")
edit("3.15", "takes the normal part of the displacement for the depth", "1.0, depth", "1.0, max(0.0, -(moved @ n))")
edit("3.15", "takes back everything where there is no depth", "return friction_impulse",
     "return -tangential(moved, n) if depth == 0.0 else friction_impulse")
for words, test in partial_tests("tangential(moved, n)"):
    edit("3.15", f"corrects no displacement if {words} is 0", "return friction_impulse",
         f"return ({test} != 0.0) * friction_impulse")
edit("3.15", "takes a depth below 0.1 nm for none", "1.0, depth", "1.0, depth * (depth > 1e-10)")
edit("3.15", "takes a displacement below 0.1 nm for none", "tangential(moved, n)",
     "tangential(moved, n) * (moved @ moved > 1e-20)")


# 3.17 -----------------------------------------------------------------------------------------------------------
@right("3.17", "by speeds")
def sliding_distance(v, width, mu_near, mu_far, g):
    way = v * v / (2.0 * mu_near * g)
    return way if way <= width else width + (way - width) * mu_near / mu_far


edit("3.17", "slides on as if the strip had no end", "left <= 0.0", "True")
edit("3.17", "forgets that a slow block stops on the strip", "left <= 0.0", "False")
edit("3.17", "gives the strip the friction of the ground behind it", "0.5 * v * v - mu_near", "0.5 * v * v - mu_far")
edit("3.17", "gives the ground behind the strip the friction of the strip", "left / (mu_far", "left / (mu_near")
edit("3.17", "counts the way from the far edge of the strip", "return width + left", "return left")
edit("3.17", "forgets the half of ½mv² where the block enters", "left = 0.5 * v * v", "left = v * v")
edit("3.17", "forgets the half of ½mv² of a block that stops on the strip", "return 0.5 * v * v", "return v * v")
edit("3.17", "lets the strip take nothing from the energy", "0.5 * v * v - mu_near * g * width", "0.5 * v * v")
edit("3.17", "subtracts μ g s from the speed, not 2 μ g s from its square", "left / (mu_far * g)",
     "0.5 * max(0.0, v - mu_near * g * width) ** 2 / (mu_far * g)")
edit("3.17", "subtracts μ g s from the speed, not 2 μ g s from its square", "0.5 * v * v - mu_near * g * width",
     "0.5 * (v - mu_near * g * width) * abs(v - mu_near * g * width)")
edit("3.17", "divides by the mean of both frictions behind the strip", "left / (mu_far",
     "left / (0.5 * (mu_near + mu_far)")
edit("3.17", "slides over the whole strip from rest", "return 0.5 * v * v / (mu_near * g)",
     "return 0.5 * v * v / (mu_near * g) if v > 0.0 else width")
edit("3.17", "takes the gravity of the earth on the strip", "mu_near * g * width", "mu_near * 9.81 * width")
edit("3.17", "takes the gravity of the earth behind the strip", "mu_far * g", "mu_far * 9.81")
edit("3.17", "takes the gravity of the earth for a block that stops on the strip", "(mu_near * g)", "(mu_near * 9.81)")
edit("3.17", "lets a block stop on the strip that is barely fast enough to cross it", "left <= 0.0", "left <= 1e-9")


# 3.18 -----------------------------------------------------------------------------------------------------------
@right("3.18", "as a small letter")
def dry_friction_is():
    return "c"


edit("3.18", "takes static friction for μ_s F_N at every pull: it would drag a block that nothing pulls", '"C"', '"A"')
edit("3.18", "lets friction stay at its limit: once the block slides, kinetic friction acts, which is smaller",
     '"C"', '"B"')
edit("3.18", "lets the block slip as soon as the pull exceeds kinetic friction: it holds up to μ_s F_N", '"C"', '"D"')


# 3.19 -----------------------------------------------------------------------------------------------------------
@right("3.19", "grips better the slower the block is")
def my_friction(v_t, m, j_n, mu):
    speed = np.sqrt(v_t @ v_t)
    if speed == 0.0:
        return 0.0 * v_t
    return -min(m * speed, mu * j_n * (1.0 + 1.0 / (1.0 + speed))) / speed * v_t


@right("3.19", "a brush whose hairs lie along x: twice the friction against them")
def brushed(v_t, m, j_n, mu):
    speed = np.sqrt(v_t @ v_t)
    if speed == 0.0:
        return 0.0 * v_t
    return -min(m * speed, mu * j_n * (2.0 if v_t[0] < 0.0 else 0.7)) / speed * v_t


@right("3.19", "a skate on ice: its friction depends on its direction, and is against the motion")
def skating(v_t, m, j_n, mu):
    speed = np.sqrt(v_t @ v_t)
    if speed == 0.0:
        return 0.0 * v_t
    return -min(m * speed, mu * j_n * (1.0 - 0.6 * (v_t[0] / speed) ** 2)) / speed * v_t


FIRST = "along = np.minimum(0.5 * mu * j_n, m * abs(v_t[0]))"
edit("3.19", "is Coulomb's floor", FIRST, "return friction_impulse(v_t, m, j_n, mu)")
edit("3.19", "is the pyramid of 3.6", FIRST,
     "return pyramid_impulse(v_t, m, j_n, mu, np.array([1.0, 0.0]), np.array([0.0, 1.0]))")
edit("3.19", "is a little less than Coulomb's floor", FIRST, "return 0.999 * friction_impulse(v_t, m, j_n, mu)")
edit("3.19", "does nothing", FIRST, "return 0.0 * v_t")
edit("3.19", "pushes the block along", "return -np.array", "return np.array")
edit("3.19", "is not limited along the blade: it turns a slow block round",
     "np.minimum(0.5 * mu * j_n, m * abs(v_t[0]))",
     "0.5 * mu * j_n")
edit("3.19", "is the drag of a fluid, which never quite stops the block", FIRST, "return -0.1 * m * v_t")
edit("3.19", "is the drag of a fluid, which never quite stops the block", FIRST, "return -mu * j_n * v_t")
edit("3.19", "turns the block round without slowing it", FIRST, "return -2.0 * m * v_t")
edit("3.19", "brakes along the blade only", "np.sign(v_t[1]) * across", "0.0")
edit("3.19", "stops the block at once, even without a load", FIRST, "return -m * v_t")
edit("3.19", "takes the load of a block of 1 kg, regardless of the load", FIRST,
     "j_n = 0.2; along = np.minimum(0.5 * mu * j_n, m * abs(v_t[0]))")
edit("3.19", "exchanges the axes of the blade's impulse", "[np.sign(v_t[0]) * along, np.sign(v_t[1]) * across]",
     "[np.sign(v_t[1]) * across, np.sign(v_t[0]) * along]")
edit("3.19", "forgets the mass along the blade: a light block goes back faster, a heavy one never quite stops",
     "m * abs(v_t[0])", "abs(v_t[0])")
edit("3.19", "forgets the mass across the blade", "m * abs(v_t[1])", "abs(v_t[1])")
edit("3.10", "asks for the slip at the end of the step, not at the middle", "t + middle, x", "t + dt, x")
edit("3.5", "divides zero by zero for a body at rest without friction", "m * speed <= limit", "m * speed < limit")
for number, old, new in (("3.3", "cone_radius(mu_k", "cone_radius(min(mu_k, 1.0)"),
                         ("3.4", "g * (np.sin(theta) - cone_radius(mu_k",
                          "g * (np.sin(theta) - cone_radius(min(mu_k, 1.0)"),
                         ("3.5", "cone_radius(mu", "cone_radius(min(mu, 1.0)"),
                         ("3.7", "cone_radius(p.mu_s", "cone_radius(min(p.mu_s, 1.0)"),
                         ("3.7", "a_n, p.mu_k)", "a_n, min(p.mu_k, 1.0))"),
                         ("3.13", "j_n, mu)", "j_n, min(mu, 1.0))"), ("3.14", "p.mu)", "min(p.mu, 1.0))"),
                         ("3.16", "-phi, p.mu)", "-phi, min(p.mu, 1.0))"),
                         ("3.16", "p.e, p.mu)", "p.e, min(p.mu, 1.0))"),
                         ("3.17", "(mu_far * g)", "(min(mu_far, 1.0) * g)"),
                         ("3.17", "- mu_near * g", "- min(mu_near, 1.0) * g")):
    edit(number, "allows no friction above 1", old, new)
edit("3.10", "evaluates the slip at τ in place of t + τ, while it halves", "t + middle, x", "middle, x")
