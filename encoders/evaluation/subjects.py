"""The simulated subject of `sandbox evaluate`, with judged days.

Judged days are the days on which methods are tested. Their numbers are derived from the subject's
configuration and a day seed by SHA-256. The numbers can therefore not be chosen, and they change
whenever the configuration changes.
"""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from hashlib import sha256
from typing import Any

from encoders.capture import Capture
from encoders.captures.subject import FROZEN, SEED, simulate

Progress = Callable[[float], None]

TRAINING_DAY = 0


@dataclass(frozen=True)
class Subject:
    """A simulated subject whose configuration is frozen.

    Attributes:
        name: The subject's name.
        seed: Seed of the person in its built-in captures.
        configuration: The configuration as JSON values.
        day: Creates a capture from day number and progress callback.
    """

    name: str
    seed: int
    configuration: dict[str, Any]
    day: Callable[[int, Progress | None], Capture]

    @property
    def digest(self) -> str:
        """SHA-256 of configuration and seed, hexadecimal."""
        text = json.dumps([self.name, self.seed, self.configuration], sort_keys=True)
        return sha256(text.encode()).hexdigest()

    def judged_days(self, count: int, day_seed: int) -> list[int]:
        """Numbers of the first `count` judged days for a day seed; none is the training day."""
        days = []
        for i in range(count):
            drawn = sha256(f"{self.digest} {day_seed} {i}".encode()).digest()
            days.append(TRAINING_DAY + 1 + int.from_bytes(drawn[:3], "big"))
        return days

    def plays(self, capture: Capture) -> bool:
        """True if a capture is the training day of this subject in its current configuration."""
        meta = capture.meta
        return bool(
            meta.get("seed") == self.seed
            and meta.get("day") == TRAINING_DAY
            and json_values(meta.get("configuration")) == self.configuration
        )


@cache
def first_subject() -> Subject:
    """The subject on whose training day the built-in encoders of one person are trained."""

    def day(number: int, progress: Progress | None = None) -> Capture:
        return simulate(FROZEN, SEED, number, progress)

    return Subject("first", SEED, json_values(FROZEN.as_json()), day)


def json_values(values: Any) -> Any:
    """Values as JSON returns them: tuples become lists."""
    return json.loads(json.dumps(values))
