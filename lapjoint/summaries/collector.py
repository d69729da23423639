"""Sums over a motion that a solver gives in stretches.

**Means and root mean squares** come from samples.  Each interval of 1 / rate has one sample, whose place within the
interval advances by the golden section from one interval to the next.  These samples are unbiased at any rate, also for
a periodic motion.  A lower rate hardly widens the confidence intervals, as long as samples are closer than the
correlation time of the motion.

**Peaks** of forces are the peaks of the contacts, which the solver computes.  The search for other peaks begins with
the largest samples of a unit.  Around each sample that is the largest so far, and around the hardest contact of each
stop so far, the motion is sampled `FINE` times as closely, and once more around the largest of these samples.  The peak
of a quantity that varies more slowly than the sampling is exact.  A peak of a faster quantity may lie between samples,
so that the result is a lower bound.

**Contacts** are counted once, in the unit in which they begin, even if the end of a stretch cuts them.  Their times,
impulses, largest forces and energies belong to the unit in which they act: a contact that lasts through several units
is cut at their edges.

**Cycles of stress**, see `lapjoint.summaries.rainflow`, belong to the unit in which they close; the residue of the
whole motion is shared by all units.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from lapjoint.answers.dissipation import parts_of, taken
from lapjoint.answers.history import Contact, History
from lapjoint.answers.powers import input_power
from lapjoint.problem import FloatArray
from lapjoint.summaries.distributions import bins_of
from lapjoint.summaries.quantities import Selection, keep_largest
from lapjoint.summaries.rainflow import CycleCounter, Damage, Places
from lapjoint.summaries.sums import OF_CONTACTS, Sums

FINE = 8
"""Factor by which sampling is refined around a peak."""
OF_STRESS = 32
"""Most samples of stress, from which cycles are counted, in a sample of other quantities: 512 in a period of the
slowest mode by default, or as many as the fastest mode needs if these are fewer."""
AT_ONCE = 1024
"""Largest number of times that are evaluated at once, to bound the memory."""
_GOLDEN = (math.sqrt(5.0) - 1.0) / 2.0


def sample_times(rate: float, start: float, end: float) -> Iterator[FloatArray]:
    """Sampling times t, s, `start` <= t < `end`, one in each interval of 1 / rate, in arrays of at most `AT_ONCE`.

    The intervals begin at 0, so that the times do not depend on how a motion is cut into stretches.
    """
    last = math.ceil(end * rate)
    for first in range(math.floor(start * rate), last, AT_ONCE):
        k = np.arange(first, min(first + AT_ONCE, last))
        t = (k + k * _GOLDEN % 1.0) / rate
        inside = t[(t >= start) & (t < end)]
        if inside.size:
            yield inside


class Collector:
    """The sums of a motion, stretch after stretch, without its first `settle` seconds.

    The rest, up to `duration`, s, is cut into `units` units, and sampled at `rate`, Hz.
    """

    def __init__(self, selection: Selection, settle: float, duration: float, units: int, rate: float) -> None:
        self._selection, self._settle, self._end, self._rate = selection, settle, duration, rate
        self._stops = len(selection.problem.stops)
        self.sums = Sums.zero(
            units,
            (duration - settle) / units,
            len(selection.quantities),
            selection.x.size,
            self._stops,
            selection.fatigued,
        )
        self._cycles = CycleCounter(Places(selection.problem, selection.x[: selection.fatigued]), OF_STRESS * rate)
        self._edges = np.linspace(settle, duration, units + 1)
        self._going: dict[int, _Going] = {}
        """Contacts that last beyond the end of a stretch, by stop."""
        self._hardest = np.zeros((units, self._stops))
        """Largest peak force of the contacts around which the motion was sampled, N, shape (units, stops)."""

    def take(self, history: History) -> None:
        """Add a stretch, which begins where the last one ended."""
        self._take_contacts(history)
        self._take_parts(history)
        for unit in range(self._unit_of(history.start), self._unit_of(history.end) + 1):
            lo, hi = max(history.start, self._edges[unit]), min(history.end, self._edges[unit + 1])
            if lo < hi:
                self._take_samples(history, unit, lo, hi)
                if self._selection.fatigued:
                    done = self._cycles.take(history, lo, hi, hi >= self._edges[unit + 1])
                    if done is not None:
                        self._add_damage(unit, done)

    def _add_damage(self, unit: int | slice, damage: Damage, share: float = 1.0) -> None:
        """Add a share of what cycles do to a unit, or to each of several."""
        sums = self.sums
        sums.damage[unit] += share * damage.damage
        sums.coarse_damage[unit] += share * damage.coarse
        sums.largest_range[unit] = np.maximum(sums.largest_range[unit], damage.largest)
        sums.range_counts[unit] += share * damage.counts

    def finish(self) -> Sums:
        """All sums, after the last stretch; contacts that still last are cut."""
        self._add([replace(going, cut=True) for going in self._going.values()])
        self._going = {}
        if self._selection.fatigued:
            self._add_damage(slice(None), self._cycles.finish(), 1 / self.sums.samples.size)
        return self.sums

    def _unit_of(self, t: float) -> int:
        """The unit that contains a time; the first or the last unit if the time is outside all units."""
        return int(np.clip(np.searchsorted(self._edges, t, side="right") - 1, 0, self._edges.size - 2))

    def _take_samples(self, history: History, unit: int, lo: float, hi: float) -> None:
        """Add samples between two times, s, of a unit, and search for peaks among them."""
        sums = self.sums
        largest, when = np.zeros_like(sums.peak[unit]), np.zeros_like(sums.peak[unit])
        for part in sample_times(self._rate, lo, hi):
            values, force = self._selection.values(history, part)
            sums.samples[unit] += part.size
            sums.total[unit] += values.sum(axis=-1)
            sums.squares[unit] += np.einsum("qxm,qxm->qx", values, values)
            sums.work[unit] += input_power(history, part).sum()
            sums.force_squares[unit] += np.einsum("sm,sm->s", force, force)
            keep_largest(values, part, largest, when)
        around = [*self._records(unit, largest, when), *self._hard_contacts(history, unit, lo, hi)]
        sums.peak[unit] = np.maximum(sums.peak[unit], largest)
        if around:
            self._look(history, unit, np.clip(np.concatenate(around), lo, hi))

    def _records(self, unit: int, largest: FloatArray, when: FloatArray) -> list[FloatArray]:
        """Times around samples larger than all earlier samples, at the chosen places and at the place of the largest
        sample."""
        steps = np.arange(-FINE, FINE + 1) / (FINE * self._rate)
        found = []
        for q, (values, before) in enumerate(zip(largest, self.sums.peak[unit], strict=True)):
            rows = np.union1d(self._selection.asked, [np.argmax(values)])
            found += [when[q, row] + steps for row in rows[values[rows] > before[rows]]]
        return found

    def _hard_contacts(self, history: History, unit: int, lo: float, hi: float) -> list[FloatArray]:
        """Times around the hardest contact of each stop, if it is harder than all earlier contacts."""
        found, hardest = {}, self._hardest[unit]
        for contact in history.contacts:
            if lo <= contact.start < hi and contact.peak_force > hardest[contact.stop]:
                hardest[contact.stop], found[contact.stop] = contact.peak_force, contact
        shares = np.linspace(-0.5, 1.5, 4 * FINE + 1)
        return [contact.start + shares * contact.duration for contact in found.values()]

    def _look(self, history: History, unit: int, t: FloatArray) -> None:
        """Search for peaks at times, s, and then around the times at which a quantity is largest."""
        for step in (0.0, 1.0 / FINE**2):
            t = np.unique(t)
            largest, when = np.zeros_like(self.sums.peak[unit]), np.zeros_like(self.sums.peak[unit])
            for part in np.split(t, range(AT_ONCE, t.size, AT_ONCE)):
                keep_largest(self._selection.values(history, part)[0], part, largest, when)
            around = [] if step else self._records(unit, largest, when)
            self.sums.peak[unit] = np.maximum(self.sums.peak[unit], largest)
            if not around:
                return
            middle = np.array([times[FINE] for times in around])
            fine = np.arange(-FINE, FINE + 1) / (FINE**2 * self._rate)
            t = np.clip((middle[:, None] + fine).ravel(), t[0], t[-1])

    def _take_contacts(self, history: History) -> None:
        """Add the contacts that end in a stretch, and keep those that last beyond it."""
        speeds, done = self._impact_speeds(history), []
        for contact, speed, (whole, most) in zip(history.contacts, speeds.tolist(), taken(history), strict=True):
            going = self._going.pop(contact.stop, None) if contact.open_start else None
            this = _Going(contact, speed, contact.open_start, whole, most)
            if going is not None:
                this = _as_one(going, this)
            if contact.open_end:
                self._going[contact.stop] = this
            else:
                done.append(this)
        self._add(done)

    def _impact_speeds(self, history: History) -> FloatArray:
        """Impact speed of each contact of a stretch, m/s, shape (c,)."""
        contacts, stops = history.contacts, history.problem.structure.stops
        if not contacts:
            return np.zeros(0)
        starts, which = np.array([c.start for c in contacts]), np.array([c.stop for c in contacts])
        parts = np.split(starts, range(AT_ONCE, starts.size, AT_ONCE))
        velocity = np.concatenate([history.seen_by_stops(part, 1) for part in parts], axis=1)
        signs = np.array([stop.sign for stop in stops])
        return np.asarray(np.maximum(signs[which] * velocity[which, np.arange(starts.size)], 0.0))

    def _add(self, done: list[_Going]) -> None:
        """Count complete contacts."""
        if not done:
            return
        sums = self.sums
        stop = np.array([it.contact.stop for it in done])
        start, end, impulse, peak = np.array(
            [(it.contact.start, it.contact.end, it.contact.impulse, it.contact.peak_force) for it in done]
        ).T
        begins = (start >= self._edges[0]) & (start < self._edges[-1])
        unit = np.clip(np.searchsorted(self._edges, start, side="right") - 1, 0, self._edges.size - 2)
        np.add.at(sums.contacts, (unit[begins], stop[begins]), 1)
        np.add.at(sums.received, (unit[begins], stop[begins]), np.array([it.most for it in done])[begins])
        whole = begins & ~np.array([it.cut for it in done])
        unit, stop = unit[whole], stop[whole]
        columns = np.abs(impulse), peak, end - start, np.array([it.speed for it in done])
        for k, values in enumerate(columns[: len(OF_CONTACTS)]):
            np.add.at(sums.counts[:, :, k], (unit, stop, bins_of(values[whole])), 1)
            np.maximum.at(sums.largest[:, :, k], (unit, stop), values[whole])

    def _take_parts(self, history: History) -> None:
        """Add the contacts of a stretch, each cut at the edges of units, to the units in which they act."""
        edges, parts = self._edges, []
        for contact in history.contacts:
            parts += parts_of(history, contact, edges[(edges > contact.start) & (edges < contact.end)].tolist())
        parts = [part for part in parts if edges[0] <= part.start < edges[-1]]
        starts, stop = np.array([part.start for part in parts]), np.array([part.stop for part in parts], dtype=int)
        at = np.searchsorted(edges, starts, side="right") - 1, stop
        np.add.at(self.sums.time_in_contact, at, [part.duration for part in parts])
        np.add.at(self.sums.impulse, at, [part.impulse for part in parts])
        np.add.at(self.sums.dissipated, at, [part.dissipated for part in parts])
        np.maximum.at(self.sums.force_peak, at, [part.peak_force for part in parts])


@dataclass(frozen=True)
class _Going:
    """A contact, or its part up to the end of a stretch."""

    contact: Contact
    """The contact."""
    speed: float
    """Impact speed of the contact, m/s."""
    cut: bool
    """Whether an end of the motion cuts the contact."""
    whole: float
    """Energy that the stop has taken at its end, J."""
    most: float
    """The most that the stop has taken at any moment of the contact, J."""


def _as_one(begun: _Going, rest: _Going) -> _Going:
    """One contact from its two parts on either side of the end of a stretch."""
    first, second = begun.contact, rest.contact
    both = replace(
        first,
        end=second.end,
        impulse=first.impulse + second.impulse,
        peak_force=max(first.peak_force, second.peak_force),
        open_end=second.open_end,
    )
    most = max(begun.most, begun.whole + rest.most)
    return _Going(both, begun.speed, begun.cut, begun.whole + rest.whole, most)
