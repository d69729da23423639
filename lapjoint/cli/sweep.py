"""The commands ``lapjoint sweep`` and ``lapjoint plot``: many steady states, and their figures."""

from __future__ import annotations

from pathlib import Path
from typing import Literal

import click

from lapjoint.cli.completing import FILE
from lapjoint.cli.echo import echo
from lapjoint.cli.options import FIGURES, SolverChoice, Work, campaign_options, problem_options, solver_options
from lapjoint.errors import InputError


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
    "stress_peak.  Of each stop: force_peak, force_rms, contact_time, contact_rate.",
)
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
    solver: SolverChoice,
    work: Work,
) -> None:
    """Find the steady state of PROBLEM at every point of a grid of excitation frequencies or other parameters.

    If the command is interrupted, run it again: it resumes.
    """
    from lapjoint.campaigns.grid import Grid
    from lapjoint.campaigns.sweep.job import SweepJob
    from lapjoint.campaigns.sweep.spec import Plan
    from lapjoint.cli import arguments, printing
    from lapjoint.cli.finding import found_or_stored

    arguments.check_file("--out", work.out, ".nc")
    axes = arguments.axes_from(first, last, step, fields, hz)
    this = arguments.problem_from(problem, overrides)
    further = () if summary is None else arguments.names_from(summary)
    plan = Plan(Grid(this, axes), solver.name, solver.numerics, start, starts, seed, sensitivity, errors, further)
    found = found_or_stored(SweepJob(plan), "sweep", "this sweep", work)
    printing.print_curve(found)
    click.get_current_context().exit(1 if bool((found.outcome == -1).any()) else 0)


@click.command()
@click.argument("curve", type=FILE)
@click.option(
    "-o", "--out", "figure", metavar="FILE", type=FILE, help="File of the figure; by default CURVE with .pdf."
)
@click.option("--wide", is_flag=True, help="Page-wide figure of a sweep: a panel for each stop, outcomes in colour.")
@click.option("--hz", is_flag=True, help="Draw the frequencies of a sweep in Hz.")
@click.option(
    "--variable",
    metavar="NAME",
    help="Variable of a sweep to draw in place of the impulses, e.g. stress_peak after --summary stress_peak.",
)
def plot(curve: str, figure: str | None, wide: bool, hz: bool, variable: str | None) -> None:
    """Draw the results of `lapjoint sweep`, `lapjoint branch` or `lapjoint basins` from their file CURVE.

    The figure of a sweep or of branches shows the impulse of each stop over the parameter; of branches in two
    parameters, the loci of their bifurcations; of basins, the motion in which each start ends, or the fraction of
    starts that end in each motion.
    """
    from lapjoint.campaigns.basins.spec import BasinPlan
    from lapjoint.campaigns.branches.spec import BranchSpec
    from lapjoint.campaigns.dataset import read_result
    from lapjoint.campaigns.sweep.spec import Plan
    from lapjoint.cli import arguments
    from lapjoint.figures import in_hertz, plot_basins, plot_branches, plot_curve, plot_curve_wide, plot_loci, save
    from lapjoint.figures.sweep_variables import IMPULSE

    if not Path(curve).name:
        raise InputError(f"{curve!r}: is no file")
    path = figure or str(Path(curve).with_suffix(".pdf"))
    arguments.check_file("--out", path, *FIGURES)
    dataset = read_result(curve, Plan.noun, BranchSpec.noun, BasinPlan.noun)
    of = dataset.attrs.get("result_of")
    if of == BranchSpec.noun:
        arguments.refuse("a diagram of branches has one look", wide=wide, hz=hz, variable=variable)
        save(plot_loci(dataset) if "also_over" in dataset.attrs else plot_branches(dataset), path)
    elif of == BasinPlan.noun:
        arguments.refuse("a figure of basins has one look", wide=wide, hz=hz, variable=variable)
        save(plot_basins(dataset), path)
    else:
        dataset = in_hertz(dataset) if hz else dataset
        what = variable or IMPULSE
        save(plot_curve_wide(dataset, variable=what) if wide else plot_curve(dataset, variable=what), path)
    echo(f"Wrote {path}")
