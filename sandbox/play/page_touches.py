"""The browser page as a touch device without simulation. The page shows a static scene."""

from __future__ import annotations

import time
from collections.abc import Sequence

from rich.console import Console

from models.errors import InputError, SurfaceTooSmallError
from models.frames import TouchFrame
from models.reader_report import ReaderReport
from models.surface import Surface, parse_surface
from sandbox.cli.common.touch_options import TouchOptions
from sandbox.devices.device import Device
from sandbox.play.pages import open_page, show_address
from sandbox.server.page_frames import describe_scene
from sandbox.server.page_server import PageServer
from sandbox.server.screen import rectangle
from sandbox.server.web import WebDevice
from sandbox.trial.assembly import build, device_makers
from sandbox.trial.logs import EventLog
from sandbox.trial.trial_options import TrialOptions, trial_settings

_PERIOD = 1.0 / 30.0
"""Time (s) between two frames for the page. The frames show the page that the program runs."""


class PageTouches(Device):
    """Serves the page and reads its touches.

    `open_page_touches` creates it when a page has connected.

    Attributes:
        surface: The touch surface, measured on the page or given by the user.
    """

    name = "web"
    lift = True
    address: str

    def __init__(self, server: PageServer, surface: Surface | None) -> None:
        self._server = server
        self.address = server.url
        chosen = trial_settings(TrialOptions(device="web"))
        screen = server.screen
        assert screen is not None
        settings = chosen.changed(**rectangle(screen))
        if surface is not None:
            settings = settings.changed(size_in=(surface.width_in, surface.height_in))
        try:
            self._session = build(settings, device_makers(chosen))
        except SurfaceTooSmallError as error:
            # No task is played, so the error must not mention a task.
            width, height = settings.surface.size_in
            raise InputError(
                "this screen is too small for a hand",
                where="the page",
                got=f"{width:.1f} x {height:.1f} in",
                remedy="Open the page on a tablet, or in a larger window",
            ) from error
        (rig,) = self._session.rigs
        device = rig.device
        assert isinstance(device, WebDevice)
        self._session_device = device
        self.surface = rig.reconstructor.surface
        scene = self._session.scene
        message = describe_scene(
            server.next_scene(),
            scene,
            self._session.task,
            self.surface,
            settings.hands[0].side,
            "touches",
        )
        server.show_scene(message, scene, self._session_device)
        self._due = 0.0

    @property
    def report(self) -> ReaderReport:
        """Touches and sizes that were left out."""
        return self._session_device.report

    @property
    def finished(self) -> bool:
        """True once the device is closed; until then the person may return to the page."""
        return bool(self._session_device.finished)

    def poll(self, now: float = 0.0) -> Sequence[TouchFrame]:
        """Returns all frames since the last call."""
        if time.monotonic() >= self._due:
            self._due = time.monotonic() + _PERIOD
            self._server.publish(self._session.snapshot())
        return list(self._session_device.poll(now))

    def close(self) -> None:
        """Stops the server; may be called twice."""
        self._session.close()
        self._server.close()


def open_page_touches(asked: TouchOptions, console: Console, patience: float) -> PageTouches | None:
    """Serves the page and waits until it is opened; returns None after a timeout.

    Args:
        asked: Address of the page, and size of the touch surface. Without a size, it is measured on
            the page.
        console: Console for link and QR code.
        patience: Timeout, s.
    """
    server = open_page(asked)
    show_address(server, asked, EventLog(None), console)
    end = time.monotonic() + patience
    try:
        while not server.wait_for_player(0.1):
            if time.monotonic() > end:
                server.close()
                return None
        return PageTouches(server, parse_surface(asked.surface) if asked.surface else None)
    except BaseException:
        server.close()
        raise
