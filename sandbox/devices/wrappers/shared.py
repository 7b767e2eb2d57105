"""One device for two hands: its frames are divided into those of two devices, one for each hand.

`Split` is the rule by which frames are divided: for a screen by the positions of the hands
(`SplitByPlace`), for a Leap by their sides (`sandbox.devices.leap.two_hands`). Frames of a camera
or a headset go to both hands, and each rig uses the hand of its own side. `MergedUsers` is the
opposite: the frames of two simulated users become those of one device.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

from numpy.typing import ArrayLike

from encoders.labels.hand_split import HandSplitter
from models.frames import TouchFrame
from sandbox.devices.device import AnyDevice, Device, DeviceWrapper
from sandbox.session.messages import Snapshot

MOST_WAITING = 600
"""Largest number of frames that wait for a hand."""


class Split:
    """Base class: how the frames of a device are divided between two hands. Here both get all.

    Attributes:
        at_every_poll: True polls the device at every poll of a hand; False polls it once for both
            hands.
    """

    at_every_poll = False

    def divide(self, frame: Any, now: float) -> tuple[Any, Any]:
        """Returns the parts of a frame for the two hands.

        Args:
            frame: A frame of the device.
            now: Session time, s.
        """
        return frame, frame

    def resting(self) -> Sequence[Any]:
        """Returns frames to use if the device has no new ones; none by default."""
        return ()

    def notices(self, now: float) -> Sequence[str] | None:
        """Returns messages for the person; None if the device's messages are to be shown."""
        return None


class SplitByPlace(Split):
    """Assigns contacts on one surface to two hands.

    Args:
        homes: (2, 2) m on the surface, initial expected position of each hand.

    Attributes:
        splitter: Assigns contacts to hands.
    """

    def __init__(self, homes: ArrayLike) -> None:
        self.splitter = HandSplitter(homes)
        self._last: TouchFrame | None = None

    def divide(self, frame: TouchFrame, now: float) -> tuple[TouchFrame, TouchFrame]:
        """Returns a frame with the contacts of each hand, at session time."""
        self._last = frame
        first, second = self.splitter.step(replace(frame, time=now))
        return first, second

    def resting(self) -> Sequence[TouchFrame]:
        """Returns the last frame again, since a device sends no frames while fingers rest."""
        return () if self._last is None else (replace(self._last, cancelled=frozenset()),)


class SharedDevice:
    """A device whose frames are for two hands.

    Args:
        device: The device.
        split: Rule by which the frames are divided.

    Attributes:
        device: As given.
        split: As given.
        parts: A device for each hand. Poll them at the same times.
    """

    def __init__(self, device: AnyDevice, split: Split) -> None:
        self.device, self.split = device, split
        self.parts = (SharedPart(self, 0), SharedPart(self, 1))
        self._now = -1.0

    def fetch(self, now: float) -> None:
        """Polls the device and divides its frames."""
        if now <= self._now and not self.split.at_every_poll:
            return
        self._now = now
        frames = self.device.poll(now)
        if not frames and not self.device.finished:
            frames = self.split.resting()
        for frame in frames:
            for part, own in zip(self.parts, self.split.divide(frame, now), strict=True):
                part.waiting.append(own)


class SharedPart(DeviceWrapper):
    """One hand's part of a shared device.

    Snapshots and messages that concern both hands pass through the first hand only.

    Args:
        shared: The shared device.
        hand: Index of the hand, 0 or 1.
    """

    def __init__(self, shared: SharedDevice, hand: int) -> None:
        super().__init__(shared.device)
        self._shared, self._first = shared, hand == 0
        self.waiting: deque[Any] = deque(maxlen=MOST_WAITING)
        self._now = 0.0

    def poll(self, now: float) -> Sequence[Any]:
        """Returns this hand's frames since the last call."""
        self._now = now
        self._shared.fetch(now)
        frames = tuple(self.waiting)
        self.waiting.clear()
        return frames

    @property
    def finished(self) -> bool:
        """True when no further frame can arrive for this hand."""
        return self.device.finished and not self.waiting

    @property
    def takes_snapshots(self) -> bool:
        """The device's value for the first hand, else False, so that it gets each snapshot once."""
        return self._first and self.device.takes_snapshots

    @property
    def notices(self) -> Sequence[str]:
        """Messages of `split`, or else those of the device, which only the first hand has."""
        own = self._shared.split.notices(self._now)
        if own is not None:
            return own
        return self.device.notices if self._first else ()

    @property
    def address(self) -> str:
        """Address of the device, for the first hand only."""
        return self.device.address if self._first else ""

    @property
    def damage(self) -> Exception | None:
        """Damage of the device, for the first hand only."""
        return self.device.damage if self._first else None


class MergedUsers(Device):
    """Two simulated users with one device, such as a screen that both touch.

    Args:
        devices: A device for each user.
    """

    name: str
    lift = True
    takes_snapshots = True
    clock_origin: float | None = None
    parts: tuple[AnyDevice, ...]

    def __init__(self, devices: Sequence[AnyDevice]) -> None:
        self.parts = tuple(devices)
        self.name = devices[0].name

    @property
    def finished(self) -> bool:
        """True when no further frame can arrive from either device."""
        return all(device.finished for device in self.parts)

    def show(self, snapshot: Snapshot) -> None:
        """Passes the snapshot to each device."""
        for device in self.parts:
            device.show(snapshot)

    def close(self) -> None:
        """Closes both devices."""
        for device in self.parts:
            device.close()


class MergedTouches(MergedUsers):
    """Two simulated users at one screen.

    They share one lift control; the lower of their two values counts.

    Args:
        devices: Two devices of one hand each.
    """

    def __init__(self, devices: Sequence[AnyDevice]) -> None:
        super().__init__(devices)
        self._latest = [TouchFrame(0.0), TouchFrame(0.0)]

    def poll(self, now: float) -> Sequence[TouchFrame]:
        """Returns a frame with all contacts; ids are interleaved, so as not to reveal the hand."""
        cancelled: set[int] = set()
        for k, device in enumerate(self.parts):
            for frame in device.poll(now):
                assert isinstance(frame, TouchFrame)
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

    def show(self, snapshot: Snapshot) -> None:
        """Passes the snapshot to each device, with only its own touches and their original ids."""
        for k, device in enumerate(self.parts):
            hands = tuple(
                replace(
                    hand,
                    contacts=tuple(
                        replace(c, id=c.id // 2) for c in hand.contacts if c.id % 2 == k
                    ),
                )
                for hand in snapshot.hands
            )
            device.show(snapshot.with_hands(*hands))


def _id(own: int, device: int) -> int:
    return 2 * own + device
