"""Compresses recordings of finished trials; a failure or kill loses no data."""

from __future__ import annotations

from pathlib import Path

from models.errors import StudyError
from sandbox.recording.recording import SUFFIX, packed, read_stored
from sandbox.study.record.files import study_error, write_atomically
from sandbox.system.files import sync_folder


def pack(recording: Path) -> Path:
    """Replaces the recording of a finished trial by a compressed file.

    The compressed file is on the disk and has been read back before the other file is deleted. A
    kill in between leaves both, with the same content; another call deletes the first one.

    Args:
        recording: Path of the recording without `.gz`. Nothing is done if only the compressed file
            exists.

    Returns:
        The compressed file.

    Raises:
        StudyError: The compressed file cannot be written; the recording is unchanged.
    """
    target = recording.with_name(recording.name + SUFFIX)
    try:
        if not recording.exists():
            return target
        data = recording.read_bytes()
    except OSError as error:
        raise study_error(error, recording, "the recording cannot be read") from None
    write_atomically(target, packed(data))
    try:
        stored = read_stored(target)
        if stored.data != data or not stored.whole:
            target.unlink()
            raise StudyError(
                "the file that was read back differs from what was written",
                where=str(target),
                remedy="Stop using this disk; the uncompressed recording is still there",
            )
        recording.unlink()
        sync_folder(recording.parent)
    except OSError as error:
        raise study_error(error, recording, "the recording cannot be compressed") from None
    return target
