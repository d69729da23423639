"""Whatever a name holds and however long it is, figures draw it as it was given, in the room there is."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from itertools import product
from pathlib import Path
from typing import Any

import pytest
import xarray as xr
from beams import with_stops
from history_figures import OF_HISTORIES, assert_fits
from matplotlib.cbook import is_math_text
from matplotlib.text import Text
from written_history import OMEGA

import analytic
from lapjoint import FREE, BaseMotion, ContactState, History, Stop, paper_joint
from lapjoint.answers import Contact
from lapjoint.campaigns.grid import FREQUENCY, Axis, Grid
from lapjoint.campaigns.point import Point
from lapjoint.campaigns.sweep.spec import Plan
from lapjoint.campaigns.sweep.table import sweep_dataset
from lapjoint.figures import (
    new_axes,
    plot_contact_impulses,
    plot_contact_states,
    plot_convergence,
    plot_curve,
    plot_curve_wide,
    plot_mode_shapes,
    plot_motion,
    save,
)
from lapjoint.figures.style import COLUMN_WIDTH, PAGE_WIDTH, figure_of
from lapjoint.figures.text import apart, cut_to, shortened, width_of, wrapped

NASTY = ("Cost $5 and $7", r"$x_1^{$ & \alpha %", "_first", "two\nlines")
SIXTY = "Upper elastomer buffer of the left bracket, on frame 12, no. 3"[:60]


def pairs(plots: Sequence[Callable[..., Any]], texts: Sequence[Any]) -> list[Any]:
    """Each figure with each text; in every run each figure once, and each text, with the next of the others."""
    drawn = {(i % len(plots), i % len(texts)) for i in range(max(len(plots), len(texts)))}
    return [
        pytest.param(plot, text, id=f"{plot.__name__}-{j}", marks=() if (i, j) in drawn else pytest.mark.thorough)
        for (i, plot), (j, text) in product(enumerate(plots), enumerate(texts))
    ]


def named(history: History, *names: str, title: str = "") -> History:
    """The history with other names of its two stops."""
    problem = with_stops(history.problem, *({"name": name} for name in names))
    base = BaseMotion(amplitude=1e-3, angular_frequency=OMEGA)
    return replace(history, problem=problem.replace(title=title, base_motion=base))


def many(history: History, number: int) -> History:
    """As many stops, each with one contact."""
    stops = tuple(Stop(x=(i + 1) / number, side="top", gap=1e-3, stiffness=1e4) for i in range(number))
    contacts = tuple(Contact(i, 0.1, 0.2, 1.0 + i, 1.0) for i in range(number))
    return replace(history, problem=history.problem.replace(stops=stops), contacts=contacts)


def swept(*names: str, path: str = FREQUENCY) -> xr.Dataset:
    joint = paper_joint().replace(stops=paper_joint().stops[: len(names)])
    axes = (Axis(FREQUENCY, [100.0, 200.0, 300.0]), *([] if path == FREQUENCY else [Axis(path, [1e-3, 2e-3])]))
    plan = Plan(Grid(with_stops(joint, *({"name": name} for name in names)), axes))
    impulses = tuple(float(i) for i in range(len(names)))
    return sweep_dataset(plan, {cell: Point("PERIODIC", 1, impulses=impulses) for cell in range(plan.size)})


def drawn(axes: Any) -> list[str]:
    """All texts as they are seen, those that are drawn as mathematics left out."""
    figure = figure_of(axes)
    figure.draw_without_rendering()
    texts = [str(text.get_text()) for text in figure.findobj(Text)]  # type: ignore[attr-defined]
    return [text.replace(r"\$", "$") for text in texts if text and not is_math_text(text)]


@pytest.mark.parametrize("plot", OF_HISTORIES, ids=lambda plot: plot.__name__)
def test_a_title_is_drawn_as_it_is(history: History, plot: Callable[..., Any]) -> None:
    for title in (NASTY[0], NASTY[1]):
        assert any(title in text for text in drawn(plot(named(history, title=title))))


@pytest.mark.parametrize(("plot", "name"), pairs((plot_motion, plot_contact_impulses, plot_contact_states), NASTY))
def test_the_name_of_a_stop_is_drawn_as_it_is_and_in_one_line(
    history: History, plot: Callable[..., Any], name: str
) -> None:
    texts = drawn(plot(named(history, name, "other")))
    assert name.replace("\n", " ") in [text.strip("\u200a") for text in texts]
    assert "other" in texts


@pytest.mark.parametrize(("plot", "name"), pairs((plot_curve, plot_curve_wide), NASTY))
def test_a_sweep_names_its_stops_as_they_are(plot: Callable[..., Any], name: str) -> None:
    assert name.replace("\n", " ") in [text.strip("\u200a") for text in drawn(plot(swept("P2", name)))]


def test_labels_are_drawn_as_they_are_and_our_own_mathematics_stays(history: History) -> None:
    answers = {n: 1 + 1.0 / n**2 for n in (8, 16)}
    assert "$a$, order 2.00" in drawn(plot_convergence(answers, reference=1.0, label="$a$"))
    modes = analytic.Solver().modes(paper_joint(), FREE, 2)
    assert plot_mode_shapes(paper_joint().replace(title="$5"), modes).get_ylabel() == "mode shape [kg$^{-1/2}$]"


LONG = (
    (SIXTY, COLUMN_WIDTH),
    ("W" * 60, COLUMN_WIDTH),
    ("W" * 60, PAGE_WIDTH),
    ("file_names_without_any_space_" * 5, COLUMN_WIDTH),
    ("long " * 60, PAGE_WIDTH),
)


@pytest.mark.parametrize(("plot", "words_and_width"), pairs(OF_HISTORIES, LONG))
def test_long_words_stay_on_the_paper(
    history: History, plot: Callable[..., Any], words_and_width: tuple[str, float]
) -> None:
    words, width = words_and_width
    motion = replace(named(history, words, f"{words[:-1]}b", title=words), solver=words)
    axes = plot(motion, new_axes(width, 3.2))
    assert_fits(axes, width, 3.2)
    assert axes.get_position().width > 0.45  # of the figure


SWEPT = ((SIXTY, "stops.P2.gap"), ("W" * 60, FREQUENCY), ("long " * 60, "stops.P2.gap"))


@pytest.mark.parametrize(("plot", "words_and_path"), pairs((plot_curve, plot_curve_wide), SWEPT))
def test_a_sweep_of_stops_with_long_names_stays_on_the_paper(
    tmp_path: Path, plot: Callable[..., Any], words_and_path: tuple[str, str]
) -> None:
    words, path = words_and_path
    name = words.strip()
    axes = plot(swept(name, "other", path=path.replace("P2", name)))
    save(axes, tmp_path / "curve.png")
    assert_fits(axes, *figure_of(axes).get_size_inches())


def test_sixty_characters_are_written_out_where_a_line_is_theirs(history: History) -> None:
    assert SIXTY in drawn(plot_contact_impulses(named(history, SIXTY, "other")))
    assert SIXTY in drawn(plot_curve_wide(swept(SIXTY)))


@pytest.mark.parametrize("number", [14, pytest.param(40, marks=pytest.mark.thorough), 150])
def test_many_stops_have_a_key_that_fits_and_colour_and_marker_of_their_own(history: History, number: int) -> None:
    axes = plot_contact_impulses(many(history, number))
    assert_fits(axes, PAGE_WIDTH, 3.2)
    assert axes.get_position().height > 0.3
    lines = [line for line in axes.lines if not str(line.get_label()).startswith("_")]
    assert len({(line.get_color(), str(line.get_marker())) for line in lines}) == min(number, 56)
    last = axes.get_legend().get_texts()[-1].get_text()
    assert last == f"stop {number}" or last.startswith("… ")


def test_a_key_that_is_too_long_says_how_much_is_left_out(history: History) -> None:
    texts = [text.get_text() for text in plot_contact_impulses(many(history, 150)).get_legend().get_texts()]
    assert texts[-1] == f"… {150 - len(texts) + 1} more"


def test_a_sweep_without_stops_says_so() -> None:
    assert "no stops, no impulses" in drawn(plot_curve(swept()))
    assert "what was established, without stops" in drawn(plot_curve_wide(swept()))


def test_a_name_is_shortened_in_its_middle_and_no_more_than_needed() -> None:
    assert cut_to("left bracket, upper", 12) == "left br…pper"
    assert cut_to("short", 12) == "short"
    for room in (0.5, 1.0, 2.0):
        short = shortened(SIXTY, room)
        assert room - 0.2 < width_of(short) <= room
        assert short.startswith("Upper") or room < 1.0


def test_names_that_shorten_to_one_keep_apart() -> None:
    names = [f"bracket {i} of the left frame" for i in (1, 2)]
    assert apart(names, lambda name: cut_to(name, 10)) == ["1: bra…ame", "2: bra…ame"]
    assert apart(["a", "a"], lambda name: cut_to(name, 10)) == ["a", "a"]


def test_lines_end_at_spaces_else_after_signs_else_anywhere() -> None:
    room = width_of("mmmmmmmm")
    assert wrapped("one two three and more", room) == ["one two three", "and more"]
    assert all(line.endswith("_") for line in wrapped("of_these_words_that_are_long", room)[:-1])
    assert "".join(wrapped("l" * 100, room)) == "l" * 100
    assert wrapped("left\u00a0bracket and\u00a0right\u00a0bracket", room)[1] == "right bracket"
    for text in ("W" * 30, "of_these_words " * 3):
        assert all(width_of(line) <= room for line in wrapped(text, room))


def test_the_title_of_a_mode_breaks_no_word_of_a_long_name() -> None:
    names = ({"name": f"{place} elastomer buffer of the bracket"} for place in ("left", "right"))
    problem = with_stops(paper_joint(), *names).replace(title="Frame")
    modes = analytic.Solver().modes(problem, ContactState((0, 1)), 2)
    axes = plot_mode_shapes(problem, modes, new_axes(COLUMN_WIDTH, 3.0))
    title = axes.get_legend().get_title().get_text()
    assert set(title.replace("…", " ").split()) & {"bracket", "buffer"}
    assert not set(title.split()) & {"brac", "ket", "buf", "fer", "brack", "et"}


def test_signs_unknown_to_the_font_are_no_warning(history: History, tmp_path: Path) -> None:
    save(plot_motion(named(history, "\u4e0a", "below", title="\u68c1")), tmp_path / "motion.png")
