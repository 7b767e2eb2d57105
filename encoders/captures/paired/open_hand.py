"""Measures the hand that is held open at the beginning of a recording, by PAALM's calibration."""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence
from typing import Any

from encoders.paalm import Paalm
from encoders.paalm.calibration import HandCalibration
from models.errors import EncoderError
from models.frames import FINGERS, HandFrame, TrackedHand

OPEN_FRAMES = 200
"""Number of frames of the open hand; the paper used 1000 frames, which lasted 10 s."""

_EVERY = 20
"""Number of frames between two checks for an open hand."""


def open_hand(frames: Sequence[HandFrame], side: str, wanted: int = OPEN_FRAMES) -> HandCalibration:
    """Measures the hand that is held open at the beginning of a recording.

    A device that reports joints also sends frames without a hand. If there are too many such frames
    at first, or if the hand is opened later, the first frames with an open hand are used.

    Args:
        frames: All frames of the recording.
        side: `right` or `left`.
        wanted: Number of frames with all five fingers that are needed to measure a hand.

    Raises:
        EncoderError: The hand is not held open; the error gives the reason.
    """
    try:
        which: Any = side
        return Paalm().calibrate(frames, which, wanted)[side]
    except EncoderError:
        search = OpenHandSearch(side, wanted)
        for frame in frames:
            found = search.add(frame)
            if found is not None:
                return found
        raise


class OpenHandSearch:
    """Searches for the first frames in which a hand with known joints is held open.

    Args:
        side: `right` or `left`.
        wanted: Number of frames with all five fingers that are needed to measure a hand.

    Attributes:
        seen: Number of such frames among the latest 2 `wanted` frames, at most `wanted`. It is
            updated every 20 frames.
        refused: Reason why the last hand that was checked is not open; empty before the first
            check.
    """

    def __init__(self, side: str, wanted: int = OPEN_FRAMES) -> None:
        self.seen = 0
        self.refused = ""
        self._side: Any = side
        self._wanted, self._until_look = wanted, 0
        # All five fingers must be seen in half of these frames.
        self._frames: deque[HandFrame] = deque(maxlen=2 * wanted)

    def add(self, frame: HandFrame) -> HandCalibration | None:
        """Processes a frame; returns the measured hand once it is held open, until then None."""
        if not self._frames and not self._whole(frame):
            return None
        self._frames.append(frame)
        self._until_look -= 1
        if self._until_look > 0:
            return None
        self._until_look = _EVERY
        whole = sum(self._whole(each) for each in self._frames)
        self.seen = min(whole, self._wanted)
        if whole < self._wanted:
            return None
        try:
            return Paalm().calibrate(self._latest(), self._side, self._wanted)[self._side]
        except EncoderError as error:
            self.refused = error.what
            return None

    def _latest(self) -> list[HandFrame]:
        """The shortest run of latest frames that contains `wanted` whole hands."""
        frames, whole = list(self._frames), 0
        for begin in range(len(frames) - 1, -1, -1):
            whole += self._whole(frames[begin])
            if whole == self._wanted:
                return frames[begin:]
        return frames

    def _whole(self, frame: HandFrame) -> bool:
        return any(
            is_whole(hand, self._side) and all(f.joints for f in hand.fingers)
            for hand in frame.hands
        )


def is_whole(hand: TrackedHand, side: str) -> bool:
    """True if a hand has five fingers, and is not reported as a hand of the other side."""
    return hand.side in (None, side) and len(hand.fingers) == len(FINGERS)
