"""How a motion is shown: what colours the beam, at which scale, from where."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal, get_args

from lapjoint.errors import InputError

Colour = Literal["stress", "velocity", "moment", "displacement"]
Frame = Literal["relative", "absolute"]
LEAST_PIXELS, MOST_PIXELS = 200, 8192


@dataclass(frozen=True)
class Look:
    """How a motion is shown."""

    colour: Colour | None = None
    """What colours the beam: ``stress`` (the default where the problem gives a section), ``velocity``, ``moment`` or
    ``displacement``."""
    scale: float | None = None
    """Factor of all displacements and gaps, 1 for true scale; by default what makes them visible: 1, 2 or 5 times a
    power of ten, never less than 1.  The picture states it."""
    frame: Frame = "relative"
    """``relative`` to the base, or ``absolute``."""
    size: tuple[int, int] | None = None
    """Width and height, pixels; by default 1200 by 520, films 900 by 400."""

    def __post_init__(self) -> None:
        for name, value, allowed in (("colour", self.colour, get_args(Colour)), ("frame", self.frame, get_args(Frame))):
            if value is not None and value not in allowed:
                raise InputError(f"{name} = {value!r}: allowed are {', '.join(allowed)}")
        if self.scale is not None and not 0 < self.scale < math.inf:
            raise InputError(f"scale = {self.scale:g}: must be positive and finite; 1 is true scale")
        if self.size is not None and not (
            len(self.size) == 2
            and all(isinstance(pixels, int) and LEAST_PIXELS <= pixels <= MOST_PIXELS for pixels in self.size)
        ):
            shown = "x".join(str(pixels) for pixels in self.size)
            raise InputError(f"size = {shown}: allowed are {LEAST_PIXELS} to {MOST_PIXELS} pixels each way")
