"""Random hands: bones of people of any size, for each generator of simulated people.

Hands of adults are 16.5 cm (5 % of women have smaller hands) to 21.1 cm long (5 % of men have
larger hands; Gordon and others 1989, anthropometric survey of the U.S. Army). This is 0.83 to 1.06
times the 20.0 cm of the trained hand. Sizes are drawn from a wider range. Finger lengths vary by 6
to 11 % about their mean (Chatzioglou, Pinar, Govsa 2024). The size of the hand explains about half
of this variation.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from models.arithmetic import Array
from models.frames import FINGERS
from models.rotations import exp
from models.skeleton import ADULT, Bone, Skeleton
from training.second_subject.hand import SLENDER, SecondHand

SIZES = (0.82, 1.18)
"""Least and greatest hand size relative to the trained hand."""

FINGER = 0.05
"""Spread of the logarithm of each finger's length."""

BONE = 0.03
"""Spread of the logarithm of each bone's length, in addition to that of its finger."""

KNUCKLE = (0.0015, 0.003, 0.003)
"""Spread (m) of a knuckle's place across, along and above the hand. A knuckle is about 20 mm from
its neighbour, and hands differ by 6 % in breadth."""

SADDLE = (0.087, 0.087, 0.0175)
"""Spread (rad) of the resting direction of a finger's first bone about its axes of flexion, twist
and abduction: 5, 5 and 1 degrees. The abduction determines how far apart people put down
neighbouring fingers. This distance differs little between people; see `population.NEIGHBOURS`."""

SADDLE_OF_THUMB = (0.087, 0.087, 0.087)
"""The same spread (rad) for the first bone of the thumb."""

HINGE = (0.035, 0.035, 0.0175)
"""The same spread (rad) for all other bones."""


def drawn_size(rng: np.random.Generator) -> float:
    """Size of a hand, uniform in its logarithm."""
    return float(np.exp(rng.uniform(*np.log(SIZES))))


def drawn_skeleton(rng: np.random.Generator, size: float, name: str) -> Skeleton:
    """Draws a hand of a given size, with random proportions."""
    fingers = np.exp(rng.normal(0, FINGER, len(FINGERS)))
    bones: list[Bone] = []
    previous = 0.0
    for bone in ADULT.scaled(size).bones:
        first = ADULT.first_bone[bone.finger] == len(bones)
        factor = float(fingers[bone.finger] * np.exp(rng.normal(0, BONE)))
        turn = exp(rng.normal(0, _spread(bone.finger, first)))
        place = size * rng.normal(0, KNUCKLE)
        x, y, z = (np.array(bone.anchor) + place).tolist() if first else (0.0, previous, 0.0)
        bones.append(
            replace(bone, anchor=(x, y, z), rest=bone.rest @ turn, length=bone.length * factor)
        )
        previous = bone.length * factor
    return Skeleton(name, tuple(bones), ADULT.palm_radius * size)


def drawn_second_hand(rng: np.random.Generator, size: float, name: str) -> SecondHand:
    """Draws a hand of a given size, with random proportions, for the second generator."""
    fingers = np.exp(rng.normal(0, FINGER, (len(FINGERS), 1)))
    bones = SLENDER.bones * size * fingers * np.exp(rng.normal(0, BONE, SLENDER.bones.shape))
    knuckle = size * (SLENDER.knuckle + rng.normal(0, KNUCKLE, SLENDER.knuckle.shape))
    spreads = [_spread(finger, True) for finger in range(len(FINGERS))]
    turns: Array = np.stack([exp(rng.normal(0, spread)) for spread in spreads])
    return replace(
        SLENDER,
        name=name,
        knuckle=knuckle,
        saddle=SLENDER.saddle @ turns,
        bones=bones,
        tip_radius=SLENDER.tip_radius * size,
    )


def _spread(finger: int, first: bool) -> tuple[float, float, float]:
    """Spread of a bone's resting direction about its axes x, y and z, rad."""
    if not first:
        return HINGE
    return SADDLE if finger else SADDLE_OF_THUMB
