"""State machine that turns Linux multitouch events (protocol B) into contacts, without hardware.

The kernel has a fixed number of slots. `ABS_MT_SLOT` selects the slot of the following values. A
tracking id of -1 empties the slot; another id puts a new contact into it. `SYN_REPORT` ends a
frame. Only changes are sent, and a slot retains its values when its finger leaves: if the next
finger in the slot comes down at the same x, this x is not sent. Source: the kernel's documents on
multi-touch (input/multi-touch-protocol) and, for `SYN_DROPPED`, on event codes.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping
from dataclasses import dataclass, field

from models.frames import Contact
from models.plausible import ContactSizes, on_surface
from models.reader_report import ReaderReport

EV_SYN, EV_ABS = 0x00, 0x03
SYN_REPORT, SYN_DROPPED = 0, 3
ABS_X, ABS_Y = 0x00, 0x01
INPUT_PROP_DIRECT, INPUT_PROP_SEMI_MT = 0x01, 0x03
"""Properties of screens (not trackpads), and of pads that report only a box around the fingers."""
ABS_MT_SLOT = 0x2F
ABS_MT_TOUCH_MAJOR = 0x30
ABS_MT_TOUCH_MINOR = 0x31
ABS_MT_POSITION_X = 0x35
ABS_MT_POSITION_Y = 0x36
ABS_MT_TOOL_TYPE = 0x37
ABS_MT_TRACKING_ID = 0x39
ABS_MT_DISTANCE = 0x3B

MT_TOOL_PALM = 2
MAX_SLOTS = 64
"""Largest number of slots, more than any hardware has; bounds the memory for a broken driver."""

SLOT_CODES = (
    ABS_MT_TOUCH_MAJOR,
    ABS_MT_TOUCH_MINOR,
    ABS_MT_POSITION_X,
    ABS_MT_POSITION_Y,
    ABS_MT_TOOL_TYPE,
    ABS_MT_TRACKING_ID,
    ABS_MT_DISTANCE,
)
"""Codes whose values are stored for every slot."""


@dataclass(frozen=True)
class Axis:
    """An axis, as described by the driver; `resolution` is in units per mm, 0 if unknown."""

    low: int
    high: int
    resolution: int = 0

    @property
    def length(self) -> float | None:
        """Length (m) of the surface along this axis; None if the driver does not report it."""
        if self.resolution <= 0 or self.high <= self.low:
            return None
        return (self.high - self.low) / self.resolution / 1000.0

    def fraction(self, value: int) -> float:
        """Returns the position of a value on the axis, 0 at `low` to 1 at `high`."""
        return (value - self.low) / (self.high - self.low)


Matrix = tuple[float, float, float, float, float, float]
"""Matrix (a b c d e f), as libinput's calibration matrix: position (x, y) on the panel, 0 to 1, is
at (ax + by + c, dx + ey + f) on the surface."""

TURNED: dict[int, Matrix] = {
    0: (1.0, 0.0, 0.0, 0.0, 1.0, 0.0),
    90: (0.0, -1.0, 1.0, 1.0, 0.0, 0.0),
    180: (-1.0, 0.0, 1.0, 0.0, -1.0, 1.0),
    270: (0.0, 1.0, 0.0, -1.0, 0.0, 1.0),
}
"""Matrices of panels that are mounted rotated, by degrees clockwise."""


def on_its_side(matrix: Matrix) -> bool:
    """True if the panel's width is the surface's height."""
    a, b, _, d, e, _ = matrix
    return abs(b) + abs(d) > abs(a) + abs(e)


def read_matrix(text: str) -> Matrix | None:
    """Reads a calibration matrix from six or nine numbers; None if the text is not a matrix."""
    try:
        values = [float(word) for word in text.split()]
    except ValueError:
        return None
    if not all(map(math.isfinite, values)) or values[6:] not in ([], [0.0, 0.0, 1.0]):
        return None
    if len(values) < 6 or values[0] * values[4] == values[1] * values[3]:
        return None
    a, b, c, d, e, f = values[:6]
    return a, b, c, d, e, f


def why_unusable(axes: Mapping[int, Axis]) -> str:
    """Returns why touches cannot be read from a device with these axes; empty if they can."""
    place = [axes.get(ABS_MT_POSITION_X), axes.get(ABS_MT_POSITION_Y)]
    if None in place:
        return (
            "it reports one finger at most" if {ABS_X, ABS_Y} <= set(axes) else "it has no touches"
        )
    if ABS_MT_SLOT not in axes:
        return "it uses multitouch protocol A, without slots, which this program cannot read"
    if ABS_MT_TRACKING_ID not in axes:
        return "it reports no tracking ids, so that begin and end of touches are unknown"
    if not all(axis and axis.low < axis.high for axis in place):
        return "its axes have no length"
    return ""


def doubts(properties: Collection[int]) -> str:
    """Returns a warning about a device with these properties; empty if there is none."""
    if INPUT_PROP_SEMI_MT in properties:
        return (
            "this device does not report fingers, only two corners of the box around them: two "
            "fingers may be at the other two corners, and more fingers are not seen"
        )
    return ""


@dataclass
class Slots:
    """Current values of a device's slots, by slot and code, and the currently selected slot."""

    values: dict[int, dict[int, int]] = field(default_factory=dict)
    current: int = 0


class MultiTouch:
    """Follows the slots of a device.

    Args:
        x: Horizontal axis of the panel.
        y: Vertical axis of the panel.
        size: (2,) m, width and height of the surface, which the axes span.
        state: Initial values of the slots. With None, fingers that rest on the device when it is
            opened are missed.
        diameter: Axis of the contacts' diameters. If its resolution is unknown, that of `x` is
            used.
        matrix: Position of the panel on the surface.

    Attributes:
        lost: True if events were lost; no frame is complete until `resync`.
        dropped: Number of times that events were lost.
        report: Contacts and sizes that were left out.
    """

    def __init__(
        self,
        x: Axis,
        y: Axis,
        size: tuple[float, float],
        state: Slots | None = None,
        diameter: Axis | None = None,
        matrix: Matrix = TURNED[0],
    ) -> None:
        self._x, self._y, self._size = x, y, size
        self._matrix, self._on_side = matrix, on_its_side(matrix)
        # By the kernel's document, diameters are in units of the surface unless their axis has a
        # resolution.
        self._metres = (
            0.001 / diameter.resolution
            if diameter is not None and diameter.resolution > 0
            else size[self._on_side] / (x.high - x.low)
        )
        self._slots = state or Slots()
        self._skipping = False
        self.lost = False
        self.dropped = 0
        self.report = ReaderReport()
        self._sizes = ContactSizes(self.report)

    def feed(self, kind: int, code: int, value: int) -> bool:
        """Processes one event; returns True if it ends a complete frame."""
        if kind == EV_SYN and code == SYN_DROPPED:
            # Everything up to the next report belongs to an incomplete frame.
            self._skipping = self.lost = True
            self.dropped += 1
            return False
        if self._skipping:
            self._skipping = not (kind == EV_SYN and code == SYN_REPORT)
            return False
        if kind == EV_SYN and code == SYN_REPORT:
            return not self.lost
        if kind == EV_ABS and code == ABS_MT_SLOT:
            self._slots.current = value
        elif kind == EV_ABS and code in SLOT_CODES and 0 <= self._slots.current < MAX_SLOTS:
            self._slots.values.setdefault(self._slots.current, {})[code] = value
        return False

    def resync(self, state: Slots) -> None:
        """Continues from the slot values that were read from the kernel."""
        self._slots, self.lost, self._skipping = state, False, False

    def contacts(self) -> tuple[Contact, ...]:
        """Returns the fingers on the surface, without palms and hovering fingers."""
        contacts: dict[int, Contact] = {}
        for _, slot in sorted(self._slots.values.items()):
            id_ = slot.get(ABS_MT_TRACKING_ID, -1)
            if not _is_finger(slot):
                continue
            if id_ in contacts:
                self.report.leave_out("touches with the id of another")
                continue
            a, b, c, d, e, f = self._matrix
            x = self._x.fraction(slot.get(ABS_MT_POSITION_X, self._x.low))
            y = self._y.fraction(slot.get(ABS_MT_POSITION_Y, self._y.low))
            across, down = on_surface(a * x + b * y + c), on_surface(d * x + e * y + f)
            if across is None or down is None:
                self.report.leave_out("positions beyond the surface")
                continue
            major, minor = slot.get(ABS_MT_TOUCH_MAJOR, 0), slot.get(ABS_MT_TOUCH_MINOR, 0)
            size = extent = None
            if major > 0:
                size = major * self._metres
                # A driver without the smaller diameter reports round contacts; the larger one lies
                # along y unless the driver reports another orientation.
                extent = (minor * self._metres if minor > 0 else size), size
                extent = extent[::-1] if self._on_side else extent
                size, extent = self._sizes.known(size, extent)
            place = across * self._size[0], down * self._size[1]
            contacts[id_] = Contact(id_, *place, size, extent=extent)
        return tuple(contacts.values())

    def palms(self) -> frozenset[int]:
        """Returns the ids of contacts that are now known to be palms; they count as cancelled."""
        return frozenset(
            slot[ABS_MT_TRACKING_ID]
            for slot in self._slots.values.values()
            if slot.get(ABS_MT_TRACKING_ID, -1) >= 0 and slot.get(ABS_MT_TOOL_TYPE) == MT_TOOL_PALM
        )


def _is_finger(slot: dict[int, int]) -> bool:
    return (
        slot.get(ABS_MT_TRACKING_ID, -1) >= 0
        and slot.get(ABS_MT_TOOL_TYPE) != MT_TOOL_PALM
        and slot.get(ABS_MT_DISTANCE, 0) <= 0
    )
