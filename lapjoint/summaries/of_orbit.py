"""Peaks, root mean squares, contact times and dissipated powers of a steady state, with their numerical errors.

A periodic motion is sampled over one period, by Gauss's rule on short parts between consecutive switches, `PER_PERIOD`
samples in a period of the fastest mode but at most `MOST` in all, and again around the largest samples.  Errors follow
from the summary of the motion at a finer resolution, see `lapjoint.orbits.refinement`.

For a motion that does not repeat, `WANDERING` excitation periods are summarised, from the point at which it was
accepted.  The error of a mean or a root mean square is the standard error of the mean over these periods, which allows
for the correlation from period to period.  No error of a peak can be stated, because a peak grows with the length of
the motion.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from lapjoint.answers.dissipation import OF_ENERGY, received
from lapjoint.answers.history import History
from lapjoint.answers.powers import input_power
from lapjoint.answers.quantities import QUANTITIES
from lapjoint.answers.shown import Shown
from lapjoint.answers.steady_state import SteadyState
from lapjoint.errors import InputError
from lapjoint.problem import FloatArray, Problem
from lapjoint.problem.supports_and_stops import forces_at_gaps
from lapjoint.summaries.correlated_series import standard_error
from lapjoint.summaries.fatigue_of_orbit import OF_FATIGUE, FatigueSummary, fatigue_of_orbit, fatigue_of_wandering
from lapjoint.summaries.quantities import IndexArray, Selection, is_rounding, keep_largest, selection

MOST = 1 << 15
"""Largest number of samples of a motion."""
FINER = 1.5
"""Factor on `MOST` for the finer motion, so that the difference also shows the error of too few samples."""
WANDERING = 128
"""Number of excitation periods over which a motion that does not repeat is summarised: twice the number that a standard
error needs."""
PER_PERIOD = 8.0
"""Samples in a period of the fastest mode, up to `MOST` in all: enough for Gauss's rule of four points."""
_FINE = 16
"""Number of times on either side of the largest sample, up to its neighbour, at which the peak is searched."""
_AT_ONCE = 4096
"""Largest number of times that are evaluated at once, to limit the memory."""
_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(4)
OF_STOPS = {
    "force_peak": ("N", "largest force of the stop, its magnitude"),
    "force_rms": ("N", "root mean square of the force of the stop"),
    "contact_time": ("1", "share of time in contact"),
    "contact_rate": ("s-1", "contacts a second"),
    "received_power": ("W", "energy that the stop takes a second, to keep or to give back: of each contact the most"),
    "dissipated_power": ("W", "energy that the stop takes and keeps a second"),
}
"""Values of each stop: unit and meaning."""
OF_ALL = {
    "dissipated_power_total": ("W", "energy that all stops take and keep a second"),
    "input_power": ("W", "energy that the excitation gives a second"),
    "damping_power": ("W", "energy that the damping of beams and links takes a second: what the stops leave"),
}
"""Values of all stops together: unit and meaning."""
_OF_INPUT = ("input_power", "damping_power")
"""Values that need the power of the excitation."""
_KINDS = {"peak": "largest magnitude", "rms": "root mean square"}
ALONG = {
    f"{name}_{kind}": (one.units, f"{text} of the {one.text}")
    for name, one in QUANTITIES.items()
    for kind, text in _KINDS.items()
} | OF_FATIGUE
"""Values of each place along the beam: unit and meaning."""
SUMMARIES = (*ALONG, *OF_STOPS, *OF_ALL)
"""Names of all values of a summary."""


@dataclass(frozen=True, repr=False)
class OrbitSummary(Shown):
    """Peaks, root mean squares and contact times of a steady state."""

    selection: Selection
    """Quantities and places."""
    values: dict[str, FloatArray]
    """By name: ``<quantity>_peak`` and ``<quantity>_rms``, shape ``(X,)``, in the quantity's unit; `OF_STOPS`,
    ``(S,)``; `OF_ALL`, ``(1,)``."""
    errors: dict[str, FloatArray] | None
    """Estimates of the numerical errors of `values`; infinite where no error can be stated, None if none were
    estimated."""
    fatigue: FatigueSummary | None = None
    """Fatigue at the places; None if no material has an S-N line, or if it was not asked for."""

    def value(self, name: str) -> tuple[FloatArray, FloatArray]:
        """A value of `SUMMARIES` and its error, NaN if none was estimated: shape ``(X,)``, ``(S,)`` or ``(1,)``."""
        of = self.fatigue if self.fatigue is not None and name in OF_FATIGUE else self
        value = of.values[name]
        return value, np.full_like(value, math.nan) if of.errors is None else of.errors[name]


def check_names(names: Sequence[str]) -> tuple[str, ...]:
    """Names of values of a summary, each once; an unknown name is an `InputError`."""
    for name in names:
        if name not in SUMMARIES:
            raise InputError(f"summary {name!r}: is unknown; allowed: {', '.join(SUMMARIES)}")
    return tuple(dict.fromkeys(names))


def quantities_of(names: Sequence[str]) -> list[str]:
    """The quantities of the beam that some names of values need."""
    return list(dict.fromkeys(name.rpartition("_")[0] for name in names if name in ALONG and name not in OF_FATIGUE))


def summarise(
    steady: SteadyState,
    *,
    at: Sequence[float] | None = None,
    quantities: Sequence[str] | None = None,
    names: Sequence[str] = SUMMARIES,
) -> OrbitSummary:
    """Peaks, root mean squares and contact times of a steady state.

    Parameters
    ----------
    steady : SteadyState
        The steady state.
    at : sequence of float, optional
        Places, m; by default the stops, and the ends that no support fixes.
    quantities : sequence of str, optional
        Names from `lapjoint.answers.quantities.QUANTITIES`; by default displacement, velocity, absolute acceleration,
        moment and, if the beam has a section, stress.
    names : sequence of str
        Names of values, of `SUMMARIES`, that are needed: powers of the excitation and fatigue, which take long, are
        left out if they are not.

    Returns
    -------
    OrbitSummary
        The values, and their errors if errors of the impulses were estimated.

    Raises
    ------
    InputError
        If a place is off the beam, a quantity is unknown, or the problem lacks something that a quantity needs.
    """
    what = selection(steady.problem, at=at, quantities=quantities)
    powers, fatigued = any(name in _OF_INPUT for name in names), any(name in OF_FATIGUE for name in names)
    if not steady.period_multiple:
        return _of_wandering(steady, what, powers, fatigued)
    values = _of_periods(steady.history, what, 1, powers)
    means = {name: value[0] for name, value in values.items()}
    fatigue = fatigue_of_orbit(steady, what, FINER) if fatigued else None
    if steady.impulse_errors is None:
        return OrbitSummary(what, means, None, fatigue)
    other = steady.comparison
    if other is None:
        unstated = {name: np.full_like(value, math.inf) for name, value in means.items()}
        return OrbitSummary(what, means, unstated, fatigue)
    finer = {name: value[0] for name, value in _of_periods(other.history, what, 1, powers, FINER).items()}
    orders = {one.name: (one.dx, one.dt) for one in what.quantities} | dict.fromkeys(
        ("received", "dissipated", "input", "damping"), (0, OF_ENERGY)
    )
    unknown = ~np.isfinite(steady.impulse_errors)
    damped = np.array([stop.damping > 0 for stop in steady.problem.stops], dtype=bool)
    jumps = bool((_bare(steady.problem) & damped & (means["contact_rate"] > 0)).any())
    errors = {}
    for name, value in means.items():
        apart = value - finer[name]
        dx, dt = orders.get(name.removesuffix("_total").rpartition("_")[0], (0, 0))  # forces and times have none
        errors[name] = other.bounds(apart, float(np.abs(apart).max(initial=0.0)), dx, dt)
        errors[name] = errors[name] + other.floor * float(np.abs(value).max(initial=0.0))
        if name in OF_ALL:
            concerned = unknown & damped if name == "dissipated_power_total" else unknown
            errors[name][concerned.any()] = math.inf
        elif name in OF_STOPS:
            if name.startswith("force"):
                errors[name] += other.floor * np.where(value > 0, forces_at_gaps(steady.problem.structure.stops), 0.0)
            errors[name][unknown] = math.inf
        elif jumps and dt == 2:
            errors[name][:] = math.inf
        else:
            errors[name][(value == 0) & (finer[name] == 0)] = 0.0  # both fulfil a condition, e.g. of a free end
    errors["dissipated_power"][~damped] = 0.0
    return OrbitSummary(what, means, errors, fatigue)


def _bare(problem: Problem) -> npt.NDArray[np.bool_]:
    """Whether each stop strikes a beam where there is no mass, ``(S,)``.

    The force of a damped stop begins with a jump.  A mass takes it; on a beam alone the acceleration then goes with
    t^-1/2 from the moment of the jump, and neither its peak nor its root mean square has a limit.
    """
    heavy = {mass.x for mass in problem.structure.masses if mass.mass > 0}
    return np.array([any(x not in heavy for x, _ in stop.reading) for stop in problem.structure.stops], dtype=bool)


def _of_wandering(steady: SteadyState, what: Selection, powers: bool, fatigued: bool) -> OrbitSummary:
    """The summary of a motion that does not repeat, with `powers` of the excitation and with fatigue if `fatigued`:
    means over its excitation periods, with their standard errors."""
    omega = steady.problem.require_excitation_frequency("a steady state")
    history = steady.history if steady.march_on is None else steady.march_on(WANDERING)
    periods = max(1, round((history.end - history.start) * omega / (2 * math.pi)))
    each = _of_periods(history, what, periods, powers)
    values, errors = {}, {}
    for name, value in each.items():
        if name.endswith("_peak"):
            values[name], errors[name] = value.max(axis=0), np.full(value.shape[1], math.inf)
            continue
        power = 2 if name.endswith("_rms") else 1
        means = value**power
        mean = means.mean(axis=0)
        values[name] = np.sqrt(mean) if power == 2 else mean
        of_mean = np.array([standard_error(series) if periods >= WANDERING else math.inf for series in means.T])
        size = np.where(values[name] > 0, values[name], 1.0)
        errors[name] = of_mean / (power * size ** (power - 1))
    fatigue = fatigue_of_wandering(steady, history, what, periods, periods >= WANDERING) if fatigued else None
    return OrbitSummary(what, values, None if steady.impulse_errors is None else errors, fatigue)


def _of_periods(
    history: History, what: Selection, periods: int, powers: bool, times: float = 1.0
) -> dict[str, FloatArray]:
    """All values over each of `periods` equal parts of a motion: by name, shape (periods, X) or (periods, S).

    The powers of the excitation and of damping are left out without `powers`.  There are at most `times` `MOST`
    samples.
    """
    edges = np.linspace(history.start, history.end, periods + 1)
    t, weight, part = _samples(history, edges, times * MOST)
    Q, X, S = len(what.quantities), what.x.size, len(history.problem.stops)
    squares, peaks, when = np.zeros((periods, Q, X)), np.zeros((periods, Q, X)), np.zeros((periods, Q, X))
    force_squares, force_peak = np.zeros((periods, S)), np.zeros((periods, S))
    given = np.zeros((periods, 1))
    for p in range(periods):
        mine = np.flatnonzero(part == p)
        for here in np.split(mine, range(_AT_ONCE, mine.size, _AT_ONCE)):
            values, force = what.values(history, t[here])
            squares[p] += (values**2) @ weight[here]
            force_squares[p] += (force**2) @ weight[here]
            if powers:
                given[p] += input_power(history, t[here]) @ weight[here]
            keep_largest(values, t[here], peaks[p], when[p])
        _look_closer(history, what, np.diff(t[mine]).max(initial=0.0), peaks[p], when[p])
    duration = np.diff(edges)[:, None]
    time, count, lost, got = np.zeros((4, periods, S))
    for contact, energy in zip(history.contacts, received(history, periods == 1), strict=True):
        p = int(np.clip(np.searchsorted(edges, contact.start, side="right") - 1, 0, periods - 1))
        time[p, contact.stop] += contact.duration
        force_peak[p, contact.stop] = max(force_peak[p, contact.stop], contact.peak_force)
        count[p, contact.stop] += not contact.open_start
        lost[p, contact.stop] += contact.dissipated
        got[p, contact.stop] += energy
    nothing = is_rounding(peaks.max(axis=0))
    peaks[:, nothing], squares[:, nothing] = 0.0, 0.0
    found = {}
    for q, one in enumerate(what.quantities):
        found[f"{one.name}_peak"] = peaks[:, q]
        found[f"{one.name}_rms"] = np.sqrt(squares[:, q] / duration)
    found["force_peak"], found["force_rms"] = force_peak, np.sqrt(force_squares / duration)
    found["contact_time"], found["contact_rate"] = time / duration, count / duration
    found["received_power"], found["dissipated_power"] = got / duration, lost / duration
    found["dissipated_power_total"] = found["dissipated_power"].sum(axis=1, keepdims=True)
    if powers:
        found["input_power"] = given / duration
        found["damping_power"] = found["input_power"] - found["dissipated_power_total"]
    return found


def _samples(history: History, edges: FloatArray, most: float) -> tuple[FloatArray, FloatArray, IndexArray]:
    """At most `most` times, s, their weights, s, and the part between `edges` in which each lies, shape (m,) each."""
    ends = np.unique(np.concatenate([edges, history.switch_times]))
    duration = history.end - history.start
    fastest = history.highest_mode or 0.0
    count = max(PER_PERIOD * fastest * duration / (2 * math.pi), 512.0 * (edges.size - 1))
    step = duration / min(count, most) * _NODES.size
    panels = np.maximum(1, np.ceil(np.diff(ends) / step)).astype(int)
    width = np.repeat(np.diff(ends) / panels, panels)
    offset = np.arange(panels.sum()) - np.repeat(np.cumsum(panels) - panels, panels)
    middle = np.repeat(ends[:-1], panels) + (offset + 0.5) * width
    t = np.clip((middle[:, None] + 0.5 * width[:, None] * _NODES).ravel(), history.start, history.end)
    part = np.clip(np.searchsorted(edges, t, side="right") - 1, 0, edges.size - 2)
    return t, (0.5 * width[:, None] * _WEIGHTS).ravel(), part


def _look_closer(history: History, what: Selection, step: float, peaks: FloatArray, when: FloatArray) -> None:
    """Search for peaks around the largest samples, at the chosen places and at the place of the largest sample; `peaks`
    and `when` are (Q, X)."""
    steps = step * np.arange(-_FINE, _FINE + 1) / _FINE
    for q, row in enumerate(peaks):  # separately, so that a peak does not depend on the other quantities
        middle = when[q, np.union1d(what.asked, [int(np.argmax(row))])]
        t = np.unique(np.clip(middle[:, None] + steps, history.start, history.end))
        alone = Selection(what.problem, (what.quantities[q],), what.places)
        for here in np.split(t, range(_AT_ONCE, t.size, _AT_ONCE)):
            keep_largest(alone.values(history, here)[0], here, peaks[q : q + 1], when[q : q + 1])
