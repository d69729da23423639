"""Where a resolution cannot tell whether the force of a damped stop ends and begins again.

While a damped stop stays closed its force may sink to almost nothing and rise again.  Whether the force ends in between
makes one contact of two, and changes their impulses at once by whole parts.  It is the sign of a least value of
k d + c d' that decides, and where this value is smaller than its own numerical error, the resolution does not decide.

An orbit is known in closed form between its switches, which gives every least value.  Any other motion is sampled.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from lapjoint.answers.history import History
from lapjoint.compiled.by_reference import in_c_order
from lapjoint.orbits.compiled_extrema import gap_extrema
from lapjoint.orbits.compiled_intervals import IndexArray, Stops
from lapjoint.orbits.newton import Orbit
from lapjoint.orbits.refinement import Refinement
from lapjoint.orbits.segments import Segments
from lapjoint.orbits.watch import awake_rows, motion_at, row_of, rows_of
from lapjoint.problem import FloatArray
from lapjoint.problem.supports_and_stops import PlacedStop

_SAMPLES = 128
"""Times at which the force is looked at between two of its switches.  What is lost in a shorter dip, 1/64 of a contact,
is found by the difference of the two motions alone."""


def undecided_breaks_of_orbit(orbit: Orbit, finer: Orbit, refinement: Refinement) -> FloatArray:
    """`undecided_breaks` of an orbit; `finer` is the orbit at the finer resolution, of as many half periods."""
    half_periods = orbit.last.half_periods
    stops = half_periods.map.problem.structure.stops
    gaps = np.array(_may_break(stops), dtype=np.intp)
    if not gaps.size:
        return np.zeros((2, 0))
    motions = Segments.of(orbit.last.linearised.segments), finer.last.linearised.motion
    rows = rows_of(stops)
    dips = [_dips(motion, stops, rows, gaps) for motion in motions]
    time, which = (np.concatenate(part) for part in zip(*dips, strict=True))
    inside = motions[0].closed[_segments_at(motions[0], time), gaps[which]]
    time, stop = time[inside], gaps[which[inside]]
    own, other = (_forces_of(motion, stops, stop, time) for motion in motions)
    uncertain = _uncertain(own, other, refinement)
    time, stop = time[uncertain], stop[uncertain]
    if orbit.symmetric:  # the other half of the motion is the mirror image
        half = orbit.half_periods * half_periods.map.period / 2
        time, stop = np.concatenate([time, time + half]), np.concatenate([stop, np.array(half_periods.twins)[stop]])
    order = np.lexsort((stop, time))
    return np.array([time[order], stop[order]])


def undecided_breaks(history: History, finer: History, refinement: Refinement) -> FloatArray:
    """Times at which a force may end and begin again, and the stop's index, shape ``(2, breaks)``, by time.

    `finer` is the motion at the finer resolution, at the same times.
    """
    stops = _may_break(history.problem.structure.stops)
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


def _may_break(stops: Sequence[PlacedStop]) -> list[int]:
    """The stops whose force may end before their gap opens."""
    return [k for k, stop in enumerate(stops) if stop.damping > 0 and not stop.may_pull]


def _dips(
    motion: Segments, stops: Sequence[PlacedStop], every: Stops, gaps: IndexArray
) -> tuple[FloatArray, IndexArray]:
    """Times, s, of the least values of the forces of the stops `gaps`, ``(R,)``, while these are closed, and the index
    of each among `gaps`, ``(m,)`` each; `every` has all rows of `rows_of`.

    A force has no least value where it begins or ends: where its own row or that of its gap switches.
    """
    rows = _force_rows(stops, gaps)
    forces = Stops._make(part[rows] for part in every)._replace(place=np.arange(rows.size))
    which, time, _, highest = gap_extrema(motion_at(motion, rows), in_c_order(forces))
    least = awake_rows(stops, motion.closed)[_segments_at(motion, time), rows[which]] & ~highest
    time, which = time[least], which[least]
    begins_or_ends = (motion.switched == rows[which, None]) | (motion.switched == gaps[which, None])
    within = ~(begins_or_ends & (motion.end == time[:, None])).any(axis=1)
    return time[within], which[within]


def _force_rows(stops: Sequence[PlacedStop], of: IndexArray) -> IndexArray:
    """The rows of `lapjoint.orbits.watch.rows_of` of the forces of some damped stops, ``(m,)``."""
    return np.array([row_of(stops, ~k) for k in of.tolist()], dtype=np.intp)


def _segments_at(motion: Segments, t: FloatArray) -> IndexArray:
    """The index of the segment at each time, s, ``(m,)``: where several begin, the last."""
    return np.maximum(np.searchsorted(motion.start, t, side="right") - 1, 0)


def _forces_of(motion: Segments, stops: Sequence[PlacedStop], stop: IndexArray, t: FloatArray) -> FloatArray:
    """k d + c d', N, of a stop at each time, s, ``(m,)`` each."""
    row, s = _force_rows(stops, stop), _segments_at(motion, t)
    tau = t - motion.start[s]
    waves = motion.amplitudes[s] * np.exp(motion.rates[s] * tau[:, None])
    z = (motion.weights[s, row] * waves).real.sum(axis=1)
    z += (motion.polynomial[s, row] * tau[:, None] ** np.arange(3)).sum(axis=1)
    sign, gap, k = (np.array([getattr(it, name) for it in stops])[stop] for name in ("sign", "gap", "stiffness"))
    return np.asarray(k * (sign * z - gap))


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
    uncertain = _uncertain(own, other, refinement)
    least = np.zeros(t.shape, dtype=bool)
    for force in (own, other):
        least[1:-1] |= (force[1:-1] <= force[:-2]) & (force[1:-1] <= force[2:])
    return [float(it) for it in t[least & uncertain]]


def _uncertain(own: FloatArray, other: FloatArray, refinement: Refinement) -> npt.NDArray[np.bool_]:
    """Whether the sign of each force, N, is uncertain, by the force of the finer motion at the same time."""
    apart = np.abs(own - other)
    return np.asarray(np.abs(own) <= refinement.bounds(apart, apart, dt=1))


def _forces(history: History, t: FloatArray) -> FloatArray:
    """k d + c d' of each stop, N, at times, s, ``(m,)``: shape ``(P, m)``."""
    stops = history.problem.structure.stops
    sign, gap, k, c = (
        np.array([getattr(stop, name) for stop in stops])[:, None] for name in ("sign", "gap", "stiffness", "damping")
    )
    d, rate = (sign * history.seen_by_stops(t, dt) for dt in (0, 1))
    return np.asarray(k * (d - gap) + c * rate)
