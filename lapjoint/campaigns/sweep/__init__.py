"""Steady states over a grid of problems: the plan, how each is found, and the table."""
