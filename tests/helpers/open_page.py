"""Components in a real browser: a server in this process, and a page in which they can be played with."""

from __future__ import annotations

import asyncio
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from queue import Queue
from typing import Any

from browser import BROWSER
from playwright.sync_api import Locator, Page, sync_playwright

WIDE, NARROW = 1280, 390
"""Widths of a screen, pixels."""


@contextmanager
def served(make: Callable[[], Any]) -> Iterator[str]:
    """The address at which a server in a thread of its own shows what `make` gives to each page."""
    import panel as pn

    pn.extension(inline=True)
    running: Queue[Any] = Queue()

    def run() -> None:
        asyncio.set_event_loop(loop := asyncio.new_event_loop())
        server = pn.serve({"page": make}, address="127.0.0.1", port=0, show=False, start=False, verbose=False)
        server.start()
        running.put(server)
        server.io_loop.start()
        loop.close()

    thread = threading.Thread(target=run)
    thread.start()
    server = running.get(timeout=60)

    async def end() -> None:
        while any(session.connection_count for session in server.get_sessions()):  # a socket of a browser that closes
            await asyncio.sleep(0.01)
        server.stop()
        await server._http.close_all_connections()
        server.io_loop.stop()

    try:
        yield f"http://127.0.0.1:{server.port}/page"
    finally:
        server.io_loop.add_callback(end)
        thread.join(60)


@contextmanager
def open_page(make: Callable[[], Any], width: int = WIDE, **options: Any) -> Iterator[Page]:
    """A page with what `make` gives, whose scripts may not fail; `options` are those of the browser's context."""
    errors: list[str] = []
    with served(make) as address, sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=BROWSER)
        page = browser.new_context(viewport={"width": width, "height": 700}, **options).new_page()
        page.on("pageerror", lambda error: errors.append(str(error)))
        page.goto(address)
        yield page
        browser.close()
    assert not errors


def until(page: Page, true: Callable[[], Any], patience: float = 30.0) -> None:
    """Wait until something holds, and fail with it if it does not within `patience`, s."""
    end = time.monotonic() + patience
    while not true():
        assert time.monotonic() < end, page.locator("[role=status], [role=alert]").all_inner_texts()
        page.wait_for_timeout(50)


def centre(one: Locator) -> tuple[float, float]:
    """The middle of an element, pixels."""
    box = one.bounding_box()
    assert box is not None
    return box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
