"""Claims about windows of Figure 4: low and high frequencies, the step near 1000, and motions that never settle."""

from __future__ import annotations

import cmath

import numpy as np

import analytic
import fe_lapjoint
from lapjoint import BaseMotion, Outcome, SteadyState, paper_joint
from lapjoint.answers.steady_state import ComplexArray
from validation.ledger.curves import PUBLISHED, Curve, Figure4, at
from validation.ledger.entry import TIP, Entry, said
from validation.ledger.rules import EVEN
from validation.ledger.window_branches import window

SILENT_BELOW = 230.0  # Frequency below which the paper finds no contact, rad/s
APERIODIC = (1398.0, 1398.5, 1399.0)  # Frequencies at which the paper finds aperiodic motions, rad/s
ASYMMETRIC = (2060.0, 2060.5, 2061.0, 2160.0, 2160.5, 2161.0)
"""Frequencies at which the paper finds one-sided motions, rad/s."""
TOUCHED = 1.0  # Least tip impulse that counts as contact, N s


def window_entries(curves: Figure4) -> list[Entry]:
    """All claims about windows."""
    return [
        low_frequencies(curves),
        step(),
        *never_settling(),
        *asymmetric_windows(),
        everywhere(curves),
        phase_lag(),
        enough_modes(curves),
    ]


def low_frequencies(curves: Figure4) -> Entry:
    """Whether the joint is silent below 230 rad/s."""

    def struck(curve: Curve) -> tuple[int, str]:
        here = curve.between(0.0, SILENT_BELOW - 1e-9)
        hit = here[curve.tip[here] > 0]
        if not hit.size:
            return 0, "silent"
        return hit.size, f"struck from {curve.omega[hit[0]]:g} rad/s on, up to {curve.tip[hit].max():.0f} N s"

    exact, fe, published = (struck(curve) for curve in (curves.converged, curves.fe, curves.published))
    here = curves.converged.between(0.0, SILENT_BELOW - 1e-9)
    closed = curves.converged.longest_contact[here].max()
    return Entry(
        "low frequencies",
        {"analytic struck": exact[0], "fe struck": fe[0]},
        f"in the steady state stops are struck and left in every cycle at {exact[0]} of {here.size} frequencies; the "
        f"longest contact lasts {closed:.0%} of a cycle",
        exact[1],
        fe[1],
        published[1],
    )


def step() -> Entry:
    """The abrupt change near 1000 rad/s."""
    near = tuple(np.arange(940.0, 1061.0, 4.0))

    def steepest(solver: str) -> tuple[float, float]:
        curve = at(solver, near)
        change = np.abs(np.diff(curve.tip)) / np.diff(curve.omega)
        i = int(np.argmax(change))
        return float(curve.omega[i]), float(change[i])

    (_, exact), (_, fe), (where, published) = (steepest(solver) for solver in ("analytic", "fe", PUBLISHED))
    return Entry(
        "step",
        {"analytic steepest": exact, "fe steepest": fe, "published steepest": published},
        f"the scheme as published is {published / exact:.2g} times as steep at {where:g} rad/s as the converged curve "
        "anywhere near",
        f"steepest {exact:.3g} N s per rad/s",
        f"steepest {fe:.3g} N s per rad/s",
        f"steepest {published:.3g} N s per rad/s, at {where:g}",
    )


def _stable(curve: Curve) -> int:
    """At how many frequencies the motion has one period, and all multipliers lie within the unit circle."""
    modulus = np.hypot(curve.dataset.multiplier_real.values, curve.dataset.multiplier_imag.values)
    return int(((curve.dataset.period_multiple.values == 1) & (modulus < 1)).sum())


def _certificates(curve: Curve) -> str:
    worst = float(np.nanmax(np.hypot(curve.dataset.multiplier_real.values, curve.dataset.multiplier_imag.values)))
    return f"{_stable(curve)} of {curve.omega.size} of period one, largest multiplier {worst:.3f}"


def _settled(curve: Curve) -> str:
    undecided = int(curve.outcome_is(Outcome.UNDECIDED).sum())
    return f"{undecided} of {curve.omega.size} do not settle, tip impulses up to {np.nanmax(curve.tip):.5g} N s"


def never_settling() -> list[Entry]:
    """The window near 1398 rad/s."""
    exact, fe, published = (at(solver, APERIODIC) for solver in ("analytic", "fe", PUBLISHED))
    through = {solver: window(solver, min(APERIODIC), max(APERIODIC)) for solver in ("analytic", "fe")}
    height, by_fe, printed = float(exact.tip[-1]), float(fe.tip[-1]), said("bound")
    settles = "does not settle everywhere" if published.outcome_is(Outcome.UNDECIDED).any() else "settles there, too"
    return [
        Entry(
            "aperiodic",
            {
                **{"analytic stable": _stable(exact), "fe stable": _stable(fe), "frequencies": len(APERIODIC)},
                **{f"{solver} changes": one.changes for solver, one in through.items()},
            },
            "a stable motion of one excitation period, closed to 1e-9, on a branch that leads through the window "
            f"without a bifurcation; the scheme as published {settles}",
            f"{_certificates(exact)}; {through['analytic'].words}",
            f"{_certificates(fe)}; {through['fe'].words}",
            _settled(published),
        ),
        Entry(
            "bound",
            {**printed, "analytic": height, "fe": by_fe},
            f"the steady impulse is {height / printed['printed']:.2f} times as large, in every cycle the same",
            f"{height:.5g}",
            f"{by_fe:.5g}",
            f"{published.tip[-1]:.5g}",
        ),
    ]


def asymmetric_windows() -> list[Entry]:
    """The windows near 2060 and 2160 rad/s, of which the text gives both numbers for one thing."""
    exact, fe, published = (at(solver, ASYMMETRIC) for solver in ("analytic", "fe", PUBLISHED))
    entries = []
    for rows, first in ((slice(0, 3), 2060), (slice(3, 6), 2160)):
        through = {solver: window(solver, first, first + 1.0) for solver in ("analytic", "fe")}
        worst = [float(curve.asymmetry[rows].max()) for curve in (exact, fe)]
        entries.append(
            Entry(
                f"window/{first}",
                {
                    **{"analytic asymmetry": worst[0], "fe asymmetry": worst[1]},
                    **{f"{solver} broken": one.broken for solver, one in through.items()},
                },
                f"the impulses of P2 and P4 differ by at most {max(worst):.0e} of the larger; no symmetry breaks "
                "in the window",
                f"asymmetry {worst[0]:.1g}, period {_multiples(exact, rows)}; {through['analytic'].words}",
                f"asymmetry {worst[1]:.1g}, period {_multiples(fe, rows)}; {through['fe'].words}",
                f"asymmetry {np.nanmax(published.asymmetry[rows]):.2g}, unsettled "
                f"{int(published.outcome_is(Outcome.UNDECIDED)[rows].sum())} of 3",
            )
        )
    return entries


def _multiples(curve: Curve, rows: slice) -> str:
    return ", ".join(str(multiple) for multiple in sorted(set(curve.dataset.period_multiple.values[rows].tolist())))


def everywhere(curves: Figure4) -> Entry:
    """How often the two tip stops differ, and how often nothing settles, over the whole figure."""

    def uneven(curve: Curve, least: float = 0.0) -> int:
        return int(((curve.asymmetry > EVEN) & (curve.tip > TOUCHED) & (curve.omega > least)).sum())

    def counted(curve: Curve) -> str:
        unsettled = int((curve.outcome_is(Outcome.UNDECIDED) | curve.outcome_is(Outcome.APERIODIC)).sum())
        return f"{uneven(curve)} asymmetric, {unsettled} unsettled of {curve.omega.size}"

    both = curves.converged, curves.fe
    share = [uneven(curve, SILENT_BELOW) / max(int((curve.omega > SILENT_BELOW).sum()), 1) for curve in both]
    return Entry(
        "asymmetric often",
        {"analytic share": share[0], "fe share": share[1]},
        f"from 230 rad/s on {share[0]:.0%} of the converged motions are asymmetric",
        *(counted(curve) for curve in (curves.converged, curves.fe, curves.published)),
    )


def phase_lag() -> Entry:
    """Whether the beam repeats the excitation with a lag of pi at high frequency."""
    omega = 5000.0
    problem = paper_joint(angular_frequency=omega)
    assert isinstance(problem.base_motion, BaseMotion)
    amplitude = problem.base_motion.amplitude
    x = np.array([TIP / 2, TIP])

    def response(found: SteadyState) -> ComplexArray:
        t = np.arange(256) / 256 * 2 * np.pi / omega
        wave = found.history.displacement(x, t) @ np.exp(-1j * omega * t) * 2 / 256 * 1j
        return np.asarray(wave / amplitude)  # 1 is in phase with the base, and as large

    answers = {
        "analytic": response(analytic.Solver().steady_state(problem, sensitivity=False, errors=False)),
        "fe": response(fe_lapjoint.Solver().steady_state(problem, sensitivity=False, errors=False)),
    }
    numbers = {}
    for solver, waves in answers.items():
        for place, wave in zip(("middle", "tip"), waves, strict=True):
            numbers[f"{solver} lag {place}"] = float(np.degrees(-cmath.phase(wave)) % 360.0)
            numbers[f"{solver} gain {place}"] = float(abs(wave))
    shown = [
        "; ".join(f"{abs(w):.3f} of Y at {np.degrees(cmath.phase(w)):+.0f} deg" for w in a) for a in answers.values()
    ]
    return Entry(
        "phase lag",
        numbers,
        "the fundamental of the relative displacement at 5000 rad/s; a lag of pi with the amplitude of the base would "
        "mean that the beam stands still in space, not that it moves with the table",
        *shown,
    )


def enough_modes(curves: Figure4) -> Entry:
    """Whether eight free and five contact modes are enough over the range of Figure 4."""
    exact = np.interp(curves.published.omega, curves.converged.omega, curves.converged.tip)
    size = float(np.nanmax(curves.converged.tip))
    away = ~(np.abs(curves.published.tip - exact) <= 0.01 * size)
    from_ = curves.published.omega[away]
    return Entry(
        "enough modes",
        {"share off": float(away.mean())},
        f"first at {from_[0]:.0f} rad/s" if away.any() else "the two curves are one",
        published=f"{away.mean():.0%} of the curve is off by more than 1 % of the largest impulse",
    )
