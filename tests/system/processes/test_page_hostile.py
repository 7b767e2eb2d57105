"""Strangers and sluggards at the page's limits: the session goes on, and each of them is counted.

A thousand strangers come in a second, ten thousand in ten with `--full`.
"""

from __future__ import annotations

import asyncio
import contextlib
import gc
import os
import resource
import socket
import sys
import time
from collections import deque
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from typing import NamedTuple
from urllib.parse import urlsplit

import pytest
from websockets.exceptions import InvalidStatus

from sandbox.server.access import (
    MOST_AUTHENTICATED,
    MOST_UNAUTHENTICATED,
    ConnectionLimits,
    Counters,
)
from sandbox.server.clients import MOST_WAITING, Client
from sandbox.server.page_server import PageServer
from sandbox.server.protocol import CREDIT
from sandbox.trial.driver import LiveRun, Trial
from tests.sandbox.server.test_page_server import Stage, opened, wait_for
from tests.support.page_client import Page
from tests.support.processes import PATIENCE

STAYING = 800
"""Strangers that are there at once as far as they decide."""
WARM = 400
MEGABYTE = 2**20

needs_proc = pytest.mark.skipif(sys.platform != "linux", reason="reads /proc")


@pytest.fixture
def stage() -> Iterator[Stage]:
    server = PageServer()
    yield opened(server)
    server.close()


@pytest.fixture
def live(stage: Stage) -> Iterator[LiveRun]:
    """The stage's session, running in real time."""
    # It must outlast the test, whatever the time limit of its task.
    scorer = stage.session.scorer
    scorer.update = lambda *_: scorer.score  # type: ignore[method-assign]
    live = LiveRun(Trial(stage.session, [stage.server.publish]))
    live.start()
    yield live
    live.stop()


def words(url: str) -> list[bytes]:
    """What strangers say: nothing, half a request, garbage, no token, and a foreign page's."""
    parts = urlsplit(url)
    start = f"GET / HTTP/1.1\r\nHost: {parts.netloc}\r\n"
    foreign = (
        f"GET {parts.path}?{parts.query} HTTP/1.1\r\nHost: {parts.netloc}\r\n"
        "Upgrade: websocket\r\nConnection: Upgrade\r\nOrigin: http://evil.example\r\n"
        "Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: AAAAAAAAAAAAAAAAAAAAAA==\r\n\r\n"
    )
    return [
        b"",
        start.encode(),
        b"\x00\xff" * 32 + b"\r\n\r\n",
        f"{start}\r\n".encode(),
        foreign.encode(),
    ]


def storm(url: str, count: int) -> float:
    """So many strangers, one a millisecond, each of whom stays for a while; s that it took."""
    parts = urlsplit(url)
    said = words(url)
    links: deque[socket.socket] = deque()
    start = time.monotonic()
    for n in range(count):
        time.sleep(max(0.0, start + 0.001 * n - time.monotonic()))
        link = socket.create_connection((parts.hostname, parts.port), timeout=PATIENCE)
        links.append(link)
        # Whoever is turned away in the middle of a sentence is turned away all the same.
        with contextlib.suppress(OSError):
            link.sendall(said[n % len(said)])
        if len(links) > STAYING:
            links.popleft().close()
    took = time.monotonic() - start
    for link in links:
        link.close()
    return took


def memory() -> int:
    """Bytes in memory."""
    gc.collect()
    with open("/proc/self/statm") as text:
        return int(text.read().split()[1]) * resource.getpagesize()


def handles() -> int:
    return len(os.listdir("/proc/self/fd"))


class Weathered(NamedTuple):
    """What a storm left behind: strangers counted, touches answered, steps, and what it took."""

    counted: int
    answered: int
    steps: int
    handles: int
    memory: int


def weathered(stage: Stage, live: LiveRun, count: int) -> Weathered:
    """A page plays while so many strangers come."""
    url, counters = stage.server.url, stage.server.counters

    def counted() -> int:
        # The test itself may be too slow to say anything for a second with its finger down.
        return sum(n for what, n in counters.as_dict().items() if what != "silent page")

    with Page(url) as page, ProcessPoolExecutor(1, get_context("spawn")) as others:
        page.until("scene")
        # Whatever is made once is there before memory is looked at.
        others.submit(storm, url, WARM).result()
        assert wait_for(lambda: counted() == WARM), counters.as_dict()
        before, handles_before, step = memory(), handles(), stage.session.step
        attack = others.submit(storm, url, count)
        answered = most = 0
        while not attack.done():
            seq = page.touch((1, 2.0 + 0.001 * (answered % 50), 2.0))
            while page.until("frame")["touch"] < seq:
                pass
            answered += 1
            most = max(most, handles())
        print(f"{count} in {attack.result():.1f} s, {answered} touches answered meanwhile")
        assert wait_for(lambda: counted() >= WARM + count), counters.as_dict()
        return Weathered(
            counted() - WARM,
            answered,
            stage.session.step - step,
            most - handles_before,
            memory() - before,
        )


@needs_proc
@pytest.mark.parametrize("count", [1_000, pytest.param(10_000, marks=pytest.mark.full)])
def test_a_thousand_strangers_a_second_are_counted_and_the_session_goes_on(
    stage: Stage, live: LiveRun, count: int
) -> None:
    left = weathered(stage, live, count)
    assert left.counted == count, "each of them once"
    assert left.answered > count / 200, "the player's touches are answered all the while"
    assert left.steps > 0
    # The system hands over a hundred at once, and who is sent away goes a moment later.
    assert left.handles <= MOST_UNAUTHENTICATED + 300
    assert left.memory < 24 * MEGABYTE
    assert not live.over
    with Page(stage.server.url, "late", role="spectator") as late:
        assert late.until("frame")


def asks_and_never_listens(url: str) -> socket.socket:
    """Somebody with the token who fetches the page's largest file and never reads it."""
    parts = urlsplit(url)
    link = socket.create_connection((parts.hostname, parts.port), timeout=PATIENCE)
    link.sendall(f"GET /app.js?{parts.query} HTTP/1.1\r\nHost: {parts.netloc}\r\n\r\n".encode())
    return link


def test_pages_that_do_not_read_cost_the_others_nothing(stage: Stage, live: LiveRun) -> None:
    """They say hello, take no frame, and ask for echoes that they do not read."""
    sluggards = [Page(stage.server.url, f"slow {n}", role="spectator") for n in range(4)]
    with Page(stage.server.url, "quick") as page:
        page.until("scene")
        for k in range(60):
            for sluggard in sluggards:
                sluggard.say(type="beat", t=float(k))
            seq = page.touch((1, 2.0 + 0.001 * k, 2.0))
            while page.until("frame")["touch"] < seq:
                pass
        assert stage.server.clients == 5
    for sluggard in sluggards:
        sluggard.socket.socket.shutdown(socket.SHUT_RDWR)
        sluggard.close()
    assert wait_for(lambda: stage.server.clients == 0)


class Wire:
    """As much of a connection as a client needs: it takes everything at once."""

    def __init__(self) -> None:
        self.aborted = 0
        self.sent: list[bytes] = []
        self.transport = self

    async def send(self, message: bytes, text: bool) -> None:
        self.sent.append(bytes(message))

    def abort(self) -> None:
        self.aborted += 1


async def written(client: Client) -> None:
    """Lets the client's sender send whatever it may send now."""
    with contextlib.suppress(TimeoutError):
        await asyncio.wait_for(client.write(), 0.01)


def test_what_waits_for_a_page_that_does_not_read_is_bounded() -> None:
    counters, wire = Counters(), Wire()
    client = Client(wire, counters, time.monotonic)  # type: ignore[arg-type]
    for _ in range(3 * MOST_WAITING):
        client.send(b"echo")
    assert len(client._waiting) == MOST_WAITING
    assert wire.aborted == 1
    assert counters.as_dict() == {"page that does not read": 1}


def test_frames_that_were_never_sent_cannot_be_acknowledged() -> None:
    wire = Wire()
    client = Client(wire, Counters(), time.monotonic)  # type: ignore[arg-type]

    async def offer() -> None:
        for _ in range(3 * CREDIT):
            client.offer(bytearray(64))
            await written(client)
            assert [client.got(number) for number in (-1, 0, CREDIT + 1, 10**9)] == [None] * 4

    asyncio.run(offer())
    assert len(wire.sent) == client.stale == CREDIT


def test_of_frames_that_wait_a_page_gets_the_newest() -> None:
    wire = Wire()
    client = Client(wire, Counters(), time.monotonic)  # type: ignore[arg-type]
    for k in range(5):
        client.offer(bytearray([0] * 15 + [k]))
    asyncio.run(written(client))
    assert [frame[-1] for frame in wire.sent] == [4]


def test_a_skin_that_a_page_has_is_not_sent_again() -> None:
    wire = Wire()
    client = Client(wire, Counters(), time.monotonic)  # type: ignore[arg-type]
    for skins in ([b"right"], [b"right", b"left"], [b"right", b"left"], [b"", b"left"], [b"right"]):
        client.send_skins(skins)
    asyncio.run(written(client))
    assert wire.sent == [b"right", b"left", b"right"]


def test_files_that_are_fetched_and_not_read_take_no_more_than_their_place(
    stage: Stage, live: LiveRun
) -> None:
    links = [asks_and_never_listens(stage.server.url) for _ in range(4 * MOST_AUTHENTICATED)]
    assert wait_for(lambda: stage.server.counters["too many clients"] > 0)
    for link in links:
        link.close()
    # The server hears of it in its own time.
    assert wait_for(lambda: is_let_in(stage.server.url))


def is_let_in(url: str) -> bool:
    try:
        with Page(url) as page:
            page.until("frame")
    except InvalidStatus:
        return False
    return True


class Visitor:
    """As much of a connection as the limits need; it has not asked for anything yet."""

    request = None

    def __init__(self) -> None:
        self.aborted = False
        self.transport = self

    def abort(self) -> None:
        self.aborted = True


def test_who_was_pushed_out_before_the_token_was_read_is_not_let_in_and_takes_no_place() -> None:
    """The request may be in already, and be read when its connection is gone."""
    limits = ConnectionLimits(Counters())
    first, *others = visitors = [Visitor() for _ in range(MOST_UNAUTHENTICATED + 1)]
    for visitor in visitors:
        limits.add(visitor)  # type: ignore[arg-type]
    assert [v.aborted for v in visitors] == [True] + [False] * MOST_UNAUTHENTICATED
    limits.remove(first)  # type: ignore[arg-type]
    assert not limits.authenticate(first)  # type: ignore[arg-type]
    assert [limits.authenticate(v) for v in others] == [True] * MOST_AUTHENTICATED + [False] * (  # type: ignore
        MOST_UNAUTHENTICATED - MOST_AUTHENTICATED
    )
    for visitor in others:
        limits.remove(visitor)  # type: ignore[arg-type]
    assert len(limits) == 0
