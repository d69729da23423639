"""The largest Lyapunov exponent of a march: a tangent vector carried along, its growth taken period by period.

The standard error comes from batch means, b of them over n periods.  Batches that are no longer than the time over
which the growth is correlated have correlated means; with r the correlation of neighbours, and means taken for an AR(1)
series,

    s^2 = var(means) / b (1 + r) / (1 - r),    r >= 0

(G. S. Fishman, Management Science 24 (1978) 510, on batches and their correlation).

A deviation along a torus grows and shrinks quasi-periodically.  Averaged with weights that vanish smoothly at both
ends, such a series has a mean that converges faster than any power of n (S. Das, Y. Saiki, E. Sander and J. Yorke,
Nonlinearity 30 (2017) 4111), and that of chaos still as n^-1/2.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np

from fe_lapjoint.turns import Turned, Turns
from lapjoint.answers.contact_state import FREE
from lapjoint.answers.steady_state import Exponent, Outcome
from lapjoint.problem import FloatArray

LEAST_PERIODS = 400  # measured before an exponent is stated; it is judged then, and after twice as many each time
_ALIGNED = 20  # periods after which the deviation points where it grows most
_BATCHES = 32
_MOST_CORRELATED = 0.9


def batch_error(series: FloatArray) -> float:
    """Standard error of the mean of a correlated series."""
    means = np.array([np.mean(batch) for batch in np.array_split(series, _BATCHES)])
    off = means - np.mean(means)
    power = float(off @ off)
    r = min(max(float(off[1:] @ off[:-1]) / power, 0.0), _MOST_CORRELATED) if power > 0 else 0.0
    return math.sqrt(power / (_BATCHES - 1) / _BATCHES * (1 + r) / (1 - r))


def smooth_mean(series: FloatArray) -> float:
    """Mean with the weights exp(-1 / (t (1 - t))) at times t from 0 to 1."""
    t = np.linspace(0, 1, series.size + 2)[1:-1]
    weights = np.exp(-1 / t / (1 - t))
    return float(weights @ series / weights.sum())


def exponent_from(logs: FloatArray, period: float) -> Exponent:
    """From the logarithms of the growth in each period, shape ``(n,)``, n at least 32."""
    rates = logs / period
    middle = rates.size // 2
    return Exponent(
        value=float(np.mean(rates)),
        spread=batch_error(rates),
        periods=rates.size,
        time=rates.size * period,
        halves=(float(np.mean(rates[:middle])), float(np.mean(rates[middle:]))),
        quarters=tuple(smooth_mean(part) for part in np.array_split(rates, 4)),
    )


@dataclass
class Growth:
    """The growth of a deviation, period by period, and what it has shown so far.

    It is judged after 400 periods, then over the latest 800, 1600 ..., each time without the first half of what was
    judged before.  What it shows is believed when two judgements in a row agree, since a long transient, or chaos that
    pauses, deceives one of them more easily than both.  If both find that deviations die out, the march has long been
    on a periodic motion; that no orbit was found then means that it has more periods than were looked for.
    """

    turns: Turns
    logs: list[float] = field(default_factory=list)
    outcome: Outcome = Outcome.UNDECIDED
    """What the last two judgements agreed on."""
    certain: bool = False
    """Whether they did, so that there is no need to go on."""
    _last: tuple[Outcome, bool] = (Outcome.UNDECIDED, False)
    _due: int = LEAST_PERIODS
    _deviation: FloatArray | None = None
    _turns: int = 0

    def add(self, turned: Turned) -> None:
        """Carry the deviation over one turn."""
        if self._deviation is None:
            deviation = np.random.default_rng(0).normal(size=turned.end.y.size)
            self._deviation = deviation / self.turns.size(deviation)
        self._deviation = self.turns.carried(turned, self._deviation[:, None])[:, 0]
        self._turns += 1
        if self._turns % self.turns.per_period == 0:
            size = self.turns.size(self._deviation)
            self._deviation = self._deviation / size
            if self._turns > _ALIGNED * self.turns.per_period:
                self.logs.append(math.log(size))

    @property
    def enough(self) -> bool:
        """Whether there are periods enough to state an exponent."""
        return len(self.logs) >= LEAST_PERIODS

    @property
    def due(self) -> bool:
        """Whether it is time to judge."""
        return len(self.logs) == self._due

    def judge(self, *, circled: bool) -> None:
        """Compare with the judgement before; `circled`: an unstable orbit that the march may circle is known."""
        exponent = self.exponent
        now = self._shown(exponent, circled), exponent.negative
        self.certain = now == self._last and now != (Outcome.UNDECIDED, False)
        self.outcome, self._last = now[0] if self.certain else Outcome.UNDECIDED, now

    def withdraw(self) -> None:
        """Take the judgement back."""
        self.outcome, self.certain = Outcome.UNDECIDED, False

    def go_on(self) -> None:
        """Forget the first half, and measure until there is twice as much as before."""
        del self.logs[: len(self.logs) // 2]
        self._due *= 2

    def _shown(self, exponent: Exponent, circled: bool) -> Outcome:
        if exponent.positive:
            return Outcome.APERIODIC
        decay = self.turns.model.system(FREE).decay
        slowest = float(decay[decay > 0].min(initial=math.inf))
        return Outcome.QUASIPERIODIC if circled and exponent.vanishes(slowest) else Outcome.UNDECIDED

    @property
    def exponent(self) -> Exponent:
        """Its mean rate, and how far to believe it."""
        return exponent_from(np.array(self.logs), 2 * math.pi / self.turns.omega)
