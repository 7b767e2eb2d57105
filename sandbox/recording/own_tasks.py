"""Digests of tasks that are not built in: their code, and the things that they place.

A task of one's own changes without any version of ours. What it consists of is its file and the
modules that this imports from beside itself, or its whole package, and the descriptions and meshes
that it reads, which become part of the scene.
"""

from __future__ import annotations

from collections.abc import Iterable
from hashlib import blake2b
from pathlib import Path

from models.errors import InputError
from models.plugins import files_of
from models.scene import SceneSpec, scene_xml
from models.surface import Surface
from sandbox.recording.source_digest import package_digest, source_digest
from sandbox.recording.task_files import code_file
from tasks.guarded import draw_task
from tasks.registry import TASK_PLUGINS, find_task, is_built_in
from tasks.task import Task


def own_tasks(names: Iterable[str]) -> dict[str, str]:
    """A digest of every task that is not built in, by the task's own name.

    Args:
        names: Names of tasks, or `FILE.py:CLASS`.

    Raises:
        InputError: No task has this name, or it cannot be used.
    """
    kinds = {name: find_task(name) for name in names}
    return {
        kind.name: _digest(kind, code_file(name, kind))
        for name, kind in kinds.items()
        if not is_built_in(kind)
    }


def _digest(kind: type[Task], file: Path | None) -> str:
    if file is None:
        code = package_digest(kind.__module__)
    else:
        code = source_digest(files_of(file), file.parent)
    return blake2b(f"{code}\n{_scene(kind)}".encode(), digest_size=8).hexdigest()


def _scene(kind: type[Task]) -> str:
    """MJCF of the things of a trial; empty where the usual surface has no room for them."""
    try:
        with TASK_PLUGINS.guarded(kind.name):
            task = draw_task(kind, 0, Surface())
            return scene_xml(SceneSpec((), task.objects, task.table_friction))
    except InputError:
        return ""
