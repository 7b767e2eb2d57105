"""Seeds that nobody chose, for hands in the air; the rules are those of `benchmarks.judged`.

    python -m benchmarks.judged_air --freeze

Frozen are the forward Leap model, the simulated person, what becomes of frames, and the rules of
what is solid. Change one of them, and the seeds are others.
"""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path
from typing import Any

from benchmarks.judged import FIRST, command, frozen_seeds, frozen_settings
from encoders.paalm.coupling import coupling_of
from encoders.paalm.hand_reconstructor import HandReconstructorSettings
from encoders.paalm.options import PaalmOptions
from encoders.paalm.simulated.air import FROZEN_AIR
from encoders.paalm.simulated.leap_configuration import FROZEN_LEAP
from sandbox.devices.simulated.air_user.person import AirHabits
from sandbox.trial.assembly import IN_AIR
from sandbox.trial.hand_input import HandInput
from sandbox.trial.settings import HandSettings, RunSettings
from tasks.registry import TASKS
from tasks.user import UserConfiguration

FROZEN = Path(__file__).with_name("frozen_air.json")


def configuration() -> dict[str, Any]:
    """Everything that decides how a run over the first Leap goes, as it is in the code now."""
    return {
        "settings": frozen_settings(RunSettings(hands=(HandSettings(in_air=HandInput()),))),
        "reconstructor": asdict(HandReconstructorSettings()),
        "paalm": asdict(PaalmOptions(coupling=coupling_of("v1"))),
        "device": asdict(FROZEN_LEAP),
        "persons": asdict(FROZEN_AIR),
        "habits": asdict(AirHabits()),
        "user": UserConfiguration().as_json(),
        "solid": dict(IN_AIR),
        "tasks": {name: TASKS[name].version for name in FIRST},
    }


def air_seeds(n: int, task: str) -> list[int]:
    """The first n judged seeds of a task.

    Raises:
        InputError: The code's configuration is no longer the frozen one.
    """
    return frozen_seeds(n, task, FROZEN, configuration(), "judged_air")


if __name__ == "__main__":
    command(__doc__, FROZEN, configuration, air_seeds)
