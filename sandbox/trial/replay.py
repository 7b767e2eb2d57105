"""Replays: a recording is simulated again, compared hash by hash, and shown.

Another libm or another version of MuJoCo may round differently, and contacts make small differences
grow. States are then not bit-identical. In this case `Agreement` tells whether the outcome is the
same, and the largest distance of objects and hands from their recorded places. Views show labels,
contacts and the commanded pose as reconstructed from the recorded touches, and the poses of hand
and objects from the recording's track (`RecordedPoses`).

A replay is many times faster than the trial was. It is simulated to its end first. `Playback` then
shows its snapshots at any speed, paused, or step by step, also backwards without a new simulation.
"""

from __future__ import annotations

import time
from bisect import bisect_right
from collections.abc import Callable, Mapping, Sequence
from contextlib import closing
from dataclasses import dataclass, replace
from math import asin, degrees
from pathlib import Path
from typing import Any

import mujoco
import numpy as np

from models.arithmetic import Array
from models.errors import InputError, RecordingError
from models.scene import CONTROL_PERIOD
from sandbox.recording.recorded_device import RecordedDevice
from sandbox.recording.recorded_task import recorded_task, task_change
from sandbox.recording.recording import Recording
from sandbox.recording.versions import check_states, decisive_differences
from sandbox.session.messages import ObjectView, Snapshot
from sandbox.session.session import Session
from sandbox.trial.assembly import DeviceMaker, DeviceMakers, build, digests
from sandbox.trial.driver import Trial, ViewMaker, no_views, undisturbed
from sandbox.trial.result import TrialResult
from sandbox.trial.settings import Settings, recorded_encoder, recorded_settings
from tasks.score import Score, Status


@dataclass(frozen=True)
class Verification:
    """Result of a replay.

    Attributes:
        compared: Number of hashes that were compared.
        first_difference: Physics step of the first hash that differs; None if all agree.
        complete: True if the recording's end was reached and its last hash compared.
        differs_in: Differences that can change states, between this machine and the machine of the
            recording, in words. If it is empty, equal states are promised.
        shown_recorded: True if views got the recorded poses, not the poses simulated here.
        diverged: Reason of a divergence in the replay; empty without one.
        agreement: Agreement of outcome and poses; None if all states are equal, or if the recording
            has no poses.
        task_change: For a task that is not built in: a line on its changes since the recording was
            made, with a remedy. Empty without a change, or if the recording has no digests.
    """

    compared: int
    first_difference: int | None
    complete: bool
    differs_in: tuple[str, ...]
    shown_recorded: bool = False
    diverged: str = ""
    agreement: Agreement | None = None
    task_change: str = ""

    @property
    def same_machine(self) -> bool:
        """True if equal states are promised."""
        return not self.differs_in

    @property
    def exact(self) -> bool:
        """True if every compared state was the recorded one."""
        return self.first_difference is None and self.compared > 0


def settings_of(recording: Recording) -> Settings:
    """The settings of a recording, to play it again.

    Raises:
        DifferentStatesError: The recording was made with other `STATES`.
        RecordingError: The task or the encoder is not on this machine; or the encoder, the
            labeller's model or the robot hand has the same name, but differs from that of the
            recording.
    """
    check_states(recording)
    header, where = recording.header, str(recording.path)
    settings = recorded_settings(header).changed(
        task=recorded_task(header, where), encoder=recorded_encoder(header, where)
    )
    here, there = digests(settings), header.get("digests")
    if here != there:
        before = there if isinstance(there, dict) else {}
        changed = [name for name in here if here[name] != before.get(name)] or list(before)
        remedy = "Use the version of the sandbox that its header names"
        if "encoder" in changed and "encoder_from" in header:
            remedy = (
                "Restore the encoder's file as it was. If it is unchanged, its libraries or the "
                "machine differ: for replays on other machines, train it once with `sandbox train "
                "--encoder` into a model file"
            )
        elif "encoder" in changed and Path(settings.pipeline.encoder).is_file():
            remedy = "Restore the model file, or the code of its encoder, as it was"
        raise RecordingError(
            f"its {' and '.join(changed) or 'encoder'} changed since the recording was made",
            where=where,
            got=", ".join(str(here.get(name)) for name in changed),
            expected=", ".join(str(before.get(name)) for name in changed) or str(there),
            remedy=remedy,
        )
    return settings


def versions_of(recording: Recording) -> dict[str, Any]:
    """The versions of the program and the libraries that made a recording.

    Raises:
        RecordingError: The recording's header has no versions.
    """
    there = recording.header.get("versions")
    if not isinstance(there, dict):
        raise RecordingError(
            "the recording's header has no versions of the program",
            where=str(recording.path),
            got="nothing" if there is None else repr(there)[:80],
            expected="versions, as `sandbox run --record` writes them",
            remedy="Record it again, or take an undamaged copy",
        )
    return there


def recorded_hands(recording: Recording, hands: int) -> DeviceMakers:
    """Device makers that play a recording, one for each of its hands."""

    def plays(hand: int) -> DeviceMaker:
        return lambda task, surface: RecordedDevice(recording, hand)

    return tuple(plays(hand) for hand in range(hands))


def replay(recording: Recording, make_views: ViewMaker = no_views) -> tuple[Session, Verification]:
    """Replays a recording to its end and compares the hashes.

    Equal states are promised if machine and versions are equal to those of the recording in all
    respects on which states depend. Otherwise the recording is also simulated and compared, but
    views get the recorded poses.

    Returns:
        The session at its end, closed, and the comparison.

    Raises:
        RecordingError: See `settings_of`. Or the recording's task, which is not built in, has
            changed and can no longer be played.
    """
    settings = settings_of(recording)
    there = versions_of(recording)
    changed = task_change(
        recording.header, settings.task, settings.seed, settings.surface.rectangle
    )
    hands = recorded_hands(recording, len(settings.hands))
    with undisturbed():
        try:
            session = build(settings, hands, may_overlap=True)
        except InputError as error:
            if not changed:
                raise
            # Only the kind of failure, since this text goes into tables that people share.
            raise RecordingError(changed, where=str(recording.path), got=error.what) from error
        with closing(session):
            verification = _compared(
                session, recording, make_views, tuple(decisive_differences(there))
            )
    return session, replace(verification, task_change=changed)


def _compared(
    session: Session, recording: Recording, make_views: ViewMaker, differs_in: tuple[str, ...]
) -> Verification:
    """Plays a session to the end of a recording, and compares the hashes."""
    kept = bool(recording.track.qpos)
    poses = RecordedPoses(session, recording) if kept and differs_in else None
    comparison = PoseComparison(session, recording) if kept else None
    views = make_views(session)
    compared, difference = 0, None

    def show(snapshot: Snapshot) -> None:
        shown = poses.show(snapshot, scored=difference is None) if poses else snapshot
        for view in views:
            view(shown)

    trial = Trial(session, [show])
    while True:
        if session.step in recording.hashes:
            compared += 1
            if recording.hashes[session.step] != session.state_hash and difference is None:
                difference = session.step
        if comparison and difference is not None:
            comparison.update()
        # The trial may end earlier here than in the recording. Recorded poses are shown to the
        # recording's end.
        if session.diverged or (session.over and not (poses and session.step < poses.last)):
            break
        trial.step()
    return Verification(
        compared,
        difference,
        recording.end is not None and session.step == recording.end["step"],
        differs_in,
        poses is not None,
        session.diverged,
        comparison.agreement() if comparison and difference is not None else None,
    )


class RecordedPoses:
    """Puts recorded poses into the snapshots of a session.

    Args:
        session: Session that plays the recording; it is only read.
        recording: A recording with a track.

    Raises:
        RecordingError: The recorded poses are of another scene.
    """

    def __init__(self, session: Session, recording: Recording) -> None:
        self._session, self._recording = session, recording
        self._track = recording.track
        self._steps = sorted(self._track.qpos)
        model = session.scene.model
        widths = {len(qpos) for qpos in self._track.qpos.values()}
        hands = {len(solid) for solid in self._track.solid.values()}
        if widths != {model.nq} or hands != {len(session.rigs)}:
            raise RecordingError(
                "the recorded poses are of another scene",
                where=str(recording.path),
                got=f"{sorted(widths)} joint positions",
                expected=str(model.nq),
                remedy="Use the version of the sandbox that its header names",
            )
        self._data = mujoco.MjData(model)

    @property
    def last(self) -> int:
        """Physics step of the last pose."""
        return self._steps[-1]

    def show(self, snapshot: Snapshot, scored: bool) -> Snapshot:
        """The snapshot with the recorded poses of its moment.

        Args:
            snapshot: Snapshot that was simulated here.
            scored: True if its score still equals the recorded score, since all states so far were
                equal.
        """
        at = self._steps[max(bisect_right(self._steps, snapshot.step) - 1, 0)]
        scene, data = self._session.scene, self._data
        data.qpos[:] = self._track.qpos[at]
        mujoco.mj_normalizeQuat(scene.model, data.qpos)
        mujoco.mj_kinematics(scene.model, data)
        objects = {name: ObjectView(*scene.object_pose(data, name)) for name in snapshot.objects}
        hands = tuple(
            replace(hand, tips=self._session.tips(i, data), solid=self._track.solid[at][i])
            for i, hand in enumerate(snapshot.hands)
        )
        return replace(
            snapshot,
            qpos=data.qpos.copy(),
            see_hands=lambda: hands,
            see_objects=lambda: objects,
            score=snapshot.score if scored else self._score(snapshot.step),
        )

    def _score(self, step: int) -> Score:
        """The recorded score at the recording's end; an empty score before."""
        end = self._recording.end
        if end is None or step < end["step"]:
            return Score()
        return TrialResult.from_json(end["result"], str(self._recording.path)).score


BOUND_MM = 1.0
"""Largest allowed distance (mm) of objects or fingertips from their recorded places: 3.5 times the
largest distance in 87 recordings (docs/results.md). Rounding in the recording alone gives up to
0.02 mm."""
BOUND_DEGREES = 2.0
"""Largest allowed rotation (degrees) of objects or links of a hand from their recorded
orientations: 4 times the largest rotation in the same recordings."""


@dataclass(frozen=True)
class Agreement:
    """Agreement of a replay with the recorded trial, until the recorded end.

    Attributes:
        same_outcome: True if status and success are equal to the recorded values; None for a
            recording without an end. See `is_same_outcome`.
        objects_mm: mm, largest distance of an object from its recorded place.
        objects_degrees: Degrees, largest rotation of an object from its recorded orientation.
        hands_mm: mm, largest distance of a fingertip from its recorded place.
        hands_degrees: Degrees, largest rotation of a link of a hand from its recorded orientation.
        compared: Number of poses that were compared.
    """

    same_outcome: bool | None
    objects_mm: float
    objects_degrees: float
    hands_mm: float
    hands_degrees: float
    compared: int

    @property
    def holds(self) -> bool:
        """True if the outcome is the same and all differences are within the measured bounds."""
        return (
            self.same_outcome is not False
            and self.compared > 0
            and max(self.objects_mm, self.hands_mm) <= BOUND_MM
            and max(self.objects_degrees, self.hands_degrees) <= BOUND_DEGREES
        )


class PoseComparison:
    """Compares a session's poses with the poses in a recording.

    Args:
        session: Session that plays the recording; it is only read.
        recording: A recording. If it has no poses, no pose is compared.
    """

    def __init__(self, session: Session, recording: Recording) -> None:
        self._session, self._recording = session, recording
        self._track = recording.track.qpos
        self._data = mujoco.MjData(session.scene.model)
        self._here = mujoco.MjData(session.scene.model)
        objects = set(session.scene.object_bodies.values())
        self._objects = np.array(sorted(objects), np.int64)
        bodies = range(1, session.scene.model.nbody)
        self._links = np.array([b for b in bodies if b not in objects], np.int64)
        self._largest = [0.0, 0.0, 0.0, 0.0]
        self._compared = 0

    def update(self) -> None:
        """Compares the current pose, if the recording has a pose at this step."""
        recorded = self._track.get(self._session.step)
        if recorded is None or len(recorded) != len(self._data.qpos):
            return
        model, there, here = self._session.scene.model, self._data, self._here
        for data, qpos in ((there, recorded), (here, self._session.data.qpos)):
            data.qpos[:] = qpos
            mujoco.mj_normalizeQuat(model, data.qpos)
            mujoco.mj_kinematics(model, data)
        self._compared += 1
        hands = range(len(self._session.rigs))
        tips = [self._session.tips(i, here) - self._session.tips(i, there) for i in hands]
        places = here.xpos[self._objects] - there.xpos[self._objects]
        differences = (
            1000.0 * _longest(places),
            _largest_turn(here.xmat[self._objects], there.xmat[self._objects]),
            1000.0 * max(map(_longest, tips), default=0.0),
            _largest_turn(here.xmat[self._links], there.xmat[self._links]),
        )
        self._largest = [max(a, b) for a, b in zip(self._largest, differences, strict=True)]

    def agreement(self) -> Agreement:
        """The result of all comparisons."""
        end, same = self._recording.end, None
        if end is not None:
            score, ended_with_input = self._session.scorer.score, self._session.step == end["step"]
            same = is_same_outcome(score, end["result"], ended_with_input)
        objects_mm, objects_degrees, hands_mm, hands_degrees = self._largest
        return Agreement(same, objects_mm, objects_degrees, hands_mm, hands_degrees, self._compared)


def is_same_outcome(score: Score, recorded: Mapping[str, Any], ended_with_input: bool) -> bool:
    """True if a replay ended as the recorded trial did.

    A person who changes to another trial, or a study's own time limit, ends a trial from outside.
    In the replay of such a trial, only the input ends. The outcome is then the same if success is
    equal.

    Args:
        score: The replay's score.
        recorded: The recorded result.
        ended_with_input: True if the replay ended at the step at which the recording ends.
    """
    if score.success != recorded["success"]:
        return False
    from_outside = (
        ended_with_input
        and score.status in (Status.INPUT_ENDED, Status.HELD)
        and recorded["status"] in (Status.RUNNING, Status.TIMEOUT)
    )
    return from_outside or score.status == recorded["status"]


def _longest(vectors: Array) -> float:
    """Length of the longest of vectors (n, 3); 0 without any."""
    return float(np.sqrt(np.sum(vectors * vectors, axis=1)).max(initial=0.0))


def _largest_turn(a: Array, b: Array) -> float:
    """Largest angle, degrees, between n pairs of rotation matrices, (n, 9) and (n, 9)."""
    # |A - B|^2 = 8 sin^2(angle / 2), accurate for small angles.
    chord = np.sqrt(np.sum((a - b) ** 2, axis=1) / 8.0)
    return degrees(2.0 * asin(min(float(chord.max(initial=0.0)), 1.0)))


class Playback:
    """A position in a sequence of snapshots. The position moves with the clock.

    Args:
        snapshots: One snapshot for every control period; at least one snapshot.
        speed: Simulated seconds per second.
        clock: Returns the time, s.
    """

    def __init__(
        self,
        snapshots: Sequence[Snapshot],
        speed: float = 1.0,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        self._snapshots, self._clock = snapshots, clock
        self._speed, self._paused = speed, False
        self._place, self._since = 0.0, clock()

    @property
    def speed(self) -> float:
        """Simulated seconds per second."""
        return self._speed

    @speed.setter
    def speed(self, speed: float) -> None:
        self._go()
        self._speed = speed

    @property
    def paused(self) -> bool:
        """True while playback is paused."""
        return self._paused

    @paused.setter
    def paused(self, paused: bool) -> None:
        self._go()
        self._paused = paused

    @property
    def now(self) -> Snapshot:
        """The snapshot to show now."""
        self._go()
        return self._snapshots[int(self._place)]

    @property
    def at_end(self) -> bool:
        """True if the last snapshot is reached."""
        self._go()
        return int(self._place) == len(self._snapshots) - 1

    def move(self, steps: int) -> None:
        """Moves the position by a number of control periods; a negative number moves backwards.

        The position stops at either end of the sequence. After a move it is at the beginning of a
        period; 0 leaves it unchanged.
        """
        if not steps:
            return
        self._go()
        self._place = float(min(max(int(self._place) + steps, 0), len(self._snapshots) - 1))

    def restart(self) -> None:
        """Plays again from the beginning."""
        self.move(-len(self._snapshots))
        self.paused = False

    def _go(self) -> None:
        now = self._clock()
        passed, self._since = now - self._since, now
        if not self._paused:
            last = len(self._snapshots) - 1
            # Rounded, since a whole number of periods could come out slightly smaller.
            place = self._place + passed * self._speed / CONTROL_PERIOD
            self._place = min(round(place, 9), float(last))
