"""Progress on standard error: a bar on a terminal, a line for every tenth part elsewhere."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import contextmanager

import click

from lapjoint.solver import Progress


@contextmanager
def shown_progress(title: str) -> Iterator[Progress]:
    """Give a callback ``progress(done, total)`` that shows how far the work called `title` has come."""
    if not sys.stderr.isatty():
        yield lines_of_progress(title)
        return
    import rich.console
    import rich.progress

    console = rich.console.Console(stderr=True)
    with rich.progress.Progress(console=console, transient=True) as bar:
        task = bar.add_task(title, total=1.0)
        yield lambda done, total: bar.update(task, completed=done / total if total else 0.0)


def lines_of_progress(title: str) -> Progress:
    """A callback that prints a line each time another tenth of the work is done."""
    shown = 0

    def progress(done: float, total: float) -> None:
        nonlocal shown
        tenths = int(10 * done / total + 1e-9) if total > 0 else 0
        if tenths > shown:
            shown = tenths
            click.echo(f"{title}: {10 * tenths} %", err=True)

    return progress
