"""The command ``lapjoint``.

Exit status: 0 when all went well; 1 when something disagrees, the solver had to give up, or what remains of a motion
could not be established; 2 for bad input, with a message and no traceback; 130 after Ctrl-C.

Everything heavy is imported inside the functions that need it, so that ``lapjoint --help`` answers at once.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import click

from validation.cli_look import export, show
from validation.cli_motion import find_motion, find_steady_state
from validation.cli_options import DRAWINGS, FIGURES, figure_options, problem_options, solver_options

if TYPE_CHECKING:
    from lapjoint import History

CONTACTS = (".csv", ".json")


class Lapjoint(click.Group):
    """A group that turns the errors a user can cause into a message and an exit status."""

    def invoke(self, ctx: click.Context) -> Any:
        """Run the command; see the module's head for the exit status."""
        try:
            return super().invoke(ctx)
        except (click.ClickException, click.Abort, click.exceptions.Exit):
            raise
        except KeyboardInterrupt as interrupt:
            click.echo(f"lapjoint: {str(interrupt) or 'interrupted'}", err=True)
            ctx.exit(130)
        except (ValueError, RuntimeError, MemoryError) as error:
            from lapjoint.errors import InputError, OutputError, SolverError

            if not isinstance(error, InputError | OutputError | SolverError | MemoryError):
                raise
            click.echo(f"lapjoint: {error or 'out of memory'}", err=True)
            ctx.exit(2 if isinstance(error, InputError) else 1)


@click.group(cls=Lapjoint, context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 100})
@click.version_option(package_name="lapjoint", prog_name="lapjoint")
def main() -> None:
    """Two independent solvers for a loose, impacting lap joint, and a verdict on whether to believe them.

    PROBLEM is a TOML file (see `lapjoint init`), or preset:paper, or preset:sdnl104.
    """


main.add_command(export)
main.add_command(show)


@main.command()
def schema() -> None:
    """Print the JSON Schema of a problem file."""
    from lapjoint.problem.files import json_schema

    click.echo(json.dumps(json_schema(), indent=2))


@main.command()
@click.argument("file", default="-")
@click.option("--force", is_flag=True, help="Overwrite FILE if it is there.")
def init(file: str, force: bool) -> None:
    """Write a commented example of a problem to FILE, or to standard output."""
    from lapjoint.errors import InputError
    from lapjoint.output_files import write_text
    from lapjoint.problem.example import commented_example

    if file == "-":
        click.echo(commented_example(), nl=False)
        return
    if Path(file).exists() and not force:
        raise InputError(f"{file}: is there already; --force overwrites it")
    write_text(file, commented_example())
    click.echo(f"Wrote {file}")


@main.command()
@problem_options
@solver_options
@click.option("--state", default="all", show_default=True, help="Names of the closed stops (P2+P4), free, 1-9, or all.")
@click.option("--count", type=int, default=8, show_default=True, help="Number of modes to print.")
@click.option("--json", "json_path", metavar="FILE", help="Write the frequencies to FILE as JSON too.")
@click.option(
    "--figure", metavar="FILE", help="Draw the mode shapes (of several states the first three): .png, .svg or .pdf."
)
def modes(
    problem: str,
    overrides: tuple[str, ...],
    state: str,
    count: int,
    json_path: str | None,
    figure: str | None,
    **solver: Any,
) -> None:
    """Print natural angular frequencies [rad/s] of the contact states of PROBLEM."""
    from validation import chosen, shown

    chosen.check_file("--figure", figure, *FIGURES)
    chosen.check_file("--json", json_path)
    this = chosen.problem_from(problem, overrides)
    states = chosen.states_from(this, state)
    answering = chosen.solver_from(**solver)
    answers = [answering.modes(this, one, count) for one in states]
    shown.print_modes(this, answering.name, answers)
    if json_path:
        shown.write_json(json_path, shown.modes_summary(this, answering.name, answers))
    if figure:
        from lapjoint.figures import plot_mode_shapes, plot_state_shapes, save

        save(plot_mode_shapes(this, answers[0]) if len(answers) == 1 else plot_state_shapes(this, answers), figure)


@main.command()
@problem_options
@solver_options
@click.option("--duration", type=float, required=True, help="Time to simulate from the initial state, s.")
@click.option("--contacts", "contacts_path", metavar="FILE", help="Write all contacts to FILE: .csv or .json.")
@figure_options
def simulate(
    problem: str,
    overrides: tuple[str, ...],
    duration: float,
    contacts_path: str | None,
    figure: str | None,
    draw: str | None,
    **solver: Any,
) -> None:
    """Simulate PROBLEM from its initial state, and print its contacts."""
    from validation import chosen, shown

    chosen.check_file("--contacts", contacts_path, *CONTACTS)
    chosen.check_file("--figure", figure, *FIGURES)
    chosen.check_duration(duration)
    this = chosen.problem_from(problem, overrides)
    chosen.check_drawing(this, figure, draw)
    history = find_motion(this, chosen.solver_from(**solver), duration)
    shown.print_history(history)
    write_results(history, contacts_path, figure, draw)


@main.command()
@problem_options
@solver_options
@click.option("--contacts", "contacts_path", metavar="FILE", help="Write the contacts to FILE: .csv or .json.")
@figure_options
@click.option("--json", "json_path", metavar="FILE", help="Write the impulses to FILE as JSON.")
def steady(
    problem: str,
    overrides: tuple[str, ...],
    contacts_path: str | None,
    figure: str | None,
    draw: str | None,
    json_path: str | None,
    **solver: Any,
) -> None:
    """Find the steady state of PROBLEM, and print the impulse of each stop over one excitation period."""
    from lapjoint import Outcome
    from validation import chosen, shown

    chosen.check_file("--contacts", contacts_path, *CONTACTS)
    chosen.check_file("--figure", figure, *FIGURES)
    chosen.check_file("--json", json_path)
    this = chosen.problem_from(problem, overrides)
    chosen.check_drawing(this, figure, draw)
    found = find_steady_state(this, chosen.solver_from(**solver))
    shown.print_steady_state(found)
    write_results(found.history, contacts_path, figure, draw)
    if json_path:
        shown.write_json(json_path, shown.steady_state_summary(found))
    click.get_current_context().exit(1 if found.outcome is Outcome.UNDECIDED else 0)


@main.command()
@problem_options
@solver_options
@click.option("--from", "first", type=float, help="First excitation frequency, rad/s.")
@click.option("--to", "last", type=float, help="Last excitation frequency, rad/s.")
@click.option("--step", type=float, default=1.0, show_default=True, help="Step between them, rad/s.")
@click.option(
    "--over",
    "fields",
    multiple=True,
    metavar="PATH=VALUES",
    help="Change another number of the problem too, as in stops.*.gap=1e-3:3e-3:5 (from:to:count) or "
    "damping.ratio=0.02,0.08; repeatable: all combinations.",
)
@click.option("--out", required=True, metavar="FILE", help="Where the dataset goes: .nc; resumed if not finished.")
@click.option(
    "--start",
    type=click.Choice(["rest", "up", "down", "random"]),
    default="rest",
    show_default=True,
    help="Where each motion starts: from the problem's initial state; from where the one before it settled, along "
    "the first axis upwards or downwards; from random states.",
)
@click.option("--starts", type=int, default=1, show_default=True, help="Starts at each point; further ones are random.")
@click.option("--seed", type=int, default=0, show_default=True, help="Seed of the random states.")
@click.option("--workers", type=int, default=1, show_default=True, help="Number of processes; -1: all processors.")
@click.option("--scheduler", metavar="ADDRESS", help="A dask scheduler whose workers do it, as tcp://host:8786.")
@click.option("--force", is_flag=True, help="Throw away another sweep that is in FILE.")
def sweep(
    problem: str,
    overrides: tuple[str, ...],
    solver_name: str,
    n_modes: int | None,
    elements: int | None,
    options: tuple[str, ...],
    first: float | None,
    last: float | None,
    step: float,
    fields: tuple[str, ...],
    out: str,
    start: Literal["rest", "up", "down", "random"],
    starts: int,
    seed: int,
    workers: int,
    scheduler: str | None,
    force: bool,
) -> None:
    """Find the steady state of PROBLEM at every point of a grid: excitation frequencies, or any of its numbers.

    Interrupted in any way, the same command resumes.
    """
    from lapjoint.campaigns import Grid, Plan, run, stored
    from validation import chosen, shown
    from validation.progress import shown_points

    chosen.check_file("--out", out, ".nc")
    axes = chosen.axes_from(first, last, step, fields)
    this = chosen.problem_from(problem, overrides)
    numerics = chosen.options_from(n_modes, elements, options)
    plan = Plan(Grid(this, axes), solver_name, numerics, start, starts, seed)
    there = stored(plan, out, force=force)
    if there is None:
        with shown_points("sweep") as progress:
            found = run(plan, workers=workers, scheduler=scheduler, out=out, force=force, progress=progress)
        click.echo(f"Wrote {out}")
    else:
        found = there
        click.echo(f"{out}: holds this sweep already, finished")
    shown.print_curve(found)
    click.get_current_context().exit(1 if bool((found.outcome == -1).any()) else 0)


@main.command()
@click.argument("curve")
@click.option("-o", "--output", "figure", metavar="FILE", help="Where the figure goes; by default CURVE with .pdf.")
@click.option("--wide", is_flag=True, help="Page-wide: a panel for each stop, and what was established, in colour.")
def plot(curve: str, figure: str | None, wide: bool) -> None:
    """Draw what a sweep found, from its file CURVE: impulse of each stop over the excitation frequency."""
    from lapjoint.campaigns.dataset import read_curve
    from lapjoint.figures import plot_curve, plot_curve_wide, save
    from validation import chosen

    path = figure or str(Path(curve).with_suffix(".pdf"))
    chosen.check_file("--output", path, *FIGURES)
    dataset = read_curve(curve)
    save(plot_curve_wide(dataset) if wide else plot_curve(dataset), path)
    click.echo(f"Wrote {path}")


@main.command()
@click.argument("problem", required=False)
@click.option("--set", "overrides", multiple=True, metavar="KEY=VALUE", help="Change one value of PROBLEM; repeatable.")
@click.option("--case", "cases", multiple=True, metavar="NAME", help="Run this case only; repeatable.")
@click.option(
    "--peers",
    "peers",
    multiple=True,
    metavar="NAME",
    help="Compare with this solver too, as opensees, or opensees:dt=2e-5,elements=20; repeatable: adds the case peers.",
)
@click.option("--quick", "level", flag_value="quick", help="Less refinement.")
@click.option("--full", "level", flag_value="full", help="More refinement.")
@click.option("-o", "--output", default="report", show_default=True, metavar="DIR", help="Where the report goes.")
@click.option("--list", "list_cases", is_flag=True, help="List the cases and stop.")
def validate(
    problem: str | None,
    overrides: tuple[str, ...],
    cases: tuple[str, ...],
    peers: tuple[str, ...],
    level: Literal["quick", "full"] | None,
    output: str,
    list_cases: bool,
) -> None:
    """Compare the two solvers with each other and with published results; write DIR/report.html.

    With PROBLEM, compare the solvers on that problem instead.
    """
    import rich.console

    from validation import chosen, suite

    if list_cases:
        click.echo("\n".join(suite.case_names()))
        return
    chosen.check_directory(output)
    path = None if problem is None else chosen.problem_file(problem, overrides, output)
    named, console = tuple(dict.fromkeys(peers)), rich.console.Console()
    click.get_current_context().exit(suite.main(path, cases, level or "standard", Path(output), console, named))


def write_results(history: History, contacts_path: str | None, figure: str | None, draw: str | None) -> None:
    """Write the files asked for."""
    if contacts_path:
        from lapjoint.answers.contact_files import write_contacts

        write_contacts(history, contacts_path)
    if figure:
        from lapjoint import figures

        figures.save(getattr(figures, DRAWINGS[draw or "motion"])(history), figure)
