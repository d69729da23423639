r"""Benchmark SDNL105 by numpy alone: three clamped-clamped tubes that strike each other at mid-span, undamped.

Each tube moves in its own modes, mass-normalised, w_i rad/s, with the value p_i at mid-span.  A stop between neighbours
a and b, of stiffness k and gap g, acts on all coordinates q of the three tubes by

    q_i'' + w_i^2 q_i = F_i - sum over stops of D_i k max(D q - g, 0),      D q = z_a - z_b at mid-span

The modes are those of ten Hermite elements, as in the document, or those of the beam, of which only the symmetric ones
move: tan h = -tanh h with h = beta L / 2, and p = (1 / cos h - 1 / cosh h) / sqrt(m L).  Between switches the motion is
a sum of the modes of the state, and switches are bisected; or the document's own steps are taken.
Run as a program it prints the converged numbers with two numbers of modes, so that one sees which digits hold.
"""

from __future__ import annotations

import math
import tomllib
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import numpy.typing as npt

DATA = Path(__file__).with_name("references.toml")
Array = npt.NDArray[np.float64]

_GROUPS = {group["name"]: group for group in tomllib.loads(DATA.read_text(encoding="utf-8"))["group"]}
_GIVEN = {name: float(text) for name, text in _GROUPS["sdnl105 problem"]["values"].items()}
LENGTH, RADIUS, WALL = _GIVEN["length"], _GIVEN["radius"], _GIVEN["wall"]  # m
GAP, STIFFNESS, FORCE = _GIVEN["gap"], _GIVEN["stiffness"], _GIVEN["force"]  # m, N/m, N
ELEMENTS, MODES, STEP = int(_GIVEN["elements"]), int(_GIVEN["modes"]), _GIVEN["step"]  # of the document; a tube; s
AT = 1.0  # Time of the printed numbers, s
TUBES = 3
EI = _GIVEN["youngs_modulus"] * math.pi / 4 * (RADIUS**4 - (RADIUS - WALL) ** 4)
MASS = _GIVEN["density"] * math.pi * (RADIUS**2 - (RADIUS - WALL) ** 2)
_SAMPLES = 32  # Samples to each period of the highest mode
_BLOCK = 2048  # Samples taken at once


@dataclass(frozen=True)
class Tube:
    """The modes of one tube."""

    omega: Array
    """rad/s, shape ``(n,)``."""
    middle: Array
    """Mass-normalised shapes at mid-span, kg^-1/2, shape ``(n,)``."""


def meshed(elements: int = ELEMENTS, modes: int = MODES) -> Tube:
    """The lowest modes of a tube of an even number of Hermite elements."""
    h, size = LENGTH / elements, 2 * (elements + 1)
    signs = np.array([[12, 6, -12, 6], [6, 4, -6, 2], [-12, -6, 12, -6], [6, 2, -6, 4]])
    inertia = np.array([[156, 22, 54, -13], [22, 4, 13, -3], [54, 13, 156, -22], [-13, -3, -22, 4]])
    turns = np.outer(*2 * [np.array([1, h, 1, h])])
    K, M = np.zeros((size, size)), np.zeros((size, size))
    for i in range(0, 2 * elements, 2):
        K[i : i + 4, i : i + 4] += EI / h**3 * signs * turns
        M[i : i + 4, i : i + 4] += MASS * h / 420 * inertia * turns
    lower = np.linalg.inv(np.linalg.cholesky(M[2:-2, 2:-2]))
    lam, V = np.linalg.eigh(lower @ K[2:-2, 2:-2] @ lower.T)
    return Tube(np.sqrt(np.asarray(lam[:modes])), np.asarray((lower.T @ V)[elements - 2, :modes]))


def uniform(symmetric: int) -> Tube:
    """The lowest symmetric modes of a tube; the others have a node at mid-span."""
    j = np.arange(1, symmetric + 1)
    h = j * math.pi - math.pi / 4
    for _ in range(60):  # a contraction: tanh h is 1 to 5 digits already at the first
        h = j * math.pi - np.arctan(np.tanh(h))
    middle = (1 / np.cos(h) - 1 / np.cosh(h)) / math.sqrt(MASS * LENGTH)
    return Tube(np.asarray((2 * h / LENGTH) ** 2 * math.sqrt(EI / MASS)), np.asarray(middle))


@dataclass(frozen=True)
class Motion:
    """The tubes at `AT`, and the switches on the way."""

    displacement: Array
    """Of the middles, m, shape ``(3,)``."""
    velocity: Array
    """Of the middles, m/s, shape ``(3,)``."""
    switches: tuple[tuple[float, int], ...]
    """Time, s, and the stop that closes or opens: 0 between the first two tubes, 1 between the others."""


def _rows(tube: Tube) -> tuple[Array, Array, Array]:
    """Squared frequencies, and the rows that read the middles and what the stops see, of all coordinates."""
    middles = np.asarray(np.kron(np.eye(TUBES), tube.middle), dtype=float)
    return np.asarray(np.tile(tube.omega**2, TUBES), dtype=float), middles, middles[:-1] - middles[1:]


def stepped(tube: Tube, step: float = STEP) -> Motion:
    """The motion by the document's scheme, first the velocity by a step, then with it the displacement."""
    squares, middles, seen = _rows(tube)
    q, v = np.zeros(squares.size), np.zeros(squares.size)
    for _ in range(round(AT / step)):
        pressed = STIFFNESS * np.maximum(seen @ q - GAP, 0.0)
        v += step * (FORCE * middles[0] - squares * q - seen.T @ pressed)
        q += step * v
    return Motion(middles @ q, middles @ v, ())


def exact(tube: Tube) -> Motion:
    """The motion in closed form between switches, each bisected to rounding."""
    squares, middles, seen = _rows(tube)
    q, v, t = np.zeros(squares.size), np.zeros(squares.size), 0.0
    step, closed, switches = 2 * math.pi / (_SAMPLES * tube.omega[-1]), np.zeros(TUBES - 1, dtype=bool), []
    states: dict[bytes, tuple[Array, Array, Array]] = {}
    while t < AT:
        if closed.tobytes() not in states:
            K = np.diag(squares) + STIFFNESS * seen[closed].T @ seen[closed]
            lam, V = np.linalg.eigh(K)
            static = V.T @ (FORCE * middles[0] + STIFFNESS * GAP * seen[closed].sum(axis=0)) / lam
            states[closed.tobytes()] = np.sqrt(lam), V, static
        omega, V, static = states[closed.tobytes()]
        a, b, rows = V.T @ q - static, V.T @ v / omega, seen @ V

        def beyond(s: Array, parts: tuple[Array, ...] = (omega, static, a, b, rows), shut: Array = closed) -> Array:
            w, still, one, other, read = parts
            angle = np.outer(w, s)
            gaps = read @ (still[:, None] + one[:, None] * np.cos(angle) + other[:, None] * np.sin(angle)) - GAP
            return np.where(shut[:, None], -gaps, gaps)  # positive where a stop switches

        samples = step * np.arange(1, min(_BLOCK, math.ceil((AT - t) / step)) + 1)
        s, stop = _first(beyond, samples, step)
        s = min(s, AT - t)
        angle = omega * s
        q = V @ (static + a * np.cos(angle) + b * np.sin(angle))
        v, t = V @ (omega * (b * np.cos(angle) - a * np.sin(angle))), t + s
        if stop >= 0 and t < AT:
            closed = closed.copy()
            closed[stop] ^= True
            switches.append((t, stop))
    return Motion(middles @ q, middles @ v, tuple(switches))


def _first(beyond: Callable[[Array], Array], samples: Array, step: float) -> tuple[float, int]:
    """Time, s, and index of the first stop that switches at or before one of the samples; the last and -1 if none."""
    found, stop = float(samples[-1]), -1
    for k, row in enumerate(beyond(samples)):
        here = np.flatnonzero(row > 0)
        if here.size and samples[here[0]] - step < found:
            low, high = samples[here[0]] - step, samples[here[0]]
            while high - low > 1e-15:
                middle = (low + high) / 2
                if middle in (low, high):
                    break
                low, high = (low, middle) if beyond(np.array([middle]))[k, 0] > 0 else (middle, high)
            if stop < 0 or high < found:
                found, stop = float(high), k
    return found, stop


def answers(symmetric: int) -> dict[str, float]:
    """The first impact of both stops, s, and displacements, m, and velocities, m/s, of the middles at `AT`."""
    found = exact(uniform(symmetric))
    first = {f"impact {k + 1}": next(t for t, stop in found.switches if stop == k) for k in range(TUBES - 1)}
    moved = {f"displacement {i + 1}": float(z) for i, z in enumerate(found.displacement)}
    return first | moved | {f"velocity {i + 1}": float(v) for i, v in enumerate(found.velocity)}


def main() -> None:
    """Print the converged numbers with 40 and with 80 symmetric modes a tube."""
    coarse, fine = answers(40), answers(80)
    for name, value in fine.items():
        print(f"{name:16} {coarse[name]:.9g} {value:.9g}")


if __name__ == "__main__":
    main()
