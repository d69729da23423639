"""Where a resolution cannot tell whether the force of a damped stop ends and begins again.

While a damped stop stays closed its force may sink to almost nothing and rise again.  Whether the force ends in between
makes one contact of two, and changes their impulses at once by whole parts.  It is the sign of a least value of
k d + c d' that decides, and where this value is smaller than its own numerical error, the resolution does not decide.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from lapjoint.answers.history import History
from lapjoint.orbits.refinement import Refinement
from lapjoint.problem import FloatArray

_SAMPLES = 128
"""Times at which the force is looked at between two of its switches.  What is lost in a shorter dip, 1/64 of a contact,
is found by the difference of the two motions alone."""


def undecided_breaks(history: History, finer: History, refinement: Refinement) -> FloatArray:
    """Times at which a force may end and begin again, and the stop's index, shape ``(2, breaks)``, by time.

    `finer` is the motion at the finer resolution, at the same times.
    """
    stops = [k for k, stop in enumerate(history.problem.structure.stops) if stop.damping > 0 and not stop.may_pull]
    times = [_times(history, k) for k in stops]
    found, at = [], np.cumsum([0, *(t.size for t in times)])
    if at[-1]:
        every = np.concatenate([t.ravel() for t in times])
        forces = [_forces(motion, every) for motion in (history, finer)]
        for i, (k, t) in enumerate(zip(stops, times, strict=True)):
            own, other = (force[k, at[i] : at[i + 1]].reshape(t.shape) for force in forces)
            found += [(moment, float(k)) for moment in _breaks(t, own, other, refinement)]
    return np.array(sorted(found)).reshape(-1, 2).T


def cut(history: History, breaks: FloatArray) -> npt.NDArray[np.bool_]:
    """Whether each contact has an undecided break within it, at its start, or at its end; shape ``(3, contacts)``.

    A break while the force is 0 is at the end of the contact before, and at the start of the contact after.
    """
    found = np.zeros((3, len(history.contacts)), dtype=bool)
    for k in {contact.stop for contact in history.contacts} & set(breaks[1].astype(int).tolist()):
        own = [i for i, contact in enumerate(history.contacts) if contact.stop == k]
        ends = np.array([history.contacts[i].end for i in own])
        for t in breaks[0, breaks[1] == k].tolist():
            after = int(np.searchsorted(ends, t))
            if after < len(own) and history.contacts[own[after]].start <= t:
                found[0, own[after]] = True
                continue
            if after < len(own):
                found[1, own[after]] = True
            if after:
                found[2, own[after - 1]] = True
    return found


def _times(history: History, stop: int) -> FloatArray:
    """Times between two switches of the force of a stop while it is closed, s, one column each: ``(S, pieces)``."""
    closed = np.array([stop in state for state in history.states])
    released = np.array([stop in state.released for state in history.states])
    switched = (np.diff(closed) | np.diff(released)).astype(bool)
    edges = np.concatenate([[history.start], history.switch_times[switched], [history.end]])
    edges = edges[np.diff(edges, append=np.inf) > 0]
    inside = closed[np.searchsorted(history.switch_times, edges[:-1], side="right")]
    return np.asarray((edges[:-1] + np.arange(_SAMPLES)[:, None] / _SAMPLES * np.diff(edges))[:, inside])


def _breaks(t: FloatArray, own: FloatArray, other: FloatArray, refinement: Refinement) -> list[float]:
    """Times of least values of which the sign is not certain, s, of two motions' forces, N; all ``(S, pieces)``."""
    apart = np.abs(own - other)
    uncertain = np.abs(own) <= refinement.bounds(apart, apart, dt=1)
    least = np.zeros(t.shape, dtype=bool)
    for force in (own, other):
        least[1:-1] |= (force[1:-1] <= force[:-2]) & (force[1:-1] <= force[2:])
    return [float(it) for it in t[least & uncertain]]


def _forces(history: History, t: FloatArray) -> FloatArray:
    """k d + c d' of each stop, N, at times, s, ``(m,)``: shape ``(P, m)``."""
    stops = history.problem.structure.stops
    sign, gap, k, c = (
        np.array([getattr(stop, name) for stop in stops])[:, None] for name in ("sign", "gap", "stiffness", "damping")
    )
    d, rate = (sign * history.seen_by_stops(t, dt) for dt in (0, 1))
    return np.asarray(k * (d - gap) + c * rate)
