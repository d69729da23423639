"""Stops fixed in space, past which the base moves: contacts, forces, derivatives and steady states of both solvers."""

from __future__ import annotations

import cmath
import math
import multiprocessing
import os
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from functools import partial

import numpy as np
import pytest
from preloaded import CERTIFICATES, COARSE, COUNT, SOLVERS, check, judged, spatial_joint, witnessed
from refining import AnySolver
from scipy.optimize import brentq

import analytic
import fe_lapjoint
from lapjoint import BaseMotion, Beam, Problem, Stop, Support
from lapjoint.problem import ViscousDamping

FEW = (0, 3, 5, 13, 21)  # a sine and harmonics, stops in space beside others, interferences
QUICK = (2, 13)
SMALL = (analytic.Solver(n_modes=8), fe_lapjoint.Solver(elements=4))  # few coordinates, for differences


@pytest.mark.parametrize("index", FEW)
def test_a_march_in_tiny_steps_meets_the_same_stops_in_space(index: int) -> None:
    assert not witnessed(spatial_joint, index)


@pytest.mark.slow
def test_a_march_in_tiny_steps_meets_the_same_stops_in_space_of_many_joints() -> None:
    with ProcessPoolExecutor(os.cpu_count(), multiprocessing.get_context("spawn")) as pool:
        every = pool.map(partial(witnessed, spatial_joint), range(COUNT))
        assert not [line for found in every for line in found]


@pytest.mark.parametrize("solver", SMALL)
def test_no_certificate_of_a_few_joints_with_stops_in_space_is_false(solver: AnySolver) -> None:
    check([judged(spatial_joint, solver, index) for index in QUICK])


@pytest.mark.slow
@pytest.mark.long_march
@pytest.mark.parametrize("solver", [SOLVERS[0], COARSE])
def test_no_certificate_of_joints_with_stops_in_space_is_false(solver: AnySolver) -> None:
    with ProcessPoolExecutor(os.cpu_count(), multiprocessing.get_context("spawn")) as pool:
        check(list(pool.map(partial(judged, spatial_joint, solver), range(CERTIFICATES))))


# A mass on a spring beside a wall that stands still, SDND102 of Code_Aster's validation manual

MASS, SPRING, RATIO, PULSE = 25.0, 98_696.0, 0.07, 20 * math.pi  # kg, N/m, 1, rad/s
WALL, GAP = 5.76e7, 0.5e-3  # N/m, m
DURATION = 1.0  # s
RIGID = 1e11  # N m2: a bar that the wall bends by 6e-4 of what its spring gives
OFF = 1e-3  # of the largest: what that bar bends, which the next test measures


@dataclass(frozen=True)
class Hit:
    """One contact of a mass."""

    start: float
    end: float
    impulse: float
    peak: float


def base(t: float) -> tuple[float, float]:
    """y and y' of the base, whose acceleration is sin(PULSE t)."""
    return -math.sin(PULSE * t) / PULSE**2, -math.cos(PULSE * t) / PULSE


def mass_against_a_wall(duration: float) -> list[Hit]:
    """The contacts of one mass by its closed form between switches; a switch is looked for on a fine grid."""
    drag, z, v, t, pressed, hits = 2 * RATIO * math.sqrt(SPRING / MASS), 0.0, 0.0, 0.0, False, []
    while t < duration:
        k = (SPRING + WALL * pressed) / MASS
        # z'' + drag z' + k z = -y'' - wall (y - gap) of the pressed wall, on exp(i PULSE t)
        force = -1.0 + (WALL / MASS / PULSE**2 if pressed else 0.0)
        answer, still = force / (k - PULSE**2 + 1j * drag * PULSE), (WALL * GAP / MASS / k if pressed else 0.0)
        root = -drag / 2 + 1j * math.sqrt(k - drag**2 / 4)
        now = answer * cmath.exp(1j * PULSE * t)
        x, y = z - still - now.imag, v - PULSE * now.real
        free = x - 1j * (y - root.real * x) / root.imag

        def at(
            s: float,
            t: float = t,
            free: complex = free,
            root: complex = root,
            answer: complex = answer,
            still: float = still,
        ) -> tuple[float, float]:
            wave, own = answer * cmath.exp(1j * PULSE * (t + s)), free * cmath.exp(root * s)
            return still + wave.imag + own.real, PULSE * wave.real + (root * own).real

        def depth(s: float, t: float = t, at: Callable[[float], tuple[float, float]] = at) -> float:
            return at(s)[0] + base(t + s)[0] - GAP

        step, s = 2 * math.pi / math.sqrt(k) / 400, 0.0
        sign = -1.0 if pressed else 1.0
        s = step * 1e-3
        while sign * depth(s + step) < 0 and t + s < duration:
            s += step
        if t + s >= duration:
            break
        end = brentq(depth, s, s + step, xtol=1e-16)
        if pressed:
            grid = np.linspace(0.0, end, 20001)
            pushed = WALL * np.array([max(depth(float(one)), 0.0) for one in grid])
            hits.append(Hit(t, t + end, float(np.trapezoid(pushed, grid)), float(pushed.max())))
        (z, v), t, pressed = at(end), t + end, not pressed
    return hits


def bar_beside_a_wall(EI: float) -> Problem:
    """A bar on two springs that only translates, as its mass, springs and walls are symmetric."""
    ends = (0.0, 1.0)
    return Problem(
        beam=Beam(length=1.0, bending_stiffness=EI, mass_per_length=MASS),
        supports=tuple(Support(x=x, translational=SPRING / 2) for x in ends),
        stops=tuple(Stop(x=x, side="top", gap=GAP, stiffness=WALL / 2, fixed_to="space") for x in ends),
        damping=ViscousDamping(coefficient=2 * RATIO * math.sqrt(SPRING * MASS)),
        base_motion=BaseMotion(amplitude=1 / PULSE**2, angular_frequency=PULSE, phase=math.pi),
    )


@pytest.mark.parametrize("solver", [analytic.Solver(n_modes=4), fe_lapjoint.Solver(elements=2)])
def test_a_mass_meets_a_wall_fixed_in_space_as_its_closed_form_does(solver: AnySolver) -> None:
    hits = mass_against_a_wall(DURATION)
    contacts = [c for c in solver.simulate(bar_beside_a_wall(RIGID), DURATION, errors=False).contacts if c.stop == 0]
    assert len(hits) > 5
    assert max(hit.peak for hit in hits) > 1100.0
    first = [c for c in contacts if not c.open_end][: len(hits)]
    largest = max(hit.impulse for hit in hits)
    for hit, contact in zip(hits[:4], first, strict=False):
        assert contact.start == pytest.approx(hit.start, abs=OFF * hit.start)
        assert 2 * contact.impulse == pytest.approx(hit.impulse, abs=OFF * largest)
        assert 2 * contact.peak_force == pytest.approx(hit.peak, rel=20 * OFF)
