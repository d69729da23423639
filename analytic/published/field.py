"""Displacement and its derivatives in a motion by the scheme as published."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from analytic.march import field
from analytic.march.march import Segment
from analytic.published.joint import PublishedJoint
from analytic.published.march import PublishedMarch
from lapjoint.answers import History
from lapjoint.problem import FloatArray


@dataclass(frozen=True)
class PublishedField(field.ModalField):
    """z(x, t) of (20), segment by segment: the modes' part moves, the rest of G stands still."""

    motion: PublishedMarch

    def _segment(self, segment: Segment, x: FloatArray, t: FloatArray, dx: int, dt: int) -> FloatArray:
        """z or a derivative of it within one segment, shape ``(n, m)``."""
        moving = self.joint.modal(segment.state).modes.shapes(x, dx).T @ self._coordinates(segment, t, dt)
        return np.asarray(moving + (self._frozen(segment, x, dx)[:, None] if dt == 0 else 0.0))

    def _frozen(self, segment: Segment, x: FloatArray, dx: int) -> FloatArray:
        """The frozen shape of a segment, or its dx-th derivative, m, shape ``(n,)``."""
        joint, total = self.joint, np.zeros(x.size)
        assert isinstance(joint, PublishedJoint)
        rest = self.motion.rest[int(np.searchsorted(self.motion.log.start, segment.start, side="right")) - 1]
        for slot in joint.order[joint.order < rest.shape[0]]:
            coefficients = rest[slot]
            if coefficients.any():
                shapes = joint.modal(joint.state_in(slot)).modes.shapes(x, dx)
                total += coefficients[: shapes.shape[0]] @ shapes
        return total


def history_of(name: str, motion: PublishedMarch) -> History:
    """A marched motion as a History.

    Parameters
    ----------
    name : str
        Name and options of the scheme.
    motion : PublishedMarch
        The motion.

    Returns
    -------
    History
        The motion with its contacts.
    """
    return field.history_of(name, motion, PublishedField(motion.joint, motion.segments, motion))
