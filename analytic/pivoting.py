r"""Linear complementarity problems in exact arithmetic: integers, so that no rounding decides which stops press.

Dependent variables are affine functions of independent ones.  Each of the ``m`` first rows is an equation, whose left
side must be 0, and belongs to a free variable; each of the ``P`` other rows is a slack, which must be at least 0, and
belongs to a force that must be at least 0, and one of both is 0:

    (e, y) = T (u, F) + c,    e = 0,    y >= 0,    F >= 0,    y_j F_j = 0 for every j.

A pivot makes an independent variable dependent, and a dependent one independent.  The entries are kept as integers over
one common denominator, the last pivot, and divisions by it leave no remainder (J. Edmonds).

First the free variables are made dependent, and the left sides independent; those stay 0.  A free variable in no
equation is the amount of a rigid motion that stops alone resist: a stop j that resists it is taken as pressed, y_j = 0,
which gives the variable, and the equation left over gives F_j.  Then the criss-cross method takes the first pair whose
dependent variable is negative, and exchanges it within the pair; where that pivot is 0, together with the first pair
that can raise it.  For a convex problem the matrix is sufficient, and for such matrices the method ends after a finite
number of pivots, as no set of dependent variables can occur twice (D. den Hertog, C. Roos and T. Terlaky, Linear
Algebra and its Applications 187, 1993).  Where no pair can raise a negative variable, there is no solution, and its
column is a direction in which the energy falls for ever.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction

Row = Sequence[Fraction]


@dataclass(frozen=True)
class Solution:
    """A solution: free variables and forces."""

    free: tuple[Fraction, ...]
    forces: tuple[Fraction, ...]


@dataclass(frozen=True)
class NoSolution:
    """The direction in which nothing resists: the change of each free variable; no force changes."""

    direction: tuple[Fraction, ...]


def solve(rows: Sequence[Row], free: int) -> Solution | NoSolution:
    """Solve a convex problem of ``free + P`` rows of T with c as the last entry; the first `free` are equations."""
    table = _Tableau(rows)
    pairs = range(free, len(rows))
    left = [e for e in range(free) if not _eliminate(table, e, free)]
    for u in [u for u in range(free) if u in table.columns]:
        stop = next((j for j in pairs if j in table.columns and table.entry(_slack(j), u)), None)
        if stop is None:
            continue
        table.exchange(_slack(stop), u)
        equation = next(e for e in left if table.entry(_slack(e), stop))
        table.exchange(_slack(equation), stop)
        left.remove(equation)
    for equation in left:
        if table.constant(_slack(equation)):
            return NoSolution(_falling(table, free, rows))
    blocked = _criss_cross(table, pairs)
    if blocked is not None:
        return NoSolution(tuple(table.value_along(u, blocked) for u in range(free)))
    return Solution(tuple(table.value(u) for u in range(free)), tuple(table.value(j) for j in pairs))


def _slack(i: int) -> int:
    """The name of the left side or slack of row i; that of its free variable or force is i itself."""
    return ~i


def _eliminate(table: _Tableau, equation: int, free: int) -> bool:
    """Make a free variable dependent by an equation; False if the equation has none."""
    for u in range(free):
        if u in table.columns and table.entry(_slack(equation), u):
            table.exchange(_slack(equation), u)
            return True
    return False


def _falling(table: _Tableau, free: int, rows: Sequence[Row]) -> tuple[Fraction, ...]:
    """A change of the free variables that no equation and no slack sees, along which the loads do work."""
    for u in [u for u in range(free) if u in table.columns]:
        direction = tuple(table.value_along(v, u) for v in range(free))
        work = sum((direction[e] * rows[e][-1] for e in range(free)), Fraction(0))
        if work:
            return direction if work > 0 else tuple(-part for part in direction)
    raise AssertionError("an equation without a solution belongs to a motion along which the loads do work")


def _criss_cross(table: _Tableau, pairs: range) -> int | None:
    """Pivot until no dependent variable is negative; or the independent variable of a direction of falling energy."""
    while True:
        below = next((j for j in pairs if table.constant(table.dependent(j)) < 0), None)
        if below is None:
            return None
        row = table.dependent(below)
        if table.entry(row, ~row):
            table.exchange(row, ~row)
            continue
        raising = next((j for j in pairs if table.entry(row, ~table.dependent(j)) > 0), None)
        if raising is None:
            return ~row
        other = table.dependent(raising)
        table.exchange(row, ~other)
        table.exchange(other, ~row)


class _Tableau:
    """Dependent variables as affine functions of independent ones: integers over a common denominator."""

    def __init__(self, rows: Sequence[Row]) -> None:
        self._T, self._over = [_whole(row) for row in rows], 1
        self.rows = {~i: i for i in range(len(rows))}
        """Row of each dependent variable."""
        self.columns = {i: i for i in range(len(rows))}
        """Column of each independent variable."""

    def dependent(self, j: int) -> int:
        """The dependent variable of a pair."""
        return j if j in self.rows else ~j

    def entry(self, row: int, column: int) -> int:
        """A coefficient, with the right sign and with a factor that the row has in common."""
        return self._signed(self._T[self.rows[row]][self.columns[column]])

    def constant(self, row: int) -> int:
        """A dependent variable where the independent ones are 0, as `entry`."""
        return self._signed(self._T[self.rows[row]][-1])

    def value(self, variable: int) -> Fraction:
        """A free variable or force, where the independent variables are 0."""
        return Fraction(self._T[self.rows[variable]][-1], self._over) if variable in self.rows else Fraction(0)

    def value_along(self, variable: int, independent: int) -> Fraction:
        """The change of a free variable with an independent one."""
        if variable in self.rows:
            return Fraction(self._T[self.rows[variable]][self.columns[independent]], self._over)
        return Fraction(int(variable == independent))

    def exchange(self, row: int, column: int) -> None:
        """Make a dependent variable independent, and an independent one dependent."""
        r, s, T, over = self.rows.pop(row), self.columns.pop(column), self._T, self._over
        self.rows[column], self.columns[row] = r, s
        pivot, own = T[r][s], T[r]
        for i, other in enumerate(T):
            if i != r:
                across = other[s]
                T[i] = [(a * pivot - across * b) // over for a, b in zip(other, own, strict=True)]
                T[i][s] = across
        T[r] = [-b for b in own]
        T[r][s], self._over = over, pivot

    def _signed(self, number: int) -> int:
        return number if self._over > 0 else -number


def _whole(row: Row) -> list[int]:
    """A row times the least positive number that makes it whole."""
    scale = math.lcm(*(number.denominator for number in row))
    return [number.numerator * (scale // number.denominator) for number in row]
