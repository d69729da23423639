"""The sketch as SVG with handles: they lie on what they move, and the values are those of the problem."""

from __future__ import annotations

import math
import re
import subprocess
import sys
from functools import cache

import numpy as np
import pytest

from explore.answers import Drawn, Handle
from explore.drawing import drawn
from lapjoint import Beam, Mass, Problem, Stop, Support, paper_joint, sdnl104
from lapjoint.figures.style import COLOURS
from lapjoint.problem.files import problem_from_tables, problem_tables
from lapjoint.problem.override import assign, targets
from lapjoint.problem.presets import lap_joint

BEAM = Beam(length=1.5, bending_stiffness=1e3, mass_per_length=4.0)
CROWDED = Problem(
    beam=BEAM,
    supports=(
        Support(x=0.0, translational=900.0),
        Support(x=0.3, torsional=130.0),
        Support(x=0.6, translational=5.0, torsional=130.0),
        Support(x=1.2, translational=math.inf),
    ),
    stops=(
        Stop(name="pad", x=0.6, side="bottom", gap=-1e-4, stiffness=1e4),
        Stop(name="<img onload=a>", x=1.2, side="bottom", gap=0.0, stiffness=1e4),
        Stop(name="$x$", x=0.9, side="top", gap=1e-3, stiffness=1e4),
    ),
    masses=(Mass(x=1.4, mass=1.0), Mass(name="clevis", x=0.45, mass=2.0)),
)
JOINTS = {"paper": paper_joint(), "sdnl104": sdnl104(), "lap": lap_joint(), "crowded": CROWDED}
WIDE, NARROW = 0, 1


@cache
def sketch(name: str) -> Drawn:
    return drawn(JOINTS[name])


def lines(svg: str) -> list[tuple[float, str, tuple[float, float]]]:
    """Width, colour and middle of the straight lines of an SVG."""
    found = []
    for path in re.findall(r"<path [^>]*>", svg):
        points = [float(number) for number in re.findall(r"-?[\d.]+", re.search(r' d="([^"]*)"', path)[1])]  # type: ignore[index]
        width, colour = re.search(r"stroke-width: ([\d.]+)", path), re.search(r"stroke: ([^;]*)", path)
        if len(points) == 4 and width and colour:
            found.append((float(width[1]), colour[1], ((points[0] + points[2]) / 2, (points[1] + points[3]) / 2)))
    return found


def by_path(one: Drawn) -> dict[str, Handle]:
    return {handle.path: handle for handle in one.handles}


@pytest.mark.parametrize("picture", [WIDE, NARROW])
@pytest.mark.parametrize("name", JOINTS)
def test_handles_of_stops_lie_on_their_faces_and_on_their_grounds(name: str, picture: int) -> None:
    problem = JOINTS[name]
    found = sketch(name)
    handles, straight = by_path(found), lines(found.svg[picture])
    faces = [at for width, colour, at in straight if width == 1.8 and COLOURS[1].lower() in colour]
    assert len(faces) == len(problem.stops)
    for i, face in enumerate(faces):
        assert handles[f"stops.{i}.gap"].centres[picture] == pytest.approx(face, abs=1e-3)
    grounds = [at for width, colour, at in straight if width == 0.9 and colour == "currentColor"]
    for i, stop in enumerate(problem.stops):
        if stop.between is None:
            centre = handles[f"stops.{i}.x"].centres[picture]
            assert min(math.dist(centre, ground) for ground in grounds) < 1e-3


@pytest.mark.parametrize("name", JOINTS)
def test_each_number_that_can_move_has_one_handle_with_its_value(name: str) -> None:
    problem, tables = JOINTS[name], problem_tables(JOINTS[name])
    found = sketch(name)
    several = sum(len(beam.supports) + len(beam.masses) for beam in problem.beams)
    places = sum(1 if stop.between is None else 2 for stop in problem.stops)
    count = len(problem.stops) + places + len(problem.supports) + len(problem.masses) + several
    assert len(by_path(found)) == len(found.handles) == count
    assert len({handle.label for handle in found.handles}) == count
    for handle in found.handles:
        ((path, value),) = targets(tables, handle.path, "")
        assert path == handle.path
        assert handle.least <= handle.value <= handle.most
        assert (f"{handle.beam}{handle.value:g}" if isinstance(value, str) else handle.value) == value


@pytest.mark.parametrize("name", ["sdnl104", *(pytest.param(name, marks=pytest.mark.thorough) for name in JOINTS)])
def test_what_moves_by_a_step_moves_in_the_picture_by_the_step_over_the_reach(name: str) -> None:
    problem = JOINTS[name]
    for handle in sketch(name).handles:
        if handle.is_gap or handle.path.startswith("supports"):  # springs step aside where a stop is below
            continue
        tables = problem_tables(problem)
        step = handle.step if handle.value + handle.step <= handle.most else -handle.step
        to = handle.value + step
        assign(tables, handle.path, f"{handle.beam}{to}" if handle.beam else to, "")
        after = by_path(drawn(problem_from_tables(tables)))[handle.path]
        for picture in (WIDE, NARROW):
            moved = after.centres[picture][0] - handle.centres[picture][0]
            assert moved * handle.reach[picture] == pytest.approx(step, rel=1e-6), handle


@pytest.mark.parametrize("name", JOINTS)
def test_a_pull_away_from_the_beam_widens_a_gap(name: str) -> None:
    problem = JOINTS[name]
    for handle, stop in zip([h for h in sketch(name).handles if h.is_gap], problem.structure.stops, strict=True):
        assert math.copysign(1, handle.reach[WIDE]) == -stop.sign  # downwards in the picture is away for a bottom stop


def test_names_are_written_not_run() -> None:
    for svg in sketch("crowded").svg:
        assert "<img" not in svg
        assert "&lt;img onload=a" in svg


def test_both_pictures_can_be_in_one_page() -> None:
    found = sketch("paper")
    names = [set(re.findall(r'\bid="([^"]*)"', svg)) for svg in found.svg]
    assert names[0]
    assert not names[0] & names[1]
    for svg, own in zip(found.svg, names, strict=True):
        assert set(re.findall(r'(?:href="#|url\(#)([^")]*)', svg)) <= own


def contrast(one: np.ndarray, other: np.ndarray) -> float:
    """Contrast of two colours, as the Web Content Accessibility Guidelines 2.2 define it."""

    def luminance(colour: np.ndarray) -> float:
        c = colour / 255
        return float(np.where(c <= 0.04045, c / 12.92, ((c + 0.055) / 1.055) ** 2.4) @ (0.2126, 0.7152, 0.0722))

    low, high = sorted((luminance(one), luminance(other)))
    return (high + 0.05) / (low + 0.05)


@pytest.mark.parametrize(("ink", "paper"), [(0, 255), (255, 0)])
def test_colours_of_text_can_be_read_on_light_and_on_dark_paper(ink: int, paper: int) -> None:
    mixed = set(re.findall(r"fill: color-mix\(in srgb, #(\w{6}) (\d+)%, currentColor\)", sketch("crowded").svg[WIDE]))
    assert mixed
    for colour, share in mixed:
        own = np.array([int(colour[i : i + 2], 16) for i in (0, 2, 4)]) * int(share) / 100
        assert contrast(own + ink * (1 - int(share) / 100), np.full(3, paper)) > 4.5, colour
    colours = re.sub(r"color-mix\([^)]*\)", "", sketch("crowded").svg[WIDE])
    assert not re.search(r"(?:fill|stroke): #", colours)


@pytest.mark.thorough
def test_it_is_made_without_a_state_of_figures_and_without_the_parts_of_a_page() -> None:
    code = (
        "import sys; from explore.drawing import drawn; from lapjoint import paper_joint; drawn(paper_joint()); "
        "sys.exit(', '.join({'matplotlib.pyplot', 'panel', 'bokeh'} & set(sys.modules)) or 0)"
    )
    subprocess.run([sys.executable, "-c", code], check=True, timeout=60)
