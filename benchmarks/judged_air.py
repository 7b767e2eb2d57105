"""Seeds that nobody chose, for hands in the air; the rules are those of `benchmarks.judged`.

    python -m benchmarks.judged_air --freeze

Frozen are the forward Leap model, the simulated person, what becomes of frames, and the rules of
what is solid. Change one of them, and the seeds are others.
"""

from __future__ import annotations

import argparse
import json
from dataclasses import asdict
from hashlib import sha256
from pathlib import Path
from typing import Any

from encoders.paalm.air import FROZEN_AIR
from encoders.paalm.forward import FROZEN_LEAP
from encoders.paalm.hand_reconstructor import HandReconstructorSettings
from encoders.paalm.options import PaalmOptions
from models.errors import InputError
from sandbox.air_user.person import AirHabits
from sandbox.assembly import IN_AIR
from sandbox.hand_input import HandInput
from sandbox.settings import RunSettings
from tasks.registry import TASKS
from tasks.simulated_user.configuration import UserConfiguration

FROZEN = Path(__file__).with_name("frozen_air.json")


def configuration() -> dict[str, Any]:
    """Everything that decides how a run in the air goes, as it is in the code now."""
    return {
        "settings": RunSettings(in_air=HandInput()).as_json(),
        "reconstructor": asdict(HandReconstructorSettings()),
        "paalm": asdict(PaalmOptions()),
        "device": asdict(FROZEN_LEAP),
        "persons": asdict(FROZEN_AIR),
        "habits": asdict(AirHabits()),
        "user": UserConfiguration().as_json(),
        "solid": dict(IN_AIR),
        "tasks": {name: task.version for name, task in TASKS.items()},
    }


def air_seeds(n: int, task: str) -> list[int]:
    """The first n judged seeds of a task.

    Raises:
        InputError: The code's configuration is no longer the frozen one.
    """
    frozen = json.loads(FROZEN.read_text())
    now = json.loads(json.dumps(configuration()))
    # Another task that comes or changes draws no new seeds for this one.
    for each in (frozen, now):
        each["tasks"] = {task: each["tasks"].get(task)}
    if frozen != now or frozen["tasks"][task] is None:
        raise InputError(
            "the configuration has changed since it was frozen",
            where=f"{FROZEN}, {task}",
            remedy="`python -m benchmarks.judged_air --freeze` freezes it anew, with new seeds",
        )
    text = json.dumps(frozen, sort_keys=True)
    return [int.from_bytes(sha256(f"{text}\n{i}".encode()).digest()[:4], "big") for i in range(n)]


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--freeze", action="store_true", help="write frozen_air.json")
    if parser.parse_args().freeze:
        FROZEN.write_text(json.dumps(configuration(), indent=1, sort_keys=True) + "\n")
    for name in TASKS:
        print(name, *air_seeds(10, name))
