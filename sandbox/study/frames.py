"""The 60 Hz tables of a trial: commanded pose, labels, touches and objects, as CSV and Parquet.

They are derived: made while a trial runs, and made again from its recording where they are missing.
"""

from __future__ import annotations

import gzip
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

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
        self._poses: list[NDArray[np.float64]] = []
        self._heads: list[tuple[float, int, str, str]] = []
        self._labels: list[tuple[int | None, ...]] = []
        self._places: list[NDArray[np.float64]] = []
        self._rotations: list[NDArray[np.float64]] = []
        self._names: tuple[str, ...] = ()
        self._touches: list[tuple[Any, ...]] = []
        self.first_contact: float | None = None

    def show(self, snapshot: Snapshot) -> None:
        """Looks at a snapshot; all of them."""
        hand = snapshot.hands[0]
        self._poses.append(hand.target)
        solid = "".join(FINGERS[f][0] for f in sorted(hand.solid))
        self._heads.append((snapshot.time, snapshot.step, hand.phase, solid))
        named = {c.label: c.id for c in hand.contacts if c.label is not None}
        self._labels.append(tuple(named.get(f) for f in range(5)))
        self._names = tuple(snapshot.objects)
        views = snapshot.objects.values()
        self._places.append(np.array([o.position for o in views]))
        self._rotations.append(np.array([o.rotation for o in views]))
        for c in hand.contacts:
            finger = "" if c.label is None else FINGERS[c.label]
            self._touches.append((snapshot.time, c.id, *c.position, finger, c.state))
        if hand.contacts and self.first_contact is None:
            self.first_contact = snapshot.time

    def write(self, folder: Path, stem: str) -> None:
        """Writes the tables of a recording `stem`.

        Raises:
            StudyError: One cannot be written.
        """
        frames = self._frames()
        if find_spec("pyarrow"):
            write_atomically(folder / f"frames_{stem}.parquet", _parquet(frames), durable=False)
        touches = dict(zip(("time_s", "contact", "x", "y", "z", "finger", "state"),
                           [list(c) for c in zip(*self._touches, strict=True)] or [[]] * 7,
                           strict=True))  # fmt: skip
        for name, table in ((f"touches_{stem}.csv.gz", touches), (f"frames_{stem}.csv.gz", frames)):
            write_atomically(folder / name, _csv(table), durable=False)

    def _frames(self) -> dict[str, Any]:
        """Columns by name."""
        poses = np.array(self._poses).reshape(-1, POSE_SIZE)
        places = np.array(self._places).reshape(len(poses), -1, 3)
        rotations = np.array(self._rotations).reshape(*places.shape[:2], 3, 3)
        things = np.concatenate([places, matrix_to_quaternion(rotations)], -1)
        things = things.reshape(len(poses), things.shape[1] * 7)
        parts = ("x", "y", "z", "qw", "qx", "qy", "qz")
        names = [f"{name}_{part}" for name in self._names for part in parts]
        time, step, phase, solid = ([head[i] for head in self._heads] for i in range(4))
        return {
            "time_s": time, "step": step, "phase": phase, "solid": solid,
            **{f"touch_{f}": [ids[i] for ids in self._labels] for i, f in enumerate(FINGERS)},
            **{name: poses[:, i] for i, name in enumerate(POSE_COLUMNS)},
            **{name: things[:, i] for i, name in enumerate(names)},
        }  # fmt: skip


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
