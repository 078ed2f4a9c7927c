"""Published benchmarks: engines that are built from a Model, and what scenes of benchmarks share."""

from validate.reference.exams import HIGH, iftomm_class, iftomm_error
from validate.scene import EngineRun, Exam

IFTOMM = "https://www.iftomm-multibody.org/benchmark/"


def built(product, model, read, **settings):
    """Return make(p, dt) of an engine's runner: the world of model(p) in that engine; read(State, p) observes it."""
    def make(p, dt):
        world = product.world.build(model(p), dt, **settings)
        return EngineRun(world.step, lambda: read(world.state(), p), world.close)
    return make


def iftomm(problem, statement, duration, outputs, steps, gives_up, **more):
    """Return the Exam of a problem of IFToMM's library, with the error and the classes that all of them share."""
    return Exam("IFToMM library of computational benchmark problems", problem, statement, IFTOMM, duration, outputs,
                steps, iftomm_error, "root mean square of relative errors", iftomm_class, HIGH, gives_up, **more)
