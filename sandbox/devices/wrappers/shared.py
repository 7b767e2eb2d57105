"""Two hands on one surface: its contacts are split between them, and each hand is a device."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from numpy.typing import ArrayLike

from encoders.labels.hand_split import HandSplitter
from models.frames import TouchFrame
from sandbox.devices.wrappers.device_wrapper import DeviceWrapper
from sandbox.session.device import Device
from sandbox.session.messages import Snapshot


class SharedSurface:
    """A device whose contacts belong to two hands.

    Args:
        device: Of the whole surface.
        homes: (2, 2) m on the surface, where each hand is expected at first.

    Attributes:
        device: The same.
        parts: A device for each hand; both see the lift control. Poll them in step.
        splitter: Says which contact belongs to which hand.
    """

    def __init__(self, device: Device, homes: ArrayLike) -> None:
        self.device = device
        self.splitter = HandSplitter(homes)
        self.parts = (OneHand(self, 0), OneHand(self, 1))
        self._waiting: tuple[list[TouchFrame], list[TouchFrame]] = ([], [])
        self._last: TouchFrame | None = None
        self._now = -1.0

    def take(self, hand: int, now: float) -> list[TouchFrame]:
        """Frames of a hand that nobody has taken yet; at s of session time."""
        if now > self._now:
            self._now = now
            frames = self.device.poll(now)
            if not frames and self._last is not None:
                # A finger that rests sends nothing, and gets its hand all the same.
                frames = [replace(self._last, cancelled=frozenset())]
            for frame in frames:
                self._last = frame
                for waiting, part in zip(
                    self._waiting, self.splitter.step(replace(frame, time=now)), strict=True
                ):
                    waiting.append(part)
        taken = list(self._waiting[hand])
        self._waiting[hand].clear()
        return taken


class OneHand(DeviceWrapper):
    """One hand's contacts on a surface that two share.

    Args:
        surface: The whole of it.
        hand: 0 or 1.
    """

    def __init__(self, surface: SharedSurface, hand: int) -> None:
        super().__init__(surface.device)
        self._surface, self._hand = surface, hand

    def poll(self, now: float) -> Sequence[TouchFrame]:
        """This hand's frames since the last call."""
        return self._surface.take(self._hand, now)

    def show(self, snapshot: Snapshot) -> None:
        """Shows a device that looks what there is to see; once, through the first hand."""
        if self._hand == 0:
            self.device.show(snapshot)


class MergedTouches(Device):
    """Two devices that touch the same surface, as one: two simulated users at one screen.

    The surface has one lift control, and two hold it: it is as high as the lower of them wants.

    Args:
        devices: Of one hand each.
    """

    name: str
    has_lift = True
    parts: tuple[Device, ...]

    def __init__(self, devices: tuple[Device, Device]) -> None:
        self.parts = devices
        self._latest = [TouchFrame(0.0), TouchFrame(0.0)]
        self.name = devices[0].name

    def poll(self, now: float) -> Sequence[TouchFrame]:
        """All contacts, with ids that tell nobody's hand by their order."""
        cancelled: set[int] = set()
        for k, device in enumerate(self.parts):
            for frame in device.poll(now):
                self._latest[k] = frame
                cancelled |= {_id(i, k) for i in frame.cancelled}
        contacts = tuple(
            replace(c, id=_id(c.id, k))
            for k, frame in enumerate(self._latest)
            for c in frame.contacts
        )
        lifts = [frame.lift for frame in self._latest if frame.lift is not None]
        gone = frozenset(cancelled - {c.id for c in contacts})
        return [TouchFrame(now, contacts, min(lifts, default=None), gone, "merged")]

    @property
    def looks(self) -> bool:
        """True where one of them looks."""
        return any(device.looks for device in self.parts)

    def show(self, snapshot: Snapshot) -> None:
        """Shows each device what there is to see, with its own ids for its touches."""
        for k, device in enumerate(self.parts):
            if not device.looks:
                continue
            hands = tuple(
                replace(
                    hand,
                    contacts=tuple(
                        replace(c, id=c.id // 2) for c in hand.contacts if c.id % 2 == k
                    ),
                )
                for hand in snapshot.hands
            )
            device.show(replace(snapshot, hands=hands))

    @property
    def finished(self) -> bool:
        """Whether no further frame can come from either."""
        return all(device.finished for device in self.parts)

    def close(self) -> None:
        """Closes both."""
        for device in self.parts:
            device.close()


def _id(own: int, device: int) -> int:
    return 2 * own + device
