"""Random stiff bars at whose motions of one contact a symmetry breaks, or a torus is born, by closed form.

`draw` gives the text of a problem file, which the witness of numpy alone reads as well as both solvers do: a bar on a
pin between two equal stops, or one on two springs beside one stop, whose two motions couple there.  In the range of
amplitudes of its base lies one bifurcation of these motions, and no other.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cache

import numpy as np
from scipy.optimize import brentq

from validation.references.bilinear_map import BilinearMap, OneContact
from validation.references.rigid_bar import RigidBar

LENGTH, MASS, GAP = 1.5, 4.0, 1e-3  # m, kg/m and m
BENDING = 2.5e6
"""N m2: bars bend by less than a hundredth of what they move."""
SIDE = 0.003, 0.06  # least and largest logarithm of amplitudes at the ends of the range over that at the bifurcation
_BESIDE = (0.02, 0.1)  # least and largest distance of the leading multiplier from the circle at the ends of the range
_WITHIN = 0.97  # largest modulus of all others
_BEAM = f"""
[beam]
length = {LENGTH}
bending_stiffness = {{bending!r}}
mass_per_length = {MASS}
[base_motion]
amplitude = {{amplitude!r}}
angular_frequency = {{omega!r}}
[initial]
kind = "polynomial"
displacement = {{displacement!r}}
velocity = {{velocity!r}}
[damping]
"""


@dataclass(frozen=True)
class ContactBar:
    """A bar, and what is known of it."""

    tables: str
    """All but the beam, the base and the initial state, as text of a problem file."""
    map: BilinearMap
    """Its motions of one contact in closed form."""
    at: OneContact
    """That at the bifurcation."""
    low: OneContact
    """That of the least amplitude."""
    high: OneContact
    """That of the largest one."""

    @property
    def stable(self) -> OneContact:
        """The end of the range at which the motion is stable."""
        return self.low if abs(self.low.multipliers[0]) < 1 else self.high

    @property
    def unstable(self) -> OneContact:
        """The other one."""
        return self.high if self.stable is self.low else self.low

    def text(self, motion: OneContact, bending: float = BENDING) -> str:
        """The problem file of a motion's amplitude, which begins on the motion."""
        return _text(self.tables, self.map, motion, bending)

    def bar(self, motion: OneContact) -> RigidBar:
        """The rigid bar of a motion's amplitude."""
        return RigidBar.from_toml(self.text(motion))

    def motion(self, amplitude: float) -> OneContact:
        """The motion of an amplitude in the range."""

        def beyond(d: float) -> float:
            return self.map.motion(d).amplitude - amplitude

        return self.map.motion(float(brentq(beyond, self.low.duration, self.high.duration, rtol=1e-15)))


@cache
def draw(seed: int, kind: str) -> ContactBar:
    """The first bar of a seed whose symmetry breaks, or whose motion has a Neimark-Sacker."""
    rng = np.random.default_rng((seed, kind == "neimark-sacker"))
    while True:
        known = _between_stops(rng) if kind == "symmetry breaking" else _on_springs(rng)
        found = _range_around(*known, kind)
        if found is not None:
            return found


def _between_stops(rng: np.random.Generator) -> tuple[str, BilinearMap]:
    torsional = float(rng.uniform(200.0, 900.0))
    free = math.sqrt(3 * torsional / (MASS * LENGTH**3))
    stiffness, place = torsional / LENGTH**2 * _log_uniform(rng, 1.5, 12.0), float(rng.uniform(0.9, LENGTH))
    tables = f"{_damping(rng, free)}[[supports]]\nx = 0.0\ntranslational = inf\ntorsional = {torsional!r}\n"
    stops = [f'[[stops]]\nx = {place!r}\nside = "{side}"\n' for side in ("top", "bottom")]
    return _known(tables + "".join(f"{stop}gap = {GAP}\nstiffness = {stiffness!r}\n" for stop in stops), free, rng)


def _on_springs(rng: np.random.Generator) -> tuple[str, BilinearMap]:
    springs = rng.uniform(500.0, 2000.0, 2).tolist()
    free = math.sqrt(sum(springs) / (MASS * LENGTH))
    stiffness, place = sum(springs) * _log_uniform(rng, 0.5, 6.0), float(rng.uniform(0.15, 0.85)) * LENGTH
    tables = _damping(rng, free) + "".join(
        f"[[supports]]\nx = {x}\ntranslational = {k!r}\n" for x, k in zip((0.0, LENGTH), springs, strict=True)
    )
    return _known(
        f'{tables}[[stops]]\nx = {place!r}\nside = "top"\ngap = {GAP}\nstiffness = {stiffness!r}\n', free, rng
    )


def _damping(rng: np.random.Generator, free: float) -> str:
    viscous, ratio = bool(rng.integers(2)), _log_uniform(rng, 0.01, 0.08)
    if viscous:
        return f'kind = "viscous"\ncoefficient = {2 * ratio * free * MASS!r}\n'
    return f'kind = "modal"\nratio = {ratio!r}\n'


def _log_uniform(rng: np.random.Generator, low: float, high: float) -> float:
    return math.exp(rng.uniform(math.log(low), math.log(high)))


def _known(tables: str, free: float, rng: np.random.Generator) -> tuple[str, BilinearMap]:
    omega = free * float(rng.uniform(0.4, 3.0))
    head = _BEAM.format(bending=BENDING, amplitude=GAP, omega=omega, displacement=(0.0,), velocity=(0.0,))
    return tables, BilinearMap.of_bar(RigidBar.from_toml(head.replace("(0.0,)", "[0.0]") + tables))


def _text(tables: str, known: BilinearMap, motion: OneContact, bending: float) -> str:
    shapes = []
    for ends in np.split(known.start(motion), 2):
        root, tip = (0.0, float(ends[0])) if ends.size == 1 else (float(ends[0]), float(ends[1]))
        shapes.append([root, (tip - root) / LENGTH])
    head = _BEAM.format(
        bending=bending, amplitude=motion.amplitude, omega=known.omega, displacement=shapes[0], velocity=shapes[1]
    )
    return head + tables


def _range_around(tables: str, known: BilinearMap, kind: str) -> ContactBar | None:
    """The first bifurcation of a kind with enough room on either side of it."""
    for at in known.flips() if kind == "symmetry breaking" else known.neimark_sackers():
        ends = [end for end in (_end(known, at, step) for step in (-1, 1)) if end is not None]
        if len(ends) < 2:
            continue
        low, high = sorted(ends, key=lambda one: one.amplitude)
        one = ContactBar(tables, known, at, low, high)
        if abs(one.stable.multipliers[0]) < 1 < abs(one.unstable.multipliers[0]):
            return one
    return None


def _end(known: BilinearMap, at: OneContact, step: int) -> OneContact | None:
    """The motion at the end of a range on one side, joined to a bifurcation; the amplitude grows, or falls."""
    stations, count = known.stations, 2 if abs(at.multipliers[0].imag) > 0.1 else 1
    k = int(np.searchsorted([one.duration for one in stations], at.duration)) + (step - 1) // 2
    before, sign, outside = at, 0.0, None
    while 0 <= k < len(stations):
        here = stations[k]
        moduli = np.abs(here.multipliers)
        goes = math.copysign(1.0, here.amplitude - before.amplitude)
        if goes * (sign or goes) < 0 or moduli[count:].max(initial=0.0) > _WITHIN:
            return None
        leaves = int(np.count_nonzero(moduli > 1))
        if outside is not None and leaves != outside:
            return None
        sign, outside = goes, leaves
        apart, beside = abs(math.log(here.amplitude / at.amplitude)), abs(moduli[0] - 1)
        if apart > SIDE[1] or beside > _BESIDE[1]:
            return here if known.exists(here) and beside > _BESIDE[0] and apart > SIDE[0] else None
        before, k = here, k + step
    return None
