"""Common clock of touches and pictures, from taps and lifts.

From above, a picture does not show when a fingertip lands. But a hand that is lifted comes nearer
to the camera, and its palm is larger in the picture. Touches are gone at the same moments: the
offset at which both agree best is the difference of the clocks, to some hundredths of a second,
which the motion of touches and fingers then refines.
"""

from __future__ import annotations

import numpy as np
from scipy.ndimage import median_filter, uniform_filter1d

from encoders.captures.conversion.synchronise import ClockOffset
from encoders.captures.conversion.touch_log import ContactTrack
from encoders.captures.overhead.picture_track import PictureTrack
from models.arithmetic import Array
from models.errors import CaptureError

_STEP = 0.02
"""s of the grid."""
_WINDOW = 4.0
"""s over which the palm's size is compared with its usual one."""
_LEAST = 0.25
"""Least correlation of lifts in the picture with those of touches."""
_RIVAL, _APART = 0.9, 0.25
"""Another offset, so many s away, that correlates so well, as a share, leaves the clocks open."""
_PALM = (0, 5, 9, 13, 17)


def offset_by_lifts(
    tracks: list[ContactTrack], pictures: PictureTrack, within: float
) -> ClockOffset:
    """Estimates the pictures' clock minus the touches' clock.

    Args:
        tracks: Contacts.
        pictures: The hand in the pictures.
        within: s, greatest possible offset.

    Raises:
        CaptureError: Nothing was lifted, or lifts do not match.
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
            expected=f"{_LEAST:g}, and no other with {100 * _RIVAL:g} % of it",
            remedy="Tap unevenly with all five fingers, lifting the hand by some centimetres",
        )
    downs = len({round(t.start, 1) for t in tracks})
    return ClockOffset(float(offsets[best]), _STEP, downs, downs)


def _palm_size(image: Array) -> Array:
    """(J,) px, root mean square distance of the palm's landmarks from their middle."""
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
