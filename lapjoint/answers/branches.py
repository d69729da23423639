"""Names of the bifurcations of branches of periodic motions."""

from __future__ import annotations

from typing import Literal

BifurcationKind = Literal["fold", "flip", "neimark-sacker", "symmetry breaking", "grazing"]
