"""Random layouts of touches, with the distances and directions that were measured on tablets.

These people have no bones, postures or movement. Neighbouring fingertips lie on an arc, with the
distances and directions of real fingertips (`population.NEIGHBOURS`). In 326 pinches of 19 real
people, the 5, 50 and 95 percent quantiles of the direction from thumb to finger were 16, 42 and 72
degrees, and those of the opening 45, 60 and 85 mm. The drawn layouts vary somewhat more than the
real layouts, which come from few people and gestures. The labeller is trained on these layouts and
on the simulated people. The layouts are used neither to train poses nor to judge models.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from encoders.captures.subject.gestures import SETS
from models.arithmetic import Array
from models.frames import FINGERS
from training.population.hands import drawn_size

FRAMES = (120, 100, 60, 60)
"""Numbers of a person's layouts in which 2, 3, 4 and 5 fingers touch."""

_GAPS, _GAPS_OF_PEOPLE, _GAPS_OF_LAYOUTS = (29.0, 23.0, 31.0), (2.0, 1.6, 2.6), (2.2, 1.8, 2.8)
"""Distances (mm) from index to middle, middle to ring, and ring to little finger: mean, standard
deviation over people, and standard deviation over a person's layouts."""

_ARC, _ARC_OF_PEOPLE, _ARC_OF_LAYOUTS = (18.0, -12.0, -42.0), (9.0, 8.0, 10.0), (9.0, 8.0, 10.0)
"""Directions (degrees) of these three lines: mean, standard deviation over people, and standard
deviation over a person's layouts. The middle finger reaches farthest."""

_LEAST_GAP = 13.0
"""Least distance (mm) between neighbouring fingertips, so that they do not overlap."""

_OPENINGS = (22.0, 110.0)
"""Least and greatest distance (mm) of the thumb from the index finger."""


@dataclass(frozen=True)
class SurfacePerson:
    """Layouts of a person, one per frame.

    Attributes:
        xy: (T, 5, 2) m, touches by finger in the frame of a right hand, y towards the person; NaN
            for fingers that do not touch.
        down: True (T, 5) for touching fingers.
    """

    xy: Array
    down: NDArray[np.bool_]

    def __len__(self) -> int:
        return len(self.xy)


def surface_person(seed: list[int], frames: tuple[int, int, int, int] = FRAMES) -> SurfacePerson:
    """Draws a person's layouts.

    Args:
        seed: Seed of the person.
        frames: Numbers of layouts in which 2, 3, 4 and 5 fingers touch.
    """
    rng = np.random.default_rng(seed)
    size = drawn_size(rng)
    gaps = rng.normal(_GAPS, _GAPS_OF_PEOPLE)
    arc = rng.normal(_ARC, _ARC_OF_PEOPLE)
    opening, direction, yaw = rng.normal((54.0, 42.0, 0.0), (5.0, 10.0, 8.0))
    n, count = sum(frames), np.repeat((2, 3, 4, 5), frames)
    down = _down(rng, count)
    wide = np.where(rng.random((n, 1)) < 0.15, np.exp(rng.uniform(0, 0.5, (n, 1))), 1.0)
    spread = wide * np.exp(rng.normal(0, 0.12, (n, 1)))
    lengths = np.maximum(gaps * spread + rng.normal(0, _GAPS_OF_LAYOUTS, (n, 3)), _LEAST_GAP)
    bend = rng.normal(0, 6.0, (n, 1)) + rng.normal(arc, _ARC_OF_LAYOUTS, (n, 3))
    # Pinches open and turn more than whole hands.
    few = count < 4
    opened = np.exp(rng.normal(np.where(few, 0.1, 0.0), np.where(few, 0.25, 0.12)))
    z = np.zeros((n, len(FINGERS)), complex)
    z[:, 2:] = np.cumsum(lengths * np.exp(1j * np.deg2rad(bend)), axis=1)
    reach = np.deg2rad(rng.normal(direction, np.where(few, 14.0, 10.0)))
    z[:, 0] = -np.clip(opening * opened, *_OPENINGS) * np.exp(1j * reach)
    turned = np.where(rng.random(n) < 0.1, rng.normal(0, 30.0, n), 0.0)
    turn = np.deg2rad(yaw + rng.normal(0, 10.0, n) + turned)
    z *= (1e-3 * size * np.exp(1j * turn))[:, None]
    xy = np.stack([z.real, -z.imag], axis=-1) + rng.normal(0, 0.0006, (n, len(FINGERS), 2))
    return SurfacePerson(np.where(down[..., None], xy, np.nan), down)


def _down(rng: np.random.Generator, count: NDArray[np.int64]) -> NDArray[np.bool_]:
    """Touching fingers (T, 5), given their number (T,). All sets with this number of fingers have
    equal probability."""
    down = np.zeros((len(count), len(FINGERS)), bool)
    for row, number in zip(down, count.tolist(), strict=True):
        sets = [fingers for fingers in SETS if len(fingers) == number]
        row[list(sets[rng.integers(len(sets))])] = True
    return down
