"""Each campaign gives the same dataset whoever works and however often it is interrupted, and its file says whose it
is."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

import pytest
import xarray as xr
from small_joints import HIGH, LOW, SHAKEN, TOUCHING
from toy import bar

from lapjoint import FREQUENCY, Axis, InputError, basins, branch, confirm, paper_joint, statistics, sweep
from lapjoint.campaigns.basins.spec import CHUNK
from lapjoint.campaigns.dataset import read_result
from lapjoint.campaigns.journal import journal_path
from lapjoint.errors import Interrupted

FEW = {"n_modes": 2}


class Campaign(NamedTuple):
    """A campaign that takes some seconds at most."""

    function: Callable[..., xr.Dataset]
    given: dict[str, Any]
    other: dict[str, Any]
    """Arguments that make it another campaign of its kind."""
    noun: str
    interrupted_at: int
    """Number of cells after which it is interrupted."""
    kept: str
    """What is said of the journal then."""

    def __call__(self, **more: Any) -> xr.Dataset:
        return self.function(**(self.given | more))


CAMPAIGNS = {
    "sweep": Campaign(
        sweep,
        {
            "problem": paper_joint(),
            "axes": [Axis(FREQUENCY, range(500, 560, 10)), Axis("stops.*.gap", [1e-3, 2e-3])],
            "options": {"n_modes": 4},
        },
        {"seed": 1},
        "sweep",
        5,
        "5 of 12 points are",
    ),
    "basins": Campaign(
        basins,
        {
            "problem": bar(0.55, (0.4, 20.0), (-0.4, 20.0), ratio=0.05),
            "energy": 20.0,
            "starts": 2 * CHUNK + 9,
            "options": FEW,
        },
        {"starts": 4},
        "search for basins",
        2,
        "2 of 4 chunks of starts are",
    ),
    "branches": Campaign(
        branch,
        {
            "problem": TOUCHING,
            "path": "base_motion.amplitude",
            "first": LOW,
            "last": HIGH,
            "options": FEW,
            "errors": False,
            "also_over": Axis("stops.*.gap", (1.05e-3, 1e-3, 0.95e-3)),
        },
        {"seed": 1},
        "search for branches",
        5,
        "5 parts of the work are",
    ),
    "confirmation": Campaign(
        confirm, {"options": {"elements": 4}}, {"share": 0.3}, "confirmation", 1, "1 of 3 bifurcations are"
    ),
    "statistics": Campaign(
        statistics,
        {"problem": SHAKEN, "seeds": 4, "duration": 1.5, "options": FEW},
        {"seeds": 3},
        "run of statistics",
        2,
        "2 of 4 realisations are",
    ),
}


class Finished(NamedTuple):
    """A campaign that one process has finished."""

    campaign: Campaign
    dataset: xr.Dataset
    out: Path


@pytest.fixture(scope="module", params=CAMPAIGNS)
def finished(
    request: pytest.FixtureRequest, branches: xr.Dataset, tmp_path_factory: pytest.TempPathFactory
) -> Finished:
    """Each campaign, finished; the file stays as it is."""
    campaign, out = CAMPAIGNS[request.param], tmp_path_factory.mktemp("finished") / "whole.nc"
    if campaign.function is confirm:
        campaign = campaign._replace(given={**campaign.given, "branches": branches})
    return Finished(campaign, campaign(out=out), out)


def reversed_map(function: Callable[[Any], Any], batches: Any) -> list[Any]:
    return [function(batch) for batch in reversed(list(batches))]


@pytest.mark.parametrize("workers", [reversed_map, pytest.param(2, marks=pytest.mark.thorough)])
def test_all_workers_find_what_one_process_finds(finished: Finished, workers: Any, tmp_path: Path) -> None:
    out = tmp_path / "other.nc"
    xr.testing.assert_identical(finished.campaign(workers=workers, out=out), finished.dataset)
    assert out.read_bytes() == finished.out.read_bytes()
    assert [path.name for path in tmp_path.iterdir()] == [out.name]


def test_interrupted_it_resumes_to_the_same_bytes(
    finished: Finished, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    campaign, out, shown = finished.campaign, tmp_path / "resumed.nc", list[tuple[float, float]]()
    monkeypatch.setattr("lapjoint.campaigns.batch.BATCH_SECONDS", 0.0)

    def interrupt(done: float, total: float) -> None:
        if done >= campaign.interrupted_at:
            raise KeyboardInterrupt

    with pytest.raises(Interrupted) as error:
        campaign(out=out, progress=interrupt)
    assert str(error.value) == f"interrupted: {campaign.kept} kept in {journal_path(out)}; the same command resumes"
    assert not out.exists()
    with pytest.raises(InputError, match=f"holds another {campaign.noun}, not finished"):
        campaign(out=out, **campaign.other)
    again = campaign(out=out, progress=lambda *now: shown.append(now))
    assert shown[0][0] == campaign.interrupted_at  # what is done is not done again
    assert all(done <= known for done, known in shown)
    whole = [done for done, _ in shown if done == int(done)]
    assert whole == sorted(whole)
    xr.testing.assert_identical(again, finished.dataset)
    assert out.read_bytes() == finished.out.read_bytes()
    assert not journal_path(out).exists()


def test_a_finished_file_is_read_and_that_of_another_is_refused(finished: Finished) -> None:
    campaign, out, shown = finished.campaign, finished.out, list[float]()
    xr.testing.assert_equal(campaign(out=out, progress=lambda done, _: shown.append(done)), finished.dataset)
    xr.testing.assert_equal(read_result(out, campaign.noun), finished.dataset)
    assert not shown
    with pytest.raises(InputError, match=f"is the result of another {campaign.noun}; choose"):
        campaign(out=out, **campaign.other)
    stranger = next(other.noun for other in CAMPAIGNS.values() if other.noun != campaign.noun)
    with pytest.raises(InputError, match=f"is not the result of a {stranger}"):
        read_result(out, stranger)


def test_another_finished_campaign_is_thrown_away_if_told(finished: Finished, tmp_path: Path) -> None:
    out = tmp_path / "other.nc"
    out.write_bytes(finished.out.read_bytes())
    other = finished.campaign(out=out, force=True, **finished.campaign.other)
    assert other.attrs["fingerprint"] != finished.dataset.attrs["fingerprint"]
    xr.testing.assert_equal(read_result(out, finished.campaign.noun), other)


def test_a_campaign_keeps_its_name_when_all_of_its_package_is_imported() -> None:
    """In a process of its own: a package of the same name takes the name when it is first imported."""
    packages = ("sweep", "basins", "branches", "confirm", "statistics")
    code = "\n".join(
        [
            "import lapjoint.campaigns",
            *(f"import lapjoint.campaigns.{name}.job" for name in packages),
            "from lapjoint import basins, branch, confirm, statistics, sweep",
            "assert all(map(callable, (basins, branch, confirm, statistics, sweep)))",
        ]
    )
    subprocess.run([sys.executable, "-c", code], check=True, timeout=60)


@pytest.mark.thorough
def test_true_shows_the_progress_of_every_campaign(
    finished: Finished, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr("lapjoint.cli.progress.EARLY", 0.0)
    xr.testing.assert_identical(finished.campaign(progress=True), finished.dataset)
    assert f"{finished.campaign.noun}: " in capsys.readouterr().err
    finished.campaign(progress=False)
    assert not capsys.readouterr().err


def test_basins_tell_how_many_starts_of_a_chunk_have_ended() -> None:
    shown = list[tuple[float, float]]()
    basins(**CAMPAIGNS["basins"].given | {"starts": 4}, progress=lambda *now: shown.append(now))
    done = [one for one, _ in shown]
    assert done == sorted(done)
    assert any(one % 1 for one in done)
    assert (done[0], {all_ for _, all_ in shown}) == (0, {2})
