"""The wheel: all that the packages hold is in it, and it validates itself where there is no checkout."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
import tomllib
import zipfile
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
PACKAGES = ("lapjoint", "analytic", "fe_lapjoint", "validation", "explore")
CHEAP = ("textbook", "table4")
"""Cases that march nothing, so that nothing is compiled; the report reads the template, references and faults."""
VERSION = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["version"]


@pytest.fixture(scope="module")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The wheel, made of a copy: building leaves files behind, and takes in those of a build before."""
    source, target = tmp_path_factory.mktemp("source"), tmp_path_factory.mktemp("wheel")
    for name in PACKAGES:
        shutil.copytree(ROOT / name, source / name, ignore=shutil.ignore_patterns("__pycache__"))
    for name in ("pyproject.toml", "README.md", "LICENSE"):
        shutil.copy(ROOT / name, source)
    pip = (sys.executable, "-m", "pip", "--quiet", "--disable-pip-version-check")
    subprocess.run([*pip, "wheel", "--no-deps", "--wheel-dir", target, source], check=True, timeout=300)
    (made,) = target.iterdir()
    return made


@pytest.fixture(scope="module")
def installed(wheel: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder that the wheel is installed in, alone."""
    folder = tmp_path_factory.mktemp("installed")
    pip = (sys.executable, "-m", "pip", "--quiet", "--disable-pip-version-check")
    command = [*pip, "install", "--no-deps", "--no-index", "--no-compile", "--target", folder, wheel]
    subprocess.run(command, check=True, timeout=300)
    return folder


def run_outside(installed: Path, empty: Path, *arguments: str, timeout: float) -> str:
    """What a command prints that sees the installed packages, and runs in an empty folder."""
    environment = {**os.environ, "PYTHONPATH": str(installed), "PYTHONSAFEPATH": "1"}
    command = [sys.executable, *arguments]
    done = subprocess.run(command, cwd=empty, env=environment, capture_output=True, text=True, timeout=timeout)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


@pytest.mark.thorough
def test_it_holds_all_that_the_packages_hold(wheel: Path) -> None:
    with zipfile.ZipFile(wheel) as archive:
        held = {name for name in archive.namelist() if name.split("/")[0] in PACKAGES}
    there = {
        path.relative_to(ROOT).as_posix()
        for package in PACKAGES
        for path in (ROOT / package).rglob("*")
        if path.is_file() and "__pycache__" not in path.parts
    }
    assert held == there
    assert {Path(name).suffix for name in held} >= {".py", ".toml", ".json", ".j2", ".css", ".typed"}
    assert f"-{VERSION}-" in wheel.name


@pytest.mark.thorough
def test_it_validates_itself_where_there_is_no_checkout(installed: Path, tmp_path: Path) -> None:
    where = run_outside(installed, tmp_path, "-c", "import validation; print(validation.__file__)", timeout=60)
    assert Path(where.strip()).is_relative_to(installed)
    cases = [word for name in CHEAP for word in ("--case", name)]
    run_outside(installed, tmp_path, "-m", "lapjoint", "validate", "--quick", *cases, timeout=300)
    report = json.loads((tmp_path / "report" / "report.json").read_text(encoding="utf-8"))
    assert [case["name"] for case in report["cases"]] == list(CHEAP)
    assert {case["verdict"] for case in report["cases"]} <= {"agree", "explained"}
    assert "<svg" in (tmp_path / "report" / "report.html").read_text(encoding="utf-8")
    assert {path.name for path in tmp_path.iterdir()} == {"report"}


@pytest.mark.slow
def test_its_whole_quick_validation_passes_where_there_is_no_checkout(installed: Path, tmp_path: Path) -> None:
    run_outside(installed, tmp_path, "-m", "lapjoint", "validate", "--quick", timeout=3600)
    report = json.loads((tmp_path / "report" / "report.json").read_text(encoding="utf-8"))
    listed = run_outside(installed, tmp_path, "-m", "lapjoint", "validate", "--list", timeout=60).split()
    assert [case["name"] for case in report["cases"]] == listed
