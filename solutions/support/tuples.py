"""Three coordinates as a tuple of numbers: compiled code keeps them in registers,
where an array of three would cost an allocation.
"""


def row(A, k):
    """Row k of an array (m, 3)."""
    return A[k, 0], A[k, 1], A[k, 2]


def axis(R, i, k):
    """Axis k of body i, given rotation matrices R (n, 3, 3): column k of R[i]."""
    return R[i, 0, k], R[i, 1, k], R[i, 2, k]


def axes(q, i):
    """The three axes of body i in the world, given unit quaternions q (n, 4)."""
    w, a, b, c = q[i, 0], q[i, 1], q[i, 2], q[i, 3]
    return ((1.0 - 2.0 * (b * b + c * c), 2.0 * (a * b + w * c), 2.0 * (a * c - w * b)),
            (2.0 * (a * b - w * c), 1.0 - 2.0 * (a * a + c * c), 2.0 * (b * c + w * a)),
            (2.0 * (a * c + w * b), 2.0 * (b * c - w * a), 1.0 - 2.0 * (a * a + b * b)))


def scaled(s, a):
    """s a"""
    return s * a[0], s * a[1], s * a[2]


def minus(a, b):
    """a − b"""
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]


def plus(a, s, b):
    """a + s b"""
    return a[0] + s * b[0], a[1] + s * b[1], a[2] + s * b[2]


def across(a, b):
    """a × b"""
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


def times(A, i, b):
    """A[i] b of matrices A (n, 3, 3)."""
    return (A[i, 0, 0] * b[0] + A[i, 0, 1] * b[1] + A[i, 0, 2] * b[2],
            A[i, 1, 0] * b[0] + A[i, 1, 1] * b[1] + A[i, 1, 2] * b[2],
            A[i, 2, 0] * b[0] + A[i, 2, 1] * b[1] + A[i, 2, 2] * b[2])


def put(A, k, a):
    """Write a into row k of A (m, 3), in place."""
    A[k, 0], A[k, 1], A[k, 2] = a
