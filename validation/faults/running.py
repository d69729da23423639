"""Many trials: each on its own copy of the packages, in its own process, some at a time.

The processes are forked from one that has loaded the heavy libraries (multiprocessing's fork server).  A trial then
begins at once, and nothing leaks from one trial to the next.  Ctrl-C ends all trials; a `TrialJournal` keeps those that
are done.
"""

from __future__ import annotations

import hashlib
import json
import multiprocessing
import re
import signal
import tempfile
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from multiprocessing.connection import Connection, wait
from multiprocessing.context import ForkServerContext, ForkServerProcess
from pathlib import Path
from typing import Any

from lapjoint.machine.processes import interrupts_held
from validation.case import Level
from validation.faults.changed_tree import PACKAGES, Changed, change, copied_tree
from validation.faults.trial import Result, Seen, try_tree

ALLOWANCE, TIMES = 20.0, 10.0
"""Time of the processor that a case may take on a changed tree, s, besides `TIMES` what it takes on the sound one."""
COMPILING = 200.0
"""Time, s, that it may take besides where functions have to be compiled again, all of which takes half of this."""
_NOT_JUDGING = ("cases", "faults", "report", "command.py", "suite.py")
"""Parts of the validation on which no verdict of another case depends; each case is known by a digest of its own."""


Limits = tuple[tuple[str, float], ...]
"""Modules of cases in the order in which they run, and the most time that each may take, s."""


@dataclass(frozen=True)
class Order:
    """The cases in the order in which all trials run them, cheapest first."""

    costs: Mapping[str, float]
    """The time of each case on the sound tree, s."""
    first: str = ""
    """A case that runs before them, such as the one that caught the same change before."""

    def limits(self, compiles: bool) -> tuple[tuple[str, float], ...]:
        """The cases, and the most time that each may take, s; more if functions have to be compiled again."""
        more = ALLOWANCE + (COMPILING if compiles else 0.0)
        ordered = sorted(self.costs.items(), key=lambda item: (item[0] != self.first, item[1]))
        return tuple((case, more + TIMES * seconds) for case, seconds in ordered)


class TrialJournal:
    """Trials that are done, a line each in a file: a run that was interrupted goes on where it stopped.

    The outcome of a case counts as long as the source of the case stays.  After a change of one case, or with one more
    case, only this case is run again.
    """

    def __init__(self, path: Path | None) -> None:
        self._path, self._seen = path, dict[str, tuple[Seen, dict[str, str]]]()
        if path is None or not path.exists():
            return
        for line in path.read_text(errors="replace").splitlines():
            try:
                entry = json.loads(line)
                self._seen[entry["key"]] = seen_from(entry["seen"]), dict(entry["cases"])
            except (ValueError, KeyError, TypeError):
                continue  # a line that was cut off: its trial is run again

    def get(self, key: str, cases: Mapping[str, str]) -> Seen | None:
        """The outcome of a trial that was run before, if it would be the outcome again; else None."""
        if key not in self._seen:
            return None
        seen, sources = self._seen[key]
        if seen.case:
            return seen if seen.case in cases and sources.get(seen.case) == cases[seen.case] else None
        return seen if set(cases) <= {case for case, _ in self.passed(key, cases).spent} else None

    def passed(self, key: str, cases: Mapping[str, str]) -> Seen:
        """The cases that a trial went through before without being caught."""
        seen, sources = self._seen.get(key, (Seen(Result.MISSED), dict[str, str]()))
        spent = tuple(
            (case, seconds)
            for case, seconds in seen.spent
            if case != seen.case and case in cases and sources.get(case) == cases[case]
        )
        return Seen(Result.MISSED, seconds=sum(seconds for _, seconds in spent), spent=spent)

    def put(self, key: str, seen: Seen, cases: Mapping[str, str]) -> Seen:
        """Keep the outcome of a trial, together with the cases that it went through before."""
        before = self.passed(key, cases)
        seen = replace(seen, spent=before.spent + seen.spent, seconds=before.seconds + seen.seconds)
        self._seen[key] = seen, dict(cases)
        if self._path is not None:
            with open(self._path, "a") as file:
                file.write(json.dumps({"key": key, "seen": plain(seen), "cases": dict(cases)}) + "\n")
        return seen


def plain(seen: Seen) -> dict[str, Any]:
    """An outcome as plain values, for JSON."""
    return {**vars(seen), "result": seen.result.value}


def seen_from(values: Mapping[str, Any]) -> Seen:
    """An outcome from plain values."""
    spent = tuple((str(case), float(seconds)) for case, seconds in values.get("spent", ()))
    return Seen(**{**values, "result": Result(values["result"]), "spent": spent})


def digest(tree: Path) -> str:
    """A digest of all source on which verdicts depend, but for that of the cases."""
    found = hashlib.sha256()
    for package in PACKAGES:
        for path in sorted((tree / package).rglob("*.*")):
            parts = path.relative_to(tree).parts
            if path.suffix in (".py", ".toml") and not (parts[0] == "validation" and parts[1] in _NOT_JUDGING):
                found.update("/".join(parts).encode() + b"\0" + path.read_bytes())
    return found.hexdigest()


def case_digests(tree: Path) -> dict[str, str]:
    """A digest of the source of each case, and of the cases that it imports."""
    sources = {path.stem: path.read_text() for path in sorted((tree / "validation/cases").glob("*.py"))}
    needed = {case: {case, *re.findall(r"validation\.cases\.(\w+)", source)} for case, source in sources.items()}
    while (
        more := {case: set().union(*(needed.get(one, ()) for one in ones)) for case, ones in needed.items()}
    ) != needed:
        needed = more
    return {
        case: hashlib.sha256("\0".join(sources.get(one, "") for one in sorted(ones)).encode()).hexdigest()
        for case, ones in needed.items()
    }


@dataclass
class _Trial:
    """A trial under way."""

    changed: Changed
    key: str
    folder: tempfile.TemporaryDirectory[str]
    process: ForkServerProcess
    case: str = ""
    """The case that it is at."""


class Trials:
    """Runs trials, some at a time."""

    def __init__(self, tree: Path, level: Level, workers: int, kept: TrialJournal) -> None:
        self.tree, self._level, self._workers, self._kept = tree, level, workers, kept
        self._digest, self._sources = digest(tree), case_digests(tree)
        self._context: ForkServerContext = multiprocessing.get_context("forkserver")
        self._context.set_forkserver_preload(["validation.faults.preload"])

    def costs(self, cases: Sequence[str], done: Callable[[str, Seen], None]) -> dict[str, Seen]:
        """Run each case alone on the sound packages, whether that was done before or not.

        Functions that the cases compile stay in the sound tree, and every trial gets them with its copy of the tree.
        Without them a trial would have to compile, for which it has no allowance, and count as too slow.  Nothing
        disagrees if every case is `Result.MISSED`.
        """
        jobs = [(Changed(case), ((case, 3600.0),)) for case in cases]
        found = {}
        for changed, seen in self._run(jobs):
            found[changed.label] = seen
            done(changed.label, seen)
        return found

    def judged(
        self, changes: Iterable[Changed], order: Order, first: Mapping[str, str] | None = None
    ) -> Iterator[tuple[Changed, Seen]]:
        """Run the cases on each change until the first disagreement; changes are yielded as they are done.

        `first` names the case that runs first on a change, by the label of the change, where it is not the cheapest.
        """
        known = first or {}
        yield from self._run((it, replace(order, first=known.get(it.label, ""))) for it in changes)

    def _run(self, jobs: Iterable[tuple[Changed, Order | Limits]]) -> Iterator[tuple[Changed, Seen]]:
        waiting, running = iter(jobs), dict[Connection, _Trial]()
        try:
            while True:
                while len(running) < self._workers and (job := next(waiting, None)) is not None:
                    changed, cases = job
                    key = self._key(changed)
                    seen = self._kept.get(key, self._with_digests(_limits(cases, False)))
                    if seen is not None and changed.module:
                        yield changed, seen
                        continue
                    here, trial = self._begin(changed, cases, key)
                    running[here] = trial
                if not running:
                    return
                for ready in wait(list(running)):
                    assert isinstance(ready, Connection)
                    trial = running[ready]
                    seen = _received(ready, trial)
                    if seen is None:
                        continue
                    del running[ready]
                    ready.close()
                    trial.folder.cleanup()
                    yield trial.changed, self._put(trial, seen)
        finally:
            for connection, trial in running.items():
                trial.process.kill()
                trial.process.join()
                connection.close()
                trial.folder.cleanup()

    def _put(self, trial: _Trial, seen: Seen) -> Seen:
        """The outcome of a trial, kept if anything is changed in it."""
        return self._kept.put(trial.key, seen, self._sources) if trial.changed.module else seen

    def _with_digests(self, limits: Limits) -> dict[str, str]:
        return {case: self._sources[case] for case, _ in limits}

    def _key(self, changed: Changed) -> str:
        """All that the outcome of a trial depends on but for the cases."""
        text = "\0".join((self._digest, self._level, changed.module, changed.source or changed.label))
        return hashlib.sha256(text.encode()).hexdigest()

    def _begin(self, changed: Changed, cases: Order | Limits, key: str) -> tuple[Connection, _Trial]:
        folder = tempfile.TemporaryDirectory(prefix="lapjoint-fault-")
        tree = self.tree
        compiles = False
        if changed.module:
            tree = Path(folder.name)
            copied_tree(self.tree, tree)
            compiles = change(tree, changed.module, changed.source)
        passed = {case for case, _ in self._kept.passed(key, self._sources).spent} if changed.module else set()
        limits = tuple((case, most) for case, most in _limits(cases, compiles) if case not in passed)
        here, there = self._context.Pipe(duplex=False)
        process = self._context.Process(target=try_tree, args=(str(tree), limits, self._level, there))
        with interrupts_held():
            process.start()
        there.close()
        return here, _Trial(changed, key, folder, process)


def _limits(cases: Order | Limits, compiles: bool) -> Limits:
    return cases.limits(compiles) if isinstance(cases, Order) else cases


def _received(connection: Connection, trial: _Trial) -> Seen | None:
    """What a trial sent or how it ended; None while it goes on."""
    try:
        message = connection.recv()
    except EOFError:
        trial.process.join()
        code = trial.process.exitcode or 0
        if code == -signal.SIGXCPU:
            return Seen(Result.TOO_SLOW, trial.case)
        return Seen(Result.CRASHED, trial.case, f"the process ended with status {code}")
    if isinstance(message, str):
        trial.case = message
        return None
    trial.process.join()
    return seen_from(message)
