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

    def _rest(self, part: field.Part, x: FloatArray, t: FloatArray, dx: int, dt: int) -> FloatArray:
        """The frozen shapes of the segments, or their dx-th derivative, m; nothing if they are asked how they move."""
        joint, total = self.joint, np.zeros((x.size, t.size))
        assert isinstance(joint, PublishedJoint)
        rest = self.motion.rest[part.which]
        for slot in joint.order[joint.order < rest.shape[1]] if dt == 0 else ():
            if rest[:, slot].any():
                shapes = joint.modal(joint.state_in(slot)).modes.shapes(x, dx)
                total += (rest[:, slot, : shapes.shape[0]] @ shapes).T
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
    return field.history_of(name, motion.joint, motion.log, PublishedField(motion.joint, motion.log, motion))
