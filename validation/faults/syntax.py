"""Code by its syntax tree: definitions by name, where a piece of code stands in them, and other code in its place.

Layout, comments and docstrings are no part of the comparison.  In a piece of code, ``...`` stands for any expression.
As an argument, an element or a statement it stands for any number of them, and ``f(...)`` for any call of f.
"""

from __future__ import annotations

import ast
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cache
from textwrap import dedent, indent
from typing import Any

Nodes = Sequence[ast.AST]


def definitions(source: str) -> Iterator[tuple[str, ast.stmt]]:
    """Functions, classes, methods and assigned names of a module, each with its qualified name."""
    yield from _definitions(_parsed(source).body, "")


def defined(name: str, source: str) -> list[ast.stmt]:
    """Definitions of a qualified name; a source is parsed only if its text looks like one."""
    last = name.rpartition(".")[2]
    texts = (f"def {last}(", f"class {last}", f"{last} =", f"{last}:", f"{last},")
    return (
        [node for known, node in definitions(source) if known == name] if any(text in source for text in texts) else []
    )


def _definitions(body: Sequence[ast.stmt], above: str) -> Iterator[tuple[str, ast.stmt]]:
    for node in body:
        if isinstance(node, ast.FunctionDef | ast.ClassDef):
            yield above + node.name, node
            if isinstance(node, ast.ClassDef):
                yield from _definitions(node.body, f"{above}{node.name}.")
        elif isinstance(node, ast.Assign | ast.AnnAssign):
            for target in node.targets if isinstance(node, ast.Assign) else [node.target]:
                yield from ((above + part.id, node) for part in ast.walk(target) if isinstance(part, ast.Name))


@cache
def _parsed(source: str) -> ast.Module:
    return ast.parse(source)


@dataclass(frozen=True)
class Match:
    """One place in a source at which a piece of code stands."""

    found: Nodes
    """One expression, or statements that follow one another."""
    gaps: tuple[Nodes, ...]
    """Nodes that each ``...`` stands for."""

    def replaced(self, source: str, new: str) -> str:
        """The source with other code here; the nth ``...`` of `new` is that of the match, an only one is each."""
        filled = ast.unparse(_Filled(self.gaps).visit(ast.parse(dedent(new))))
        start, end = span(source, self.found[0], self.found[-1])
        first = self.found[0]
        text = indent(filled, " " * first.col_offset).lstrip() if isinstance(first, ast.stmt) else f"({filled})"
        raw = source.encode()
        return (raw[:start] + text.encode() + raw[end:]).decode()


def matches(code: str, node: ast.AST) -> Iterator[Match]:
    """All places below a node at which an expression or statements stand."""
    wanted = _parsed(dedent(code)).body
    only = wanted[0].value if len(wanted) == 1 and isinstance(wanted[0], ast.Expr) else None
    for part in ast.walk(node):
        if only is not None:
            if isinstance(part, ast.expr) and (gaps := _gaps(only, part)) is not None:
                yield Match((part,), tuple(gaps))
            continue
        for body in (getattr(part, name, ()) for name in ("body", "orelse", "finalbody")):
            for i in range(len(body) - len(wanted) + 1) if isinstance(body, list) else ():
                here = body[i : i + len(wanted)]
                if (gaps := _gaps_of_list(wanted, here)) is not None:
                    yield Match(here, tuple(gaps))


def span(source: str, first: ast.AST, last: ast.AST | None = None) -> tuple[int, int]:
    """Where a node begins and where it, or another one, ends, in bytes of the source."""
    starts, end = _line_starts(source), first if last is None else last
    assert isinstance(first, ast.expr | ast.stmt)
    assert isinstance(end, ast.expr | ast.stmt)
    assert end.end_lineno is not None
    assert end.end_col_offset is not None
    return starts[first.lineno - 1] + first.col_offset, starts[end.end_lineno - 1] + end.end_col_offset


@cache
def _line_starts(source: str) -> tuple[int, ...]:
    starts = [0]
    for line in source.encode().split(b"\n"):
        starts.append(starts[-1] + len(line) + 1)
    return tuple(starts)


def _is_gap(node: object) -> bool:
    return (isinstance(node, ast.Constant) and node.value is ...) or (
        isinstance(node, ast.Expr) and _is_gap(node.value)
    )


def _has_only_a_gap(call: ast.Call) -> bool:
    return len(call.args) == 1 and not call.keywords and _is_gap(call.args[0])


def _gaps(wanted: ast.AST, node: ast.AST) -> list[Nodes] | None:
    """Nodes that each ``...`` of a tree stands for in another one; None if the trees differ."""
    if _is_gap(wanted):
        return [[node]] if isinstance(node, ast.expr) else None
    if type(wanted) is not type(node):
        return None
    if isinstance(wanted, ast.Call) and isinstance(node, ast.Call) and _has_only_a_gap(wanted):
        of_function = _gaps(wanted.func, node.func)
        return None if of_function is None else [*of_function, [*node.args, *node.keywords]]
    found: list[Nodes] = []
    for name in wanted._fields:
        gaps = _gaps_of_field(getattr(wanted, name, None), getattr(node, name, None))
        if gaps is None:
            return None
        found += gaps
    return found


def _gaps_of_field(wanted: object, value: object) -> list[Nodes] | None:
    if isinstance(wanted, list) and isinstance(value, list):
        return _gaps_of_list(wanted, value)
    if isinstance(wanted, ast.AST):
        return _gaps(wanted, value) if isinstance(value, ast.AST) else None
    return [] if type(wanted) is type(value) and wanted == value else None


def _gaps_of_list(wanted: Sequence[object], values: Sequence[object]) -> list[Nodes] | None:
    if not wanted:
        return None if values else []
    if _is_gap(wanted[0]):
        for count in range(len(values) + 1):
            if (rest := _gaps_of_list(wanted[1:], values[count:])) is not None:
                return [values[:count], *rest]  # type: ignore[list-item]
        return None
    first = _gaps_of_field(wanted[0], values[0]) if values else None
    rest = None if first is None else _gaps_of_list(wanted[1:], values[1:])
    return None if first is None or rest is None else [*first, *rest]


class _Filled(ast.NodeTransformer):
    """Puts nodes in place of each ``...``."""

    def __init__(self, gaps: Sequence[Nodes]) -> None:
        self._left, self._only = list(gaps), gaps[0] if len(gaps) == 1 else None

    def visit(self, node: ast.AST) -> Any:
        """See `ast.NodeVisitor.visit`."""
        if not _is_gap(node) or not (self._left or self._only):
            return self.generic_visit(node)
        nodes = self._only or self._left.pop(0)
        return nodes[0] if len(nodes) == 1 else nodes
