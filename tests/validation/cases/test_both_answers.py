"""Which numbers of both solvers' tables are compared."""

from __future__ import annotations

from lapjoint.summaries.blocks import Block, Number, Row
from validation.cases.both_answers import How, checks_of


def block(largest_at: str, rms: float) -> Block:
    """Peak and RMS of an acceleration at a chosen place, and where the peak is largest."""
    place = Row("0.5 m", (Number(1.0, 0.1), Number(0.6, 0.01)), "acceleration [m/s2]")
    largest = Row(largest_at, (Number(2.0, 0.1), Number(rms, 0.01)), "acceleration [m/s2]", largest=True, asked=False)
    return Block("Largest magnitude, and RMS", ("peak", "RMS"), (place, largest))


def compared(*blocks: Block) -> list[str]:
    """What is compared of the blocks of two solvers, each with how both agree."""
    solvers = {f"solver {i}": [one] for i, one in enumerate(blocks)}
    checks, _ = checks_of(solvers, [How(name, "refinement") for name in solvers])
    return [f"{check.name}: {check.verdict.value}" for check in checks]


def test_where_solvers_have_the_largest_value_at_two_places_they_are_compared_by_that_value_alone() -> None:
    chosen = [f"acceleration, at 0.5 m, {name}: agree" for name in ("peak", "RMS")]
    assert compared(block("1 m", 0.9), block("1 m", 1.2)) == [
        *chosen,
        "acceleration, largest, at 1 m, peak: agree",
        "acceleration, largest, at 1 m, RMS: disagree",
    ]
    assert compared(block("1 m", 0.9), block("0.9 m", 1.2)) == [
        *chosen,
        "acceleration, largest, at 1 m and 0.9 m, peak: agree",
    ]
