"""The motion of a recorded hand over a Leap, many frames at a time.

Poses are those of `sandbox.export.leap_hands.straight_reconstructor`, to the bit. PAALM goes from
frame to frame; the joints of all frames since the last batch are computed at once.
"""

from __future__ import annotations

import numpy as np

from encoders.paalm.calibration import HandCalibration
from encoders.paalm.chain import tables_of
from encoders.paalm.hand_pose import hand_poses
from encoders.paalm.paalm import Paalm, PaalmHand
from encoders.reconstruction.followed_hand import FollowedHand
from models.arithmetic import Array
from models.frames import HandFrame
from models.person import Person
from models.skeleton import ADULT
from sandbox.export.leap_hands import STRAIGHT


class RecordedHand:
    """One hand of a recording.

    Args:
        side: `right` or `left`.
        calibration: Calibration of that hand.
        first: (48,) pose of the hand until it is seen.
    """

    def __init__(self, side: str, calibration: HandCalibration, first: Array) -> None:
        self._side, self._paalm = side, Paalm()
        self._paalm.use({side: calibration})
        self._hand = FollowedHand(Person(side).skeleton(ADULT), STRAIGHT.following, first)
        self._time: float | None = None
        self._waiting: list[tuple[float, PaalmHand | None]] = []

    @property
    def counts(self) -> dict[str, int]:
        """Numbers of hands that were left out or mended, by reason."""
        return {reason: n for reason, n in self._paalm.counts.items() if reason != "frames"}

    def add(self, frame: HandFrame) -> None:
        """Takes in the next frame."""
        dt = 0.0 if self._time is None else max(frame.time - self._time, 0.0)
        self._time = frame.time if self._time is None else max(frame.time, self._time)
        hand = self._paalm.step(frame).hands.get(self._side)
        self._waiting.append((dt, hand if hand is not None and hand.seen else None))

    def poses(self) -> Array:
        """Poses (n, 48) in the device's frame of the frames since the last call."""
        seen = [hand for _, hand in self._waiting if hand is not None]
        tables = tables_of([h.bends for h in seen])
        goals = iter(hand_poses(tables, [h.palm for h in seen], self._side))
        poses = np.empty((len(self._waiting), self._hand.commanded.size))
        for pose, (dt, hand) in zip(poses, self._waiting, strict=True):
            if hand is None:
                self._hand.lose(dt)
            else:
                self._hand.follow(next(goals), dt)
            pose[:] = self._hand.commanded
        self._waiting.clear()
        return poses
