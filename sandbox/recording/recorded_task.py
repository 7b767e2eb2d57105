"""Finds the task of a recording again, which may be somebody else's."""

from __future__ import annotations

from typing import Any

from models.errors import InputError, RecordingError
from models.outside import how_to_get, place_of
from tasks.registry import find_task


def recorded_task(header: dict[str, Any], where: str) -> str:
    """What to call a recording's task here: by its name, or by the place that its header tells.

    Args:
        header: Of the recording.
        where: The recording, for messages.

    Raises:
        RecordingError: It is not here; says what to install.
    """
    name = str(header["settings"]["task"])
    source = header.get("task_from")
    if not isinstance(source, dict):
        # Ours; another version's is refused with the settings.
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
        "its task is not on this machine as it was",
        where=where,
        got=reasons[-1],
        expected=f"{name} from {place_of(source)}",
        remedy=how_to_get(source),
    )
