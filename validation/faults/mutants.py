"""``python -m validation.faults.mutants``: changes drawn at random, and what catches each; survivors with their reason.

Each mutant goes through the cases as a fault does.  A mutant that no case catches shows what the cases lack, or changes
no answer; `equivalent.toml` gives the reason why a mutant changes no answer.  `mutants.json` keeps the run that the
documents show, with the commits in whose source each mutant was drawn and judged.  Mutants of the kept run come first
in every later run.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import tomllib
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from importlib.resources import files
from pathlib import Path
from typing import Any

from rich.console import Console

from lapjoint.files.writing import write_file
from validation.faults.changed_tree import PACKAGES, Changed, installed_tree, source_of
from validation.faults.mutation import Mutant, drawn
from validation.faults.record import recorded
from validation.faults.run import LEVEL, seen_line, sound, sound_tree
from validation.faults.running import Order, TrialJournal, Trials, plain, seen_from
from validation.faults.trial import Result, Seen
from validation.suite import modules_of

SEED = 1
REASONS = "equivalent.toml"
"""File beside this module: a reason for each mutant that changes no answer."""
RECORD, PAGE = "mutants.json", "mutants.md"
"""File beside this module that keeps the run which the documents show, and their page."""
KEPT = "mutants.jsonl"
EQUIVALENT = "equivalent"
"""Verdict on what no case catches, for a reason that is given."""
BESIDES = ("as_published", "slow_modes")
"""Cases that mutants go through besides those that it takes to catch all faults."""
_HEAD = """# Mutants

<!-- Written by `python -m validation.faults.mutants --page docs/mutants.md`; not to be edited. -->

Changes drawn at random from the source of both solvers and of the ground: a sign, a factor of 1.001, a term dropped, an
index off by one. Each goes through the cases that it takes to catch all [faults](faults.md) and two more, at the quick
level, until one disagrees: first the case that ended it when it was last run, then the others, the cheapest first. A
crash, or a case that takes far too long, is told apart. What is not caught needs a check, or a reason why it changes no
answer; those with a reason are called equivalent.

The seed {seed} drew {drawn}. Judged were {judged}: {found}. The source has moved on since; a name says what was
changed, and where it stood.

| mutant | kind | result | by | number | bound |
|---|---|---|---|---|---|
"""


@dataclass(frozen=True)
class Outcome:
    """A mutant, and the outcome of its trial."""

    mutant: Mutant
    seen: Seen
    reason: str
    """Why the mutant changes no answer; empty where no reason is known, or none is due."""
    drawn: str
    """The commit from whose source the mutant was drawn."""
    judged: str
    """The commit in whose source the mutant was judged; empty where the commit is unknown."""

    @property
    def verdict(self) -> str:
        """The outcome in a word or two."""
        return EQUIVALENT if self.seen.result is Result.MISSED and self.reason else self.seen.result.value


def reasons() -> dict[str, str]:
    """Why mutants change no answer, by their identity, and by the identities before their functions were moved."""
    text = (Path(str(files("validation.faults"))) / REASONS).read_text()
    entries = tomllib.loads(text).get("equivalent", [])
    return {name: entry["reason"] for entry in entries for name in (entry["mutant"], *entry.get("formerly", ()))}


def record_path() -> Path:
    """The file of the record, beside this module."""
    return Path(str(files("validation.faults"))) / RECORD


@dataclass(frozen=True)
class Run:
    """The outcomes of the mutants that a seed draws."""

    seed: int
    outcomes: tuple[Outcome, ...]
    """In the sequence in which they were drawn."""

    @property
    def survivors(self) -> list[str]:
        """Names of the mutants that nothing caught, and for which no reason is given."""
        return [it.mutant.identity for it in self.outcomes if it.verdict == Result.MISSED.value]

    @property
    def text(self) -> str:
        """The record, JSON."""

        def line(seen: Seen) -> dict[str, Any]:
            return {key: value for key, value in plain(seen).items() if key not in ("spent", "seconds") and value != ""}

        found = [
            {"drawn": it.drawn, "judged": it.judged, "mutant": vars(it.mutant), "seen": line(it.seen)}
            for it in self.outcomes
        ]
        return json.dumps({"seed": self.seed, "mutants": found}, indent=1) + "\n"

    @property
    def page(self) -> str:
        """The page of the run, Markdown."""
        text = _HEAD.format(
            seed=self.seed,
            drawn=_counted((it.drawn for it in self.outcomes), "{0} from the source of commit {1}"),
            judged=_counted((it.judged for it in self.outcomes), "{0} in the source of commit {1}"),
            found=_counted((it.verdict for it in self.outcomes), "{0} {1}"),
        )
        for it in self.outcomes:
            by = it.reason if it.verdict == EQUIVALENT else f"{it.seen.case.replace('_', '-')}: {it.seen.item}"
            cells = (f"`{it.mutant.identity}`", it.mutant.kind, it.verdict, by, it.seen.number, it.seen.bound)
            text += "| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |\n"
        return text


def _counted(names: Iterable[str], words: str) -> str:
    """How often each name is there, most often first."""
    return ", ".join(words.format(number, name) for name, number in Counter(names).most_common())


def recorded_run() -> Run:
    """The run that the documents show, with the reasons that are known now; without mutants if there is none."""
    if not record_path().exists():
        return Run(SEED, ())
    known, data = reasons(), json.loads(record_path().read_text())

    def outcome(entry: dict[str, Any]) -> Outcome:
        mutant = Mutant(**entry["mutant"])
        return Outcome(
            mutant, seen_from(entry["seen"]), known.get(mutant.identity, ""), entry["drawn"], entry["judged"]
        )

    return Run(data["seed"], tuple(map(outcome, data["mutants"])))


def commit_of(tree: Path) -> str:
    """The commit that a tree of packages is; empty if it is none, or if its source was changed since."""
    source = [f"{package}/*.{ending}" for package in PACKAGES for ending in ("py", "toml")]
    status = _asked(tree, "status", "--porcelain", "--", *source)
    return "" if status is None or status else _asked(tree, "rev-parse", "--short=7", "HEAD") or ""


def _asked(tree: Path, *question: str) -> str | None:
    """What git says of a folder; None where there is no git, or nothing that it knows."""
    try:
        found = subprocess.run(("git", *question), cwd=tree, capture_output=True, text=True, check=False)
    except OSError:
        return None
    return found.stdout.strip() if found.returncode == 0 else None


def judged(
    mutants: Mapping[Mutant, str],
    cases: Sequence[str],
    first: Mapping[str, str],
    commit: str,
    output: Path,
    console: Console,
    workers: int,
) -> list[Outcome]:
    """Run the cases on each mutant until something disagrees."""
    known, found = reasons(), dict[str, Outcome]()
    with sound_tree() as tree:
        trials = Trials(tree, LEVEL, workers, TrialJournal(output / KEPT))
        baseline = sound(trials, cases, console)
        if any(seen.result is not Result.MISSED for seen in baseline.values()):
            return []
        by_name = {mutant.identity: mutant for mutant in mutants}
        changes = (
            Changed(name, mutant.module, mutant.put_into(source_of(tree, mutant.module)))
            for name, mutant in by_name.items()
        )
        order = Order({case: seen.seconds for case, seen in baseline.items()})
        for changed, seen in trials.judged(changes, order, first):
            name = changed.label
            mutant = by_name[name]
            found[name] = Outcome(mutant, seen, known.get(name, ""), mutants[mutant], commit)
            line = f"  {len(found)}/{len(by_name)} {name}: {seen_line(seen)}"
            console.print(line, highlight=False, markup=False, soft_wrap=True)
    return [found[name] for name in by_name]


def main(arguments: Sequence[str] | None = None) -> int:
    """Draw, judge, and write `PAGE` and `RECORD`."""
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
    commit = commit_of(installed_tree())
    if given.page is not None and not commit:
        parser.error("--page: the source is not that of a commit, which the page has to name")
    given.output.mkdir(parents=True, exist_ok=True)
    before = {it.mutant.identity: it for it in recorded_run().outcomes}
    first = {name: it.seen.case for name, it in before.items()}
    with sound_tree() as tree:
        found = drawn(tree, given.seed, given.count, before)
        mutants = {it: before[it.identity].drawn if it.identity in before else commit for it in found}
    usual = tuple(dict.fromkeys((*recorded()[1], *BESIDES))) if recorded()[1] else modules_of(())
    cases = modules_of(tuple(given.case)) if given.case else usual
    run = Run(given.seed, tuple(judged(mutants, cases, first, commit, given.output, Console(), given.workers)))
    if not run.outcomes:
        return 1
    write_file(given.output / RECORD, run.text)
    write_file(given.output / PAGE, run.page)
    if given.page is not None:
        write_file(record_path(), run.text)
        write_file(given.page, run.page)
    print(f"{given.output / PAGE}: {dict(Counter(it.verdict for it in run.outcomes))}")
    return 1 if run.survivors else 0


if __name__ == "__main__":
    sys.exit(main())
