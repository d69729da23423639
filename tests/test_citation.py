"""CITATION.cff has what archives ask for, and says the same as package and changelog; so does CONTRIBUTING.md."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path
from typing import Any

import pytest
import yaml

from lapjoint.answers import series
from lapjoint.campaigns.dataset import FORMAT_VERSION
from lapjoint.problem.problem import SCHEMA_VERSION

ROOT = Path(__file__).resolve().parents[1]
CITED: dict[str, Any] = yaml.safe_load((ROOT / "CITATION.cff").read_text(encoding="utf-8"))
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
CHANGES = (ROOT / "CHANGELOG.md").read_text(encoding="utf-8")
NEEDED = {"cff-version", "message", "title", "authors", "type", "abstract", "version", "license", "keywords"}
OPTIONAL = {
    *("commit", "contact", "date-released", "doi", "identifiers", "license-url", "preferred-citation", "references"),
    *("repository", "repository-artifact", "repository-code", "url"),
}
"""The other keys that version 1.2.0 of the format has; there must be none else."""


def test_it_has_what_archives_ask_for_and_nothing_that_the_format_has_not() -> None:
    assert CITED["cff-version"] == "1.2.0"
    assert NEEDED <= set(CITED) <= NEEDED | OPTIONAL
    assert all(isinstance(CITED[key], str) and CITED[key] for key in NEEDED - {"authors", "keywords"})
    assert CITED["type"] == "software"
    assert len(CITED["abstract"]) > 200
    people = [author for work in (CITED, *CITED["references"]) for author in work["authors"]]
    assert people
    assert all(set(one) in ({"name"}, {"family-names", "given-names"}) for one in people)
    for work in CITED["references"]:
        assert {"type", "title", "authors", "doi", "year"} <= set(work)
        assert re.fullmatch(r"10\.\d{4,9}/\S+", work["doi"])


def test_it_says_what_the_package_says() -> None:
    assert CITED["version"] == PROJECT["version"]
    assert CITED["license"] == PROJECT["license"]
    assert CITED["keywords"] == PROJECT["keywords"]


def test_a_version_that_is_released_has_its_date_in_both_files() -> None:
    dates = re.findall(rf"^## \[{re.escape(PROJECT['version'])}\] - (\S+)$", CHANGES, re.MULTILINE)
    assert [str(CITED[key]) for key in ("date-released",) if key in CITED] == dates


@pytest.mark.parametrize(
    ("row", "number"),
    [
        ("the package", PROJECT["version"]),
        ("a problem file", SCHEMA_VERSION),
        ("files of sweeps, branches, basins and statistics, and their journals", FORMAT_VERSION),
        ("files of time series", series.FORMAT_VERSION),
    ],
)
def test_the_policy_for_versions_tells_the_present_ones(row: str, number: object) -> None:
    text = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
    assert re.search(rf"^\| {re.escape(row)} \| [^|]+ \| {re.escape(str(number))} \|", text, re.MULTILINE)
