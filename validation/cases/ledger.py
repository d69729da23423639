"""The ledger: each number and claim of the paper, recomputed by both solvers and by its own scheme, with a ruling."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

import analytic
import fe_lapjoint
from lapjoint import paper_joint
from lapjoint.figures import plot_phase_portrait, plot_poincare_section
from lapjoint.figures.style import entitle
from lapjoint.solver import Solver
from validation.case import CaseResult, Level, Say
from validation.ledger.curves import TIP_BOTTOM, TIP_TOP, Figure4, figure_4
from validation.ledger.entry import TIP, Entry, claims, counted, ledger_table
from validation.ledger.modal import modal_entries
from validation.ledger.numerics import numerical_entries
from validation.ledger.peak_claims import peak_entries
from validation.ledger.tolerance_claims import tolerance_entries
from validation.ledger.window_claims import window_entries
from validation.report.drawing import COLOURS, draw
from validation.verdict import Criterion

if TYPE_CHECKING:
    from matplotlib.axes import Axes

PORTRAITS = (1398.5, 2060.5, 2160.5)  # Frequencies, rad/s, at which the ruling depends on the shape of the motion


def run(level: Level, say: Say) -> CaseResult:
    """Recompute everything, and rule."""
    modal = modal_entries()
    say(f"{len(modal)} claims on frequencies and shapes")
    curves = figure_4(level, say)
    figure = [*peak_entries(curves, level, say), *window_entries(curves)]
    numbers = [*numerical_entries(), *tolerance_entries()]
    entries = [*modal, *figure, *numbers]
    return CaseResult(
        "ledger",
        "The paper on trial",
        "Each number, table and claim of Rahmani and Ervin (2014) beside what both solvers give, and where it bears on "
        "the claim beside what the paper's own scheme gives with its own eight free and five contact modes. Each "
        "ruling follows from the computed numbers by a rule, which stands beside it; the case disagrees if one is not "
        "the ruling that is expected. A printed number is confirmed if the computed ones round to it, or lie within "
        "the reading of a curve; a misprint if it is off by a slip of the pen, or contradicts arithmetic; overturned "
        "if both solvers, converged, say otherwise; where they do not say one thing, it is not decidable.",
        criteria=tuple(decided(entries)),
        tables=(
            ledger_table("Figure 4 and Section 3", figure),
            ledger_table("Frequencies and mode shapes", modal),
            ledger_table("Numerics", numbers),
        ),
        drawings=(
            draw(
                "Figure 4 as published, converged, and by finite elements",
                lambda axes: _paint(axes, curves),
                width=9.0,
                height=4.6,
            ),
            *(
                draw(f"Phase portrait of the tip, {omega:g} rad/s", partial(_paint_phase, omega=omega), width=5.0)
                for omega in PORTRAITS
            ),
        ),
        headline=f"{len(entries)} claims: {counted(entries)}; the verdict is on whether each ruling is as expected",
    )


def decided(entries: list[Entry]) -> list[Criterion]:
    """Whether each claim has the ruling that is expected of it, and none is left out."""
    ruled = {entry.key for entry in entries}
    missing = sorted(set(claims()) - ruled)
    result = [
        Criterion("claims without a ruling", "1", float(len(missing)), 0, 0, ", ".join(missing) or "none is left out")
    ]
    for entry in entries:
        expected, found = entry.claim.expected, entry.ruling
        as_expected = float(found is expected)
        reason = f"expected: {expected.value}; found: {found.value}; by the rule: {entry.rule.words}"
        result.append(Criterion(f"{entry.claim.place}: {entry.claim.claim}", "1", as_expected, 1, 1, reason))
    return result


def _paint_phase(axes: Axes, omega: float) -> None:
    """Velocity over displacement of the tip; dots where the excitation begins a cycle (the Poincare section)."""
    joint = paper_joint(angular_frequency=omega)
    solvers: tuple[tuple[str, str, Solver], ...] = (
        ("scheme as published", "paper", analytic.PublishedScheme()),
        ("converged, analytic", "analytic", analytic.Solver()),
        ("converged, finite elements", "fe", fe_lapjoint.Solver()),
    )
    for label, colour, solver in solvers:
        history = solver.steady_state(joint, sensitivity=False, errors=False).history
        axes.set_prop_cycle(color=[COLOURS[colour]], linestyle=["--" if colour == "fe" else "-"])
        plot_phase_portrait(history, axes, x=TIP, label=label)
        plot_poincare_section(history, axes, x=TIP, label=f"_sections, {label}")


def _paint(axes: Axes, curves: Figure4) -> None:
    for stop, label in ((TIP_BOTTOM, "P2"), (TIP_TOP, "P4")):
        first = stop == TIP_BOTTOM
        for curve, colour, style, width, name in (
            (curves.published, "paper", "-", 0.7, "scheme as published, 8 and 5 modes"),
            (curves.converged, "analytic", "-", 1.3, "converged, analytic"),
            (curves.fe, "fe", ".", 1.3, "converged, finite elements"),
        ):
            impulse, shown = curve.impulse[:, stop] / 1e4, name if first else None
            axes.plot(curve.omega, impulse, style, color=COLOURS[colour], lw=width, ms=3.5, label=shown)
        axes.annotate(label, (4990, 0.75 if stop == TIP_TOP else -0.85), ha="right")
    axes.axhline(1.5, color="0.6", lw=0.6, ls=":")
    axes.axhline(-1.5, color="0.6", lw=0.6, ls=":", label="axis of Figure 4")
    axes.set(xlabel="excitation frequency [rad/s]", ylabel="impulse [10⁴ N s]", xlim=(0, 5000))
    entitle(axes)
