"""The build to which a study is locked: program, libraries, encoders, tasks and design."""

from __future__ import annotations

from collections.abc import Collection
from functools import cache
from pathlib import Path
from typing import Any

from sandbox.recording.recorded_task import own_tasks
from sandbox.recording.versions import (
    DECISIVE,
    decisive_part,
    program_root,
    source_digest,
    source_files,
    versions,
)
from sandbox.study.design.conditions import every_values, run_settings
from sandbox.study.design.design import Design


def _with_packages_below(folder: str) -> list[str]:
    """Paths of a folder of the program and of every package below it; a new package needs no
    entry."""
    root = program_root()
    below = (path.parent for path in (root / folder).rglob("__init__.py"))
    return sorted(path.relative_to(root).as_posix() for path in below)


COMPUTES = (
    "models",
    "models/robot",
    "encoders",
    "encoders/air",
    "encoders/labels",
    "encoders/paalm",
    "encoders/paalm/simulated",
    "encoders/person",
    "encoders/reconstruction",
    "encoders/regression",
    "tasks",
    "tasks/simulated_user",
    *_with_packages_below("sandbox/devices"),
    "sandbox/play",
    "sandbox/recording",
    "sandbox/session",
    "sandbox/study/design",
    "sandbox/study/measures",
    "sandbox/study/record",
    "sandbox/study/run",
    "sandbox/study/tables",
    "sandbox/trial",
)
"""Folders whose files take part in a trial or compute its measures."""
LEFT_OUT = {
    "encoders/captures/conversion": "it converts recordings to captures, which no trial does",
    "models/motion": "it reads and writes files of motion capture, which no trial does",
    "models/skin": "it is drawn only; no state depends on it",
    "sandbox": "lsl.py sends copies of events to other instruments",
    "sandbox/server": "it connects the page; the touches that it receives are recorded",
    "sandbox/system": "it locks and flushes files",
    "sandbox/views": "it shows the simulation",
    "sandbox/words": "it has texts for people; no state depends on them",
}
"""Folders that files of `COMPUTES` import but that the digest leaves out, each with the reason."""
LIBRARIES = ("hand-sandbox", *DECISIVE)
"""Versions to which a study is locked."""
OWN_TASKS = "tasks of one's own"
"""Key of a build: digests of tasks that are not built in, by name."""
NOTED = ("numpy", "python", "scipy")
"""Versions that are recorded for human readers; a study is not locked to them."""

SHARED_BUILD = (*LIBRARIES, *NOTED, OWN_TASKS, "program", "encoders", "design")
"""Keys of a build that `sandbox study share` includes."""


@cache
def code_digest() -> str:
    """Digest of the parts of the program that take part in a trial or compute its measures."""
    return digest_of(program_root())


def digest_of(root: Path) -> str:
    """Digest of the files of `COMPUTES` below a folder."""
    files = (path for folder in COMPUTES for path in source_files(root / folder))
    return source_digest(files, root)


def build_of(design: Design) -> dict[str, Any]:
    """Versions of libraries, and digests of the program, of a design and of all its encoders.

    If the design has tasks that are not built in, their digests are included.
    """
    from sandbox.trial.assembly import digests

    here = versions()
    learned: dict[str, dict[str, str]] = {}
    tasks: set[str] = set()
    for values in every_values(design):
        settings = run_settings(values, 0)
        pipeline = settings.pipeline
        learned.setdefault(f"{pipeline.encoder}, labels {pipeline.labels}", digests(settings))
        tasks.add(settings.task)
    own = own_tasks(sorted(tasks))
    return {
        **{name: here[name] for name in (*LIBRARIES, *NOTED)},
        **({OWN_TASKS: own} if own else {}),
        "program": code_digest(),
        "encoders": learned,
        "design": design.digest,
    }


def changes(locked: dict[str, Any], here: dict[str, Any]) -> list[str]:
    """Differences between two builds to which a study can be locked, with their values."""
    names = (set(locked) | set(here)) - set(NOTED)
    # Builds of earlier versions have no digests of external tasks, so these are not compared.
    return _differences(locked, here, names if OWN_TASKS in locked else names - {OWN_TASKS})


def noted_changes(locked: dict[str, Any], here: dict[str, Any]) -> list[str]:
    """Differences of the versions in `NOTED`, to which a study is not locked."""
    return _differences(locked, here, NOTED)


def _differences(locked: dict[str, Any], here: dict[str, Any], names: Collection[str]) -> list[str]:
    differences = []
    for name in sorted(names):
        before, after = locked.get(name), here.get(name)
        if decisive_part(name, before) != decisive_part(name, after):
            values = "" if name == "encoders" else f" ({before} -> {after})"
            if name == OWN_TASKS:
                values = f" ({_changed_tasks(before or {}, after or {})})"
            differences.append(f"{name}{values}")
    return differences


def _changed_tasks(before: dict[str, str], after: dict[str, str]) -> str:
    """A text that names the external tasks whose code or objects have changed."""
    names = [name for name in sorted({*before, *after}) if before.get(name) != after.get(name)]
    return ", ".join(f"the code or the objects of {name} have changed" for name in names)
