"""Seeds that nobody chose: outputs of SHA-256 over the frozen configuration.

A number is judged on seeds drawn after the configuration is frozen. `python -m benchmarks.judged
--freeze` writes settings, digests of models, versions of tasks and how a solid hand keeps clear of
objects into `frozen.json`. The seeds follow from that file, so that tuning any of these afterwards
draws new ones. The code itself is not part of it: tables of results name its commit.
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
"""Tasks of the papers, and those that were made from them."""

LATER = ("slalom", "gather", "books", "dial", "chords", "single-keys", "insert", "close-case")
"""Tasks in which more of the hand counts."""

JUDGED = FIRST + LATER
"""Tasks of the frozen configuration."""

CLEARING = (
    *("MARGIN", "BESIDE", "NOTICED", "BEND", "SWAY", "MOVE", "TILT", "TIP_SIGMA"),
    *("STEADY", "CLEAR_SIGMA", "AHEAD", "FAR", "SLOW", "TAU", "SPEED"),
    *("REACH", "CLEARANCE", "INSIDE"),
)
"""Constants of `collision_avoidance` by which a hand keeps clear and turns solid."""


def configuration() -> dict[str, Any]:
    """Settings, models and versions of tasks that decide how a run goes, as they are now."""
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
    """The first n seeds of a task; they follow from what is frozen of it and of all tasks' runs.

    Args:
        n: How many.
        task: Name.
        solid: One of `sandbox.trial.settings.SOLID`; each has seeds of its own.

    Raises:
        InputError: The code's configuration is no longer the frozen one.
    """
    return frozen_seeds(n, task, solid, FROZEN, configuration())


def frozen_seeds(n: int, task: str, solid: str, path: Path, now: dict[str, Any]) -> list[int]:
    """The first n seeds of a task by a frozen configuration, which must be that of now.

    Args:
        n: How many.
        task: Name.
        solid: One of `sandbox.trial.settings.SOLID`.
        path: What was frozen.
        now: The configuration as it is in the code.

    Raises:
        InputError: They differ in what decides the task's runs.
    """
    frozen = json.loads(path.read_text())
    now = json.loads(json.dumps(now))
    # Another task that comes or changes draws no new seeds for this one.
    for each in (frozen, now):
        each["tasks"] = {task: each["tasks"].get(task)}
    # A setting that is younger than the file has the value that such files stand for.
    same = {**frozen, "settings": json.loads(json.dumps(encoded(decoded(frozen["settings"]))))}
    if same != now or frozen["tasks"][task] is None:
        raise InputError(
            "the configuration has changed since it was frozen",
            where=f"{path}, {task}",
            remedy="`python -m benchmarks.judged --freeze` freezes it anew and draws new seeds",
        )
    text = json.dumps(frozen | {"solid": solid}, sort_keys=True)
    return [int.from_bytes(sha256(f"{text}\n{i}".encode()).digest()[:4], "big") for i in range(n)]


def freeze(path: Path, now: dict[str, Any]) -> None:
    """Writes a configuration down."""
    path.write_text(json.dumps(now, indent=1, sort_keys=True) + "\n")


def main() -> None:
    """Writes the file if asked, and prints ten seeds a task and solidity."""
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
