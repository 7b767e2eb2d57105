"""State machine that turns Linux multitouch events (protocol B) into contacts, without hardware.

The kernel keeps a fixed number of slots. `ABS_MT_SLOT` says which slot the following values are
for; a tracking id of -1 empties it, another one puts a new contact in; `SYN_REPORT` ends a frame.
Only changes are sent, and a slot keeps its values when its finger leaves: if the next finger in it
comes down at the same x, that x is not sent. Source: the kernel's document on multi-touch
(input/multi-touch-protocol), and that on event codes for `SYN_DROPPED`.
"""

from __future__ import annotations

from dataclasses import dataclass, field

from models.frames import Contact

EV_SYN, EV_ABS = 0x00, 0x03
SYN_REPORT, SYN_DROPPED = 0, 3
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
"""More than any hardware has; bounds the memory that a broken driver can use."""

SLOT_CODES = (
    ABS_MT_TOUCH_MAJOR,
    ABS_MT_TOUCH_MINOR,
    ABS_MT_POSITION_X,
    ABS_MT_POSITION_Y,
    ABS_MT_TOOL_TYPE,
    ABS_MT_TRACKING_ID,
    ABS_MT_DISTANCE,
)
"""Codes whose values are kept for every slot."""


@dataclass(frozen=True)
class Axis:
    """One axis as the driver describes it; `resolution` is in units per mm, 0 if unknown."""

    low: int
    high: int
    resolution: int = 0

    @property
    def length(self) -> float | None:
        """m, length of the surface along this axis; None if the driver does not report it."""
        if self.resolution <= 0 or self.high <= self.low:
            return None
        return (self.high - self.low) / self.resolution / 1000.0

    def fraction(self, value: int) -> float:
        """Position of a value on the axis, 0 to 1."""
        return min(max((value - self.low) / max(self.high - self.low, 1), 0.0), 1.0)


@dataclass
class Slots:
    """Current values of a device's slots, by slot and code, and the currently selected slot."""

    values: dict[int, dict[int, int]] = field(default_factory=dict)
    current: int = 0


class MultiTouch:
    """Follows the slots of a device.

    Args:
        x: Horizontal axis.
        y: Vertical axis.
        size: (2,) m, size of the surface, which the axes span.
        state: Initial values of the slots. Without them, fingers that rest on the device when it is
            opened are missed.
        diameter: Axis of the contacts' diameters; its resolution is that of `x` where the driver
            reports none.

    Attributes:
        lost: Events were lost; frames count again after `resync`.
        dropped: Number of times that events were lost.
    """

    def __init__(
        self,
        x: Axis,
        y: Axis,
        size: tuple[float, float],
        state: Slots | None = None,
        diameter: Axis | None = None,
    ) -> None:
        self._x, self._y, self._size = x, y, size
        # The kernel's document gives diameters in units of the surface, unless they have their own.
        self._metres = (
            0.001 / diameter.resolution
            if diameter is not None and diameter.resolution > 0
            else size[0] / max(x.high - x.low, 1)
        )
        self._slots = state or Slots()
        self._skipping = False
        self.lost = False
        self.dropped = 0

    def feed(self, kind: int, code: int, value: int) -> bool:
        """Takes one event in; True if it ends a complete frame."""
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
        """The fingers on the surface, without palms and hovering fingers."""
        contacts: dict[int, Contact] = {}
        for _, slot in sorted(self._slots.values.items()):
            id_ = slot.get(ABS_MT_TRACKING_ID, -1)
            if not _is_finger(slot) or id_ in contacts:
                continue
            x = self._x.fraction(slot.get(ABS_MT_POSITION_X, self._x.low)) * self._size[0]
            y = self._y.fraction(slot.get(ABS_MT_POSITION_Y, self._y.low)) * self._size[1]
            major, minor = slot.get(ABS_MT_TOUCH_MAJOR, 0), slot.get(ABS_MT_TOUCH_MINOR, 0)
            size = extent = None
            if major > 0:
                size = major * self._metres
                # A driver without the smaller diameter reports round contacts; the larger one lies
                # along y unless the driver reports another orientation.
                extent = (minor * self._metres if minor > 0 else size), size
            contacts[id_] = Contact(id_, x, y, size, extent=extent)
        return tuple(contacts.values())

    def palms(self) -> frozenset[int]:
        """Ids of contacts that turned out to be palms, which count as cancelled."""
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
