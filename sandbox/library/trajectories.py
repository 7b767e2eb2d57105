"""Trajectories of a trial as arrays and CSV: objects, hands and touches at every control period."""

from __future__ import annotations

import csv
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from models.arithmetic import Array
from models.errors import InputError
from models.frames import FINGERS
from models.objects import Joint
from models.rotations import matrix_to_quaternion
from models.skeleton import ADULT
from sandbox.session.messages import HandView, Snapshot
from sandbox.session.session import Session

Integers = NDArray[np.int64]

POSE_COLUMNS = tuple(
    f"q_{part}_{axis}"
    for part in ("position", "rotation", *(bone.name for bone in ADULT.bones))
    for axis in "xyz"
)
"""Column names of the 48 numbers of a pose, in the pose's order."""

UNNAMED = -1
"""Value of `TouchTable.finger` for a touch that is not labelled yet."""


@dataclass(frozen=True)
class ObjectTrajectory:
    """Trajectory of one object in the world; T control periods.

    Attributes:
        position: (T, 3) m, position of its centre.
        rotation: (T, 3, 3) rotation from object axes to world axes.
    """

    position: Array
    rotation: Array

    @property
    def quaternion(self) -> Array:
        """(T, 4) unit quaternions w, x, y, z of `rotation`, with w >= 0."""
        return matrix_to_quaternion(self.rotation)


@dataclass(frozen=True)
class JointTrajectory:
    """Trajectory of the hinge or slide of a mechanism's part; T control periods.

    Attributes:
        position: (T,) rad or m; an angle continues beyond a full turn.
        joint: Kind, unit and range of the joint.
    """

    position: Array
    joint: Joint


@dataclass(frozen=True)
class HandTrajectory:
    """Trajectory of one hand in the world; T control periods.

    Attributes:
        q: (T, 48) pose of the simulated hand: root position (m), root rotation vector (rad), then
            the rotation vectors of 14 ball joints (rad). For a robot hand (T, 6 + n): position and
            rotation vector of its palm, then its n joint positions.
        commanded: (T, 48) commanded pose, reconstructed from the touches; the servos follow it.
        tips: (T, 5, 3) m, fingertips of the simulated hand, thumb to little finger.
        solid: (T, 5) True if a finger collides with objects; False for a ghost.
    """

    q: Array
    commanded: Array
    tips: Array
    solid: NDArray[np.bool_]


@dataclass(frozen=True)
class TouchTable:
    """All touches of a trial. Each row is one touch in one control period; n rows, sorted by time.

    Attributes:
        time: (n,) s of simulated time since the trial's start.
        hand: (n,) index of the hand that touched.
        contact: (n,) id of the contact, from touch-down to touch-up.
        finger: (n,) 0 for the thumb to 4 for the little finger; -1 until it is labelled.
        xy: (n, 2) m on the surface, from its top left corner, x right and y down.
        state: (n,) `active`, `lost` (predicted for a moment), `palm` or `ignored`.
    """

    time: Array
    hand: Integers
    contact: Integers
    finger: Integers
    xy: Array
    state: NDArray[np.str_]


@dataclass(frozen=True)
class Trajectories:
    """Trajectories of a trial; T control periods of 16 ms.

    Positions of objects and fingertips are one physics step (2 ms) older than `time` and `q`, since
    MuJoCo computes the positions of bodies at the start of a step. This is also so in views and in
    the tables of studies.

    Attributes:
        time: (T,) s of simulated time since the trial's start, at the end of each period.
        step: (T,) physics steps since the trial's start.
        objects: Trajectories by name of the object.
        hands: Trajectories of the hands.
        touches: Touches of all hands.
        joints: Trajectories of hinges and slides by name of the part.
    """

    time: Array
    step: Integers
    objects: dict[str, ObjectTrajectory]
    hands: tuple[HandTrajectory, ...]
    touches: TouchTable
    joints: dict[str, JointTrajectory]

    def write_csv(self, folder: Path | str) -> tuple[Path, ...]:
        """Writes `objects.csv`, `hands.csv` and `touches.csv`; existing files are replaced.

        Args:
            folder: Folder for the files; it is created if it is missing.

        Returns:
            The files.

        Raises:
            InputError: A file cannot be written in the folder.
        """
        folder = Path(folder)
        tables = {
            "objects.csv": self._object_rows(),
            "hands.csv": self._hand_rows(),
            "touches.csv": self._touch_rows(),
        }
        try:
            folder.mkdir(parents=True, exist_ok=True)
            for name, rows in tables.items():
                with (folder / name).open("w", newline="", encoding="utf-8") as file:
                    csv.writer(file, lineterminator="\n").writerows(rows)
        except OSError as error:
            raise InputError(
                "the trajectories cannot be written", where=str(folder), got=error.strerror
            ) from None
        return tuple(folder / name for name in tables)

    def _moments(self) -> Iterable[tuple[str, int]]:
        return ((f"{time:.3f}", int(step)) for time, step in zip(self.time, self.step, strict=True))

    def _object_rows(self) -> Iterable[Sequence[object]]:
        parts = ("x", "y", "z", "qw", "qx", "qy", "qz")
        poses = (f"{name}_{part}" for name in self.objects for part in parts)
        joints = (f"{name}_{each.joint.column}" for name, each in self.joints.items())
        yield ["time_s", "step", *poses, *joints]
        tables = [np.hstack([o.position, o.quaternion]) for o in self.objects.values()]
        tables += [joint.position[:, None] for joint in self.joints.values()]
        values = np.hstack(tables) if tables else np.empty((len(self.time), 0))
        for moment, row in zip(self._moments(), values, strict=True):
            yield [*moment, *_digits(row)]

    def _hand_rows(self) -> Iterable[Sequence[object]]:
        tips = (f"{finger}_tip_{axis}" for finger in FINGERS for axis in "xyz")
        yield ["hand", "time_s", "step", "solid", *self._pose_columns(), *tips]
        for number, hand in enumerate(self.hands):
            for i, moment in enumerate(self._moments()):
                solid = "".join(FINGERS[f][0] for f in np.flatnonzero(hand.solid[i]))
                values = np.concatenate([hand.q[i], hand.tips[i].ravel()])
                yield [number, *moment, solid, *_digits(values)]

    def _pose_columns(self) -> Sequence[str]:
        """Column names of the numbers of a pose; the joints of a robot hand are numbered."""
        width = self.hands[0].q.shape[1] if self.hands else len(POSE_COLUMNS)
        if width == len(POSE_COLUMNS):
            return POSE_COLUMNS
        return [*POSE_COLUMNS[:6], *(f"q_joint_{i}" for i in range(width - 6))]

    def _touch_rows(self) -> Iterable[Sequence[object]]:
        yield ["time_s", "hand", "contact", "finger", "x", "y", "state"]
        touches = self.touches
        for i, time in enumerate(touches.time):
            finger = "" if touches.finger[i] == UNNAMED else FINGERS[touches.finger[i]]
            who = (int(touches.hand[i]), int(touches.contact[i]), finger)
            yield [f"{time:.3f}", *who, *_digits(touches.xy[i]), touches.state[i]]


def _digits(values: Array) -> list[str]:
    """Texts of numbers, rounded to a nanometre or nanoradian."""
    return [f"{value:.9f}" for value in values]


class TrajectoryView:
    """A view of a session that keeps its snapshots and makes trajectories of them.

    Args:
        session: Session of the snapshots; its scene is read, not changed.
    """

    def __init__(self, session: Session) -> None:
        self._scene = session.scene
        self._snapshots: list[Snapshot] = []

    def show(self, snapshot: Snapshot) -> None:
        """Keeps a snapshot."""
        self._snapshots.append(snapshot)

    def trajectories(self) -> Trajectories:
        """The trajectories of all snapshots so far."""
        shots = self._snapshots
        objects = {name: _of_object(shots, name) for name in (shots[0].objects if shots else ())}
        return Trajectories(
            np.array([s.time for s in shots]),
            np.array([s.step for s in shots], np.int64),
            objects,
            tuple(self._of_hand(i) for i in range(len(self._scene.spec.hands))),
            self._touches(),
            {
                name: JointTrajectory(np.array([s.qpos[at] for s in shots]), joint)
                for name, (joint, at) in self._scene.joints.items()
            },
        )

    def _of_hand(self, number: int) -> HandTrajectory:
        views = [s.hands[number] for s in self._snapshots]
        qpos = np.array([s.qpos[self._scene.qpos_slice(number)] for s in self._snapshots])
        at = self._scene.qpos_slice(number)
        qpos = qpos.reshape(len(views), at.stop - at.start)  # Correct for no moment, too.
        return HandTrajectory(
            self._scene.spec.hands[number].coordinates(qpos),
            np.array([view.target for view in views]),
            np.array([view.tips for view in views]),
            np.array([_solid(view) for view in views], bool),
        )

    def _touches(self) -> TouchTable:
        rows = [
            (shot.time, number, contact)
            for shot in self._snapshots
            for number, hand in enumerate(shot.hands)
            for contact in hand.contacts
        ]
        places = [(c.x, c.y) for _, _, c in rows]
        fingers = [UNNAMED if c.label is None else c.label for _, _, c in rows]
        return TouchTable(
            np.array([time for time, _, _ in rows], float),
            np.array([number for _, number, _ in rows], np.int64),
            np.array([c.id for _, _, c in rows], np.int64),
            np.array(fingers, np.int64),
            np.array(places, float).reshape(len(rows), 2),
            np.array([c.state for _, _, c in rows], np.str_),
        )


def _of_object(shots: Sequence[Snapshot], name: str) -> ObjectTrajectory:
    return ObjectTrajectory(
        np.array([shot.objects[name].position for shot in shots]),
        np.array([shot.objects[name].rotation for shot in shots]),
    )


def _solid(view: HandView) -> list[bool]:
    return [finger in view.solid for finger in range(len(FINGERS))]
