"""Finds the task that a recording was made with, built in or from elsewhere."""

from __future__ import annotations

from typing import Any

from models.errors import InputError, RecordingError
from models.plugins import how_to_get, place_of
from models.surface import Surface
from sandbox.recording.task_files import task_files
from tasks.registry import find_task, origin

_MOST_NAMED = 4
"""Number of files that a message names at most."""


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


def task_origin(name: str, seed: int, surface: Surface) -> dict[str, Any]:
    """Origin of an external task, and digests of its files, for a header; empty for built-in tasks.

    Args:
        name: Name of the task, or its place.
        seed: Seed of the trial.
        surface: The touch rectangle, which need not be placed.
    """
    source = origin(name)
    return {**source, "files": task_files(name, seed, surface)} if source else {}


def task_change(header: dict[str, Any], name: str, seed: int, surface: Surface) -> str:
    """What has changed in a recording's own task since it was recorded, and what to do, in a line.

    Args:
        header: Header of the recording.
        name: Name under which the task was found; see `recorded_task`.
        seed: Seed of the trial.
        surface: The touch rectangle, which need not be placed.

    Returns:
        The line; empty where nothing has changed, for a built-in task, and where the header has no
        digests.
    """
    source = header.get("task_from")
    there = source.get("files") if isinstance(source, dict) else None
    if not isinstance(source, dict) or not isinstance(there, dict):
        return ""
    here = task_files(name, seed, surface)
    changed = sorted(file for file in here.keys() & there.keys() if here[file] != there[file])
    # A task whose code has changed may read other descriptions, or fail before it reads any.
    changed = changed or sorted(here.keys() ^ there.keys())
    if not changed:
        return ""
    files = ", ".join(changed[:_MOST_NAMED])
    files += f" and {len(changed) - _MOST_NAMED} more" if len(changed) > _MOST_NAMED else ""
    remedy = f"Put the old {files} back"
    if source.get("version") != origin(name).get("version"):
        remedy = how_to_get(source)
    return (
        f"the task {find_task(name).name} has changed since it was recorded, in {files}. {remedy}"
    )
