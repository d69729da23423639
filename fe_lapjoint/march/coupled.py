r"""Contact states whose damping couples the modes: the mesh as a first-order system, by its own exponentials.

In the modes of the mesh with the springs that act, frequencies omega_i and values phi_k at stop k, the motion obeys

    q'' + D q' + omega^2 q = f(t),    D = C + sum over pressing damped stops of c_k phi_k phi_k^T.

A stop that has let go has no spring here.  C is that of the problem.  It is 2 a of each mode, and a full matrix beside
it if viscous damping or dampers of links couple the modes, which then are coupled in all states.  Under modal damping,
2 a belongs to the modes of all closed stops, and a stop that has let go is still closed, so that S (2 a) S^T takes its
place, with the map S between both sets of modes.

Its free motions are `fe_lapjoint.march.exponentials`.

The force of a damped stop divided by k is the penetration of a point that moves by z + (c / k) z'.  Such a stop has a
second gap function, with that point: `Model` says which gap functions may switch in a state.
"""

from __future__ import annotations

import copy
from collections.abc import Sequence
from dataclasses import dataclass, fields, replace
from functools import cached_property

import numpy as np

from fe_lapjoint.march.compiled import integral_of_product, integrals, moved_on_coupled, start_coupled, turned
from fe_lapjoint.march.coupled_modes import CoupledModes
from fe_lapjoint.march.envelope import Envelope
from fe_lapjoint.march.exponentials import Exponentials, rigid_directions
from fe_lapjoint.march.propagator import Flow
from fe_lapjoint.march.system import ComplexArray, Coordinates, IndexArray, ModalRamps, System
from lapjoint.answers.contact_state import ContactState
from lapjoint.problem import FloatArray
from lapjoint.problem.supports_and_stops import PlacedStop

_SURE = 1e-8
"""Largest correction of a forced motion, relative to it: its square is below rounding."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Coupled(System):
    """A state whose modes are coupled; `System` says what the fields are where this class says nothing else.

    The places are the positions of the ``P`` stops, and then the points of closed damped stops that read z + (c / k)
    z'.  `place_of` is the place of each gap function that may switch, as `Model.rows` lists them.
    """

    modes: CoupledModes
    """What the state is without its loads."""
    push: ComplexArray
    """Complex amplitudes of the loads, with those of dampers that move with the base, kg^1/2 m/s2, ``(n, H)``."""

    @property
    def D(self) -> FloatArray:
        """Damping matrix, 1/s, shape ``(n, n)``."""
        return self.modes.damping

    @property
    def free(self) -> Exponentials:
        """The free motions."""
        return self.modes.free

    @property
    def delay(self) -> FloatArray:
        """c / k of the points that read z + (c / k) z', and 0 of the positions, s, shape ``(p,)``."""
        return self.modes.delay

    @property
    def force_place(self) -> IndexArray:
        """The place whose penetration times the stiffness is the force of each stop, shape ``(P,)``."""
        return self.modes.force_place

    @property
    def row_places(self) -> IndexArray:
        """The place of each gap function, or -1 for one of an open stop that reads z + (c / k) z', ``(P + D,)``."""
        return self.modes.row_places

    @cached_property
    def of_forces(self) -> Coupled:
        """The same state, whose gap functions are those of the forces of the stops, shape ``(P,)``."""
        made = copy.copy(self)  # with all that was made of it and does not depend on its gap functions
        vars(made).pop("stop_amplitudes", None)
        object.__setattr__(made, "place_of", self.force_place)
        return made

    def jacobian(self, t: float, y: FloatArray) -> FloatArray:
        """Derivative of `rates` by y. See `System.jacobian`."""
        n = self.omega.size
        return np.block([[np.zeros((n, n)), np.eye(n)], [-np.diag(self.omega**2), -self.D]])

    @cached_property
    def plain(self) -> bool:
        """Whether the terms are the whole motion: there are no rigid-body modes."""
        return self.free.rest is None

    @cached_property
    def all_ring(self) -> bool:
        """Whether the terms of a place's motion, which bound it themselves, are the whole motion."""
        return self.plain

    @cached_property
    def slowest_decay(self) -> FloatArray:
        """0 for each mode: its motion is a sum of all exponentials; 1/s, shape ``(n,)``."""
        return np.zeros_like(self.omega)

    @cached_property
    def steady(self) -> FloatArray:
        """Displacement, speed, and half the acceleration under the constant forces, shape ``(n, 3)``."""
        made, f, rigid = np.zeros((self.omega.size, 3)), self.constant, self.omega == 0
        if rigid.any():
            turn, damped = rigid_directions(self.omega, self.D)
            drifting, dragged = turn[:, rigid & ~damped], turn[:, rigid & damped]
            made[:, 1] = dragged @ np.linalg.solve(dragged.T @ self.D @ dragged, dragged.T @ f)
            made[:, 2] = drifting @ (drifting.T @ f) / 2
        made[:, 0] = np.where(rigid, 0.0, (f - self.D @ made[:, 1]) / np.where(rigid, 1.0, self.omega) ** 2)
        return made

    @cached_property
    def amplitudes(self) -> ComplexArray:
        """Complex amplitudes P of the forced motion Im(P exp(i angle)), kg^1/2 m, shape ``(n, H)``."""
        found = np.zeros(self.push.shape, dtype=complex)
        for h, w in enumerate(self.driven.tolist()):
            found[:, h] = self._driven(self.push[:, h], w)
        return found

    def _driven(self, push: ComplexArray, w: float) -> ComplexArray:
        """One of the `amplitudes`: by the exponentials, and then a correction by what they leave of the forces.

        The correction is as large as the error before, and leaves the square of it.
        """
        square = self.omega**2 - w**2
        if self.plain:
            found = self.free.driven(push, w)
            drag = np.stack([found.real, found.imag]) @ self.D
            correction = self.free.driven(push - square * found - 1j * w * (drag[0] + 1j * drag[1]), w)
            if np.linalg.norm(correction) <= _SURE * np.linalg.norm(found):
                return found + correction
        return np.asarray(np.linalg.solve(np.diag(square) + 1j * w * self.D, push))

    @cached_property
    def place_amplitudes(self) -> ComplexArray:
        """Complex amplitudes of the forced motion that the gaps at the places see, m, shape ``(p, H)``."""
        return np.asarray((self.places @ self.amplitudes + self.seen) * (1 + 1j * np.outer(self.delay, self.driven)))

    @cached_property
    def shares(self) -> ComplexArray:
        """Factor of each term in the motion of the places: free terms, loads, constant; shape ``(p, terms)``."""
        still = self.places @ self.steady[:, 0] + self.delay * (self.places @ self.steady[:, 1])
        return np.ascontiguousarray(
            np.concatenate([self.modes.shares, -1j * self.place_amplitudes, still[:, None]], axis=1)
        )

    @cached_property
    def moduli_of_shares(self) -> FloatArray:
        """Moduli of the `shares`, and of the places for units of (q, q'), shape ``(p, terms + 2 n)``."""
        return np.concatenate([np.abs(self.shares), self.modes.moduli], axis=1)

    @cached_property
    def gap_rows(self) -> tuple[FloatArray, FloatArray, ComplexArray]:
        """Of each gap function, zeros for one of -1 in `row_places`: the modes, kg^-1/2, ``(P + D, n)``, the delay, s,
        ``(P + D, 1)``, and the factor of each term but the constant, ``(P + D, terms - 1)``."""
        known, at = (self.row_places >= 0)[:, None], self.row_places
        return known * self.places[at], known * self.delay[at][:, None], known * self.shares[at, :-1]

    @cached_property
    def rates_of_terms(self) -> ComplexArray:
        """Rates r of the terms exp(r t) of a place's motion: free terms, loads, constant; 1/s, ``(terms,)``."""
        return np.concatenate([self.free.rates, 1j * self.driven, [0.0]])

    @cached_property
    def swinging(self) -> FloatArray:
        """Moduli of `rates_of_terms`, 1/s: each term stays below its amplitude; shape ``(terms,)``."""
        return np.abs(self.rates_of_terms)

    @cached_property
    def fading(self) -> FloatArray:
        """Rates at which the bounds of `Flow.envelope` fall, 1/s: terms without the constant, and rigid-body modes."""
        return np.concatenate([-self.rates_of_terms[:-1].real, np.zeros(0 if self.plain else 1)])

    @cached_property
    def bounded_shares(self) -> FloatArray:
        """Moduli of the factors of these bounds in the motion of the places, ``(p, bounds)``."""
        fall = [] if self.plain else [2 * np.abs(self.places) @ np.abs(self.steady[:, 2:])]
        return np.ascontiguousarray(np.concatenate([np.abs(self.shares[:, :-1]), *fall], axis=1))

    @cached_property
    def motion_by_loads(self) -> tuple[FloatArray, FloatArray]:
        """The forced motion at the start by real and imaginary part of each load, ``(2 n, 2 H)``, and without loads,
        ``(2 n,)``."""
        turning = self.amplitudes.conj()
        both = np.concatenate([1j * turning, self.driven * turning]).view(float)
        return both, np.concatenate([self.steady[:, 0], self.steady[:, 1]])

    @property
    def loads(self) -> ComplexArray:
        """See `System.loads`."""
        return self.push

    def drag(self, v: FloatArray) -> FloatArray:
        """See `System.drag`."""
        return np.asarray(self.D @ v)

    def rates(self, t: float, y: FloatArray) -> FloatArray:
        """See `System.rates`; the same sums with a tenth of the calls."""
        if self.ramps is not None:
            return super().rates(t, y)
        (q, v), angle = y.reshape(2, -1), self.driven * t + self.phase
        force = self.constant + self.push.imag @ np.cos(angle) + self.push.real @ np.sin(angle)
        return np.concatenate([v, force - self.D @ v - self.omega**2 * q])

    def sizes(self, q: FloatArray, v: FloatArray) -> FloatArray:
        """See `System.sizes`."""
        own = np.abs(self.places)
        return np.asarray((own @ q + self.delay * (own @ v))[self.place_of])

    def read(self, coordinates: Coordinates, t: FloatArray, dt: int = 0) -> FloatArray:
        """See `System.read`; points that read z + (c / k) z' take the next derivative, too."""
        z, rate = (self.places @ coordinates(t, d) + self._seen_at_places(t, d) for d in (dt, dt + 1))
        return np.asarray((z + self.delay[:, None] * rate)[self.place_of])

    def turned(self, s: float, amplitudes: FloatArray) -> FloatArray:
        """Amplitudes of the first free terms, real and imaginary parts in turn, ``(2 count, m)``, `s` seconds later."""
        return np.asarray(turned(amplitudes, self.free.rates, s))

    def flown(self, s: float, deviations: FloatArray) -> FloatArray:
        """Deviations (dq, dq'), ``(2 n, m)``, `s` seconds later."""
        n = self.omega.size
        result = self.free.real_motion.T @ self.turned(s, self.free.real_back.T @ deviations)
        if self.free.rest is not None:
            place, speed = self.free.rest @ deviations
            result[:n] += place + speed * s
            result[n:] += speed
        return np.asarray(result)


class CoupledFlow(Flow):
    """The exact motion of a `Coupled` state; see `Flow`."""

    system: Coupled

    def __init__(self, system: Coupled, start: float, q: FloatArray, v: FloatArray) -> None:
        self.system, self.start, self.q, self.v = system, start, q, v
        y, loads, free = np.concatenate([q, v]), (system.driven, system.phase), system.free
        self.free, self._amplitudes, self._moduli, self.terms, self._sizes = start_coupled(
            y, start, loads, system.motion_by_loads, free.real_back, system.shares, system.moduli_of_shares
        )
        self._rest = None
        if free.rest is not None:
            self._rest = system.steady * [0.0, 1.0, 1.0]
            self._rest[:, :2] += (free.rest @ self.free.ravel()).T

    _rest: FloatArray | None
    """Coefficients of 1, s, s^2 in the modal displacements beside the terms, shape ``(n, 3)``."""

    @property
    def amplitudes(self) -> ComplexArray:
        """Amplitudes of the free terms and of the loads at the start, shape ``(terms - 1,)``."""
        return self._amplitudes[:-1]

    @property
    def polynomial(self) -> FloatArray:
        """Coefficients of 1, s, s^2 in the modal displacements beside the exponentials, shape ``(n, 3)``."""
        still = self.system.steady * [1.0, 0.0, 0.0]
        return still if self._rest is None else still + self._rest

    def of_forces(self) -> CoupledFlow:
        """This motion, read at the places of the forces of the stops."""
        made = copy.copy(self)
        made.system = self.system.of_forces
        made.__dict__.pop("rounding", None)  # which is of the gap functions that are read
        return made

    def __call__(self, t: FloatArray, dt: int = 0) -> FloatArray:
        """The `dt`-th derivative (0 to 2) of q at the times ``t``, s, shape ``(m,)``; gives ``(n, m)``."""
        it, s = self.system, np.asarray(t - self.start, dtype=float)
        T, rates = it.free.rates.size, it.rates_of_terms[:-1]
        terms = (self._amplitudes[:-1] * rates**dt)[:, None] * np.exp(np.multiply.outer(rates, s))
        result = (it.free.modes @ terms[:T]).real + (it.amplitudes @ terms[T:]).imag
        if dt == 0:
            result += it.steady[:, :1]
        return np.asarray(result if self._rest is None else result + self._rest @ _powers_of(s, dt))

    def at(self, t: float) -> FloatArray:
        """(q, q') at time `t`, s: kg^1/2 m and kg^1/2 m/s, shape ``(2 n,)``."""
        it, s, n = self.system, t - self.start, self.q.size
        y = moved_on_coupled(self._amplitudes, it.rates_of_terms, it.free.real_motion, it.motion_by_loads, s)
        if self._rest is not None:
            y[:n] += self._rest @ [1.0, s, s * s]
            y[n:] += self._rest @ [0.0, 1.0, 2 * s] - it.steady[:, 1]
        return np.asarray(y)

    def _beside(self, s: FloatArray, dt: int) -> FloatArray:
        """The `dt`-th derivative of the motion of the places beside the terms and the constant, ``(p, m)``."""
        assert self._rest is not None
        it = self.system
        rest = self._rest @ _powers_of(s, dt), self._rest @ _powers_of(s, dt + 1)
        found = it.places @ rest[0] + it.delay[:, None] * (it.places @ rest[1])
        if dt == 0:  # the constant term has the speed of the constant forces already
            found -= (it.delay * (it.places @ it.steady[:, 1]))[:, None]
        return np.asarray(found)

    def _with_others(self, z: FloatArray, t: FloatArray, dt: int) -> FloatArray:
        """Motion of the gap functions' places, ``(P, m)``, from the terms of all places."""
        it = self.system
        return np.asarray((z if it.plain else z + self._beside(t - self.start, dt))[it.place_of])

    def _with_other_rates(self, both: tuple[float, float], k: int, t: float) -> tuple[float, float]:
        """A displacement and its rate with the motion of rigid-body modes, m and m/s."""
        it = self.system
        if it.plain:
            return both
        s, u = np.array([t - self.start]), it.place_of[k]
        return both[0] + float(self._beside(s, 0)[u, 0]), both[1] + float(self._beside(s, 1)[u, 0])

    def integral_at_stops(self, end: float) -> FloatArray:
        """The time integral of z at the stops from the start to `end`, m s, shape ``(P,)``; of a closed damped stop,
        that of z + (c / k) z'."""
        it, T = self.system, end - self.start
        areas = integrals(self.terms, it.rates_of_terms, T)
        if self._rest is not None:
            rest = it.places @ self._rest
            still = it.places @ it.steady[:, 1]
            areas += rest @ [T, T**2 / 2, T**3 / 3] + it.delay * (rest[:, 1] * T + rest[:, 2] * T**2 - still * T)
        return np.asarray(areas[it.force_place])

    def work_on(self, k: int, sign: float, gap: float, end: float) -> float:
        """The integral of (z + (c / k) z' - sign gap) z' at closed damped stop `k` to `end`, m2: times the stiffness,
        the energy that the stop takes.  `Coupled.plain` is required.
        """
        it = self.system
        one, other = self.terms[it.force_place[k]].copy(), self.terms[it.row_places[k]] * it.rates_of_terms
        one[-1] -= sign * gap  # the last term is constant
        return float(integral_of_product(one, other, it.rates_of_terms, end - self.start))

    @cached_property
    def envelope(self) -> Envelope:
        """Bounds on the motion of the places, one for each term but the constant, and one for rigid-body modes."""
        it, value = self.system, self._moduli[:-1]
        slope = value * it.moduli
        bounds = [value, slope, slope * it.moduli]
        if not it.plain:
            bounds = [np.append(bound, rest) for bound, rest in zip(bounds, (np.inf, np.inf, 1.0), strict=True)]
        return Envelope(self.start, it.fading, it.bounded_shares, *bounds)


def _powers_of(s: FloatArray, dt: int) -> FloatArray:
    """The `dt`-th derivatives (0 to 3) of 1, s and s^2, shape ``(3, m)``."""
    zero, one = np.zeros_like(s), np.ones_like(s)
    rows = [(one, s, s * s), (zero, one, 2 * s), (zero, zero, 2 * one), (zero, zero, zero)]
    return np.array(rows[dt])


def coupled_system(base: System, state: ContactState, stops: Sequence[PlacedStop], modes: CoupledModes) -> Coupled:
    """A state whose modes are coupled under its loads, from the one in which the springs that act are closed stops."""
    push, closed = base.harmonic.astype(complex), list(modes.closed)
    given = {field.name: getattr(base, field.name) for field in fields(System)}
    given |= {"state": state, "places": modes.places, "place_of": modes.place_of}
    given["seen"] = np.concatenate([base.seen, base.seen[base.place_of[closed]]])
    for k, mode in zip(modes.pressing, modes.bent, strict=True) if base.sees_base else ():
        push -= stops[k].damping * np.outer(mode, 1j * base.driven * base.seen[base.place_of[k]])
    if base.ramps is not None:
        given["ramps"] = _damped_ramps(base, base.ramps, stops, modes)
    return Coupled(**given, modes=modes, push=push)


def _damped_ramps(base: System, ramps: ModalRamps, stops: Sequence[PlacedStop], modes: CoupledModes) -> ModalRamps:
    """The sampled forces with those of dampers that move with the base, of the closed damped stops."""
    push, seen = ramps.base.copy(), ramps.seen[base.place_of[list(modes.closed)]]
    for k, mode in zip(modes.pressing, modes.bent, strict=True):
        push[:, 1] -= stops[k].damping * ramps.seen[base.place_of[k]] * mode
    return replace(ramps, base=push, seen=np.concatenate([ramps.seen, seen]))


def flow_from(system: System, start: float, y: FloatArray) -> Flow:
    """The exact motion of a state from (q, q') at `start`, s, on, kg^1/2 m and kg^1/2 m/s, shape ``(2 n,)``."""
    made = CoupledFlow if isinstance(system, Coupled) else Flow
    return made(system, start, *y.reshape(2, -1))  # type: ignore[arg-type]
