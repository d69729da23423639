"""The command ``lapjoint confirm``: bifurcations of branches looked for by another solver."""

from __future__ import annotations

import click

from lapjoint.cli.completing import FILE, SOLVER
from lapjoint.cli.options import campaign_options


@click.command()
@click.argument("branches", type=FILE)
@click.option(
    "--solver",
    "solver_name",
    type=SOLVER,
    default="fe",
    show_default=True,
    help="The other solver: fe, analytic, or another installed.",
)
@click.option("--modes", "n_modes", type=int, help="Number of modes of the solver.")
@click.option("--elements", type=int, help="Number of elements of the FE solver.")
@click.option(
    "--option", "options", multiple=True, metavar="KEY=VALUE", help="Any numerical option of the solver; repeatable."
)
@click.option("--share", type=float, default=1.0, show_default=True, help="Look for this share, drawn at random.")
@click.option("--seed", type=int, default=0, show_default=True, help="Seed of the draw.")
@click.option(
    "-o", "--out", required=True, metavar="FILE", type=FILE, help="Where it goes: .nc; resumed if not finished."
)
@campaign_options
def confirm(
    branches: str,
    solver_name: str,
    n_modes: int | None,
    elements: int | None,
    options: tuple[str, ...],
    share: float,
    seed: int,
    out: str,
    workers: int,
    scheduler: str | None,
    force: bool,
) -> None:
    """Look for each bifurcation in the file BRANCHES of `lapjoint branch` by another solver, too.

    The other solver starts from the motions in the file, and states its own errors.  Interrupted in any way, the same
    command resumes.  The exit status is 1 unless both agree on all.
    """
    from lapjoint.campaigns.branches.table import read_branches
    from lapjoint.campaigns.confirm.spec import confirm_spec
    from lapjoint.campaigns.running import solve
    from lapjoint.cli import arguments
    from lapjoint.cli.confirm_printing import all_agree, print_confirmed
    from lapjoint.cli.finding import found_or_stored

    arguments.check_file("--out", out, ".nc")
    numerics = arguments.options_from(n_modes, elements, options)
    spec = confirm_spec(read_branches(branches), solver_name, numerics, share, seed)
    found = found_or_stored(
        spec, "confirm", "this confirmation", solve, out=out, force=force, workers=workers, scheduler=scheduler
    )
    print_confirmed(found)
    click.get_current_context().exit(0 if all_agree(found) else 1)
