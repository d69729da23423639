"""The command ``lapjoint sketch``: a drawing of the problem alone."""

from __future__ import annotations

from pathlib import Path

import click

from lapjoint.cli.completing import FILE
from lapjoint.cli.echo import echo
from lapjoint.cli.options import FIGURES, problem_options


@click.command()
@problem_options
@click.option(
    "-o",
    "--out",
    "figure",
    metavar="FILE",
    type=FILE,
    help="File of the drawing: .png, .svg or .pdf; by default PROBLEM with .png.",
)
@click.option("--narrow", is_flag=True, help="One column wide, for half a page or a telephone.")
def sketch(problem: str, overrides: tuple[str, ...], figure: str | None, narrow: bool) -> None:
    """Draw PROBLEM: beams, supports, masses, links, stops and loads, with their numbers.

    Only positions along the beam are to scale.
    """
    from lapjoint.cli import arguments
    from lapjoint.figures import plot_joint, save
    from lapjoint.figures.style import COLUMN_WIDTH, PAGE_WIDTH

    path = figure or str(Path(problem.removeprefix("preset:")).with_suffix(".png"))
    arguments.check_file("--out", path, *FIGURES)
    this = arguments.problem_from(problem, overrides)
    save(plot_joint(this, width=COLUMN_WIDTH if narrow else PAGE_WIDTH), path)
    echo(f"Wrote {path}")
