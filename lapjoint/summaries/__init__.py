"""Summaries of a motion: peaks, root mean squares, contacts a second and their distributions.

Either solver gives a long motion in stretches, of which only sums are kept: an hour needs no more memory than a minute.
`collector` computes the sums, `intervals` their uncertainty, and `table` a dataset of both.  `of_orbit` summarises a
steady state, and estimates the numerical errors of its summary.
"""

from lapjoint.summaries.of_orbit import OrbitSummary, summarise

__all__ = ["OrbitSummary", "summarise"]
