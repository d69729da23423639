"""``lapjoint validate --faults``: the judge on trial."""

from __future__ import annotations

import os
import tempfile
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from lapjoint.errors import InputError
from validation.case import Level
from validation.faults.catalogue import CONTROL, FAULTS
from validation.faults.changed_tree import copied_tree, installed_tree
from validation.faults.fault import Fault
from validation.faults.record import recorded, write_record
from validation.faults.running import Order, TrialJournal, Trials
from validation.faults.table import Judged, answer
from validation.faults.trial import Result, Seen
from validation.verdict import Verdict

if TYPE_CHECKING:
    from rich.console import Console

LEVEL: Level = "quick"
KEPT = "faults.jsonl"
"""Name of the file in the folder of the report that keeps the trials that are done."""


def main(
    names: Sequence[str],
    quickest: int | None,
    modules: Sequence[str],
    output: Path,
    console: Console,
    workers: int | None = None,
) -> int:
    """Put faults in, one at a time, run the cases on each, and write the reports."""
    from validation.report.write import write_reports
    from validation.suite import modules_of

    begin = time.perf_counter()
    faults, complete = _chosen(names), tuple(modules) == modules_of(())
    if quickest is not None:
        faults, modules = _quickest(faults, modules, quickest)
    with sound_tree() as tree:
        trials = Trials(tree, LEVEL, workers or len(os.sched_getaffinity(0)), TrialJournal(output / KEPT))
        judged, baseline = _on_trial(trials, faults, modules, console)
    result = answer(judged, baseline)
    pages = [*write_reports([result], LEVEL, output, time.perf_counter() - begin)]
    if judged and complete and len(faults) == len(FAULTS) and result.verdict is Verdict.AGREE:
        pages += write_record(judged, baseline)
    console.print(f"\n{result.title}")
    console.print(f"reports: {', '.join(str(page) for page in pages)}", highlight=False, markup=False, soft_wrap=True)
    return 0 if judged and result.verdict is Verdict.AGREE else 1


def _on_trial(
    trials: Trials, faults: Sequence[Fault], modules: Sequence[str], console: Console
) -> tuple[list[Judged], dict[str, Seen]]:
    """Outcomes of the faults, the control and the cases without a fault; of no fault if one of these cases disagrees.

    The cases that the last complete run came to are enough, unless they leave a fault uncaught: then the others follow.
    """
    reached = set(recorded()[1]) & set(modules) or set(modules)
    found: dict[str, Judged] = {}
    baseline: dict[str, Seen] = {}
    for part in ([m for m in modules if m in reached], [m for m in modules if m not in reached]):
        left = [fault for fault in faults if fault.name not in found or not found[fault.name].as_wanted]
        if not part or not left:
            continue
        baseline |= sound(trials, part, console)
        if any(seen.result is not Result.MISSED for seen in baseline.values()):
            return [], baseline
        order = Order({case: seen.seconds for case, seen in baseline.items()})
        found |= {one.fault.name: one for one in _judged(trials, (CONTROL, *left), order, console)}
    return [found[fault.name] for fault in (CONTROL, *faults)], baseline


@contextmanager
def sound_tree() -> Iterator[Path]:
    """A copy of the packages as they are now, which later changes of the source leave alone."""
    with tempfile.TemporaryDirectory(prefix="lapjoint-sound-") as name:
        copied_tree(installed_tree(), Path(name))
        yield Path(name)


def sound(trials: Trials, modules: Sequence[str], console: Console) -> dict[str, Seen]:
    """Run each case without a fault."""
    console.print(f"[bold]{len(modules)} cases without a fault[/bold]", highlight=False)

    def done(case: str, seen: Seen) -> None:
        found = "agrees" if seen.result is Result.MISSED else f"{seen.result.value}: {seen.item}"
        console.print(f"  {case.replace('_', '-')}: {found}, {seen.seconds:.1f} s", highlight=False, markup=False)

    return trials.costs(modules, done)


def _judged(trials: Trials, faults: Sequence[Fault], order: Order, console: Console) -> list[Judged]:
    console.print(f"[bold]{len(faults) - 1} faults, and a control[/bold]", highlight=False)
    known = {fault.name: fault for fault in faults}
    found: list[Judged] = []
    for changed, seen in trials.judged((fault.put_into(trials.tree) for fault in faults), order):
        found.append(Judged(known[changed.label], seen))
        line = f"  {len(found)}/{len(faults)} {changed.label}: {seen_line(seen)}"
        console.print(line, highlight=False, markup=False, soft_wrap=True)
    return found


def seen_line(seen: Seen) -> str:
    """The outcome of a trial, in a line."""
    case = f" by {seen.case.replace('_', '-')}" if seen.case else ""
    item = f": {seen.item}" if seen.item else ""
    numbers = f", {seen.number} against {seen.bound}" if seen.number else ""
    return f"{seen.result.value}{case}{item}{numbers} ({seen.seconds:.1f} s)"


def _chosen(names: Sequence[str]) -> list[Fault]:
    known = {fault.name: fault for fault in FAULTS}
    unknown = [name for name in names if name not in known]
    if unknown:
        raise InputError(f"fault = {unknown[0]!r} is unknown; allowed: {', '.join(known)}")
    return [fault for name, fault in known.items() if not names or name in names]


def _quickest(faults: list[Fault], modules: Sequence[str], count: int) -> tuple[list[Fault], list[str]]:
    caught = [one for one in recorded()[0] if one.fault in faults and one.seen.result is Result.CAUGHT]
    first = sorted(caught, key=lambda one: one.seen.seconds)[:count]
    by = {one.seen.case for one in first}
    return [one.fault for one in first], [module for module in modules if module in by]
