"""Cases disagree where a number is a little off; `lapjoint validate --quick` in `.ci/run` shows that they agree.

Faults of the code that cases must notice stand in `validation.faults`.  Here are some of what cases read and compare.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from itertools import pairwise
from typing import Any

import pytest

from analytic.march.step_bound import first_root_of_bound
from analytic.published import steady
from analytic.published.loss import FrozenPart, frozen_part
from lapjoint import History, Problem
from lapjoint.problem import Beam, files
from validation.cases import (
    as_given,
    as_published,
    balance,
    certified_steps,
    one_mode,
    random_linear,
    random_stops,
)
from validation.statistics_estimates import joint_factor
from validation.verdict import Verdict


def disagree(items: Any) -> list[str]:
    return [item.line for item in items if item.verdict is Verdict.DISAGREE]


def quick(case: Any) -> list[str]:
    """What disagrees in the quick run of a case."""
    return disagree(case.run("quick", lambda _: None).items)


def test_cases_compare_what_they_are_for() -> None:
    names = {case: [item.name for item in case.run("quick", lambda _: None).items] for case in (balance, one_mode)}
    for case, part in ((balance, "angular momentum"), (one_mode, "frequency: FE"), (one_mode, "harmonic 3: analytic")):
        assert any(part in name for name in names[case])


def read_with(change: Callable[[Problem], Problem]) -> Callable[[str], Problem]:
    """A reader of problem files that makes a mistake."""
    return lambda text: change(files.from_toml(text))


def wide(problem: Problem) -> Problem:
    return problem.replace(stops=[s.model_copy(update={"gap": 1.01 * s.gap}) for s in problem.stops])


def without_phase(problem: Problem) -> Problem:
    base = problem.base_motion
    return problem if base is None else problem.replace(base_motion=base.model_copy(update={"phase": 0.0}))


MASS = Beam.m.fget  # type: ignore[attr-defined]
GROUND: dict[str, tuple[str, Any]] = {
    "a gap of a file read one percent wide": ("validation.cases.as_given.from_toml", read_with(wide)),
    "a phase that is not read": ("validation.cases.as_given.from_toml", read_with(without_phase)),
    "mass per length": ("lapjoint.problem.beam.Beam.m", property(lambda self: 1.001 * MASS(self))),
    "the side of a stop": ("lapjoint.problem.supports_and_stops.Stop.sign", property(lambda self: 1)),
}


@pytest.mark.parametrize("fault", GROUND)
def test_a_fault_of_the_ground_is_caught(fault: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(*GROUND[fault])
    assert quick(as_given)


@pytest.mark.parametrize("factor", [1.00001, 0.99])
def test_steps_of_another_length_are_noticed(factor: float, monkeypatch: pytest.MonkeyPatch) -> None:
    def longer(h: float, h1: float, h2: float, b3: float, most: float) -> float:
        return min(factor * first_root_of_bound(h, h1, h2, b3, most), most)

    monkeypatch.setattr(certified_steps, "first_root_of_bound", longer)
    assert disagree(certified_steps.steps(certified_steps.cubics()[:400]))


def test_another_number_of_repeats_of_the_published_scheme_is_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(steady, "REPEATS", 21)
    assert disagree(as_published.settled("515 rad/s", as_published.paper(515.0)))


def test_losses_of_the_published_scheme_that_are_a_thousandth_off_are_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    def off(history: History) -> FrozenPart:
        found = frozen_part(history)
        return replace(found, kinetic=1 - 1.001 * (1 - found.kinetic))

    monkeypatch.setattr(as_published, "frozen_part", off)
    assert disagree(as_published.left_behind())


def test_a_random_beam_a_tenth_too_heavy_is_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(random_linear, "SOLVERS", {"analytic": random_linear.SOLVERS["analytic"]})
    monkeypatch.setattr(random_linear, "BEAM", replace(random_linear.BEAM, mass=1.1 * random_linear.BEAM.mass))
    assert quick(random_linear)


@pytest.mark.thorough
def test_a_spring_under_random_excitation_a_tenth_too_soft_is_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    kept, made = random_stops.OSCILLATOR, random_stops.bar
    soft = replace(kept, omega=0.9**0.5 * kept.omega)

    def bar(band: tuple[float, float]) -> Any:
        """The bar of one oscillator while another is the reference."""
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr(random_stops, "OSCILLATOR", kept)
            return made(band)

    monkeypatch.setattr(random_stops, "SOLVERS", {"analytic": random_stops.SOLVERS["analytic"]})
    monkeypatch.setattr(random_stops, "bar", bar)
    monkeypatch.setattr(random_stops, "OSCILLATOR", soft)
    assert quick(random_stops)


def test_intervals_that_are_to_hold_together_are_wider() -> None:
    assert joint_factor(1, 0.95) == pytest.approx(1.0)
    assert joint_factor(20, 0.95) == pytest.approx(3.0233 / 1.95996, rel=1e-4)


def test_a_wider_band_leaves_out_less() -> None:
    parts = [sum(random_stops.bias(band)) for band in random_stops.BANDS]
    assert all(after < before / 1.8 for before, after in pairwise(parts))
