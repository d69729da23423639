"""Which findings remain true for variants of the joint: density, kind of damping, gaps, stiffnesses."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

import analytic
from lapjoint import FREE, Outcome, Problem, ViscousDamping, paper_joint
from lapjoint.campaigns import FREQUENCY, Axis, sweep
from lapjoint.machine.processes import process_pool
from lapjoint.problem.presets import PAPER_DENSITY, TABLE_4_DENSITY
from validation.case import CaseResult, Level, Say, table
from validation.ledger.curves import Curve
from validation.verdict import Criterion

RATIO = 0.08  # Modal damping ratio of the paper's joint
PEAKS = {515.0: 30.0, 820.0: 30.0, 2950.0: 80.0}
"""Frequencies of the peaks, and the half width in which each peak is searched, rad/s."""
WINDOWS = (1398.5, 2060.5, 2160.5)  # Frequencies at which the paper's motions do not settle, rad/s
SYMMETRIC = 1e-3  # Largest difference of the impulses of both tip stops, divided by the larger impulse
LIGHT = "viscous damping"
WORKERS = 2


def scaled(problem: Problem, **factors: float) -> Problem:
    """The joint with gaps and stiffnesses of all stops multiplied."""
    stops = tuple(
        stop.model_copy(update={field: getattr(stop, field) * factor for field, factor in factors.items()})
        for stop in problem.stops
    )
    return problem.replace(stops=stops)


def viscous() -> Problem:
    """The joint with the viscous damping of equation (1): C gives the damping ratio in the first free mode."""
    problem = paper_joint()
    omega = float(analytic.Solver().modes(problem, FREE, 1).angular_frequencies[0])
    return problem.replace(damping=ViscousDamping(coefficient=2 * RATIO * omega * problem.line.m))


VARIANTS: dict[str, Callable[[], Problem]] = {
    f"base case, rho = {PAPER_DENSITY:g}": paper_joint,
    f"rho = {TABLE_4_DENSITY:g}": lambda: paper_joint(density=TABLE_4_DENSITY),
    "gaps + 2 %": lambda: scaled(paper_joint(), gap=1.02),
    "gaps - 2 %": lambda: scaled(paper_joint(), gap=0.98),
    "stiffnesses + 2 %": lambda: scaled(paper_joint(), stiffness=1.02),
    "stiffnesses - 2 %": lambda: scaled(paper_joint(), stiffness=0.98),
    LIGHT: viscous,
}


@dataclass(frozen=True)
class Findings:
    """The findings of the base case, as found in a variant."""

    peaks: tuple[tuple[float, float], ...]
    """Frequency, rad/s, and tip impulse, N s, of the three peaks."""
    settled: int
    """Number of `WINDOWS` in which the motion is symmetric, stable, and of period one."""
    periodic: int | None
    """Number of frequencies of the whole curve with a stable periodic motion; None if the curve was not computed."""
    points: int

    @property
    def ratios(self) -> tuple[float, float]:
        """Ratios of the second to the first, and of the third to the second peak."""
        first, second, third = (height for _, height in self.peaks)
        return second / first, third / second


def curve(problem: Problem, omega: tuple[float, ...], solver: str = "analytic") -> Curve:
    """Steady states over some frequencies."""
    return Curve(sweep(problem, [Axis(FREQUENCY, omega)], solver=solver))


def findings(problem: Problem, points: int, solver: str = "analytic") -> Findings:
    """Peaks, windows and certificates of a variant."""
    tops = []
    for near, reach in PEAKS.items():
        omega = tuple(np.linspace(near - reach, near + reach, 13))
        tops.append(curve(problem, omega, solver).peak(near, reach))
    windows = curve(problem, WINDOWS, solver)
    settled = (windows.dataset.period_multiple.values == 1) & (windows.asymmetry < SYMMETRIC)
    return Findings(tuple(tops), int(settled.sum()), periodic(problem, points) if points else None, points)


def periodic(problem: Problem, points: int) -> int:
    """Number of frequencies of the whole curve with a stable periodic motion, by the analytic solver."""
    whole = curve(problem, tuple(np.linspace(5000.0 / points, 5000.0, points)))
    return sum(
        int(whole.outcome_is(outcome).sum()) for outcome in (Outcome.NO_CONTACT, Outcome.PERIODIC, Outcome.CHATTERING)
    )


def run(level: Level, say: Say) -> CaseResult:
    """Every variant by the analytic solver, and the variant that differs most also by finite elements."""
    points = {"quick": 25, "standard": 100, "full": 500}[level]
    rows, found = [], {}
    # With light damping, motions settle slowly or never.
    counts = [points if label != LIGHT else 0 if level == "quick" else 25 for label in VARIANTS]
    with process_pool(WORKERS) as pool:
        answers = pool.map(findings, [variant() for variant in VARIANTS.values()], counts)
        for label, answer in zip(VARIANTS, answers, strict=True):
            found[label] = answer
            rows.append((label, "analytic", *shown(answer)))
            say(label)
    by_fe = None if level == "quick" else findings(VARIANTS[LIGHT](), 0, "fe")  # it settles slowly
    if by_fe is not None:
        rows.append((LIGHT, "FE", *shown(by_fe)))
    return CaseResult(
        "sensitivity",
        "Which findings stand",
        "The findings of the base case, for both densities, for gaps and stiffnesses 2 % larger and smaller, and for "
        "viscous damping that is as strong as the paper's in the first free mode, and so very light at high frequency. "
        "Peaks are those of the tip stops' impulse; windows are those in which the paper's motions do not settle.",
        criteria=tuple(criteria(found, by_fe)),
        tables=(
            table(
                "Findings by variant",
                (
                    "variant",
                    "solver",
                    "peaks (rad/s)",
                    "impulses (kN s)",
                    "ratios",
                    "windows settled",
                    "periodic on the curve",
                ),
                rows,
            ),
        ),
    )


def shown(it: Findings) -> tuple[str, ...]:
    """A row of the table."""
    return (
        ", ".join(f"{omega:.1f}" for omega, _ in it.peaks),
        ", ".join(f"{height / 1e3:.2f}" for _, height in it.peaks),
        ", ".join(f"{ratio:.2f}" for ratio in it.ratios),
        f"{it.settled} of {len(WINDOWS)}",
        "" if it.periodic is None else f"{it.periodic} of {it.points}",
    )


def criteria(found: dict[str, Findings], by_fe: Findings | None) -> list[Criterion]:
    """Conditions for a finding to be called robust, and the two solvers on the variant that differs most."""
    base = next(iter(found.values()))
    light = found[LIGHT]
    result = []
    for label, it in found.items():
        if it is base or it is light:
            continue
        for (omega, height), (w, h), near in zip(base.peaks, it.peaks, PEAKS, strict=True):
            name = f"{label}: peak near {near:g} rad/s"
            small = "a change of 2 % or less may not move a peak by more"
            result.append(Criterion(f"{name}, frequency over that of the base case", "1", w / omega, 0.98, 1.02, small))
            result.append(Criterion(f"{name}, impulse over that of the base case", "1", h / height, 0.9, 1.1, small))
        windows = float(it.settled)
        result.append(
            Criterion(f"{label}: windows settled", "1", windows, 3, 3, "the windows are artefacts in every variant")
        )
    fe_peaks = () if by_fe is None else by_fe.peaks
    for (w, h), (omega, height), near in zip(light.peaks, fe_peaks, PEAKS, strict=False):
        name = f"viscous damping: peak near {near:g} rad/s, FE over analytic"
        same = "two converged solvers, one grid of frequencies"
        result.append(Criterion(f"{name}, frequency", "1", omega / w, 0.999, 1.001, same))
        result.append(Criterion(f"{name}, impulse", "1", height / h, 0.99, 1.01, same))
    return result
