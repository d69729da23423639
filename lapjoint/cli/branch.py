"""The command ``lapjoint branch``: continuation of periodic motions in a parameter of the problem."""

from __future__ import annotations

import click

from lapjoint.cli.options import SolverChoice, Work, campaign_options, problem_options, solver_options


@click.command()
@problem_options
@solver_options
@click.option(
    "--over",
    "path",
    default="base_motion.angular_frequency",
    show_default=True,
    metavar="PATH",
    help="The parameter that changes, e.g. stops.*.gap, or base_motion.frequency in Hz.",
)
@click.option("--from", "first", type=float, required=True, help="One end of the parameter's range, SI units.")
@click.option("--to", "last", type=float, required=True, help="The other end of the range.")
@click.option(
    "--hz", is_flag=True, help="--from, --to and what is printed are in Hz; frequencies in the file in rad/s."
)
@click.option(
    "--max-period-multiple",
    type=int,
    default=1,
    show_default=True,
    help="Follow motions that repeat after at most this number of excitation periods.",
)
@click.option("--starts", type=int, default=0, show_default=True, help="Number of further starts, all random.")
@click.option("--seed", type=int, default=0, show_default=True, help="Seed of the random starts.")
@click.option(
    "--errors/--no-errors",
    default=True,
    show_default=True,
    help="Estimate the errors of the bifurcations, by finer resolutions of the solver.",
)
@click.option(
    "--max-points",
    type=int,
    default=5000,
    show_default=True,
    help="Largest number of points of a branch; a branch that needs more ends as `effort`.",
)
@click.option(
    "--effort",
    type=int,
    default=100_000,
    show_default=True,
    help="Limit of the sum over all branches of points times period multiple; beyond it, no new branch is followed.",
)
@click.option(
    "--from-grazes",
    is_flag=True,
    help="Also look near each graze for motions with the grazing contact in every second period only.",
)
@click.option(
    "--also-over",
    "second",
    metavar="PATH=VALUES",
    help="Follow branches for each value of a second parameter, e.g. stops.*.gap=1e-3:3e-3:5 (from:to:count) or "
    "damping.ratio=0.02,0.08, and find the loci of bifurcations in both parameters.",
)
@campaign_options(out_required=True)
def branch(
    problem: str,
    overrides: tuple[str, ...],
    path: str,
    first: float,
    last: float,
    hz: bool,
    max_period_multiple: int,
    starts: int,
    seed: int,
    errors: bool,
    max_points: int,
    effort: int,
    from_grazes: bool,
    second: str | None,
    solver: SolverChoice,
    work: Work,
) -> None:
    """Follow the periodic motions of PROBLEM, stable or not, while one of its parameters changes.

    Folds, flips, Neimark-Sacker bifurcations, broken symmetries and grazes are located; with --also-over, their loci in
    two parameters.  If the command is interrupted, run it again: it resumes.
    """
    from lapjoint.campaigns.branches.job import BranchJob
    from lapjoint.campaigns.branches.spec import BranchSpec
    from lapjoint.cli import arguments
    from lapjoint.cli.branch_printing import is_whole, print_branches
    from lapjoint.cli.finding import found_or_stored
    from lapjoint.figures.sweep_axes import in_hertz

    arguments.check_file("--out", work.out, ".nc")
    this = arguments.problem_from(problem, overrides)
    also_over = None if second is None else arguments.axis_from(second, "--also-over")
    over = arguments.in_hz(path) if hz else path
    plan = BranchSpec(
        this,
        over,
        first,
        last,
        solver.name,
        solver.numerics,
        max_period_multiple=max_period_multiple,
        starts=starts,
        seed=seed,
        errors=errors,
        max_points=max_points,
        effort=effort,
        also_over=also_over,
        from_grazes=from_grazes,
    )
    found = found_or_stored(BranchJob(plan), "these branches", work)
    print_branches(in_hertz(found) if arguments.is_in_hz(over) else found)
    click.get_current_context().exit(0 if is_whole(found) else 1)
