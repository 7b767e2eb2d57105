"""Files that appear whole or not at all, and what all writers of motion have in common."""

from __future__ import annotations

import os
from abc import ABC, abstractmethod
from contextlib import suppress
from pathlib import Path
from types import TracebackType
from typing import BinaryIO, Self

import numpy as np
from numpy.typing import NDArray

from models.errors import MotionError
from models.motion.armature import Keys

Array = NDArray[np.float64]

NUMBER = "%.6f"
"""Of text formats in cm and degrees: what is rounded off is less than 1e-7 m at a fingertip."""


class Output:
    """A file that is written under another name, and gets its own when it is whole.

    Args:
        path: Its name; a file that is there is replaced at the end, and not before.

    Raises:
        MotionError: It cannot be written there.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self._part = path.with_name(path.name + ".part")
        try:
            self.file: BinaryIO = self._part.open("w+b")
        except OSError as error:
            raise refused(path, error) from error

    def write(self, data: bytes) -> None:
        """Appends bytes.

        Raises:
            MotionError: There is no room.
        """
        try:
            self.file.write(data)
        except OSError as error:
            raise refused(self.path, error) from error

    def put(self, at: int, data: bytes) -> None:
        """Overwrites bytes from a place on.

        Raises:
            MotionError: There is no room for what was appended before.
        """
        try:
            end = self.file.tell()
            self.file.seek(at)
            self.file.write(data)
            self.file.seek(end)
        except OSError as error:
            raise refused(self.path, error) from error

    def complete(self) -> None:
        """Writes what still waits to be written.

        Raises:
            MotionError: There is no room.
        """
        try:
            self.file.close()
        except OSError as error:
            raise refused(self.path, error) from error

    def commit(self) -> None:
        """Gives the complete file its name."""
        try:
            os.replace(self._part, self.path)
        except OSError as error:
            raise refused(self.path, error) from error

    def abort(self) -> None:
        """Leaves nothing behind."""
        # What waits to be written may have no room, and is not wanted.
        with suppress(OSError):
            self.file.close()
        self._part.unlink(missing_ok=True)


class MotionWriter(ABC):
    """Writes keys as they come. Used as a context; its files appear when it ends without an error.

    Attributes:
        frames: Written so far.
    """

    def __init__(self, *paths: Path) -> None:
        self._outputs: list[Output] = []
        self.frames = 0
        try:
            for path in paths:
                self._outputs.append(Output(path))
        except MotionError:
            self.abort()
            raise

    @property
    def paths(self) -> list[Path]:
        """What is written."""
        return [output.path for output in self._outputs]

    @abstractmethod
    def write(self, *hands: Keys) -> None:
        """Appends the same moments of every hand."""

    def finish(self) -> None:  # noqa: B027 - it need not be written
        """Completes what could not be known before the end; most formats know all of it."""

    def abort(self) -> None:
        """Leaves nothing behind."""
        for output in self._outputs:
            output.abort()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        if kind is not None:
            self.abort()
            return
        try:
            if not self.frames:
                raise MotionError("there is no motion to write", where=str(self.paths[0]))
            self.finish()
            # None of several files appears before all of them are whole.
            for output in self._outputs:
                output.complete()
            for output in self._outputs:
                output.commit()
        except BaseException:
            self.abort()
            raise


def refused(path: Path, error: OSError) -> MotionError:
    """That a file cannot be written."""
    return MotionError("the motion cannot be written here", where=str(path), got=error.strerror)


def checked_rate(rate: float) -> float:
    """A rate in Hz.

    Raises:
        MotionError: It is none.
    """
    if not 0 < rate <= 10_000:
        raise MotionError("this is no frame rate", got=rate, expected="0 to 10000 Hz")
    return rate


def rows(values: Array, line: str, decimals: int = 6) -> bytes:
    """Rows (n, k) as text, each by the same pattern of k numbers.

    All rows at once, which takes a third of the time of one after the other.
    """
    # Zero has no sign in a text.
    rounded = np.round(values, decimals) + 0.0
    return (line * len(rounded) % tuple(rounded.ravel().tolist())).encode("ascii")
