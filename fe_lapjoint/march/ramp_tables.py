r"""A contact state under sampled forces, as amplitudes of its own exponentials: tables for the compiled march.

In any state, damped as it may be, the free motions of `fe_lapjoint.march.coupled.Exponentials` have amplitudes c with

    c' = r c + b(t),

where b are the loads on each amplitude.  Sampled forces are linear between two knots.  The displacement y of the base
is a cubic there; closed stops fixed in space push with -k y - c y', and the gaps of all stops fixed in space see y.
While b is a polynomial in time, c = a exp(r s) + p(s) with

    p = -(b / r + b' / r^2 + b'' / r^3 + b''' / r^4).

p is a sum of huge numbers where a real rate is slow, as that of a free bar with little drag is.  The amplitudes of such
rates are integrals of fading exponentials instead, see `fe_lapjoint.march.ramp_interval`.  Displacements of rigid-body
modes are integrals of their velocities: less what the other terms share in them, they are polynomials in time, and
what the slow terms add.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple, TypeAlias

import numpy as np
import numpy.typing as npt
import scipy.sparse

from fe_lapjoint.march.coupled import Coupled
from fe_lapjoint.march.exponentials import Exponentials
from fe_lapjoint.march.system import ComplexArray, IndexArray, System
from lapjoint.compiled.by_reference import by_reference, in_c_order
from lapjoint.compiled.compiling import njit_called
from lapjoint.problem import FloatArray
from lapjoint.problem.ramps import Ramps

RealMatrix: TypeAlias = FloatArray | scipy.sparse.csr_array
_APART = 1e-5
"""A critically damped mode turns with this fraction of its damping rate; its motion changes by 1e-10 of itself at most.
The imaginary part of its amplitude is 1e5 times its motion, but it and its rounding error turn as little."""
_NEAR = 0.5
"""Turn of a mode, as a fraction of its damping rate, below which its amplitude is a poor bound of its motion."""


@by_reference
class RampTables(NamedTuple):
    """A contact state with ``P`` stops at ``p`` places, ``T`` terms, ``J`` slow terms and ``r`` rigid-body modes.

    There are ``H`` harmonic loads, and ``m = T + H`` rates.  Of the ``L`` other loads the first is constant, 1, the
    next ``R`` are the sampled forces, and then follow y and y' of the base if stops see it.  They have ``d``
    derivatives: 2, or 4 with y.  ``b`` bounds hold for the terms, the harmonic loads and, where other parts of the
    motion of a place are bent, one for each place.
    """

    rates: ComplexArray
    """Rates of the terms and of the harmonic loads, 1/s, shape ``(m,)``."""
    swinging: FloatArray
    """Moduli of `rates`, 0 for nearly critical modes, 1/s, shape ``(m,)``."""
    turned: FloatArray
    """Share of an imaginary part, with its rounding error, that comes to be real, at most; shape ``(m,)``."""
    driven: FloatArray
    """Angular frequencies of the harmonic loads, rad/s, shape ``(H,)``."""
    phase: FloatArray
    """Phases of the harmonic loads, rad, shape ``(H,)``."""
    factors: ComplexArray
    """Factor of each term, and of each harmonic load, in the motion of the places, shape ``(p, m)``."""
    gain: ComplexArray
    """What each derivative of a load adds to p of a term, shape ``(T, L, d)``."""
    gain_at_places: FloatArray
    """What each derivative of a load adds to what the places see, m over units of the load, shape ``(p, L, d)``."""
    gain_sizes: FloatArray
    """The moduli of all parts of `gain_at_places`, added, shape ``(p, L, d)``."""
    drag: FloatArray
    """Rates at which the slow terms fall, 1/s, shape ``(J,)``."""
    slow_push: FloatArray
    """What each load does to the slow terms, shape ``(J, L)``."""
    slow_at_places: FloatArray
    """Factors of each slow term, and of its time integral, in the motion of the places, shape ``(p, J, 2)``."""
    body_push: FloatArray
    """What each load adds to the rate of displacement, and to that of speed, of each rigid-body mode, ``(r, 2, L)``."""
    body_slow: FloatArray
    """Speed of each rigid-body mode by each slow term, shape ``(r, J)``."""
    body_at_places: FloatArray
    """Factors of displacement and speed of the rigid-body modes in the motion of the places, shape ``(p, r, 2)``."""
    shares: FloatArray
    """Moduli of the factor of each bounded part in the motion of the places, shape ``(p, b)``."""
    fading: FloatArray
    """Rates at which the bounds fall, 1/s, shape ``(b,)``."""
    place_of: IndexArray
    """Which place each gap function reads, as `Model.rows` lists them."""
    force_place: IndexArray
    """Which place's penetration is the force of each stop over its stiffness, shape ``(P,)``."""
    orientation: FloatArray
    """Sign of z in each gap function, +1 or -1; see `Model.orientation`."""
    offset: FloatArray
    """Gap of each open stop, minus the gap of each closed one, m; see `Model.offset`."""
    window: float
    """Longest time for which one closed form is followed, s."""
    spacing: float
    """The usual time between knots, s; 0 without one."""
    whole: ComplexArray
    """exp(rate spacing) of each rate, shape ``(m,)``."""
    whole_areas: ComplexArray
    """The integral of exp(rate s) over `spacing`, s, shape ``(m,)``."""


@by_reference
class Knots(NamedTuple):
    """``K`` knots of ``R`` forces that are linear between them."""

    time: FloatArray
    """Times of the knots, s, ascending, shape ``(K,)``."""
    force: FloatArray
    """Forces at the knots, N or N/m, shape ``(K, R)``."""
    slope: FloatArray
    """Rate of each force from each knot to the next, N/s or N/(m s), shape ``(K - 1, R)``."""
    base: FloatArray
    """y of the base that stops see, and three derivatives, from each knot on, m over powers of s, ``(K - 1, 4)``;
    ``(0, 4)`` if no stop sees it."""


def knots_of(ramps: Ramps) -> Knots:
    """Sampled forces as the compiled march takes them."""
    base = np.zeros((0, 4)) if ramps.base is None else ramps.base_at(ramps.time[:-1]).T
    return in_c_order(Knots(ramps.time, ramps.force, ramps.slope, base))


@dataclass(frozen=True, eq=False)
class RampForm:
    """A contact state along ramps: its tables, and the way from (q, q') to its ``X = T + J + 2 r`` amplitudes and back.

    The amplitudes x are those of the terms and of the slow terms; of the rigid-body modes, displacements less what the
    terms share in them; and their speeds, less those of all terms.
    """

    system: System
    tables: RampTables
    into: RealMatrix
    """Real and imaginary parts of the amplitudes, in turn, for units of (q, q'), shape ``(2 X, 2 n)``."""
    out: RealMatrix
    """(q, q') for units of real and imaginary parts of the amplitudes, in turn, shape ``(2 n, 2 X)``."""

    def amplitudes(self, t: float, y: FloatArray) -> ComplexArray:
        """The amplitudes x at time `t`, s, from (q, q') there, shape ``(2 n,)``."""
        own = y if self._waves is None else y - (self._waves @ self._turned(np.array([t])))[:, 0]
        return _times(self.into, own).view(complex)

    def motion_at(self, t: float, x: ComplexArray) -> FloatArray:
        """(q, q') at time `t`, s, from the amplitudes there, shape ``(2 n,)``."""
        y = _times(self.out, x.view(float))
        return y if self._waves is None else y + (self._waves @ self._turned(np.array([t])))[:, 0]

    def motion(self, t: FloatArray, x: ComplexArray) -> FloatArray:
        """(q, q') at times ``(m,)``, s, from the amplitudes there, shape ``(m, X)``; gives ``(2 n, m)``."""
        y = self.out @ x.view(float).T
        return np.asarray(y if self._waves is None else y + self._waves @ self._turned(t))

    @cached_property
    def _waves(self) -> FloatArray | None:
        """(q, q') under the harmonic loads by the real and imaginary parts of these, ``(2 n, 2 H)``; None without."""
        it = self.system
        if not it.driven.size:
            return None
        turning = np.concatenate([-1j * it.amplitudes, it.driven * it.amplitudes])
        return np.concatenate([turning.real, -turning.imag], axis=1)

    def _turned(self, t: FloatArray) -> FloatArray:
        """Cosines and sines of the harmonic loads' angles at times ``(m,)``, s, shape ``(2 H, m)``."""
        angle = np.multiply.outer(self.system.driven, t) + self.system.phase[:, None]
        return np.concatenate([np.cos(angle), np.sin(angle)])


def _times(matrix: RealMatrix, x: FloatArray) -> FloatArray:
    """The product with a vector; scipy spends ten times as long on the call of a sparse one as on the product."""
    if isinstance(matrix, np.ndarray):
        return np.asarray(matrix @ x)
    result = np.empty(matrix.shape[0])
    _sparse_times(matrix.data, matrix.indices, matrix.indptr, x, result)
    return result


@njit_called()
def _sparse_times(
    data: FloatArray, columns: npt.NDArray[np.int32], first: npt.NDArray[np.int32], x: FloatArray, result: FloatArray
) -> None:
    """Write the product of a matrix in compressed rows and `x` into `result`."""
    for i in range(result.size):
        total = 0.0
        for j in range(first[i], first[i + 1]):
            total += data[j] * x[columns[j]]
        result[i] = total


def own_exponentials(system: System) -> Exponentials:
    """The free motions of a state whose modes are not coupled, one mode after the other."""
    n, (a, omega) = system.omega.size, (system.damping_rate, system.omega)
    split = np.sqrt(np.abs(a**2 - omega**2))
    rings = (omega > a) | ((omega > 0) & (split <= _APART * a))
    split = np.where(rings, np.maximum(split, _APART * a), split)
    ring, pair = np.flatnonzero(rings), np.flatnonzero(~rings & (omega > 0))
    dragged = np.flatnonzero((omega == 0) & (a > 0))
    fast = -(a[pair] + split[pair])
    slow = omega[pair] ** 2 / fast
    rates = np.concatenate([-a[ring] + 1j * split[ring], slow, fast, -2 * a[dragged]])
    mode_of, term = np.concatenate([ring, pair, pair, dragged]), np.arange(rates.size)
    modes, back = np.zeros((n, rates.size), dtype=complex), np.zeros((rates.size, 2 * n), dtype=complex)
    modes[mode_of, term] = 1.0
    speeds = modes * rates
    modes[dragged, term[-dragged.size or rates.size :]] = -0.5 / a[dragged]
    speeds[dragged, term[-dragged.size or rates.size :]] = 1.0
    one, s, f = np.split(term[: rates.size - dragged.size], [ring.size, ring.size + pair.size])
    back[one, ring] = 1 - 1j * a[ring] / split[ring]
    back[one, n + ring] = -1j / split[ring]
    back[s, pair], back[s, n + pair] = -fast / (slow - fast), 1 / (slow - fast)
    back[f, pair], back[f, n + pair] = slow / (slow - fast), -1 / (slow - fast)
    back[term[-dragged.size or rates.size :], n + dragged] = 1.0
    return Exponentials(rates, modes, speeds, back, None)


def ramp_form(system: System, orientation: FloatArray, offset: FloatArray, window: float) -> RampForm:
    """A contact state along ramps; signs and gaps as in `Model`; no closed form is longer than `window`, s."""
    assert system.ramps is not None
    coupled = system if isinstance(system, Coupled) else None
    free = own_exponentials(system) if coupled is None else coupled.free
    delay = np.zeros(system.places.shape[0]) if coupled is None else coupled.delay
    n, rigid, elastic = system.omega.size, np.flatnonzero(system.omega == 0), system.omega > 0
    is_slow = (free.rates.imag == 0) & (-free.rates.real * window <= 1)
    fast, slow = np.flatnonzero(~is_slow), np.flatnonzero(is_slow)
    T, J, r = fast.size, slow.size, rigid.size
    modes, speeds, back = free.modes.copy(), free.speeds, free.back
    modes[np.ix_(rigid, slow)] = 0.0  # the displacement of a rigid body by slow terms is an integral
    alone = ~np.any(speeds[rigid] != 0, axis=1)

    into, out = np.zeros((T + J + 2 * r, 2 * n), dtype=complex), np.zeros((2 * n, T + J + 2 * r), dtype=complex)
    into[:T], into[T : T + J] = back[fast], back[slow].real
    body, speed = np.arange(T + J, T + J + r), np.arange(T + J + r, T + J + 2 * r)
    into[body] = -(modes[np.ix_(rigid, fast)] @ back[fast]).real
    into[body, rigid] += 1.0
    into[speed[alone], n + rigid[alone]] = 1.0
    out[:n, :T], out[:n, T : T + J] = modes[:, fast], modes[:, slow]
    out[n:, :T], out[n:, T : T + J] = speeds[:, fast], speeds[:, slow]
    out[rigid, body] = out[n + rigid, speed] = 1.0

    pushed = np.concatenate([system.constant[:, None], system.ramps.shares], axis=1)
    sees, kinds = system.ramps.ramps.base is not None, 2
    if sees:
        pushed, kinds = np.concatenate([pushed, system.ramps.base], axis=1), 4
    push = back[:, n:] @ pushed
    gain = -push[fast, :, None] / free.rates[fast, None, None] ** np.arange(1, kinds + 1)
    factors = system.places @ (modes * elastic[:, None]) + delay[:, None] * (system.places @ speeds)
    own = factors[:, fast] + system.places[:, rigid] @ modes[np.ix_(rigid, fast)]
    gain_at_places = np.einsum("uk,kld->uld", own, gain).real
    gain_sizes = np.einsum("uk,kld->uld", np.abs(own), np.abs(gain))
    if sees:
        for kind, seen in ((-2, system.ramps.seen), (-1, system.ramps.seen * delay)):
            gain_at_places[:, kind, 0] += seen
            gain_sizes[:, kind, 0] += np.abs(seen)
    body_slow = speeds[np.ix_(rigid, slow)].real
    body_push = np.stack([-(modes[np.ix_(rigid, fast)] @ push[fast]).real, pushed[rigid] * alone[:, None]], axis=1)
    rates = np.concatenate([free.rates[fast], 1j * system.driven])
    every = np.concatenate([own, -1j * system.place_amplitudes], axis=1)
    bent = np.eye(system.places.shape[0] if r or J or sees else 0, system.places.shape[0]).T
    turned = np.ones(rates.size)
    if coupled is None:  # exp(-a s) sin(w s) is at most w / (e a)
        rings = np.flatnonzero(rates[:T].imag > 0)
        turned[rings] = rates[rings].imag / np.maximum(rates[rings].imag, -rates[rings].real)
    spacing = system.ramps.ramps.block_at(0.0).spacing
    tables = RampTables(
        rates=rates,
        swinging=np.where(turned < _NEAR, 0.0, np.abs(rates)),
        turned=turned,
        driven=system.driven,
        phase=system.phase,
        factors=every,
        gain=gain,
        gain_at_places=gain_at_places,
        gain_sizes=gain_sizes,
        drag=-free.rates[slow].real,
        slow_push=push[slow].real,
        slow_at_places=np.stack([factors[:, slow].real, system.places[:, rigid] @ body_slow], axis=-1),
        body_push=body_push,
        body_slow=body_slow,
        body_at_places=np.stack([system.places[:, rigid], delay[:, None] * system.places[:, rigid]], axis=-1),
        shares=np.concatenate([np.abs(every), bent], axis=1),
        fading=np.concatenate([-rates.real * np.where(turned < _NEAR, 0.5, 1.0), np.zeros(bent.shape[1])]),
        place_of=system.place_of,
        force_place=system.place_of if coupled is None else coupled.force_place,
        orientation=orientation,
        offset=offset,
        window=window,
        spacing=spacing,
        whole=np.exp(rates * spacing),
        whole_areas=np.expm1(rates * spacing) / rates,
    )
    parts = np.stack([into.real, into.imag], axis=1).reshape(-1, 2 * n), np.ascontiguousarray(out.conj()).view(float)
    if coupled is None:  # each amplitude is of one mode
        return RampForm(system, in_c_order(tables), scipy.sparse.csr_array(parts[0]), scipy.sparse.csr_array(parts[1]))
    return RampForm(system, in_c_order(tables), *parts)
