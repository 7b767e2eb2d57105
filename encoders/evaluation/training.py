"""Methods by name, trained on a capture."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np

from encoders.capture import Capture
from encoders.discovery import guarded, is_place
from encoders.encoder import Encoder
from encoders.evaluation.best import CANDIDATES, Best, builtin_best, train_best
from encoders.evaluation.methods import EncoderMethod, Method
from encoders.labels.labelling import Labeller, PaperLabels
from encoders.regression.mean import MeanEncoder
from encoders.regression.registry import ENCODERS, find_encoder, is_external
from encoders.regression.stored_encoder import predicted
from encoders.regression.trained import TrainedModel, load_model
from models.errors import EncoderError
from models.pose import POSE_SIZE

Progress = Callable[[float], None]

LEAST_SQUARES = {
    "linear": "linear",
    "quadratic": "quadratic",
    "cubic": "cubic",
    "paper": "quadratic",
}
"""The paper's encoders by plain least squares, as there. `paper` is its method: the quadratic."""

NAMES = (*LEAST_SQUARES, "pca-ik", "mean", "best")
"""Methods that can be trained by name."""

_EXPECTED = ", ".join(NAMES) + ", a FILE.npz made by `sandbox train`, or FILE.py:CLASS"


@dataclass(frozen=True)
class Training:
    """Training data of methods.

    Attributes:
        capture: Labelled contacts and poses.
        shipped: True for the capture of the shipped models, which then need not be trained again.
    """

    capture: Capture
    shipped: bool = False

    def method(self, name: str, progress: Progress | None = None) -> Method:
        """A method of `NAMES`, a model's file or an encoder that is not ours, ready for use.

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
            return self._fitted(_shown(name), find_encoder(name))
        if name == "best":
            return self._best(progress)
        if Path(name).suffix == ".npz":
            model = load_model(Path(name))
            paper = PaperLabels(model)
            if model.correction is not None:
                return CorrectedMethod(Path(name).stem, Best(model), paper)
            return EncoderMethod(Path(name).stem, model.encoder, lambda: paper)
        raise EncoderError(
            "no such encoder",
            where="--encoders",
            got=name,
            expected=_EXPECTED,
        )

    def _fitted(self, name: str, fresh: type[Encoder], metric: str = "joints") -> EncoderMethod:
        """An encoder with the paper's labelling rule, which has no history and so is shared."""
        model = self._model(fresh())
        paper = PaperLabels(model, metric)
        return EncoderMethod(name, model.encoder, lambda: paper, fresh=fresh)

    def _model(self, encoder: Encoder) -> TrainedModel:
        U, Q = self._inputs
        with guarded("the encoder cannot learn", type(encoder).__qualname__):
            # Copies: other encoders learn from the same frames afterwards.
            encoder.fit(U.copy("K"), Q.copy("K"))
        predicted(encoder, U[:1])
        return TrainedModel("", encoder, np.eye(POSE_SIZE), U, Q)

    @cached_property
    def _inputs(self) -> tuple[np.ndarray, np.ndarray]:
        return self.capture.u, self.capture.relative

    def _best(self, progress: Progress | None) -> Method:
        best = builtin_best() if self.shipped else train_best(self.capture, progress)
        return BestMethod(best)


class BestMethod:
    """The method `best`, which has history and so is more than an encoder; its encoder is tested
    alone."""

    def __init__(self, best: Best, name: str = "best") -> None:
        self.name, self.history = name, True
        self.encoder: Encoder | None = best.model.encoder
        self.fresh: Callable[[], Encoder] | None = CANDIDATES.get(best.model.meta.get("winner", ""))
        self.estimate = best.estimate
        self._best = best

    def labeller(self) -> Labeller:
        """See `Method.labeller`."""
        return self._best.labeller()


class CorrectedMethod(BestMethod):
    """A model from a file; it has no belief, so labels follow the paper's rule."""

    def __init__(self, name: str, best: Best, labeller: Labeller) -> None:
        super().__init__(best, name)
        # Nobody knows on what it was trained, and how, so that it cannot be trained anew.
        self.fresh = None
        self.history, self._labeller = False, labeller

    def labeller(self) -> Labeller:
        """See `Method.labeller`."""
        return self._labeller


def _shown(name: str) -> str:
    """Name of a method in tables: a file's stem, or the class of an encoder at a place."""
    if is_place(name):
        return find_encoder(name).__qualname__
    return Path(name).stem if Path(name).suffix == ".npz" else name


def check_names(names: tuple[str, ...]) -> None:
    """Checks a list of methods before the evaluation starts.

    Raises:
        EncoderError: One is unknown, or occurs twice.
    """
    for name in names:
        path = Path(name)
        if name in NAMES:
            continue
        if is_external(name):
            find_encoder(name)
            continue
        if path.suffix != ".npz":
            raise EncoderError(
                "no such encoder",
                where="--encoders",
                got=name,
                expected=_EXPECTED,
            )
        if not path.is_file():
            raise EncoderError("no such file", where="--encoders", got=name)
    shown = [_shown(name) for name in names]
    twice = sorted({n for n in shown if shown.count(n) > 1})
    if twice or not names:
        raise EncoderError(
            "every encoder is evaluated once" if twice else "no encoder to evaluate",
            where="--encoders",
            got=", ".join(twice) or None,
        )
