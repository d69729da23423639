"""The command ``lapjoint``.

Exit status: 0 when all went well; 1 when something disagrees, the solver had to give up, or what remains of a motion
could not be established; 2 for bad input, with a message and no traceback; 130 after Ctrl-C.

Another package adds a command by an entry point of the group ``lapjoint.commands``, a `click.Command`.  Everything
heavy is imported inside the functions that need it, so that ``lapjoint --help`` answers at once.
"""

from __future__ import annotations

import json
from importlib.metadata import EntryPoint, entry_points
from pathlib import Path
from typing import Any

import click

from lapjoint.cli.look import export, show
from lapjoint.cli.solve import modes, simulate, steady
from lapjoint.cli.sweep import plot, sweep

ENTRY_POINT_GROUP = "lapjoint.commands"


class Lapjoint(click.Group):
    """All commands, those of other packages too; errors that a user can cause end in a message and an exit status."""

    def list_commands(self, ctx: click.Context) -> list[str]:
        """Names of all commands, in alphabetical order."""
        return sorted({*super().list_commands(ctx), *entry_points(group=ENTRY_POINT_GROUP).names})

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        """A command of this package, or of another."""
        command = super().get_command(ctx, cmd_name)
        return command or next((_load(entry) for entry in entry_points(group=ENTRY_POINT_GROUP, name=cmd_name)), None)

    def invoke(self, ctx: click.Context) -> Any:
        """Run the command; see the module's head for the exit status."""
        try:
            return super().invoke(ctx)
        except (click.ClickException, click.Abort, click.exceptions.Exit):
            raise
        except KeyboardInterrupt as interrupt:
            click.echo(f"lapjoint: {str(interrupt) or 'interrupted'}", err=True)
            ctx.exit(130)
        except (ValueError, RuntimeError, MemoryError) as error:
            from lapjoint.errors import InputError, OutputError, SolverError

            if not isinstance(error, InputError | OutputError | SolverError | MemoryError):
                raise
            click.echo(f"lapjoint: {error or 'out of memory'}", err=True)
            ctx.exit(2 if isinstance(error, InputError) else 1)


def _load(entry: EntryPoint) -> click.Command:
    """The command of an entry point; where it cannot be loaded, one that says so, and leaves the others usable."""
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
    """Two independent solvers for a loose, impacting lap joint, and a verdict on whether to believe them.

    PROBLEM is a TOML file (see `lapjoint init`), or preset:paper, or preset:sdnl104.
    """


for command in (modes, simulate, steady, sweep, plot, export, show):
    main.add_command(command)


@main.command()
def schema() -> None:
    """Print the JSON Schema of a problem file."""
    from lapjoint.problem.files import json_schema

    click.echo(json.dumps(json_schema(), indent=2))


@main.command()
@click.argument("file", default="-")
@click.option("--force", is_flag=True, help="Overwrite FILE if it is there.")
def init(file: str, force: bool) -> None:
    """Write a commented example of a problem to FILE, or to standard output."""
    from lapjoint.errors import InputError
    from lapjoint.output_files import write_file
    from lapjoint.problem.example import commented_example

    if file == "-":
        click.echo(commented_example(), nl=False)
        return
    if Path(file).exists() and not force:
        raise InputError(f"{file}: is there already; --force overwrites it")
    write_file(file, commented_example())
    click.echo(f"Wrote {file}")
