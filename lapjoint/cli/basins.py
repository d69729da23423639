"""The command ``lapjoint basins``: which motion each of many starts ends in."""

from __future__ import annotations

from typing import Any

import click

from lapjoint.cli.completing import FILE
from lapjoint.cli.echo import echo
from lapjoint.cli.options import FIGURES, SolverChoice, Work, campaign_options, problem_options, solver_options


@click.command()
@problem_options
@solver_options
@click.option(
    "--plane",
    metavar="A,B",
    help="Starts in the plane of two coordinates: displacement z or velocity v at a place, m, e.g. z(2.5),v(2.5).",
)
@click.option("--grid", metavar="NxM", help="Number of values of A and B.  [default: 40x40]")
@click.option(
    "--range",
    "ranges",
    metavar="A:A,B:B",
    help="First and last value of A and of B, m or m/s, e.g. -0.1:0.1,-20:20.  [default: by base motion and gap]",
)
@click.option("--energy", type=float, metavar="J", help="Random starts with at most this energy, instead of a plane.")
@click.option("--starts", type=int, help="Number of random starts.  [default: 1000]")
@click.option("--seed", type=int, help="Seed of the random starts.  [default: 0]")
@click.option(
    "--over",
    metavar="PATH",
    help="A parameter to vary, e.g. stops.*.gap, or frequency in Hz; basins are found at each value.",
)
@click.option("--from", "first", type=float, help="First value of the parameter.")
@click.option("--to", "last", type=float, help="Last value of the parameter.")
@click.option("--values", type=int, help="Number of values of the parameter.")
@click.option(
    "--hz", is_flag=True, help="--from, --to and what is printed are in Hz; frequencies in the file in rad/s."
)
@click.option("--effort", type=int, metavar="PERIODS", help="Limit of periods simulated from a start.  [default: 4000]")
@click.option("--figure", metavar="FILE", type=FILE, help="Draw the basins to FILE: .png, .svg or .pdf.")
@campaign_options(out_required=True)
def basins(
    problem: str,
    overrides: tuple[str, ...],
    figure: str | None,
    hz: bool,
    solver: SolverChoice,
    work: Work,
    **chosen: Any,
) -> None:
    """Find which motion of PROBLEM each of many starts ends in.

    Starts are the points of a grid in a --plane, or random states of at most an --energy. If the command is
    interrupted, run it again: it resumes.
    """
    from lapjoint.campaigns.basins.job import BasinJob
    from lapjoint.campaigns.basins.table import UNBOUND_CLASSES
    from lapjoint.cli import arguments
    from lapjoint.cli.basin_arguments import plan_from
    from lapjoint.cli.basin_printing import print_basins
    from lapjoint.cli.finding import found_or_stored
    from lapjoint.figures.sweep_axes import in_hertz

    arguments.check_file("--out", work.out, ".nc")
    arguments.check_file("--figure", figure, *FIGURES)
    if hz:
        arguments.refuse("is of --over base_motion.angular_frequency", hz=chosen["over"] is None)
        chosen["over"] = arguments.in_hz(chosen["over"])
    this = arguments.problem_from(problem, overrides)
    plan = plan_from(this, solver.name, solver.numerics, **chosen)
    found = found_or_stored(BasinJob(plan), "these basins", work)
    found = in_hertz(found) if arguments.is_in_hz(chosen["over"]) else found
    print_basins(found)
    if figure is not None:
        from lapjoint.figures import plot_basins, save

        save(plot_basins(found), figure)
        echo(f"Wrote {figure}")
    failed = found.unbound_count.isel(unbound=len(UNBOUND_CLASSES) - 1)
    click.get_current_context().exit(1 if bool((failed > 0).any()) else 0)
