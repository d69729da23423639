"""Progress on standard error: a bar on a terminal, occasional lines elsewhere."""

from __future__ import annotations

import logging
import math
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

from lapjoint.cli.echo import echo
from lapjoint.files.plain_text import duration_text

if TYPE_CHECKING:  # importing solvers loads numpy, and every call of the command line imports this module
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
            if not began:  # points of an earlier run say nothing about the speed
                bar.reset(task, total=total, completed=int(done))
                began = True
            bar.update(task, completed=done)

        yield progress


EARLY = 10.0
"""Time after which the first line is printed if a twentieth of the work takes longer, s."""
A_FEW = 3
"""Number of finished points needed for a line after `EARLY`, or 1 % of all points if that is fewer: the time left is
estimated from the finished points."""


def lines_with_time_left(title: str, clock: Callable[[], float] = time.monotonic) -> Progress:
    """A callback that prints a line each time another twentieth is done, with the time left.

    The first call says where the work begins; points done before it do not count for the time left.  Until the first
    twentieth is done, lines are printed after `EARLY`, then each time the time has doubled, if `A_FEW` points are done.
    """
    began: tuple[float, float] | None = None
    shown = 0
    early: float | None = EARLY

    def progress(done: float, total: float) -> None:
        nonlocal began, shown, early
        share = int(20 * done / total + 1e-9) if total > 0 else 0
        if began is None:
            began, shown = (clock(), done), share
            if done:
                echo(f"{title}: goes on from {done:g} of {total:g}", err=True)
            return
        spent, found = clock() - began[0], done - began[1]
        soon = early is not None and spent >= early and found >= min(A_FEW, 0.01 * total)
        if not (share > shown or (soon and done < total)):
            return
        early = None if share > shown else 2 * spent
        left = spent * (total - done) / found if found > 0 else 0.0
        tail = f", {duration_text(left)} left" if done < total else ""
        percent = f"{5 * share}" if share > shown else f"{100 * done / total:.2g}"
        of = f", {math.floor(done)} of {total:g}" if total > 1 else ""
        shown = share
        echo(f"{title}: {percent} %{of}{tail}", err=True)

    return progress


@contextmanager
def shown_search(title: str, known_as: str = "known so far") -> Iterator[Progress]:
    """Give a callback ``progress(done, known)`` that shows how much of the work known so far a search has done.

    `known_as` describes `known`: the work known so far, or the largest work allowed, of which a search may need less.
    """
    if not sys.stderr.isatty():
        yield lines_of_search(title, known_as=known_as)
        return
    import rich.console
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn

    columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TextColumn(known_as))
    with Progress(*columns, TimeElapsedColumn(), console=rich.console.Console(stderr=True), transient=True) as bar:
        task = bar.add_task(title, total=None)
        yield lambda done, known: bar.update(task, completed=done, total=known)


MOST = 60.0
"""Longest time between two lines of a search, s."""


def lines_of_search(
    title: str, clock: Callable[[], float] = time.monotonic, known_as: str = "known so far"
) -> Progress:
    """A callback that prints a line after `EARLY`, then at growing intervals, at most `MOST`.

    No time left is shown, because a search finds further work on the way.
    """
    began: float | None = None
    due, wait = EARLY, EARLY

    def progress(done: float, known: float) -> None:
        nonlocal began, due, wait
        now = clock()
        if began is None:
            began = now
            if done:
                echo(f"{title}: goes on from {done:g} of {known:g} {known_as}", err=True)
        if now - began < due:
            return
        wait = min(1.5 * wait, MOST)
        due = now - began + wait
        echo(f"{title}: {done:.3g} of {known:g} {known_as}, after {duration_text(now - began)}", err=True)

    return progress


class _Lines(logging.Handler):
    """Prints log messages on the standard error that is current at the time of the message."""

    def emit(self, record: logging.LogRecord) -> None:
        """Print one message."""
        echo(f"lapjoint: {record.getMessage()}", err=True)


def tell_of_delays() -> None:
    """Print, from now on, log messages about compilation, slow points of a campaign, and large use of memory."""
    for name in ("lapjoint.compiled.compiling", "lapjoint.campaigns.pace", "lapjoint.machine.memory"):
        logger = logging.getLogger(name)
        if not any(isinstance(handler, _Lines) for handler in logger.handlers):
            logger.addHandler(_Lines())
        logger.setLevel(logging.INFO)
