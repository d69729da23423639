"""Where it is not certain whether the force of a damped stop ends and begins again."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from random_joints import DAMPED
from refining import AnySolver

import analytic
import fe_lapjoint
from lapjoint import History, Stop
from lapjoint.answers import Contact
from lapjoint.answers.contact_state import ContactState
from lapjoint.orbits import orbit_errors
from lapjoint.orbits.contact_errors import with_contact_errors
from lapjoint.orbits.force_breaks import cut, undecided_breaks, undecided_breaks_of_orbit
from lapjoint.orbits.newton import Orbit
from lapjoint.orbits.refinement import Refinement
from lapjoint.problem import FloatArray
from tests.helpers.beams import unit_cantilever

TWICE = Refinement("finer", 2.0, 4.0)  # allows four times a difference of forces: three, and a third of three
GAP, K = 1.0, 10.0


def dipping(least: float, *, may_pull: bool = False) -> History:
    """A motion from 0 to 2 s in which the tip is `least` + (t - 1)^2 beyond its stop."""

    def field(x: FloatArray, t: FloatArray, dx: int = 0, dt: int = 0) -> FloatArray:
        return np.outer(np.ones(x.size), 2 * (t - 1) if dt else GAP + least + (t - 1) ** 2)

    stop = Stop(x=1.0, side="top", gap=GAP, stiffness=K, damping=1e-9, may_pull=may_pull)
    problem = unit_cantilever(stop)
    return History(
        problem=problem,
        solver="",
        start=0.0,
        end=2.0,
        switch_times=np.zeros(0),
        states=(ContactState({0}),),
        contacts=(Contact(0, 0.0, 2.0, 1.0, 1.0, open_start=True, open_end=True),),
        field=field,
    )


@pytest.mark.parametrize(("own", "finer", "certain"), [(0.01, 0.012, True), (0.01, 0.013, False), (-0.01, 0.0, False)])
def test_a_dip_of_a_force_is_certain_where_it_is_above_its_error(own: float, finer: float, certain: bool) -> None:
    found = undecided_breaks(dipping(own), dipping(finer), TWICE)
    assert found.shape == (2, not certain)
    if not certain:
        assert found[:, 0] == pytest.approx([1.0, 0.0], abs=2e-2)


def test_a_stop_that_may_pull_has_no_such_breaks() -> None:
    assert not undecided_breaks(dipping(0.01, may_pull=True), dipping(0.02, may_pull=True), TWICE).size


def test_an_uncertain_break_leaves_all_but_the_start_of_its_contact_unknown() -> None:
    found = with_contact_errors(dipping(0.01), TWICE, lambda: dipping(0.02))
    (contact,) = found.contacts
    assert contact.start_error == 0.0
    assert [contact.impulse_error, contact.peak_force_error, contact.dissipated_error] == [np.inf] * 3
    assert "not always certain" in found.error_source


def test_a_break_is_within_a_contact_or_between_two() -> None:
    times = ((0.1, 0.4), (0.5, 1.0))
    history = dipping(0.01)
    contacts = tuple(Contact(0, *pair, 1.0, 1.0) for pair in times)
    at = [cut(replace(history, contacts=contacts), np.array([[t], [0.0]])) for t in (0.2, 0.45, 0.6, 1.2)]
    assert [it.astype(int).tolist() for it in at] == [
        [[1, 0], [0, 0], [0, 0]],
        [[0, 0], [0, 1], [1, 0]],
        [[0, 1], [0, 0], [0, 0]],
        [[0, 0], [0, 0], [0, 1]],
    ]


def test_an_uncertain_break_leaves_the_energy_of_the_whole_motion_known() -> None:
    found = with_contact_errors(dipping(0.01), TWICE, lambda: dipping(0.02)).dissipated_errors()
    assert found is not None
    assert np.isfinite(found).all()


@pytest.mark.parametrize(
    "solver", [analytic.Solver(), pytest.param(fe_lapjoint.Solver(elements=8), marks=pytest.mark.thorough)]
)
@pytest.mark.parametrize(("index", "certain"), [(2, True), (7, False)])
def test_the_closed_form_of_an_orbit_shows_the_breaks_that_samples_show(
    solver: AnySolver, index: int, certain: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    told = list[tuple[FloatArray, Refinement]]()

    def listened(orbit: Orbit, finer: Orbit, refinement: Refinement) -> FloatArray:
        told.append((undecided_breaks_of_orbit(orbit, finer, refinement), refinement))
        return told[-1][0]

    monkeypatch.setattr(orbit_errors, "undecided_breaks_of_orbit", listened)
    steady = solver.steady_state(DAMPED(31415, index), sensitivity=False)
    ((exact, refinement),) = told
    assert steady.comparison is not None
    sampled = undecided_breaks(steady.history, steady.comparison.history, refinement)
    assert np.all(cut(steady.history, exact) >= cut(steady.history, sampled))
    if certain:
        assert not exact.size
    spacing = steady.history.end - steady.history.start
    for t in sampled[0].tolist():
        assert np.abs(exact[0] - t).min() <= 0.01 * spacing
