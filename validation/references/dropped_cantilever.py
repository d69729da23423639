r"""The answers of benchmark SDNL104 by numpy alone: a cantilever under a step force that falls on one stop, undamped.

In each of its two states, free and with the stop's spring at its tip, the motion is

    z = z_static(x) + sum_i phi_i(x) (a_i cos omega_i s + b_i sin omega_i s),    s = t - t_switch

about the static deflection under all forces of the state.  The modes are those of the textbooks, with roots of

    cos b cosh b = -1,    b^3 (1 + cos b cosh b) + kappa (sin b cosh b - cos b sinh b) = 0,    kappa = k L^3 / EI

A switch carries displacement and velocity over by inner products of modes, taken by quadrature.  Its time is bisected.
Run as a program it prints the four numbers with two numbers of modes, so that one sees which digits hold.
"""

from __future__ import annotations

import math
import tomllib
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import numpy.typing as npt
from scipy.optimize import brentq

from validation.references.panels import gauss_panels

DATA = Path(__file__).with_name("references.toml")
Array = npt.NDArray[np.float64]

_GROUPS = {group["name"]: group for group in tomllib.loads(DATA.read_text(encoding="utf-8"))["group"]}
_GIVEN = {name: float(text) for name, text in _GROUPS["sdnl104 problem"]["values"].items()}
LENGTH, DIAMETER = _GIVEN["length"], _GIVEN["diameter"]  # m
MODULUS, DENSITY = _GIVEN["youngs_modulus"], _GIVEN["density"]  # Pa, kg/m3
GAP, STIFFNESS, FORCE = _GIVEN["gap"], _GIVEN["stiffness"], _GIVEN["force"]  # m, N/m, N
AT = 0.16  # Time of the kinetic energy, s
EI, MASS = MODULUS * math.pi * DIAMETER**4 / 64, DENSITY * math.pi * DIAMETER**2 / 4
_STEP = 2e-5  # Time between samples of the tip, s: a thousandth of the slowest half period
QUANTITIES = ("first_contact", "release", "impulse", "kinetic_energy")


@dataclass(frozen=True)
class Family:
    """The modes of one state, and its static deflection."""

    omega: Array
    """rad/s, shape ``(n,)``."""
    shapes: Array
    """Mass-normalised, at the points of the quadrature, kg^-1/2, shape ``(n, points)``."""
    tip: Array
    """Mass-normalised shapes at the tip, kg^-1/2, shape (n,)."""
    static: Array
    """Static deflection at the points, m."""
    static_tip: float
    """Static deflection at the tip, m."""


def quadrature(modes: int) -> tuple[Array, Array]:
    """Points and weights along the beam, m, shape (points,) each: eight points to each half wave of the highest
    mode."""
    return gauss_panels(np.linspace(0.0, LENGTH, modes + 2), 8)


def family(spring: float, modes: int) -> Family:
    """Modes and static deflection of the cantilever with a spring, N/m, at its tip."""
    kappa = spring * LENGTH**3 / EI
    x, w = quadrature(modes)

    def equation(b: float) -> float:
        return b**3 * (1 / math.cosh(b) + math.cos(b)) + kappa * (math.sin(b) - math.cos(b) * math.tanh(b))

    grid = np.linspace(0.5, (modes + 2) * math.pi, 60 * (modes + 2))
    signs = np.sign([equation(b) for b in grid])
    changes = np.flatnonzero(signs[:-1] * signs[1:] < 0)[:modes]
    b = np.array([brentq(equation, grid[i], grid[i + 1], xtol=1e-14) for i in changes])
    shapes = _shape(b, x / LENGTH)
    size = np.sqrt(MASS * (shapes**2 @ w))
    force = FORCE - spring * GAP  # the spring pushes upwards where z < -gap
    stiffness = 3 * EI / LENGTH**3
    tip = force / (stiffness + spring)
    return Family(
        omega=(b / LENGTH) ** 2 * math.sqrt(EI / MASS),
        shapes=shapes / size[:, None],
        tip=_shape(b, np.array([1.0]))[:, 0] / size,
        static=tip * (3 * (x / LENGTH) ** 2 - (x / LENGTH) ** 3) / 2,
        static_tip=tip,
    )


def _shape(b: Array, s: Array) -> Array:
    """cosh - cos - r (sinh - sin) at s = x / L by growing and falling parts, so that nothing overflows."""
    # r = (cosh b + cos b) / (sinh b + sin b); 1 - r is small and kept apart.
    e = np.exp(-b)
    r = (1 + e**2 + 2 * e * np.cos(b)) / (1 - e**2 + 2 * e * np.sin(b))
    rest = 2 * e * (np.sin(b) - np.cos(b) - e) / (1 - e**2 + 2 * e * np.sin(b))  # 1 - r
    bs = np.multiply.outer(b, s)
    growing = rest[:, None] / 2 * np.exp(bs)
    falling = (1 + r)[:, None] / 2 * np.exp(-bs)
    return np.asarray(growing + falling - np.cos(bs) + r[:, None] * np.sin(bs))


@dataclass(frozen=True)
class Stay:
    """The motion in one state, from `start` on."""

    state: Family
    closed: bool
    start: float
    """Start of the stay, s."""
    a: Array
    """Modal coordinates at its start, about the static deflection, kg^1/2 m."""
    b: Array
    """Modal velocities at its start over omega, kg^1/2 m."""

    def q(self, s: float) -> Array:
        """Modal coordinates `s` seconds after the start of the stay, kg^1/2 m, shape (n,)."""
        angle = self.state.omega * s
        return np.asarray(self.a * np.cos(angle) + self.b * np.sin(angle))

    def v(self, s: float) -> Array:
        """Modal velocities `s` seconds after the start of the stay, kg^1/2 m/s, shape (n,)."""
        angle = self.state.omega * s
        return np.asarray(self.state.omega * (self.b * np.cos(angle) - self.a * np.sin(angle)))

    def beyond(self, s: float) -> float:
        """How far the tip is beyond the gap `s` seconds after the start of the stay, m; negative while the stop is not
        reached."""
        return -float(self.state.static_tip + self.state.tip @ self.q(s)) - GAP

    def end(self) -> float:
        """After how many seconds the stop switches."""
        before, s = -1.0, _STEP  # it has just switched, or begins at rest away from the gap
        while True:
            now = (-1.0 if self.closed else 1.0) * self.beyond(s)
            if before < 0 <= now:
                return float(brentq(self.beyond, s - _STEP, s, xtol=1e-15))
            before, s = now, s + _STEP

    def impulse(self, s: float) -> float:
        """Time integral of the stop's force over the first `s` seconds of the stay, N s."""
        angle = self.state.omega * s
        waves = (self.state.tip / self.state.omega) @ (self.a * np.sin(angle) + self.b * (1 - np.cos(angle)))
        return STIFFNESS * (-(self.state.static_tip + GAP) * s - float(waves))

    def next(self, s: float, other: Family, weights: Array) -> Stay:
        """The motion in the other state from `s` seconds on: displacement and velocity are carried over by quadrature
        of `weights`, m, shape (points,)."""
        carry = MASS * (other.shapes * weights) @ self.state.shapes.T
        moved = MASS * (other.shapes @ (weights * (self.state.static - other.static)))
        return Stay(other, not self.closed, self.start + s, carry @ self.q(s) + moved, carry @ self.v(s) / other.omega)


def answers(modes: int) -> dict[str, float]:
    """First contact and release, s, impulse, N s, and kinetic energy at `AT`, J, with so many modes in each state."""
    free, closed = family(0.0, modes), family(STIFFNESS, modes)
    _, w = quadrature(modes)
    fall = Stay(free, False, 0.0, -MASS * (free.shapes @ (w * free.static)), np.zeros(modes))  # straight, at rest
    contact = fall.next(fall.end(), closed, w)
    duration = contact.end()
    flight = contact.next(duration, free, w)
    assert flight.start < AT < flight.start + flight.end()
    energy = float(np.sum(flight.v(AT - flight.start) ** 2)) / 2  # the modes are mass-normalised
    numbers = (contact.start, flight.start, contact.impulse(duration), energy)
    return dict(zip(QUANTITIES, numbers, strict=True))


def main() -> None:
    """Print the four numbers with 60 and with 120 modes."""
    coarse, fine = answers(60), answers(120)
    for name in QUANTITIES:
        print(f"{name:16} {coarse[name]:.9g} {fine[name]:.9g}")


if __name__ == "__main__":
    main()
