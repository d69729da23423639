"""What a bifurcation of a branch of periodic motions is called."""

from __future__ import annotations

from typing import Literal

BifurcationKind = Literal["fold", "flip", "neimark-sacker", "symmetry breaking", "grazing"]
