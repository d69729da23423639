"""Faults of the tools around the solvers: records, campaigns, command line, series, export and report.

`validation.faults` judges faults of the physics by the cases of `lapjoint validate`.  A fault of a tool changes no
comparison, so each one here names the test that must fail with it.
"""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import NamedTuple

import pytest

from validation.faults.changed_tree import change, changed_names, copied_tree, source_of
from validation.faults.fault import Fault

ROOT = Path(__file__).parents[3]


class Watched(NamedTuple):
    """A fault, and the test that must fail with it."""

    fault: Fault
    test: str


FAULTS = (
    Watched(
        Fault(
            "record-stamps",
            "an input ignored",
            "lapjoint:Record.time",
            "Time stamps of a record are replaced by even spacing.",
            "(self.times.array - self.times.array[0]) * TIME_UNITS[self.time_unit]",
            "np.linspace(0.0, np.ptp(self.times.array), len(self.times)) * TIME_UNITS[self.time_unit]",
        ),
        "tests/lapjoint/problem/test_records.py::test_samples_lie_at_their_own_time_stamps",
    ),
    Watched(
        Fault(
            "record-time-unit",
            "a factor",
            "lapjoint:Record.time",
            "Times of a record are in seconds, whatever its time_unit.",
            "(self.times.array - self.times.array[0]) * TIME_UNITS[self.time_unit]",
            "(self.times.array - self.times.array[0]) * 1.0",
        ),
        "tests/lapjoint/problem/test_records.py::test_samples_lie_at_their_own_time_stamps",
    ),
    Watched(
        Fault(
            "record-digest-without-times",
            "an input ignored",
            "lapjoint:_digest",
            "Two records that differ in their time stamps alone count as one.",
            "return values.digest if times is None else Samples(np.concatenate([values.array, times.array])).digest",
            "return values.digest",
        ),
        "tests/lapjoint/problem/test_records.py::test_a_file_that_changed_since_it_was_named_with_its_digest_is_told",
    ),
    Watched(
        Fault(
            "journal-without-options",
            "an input ignored",
            "lapjoint:Plan.identity",
            "A journal begun with other numerical options of the solver is gone on with.",
            "dict(self.options)",
            "{}",
        ),
        "tests/lapjoint/campaigns/sweep/test_spec.py::test_work_with_other_options_of_the_solver_is_other_work",
    ),
    Watched(
        Fault(
            "journal-checksum",
            "a check dropped",
            "lapjoint:_opened",
            "A line of a journal is taken whatever its checksum.",
            "return json.loads(body) if _checksum(body, owner) == end[1] else None",
            "return json.loads(body)",
        ),
        "tests/lapjoint/campaigns/test_journal.py::test_another_sweep_is_thrown_away_only_when_told",
    ),
    Watched(
        Fault(
            "journal-forgets",
            "an event dropped",
            "lapjoint:Journal._taken",
            "What a journal holds is not taken when the work is resumed.",
            ("return line is not None"),
            ("return False"),
        ),
        "tests/lapjoint/campaigns/test_journal.py::test_what_it_keeps_comes_back_exactly",
    ),
    Watched(
        Fault(
            "grid-axes-swapped",
            "off by one",
            "lapjoint:Grid.values_at",
            "The first axis of a grid runs fastest, and its dataset has it as the slowest.",
            "places = np.unravel_index(point, self.shape)",
            'places = np.unravel_index(point, self.shape, order="F")',
        ),
        "tests/lapjoint/campaigns/test_grid.py::test_the_last_axis_runs_fastest_as_in_the_dataset",
    ),
    Watched(
        Fault(
            "sweep-in-hertz",
            "a factor",
            "lapjoint:frequencies",
            "Frequencies of a sweep that are given in Hz are taken for rad/s.",
            '("Hz", 2 * math.pi)',
            '("Hz", 1.0)',
        ),
        "tests/lapjoint/cli/test_arguments.py::test_frequencies_in_hz_become_angular_ones",
    ),
    Watched(
        Fault(
            "modes-in-hertz",
            "a factor",
            "lapjoint:print_modes",
            "Natural frequencies in Hz are printed in rad/s.",
            "values = answer.angular_frequencies / (2 * math.pi if hz else 1.0)",
            "values = answer.angular_frequencies",
        ),
        "tests/lapjoint/cli/test_commands.py::test_frequencies_in_hz_and_within_the_width_of_a_terminal",
    ),
    Watched(
        Fault(
            "sweep-last-point",
            "off by one",
            "lapjoint:frequencies",
            "The last frequency of a sweep is left out.",
            "int(steps) + 1",
            "int(steps)",
        ),
        "tests/lapjoint/cli/test_sweeps.py::test_sweep_writes_a_dataset_and_plot_draws_it",
    ),
    Watched(
        Fault(
            "sweep-status",
            "a check dropped",
            "lapjoint:sweep",
            "A sweep with failed points ends with the status of success.",
            "1 if bool((found.outcome == -1).any()) else 0",
            "0",
        ),
        "tests/lapjoint/cli/test_sweeps.py::test_a_sweep_with_points_that_failed_ends_with_status_1",
    ),
    Watched(
        Fault(
            "set-first-only",
            "off by one",
            "lapjoint:_indices",
            "--set with * changes the first element alone.",
            "return list(range(len(items)))",
            "return [0]",
        ),
        "tests/lapjoint/problem/test_override.py::test_values_are_set_by_number_by_name_and_all_at_once",
    ),
    Watched(
        Fault(
            "realisations-alike",
            "counted twice",
            "lapjoint:Realisations.realisation",
            "All realisations of a random excitation have the seed of the first.",
            "(own + number) % (LARGEST_SEED + 1)",
            "(own + 0 * number) % (LARGEST_SEED + 1)",
        ),
        "tests/lapjoint/campaigns/statistics/test_running.py"
        "::test_values_lie_within_their_intervals_and_differ_between_realisations",
    ),
    Watched(
        Fault(
            "series-late",
            "off by one",
            "lapjoint:time_series",
            "Time series are one sample late.",
            "np.arange(count) / rate",
            "np.arange(1, count + 1) / rate",
        ),
        "tests/lapjoint/answers/test_series.py::test_every_quantity_is_that_of_the_closed_form",
    ),
    Watched(
        Fault(
            "series-absolute",
            "a term dropped",
            "lapjoint:Quantity.of",
            "Absolute quantities lack the motion of the base.",
            "return values + np.outer(history.problem.structure.base_shares(x), history.base(t, self.dt))",
            "return values",
        ),
        "tests/lapjoint/answers/test_series.py::test_every_quantity_is_that_of_the_closed_form",
    ),
    Watched(
        Fault(
            "series-columns",
            "off by one",
            "lapjoint:_columns",
            "Columns of a CSV file of time series are named from the last place to the first.",
            "_headings(series)",
            "_headings(series.isel(x=slice(None, None, -1)))",
        ),
        "tests/lapjoint/answers/test_series.py::test_netcdf_and_csv_keep_every_digit",
    ),
    Watched(
        Fault(
            "contacts-columns",
            "off by one",
            "lapjoint:contact_rows",
            "In tables of contacts, impulses are peak forces.",
            ("float(c.impulse)"),
            ("float(c.peak_force)"),
        ),
        "tests/lapjoint/answers/test_contact_files.py::test_contacts_are_written_with_all_their_digits",
    ),
    Watched(
        Fault(
            "export-moment",
            "a factor",
            "lapjoint:Beam.values",
            "Files for ParaView hold the curvature in place of the bending moment.",
            'EI * beam["z_xx"][:, here]',
            'beam["z_xx"][:, here]',
        ),
        "tests/lapjoint/scene/test_export.py::test_the_axis_carries_the_history",
    ),
    Watched(
        Fault(
            "export-times",
            "off by one",
            "lapjoint:_write_pieces",
            "In a series for ParaView every file has the time of the first.",
            "_entry(float(time), place, label, file)",
            "_entry(float(block.times[0]), place, label, file)",
        ),
        "tests/lapjoint/scene/test_export.py::test_another_library_reads_back_every_value_of_both_solvers_side_by_side",
    ),
    Watched(
        Fault(
            "picture-scale",
            "a factor",
            "lapjoint:_moved",
            "Displacements in pictures are at true scale, whatever scale the note states.",
            "moved: FloatArray = part.points + scale * values.point[carried]",
            "moved: FloatArray = part.points + values.point[carried]",
        ),
        "tests/lapjoint/scene/test_pictures.py::test_the_scale_is_one_two_or_five_times_a_power_of_ten_and_stated",
    ),
    Watched(
        Fault(
            "report-verdict",
            "a certificate too lenient",
            "validation:check_record",
            "Each comparison in report.json agrees.",
            ("check.verdict.value"),
            ('"agrees"'),
        ),
        "tests/validation/test_comparison.py::test_table_4_comes_out_to_the_last_digit_and_its_misprint_is_named",
    ),
    Watched(
        Fault(
            "report-header",
            "off by one",
            "validation:Sheet.csv",
            "Tables of a report as CSV lack their first row.",
            "(self.columns, *self.rows)",
            "(self.columns, *self.rows[1:])",
        ),
        "tests/validation/report/test_report.py::test_every_table_has_its_files",
    ),
)


def outcomes(tree: Path, *tests: str) -> subprocess.CompletedProcess[str]:
    """Run tests of this checkout on the packages of a tree."""
    places = f"pythonpath={tree} {ROOT / 'tests' / 'helpers'}"
    options = ("-q", "-x", "-p", "no:cacheprovider", "-m", "", "-o", places)
    environment = {**os.environ, "PYTHONPATH": str(tree)}
    environment.pop("PYTEST_XDIST_WORKER", None)  # this run has no other worker to share what is compiled with
    return subprocess.run(
        [sys.executable, "-P", "-m", "pytest", *options, *dict.fromkeys(tests)],
        cwd=ROOT,
        env=environment,
        capture_output=True,
        text=True,
        check=False,
    )


@pytest.fixture(scope="module")
def tree(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A copy of the packages."""
    folder = tmp_path_factory.mktemp("tree")
    copied_tree(ROOT, folder)
    return folder


@contextmanager
def with_fault(tree: Path, fault: Fault) -> Iterator[None]:
    """The tree with a fault in it, and without it afterwards."""
    changed = fault.put_into(tree)
    sound = source_of(tree, changed.module)
    change(tree, changed.module, changed.source)
    try:
        yield
    finally:
        change(tree, changed.module, sound)


def test_each_fault_of_a_tool_fits_the_source_and_its_test_exists() -> None:
    assert len({watched.fault.name for watched in FAULTS}) == len(FAULTS)
    for fault, test in FAULTS:
        changed = fault.put_into(ROOT)
        assert changed_names(source_of(ROOT, changed.module), changed.source)
        file, name = test.split("::")
        assert f"def {name}(" in (ROOT / file).read_text()


@pytest.mark.thorough
def test_without_a_fault_no_named_test_fails(tree: Path) -> None:
    seen = outcomes(tree, *(watched.test for watched in FAULTS))
    assert seen.returncode == 0, seen.stdout


@pytest.mark.thorough
@pytest.mark.parametrize("watched", FAULTS, ids=lambda watched: watched.fault.name)
def test_each_fault_of_a_tool_fails_its_named_test(watched: Watched, tree: Path) -> None:
    with with_fault(tree, watched.fault):
        seen = outcomes(tree, watched.test)
    assert seen.returncode == 1, seen.stdout
    assert "1 failed" in seen.stdout, seen.stdout
    assert "error" not in seen.stdout.splitlines()[-1], seen.stdout
