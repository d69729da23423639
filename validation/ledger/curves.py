"""Figure 4 three times: by the scheme as published, converged, and by finite elements."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from lapjoint import Outcome, paper_joint
from lapjoint.campaigns import FREQUENCY, Axis, sweep
from lapjoint.problem import FloatArray
from validation.case import Level, Say

if TYPE_CHECKING:
    import xarray as xr

PUBLISHED = "analytic-published"
WORKERS = 2
# Spacing of the analytic, the published and the finite element curve, rad/s.
STEPS = {"quick": (10.0, 50.0, 100.0), "standard": (5.0, 20.0, 50.0), "full": (1.0, 10.0, 25.0)}
TIP_BOTTOM, TIP_TOP = 0, 2  # P2 and P4, the two that Figure 4 shows


@dataclass(frozen=True)
class Curve:
    """Impulses against frequency by one solver."""

    dataset: xr.Dataset

    @property
    def omega(self) -> FloatArray:
        """Excitation frequency, rad/s, shape (n,)."""
        return np.asarray(self.dataset[self.dataset.impulse.dims[0]].values)

    @property
    def impulse(self) -> FloatArray:
        """Impulse per excitation period, N s, shape (n, stops); NaN where the solver gave up."""
        return np.asarray(self.dataset.impulse.values)

    @cached_property
    def tip(self) -> FloatArray:
        """The larger magnitude of the two tip stops' impulses, N s, shape ``(n,)``."""
        return np.asarray(np.abs(self.impulse[:, [TIP_BOTTOM, TIP_TOP]]).max(axis=1))

    @cached_property
    def asymmetry(self) -> FloatArray:
        """Difference of the magnitudes of P2 and P4 over the larger, shape ``(n,)``; 0 where neither is struck."""
        a, b = np.abs(self.impulse[:, TIP_BOTTOM]), np.abs(self.impulse[:, TIP_TOP])
        return np.asarray(np.abs(a - b) / np.maximum(np.maximum(a, b), 1e-9), dtype=float)

    @cached_property
    def longest_contact(self) -> FloatArray:
        """The longest contact at each point over the excitation period, shape (n,); a contact cut by the ends of the
        recorded motion counts whole."""
        counts = self.dataset.contact_count.values
        owner = np.repeat(np.arange(counts.size), counts)
        stops = self.dataset.contact_stop.values
        cut = self.dataset.contact_cut.values != 0
        duration = self.dataset.contact_duration.values
        whole = np.zeros((counts.size, int(stops.max(initial=0)) + 1))
        np.add.at(whole, (owner[cut], stops[cut]), duration[cut])
        longest = whole.max(axis=1)
        np.maximum.at(longest, owner[~cut], duration[~cut])
        return np.asarray(longest * self.omega / (2 * np.pi))

    def outcome_is(self, outcome: Outcome) -> np.ndarray:
        """Whether the certificate states this outcome, shape (n,)."""
        attributes = self.dataset.outcome.attrs
        names = attributes["flag_meanings"].split()
        flag = attributes["flag_values"][names.index(outcome.name.lower())]
        return np.asarray(self.dataset.outcome.values == flag)

    def between(self, low: float, high: float) -> np.ndarray:
        """Indices of the frequencies in a range, ends included."""
        return np.flatnonzero((self.omega >= low) & (self.omega <= high))

    def peak(self, near: float, reach: float) -> tuple[float, float]:
        """Frequency and height of the tip's largest impulse within `reach` of `near`, by the parabola at the top."""
        here = self.between(near - reach, near + reach)
        i = int(here[np.nanargmax(self.tip[here])])
        if not 0 < i < self.omega.size - 1:
            return float(self.omega[i]), float(self.tip[i])
        a, b, c = self.tip[i - 1 : i + 2]
        bend = a - 2 * b + c
        shift = 0.5 * (a - c) / bend if bend < 0 else 0.0
        step = self.omega[i + 1] - self.omega[i]
        return float(self.omega[i] + np.clip(shift, -1, 1) * step), float(b - 0.25 * (a - c) * np.clip(shift, -1, 1))


@dataclass(frozen=True)
class Figure4:
    """The three curves."""

    converged: Curve
    published: Curve
    fe: Curve


def figure_4(level: Level, say: Say) -> Figure4:
    """Compute the curves over 0 to 5000 rad/s, base case of Table 6."""
    curves = []
    for solver, step in zip(("analytic", PUBLISHED, "fe"), STEPS[level], strict=True):
        omega = np.arange(step, 5000.0 + step / 2, step)
        curves.append(Curve(sweep(paper_joint(), [Axis(FREQUENCY, tuple(omega))], solver=solver, workers=WORKERS)))
        say(f"curve of {omega.size} frequencies, {solver}")
    return Figure4(*curves)


def at(solver: str, frequencies: tuple[float, ...]) -> Curve:
    """Steady states at a few frequencies; fast solvers use this process alone."""
    workers = WORKERS if solver == PUBLISHED else 1
    return Curve(sweep(paper_joint(), [Axis(FREQUENCY, frequencies)], solver=solver, workers=workers))
