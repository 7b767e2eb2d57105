"""Converts touches and frames of a 3-D device to a capture, in five steps.

1. The hand, held open at the beginning, is measured (PAALM's calibration).
2. Every frame becomes a pose and labelled fingertips, in the device's frame.
3. The plane on which fingertips rest gives heights. Touch-downs and landings of fingertips give the
  offset of the clocks.
4. Three estimates alternate: the labels of touches, the offset at which touches move like their
  fingertips, and the device's pose from touches and fingertips of the same moments.
5. Poses are transformed to the surface frame, and corrected so that touching fingertips meet their
  touches.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any, Literal

import numpy as np

from encoders.capture import Capture
from encoders.captures.conversion.assemble import assemble, whole_frames
from encoders.captures.conversion.conversion_report import ConversionReport, ConversionRules
from encoders.captures.conversion.fingers import RESTING, LabelledTrack, sample_times
from encoders.captures.conversion.surface_frame import frame_from_fingertips
from encoders.captures.conversion.synchronise import ClockOffset, offset_by_taps, refined_by_motion
from encoders.captures.conversion.touch_log import ContactTrack, TouchLog, valid_contacts
from encoders.captures.paired.hand_track import HandTrack, hand_track
from encoders.captures.paired.registration import DevicePose, first_guess, register
from encoders.correction import FingertipCorrection, tip_targets
from encoders.paalm.calibration import HandCalibration
from models.arithmetic import Array
from models.errors import CaptureError
from models.frames import FINGERS, HandFrame
from models.pose import JOINTS, POSE_SIZE, ROOT_POSITION, ROOT_ROTATION

ONE_CLOCK = 0.5
"""Largest difference (s) between the latencies of two devices that are recorded with one clock."""

Correct = Literal["unseen", "all", "none"]

_ROUNDS = 3
_SAMPLES = 1500
"""Number of samples of touches for the first guess; more samples take longer without a better
result."""
_NEAR_PLANE = 0.012
"""Distance (m) from the plane of resting fingertips within which a finger may touch."""

POSE_ERROR = (0.004, np.deg2rad(2.0), np.deg2rad(8.0))
"""Standard deviations of a pose by PAALM: position (m), rotation and joints (rad). See
docs/paalm.md. The correction leaves parts of the pose that the touches do not determine."""


def capture_from_hands(
    log: TouchLog,
    frames: Sequence[HandFrame],
    time: Array,
    calibration: HandCalibration,
    rules: ConversionRules,
    report: ConversionReport,
    meta: dict[str, Any],
    *,
    one_clock: bool = True,
    offset: float | None = None,
    correct: Correct = "unseen",
) -> Capture:
    """Creates the capture of a session with both devices.

    Args:
        log: The touches; x of a left hand is already mirrored.
        frames: The device's frames.
        time: (F,) s, times of the frames.
        calibration: Calibration of the hand.
        rules: Rules for dropping contacts and frames.
        report: Receives the counts of dropped contacts and frames, and estimated values.
        meta: Metadata of the capture.
        one_clock: True if touches and frames have times of the same clock, apart from latencies.
        offset: The frames' clock minus the touches' clock (s), if known; None estimates it from
            taps.
        correct: Which touching fingertips are corrected to their touches: `unseen`, those that the
            device does not see; `all`; or `none`.

    Raises:
        CaptureError: The recordings do not match; the error gives the reason.
    """
    track, share = hand_track(frames, time, calibration)
    tracks = valid_contacts(log, rules, report)
    _overlap(tracks, track, ONE_CLOCK if one_clock else None, offset)
    plane = _plane(track)
    clock = ClockOffset(offset or 0.0, 0.0, 0, 0)
    if offset is None:
        clock = offset_by_taps(tracks, track.placed(plane), ONE_CLOCK if one_clock else None)
    place = _first(tracks, track, plane, clock.offset, rules)
    labelled: list[LabelledTrack] = []
    for _ in range(_ROUNDS):
        here = track.placed(place)
        labelled = label_by_fingertips(tracks, here, clock.offset, rules, ConversionReport())
        if not labelled:
            break
        if offset is None:
            clock = refined_by_motion(clock, labelled, here, rules)
        place = register(*_pairs(labelled, track, clock.offset, rules))
    here = track.placed(place)
    labelled = label_by_fingertips(tracks, here, clock.offset, rules, report)
    if not labelled:
        raise CaptureError(
            "no touch is near a fingertip",
            got="; ".join(f"{n} contacts: {reason}" for reason, n in report.contacts.items()),
            remedy="Check --side and --surface",
        )
    _note(report, clock, place, share, offset is None)
    # Without reported bones, a finger may be unseen, and PAALM only guesses its place. The touch is
    # then more accurate, so no frame is dropped for a distance between touch and guess.
    near = rules if calibration.bones is not None else replace(rules, reach=np.inf)
    capture = assemble(labelled, here, clock.offset, near, report, meta)
    capture = whole_frames(capture, tracks, labelled, report)
    return capture if correct == "none" else corrected(capture, here, clock.offset, rules, correct)


def _overlap(
    tracks: list[ContactTrack], track: HandTrack, slack: float | None, offset: float | None
) -> None:
    if not tracks:
        raise CaptureError(
            "no usable touch is left",
            where="touches",
            expected="touches that are not glitches",
        )
    if slack is None and offset is None:
        return
    shift, room = offset or 0.0, slack or 0.0
    begin, end = min(t.start for t in tracks) + shift, max(t.end for t in tracks) + shift
    if end < track.time[0] - room or begin > track.time[-1] + room:
        raise CaptureError(
            "the two recordings do not overlap in time",
            got=f"touches from {begin:.1f} to {end:.1f} s, the hand from {track.time[0]:.1f} to "
            f"{track.time[-1]:.1f} s",
            remedy="Record both at the same time, with `sandbox capture record`",
        )


def _plane(track: HandTrack) -> DevicePose:
    """Pose of the device in a frame whose z is the height above the plane on which fingertips
    rest."""
    shown = np.isfinite(track.seen[..., 0]).any(axis=1)
    try:
        frame = frame_from_fingertips(track.seen[shown], track.q[shown, ROOT_POSITION])
    except CaptureError as error:
        raise CaptureError(
            "the fingertips never rest on a plane, so that no tap is detected",
            got=error.got,
            remedy="Keep the hand in the device's view while it touches",
        ) from None
    return DevicePose(frame.rotation.T, -frame.rotation.T @ frame.origin, 0.0, 0)


def _first(
    tracks: list[ContactTrack],
    track: HandTrack,
    plane: DevicePose,
    offset: float,
    rules: ConversionRules,
) -> DevicePose:
    """Estimates the device's pose roughly, without labels of touches."""
    times = [sample_times(t, rules.rate) for t in tracks]
    xy = np.concatenate([t.at(s, rules.gap) for t, s in zip(tracks, times, strict=True)])
    moments = np.concatenate(times) + offset
    some = np.linspace(0, len(xy) - 1, min(_SAMPLES, len(xy))).astype(int)
    tips, known = track.placed(plane).tips_at(moments[some], rules.gap)
    rows = np.flatnonzero(known)
    guess = first_guess(xy[some][rows] * [1.0, -1.0], rows, tips, _NEAR_PLANE)
    return DevicePose(
        guess.rotation @ plane.rotation,
        guess.rotation @ plane.shift + guess.shift,
        guess.miss,
        guess.pairs,
    )


def _pairs(
    labelled: list[LabelledTrack], track: HandTrack, offset: float, rules: ConversionRules
) -> tuple[Array, Array]:
    """Touches (R, 2), y up, and their fingertips (R, 3) in the device's frame."""
    touches, fingertips = [], []
    for one in labelled:
        times = sample_times(one.track, rules.rate)
        tips, known = track.seen_at(times + offset, rules.gap)
        touches.append(one.track.at(times, rules.gap)[known] * [1.0, -1.0])
        fingertips.append(tips[known, one.finger])
    return np.concatenate(touches), np.concatenate(fingertips)


def corrected(
    capture: Capture,
    track: HandTrack,
    offset: float,
    rules: ConversionRules,
    which: Correct,
    error: tuple[float, float, float] = POSE_ERROR,
) -> Capture:
    """Corrects poses so that touching fingertips are at their touches.

    Args:
        capture: The capture.
        track: The hand, in the frame of the surface.
        offset: The hand's clock minus the touches' clock (s).
        rules: `gap`.
        which: Which touching fingertips are corrected: `unseen`, those that the device does not
            see, while seen fingertips stay where they were seen; or `all`.
        error: Standard deviations of a pose in position (m), rotation and joints (rad).
    """
    tips, _ = track.seen_at(capture.time + offset, rules.gap)
    unseen = np.isnan(tips[..., 0])
    covariance = np.empty(POSE_SIZE)
    covariance[ROOT_POSITION], covariance[ROOT_ROTATION], covariance[JOINTS] = error
    correction = FingertipCorrection(track.skeleton, np.diag(covariance**2))
    targets = tip_targets(capture.xy)
    q = capture.q.copy()
    if which == "unseen":
        targets = np.where(unseen[..., None] & capture.down[..., None], targets, tips)
    for i, down in enumerate(capture.down):
        if which == "unseen" and not (unseen[i] & down).any():
            continue
        fingers = np.flatnonzero(down if which == "all" else down | ~unseen[i])
        q[i] = correction.correct(q[i], fingers, targets[i, fingers]).q
    return replace(capture, q=q)


def _note(
    report: ConversionReport, clock: ClockOffset, place: DevicePose, share: float, taps: bool
) -> None:
    report.notes["sync"] = "tap" if taps else "clock"
    report.notes["offset_s"] = round(clock.offset, 6)
    if taps:
        report.notes["offset_precision_s"] = round(clock.precision, 6)
        report.notes["taps_agreeing"] = f"{clock.agreeing} of {clock.taps}"
    report.notes["hand_seen_percent"] = round(100.0 * share, 1)
    report.notes["device_at_m"] = [round(v, 4) for v in place.shift.tolist()]
    report.notes["device_axes"] = np.round(place.rotation, 4).tolist()
    report.notes["touch_to_fingertip_mm"] = round(1000 * place.miss, 2)


BESIDE = 0.015
"""Distance (m) from a touch within which a visible fingertip labels the touch. A neighbouring
finger may be as near to the touch, but if it is visible, it is nearer to its own touch."""

_VOTES = 3
"""Number of moments at which a fingertip must be seen beside a touch to label it."""


def label_by_fingertips(
    tracks: list[ContactTrack],
    track: HandTrack,
    offset: float,
    rules: ConversionRules,
    report: ConversionReport,
) -> list[LabelledTrack]:
    """Labels contacts; contacts that cannot be labelled are counted and left out.

    A fingertip that is seen beside a touch labels the touch. But the first Leap software loses bent
    fingers, and PAALM then guesses their places. A touch without a seen fingertip gets the finger
    with the nearest guessed tip, among the fingers that are neither seen elsewhere nor used by
    another touch.

    Args:
        tracks: Contacts.
        track: The hand, in the frame of the surface.
        offset: The hand's clock minus the touches' clock (s).
        rules: `reach`, `doubt`, `gap`, `rate`.
        report: Receives the counts.
    """
    seen = [_distances(one, track, offset, rules, held=False) for one in tracks]
    labelled: dict[int, LabelledTrack] = {}
    for number in sorted(range(len(tracks)), key=lambda n: _least(seen[n])):
        off = seen[number]
        votes = off[(off < BESIDE).any(axis=1)]
        if len(votes) < min(_VOTES, len(off)) or not len(votes):
            continue
        share = np.bincount(votes.argmin(axis=1), minlength=len(FINGERS)) / len(votes)
        finger = int(share.argmax())
        if share[finger] < 1 - rules.doubt or finger in _taken(tracks, number, labelled):
            continue
        there = votes[:, finger][np.isfinite(votes[:, finger])]
        labelled[number] = LabelledTrack(tracks[number], finger, float(np.median(there)))
    for number, one in enumerate(tracks):
        if number in labelled:
            continue
        off = _distances(one, track, offset, rules, held=True)
        if not np.isfinite(off).any():
            report.drop_contacts("no pose at their time")
            continue
        typical = np.median(off[np.isfinite(off).any(axis=1)], axis=0)
        for finger in range(len(FINGERS)):
            shown = seen[number][:, finger]
            shown = shown[np.isfinite(shown)]
            # The finger was seen elsewhere.
            if len(shown) >= _VOTES and np.median(shown) > rules.reach:
                typical[finger] = np.inf
        typical[list(_taken(tracks, number, labelled))] = np.inf
        finger = int(typical.argmin())
        if not np.isfinite(typical[finger]) or typical[finger] > 2 * rules.reach:
            report.drop_contacts(f"no free fingertip within {2000 * rules.reach:g} mm")
            continue
        labelled[number] = LabelledTrack(one, finger, float(typical[finger]))
    return [labelled[n] for n in sorted(labelled)]


def _distances(
    one: ContactTrack, track: HandTrack, offset: float, rules: ConversionRules, held: bool
) -> Array:
    """Distances (m, 5) m from a contact to fingertips; infinite where unknown.

    `held`: True also uses the fingertips that PAALM guesses, False only those that were seen.
    """
    times = sample_times(one, rules.rate)
    look = track.tips_at if held else track.seen_at
    tips, known = look(times + offset, rules.gap)
    xy = one.at(times, rules.gap) * [1.0, -1.0]
    above = np.maximum(tips[..., 2] - RESTING, 0.0)
    off = np.sqrt(((tips[..., :2] - xy[:, None]) ** 2).sum(axis=2) + above**2)
    return np.where(known[:, None] & ~np.isnan(off), off, np.inf)


def _least(off: Array) -> float:
    """Median distance (m) from a contact to the nearest fingertip; infinite if none is known."""
    return float(np.median(off.min(axis=1))) if len(off) else np.inf


def _taken(tracks: list[ContactTrack], number: int, labelled: dict[int, LabelledTrack]) -> set[int]:
    """Fingers of labelled contacts that are down at the same time as contact `number`."""
    own = tracks[number]
    return {
        other.finger
        for n, other in labelled.items()
        if n != number and own.start < other.track.end and other.track.start < own.end
    }
