"""The number of modes that is enough at each excitation frequency, for the impulses of both schemes."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

import analytic
from analytic.published.loss import frozen_part
from lapjoint import paper_joint
from lapjoint.errors import SolverError
from lapjoint.machine.processes import process_pool
from lapjoint.problem import FloatArray
from lapjoint.solver import Solver
from validation.case import CaseResult, Level, Say, table
from validation.report.drawing import draw
from validation.verdict import Criterion

if TYPE_CHECKING:
    from matplotlib.axes import Axes

FREQUENCIES = {
    "quick": (250.0, 515.0, 820.0, 1400.0, 2060.0, 2950.0, 4000.0, 5000.0),
    "standard": tuple(np.arange(250.0, 5001.0, 250.0)),
    "full": tuple(np.arange(125.0, 5001.0, 125.0)),
}
COUNTS = (5, 8, 10, 12, 15, 20, 30)  # Numbers of modes in every state
PUBLISHED_COUNTS = ((8, 5), (12, 8), (20, 12), (30, 20))  # Numbers of modes without contact and in contact
REFERENCE = 60  # Number of modes of the converged reference
MECHANISM = (515.0, 1000.0, 1398.5, 2060.5, 2160.5, 2950.0)  # Peaks and windows of the paper's Figure 4, rad/s
AFTER = (40, 290)  # Cycles from rest
WORKERS = 2
SMALL = 1e-3  # Least error that counts, divided by the largest impulse of the motion
Make = Callable[[], Solver]


def impulses(make: Make, omega: float) -> FloatArray:
    """Impulses per excitation period, N s, shape ``(stops,)``; NaN if the solver fails."""
    problem = paper_joint(angular_frequency=omega)
    try:
        return make().steady_state(problem, sensitivity=False, errors=False).impulses
    except SolverError:
        return np.full(len(problem.stops), np.nan)


def errors(makes: dict[str, Make], frequencies: tuple[float, ...], say: Say) -> FloatArray:
    """Largest error of an impulse, divided by the largest impulse, shape ``(schemes, frequencies)``; NaN without an
    answer."""
    every = (partial(analytic.Solver, n_modes=REFERENCE), *makes.values())
    pairs = [(make, omega) for make in every for omega in frequencies]
    with process_pool(WORKERS) as pool:
        answers = iter(pool.map(impulses, *zip(*pairs, strict=True)))
        reference = [next(answers) for _ in frequencies]
        result = np.empty((len(makes), len(frequencies)))
        for i, label in enumerate(makes):
            for j in range(len(frequencies)):
                result[i, j] = np.abs(next(answers) - reference[j]).max() / np.abs(reference[j]).max()
            say(label)
    return result


def left_behind(omega: float, free: int, contact: int) -> list[float]:
    """Frozen part of the displacement, divided by the displacement, as means over the switches of ten cycles, at two
    times."""
    period = 2 * np.pi / omega
    scheme = analytic.PublishedScheme(free, contact)
    part = frozen_part(scheme.simulate(paper_joint(angular_frequency=omega), (AFTER[-1] + 10) * period, errors=False))
    cycle = part.time / period
    return [float(part.displacement[(cycle > after) & (cycle <= after + 10)].mean()) for after in AFTER]


def run(level: Level, say: Say) -> CaseResult:
    """The map, and the least number of modes at each frequency."""
    frequencies = FREQUENCIES[level]
    ours = {f"{n} modes": partial(analytic.Solver, n_modes=n) for n in COUNTS}
    theirs = {f"as published, {a} and {b}": partial(analytic.PublishedScheme, a, b) for a, b in PUBLISHED_COUNTS}
    found = errors({**ours, **theirs}, frequencies, say)
    labels = [*ours, *theirs]
    enough = [int(np.argmax(column[: len(COUNTS)] <= SMALL)) for column in found.T]
    small = found[: len(COUNTS)] <= SMALL
    rows = [
        (f"{omega:g}", *(f"{error:.1e}" if np.isfinite(error) else "none" for error in found[:, j]))
        for j, omega in enumerate(frequencies)
    ]
    return CaseResult(
        "mode-map",
        "How many modes are enough, where",
        f"Steady-state impulses by every number of modes against {REFERENCE} modes: the largest error over the largest "
        "impulse. Above, what the left-out modes would carry follows its equilibrium; below, in the scheme as "
        "published, it stays frozen from switch to switch. With enough modes the paper's own scheme comes to the same "
        "motion; eight and five are not enough from about 2000 rad/s on. There, and near 1000, the frozen "
        "part grows from cycle to cycle: that is what makes the step and the one-sided motions of Figure 4.",
        criteria=(
            Criterion(
                "frequencies at which some number of modes up to 30 holds a thousandth",
                "1",
                float(small.any(axis=0).sum()),
                len(frequencies),
                len(frequencies),
                "or the solver does not converge",
            ),
            Criterion(
                "most modes needed for a thousandth",
                "1",
                float(max(COUNTS[i] for i in enough)),
                5,
                30,
                "the default criterion takes 15 to 27",
            ),
        ),
        tables=(
            table("Error of the impulses by number of modes", ("omega (rad/s)", *labels), rows),
            table(
                "Share of the displacement that a switch of the published scheme leaves frozen, mean over ten cycles",
                ("omega (rad/s)", "modes", *(f"after {cycles} cycles" for cycles in AFTER)),
                [
                    (
                        f"{omega:g}",
                        f"{free} and {contact}",
                        *(f"{share:.1e}" for share in left_behind(omega, free, contact)),
                    )
                    for omega in MECHANISM
                    for free, contact in ((8, 5), (24, 24))
                ],
            ),
        ),
        drawings=(
            draw("Error of the impulses", lambda axes: _paint(axes, found, labels, frequencies), width=8.0, height=4.6),
        ),
    )


def _paint(axes: Axes, found: FloatArray, labels: list[str], frequencies: tuple[float, ...]) -> None:
    from matplotlib.colors import LogNorm

    shown = np.ma.masked_invalid(found)
    image = axes.imshow(shown, aspect="auto", norm=LogNorm(1e-7, 1.0), cmap="cividis", interpolation="nearest")
    step = max(1, len(frequencies) // 10)
    axes.set_xticks(range(0, len(frequencies), step), [f"{omega:g}" for omega in frequencies[::step]])
    axes.set_yticks(range(len(labels)), labels)
    axes.axhline(len(COUNTS) - 0.5, color="white", lw=2)
    axes.grid(False)
    axes.set_xlabel("excitation frequency [rad/s]")
    axes.figure.colorbar(image, ax=axes, label="error over the largest impulse; blank: no answer")
