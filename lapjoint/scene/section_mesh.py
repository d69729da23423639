"""Meshes of cross-sections: points (y, zeta) about the centroid, and quadrilaterals between them.

zeta is the height above the axis, and y completes (x, y, zeta) to a right-handed frame.  Curved outlines are polygons
whose corners lie on the true outline.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lapjoint.problem import FloatArray
from lapjoint.problem.beam import Circle, Rectangle, Section, Tube

IntArray = NDArray[np.int64]
CORNERS = 48
"""Number of corners of the polygon that replaces a circle; the area of the polygon is smaller by 0.3 %."""


class SectionMesh(NamedTuple):
    """The mesh of a cross-section."""

    points: FloatArray
    """Coordinates (y, zeta), m, shape ``(n, 2)``."""
    quads: IntArray
    """Indices of the corners of each quadrilateral, counter-clockwise about x, shape ``(quads, 4)``."""


def section_mesh(section: Section) -> SectionMesh:
    """The mesh of a cross-section; in a solid one, a line of points lies on the neutral axis."""
    if isinstance(section, Rectangle):
        return _grid(section.breadth / 2 * np.array([-1.0, 1.0]), section.height / 2 * np.array([-1.0, 0.0, 1.0]))
    if isinstance(section, Circle):
        return _disc(section.diameter / 2)
    assert isinstance(section, Tube)
    return _ring(section.inner_diameter / 2, section.outer_diameter / 2)


def _grid(y: FloatArray, z: FloatArray) -> SectionMesh:
    points = np.array([(a, b) for b in z for a in y])
    corner = (np.arange(y.size - 1)[None, :] + y.size * np.arange(z.size - 1)[:, None]).ravel()
    return SectionMesh(points, np.column_stack([corner, corner + 1, corner + 1 + y.size, corner + y.size]))


def _disc(radius: float) -> SectionMesh:
    """A square grid whose concentric squares are mapped to circles, with equal angles between the corners."""
    cells = CORNERS // 4
    along = np.linspace(-1.0, 1.0, cells + 1)
    square = _grid(along, along)
    u, v = square.points.T
    size = np.maximum(np.abs(u), np.abs(v))
    with np.errstate(divide="ignore", invalid="ignore"):
        angle = np.where(np.abs(u) >= np.abs(v), np.pi / 4 * v / u, np.pi / 2 - np.pi / 4 * u / v)
        angle = np.where(size > 0, np.where(np.where(np.abs(u) >= np.abs(v), u, v) < 0, angle + np.pi, angle), 0.0)
    return SectionMesh(radius * size[:, None] * np.column_stack([np.cos(angle), np.sin(angle)]), square.quads)


def _ring(inner: float, outer: float) -> SectionMesh:
    angle = 2 * np.pi * np.arange(CORNERS) / CORNERS
    unit = np.column_stack([np.cos(angle), np.sin(angle)])
    here = np.arange(CORNERS)
    after = (here + 1) % CORNERS
    quads = np.column_stack([here, here + CORNERS, after + CORNERS, after])
    return SectionMesh(np.concatenate([inner * unit, outer * unit]), quads)
