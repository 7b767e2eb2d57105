"""The commanded pose of a hand in the air. It follows the hand while the hand is seen, and waits
while the hand is lost."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, field
from math import exp, inf

import numpy as np

from encoders.reconstruction.hand_motion import Phase, RateLimit
from encoders.reconstruction.reconstructor import Reconstruction
from models.arithmetic import Array, length
from models.frames import FINGERS
from models.message import Message
from models.person import Person
from models.pose import JOINTS, POSE_SIZE, ROOT_POSITION, ROOT_ROTATION, mirrored
from models.rotations import unwrapped
from models.single_pose import SinglePose
from models.skeleton import ADULT, Skeleton
from models.surface import Surface

_ALL = frozenset(range(len(FINGERS)))

UNSEEN_NOTICE = 1.0
"""Time (s), after `FollowingSettings.patience`, for which a hand is unseen before the person gets a
notice."""


@dataclass(frozen=True)
class FollowingSettings:
    """Settings that determine how a commanded pose follows the observed poses of a hand.

    Attributes:
        rate: Speed limits of the commanded pose.
        smoothing: Time constant (s) of the smoothing of the palm's position and rotation; 0
            switches it off.
        joint_smoothing: Time constant (s) of the smoothing of the joints; 0 switches it off.
        patience: Time (s) for which a lost hand holds its pose and stays solid. Devices lose hands
            for moments, and a held box should not fall each time.
        rise, rise_speed: Height (m) by which a lost hand then rises as a ghost, so that it does not
            hide objects, and speed (m/s) of this rise.
        near: Distance (m) from its place within which a returned hand may be solid again.
        floor: Least world height (m) of the lowest points of commanded fingertips; the whole hand
            is raised to this height. People do not feel the table, and a hand pushed into the table
            would crush a held object. -inf if there is no table.
    """

    rate: RateLimit = field(default_factory=RateLimit)
    smoothing: float = 0.06
    joint_smoothing: float = 0.05
    patience: float = 0.3
    rise: float = 0.08
    rise_speed: float = 0.15
    near: float = 0.02
    floor: float = 0.0


class FollowedHand:
    """Follows one hand.

    Args:
        skeleton: The hand's skeleton.
        settings: How the pose follows the hand.
        start: (48,) pose in the world until the hand is seen for the first time.

    Attributes:
        unseen: Time (s) since the hand was last seen; infinite if it was never seen.
    """

    def __init__(self, skeleton: Skeleton, settings: FollowingSettings, start: Array) -> None:
        self.settings = settings
        self._tips, self._radius = SinglePose(skeleton), skeleton.tip_radius
        self._start = start
        self.reset()

    def reset(self) -> None:
        """Resets to the initial state."""
        self._commanded = self._goal = self._start.copy()
        self._seen_before = self._here = False
        self.unseen = np.inf

    @property
    def commanded(self) -> Array:
        """The pose last commanded (48,), in the world."""
        return self._commanded

    def notice(self, side: str) -> str:
        """Notice to a person whose hand on this side is not seen; empty while it is seen."""
        if self.unseen > self.settings.patience + UNSEEN_NOTICE:
            return Message(
                "hand_unseen", "the {side} hand is not seen: hold it over the device", side=side
            )
        return ""

    def follow(self, goal: Array, dt: float) -> None:
        """Moves towards the current observed pose (48,), in a control step of `dt` (s)."""
        s, goal = self.settings, goal.copy()
        first = not self._seen_before
        # After a long absence, the old state is not used for smoothing.
        if self.unseen <= s.patience:
            if s.smoothing > 0.0:
                goal[ROOT_ROTATION] = unwrapped(goal[ROOT_ROTATION], self._goal[ROOT_ROTATION])
            _keep(goal, self._goal, slice(0, JOINTS.start), s.smoothing, dt)
            _keep(goal, self._goal, JOINTS, s.joint_smoothing, dt)
        self._goal = goal
        above = self._above_floor(goal)
        self._commanded = above if first else s.rate(self._commanded, above, dt)
        self._seen_before, self.unseen = True, 0.0
        off = length(self._commanded[ROOT_POSITION] - above[ROOT_POSITION])
        self._here = self._here or off < s.near

    def lose(self, dt: float) -> None:
        """Makes a control step of `dt` (s) in which the hand is not seen."""
        s = self.settings
        self.unseen += dt
        if self.unseen <= s.patience:
            return
        self._here = False
        gone = self.unseen - s.patience
        if self._seen_before and (gone - dt) * s.rise_speed < s.rise:
            self._commanded = self._commanded.copy()
            self._commanded[2] += s.rise_speed * min(dt, gone)

    def reconstruction(self, error: float) -> Reconstruction:
        """The result of a control step.

        Args:
            error: Distance (m) between the reconstruction and the observation.
        """
        phase = Phase.DOWN if self._here else Phase.AWAY
        if not self._here and self.unseen == 0.0:
            phase = Phase.COMING_DOWN
        fingers = _ALL if self._here else frozenset()
        return Reconstruction(self._commanded, phase, fingers, None, 1.0, error)

    def _above_floor(self, q: Array) -> Array:
        if self.settings.floor == -inf:
            return q
        low = float((self._tips.tips(q)[:, 2] - self._radius).min()) - self.settings.floor
        if low >= 0.0:
            return q
        raised = q.copy()
        raised[2] -= low
        return raised


_START = (0.0, -0.10, 0.12)
"""Wrist position (m) of the right hand before it is seen: over the table, with the fingers pointing
away from the person."""


class AirReconstructor:
    """Base class of reconstructors of one hand that is seen in the air, frame by frame.

    Args:
        side: `right` or `left`.
        size: Length of the hand relative to the average hand.
        following: How the commanded pose follows the hand.
        surface: Workspace of a task; None is the default tablet.

    Attributes:
        counts: Number of frames or hands that could not be used, by reason.
    """

    def __init__(
        self, side: str, size: float, following: FollowingSettings, surface: Surface | None
    ) -> None:
        self.side = side
        self.surface = surface or Surface()
        start = np.zeros(POSE_SIZE)
        start[ROOT_POSITION] = _START
        start = mirrored(start) if side == "left" else start
        self._hand = FollowedHand(Person(side, size).skeleton(ADULT), following, start)
        self.reset()

    def reset(self) -> None:
        """Returns to the initial state: a hand that waits for its first frame."""
        self._hand.reset()
        self.counts: dict[str, int] = Counter()
        self._time: float | None = None
        self._goal: Array | None = None
        self._error = float("nan")

    @property
    def commanded(self) -> Array:
        """The pose last commanded (48,), in the world."""
        return self._hand.commanded

    @property
    def notice(self) -> str:
        """Notice to the person whose hand is not seen; empty while it is seen."""
        return self._hand.notice(self.side)

    def _elapsed(self, time: float) -> float:
        """Time (s) since the previous step; 0 at the first step, and if time runs backwards."""
        dt = 0.0 if self._time is None else max(time - self._time, 0.0)
        self._time = time if self._time is None else max(time, self._time)
        return dt

    def _followed(self, dt: float) -> Reconstruction:
        """The result of a control step of `dt` (s), in which the hand follows its goal or waits."""
        if self._goal is None:
            self._hand.lose(dt)
        else:
            self._hand.follow(self._goal, dt)
        return self._hand.reconstruction(self._error)


def _keep(goal: Array, before: Array, part: slice, smoothing: float, dt: float) -> None:
    """Smooths a part of a goal (48,) towards the previous goal, in place."""
    if smoothing > 0.0:
        goal[part] += exp(-dt / smoothing) * (before[part] - goal[part])
