"""What is read off a motion: peaks, root mean squares, contacts a second and their distributions.

Motions are taken stretch by stretch, whichever solver gave them, and only sums are kept: an hour needs no more memory
than a minute.  `collector` makes the sums, `intervals` says how certain they are, `table` makes a dataset of them, and
`of_orbit` does the same for a steady state, whose errors are numerical.
"""

from lapjoint.summaries.of_orbit import OrbitSummary, summarise

__all__ = ["OrbitSummary", "summarise"]
