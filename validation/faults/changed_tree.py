"""A copy of the packages with one module changed; compiled functions that depend on the change are compiled again.

`lapjoint.compiled.cache` sees to that.  Here it is only asked whether there are any, since to compile takes time: they
are found by the names that they mention, which are more than those that they need.
"""

from __future__ import annotations

import ast
import shutil
from collections.abc import Iterator
from compileall import compile_dir
from functools import cache
from importlib.util import find_spec
from pathlib import Path

PACKAGES = ("lapjoint", "analytic", "fe_lapjoint", "validation")


def module_file(tree: Path, module: str) -> Path:
    """The file of a module.

    Parameters
    ----------
    tree : Path
        The folder that holds the packages.
    module : str
        Its full name.

    Returns
    -------
    Path
        The file.
    """
    path = tree.joinpath(*module.split("."))
    return path / "__init__.py" if path.is_dir() else path.with_suffix(".py")


def source_of(tree: Path, module: str) -> str:
    """The source of a module.

    Parameters
    ----------
    tree : Path
        The folder that holds the packages.
    module : str
        Its full name.

    Returns
    -------
    str
        Its text.
    """
    return module_file(tree, module).read_text()


def installed_tree() -> Path:
    """The folder that holds the packages as they are installed."""
    spec = find_spec("lapjoint")
    assert spec is not None
    assert spec.origin is not None
    return Path(spec.origin).parents[1]


def copied_tree(tree: Path, target: Path) -> None:
    """Copy the packages, times of files included, so that what was compiled from them stays valid; compile the rest.

    Parameters
    ----------
    tree : Path
        The folder that holds them.
    target : Path
        A folder that takes the copy.
    """
    for package in PACKAGES:
        shutil.copytree(tree / package, target / package)
        compile_dir(target / package, quiet=2)


def change(tree: Path, module: str, source: str) -> bool:
    """Change a module of a copy.

    Parameters
    ----------
    tree : Path
        The folder that holds the copy.
    module : str
        The module, by its full name.
    source : str
        Its new source.

    Returns
    -------
    bool
        Whether any compiled function depends on it.
    """
    file = module_file(tree, module)
    names = changed_names(file.read_text(), source)
    file.write_text(source)
    for kept in (file.parent / "__pycache__").glob(f"{file.stem}.*.pyc"):
        kept.unlink()
    return "njit" in source or _compiled_from(tree, names)


def changed_names(old: str, new: str) -> set[str]:
    """What a change of a module's source changes, by its name at the top of the module.

    Parameters
    ----------
    old, new : str
        Source before and after.

    Returns
    -------
    set of str
        Functions, classes and constants that differ.
    """
    before, after = (dict(_definitions(ast.parse(source))) for source in (old, new))
    return {name for name in before.keys() | after.keys() if _written(before, name) != _written(after, name)}


def _written(definitions: dict[str, ast.stmt], name: str) -> str:
    return ast.dump(definitions[name]) if name in definitions else ""


def _definitions(tree: ast.Module) -> Iterator[tuple[str, ast.stmt]]:
    for node in tree.body:
        if isinstance(node, ast.FunctionDef | ast.ClassDef):
            yield node.name, node
        elif isinstance(node, ast.Assign | ast.AnnAssign):
            targets = node.targets if isinstance(node, ast.Assign) else [node.target]
            for target in targets:
                for part in ast.walk(target):
                    if isinstance(part, ast.Name):
                        yield part.id, node


def _compiled_from(tree: Path, names: set[str]) -> bool:
    """Whether any compiled function mentions a name, or what depends on it."""
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
    for name, node in _definitions(ast.parse(source)):
        compiled = isinstance(node, ast.FunctionDef) and any("njit" in ast.dump(d) for d in node.decorator_list)
        if compiled or not isinstance(node, ast.FunctionDef | ast.ClassDef):
            found.append((name, compiled, _mentioned(node)))
    return tuple(found)


def _mentioned(node: ast.stmt) -> frozenset[str]:
    return frozenset(part.id for part in ast.walk(node) if isinstance(part, ast.Name))
