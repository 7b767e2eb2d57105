"""Frames of a Leap recording, read from the disk as they are needed.

`sandbox.devices.leap.leap_file.read_leap` reads every form of file, but whole: ten minutes are a
gigabyte as objects. The forms that grow long (lists of frames, and a message a line) are read
frame by frame here; all others are left to it.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import msgspec

from models.errors import RecordingError
from models.frames import HandFrame
from models.json_input import any_json
from models.plausible import parse_units, unit_size
from models.reader_report import ReaderReport
from sandbox.devices.leap.leap_file import LeapRecording, read_leap
from sandbox.devices.leap.leap_json import LeapDecoder, find_leap_units
from sandbox.export.json_text import EVERYTHING, LARGEST, JsonText

_DAMAGE = (msgspec.DecodeError, UnicodeDecodeError, RecursionError)


class HandOutline(msgspec.Struct):
    """A hand of a message.

    Attributes:
        type: Its side, as the device names it; None where it does not.
    """

    type: Any = None


class Outline(msgspec.Struct):
    """What a message tells before its frames are used.

    Attributes:
        hands: Its hands; None if it is no frame.
        timestamp: us by the device's clock; None where it has none.
    """

    hands: list[HandOutline] | None = None
    timestamp: float | None = None


_OUTLINES: msgspec.json.Decoder[list[Any]] = msgspec.json.Decoder(list[Outline])


class LeapFrames:
    """The frames of a recording; every iteration reads them anew.

    Args:
        path: The file.
        unit: Units that a person gave, such as `cm,ms`.

    Attributes:
        metadata: Metadata of the file; empty without any.
        damage: Error that ended the latest iteration early; None if there was none.

    Raises:
        RecordingError: The file does not exist, is damaged or of another program.
    """

    def __init__(self, path: Path, unit: str = "") -> None:
        self._path = path
        self._whole: LeapRecording | None = None
        self.metadata: dict[str, Any] = {}
        self._assumed = ReaderReport()
        self._decoder = LeapDecoder()
        self.damage: RecordingError | None = None
        self._lines = _is_lines(path)
        if not (self._lines or self._is_list()):
            self._whole = read_leap(path, unit)
            self.metadata, self.damage = self._whole.metadata, self._whole.damage
            self._units, self._stride = self._whole.units, 0
            return
        found = find_leap_units(self.messages(), parse_units(unit), str(path), self._assumed)
        self._units, self._stride = found

    @property
    def report(self) -> ReaderReport:
        """What the latest iteration left out, and what is assumed."""
        if self._whole is not None:
            return self._whole.report
        report = self._decoder.report
        report.add(self._assumed)
        return report

    @property
    def second(self) -> float:
        """s, unit of the messages' times."""
        return unit_size(self._units, "time")

    def messages(self, outlines: bool = False) -> Iterator[Any]:
        """Yields the decoded JSON messages.

        Args:
            outlines: Yields an `Outline` in place of a message wherever that is quicker.

        Raises:
            RecordingError: The file is damaged.
        """
        if self._whole is not None:
            yield from self._whole.messages
        elif self._lines:
            yield from self._messages_of_lines()
        else:
            yield from self._messages_of_list(_OUTLINES if outlines else EVERYTHING)

    def __iter__(self) -> Iterator[HandFrame]:
        if self._whole is not None:
            yield from self._whole.frames
            return
        self._decoder = LeapDecoder(self._path.name, units=self._units, stride=self._stride)
        for frame in map(self._decoder.feed, self.messages()):
            if frame is not None:
                yield frame

    def _messages_of_lines(self) -> Iterator[Any]:
        self.damage = None
        with self._path.open("rb") as file:
            for number, line in enumerate(file, start=1):
                if not line.strip():
                    continue
                try:
                    yield any_json(line)
                except _DAMAGE as error:
                    self.damage = RecordingError(
                        f"the recording is damaged here: {error}",
                        where=f"{self._path}, line {number}",
                        got=line[:40].decode("latin-1"),
                        remedy="The lines before this one were read",
                    )
                    return

    def _messages_of_list(self, decoder: msgspec.json.Decoder[list[Any]]) -> Iterator[Any]:
        text = JsonText(self._path.open(encoding="utf-8"))
        try:
            before = self._first_frame(text)
            while text.sign() != "]":
                yield from text.values(decoder)
                if text.sign() not in (",", "]"):
                    raise ValueError("a frame is followed by neither another nor the end")
                if text.sign() == ",":
                    text.skip()
            text.skip()
            json.loads(f"{before}{text.rest()}")
        except (ValueError, RecursionError) as error:
            raise RecordingError(
                f"the JSON is damaged or cut short: {error}", where=str(self._path)
            ) from error
        finally:
            text.close()

    def _is_list(self) -> bool:
        try:
            text = JsonText(self._path.open(encoding="utf-8"))
        except OSError:
            return False
        try:
            return self._first_frame(text) is not None
        except (ValueError, RecursionError):
            return False
        finally:
            text.close()

    def _first_frame(self, text: JsonText) -> str | None:
        """Goes to the first frame of a list of plain frames.

        Returns:
            What stands for all before the list's end; None if the file has another form.
        """
        opening = text.sign()
        text.skip()
        if opening == "[":
            return "[]" if text.sign() == "{" else None
        while opening == "{" and text.sign() == '"':
            name = text.value()
            if text.sign() != ":":
                return None
            text.skip()
            if name == "frames" and text.sign() == "[":
                text.skip()
                # A rate in the metadata counts for frames without a time: `read_leap` knows it.
                plain = bool(self.metadata) and "frameRate" not in self.metadata
                return '{"frames":[]' if plain and text.sign() == "{" else None
            value = text.value()
            if name == "metadata" and isinstance(value, dict):
                self.metadata = value
            if text.sign() == ",":
                text.skip()
        return None


def _is_lines(path: Path) -> bool:
    """True if the first line is a complete JSON object and further lines follow."""
    try:
        with path.open("rb") as file:
            first = file.readline(LARGEST)
            while first and not first.strip():
                first = file.readline(LARGEST)
            if not first.lstrip().startswith(b"{") or not file.read(1):
                return False
        any_json(first)
    except (OSError, *_DAMAGE):
        return False
    return True
