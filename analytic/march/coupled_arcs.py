r"""Arcs of a joint with damped stops, in whose contact states (q, v) may be the (P, V) of `analytic.march.coupled`.

In every state a free motion w = (q, v) obeys w' = L w, with L = [[0, 1], [-stiffness, -damping]] for each oscillator.
A function of L with the roots lambda_1, lambda_2 is f(L) = c_0 + c_1 L with

    c_1 = (f(lambda_1) - f(lambda_2)) / (lambda_1 - lambda_2),    c_0 = f(lambda_1) - lambda_1 c_1.

With f = exp(lambda d) that is the flow, and with the means over d of `_means` it gives the mean rates over an arc.

If the switch between two arcs comes later, all other times fixed, the second arc changes, at a fixed time just after
the switch, at the rate W y'- + b' - y'+ with the passage y_new = W y + b(t).  The derivative by a duration is the sum
of the derivatives by the times of the end of its arc and of all later ends.

A damped stop may open by the equation w m_1 + (1 - w) m_2, with the mean rates m of the two arcs of its contact, of
durations p and r; see `lapjoint.orbits.arcs`.  Where dw = w_p dp + w_r dr, the difference m_2 - m_1 = p late_1 +
r early_2, because the velocity between both arcs is one.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from analytic.march.joint import Joint
from analytic.march.oscillator import DRIFTING, SPLIT
from analytic.march.tables import IntArray
from analytic.modes.beam_functions import ComplexArray
from lapjoint.answers.contact_state import ContactState
from lapjoint.orbits.arcs import Chain, ContactSequence
from lapjoint.orbits.watch import row_of
from lapjoint.problem import FloatArray

_POINTS, _WEIGHTS = np.add(np.polynomial.legendre.leggauss(8), [[1.0], [0.0]]) / 2
"""Gauss' rule on [0, 1]: exact to rounding for exponentials that turn, rise or fall by up to 1."""


@dataclass(frozen=True)
class _Mean:
    """The mean rate of a gap function over an arc, m/s."""

    value: float
    """The mean rate, m/s."""
    by_start: FloatArray
    """Its derivatives by (q, v) at the start, shape ``(2 N,)``."""
    early: float
    """Its derivative by the time of the start, which moves along the arc while the end stays, m/s2."""
    late: float
    """Its derivative by the time of the end, m/s2."""


class OscillatorState:
    """One contact state of a joint with damped stops: ``N`` oscillators, ``H`` harmonics, ``P`` rows of the tables."""

    def __init__(self, joint: Joint, state: ContactState) -> None:
        slot, n = joint.slot(state), joint.count(state)
        tables = joint.tables
        self.n = n
        self._turning = np.asarray(1j * tables.omega, dtype=complex)
        self._kind: IntArray = tables.kind[slot, :n].copy()
        split = np.flatnonzero(self._kind == SPLIT)
        self._roots = np.array([tables.root[slot, :n], tables.root[slot, :n].conj()], dtype=complex)
        self._roots[:, self._kind == DRIFTING] = 0.0
        self._roots[1, split] = tables.root[slot, n : n + split.size]
        self._damping, self._stiffness = -self._roots.sum(axis=0).real, self._roots.prod(axis=0).real
        self._static, self._push = tables.static[slot, :n].copy(), tables.push[slot, :, :n].copy()
        harmonic = tables.harmonic[slot, :, :n]
        self._answer = np.concatenate([harmonic, self._turning[:, None] * harmonic], axis=1)
        self.gradient: FloatArray = tables.gradient[slot, tables.position, :, :n].reshape(-1, 2 * n)
        """Displacement at each row for units of (q, v), kg^-1/2 and kg^-1/2 s, shape ``(P, 2 N)``."""
        self._constant, self._forced = tables.constant[slot, tables.position], tables.forced[slot, tables.position]
        self._beside = self._forced - self.gradient @ self._answer.T
        self._sign, self._gap = tables.sign, tables.gap

    def _function(self, values: ComplexArray, at_zero: tuple[float, float]) -> tuple[FloatArray, FloatArray]:
        """c_0 and c_1, ``(N,)``, of a function with the values ``(2, N)`` at both roots; `at_zero` is the function and
        its derivative at a double root of 0."""
        (one, other), (f, g) = self._roots, values
        apart = np.where(self._kind == DRIFTING, 1.0, one - other)
        c1, c0 = ((f - g) / apart).real, ((one * g - other * f) / apart).real
        drifts = self._kind == DRIFTING
        return np.where(drifts, at_zero[0], c0), np.where(drifts, at_zero[1], c1)

    def flown(self, d: float, w: FloatArray) -> FloatArray:
        """Free motions (q, v), ``(2 N, m)``, after `d` seconds."""
        c0, c1 = (np.tile(c, 2)[:, None] for c in self._function(np.exp(self._roots * d), (1.0, d)))
        return np.asarray(c0 * w + c1 * self._rates_of(w))

    def _rates_of(self, w: FloatArray) -> FloatArray:
        """L w of free motions ``(2 N, m)``."""
        q, v = w[: self.n], w[self.n :]
        return np.concatenate([v, -self._stiffness[:, None] * q - self._damping[:, None] * v])

    def answer(self, waves: ComplexArray) -> FloatArray:
        """(q, v) of the answer to the harmonics, ``(2 N,)``; `waves` are exp(i theta), ``(H,)``."""
        return np.asarray((waves @ self._answer).imag)

    def still(self, s: float) -> FloatArray:
        """(q, v) of the answer to constant forces `s` seconds after the start of an arc, ``(2 N,)``."""
        a = self._static.T
        return np.concatenate([a[0] + s * (a[1] + s * a[2]), a[1] + 2 * s * a[2]])

    def rates(self, waves: ComplexArray, y: FloatArray) -> FloatArray:
        """d(q, v)/dt, ``(2 N,)``."""
        rates = self._rates_of(y[:, None])[:, 0]
        rates[self.n :] += self._push[0].real + (waves @ self._push[1:]).imag
        return rates

    def gap_function(self, row: int, waves: ComplexArray, y: FloatArray) -> float:
        """sign z - gap of a row, m."""
        z = self._constant[row] + self.gradient[row] @ y + (self._beside[row] @ waves).imag
        return float(self._sign[row] * z - self._gap[row])

    def reading(self, row: int) -> FloatArray:
        """Derivatives of `gap_function` by (q, v), ``(2 N,)``."""
        return np.asarray(self._sign[row] * self.gradient[row])

    def gap_rate(self, row: int, waves: ComplexArray, rates: FloatArray) -> float:
        """Rate of `gap_function`, m/s, of a motion with `rates`, ``(2 N,)``."""
        beside = (self._beside[row] @ (self._turning * waves)).imag
        return float(self._sign[row] * (self.gradient[row] @ rates + beside))

    def mean(self, row: int, waves: ComplexArray, w: FloatArray, d: float) -> _Mean:
        """Mean rate of `gap_function` over `d` seconds from the free motion `w`, ``(2 N,)``, and the phases `waves`."""
        sign, (by_q, by_v) = self._sign[row], self.gradient[row].reshape(2, -1)
        onward = np.concatenate([-self._stiffness * by_v, by_q - self._damping * by_v])
        rows = []
        for values, slope in zip(_means(self._roots, d), (1.0, 0.0, 0.0), strict=True):
            c0, c1 = (np.tile(c, 2) for c in self._function(values, (0.0, slope)))
            rows.append(sign * (c0 * self.gradient[row] + c1 * onward))
        loads = sign * (_means(self._turning, d) @ (self._forced[row] * waves)).imag
        value, early, late = np.array([its @ w for its in rows]) + loads
        a1, a2 = self._static[:, 1], self._static[:, 2]
        bend = float(sign * (by_q @ a2))
        value += sign * (by_q @ a1 + 2 * by_v @ a2) + bend * d
        return _Mean(float(value), rows[0], float(early + bend), float(late + bend))


def _means(roots: ComplexArray, d: float) -> ComplexArray:
    """The mean rate of exp(lambda s) over `d`, s, and the means of its second rate, weighted by the share of the time
    that is left, and by the share that has passed; for roots of any shape, shape ``(3, ...)``."""
    x = roots * d
    slow = np.abs(x) <= 1
    waves = np.exp(np.multiply.outer(np.where(slow, x, 0.0), _POINTS))
    mean = np.where(slow, roots * (waves @ _WEIGHTS), 0.0)
    early, late = (roots**2 * (waves @ (share * _WEIGHTS)) for share in (1 - _POINTS, _POINTS))
    if not slow.all():
        fast = ~slow
        r, e = roots[fast], np.exp(x[fast])
        mean[fast] = (e - 1) / d
        early[fast], late[fast] = (mean[fast] - r) / d, (r * e - mean[fast]) / d
    return np.array([mean, early, late])


@dataclass(frozen=True)
class _Arc:
    """An arc from (q, v) = `y`, ``(2 N,)``, at `start`, s, on, for `duration`, s."""

    it: OscillatorState
    start: float
    duration: float
    y: FloatArray
    waves: ComplexArray
    """exp(i theta) at the start, shape ``(H,)``."""
    after: ComplexArray
    """exp(i theta) at the end, shape ``(H,)``."""

    @cached_property
    def free(self) -> FloatArray:
        """The free motion at the start, ``(2 N,)``."""
        return self.y - self.it.answer(self.waves) - self.it.still(0.0)

    @cached_property
    def end(self) -> FloatArray:
        """(q, v) at the end, ``(2 N,)``."""
        flown = self.it.flown(self.duration, self.free[:, None])[:, 0]
        return np.asarray(flown + self.it.answer(self.after) + self.it.still(self.duration))

    @cached_property
    def rates(self) -> FloatArray:
        """d(q, v)/dt at the end, ``(2 N,)``."""
        return self.it.rates(self.after, self.end)

    def mean(self, row: int) -> _Mean:
        """Mean rate of the gap function of a row."""
        return self.it.mean(row, self.waves, self.free, self.duration)


@dataclass(frozen=True)
class CoupledArcs:
    """The arcs of a joint with damped stops."""

    joint: Joint
    _states: dict[ContactState, OscillatorState] = field(default_factory=dict, repr=False)
    _passages: dict[tuple[ContactState, ContactState], tuple[FloatArray, ComplexArray]] = field(
        default_factory=dict, repr=False
    )

    def chain(
        self, sequence: ContactSequence, start: FloatArray, time: float, durations: FloatArray, derivatives: bool
    ) -> Chain:
        """Follow arcs. See `lapjoint.orbits.arcs.Arcs.chain`; the derivative by a parameter is not known.

        Backwards in time fast modes grow: values that overflow are infinite or NaN.
        """
        stops = self.joint.loaded.problem.structure.stops
        rows = [row_of(stops, switch) for switch in sequence.stops]
        with np.errstate(over="ignore", invalid="ignore"):
            arcs = self._arcs(sequence, start, time, durations)
            events = np.array([_equation(arcs, i, row, sequence) for i, row in enumerate(rows)])
            end_by, events_by = self._derivatives(sequence, arcs, rows) if derivatives else (None, None)
            end = arcs[-1].end
        return Chain(
            tuple(arc.y for arc in arcs), np.array([arc.start for arc in arcs]), end, events, end_by, events_by
        )

    def _state(self, state: ContactState) -> OscillatorState:
        if state not in self._states:
            self._states[state] = OscillatorState(self.joint, state)
        return self._states[state]

    def _passage(self, old: ContactState, new: ContactState) -> tuple[FloatArray, ComplexArray]:
        if (old, new) not in self._passages:
            self._passages[old, new] = self.joint.whole_passage(old, new)
        return self._passages[old, new]

    def _waves(self, t: float) -> ComplexArray:
        return np.asarray(np.exp(1j * self.joint.harmonics.theta(t)))

    def _arcs(self, sequence: ContactSequence, start: FloatArray, time: float, durations: FloatArray) -> list[_Arc]:
        arcs, y, t, before = list[_Arc](), start, time, None
        waves = self._waves(t)
        for state, duration in zip(sequence.states, durations.tolist(), strict=True):
            if before is not None:
                W, load = self._passage(before, state)
                y = W @ arcs[-1].end + load[0].real + (waves @ load[1:]).imag
            after = self._waves(t + duration)
            arcs.append(_Arc(self._state(state), t, duration, y, waves, after))
            waves, before = after, state
            t += duration
        return arcs

    def _derivatives(
        self, sequence: ContactSequence, arcs: list[_Arc], rows: list[int]
    ) -> tuple[FloatArray, FloatArray]:
        """Derivatives of the end and of the events, ``(2 N_end, 2 N + M + 1)`` and ``(M, 2 N + M + 1)``."""
        n, states, turning = arcs[0].y.size, sequence.states, 1j * self.joint.harmonics.omega
        here = before = there = np.eye(n, n + len(arcs))
        events = np.zeros((len(rows), here.shape[1]))
        for i, arc in enumerate(arcs):
            end = n + i
            if i:
                W, load = self._passage(states[i - 1], states[i])
                before, here = here, W @ there
                here[:, end - 1] += W @ arcs[i - 1].rates + ((turning * arc.waves) @ load[1:]).imag
                here[:, end - 1] -= arc.it.rates(arc.waves, arc.y)
            there = arc.it.flown(arc.duration, here)
            if i == len(rows):
                break
            if sequence.joining[i]:
                events[i] = _joined(arcs[i - 1], arc, rows[i], (before, here), end)
            elif sequence.returning[i]:
                events[i] = _returned(arc.mean(rows[i]), here, end)
            else:
                events[i] = arc.it.reading(rows[i]) @ there
                events[i, end] += arc.it.gap_rate(rows[i], arc.after, arc.rates)
        there[:, -1] = arcs[-1].rates
        return _by_durations(there, n), _by_durations(events, n)


def _equation(arcs: list[_Arc], i: int, row: int, sequence: ContactSequence) -> float:
    """Left side of the equation of an event, m or m/s."""
    arc = arcs[i]
    if sequence.joining[i]:
        w = _weight(arcs[i - 1].duration, arc.duration)
        return w * arcs[i - 1].mean(row).value + (1 - w) * arc.mean(row).value
    return arc.mean(row).value if sequence.returning[i] else arc.it.gap_function(row, arc.after, arc.end)


def _weight(p: float, r: float) -> float:
    """Weight w of the first of two arcs of durations `p` and `r`, s; see `lapjoint.orbits.arcs`."""
    both = abs(p) + abs(r)
    return abs(p) / both if both > 0 else 0.5


def _returned(mean: _Mean, here: FloatArray, end: int) -> FloatArray:
    """Derivatives of a mean rate over an arc; `here`, ``(2 N, m)``, are the deviations at its start, and `end` is the
    column of the time of its end."""
    columns = mean.by_start @ here
    columns[end - 1] += mean.early
    columns[end] += mean.late
    return np.asarray(columns)


def _joined(one: _Arc, two: _Arc, row: int, starts: tuple[FloatArray, FloatArray], end: int) -> FloatArray:
    """Derivatives of the equation that joins two arcs, by the columns of `CoupledArcs._derivatives`; `starts` are the
    deviations at the starts of both."""
    w, first, second = _weight(one.duration, two.duration), one.mean(row), two.mean(row)
    columns = w * _returned(first, starts[0], end - 1) + (1 - w) * _returned(second, starts[1], end)
    alike = -1.0 if one.duration * two.duration < 0 else 1.0
    by_p = -(1 - w) * (w * first.late + alike * (1 - w) * second.early)
    by_r = w * (alike * w * first.late + (1 - w) * second.early)
    columns[end - 2 : end + 1] += [-by_p, by_p - by_r, by_r]
    return columns


def _by_durations(columns: FloatArray, n: int) -> FloatArray:
    """Derivatives by ``n`` coordinates and by the durations, from those by the ends of arcs."""
    return np.concatenate([columns[:, :n], np.cumsum(columns[:, n:][:, ::-1], axis=1)[:, ::-1]], axis=1)
