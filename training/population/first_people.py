"""People of the first generator, each with their own hand, resting posture and habits."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from encoders.capture import Capture
from encoders.captures.subject.configuration import FROZEN, SubjectConfiguration
from encoders.captures.subject.subject import FREEDOMS, simulate
from training.population.hands import drawn_size, drawn_skeleton
from training.population.spreads import around, between

LEAN = 0.4
"""Spread of resting postures between people, relative to the spread of one person's postures."""


def drawn_configuration(rng: np.random.Generator) -> SubjectConfiguration:
    """Draws a person's habits, and the errors of the sensors.

    Openings of the hand range from well below to well above those of the frozen subject. People who
    hold a wide object open their hands to 110 mm from thumb to index finger.
    """
    c = FROZEN
    yaw = between(rng, 0.7, 1.3)
    drawn: dict[str, Any] = {
        "grasp": between(rng, 0.35, 0.9),
        "grasp_closed": between(rng, -0.2, 0.5),
        "widest": between(rng, 1.3, 1.9),
        "pinch": between(rng, 0.5, 0.95),
        "pinch_closed": between(rng, -0.3, 0.9),
        "pinch_least": between(rng, -1.1, -0.3),
        "move": around(rng, c.move, 0.3),
        "turn": between(rng, 0.5, 1.4),
        "placing": between(rng, 0.003, 0.008),
        "wobble": between(rng, 0.0015, 0.004),
        "tip_width": between(rng, 0.012, 0.019),
        "aside": between(rng, 0.05, 0.5),
        "synergy_spread": tuple(around(rng, v, 0.25) for v in c.synergy_spread),
        "finger_spread": tuple(around(rng, v, 0.25) for v in c.finger_spread),
        "thumb_spread": tuple(around(rng, v, 0.25) for v in c.thumb_spread),
        "root_rotation_spread": tuple(yaw * v for v in c.root_rotation_spread),
        "arm_turn": between(rng, 0.75, 1.0),
        "elbow": between(rng, 0.0, 0.5),
        "elbow_distance": between(rng, 0.15, 0.35),
        "curl_share": between(rng, 0.0, 0.6),
        "lift_posture": between(rng, 0.1, 0.4),
        "pad_roll": between(rng, 0.002, 0.0055),
        "touch_noise": between(rng, 0.0001, 0.0006),
        "natural": between(rng, 1.0, 3.0),
    }
    return replace(c, **drawn)


def capture_person(
    seed: list[int], frames: tuple[int, int, int, int], day: int, rate: float
) -> Capture:
    """Captures a person of this generator.

    Args:
        seed: Seed of the person.
        frames: Number of frames with 2, 3, 4 and 5 fingers.
        day: 0 for the script of all finger sets, a later day for free play.
        rate: Rate (Hz) of the frames.
    """
    rng = np.random.default_rng(seed)
    size = drawn_size(rng)
    skeleton = drawn_skeleton(rng, size, f"drawn {size:.3f}")
    lean = LEAN * rng.normal(size=FREEDOMS)
    c = replace(
        drawn_configuration(rng),
        training_frames=frames,
        test_frames=frames,
        training_rate=rate,
        test_rate=rate,
        five_finger_repeats=4,
    )
    capture = simulate(c, int(rng.integers(2**31)), day, skeleton=skeleton, lean=lean)
    capture.meta["size"] = size
    return capture
