"""The schema: what a problem comes to, and what is refused."""

from __future__ import annotations

import math
import pickle
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from pydantic import ValidationError

from lapjoint import (
    BaseMotion,
    Beam,
    Circle,
    InputError,
    Material,
    ModalDamping,
    PolynomialShape,
    Problem,
    RecordBaseMotion,
    Rectangle,
    SampledShape,
    SineLoad,
    StepLoad,
    Stop,
    Support,
    Tube,
    ViscousDamping,
    initial_from_functions,
    paper_joint,
    sdnl104,
)
from lapjoint.problem import AtRest, BeamSegment, Mass

BEAM = Beam(length=2.0, bending_stiffness=3.0, mass_per_length=5.0)
CLAMP = Support(x=0.0, translational=math.inf, torsional=math.inf)


def test_sections_have_their_textbook_areas_and_second_moments() -> None:
    # rtol 1e-15: both sides are a handful of multiplications in double precision.
    assert Rectangle(breadth=2.0, height=3.0).second_moment == pytest.approx(4.5, rel=1e-15)
    assert Circle(diameter=2.0).second_moment == pytest.approx(math.pi / 4, rel=1e-15)
    tube = Tube(outer_diameter=2.0, inner_diameter=1.0)
    assert tube.second_moment == pytest.approx(math.pi / 4 * (1 - 1 / 16), rel=1e-15)
    assert tube.area == pytest.approx(math.pi * (1 - 1 / 4), rel=1e-15)
    assert (tube.depth, Rectangle(breadth=2.0, height=3.0).depth) == (2.0, 3.0)


def test_a_beam_takes_numbers_or_material_and_section() -> None:
    assert (BEAM.EI, BEAM.m) == (3.0, 5.0)
    made = Beam(
        length=1.0, material=Material(youngs_modulus=2.0, density=3.0), section=Rectangle(breadth=1.0, height=2.0)
    )
    assert made.EI == pytest.approx(4.0 / 3.0, rel=1e-15)
    assert made.m == 6.0


def test_the_papers_joint_has_the_papers_numbers() -> None:
    joint = paper_joint(k_star=5000.0)
    assert joint.beam.EI == pytest.approx(640625.0, rel=1e-12)  # 2.05e11 * 0.3 * 0.05^3 / 12
    assert joint.beam.m == pytest.approx(118.35, rel=1e-12)  # 7890 * 0.3 * 0.05
    assert joint.stop_names == ("P2", "P3", "P4", "P5")
    for stop in joint.stops:
        assert stop.stiffness * joint.beam.length**3 / (3 * joint.beam.EI) == pytest.approx(5000.0, rel=1e-12)


def test_sdnl104_is_a_solid_circle_of_radius_one_tenth() -> None:
    assert sdnl104().beam.m == pytest.approx(1e6 * math.pi * 0.01, rel=1e-12)
    assert sdnl104().beam.EI == pytest.approx(1e10 * math.pi * 1e-4 / 4, rel=1e-12)


def test_problems_are_frozen_hashable_and_can_be_sent_to_other_processes() -> None:
    joint = paper_joint()
    with pytest.raises(ValidationError, match="frozen"):
        joint.title = "other"
    assert hash(joint) == hash(paper_joint())
    assert pickle.loads(pickle.dumps(joint)) == joint


def test_the_last_damping_ratio_holds_for_all_modes_above() -> None:
    np.testing.assert_array_equal(ModalDamping(ratio=0.1).ratios(3), [0.1, 0.1, 0.1])
    np.testing.assert_array_equal(ModalDamping(ratio=(0.1, 0.2)).ratios(4), [0.1, 0.2, 0.2, 0.2])
    np.testing.assert_array_equal(ModalDamping(ratio=(0.1, 0.2)).ratios(1), [0.1])


def test_an_excitation_frequency_is_common_to_all_or_none() -> None:
    def load(omega: float, force: float = 1.0) -> SineLoad:
        return SineLoad(x=1.0, force=force, angular_frequency=omega)

    assert Problem(beam=BEAM).excitation_frequency is None
    assert Problem(beam=BEAM, point_loads=(load(2.0), load(2.0))).excitation_frequency == 2.0
    assert Problem(beam=BEAM, point_loads=(load(2.0), load(3.0))).excitation_frequency is None
    assert Problem(beam=BEAM, point_loads=(load(2.0), load(3.0, 0.0))).excitation_frequency == 2.0
    assert Problem(beam=BEAM, point_loads=(load(6.0), load(2.0), load(4.0))).excitation_frequency == 2.0
    assert Problem(beam=BEAM, point_loads=(load(0.1), load(0.3))).excitation_frequency == 0.1  # 0.3 / 0.1 is below 3
    assert Problem(beam=BEAM, point_loads=(load(2.0), load(4.0), load(5.0))).excitation_frequency is None
    assert Problem(beam=BEAM, point_loads=(load(1e-3), load(11.0))).excitation_frequency is None
    assert paper_joint(angular_frequency=7.0).excitation_frequency == 7.0


@pytest.mark.parametrize(
    ("changes", "there"),
    [
        ({"base_motion": None}, "there is neither a base_motion with an amplitude nor a periodic load with a force"),
        (
            {"base_motion": BaseMotion(amplitude=0.0, angular_frequency=2.0)},
            "there is neither .* `lapjoint equilibrium`",
        ),
        (
            {"point_loads": (StepLoad(x=1.0, force=1.0), SineLoad(x=1.0, force=1.0, angular_frequency=3.0))},
            r"base_motion.angular_frequency = 515, point_loads\[1\].angular_frequency = 3 \(kind = .* lower one\)",
        ),
    ],
)
def test_a_problem_without_one_frequency_says_what_there_is(changes: dict[str, Any], there: str) -> None:
    message = (
        f"^steady state: the excitation must have one angular_frequency, or whole multiples of the lowest; {there}"
    )
    with pytest.raises(InputError, match=message):
        paper_joint().replace(**changes).require_excitation_period("steady state")


def test_the_excitation_period_is_that_of_its_frequency() -> None:
    assert paper_joint(angular_frequency=7.0).require_excitation_period("march") == 2 * math.pi / 7.0


@pytest.mark.parametrize("derivative", [0, 1, 2, 3])
def test_a_polynomial_start_is_differentiated_exactly(derivative: int) -> None:
    shape = PolynomialShape(displacement=(0.0, 0.0, 3.0, -1.0))
    x = np.array([0.0, 0.5, 2.0])
    exact = (3 * x**2 - x**3, 6 * x - 3 * x**2, 6 - 6 * x, np.full(3, -6.0))[derivative]
    np.testing.assert_allclose(shape.displacement_at(x, derivative), exact, rtol=1e-15)
    np.testing.assert_array_equal(shape.velocity_at(x), 0.0)
    np.testing.assert_array_equal(AtRest().displacement_at(x, derivative), 0.0)


def test_a_start_from_functions_is_their_spline_to_fourth_order() -> None:
    def error(points: int) -> float:
        shape = initial_from_functions(2.0, displacement=np.sin, points=points)
        x = np.linspace(0.0, 2.0, 1001)
        return float(np.max(np.abs(shape.displacement_at(x) - np.sin(x))))

    order = math.log2(error(41) / error(81))
    assert 3.7 < order < 4.3  # fourth order, with the boundary's slower terms


def test_problems_with_a_sampled_start_are_equal_after_use() -> None:
    def problem() -> Problem:
        return Problem(beam=BEAM, supports=(CLAMP,), initial=initial_from_functions(2.0, lambda x: x**2))

    one, other = problem(), problem()
    one.initial.displacement_at(np.array([0.3]))
    assert one == other
    assert hash(one) == hash(other)


@pytest.mark.parametrize("function", [lambda x: 1.0, lambda x: x[:-1], lambda x: x / np.inf * np.inf])
def test_a_function_that_does_not_give_a_shape_is_refused(function: Any) -> None:
    with np.errstate(invalid="ignore"), pytest.raises(InputError, match=r"initial\.velocity.*401 finite numbers"):
        initial_from_functions(1.0, velocity=function)


WAVE = [math.sin(0.3 * i) for i in range(60)]


def record(**changes: Any) -> RecordBaseMotion:
    return RecordBaseMotion(**{"quantity": "acceleration", "values": WAVE, "rate": 500.0} | changes)


def pins(*places: float) -> tuple[Support, ...]:
    return tuple(Support(x=x, translational=math.inf) for x in places)


def segment(to: float, EI: float, m: float) -> BeamSegment:
    return BeamSegment(to=to, bending_stiffness=EI, mass_per_length=m)


REFUSED: list[tuple[str, dict[str, Any], str]] = [
    ("stop outside", {"stops": (Stop(x=2.1, side="top", gap=0.0, stiffness=1.0),)}, r"stops\[0\]\.x = 2\.1.*0 to 2 m"),
    ("support outside", {"supports": (Support(x=3.0),)}, r"supports\[0\]\.x = 3.*0 to 2 m"),
    ("load outside", {"point_loads": (SineLoad(x=3.0, force=1.0, angular_frequency=1.0),)}, r"point_loads\[0\]\.x = 3"),
    (
        "same name",
        {"stops": (Stop(name="a", x=1.0, side="top", gap=0.0, stiffness=1.0),) * 2},
        r'stops\[1\]\.name = "a": is the name of stops\[0\] too',
    ),
    (
        "a support too soft for double precision",
        {"supports": (Support(x=0.0, translational=math.inf, torsional=1e-100),)},
        r"supports\[0\]\.torsional = 1e-100: is .* EI / length; allowed are 0, 1e-16 to 1e\+20 EI / length, .* and inf",
    ),
    (
        "a support too stiff to be finite",
        {"supports": (Support(x=0.0, translational=1e100),)},
        r"supports\[0\]\.translational = 1e\+100: is .* EI / length\^3; allowed are 0, .* and inf",
    ),
    (
        "a stop too stiff for double precision",
        {"stops": (Stop(x=1.0, side="top", gap=1e-3, stiffness=1e30),)},
        r"stops\[0\]\.stiffness = 1e\+30: is .* EI / length\^3; allowed are up to 1e\+13 EI / length\^3, which is",
    ),
    (
        "a mass too heavy for double precision",
        {"masses": (Mass(x=1.0, mass=1e30),)},
        r"masses\[0\]\.mass = 1e\+30: is .* times the beam's mass; allowed are up to 1e\+12 times, which is",
    ),
    (
        "a rotary inertia too large for double precision",
        {"masses": (Mass(x=1.0, mass=1.0, rotary_inertia=1e30),)},
        r"masses\[0\]\.rotary_inertia = 1e\+30: is .* mass times length\^2; allowed are up to 1e\+12 times",
    ),
    (
        "a step too large for double precision",
        {"beam": Beam(length=2.0, segments=(segment(1.0, 1.0, 1.0), segment(2.0, 1e10, 1.0)))},
        r"beam\.segments\[1\]: its bending stiffness is 1e\+10 times that of segments\[0\]; allowed are up to 1e\+09",
    ),
    (
        "a step of mass too large for double precision",
        {"beam": Beam(length=2.0, segments=(segment(1.0, 1.0, 1e10), segment(2.0, 1.0, 1.0)))},
        r"beam\.segments\[0\]: its mass per length is 1e\+10 times that of segments\[1\]; allowed are up to 1e\+09",
    ),
    (
        "a start that moves a clamp",
        {"supports": (CLAMP,), "initial": PolynomialShape(displacement=(1e-3,))},
        r"initial\.displacement: moves supports\[0\] at x = 0 m.*must be 0",
    ),
    (
        "a start that turns a clamp",
        {"supports": (CLAMP,), "initial": PolynomialShape(velocity=(0.0, 1.0))},
        r"initial\.velocity: turns supports\[0\].*slope is 1",
    ),
    (
        "samples that stop short",
        {"initial": SampledShape(x=(0.0, 0.5, 1.0, 1.5), displacement=(0.0, 0.0, 0.0, 0.0))},
        r"initial\.x: runs from 0 to 1\.5, and must run from 0 to 2 m",
    ),
    ("ratio", {"damping": ModalDamping(ratio=1e150)}, r"damping.ratio = 1e\+150: must be at most 1e\+07"),
    ("ratios", {"damping": ModalDamping(ratio=(0.1, 1e160))}, r"damping.ratio\[1\] = 1e\+160: must be at most"),
    ("coefficient", {"damping": ViscousDamping(coefficient=1e200)}, r"damping.coefficient = 1e\+200: must be at most"),
    ("fast record", {"base_motion": record(rate=1e120)}, r"base_motion.rate = 1e\+120: the samples come to 1e-120 s"),
    ("slow record", {"base_motion": record(rate=1e-308)}, r"base_motion.rate = 1e-308: .* and inf s in all; allowed"),
    ("times", {"base_motion": record(rate=None, times=[1e-120 * i for i in range(60)])}, "base_motion.times: the sam"),
    (
        "swift record",
        {"base_motion": record(quantity="displacement", rate=1e60)},
        "base_motion: the largest acceleration of the base comes to",
    ),
    ("frequency", {"base_motion": BaseMotion(amplitude=1.0, angular_frequency=1e-60)}, "must be between 1e-100 and"),
    ("amplitude", {"base_motion": BaseMotion(amplitude=1e101, angular_frequency=1.0)}, r"amplitude = 1e\+101: must be"),
    (
        "acceleration",
        {"base_motion": BaseMotion(amplitude=1e99, angular_frequency=1e3)},
        "the acceleration comes to 1e",
    ),
    ("phase", {"base_motion": BaseMotion(amplitude=1.0, angular_frequency=1.0, phase=1e150)}, r"phase = 1e\+150: allo"),
    ("force", {"point_loads": (StepLoad(x=1.0, force=-1e150),)}, r"point_loads\[0\].force = -1e\+150: must be at most"),
    ("gap", {"stops": (Stop(x=1.0, side="top", gap=1e150, stiffness=1e4),)}, r"stops\[0\].gap = 1e\+150: must be at"),
    ("start", {"initial": PolynomialShape(displacement=(0.0, 1e300))}, "initial.displacement: the largest value comes"),
    ("at the root", {"supports": pins(0.0, 5e-324)}, r"supports\[1\].x = 4.94066e-324: must be 0, or more than 1e-12"),
    ("one pin or two", {"supports": pins(0.5, 0.5 + 1e-14)}, r"supports\[1\].x = .*: lies 1e-14 m from supports\[0\]"),
]


@pytest.mark.parametrize(("parts", "message"), [row[1:] for row in REFUSED], ids=[row[0] for row in REFUSED])
def test_parts_that_do_not_fit_together_or_hold_numbers_out_of_range_are_refused(
    parts: dict[str, Any], message: str
) -> None:
    with pytest.raises(InputError, match=message):
        Problem(**{"beam": BEAM} | parts)


def test_numbers_that_vanish_beside_all_else_are_allowed() -> None:
    least = 5e-324
    Problem(
        beam=BEAM,
        supports=(),
        stops=(Stop(x=0.5, side="top", gap=least, stiffness=1.0),),
        damping=ModalDamping(ratio=least),
        base_motion=BaseMotion(amplitude=least, angular_frequency=1.0, phase=least),
        initial=PolynomialShape(displacement=(0.0,), velocity=(least,)),
    )


def test_a_start_may_move_what_is_not_fixed() -> None:
    spring = Support(x=0.0, translational=1e15, torsional=1e15)
    pinned = Support(x=0.0, translational=math.inf)
    Problem(beam=BEAM, supports=(spring,), initial=PolynomialShape(displacement=(1.0, 1.0)))
    Problem(beam=BEAM, supports=(pinned,), initial=PolynomialShape(displacement=(0.0, 1.0)))


def test_replace_validates_again() -> None:
    assert paper_joint().replace(title="other").title == "other"
    with pytest.raises(InputError, match="lies outside the beam"):
        paper_joint().replace(supports=(Support(x=9.0),))


def test_other_excitation_is_validated_and_the_rest_stays_as_it_is() -> None:
    own = paper_joint(angular_frequency=515.0)
    load = SineLoad(x=0.2, force=1.0, angular_frequency=900.0)
    assert own.forces.fundamental == 515.0
    other = own.with_excitation(base_motion={"amplitude": 0.01, "angular_frequency": 300.0}, point_loads=(load,))
    assert other == own.replace(base_motion=BaseMotion(amplitude=0.01, angular_frequency=300.0), point_loads=(load,))
    assert (other.forces.fundamental, own.forces.fundamental) == (300.0, 515.0)
    assert other.with_excitation(base_motion=own.base_motion).point_loads == (load,)
    for wrong, message in (
        ({"base_motion": {"amplitude": -1.0, "angular_frequency": 300.0}}, "amplitude = -1.0: must be at least 0"),
        (
            {"base_motion": {"amplitude": 1.0, "angular_frequency": 1e200}},
            "Problem: base_motion: the square of the angular frequency comes to inf",
        ),
        ({"point_loads": (StepLoad(x=9.0, force=1.0),)}, "Problem: .* lies outside the beam"),
    ):
        with pytest.raises(InputError, match=message):
            own.with_excitation(**wrong)


def test_other_numbers_of_the_base_are_validated() -> None:
    own = paper_joint(angular_frequency=515.0)
    assert own.forces.fundamental == 515.0
    other = own.with_base_numbers(angular_frequency=300.0, phase=0.5)
    base = BaseMotion(**vars(own.base_motion) | {"angular_frequency": 300.0, "phase": 0.5})
    assert other == own.replace(base_motion=base)
    assert (other.forces, own.forces.fundamental) == (own.replace(base_motion=base).forces, 515.0)
    assert other.structure is own.structure
    for numbers, message in (
        ({"amplitude": -1.0}, "amplitude = -1.0: must be at least 0"),
        ({"angular_frequency": 1e200}, "Problem: base_motion: the square of the angular frequency comes to inf"),
        ({"angular_frequency": float("nan")}, "angular_frequency = nan"),
        ({"speed": 1.0}, "speed"),
    ):
        with pytest.raises(InputError, match=message):
            own.with_base_numbers(**numbers)
    with pytest.raises(InputError, match="base_motion: is no sine"):
        own.replace(base_motion=None).with_base_numbers(amplitude=1.0)


def test_a_section_that_underflows_is_refused() -> None:
    with pytest.raises(InputError, match="EI comes to 0"):
        Beam(length=1.0, material=Material(youngs_modulus=1.0, density=1.0), section=Circle(diameter=1e-100))


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: Stop(x=0.5, side="topp", gap=1.0, stiffness=1.0), 'Stop: side = "topp": must be "top" or "bottom"'),
        (lambda: Stop(x=-0.5, side="top", gap=1.0, stiffness="1"), "Stop: 2 faults\n  x = -0.5"),
        (lambda: paper_joint().replace(stop=()), "Problem: stop: unknown key; did you mean stops?"),
        (lambda: Problem(beam={"length": 1.0}), "Problem: beam: give either bending_stiffness"),
    ],
)
def test_who_makes_a_part_in_python_reads_sentences(make: Callable[[], Any], message: str) -> None:
    with pytest.raises(InputError) as caught:
        make()
    assert message in str(caught.value)
    assert "pydantic" not in str(caught.value)
    assert caught.value.__suppress_context__


def test_viscous_damping_that_couples_modes_has_a_limit_of_its_own() -> None:
    given = {
        "beam": {"length": 1.0, "bending_stiffness": 1.0, "mass_per_length": 1.0},
        "supports": [{"x": 0.0, "translational": math.inf, "torsional": math.inf}],
        "damping": {"kind": "viscous", "coefficient": 1e6},
    }
    assert Problem.model_validate(given).structure.coupling_drag == 0
    laden = given | {"masses": [{"x": 1.0, "mass": 0.1}]}
    with pytest.raises(ValueError, match=r"damping\.coefficient = 1e\+06: must be at most 10000 .*couple the modes"):
        Problem.model_validate(laden)
    light = laden | {"damping": {"kind": "viscous", "coefficient": 2.0}}
    assert Problem.model_validate(light).structure.coupling_drag == 2.0


def test_a_beam_copied_with_another_mass_has_the_pieces_of_the_copy() -> None:
    beam = Beam(length=1.0, bending_stiffness=2.0, mass_per_length=3.0)
    assert beam.pieces[0].mass == 3.0
    heavy = beam.model_copy(update={"contents_per_length": 1.0, "length": 2.0})
    assert (heavy.pieces[0].mass, heavy.pieces[0].end) == (4.0, 2.0)
