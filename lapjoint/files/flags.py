"""Variables whose values stand for names, with the attributes by which the CF conventions say so."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np


def flags(names: Iterable[str], values: Iterable[int] | None = None) -> dict[str, Any]:
    """Attributes of a variable whose values, by default 0, 1, ..., stand for names."""
    words = list(names)
    codes = range(len(words)) if values is None else values
    return {"flag_values": np.array(list(codes), dtype="i1"), "flag_meanings": " ".join(words)}


def flag_names(attributes: Mapping[Any, Any]) -> dict[int, str]:
    """The name for which each value of a variable stands, by the variable's attributes."""
    names = str(attributes["flag_meanings"]).split()
    return dict(zip(np.ravel(attributes["flag_values"]).tolist(), names, strict=True))
