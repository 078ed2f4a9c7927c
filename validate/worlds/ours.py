"""A Model in our own loop, plain or compiled, which is composed of what the Model needs."""

from functools import partial

from solutions.checks import positive_number
from solutions.support.model import WORLD
from validate.subject import modules

from . import Push, World


def lesson_of(subject, compiled=False):
    """Return the lesson with the loop, with the exercises of a subject."""
    return modules.module_set(subject, compiled).lessons.simulator


def refuses(model):
    """Return "": our loop runs every Model."""
    return ""


def build(model, dt, of="solutions", compiled=False, **settings):
    """Return the World of a Model in our loop; settings are those of Settings in solutions/given/compose.py.

    of: the subject whose exercises the loop calls, such as "lessons".  A load that is a Python function is not
    compiled, and a loop with one runs in plain Python.
    """
    dt = positive_number("step dt [s]", dt)
    lesson = lesson_of(of)
    loop = lesson.compose(model, lesson.Settings(**settings))
    lesson.check_explicit_forces(loop, dt)
    fast = compiled and not any(callable(load) for load in model.loads)
    advance = compiled_advance(loop, of) if fast else partial(lesson.run_parts, loop)
    history, clock = [loop.state, loop.state], [0]                     # before and after the last step

    def step():
        history[:] = history[1], advance(clock[0] * dt, history[1], dt, 1)
        clock[0] += 1

    return World(step, lambda: lesson.state_of(loop, history[1]),
                 lambda: pushes(lesson, loop, clock[0], *history, dt) if clock[0] else [])


def compiled_advance(loop, of="solutions"):
    """Return the function (t, state, dt, steps) → PileState of a Loop, with the compiled twins of its functions."""
    names = [function.__name__ for function in lesson_of(of).padded(loop)]
    return modules.module_set(of, True).advance(loop, names)


def pushes(lesson, loop, steps, before, after, dt):
    """Return the pushes of the last step: of its contacts, and of its joints."""
    body = {row: k for k, row in enumerate(loop.row)}
    found = [Push(body[a], body[b], J / dt) for a, b, J in zip(after.contacts.a, after.contacts.b, after.J)]
    joints, rods = loop.p.joints, loop.p.rods
    if loop.joint_of:
        J = lesson.link_impulses(loop.load, (steps - 1) * dt, before, after, dt, loop.p)
        rows = zip((*joints.a, *rods.a), (*joints.b, *rods.b), J, loop.joint_of)
        found += [Push(body[a], body.get(b, WORLD), impulse / dt, joint) for a, b, impulse, joint in rows]
    return found
