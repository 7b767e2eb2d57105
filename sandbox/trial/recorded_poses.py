"""Recorded poses, shown where a recording cannot be simulated again to the bit.

Labels, contacts and the commanded pose are reconstructed from the recorded touches; the poses of
hand and objects come from the recording's track.
"""

from __future__ import annotations

from bisect import bisect_right
from dataclasses import replace

import mujoco

from models.errors import RecordingError
from sandbox.recording.recording import Recording
from sandbox.session.messages import ObjectView, Snapshot
from sandbox.session.session import Session
from sandbox.trial.result import TrialResult
from tasks.goals import place
from tasks.score import Score


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
                "its poses are of another scene",
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
            scored: Its score still equals the recorded one, as no state has differed so far.
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
            hands=hands,
            objects=objects,
            goals=place(self._session.task.goals, objects),
            score=snapshot.score if scored else self._score(snapshot.step),
        )

    def _score(self, step: int) -> Score:
        """The recorded score at the end, and an empty one before."""
        end = self._recording.end
        if end is None or step < end["step"]:
            return Score()
        return TrialResult.from_json(end["result"], str(self._recording.path)).score
