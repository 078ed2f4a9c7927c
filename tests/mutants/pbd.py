"""Lesson 8: projections with a wrong sign, mass, step or order."""

import numpy as np

from solutions import pbd as worked
from solutions.checks import BadInput, Diverged

from . import collection, variants

wrong, right, edit, MUTANTS = collection(worked)
NO_LENGTH = BadInput("the length of a link [m]", 0.0, "keep its ends apart")
NO_WEIGHT = BadInput("Σ w |∇C|² of a constraint", 0.0, "let one of its points have a mass and a gradient")


def size(y):
    return np.linalg.norm(y)


# 8.1 ------------------------------------------------------------------------------------------------------------
@variants
def link(sign=1.0, scaled=True, absolute=False, towards=1.0, squared=False, checked=True, ratio=False):
    def distance_constraint(x_i, x_j, rest):
        r, length = x_i - x_j, size(x_i - x_j)
        if length == 0.0:
            if checked:
                raise NO_LENGTH
            return -rest, r
        C = sign * (length - rest) if not squared else length**2 - rest**2
        C = C / rest if ratio else C
        return abs(C) if absolute else C, towards * (r / length if scaled else r)
    return distance_constraint


right("8.1", "with norm")(link())
wrong("8.1", "reverses the sign of C")(link(sign=-1.0))
wrong("8.1", "returns the gradient of the other point")(link(towards=-1.0))
wrong("8.1", "does not normalise the gradient")(link(scaled=False))
wrong("8.1", "treats a link that is too short as satisfied")(link(absolute=True))
wrong("8.1", "uses the squares of the lengths")(link(squared=True))
wrong("8.1", "returns the strain in place of the extension")(link(ratio=True))
wrong("8.1", "accepts coincident ends")(link(checked=False))
edit("8.1", "refuses short segments", "length == 0.0", "length < 1e-9")
edit("8.1", "treats a picometre as zero", "length == 0.0", "length < 1e-12")
edit("8.1", "treats a link that is too long as satisfied", "length - rest", "min(0.0, length - rest)")
edit("8.1", "reverses the gradient where the link is too short", "r / length", "r / length * np.sign(rest - length)")
edit("8.1", "refuses links along the second axis", "length == 0.0", "r[0] == 0.0")
edit("8.1", "refuses links whose components add up to 0", "length == 0.0", "np.sum(r) == 0.0")
edit("8.1", "refuses a link whose first end is at the origin", "length == 0.0", "length == 0.0 or not x_i.any()")
edit("8.1", "returns a zero gradient at the rest length", "r / length", "r / length * abs(np.sign(length - rest))")
edit("8.1", "adds the rest length", "length - rest", "length + rest")
edit("8.1", "forgets the root", "np.sqrt(np.sum(r * r))", "np.sum(r * r)")
edit("8.1", "forgets the rest length", "length - rest", "length")
GRADIENT_OVER_REST_LENGTH = edit("8.1", "divides the gradient by the rest length", "r / length", "r / rest")
edit("8.1", "takes the size of the extension", "length - rest", "abs(length - rest)")
edit("8.1", "uses half of the squares of the lengths, and their gradient", "return length - rest, r / length",
     "return 0.5 * (length * length - rest * rest), r")
edit("8.1", "uses the squares of the lengths, and their gradient", "return length - rest, r / length",
     "return length * length - rest * rest, 2.0 * r")
edit("8.1", "refuses a link that is very short beside its rest length", "length == 0.0", "length < 1e-12 * rest")
edit("8.1", "refuses a link whose ends are close to each other", "length == 0.0", "np.allclose(x_i, x_j, 1e-9, 0.0)")


# 8.2 ------------------------------------------------------------------------------------------------------------
@variants
def projecting(sign=-1.0, mass=True, total=lambda w, g: np.sum(w * np.sum(g * g, axis=1)), checked=True):
    def constraint_correction(C, gradients, inv_mass):
        s = total(inv_mass, gradients)
        if s == 0.0:
            if checked:
                raise NO_WEIGHT
            return 0.0 * gradients
        return sign * C / s * (inv_mass[:, None] if mass else 1.0) * gradients
    return constraint_correction


right("8.2", "all points at once")(projecting())
wrong("8.2", "moves the wrong way")(projecting(sign=1.0))
wrong("8.2", "moves every point alike, regardless of its mass")(projecting(mass=False))
wrong("8.2", "omits the masses in the denominator")(projecting(total=lambda w, g: np.sum(g * g)))
wrong("8.2", "takes gradients for unit vectors")(projecting(total=lambda w, g: np.sum(w)))
wrong("8.2", "corrects half of the error only")(projecting(sign=-0.5))
wrong("8.2", "accepts an unsatisfiable constraint")(projecting(checked=False))
edit("8.2", "solves for each point on its own", "-C / weight * inv_mass[:, None]",
     "-C / np.sum(gradients**2, axis=1)[:, None] * (inv_mass > 0.0)[:, None]")
edit("8.2", "refuses small masses", "weight == 0.0", "weight < 1e-6")
edit("8.2", "refuses only where all masses are infinite or all gradients 0", "weight == 0.0",
     "np.all(inv_mass == 0.0) or np.all(gradients == 0.0)")
edit("8.2", "refuses gradients that add up to 0", "weight == 0.0", "weight == 0.0 or np.sum(gradients) == 0.0")
edit("8.2", "refuses gradients that add up to 0 with their inverse masses", "weight == 0.0",
     "np.sum(inv_mass[:, None] * gradients) == 0.0")
edit("8.2", "refuses a constraint of which the gradients of each point add up to 0", "weight == 0.0",
     "not np.any(np.sum(gradients, axis=1))")
edit("8.2", "refuses a constraint of which the points' gradients cancel", "weight == 0.0",
     "weight == 0.0 or not np.any(inv_mass @ gradients)")
edit("8.2", "refuses a constraint of which all gradients have no first component", "weight == 0.0",
     "weight == 0.0 or not np.any(gradients[:, 0])")
edit("8.2", "refuses very small masses and gradients", "weight == 0.0", "weight < 1e-20")
edit("8.2", "takes the gradient of a single point for a unit vector", "return -C / weight",
     "return -C * gradients if inv_mass.size == 1 else -C / weight")
edit("8.2", "returns the gradients where the constraint holds", "return -C / weight",
     "return gradients if C == 0.0 else -C / weight")
edit("8.2", "accepts immovable points where the constraint holds", "if weight == 0.0:",
     "if C == 0.0:\n        return 0.0 * gradients\n    if weight == 0.0:")
edit("8.2", "refuses a constraint one of whose points has no gradient", "if weight == 0.0:",
     "if weight == 0.0 or not np.all(np.any(gradients != 0.0, axis=1)):")
edit("8.2", "multiplies by Σ w |∇C|²", "-C / weight", "-C * weight")
edit("8.2", "forgets Σ w |∇C|²", "-C / weight", "-C")
edit("8.2", "uses the masses in place of their inverses",
     "* inv_mass[:, None] * gradients", "/ inv_mass[:, None] * gradients")
edit("8.2", "forgets the square of the gradients", "inv_mass[k] * g * g", "inv_mass[k] * g")
edit("8.2", "forgets C", "-C / weight", "-1.0 / weight")
edit("8.2", "divides each gradient by its length", "* gradients",
     "* gradients / np.maximum(1e-300, np.sqrt(np.sum(gradients * gradients, axis=1)))[:, None]")


# 8.3 ------------------------------------------------------------------------------------------------------------
@variants
def predicting(half=1.0, stops=False, falls=False, clock=1.0, speed=1.0, changes=False):
    def predict(acceleration, t, x, v, dt, network):
        free = (network.inv_mass > 0.0)[:, None]
        a = np.asarray(acceleration(clock * t, x, speed * v, network)) * (1.0 if falls else free)
        move = dt * v * (free if stops else 1.0) + half * dt * dt * a
        if changes:
            x += move
            return x
        return x + move
    return predict


right("8.3", "with a mask")(predicting())
wrong("8.3", "adds ½ dt² a in place of dt² a")(predicting(half=0.5))
wrong("8.3", "stops immovable points")(predicting(stops=True))
wrong("8.3", "lets immovable points fall")(predicting(falls=True))
wrong("8.3", "does not advance t")(predicting(clock=0.0))
wrong("8.3", "takes the acceleration at zero velocity")(predicting(speed=0.0))
wrong("8.3", "changes its input")(predicting(changes=True))
edit("8.3", "divides the acceleration of heavy points by their mass",
     "free = network.inv_mass > 0.0", "free = np.minimum(1.0, network.inv_mass)")
wrong("8.3", "omits the acceleration")(predicting(half=0.0))
edit("8.3", "treats heavy points as immovable", "network.inv_mass > 0.0", "network.inv_mass > 1e-6")
edit("8.3", "changes the array that the acceleration returned", "a = acceleration(t, x, v, network)",
     "a = acceleration(t, x, v, network)\n    a[network.inv_mass == 0.0] = 0.0")
@right("8.3", "asks no immovable point for its acceleration")
def predict(acceleration, t, x, v, dt, network):
    a = acceleration(t, x, v, network)
    return x + dt * (v + dt * np.where(network.inv_mass[:, None] > 0.0, a, 0.0))


edit("8.3", "uses dt in place of dt² beside the acceleration", "dt * dt * free", "dt * free")
edit("8.3", "forgets dt beside the velocity", "x + dt * v", "x + v")
edit("8.3", "subtracts the acceleration", "+ dt * dt * free", "- dt * dt * free")
edit("8.3", "returns the change of the positions", "return x + dt * v", "return dt * v")
edit("8.3", "multiplies the acceleration by the inverse mass", "free[:, None] * a", "network.inv_mass[:, None] * a")
edit("8.3", "omits the velocity", "x + dt * v + dt", "x + dt")
edit("8.3", "does not accelerate points at rest", "free = network.inv_mass > 0.0",
     "free = (network.inv_mass > 0.0) * v.any(axis=1)")
edit("8.3", "returns a point that is alone as a vector", "return x + dt * v + dt * dt * free[:, None] * a",
     "new = x + dt * v + dt * dt * free[:, None] * a\n    return new if len(new) > 1 else new[0]")
edit("8.3", "treats very heavy points as immovable", "network.inv_mass > 0.0", "network.inv_mass > 1e-16")


# 8.4 ------------------------------------------------------------------------------------------------------------
@variants
def newton(curved=1.0, per_row=True, scale=lambda dt: dt * dt, sign=1.0, from_goal=1.0, difference=False, across=True):
    def newton_correction(x, lam, goal, dt, network):
        d, n, s = x.shape[1], x.size, network.i.size
        C, J = worked.constraints(x, network)
        W = np.repeat(network.inv_mass, d)
        bend = np.zeros((n, n))
        for k in range(s):
            i, j = slice(network.i[k] * d, network.i[k] * d + d), slice(network.j[k] * d, network.j[k] * d + d)
            H = lam[k] * ((np.eye(d) if across else 0.0) - np.outer(J[k, i], J[k, i])) / (C[k] + network.rest[k])
            bend[i, i] += H
            bend[j, j] += H
            bend[i, j] -= H
            bend[j, i] -= H
        push = W[:, None] * J.T if per_row else J.T * W.max()
        trace = worked.REGULARISATION * (network.inv_mass[network.i] + network.inv_mass[network.j])
        A = np.block([[np.eye(n) - curved * dt * dt * W[:, None] * bend, -sign * push], [J, np.diag(-trace)]])
        found = np.linalg.solve(A, np.concatenate((from_goal * (goal - x).ravel(), -C - trace * dt * dt * lam)))
        return found[:n].reshape(x.shape), found[n:] / scale(dt) + (lam if difference else 0.0)
    return newton_correction


right("8.4", "in blocks")(newton())
wrong("8.4", "takes links for straight surfaces: no second derivative")(newton(curved=0.0))
wrong("8.4", "reverses the sign of the second derivative")(newton(curved=-1.0))
wrong("8.4", "uses the same mass for all points")(newton(per_row=False))
wrong("8.4", "returns Λ in place of λ")(newton(scale=lambda dt: 1.0))
wrong("8.4", "uses dt in place of dt²")(newton(scale=lambda dt: dt))
wrong("8.4", "reverses the sign of the multipliers")(newton(sign=-1.0))
wrong("8.4", "reverses the difference from the prediction")(newton(from_goal=-1.0))
wrong("8.4", "adds the old λ")(newton(difference=True))
wrong("8.4", "omits the part of the second derivative across the link")(newton(across=False))
SHARE = "REGULARISATION * (network.inv_mass[network.i[s]] + network.inv_mass[network.j[s]])"
edit("8.4", "omits the small regularisation", SHARE, "0.0")
edit("8.4", "lets the regularisation act on λ, not on its change", " - trace * dt * dt * lam[s]", "")
edit("8.4", "omits the masses in the regularisation", SHARE, "REGULARISATION * 2.0")
edit("8.4", "assumes that link s joins the points s and s + 1", "for s in range(C.size):",
     "network = network._replace(i=np.arange(C.size), j=np.arange(C.size) + 1)\n    for s in range(C.size):")
edit("8.4", "uses the mass of one end only in the regularisation",
     "(network.inv_mass[network.i[s]] + network.inv_mass[network.j[s]])",
     "network.inv_mass[network.i[s]]")
edit("8.4", "uses the larger of both inverse masses in the regularisation",
     "(network.inv_mass[network.i[s]] + network.inv_mass[network.j[s]])",
     "np.maximum(network.inv_mass[network.i[s]], network.inv_mass[network.j[s]])")
edit("8.4", "uses the smaller of both inverse masses in the regularisation",
     "(network.inv_mass[network.i[s]] + network.inv_mass[network.j[s]])",
     "np.minimum(network.inv_mass[network.i[s]], network.inv_mass[network.j[s]])")
edit("8.4", "uses the root of the sum of the squares of both inverse masses in the regularisation",
     "(network.inv_mass[network.i[s]] + network.inv_mass[network.j[s]])",
     "np.hypot(network.inv_mass[network.i[s]], network.inv_mass[network.j[s]])")
edit("8.4", "adds C in place of subtracting it", "-C[s] - trace", "C[s] - trace")
edit("8.4", "takes the compliance on the diagonal with the wrong sign",
     "A[size + s, size + s] = -trace", "A[size + s, size + s] = trace")
edit("8.4", "omits the masses beside the multipliers", "-network.inv_mass[e] * J[s, a]", "-J[s, a]")
edit("8.4", "multiplies the multipliers by dt² in place of dividing",
     "found[size:] / (dt * dt)", "found[size:] * (dt * dt)")
edit("8.4", "returns the new positions, not their change", "return change,", "return x + change,")
edit("8.4", "takes 1 N for a multiplier of 0", "bend = dt * dt * lam[s]", "bend = dt * dt * (lam[s] or 1.0)")


# 8.5 ------------------------------------------------------------------------------------------------------------
@variants
def projecting(enough=lambda done, change, longest: change <= 1e-12 * longest, speed=lambda new, x, goal, v,
                    dt: (new - x) / dt, start="x", gives_up=True, force=True):
    def constraint_projection_step(acceleration, t, x, v, dt, network):
        goal = worked.predict(acceleration, t, x, v, dt, network)
        new, lam = (x if start == "x" else goal).copy(), np.zeros(network.i.size)
        for done in range(worked.NEWTON_LIMIT):
            change, found = worked.newton_correction(new, lam, goal if force else x, dt, network)
            new, lam = new + change, found
            if enough(done, np.abs(change).max(), network.rest.max(initial=0.0)):
                return new, speed(new, x, goal, v, dt)
        if gives_up:
            raise Diverged("the projection did not converge at dt [s]", dt, "take a smaller step")
        return new, speed(new, x, goal, v, dt)
    return constraint_projection_step


wrong("8.5", "stops after one iteration")(projecting(enough=lambda done, change, longest: True))
wrong("8.5", "stops after two iterations")(projecting(enough=lambda done, change, longest: done == 1))
wrong("8.5", "compares the change with an absolute 1e-12 m")(
    projecting(enough=lambda done, change, longest: change <= 1e-12))
edit("8.5", "tests only positive corrections", "np.max(np.abs(change))", "np.max(change)")
edit("8.5", "tests the sum of all corrections", "np.max(np.abs(change))", "np.abs(np.sum(change))")
edit("8.5", "tests the sum of the corrections of each coordinate", "np.max(np.abs(change))",
     "np.max(np.abs(np.sum(change, axis=0)))")
edit("8.5", "tests the sum of the corrections of each point", "np.max(np.abs(change))",
     "np.max(np.abs(np.sum(change, axis=1)))")
edit("8.5", "tests the first coordinate only", "np.max(np.abs(change))", "np.max(np.abs(change[:, 0]))")
edit("8.5", "tests the last coordinate only", "np.max(np.abs(change))", "np.max(np.abs(change[:, -1]))")
edit("8.5", "tests the first point only", "np.max(np.abs(change))", "np.max(np.abs(change[0]))")
edit("8.5", "tests the last point only", "np.max(np.abs(change))", "np.max(np.abs(change[-1]))")
edit("8.5", "corrects the first two coordinates only", "new = new + change",
     "change[:, 2:] = 0.0\n        new = new + change")
wrong("8.5", "does not raise Diverged")(projecting(gives_up=False))
wrong("8.5", "keeps the predicted velocity")(projecting(speed=lambda new, x, goal, v, dt: (goal - x) / dt))
wrong("8.5", "keeps the old velocity")(projecting(speed=lambda new, x, goal, v, dt: v))
wrong("8.5", "forgets the prediction")(projecting(force=False))
wrong("8.5", "does not divide by dt in the velocity")(projecting(speed=lambda new, x, goal, v, dt: new - x))
wrong("8.5", "starts the iteration at the prediction")(projecting(start="goal"))
edit("8.5", "stops when the links have their length, wherever the points are", "np.max(np.abs(change)) <=",
     "np.max(np.abs(constraints(new, network)[0]), initial=0.0) <=")
edit("8.5", "stops immovable points that move", "new = new + change",
     "change[network.inv_mass == 0.0] = 0.0\n        new = new + change")
edit("8.5", "uses gravity in place of the acceleration", "predict(acceleration, t,", "predict(network_gravity, t,")
edit("8.5", "takes the acceleration at time t + dt", "predict(acceleration, t,", "predict(acceleration, t + dt,")
edit("8.5", "restarts λ at zero in every iteration", "change, lam = newton", "change, _ = newton")
edit("8.5", "takes the first link for the longest", "np.max(network.rest)", "network.rest[0]")
edit("8.5", "takes the last link for the longest", "np.max(network.rest)", "network.rest[-1]")
edit("8.5", "needs at least one link", "np.max(network.rest) if network.i.size > 0 else 0.0", "np.max(network.rest)")
edit("8.5", "stops after eight iterations", "range(NEWTON_LIMIT)", "range(8)")
edit("8.5", "accepts NaN as converged", "np.max(np.abs(change)) <= NEWTON_TOLERANCE * longest",
     "not np.max(np.abs(change)) > NEWTON_TOLERANCE * longest")
edit("8.5", "stops after fifteen iterations", "range(NEWTON_LIMIT)", "range(15)")
edit("8.5", "stops after thirty iterations", "range(NEWTON_LIMIT)", "range(30)")
edit("8.5", "multiplies by dt in the velocity", "(new - x) / dt", "(new - x) * dt")
edit("8.5", "takes the velocity with the wrong sign", "(new - x) / dt", "(x - new) / dt")
edit("8.5", "replaces the positions by their change", "new = new + change", "new = change")
edit("8.5", "subtracts the change", "new = new + change", "new = new - change")
edit("8.5", "takes the change of velocity from the prediction", "(new - x) / dt", "(new - goal) / dt")
edit("8.5", "adds the correction over dt to the old velocity, without the acceleration", "(new - x) / dt",
     "v + (new - goal) / dt")


# 8.6 ------------------------------------------------------------------------------------------------------------
@variants
def sweeping(stiff=True, by_mass=True, sign=1.0, jacobi=False, backwards=False, changes=False, checked=True, held=True):
    def distance_sweep(x, network):
        seen = x.copy()
        new = x if changes else x.copy()
        order = range(network.i.size)
        for s in reversed(order) if backwards else order:
            i, j = network.i[s], network.j[s]
            r = (seen if jacobi else new)[i] - (seen if jacobi else new)[j]
            weight = lambda k: network.inv_mass[k] if by_mass else float(network.inv_mass[k] > 0.0)
            w_i, w_j = (weight(i), weight(j)) if held else (1.0, 1.0)
            if not r.any():
                if checked:
                    raise NO_LENGTH
                continue
            share = sign * (network.stiffness[s] if stiff else 1.0) / (w_i + w_j)
            move = share * (size(r) - network.rest[s]) * r / size(r)
            new[i] -= w_i * move
            new[j] += w_j * move
        return new
    return distance_sweep


right("8.6", "with vectors")(sweeping())
wrong("8.6", "ignores the stiffness: always corrects the whole error")(sweeping(stiff=False))
wrong("8.6", "moves both ends equally, regardless of their masses")(sweeping(by_mass=False))
wrong("8.6", "reverses the corrections")(sweeping(sign=-1.0))
wrong("8.6", "corrects all links at once, from the old positions")(sweeping(jacobi=True))
wrong("8.6", "visits the links from the last to the first")(sweeping(backwards=True))
wrong("8.6", "changes its input")(sweeping(changes=True))
wrong("8.6", "accepts coincident ends")(sweeping(checked=False))
wrong("8.6", "moves both ends by half, also a heavy or an immovable one")(sweeping(held=False))
edit("8.6", "never pushes, as a thread", "share = network.stiffness[s]",
     "share = network.stiffness[s] * (length > network.rest[s])")
edit("8.6", "refuses short segments", "length == 0.0", "length < 1e-6")
edit("8.6", "refuses links whose components add up to 0", "length == 0.0", "np.sum(x[i] - x[j]) == 0.0")
edit("8.6", "refuses links along the second axis", "length == 0.0", "x[i, 0] == x[j, 0]")
edit("8.6", "assumes that link s joins the points s and s + 1", "i, j = network.i[s], network.j[s]", "i, j = s, s + 1")
edit("8.6", "uses the rest length of the first link for all", "network.rest[s]", "network.rest[0]")
FIRST_ONLY = edit("8.6", "uses the stiffness of the first link for all", "network.stiffness[s]", "network.stiffness[0]")
edit("8.6", "reduces the stiffness so that all sweeps together remove the share s", "network.stiffness[s] *",
     "(1.0 - (1.0 - network.stiffness[s]) ** (1.0 / network.sweeps)) *")
edit("8.6", "uses the stiffness of all sweeps in each sweep", "network.stiffness[s] *",
     "(1.0 - (1.0 - network.stiffness[s]) ** network.sweeps) *")
edit("8.6", "makes all sweeps in one call", "range(network.i.size)", "[*range(network.i.size)] * network.sweeps")
edit("8.6", "adds α in the denominator, as XPBD does", "(w[i] + w[j])", "(w[i] + w[j] + network.alpha[s])")
edit("8.6", "visits the links in the order of their first points", "range(network.i.size)", "np.argsort(network.i)")
edit("8.6", "refuses links shorter than a nanometre", "length == 0.0", "length < 1e-9")
edit("8.6", "ignores errors below a millionth of the length", "share = network.stiffness[s]",
     "share = (abs(length - network.rest[s]) > 1e-6 * length) * network.stiffness[s]")


@right("8.6", "by projection")
def distance_sweep(x, network):
    x = x.copy()
    for s in range(network.i.size):
        ends = [network.i[s], network.j[s]]
        C, n = worked.distance_constraint(x[ends[0]], x[ends[1]], network.rest[s])
        x[ends] += network.stiffness[s] * worked.constraint_correction(C, np.stack((n, -n)), network.inv_mass[ends])
    return x
edit("8.6", "returns its input where nothing is to be done", "x, w = float_copy(x), network.inv_mass",
     "w, r = network.inv_mass, x[network.i] - x[network.j]\n"
     "    if np.allclose(np.sqrt(np.sum(r ** 2, axis=1)), network.rest):\n        return x\n    x = float_copy(x)")
INVERSE_MASSES_EXCHANGED = edit("8.6", "exchanges the inverse masses of the two ends",
                                "w[i] * share, w[j] * share", "w[j] * share, w[i] * share")
edit("8.6", "forgets to divide by the inverse masses", "/ (w[i] + w[j])", "/ 1.0")
edit("8.6", "moves both ends in the same direction", "w[j] * share, x", "-w[j] * share, x")
edit("8.6", "moves the first end only", "w[j] * share, x", "0.0, x")
edit("8.6", "multiplies by the vector, not by the unit vector",
     "network.rest[s] / length - 1.0", "network.rest[s] - length")
edit("8.6", "makes the correction half as large", "share = network", "share = 0.5 * network")
edit("8.6", "compares the lengths by their ratio the other way round",
     "network.rest[s] / length - 1.0", "length / network.rest[s] - 1.0")
edit("8.6", "refuses a link that is very short beside its rest length", "length == 0.0",
     "length < 1e-9 * network.rest[s]")


# 8.7 ------------------------------------------------------------------------------------------------------------
@variants
def dynamics(sweeps=lambda n: n, speed=lambda new, x, goal, v, dt: (new - x) / dt, begin="goal"):
    def pbd_step(acceleration, t, x, v, dt, network):
        goal = worked.predict(acceleration, t, x, v, dt, network)
        new = (goal if begin == "goal" else x + dt * v).copy()
        for _ in range(sweeps(network.sweeps)):
            new = worked.distance_sweep(new, network)
        return new, speed(new, x, goal, v, dt)
    return pbd_step


right("8.7", "with a copy")(dynamics())
edit("8.7", "starts from the old positions and forgets the prediction",
     "new = predict(acceleration, t, x, v, dt, network)", "new = x")
wrong("8.7", "keeps the result of one sweep only")(dynamics(sweeps=lambda n: 1))
wrong("8.7", "makes one sweep too many")(dynamics(sweeps=lambda n: n + 1))
wrong("8.7", "makes no sweep")(dynamics(sweeps=lambda n: 0))
wrong("8.7", "keeps the predicted velocity")(dynamics(speed=lambda new, x, goal, v, dt: (goal - x) / dt))
wrong("8.7", "keeps the old velocity")(dynamics(speed=lambda new, x, goal, v, dt: v))
wrong("8.7", "adds the correction over dt to the old velocity, without the acceleration")(
    dynamics(speed=lambda new, x, goal, v, dt: v + (new - goal) / dt))
wrong("8.7", "omits the acceleration in the prediction")(dynamics(begin="x"))
edit("8.7", "sets the velocity of immovable points to zero",
     "(new - x) / dt", "(new - x) / dt * (network.inv_mass > 0.0)[:, None]")
edit("8.7", "visits the links from the last to the first", "distance_sweep(new, network)",
     "distance_sweep(new, network._replace(i=network.i[::-1], j=network.j[::-1], rest=network.rest[::-1], "
     "stiffness=network.stiffness[::-1]))")
edit("8.7", "uses gravity in place of the acceleration", "predict(acceleration, t,", "predict(network_gravity, t,")
edit("8.7", "takes the acceleration at time t + dt", "predict(acceleration, t,", "predict(acceleration, t + dt,")
wrong("8.7", "makes at most five sweeps")(dynamics(sweeps=lambda n: min(n, 5)))
edit("8.7", "corrects the first two coordinates only", "new = distance_sweep(new, network)",
     "new = distance_sweep(new, network)\n        new[:, 2:] = x[:, 2:]")
edit("8.7", "stops when less than a micrometre changes", "new = distance_sweep(new, network)",
     "old, new = new, distance_sweep(new, network)\n        if np.abs(new - old).max() < 1e-6:\n            break")
edit("8.7", "forgets dt in the velocity", "(new - x) / dt", "(new - x)")
edit("8.7", "multiplies by dt in the velocity", "(new - x) / dt", "(new - x) * dt")
edit("8.7", "takes the velocity with the wrong sign", "(new - x) / dt", "(x - new) / dt")
edit("8.7", "adds the change to the old velocity", "(new - x) / dt", "v + (new - x) / dt")
edit("8.7", "leaves points without gravity where they are", "new = predict(acceleration, t, x, v, dt, network)",
     "if not network.gravity.any():\n        return x, v\n    new = predict(acceleration, t, x, v, dt, network)")
edit("8.7", "takes the mean of the old and the new velocity", "(new - x) / dt", "0.5 * (v + (new - x) / dt)")
edit("8.7", "makes at most a hundred sweeps", "range(network.sweeps)", "range(min(network.sweeps, 100))")


# 8.8 ------------------------------------------------------------------------------------------------------------
@variants
def sagging(left=lambda s, n: (1.0 - s) ** n, step=lambda dt: dt * dt, below=lambda S: 1.0 - S, above=lambda S: S):
    def pbd_sag(g, dt, stiffness, sweeps):
        S = left(stiffness, sweeps)
        return g * step(dt) * above(S) / below(S)
    return pbd_sag


right("8.8", "by what is put back")(
    lambda g, dt, stiffness, sweeps: g * dt**2 / (1.0 - (1.0 - stiffness) ** sweeps) - g * dt**2)
wrong("8.8", "uses the share that the sweeps remove, not the share that they leave")(sagging(left=lambda s, n: s**n))
wrong("8.8", "omits the denominator, as if the mass fell in one step only")(sagging(below=lambda S: 1.0))
wrong("8.8", "returns the sag before the sweeps")(sagging(above=lambda S: 1.0))
wrong("8.8", "uses ½ g dt² in place of g dt²")(sagging(step=lambda dt: 0.5 * dt * dt))
edit("8.8", "counts at most five sweeps", "** sweeps", "** min(sweeps, 5)")
wrong("8.8", "multiplies the stiffness by the number of sweeps")(sagging(left=lambda s, n: max(0.0, 1.0 - n * s)))
edit("8.8", "counts at most fifty sweeps", "** sweeps", "** min(sweeps, 50)")
wrong("8.8", "multiplies a small stiffness by the number of sweeps")(
    sagging(left=lambda s, n: (1.0 - s) ** n if s > 0.01 else 1.0 - n * s))


edit("8.8", "uses dt in place of dt²", "g * dt * dt", "g * dt")
edit("8.8", "has the wrong sign in the denominator", "(1.0 - S)", "(1.0 + S)")
edit("8.8", "forgets the sweeps: counts one", "** sweeps", "** 1")
edit("8.8", "divides by the stiffness, as for a single sweep", "/ (1.0 - S)", "/ stiffness")
edit("8.8", "returns a negative sag", "return g", "return -g")


# 8.9 ------------------------------------------------------------------------------------------------------------
@variants
def folding(angle="atan2", wrapped=lambda C: np.pi - (np.pi - C) % (2.0 * np.pi), sign=1.0,
            wings=1.0, leverage=True, closed=True, checked=True, swapped=False, slope=1.0):
    def fold_constraint(x, fold):
        a, b, c, d = x
        e, N_c, N_d = b - a, np.cross(a - c, b - c), np.cross(b - d, a - d)
        if checked and not (N_c.any() and N_d.any()):
            raise BadInput("the area of a triangle at a fold [m²]", 0.0, "keep its corners apart")
        e_hat = e / size(e)
        with np.errstate(all="ignore"):
            phi = np.arctan2(np.cross(N_c, N_d) @ e_hat, N_c @ N_d)
            if angle == "acos":
                phi = np.arccos(np.clip(N_c @ N_d / size(N_c) / size(N_d), -1.0, 1.0))
            elif angle != "atan2":
                phi = np.pi - phi
            C = wrapped(sign * phi - fold)
            g_c, g_d = (-wings * size(e) ** slope * N / (N @ N) for N in (N_c, N_d))
        share = ((b - c) @ e / (e @ e), (b - d) @ e / (e @ e)) if leverage else (0.5, 0.5)
        share = tuple(1.0 - y for y in share) if swapped else share
        g_a = -share[0] * g_c - share[1] * g_d
        g_b = -(g_a + g_c + g_d) if closed else 0.0 * g_a
        return C, np.stack((g_a, g_b, g_c, g_d))
    return fold_constraint


right("8.9", "with NumPy's products")(folding())
wrong("8.9", "uses the arccosine, which loses the sign of the angle")(folding(angle="acos"))
wrong("8.9", "measures a flat fold as π, not as 0")(folding(angle="open"))
wrong("8.9", "does not bring the angle back into (−π, π]")(folding(wrapped=lambda C: C))
wrong("8.9", "brings only angles above π back into (−π, π]")(folding(wrapped=lambda C: C - 2.0 * np.pi * (C > np.pi)))
wrong("8.9", "brings only angles below −π back into (−π, π]")(
    folding(wrapped=lambda C: C + 2.0 * np.pi * (C <= -np.pi)))
wrong("8.9", "reverses the sign of the angle")(folding(sign=-1.0))
wrong("8.9", "reverses the gradients")(folding(wings=-1.0))
wrong("8.9", "omits the length of the edge in the gradients")(folding(slope=0.0))
wrong("8.9", "gives each end of the edge half of each wing's gradient")(folding(leverage=False))
wrong("8.9", "exchanges the shares of the two ends of the edge")(folding(swapped=True))
wrong("8.9", "returns gradients that do not add up to zero")(folding(closed=False))
wrong("8.9", "accepts a triangle without area")(folding(checked=False))
edit("8.9", "limits the share of c to 0 … 1", "dot(b - c, e) / squared",
     "min(1.0, max(0.0, dot(b - c, e) / squared))")
edit("8.9", "limits the share of d to 0 … 1", "dot(b - d, e) / squared",
     "min(1.0, max(0.0, dot(b - d, e) / squared))")
edit("8.9", "refuses triangles of whose normal the components add up to 0", "squared_c == 0.0 or squared_d == 0.0",
     "np.sum(N_c) == 0.0 or np.sum(N_d) == 0.0")
edit("8.9", "tests the components of one normal by their sum", "squared_d == 0.0:", "np.sum(N_d) == 0.0:")
edit("8.9", "refuses triangles whose normal has no first component", "squared_c == 0.0 or squared_d == 0.0",
     "N_c[0] == 0.0 or N_d[0] == 0.0")
edit("8.9", "takes a turn to half a turn for a whole one", "np.ceil((turn - np.pi) / (2.0 * np.pi))",
     "np.ceil((turn - 3.0) / (2.0 * np.pi))")
edit("8.9", "removes one full turn only", "np.ceil((turn - np.pi) / (2.0 * np.pi))",
     "np.sign(np.ceil((turn - np.pi) / (2.0 * np.pi)))")
edit("8.9", "tests the area of one triangle only", "squared_c == 0.0 or squared_d == 0.0", "squared_d == 0.0")
edit("8.9", "refuses small inputs", "squared_c == 0.0 or squared_d == 0.0", "squared_c < 1e-9 or squared_d < 1e-9")
edit("8.9", "removes two full turns only", "np.ceil((turn - np.pi) / (2.0 * np.pi))",
     "max(-2.0, min(2.0, np.ceil((turn - np.pi) / (2.0 * np.pi))))")
edit("8.9", "removes three full turns only", "np.ceil((turn - np.pi) / (2.0 * np.pi))",
     "max(-3.0, min(3.0, np.ceil((turn - np.pi) / (2.0 * np.pi))))")
edit("8.9", "refuses thin triangles", "squared_c == 0.0 or squared_d == 0.0",
     "squared_c < 1e-4 * squared**2 or squared_d < 1e-4 * squared**2")
edit("8.9", "refuses coincident corners only", "squared_c == 0.0 or squared_d == 0.0",
     "not all([(x[i] - x[j]).any() for i, j in ((0, 1), (0, 2), (1, 2), (0, 3), (1, 3))])")
edit("8.9", "accepts an edge without length", "squared_c == 0.0 or squared_d == 0.0",
     "squared > 0.0 and (squared_c == 0.0 or squared_d == 0.0)")


right("8.9", "brings the angle into [−π, π): half a turn has either sign")(
    folding(wrapped=lambda C: (C + np.pi) % (2.0 * np.pi) - np.pi))
right("8.9", "takes the angle of the sine and the cosine")(folding(wrapped=lambda C: np.arctan2(np.sin(C), np.cos(C))))
right("8.9", "subtracts the nearest number of turns")(
    folding(wrapped=lambda C: C - 2.0 * np.pi * np.round(C / (2.0 * np.pi))))


@right("8.9", "normals from the edge, the angle from its sine and cosine")
def fold_constraint(x, fold):
    e, c, d = x[1:] - x[0]
    N_c, N_d, length = np.cross(e, c), np.cross(d, e), size(e)
    if not (N_c.any() and N_d.any()):
        raise BadInput("the area of a triangle at a fold [m²]", 0.0, "keep its corners apart")
    u_c, u_d = N_c / size(N_c), N_d / size(N_d)
    C = np.arctan2(np.cross(u_c, u_d) @ (e / length), u_c @ u_d) - fold
    while C > np.pi:
        C -= 2.0 * np.pi
    while C <= -np.pi:
        C += 2.0 * np.pi
    g_c, g_d = -length / size(N_c) * u_c, -length / size(N_d) * u_d
    at_b = c @ e / (e @ e), d @ e / (e @ e)
    return C, np.stack((-(1.0 - at_b[0]) * g_c - (1.0 - at_b[1]) * g_d, -at_b[0] * g_c - at_b[1] * g_d, g_c, g_d))


edit("8.9", "adds the rest angle", "theta - fold", "theta + fold")
edit("8.9", "exchanges the arguments of the arctangent",
     "np.arctan2(dot(cross(N_c, N_d), e) / length, dot(N_c, N_d))",
     "np.arctan2(dot(N_c, N_d), dot(cross(N_c, N_d), e) / length)")
edit("8.9", "does not normalise the edge", "dot(cross(N_c, N_d), e) / length", "dot(cross(N_c, N_d), e)")
edit("8.9", "divides the gradients of the wings by |N| once",
     "-length / squared_c * N_c", "-length / np.sqrt(squared_c) * N_c")
edit("8.9", "returns the rows in the order c, d, a, b",
     "np.stack((hinge, -hinge - wing_c - wing_d, wing_c, wing_d))",
     "np.stack((wing_c, wing_d, hinge, -hinge - wing_c - wing_d))")
edit("8.9", "reverses the second normal", "cross(b - d, a - d)", "cross(a - d, b - d)")
edit("8.9", "measures the shares of an end from the other end",
     "-dot(b - c, e) / squared * wing_c - dot(b - d, e)", "-dot(a - c, e) / squared * wing_c - dot(b - d, e)")
edit("8.9", "forgets the rest angle", "theta - fold", "theta")
for side in ("-", "+"):
    edit("8.9", "takes a little less than half a turn for a little more, or the other way round",
         "np.ceil((turn - np.pi) / (2.0 * np.pi))", f"np.ceil((turn - np.pi {side} 1e-7) / (2.0 * np.pi))")


# 8.10 -----------------------------------------------------------------------------------------------------------
@variants
def ball(sign=1.0, n_sign=1.0, centred=True, scaled=True, safe=True):
    def ball_gap(x, obstacle):
        r = x - obstacle.centre if centred else x
        if safe and not r.any():
            return -obstacle.radius, 0.0 * r
        with np.errstate(invalid="ignore"):
            return sign * (size(r) - obstacle.radius), n_sign * (r / size(r) if scaled else r)
    return ball_gap


right("8.10", "with norm")(ball())
edit("8.10", "treats the ball as a bowl",
     "distance - obstacle.radius, r / distance", "obstacle.radius - distance, -r / distance")
edit("8.10", "treats a micrometre around the centre as the centre", "distance > 0.0", "distance > 1e-6")
edit("8.10", "treats round-off around the centre as the centre", "distance > 0.0", "distance > 1e-14")
edit("8.10", "returns no normal where a coordinate is that of the centre", "distance > 0.0", "np.all(r)")
edit("8.10", "returns no normal where the components of x − centre add up to 0", "distance > 0.0", "np.sum(r) != 0.0")
edit("8.10", "takes a point for the centre if its coordinates less those of the centre add up to 0",
     "distance - obstacle.radius", "(distance if np.sum(r) else 0.0) - obstacle.radius")
wrong("8.10", "reverses the sign of the gap")(ball(sign=-1.0))
wrong("8.10", "returns a normal that points inwards")(ball(n_sign=-1.0))
wrong("8.10", "puts the centre of the ball at the origin")(ball(centred=False))
wrong("8.10", "does not return a unit normal")(ball(scaled=False))
wrong("8.10", "divides by a distance of zero")(ball(safe=False))
edit("8.10", "returns the distance from the centre", "return distance - obstacle.radius,", "return distance,")
edit("8.10", "adds the centre", "x - obstacle.centre", "x + obstacle.centre")
edit("8.10", "forgets the root", "np.sqrt(np.sum(r * r))", "np.sum(r * r)")
edit("8.10", "adds the radius", "distance - obstacle.radius", "distance + obstacle.radius")
NORMAL_OVER_RADIUS = edit("8.10", "divides the normal by the radius", "r / distance if", "r / obstacle.radius if")
edit("8.10", "subtracts squares", "distance - obstacle.radius", "distance**2 - obstacle.radius**2")
edit("8.10", "treats what is very near the centre, beside the radius, as the centre", "distance > 0.0",
     "distance > 1e-9 * obstacle.radius")


# 8.11 -----------------------------------------------------------------------------------------------------------
@variants
def outside(asks=lambda phi: phi < 0.0, sign=-1.0, held=True, changes=False, share=1.0):
    def keep_outside(surface, x, inv_mass, obstacle):
        new = x if changes else x.copy()
        for k in range(len(x)):
            phi, n = surface(x[k], obstacle)
            if asks(phi) and (inv_mass[k] > 0.0 or not held):
                new[k] = x[k] + sign * share * phi * np.asarray(n)
        return new
    return keep_outside


right("8.11", "with a new array")(outside())
right("8.11", "treats the surface as inside")(outside(asks=lambda phi: phi <= 0.0))
wrong("8.11", "moves every point onto the surface")(outside(asks=lambda phi: True))
wrong("8.11", "moves points outside onto the surface")(outside(asks=lambda phi: phi > 0.0))
wrong("8.11", "reverses the correction, which pushes points in deeper")(outside(sign=1.0))
wrong("8.11", "moves points only half of the way")(outside(share=0.5))
wrong("8.11", "moves immovable points")(outside(held=False))
wrong("8.11", "changes its input")(outside(changes=True))
edit("8.11", "ignores depths below 5 cm", "phi < 0.0", "phi < -0.05")
edit("8.11", "moves heavy points less", "x[k] -= phi * n", "x[k] -= min(1.0, inv_mass[k]) * phi * n")
edit("8.11", "uses the gap of the first point for all points", "surface(x[k], obstacle)", "surface(x[0], obstacle)")
edit("8.11", "uses the floor in place of the given surface", "surface(x[k], obstacle)", "floor_gap(x[k], obstacle)")
edit("8.11", "returns three coordinates, also in the plane",
     "x = float_copy(x)", "x = float_copy(x) + np.zeros((x.shape[0], 3))")
edit("8.11", "moves a point at the centre of a ball upwards", "x[k] -= phi * n",
     "x[k] -= phi * (n if n.any() else np.eye(n.size)[-1])")
edit("8.11", "divides by the length of n", "x[k] -= phi * n", "x[k] -= phi * (n / np.sqrt(np.sum(n * n)))")
edit("8.11", "leaves points where the components of n add up to 0", "phi < 0.0 and",
     "phi < 0.0 and np.sum(n) != 0.0 and")
edit("8.11", "leaves points where n has no first component", "phi < 0.0 and", "phi < 0.0 and n[0] != 0.0 and")
edit("8.11", "treats heavy points as immovable", "inv_mass[k] > 0.0", "inv_mass[k] > 1e-6")
edit("8.11", "returns a point that is alone as a vector", "return x", "return x if len(x) > 1 else x[0]")
edit("8.11", "returns its input where nothing is inside", "x = float_copy(x)",
     "if min(surface(p, obstacle)[0] for p in x) >= 0.0:\n        return x\n    x = float_copy(x)")
edit("8.11", "moves the points that are outside only", "phi < 0.0", "phi > 0.0")
edit("8.11", "leaves points whose depth is small beside their coordinates", "phi < 0.0",
     "phi < -1e-6 * np.sqrt(np.sum(x[k] * x[k]))")
edit("8.11", "treats very heavy points as immovable", "inv_mass[k] > 0.0", "inv_mass[k] > 1e-13")


# 8.12 -----------------------------------------------------------------------------------------------------------
@variants
def giving(memory=1.0, sign=-1.0, below=1.0, checked=True, weighed=True, nan=True):
    def compliant_multiplier(C, Lam, weight, alpha_scaled):
        if checked and (alpha_scaled < 0.0 or (nan and alpha_scaled != alpha_scaled)):
            raise BadInput("scaled compliance α/dt² [1/kg]", alpha_scaled, "give zero or more")
        if weight == 0.0:
            if weighed:
                raise NO_WEIGHT
            return 0.0
        return (sign * C - memory * alpha_scaled * Lam) / (weight + below * alpha_scaled)
    return compliant_multiplier


right("8.12", "in two lines")(giving())
wrong("8.12", "omits the multiplier Λ so far")(giving(memory=0.0))
wrong("8.12", "omits α̃ in the denominator")(giving(below=0.0))
wrong("8.12", "reverses the sign of the change")(giving(sign=1.0))
wrong("8.12", "accepts a negative compliance")(giving(checked=False))
edit("8.12", "drops the sign of C", "-C - alpha_scaled", "-abs(C) - alpha_scaled")
wrong("8.12", "accepts NaN")(giving(nan=False))
wrong("8.12", "accepts a constraint without movable mass")(giving(weighed=False))
edit("8.12", "refuses heavy points", "weight == 0.0", "weight < 1e-9")
edit("8.12", "treats a very small compliance as zero", "-C - alpha_scaled * Lam",
     "-C - (alpha_scaled > 1e-6) * alpha_scaled * Lam")
edit("8.12", "accepts a slightly negative compliance", "not alpha_scaled >= 0.0", "not alpha_scaled >= -1e-9")
edit("8.12", "returns no change where C = 0", "(-C - alpha_scaled", "(C != 0.0) * (-C - alpha_scaled")
edit("8.12", "adds C", "(-C - alpha_scaled * Lam)", "(C - alpha_scaled * Lam)")
edit("8.12", "adds the multiplier so far with the wrong sign", "(-C - alpha_scaled * Lam)", "(-C + alpha_scaled * Lam)")
edit("8.12", "subtracts the compliance, where it is added", "weight + alpha_scaled", "weight - alpha_scaled")
edit("8.12", "multiplies by the denominator", "/ (weight + alpha_scaled)", "* (weight + alpha_scaled)")
edit("8.12", "returns the new Λ, not its change", "return (-C", "return Lam + (-C")
edit("8.12", "takes a weight of 1", "(weight + alpha_scaled)", "(1.0 + alpha_scaled)")
edit("8.12", "forgets the compliance beside the multiplier so far", "alpha_scaled * Lam", "Lam")
edit("8.12", "refuses very heavy points", "weight == 0.0", "weight < 1e-22")
edit("8.12", "accepts a compliance that is negative by round-off", "not alpha_scaled >= 0.0",
     "not alpha_scaled >= -1e-25")


# 8.13 -----------------------------------------------------------------------------------------------------------
@variants
def soft_sweep(adds=True, kept=True, jacobi=False, mass=True, sign=1.0, changes=False,
               checked=True, one_alpha=False, weight=1.0, stiffness=False, power=2):
    def compliant_sweep(x, Lam, dt, network):
        seen, new, total = x.copy(), (x if changes else x.copy()), (Lam if changes else Lam.copy())
        for s in range(network.i.size):
            i, j = network.i[s], network.j[s]
            r = (seen if jacobi else new)[i] - (seen if jacobi else new)[j]
            if not r.any():
                if checked:
                    raise NO_LENGTH
                continue
            w_i, w_j = network.inv_mass[i], network.inv_mass[j]
            alpha = network.alpha[0] if one_alpha else network.alpha[s]
            change = worked.compliant_multiplier(size(r) - network.rest[s], total[s] if kept else 0.0,
                                                 weight * (w_i + w_j), alpha / dt**power)
            change *= network.stiffness[s] if stiffness else 1.0
            total[s] = total[s] + change if adds else change
            new[i] = new[i] + sign * (w_i if mass else 1.0) * change * r / size(r)
            new[j] = new[j] - sign * (w_j if mass else 1.0) * change * r / size(r)
        return new, total
    return compliant_sweep


right("8.13", "with vectors")(soft_sweep())
wrong("8.13", "returns the last ΔΛ")(soft_sweep(adds=False))
wrong("8.13", "omits the multipliers so far")(soft_sweep(kept=False))
wrong("8.13", "corrects all links at once, from the old positions")(soft_sweep(jacobi=True))
wrong("8.13", "forgets the masses")(soft_sweep(mass=False))
wrong("8.13", "reverses the corrections")(soft_sweep(sign=-1.0))
wrong("8.13", "changes its input")(soft_sweep(changes=True))
wrong("8.13", "accepts coincident ends")(soft_sweep(checked=False))
wrong("8.13", "uses one compliance for all links")(soft_sweep(one_alpha=True))
wrong("8.13", "multiplies by PBD's stiffness as well")(soft_sweep(stiffness=True))
wrong("8.13", "uses α in place of α/dt²")(soft_sweep(power=0))
wrong("8.13", "uses α dt² in place of α/dt²")(soft_sweep(power=-2))
wrong("8.13", "uses α/dt in place of α/dt²")(soft_sweep(power=1))
wrong("8.13", "uses half of the inverse masses")(soft_sweep(weight=0.5))
edit("8.13", "never pushes, as a thread", "length - network.rest[s]", "max(0.0, length - network.rest[s])")
edit("8.13", "skips links that are too short, as if they were threads", "change = compliant",
     "if length <= network.rest[s]: continue\n        change = compliant")
edit("8.13", "assumes that link s joins the points s and s + 1", "i, j = network.i[s], network.j[s]", "i, j = s, s + 1")
edit("8.13", "uses the rest length of the first link for all", "network.rest[s]", "network.rest[0]")
edit("8.13", "never pushes where α = 0", "length - network.rest[s]",
     "length - network.rest[s] if network.alpha[s] else max(0.0, length - network.rest[s])")
edit("8.13", "never pulls where α = 0", "length - network.rest[s]",
     "length - network.rest[s] if network.alpha[s] else min(0.0, length - network.rest[s])")
edit("8.13", "skips links with α = 0", "i, j = network.i[s], network.j[s]",
     "i, j = network.i[s], network.j[s]\n        if network.alpha[s] == 0.0:\n            continue")
edit("8.13", "stores no Λ where α = 0", "Lam[s] += change", "Lam[s] += change * (network.alpha[s] > 0.0)")
edit("8.13", "does not check its input",
     "compliant_multiplier(length - network.rest[s], Lam[s], w[i] + w[j], network.alpha[s] / (dt * dt))",
     "(network.rest[s] - length - network.alpha[s] / dt**2 * Lam[s]) / (w[i] + w[j] + network.alpha[s] / dt**2)")
edit("8.13", "skips links between immovable points", "length = distance_between(x, i, j)",
     "length = distance_between(x, i, j)\n        if w[i] + w[j] == 0.0:\n            continue")
edit("8.13", "visits the links in the order of their first points", "range(network.i.size)", "np.argsort(network.i)")
edit("8.13", "skips links that have their rest length", "length = distance_between(x, i, j)",
     "length = distance_between(x, i, j)\n"
     "        if abs(length / network.rest[s] - 1.0) < 1e-9:\n            continue")
edit("8.13", "refuses links shorter than a nanometre", "length == 0.0", "length < 1e-9")
edit("8.13", "refuses links whose components add up to 0", "length == 0.0", "np.sum(x[i] - x[j]) == 0.0")
edit("8.13", "refuses links along the second axis", "length == 0.0", "x[i, 0] == x[j, 0]")
edit("8.13", "makes all sweeps in one call", "range(network.i.size)", "[*range(network.i.size)] * network.sweeps")
edit("8.13", "divides α by the number of sweeps",
     "network.alpha[s] / (dt * dt)", "network.alpha[s] / (dt * dt) / network.sweeps")
edit("8.13", "returns its input where there are no links", "x, Lam, w =",
     "if network.i.size == 0:\n        return x, Lam\n    x, Lam, w =")
edit("8.13", "exchanges the inverse masses of the two ends",
     "w[i] * change / length, w[j] * change / length", "w[j] * change / length, w[i] * change / length")
edit("8.13", "moves both ends in the same direction", "w[j] * change / length, x", "-w[j] * change / length, x")
edit("8.13", "subtracts the change from Λ", "Lam[s] += change", "Lam[s] -= change")
edit("8.13", "does not divide by the length",
     "w[i] * change / length, w[j] * change / length", "w[i] * change, w[j] * change")
edit("8.13", "exchanges C and Λ", "length - network.rest[s], Lam[s],", "Lam[s], length - network.rest[s],")
edit("8.13", "reverses the sign of C", "length - network.rest[s], Lam[s]", "network.rest[s] - length, Lam[s]")
edit("8.13", "moves the ends by the whole Λ, not by its change",
     "Lam[s] += change", "Lam[s] += change; change = Lam[s]")
edit("8.13", "takes a stiff spring for an inextensible link", "network.alpha[s] / (dt * dt)",
     "network.alpha[s] * (not 0.0 < network.alpha[s] < 1e-6) / (dt * dt)")
edit("8.13", "takes a compliance of at most 10 m/N", "network.alpha[s] / (dt * dt)",
     "(network.alpha[s] if not network.alpha[s] > 10.0 else 10.0) / (dt * dt)")


# 8.14 -----------------------------------------------------------------------------------------------------------
@variants
def soft_step(anew=False, sweeps=lambda n: n, hard=False, speed=lambda new, x, v, dt: (new - x) / dt, begin=0.0):
    def xpbd_step(acceleration, t, x, v, dt, network):
        new, Lam = worked.predict(acceleration, t, x, v, dt, network), np.full(network.i.size, begin)
        for _ in range(sweeps(network.sweeps)):
            new, Lam = worked.compliant_sweep(new, 0.0 * Lam if anew else Lam, dt, network)
            new = worked.distance_sweep(new, network) if hard else new
        return new, speed(new, x, v, dt)
    return xpbd_step


right("8.14", "with a loop")(soft_step())
wrong("8.14", "restarts Λ at zero in every sweep")(soft_step(anew=True))
wrong("8.14", "starts with Λ = 1")(soft_step(begin=1.0))
wrong("8.14", "takes a PBD step")(soft_step(hard=True))
wrong("8.14", "makes no sweep")(soft_step(sweeps=lambda n: 0))
wrong("8.14", "keeps the old velocity")(soft_step(speed=lambda new, x, v, dt: v))
edit("8.14", "sets the velocity of immovable points to zero",
     "(new - x) / dt", "(new - x) / dt * (network.inv_mass > 0.0)[:, None]")
wrong("8.14", "halves the velocity")(soft_step(speed=lambda new, x, v, dt: 0.5 * (new - x) / dt))
edit("8.14", "uses the last Λ for all links", "compliant_sweep(new, Lam, dt, network)",
     "compliant_sweep(new, np.full(network.i.size, Lam[-1]), dt, network)")
edit("8.14", "keeps one Λ per point, not per link", "np.zeros(network.i.size)", "np.zeros(x.shape[0])")
edit("8.14", "keeps one Λ per coordinate, not per link", "np.zeros(network.i.size)", "np.zeros(x.size)")
edit("8.14", "uses gravity in place of the acceleration", "predict(acceleration, t,", "predict(network_gravity, t,")
edit("8.14", "takes the acceleration at time t + dt", "predict(acceleration, t,", "predict(acceleration, t + dt,")
wrong("8.14", "makes at most five sweeps")(soft_step(sweeps=lambda n: min(n, 5)))
edit("8.14", "takes a PBD step where no link is soft", "Lam = np.zeros(network.i.size)",
     "Lam = np.zeros(network.i.size)\n"
     "    if not network.alpha.any():\n        return pbd_step(acceleration, t, x, v, dt, network)")
edit("8.14", "multiplies by dt in the velocity", "(new - x) / dt", "(new - x) * dt")
edit("8.14", "forgets dt in the velocity", "(new - x) / dt", "(new - x)")
edit("8.14", "takes the velocity with the wrong sign", "(new - x) / dt", "(x - new) / dt")
edit("8.14", "starts from the old positions and forgets the prediction",
     "new = predict(acceleration, t, x, v, dt, network)", "new = x")
edit("8.14", "makes one sweep only", "range(network.sweeps)", "range(1)")
edit("8.14", "leaves points without gravity where they are", "new = predict(acceleration, t, x, v, dt, network)",
     "if not network.gravity.any():\n        return x, v\n    new = predict(acceleration, t, x, v, dt, network)")
edit("8.14", "makes at most twenty sweeps", "range(network.sweeps)", "range(min(network.sweeps, 20))")


# 8.15 -----------------------------------------------------------------------------------------------------------
@variants
def readiness(turned=True, arm=np.cross, centre=1.0, moments=lambda I: 1.0 / I, back=False):
    def effective_inverse_mass_at(q, r, n, m, I_body):
        turn = arm(r, n)
        if turned:
            turn = worked.rotate(q, turn) if back else worked.unrotate(q, turn)
        return centre / m + np.sum(turn * turn * moments(I_body))
    return effective_inverse_mass_at


right("8.15", "with NumPy's product")(readiness())
wrong("8.15", "uses the body's moments with vectors in world axes")(readiness(turned=False))
wrong("8.15", "rotates from body to world in place of world to body")(readiness(back=True))
wrong("8.15", "omits the mass")(readiness(centre=0.0))
wrong("8.15", "omits the rotation")(readiness(arm=lambda r, n: 0.0 * r))
wrong("8.15", "uses the part of the arm along n in place of r × n")(readiness(arm=lambda r, n: (r @ n) * n))
edit("8.15", "uses a mass of at least 1 kg", "1.0 / m", "1.0 / max(m, 1.0)")
wrong("8.15", "multiplies by the moments")(readiness(moments=lambda I: I))
edit("8.15", "forgets the square of r × n", "turn * turn / I_body", "turn / I_body")
edit("8.15", "adds the mass in place of its inverse", "1.0 / m", "m")
edit("8.15", "uses the length of the arm in place of r × n", "cross(r, n)", "r")
edit("8.15", "divides by the squares of the moments", "turn * turn / I_body", "turn * turn / I_body**2")
edit("8.15", "returns the effective mass, not its inverse",
     "return 1.0 / m + np.sum(turn * turn / I_body)", "return 1.0 / (1.0 / m + np.sum(turn * turn / I_body))")
edit("8.15", "subtracts the rotation", "1.0 / m + np", "1.0 / m - np")
edit("8.15", "does not square the lever r × n", "turn * turn", "np.abs(turn)")
edit("8.15", "omits the rotation of a body with two equal moments", "turn = unrotate",
     "if I_body[0] == I_body[1]:\n        return 1.0 / m\n    turn = unrotate")
edit("8.15", "omits the rotation where the components of r × n add up to 0", "turn = unrotate",
     "if np.sum(cross(r, n)) == 0.0:\n        return 1.0 / m\n    turn = unrotate")
edit("8.15", "omits the rotation of a body in the orientation (1, 0, 0, 0)", "turn = unrotate",
     "if q[0] == 1.0:\n        return 1.0 / m\n    turn = unrotate")
edit("8.15", "omits the rotation at a point that is less than a millimetre from the centre of mass", "turn = unrotate",
     "if np.sqrt(np.sum(r * r)) < 1e-3:\n        return 1.0 / m\n    turn = unrotate")


# 8.16 -----------------------------------------------------------------------------------------------------------
@variants
def apply_multipliers(mass=True, sign=1.0, turned=True, half=1.0, unit=True, moves=1.0):
    def apply_positional_impulse(x, q, r, p, m, I_body):
        arm = sign * np.cross(r, p)
        turn = worked.rotate(q, worked.unrotate(q, arm) / I_body) if turned else arm / I_body
        new = q + 0.5 * half * worked.quaternion_product(np.append(0.0, turn), q)
        return x + moves * p / (m if mass else 1.0), new / size(new) if unit else new
    return apply_positional_impulse


right("8.16", "by the product itself")(apply_multipliers())
wrong("8.16", "forgets the mass")(apply_multipliers(mass=False))
wrong("8.16", "turns the other way")(apply_multipliers(sign=-1.0))
wrong("8.16", "uses the body's moments with vectors in world axes")(apply_multipliers(turned=False))
wrong("8.16", "turns twice as far")(apply_multipliers(half=2.0))
wrong("8.16", "does not normalise the quaternion")(apply_multipliers(unit=False))
edit("8.16", "uses a mass of at least 1 kg", "p / m", "p / max(m, 1.0)")
edit("8.16", "uses a mass of at most 1 kg", "p / m", "p / min(m, 1.0)")
wrong("8.16", "rotates the body and does not move it")(apply_multipliers(moves=0.0))
edit("8.16", "fails without rotation", "quaternion_update(q, turn, 1.0)",
     "quaternion_update(q, turn / np.sqrt(turn @ turn), np.sqrt(turn @ turn))")
edit("8.16", "ignores rotations below 1 µrad", "quaternion_update(q, turn, 1.0)",
     "quaternion_update(q, turn * (turn @ turn > 1e-12), 1.0)")
edit("8.16", "multiplies by the mass", "p / m", "p * m")
edit("8.16", "moves the other way", "x + p / m", "x - p / m")
edit("8.16", "multiplies by the moments", "/ I_body)", "* I_body)")
edit("8.16", "forgets the moments", "unrotate(q, cross(r, p)) / I_body", "unrotate(q, cross(r, p))")
edit("8.16", "does not rotate back into the world",
     "rotate(q, unrotate(q, cross(r, p)) / I_body)", "unrotate(q, cross(r, p)) / I_body")
edit("8.16", "moves the body and does not rotate it", "quaternion_update(q, turn, 1.0)", "q")
edit("8.16", "exchanges rotate and unrotate",
     "rotate(q, unrotate(q, cross(r, p)) / I_body)", "unrotate(q, rotate(q, cross(r, p)) / I_body)")
edit("8.16", "rotates by p in place of r × p", "cross(r, p)", "p")
edit("8.16", "does not rotate where the components of r × p add up to 0", "return x + p / m,",
     "if np.sum(cross(r, p)) == 0.0:\n        return x + p / m, q\n    return x + p / m,")
edit("8.16", "does not rotate where r × p has no last component", "return x + p / m,",
     "if cross(r, p)[2] == 0.0:\n        return x + p / m, q\n    return x + p / m,")
edit("8.16", "does not rotate a body in the orientation (1, 0, 0, 0)", "return x + p / m,",
     "if q[0] == 1.0:\n        turn = 0.0 * turn\n    return x + p / m,")
edit("8.16", "ignores rotations below 1 nrad", "quaternion_update(q, turn, 1.0)",
     "quaternion_update(q, turn * (turn @ turn > 1e-18), 1.0)")


# 8.17 -----------------------------------------------------------------------------------------------------------
@variants
def rate(order=False, scale=2.0, by_w=True, per_step=True, sign=1.0, back=True):
    def turning_rate(q_old, q_new, dt):
        turned_back = q_old * np.array([1.0, -1.0, -1.0, -1.0]) if back else q_old
        turn = worked.quaternion_product(turned_back, q_new) if order else worked.quaternion_product(q_new, turned_back)
        return sign * scale * turn[1:] / (turn[0] if by_w else 1.0) / (dt if per_step else 1.0)
    return turning_rate


right("8.17", "with a conjugate by signs")(rate())
wrong("8.17", "returns the rate in body coordinates")(rate(order=True))
wrong("8.17", "omits the factor 2")(rate(scale=1.0))
wrong("8.17", "does not divide by the scalar part, not even by its sign")(rate(by_w=False))
wrong("8.17", "does not divide by dt")(rate(per_step=False))
wrong("8.17", "returns the rate of the reversed rotation")(rate(sign=-1.0))
wrong("8.17", "multiplies the two quaternions without conjugating one")(rate(back=False))
edit("8.17", "fails without rotation", "return 2.0 / (turn[0] * dt) * turn[1:]",
     "size = np.sqrt(np.sum(turn[1:] ** 2))\n    return 2.0 * size / (turn[0] * dt) * (turn[1:] / size)")
edit("8.17", "ignores rotations below 1 µrad", "* turn[1:]", "* turn[1:] * (turn[1:] @ turn[1:] > 1e-12)")
edit("8.17", "limits the rotation to 120°",
     "2.0 / (turn[0] * dt)", "2.0 / (np.sign(turn[0]) * max(abs(turn[0]), 0.5) * dt)")


@right("8.17", "by the angle")
def turning_rate(q_old, q_new, dt):
    turn = worked.quaternion_product(q_new, q_old * np.array([1.0, -1.0, -1.0, -1.0]))
    turn = turn if turn[0] >= 0.0 else -turn
    s = size(turn[1:])
    return 2.0 * np.tan(np.arctan2(s, turn[0])) / dt * turn[1:] / s if s > 0.0 else np.zeros(3)


edit("8.17", "takes only the sign of the scalar part, and does not divide by its size", "2.0 / (turn[0] * dt)",
     "2.0 / (np.copysign(1.0, turn[0]) * dt)")
WITHOUT_SCALAR_PART = edit("8.17", "does not divide by the scalar part, not even by its sign",
                           "2.0 / (turn[0] * dt)", "2.0 / dt")
edit("8.17", "multiplies by dt", "2.0 / (turn[0] * dt)", "2.0 * dt / turn[0]")
edit("8.17", "takes half in place of twice", "2.0 / (turn[0]", "0.5 / (turn[0]")
edit("8.17", "returns no rate for a body that starts in the orientation (1, 0, 0, 0)", "return 2.0",
     "if q_old[0] == 1.0:\n        return np.zeros(3)\n    return 2.0")
edit("8.17", "returns no rate where the components of the axis add up to 0", "return 2.0",
     "if np.sum(turn[1:]) == 0.0:\n        return np.zeros(3)\n    return 2.0")
edit("8.17", "takes the difference of the quaternions",
     "turn = quaternion_product(q_new, q_back)", "turn = q_new - q_old; turn[0] = 1.0")
edit("8.17", "ignores rotations below 20 nrad", "* turn[1:]", "* turn[1:] * (turn[1:] @ turn[1:] > 1e-16)")


# 8.18 -----------------------------------------------------------------------------------------------------------
@variants
def enclosed(share=6.0, order=(0, 1, 2), slope_share=6.0, sign=1.0, only_first=False, slope=lambda own, face: own):
    def volume_gradient(x, faces):
        corners = x[faces[:, list(order)]]
        a, b, c = corners[:, 0], corners[:, 1], corners[:, 2]
        gradient = np.zeros_like(x)
        for k, (p, r) in enumerate(((b, c), (c, a), (a, b))):
            if k == 0 or not only_first:
                np.add.at(gradient, faces[:, order[k]], slope(np.cross(p, r), np.cross(b - a, c - a)) / slope_share)
        return sign * np.sum(a * np.cross(b, c)) / share, sign * gradient
    return volume_gradient


right("8.18", "all faces at once")(enclosed())
right("8.18", "from another corner")(enclosed(order=(1, 2, 0)))
right("8.18", "a third of the area vector of each face")(enclosed(slope=lambda own, face: face))
wrong("8.18", "returns volume and gradient with the opposite sign")(enclosed(order=(0, 2, 1)))
wrong("8.18", "divides the volume by 3 in place of 6")(enclosed(share=3.0))
wrong("8.18", "divides the gradient by 3 in place of 6")(enclosed(slope_share=3.0))
wrong("8.18", "computes the gradient of the first corner of each face only")(enclosed(only_first=True))
wrong("8.18", "gives each corner the whole area vector of its faces, not a third of it")(
    enclosed(slope=lambda own, face: 3.0 * face))
wrong("8.18", "gives each corner half of the area vector of its faces, not a third of it")(
    enclosed(slope=lambda own, face: 1.5 * face))
edit("8.18", "counts every tetrahedron positive", "V += dot(a, across)", "V += abs(dot(a, across))")
edit("8.18", "drops the sign of the volume", "return V, gradient", "return abs(V), gradient")
edit("8.18", "drops the sign of volume and gradient", "return V, gradient", "return abs(V), np.sign(V) * gradient")
edit("8.18", "keeps only the last face of each corner",
     "gradient[faces[f, 0]] += across", "gradient[faces[f, 0]] = across")
edit("8.18", "leaves out the corners of no face", "return V, gradient", "return V, gradient[np.unique(faces)]")
edit("8.18", "forgets the division by 6", "cross(b, c) / 6.0", "cross(b, c)")
EXCHANGED = edit("8.18", "exchanges the corners in one of the cross products", "cross(c, a) / 6.0", "cross(a, c) / 6.0")
edit("8.18", "uses the first hundred faces only", "range(faces.shape[0])", "range(min(faces.shape[0], 100))")
edit("8.18", "forgets the division by 6 at the third corner", "cross(a, b) / 6.0", "cross(a, b)")
edit("8.18", "gives two corners of a face the same gradient",
     "gradient[faces[f, 1]] += cross(c, a) / 6.0", "gradient[faces[f, 1]] += across")
edit("8.18", "uses the area of the face for its first corner",
     "across = cross(b, c) / 6.0", "across = cross(b - a, c - a) / 6.0")
edit("8.18", "skips faces of which the components of b × c add up to 0", "V += dot(a, across)",
     "if np.sum(across) == 0.0:\n            continue\n        V += dot(a, across)")
edit("8.18", "skips faces whose tetrahedron has no volume, although their corners change it",
     "V += dot(a, across)", "V += dot(a, across)\n        if dot(a, across) == 0.0:\n            continue")


# 8.19 --------------------------------------------------------------------------------------------------------------
@right("8.19", "by the recursion of the angle, to leading order")
def recursion(v, length, dt, t):
    angle = v * dt / length
    for _ in range(round(t / dt)):
        angle *= 1.0 - angle * angle
    return angle * length / dt


@right("8.19", "by the angle per step")
def circling_speed(v, length, dt, t):
    angle = v * dt / length
    return length / dt / np.sqrt(1.0 / angle**2 + 2.0 * t / dt)


edit("8.19", "says that the speed stays", "2.0 * omega * omega * dt * t", "0.0 * t")
edit("8.19", "takes half of the loss", "2.0 * omega * omega", "omega * omega")
edit("8.19", "takes twice the loss", "2.0 * omega * omega", "4.0 * omega * omega")
edit("8.19", "takes the loss of the energy as that of the speed",
     "np.sqrt(1.0 + 2.0 * omega * omega * dt * t)", "(1.0 + 2.0 * omega * omega * dt * t)")
edit("8.19", "takes the speed in place of the angular velocity", "v / length", "v")
edit("8.19", "counts a step as a second", "2.0 * omega * omega * dt * t", "2.0 * omega * omega * dt * dt * t")
edit("8.19", "says that the speed falls exponentially",
     "v / np.sqrt(1.0 + 2.0 * omega * omega * dt * t)", "v * np.exp(-omega * omega * dt * t)")
edit("8.19", "says that the speed falls exponentially",
     "v / np.sqrt(1.0 + 2.0 * omega * omega * dt * t)", "v * np.exp(-0.5 * omega * omega * dt * t)")
edit("8.19", "multiplies the speed in every step by the cosine of the first angle",
     "v / np.sqrt(1.0 + 2.0 * omega * omega * dt * t)", "v * np.cos(omega * dt) ** (t / dt)")
edit("8.19", "counts one step too many", "dt * t)", "dt * (t + dt))")
edit("8.19", "counts one step too few", "dt * t)", "dt * max(0.0, t - dt))")
edit("8.19", "counts half a step too many", "dt * t)", "dt * (t + 0.5 * dt))")
edit("8.19", "says that the speed grows", "1.0 + 2.0", "1.0 - 2.0")


# 8.20 --------------------------------------------------------------------------------------------------------------
@right("8.20", "as a small letter")
def substeps_are():
    return "a"


edit("8.20", "chooses a softness that no work changes: that is the compliance of a material",
     '"A"', '"B"')
edit("8.20", "chooses the single link, of whose error each sweep leaves a fixed share",
     '"A"', '"C"')
edit("8.20", "chooses n sweeps of one step: a substep does more than a sweep",
     '"A"', '"D"')


# 8.21 --------------------------------------------------------------------------------------------------------------
def with_points(x, fixed, i, j, sweeps=8, frames=90):
    """A thing of rigid links between points of 1 kg."""
    inv_mass = np.ones(len(x))
    inv_mass[fixed] = 0.0
    i, j = np.array(i), np.array(j)
    rest = np.linalg.norm(x[i] - x[j], axis=1)
    return x, worked.ConstraintNetwork(inv_mass, np.array([0.0, -9.81]), i, j, rest, np.ones(len(i)),
                                       np.zeros(len(i)), sweeps), frames


@right("8.21", "a pendulum of six beads")
def my_thing():
    x = np.stack((0.3 * np.arange(7.0), np.zeros(7)), axis=1)
    return with_points(x, [0], range(6), range(1, 7))


@right("8.21", "a ladder that swings from one corner")
def ladder():
    x = np.array([(0.5 * (k // 2), -0.5 * (k % 2)) for k in range(8)])
    pairs = [(k, k + 2) for k in range(6)] + [(k, k + 1) for k in (0, 2, 4, 6)] + [(k, k + 3) for k in (0, 2, 4)]
    return with_points(x, [0], *np.transpose(pairs))


@right("8.21", "in lists")
def listed():
    x, network, frames = my_thing()
    *arrays, sweeps = network
    return x.tolist(), worked.ConstraintNetwork(*(y.tolist() for y in arrays), sweeps), frames


@right("8.21", "a ladder in space")
def space():
    x, network, frames = ladder()
    return np.insert(x, 1, 0.0, axis=1), network._replace(gravity=np.array([0.0, 0.0, -9.81])), frames


edit("8.21", "hangs nothing free: all points are nails", "np.full(n, 1.0)", "np.full(n, 0.0)")
edit("8.21", "takes soft links only", "np.zeros(n - 1)", "np.full(n - 1, 0.01)")
edit("8.21", "does not move, because nothing pulls", "-9.81", "0.0")
edit("8.21", "begins with links that are too long",
     "i, i + 1, np.ones(n - 1), np", "i, i + 1, np.full(n - 1, 0.8), np")
edit("8.21", "is too heavy for one sweep",
     "inv_mass[0], inv_mass[n - 1], inv_mass[2] = 0.0, 0.0, 0.5",
     "inv_mass[0], inv_mass[n - 1], inv_mass[2] = 0.0, 0.0, 0.001")
edit("8.21", "falls apart into two pieces", "i, i + 1, np.ones", "i, i + 1 - (i == 4) * 3, np.ones")
edit("8.21", "ends before it has moved", "x, network, 90", "x, network, 3")
