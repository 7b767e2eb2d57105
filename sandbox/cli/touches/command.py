"""`sandbox touches`: shows, records and sends touches, and lists the formats."""

from __future__ import annotations

import math
import time
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

from cyclopts import Parameter
from rich.console import Console
from rich.table import Table
from rich.text import Text

from models.errors import InputError
from models.frames import TouchFrame
from sandbox.cli.common.command_line import application, flat, run
from sandbox.cli.common.device_options import taking_device_options
from sandbox.cli.common.touch_options import TouchOptions, open_touches_or_page
from sandbox.cli.touches.send import send
from sandbox.cli.touches.views import JsonView, TextView, View, missing_frames_hint
from sandbox.devices.files.frame_file import LineFile, frame_record, header_record
from sandbox.devices.files.touch_files import Opened
from sandbox.devices.registry import DEVICES, offered_devices, touch_devices
from sandbox.devices.tuio.touch_capture import CapturedPacket, packet_record

_LISTED = ("web", "tuio", "evdev")
"""Devices whose formats are listed one by one."""

PATIENCE = 5.0
"""s without a frame after which a hint on what to check is shown."""


@flat
@dataclass(frozen=True, kw_only=True)
class Show(TouchOptions):
    """Options of `sandbox touches show`."""

    json: bool = False
    """Print a JSON line per frame on stdout, {"time", "contacts": [{"id", "x", "y", "finger"}]},
    and events as JSON lines on stderr, first {"event": "listening", "address"}."""

    seconds: float = math.inf
    """Stop after this many seconds."""

    frames: Annotated[int | None, Parameter(metavar="INT")] = None
    """Stop after this many frames."""


@dataclass(frozen=True)
class _NewFile:
    """What stands behind the command; its base comes first, as a positional argument must."""

    file: Annotated[Path, Parameter(metavar="FILE")]
    """File for the recording; an existing file is never overwritten."""


@flat
@dataclass(frozen=True, kw_only=True)
class Record(TouchOptions, _NewFile):
    """Options of `sandbox touches record`."""

    seconds: float = math.inf
    """Stop after this many seconds."""

    frames: Annotated[int | None, Parameter(metavar="INT")] = None
    """Stop after this many frames."""


def main(argv: list[str]) -> int:
    """Runs `sandbox touches ...`; returns the exit status."""
    about = "Shows, records and sends the touches of a tablet or touch table."
    opening = (taking_device_options(each, argv) for each in (show, record, send))
    return int(run(application("sandbox touches", about, *opening, formats), argv) or 0)


def show(options: Show = Show()) -> int:
    """Shows every touch as it arrives; Ctrl-C stops.

    x and y are in inches from the top left corner of the surface.

    Try it on this machine first, with a capture of TUIO packets and two terminals:

        sandbox touches show

        sandbox touches send CAPTURE --to 127.0.0.1:3333

    Then with a tablet in the same network, which opens the page in a browser, or whose app sends
    TUIO to the address that this command prints:

        sandbox touches show --device web --tablet

        sandbox touches show --bind 0.0.0.0
    """
    _check_end(options.seconds, options.frames)
    opened = open_touches_or_page(options, options.seconds)
    if opened is None:
        return 0
    view: View = (
        JsonView(opened.device) if options.json else TextView(opened.device, opened.surface)
    )
    return _show_frames(opened, view, options.seconds, options.frames)


def record(options: Record) -> int:
    """Records touches in a file, until Ctrl-C; the file can be used as a --device.

    TUIO is recorded packet by packet, including invalid ones; other devices frame by frame. If the
    program is killed, at most the last line is lost. If nothing arrives, no file is left, and the
    exit status is 1.

        sandbox touches record touches.jsonl --device evdev

        sandbox touches show --device touches.jsonl
    """
    _check_end(options.seconds, options.frames)
    with LineFile(options.file) as file:

        def tap(now: float, peer: str, data: bytes | None) -> None:
            file.write(packet_record(CapturedPacket(now, data, peer)))

        packets = options.device == "tuio" and not options.is_page
        try:
            opened = open_touches_or_page(options, options.seconds, tap if packets else None)
        except BaseException:
            # The corrected command makes a new file.
            file.discard()
            raise
        if opened is None:
            file.discard()
            return 0
        if not packets:
            file.write(header_record(opened.surface, opened.device.name))
        view = _Recorder(TextView(opened.device, opened.surface), None if packets else file)
        status = _show_frames(opened, view, options.seconds, options.frames)
        empty = file.lines == (0 if packets else 1)
        if empty:
            file.discard()
    told = "nothing arrived, so there is no" if empty else "written to"
    Console(stderr=True).print(Text(f"{told} {options.file}"), soft_wrap=True)
    return 1 if empty else status


def formats() -> int:
    """Lists the protocols and file formats that this program reads."""
    table = Table("what", "how", "understood")
    for row in (
        ("TUIO 1.1, 2Dcur", "--device tuio", "fingers on tablets and tables"),
        ("TUIO 1.1, 2Dblb", "--device tuio", "size of the fingers in a blob"),
        ("TUIO 2.0, ptr", "--device tuio", "fingers, with names if the sender gives them"),
        ("TUIO 2.0, bnd", "--device tuio", "size of the finger of the same id"),
        ("TUIO 1.1 2Dobj, 3D; 2.0 tok, sym, ...", "--device tuio", "ignored and counted"),
        ("over UDP, TCP, WebSocket", "--tuio-transport, --tuio-connect", "all of it"),
        ("the page", "--device web, --tablet", "any tablet with a browser"),
        ("Linux multitouch, slots", "--device evdev[:NODE]", "touch screens, trackpads"),
        ("a device of your own", "--device FILE.py:CLASS[:ARGUMENT]", "docs/write-a-device.md"),
        (
            "packet capture",
            "--device FILE, send FILE --to",
            'JSON lines {"t": seconds, "hex": "...", "from"}',
        ),
        (
            "recorded frames",
            "--device FILE",
            'JSON lines {"time", "contacts": [{"id", "x", "y", "finger"}]}',
        ),
        ("recording of sandbox", "--device FILE", "the touches in it"),
        *(
            (DEVICES[name].help, f"--device {name}", "")
            for name in touch_devices()
            if name not in _LISTED
        ),
        *((name, f"--device {name}", "a package offers it") for name in offered_devices()),
        ("TUIO 1.1, 2Dcur", "send --tuio", "sent, for other programs"),
    ):
        table.add_row(*row)
    Console().print(table)
    return 0


class _Recorder:
    """A view that also writes every frame."""

    def __init__(self, shown: TextView, file: LineFile | None) -> None:
        self._view, self._file = shown, file

    def __enter__(self) -> _Recorder:
        self._view.__enter__()
        return self

    def __exit__(self, *error: object) -> None:
        self._view.__exit__(*error)

    def frame(self, frame: TouchFrame) -> None:
        self._view.frame(frame)
        if self._file is not None:
            self._file.write(frame_record(frame))

    def hint(self, text: str) -> None:
        self._view.hint(text)


def _check_end(seconds: float, frames: int | None) -> None:
    if not seconds > 0.0 or (frames is not None and frames <= 0):
        raise InputError(
            "nothing would be shown", where="--seconds, --frames", expected="more than 0"
        )


def _show_frames(opened: Opened, view: View, seconds: float, frames: int | None) -> int:
    """Shows frames until there are enough; raises the damage of a file at its end."""
    device = opened.device
    try:
        with view:
            _follow(opened, view, seconds, frames)
            reached_end = device.finished
    except KeyboardInterrupt:
        return 0  # the usual way to end
    finally:
        device.close()
    damage = device.damage
    if damage is not None and reached_end:
        raise damage
    return 0


def _follow(opened: Opened, view: View, seconds: float, wanted: int | None) -> None:
    """Reads and shows frames until there are enough, the file ends, or the time is over."""
    seen = opened.device
    shown, hinted = 0, False
    begin = time.monotonic()
    while True:
        elapsed = time.monotonic() - begin
        seen.wait(min(0.1, max(0.0, seconds - elapsed)))
        for frame in seen.poll(elapsed):
            view.frame(frame)
            shown += 1
            if shown == wanted:
                return
        over = elapsed >= seconds or seen.finished
        if not shown and not hinted and (elapsed > PATIENCE or over):
            hinted = True
            view.hint(missing_frames_hint(seen))
        if over:
            return
