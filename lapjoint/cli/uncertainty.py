"""The command ``lapjoint uncertainty``: what the samples of a file show."""

from __future__ import annotations

from importlib.util import find_spec
from textwrap import fill

import click

from lapjoint.cli.completing import FILE
from lapjoint.cli.echo import echo
from lapjoint.cli.options import FIGURES


@click.command()
@click.argument("file", type=FILE)
@click.option(
    "--limit",
    "limits",
    multiple=True,
    metavar="NAME=VALUE",
    help="A limit of the magnitude of a variable, in its SI unit, e.g. stress=120e6: the probability of exceeding it "
    "is computed; repeatable.",
)
@click.option(
    "--variable",
    metavar="NAME,NAME,..",
    help="Variables, e.g. impulse,stress_peak.  [default: those with a limit; else all of a sweep, or "
    "peaks, contacts and damage of statistics]",
)
@click.option(
    "--figure",
    metavar="FILE",
    type=FILE,
    help="Draw the bands of the first variable, or its distribution if nothing is swept: .png, .svg or .pdf.",
)
@click.option(
    "--ranking", metavar="FILE", type=FILE, help="Draw its sensitivity indices, the largest first: .png, .svg or .pdf."
)
@click.option("--json", "json_path", metavar="FILE", type=FILE, help="Also write all numbers to FILE as JSON.")
def uncertainty(
    file: str,
    limits: tuple[str, ...],
    variable: str | None,
    figure: str | None,
    ranking: str | None,
    json_path: str | None,
) -> None:
    """Show what the samples in FILE, of `lapjoint sweep --samples` or `statistics --samples`, say.

    It prints bands (5, 50, 95 %), probabilities of exceeding limits, and sensitivity indices, with 95 % intervals for
    the number of samples; what the errors of the samples themselves change stands beside them.
    """
    from lapjoint.campaigns.dataset import read_result
    from lapjoint.campaigns.statistics.spec import Realisations
    from lapjoint.campaigns.sweep.spec import Plan
    from lapjoint.cli import arguments, printing, uncertainty_printing
    from lapjoint.figures.style import save
    from lapjoint.figures.uncertainty import plot_bands, plot_ranking
    from lapjoint.sampling import bands, sensitivities
    from lapjoint.sampling.bands import Sampled

    arguments.check_file("--figure", figure, *FIGURES)
    arguments.check_file("--ranking", ranking, *FIGURES)
    arguments.check_file("--json", json_path)
    bounds = dict(arguments.named_number("--limit", text, "NAME=VALUE, as in stress=120e6") for text in limits)
    dataset = read_result(file, Plan.noun, Realisations.noun)
    of = Sampled(dataset)
    names = arguments.names_from(variable) if variable is not None else None if bounds else of.usual
    found = bands(dataset, bounds, names)
    chosen = tuple(str(name).removesuffix("_quantile") for name in found if str(name).endswith("_quantile"))
    chosen = tuple(name for name in chosen if name in of.variables)
    if find_spec("SALib") is None and not ranking:
        echo("lapjoint: hint: pip install 'lapjoint[sensitivity]' adds sensitivity indices", err=True)
        indices = found[[]]
    else:
        indices = sensitivities(dataset, chosen)
    uncertainty_printing.print_uncertainty(of, found, indices, chosen)
    others = [name for name in of.variables if name not in chosen]
    if others and variable is None:
        echo("\n" + fill(f"--variable shows others: {', '.join(others)}", printing.COLUMNS))
    if figure:
        save(plot_bands(dataset, chosen[0], limits=bounds), figure)
        echo(f"Wrote {figure}")
    if ranking:
        save(plot_ranking(indices, chosen[0]), ranking)
        echo(f"Wrote {ranking}")
    if json_path:
        printing.write_json(json_path, uncertainty_printing.summary(found, indices))
        echo(f"Wrote {json_path}")
