"""A dataset that a command finds, or that is finished already in the file it would write."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from lapjoint.cli.echo import echo
from lapjoint.cli.options import Work

if TYPE_CHECKING:
    import xarray as xr

    from lapjoint.campaigns.job import Job


def found_or_stored(job: Job[Any, Any], holds: str, work: Work) -> xr.Dataset:
    """The dataset of a job: read from its file if the file is finished, else found, with progress.

    `holds` names the content of a finished file, for example "this sweep".
    """
    from lapjoint.campaigns.running import run_job, stored

    there = None if work.out is None else stored(job.spec, work.out, force=work.force)
    if there is not None:
        echo(f"{work.out}: holds {holds} already, finished")
        return there
    found = run_job(job, progress=True, **work._asdict())
    if work.out is not None:
        echo(f"Wrote {work.out}")
    return found
