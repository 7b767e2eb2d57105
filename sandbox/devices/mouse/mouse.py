"""The mouse as a touch device: one pointer puts down, opens, turns and moves a whole hand.

A mouse has only one pointer, so fingers can be *pinned*: they stay on the surface when the button
is released. The window converts pixels to metres on the surface and calls the methods of
`MouseDevice`; the frames are the same as those of a tablet.
"""

from __future__ import annotations

import threading
import time
from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import cos, sin

import numpy as np
from numpy.typing import ArrayLike

from models.arithmetic import Array, length, small_product, squared_lengths
from models.errors import InputError
from models.frames import FINGERS, Contact, TouchFrame
from models.kinematics import Kinematics
from models.person import Person, PersonFrame
from models.pose import POSE_SIZE
from models.skeleton import ADULT
from models.surface import Surface
from sandbox.devices.device import Device

GRAB_RADIUS = 0.010
"""Radius (m) around a pinned finger in which a click grabs it."""
OPENING = 0.075
"""Distance (m) between thumb and centre of the other fingers, when a hand is put down. It is wide
enough for a 5 cm box between two fingertips, and comfortable for an adult hand."""
FINGER_BREADTH = 0.019
"""Distance (m) between adjacent fingertips: an adult's finger is 16 to 20 mm wide."""
WHEEL_FACTOR = 1.03
"""Factor on the opening for one step of the wheel; at 75 mm, about 2 mm."""
WHEEL_TURN = np.deg2rad(3.0)
"""Turn (rad) of the hand for one step of the wheel."""
NARROWEST, WIDEST = 0.008, 0.200
"""Limits (m) of the opening."""
PENDING = 4096
"""Largest number of frames that wait for the session, about those of a minute of moving. If there
are more, the oldest are dropped."""


@dataclass
class _Finger:
    """A finger on the surface."""

    xy: Array
    label: int | None
    pinned: bool


class MouseDevice(Device):
    """The mouse in the window, as one finger or a whole hand. Safe to use from two threads.

    Positions are metres on the surface, x right and y down. A press outside the surface is ignored;
    a finger dragged over the border stays at the border, as at the edge of a tablet.

    Args:
        surface: The touch surface.
        person: Side and seat of the hand that the keys put down; its size is ignored.

    Attributes:
        surface: As given.
        frame_ready: Event that is set when a frame has arrived.
    """

    name = "mouse"
    frame_ready: threading.Event

    def __init__(self, surface: Surface, person: Person | None = None) -> None:
        self.surface = surface
        self._size = surface.size
        self._person = PersonFrame(replace(person or Person(), hand_size=1.0), surface)
        self._lock = threading.Lock()
        self._frames: deque[TouchFrame] = deque(maxlen=PENDING)
        self._fingers: dict[int, _Finger] = {}
        self._next_id = 0
        self._held: tuple[int, ...] = ()
        self._last = np.zeros(2)
        self._is_hand = False
        self.frame_ready = threading.Event()

    @property
    def pins(self) -> int:
        """Number of pinned fingers, which stay down without a button."""
        with self._lock:
            return sum(f.pinned for f in self._fingers.values())  # any order: whole numbers

    def poll(self, now: float) -> Sequence[TouchFrame]:
        """Returns a frame for each change since the last call, with monotonic clock times."""
        with self._lock:
            self.frame_ready.clear()
            frames = list(self._frames)
            self._frames.clear()
            return frames

    def close(self) -> None:
        """Lifts all fingers; may be called twice."""
        self.lift_fingers()
        super().close()

    def press(self, xy: ArrayLike, pin: bool = False, together: bool = False) -> None:
        """Presses the button: grabs a pinned finger at this place, else puts down a finger.

        If the pinned fingers are a hand (`hand`), a press beside them grabs all of them.

        Args:
            xy: (2,) m, position of the pointer.
            pin: Pins the new finger; if a pinned finger is at the place, lifts it instead.
            together: Grabs all pinned fingers, wherever the press is.
        """
        place = np.asarray(xy, float)
        with self._lock:
            if self._release():
                # The event of the button's release was lost.
                self._emit()
            self._last = place
            pins = [i for i, f in self._fingers.items() if f.pinned]
            near = self._nearest(pins, place)
            if pins and together:
                self._held = tuple(pins)
            elif near is not None and pin:
                del self._fingers[near]
                self._emit()
            elif near is not None:
                self._held = (near,)
            elif self._is_hand and not pin:
                self._held = tuple(pins)
            elif np.all(place >= 0.0) and np.all(place <= self._size):
                self._held = (self._put(place, None, pin),)
                self._is_hand = False
                self._emit()

    def move(self, xy: ArrayLike) -> None:
        """Moves the pointer to `xy` (2,) m, together with the fingers that the button holds."""
        place = np.asarray(xy, float)
        with self._lock:
            step, self._last = place - self._last, place
            if not self._held:
                return
            if len(self._held) == 1 and not self._fingers[self._held[0]].pinned:
                # The finger stays at the border while the pointer is outside, and then returns to
                # the pointer.
                self._fingers[self._held[0]].xy = np.clip(place, 0.0, self._size)
            else:
                self._shift(step)
            self._emit()

    def release(self) -> None:
        """Releases the button: pinned fingers stay, a finger that is not pinned is lifted."""
        with self._lock:
            if self._release():
                self._emit()

    def wheel(self, steps: float, turn: bool = False) -> None:
        """Opens (steps above 0) or closes the pinned fingers, or turns them about their centre.

        A thumb closes against all other fingers together; unlabelled fingers close evenly.

        Args:
            steps: Steps of the wheel; touch pads give fractions.
            turn: Turns the fingers instead, counterclockwise for steps above 0, as seen by the
                person.
        """
        with self._lock:
            pins = [f for f in self._fingers.values() if f.pinned]
            if len(pins) < 2 or not np.isfinite(steps):
                return
            groups = _opposing(pins)
            means = np.array([np.mean([f.xy for f in g], axis=0) for g in groups])
            middle = means.mean(axis=0)
            if turn:
                # y points down on the surface, which reverses the sense of rotation.
                angle = -WHEEL_TURN * steps
                c, s = cos(angle), sin(angle)
                rotation = np.array([[c, -s], [s, c]])
                targets = [middle + small_product(rotation, f.xy - middle) for f in pins]
            else:
                width = 2.0 * float(np.sqrt(squared_lengths(means - middle)).max())
                goal = np.clip(width * WHEEL_FACTOR**steps, NARROWEST, WIDEST)
                factor = goal / width if width > 0.0 else 1.0
                shifts = (factor - 1.0) * (means - middle)
                of = {id(f): shift for g, shift in zip(groups, shifts, strict=True) for f in g}
                targets = [f.xy + of[id(f)] for f in pins]
            for finger, target in zip(pins, targets, strict=True):
                finger.xy = np.clip(target, 0.0, self._size)
            self._emit()

    def hand(self, fingers: int, xy: ArrayLike) -> None:
        """Puts down a hand with a number of fingers at a place, or lifts the present one.

        The same number again lifts the hand; another number replaces it.

        Args:
            fingers: Number of fingers, 1 to 5. One is the index finger; two or more include the
                thumb.
            xy: (2,) m, midpoint between the thumb and the other fingers. It is shifted so that all
                fingers are on the surface.

        Raises:
            InputError: The number of fingers is not 1 to 5.
        """
        if fingers not in range(1, len(FINGERS) + 1):
            raise InputError("a hand has 1 to 5 fingers", got=fingers, expected="1 to 5")
        with self._lock:
            pinned = [f for f in self._fingers.values() if f.pinned]
            there = self._is_hand and len(pinned) == fingers
            self._fingers.clear()
            self._held = ()
            self._is_hand = False
            if not there:
                layout = default_hand(fingers)
                steps = self._person.outward_steps(list(layout.values()))
                places = np.asarray(xy, float) + steps
                places += np.maximum(-places.min(axis=0), 0.0)
                places -= np.maximum(places.max(axis=0) - self._size, 0.0)
                for label, place in zip(layout, places, strict=True):
                    self._put(np.clip(place, 0.0, self._size), label, True)
                self._is_hand = True
            self._emit()

    def lift_fingers(self) -> None:
        """Lifts all fingers."""
        with self._lock:
            self._held = ()
            self._is_hand = False
            if self._fingers:
                self._fingers.clear()
                self._emit()

    def _put(self, place: Array, label: int | None, pinned: bool) -> int:
        self._fingers[self._next_id] = _Finger(place, label, pinned)
        self._next_id += 1
        return self._next_id - 1

    def _release(self) -> bool:
        """Releases the held fingers; returns True if a finger was lifted."""
        lifted = [i for i in self._held if not self._fingers[i].pinned]
        for i in lifted:
            del self._fingers[i]
        self._held = ()
        return bool(lifted)

    def _nearest(self, pins: list[int], place: Array) -> int | None:
        off = {i: length(self._fingers[i].xy - place) for i in pins}
        near = min(off, key=lambda i: off[i], default=None)
        return near if near is not None and off[near] <= GRAB_RADIUS else None

    def _shift(self, step: Array) -> None:
        """Moves all held fingers by the same step, shortened so that all stay on the surface."""
        places = np.array([self._fingers[i].xy for i in self._held])
        step = np.clip(step, -places.min(axis=0), self._size - places.max(axis=0))
        for i in self._held:
            self._fingers[i].xy = self._fingers[i].xy + step

    def _emit(self) -> None:
        contacts = tuple(
            Contact(i, float(f.xy[0]), float(f.xy[1]), label=f.label)
            for i, f in self._fingers.items()
        )
        self._frames.append(TouchFrame(time.monotonic(), contacts, source=self.name))
        self.frame_ready.set()


def default_hand(fingers: int) -> dict[int, Array]:
    """Returns the positions of the fingertips of a hand about to grip, by label.

    The fingers are side by side, as on the face of a box. The thumb is opposite to them, in the
    direction in which it opposes the index finger in the skeleton's reference pose.

    Returns:
        (2,) m each, x right and y down, from the midpoint between the thumb and the other fingers.
        For one finger: the index finger at zero.
    """
    if fingers == 1:
        return {1: np.zeros(2)}
    tips = Kinematics(ADULT).tips(np.zeros(POSE_SIZE))[:, :2] * np.array([1.0, -1.0])
    across = (tips[1] - tips[0]) / length(tips[1] - tips[0])
    # From the index finger towards the little finger.
    aside = np.array([-across[1], across[0]])
    order = np.arange(1, fingers)
    places = OPENING / 2 * across + np.outer(order - order.mean(), FINGER_BREADTH * aside)
    return {0: -OPENING / 2 * across} | dict(zip(order.tolist(), places, strict=True))


def _opposing(fingers: list[_Finger]) -> list[list[_Finger]]:
    """Groups fingers that move against each other: thumb and other fingers; without a single
    thumb, every finger by itself."""
    thumbs = [f for f in fingers if f.label == 0]
    if len(thumbs) == 1:
        return [thumbs, [f for f in fingers if f.label != 0]]
    return [[f] for f in fingers]
