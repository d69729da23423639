"""Sums over a motion are those of its closed form, however it is cut, and contacts are counted once."""

from __future__ import annotations

import math
from dataclasses import fields, replace
from itertools import pairwise

import numpy as np
import pytest
from stretches import cut
from written_history import AMPLITUDE, GAP, OMEGA, STIFFNESS

from lapjoint import BaseMotion, History, Stop
from lapjoint.answers import Contact, ContactState
from lapjoint.problem import FloatArray
from lapjoint.summaries.collector import AT_ONCE, Collector, sample_times
from lapjoint.summaries.distributions import BINS, bins_of, edges
from lapjoint.summaries.quantities import selection
from lapjoint.summaries.sums import OF_CONTACTS, Sums

RATE = 40.0
DEPTH = 4e-3  # m


def collected(history: History, times: list[float], *, settle: float = 0.0, units: int = 1, rate: float = RATE) -> Sums:
    collector = Collector(selection(history.problem), settle, history.end, units, rate)
    for part in cut(history, times):
        collector.take(part)
    return collector.finish()


def all_times(rate: float, start: float, end: float) -> FloatArray:
    return np.concatenate(list(sample_times(rate, start, end)))


def test_means_squares_and_peaks_are_those_of_the_closed_form(history: History) -> None:
    sums = collected(history, [], rate=2000.0)
    tip = AMPLITUDE
    for q, largest in enumerate((tip, tip * OMEGA, tip * OMEGA**2)):
        assert sums.peak[0, q, -1] == pytest.approx(largest, rel=1e-6)
        assert math.sqrt(sums.squares[0, q, -1] / sums.samples[0]) == pytest.approx(largest / math.sqrt(2), rel=1e-3)
        assert abs(sums.total[0, q, -1] / sums.samples[0]) < 1e-3 * largest
    assert sums.peak[0, 3, 0] == pytest.approx(2.0 * 3 * AMPLITUDE, rel=1e-6)  # EI z_xx at the root
    assert sums.force_peak[0] == pytest.approx([STIFFNESS * (AMPLITUDE - GAP)] * 2)


def test_a_peak_between_samples_is_found(history: History) -> None:
    assert collected(history, [], rate=7.0).peak[0, 0, -1] == pytest.approx(AMPLITUDE, rel=1e-4)


def test_the_motion_of_the_base_belongs_to_absolute_quantities(history: History) -> None:
    base = BaseMotion(amplitude=0.5, angular_frequency=3 * OMEGA)
    moving = replace(history, problem=history.problem.replace(base_motion=base))
    of = selection(moving.problem, quantities=["acceleration", "absolute_acceleration"])
    t = np.linspace(0.0, 1.0, 17)
    relative, absolute = of.values(moving, t)[0]
    assert np.allclose(absolute - relative, base.at(t, 2))


def test_contacts_are_counted_once_however_the_motion_is_cut(history: History) -> None:
    whole = collected(history, [])
    assert whole.contacts.tolist() == [[1, 1]]
    (above, below) = history.contacts
    assert whole.time_in_contact[0] == pytest.approx([above.duration, below.duration])
    assert whole.impulse[0] == pytest.approx([above.impulse, below.impulse])
    middle = (above.start + above.end) / 2
    for times in ([0.5], [middle], [middle, middle + 0.01, middle + 0.02, 0.75], np.linspace(0.01, 0.99, 50).tolist()):
        sums = collected(history, times)
        for field in fields(Sums):
            one, other = getattr(whole, field.name), getattr(sums, field.name)
            # Impulses of contacts that are cut are quadratures here, and refined peaks depend on where stretches end.
            np.testing.assert_allclose(one, other, rtol=1e-3 if field.name == "peak" else 1e-6, atol=1e-12)


def test_a_contact_that_an_end_of_the_motion_cuts_is_in_no_distribution(history: History) -> None:
    (above, below) = history.contacts
    late = replace(history, start=above.start + 0.01, contacts=(replace(above, open_start=True), below))
    sums = collected(late, [])
    assert sums.counts.sum(axis=(0, 3)).tolist() == [[0] * len(OF_CONTACTS), [1] * len(OF_CONTACTS)]


def test_what_comes_before_the_settled_motion_is_left_out(history: History) -> None:
    (above, below) = history.contacts
    settle = above.start + 0.25 * above.duration
    sums = collected(history, [], settle=settle, units=3)
    assert sums.contacts.sum(axis=0).tolist() == [0, 1]
    assert sums.time_in_contact.sum(axis=0) == pytest.approx([0.75 * above.duration, below.duration])
    assert sums.samples.sum() == all_times(RATE, settle, 1.0).size
    assert sums.duration == pytest.approx((1 - settle) / 3)


@pytest.mark.parametrize("share", [0.25, 0.75])
def test_of_a_contact_that_began_before_the_settled_motion_the_rest_counts(history: History, share: float) -> None:
    """The force is k (A sin(omega t) - gap): before and after its peak."""
    above = history.contacts[0]
    settle = above.start + share * above.duration
    sums = collected(history, [], settle=settle)
    fall = math.cos(OMEGA * settle) - math.cos(OMEGA * above.end)
    impulse = STIFFNESS * (AMPLITUDE * fall / OMEGA - GAP * (above.end - settle))
    assert sums.impulse[0, 0] == pytest.approx(impulse, rel=1e-7)  # eight nodes, and a third of a turn
    largest = AMPLITUDE if share < 0.5 else AMPLITUDE * math.sin(OMEGA * settle)
    assert sums.force_peak[0, 0] == pytest.approx(STIFFNESS * (largest - GAP), rel=1e-12)


def pressed(history: History) -> History:
    """The first stop pressed by a tip at D + A sin(omega t), which never leaves it."""

    def field(x: FloatArray, t: FloatArray, dx: int = 0, dt: int = 0) -> FloatArray:
        return history.field(x, t, dx, dt) + (DEPTH if dx == dt == 0 else 0.0)

    stop = Stop(x=1.0, side="top", gap=-GAP, stiffness=STIFFNESS)
    peak = STIFFNESS * (DEPTH + GAP + AMPLITUDE)
    only = Contact(0, 0.0, 1.0, STIFFNESS * (DEPTH + GAP), peak, open_start=True, open_end=True)
    closed = (ContactState((0,)),)
    problem = history.problem.replace(stops=(stop,))
    return replace(
        history,
        problem=problem,
        switch_times=np.zeros(0),
        states=closed,
        contacts=(only,),
        field=field,
        highest_mode=OMEGA,
    )


def test_a_stop_that_is_pressed_all_the_time_has_its_force_in_every_unit(history: History) -> None:
    """In units of a quarter of a period, from an eighth on: however the motion is cut in stretches."""
    for times in ([], [0.3, 0.55]):
        collector = Collector(selection(pressed(history).problem), 0.125, 1.0, 7, RATE)
        for part in cut(pressed(history), times):
            collector.take(part)
        sums = collector.finish()
        edges = np.linspace(0.125, 1.0, 8)
        wave = -np.diff(np.cos(OMEGA * edges)) * AMPLITUDE / OMEGA
        exact = STIFFNESS * ((DEPTH + GAP) * 0.125 + wave)
        # Impulses of contacts that the ends of stretches cut are trapezoids here.
        assert sums.impulse[:, 0] == pytest.approx(exact, rel=1e-6 if times else 1e-12)
        assert sums.time_in_contact[:, 0] == pytest.approx(0.125)
        top = np.max(np.sin(OMEGA * np.array(list(pairwise(edges)))), axis=1)  # both turns are at edges
        assert sums.force_peak[:, 0] == pytest.approx(STIFFNESS * (DEPTH + GAP + AMPLITUDE * top), rel=1e-5)
        assert not sums.contacts.any()
        assert not sums.counts.any()


def test_units_add_up_to_the_whole(history: History) -> None:
    one, many = collected(history, []), collected(history, [], units=7)
    for name in ("samples", "total", "squares", "contacts", "time_in_contact", "impulse", "counts"):
        np.testing.assert_allclose(getattr(many, name).sum(axis=0), getattr(one, name)[0], rtol=1e-12, atol=1e-15)


def test_distributions_hold_each_contact_in_its_bin(history: History) -> None:
    sums = collected(history, [])
    (above, below) = history.contacts
    speed = AMPLITUDE * OMEGA * math.cos(OMEGA * above.start)
    for k, value in enumerate((above.impulse, above.peak_force, above.duration, speed)):
        (bin_,) = np.flatnonzero(sums.counts[0, 0, k])
        low, high = edges(bin_, bin_)
        assert low <= value < high < 1.13 * low
        assert sums.largest[0, 0, k] == pytest.approx(value)
    assert sums.largest[0, 1, 0] == pytest.approx(abs(below.impulse))


def test_bins_take_every_number() -> None:
    assert bins_of(np.array([-1.0, 0.0, 1e-300, 1.0, 1e300])).tolist() == [0, 0, 0, BINS // 2, BINS - 1]


def test_one_time_lies_in_each_interval_and_none_depends_on_the_ends() -> None:
    t = all_times(10.0, 0.0, 50.0)
    assert np.array_equal(np.floor(t * 10), np.arange(500))
    parts = [all_times(10.0, a, b) for a, b in ((0.0, 0.123), (0.123, 7.0), (7.0, 50.0))]
    assert np.array_equal(np.concatenate(parts), t)


def test_times_come_a_few_at_once_whatever_the_rate() -> None:
    first = next(sample_times(1e12, 0.0, 1.0))
    assert 0 < first.size <= AT_ONCE
    assert 0 <= first[0] <= first[-1] <= AT_ONCE / 1e12


def test_a_periodic_motion_is_sampled_without_bias() -> None:
    for omega in (1.0, 20 * math.pi, 40 * math.pi):  # the last two: one and two periods in an interval
        assert abs(np.mean(np.sin(omega * all_times(10.0, 0.0, 400.0)))) < 0.01


def test_sums_come_back_from_a_journal_with_the_same_bits(history: History) -> None:
    import json

    sums = collected(history, [0.3], units=2)
    again = Sums.from_plain(json.loads(json.dumps(sums.plain())))
    for field in fields(Sums):
        assert np.array_equal(getattr(sums, field.name), getattr(again, field.name))
