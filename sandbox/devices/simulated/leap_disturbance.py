"""Disturbances of a simulated Leap beyond those of its frozen configuration."""

from __future__ import annotations

from dataclasses import dataclass, fields, replace
from math import isfinite

from encoders.paalm.simulated.forward import DIALECTS
from encoders.paalm.simulated.leap_configuration import LeapConfiguration
from models.errors import InputError

_NOISY = (
    "joint",
    "palm_place",
    "palm_turn",
    "length_slow",
    "tip",
    "length",
    "direction",
    "aside",
    "centre_wanders",
    "centre_place",
    "centre_turn",
    "lost_rate",
)
MOST_NOISE, LONGEST = 20.0, 10.0
"""Largest multiple of the frozen noise, and longest loss in s."""


@dataclass(frozen=True)
class LeapDisturbance:
    """Disturbances that are added to a simulated device.

    Attributes:
        noise: Factor on the noise of positions, lengths and directions, and on lost fingers.
        lose: s for which the whole hand leaves the device's view, once, while it carries an object;
            0 never.
    """

    noise: float = 1.0
    lose: float = 0.0

    def __post_init__(self) -> None:
        for name, most in (("noise", MOST_NOISE), ("lose", LONGEST)):
            value = getattr(self, name)
            if not (isfinite(value) and 0.0 <= value <= most):
                raise InputError(
                    "a disturbance of the simulated Leap is out of range",
                    where=name,
                    got=value,
                    expected=f"0 to {most:g}",
                )

    def applied(self, to: LeapConfiguration) -> LeapConfiguration:
        """The configuration with the factor on its noise."""
        if self.noise == 1.0:
            return to
        return replace(to, **{name: self.noise * getattr(to, name) for name in _NOISY})


def parse_simulated(text: str) -> tuple[str, LeapDisturbance]:
    """Reads the text after `leap-simulated:`, such as `v1,noise=2,lose=1`.

    Returns:
        Dialect and disturbance.

    Raises:
        InputError: The dialect or a disturbance is unknown.
    """
    dialect, values = DIALECTS[0], {}
    known = [f.name for f in fields(LeapDisturbance)]
    for part in filter(None, text.split(",")):
        name, equals, value = part.partition("=")
        try:
            if not equals and name in DIALECTS:
                dialect = name
                continue
            if not equals or name not in known:
                raise ValueError
            values[name] = float(value)
        except ValueError:
            raise InputError(
                "no such simulated Leap",
                where="--device",
                got=f"leap-simulated:{text}",
                expected=f"leap-simulated:{{{','.join(DIALECTS)}}}, with noise=TIMES or lose=S",
            ) from None
    return dialect, LeapDisturbance(**values)
