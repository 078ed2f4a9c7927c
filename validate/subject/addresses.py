"""Two types for numba: a record that is read by its address, and a function that is called by its address.

numba passes a record by value, as one number for each pointer, size and stride of its arrays.  A record of twenty
arrays is three hundred numbers, which every call copies and every function that passes it on has to be compiled for.

numba compiles a function again for each function that it is given.  A loop that is made of ten functions would be
compiled for each choice of them, and so would every function that passes some of them on.  A function that gets the
address of another one is compiled once, and serves every loop.

Importing this module imports numba.
"""

import dis
import hashlib
from contextlib import contextmanager

from llvmlite import ir
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

WHOLE = "whole_step"         # the step that calls nothing but the parts


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
    """An address."""

    def __init__(self, manager, kind):
        super().__init__(manager, kind, ir.IntType(8).as_pointer())


@unbox(FunctionAddress)
def unbox_function(kind, thing, c):
    """Read the field `place`."""
    place = c.pyapi.object_getattr_string(thing, "place")
    address = c.pyapi.long_as_voidptr(place)
    c.pyapi.decref(place)
    return NativeValue(address)


@lower_builtin(FunctionAddress, types.VarArg(types.Any))
def call_function(context, builder, signature, values):
    """Call a function by its address, and pass on what it raises."""
    address, *values = values
    kinds = signature.args[1:]
    pointer = context.call_conv.get_function_type(signature.return_type, kinds).as_pointer()
    status, result = context.call_conv.call_function(
        builder, builder.bitcast(address, pointer), signature.return_type, kinds, values)
    with cgutils.if_unlikely(builder, status.is_error):
        context.call_conv.return_status_propagate(builder, status)
    return result


class Address:
    """Where a compiled function is, and its type; 0 stands for one that is never called."""

    def __init__(self, place, kind):
        self.place, self.kind, self.kind_name = place, kind, kind.name


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


def address_of(twin, kind):
    """Return the Address of a compiled function, which is compiled for this type if it is not yet.

    Raises TypeError where it returns something else than the type says: a caller that knows its address only would take
    that for what it expects.
    """
    arguments = kind.signature.args
    if arguments not in twin.overloads:
        with short_message_of_shapes():
            twin.compile(arguments)
    code = twin.overloads[arguments]
    if code.signature.return_type != kind.signature.return_type:
        raise TypeError(f"{twin.__name__} returns {code.signature.return_type} and not {kind.signature.return_type}")
    return Address(code.library.get_pointer_to_function(code.fndesc.llvm_func_name), kind)


def function(result, *arguments):
    """Return the type of functions of arguments of these types."""
    return FunctionAddress(Signature(result, arguments, None))


# ---------------------------------------------------------------------------------------------- loops

def names_used(part):
    """Return the names of the variables that a function reads or writes; one instruction may do so with two."""
    found = [line.argval for line in dis.get_instructions(part) if "FAST" in line.opname]
    return {name for one in found for name in (one if isinstance(one, tuple) else (one,))}


def functions_of_loop(lesson, loop, parts):
    """Return the addresses that advance_parts takes: of a step, of six parts, of a load, of bounds and of a search for
    contacts.

    Each is compiled once for all models in the plane, and once for all in space.  What no part calls is not compiled.
    lesson: a lesson of compiled functions;    parts: six functions of it
    """
    s, p, step = loop.state, loop.p, getattr(lesson, loop.step.step.__name__)
    x, q, v, omega, contacts, state, record = map(typeof, (s.x, s.q, s.v, s.omega, s.contacts, s, p))
    number, turn = types.float64, types.Array(types.float64, s.x.shape[1], "C")
    load = function(types.Tuple((x, omega)), number, x, q, v, omega, record)
    bounds = function(types.Tuple((x, x, turn)), x, q, typeof(p.half))
    narrow = function(contacts, x, turn, *map(typeof, (p.half, p.planes, p.pairs)), number)
    part = function(state, load, bounds, narrow, number, state, number, record)
    whole = function(state, *[part] * len(parts), *part.signature.args)
    used = set().union(*(names_used(one.py_func) for one in (*parts, *[step] * (step.__name__ != WHOLE))))
    called = [address_of(getattr(lesson, one.__name__), kind) if name in used else Address(0, kind)
              for name, one, kind in (("load", loop.load, load), ("bounds", loop.bounds, bounds),
                                      ("narrow", loop.narrow, narrow))]
    return address_of(step, whole), *[address_of(one, part) for one in parts], *called
