"""Finds the task that a recording was made with, built in or from elsewhere."""

from __future__ import annotations

from typing import Any

from models.errors import InputError, RecordingError
from models.outside import how_to_get, place_of
from tasks.registry import find_task


def recorded_task(header: dict[str, Any], where: str) -> str:
    """The name under which a recording's task can be loaded on this machine.

    Args:
        header: Header of the recording.
        where: The recording, for error messages.

    Raises:
        RecordingError: The task is not on this machine, or in another version; the error names
            what to install.
    """
    name = str(header["settings"]["task"])
    source = header.get("task_from")
    if not isinstance(source, dict):
        # A built-in task; one of another version is refused with the settings.
        return name
    reasons = []
    for candidate in (name, place_of(source)):
        if not candidate:
            continue
        try:
            version = find_task(candidate).version
        except InputError as error:
            reasons.append(str(error))
            continue
        if version == source.get("task_version", version):
            return candidate
        reasons.append(f"version {version} of the task, not {source['task_version']}")
    raise RecordingError(
        "its task is not on this machine in the recorded version",
        where=where,
        got=reasons[-1],
        expected=f"{name} from {place_of(source)}",
        remedy=how_to_get(source),
    )
