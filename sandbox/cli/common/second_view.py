"""A page beside the window: it looks on, and lends its fingers where a device takes them."""

from __future__ import annotations

from rich.console import Console

from encoders.paalm.hand_reconstructor import HandReconstructor
from models.errors import DeviceError
from sandbox.cli.common.page_options import PageOptions, open_page
from sandbox.devices.wrappers.device_wrapper import DeviceWrapper
from sandbox.server.connections.address import LOOPBACK
from sandbox.server.connections.invitation import code, hints
from sandbox.server.page_server import PageServer
from sandbox.server.protocol.describe import describe_scene
from sandbox.server.protocol.skins import pack_skin
from sandbox.server.web import WebDevice
from sandbox.session.session import Session
from sandbox.trial.events import EventLog


def show_session(
    server: PageServer,
    session: Session,
    hand: str,
    caption: str = "",
    device: WebDevice | None = None,
    own: int | None = None,
) -> None:
    """Shows a session that is about to begin on the page.

    Args:
        server: Server of the page.
        session: To be shown.
        hand: `right` or `left`.
        caption: The player, unless it is a person.
        device: Takes the page's touches; None lets the page only look.
        own: The hand that touches this page, where others touch elsewhere.
    """
    message = describe_scene(
        server.next_scene(),
        session.scene,
        session.task,
        session.rigs[own or 0].reconstructor.surface,
        hand,
        caption,
        in_air(session),
    )
    skins = [pack_skin(hand) for hand in session.scene.spec.hands]
    server.show_scene(message, session.scene, device, skins, own)


def touched_pages(session: Session) -> list[tuple[int | None, WebDevice]]:
    """Devices for the touches of each page, with the index of their hand; None for both hands."""
    devices: dict[int, tuple[int | None, WebDevice]] = {}
    for hand, rig in enumerate(session.rigs):
        device = rig.device
        while isinstance(device, DeviceWrapper):
            device = device.device
        if isinstance(device, WebDevice):
            devices[id(device)] = (None if id(device) in devices else hand, device)
    return list(devices.values())


def in_air(session: Session) -> bool:
    """True if all hands are in the air over 3-D devices, without touches."""
    return all(isinstance(rig.reconstructor, HandReconstructor) for rig in session.rigs)


def invite(server: PageServer, page: PageOptions, events: EventLog, console: Console) -> None:
    """Says how the page is opened."""
    host = page.page_host
    if page.tablet or page.lan:
        console.print(code(server.url), highlight=False, soft_wrap=True)
    console.print(f"open [bold]{server.url}[/]", soft_wrap=True, highlight=False)
    for hint in hints(host):
        console.print(f"[dim]{hint}[/]")
    events.tell("listening", address=server.url)


def open_second_view(
    page: PageOptions, touch: bool, events: EventLog, console: Console
) -> PageServer | None:
    """The page beside the window, whose fingers may count; None where it cannot be served, which
    costs nothing else.

    Raises:
        DeviceError: A page was asked for by name, and cannot be served.
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
        invite(server, page, events, console)
    return server


def short_address(server: PageServer) -> str:
    """The page's host and port, for a person's eyes; the whole link is in the terminal."""
    return server.url.split("://", 1)[1].split("/", 1)[0].split("?", 1)[0]
