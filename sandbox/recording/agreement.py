"""The second verdict on a replay whose states are not equal to the bit: is it the same trial?

Another libm or another version of MuJoCo rounds another way, and contacts make small differences
grow. Then two questions remain: is the outcome the same, and how far did objects and hands ever
stand from where they were recorded?
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from math import asin, degrees
from typing import Any

import mujoco
import numpy as np

from models.arithmetic.arrays import Array
from sandbox.recording.recording import Recording
from sandbox.session.session import Session
from tasks.score import Score, Status

BOUND_MM = 1.0
"""mm that objects or fingertips may be apart at most: 3.5 times the largest of 87 recordings,
docs/results.md. Rounding in the recording alone makes up to 0.02 mm."""
BOUND_DEGREES = 2.0
"""Degrees that objects or links of a hand may be apart at most: 4 times the largest, likewise."""


@dataclass(frozen=True)
class Agreement:
    """Agreement of a replay's trial with the recorded one, until the recorded end.

    Attributes:
        same_outcome: Status and success are those that were recorded; None where the recording has
            no end. See `is_same_outcome`.
        objects_mm: mm, largest distance of an object from its recorded place.
        objects_degrees: Degrees, largest turn of an object from its recorded one.
        hands_mm: mm, largest distance of a fingertip from its recorded place.
        hands_degrees: Degrees, largest turn of a link of a hand from its recorded one.
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
    """Compares a session's poses with those that a recording has kept.

    Args:
        session: Session that plays the recording; it is only read.
        recording: A recording; without kept poses there is nothing to compare.
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

    def look(self) -> None:
        """Compares the poses of this moment, if the recording has one of it."""
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
        """The verdict on everything that was compared."""
        end, same = self._recording.end, None
        if end is not None:
            score, ended_with_input = self._session.scorer.score, self._session.step == end["step"]
            same = is_same_outcome(score, end["result"], ended_with_input)
        objects_mm, objects_degrees, hands_mm, hands_degrees = self._largest
        return Agreement(same, objects_mm, objects_degrees, hands_mm, hands_degrees, self._compared)


def is_same_outcome(score: Score, recorded: Mapping[str, Any], ended_with_input: bool) -> bool:
    """True if a replay ended as the recorded trial did.

    A person who goes on to another trial, or a study's own limit, ends a trial from outside. Its
    replay sees nothing but the end of the input. Then success decides.

    Args:
        score: The replay's.
        recorded: The recorded result.
        ended_with_input: The replay ended at the step at which the recording ends.
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
    """Degrees of the largest turn between rotation matrices (n, 9) and (n, 9)."""
    # |A - B|^2 = 8 sin^2(angle / 2), accurate for small angles.
    chord = np.sqrt(np.sum((a - b) ** 2, axis=1) / 8.0)
    return degrees(2.0 * asin(min(float(chord.max(initial=0.0)), 1.0)))
