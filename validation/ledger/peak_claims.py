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
from validation.ledger.entry import Entry, claims, said, written
from validation.ledger.rules import SAME_PEAK
from validation.verdict import Estimate

BOTH_BOTTOM = ContactState((0, 1))
MODE = {515.0: 1, 820.0: 2, 2950.0: 5}
"""The mode of the states with two springs that the paper measures a peak against."""
LOWER = {820.0: 515.0, 2950.0: 820.0}
"""The peak that the height of one is compared with."""

Peaks = dict[float, tuple[Peak, Peak]]


def peak_entries(curves: Figure4, level: Level, say: Say) -> list[Entry]:
    """Positions, offsets and ratios of all peaks, and the axis."""
    peaks: Peaks = {}
    for near in NEAR:
        _, exact, fe = solve_peak(near, level)
        peaks[near] = exact, fe
        say(f"peak near {near:g} rad/s")
    return [
        *(position(near, peaks) for near in peaks),
        *(entry for near in peaks for entry in offsets(near, peaks)),
        *(ratio(high, peaks) for high in LOWER),
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
    key = f"peak/{near:g}"
    return Entry(
        key,
        {**said(key), "analytic": exact.frequency.value, "fe": fe.frequency.value},
        f"largest tip impulse {exact.impulse.value:.6g} N s there, {height:.5g} by the scheme as published; so broad a "
        f"peak is the same if it lies within {SAME_PEAK:.0%}",
        written(exact.frequency),
        written(fe.frequency),
        f"{frequency:.5g}",
    )


def offsets(near: float, peaks: Peaks) -> list[Entry]:
    """How far a peak lies from the frequency of the states with two springs."""
    exact, fe = peaks[near]
    omega, heavier = (
        float(analytic.Solver().modes(paper_joint(density=rho), BOTH_BOTTOM, MODE[near]).angular_frequencies[-1])
        for rho in (TABLE_4_DENSITY, PAPER_DENSITY)
    )
    key, in_percent = f"offset/{near:g}", f"offset in percent/{near:g}"
    by_number, by_percent = claims()[key].printed, said(in_percent)
    state = near - float(by_number)
    share = 100 * float(by_number) / state
    own = [peak.frequency.value - heavier for peak in (exact, fe)]
    return [
        Entry(
            key,
            {**said(key), "peak": near, "analytic": own[0], "fe": own[1]},
            f"one density for both, {PAPER_DENSITY:g}: the state has {heavier:.5g} rad/s, and the peak lies "
            f"{'below' if own[0] < 0 else 'above'} it. The paper's frequency of {state:g} belongs to "
            f"{TABLE_4_DENSITY:g} ({omega:.5g})",
            f"{own[0]:+.3g}",
            f"{own[1]:+.3g}",
        ),
        Entry(
            in_percent,
            {**by_percent, "by arithmetic": share},
            f"{by_number} over {state:g} is {share:.3g} %",
            f"{share:+.3g} %",
        ),
    ]


def ratio(high: float, peaks: Peaks) -> Entry:
    """Ratio of the impulses of two peaks."""
    low, key = LOWER[high], f"peak ratio/{high:g}"

    def of(i: int) -> Estimate:
        a, b = peaks[high][i].impulse, peaks[low][i].impulse
        value = a.value / b.value
        return Estimate(value, value * (a.uncertainty / a.value + b.uncertainty / b.value), a.how)

    published = published_peak(high)[1] / published_peak(low)[1]
    exact, fe = of(0), of(1)
    printed = said(key)
    belongs = abs(published - printed["printed"]) <= printed["half unit"]
    return Entry(
        key,
        {**printed, "analytic": exact.value, "fe": fe.value},
        f"the scheme as published gives {published:.4g}, {'as' if belongs else 'not as'} printed",
        written(exact, 5),
        written(fe, 5),
        f"{published:.4g}",
    )


def axis(curves: Figure4) -> Entry:
    """Whether the axis of Figure 4 holds the curve."""
    exact, fe, published = (float(np.nanmax(curve.tip)) for curve in (curves.converged, curves.fe, curves.published))
    printed = said("axis")
    return Entry(
        "axis",
        {**printed, "analytic": exact, "fe": fe},
        f"the largest converged impulse is {exact / printed['printed']:.2f} times the axis, at "
        f"{curves.converged.omega[np.nanargmax(curves.converged.tip)]:.0f} rad/s",
        f"{exact:.5g}",
        f"{fe:.5g}",
        f"{published:.5g}",
    )
