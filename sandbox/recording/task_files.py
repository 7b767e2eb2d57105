"""Files of tasks that are not built in: their code, and the descriptions of what they place.

The header of a recording keeps a digest of each, so that a replay can say which one has changed.
They are of the files alone. What the program makes of a description, which differs between
versions and machines, has no part in them.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Iterable
from contextlib import suppress
from functools import cache
from pathlib import Path

from models.errors import InputError
from models.mjcf_object import MjcfObject, described_files
from models.objects import MechanismPart
from models.plugins import files_of, loaded_from, place_file
from models.surface import Surface
from sandbox.recording.source_digest import bytes_digest, package_digest
from tasks.registry import TASK_PLUGINS, find_task, is_built_in
from tasks.task import Task


def task_files(name: str, seed: int, surface: Surface) -> dict[str, str]:
    """Digests of the files that a trial of a task consists of; empty for a built-in task.

    Args:
        name: Name of the task, or its place.
        seed: Seed of the trial: the things that a task places may differ between seeds.
        surface: The touch rectangle, which need not be placed.

    Returns:
        Name relative to the folder of the task's file -> digest: of that file, of the modules that
        it has imported from beside itself, of MJCF files and their meshes. All modules of a package
        are one entry, with the package's name.
    """
    kind = find_task(name)
    if is_built_in(kind):
        return {}
    code, folder = _code(kind, code_file(name, kind))
    return {**code, **_named(_descriptions(kind, seed, surface), folder)}


def code_file(name: str, kind: type[Task]) -> Path | None:
    """The file that a task was loaded from; None for a task of a package.

    A file may also have a task that it imports from beside itself: both files take part.

    Args:
        name: Name of the task, or its place.
        kind: The task.
    """
    return place_file(name) or loaded_from(kind.__module__)


@cache
def _code(kind: type[Task], file: Path | None) -> tuple[dict[str, str], Path]:
    """Digests of a task's code, and the folder that names are relative to.

    They are taken once: a file that is edited later is not loaded again.
    """
    if file is not None:
        return _named(files_of(file), file.parent), file.parent
    module = sys.modules[kind.__module__]
    top = kind.__module__.partition(".")[0]
    return {top: package_digest(kind.__module__)}, Path(module.__file__ or "").absolute().parent


def _descriptions(kind: type[Task], seed: int, surface: Surface) -> list[Path]:
    """Files of the things of a trial; none where it cannot be drawn, which its start will tell."""
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
            # On another drive of Windows there is no way from the folder to the file.
            name = Path(os.path.relpath(file, folder)).as_posix()
            # Folders outside the task's own may tell whose they are, so that two files there may
            # have one name.
            name = file.name if name.startswith("../") else name
            digests.setdefault(name, []).append(bytes_digest(file))
    return {name: "+".join(sorted(some)) for name, some in digests.items()}
