"""Printing of static equilibria by the command line, and their content in JSON files."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from lapjoint.answers import Equilibrium, Extreme
from lapjoint.cli.echo import echo
from lapjoint.cli.printing import print_source, stop_column
from lapjoint.figures.text import error_text

_COMPARED = 101
"""Number of places along each beam at which two solvers are compared."""


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
        wide = max(8, *(len(stop.where) + 1 for stop in problem.structure.stops))
        rows = zip(names, problem.structure.stops, found.contact_forces, found.errors.contact_forces, strict=True)
        for name, stop, force, error in rows:
            echo(f"{name:<{width}}x = {stop.where:<{wide}} {stop.side:<8}{_with_error(force, error)}")
    for what, places, numbers in _held(found):
        echo(f"\nForce [N] and couple [N m] of each {what}, force upwards and couple anticlockwise positive")
        wide = max(8, *map(len, places))
        for i, (place, (force, of_force, couple, of_couple)) in enumerate(zip(places, numbers, strict=True), start=1):
            echo(f"{i:<10}x = {place:<{wide}} {_with_error(force, of_force)} {_with_error(couple, of_couple)}")
    echo()
    for label, extreme in _extremes(found):
        echo(f"{label:<38}{_with_error(extreme.value, extreme.error)}  at x = {found.problem.line.place(extreme.x)} m")
    print_source(found.error_source)


def _held(found: Equilibrium) -> Iterator[tuple[str, list[str], list[tuple[float, float, float, float]]]]:
    """Supports and links, if there are any: their words, places, and forces and couples, each with its error."""
    errors, problem = found.errors, found.problem
    supports = found.support_forces, errors.support_forces, found.support_moments, errors.support_moments
    links = found.link_forces, errors.link_forces, found.link_moments, errors.link_moments
    if problem.structure.supports:
        places = [problem.line.place(it.x) for it in problem.structure.supports]
        yield "support on the beam", places, list(zip(*(each.tolist() for each in supports), strict=True))
    if problem.structure.links:
        places = [" to ".join(map(problem.line.place, (it.first, it.second))) for it in problem.structure.links]
        yield "link on its second beam", places, list(zip(*(each.tolist() for each in links), strict=True))


def _extremes(found: Equilibrium) -> list[tuple[str, Extreme]]:
    """The largest moment and, where there is a section, the largest stress; and the displacement of each tip."""
    extremes = [("Largest bending moment [N m]", found.largest_moment())]
    if found.problem.line.has_sections:
        extremes.append(("Largest bending stress at the top [Pa]", found.largest_stress()))
    return extremes + [("Displacement of the tip [m]", tip) for tip in found.tips]


def _with_error(value: float, error: float) -> str:
    return f"{value:14.8g}  +- {error_text(float(error)):<8}"


def differences(one: Equilibrium, other: Equilibrium) -> list[str]:
    """What two solvers say differently of one joint, beyond the sum of their errors; nothing where they agree."""
    x = one.problem.line.grid(_COMPARED)
    ours, theirs, found = one.errors, other.errors, []
    if one.state != other.state:
        names = (each.state.name(each.problem) for each in (one, other))
        found.append("pressing stops: " + " and ".join(names))
    for name, what in (
        ("stop", "contact_forces"),
        ("force of support", "support_forces"),
        ("couple of support", "support_moments"),
        ("force of link", "link_forces"),
        ("couple of link", "link_moments"),
    ):
        a, b, error = getattr(one, what), getattr(other, what), getattr(ours, what) + getattr(theirs, what)
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
    names, line = problem.stop_names, problem.line

    def extreme(of: Extreme) -> dict[str, Any]:
        i = line.beam_at(of.x)
        beam = {"beam": line.names[i]} if line.several else {}
        return beam | {"x_m": of.x - line.starts[i], "value": of.value, "error": of.error}

    tips = [extreme(tip) for tip in found.tips]
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
        "link_forces_N": found.link_forces.tolist(),
        "link_force_errors_N": errors.link_forces.tolist(),
        "link_moments_Nm": found.link_moments.tolist(),
        "link_moment_errors_Nm": errors.link_moments.tolist(),
        "largest_moment_Nm": extreme(found.largest_moment()),
        "largest_stress_Pa": extreme(found.largest_stress()) if section else None,
        "tip_displacement_m": tips if line.several else tips[0],
        "error_source": found.error_source,
    }
