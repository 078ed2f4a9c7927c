"""Published benchmarks: what their scenes share."""

from validate.reference.exams import HIGH, iftomm_class, iftomm_error
from validate.scene import Exam

IFTOMM = "https://www.iftomm-multibody.org/benchmark/"


def iftomm(problem, statement, duration, outputs, steps, gives_up, **more):
    """Return the Exam of a problem of IFToMM's library, with the error and the classes that all of them share."""
    return Exam("IFToMM library of computational benchmark problems", problem, statement, IFTOMM, duration, outputs,
                steps, iftomm_error, "root mean square of relative errors", iftomm_class, HIGH, gives_up, **more)
