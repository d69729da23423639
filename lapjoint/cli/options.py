"""Options that several commands share: the problem, the solver, the motion, and figures of it."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import wraps
from typing import TYPE_CHECKING, Any, NamedTuple, TypeVar, cast

import click

from lapjoint.cli.completing import FILE, PROBLEM, SOLVER
from lapjoint.errors import InputError

if TYPE_CHECKING:
    from lapjoint.problem import Problem
    from lapjoint.sampling.design import Samples
    from lapjoint.solver import Solver

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
    "psd": Drawing("plot_psd", 1),
}
"""Figures of a motion by their names on the command line."""
Command = TypeVar("Command", bound=Callable[..., Any])


class SolverChoice(NamedTuple):
    """The chosen solver, and its numerical options as given on the command line."""

    name: str
    n_modes: int | None = None
    elements: int | None = None
    options: tuple[str, ...] = ()
    """Further numerical options, ``key=value`` each."""

    @property
    def numerics(self) -> dict[str, Any]:
        """All numerical options that were given, by their names."""
        from lapjoint.problem.override import toml_value
        from lapjoint.solver import options_of

        chosen: dict[str, Any] = {}
        for option in self.options:
            key, equals, value = option.partition("=")
            if not equals or not key.strip():
                raise InputError(f"--option {option}: must be key=value")
            chosen[key.strip().replace("-", "_")] = toml_value(value)
        numbers = {"n_modes": self.n_modes, "elements": self.elements}
        given = {key: number for key, number in numbers.items() if number is not None}
        allowed = options_of(self.name) if given else None
        for key, number in given.items():
            if allowed is not None and key not in allowed:
                raise InputError(
                    f"--{key.replace('_', '-')} {number}: solver {self.name} has no option {key}; allowed: "
                    + ", ".join(allowed)
                )
        return chosen | given

    def make(self) -> Solver:
        """The solver."""
        from lapjoint.solver import make_solver

        return make_solver(self.name, **self.numerics)


class MotionChoice(NamedTuple):
    """The chosen motion."""

    duration: float | None
    """Time from the initial state, s; None for the steady state."""
    steady_state: bool
    beside: str | None
    """A second solver, ``NAME`` or ``NAME:KEY=VALUE,...``, whose motion is shown beside the first."""


class AnswerFiles(NamedTuple):
    """The files to which an answer is written, and their contents."""

    contacts: str | None
    series: str | None
    at: str | None
    """Places of the series and of the figure, as ``x=2.5,1.25``."""
    quantity: str | None
    rate: float | None
    figure: str | None
    draw: str | None
    """The figure, a name of `DRAWINGS`."""


class Work(NamedTuple):
    """The file of a campaign's dataset, and the processes that compute it."""

    out: str | None
    workers: int
    scheduler: str | None
    force: bool
    """Whether a file of another campaign may be overwritten."""


class Sampling(NamedTuple):
    """The samples of uncertain numbers that are drawn."""

    samples: int | None
    design: str
    sample_seed: int

    def of(self, problem: Problem) -> Samples | None:
        """The samples of a problem; None if none were asked for."""
        from lapjoint.sampling.design import samples_of

        if self.samples is None:
            return None
        return samples_of(problem, self.samples, cast(Any, self.design), self.sample_seed)


def together(*options: Callable[[Any], Any]) -> Callable[[Command], Command]:
    """One decorator for several options; the help text lists them from the last to the first."""

    def decorate(command: Command) -> Command:
        for option in options:
            command = option(command)
        return command

    return decorate


LARGE = "lapjoint.large"
"""Key in the ``meta`` of click's context under which the value of --large is kept."""


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
"""PROBLEM, --set to change values of it, and --large to allow large problems and exports."""


def as_one(record: type[Any], name: str) -> Callable[[Command], Command]:
    """A decorator that collects the options named as the fields of `record` into one argument `name` of a command."""

    def decorate(command: Command) -> Command:
        @wraps(command)
        def called(**given: Any) -> Any:
            fields = {field: given.pop(field) for field in record._fields}
            return command(**given, **{name: record(**fields)})

        return cast(Command, called)

    return decorate


def solver_options_with(default: str, help_text: str) -> Callable[[Command], Command]:
    """--solver, and its numerical options: the argument ``solver`` of a command, a `SolverChoice`."""
    return together(
        as_one(SolverChoice, "solver"),
        click.option(
            "--option",
            "options",
            multiple=True,
            metavar="KEY=VALUE",
            help="Any numerical option of the solver; repeatable.",
        ),
        click.option("--elements", type=int, help="Number of elements of the FE solver."),
        click.option("--n-modes", type=int, help="Number of modes of the solver."),
        click.option("--solver", "name", type=SOLVER, default=default, show_default=True, help=help_text),
    )


solver_options = solver_options_with("analytic", "The solver: analytic, fe, or another installed one.")

answer_options = together(
    as_one(AnswerFiles, "files"),
    click.option(
        "--draw",
        type=click.Choice(list(DRAWINGS)),
        help="Kind of figure: motion (the default), phase portrait, Poincare section, impulses of the contacts, "
        "contact states over time, amplitude spectrum, or power spectral density (Welch).",
    ),
    click.option("--figure", metavar="FILE", type=FILE, help="Draw the answer to FILE: .png, .svg or .pdf."),
    click.option(
        "--errors/--no-errors",
        default=True,
        show_default=True,
        help="Also estimate numerical errors; at most doubles the time.",
    ),
    click.option("--rate", type=float, metavar="HZ", help="Samples a second of --series.  [default: by the modes]"),
    click.option(
        "--quantity",
        metavar="NAME,NAME,..",
        help="Quantities in --series: displacement, velocity, acceleration (relative to the base), "
        "absolute_displacement, absolute_velocity, absolute_acceleration, moment, shear, stress, "
        "force (of each stop).  [default: displacement and force]",
    ),
    click.option(
        "--at",
        metavar="x=X,X,..",
        help="Places of --series, of a figure, and of the peaks that steady prints, m.  [default: the stops and the "
        "free ends; for spectrum and psd, the place of largest motion]",
    ),
    click.option("--series", "series", metavar="FILE", type=FILE, help="Write time series to FILE: .nc or .csv."),
    click.option("--contacts", metavar="FILE", type=FILE, help="Write all contacts to FILE: .csv or .json."),
)
"""--errors, and the files of an answer: the argument ``files`` of a command, an `AnswerFiles`."""


def campaign_options(out_required: bool) -> Callable[[Command], Command]:
    """The file of a campaign, and the workers: the argument ``work`` of a command, a `Work`."""
    return together(
        as_one(Work, "work"),
        click.option("--force", is_flag=True, help="Overwrite another campaign of this kind in FILE."),
        click.option(
            "--scheduler", metavar="ADDRESS", help="A dask scheduler whose workers compute, e.g. tcp://host:8786."
        ),
        click.option(
            "--workers", type=int, default=1, show_default=True, help="Number of processes; -1: one per processor."
        ),
        click.option(
            "-o",
            "--out",
            required=out_required,
            metavar="FILE",
            type=FILE,
            help="File of the dataset, .nc; an unfinished file is resumed.",
        ),
    )


sample_options = together(
    as_one(Sampling, "sampling"),
    click.option("--sample-seed", type=int, default=0, show_default=True, help="Seed of the samples."),
    click.option(
        "--design",
        type=click.Choice(["sobol", "saltelli"]),
        default="sobol",
        show_default=True,
        help="sobol: scrambled Sobol points; saltelli: for total sensitivity indices, --samples blocks of d + 2 points "
        "for d uncertain numbers.",
    ),
    click.option(
        "--samples",
        type=int,
        help="Draw this many samples of the [[uncertain]] numbers of PROBLEM: 64, 128, 256, ...",
    ),
)
"""--samples, --design and --sample-seed: the argument ``sampling`` of a command, a `Sampling`."""


motion_options = together(
    as_one(MotionChoice, "motion"),
    click.option(
        "--beside",
        metavar="NAME",
        type=SOLVER,
        help="A second solver, whose motion is shown beside the first: fe, or with options fe:elements=80.",
    ),
    click.option("--steady", "steady_state", is_flag=True, help="Take the steady state instead of --duration."),
    click.option("--duration", type=float, help="Time to simulate from the initial state, s."),
)
"""--duration or --steady, and --beside: the argument ``motion`` of a command, a `MotionChoice`."""
