"""Takes for evaluating PAALM from recordings whose device knows joints: its bones are the truth."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from encoders.paalm.angles import angles_of_joints
from encoders.paalm.calibration import EQUAL_BENDS, MOST_BENT, measure, pointing
from encoders.paalm.palm import palm_of
from encoders.paalm.simulated.forward import LeapTake
from models.arithmetic import Array
from models.errors import EncoderError
from models.frames import FINGERS, HandFrame, TrackedFinger, TrackedHand


def take_of_recording(frames: Sequence[HandFrame], side: str) -> LeapTake:
    """Extracts the frames of one hand whose five fingers have labels and joints.

    Raises:
        EncoderError: There are no such frames.
    """
    kept: list[HandFrame] = []
    names: list[dict[int, int]] = []
    angles: list[Array] = []
    for frame in frames:
        hand = next((h for h in frame.hands if h.side == side), None)
        if hand is None or not _whole(hand):
            continue
        palm = palm_of(hand, side)
        ordered = sorted(hand.fingers, key=lambda f: f.finger or 0)
        joints = [[palm.place(j) for j in f.joints or ()] for f in ordered]
        angles.append(angles_of_joints(joints))
        kept.append(replace(frame, hands=(hand,)))
        names.append({f.id: int(f.finger or 0) for f in ordered})
    if not kept:
        raise EncoderError(f"no {side} hand with five fingers and their joints")
    table = np.array(angles)
    is_open = (table[:, 1:, 2] + table[:, 1:, 3] < MOST_BENT).all(axis=1) & (
        table[:, 1:, 0] < 45.0
    ).all(axis=1)
    return LeapTake(tuple(kept), tuple(names), table, _steady(np.asarray(is_open)), side, "v3")


def independent(take: LeapTake) -> bool:
    """True if PIP and DIP are independent in this recording, so that they can be evaluated."""
    apart = np.abs(take.angles[:, 1:, 2] - take.angles[:, 1:, 3]).mean()
    return bool(apart > EQUAL_BENDS)


def as_first_software(take: LeapTake, seed: int = 0) -> LeapTake:
    """The hand as the first software would have reported it: no labels, no joints, any order.

    A finger that the device does not report as stretched is left out, since the first software lost
    folded fingers; a returning one gets a new id.
    """
    rng = np.random.default_rng([seed, 0xF175])
    fresh, current = 0, dict.fromkeys(range(len(FINGERS)), -1)
    frames, names = [], []
    for frame, held in zip(take.frames, take.open, strict=True):
        hand = frame.hands[0]
        shown: list[TrackedFinger] = []
        for finger in hand.fingers:
            name = int(finger.finger or 0)
            if finger.extended is False and not held:
                current[name] = -1
                continue
            if current[name] < 0:
                current[name], fresh = fresh, fresh + 1
            shown.append(
                TrackedFinger(current[name], finger.tip, pointing(finger), measure(finger))
            )
        order = rng.permutation(len(shown)).tolist()
        shown = [shown[i] for i in order]
        unnamed = replace(hand, fingers=tuple(shown))
        frames.append(replace(frame, hands=(unnamed,), dialect="v1"))
        names.append({i: n for n, i in current.items() if i >= 0})
    return replace(take, frames=tuple(frames), fingers=tuple(names), dialect="v1")


def _whole(hand: TrackedHand) -> bool:
    return len(hand.fingers) == len(FINGERS) and all(
        f.joints is not None and f.finger is not None for f in hand.fingers
    )


def _steady(is_open: NDArray[np.bool_], most: float = 0.3) -> NDArray[np.bool_]:
    """The first open frames, up to a share of all; the others are evaluated."""
    chosen = is_open & (np.cumsum(is_open) <= max(most * len(is_open), 10))
    return np.asarray(chosen)
