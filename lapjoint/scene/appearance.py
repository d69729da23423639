"""The options of pictures and films: the colours of the beam, the scale, the frame of reference, and the size."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal, get_args

from lapjoint.errors import InputError

Colour = Literal["stress", "velocity", "moment", "displacement"]
Frame = Literal["relative", "absolute"]
LEAST_PIXELS, MOST_PIXELS = 200, 8192
"""Least and largest width and height, pixels: the text needs the least, and graphics memory holds the largest."""


@dataclass(frozen=True)
class Look:
    """The appearance of a picture, a film or a window.

    Raises
    ------
    InputError
        If an option is not an allowed one, or out of its range.
    """

    colour: Colour | None = None
    """Value that colours the beam: ``stress``, ``velocity``, ``moment`` or ``displacement``.  By default it is
    ``stress`` if the problem gives a cross-section, else ``moment``."""
    scale: float | None = None
    """Factor on all displacements and gaps, 1 for true scale.  By default displacements become visible: the factor is
    1, 2 or 5 times a power of ten, and at least 1.  The picture states the factor."""
    frame: Frame = "relative"
    """Frame of reference: displacements ``relative`` to the base, or ``absolute`` ones."""
    size: tuple[int, int] | None = None
    """Width and height, pixels; by default 1200 by 520 for a picture or window, 900 by 400 for a film."""

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
