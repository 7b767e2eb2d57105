"""Finds the task of a recording again, which may be somebody else's."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from models.errors import InputError, RecordingError
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
    for candidate in (name, _place(source)):
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
        expected=f"{name} from {_place(source)}",
        remedy=_remedy(source),
    )


def _place(source: dict[str, Any]) -> str:
    """`FILE.py:Class` or `module:Class`."""
    if source.get("file"):
        return f"{source['file']}:{source.get('member', '')}"
    return str(source.get("entry_point", ""))


def _remedy(source: dict[str, Any]) -> str:
    if source.get("package"):
        return f"Install it: pip install '{source['package']}=={source.get('version')}'"
    if source.get("file"):
        return f"Put {Path(str(source['file'])).name} back where it was"
    module = str(source.get("entry_point", "")).partition(":")[0]
    return f"Put the module {module} on the path: PYTHONPATH=its folder"
