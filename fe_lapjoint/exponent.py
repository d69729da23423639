"""The largest Lyapunov exponent of a march: a tangent vector carried along, its growth taken in equal stretches."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np

from fe_lapjoint.turns import Turned, Turns
from lapjoint.problem import FloatArray
from lapjoint.steady import Exponent

STRETCH = 20  # periods
LEAST_STRETCHES = 20
_UNMISTAKABLE = 10  # spreads above zero at which a march is not continued: it has been looked at many times
_LEAST_GROWTH = 7.0  # logarithm of the growth below which nothing is called exponential


@dataclass
class Growth:
    """The growth of a deviation, turn by turn; the first stretch turns the deviation and is not counted."""

    turns: Turns
    logs: list[float] = field(default_factory=list)
    _deviation: FloatArray | None = None
    _turns: int = 0
    _stretches: int = 0

    def add(self, turned: Turned) -> None:
        """Carry the deviation over one turn."""
        if self._deviation is None:
            deviation = np.random.default_rng(0).normal(size=turned.end.y.size)
            self._deviation = deviation / self.turns.size(deviation)
        self._deviation = self.turns.carried(turned, self._deviation[:, None])[:, 0]
        self._turns += 1
        if self._turns % (STRETCH * self.turns.per_period) == 0:
            size = self.turns.size(self._deviation)
            self._deviation = self._deviation / size
            self._stretches += 1
            if self._stretches > 1:
                self.logs.append(math.log(size))

    @property
    def enough(self) -> bool:
        """Whether there are stretches enough to judge by."""
        return len(self.logs) >= LEAST_STRETCHES

    @property
    def exponent(self) -> Exponent:
        """Its mean rate, and the standard error of the mean over `LEAST_STRETCHES` parts of equal length."""
        each = len(self.logs) // LEAST_STRETCHES
        logs = np.array(self.logs[-each * LEAST_STRETCHES :]).reshape(LEAST_STRETCHES, each)
        rates = logs.mean(axis=1) / (STRETCH * 2 * math.pi / self.turns.omega)
        spread = float(np.std(rates, ddof=1) / math.sqrt(rates.size))
        return Exponent(value=float(np.mean(rates)), spread=spread, periods=STRETCH * logs.size)

    @property
    def exponential(self) -> bool:
        """Whether nearby motions part exponentially, for certain."""
        return self.enough and self.exponent.positive and sum(self.logs) > _LEAST_GROWTH

    @property
    def unmistakable(self) -> bool:
        """Whether this is so clear that going on would not change it."""
        return self.exponential and self.exponent.value > _UNMISTAKABLE * self.exponent.spread
