"""Wrappers around the device with which a person plays in a window.

Two keys act as a lift control (`LiftKeys`). The mouse and the fingers on a page become one device
(`MergedDevice`). A trial begins with the first touch (`FirstTouch`), so that the person can look at
the scene before.
"""

from __future__ import annotations

import threading
from collections.abc import Sequence
from dataclasses import replace

from models.frames import Contact, TouchFrame
from sandbox.devices.device import Device, DeviceWrapper

SPEED = 0.45
"""Speed of the lift while a key is held, as a share of its range per second (1/s)."""


class LiftKeys(DeviceWrapper):
    """Wrapper that adds a lift control to a device. Safe to use from two threads.

    Args:
        device: Source of the touches.
        leader: Wrapper whose lift this one copies, since the same keys lift two hands; None for
            the first hand.
    """

    lift = True

    def __init__(self, device: Device, leader: LiftKeys | None = None) -> None:
        super().__init__(device)
        self._leader = leader
        self._lock = threading.Lock()
        self._direction = 0.0
        self._tapped = 0.0
        self._lift = 0.0
        self._now = 0.0
        self._last = TouchFrame(0.0)

    def hold(self, direction: float) -> None:
        """Sets the held key: 1 lifts, -1 lowers, 0 means none."""
        with self._lock:
            self._direction = direction
            # A key that is pressed and released between two polls still has an effect.
            self._tapped = direction or self._tapped

    def follow(self, lift: float) -> None:
        """Sets the lift to that of another control, without a frame; keys continue from it."""
        with self._lock:
            self._lift = lift

    def poll(self, now: float) -> Sequence[TouchFrame]:
        """Returns the device's frames with the lift; repeats a frame if only the lift changed."""
        with self._lock:
            direction, self._tapped = self._direction or self._tapped, 0.0
        passed, self._now = max(now - self._now, 0.0), now
        before = self._lift
        self._lift = min(max(before + direction * SPEED * passed, 0.0), 1.0)
        if self._leader is not None:
            self._lift = self._leader._lift
        over = self.device.finished
        frames = [replace(frame, lift=self._lift) for frame in super().poll(now)]
        if not frames and self._lift != before and not over:
            frames = [replace(self._last, lift=self._lift, cancelled=frozenset())]
        if frames:
            self._last = frames[-1]
        return frames


FAR = 2**30
"""First new id if the ids of one device are preserved; ids of a page are lower."""


class MergedDevice(Device):
    """Merges the touches of several devices on one surface, with distinct ids.

    Args:
        devices: The devices; frames keep the times of their own clocks.
        kept: Index of the device whose ids are preserved, such as a page, which identifies its
            touches by them; None if the touches of all devices get new ids.

    Attributes:
        parts: The devices.
        lift: True if any device has a lift control. The control that was moved last counts.
        frame_ready: Event that is set when a device with such an event has a frame.
        lifted: Lift of the last frame; None before a control was moved.
    """

    name: str
    lift: bool
    parts: tuple[Device, ...]

    def __init__(self, devices: Sequence[Device], kept: int | None = None) -> None:
        self.parts = tuple(devices)
        self._kept = kept
        self.name = "+".join(device.name for device in devices)
        self.lift = any(device.lift for device in devices)
        self.frame_ready = threading.Event()
        for device in devices:
            if device.frame_ready is not None:
                device.frame_ready = self.frame_ready
        self.lifted: float | None = None
        self._lifts: list[float | None] = [None] * len(devices)
        self._contacts: list[tuple[Contact, ...]] = [()] * len(devices)
        self._ids: list[dict[int, int]] = [{} for _ in devices]
        self._next = 0 if kept is None else FAR

    @property
    def finished(self) -> bool:
        """True when all devices have ended."""
        return all(device.finished for device in self.parts)

    @property
    def clock_origin(self) -> float | None:
        """The common value of all devices; None if they differ."""
        origins = {device.clock_origin for device in self.parts}
        return origins.pop() if len(origins) == 1 else None

    def poll(self, now: float) -> Sequence[TouchFrame]:
        """Returns a frame for each frame of any device, with the contacts of all devices."""
        frames = [
            (frame.time, i, frame)
            for i, device in enumerate(self.parts)
            for frame in device.poll(now)
        ]
        frames.sort(key=lambda entry: entry[0])
        return [self._merged(i, frame) for _, i, frame in frames]

    def close(self) -> None:
        """Closes all devices."""
        for device in self.parts:
            device.close()

    def _merged(self, i: int, frame: TouchFrame) -> TouchFrame:
        known, ids = self._ids[i], {}
        for contact in frame.contacts:
            ids[contact.id] = known[contact.id] if contact.id in known else self._new(i, contact.id)
        self._ids[i] = ids
        self._contacts[i] = tuple(replace(c, id=ids[c.id]) for c in frame.contacts)
        if frame.lift is not None and frame.lift != self._lifts[i]:
            self._move_lift(i, frame.lift)
        return replace(
            frame,
            contacts=tuple(contact for contacts in self._contacts for contact in contacts),
            lift=self.lifted,
            cancelled=frozenset(known[c] for c in frame.cancelled if c in known and c not in ids),
        )

    def _move_lift(self, i: int, lift: float) -> None:
        first, self._lifts[i] = self._lifts[i] is None, lift
        if first and self.lifted is not None and lift == 0.0:
            # A first value of 0 is the start of a control, not a movement.
            return
        self.lifted = lift
        for k, other in enumerate(self.parts):
            if k != i and isinstance(other, LiftKeys):
                other.follow(lift)
                self._lifts[k] = lift

    def _new(self, i: int, own: int) -> int:
        """Returns an id for a new contact, whose id on device `i` is `own`."""
        used = {id_ for ids in self._ids for id_ in ids.values()}
        if i == self._kept and own not in used:
            return own
        while self._next in used:
            self._next += 1
        self._next += 1
        return self._next - 1


class FirstTouch(DeviceWrapper):
    """Wrapper that waits for the first touch while the session is paused.

    Frames before the first touch are dropped: the session receives frames from the first touch on.

    Args:
        device: Device of a person.
    """

    def __init__(self, device: Device) -> None:
        super().__init__(device)
        self._kept: list[TouchFrame] = []
        self._came = False

    def came(self) -> bool:
        """Returns True after the first touch or the end of the device.

        Before, it polls the device, so the session must not call `poll`.
        """
        if not self._came and not self.device.finished:
            frames = list(super().poll(0.0))
            touched = [n for n, frame in enumerate(frames) if frame.contacts]
            if touched:
                self._kept = frames[touched[0] :]
                self._came = True
        return self._came or self.device.finished

    def poll(self, now: float) -> Sequence[TouchFrame]:
        """Returns the device's frames, from that of the first touch on."""
        kept, self._kept, self._came = self._kept, [], True
        return [*kept, *super().poll(now)]
