"""Small changes of source, drawn at random: a sign, a factor of 1.001, a term dropped, an index off by one.

Changes are made in the functions of both solvers and of the ground that compute something.  Code that only reads,
writes, draws or speaks is left out, and so are texts, annotations and messages of errors.
"""

from __future__ import annotations

import ast
import random
from collections import Counter
from collections.abc import Collection, Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from validation.faults.changed_tree import source_of
from validation.faults.syntax import span

ROOMS = ("analytic", "fe_lapjoint", "lapjoint/problem", "lapjoint/answers", "lapjoint/orbits", "lapjoint/campaigns")
LEFT_OUT = (
    *("lapjoint/problem/example", "lapjoint/problem/files", "lapjoint/problem/messages", "lapjoint/problem/schema"),
    *("lapjoint/answers/contact_files", "lapjoint/campaigns/batch", "lapjoint/campaigns/cluster"),
    *("lapjoint/campaigns/journal", "lapjoint/campaigns/running", "lapjoint/campaigns/workers"),
)
KINDS = ("sign", "factor 1.001", "dropped term", "off by one")


@dataclass(frozen=True)
class Mutant:
    """One change of one module."""

    kind: str
    """One of `KINDS`."""
    module: str
    """The module, by its full name."""
    function: str
    """Qualified name of the function."""
    line: int
    """Number of its line in the sound source."""
    start: int
    """Where the change begins, in bytes of the source."""
    end: int
    """Where the change ends, in bytes of the source."""
    old: str
    """The sound code."""
    new: str
    """The code in place of `old`."""
    number: int = 1
    """Number among the changes of the function that read alike, from 1."""

    @property
    def identity(self) -> str:
        """A name that does not depend on the line: module, function, and the code before and after."""
        old, new = (" ".join(text.split()) for text in (self.old, self.new))
        which = f" (number {self.number})" if self.number > 1 else ""
        return f"{self.module}.{self.function}: {old} -> {new}{which}"

    def put_into(self, source: str) -> str:
        """The source of the module with the change in it."""
        raw = source.encode()
        return (raw[: self.start] + self.new.encode() + raw[self.end :]).decode()


def drawn(tree: Path, seed: int, count: int, before: Collection[str] = ()) -> list[Mutant]:
    """Changes drawn at random, first the kind and then the place, each place once at most.

    A seed draws other changes as soon as the source changes anywhere; therefore changes drawn before come first while
    they fit.
    """
    known: dict[str, list[Mutant]] = {kind: [] for kind in KINDS}
    fitting = {mutant.identity: mutant for mutant in everywhere(tree)}
    for mutant in fitting.values():
        if mutant.identity not in before:
            known[mutant.kind].append(mutant)
    generator = random.Random(seed)
    found = [fitting[name] for name in before if name in fitting][:count]
    while len(found) < count and any(known.values()):
        kind = generator.choice([kind for kind, left in known.items() if left])
        found.append(known[kind].pop(generator.randrange(len(known[kind]))))
    return found


@cache
def everywhere(tree: Path) -> tuple[Mutant, ...]:
    """All changes that may be made in the packages of a tree, module by module, as the source is at the first call."""
    return tuple(one for name in modules(tree) for one in possible(name, source_of(tree, name)))


def modules(tree: Path) -> list[str]:
    """Names of the modules that may be changed, sorted."""
    paths = {path.relative_to(tree).with_suffix("") for room in ROOMS for path in (tree / room).rglob("*.py")}
    wanted = [path.as_posix() for path in paths if path.name != "__init__"]
    return sorted(path.replace("/", ".") for path in wanted if path not in LEFT_OUT)


def possible(module: str, source: str) -> Iterator[Mutant]:
    """All changes that may be made in a module."""
    raw = source.encode()
    alike: Counter[tuple[str, ...]] = Counter()
    for function, node in _computing(ast.parse(source), ""):
        for kind, part, change in _changes(node):
            begin, end = span(source, part)
            old = raw[begin:end].decode()
            new = change.format(old=old, **_pieces(part, source))
            reads = (function, *(" ".join(text.split()) for text in (old, new)))
            alike[reads] += 1
            yield Mutant(kind, module, function, part.lineno, begin, end, old, new, alike[reads])


def _computing(tree: ast.AST, above: str) -> Iterator[tuple[str, ast.AST]]:
    """Expressions and statements of the functions, with the name of the function."""
    for node in ast.iter_child_nodes(tree):
        if isinstance(node, ast.ClassDef):
            yield from _computing(node, f"{above}{node.name}.")
        elif isinstance(node, ast.FunctionDef) and not (node.name.startswith("__") and node.name != "__call__"):
            for statement in node.body:
                for part in _walked(statement):
                    yield above + node.name, part


def _walked(node: ast.AST) -> Iterator[ast.AST]:
    """A statement and what it consists of, but for texts, annotations, errors and assertions."""
    if isinstance(node, ast.Raise | ast.Assert | ast.JoinedStr):
        return
    yield node
    for name, value in ast.iter_fields(node):
        if name in ("annotation", "returns", "decorator_list"):
            continue
        for child in value if isinstance(value, list) else [value]:
            if isinstance(child, ast.AST):
                yield from _walked(child)


def _changes(node: ast.AST) -> Iterator[tuple[str, ast.expr, str]]:
    """The changes of one expression: the kind, what is replaced, and what by."""
    if isinstance(node, ast.BinOp) and isinstance(node.op, ast.Add | ast.Sub):
        if not any(_text(side) for side in (node.left, node.right)):
            other = "-" if isinstance(node.op, ast.Add) else "+"
            yield "sign", node, "({left} " + other + " ({right}))"
            yield "dropped term", node, "({left})"
            yield "dropped term", node, "({right})" if isinstance(node.op, ast.Add) else "(-({right}))"
    elif isinstance(node, ast.BinOp) and isinstance(node.op, ast.Mult | ast.Div):
        yield "factor 1.001", node, "(1.001 * ({old}))"
    elif isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub):
        yield "sign", node, "({operand})"
    elif isinstance(node, ast.Subscript):
        for part in ast.walk(node.slice):
            if isinstance(part, ast.Constant) and type(part.value) is int:
                yield "off by one", part, "({old} + 1)"
            elif isinstance(part, ast.Slice) and isinstance(part.upper, ast.Name):
                yield "off by one", part.upper, "({old} - 1)"
    elif isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id == "range":
        yield "off by one", node.args[-1], "({old} - 1)"
    elif isinstance(node, ast.Compare) and len(node.ops) == 1 and isinstance(node.ops[0], ast.Lt | ast.Gt):
        yield "off by one", node, "({left} " + ("<=" if isinstance(node.ops[0], ast.Lt) else ">=") + " {right})"


def _text(node: ast.expr) -> bool:
    return isinstance(node, ast.JoinedStr) or (isinstance(node, ast.Constant) and isinstance(node.value, str))


def _pieces(node: ast.expr, source: str) -> dict[str, str]:
    """The source of both sides of an operation, or of its operand."""
    if isinstance(node, ast.Compare):
        parts = {"left": node.left, "right": node.comparators[0]}
    elif isinstance(node, ast.BinOp):
        parts = {"left": node.left, "right": node.right}
    else:
        parts = {"operand": node.operand} if isinstance(node, ast.UnaryOp) else {}
    return {name: source.encode()[slice(*span(source, part))].decode() for name, part in parts.items()}
