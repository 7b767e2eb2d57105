"""Prints the link and the QR code of the page."""

from __future__ import annotations

import io

import segno

from sandbox.server.connections.address import LOOPBACK


def code(url: str) -> str:
    """A QR code of a link in block characters, for a terminal of any background colour."""
    out = io.StringIO()
    segno.make(url, error="m").terminal(out, compact=True, border=2)
    return out.getvalue()


def hints(host: str) -> list[str]:
    """Advice on settings before play, and on a page that does not open."""
    if host == LOOPBACK:
        return ["Only this machine can open it; `--tablet` lets a tablet in."]
    return [
        "iPad: switch off Settings > Multitasking & Gestures > Four & Five Finger Gestures, and "
        "set Display & Brightness > Auto-Lock to Never.",
        "If the page does not open: are both in the same Wi-Fi? Does a firewall on this machine "
        "keep the port closed?",
    ]
