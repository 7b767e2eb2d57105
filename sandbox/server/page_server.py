"""The server of the page: one thread with its own event loop; a session never waits for it.

`AutoPause` stops simulated time before the first touch on a page, and while a player is away, in
play and in studies.
"""

from __future__ import annotations

import contextlib
import errno
import queue
import ssl
import time
from collections.abc import Sequence
from dataclasses import dataclass
from http import HTTPStatus
from typing import TypeVar
from urllib.parse import urlsplit

from websockets.asyncio.server import ServerConnection
from websockets.http11 import Request, Response

from models.errors import InputError
from models.scene import Scene as SimulatedScene
from sandbox.server.clients import MOST_CLIENTS, Clients
from sandbox.server.page_frames import (
    BodyKinematics,
    localised,
    pack,
    state_of,
)
from sandbox.server.protocol import (
    LARGEST_MESSAGE,
    ItemAnswer,
    Leave,
    PageScreen,
    Pause,
    PlayerRequest,
    Refusal,
    SceneMessage,
    Sheet,
    StudyView,
    TaskName,
    Trouble,
    encode,
)
from sandbox.server.server_thread import ServerThread, cannot_serve
from sandbox.server.static import StaticFiles, plain
from sandbox.server.web import PageDevice
from sandbox.session.messages import Snapshot
from sandbox.trial.logs import LatencyLog
from sandbox.words import preferred, words_in

_T = TypeVar("_T")


@dataclass(frozen=True)
class _ServedScene:
    """The scene that is served now."""

    message: SceneMessage
    device: PageDevice | None
    poses: BodyKinematics
    skins: Sequence[bytes] = ()
    own: int | None = None


class PageServer(ServerThread):
    """Serves the page, sends it a session's frames, and passes its touches to a device.

    Args:
        host: IP address to bind; 127.0.0.1 can be reached only from this machine.
        port: TCP port; 0 lets the system choose.
        tasks: Tasks that the page offers.
        version: Version of the program.
        tls: Certificate and key for https.
        files: Files of the page.
        token: Token of an earlier server, so that its pages can reconnect; empty creates a new one.
        study: Study to which the page belongs; such a page has no menus. None outside a study.
        touch: True if the player's touches are used; False if another device plays and all pages
            are spectators.

    Raises:
        DeviceError: The address or port is not available.

    Attributes:
        latency: Log of the latency of touches.
    """

    def __init__(
        self,
        host: str = "127.0.0.1",
        port: int = 0,
        tasks: Sequence[TaskName] = (),
        version: str = "",
        tls: ssl.SSLContext | None = None,
        files: StaticFiles | None = None,
        token: str = "",
        study: StudyView | None = None,
        touch: bool = True,
    ) -> None:
        super().__init__(LARGEST_MESSAGE, tls, token)
        self.latency = LatencyLog()
        self._language = study.language if study else ""
        self._files = files or StaticFiles()
        self._pages = Clients(tasks, version, self.counters, self.latency, study, touch)
        self._shown: _ServedScene | None = None
        self._scenes = 0
        self._moment: tuple[_ServedScene, int, Snapshot, Pause] | None = None
        self._scheduled = False
        error = self._start("page", host, port)
        if error is not None:
            taken = error.errno == errno.EADDRINUSE
            remedy = (
                "Another `sandbox play` may use the port: choose another --page-port"
                if taken
                else "Choose another --page-port, or an address of this machine"
            )
            raise cannot_serve("the page", host, port, error, remedy)

    @property
    def screen(self) -> PageScreen | None:
        """The player's screen; None before a player has connected."""
        return self._pages.screen

    @property
    def language(self) -> str:
        """Language of the player's page, by ISO 639-1; empty before a player has connected."""
        return self._pages.language

    @property
    def browser(self) -> str:
        """Name that the player's browser reports; empty before a player has connected."""
        return self._pages.browser

    @property
    def seated(self) -> int:
        """Number of times that a new page, with another screen, became the player's page."""
        return self._pages.seated

    @property
    def away(self) -> bool:
        """True if play is impossible: the player's page is closed, hidden or silent."""
        return self._pages.away

    @property
    def clients(self) -> int:
        """Number of connected pages."""
        return len(self._pages)

    def wait_for_player(self, timeout: float | None) -> bool:
        """Waits for a player, at most `timeout` seconds; returns True if a player has joined."""
        return self._pages.joined.wait(timeout)

    @property
    def silence(self) -> float:
        """Time (s) since a player's page was last present, that is, visible and sending messages;
        infinite before the first player."""
        return self._pages.silence

    def take_requests(self) -> list[PlayerRequest]:
        """Returns the player's requests since the last call."""
        return _all_of(self._pages.requests)

    def take_inputs(self) -> list[ItemAnswer | Leave]:
        """Returns the player's inputs to a study's sheets since the last call, unchecked."""
        return _all_of(self._pages.inputs)

    def show_sheet(self, sheet: Sheet, tell: bool = True) -> None:
        """Shows the player a sheet, also after a reconnection.

        Args:
            sheet: What the participant of a study sees instead of the scene, such as a consent
                form, instructions or a questionnaire.
            tell: False if the player's page already shows it.
        """
        self._loop.call_soon_threadsafe(self._pages.show_sheet, sheet, tell)

    def refuse(self, refusal: Refusal) -> None:
        """Sends the player the refusal of an answer."""
        self._loop.call_soon_threadsafe(self._pages.send_to_player, encode(refusal))

    def next_scene(self) -> int:
        """Returns the number of the scene that is shown next."""
        return self._scenes + 1

    def show_scene(
        self,
        message: SceneMessage,
        scene: SimulatedScene,
        device: PageDevice | None = None,
        skins: Sequence[bytes] = (),
        own: int | None = None,
    ) -> None:
        """Begins a new trial; the player's touches go to the device.

        Args:
            message: Message with the scene.
            scene: The compiled scene, which is only read.
            device: Device for the player's touches; None for a page without touches.
            skins: Skins of the scene's hands, by `sandbox.server.page_frames.pack_skin`; without
                them, the page shows bones.
            own: Index of the hand that this page's touches move; None if they move all hands.
        """
        self._scenes = message.scene
        shown = _ServedScene(message, device, BodyKinematics(scene), skins, own)
        self._loop.call_soon_threadsafe(self._open_scene, shown)

    def show_demonstration(self, scene: int, message: bytes) -> None:
        """Sends the player a demonstration for a scene, if this scene is still shown."""

        def send() -> None:
            if self._shown is not None and self._shown.message.scene == scene:
                self._pages.show_demonstration(message)

        with contextlib.suppress(RuntimeError):  # the loop is closed
            self._loop.call_soon_threadsafe(send)

    def show_problem(self, *sentences: str) -> None:
        """Shows the reason for a missing scene on all pages until the next scene.

        Until then, the next page that connects may become the player's page.
        """
        self._loop.call_soon_threadsafe(
            self._pages.show_problem, encode(Trouble([localised(s) for s in sentences]))
        )

    def publish(self, snapshot: Snapshot, pause: Pause = "") -> None:
        """Publishes the newest snapshot; called from the session's thread, and never waits.

        Args:
            snapshot: The snapshot.
            pause: Reason why simulated time stands still; empty while it runs.
        """
        shown = self._shown
        if shown is None:
            return
        touch = shown.device.applied if shown.device else 0
        self._moment = (shown, touch, snapshot, pause)
        if not self._scheduled:
            self._scheduled = True
            with contextlib.suppress(RuntimeError):  # the loop is closed
                self._loop.call_soon_threadsafe(self._spread)

    # -- everything below runs in the server's thread ------------------------------------------

    async def _handle(self, connection: ServerConnection) -> None:
        await self._pages.handle(connection)

    async def _watch(self) -> None:
        await self._pages.watch()

    async def _part(self) -> None:
        await self._pages.part()

    def _process(self, connection: ServerConnection, request: Request) -> Response | None:
        """Accepts or refuses a request; returns the response, or None to open a WebSocket."""
        if not self._limits.judge(connection):
            return plain(HTTPStatus.SERVICE_UNAVAILABLE, self._words(request)["too_many_pages"])
        wants_socket = request.headers.get("Upgrade", "").lower() == "websocket"
        reason = self._refusal(request, wants_socket)
        if reason == "token" and self.access.is_return_page(request.path, wants_socket):
            # Count also these requests, so that a flood of them is visible.
            self.counters.add("request without a token")
            return self._files.way_back()
        if reason:
            self.counters.add(f"wrong {reason}")
            return plain(HTTPStatus.FORBIDDEN, self._words(request)["link_invalid"])
        full = wants_socket and len(self._pages) >= 2 * MOST_CLIENTS
        if full or not self._limits.authenticate(connection):
            self.counters.add("too many clients")
            return plain(HTTPStatus.SERVICE_UNAVAILABLE, self._words(request)["too_many_pages"])
        if wants_socket:
            return None
        host = request.headers["Host"]
        origin = f"{'wss' if self._tls else 'ws'}://{host}"
        path = urlsplit(request.path).path
        accepted = ", ".join(request.headers.get_all("Accept-Encoding"))
        return self._files.response(path, origin, self.access.token, self._language, accepted)

    def _words(self, request: Request) -> dict[str, str]:
        """Returns the texts for a refused page, in the study's language or the browser's."""
        accepted = request.headers.get_all("Accept-Language")
        return words_in(self._language or preferred(accepted[0] if accepted else ""))

    def _open_scene(self, shown: _ServedScene) -> None:
        self._shown = shown
        self._pages.open_scene(shown.message, shown.device, shown.skins)

    def _spread(self) -> None:
        """Encodes the newest snapshot as a frame, and offers it to all pages."""
        self._scheduled = False
        if self._moment is None or self._moment[0] is not self._shown or not len(self._pages):
            return
        shown, touch, snapshot, pause = self._moment
        poses, state = shown.poses(snapshot.qpos), state_of(snapshot, pause, shown.own)
        self._pages.show(pack(shown.message.scene, touch, snapshot.time, poses, state))


def _all_of(waiting: queue.SimpleQueue[_T]) -> list[_T]:
    """Takes all items that are in a queue now."""
    items = []
    with contextlib.suppress(queue.Empty):
        while True:
            items.append(waiting.get_nowait())
    return items


def tls_context(certificate: str, key: str) -> ssl.SSLContext:
    """Returns the TLS context for https.

    Raises:
        InputError: The files are not a certificate and its key.
    """
    context = ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER)
    try:
        context.load_cert_chain(certificate, key)
    except (OSError, ssl.SSLError) as error:
        raise InputError(
            "these files are not a certificate and its key",
            where=f"--tls-cert {certificate} --tls-key {key}",
            got=str(error),
            expected="two PEM files",
        ) from None
    return context


class AutoPause:
    """Stops simulated time while a player cannot play, and lists these absences.

    Time begins with the first touch on any page. It stops as soon as a page is away. It continues
    when this page is back and has a touch. Once the goal is held, no player is needed, so time runs
    to the trial's end.

    Args:
        pages: Server and device of every page. A page without a device counts as touched while it
            is not away.
        begun: True if time runs before the first touch.
        stops: False if time continues while a page is away.

    Attributes:
        begun: True once time has begun.
        away: Indices of the pages that were away at the last check.
    """

    def __init__(
        self,
        pages: Sequence[tuple[PageServer, PageDevice | None]],
        begun: bool = False,
        stops: bool = True,
    ) -> None:
        self._pages, self._stops = tuple(pages), stops
        self.begun = begun or not any(device for _, device in self._pages)
        self._awaits_touch = not self.begun
        self._awaited: set[int] = set()
        self._since: tuple[float, float] | None = None
        self._ended: list[dict[str, float]] = []
        self.away: set[int] = set()

    def check(self, time_s: float, held: bool, paused: bool = False) -> Pause:
        """Returns the reason why simulated time must stand still now; empty if it may run.

        Args:
            time_s: Simulated time, s.
            held: True if the goal has been held.
            paused: True during a pause by the experimenter. After it, time continues with the next
                touch on any page.
        """
        self.away = {i for i, (server, _) in enumerate(self._pages) if server.away}
        if self.begun and self._stops and not held:
            self._awaited |= self.away
        if paused:
            self._awaits_touch = True
            return "menu"
        devices = [device for _, device in self._pages]
        touched = {i for i, d in enumerate(devices) if d is None or d.touched} - self.away
        if self._awaits_touch and touched:
            self._awaits_touch, self.begun = False, True
        if not self.begun:
            return "start"
        self._awaited -= touched
        if held:
            self._awaited.clear()
        if self._awaited and self._since is None:
            self._since = time_s, time.monotonic()
        elif not self._awaited:
            self._end()
        if not (self._awaited or self._awaits_touch):
            return ""
        return "away" if self.away else "back"

    def listed(self) -> list[dict[str, float]]:
        """Returns all absences: `at_s`, simulated time, and `lasted_s`, real time until the next
        touch."""
        self._end()
        return self._ended

    def _end(self) -> None:
        if self._since is None:
            return
        at, began = self._since
        self._since = None
        self._ended.append({"at_s": round(at, 3), "lasted_s": round(time.monotonic() - began, 3)})
