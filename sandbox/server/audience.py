"""The connected pages of a session, a player and spectators: roles, messages and frames.

Everything runs in the server's thread unless stated otherwise.
"""

from __future__ import annotations

import asyncio
import functools
import queue
import threading
import time
from collections.abc import Sequence
from typing import TypeVar

from websockets.exceptions import ConnectionClosed

from models.errors import InputError
from sandbox.server.connections.client import Client
from sandbox.server.connections.counters import Counters
from sandbox.server.connections.page_connection import PageConnection
from sandbox.server.page_device import PageDevice
from sandbox.server.protocol.protocol import (
    CREDIT,
    PROTOCOL,
    Beat,
    Drawn,
    Echo,
    Got,
    Hello,
    ItemAnswer,
    Leave,
    PageHands,
    PageScreen,
    PageTouches,
    PlayerRequest,
    Presence,
    Resized,
    SceneMessage,
    Sheet,
    StudyView,
    TaskName,
    Up,
    Welcome,
    encode,
)
from sandbox.trial.latency import LatencyLog

MOST_CLIENTS = 8
SILENCE = 1.0
"""s without a message after which a page's touches are cancelled; a page with a finger down sends
ten messages a second."""
QUIET = 1.5
"""s without a message after which a page without a finger counts as away; it sends two messages a
second."""
SEAT_KEPT = 60.0
"""s for which the seat of a player who is away is kept against other pages."""
Heard = TypeVar("Heard")
MOST_QUEUED = 256
"""Number of requests, or of answers to questions, that wait to be read; more than a person gives
before somebody reads them."""
GREETING = 5.0
"""s within which a page has to send its hello message."""

WRONG_VERSION, TOO_MANY, REPLACED, NONSENSE = 4001, 4002, 4003, 4004
"""Close codes, which the page explains to the person."""


class Audience:
    """The connected pages of a session.

    Args:
        tasks: Tasks that the page offers.
        version: Version of the program.
        counters: Counters of refusals.
        latency: Log of the latency of touches.
        study: Study that the page belongs to; None outside a study.
        touch: True if the player's fingers are used.

    Attributes:
        joined: Event that is set once a player has connected.
        seated: Number of times that another page became the player's.
        asked: Queue of the player's requests; read by another thread.
        filled: Queue of the player's inputs to a study's sheets; read by another thread.
        screen: Size of the player's screen; None before a player connected.
        language: Language of the player's page; empty before a player connected.
    """

    def __init__(
        self,
        tasks: Sequence[TaskName],
        version: str,
        counters: Counters,
        latency: LatencyLog,
        study: StudyView | None = None,
        touch: bool = True,
    ) -> None:
        self._touch, self.seated = touch, 0
        self._tasks, self._version = list(tasks), version
        self._counters, self._latency = counters, latency
        self._clients: list[Client] = []
        self._last_player = ""
        self._scene: SceneMessage | None = None
        self._device: PageDevice | None = None
        self._frame: bytearray | None = None
        self._skins: Sequence[bytes] = ()
        self._study = study
        self._sheet: Sheet | None = None
        self._trouble: bytes | None = None
        self._heard = float("-inf")
        self._left = float("-inf")
        self.joined = threading.Event()
        self.asked: queue.SimpleQueue[PlayerRequest] = queue.SimpleQueue()
        self.filled: queue.SimpleQueue[ItemAnswer | Leave] = queue.SimpleQueue()
        self.screen: PageScreen | None = None
        self.language = ""

    def __len__(self) -> int:
        return len(self._clients)

    def open_scene(
        self, scene: SceneMessage, device: PageDevice | None, skins: Sequence[bytes] = ()
    ) -> None:
        """Begins a new trial: sends its scene to all pages.

        Args:
            scene: Message of the scene.
            device: Device for the player's touches; None if they are not used.
            skins: Skins of the hands.
        """
        self._scene, self._device, self._frame, self._skins = scene, device, None, skins
        self._trouble = None
        for client in self._clients:
            client.offer(None)
            if client.hello:
                client.say(encode(scene))
                client.dress(skins)

    def show_problem(self, text: bytes) -> None:
        """Sends a problem that prevents a scene to all pages, and to those that connect later."""
        self._trouble, self._frame = text, None
        for client in self._clients:
            if client.hello:
                client.say(text)

    @property
    def silence(self) -> float:
        """s since a player was last there; infinite before the first. From any thread."""
        seen = [c.seen for c in tuple(self._clients) if c.player]
        return time.monotonic() - max(seen, default=self._heard)

    @property
    def away(self) -> bool:
        """True if no player's page can be played: closed, hidden or silent. From any thread."""
        device = self._device
        limit = SILENCE if device and device.touched else QUIET
        players = [c for c in tuple(self._clients) if c.player]
        return not any(c.here and time.monotonic() - c.heard <= limit for c in players)

    def show_sheet(self, sheet: Sheet, tell: bool) -> None:
        """Stores the sheet for a page that reconnects, and sends it to the player if `tell`."""
        self._sheet = sheet
        if tell:
            self.say_to_player(encode(sheet))

    def say_to_player(self, text: bytes) -> None:
        """Sends a message to the player alone; viewers do not get it."""
        for client in self._clients:
            if client.player:
                client.say(text)

    def show(self, frame: bytearray) -> None:
        """Sends the newest frame to all pages."""
        self._frame = frame
        for client in self._clients:
            if client.hello:
                client.offer(frame)

    async def handle(self, connection: PageConnection) -> None:
        """Handles the connection of a page from its first message to its end."""
        client = Client(connection, self._counters, time.monotonic)
        self._clients.append(client)
        writing = asyncio.create_task(client.write())
        try:
            async with asyncio.timeout(GREETING):
                first = client.read(await connection.recv())
            if not isinstance(first, Hello):
                self._counters.add("no hello")
                await connection.close(NONSENSE, "a page must send hello first")
                return
            if first.protocol != PROTOCOL:
                self._counters.add("wrong version")
                await connection.close(WRONG_VERSION, f"this server uses version {PROTOCOL}")
                return
            if not self._has_room(first):
                self._counters.add("too many clients")
                await connection.close(TOO_MANY, "too many pages are open")
                return
            self._greet(client, first)
            connection.hear = functools.partial(self._hear, client)
            async for message in connection:
                self._hear(client, message)
        except TimeoutError:
            self._counters.add("no hello")
        except ConnectionClosed:
            if not client.parted:
                self._counters.add("lost connection")
        finally:
            connection.hear = None
            writing.cancel()
            self._clients.remove(client)
            self._leave(client)

    def _hear(self, client: Client, message: str | bytes) -> None:
        """Processes a message of a page."""
        try:
            up = client.read(message)
        except InputError:
            client.part(NONSENSE, "too many messages were refused")
        else:
            if up is not None:
                self._take(client, up)
            elif client.missed and client.player and self._device and self._device.touched:
                # Where the fingers are now, or that they were lifted, was perhaps in that message.
                self._counters.add("missed touches")
                self._device.cancel_all()

    def _greet(self, client: Client, hello: Hello) -> None:
        client.hello, client.screen = hello, hello.screen
        same = hello.role == "player" and hello.client == self._last_player
        for other in [c for c in self._clients if c.player and same and c is not client]:
            # The same page has reconnected before the loss of its old socket was noticed.
            # Its end is not waited for: a dead socket takes a second to close.
            self._leave(other)
            other.part(REPLACED, "the page is open elsewhere")
        if hello.role == "player" and (player := self._player()) and self._trouble:
            # The player's screen is too small; the new page may have enough room.
            player.player = False
            self._welcome(player)
        if hello.role == "player" and self._player() is None and self._may_sit(hello):
            self._seat(client)
            self.joined.set()
        self._welcome(client)

    def _has_room(self, hello: Hello) -> bool:
        """True if a page may stay: one place is the player's, the others are for whoever comes."""
        others = [c for c in self._clients if c.hello and not c.player]
        mine = hello.role == "player" and self._may_sit(hello)
        return mine or len(others) < MOST_CLIENTS - 1

    def _may_sit(self, hello: Hello) -> bool:
        """True if the player's seat is the page's own, or nobody's."""
        return hello.client == self._last_player or (self._player() is None and self._seat_is_free)

    @property
    def _seat_is_free(self) -> bool:
        """True if the last player has been away for too long, or had no room to play."""
        kept = self._last_player and time.monotonic() - self._left <= SEAT_KEPT
        return not kept or self._trouble is not None

    def _player(self) -> Client | None:
        return next((c for c in self._clients if c.player), None)

    def _seat(self, client: Client) -> None:
        assert client.hello is not None
        other = client.hello.client != self._last_player
        client.player, self._last_player = True, client.hello.client
        if self._device:
            self._device.begin_page()
        self.screen, self.seated = client.screen, self.seated + other
        self.language = client.hello.language

    def _welcome(self, client: Client) -> None:
        role = "player" if client.player else "spectator"
        client.say(
            encode(
                Welcome(
                    PROTOCOL,
                    self._version,
                    role,  # type: ignore[arg-type]
                    self._tasks,
                    CREDIT,
                    self._study,
                    self._touch,
                )
            )
        )
        if client.player and self._sheet:
            client.say(encode(self._sheet))
        if self._scene:
            client.say(encode(self._scene))
            client.dress(self._skins)
            client.offer(self._frame)
        if self._trouble:
            client.say(self._trouble)

    def _leave(self, client: Client) -> None:
        if not client.player:
            return
        client.player = False
        if client.menu:
            # It is open no more. A page that comes back with it open says so again.
            client.menu = False
            self._keep(self.asked, PlayerRequest("resume"))
        self._heard = client.seen
        self._left = time.monotonic()
        if self._device:
            self._device.cancel_all()
        self._fill_seat(client)

    def _fill_seat(self, gone: Client | None = None) -> None:
        """Gives a seat that is free to the first other page that asked to be the player."""
        if self._player() is not None or not self._seat_is_free:
            return
        for other in self._clients:
            if other is not gone and other.hello and other.hello.role == "player":
                self._seat(other)
                self._welcome(other)
                return

    def _give_up_seat(self, now: float) -> None:
        """Takes the seat from a player who has been hidden for too long, if somebody waits."""
        player = self._player()
        if player is None or now - player.seen <= SEAT_KEPT:
            return
        waiting = [c for c in self._clients if c.hello and c.hello.role == "player"]
        if len(waiting) > 1:
            self._leave(player)
            self._left = float("-inf")
            self._fill_seat(player)
            self._welcome(player)

    def _take(self, client: Client, up: Up) -> None:
        """Acts on a valid message."""
        match up:
            case Got():
                after = client.got(up.frame)
                if after is not None:
                    self._latency.add("acknowledged", 1000.0 * after)
            case Beat():
                client.say(encode(Echo(up.t)))
                if up.round_trip_ms is not None:
                    self._latency.add("round_trip", up.round_trip_ms)
            case Resized():
                client.screen = up.screen
                if client.player:
                    self.screen = up.screen
            case Presence():
                client.appear(up.here)
            case PageTouches() | PageHands() if client.player and client.screen:
                if self._device and not self._device.hear(up, client.screen):
                    self._counters.add("another device's message")
            case Drawn() if client.player:
                self._latency.add("drawn", up.after_ms)
            case PlayerRequest() if client.player and not self._study:
                if up.what in ("pause", "resume"):
                    client.menu = up.what == "pause"
                self._keep(self.asked, up)
            case ItemAnswer() | Leave() if client.player and self._study:
                self._keep(self.filled, up)
            case Hello():
                self._counters.add("second hello")
            case _:
                self._counters.add("not the player")

    def _keep(self, waiting: queue.SimpleQueue[Heard], up: Heard) -> None:
        """Queues what another thread reads, which may not be reading now."""
        if waiting.qsize() < MOST_QUEUED:
            waiting.put(up)
        else:
            self._counters.add("input that nobody waits for")

    async def watch(self) -> None:
        """Cancels the touches of a silent page, and ends the keeping of seats; runs until it is
        cancelled."""
        while True:
            await asyncio.sleep(0.1)
            self._give_up_seat(time.monotonic())
            self._fill_seat()
            device = self._device
            for client in self._clients:
                silent = time.monotonic() - client.heard > SILENCE
                if client.player and silent and device and device.touched:
                    self._counters.add("silent page")
                    device.cancel_all()
