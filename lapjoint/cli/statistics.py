"""The command ``lapjoint statistics``: statistics of long motions, with intervals."""

from __future__ import annotations

import click

from lapjoint.cli.completing import FILE
from lapjoint.cli.options import (
    Sampling,
    SolverChoice,
    Work,
    campaign_options,
    problem_options,
    sample_options,
    solver_options,
)
from lapjoint.errors import InputError


@click.command()
@problem_options
@solver_options
@click.option("--duration", type=float, help="Duration of each motion, s, with its start; by default the record's.")
@click.option("--seeds", type=int, default=1, show_default=True, help="Number of realisations of random excitation.")
@click.option("--at", metavar="x=X,X,..", help="Places, m.  [default: the stops and the free ends]")
@click.option(
    "--quantity",
    metavar="NAME,NAME,..",
    help="Quantities at these places: displacement, velocity, acceleration (relative to the base), "
    "absolute_displacement, absolute_velocity, absolute_acceleration, moment, shear, stress.  [default: displacement, "
    "velocity, absolute_acceleration, moment, stress]",
)
@click.option(
    "--settle",
    type=float,
    help="Length of the start that is left out, s.  [default: 7 decay times of the slowest mode]",
)
@click.option("--rate", type=float, metavar="HZ", help="Samples a second.  [default: 16 in the slowest mode's period]")
@sample_options
@click.option("--json", "json_path", metavar="FILE", type=FILE, help="Also write the statistics to FILE as JSON.")
@campaign_options(out_required=False)
def statistics(
    problem: str,
    overrides: tuple[str, ...],
    duration: float | None,
    seeds: int,
    at: str | None,
    quantity: str | None,
    settle: float | None,
    rate: float | None,
    json_path: str | None,
    sampling: Sampling,
    solver: SolverChoice,
    work: Work,
) -> None:
    """Summarise long motions of PROBLEM: peaks, RMS, contacts and their distributions, with 95 % intervals.

    With --samples, all is done for each sample of the uncertain numbers; `lapjoint uncertainty` reads the file.

    If a command with --out is interrupted, run it again: it resumes.
    """
    from lapjoint.campaigns.statistics.job import StatisticsJob
    from lapjoint.campaigns.statistics.spec import Realisations
    from lapjoint.cli import arguments, printing, statistics_printing
    from lapjoint.cli.finding import found_or_stored

    arguments.check_file("--out", work.out, ".nc")
    arguments.check_file("--json", json_path)
    arguments.check_duration(duration)
    if sampling.samples is not None and work.out is None:
        raise InputError("--out: is missing; with --samples the answer is a file, which `lapjoint uncertainty` reads")
    this = arguments.problem_from(problem, overrides)
    plan = Realisations(
        this,
        arguments.duration_of(this, duration),
        seeds,
        solver.name,
        solver.numerics,
        None if at is None else tuple(arguments.places_from(at, this)),
        None if quantity is None else arguments.names_from(quantity),
        settle,
        rate,
        sampling.of(this),
    )
    found = found_or_stored(StatisticsJob(plan), "these statistics", work)
    if sampling.samples is None:
        statistics_printing.print_statistics(found, this)
    else:
        statistics_printing.print_samples(found)
    if json_path:
        printing.write_json(json_path, statistics_printing.statistics_summary(found))
    click.get_current_context().exit(1 if found.attrs["failed"] else 0)
