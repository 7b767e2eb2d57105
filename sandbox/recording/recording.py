"""Recordings: what came in and when it took effect, so that a run can be played again to the bit.

JSON lines: a header, then `input` lines (a frame of touches or of 3-D hands, the physics step at
which it took effect, the state's hash just before), `event` lines (what else came in, such as
another contact mode), `keyframe` lines (MuJoCo's integration state, once a second), `track` lines
(a second's poses, for eyes), and an `end` line with the result. A program that dies loses at most
the lines of the last 10 ms and a second of the track.
"""

from __future__ import annotations

import base64
import json
import threading
import zlib
from abc import ABC, abstractmethod
from collections import deque
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from models.errors import InputError, RecordingError
from models.frames import Frame, TouchFrame
from models.scene import CONTROL_PERIOD
from sandbox.recording.recorded_frames import frame_from_json, frame_to_json
from sandbox.recording.recording_file import first_line, read_stored
from sandbox.recording.upgrade import upgraded
from sandbox.session.pose_track import PoseTrack, PoseTrackWriter, read_track_line

SCHEMA = 1
"""Version of the file's layout."""

KEYFRAME_PERIOD = 1.0
"""s between two stored states."""
STATES_PER_KEYFRAME = round(KEYFRAME_PERIOD / CONTROL_PERIOD)

LOOK = 0.01
"""s between two looks of the writing thread at what there is to write."""

Line = dict[str, Any]


class DeferredLine:
    """A line that is made by whoever needs it first: not by the session's loop, which only keeps
    what it is made of.

    Args:
        make: Makes it.
        values: Of these, which do not change any more.
    """

    __slots__ = ("_line", "_parts")

    def __init__(self, make: Callable[..., Line], *values: Any) -> None:
        # One thing, which another thread takes away whole or not at all.
        self._parts: tuple[Callable[..., Line], tuple[Any, ...]] | None = (make, values)
        self._line: Line | None = None

    def line(self) -> Line:
        """The line; from any thread."""
        parts = self._parts
        if self._line is None and parts is not None:
            make, values = parts
            self._line = make(*values)
        # What it was made of may be large, and is not needed any more.
        self._parts = None
        assert self._line is not None
        return self._line


class RecordingLines(ABC):
    """Makes the lines of a recording from what a session tells; who inherits keeps them."""

    def __init__(self) -> None:
        self._track = PoseTrackWriter()
        self._states = 0

    def input(self, step: int, hand: int, frame: Frame, state_hash: str) -> None:
        """A frame that takes effect at a physics step, and the state's hash before it."""
        self._put(DeferredLine(input_line, step, hand, frame, state_hash))

    def event(self, step: int, what: str, **details: Any) -> None:
        """Something else that takes effect, or has happened, at a physics step."""
        self._put({"kind": "event", "step": step, "event": what, **details})

    def state(
        self,
        step: int,
        state: NDArray[np.float64],
        state_hash: str,
        qpos: NDArray[np.float64],
        solid: Sequence[frozenset[int]],
    ) -> None:
        """The simulation at the beginning of a control period."""
        if self._states % STATES_PER_KEYFRAME == 0:
            self._put_track()
            self.keyframe(step, state, state_hash)
        self._states += 1
        self._track.add(step, qpos, solid)

    def keyframe(self, step: int, state: NDArray[np.float64], state_hash: str) -> None:
        """The integration state at a physics step."""
        self._put(DeferredLine(keyframe_line, step, state.copy(), state_hash))

    def end(self, step: int, result: dict[str, Any]) -> None:
        """The trial's end and result."""
        self._put_track()
        self._put(end_line(step, result))

    def _put_track(self) -> None:
        make = self._track.take()
        if make:
            self._put(DeferredLine(make))

    @abstractmethod
    def _put(self, line: Line | DeferredLine) -> None:
        """Keeps a line."""


def input_line(step: int, hand: int, frame: Frame, state_hash: str) -> Line:
    """The line of a frame that takes effect at a physics step."""
    return {"kind": "input", "step": step, "hand": hand, **frame_to_json(frame), "hash": state_hash}


def keyframe_line(step: int, state: NDArray[np.float64], state_hash: str) -> Line:
    """The line of an integration state."""
    text = base64.b64encode(np.ascontiguousarray(state, "<f8").tobytes()).decode()
    return {"kind": "keyframe", "step": step, "state": text, "hash": state_hash}


def end_line(step: int, result: dict[str, Any]) -> Line:
    """The line of a trial's end."""
    return {"kind": "end", "step": step, "hash": result["state_hash"], "result": result}


class RecordingWriter(RecordingLines):
    """Writes a recording from its own thread, one write per line, every 10 ms; the session never
    waits for it.

    Args:
        path: Of the new file; an existing one is never overwritten.
        header: Settings, versions and the like; JSON values.

    Raises:
        RecordingError: The file exists or cannot be made.
    """

    def __init__(self, path: Path, header: dict[str, Any]) -> None:
        try:
            # Unbuffered: a line that was written is safe from the program's own end.
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
        """A line that was made elsewhere."""
        self._waiting.append(line)

    def _start(self) -> None:
        # A deque takes a line without waking anybody, which costs more than all else here.
        self._waiting: deque[Line | DeferredLine] = deque()
        self._ending = threading.Event()
        self._error: Exception | None = None
        self._thread = threading.Thread(target=self._write, name="recording", daemon=True)
        self._thread.start()

    def close(self) -> None:
        """Waits until everything is on disk.

        Raises:
            RecordingError: Something could not be written; what came before it is safe.
        """
        if self._thread.is_alive():
            self._ending.set()
            self._thread.join()
            self._file.close()
        if isinstance(self._error, OSError):
            raise RecordingError(
                "the recording is incomplete",
                where=str(self.path),
                got=self._error.strerror,
                remedy="Make room on the disk; the lines before this are sound",
            )
        if self._error is not None:
            raise RecordingError(
                "the recording is incomplete",
                where=str(self.path),
                got=str(self._error),
                expected="events and results that JSON knows, such as float(x) of NumPy's numbers",
            )

    def _put(self, line: Line | DeferredLine) -> None:
        self._waiting.append(line)

    def _write(self) -> None:
        ending = False
        while not ending:
            # What comes after this look is written by the next one.
            ending = self._ending.wait(LOOK)
            while self._waiting:
                self._write_line(self._waiting.popleft())

    def _write_line(self, line: Line | DeferredLine) -> None:
        if self._error is not None:
            return
        try:
            told = line.line() if isinstance(line, DeferredLine) else line
            data = json.dumps(told, separators=(",", ":")).encode() + b"\n"
            while data:
                data = data[self._file.write(data) :]
        except (OSError, TypeError, ValueError) as error:
            # Of a device without room, or of a value that is none of JSON's.
            self._error = error


@dataclass(frozen=True)
class RecordedInput:
    """A frame, the physics step at which it took effect, and the state's hash before it."""

    step: int
    frame: Frame
    state_hash: str


@dataclass(frozen=True)
class RecordedEvent:
    """Something that happened at a physics step: its name, and what else is known."""

    step: int
    what: str
    details: dict[str, Any]


@dataclass(frozen=True)
class Recording:
    """A recording read back.

    Attributes:
        path: Where it came from.
        header: As this version writes it (see `sandbox.recording.upgrade`).
        inputs: By hand, in order.
        keyframes: Integration state by physics step.
        events: In order.
        hashes: The state's hash by physics step, wherever one is told.
        track: The poses, for eyes; empty in older recordings.
        end: The `end` line, or None where the recording breaks off.
        damage: What is wrong with the file's tail, in words; empty when nothing is.
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
        """The touch frames of a hand.

        Raises:
            RecordingError: It was moved in the air.
        """
        frames = [entry.frame for entry in self.inputs.get(hand, [])]
        found = [frame for frame in frames if isinstance(frame, TouchFrame)]
        if len(found) < len(frames):
            raise RecordingError(
                "this recording is of a hand in the air, and has no touches",
                where=str(self.path),
                remedy="`sandbox run` and `sandbox replay` play it",
            )
        return found


def is_recording(path: Path) -> bool:
    """Whether a file begins like a recording of ours."""
    try:
        head = json.loads(first_line(path))
    except (OSError, ValueError, RecursionError):
        return False
    return isinstance(head, dict) and head.get("kind") == "header" and "settings" in head


def read_header(line: bytes, path: Path) -> dict[str, Any]:
    """The header in a recording's first line, upgraded where an earlier version wrote it.

    Raises:
        RecordingError: It is damaged, or of a version whose layout is another one.
    """
    try:
        header = json.loads(line)
    except ValueError:
        raise RecordingError("its first line is damaged", where=str(path)) from None
    if header.get("schema") != SCHEMA:
        raise RecordingError(
            "another version's recording",
            where=str(path),
            got=header.get("schema"),
            expected=f"schema {SCHEMA}",
        )
    return upgraded(header)


def load_recording(path: Path | str) -> Recording:
    """Reads a recording, compressed or not; a damaged one up to the damage, which is named.

    Raises:
        RecordingError: There is no such file, it is no recording, or of another version.
    """
    path = Path(path)
    try:
        data, whole = read_stored(path)
    except OSError as error:
        raise RecordingError("cannot be read", where=str(path), got=error.strerror) from None
    if not is_recording(path):
        raise RecordingError("this is not a recording", where=str(path))
    lines = data.split(b"\n")
    found = Recording(path, read_header(lines[0], path))
    end: Line | None = None
    damage = ""
    for number, text in enumerate(lines[1:], start=2):
        if not text:
            continue
        try:
            line = json.loads(text)
            if line["kind"] == "end":
                line["step"] = int(line["step"])
                found.hashes[line["step"]] = str(line["hash"])
                end = line
            else:
                _take(line, found)
        except (ValueError, KeyError, TypeError, InputError, zlib.error) as error:
            damage = f"line {number} is damaged ({error}); everything before it is used"
            break
    if not whole and (damage or end is not None):
        damage = f"its compression is damaged; {damage or 'some of it may be wrong'}"
    elif not damage and end is None:
        damage = "it breaks off before its end"
    return replace(found, end=end, damage=damage)


def _take(line: Line, found: Recording) -> None:
    """Adds a line to a recording; kinds that a later version added are passed over."""
    kind = line["kind"]
    if kind == "input":
        frame = frame_from_json(line)
        step, state_hash = int(line["step"]), str(line["hash"])
        found.inputs.setdefault(int(line["hand"]), []).append(
            RecordedInput(step, frame, state_hash)
        )
        found.hashes[step] = state_hash
    elif kind == "keyframe":
        state = base64.b64decode(line["state"], validate=True)
        step, state_hash = int(line["step"]), str(line["hash"])
        found.keyframes[step] = np.frombuffer(state, "<f8")
        found.hashes[step] = state_hash
    elif kind == "event":
        known = ("kind", "step", "event")
        details = {name: value for name, value in line.items() if name not in known}
        found.events.append(RecordedEvent(int(line["step"]), str(line["event"]), details))
    elif kind == "track":
        read_track_line(line, found.track)
