"""The 60 Hz tables of a trial: commanded pose, labels, touches and objects, as CSV and Parquet.

They are built while the trial runs, and from its recording if they are missing later.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from models.errors import RecordingError
from models.frames import FINGERS, TouchFrame
from models.objects import Box, Symmetric
from models.pose import POSE_SIZE
from models.rotations import matrix_to_quaternion
from models.skeleton import ADULT
from sandbox.recording.recording import load_recording
from sandbox.study.measures.columns import SECOND, Columns
from sandbox.study.measures.object_contacts import ContactReader, ContactSample, ObjectPushes
from sandbox.study.record.files import write_atomically
from sandbox.study.tables.frame_columns import frame_column
from sandbox.study.tables.measures_file import (
    keep_measures,
    measures_are_complete,
    measures_were_kept,
    write_measures,
)
from sandbox.trial.result import TrialResult
from tasks.task import flat_yaw

if TYPE_CHECKING:
    from models.frames import Frame
    from sandbox.session.messages import ObjectView, Snapshot
    from sandbox.session.session import Session
    from sandbox.trial.driver import View
    from tasks.task import Goal

SAME_MACHINE = "the program or the recording's settings (MuJoCo, architecture and libm are equal)"
"""What differs if states differ where equal states are promised."""
POSE_COLUMNS = tuple(
    f"q_{name}_{axis}"
    for name in ("position", "rotation", *(b.name for b in ADULT.bones))
    for axis in "xyz"
)
"""Columns of the 48 numbers of a pose, in the order of the pose."""


class FrameTable:
    """A view that collects the snapshots of a trial and writes its 60 Hz tables and measures.

    Attributes:
        truths: True finger by id of the contact, for each hand; empty if unknown.
        truth_by: Source of the true fingers; empty if they are unknown.
    """

    def __init__(self) -> None:
        self._snapshots: list[Snapshot] = []
        self._contacts: list[ContactSample] = []
        self._inputs: list[list[Frame]] = []
        self._session: Session | None = None
        self._reader: ContactReader | None = None
        self.truths: list[dict[int, int]] = []
        self.truth_by = ""

    @property
    def first_contact(self) -> float | None:
        """Time of the first touch, s; None without a touch."""
        return next((s.time for s in self._snapshots if any(h.contacts for h in s.hands)), None)

    def watch(self, session: Session) -> None:
        """Sets the session that the snapshots come from, and from which contacts are read."""
        if self._session is None:
            self._session, self._reader = session, ContactReader(session.scene, session.data)

    def show(self, snapshot: Snapshot) -> None:
        """Collects a snapshot; must be called for every snapshot before the session continues."""
        # Rows are computed after the trial, so that the session's loop is not delayed.
        self._snapshots.append(snapshot)
        if self._session is not None and self._reader is not None:
            self._inputs.append([self._session.latest_frame(k) for k in range(len(snapshot.hands))])
            self._contacts.append(self._reader.copy())

    def forget_contacts(self) -> None:
        """Discards the contacts with objects, if the simulation differs from the recorded poses."""
        self._contacts = []

    def write(self, folder: Path, stem: str, result: TrialResult | None = None) -> list[str]:
        """Writes the tables and measures of a trial.

        Args:
            folder: Folder of the tables.
            stem: Name of the trial's recording without suffix.
            result: Result at the end of the recording; None writes no measures.

        Returns:
            A line for every failed measure.

        Raises:
            StudyError: A file cannot be written.
        """
        if not any(self.truths):
            self._use_labels_of_devices()
        frames = self._frames()
        if find_spec("pyarrow"):
            write_atomically(folder / f"frames_{stem}.parquet", _parquet(frames), durable=False)
        columns = Columns.of(frames)
        notices = []
        if result is not None:
            notices = write_measures(folder, stem, columns, result, self.truth_by)
        touches = Columns.of(self._touches())
        for name, table in (
            (f"touches_{stem}.csv.gz", touches),
            (f"frames_{stem}.csv.gz", columns),
        ):
            write_atomically(folder / name, table.csv(), durable=False)
        return notices

    def _use_labels_of_devices(self) -> None:
        """Uses the finger labels that devices report as the true fingers."""
        labels = [
            {
                contact.id: contact.label
                for frame in frames
                for contact in (frame.contacts if isinstance(frame, TouchFrame) else ())
                if contact.label is not None
            }
            for frames in zip(*self._inputs, strict=True)
        ]
        if any(labels):
            self.truths, self.truth_by = labels, "device"

    def _frames(self) -> dict[str, Any]:
        """Columns of the table of frames, by name: one row for every snapshot."""
        shots = self._snapshots
        columns: dict[str, Any] = {
            "time_s": [s.time for s in shots],
            "step": [s.step for s in shots],
            **self._hand(0, ""),
        }
        if shots and len(shots[0].hands) > 1:
            columns |= self._hand(1, SECOND)
        for name in shots[0].objects if shots else ():
            views = [s.objects[name] for s in shots]
            positions = np.array([view.position for view in views])
            rotations = matrix_to_quaternion(np.array([view.rotation for view in views]))
            columns |= {f"{name}_{part}": positions[:, i] for i, part in enumerate("xyz")}
            columns |= {f"{name}_q{part}": rotations[:, i] for i, part in enumerate("wxyz")}
        return columns | self._joints() | self._pushes() | self._goals()

    def _hand(self, hand: int, prefix: str) -> dict[str, Any]:
        """Columns of one hand."""
        views = [s.hands[hand] for s in self._snapshots]
        truth = self.truths[hand] if hand < len(self.truths) else {}
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
        """Columns of the positions of hinges and slides, of parts that have one."""
        if self._session is None:
            return {}
        return {
            f"{name}_{joint.column}": np.array([s.qpos[at] for s in self._snapshots])
            for name, (joint, at) in self._session.scene.joints.items()
        }

    def _pushes(self) -> dict[str, Any]:
        """Columns of what pushes each object; the cells are empty if it is unknown."""
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
        """Columns of the goal of each object that has one, and of its yaw relative to the goal."""
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
        """Number of equivalent angles in one full turn about the vertical, by object; 0: all."""
        objects = self._session.task.objects if self._session is not None else ()
        symmetries = {}
        for item in objects:
            symmetries[item.name] = item.symmetry if isinstance(item, Symmetric) else 1
            if isinstance(item, Box):
                a, b, _ = item.half_size
                symmetries[item.name] = 4 if abs(a - b) < 1e-9 else 2
        return symmetries

    def _touches(self) -> dict[str, Any]:
        """Columns of the table of touches, by name: one row for every contact of every snapshot."""
        rows = [
            (
                s.time,
                c.id,
                *map(float, c.position),
                "" if c.label is None else FINGERS[c.label],
                c.state,
                number,
            )
            for s in self._snapshots
            for number, hand in enumerate(s.hands, start=1)
            for c in hand.contacts
        ]
        names = ["time_s", "contact", "x", "y", "z", "finger", "state"]
        if self._snapshots and len(self._snapshots[0].hands) > 1:
            names.append("hand")
        return {name: [row[i] for row in rows] for i, name in enumerate(names)}


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
    # A box that lies on another face may have its x axis upright; its edges still have a yaw.
    yaw = flat_yaw(view.rotation) if symmetry > 1 else _yaw(view.rotation)
    return float((yaw - goal.yaw + part / 2) % part - part / 2)


def _yaw(rotation: Any) -> float:
    return float(np.arctan2(rotation[1, 0], rotation[0, 0]))


def tables_are_missing(folder: Path, stem: str) -> bool:
    """Returns True if the tables of a trial must be built from its recording."""
    # The CSV of the frames is written last.
    lacks = not (folder / f"frames_{stem}.csv.gz").exists()
    return (
        lacks
        or not measures_are_complete(folder, stem)
        or (find_spec("pyarrow") is not None and not (folder / f"frames_{stem}.parquet").exists())
    )


@dataclass(frozen=True)
class Rebuilt:
    """Result of building the tables of a trial again.

    Attributes:
        notices: A line for every failed measure.
        differs: What differs here, if the replayed states were not the recorded ones; empty if they
            were, or if nothing was to be built.
        built: True if something was to be built.
    """

    notices: tuple[str, ...] = ()
    differs: str = ""
    built: bool = True


def complete_tables(recording: Path, folder: Path, anew: bool = False) -> Rebuilt:
    """Builds the tables and measures of a trial that are missing; see `rebuild_tables`.

    Nothing is replayed where all are there, or where a replay here has differed before.

    Args:
        recording: Recording of a finished trial.
        folder: Folder of the tables.
        anew: True builds them even if all are there.
    """
    stem = recording.stem
    if measures_were_kept(folder, stem):
        return Rebuilt(built=anew)
    if not anew and not tables_are_missing(folder, stem):
        return Rebuilt(built=False)
    return rebuild_tables(recording, folder)


def rebuild_tables(recording: Path, folder: Path) -> Rebuilt:
    """Builds the tables and measures of a trial by replaying its recording.

    Everything is written anew where the replay gives every recorded state. Elsewhere tables and
    measures that are there stay. A missing measure is empty, with the reason; a missing 60 Hz table
    is built from the recorded poses, without contacts.

    Args:
        recording: Recording of a finished trial.
        folder: Folder of the tables.

    Raises:
        StudyError: A file cannot be written.
    """
    from sandbox.trial.replay import replay

    table, stem = FrameTable(), recording.stem

    def views(session: Session) -> list[View]:
        table.watch(session)
        return [table.show]

    try:
        loaded = load_recording(recording)
        _, verification = replay(loaded, views)
    except RecordingError as error:
        # Not where it lies: names of folders may be names of people, and tables are shared.
        differs = error.what if error.got is None else f"{error.what} (got {error.got})"
        keep_measures(folder, stem, differs, compared=False)
        return Rebuilt(differs=differs)
    end = loaded.end
    result = TrialResult.from_json(end["result"], str(recording)) if end else None
    if result is not None:
        table.truths = [dict(result.fingers or ()), dict(result.second_fingers or ())]
        table.truth_by = result.fingers_by or ""
    if verification.exact and verification.complete:
        return Rebuilt(tuple(table.write(folder, stem, result)))
    reasons = (verification.task_change, *verification.differs_in)
    differs = "; ".join(filter(None, reasons)) or SAME_MACHINE
    if verification.shown_recorded and not (folder / f"frames_{stem}.csv.gz").exists():
        table.forget_contacts()
        table.write(folder, stem)
    keep_measures(folder, stem, differs, compared=True)
    return Rebuilt(differs=differs)


def _parquet(table: dict[str, Any]) -> bytes:
    import pyarrow as pa
    from pyarrow import parquet

    columns = {
        name: pa.array(values.astype(np.float32))
        if isinstance(values, np.ndarray)
        else pa.array(values, type=pa.type_for_alias(frame_column(name).type))
        for name, values in table.items()
    }
    sink = pa.BufferOutputStream()
    parquet.write_table(pa.table(columns), sink, compression="zstd")
    return bytes(sink.getvalue())
