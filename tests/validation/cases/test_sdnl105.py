"""The case `sdnl105`: printed values are repeated, both solvers converge to others, and other tubes are noticed."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from lapjoint import Problem
from validation.cases import sdnl105
from validation.references import three_tubes
from validation.references.reading import printed
from validation.verdict import Verdict

WITNESSED = {"impact": 2, "displacement": 3, "velocity": 3}


@pytest.mark.thorough
def test_only_the_printed_values_differ_and_for_a_reason_that_is_named() -> None:
    result = sdnl105.run("quick", lambda _: None)
    assert result.verdict is Verdict.EXPLAINED
    explained = {item.name for item in result.checks if item.verdict is Verdict.EXPLAINED}
    assert len(explained) == 6
    assert all("printed against converged" in name for name in explained)


def test_five_modes_of_ten_elements_give_the_printed_values() -> None:
    """To 0.3 % in exact time, and to 0.05 % in the document's steps."""
    mesh = three_tubes.meshed()
    for motion, far in ((three_tubes.exact(mesh), 3e-3), (three_tubes.stepped(mesh), 5e-4)):
        for key in ("displacement", "velocity"):
            given = [printed("sdnl105 printed", key, i).value for i in range(3)]
            assert getattr(motion, key) == pytest.approx(given, rel=far)


def test_the_modes_of_a_mesh_are_those_of_the_beam() -> None:
    mesh, beam = three_tubes.meshed(40, 5), three_tubes.uniform(3)
    assert mesh.omega[::2] == pytest.approx(beam.omega, rel=1e-4)
    assert np.abs(mesh.middle[::2]) == pytest.approx(np.abs(beam.middle), rel=1e-4)
    assert mesh.middle[1::2] == pytest.approx(0.0, abs=1e-9)


def test_exact_time_is_what_small_steps_give() -> None:
    tube = three_tubes.uniform(2)
    squares, middles, seen = three_tubes._rows(tube)

    def rates(_: float, at: np.ndarray) -> np.ndarray:
        q, v = np.split(at, 2)
        pressed = three_tubes.STIFFNESS * np.maximum(seen @ q - three_tubes.GAP, 0.0)
        return np.concatenate([v, three_tubes.FORCE * middles[0] - squares * q - seen.T @ pressed])

    start = np.zeros(2 * squares.size)
    end = solve_ivp(rates, (0.0, three_tubes.AT), start, method="DOP853", rtol=1e-9, atol=1e-9, max_step=2e-3).y[:, -1]
    found = three_tubes.exact(tube)
    assert len(found.switches) > 6
    assert found.displacement == pytest.approx(middles @ end[: squares.size], rel=1e-6)
    assert found.velocity == pytest.approx(middles @ end[squares.size :], rel=1e-5)


@pytest.mark.thorough
def test_the_program_gives_the_digits_that_are_kept() -> None:
    coarse, fine = three_tubes.answers(40), three_tubes.answers(80)
    for key, count in WITNESSED.items():
        for i in range(count):
            name, kept = f"{key} {i + 1}", printed("sdnl105 answers", key, i)
            allowed = sdnl105.UNDER_THE_LOAD if name == "velocity 1" else kept.half_unit
            assert abs(fine[name] - kept.value) <= allowed
            assert abs(fine[name] - coarse[name]) <= allowed


@pytest.mark.thorough
@pytest.mark.parametrize("changed", [{"gap": 1.001e-3}, {"stiffness": 1.01e8}, {"between": ("b:0.51", "a:0.5")}])
def test_another_stop_disagrees(changed: dict[str, object], monkeypatch: pytest.MonkeyPatch) -> None:
    right = sdnl105.as_published()

    def wrong() -> Problem:
        return right.replace(stops=(right.stops[0].model_copy(update=changed), *right.stops[1:]))

    monkeypatch.setattr(sdnl105, "as_published", wrong)
    assert sdnl105.run("quick", lambda _: None).verdict is Verdict.DISAGREE
