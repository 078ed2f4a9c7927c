"""A Model in our own loop, plain or compiled, which is composed of what the Model needs."""

from solutions.support.model import WORLD
from validate.subject import modules

from . import Push, World

PLACES = 6                   # of parts in a compiled loop; `leave` stands where there are fewer


def lesson_of(subject, compiled=False):
    """Return the lesson with the loop, with the exercises of a subject."""
    return modules.module_set(subject, compiled).lessons.simulator


def refuses(model):
    """Return why our loop cannot run a Model; an empty text where it can."""
    return lesson_of("solutions").refuses(model)


def build(model, dt, of="solutions", compiled=False, **settings):
    """Return the World of a Model in our loop; settings are those of Settings in solutions/given/compose.py.

    of: the subject whose exercises the loop calls, such as "lessons".  A load that is a Python function is not
    compiled, and a loop with one runs in plain Python.
    """
    lesson = lesson_of(of)
    loop = lesson.compose(model, lesson.Settings(**settings))
    fast = compiled and not any(callable(load) for load in model.loads)
    advance = compiled_advance(loop, lesson_of(of, True)) if fast else plain_advance(loop)
    history, clock = [loop.state, loop.state], [0]                     # before and after the last step

    def step():
        history[:] = history[1], advance(clock[0] * dt, history[1], dt)
        clock[0] += 1

    return World(step, lambda: lesson.state_of(loop, history[1]),
                 lambda: pushes(lesson, loop, clock[0], *history, dt) if clock[0] else [])


def plain_advance(loop):
    """Return the function (t, state, dt) → state of one step."""
    def advance(t, state, dt):
        for part in loop.parts:
            state = part.step(loop.load, loop.bounds, loop.narrow, t, state, dt, loop.p)
        return state
    return advance


def compiled_advance(loop, lesson):
    """Return the same with the compiled twins of the parts, which a compiled lesson has by name."""
    parts = [part.step.__name__ for part in loop.parts] + ["leave"] * (PLACES - len(loop.parts))
    names = [*parts, *(function.__name__ for function in (loop.load, loop.bounds, loop.narrow))]
    functions = [getattr(lesson, name) for name in names]
    return lambda t, state, dt: lesson.advance_parts(*functions, t, state, dt, 1, loop.p)


def pushes(lesson, loop, steps, before, after, dt):
    """Return the pushes of the last step: of its contacts, and of its joints."""
    body = {row: k for k, row in enumerate(loop.row)}
    found = [Push(body[a], body[b], J / dt) for a, b, J in zip(after.contacts.a, after.contacts.b, after.J)]
    joints = loop.p.joints
    if joints.a.size:
        of_joints = lesson.joint_impulses_2d if after.x.shape[1] == 2 else lesson.joint_impulses
        J = of_joints(loop.load, (steps - 1) * dt, before, after, dt, loop.p)
        rows = zip(joints.a, joints.b, J, loop.joint_of)
        found += [Push(body[a], body.get(b, WORLD), impulse / dt, joint) for a, b, impulse, joint in rows]
    return found
