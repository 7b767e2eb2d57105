"""The connected pages of a session, a player and spectators: roles, messages and frames.

Every page has a credit of frames, a limit of messages, and an asyncio task that sends. Everything
runs in the server's thread unless stated otherwise.
"""

from __future__ import annotations

import asyncio
import contextlib
import math
import queue
import threading
import time
from collections import deque
from collections.abc import Callable, Sequence
from typing import TypeVar

from websockets.asyncio.server import ServerConnection
from websockets.exceptions import ConnectionClosed

from models.errors import InputError
from sandbox.server.access import Counters
from sandbox.server.page_frames import number_frame
from sandbox.server.protocol import (
    CREDIT,
    PROTOCOL,
    Allowance,
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
    Seat,
    Sheet,
    StudyView,
    TaskName,
    Up,
    Welcome,
    decode,
    encode,
)
from sandbox.server.server_thread import GREETING
from sandbox.server.web import PageDevice
from sandbox.trial.logs import LatencyLog

MESSAGES_PER_SECOND, BURST = 240.0, 1200.0
"""Limits of messages from a page. Touches at 120 Hz, acknowledgements at 60 Hz and heartbeats are
185 messages a second. While the network stalls, a page sends for 4 s before it closes its socket;
then all these messages may arrive at once."""
PATIENCE, FORGIVEN = 240.0, 1.0
"""The connection is closed after this number of refused messages. Their count decreases by
`FORGIVEN` a second."""
MOST_WAITING = 512
"""Largest number of messages that wait for a page that does not read, such as echoes of several
minutes. If there are more, the connection is aborted."""
MOST_CLIENTS = 8
SILENT_TOUCHED, SILENT = 1.0, 1.5
"""Times (s) without a message after which a page counts as away: with a finger down (it then sends
ten messages a second), and without (two messages a second)."""
SEAT_TIMEOUT, REQUESTED_SEAT_TIMEOUT = 60.0, 10.0
"""Times (s) after which a player who is away loses the seat to a waiting page: without and with a
request for the seat."""
Queued = TypeVar("Queued")
MOST_QUEUED = 256
"""Largest number of requests, or of answers to questions, that wait to be read. A person sends
fewer before they are read."""

WRONG_VERSION, TOO_MANY, REPLACED, NONSENSE, GOODBYE = 4001, 4002, 4003, 4004, 4005
"""Close codes, which the page explains to the person. GOODBYE: the program has ended."""


class Client:
    """A connected page, its message credit and its position in the stream of frames.

    Args:
        connection: The open connection.
        counters: Counters of refusals.
        clock: Monotonic clock, s.

    Attributes:
        hello: The page's hello message; None before it arrives.
        screen: Current size of the page's screen.
        player: True if the page's touches are used.
        last_message: Time of the page's last message, s.
        visible: False while the page reports that it is hidden or rotated (`Presence`).
        menu: True while the player has a menu open.
        missed: True if the last message was refused unread, because there were too many.
        silenced: True if touches were cancelled because the page became silent with a finger down.
        requests_seat: True if the page waits and has requested the player's seat.
    """

    def __init__(
        self, connection: ServerConnection, counters: Counters, clock: Callable[[], float]
    ) -> None:
        self.connection = connection
        self.hello: Hello | None = None
        self.screen: PageScreen | None = None
        self.player = False
        self.last_message = clock()
        self.visible, self.missed, self.menu, self.silenced = True, False, False, False
        self.requests_seat = False
        self._seat: Seat | None = None
        self._hidden = self.last_message
        self._clock = clock
        self._counters = counters
        self._allowance = Allowance(MESSAGES_PER_SECOND, BURST, self.last_message)
        self._patience = Allowance(FORGIVEN, PATIENCE, self.last_message)
        self._waiting: deque[tuple[bytes, bool]] = deque()
        self._skins: tuple[bytes, ...] = ()
        self._newest: bytearray | None = None
        self._aborted = False
        self._sent = self._acknowledged = 0
        self._due = asyncio.Event()
        self._parting: asyncio.Task[None] | None = None
        self.sent_at: dict[int, float] = {}

    @property
    def stale(self) -> int:
        """Number of sent frames that are not acknowledged."""
        return self._sent - self._acknowledged

    @property
    def seen(self) -> float:
        """Time (s) at which the page's person was last able to play."""
        return self.last_message if self.visible else self._hidden

    def set_visible(self, visible: bool) -> None:
        """Stores whether the page can be played now."""
        if self.visible and not visible:
            self._hidden = self._clock()
        self.visible = visible

    def send(self, message: bytes, text: bool = True) -> None:
        """Queues a message, JSON text or bytes. Messages are sent in order, before later frames."""
        if len(self._waiting) < MOST_WAITING:
            self._waiting.append((message, text))
            self._due.set()
        elif not self._aborted:
            self._aborted = True
            self._counters.add("page that does not read")
            self.connection.transport.abort()

    def send_skins(self, skins: Sequence[bytes]) -> None:
        """Queues the skins of hands that the page does not have yet."""
        for skin in skins:
            if skin and skin not in self._skins:
                self.send(skin, text=False)
        self._skins = tuple(skins)

    def send_seat(self, seat: Seat) -> None:
        """Queues the permission to play, if it has changed."""
        if seat != self._seat:
            self._seat = seat
            self.send(encode(seat))

    def offer(self, frame: bytearray | None) -> None:
        """Queues the newest frame; it replaces an older frame that has not been sent."""
        self._newest = frame
        self._due.set()

    def got(self, number: int) -> float | None:
        """Returns the credit of a frame and of all frames before it.

        Returns:
            Time (s) since the frame was sent; None if the frame is unknown or was acknowledged
            before.
        """
        if not self._acknowledged < number <= self._sent:
            return None
        self._acknowledged = number
        at = self.sent_at.get(number)
        self.sent_at = {n: t for n, t in self.sent_at.items() if n > number}
        self._due.set()
        return None if at is None else self._clock() - at

    @property
    def closing(self) -> bool:
        """True once the server has begun to close the connection."""
        return self._parting is not None

    def close(self, code: int, reason: str) -> None:
        """Begins to close the connection; returns at once."""
        if self._parting is None:
            self._parting = asyncio.create_task(self.connection.close(code, reason))

    async def write(self) -> None:
        """Sends waiting messages until cancelled; a slow page delays no other page."""
        with contextlib.suppress(ConnectionClosed):
            while True:
                await self._due.wait()
                self._due.clear()
                while following := self._following():
                    message, text = following
                    await self.connection.send(message, text=text)

    def _following(self) -> tuple[bytes, bool] | None:
        """Returns the next message to send, and whether it is text; None if there is none now."""
        if self._waiting:
            return self._waiting.popleft()
        if self._newest is None or self.stale >= CREDIT:
            return None
        frame, self._newest = self._newest, None
        self._sent += 1
        self.sent_at[self._sent] = self._clock()
        return number_frame(frame, self._sent), False

    def read(self, message: str | bytes) -> Up | None:
        """Checks a message; returns None if it is refused.

        Raises:
            InputError: Too many messages were refused, so the sender is not a page of this program.
        """
        self.last_message, self.silenced = self._clock(), False
        reason, up = "", None
        self.missed = not self._allowance.take(self.last_message)
        if self.missed:
            reason = "too many messages"
        elif isinstance(message, bytes):
            reason = "binary message"
        else:
            try:
                up = decode(message)
            except InputError:
                reason = "malformed message"
        if reason:
            self._counters.add(reason)
            if not self._patience.take(self.last_message):
                raise InputError("the client sent too many invalid messages", got=reason)
        return up


class Clients:
    """The connected pages of a session.

    Args:
        tasks: Tasks that the page offers.
        version: Version of the program.
        counters: Counters of refusals.
        latency: Log of the latency of touches.
        study: Study that the page belongs to; None outside a study.
        touch: True if the player's touches are used.

    Attributes:
        joined: Event that is set once a player has connected.
        seated: Number of times that a new page became the player's page.
        requests: Queue of the player's requests; read by another thread.
        inputs: Queue of the player's inputs to a study's sheets; read by another thread.
        browser: User agent of the player's browser; empty before a player connected.
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
        self._demonstration = b""
        self._last_present = float("-inf")
        self._left = float("-inf")
        self.joined = threading.Event()
        self.requests: queue.SimpleQueue[PlayerRequest] = queue.SimpleQueue()
        self.inputs: queue.SimpleQueue[ItemAnswer | Leave] = queue.SimpleQueue()
        self.browser = ""
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
        self._trouble, self._demonstration = None, b""
        for client in self._clients:
            client.offer(None)
            if client.hello:
                client.send(encode(scene))
                client.send_skins(skins)

    def show_problem(self, text: bytes) -> None:
        """Sends a problem that prevents a scene to all pages, also to pages that connect later."""
        self._trouble, self._frame = text, None
        for client in self._clients:
            if client.hello:
                client.send(text)

    @property
    def silence(self) -> float:
        """Time (s) since a player was last present; infinite before the first. From any thread."""
        seen = [c.seen for c in tuple(self._clients) if c.player]
        return time.monotonic() - max(seen, default=self._last_present)

    @property
    def away(self) -> bool:
        """True if no player's page can be played: closed, hidden or silent. From any thread."""
        now = time.monotonic()
        return all(self._is_away(c, now) for c in tuple(self._clients) if c.player)

    def _is_away(self, client: Client, now: float) -> bool:
        """True if a page cannot be played: it is hidden, or silent for too long."""
        touched = client.silenced or (self._device is not None and self._device.touched)
        limit = SILENT_TOUCHED if touched else SILENT
        return not client.visible or now - client.last_message > limit

    def show_sheet(self, sheet: Sheet, tell: bool) -> None:
        """Stores the sheet for a page that reconnects; if `tell`, also sends it to the player."""
        self._sheet = sheet
        if tell:
            self.send_to_player(encode(sheet))

    def show_demonstration(self, message: bytes) -> None:
        """Sends the player a demonstration of the scene, also after a reconnection."""
        self._demonstration = message
        self.send_to_player(message, text=False)

    def send_to_player(self, message: bytes, text: bool = True) -> None:
        """Sends a message, JSON text or bytes, only to the player."""
        for client in self._clients:
            if client.player:
                client.send(message, text)

    def show(self, frame: bytearray) -> None:
        """Sends the newest frame to all pages."""
        self._frame = frame
        for client in self._clients:
            if client.hello:
                client.offer(frame)

    async def handle(self, connection: ServerConnection) -> None:
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
            async for message in connection:
                self._receive(client, message)
                # Let the sending task run, even if the page sends without a break.
                await asyncio.sleep(0)
        except TimeoutError:
            self._counters.add("no hello")
        except ConnectionClosed:
            if not client.closing:
                self._counters.add("lost connection")
        finally:
            writing.cancel()
            self._clients.remove(client)
            self._leave(client)

    def _receive(self, client: Client, message: str | bytes) -> None:
        """Processes a message of a page."""
        try:
            up = client.read(message)
        except InputError:
            client.close(NONSENSE, "too many messages were refused")
        else:
            if up is not None:
                self._take(client, up)
            elif client.missed and client.player and self._device and self._device.touched:
                # The refused message may have moved or lifted fingers.
                self._counters.add("missed touches")
                self._device.cancel_all()

    def _greet(self, client: Client, hello: Hello) -> None:
        client.hello, client.screen = hello, hello.screen
        same = hello.role == "player" and hello.client == self._last_player
        for other in [c for c in self._clients if c.player and same and c is not client]:
            # The same page has reconnected before the loss of its old socket was detected. Do not
            # wait for the end of the old socket, which takes a second.
            self._leave(other)
            other.close(REPLACED, "the page is open elsewhere")
        if hello.role == "player" and (player := self._player()) and self._trouble:
            # The player's screen is too small; the new page may have enough room.
            player.player = False
            self._welcome(player)
        if hello.role == "player" and self._player() is None and self._may_sit(hello):
            self._seat(client)
            self.joined.set()
        self._welcome(client)

    def _has_room(self, hello: Hello) -> bool:
        """True if a page may stay: one place is reserved for the player."""
        others = [c for c in self._clients if c.hello and not c.player]
        mine = hello.role == "player" and self._may_sit(hello)
        return mine or len(others) < MOST_CLIENTS - 1

    def _may_sit(self, hello: Hello) -> bool:
        """True if the player's seat belongs to the page, or is free."""
        return hello.client == self._last_player or (self._player() is None and self._seat_is_free)

    @property
    def _seat_is_free(self) -> bool:
        """True if the last player was away for too long, or had a screen too small for the task."""
        kept = self._last_player and time.monotonic() - self._left <= self._seat_timeout
        return not kept or self._trouble is not None

    @property
    def _seat_timeout(self) -> float:
        """Time (s) after which a player who is away loses the seat."""
        return (
            REQUESTED_SEAT_TIMEOUT if any(c.requests_seat for c in self._clients) else SEAT_TIMEOUT
        )

    def _player(self) -> Client | None:
        return next((c for c in self._clients if c.player), None)

    def _seat(self, client: Client) -> None:
        assert client.hello is not None
        other = client.hello.client != self._last_player
        client.player, self._last_player = True, client.hello.client
        client.requests_seat = False
        if self._device:
            self._device.begin_page()
        self.screen, self.seated = client.screen, self.seated + other
        self.language = client.hello.language
        request = client.connection.request
        self.browser = request.headers.get("User-Agent", "") if request else ""

    def _welcome(self, client: Client) -> None:
        role = "player" if client.player else "spectator"
        client.send(
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
            client.send(encode(self._sheet))
        if self._scene:
            client.send(encode(self._scene))
            client.send_skins(self._skins)
            client.offer(self._frame)
        if client.player and self._demonstration:
            client.send(self._demonstration, text=False)
        if self._trouble:
            client.send(self._trouble)

    def _leave(self, client: Client) -> None:
        if not client.player:
            return
        client.player = False
        if client.menu:
            # The pause of its menu ends. A page that reconnects with an open menu reports it again.
            client.menu = False
            self._keep(self.requests, PlayerRequest("resume"))
        self._last_present = client.seen
        self._left = time.monotonic()
        if self._device:
            self._device.cancel_all()
        self._fill_seat(client)

    def _fill_seat(self, gone: Client | None = None) -> None:
        """Gives a free seat to the first other page that requested it."""
        if self._player() is not None or not self._seat_is_free:
            return
        for other in self._clients:
            if other is not gone and other.hello and other.hello.role == "player":
                self._seat(other)
                self._welcome(other)
                return

    def _give_up_seat(self, now: float) -> None:
        """Takes the seat from a player who has been away for too long, if another page waits."""
        player = self._player()
        if player is None or now - player.seen <= self._seat_timeout:
            return
        if self._waiting():
            self._leave(player)
            self._left = float("-inf")
            self._fill_seat(player)
            self._welcome(player)

    def _waiting(self) -> list[Client]:
        """Pages that wait to play."""
        return [c for c in self._clients if c.hello and c.hello.role == "player" and not c.player]

    def _send_seats(self, now: float) -> None:
        """Sends changes of the waiting time to waiting pages, and of requests to the player."""
        player = self._player()
        absent = now - (player.seen if player else self._left)
        there = player is not None and not self._is_away(player, now)
        wait = None if there else math.ceil(max(self._seat_timeout - absent, 0.0))
        for client in self._waiting():
            client.send_seat(Seat(wait))
        if player is not None:
            player.send_seat(Seat(requested=any(c.requests_seat for c in self._waiting())))

    def _take(self, client: Client, up: Up) -> None:
        """Acts on a valid message."""
        match up:
            case Got():
                after = client.got(up.frame)
                if after is not None:
                    self._latency.add("acknowledged", 1000.0 * after)
            case Beat():
                client.send(encode(Echo(up.t)))
                if up.round_trip_ms is not None:
                    self._latency.add("round_trip", up.round_trip_ms)
            case Resized():
                client.screen = up.screen
                if client.player:
                    self.screen = up.screen
            case Presence():
                client.set_visible(up.here)
            case PageTouches() | PageHands() if client.player and client.screen:
                if self._device and not self._device.receive(up, client.screen):
                    self._counters.add("another device's message")
            case Drawn() if client.player:
                self._latency.add("drawn", up.after_ms)
            case PlayerRequest(what="seat") if client in self._waiting() and not self._study:
                client.requests_seat = True
            case PlayerRequest() if client.player and up.what != "seat" and not self._study:
                if up.what in ("pause", "resume"):
                    client.menu = up.what == "pause"
                self._keep(self.requests, up)
            case ItemAnswer() | Leave() if client.player and self._study:
                self._keep(self.inputs, up)
            case Hello():
                self._counters.add("second hello")
            case _:
                self._counters.add("not the player")

    def _keep(self, waiting: queue.SimpleQueue[Queued], up: Queued) -> None:
        """Queues an item for another thread, which may not be reading now."""
        if waiting.qsize() < MOST_QUEUED:
            waiting.put(up)
        else:
            self._counters.add("input to a full queue")

    async def part(self) -> None:
        """Announces the end to all pages, so that they do not take it for a lost connection."""
        for client in self._clients:
            client.close(GOODBYE, "the session has ended")
        # Let the closing handshakes begin.
        await asyncio.sleep(0)

    async def watch(self) -> None:
        """Cancels the touches of silent pages and gives free seats to waiting pages.

        Runs until it is cancelled.
        """
        while True:
            await asyncio.sleep(0.1)
            self._give_up_seat(time.monotonic())
            self._fill_seat()
            device, now = self._device, time.monotonic()
            if not self._study:
                self._send_seats(now)
            for client in self._clients:
                silent = now - client.last_message > SILENT_TOUCHED
                if client.player and silent and device and device.touched:
                    self._counters.add("silent page")
                    client.silenced = True
                    device.cancel_all()
