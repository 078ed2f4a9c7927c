"""A run that is repeated with the same arguments: its records are checked, and its machine code is found, only once.

An engine's world is built and checked before the clock starts.  In the same way, a run of ours is rehearsed before it
is timed: each call of a compiled function checks its records and looks up the machine code for its arguments.  The
timed runs then call that machine code.
"""

from ..subject.modules import Lessons
from ..subject.numba_twins import CachedDispatch, kinds_of


def rehearsed(lessons, step, run):
    """Return (lessons, step) for repeating `run(lessons, step)`, which takes place once.

    A function whose calls had arguments of several kinds checks and looks up in each call, as before.  A run may ask
    whether its step is a function of a lesson: where it was, it still is.
    """
    heard = Heard()
    own, again = heard.function(step), Lessons(lambda name: heard.module(getattr(lessons, name)))
    run(again, own)
    heard.settle()
    return again, settled(own)


class Heard:
    """What a run asks for of the lessons: modules, and one HeardFunction for each compiled function."""

    def __init__(self):
        self.modules, self.functions = [], {}

    def module(self, module):
        """Return the HeardModule of the module of a lesson."""
        self.modules.append(HeardModule(module, self))
        return self.modules[-1]

    def function(self, found):
        """Return the HeardFunction of a compiled function; anything else as it is."""
        if not isinstance(found, CachedDispatch):
            return found
        return self.functions.setdefault(id(found), HeardFunction(found))

    def settle(self):
        """Put the machine code of each function in its place."""
        for module in self.modules:
            vars(module).update({name: settled(part) for name, part in vars(module).items()})


class HeardModule:
    """The module of a lesson, for a run that will be repeated."""

    def __init__(self, module, heard):
        self._module, self._heard = module, heard

    def __getattr__(self, name):
        found = self._heard.function(getattr(self._module, name))
        setattr(self, name, found)
        return found


class HeardFunction:
    """A compiled function that notes the machine code of its calls, and whether it is an argument of another one."""

    def __init__(self, function):
        self.function, self.codes, self.passed_on = function, set(), False

    def __call__(self, *arguments):
        arguments = [meant(argument) for argument in arguments]
        result = self.function(*arguments)
        self.codes.add(self.function.known[kinds_of(arguments)])
        return result


def meant(argument):
    """Return an argument of a compiled function, with compiled functions in place of heard ones."""
    if isinstance(argument, HeardFunction):
        argument.passed_on = True
        return argument.function
    if isinstance(argument, tuple):
        inner = map(meant, argument)
        return type(argument)(*inner) if hasattr(argument, "_fields") else tuple(inner)
    return argument


def settled(part):
    """Return the machine code of all calls of a heard function, or the function itself where there is no single one.

    Anything else is returned as it is.
    """
    if not isinstance(part, HeardFunction):
        return part
    return part.function if part.passed_on or len(part.codes) != 1 else next(iter(part.codes))
