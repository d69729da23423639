"""Claims about the convergence study: what eight and five modes leave of the largest displacements."""

from __future__ import annotations

import numpy as np

import analytic
from lapjoint import FREE, History, paper_joint
from validation.ledger.entry import TIP, Entry, said

FREQUENCIES = (515.0, 820.0, 2060.5, 2950.0)  # The peaks, and a window, of Figure 4, rad/s
FEW, MANY = (8, 5), (30, 20)
KINDS = ("free", "contact")


def tolerance_entries() -> list[Entry]:
    """Both tolerances against the change by more modes."""
    changes: dict[str, list[float]] = {kind: [] for kind in KINDS}
    for omega in FREQUENCIES:
        few, many = (
            largest(
                analytic.PublishedScheme(*modes)
                .steady_state(paper_joint(angular_frequency=omega), sensitivity=False, errors=False)
                .history
            )
            for modes in (FEW, MANY)
        )
        for kind, a, b in zip(KINDS, few, many, strict=True):
            changes[kind].append(abs(a - b))
    return [_entry(kind, changes[kind]) for kind in KINDS]


def largest(history: History) -> tuple[float, float]:
    """Largest displacement of the tip while no stop is closed, and while one is, m; 0 if that never is."""
    t = np.linspace(history.start, history.end, 4000)
    z = np.abs(history.displacement(TIP, t)[0])
    free = np.array([history.state_at(time) == FREE for time in t])
    return float(z[free].max(initial=0.0)), float(z[~free].max(initial=0.0))


def _entry(kind: str, changes: list[float]) -> Entry:
    key, worst, at = f"tolerance/{kind}", max(changes), ", ".join(f"{omega:g}" for omega in FREQUENCIES)
    why = f"change of the tip's largest {kind} displacement, m, to {MANY[0]} and {MANY[1]} modes at {at} rad/s"
    if worst == 0:
        why = f"the text does not say where and when: at {at} rad/s the settled joint is never free of all its stops"
    found = {**said(f"{key}"), "largest change": worst}
    return Entry(key, found, why, published=", ".join(f"{change:.1e}" for change in changes) if worst else "")
