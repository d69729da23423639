"""The settings of a summary: the time left out at the start, the length of a unit, and the sampling rate."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from lapjoint.answers.contact_state import FREE
from lapjoint.answers.history import History
from lapjoint.answers.modes import Modes
from lapjoint.errors import InputError
from lapjoint.problem import FloatArray, ModalDamping, Problem
from lapjoint.problem.damping import ROUNDED
from lapjoint.solver import Progress, Solver, Streams
from lapjoint.summaries.collector import Collector
from lapjoint.summaries.quantities import Selection
from lapjoint.summaries.sums import Sums

SETTLED = 7.0
"""Default time left out at the start, in decay times of the slowest mode: a thousandth of the initial motion is then
left."""
LONG = 20.0
"""Least length of a unit, in decay times of the slowest mode, with which neighbouring units are nearly independent."""
UNITS = 32
"""Number of units of all realisations together, from which confidence intervals follow."""
ENOUGH = 8
"""Number of units below which a remark says that the intervals are wide because there are few units."""
SAMPLES_A_PERIOD = 16
"""Default number of samples in a period of the slowest mode."""
LEAST_SAMPLES = 4096
"""Least default number of samples of a motion."""
LEAST_IN_UNIT = 16
"""Least number of samples in a unit."""
MOST_SAMPLES = 1e10
"""Largest number of samples of a motion, which takes a day to compute."""
_MODES = 8
"""Number of the lowest modes of the free joint among which the mode with the slowest decay is found."""
_PANELS, _NODES = 16, 8
"""Panels of the beam, and Gauss points in each, for products of these modes: ten digits."""


@dataclass(frozen=True)
class Measure:
    """The settings of a summary."""

    selection: Selection
    """The quantities and places."""
    duration: float
    """Duration of each motion, s, the start included."""
    settle: float
    """Duration of the start that is left out, s."""
    units: int
    """Number of units of each motion."""
    rate: float
    """Samples a second, Hz."""
    decay_time: float
    """Time in which the slowest mode falls by a factor e, s; infinite without damping."""

    @property
    def unit(self) -> float:
        """Duration of a unit, s."""
        return (self.duration - self.settle) / self.units


def measure(
    selection: Selection,
    solver: Solver,
    duration: float,
    *,
    seeds: int = 1,
    settle: float | None = None,
    rate: float | None = None,
) -> Measure:
    """The settings of a summary of `seeds` motions of a duration, s.

    By default, `settle` is `SETTLED` decay times of the slowest mode, and the rate gives `SAMPLES_A_PERIOD` samples in
    a period of the slowest mode.
    """
    problem = selection.problem
    problem.check_duration(duration)
    slowest, decay = _slowest(problem, solver)
    if settle is None:
        if not decay:
            raise InputError("settle: is missing; nothing is damped here, so no time is long enough by itself")
        settle = SETTLED / decay
    if not 0 <= settle < math.inf:
        raise InputError(f"settle = {settle:g}: must be zero or positive, and finite, in s")
    left = duration - settle
    if not left > 0:
        raise InputError(f"duration = {duration:g}: must be longer than the {settle:.6g} s that are left out (settle)")
    if rate is None:
        rate = max(SAMPLES_A_PERIOD * slowest / (2 * math.pi), LEAST_SAMPLES / left)
    if not 0 < rate < math.inf:
        raise InputError(f"rate = {rate:g}: must be positive and finite, in Hz")
    if rate * duration > MOST_SAMPLES:
        raise InputError(
            f"rate = {rate:g} Hz: gives {rate * duration:.3g} samples of a motion; at most {MOST_SAMPLES:g} are allowed"
        )
    most = math.ceil(UNITS / seeds)
    units = max(1, min(most, math.floor(left * decay / LONG))) if decay else most
    if rate * left < units * LEAST_IN_UNIT:
        raise InputError(
            f"rate = {rate:g} Hz: gives {rate * left / units:.3g} samples in each of {units} units; needed are "
            f"{LEAST_IN_UNIT} or more"
        )
    return Measure(selection, duration, settle, units, rate, 1 / decay if decay else math.inf)


def duration_of(problem: Problem, solver: Solver, units: int) -> float:
    """The duration, s, that the default start and some units of `LONG` decay times fill; infinite without damping."""
    _, decay = _slowest(problem, solver)
    return (SETTLED + units * LONG) / decay if decay else math.inf


def sums_of(what: Measure, solver: Solver, problem: Problem, progress: Progress | None = None) -> Sums:
    """The sums over all units of the motion of a problem, of one realisation of its excitation."""
    collector = Collector(what.selection, what.settle, what.duration, what.units, what.rate)
    for stretch in _stretches(solver, problem, what.duration, progress):
        collector.take(stretch)
    return collector.finish()


def _stretches(solver: Solver, problem: Problem, duration: float, progress: Progress | None) -> Iterator[History]:
    """The motion in stretches; in a single stretch if the solver gives no others."""
    if isinstance(solver, Streams):
        yield from solver.stream(problem, duration, progress=progress)
    else:
        yield solver.simulate(problem, duration, errors=False, progress=progress)


def _slowest(problem: Problem, solver: Solver) -> tuple[float, float]:
    """The lowest angular frequency, rad/s, and the lowest rate of decay, 1/s, of the free joint; 0 if there is none.

    The lowest modes are enough: higher modes do not decay more slowly under viscous damping, or modal damping of one
    ratio.  Where damping couples the modes, the rates are those of the lowest modes together.
    """
    modes = _lowest_modes(problem, solver)
    omega = np.asarray(modes.angular_frequencies, dtype=float)
    structure, damping = problem.structure, problem.damping
    bends = np.arange(omega.size) >= structure.free_motions
    own = np.full(omega.size, structure.even_decay)
    if isinstance(damping, ModalDamping):
        own += damping.ratios(omega.size) * omega
    if structure.couples:
        rates = _coupled_rates(problem, modes, own)
    else:
        rates = (own - np.sqrt(np.maximum(own**2 - omega**2, 0.0)))[bends]
    slow = rates[rates > 0]
    return float(omega[bends].min()), float(slow.min()) if slow.size else 0.0


def _coupled_rates(problem: Problem, modes: Modes, own: FloatArray) -> FloatArray:
    """Rates of decay, 1/s, of modes that damping couples, but for rigid-body motions at rest; `own`, 1/s, ``(n,)``, are
    the rates of the damping that couples none.  A rate of 0 is that of a mode without damping."""
    nodes, weights = np.polynomial.legendre.leggauss(_NODES)
    edges = problem.line.grid(_PANELS + 1)
    edges = np.union1d(edges, [piece.end for piece in problem.line.pieces])
    half = np.diff(edges)[:, None] / 2
    x = (edges[:-1, None] + half * (1 + nodes)).ravel()
    shapes, along = modes.shapes(x), np.zeros(x.size)
    for start, end, C in problem.structure.coupling_drag:
        along += C * ((x > start) & (x < end))
    D = np.diag(2 * own) + (shapes * along * (half * weights).ravel()) @ shapes.T
    for it in problem.structure.dampers:
        moved = np.diff(modes.shapes(np.array([it.first, it.second]), it.derivative))[:, 0]
        D += it.damping * np.outer(moved, moved)
    turn, n = np.diag(modes.angular_frequencies), D.shape[0]
    roots = np.linalg.eigvals(np.block([[np.zeros((n, n)), turn], [-turn, -D]]))
    rates = -roots[np.argsort(np.abs(roots))[problem.structure.free_motions :]].real
    return np.asarray(np.where(rates > ROUNDED * np.abs(roots).max(), rates, 0.0))


def _lowest_modes(problem: Problem, solver: Solver) -> Modes:
    """The lowest modes: `_MODES` of them, or all modes of a coarse solver if it has fewer."""
    for count in (_MODES, _MODES // 2, _MODES // 4):
        try:
            return solver.modes(problem, FREE, count)
        except InputError:
            continue
    return solver.modes(problem, FREE, 1)
