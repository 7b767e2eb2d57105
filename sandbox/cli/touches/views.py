"""Output of `sandbox touches show`: JSON lines for programs, a table for people."""

from __future__ import annotations

import dataclasses
import json
import socket
import sys
import time
from typing import Any, Protocol, Self

from rich.console import Console, Group
from rich.live import Live
from rich.table import Table
from rich.text import Text

from models.frames import TouchFrame
from models.reader_report import ReaderReport
from models.surface import Surface
from sandbox.cli.devices.show import DeviceTable
from sandbox.devices.device import Device
from sandbox.devices.files.frame_file import frame_record
from sandbox.devices.tuio.touch_capture import CaptureDevice
from sandbox.devices.tuio.tuio import TuioDevice
from sandbox.devices.tuio.tuio_senders import Statistics

_REPORTS = 1.0
"""s between two reports on what is left out, where stdout is no terminal."""


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
    """What the device sends, and a table of the current touches.

    If stdout is not a terminal, it has one line per frame; what is left out or assumed goes to
    stderr when it changes, once a second at most.
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
        """Says what has been left out and assumed since it was last said."""
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
    """Counts of a device that receives packets."""
    return seen.statistics if isinstance(seen, TuioDevice | CaptureDevice) else None


def _touches(count: int) -> str:
    return "1 touch" if count == 1 else f"{count} touches"


def _contacts(frame: TouchFrame) -> list[dict[str, Any]]:
    """Contacts in inches from the top left corner of the surface."""
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
