"""Reconstruct one hand in the air: from a camera's landmarks, or from a headset's joints.

The interface is that of all reconstructors (`encoders.reconstruction.reconstructor`). Each picture
or frame is solved once, on arrival. Between two pictures, the commanded pose goes on towards the
last result.
"""

from __future__ import annotations

import numpy as np

from encoders.air.camera import Camera
from encoders.air.joint_fit import JointFit, JointFitSettings, seen_points
from encoders.air.landmark_fit import FitSettings, LandmarkFit
from encoders.reconstruction.followed_hand import AirReconstructor, FollowingSettings
from encoders.reconstruction.hand_motion import RateLimit
from encoders.reconstruction.reconstructor import Reconstruction
from models.arithmetic import Array, small_product
from models.frames import HandFrame, LandmarkFrame, SeenHand, TrackedHand
from models.person import Person
from models.pose import ROOT_POSITION, ROOT_ROTATION, mirrored
from models.reader_report import SIDE_MENDED
from models.rotations import exp, log
from models.skeleton import ADULT
from models.surface import Surface

_FORGET = 0.5
"""Time (s) without a picture of the hand after which the next picture is solved from the first
guess."""

WITHOUT = "pictures without the hand"
"""Key in a reconstructor's counts."""


class LandmarkReconstructor(AirReconstructor):
    """Reconstructs one hand from a camera's landmarks.

    Args:
        camera: The camera.
        side: `right` or `left`.
        size: Length of the hand relative to the average hand. The hand's distance from the camera
            follows from this length.
        following: How the commanded pose follows the solved poses.
        fit: Weights of the fit.
        surface: Workspace of a task; None is the default tablet.

    Attributes:
        empty: The frame that is used before the device's first frame.
        counts: Number of pictures without this hand, of additional hands of its side, and of hands
            whose reported side was corrected, by reason.
    """

    empty = LandmarkFrame(0.0)

    def __init__(
        self,
        camera: Camera,
        side: str = "right",
        size: float = 1.0,
        following: FollowingSettings | None = None,
        fit: FitSettings | None = None,
        surface: Surface | None = None,
    ) -> None:
        self.camera = camera
        self._fit = LandmarkFit(Person("right", size).skeleton(ADULT), fit)
        super().__init__(side, size, following or FollowingSettings(), surface)

    def reset(self) -> None:
        """See `AirReconstructor.reset`."""
        super().reset()
        self._fit.reset()
        self._taken: float | None = None
        self._solved: float | None = None
        self._image_middle: Array | None = None

    def step(self, frame: LandmarkFrame) -> Reconstruction:
        """Processes a frame; called once per control step, even if nothing has changed."""
        dt = self._elapsed(frame.time)
        before_the_first = self._taken is None and not frame.hands
        if frame.taken != (self.empty.taken if before_the_first else self._taken):
            self._taken = frame.taken
            self._solve(frame)
        elif not frame.hands:
            # The device has stopped sending.
            self._goal = None
        return self._followed(dt)

    def _solve(self, frame: LandmarkFrame) -> None:
        """Solves a new picture; the goal is None if the hand is not in the picture."""
        hand = self._choose(frame)
        if hand is None:
            self._goal = None
            return
        dt = np.inf if self._solved is None else frame.taken - self._solved
        if not 0.0 < dt <= _FORGET:
            self._fit.reset()
        self._solved = frame.taken
        rays = self.camera.rays(np.array(hand.image), frame.size)
        world = np.array(hand.world)
        if self.side == "left":
            # The fit is for right hands: a left hand's landmarks are mirrored, and its pose back.
            rays, world = rays * [-1.0, 1.0], world * [-1.0, 1.0, 1.0]
        pose, self._error = self._fit.fit(rays, world, dt)
        self._goal = self._in_world(mirrored(pose) if self.side == "left" else pose)
        self._image_middle = np.array(hand.image).mean(axis=0)

    def _choose(self, frame: LandmarkFrame) -> SeenHand | None:
        """This reconstructor's hand among the hands of a picture; None if it is not seen.

        Among several hands of its side, the hand nearest to its recent place is chosen, or without
        a recent place the hand with the highest score. A hand of the other side is accepted at the
        recent place if no hand of this side is there, since the engine sometimes mistakes the side
        for a moment.
        """
        own = [h for h in frame.hands if h.side == self.side]
        if len(own) > 1:
            self.counts["further hands of the same side"] += len(own) - 1
        if frame.hands and self._seen_lately(frame) and not any(map(self._is_near, own)):
            nearest = min(frame.hands, key=self._off)
            if self._is_near(nearest):
                self.counts[SIDE_MENDED] += 1
                return nearest
        if not own:
            self.counts[WITHOUT] += 1
            return None
        if self._seen_lately(frame):
            return min(own, key=self._off)
        return max(own, key=lambda h: h.score)

    def _seen_lately(self, frame: LandmarkFrame) -> bool:
        """True if the hand was seen just before this picture."""
        before = self._solved is not None and 0.0 <= frame.taken - self._solved <= _FORGET
        return before and self._image_middle is not None

    def _is_near(self, hand: SeenHand) -> bool:
        """True if a hand in a picture overlaps the last place of the reconstructor's hand."""
        palm = np.array(hand.image)
        return self._off(hand) < float(np.abs(palm - palm.mean(axis=0)).max())

    def _off(self, hand: SeenHand) -> float:
        """Distance (pixels) of a hand from the last place of the reconstructor's hand, along the
        axis with the larger difference."""
        assert self._image_middle is not None
        return float(np.abs(np.array(hand.image).mean(axis=0) - self._image_middle).max())

    def _in_world(self, pose: Array) -> Array:
        """Converts a pose (48,) from the camera's frame to the world."""
        q, axes = pose.copy(), self.camera.axes
        q[ROOT_POSITION] = self.camera.unseen(pose[None, ROOT_POSITION])[0]
        q[ROOT_ROTATION] = log(small_product(axes.T, exp(pose[ROOT_ROTATION])))
        return q


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
