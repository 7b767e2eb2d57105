"""Recordings: inputs with the steps at which they took effect, for a replay equal to the bit.

JSON lines: a header, then `input` lines (a touch frame or hand frame, the physics step at which it
took effect, the state's hash just before), `event` lines (other inputs and events, such as a change
of contact mode), `keyframe` lines (MuJoCo's integration state, once a second), `track` lines (the
poses of a second, for viewing), and an `end` line with the result. If the program crashes, at most
the lines of the last 10 ms and a second of the track are lost.
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
from sandbox.session.pose_track import PoseTrack, PoseTrackWriter, read_track_line

SCHEMA = 2
"""Version of the file's layout."""

KEYFRAME_PERIOD = 1.0
"""s between two stored states."""
STATES_PER_KEYFRAME = round(KEYFRAME_PERIOD / CONTROL_PERIOD)

LOOK = 0.01
"""s between two checks of the writing thread for new lines."""

Line = dict[str, Any]


class DeferredLine:
    """A line that is made when it is first needed, to keep that work out of the session's loop.

    Args:
        make: Function that makes the line.
        values: Its arguments; they must not change afterwards.
    """

    __slots__ = ("_line", "_parts")

    def __init__(self, make: Callable[..., Line], *values: Any) -> None:
        # A single attribute, so that another thread reads both values or neither.
        self._parts: tuple[Callable[..., Line], tuple[Any, ...]] | None = (make, values)
        self._line: Line | None = None

    def line(self) -> Line:
        """Makes the line or returns it; may be called from any thread."""
        parts = self._parts
        if self._line is None and parts is not None:
            make, values = parts
            self._line = make(*values)
        # The arguments may be large, and are no longer needed.
        self._parts = None
        assert self._line is not None
        return self._line


class RecordingLines(ABC):
    """A session recorder that makes the lines of a recording; subclasses store them."""

    def __init__(self) -> None:
        self._track = PoseTrackWriter()
        self._states = 0

    def input(self, step: int, hand: int, frame: Frame, state_hash: str) -> None:
        """Records a frame that takes effect at a physics step, and the state's hash before it."""
        self._put(DeferredLine(input_line, step, hand, frame, state_hash))

    def event(self, step: int, what: str, **details: Any) -> None:
        """Records another event at a physics step, such as a change of the contact mode."""
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
        """Keeps a line."""


def input_line(step: int, hand: int, frame: Frame, state_hash: str) -> Line:
    """The line of a frame that takes effect at a physics step."""
    return {"kind": "input", "step": step, "hand": hand, **frame_to_json(frame), "hash": state_hash}


def keyframe_line(step: int, state: NDArray[np.float64], state_hash: str) -> Line:
    """Line of an integration state."""
    text = base64.b64encode(np.ascontiguousarray(state, "<f8").tobytes()).decode()
    return {"kind": "keyframe", "step": step, "state": text, "hash": state_hash}


def end_line(step: int, result: dict[str, Any]) -> Line:
    """Line of a trial's end."""
    return {"kind": "end", "step": step, "hash": result["state_hash"], "result": result}


class RecordingWriter(RecordingLines):
    """Writes a recording from its own thread, one write per line, every 10 ms; the session never
    waits for it.

    Args:
        path: The new file; an existing file is never overwritten.
        header: Settings, versions and the like; JSON values.

    Raises:
        RecordingError: The file exists or cannot be made.
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
        """Appends a line that was made elsewhere."""
        self._waiting.append(line)

    def _start(self) -> None:
        # Appending to a deque wakes no thread, which would take longer than all else here.
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
        """Does nothing while all lines so far could be written; never waits.

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
                expected="events and results that JSON knows, such as float(x) of NumPy's numbers",
            )

    def _put(self, line: Line | DeferredLine) -> None:
        self._waiting.append(line)

    def _write(self) -> None:
        ending = False
        while not ending:
            # Lines that arrive after this check are written by the next one.
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
        except Exception as error:  # the thread must live to say that a line is missing
            # The disk is full, or a value cannot be written as JSON.
            self._error = error


@dataclass(frozen=True)
class RecordedInput:
    """A frame, the physics step at which it took effect, and the state's hash before it."""

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
    """A recording read back.

    Attributes:
        path: File of the recording.
        header: Header, of this version (see `read_header`).
        inputs: Inputs by hand, in order.
        keyframes: Integration states by physics step.
        events: Events in order.
        hashes: Hashes of the state by physics step, as far as the file has them.
        track: Poses, for viewing; empty where it breaks off before the first.
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
        """The touch frames of a hand.

        Raises:
            RecordingError: The hand was driven by hand frames.
        """
        frames = [entry.frame for entry in self.inputs.get(hand, [])]
        touches = [frame for frame in frames if isinstance(frame, TouchFrame)]
        if len(touches) < len(frames):
            raise RecordingError(
                "this recording is of a hand in the air, and has no touches",
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
    """True if a recording is the dump of a divergence, which repeats the one that it lies beside.

    Args:
        path: File of a recording; see `is_recording`.
    """
    return "dump" in json.loads(first_line(path))


def read_header(line: bytes, path: Path) -> dict[str, Any]:
    """Reads the header in a recording's first line.

    Raises:
        RecordingError: The header is damaged, or of a version with another layout.
    """
    try:
        header = json.loads(line)
    except (ValueError, RecursionError):
        raise RecordingError("its first line is damaged", where=str(path)) from None
    if header.get("schema") != SCHEMA:
        raise RecordingError(
            "this recording is of another version",
            where=str(path),
            got=f"schema {header.get('schema')}",
            expected=f"schema {SCHEMA}",
            remedy="Use the version of the sandbox that made it, or record again",
        )
    states = header.get("states", 1)
    if not isinstance(states, int) or isinstance(states, bool):
        raise RecordingError(
            "its header is damaged",
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
"""What a damaged line may raise."""


def load_recording(path: Path | str) -> Recording:
    """Reads a recording, compressed or not; a damaged one is read up to the damage.

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
        damage = f"its compression is damaged; {damage or 'some of it may be wrong'}"
    elif not damage and end is None:
        damage = "it breaks off before its end"
    return replace(recording, end=end, damage=damage)


def _take(line: Line, recording: Recording) -> None:
    """Adds a line to a recording; unknown kinds, of a later version, are skipped."""
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
