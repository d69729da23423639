"""Errors of a steady state: its orbit is found again at a finer resolution of the solver, and compared.

Newton's method begins at the known section point, adopted by the finer period map.  If this point is too far from the
finer orbit, across a switch, the finer map first marches for some periods of the orbit.  If the finer map has no such
orbit, or an unstable one, no error can be stated: the errors are infinite.

The impulse of a stop that neither motion touches is zero.  Its error is zero if the motion keeps clear of the stop by
more than the error of the displacement at the stop; otherwise the error is infinite.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from lapjoint.answers.dissipation import OF_ENERGY
from lapjoint.answers.history import Contact, History
from lapjoint.answers.steady_state import Comparison, impulses_per_period
from lapjoint.errors import InputError, SolverError
from lapjoint.orbits.contact_errors import (
    differences,
    sizes_at_gaps,
    with_errors,
    without_broken,
    without_contact_errors,
)
from lapjoint.orbits.force_breaks import cut, undecided_breaks_of_orbit
from lapjoint.orbits.half_periods import HalfPeriods
from lapjoint.orbits.newton import RESIDUAL, Orbit, find_orbit
from lapjoint.orbits.period_map import PeriodMap
from lapjoint.orbits.refinement import ROUNDING, Refinement
from lapjoint.problem import FloatArray
from lapjoint.problem.supports_and_stops import forces_at_gaps

FARTHEST = 0.5
"""Largest residual of the adopted section point, divided by the size of the motion, from which Newton's method is
tried; with twenty modes, and a stop ten thousand times as stiff as the beam, the residual is a tenth."""
SETTLING = (0, 1, 4)
"""Periods of the orbit that the finer map has marched at each attempt of Newton's method."""
_SAMPLES = 64
"""Number of times in half an excitation period at which displacements are compared: without contact they are nearly
harmonic."""


@dataclass(frozen=True)
class FinerMap:
    """A finer resolution of a solver, for one problem."""

    refinement: Refinement
    """Ratio of the two resolutions, and the order with which errors fall."""
    period_map: PeriodMap
    """The period map of the problem at the finer resolution."""


@dataclass(frozen=True)
class OrbitErrors:
    """The errors of a steady state."""

    impulses: FloatArray
    """Error of the impulse of each stop per excitation period, N s, shape ``(stops,)``."""
    dissipated: FloatArray
    """Error of the energy that each stop takes and keeps per excitation period, J, shape ``(stops,)``."""
    history: History
    """The motion, with the errors of its contacts."""
    source: str
    """How the errors were estimated, or why they are infinite."""
    comparison: Comparison | None = None
    """The finer motion, for errors of other quantities; None if the errors are infinite."""


def orbit_errors(orbit: Orbit, history: History, finer: Callable[[], FinerMap]) -> OrbitErrors:
    """The errors of the impulses, energies and contacts of a stable orbit, of which `history` is one period."""
    try:
        other = finer()
        half_periods, name = HalfPeriods(other.period_map), other.refinement.name
        found = same_orbit(half_periods, orbit)
        if found is None:
            return _unknown(history, f"{name} has no such orbit that Newton's method could find")
        if not found.stable:
            return _unknown(history, f"by {name} the motion is unstable")
        finer_history = other.period_map.history(found.point, orbit.period_multiple)
    except (InputError, SolverError) as error:
        return _unknown(history, f"the finer solver gave up: {error}")
    floor = (ROUNDING + (orbit.residual if orbit.residual > RESIDUAL else 0.0)) / (1 - abs(orbit.leading))
    impulses = _impulse_errors(orbit, history, finer_history, other.refinement, floor)
    energies = _energy_errors(orbit, history, finer_history, other.refinement, floor, impulses)
    source = f"compared with {name}"
    breaks = undecided_breaks_of_orbit(orbit, found, other.refinement)
    history = _with_contact_errors(history, finer_history, other.refinement, floor, breaks)
    comparison = Comparison(finer_history, other.refinement.bounds, floor)
    return OrbitErrors(impulses, energies, replace(history, error_source=source), source, comparison)


def same_orbit(half_periods: HalfPeriods, orbit: Orbit) -> Orbit | None:
    """The orbit of another map of the problem nearest to a known one, stable or not; None if none is found."""
    point, marched = half_periods.map.adopted(orbit.point), 0
    for periods in SETTLING:
        for _ in range(periods - marched):
            point = half_periods.marched(point, orbit.half_periods)
        marched = periods
        found = find_orbit(half_periods, point, orbit.half_periods, FARTHEST)
        if found is not None:
            return found
    return None


def _unknown(history: History, reason: str) -> OrbitErrors:
    """Infinite errors, with the reason."""
    unknown = np.full(len(history.problem.stops), np.inf)
    damped = np.array([stop.damping > 0 for stop in history.problem.stops], dtype=bool)
    return OrbitErrors(
        unknown,
        np.where(damped, unknown, 0.0),
        without_contact_errors(history, reason),
        f"unknown: {reason}",
    )


def _impulse_errors(orbit: Orbit, history: History, finer: History, refinement: Refinement, floor: float) -> FloatArray:
    """Errors of the impulses per excitation period, N s, shape ``(stops,)``; `floor` is relative."""
    own, other = (impulses_per_period(motion, orbit.period_multiple) for motion in (history, finer))
    touched = np.zeros(own.size, dtype=bool)
    touched[[contact.stop for motion in (history, finer) for contact in motion.contacts]] = True
    apart = own - other
    errors = refinement.bounds(apart, float(np.abs(apart).max(initial=0.0)))
    lasts = (history.end - history.start) / orbit.period_multiple
    errors += floor * (float(np.abs(own).max(initial=0.0)) + forces_at_gaps(history.problem.structure.stops) * lasts)
    clear = _clear(orbit, history, finer, refinement, np.flatnonzero(~touched).tolist())
    errors[~touched] = np.where(clear, 0.0, np.inf)
    return errors


def _energy_errors(
    orbit: Orbit, history: History, finer: History, refinement: Refinement, floor: float, impulse_errors: FloatArray
) -> FloatArray:
    """Errors of the energies lost in the stops per excitation period, J, shape ``(stops,)``; `floor` is relative.

    They are unknown where the error of the impulse is, and 0 of a stop that is certainly not touched.
    """
    own, other = (motion.dissipated() / orbit.period_multiple for motion in (history, finer))
    errors = refinement.bounds(own - other, float(np.abs(own - other).max(initial=0.0)), dt=OF_ENERGY)
    errors += floor * float(np.abs(own).max(initial=0.0))
    errors = np.where(np.isfinite(impulse_errors) & (impulse_errors > 0), errors, impulse_errors)
    damped = np.array([stop.damping > 0 for stop in history.problem.stops], dtype=bool)
    return np.where(damped, errors, 0.0)


def _clear(
    orbit: Orbit, history: History, finer: History, refinement: Refinement, stops: Sequence[int]
) -> npt.NDArray[np.bool_]:
    """Whether the motion certainly keeps clear of each of `stops`, which it does not touch."""
    x = np.array([history.problem.structure.stops[k].x for k in stops])
    if not x.size:
        return np.zeros(0, dtype=bool)
    t = np.linspace(history.start, history.end, 2 * _SAMPLES * orbit.period_multiple + 1)
    apart = np.abs(history.displacement(x, t) - finer.displacement(x, t)).max(axis=1)
    intervals = orbit.watch.intervals
    distance = np.array([intervals.distance[intervals.stop == k].min(initial=np.inf) for k in stops])
    return np.asarray(distance > refinement.bounds(apart, apart))


def _with_contact_errors(
    history: History, finer: History, refinement: Refinement, floor: float, breaks: FloatArray
) -> History:
    """The motion with the errors of its contacts; `floor` is relative, and `breaks` are those of `undecided_breaks`."""
    period = history.end - history.start
    whole, number = _whole(history)
    broken, of_whole = cut(history, breaks), np.eye(len(whole), dtype=bool)
    found = without_broken(differences(whole, _whole(finer)[0], period), broken @ of_whole[number])
    start, impulse, peak, dissipated = (
        refinement.bounds(values, float(values[np.isfinite(values)].max(initial=0.0)), dt=dt)
        for values, dt in ((found.start, 0), (found.impulse, 0), (found.peak_force, 0), (found.dissipated, OF_ENERGY))
    )
    impulses, forces = sizes_at_gaps(history)
    together = np.bincount(np.array(number, dtype=int), impulses, len(whole))  # of both parts of a contact that is cut
    impulse += floor * (max((abs(contact.impulse) for contact in whole), default=0.0) + together)
    peak += floor * max((contact.peak_force for contact in whole), default=0.0)
    dissipated += floor * max((abs(contact.dissipated) for contact in whole), default=0.0)
    start += floor * period
    contacts = with_errors(history, start[number], impulse[number], peak[number] + floor * forces, dissipated[number])
    return replace(history, contacts=contacts)


def _whole(history: History) -> tuple[list[Contact], list[int]]:
    """The contacts of a periodic motion, with a contact that its ends cut in two joined; and for each contact the index
    of its whole."""
    contacts = history.contacts
    cut = {c.stop: i for i, c in enumerate(contacts) if c.open_end and not c.open_start}
    rest = {i: cut[c.stop] for i, c in enumerate(contacts) if c.open_start and not c.open_end and c.stop in cut}
    whole = [i for i in range(len(contacts)) if i not in rest]
    made = [contacts[i] for i in whole]
    for i, begun in rest.items():
        k = whole.index(begun)
        peak = max(made[k].peak_force, contacts[i].peak_force)
        impulse, lost = (getattr(made[k], name) + getattr(contacts[i], name) for name in ("impulse", "dissipated"))
        made[k] = replace(made[k], end=contacts[i].end, impulse=impulse, peak_force=peak, dissipated=lost)
    return made, [whole.index(rest.get(i, i)) for i in range(len(contacts))]
