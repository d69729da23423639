"""The commands ``lapjoint modes``, ``lapjoint simulate`` and ``lapjoint steady``: one answer, printed and drawn."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import click

from lapjoint.cli.completing import FILE
from lapjoint.cli.motions import find_motion, find_steady_state
from lapjoint.cli.options import (
    DRAWINGS,
    FIGURES,
    AnswerFiles,
    SolverChoice,
    answer_options,
    problem_options,
    solver_options,
)

if TYPE_CHECKING:
    from lapjoint import History


@click.command()
@problem_options
@solver_options
@click.option("--state", default="all", show_default=True, help="Names of closed stops (P2+P4), free, 1-9, or all.")
@click.option("--hz", is_flag=True, help="Print frequencies in Hz instead of angular frequencies in rad/s.")
@click.option("--json", "json_path", metavar="FILE", type=FILE, help="Also write the frequencies to FILE as JSON.")
@click.option(
    "--figure",
    metavar="FILE",
    type=FILE,
    help="Draw the mode shapes to FILE, .png, .svg or .pdf; if there are several states, three shapes of each.",
)
def modes(
    problem: str,
    overrides: tuple[str, ...],
    state: str,
    hz: bool,
    json_path: str | None,
    figure: str | None,
    solver: SolverChoice,
) -> None:
    """Print natural frequencies of the contact states of PROBLEM, the lowest 6 or as many as --n-modes says."""
    from lapjoint.cli import arguments, printing
    from lapjoint.solver import MODES

    arguments.check_file("--figure", figure, *FIGURES)
    arguments.check_file("--json", json_path)
    this = arguments.problem_from(problem, overrides)
    states = arguments.states_from(this, state)
    answering = solver._replace(n_modes=None).make()
    answers = [answering.modes(this, one, MODES if solver.n_modes is None else solver.n_modes) for one in states]
    printing.print_modes(this, answering.name, answers, hz)
    if json_path:
        printing.write_json(json_path, printing.modes_summary(this, answering.name, answers))
    if figure:
        from lapjoint.figures import plot_mode_shapes, plot_state_shapes, save

        one = len(answers) == 1
        save(plot_mode_shapes(this, answers[0], hz=hz) if one else plot_state_shapes(this, answers, hz=hz), figure)


@click.command()
@problem_options
@solver_options
@click.option("--duration", type=float, help="Time to simulate from the initial state, s; by default the record's.")
@answer_options
def simulate(
    problem: str,
    overrides: tuple[str, ...],
    duration: float | None,
    errors: bool,
    files: AnswerFiles,
    solver: SolverChoice,
) -> None:
    """Simulate PROBLEM from its initial state, and print its contacts."""
    from lapjoint.cli import arguments, printing

    arguments.check_answer_files(files)
    arguments.check_duration(duration)
    this = arguments.problem_from(problem, overrides)
    drawing = arguments.drawing_from(this, files, files.series is not None)
    lasting = arguments.duration_of(this, duration)
    series = arguments.series_from(this, files, lasting)
    history = find_motion(this, solver.make(), lasting, errors)
    printing.print_history(history)
    write_results(history, files, series, drawing)


@click.command()
@problem_options
@solver_options
@answer_options
@click.option("--json", "json_path", metavar="FILE", type=FILE, help="Write the steady state to FILE as JSON.")
def steady(
    problem: str,
    overrides: tuple[str, ...],
    errors: bool,
    files: AnswerFiles,
    json_path: str | None,
    solver: SolverChoice,
) -> None:
    """Find the steady state of PROBLEM, and print the impulse of each stop over one excitation period."""
    from lapjoint import Outcome
    from lapjoint.cli import arguments, printing

    arguments.check_answer_files(files)
    arguments.check_file("--json", json_path)
    this = arguments.problem_from(problem, overrides)
    drawing = arguments.drawing_from(this, files, True)
    series = arguments.series_from(this, files, None)
    shown = None if files.at is None else arguments.places_from(files.at, this)
    found = find_steady_state(this, solver.make(), errors)
    printing.print_steady_state(found, shown)
    write_results(found.history, files, series, drawing)
    if json_path:
        printing.write_json(json_path, printing.steady_state_summary(found, shown))
    click.get_current_context().exit(1 if found.outcome is Outcome.UNDECIDED else 0)


def write_results(history: History, files: AnswerFiles, series: dict[str, Any], drawing: dict[str, Any]) -> None:
    """Write the files that were requested; `series` are arguments of `time_series`, `drawing` those of the figure."""
    if files.contacts:
        from lapjoint.answers.contact_files import write_contacts

        write_contacts(history, files.contacts)
    if files.series:
        from lapjoint.answers.series import time_series, write_series

        write_series(time_series(history, **series), files.series)
    if files.figure:
        from lapjoint import figures

        draw = getattr(figures, DRAWINGS[files.draw or "motion"].function)
        figures.save(draw(history, **drawing), files.figure)
