"""Code by its syntax tree: definitions by name, where a piece of code stands in them, and other code in its place.

Layout and comments are no part of the comparison.  In a piece of code, ``...`` stands for any expression.  In a list of
arguments, elements or statements, ``...`` stands for any number of them, and ``f(...)`` for any call of f.
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
    """Definitions of a qualified name; a source that does not mention the name is not parsed."""
    if name.rpartition(".")[2] not in source:
        return []
    return [node for known, node in definitions(source) if known == name]


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
        first, raw = self.found[0], source.encode()
        if not isinstance(first, ast.stmt):
            text = f"({filled})"
        elif isinstance(first, ast.If) and raw[start:].startswith(b"elif"):
            text = "else:\n" + indent(filled, " " * (first.col_offset + 4))
        else:
            text = indent(filled, " " * first.col_offset).lstrip()
        return (raw[:start] + text.encode() + raw[end:]).decode()


def matches(code: str, node: ast.AST) -> Iterator[Match]:
    """All places below a node at which an expression or statements stand, and all ways in which ``...`` fits there."""
    wanted = _parsed(dedent(code)).body
    only = wanted[0].value if len(wanted) == 1 and isinstance(wanted[0], ast.Expr) else None
    for part in ast.walk(node):
        if only is not None:
            if isinstance(part, ast.expr):
                yield from (Match((part,), tuple(gaps)) for gaps in _gaps(only, part))
            continue
        for body in (getattr(part, name, ()) for name in ("body", "orelse", "finalbody")):
            for i in range(len(body) - len(wanted) + 1) if isinstance(body, list) else ():
                here = body[i : i + len(wanted)]
                yield from (Match(here, tuple(gaps)) for gaps in _gaps_of_list(wanted, here))


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


def _gaps(wanted: ast.AST, node: ast.AST) -> Iterator[list[Nodes]]:
    """Nodes that each ``...`` of a tree may stand for in another one, in all ways; none if the trees differ."""
    if _is_gap(wanted):
        if isinstance(node, ast.expr):
            yield [[node]]
    elif type(wanted) is not type(node):
        return
    elif isinstance(wanted, ast.Call) and isinstance(node, ast.Call) and _has_only_a_gap(wanted):
        yield from ([*gaps, [*node.args, *node.keywords]] for gaps in _gaps(wanted.func, node.func))
    else:
        yield from _gaps_of_fields(*([getattr(tree, name, None) for name in wanted._fields] for tree in (wanted, node)))


def _gaps_of_fields(wanted: Sequence[object], values: Sequence[object]) -> Iterator[list[Nodes]]:
    """As `_gaps`, for fields that must fit one by one."""
    if not wanted:
        yield []
        return
    for first in _gaps_of_field(wanted[0], values[0]):
        yield from ([*first, *rest] for rest in _gaps_of_fields(wanted[1:], values[1:]))


def _gaps_of_field(wanted: object, value: object) -> Iterator[list[Nodes]]:
    """As `_gaps`, for one field."""
    if isinstance(wanted, list) and isinstance(value, list):
        yield from _gaps_of_list(wanted, value)
    elif isinstance(wanted, ast.AST) and isinstance(value, ast.AST):
        yield from _gaps(wanted, value)
    elif type(wanted) is type(value) and wanted == value:
        yield []


def _gaps_of_list(wanted: Sequence[object], values: Sequence[object]) -> Iterator[list[Nodes]]:
    """As `_gaps`, for a list, in which ``...`` stands for any number of nodes."""
    if not wanted:
        yield from () if values else ([],)
    elif _is_gap(wanted[0]):
        for count in range(len(values) + 1):
            skipped = [value for value in values[:count] if isinstance(value, ast.AST)]
            yield from ([skipped, *rest] for rest in _gaps_of_list(wanted[1:], values[count:]))
    elif values:
        for first in _gaps_of_field(wanted[0], values[0]):
            yield from ([*first, *rest] for rest in _gaps_of_list(wanted[1:], values[1:]))


class _Filled(ast.NodeTransformer):
    """Puts nodes in place of each ``...``; without any, ``...`` is Python's own."""

    def __init__(self, gaps: Sequence[Nodes]) -> None:
        self._gaps, self._left = gaps, list(gaps)

    def visit(self, node: ast.AST) -> Any:
        """See `ast.NodeVisitor.visit`."""
        if not _is_gap(node) or not self._gaps:
            return self.generic_visit(node)
        if len(self._gaps) > 1 and not self._left:
            raise ValueError(f"`new` has more than the {len(self._gaps)} `...` of `old`")
        nodes = self._gaps[0] if len(self._gaps) == 1 else self._left.pop(0)
        return nodes[0] if len(nodes) == 1 else nodes
