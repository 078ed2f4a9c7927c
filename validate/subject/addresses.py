"""Two types for numba: a record that is read by its address, and a function that is called by its address.

numba passes a record by value, as one number for each pointer, size and stride of its arrays.  A record of twenty
arrays is three hundred numbers, which every call copies and every function that passes it on has to be compiled for.

numba compiles a function again for each function that it is given.  A loop that is made of ten functions would be
compiled for each choice of them, and so would every function that passes some of them on.  A function that gets the
address of another one is compiled once, and serves every loop.

A function may also be promised: it is compiled when it is first called.  A loop pays for no function that it never
calls, such as the test of bodies that are too fast.

Importing this module imports numba.
"""

import ctypes
import hashlib
from contextlib import contextmanager

from numba import typeof
from numba.core import cgutils, types
from numba.core.imputils import impl_ret_borrowed
from numba.core.typeconv import Conversion
from numba.core.typing.templates import AttributeTemplate, Signature, infer_getattr
from numba.extending import (
    NativeValue,
    lower_builtin,
    lower_getattr_generic,
    models,
    overload,
    register_model,
    typeof_impl,
    unbox,
)
from numba.np import arrayobj

from .linking import is_linked_only
from .numba_twins import rare_searches_for_cycles


def short(kind, more):
    """Return a short name of a type, which is part of the name of each function that is compiled for it."""
    return f"{kind}_{hashlib.sha256(str(more).encode()).hexdigest()[:12]}"


# ---------------------------------------------------------------------------------------------- records

class RecordAddress(types.Type):
    """The type of a record that compiled code only reads, and never returns."""

    def __init__(self, record):
        self.record = record             # the type that numba has for it
        super().__init__(short(record.instance_class.__name__, record))

    @property
    def key(self):
        return self.record


@register_model(RecordAddress)
class RecordModel(models.PrimitiveModel):
    """The address of a record, which its caller keeps."""

    def __init__(self, manager, kind):
        super().__init__(manager, kind, manager.lookup(kind.record).get_value_type().as_pointer())


@unbox(RecordAddress)
def unbox_record(kind, thing, c):
    """Keep the record in the frame of the function that Python calls."""
    found = c.unbox(kind.record, thing)
    place = cgutils.alloca_once_value(c.builder, found.value)

    def cleanup():
        if found.cleanup is not None:
            found.cleanup()
        c.context.nrt.decref(c.builder, kind.record, found.value)
    return NativeValue(place, is_error=found.is_error, cleanup=cleanup)


@infer_getattr
class FieldOfRecord(AttributeTemplate):
    """The type of a field."""
    key = RecordAddress

    def generic_resolve(self, kind, name):
        fields = kind.record.fields
        return kind.record.types[fields.index(name)] if name in fields else None


@lower_getattr_generic(RecordAddress)
def read_field(context, builder, kind, address, name):
    number = kind.record.fields.index(name)
    value = builder.load(cgutils.gep_inbounds(builder, address, 0, number))
    return impl_ret_borrowed(context, builder, kind.record.types[number], value)


def pass_by_address(record):
    """Let compiled code get all records of a class by their addresses."""
    @typeof_impl.register(record)
    def _(value, context):
        kinds = [typeof_impl(field, context) for field in value]
        if None in kinds:
            return None
        return RecordAddress(types.BaseTuple.from_types(kinds, record))


# ---------------------------------------------------------------------------------------------- functions

class FunctionAddress(types.Callable):
    """The type of a compiled function of which its caller knows the signature only."""

    def __init__(self, signature):
        self.signature = signature
        super().__init__(short("function", signature))

    @property
    def key(self):
        return self.signature

    def get_call_type(self, context, args, kws):
        if kws or len(args) != len(self.signature.args):
            return None
        scores = [context.can_convert(types.unliteral(a), b) for a, b in zip(args, self.signature.args)]
        if any(score is None or score > Conversion.safe for score in scores):
            return None
        return Signature(self.signature.return_type, self.signature.args, recvr=self)

    def get_call_signatures(self):
        return [self.signature], False

    def get_impl_key(self, signature):
        return FunctionAddress


@register_model(FunctionAddress)
class FunctionModel(models.PrimitiveModel):
    """The address of a Cell."""

    def __init__(self, manager, kind):
        super().__init__(manager, kind, cgutils.voidptr_t)


@unbox(FunctionAddress)
def unbox_function(kind, thing, c):
    """Read the field `cell`."""
    cell = c.pyapi.object_getattr_string(thing, "cell")
    address = c.pyapi.long_as_voidptr(cell)
    c.pyapi.decref(cell)
    return NativeValue(address)


@lower_builtin(FunctionAddress, types.VarArg(types.Any))
def call_function(context, builder, signature, values):
    """Call a function by its address, and pass on what it raises; one that is promised is compiled before."""
    cell, *values = values
    kinds = signature.args[1:]
    pointer = context.call_conv.get_function_type(signature.return_type, kinds).as_pointer()
    place, find = (builder.bitcast(cell, kind.as_pointer().as_pointer()) for kind in (pointer.pointee, FIND))
    with cgutils.if_unlikely(builder, cgutils.is_null(builder, builder.load(place))):
        builder.call(builder.load(cgutils.gep_inbounds(builder, find, 1)), [cell])
    address = builder.load(place)
    with cgutils.if_unlikely(builder, cgutils.is_null(builder, address)):
        context.call_conv.return_user_exc(builder, RuntimeError, ("a function could not be compiled",))
    status, result = context.call_conv.call_function(builder, address, signature.return_type, kinds, values)
    with cgutils.if_unlikely(builder, status.is_error):
        context.call_conv.return_status_propagate(builder, status)
    return result


FIND = cgutils.ir.FunctionType(cgutils.ir.VoidType(), [cgutils.voidptr_t])       # of the second field of a Cell


class Cell(ctypes.Structure):
    """What compiled code reads of a function."""
    _fields_ = (("place", ctypes.c_void_p),          # its machine code; 0: it is not yet compiled
                ("find", ctypes.c_void_p))           # the function that then compiles it and writes `place`


PROMISED: dict[int, tuple] = {}                      # address of a Cell → (cell, twin, kind)
ADDRESSES: dict[tuple, object] = {}                  # (twin, kind) → its Address


@ctypes.CFUNCTYPE(None, ctypes.c_void_p)
def compile_promised(address):
    """Compile the function of a Cell; Python prints what fails here, and the caller raises."""
    cell, twin, kind = PROMISED[address]
    cell.place = machine_code(twin, kind)


class Address:
    """Where compiled code finds a function, and its type."""

    def __init__(self, twin, kind):
        cell = Cell(0, ctypes.cast(compile_promised, ctypes.c_void_p).value)
        self.cell, self.kind, self.kind_name = ctypes.addressof(cell), kind, kind.name
        PROMISED[self.cell] = cell, twin, kind


@typeof_impl.register(Address)
def _(address, context):
    return address.kind


def shapes_differ(source, place):
    """Replace numba's raise_with_shape_context."""


@overload(shapes_differ)
def _(source, place):
    def say(source, place):
        raise ValueError("an array does not fit where it is assigned to")
    return say


@contextmanager
def short_message_of_shapes():
    """Let `rows[k] = row` say that shapes differ, but not which: to compile that sentence takes seconds.

    numba does so anew in each process that compiles such a line.
    """
    usual = arrayobj.raise_with_shape_context
    arrayobj.raise_with_shape_context = shapes_differ
    try:
        yield
    finally:
        arrayobj.raise_with_shape_context = usual


def machine_code(twin, kind):
    """Return where the machine code of a compiled function is, which is compiled for this type if it is not yet.

    Raises TypeError where it returns something else than the type says: a caller that knows its address only would take
    that for what it expects.
    """
    arguments = kind.signature.args
    if arguments not in twin.overloads:
        with short_message_of_shapes(), rare_searches_for_cycles():
            twin.compile(arguments)
    code = twin.overloads[arguments]
    if code.signature.return_type != kind.signature.return_type:
        raise TypeError(f"{twin.__name__} returns {code.signature.return_type} and not {kind.signature.return_type}")
    was_linked_only = is_linked_only(code.library)
    place = code.library.get_pointer_to_function(code.fndesc.llvm_func_name)
    if was_linked_only:
        twin._cache.save_overload(arguments, code)                       # with the machine code that it has now
    return place


def promise(twin, kind):
    """Return the Address of a function that is compiled when it is first called."""
    if (twin, kind) not in ADDRESSES:
        ADDRESSES[twin, kind] = Address(twin, kind)
    return ADDRESSES[twin, kind]


def address_of(twin, kind):
    """Return the Address of a function that is compiled now, so that this raises what is wrong with it."""
    address = promise(twin, kind)
    PROMISED[address.cell][0].place = machine_code(twin, kind)
    return address


def function(result, *arguments):
    """Return the type of functions of arguments of these types."""
    return FunctionAddress(Signature(result, arguments, None))


# ---------------------------------------------------------------------------------------------- loops

def functions_of_loop(lesson, loop, parts):
    """Return the addresses that advance_parts takes: of a step, of six parts, of first_touch, of a load, of bounds and
    of a search for contacts.

    Each is compiled once for all models in the plane, and once for all in space.  What no part calls is not compiled.
    lesson: a lesson of compiled functions;    parts: six functions of it
    """
    s, p = loop.state, loop.p
    x, q, v, omega, contacts, state, record = map(typeof, (s.x, s.q, s.v, s.omega, s.contacts, s, p))
    number, turn = types.float64, types.Array(types.float64, s.x.shape[1], "C")
    load = function(types.Tuple((x, omega)), number, x, q, v, omega, record)
    bounds = function(types.Tuple((x, x, turn)), x, q, typeof(p.half))
    narrow = function(contacts, x, turn, *map(typeof, (p.half, p.planes, p.pairs)), number)
    touch = function(number, bounds, narrow, state, state, number, record)
    part = function(state, load, bounds, narrow, number, state, number, record)
    whole = function(state, *[part] * len(parts), touch, *part.signature.args)
    called = [promise(getattr(lesson, one.__name__), kind)
              for one, kind in ((loop.touch, touch), (loop.load, load), (loop.bounds, bounds), (loop.narrow, narrow))]
    step = address_of(getattr(lesson, loop.step.step.__name__), whole)
    return step, *[address_of(one, part) for one in parts], *called
