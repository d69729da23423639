"""The commands ``lapjoint export`` and ``lapjoint show``."""

from __future__ import annotations

from typing import Literal

import click

from lapjoint.cli.completing import DIRECTORY, FILE
from lapjoint.cli.echo import echo
from lapjoint.cli.motions import find_motions
from lapjoint.cli.options import (
    MotionChoice,
    SolverChoice,
    large_allowed,
    motion_options,
    problem_options,
    solver_options,
)


@click.command()
@problem_options
@solver_options
@motion_options
@click.option("-o", "--out", "directory", required=True, metavar="DIR", type=DIRECTORY, help="Directory of the files.")
@click.option(
    "--state",
    help="Write mode shapes of contact states instead: closed stops (P2+P4), free, 1-9, or all; see --n-modes.",
)
@click.option(
    "--format",
    "file_format",
    type=click.Choice(["pvd", "vtkhdf", "xdmf"]),
    default="pvd",
    show_default=True,
    help="pvd: .vtu files and a .pvd, for ParaView; vtkhdf: one file, for ParaView from 5.12 on; xdmf: for meshio.",
)
@click.option("--frames", type=int, help="Number of equidistant times.  [default: as many as the motion needs]")
@click.option("--times", metavar="T,T,..", help="The times to write, s, in place of --frames.")
@click.option("--points", type=int, default=81, show_default=True, help="Number of equidistant points along the beam.")
def export(
    problem: str,
    overrides: tuple[str, ...],
    directory: str,
    motion: MotionChoice,
    state: str | None,
    file_format: Literal["pvd", "vtkhdf", "xdmf"],
    frames: int | None,
    times: str | None,
    points: int,
    solver: SolverChoice,
) -> None:
    """Write the motion of PROBLEM, or its mode shapes, to DIR for ParaView: open DIR/motion.pvd.

    The switches of the contact state are always among the times.
    """
    from lapjoint.cli import arguments
    from lapjoint.cli.progress import shown_progress
    from lapjoint.scene import export_modes, export_motion
    from lapjoint.scene.layout import check_points
    from lapjoint.solver import MODES

    arguments.check_directory(directory)
    check_points(points)
    at = arguments.times_from(frames, times)
    if state is not None:
        chosen = {"duration": motion.duration, "steady": motion.steady_state, "beside": motion.beside}
        arguments.refuse("mode shapes have none", **chosen, frames=frames, times=times)
        this, answering = arguments.problem_from(problem, overrides), solver._replace(n_modes=None).make()
        count = MODES if solver.n_modes is None else solver.n_modes
        answers = [answering.modes(this, one, count) for one in arguments.states_from(this, state)]
        written = export_modes(this, answers, directory, solver=answering.name, format=file_format, points=points)
        echo("\n".join(f"Wrote {path}" for path in written))
        return
    found = find_motions(problem, overrides, motion, solver)
    with shown_progress("export") as progress:
        path = export_motion(
            found,
            directory,
            format=file_format,
            times=at,
            frames=frames,
            points=points,
            large=large_allowed(),
            say=lambda size: echo(f"export: {size}", err=True),
            progress=progress,
        )
    echo(f"Wrote {path}")


@click.command()
@problem_options
@solver_options
@motion_options
@click.option(
    "-o",
    "--out",
    "output",
    metavar="FILE",
    type=FILE,
    help="File of a picture (.png) or a film (.gif, .mp4).  [default: show a window]",
)
@click.option("--at", type=float, help="Time of a picture, s.  [default: the time of the largest contact force]")
@click.option("--frames", type=int, help="Number of frames of a film, or of a window.  [default: 60]")
@click.option("--pace", type=float, help="Frames a second of a film.  [default: 20]")
@click.option(
    "--colour",
    type=click.Choice(["stress", "velocity", "moment", "displacement"]),
    help="Quantity that colours the beam.  [default: stress, or moment if the problem has no section]",
)
@click.option(
    "--scale", type=float, help="Factor on displacements and gaps, 1 for true scale.  [default: by the motion]"
)
@click.option("--absolute", is_flag=True, help="Show the motion as seen from outside, not from the moving base.")
@click.option("--size", metavar="WxH", help="Width and height, pixels.  [default: 1200x520, films 900x400]")
def show(
    problem: str,
    overrides: tuple[str, ...],
    motion: MotionChoice,
    output: str | None,
    at: float | None,
    frames: int | None,
    pace: float | None,
    colour: Literal["stress", "velocity", "moment", "displacement"] | None,
    scale: float | None,
    absolute: bool,
    size: str | None,
    solver: SolverChoice,
) -> None:
    """Show the motion of PROBLEM in three dimensions: in a window, as a picture, or as a film.

    By default the bending stress colours the beam.  Closed stops light up, and the picture states its scale.
    """
    from lapjoint import scene
    from lapjoint.cli import arguments
    from lapjoint.cli.progress import shown_progress

    look = scene.Look(colour, scale, "absolute" if absolute else "relative", arguments.size_from(size))
    if output is not None:
        arguments.check_file("--out", output, *scene.PICTURES, *scene.FILMS)
    picture = output is not None and output.lower().endswith(scene.PICTURES)
    if picture:
        arguments.refuse("a picture has none", frames=frames, pace=pace)
    else:
        arguments.refuse("only a picture is of one time", at=at)
    if output is None:
        arguments.refuse("a window has none", pace=pace)
    scene.check_can_show(output)
    found = find_motions(problem, overrides, motion, solver)
    number = 60 if frames is None else frames
    if output is None:
        scene.show_window(found, frames=number, look=look)
        return
    if picture:
        scene.save_picture(found, output, at=at, look=look)
    else:
        with shown_progress("draw") as progress:
            scene.save_film(
                found, output, frames=number, pace=20.0 if pace is None else pace, look=look, progress=progress
            )
    echo(f"Wrote {output}")
