"""``python -m validation.faults.mutants``: changes drawn at random, and what catches each; survivors with their reason.

Each mutant goes through the cases as a fault does.  One that no case catches either shows what the cases lack, or
changes no answer: `equivalent.toml` then holds it with the reason.  The run whose page the documents show is kept in
`mutants.json`; its mutants come first in every later run.
"""

from __future__ import annotations

import argparse
import json
import os
import sys
import tomllib
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from importlib.resources import files
from pathlib import Path
from typing import Any

from rich.console import Console

from lapjoint.output_files import write_file
from validation.faults.changed_tree import source_of
from validation.faults.mutation import Mutant, drawn
from validation.faults.record import recorded
from validation.faults.run import LEVEL, seen_line, sound, sound_tree
from validation.faults.running import Changed, Kept, Order, Trials, plain, seen_from
from validation.faults.trial import Result, Seen
from validation.suite import modules_of

SEED = 1
EQUIVALENT = "equivalent.toml"
"""File beside this module: a reason for each mutant that changes no answer."""
RECORD, PAGE = "mutants.json", "mutants.md"
"""File beside this module that keeps the run which the documents show, and their page."""
KEPT = "mutants.jsonl"
BESIDES = ("as_published", "slow_modes")
"""Cases that mutants go through besides those that it takes to catch all faults."""
_HEAD = """# Mutants

<!-- Written by `python -m validation.faults.mutants --page docs/mutants.md`; not to be edited. -->

Changes drawn at random from the source of both solvers and of the ground: a sign, a factor of 1.001, a term dropped, an
index off by one. Each goes through the cases that it takes to catch all [faults](faults.md) and two more, at the quick
level, the cheapest first, until one disagrees; a crash, or a case that takes far too long, is told apart. What is not
caught needs a check, or a reason why it changes no answer; those with a reason are called equivalent.

These are the first {count} that the seed {seed} draws: {found}.

| mutant | kind | result | by | number | bound |
|---|---|---|---|---|---|
"""


@dataclass(frozen=True)
class Outcome:
    """A mutant, and what became of it under the judge."""

    mutant: Mutant
    seen: Seen
    reason: str
    """Why it changes no answer; empty where none is known, or none is due."""

    @property
    def verdict(self) -> str:
        """In a word or two."""
        return "equivalent" if self.seen.result is Result.MISSED and self.reason else self.seen.result.value


def reasons() -> dict[str, str]:
    """Why mutants change no answer, by their identity."""
    text = (Path(str(files("validation.faults"))) / EQUIVALENT).read_text()
    return {entry["mutant"]: entry["reason"] for entry in tomllib.loads(text).get("equivalent", [])}


def record_path() -> Path:
    """The file of the record, beside this module."""
    return Path(str(files("validation.faults"))) / RECORD


def recorded_outcomes() -> tuple[Outcome, ...]:
    """The run that the documents show, with the reasons that are known now."""
    if not record_path().exists():
        return ()
    known = reasons()
    found = ((Mutant(**entry["mutant"]), seen_from(entry["seen"])) for entry in json.loads(record_path().read_text()))
    return tuple(Outcome(mutant, seen, known.get(mutant.identity, "")) for mutant, seen in found)


def written(outcomes: Sequence[Outcome]) -> str:
    """The record as text.

    Parameters
    ----------
    outcomes : sequence of Outcome
        In the sequence in which they were drawn.

    Returns
    -------
    str
        JSON.
    """

    def line(seen: Seen) -> dict[str, Any]:
        return {key: value for key, value in plain(seen).items() if key not in ("spent", "seconds") and value != ""}

    data = [{"mutant": vars(it.mutant), "seen": line(it.seen)} for it in outcomes]
    return json.dumps(data, indent=1) + "\n"


def judged(
    mutants: Sequence[Mutant], cases: Sequence[str], output: Path, console: Console, workers: int
) -> list[Outcome]:
    """Run the cases on each mutant until something disagrees.

    Parameters
    ----------
    mutants : sequence of Mutant
        What was drawn.
    cases : sequence of str
        Modules of the cases.
    output : Path
        Folder that keeps the trials that are done.
    console : rich.console.Console
        Where progress goes.
    workers : int
        Number of trials at a time.

    Returns
    -------
    list of Outcome
        In the sequence in which they were drawn.
    """
    known, found = reasons(), dict[str, Outcome]()
    with sound_tree() as tree:
        trials = Trials(tree, LEVEL, workers, Kept(output / KEPT))
        baseline = sound(trials, cases, console)
        if any(seen.result is not Result.MISSED for seen in baseline.values()):
            return []
        by_name = {mutant.identity: mutant for mutant in mutants}
        changes = (
            Changed(name, mutant.module, mutant.put_into(source_of(tree, mutant.module)))
            for name, mutant in by_name.items()
        )
        order = Order({case: seen.seconds for case, seen in baseline.items()})
        for changed, seen in trials.judged(changes, order):
            name = changed.label
            found[name] = Outcome(by_name[name], seen, known.get(name, ""))
            line = f"  {len(found)}/{len(by_name)} {name}: {seen_line(seen)}"
            console.print(line, highlight=False, markup=False, soft_wrap=True)
    return [found[name] for name in by_name]


def table(outcomes: Sequence[Outcome], seed: int) -> str:
    """The outcomes as a page.

    Parameters
    ----------
    outcomes : sequence of Outcome
        In the sequence in which they were drawn.
    seed : int
        With which they were drawn.

    Returns
    -------
    str
        Markdown.
    """
    counts = Counter(outcome.verdict for outcome in outcomes)
    found = ", ".join(f"{number} {verdict}" for verdict, number in counts.most_common())
    text = _HEAD.format(count=len(outcomes), seed=seed, found=found)
    for it in outcomes:
        by = it.reason if it.verdict == "equivalent" else f"{it.seen.case.replace('_', '-')}: {it.seen.item}"
        cells = (f"`{it.mutant.identity}`", it.mutant.kind, it.verdict, by, it.seen.number, it.seen.bound)
        text += "| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |\n"
    return text


def main(arguments: Sequence[str] | None = None) -> int:
    """Draw, judge, and write `PAGE` and `RECORD`.

    Parameters
    ----------
    arguments : sequence of str, optional
        Of the command line.

    Returns
    -------
    int
        0 if nothing survived without a reason, else 1.
    """
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--count", type=int, default=100, help="how many (100)")
    parser.add_argument("--seed", type=int, default=SEED, help=f"of the random numbers ({SEED})")
    parser.add_argument(
        "--case", action="append", default=[], help="this case; repeatable; by default those of the record"
    )
    parser.add_argument("--workers", type=int, default=len(os.sched_getaffinity(0)), help="so many at a time")
    parser.add_argument("--page", type=Path, help=f"write the table here, too, and {RECORD}, from which it is made")
    parser.add_argument("-o", "--output", type=Path, default=Path("report"), help="folder (report)")
    given = parser.parse_args(arguments)
    given.output.mkdir(parents=True, exist_ok=True)
    with sound_tree() as tree:
        mutants = drawn(tree, given.seed, given.count, [it.mutant.identity for it in recorded_outcomes()])
    usual = tuple(dict.fromkeys((*recorded()[1], *BESIDES))) if recorded()[1] else modules_of(())
    cases = modules_of(tuple(given.case)) if given.case else usual
    outcomes = judged(mutants, cases, given.output, Console(), given.workers)
    write_file(given.output / RECORD, written(outcomes))
    write_file(given.output / PAGE, table(outcomes, given.seed))
    if given.page is not None and outcomes:
        write_file(record_path(), written(outcomes))
        write_file(given.page, table(outcomes, given.seed))
    print(f"{given.output / PAGE}: {dict(Counter(it.verdict for it in outcomes))}")
    return 0 if outcomes and all(it.seen.result is not Result.MISSED or it.reason for it in outcomes) else 1


if __name__ == "__main__":
    sys.exit(main())
