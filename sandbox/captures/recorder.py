"""Records touches and the hand, by a Leap or a camera, by one clock."""

from __future__ import annotations

import math
import time
from collections.abc import Sequence

from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn

from encoders.captures.paired.guide import Guide
from models.frames import HandFrame, TouchFrame
from sandbox.captures.live_naming import LiveNaming
from sandbox.devices.device import Device, HandDevice, LandmarkDevice
from sandbox.devices.files.paired_capture import (
    PairedCaptureWriter,
)
from sandbox.devices.webcam.landmarks import message_of
from sandbox.devices.webcam.webcam import WebcamDevice

Hands = HandDevice | LandmarkDevice
"""What sees the hand."""

_POLL_PERIOD = 0.002
"""s between two polls of the devices, by which a time of arrival may be late."""
SILENT = 10.0
"""s without data from a device after which a hint is printed."""

REMEDY = {
    "touches": "`sandbox touches show` gives hints on what to check",
    "hand": "`sandbox paalm show --device leap` shows what the Leap sees",
    "camera": "The camera's page says in its one line what is missing",
}
"""What to look at where nothing arrives."""
PICTURE_WIDTH = 640
"""px of the picture that the page asks the camera for."""


def seer(hands: Hands) -> str:
    """Key in `REMEDY` of what sees the hand."""
    return "camera" if isinstance(hands, LandmarkDevice) else "hand"


def record_session(
    touched: Device,
    hands: Hands,
    writer: PairedCaptureWriter,
    guide: Guide | None,
    naming: LiveNaming | None,
    seconds: float = math.inf,
    late: tuple[float, float] = (0.0, 0.0),
) -> str:
    """Writes touches and hands until the end; returns the reason for the end.

    Args:
        touched: Device of the touches.
        hands: What sees the hand.
        writer: Writes both, by one clock.
        guide: Guides the person through sets of fingers; None records until it is stopped.
        naming: Names touches under a camera; None under a Leap.
        seconds: s after which recording ends.
        late: s by which touches and hands begin after the first of two files that play as devices.
    """
    console = Console(stderr=True)
    late_touches, late_hands = late
    for device in (touched, hands):
        if not device.plays_file:
            # What came while the devices were opened did not arrive now.
            device.poll(0.0)
    begin = time.monotonic()
    last: TouchFrame | None = None
    bar = Progress(
        TextColumn("{task.description}"),
        BarColumn(),
        TextColumn("{task.percentage:3.0f} %"),
        console=console,
        disable=not console.is_terminal,
    )
    with bar as progress:
        now_doing = progress.add_task("recording; Ctrl-C ends", total=1.0 if guide else None)
        session = progress.add_task("the whole session", total=1.0, visible=guide is not None)
        named = progress.add_task("", total=None, visible=naming is not None)
        shown, quiet = -1.0, set[str]()
        told: Sequence[str] = ()
        asked: tuple[int, ...] | None = None
        marked: Sequence[tuple[float, float]] = ()
        while True:
            now = time.monotonic() - begin
            for frame in touched.poll(now - late_touches):
                last = frame
                writer.touch(frame, now)
                if guide is not None:
                    guide.touch(frame, now)
                if naming is not None:
                    naming.touch(frame, now)
            for seen in hands.poll(now - late_hands):
                if isinstance(seen, HandFrame):
                    writer.hand(seen, now)
                    if guide is not None:
                        guide.hand(seen)
                    continue
                writer.picture(message_of(seen), now)
                if guide is not None:
                    guide.picture(seen)
                if naming is not None:
                    naming.picture(seen, now)
            if naming is not None and guide is not None and guide.requested != asked:
                asked = guide.requested
                writer.request(asked or (), now)
            if isinstance(hands, WebcamDevice):
                if hands.corners != marked:
                    marked = hands.corners
                    writer.describe(corners=marked)
                    if naming is not None:
                        naming.corners(marked, PICTURE_WIDTH)
                if hands.notices != told:
                    told = hands.notices
                    text = ", ".join(told) or "the camera sees"
                    progress.console.print(text, markup=False)
            if guide is not None and last is not None:
                guide.pass_time(now, len(last.contacts))
            if now - shown > 0.1:
                shown = now
                if guide is not None:
                    step = guide.step
                    progress.update(now_doing, description=step.text, completed=step.share)
                    progress.update(session, completed=guide.share)
                if naming is not None:
                    progress.update(named, description=naming.text)
                for what, count in (("touches", writer.touches), (seer(hands), writer.hands)):
                    if not count and now > SILENT and what not in quiet:
                        quiet.add(what)
                        progress.console.print(f"no {what} yet; {REMEDY[what]}")
            if guide is not None and guide.done:
                return "all sets of fingers"
            if now >= seconds:
                return "the time is over"
            if touched.finished and hands.finished:
                return "both recordings ended"
            time.sleep(_POLL_PERIOD)
