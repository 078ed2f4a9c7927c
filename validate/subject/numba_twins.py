"""Compilation of plain functions with numba: the compiled twins, their cache, and what is changed in numba itself.

A twin's cache on disk lies in a folder that is named after a digest of *all* files of its set of modules.  numba
looks at one file only, so without the digest an edit to an imported sibling would leave a stale caller.
"""

import gc
import os
import shutil
import time
import types
import uuid
import warnings
from contextlib import contextmanager, suppress
from functools import cache, cached_property, partial
from pathlib import Path
from types import MappingProxyType

import numpy as np

CACHE = Path(__file__).resolve().parents[2] / ".cache" / "compiled"
INLINED = "vectors"          # its functions become part of their callers: a call would pass whole arrays, and a step of
                             # a spring net would take 2.5 times as long
FROM_PYTHON = "from python"  # folder of the cache for what Python calls
RARELY = 100_000             # new objects between two searches for cycles
SAVE_WITHIN = 10.0           # wait for another process that saves [s]
CACHED_SETS = 6              # digests kept on disk: some edits back
IN_USE = 3600.0              # a digest that was asked for so long ago [s] may still be in use by another process


def compiled_twins(module, names, space, cache):
    """Return {name: compiled function}, whose globals are `space`, for those functions of a module.

    cache: the folder of their set, as `use_cache` gave it.  The same file may belong to two sets of one process, and
    its functions call others there.
    """
    from .linking import SIDE_BY_SIDE
    twins = {}
    for name in names:
        plain = space[name]
        copy = types.FunctionType(plain.__code__, space, plain.__name__, plain.__defaults__, plain.__closure__)
        copy.__module__, copy.__qualname__, copy.__doc__ = module.__name__, plain.__qualname__, plain.__doc__
        options = {"inline": "always"} if module.__name__.rpartition(".")[2] == INLINED else {}
        if name in space.get("SIDE_BY_SIDE", ()):                        # its loop, over arrays that share no memory
            SIDE_BY_SIDE.add(plain.__qualname__)
            options["noalias"] = True
        twins[name] = compiled(copy, f"{module.__name__}.{plain.__qualname__}", cache, options)
    return twins


def compiled(function, name, cache, options=MappingProxyType({}), from_python=False):
    """Return the twin of a function, which may be a closure that calls other twins.

    name: the same in every process, and no other function's.  numba recognises a function argument in its disk cache
    by the id that is made from it.    options: of numba, beside the usual ones.
    from_python: whether Python can call the twin; CachedDispatch makes such a one.
    """
    from numba import config, njit
    config.CACHE_DIR = os.path.join(cache, FROM_PYTHON) if from_python else cache
    twin = njit(cache=True, error_model="numpy", no_cfunc_wrapper=True, no_cpython_wrapper=not from_python,
                **options)(function)
    twin._set_uuid(str(uuid.uuid5(uuid.NAMESPACE_URL, f"{name} {FROM_PYTHON}" if from_python else name)))
    twin.from_python = partial(compiled, function, name, cache, options, from_python=True)
    return twin


@contextmanager
def rare_searches_for_cycles():
    """Let Python look for cycles of unused objects more rarely.

    Compiling makes millions of objects, and few such cycles.  To look for them takes up to a tenth of its time.
    """
    usual = gc.get_threshold()
    gc.set_threshold(RARELY, *usual[1:])
    try:
        yield
    finally:
        gc.set_threshold(*usual)


class CachedDispatch:
    """A twin as Python calls it.

    What numba compiles for a call from Python takes up to nine tenths of the time, because it takes all records apart
    and makes new ones.  So it is compiled for those functions only that Python does call.
    The machine code is looked up by the kinds of the arguments: numba's own search takes 50 µs per call.
    """

    def __init__(self, twin):
        self.twin, self.known = twin, {}
        ITS_OWN_KIND.add(type(twin))

    @cached_property
    def called(self):
        """The same function, compiled for calls from Python."""
        return self.twin.from_python()

    def __call__(self, *arguments):
        kinds = kinds_of(arguments)
        if kinds not in self.known:
            self.known[kinds] = self.machine_code(arguments)
        return self.known[kinds](*arguments)

    def machine_code(self, arguments):
        """Return what Python calls for arguments of these kinds.

        Where numba cannot compile for them, arrays that do not lie row by row in memory, such as transposed ones, and
        those that may not be written are copied before each call.
        """
        from numba.core.errors import TypingError
        try:
            return self.compiled_for(arguments)
        except TypingError:
            usual = _in_rows(arguments)
            if kinds_of(usual) == kinds_of(arguments):
                raise
            code = self.compiled_for(usual)
            return lambda *others: code(*_in_rows(others))

    def compiled_for(self, arguments):
        """Return the machine code for arguments of exactly these types."""
        from numba import typeof
        exact = tuple(map(typeof, arguments))
        if exact not in self.called.overloads:
            with rare_searches_for_cycles():
                self.called.compile(exact)
        return self.called.get_overload(exact)

    def __getattr__(self, name):                                     # py_func … are those of the twin
        if name == "twin":
            raise AttributeError(name)
        return getattr(self.twin, name)


class CheckedFirst(CachedDispatch):
    """The same for a function whose records are checked in plain Python before it starts."""

    def __init__(self, twin, check):
        super().__init__(twin)
        self.check = check

    def __call__(self, *arguments):
        self.check(*arguments)
        return super().__call__(*arguments)


NUMBERS = {float, int}
ITS_OWN_KIND = {CachedDispatch, CheckedFirst}            # and numba's type of compiled functions


def passed_over(p, state):
    """Stand in for check_record where compiled code calls it: CheckedFirst has made the call before."""


def _in_rows(argument):
    """Return an array, or the arrays of a record, row by row in memory and writable; anything else as it is."""
    if type(argument) is np.ndarray:
        return argument if argument.flags.c_contiguous and argument.flags.writeable else argument.copy()
    if isinstance(argument, tuple):
        inner = map(_in_rows, argument)
        return type(argument)(*inner) if hasattr(argument, "_fields") else tuple(inner)
    return argument


def kinds_of(arguments):
    """Return what decides which machine code a call needs, for each of its arguments.  It is asked for in each call."""
    return tuple([type(a) if type(a) in NUMBERS else a if type(a) in ITS_OWN_KIND else _kind(a) for a in arguments])


def _kind(argument):
    """Return the same for one argument, which is neither a number nor a compiled function."""
    kind = type(argument)
    if kind is np.ndarray:
        return argument.dtype, argument.ndim, argument.flags.num
    return (kind, kinds_of(argument)) if isinstance(argument, tuple) else getattr(argument, "kind_name", kind)


@cache
def _make_dispatcher_constants_cacheable():
    """Let numba cache functions that pass a function on: it refuses to,
    because it would store an address, which is never read.
    """
    import numba.experimental.function_type  # noqa: F401
    from numba import types
    from numba.core.imputils import lower_constant
    lower_constant(types.Dispatcher)(lambda context, builder, kind, function: context.get_dummy_value())


@cache
def _pass_checked_functions_on():
    """Let a compiled function take a CachedDispatch as an argument: the twin in it is meant."""
    from numba.extending import typeof_impl

    @typeof_impl.register(CachedDispatch)
    def _(around, context):
        return typeof_impl(around.twin, context)


@cache
def _save_one_at_a_time():
    """Let one process at a time save to a cache, and let numba go on when it cannot: it then compiles again next time.

    numba reads the index of a function, adds an entry and writes it back.  Two processes at once lose an entry, or give
    the machine code of both the same file.
    """
    from filelock import FileLock
    from numba.core.caching import Cache
    keep = Cache.save_overload

    def keep_if_possible(cache, signature, data):
        with suppress(OSError), FileLock(Path(cache.cache_path) / "lock", timeout=SAVE_WITHIN):    # or the disk is full
            keep(cache, signature, data)
    Cache.save_overload = keep_if_possible


@cache
def _count_references_in_one_thread():
    """Let compiled code count the references to its arrays by plain additions.

    numba adds with the processor's lock, so that threads may share an array.  A step that passes records of arrays on
    takes up to three times as long by that.  All code here runs in one thread, but for the loops of `speed/threads.py`:
    numba hands them arrays without counting.
    """
    from numba.core.cgutils import ir
    from numba.core.runtime import nrtdynmod

    def count(module, op, ordering):
        word = nrtdynmod._word_type
        made = ir.Function(module, ir.FunctionType(word, [word.as_pointer()]), name=f"nrt_atomic_{op}")
        builder = ir.IRBuilder(made.append_basic_block())
        new = getattr(builder, op)(builder.load(made.args[0]), ir.Constant(word, 1))
        builder.store(new, made.args[0])
        builder.ret(new)
        return made
    nrtdynmod._define_atomic_inc_dec = count


def use_cache(digest):
    """Return the cache folder of this digest, as text, and delete those that were not used for long."""
    import numba
    from numba.core.config import _OptLevel

    from .linking import link_only
    _make_dispatcher_constants_cacheable()
    _pass_checked_functions_on()
    _save_one_at_a_time()
    _count_references_in_one_thread()
    link_only()
    numba.config.OPT, numba.config.LOOP_VECTORIZE = _OptLevel(1), 0  # same speed, a third of the compile time
    warnings.filterwarnings("ignore", message="Cannot cache compiled function")  # then it is compiled anew, that is all
    folder = CACHE / digest
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError:                                                  # a read-only installation: compile anew each time
        import tempfile
        folder = Path(tempfile.mkdtemp(prefix="workbook-"))
    os.utime(folder)
    forget_old_sets(folder.parent)
    return str(folder)


def forget_old_sets(cache):
    """Delete all folders of a cache but the newest CACHED_SETS and those that another process may be using."""
    with suppress(OSError):                                          # another process deletes them at this moment
        newest = sorted(cache.iterdir(), key=lambda path: path.stat().st_mtime, reverse=True)
        for old in newest[CACHED_SETS:]:
            if old.stat().st_mtime < time.time() - IN_USE:
                shutil.rmtree(old, ignore_errors=True)
