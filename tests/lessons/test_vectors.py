"""The given vectors do what NumPy does, plain and compiled; what has no inverse is refused."""

import numpy as np

from solutions.checks import BadInput

from ..grading.expect import close, raises


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
