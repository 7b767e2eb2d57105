"""Reconstructs one hand from the joints that a headset reports, frame by frame.

The interface is that of all reconstructors (`encoders.reconstruction.reconstructor`). Each frame is
solved once, on arrival.
"""

from __future__ import annotations

import numpy as np

from encoders.air.joint_fit import JointFit, JointFitSettings, seen_points
from encoders.reconstruction.followed_hand import AirReconstructor, FollowingSettings
from encoders.reconstruction.hand_motion import RateLimit
from encoders.reconstruction.reconstructor import Reconstruction
from models.arithmetic import Array
from models.frames import HandFrame, TrackedHand
from models.person import Person
from models.pose import mirrored
from models.skeleton import ADULT
from models.surface import Surface

_MIRROR = np.array([-1.0, 1.0, 1.0])


def following(rate: RateLimit | None = None) -> FollowingSettings:
    """Settings for following a headset's joints. These are less noisy than a camera's landmarks."""
    return FollowingSettings(rate=rate or RateLimit(), smoothing=0.02, joint_smoothing=0.02)


class JointReconstructor(AirReconstructor):
    """Reconstructs one hand from the joints that a device reports, in the world.

    Args:
        side: `right` or `left`.
        size: Length of the hand relative to the average hand.
        settings: How the commanded pose follows the solved poses.
        fit: Weights of the fit.
        surface: Workspace of a task; None is the default tablet.

    Attributes:
        empty: The frame that is used before the device's first frame.
        counts: Number of frames that could not be used, by reason.
    """

    empty = HandFrame(0.0)

    def __init__(
        self,
        side: str = "right",
        size: float = 1.0,
        settings: FollowingSettings | None = None,
        fit: JointFitSettings | None = None,
        surface: Surface | None = None,
    ) -> None:
        self._fit = JointFit(Person("right", size).skeleton(ADULT), fit)
        super().__init__(side, size, settings or following(), surface)

    def reset(self) -> None:
        """See `AirReconstructor.reset`."""
        super().reset()
        self._seen: TrackedHand | None = None

    def step(self, frame: HandFrame) -> Reconstruction:
        """Processes a frame; called once per control step, even if nothing has changed."""
        dt = self._elapsed(frame.time)
        hand = next((h for h in frame.hands if h.side == self.side), None)
        # The same hand gives the same goal and is not solved again.
        if hand is None or hand is not self._seen:
            self._seen, self._goal = hand, None if hand is None else self._solved(hand)
        return self._followed(dt)

    def _solved(self, hand: TrackedHand) -> Array | None:
        """The pose (48,) of a reported hand in the world; None if too few of its joints are
        reported."""
        left = self.side == "left"
        points = seen_points(hand)
        # The fit is for right hands: a left hand's points are mirrored, and its pose mirrored back.
        fit = self._fit.fit(points * _MIRROR if left else points)
        if fit is None:
            self.counts["hands without a palm"] += 1
            return None
        self._error = fit.error
        return mirrored(fit.pose) if left else fit.pose
