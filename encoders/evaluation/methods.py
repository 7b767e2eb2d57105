"""What is evaluated: a way from labelled touches to poses, and a way from touches to labels."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from encoders.encoder import Encoder
from encoders.input_vector import contact_vectors
from encoders.labels.labelling import Labeller
from models.pose import absolute_pose

Array = NDArray[np.float64]


class Method(Protocol):
    """A method under evaluation.

    Attributes:
        name: In tables and files.
        history: Whether its labeller remembers a take's earlier frames.
        encoder: What it predicts relative poses (n, 48) from contact vectors (n, 15) with, if it is
            nothing but that; it is then also timed by single calls, and tested for overfitting.
        fresh: Makes such an encoder that has learned nothing.
    """

    name: str
    history: bool
    encoder: Encoder | None
    fresh: Callable[[], Encoder] | None

    def estimate(self, time: Array, trial: NDArray[np.int64], xy: Array) -> Array:
        """Poses of all frames; whatever is remembered is forgotten at every new trial.

        Args:
            time: (T,) s.
            trial: (T,) take of every frame.
            xy: (T, 5, 2) m on the surface by label, NaN where lifted.

        Returns:
            (T, 48) in the 3-D surface frame.
        """

    def labeller(self) -> Labeller:
        """A labeller that knows of no contact yet."""


@dataclass
class EncoderMethod:
    """An encoder that takes every frame by itself, with a labeller; see `Method`."""

    name: str
    encoder: Encoder | None
    make_labeller: Callable[[], Labeller]
    history: bool = False
    fresh: Callable[[], Encoder] | None = None

    def estimate(self, time: Array, trial: NDArray[np.int64], xy: Array) -> Array:
        """See `Method.estimate`."""
        assert self.encoder is not None
        u, leftmost = contact_vectors(xy)
        return absolute_pose(self.encoder.predict(u), leftmost)

    def labeller(self) -> Labeller:
        """See `Method.labeller`."""
        return self.make_labeller()
