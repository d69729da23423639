"""Branches of periodic motions with a fixed contact sequence: curves, their events and their bifurcations.

`boundary_problem` has the equations, `continuation` follows their solutions, `monitors` says what changes on the way,
and `events` how the contact sequence does.
"""
