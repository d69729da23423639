"""The command ``lapjoint plot``: figures of the files of campaigns, and what they show in numbers."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import click

from lapjoint.cli.completing import FILE
from lapjoint.cli.echo import echo
from lapjoint.cli.options import FIGURES
from lapjoint.errors import InputError

if TYPE_CHECKING:
    import xarray as xr


class Look(NamedTuple):
    """How a file is drawn."""

    wide: bool
    variable: str | None
    limits: tuple[tuple[str, float], ...]
    """Variables and their limits, SI."""

    def limits_of(self, variable: str) -> list[float]:
        """The limits of the variable drawn; InputError if there is one of another variable."""
        for name, value in self.limits:
            if name != variable:
                raise InputError(f"--limit {name}={value:g}: the figure shows {variable}; --variable chooses another")
        return [value for _, value in self.limits]


@click.command()
@click.argument("files", type=FILE, nargs=-1, required=True, metavar="FILE...")
@click.option(
    "-o", "--out", "figure", metavar="FILE", type=FILE, help="File of the figure; by default the first FILE with .pdf."
)
@click.option("--wide", is_flag=True, help="Page-wide figure of sweeps: a panel for each stop, outcomes in colour.")
@click.option("--hz", is_flag=True, help="Draw and print frequencies in Hz.")
@click.option(
    "--variable",
    metavar="NAME",
    help="Variable of sweeps to draw in place of the impulses, e.g. stress_peak after --summary stress_peak; of "
    "statistics impulse, peak_force, contact_duration, impact_speed or stress_range.",
)
@click.option(
    "--limit",
    "limits",
    multiple=True,
    metavar="NAME=VALUE",
    help="Draw a limit of the variable that is drawn, a magnitude in SI units, e.g. stress_peak=120e6, and print where "
    "it is exceeded; repeatable.",
)
def plot(
    files: tuple[str, ...], figure: str | None, wide: bool, hz: bool, variable: str | None, limits: tuple[str, ...]
) -> None:
    """Draw the results of `lapjoint sweep`, `branch`, `basins` or `statistics` from their files.

    Several sweeps, such as one upwards and one downwards, are drawn in one figure.  The figure of sweeps or of branches
    shows the impulse of each stop over the parameter; of sweeps with --strobe, a bifurcation diagram; of branches in
    two parameters, the loci of their bifurcations; of basins, the motion in which each start ends, or the fraction of
    starts that end in each motion; of statistics, the rate of contacts or cycles of stress that exceed a value.  For
    sweeps, peaks and jumps are printed.
    """
    from lapjoint.campaigns.basins.spec import BasinPlan
    from lapjoint.campaigns.branches.spec import BranchSpec
    from lapjoint.campaigns.dataset import SWEEP, read_result
    from lapjoint.campaigns.statistics.spec import Realisations
    from lapjoint.cli import arguments
    from lapjoint.figures import in_hertz, plot_basins, plot_branches, plot_loci, save
    from lapjoint.figures.sweep_axes import refuse_samples

    for path in files:
        if not Path(path).name:
            raise InputError(f"{path!r}: is no file")
    look = Look(wide, variable, tuple(_limit_from(text) for text in limits))
    path = figure or str(Path(files[0]).with_suffix(".pdf"))
    arguments.check_file("--out", path, *FIGURES)
    nouns = (SWEEP, BranchSpec.noun, BasinPlan.noun, Realisations.noun)
    datasets = {name: read_result(file, *nouns) for name, file in zip(_names(files), files, strict=True)}
    for file, dataset in zip(files, datasets.values(), strict=True):
        refuse_samples(dataset, file)
    if hz:
        datasets = {name: in_hertz(dataset) for name, dataset in datasets.items()}
    kinds = {name: dataset.attrs.get("result_of", SWEEP) for name, dataset in datasets.items()}
    of, dataset = next(iter(kinds.values())), next(iter(datasets.values()))
    if len(files) > 1:
        for file, kind in zip(files, kinds.values(), strict=True):
            if kind != SWEEP:
                raise InputError(f"{file}: is the result of a {kind}; only sweeps are drawn several in one figure")
    options = {"wide": wide, "variable": variable, "limit": limits or None}
    if of == BranchSpec.noun:
        arguments.refuse("a diagram of branches has one look", **options)
        save(plot_loci(dataset) if "also_over" in dataset.attrs else plot_branches(dataset), path)
        echo(f"Wrote {path}")
    elif of == BasinPlan.noun:
        arguments.refuse("a figure of basins has one look", **options)
        save(plot_basins(dataset), path)
        echo(f"Wrote {path}")
    elif of == Realisations.noun:
        arguments.refuse("a figure of statistics has one look, over no frequency", wide=wide, hz=hz)
        _plot_statistics(dataset, look, path)
    else:
        _plot_sweeps(datasets, look, path)


def _plot_statistics(dataset: xr.Dataset, look: Look, path: str) -> None:
    """Draw the exceedance of statistics, and print it at the limits."""
    from lapjoint.cli.plot_printing import print_exceedance
    from lapjoint.figures import plot_exceedance, save

    quantity = look.variable or "impulse"
    limits = look.limits_of(quantity)
    save(plot_exceedance(dataset, quantity=quantity, limits=limits), path)
    echo(f"Wrote {path}")
    for limit in limits:
        print_exceedance(dataset, quantity, limit)


def _plot_sweeps(datasets: dict[str, xr.Dataset], look: Look, path: str) -> None:
    """Draw one sweep, or several in one figure, and print their peaks and jumps."""
    from lapjoint.cli.plot_printing import print_features
    from lapjoint.figures import plot_curve, plot_curve_wide, plot_curves, plot_curves_wide, save
    from lapjoint.figures.sweep_variables import IMPULSE, STROBES

    has_samples = all(STROBES[0] in dataset for dataset in datasets.values())
    what = look.variable or (STROBES[0] if has_samples else IMPULSE)
    if what in STROBES:
        _plot_samples(datasets, what, look, path)
        return
    limits = look.limits_of(what)
    if len(datasets) > 1:
        draw = plot_curves_wide if look.wide else plot_curves
        save(draw(datasets, variable=what, limits=limits), path)
    else:
        (dataset,) = datasets.values()
        alone = plot_curve_wide if look.wide else plot_curve
        save(alone(dataset, variable=what, limits=limits), path)
    echo(f"Wrote {path}")
    for name, dataset in datasets.items():
        print_features(dataset, what, limits, name if len(datasets) > 1 else "")


def _plot_samples(datasets: dict[str, xr.Dataset], what: str, look: Look, path: str) -> None:
    """Draw the bifurcation diagram of sweeps, and print the jumps of their impulses from motion to motion."""
    from lapjoint.cli import arguments
    from lapjoint.cli.plot_printing import print_features
    from lapjoint.figures import plot_bifurcation, save
    from lapjoint.figures.sweep_variables import IMPULSE

    arguments.refuse("a bifurcation diagram has none; --variable impulse draws curves", limit=look.limits or None)
    alone = len(datasets) == 1
    save(plot_bifurcation(next(iter(datasets.values())) if alone else datasets, variable=what, wide=look.wide), path)
    echo(f"Wrote {path}")
    for name, dataset in datasets.items():
        print_features(dataset, IMPULSE, [], "" if alone else name)


def _names(files: tuple[str, ...]) -> list[str]:
    """A name for each file: without its folder and ending where that tells all apart, else the path, with a number if
    a path is given twice."""
    for names in ([Path(file).stem for file in files], list(files)):
        if len(set(names)) == len(names):
            return names
    return [f"{i + 1}: {file}" for i, file in enumerate(files)]


def _limit_from(text: str) -> tuple[str, float]:
    """The variable and the value of ``NAME=VALUE``."""
    from lapjoint.cli.arguments import named_number

    rule = "NAME=VALUE with a positive value in SI units, as in impulse=2.5"
    name, limit = named_number("--limit", text, rule)
    if not 0 < limit < math.inf:
        raise InputError(f"--limit {text}: must be {rule}")
    return name, limit
