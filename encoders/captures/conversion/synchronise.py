"""Estimates the offset between the clocks of touches and poses from taps.

The offset is the poses' clock minus the touches' clock. Every touch-down belongs to a landing, the
moment when a fingertip reaches the surface. The search takes all time differences between landings
and touch-downs, and finds the offset at which most touch-downs have a landing. Touches and
fingertips then move together, so their movement refines the offset.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from encoders.captures.conversion.conversion_report import ConversionRules
from encoders.captures.conversion.fingers import LabelledTrack, sample_times
from encoders.captures.conversion.joint_track import JointTrack
from encoders.captures.conversion.touch_log import ContactTrack
from models.arithmetic import Array
from models.errors import CaptureError

AGREES = 0.04
"""Largest time difference (s) between a touch-down and its landing."""

NEEDED = 0.6
"""Least share of touch-downs that must have a landing."""

RIVAL = 0.8
"""The result is ambiguous if another offset reaches this share of the best offset's agreements."""

_APART = 0.15
"""Offsets nearer than this (s) count as the same result."""

_NEAR, _FAR = 0.003, 0.008
"""Heights (m) above a tip's lowest height: below the first the tip has landed, above the second it
was lifted."""

_LOW = 5.0
"""Percentile of a tip's heights that counts as its height on the surface."""

_FINE = 0.1
"""Range (s) to either side of the first result in which the refinement searches."""

_STEP = 0.0025
"""Step (s) of the refinement's grid."""


@dataclass(frozen=True)
class ClockOffset:
    """The poses' clock minus the touches' clock (s), with its precision.

    Attributes:
        offset: The clock offset (s).
        precision: Standard error (s) of the offset.
        agreeing: Number of touch-downs that have a landing.
        taps: Number of touch-downs within the time of the poses, which can have a landing.
    """

    offset: float
    precision: float
    agreeing: int
    taps: int


def offset_by_taps(
    tracks: list[ContactTrack], joints: JointTrack, within: float | None = None
) -> ClockOffset:
    """Estimates the offset at which touch-downs and landings agree.

    Args:
        tracks: Contacts.
        joints: Poses, whose z is the height above the surface up to a constant.
        within: Greatest possible offset (s); None allows any.

    Raises:
        CaptureError: There are no taps, too few agree, or two offsets fit about equally well.
    """
    downs = np.array([track.start for track in tracks])
    landings = tip_landings(joints)
    differences = np.sort((landings[None, :] - downs[:, None]).ravel())
    if within is not None:
        differences = differences[np.abs(differences) <= within]
    if not len(differences):
        raise CaptureError(
            "the recording has no tap to synchronise by",
            where="--sync tap",
            got=f"{len(downs)} touch-downs, {len(landings)} landings of fingertips",
            remedy="Tap the surface a few times, unevenly, or give --sync clock --offset S",
        )
    upper = np.searchsorted(differences, differences + AGREES, side="right")
    counts = upper - np.arange(len(differences))
    best = int(counts.argmax())
    # The agreeing pairs are those in the window; their median ignores outliers.
    coarse = float(np.median(differences[best : best + counts[best]]))
    pairs, possible = _agreeing(downs, landings, coarse, joints)
    elsewhere = np.abs(differences + AGREES / 2 - coarse) > _APART
    rival = int(counts[elsewhere].max()) if elsewhere.any() else 0
    if len(pairs) < NEEDED * possible or rival >= RIVAL * counts[best]:
        raise CaptureError(
            "the taps do not determine the offset of the clocks",
            where="--sync tap",
            got=f"{len(pairs)} of {possible} touch-downs agree, and {rival} at another offset",
            expected=f"at least {100 * NEEDED:g} % of the touch-downs, and no other offset with "
            f"{100 * RIVAL:g} % as many",
            remedy="Tap unevenly, a few times, or give --sync clock --offset S",
        )
    spread = float(np.median(np.abs(pairs - coarse)) * 1.4826 / np.sqrt(len(pairs)))
    return ClockOffset(coarse, max(spread, joints.period / 2), len(pairs), possible)


def refined_by_motion(
    coarse: ClockOffset, tracks: list[LabelledTrack], joints: JointTrack, rules: ConversionRules
) -> ClockOffset:
    """Refines an offset so that touches and their fingertips move alike.

    The mean displacement of each contact from its fingertip is subtracted, so that only movement
    counts. The given offset is returned if the movement gives no more precise offset.
    """
    offsets = coarse.offset + np.arange(-_FINE, _FINE + _STEP / 2, _STEP)
    error = np.zeros(len(offsets))
    samples = 0
    for one in tracks:
        times = sample_times(one.track, rules.rate)
        xy = one.track.at(times, rules.gap) * [1.0, -1.0]
        asked = (times + offsets[:, None]).ravel()
        tip, known = joints.tip_at(one.finger, asked, rules.gap)
        way = tip[:, :2].reshape(len(offsets), len(times), 2)
        seen = known.reshape(len(offsets), len(times)).all(axis=0)
        if seen.sum() > 2:
            off = way[:, seen] - xy[seen]
            error += ((off - off.mean(axis=1, keepdims=True)) ** 2).sum(axis=(1, 2))
            samples += int(seen.sum())
    best = int(error.argmin())
    if not samples or best in (0, len(offsets) - 1):
        return coarse
    a, b, c = error[best - 1 : best + 2]
    curvature = (a - 2 * b + c) / _STEP**2
    shift = 0.5 * (a - c) / (a - 2 * b + c) * _STEP if curvature > 0 else 0.0
    # Errors of one contact are correlated: a fifth of a second counts as one independent sample.
    independent = max(1.0, samples / rules.rate * 5)
    variance = max(b, 1e-12) / independent
    precision = float(np.sqrt(2 * variance / curvature)) if curvature > 0 else np.inf
    if precision > coarse.precision:
        return coarse
    return ClockOffset(float(offsets[best] + shift), precision, coarse.agreeing, coarse.taps)


def tip_landings(joints: JointTrack) -> Array:
    """Sorted times (n,) s on the poses' clock at which a fingertip came down to the surface."""
    landings: list[float] = []
    for z in joints.tips[..., 2].T:
        low = np.percentile(z, _LOW)
        lifted = False
        for i in range(1, len(z)):
            lifted |= bool(z[i - 1] > low + _FAR)
            if lifted and z[i] <= low + _NEAR:
                share = (z[i - 1] - low - _NEAR) / max(z[i - 1] - z[i], 1e-9)
                step = joints.time[i] - joints.time[i - 1]
                landings.append(float(joints.time[i - 1] + np.clip(share, 0, 1) * step))
                lifted = False
    return np.sort(np.array(landings))


def _agreeing(
    downs: Array, landings: Array, offset: float, joints: JointTrack
) -> tuple[Array, int]:
    """Time differences (s) of the touch-downs that have a landing, and the number of touch-downs
    within the time of the poses."""
    inside = (downs + offset > joints.time[0]) & (downs + offset < joints.time[-1])
    wanted = downs[inside] + offset
    after = np.clip(np.searchsorted(landings, wanted), 1, max(1, len(landings) - 1))
    near = landings[np.clip(after, 0, len(landings) - 1)]
    before = landings[after - 1]
    nearest = np.where(np.abs(before - wanted) < np.abs(near - wanted), before, near)
    agree = np.abs(nearest - wanted) <= AGREES
    return (nearest - downs[inside])[agree], int(inside.sum())
