"""Errors of contacts: each contact is compared with its partner in a motion at a finer resolution of the solver.

Two contacts are partners if they are contacts of one stop, and each is the nearest to the other in time.  If a contact
has no partner, because the finer motion grazes the stop, no error can be stated, and the error is infinite.

If two contacts are nearest by their starts and not by their ends, one motion splits what is one contact in the other;
then only the error of the start can be stated.  The same holds where it is not certain whether the force of a damped
stop ends and begins again, see `force_breaks`.

Two chaotic marches finally part.  They have parted where the time between partners is not small compared with the time
to their neighbours; from then on no error can be stated.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from lapjoint.answers.dissipation import OF_ENERGY
from lapjoint.answers.history import Contact, History
from lapjoint.errors import InputError, SolverError
from lapjoint.orbits.compiled_intervals import IndexArray
from lapjoint.orbits.force_breaks import cut, undecided_breaks
from lapjoint.orbits.refinement import ROUNDING, Refinement
from lapjoint.problem import FloatArray
from lapjoint.problem.supports_and_stops import forces_at_gaps

PARTED = 0.1
"""Largest time between partners, divided by the time to the stop's nearest other contact, of motions that have not
parted."""


@dataclass(frozen=True)
class Differences:
    """Differences between contacts and their partners; infinite without a partner, and all but the start infinite where
    one motion splits a contact."""

    start: FloatArray
    """Difference of the start times, s, shape ``(contacts,)``."""
    impulse: FloatArray
    """Difference of the impulses, N s, shape ``(contacts,)``."""
    peak_force: FloatArray
    """Difference of the peak forces, N, shape ``(contacts,)``."""
    dissipated: FloatArray
    """Difference of the energies lost in the stops, J, shape ``(contacts,)``."""


def with_contact_errors(history: History, refinement: Refinement, finer: Callable[[], History]) -> History:
    """A march with the errors of its contacts; `finer` returns the march of the finer solver."""
    try:
        other = finer()
    except (InputError, SolverError) as error:
        return without_contact_errors(history, f"{refinement.name} gave up: {error}")
    breaks = undecided_breaks(history, other, refinement)
    found = without_broken(differences(history.contacts, other.contacts), cut(history, breaks))
    parted = parting(history.contacts, found)
    together = np.arange(len(history.contacts)) < parted
    errors = []
    for values, dt in ((found.start, 0), (found.impulse, 0), (found.peak_force, 0), (found.dissipated, OF_ENERGY)):
        finite = np.where(np.isfinite(values), values, 0.0)
        bounds = refinement.bounds(values, np.maximum.accumulate(finite), dt=dt)
        errors.append(np.where(together, bounds, np.inf))
    sizes = [(one.end, abs(one.impulse), one.peak_force, abs(one.dissipated)) for one in history.contacts]
    largest = np.maximum.accumulate(np.array(sizes).reshape(-1, 4)).T
    largest[1:3] += sizes_at_gaps(history)
    floors = ROUNDING * largest
    contacts = with_errors(history, *(error + floor for error, floor in zip(errors, floors, strict=True)))
    source = f"compared with {refinement.name}"
    if breaks.size:
        source += f"; from {breaks[0, 0]:.6g} s on it is not always certain whether the force of a stop ends"
    if parted < len(contacts):
        source += f"; from {contacts[parted].start:.6g} s on the two motions part, and no error can be stated"
    lost = _lost_errors(history, other, refinement, found) if parted == len(contacts) else None
    return replace(history, contacts=contacts, error_source=source, lost_errors=lost)


def sizes_at_gaps(history: History) -> FloatArray:
    """Impulse, N s, and force, N, of each contact at a penetration as large as the gap, ``(2, contacts)``: rounding
    counts with these."""
    forces = forces_at_gaps(history.problem.structure.stops)[[one.stop for one in history.contacts]]
    return np.stack([forces * [one.duration for one in history.contacts], forces])


def _lost_errors(history: History, finer: History, refinement: Refinement, found: Differences) -> FloatArray:
    """Errors of the energies lost in the stops over a whole march, J, (stops,): no break of a force changes them."""
    own, apart = history.dissipated(), np.abs(history.dissipated() - finer.dissipated())
    finite = found.dissipated[np.isfinite(found.dissipated)]
    largest = float(max(apart.max(initial=0.0), finite.max(initial=0.0)))
    errors = refinement.bounds(apart, largest, dt=OF_ENERGY) + ROUNDING * float(np.abs(own).max(initial=0.0))
    return np.where([stop.damping > 0 for stop in history.problem.stops], errors, 0.0)


def without_broken(found: Differences, broken: npt.NDArray[np.bool_]) -> Differences:
    """Differences of contacts, infinite where undecided breaks of forces, as of `cut`, leave a number unknown."""
    unknown = broken.any(axis=0)
    others = (np.where(unknown, np.inf, it) for it in (found.impulse, found.peak_force, found.dissipated))
    return Differences(np.where(broken[1], np.inf, found.start), *others)


def with_errors(
    history: History, start: FloatArray, impulse: FloatArray, peak: FloatArray, dissipated: FloatArray
) -> tuple[Contact, ...]:
    """Contacts with errors, s, N s, N and J, (contacts,) each; a contact that is closed at the start has an exact
    start, and a stop without damping loses exactly nothing."""
    damped = [stop.damping > 0 for stop in history.problem.stops]
    return tuple(
        replace(
            contact,
            start_error=0.0 if contact.open_start else float(start[i]),
            impulse_error=float(impulse[i]),
            peak_force_error=float(peak[i]),
            dissipated_error=float(dissipated[i]) if damped[contact.stop] else 0.0,
        )
        for i, contact in enumerate(history.contacts)
    )


def without_contact_errors(history: History, reason: str) -> History:
    """A motion whose contacts have infinite errors (but for exact numbers, see `with_errors`), for a `reason`."""
    unknown = np.full(len(history.contacts), np.inf)
    contacts = with_errors(history, unknown, unknown, unknown, unknown)
    return replace(history, contacts=contacts, error_source=reason)


def differences(contacts: Sequence[Contact], others: Sequence[Contact], period: float | None = None) -> Differences:
    """Differences of contacts from their partners in another motion; times are modulo a `period`, s, if one is
    given."""
    start, impulse, peak, dissipated = np.full((4, len(contacts)), np.inf)
    for stop in {contact.stop for contact in contacts}:
        own = np.array([i for i, contact in enumerate(contacts) if contact.stop == stop])
        other = [contact for contact in others if contact.stop == stop]
        if not other:
            continue
        mine = [contacts[i] for i in own]
        partner, mutual, apart = _partners([c.start for c in mine], [c.start for c in other], period)
        start[own[mutual]] = apart[mutual]
        if len(mine) > 1 or len(other) > 1:  # else they are partners by their ends, too
            by_end, both, _ = _partners([c.end for c in mine], [c.end for c in other], period)
            mutual &= both & (by_end == partner)
        pairs = [(contacts[i], other[k]) for i, k in zip(own[mutual], partner[mutual], strict=True)]
        impulse[own[mutual]] = [abs(one.impulse - another.impulse) for one, another in pairs]
        peak[own[mutual]] = [abs(one.peak_force - another.peak_force) for one, another in pairs]
        dissipated[own[mutual]] = [abs(one.dissipated - another.dissipated) for one, another in pairs]
    return Differences(start, impulse, peak, dissipated)


def _partners(
    times: Sequence[float], others: Sequence[float], period: float | None
) -> tuple[IndexArray, npt.NDArray[np.bool_], FloatArray]:
    """Index of the nearest other time to each time, whether each is the nearest to the other, and their distance, s."""
    one, other = np.array(times), np.array(others)
    partner, apart = _nearest(one, other, period)
    if one.size == other.size == 1:
        return partner, np.ones(1, dtype=np.bool_), apart
    return partner, _nearest(other, one, period)[0][partner] == np.arange(one.size), apart


def _nearest(times: FloatArray, others: FloatArray, period: float | None) -> tuple[IndexArray, FloatArray]:
    """Index of the nearest other time to each time, and its distance, s, shape ``(n,)`` each.

    Both arrays of times ascend; with a period, s, they are compared modulo the period.
    """
    index = np.arange(others.size)
    if period is not None:
        times, at = times % period, np.argsort(others % period, kind="stable")
        others, index = (others % period)[at], np.concatenate([at, at, at])
        others = np.concatenate([others - period, others, others + period])
    after = np.minimum(np.searchsorted(others, times), others.size - 1)
    before = np.maximum(after - 1, 0)
    nearest = np.where(np.abs(times - others[before]) <= np.abs(others[after] - times), before, after)
    return index[nearest], np.abs(others[nearest] - times)


def parting(contacts: Sequence[Contact], found: Differences) -> int:
    """Index of the first contact, by time, at which two marches have parted; the number of contacts if none."""
    near = PARTED * _spacings(contacts)
    beyond = np.isfinite(found.start) & (found.start > near)
    return int(np.argmax(beyond)) if beyond.any() else len(contacts)


def _spacings(contacts: Sequence[Contact]) -> FloatArray:
    """Time from the start of each contact to the start of the stop's nearest other contact, s, shape
    ``(contacts,)``."""
    result = np.full(len(contacts), np.inf)
    for stop in {contact.stop for contact in contacts}:
        own = np.array([i for i, contact in enumerate(contacts) if contact.stop == stop])
        steps = np.concatenate([[np.inf], np.diff([contacts[i].start for i in own]), [np.inf]])
        result[own] = np.minimum(steps[:-1], steps[1:])
    return result
