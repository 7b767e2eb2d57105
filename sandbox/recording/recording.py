"""Recordings: inputs with their physics steps, for a bit-identical replay.

A recording is a file of JSON lines:

- `header`: settings, versions and digests.
- `input`: a touch frame or hand frame, the physics step at which it took effect, and the state's
  hash just before.
- `event`: an event other than a frame, such as a change of contact mode.
- `keyframe`: MuJoCo's integration state, once per simulated second.
- `track`: all poses of one simulated second.
- `end`: the result.

If the program crashes, at most the lines of the last 10 ms and one second of the track are lost.

The track is used to show a trial on machines that cannot reproduce its states. Its joint positions
are rounded, so that it is for viewing only. To continue a simulation, use a keyframe.

A recording is written uncompressed, line by line, and may be compressed once it is complete. The
compressed file has the same name with `.gz` appended. Readers accept both files.
"""

from __future__ import annotations

import base64
import gzip
import json
import threading
import zlib
from abc import ABC, abstractmethod
from collections import deque
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from models.arithmetic import Array
from models.errors import InputError, RecordingError
from models.frames import (
    Contact,
    Frame,
    HandFrame,
    LandmarkFrame,
    SeenHand,
    TouchFrame,
    TrackedFinger,
    TrackedHand,
    Vector,
    finger_bits,
)
from models.scene import CONTROL_PERIOD

SCHEMA = 2
"""Version of the file format."""

KEYFRAME_PERIOD = 1.0
"""Time between two stored states, s."""
STATES_PER_KEYFRAME = round(KEYFRAME_PERIOD / CONTROL_PERIOD)

LOOK = 0.01
"""Time between two looks of the writing thread for new lines, s."""

Line = dict[str, Any]
SHARED_FIELDS = {
    "input": (
        *("kind", "step", "hand", "time", "contacts", "lift", "cancelled", "hands", "dialect"),
        *("taken", "size", "seen", "hash"),
    ),
    "event": ("kind", "step", "event", "mode", "objects"),
    "keyframe": ("kind", "step", "state", "hash"),
    "track": ("kind", "steps", "hands", "joints", "poses"),
    "end": ("kind", "step", "hash", "result"),
}
"""Fields of lines, by kind, that `sandbox study share` copies. The shared fields of a header are
those of a result with `SHARED` (`sandbox.trial.result`)."""

GRAIN = 2e-5
"""Rounding of joint positions, in m, rad or quaternion units: 0.02 mm, 0.002 degrees."""
TRACK_LEVEL = 6
"""Compression level of zlib. Level 6 takes 0.1 ms for the poses of a second. Level 9 takes 0.5 to
1 ms, and its data are 2 percent smaller."""
ROOM = 64
"""Initial capacity in poses: slightly more than a second."""
LONGEST = 3600 * 1000
"""Number of poses in a line above which the line counts as damaged."""


@dataclass(frozen=True)
class PoseTrack:
    """Poses by physics step.

    Attributes:
        qpos: Joint positions of the scene's model (nq,) by step.
        solid: Labels of each hand's solid fingers, by step.
    """

    qpos: dict[int, Array] = field(default_factory=dict)
    solid: dict[int, tuple[frozenset[int], ...]] = field(default_factory=dict)


class PoseTrackWriter:
    """Collects poses and turns them into lines of a recording.

    Poses are copied into memory that was allocated beforehand. Allocating memory after the loop has
    slept would take longer than copying.
    """

    def __init__(self) -> None:
        self._entries: list[tuple[int, Sequence[frozenset[int]]]] = []
        self._poses = np.empty((0, 0))

    def add(self, step: int, qpos: Array, solid: Sequence[frozenset[int]]) -> None:
        """Adds a pose (nq,) and the solid fingers of every hand at a physics step."""
        row = len(self._entries)
        if row == len(self._poses):
            self._make_room(len(qpos))
        self._poses[row] = qpos
        self._entries.append((step, solid))

    def take(self) -> Callable[[], dict[str, Any]] | None:
        """Returns a function that makes a line of the poses since the last call.

        Returns None if there are no new poses. The returned function takes a millisecond, and may
        be called later from any thread.
        """
        if not self._entries:
            return None
        make = partial(_line_of, self._entries, self._poses)
        self._entries, self._poses = [], np.empty_like(self._poses)
        return make

    def line(self) -> dict[str, Any] | None:
        """Makes a line of all poses since the last line; None without poses."""
        make = self.take()
        return make() if make else None

    def _make_room(self, joints: int) -> None:
        room = np.empty((max(ROOM, 2 * len(self._poses)), joints))
        if len(self._poses):
            room[: len(self._poses)] = self._poses
        self._poses = room


def _line_of(
    entries: Sequence[tuple[int, Sequence[frozenset[int]]]], poses: Array
) -> dict[str, Any]:
    steps, solid = zip(*entries, strict=True)
    return track_line(list(steps), poses[: len(entries)], solid)


def track_line(
    steps: list[int], poses: Array | Sequence[Array], solid: Sequence[Sequence[frozenset[int]]]
) -> dict[str, Any]:
    """Makes the `track` line of poses.

    Args:
        steps: Physics steps of the poses, evenly spaced.
        poses: Joint positions (nq,) at each step.
        solid: Labels of the solid fingers of every hand, at each step.
    """
    with np.errstate(invalid="ignore"):
        places = np.clip(np.nan_to_num(np.array(poses)), -1e4, 1e4) / GRAIN
    masks = [[finger_bits(labels) for labels in hands] for hands in solid]
    fingers = np.array(masks, np.int64).reshape(len(steps), -1)
    rows = np.hstack([np.rint(places).astype(np.int64), fingers])
    changes = np.diff(rows, axis=0, prepend=0 * rows[:1])
    # Zigzag encoding: small changes of either sign become small numbers. Their upper bytes are 0.
    folded = ((changes << 1) ^ (changes >> 63)).astype("<u4")
    planes = np.ascontiguousarray(folded.T).view(np.uint8).reshape(-1, 4).T
    data = base64.b64encode(zlib.compress(planes.tobytes(), TRACK_LEVEL)).decode()
    return {
        "kind": "track",
        "steps": _runs(steps),
        "hands": fingers.shape[1],
        "joints": places.shape[1],
        "poses": data,
    }


def read_track_line(line: dict[str, Any], track: PoseTrack) -> None:
    """Adds the poses of a recorded line to a track.

    Raises:
        ValueError: The line is damaged.
    """
    first, stride, count = (int(n) for n in line["steps"])
    joints, hands = int(line["joints"]), int(line["hands"])
    if not (0 < count <= LONGEST and 0 <= joints <= 10_000 and 0 <= hands <= 8):
        raise ValueError("the size of the track is implausible")
    size = 4 * count * (joints + hands)
    packed = zlib.decompressobj()
    data = packed.decompress(base64.b64decode(line["poses"], validate=True), size + 1)
    if len(data) != size:
        raise ValueError("the length of the track's data differs from its size")
    planes = np.frombuffer(data, np.uint8).reshape(4, -1).T
    folded = np.ascontiguousarray(planes).view("<u4").reshape(joints + hands, count).T
    folded = folded.astype(np.int64)
    rows = np.cumsum((folded >> 1) ^ -(folded & 1), axis=0)
    for i, row in enumerate(rows):
        step = first + i * stride
        track.qpos[step] = row[:joints] * GRAIN
        track.solid[step] = tuple(
            frozenset(f for f in range(5) if mask >> f & 1) for mask in row[joints:].tolist()
        )


def _runs(steps: list[int]) -> list[int]:
    """First step, stride and count of evenly spaced steps."""
    stride = steps[1] - steps[0] if len(steps) > 1 else 1
    return [steps[0], stride, len(steps)]


def frame_to_json(frame: Frame) -> dict[str, Any]:
    """Converts a frame to JSON values; floats written by Python are read back exactly."""
    if isinstance(frame, HandFrame):
        line: dict[str, Any] = {"time": frame.time, "hands": [_hand(h) for h in frame.hands]}
        told = {"source": frame.source, "dialect": frame.dialect}
        return line | {name: value for name, value in told.items() if value}
    if isinstance(frame, LandmarkFrame):
        return {
            "time": frame.time,
            "taken": frame.taken,
            "size": frame.size,
            "seen": [[h.side, h.score, h.image, h.world] for h in frame.hands],
            **({"source": frame.source} if frame.source else {}),
        }
    contacts = [[c.id, c.x, c.y, c.size, c.label, *(c.extent or ())] for c in frame.contacts]
    line = {"time": frame.time, "contacts": contacts}
    if frame.lift is not None:
        line["lift"] = frame.lift
    if frame.cancelled:
        line["cancelled"] = sorted(frame.cancelled)
    return line


def frame_from_json(line: dict[str, Any]) -> Frame:
    """Reads a frame from JSON values.

    Raises:
        FrameError: The numbers are not valid for a frame.
        KeyError, TypeError, ValueError: The values are damaged.
    """
    if "hands" in line:
        hands = tuple(map(_read_hand, line["hands"]))
        dialect = line.get("dialect")
        return HandFrame(
            float(line["time"]),
            hands,
            str(line.get("source", "")),
            None if dialect is None else str(dialect),
        )
    if "seen" in line:
        width, height = line["size"]
        return LandmarkFrame(
            float(line["time"]),
            tuple(_read_seen(*hand) for hand in line["seen"]),
            (int(width), int(height)),
            float(line["taken"]),
            str(line.get("source", "")),
        )
    contacts = tuple(
        Contact(int(i), x, y, size, label, _extent(extent))
        for i, x, y, size, label, *extent in line["contacts"]
    )
    return TouchFrame(
        float(line["time"]), contacts, line.get("lift"), frozenset(line.get("cancelled", ()))
    )


def _extent(values: list[Any]) -> tuple[float, float] | None:
    """Reads width and height of a contact, m; None if there are no values after the label."""
    if not values:
        return None
    width, height = values
    return float(width), float(height)


def _hand(hand: TrackedHand) -> dict[str, Any]:
    values: dict[str, Any] = {
        "id": hand.id,
        "palm": hand.palm,
        "normal": hand.normal,
        "direction": hand.direction,
        "fingers": [
            [f.id, f.tip, f.direction, f.length, f.finger, f.joints, f.extended]
            for f in hand.fingers
        ],
    }
    if hand.confidence != 1.0:
        values["confidence"] = hand.confidence
    for name in ("side", "sphere_radius", "wrist"):
        if getattr(hand, name) is not None:
            values[name] = getattr(hand, name)
    return values


def _read_hand(values: dict[str, Any]) -> TrackedHand:
    fingers = []
    for id_, tip, direction, length, finger, joints, extended in values["fingers"]:
        if joints is not None:
            mcp, pip, dip, end = map(_vector, joints)
            joints = (mcp, pip, dip, end)
        fingers.append(
            TrackedFinger(
                int(id_), _vector(tip), _vector(direction), float(length), finger, joints, extended
            )
        )
    wrist, radius = values.get("wrist"), values.get("sphere_radius")
    return TrackedHand(
        int(values["id"]),
        _vector(values["palm"]),
        _vector(values["normal"]),
        _vector(values["direction"]),
        tuple(fingers),
        values.get("side"),
        float(values.get("confidence", 1.0)),
        None if radius is None else float(radius),
        None if wrist is None else _vector(wrist),
    )


def _read_seen(side: Any, score: Any, image: Any, world: Any) -> SeenHand:
    points = tuple((float(x), float(y)) for x, y in image)
    return SeenHand(str(side), float(score), points, tuple(map(_vector, world)))


def _vector(values: Any) -> Vector:
    x, y, z = values
    return float(x), float(y), float(z)


GZIP = b"\x1f\x8b"
"""First bytes of a compressed file."""
SUFFIX = ".gz"
GZIP_LEVEL = 6
"""Compression level. Level 9 takes three times as long, and its files are 1 percent smaller."""

_PIECE = 1 << 16


def stored(path: Path) -> Path:
    """Returns the file of a recording: the compressed file if only this file exists, else
    `path`."""
    packed = Path(f"{path}{SUFFIX}")
    return packed if not path.exists() and packed.exists() else path


class Stored(NamedTuple):
    """Contents of a recording's file.

    Attributes:
        data: Uncompressed bytes. If a compressed file is damaged, the bytes before the damage.
        whole: False if compressed data are damaged.
    """

    data: bytes
    whole: bool


def read_stored(path: Path) -> Stored:
    """Reads a recording's bytes, plain or compressed.

    Raises:
        OSError: The file does not exist or cannot be read.
    """
    data = stored(path).read_bytes()
    return _unpacked(data) if data.startswith(GZIP) else Stored(data, True)


def first_line(path: Path, most: int = 1_000_000) -> bytes:
    """Reads a recording's first line, up to `most` bytes.

    Raises:
        OSError: The file does not exist or cannot be read.
    """
    with stored(path).open("rb") as file:
        head = file.read(2)
        file.seek(0)
        if head != GZIP:
            return file.readline(most)
        try:
            with gzip.open(file) as text:
                return text.readline(most)
        except (EOFError, zlib.error):
            return b""


def packed(data: bytes) -> bytes:
    """Compresses data. Equal data give equal bytes."""
    return gzip.compress(data, compresslevel=GZIP_LEVEL, mtime=0)


def _unpacked(data: bytes) -> Stored:
    """Decompresses data up to their end, or up to the damage."""
    reader, pieces = zlib.decompressobj(wbits=31), []
    try:
        # Decompress in pieces, so that the pieces before the damage are not lost.
        while data and not reader.eof:
            pieces.append(reader.decompress(data, _PIECE))
            data = reader.unconsumed_tail
    except zlib.error:
        return Stored(b"".join(pieces), False)
    return Stored(b"".join(pieces), reader.eof)


class DeferredLine:
    """A line that is made on first use, so that the session's loop does not do this work.

    Args:
        make: Function that makes the line.
        values: Arguments of the function; they must not change afterwards.
    """

    __slots__ = ("_line", "_parts")

    def __init__(self, make: Callable[..., Line], *values: Any) -> None:
        # One attribute for both values: another thread reads either both values or None.
        self._parts: tuple[Callable[..., Line], tuple[Any, ...]] | None = (make, values)
        self._line: Line | None = None

    def line(self) -> Line:
        """Makes the line or returns it; may be called from any thread."""
        parts = self._parts
        if self._line is None and parts is not None:
            make, values = parts
            self._line = make(*values)
        # The arguments may be large, and are not needed any more.
        self._parts = None
        assert self._line is not None
        return self._line


class RecordingLines(ABC):
    """Base class of session recorders. It makes the lines of a recording; subclasses store them."""

    def __init__(self) -> None:
        self._track = PoseTrackWriter()
        self._states = 0

    def input(self, step: int, hand: int, frame: Frame, state_hash: str) -> None:
        """Records a frame, the step at which it takes effect, and the state's hash before this
        step."""
        self._put(DeferredLine(input_line, step, hand, frame, state_hash))

    def event(self, step: int, what: str, **details: Any) -> None:
        """Records an event other than a frame, such as a change of the contact mode, at a step."""
        self._put({"kind": "event", "step": step, "event": what, **details})

    def state(
        self,
        step: int,
        state: NDArray[np.float64],
        state_hash: str,
        qpos: NDArray[np.float64],
        solid: Sequence[frozenset[int]],
    ) -> None:
        """Records the state at the beginning of a control period."""
        if self._states % STATES_PER_KEYFRAME == 0:
            self._put_track()
            self.keyframe(step, state, state_hash)
        self._states += 1
        self._track.add(step, qpos, solid)

    def keyframe(self, step: int, state: NDArray[np.float64], state_hash: str) -> None:
        """Records the integration state at a physics step."""
        self._put(DeferredLine(keyframe_line, step, state.copy(), state_hash))

    def end(self, step: int, result: dict[str, Any]) -> None:
        """Records the trial's end and result."""
        self._put_track()
        self._put(end_line(step, result))

    def _put_track(self) -> None:
        make = self._track.take()
        if make:
            self._put(DeferredLine(make))

    @abstractmethod
    def _put(self, line: Line | DeferredLine) -> None:
        """Stores a line."""


def input_line(step: int, hand: int, frame: Frame, state_hash: str) -> Line:
    """Makes the `input` line of a frame that takes effect at a physics step."""
    return {"kind": "input", "step": step, "hand": hand, **frame_to_json(frame), "hash": state_hash}


def keyframe_line(step: int, state: NDArray[np.float64], state_hash: str) -> Line:
    """Makes the `keyframe` line of an integration state."""
    text = base64.b64encode(np.ascontiguousarray(state, "<f8").tobytes()).decode()
    return {"kind": "keyframe", "step": step, "state": text, "hash": state_hash}


def end_line(step: int, result: dict[str, Any]) -> Line:
    """Makes the `end` line of a trial."""
    return {"kind": "end", "step": step, "hash": result["state_hash"], "result": result}


class RecordingWriter(RecordingLines):
    """Writes a recording from its own thread every 10 ms, one write per line.

    The session never waits for this thread.

    Args:
        path: The new file; an existing file is never overwritten.
        header: Header: settings, versions, digests and further JSON values.

    Raises:
        RecordingError: The file exists or cannot be created.
    """

    def __init__(self, path: Path, header: dict[str, Any]) -> None:
        try:
            # Unbuffered: a written line survives a crash of the program.
            self._file = path.open("xb", buffering=0)
        except FileExistsError:
            raise RecordingError(
                "the file exists already", where=str(path), remedy="Choose another name"
            ) from None
        except OSError as error:
            raise RecordingError(
                "the file cannot be written", where=str(path), got=error.strerror
            ) from None
        super().__init__()
        self.path = path
        self._start()
        self._put({"kind": "header", "schema": SCHEMA, **header})

    def put(self, line: Line | DeferredLine) -> None:
        """Appends a line that the caller has made."""
        self._waiting.append(line)

    def _start(self) -> None:
        # A deque, since appending to it wakes no thread. Waking a thread would be the slowest part.
        self._waiting: deque[Line | DeferredLine] = deque()
        self._ending = threading.Event()
        self._error: Exception | None = None
        self._thread = threading.Thread(target=self._write, name="recording", daemon=True)
        self._thread.start()

    def close(self) -> None:
        """Waits until everything is on disk.

        Raises:
            RecordingError: A line could not be written; the lines before it are on disk.
        """
        if self._thread.is_alive():
            self._ending.set()
            self._thread.join()
            self._file.close()
        self.check()

    def check(self) -> None:
        """Raises the error of the writing thread, if there is one; never waits.

        Raises:
            RecordingError: A line could not be written; the lines before it are on disk.
        """
        if isinstance(self._error, OSError):
            raise RecordingError(
                "the recording is incomplete",
                where=str(self.path),
                got=self._error.strerror,
                remedy="Make room on the disk; the lines before this are complete",
            )
        if self._error is not None:
            raise RecordingError(
                "the recording is incomplete",
                where=str(self.path),
                got=str(self._error),
                expected="events and results of JSON types, such as float(x) of NumPy's numbers",
            )

    def _put(self, line: Line | DeferredLine) -> None:
        self._waiting.append(line)

    def _write(self) -> None:
        ending = False
        while not ending:
            # Lines that arrive after this loop are written in the next round.
            ending = self._ending.wait(LOOK)
            while self._waiting:
                self._write_line(self._waiting.popleft())

    def _write_line(self, line: Line | DeferredLine) -> None:
        if self._error is not None:
            return
        try:
            values = line.line() if isinstance(line, DeferredLine) else line
            data = json.dumps(values, separators=(",", ":")).encode() + b"\n"
            while data:
                data = data[self._file.write(data) :]
        except Exception as error:  # the thread must survive, so that `check` can raise the error
            # The disk is full, or a value is of no JSON type.
            self._error = error


@dataclass(frozen=True)
class RecordedInput:
    """A frame, the physics step at which it took effect, and the state's hash before the step."""

    step: int
    frame: Frame
    state_hash: str


@dataclass(frozen=True)
class RecordedEvent:
    """An event at a physics step, with its name and details."""

    step: int
    what: str
    details: dict[str, Any]


@dataclass(frozen=True)
class Recording:
    """The contents of a recording's file.

    Attributes:
        path: File of the recording.
        header: Header in the current format (see `read_header`).
        inputs: Inputs of each hand, in order, by the hand's index.
        keyframes: Integration states by physics step.
        events: Events in order.
        hashes: State hashes by physics step, for the steps with a hash in the file.
        track: Poses, for viewing; empty if the file ends before the first `track` line.
        end: The `end` line; None if the recording breaks off.
        damage: Description of damage at the end of the file; empty without damage.
    """

    path: Path
    header: dict[str, Any]
    inputs: dict[int, list[RecordedInput]] = field(default_factory=dict)
    keyframes: dict[int, NDArray[np.float64]] = field(default_factory=dict)
    events: list[RecordedEvent] = field(default_factory=list)
    hashes: dict[int, str] = field(default_factory=dict)
    track: PoseTrack = field(default_factory=PoseTrack)
    end: dict[str, Any] | None = None
    damage: str = ""

    def touches(self, hand: int = 0) -> list[TouchFrame]:
        """Returns the touch frames of a hand.

        Raises:
            RecordingError: The hand was driven by hand frames.
        """
        frames = [entry.frame for entry in self.inputs.get(hand, [])]
        touches = [frame for frame in frames if isinstance(frame, TouchFrame)]
        if len(touches) < len(frames):
            raise RecordingError(
                "this recording has no touches, since the hand was in the air",
                where=str(self.path),
                remedy="`sandbox run` and `sandbox replay` play it",
            )
        return touches


def is_recording(path: Path) -> bool:
    """True if a file begins with the header of a recording."""
    try:
        head = json.loads(first_line(path))
    except (OSError, ValueError, RecursionError):
        return False
    return isinstance(head, dict) and head.get("kind") == "header" and "settings" in head


def is_dump(path: Path) -> bool:
    """True if a recording is the dump of a divergence.

    Its inputs are also in the recording of the trial, if the trial was recorded.

    Args:
        path: File of a recording; see `is_recording`.
    """
    return "dump" in json.loads(first_line(path))


def read_header(line: bytes, path: Path) -> dict[str, Any]:
    """Reads the header in a recording's first line.

    Raises:
        RecordingError: The header is damaged, or has another format.
    """
    try:
        header = json.loads(line)
    except (ValueError, RecursionError):
        raise RecordingError("the first line is damaged", where=str(path)) from None
    if header.get("schema") != SCHEMA:
        raise RecordingError(
            "this recording has the format of another version",
            where=str(path),
            got=f"schema {header.get('schema')}",
            expected=f"schema {SCHEMA}",
            remedy="Use the version of the sandbox that made it, or record again",
        )
    states = header.get("states", 1)
    if not isinstance(states, int) or isinstance(states, bool):
        raise RecordingError(
            "the header is damaged",
            where=f"{path}, states",
            got=repr(states)[:80],
            expected="a whole number",
        )
    return dict(header)


_DAMAGED = (
    ValueError,
    KeyError,
    TypeError,
    OverflowError,
    RecursionError,
    InputError,
    zlib.error,
)
"""Exceptions that a damaged line may raise."""


def load_recording(path: Path | str) -> Recording:
    """Reads a recording, compressed or not; a damaged recording is read up to the damage.

    Raises:
        RecordingError: The file cannot be read, is not a recording, or is of another version.
    """
    path = Path(path)
    try:
        data, whole = read_stored(path)
    except OSError as error:
        raise RecordingError("cannot be read", where=str(path), got=error.strerror) from None
    if not is_recording(path):
        raise RecordingError("this is not a recording", where=str(path))
    lines = data.split(b"\n")
    recording = Recording(path, read_header(lines[0], path))
    end: Line | None = None
    damage = ""
    for number, text in enumerate(lines[1:], start=2):
        if not text:
            continue
        try:
            line = json.loads(text)
            if line["kind"] == "end":
                line["step"] = int(line["step"])
                _ = line["result"]["status"], line["result"]["success"]
                recording.hashes[line["step"]] = str(line["hash"])
                end = line
            else:
                _take(line, recording)
        except _DAMAGED as error:
            damage = f"line {number} is damaged ({error}); everything before it is used"
            break
    if not whole and (damage or end is not None):
        damage = f"the compressed data are damaged; {damage or 'some values may be wrong'}"
    elif not damage and end is None:
        damage = "it breaks off before its end"
    return replace(recording, end=end, damage=damage)


def _take(line: Line, recording: Recording) -> None:
    """Adds a line to a recording. Lines of unknown kinds, from a later version, are skipped."""
    kind = line["kind"]
    if kind == "input":
        frame = frame_from_json(line)
        step, state_hash = int(line["step"]), str(line["hash"])
        recording.inputs.setdefault(int(line["hand"]), []).append(
            RecordedInput(step, frame, state_hash)
        )
        recording.hashes[step] = state_hash
    elif kind == "keyframe":
        state = base64.b64decode(line["state"], validate=True)
        step, state_hash = int(line["step"]), str(line["hash"])
        recording.keyframes[step] = np.frombuffer(state, "<f8")
        recording.hashes[step] = state_hash
    elif kind == "event":
        known = ("kind", "step", "event")
        details = {name: value for name, value in line.items() if name not in known}
        recording.events.append(RecordedEvent(int(line["step"]), str(line["event"]), details))
    elif kind == "track":
        read_track_line(line, recording.track)
