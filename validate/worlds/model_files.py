"""A Model as a JSON file, and the schema of such files, which follows from the fields of the records.

A field that make_model fills in is left out.  An infinite number is the text "inf".  A shape, a joint and a load have a
`kind`, the name of their record.
"""

import json
import math
from functools import partial
from pathlib import Path
from typing import get_type_hints

from solutions.checks import BadInput
from solutions.support.model import JOINTS, SHAPES, Body, Drag, Model, Spring, check_model, make_model

KIND = "kind"
LISTS = {"bodies": (Body,), "joints": JOINTS, "springs": (Spring,), "loads": (Drag,)}    # of a Model, and their records
NAMED = (*SHAPES, *JOINTS, Drag)             # records with a kind
DRAFT = "https://json-schema.org/draft/2020-12/schema"
NUMBER = {"anyOf": [{"type": "number"}, {"const": "inf"}]}
NUMBERS = {"type": "array", "items": {"anyOf": [*NUMBER["anyOf"], {"type": "array", "items": NUMBER}]}}


# ---------------------------------------------------------------------------------------------- writing

def save_model(model, path):
    """Write a Model to a file.  Raises BadInput for a load that is a function, which no file can hold."""
    check_model(model)
    for n, load in enumerate(model.loads):
        if not isinstance(load, Drag):
            raise BadInput(f"load {n}", "a function", "leave it out: a file holds Drag only")
    model = make_model(*model)
    data = {"gravity": plain(model.gravity)}
    for name in LISTS:
        records = getattr(model, name)
        records = [bare(body, model.gravity) for body in records] if name == "bodies" else records
        if records:
            data[name] = [plain(record) for record in records]
    text = json.dumps(data, indent=1, allow_nan=False, ensure_ascii=False) + "\n"
    path = file_path(path)
    try:
        path.write_text(text, encoding="utf-8")
    except OSError as error:
        raise BadInput(f"the file {path}", error.strerror, "name a file that can be written") from None


def file_path(path):
    """Return the Path of a file.  Raises BadInput for what names none."""
    try:
        return Path(path)
    except TypeError:
        raise BadInput("the name of a file", f"a {type(path).__name__}", "give a text or a Path") from None


def bare(body, gravity):
    """Return a body with None or the default in each field that make_model gives back."""
    found = body
    for name, value in Body._field_defaults.items():
        less = found._replace(**{name: value})
        try:
            if make_model([less], gravity).bodies[0] == body:
                found = less
        except BadInput:                                     # such as a half-space with a mass
            continue
    return found


def plain(value):
    """Return numbers, tuples and records as JSON has them; a field with its default is left out."""
    if hasattr(value, "_fields"):
        kind = {KIND: type(value).__name__} if isinstance(value, NAMED) else {}
        defaults = value._field_defaults
        return kind | {name: plain(one) for name, one in value._asdict().items()
                       if name not in defaults or one != defaults[name]}
    if isinstance(value, tuple):
        return [plain(one) for one in value]
    if isinstance(value, float) and math.isinf(value):
        return "inf"
    return value


# ---------------------------------------------------------------------------------------------- reading

def read_model(path):
    """Return the Model in a file.  Raises BadInput for everything that model_schema or make_model does not allow."""
    path = file_path(path)
    try:
        return model_of(json.loads(
            path.read_text(encoding="utf-8"), parse_constant=refuse_constant, object_pairs_hook=named_once,
            parse_float=partial(number_of, float), parse_int=partial(number_of, int)))
    except OSError as error:
        raise BadInput(f"the file {path}", error.strerror, "name a file that can be read") from None
    except BadInput:
        raise
    except (ValueError, RecursionError) as error:
        raise BadInput(f"the file {path}", f"not JSON ({error})", "write it with save_model") from None


def model_of(data):
    """Return the Model of the content of a file."""
    fields = checked_fields("a model", data, Model)
    lists = {name: records_of(name, fields.get(name, []), kinds) for name, kinds in LISTS.items()}
    return make_model(gravity=value_of("gravity", fields["gravity"], tuple), **lists)


def refuse_constant(text):
    """Raise BadInput for NaN and Infinity, which JSON does not have."""
    raise BadInput("a number", text, 'write "inf" for an infinite one')


def named_once(fields):
    """Return the fields of an object.  Raises BadInput where two have one name: only the last would count."""
    found = dict(fields)
    for name, _ in fields if len(found) < len(fields) else ():
        if [other for other, _ in fields].count(name) > 1:
            raise BadInput(f"the field {name!r} of an object", "given twice", "leave one out")
    return found


def number_of(kind, text):
    """Return the number of a text.  Raises BadInput for one too large for a float, which would be read as infinite."""
    if math.isinf(float(text)):
        raise BadInput("a number", f"{text[:20]}… with {len(text)} characters", 'write "inf" for an infinite one')
    return kind(text)


def records_of(name, rows, kinds):
    """Return the records of a list."""
    if not isinstance(rows, list):
        raise BadInput(name, type(rows).__name__, "give a list")
    singular = {"bodies": "body"}.get(name, name[:-1])
    return [record_of(f"{singular} {n}", row, kinds) for n, row in enumerate(rows)]


def record_of(thing, data, kinds):
    """Return a record of one of these kinds."""
    if not isinstance(data, dict):
        raise BadInput(thing, type(data).__name__, "give an object with named fields")
    kind = kinds[0]
    if kind in NAMED:
        known = {one.__name__: one for one in kinds}
        name = data.get(KIND)
        if not isinstance(name, str) or name not in known:
            raise BadInput(f"the kind of {thing}", repr(name), f"choose from: {', '.join(known)}")
        kind, data = known[name], {key: value for key, value in data.items() if key != KIND}
    hints = get_type_hints(kind)
    return kind(**{key: value_of(f"{key} of {thing}", value, hints[key])
                   for key, value in checked_fields(thing, data, kind).items()})


def checked_fields(thing, data, kind):
    """Return data.  Raises BadInput unless it has exactly the fields of a record, those with a default or not."""
    if not isinstance(data, dict):
        raise BadInput(thing, type(data).__name__, "give an object with named fields")
    for key in data:
        if key not in kind._fields:
            raise BadInput(f"the field {key!r} of {thing}", "unknown", f"choose from: {', '.join(kind._fields)}")
    for key in kind._fields:
        if key not in data and key not in kind._field_defaults:
            raise BadInput(f"the field {key!r} of {thing}", "missing", "add it")
    return data


def value_of(thing, value, hint):
    """Return a value of a field whose annotation is `hint`.  Raises BadInput for another type."""
    if hint is int:
        if type(value) is not int:
            raise BadInput(thing, repr(value), "give a whole number")
        return value
    if type(value) in (int, float) and hint is not tuple:
        return float(value)
    if value == "inf" and hint is not tuple:
        return math.inf
    if isinstance(value, list) and hint is not float:
        return tuple(value_of(f"an entry of {thing}", one, object) for one in value)
    if isinstance(value, dict) and hint is object:
        return record_of(thing, value, SHAPES)
    if value is None and hint is not float:
        return None
    raise BadInput(thing, repr(value), {float: "give a number", tuple: "give a list of numbers"}.get(
        hint, "give a number, a list of numbers or a shape"))


# ---------------------------------------------------------------------------------------------- the schema

def model_schema():
    """Return the JSON Schema of a Model's file, from the fields of the records."""
    records = (Body, Spring, *NAMED)
    entries = {name: {"type": "array", "items": any_of(kinds)} for name, kinds in LISTS.items()}
    return {"$schema": DRAFT, "title": "Model", "type": "object", "additionalProperties": False,
            "required": ["bodies", "gravity"], "properties": {"gravity": NUMBERS, **entries},
            "$defs": {kind.__name__: schema_of(kind) for kind in records}}


def any_of(kinds):
    """Return the schema of one of these records."""
    return {"anyOf": [{"$ref": f"#/$defs/{kind.__name__}"} for kind in kinds]}


def schema_of(kind):
    """Return the schema of a record."""
    named = {KIND: {"const": kind.__name__}} if kind in NAMED else {}
    hints = get_type_hints(kind)
    required = [*named, *(name for name in kind._fields if name not in kind._field_defaults)]
    return {"type": "object", "additionalProperties": False, "required": required,
            "description": (kind.__doc__ or "").strip(),
            "properties": named | {name: allowed(kind, name, hints[name]) for name in kind._fields}}


def allowed(kind, name, hint):
    """Return the schema of a field."""
    if hint is int:
        return {"type": "integer"}
    if hint is float:
        return NUMBER
    if hint is tuple:
        return NUMBERS if name not in kind._field_defaults else {"anyOf": [NUMBERS, {"type": "null"}]}
    shapes = any_of(SHAPES)["anyOf"] if name == "shape" else []
    plain_values = [] if name == "shape" else [*NUMBER["anyOf"], NUMBERS]
    return {"anyOf": [*plain_values, *shapes, {"type": "null"}]}
