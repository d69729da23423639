"""Solvers of others as witnesses: OpenSees, run in a process of its own."""
