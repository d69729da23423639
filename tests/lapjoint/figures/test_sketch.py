"""The sketch of a joint: everything of the problem is in it, names are drawn as they are, and texts keep apart."""

from __future__ import annotations

import math
from itertools import combinations

import pytest
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg

from lapjoint import (
    Beam,
    BeamSegment,
    Gravity,
    Mass,
    Problem,
    SineLoad,
    StepLoad,
    Stop,
    Support,
    UniformLoad,
    paper_joint,
    sdnl104,
)
from lapjoint.figures import plot_joint
from lapjoint.figures.style import figure_of

BEAM = Beam(length=1.5, bending_stiffness=1e3, mass_per_length=4.0)
CROWDED = Problem(
    beam=BEAM,
    supports=(
        Support(x=0.0, translational=900.0),
        Support(x=0.6, translational=5.0, torsional=130.0),
        Support(x=1.2, translational=math.inf),
    ),
    stops=tuple(Stop(x=0.15 * i, side="top" if i % 2 else "bottom", gap=0.0, stiffness=1e4) for i in range(1, 9)),
    point_loads=(SineLoad(x=0.9, force=3.0, angular_frequency=4.0), StepLoad(x=0.3, force=-5.0)),
)
MANY = Problem(
    beam=BEAM,
    stops=tuple(Stop(name=f"$a_{i}$", x=0.05 * i, side="top", gap=1e-3, stiffness=1e4) for i in range(30)),
)
JOINTS = {"paper": paper_joint(), "sdnl104": sdnl104(), "crowded": CROWDED, "many": MANY, "bare": Problem(beam=BEAM)}


def texts(axes: Axes) -> list[str]:
    return [text.get_text() for text in axes.texts if text.get_text()]


def test_the_paper_joint_is_all_there() -> None:
    drawn = " ".join(texts(plot_joint(paper_joint(angular_frequency=515.0))))
    for part in (
        "P2",
        "P3",
        "P4",
        "P5",
        "gap 0.001 m",
        "k 1.476e+08 N/m",
        "0.06 m",
        "515 rad/s (81.96 Hz)",
        "1.25",
        "2.5",
    ):
        assert part in drawn


@pytest.mark.parametrize("width", [3.4, 7.0])
@pytest.mark.parametrize("name", JOINTS)
def test_no_two_texts_stand_on_each_other_and_none_is_cut(name: str, width: float) -> None:
    axes = plot_joint(JOINTS[name], width=width)
    figure = figure_of(axes)
    canvas = FigureCanvasAgg(figure)
    canvas.draw()  # type: ignore[no-untyped-call]
    renderer = canvas.get_renderer()  # type: ignore[no-untyped-call]
    boxes = [(t.get_text(), t.get_window_extent(renderer)) for t in axes.texts if t.get_text()]
    for (one, a), (other, b) in combinations(boxes, 2):
        assert not a.padded(-2).overlaps(b.padded(-2)), (one, other)
    for text, box in boxes:
        assert figure.bbox.x0 <= box.x0, text
        assert box.x1 <= figure.bbox.x1, text


def test_many_stops_are_counted_and_named_where_there_is_room() -> None:
    drawn = texts(plot_joint(MANY))
    assert "30 stops" in drawn
    assert 2 <= sum("a_" in text for text in drawn) < 30


def test_a_name_is_drawn_as_it_is() -> None:
    joint = Problem(beam=BEAM, stops=(Stop(name="$x^2$", x=0.5, side="top", gap=1e-3, stiffness=1e4),))
    assert any(text.startswith(r"\$x^2\$") for text in texts(plot_joint(joint)))


def test_everything_that_rests_on_a_joint_is_in_its_sketch() -> None:
    joint = Problem(
        beam=Beam(
            length=0.6,
            segments=(
                BeamSegment(to=0.2, bending_stiffness=5e3, mass_per_length=6.0),
                BeamSegment(to=0.6, bending_stiffness=1e3, mass_per_length=4.0),
            ),
        ),
        supports=(Support(x=0.0, translational=math.inf, torsional=math.inf),),
        masses=(Mass(x=0.6, mass=0.8, rotary_inertia=4e-4, name="clevis"),),
        stops=(
            Stop(x=0.3, side="bottom", gap=-1e-5, stiffness=2e6),
            Stop(x=0.45, side="top", gap=1e-3, stiffness=1e6, damping=70.0, fixed_to="space"),
        ),
        gravity=Gravity(acceleration=-9.81),
        uniform_loads=(UniformLoad(start=0.1, to=0.25, force_per_length=-30.0),),
        point_loads=(StepLoad(x=0.52, force=-12.0), SineLoad(x=0.38, force=7.0, angular_frequency=4.0)),
    )
    drawn = " ".join(texts(plot_joint(joint)))
    for part in ("-12 N", "7 N", "0.1", "0.25", "0.38", "0.52"):  # each load, and its place on the axis
        assert part in drawn.split() if part.startswith("0") else part in drawn
    for part in ("clevis", "m 0.8 kg", "J 0.0004 kg m2", "interference 1e-05 m", "fixed in space", "9.81 m/s2"):
        assert part in drawn
    for part in ("-30 N/m", "0.2", "gap 0.001 m", "c 70 N s/m"):
        assert part in drawn


def test_a_mass_between_two_stops_is_named_beside_them() -> None:
    jaws = tuple(Stop(name=side, x=1.5, side=side, gap=1e-3, stiffness=1e6) for side in ("top", "bottom"))
    drawn = texts(plot_joint(Problem(beam=BEAM, stops=jaws, masses=(Mass(x=1.5, mass=0.8, name="clevis"),))))
    assert "clevis 0.8 kg" in drawn


def test_a_stop_without_room_beside_it_is_named_beyond_its_ground() -> None:
    stops = tuple(
        Stop(name=name, x=x, side="top", gap=1e-3, stiffness=1e6) for name, x in (("bush", 1.2), ("wall", 1.5))
    )
    drawn = texts(plot_joint(Problem(beam=BEAM, stops=stops, gravity=Gravity(acceleration=-9.81))))
    assert "wall" in " ".join(drawn)
