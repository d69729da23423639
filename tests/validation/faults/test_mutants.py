"""The run over mutants: what its page tells, and which source it names."""

from __future__ import annotations

import subprocess
from pathlib import Path

import pytest

from validation.faults import mutants
from validation.faults.mutants import Outcome, Run, commit_of, main
from validation.faults.trial import Result, Seen

ROOT = Path(__file__).resolve().parents[3]
FIRST, SECOND = (outcome.mutant for outcome in mutants.recorded_run().outcomes[:2])


def _run() -> Run:
    caught = Outcome(FIRST, Seen(Result.CAUGHT, "one_mode", "peak", "2 N", "1 N"), "", "1234567", "89abcde")
    return Run(5, (caught, Outcome(SECOND, Seen(Result.MISSED), "because", "89abcde", "89abcde")))


def test_the_page_names_the_commits_and_gives_the_reason_of_what_survived() -> None:
    text = " ".join(_run().page.split())
    assert (
        "seed 5 drew 1 from the source of commit 1234567, 1 from the source of commit 89abcde. "
        "Judged were 2 in the source of commit 89abcde: 1 caught, 1 equivalent."
    ) in text
    assert "| caught | one-mode: peak | 2 N | 1 N |" in text
    assert "| equivalent | because |" in text


def test_what_is_written_is_read_again_and_what_lost_its_reason_survives(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(mutants, "record_path", lambda: tmp_path / "mutants.json")
    monkeypatch.setattr(mutants, "reasons", lambda: {SECOND.identity: "because"})
    assert mutants.recorded_run().outcomes == ()
    (tmp_path / "mutants.json").write_text(_run().text)
    assert mutants.recorded_run() == _run()
    assert mutants.recorded_run().survivors == []
    monkeypatch.setattr(mutants, "reasons", dict)
    assert mutants.recorded_run().survivors == [SECOND.identity]


def _git(folder: Path, *arguments: str) -> str:
    who = ("-c", "user.name=Some", "-c", "user.email=some@example.org", "-c", "commit.gpgsign=false")
    return subprocess.run(("git", *who, *arguments), cwd=folder, check=True, capture_output=True, text=True).stdout


def test_source_is_that_of_a_commit_until_it_changes(tmp_path: Path) -> None:
    _git(tmp_path, "init")
    (tmp_path / "analytic").mkdir()
    (tmp_path / "analytic/a.py").write_text("a = 1\n")
    _git(tmp_path, "add", ".")
    _git(tmp_path, "commit", "-m", "one")
    (tmp_path / "notes.py").write_text("b = 1\n")
    assert _git(tmp_path, "rev-parse", "HEAD").startswith(commit_of(tmp_path))
    assert len(commit_of(tmp_path)) >= 7
    (tmp_path / "analytic/a.py").write_text("a = 2\n")
    assert commit_of(tmp_path) == ""


def test_no_page_is_made_of_source_that_is_no_commit(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(mutants, "installed_tree", lambda: tmp_path)
    monkeypatch.setenv("GIT_CEILING_DIRECTORIES", str(tmp_path.parent))
    with pytest.raises(SystemExit):
        main(["--page", str(tmp_path / "page.md"), "-o", str(tmp_path / "out")])
    assert "the source is not that of a commit" in capsys.readouterr().err


def test_the_page_is_that_of_the_record_and_nothing_survived_without_a_reason() -> None:
    run = mutants.recorded_run()
    assert len(run.outcomes) >= 100
    assert (ROOT / "docs" / mutants.PAGE).read_text() == run.page
    assert run.survivors == []
    assert all(outcome.drawn and outcome.judged for outcome in run.outcomes)
