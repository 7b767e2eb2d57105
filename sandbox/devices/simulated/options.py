"""Options of simulated devices."""

from __future__ import annotations

from dataclasses import dataclass, field

from models.errors import InputError
from tasks.user import UserConfiguration

NEXT_PERSON = 1_000_003
"""Added to the seed for the user of the second hand; larger than all seeds of trials."""
MOST_DROP_OUTS = 10.0
"""1/s, largest rate at which a simulated screen loses each touch."""


@dataclass(frozen=True)
class SimulatedOptions:
    """Options of the simulated user at a tablet."""

    user: UserConfiguration = field(default_factory=UserConfiguration)
    """The simulated user."""

    drop_outs: float = 0.0
    """Times per second that the user's screen loses each touch, 0 to 10."""

    def __post_init__(self) -> None:
        if not 0.0 <= self.drop_outs <= MOST_DROP_OUTS:
            raise InputError(
                "out of range",
                where="--drop-outs",
                got=self.drop_outs,
                expected=f"0 to {MOST_DROP_OUTS:g} times per second",
            )


@dataclass(frozen=True)
class InAirOptions:
    """Options of a simulated person over a Leap, or in a headset."""

    user: UserConfiguration = field(default_factory=UserConfiguration)
    """The simulated user."""
