"""Printing of static equilibria by the command line, and their content in JSON files."""

from __future__ import annotations

from typing import Any

import numpy as np

from lapjoint.answers import Equilibrium, Extreme
from lapjoint.cli.echo import echo
from lapjoint.cli.printing import print_source, stop_column
from lapjoint.figures.text import error_text

_COMPARED = 101
"""Number of places along the beam at which two solvers are compared."""


def print_equilibrium(found: Equilibrium) -> None:
    """Print the forces of stops and supports, the largest moment and stress, and the tip, with their errors."""
    problem = found.problem
    echo(f"{found.solver}: {problem.title or 'static equilibrium'}")
    if found.other_equilibria:
        echo(found.other_equilibria)
    if problem.structure.stops:
        pressing = ", ".join(problem.stop_names[k] for k in found.state.closed)
        echo(f"\nForce of each stop [N]; {f'pressing: {pressing}' if pressing else 'none presses'}")
        names, width = stop_column(problem)
        rows = zip(names, problem.structure.stops, found.contact_forces, found.errors.contact_forces, strict=True)
        for name, stop, force, error in rows:
            echo(f"{name:<{width}}x = {stop.where:<8} {stop.side:<8}{_with_error(force, error)}")
    if problem.structure.supports:
        echo(
            "\nForce [N] and couple [N m] of each support on the beam, force upwards and couple anticlockwise positive"
        )
    for i, support in enumerate(problem.structure.supports):
        force = _with_error(found.support_forces[i], found.errors.support_forces[i])
        couple = _with_error(found.support_moments[i], found.errors.support_moments[i])
        echo(f"{i + 1:<10}x = {problem.line.place(support.x):<8} {force} {couple}")
    echo()
    for label, extreme in _extremes(found).items():
        echo(f"{label:<38}{_with_error(extreme.value, extreme.error)}  at x = {found.problem.line.place(extreme.x)} m")
    print_source(found.error_source)


def _extremes(found: Equilibrium) -> dict[str, Extreme]:
    """The largest moment and, where there is a section, the largest stress; and the displacement of the tip."""
    L = found.problem.line.length
    extremes = {"Largest bending moment [N m]": found.largest_moment()}
    if found.problem.line.has_sections:
        extremes["Largest bending stress at the top [Pa]"] = found.largest_stress()
    tip = Extreme(L, float(found.displacement(L)[0]), found.errors.displacement)
    return extremes | {"Displacement of the tip [m]": tip}


def _with_error(value: float, error: float) -> str:
    return f"{value:14.8g}  +- {error_text(float(error)):<8}"


def differences(one: Equilibrium, other: Equilibrium) -> list[str]:
    """What two solvers say differently of one joint, beyond the sum of their errors; nothing where they agree."""
    x = np.linspace(0.0, one.problem.line.length, _COMPARED)
    ours, theirs, found = one.errors, other.errors, []
    if one.state != other.state:
        names = (each.state.name(each.problem) for each in (one, other))
        found.append("pressing stops: " + " and ".join(names))
    for name, a, b, error in (
        ("stop", one.contact_forces, other.contact_forces, ours.contact_forces + theirs.contact_forces),
        ("force of support", one.support_forces, other.support_forces, ours.support_forces + theirs.support_forces),
        (
            "couple of support",
            one.support_moments,
            other.support_moments,
            ours.support_moments + theirs.support_moments,
        ),
    ):
        for i in np.flatnonzero(np.abs(a - b) > error).tolist():
            found.append(f"{name} {i + 1}: {a[i]:.10g} and {b[i]:.10g}, with errors of {error_text(float(error[i]))}")
    for name, unit in (("displacement", "m"), ("slope", "rad"), ("moment", "N m"), ("shear", "N")):
        apart = float(np.abs(getattr(one, name)(x) - getattr(other, name)(x)).max())
        allowed = getattr(ours, name) + getattr(theirs, name)
        if apart > allowed:
            found.append(f"{name}: {apart:.3g} {unit} apart, with errors of {error_text(allowed)}")
    return found


def print_agreement(found: list[str]) -> None:
    """Print what two solvers say differently, or that they agree."""
    echo("\nThe solvers disagree:" if found else "\nThe solvers agree within their errors.")
    for line in found:
        echo(f"  {line}")


def equilibrium_summary(found: Equilibrium) -> dict[str, Any]:
    """An equilibrium as JSON holds it."""
    problem, errors = found.problem, found.errors
    names, L = problem.stop_names, problem.line.length

    def extreme(of: Extreme) -> dict[str, float]:
        return {"x_m": of.x, "value": of.value, "error": of.error}

    section = problem.line.has_sections
    return {
        "solver": found.solver,
        "pressing": [names[k] for k in found.state.closed],
        "unique": found.unique,
        "other_equilibria": found.other_equilibria,
        "contact_forces_N": dict(zip(names, found.contact_forces.tolist(), strict=True)),
        "contact_force_errors_N": dict(zip(names, errors.contact_forces.tolist(), strict=True)),
        "support_forces_N": found.support_forces.tolist(),
        "support_force_errors_N": errors.support_forces.tolist(),
        "support_moments_Nm": found.support_moments.tolist(),
        "support_moment_errors_Nm": errors.support_moments.tolist(),
        "largest_moment_Nm": extreme(found.largest_moment()),
        "largest_stress_Pa": extreme(found.largest_stress()) if section else None,
        "tip_displacement_m": extreme(Extreme(L, float(found.displacement(L)[0]), errors.displacement)),
        "error_source": found.error_source,
    }
