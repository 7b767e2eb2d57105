"""Finger sets over time: the script of day 0, free play on later days, and contact ids."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from models.arithmetic import Array, Mask
from models.frames import FINGERS
from training.second_subject.configuration import SecondConfiguration
from training.second_subject.grips import GESTURES

SETS = np.array(
    [[bool(code >> f & 1) for f in range(5)] for code in range(32) if code.bit_count() >= 2]
)
"""Booleans (26, 5): the fingers of each set of two or more fingers."""


@dataclass(frozen=True)
class TakeSettings:
    """Settings of one take: touching fingers (n, 5), rate in Hz, gestures, and whether it is free
    play."""

    down: Mask
    rate: float
    gestures: tuple[str, ...]
    free: bool

    @property
    def times(self) -> Array:
        """Times (n,) s from the take's beginning."""
        return np.arange(len(self.down)) / self.rate


def script(c: SecondConfiguration) -> list[TakeSettings]:
    """Script of day 0: every finger set with every gesture, so that encoders learn every set."""
    takes = []
    for size, frames in enumerate(c.training_frames, start=2):
        chosen = SETS[SETS.sum(axis=1) == size]
        repeats = c.five_finger_repeats if size == len(FINGERS) else 1
        clips = [(fingers, g) for fingers in chosen for g in GESTURES for _ in range(repeats)]
        share, rest = divmod(frames, len(clips))
        for i, (fingers, gesture) in enumerate(clips):
            down = np.repeat(fingers[None], share + (i < rest), axis=0)
            takes.append(TakeSettings(down, c.training_rate, (gesture,), False))
    return takes


def preferences(rng: np.random.Generator, scale: float) -> Array:
    """Preference (26,) of a subject for each finger set.

    All subjects prefer sets with the thumb, and sets without gaps from the index finger on. The
    logarithm of individual preferences has a Laplace distribution, so some of them are strong.
    """
    others = SETS[:, 1:]
    # Unused fingers between the index and the outermost finger in use.
    skipped = (4 - others[:, ::-1].argmax(axis=1)) - others.sum(axis=1)
    liking = np.log(2.0) * SETS[:, 0] - 0.9 * skipped
    return np.exp(liking + rng.laplace(0, scale, len(SETS)))


def free_play(rng: np.random.Generator, taste: Array, c: SecondConfiguration) -> list[TakeSettings]:
    """Takes of the free play of a later day. A take consists of stretches with one finger set each;
    from stretch to stretch, one or two fingers change."""
    stretches = _stretches(rng, taste, c)
    takes = []
    while stretches:
        current = stretches.pop(int(rng.integers(len(stretches))))
        chain = [current]
        while sum(n for _, n in chain) < c.take_length * c.test_rate:
            changes = [int((SETS[s] ^ SETS[chain[-1][0]]).sum()) for s, _ in stretches]
            near = [i for i, count in enumerate(changes) if 1 <= count <= 2]
            if not near:
                break
            chain.append(stretches.pop(int(rng.choice(near))))
        down = np.concatenate([np.repeat(SETS[s][None], n, axis=0) for s, n in chain])
        count = 1 if rng.random() < 0.4 else 2
        gestures = tuple(str(g) for g in rng.choice(GESTURES, count, replace=False))
        takes.append(TakeSettings(down, c.test_rate, gestures, True))
    return takes


def _stretches(
    rng: np.random.Generator, taste: Array, c: SecondConfiguration
) -> list[tuple[int, int]]:
    """Stretches of a day, as pairs of the index of a finger set and the number of frames.

    For every number of fingers, the frames add up to `test_frames`.
    """
    out = []
    low, high = (int(s * c.test_rate) for s in c.stay)
    for size, left in enumerate(c.test_frames, start=2):
        chosen = np.flatnonzero(SETS.sum(axis=1) == size)
        odds = taste[chosen] / taste[chosen].sum()
        while left:
            frames = int(rng.integers(low, high + 1))
            # If the remainder would be too short for a stretch, it is added to the last stretch.
            frames = left if left - frames < low else frames
            out.append((int(rng.choice(chosen, p=odds)), frames))
            left -= frames
    return out


def closeness(down: Mask, rate: float, landing: float) -> Array:
    """Values (n, 5): 1 while a finger touches, 0 while it is lifted, with smooth transitions."""
    n = len(down)
    frame = np.arange(n)[:, None]
    before = np.maximum.accumulate(np.where(down, frame, -n * 9), axis=0)
    after = np.minimum.accumulate(np.where(down, frame, n * 9)[::-1], axis=0)[::-1]
    away = np.minimum(frame - before, after - frame) / rate
    return 0.5 + 0.5 * np.cos(np.pi * np.clip(away / landing, 0.0, 1.0))


def contact_ids(down: Mask, first: int) -> tuple[NDArray[np.int64], int]:
    """Contact ids (n, 5), -1 while lifted, and the next free id.

    An id lasts from touch-down to touch-up and is never used again.
    """
    ids = np.full(down.shape, -1, np.int64)
    living = np.full(down.shape[1], -1, np.int64)
    for i, touching in enumerate(down):
        new = touching & (living < 0)
        living[new] = first + np.arange(new.sum())
        first += int(new.sum())
        living[~touching] = -1
        ids[i] = living
    return ids, first
