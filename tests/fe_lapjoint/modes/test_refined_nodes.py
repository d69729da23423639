"""A finer mesh, by which errors are estimated, is finer everywhere and keeps its grading."""

from __future__ import annotations

import itertools

import numpy as np
import pytest

from fe_lapjoint.modes.mesh import mesh_nodes, refined_nodes
from lapjoint import paper_joint


@pytest.mark.parametrize("elements", [1, 7, 40])
@pytest.mark.parametrize("ratio", [4 / 3, 1.5, 2.0])
def test_every_stretch_gets_at_least_as_many_times_the_elements(elements: int, ratio: float) -> None:
    joint = paper_joint()
    moved = joint.replace(
        stops=tuple(stop.model_copy(update={"x": 0.37 * stop.x}) if stop.x < 1 else stop for stop in joint.stops)
    )
    nodes = mesh_nodes(moved, elements, None)
    finer = refined_nodes(moved, nodes, ratio)
    required = sorted({0.0, moved.beam.length, *(stop.x for stop in moved.stops)})
    for a, b in itertools.pairwise(required):
        assert {a, b} <= set(finer.tolist())
        counts = [np.count_nonzero((a < these) & (these < b)) + 1 for these in (nodes, finer)]
        assert counts[0] * ratio - 1e-6 <= counts[1] < counts[0] * ratio + 1
    assert np.all(np.diff(finer) > 0)


def test_a_graded_mesh_keeps_its_grading() -> None:
    joint = paper_joint()
    graded = joint.beam.length * np.linspace(0, 1, 21) ** 2
    nodes = mesh_nodes(joint, 40, tuple(graded.tolist()))
    finer = refined_nodes(joint, nodes, 1.5)
    assert np.diff(finer).min() == pytest.approx(np.diff(nodes).min(), rel=0.4)
    assert np.diff(finer).max() < np.diff(nodes).max() * 1.001


def test_a_very_short_stretch_stays_one_element() -> None:
    joint = paper_joint()
    L = joint.beam.length
    close = joint.replace(stops=(joint.stops[0].model_copy(update={"x": L * (1 - 5e-4)}), *joint.stops[1:]))
    nodes = mesh_nodes(close, 10, None)
    assert refined_nodes(close, nodes, 1.5)[-2] == nodes[-2]
