"""A copy of the packages with one module changed; compiled functions that depend on the change are compiled again.

`lapjoint.compiled.cache` compiles them.  This module only tells whether there are any, because compiling takes time.
It goes by the names that a function mentions, which are more than the function needs.
"""

from __future__ import annotations

import ast
import shutil
from collections.abc import Iterator
from compileall import compile_dir
from dataclasses import dataclass
from functools import cache
from importlib.util import find_spec
from pathlib import Path

from validation.faults.syntax import definitions

PACKAGES = ("lapjoint", "analytic", "fe_lapjoint", "validation")


@dataclass(frozen=True)
class Changed:
    """A module and its changed source; an empty `module` stands for the sound packages."""

    label: str
    """Name of the change."""
    module: str = ""
    """Full name."""
    source: str = ""


def module_file(tree: Path, module: str) -> Path:
    """The file of a module, given the folder that holds the packages."""
    path = tree.joinpath(*module.split("."))
    return path / "__init__.py" if path.is_dir() else path.with_suffix(".py")


def source_of(tree: Path, module: str) -> str:
    """The source of a module."""
    return module_file(tree, module).read_text()


def sources_below(tree: Path, name: str) -> Iterator[tuple[str, str]]:
    """Name and source of a module, or of each module of a package."""
    path = tree.joinpath(*name.split("."))
    for file in sorted(path.rglob("*.py")) if path.is_dir() else [path.with_suffix(".py")]:
        if file.is_file():
            yield ".".join(file.relative_to(tree).with_suffix("").parts).removesuffix(".__init__"), file.read_text()


def installed_tree() -> Path:
    """The folder that holds the installed packages."""
    spec = find_spec("lapjoint")
    assert spec is not None
    assert spec.origin is not None
    return Path(spec.origin).parents[1]


def copied_tree(tree: Path, target: Path) -> None:
    """Copy the packages with the times of their files, which keeps compiled functions valid; compile the modules."""
    for package in PACKAGES:
        shutil.copytree(tree / package, target / package)
        compile_dir(target / package, quiet=2)


def change(tree: Path, module: str, source: str) -> bool:
    """Change the source of a module of a copy; whether any compiled function depends on the change."""
    file = module_file(tree, module)
    names = changed_names(file.read_text(), source)
    file.write_text(source)
    for bytecode in (file.parent / "__pycache__").glob(f"{file.stem}.*.pyc"):
        bytecode.unlink()
    return "njit" in source or _compiled_from(tree, names)


def changed_names(old: str, new: str) -> set[str]:
    """Functions, classes and constants of a module that differ between two sources."""
    before, after = (dict(definitions(source)) for source in (old, new))
    return {name for name in before.keys() | after.keys() if _written(before, name) != _written(after, name)}


def _written(definitions: dict[str, ast.stmt], name: str) -> str:
    return ast.dump(definitions[name]) if name in definitions else ""


def _compiled_from(tree: Path, names: set[str]) -> bool:
    """Whether any compiled function mentions one of the names, or a constant or function that depends on one."""
    paths = [path for package in PACKAGES for path in sorted((tree / package).rglob("*.py"))]
    found = [one for path in paths for one in _mentioning(path.read_text())]
    known: set[str] = set()
    reached = set(names)
    while reached != known:
        known = set(reached)
        reached |= {name for name, _, mentions in found if mentions & known}
    return any(compiled and name in reached for name, compiled, _ in found)


@cache
def _mentioning(source: str) -> tuple[tuple[str, bool, frozenset[str]], ...]:
    """Compiled functions and constants of a module: the name, whether it is compiled, and the names it mentions."""
    found = []
    for name, node in definitions(source):
        compiled = isinstance(node, ast.FunctionDef) and any("njit" in ast.dump(d) for d in node.decorator_list)
        if compiled or not isinstance(node, ast.FunctionDef | ast.ClassDef):
            found.append((name, compiled, _mentioned(node)))
    return tuple(found)


def _mentioned(node: ast.stmt) -> frozenset[str]:
    return frozenset(part.id for part in ast.walk(node) if isinstance(part, ast.Name))
