"""Every reference has one address, and what separate code computes comes back from it."""

from __future__ import annotations

from importlib import import_module

import pytest

from validation.references import dropped_cantilever
from validation.references.reading import group, group_names, printed, sources
from validation.verdict import Kind


@pytest.mark.parametrize("key", sources())
def test_every_source_says_who_what_which_where_and_how_it_was_read(key: str) -> None:
    source = sources()[key]
    assert all((source.author, source.title, source.edition, source.address, source.read))
    assert source.kind in (Kind.PUBLISHED, Kind.OTHER_CODE)
    assert (source.kind is Kind.OTHER_CODE) == bool(source.made_by)
    if source.made_by:
        assert callable(import_module(source.made_by).main)


def test_every_source_is_used_and_no_address_is_given_twice() -> None:
    used = {value.source.line for name in group_names() for row in group(name).values() for value in row}
    assert used == {source.line for source in sources().values()}
    addresses = [source.address for source in sources().values()]
    assert len(set(addresses)) == len(addresses)


@pytest.mark.parametrize(("text", "half"), [("41.5", 0.05), ("734.92", 0.005), ("1e-3", 5e-4), ("6.15e5", 5e2)])
def test_a_printed_number_stands_for_half_a_unit_of_its_last_digit(text: str, half: float) -> None:
    like = printed("paper joint", "length")
    assert type(like)(text, "1", "", like.source).half_unit == pytest.approx(half)


def test_the_program_gives_the_digits_that_are_kept_of_the_benchmark() -> None:
    coarse, fine = dropped_cantilever.answers(60), dropped_cantilever.answers(120)
    for name in dropped_cantilever.QUANTITIES:
        kept = printed("sdnl104 answers", name)
        assert abs(fine[name] - kept.value) <= kept.half_unit
        assert abs(fine[name] - coarse[name]) <= kept.half_unit


def test_the_program_prints_what_it_computes(capsys: pytest.CaptureFixture[str]) -> None:
    dropped_cantilever.main()
    lines = capsys.readouterr().out.splitlines()
    assert [line.split()[0] for line in lines] == list(dropped_cantilever.QUANTITIES)
