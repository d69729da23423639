"""Options that several commands share: the problem, the solver, the motion, and figures of it."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any, NamedTuple, TypeVar

import click

from lapjoint.cli.completing import FILE, PROBLEM, SOLVER

FIGURES = (".png", ".svg", ".pdf")


class Drawing(NamedTuple):
    """A figure of a motion."""

    function: str
    """Name of the function of `lapjoint.figures` that draws it."""
    most_places: float
    """Largest number of places along the beam that the figure can show."""


DRAWINGS = {
    "motion": Drawing("plot_motion", math.inf),
    "phase": Drawing("plot_phase_portrait", 1),
    "poincare": Drawing("plot_poincare_section", 1),
    "impulses": Drawing("plot_contact_impulses", 0),
    "states": Drawing("plot_contact_states", 0),
    "spectrum": Drawing("plot_spectrum", 1),
}
"""Figures of a motion by their names on the command line."""
Command = TypeVar("Command", bound=Callable[..., Any])


def together(*options: Callable[[Any], Any]) -> Callable[[Command], Command]:
    """One decorator for several options; help lists them from the last to the first."""

    def decorate(command: Command) -> Command:
        for option in options:
            command = option(command)
        return command

    return decorate


LARGE = "lapjoint.large"
"""Where click's context keeps whether --large was given."""


def _keep(context: click.Context, parameter: click.Parameter, value: bool) -> None:
    context.meta[LARGE] = value


def large_allowed() -> bool:
    """Whether --large was given to the command that runs."""
    context = click.get_current_context(silent=True)
    return context is not None and bool(context.meta.get(LARGE))


problem_options = together(
    click.option(
        "--large",
        is_flag=True,
        expose_value=False,
        callback=_keep,
        help="Allow more than 100 stops, and exports of more than 500 MB or 10 000 files.",
    ),
    click.option(
        "--set",
        "overrides",
        multiple=True,
        metavar="KEY=VALUE",
        help="Change one value of the problem, e.g. base_motion.angular_frequency=820, stops.P2.gap=2e-3 "
        "or stops.*.gap=2e-3; repeatable.",
    ),
    click.argument("problem", type=PROBLEM),
)
"""PROBLEM, --set to change parts of it, and --large to allow what takes long or much room."""

solver_options = together(
    click.option(
        "--option",
        "options",
        multiple=True,
        metavar="KEY=VALUE",
        help="Any numerical option of the solver; repeatable.",
    ),
    click.option("--elements", type=int, help="Number of elements of the FE solver."),
    click.option("--modes", "n_modes", type=int, help="Number of modes of the solver."),
    click.option(
        "--solver",
        "solver_name",
        type=SOLVER,
        default="analytic",
        show_default=True,
        help="analytic, fe, or another installed.",
    ),
)
"""--solver, and its numerical options."""

figure_options = together(
    click.option(
        "--draw",
        type=click.Choice(list(DRAWINGS)),
        help="What the figure shows: motion (the default), phase portrait, Poincare section, impulses of the "
        "contacts, contact states over time, or amplitude spectrum.",
    ),
    click.option("--figure", metavar="FILE", type=FILE, help="Draw the answer to FILE: .png, .svg or .pdf."),
)
"""--figure, and --draw to say what it shows."""

series_options = together(
    click.option("--rate", type=float, metavar="HZ", help="Samples a second of --series.  [default: by its modes]"),
    click.option(
        "--quantity",
        "quantity",
        metavar="NAME,NAME,..",
        help="What --series holds: displacement, velocity, acceleration (relative to the base), absolute_displacement, "
        "absolute_velocity, absolute_acceleration, moment, shear, stress, force (of each stop).  "
        "[default: displacement and force]",
    ),
    click.option(
        "--at",
        metavar="x=X,X,..",
        help="Places of --series, of a figure, and of what steady prints, m.  [default: the stops and the free ends; "
        "of a spectrum, where it moves most]",
    ),
    click.option("--series", "series_path", metavar="FILE", type=FILE, help="Write time series to FILE: .nc or .csv."),
)
"""--series, and what it holds."""

campaign_options = together(
    click.option("--force", is_flag=True, help="Throw away what else of this kind is in FILE."),
    click.option("--scheduler", metavar="ADDRESS", help="A dask scheduler whose workers do it, as tcp://host:8786."),
    click.option("--workers", type=int, default=1, show_default=True, help="Number of processes; -1: all processors."),
)
"""Who does work that is done cell by cell, and what may be thrown away for it."""

errors_option = click.option(
    "--errors/--no-errors",
    default=True,
    show_default=True,
    help="Estimate the numerical errors too; takes up to as long again.",
)
"""--errors, on by default for one problem."""

motion_options = together(
    click.option(
        "--beside",
        metavar="NAME",
        type=SOLVER,
        help="Another solver, whose motion stands beside: fe, or fe:elements=80 with options of its own.",
    ),
    click.option("--steady", "steady_state", is_flag=True, help="Take the steady state instead."),
    click.option("--duration", type=float, help="Time to simulate from the initial state, s."),
)
"""What motion is meant: --duration or --steady, and a second solver's --beside it."""
