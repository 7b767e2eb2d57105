"""Test seeds that no person chose: outputs of SHA-256 over the frozen configuration.

Success rates are measured on seeds that are drawn after the configuration is frozen. `python -m
benchmarks.judged --freeze` writes settings, digests of models, versions of tasks and the constants
of collision avoidance to `frozen.json`. The seeds depend on that file, so that a later change of
these values draws new seeds. The file does not include the code: tables of results have its commit.
"""

from __future__ import annotations

import argparse
import json
from dataclasses import asdict
from hashlib import sha256
from pathlib import Path
from typing import Any

from models.errors import InputError
from sandbox.session import collision_avoidance
from sandbox.trial.assembly import digests, reconstructor_settings
from sandbox.trial.settings import SOLID, Settings, decoded, encoded
from tasks.registry import TASKS
from tasks.user import UserConfiguration

FROZEN = Path(__file__).with_name("frozen.json")

FIRST = (
    "box-to-goal",
    "wrench-turn",
    "wrench-slide",
    "stack",
    "stack-three",
    "stack-vertical",
    "carry-together",
)
"""Tasks of the papers, and tasks that are derived from them."""

LATER = ("slalom", "gather", "books", "dial", "chords", "single-keys", "insert", "close-case")
"""Tasks in which more parts of the hand matter."""

JUDGED = FIRST + LATER
"""Tasks of the frozen configuration."""

CLEARING = (
    *("MARGIN", "BESIDE", "NOTICED", "BEND", "SWAY", "MOVE", "TILT", "TIP_SIGMA"),
    *("STEADY", "CLEAR_SIGMA", "AHEAD", "FAR", "SLOW", "TAU", "SPEED"),
    *("REACH", "CLEARANCE", "INSIDE"),
)
"""Constants of `collision_avoidance` that are part of the configuration."""


def configuration() -> dict[str, Any]:
    """Returns the current settings, digests of models and versions of tasks that affect trials."""
    settings = Settings()
    return {
        "settings": encoded(settings),
        "reconstructor": asdict(reconstructor_settings(settings)),
        "user": UserConfiguration().as_json(),
        "digests": digests(settings),
        "keeps_clear": {name.lower(): vars(collision_avoidance)[name] for name in CLEARING},
        "tasks": {name: TASKS[name].version for name in JUDGED},
    }


def judged_seeds(n: int, task: str = "box-to-goal", solid: str = SOLID[0]) -> list[int]:
    """Returns the first n test seeds of a task, which depend on the frozen configuration alone.

    Args:
        n: Number of seeds.
        task: Name of the task.
        solid: One of `sandbox.trial.settings.SOLID`. Each has other seeds.

    Raises:
        InputError: The configuration of the code differs from the frozen one.
    """
    return frozen_seeds(n, task, solid, FROZEN, configuration())


def frozen_seeds(n: int, task: str, solid: str, path: Path, now: dict[str, Any]) -> list[int]:
    """Returns the first n seeds of a task for a frozen configuration.

    Args:
        n: Number of seeds.
        task: Name of the task.
        solid: One of `sandbox.trial.settings.SOLID`.
        path: File with the frozen configuration.
        now: The current configuration of the code.

    Raises:
        InputError: The two configurations differ for this task.
    """
    frozen = json.loads(path.read_text())
    now = json.loads(json.dumps(now))
    # A new or changed other task does not change the seeds of this one.
    for each in (frozen, now):
        each["tasks"] = {task: each["tasks"].get(task)}
    # A setting that is newer than the file has the value that a file without it means.
    same = {**frozen, "settings": json.loads(json.dumps(encoded(decoded(frozen["settings"]))))}
    if same != now or frozen["tasks"][task] is None:
        raise InputError(
            "the configuration has changed since it was frozen",
            where=f"{path}, {task}",
            remedy="Run `python -m benchmarks.judged --freeze`; it draws new seeds",
        )
    text = json.dumps(frozen | {"solid": solid}, sort_keys=True)
    return [int.from_bytes(sha256(f"{text}\n{i}".encode()).digest()[:4], "big") for i in range(n)]


def freeze(path: Path, now: dict[str, Any]) -> None:
    """Writes a configuration to a file."""
    path.write_text(json.dumps(now, indent=1, sort_keys=True) + "\n")


def main() -> None:
    """Writes the file with `--freeze`, and prints ten seeds for each task and solidity."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--freeze", action="store_true", help=f"write {FROZEN.name}")
    if parser.parse_args().freeze:
        freeze(FROZEN, configuration())
    for name in JUDGED:
        for solid in SOLID:
            print(name, solid, *judged_seeds(10, name, solid))


if __name__ == "__main__":
    main()
