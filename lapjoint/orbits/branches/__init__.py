"""Branches of periodic motions with a fixed contact sequence: curves, their events and their bifurcations.

`boundary_problem` has the equations, `newton` solves them, and `continuation` follows their solutions.
`sequence_changes` finds where a contact sequence ceases to fit, and the sequence that follows.  `bifurcations` finds
where multipliers pass the unit circle, and `halves` where motions of twice the length begin.  `starts` makes the first
point of a curve from a march, and `tracing` a whole branch from a start.  `errors` locates bifurcations again at finer
resolutions, and `confirmation` by another solver.
"""
