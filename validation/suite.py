"""The validation suite: runs its cases, prints their verdicts, writes the reports."""

from __future__ import annotations

import tempfile
import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from lapjoint.errors import InputError
from lapjoint.files.plain_text import escaped
from lapjoint.files.writing import unwritable
from validation.case import CaseResult, Level, Say
from validation.verdict import Verdict

if TYPE_CHECKING:
    from rich.console import Console

    from lapjoint.problem import Problem

Run = Callable[[Level, Say], CaseResult]
_MODULES = {
    "as-given": "as_given",
    "parts-as-given": "parts_as_given",
    "pinned-beam": "pinned_beam",
    "records": "records",
    "random-signal": "random_signal",
    "summaries": "summaries",
    "shared-record": "shared_record",
    "rigid-bar": "rigid_bar",
    "settled": "settled",
    "orbit-watch": "orbit_watch",
    "balance": "balance",
    "ledger": "ledger",
    "textbook": "textbook",
    "masses-and-steps": "masses_and_steps",
    "linked-beams": "linked_beams",
    "colliding-beams": "colliding_beams",
    "dragged-masses": "dragged_masses",
    "table4": "table4",
    "fe-order": "fe_order",
    "mode-shapes": "mode_shapes",
    "sdnl104": "sdnl104",
    "sdnl105": "sdnl105",
    "sdnd101": "sdnd101",
    "sdnd102": "sdnd102",
    "sdnd108": "sdnd108",
    "damped-stops": "damped_stops",
    "pressed": "pressed",
    "limits": "limits",
    "resting": "resting",
    "together": "together",
    "one-mode": "one_mode",
    "certified-steps": "certified_steps",
    "grazing": "grazing",
    "transient": "transient",
    "slow-modes": "slow_modes",
    "random-linear": "random_linear",
    "random-stops": "random_stops",
    "fatigue": "fatigue",
    "as-published": "as_published",
    "branches": "branches",
    "steady": "steady",
    "peaks": "peaks",
    "aperiodic": "aperiodic",
    "mode-map": "mode_map",
    "sensitivity": "sensitivity",
}
PEERS = "peers"  # Name of the case that other solvers make
_COLOURS = {Verdict.AGREE: "green", Verdict.DISAGREE: "red", Verdict.EXPLAINED: "yellow"}
_MOST_LINES = 12  # Most lines on the console about comparisons that do not agree


def case_names() -> tuple[str, ...]:
    """Names of the cases of the suite, in the order in which they run."""
    return tuple(_MODULES)


def main(
    problem: Problem | None,
    cases: tuple[str, ...],
    level: Level,
    output: Path,
    console: Console,
    peers: tuple[str, ...] = (),
    *,
    source: str = "",
    duration: float | None = None,
) -> int:
    """Run the suite, or compare the solvers on one problem, and write the reports.

    Parameters
    ----------
    problem : Problem, optional
        A user's problem; None runs the suite.
    cases : tuple of str
        Cases to run; empty: all.
    level : "quick", "standard" or "full"
        How far meshes and numbers of modes are refined.
    output : Path
        Directory for ``report.json`` and ``report.html``.
    console : rich.console.Console
        Where progress and verdicts go.
    peers : tuple of str
        Further solvers to compare with, by their entry-point names.
    source : str
        Where the user's problem comes from, as the command line names it.
    duration : float, optional
        Duration of motions under records and random excitation, s; by default the record's, or long enough.

    Returns
    -------
    int
        0 if all agree, or differ for a reason that is named; 1 if something disagrees.

    Raises
    ------
    InputError
        For an unknown case, or a peer that does not answer.
    OutputError
        If the output cannot be written.
    """
    from validation.report.write import write_reports

    others = tuple(name for name in cases if name != PEERS)
    if len(others) < len(cases) and not peers:
        raise InputError(f"case = {PEERS!r}: name the solvers to compare with, as in --peers opensees")
    runs: dict[str, Run] = {}
    if others or not cases:
        runs = _chosen(others) if problem is None else _own(problem, others, level, duration)
    if peers:
        runs[PEERS] = _peers(problem, peers)
    output = writable(output)
    results, begin = [], time.perf_counter()
    for name, run in runs.items():
        started = time.perf_counter()
        console.print(f"[bold]{name}[/bold]", highlight=False)

        def say(line: str, name: str = name) -> None:
            console.print(f"  {escaped(line)}", highlight=False, style="dim", markup=False)

        result = run(level, say)
        results.append(replace(result, seconds=time.perf_counter() - started))
        _summary(results[-1], console)
    pages = write_reports(results, level, output, time.perf_counter() - begin, problem, source)
    _table(results, console)
    written = escaped(", ".join(str(page) for page in pages))
    console.print(f"\nreports: {written}", highlight=False, markup=False, soft_wrap=True)
    return 1 if any(result.verdict is Verdict.DISAGREE for result in results) else 0


def modules_of(cases: tuple[str, ...]) -> tuple[str, ...]:
    """Modules in `validation.cases`, in the order of the suite.

    Parameters
    ----------
    cases : tuple of str
        Names of cases; empty: all.

    Returns
    -------
    tuple of str
        Names of modules.

    Raises
    ------
    InputError
        For an unknown case.
    """
    unknown = [name for name in cases if name not in _MODULES]
    if unknown:
        raise InputError(f"case = {unknown[0]!r} is unknown; allowed: {', '.join(_MODULES)}")
    return tuple(module for name, module in _MODULES.items() if not cases or name in cases)


def _chosen(cases: tuple[str, ...]) -> dict[str, Run]:
    from importlib import import_module

    names = {module: name for name, module in _MODULES.items()}
    return {names[module]: import_module(f"validation.cases.{module}").run for module in modules_of(cases)}


def _own(problem: Problem, cases: tuple[str, ...], level: Level, duration: float | None) -> dict[str, Run]:
    from validation.cases import own_problem

    def bound(part: Callable[[Problem, Level, Say], CaseResult]) -> Run:
        return lambda level, say: part(problem, level, say)

    runs = {"frequencies": bound(own_problem.frequencies)}
    if own_problem.has_equilibrium(problem):
        runs["equilibrium"] = bound(own_problem.equilibrium)
    runs["transient"] = bound(own_problem.transient)
    if problem.excitation_frequency is not None:
        runs["steady"] = bound(own_problem.steady)
    if own_problem.statistics_lasting(problem, level, duration):
        runs["statistics"] = lambda level, say: own_problem.statistics(problem, level, say, duration)
    elif duration is not None:
        raise InputError(f"duration = {duration:g}: this problem has no record and no random excitation")
    unknown = [name for name in cases if name not in runs]
    if unknown:
        raise InputError(f"case = {unknown[0]!r}: this problem has {', '.join(runs)}")
    return {name: run for name, run in runs.items() if not cases or name in cases}


def _peers(problem: Problem | None, names: tuple[str, ...]) -> Run:
    from validation.cases import peers

    peers.check_peers(names)
    return lambda level, say: peers.run(problem, names, level, say)


def writable(output: Path) -> Path:
    """Make the folder of the reports, and see that files can be written there.

    Parameters
    ----------
    output : Path
        The folder.

    Returns
    -------
    Path
        The same.

    Raises
    ------
    InputError
        If they cannot.
    """
    try:
        output.mkdir(parents=True, exist_ok=True)
        tempfile.TemporaryFile(dir=output).close()
    except OSError as error:
        raise unwritable(output, error) from None
    return output


def _summary(result: CaseResult, console: Console) -> None:
    colour = _COLOURS[result.verdict]
    console.print(
        f"  [{colour}]{result.verdict.value}[/{colour}]: {len(result.items)} comparisons in {result.seconds:.1f} s",
        highlight=False,
    )
    shown = 0
    for item in result.items:
        if item.verdict is Verdict.AGREE:
            continue
        shown += 1
        if shown <= _MOST_LINES:
            console.print(
                f"    {item.verdict.value}: {escaped(item.line)}", highlight=False, markup=False, soft_wrap=True
            )
    if shown > _MOST_LINES:
        console.print(f"    and {shown - _MOST_LINES} more, in the report", highlight=False)


def _table(results: list[CaseResult], console: Console) -> None:
    """One line a case, by its name, within 80 columns."""
    from rich import box
    from rich.markup import escape
    from rich.table import Table

    table = Table(
        title="Verdicts", box=box.SIMPLE_HEAD, caption="of allowed: the largest difference over what is allowed"
    )
    table.add_column("case", overflow="ellipsis", no_wrap=True, max_width=_NAME_SHOWN)
    table.add_column("verdict")
    for column in (*(verdict.value for verdict in _COUNTED), "of allowed"):
        table.add_column(column, justify="right")
    for result in results:
        counts = [sum(item.verdict is verdict for item in result.items) for verdict in _COUNTED]
        used = max((c.used for c in result.checks if c.verdict is Verdict.AGREE), default=0.0)
        colour = _COLOURS[result.verdict]
        table.add_row(
            escape(escaped(result.name)),
            f"[{colour}]{result.verdict.value}[/{colour}]",
            *map(str, counts),
            f"{used:.2f}",
        )
    console.print(table)


_NAME_SHOWN = 24  # Most characters of a case's name in the table
_COUNTED = (Verdict.AGREE, Verdict.EXPLAINED, Verdict.DISAGREE)
