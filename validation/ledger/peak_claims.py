"""Claims about the peaks of Figure 4: where they are, how high, how far from the states' frequencies."""

from __future__ import annotations

from functools import cache

import numpy as np

import analytic
from lapjoint import ContactState, paper_joint
from lapjoint.problem.presets import PAPER_DENSITY, TABLE_4_DENSITY
from validation.case import Level, Say
from validation.cases.peaks import NEAR, Peak, solve_peak
from validation.ledger.curves import PUBLISHED, Figure4, at
from validation.ledger.entry import Entry, Ruling, matches, written
from validation.verdict import Estimate

BOTH_BOTTOM = ContactState((0, 1))
AXIS = 1.5e4
"""Where the axis of Figure 4 ends, N s."""
SAME_PEAK = 0.01  # of its frequency: a peak read off a curve that is 50 to 400 rad/s wide at half its height
# Printed by peak: the offset from the state's frequency in rad/s and in percent, and the mode of that state.
OFFSETS = {515.0: ("-3", "-0.58 %", 1), 820.0: ("6", "0.78 %", 2), 2950.0: ("-20", "-0.67 %", 5)}
RATIOS = {(820.0, 515.0): ("second to the first", "0.5"), (2950.0, 820.0): ("third to the second", "1.5")}

Peaks = dict[float, tuple[Peak, Peak]]


def peak_entries(curves: Figure4, level: Level, say: Say) -> list[Entry]:
    """All of them."""
    peaks: Peaks = {}
    for near in NEAR:
        _, exact, fe = solve_peak(near, level)
        peaks[near] = exact, fe
        say(f"peak near {near:g} rad/s")
    return [
        *(position(near, peaks) for near in peaks),
        *(entry for near in peaks for entry in offsets(near, peaks)),
        *(ratio(high, low, peaks) for high, low in RATIOS),
        axis(curves),
    ]


@cache
def published_peak(near: float) -> tuple[float, float]:
    """Frequency and height of a peak by the scheme as published."""
    omega = near + NEAR[near] * np.linspace(-1.2, 1.2, 13)
    return at(PUBLISHED, tuple(omega)).peak(near, 2 * NEAR[near])


def position(near: float, peaks: Peaks) -> Entry:
    """Where a peak is."""
    exact, fe = peaks[near]
    frequency, height = published_peak(near)
    fits = abs(exact.frequency.value - near) <= SAME_PEAK * near
    return Entry(
        "Section 3, Figure 4",
        f"a peak at {near:g} rad/s",
        f"{near:g}",
        written(exact.frequency),
        written(fe.frequency),
        f"{frequency:.5g}",
        Ruling.CONFIRMED if fits else Ruling.OVERTURNED,
        f"largest tip impulse {exact.impulse.value:.6g} N s there, {height:.5g} by the scheme as published; so broad a "
        f"peak is the same if it lies within {SAME_PEAK:.0%}",
        "peaks",
    )


def offsets(near: float, peaks: Peaks) -> list[Entry]:
    """How far a peak lies from the frequency of the states with two springs."""
    by_number, by_percent, mode = OFFSETS[near]
    exact, fe = peaks[near]
    omega, heavier = (
        float(analytic.Solver().modes(paper_joint(density=rho), BOTH_BOTTOM, mode).angular_frequencies[-1])
        for rho in (TABLE_4_DENSITY, PAPER_DENSITY)
    )
    state = near - float(by_number)
    share = 100 * float(by_number) / state
    consistent = matches(share, by_percent)
    own = exact.frequency.value - heavier
    side = "below" if own < 0 else "above"
    agrees = (own < 0) == (float(by_number) < 0) and abs(own - float(by_number)) <= SAME_PEAK * near
    place = "Section 3"
    return [
        Entry(
            place,
            f"peak at {near:g} rad/s: offset from mode {mode} of the states with two springs, rad/s",
            by_number,
            f"{own:+.3g}",
            f"{fe.frequency.value - heavier:+.3g}",
            "",
            Ruling.CONFIRMED if agrees else Ruling.OVERTURNED,
            f"one density for both, {PAPER_DENSITY:g}: the state has {heavier:.5g} rad/s, and the peak lies {side} it. "
            f"The paper's frequency of {state:g} belongs to {TABLE_4_DENSITY:g} ({omega:.5g})",
            "peaks",
        ),
        Entry(
            place,
            f"the same in percent of {state:g} rad/s",
            by_percent,
            f"{share:+.3g} %",
            "",
            "",
            Ruling.CONFIRMED if consistent else Ruling.MISPRINT,
            f"{by_number} over {state:g}" if consistent else f"{by_number} over {state:g} is {share:.3g} %",
            "arithmetic",
        ),
    ]


def ratio(high: float, low: float, peaks: Peaks) -> Entry:
    """Ratio of the impulses of two peaks."""
    words, text = RATIOS[high, low]

    def of(i: int) -> Estimate:
        a, b = peaks[high][i].impulse, peaks[low][i].impulse
        value = a.value / b.value
        return Estimate(value, value * (a.uncertainty / a.value + b.uncertainty / b.value), a.how)

    published = published_peak(high)[1] / published_peak(low)[1]
    fits = matches(of(0).value, text)
    return Entry(
        "Section 3",
        f"impulse ratio of the {words} peak, tip stops",
        text,
        written(of(0), 5),
        written(of(1), 5),
        f"{published:.4g}",
        Ruling.CONFIRMED if fits else Ruling.OVERTURNED,
        "rounds to the printed digit"
        if fits
        else "the printed ratio belongs to the truncated scheme"
        if matches(published, text)
        else "neither the converged curve nor the scheme as published gives it",
        "peaks",
    )


def axis(curves: Figure4) -> Entry:
    """Whether the axis of Figure 4 holds the curve."""
    exact, fe, published = (float(np.nanmax(curve.tip)) for curve in (curves.converged, curves.fe, curves.published))
    return Entry(
        "Figure 4",
        "tip impulses lie within 1.5e4 N s",
        f"{AXIS:.3g}",
        f"{exact:.5g}",
        f"{fe:.5g}",
        f"{published:.5g}",
        Ruling.CONFIRMED if exact <= AXIS * 1.05 else Ruling.OVERTURNED,
        f"the largest converged impulse is {exact / AXIS:.2f} times the axis, at "
        f"{curves.converged.omega[np.nanargmax(curves.converged.tip)]:.0f} rad/s",
        "ledger",
    )
