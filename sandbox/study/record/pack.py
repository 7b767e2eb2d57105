"""Compresses the recordings of finished trials without loss, even on failures."""

from __future__ import annotations

from pathlib import Path

from models.errors import StudyError
from sandbox.recording.recording_file import SUFFIX, packed, read_stored
from sandbox.study.record.files import study_error, sync_folder, write_atomically


def pack(recording: Path) -> Path:
    """Puts a compressed file in the place of a finished trial's recording.

    The compressed file is on the disk, and was read back, before the other one goes. A kill in
    between leaves both, which are the same; packing again removes one.

    Args:
        recording: By its own name, without `.gz`; where only the compressed one is left, there is
            nothing to do.

    Returns:
        The compressed file.

    Raises:
        StudyError: It cannot be written; the recording is as it was.
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
                "what is read is not what was written",
                where=str(target),
                remedy="Do not trust this disk; nothing is lost yet",
            )
        recording.unlink()
        sync_folder(recording.parent)
    except OSError as error:
        raise study_error(error, recording, "the recording cannot be compressed") from None
    return target
