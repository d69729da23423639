"""The command ``lapjoint confirm``: another solver looks for the bifurcations of branches."""

from __future__ import annotations

import click

from lapjoint.cli.completing import FILE
from lapjoint.cli.options import SolverChoice, Work, campaign_options, solver_options_with


@click.command()
@click.argument("branches", type=FILE)
@solver_options_with("fe", "The other solver: fe, analytic, or another installed.")
@click.option("--share", type=float, default=1.0, show_default=True, help="Fraction to look for, drawn at random.")
@click.option("--seed", type=int, default=0, show_default=True, help="Seed of the random draw.")
@click.option("--hz", is_flag=True, help="Print frequencies in Hz; those in the files are in rad/s.")
@campaign_options(out_required=True)
def confirm(
    branches: str,
    share: float,
    seed: int,
    hz: bool,
    solver: SolverChoice,
    work: Work,
) -> None:
    """Locate each bifurcation in the file BRANCHES of `lapjoint branch` with another solver, too.

    The other solver starts from the motions in the file, and states its own errors.  The exit status is 1 unless both
    solvers agree on all bifurcations.  If the command is interrupted, run it again: it resumes.
    """
    from lapjoint.campaigns.branches.table import read_branches
    from lapjoint.campaigns.confirm.job import ConfirmJob
    from lapjoint.campaigns.confirm.spec import confirm_spec
    from lapjoint.cli import arguments
    from lapjoint.cli.confirm_printing import all_agree, print_confirmed
    from lapjoint.cli.finding import found_or_stored
    from lapjoint.figures.sweep_axes import in_hertz

    arguments.check_file("--out", work.out, ".nc")
    spec = confirm_spec(read_branches(branches), solver.name, solver.numerics, share, seed)
    found = found_or_stored(ConfirmJob(spec), "this confirmation", work)
    print_confirmed(in_hertz(found) if hz else found)
    click.get_current_context().exit(0 if all_agree(found) else 1)
