"""A rest posture from a hand that a device sees in the air, held as it rests on a screen.

The person holds the hand still for a second, relaxed, with all fingertips on one level: on a table,
on the switched-off screen, or above the device. The pose is the median of that second. The level of
the fingertips stands for the screen, and the places over which they are for the touches: that is
one sample of `encoders.person.rest_posture`.
"""

from __future__ import annotations

from collections import deque

import numpy as np

from encoders.correction import PAD_HEIGHT
from encoders.person.rest_posture import DIGITS
from models.arithmetic import Array, squared_lengths
from models.errors import EncoderError
from models.frames import FINGERS
from models.kinematics import Kinematics
from models.person import RestSample
from models.pose import ROOT_POSITION, ROOT_ROTATION
from models.rotations import unwrap_near
from models.skeleton import Skeleton

SECONDS = 1.0
"""s that a hand is held still."""
STILL = 0.012
"""m from its median place within which every fingertip stays. Landmarks of a still hand shake a
fingertip by some millimetres."""
LEVEL = 0.030
"""m from their median height within which the fingertips of a resting hand are, so that all of them
may touch. Thumbs lie lower than fingers stand, and a device errs by a centimetre."""
MOVED = 0.040
"""m by which a hand moves between two samples."""


class SeenRest:
    """Waits for a hand that is held still, sample after sample.

    Args:
        skeleton: The right hand's skeleton, of the person's size.

    Attributes:
        samples: The samples so far.
        trouble: Why the last hand that was held still is not a sample; empty if it is one.
    """

    def __init__(self, skeleton: Skeleton) -> None:
        self._kinematics = Kinematics(skeleton)
        self._frames: deque[tuple[float, Array, Array]] = deque()
        self._taken: Array | None = None
        self.samples: list[RestSample] = []
        self.trouble = ""

    def lose(self) -> None:
        """The hand is not seen."""
        self._frames.clear()

    def add(self, time: float, q: Array) -> bool:
        """Takes in a pose.

        Args:
            time: s.
            q: (48,) pose as of a right hand; x right, y away from the person, z up.

        Returns:
            True if a sample was taken.
        """
        self._frames.append((time, q, self._kinematics.tips(q)))
        while time - self._frames[0][0] > SECONDS:
            self._frames.popleft()
        if time - self._frames[0][0] < 0.9 * SECONDS:
            return False
        tips = np.array([frame[2] for frame in self._frames])
        middle = np.median(tips, axis=0)
        if float(np.sqrt(squared_lengths(tips - middle)).max()) > STILL:
            return False
        if self._taken is not None and _moved(middle, self._taken) < MOVED:
            return False
        try:
            sample = rest_sample_of(
                np.array([frame[1] for frame in self._frames]), self._kinematics
            )
        except EncoderError as error:
            self.trouble = str(error)
            return False
        self.trouble = ""
        self.samples.append(sample)
        self._taken = middle
        return True


def rest_sample_of(poses: Array, kinematics: Kinematics) -> RestSample:
    """The sample of a hand that was held still.

    Args:
        poses: (n, 48) as of a right hand; z is up.
        kinematics: That of the hand's skeleton.

    Raises:
        EncoderError: The fingertips are not on one level.
    """
    q = np.median(poses, axis=0)
    turns = unwrap_near(poses[:, ROOT_ROTATION], poses[0, ROOT_ROTATION])
    q[ROOT_ROTATION] = np.median(turns, axis=0)
    tips = kinematics.tips(q)
    heights = tips[:, 2] - np.median(tips[:, 2])
    worst = int(np.argmax(np.abs(heights)))
    if abs(heights[worst]) > LEVEL:
        raise EncoderError(
            "the fingertips are not on one level",
            got=f"the {FINGERS[worst]} is {100 * abs(heights[worst]):.1f} cm "
            f"{'above' if heights[worst] > 0 else 'below'} the others",
            expected=f"{100 * LEVEL:.0f} cm or less, as of a hand that rests on a screen",
        )
    # The screen begins at the leftmost and farthest touch; only what is relative to it counts.
    q[ROOT_POSITION] -= [tips[:, 0].min(), tips[:, 1].max(), np.median(tips[:, 2]) - PAD_HEIGHT]
    places = (kinematics.tips(q)[:, :2] * [1.0, -1.0]).round(DIGITS).tolist()
    return RestSample(tuple((x, y) for x, y in places), tuple(q.round(DIGITS).tolist()))


def _moved(tips: Array, before: Array) -> float:
    """m, the least movement of a fingertip."""
    return float(np.sqrt(squared_lengths(tips - before)).min())
