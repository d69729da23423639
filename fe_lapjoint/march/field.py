"""Displacement and its derivatives anywhere in a marched motion, from the Hermite elements."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fe_lapjoint.march.march import March, Piece
from fe_lapjoint.march.model import Model
from lapjoint.answers import History
from lapjoint.problem import FloatArray


@dataclass(frozen=True)
class ElementField:
    """z(x, t) of the finite element solution; see `lapjoint.answers.Field`."""

    model: Model
    pieces: tuple[Piece, ...]

    def __call__(self, x: FloatArray, t: FloatArray, dx: int = 0, dt: int = 0) -> FloatArray:
        """The `dx`-th x-derivative of the `dt`-th t-derivative of z, shape ``(n, m)``."""
        rows = self.model.assembly.shapes(x, dx)
        starts = np.array([piece.start for piece in self.pieces])
        which = np.maximum(np.searchsorted(starts, t, side="right") - 1, 0)
        result = np.empty((x.size, t.size))
        for i in np.unique(which):
            here, piece = which == i, self.pieces[i]
            modes = rows @ self.model.system(piece.state).vectors
            result[:, here] = modes @ piece.coordinates(t[here], dt)
        return result


def history_of(name: str, model: Model, motion: March) -> History:
    """A marched motion as the History that everybody reads."""
    pieces = motion.pieces
    switches = [i for i, piece in enumerate(pieces[:-1]) if piece.switched >= 0]
    states = [pieces[0].state, *(pieces[i + 1].state for i in switches)]
    return History(
        problem=model.problem,
        solver=name,
        start=pieces[0].start,
        end=pieces[-1].end,
        switch_times=np.array([pieces[i].end for i in switches]),
        states=tuple(states),
        contacts=motion.contacts,
        field=ElementField(model, pieces),
    )
