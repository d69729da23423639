"""The command ``lapjoint equilibrium``: how a joint rests under its static loads."""

from __future__ import annotations

from typing import TYPE_CHECKING, cast

import click

from lapjoint.cli.completing import FILE
from lapjoint.cli.options import SolverChoice, problem_options, solver_options_with

if TYPE_CHECKING:
    from lapjoint import Problem
    from lapjoint.answers import Equilibrium
    from lapjoint.solver import Rests, Solver

BOTH = "both"
_PAIR = "analytic", "fe"


@click.command()
@problem_options
@solver_options_with("analytic", "analytic, fe, another installed, or both: analytic and fe, compared.")
@click.option("--json", "json_path", metavar="FILE", type=FILE, help="Write the equilibrium to FILE as JSON too.")
def equilibrium(problem: str, overrides: tuple[str, ...], json_path: str | None, solver: SolverChoice) -> None:
    """Print how PROBLEM rests: pressing stops, reactions, largest moment and stress, and the tip.

    The loads are gravity, the uniform loads, the constant parts of the point loads, and stops with an interference.
    """
    from lapjoint.cli import arguments, equilibrium_printing
    from lapjoint.cli.printing import write_json

    arguments.check_file("--json", json_path)
    if solver.name == BOTH:
        arguments.refuse(
            "is of one solver, and both are asked",
            modes=solver.n_modes,
            elements=solver.elements,
            option=solver.options or None,
        )
    solvers = [SolverChoice(name).make() for name in _PAIR] if solver.name == BOTH else [solver.make()]
    this = arguments.problem_from(problem, overrides)
    answers = [_rested(one, this) for one in solvers]
    for answer in answers:
        equilibrium_printing.print_equilibrium(answer)
    differences = equilibrium_printing.differences(*answers) if len(answers) == 2 else []
    if len(answers) == 2:
        equilibrium_printing.print_agreement(differences)
    if json_path:
        summaries = [equilibrium_printing.equilibrium_summary(answer) for answer in answers]
        both = {"solvers": summaries, "agree": not differences}
        write_json(json_path, both if len(answers) == 2 else summaries[0])
    click.get_current_context().exit(1 if differences else 0)


def _rested(solver: Solver, problem: Problem) -> Equilibrium:
    """The equilibrium by a solver; an InputError if the solver finds none of any problem."""
    from lapjoint.parts import require
    from lapjoint.solver import Rests

    require(solver, Rests, f"--solver {solver.name}", "equilibria")
    return cast("Rests", solver).equilibrium(problem)
