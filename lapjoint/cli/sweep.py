"""The command ``lapjoint sweep``: many steady states."""

from __future__ import annotations

from typing import Literal

import click

from lapjoint.cli.options import (
    Sampling,
    SolverChoice,
    Work,
    campaign_options,
    problem_options,
    sample_options,
    solver_options,
)


@click.command()
@problem_options
@solver_options
@click.option("--from", "first", type=float, help="First excitation frequency, rad/s.")
@click.option("--to", "last", type=float, help="Last excitation frequency, rad/s.")
@click.option("--step", type=float, default=1.0, show_default=True, help="Step from one frequency to the next, rad/s.")
@click.option("--hz", is_flag=True, help="--from, --to and --step are in Hz; frequencies in the file are in rad/s.")
@click.option(
    "--over",
    "fields",
    multiple=True,
    metavar="PATH=VALUES",
    help="Another parameter to vary, e.g. stops.*.gap=1e-3:3e-3:5 (from:to:count) or damping.ratio=0.02,0.08; "
    "repeatable: the grid then has all combinations.",
)
@click.option(
    "--start",
    type=click.Choice(["rest", "up", "down", "random"]),
    default="rest",
    show_default=True,
    help="Start of each motion.  rest: the problem's initial state; up, down: the steady state at the previous point, "
    "along the first axis upwards or downwards; random: random states.",
)
@click.option("--starts", type=int, default=1, show_default=True, help="Starts at each point; after the first, random.")
@click.option("--seed", type=int, default=0, show_default=True, help="Seed of the random states.")
@click.option(
    "--sensitivity", is_flag=True, help="Also measure the growth of deviations on the way; takes about as long again."
)
@click.option(
    "--errors", is_flag=True, help="Also estimate numerical errors of the impulses; at most doubles the time."
)
@click.option(
    "--summary",
    metavar="NAME,NAME,..",
    help="Further variables of each motion.  Largest values along the beam: <quantity>_peak or <quantity>_rms, e.g. "
    "stress_peak, and with an S-N line damage_rate, equivalent_range, largest_range.  Of each stop: force_peak, "
    "force_rms, contact_time, contact_rate.",
)
@click.option(
    "--strobe",
    type=int,
    default=0,
    metavar="N",
    help="Also store N samples of each motion, one a period, for a bifurcation diagram.",
)
@click.option("--at", metavar="x=X", help="Place of the samples, m.  [default: the outermost stop, or the tip]")
@sample_options
@campaign_options(out_required=True)
def sweep(
    problem: str,
    overrides: tuple[str, ...],
    first: float | None,
    last: float | None,
    step: float,
    hz: bool,
    fields: tuple[str, ...],
    start: Literal["rest", "up", "down", "random"],
    starts: int,
    seed: int,
    sensitivity: bool,
    errors: bool,
    summary: str | None,
    strobe: int,
    at: str | None,
    sampling: Sampling,
    solver: SolverChoice,
    work: Work,
) -> None:
    """Find the steady state of PROBLEM at every point of a grid of excitation frequencies or other parameters.

    With --samples, all is done for each sample of the uncertain numbers; `lapjoint uncertainty` reads the file.

    If the command is interrupted, run it again: it resumes.
    """
    from lapjoint.campaigns.grid import Grid
    from lapjoint.campaigns.sweep.job import SweepJob
    from lapjoint.campaigns.sweep.spec import Plan
    from lapjoint.cli import arguments, printing
    from lapjoint.cli.finding import found_or_stored

    arguments.check_file("--out", work.out, ".nc")
    axes = arguments.axes_from(first, last, step, fields, hz, needed=sampling.samples is None)
    this = arguments.problem_from(problem, overrides)
    place = None if at is None else arguments.place_from(at, this)
    further = () if summary is None else arguments.names_from(summary)
    grid = Grid(this, axes, sampling.of(this))
    plan = Plan(grid, solver.name, solver.numerics, start, starts, seed, sensitivity, errors, further, strobe, place)
    found = found_or_stored(SweepJob(plan), "this sweep", work)
    printing.print_curve(found)
    click.get_current_context().exit(1 if bool((found.outcome == -1).any()) else 0)
