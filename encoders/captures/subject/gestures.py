"""Gestures as smooth paths of fingertips, and the takes of a day: all finger sets or free play."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from encoders.captures.subject.configuration import SubjectConfiguration
from models.arithmetic import Array
from models.frames import FINGERS
from models.surface import Surface

GESTURES = ("move", "grasp", "pinch", "rotate")
"""The paper's gestures: "moving, grasping, pinching, and rotating motions" (section 4)."""

MARGIN = 0.006
"""Least distance (m) of a touching fingertip from the screen's edge: half the width of a touch,
since a screen reports only touches that lie wholly on it."""

_COMPONENTS = 24
"""Number of waves in a smooth noise; enough for its values to be nearly normal."""

_PUSHES = 8
"""Number of rounds that push fingertips apart. Five fingertips in a row are then at the right
distances, within 1 mm."""

_THUMB = 0


@dataclass(frozen=True)
class Path:
    """Intended positions of the touches in n frames.

    Attributes:
        turn: (n,) rad, rotation of the layout, counterclockwise seen from above.
        place: (n, 2) m, position of the natural layout's origin, 3-D surface frame.
        targets: (n, 5, 2) m, positions of all fingertips, touching or not, 3-D surface frame.
    """

    turn: Array
    place: Array
    targets: Array


def smooth_noise(
    rng: np.random.Generator, times: Array, timescale: float, shape: tuple[int, ...]
) -> Array:
    """Independent smooth noises (n, *shape) of variance 1.

    Each noise is a sum of waves of random frequency. Such a sum can be sampled at any times, so the
    same movement may be recorded at any rate. Frequencies are heavy-tailed, as those of a Matern
    3/2 process.
    """
    frequency = rng.standard_t(3, (_COMPONENTS, *shape)) / timescale
    phase = rng.uniform(0, 2 * np.pi, (_COMPONENTS, *shape))
    t = times.reshape(-1, 1, *(1 for _ in shape))
    return np.sqrt(2 / _COMPONENTS) * np.cos(frequency * t + phase).sum(axis=1)


def strokes(
    rng: np.random.Generator,
    times: Array,
    swing: tuple[float, float],
    variety: tuple[float, float],
) -> Array:
    """A movement (n,) to and fro between about -1 and 1.

    Every stroke is a minimum-jerk movement with rest at both ends, like the movement of a person's
    hand between two points (Flash and Hogan 1985).

    Args:
        rng: Source of randomness.
        times: (n,) s.
        swing: Least and greatest duration (s) of a stroke.
        variety: Least and greatest distance of a stroke's end from 0.
    """
    count = int(np.ceil((times[-1] - times[0]) / swing[0])) + 2
    ends = times[0] + np.concatenate([[0.0], np.cumsum(rng.uniform(*swing, count))])
    ends -= rng.uniform(0, swing[0])
    side = rng.choice([-1.0, 1.0]) * (-1.0) ** np.arange(count + 1)
    points = side * rng.uniform(*variety, count + 1)
    i = np.clip(np.searchsorted(ends, times, side="right") - 1, 0, count - 1)
    s = np.clip((times - ends[i]) / (ends[i + 1] - ends[i]), 0, 1)
    share = s**3 * (10 - 15 * s + 6 * s**2)
    return points[i] + share * (points[i + 1] - points[i])


def path(
    rng: np.random.Generator,
    times: Array,
    amplitudes: Array,
    fingers: NDArray[np.bool_],
    layout: Array,
    surface: Surface,
    configuration: SubjectConfiguration,
) -> Path:
    """A take's path.

    Args:
        rng: Source of the take's randomness.
        times: (n,) s.
        amplitudes: (4,) share of each gesture of `GESTURES`.
        fingers: (5,) booleans, fingers that touch at some time in the take. Only these stay on the
            screen, and pinches close between them.
        layout: (5, 2) m, natural positions of the fingertips relative to their middle.
        surface: The screen.
        configuration: Amplitudes of the gestures.
    """
    c = configuration

    def to_and_fro() -> Array:
        return strokes(rng, times, c.swing, c.variety)

    move, grasp, pinch, rotate = amplitudes
    turn = np.clip(rotate * c.turn * to_and_fro(), -c.greatest_turn, c.greatest_turn)
    way = move * c.move * np.stack([to_and_fro(), to_and_fro()], axis=-1)
    span = np.clip(1 + grasp * c.grasp * (to_and_fro() - c.grasp_closed), 0.45, c.widest)
    closing = np.clip(0.5 * pinch * c.pinch * (c.pinch_closed + to_and_fro()), c.pinch_least, 0.8)

    tips = span[:, None, None] * layout
    tips = tips + c.placing * rng.normal(size=(len(FINGERS), 2))
    tips = tips + c.wobble * smooth_noise(rng, times, 0.4, (len(FINGERS), 2))
    tips = _apart(_pinched(tips, closing, fingers), c.tip_width)
    cos, sin = np.cos(turn), np.sin(turn)
    rotation = np.stack([np.stack([cos, -sin], -1), np.stack([sin, cos], -1)], -2)
    tips = tips @ np.swapaxes(rotation, -1, -2)
    place = _on_screen(way, tips, fingers, surface)
    return Path(turn, place, tips + place[:, None, :])


def _pinched(tips: Array, closing: Array, fingers: NDArray[np.bool_]) -> Array:
    """Moves thumb and fingers towards each other by the share `closing` (n,) of their distance.

    If the thumb or all other fingers do not touch, the fingers close on the middle of those that
    touch.
    """
    others = fingers.copy()
    others[_THUMB] = False
    opposed = bool(fingers[_THUMB] and others.any())
    middle = tips[:, others if others.any() else fingers].mean(axis=1)
    out = tips.copy()
    if opposed:
        step = 0.5 * closing[:, None] * (middle - tips[:, _THUMB])
        out[:, _THUMB] += step
        out[:, 1:] -= step[:, None]
    else:
        out[:, 1:] += 0.6 * closing[:, None, None] * (middle[:, None] - tips[:, 1:])
    return out


def _apart(tips: Array, width: float) -> Array:
    """Pushes fingertips (n, 5, 2) m apart to a distance of at least `width` (m)."""
    tips = tips.copy()
    pairs = list(combinations(range(tips.shape[1]), 2))
    for _ in range(_PUSHES):
        for a, b in pairs:
            between = tips[:, b] - tips[:, a]
            distance = np.maximum(np.linalg.norm(between, axis=1, keepdims=True), 1e-6)
            push = 0.5 * np.maximum(width - distance, 0.0) * between / distance
            tips[:, a] -= push
            tips[:, b] += push
    return tips


def _on_screen(way: Array, tips: Array, fingers: NDArray[np.bool_], surface: Surface) -> Array:
    """Positions (n, 2) m of the layout that follow `way` and keep touching fingertips on the
    screen.

    A layout that is too large for the screen is centred on it.
    """
    size = surface.size
    middle = np.array([size[0] / 2, -size[1] / 2])
    low, high = tips[:, fingers].min(axis=1), tips[:, fingers].max(axis=1)
    free = size / 2 - MARGIN
    least, most = middle - free - low, middle + free - high
    # The middle of the layout, not its origin, stays near the screen's middle.
    place = middle + way - 0.5 * (low + high)
    inside = np.clip(place, np.minimum(least, most), np.maximum(least, most))
    return np.where(most >= least, inside, 0.5 * (least + most))


SETS: tuple[tuple[int, ...], ...] = tuple(
    chosen for size in range(2, 6) for chosen in combinations(range(len(FINGERS)), size)
)
"""The 26 sets of 2 to 5 fingers. The paper did not capture single fingers, because of their
"inherent ambiguity"."""


@dataclass(frozen=True)
class Take:
    """One continuous recording.

    Attributes:
        down: (n, 5) booleans, touching fingers, frame by frame.
        amplitudes: (4,) share of each gesture of `GESTURES`.
        rate: Rate (Hz) of the frames.
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
    """Takes of every finger set with every gesture, since an encoder cannot reconstruct a set that
    it did not learn."""
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
    """Takes of free play, as with clay: mixed gestures, with fingers landing and lifting at any
    time.

    A take consists of stretches with one finger set each. Neighbouring stretches differ by one or
    two fingers. Stretches are added until the day has its number of frames for every number of
    fingers.
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
        # A remainder shorter than the least stay is added to the stretch.
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
    """Draws the next finger set; None if no set can follow.

    Natural sets are more likely, and so are sets whose number of fingers has many remaining frames.
    """
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

    Sets of two or three fingers are more natural with the thumb, since they pinch. For larger sets
    the thumb makes no difference.
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
    # Of the four shares of a mixture, the largest is about a half on average.
    amplitudes = np.minimum(1.0, configuration.free_amplitude * mixture)
    return Take(down, amplitudes, configuration.test_rate)
