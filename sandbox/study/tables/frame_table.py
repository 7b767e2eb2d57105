"""The frames of a trial, every 16 ms: commanded pose, labels, objects and contacts, as CSV.

Frames are collected while the trial runs, and written once after its end. If their file is missing,
a replay of the trial's recording makes it again.
"""

from __future__ import annotations

import csv
import gzip
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from io import StringIO
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from models.errors import RecordingError, StudyError
from models.frames import FINGERS, TouchFrame
from models.objects import Box, Symmetric
from models.pose import POSE_SIZE
from models.rotations import matrix_to_quaternion
from sandbox.recording.recording import load_recording
from sandbox.study.measures.arrays import POSE_COLUMNS, SECOND, TrialArrays, texts_of
from sandbox.study.record.durable_files import write_atomically
from sandbox.study.record.trial_files import frames_of, pack
from sandbox.study.tables.column import Column
from sandbox.study.tables.contacts import ContactReader, ContactSample, ObjectPushes
from sandbox.trial.result import TrialResult
from tasks.task import flat_yaw

if TYPE_CHECKING:
    from models.frames import Frame
    from sandbox.session.messages import ObjectView, Snapshot
    from sandbox.session.session import Session
    from sandbox.trial.driver import View
    from sandbox.trial.replay import Verification
    from tasks.task import Goal

SAME_MACHINE = "the program or the recording's settings (MuJoCo, architecture and libm are equal)"
"""Text on the difference if a replay gives other states although nothing known differs."""

FRAMES = (
    Column("time_s", "s", "simulated time since the trial's start"),
    Column("step", "", "physics steps since the trial's start"),
    Column("phase", "", "phase of the hand, such as hovering or down"),
    Column("solid", "", "fingers that collide with objects, as letters t i m r l"),
    Column(
        "q_*",
        "m, rad",
        "commanded pose in the world: root position, root rotation "
        "vector, then a rotation vector for each of 14 joints",
    ),
    Column("touch_*", "", "id of the contact with this finger label; empty if there is none"),
    Column(
        "true_*",
        "",
        "id of the contact that this finger really makes; empty if neither a simulated user nor "
        "the device reports it",
    ),
    Column("hand2_phase", "", "phase of the second hand; only in trials with two hands"),
    Column("hand2_solid", "", "same as solid, for the second hand"),
    Column("hand2_q_*", "m, rad", "same as q_*, for the second hand"),
    Column("hand2_touch_*", "", "same as touch_*, for the second hand"),
    Column("hand2_true_*", "", "same as true_*, for the second hand"),
    Column(
        "OBJECT_*",
        "m, 1",
        "position of the object in the world, and its rotation as a quaternion w x y z",
    ),
    Column(
        "OBJECT_hinge_rad",
        "rad",
        "angle of the hinge of a mechanism's part; it continues beyond a whole turn",
    ),
    Column("OBJECT_slide_m", "m", "position of the slide of a mechanism's part"),
    Column(
        "OBJECT_digits",
        "",
        "digits that push the object: letters t i m r l, and p for the palm; capital letters for a "
        "second hand; unknown if grip_N is empty",
    ),
    Column("OBJECT_grip_N", "N", "sum of the normal forces of all hands on the object"),
    Column("OBJECT_by", "", "other bodies that push the object: the table, names of objects"),
    Column(
        "OBJECT_on",
        "",
        "the bodies of OBJECT_by that bear the object: the upward force of each is more than 60 "
        "percent of the object's weight",
    ),
    Column("OBJECT_goal_*", "m", "position of the goal of the object's centre"),
    Column(
        "OBJECT_off_rad",
        "rad",
        "angle about the vertical from the goal to the object; for a symmetric object, the "
        "smallest of the equivalent angles",
    ),
)
"""Columns of the frames."""
_PARTS = {
    "q_*": POSE_COLUMNS,
    "touch_*": tuple(f"touch_{name}" for name in FINGERS),
    "true_*": tuple(f"true_{name}" for name in FINGERS),
    "OBJECT_*": tuple(f"OBJECT_{part}" for part in (*"xyz", "qw", "qx", "qy", "qz")),
    "OBJECT_goal_*": tuple(f"OBJECT_goal_{part}" for part in "xyz"),
}
"""Names of the columns in the file, for each entry of `FRAMES` that stands for several columns."""


def declared_columns(names: Collection[str]) -> list[str]:
    """The columns of a file that `FRAMES` declares, in the order of the file.

    Args:
        names: Columns of the file. Objects of the trial are recognised by their columns `*_qw`.
    """
    objects = [name.removesuffix("_qw") for name in names if name.endswith("_qw")]
    known = set()
    for column in FRAMES:
        second = SECOND if column.name.startswith(SECOND) else ""
        base = column.name.removeprefix(second)
        for name in _PARTS.get(base, (base,)):
            of = objects if name.startswith("OBJECT_") else [""]
            known |= {second + name.replace("OBJECT", item, 1) for item in of}
    return [name for name in names if name in known]


def frames_bytes(columns: Iterable[str], rows: Iterable[Sequence[str]]) -> bytes:
    """The content of a file of frames, compressed. Equal cells give equal bytes."""
    out = StringIO(newline="")
    # Names of columns contain names of objects, which may have commas, so they are quoted.
    writer = csv.writer(out, lineterminator="\n")
    writer.writerow(columns)
    writer.writerows(rows)
    return gzip.compress(out.getvalue().encode(), compresslevel=5, mtime=0)


class FrameTable:
    """A view that collects the snapshots of a trial and makes the frames of them.

    Attributes:
        truths: True fingers of a simulated user: for each hand, the finger by contact id. If they
            are empty, labels that the devices report are used instead.
    """

    def __init__(self) -> None:
        self._snapshots: list[Snapshot] = []
        self._contacts: list[ContactSample] = []
        self._inputs: list[list[Frame]] = []
        self._session: Session | None = None
        self._reader: ContactReader | None = None
        self.truths: list[dict[int, int]] = []

    @property
    def first_contact(self) -> float | None:
        """Time of the first touch, s; None without a touch."""
        return next((s.time for s in self._snapshots if any(h.contacts for h in s.hands)), None)

    def watch(self, session: Session) -> None:
        """Sets the session from which snapshots come and contacts are read."""
        if self._session is None:
            self._session, self._reader = session, ContactReader(session.scene, session.data)

    def show(self, snapshot: Snapshot) -> None:
        """Collects a snapshot; must be called for every snapshot before the session continues."""
        # Rows are computed after the trial, so as not to delay the session's loop.
        self._snapshots.append(snapshot)
        if self._session is not None and self._reader is not None:
            self._inputs.append([self._session.latest_frame(k) for k in range(len(snapshot.hands))])
            self._contacts.append(self._reader.copy())

    def forget_contacts(self) -> None:
        """Discards the contacts with objects: the simulation differed from the recorded poses."""
        self._contacts = []

    def data(self) -> bytes:
        """The content of the file of frames: compressed CSV, which R and pandas read directly."""
        columns = {name: texts_of(values) for name, values in self.columns().items()}
        return frames_bytes(columns, zip(*columns.values(), strict=True))

    def _true_fingers(self) -> list[dict[int, int]]:
        """True fingers for each hand, by contact id: `truths`, or the labels of devices."""
        if any(self.truths):
            return self.truths
        labels = [
            {
                contact.id: contact.label
                for frame in frames
                for contact in (frame.contacts if isinstance(frame, TouchFrame) else ())
                if contact.label is not None
            }
            for frames in zip(*self._inputs, strict=True)
        ]
        return labels

    def columns(self) -> dict[str, Any]:
        """Columns of the frames by name; each has one value for every snapshot."""
        shots, truths = self._snapshots, self._true_fingers()
        columns: dict[str, Any] = {
            "time_s": [s.time for s in shots],
            "step": [s.step for s in shots],
            **self._hand(0, "", truths),
        }
        if shots and len(shots[0].hands) > 1:
            columns |= self._hand(1, SECOND, truths)
        for name in shots[0].objects if shots else ():
            views = [s.objects[name] for s in shots]
            positions = np.array([view.position for view in views])
            rotations = matrix_to_quaternion(np.array([view.rotation for view in views]))
            columns |= {f"{name}_{part}": positions[:, i] for i, part in enumerate("xyz")}
            columns |= {f"{name}_q{part}": rotations[:, i] for i, part in enumerate("wxyz")}
        return columns | self._joints() | self._pushes() | self._goals()

    def _hand(self, hand: int, prefix: str, truths: list[dict[int, int]]) -> dict[str, Any]:
        """Columns of one hand."""
        views = [s.hands[hand] for s in self._snapshots]
        truth = truths[hand] if hand < len(truths) else {}
        poses = np.array([view.target for view in views]).reshape(-1, POSE_SIZE)
        labelled = [{c.label: c.id for c in view.contacts} for view in views]
        true = [{truth.get(c.id): c.id for c in view.contacts} for view in views]
        columns = {
            "phase": [view.phase for view in views],
            "solid": ["".join(FINGERS[f][0] for f in sorted(view.solid)) for view in views],
            **{f"touch_{name}": [ids.get(i) for ids in labelled] for i, name in enumerate(FINGERS)},
            **{f"true_{name}": [ids.get(i) for ids in true] for i, name in enumerate(FINGERS)},
            **{name: poses[:, i] for i, name in enumerate(POSE_COLUMNS)},
        }
        return {prefix + name: values for name, values in columns.items()}

    def _joints(self) -> dict[str, Any]:
        """Columns of the positions of hinges and slides, for the parts that have such a joint."""
        if self._session is None:
            return {}
        return {
            f"{name}_{joint.column}": np.array([s.qpos[at] for s in self._snapshots])
            for name, (joint, at) in self._session.scene.joints.items()
        }

    def _pushes(self) -> dict[str, Any]:
        """Columns of the pushes on each object; empty cells if the pushes are unknown."""
        columns: dict[str, Any] = {}
        names = self._snapshots[0].objects if self._snapshots else ()
        rows: list[Mapping[str, ObjectPushes] | None] = [None] * len(self._snapshots)
        if self._reader is not None and self._contacts:
            rows = [self._reader.pushes(contacts) for contacts in self._contacts]
        for name in names:
            pushes = [None if row is None else row[name] for row in rows]
            columns |= {
                f"{name}_digits": [p.digits if p else None for p in pushes],
                f"{name}_grip_N": [p.grip if p else None for p in pushes],
                f"{name}_by": [" ".join(p.by) if p else None for p in pushes],
                f"{name}_on": [" ".join(p.on) if p else None for p in pushes],
            }
        return columns

    def _goals(self) -> dict[str, Any]:
        """Columns for each object with a goal: the goal, and the object's yaw relative to it."""
        columns: dict[str, Any] = {}
        symmetries = self._symmetries()
        for i, goal in enumerate(self._snapshots[0].goals if self._snapshots else ()):
            name = goal.object
            goals = [s.goals[i] for s in self._snapshots]
            positions = np.array([goal.position for goal in goals])
            columns |= {f"{name}_goal_{part}": positions[:, j] for j, part in enumerate("xyz")}
            columns[f"{name}_off_rad"] = [
                yaw_error(s.objects[name], goal, symmetries.get(name, 1))
                for s, goal in zip(self._snapshots, goals, strict=True)
            ]
        return columns

    def _symmetries(self) -> dict[str, int]:
        """Number of equivalent angles in a full turn about the vertical, by object; 0: all are."""
        objects = self._session.task.objects if self._session is not None else ()
        symmetries = {}
        for item in objects:
            symmetries[item.name] = item.symmetry if isinstance(item, Symmetric) else 1
            if isinstance(item, Box):
                a, b, _ = item.half_size
                symmetries[item.name] = 4 if abs(a - b) < 1e-9 else 2
        return symmetries


def yaw_error(view: ObjectView, goal: Goal, symmetry: int) -> float:
    """Angle about the vertical from a goal to an object, rad, to the nearest equivalent angle.

    Args:
        view: The object.
        goal: Its goal.
        symmetry: Number of equivalent angles in one full turn; 0 if all angles are equivalent.
    """
    if symmetry == 0:
        return 0.0
    part = 2.0 * np.pi / symmetry
    # The x axis of a box may be upright. `flat_yaw` uses an edge that is not upright instead.
    yaw = flat_yaw(view.rotation) if symmetry > 1 else _yaw(view.rotation)
    return float((yaw - goal.yaw + part / 2) % part - part / 2)


def _yaw(rotation: Any) -> float:
    return float(np.arctan2(rotation[1, 0], rotation[0, 0]))


class FrameWriter:
    """A thread that writes the frames of trials and compresses their recordings, one by one."""

    def __init__(self) -> None:
        self._thread = ThreadPoolExecutor(max_workers=1, thread_name_prefix="frames")
        self._written: list[Future[Any]] = []

    def write(self, table: FrameTable, recording: Path) -> None:
        """Begins to write the frames of a finished trial, and to compress its recording.

        Args:
            table: The frames of the trial; they must not change any more.
            recording: Path of the trial's recording, which is complete.
        """
        self._written.append(self._thread.submit(_write, table, recording))
        self._written.append(self._thread.submit(pack, recording))

    def finish(self) -> Iterator[str]:
        """Waits until all files are written; yields a line for every file that failed."""
        while self._written:
            try:
                self._written.pop(0).result()
            except StudyError as error:
                yield str(error)


def read_frames(recording: Path) -> TrialArrays | None:
    """The frames of a trial; None if the file is missing or damaged.

    Args:
        recording: Path of the trial's recording.
    """
    try:
        return TrialArrays.read(frames_of(recording).read_bytes())
    except (OSError, EOFError, ValueError, csv.Error):
        return None


def make_frames(recording: Path) -> str:
    """Writes the frames of a trial by replaying its recording.

    If the replay does not give the recorded states, the frames are made from the recorded poses,
    without the pushes on objects. If there are no recorded poses, or the replay cannot begin, no
    file is written.

    Args:
        recording: Recording of a finished trial.

    Returns:
        Empty if the replay gives the recorded states. Otherwise a text: the differences between
        this machine and program and those of the recording, or the error of the replay.

    Raises:
        StudyError: The file cannot be written.
    """
    try:
        verification, table = _replayed(recording)
    except RecordingError as error:
        # The path is left out: names of folders may be names of people, and the text may be shared.
        return error.what if error.got is None else f"{error.what} (got {error.got})"
    differs = ""
    if not (verification.exact and verification.complete):
        reasons = (verification.task_change, *verification.differs_in)
        differs = "; ".join(filter(None, reasons)) or SAME_MACHINE
        if not verification.shown_recorded:
            return differs
        table.forget_contacts()
    _write(table, recording)
    return differs


def frames_again(recording: Path) -> tuple[Verification, bytes | None]:
    """Replays a recording, and makes its frames again.

    Args:
        recording: Recording of a finished trial.

    Returns:
        The comparison of the states, and the content of the file of frames, or None if the states
        differ.

    Raises:
        RecordingError: The recording cannot be replayed.
    """
    verification, table = _replayed(recording)
    same = verification.exact and verification.complete
    return verification, table.data() if same else None


def _replayed(recording: Path) -> tuple[Verification, FrameTable]:
    """Replays a recording, and collects its frames."""
    from sandbox.trial.replay import replay

    table, loaded = FrameTable(), load_recording(recording)

    def views(session: Session) -> list[View]:
        table.watch(session)
        return [table.show]

    _, verification = replay(loaded, views)
    if loaded.end is not None:
        result = TrialResult.from_json(loaded.end["result"], str(recording))
        table.truths = [dict(result.fingers or ()), dict(result.second_fingers or ())]
    return verification, table


def _write(table: FrameTable, recording: Path) -> None:
    write_atomically(frames_of(recording), table.data())
