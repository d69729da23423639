"""How a motion is cut in units, what is left out of it, and what is said where that cannot be right."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from beams import unit_cantilever
from random_joints import dragged_cantilever
from stretches import Cutting

import analytic
import fe_lapjoint
from lapjoint import Beam, InputError, ModalDamping, NoDamping, Problem, Stop, ViscousDamping, paper_joint
from lapjoint.problem import AtEquilibrium, Gravity, Mass
from lapjoint.summaries.measure import LONG, SETTLED, UNITS, Measure, measure, sums_of
from lapjoint.summaries.quantities import DEFAULT, STATIONS, selection
from lapjoint.summaries.table import remarks, table

SOLVER = analytic.Solver(n_modes=4)
CANTILEVER = unit_cantilever().replace(
    beam=Beam(length=1.0, bending_stiffness=2.0, mass_per_length=0.5), base_motion=None
)
FIRST = 1.8751040687**2 * math.sqrt(2.0 / 0.5)  # rad/s, of a cantilever


def of(problem: Problem, duration: float = 100.0, **options: float) -> Measure:
    return measure(selection(problem), SOLVER, duration, **options)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("damping", "rate"),
    [
        (ModalDamping(ratio=0.05), 0.05 * FIRST),
        (ModalDamping(ratio=(0.05, 1e-4)), 1e-4 * 22.0345 * 2),
        (ViscousDamping(coefficient=0.3), 0.3),
        (ViscousDamping(coefficient=30.0), 30.0 - math.sqrt(900 - FIRST**2)),
    ],
)
def test_the_slowest_mode_says_how_long_a_motion_settles(damping: ModalDamping | ViscousDamping, rate: float) -> None:
    found = of(CANTILEVER.replace(damping=damping), 1e5)
    assert found.settle == pytest.approx(SETTLED / rate, rel=1e-4)
    assert found.decay_time == pytest.approx(1 / rate, rel=1e-4)


def test_a_heavy_mass_makes_a_slow_mode_that_counts() -> None:
    """A mode 1e7 times as slow as the others is no motion as a rigid body."""
    heavy = CANTILEVER.replace(masses=(Mass(x=1.0, mass=0.5e11),))
    slowest = math.sqrt(3 * 2.0 / 0.5e11)
    found = measure(selection(heavy), fe_lapjoint.Solver(elements=8), 1e12, rate=1e-6)
    assert found.settle == pytest.approx(SETTLED / (0.05 * slowest), rel=1e-6)


def test_units_are_long_against_the_correlation_and_no_more_than_needed() -> None:
    long = of(CANTILEVER, 1e6)
    assert long.units == UNITS
    assert of(CANTILEVER, 1e6, seeds=5).units == 7
    assert of(CANTILEVER, 1e6, seeds=32).units == 1
    short = of(CANTILEVER, SETTLED * long.decay_time + 3.5 * LONG * long.decay_time)
    assert short.units == 3
    assert short.unit >= LONG * short.decay_time


@pytest.mark.parametrize(
    ("problem", "options", "message"),
    [
        (CANTILEVER.replace(damping=NoDamping()), {}, r"settle: is missing; nothing is damped"),
        (CANTILEVER, {"settle": -1.0}, r"settle = -1: must be"),
        (CANTILEVER, {"settle": 200.0}, r"duration = 100: must be longer than the 200 s"),
        (CANTILEVER, {"rate": 0.0}, r"rate = 0: must be positive"),
        (CANTILEVER, {"rate": 1e12}, r"rate = 1e\+12 Hz: gives .* samples of a motion; at most 1e\+10"),
        (CANTILEVER, {"rate": 0.1}, r"rate = 0.1 Hz: gives .* samples in each of"),
        (CANTILEVER, {"duration": math.nan}, r"duration = nan: must be positive"),
    ],
)
def test_what_cannot_be_is_refused(problem: Problem, options: dict[str, float], message: str) -> None:
    with pytest.raises(InputError, match=message):
        of(problem, **options)


def test_places_and_quantities() -> None:
    joint = paper_joint()
    found = selection(joint)
    assert [one.name for one in found.quantities] == list(DEFAULT)
    assert found.places == (1.25, 2.5)
    assert found.x.size == STATIONS  # mid-span and tip are among them
    plain = selection(CANTILEVER, at=[0.3])
    assert "stress" not in [one.name for one in plain.quantities]
    assert plain.x[plain.asked] == pytest.approx([0.3])
    for bad, message in (
        ({"quantities": ["weight"]}, r"quantity 'weight': is unknown; allowed: displacement"),
        ({"quantities": []}, r"quantity: none is named"),
        ({"quantities": ["stress"]}, r"quantity 'stress': the beam has no section"),
        ({"at": [3.0]}, r"x = 3: lies outside the beam"),
    ):
        with pytest.raises(InputError, match=message):
            selection(CANTILEVER, **bad)  # type: ignore[arg-type]


def test_a_motion_in_stretches_has_the_statistics_of_the_whole() -> None:
    """A joint under a sine: in stretches of 27 ms, and at once where a solver has no stretches."""
    joint = paper_joint(angular_frequency=820.0)
    what = measure(selection(joint), SOLVER, 0.2, settle=0.1)
    whole, cut = sums_of(what, SOLVER, joint), sums_of(what, Cutting(SOLVER, 27e-3), joint)  # type: ignore[arg-type]
    assert np.array_equal(whole.contacts, cut.contacts)
    assert whole.contacts.sum() > 0
    for name in ("squares", "time_in_contact", "impulse", "peak"):
        np.testing.assert_allclose(
            getattr(cut, name), getattr(whole, name), rtol=2e-3, atol=1e-6 * np.abs(getattr(whole, name)).max()
        )


def test_the_table_holds_values_within_their_intervals_and_says_what_is_doubtful() -> None:
    far = Stop(x=2.0, side="top", gap=1.0, stiffness=1e6)
    joint = paper_joint(angular_frequency=820.0).replace(stops=(*paper_joint().stops, far))
    what = measure(selection(joint), SOLVER, 0.3, settle=0.1)
    sums = sums_of(what, SOLVER, joint)
    found = table(what, sums)
    assert "1 unit" in remarks(what, sums, 1)[0]
    values = [name for name in found.data_vars if f"{name}_interval" in found]
    assert len(values) == 3 * 3 + 2 * 2 + 7 + 3 + 4  # of velocity and acceleration there is no mean
    for name in values:
        ends = found[f"{name}_interval"]
        assert bool((ends[..., 0] <= found[name]).all() & (found[name] <= ends[..., 1]).all()), name
        assert found[name].attrs["units"] == ends.attrs["units"]
    assert float(found.contact_rate[-1]) == 0.0
    assert np.isinf(found.impulse_rate_interval[-1, 1])  # of a stop that was never touched, nothing is known
    assert float(found.impulse_exceedance[0, 0]) == pytest.approx(float(found.contact_rate[0]), rel=0.1)
    ratio = found.stress_rms / found.moment_rms
    assert np.ptp(ratio.values[:-1]) < 1e-9 * float(ratio[0])  # at the tip both are zero


def test_a_stop_that_gravity_keeps_closed_has_the_force_of_the_beam_at_rest() -> None:
    """Of a cantilever of length 1: (q / 8 EI - gap) / (1 / 3 EI + 1 / k), all the time, and no contact begins.

    Samples of the force lack what four modes leave out of the sag, 1e-7 of it.
    """
    stiffness, gap, EI, q = 50.0, 1e-3, 2.0, 0.5 * 9.81
    joint = CANTILEVER.replace(
        stops=(Stop(x=1.0, side="bottom", gap=gap, stiffness=stiffness),),
        gravity=Gravity(acceleration=-9.81),
        initial=AtEquilibrium(),
    )
    what = replace(measure(selection(joint), SOLVER, 4.0, settle=1.0, rate=50.0), units=3)
    found = table(what, sums_of(what, SOLVER, joint)).isel(stop=0)
    force = (q / (8 * EI) - gap) / (1 / (3 * EI) + 1 / stiffness)
    for name, value in {"force_rms": force, "force_peak": force, "impulse_rate": -force, "contact_time": 1.0}.items():
        assert float(found[name]) == pytest.approx(value, rel=1e-6), name
    for name, value in {
        "force_rms": force,
        "force_maximum": force,
        "impulse_rate": -force,
        "contact_time": 1.0,
    }.items():
        assert found[f"{name}_interval"].values == pytest.approx([value, value], rel=1e-6), name
    assert float(found.contact_rate) == 0.0
    assert float(found.contact_rate_interval[1]) == pytest.approx(
        -math.log(0.025) / 3.0, rel=1e-3
    )  # Garwood's for none


def test_what_is_nothing_but_rounding_is_zero() -> None:
    problem = paper_joint(angular_frequency=820.0)
    what = measure(selection(problem, quantities=["displacement", "moment"]), SOLVER, 3.0, seeds=8, settle=1.0)
    found = table(replace(what, units=2), sums_of(replace(what, units=2), SOLVER, problem))
    for name, x in (("displacement", 0.0), ("moment", problem.beam.length)):
        for of_it in ("rms", "peak", "maximum", "mean_interval", "rms_interval", "maximum_interval"):
            assert not found[f"{name}_{of_it}"].sel(x=x).values.any(), (name, of_it)
            assert found[f"{name}_{of_it}"].isel(x=5).values.all()


def test_the_slowest_complex_mode_says_how_long_a_motion_settles() -> None:
    heavy = dragged_cantilever(np.random.default_rng(0))
    for solver in (analytic.Solver(n_modes=8), fe_lapjoint.Solver(elements=8)):
        found = measure(selection(heavy), solver, 1e12, rate=1e-6)
        slowest = solver.period_map(heavy).lowest_damping_rate
        assert found.decay_time == pytest.approx(1 / slowest, rel=0.05)  # both are of truncated matrices
