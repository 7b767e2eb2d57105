"""The 60 Hz tables of a trial: commanded pose, labels, touches and objects, as CSV and Parquet.

They are derived: made while a trial runs, and made again from its recording where they are missing.
"""

from __future__ import annotations

import gzip
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from models.frames import FINGERS
from models.pose import POSE_SIZE
from models.rotations import matrix_to_quaternion
from models.skeleton import ADULT
from sandbox.study.files import write_atomically

if TYPE_CHECKING:
    from sandbox.messages import Snapshot

STEMS = {"frames": "frames", "touches": "touches"}
POSE_COLUMNS = tuple(
    f"q_{name}_{axis}" for name in ("position", "rotation", *(b.name for b in ADULT.bones))
    for axis in "xyz"
)  # fmt: skip
"""The 48 numbers of a pose, in its own order."""


class FrameTable:
    """A view that keeps what the tables tell of every snapshot."""

    def __init__(self) -> None:
        self._snapshots: list[Snapshot] = []

    @property
    def first_contact(self) -> float | None:
        """s, when something first touched; None if nothing did."""
        return next((s.time for s in self._snapshots if s.hands[0].contacts), None)

    def show(self, snapshot: Snapshot) -> None:
        """Looks at a snapshot; all of them."""
        # It is taken apart after the trial: the session's loop has better things to do.
        self._snapshots.append(snapshot)

    def write(self, folder: Path, stem: str) -> None:
        """Writes the tables of a recording `stem`.

        Raises:
            StudyError: One cannot be written.
        """
        frames = self._frames()
        if find_spec("pyarrow"):
            write_atomically(folder / f"frames_{stem}.parquet", _parquet(frames), durable=False)
        touches = self._touches()
        for name, table in ((f"touches_{stem}.csv.gz", touches), (f"frames_{stem}.csv.gz", frames)):
            write_atomically(folder / name, _csv(table), durable=False)

    def _frames(self) -> dict[str, Any]:
        """Columns by name, a row for every snapshot."""
        shots = self._snapshots
        hands = [s.hands[0] for s in shots]
        poses = np.array([hand.target for hand in hands]).reshape(-1, POSE_SIZE)
        named = [{c.label: c.id for c in hand.contacts} for hand in hands]
        columns: dict[str, Any] = {
            "time_s": [s.time for s in shots],
            "step": [s.step for s in shots],
            "phase": [hand.phase for hand in hands],
            "solid": ["".join(FINGERS[f][0] for f in sorted(hand.solid)) for hand in hands],
            **{f"touch_{name}": [ids.get(i) for ids in named] for i, name in enumerate(FINGERS)},
            **{name: poses[:, i] for i, name in enumerate(POSE_COLUMNS)},
        }
        for name in shots[0].objects if shots else ():
            views = [s.objects[name] for s in shots]
            places = np.array([view.position for view in views])
            turns = matrix_to_quaternion(np.array([view.rotation for view in views]))
            columns |= {f"{name}_{part}": places[:, i] for i, part in enumerate("xyz")}
            columns |= {f"{name}_q{part}": turns[:, i] for i, part in enumerate("wxyz")}
        return columns

    def _touches(self) -> dict[str, Any]:
        """Columns by name, a row for every contact of every snapshot."""
        rows = [
            (s.time, c.id, *map(float, c.position),
             "" if c.label is None else FINGERS[c.label], c.state)
            for s in self._snapshots for c in s.hands[0].contacts
        ]  # fmt: skip
        names = ("time_s", "contact", "x", "y", "z", "finger", "state")
        return {name: [row[i] for row in rows] for i, name in enumerate(names)}


def missing(folder: Path, stem: str) -> bool:
    """Whether a trial's tables have to be made."""
    # The CSV of the frames is written last.
    lacks = not (folder / f"frames_{stem}.csv.gz").exists()
    return lacks or (
        find_spec("pyarrow") is not None and not (folder / f"frames_{stem}.parquet").exists()
    )


def rebuild(recording: Path, folder: Path) -> None:
    """Makes a trial's tables from its recording, by playing it again.

    Raises:
        InputError: It cannot be played here, or they cannot be written.
    """
    from sandbox.recording import load_recording
    from sandbox.replay import replay

    table = FrameTable()
    replay(load_recording(recording), lambda session: [table.show])
    table.write(folder, recording.stem)


def _csv(table: dict[str, Any]) -> bytes:
    """A table, compressed; R and pandas read it as it is."""
    columns = [_texts(values) for values in table.values()]
    lines = [",".join(table), *map(",".join, zip(*columns, strict=True)), ""]
    return gzip.compress("\n".join(lines).encode(), compresslevel=5, mtime=0)


def _texts(values: Any) -> list[str]:
    """Cells of a column: 0.01 mm and 0.00001 rad are enough for tables."""
    if isinstance(values, np.ndarray):
        return np.char.mod("%.5f", values).tolist()
    return ["" if v is None else f"{v:.5f}" if isinstance(v, float) else str(v) for v in values]


def _parquet(table: dict[str, Any]) -> bytes:
    import pyarrow as pa
    from pyarrow import parquet

    columns = {
        name: pa.array(values.astype(np.float32)) if isinstance(values, np.ndarray)
        else pa.array(values, type=_TYPES.get(name) and getattr(pa, _TYPES[name])())
        for name, values in table.items()
    }  # fmt: skip
    sink = pa.BufferOutputStream()
    parquet.write_table(pa.table(columns), sink, compression="zstd")
    return bytes(sink.getvalue())


_TYPES = {
    "time_s": "float64", "step": "int64", "phase": "string", "solid": "string",
    **{f"touch_{f}": "int64" for f in FINGERS},
}  # fmt: skip
