"""People of both generators, each with their own hand, posture or manner, habits and sensors."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from encoders.capture import Capture
from encoders.captures import subject
from encoders.captures.subject.configuration import SubjectConfiguration
from encoders.captures.subject.subject import FREEDOMS
from training import second_subject
from training.population.hands import drawn_second_hand, drawn_size, drawn_skeleton
from training.second_subject.configuration import SecondConfiguration
from training.second_subject.grips import MANNERS

POSTURE_LEAN = 0.4
"""Spread of resting postures between people, relative to the spread of one person's postures."""

MANNER_LEAN = 0.6
"""Spread of the constant manner between people, relative to the range of one person's habits."""


def between(rng: np.random.Generator, least: float, greatest: float) -> float:
    """A random number, uniform in a range."""
    return float(rng.uniform(least, greatest))


def around(rng: np.random.Generator, value: float, spread: float) -> float:
    """A random number near `value`; its logarithm has a normal distribution with a standard
    deviation of `spread`."""
    return float(value * np.exp(spread * rng.normal()))


def first_configuration(rng: np.random.Generator) -> SubjectConfiguration:
    """Draws the habits of a person of the first generator, and the errors of the sensors.

    Openings of the hand range from well below to well above those of the frozen subject. People who
    hold a wide object open their hands to 110 mm from thumb to index finger.
    """
    c = subject.FROZEN
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


def first_person(
    seed: list[int], frames: tuple[int, int, int, int], day: int, rate: float
) -> Capture:
    """Captures a person of the first generator.

    Args:
        seed: Seed of the person.
        frames: Number of frames with 2, 3, 4 and 5 fingers.
        day: 0 for the script of all finger sets, a later day for free play.
        rate: Rate (Hz) of the frames.
    """
    rng = np.random.default_rng(seed)
    size = drawn_size(rng)
    skeleton = drawn_skeleton(rng, size, f"drawn {size:.3f}")
    lean = POSTURE_LEAN * rng.normal(size=FREEDOMS)
    c = replace(first_configuration(rng), **_script(frames, rate))
    capture = subject.simulate(c, int(rng.integers(2**31)), day, skeleton=skeleton, lean=lean)
    capture.meta["size"] = size
    return capture


def second_configuration(rng: np.random.Generator) -> SecondConfiguration:
    """Draws the habits of a person of the second generator, and the errors of the sensors."""
    c = second_subject.FROZEN
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


def second_person(
    seed: list[int], frames: tuple[int, int, int, int], day: int, rate: float
) -> Capture:
    """Captures a person of the second generator; see `first_person` for the arguments."""
    rng = np.random.default_rng(seed)
    size = drawn_size(rng)
    hand = drawn_second_hand(rng, size, f"drawn {size:.3f}")
    lean = MANNER_LEAN * rng.normal(size=len(MANNERS))
    c = replace(second_configuration(rng), **_script(frames, rate))
    capture = second_subject.simulate(c, int(rng.integers(2**31)), day, hand=hand, lean=lean)
    capture.meta["size"] = size
    return capture


def _script(frames: tuple[int, int, int, int], rate: float) -> dict[str, Any]:
    """Settings of the frames, equal on the training day and on later days."""
    return {
        "training_frames": frames,
        "test_frames": frames,
        "training_rate": rate,
        "test_rate": rate,
        "five_finger_repeats": 4,
    }
