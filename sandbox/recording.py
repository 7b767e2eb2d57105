"""Recordings: what came in and when it took effect, so that a run can be played again to the bit.

JSON lines: a header, then `input` lines (a touch frame, the physics step at which it took effect,
the state's hash just before), `keyframe` lines (MuJoCo's integration state), and an `end` line with
the result. A program that dies loses at most the line it was writing.
"""

from __future__ import annotations

import base64
import json
import queue
import threading
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from models.errors import InputError, RecordingError
from models.frames import Contact, TouchFrame

SCHEMA = 1
"""Version of the file's layout."""

_STOP = None


class RecordingWriter:
    """Writes a recording from its own thread, one write per line; the session never waits for it.

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
        self._path = path
        self._start()
        self._put({"kind": "header", "schema": SCHEMA, **header})

    def _start(self) -> None:
        self._queue: queue.SimpleQueue[dict[str, Any] | None] = queue.SimpleQueue()
        self._error: OSError | None = None
        self._thread = threading.Thread(target=self._write, name="recording", daemon=True)
        self._thread.start()

    def input(self, step: int, hand: int, frame: TouchFrame, state_hash: str) -> None:
        """A frame that takes effect at a physics step, and the state's hash before it."""
        self._put({"kind": "input", "step": step, "hand": hand, **_to_json(frame),
                   "hash": state_hash})  # fmt: skip

    def keyframe(self, step: int, state: NDArray[np.float64], state_hash: str) -> None:
        """The integration state at a physics step."""
        text = base64.b64encode(np.ascontiguousarray(state, "<f8").tobytes()).decode()
        self._put({"kind": "keyframe", "step": step, "state": text, "hash": state_hash})

    def end(self, step: int, result: dict[str, Any]) -> None:
        """The trial's end and result."""
        self._put({"kind": "end", "step": step, "hash": result["state_hash"], "result": result})

    def close(self) -> None:
        """Waits until everything is on disk.

        Raises:
            RecordingError: Something could not be written; what came before it is safe.
        """
        if self._thread.is_alive():
            self._queue.put(_STOP)
            self._thread.join()
            self._file.close()
        if self._error is not None:
            raise RecordingError(
                "the recording is incomplete",
                where=str(self._path),
                got=self._error.strerror,
                remedy="Make room on the disk; the lines before this are sound",
            )

    def _put(self, line: dict[str, Any]) -> None:
        self._queue.put(line)

    def _write(self) -> None:
        while (line := self._queue.get()) is not _STOP:
            if self._error is not None:
                continue
            data = json.dumps(line, separators=(",", ":")).encode() + b"\n"
            try:
                while data:
                    data = data[self._file.write(data) :]
            except OSError as error:
                self._error = error


@dataclass(frozen=True)
class RecordedInput:
    """A frame, the physics step at which it took effect, and the state's hash before it."""

    step: int
    frame: TouchFrame
    state_hash: str


@dataclass(frozen=True)
class Recording:
    """A recording read back.

    Attributes:
        path: Where it came from.
        header: As it was written.
        inputs: By hand, in order.
        keyframes: Integration state by physics step.
        end: The `end` line, or None where the recording breaks off.
        damage: What is wrong with the file's tail, in words; empty when nothing is.
    """

    path: Path
    header: dict[str, Any]
    inputs: dict[int, list[RecordedInput]] = field(default_factory=dict)
    keyframes: dict[int, NDArray[np.float64]] = field(default_factory=dict)
    end: dict[str, Any] | None = None
    damage: str = ""


def is_recording(path: Path) -> bool:
    """Whether a file begins like a recording of ours."""
    try:
        with path.open("rb") as file:
            head = json.loads(file.readline(1_000_000))
    except (OSError, ValueError):
        return False
    return isinstance(head, dict) and head.get("kind") == "header" and "settings" in head


def load_recording(path: Path) -> Recording:
    """Reads a recording; a damaged one is read up to the damage, which is named.

    Raises:
        RecordingError: There is no such file, it is no recording, or of another version.
    """
    try:
        lines = path.read_bytes().split(b"\n")
    except OSError as error:
        raise RecordingError("cannot be read", where=str(path), got=error.strerror) from None
    if not is_recording(path):
        raise RecordingError("this is not a recording", where=str(path))
    header = json.loads(lines[0])
    if header.get("schema") != SCHEMA:
        raise RecordingError(
            "another version's recording",
            where=str(path),
            got=header.get("schema"),
            expected=f"schema {SCHEMA}",
        )
    inputs: dict[int, list[RecordedInput]] = {}
    keyframes: dict[int, NDArray[np.float64]] = {}
    end: dict[str, Any] | None = None
    damage = ""
    for number, text in enumerate(lines[1:], start=2):
        if not text:
            continue
        try:
            line = json.loads(text)
            kind = line["kind"]
            if kind == "input":
                frame = _from_json(line)
                inputs.setdefault(int(line["hand"]), []).append(
                    RecordedInput(int(line["step"]), frame, str(line["hash"]))
                )
            elif kind == "keyframe":
                state = base64.b64decode(line["state"], validate=True)
                keyframes[int(line["step"])] = np.frombuffer(state, "<f8")
            elif kind == "end":
                line["step"] = int(line["step"])
                end = line
        except (ValueError, KeyError, TypeError, InputError) as error:
            damage = f"line {number} is damaged ({error}); everything before it is used"
            break
    if not damage and end is None:
        damage = "it breaks off before its end"
    return Recording(path, header, inputs, keyframes, end, damage)


def _to_json(frame: TouchFrame) -> dict[str, Any]:
    contacts = [[c.id, c.x, c.y, c.size, c.label] for c in frame.contacts]
    line: dict[str, Any] = {"time": frame.time, "contacts": contacts}
    if frame.lift is not None:
        line["lift"] = frame.lift
    if frame.cancelled:
        line["cancelled"] = sorted(frame.cancelled)
    return line


def _from_json(line: dict[str, Any]) -> TouchFrame:
    contacts = tuple(
        Contact(int(i), x, y, size, label) for i, x, y, size, label in line["contacts"]
    )
    return TouchFrame(
        float(line["time"]), contacts, line.get("lift"), frozenset(line.get("cancelled", ()))
    )
