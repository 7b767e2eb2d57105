"""Methods under evaluation: a pose estimate from labelled touches, and a labeller."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from encoders.encoder import Encoder
from encoders.input_vector import contact_vectors
from encoders.labels.labelling import Labeller
from models.arithmetic import Array
from models.pose import absolute_pose


class Method(Protocol):
    """A method under evaluation.

    Attributes:
        name: Name in tables and files.
        history: True if its labeller uses a take's earlier frames.
        encoder: Encoder that predicts relative poses (n, 48) from contact vectors (n, 15), for a
            method that consists of it alone; such a method is also timed by single calls and tested
            for overfitting.
        fresh: Creates such an encoder, untrained.
    """

    name: str
    history: bool
    encoder: Encoder | None
    fresh: Callable[[], Encoder] | None

    def estimate(self, time: Array, trial: NDArray[np.int64], xy: Array) -> Array:
        """Estimates poses of all frames; the state is reset at every new trial.

        Args:
            time: (T,) s.
            trial: (T,) take of every frame.
            xy: (T, 5, 2) m on the surface by label, NaN where lifted.

        Returns:
            Poses (T, 48) in the 3-D surface frame.
        """

    def labeller(self) -> Labeller:
        """A labeller without contacts."""


@dataclass
class EncoderMethod:
    """A method that encodes every frame separately, with a labeller; see `Method`."""

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
