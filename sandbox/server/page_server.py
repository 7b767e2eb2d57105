"""The server of the page: one thread with its own event loop, which no session ever waits for."""

from __future__ import annotations

import asyncio
import contextlib
import logging
import queue
import ssl
import threading
import time
from collections.abc import Sequence
from dataclasses import dataclass
from http import HTTPStatus
from urllib.parse import urlsplit

from websockets.asyncio.server import ServerConnection, serve
from websockets.exceptions import ConnectionClosed
from websockets.http11 import Request, Response

from models.errors import DeviceError, InputError
from models.scene import Scene as SimulatedScene
from sandbox.devices.web import WebDevice
from sandbox.messages import Snapshot
from sandbox.server.access import Access
from sandbox.server.client import Client
from sandbox.server.counters import Counters
from sandbox.server.describe import BodyPoses, state_of
from sandbox.server.frames import pack
from sandbox.server.latency import LatencyLog
from sandbox.server.protocol import (
    CREDIT,
    LARGEST_MESSAGE,
    PROTOCOL,
    Ask,
    Beat,
    Drawn,
    Echo,
    Got,
    Hello,
    Resized,
    Scene,
    Screen,
    TaskName,
    Touches,
    Trouble,
    Up,
    Welcome,
    encode,
)
from sandbox.server.static import StaticFiles, plain

MOST_CLIENTS = 8
SILENCE = 1.0
"""s without a word after which a page's fingers are taken for gone; a page with a finger down says
something ten times a second."""
GREETING = 5.0
"""s within which a page has to say hello."""

WRONG_VERSION, TOO_MANY, REPLACED, NONSENSE = 4001, 4002, 4003, 4004
"""Close codes that the page has words for."""


@dataclass(frozen=True)
class _Shown:
    """What is served now."""

    message: Scene
    device: WebDevice | None
    poses: BodyPoses


class PageServer:
    """Serves the page, sends it what a session shows, and hands its touches to a device.

    Args:
        host: IP address to bind; 127.0.0.1 is reached from this machine only.
        port: 0 lets the system choose.
        tasks: What the page offers.
        version: Of the program.
        tls: Certificate and key for https.
        files: The page.

    Raises:
        DeviceError: The address or port cannot be had.

    Attributes:
        access: Who may come, and the link.
        counters: Refusals.
        latency: How long touches take.
    """

    def __init__(
        self,
        host: str = "127.0.0.1",
        port: int = 0,
        tasks: Sequence[TaskName] = (),
        version: str = "",
        tls: ssl.SSLContext | None = None,
        files: StaticFiles | None = None,
    ) -> None:
        self.counters, self.latency = Counters(), LatencyLog()
        self._tasks, self._version, self._tls = list(tasks), version, tls
        self._files = files or StaticFiles()
        self._clients: list[Client] = []
        self._last_player = ""
        self._shown: _Shown | None = None
        self._scenes = 0
        self._moment: tuple[_Shown, Snapshot, int, bool] | None = None
        self._scheduled = False
        self._frame: bytearray | None = None
        self._asked: queue.SimpleQueue[Ask] = queue.SimpleQueue()
        self._screen: Screen | None = None
        self._joined = threading.Event()
        self._ready: queue.Queue[Access | OSError] = queue.Queue()
        self._loop = asyncio.new_event_loop()
        self._closing = asyncio.Event()
        self._thread = threading.Thread(
            target=self._run, args=(host, port), name="page", daemon=True
        )
        self._thread.start()
        ready = self._ready.get()
        if isinstance(ready, OSError):
            self._thread.join()
            raise DeviceError(
                "the page cannot be served here",
                where=f"{host}:{port}",
                got=ready.strerror or str(ready),
                remedy="Choose another --page-port, or an address of this machine",
            )
        self.access = ready

    @property
    def url(self) -> str:
        """The link that opens the page."""
        return self.access.url

    @property
    def screen(self) -> Screen | None:
        """The player's screen; None before one came."""
        return self._screen

    @property
    def clients(self) -> int:
        """Pages that are connected."""
        return len(self._clients)

    def wait_for_player(self, timeout: float | None) -> bool:
        """Whether a player has joined, after at most so many seconds."""
        return self._joined.wait(timeout)

    def asked(self) -> list[Ask]:
        """What the player has asked for since the last call."""
        wishes = []
        with contextlib.suppress(queue.Empty):
            while True:
                wishes.append(self._asked.get_nowait())
        return wishes

    def next_scene(self) -> int:
        """The number of the scene that is shown next."""
        return self._scenes + 1

    def show_scene(
        self, message: Scene, scene: SimulatedScene, device: WebDevice | None = None
    ) -> None:
        """A new trial begins; its touches go to the device.

        Args:
            message: What the page is told.
            scene: Compiled; is read only.
            device: Takes the player's touches; None lets the page only look.
        """
        self._scenes = message.scene
        shown = _Shown(message, device, BodyPoses(scene))
        self._loop.call_soon_threadsafe(self._switch, shown)

    def tell(self, text: str) -> None:
        """Says something to everybody who looks."""
        self._loop.call_soon_threadsafe(self._say, encode(Trouble(text)))

    def publish(self, snapshot: Snapshot, paused: bool = False) -> None:
        """The newest moment of the session; called from its thread, and never waits."""
        shown = self._shown
        if shown is None:
            return
        touch = shown.device.applied if shown.device else 0
        self._moment = (shown, snapshot, touch, paused)
        if not self._scheduled:
            self._scheduled = True
            with contextlib.suppress(RuntimeError):  # the loop is closed: nobody looks any more
                self._loop.call_soon_threadsafe(self._spread)

    def close(self) -> None:
        """Says goodbye to all pages and ends the thread; may be called twice."""
        if self._thread.is_alive():
            with contextlib.suppress(RuntimeError):
                self._loop.call_soon_threadsafe(self._closing.set)
            self._thread.join(timeout=5.0)

    # -- everything below runs in the server's thread ------------------------------------------

    def _run(self, host: str, port: int) -> None:
        asyncio.set_event_loop(self._loop)
        try:
            self._loop.run_until_complete(self._serve(host, port))
        finally:
            self._loop.close()

    async def _serve(self, host: str, port: int) -> None:
        try:
            server = await serve(
                self._handle,
                host,
                port,
                process_request=self._process,
                ssl=self._tls,
                compression=None,
                max_size=LARGEST_MESSAGE,
                max_queue=8,
                open_timeout=GREETING,
                ping_interval=5,
                ping_timeout=5,
                close_timeout=1,
                server_header=None,
                logger=_silent_logger(),
                create_connection=_counted_connection(self.counters),
            )
        except OSError as error:
            self._ready.put(error)
            return
        bound = next(iter(server.sockets)).getsockname()
        self.access = Access(bound[0], bound[1], self._tls is not None)
        self._ready.put(self.access)
        watch = asyncio.create_task(self._watch())
        await self._closing.wait()
        watch.cancel()
        server.close()
        with contextlib.suppress(asyncio.TimeoutError):
            await asyncio.wait_for(server.wait_closed(), 3.0)

    def _process(self, connection: ServerConnection, request: Request) -> Response | None:
        """Decides on every request before anything else is done for it."""
        wants_socket = request.headers.get("Upgrade", "").lower() == "websocket"
        hosts, origins = request.headers.get_all("Host"), request.headers.get_all("Origin")
        reason = self.access.refusal(
            request.path,
            hosts[0] if len(hosts) == 1 else None,
            origins[0] if origins else None,
            wants_socket,
        )
        if reason:
            self.counters.add(f"wrong {reason}")
            return plain(HTTPStatus.FORBIDDEN, "This link is not valid. Scan the code again.")
        if wants_socket:
            if len(self._clients) >= 2 * MOST_CLIENTS:
                self.counters.add("too many clients")
                return plain(HTTPStatus.SERVICE_UNAVAILABLE, "Too many pages are open.")
            return None
        origin = f"{'wss' if self._tls else 'ws'}://{hosts[0]}"
        return self._files.response(urlsplit(request.path).path, origin)

    async def _handle(self, connection: ServerConnection) -> None:
        client = Client(connection, self.counters, time.monotonic)
        if len(self._clients) >= MOST_CLIENTS:
            self.counters.add("too many clients")
            await connection.close(TOO_MANY, "too many pages are open")
            return
        self._clients.append(client)
        writing = asyncio.create_task(client.write())
        try:
            async with asyncio.timeout(GREETING):
                first = client.read(await connection.recv())
            if not isinstance(first, Hello):
                self.counters.add("no hello")
                await connection.close(NONSENSE, "a page says hello first")
                return
            if first.protocol != PROTOCOL:
                self.counters.add("wrong version")
                await connection.close(WRONG_VERSION, f"this server speaks version {PROTOCOL}")
                return
            await self._greet(client, first)
            async for message in connection:
                up = client.read(message)
                if up is not None:
                    self._take(client, up)
        except (ConnectionClosed, TimeoutError):
            pass
        except InputError:
            await connection.close(NONSENSE, "too many messages were refused")
        finally:
            writing.cancel()
            self._clients.remove(client)
            self._leave(client)

    async def _greet(self, client: Client, hello: Hello) -> None:
        client.hello, client.screen = hello, hello.screen
        same = hello.role == "player" and hello.client == self._last_player
        for other in [c for c in self._clients if c.player and same and c is not client]:
            # The same page again, before its old socket was noticed to be dead.
            self._leave(other)
            await other.connection.close(REPLACED, "the page is open elsewhere")
        if hello.role == "player" and not any(c.player for c in self._clients):
            client.player, self._last_player = True, hello.client
            self._screen = hello.screen
            self._joined.set()
        self._welcome(client)

    def _welcome(self, client: Client) -> None:
        role = "player" if client.player else "spectator"
        client.say(encode(Welcome(PROTOCOL, self._version, role, self._tasks, CREDIT)))  # type: ignore[arg-type]
        if self._shown:
            client.say(encode(self._shown.message))
            client.offer(self._frame)

    def _leave(self, client: Client) -> None:
        if not client.player:
            return
        client.player = False
        if self._shown and self._shown.device:
            self._shown.device.cancel_all()
        # Somebody who wanted to play, and found the seat taken, gets it now.
        for other in self._clients:
            if other is not client and other.hello and other.hello.role == "player":
                other.player, self._last_player = True, other.hello.client
                self._screen = other.screen
                self._welcome(other)
                return

    def _take(self, client: Client, up: Up) -> None:
        """Does what a message says."""
        match up:
            case Got():
                after = client.got(up.frame)
                if after is not None:
                    self.latency.add("acknowledged", 1000.0 * after)
            case Beat():
                client.say(encode(Echo(up.t)))
                if up.round_trip_ms is not None:
                    self.latency.add("round_trip", up.round_trip_ms)
            case Resized():
                client.screen = up.screen
                if client.player:
                    self._screen = up.screen
            case Touches() if client.player and client.screen:
                if self._shown and self._shown.device:
                    self._shown.device.push(up, client.screen)
            case Drawn() if client.player:
                self.latency.add("drawn", up.after_ms)
            case Ask() if client.player:
                self._asked.put(up)
            case Hello():
                self.counters.add("second hello")
            case _:
                self.counters.add("not the player")

    def _switch(self, shown: _Shown) -> None:
        self._shown, self._frame = shown, None
        for client in self._clients:
            client.offer(None)
        self._say(encode(shown.message))

    def _say(self, text: bytes) -> None:
        for client in self._clients:
            if client.hello:
                client.say(text)

    def _spread(self) -> None:
        """Makes the newest moment a frame, and offers it to everybody."""
        self._scheduled = False
        if self._moment is None or self._moment[0] is not self._shown or not self._clients:
            return
        shown, snapshot, touch, paused = self._moment
        self._frame = pack(
            shown.message.scene,
            touch,
            snapshot.time,
            shown.poses(snapshot.qpos),
            state_of(snapshot, paused),
        )
        for client in self._clients:
            if client.hello:
                client.offer(self._frame)

    async def _watch(self) -> None:
        """Takes away the fingers of a page that has fallen silent."""
        while True:
            await asyncio.sleep(0.1)
            device = self._shown.device if self._shown else None
            for client in self._clients:
                silent = time.monotonic() - client.heard > SILENCE
                if client.player and silent and device and device.touched:
                    self.counters.add("silent page")
                    device.cancel_all()


def _silent_logger() -> logging.Logger:
    """A logger that says nothing: what goes wrong with strangers is counted, not printed."""
    logger = logging.Logger("hand_sandbox.page")
    logger.addHandler(logging.NullHandler())
    return logger


def _counted_connection(counters: Counters) -> type[ServerConnection]:
    """A kind of connection that is counted if it ends before it made a request."""

    class Counted(ServerConnection):
        def connection_lost(self, exc: Exception | None) -> None:
            if self.request is None:
                counters.add("failed handshake")
            super().connection_lost(exc)

    return Counted


def tls_context(certificate: str, key: str) -> ssl.SSLContext:
    """For https.

    Raises:
        InputError: The files are not a certificate and its key.
    """
    context = ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER)
    try:
        context.load_cert_chain(certificate, key)
    except (OSError, ssl.SSLError) as error:
        raise InputError(
            "this is no certificate with its key",
            where=f"--tls-cert {certificate} --tls-key {key}",
            got=str(error),
        ) from None
    return context
