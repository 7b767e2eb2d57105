"""Converts a touch log and poses, or poses alone, to a capture."""

from __future__ import annotations

from typing import Any, Literal

import numpy as np

from encoders.capture import Capture
from encoders.captures.conversion.assemble import assemble, whole_frames
from encoders.captures.conversion.fingers import is_in_doubt, label_contacts
from encoders.captures.conversion.hand_points import touches_from_tips
from encoders.captures.conversion.joint_track import JointTrack
from encoders.captures.conversion.report import ConversionReport, ConversionRules
from encoders.captures.conversion.synchronise import ClockOffset, offset_by_taps, refined_by_motion
from encoders.captures.conversion.touch_log import TouchLog, valid_contacts
from models.errors import CaptureError

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
        offset: s, the poses' clock minus the touches' clock.
        rules: Rules for dropping contacts and frames.
        report: Receives the counts of dropped ones.
        meta: Metadata of the capture.

    Raises:
        CaptureError: Touches and poses do not match, or the taps are ambiguous.
    """
    tracks = valid_contacts(log, rules, report)
    if sync == "tap":
        clock_offset = offset_by_taps(tracks, joints)
        trial = (
            ConversionReport()
        )  # contacts refused at the first offset may be accepted at the refined one
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
    # What is near no fingertip may be a palm, and takes no frames with it.
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
        threshold: m above a touching fingertip's height at which a touch begins.
        rules: Rules for dropping contacts and frames.
        report: Receives the counts of dropped ones.
        meta: Metadata of the capture.

    Raises:
        CaptureError: No finger comes near the surface, or never two at a time.
    """
    if not 0 < threshold < 0.05:
        raise CaptureError(
            "the touch height is out of range", got=threshold, expected="0 to 0.05 m"
        )
    labelled = touches_from_tips(joints, threshold, rules, report)
    report.notes["touches"] = f"fingertips within {1000 * threshold:g} mm of the surface"
    return assemble(labelled, joints, 0.0, rules, report, meta)
