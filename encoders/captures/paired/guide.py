"""Instructions for a person during a paired capture, with progress.

The guide first requests the open hand, for PAALM's calibration. It then requests three taps, which
synchronise the clocks. It then requests every set of two to five fingers, since a set that is
missing in the capture cannot be reconstructed later. A touch device does not report which fingers
touch, so the guide checks only the number of touches.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations

from encoders.captures.paired.hand_track import OPEN_FRAMES, OpenHandSearch, is_whole
from models.frames import FINGERS, HandFrame, LandmarkFrame, TouchFrame

TAPS = 3
APART = 0.15
"""Time (s) without any touch between two taps."""
DOING = "move, open and close, pinch, turn"

SETS: tuple[tuple[int, ...], ...] = tuple(
    chosen for size in range(5, 1, -1) for chosen in combinations(range(len(FINGERS)), size)
)
"""The 26 finger sets. Sets with many fingers come first, since they determine the device's pose
best."""

PICTURES = 20
"""Number of pictures with the hand that are needed before the taps. A camera's pictures, unlike a
Leap's frames, are not used to measure the open hand."""

ROUNDS = 2
"""Number of takes of every set. With a single take, a set could not be held out for testing."""

_MOST_STEP = 0.1
"""Largest time (s) that one frame adds to the time of a set, so that a pause of the device adds
hardly any."""


@dataclass(frozen=True)
class GuideStep:
    """The current instruction, and how much of it is done, 0 to 1."""

    text: str
    share: float


class Guide:
    """Leads a person through a session, based on incoming frames.

    Args:
        side: The hand, left or right.
        each: Time (s) for which every set is recorded, in all rounds together.
        sets: The finger sets; by default all 26.
        camera: True if a camera sees the hand, in place of a Leap.

    Attributes:
        done: True once all steps are done.
    """

    def __init__(
        self,
        side: str,
        each: float = 6.0,
        sets: tuple[tuple[int, ...], ...] = SETS,
        camera: bool = False,
    ) -> None:
        self._side, self._each, self._camera = side, each / ROUNDS, camera
        self._sets = ROUNDS * sets
        self._wanted = PICTURES if camera else OPEN_FRAMES
        self._open = self._taps = self._set = 0
        self._search = OpenHandSearch(side)
        self._lifted = True
        self._played = 0.0
        self._touched: float | None = None
        self._last: float | None = None
        self.done = False

    @property
    def step(self) -> GuideStep:
        """The current instruction."""
        if self._open < self._wanted:
            text = f"Hold your {self._side} hand open over the surface, palm down, fingers spread"
            if self._camera:
                text += ", all of it in the picture"
            if self._search.refused:
                text += f" (not yet: {self._search.refused})"
            return GuideStep(text, self._open / self._wanted)
        if self._taps < TAPS:
            return GuideStep("Tap with all five fingers, three times, unevenly", self._taps / TAPS)
        if self.done:
            return GuideStep("Done", 1.0)
        names = " + ".join(FINGERS[f] for f in self._sets[self._set])
        number = f"{self._set + 1} of {len(self._sets)}"
        return GuideStep(f"{names}: {DOING} ({number})", min(1.0, self._played / self._each))

    @property
    def share(self) -> float:
        """Share of the whole session that is done, 0 to 1."""
        whole = 2.0 + len(self._sets)
        begun = min(1.0, self._open / self._wanted) + min(1.0, self._taps / TAPS)
        part = 0.0 if self.done else min(1.0, self._played / self._each)
        return (begun + self._set + part) / whole

    def hand(self, frame: HandFrame) -> None:
        """Processes a frame of the Leap."""
        if self._open >= self._wanted:
            return
        whole = [h for h in frame.hands if is_whole(h, self._side)]
        if any(f.joints for h in whole for f in h.fingers):
            # The hand must be held open, or PAALM could not measure it after the session.
            found = self._search.add(frame) is not None
            self._open = self._wanted if found else min(self._search.seen, self._wanted - 1)
        elif whole:
            self._open += 1

    def picture(self, frame: LandmarkFrame) -> None:
        """Processes a picture of the camera."""
        if self._open < self._wanted and any(h.side == self._side for h in frame.hands):
            self._open += 1

    @property
    def requested(self) -> tuple[int, ...] | None:
        """The requested fingers; None while no set is requested."""
        if self._open < self._wanted or self._taps < TAPS or self.done:
            return None
        return self._sets[self._set]

    def touch(self, frame: TouchFrame, now: float) -> None:
        """Processes a frame of the touch device that arrived at the time `now` (s)."""
        if self._open < self._wanted or self.done:
            return
        if frame.contacts:
            apart = self._touched is None or now - self._touched > APART
            if self._taps < TAPS:
                self._taps += self._lifted and apart
            self._touched = now
        self._lifted = not frame.contacts
        self.pass_time(now, len(frame.contacts))

    def pass_time(self, now: float, down: int) -> None:
        """Advances the time of the current set; devices send no frames while fingers rest."""
        step = 0.0 if self._last is None else min(now - self._last, _MOST_STEP)
        self._last = now
        if self._taps < TAPS or self.done or down != len(self._sets[self._set]):
            return
        self._played += max(step, 0.0)
        if self._played >= self._each:
            self._set, self._played = self._set + 1, 0.0
            self.done = self._set == len(self._sets)
