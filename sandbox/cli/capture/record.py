"""`sandbox capture record`: records touches, and the hand by a Leap or a camera, on one clock."""

from __future__ import annotations

import math
import time
import webbrowser
from collections.abc import Sequence
from contextlib import nullcontext
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, Literal

from cyclopts import Parameter
from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn
from rich.text import Text

from encoders.captures.paired.guide import Guide
from models.errors import InputError, RecordingError, unknown_name
from models.frames import HandFrame, TouchFrame
from sandbox.captures.live_naming import LiveNaming
from sandbox.cli.common.command_line import parse, picked
from sandbox.cli.common.touch_options import LiveTouchOptions, TouchOptions, open_touches_or_page
from sandbox.devices.device import Device, HandDevice, LandmarkDevice, Sees
from sandbox.devices.files import show_report
from sandbox.devices.files.paired_capture import (
    ABOUT,
    PairedCaptureWriter,
    check_new,
    first_line_with_host,
    read_about,
)
from sandbox.devices.files.touch_files import Opened
from sandbox.devices.leap import DEFAULT_ADDRESS
from sandbox.devices.leap.leap import LeapDevice, LeapFileDevice, open_leap
from sandbox.devices.leap.leap_fake import FAKE
from sandbox.devices.leap.leap_file import read_leap
from sandbox.devices.registry import LIVE_LEAP as LIVE
from sandbox.devices.registry import LIVE_WEBCAM as CAMERA
from sandbox.devices.registry import kind_of, named_device
from sandbox.devices.webcam import webcam_choice
from sandbox.devices.webcam.engine import installed_engine
from sandbox.devices.webcam.landmarks import (
    LandmarkFileDevice,
    header_record,
    message_of,
    read_landmarks,
)
from sandbox.devices.webcam.webcam import WebcamDevice
from sandbox.server.page_options import PageOptions

Hands = HandDevice | LandmarkDevice
"""A device that sees the hand."""

_POLL_PERIOD = 0.002
"""Time between two polls of the devices, s. A recorded time of arrival is late by at most this."""
SILENT = 10.0
"""Time without data from a device after which a hint is printed, s."""

REMEDY = {
    "touches": "`sandbox touches show` gives hints on what to check",
    "hand": "`sandbox paalm show --device leap` shows what the Leap sees",
    "camera": "The camera's page shows the reason in its status line",
}
"""Kind of data -> next step if none of it arrives."""
PICTURE_WIDTH = 640
"""Width of the picture that the page requests from the camera, px."""


def seer(hands: Hands) -> str:
    """Returns the key in `REMEDY` of the device that sees the hand."""
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
        hands: Device that sees the hand.
        writer: Writer of touches and hands, both with times of one clock.
        guide: Guides the person through sets of fingers; None to record until it is stopped.
        naming: Labels touches by the fingertips that a camera sees; None with a Leap.
        seconds: Time after which recording ends, s.
        late: Delays (s) of the first touch frame and of the first hand frame, if two files of one
            session play as devices. One of the delays is 0.
    """
    console = Console(stderr=True)
    late_touches, late_hands = late
    for device in (touched, hands):
        if not device.plays_file:
            # Discard frames that arrived while the devices were opened: their time is unknown.
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


@dataclass(frozen=True, kw_only=True)
class RecordOptions(PageOptions, LiveTouchOptions):
    """Records touches and your hand at the same time, to train an encoder of your own.

    It guides you: hold the hand open (PAALM measures it), tap three times with all five fingers (to
    synchronise the clocks), then move on the surface with each of the 26 sets of two to five
    fingers, twice for some seconds. Ctrl-C stops earlier and keeps the recording. Record again on
    another day for a test set. docs/captures.md explains where to place the Leap.

    With --hands webcam, a camera over the tablet sees the fingers, and each touch is labelled by
    the nearest fingertip in the picture (docs/captures.md; a session takes ten minutes). Landmarks
    of the hand are recorded, but never pictures.

    Try it without devices:

        sandbox capture simulate --out day
        sandbox capture record --touches day/touches.jsonl --hands day/hands.jsonl --out copy

    With them:

        sandbox capture record --touches tuio --bind 0.0.0.0 --surface ipad2 --out monday
        sandbox capture record --touches web --tablet --hands webcam --out tuesday
        sandbox capture --recorded monday --out mine.npz
    """

    out: Annotated[Path, Parameter(metavar="FOLDER")]
    """Folder to create; an existing session is never overwritten."""

    touches: Annotated[str, Parameter(metavar="DEVICE")] = "tuio"
    """Touch device, as --device of `sandbox touches show`."""

    hands: Annotated[str, Parameter(metavar="leap|webcam|FILE")] = LIVE
    """Device that sees the hand: a running Leap service, a camera over the surface, or a recording
    of one of them."""

    webcam: Annotated[str, Parameter(metavar="KEY=VALUE,...")] = ""
    """With --hands webcam: fov=DEGREES, the horizontal field of view, if known; mirrored, if the
    camera's picture is mirrored; quiet, to open no browser."""

    corners: Annotated[
        str | None, Parameter(metavar="X/Y,X/Y,X/Y,X/Y", allow_leading_hyphen=True)
    ] = None
    """With --hands webcam: the surface's corners in pixels of the picture: top left, top right,
    bottom right, bottom left, as seen by the person who touches it. They can be marked in the
    camera's page instead. Without them, the touches show where the surface is."""

    side: Literal["right", "left"] = "right"
    """Which hand."""

    subject: str = "unnamed"
    """Pseudonym of the person."""

    each: float = 6.0
    """Seconds for each set of fingers, in two parts. With 6, there are about as many frames as in
    the paper."""

    free: bool = False
    """Record without guidance until Ctrl-C, for a test set. Begin with the open hand and three
    taps, as in a guided session."""

    seconds: float = math.inf
    """Stop after this many seconds."""

    leap: Annotated[str, Parameter(metavar="URL")] = DEFAULT_ADDRESS
    """WebSocket address of the Leap service."""

    surface: Annotated[str | None, Parameter(metavar="SIZE")] = None
    """Size of the touch surface: 7.76x5.82in, 197x148mm, or a preset such as ipad2."""


def main(argv: list[str]) -> int:
    """Runs `sandbox capture record ...`."""
    options = parse(RecordOptions, "sandbox capture record", argv)
    named_device(options.touches, "--touches")
    for name, value in (("--seconds", options.seconds), ("--each", options.each)):
        if not value > 0.0:
            raise InputError(
                "the time is not positive", where=name, got=value, expected="seconds, above 0"
            )
    check_new(options.out)
    hands = _hands(options)
    try:
        opened = _touches(options)
        if opened is None:
            return 0
        try:
            return _record(options, opened, hands)
        finally:
            opened.device.close()
    finally:
        hands.close()


def _record(options: RecordOptions, opened: Opened, hands: Hands) -> int:
    about: dict[str, Any] = {
        "side": options.side,
        "subject": options.subject,
        "simulated": (isinstance(hands, LeapDevice) and hands.version == FAKE)
        or any(_simulated(Path(name)) for name in (options.touches, options.hands)),
        "touches": opened.device.name,
        "hands": hands.name,
    }
    if opened.surface.calibrated is False:
        Console(stderr=True).print("the surface's size is a guess: give --surface", style="yellow")
    camera, first = isinstance(hands, LandmarkDevice), None
    naming: LiveNaming | None = None
    if camera:
        about |= _known_of_camera(options)
        recorded = hands.camera if isinstance(hands, LandmarkFileDevice) else None
        first = header_record(webcam_choice(options.webcam, recorded).camera)
        naming = LiveNaming(opened.surface, options.side)
        if any(key in options.webcam for key in ("fov=", "sees=")):
            about["fov"] = webcam_choice(options.webcam).camera.view
        if options.corners is not None:
            about["corners"] = parsed_corners(options.corners)
        if "corners" in about:
            naming.corners(about["corners"], PICTURE_WIDTH)
    guide = None if options.free else Guide(options.side, options.each, camera=camera)
    with (
        PairedCaptureWriter(options.out, opened.surface, about, first) as writer,
        naming or nullcontext(),
    ):
        try:
            ended = record_session(
                opened.device,
                hands,
                writer,
                guide,
                naming,
                options.seconds,
                _start_offsets(options),
            )
        except KeyboardInterrupt:
            ended = "stopped"
    console = Console(stderr=True)
    console.print(
        f"{options.out}: {writer.touches:,} touch frames, {writer.hands:,} hand frames; {ended}",
        soft_wrap=True,
        markup=False,
    )
    if naming is not None:
        console.print(naming.text, markup=False)
    for count, what in ((writer.touches, "touches"), (writer.hands, seer(hands))):
        if not count:
            name = "hand" if what == "camera" else what
            raise RecordingError(f"no {name} arrived", where=str(options.out), remedy=REMEDY[what])
    return 0


def _start_offsets(options: RecordOptions) -> tuple[float, float]:
    """Returns how much later (s) touches and hands begin than the earlier of the two.

    One of the values is 0. The offsets apply to two files of one session, both of which would begin
    at 0 if they were played as devices. For all other sources both are 0.
    """
    begin = [first_line_with_host(Path(name)) for name in (options.touches, options.hands)]
    if None in begin:
        return 0.0, 0.0
    touches, hands = (b for b in begin if b is not None)
    first = min(touches, hands)
    return touches - first, hands - first


def _simulated(path: Path) -> bool:
    """True if a file that plays as a device belongs to a simulated session."""
    if not (path.is_file() and (path.parent / ABOUT).is_file()):
        return False
    return read_about(path.parent).simulated


def _known_of_camera(options: RecordOptions) -> dict[str, Any]:
    """Returns field of view and corners from the session of a recording that plays as a device."""
    path = Path(options.hands)
    if not (path.is_file() and (path.parent / ABOUT).is_file()):
        return {}
    about = read_about(path.parent)
    known = {"fov": about.fov, "corners": about.corners}
    return {name: value for name, value in known.items() if value is not None}


def parsed_corners(text: str) -> list[tuple[float, float]]:
    """Returns the four corners (x, y) of `--corners`, px.

    Raises:
        InputError: The text does not have four points.
    """
    try:
        points = [tuple(map(float, part.split("/"))) for part in text.split(",")]
        corners = [(x, y) for x, y in points]
        if len(corners) != 4:
            raise ValueError
    except ValueError:
        raise InputError(
            "these are not four corners",
            where="--corners",
            got=text,
            expected="X/Y,X/Y,X/Y,X/Y in pixels: top left, top right, bottom right, bottom left",
        ) from None
    return corners


def _hands(options: RecordOptions) -> Hands:
    camera = kind_of(options.hands).sees is Sees.CAMERA
    for name, given in (("--webcam", options.webcam), ("--corners", options.corners)):
        if given and not camera:
            raise InputError(
                f"{name} is only for a camera",
                where=name,
                got=f"--hands {options.hands}",
                expected="--hands webcam",
            )
    if options.corners is not None:
        parsed_corners(options.corners)
    if options.hands == CAMERA:
        choice = webcam_choice(options.webcam)
        device = WebcamDevice(installed_engine(), (options.side,), choice.mirrored, marks=True)
        Console(stderr=True).print(Text(f"the camera's page: {device.address}"))
        if not choice.quiet:
            webbrowser.open(device.address)
        return device
    if camera:
        landmarks = read_landmarks(Path(options.hands))
        show_report(landmarks.report, options.hands)
        return LandmarkFileDevice(landmarks)
    if options.hands == LIVE:
        return open_leap(options.leap)
    path = Path(options.hands)
    if not path.is_file():
        raise unknown_name(
            "no such device or file",
            options.hands,
            (LIVE, CAMERA),
            where="--hands",
            others="or a recording of one of them",
        )
    recording = read_leap(path)
    show_report(recording.report, options.hands)
    return LeapFileDevice(recording)


def _touches(options: RecordOptions) -> Opened | None:
    asked = picked(TouchOptions, options, device=options.touches)
    return open_touches_or_page(asked, options.seconds)
