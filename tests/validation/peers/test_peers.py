"""Other solvers as witnesses, OpenSees among them; what needs OpenSees is skipped where it cannot be imported."""

from __future__ import annotations

import math
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import analytic
from lapjoint import (
    FREE,
    BaseMotion,
    Beam,
    HarmonicsBaseMotion,
    InputError,
    Outcome,
    Problem,
    Support,
    contact_states,
    paper_joint,
    sdnl104,
)
from lapjoint.cli import arguments
from lapjoint.errors import SolverError
from lapjoint.problem import (
    BaseHarmonic,
    BeamSegment,
    Gravity,
    Mass,
    NoDamping,
    PolynomialShape,
    UniformLoad,
    ViscousDamping,
)
from lapjoint.solver import Solver as AnySolver
from validation.cases import peers
from validation.invariants import witness
from validation.peers.opensees import Solver
from validation.peers.opensees_motion import contacts_of, history_of
from validation.peers.opensees_script import Record, mesh, repetition
from validation.peers.process import in_another_process
from validation.verdict import Kind, Verdict


def why_not() -> str:
    """Why OpenSees cannot be used here; empty if it can.  Asked in another process, as it may abort this one."""
    code = "from validation.peers.opensees_script import load_opensees; load_opensees()"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=120)
    return done.stderr.strip().splitlines()[-1] if done.returncode else ""


@pytest.fixture(scope="module")
def opensees() -> None:
    """OpenSees, where it can be imported."""
    reason = why_not()
    if reason:
        pytest.skip(f"openseespy cannot be imported: {reason}")


needs_opensees = pytest.mark.usefixtures("opensees")
JOINT = peers.damped_joint()
COARSE = Solver(elements=16, dt=2e-5)


STEPPED = Beam(
    length=JOINT.beam.length,
    segments=(
        BeamSegment(to=JOINT.beam.length / 2, bending_stiffness=2 * JOINT.beam.EI, mass_per_length=JOINT.beam.m),
        BeamSegment(to=JOINT.beam.length, bending_stiffness=JOINT.beam.EI, mass_per_length=JOINT.beam.m),
    ),
)


def silent(_: str) -> None:
    """Progress that nobody wants."""


def test_it_is_a_solver_and_registered() -> None:
    import tomllib

    project = tomllib.loads((Path(__file__).parents[3] / "pyproject.toml").read_text())["project"]
    assert project["entry-points"]["lapjoint.solvers"]["opensees"] == f"{Solver.__module__}:Solver"
    assert isinstance(Solver(), AnySolver)
    assert Solver().refined(2) == Solver(elements=80, dt=2e-6)


@pytest.mark.parametrize(
    ("options", "message"),
    [({"elements": 0}, "elements = 0"), ({"dt": 0.0}, "dt = 0.0"), ({"repeats": math.nan}, "repeats = nan")],
)
def test_options_out_of_range_are_named(options: dict[str, float], message: str) -> None:
    with pytest.raises(InputError, match=message):
        Solver(**options)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("problem", "message"),
    [
        (paper_joint(), "damping.kind"),
        (sdnl104(), "point_loads"),
        (JOINT.replace(initial=PolynomialShape(velocity=(0.0, 0.0, 1.0))), "initial.kind"),
        (JOINT.replace(base_motion=BaseMotion(amplitude=1e-3, angular_frequency=9.0, phase=1.0)), "base_motion.phase"),
        (
            JOINT.replace(
                base_motion=HarmonicsBaseMotion(
                    angular_frequency=9.0, harmonics=(BaseHarmonic(multiple=2, amplitude=1e-3, phase=1.0),)
                )
            ),
            r"base_motion\.harmonics\[0\]\.phase = 1: must be 0",
        ),
        (JOINT.replace(damping=NoDamping(), masses=(Mass(x=0.1, mass=1.0),)), "masses: "),
        (JOINT.replace(beam=STEPPED), r"beam\.segments: "),
        (JOINT.replace(gravity=Gravity(acceleration=-9.81)), "gravity: "),
        (JOINT.replace(uniform_loads=(UniformLoad(force_per_length=1.0),)), "uniform_loads: "),
    ],
)
def test_what_opensees_cannot_express_is_refused_in_a_line(problem: Problem, message: str) -> None:
    with pytest.raises(InputError, match=message) as refused:
        Solver().simulate(problem, 0.01)
    assert "\n" not in str(refused.value)


@pytest.mark.parametrize("changed", [{"masses": (Mass(x=0.1, mass=1.0),), "damping": NoDamping()}, {"beam": STEPPED}])
def test_modes_of_a_beam_with_masses_or_steps_are_refused(changed: dict[str, object]) -> None:
    with pytest.raises(InputError, match="the OpenSees solver knows beams"):
        Solver().modes(JOINT.replace(**changed))


def test_a_step_far_too_short_is_refused() -> None:
    with pytest.raises(InputError, match="more than 1000000 steps"):
        Solver(dt=1e-9).simulate(JOINT, 1.0)


def test_a_crash_in_the_other_process_is_a_message() -> None:
    with pytest.raises(SolverError, match="Foreign ended its process with status -6"):
        in_another_process("os:abort", (), "Foreign", "")
    with pytest.raises(SolverError, match="Foreign: ValueError: math domain error"):
        in_another_process("math:sqrt", (-1.0,), "Foreign", "")


def test_what_is_not_installed_says_how_to_install_it() -> None:
    with pytest.raises(InputError, match=r"Foreign is not installed.*: pip install foreign"):
        in_another_process("no_such_module:f", (), "Foreign", "pip install foreign")


def test_the_mesh_has_a_node_at_every_stop() -> None:
    assert {stop.x for stop in JOINT.stops} <= set(mesh(JOINT, 7).tolist())


def test_contacts_of_a_written_record_are_found_with_their_impulses() -> None:
    stop, omega = JOINT.stops[2], 100.0  # at the tip, top
    t, nodes = np.linspace(0.0, 0.1, 401), np.array([0.0, stop.x])
    values, rates = np.zeros((401, 2, 2)), np.zeros((401, 2, 2))
    values[:, 1, 0], rates[:, 1, 0] = 2 * stop.gap * np.sin(omega * t), 2 * stop.gap * omega * np.cos(omega * t)
    contacts = contacts_of(JOINT, 2, Record(nodes, t, values, rates))
    begin = math.pi / 6 / omega
    area = 2 * stop.gap / omega * (math.sqrt(3) - math.pi / 3)
    assert [c.start for c in contacts] == pytest.approx([begin, begin + 2 * math.pi / omega], rel=1e-8)
    assert contacts[0].impulse == pytest.approx(stop.stiffness * area, rel=1e-7)
    assert contacts[0].peak_force == pytest.approx(stop.stiffness * stop.gap, rel=1e-9)
    history = history_of(JOINT, "written", Record(nodes, t, values, rates))
    assert len(history.states) == history.switch_times.size + 1
    assert history.velocity(stop.x, 0.02)[0, 0] == pytest.approx(2 * stop.gap * omega * math.cos(2.0), rel=1e-6)


def test_a_peer_takes_options() -> None:
    name = arguments.named_solver("fe:elements=7,method=Radau").name
    assert name == "FE (7 elements, Radau)"
    with pytest.raises(InputError, match="has no option 'dt'"):
        arguments.named_solver("fe:dt=1")


def test_any_registered_solver_can_be_a_peer(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(peers, "DURATION", 0.008)
    result = peers.run(None, ("fe",), "quick", silent)
    assert result.verdict is Verdict.AGREE
    assert {check.b.kind for check in result.checks if check.name.endswith("against fe")} == {Kind.OTHER_CODE}
    assert any("contact 1" in check.name and check.unit == "N s" for check in result.checks)


def test_a_motion_that_a_peer_refuses_is_noted(monkeypatch: pytest.MonkeyPatch) -> None:
    def refuses(*_: object) -> None:
        raise InputError("damping: not known")

    monkeypatch.setattr(peers, "first_contacts", refuses)
    result = peers.run(sdnl104(), ("fe",), "quick", silent)
    assert result.notes == ("No motion was compared: damping: not known",)
    assert result.verdict is Verdict.AGREE


def test_a_peer_that_does_not_answer_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    def broken(name: str) -> AnySolver:
        raise SolverError("cannot be loaded")

    monkeypatch.setattr(peers, "named_solver", broken)
    with pytest.raises(InputError, match="--peers x: cannot be loaded"):
        peers.check_peers(("x",))


def test_a_motion_repeats_when_it_comes_back_and_lower_orders_do_not_nearly() -> None:
    assert repetition([0.1, 1e-7, 0.1, 1e-8], 1e-6) == (2, 1e-7)
    assert repetition([2e-6, 1e-7], 1e-6)[0] == 0  # still settling to order 1
    assert repetition([], 1e-6) == (0, math.inf)


@needs_opensees
@pytest.mark.parametrize("state", [FREE, contact_states(JOINT)[-1]])
def test_opensees_has_the_same_modes(state: object) -> None:
    found, exact = (solver.modes(JOINT, state, 3) for solver in (COARSE, analytic.Solver()))  # type: ignore[arg-type]
    assert found.angular_frequencies == pytest.approx(exact.angular_frequencies, rel=3e-4)
    x = np.linspace(0.0, JOINT.beam.length, 7)
    assert np.abs(found.shapes(x)) == pytest.approx(np.abs(exact.shapes(x)), abs=2e-3 * np.abs(exact.shapes(x)).max())


@needs_opensees
def test_opensees_knows_springs_and_free_beams() -> None:
    beam = Beam(length=1.0, bending_stiffness=1.0, mass_per_length=1.0)
    sprung = Problem(beam=beam, supports=(Support(x=0.0, translational=20.0, torsional=3.0),))
    for problem in (sprung, Problem(beam=beam)):
        found, exact = (s.modes(problem, FREE, 4).angular_frequencies for s in (COARSE, analytic.Solver()))
        assert found == pytest.approx(exact, rel=1e-4, abs=1e-3)
    with pytest.raises(InputError, match="count = 99"):
        COARSE.modes(sprung, FREE, 99)


@needs_opensees
def test_opensees_finds_the_same_contacts_and_keeps_the_invariants() -> None:
    found, exact = (solver.simulate(JOINT, 0.009) for solver in (COARSE, analytic.Solver()))
    assert [c.stop for c in found.contacts] == [c.stop for c in exact.contacts]
    assert [c.start for c in found.contacts] == pytest.approx([c.start for c in exact.contacts], abs=1e-5)
    assert found.impulses() == pytest.approx(exact.impulses(), rel=1e-2)
    assert [item.line for item in witness(found, 5e-3, "") if item.verdict is not Verdict.AGREE] == []


@needs_opensees
def test_opensees_marches_to_the_steady_state() -> None:
    heavy = JOINT.replace(damping=ViscousDamping(coefficient=40_000.0))
    found = Solver(elements=8, dt=1e-4).steady_state(heavy)
    exact = analytic.Solver().steady_state(heavy)
    assert (found.outcome, found.period_multiple) == (Outcome.PERIODIC, exact.period_multiple)
    assert found.symmetric == exact.symmetric
    assert found.impulses == pytest.approx(exact.impulses, rel=2e-2)
    undecided = Solver(elements=4, dt=1e-3, max_periods=3).steady_state(JOINT.replace(damping=NoDamping()))
    assert undecided.outcome is Outcome.UNDECIDED


@needs_opensees
def test_opensees_as_a_peer_agrees_three_ways(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(peers, "named_solver", lambda name: COARSE)
    monkeypatch.setattr(peers, "DURATION", 0.008)
    peers.check_peers(("opensees",))
    result = peers.run(None, ("opensees",), "quick", silent)
    assert [check.line for check in result.checks if check.verdict is not Verdict.AGREE] == []
    assert any(check.name == "contact 1, P5: impulse: FE against opensees" for check in result.checks)
