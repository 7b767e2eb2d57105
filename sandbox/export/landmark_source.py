"""Source of poses: a recording of landmarks, straight from the fit, without a task."""

from __future__ import annotations

from collections import Counter
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import numpy as np

from encoders.reconstruction.followed_hand import FollowingSettings
from encoders.reconstruction.hand_motion import RateLimit
from encoders.webcam.camera import Camera
from encoders.webcam.landmark_reconstructor import WITHOUT, LandmarkReconstructor
from models.arithmetic import Array
from models.errors import InputError
from models.frames import SIDES
from models.motion.armature import CHUNK, Armature
from models.person import Person
from models.reader_report import ReaderReport
from models.skeleton import ADULT
from sandbox.devices.webcam.landmarks import LandmarkRecording, read_landmarks
from sandbox.export.leap_source import FEW, Hand
from sandbox.export.motion_source import MotionSource, PoseCallback, poses_of, together

STRAIGHT = FollowingSettings(
    rate=RateLimit(linear=1e3, angular=1e3),
    smoothing=0.03,
    joint_smoothing=0.03,
    rise=0.0,
    floor=-1e3,
)
"""How hands without a table follow: as fast as they move, and not raised above anything."""


def open_landmarks(path: Path, hand: Hand | None = None, unit: str = "") -> MotionSource:
    """Opens a recording of landmarks; poses are in the world, at the pictures' times.

    Args:
        path: The recording.
        hand: Whose hand; None: all hands that are there.
        unit: Units that a person gave, such as `cm,ms`.

    Raises:
        RecordingError: The file is damaged, or has no picture.
        InputError: That hand is not in the recording.
    """
    recording = read_landmarks(path, unit)
    camera = recording.camera or Camera()
    sides, remarks = _sides(recording, hand, str(path))
    report = ReaderReport()
    report.add(recording.report)
    begin = recording.frames[0].taken
    # Of pictures of one moment, as there are where a page is opened anew, the last one counts.
    follows = pairwise(recording.frames)
    frames = [a for a, b in follows if b.taken > a.taken] + [recording.frames[-1]]

    def run(take: PoseCallback) -> str:
        hands = [LandmarkReconstructor(camera, side, following=STRAIGHT) for side in sides]
        times: list[float] = []
        poses: list[list[Array]] = []
        for frame in frames:
            at = frame.taken - begin
            poses.append([one.step(replace(frame, time=at)).q for one in hands])
            times.append(at)
            if len(times) == CHUNK or frame is frames[-1]:
                q = np.array(poses)
                time = np.array(times)
                take(together([poses_of(time, q[:, i]) for i in range(len(sides))]))
                times, poses = [], []
        for one in hands:
            # Two hands need not be in every picture.
            without = (WITHOUT,) if len(sides) > 1 else ()
            report.add_counts({k: n for k, n in one.counts.items() if k not in without})
        return "" if recording.damage is None else str(recording.damage)

    armatures = tuple(Armature(Person(side).skeleton(ADULT)) for side in sides)
    what = f"{' and '.join(sides)} before a camera with a field of view of {camera.view:g} degrees"
    duration = recording.frames[-1].taken - begin
    return MotionSource(armatures, sides, duration, what, run, tuple(remarks), report)


def _sides(
    recording: LandmarkRecording, hand: Hand | None, where: str
) -> tuple[tuple[str, ...], list[str]]:
    """The sides to export, and remarks on them.

    Where pictures never show both hands at once, the side of a single one is mistaken at times. So
    a second hand counts only beside the first one.
    """
    seen: Counter[str] = Counter()
    same: Counter[str] = Counter()
    both = 0
    for frame in recording.frames:
        named = Counter(h.side for h in frame.hands)
        seen.update(named.keys())
        same.update(side for side, count in named.items() if count > 1)
        both += len(named) == len(SIDES)
    enough = FEW * len(recording.frames)
    there = tuple(s for s in SIDES if seen[s] > enough)
    most = max(there, key=lambda s: seen[s], default="")
    wanted: tuple[str, ...] = tuple(s for s in there if s == most or both > enough)
    if hand is not None:
        wanted = SIDES if hand == "both" else (hand,)
    if not wanted or not set(wanted) <= set(there):
        raise InputError(
            "this hand is not in the recording",
            where=where,
            got=hand or recording.report.main_reason or "no hand",
            expected=" or ".join(there) or "a picture with a hand",
        )
    pictures = len(recording.frames)
    remarks = [
        f"a {s} hand is named in {seen[s]} of {pictures} pictures, {both} of them with both hands: "
        f"it is taken for the {most} one where that was; --hand {s} exports it"
        for s in there
        if hand is None and s not in wanted
    ]
    remarks += [
        f"{same[s]} of {pictures} pictures show two {s} hands: one is followed from where it was, "
        "beginning with the surest, and the other is left out"
        for s in wanted
        if same[s]
    ]
    return wanted, remarks
