"""Convergence of the finite element frequencies to the analytic ones: order 4, down to the round-off floor."""

from __future__ import annotations

import math
from functools import partial
from typing import TYPE_CHECKING

import numpy as np
from cycler import cycler

import analytic
import fe_lapjoint
from lapjoint import FREE, ContactState, paper_joint
from lapjoint.answers.observed_order import fitted_order
from lapjoint.figures import plot_convergence
from lapjoint.figures.style import COLOURS as PALETTE
from lapjoint.problem import FloatArray
from validation.case import CaseResult, Level, Say, table
from validation.report.drawing import draw
from validation.verdict import Criterion

if TYPE_CHECKING:
    from matplotlib.axes import Axes

MODES = 8  # Number of the lowest modes of each state
SHOWN = (0, 1, 3, 7)  # Modes of the figure
FLOOR = 1e-9  # Relative rounding error of the dense eigenproblem: see the table


def run(level: Level, say: Say) -> CaseResult:
    """Errors over meshes in the free state and with both bottom stops closed."""
    meshes = (12, 16, 24, 32, 48, 64, 96, 128) if level != "full" else (12, 16, 24, 32, 48, 64, 96, 128, 160)
    problem = paper_joint()
    criteria, rows, studies = [], [], {}
    for label, state in (("free", FREE), ("states 6 to 9", ContactState((0, 1)))):
        say(label)
        exact = analytic.Solver().modes(problem, state, MODES).angular_frequencies
        found = [fe_lapjoint.Solver(elements=n).modes(problem, state, MODES).angular_frequencies for n in meshes]
        error = np.abs(np.array(found) / exact - 1)  # (meshes, modes)
        studies[label] = (exact, dict(zip(meshes, found, strict=True)))
        for i in range(MODES):
            above = (error[:, i] > 30 * FLOOR) & (error[:, i] < 1e-2)
            last = np.flatnonzero(above)[-3:]
            order = fitted_order(np.array(meshes)[last], error[last, i])
            if math.isfinite(order):
                criteria.append(
                    Criterion(
                        f"{label}: observed order of omega_{i + 1}",
                        "1",
                        order,
                        3.9,
                        4.1,
                        "Hermite elements: order 4",
                    )
                )
            rows.append((label, i + 1, f"{order:.3f}", *(f"{e:.1e}" for e in error[:, i])))
        best = error.min(axis=0)
        criteria.append(Criterion(f"{label}: omega_1 at the best mesh", "1", float(best[0]), 0.0, 1e-8, "required"))
        criteria.append(
            Criterion(f"{label}: omega_1 to omega_8 at the best mesh", "1", float(best.max()), 0.0, 1e-6, "required")
        )

    return CaseResult(
        "fe-order",
        "Convergence of the finite element frequencies",
        "Cubic Hermite elements with consistent mass converge at order 4 in frequency. The order is fitted over the "
        f"last three meshes whose error exceeds thirty times the floor of {FLOOR:g}, below which round-off of the "
        "eigenproblem takes over. The figure's key has the order over all meshes above that.",
        criteria=tuple(criteria),
        tables=(
            table(
                "Relative error of FE frequencies, by number of elements",
                ("state", "mode", "order", *map(str, meshes)),
                rows,
            ),
        ),
        drawings=(draw("Convergence of the FE frequencies", partial(_paint, studies=studies)),),
    )


def _paint(axes: Axes, studies: dict[str, tuple[FloatArray, dict[int, FloatArray]]]) -> None:
    """Modes by colour, states by line."""
    axes.set_prop_cycle(cycler(linestyle=("-", "--")) * cycler(color=PALETTE[: len(SHOWN)]))
    for label, (exact, found) in studies.items():
        for i in SHOWN:
            answers = {elements: float(omega[i]) for elements, omega in found.items()}
            name = f"{label}, mode {i + 1}"
            plot_convergence(answers, axes, reference=float(exact[i]), label=name, order=4, floor=30 * FLOOR)
    axes.set_xlabel("number of elements")
