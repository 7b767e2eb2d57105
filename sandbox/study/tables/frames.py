"""The 60 Hz tables of a trial: commanded pose, labels, touches and objects, as CSV and Parquet.

They are derived: made while a trial runs, and made again from its recording where they are missing.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from models.errors import StudyError
from models.frames import FINGERS, TouchFrame
from models.json_input import decoded_record, read_bytes
from models.pose import POSE_SIZE
from models.rotations import matrix_to_quaternion
from models.skeleton import ADULT
from sandbox.recording.recording import load_recording
from sandbox.study.measures.columns import SECOND, Columns
from sandbox.study.measures.compute import VERSION, measure_result, measure_trial
from sandbox.study.measures.registry import measures
from sandbox.study.measures.touching import ContactReader, ContactSample, ObjectPushes
from sandbox.study.record.files import write_atomically
from sandbox.study.tables.frame_columns import frame_column
from sandbox.trial.result import TrialResult
from tasks.goals import flat_yaw

if TYPE_CHECKING:
    from models.frames import Frame
    from sandbox.session.messages import ObjectView, Snapshot
    from sandbox.session.session import Session
    from sandbox.trial.driver import View
    from tasks.task import Goal

REASONS = "reasons"
"""Key of a file of measures: why cells are empty, by measure."""
STEMS = {"frames": "frames", "touches": "touches"}
POSE_COLUMNS = tuple(
    f"q_{name}_{axis}"
    for name in ("position", "rotation", *(b.name for b in ADULT.bones))
    for axis in "xyz"
)
"""The 48 numbers of a pose, in its own order."""


class FrameTable:
    """A view that keeps what the tables tell of every snapshot.

    Attributes:
        truths: True finger by contact, hand by hand, where somebody knows.
        truth_by: Who knows; empty where nobody does.
    """

    def __init__(self) -> None:
        self._snapshots: list[Snapshot] = []
        self._contacts: list[ContactSample] = []
        self._heard: list[list[Frame]] = []
        self._session: Session | None = None
        self._touching: ContactReader | None = None
        self.truths: list[dict[int, int]] = []
        self.truth_by = ""

    @property
    def first_contact(self) -> float | None:
        """s, when something first touched; None if nothing did."""
        return next((s.time for s in self._snapshots if any(h.contacts for h in s.hands)), None)

    def watch(self, session: Session) -> None:
        """Says which session the snapshots come from; who pushes what is read there."""
        if self._session is None:
            self._session, self._touching = session, ContactReader(session.scene, session.data)

    def show(self, snapshot: Snapshot) -> None:
        """Looks at a snapshot; all of them, each before the session goes on."""
        # It is taken apart after the trial: the session's loop has better things to do.
        self._snapshots.append(snapshot)
        if self._session is not None and self._touching is not None:
            self._heard.append([self._session.heard(k) for k in range(len(snapshot.hands))])
            self._contacts.append(self._touching.copy())

    def forget_contacts(self) -> None:
        """Makes who pushes what unknown: what was simulated is not what is shown."""
        self._contacts = []

    def write(self, folder: Path, stem: str, result: TrialResult | None = None) -> list[str]:
        """Writes the tables of a recording `stem`, and the measures.

        Args:
            folder: Folder of the tables.
            stem: Stem of the recording's name.
            result: Result that the recording ends with; None writes no measures.

        Returns:
            A line for every measure that failed.

        Raises:
            StudyError: One cannot be written.
        """
        if not any(self.truths):
            self._believe_the_devices()
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

    def _believe_the_devices(self) -> None:
        """Takes what devices say of their touches for true, where nobody knows better."""
        told = [
            {
                contact.id: contact.label
                for frame in frames
                for contact in (frame.contacts if isinstance(frame, TouchFrame) else ())
                if contact.label is not None
            }
            for frames in zip(*self._heard, strict=True)
        ]
        if any(told):
            self.truths, self.truth_by = told, "device"

    def _frames(self) -> dict[str, Any]:
        """Columns by name, a row for every snapshot."""
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
            places = np.array([view.position for view in views])
            turns = matrix_to_quaternion(np.array([view.rotation for view in views]))
            columns |= {f"{name}_{part}": places[:, i] for i, part in enumerate("xyz")}
            columns |= {f"{name}_q{part}": turns[:, i] for i, part in enumerate("wxyz")}
        return columns | self._pushes() | self._goals()

    def _hand(self, hand: int, prefix: str) -> dict[str, Any]:
        """Columns of one hand."""
        views = [s.hands[hand] for s in self._snapshots]
        truth = self.truths[hand] if hand < len(self.truths) else {}
        poses = np.array([view.target for view in views]).reshape(-1, POSE_SIZE)
        named = [{c.label: c.id for c in view.contacts} for view in views]
        true = [{truth.get(c.id): c.id for c in view.contacts} for view in views]
        columns = {
            "phase": [view.phase for view in views],
            "solid": ["".join(FINGERS[f][0] for f in sorted(view.solid)) for view in views],
            **{f"touch_{name}": [ids.get(i) for ids in named] for i, name in enumerate(FINGERS)},
            **{f"true_{name}": [ids.get(i) for ids in true] for i, name in enumerate(FINGERS)},
            **{name: poses[:, i] for i, name in enumerate(POSE_COLUMNS)},
        }
        return {prefix + name: values for name, values in columns.items()}

    def _pushes(self) -> dict[str, Any]:
        """Who pushes each thing; empty cells where that is not known."""
        columns: dict[str, Any] = {}
        names = self._snapshots[0].objects if self._snapshots else ()
        rows: list[Mapping[str, ObjectPushes] | None] = [None] * len(self._snapshots)
        if self._touching is not None and self._contacts:
            rows = [self._touching.pushes(contacts) for contacts in self._contacts]
        for name in names:
            found = [None if row is None else row[name] for row in rows]
            columns |= {
                f"{name}_digits": [p.digits if p else None for p in found],
                f"{name}_grip_N": [p.grip if p else None for p in found],
                f"{name}_by": [" ".join(p.by) if p else None for p in found],
                f"{name}_on": [" ".join(p.on) if p else None for p in found],
            }
        return columns

    def _goals(self) -> dict[str, Any]:
        """Where each thing with a goal should be, and how far it is turned against that."""
        columns: dict[str, Any] = {}
        alike = self._alike()
        for i, goal in enumerate(self._snapshots[0].goals if self._snapshots else ()):
            name = goal.object
            placed = [s.goals[i] for s in self._snapshots]
            places = np.array([goal.position for goal in placed])
            columns |= {f"{name}_goal_{part}": places[:, j] for j, part in enumerate("xyz")}
            columns[f"{name}_off_rad"] = [
                turn_off(s.objects[name], goal, alike.get(name, 1))
                for s, goal in zip(self._snapshots, placed, strict=True)
            ]
        return columns

    def _alike(self) -> dict[str, int]:
        """How often things look the same in a turn about the vertical; 0: at any angle."""
        things = self._session.task.objects if self._session is not None else ()
        found = {}
        for thing in things:
            half = getattr(thing, "half_size", None)
            found[thing.name] = int(getattr(thing, "looks_alike", 1))
            if half is not None:
                found[thing.name] = 4 if abs(half[0] - half[1]) < 1e-9 else 2
        return found

    def _touches(self) -> dict[str, Any]:
        """Columns by name, a row for every contact of every snapshot."""
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


def turn_off(thing: ObjectView, goal: Goal, alike: int) -> float:
    """rad about the vertical from a goal to a thing, by the nearest turn that looks the same."""
    if alike == 0:
        return 0.0
    part = 2.0 * np.pi / alike
    # A box on another of its faces has its x axis upright, and still edges with a direction.
    yaw = flat_yaw(thing.rotation) if alike > 1 else _yaw(thing.rotation)
    return float((yaw - goal.yaw + part / 2) % part - part / 2)


def _yaw(rotation: Any) -> float:
    return float(np.arctan2(rotation[1, 0], rotation[0, 0]))


def write_measures(
    folder: Path, stem: str, table: Columns, result: TrialResult, truth: str
) -> list[str]:
    """Writes the measures of a trial, and why some are empty.

    Returns:
        A line for every measure that failed.

    Raises:
        StudyError: They cannot be written.
    """
    measured, at_end = measure_trial(table, result, truth), measure_result(result)
    values = {
        "version": VERSION,
        "truth": truth,
        **measured.values,
        REASONS: {**measured.reasons, **at_end.reasons},
    }
    data = json.dumps(values, indent=1).encode() + b"\n"
    write_atomically(folder / f"measures_{stem}.json", data, durable=False)
    return [*measured.notices, *at_end.notices]


def read_measures(folder: Path, stem: str) -> dict[str, Any]:
    """The measures of a trial; empty where there are none, or another version made them."""
    values = _stored_measures(folder, stem)
    return {name: value for name, value in values.items() if name not in ("truth", REASONS)}


def _stored_measures(folder: Path, stem: str) -> dict[str, Any]:
    path, what = folder / f"measures_{stem}.json", "the measures cannot be read"
    try:
        data = read_bytes(path, StudyError, what=what)
        values = decoded_record(data, StudyError, what=what, where=str(path))
    except StudyError:
        return {}
    if values.pop("version", None) != VERSION:
        return {}
    return values


def missing(folder: Path, stem: str) -> bool:
    """Whether a trial's tables have to be made from its recording."""
    # The CSV of the frames is written last.
    lacks = not (folder / f"frames_{stem}.csv.gz").exists() or not read_measures(folder, stem)
    return lacks or (
        find_spec("pyarrow") is not None and not (folder / f"frames_{stem}.parquet").exists()
    )


def complete(recording: Path, folder: Path) -> list[str]:
    """Makes the tables and measures that a trial lacks.

    Tables are made by playing the recording again; a measure that was added since is computed from
    the table that there is.

    Args:
        recording: A finished trial's.
        folder: Folder of the tables.

    Returns:
        A line for every measure that failed.

    Raises:
        InputError: It cannot be played here, or they cannot be written.
    """
    stem = recording.stem
    if missing(folder, stem):
        return rebuild(recording, folder)
    stored = _stored_measures(folder, stem)
    if all(m.name in stored for m in measures() if m.of_trial is not None):
        return []
    loaded = load_recording(recording)
    if loaded.end is None:
        return []
    table = Columns.read((folder / f"frames_{stem}.csv.gz").read_bytes())
    result = TrialResult.from_json(loaded.end["result"], str(recording))
    return write_measures(folder, stem, table, result, str(stored["truth"]))


def rebuild(recording: Path, folder: Path) -> list[str]:
    """Makes a trial's tables from its recording, by playing it again.

    Returns:
        A line for every measure that failed.

    Raises:
        InputError: It cannot be played here, or they cannot be written.
    """
    from sandbox.trial.replay import replay

    table, loaded = FrameTable(), load_recording(recording)

    def views(session: Session) -> list[View]:
        table.watch(session)
        return [table.show]

    _, found = replay(loaded, views)
    if found.shown_recorded and not found.exact:
        table.forget_contacts()
    result = TrialResult.from_json(loaded.end["result"], str(recording)) if loaded.end else None
    if result is not None:
        table.truths = [dict(result.fingers or ()), dict(result.second_fingers or ())]
        table.truth_by = result.fingers_by or ""
    return table.write(folder, recording.stem, result)


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
