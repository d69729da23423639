r"""A beam on two pins without stops, as the sum over its sines: by numpy alone, no code of the project takes part.

With phi_n = sqrt(2 / (m L)) sin(n pi x / L) and omega_n = (n pi / L)^2 sqrt(EI / m),

    z = sum_n phi_n q_n,    q_n'' + 2 zeta_n omega_n q_n' + omega_n^2 q_n = f_n + sum_h f_hn sin(Omega_h t + phase_h)

Each q_n is its static answer to the loads of the moment plus a rest that falls fast with n.  The sum over all static
answers is the static deflection, of a uniform load q or of a force F at a (b = L - a, for x <= a, else mirrored),

    EI z = q x (L^3 - 2 L x^2 + x^3) / 24,    EI z = F b x (L^2 - b^2 - x^2) / (6 L)

so that only the rests are summed, and moments and shear forces come out as well as displacements.

A record is linear between its knots: a step of its first value, and a ramp from each knot on, of the change of slope
there.  Every ramp has an answer of its own, and all are added; nothing is carried from knot to knot.
The problem is read from the text of a problem file by `tomllib`.
"""

from __future__ import annotations

import math
import tomllib
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
import numpy.typing as npt
from scipy.interpolate import CubicSpline, make_interp_spline

from validation.references.panels import gauss_panels

Array = npt.NDArray[np.float64]

_TERMS = 600  # Terms of the sum; the rests fall at least as n^-4, but for undamped waves from a jump of load
_PANELS = 400  # Panels of the quadrature of the initial shapes: less than two half waves of the highest sine each


@dataclass(frozen=True, eq=False)
class PinnedBeam:
    """The beam of a problem file; its supports are taken as pins at both ends."""

    tables: dict[str, Any]
    """The file, as `tomllib` reads it."""

    @staticmethod
    def from_toml(text: str) -> PinnedBeam:
        """The beam of a problem given as the text of its file."""
        return PinnedBeam(tomllib.loads(text))

    @cached_property
    def _beam(self) -> tuple[float, float, float]:
        """Length, m, bending stiffness, N m2, and mass per length, kg/m."""
        beam = self.tables["beam"]
        b, h = beam["section"]["breadth"], beam["section"]["height"]
        material = beam["material"]
        return beam["length"], material["youngs_modulus"] * b * h**3 / 12, material["density"] * b * h

    @cached_property
    def _n(self) -> Array:
        return np.arange(1.0, _TERMS + 1)

    @cached_property
    def omega(self) -> Array:
        """Natural angular frequencies, rad/s."""
        L, EI, m = self._beam
        return np.asarray((self._n * math.pi / L) ** 2 * math.sqrt(EI / m))

    @cached_property
    def _decay(self) -> Array:
        damping = self.tables["damping"]
        if damping["kind"] == "viscous":
            return np.full(_TERMS, damping["coefficient"] / (2 * self._beam[2]))
        ratios = np.array(damping["ratio"], dtype=float)
        return np.asarray(ratios[np.minimum(np.arange(_TERMS), ratios.size - 1)] * self.omega)

    def _sines(self, x: float, dx: int = 0) -> Array:
        """phi_n or an x-derivative at a place, by n."""
        L, _, m = self._beam
        wave = self._n * math.pi / L
        return np.asarray(math.sqrt(2 / (m * L)) * wave**dx * np.sin(wave * x + dx * math.pi / 2))

    @cached_property
    def _loads(self) -> list[tuple[float | None, float, float, float]]:
        """Place (None: uniform), size, angular frequency and phase; a step is a cosine of frequency zero."""
        found: list[tuple[float | None, float, float, float]] = []
        if "base_motion" in self.tables:
            base = self.tables["base_motion"]
            for one in base.get("harmonics", [base] if base.get("kind") != "record" else []):
                w = one.get("multiple", 1) * base["angular_frequency"]
                found.append((None, self._beam[2] * one["amplitude"] * w**2, w, one.get("phase", 0.0)))
        for load in self.tables.get("point_loads", ()):
            if load["kind"] == "step":
                found.append((load["x"], load["force"], 0.0, math.pi / 2))
                continue
            for one in load.get("harmonics", [load] if load["kind"] != "record" else []):
                w = one.get("multiple", 1) * load["angular_frequency"]
                found.append((load["x"], one["force"], w, one.get("phase", 0.0)))
        return found

    @cached_property
    def _records(self) -> list[tuple[float | None, Array, Array]]:
        """Place (None: uniform), knots and forces there, N or N/m."""
        found: list[tuple[float | None, Array, Array]] = []
        base = self.tables.get("base_motion", {})
        if base.get("kind") == "record":
            knots, acceleration = accelerations(base["quantity"], *_samples(base))
            found.append((None, knots, -self._beam[2] * acceleration))
        found += [(it["x"], *_samples(it)) for it in self.tables.get("point_loads", ()) if it["kind"] == "record"]
        return found

    def _ramped(self, t: float, dt: int) -> Iterator[tuple[float | None, float, Array]]:
        """Position of each record, its force at t or the t-derivative, and the modal coordinates besides the static
        answer."""
        for place, knots, force in self._records:
            slope, passed = np.diff(force) / np.diff(knots), knots[:-1] <= t
            turns, begun = np.diff(slope, prepend=0.0)[passed], knots[:-1][passed]
            rests = force[0] * self._after(t, 0, dt) + sum(
                turn * self._after(t - start, 1, dt) for start, turn in zip(begun, turns, strict=True)
            )
            now = np.interp(t, knots, force) if dt == 0 else slope[int(passed.sum()) - 1]
            yield place, float(now), self._projected(place) * rests

    def _after(self, s: float, kind: int, dt: int) -> Array:
        """A t-derivative of each mode, a time s after a unit step (0) or ramp (1) began, less its static answer."""
        omega, decay = self.omega, self._decay
        lag = -2 * decay / omega**4 if kind else np.zeros(_TERMS)
        start = -lag - (0.0 if kind else 1 / omega**2), -(1 / omega**2 if kind else np.zeros(_TERMS))
        return (lag if dt == 0 else 0.0) + self._free(*start, s, dt)

    def _free(self, q: Array, v: Array, t: float, dt: int) -> Array:
        """A t-derivative of the free motion of each mode from q and v."""
        swing = np.sqrt(self.omega**2 - self._decay**2 + 0j)  # imaginary where a mode is overdamped
        one, other = -self._decay + 1j * swing, -self._decay - 1j * swing
        a = (v - other * q) / (one - other)
        return np.asarray((a * one**dt * np.exp(one * t) + (q - a) * other**dt * np.exp(other * t)).real)

    def _projected(self, place: float | None) -> Array:
        """Modal force of a unit load."""
        if place is not None:
            return self._sines(place)
        L, _, m = self._beam
        return np.asarray(math.sqrt(2 / (m * L)) * L / (self._n * math.pi) * (1 - np.cos(self._n * math.pi)))

    def _static(self, place: float | None, x: float, dx: int) -> float:
        """Static deflection under a unit load, or an x-derivative."""
        L, EI, _ = self._beam
        if place is None:
            curve, sign = np.polynomial.Polynomial([0, L**3, 0, -2 * L, 1]) / 24, 1.0
        else:
            mirrored = x > place
            b, x, sign = (place, L - x, (-1.0) ** dx) if mirrored else (L - place, x, 1.0)
            curve = np.polynomial.Polynomial([0, L**2 - b**2, 0, -1]) * b / (6 * L)
        return sign * float((curve.deriv(dx) if dx else curve)(x)) / EI

    @cached_property
    def _initial(self) -> tuple[Array, Array]:
        """Modal coordinates and rates at t = 0."""
        L, _, m = self._beam
        x, w = gauss_panels(np.linspace(0.0, L, _PANELS + 1), 16)
        shapes = math.sqrt(2 / (m * L)) * np.sin(np.multiply.outer(self._n * math.pi / L, x))
        given = self.tables.get("initial", {})

        def along(name: str) -> Array:
            values = given.get(name) or [0.0]
            if given.get("kind") == "sampled" and len(values) > 1:
                return np.asarray(CubicSpline(given["x"], values)(x))
            return np.asarray(np.polynomial.polynomial.polyval(x, np.array(values, dtype=float)))

        return m * shapes @ (w * along("displacement")), m * shapes @ (w * along("velocity"))

    def evaluate(self, x: float, t: float, dx: int = 0, dt: int = 0) -> float:
        """z at x, m, and t, s, or its derivative of order dx, up to 3, and dt, up to 1: m^(1 - dx) s^-dt."""
        omega, decay = self.omega, self._decay
        q, v = self._initial
        total, rest = 0.0, np.zeros(_TERMS)
        for place, size, w, phase in self._loads:
            force = size * self._projected(place)
            wave = force / (omega**2 - w**2 + 2j * decay * w)
            at_start, now = np.exp(1j * phase), (1j * w) ** dt * np.exp(1j * (w * t + phase))
            q, v = q - (wave * at_start).imag, v - (1j * w * wave * at_start).imag
            rest = rest + ((wave - force / omega**2) * now).imag
            total += size * self._static(place, x, dx) * float(now.imag)
        for place, force_now, moving in self._ramped(t, dt):
            total, rest = total + self._static(place, x, dx) * force_now, rest + moving
        rest = rest + self._free(q, v, t, dt)
        return total + float(self._sines(x, dx) @ rest)

    def moment(self, x: float, t: float) -> float:
        """EI z'' at x, m, and t, s, in N m."""
        return self._beam[1] * self.evaluate(x, t, 2)

    def shear(self, x: float, t: float) -> float:
        """EI z''' at x, m, and t, s, in N."""
        return self._beam[1] * self.evaluate(x, t, 3)


def accelerations(quantity: str, time: Array, values: Array) -> tuple[Array, Array]:
    """Knots, s, and acceleration, m/s2, shape (K,), linear between them, of samples, shape (n,), of an acceleration,
    velocity or displacement at `time`, s."""
    if quantity == "acceleration":
        return time, values
    if quantity == "displacement":
        return time, np.asarray(CubicSpline(time, values)(time, 2))
    # A quadratic spline whose knots lie half-way between the samples, without the first and the last.
    knots = np.concatenate([time[:1], (time[1:-2] + time[2:-1]) / 2, time[-1:]])
    spline = make_interp_spline(time, values, k=2, t=np.pad(knots, 2, mode="edge"))
    return knots, np.asarray(spline(knots, 1))


def _samples(record: dict[str, Any]) -> tuple[Array, Array]:
    """Times and values of a record that its tables hold."""
    values = np.array(record["values"], dtype=float)
    return np.arange(values.size) / record["rate"], values
