"""`sandbox touches`: shows, records and sends touches, and lists the formats."""

from __future__ import annotations

import dataclasses
import json
import math
import socket
import sys
import time
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, Protocol, Self

from cyclopts import Parameter
from rich.console import Console, Group
from rich.live import Live
from rich.table import Table
from rich.text import Text

from models.errors import InputError
from models.frames import TouchFrame
from models.reader_report import ReaderReport
from models.surface import Surface
from sandbox.cli.common.command_line import application, flat, run
from sandbox.cli.common.device_options import taking_device_options
from sandbox.cli.common.touch_options import TouchOptions, open_touches_or_page
from sandbox.cli.devices.show import DeviceTable
from sandbox.cli.touches.send import send
from sandbox.devices.device import Device
from sandbox.devices.files.frame_file import LineFile, frame_record, header_record
from sandbox.devices.files.touch_files import Opened
from sandbox.devices.registry import DEVICES, offered_devices, touch_devices
from sandbox.devices.tuio.touch_capture import CaptureDevice, CapturedPacket, packet_record
from sandbox.devices.tuio.tuio import TuioDevice
from sandbox.devices.tuio.tuio_senders import Statistics

_REPORTS = 1.0
"""Time between two reports on left-out data if stdout is not a terminal, s."""


class View(Protocol):
    """Output of frames; a context manager that is entered when the device is open."""

    def __enter__(self) -> Self: ...

    def __exit__(self, *error: object) -> None: ...

    def frame(self, frame: TouchFrame) -> None: ...

    def hint(self, text: str) -> None: ...


class JsonView:
    """Frames as JSON lines on stdout, events as JSON lines on stderr."""

    def __init__(self, seen: Device) -> None:
        self._seen = seen
        self._frames = 0

    def __enter__(self) -> Self:
        if self._seen.address:
            self._event("listening", address=self._seen.address)
        return self

    def __exit__(self, *error: object) -> None:
        counts = counts_of(self._seen)
        facts = dataclasses.asdict(counts) if counts else {"frames": self._frames}
        report = self._seen.report or ReaderReport()
        self._event("end", **facts, left_out=report.left_out, assumed=report.assumed)

    def frame(self, frame: TouchFrame) -> None:
        self._frames += 1
        print(json.dumps(frame_record(frame)), flush=True)

    def hint(self, text: str) -> None:
        self._event("warning", message=text)

    def _event(self, kind: str, **facts: object) -> None:
        print(json.dumps({"event": kind, **facts}), file=sys.stderr, flush=True)


class TextView:
    """A live table of the device's data, and one of the current touches.

    If stdout is not a terminal, it gets one line per frame instead. Left-out data and assumptions
    are printed on stderr when they change, at most once a second.
    """

    def __init__(self, seen: Device, surface: Surface) -> None:
        self._seen, self._surface = seen, surface
        self._last: TouchFrame | None = None
        self._hint = ""
        self._frames = 0
        self._device = DeviceTable(seen, in_place=False)
        self._reported, self._due = "", 0.0
        self._stderr = Console(stderr=True, highlight=False)
        stdout = Console()
        self._live = (
            Live(console=stdout, get_renderable=self._render) if stdout.is_terminal else None
        )

    def __enter__(self) -> Self:
        self._say(_title(self._seen, self._surface))
        if self._live is not None:
            self._live.start()
        return self

    def __exit__(self, *error: object) -> None:
        if self._live is not None:
            self._live.stop()
        self._say(self._summary())

    def frame(self, frame: TouchFrame) -> None:
        self._last, self._hint = frame, ""
        self._frames += 1
        self._device.take([frame])
        if self._live is None:
            self._report()
            touches = "  ".join(
                f"{c['finger'] or c['id']}: {c['x']:.2f}, {c['y']:.2f}" for c in _contacts(frame)
            )
            print(f"{frame.time:9.3f} s  {touches or 'no touch'}", flush=True)

    def hint(self, text: str) -> None:
        self._hint = text
        if self._live is None:
            self._say(text)

    def _report(self) -> None:
        """Prints the report on left-out data and assumptions if it has changed."""
        if time.monotonic() >= self._due and (report := self._seen.report):
            self._due = time.monotonic() + _REPORTS
            if report.line() != self._reported:
                self._reported = report.line()
                self._say(self._reported)

    def _say(self, text: str) -> None:
        self._stderr.print(Text(text), soft_wrap=True)

    def _render(self) -> Group:
        table = Table("id", "x, in", "y, in", "size, in", "finger")
        for c in _contacts(self._last) if self._last else ():
            size = f"{c['size']:.2f}" if "size" in c else ""
            row = (f"{c['x']:.2f}", f"{c['y']:.2f}", size, c["finger"] or "")
            table.add_row(str(c["id"]), *row)
        counts = counts_of(self._seen)
        lines = [_summary(counts)] if counts else []
        if isinstance(self._seen, TuioDevice):
            for source in self._seen.sources:
                state = "silent" if source.stale else _touches(source.touches)
                lines.append(f"{source.name or 'unnamed'} at {source.peer}: {state}")
        below = (table, Text("\n".join(lines)), Text(self._hint, style="yellow"))
        return Group(self._device.table(), *below)

    def _summary(self) -> str:
        counts = counts_of(self._seen)
        text = _summary(counts) if counts else f"{self._frames} frames"
        report = self._seen.report
        return "\n".join(filter(None, (text, report.line() if report else "")))


def counts_of(seen: Device) -> Statistics | None:
    """Returns the counters of a device that receives packets; None for other devices."""
    return seen.statistics if isinstance(seen, TuioDevice | CaptureDevice) else None


def _touches(count: int) -> str:
    return "1 touch" if count == 1 else f"{count} touches"


def _contacts(frame: TouchFrame) -> list[dict[str, Any]]:
    """Returns the contacts as JSON values, in inches from the top left corner of the surface."""
    contacts: list[dict[str, Any]] = frame_record(frame)["contacts"]
    return contacts


def _title(seen: Device, surface: Surface) -> str:
    size = f"surface {surface.width_in:.2f} x {surface.height_in:.2f} in"
    if not surface.calibrated:
        size += " (a guess: give --surface)"
    if not isinstance(seen, TuioDevice):
        what = "playing a file" if seen.plays_file else seen.title
        return f"{what}; {size}; Ctrl-C ends"
    if "://" in seen.address:
        return f"calling {seen.address}; {size}; Ctrl-C ends"
    reach = ""
    if seen.bind == "0.0.0.0":
        reach = f", from the network at {_network_address()}:{seen.announced_port}"
    how = f"TUIO over {seen.transports}"
    return f"listening on {seen.address}{reach} ({how}); {size}; Ctrl-C ends"


def _summary(counts: Statistics) -> str:
    """Returns the counters in a line, without those that are zero."""
    text = f"{counts.packets} packets, {counts.frames} frames"
    for number, what, detail in (
        (counts.malformed, "malformed", counts.malformed_reason),
        (counts.late, "late", counts.late_reason),
        (counts.unfinished, "frames never closed", ""),
        (counts.refused, "connections refused", counts.refused_reason),
        (counts.ignored, "messages ignored", counts.ignored_address),
        (counts.dropped, "frames dropped", "shown too slowly"),
    ):
        if number:
            text += f", {number} {what}" + (f" (last: {detail})" if detail else "")
    return text


def missing_frames_hint(seen: Device) -> str:
    """Returns a hint on why no frame has arrived."""
    counts = counts_of(seen)
    if counts and counts.packets:
        report = seen.report
        why = f" {report.line()}." if report else ""
        return (
            f"Packets arrive, but they contain no touches: {_summary(counts)}.{why} "
            "Check that the sender is set to TUIO 1.1, cursors (2Dcur), or TUIO 2.0, pointers."
        )
    if not isinstance(seen, TuioDevice):
        return "The file begins with a pause." if seen.plays_file else "Nothing has arrived yet."
    if "://" in seen.address:
        return f"{seen.address} has not answered or sends nothing: touch the surface."
    where = f"{_network_address()} port {seen.announced_port}"
    checks = [
        "Nothing has arrived yet. Touch the surface: an idle sender is silent.",
        f"Check that the sender's host and port are {where}, its protocol TUIO over "
        f"{seen.transports},",
        "that both are in the same network, and that the firewall lets port "
        f"{seen.announced_port} in.",
    ]
    if seen.bind == "::1" or seen.bind.startswith("127."):
        checks[1] = (
            f"{seen.address} is reachable from this machine only; for a tablet add --bind 0.0.0.0."
        )
        checks[2] = (
            "`sandbox touches send CAPTURE --to " + seen.address + "` sends recorded touches."
        )
    return " ".join(checks)


def _network_address() -> str:
    """Returns this machine's address in the network, or a description if it has none."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        try:
            probe.connect(("192.0.2.1", 9))  # a documentation address (RFC 5737); nothing is sent
            return str(probe.getsockname()[0])
        except OSError:
            return "this machine's address"


_LISTED = ("web", "tuio", "evdev")
"""Devices whose formats are listed one by one."""

PATIENCE = 5.0
"""Time without a frame after which a hint on what to check is shown, s."""


@flat
@dataclass(frozen=True, kw_only=True)
class Show(TouchOptions):
    """Options of `sandbox touches show`."""

    json: bool = False
    """Print frames as JSON lines on stdout, {"time", "contacts": [{"id", "x", "y", "finger"}]}, and
    events as JSON lines on stderr. The first event is {"event": "listening", "address"}."""

    seconds: float = math.inf
    """Stop after this many seconds."""

    frames: Annotated[int | None, Parameter(metavar="INT")] = None
    """Stop after this many frames."""


@dataclass(frozen=True)
class _NewFile:
    """Positional argument of the command. The class is the last base of the options, so that its
    field comes first, as a positional argument must."""

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

    Try it on this machine first, in two terminals, with a capture of TUIO packets:

        sandbox touches show

        sandbox touches send CAPTURE --to 127.0.0.1:3333

    Then try a tablet in the same network. It opens the page in a browser, or an app on it sends
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
            # An empty file left behind would refuse the next try with the same file name.
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
        ("over UDP, TCP, WebSocket", "--tuio-transport, --tuio-connect", "TUIO 1.1 and 2.0"),
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
        ("recording of this program", "--device FILE", "its touches"),
        *(
            (DEVICES[name].help, f"--device {name}", "")
            for name in touch_devices()
            if name not in _LISTED
        ),
        *((name, f"--device {name}", "from a package") for name in offered_devices()),
        ("TUIO 1.1, 2Dcur", "send --tuio", "sent to other programs"),
    ):
        table.add_row(*row)
    Console().print(table)
    return 0


class _Recorder:
    """A view that also writes every frame to a file."""

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
            "no frames would be shown", where="--seconds, --frames", expected="above 0"
        )


def _show_frames(opened: Opened, view: View, seconds: float, frames: int | None) -> int:
    """Shows frames; after the end of a damaged file, raises the error."""
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
    """Reads and shows frames until `wanted` are shown, the file ends, or the time is over."""
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
