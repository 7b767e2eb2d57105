"""Combines two takes of one hand each to frames that show both hands beside each other."""

from __future__ import annotations

import time
from dataclasses import replace

import numpy as np

from encoders.paalm.paalm import Paalm
from encoders.paalm.simulated.forward import LeapTake
from models.frames import HandFrame, TrackedFinger, TrackedHand, Vector


def moved(hand: TrackedHand, by: Vector) -> TrackedHand:
    """The hand shifted by `by`, m."""

    def shift(v: Vector) -> Vector:
        return v[0] + by[0], v[1] + by[1], v[2] + by[2]

    def finger(f: TrackedFinger) -> TrackedFinger:
        if f.joints is None:
            return replace(f, tip=shift(f.tip))
        a, b, c, d = (shift(j) for j in f.joints)
        return replace(f, tip=shift(f.tip), joints=(a, b, c, d))

    return replace(hand, palm=shift(hand.palm), fingers=tuple(map(finger, hand.fingers)))


def side_by_side(right: LeapTake, left: LeapTake, apart: float = 0.15) -> list[HandFrame]:
    """Frames with both hands, each `apart` m from the middle; as long as the shorter take."""
    return [
        HandFrame(
            x.time,
            (
                replace(moved(y.hands[0], (-apart, 0.0, 0.0)), id=2),
                moved(x.hands[0], (apart, 0.0, 0.0)),
            ),
        )
        for x, y in zip(right.frames, left.frames, strict=False)
    ]


def two_hand_milliseconds(right: LeapTake, left: LeapTake) -> float:
    """Median ms of a step with two hands, measured on this machine."""
    frames = side_by_side(right, left)
    paalm = Paalm()
    held = (right.open & left.open)[: len(frames)]
    is_open = [f for f, both in zip(frames, held, strict=True) if both]
    paalm.calibrate(is_open, "both", len(is_open) // 2)
    paalm.reset()
    spent = []
    for frame in frames:
        begin = time.perf_counter()
        paalm.step(frame)
        spent.append(time.perf_counter() - begin)
    return 1e3 * float(np.median(spent))
