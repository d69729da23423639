"""``python -m validation.faults.mutants``: changes drawn at random, and what catches each; survivors with their reason.

Each mutant goes through the cases as a fault does.  One that no case catches either shows what the cases lack, or
changes no answer: `equivalent.toml` then holds it with the reason.
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

from rich.console import Console

from lapjoint.output_files import write_file
from validation.faults.changed_tree import source_of
from validation.faults.mutation import Mutant, drawn
from validation.faults.record import recorded
from validation.faults.run import LEVEL, seen_line, sound, sound_tree
from validation.faults.running import Changed, Kept, Order, Trials
from validation.faults.trial import Result, Seen
from validation.suite import modules_of

SEED = 1
EQUIVALENT = "equivalent.toml"
"""File beside this module: a reason for each mutant that changes no answer."""
KEPT = "mutants.jsonl"
_HEAD = """# Mutants

<!-- Written by `python -m validation.faults.mutants --page docs/mutants.md`; not to be edited. -->

Changes drawn at random from the source of both solvers and of the ground: a sign, a factor of 1.001, a term dropped, an
index off by one. Each goes through the cases that it takes to catch all [faults](faults.md), at the quick level, the
cheapest first, until one disagrees; a crash, or a case that takes far too long, is told apart. What is not caught needs
a check, or a reason why it changes no answer; those with a reason are called equivalent.

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


def identity(mutant: Mutant) -> str:
    """What a mutant is called, whatever line it is in.

    Parameters
    ----------
    mutant : Mutant
        The change.

    Returns
    -------
    str
        Module, function, and what becomes of what.
    """
    old, new = (" ".join(text.split()) for text in (mutant.old, mutant.new))
    return f"{mutant.module}.{mutant.function}: {old} -> {new}"


def reasons() -> dict[str, str]:
    """Why mutants change no answer, by their `identity`."""
    text = (Path(str(files("validation.faults"))) / EQUIVALENT).read_text()
    return {entry["mutant"]: entry["reason"] for entry in tomllib.loads(text).get("equivalent", [])}


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
        by_name = {identity(mutant): mutant for mutant in mutants}
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
        cells = (f"`{identity(it.mutant)}`", it.mutant.kind, it.verdict, by, it.seen.number, it.seen.bound)
        text += "| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |\n"
    return text


def main(arguments: Sequence[str] | None = None) -> int:
    """Draw, judge, and write ``mutants.md`` and ``mutants.json``.

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
    parser.add_argument("--page", type=Path, help="write the table here, too")
    parser.add_argument("-o", "--output", type=Path, default=Path("report"), help="folder (report)")
    given = parser.parse_args(arguments)
    given.output.mkdir(parents=True, exist_ok=True)
    with sound_tree() as tree:
        mutants = drawn(tree, given.seed, given.count)
    cases = modules_of(tuple(given.case)) if given.case else tuple(recorded()[1]) or modules_of(())
    outcomes = judged(mutants, cases, given.output, Console(), given.workers)
    plain = [{"mutant": identity(it.mutant), "kind": it.mutant.kind, "verdict": it.verdict} for it in outcomes]
    write_file(given.output / "mutants.json", json.dumps(plain, indent=1) + "\n")
    for page in {given.output / "mutants.md", given.page or given.output / "mutants.md"}:
        write_file(page, table(outcomes, given.seed))
    print(f"{given.output / 'mutants.md'}: {dict(Counter(it.verdict for it in outcomes))}")
    return 0 if outcomes and all(it.seen.result is not Result.MISSED or it.reason for it in outcomes) else 1


if __name__ == "__main__":
    sys.exit(main())
