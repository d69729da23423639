"""Who imports whom: explore -> validation -> analytic, fe_lapjoint -> lapjoint; and each folder has a purpose."""

from __future__ import annotations

import ast
import re
import subprocess
import sys
from functools import cache
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
ALLOWED = {
    "lapjoint": {"lapjoint"},
    "analytic": {"analytic", "lapjoint"},
    "fe_lapjoint": {"fe_lapjoint", "lapjoint"},
    "validation": {"validation", "analytic", "fe_lapjoint", "lapjoint"},
    "explore": {"explore", "validation", "analytic", "fe_lapjoint", "lapjoint"},
}
SOLVERS = ("analytic", "fe_lapjoint")


@cache
def nodes_of(path: Path) -> tuple[ast.AST, ...]:
    """All nodes of a file of Python."""
    return tuple(ast.walk(ast.parse(path.read_text())))


def imported_packages(path: Path) -> set[str]:
    """Top-level names that a file imports anywhere, also inside functions and by ``import_module``."""
    found: set[str] = set()
    for node in nodes_of(path):
        if isinstance(node, ast.Import):
            found |= {alias.name.split(".")[0] for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{path}: relative imports hide who imports whom"
            found.add(str(node.module).split(".")[0])
        elif isinstance(node, ast.Call) and ast.unparse(node.func).endswith(("import_module", "__import__")):
            found |= {str(arg.value).split(".")[0] for arg in node.args if isinstance(arg, ast.Constant)}
    return found


@pytest.mark.parametrize("package", sorted(ALLOWED))
def test_a_package_imports_only_what_lies_below_it(package: str) -> None:
    files = sorted((ROOT / package).rglob("*.py"))
    assert files
    for file in files:
        ours = imported_packages(file) & set(ALLOWED)
        assert ours <= ALLOWED[package], f"{file} imports {ours - ALLOWED[package]}"


def imported_files(file: Path, known: dict[str, Path]) -> set[Path]:
    """The files that a file imports anywhere; a name that a package exports is that of the file that defines it."""
    found = set()
    for node in nodes_of(file):
        if isinstance(node, ast.ImportFrom):
            found |= {home(str(node.module), alias.name, known) for alias in node.names}
        elif isinstance(node, ast.Import):
            found |= {known.get(alias.name) for alias in node.names}
    return {path for path in found if path is not None and path != file}


def home(module: str, name: str, known: dict[str, Path]) -> Path | None:
    """The file in which a name of a module is defined; None if the module is none of ours."""
    if f"{module}.{name}" in known:
        return known[f"{module}.{name}"]
    file = known.get(module)
    if file is not None and file.name == "__init__.py":
        for node in nodes_of(file):
            if isinstance(node, ast.ImportFrom) and name in {alias.name for alias in node.names}:
                return home(str(node.module), name, known)
    return file


def test_no_imports_go_round_in_a_circle() -> None:
    """Imports within functions, and for types alone, count; `__init__` files, which only pass names on, do not."""
    known = {}
    for package in ALLOWED:
        for file in (ROOT / package).rglob("*.py"):
            parts = file.relative_to(ROOT).with_suffix("").parts
            known[".".join(parts[:-1] if parts[-1] == "__init__" else parts)] = file
    files = [file for file in known.values() if file.name != "__init__.py"]
    order = TopologicalSorter({file: imported_files(file, known) & set(files) for file in files})
    try:
        order.prepare()
    except CycleError as error:
        circle = " -> ".join(file.relative_to(ROOT).as_posix() for file in error.args[1])
        pytest.fail(f"imports go round: {circle}")


WITNESSES = (
    *("rigid_bar.py", "rigid_bar_orbits.py", "dropped_cantilever.py", "pinned_beam.py"),
    *("shaken_cantilever.py", "gibbs.py", "panels.py", "three_tubes.py"),
)


@pytest.mark.parametrize("witness", WITNESSES)
def test_a_witness_shares_no_code_with_what_it_judges(witness: str) -> None:
    file = ROOT / "validation" / "references" / witness
    others = set(re.findall(r"(?:from|import) (validation[\w.]*)", file.read_text()))
    assert others <= {f"validation.references.{Path(name).stem}" for name in WITNESSES}
    assert not imported_packages(file) & set(ALLOWED) - {"validation"}


@pytest.mark.parametrize("package", sorted(ALLOWED))
def test_every_folder_says_what_it_is_for(package: str) -> None:
    folders = {file.parent for file in (ROOT / package).rglob("*.py")}
    for folder in sorted(folders):
        initial = folder / "__init__.py"
        assert initial.exists(), f"{folder} is no package"
        said = ast.get_docstring(ast.parse(initial.read_text())) or ""
        first = re.split(r"\n\s*\n", said)[0]
        assert len(first.split()) > 4, f"{initial}: says not what the folder is for"
        assert first.rstrip().endswith((".", "?")), f"{initial}: begins with no sentence: {first}"


def test_tests_stand_where_the_code_stands() -> None:
    places = {file.parent.relative_to(ROOT / "tests") for file in (ROOT / "tests").rglob("test_*.py")}
    strangers = [place for place in places if str(place) not in (".", "cross") and not (ROOT / place).is_dir()]
    assert not strangers


@pytest.mark.parametrize(
    ("one", "other"),
    [("analytic", "fe_lapjoint"), pytest.param("fe_lapjoint", "analytic", marks=pytest.mark.thorough)],
)
def test_a_solver_runs_without_the_other_being_loaded(one: str, other: str) -> None:
    question = "from lapjoint import FREE, paper_joint; solver.modes(paper_joint(), FREE, 2)"
    code = f"import sys, {one}; solver = {one}.Solver(); {question}; sys.exit('{other}' in sys.modules)"
    subprocess.run([sys.executable, "-c", code], check=True, timeout=60)


@pytest.mark.parametrize("asked", [["--help"], ["sweep", "--help"], ["--version"]], ids=" ".join)
def test_help_loads_nothing_heavy(asked: list[str]) -> None:
    code = (
        "import atexit, sys; from lapjoint.cli.start import main; "
        "heavy = {'numpy', 'pydantic', 'scipy', 'matplotlib', 'pyvista', 'skfem', 'numba'}; "
        "atexit.register(lambda: sys.stderr.write(', '.join(heavy & set(sys.modules)))); "
        "main()"
    )
    done = subprocess.run([sys.executable, "-c", code, *asked], capture_output=True, text=True, timeout=60)
    assert (done.returncode, done.stderr) == (0, ""), f"loaded: {done.stderr}"


def test_libraries_are_imported_without_what_only_their_answers_need() -> None:
    """One process imports them all: what none of them loads, each alone does not load."""
    modules = ("lapjoint", "lapjoint.problem", "lapjoint.answers", "lapjoint.figures", "lapjoint.campaigns", *SOLVERS)
    heavy = "{'scipy', 'numba', 'skfem', 'matplotlib', 'xarray', 'meshio'} & set(sys.modules)"
    code = f"import sys, {', '.join(modules)}; sys.exit(', '.join({heavy}) or 0)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=60)
    assert done.returncode == 0, f"loaded: {done.stderr}"
