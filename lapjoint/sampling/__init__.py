"""Samples of uncertain numbers: where they lie, and what their answers show about bands, limits and sensitivities."""

from lapjoint.sampling.bands import bands
from lapjoint.sampling.sensitivity import sensitivities

__all__ = ["bands", "sensitivities"]
