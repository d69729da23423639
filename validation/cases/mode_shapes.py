"""Mode shapes of the nine states: MAC, pointwise difference, and two ratios that the paper states."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

import analytic
import fe_lapjoint
from lapjoint import FREE, ContactState, Problem, contact_states, paper_joint, paper_state_number
from lapjoint.figures import plot_state_shapes
from lapjoint.figures.mode_shapes import state_groups
from lapjoint.problem import FloatArray
from validation.case import CaseResult, Drawing, Level, Say, table
from validation.references.reading import printed
from validation.report.drawing import draw, drawing
from validation.uncertainty import elements, refined_estimate
from validation.verdict import Check, Criterion, Estimate

if TYPE_CHECKING:
    from matplotlib.axes import Axes

MODES = 8  # Number of the lowest modes of each state


def mac(a: FloatArray, b: FloatArray) -> FloatArray:
    """Modal assurance criterion of two sets of shapes sampled at the same points, ``(modes, points)`` each."""
    return np.asarray((a @ b.T) ** 2 / np.outer((a**2).sum(axis=1), (b**2).sum(axis=1)))


def run(level: Level, say: Say) -> CaseResult:
    """Compare shapes at k* = 5000, where contact changes them most."""
    problem, elements = paper_joint(k_star=5000.0), 96 if level == "full" else 64
    x = np.linspace(0.0, problem.line.length, 501)
    rows, criteria, first = [], [], None
    for state in contact_states(problem):
        label = paper_state_number(problem, state)
        say(f"state {label}")
        a = analytic.Solver().modes(problem, state, MODES).shapes(x)
        b = fe_lapjoint.Solver(elements=elements).modes(problem, state, MODES).shapes(x)
        assurance = mac(a, b)
        first = assurance if label == 6 else first
        criteria.append(upwards(problem, state, label))
        b = b * np.sign((a * b).sum(axis=1))[:, None]
        off = assurance - np.diag(np.diag(assurance))
        pointwise = float(np.max(np.abs(a - b)) / np.max(np.abs(a)))
        rows.append((label, f"{1 - np.diag(assurance).min():.1e}", f"{off.max():.3f}", f"{pointwise:.1e}"))
        reason = f"interpolation error of {elements} cubic elements at the eighth mode is (beta h)^4 / 384"
        criteria.append(
            Criterion(
                f"state {label}: 1 - MAC of equal modes",
                "1",
                float(1 - np.diag(assurance).min()),
                -1e-12,
                1e-9,
                reason,
            )
        )
        bound = (7.5 * np.pi / elements) ** 4 / 384 * 4
        criteria.append(
            Criterion(
                f"state {label}: largest pointwise difference",
                "1",
                pointwise,
                0.0,
                float(bound),
                reason + ", times 4",
            )
        )
    assert first is not None

    def paint(axes: Axes) -> None:
        image = axes.imshow(first, cmap="Blues", vmin=0, vmax=1, extent=(0.5, MODES + 0.5, MODES + 0.5, 0.5))
        axes.set(xlabel="FE mode", ylabel="analytic mode")
        axes.grid(False)
        assert axes.figure is not None
        axes.figure.colorbar(image, ax=axes, label="MAC")

    return CaseResult(
        "mode-shapes",
        "Mode shapes of the nine states",
        f"Mass-normalised shapes at k* = 5000, sampled at 501 points, from the analytic solver and {elements} "
        "elements. The ratios compare the tip of state 2 with the tip of the free beam, mode by mode, as the paper "
        "does in Section 2.2. States with equal springs share their shapes; lines are analytic, dots finite elements.",
        checks=tuple(tip_ratios()),
        criteria=tuple(criteria),
        tables=(
            table(
                "Agreement of shapes",
                ("state", "1 - MAC, equal modes", "MAC, unlike modes", "largest difference"),
                rows,
            ),
        ),
        drawings=(
            draw("MAC, state 6, k* = 5000", paint, width=4.2),
            shapes_drawing(problem),
        ),
    )


def shapes_drawing(problem: Problem, count: int = 3) -> Drawing:
    """The first modes of the nine states: analytic lines, and finite elements as dots."""
    exact = [analytic.Solver().modes(problem, state, count) for state in contact_states(problem)]
    panels = plot_state_shapes(problem, exact, count=count)
    for axes, group in zip(panels, state_groups(problem, exact), strict=True):
        lines = [line for line in axes.get_lines() if not str(line.get_label()).startswith("_")]
        fe = fe_lapjoint.Solver().modes(problem, group[0].state, count).shapes(np.asarray(lines[0].get_xdata()))
        for line, shape in zip(lines, fe, strict=True):
            x, drawn = np.asarray(line.get_xdata()), np.asarray(line.get_ydata())
            axes.plot(x[::20], np.sign(drawn @ shape) * shape[::20], ".", color=line.get_color(), markersize=4)
    return drawing("The first modes of the nine states, k* = 5000", panels)


def upwards(problem: Problem, state: ContactState, label: int | None) -> Criterion:
    """Number of modes of the analytic solver with phi + d3 phi / beta^3 above 0 at the tip, as all should have."""
    modes, tip = analytic.Solver().modes(problem, state, MODES), np.array([problem.line.length])
    beta = (modes.angular_frequencies**2 * problem.line.m / problem.line.EI) ** 0.25
    count = float(np.sum(modes.shapes(tip)[:, 0] + modes.shapes(tip, 3)[:, 0] / beta**3 > 0))
    return Criterion(f"state {label}: modes that point upwards", "1", count, MODES, MODES, "so that signs go on")


def tip_ratios() -> list[Check]:
    """|Phi(L)| in state 2, divided by that of the free beam, in hard contact: the paper has 0.32 % and 1.67 %."""
    problem = paper_joint(k_star=5000.0)
    tip = np.array([problem.line.length])
    checks = []

    def ratio(solver: analytic.Solver | fe_lapjoint.Solver, i: int) -> float:
        closed, free = (solver.modes(problem, s, MODES).shapes(tip)[i, 0] for s in (ContactState((0,)), FREE))
        return float(abs(closed / free) * 100)

    explanations = (
        "The paper's 0.32 % is not what its own definition gives: both solvers find the same smaller ratio with "
        "mass-normalised shapes (16)-(17), while the second mode's ratio agrees. Why the first was printed "
        "so cannot be "
        "told from the text.",
        "",
    )
    for i, explanation in enumerate(explanations):
        a = Estimate(ratio(analytic.Solver(), i), 1e-9, "closed form")
        fe = refined_estimate(
            [ratio(fe_lapjoint.Solver(elements=n), i) for n in (16, 32, 64)], 2.0, 4.0, elements(64), 1e-8
        )
        paper = printed("tip ratios", str(i + 1)).estimate()
        checks.append(Check(f"tip of state 2 over free, mode {i + 1}", "%", a, fe))
        checks.append(Check(f"tip of state 2 over free, mode {i + 1}, printed", "%", a, paper, explanation=explanation))
    return checks
