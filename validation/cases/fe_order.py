"""Convergence of the finite element frequencies to the analytic ones: order 4, down to the round-off floor."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

import analytic
import fe_lapjoint
from lapjoint import FREE, ContactState, paper_joint
from validation.case import CaseResult, Level, Say, table
from validation.drawing import draw
from validation.quantity import Criterion

if TYPE_CHECKING:
    from matplotlib.axes import Axes

MODES = 8
FLOOR = 1e-9  # relative errors below are round-off of the dense eigenproblem: see the table


def run(level: Level, say: Say) -> CaseResult:
    """Errors over meshes in the free state and with both bottom stops closed."""
    meshes = (12, 16, 24, 32, 48, 64, 96, 128) if level != "full" else (12, 16, 24, 32, 48, 64, 96, 128, 160)
    problem = paper_joint()
    criteria, rows, curves = [], [], {}
    for label, state in (("free", FREE), ("states 6 to 9", ContactState((0, 1)))):
        say(label)
        exact = analytic.Solver().modes(problem, state, MODES).angular_frequencies
        found = [fe_lapjoint.Solver(elements=n).modes(problem, state, MODES).angular_frequencies for n in meshes]
        error = np.abs(np.array(found) / exact - 1)  # (meshes, modes)
        curves[label] = error
        for i in range(MODES):
            above = (error[:, i] > 30 * FLOOR) & (error[:, i] < 1e-2)
            order = math.nan
            if above.sum() >= 2:
                last = np.flatnonzero(above)[-3:]
                order = -float(np.polyfit(np.log(np.array(meshes)[last]), np.log(error[last, i]), 1)[0])
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

    def paint(axes: Axes) -> None:
        for (label, error), style in zip(curves.items(), ("-", "--"), strict=True):
            for i in (0, 1, 3, 7):
                axes.loglog(meshes, error[:, i], style, marker="o", ms=3, label=f"{label}, mode {i + 1}")
        n = np.array(meshes, dtype=float)
        axes.loglog(n, 2e-2 * (n / n[0]) ** -4.0, ":", color="#666666", label="order 4")
        axes.set(xlabel="elements", ylabel="relative error of frequency")
        axes.legend(fontsize=7, ncols=2)

    return CaseResult(
        "fe-order",
        "Convergence of the finite element frequencies",
        "Cubic Hermite elements with consistent mass converge at order 4 in frequency. The order is fitted over the "
        f"last three meshes whose error exceeds thirty times the floor of {FLOOR:g}, below which round-off of the "
        "eigenproblem takes over.",
        criteria=tuple(criteria),
        tables=(
            table(
                "Relative error of FE frequencies, by number of elements",
                ("state", "mode", "order", *map(str, meshes)),
                rows,
            ),
        ),
        drawings=(draw("Convergence of the FE frequencies", paint),),
    )
