"""Places of a problem: a position of the only beam, or the name of one of several beams with a position on it."""

from __future__ import annotations

import math
from typing import Annotated

from pydantic import BeforeValidator, WithJsonSchema


def split_place(text: str) -> tuple[str, float] | None:
    """The beam's name and the position, m, of a text such as ``upper:0.3``; None of any other text."""
    name, colon, position = text.rpartition(":")
    try:
        x = float(position)
    except ValueError:
        return None
    return (name.strip(), x) if colon and name.strip() and x >= 0 and math.isfinite(x) else None


def _valid_place(value: object) -> object:
    """A place as it was given, if it may be one."""
    if isinstance(value, str):
        if split_place(value) is None:
            raise ValueError('must be a number, or of several beams a name and a number, as in "upper:0.3"')
        return value
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise ValueError('must be a number, or of several beams a name and a number, as in "upper:0.3"')
    if not math.isfinite(value):
        raise ValueError("must be a finite number")
    if value < 0:
        raise ValueError("must be at least 0")
    return float(value)


Place = Annotated[
    float | str,
    BeforeValidator(_valid_place),
    WithJsonSchema({"anyOf": [{"type": "number", "minimum": 0}, {"type": "string", "pattern": "^.+:[^:]+$"}]}),
]
"""A position on the only beam, m, or a beam's name and a position on it, as ``upper:0.3``."""


def place_of(text: str) -> float | str:
    """A place that is given as text: a number, or a beam and a number as they stand; `ValueError` of other text."""
    return text if split_place(text) is not None else float(text)
