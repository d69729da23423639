"""Displacement and its derivatives in a motion by the scheme as published."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from analytic.march import Segment, contacts_of
from analytic.motion import ModalField
from analytic.published_march import PublishedJoint, PublishedMarch
from lapjoint.answers import History
from lapjoint.problem import FloatArray, Problem


@dataclass(frozen=True)
class PublishedField(ModalField):
    """z(x, t) of (20), segment by segment: the modes' part moves, the rest of G stands still."""

    motion: PublishedMarch

    def _segment(self, segment: Segment, x: FloatArray, t: FloatArray, dx: int, dt: int) -> FloatArray:
        model = self.joint.model(segment.state)
        moving = model.modes.shapes(x, dx).T @ self._coordinates(model, segment, t, dt)
        return np.asarray(moving + (self._frozen(segment, x, dx)[:, None] if dt == 0 else 0.0))

    def _frozen(self, segment: Segment, x: FloatArray, dx: int) -> FloatArray:
        """The frozen shape of a segment, or its dx-th derivative, m, shape ``(n,)``."""
        joint, total = self.joint, np.zeros(x.size)
        assert isinstance(joint, PublishedJoint)
        rest = self.motion.rest[int(np.searchsorted(self.motion.log.start, segment.start, side="right")) - 1]
        for slot in joint.frozen_tables.order:
            coefficients = rest[slot]
            if coefficients.any():
                shapes = joint.model(joint.state_in(slot)).modes.shapes(x, dx)
                total += coefficients[: shapes.shape[0]] @ shapes
        return total


def history_of(problem: Problem, name: str, motion: PublishedMarch) -> History:
    """A marched motion as the History that everybody reads."""
    assert isinstance(motion.joint, PublishedJoint)
    segments = motion.segments
    return History(
        problem=problem,
        solver=name,
        start=segments[0].start,
        end=segments[-1].end,
        switch_times=np.array([segment.start for segment in segments[1:]]),
        states=tuple(segment.state for segment in segments),
        contacts=contacts_of(motion),
        field=PublishedField(motion.joint, segments, motion),
    )
