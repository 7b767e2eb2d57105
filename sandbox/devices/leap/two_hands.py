"""Two hands over one Leap: each hand of the scene gets the frames of its own side.

This module is separate from the live device, so that exports of recordings load no network library.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import replace
from math import inf

from encoders.paalm.hand_reconstructor import NOTICE_LASTS
from encoders.paalm.identity import HandSides
from encoders.paalm.palm import stacked
from models.frames import HandFrame
from models.message import Message
from sandbox.devices.wrappers.shared import MergedUsers, Split


class SplitBySide(Split):
    """Splits the hands of a Leap by side.

    While one hand is above the other, both are left out, because the device confuses their fingers.

    Args:
        sides: Sides of the scene's hands, one `right` and one `left`.

    Attributes:
        counts: Number of frames in which one hand was above the other, and numbers of hands left
            out, by reason.
    """

    at_every_poll = True

    def __init__(self, sides: Sequence[str]) -> None:
        first, second = self._sides = tuple(sides)
        self.counts: Counter[str] = Counter()
        self._hidden = -inf
        self._choose = HandSides((first, second), self.counts)

    def divide(self, frame: HandFrame, now: float) -> tuple[HandFrame, HandFrame]:
        """Returns a frame for each side; a frame has no hand while that side is not in view."""
        hands = frame.hands
        hidden = any(stacked(a, b) for i, a in enumerate(hands) for b in hands[:i])
        self.counts["one hand above the other"] += hidden
        self._hidden = now if hidden else self._hidden
        chosen = {} if hidden else self._choose.choose(frame)
        parts = []
        for side in self._sides:
            hand = chosen.get(side)
            seen = () if hand is None else (replace(hand, side=side),)
            parts.append(replace(frame, hands=seen))
        first, second = parts
        return first, second

    def notices(self, now: float) -> Sequence[str] | None:
        """Returns a message while one hand is above the other and shortly after; else None."""
        if now - self._hidden >= NOTICE_LASTS:
            return None
        return (Message("hand_above", "one hand is above the other: hold them apart"),)


class MergedLeaps(MergedUsers):
    """Two simulated people over one Leap.

    Args:
        devices: Two devices whose frames have the same times.
    """

    clock_origin = 0.0

    @property
    def finished(self) -> bool:
        """True if either device has ended."""
        return any(device.finished for device in self.parts)

    def poll(self, now: float) -> Sequence[HandFrame]:  # type: ignore[override]
        """Returns frames with the hands of both devices; the ids are made distinct."""
        return [
            replace(
                frames[0],
                hands=tuple(
                    replace(h, id=2 * h.id + i) for i, f in enumerate(frames) for h in f.hands
                ),
            )
            for frames in zip(*(d.poll(now) for d in self.parts), strict=True)
        ]
