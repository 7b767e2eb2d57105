"""Browser page beside the window, which shows the session and may take touches."""

from __future__ import annotations

from rich.console import Console

from encoders.headset.joint_reconstructor import JointReconstructor
from encoders.paalm.hand_reconstructor import HandReconstructor
from encoders.webcam.landmark_reconstructor import LandmarkReconstructor
from models.errors import DeviceError
from models.message import Message
from sandbox.cli.common.open_page import open_page
from sandbox.devices.wrappers.device_wrapper import DeviceWrapper
from sandbox.options.page_options import PageOptions
from sandbox.server.connections.address import LOOPBACK
from sandbox.server.connections.invitation import code, hints
from sandbox.server.page_device import PageDevice
from sandbox.server.page_server import PageServer
from sandbox.server.protocol.describe import describe_scene
from sandbox.server.protocol.skins import pack_skin
from sandbox.session.session import Session
from sandbox.trial.events import EventLog

SIMULATED_USER = Message("simulated_user", "simulated user")
"""Caption of pictures in which no person plays."""


def show_session(
    server: PageServer,
    session: Session,
    hand: str,
    caption: str = "",
    device: PageDevice | None = None,
    own: int | None = None,
    scored: bool = True,
) -> None:
    """Shows a session that is about to begin on the page.

    Args:
        server: Server of the page.
        session: Session to show.
        hand: `right` or `left`.
        caption: Name of the player if it is not a person.
        device: Device for the page's touches; None: the page only shows.
        own: Index of the hand that touches this page, if the other one touches elsewhere.
        scored: False if the result does not count.
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
    skins = [pack_skin(hand) for hand in session.scene.spec.hands]
    server.show_scene(message, session.scene, device, skins, own)


def touched_pages(session: Session) -> list[tuple[int | None, PageDevice]]:
    """Returns the device of each page, with the index of its hand; None for both hands."""
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


def show_address(server: PageServer, page: PageOptions, events: EventLog, console: Console) -> None:
    """Prints the page's address, for tablets with a QR code, and hints."""
    host = page.page_host
    if page.tablet or page.lan:
        console.print(code(server.url), highlight=False, soft_wrap=True)
    console.print(f"open [bold]{server.url}[/]", soft_wrap=True, highlight=False)
    for hint in hints(host):
        console.print(f"[dim]{hint}[/]")
    events.tell("listening", address=server.url)


def open_page_beside_window(
    page: PageOptions, touch: bool, events: EventLog, console: Console
) -> PageServer | None:
    """Starts the page beside the window; returns None if it cannot be served, with a warning.

    Raises:
        DeviceError: An option asks for the page, and it cannot be served.
    """
    try:
        server = open_page(page, touch=touch)
    except DeviceError as error:
        if page.tablet or page.lan or page.page_port:
            raise
        console.print(f"[yellow]no page beside the window: {error}[/]")
        events.tell("warning", what=f"no page beside the window: {error}")
        return None
    if page.page_host == LOOPBACK:
        console.print(
            f"also in a browser on this machine: [bold]{server.url}[/]",
            soft_wrap=True,
            highlight=False,
        )
        events.tell("listening", address=server.url)
    else:
        show_address(server, page, events, console)
    return server


def short_address(server: PageServer) -> str:
    """Returns the page's host and port; the terminal shows the whole link."""
    return server.url.split("://", 1)[1].split("/", 1)[0].split("?", 1)[0]
