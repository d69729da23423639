"""The command ``lapjoint validate``, which joins the others by the entry point ``lapjoint.commands``.

Everything heavy is imported inside the functions that need it, so that ``lapjoint --help`` answers at once.
"""

from __future__ import annotations

from pathlib import Path
from typing import Literal

import click

from lapjoint.cli.completing import DIRECTORY, PROBLEM, SOLVER, Offering
from lapjoint.cli.echo import echo


def _cases() -> tuple[str, ...]:
    from validation import suite

    return tuple(suite.case_names())


@click.command()
@click.argument("problem", type=PROBLEM, required=False)
@click.option("--set", "overrides", multiple=True, metavar="KEY=VALUE", help="Change one value of PROBLEM; repeatable.")
@click.option(
    "--case", "cases", multiple=True, metavar="NAME", type=Offering(_cases), help="Run only this case; repeatable."
)
@click.option(
    "--peers",
    "peers",
    multiple=True,
    metavar="NAME",
    type=SOLVER,
    help="Also compare with this solver, in the case peers: opensees, or opensees:dt=2e-5,elements=20; repeatable.",
)
@click.option("--quick", "level", flag_value="quick", help="Less refinement.")
@click.option("--full", "level", flag_value="full", help="More refinement.")
@click.option(
    "--duration",
    type=float,
    metavar="S",
    help="Duration of motions of PROBLEM under records or random excitation, s.  [default: the record's, or some decay "
    "times]",
)
@click.option("--faults", is_flag=True, help="Put faults into the program, one at a time, and say what catches each.")
@click.option("--fault", "fault_names", multiple=True, metavar="NAME", help="Put this fault only; repeatable.")
@click.option(
    "--quickest", type=click.IntRange(1), metavar="N", help="Put only the N faults that an earlier run caught fastest."
)
@click.option(
    "--workers",
    type=click.IntRange(1),
    metavar="N",
    help="Number of faults tried at once.  [default: one per processor]",
)
@click.option(
    "-o",
    "--out",
    "output",
    default="report",
    show_default=True,
    metavar="DIR",
    type=DIRECTORY,
    help="Directory of the report.",
)
@click.option("--list", "list_cases", is_flag=True, help="List the cases and stop.")
def validate(
    problem: str | None,
    overrides: tuple[str, ...],
    cases: tuple[str, ...],
    peers: tuple[str, ...],
    level: Literal["quick", "full"] | None,
    duration: float | None,
    faults: bool,
    fault_names: tuple[str, ...],
    quickest: int | None,
    workers: int | None,
    output: str,
    list_cases: bool,
) -> None:
    """Compare the two solvers with each other and with published results; write DIR/report.html.

    With PROBLEM, compare the solvers on that problem instead.  With --faults, judge the judge: docs/faults.md has the
    table of the last complete run.
    """
    import rich.console

    from lapjoint.cli import arguments
    from validation import suite

    if list_cases:
        echo("\n".join(suite.case_names()))
        return
    if problem is None:
        changes = " ".join(overrides) or None
        arguments.refuse("it changes a PROBLEM, and none is given; preset:paper is one", set=changes)
        arguments.refuse("it is that of the motions of a PROBLEM, and none is given", duration=duration)
    arguments.check_directory(output)
    arguments.check_duration(duration)
    if faults or fault_names or quickest is not None:
        if problem is not None or peers or level is not None:
            raise click.UsageError("--faults takes no problem, no peers and no level: it is the suite that is judged.")
        from validation.faults import run

        folder, modules = suite.writable(Path(output)), suite.modules_of(cases)
        status = run.main(fault_names, quickest, modules, folder, rich.console.Console(), workers)
        click.get_current_context().exit(status)
    this = None if problem is None else arguments.problem_from(problem, overrides)
    named, console = tuple(dict.fromkeys(peers)), rich.console.Console()
    source = " ".join([problem or "", *(f"--set {one}" for one in overrides)])
    status = suite.main(
        this, cases, level or "standard", Path(output), console, named, source=source, duration=duration
    )
    click.get_current_context().exit(status)
