"""Trains encoders on captures, checks that they can be stored, and writes the models.

`encoders.regression.trained` reads them.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from encoders.capture import Capture
from encoders.encoder import Encoder
from encoders.npz import write_npz
from encoders.regression.encoder_registry import ENCODER_PLUGINS, ENCODERS, builtin_name, origin_of
from encoders.regression.least_squares import ridge_path
from encoders.regression.polynomial import PolynomialEncoder
from encoders.regression.trained import (
    EXTERNAL,
    MODEL_ARRAYS,
    SCHEMA,
    TrainedModel,
    header_fields,
    restored,
    single,
    skeleton_of,
)
from encoders.validation import FOLDS, error_product, robust_covariance, trial_folds
from models.arithmetic import Array
from models.errors import EncoderError
from models.pose import POSE_SIZE

RIDGES = (1e-4, 3e-4, 1e-3, 3e-3, 1e-2, 3e-2, 1e-1, 3e-1, 1.0, 3.0)
"""Candidate penalties for validation."""

_SAME_POSE = 1e-3
"""Largest change of a pose (m or rad) that storing an encoder may cause."""

_TRIED = 100
"""Number of frames on which a restored encoder is tested."""


def train(capture: Capture, name: str, degree: int, ridge: float | None) -> TrainedModel:
    """Trains a polynomial encoder on a capture.

    Args:
        capture: Labelled contacts and poses.
        name: Name of the model.
        degree: 1, 2 or 3.
        ridge: Penalty; 0 is least squares, None chooses from `RIDGES` by cross-validation blocked
            by trial. (With random frames, test frames would hardly differ from training frames.)

    Raises:
        EncoderError: Degree or ridge is invalid, or the capture has only one trial.
    """
    U, Q = capture.u, capture.relative
    if ridge is None:
        candidates = _blocked_residuals(capture, degree, RIDGES)
        best = int(np.argmin([error_product(Q - e, Q) for e in candidates]))
        ridge, residuals = RIDGES[best], candidates[best]
    else:
        residuals = _blocked_residuals(capture, degree, [ridge])[0]
    meta = origin(capture) | {"degree": degree, "ridge": ridge}
    encoder = PolynomialEncoder(degree, ridge).fit(U, Q)
    return rounded(TrainedModel(name, encoder, robust_covariance(residuals), U, Q, meta))


def train_encoder(
    capture: Capture,
    name: str,
    make: Callable[[], Encoder],
    progress: Callable[[float], None] | None = None,
) -> TrainedModel:
    """Trains any encoder on a capture.

    Args:
        capture: Labelled contacts and poses.
        name: Name of the model.
        make: Creates an untrained encoder.
        progress: Called with the share done, 0 to 1.

    Raises:
        EncoderError: The encoder cannot learn, predict or be stored, or the capture has only one
            trial.
    """
    U, Q = capture.u, capture.relative
    residuals = Q - blocked_predictions(make, capture, progress=progress)
    with ENCODER_PLUGINS.guarded(name, "the encoder cannot learn"):
        # Copies protect the capture from a fit that changes its inputs.
        encoder = _itself(make().fit(U.copy("K"), Q.copy("K")), name)
    predicted(encoder, U[:1])
    covariance = robust_covariance(residuals)
    return rounded(TrainedModel(name, encoder, covariance, U, Q, origin(capture)))


def blocked_predictions(
    make: Callable[[], Encoder],
    capture: Capture,
    folds: int = FOLDS,
    progress: Callable[[float], None] | None = None,
) -> Array:
    """Relative poses (T, 48) predicted by encoders that were not trained on their trial.

    Args:
        make: Creates an untrained encoder.
        capture: Labelled contacts and poses.
        folds: Number of folds of the cross-validation.
        progress: Called with the share done, 0 to 1.

    Raises:
        EncoderError: The encoder cannot learn or predict, or the capture has only one trial.
    """
    U, Q = capture.u, capture.relative
    poses = np.empty((len(U), POSE_SIZE))
    fold = trial_folds(capture.trial, folds)
    for k in np.unique(fold):
        out = fold == k
        with ENCODER_PLUGINS.guarded("fit", "the encoder cannot learn"):
            encoder = _itself(make().fit(U[~out], Q[~out]), "fit")
        poses[out] = predicted(encoder, U[out])
        if progress:
            progress((k + 1) / (folds + 1))
    return poses


def _itself(fitted: Encoder | None, where: str) -> Encoder:
    """Returns the result of `fit` after checking it.

    Raises:
        EncoderError: The result is None.
    """
    if fitted is None:
        raise EncoderError(
            "`fit` did not return the encoder", where=where, remedy="End it with `return self`"
        )
    return fitted


def origin(capture: Capture) -> dict[str, Any]:
    """Fields of a model's `meta` that describe its training capture."""
    return {"simulated": bool(capture.meta.get("simulated", False)), "capture": capture.meta}


def _blocked_residuals(capture: Capture, degree: int, ridges: Sequence[float]) -> Array:
    """Prediction errors (len(ridges), T, 48) for every penalty, of encoders that were not trained
    on the frame's trial."""
    U, Q = capture.u, capture.relative
    fold = trial_folds(capture.trial)
    residuals = np.empty((len(ridges), *Q.shape))
    for k in np.unique(fold):
        out = fold == k
        encoder = PolynomialEncoder(degree, ridges[0]).fit(U[~out], Q[~out])
        coefs = [encoder.coef_]
        if len(ridges) > 1:
            coefs = list(ridge_path(encoder.terms(U[~out]), Q[~out], ridges))
        X = encoder.terms(U[out])
        for i, coef in enumerate(coefs):
            residuals[i, out] = Q[out] - X @ coef
    return residuals


def rounded(model: TrainedModel) -> TrainedModel:
    """Rounds a model as its file would, so that the saved model gives bit-identical predictions."""
    training_u, training_pose = single(model.training_u), single(model.training_pose)
    covariance = single(model.residual_covariance)
    correction = model.correction
    if correction is not None:
        correction = replace(
            correction,
            skeleton=skeleton_of(single(correction.anchors), single(correction.lengths)),
            covariance=covariance,
            tip_variance=single(correction.tip_variance),
        )
    return replace(
        model,
        encoder=_as_restored(model.encoder, training_u, training_pose),
        residual_covariance=covariance,
        training_u=training_u,
        training_pose=training_pose,
        meta=json.loads(json.dumps(model.meta)),
        correction=correction,
        personal_covariance=(
            None if model.personal_covariance is None else single(model.personal_covariance)
        ),
    )


def _as_restored(encoder: Encoder, U: Array, Q: Array) -> Encoder:
    """The encoder as restored from a file.

    Args:
        encoder: A fitted encoder.
        U: (T, 15) contact vectors of the training frames, in single precision.
        Q: (T, 48) relative poses of the training frames, in single precision.

    Raises:
        EncoderError: The encoder cannot be stored, or the restored encoder differs.
    """
    ours = builtin_name(encoder)
    if ours is not None:
        return restored(ENCODERS[ours], encoder.configuration(), encoder.arrays(), U, Q)
    kind = type(encoder)
    where = kind.__qualname__
    with ENCODER_PLUGINS.guarded(where, "the encoder cannot be stored"):
        options = json.loads(json.dumps(encoder.configuration(), allow_nan=False))
        arrays = encoder.arrays()
    _check_arrays(arrays, where)
    loaded = restored(kind, options, arrays, U, Q)
    with ENCODER_PLUGINS.guarded(where, "the encoder cannot be stored"):
        same = loaded.digest() == encoder.digest()
    some = U[:_TRIED]
    moved = np.abs(predicted(loaded, some) - predicted(encoder, some)).max()
    # An encoder without stored arrays is restored by fitting it again, to rounded frames.
    if not arrays:
        check_repeatable(loaded, restored(kind, options, arrays, U, Q), some)
    if not same or (arrays and moved > _SAME_POSE):
        raise EncoderError(
            "the encoder restored from its arrays differs from the original",
            where=where,
            got=f"poses that differ by up to {moved:.2g} m or rad" if same else "other arrays",
            remedy="restore must use everything that arrays and configuration return",
        )
    return loaded


def check_repeatable(first: Encoder, second: Encoder, U: Array) -> None:
    """Checks that two encoders fitted to equal frames predict equal poses.

    Args:
        first: First encoder.
        second: Second encoder.
        U: (T, 15) contact vectors for which both predict poses.

    Raises:
        EncoderError: The poses differ. A recording made with one encoder could not be replayed with
            the other.
    """
    difference = np.abs(predicted(first, U) - predicted(second, U)).max()
    if difference > _SAME_POSE:
        raise EncoderError(
            "two trainings on equal frames gave different encoders",
            where=f"{type(first).__qualname__}.fit",
            got=f"poses that differ by up to {difference:.2g} m or rad",
            remedy="Give random numbers a fixed seed, such as random_state=0 in scikit-learn",
        )


def predicted(encoder: Encoder, U: ArrayLike) -> Array:
    """Poses (T, 48) that an encoder predicts from contact vectors (T, 15), checked.

    Raises:
        EncoderError: The encoder fails, returns another type or shape, or changes its input, for
            many vectors or for one vector.
    """
    U = np.asarray(U, float)
    where = f"{type(encoder).__qualname__}.predict"
    for rows, shape in ((U[0], (POSE_SIZE,)), (U, (len(U), POSE_SIZE))):
        given = rows.copy("K")
        with ENCODER_PLUGINS.guarded(
            where, f"the encoder cannot predict from U of shape {rows.shape}"
        ):
            poses = np.asarray(encoder.predict(given), float)
        if not np.array_equal(given, rows):
            raise EncoderError(
                "the encoder changes its input",
                where=where,
                remedy="Write `U = U - mean`, not `U -= mean`: other code reads the same array",
            )
        if poses.shape != shape:
            raise EncoderError(
                "the encoder predicts poses of another shape",
                where=where,
                got=f"{poses.shape} for inputs {rows.shape}",
                expected=str(shape),
            )
        if not np.isfinite(poses).all():
            raise EncoderError(
                "the encoder predicts poses that are not finite",
                where=where,
                expected="48 finite numbers for every contact vector",
            )
    return poses


def save_model(model: TrainedModel, path: Path | str, training: bool = True) -> None:
    """Writes a model as npz without pickle: a JSON header, and arrays.

    Arrays of the model are in single precision; those of an external encoder are stored unchanged.

    Args:
        model: The model.
        path: The file.
        training: True writes the training data as well. Built-in models leave it out, since the
            package contains the built-in capture.

    Raises:
        EncoderError: The encoder cannot be stored.
    """
    header = {
        "schema": SCHEMA,
        "name": model.name,
        "meta": model.meta,
        **header_fields(model.encoder),
    }
    if header["kind"] == EXTERNAL:
        header["from"] = origin_of(type(model.encoder))
    arrays = {"covariance": single(model.residual_covariance)}
    if training:
        arrays |= {"training_u": model.training_u, "training_pose": model.training_pose}
    if model.correction is not None:
        header["distrust"] = model.correction.distrust
        arrays |= {
            "anchors": model.correction.anchors,
            "lengths": model.correction.lengths,
            "tip_variance": model.correction.tip_variance,
        }
    if model.personal_covariance is not None:
        arrays["personal"] = model.personal_covariance
    ours = {name: array.astype(np.float32) for name, array in arrays.items()}
    write_npz(Path(path), header, model.encoder.arrays() | ours)


def _check_arrays(arrays: Any, where: str) -> None:
    """Raises an error for arrays that cannot be written without pickle."""
    sound = isinstance(arrays, dict) and all(
        isinstance(name, str) and isinstance(array, np.ndarray) and array.dtype.kind in "biuf"
        for name, array in arrays.items()
    )
    if not sound:
        raise EncoderError(
            "the encoder does not store plain arrays",
            where=f"{where}.arrays",
            got=repr(arrays)[:80],
            expected="a dictionary of NumPy arrays of numbers by name",
        )
    odd = [name for name in arrays if name in MODEL_ARRAYS or not name.isidentifier()]
    if odd:
        raise EncoderError(
            "an array of the encoder has a reserved or invalid name",
            where=f"{where}.arrays",
            got=", ".join(odd),
            expected=f"an identifier other than {', '.join(MODEL_ARRAYS)}",
        )
