"""A surface shared by two hands: its contacts are split, and each hand becomes a device."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from numpy.typing import ArrayLike

from encoders.labels.hand_split import HandSplitter
from models.frames import TouchFrame
from sandbox.devices.device import Device
from sandbox.devices.wrappers.device_wrapper import DeviceWrapper
from sandbox.session.messages import Snapshot


class SharedSurface:
    """Splits a device whose contacts belong to two hands.

    Args:
        device: Device of the whole surface.
        homes: (2, 2) m on the surface, initial expected position of each hand.

    Attributes:
        device: As given.
        parts: A device for each hand, both with the lift control. Poll them at the same times.
        splitter: Assigns contacts to hands.
    """

    def __init__(self, device: Device, homes: ArrayLike) -> None:
        self.device = device
        self.splitter = HandSplitter(homes)
        self.parts = (OneHand(self, 0), OneHand(self, 1))
        self._waiting: tuple[list[TouchFrame], list[TouchFrame]] = ([], [])
        self._last: TouchFrame | None = None
        self._now = -1.0

    def take(self, hand: int, now: float) -> list[TouchFrame]:
        """Frames of a hand since its last call; `now` is session time, s."""
        if now > self._now:
            self._now = now
            frames = self.device.poll(now)
            if not frames and self._last is not None:
                # A resting finger sends no frames, but must still be assigned to its hand.
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
    """The contacts of one hand on a shared surface.

    Args:
        surface: The shared surface.
        hand: Index of the hand, 0 or 1.
    """

    def __init__(self, surface: SharedSurface, hand: int) -> None:
        super().__init__(surface.device)
        self._surface, self._hand = surface, hand

    def poll(self, now: float) -> Sequence[TouchFrame]:
        """This hand's frames since the last call."""
        return self._surface.take(self._hand, now)

    @property
    def clock_origin(self) -> None:
        """Frames carry session time."""
        return None

    def show(self, snapshot: Snapshot) -> None:
        """Passes the snapshot to the device once, through the first hand."""
        if self._hand == 0:
            self.device.show(snapshot)


class MergedTouches(Device):
    """Merges two devices on the same surface into one: two simulated users at one screen.

    Both control the same lift, which takes the lower of their two values.

    Args:
        devices: Two devices of one hand each.
    """

    name: str
    lift = True
    parts: tuple[Device, ...]

    def __init__(self, devices: tuple[Device, Device]) -> None:
        self.parts = devices
        self._latest = [TouchFrame(0.0), TouchFrame(0.0)]
        self.name = devices[0].name

    def poll(self, now: float) -> Sequence[TouchFrame]:
        """All contacts, with interleaved ids, whose order does not reveal the hand."""
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
    def clock_origin(self) -> None:
        """Frames carry session time."""
        return None

    @property
    def wants_snapshots(self) -> bool:
        """True if either device needs snapshots."""
        return any(device.wants_snapshots for device in self.parts)

    def show(self, snapshot: Snapshot) -> None:
        """Passes the snapshot to each device, with the device's own ids of its touches."""
        for k, device in enumerate(self.parts):
            if not device.wants_snapshots:
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
        """True when no further frame can arrive from either device."""
        return all(device.finished for device in self.parts)

    def close(self) -> None:
        """Closes both."""
        for device in self.parts:
            device.close()


def _id(own: int, device: int) -> int:
    return 2 * own + device
