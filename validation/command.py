"""The command ``lapjoint validate``, which joins the others by the entry point ``lapjoint.commands``.

Everything heavy is imported inside the functions that need it, so that ``lapjoint --help`` answers at once.
"""

from __future__ import annotations

from pathlib import Path
from typing import Literal

import click

from lapjoint.cli.echo import echo


@click.command()
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

    from lapjoint.cli import arguments
    from validation import suite

    if list_cases:
        echo("\n".join(suite.case_names()))
        return
    if problem is None:
        arguments.refuse(
            "it changes a PROBLEM, and none is given; preset:paper is one", set=" ".join(overrides) or None
        )
    arguments.check_directory(output)
    this = None if problem is None else arguments.problem_from(problem, overrides)
    named, console = tuple(dict.fromkeys(peers)), rich.console.Console()
    click.get_current_context().exit(suite.main(this, cases, level or "standard", Path(output), console, named))
