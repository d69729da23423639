"""Units of recorded quantities and times, and what a file says of its own units.

A unit that a file states is compared with that of the problem, and nothing is converted by it: the problem alone says
what numbers mean.
"""

from __future__ import annotations

from collections.abc import Mapping

from lapjoint.problem.messages import shown
from lapjoint.problem.samples import Stated

G = 9.80665  # m/s2, the standard acceleration of free fall (CGPM 1901)
INCH, POUND = 0.0254, 0.45359237  # m and kg, the international inch and pound (1959)
UNITS: dict[str, dict[str, float]] = {
    "acceleration": {"m/s2": 1.0, "mm/s2": 1e-3, "cm/s2": 1e-2, "g": G, "mg": 1e-3 * G, "in/s2": INCH},
    "velocity": {"m/s": 1.0, "mm/s": 1e-3, "cm/s": 1e-2, "in/s": INCH},
    "displacement": {"m": 1.0, "mm": 1e-3, "um": 1e-6, "in": INCH},
    "force": {"N": 1.0, "kN": 1e3, "mN": 1e-3, "lbf": POUND * G},
}
"""SI units in each allowed unit; the first is the default."""
TIME_UNITS = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "min": 60.0}
"""Seconds in each allowed unit of time."""
_SPELT = str.maketrans({"²": "2", "µ": "u", "μ": "u"} | dict.fromkeys("^*[]() "))
"""Other spellings of units: ``m/s²``, ``m/s^2``, ``[µm]``."""
_NO_UNIT = ("", "-", "none", "unknown")
"""What stands for a unit where a file states none, in small letters."""


def as_spelt(text: str) -> str:
    """A unit as the problem file spells it; any other text without brackets and spaces."""
    plain = text.translate(_SPELT)
    return {"sec": "s", "gn": "g", "m/s/s": "m/s2"}.get(plain, plain)


def names_a_unit(text: str) -> bool:
    """Whether a text is a unit of any quantity, or of time."""
    unit = as_spelt(text)
    return unit in TIME_UNITS or any(unit in allowed for allowed in UNITS.values())


def check_stated(stated: Stated | None, key: str, given: str, quantity: str, allowed: Mapping[str, float]) -> None:
    """Refuse a file that states another quantity than the problem, or another unit than its `key`, which is `given`."""
    if stated is None:
        return
    if stated.quantity not in ("", quantity):
        raise ValueError(f"file: {stated.where} is of {stated.quantity}, and the problem asks for {quantity}")
    unit = as_spelt(stated.unit)
    if unit.lower() in _NO_UNIT or allowed.get(unit) == allowed[given] or not (stated.sure or names_a_unit(unit)):
        return
    settle = (
        f"set {key} = {shown(unit)}"
        if unit in allowed
        else f"is no unit of {quantity} ({', '.join(allowed)}); to read it nevertheless, skip the heading"
    )
    raise ValueError(f"{key} = {shown(given)}: {stated.where} of the file says {shown(stated.unit)}; {settle}")
