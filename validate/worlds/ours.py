"""A Model in our own loop, plain or compiled, which is composed of what the Model needs."""

from solutions.given.compose import Settings, compose, leave, refuses, state_of
from solutions.given.simulator import joint_impulses_2d
from solutions.support.model import WORLD
from validate.subject import modules

from . import Push, World

__all__ = ["build", "refuses"]

COMPILED_NAMES = 6           # parts of a loop that is compiled; `leave` stands where there are fewer


def build(model, dt, of="solutions", compiled=False, **settings):
    """Return the World of a Model in our loop; settings are those of compose.Settings.

    of: the subject whose exercises the loop calls, such as "lessons".
    """
    loop = compose(model, Settings(**settings))
    advance = advancing(loop, of, compiled and not model_has_own_loads(model))
    history = [loop.state, loop.state]                                 # before and after the last step
    clock = [0]

    def step():
        history[:] = history[1], advance(clock[0] * dt, history[1], dt)
        clock[0] += 1

    return World(step, lambda: state_of(loop, history[1]), lambda: pushes(loop, clock[0], *history, dt))


def model_has_own_loads(model):
    """Return whether a load of a Model is a Python function, which is not compiled."""
    return any(callable(load) for load in model.loads)


def advancing(loop, of, compiled):
    """Return the function (t, state, dt) → state of one step, with the exercises of a subject."""
    lesson = modules.module_set(of, compiled).lesson_of_scenes("simulator") if compiled or of != "solutions" else None

    def meant(function):
        return getattr(lesson, function.__name__, function) if lesson else function

    steps = [meant(part.step) for part in loop.parts]
    functions = meant(loop.load), meant(loop.bounds), meant(loop.narrow)
    if compiled:
        steps += [meant(leave)] * (COMPILED_NAMES - len(steps))
        return lambda t, state, dt: lesson.advance_parts(*steps, *functions, t, state, dt, 1, loop.p)

    def advance(t, state, dt):
        for part in steps:
            state = part(*functions, t, state, dt, loop.p)
        return state
    return advance


def pushes(loop, steps, before, after, dt):
    """Return the pushes of the last step: of its contacts, and of its joints."""
    if steps == 0:
        return []
    body = {row: k for k, row in enumerate(loop.row)}
    found = [Push(body[a], body[b], J / dt) for a, b, J in zip(after.contacts.a, after.contacts.b, after.J)]
    joints = loop.p.joints
    if joints.a.size:
        J = joint_impulses_2d(loop.load, (steps - 1) * dt, before, after, dt, loop.p)
        rows = zip(joints.a, joints.b, J, loop.joint_of)
        found += [Push(body[a], body.get(b, WORLD), impulse / dt, joint) for a, b, impulse, joint in rows]
    return found
