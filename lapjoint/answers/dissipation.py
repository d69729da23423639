"""The energy that damped stops take from the beam, by quadrature of the force law along the motion."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise

import numpy as np

from lapjoint.answers.history import Contact, History
from lapjoint.problem import FloatArray

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(8)
_TURN = 1.5
"""Turn of the fastest mode in one panel, rad: the integrand turns twice as far, and eight nodes give twelve digits."""
_GROWTH = 1.5
"""Growth of panels after a switch, from the time of the fastest decay up to that of `_TURN`, when it is over."""
_AT_ONCE = 65536  # times evaluated at once, 0.5 MB for each stop


def with_dissipation(history: History, fastest: float) -> History:
    """The motion with the energy that is lost in each contact of a damped stop.

    `fastest`, 1/s, is the largest rate at which a part of the motion decays or turns.
    """
    contacts = list(history.contacts)
    for stop, it in enumerate(history.problem.stops):
        which = [i for i, contact in enumerate(contacts) if contact.stop == stop]
        if it.damping > 0 and which:
            for i, lost in zip(which, _lost(history, stop, [contacts[i] for i in which], fastest), strict=True):
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


def _lost(history: History, stop: int, contacts: Sequence[Contact], fastest: float) -> list[float]:
    """The integral of F d' over each contact of one stop, J."""
    it, turning = history.problem.stops[stop], max(history.highest_mode or 0.0, history.problem.forces.fastest)
    times, weights, sizes = [], [], []
    sampled = history.problem.forces.sampled
    for contact in contacts:
        inside = history.switch_times[(history.switch_times > contact.start) & (history.switch_times < contact.end)]
        edges, knots = [np.zeros(0)], [force.knots_within(contact.start, contact.end) for force in sampled]
        begun = {contact.start, *inside.tolist()}
        for a, b in pairwise(np.unique(np.concatenate([[*begun, contact.end], *knots])).tolist()):
            panels = _panels(a, b, turning, fastest if a in begun else turning)
            half, middle = np.diff(panels)[:, None] / 2, ((panels[:-1] + panels[1:]) / 2)[:, None]
            edges.append((middle + half * _NODES).ravel())
            weights.append((half * _WEIGHTS).ravel())
        times.append(np.concatenate(edges))
        sizes.append(times[-1].size)
    t, rates = np.concatenate(times), []
    for part in np.split(t, range(_AT_ONCE, t.size, _AT_ONCE)):
        within = np.clip(part, history.start, history.end)
        d, rate = (it.sign * history.seen_by_stops(within, dt)[stop] for dt in (0, 1))
        force = it.stiffness * (d - it.gap) + it.damping * rate
        rates.append((force if it.may_pull else np.maximum(force, 0.0)) * rate)
    power = np.concatenate(weights) * np.concatenate(rates)
    return [float(part.sum()) for part in np.split(power, np.cumsum(sizes)[:-1])]
