"""Long lists of numbers as one part of a problem: immutable, compared by value, identified by a digest."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from hashlib import sha256
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from lapjoint.problem.schema import FloatArray

if TYPE_CHECKING:
    from pydantic import GetCoreSchemaHandler, GetJsonSchemaHandler


class Source(NamedTuple):
    """Where samples were read, and how."""

    folder: str
    """Folder from which `file` is looked for."""
    file: str
    """The file, as the problem names it."""
    column: int | str | None = None
    time_column: int | str | None = None
    skip: int = 0
    delimiter: str | None = None
    decimal: str = "."
    encoding: str = "utf-8"
    comment: str = "#"
    dataset: int | str | None = None

    def passes_over(self, line: str) -> bool:
        """Whether a line is a comment."""
        return line.lstrip().startswith(self.comment)


class Stated(NamedTuple):
    """What a file says of the numbers of a column."""

    where: str
    """The place in the file: a line, or a data set."""
    unit: str
    """The unit as it is written there; empty for none."""
    sure: bool
    """Whether the text stands where only a unit can stand."""
    quantity: str = ""
    """The quantity; empty where the file does not say it."""


class Samples:
    """Numbers in a row, shape (n,), in whatever unit, and the file that they were read from, if any."""

    def __init__(
        self, values: Sequence[float] | FloatArray, source: Source | None = None, stated: Stated | None = None
    ) -> None:
        if any(isinstance(value, str | bool) for value in _few(values)):
            raise ValueError("must be a list of numbers")
        try:
            array = np.array(values, dtype=float)
        except (TypeError, ValueError):
            raise ValueError("must be a list of numbers") from None
        if array.ndim != 1:
            raise ValueError(f"must be a list of numbers, one after the other, and has the shape {array.shape}")
        array.flags.writeable = False
        self.array: FloatArray = array
        """The numbers, not to be written to, shape ``(n,)``."""
        self.source = source
        self.stated = stated
        """What the file says of them."""

    @cached_property
    def digest(self) -> str:
        """SHA-256 of the numbers as little-endian doubles, in hexadecimal digits."""
        return sha256(self.array.astype("<f8").tobytes()).hexdigest()

    def __len__(self) -> int:
        return self.array.size

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Samples) and np.array_equal(self.array, other.array)

    def __hash__(self) -> int:
        return hash(self.digest)

    def __repr__(self) -> str:
        return f"Samples({len(self)} numbers, {self.digest[:8]})"

    def __copy__(self) -> Samples:
        return self

    def __deepcopy__(self, memo: Any) -> Samples:
        return self

    def __reduce__(self) -> tuple[object, ...]:
        return Samples, (self.array, self.source, self.stated)

    @classmethod
    def __get_pydantic_core_schema__(cls, source: Any, handler: GetCoreSchemaHandler) -> Any:
        from pydantic_core import core_schema

        return core_schema.no_info_plain_validator_function(_samples)

    @classmethod
    def __get_pydantic_json_schema__(cls, schema: Any, handler: GetJsonSchemaHandler) -> dict[str, Any]:
        return {"type": "array", "items": {"type": "number"}}


def _samples(value: Any) -> Samples:
    """Samples, from samples or from a list or array of numbers."""
    return value if isinstance(value, Samples) else Samples(value)


def _few(values: Any) -> Any:
    """The values that must be checked one by one: none of an array of numbers, and a text in place of no list."""
    if isinstance(values, np.ndarray):
        return () if values.dtype.kind in "fiu" else [""]
    return values if isinstance(values, list | tuple) else [""]
