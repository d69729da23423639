"""Steady states over a grid of problems: what is asked, how each is found, and the table."""
