"""What is printed so that somebody can open the page: the link, and a code to be photographed."""

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
    """What has to be set before play, and where the page is looked for if it does not open."""
    if host == LOOPBACK:
        return ["Only this machine can open it; `--tablet` lets a tablet in."]
    return [
        "iPad: switch off Settings > Multitasking & Gestures > Four & Five Finger Gestures, and "
        "set Display & Brightness > Auto-Lock to Never.",
        "If the page does not open: are both in the same Wi-Fi? Does a firewall on this machine "
        "keep the port closed?",
    ]
