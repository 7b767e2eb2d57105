"""The hand of a recording of a 3-D device: its measurement, and its poses and fingertips over time.

The hand is held open at the beginning of a recording, and measured by PAALM's calibration.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter1d

from encoders.captures.conversion.joint_track import JointTrack
from encoders.captures.paired.registration import DevicePose
from encoders.paalm import Paalm, PaalmOptions
from encoders.paalm.average import with_reported_coupling
from encoders.paalm.calibration import HandCalibration
from encoders.paalm.hand_pose import PALM_CENTRE, hand_pose
from encoders.paalm.rig import bone_lengths
from models.arithmetic import Array
from models.errors import CaptureError, EncoderError
from models.frames import FINGERS, HandFrame, TrackedHand
from models.pose import ROOT_POSITION, ROOT_ROTATION, mirrored
from models.rotations import exp, log, unwrapped
from models.skeleton import ADULT, Bone, Skeleton

OPEN_FRAMES = 200
"""Number of frames of the open hand; the paper used 1000 frames, which lasted 10 s."""

_EVERY = 20
"""Number of frames between two checks for an open hand."""


def open_hand(frames: Sequence[HandFrame], side: str, wanted: int = OPEN_FRAMES) -> HandCalibration:
    """Measures the hand that is held open at the beginning of a recording.

    A device that reports joints also sends frames without a hand. If there are too many such frames
    at first, or if the hand is opened later, the first frames with an open hand are used.

    Args:
        frames: All frames of the recording.
        side: `right` or `left`.
        wanted: Number of frames with all five fingers that are needed to measure a hand.

    Raises:
        EncoderError: The hand is not held open; the error gives the reason.
    """
    try:
        which: Any = side
        return Paalm().calibrate(frames, which, wanted)[side]
    except EncoderError:
        search = OpenHandSearch(side, wanted)
        for frame in frames:
            found = search.add(frame)
            if found is not None:
                return found
        raise


class OpenHandSearch:
    """Searches for the first frames in which a hand with known joints is held open.

    Args:
        side: `right` or `left`.
        wanted: Number of frames with all five fingers that are needed to measure a hand.

    Attributes:
        seen: Number of frames with all five fingers among the latest 2 `wanted` frames, at most
            `wanted`. It is updated every 20 frames.
        refused: Reason why the last hand that was checked is not open; empty before the first
            check.
    """

    def __init__(self, side: str, wanted: int = OPEN_FRAMES) -> None:
        self.seen = 0
        self.refused = ""
        self._side: Any = side
        self._wanted, self._until_look = wanted, 0
        # All five fingers must be seen in half of these frames.
        self._frames: deque[HandFrame] = deque(maxlen=2 * wanted)

    def add(self, frame: HandFrame) -> HandCalibration | None:
        """Processes a frame; returns the measured hand once it is held open, until then None."""
        if not self._frames and not self._whole(frame):
            return None
        self._frames.append(frame)
        self._until_look -= 1
        if self._until_look > 0:
            return None
        self._until_look = _EVERY
        whole = sum(self._whole(each) for each in self._frames)
        self.seen = min(whole, self._wanted)
        if whole < self._wanted:
            return None
        try:
            return Paalm().calibrate(self._latest(), self._side, self._wanted)[self._side]
        except EncoderError as error:
            self.refused = error.what
            return None

    def _latest(self) -> list[HandFrame]:
        """The shortest run of latest frames that contains `wanted` whole hands."""
        frames, whole = list(self._frames), 0
        for begin in range(len(frames) - 1, -1, -1):
            whole += self._whole(frames[begin])
            if whole == self._wanted:
                return frames[begin:]
        return frames

    def _whole(self, frame: HandFrame) -> bool:
        return any(
            is_whole(hand, self._side) and all(f.joints for f in hand.fingers)
            for hand in frame.hands
        )


def is_whole(hand: TrackedHand, side: str) -> bool:
    """True if a hand has five fingers, and is not reported as a hand of the other side."""
    return hand.side in (None, side) and len(hand.fingers) == len(FINGERS)


SMOOTHING = 0.02
"""Standard deviation (s) of the smoothing filter. The filter is symmetric in time and adds no
delay."""

LONGEST_GAP = 0.1
"""Time (s) without the hand after which a new piece of the track begins."""


@dataclass(frozen=True)
class HandTrack(JointTrack):
    """Poses by PAALM, and the fingertips that the device saw.

    Attributes:
        seen: (J, 5, 3) m, fingertips that the device saw; NaN where it saw none.
    """

    seen: Array

    @cached_property
    def tips(self) -> Array:
        """Fingertips (J, 5, 3) m: seen fingertips, otherwise those of the pose."""
        return np.where(np.isnan(self.seen), self.kinematics.tips(self.q), self.seen)

    def seen_at(self, times: Array, gap: float) -> tuple[Array, NDArray[np.bool_]]:
        """Seen fingertips (m, 5, 3) m at times (m,) s, NaN where not seen.

        Also returns booleans (m,): True where there are frames.
        """
        before, share, known = self._between(times, gap)
        a, b = self.seen[before], self.seen[before + 1]
        return a + share[:, None, None] * (b - a), known

    def tip_at(self, finger: int, times: Array, gap: float) -> tuple[Array, NDArray[np.bool_]]:
        """Interpolates one fingertip (m, 3) m as the device saw it, at times (m,) s.

        Also returns booleans (m,): True where the device saw it.
        """
        tips, known = self.seen_at(times, gap)
        known = known & np.isfinite(tips[:, finger]).all(axis=1)
        return np.where(known[:, None], tips[:, finger], 0.0), known

    def placed(self, at: DevicePose) -> HandTrack:
        """Transforms the track to another frame, in which the device has the pose `at`."""
        q = self.q.copy()
        q[:, ROOT_POSITION] = at.points(q[:, ROOT_POSITION])
        q[:, ROOT_ROTATION] = log(at.rotation @ exp(q[:, ROOT_ROTATION]))
        return replace(self, q=q, seen=at.points(self.seen))


def hand_track(
    frames: Sequence[HandFrame], time: Array, calibration: HandCalibration
) -> tuple[HandTrack, float]:
    """Tracks the calibrated hand of a recording, as a right hand in the device's frame.

    A left hand is mirrored: its x changes sign.

    Args:
        frames: All frames of the recording.
        time: (F,) s, times of the frames, on the clock of the returned track.
        calibration: Calibration of the hand.

    Returns:
        The track, and the share of frames that show the hand.

    Raises:
        CaptureError: The hand is hardly seen.
    """
    left = calibration.side == "left"
    skeleton, centre = skeleton_of(calibration)
    paalm = Paalm(PaalmOptions(smoothing=0.0))
    paalm.use({calibration.side: with_reported_coupling(calibration, frames)})
    rows, q, seen = [], [], []
    for row, frame in enumerate(frames):
        hand = paalm.step(frame).hands.get(calibration.side)
        if hand is None or not hand.seen:
            continue
        pose = hand_pose(hand.table, hand.palm, calibration.side)
        pose = mirrored(pose) if left else pose
        # `hand_pose` places an average palm; the wrist follows from this person's own bones.
        pose[ROOT_POSITION] += exp(pose[ROOT_ROTATION]) @ np.subtract(PALM_CENTRE, centre)
        rows.append(row)
        q.append(pose)
        seen.append(_tips(frame.hands, hand.ids, left))
    if len(rows) < 2 or len(rows) < 0.05 * len(frames):
        raise CaptureError(
            f"the {calibration.side} hand is hardly seen in the recording",
            got=f"{len(rows)} of {len(frames)} frames",
            remedy="Check --side, and that the hand is within the device's view",
        )
    moments = time[rows]
    ahead = np.concatenate([[True], np.diff(moments) > 0])
    poses = _smooth(moments[ahead], np.array(q)[ahead])
    track = HandTrack(moments[ahead], poses, skeleton, np.array(seen)[ahead])
    return track, len(rows) / len(frames)


def skeleton_of(calibration: HandCalibration) -> tuple[Skeleton, Array]:
    """The person's skeleton, from what the device reports, and the centre (3,) m of its palm.

    If the device reports bones, every bone has its reported length. Otherwise, all bones are those
    of the average hand, scaled. Positions of knuckles are always scaled from the average hand,
    since a device's definition of the palm's centre is unknown.
    """
    average = np.array(bone_lengths())
    if calibration.bones is not None:
        size = float(np.median(calibration.bones[1:].sum(axis=1) / average[1:].sum(axis=1)))
    else:
        # The part of an average finger that the first software reports: see `PaalmOptions.hidden`.
        options = PaalmOptions()
        shown = average[1:].sum(axis=1) - options.hidden * average[1:, 0]
        size = float(np.median(calibration.standard[1:] / shown))
    skeleton = ADULT.scaled(size)
    if calibration.bones is None:
        return skeleton, size * np.array(PALM_CENTRE)
    bones: list[Bone] = []
    anchor, finger, column = (0.0, 0.0, 0.0), -1, 0
    for bone in skeleton.bones:
        column = column + 1 if bone.finger == finger else 0
        anchor = (0.0, bones[-1].length, 0.0) if bone.finger == finger else bone.anchor
        finger = bone.finger
        length = float(calibration.bones[finger, column])
        bones.append(replace(bone, anchor=anchor, length=length))
    skeleton = replace(skeleton, name=f"{ADULT.name}, as seen", bones=tuple(bones))
    return skeleton, size * np.array(PALM_CENTRE)


def _tips(hands: Sequence[TrackedHand], ids: dict[str, int | None], left: bool) -> Array:
    """Fingertips (5, 3) m, NaN where a finger is not seen."""
    out = np.full((len(FINGERS), 3), np.nan)
    wanted = {id_: name for name, id_ in enumerate(ids[f] for f in FINGERS) if id_ is not None}
    for hand in hands:
        tips = {f.id: f.end for f in hand.fingers}
        if wanted and set(wanted) <= set(tips):
            for id_, name in wanted.items():
                out[name] = tips[id_]
            break
    return out * [-1.0, 1.0, 1.0] if left else out


def _smooth(time: Array, q: Array) -> Array:
    """Smooths poses (J, 48), separately between gaps."""
    out = q.copy()
    cuts = np.flatnonzero(np.diff(time) > LONGEST_GAP) + 1
    for piece in np.split(np.arange(len(time)), cuts):
        if len(piece) < 3:
            continue
        turn = out[piece, ROOT_ROTATION]
        for i in range(1, len(turn)):
            turn[i] = unwrapped(turn[i], turn[i - 1])
        out[piece, ROOT_ROTATION] = turn
        period = float(np.median(np.diff(time[piece])))
        out[piece] = gaussian_filter1d(out[piece], SMOOTHING / period, axis=0, mode="nearest")
    return out
