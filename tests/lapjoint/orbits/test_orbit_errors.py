"""Errors of steady states, against a solver whose true error is known: a rigid bar with stops a little too stiff."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
import pytest
from toy import BarMap, Unwilling, bar

import analytic
from lapjoint import History, Problem, SteadyState, paper_joint
from lapjoint.answers import SectionPoint
from lapjoint.orbits import Effort, Passage, find_steady_state
from lapjoint.orbits.contact_errors import with_contact_errors
from lapjoint.orbits.orbit_errors import FinerMap
from lapjoint.orbits.refinement import Refinement

TOUCHING = bar(0.8, (0.5, 5.0), (-0.5, 5.0))
ONE_SIDED = bar(0.8, (0.5, 5.0))
CHAOTIC = bar(2.6, (0.3, 30.0), ratio=0.02)


def coarse(problem: Problem, resolution: float) -> BarMap:
    """Stops too stiff by the fourth power of the inverse resolution."""
    stops = tuple(
        stop.model_copy(update={"stiffness": stop.stiffness * (1 + resolution**-4)}) for stop in problem.stops
    )
    return BarMap(problem.replace(stops=stops), f"resolution {resolution:g}")


def finer(problem: Problem, resolution: float, ratio: float = 1.5) -> Callable[[], FinerMap]:
    return lambda: FinerMap(Refinement("the finer bar", ratio, 4.0), coarse(problem, resolution * ratio))


def answered(problem: Problem, resolution: float, other: Callable[[], FinerMap] | None, **options: bool) -> SteadyState:
    effort = Effort(max_period_multiple=8, max_periods=3000, growth=False)
    return find_steady_state(coarse(problem, resolution), "bar", effort, finer=other, **options)


@pytest.mark.parametrize(("problem", "resolution"), [(TOUCHING, 10.0), (ONE_SIDED, 3.0)])
def test_errors_are_the_true_ones_with_a_margin(problem: Problem, resolution: float) -> None:
    found, exact = answered(problem, resolution, finer(problem, resolution)), answered(problem, 1e9, None)
    assert found.impulse_errors is not None
    true = np.abs(found.impulses - exact.impulses)
    assert np.all(true <= found.impulse_errors)
    assert np.all(found.impulse_errors <= 4 * true.max())
    assert found.error_source == found.history.error_source == "compared with the finer bar"
    assert_contacts_are_within_their_errors(found.history, exact.history, np.inf)


def assert_contacts_are_within_their_errors(found: History, exact: History, most: float) -> None:
    """Starts, impulses and peak forces are known to their errors, which are below `most`, in s, N s and N."""
    for contact, other in zip(found.contacts, exact.contacts, strict=True):
        for name in ("start", "impulse", "peak_force"):
            error = getattr(contact, f"{name}_error")
            assert abs(getattr(contact, name) - getattr(other, name)) <= error < most, name


def test_a_contact_that_the_section_point_cuts_is_compared_as_a_whole() -> None:
    solver, problem = analytic.Solver(n_modes=16), paper_joint(angular_frequency=515.0)  # by default as the phase asks
    plain = solver.steady_state(problem, sensitivity=False)
    contact = next(one for one in plain.history.contacts if not (one.open_start or one.open_end))
    shifted = problem.with_base_numbers(phase=515.0 * (contact.start + contact.end) / 2)
    found = solver.steady_state(shifted, sensitivity=False)
    assert found.impulse_errors == pytest.approx(plain.impulse_errors, rel=0.1)
    cut = [one for one in found.history.contacts if one.stop == contact.stop and (one.open_start or one.open_end)]
    assert len(cut) == 2
    assert cut[0].start_error == 0.0
    for half in cut:
        assert half.impulse_error == pytest.approx(contact.impulse_error, rel=0.1)
    assert cut[1].start_error == pytest.approx(contact.start_error, rel=0.1)


def test_rounding_counts_with_both_parts_of_a_contact_that_the_section_point_cuts() -> None:
    """Both resolutions are the same here, so that rounding is the whole error."""
    plain = answered(TOUCHING, 1e9, finer(TOUCHING, 1e9))
    contact = next(one for one in plain.history.contacts if not (one.open_start or one.open_end))
    shifted = TOUCHING.with_base_numbers(phase=0.8 * (contact.start + contact.end) / 2)
    found = answered(shifted, 1e9, finer(shifted, 1e9))
    halves = [one for one in found.history.contacts if one.stop == contact.stop]
    assert len(halves) == 2
    assert contact.impulse_error is not None
    assert contact.impulse_error > 0
    assert [half.impulse_error for half in halves] == pytest.approx([contact.impulse_error] * 2, rel=0.1)


def test_a_solver_without_a_finer_self_says_so() -> None:
    found = answered(TOUCHING, 10.0, None)
    assert found.impulse_errors is None
    assert "no finer self" in found.error_source
    assert all(contact.start_error is None for contact in found.history.contacts)


def test_errors_that_nobody_asked_for_are_not_made() -> None:
    def never() -> FinerMap:
        raise AssertionError

    assert answered(TOUCHING, 10.0, never, errors=False).impulse_errors is None


def test_an_untouched_stop_has_an_error_only_if_it_lies_within_the_error_of_the_motion() -> None:
    lowest = float(answered(ONE_SIDED, 2.0, None).history.displacement(0.5, np.linspace(0, 7.8, 4001)).min())
    for gap, near in ((lowest * (1 + 1e-4), True), (-40.0, False)):  # the coarse bar just does not touch the first
        problem = bar(0.8, (0.5, 5.0), (gap, 5.0))
        found = answered(problem, 2.0, finer(problem, 2.0))
        assert not any(contact.stop == 1 for contact in found.history.contacts)
        assert found.impulse_errors is not None
        assert found.impulse_errors[0] > 0
        assert found.impulse_errors[1] > 1e-3 * found.impulse_errors[0] if near else found.impulse_errors[1] == 0.0


@dataclass(frozen=True)
class Repelling(BarMap):
    """A bar whose march goes away from where it ends three times as fast as it should come near."""

    centre: SectionPoint | None = None

    def march(self, start: SectionPoint, half_periods: int) -> Passage:
        assert self.centre is not None
        away = 3.0 * self.difference(start, self.centre)
        return replace(super().march(start, half_periods), end=self.moved(self.centre, away))


@pytest.mark.parametrize(
    ("kind", "said"),
    [(Unwilling, "gave up: stopped at t = 0 s"), (Repelling, "by repelling the motion is unstable")],
)
def test_nothing_is_stated_where_the_finer_solver_gives_up_or_has_no_stable_motion(
    kind: type[BarMap], said: str
) -> None:
    plain = answered(ONE_SIDED, 10.0, None)
    other = kind(ONE_SIDED, "repelling", *([plain.section_point] if kind is Repelling else []))
    found = answered(ONE_SIDED, 10.0, lambda: FinerMap(Refinement("repelling", 1.5, 4.0), other))
    assert found.impulse_errors is not None
    assert np.all(np.isinf(found.impulse_errors))
    assert said in found.error_source
    for contact in found.history.contacts:
        assert contact.impulse_error == contact.peak_force_error == np.inf


def test_errors_of_a_march_are_the_true_ones_with_a_margin() -> None:
    marched, better, exact = (
        map_.history(map_.initial(), 12)
        for map_ in (coarse(TOUCHING, 20.0), coarse(TOUCHING, 30.0), coarse(TOUCHING, 1e9))
    )
    found = with_contact_errors(marched, Refinement("finer", 1.5, 4.0), lambda: better)
    assert found.error_source == "compared with finer"
    assert_contacts_are_within_their_errors(found, exact, 1e-2)


def test_nothing_is_stated_after_two_marches_have_parted() -> None:
    marched, better = (map_.history(map_.initial(), 60) for map_ in (coarse(CHAOTIC, 10.0), coarse(CHAOTIC, 15.0)))
    found = with_contact_errors(marched, Refinement("finer", 1.5, 4.0), lambda: better)
    assert "the two motions part" in found.error_source
    stated = [contact.impulse_error is not None and np.isfinite(contact.impulse_error) for contact in found.contacts]
    assert stated[0]
    assert not any(stated[-10:])
