"""People of the second generator, each with their own hand, manner and habits."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from encoders.capture import Capture
from training.population.hands import drawn_second_hand, drawn_size
from training.population.spreads import around, between
from training.second_subject.configuration import FROZEN, SecondConfiguration
from training.second_subject.grips import MANNERS
from training.second_subject.session import simulate

LEAN = 0.6
"""Spread of the constant manner between people, relative to the range of one person's habits."""


def drawn_configuration(rng: np.random.Generator) -> SecondConfiguration:
    """Draws a person's habits, and the errors of the sensors."""
    c = FROZEN
    weak = between(rng, 0.1, 0.5)
    turn = between(rng, 0.6, 1.3)
    drawn: dict[str, Any] = {
        "strength": (weak, between(rng, weak + 0.2, 1.15)),
        "bold": between(rng, 0.0, 0.3),
        "calm": between(rng, 0.7, 1.0),
        "way": tuple(around(rng, v, 0.2) for v in c.way),
        "turn": tuple(turn * v for v in c.turn),
        "bias": between(rng, 0.05, 0.4),
        "forearm": between(rng, 0.0, 0.8),
        "elbow": between(rng, 0.15, 0.35),
        "habit": tuple(around(rng, v, 0.3) for v in c.habit),
        "variety": tuple(around(rng, v, 0.3) for v in c.variety),
        "tip_width": between(rng, 0.012, 0.019),
        "raise_": (between(rng, 0.05, 0.2), between(rng, 0.25, 0.5)),
        "curl": between(rng, 0.0, 0.6),
        "coupling": (between(rng, 0.1, 0.4), between(rng, 0.5, 0.8)),
        "pad": between(rng, 0.002, 0.0065),
        "jitter": between(rng, 0.0001, 0.0006),
        "taste": between(rng, 0.1, 0.6),
    }
    return replace(c, **drawn)


def capture_person(
    seed: list[int], frames: tuple[int, int, int, int], day: int, rate: float
) -> Capture:
    """Captures a person of this generator; see `first_people.capture_person` for the arguments."""
    rng = np.random.default_rng(seed)
    size = drawn_size(rng)
    hand = drawn_second_hand(rng, size, f"drawn {size:.3f}")
    lean = LEAN * rng.normal(size=len(MANNERS))
    c = replace(
        drawn_configuration(rng),
        training_frames=frames,
        test_frames=frames,
        training_rate=rate,
        test_rate=rate,
        five_finger_repeats=4,
    )
    capture = simulate(c, int(rng.integers(2**31)), day, hand=hand, lean=lean)
    capture.meta["size"] = size
    return capture
