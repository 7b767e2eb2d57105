"""Converts touches and poses, or poses alone, to a capture: labelled contacts on one time grid."""

from __future__ import annotations

from dataclasses import replace
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from encoders.capture import Capture
from encoders.captures.conversion.conversion_report import ConversionReport, ConversionRules
from encoders.captures.conversion.fingers import (
    LabelledTrack,
    distances,
    is_in_doubt,
    label_contacts,
)
from encoders.captures.conversion.hand_points import touches_from_tips
from encoders.captures.conversion.joint_track import JointTrack
from encoders.captures.conversion.synchronise import ClockOffset, offset_by_taps, refined_by_motion
from encoders.captures.conversion.touch_log import ContactTrack, TouchLog, valid_contacts
from models.arithmetic import Array
from models.errors import CaptureError
from models.frames import FINGERS

_ROUNDING = 1e-6
"""Tolerance (s) for rounded times."""


def assemble(
    tracks: list[LabelledTrack],
    joints: JointTrack,
    offset: float,
    rules: ConversionRules,
    report: ConversionReport,
    meta: dict[str, Any],
) -> Capture:
    """Creates the capture.

    Frames with one finger are dropped, as in the paper, because one touch does not determine the
    hand. Frames without a pose, and frames with a touch away from its finger, are dropped as well:
    a frame that lacks a touch would be a wrong training example.

    Args:
        tracks: Contacts with their fingers; a finger has at most one contact at a time.
        joints: Poses, on their own clock.
        offset: Poses' clock minus touches' clock (s).
        rules: `rate`, `gap`, `reach`, `pause`, `longest_take`.
        report: Receives the counts.
        meta: Metadata of the capture; rate and report are added.

    Raises:
        CaptureError: No frame is left.
    """
    if not tracks:
        raise CaptureError(
            "no contact is left",
            remedy=f"Dropped: {_dropped_text(report)}. Check the clocks' offset and the frame of "
            "the surface",
        )
    begin = min(one.track.start for one in tracks)
    end = max(one.track.end for one in tracks)
    time = begin + np.arange(int((end - begin) * rules.rate + 1 + _ROUNDING)) / rules.rate
    ids = np.full((len(time), len(FINGERS)), -1, np.int64)
    xy = np.full((len(time), len(FINGERS), 2), np.nan)
    away = np.zeros(len(time), bool)
    for number, one in enumerate(tracks):
        track = one.track
        inside = np.flatnonzero((time >= track.start - _ROUNDING) & (time < track.end - _ROUNDING))
        apart, known = distances(track, time[inside], joints, offset, rules)
        left = known & (apart[:, one.finger] > rules.reach)
        report.drop_parts("touches on frames in which their finger was elsewhere", int(left.sum()))
        away[inside[left]] = True
        inside = inside[~left]
        ids[inside, one.finger] = number
        xy[inside, one.finger] = track.at(time[inside], rules.gap)
    fingers = (ids >= 0).sum(axis=1)
    q, posed = joints.at(time + offset, rules.gap)
    report.drop_frames("with one finger", int((fingers == 1).sum()))
    report.drop_frames("without a pose", int(((fingers > 1) & ~posed).sum()))
    report.drop_frames(
        "with a finger away from its touch", int(((fingers > 1) & posed & away).sum())
    )
    keep = np.flatnonzero((fingers > 1) & posed & ~away)
    if not len(keep):
        raise CaptureError("no frame is left", remedy=f"Dropped: {_dropped_text(report)}")
    report.notes["kept_frames"] = len(keep)
    report.notes["kept_contacts"] = len(tracks)
    meta = {**meta, "rate_hz": rules.rate, "conversion": report.as_json()}
    return Capture(time[keep], _takes(time[keep], rules), ids[keep], xy[keep], q[keep], meta)


def whole_frames(
    capture: Capture,
    tracks: list[ContactTrack],
    labelled: list[LabelledTrack],
    report: ConversionReport,
) -> Capture:
    """Selects the frames in which every touch is labelled.

    A frame that lacks a touch would be a wrong training example.

    Args:
        capture: The capture.
        tracks: All contacts.
        labelled: The contacts that have a label.
        report: Receives the counts.

    Raises:
        CaptureError: No frame is left.
    """
    named = {id(one.track) for one in labelled}
    keep = np.ones(len(capture), bool)
    for one in tracks:
        if id(one) not in named:
            keep &= (capture.time < one.start) | (capture.time >= one.end)
    report.drop_frames("with a touch that has no name", int((~keep).sum()))
    if not keep.any():
        raise CaptureError(
            "no frame is left in which all touches have labels",
            remedy=f"Dropped: {_dropped_text(report)}",
        )
    kept = capture if keep.all() else capture.select(keep)
    report.notes["kept_frames"] = len(kept)
    return replace(kept, meta={**capture.meta, "conversion": report.as_json()})


def _takes(time: Array, rules: ConversionRules) -> NDArray[np.int64]:
    """Take number (T,) of every frame. A new take begins after a pause, and when a take reaches its
    longest duration."""
    starts = np.flatnonzero(np.diff(time, prepend=-np.inf) > rules.pause + _ROUNDING)
    take = np.zeros(len(time), np.int64)
    number = 0
    for a, b in zip(starts, [*starts[1:], len(time)], strict=True):
        inner = ((time[a:b] - time[a]) // rules.longest_take).astype(np.int64)
        take[a:b] = number + inner
        number += int(inner[-1]) + 1
    return take


def _dropped_text(report: ConversionReport) -> str:
    counts = {**report.contacts, **report.frames, **report.parts}
    return "; ".join(f"{count} {reason}" for reason, count in counts.items()) or "nothing"


Sync = Literal["clock", "tap"]


def capture_from_touches(
    log: TouchLog,
    joints: JointTrack,
    sync: Sync,
    offset: float,
    rules: ConversionRules,
    report: ConversionReport,
    meta: dict[str, Any],
) -> Capture:
    """Creates a capture from touches and poses that were recorded at the same time.

    Args:
        log: The touches; x of a left hand is already mirrored.
        joints: The poses.
        sync: `clock`: both clocks differ by `offset`. `tap`: the offset is estimated from taps.
        offset: Poses' clock minus touches' clock (s).
        rules: Rules for dropping contacts and frames.
        report: Receives the counts of dropped contacts and frames.
        meta: Metadata of the capture.

    Raises:
        CaptureError: Touches and poses do not match, or the taps are ambiguous.
    """
    tracks = valid_contacts(log, rules, report)
    if sync == "tap":
        clock_offset = offset_by_taps(tracks, joints)
        # Contacts that are refused at the first offset may be accepted at the refined offset, so
        # these refusals are not reported.
        trial = ConversionReport()
        labelled = label_contacts(tracks, joints, clock_offset.offset, rules, trial)
        clock_offset = refined_by_motion(clock_offset, labelled, joints, rules)
    else:
        clock_offset = ClockOffset(offset, 0.0, 0, 0)
    report.notes["sync"] = sync
    report.notes["offset_s"] = round(clock_offset.offset, 6)
    if sync == "tap":
        report.notes["offset_precision_s"] = round(clock_offset.precision, 6)
        report.notes["taps_agreeing"] = f"{clock_offset.agreeing} of {clock_offset.taps}"
    labelled = label_contacts(tracks, joints, clock_offset.offset, rules, report)
    if not labelled:
        raise CaptureError(
            "no touch is near a fingertip",
            got="; ".join(f"{n} contacts: {reason}" for reason, n in report.contacts.items()),
            remedy="Check --offset, --side, --surface, and that the poses are in the frame of the "
            "surface",
        )
    apart = float(np.median([one.distance for one in labelled]))
    report.notes["touch_to_fingertip_mm"] = round(1000 * apart, 2)
    capture = assemble(labelled, joints, clock_offset.offset, rules, report, meta)
    # A contact near no fingertip may be a palm, and its frames are not dropped.
    doubtful = [one for one in tracks if is_in_doubt(one, joints, clock_offset.offset, rules)]
    return whole_frames(capture, doubtful, labelled, report)


def capture_from_poses(
    joints: JointTrack,
    threshold: float,
    rules: ConversionRules,
    report: ConversionReport,
    meta: dict[str, Any],
) -> Capture:
    """Creates a capture whose touches are the fingertips near the surface.

    Args:
        joints: Poses in the frame of the surface.
        threshold: Height (m) above a touching fingertip's height at which a touch begins.
        rules: Rules for dropping contacts and frames.
        report: Receives the counts of dropped contacts and frames.
        meta: Metadata of the capture.

    Raises:
        CaptureError: No finger comes near the surface, or never two fingers at the same time.
    """
    if not 0 < threshold < 0.05:
        raise CaptureError(
            "the touch height is out of range", got=threshold, expected="0 to 0.05 m"
        )
    labelled = touches_from_tips(joints, threshold, rules, report)
    report.notes["touches"] = f"fingertips within {1000 * threshold:g} mm of the surface"
    return assemble(labelled, joints, 0.0, rules, report, meta)
