"""The energy that damped stops take from the beam, and the parts of a contact, by quadrature of the force law."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from lapjoint.answers.history import Contact, History
from lapjoint.problem import FloatArray

OF_ENERGY = 1
"""Order of the time derivative as which an energy lost in a damped stop converges: that of the velocity in the damper's
force."""
NODES, WEIGHTS = np.polynomial.legendre.leggauss(8)
"""Gauss's rule of eight points, from -1 to 1."""
_SERIES = (np.polynomial.legendre.legvander(NODES, NODES.size - 1) * WEIGHTS[:, None]).T * (
    np.arange(NODES.size)[:, None] + 0.5
)
"""Legendre coefficients, by rows, of the polynomial through values at the nodes, by columns."""
_WITH_ENDS = np.concatenate([[-1.0], NODES, [1.0]])
_TURN = 1.5
"""Turn of the fastest mode in one panel, rad: the integrand turns twice as far, and eight nodes give twelve digits."""
_GROWTH = 1.5
"""Growth of panels after a switch, from the time of the fastest decay up to that of `_TURN`, when it is over."""
_AT_ONCE = 65536  # times evaluated at once, 0.5 MB for each stop


class Span(NamedTuple):
    """A contact, or a part of one."""

    start: float
    """First time, s."""
    end: float
    """Last time, s."""
    cut_start: bool
    """Whether the contact goes on before the first time."""
    cut_end: bool
    """Whether the contact goes on after the last time."""


def with_dissipation(history: History, fastest: float) -> History:
    """The motion with the energy that is lost in each contact of a damped stop, where it is not a number yet.

    `fastest`, 1/s, is the largest rate at which a part of the motion decays or turns.
    """
    contacts = list(history.contacts)
    if not any(math.isnan(contact.dissipated) for contact in contacts):
        return history
    for stop, it in enumerate(history.problem.structure.stops):
        which = [i for i, contact in enumerate(contacts) if contact.stop == stop and math.isnan(contact.dissipated)]
        if it.damping > 0 and which:
            spans = [Span(it.start, it.end, it.open_start, it.open_end) for it in (contacts[i] for i in which)]
            for i, lost in zip(which, energies_lost(history, stop, spans, fastest), strict=True):
                contacts[i] = replace(contacts[i], dissipated=lost)
    return replace(history, contacts=tuple(contacts))


def _panels(a: float, b: float, turning: float, fastest: float) -> FloatArray:
    """Edges of panels from a switch at `a` to `b`, s, short after the switch; the rates are in 1/s."""
    longest = min(_TURN / turning, b - a) if turning > 0 else b - a
    edges, width = [a], min(_TURN / fastest, longest) if fastest > 0 else longest
    while width < longest and edges[-1] + width < b:
        edges.append(edges[-1] + width)
        width *= _GROWTH
    return np.concatenate([edges[:-1], np.linspace(edges[-1], b, max(1, math.ceil((b - edges[-1]) / longest)) + 1)])


def energies_lost(history: History, stop: int, spans: Sequence[Span], fastest: float | None = None) -> list[float]:
    """The energy lost in each contact of one stop, or in a part of it, J.

    This is the integral of F d', less what the spring stores at a cut end, with what it stores at a cut start.
    `fastest` is as in `with_dissipation`, by default the rate of the fastest mode.
    """
    return _lost(history, stop, spans, _courses(history, stop, spans, fastest))


def taken(history: History) -> list[tuple[float, float]]:
    """Of each contact, what the stop has taken at its end and, at the most, before that, J.

    A stop without damping gives all back, and holds most when it is pressed hardest, F^2 / (2 k).  What a damped stop
    has taken is the integral of F d', of which the largest value stands where the polynomial through the nodes of a
    panel turns from positive to negative, or at an end of the contact.
    """
    found, stops = [(0.0, 0.0)] * len(history.contacts), history.problem.structure.stops
    for stop, it in enumerate(stops):
        which = [i for i, contact in enumerate(history.contacts) if contact.stop == stop]
        if it.damping == 0:
            for i in which:
                found[i] = 0.0, history.contacts[i].peak_force ** 2 / (2 * it.stiffness)
        elif which:
            mine = (history.contacts[i] for i in which)
            spans = [Span(one.start, one.end, one.open_start, one.open_end) for one in mine]
            for i, course in zip(which, _courses(history, stop, spans), strict=True):
                found[i] = _largest_integral(*course)
    return found


def _largest_integral(weights: FloatArray, force: FloatArray, rate: FloatArray) -> tuple[float, float]:
    """The integral of F d' along a course, and the largest one up to any moment of it, J; at least 0."""
    halves = weights.reshape(-1, NODES.size).sum(axis=1) / 2
    series = (force * rate).reshape(-1, NODES.size) @ _SERIES.T  # Legendre coefficients of the power in each panel
    until = np.cumsum(2 * halves * series[:, 0])
    sampled = series @ np.polynomial.legendre.legvander(_WITH_ENDS, NODES.size - 1).T
    most = max(float(until.max(initial=0.0)), 0.0)
    for i in np.flatnonzero(((sampled[:, :-1] > 0) & (sampled[:, 1:] <= 0)).any(axis=1)).tolist():
        roots = np.polynomial.legendre.legroots(series[i])
        s = roots.real[(np.abs(roots.imag) < 1e-9) & (np.abs(roots.real) < 1)]
        within = np.polynomial.legendre.legval(s, np.polynomial.legendre.legint(series[i], lbnd=-1))
        most = max(most, float((until[i] - 2 * halves[i] * series[i, 0] + halves[i] * within).max(initial=0.0)))
    return float(until[-1]), most


def received(history: History, repeats: bool) -> FloatArray:
    """The most that the stop has taken at any moment of each contact, J, shape (contacts,); 0 of a contact that began
    before the motion.  If the motion `repeats`, a contact that its end cuts goes on at its start."""
    energies = taken(history)
    begun = {c.stop: i for i, c in enumerate(history.contacts) if c.open_start}
    found = np.zeros(len(energies))
    for i, (contact, (whole, most)) in enumerate(zip(history.contacts, energies, strict=True)):
        if not contact.open_start:
            rest = begun.get(contact.stop) if repeats and contact.open_end else None
            found[i] = most if rest is None else max(most, whole + energies[rest][1])
    return found


def parts_of(history: History, contact: Contact, times: Sequence[float]) -> list[Contact]:
    """The parts of a contact between times within it, s, ascending; together they have its impulse and its energy.

    The longest part has what the others leave.  Where the sampled force is largest, the peak is that of the contact;
    elsewhere it is the largest force at the nodes of the quadrature and at the ends.
    """
    if not len(times):
        return [contact]
    spans = [
        Span(a, b, a > contact.start or contact.open_start, b < contact.end or contact.open_end)
        for a, b in pairwise([contact.start, *times, contact.end])
    ]
    it, courses = history.problem.stops[contact.stop], _courses(history, contact.stop, spans)
    sign = history.problem.structure.stops[contact.stop].sign
    impulse = [sign * float((weights * force).sum()) for weights, force, _ in courses]
    lost = _lost(history, contact.stop, spans, courses) if it.damping > 0 else [0.0] * len(spans)
    at_ends = np.abs(history.contact_force(np.array([contact.start, *times, contact.end]))[contact.stop])
    peak = [max(float(force.max()), *at_ends[i : i + 2]) for i, (_, force, _) in enumerate(courses)]
    longest = max(range(len(spans)), key=lambda i: spans[i].end - spans[i].start)
    impulse[longest] += contact.impulse - sum(impulse)
    lost[longest] += contact.dissipated - sum(lost)
    peak[int(np.argmax(peak))] = contact.peak_force
    return [
        replace(
            contact,
            start=span.start,
            end=span.end,
            open_start=span.cut_start,
            open_end=span.cut_end,
            impulse=impulse[i],
            peak_force=min(peak[i], contact.peak_force),
            dissipated=lost[i],
        )
        for i, span in enumerate(spans)
    ]


def _lost(history: History, stop: int, spans: Sequence[Span], courses: Sequence[FloatArray]) -> list[float]:
    """The energy lost along each of the spans, J, from the `courses` along them."""
    given = [float(course.prod(axis=0).sum()) for course in courses]
    return [lost - kept for lost, kept in zip(given, _kept(history, stop, spans), strict=True)]


def _courses(history: History, stop: int, spans: Sequence[Span], fastest: float | None = None) -> list[FloatArray]:
    """Weights, s, force, N, and rate of penetration, m/s, of a stop along each contact or part of one, each (3, n)."""
    it, turning = (
        history.problem.structure.stops[stop],
        max(history.highest_mode or 0.0, history.problem.forces.fastest),
    )
    times, weights, sizes, switches = [], [], [], history.switch_times
    sampled = history.problem.forces.sampled
    for start, end, *_ in spans:
        inside = switches[(switches > start) & (switches < end)]
        edges, knots = [np.zeros(0)], [force.knots_within(start, end) for force in sampled]
        begun = {start, *inside.tolist()}
        for a, b in pairwise(np.unique(np.concatenate([[*begun, end], *knots])).tolist()):
            panels = _panels(a, b, turning, (fastest or turning) if a in begun else turning)
            half, middle = np.diff(panels)[:, None] / 2, ((panels[:-1] + panels[1:]) / 2)[:, None]
            edges.append((middle + half * NODES).ravel())
            weights.append((half * WEIGHTS).ravel())
        times.append(np.concatenate(edges))
        sizes.append(times[-1].size)
    t, forces, rates = np.concatenate(times), [], []
    for part in np.split(t, range(_AT_ONCE, t.size, _AT_ONCE)):
        within = np.clip(part, history.start, history.end)
        d, rate = (it.sign * history.seen_by_stops(within, dt)[stop] for dt in (0, 1))
        forces.append(it.stiffness * (d - it.gap) + it.damping * rate)
        rates.append(rate)
    columns = np.array([np.concatenate(one) for one in (weights, forces, rates)])
    return np.split(columns, np.cumsum(sizes)[:-1], axis=1)


def _kept(history: History, stop: int, spans: Sequence[Span]) -> list[float]:
    """What the spring of a stop stores at the cut end of each span, less what it stores at a cut start, J."""
    ends = np.clip(np.array([(span.start, span.end) for span in spans]).ravel(), history.start, history.end)
    stored = history.problem.stops[stop].stiffness / 2 * history.penetration(ends)[stop] ** 2
    cuts = np.array([(-float(span.cut_start), float(span.cut_end)) for span in spans])
    return [float(kept) for kept in (stored.reshape(-1, 2) * cuts).sum(axis=1)]


def without_stored(history: History) -> History:
    """The motion with energies that were integrals of F d', less what a spring stores where a contact is cut."""
    contacts, stops = list(history.contacts), history.problem.structure.stops
    cut = [i for i, it in enumerate(contacts) if stops[it.stop].damping > 0 and (it.open_start or it.open_end)]
    if cut:
        ends = history.penetration(np.array([history.start, history.end]))
        stored = np.array([stop.stiffness for stop in stops])[:, None] / 2 * ends**2
        for i in cut:
            it = contacts[i]
            kept = it.open_end * stored[it.stop, 1] - it.open_start * stored[it.stop, 0]
            contacts[i] = replace(it, dissipated=it.dissipated - float(kept))
    return replace(history, contacts=tuple(contacts))
