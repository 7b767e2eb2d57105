"""Source of poses: a recording of landmarks, straight from the fit, without a task."""

from __future__ import annotations

from collections import Counter
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import numpy as np

from encoders.reconstruction.followed_hand import FollowingSettings
from encoders.webcam.camera import Camera
from encoders.webcam.landmark_reconstructor import LandmarkReconstructor
from models.arithmetic.arrays import Array
from models.errors import InputError
from models.frames import SIDES
from models.motion.armature import CHUNK, Armature
from models.person import Person
from models.pose import RateLimit
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


def open_landmarks(path: Path, hand: Hand | None = None) -> MotionSource:
    """Opens a recording of landmarks; poses are in the world, at the pictures' times.

    Args:
        path: The recording.
        hand: Whose hand; None: all hands that are there.

    Raises:
        RecordingError: The file is damaged, or has no picture.
        InputError: That hand is not in the recording.
    """
    recording = read_landmarks(path)
    camera = recording.camera or Camera()
    sides = _sides(recording, hand, str(path))
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
        return "" if recording.damage is None else str(recording.damage)

    armatures = tuple(Armature(Person(side).skeleton(ADULT)) for side in sides)
    what = f"{' and '.join(sides)} before a camera with a field of view of {camera.view:g} degrees"
    duration = recording.frames[-1].taken - begin
    return MotionSource(armatures, sides, duration, what, run)


def _sides(recording: LandmarkRecording, hand: Hand | None, where: str) -> tuple[str, ...]:
    """The sides to export; a side in fewer than `FEW` of the pictures is the engine's mistake."""
    seen: Counter[str] = Counter()
    for frame in recording.frames:
        seen.update({h.side for h in frame.hands})
    there = tuple(s for s in SIDES if seen[s] > FEW * len(recording.frames))
    wanted = there if hand is None else SIDES if hand == "both" else (hand,)
    if not wanted or not set(wanted) <= set(there):
        raise InputError(
            "this hand is not in the recording",
            where=where,
            got=hand or "no hand",
            expected=" or ".join(there) or "a picture with a hand",
        )
    return wanted
