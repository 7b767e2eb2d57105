"""Landmarks of one hand over time, mirrored to a right hand, and their clock's offset."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import median_filter, uniform_filter1d

from encoders.captures.conversion.synchronise import ClockOffset
from encoders.captures.conversion.touch_log import ContactTrack
from models.arithmetic import Array
from models.errors import CaptureError
from models.frames import LandmarkFrame, SeenHand

TIPS = (4, 8, 12, 16, 20)
LAST_JOINTS = (3, 7, 11, 15, 19)
"""Landmark indices of the fingertips and of each finger's last joint, thumb first."""

LONGEST_GAP = 0.25
"""Longest time (s) between two pictures that is interpolated linearly."""
_LEAST_SHARE = 0.05
_LONGEST_FOLLOWED = 0.5
"""Longest time (s) for which a hand that the engine labels with the other side still counts as the
followed hand."""


@dataclass(frozen=True)
class PictureTrack:
    """Landmarks of one hand in J pictures; a left hand is mirrored.

    Attributes:
        time: (J,) s, times of the pictures, increasing.
        image: (J, 21, 2) px, landmarks in the picture.
        world: (J, 21, 3) m, the engine's estimate of the landmarks in space, in the camera's axes.
        size: Width and height of the pictures in px.
    """

    time: Array
    image: Array
    world: Array
    size: tuple[int, int]

    def pads(self, share: float) -> Array:
        """Finger pads (J, 5, 2) px, at a share of the way from the fingertip to the last joint."""
        tips, joints = self.image[:, TIPS], self.image[:, LAST_JOINTS]
        return np.asarray(tips + share * (joints - tips))

    def between(self, values: Array, times: Array) -> tuple[Array, NDArray[np.bool_]]:
        """Interpolates values (J, ...) of the pictures at times (m,) s.

        Returns:
            Values (m, ...), and booleans (m,): True within the track, where the two nearest
            pictures are at most `LONGEST_GAP` apart.
        """
        after = np.searchsorted(self.time, times, side="right")
        before = np.clip(after - 1, 0, len(self.time) - 2)
        span = self.time[before + 1] - self.time[before]
        share = (times - self.time[before]) / span
        known = (share >= 0.0) & (share <= 1.0) & (span <= LONGEST_GAP)
        share = np.clip(share, 0.0, 1.0).reshape(-1, *[1] * (values.ndim - 1))
        return values[before] + share * (values[before + 1] - values[before]), known


def picture_track(
    frames: Sequence[LandmarkFrame], time: Array, side: str
) -> tuple[PictureTrack, float]:
    """Follows one hand through the pictures.

    Args:
        frames: All pictures.
        time: (F,) s, times of the pictures, on the clock of the returned track.
        side: `right` or `left`.

    Returns:
        The track, and the share of pictures that show the hand.

    Raises:
        CaptureError: Too few pictures show the hand.
    """
    rows: list[int] = []
    image, world = [], []
    before: tuple[float, Array] | None = None
    for row, frame in enumerate(frames):
        hand = _chosen(frame, side, before, float(time[row]))
        if hand is None or (rows and time[row] <= time[rows[-1]]):
            continue
        rows.append(row)
        image.append(hand.image)
        world.append(hand.world)
        before = float(time[row]), np.array(hand.image).mean(axis=0)
    if len(rows) < 2 or len(rows) < _LEAST_SHARE * len(frames):
        raise CaptureError(
            f"the {side} hand is hardly seen in the pictures",
            got=f"{len(rows)} of {len(frames)} pictures",
            remedy="Check --side and the light, and that the whole hand is in the picture",
        )
    points, space = np.array(image), np.array(world)
    width, height = frames[rows[0]].size
    if side == "left":
        points = points * [-1.0, 1.0] + [float(width), 0.0]
        space = space * [-1.0, 1.0, 1.0]
    share = len(rows) / len(frames)
    return PictureTrack(time[rows], points, space, (width, height)), share


def _chosen(
    frame: LandmarkFrame, side: str, before: tuple[float, Array] | None, now: float
) -> SeenHand | None:
    """The hand with the given side in a picture; None if it is not seen.

    Among several hands of this side, the hand nearest to the recent place of the followed hand is
    chosen. Without a recent place, the hand with the highest score is chosen. If the only hand in
    the picture has the other side, it is accepted at the recent place: from above, the engine
    sometimes mistakes the side of a hand for a short time.
    """
    own = [h for h in frame.hands if h.side == side]
    if before is not None and now - before[0] <= _LONGEST_FOLLOWED:
        place = before[1]

        def off(hand: SeenHand) -> float:
            return float(np.abs(np.array(hand.image).mean(axis=0) - place).max())

        if own:
            return min(own, key=off)
        if len(frame.hands) == 1:
            (other,) = frame.hands
            if off(other) < float(np.ptp(np.array(other.image), axis=0).max()) / 2.0:
                return other
        return None
    return max(own, key=lambda h: h.score) if own else None


_STEP = 0.02
"""Step (s) of the grids of times and offsets."""
_WINDOW = 4.0
"""Window (s) of the median against which the palm's size is compared."""
_LEAST = 0.25
"""Least correlation between lifts in the pictures and lifts of the touches."""
_RIVAL, _APART = 0.9, 0.25
"""The result is ambiguous if an offset more than `_APART` (s) away reaches the share `_RIVAL` of
the best correlation."""
_PALM = (0, 5, 9, 13, 17)


def offset_by_lifts(
    tracks: list[ContactTrack], pictures: PictureTrack, within: float
) -> ClockOffset:
    """Estimates the pictures' clock minus the touches' clock, from taps and lifts.

    A picture from above does not show when a fingertip lands. But while no touch is down, the hand
    is lifted and nearer to the camera, and its palm is larger in the picture. The offset at which
    the palm's size and the absence of touches correlate best is the difference of the clocks, to
    some hundredths of a second. `refined_by_motion` makes it more precise.

    Args:
        tracks: Contacts.
        pictures: Landmarks of the hand in the pictures.
        within: Greatest possible offset (s).

    Raises:
        CaptureError: The hand was never lifted, or lifts in the pictures and touches do not match.
    """
    begin = min(t.start for t in tracks) - 1.0
    grid = np.arange(begin, max(t.end for t in tracks) + 1.0, _STEP)
    lifted = np.ones(len(grid))
    for one in tracks:
        lifted[(grid >= one.start) & (grid < one.end)] = 0.0
    size = np.log(_palm_size(pictures.image))
    offsets = np.arange(-within, within + _STEP / 2, _STEP)
    agree = np.array([_agreement(lifted, grid, size, pictures, o) for o in offsets])
    best = int(agree.argmax())
    peak = float(agree[best])
    rivals = agree[np.abs(offsets - offsets[best]) > _APART]
    rival = float(rivals.max()) if len(rivals) else 0.0
    if not peak >= _LEAST or rival >= _RIVAL * peak or best in (0, len(offsets) - 1):
        raise CaptureError(
            "the taps do not determine the offset of the clocks",
            where="touches and pictures",
            got=f"an agreement of {peak:.2f} at {offsets[best]:.2f} s, and {max(rival, 0.0):.2f} "
            "at another offset",
            expected=f"at least {_LEAST:g}, and no other offset with {100 * _RIVAL:g} % of it",
            remedy="Tap unevenly with all five fingers, lifting the hand by some centimetres",
        )
    downs = len({round(t.start, 1) for t in tracks})
    return ClockOffset(float(offsets[best]), _STEP, downs, downs)


def _palm_size(image: Array) -> Array:
    """Root mean square distance (J,) px of the palm's landmarks from their centroid."""
    palm = image[:, _PALM]
    away = palm - palm.mean(axis=1, keepdims=True)
    return np.sqrt((away**2).sum(axis=2).mean(axis=1))


def _agreement(
    lifted: Array, grid: Array, size: Array, pictures: PictureTrack, offset: float
) -> float:
    there, known = pictures.between(size, grid + offset)
    if known.sum() < 50 or np.ptp(lifted[known]) == 0.0:
        return 0.0
    width = round(_WINDOW / _STEP)
    there, up = there[known], lifted[known]
    there = there - median_filter(there, width, mode="nearest")
    there = uniform_filter1d(np.clip(there, -0.15, 0.15), 3, mode="nearest")
    up = up - uniform_filter1d(up, width, mode="nearest")
    spread = float(np.sqrt((there**2).sum() * (up**2).sum()))
    return float((there * up).sum()) / spread if spread > 0.0 else 0.0
