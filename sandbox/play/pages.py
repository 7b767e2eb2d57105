"""Pages of a session: start of their servers, their addresses, and the session that they show."""

from __future__ import annotations

from collections.abc import Callable

import msgspec
from rich.console import Console

from encoders.air.reconstructors import JointReconstructor, LandmarkReconstructor
from encoders.paalm.hand_reconstructor import HandReconstructor
from models.errors import DeviceError, InputError
from models.message import Message
from sandbox.devices.device import DeviceWrapper
from sandbox.recording.versions import versions
from sandbox.server.access import stored_token
from sandbox.server.page_frames import describe_scene, pack_skin
from sandbox.server.page_options import LOOPBACK, PageOptions, code, hints
from sandbox.server.page_server import PageServer, tls_context
from sandbox.server.protocol import StudyView, TaskName
from sandbox.server.static import HEADSET, StaticFiles
from sandbox.server.web import PageDevice
from sandbox.session.session import Session
from sandbox.trial.logs import EventLog
from sandbox.trial.profiles import default_path
from tasks.registry import TASKS, find_task, hands_of
from tasks.task import Task, summary

SIMULATED_USER = Message("simulated_user", "simulated user")
"""Caption of pictures in which no person plays."""


EASIEST_FIRST = (
    "box-to-goal",
    "wrench-turn",
    "dial",
    "stack-vertical",
    "wrench-slide",
    "insert",
    "stack",
    "gather",
    "slalom",
    "books",
    "chords",
    "single-keys",
    "stack-three",
)
"""The order in which the page offers tasks: first pushes and turns with any fingers; then tasks
that need a grip, a lift or a narrow path; last, tasks that need certain fingers or several lifts.
The order follows from the requirements of the tasks, and was not measured with people."""


def _difficulty(kind: type[Task]) -> int:
    return EASIEST_FIRST.index(kind.name) if kind.name in EASIEST_FIRST else len(EASIEST_FIRST)


def open_page(
    options: PageOptions,
    study: StudyView | None = None,
    touch: bool = True,
    headset: bool = False,
    task: str = "",
) -> PageServer:
    """Starts the server of the page.

    Args:
        options: Address, port and certificate.
        study: View of a study; its pages have no menus. None for play.
        touch: True if the player's page moves the hand.
        headset: True for the page of a headset, False for the page of fingers on a screen.
        task: Name of the first task, or its place (`FILE.py`, `FILE.py:CLASS` or `MODULE:CLASS`).
            The page's menu offers it in addition to the built-in tasks.

    Raises:
        DeviceError: The address or port is not available.
        InputError: The certificate or its key is missing or wrong.
    """
    if not 0 <= options.page_port <= 65535:
        raise InputError(
            "no such port",
            where="--page-port",
            got=options.page_port,
            expected="0 to 65535; 0 chooses a free port",
        )
    if (options.tls_cert is None) != (options.tls_key is None):
        raise InputError(
            "a certificate and its key must be given together",
            where="--tls-cert, --tls-key",
        )
    tls = None
    if options.tls_cert and options.tls_key:
        tls = tls_context(options.tls_cert, options.tls_key)
    offered = sorted((k for k in TASKS.values() if hands_of(k) == 1), key=_difficulty)
    own = find_task(task) if task else None
    if own is not None and own not in offered:
        offered.insert(0, own)
    tasks = [TaskName(kind.name, summary(kind), kind.lift_range > 0) for kind in offered]
    program = str(versions()["hand-sandbox"])
    token = stored_token(default_path().with_name("page-token")) if options.page_port else ""
    return PageServer(
        options.page_host,
        options.page_port,
        tasks,
        program,
        tls,
        files=StaticFiles(index=HEADSET) if headset else None,
        token=token,
        study=study,
        touch=touch,
    )


def open_window_page(
    page: PageOptions, touch: bool, events: EventLog, console: Console, task: str = ""
) -> PageServer | None:
    """Starts the page in addition to the window. If the page cannot be served, prints a warning and
    returns None.

    For `task` see `open_page`.

    Raises:
        DeviceError: The page cannot be served, but an option requires it.
    """
    try:
        server = open_page(page, touch=touch, task=task)
    except DeviceError as error:
        if page.tablet or page.lan or page.page_port:
            raise
        console.print(f"[yellow]there is a window, but no page: {error}[/]")
        events.write("warning", what=f"there is a window, but no page: {error}")
        return None
    if page.page_host == LOOPBACK:
        console.print(
            f"also in a browser on this machine: [bold]{server.url}[/]",
            soft_wrap=True,
            highlight=False,
        )
        events.write("listening", address=server.url)
    else:
        show_address(server, page, events, console)
    return server


def show_address(server: PageServer, page: PageOptions, events: EventLog, console: Console) -> None:
    """Prints the page's address and hints, and for tablets a QR code."""
    host = page.page_host
    if page.tablet or page.lan:
        console.print(code(server.url), highlight=False, soft_wrap=True)
    console.print(f"open [bold]{server.url}[/]", soft_wrap=True, highlight=False)
    for hint in hints(host):
        console.print(f"[dim]{hint}[/]")
    events.write("listening", address=server.url)


def short_address(server: PageServer) -> str:
    """Returns the page's host and port, without the rest of the link."""
    return server.url.split("://", 1)[1].split("/", 1)[0].split("?", 1)[0]


def print_refusals(server: PageServer, console: Console) -> None:
    """Prints the numbers of refused or lost connections and messages, by reason, if any."""
    refused = server.counters.as_dict()
    if refused:
        console.print(
            "connections refused or lost: "
            + ", ".join(f"{n} {reason}" for reason, n in refused.items())
        )


def show_session(
    server: PageServer,
    session: Session,
    hand: str,
    caption: str = "",
    device: PageDevice | None = None,
    own: int | None = None,
    scored: bool = True,
    texts: Callable[[str, str], tuple[str, str, str]] | None = None,
    finger_sets: str | None = None,
) -> None:
    """Shows a session that is about to begin on the page.

    Args:
        server: Server of the page.
        session: Session to show.
        hand: `right` or `left`.
        caption: Name of the player if it is not a person.
        device: Device for the page's touches; None for a page that only shows the session.
        own: Index of the hand that this page's touches move; None if they move all hands.
        scored: False if the result does not count.
        texts: Function that returns the title, goal and hint for a study's page, from the task's
            name and summary; None shows the task's own texts.
        finger_sets: Finger sets of the trial's settings, as text; None if the player cannot choose
            finger sets in this trial.
    """
    message = describe_scene(
        server.next_scene(),
        session.scene,
        session.task,
        session.rigs[own or 0].reconstructor.surface,
        hand,
        caption,
        in_air(session),
        scored,
    )
    if texts is not None:
        title, goal, how = texts(message.task, message.goal)
        message = msgspec.structs.replace(message, task=title, goal=goal, how=how)
    shared = own is not None and len(session.rigs) > 1
    message = msgspec.structs.replace(message, finger_sets=finger_sets, shared=shared)
    skins = [pack_skin(hand) for hand in session.scene.spec.hands]
    server.show_scene(message, session.scene, device, skins, own)


def touched_pages(session: Session) -> list[tuple[int | None, PageDevice]]:
    """Returns, for each page, the index of the hand that its touches move, and its device.

    The index is None if the page's touches move several hands.
    """
    devices: dict[int, tuple[int | None, PageDevice]] = {}
    for hand, rig in enumerate(session.rigs):
        device = rig.device
        while isinstance(device, DeviceWrapper):
            device = device.device
        if isinstance(device, PageDevice):
            devices[id(device)] = (None if id(device) in devices else hand, device)
    return list(devices.values())


def in_air(session: Session) -> bool:
    """True if all hands are in the air, without touches."""
    kinds = (HandReconstructor, JointReconstructor, LandmarkReconstructor)
    return all(isinstance(rig.reconstructor, kinds) for rig in session.rigs)
