"""What caught each fault, as a case of the report."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from validation.case import CaseResult, table
from validation.faults.catalogue import CONTROL
from validation.faults.fault import Fault
from validation.faults.trial import Result, Seen
from validation.verdict import Criterion

COLUMNS = ("fault", "kind", "where", "what it does", "result", "case", "comparison", "by", "against", "time (s)")


@dataclass(frozen=True)
class Judged:
    """A fault, and the outcome of its trial."""

    fault: Fault
    seen: Seen

    @property
    def as_wanted(self) -> bool:
        """Whether a fault was caught, or the control was not."""
        return self.seen.result is (Result.MISSED if self.fault == CONTROL else Result.CAUGHT)

    @property
    def row(self) -> tuple[str, ...]:
        """Its line of the table."""
        fault, seen = self.fault, self.seen
        found = (seen.result.value, seen.case.replace("_", "-"), seen.item, seen.number, seen.bound)
        return (fault.name, fault.kind, fault.place, fault.what, *found, f"{seen.seconds:.1f}")


def answer(judged: Sequence[Judged], baseline: dict[str, Seen]) -> CaseResult:
    """The faults as a case of the report, which agrees if all are caught, and nothing is without a fault."""
    criteria = [
        Criterion(
            f"{one.fault.name}: {one.seen.result.value}",
            "1",
            float(one.seen.result is Result.CAUGHT),
            *((0.0, 0.0) if one.fault == CONTROL else (1.0, 1.0)),
            one.fault.what,
        )
        for one in judged
    ]
    criteria += [
        Criterion(f"without a fault, {case}: disagreements", "1", float(seen.result is not Result.MISSED), 0.0, 0.0, "")
        for case, seen in baseline.items()
    ]
    faults = [one for one in judged if one.fault != CONTROL]
    caught = sum(one.as_wanted for one in faults)
    return CaseResult(
        "faults",
        f"Would the judge notice? {caught} of {len(faults)} faults caught",
        "Faults of the kinds that programs have are put into one solver, or into the ground that both share, one at a "
        "time, and the cases run at the quick level, cheapest first, until one disagrees. A fault is caught if the "
        "verdict changes; a crash does not count. No fault names the case that is to catch it. The control changes "
        "nothing, and must not be caught.",
        criteria=tuple(criteria),
        tables=(
            table("Faults, and what caught them", COLUMNS, [one.row for one in judged]),
            table(
                "Cases without a fault",
                ("case", "time (s)"),
                [(case.replace("_", "-"), f"{seen.seconds:.1f}") for case, seen in _by_cost(baseline)],
            ),
        ),
    )


def _by_cost(baseline: dict[str, Seen]) -> list[tuple[str, Seen]]:
    return sorted(baseline.items(), key=lambda item: item[1].seconds)
