"""Assembles labelled contacts and poses on one time grid to a capture."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from encoders.capture import Capture
from encoders.captures.conversion.fingers import LabelledTrack, distances
from encoders.captures.conversion.joint_track import JointTrack
from encoders.captures.conversion.report import ConversionReport, ConversionRules
from encoders.captures.conversion.touch_log import ContactTrack
from models.arithmetic import Array
from models.errors import CaptureError
from models.frames import FINGERS

_ROUNDING = 1e-6
"""s, tolerance for rounded times."""


def assemble(
    tracks: list[LabelledTrack],
    joints: JointTrack,
    offset: float,
    rules: ConversionRules,
    report: ConversionReport,
    meta: dict[str, Any],
) -> Capture:
    """Creates the capture.

    Frames with one finger are dropped, as in the paper: one touch does not determine the hand.
    Frames without a pose, and frames with a touch away from its finger, are dropped as well: a
    missing touch would be a wrong training example.

    Args:
        tracks: Contacts with their fingers; no two of one finger at a time.
        joints: Poses, on their own clock.
        offset: s, the poses' clock minus the touches' clock.
        rules: `rate`, `gap`, `reach`, `pause`, `longest_take`.
        report: Receives the counts.
        meta: Metadata of the capture; rate and report are added.

    Raises:
        CaptureError: No frame is left.
    """
    if not tracks:
        raise CaptureError(
            "no contact is left", remedy=f"Dropped: {_dropped_text(report)}. Check clock and frame"
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
    """Selects the frames in which every touch is labelled: a missing touch would be a wrong
    training example.

    Args:
        capture: The capture.
        tracks: All contacts.
        labelled: Those with a name.
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
        raise CaptureError("no frame is left in which all touches have names")
    kept = capture if keep.all() else capture.select(keep)
    report.notes["kept_frames"] = len(kept)
    return replace(kept, meta={**capture.meta, "conversion": report.as_json()})


def _takes(time: Array, rules: ConversionRules) -> NDArray[np.int64]:
    """Take number (T,) of every frame: a new take begins after a pause, and when one gets too
    long."""
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
