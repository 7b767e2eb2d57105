"""Reader and writer of Vicon V files (.v): binary motion of a skeleton.

After "V#" and a version come sections. A section has a header of 32 bytes with its length and name,
then records that begin with their length. An empty record ends the section. A header of zeros ends
the sections. Records of numbers follow, one per frame. Numbers are little endian, in millimetres
and radians, with z up. A segment has a rotation vector `<a-X>` .. `<a-Z>` and, if it moves freely,
a position `<t-X>` .. `<t-Z>`.

Only parts of Vicon's own description (issue 2 of 2001) were readable. The rest follows a reader
that was written for real files (readV.m of ComedyLab).
"""

from __future__ import annotations

import re
import struct
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from models.arithmetic import Array
from models.errors import MotionError
from models.motion.armature import Z_UP, Armature, Keys
from models.motion.motion import Motion
from models.motion.output import MotionWriter, checked_rate
from models.motion.text import LARGEST, MOST, decoded
from models.motion.vsk import MILLIMETRE, MILLIMETRES, ORDER, ViconSkeleton, vsk
from models.reader_report import ReaderReport
from models.rotations import exp, log, unwrap_near

MAGIC, VERSION = b"V#", 1
SECTION = struct.Struct("<I28s")
RECORD = struct.Struct("<HHI")
"""Head of a record: length of the rest, group, frame."""
TYPES = {3: "<i2", 4: "<i4", 5: "<f4", 6: "<f8"}
"""Code of a number type -> NumPy's type. Any other code means a byte."""

_LABEL = re.compile(
    r"(?:(?P<subject>[^:]*):)?(?P<segment>.+?)\s*<(?P<kind>[atAT])-(?P<axis>[XYZ])>"
)


@dataclass(frozen=True)
class ViconMotion:
    """The columns of a V file over time.

    Attributes:
        labels: One label for each column.
        rate: Rate (Hz) of the frames.
        values: (T, columns), mm and rad.
        numbers: (T,) number of each frame from 0; a recorder may leave frames out.
        report: Parts of the file that the reader left out or assumed.
    """

    labels: tuple[str, ...]
    rate: float
    values: Array
    numbers: Array
    report: ReaderReport = field(default_factory=ReaderReport)


def read_v(path: Path) -> ViconMotion:
    """Reads a V file.

    Raises:
        MotionError: The file is not a V file, is cut short, or contains a number that is not
            finite.
    """
    try:
        if path.stat().st_size > LARGEST:
            raise MotionError(
                "the file is too large", where=str(path), expected=f"at most {LARGEST:,} bytes"
            )
        data = path.read_bytes()
    except FileNotFoundError:
        raise MotionError("no such file", where=str(path)) from None
    except OSError as error:
        raise MotionError("the file cannot be read", where=str(path), got=error.strerror) from None
    if data[:2] != MAGIC:
        raise MotionError("this is not a V file", where=str(path), expected="a file that begins V#")
    try:
        report = ReaderReport()
        group, at = _groups(data, report)
        return _values(path, data, group, at, report)
    except (struct.error, IndexError, ValueError):
        raise MotionError(
            "the V file is damaged", where=str(path), remedy="It was probably cut short"
        ) from None


def motion_of(
    path: Path, skeleton: ViconSkeleton, motion: ViconMotion, unit: float = MILLIMETRE
) -> Motion:
    """The motion of a skeleton. Its markers become joints that do not rotate.

    Args:
        path: Path of the motion, for messages.
        skeleton: From `read_vsk`.
        motion: From `read_v`.
        unit: Unit of length of the file (m).

    Raises:
        MotionError: The file moves no segment of the skeleton, or moves another subject.
    """
    report = ReaderReport()
    report.add(skeleton.report)
    report.add(motion.report)
    columns: dict[tuple[str, str, str], int] = {}
    for i, label in enumerate(motion.labels):
        match = _LABEL.fullmatch(label.strip())
        if not match or match["segment"] not in skeleton.names:
            report.leave_out("columns of no segment of the skeleton")
            continue
        key = (match["segment"], match["kind"].lower(), match["axis"])
        if key in columns:
            raise MotionError(
                "two subjects move the same segments",
                where=str(path),
                got=label[:60],
                remedy="Export one subject alone",
            )
        columns[key] = i
    if not columns:
        raise MotionError(
            "the file moves none of the skeleton's segments",
            where=str(path),
            got=", ".join(motion.labels[:4]),
            expected=f"{skeleton.names[0]} <a-X>",
        )

    def vectors(name: str, kind: str) -> Array | None:
        here = [columns.get((name, kind, axis)) for axis in "XYZ"]
        if None in here:
            return None
        return np.asarray(motion.values[:, [i for i in here if i is not None]])

    count, joints = len(motion.values), len(skeleton.names)
    shifts = np.tile(np.array(skeleton.positions), (count, 1, 1))
    rotations = np.tile(np.array(skeleton.frames), (count, 1, 1, 1))
    for j, name in enumerate(skeleton.names):
        turn, place = vectors(name, "a"), vectors(name, "t")
        if turn is not None:
            rotations[:, j] = rotations[:, j] @ exp(turn)
        elif skeleton.joints[j] != "JointDummy" and skeleton.parents[j] < 0:
            raise MotionError("the root does not move", where=str(path), got=name[:40])
        if place is not None:
            shifts[:, j] = unit * place
    ends = np.full((joints, 3), np.nan)
    marks = [m for m in skeleton.markers if m not in skeleton.names]
    names = (*skeleton.names, *marks)
    parents = (*skeleton.parents, *(skeleton.markers[m][0] for m in marks))
    if marks:
        places = np.array([skeleton.markers[m][1] for m in marks])
        shifts = np.concatenate([shifts, np.tile(places, (count, 1, 1))], axis=1)
        still = np.tile(np.eye(3), (count, len(marks), 1, 1))
        rotations = np.concatenate([rotations, still], axis=1)
        ends = np.concatenate([ends, np.full((len(marks), 3), np.nan)])
    return Motion(
        names, parents, shifts, rotations, ends, 1.0 / motion.rate, motion.numbers, report
    )


@dataclass(frozen=True)
class _Group:
    number: int
    kind: str
    rate: float
    labels: tuple[str, ...]


def _groups(data: bytes, report: ReaderReport) -> tuple[_Group, int]:
    """Finds the group of numbers, and the offset of the first record."""
    (version,) = struct.unpack_from("<h", data, 2)
    if version != VERSION:
        raise ValueError
    at, group = 4, None
    while True:
        length, name = SECTION.unpack_from(data, at)
        at += SECTION.size
        if not length and not name.strip(b"\0"):
            break
        if name.rstrip(b"\0").split(b"\0")[0] == b"DATAGROUP" and group is None:
            group = _group(data, at, report)
        at += length
    if group is None:
        raise ValueError
    return group, at


def _group(data: bytes, at: int, report: ReaderReport) -> _Group:
    _, number, described = struct.unpack_from("<HHB", data, at)
    at += 5 + described
    kind, width, rate, count = struct.unpack_from("<BBdH", data, at)
    at += 12
    labels = []
    for _ in range(count):
        end = at + 1 + data[at]
        labels.append(data[at + 1 : end].rstrip(b"\0").replace(b"\n", b" "))
        at = end
    dtype = TYPES.get(kind, "<i1")
    if not (0 < rate < 1e6) or np.dtype(dtype).itemsize != width or not labels:
        raise ValueError
    # All labels have the same encoding, which is detected as in the skeleton's file.
    text = decoded(b"\n".join(labels), report)
    return _Group(number, dtype, rate, tuple(text.split("\n")))


def _values(path: Path, data: bytes, group: _Group, at: int, report: ReaderReport) -> ViconMotion:
    size = np.dtype(group.kind).itemsize * len(group.labels)
    rows = []
    frames: list[int] = []
    while at + 2 <= len(data):
        length, number, this = RECORD.unpack_from(data, at)
        if not length:
            break
        if number == group.number:
            if length != size + RECORD.size - 2 or at + RECORD.size + size > len(data):
                raise ValueError  # of another length, or cut short
            if frames and this <= frames[-1]:
                raise MotionError("frames are out of order", where=f"{path}, frame {this}")
            frames.append(this)
            rows.append(np.frombuffer(data, group.kind, len(group.labels), at + RECORD.size))
        at += 2 + length
    if not rows:
        raise MotionError("the file contains no frame", where=str(path))
    values = np.array(rows, float)
    if not np.isfinite(values).all():
        raise MotionError("the file contains a number that is not finite", where=str(path))
    if np.abs(values).max() > MOST:
        raise MotionError(
            "the file contains a number that is too large",
            where=str(path),
            expected=f"up to {MOST:g}",
        )
    missing = frames[-1] - frames[0] + 1 - len(frames)
    if missing:
        report.assume(f"the recorder left out {missing} frames")
    return ViconMotion(
        group.labels, group.rate, values, np.array(frames, float) - frames[0], report
    )


GROUP, FLOAT = 1, 5


class VWriter(MotionWriter):
    """One hand as V and VSK.

    Args:
        path: Path of either file; the other file has the same name with the other ending.
        armature: The hand.
        rate: Rate (Hz) of the keys.
        subject: Prefix of the labels.
    """

    def __init__(self, path: Path, armature: Armature, rate: float, subject: str = "hand") -> None:
        checked_rate(rate)
        self._armature, self._zero = armature, armature.zero(ORDER)
        self._last: Array | None = None
        super().__init__(path.with_suffix(".v"), path.with_suffix(".vsk"))
        self._v, skeleton = self._outputs
        skeleton.write(vsk(armature))
        labels = [f"{subject}:{name} <a-{axis}>" for name in armature.names for axis in "XYZ"]
        labels[3:3] = [f"{subject}:{armature.names[0]} <t-{axis}>" for axis in "XYZ"]
        self._v.write(_static(labels, rate))
        self._record = np.dtype(
            [("length", "<u2"), ("group", "<u2"), ("frame", "<u4"), ("values", "<f4", len(labels))]
        )

    def write(self, *hands: Keys) -> None:
        """Appends keys of the one hand."""
        (keys,) = hands
        root, turns = self._armature.relative(keys, self._zero, Z_UP)
        vectors = self._continuous(log(turns))
        count = len(root)
        records = np.zeros(count, self._record)
        records["length"] = self._record.itemsize - 2
        records["group"] = GROUP
        records["frame"] = np.arange(self.frames + 1, self.frames + count + 1)
        records["values"] = np.concatenate(
            [vectors[:, 0], MILLIMETRES * root, vectors[:, 1:].reshape(count, -1)], axis=1
        )
        self._v.write(records.tobytes())
        self.frames += count

    def _continuous(self, vectors: Array) -> Array:
        """Rotation vectors without jumps by full turns. Only those of the wrist could jump."""
        last = vectors[0, 0] if self._last is None else self._last
        chain = np.concatenate([last[None], vectors[:, 0]])
        jumps = np.abs(np.diff(chain, axis=0)).max(axis=1) > np.pi / 2
        if jumps.any() or np.linalg.norm(last) > np.pi:
            for i in range(len(vectors)):
                last = vectors[i, 0] = unwrap_near(vectors[i, 0], last)
        self._last = vectors[-1, 0]
        return vectors


def _static(labels: list[str], rate: float) -> bytes:
    """All bytes before the first frame."""
    described = b"a hand\0"
    body = struct.pack("<HB", GROUP, len(described)) + described
    body += struct.pack("<BBdH", FLOAT, 4, rate, len(labels))
    for label in labels:
        text = label.encode("ascii") + b"\0"
        body += bytes([len(text)]) + text
    section = struct.pack("<H", len(body)) + body + b"\0\0"
    out = MAGIC + struct.pack("<h", VERSION)
    out += SECTION.pack(len(section), b"DATAGROUP") + section
    return out + SECTION.pack(0, b"")
