"""Faults: their list, how they are put in, and that the judge notices them and not their absence."""

from __future__ import annotations

import ast
from concurrent.futures import ProcessPoolExecutor
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import cast

import pytest

from lapjoint.cli.main import main
from lapjoint.machine.processes import end_pool
from validation.faults.catalogue import CONTROL, FAULTS
from validation.faults.changed_tree import Changed, change, changed_names, installed_tree, source_of
from validation.faults.fault import PLACES, Fault
from validation.faults.record import PAGE, page, recorded
from validation.faults.running import Order, TrialJournal, Trials, case_digests, plain
from validation.faults.trial import Result, Seen, _Here

TREE = installed_tree()
ROOT = Path(__file__).resolve().parents[3]


@pytest.mark.parametrize("fault", [*FAULTS, CONTROL], ids=lambda fault: fault.name)
def test_a_fault_fits_the_source_once_and_leaves_it_valid(fault: Fault) -> None:
    changed = fault.put_into(TREE)
    compile(changed.source, changed.module, "exec")
    assert changed_names(source_of(TREE, changed.module), changed.source)


@cache
def _laid_out_otherwise(source: str) -> str:
    """A source without comments, in other lines, and with docstrings that say something else."""
    tree = ast.parse(source)
    for node in ast.walk(tree):
        if isinstance(node, ast.FunctionDef) and ast.get_docstring(node) is not None:
            node.body[0] = ast.Expr(ast.Constant("Otherwise."))
    return ast.unparse(tree)


@pytest.mark.parametrize(
    "fault",
    [fault if i % 10 == 0 else pytest.param(fault, marks=pytest.mark.thorough) for i, fault in enumerate(FAULTS)],
    ids=lambda fault: fault.name,
)
def test_a_fault_is_the_same_in_another_file_and_in_other_lines(fault: Fault, tmp_path: Path) -> None:
    changed = fault.put_into(TREE)
    package = changed.module.partition(".")[0]
    (tmp_path / package / "elsewhere").mkdir(parents=True)
    (tmp_path / package / "elsewhere/moved.py").write_text(_laid_out_otherwise(source_of(TREE, changed.module)))
    moved = fault.put_into(tmp_path)
    assert moved.module == f"{package}.elsewhere.moved"
    assert ast.dump(ast.parse(moved.source)) == ast.dump(ast.parse(_laid_out_otherwise(changed.source)))


def test_there_are_faults_of_many_kinds_in_both_solvers_and_the_ground() -> None:
    names = [fault.name for fault in FAULTS]
    assert len(names) == len(set(names)) >= 40
    for place in PLACES.values():
        assert sum(fault.place == place for fault in FAULTS) >= 12
    kinds = {fault.kind for fault in FAULTS}
    assert {"a sign", "a factor", "a term dropped", "an input ignored", "off by one", "a mode skipped"} <= kinds
    assert {"a stale cache", "an event dropped", "counted twice", "a gap read wrong"} <= kinds
    assert {"a certificate too lenient", "an error estimate too small"} <= kinds


def _put_into(tree: Path, source: str, old: str = "x + 2 * y", new: str = "x - 2 * y", file: str = "march/a") -> str:
    """The source of `Beam.load` of a package with a fault in it."""
    path = tree / f"analytic/{file}.py"
    path.parent.mkdir(parents=True)
    path.write_text(source)
    changed = Fault("some", "a sign", "analytic:Beam.load", "", old, new).put_into(tree)
    assert changed.module == f"analytic.{file.replace('/', '.')}"
    return changed.source


METHOD = "class Beam:\n    def load(self, x, y):\n        {}\n"


@pytest.mark.parametrize(
    ("body", "changed"),
    [
        ("return f(x + 2 * y)", "return f((x - 2 * y))"),
        ('"""Says x + 2 * y."""\n        return (  # x + 2 * y\n            x + 2*y)', "x - 2 * y)"),
        ("if x + 2 * y > 0:\n            return 'ä' + g()", "if (x - 2 * y) > 0:\n            return 'ä' + g()"),
    ],
)
@pytest.mark.parametrize("file", ["march/a", "modes/other/b"])
def test_a_fault_fits_whatever_the_layout_the_docstring_and_the_file(
    body: str, changed: str, file: str, tmp_path: Path
) -> None:
    before = "def other(x, y):\n    return x + 2 * y\n\n"
    source = _put_into(tmp_path, before + METHOD.format(body), file=file)
    assert source.startswith(before)
    assert changed in source
    compile(source, "some", "exec")


@pytest.mark.parametrize(
    ("body", "old", "new", "changed"),
    [
        ("return g(x) / h(y, z=1)", "... / h(...)", "2 * ... / h(...)", "return (2 * g(x) / h(y, z=1))"),
        ("return [a, x, y, b]", "[..., x, y, ...]", "[..., y, x, ...]", "return ([a, y, x, b])"),
        ("return x[y]", "x[...]", "x[...] + x[...]", "return (x[y] + x[y])"),
        ("x = 1; return x", "x = 1", "x = 1\nx = 2", "        x = 1\n        x = 2; return x"),
        (
            "if x:\n            y()\n            z()",
            "if x:\n    ...",
            "if not x:\n    ...",
            "if not x:\n            y()\n    ",
        ),
        (
            "if x:\n            y()\n        elif y:\n            z()",
            "if y:\n    ...",
            "if not y:\n    ...",
            "y()\n        else:\n            if not y:\n                z()",
        ),
        ("return g()", "g(...)", "g(...) + g(...)", "return (g() + g())"),
    ],
)
def test_three_dots_stand_for_anything_and_statements_keep_their_indentation(
    body: str, old: str, new: str, changed: str, tmp_path: Path
) -> None:
    source = _put_into(tmp_path, METHOD.format(body), old, new)
    assert changed in source
    compile(source, "some", "exec")


@pytest.mark.parametrize(
    ("source", "message"),
    [
        (METHOD.format("return y"), "fault some: `x \\+ 2 \\* y` stands 0 times in `Beam.load` of analytic.march.a"),
        (METHOD.format("return x + 2 * y, x + 2 * y"), "stands 2 times"),
        ("def load(x, y):\n    return x + 2 * y\n", "analytic defines no `Beam.load`"),
    ],
)
def test_a_fault_that_fits_not_once_names_itself_and_where_it_looked(source: str, message: str, tmp_path: Path) -> None:
    with pytest.raises(ValueError, match=message):
        _put_into(tmp_path, source)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("[..., x, ...]", "[..., y, ...]", "stands 2 times"),
        ("[..., y, ...]", "[..., y, ..., ...]", "fault some: `new` has more than the 2 `...` of `old`"),
    ],
)
def test_three_dots_must_fit_in_one_way_and_stand_for_something(
    old: str, new: str, message: str, tmp_path: Path
) -> None:
    with pytest.raises(ValueError, match=message):
        _put_into(tmp_path, METHOD.format("return [x, y, x]"), old, new)


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
    control = CONTROL.put_into(TREE)
    crash = Changed("crash", control.module, control.source + "\nraise RuntimeError('on purpose')\n")
    changes = [*(fault.put_into(TREE) for fault in faults), control, crash]
    trials = Trials(TREE, "quick", 2, TrialJournal(None))
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
        trials = Trials(TREE, "quick", 1, TrialJournal(path))
        seen = trials.costs(["table4"], lambda case, _: done.append(case))
        assert seen["table4"].seconds > 0
        assert [case for case, _ in seen["table4"].spent] == ["table4"]
    assert done == ["table4", "table4"]
    assert not path.exists()


def test_a_trial_that_was_done_is_not_run_again_and_a_torn_line_is(tmp_path: Path) -> None:
    path, seen = tmp_path / "kept", Seen(Result.CAUGHT, "textbook", "a", "1", "2", 0.5, (("textbook", 0.5),))
    TrialJournal(path).put("one", seen, CASES)
    TrialJournal(path).put("two", seen, CASES)
    whole = path.read_text()
    path.write_text(whole[: len(whole) - 20])
    assert TrialJournal(path).get("one", _some("table4", "textbook")) == seen
    assert TrialJournal(path).get("one", _some("table4")) is None
    assert TrialJournal(path).get("two", _some("textbook")) is None


def test_a_trial_that_nothing_caught_is_run_again_if_there_are_more_cases() -> None:
    kept = TrialJournal(None)
    missed = kept.put("one", Seen(Result.MISSED, seconds=2.0, spent=(("table4", 1.0), ("textbook", 1.0))), CASES)
    assert kept.get("one", _some("textbook")) == missed
    assert kept.get("one", _some("textbook", "grazing")) is None


def test_what_a_case_saw_counts_as_long_as_its_source_is_the_same() -> None:
    kept = TrialJournal(None)
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
