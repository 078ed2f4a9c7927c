"""The given vectors do what NumPy does, plain and compiled; what has no inverse is refused."""

import numpy as np

from solutions.checks import BadInput
from validate.grading.expect import close, raises


def test_products_are_those_of_numpy(lesson, draw):
    a, b = draw(-2.0, 2.0, (2, 3))
    close("a · b", lesson.dot(a, b), a @ b, 1e-14)
    close("a × b", lesson.cross(a, b), np.cross(a, b), 1e-14)
    close("|a|", lesson.norm(a), np.linalg.norm(a), 1e-14)


def test_a_symmetric_matrix_times_its_inverse_is_one(lesson, draw):
    A = draw(-1.0, 1.0, (3, 3))
    A = A @ A.T + np.eye(3)                              # eigenvalues from 1 to 10: its inverse costs a digit
    close("A⁻¹ A", lesson.inverse(A) @ A, np.eye(3), 1e-13)
    raises("a matrix of rank 2", BadInput, lesson.inverse, np.diag([1.0, 0.0, 2.0]))


def test_the_ends_of_a_link_move_along_it_by_their_own_shares(lesson, draw):
    x, y = draw(-1.0, 1.0, (2, 3, 2))
    r, u = x[2] - x[0], y[2] - y[0]
    close("(x_i − x_j) · (y_i − y_j)", lesson.product_between(x, y, 2, 0), r @ u, 1e-14)
    close("|x_i − x_j|", lesson.distance_between(x, 2, 0), np.linalg.norm(r), 1e-14)
    move_apart = getattr(lesson.move_apart, "unwatched", lesson.move_apart)          # it works in place
    for moved in (y, x):                                                             # x itself at the end
        expected = moved + np.array([-0.5, 0.0, 0.25])[:, None] * r
        move_apart(moved, 2, 0, 0.25, 0.5, x)
        close("the points", moved, expected, 1e-14)
