"""Checks of devices: network, ports, input devices of Linux, and a browser."""

from __future__ import annotations

import os
import shutil
import socket
import sys
from pathlib import Path

from models.errors import DeviceError
from sandbox.doctor.check import Check

TUIO_PORT = 3333
"""Ports of TUIO over UDP and TCP, by its specification."""

BROWSERS = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable", "chrome")


def device_checks() -> list[Check]:
    """Checks of all devices."""
    return [
        _network(),
        *(port_check(kind, TUIO_PORT) for kind in ("UDP", "TCP")),
        _browser(),
        _webcam(),
        *_inputs(),
    ]


def port_check(kind: str, port: int) -> Check:
    """Checks whether a port of this machine is free.

    Args:
        kind: `UDP` or `TCP`.
        port: Port of 127.0.0.1.
    """
    stream = kind == "TCP"
    with socket.socket(
        socket.AF_INET, socket.SOCK_STREAM if stream else socket.SOCK_DGRAM
    ) as probe:
        if stream and os.name == "posix":
            # As a server does: a connection closed a minute ago does not block the port.
            probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            probe.bind(("127.0.0.1", port))
            if stream:
                probe.listen()
            ok, state = True, "free"
        except OSError as error:
            ok, state = False, error.strerror or str(error)
    return Check(
        "devices",
        f"{kind} port {port}",
        ok,
        state,
        f"tablets and tables that send TUIO by {kind}",
        ""
        if ok
        else "Another program listens there, perhaps another session; end it, or give "
        "both sides another port (--port)",
    )


def _network() -> Check:
    from sandbox.server.page_options import local_network_address

    try:
        ok, address, remedy = True, local_network_address(), ""
    except DeviceError as error:
        ok, address, remedy = False, error.what, error.remedy or ""
    return Check("devices", "network address", ok, address, "`sandbox play --tablet`", remedy)


def _browser() -> Check:
    path = next(filter(None, map(shutil.which, BROWSERS)), None)
    return Check(
        "devices",
        "Chromium",
        path is not None,
        path or "not found on the PATH",
        "the page on this machine, and its tests; any browser will do for play",
        "" if path else "On Debian or Ubuntu: apt-get install chromium",
    )


def _webcam() -> Check:
    """Checks that what finds hands in a camera's pictures is installed and undamaged."""
    from sandbox.devices.webcam.engine import INSTALL, damaged, engine_folder

    folder = engine_folder()
    wrong = damaged(folder)
    return Check(
        "devices",
        "webcam engine",
        not wrong,
        f"{wrong[0]} is missing or damaged in {folder}" if wrong else str(folder),
        "hands before a camera (--device webcam)",
        INSTALL if wrong else "",
    )


def _inputs() -> list[Check]:
    """Checks that input devices of Linux can be read."""
    if sys.platform != "linux":
        return []
    folder = Path("/dev/input")
    events = sorted(folder.glob("event*")) if folder.is_dir() else []
    readable = [p for p in events if os.access(p, os.R_OK)]
    if not events:
        summary = "no input devices, as in most containers"
        remedy = "Connect a touch screen or trackpad to this machine itself"
    elif not readable:
        summary = f"{len(events)} devices, none of which may be read"
        remedy = 'sudo usermod -aG input "$USER", then log in again'
    else:
        summary, remedy = f"{len(readable)} of {len(events)} devices can be read", ""
    return [
        Check(
            "devices",
            "/dev/input",
            bool(readable),
            summary,
            "touch screens and trackpads (--device evdev)",
            remedy,
        )
    ]
