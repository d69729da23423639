"""Displacement and its derivatives in a motion by the scheme as published."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from analytic.march import field
from analytic.published.joint import PublishedJoint
from analytic.published.march import PublishedMarch
from lapjoint.answers import History
from lapjoint.problem import FloatArray


@dataclass(frozen=True, eq=False)
class PublishedField(field.ModalField):
    """z(x, t) of (20), segment by segment: the modes' part moves, the rest of G stands still."""

    motion: PublishedMarch

    def rest(self, part: field.TimesInState, x: FloatArray, t: FloatArray, dx: int, dt: int) -> FloatArray:
        """The x-derivative of order `dx` of the segments' frozen shapes, m^(1 - dx); 0 for time derivatives."""
        joint, total = self.joint, np.zeros((x.size, t.size))
        assert isinstance(joint, PublishedJoint)
        rest = self.motion.rest[part.which]
        for slot in joint.order[joint.order < rest.shape[1]] if dt == 0 else ():
            if rest[:, slot].any():
                shapes = joint.modal(joint.state_in(slot)).modes.shapes(x, dx)
                total += (rest[:, slot, : shapes.shape[0]] @ shapes).T
        return total


def history_of(name: str, motion: PublishedMarch) -> History:
    """A motion marched by a scheme called `name`, as a History."""
    return field.history_of(name, motion.joint, motion.log, PublishedField(motion.joint, motion.log, motion))
