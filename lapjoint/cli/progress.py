"""Progress on standard error: a bar on a terminal, a line now and then elsewhere."""

from __future__ import annotations

import logging
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from lapjoint.cli.echo import echo
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
            echo(f"{title}: {10 * tenths} %", err=True)

    return progress


@contextmanager
def shown_points(title: str) -> Iterator[Progress]:
    """Give a callback ``progress(done, total)`` that shows how many points are done, and the time left."""
    if not sys.stderr.isatty():
        yield lines_with_time_left(title)
        return
    import rich.console
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

    columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeRemainingColumn())
    with Progress(*columns, console=rich.console.Console(stderr=True), transient=True) as bar:
        task = bar.add_task(title, total=None)
        began = False

        def progress(done: float, total: float) -> None:
            nonlocal began
            if not began:  # what was done before says nothing about the speed
                bar.reset(task, total=total, completed=int(done))
                began = True
            bar.update(task, completed=done)

        yield progress


def lines_with_time_left(title: str, clock: Callable[[], float] = time.monotonic) -> Progress:
    """A callback that prints a line each time another twentieth is done, with the time that is left.

    The first call says where the work begins: what was done before does not count as quick.
    """
    began: tuple[float, float] | None = None
    shown = 0

    def progress(done: float, total: float) -> None:
        nonlocal began, shown
        share = int(20 * done / total + 1e-9) if total > 0 else 0
        if began is None:
            began, shown = (clock(), done), share
            if done:
                echo(f"{title}: goes on from {done:g} of {total:g}", err=True)
        elif share > shown:
            shown = share
            left = (clock() - began[0]) * (total - done) / (done - began[1]) if done > began[1] else 0.0
            tail = f", {duration_text(left)} left" if done < total else ""
            echo(f"{title}: {5 * share} %, {done:g} of {total:g}{tail}", err=True)

    return progress


def duration_text(seconds: float) -> str:
    """A duration for a person: ``40 s``, ``12 min``, ``3 h 20 min``."""
    if seconds < 100:
        return f"{seconds:.0f} s"
    minutes = round(seconds / 60)
    return f"{minutes} min" if minutes < 100 else f"{minutes // 60} h {minutes % 60} min"


class _Lines(logging.Handler):
    """Prints what is logged on standard error, whatever that is then."""

    def emit(self, record: logging.LogRecord) -> None:
        """Print one message."""
        echo(f"lapjoint: {record.getMessage()}", err=True)


def tell_of_compiling() -> None:
    """Say on standard error when compiling begins, from now on; see `lapjoint.compiling`."""
    logger = logging.getLogger("lapjoint.compiling")
    if not any(isinstance(handler, _Lines) for handler in logger.handlers):
        logger.addHandler(_Lines())
    logger.setLevel(logging.INFO)
