"""Mesh, assembly by Hermite elements, and the natural frequencies and mode shapes of each contact state."""
