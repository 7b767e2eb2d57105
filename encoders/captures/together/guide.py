"""What a person is asked to do while touches and hand are recorded, and how far they are.

First the open hand, for PAALM to measure; then three taps, for the clocks; then every set of two to
five fingers, for a set that is missing cannot be reconstructed later. A touch device does not know
which fingers it feels: the guide counts them and trusts the person.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations

from encoders.captures.together.capture_from_hands import OPEN_FRAMES
from models.frames import FINGERS, HandFrame, TouchFrame

TAPS = 3
APART = 0.15
"""s without any touch between two taps."""
DOING = "move, open and close, pinch, turn"

SETS: tuple[tuple[int, ...], ...] = tuple(
    chosen for size in range(5, 1, -1) for chosen in combinations(range(len(FINGERS)), size)
)
"""The 26 sets, those with many fingers first: they tell best where the device is."""

_MOST_STEP = 0.1
"""s that one frame can add; a device that pauses adds nothing."""


@dataclass(frozen=True)
class Step:
    """What is asked for now, and the share of it that is done, 0 to 1."""

    text: str
    share: float


class Guide:
    """The way through a session, by the frames that come.

    Args:
        side: Which hand.
        each: s for which every set is to be played.
        sets: Which; all 26 without.

    Attributes:
        done: Whether everything was done.
    """

    def __init__(
        self, side: str, each: float = 6.0, sets: tuple[tuple[int, ...], ...] = SETS
    ) -> None:
        self._side, self._each, self._sets = side, each, sets
        self._open = self._taps = self._set = 0
        self._played = 0.0
        self._touched: float | None = None
        self._last: float | None = None
        self.done = False

    @property
    def step(self) -> Step:
        """What the person is to do."""
        if self._open < OPEN_FRAMES:
            text = f"Hold your {self._side} hand open over the surface, palm down, fingers spread"
            return Step(text, self._open / OPEN_FRAMES)
        if self._taps < TAPS:
            return Step("Tap with all five fingers, three times, unevenly", self._taps / TAPS)
        if self.done:
            return Step("Done", 1.0)
        names = " + ".join(FINGERS[f] for f in self._sets[self._set])
        number = f"{self._set + 1} of {len(self._sets)}"
        return Step(f"{names}: {DOING} ({number})", min(1.0, self._played / self._each))

    @property
    def share(self) -> float:
        """Of the whole session, 0 to 1."""
        whole = 2.0 + len(self._sets)
        begun = min(1.0, self._open / OPEN_FRAMES) + min(1.0, self._taps / TAPS)
        part = 0.0 if self.done else min(1.0, self._played / self._each)
        return (begun + self._set + part) / whole

    def hand(self, frame: HandFrame) -> None:
        """A frame of the Leap."""
        if self._open < OPEN_FRAMES and any(len(h.fingers) == len(FINGERS) for h in frame.hands):
            self._open += 1

    def touch(self, frame: TouchFrame, now: float) -> None:
        """A frame of the touch device that came at `now`, s."""
        if self._open < OPEN_FRAMES or self.done:
            return
        gone = self._touched is None or now - self._touched > APART
        if frame.contacts:
            if self._taps < TAPS:
                self._taps += gone
            self._touched = now
        self.pass_time(now, len(frame.contacts))

    def pass_time(self, now: float, down: int) -> None:
        """Fingers that are down play their set; devices say nothing while they rest."""
        step = 0.0 if self._last is None else min(now - self._last, _MOST_STEP)
        self._last = now
        if self._taps < TAPS or self.done or down != len(self._sets[self._set]):
            return
        self._played += max(step, 0.0)
        if self._played >= self._each:
            self._set, self._played = self._set + 1, 0.0
            self.done = self._set == len(self._sets)
