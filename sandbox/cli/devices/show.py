"""`sandbox devices show`: a live table of the data of a device or a file."""

from __future__ import annotations

import math
import time
from collections import deque
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from statistics import median
from typing import Annotated, Any, Self

from cyclopts import Parameter
from rich.console import Console, Group
from rich.live import Live
from rich.table import Table
from rich.text import Text

from models.errors import InputError
from models.frames import Frame, HandFrame, LandmarkFrame, TouchFrame
from models.message import counted
from models.plausible import (
    CONTACT,
    DISTANCE,
    FINGER,
    IN_PICTURE,
    PALM,
    REACH,
    STEP,
    TOUCH_STEP,
    Bounds,
)
from sandbox.cli.common.command_line import flat
from sandbox.cli.common.touch_options import TouchOptions, open_touches_or_page, refuse_unit
from sandbox.devices.device import AnyDevice, Device, Place, Sees, Source
from sandbox.devices.leap import LeapOptions
from sandbox.devices.registry import DEVICES, kind_of, named_device
from sandbox.devices.webcam import WebcamOptions
from sandbox.trial.trial_options import COMMON

_RECENT = 240
"""Number of recent frames used for the rate and the sizes."""
_LINES = 1.0
"""Time between two prints if the output is not a terminal, s."""


class DeviceTable:
    """A table of a device's data: rate, sizes, units, and left-out data with the reasons.

    On a terminal the table is refreshed in place. Otherwise, changed rows are printed as lines, at
    most once a second. The table is a context manager, entered when the device is open.

    Args:
        device: The device.
        in_place: False if the caller draws `table` itself.
    """

    def __init__(self, device: AnyDevice, in_place: bool = True) -> None:
        self._device = device
        self._frames = 0
        self._steps: deque[float] = deque(maxlen=_RECENT)
        self._last: tuple[float, bool] | None = None
        self._sizes: dict[Bounds, deque[float]] = {}
        self._seen = ""
        self._printed: dict[str, str] = {}
        self._due = 0.0
        console = Console()
        self._lines = in_place and not console.is_terminal
        self._live = (
            Live(console=console, get_renderable=self.table)
            if in_place and console.is_terminal
            else None
        )

    def __enter__(self) -> Self:
        if self._live is not None:
            self._live.start()
        return self

    def __exit__(self, *error: object) -> None:
        if self._live is not None:
            self._live.stop()
        self._print()

    def take(self, frames: Sequence[Frame]) -> None:
        """Adds the next frames, if there are any."""
        for frame in frames:
            self._frames += 1
            at = frame.taken if isinstance(frame, LandmarkFrame) else frame.time
            # After a frame without touches, the pause is not a frame interval.
            if self._last is not None and self._last[1]:
                self._steps.append(at - self._last[0])
            self._last = at, not isinstance(frame, TouchFrame) or bool(frame.contacts)
            self._seen, sizes = _measured(frame)
            for bounds, size in sizes.items():
                self._sizes.setdefault(bounds, deque(maxlen=_RECENT)).append(size)
        if time.monotonic() >= self._due:
            self._due = time.monotonic() + _LINES
            self._print()

    def rows(self) -> dict[str, str]:
        """Returns the rows: name and value."""
        rows = {"source": self._device.title, "frames": f"{self._frames:,}"}
        if self._steps and (step := math.fsum(self._steps) / len(self._steps)) > 0.0:
            bounds = TOUCH_STEP if isinstance(self._device, Device) else STEP
            unlikely = "" if bounds.includes(step) else " (impossible for a device)"
            rows["frames a second"] = f"{1.0 / step:.1f}{unlikely}"
        if self._seen:
            rows["seen"] = self._seen
        for bounds, sizes in self._sizes.items():
            unit = bounds.powers[0][0].replace("image coordinate", "px").replace("length", "m")
            usual = f"{bounds.least:g} to {bounds.most:g} {unit}"
            rows[bounds.name.removeprefix("the ")] = f"{median(sizes):.3g} {unit} (usual: {usual})"
        report = self._device.report
        if report is not None:
            rows["assumed"] = "; ".join(report.assumed) or "nothing: units are those of the format"
            for name, counts in (("left out", report.left_out), ("mended", report.mended)):
                rows |= {f"{name}: {why}": f"{n:,}" for why, n in counts.most_common()}
        notices = [str(n) for n in self._device.notices if not report or n not in report.assumed]
        if notices:
            rows["notice"] = "; ".join(notices)
        return rows

    def table(self) -> Group:
        """Returns the rows as a table."""
        table = Table(show_header=False)
        for name, value in self.rows().items():
            table.add_row(Text(name), Text(value))
        return Group(table)

    def _print(self) -> None:
        """Prints the rows that have changed, if the output is not a terminal."""
        if not self._lines:
            return
        for name, value in self.rows().items():
            if self._printed.get(name) != value:
                print(f"{name}: {value}", flush=True)
        self._printed = self.rows()


def _measured(frame: Frame) -> tuple[str, Mapping[Bounds, float]]:
    """Returns a description of a frame in words, and the sizes of its first hand."""
    if isinstance(frame, TouchFrame):
        named = sum(c.label is not None for c in frame.contacts)
        seen = counted(len(frame.contacts), "touch", "touches") + f", {named} with a finger"
        known = [c.size for c in frame.contacts if c.size is not None]
        return seen, {CONTACT: median(known)} if known else {}
    seen = ", ".join(f"a {h.side or 'right or left'} hand" for h in frame.hands) or "no hand"
    if not frame.hands:
        return seen, {}
    if isinstance(frame, LandmarkFrame):
        picture = frame.hands[0]
        x = [p[0] for p in picture.image]
        return seen, {
            PALM: math.dist(picture.world[0], picture.world[9]),
            IN_PICTURE: max(x) - min(x),
        }
    assert isinstance(frame, HandFrame)
    hand = frame.hands[0]
    sizes = {DISTANCE: math.hypot(*hand.palm)}
    if any(finger.joints for finger in hand.fingers):
        sizes[FINGER] = max(finger.length for finger in hand.fingers if finger.joints)
    if hand.fingers:
        sizes[REACH] = max(math.dist(hand.palm, finger.tip) for finger in hand.fingers)
    return f"{seen} with {counted(len(hand.fingers), 'finger')}", sizes


@flat
@dataclass(frozen=True, kw_only=True)
class Show(WebcamOptions, LeapOptions, TouchOptions):
    """Options of `sandbox devices show`."""

    device: Annotated[str, Parameter(group=COMMON, metavar="NAME|FILE")] = ""
    """Device or file: leap, webcam, tuio, web, evdev, a device of your own, or a recording of a
    Leap, of landmarks, of touches or of this program. As the first word after `show`, it needs no
    `--device`."""

    seconds: Annotated[float, Parameter(group=COMMON)] = math.inf
    """Stop after this many seconds."""


def show(options: Show = Show()) -> int:
    """Shows the data of a device or a file: rate, sizes, units, and left-out data with reasons.

    Use it first if a hand does not move, is far away or is missing. On a terminal the table is
    refreshed in place until Ctrl-C or the end of the file; otherwise each row is a line.

        sandbox devices show leap

        sandbox devices show tuio --bind 0.0.0.0

        sandbox devices show recording.json

    Read the table from the top. If there are no frames, check cable, address and firewall. If the
    frames per second are impossible or sizes are outside the usual range, the sender uses other
    units. `assumed` shows the units that are used instead; for a file, --unit sets them, such as
    --unit cm,ms. `left out` counts unusable data by reason.
    """
    if not options.device and not options.is_page:
        raise InputError(
            "no device or file is named",
            where="--device",
            expected=", ".join((*DEVICES, "or a file")),
        )
    if not options.seconds > 0.0:
        raise InputError(
            "no frames would be shown",
            where="--seconds",
            got=options.seconds,
            expected="above 0",
        )
    device = _opened(options)
    if device is None:
        return 0
    try:
        with DeviceTable(device) as table:
            _follow(device, table, options.seconds)
            ended = device.finished
    except KeyboardInterrupt:
        return 0  # the usual way to end
    finally:
        device.close()
    if ended and device.damage is not None:
        raise device.damage
    return 0


def _opened(options: Show) -> AnyDevice | None:
    """Opens the device or the file; returns None if no browser has opened the page."""
    kind = kind_of(options.device)
    path = Path(options.device)
    if kind.source is Source.FILE and kind.sees is Sees.LEAP:
        from sandbox.devices.leap.leap import LeapFileDevice
        from sandbox.devices.leap.leap_file import read_leap

        return LeapFileDevice(read_leap(path, options.unit))
    if kind.source is Source.FILE and kind.sees is Sees.CAMERA:
        from sandbox.devices.webcam.landmarks import LandmarkFileDevice, read_landmarks

        return LandmarkFileDevice(read_landmarks(path, options.unit))
    if kind.live and kind.sees in (Sees.LEAP, Sees.CAMERA):
        from sandbox.devices.files.touch_files import guessed_surface

        named_device(options.device, "sandbox devices show")
        refuse_unit(options)
        return options.settings.open(Place(guessed_surface()))
    opened: Any = open_touches_or_page(options, options.seconds)
    return None if opened is None else opened.device


def _follow(device: AnyDevice, table: DeviceTable, seconds: float) -> None:
    """Shows frames until the file ends or the time is over."""
    begin = time.monotonic()
    while (elapsed := time.monotonic() - begin) < seconds and not device.finished:
        if not device.plays_file:
            device.wait(min(0.1, seconds - elapsed))
        # A file is not played at its speed: all its frames are read at once.
        table.take(device.poll(math.inf if device.plays_file else elapsed))
