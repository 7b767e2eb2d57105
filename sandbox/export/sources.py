"""Sources of poses for an export: recordings (simulated or commanded hands), captures, and
recordings of a Leap.

Recordings are read line by line, so that memory does not grow with their length.
"""

from __future__ import annotations

import gzip
import json
import zlib
from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING, Literal

import numpy as np
from msgspec import Struct

from encoders.air.camera import Camera
from encoders.air.reconstructors import WITHOUT, LandmarkReconstructor
from encoders.capture import Capture, load_capture
from encoders.reconstruction.followed_hand import FollowingSettings
from encoders.reconstruction.hand_motion import RateLimit
from models.arithmetic import Array
from models.errors import InputError, RecordingError
from models.frames import SIDES
from models.json_input import checked, decoded_record
from models.motion.armature import CHUNK, Armature
from models.motion.sampling import Poses
from models.person import Person
from models.reader_report import ReaderReport
from models.skeleton import ADULT
from sandbox.devices.webcam.landmarks import LandmarkRecording, is_landmark_file, read_landmarks
from sandbox.export.leap_source import FEW, Hand, open_leap
from sandbox.export.motion_source import MotionSource, PoseCallback, poses_of, together
from sandbox.recording.recording import (
    GZIP,
    PoseTrack,
    first_line,
    is_recording,
    load_recording,
    read_header,
    read_track_line,
    stored,
)
from sandbox.recording.versions import check_states, states_difference
from sandbox.trial.settings import Settings, recorded_settings

if TYPE_CHECKING:
    from sandbox.session.messages import Snapshot
    from sandbox.session.session import Session


STRAIGHT = FollowingSettings(
    rate=RateLimit(linear=1e3, angular=1e3),
    smoothing=0.03,
    joint_smoothing=0.03,
    rise=0.0,
    floor=-1e3,
)
"""Settings of hands without a table: no limit of speed, and no lowest height."""


def open_landmarks(path: Path, hand: Hand | None = None, unit: str = "") -> MotionSource:
    """Opens a recording of landmarks; poses are in the world, at the pictures' times.

    Args:
        path: The recording.
        hand: Side of the hand; None takes all hands in the recording.
        unit: Units that the user gave, such as `cm,ms`.

    Raises:
        RecordingError: The file is damaged, or has no picture.
        InputError: The hand is not in the recording.
    """
    recording = read_landmarks(path, unit)
    camera = recording.camera or Camera()
    sides, remarks = _sides(recording, hand, str(path))
    report = ReaderReport()
    report.add(recording.report)
    begin = recording.frames[0].taken
    # Several pictures may have the same time if the page was opened again. The last one is used.
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
            # With two hands, a picture without one of them is normal.
            without = (WITHOUT,) if len(sides) > 1 else ()
            report.add_counts({k: n for k, n in one.counts.items() if k not in without})
        return "" if recording.damage is None else str(recording.damage)

    armatures = tuple(Armature(Person(side).skeleton(ADULT)) for side in sides)
    hands_text = f"{' and '.join(sides)} {'hand' if len(sides) == 1 else 'hands'}"
    what = f"the {hands_text} in front of a camera with a field of view of {camera.view:g} degrees"
    duration = recording.frames[-1].taken - begin
    return MotionSource(armatures, sides, duration, what, run, tuple(remarks), report)


def _sides(
    recording: LandmarkRecording, hand: Hand | None, where: str
) -> tuple[tuple[str, ...], list[str]]:
    """The sides to export, and remarks on them.

    If pictures never show both hands, the reported side of a single hand is sometimes wrong.
    Therefore a second hand is exported only if it was often seen together with the first hand.
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
        f"a {s} hand is reported in {seen[s]} of {pictures} pictures, {both} of them with both "
        f"hands: near the {most} hand's place, it is taken for this hand; --hand {s} exports it"
        for s in there
        if hand is None and s not in wanted
    ]
    remarks += [
        f"{same[s]} of {pictures} pictures show two {s} hands: the hand nearest to the last one is "
        "exported, at first the more certain hand; the other hand is left out"
        for s in wanted
        if same[s]
    ]
    return wanted, remarks


Of = Literal["simulated", "commanded"]

HAND_JOINTS = 3 + 4 * 15
"""Number of joint positions of one hand in a scene. Hands come before objects."""


def open_source(
    path: Path,
    of: Of | None = None,
    take: int = 1,
    hand: Hand | None = None,
    calibration: Path | None = None,
    unit: str = "",
) -> MotionSource:
    """Opens a recording, a capture, or a recording of a Leap or a camera, distinguished by content.

    Args:
        path: The file.
        of: For the recording of a session: `simulated`, the default, or `commanded`, for which the
            recording is played again.
        take: Number of the take of a capture, from 1.
        hand: Side of the hand in a recording of a Leap or a camera; None takes all hands.
        calibration: File with the measured hands of a Leap recording.
        unit: Units of a recording of a Leap or a camera, such as `cm,ms`. Units that are not given
            are inferred.

    Raises:
        InputError: The file is of no such kind, or has no poses.
    """

    if not stored(path).exists():
        raise InputError("no such file", where=str(path))
    if is_recording(path):
        _only_leaps(hand, calibration, unit, "a recording of a session")
        return _commanded(path) if of == "commanded" else _simulated(path)
    try:
        with path.open("rb") as file:
            head = file.read(64)
    except OSError as error:
        raise InputError("cannot be read", where=str(path), got=error.strerror) from error
    if head.startswith(b"PK"):
        _only_leaps(hand, calibration, unit, "a capture")
        return _capture(load_capture(path), str(path), take)
    if of is not None:
        raise InputError(
            "--of is for recordings of sessions, which have a simulated and a commanded hand",
            where=f"--of {of}",
            got=str(path),
            remedy="Leave out --of",
        )
    if is_landmark_file(path):
        _only_leaps(None, calibration, "", "a recording of landmarks")
        return open_landmarks(path, hand, unit)
    try:
        return open_leap(path, hand, calibration, unit)
    except RecordingError as error:
        if head.lstrip()[:1] in (b"{", b"[") or path.suffix == ".lz":
            raise
        raise InputError(
            "this is neither a recording nor a capture, nor a recording of a Leap",
            where=str(path),
            remedy="`sandbox run` and `sandbox play` write a recording with --record FILE, and "
            "`sandbox capture` writes a capture; `sandbox devices leap formats` lists the formats "
            "of Leap recordings",
        ) from error


def _only_leaps(hand: Hand | None, calibration: Path | None, unit: str, what: str) -> None:
    """Refuses options that do not apply to a source."""
    given = "--hand" if hand else "--calibration" if calibration else "--unit" if unit else ""
    if given:
        raise InputError(
            "this option is for recordings of a Leap",
            where=given,
            got=what,
            remedy="Leave it out: all hands are exported, each under its own name",
        )


def poses_of_qpos(time: Array, qpos: Array, hands: int) -> Poses:
    """Poses of hands at times (n,), from joint positions (n, nq) of a scene."""
    values = qpos[:, : hands * HAND_JOINTS].reshape(len(qpos), hands, HAND_JOINTS)
    turns = values[..., 3:].reshape(len(qpos), hands, 15, 4)
    # A track is rounded, so that the lengths of its quaternions differ slightly from 1.
    return Poses(time, values[..., :3], turns / np.linalg.norm(turns, axis=-1, keepdims=True))


def hands_of(settings: Settings) -> tuple[tuple[Armature, ...], tuple[str, ...]]:
    """Armatures and names of a session's hands.

    Raises:
        InputError: The hands are robot hands, whose joints the formats cannot hold.
    """
    if settings.physics.robot:
        raise InputError(
            "the motion of a robot hand cannot be exported",
            where="--robot",
            got=settings.physics.robot,
        )
    return (
        tuple(Armature(hand.person.skeleton(ADULT)) for hand in settings.hands),
        settings.hand_names,
    )


def _simulated(path: Path) -> MotionSource:
    header = read_header(first_line(path), path)
    settings = recorded_settings(header, "hands", "physics")
    armatures, names = hands_of(settings)
    timestep = settings.physics.timestep

    def run(take: PoseCallback) -> str:
        any_rows = False
        for steps, qpos, damage in _tracks(path):
            if damage and not any_rows:
                raise RecordingError(
                    "the recording ends before the first pose", where=str(path), got=damage
                )
            if damage:
                return damage
            if qpos.shape[1] < len(names) * HAND_JOINTS:
                raise RecordingError(
                    "the recorded poses are of another scene",
                    where=str(path),
                    got=f"{qpos.shape[1]} joint positions",
                    expected=f"at least {len(names) * HAND_JOINTS}",
                )
            take(poses_of_qpos(steps * timestep, qpos, len(names)))
            any_rows = True
        if not any_rows:
            raise RecordingError(
                "the recording has no poses: it ends before the first pose",
                where=str(path),
                remedy="--of commanded replays the recording and exports the commanded pose",
            )
        return ""

    remarks = tuple(filter(None, [states_difference(header)]))
    duration = _length(path, timestep)
    return MotionSource(armatures, names, duration, "the simulated hand", run, remarks)


def _commanded(path: Path) -> MotionSource:
    # This import loads the simulation, which all other exports do not need.
    from sandbox.trial.replay import replay

    recording = load_recording(path)
    check_states(recording)
    settings = recorded_settings(recording.header)
    armatures, names = hands_of(settings)
    duration = recording.end["step"] * settings.physics.timestep if recording.end else 0.0

    def run(take: PoseCallback) -> str:
        def show(snapshot: Snapshot) -> None:
            take(commanded_poses(snapshot))

        def views(session: Session) -> list[Callable[[Snapshot], None]]:
            return [show]

        _, verification = replay(recording, views)
        said = [recording.damage, verification.task_change]
        if not verification.exact:
            said.append(
                "the replay differs from the recording, so the commanded poses may be different"
            )
        return "; ".join(filter(None, said))

    return MotionSource(armatures, names, duration, "the commanded pose", run)


def commanded_poses(snapshot: Snapshot) -> Poses:
    """Commanded poses of all hands at one moment."""
    return together([poses_of(np.array([snapshot.time]), h.target[None]) for h in snapshot.hands])


def _capture(capture: Capture, where: str, take: int) -> MotionSource:
    trials = np.unique(capture.trial)
    if not 1 <= take <= len(trials):
        raise InputError(
            "the capture has no such take",
            where=f"{where}, --take",
            got=take,
            expected=f"1 to {len(trials)}",
        )
    one = capture.select(capture.trial == trials[take - 1])
    time = one.time - one.time[0]

    def run(give: PoseCallback) -> str:
        for a in range(0, len(time), CHUNK):
            give(poses_of(time[a : a + CHUNK], one.q[a : a + CHUNK]))
        return ""

    what = f"take {take} of {len(trials)}, in the frame of the surface"
    return MotionSource((Armature(ADULT),), ("right",), float(time[-1]), what, run)


def _tracks(path: Path) -> Iterator[tuple[Array, Array, str]]:
    """Yields steps (n,), joint positions (n, nq) and an empty text for each `track` line.

    If the file is damaged, the last item has the error text in place of poses.
    """
    nothing, number, ended, any_track, last = np.zeros(0), 0, False, False, -1
    try:
        for text in _lines(path):
            number += 1
            # Only the beginning of a line is examined, since most lines are not needed here.
            begins = text[:40].replace(b" ", b"")
            ended = begins.startswith(b'{"kind":"end"') and text.endswith(b"\n")
            if not begins.startswith(b'{"kind":"track"'):
                continue
            any_track, track = True, PoseTrack()
            read_track_line(json.loads(text), track)
            steps = sorted(track.qpos)
            if steps and steps[0] <= last:
                raise ValueError("it repeats earlier steps")
            last = steps[-1] if steps else last
            yield np.array(steps, float), np.array([track.qpos[s] for s in steps]), ""
        if any_track and not ended:
            yield nothing, nothing, "it breaks off before its end"
    except (
        ValueError,
        KeyError,
        TypeError,
        OverflowError,
        EOFError,
        OSError,
        zlib.error,
    ) as error:
        yield nothing, nothing, f"line {number} is damaged ({error}); the rest is left out"


def _lines(path: Path) -> Iterator[bytes]:
    """Yields the lines of a recording, compressed or not."""
    with stored(path).open("rb") as file:
        compressed = file.read(2) == GZIP
        file.seek(0)
        if not compressed:
            yield from file
            return
        with gzip.open(file) as text:
            yield from text


class _End(Struct):
    """Field of a recording's last line: its length in physics steps."""

    step: int


def _length(path: Path, timestep: float) -> float:
    """Duration in s, from the `end` line in the last bytes of the file.

    0 if no `end` line is found, as in a compressed recording.
    """
    file_path = stored(path)
    with file_path.open("rb") as file:
        file.seek(max(0, file_path.stat().st_size - 8192))
        last = file.read().rstrip().rpartition(b"\n")[2]
    what, where = "the end is damaged", str(path)
    try:
        record = decoded_record(last, RecordingError, what=what, where=where)
        end = checked(record, _End, RecordingError, what=what, where=where)
    except RecordingError:
        return 0.0
    return end.step * timestep
