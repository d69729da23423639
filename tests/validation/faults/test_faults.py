"""Faults: their list, how they are put in, and that the judge notices them and not their absence."""

from __future__ import annotations

from concurrent.futures import ProcessPoolExecutor
from dataclasses import replace
from pathlib import Path
from typing import cast

import pytest

from lapjoint.cli.main import main
from lapjoint.machine.processes import end_pool
from validation.faults.catalogue import CONTROL, FAULTS
from validation.faults.changed_tree import change, changed_names, installed_tree, source_of
from validation.faults.fault import PLACES, Fault
from validation.faults.record import PAGE, page, recorded
from validation.faults.running import Changed, Kept, Order, Trials, case_digests, plain
from validation.faults.trial import Result, Seen, _Here

TREE = installed_tree()
ROOT = Path(__file__).resolve().parents[3]


@pytest.mark.parametrize("fault", [*FAULTS, CONTROL], ids=lambda fault: fault.name)
def test_a_fault_fits_the_source_once_and_leaves_it_valid(fault: Fault) -> None:
    compile(fault.put_into(source_of(TREE, fault.module)), fault.module, "exec")


def test_there_are_faults_of_many_kinds_in_both_solvers_and_the_ground() -> None:
    names = [fault.name for fault in FAULTS]
    assert len(names) == len(set(names)) >= 40
    for place in PLACES.values():
        assert sum(fault.place == place for fault in FAULTS) >= 12
    kinds = {fault.kind for fault in FAULTS}
    assert {"a sign", "a factor", "a term dropped", "an input ignored", "off by one", "a mode skipped"} <= kinds
    assert {"a stale cache", "an event dropped", "counted twice", "a gap read wrong"} <= kinds
    assert {"a certificate too lenient", "an error estimate too small"} <= kinds


@pytest.mark.parametrize("source", ["", "x = 1\nx = 1\n"])
def test_a_fault_whose_text_is_not_there_once_is_refused(source: str) -> None:
    with pytest.raises(ValueError, match="must once"):
        Fault("some", "a sign", "analytic.solver", "", old="x = 1", new="x = -1").put_into(source)


def test_the_record_fits_the_list_and_the_page_fits_the_record() -> None:
    judged, costs = recorded()
    assert [one.fault for one in judged] == [*FAULTS, CONTROL]
    assert all(one.as_wanted for one in judged), [one.fault.name for one in judged if not one.as_wanted]
    assert (ROOT / "docs" / PAGE).read_text() == page(judged, costs)


def _quickest(count: int) -> tuple[list[Fault], list[str]]:
    caught = sorted(recorded()[0], key=lambda one: (one.fault == CONTROL, one.seen.seconds))[:count]
    return [one.fault for one in caught], sorted({one.seen.case for one in caught})


@pytest.mark.thorough
def test_the_quickest_faults_change_verdicts_and_their_absence_does_not() -> None:
    faults, cases = _quickest(2)
    sound = source_of(TREE, CONTROL.module)
    changes = [Changed(fault.name, fault.module, fault.put_into(source_of(TREE, fault.module))) for fault in faults]
    changes.append(Changed("control", CONTROL.module, CONTROL.put_into(sound)))
    changes.append(Changed("crash", CONTROL.module, sound + "\nraise RuntimeError('on purpose')\n"))
    trials = Trials(TREE, "quick", 2, Kept(None))
    seen = {changed.label: seen for changed, seen in trials.judged(changes, Order(dict.fromkeys(cases, 5.0)))}
    assert all(seen[fault.name].result is Result.CAUGHT and seen[fault.name].number for fault in faults)
    assert seen["control"].result is Result.MISSED
    assert seen["crash"].result is Result.CRASHED
    assert "on purpose" in seen["crash"].item


CASES = {"table4": "a digest", "textbook": "of each", "grazing": "case's source"}


def _some(*names: str) -> dict[str, str]:
    return {name: CASES[name] for name in names}


def test_the_sound_packages_are_always_run_for_what_they_compile_goes_with_their_copies(tmp_path: Path) -> None:
    path = tmp_path / "kept"
    done: list[str] = []
    for _ in range(2):
        trials = Trials(TREE, "quick", 1, Kept(path))
        seen = trials.costs(["table4"], lambda case, _: done.append(case))
        assert seen["table4"].seconds > 0
        assert [case for case, _ in seen["table4"].spent] == ["table4"]
    assert done == ["table4", "table4"]
    assert not path.exists()


def test_a_trial_that_was_done_is_not_run_again_and_a_torn_line_is(tmp_path: Path) -> None:
    path, seen = tmp_path / "kept", Seen(Result.CAUGHT, "textbook", "a", "1", "2", 0.5, (("textbook", 0.5),))
    Kept(path).put("one", seen, CASES)
    Kept(path).put("two", seen, CASES)
    whole = path.read_text()
    path.write_text(whole[: len(whole) - 20])
    assert Kept(path).get("one", _some("table4", "textbook")) == seen
    assert Kept(path).get("one", _some("table4")) is None
    assert Kept(path).get("two", _some("textbook")) is None


def test_a_trial_that_nothing_caught_is_run_again_if_there_are_more_cases() -> None:
    kept = Kept(None)
    missed = kept.put("one", Seen(Result.MISSED, seconds=2.0, spent=(("table4", 1.0), ("textbook", 1.0))), CASES)
    assert kept.get("one", _some("textbook")) == missed
    assert kept.get("one", _some("textbook", "grazing")) is None


def test_what_a_case_saw_counts_as_long_as_its_source_is_the_same() -> None:
    kept = Kept(None)
    kept.put("one", Seen(Result.MISSED, seconds=2.0, spent=(("table4", 1.0), ("textbook", 1.0))), CASES)
    kept.put("two", Seen(Result.CAUGHT, "textbook", "a", "1", "2", 2.0, (("table4", 1.0), ("textbook", 1.0))), CASES)
    changed = {**CASES, "textbook": "another"}
    for key in ("one", "two"):
        assert kept.get(key, changed) is None
        assert kept.passed(key, changed).spent == (("table4", 1.0),)


def test_the_cheapest_case_runs_first_but_for_one_that_is_named() -> None:
    order = Order({"table4": 0.5, "textbook": 2.0, "grazing": 1.0})
    assert [case for case, _ in order.limits(False)] == ["table4", "grazing", "textbook"]
    named = replace(order, first="textbook").limits(False)
    assert [case for case, _ in named] == ["textbook", "table4", "grazing"]
    assert sorted(named) == sorted(order.limits(False))


def test_a_case_is_known_by_its_source_and_that_of_the_cases_that_it_imports(tmp_path: Path) -> None:
    cases = tmp_path / "validation/cases"
    cases.mkdir(parents=True)
    (cases / "one.py").write_text("from validation.cases.two import f\n")
    (cases / "two.py").write_text("f = 1\n")
    (cases / "three.py").write_text("")
    before = case_digests(tmp_path)
    (cases / "two.py").write_text("f = 2\n")
    after = case_digests(tmp_path)
    assert {case for case in before if before[case] != after[case]} == {"one", "two"}


def test_a_pool_that_does_everything_in_one_process_ends_as_one_of_processes_does() -> None:
    pool = _Here(2)
    assert pool.submit(max, 1, 2).result() == 2
    end_pool(cast(ProcessPoolExecutor, pool))


def test_what_was_seen_survives_json() -> None:
    assert plain(Seen(Result.TOO_SLOW, "grazing"))["result"] == "too slow"


def test_whether_a_change_goes_into_anything_compiled_is_known(tmp_path: Path) -> None:
    for package in ("lapjoint", "analytic", "fe_lapjoint", "validation"):
        (tmp_path / package).mkdir()
    (tmp_path / "analytic/low.py").write_text("LIMIT, OTHER = 1.0, 2.0\nTWICE = 2 * LIMIT\nUNUSED = 1.0\n")
    (tmp_path / "analytic/high.py").write_text("@njit\ndef high(x):\n    return x + TWICE\n")
    assert change(tmp_path, "analytic.low", "LIMIT, OTHER = 2.0, 2.0\nTWICE = 2 * LIMIT\nUNUSED = 1.0\n")
    assert not change(tmp_path, "analytic.low", "LIMIT, OTHER = 2.0, 2.0\nTWICE = 2 * LIMIT\nUNUSED = 3.0\n")


def test_a_change_is_known_by_the_name_at_the_top_of_the_module() -> None:
    old = "A = 1\nB = A\n\ndef f():\n    return A\n"
    assert changed_names(old, old.replace("return A", "return B")) == {"f"}
    assert changed_names(old, old.replace("A = 1", "A = 2")) == {"A"}
    assert changed_names(old, old + "\n# nothing\n") == set()


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--fault", "no-such"], "fault = 'no-such' is unknown"),
        (["--faults", "--quick"], "no level"),
        (["--faults", "preset:paper"], "no problem"),
        (["--faults", "--case", "no-such"], "case = 'no-such' is unknown"),
    ],
)
def test_a_wrong_command_is_refused(
    arguments: list[str], message: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(SystemExit) as refused:
        main(["validate", *arguments, "-o", str(tmp_path)])
    assert refused.value.code == 2
    assert message in capsys.readouterr().err
