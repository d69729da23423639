"""A variable of a dataset with its interval."""

from __future__ import annotations

from typing import Any

from lapjoint.problem import FloatArray

Variable = tuple[tuple[str, ...], Any, dict[str, Any]]
"""Dimensions, values and attributes of a variable, as xarray takes them."""


def valued(
    name: str, dimensions: tuple[str, ...], values: FloatArray, ends: FloatArray, units: str, text: str
) -> dict[str, Variable]:
    """A value and its interval."""
    around = f"95 % interval: {text}"
    return {
        name: (dimensions, values, {"units": units, "long_name": text}),
        f"{name}_interval": ((*dimensions, "bound"), ends, {"units": units, "long_name": around}),
    }
