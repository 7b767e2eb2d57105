"""Seeds that nobody chose: outputs of SHA-256 over the frozen configuration.

A number is judged on seeds drawn after the configuration is frozen. `python -m benchmarks.judged
--freeze` writes settings, digests of models and versions of tasks into `frozen.json`. The seeds
follow from that file, so that tuning any of these afterwards draws new ones. The code itself is not
part of it: tables of results name its commit.
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Callable
from dataclasses import asdict
from hashlib import sha256
from pathlib import Path
from typing import Any

from models.errors import InputError
from sandbox.trial.assembly import digests, reconstructor_settings
from sandbox.trial.settings import RunSettings
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
"""Tasks of the papers, and those that were made from them."""

LATER = ("slalom", "gather", "books", "dial", "chords", "insert", "close-case")
"""Tasks in which more of the hand counts."""

JUDGED = FIRST + LATER
"""Tasks of the frozen configuration."""


def configuration() -> dict[str, Any]:
    """Settings, models and versions of tasks that decide how a run goes, as they are now."""
    settings = RunSettings()
    reconstructor = asdict(reconstructor_settings(settings))
    # Of later rules than those that were frozen.
    assert not reconstructor["arrival"].pop("stays")
    return {
        "settings": frozen_settings(settings),
        "reconstructor": reconstructor,
        "user": UserConfiguration().as_json(),
        "digests": digests(settings),
        "tasks": {name: TASKS[name].version for name in JUDGED},
    }


def frozen_settings(settings: RunSettings) -> dict[str, Any]:
    """The settings of a run with one hand, in the form of the frozen files.

    The seeds are outputs of a hash over these files, which are older than the tuple of hands.
    """
    values = settings.as_json()
    del values["one_surface"]
    (hand,) = values.pop("hands")
    return values | {"hand": hand["side"], "hand_size": hand["size"], "turn": hand["turn"]}


def judged_seeds(n: int, task: str = "box-to-goal") -> list[int]:
    """The first n seeds of a task; they follow from what is frozen of it and of all tasks' runs.

    Raises:
        InputError: The code's configuration is no longer the frozen one.
    """
    return frozen_seeds(n, task, FROZEN, configuration(), "judged")


def frozen_seeds(n: int, task: str, path: Path, now: dict[str, Any], module: str) -> list[int]:
    """The first n seeds of a task by a frozen configuration, which must be that of now.

    Args:
        n: How many.
        task: Name.
        path: What was frozen.
        now: The configuration as it is in the code.
        module: Module of `benchmarks` that freezes it.

    Raises:
        InputError: They differ in what decides the task's runs.
    """
    frozen = json.loads(path.read_text())
    now = json.loads(json.dumps(now))
    # Another task that comes or changes draws no new seeds for this one.
    for each in (frozen, now):
        each["tasks"] = {task: each["tasks"].get(task)}
    if frozen != now or frozen["tasks"][task] is None:
        raise InputError(
            "the configuration has changed since it was frozen",
            where=f"{path}, {task}",
            remedy=f"`python -m benchmarks.{module} --freeze` freezes it anew and draws new seeds",
        )
    text = json.dumps(frozen, sort_keys=True)
    return [int.from_bytes(sha256(f"{text}\n{i}".encode()).digest()[:4], "big") for i in range(n)]


def freeze(path: Path, now: dict[str, Any]) -> None:
    """Writes a configuration down."""
    path.write_text(json.dumps(now, indent=1, sort_keys=True) + "\n")


def command(
    about: str | None,
    path: Path,
    configuration: Callable[[], dict[str, Any]],
    seeds: Callable[[int, str], list[int]],
) -> None:
    """The command of a module that freezes: writes the file if asked, and prints ten seeds a task.

    Args:
        about: The module's text.
        path: What is frozen.
        configuration: As it is in the code now, with all its tasks.
        seeds: The first n judged seeds of a task.
    """
    parser = argparse.ArgumentParser(
        description=about, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--freeze", action="store_true", help=f"write {path.name}")
    if parser.parse_args().freeze:
        freeze(path, configuration())
    for name in configuration()["tasks"]:
        print(name, *seeds(10, name))


if __name__ == "__main__":
    command(__doc__, FROZEN, configuration, judged_seeds)
