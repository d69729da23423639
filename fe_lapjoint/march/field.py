"""Displacement and its derivatives anywhere in a marched motion, from the Hermite elements."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from fe_lapjoint.march.march import March, Piece
from fe_lapjoint.march.model import Model
from fe_lapjoint.march.system import Coordinates
from lapjoint.answers import Contact, History
from lapjoint.answers.contact_state import ContactState
from lapjoint.answers.dissipation import with_dissipation, without_stored
from lapjoint.problem import FloatArray


@dataclass(frozen=True)
class ElementField:
    """z(x, t), m, of the finite element solution; see `lapjoint.answers.Field`."""

    model: Model
    pieces: tuple[Piece, ...]
    """The motion, without gaps in time."""

    def __call__(self, x: FloatArray, t: FloatArray, dx: int = 0, dt: int = 0) -> FloatArray:
        """The `dx`-th x- and `dt`-th t-derivative of z: ``x``, shape ``(n,)``, and ``t``, ``(m,)``, give ``(n, m)``."""
        rows = self.model.assembly.shapes(x, dx)
        starts = np.array([piece.start for piece in self.pieces])
        which = np.maximum(np.searchsorted(starts, t, side="right") - 1, 0)
        result = np.empty((x.size, t.size))
        shapes: dict[ContactState, FloatArray] = {}
        for i in np.unique(which):
            here, piece = which == i, self.pieces[i]
            modes = shapes.get(piece.state)
            if modes is None:
                modes = shapes[piece.state] = rows @ self.model.system(piece.state).vectors
            result[:, here] = modes @ piece.coordinates(t[here], dt)
        return result


@dataclass(frozen=True, slots=True)
class Later:
    """Coordinates of a piece in the time of the whole motion; the piece's own march counts time from 0."""

    coordinates: Coordinates
    offset: float
    """When that march starts in the whole motion, s."""

    def __call__(self, t: FloatArray, dt: int = 0) -> FloatArray:
        """The `dt`-th derivative of the modal displacements at times ``(m,)`` of the whole motion, shape ``(n, m)``."""
        return self.coordinates(t - self.offset, dt)


def history_of(name: str, model: Model, motions: Sequence[March], period: float, first: int = 0) -> History:
    """One History of recorded marches that follow each other.

    Each march counts time from 0, and begins `period` seconds after the one before it.  `first` is the number of
    marches before the first one given.
    """
    pieces = [_later(piece, i * period) for i, motion in enumerate(motions, first) for piece in motion.pieces]
    switches = [i for i, piece in enumerate(pieces) if piece.switched >= 0 and i + 1 < len(pieces)]
    states = [pieces[0].state, *(pieces[i + 1].state for i in switches)]
    made = History(
        problem=model.problem,
        solver=name,
        start=pieces[0].start,
        end=pieces[-1].end,
        switch_times=np.array([pieces[i].end for i in switches]),
        states=tuple(states),
        contacts=_joined(motions, period, first),
        field=ElementField(model, tuple(pieces)),
        highest_mode=max(float(np.max(model.system(state).omega)) for state in {piece.state for piece in pieces}),
    )
    fastest = max(float(model.system(state).moduli.max(initial=0.0)) for state in set(states))
    return with_dissipation(without_stored(made), fastest)


def _later(piece: Piece, offset: float) -> Piece:
    if not offset:
        return piece
    start, end = piece.start + offset, piece.end + offset
    return replace(piece, start=start, end=end, coordinates=Later(piece.coordinates, offset))


def _joined(motions: Sequence[March], period: float, first: int) -> tuple[Contact, ...]:
    """All contacts, by start time; a contact that lasts from one march into the next is one contact."""
    done: list[Contact] = []
    going: dict[int, Contact] = {}
    for i, motion in enumerate(motions, first):
        for contact in motion.contacts:
            contact = replace(contact, start=contact.start + i * period, end=contact.end + i * period)
            before = going.pop(contact.stop, None) if contact.open_start else None
            if before is not None:
                contact = replace(
                    before,
                    end=contact.end,
                    impulse=before.impulse + contact.impulse,
                    peak_force=max(before.peak_force, contact.peak_force),
                    dissipated=before.dissipated + contact.dissipated,
                    open_end=contact.open_end,
                )
            if contact.open_end:
                going[contact.stop] = contact
            else:
                done.append(contact)
    return tuple(sorted([*done, *going.values()], key=lambda contact: (contact.start, contact.stop)))
