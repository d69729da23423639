"""Who reaches the page of ``lapjoint explore``: this machine alone, with the address, from no other page."""

from __future__ import annotations

import asyncio
import base64
import re
import socket
import time
import urllib.error
import urllib.request
from collections.abc import Iterator
from pathlib import Path

import pytest
from explored import Explored, exploring
from tornado.httpclient import HTTPClientError, HTTPRequest
from tornado.websocket import websocket_connect

pytestmark = pytest.mark.thorough


@pytest.fixture(scope="module")
def server(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Explored]:
    with exploring(tmp_path_factory.mktemp("explore")) as one:
        yield one


def status(address: str) -> int:
    """What a server answers to a request."""
    try:
        with urllib.request.urlopen(address, timeout=60) as answer:
            return int(answer.status)
    except urllib.error.HTTPError as error:
        with error:
            return error.code


def handshake(address: str, token: str, origin: str) -> int:
    """What a server answers to who asks for messages about a page, from a page of some origin."""

    async def shake() -> int:
        request = HTTPRequest(f"ws{address.removeprefix('http')}/ws", headers={"Origin": origin})
        try:
            (await websocket_connect(request, subprotocols=["bokeh", token])).close()
        except HTTPClientError as error:
            return error.code
        return 101

    return asyncio.run(shake())


def test_the_address_has_128_random_bits_and_without_them_nothing_is_found(server: Explored) -> None:
    base, _, token = server.address.rpartition("/")
    assert len(base64.urlsafe_b64decode(token + "==")) == 16
    assert status(server.address) == 200
    last = "B" if token[0] == "A" else "A"
    for path in ("", "/", f"/{last}{token[1:]}", f"/{token[:-1]}", f"/{last}{token[1:]}/ws", "/autoload.js", "/ws"):
        assert status(base + path) == 404, path


def test_a_page_of_another_origin_gets_no_messages(server: Explored) -> None:
    with urllib.request.urlopen(server.address, timeout=60) as page:
        token = re.search(r'"token":"([^"]+)"', page.read().decode())
    assert token
    others = ("http://example.org", f"http://localhost:{server.port}", f"http://127.0.0.1:{server.port + 1}",
              f"http://127.0.0.1.example.org:{server.port}", "null")  # fmt: skip
    for origin in others:
        assert handshake(server.address, token[1], origin) == 403, origin
    assert handshake(server.address, token[1], f"http://127.0.0.1:{server.port}") == 101


def test_it_listens_on_the_loopback_address_alone(server: Explored) -> None:
    listens = "0A"
    for name in ("tcp", "tcp6"):
        for line in Path(f"/proc/net/{name}").read_text().splitlines()[1:]:
            _, local, _, state, *_ = line.split()
            if state == listens and int(local.rpartition(":")[2], 16) == server.port:
                assert (name, local.partition(":")[0]) == ("tcp", "0100007F")
    with pytest.raises(OSError):  # noqa: PT011  refused, or unreachable
        socket.create_connection(("127.0.0.2", server.port), timeout=5)


def test_a_page_that_is_only_fetched_starts_no_processes_and_ctrl_c_ends_all(server: Explored, tmp_path: Path) -> None:
    with exploring(tmp_path) as one:
        assert one.address.rpartition("/")[2] != server.address.rpartition("/")[2]
        before = one.pids
        assert status(one.address + "?state=damaged") == 200
        assert one.pids == before
    end = time.monotonic() + 30
    while any(Path(f"/proc/{pid}").exists() for pid in before):
        assert time.monotonic() < end
        time.sleep(0.1)
