r"""Contact states whose damping couples the modes, which are turned into oscillators again.

In the modes of the closed stops, of frequencies omega_i and values phi_ik at stop k, the motion obeys

    q'' + D q' + K q = f(t),
    D = D_0             + sum over pressing stops of c_k phi_k phi_k^T,
    K = diag(omega_i^2) - sum over released stops of k_k phi_k phi_k^T,

because a pressing stop adds its damper, and a released stop takes back its spring, which the modes contain.  D_0 is
diag(2 zeta_i omega_i), and the matrix of `analytic.march.drag` where damping couples the modes of all states.
The shapes that the modes leave out move with the loads; their share of damper and spring forces belongs to f.

Each pair of roots lambda of the homogeneous equation is one oscillator.  With the amplitude a(t) of its eigenvector,
P = Re a and V = P' obey P'' - 2 Re(lambda) P' + |lambda|^2 P = F(t), and

    (q, q') = T (P, V - r(t)),    r = Re of the share of the loads in a',    F = s + d r + r',

where s is the share of the loads in (Re lambda a)' and d = -(lambda_1 + lambda_2).  The march therefore knows (P, V) of
a coupled state as it knows (q, v) of any other.  A place reads P and V, so its weight of a complex term is complex.

The force of a stop divided by k is the penetration at a virtual place, which moves by z + (c / k) z'.  Each damped stop
has a second row in the tables, with that place: a closed second row presses.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import scipy.linalg

from analytic.march.drag import drag_of
from analytic.march.modal_state import LoadedStructure, modal_state, passage
from analytic.march.oscillator import (
    SPLIT,
    all_away_from_resonance,
    kinds_of,
    may_resonate,
    static_answer,
)
from analytic.march.tables import IntArray, Tables, moves_stops, seen_motion, stop_positions, tabulated_steps
from analytic.modes.beam_functions import ComplexArray
from lapjoint.answers.contact_state import ContactState
from lapjoint.machine.result_cache import cached
from lapjoint.problem import FloatArray, Problem

_RIGID = 1e-8
"""Squared frequency, relative to those of the modes, below which a state counts as free to move: the restoring force
then is below 1e-8 of the spring's, and answers to constant loads keep half of their digits above it."""
_UNDAMPED = 1e-12
"""Damping of a motion that no spring holds, relative to the largest of such motions, below which it is rounding: the
motion then drifts."""
_LITTLE = float(np.finfo(float).eps) ** (2 / 3)
"""Relative change of the damping near a double root, 4e-11: it parts the roots by its square root.  The condition
number of the eigenvectors becomes the inverse of that, and rounding times this number as small as the change."""
_NEARLY_DOUBLE = _LITTLE**-0.5
"""Condition number of the eigenvectors above which the damping is changed a little."""
SAMPLED = 1j
"""The turning of a sampled load, as that of a harmonic is i Omega: of two numbers for a sampled load, the real part is
that of the load, the imaginary part that of its rate."""
_TRIES = 8  # most such changes, each twice the one before
_PASSAGES = 1024  # maps kept: a state has twice as many passages as without damping
_STATES = 256  # states whose oscillators are kept, as in `analytic.march.modal_state`


@dataclass(frozen=True, eq=False)
class Coupled:
    """The oscillators of a coupled state with ``N`` modes, under unit loads.

    What a load does is a polynomial in its turning s, the time derivative of the load divided by the load, 1/s: 0 for
    the constant load, i Omega for a harmonic, and `SAMPLED` for a sampled load.  `lag`, `carried`, `push` and `beside`
    hold the coefficients of 1, s and, in `push`, s^2.
    """

    roots: ComplexArray
    """lambda of both roots of each oscillator, 1/s, shape ``(N, 2)``."""
    frame: Frame
    """What the tables hold of the state whatever the loads are."""
    to: FloatArray
    """T: (q, v) for unit (P, R), shape ``(2 N, 2 N)``."""
    back: FloatArray
    """The inverse of T."""
    lag: FloatArray
    """r, kg^1/2 m/s for each unit of load, shape ``(2, 1 + H + R, N)``."""
    carried: FloatArray
    """`lag` without the rates of sampled loads, which jump at knots: a march along ramps carries V less their part of r
    from segment to segment, see `analytic.march.ramps`."""
    push: FloatArray
    """F, kg^1/2 m/s^2 for each unit of load, shape ``(3, 1 + H + R, N)``; the rate of a sampled load's rate, which is
    not s^2 times the load, adds its `lag`."""
    beside: FloatArray
    """What the places see beside P and V, m for each unit of load, shape ``(2, U, 1 + H + R)``."""
    D: FloatArray
    """The damping matrix of the modes, 1/s, shape ``(N, N)``."""
    resonant: bool
    """Whether `coupled` may move a root."""

    @property
    def damping(self) -> FloatArray:
        """Twice the damping rates, 1/s, shape ``(N,)``."""
        return np.asarray(-self.roots.sum(axis=1).real)

    @property
    def stiffness(self) -> FloatArray:
        """Squared frequencies, 1/s2, shape ``(N,)``."""
        return np.asarray(
            np.where(self.roots.imag[:, 0] > 0, np.abs(self.roots[:, 0]) ** 2, self.roots.prod(axis=1).real)
        )


def damped_rows(problem: Problem) -> IntArray:
    """The stop of each second row of the tables: of all stops with damping, ascending, shape ``(D,)``."""
    return np.array([k for k, stop in enumerate(problem.structure.stops) if stop.damping > 0], dtype=np.int64)


def force_rows(problem: Problem) -> IntArray:
    """The row of the tables whose penetration times the stiffness is each stop's force, shape ``(P,)``."""
    rows = np.arange(len(problem.structure.stops))
    damped = damped_rows(problem)
    rows[damped] = len(problem.structure.stops) + np.arange(damped.size)
    return rows


def kept_by_force(problem: Problem, state: ContactState) -> set[int]:
    """The stops whose gaps cannot switch while the damped stops press as in a state: their own, and those opposite.

    A force that may not pull ends before its gap opens, and beyond that gap the gap of a stop on the other side of the
    same place is open.
    """
    stops, found = problem.structure.stops, set[int]()
    for k in state.closed:
        it = stops[k]
        if it.damping > 0 and not it.may_pull and k not in state.released:
            opposite = (i for i, other in enumerate(stops) if other.place == it.place and other.sign != it.sign)
            found |= {k, *(i for i in opposite if stops[i].gap + it.gap > 0 and i not in state)}
    return found


def is_coupled(problem: Problem, state: ContactState) -> bool:
    """Whether a damped stop is closed, or damping couples the modes of every state."""
    return problem.structure.couples or any(problem.structure.stops[k].damping > 0 for k in state.closed)


def oscillators(D: FloatArray, K: FloatArray, scale: FloatArray) -> tuple[ComplexArray, FloatArray, FloatArray]:
    """Roots ``(N, 2)``, T and its inverse ``(2 N, 2 N)`` of q'' + D q' + K q = 0, of symmetric matrices.

    `scale`, rad/s, ``(N,)``, is a positive frequency of each coordinate.
    """
    values, vectors = np.linalg.eigh(K / np.outer(scale, scale))
    null = values < _RIGID
    if not null.any():
        return _of_stiff(D, K, scale, 0)
    r = int(np.count_nonzero(null))
    B = np.linalg.qr(np.concatenate([vectors[:, null] / scale[:, None], np.eye(K.shape[0])], axis=1))[0]
    turned, drag = B.T @ K @ B, B.T @ D @ B
    turned[:r] = turned[:, :r] = 0.0
    n = K.shape[0] - r
    least = np.concatenate([np.full(r, scale.min()), np.sqrt(np.maximum(np.diag(turned)[r:], scale.min() ** 2))])
    damping, directions = np.linalg.eigh(drag[:r, :r])
    free = int(np.count_nonzero(damping <= max(_UNDAMPED * damping.max(), 1e-13 * scale.min())))
    turn = scipy.linalg.block_diag(directions, np.eye(n))
    B, drag = B @ turn, turn.T @ drag @ turn
    roots, to, back = np.zeros((free, 2), dtype=complex), np.eye(2 * free), np.eye(2 * free)
    if free < K.shape[0]:
        others, its, inverse = _of_stiff(drag[free:, free:], turned[free:, free:], least[free:], r - free)
        roots, to, back = np.concatenate([roots, others]), _beside(to, its), _beside(back, inverse)
    both = scipy.linalg.block_diag(B, B)
    return roots, both @ to, back @ both.T


def _beside(one: FloatArray, other: FloatArray) -> FloatArray:
    """Two maps of (q, v) as one, of the coordinates of both."""
    a, b = one.shape[0] // 2, other.shape[0] // 2
    whole = scipy.linalg.block_diag(one, other)
    order = np.r_[0:a, 2 * a : 2 * a + b, a : 2 * a, 2 * a + b : 2 * (a + b)]
    return np.asarray(whole[np.ix_(order, order)])


def _of_stiff(
    D: FloatArray, K: FloatArray, scale: FloatArray, zeros: int
) -> tuple[ComplexArray, FloatArray, FloatArray]:
    """`oscillators` of a matrix K, of which `zeros` eigenvalues are 0."""
    n = scale.size
    A = np.block([[np.zeros((n, n)), np.diag(scale)], [-K / scale, -D]])
    w, V = scipy.linalg.eig(A)
    w[np.argsort(np.abs(w))[:zeros]] = 0.0
    columns: list[tuple[complex, complex, FloatArray, FloatArray]] = []
    for j in np.flatnonzero(w.imag > 0):
        v = V[:, j] / np.linalg.norm(V[:n, j] / scale)
        q = v[:n] / scale
        v = v * np.exp(-0.5j * np.angle(np.sum(q * q)))
        v = v * np.sign(v.real[np.argmax(np.abs(v.real[:n]))])  # neighbouring problems share the sign
        a, b = w[j].real, w[j].imag
        columns.append((w[j], w[j].conjugate(), v.real - a / b * v.imag, v.imag / b))
    real = np.flatnonzero(w.imag == 0)
    real = real[np.argsort(-w[real].real)]
    for i, j in zip(real[: real.size // 2], real[real.size // 2 :], strict=True):
        one, other = (V[:, k].real / np.linalg.norm(V[:n, k].real / scale) for k in (i, j))
        one = one * np.sign(one[np.argmax(np.abs(one[:n]))])
        other = other if one[:n] @ (other[:n] / scale**2) >= 0 else -other
        first, second = w[i].real, w[j].real
        columns.append(
            (w[i], w[j], (first * other - second * one) / (first - second), (one - other) / (first - second))
        )
    columns.sort(key=lambda it: abs(it[0] * it[1]))
    roots = np.array([it[:2] for it in columns])
    size = np.maximum(np.sqrt(np.abs(roots.prod(axis=1))), np.abs(roots).max(axis=1))
    to = np.array([it[2] for it in columns] + [it[3] * s for it, s in zip(columns, size, strict=True)]).T
    rows, cols = np.concatenate([scale, np.ones(n)]), np.concatenate([np.ones(n), size])
    back = np.linalg.inv(to)
    return roots, to / np.outer(rows, cols), back * np.outer(cols, rows)


@cached(_STATES)
def free_oscillators(
    loaded: LoadedStructure, state: ContactState, count: int
) -> tuple[ComplexArray, FloatArray, FloatArray, FloatArray]:
    """The `oscillators` of a state with `count` modes, and its damping matrix, 1/s, ``(N, N)``.

    They do not depend on the excitation, and are not to be written to.
    """
    problem, closed = loaded.problem, ContactState(state.closed)
    modal = modal_state(loaded, closed, count)
    omega, n = modal.modes.omega, modal.size
    scale = np.where(omega > 0, omega, omega[omega > 0].min(initial=np.inf))
    scale = np.where(np.isfinite(scale), scale, np.sqrt(problem.line.EI / problem.line.m) / problem.line.length**2)
    K, coupling = np.diag(omega**2), np.zeros((n, n))
    if problem.structure.couples:
        coupling += drag_of(loaded, closed, count).D
    for k in state.closed:
        stop, phi = problem.structure.stops[k], modal.at_stops[k]
        if k in state.released:
            K -= stop.stiffness * np.outer(phi, phi)
        elif stop.damping > 0:
            coupling += stop.damping * np.outer(phi, phi)
    own = np.diag(2 * modal.damping_rate)
    for i in range(_TRIES):
        more = _LITTLE * 2**i if i else 0.0
        roots, to, back = oscillators((own + coupling) * (1 + more), K, scale)
        if i == 0:
            best = roots, to, back
        if _condition(roots, to, scale) < _NEARLY_DOUBLE:
            best = roots, to, back
            break
    return *best, own + coupling


@cached(_PASSAGES)
def whole_passage(
    loaded: LoadedStructure, old: ContactState, n_old: int, new: ContactState, n_new: int
) -> tuple[FloatArray, FloatArray]:
    """The map of the coordinates from one state to another, ``(2 N_new, 2 N_old)``, of which either may be coupled.

    Beside it the part that unit loads bring, ``(2, 1 + H + R, 2 N_new)``: coefficients as in `Coupled`.
    """
    S, left_out = np.eye(n_new, n_old), np.zeros((1 + len(loaded.positions), n_new))
    if old.closed != new.closed:
        between = passage(loaded, old.pressed, n_old, new.pressed, n_new)
        S, left_out = between.S, between.residual
    both, still = scipy.linalg.block_diag(S, S), np.zeros_like(left_out)
    load = np.array([np.concatenate(parts, axis=1) for parts in ((left_out, still), (still, left_out))])
    if is_coupled(loaded.problem, old):
        before = coupled_at_rest(loaded, old, n_old)
        load -= before.carried @ (before.to[:, n_old:].T @ both.T)
        both = both @ before.to
    if is_coupled(loaded.problem, new):
        after = coupled_at_rest(loaded, new, n_new)
        both, load = after.back @ both, load @ after.back.T
        load[..., n_new:] += after.carried
    return np.asarray(both), load


def coupled(loaded: LoadedStructure, state: ContactState, count: int, driven: FloatArray, side: float) -> Coupled:
    """The oscillators of a state with `count` modes, for harmonic loads of frequencies `driven`, rad/s, ``(H,)``.

    `side` is as in `analytic.march.oscillator.away_from_resonance`.
    """
    it = coupled_at_rest(loaded, state, count)
    if not it.resonant:
        return it
    roots = _detuned(it.roots, driven, side)
    return it if np.array_equal(roots, it.roots) else _coupled(loaded, state, count, roots)


@cached(_STATES)
def coupled_at_rest(loaded: LoadedStructure, state: ContactState, count: int) -> Coupled:
    """The oscillators of a state none of which a load has moved; not to be written to."""
    return _coupled(loaded, state, count, free_oscillators(loaded, state, count)[0])


def _coupled(loaded: LoadedStructure, state: ContactState, count: int, roots: ComplexArray) -> Coupled:
    """The oscillators of a state with given roots, 1/s, ``(N, 2)``."""
    problem, closed, n = loaded.problem, ContactState(state.closed), count
    modal = modal_state(loaded, closed, count)
    left_out = modal.residual_at_stops + seen_motion(loaded)
    f = np.array([modal.force, np.zeros_like(modal.force)])
    if problem.structure.couples:
        f[1] -= drag_of(loaded, closed, count).left_out
    for k in state.closed:
        stop, phi = problem.structure.stops[k], modal.at_stops[k]
        if k in state.released:
            f[0] += stop.stiffness * np.outer(left_out[:, k], phi)
            f[0, 0] -= stop.stiffness * stop.sign * stop.gap * phi
        elif stop.damping > 0:
            f[1] -= stop.damping * np.outer(left_out[:, k], phi)
    _, to, back, D = free_oscillators(loaded, state, count)
    by = _frame_of(loaded, state, count, roots, to)
    lag, rise = f @ back[:n, n:].T, f @ back[n:, n:].T
    moved, sampled = moves_stops(loaded), np.arange(modal.force.shape[0]) > len(loaded.positions) - loaded.sampled
    adrift = (roots == 0).all(axis=1)  # a motion that no spring holds does not feel that stops move
    lag[:, np.outer(moved, adrift)] = rise[:, np.outer(moved, adrift)] = 0.0
    push = np.zeros((3, *lag.shape[1:]))
    push[:2] = rise - roots.sum(axis=1).real * lag
    push[1:] += lag
    push[0, np.outer(moved, roots.prod(axis=1) == 0)] = 0.0
    carried = lag.copy()
    push[2, sampled] = carried[1, sampled] = 0.0
    seen = left_out[:, _of_places(problem)].T
    beside = np.array([seen, by.delay[:, None] * seen]) - by.reads[:, 1] @ lag.transpose(0, 2, 1)
    ringing = roots[roots.imag[:, 0] > 0, 0]
    return Coupled(roots, by, to, back, lag, carried, push, beside, D, may_resonate(np.abs(ringing), -ringing.real))


def _detuned(roots: ComplexArray, driven: FloatArray, side: float) -> ComplexArray:
    """Roots, ``(N, 2)``, of which those without damping are kept away from the loads' frequencies, rad/s, ``(H,)``."""
    rings = np.flatnonzero(roots.imag[:, 0] > 0)
    natural, rate = np.abs(roots[rings, 0]), -roots[rings, 0].real
    moved = all_away_from_resonance(natural, rate, driven, side)
    found, which = roots.copy(), moved != natural
    turn = 1j * np.sqrt(moved[which] ** 2 - rate[which] ** 2)
    found[rings[which]] = np.stack([turn, -turn], axis=1) - rate[which, None]
    return found


class Frame(NamedTuple):
    """What the tables hold of a coupled state whatever the loads are: ``N`` oscillators, ``T`` terms, ``U`` places."""

    kind: IntArray
    """How each oscillator moves freely, shape ``(N,)``."""
    mode_of: IntArray
    """The oscillator of each term, shape ``(T,)``."""
    root: ComplexArray
    """lambda of each term, 1/s, shape ``(T,)``."""
    inverse: ComplexArray
    """1 / lambda, s, or 0 where lambda is 0, shape ``(T,)``."""
    turn: ComplexArray
    """exp(lambda tau) of the tabulated steps, shape ``(J, T)``."""
    reads: FloatArray
    """Weights of P and V at the places, kg^-1/2 and kg^-1/2 s, shape ``(U, 2, N)``."""
    weight: ComplexArray
    """Weight of each term at the places, kg^-1/2, shape ``(U, T)``."""
    delay: FloatArray
    """c / k of the places that forces see, and 0 of the others, s, shape ``(U,)``."""


def _frame_of(loaded: LoadedStructure, state: ContactState, count: int, roots: ComplexArray, to: FloatArray) -> Frame:
    """The frame of a state with roots, 1/s, ``(N, 2)``, and T, ``(2 N, 2 N)``."""
    problem, n, kind = loaded.problem, count, kinds_of(roots)
    split = np.flatnonzero(kind == SPLIT)
    mode_of, root = np.concatenate([np.arange(n), split]), np.concatenate([roots[:, 0], roots[split, 1]])
    stops = _of_places(problem)
    tau = np.array([problem.structure.stops[k].damping / problem.structure.stops[k].stiffness for k in stops.tolist()])
    tau[: stops.size - damped_rows(problem).size] = 0.0
    phi = modal_state(loaded, ContactState(state.closed), count).at_stops[stops]
    reads = np.concatenate([phi, tau[:, None] * phi], axis=1) @ to
    return Frame(
        kind,
        mode_of,
        root,
        np.divide(1.0, root, out=np.zeros(root.size, dtype=complex), where=root != 0),
        np.exp(np.outer(tabulated_steps(problem), root)),
        reads.reshape(-1, 2, n),
        reads[:, mode_of] + reads[:, n + mode_of] * root,
        tau,
    )


def _of_places(problem: Problem) -> IntArray:
    """A stop that sees each place: places of gaps, and then those of forces, shape ``(U,)``."""
    return np.concatenate([np.unique(stop_positions(problem), return_index=True)[1], damped_rows(problem)])


def _condition(roots: ComplexArray, to: FloatArray, scale: FloatArray) -> float:
    """Condition number of the eigenvectors, without unit: that of T in coordinates of one size, times the most that the
    two eigenvectors of an oscillator add to it, the larger root over half of the difference."""
    n = scale.size
    sized = to * np.concatenate([scale, np.ones(n)])[:, None]
    sized = sized / np.linalg.norm(sized, axis=0)
    moving = roots[np.any(roots != 0, axis=1)]
    apart = np.abs(moving[:, 0] - moving[:, 1]) / (2 * np.abs(moving).max(axis=1))
    return float(np.linalg.cond(sized) / apart.min(initial=1.0))


def write_coupled(tables: Tables, slot: int, problem: Problem, state: ContactState, it: Coupled) -> None:
    """Write a coupled state into its empty slot, but for what it owes to loads that change with time."""
    P, by = len(problem.structure.stops), it.frame
    n, terms = by.kind.size, by.root.size
    tables.modes[slot], tables.terms[slot], tables.coupled[slot] = n, terms, True
    tables.fastest[slot] = np.abs(by.root).max()
    tables.kind[slot, :n], tables.mode_of[slot, :terms], tables.root[slot, :terms] = by.kind, by.mode_of, by.root
    tables.inverse[slot, :terms], tables.turn[slot, :, :terms] = by.inverse, by.turn
    tables.cube[slot, :terms] = np.abs(by.root) ** 3
    tables.gradient[slot, :, :, :n] = by.reads
    tables.weight[slot, :, :terms], tables.twist[slot, :, :terms] = by.weight.real, by.weight.imag
    tables.static[slot, :n] = static_answer(it.push[0, 0], np.sqrt(it.stiffness), it.damping / 2)
    tables.constant[slot] = it.beside[0, :, 0]
    tables.closed[slot, :P] = [k in state for k in range(P)]
    for row, k in enumerate(damped_rows(problem).tolist(), start=P):
        tables.closed[slot, row] = k in state and k not in state.released
        tables.asleep[slot, row] = k not in state or problem.structure.stops[k].may_pull
    tables.asleep[slot, list(kept_by_force(problem, state))] = True


def write_still(tables: Tables, slot: int) -> None:
    """Write z at the positions under the constant loads, where damped stops may couple a state, to its filled slot."""
    static, (by_q, by_v) = tables.static[slot], tables.gradient[slot].transpose(1, 0, 2)
    tables.still[slot] = by_q @ static
    tables.still[slot, :, :2] += by_v @ (static[:, 1:] * [1.0, 2.0])
    tables.still[slot, :, 0] += tables.constant[slot]
