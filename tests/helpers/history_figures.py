"""Every figure of a history, and what must hold of each: it fits its paper."""

from __future__ import annotations

from lapjoint.figures import (
    plot_contact_impulses,
    plot_contact_states,
    plot_motion,
    plot_phase_portrait,
    plot_poincare_section,
    plot_spectrum,
)
from lapjoint.figures.style import figure_of

OF_HISTORIES = (
    plot_motion,
    plot_phase_portrait,
    plot_poincare_section,
    plot_contact_impulses,
    plot_contact_states,
    plot_spectrum,
)


def assert_fits(axes: object, width: float, height: float) -> None:
    """All that is drawn lies on the paper; the figure is laid out first, as it is when it is written."""
    figure = figure_of(axes)  # type: ignore[arg-type]
    figure.draw_without_rendering()
    box = figure.get_tightbbox()
    assert box.x0 >= 0
    assert box.y0 >= 0
    assert box.x1 <= width
    assert box.y1 <= height
