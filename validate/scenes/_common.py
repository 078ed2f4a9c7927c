"""Shared parts of all scenes: fields, checks of parameters, and common observations and drawings."""

from typing import Any

from solutions.checks import check_positive
from validate.engines.switches import worlds_made
from validate.scene import EXACT, EngineRun, by_order, check_known

# fields of a scene in which nothing moves and nothing can be refined
ANSWER: dict[str, Any] = {"moves": False, "duration": 1.0, "steps": (1,), "refinement": ""}


def check_positives(p, *names):
    """Raise BadInput unless these parameters of a case are positive."""
    for name in names:
        check_positive(name, getattr(p, name))


def cases_with(parameter, names, cases):
    """Return the field `supports` of a Runner that can do the cases in which a parameter is one of these names.

    Raises BadInput for a name that the parameter has in no case.
    """
    check_known(f"parameter {parameter!r} of a runner", names, {getattr(p, parameter): p for p in cases.values()})
    return lambda p: getattr(p, parameter) in names


def measured(*parts):
    """Return the field `ablations`: each part that a scene omits and the whole loop of lesson 10 includes."""
    return dict.fromkeys(parts, "the whole loop of lesson 10 has it, and a full run measures it")


# ---------------------------------------------------------------------------------------------- observed quantities

def coordinates(d):
    """Return observe(state, p) of a point: the first d coordinates of its position."""
    return lambda state, p: state[0][:d]


def sole_array(state, p):
    """Return the array that is the whole state."""
    return state[0]


def constantly(value):
    """Return the function of p that is the same in every case."""
    return lambda p: value


ONE_LINK = constantly([(0, 1)])          # of a picture of two points


def built(product, model, read, watch=None, accelerations=None, **settings):
    """Return make(p, dt) of an engine's runner: the world of model(p) in that engine; read(State, p) observes it.

    watch(the engine's own world, p, dt) → what reports its steps, of validate/engines/watched.py
    accelerations(p) → (a, α) of all bodies at the start, for a leapfrog start; `ahead` takes those of the loads
    """
    def make(p, dt):
        begins = {"ahead": 0.5, "accelerations": accelerations(p)} if accelerations else {}
        with worlds_made() as made:
            world = product.world.build(model(p), dt, **settings, **begins)
        run = EngineRun(world.step, lambda: read(world.state(), p), world.close)
        if watch is None:
            return run
        watching = watch(*made, p, dt)
        # with the loads of the Model
        watching.step, watching.state, watching.data = world.step, world.state, world.data
        return run._replace(watched_step=watching.watched)
    return make


def one_reading(read, close=lambda: None, watched=None):
    """Return the EngineRun of a computation without steps: one long reading."""
    return EngineRun(lambda: None, read, close, watched)


# ---------------------------------------------------------------------------------------------- limits

def floor_of(limits, more=0.0):
    """Return (p, dt) → the limit by order of a run that has only round-off and this uncertainty of the truth."""
    return lambda p, dt: limits(p, dt)[EXACT] + more


FEW = "what few iterations leave is not modelled; the limit has a thousandth more for it"


def after_few_iterations(limits):
    """Return the limits of an engine whose iterations leave less than a thousandth of its error."""
    def more(p, dt):
        found = limits(p, dt)
        return {k: 1.001 * most for k, most in found.items()} if isinstance(found, dict) else 1.001 * found
    return more


def round_off(T):
    """Return (p, dt) → the relative error of a run over the time T that has only round-off."""
    return lambda p, dt: by_order(0.0, T, dt)[EXACT]
