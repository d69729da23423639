"""From what OpenSees recorded to a History: cubic Hermite interpolation along the beam and in time.

Elements and steps both give a value and a derivative at each end, so both interpolations are of the order of the
records.  Contacts lie where the interpolated displacement of a stop crosses its gap.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.interpolate import CubicHermiteSpline

from lapjoint.answers import Contact, History
from lapjoint.answers.contact_state import ContactState
from lapjoint.problem import FloatArray, Problem
from validation.peers.opensees_script import Record


def along(nodes: FloatArray, values: FloatArray, x: FloatArray, derivative: int) -> FloatArray:
    """Displacement, m, or its x-derivative of order 0 to 3 at `x` (m, shape (n,)), shape (n, m), from nodal
    displacements, m, and slopes, rad, `values` of shape (k, 2, m) at `nodes` (m, shape (k,))."""
    # The third derivative jumps at nodes, where the left one is meant.
    at = np.maximum(np.nextafter(x, -np.inf), nodes[0]) if derivative == 3 else x
    return np.asarray(CubicHermiteSpline(nodes, values[:, 0], values[:, 1])(at, derivative))


@dataclass(frozen=True)
class RecordedField:
    """z(x, t) of a record; see `lapjoint.answers.Field`."""

    nodes: FloatArray
    in_time: CubicHermiteSpline
    """Displacements and slopes of all nodes, ``(n, 2)``, over time."""

    def __call__(self, x: FloatArray, t: FloatArray, dx: int = 0, dt: int = 0) -> FloatArray:
        """The `dx`-th x-derivative of the `dt`-th t-derivative of z, shape ``(n, m)``."""
        return along(self.nodes, np.moveaxis(self.in_time(t, dt), 0, -1), x, dx)


def contacts_of(problem: Problem, stop: int, record: Record) -> list[Contact]:
    """The contacts of one stop."""
    this, start, end = problem.structure.stops[stop], record.times[0], record.times[-1]
    node = int(np.argmin(np.abs(record.nodes - this.x)))
    beyond = CubicHermiteSpline(
        record.times, this.sign * record.values[:, node, 0] - this.gap, this.sign * record.rates[:, node, 0]
    )
    switches = beyond.roots(extrapolate=False)
    edges = np.unique([start, *switches[np.isfinite(switches)], end])
    area, tops = beyond.antiderivative(), beyond.derivative().roots(extrapolate=False)
    found: list[Contact] = []
    for a, b in zip(edges[:-1].tolist(), edges[1:].tolist(), strict=True):
        inside = tops[(tops > a) & (tops < b)]
        depth = float(np.max(beyond(np.array([a, (a + b) / 2, b, *inside]))))
        if beyond((a + b) / 2) > 0:
            impulse = this.sign * this.stiffness * float(area(b) - area(a))
            found.append(Contact(stop, a, b, impulse, this.stiffness * depth, a == start, b == end))
    return found


def history_of(problem: Problem, name: str, record: Record) -> History:
    """A record as a History."""
    stops = range(len(problem.stops))
    contacts = sorted((c for k in stops for c in contacts_of(problem, k, record)), key=lambda c: c.start)
    switches = sorted(
        [(c.start, c.stop) for c in contacts if not c.open_start]
        + [(c.end, c.stop) for c in contacts if not c.open_end]
    )
    states = [ContactState(tuple(c.stop for c in contacts if c.open_start))]
    for _, stop in switches:
        states.append(states[-1].toggled(stop))
    return History(
        problem=problem,
        solver=name,
        start=float(record.times[0]),
        end=float(record.times[-1]),
        switch_times=np.array([t for t, _ in switches]),
        states=tuple(states),
        contacts=tuple(contacts),
        field=RecordedField(record.nodes, CubicHermiteSpline(record.times, record.values, record.rates)),
    )
