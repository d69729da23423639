"""Problems go to files and back without loss; every fault of a file has one line that names it."""

from __future__ import annotations

import json
import math
import re
from pathlib import Path
from typing import Any

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from lapjoint import (
    BaseMotion,
    Beam,
    Circle,
    HarmonicsBaseMotion,
    HarmonicsLoad,
    InputError,
    Material,
    ModalDamping,
    NoDamping,
    PolynomialShape,
    Problem,
    Rectangle,
    SampledShape,
    SineLoad,
    StepLoad,
    Stop,
    Support,
    Tube,
    ViscousDamping,
    paper_joint,
    sdnl104,
)
from lapjoint.errors import OutputError
from lapjoint.problem import (
    AtEquilibrium,
    AtRest,
    BaseHarmonic,
    Gravity,
    Link,
    LoadHarmonic,
    Mass,
    NamedBeam,
    UniformLoad,
)
from lapjoint.problem.example import commented_example
from lapjoint.problem.files import from_toml, json_schema, problem_tables, read_problem, to_toml, write_problem
from lapjoint.problem.presets import lap_joint

positive = st.floats(min_value=1e-3, max_value=1e12, allow_nan=False)
finite = st.floats(allow_nan=False, allow_infinity=False, min_value=-1e50, max_value=1e50)
phase = st.floats(-1e6, 1e6)
support_share, stop_share = st.floats(1e-15, 1e19), st.floats(1e-20, 1e12)
"""Of EI / L^3 or EI / L."""
sections = st.one_of(
    st.builds(Rectangle, breadth=positive, height=st.floats(1e-3, 1e3)),
    st.builds(Circle, diameter=st.floats(1e-3, 1e3)),
    st.builds(
        lambda d, ratio: Tube(outer_diameter=d, inner_diameter=d * ratio), st.floats(1e-3, 1e3), st.floats(0.1, 0.9)
    ),
)


def several(harmonic: Any, **sizes: Any) -> Any:
    """One to three harmonics of different multiples."""
    multiples = st.lists(st.integers(1, 10_000), min_size=1, max_size=3, unique=True)
    return multiples.flatmap(
        lambda found: st.tuples(*(st.builds(harmonic, multiple=st.just(n), phase=phase, **sizes) for n in found))
    )


@st.composite
def problems(draw: st.DrawFn) -> Problem:
    """Any problem, with every kind of part."""
    L = draw(positive)
    within = st.integers(0, 1000).map(lambda n: n / 1000 * L)
    ratio = st.floats(0.0, 2.0)
    beam = draw(
        st.one_of(
            st.builds(Beam, length=st.just(L), bending_stiffness=positive, mass_per_length=positive),
            st.builds(
                Beam,
                length=st.just(L),
                material=st.builds(Material, youngs_modulus=positive, density=positive),
                section=sections,
            ),
        )
    )
    initial = draw(
        st.one_of(
            st.just(AtRest()),
            st.just(AtEquilibrium()),
            st.builds(lambda a, b: PolynomialShape(displacement=(0, 0, 0, a), velocity=(b,)), finite, finite),
            st.builds(
                lambda values: SampledShape(x=(0.0, L / 4, L / 2, L), velocity=values),
                st.tuples(*[st.floats(-1e6, 1e6)] * 4),
            ),
        )
    )
    springs = [support_share.map(lambda share, power=power: share * beam.EI / L**power) for power in (3, 1)]
    any_spring = st.one_of(st.just(0.0), springs[0], st.just(math.inf))
    supports = st.builds(
        Support, x=within, translational=any_spring if initial == AtRest() else springs[0], torsional=springs[1]
    )
    viscous = st.floats(1e-3, 1e3).map(lambda share: share * 2 * beam.m * beam.slowest_bending)
    stop_springs = stop_share.map(lambda share: share * beam.EI / L**3)
    stops = st.builds(Stop, x=within, side=st.sampled_from(["top", "bottom"]), gap=positive, stiffness=stop_springs)
    loads = st.one_of(
        st.builds(StepLoad, x=within, force=finite),
        st.builds(SineLoad, x=within, force=finite, angular_frequency=positive, phase=phase),
        st.builds(HarmonicsLoad, x=within, angular_frequency=positive, harmonics=several(LoadHarmonic, force=finite)),
    )
    return Problem(
        title=draw(st.text(max_size=20)),
        beam=beam,
        supports=tuple(draw(st.lists(supports, max_size=2))),
        stops=tuple(draw(st.lists(stops, max_size=3))),
        damping=draw(
            st.one_of(
                st.just(NoDamping()),
                st.builds(ModalDamping, ratio=st.one_of(ratio, st.tuples(ratio, ratio))),
                st.builds(ViscousDamping, coefficient=viscous),
            )
        ),
        base_motion=draw(
            st.none()
            | st.builds(BaseMotion, amplitude=positive, angular_frequency=positive, phase=phase)
            | st.builds(
                HarmonicsBaseMotion, angular_frequency=positive, harmonics=several(BaseHarmonic, amplitude=positive)
            )
        ),
        point_loads=tuple(draw(st.lists(loads, max_size=2))),
        initial=initial,
    )


@settings(max_examples=60, deadline=None, derandomize=True, suppress_health_check=[HealthCheck.too_slow])
@given(problems())
def test_any_problem_survives_its_file(problem: Problem) -> None:
    text = to_toml(problem)
    assert from_toml(text) == problem
    assert to_toml(from_toml(text)) == text


@pytest.mark.parametrize("problem", [paper_joint(), sdnl104()], ids=["paper", "sdnl104"])
def test_presets_survive_their_files(problem: Problem, tmp_path: Path) -> None:
    write_problem(problem, tmp_path / "problem.toml")
    assert read_problem(tmp_path / "problem.toml") == problem


def test_a_file_leaves_out_defaults_and_what_is_not_given() -> None:
    assert problem_tables(Problem(beam=Beam(length=1.0, bending_stiffness=1.0, mass_per_length=1.0))) == {
        "schema_version": 1,
        "beam": {"length": 1.0, "bending_stiffness": 1.0, "mass_per_length": 1.0},
    }


def test_the_example_is_the_papers_joint() -> None:
    example, joint = from_toml(commented_example()), paper_joint()
    for mine, theirs in zip(example.stops, joint.stops, strict=True):
        # The example writes the stiffness 1200 * 3 EI / L^3 as a decimal number; the preset computes it.
        assert mine.stiffness == pytest.approx(theirs.stiffness, rel=1e-14)
    assert example.replace(stops=joint.stops) == joint


def test_the_example_of_several_beams_is_the_preset_and_explains_each_of_their_keys() -> None:
    text = commented_example("lap")
    assert from_toml(text) == lap_joint()
    link = text[text.index("# [[links]]") : text.index("\n[damping]")].replace("\n# ", "\n").removeprefix("# ")
    (rivet,) = from_toml(text + link).links
    assert rivet == Link(
        name="rivet",
        between=("upper:0.29", "lower:0.05"),
        translational=1e7,
        torsional=1e3,
        damping=20.0,
        torsional_damping=0.1,
    )
    of_one_beam = commented_example()
    for part in (NamedBeam, Link, Stop):
        for key in part.model_fields:
            assert key in text or key in of_one_beam, f"no example of {key} of {part.__name__}"


def test_parts_that_the_example_leaves_out_need_only_their_marks_removed() -> None:
    text = re.sub(r"^\[beam\.section\].*?\n\n", "", commented_example(), flags=re.DOTALL | re.MULTILINE)
    taken = {"contents_per_length", "added_mass_per_length", "[[beam.segments]]", "[[masses]]", "fixed_to"}
    taken |= {"[gravity]", "[[uniform_loads]]"}
    lines, within = [], False
    for line in text.splitlines():
        begins = line.removeprefix("# ").split(maxsplit=1)[:1]
        within = line.startswith("# ") and (within or bool(taken.intersection(begins)))
        lines.append(line.removeprefix("# ") if within else line)
    joint = from_toml("\n".join(lines))
    assert [piece.end for piece in joint.beam.pieces] == [0.8, 2.5]
    assert joint.beam.contents_per_length == 8.0
    assert joint.beam.added_mass_per_length == 5.0
    assert joint.masses == (Mass(name="clevis", x=2.5, mass=12.0, rotary_inertia=0.05),)
    assert joint.stops[0].in_space
    assert joint.gravity == Gravity(acceleration=-9.81)
    assert joint.uniform_loads == (UniformLoad(start=0.5, to=1.0, force_per_length=-200.0),)


def test_the_schema_describes_every_key() -> None:
    schema = json_schema()
    assert json.loads(json.dumps(schema, allow_nan=False)) == schema
    for name, part in {"Problem": schema, **schema["$defs"]}.items():
        for key, field in part["properties"].items():
            assert key in ("kind", "shape") or "description" in field, f"{name}.{key} has no description"


GOOD = """
[beam]
length = 1.0
bending_stiffness = 1.0
mass_per_length = 1.0
"""
STOP = '[[stops]]\nx = 1.0\nside = "top"\ngap = 1e-3\nstiffness = 1e5\n'
CLAMP = "[[supports]]\nx = 0.0\ntranslational = inf\ntorsional = inf\n"


ONE = "{multiple = 1, amplitude = 1.0}"


def length(value: str) -> str:
    return GOOD.replace("length = 1.0", f"length = {value}", 1)


def stop(old: str, new: str) -> str:
    return GOOD + STOP.replace(old, new)


def damping(keys: str) -> str:
    return f"{GOOD}[damping]\n{keys}"


def harmonics(*tables: str) -> str:
    """A base that moves by harmonics."""
    return f'{GOOD}[base_motion]\nkind = "harmonics"\nangular_frequency = 2.0\nharmonics = [{", ".join(tables)}]\n'


FAULTS: list[tuple[str, str, str]] = [
    ("negative length", length("-1.0"), "beam.length = -1.0: must be greater than 0"),
    ("NaN", length("nan"), "beam.length = nan: must be greater than 0"),
    ("infinite", length("inf"), "beam.length = inf: must be a finite number"),
    ("boolean", length("true"), "beam.length = true: must be a number"),
    ("date", length("2020-01-01"), "beam.length = "),
    ("missing", "title = 'x'", "beam: is missing"),
    ("missing key", STOP.replace("gap = 1e-3\n", "") + GOOD, "stops[0].gap: is missing (Gap when"),
    ("text for gap", stop("1e-3", '"wide"'), 'stops[0].gap = "wide": must be a number'),
    ("NaN gap", stop("1e-3", "nan"), "stops[0].gap = nan: must be a finite number"),
    ("stop outside", stop("x = 1.0", "x = 1.1"), "stops[0].x = 1.1: lies outside the beam; allowed are 0 to 1 m"),
    ("side", stop('"top"', '"left"'), 'stops[0].side = "left": must be "top" or "bottom"'),
    (
        "unknown key",
        stop("gap", "gaap"),
        "stops[0].gaap: unknown key; did you mean gap? allowed: x, side, between, gap",
    ),
    ("unknown table", GOOD + "[suports]\nx = 1", "suports: unknown key; did you mean supports?"),
    ("not a list", GOOD + "[stops]\nx = 1.0", "stops = {x = ...}: must be a list; above each entry stands [[stops]]"),
    ("not a table", "beam = 3", "beam = 3: must be a table"),
    ("kind", damping('kind = "rayleigh"'), 'damping.kind = "rayleigh": allowed: modal, none, viscous'),
    ("no kind", damping("ratio = 0.1"), "damping.kind: is missing; allowed: modal, none, viscous"),
    ("ratio", damping('kind = "modal"\nratio = [0.1, "x"]'), 'damping.ratio[1] = "x": must be a number'),
    ("no ratios", damping('kind = "modal"\nratio = []'), "damping.ratio = []: must have at least 1 value"),
    (
        "two descriptions",
        GOOD + "[beam.material]\nyoungs_modulus = 1.0\ndensity = 1.0",
        "beam: give either bending_stiffness",
    ),
    ("long number", GOOD.replace("1.0", "1" + 400 * "0", 1), "beam.length = 1000000"),
    (
        "moved clamp",
        GOOD + CLAMP + '[initial]\nkind = "polynomial"\ndisplacement = [1.0]',
        "initial.displacement: moves supports[0]",
    ),
    (
        "kind of base",
        GOOD + '[base_motion]\nkind = "square"',
        'base_motion.kind = "square": allowed: harmonics, random, record, sine',
    ),
    (
        "no frequency",
        GOOD + "[base_motion]\namplitude = 1.0",
        "base_motion.angular_frequency: is missing (omega, rad/s; or else frequency, Hz)",
    ),
    (
        "no frequency of harmonics",
        harmonics(ONE).replace("angular_frequency = 2.0\n", ""),
        "base_motion.angular_frequency: is missing (omega of the fundamental",
    ),
    ("a half", harmonics("{multiple = 1.5, amplitude = 1.0}"), "[0].multiple = 1.5: must be a whole number"),
    ("none", harmonics("{multiple = 0, amplitude = 1.0}"), "harmonics[0].multiple = 0: must be at least 1"),
    ("text for one", harmonics('{multiple = "1", amplitude = 1.0}'), 'multiple = "1": must be a number'),
    ("too many", harmonics("{multiple = 10001, amplitude = 1.0}"), "= 10001: must be at most 10000"),
    ("no harmonics", harmonics(), "base_motion.harmonics: must have at least one harmonic"),
    (
        "repeated",
        harmonics(*["{multiple = 3, amplitude = 1.0}"] * 2),
        "base_motion.harmonics: multiple 3 is given 2 times; each must be there once",
    ),
    (
        "force of the base",
        harmonics("{multiple = 3, force = 1.0}"),
        "base_motion.harmonics[0].force: unknown key; allowed: multiple, amplitude, phase",
    ),
    (
        "fast harmonic",
        harmonics(ONE, "{multiple = 100, amplitude = 1e304}"),
        "base_motion.harmonics[1].amplitude = 1e+304: must be at most 1e+100 m",
    ),
    (
        "hard harmonic",
        harmonics(ONE, "{multiple = 100, amplitude = 1e97}"),
        "base_motion.harmonics[1]: the acceleration comes to 4e+101, and must be at most 1e+100 in SI units",
    ),
    (
        "fast load",
        GOOD + "[[point_loads]]\nx = 1.0\nforce = 1.0\nangular_frequency = 1e200",
        "point_loads[0]: the square of the angular frequency comes to inf, and must be between 1e-100 and 1e+100 in SI",
    ),
    ("broken", GOOD + "length =", "is not valid TOML"),
    ("twice", GOOD + "length = 2.0\nlength = 3.0", "is not valid TOML"),
    (
        "two frequencies",
        harmonics(ONE) + "frequency = 1.0\n",
        "base_motion: frequency, angular_frequency: give one of them, in Hz or in rad/s",
    ),
    (
        "no frequency in Hz",
        harmonics(ONE).replace("angular_frequency = 2.0", "frequency = 0.0"),
        "base_motion: frequency = 0.0: must be greater than 0 and finite, in Hz",
    ),
    (
        "text in Hz",
        GOOD + '[[point_loads]]\nx = 1.0\nforce = 1.0\nfrequency = "1,5"',
        'point_loads[0]: frequency = "1,5": must be a number; a point begins the fraction: 1.5',
    ),
    (
        "a frequency of a record",
        GOOD + "[base_motion]\nkind = 'record'\nquantity = 'velocity'\nvalues = [1, 2]\nrate = 1.0\nfrequency = 1.0",
        "base_motion.frequency: unknown key",
    ),
    ("infinity", length("infinity"), "); infinity is written inf"),
    ("infinity in quotes", length('"infinity"'), '= "infinity": must be a number; infinity is written inf, without'),
    ("a decimal comma", stop("1e-3", "0,4e-3  # m"), "); a point begins the fraction: 0.4e-3"),
    ("and quotes", stop("1e-3", '"-0,4"'), 'gap = "-0,4": must be a number; a point begins the fraction: -0.4'),
    ("quotes", stop("1e-3", '"1e-3"'), 'stops[0].gap = "1e-3": must be a number; leave out the quotes'),
    (
        "a list as tables",
        GOOD + 2 * STOP.replace("[[stops]]", "[stops]"),
        "entry of a list stands [[stops]]",
    ),
    ("a table of another", GOOD + "[section]\nshape = 'circle'", "section: unknown key; is it [beam.section]?"),
    ("a key of another", "gap = 1e-3\n" + GOOD, "gap: unknown key; it is a key of [[stops]]"),
    ("bad line", "title = 'x'\nbeam length\n", "line 2"),
    ("cut off", GOOD + "title = 'x", "line 6"),
    ("empty", " \n", "is empty"),
]


@pytest.mark.parametrize(("text", "message"), [row[1:] for row in FAULTS], ids=[row[0] for row in FAULTS])
def test_a_fault_has_one_line_that_names_it(text: str, message: str, tmp_path: Path) -> None:
    path = tmp_path / "problem.toml"
    path.write_text(text)
    with pytest.raises(InputError) as caught:
        read_problem(path)
    said = str(caught.value)
    assert said.startswith(f"{path}: ")
    assert message in said
    assert not any(word in said for word in ("pydantic", "http", "function-", "type=", "Input should"))
    assert "\n" not in said or "faults\n" in said


@pytest.mark.parametrize(
    ("kind", "part"),
    [
        ("BaseMotion", "[base_motion]\namplitude = 1e-3\nF"),
        (
            "HarmonicsBaseMotion",
            '[base_motion]\nkind = "harmonics"\nharmonics = [{multiple = 2, amplitude = 1e-3}]\nF',
        ),
        ("SineLoad", "[[point_loads]]\nx = 1.0\nforce = 1.0\nF"),
        (
            "HarmonicsLoad",
            '[[point_loads]]\nkind = "harmonics"\nx = 1.0\nharmonics = [{multiple = 2, force = 1.0}]\nF',
        ),
    ],
)
def test_a_frequency_in_hz_is_an_angular_frequency_and_written_as_one(kind: str, part: str) -> None:
    hertz = from_toml(GOOD + part.replace("\nF", "\nfrequency = 1.25"))
    assert hertz == from_toml(GOOD + part.replace("\nF", f"\nangular_frequency = {2 * math.pi * 1.25!r}"))
    assert " frequency" not in to_toml(hertz).replace("\n", " ").replace("angular_frequency = 7.85398163", "")
    defined = json_schema()["$defs"][kind]
    assert defined["oneOf"] == [{"required": ["angular_frequency"]}, {"required": ["frequency"]}]
    assert "Hz" in defined["properties"]["frequency"]["description"]


def test_all_faults_of_a_file_are_named_at_once() -> None:
    text = GOOD.replace("length = 1.0", "length = -1.0", 1) + STOP.replace("1e-3", '"wide"').replace("1e5", "0.0")
    with pytest.raises(InputError) as caught:
        from_toml(text)
    assert str(caught.value).splitlines() == [
        "problem: 3 faults",
        "  beam.length = -1.0: must be greater than 0",
        '  stops[0].gap = "wide": must be a number',
        "  stops[0].stiffness = 0.0: must be greater than 0",
    ]


def test_files_that_cannot_be_read_are_named(tmp_path: Path) -> None:
    (tmp_path / "binary").write_bytes(b"\x00\xff\xfe")
    for name, reason in (("missing", "No such file"), (".", "directory"), ("binary", "UTF-8"), ("a\0b", "null")):
        with pytest.raises(InputError, match=reason):
            read_problem(f"{tmp_path}/{name}")
    with pytest.raises(OutputError, match="cannot be written"):
        write_problem(paper_joint(), tmp_path / "no" / "such.toml")


def test_a_file_of_another_schema_is_refused() -> None:
    text = to_toml(paper_joint())
    assert text.startswith("schema_version = 1\n")
    assert from_toml(text.partition("\n")[2]) == paper_joint()  # a file need not state it
    with pytest.raises(InputError, match="schema_version = 2: must be 1"):
        from_toml(text.replace("schema_version = 1", "schema_version = 2"))
