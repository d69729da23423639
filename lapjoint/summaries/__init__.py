"""Summaries of a motion: peaks, root mean squares, contacts a second and their distributions.

A motion comes in stretches from either solver, and only sums are kept: an hour needs no more memory than a minute.
`collector` makes the sums, `intervals` says how certain they are, and `table` makes a dataset of them.  `of_orbit`
summarises a steady state, whose errors are numerical.
"""

from lapjoint.summaries.of_orbit import OrbitSummary, summarise

__all__ = ["OrbitSummary", "summarise"]
