"""The faults of a problem in the words of its file, one line for each.

A line names the field, shows its value and says what is allowed, as in
``stops[1].gap = "wide": must be a number``.
"""

from __future__ import annotations

import difflib
import json
import math
from collections.abc import Iterator, Mapping, Sequence
from functools import cache
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from pydantic import BaseModel, ValidationError
    from pydantic_core import ErrorDetails

LONGEST_VALUE = 60
"""Most characters of a value in a message, so that the message fits into a line."""
LONGEST_PATH = 200
"""Most characters of a path or an argument in a message."""
_SEQUENCES = (list, tuple)


def explain(error: ValidationError, data: Any, model: type[BaseModel]) -> str:
    """All faults that validation of `data` against `model` found, one a line, no line twice."""
    lines: list[str] = []
    for fault in error.errors(include_url=False):
        lines += [line for line in _lines(fault, data, model) if line not in lines]
    return "\n".join(lines)


def in_sentences(error: ValidationError, data: Any, model: type[BaseModel], source: str) -> str:
    """All faults that validation of `data` against `model` found, for a message about `source`, a file or a part.

    One fault stands in one line with its source; several stand in a line each, after one that counts them.
    """
    faults = explain(error, data, model).split("\n")
    if len(faults) == 1:
        return f"{source}: {faults[0]}"
    return "\n".join([f"{source}: {len(faults)} faults", *(f"  {fault}" for fault in faults)])


def shown(value: Any) -> str:
    """A value as its file would write it, in at most `LONGEST_VALUE` characters; of a table only the keys."""
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, float) and not math.isfinite(value):
        return str(value)
    if isinstance(value, str):
        text = encodable(json.dumps(value, ensure_ascii=False))
    elif isinstance(value, Mapping):
        text = "{" + ", ".join(f"{key} = ..." for key in value) + "}"
    else:
        try:
            text = repr(value)
        except ValueError:  # Python refuses to write integers of more than some thousand digits
            text = "a very long number"
        except RecursionError:
            text = "a very deep list"
    return shortened(text, LONGEST_VALUE)


def encodable(text: str) -> str:
    """Text that UTF-8 can hold, as pydantic's messages must: half of a surrogate pair is written by its number."""
    return text.encode(errors="backslashreplace").decode()


def shortened(text: str, most: int = LONGEST_PATH) -> str:
    """A text of at most `most` characters; three dots stand for the end of a longer one."""
    return text if len(text) <= most else text[: most - 3] + "..."


def closest(name: str, allowed: Sequence[str]) -> str:
    """The allowed name that is closest to a given one, if one resembles it, and then all that are allowed."""
    near = difflib.get_close_matches(name, allowed, n=1)
    return (f"did you mean {near[0]}? " if near else "") + f"allowed: {', '.join(allowed)}"


def field_path(loc: Sequence[int | str], data: Any) -> str:
    """The path of a field of `data` as a person writes it, ``stops[1].gap``; empty for the whole of the data.

    A validator's location `loc` also holds the kind of a part (``rectangle``), though a key may have the same name
    (``harmonics``).  The kind is left out, and so are elements that are no keys of the data, except the last.
    """
    path, here, told = "", data, False
    for i, key in enumerate(loc):
        if not told and isinstance(here, Mapping) and key in (here.get("kind"), here.get("shape")):
            told = True
            continue
        told = False
        if isinstance(key, int) and isinstance(here, _SEQUENCES) and key < len(here):
            path, here = f"{path}[{key}]", here[key]
        elif isinstance(key, str) and isinstance(here, Mapping) and key in here:
            path, here = f"{path}.{key}", here[key]
        elif isinstance(key, str) and isinstance(here, Mapping) and i == len(loc) - 1:
            path = f"{path}.{key}"
    return shortened(path.removeprefix("."))


def _lines(fault: ErrorDetails, data: Any, model: type[BaseModel]) -> Iterator[str]:
    kind, value, loc = fault["type"], fault["input"], fault["loc"]
    if kind in ("missing", "extra_forbidden"):
        path = field_path(loc, data)
        if kind == "missing":
            yield f"{path}: is missing{_described(model, loc)}"
        else:
            yield f"{path}: unknown key; {_meant(model, loc, value)}"
        return
    # The kind of the part itself may end the location; it is not a key there.
    path = field_path((*loc, ""), data).removesuffix(".")
    if kind == "union_tag_not_found":
        key = str(fault["ctx"]["discriminator"]).strip("'")
        yield f"{path}.{key}: is missing; allowed: {', '.join(_tags(model, loc))}"
    elif kind == "union_tag_invalid":
        key = str(fault["ctx"]["discriminator"]).strip("'")
        yield f"{path}.{key} = {shown(fault['ctx']['tag'])}: allowed: {', '.join(_tags(model, loc))}"
    elif kind == "value_error":
        for line in fault["msg"].removeprefix("Value error, ").split("\n"):
            yield _joined(path, value, line)
    else:
        written = f"; above each entry stands [[{path}]]" if kind == "tuple_type" and isinstance(value, Mapping) else ""
        yield f"{path or 'the file'} = {shown(value)}: {_requirement(fault)}{written}"


def _joined(path: str, value: Any, message: str) -> str:
    if isinstance(value, Mapping) or not isinstance(value, str | int | float):
        return f"{path}: {message}" if path else message
    return f"{path} = {shown(value)}: {message}"


def _requirement(fault: ErrorDetails) -> str:
    kind, ctx = fault["type"], fault.get("ctx", {})
    simple = {
        "finite_number": "must be a finite number",
        "int_from_float": "must be a whole number",
        "int_type": "must be a whole number",
        "float_type": "must be a number",
        "tuple_type": "must be a list",
        "string_type": "must be text",
        "string_unicode": "must be valid Unicode text",
        "model_type": "must be a table",
        "model_attributes_type": "must be a table",
        "dict_type": "must be a table",
    }
    if kind in simple:
        return simple[kind]
    if kind == "greater_than":
        return f"must be greater than {ctx['gt']:g}"
    if kind == "greater_than_equal":
        return f"must be at least {ctx['ge']:g}"
    if kind == "less_than_equal":
        return f"must be at most {ctx['le']:g}"
    if kind == "string_too_short":
        return f"must have at least {ctx['min_length']} character{'s' * (ctx['min_length'] > 1)}"
    if kind == "too_short":
        return f"must have at least {ctx['min_length']} value{'s' * (ctx['min_length'] > 1)}"
    if kind == "literal_error":
        return "must be " + str(ctx["expected"]).replace("'", '"')
    return fault["msg"].replace("Input should be", "must be")


@cache
def _schema_of(model: type[BaseModel]) -> Mapping[str, Any]:
    """The JSON Schema of a model, made once: that takes longer than everything else."""
    return model.model_json_schema()


def _schema_at(model: type[BaseModel], loc: Sequence[int | str]) -> Mapping[str, Any]:
    """The part of the JSON Schema that describes the value at a validator's location."""
    schema = _schema_of(model)
    definitions = schema.get("$defs", {})

    def resolved(part: Mapping[str, Any]) -> Mapping[str, Any]:
        while True:
            if "$ref" in part:
                part = definitions[part["$ref"].rsplit("/", 1)[-1]]
            elif "anyOf" in part:  # an optional part: the first is the part, the second null
                part = part["anyOf"][0]
            else:
                return part

    here = resolved(schema)
    for key in loc:
        if isinstance(key, int):
            here = resolved(here.get("items", {}))
        elif key in here.get("properties", {}):
            here = resolved(here["properties"][key])
        elif key in here.get("discriminator", {}).get("mapping", {}):
            here = resolved({"$ref": here["discriminator"]["mapping"][key]})
    return here


def _allowed_keys(model: type[BaseModel], loc: Sequence[int | str]) -> list[str]:
    return list(_schema_at(model, loc).get("properties", {}))


def _meant(model: type[BaseModel], loc: Sequence[int | str], value: Any) -> str:
    """What may be meant by an unknown key: the key of a part below, or the closest of those that are allowed."""
    key, here = str(loc[-1]), _schema_at(model, loc[:-1]).get("properties", {})
    for name in here:
        part = _schema_at(model, (*loc[:-1], name))
        listed = part.get("type") == "array"
        if key in _schema_at(model, (*loc[:-1], name, 0) if listed else (*loc[:-1], name)).get("properties", {}):
            path = ".".join(str(part) for part in (*loc[:-1], name) if not isinstance(part, int))
            within = f"[[{path}]]" if listed else f"[{path}]"
            return f"is it [{path}.{key}]?" if isinstance(value, Mapping) and not listed else f"it is a key of {within}"
    return closest(key, _allowed_keys(model, loc[:-1]))


def _tags(model: type[BaseModel], loc: Sequence[int | str]) -> list[str]:
    return list(_schema_at(model, loc).get("discriminator", {}).get("mapping", {}))


def _described(model: type[BaseModel], loc: Sequence[int | str]) -> str:
    properties = _schema_at(model, loc[:-1]).get("properties", {})
    description = properties.get(loc[-1], {}).get("description", "")
    return f" ({description.rstrip('.')})" if description else ""
