"""Branches of periodic motions with a fixed contact sequence: curves, their events and their bifurcations.

`boundary_problem` has the equations, `newton` solves them, and `continuation` follows their solutions.
`sequence_changes` says where a contact sequence ceases to fit and what comes after, `bifurcations` what the multipliers
do on the way, and `halves` where motions of twice the length spring.  `starts` makes a curve's first point of a march,
`tracing` a whole branch of a start, `errors` locates what was found at finer resolutions, and `confirmation` by another
solver.
"""
