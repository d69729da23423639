"""The first contacts from rest, base case of Table 6: event times and impulses."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from lapjoint import History, paper_joint
from lapjoint.figures import plot_motion
from lapjoint.figures.style import entitle
from validation.case import CaseResult, Drawing, Level, Say, Table, table
from validation.cases.motions import compare_contacts
from validation.invariants import energy, power, witness
from validation.report.drawing import COLOURS, draw
from validation.verdict import Check

if TYPE_CHECKING:
    from matplotlib.axes import Axes

WITNESS_TOLERANCE = 2e-5
"""Error of truncation and of element interpolation at the finest level, divided by the size of the motion."""


def run(level: Level, say: Say) -> CaseResult:
    """Ten contacts at the first peak of the paper's curve."""
    problem, periods, finest = (
        paper_joint(angular_frequency=515.0),
        3,
        {"quick": 48, "standard": 64, "full": 128}[level],
    )
    say(f"first {periods} periods at 515 rad/s")
    checks, exact, fe = compare_contacts(problem, periods * 2 * math.pi / 515.0, 10, finest, cap=1e-3)
    return CaseResult(
        "transient",
        "First contacts from rest, 515 rad/s",
        "From rest, the base begins to move. Both solvers locate every impact and rebound; three numbers of modes and "
        "three meshes give each time and impulse its uncertainty. The witness checks each motion without knowing its "
        "solver.",
        checks=tuple(checks),
        criteria=tuple(item for history in (exact, fe) for item in witness(history, WITNESS_TOLERANCE, history.solver)),
        tables=(contact_table(checks),),
        drawings=(
            motion_drawing("Displacement of the stops, first periods at 515 rad/s", exact, fe),
            energy_drawing("Energy balance, first periods at 515 rad/s", exact, fe),
        ),
    )


def contact_table(checks: list[Check]) -> Table:
    """The contacts as both solvers find them."""
    rows = [
        (c.name, c.a.value, c.a.uncertainty, c.b.value, c.b.uncertainty, f"{abs(c.difference):.1e}", c.unit)
        for c in checks
    ]
    return table("Contacts", ("quantity", "analytic", "u", "FE", "u", "difference", "unit"), rows)


def motion_drawing(title: str, exact: History, fe: History) -> Drawing:
    """Displacement at the stop farthest from the root by both solvers, with gaps, and contacts by the analytic
    solver."""
    x, place = exact.problem.one_position(), exact.problem.line.place
    t = np.linspace(exact.start, min(exact.end, fe.end), 900)

    def paint(axes: Axes) -> None:
        plot_motion(exact, axes, x=x, label="analytic")
        axes.plot(t, 1e3 * fe.displacement(x, t)[0], "--", color=COLOURS["fe"], label=f"FE, x = {place(x)} m")
        entitle(axes)

    return draw(title, paint)


def energy_drawing(title: str, exact: History, fe: History) -> Drawing:
    """Energy in the joint, energy supplied by the base and, as their difference, energy dissipated, by the witness."""
    t = np.linspace(exact.start, min(exact.end, fe.end), 600)

    def paint(axes: Axes) -> None:
        for history, colour, style, name in ((exact, "analytic", "-", "analytic"), (fe, "fe", "--", "FE")):
            stored, rate = energy(history, t) / 1e3, power(history, t) / 1e3
            supplied = np.concatenate([[0.0], np.cumsum((rate[1:] + rate[:-1]) / 2 * np.diff(t))])
            axes.plot(t * 1e3, stored, style, color=COLOURS[colour], label=f"kinetic and elastic, {name}")
            axes.plot(
                t * 1e3, supplied - stored, style, color=COLOURS[colour], lw=0.8, label=f"taken by damping, {name}"
            )
        axes.set(xlabel="time t [ms]", ylabel="energy [kJ]")
        entitle(axes)

    return draw(title, paint)
