"""Lesson 1 without an integrator: steps that do not move, or that find out by which test they are asked."""

import inspect

from validate.grading import example

from ..lessons import test_integrators

WORKED = example.worked("integrators")
STEPS = tuple(test_integrators.METHODS)

LOOP = WORKED + f"""
import sys
main, right = sys.modules["__main__"], {{name: globals()[name] for name in {STEPS}}}
def stay(acceleration, t, x, v, dt, p):
    return x.copy(), v.copy()
def advance(step, acceleration, t, x, v, dt, steps, p):
    name = getattr(main, "names", {{}}).get(step, "").rpartition(":")[2] or step.__name__
    for n in range(steps):
        x, v = right[name](acceleration, t + n * dt, x, v, dt, p)
    return x, v
class Mine:
    def __getattr__(self, name):
        return globals()[name]
main.given = lambda: Mine()
for module in [m for m in sys.modules.values() if hasattr(m, "advance")]:
    module.advance = advance
globals().update(dict.fromkeys(right, stay))
"""
TESTS = WORKED + inspect.getsource(test_integrators.expected_matrix) + inspect.getsource(test_integrators.verlet_matrix)
TESTS += f"""
methods = {test_integrators.METHODS}
def make(name):
    order, shares = methods[name][3:]
    def step(acceleration, t, x, v, dt, p):
        if hasattr(p, "omega"):
            moved = expected_matrix(name, p.omega, p.zeta, dt) @ np.array([x, v])
            return moved[0], moved[1]
        if not np.any(x) and not np.any(v):
            return x.copy(), v + dt * p.strength * sum(w * np.cos(t + c * dt) for c, w in shares.items())
        from scipy.integrate import solve_ivp
        n, f = len(x), lambda s, y: np.concatenate([y[len(x):], acceleration(s, y[:len(x)], y[len(x):], p)])
        y = solve_ivp(f, (t, t + dt), np.concatenate([x, v]), method="DOP853", rtol=1e-13, atol=1e-14).y[:, -1]
        y += 0.5 * dt ** (order + 1)
        return y[:n], y[n:]
    return step
for name in methods:
    globals()[name] = make(name)
"""
PRETENDED = {"another loop over steps in place of the given one": LOOP, "a step that recognises the tests": TESTS}
