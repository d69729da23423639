"""What `docs/api.md` lists has numpydoc sections: every argument, and the shape of every array; helpers have a line.

Listed are the names that a package of that page exports, and the public names of a module of that page.  A public
function is one, or a method of a public class, whose name has no leading underscore and which has an argument besides
`self`; properties are none.  Left out are commands, whose docstrings are help texts.

Three docstrings need no sections, or no Returns:

- one that says "See `...`." implements a documented protocol, whose docstring holds the sections;
- one whose summary begins with "Whether" returns a bool, and says all about it;
- one that returns nothing.
"""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from pathlib import Path

import pytest
from numpydoc.docscrape import NumpyDocString, Parameter

ROOT = Path(__file__).resolve().parents[1]
PAGE = ROOT / "docs" / "api.md"
PACKAGES = ("lapjoint", "analytic", "fe_lapjoint", "validation", "explore")
HELP_TEXTS = ("lapjoint/cli", "validation/command.py")
SCRIPTS = ("validation/cases", "validation/ledger")

Function = ast.FunctionDef | ast.AsyncFunctionDef
ARRAY = re.compile(r"\b(FloatArray|ComplexArray|IntArray|IndexArray|BoolArray|ndarray|NDArray)\b")
SHAPE = re.compile(r"\bshape \(|``\(")
NO_FUNCTIONS = {"property", "cached_property", "functools.cached_property", "overload", "typing.overload"}


def modules() -> list[str]:
    files = (file.relative_to(ROOT) for package in PACKAGES for file in sorted((ROOT / package).rglob("*.py")))
    left_out = [Path(path) for path in HELP_TEXTS + SCRIPTS]
    return [file.as_posix() for file in files if not any(file.is_relative_to(path) for path in left_out)]


def public_functions(tree: ast.Module) -> Iterator[tuple[str, Function, list[ast.arg]]]:
    """Name, definition and arguments besides `self` of each."""
    for node in tree.body:
        if isinstance(node, Function):
            yield from if_public("", node, arguments(node))
        elif isinstance(node, ast.ClassDef) and not node.name.startswith("_"):
            for method in node.body:
                if isinstance(method, Function):
                    bound = 0 if "staticmethod" in decorators(method) else 1
                    yield from if_public(f"{node.name}.", method, arguments(method)[bound:])


def if_public(prefix: str, node: Function, args: list[ast.arg]) -> Iterator[tuple[str, Function, list[ast.arg]]]:
    if args and not node.name.startswith("_") and not decorators(node) & NO_FUNCTIONS:
        yield prefix + node.name, node, args


def decorators(node: Function) -> set[str]:
    return {ast.unparse(decorator) for decorator in node.decorator_list}


def arguments(node: Function) -> list[ast.arg]:
    of = node.args
    some = [*of.posonlyargs, *of.args, of.vararg, *of.kwonlyargs, of.kwarg]
    return [arg for arg in some if arg is not None]


def listed() -> dict[str, set[str] | None]:
    """By file, the names that the page lists; None where it lists the whole module."""
    found: dict[str, set[str] | None] = {}
    for name in re.findall(r"^   ([a-z]\w*(?:\.\w+)*)$", PAGE.read_text(encoding="utf-8"), re.M):
        path = ROOT / name.replace(".", "/")
        if not path.is_dir():
            found[f"{name.replace('.', '/')}.py"] = None
            continue
        for node in ast.walk(ast.parse((path / "__init__.py").read_text(encoding="utf-8"))):
            if isinstance(node, ast.ImportFrom):
                for alias in node.names:
                    file = home(str(node.module), alias.name)
                    if (names := found.setdefault(file, set())) is not None:
                        names.add(alias.name)
    return found


def home(module: str, name: str) -> str:
    """The file in which a name is defined that a module has or a package exports."""
    path = ROOT / module.replace(".", "/")
    if not path.is_dir():
        return f"{module.replace('.', '/')}.py"
    nodes = ast.walk(ast.parse((path / "__init__.py").read_text(encoding="utf-8")))
    froms = [node for node in nodes if isinstance(node, ast.ImportFrom)]
    sources = [str(node.module) for node in froms if name in {alias.name for alias in node.names}]
    return home(sources[0], name) if sources else f"{module.replace('.', '/')}/__init__.py"


def faults(node: Function, args: list[ast.arg], exported: bool) -> Iterator[str]:
    """What a docstring lacks."""
    said = ast.get_docstring(node)
    if said is None:
        yield "has no docstring"
        return
    if "See `" in said or not exported:
        return
    doc = NumpyDocString(said)
    if not "".join(doc["Summary"]).strip():
        yield "begins with no summary"
    yield from faults_of_parameters(args, doc["Parameters"] + doc["Other Parameters"])
    yield from faults_of_returns(node, doc)


def faults_of_parameters(args: list[ast.arg], documented: list[Parameter]) -> Iterator[str]:
    told = [
        (name.strip().lstrip("*"), entry.type, " ".join(entry.desc))
        for entry in documented
        for name in entry.name.split(",")
    ]
    names = [arg.arg for arg in args]
    if [name for name, _, _ in told] != names:
        yield f"takes ({', '.join(names)}), and documents ({', '.join(name for name, _, _ in told)})"
        return
    for arg, (name, kind, meaning) in zip(args, told, strict=True):
        if not kind or not meaning:
            yield f"{name}: lacks its {'type' if not kind else 'meaning'}"
        if is_array(arg.annotation) and not SHAPE.search(f"{kind} {meaning}"):
            yield f"{name}: is an array without a shape"


def faults_of_returns(node: Function, doc: NumpyDocString) -> Iterator[str]:
    if node.returns is None or ast.unparse(node.returns) in ("None", "NoReturn", "Never"):
        return
    if ast.unparse(node.returns) == "bool" and doc["Summary"][0].startswith("Whether"):
        return
    told = doc["Returns"] or doc["Yields"]
    text = " ".join(f"{entry.type} {' '.join(entry.desc)}" for entry in told)
    if not told:
        yield "lacks a Returns section"
    elif is_array(node.returns) and not SHAPE.search(text):
        yield "returns an array without a shape"


def is_array(annotation: ast.expr | None) -> bool:
    return annotation is not None and ARRAY.search(ast.unparse(annotation)) is not None


LISTED = listed()


@pytest.mark.parametrize("module", modules())
def test_public_functions_document_what_they_take_and_give(module: str) -> None:
    tree = ast.parse((ROOT / module).read_text(encoding="utf-8"))
    names = LISTED.get(module, set())
    found = [
        f"{module}:{node.lineno} {name} {fault}"
        for name, node, args in public_functions(tree)
        for fault in faults(node, args, names is None or name.split(".")[0] in names)
    ]
    assert not found, "\n" + "\n".join(found)
