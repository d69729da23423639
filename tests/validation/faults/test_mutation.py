"""Mutants: drawn by seed, valid, and only where something is computed."""

from __future__ import annotations

from validation.faults.changed_tree import installed_tree, source_of
from validation.faults.mutants import reasons, recorded_run
from validation.faults.mutation import KINDS, LEFT_OUT, drawn, everywhere, modules, possible

TREE = installed_tree()
SOURCE = '''
def f(x: tuple[int, int], n):
    """x - 1"""
    if n < 0:
        raise ValueError(f"{n + 1} - 2")
    return -x[0] + 2 * n
'''


def test_the_same_seed_draws_the_same_mutants_however_many() -> None:
    many = drawn(TREE, 3, 60)
    assert drawn(TREE, 3, 20) == many[:20]
    assert drawn(TREE, 4, 20) != many[:20]
    assert {mutant.kind for mutant in many} == set(KINDS)
    assert {mutant.module.partition(".")[0] for mutant in many} == {"analytic", "fe_lapjoint", "lapjoint"}


def test_each_change_has_a_name_of_its_own() -> None:
    names = [mutant.identity for mutant in everywhere(TREE)]
    assert len(set(names)) == len(names)


def test_those_drawn_before_come_first_as_long_as_they_fit() -> None:
    before = [mutant.identity for mutant in drawn(TREE, 3, 20)]
    again = [mutant.identity for mutant in drawn(TREE, 4, 30, ["gone.f: x -> (y)", *before])]
    assert again[:20] == before
    assert len(set(again)) == 30


def test_every_mutant_of_a_draw_is_valid_source_and_another_one() -> None:
    for mutant in drawn(TREE, 5, 30):
        sound = source_of(TREE, mutant.module)
        changed = mutant.put_into(sound)
        compile(changed, mutant.module, "exec")
        assert changed != sound


def test_texts_annotations_and_errors_are_left_alone() -> None:
    found = {(mutant.kind, mutant.old, mutant.new) for mutant in possible("m", SOURCE)}
    assert found == {
        ("off by one", "n < 0", "(n <= 0)"),
        ("sign", "-x[0] + 2 * n", "(-x[0] - (2 * n))"),
        ("dropped term", "-x[0] + 2 * n", "(-x[0])"),
        ("dropped term", "-x[0] + 2 * n", "(2 * n)"),
        ("sign", "-x[0]", "(x[0])"),
        ("off by one", "0", "(0 + 1)"),
        ("factor 1.001", "2 * n", "(1.001 * (2 * n))"),
    }


def test_nothing_that_draws_or_speaks_is_changed() -> None:
    names = modules(TREE)
    assert "analytic.march.segment" in names
    assert not any("figures" in name or "messages" in name or "cli" in name for name in names)


def test_every_reason_belongs_to_a_mutant_of_the_record_or_to_one_that_can_be_drawn() -> None:
    recorded = {outcome.mutant.identity for outcome in recorded_run().outcomes}
    assert set(reasons()) <= recorded | {mutant.identity for mutant in everywhere(TREE)}


def test_each_module_that_is_left_out_is_there() -> None:
    assert [name for name in LEFT_OUT if not (TREE / f"{name}.py").exists()] == []
