"""Seeds that nobody chose, for a hand that is solid all over; the rules are those of
`benchmarks.judged`.

    python -m benchmarks.judged_hand --freeze

Frozen is what decides a run of `best`, and besides how such a hand keeps clear of things. Change
one of them, and the seeds are others.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

from benchmarks import judged
from benchmarks.judged import command, frozen_seeds
from sandbox.clearing import clearing, hand_distances, solid_links

FROZEN = Path(__file__).with_name("frozen_hand.json")

CLEARING = (
    (clearing, ("MARGIN", "BESIDE", "NOTICED", "BEND", "SWAY", "MOVE", "TILT", "TIP_SIGMA")),
    (clearing, ("STEADY", "CLEAR_SIGMA", "AHEAD", "FAR", "SLOW", "TAU", "SPEED")),
    (hand_distances, ("REACH",)),
    (solid_links, ("CLEARANCE", "INSIDE")),
)
"""Modules and the constants in them by which a hand keeps clear and turns solid."""


def configuration() -> dict[str, Any]:
    """Everything that decides how a run with `--solid hand` goes, as it is in the code now."""
    keeps_clear = {name.lower(): vars(module)[name] for module, names in CLEARING for name in names}
    return judged.configuration() | {"keeps_clear": keeps_clear}


def hand_seeds(n: int, task: str = "box-to-goal") -> list[int]:
    """The first n judged seeds of a task with the whole hand solid.

    Raises:
        InputError: The code's configuration is no longer the frozen one.
    """
    return frozen_seeds(n, task, FROZEN, configuration(), "judged_hand")


if __name__ == "__main__":
    command(__doc__, FROZEN, configuration, hand_seeds)
