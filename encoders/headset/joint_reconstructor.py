"""A headset's joints as a source of poses: a reconstructor of one hand from one frame after
another.

It has the interface of all reconstructors (`encoders.reconstruction.reconstructor`). A frame is
solved once, when it comes.
"""

from __future__ import annotations

from collections import Counter

import numpy as np

from encoders.headset.joint_fit import JointFit, JointFitSettings, seen_points
from encoders.reconstruction.followed_hand import FollowedHand, FollowingSettings
from encoders.reconstruction.hand_motion import RateLimit
from encoders.reconstruction.reconstructor import Reconstruction
from models.arithmetic import Array
from models.frames import HandFrame, TrackedHand
from models.person import Person
from models.pose import POSE_SIZE, ROOT_POSITION, mirrored
from models.skeleton import ADULT
from models.surface import Surface

_START = (0.0, -0.10, 0.12)
"""m, wrist of the right hand before it is seen: over the table, fingers away from the person."""
_MIRROR = np.array([-1.0, 1.0, 1.0])


def following(rate: RateLimit | None = None) -> FollowingSettings:
    """Settings of following a headset's joints, which are steadier than a camera's."""
    return FollowingSettings(rate=rate or RateLimit(), smoothing=0.02, joint_smoothing=0.02)


class JointReconstructor:
    """Reconstructs one hand from the joints that a device sees, in the world.

    Args:
        side: `right` or `left`.
        size: Length of the hand relative to the average one.
        settings: How the commanded pose follows.
        fit: What the fit trusts.
        surface: Workspace of a task; None is the default tablet.

    Attributes:
        empty: The frame that stands for a device before its first one.
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
        self.side = side
        self.surface = surface or Surface()
        self._fit = JointFit(Person("right", size).skeleton(ADULT), fit)
        start = np.zeros(POSE_SIZE)
        start[ROOT_POSITION] = _START
        start = mirrored(start) if side == "left" else start
        own = Person(side, size).skeleton(ADULT)
        self._hand = FollowedHand(own, settings or following(), start)
        self.reset()

    def reset(self) -> None:
        """Returns to the initial state: a hand that waits for its first frame."""
        self._hand.reset()
        self.counts: dict[str, int] = Counter()
        self._time: float | None = None
        self._seen: TrackedHand | None = None
        self._goal: Array | None = None
        self._error = float("nan")

    @property
    def commanded(self) -> Array:
        """The pose last commanded (48,), in the world."""
        return self._hand.commanded

    @property
    def notice(self) -> str:
        """Notice to the person whose hand is not seen; empty while all is well."""
        return self._hand.notice(self.side)

    def step(self, frame: HandFrame) -> Reconstruction:
        """Processes a frame; called once per control step, even if nothing has changed."""
        dt = 0.0 if self._time is None else max(frame.time - self._time, 0.0)
        self._time = frame.time if self._time is None else max(frame.time, self._time)
        hand = next((h for h in frame.hands if h.side == self.side), None)
        # The same hand gives the same goal; it need not be solved again.
        if hand is None or hand is not self._seen:
            self._seen, self._goal = hand, None if hand is None else self._solved(hand)
        if self._goal is None:
            self._hand.lose(dt)
        else:
            self._hand.follow(self._goal, dt)
        return self._hand.reconstruction(self._error)

    def _solved(self, hand: TrackedHand) -> Array | None:
        """The pose (48,) of a seen hand in the world; None if too few of its joints are seen."""
        left = self.side == "left"
        points = seen_points(hand)
        # A left hand is the right-hand code between two mirrors.
        fit = self._fit.fit(points * _MIRROR if left else points)
        if fit is None:
            self.counts["hands without a palm"] += 1
            return None
        self._error = fit.error
        return mirrored(fit.pose) if left else fit.pose
