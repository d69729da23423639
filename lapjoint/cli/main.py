"""The command ``lapjoint``.

Exit status: 0 for success; 1 if answers disagree, a solver failed, or a steady state is undecided; 2 for bad input; 3
if a file could not be written; 130 after Ctrl-C.  Each status except 0 comes with a message, never with a traceback.

Another package adds a command by an entry point of the group ``lapjoint.commands``, a `click.Command`.  Heavy modules
are imported inside the functions that need them, so that ``lapjoint --help`` answers at once.
"""

from __future__ import annotations

import errno
import io
import json
import os
import sys
import warnings
from contextlib import suppress
from importlib.metadata import EntryPoint, entry_points
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from lapjoint.cli.basins import basins
from lapjoint.cli.branch import branch
from lapjoint.cli.completing import FILE
from lapjoint.cli.confirm import confirm
from lapjoint.cli.echo import echo
from lapjoint.cli.equilibrium import equilibrium
from lapjoint.cli.look import export, show
from lapjoint.cli.plot import plot
from lapjoint.cli.sketch import sketch
from lapjoint.cli.solve import modes, simulate, steady
from lapjoint.cli.statistics import statistics
from lapjoint.cli.sweep import sweep
from lapjoint.cli.uncertainty import uncertainty

if TYPE_CHECKING:
    from lapjoint.problem.example import ExampleName

ENTRY_POINT_GROUP = "lapjoint.commands"
BAD_INPUT, NOT_WRITTEN, INTERRUPTED = 2, 3, 130
"""Exit statuses; see the head of this module."""


class Lapjoint(click.Group):
    """All commands, also of other packages; an error that a user can cause ends in a message and an exit status."""

    def list_commands(self, ctx: click.Context) -> list[str]:
        """Names of all commands, in alphabetical order."""
        return sorted({*super().list_commands(ctx), *entry_points(group=ENTRY_POINT_GROUP).names})

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        """A command of this package, or of another."""
        command = super().get_command(ctx, cmd_name)
        return command or next((_load(entry) for entry in entry_points(group=ENTRY_POINT_GROUP, name=cmd_name)), None)

    def main(self, *args: Any, standalone_mode: bool = True, **extra: Any) -> Any:
        """Run the command line, and end the process with its exit status."""
        run: Any = super().main
        if not standalone_mode:
            return run(*args, standalone_mode=False, **extra)
        try:
            status = run(*args, standalone_mode=False, **extra) or 0
            sys.stdout.flush()
        except click.ClickException as error:
            usage = io.StringIO()
            error.show(usage)
            echo(usage.getvalue(), err=True, nl=False)
            status = error.exit_code
        except click.Abort:
            status = _said("interrupted", INTERRUPTED)
        except OSError as error:
            status = _not_written(error)
        sys.exit(status)

    def invoke(self, ctx: click.Context) -> Any:
        """Run the command; see the module's head for the exit status."""
        try:
            with warnings.catch_warnings():
                _show_warnings()
                return super().invoke(ctx)
        except (click.ClickException, click.Abort, click.exceptions.Exit):
            raise
        except KeyboardInterrupt as interrupt:
            ctx.exit(_said(str(interrupt) or "interrupted", INTERRUPTED))
        except OSError as error:
            ctx.exit(_not_written(error))
        except UnicodeEncodeError as error:
            from lapjoint.problem.messages import LONGEST_VALUE, shortened

            text = shortened(error.object[max(0, error.start - LONGEST_VALUE // 2) :], LONGEST_VALUE)
            ctx.exit(_said(f"{text}: cannot be written: has characters that UTF-8 does not hold", NOT_WRITTEN))
        except (ValueError, RuntimeError, MemoryError) as error:
            from lapjoint.errors import InputError, OutputError, SolverError

            if not isinstance(error, InputError | OutputError | SolverError | MemoryError):
                raise
            status = (
                BAD_INPUT if isinstance(error, InputError) else NOT_WRITTEN if isinstance(error, OutputError) else 1
            )
            ctx.exit(_said(str(error) or "out of memory", status))


def _said(message: str, status: int) -> int:
    """Print a message on standard error, and return `status`."""
    echo(f"lapjoint: {message}", err=True)
    return status


def _not_written(error: OSError) -> int:
    """The exit status after an error of the operating system in a temporary file or in standard output.

    Standard output is then redirected to the null device, because Python writes to it again at exit.  A pipe without a
    reader gets no message.
    """
    with suppress(OSError, ValueError):
        try:
            sys.stdout.flush()
        except OSError:
            os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
    if error.errno == errno.EPIPE:
        return 1
    return _said(f"{error.filename or 'output'}: cannot be written: {error.strerror or error}", NOT_WRITTEN)


def _show_warnings() -> None:
    """Print warnings of damaged files and of the excitation as messages of the command."""
    from lapjoint.errors import DamageWarning, ExcitationWarning

    show: Any = warnings.showwarning

    def show_in_a_line(message: Warning | str, category: type[Warning], *where: Any, **kept: Any) -> None:
        if issubclass(category, DamageWarning | ExcitationWarning):
            _said(str(message), 0)
        else:
            show(message, category, *where, **kept)

    for ours in (DamageWarning, ExcitationWarning):
        warnings.simplefilter("always", ours)
    warnings.showwarning = show_in_a_line


def _load(entry: EntryPoint) -> click.Command:
    """The command of an entry point; if it cannot be loaded, a command that says why, so that the others work."""
    try:
        command: click.Command = entry.load()
    except (ImportError, AttributeError) as error:
        reason = f"command {entry.name!r} is installed but cannot be loaded: {error}"

        def refuse(arguments: tuple[str, ...]) -> None:
            raise click.ClickException(reason)

        anything = click.Argument(["arguments"], nargs=-1, type=click.UNPROCESSED)
        settings = {"ignore_unknown_options": True}
        return click.Command(entry.name, settings, refuse, [anything], short_help="Cannot be loaded.")
    return command


@click.group(cls=Lapjoint, context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 100})
@click.version_option(package_name="lapjoint", prog_name="lapjoint")
def main() -> None:
    """Simulate a loose, impacting lap joint by two independent solvers, and compare their answers.

    PROBLEM is a TOML file (see `lapjoint init`), or preset:paper, preset:lap or preset:sdnl104.
    """


for command in (
    *(modes, equilibrium, simulate, steady, statistics, sweep, basins, branch, confirm),
    *(plot, uncertainty, sketch, export, show),
):
    main.add_command(command)


@main.command()
def schema() -> None:
    """Print the JSON Schema of a problem file."""
    from lapjoint.problem.files import json_schema

    echo(json.dumps(json_schema(), indent=2))


@main.command()
@click.argument("file", type=FILE, default="-")
@click.option(
    "--preset",
    type=click.Choice(["paper", "lap"]),
    default="paper",
    show_default=True,
    help="paper: one beam; lap: two beams that strike each other.",
)
@click.option("--force", is_flag=True, help="Overwrite FILE if it is there.")
def init(file: str, preset: ExampleName, force: bool) -> None:
    """Write a commented example of a problem to FILE, or to standard output."""
    from lapjoint.errors import InputError
    from lapjoint.files.writing import write_file
    from lapjoint.problem.example import commented_example

    example = commented_example(preset)
    if file == "-":
        echo(example, nl=False)
        return
    if Path(file).exists() and not force:
        raise InputError(f"{file}: is there already; --force overwrites it")
    write_file(file, example)
    echo(f"Wrote {file}")
