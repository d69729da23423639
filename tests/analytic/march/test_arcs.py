"""Arcs with a given contact sequence: against the march, differences, and quotients in fifty digits."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import lru_cache

import mpmath as mp
import numpy as np
import pytest

import analytic
from analytic.march.arcs import JointArcs
from analytic.march.oscillator import DRIFTING, OSCILLATING, SPLIT
from analytic.period_map import PeriodMap
from lapjoint import ModalDamping, NoDamping, Problem, Support, ViscousDamping
from lapjoint.answers import SectionPoint
from lapjoint.orbits.arcs import ContactSequence
from lapjoint.problem import FloatArray
from tests.helpers.population import harmonic_joint, joint, lasting_joint, stiffened_joint

Kind = Callable[[int, int], Problem]


def overdamped(seed: int, index: int) -> Problem:
    """The first mode decays without oscillating, and the second nearly so."""
    return joint(seed, index).replace(damping=ModalDamping(ratio=(3.0, 1.5, 0.1)))


def with_a_rigid_body(seed: int, index: int) -> Problem:
    """A pinned beam, undamped in every second problem, which turns about its pin."""
    damping = ViscousDamping(coefficient=0.5) if index % 2 else NoDamping()
    pin = (Support(x=0.0, translational=math.inf),)
    return stiffened_joint(seed, index).replace(damping=damping, supports=pin)


KINDS: list[Kind] = [joint, stiffened_joint, lasting_joint, harmonic_joint, overdamped, with_a_rigid_body]


SOME = pytest.mark.parametrize("seeds", [range(24), pytest.param(range(24, 144), marks=pytest.mark.slow)], ids=str)


@lru_cache(maxsize=24)
def mapped(seed: int) -> tuple[PeriodMap, SectionPoint]:
    """A joint with 5 to 24 modes, every twelve two of each kind, and a motion of it some periods from rest."""
    rng, kind = np.random.default_rng((107, seed)), KINDS[seed // 2 % len(KINDS)]
    period_map = analytic.Solver(n_modes=int(rng.integers(5, 25))).period_map(kind(93, seed))
    return period_map, period_map.march(period_map.initial(), 2 * int(rng.integers(1, 12))).end


def quotient(coefficient: mp.mpc, rate: mp.mpc, d: mp.mpf) -> tuple[mp.mpf, mp.mpf, mp.mpf]:
    """The mean rate of the real part of an exponential over a duration, its derivative, and the size of the rate."""
    first, second = coefficient * rate, coefficient * rate**2 / 2
    if d:
        first = coefficient * (mp.exp(rate * d) - 1) / d
        second = (coefficient * rate * mp.exp(rate * d) - first) / d
    return first.real, second.real, abs(coefficient * rate)


def in_many_digits(
    arcs: JointArcs, slot: int, start: FloatArray, time: float, d: float, stop: int
) -> tuple[mp.mpf, mp.mpf, mp.mpf]:
    """(h(end) - h(start)) / d of a stop at the top, its derivative by d, and the size of its terms."""
    tables = arcs.joint.tables
    n, u, total = int(tables.modes[slot]), int(tables.position[stop]), [mp.mpf(0)] * 3
    extra = n
    turns = [
        (mp.expj(angle), mp.mpf(w)) for angle, w in zip(tables.omega * time + tables.phase, tables.omega, strict=True)
    ]

    def add(weight: mp.mpc, coefficient: mp.mpc, rate: mp.mpc) -> None:
        total[:] = [it + one for it, one in zip(total, quotient(weight * coefficient, rate, mp.mpf(d)), strict=True)]

    for i in range(n):
        weight, root, static = (
            mp.mpmathify(it[slot][i]) for it in (tables.weight[:, u], tables.root, tables.static[..., 0])
        )
        x, y = start[i] - static, start[n + i] - mp.mpf(tables.static[slot, i, 1])
        for wave, (turn, omega) in zip(tables.harmonic[slot, :, i], turns, strict=True):
            x, y = x - (mp.mpc(wave) * turn).imag, y - omega * (mp.mpc(wave) * turn).real
        if tables.kind[slot, i] == OSCILLATING:
            add(weight, mp.mpc(x, -(y - root.real * x) / root.imag), root)
        elif tables.kind[slot, i] == SPLIT:
            other = mp.mpmathify(tables.root[slot, extra])
            extra += 1
            add(weight, (y - other * x) / (root - other), root)
            add(weight, (root * x - y) / (root - other), other)
        rigid = y if tables.kind[slot, i] == DRIFTING else 0
        drift = rigid + mp.mpf(tables.static[slot, i, 1]) + tables.static[slot, i, 2] * mp.mpf(d)
        total[0], total[2] = total[0] + weight * drift, total[2] + abs(weight * drift)
        total[1] += weight * tables.static[slot, i, 2]
    for wave, (turn, omega) in zip(tables.forced[slot, u], turns, strict=True):
        add(mp.mpc(0, -1), mp.mpc(wave) * turn, mp.mpc(0, omega))
    return total[0], total[1], total[2]


@SOME
def test_equations_of_short_contacts_lose_no_digits(seeds: range) -> None:
    for seed in seeds:
        period_map, point = mapped(seed)
        arcs, rng = period_map.arcs, np.random.default_rng((110, seed))
        stop = int(rng.integers(arcs.joint.stops))
        sequence = ContactSequence(point.state, (stop, stop))
        for d in (0.0, *(sign * 10.0**-k for k in (3, 6, 9, 12) for sign in (1, -1))):
            durations = np.array([0.2, d, 0.1]) * arcs.period
            chain = arcs.chain(sequence, arcs.coordinates(point), 0.0, durations)
            assert chain.events_by is not None
            slot = arcs.joint.slot(sequence.states[1])
            sign, begin = arcs.problem.stops[stop].sign, chain.starts[1]
            with mp.workdps(60):
                exact = in_many_digits(arcs, slot, begin, float(chain.times[1]), float(durations[1]), stop)
                value, slope, most = (float(it) for it in exact)
            fastest = arcs.joint.tables.fastest[slot]
            assert abs(chain.events[1] - sign * value) <= 1e-14 * most, (seed, d)
            assert abs(chain.events_by[1, chain.starts[0].size + 1] - sign * slope) <= 1e-14 * most * fastest, (seed, d)
