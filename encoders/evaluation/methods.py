"""Methods under evaluation, by name. A method has a labeller and estimates poses from touches."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Protocol, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from encoders.capture import Capture
from encoders.encoder import Encoder
from encoders.evaluation.person_model import CANDIDATES, PersonEstimate, person_model
from encoders.input_vector import contact_vectors
from encoders.labels.belief import builtin_population_belief
from encoders.labels.labelling import Labeller
from encoders.labels.paper import PaperLabels
from encoders.regression.encoder_registry import (
    ENCODER_PLUGINS,
    ENCODERS,
    find_encoder,
    is_external,
)
from encoders.regression.trained import TrainedModel, load_model
from encoders.regression.training import predicted
from models.arithmetic import Array
from models.errors import EncoderError, InputError, unknown_name
from models.pose import POSE_SIZE, absolute_pose


class Method(Protocol):
    """A method under evaluation.

    Attributes:
        name: Name in tables and files.
        history: True if its labeller uses a take's earlier frames.
        encoder: Encoder of the method, whose predictions are timed by single calls and in batches.
            None times the whole method.
        fresh: Creates an untrained encoder for the test of overfitting; None leaves the test out.
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


Progress = Callable[[float], None]

LEAST_SQUARES = {
    "linear": "linear",
    "quadratic": "quadratic",
    "cubic": "cubic",
    "paper": "quadratic",
}
"""The paper's encoders, fitted by plain least squares as in the paper. `paper` is the paper's
own method, which is quadratic."""

TRAINED = "trained"
"""Name of the model that `sandbox train` makes from the training data, with the shipped
labeller."""

NAMES = (*LEAST_SQUARES, "pca-ik", "mean", TRAINED)
"""Methods that can be trained by name."""


def _unknown(name: str) -> InputError:
    """The error for the name of an unknown encoder."""
    others = "a FILE.npz made by `sandbox train`, or FILE.py:CLASS"
    what, where = "no such encoder", "--encoders"
    return unknown_name(what, name, NAMES, where=where, others=others, kind=EncoderError)


@dataclass(frozen=True)
class Training:
    """Training data of methods.

    Attributes:
        capture: Labelled contacts and poses.
    """

    capture: Capture

    def method(self, name: str, progress: Progress | None = None) -> Method:
        """Creates and trains a method by name: a name in `NAMES`, a model's file, or an external
        encoder.

        Raises:
            EncoderError: The method or file does not exist, or cannot be trained on this capture.
        """
        if name in LEAST_SQUARES:
            return self._fitted(name, ENCODERS[LEAST_SQUARES[name]])
        if name == "pca-ik":
            return self._fitted(name, ENCODERS[name], metric="touches")
        if name == "mean":
            return self._fitted(name, MeanEncoder, metric="touches")
        if is_external(name):
            return self._fitted(_table_name(name), find_encoder(name))
        if name == TRAINED:
            model = person_model(self.capture, progress)
            fresh = CANDIDATES[model.meta["winner"]]
            return PersonMethod(name, model, builtin_population_belief, history=True, fresh=fresh)
        if Path(name).suffix == ".npz":
            model = load_model(Path(name))
            paper = PaperLabels(model)
            if model.correction is not None:
                return PersonMethod(Path(name).stem, model, lambda: paper)
            return EncoderMethod(Path(name).stem, model.encoder, lambda: paper)
        raise _unknown(name)

    def _fitted(self, name: str, fresh: type[Encoder], metric: str = "joints") -> EncoderMethod:
        """A trained encoder with the paper's labelling rule. The rule has no history, so all calls
        of `labeller` return the same object."""
        model = self._model(fresh())
        paper = PaperLabels(model, metric)
        return EncoderMethod(name, model.encoder, lambda: paper, fresh=fresh)

    def _model(self, encoder: Encoder) -> TrainedModel:
        U, Q = self._inputs
        with ENCODER_PLUGINS.guarded(type(encoder).__qualname__, "the encoder cannot learn"):
            # Copies protect the frames, from which other encoders learn afterwards.
            encoder.fit(U.copy("K"), Q.copy("K"))
        predicted(encoder, U[:1])
        return TrainedModel("", encoder, np.eye(POSE_SIZE), U, Q)

    @cached_property
    def _inputs(self) -> tuple[np.ndarray, np.ndarray]:
        return self.capture.u, self.capture.relative


class PersonMethod(EncoderMethod):
    """A model of one person. Its poses are corrected by the person's bones and smoothed. Only its
    encoder is timed and tested for overfitting."""

    def __init__(
        self,
        name: str,
        model: TrainedModel,
        make_labeller: Callable[[], Labeller],
        history: bool = False,
        fresh: Callable[[], Encoder] | None = None,
    ) -> None:
        super().__init__(name, model.encoder, make_labeller, history, fresh)
        self._estimate = PersonEstimate(model)

    def estimate(self, time: Array, trial: NDArray[np.int64], xy: Array) -> Array:
        """See `Method.estimate`."""
        return self._estimate.estimate(time, trial, xy)


def _table_name(name: str) -> str:
    """Name of a method in tables: the stem of a model's file, the class in `FILE.py:CLASS`, or the
    name itself."""
    if ENCODER_PLUGINS.place_in(name) is not None:
        return find_encoder(name).__qualname__
    return Path(name).stem if Path(name).suffix == ".npz" else name


def check_names(names: tuple[str, ...]) -> None:
    """Checks a list of methods before the evaluation starts.

    Raises:
        EncoderError: A method is unknown, or occurs twice.
    """
    for name in names:
        path = Path(name)
        if name in NAMES:
            continue
        if is_external(name):
            find_encoder(name)
            continue
        if path.suffix != ".npz":
            raise _unknown(name)
        if not path.is_file():
            raise EncoderError(
                "no such file",
                where="--encoders",
                got=name,
                expected="a FILE.npz made by `sandbox train`",
            )
    shown = [_table_name(name) for name in names]
    twice = sorted({n for n in shown if shown.count(n) > 1})
    if twice or not names:
        raise EncoderError(
            "an encoder is listed twice" if twice else "no encoder to evaluate",
            where="--encoders",
            got=", ".join(twice) or None,
            expected="every encoder once" if twice else "at least one encoder",
        )


class MeanEncoder(Encoder):
    """Predicts the mean training pose for any touches.

    Attributes:
        mean_: (n,) mean of the outputs.
    """

    mean_: Array

    def fit(self, U: ArrayLike, Q: ArrayLike) -> Self:
        """Learns the mean of outputs (T, n)."""
        self.mean_ = np.asarray(Q, float).mean(axis=0)
        return self

    def predict(self, U: ArrayLike) -> Array:
        """The mean (T, n) for inputs (T, width), or (n,) for one input."""
        return np.broadcast_to(self.mean_, (*np.shape(U)[:-1], len(self.mean_))).copy()
