"""What cannot be drawn is refused in a sentence that names the argument."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace

import pytest
from written_history import OMEGA

import analytic
from lapjoint import BaseMotion, History, InputError, contact_states, paper_joint
from lapjoint.figures import (
    new_panels,
    plot_convergence,
    plot_motion,
    plot_poincare_section,
    plot_spectrum,
    plot_state_shapes,
)

JOINT = paper_joint()
MODES = [analytic.Solver().modes(JOINT, state, 2) for state in contact_states(JOINT)]


def driven(history: History, start: float = 0.0) -> History:
    """The history from a time on, under a base motion of the frequency of its swing."""
    base = BaseMotion(amplitude=1e-3, angular_frequency=OMEGA)
    return replace(history, problem=history.problem.replace(base_motion=base), start=start)


REFUSED: list[tuple[Callable[[History], object], str]] = [
    (lambda h: plot_motion(h, x=1.5), "x = 1.5: lies outside the beam; allowed are 0 to 1 m"),
    (lambda h: plot_motion(h, x=[0.5, math.nan]), "x = nan: lies outside the beam"),
    (lambda h: plot_motion(h, x=[]), r"x = \[\]: names no position; one or more are needed"),
    (lambda h: plot_motion(h, samples=1), "samples = 1: must be 2 or more"),
    (lambda h: plot_spectrum(h, harmonics=0), "harmonics = 0: must be 1 or more"),
    (lambda h: plot_spectrum(h, x=2.0), "x = 2: lies outside the beam"),
    (lambda h: plot_spectrum(replace(h, end=0.0)), "history: runs from 0 to 0 s; a spectrum needs a duration"),
    (plot_poincare_section, "a Poincare section: the excitation must have one angular_frequency"),
    (
        lambda h: plot_poincare_section(driven(h, 0.5), phase=1.0),
        r"phase = 1: the history, 0\.5 to 1 s, holds no section; allowed are .* 1 s",
    ),
    (lambda h: plot_poincare_section(driven(h), phase=math.nan), "phase = nan: must be finite, in rad"),
    (lambda h: plot_poincare_section(driven(h), x=-1.0), "x = -1: lies outside the beam"),
    (lambda _: plot_state_shapes(JOINT, []), "states_modes: has 0 groups of states; 1 to 24 can be drawn"),
    (lambda _: plot_state_shapes(JOINT, MODES, count=0), "count = 0: must be 1 or more"),
    (lambda _: plot_state_shapes(JOINT, MODES, new_panels(1, 1, 3.4, 2.0)), "axes: has 1 panels; these states need 4"),
    (lambda h: plot_convergence({8: h, 16: h}, reference=1.0), "quantity: must say which number to take"),
    (
        lambda _: plot_convergence({8: 1.0, 16: math.nan}, reference=1.0),
        "answers: the number at resolution 16 is nan; it must be finite",
    ),
    (lambda _: plot_convergence({8: 1.0, 0: 1.0}, reference=1.0), "resolution 0 must be positive and finite"),
    (
        lambda _: plot_convergence({8: 1.0, 16: 1.1}),
        "answers: there are 2; two or more are needed, and one more where reference is None",
    ),
    (lambda _: plot_convergence({}, reference=1.0), "answers: there are 0; two or more are needed"),
    (lambda _: plot_convergence({}), "answers: there are 0; two or more are needed"),
    (lambda _: plot_convergence({8: 1.0, 16: 1.1}, reference=0.0), "reference = 0.0: must be finite and not zero"),
    (lambda _: plot_convergence({8: 1.0, 16: 1.1, 32: 0.0}), "reference = 0.0: must be finite and not zero"),
]


@pytest.mark.parametrize(("plot", "message"), REFUSED)
def test_what_cannot_be_drawn_is_refused_by_name(
    history: History, plot: Callable[[History], object], message: str
) -> None:
    with pytest.raises(InputError, match=message):
        plot(history)
