"""Base classes of motion writers. Their files appear complete or not at all."""

from __future__ import annotations

import os
from abc import ABC, abstractmethod
from contextlib import suppress
from pathlib import Path
from secrets import token_hex
from types import TracebackType
from typing import BinaryIO, Self

import numpy as np

from models.arithmetic import Array
from models.errors import MotionError
from models.motion.armature import Keys

NUMBER = "%.6f"
"""Format of numbers in text formats with cm and degrees. The rounding error is below 1e-7 m at a
fingertip."""


class AtomicFile:
    """A file that is written under a temporary name and renamed when it is complete.

    Args:
        path: The final name of the file; an existing file is replaced only at the end.

    Raises:
        MotionError: The file cannot be written there.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        try:
            # If the path is a link, its target is replaced, and not the link. Programs that write
            # the same file use different temporary names.
            self._target = path.resolve()
            self._part = self._target.with_name(f"{path.name}.{token_hex(4)}.part")
            self.file: BinaryIO = self._part.open("x+b")
        except (OSError, RuntimeError) as error:
            raise refused(path, error) from error

    def write(self, data: bytes) -> None:
        """Appends bytes.

        Raises:
            MotionError: The disk is full.
        """
        try:
            self.file.write(data)
        except OSError as error:
            raise refused(self.path, error) from error

    def put(self, at: int, data: bytes) -> None:
        """Overwrites bytes from an offset on.

        Raises:
            MotionError: The disk is full.
        """
        try:
            end = self.file.tell()
            self.file.seek(at)
            self.file.write(data)
            self.file.seek(end)
        except OSError as error:
            raise refused(self.path, error) from error

    def complete(self) -> None:
        """Writes all buffered bytes, and closes the file.

        Raises:
            MotionError: The disk is full.
        """
        try:
            self.file.close()
        except OSError as error:
            raise refused(self.path, error) from error

    def commit(self) -> None:
        """Gives the complete file its name."""
        try:
            os.replace(self._part, self._target)
        except OSError as error:
            raise refused(self.path, error) from error

    def abort(self) -> None:
        """Removes the unfinished file."""
        # Flushing may fail on a full disk; the bytes are not needed any more.
        with suppress(OSError):
            self.file.close()
        self._part.unlink(missing_ok=True)


class MotionWriter(ABC):
    """Base class of writers to which keys are given batch by batch.

    A writer is a context manager. Its files appear when the block ends without an error.

    Attributes:
        frames: Number of frames written so far.
    """

    def __init__(self, *paths: Path) -> None:
        self._outputs: list[AtomicFile] = []
        self.frames = 0
        try:
            for path in paths:
                self._outputs.append(AtomicFile(path))
        except MotionError:
            self.abort()
            raise

    @property
    def paths(self) -> list[Path]:
        """Paths of the written files."""
        return [output.path for output in self._outputs]

    @abstractmethod
    def write(self, *hands: Keys) -> None:
        """Appends keys of every hand, all at the same moments."""

    def finish(self) -> None:  # noqa: B027 - need not be overridden
        """Fills in values that are known only at the end; most formats need none."""

    def abort(self) -> None:
        """Removes the unfinished files."""
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
                raise MotionError("no motion to write", where=str(self.paths[0]))
            self.finish()
            # All files are completed before the first of them appears.
            for output in self._outputs:
                output.complete()
            for output in self._outputs:
                output.commit()
        except BaseException:
            self.abort()
            raise


def refused(path: Path, error: OSError | RuntimeError) -> MotionError:
    """The error for a file that cannot be written. Python reports a loop of links as
    `RuntimeError`."""
    got = error.strerror if isinstance(error, OSError) else str(error)
    return MotionError("the motion cannot be written here", where=str(path), got=got)


def checked_rate(rate: float) -> float:
    """A rate in Hz.

    Raises:
        MotionError: The value is not a rate.
    """
    if not 0 < rate <= 10_000:
        raise MotionError("not a frame rate", got=rate, expected="0 to 10000 Hz")
    return rate


def rows(values: Array, line: str, decimals: int = 6) -> bytes:
    """Text of rows (n, k), each formatted by the same pattern of k numbers.

    All rows are formatted at once, in a third of the time of separate rows.
    """
    # Zero is written without a sign.
    rounded = np.round(values, decimals) + 0.0
    return (line * len(rounded) % tuple(rounded.ravel().tolist())).encode("ascii")
