"""Small simulated hands over a Leap, for tests."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np

from encoders.evaluation.paalm_errors import calibrated_on
from encoders.paalm import Paalm, PaalmOptions
from encoders.paalm.simulated.air import FROZEN_AIR, simulate_air
from encoders.paalm.simulated.forward import PRINTED_LEAP, LeapTake, leap_take
from models.arithmetic import Array
from models.frames import TrackedHand

SHORT = replace(FROZEN_AIR, open_seconds=1.5, seconds=5.0)


@cache
def take(
    seed: int = 0, dialect: str = "v1", drop_outs: bool = True, side: str = "right"
) -> LeapTake:
    """A short take of a simulated person, over the Leap of the paper: what is seen of a finger
    depends on its bend alone, so that a test's hand is where it seems to be."""
    return leap_take(simulate_air(seed, side, SHORT), seed, dialect, drop_outs, PRINTED_LEAP)


@cache
def real_take(seed: int = 0, drop_outs: bool = True, side: str = "right") -> LeapTake:
    """A longer take over the first Leap as real recordings show it."""
    long = replace(FROZEN_AIR, open_seconds=4.0, seconds=8.0)
    return leap_take(simulate_air(seed, side, long), seed, "v1", drop_outs)


def calibrated(one: LeapTake, options: PaalmOptions | None = None) -> Paalm:
    """PAALM that has measured the hand of a take."""
    return calibrated_on(one, options or PaalmOptions())


def changed_hand(
    hand: TrackedHand,
    matrix: Array,
    about: tuple[float, float, float] = (0.0, 0.0, 0.0),
    shift: tuple[float, float, float] = (0.0, 0.0, 0.0),
) -> TrackedHand:
    """The hand turned or mirrored about a point (m) by a matrix (3, 3), then shifted (m)."""

    def along(v: tuple[float, float, float]) -> tuple[float, float, float]:
        x, y, z = (matrix @ v).tolist()
        return x, y, z

    def place(p: tuple[float, float, float]) -> tuple[float, float, float]:
        x, y, z = (matrix @ np.subtract(p, about) + about + shift).tolist()
        return x, y, z

    fingers = tuple(
        replace(f, tip=place(f.tip), direction=along(f.direction)) for f in hand.fingers
    )
    return replace(
        hand,
        palm=place(hand.palm),
        normal=along(hand.normal),
        direction=along(hand.direction),
        fingers=fingers,
    )


MIRROR = np.diag([-1.0, 1.0, 1.0])
"""For `changed_hand`: a mirror across x = 0."""
