"""The server of the page: on the loopback address alone, behind a random word in the address."""

from __future__ import annotations

import logging
import secrets
import threading
import warnings
import webbrowser
from typing import Any

import panel as pn
from panel.io.resources import get_dist_path

from explore.computing import Computing
from explore.page import Page, here, question_in
from explore.question import Question

ADDRESS = "127.0.0.1"
"""The loopback address: no other machine reaches it."""
MOST_PAGES = 4
"""Most pages that are open at once: each has processes of its own."""
QUIET = ("bokeh.server.views.ws", "bokeh.server.util", "tornado.access", "asyncio")
"""Loggers that say, with tracebacks, that a page was closed while an answer was on its way, or that a request was
refused; a fault of the page itself is logged by others."""
_UNUSED = 3000
"""Time after which a page that was closed is given up, ms; a page that is loaded again is a new one."""


class Processes:
    """The processes of the pages: those of a page that was closed wait for the next one."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._idle = [Computing(None)]
        self._busy: list[Computing] = []

    def take(self) -> Computing | None:
        """Processes for a page; None if too many pages are open."""
        with self._lock:
            if len(self._busy) >= MOST_PAGES:
                return None
            computing = self._idle.pop() if self._idle else Computing(None)
            self._busy.append(computing)
            return computing

    def give_back(self, computing: Computing) -> None:
        """Take the processes of a page that was closed: one set is kept, others end."""
        with self._lock:
            self._busy.remove(computing)
            computing.rest()
            if not self._idle:
                self._idle.append(computing)
                return
        computing.close()

    def close(self) -> None:
        """End all processes."""
        for computing in (*self._idle, *self._busy):
            computing.close()


def serve(question: Question, port: int = 0, *, browse: bool = True, say: Any = print) -> None:
    """Serve the page until Ctrl-C.

    Parameters
    ----------
    question : Question
        What a page asks that is opened without a state in its address.
    port : int
        The port; 0 for a free one.
    browse : bool
        Whether to open the page in a browser.
    say : callable
        Called with the address.
    """
    for name in QUIET:
        logging.getLogger(name).setLevel(logging.CRITICAL)
    warnings.filterwarnings("ignore", "reference already known")  # a click on a button that is gone meanwhile
    pn.extension(inline=True)
    token, processes = secrets.token_urlsafe(16), Processes()

    def opened() -> Any:
        here().template_variables["dist_url"] = get_dist_path(cdn=False)  # Panel sets it too late for a slow browser
        search = "" if pn.state.location is None else pn.state.location.search
        page = Page(question_in(search, question))

        def begin() -> None:  # a page that is only fetched gets no processes
            computing = processes.take()
            if computing is None:
                page.refuse(f"{MOST_PAGES} pages are open; close one of them, and load this one again")
                return
            here().on_session_destroyed(lambda _: processes.give_back(computing))
            page.begin(computing)

        pn.state.onload(begin)
        return page.view()

    try:
        port = port or _free_port()
        server = pn.serve(
            {token: opened},
            address=ADDRESS,
            port=port,
            websocket_origin=[f"{ADDRESS}:{port}"],
            show=False,
            start=False,
            verbose=False,
            title="lapjoint explore",
            use_index=False,
            redirect_root=False,
            unused_session_lifetime_milliseconds=_UNUSED,
            check_unused_sessions_milliseconds=_UNUSED // 3,
        )
        address = f"http://{ADDRESS}:{port}/{token}"
        say(address)
        if browse:
            webbrowser.open(address)
        server.run_until_shutdown()
    except KeyboardInterrupt:
        pass
    finally:
        processes.close()


def _free_port() -> int:
    import socket

    with socket.socket() as one:
        one.bind((ADDRESS, 0))
        return int(one.getsockname()[1])
