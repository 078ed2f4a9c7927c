"""Every step of lesson 5 in an independent form, and the engines' steps for a rotating body, to predict their errors.

An orientation is a pair of complex numbers (Cayley and Klein): (α, β) with |α|² + |β|² = 1 is the quaternion
w = Re α, z = −Im α, y = −Re β, x = −Im β.  A step is step(torque, R, L, I, h) → (R, L); L and the torque [N m] are
tuples in world coordinates.  The numbers are plain floats, because arrays of three take ten times as long.
"""

from collections.abc import Callable
from functools import cache
from itertools import accumulate, chain, pairwise
from math import cos, sin, sqrt, tan
from typing import NamedTuple

import numpy as np

from ..scene import ROUND_OFF
from .orientation import quaternion
from .schemes import ErrorLaw

GAMMA = 1.0 / (4.0 - 4.0 ** (1.0 / 3.0))                # Suzuki 1990
EVEN = {2: (2, 4, 6), 4: (4, 6, 8)}  # powers of the step in the error of a symmetric step, by its order
FINEST = {1: 1000, 2: 800, 4: 400}
DOUBLINGS = {1: 4, 2: 3, 4: 3}
NEWTON = 12                  # largest number of iterations; from a close guess each doubles the number of digits
AXES = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))


def plus(a, b, factor=1.0):
    return a[0] + factor * b[0], a[1] + factor * b[1], a[2] + factor * b[2]


def cross(a, b):
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


def over(a, I):
    return a[0] / I[0], a[1] / I[1], a[2] / I[2]


def times(a, I):
    return a[0] * I[0], a[1] * I[1], a[2] * I[2]


def length(a):
    return sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2])


def product(p, q):
    """Return the pair of the rotation q followed by p."""
    return p[0] * q[0] - p[1] * q[1].conjugate(), p[0] * q[1] + p[1] * q[0].conjugate()


def unit(q):
    size = sqrt(abs(q[0]) ** 2 + abs(q[1]) ** 2)
    return q[0] / size, q[1] / size


def turn(omega, scale, real):
    """Return the pair with the real part `real` and the vector part  scale ω."""
    return complex(real, -scale * omega[2]), complex(-scale * omega[1], -scale * omega[0])


def rotation(phi):
    """Return the pair of a rotation by the vector φ."""
    angle = length(phi)
    return turn(phi, sin(0.5 * angle) / angle if angle else 0.5, cos(0.5 * angle))


def tangent(omega, h):
    """Return the pair of a rotation about ω by the angle 2 arctan(½|ω|h)."""
    return unit(turn(omega, 0.5 * h, 1.0))


def matrix(q, s=2.0):
    """Return R (3, 3) of a pair as three rows; s = 2 for a pair of length 1, else 2 over the square of its length."""
    w, z, y, x = q[0].real, -q[0].imag, -q[1].real, -q[1].imag
    w = s * w
    return ((1.0 - s * (y * y + z * z), s * x * y - w * z, s * x * z + w * y),
            (s * x * y + w * z, 1.0 - s * (x * x + z * z), s * y * z - w * x),
            (s * x * z - w * y, s * y * z + w * x, 1.0 - s * (x * x + y * y)))


def dot(a, b):
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def to_world(M, r):
    return dot(M[0], r), dot(M[1], r), dot(M[2], r)


def to_body(M, r):
    return to_world(tuple(zip(*M)), r)


# ---------------------------------------------------------------------------------------------- first order

def kept_L(update):
    """Update L first, then R by `update` at ω = I⁻¹L."""
    def step(torque, q, L, I, h):
        M = matrix(q)
        L = plus(L, torque(M), h)
        return update(q, to_world(M, over(to_body(M, L), I)), h), L
    return step


def by_columns(q, omega, h):
    """Return (1 + h ω*) R with its columns made orthonormal from the first to the last."""
    moves = zip(*(cross(omega, column) for column in zip(*matrix(q))))
    a, b, c = zip(*(plus(row, move, h) for row, move in zip(matrix(q), moves)))
    a = tuple(x / length(a) for x in a)
    b = plus(b, a, -dot(a, b))
    b = tuple(x / length(b) for x in b)
    c = cross(a, b)
    w, x, y, z = quaternion(np.array((a, b, c)).T)
    return complex(w, -z), complex(-y, -x)


def exactly(q, omega, h):
    return product(rotation(tuple(h * x for x in omega)), q)


def nearly(q, omega, h):
    return product(tangent(omega, h), q)


def kept_omega(implicit, update):
    """Update ω first, by Euler's equations in body coordinates; rotate R by the new ω; compute L from both."""
    def step(torque, q, L, I, h):
        M = matrix(q)
        l = to_body(M, L)
        w = over(l, I)
        push = plus(to_body(M, torque(M)), cross(l, w))
        if implicit:                                    # one correction of Newton's method
            columns = [plus(times(AXES[k], I), cross(plus(times(w, (I[k],) * 3), l, -1.0), AXES[k]), h)
                       for k in range(3)]
            change = solve(columns, tuple(h * x for x in push))
        else:
            change = tuple(h * x for x in over(push, I))
        omega = to_world(M, plus(w, change))
        q = update(q, omega, h)
        M = matrix(q)
        return q, to_world(M, times(to_body(M, omega), I))
    return step


def solve(columns, right):
    """Solve a (3, 3) system by Cramer's rule."""
    a, b, c = columns
    whole = dot(a, cross(b, c))
    return dot(right, cross(b, c)) / whole, dot(a, cross(right, c)) / whole, dot(a, cross(b, right)) / whole


# ---------------------------------------------------------------------------------------------- higher order

def classical(torque, q, L, I, h):
    """Take a step of Runge–Kutta 4 on the pair and L.

    Between the stages the length of the pair differs slightly from 1, but R is a rotation.
    """
    def slope(q, L):
        M = matrix(q, 2.0 / (abs(q[0]) ** 2 + abs(q[1]) ** 2))
        omega = to_world(M, over(to_body(M, L), I))
        return product(turn(omega, 0.5, 0.0), q), torque(M)

    def ahead(rate, tau, share):
        return (q[0] + share * h * rate[0], q[1] + share * h * rate[1]), plus(L, tau, share * h)

    k1 = slope(q, L)
    k2 = slope(*ahead(*k1, 0.5))
    k3 = slope(*ahead(*k2, 0.5))
    k4 = slope(*ahead(*k3, 1.0))
    mean = [(k1[0][n] + 2.0 * k2[0][n] + 2.0 * k3[0][n] + k4[0][n]) / 6.0 for n in range(2)]
    tau = tuple((a + 2.0 * b + 2.0 * c + d) / 6.0 for a, b, c, d in zip(k1[1], k2[1], k3[1], k4[1]))
    return unit((q[0] + h * mean[0], q[1] + h * mean[1])), plus(L, tau, h)


def munthe_kaas(torque, q, L, I, h):
    """Take a step of Runge–Kutta 4 on ω and on the rotation vector u since the start of the step, in body coordinates.

    The orientation is R exp(u*), and  u̇ = ω + ½ u × ω + c u × (u × ω),  c = (1 − ½|u| cot ½|u|)/|u|².  Without these
    terms the method would be of order 2.
    *Source:* Munthe-Kaas 1998; Hairer, Lubich, Wanner 2006, IV.8.
    """
    def slope(u, w):
        M, across, angle = matrix(product(q, rotation(u))), cross(u, w), length(u)
        c = (1.0 - 0.5 * angle / tan(0.5 * angle)) / angle**2 if angle else 0.0
        return (plus(plus(w, across, 0.5), cross(u, across), c),
                over(plus(to_body(M, torque(M)), cross(times(w, I), w)), I))

    w, still = over(to_body(matrix(q), L), I), (0.0, 0.0, 0.0)
    slopes = [slope(still, w)]
    for share in (0.5, 0.5, 1.0):
        turned, changed = slopes[-1]
        slopes.append(slope(plus(still, turned, share * h), plus(w, changed, share * h)))
    turned, changed = (tuple((a + 2.0 * b + 2.0 * c + d) / 6.0 for a, b, c, d in zip(*each)) for each in zip(*slopes))
    q = unit(product(q, rotation(plus(still, turned, h))))
    return q, to_world(matrix(q), times(plus(w, changed, h), I))


def free_midpoint(q, L, I, h):
    """Solve m = ℓ + ½h m × I⁻¹m by iteration of its linear part, then apply Cayley's rotation about m in the body."""
    l = to_body(matrix(q), L)
    m = l
    for _ in range(NEWTON):
        w = over(m, I)
        r = plus(plus(m, l, -1.0), cross(m, w), -0.5 * h)
        columns = [plus(AXES[k], cross(plus(w, m, -1.0 / I[k]), AXES[k]), 0.5 * h) for k in range(3)]
        change = solve(columns, r)
        m = plus(m, change, -1.0)
        if length(change) <= ROUND_OFF * length(m):
            break
    return unit(product(q, turn(over(m, I), 0.5 * h, 1.0)))


def free_splitting(q, L, I, h):
    """Rotate half about axis a of the body, fully about c, half about a, and then apply the common rotation about L."""
    middle = sorted(range(3), key=lambda k: I[k])[1] if len(set(I)) == 3 else next(
        k for k in range(3) if (I[(k + 1) % 3] - I[k]) * (I[k] - I[(k + 2) % 3]) >= 0.0)
    a, c = (middle + 1) % 3, (middle + 2) % 3

    def about(q, axis, share):
        part = dot(tuple(zip(*matrix(q)))[axis], L)
        angle = share * h * (1.0 / I[axis] - 1.0 / I[middle]) * part
        return product(q, rotation(tuple(angle * (n == axis) for n in range(3))))
    q = about(about(about(q, a, 0.5), c, 1.0), a, 0.5)
    return unit(product(rotation(tuple(h / I[middle] * x for x in L)), q))


def kicked(free):
    """Apply half of the angular impulse, the free motion, and the other half."""
    def step(torque, q, L, I, h):
        L = plus(L, torque(matrix(q)), 0.5 * h)
        q = free(q, L, I, h)
        return q, plus(L, torque(matrix(q)), 0.5 * h)
    return step


FIVE = GAMMA, GAMMA, 1.0 - 4.0 * GAMMA, GAMMA, GAMMA     # shares of Suzuki's substeps
ENDS = 0.0, 1.0                                          # times of the torques of one step
ENDS_OF_FIVE = tuple(chain.from_iterable(pairwise(accumulate(FIVE, initial=0.0))))


def composed(step):
    def five(torque, q, L, I, h):
        for share in FIVE:
            q, L = step(torque, q, L, I, share * h)
        return q, L
    return five


# ---------------------------------------------------------------------------------------------- all of them

class Turn(NamedTuple):
    """One of these steps."""
    order: int
    step: Callable
    powers: tuple | None = None          # the first three powers of h in its error; without them order, order + 1, …
    torques: tuple = (0.0,)              # the times in a step at which it takes the torque [h]


MATRIX = Turn(1, kept_L(by_columns))
AXIS_ANGLE = Turn(1, kept_L(exactly))
QUATERNION = Turn(1, kept_L(nearly))
GYROSCOPIC = Turn(1, kept_omega(False, nearly))
IMPLICIT_GYROSCOPIC = Turn(1, kept_omega(True, nearly))
RUNGE_KUTTA = Turn(4, classical, torques=(0.0, 0.5, 0.5, 1.0))
MIDPOINT_TURN = Turn(2, kicked(free_midpoint), EVEN[2], ENDS)
SPLITTING = Turn(2, kicked(free_splitting), EVEN[2], ENDS)
COMPOSED_SPLITTING = Turn(4, composed(SPLITTING.step), EVEN[4], ENDS_OF_FIVE)
COMPOSED_MIDPOINT = Turn(4, composed(MIDPOINT_TURN.step), EVEN[4], ENDS_OF_FIVE)
# the engines: the explicit or the implicit gyroscopic term, then the exact rotation by the new ω; Runge–Kutta 4
EXPLICIT_TERM = Turn(1, kept_omega(False, exactly))
IMPLICIT_TERM = Turn(1, kept_omega(True, exactly))
MUNTHE_KAAS = Turn(4, munthe_kaas)


def no_torque(M):
    return 0.0, 0.0, 0.0


class TurningBody(NamedTuple):
    """A scene's description of its single rotating body."""
    T: float                 # the output time [s]
    moments: Callable        # p → I
    begin: Callable          # p → (pair, L) at the start
    torque: Callable         # p → (rows of R → torque)
    seen: Callable           # rows of R → what the scene observes
    truth: Callable          # (p, t) → the same
    floor: Callable          # (p, dt) → round-off, relative
    doublings: dict = DOUBLINGS          # {order: as in ErrorLaw}

    def predict(self, turn):
        """Return the field `predicted` of a Runner that follows a Turn."""
        @cache
        def error_law(p):
            I = tuple(map(float, self.moments(p)))

            def run(steps, nudge):
                (q, L), moment = self.begin(p), self.torque(p)
                L = tuple(one + nudge * share for one, share in zip(L, (0.5, -0.3, 0.8)))
                for _ in range(steps):
                    q, L = turn.step(moment, q, L, I, self.T / steps)
                return self.seen(matrix(q))
            return ErrorLaw(run, np.array(self.truth(p, self.T), dtype=float), turn.powers or turn.order, self.T,
                            FINEST[turn.order], self.doublings[turn.order])

        def predicted_error(p, dt):
            """The error, with its sign, of the same step written independently in complex numbers.

            It is taken at the same step where that is coarse, else by its expansion in powers of dt.  pybullet
            turns its bodies by the gyroscopic term, explicit in reduced coordinates and implicit in maximal ones.
            MuJoCo uses Runge–Kutta 4 in the form of Munthe-Kaas; its default step is like that of pybullet in
            reduced coordinates.
            """
            return error_law(p).prediction(dt, self.floor(p, dt))
        return predicted_error


def free_turning(T, truth, uncertainty):
    """Return the TurningBody of a free body that starts at R = 1, with p.moments() and p.omega().

    The floor is round-off, u = 1.1e-16.  A step rounds the orientation by about u in each direction.  An error
    about L or about the axis of symmetry stays constant.  An error that tilts the axis by δ at time t also changes
    the rate of spin, which is (1/I₃ − 1/I₁) L₃.  At the end the spin is off by  δ S (1 − t/T),  S = |1/I₃ − 1/I₁|
    |L| T.  For the axisymmetric body S = 54.

    If the δ are independent, with standard deviation σ, the error after n steps is S σ √(n/3); a mean of μ adds ½ S
    μ n. A count of 100,000 steps of the splitting against the same steps in 80 bits gave σ = 0.74 u and μ = 0.0045
    ± 0.0024 u. The random walk predicts 8e-13, and the measured errors, each with its weight, give 4.2e-12.  That
    is five standard deviations of a random walk, so their mean is not 0, and it drifts slowly.  (The error at the
    end is 3.5e-12.)  So √n dominates below some 30,000 steps and n above; from there to a million steps the error
    is 0.17 to 0.31 u n (0.08 to 0.6 u n for four bodies).  The limit of 2 u n corresponds to a mean tilt of 4/S u =
    0.07 u, a tenth of σ.
    """
    def begin(p):
        return (1.0 + 0j, 0j), tuple(map(float, p.moments() * p.omega()))
    # round-off as derived above, 1e-12 of Newton's method, and the uncertainty of the truth
    floor = lambda p, dt: 1e-12 + T / dt * ROUND_OFF + 10.0 * uncertainty
    return TurningBody(T, lambda p: p.moments(), begin, lambda p: no_torque, np.ravel, truth, floor,
                       {**DOUBLINGS, 1: 0})
