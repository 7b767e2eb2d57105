"""Small simulated hands over a Leap, for tests."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

from encoders.paalm import Paalm, PaalmOptions
from encoders.paalm.air import FROZEN_AIR, simulate_air
from encoders.paalm.forward import LeapTake, seen
from encoders.paalm.judge import calibrated_on
from models.frames import HandFrame, SeenFinger, SeenHand, Vector

SHORT = replace(FROZEN_AIR, open_seconds=1.5, seconds=5.0)


@cache
def take(
    seed: int = 0, dialect: str = "v1", drop_outs: bool = True, side: str = "right"
) -> LeapTake:
    """A short take of a simulated person, as a simulated Leap sees it."""
    return seen(simulate_air(seed, side, SHORT), seed, dialect, drop_outs)


def calibrated(one: LeapTake, options: PaalmOptions | None = None) -> Paalm:
    """PAALM that has measured the hand of a take."""
    return calibrated_on(one, options or PaalmOptions())


def moved(hand: SeenHand, by: Vector) -> SeenHand:
    """The same hand at another place."""

    def shift(v: Vector) -> Vector:
        return v[0] + by[0], v[1] + by[1], v[2] + by[2]

    def finger(f: SeenFinger) -> SeenFinger:
        joints = f.joints and tuple(shift(j) for j in f.joints)
        return replace(f, tip=shift(f.tip), joints=joints)

    return replace(hand, palm=shift(hand.palm), fingers=tuple(map(finger, hand.fingers)))


def side_by_side(a: LeapTake, b: LeapTake, apart: float = 0.15) -> list[HandFrame]:
    """Frames that show the first take's hand on the right and the second's on the left."""
    return [
        HandFrame(
            x.time,
            (
                replace(moved(y.hands[0], (-apart, 0.0, 0.0)), id=2),
                moved(x.hands[0], (apart, 0.0, 0.0)),
            ),
        )
        for x, y in zip(a.frames, b.frames, strict=True)
    ]
