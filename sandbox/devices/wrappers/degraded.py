"""Wrapper that degrades a device's touches: noise, drop-outs, ghost touches and latency."""

from __future__ import annotations

from collections import deque
from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from models.arithmetic import Array
from models.frames import Contact, TouchFrame
from models.surface import Surface
from sandbox.devices.device import Device, DeviceWrapper
from sandbox.session.messages import Snapshot
from tasks.variation import Variation

LENGTH = 0.1
"""Duration (s) of a drop-out."""

_FIRST_ID = 1_000_000
"""First id of touches that return after a drop-out on a simulated screen."""


class DropOuts:
    """Drop-outs: touches are lost at random, and return with new ids.

    Args:
        rate: 1/s, rate at which each touch is lost.
        seed: Seed of the random drop-outs.
        first: First id of touches that return; no other touches may have such ids.

    Attributes:
        given: For every touch that returned: new id -> the device's id.
    """

    def __init__(self, rate: float, seed: int, first: int = _FIRST_ID) -> None:
        self._rate = rate
        self._rng = np.random.default_rng([seed, 7_003])
        self._alias: dict[int, int] = {}
        self._back_at: dict[int, float] = {}
        self.given: dict[int, int] = {}
        self._next = first
        self._time = 0.0

    @property
    def loses(self) -> bool:
        """True if touches may be lost. If False, ids never change."""
        return self._rate > 0.0

    def degrade(self, frame: TouchFrame) -> TouchFrame:
        """Returns the frame with drop-outs."""
        dt, self._time = frame.time - self._time, frame.time
        if self._rate <= 0.0:
            return frame
        contacts = []
        for contact in frame.contacts:
            own = contact.id
            if own in self._back_at:
                if frame.time < self._back_at[own]:
                    continue
                del self._back_at[own]
                self._alias[own] = self._next
                self.given[self._next] = own
                self._next += 1
            elif self._rng.random() < self._rate * dt:
                self._back_at[own] = frame.time + LENGTH
                continue
            contacts.append(replace(contact, id=self._alias.get(own, own)))
        cancelled = frozenset(self._alias.get(own, own) for own in frame.cancelled)
        return replace(frame, contacts=tuple(contacts), cancelled=cancelled)

    def own_id(self, reported: int) -> int:
        """Returns the device's id for a reported id."""
        return self.given.get(reported, reported)


GHOST_LENGTH = 0.1
"""Duration (s) of a ghost touch, equal to that of a drop-out."""
FIRST_RETURNED = 1_000_000_000
"""First id of touches that return after a drop-out; ids of a simulated screen are lower."""
FIRST_GHOST = 2_000_000_000
"""First id of ghost touches."""

_SLACK = 1e-9
"""Tolerance (s) of times, which are sums of control periods."""


class Noise:
    """White noise on the coordinates of touches.

    Args:
        deviation: m, standard deviation of either coordinate.
        seed: Seed of the noise.
    """

    def __init__(self, deviation: float, seed: int) -> None:
        self._deviation = deviation
        self._rng = np.random.default_rng([seed, 7_006])

    def degrade(self, frame: TouchFrame) -> TouchFrame:
        """Returns the frame with noise on every contact."""
        shifts = self._deviation * self._rng.standard_normal((len(frame.contacts), 2))
        contacts = tuple(
            replace(c, x=c.x + float(dx), y=c.y + float(dy))
            for c, (dx, dy) in zip(frame.contacts, shifts, strict=True)
        )
        return replace(frame, contacts=contacts)


class Ghosts:
    """Ghost touches: touches without a finger, at random positions on the surface.

    Args:
        rate: 1/s, mean number of new ghost touches.
        size: (2,) m, size of the surface.
        seed: Seed of the ghosts' times and positions.
    """

    def __init__(self, rate: float, size: Array, seed: int) -> None:
        self._rate, self._size = rate, size
        self._rng = np.random.default_rng([seed, 7_007])
        self._alive: dict[int, tuple[Contact, float]] = {}
        self._next = FIRST_GHOST
        self._time = 0.0

    def degrade(self, frame: TouchFrame) -> TouchFrame:
        """Returns the frame with ghost touches after its own contacts."""
        dt, self._time = frame.time - self._time, frame.time
        for _ in range(self._rng.poisson(self._rate * max(dt, 0.0))):
            x, y = (self._rng.uniform(0.0, 1.0, 2) * self._size).tolist()
            self._alive[self._next] = Contact(self._next, x, y), frame.time + GHOST_LENGTH
            self._next += 1
        # If the device itself uses such an id, its touch replaces the ghost.
        taken = {c.id for c in frame.contacts} | frame.cancelled
        self._alive = {
            i: (contact, until)
            for i, (contact, until) in self._alive.items()
            if frame.time < until - _SLACK and i not in taken
        }
        ghosts = tuple(contact for contact, _ in self._alive.values())
        return replace(frame, contacts=frame.contacts + ghosts)


class DegradedDevice(DeviceWrapper):
    """Wrapper that degrades a device's touches by a variation; frames get session time.

    A touch that returns after a drop-out has a new id, but the same true finger. Drop-outs and
    ghosts begin and end even while the device sends no frames, as with resting fingers.

    Args:
        device: The device to degrade.
        variation: Noise, drop-outs, ghost touches and latency.
        surface: Surface on which ghost touches appear.
        seed: Seed of all random numbers.
    """

    def __init__(self, device: Device, variation: Variation, surface: Surface, seed: int) -> None:
        super().__init__(device)
        self._noise = Noise(variation.noise, seed)
        self._drop_outs = DropOuts(variation.dropped, seed, FIRST_RETURNED)
        self._ghosts = Ghosts(variation.ghosts, surface.size, seed)
        self._latency = variation.latency
        self._goes_on = variation.dropped > 0.0 or variation.ghosts > 0.0
        self._last = TouchFrame(0.0)
        self._on_the_way: deque[tuple[float, TouchFrame]] = deque()

    def poll(self, now: float) -> Sequence[TouchFrame]:
        """Returns the frames whose latency has passed."""
        frames = [self._noise.degrade(replace(f, time=now)) for f in super().poll(now)]
        if not frames and self._goes_on and not self.device.finished:
            frames = [replace(self._last, time=now, cancelled=frozenset())]
        for frame in frames:
            self._last = frame
            frame = self._ghosts.degrade(self._drop_outs.degrade(frame))
            self._on_the_way.append((now + self._latency, frame))
        arrived = []
        while self._on_the_way and self._on_the_way[0][0] <= now + _SLACK:
            arrived.append(replace(self._on_the_way.popleft()[1], time=now))
        return arrived

    @property
    def clock_origin(self) -> None:
        """Frames carry session time."""
        return None

    @property
    def true_labels(self) -> Mapping[int, int]:
        """True labels of the wrapped device, including those of touches with new ids."""
        own = self.device.true_labels
        again = {new: own[i] for new, i in self._drop_outs.given.items() if i in own}
        return {**own, **again}

    def show(self, snapshot: Snapshot) -> None:
        """Passes the snapshot, with the device's ids of touches, to a device that needs it."""
        if not self.device.takes_snapshots:
            return
        hands = tuple(
            replace(
                hand,
                contacts=tuple(
                    replace(c, id=self._drop_outs.own_id(c.id))
                    for c in hand.contacts
                    if c.id < FIRST_GHOST
                ),
            )
            for hand in snapshot.hands
        )
        self.device.show(snapshot.with_hands(*hands))

    @property
    def finished(self) -> bool:
        """True when no further frame can arrive, and none is delayed."""
        return self.device.finished and not self._on_the_way

    def close(self) -> None:
        """Closes the wrapped device; delayed frames are lost."""
        super().close()
        self._on_the_way.clear()
