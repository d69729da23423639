r"""The semi-discrete beam in one contact state, in the coordinates of its own finite element modes.

    M u'' + C u' + K u = f0 + sum_h fh sin(Omega_h t + phase_h)

with the springs of the closed stops in K and their k gap in f0.  Stops fixed in space move relative to the base by -y:
each wave of y is a further harmonic load, by which closed ones push with -k y and which the gap functions of all of
them see as y beside z.  The modes of one mesh span all of its degrees of
freedom, so nothing is lost between states: q_new = Phi_new^T M Phi_old q_old exactly.  Under modal damping every
mode of the state has its ratio; under viscous damping C = (C / m) M where all inertia is one mass per length m, and
elsewhere the modes are coupled, see `fe_lapjoint.march.coupled`.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import numpy.typing as npt

from fe_lapjoint.modes.assembly import Assembly
from fe_lapjoint.modes.eigenmodes import eigenmodes
from lapjoint.answers.contact_state import ContactState
from lapjoint.problem import FloatArray, ModalDamping, Problem, ViscousDamping
from lapjoint.problem.excitation import Wave
from lapjoint.problem.forces import HarmonicForce
from lapjoint.problem.ramps import RampBlocks

ComplexArray = npt.NDArray[np.complex128]
Coordinates = Callable[[FloatArray, int], FloatArray]
"""A function of times, s, shape ``(m,)``, and of a number dt from 0 to 2, or to 3 of a library method.

It gives the dt-th derivative of the modal displacements, kg^1/2 m / s^dt, shape ``(n, m)``.
"""
IndexArray = npt.NDArray[np.intp]
SAMPLES = 48
"""Steps of the grid, over one window, on which the search for switches evaluates a motion."""
_APART = 1e-4
"""Half the relative distance kept between the two rates of a critically damped mode; its motion changes by 1e-8 of
itself."""
_NEAR = 0.25
"""Relative distance of a^2 and omega^2 below which the two exponentials of a mode nearly cancel."""
DETUNE = 1e-9
"""Least relative distance kept between an undamped frequency and the frequency of a load.  Free and forced motion are
each as large as the static deflection divided by 2 `DETUNE`; they cancel to 1e-7 of the static deflection, and the
phase is off by 1e-9 of itself."""


@dataclass(frozen=True, eq=False)
class ModalRamps:
    """The sampled forces of a problem on the modes of one contact state."""

    ramps: RampBlocks
    shares: FloatArray
    """Modal force for each unit of load, kg^-1/2, or kg^-1/2 m along the beam, shape ``(n, R)``."""
    base: FloatArray
    """Modal force of the closed stops fixed in space for each unit of y, and of y', shape ``(n, 2)``."""
    seen: FloatArray
    """Share of y that the gap at each place sees, shape ``(p,)``."""

    def at(self, t: FloatArray, order: int = 0) -> FloatArray:
        """The `order`-th derivative of the modal forces at times ``(m,)``, s, ``(n, m)``; at a knot after it."""
        found = np.zeros((self.shares.shape[0], t.size))
        if order < 2:
            found += self.shares @ self.ramps.at(t)[order].T
        for d in range(2 if self.base.any() else 0):
            found += np.outer(self.base[:, d], self.base_at(t, order + d))
        return found

    def base_at(self, t: FloatArray, order: int) -> FloatArray:
        """The `order`-th derivative of y at times ``(m,)``, s, m over powers of s, ``(m,)``."""
        return self.ramps.base_at(t)[order] if order < 4 else np.zeros(t.size)


@dataclass(frozen=True, eq=False)
class System:
    """One contact state with ``n`` modes, ``P`` stops and ``H`` harmonic loads."""

    state: ContactState
    omega: FloatArray
    """Natural angular frequencies, rad/s, shape ``(n,)``."""
    vectors: FloatArray
    """Mass-normalised modes as columns over the free degrees of freedom, kg^-1/2, shape ``(n, n)``."""
    damping_rate: FloatArray
    """Damping rate zeta omega of each mode, or half its entry on the diagonal of a damping matrix, 1/s, shape
    ``(n,)``."""
    constant: FloatArray
    """Modal force of the closed stops' gaps and of the step loads, kg^1/2 m/s2, shape ``(n,)``."""
    harmonic: FloatArray
    """Modal amplitudes of the harmonic loads, kg^1/2 m/s2, shape ``(n, H)``."""
    driven: FloatArray
    """Angular frequencies of the harmonic loads, rad/s, shape ``(H,)``."""
    phase: FloatArray
    """Phases of the harmonic loads, rad, shape ``(H,)``."""
    stops: FloatArray
    """Modes at the stops, kg^-1/2, shape ``(P, n)``."""
    places: FloatArray
    """The distinct rows of `stops`: one for each position, and for stops in space, kg^-1/2, shape ``(p, n)``."""
    place_of: IndexArray
    """Which of the `places` each stop is at, shape ``(P,)``."""
    seen: FloatArray
    """Amplitude of the base's motion y that the gaps at each place see, by harmonic load, m, shape ``(p, H)``."""
    ramps: ModalRamps | None = None
    """The sampled forces, if there are any."""

    @cached_property
    def oscillating(self) -> npt.NDArray[np.bool_]:
        """Whether each mode is damped below critical, by more than a millionth, shape ``(n,)``."""
        return np.asarray(self.omega > self.damping_rate * (1 + 1e-6))

    @cached_property
    def all_oscillate(self) -> bool:
        """Whether every mode is damped below critical."""
        return bool(self.oscillating.all())

    @cached_property
    def which(self) -> IndexArray:
        """Indices of the oscillating modes, shape ``(oscillating,)``."""
        return np.flatnonzero(self.oscillating)

    @cached_property
    def slowest_decay(self) -> FloatArray:
        """Rate at which each mode's free motion falls in the long run, 1/s, shape ``(n,)``."""
        a, omega = self.damping_rate, self.omega
        return np.where(self.oscillating, a, a - np.sqrt(np.maximum(a**2 - omega**2, 0.0)))

    @cached_property
    def roots(self) -> ComplexArray:
        """-a + i sqrt(omega^2 - a^2) of the oscillating modes, a = zeta omega, 1/s, shape ``(oscillating,)``."""
        a, omega = self.damping_rate[self.oscillating], self.omega[self.oscillating]
        return np.asarray(-a + 1j * np.sqrt(omega**2 - a**2))

    @cached_property
    def parts_of_roots(self) -> tuple[FloatArray, FloatArray]:
        """Real parts of `roots`, 1/s, and inverse imaginary parts, s, shape ``(oscillating,)`` each."""
        return self.roots.real.copy(), 1.0 / self.roots.imag

    @cached_property
    def equilibrium(self) -> FloatArray:
        """Modal displacements under the constant forces, 0 for rigid-body modes, kg^1/2 m, shape ``(n,)``."""
        rigid = self.omega == 0
        return np.where(rigid, 0.0, self.constant / np.where(rigid, 1.0, self.omega) ** 2)

    @cached_property
    def amplitudes(self) -> ComplexArray:
        """Complex amplitudes P of the forced motion Im(P exp(i angle)), kg^1/2 m, shape ``(n, H)``."""
        a, w, omega = self.damping_rate[:, None], self.driven, self.omega[:, None]
        return np.asarray(self.harmonic / (omega**2 - w**2 + 2j * a * w))

    @cached_property
    def place_amplitudes(self) -> ComplexArray:
        """Complex amplitudes of the forced motion that the gaps at the places see, m, shape ``(p, H)``."""
        return np.asarray(self.places @ self.amplitudes + self.seen)

    @cached_property
    def stop_amplitudes(self) -> ComplexArray:
        """The `place_amplitudes` of the place of each stop, m, shape ``(P, H)``."""
        return np.asarray(self.place_amplitudes[self.place_of])

    @cached_property
    def sees_base(self) -> bool:
        """Whether the gap of any stop sees the motion of the base."""
        return bool(self.seen.any())

    def seen_motion(self, t: FloatArray, dt: int = 0) -> FloatArray:
        """The `dt`-th derivative (0 to 3) of the y that each stop's gap sees at times ``(m,)``: m s^-dt, ``(P, m)``."""
        return np.asarray(self._seen_at_places(t, dt)[self.place_of])

    def _seen_at_places(self, t: FloatArray, dt: int) -> FloatArray:
        """`seen_motion` at each place, ``(p, m)``."""
        found = np.zeros((self.places.shape[0], t.size))
        if self.sees_base:
            angle = self.driven[:, None] * t + self.phase[:, None]
            found += self.seen @ ((1j * self.driven[:, None]) ** dt * np.exp(1j * angle)).imag
        if self.ramps is not None and self.ramps.seen.any():
            found += np.outer(self.ramps.seen, self.ramps.base_at(t, dt))
        return found

    def sizes(self, q: FloatArray, v: FloatArray) -> FloatArray:
        """What gap functions read of moduli of modal displacements and velocities, ``(n,)``, m, shape ``(P,)``."""
        return np.asarray((np.abs(self.places) @ q)[self.place_of])

    @property
    def of_forces(self) -> System:
        """The same state, whose gap functions are those of the forces of the stops, shape ``(P,)``."""
        return self

    def read(self, coordinates: Coordinates, t: FloatArray, dt: int = 0) -> FloatArray:
        """The `dt`-th derivative of what the gap functions read at times ``(m,)``, m s^-dt, ``(P, m)``."""
        return np.asarray((self.places @ coordinates(t, dt) + self._seen_at_places(t, dt))[self.place_of])

    @cached_property
    def shares(self) -> ComplexArray:
        """Factor of each term in the motion of the places, shape ``(p, terms)``.

        The terms are oscillating modes, kg^-1/2; loads of unit amplitude, written as cosines, m; and the displacement
        by constant forces, m.
        """
        modes = self.places if self.all_oscillate else self.places[:, self.oscillating]
        constant = (self.places @ self.equilibrium)[:, None]
        return np.ascontiguousarray(np.concatenate([modes, -1j * self.place_amplitudes, constant], axis=1))

    @cached_property
    def shares_and_moduli(self) -> tuple[ComplexArray, FloatArray]:
        """The `shares`, and their moduli followed by those of all modes at the places, shape ``(p, terms + n)``."""
        return self.shares, np.concatenate([np.abs(self.shares), np.abs(self.places)], axis=1)

    @cached_property
    def motion_by_loads(self) -> tuple[FloatArray, FloatArray]:
        """The forced motion by real and imaginary part of each load, ``(2 n, 2 H)``, and the motion without loads, ``(2
        n,)``."""
        turning = self.amplitudes.conj()
        both = np.concatenate([1j * turning, self.driven * turning]).view(float)
        ramp = np.zeros_like(self.equilibrium) if self.drift is None else self.drift[0]
        return both, np.concatenate([self.equilibrium, ramp])

    @cached_property
    def rates_of_terms(self) -> ComplexArray:
        """Rates r of the terms exp(r t) of a place's motion: oscillating modes, loads, constant; 1/s, ``(terms,)``."""
        return np.concatenate([self.roots, 1j * self.driven, [0.0]])

    @cached_property
    def plain(self) -> bool:
        """Whether the terms are the whole motion: there are no overdamped and no rigid-body modes."""
        return self.all_oscillate and self.drift is None

    @cached_property
    def drift(self) -> tuple[FloatArray, FloatArray] | None:
        """Speed and acceleration of rigid-body modes under constant forces, each ``(n,)``; None without such modes."""
        rigid, drag = self.omega == 0, self.damping_rate > 0
        if not rigid.any():
            return None
        ramp = np.where(rigid & drag, self.constant / np.where(drag, 2 * self.damping_rate, 1.0), 0.0)
        return ramp, np.where(rigid & ~drag, self.constant, 0.0)

    @cached_property
    def polynomial(self) -> FloatArray:
        """Motion of the stops under the constant forces: coefficients of 1, t, t^2, m over s^0 to s^2, ``(P, 3)``."""
        ramp, fall = (np.zeros_like(self.omega),) * 2 if self.drift is None else self.drift
        return np.asarray(self.stops @ np.stack([self.equilibrium, ramp, fall / 2], axis=1))

    @cached_property
    def exponentials(self) -> tuple[ComplexArray, IndexArray]:
        """Rates of the free motion, 1/s, and the mode to which each rate belongs, shape ``(terms,)`` each.

        An oscillating mode has one rate, of its complex pair.  Then follow the slow rates, and then the fast rates, of
        the other modes.  The two rates of a critically damped mode are kept apart by `_APART`.  A rigid-body mode
        without drag has no rate.
        """
        others = np.flatnonzero(~self.oscillating & (self.damping_rate > 0))
        a, omega = self.damping_rate[others], self.omega[others]
        s = np.maximum(np.sqrt(np.maximum(a**2 - omega**2, 0.0)), _APART * a)
        slow = np.where(omega > 0, np.where(s > _APART * a, omega**2 / (a + s), a - s), 0.0)
        rates = np.concatenate([self.roots, -slow, -(a + s)])
        return rates, np.concatenate([np.flatnonzero(self.oscillating), others, others])

    def amplitudes_of(self, q: FloatArray, v: FloatArray) -> tuple[ComplexArray, FloatArray]:
        """Amplitudes of the `exponentials` in ``m`` free motions, kg^1/2 m, ``(terms, m)``; and rigid-body motion.

        Given are displacements, kg^1/2 m, and velocities, kg^1/2 m/s, at the start, ``(n, m)``. The second array holds
        displacement, m, and speed, m/s, of the rigid-body modes without drag at the stops, ``(P, 2, m)``.
        """
        rates, modes = self.exponentials
        which = self.oscillating
        count = int(np.count_nonzero(which))
        one = self.roots[:, None]
        oscillating = q[which] - 1j * (v[which] - one.real * q[which]) / one.imag
        others = modes[count : count + (modes.size - count) // 2]
        slow, fast = np.split(rates[count:, None].real, 2)
        first = (v[others] - fast * q[others]) / (slow - fast)
        drifting = ~which & (self.damping_rate == 0)
        drift = np.stack([self.stops[:, drifting] @ part[drifting] for part in (q, v)], axis=1)
        return np.concatenate([oscillating, first, q[others] - first]), drift

    @cached_property
    def bounded(self) -> tuple[IndexArray, IndexArray, IndexArray]:
        """Indices of the damped or oscillating modes by their bound in `Flow.envelope`: ringing, near critical,
        creeping."""
        a, omega = self.damping_rate, self.omega
        near = (a > 0) & (np.abs(a**2 - omega**2) < _NEAR * a**2)
        ringing, creeping = self.oscillating & ~near, ~self.oscillating & ~near & (a > 0)
        return np.flatnonzero(ringing), np.flatnonzero(near), np.flatnonzero(creeping)

    @cached_property
    def creeping_rates(self) -> tuple[FloatArray, FloatArray]:
        """Rates at which the two parts of each creeping mode fall, slow and fast, 1/s, each ``(creeping,)``."""
        a, omega = self.damping_rate[self.bounded[2]], self.omega[self.bounded[2]]
        fast = a + np.sqrt(a**2 - omega**2)
        return omega**2 / fast, fast

    @cached_property
    def bounded_shares(self) -> FloatArray:
        """Moduli of the factors of the terms that `Flow.envelope` bounds in the motion of the places, ``(p, bounds)``.

        The terms are bounded modes, creeping ones twice, kg^-1/2; loads, m; and rigid-body modes under constant forces,
        m/s2.
        """
        ringing, near, creeping = self.bounded
        modes = np.abs(self.places[:, np.concatenate([ringing, near, creeping, creeping])])
        fall = [] if self.drift is None else [np.abs(self.places) @ np.abs(self.drift[1])[:, None]]
        return np.ascontiguousarray(np.concatenate([modes, np.abs(self.place_amplitudes), *fall], axis=1))

    @cached_property
    def fading(self) -> FloatArray:
        """Rates at which the bounds of `Flow.envelope` fall, 1/s: bounded modes, loads, and rigid-body modes."""
        ringing, near, _ = self.bounded
        a, omega = self.damping_rate[near], self.omega[near]
        least = a - np.sqrt(np.maximum(a**2 - omega**2, 0.0))
        drift = 0 if self.drift is None else 1
        return np.concatenate(
            [self.damping_rate[ringing], least / 2, *self.creeping_rates, np.zeros(self.driven.size + drift)]
        )

    @cached_property
    def all_ring(self) -> bool:
        """Whether every mode rings, far from critical, so that the terms of a place's motion bound it themselves."""
        return self.plain and self.bounded[0].size == self.omega.size

    @cached_property
    def moduli(self) -> FloatArray:
        """|r| of `rates_of_terms` but the constant, 1/s, shape ``(terms - 1,)``."""
        return np.asarray(np.abs(self.rates_of_terms[:-1]))

    @cached_property
    def swinging(self) -> FloatArray:
        """Moduli of `rates_of_terms`, or 0 for modes that `Flow.envelope` does not bound by amplitude, 1/s,
        ``(terms,)``."""
        sure = np.ones(self.rates_of_terms.size, dtype=bool)
        sure[: self.which.size] = np.isin(self.which, self.bounded[0])
        return np.where(sure, np.abs(self.rates_of_terms), 0.0)

    def waves(self, s: float | FloatArray) -> FloatArray:
        """Conjugates of exp(r s) for the rates r of `rates_of_terms`, as pairs of real numbers.

        The shape is ``(2 terms,)``, or ``(m, 2 terms)`` for ``m`` times, s. The scalar product with complex amplitudes,
        as pairs too, is the real part of their sum.
        """
        return np.exp(np.multiply.outer(s, self._conjugate_rates)).view(float)

    @cached_property
    def _conjugate_rates(self) -> ComplexArray:
        return self.rates_of_terms.conj()

    def grid(self, step: float) -> FloatArray:
        """The `waves` at t = 0, step, ... `SAMPLES` step, shape ``(SAMPLES + 1, 2 terms)``; kept for the next call."""
        if step not in self._grids:
            self._grids[step] = self.waves(step * np.arange(SAMPLES + 1.0))
        return self._grids[step]

    @cached_property
    def _grids(self) -> dict[float, FloatArray]:
        return {}

    @property
    def loads(self) -> ComplexArray | FloatArray:
        """Complex amplitudes of all that pushes the modes as a harmonic load, kg^1/2 m/s2, ``(n, H)``."""
        return self.harmonic

    def forces(self, t: FloatArray, order: int = 0) -> FloatArray:
        """The `order`-th derivative of the modal forces at times ``(m,)``, s, kg^1/2 m s^(-2 - order), ``(n, m)``."""
        waves = (1j * self.driven[:, None]) ** order * np.exp(1j * (self.driven[:, None] * t + self.phase[:, None]))
        found = (self.loads @ waves).imag
        if order == 0:
            found += self.constant[:, None]
        return np.asarray(found if self.ramps is None else found + self.ramps.at(t, order))

    def drag(self, v: FloatArray) -> FloatArray:
        """Damping forces that modal velocities cause, ``(n, m)``, kg^1/2 m/s2."""
        return 2 * self.damping_rate[:, None] * v

    def next_derivative(self, t: FloatArray, q: FloatArray, v: FloatArray, order: int = 0) -> FloatArray:
        """Derivative `order` + 2 of q at times ``(m,)``, s, from the two derivatives before it, ``(n, m)`` each."""
        return self.forces(t, order) - self.drag(v) - self.omega[:, None] ** 2 * q

    def rates(self, t: float, y: FloatArray) -> FloatArray:
        """d(q, q')/dt at time `t`, s, from `y` = (q, q'), ``(2 n,)``: the right side of the equations of motion."""
        q, v = y.reshape(2, -1, 1)
        return np.concatenate([v, self.next_derivative(np.array([t]), q, v)])[:, 0]

    def jacobian(self, t: float, y: FloatArray) -> FloatArray:
        """Derivative of `rates` by y, shape ``(2 n, 2 n)``; constant, with the arguments that `solve_ivp` gives."""
        n = self.omega.size
        return np.block(
            [
                [np.zeros((n, n)), np.eye(n)],
                [-np.diag(self.omega**2), -2 * np.diag(self.damping_rate)],
            ]
        )


def build_system(assembly: Assembly, state: ContactState) -> System:
    """The modal form of a contact state on a mesh."""
    problem = assembly.problem
    omega, vectors = eigenmodes(assembly, state)
    harmonic, driven, seen = _harmonic_loads(assembly, state, vectors, problem)
    damping_rate = _damping_rates(assembly, omega, vectors)
    omega = _away_from_resonance(omega, damping_rate, driven.tolist())
    f0 = np.zeros(omega.size)
    for k in state.closed:
        stop = problem.structure.stops[k]
        f0 += stop.sign * stop.stiffness * stop.gap * assembly.stop_rows[k]
    stops = assembly.stop_rows @ vectors
    first, place_of = assembly.stop_places
    for step in problem.forces.constant:
        f0 += step.force * assembly.load(step.shape)
    return System(
        state=state,
        omega=omega,
        vectors=vectors,
        damping_rate=damping_rate,
        constant=vectors.T @ f0,
        harmonic=harmonic,
        driven=driven,
        phase=np.array([load.phase for load in _waves(problem)]),
        stops=stops,
        places=stops[first],
        place_of=place_of,
        seen=seen[first],
        ramps=_modal_ramps(assembly, state, vectors),
    )


def under_other_loads(alike: System, assembly: Assembly, problem: Problem) -> System:
    """A contact state of a problem whose harmonic loads differ from those of `alike` by size or frequency alone."""
    harmonic, driven, seen = _harmonic_loads(assembly, alike.state, alike.vectors, problem)
    omega = alike.omega
    if (alike.damping_rate < DETUNE * omega).any():
        omega = _away_from_resonance(eigenmodes(assembly, alike.state)[0], alike.damping_rate, driven.tolist())
    return replace(alike, omega=omega, harmonic=harmonic, driven=driven, seen=seen[assembly.stop_places[0]])


def _waves(problem: Problem) -> tuple[HarmonicForce | Wave, ...]:
    """The harmonic loads, and after them the waves of stops fixed in space."""
    return (*problem.forces.harmonic, *problem.moved_stops)


def _harmonic_loads(
    assembly: Assembly, state: ContactState, vectors: FloatArray, problem: Problem
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Harmonic loads, and after them the waves of stops fixed in space.

    Modal amplitudes, kg^1/2 m/s2, ``(n, H)``; angular frequencies, rad/s, ``(H,)``; and the amplitude of y that each
    stop's gap sees, m, ``(P, H)``.
    """
    loads, waves, springs = problem.forces.harmonic, problem.moved_stops, _springs(assembly, state)
    columns = [load.amplitude * assembly.load(load.shape) for load in loads]
    columns += [-wave.amplitude * (springs @ assembly.stop_rows) for wave in waves]
    forces = np.array(columns).reshape(len(columns), vectors.shape[0]).T
    seen = np.outer(assembly.base_shares, [0.0] * len(loads) + [wave.amplitude for wave in waves])
    return vectors.T @ forces, np.array([load.angular_frequency for load in _waves(problem)]), seen


def _away_from_resonance(omega: FloatArray, damping_rate: FloatArray, driven: list[float]) -> FloatArray:
    """Natural frequencies, rad/s, ``(n,)``; an undamped one that a load meets is moved above the load's frequency.

    Free and forced motion take the moved frequency, so that their difference grows as it does at resonance.
    """
    for w in sorted(driven):
        least = DETUNE * omega
        met = (damping_rate < least) & (np.abs(omega - w) < least)
        omega = np.where(met, w * (1 + DETUNE), omega)
    return omega


def _modal_ramps(assembly: Assembly, state: ContactState, vectors: FloatArray) -> ModalRamps | None:
    """The sampled forces on modes, which are columns ``(n, n)``; None without any."""
    forces = assembly.problem.forces
    if forces.ramps is None:
        return None
    base, seen = np.zeros((vectors.shape[1], 2)), np.zeros(len(assembly.stop_places[0]))
    if forces.seen is not None:
        seen = assembly.base_shares[assembly.stop_places[0]]
        base[:, 0] = -vectors.T @ (_springs(assembly, state) @ assembly.stop_rows)
    shares = vectors.T @ np.stack([assembly.load(it.shape) for it in forces.sampled], axis=1)
    return ModalRamps(forces.ramps, shares, base, seen)


def _springs(assembly: Assembly, state: ContactState) -> FloatArray:
    """Force by which each closed stop fixed in space pushes for a unit of -y, N/m, shape ``(P,)``."""
    stops = assembly.problem.structure.stops
    return np.array([stop.stiffness * (k in state) for k, stop in enumerate(stops)]) * assembly.base_shares


def drag_on(assembly: Assembly, vectors: FloatArray) -> FloatArray | None:
    """The damping matrix, 1/s, ``(n, n)``, of modes that viscous damping couples; None where it does not."""
    C = assembly.problem.structure.coupling_drag
    return C * (vectors.T @ assembly.drag @ vectors) if C > 0 else None


def _damping_rates(assembly: Assembly, omega: FloatArray, vectors: FloatArray) -> FloatArray:
    """See `System.damping_rate`."""
    damping, drag = assembly.problem.damping, drag_on(assembly, vectors)
    if isinstance(damping, ModalDamping):
        return damping.ratios(omega.size) * omega
    if drag is not None:
        return np.asarray(np.diag(drag) / 2)
    coefficient = damping.coefficient if isinstance(damping, ViscousDamping) else 0.0
    return np.full(omega.size, coefficient / (2 * assembly.problem.line.m))
