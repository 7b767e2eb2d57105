"""Converts points on a hand, markers or joints, to poses of our skeleton and to touches."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np
from numpy.typing import NDArray

from encoders.captures.conversion.fingers import LabelledTrack
from encoders.captures.conversion.joint_track import JointTrack
from encoders.captures.conversion.report import ConversionReport, ConversionRules
from encoders.captures.conversion.sites import PALM, Site
from encoders.captures.conversion.skeleton_fit import fit_skeleton
from encoders.captures.conversion.surface_frame import ON_PLANE, SurfaceFrame, frame_from_fingertips
from encoders.captures.conversion.touch_log import ContactTrack
from models.arithmetic import Array
from models.errors import CaptureError
from models.frames import FINGERS
from models.skeleton import Skeleton

_KEPT = 2e-6
"""s by which a touch lasts longer than its last pose, so that this one is within it; times are
rounded to half of that."""

ON_SURFACE = 0.006
"""m, height of a touching fingertip's centre: its radius minus the compressed flesh."""

POOR_FIT = 0.010
"""m, root mean square distance between observed and modelled points beyond which a frame is
dropped."""

SURPRISE = 3.0
"""Standard deviations from its expected place beyond which a point does not belong to the hand."""

LETS_GO = 1.5
"""Factor between the heights at which a touch ends and begins, so that touches do not flicker."""


def joints_from_points(
    time: Array,
    points: Mapping[str, Array],
    sites: Mapping[str, Site],
    frame: SurfaceFrame | None,
    skeleton: Skeleton,
    report: ConversionReport,
    *,
    left: bool = False,
    tolerance: float = ON_PLANE,
    progress: Callable[[float], None] | None = None,
) -> JointTrack:
    """Computes poses of a hand from recorded points.

    Args:
        time: (T,) s.
        points: Positions (T, 3) m by name, in the recorder's frame, NaN where not seen.
        sites: Places on the hand by the same names.
        frame: Frame of the surface; None estimates the plane on which fingertips rest.
        skeleton: Our skeleton, whose size is fitted.
        report: Receives residuals and counts.
        left: True for a left hand, which is mirrored into a right one.
        tolerance: m from an estimated plane within which a fingertip rests on it.
        progress: Called with the share done, 0 to 1.

    Raises:
        CaptureError: The hand is not seen, does not fit, or does not rest on a plane.
    """
    names = list(sites)
    recorded = np.stack([points[name] for name in names], axis=1)
    chosen = [sites[name] for name in names]
    palm = np.array([site.bone == PALM for site in chosen])
    outermost = [] if frame is not None else _tip_points(chosen, skeleton)
    if frame is None:
        middle = _middle(recorded[:, palm])
        frame = frame_from_fingertips(recorded[:, outermost], middle, tolerance)
    placed = frame.points(recorded)
    if left:
        placed = placed * [-1.0, 1.0, 1.0]
    hand = fit_skeleton(placed, chosen, skeleton, progress)
    odd = int(hand.surprise.argmax())
    if hand.surprise[odd] > SURPRISE:
        raise CaptureError(
            "a point is not at its expected place on the hand",
            got=f"{names[odd]} as {chosen[odd].name}",
            remedy="Check the mapping for swapped names, and the side (--side)",
        )
    with np.errstate(invalid="ignore"):
        seen = ~np.isnan(hand.residual)
        squares = np.where(seen, hand.residual, 0.0) ** 2
        rms = np.sqrt(squares.sum(axis=1) / np.maximum(seen.sum(axis=1), 1))
    whole = ~np.isnan(hand.q).any(axis=1)
    fits = whole & (rms <= POOR_FIT)
    report.drop_parts("poses without enough points", int((~whole).sum()))
    poor = int((whole & ~fits).sum())
    report.drop_parts(f"poses that missed their points by {1000 * POOR_FIT:g} mm", poor)
    if fits.sum() < 2:
        raise CaptureError(
            "the skeleton does not fit the points",
            got=f"{1000 * float(np.median(rms[whole])):.0f} mm apart",
            expected=f"{1000 * POOR_FIT:g} mm",
            remedy="Check the mapping, the side (--side) and the unit",
        )
    used = squares[fits]
    report.notes["hand_scale"] = round(hand.scale, 4)
    report.notes["residual_mm"] = round(1000 * float(np.sqrt(used.sum() / seen[fits].sum())), 2)
    worst = np.sqrt(used.sum(axis=0) / np.maximum(seen[fits].sum(axis=0), 1))
    report.notes["worst_point"] = names[int(worst.argmax())]
    report.notes["worst_point_mm"] = round(1000 * float(worst.max()), 2)
    joints = JointTrack(time[fits], hand.q[fits], hand.skeleton)
    if not outermost:
        return joints
    with np.errstate(invalid="ignore"):
        return _on_the_surface(joints, np.abs(placed[fits][:, outermost, 2]) < tolerance)


def _middle(palm: Array) -> Array:
    """Middle (T, 3) of points of the palm (T, n, 3), where all of them are seen.

    If they never are, as one of them may be missing in a whole recording, it is that of the points
    that are.
    """
    middle: Array = palm.mean(axis=1)
    if not np.isnan(middle).any(axis=1).all():
        return middle
    seen = np.asarray(~np.isnan(palm).any(axis=2))
    count = seen.sum(axis=1)[:, None]
    sums = np.where(seen[:, :, None], palm, 0.0).sum(axis=1)
    return np.where(count > 0, sums / np.maximum(count, 1), np.nan)


def _tip_points(sites: list[Site], skeleton: Skeleton) -> list[int]:
    """Index (5,) of each finger's outermost point."""
    out = []
    for finger in range(len(FINGERS)):
        last = max(i for i, bone in enumerate(skeleton.bones) if bone.finger == finger)
        on_it = [i for i, site in enumerate(sites) if site.bone == last]
        if not on_it:
            raise CaptureError(
                "no point on a fingertip, so no surface can be estimated",
                got=f"none on the last bone of the {FINGERS[finger]}",
                remedy="Give the surface's corners in the --mapping file",
            )
        out.append(max(on_it, key=lambda i: float(sites[i].at[1])))
    return out


def _on_the_surface(joints: JointTrack, resting: NDArray[np.bool_]) -> JointTrack:
    """Shifts the poses to the height at which resting tips (J, 5) touch, since the plane was that
    of markers."""
    q = joints.q.copy()
    q[:, 2] += ON_SURFACE - np.median(joints.tips[..., 2][resting])
    return JointTrack(joints.time, q, joints.skeleton)


def touches_from_tips(
    joints: JointTrack, threshold: float, rules: ConversionRules, report: ConversionReport
) -> list[LabelledTrack]:
    """Derives labelled touches, on the poses' clock, from fingertips near the surface.

    Args:
        joints: Poses in the frame of the surface.
        threshold: m above the height of a touching fingertip's centre at which a touch begins; it
            ends at one and a half times that.
        rules: `shortest`, `gap`.
        report: Receives the counts.
    """
    out = []
    height = joints.tips[..., 2] - ON_SURFACE
    xy = joints.tips[..., :2] * [1.0, -1.0]
    breaks = np.diff(joints.time, append=np.inf) > max(rules.gap, 1.5 * joints.period)
    number = 0
    for finger in range(len(FINGERS)):
        down = False
        begin = 0
        for i, z in enumerate(height[:, finger]):
            if not down and z < threshold:
                down, begin = True, i
            if down and (z > LETS_GO * threshold or breaks[i]):
                stop = i if z > LETS_GO * threshold else i + 1
                end = float(joints.time[i]) + (0.0 if stop == i else _KEPT)
                if stop <= begin or end - joints.time[begin] < rules.shortest:
                    report.drop_contacts(f"shorter than {1000 * rules.shortest:g} ms")
                else:
                    part = slice(begin, stop)
                    track = ContactTrack(number, joints.time[part], xy[part, finger], end)
                    out.append(LabelledTrack(track, finger, 0.0))
                    number += 1
                down = False
    return sorted(out, key=lambda one: one.track.start)
