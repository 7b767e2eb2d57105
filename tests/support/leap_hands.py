"""Small simulated hands over a Leap, for tests."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

from encoders.evaluation.paalm_judge import calibrated_on
from encoders.paalm import Paalm, PaalmOptions
from encoders.paalm.simulated.air import FROZEN_AIR, simulate_air
from encoders.paalm.simulated.forward import LeapTake, leap_take

SHORT = replace(FROZEN_AIR, open_seconds=1.5, seconds=5.0)


@cache
def take(
    seed: int = 0, dialect: str = "v1", drop_outs: bool = True, side: str = "right"
) -> LeapTake:
    """A short take of a simulated person, as a simulated Leap sees it."""
    return leap_take(simulate_air(seed, side, SHORT), seed, dialect, drop_outs)


def calibrated(one: LeapTake, options: PaalmOptions | None = None) -> Paalm:
    """PAALM that has measured the hand of a take."""
    return calibrated_on(one, options or PaalmOptions())
