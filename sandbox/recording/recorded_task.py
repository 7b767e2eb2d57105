"""Tasks that are not built in: their origin, digests of their files, and their changes.

An external task is a task that is not built in. It can change while the program's version stays the
same. It consists of its file and the modules that this file imports from the same folder, or of its
whole package. The MJCF files and meshes that it reads also belong to it.

The header of a recording has a digest of each file, so that a replay can name the changed file. The
digests cover the files only. They do not cover the scene that the program makes from MJCF files,
since it differs between versions and machines.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Iterable
from contextlib import suppress
from functools import cache
from hashlib import blake2b
from pathlib import Path
from typing import Any

from models.errors import InputError, RecordingError
from models.objects import MechanismPart
from models.plugins import files_of, how_to_get, loaded_from, place_file, place_of
from models.scene import SceneSpec, scene_xml
from models.surface import Surface
from sandbox.recording.versions import bytes_digest, package_digest, source_digest
from tasks.guarded import draw_task
from tasks.registry import TASK_PLUGINS, find_task, is_built_in, origin
from tasks.task import Task

_MOST_NAMED = 4
"""Largest number of files that a message names."""


def recorded_task(header: dict[str, Any], where: str) -> str:
    """The name under which a recording's task can be loaded on this machine.

    Args:
        header: Header of the recording.
        where: The recording, for error messages.

    Raises:
        RecordingError: The task is not on this machine, or has another version; the error names
            what to install.
    """
    name = str(header["settings"]["task"])
    source = header.get("task_from")
    if not isinstance(source, dict):
        # A built-in task. Another version of it is refused with the settings.
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
        "the recorded task is not on this machine in the recorded version",
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
        surface: The touch surface; its place in the world does not matter.
    """
    source = origin(name)
    return {**source, "files": task_files(name, seed, surface)} if source else {}


def task_change(header: dict[str, Any], name: str, seed: int, surface: Surface) -> str:
    """A line on changes of a recording's external task since it was recorded, with a remedy.

    Args:
        header: Header of the recording.
        name: Name under which the task was found; see `recorded_task`.
        seed: Seed of the trial.
        surface: The touch surface; its place in the world does not matter.

    Returns:
        The line; empty without a change, for a built-in task, and for a header without digests.
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


def task_files(name: str, seed: int, surface: Surface) -> dict[str, str]:
    """Digests of the files that a trial of a task consists of; empty for a built-in task.

    Args:
        name: Name of the task, or its place.
        seed: Seed of the trial: the objects that a task places may differ between seeds.
        surface: The touch surface; its place in the world does not matter.

    Returns:
        Digests by file name, relative to the folder of the task's file. The files are the task's
        file, the modules that it has imported from the same folder, MJCF files and their meshes.
        A package is one entry with the package's name, for all its modules.
    """
    kind = find_task(name)
    if is_built_in(kind):
        return {}
    code, folder = _code(kind, code_file(name, kind))
    return {**code, **_named(_descriptions(kind, seed, surface), folder)}


def code_file(name: str, kind: type[Task]) -> Path | None:
    """The file that a task was loaded from; None for a task of a package.

    A file may also import its task from another file in the same folder. Then both files count.

    Args:
        name: Name of the task, or its place.
        kind: The task.
    """
    return place_file(name) or loaded_from(kind.__module__)


@cache
def _code(kind: type[Task], file: Path | None) -> tuple[dict[str, str], Path]:
    """Digests of a task's code, and the folder to which file names are relative.

    The digests are computed only once, since a file that is edited later is not loaded again.
    """
    if file is not None:
        return _named(files_of(file), file.parent), file.parent
    module = sys.modules[kind.__module__]
    top = kind.__module__.partition(".")[0]
    return {top: package_digest(kind.__module__)}, Path(module.__file__ or "").absolute().parent


def _descriptions(kind: type[Task], seed: int, surface: Surface) -> list[Path]:
    """MJCF files and meshes of a trial's objects; empty if the trial cannot be drawn.

    The start of the trial reports the reason.
    """
    from models.mjcf_object import MjcfObject, described_files

    found: list[Path] = []
    with suppress(InputError), TASK_PLUGINS.guarded(kind.name):
        for thing in kind.draw(seed, surface).objects:
            if isinstance(thing, MjcfObject | MechanismPart):
                found += described_files(thing.mjcf)
    return found


def _named(files: Iterable[Path], folder: Path) -> dict[str, str]:
    digests: dict[str, list[str]] = {}
    for file in sorted(set(files)):
        with suppress(ValueError):
            # On Windows there is no relative path to a file on another drive.
            name = Path(os.path.relpath(file, folder)).as_posix()
            # Names of folders outside the task's folder may identify a person, so they are left
            # out. Two files outside the task's folder may therefore have the same name.
            name = file.name if name.startswith("../") else name
            digests.setdefault(name, []).append(bytes_digest(file))
    return {name: "+".join(sorted(some)) for name, some in digests.items()}


def own_tasks(names: Iterable[str]) -> dict[str, str]:
    """A digest of every task that is not built in, by the task's name.

    Args:
        names: Names of tasks, or `FILE.py:CLASS`.

    Raises:
        InputError: No task has this name, or it cannot be used.
    """
    kinds = {name: find_task(name) for name in names}
    return {
        kind.name: _task_digest(kind, code_file(name, kind))
        for name, kind in kinds.items()
        if not is_built_in(kind)
    }


def _task_digest(kind: type[Task], file: Path | None) -> str:
    if file is None:
        code = package_digest(kind.__module__)
    else:
        code = source_digest(files_of(file), file.parent)
    return blake2b(f"{code}\n{_trial_xml(kind)}".encode(), digest_size=8).hexdigest()


def _trial_xml(kind: type[Task]) -> str:
    """MJCF of the objects of a trial; empty if the default surface has no room for them."""
    try:
        with TASK_PLUGINS.guarded(kind.name):
            task = draw_task(kind, 0, Surface())
            return scene_xml(SceneSpec((), task.objects, task.table_friction))
    except InputError:
        return ""
