"""A Leap shared by two hands: each hand of the scene receives the frames of its own side."""

from __future__ import annotations

from collections import Counter, deque
from collections.abc import Sequence
from dataclasses import replace
from math import inf

from encoders.paalm.hand_reconstructor import NOTICE_LASTS
from encoders.paalm.palm import stacked
from encoders.paalm.sides import HandSides
from models.frames import HandFrame
from models.message import Message
from sandbox.devices.device import HandDevice
from sandbox.session.messages import Snapshot

KEPT = 600
"""Largest number of frames that wait for a hand, as in `sandbox.devices.leap.leap`."""


class SharedLeap:
    """Splits the hands of a device by side.

    If one hand is above the other, both are removed from the frame, as the device cannot tell their
    fingers apart.

    Args:
        device: Device that sees both hands.
        sides: Sides of the scene's hands, one `right` and one `left`.

    Attributes:
        parts: A device for each hand, in the order of the sides.
        counts: Number of frames in which one hand was above the other.
        hidden: s, time of the last such frame; minus infinity without one.
    """

    def __init__(self, device: HandDevice, sides: tuple[str, str]) -> None:
        self.device = device
        self.counts: Counter[str] = Counter()
        self.hidden = -inf
        self._choose = HandSides(sides)
        self.parts = tuple(LeapPart(self, i, side) for i, side in enumerate(sides))

    def fetch(self, now: float) -> None:
        """Polls the device, and distributes its frames to both parts."""
        for frame in self.device.poll(now):
            hands = frame.hands
            hidden = any(stacked(a, b) for i, a in enumerate(hands) for b in hands[:i])
            self.counts["one hand above the other"] += hidden
            self.hidden = now if hidden else self.hidden
            chosen = {} if hidden else self._choose.choose(frame)
            for part in self.parts:
                hand = chosen.get(part.side)
                seen = () if hand is None else (replace(hand, side=part.side),)
                part.waiting.append(replace(frame, hands=seen))


class LeapPart(HandDevice):
    """The frames of one hand of a shared Leap.

    Args:
        shared: The shared Leap.
        index: Index of the hand in the scene.
        side: Side of the hand.
    """

    name: str
    lift = True

    def __init__(self, shared: SharedLeap, index: int, side: str) -> None:
        self._shared, self.side = shared, side
        self.name = f"{shared.device.name}, {side} hand"
        self.waiting: deque[HandFrame] = deque(maxlen=KEPT)
        self._first = index == 0
        self._now = 0.0

    @property
    def finished(self) -> bool:
        """True when no further frame can arrive for this hand."""
        return self._shared.device.finished and not self.waiting

    @property
    def wants_snapshots(self) -> bool:
        """The device's for the first hand, else False, so that the device sees snapshots once."""
        return self._first and self._shared.device.wants_snapshots

    def show(self, snapshot: Snapshot) -> None:
        """Passes the snapshot to the device, through the first hand only."""
        if self._first:
            self._shared.device.show(snapshot)

    @property
    def notices(self) -> Sequence[str]:
        """A message while one hand is above the other; otherwise the device's, once for all
        hands.
        """
        if self._now - self._shared.hidden >= NOTICE_LASTS:
            return self._shared.device.notices if self._first else ()
        return (Message("hand_above", "one hand is above the other: hold them apart"),)

    def poll(self, now: float) -> Sequence[HandFrame]:
        """This hand's frames."""
        self._now = now
        self._shared.fetch(now)
        frames = tuple(self.waiting)
        self.waiting.clear()
        return frames

    def close(self) -> None:
        """Closes the device."""
        self._shared.device.close()


class MergedLeap(HandDevice):
    """Merges two devices into one that sees both hands: two simulated people over one Leap.

    Args:
        devices: Two devices that return frames of the same times.
    """

    name = "simulated leap"
    lift = True
    wants_snapshots = True
    parts: tuple[HandDevice, ...]

    def __init__(self, devices: Sequence[HandDevice]) -> None:
        self.parts = tuple(devices)

    @property
    def finished(self) -> bool:
        """True if either device has ended."""
        return any(d.finished for d in self.parts)

    def show(self, snapshot: Snapshot) -> None:
        """Passes the snapshot to both devices."""
        for device in self.parts:
            device.show(snapshot)

    def poll(self, now: float) -> Sequence[HandFrame]:
        """Frames with the hands of both devices, with distinct ids."""
        return [
            replace(
                frames[0],
                hands=tuple(
                    replace(h, id=2 * h.id + i) for i, f in enumerate(frames) for h in f.hands
                ),
            )
            for frames in zip(*(d.poll(now) for d in self.parts), strict=True)
        ]

    def close(self) -> None:
        """Closes both."""
        for device in self.parts:
            device.close()
