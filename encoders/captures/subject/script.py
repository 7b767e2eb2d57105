"""The subject's tasks: a script of all finger sets on day 0, free play later."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from encoders.captures.subject.configuration import SubjectConfiguration
from encoders.captures.subject.gestures import GESTURES
from models.arithmetic import Array
from models.frames import FINGERS

SETS: tuple[tuple[int, ...], ...] = tuple(
    chosen for size in range(2, 6) for chosen in combinations(range(len(FINGERS)), size)
)
"""The 26 sets of 2 to 5 fingers. One finger alone was not captured: "inherent ambiguity"."""


@dataclass(frozen=True)
class Take:
    """One continuous recording.

    Attributes:
        down: (n, 5) booleans, touching fingers, frame by frame.
        amplitudes: (4,) share of every gesture.
        rate: Hz of the frames.
    """

    down: NDArray[np.bool_]
    amplitudes: Array
    rate: float

    @property
    def times(self) -> Array:
        """Times (n,) s from the take's beginning."""
        return np.arange(len(self.down)) / self.rate


def takes_of(day: int, rng: np.random.Generator, configuration: SubjectConfiguration) -> list[Take]:
    """The takes of a day."""
    return _script(rng, configuration) if day == 0 else _free_play(rng, configuration)


def _script(rng: np.random.Generator, configuration: SubjectConfiguration) -> list[Take]:
    """Every finger set with every gesture: a missing set could not be reconstructed later."""
    c = configuration
    takes = []
    for size, frames in zip(range(2, 6), c.training_frames, strict=True):
        repeats = c.five_finger_repeats if size == len(FINGERS) else 1
        clips = [
            (fingers, gesture)
            for _ in range(repeats)
            for fingers in SETS
            if len(fingers) == size
            for gesture in range(len(GESTURES))
        ]
        bounds = np.linspace(0, frames, len(clips) + 1).round().astype(int)
        for (fingers, gesture), length in zip(clips, np.diff(bounds), strict=True):
            amplitudes = c.aside * rng.uniform(0, 1, len(GESTURES))
            amplitudes[gesture] = 1.0
            down = np.zeros((length, len(FINGERS)), bool)
            down[:, fingers] = True
            takes.append(Take(down, amplitudes, c.training_rate))
    return takes


def _free_play(rng: np.random.Generator, configuration: SubjectConfiguration) -> list[Take]:
    """Free play, as with clay: mixed gestures, with fingers landing and lifting at any time.

    Stretches with one set follow each other until the day's frames of every set size are used up;
    within a take, neighbouring stretches differ by one or two fingers.
    """
    c = configuration
    left = dict(zip(range(2, 6), c.test_frames, strict=True))
    takes: list[Take] = []
    stretches: list[tuple[tuple[int, ...], int]] = []
    length = 0
    current: tuple[int, ...] | None = None
    wanted = rng.exponential(c.take_length)
    while any(left.values()):
        following = _next_set(rng, current, left, c)
        if stretches and (following is None or length / c.test_rate > wanted):
            takes.append(_free_take(rng, stretches, c))
            stretches, length, current = [], 0, None
            wanted = 0.5 * c.take_length + rng.exponential(0.5 * c.take_length)
            continue
        assert following is not None
        frames = min(int(rng.uniform(*c.stay) * c.test_rate), left[len(following)])
        # No remainder too short to be seen is left.
        if left[len(following)] - frames < c.stay[0] * c.test_rate:
            frames = left[len(following)]
        left[len(following)] -= frames
        length += frames
        stretches.append((following, frames))
        current = following
    takes.append(_free_take(rng, stretches, c))
    return takes


def _next_set(
    rng: np.random.Generator,
    current: tuple[int, ...] | None,
    left: dict[int, int],
    configuration: SubjectConfiguration,
) -> tuple[int, ...] | None:
    """A set that may follow, or None; more likely if natural and if many frames of its size
    remain."""
    weights = np.zeros(len(SETS))
    for i, fingers in enumerate(SETS):
        changes = 1 if current is None else len(set(fingers) ^ set(current))
        if 1 <= changes <= 2:
            alike = sum(len(s) == len(fingers) for s in SETS)
            weights[i] = _naturalness(fingers) ** configuration.natural * left[len(fingers)] / alike
    if not weights.any():
        return None
    return SETS[rng.choice(len(SETS), p=weights / weights.sum())]


def _naturalness(fingers: tuple[int, ...]) -> float:
    """Naturalness of a finger set: higher with the index finger and without gaps between fingers.

    Two or three fingers touch with the thumb, because they pinch; four rather swipe without it.
    """
    others = [f for f in fingers if f > 0]
    gaps = others[-1] - others[0] + 1 - len(others)
    with_thumb = 2.0 if len(fingers) <= 3 else 1.0
    return (with_thumb if 0 in fingers else 1.0) * (2.0 if 1 in fingers else 1.0) / (1 + gaps)


def _free_take(
    rng: np.random.Generator,
    stretches: list[tuple[tuple[int, ...], int]],
    configuration: SubjectConfiguration,
) -> Take:
    down = np.concatenate(
        [
            np.tile(np.isin(np.arange(len(FINGERS)), fingers), (frames, 1))
            for fingers, frames in stretches
        ]
    )
    mixture = rng.dirichlet(np.full(len(GESTURES), configuration.free_style))
    # The largest share of a mixture of four is about a half on average.
    amplitudes = np.minimum(1.0, configuration.free_amplitude * mixture)
    return Take(down, amplitudes, configuration.test_rate)
