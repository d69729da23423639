"""What several tests need: a history that is written down, a machine that can draw, one thread, and a Ctrl-C
that works.
"""

from __future__ import annotations

import gc
import math
import os
import signal
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
import scipy.linalg  # noqa: F401  its own library for linear algebra is loaded before `one_thread` looks for some
from compile_first import SHARES
from threadpoolctl import threadpool_limits
from written_history import AMPLITUDE, GAP, OMEGA, STIFFNESS, swinging

from lapjoint import FREE, Beam, ContactState, History, Problem, Stop
from lapjoint.answers import Contact


def pytest_sessionstart() -> None:
    """Two workers that begin at the same time do not compile the same functions."""
    share = SHARES.get(os.environ.get("PYTEST_XDIST_WORKER", ""))
    if share is not None:
        share()


@pytest.hookimpl(tryfirst=True)
def pytest_cmdline_main(config: pytest.Config) -> None:
    """Workers take tests in their order, and one that has none left takes some of the other's: most modules stay whole,
    so that their fixtures are made once, and no worker waits for a long test at the end."""
    if config.getoption("numprocesses", None) and config.option.dist == "no":
        config.option.dist = "worksteal"


def pytest_collection_finish() -> None:
    """What is loaded and collected stays until the end; searches for cyclic garbage leave it out."""
    gc.freeze()


@pytest.fixture(scope="session", autouse=True)
def one_thread() -> Iterator[None]:
    """Linear algebra takes one thread: several processes with several threads each wait for one another."""
    with threadpool_limits(1, user_api="blas"):
        yield


@pytest.fixture(scope="session", autouse=True)
def ctrl_c() -> Iterator[None]:
    """Ctrl-C works: a shell without job control starts what runs in the background so that it is ignored."""
    if signal.getsignal(signal.SIGINT) is not signal.SIG_IGN:
        yield
        return
    signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, signal.SIG_IGN)


@pytest.fixture(scope="session")
def compiled() -> None:
    """The analytic march is compiled, and kept for other processes: each would compile it anew for itself."""
    import analytic
    from lapjoint import sdnl104

    analytic.Solver(n_modes=2).simulate(sdnl104(), 1e-4, errors=False)


@pytest.fixture
def history() -> History:
    """One second of a tip that swings between two stops, its contacts and their impulses in closed form."""
    problem = Problem(
        title="Written down",
        beam=Beam(length=1.0, bending_stiffness=2.0, mass_per_length=1.0),
        stops=(
            Stop(name="above", x=1.0, side="top", gap=GAP, stiffness=STIFFNESS),
            Stop(name="below", x=1.0, side="bottom", gap=GAP, stiffness=STIFFNESS),
        ),
    )
    a = math.asin(GAP / AMPLITUDE) / OMEGA
    b = 0.5 - a
    impulse = STIFFNESS * (2 * AMPLITUDE * math.cos(OMEGA * a) / OMEGA - GAP * (b - a))
    peak = STIFFNESS * (AMPLITUDE - GAP)
    return History(
        problem=problem,
        solver="written down",
        start=0.0,
        end=1.0,
        switch_times=np.array([a, b, 0.5 + a, 0.5 + b]),
        states=(FREE, ContactState((0,)), FREE, ContactState((1,)), FREE),
        contacts=(Contact(0, a, b, impulse, peak), Contact(1, 0.5 + a, 0.5 + b, -impulse, peak)),
        field=swinging,
    )


@pytest.fixture(scope="session")
def graphics(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A machine that can draw: a picture by it, of the paper's joint at rest."""
    import analytic
    from lapjoint import paper_joint
    from lapjoint.errors import OutputError
    from lapjoint.scene import Look, save_picture
    from lapjoint.scene.render_process import NO_GRAPHICS

    motion = analytic.Solver(n_modes=2).simulate(paper_joint(), 0.01, errors=False)
    picture = tmp_path_factory.mktemp("graphics") / "try.png"
    try:
        return save_picture(motion, picture, at=0.0, look=Look(size=(600, 300)))
    except OutputError as error:
        if str(error) != NO_GRAPHICS:
            raise
        pytest.skip(f"{error}")
