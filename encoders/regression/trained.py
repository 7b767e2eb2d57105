"""Trained models: an encoder with the covariance of its errors and its training data.

The built-in models are trained on a capture of the *simulated* subject, not on people.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cache, cached_property
from hashlib import blake2b
from importlib.resources import files
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from encoders.capture import Capture
from encoders.encoder import Encoder
from encoders.input_vector import CONTACT_VECTOR_SIZE
from encoders.npz import read_npz, write_npz
from encoders.regression.least_squares import is_ridge, ridge_path
from encoders.regression.person_correction import PersonCorrection
from encoders.regression.polynomial import PolynomialEncoder
from encoders.regression.registry import ENCODER_PLUGINS, ENCODERS, origin_of
from encoders.regression.stored_encoder import (
    EXTERNAL,
    MODEL_ARRAYS,
    as_restored,
    class_of_origin,
    header_fields,
    predicted,
    restored,
)
from encoders.store import load_capture
from encoders.validation import FOLDS, error_product, robust_covariance, trial_folds
from models.arithmetic.arrays import Array
from models.errors import EncoderError
from models.plugins import place_of
from models.pose import BALL_JOINTS, POSE_SIZE
from models.skeleton import ADULT, Skeleton

SCHEMA = 2
"""Version of the file's layout."""

CAPTURED = frozenset(("time", "trial", "ids", "xy", "q"))
"""Arrays of a capture, which is easily taken for the model that is trained from it."""

_REMEDY = "`sandbox train --out FILE` makes a valid one"

RIDGES = (1e-4, 3e-4, 1e-3, 3e-3, 1e-2, 3e-2, 1e-1, 3e-1, 1.0, 3.0)
"""Candidate penalties for validation."""

POLYNOMIALS: dict[str, tuple[int, float | None]] = {
    "paper": (2, 0.0),
    "linear": (1, None),
    "quadratic": (2, None),
    "cubic": (3, None),
}
"""Name -> degree and ridge (None: chosen by validation) of the built-in polynomials."""

BUILTIN = tuple(POLYNOMIALS)
"""Names of the models trained on the built-in capture."""

POPULATION = "population"
"""Name of the built-in model for any person; `python -m training population` makes it."""


@dataclass(frozen=True)
class TrainedModel:
    """An encoder ready for use: `model.encoder.predict(u)` gives relative poses.

    Attributes:
        name: Name of a built-in model, such as `paper`, or a name of your own.
        encoder: The fitted encoder.
        residual_covariance: (48, 48) covariance of the relative pose's error, m and rad, on unseen
            trials.
        training_u: (T, 15) contact vectors of the training data.
        training_pose: (T, 48) relative poses of the training data.
        meta: Origin of the capture, simulated or not, degree and ridge; JSON values.
        correction: Correction of estimates of the captured person's pose by the touches. It does
            not apply to our hand, and no session uses it.
        personal_covariance: (48, 48) part of the covariance that stays the same for a person, in
            the frame that turns with the hand; None for a model of one person.
    """

    name: str
    encoder: Encoder
    residual_covariance: Array
    training_u: Array
    training_pose: Array
    meta: dict[str, Any] = field(default_factory=dict)
    correction: PersonCorrection | None = None
    personal_covariance: Array | None = None

    @cached_property
    def digest(self) -> str:
        """BLAKE2b over arrays and meta, hexadecimal; equal for equal models."""
        hash_ = blake2b(digest_size=16)
        for _, learned in sorted(self.encoder.arrays().items()):
            hash_.update(np.ascontiguousarray(learned).tobytes())
        arrays = [self.residual_covariance, self.training_u, self.training_pose]
        if self.correction is not None:
            variance = self.correction.tip_variance
            arrays += [_anchors(self.correction), _lengths(self.correction), variance]
        if self.personal_covariance is not None:
            arrays.append(self.personal_covariance)
        for array in arrays:
            hash_.update(np.ascontiguousarray(array, np.float32).tobytes())
        hash_.update(json.dumps(self.meta, sort_keys=True).encode())
        hash_.update(json.dumps(header_fields(self.encoder), sort_keys=True).encode())
        return hash_.hexdigest()


def train(capture: Capture, name: str, degree: int, ridge: float | None) -> TrainedModel:
    """Trains a polynomial encoder on a capture.

    Args:
        capture: Labelled contacts and poses.
        name: Name of the model.
        degree: 1, 2 or 3.
        ridge: Penalty; 0 is least squares, None chooses from `RIDGES` by cross-validation blocked
            by trial. (Random frames would leak, since neighbouring frames are nearly equal.)

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
        # Copies: a fit that subtracts means in place must not change the capture for others.
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
    """What `fit` returned.

    Raises:
        EncoderError: It is nothing.
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
    """Prediction errors (len(ridges), T, 48) of encoders that were not trained on the frame's
    trial."""
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


def single(array: Array) -> Array:
    """Values rounded to single precision."""
    return np.asarray(array, np.float32).astype(float)


def rounded(model: TrainedModel) -> TrainedModel:
    """The model as restored from a file, so that a saved model predicts the same bits."""
    training_u, training_pose = single(model.training_u), single(model.training_pose)
    covariance = single(model.residual_covariance)
    correction = model.correction
    if correction is not None:
        correction = replace(
            correction,
            skeleton=_skeleton(single(_anchors(correction)), single(_lengths(correction))),
            covariance=covariance,
            tip_variance=single(correction.tip_variance),
        )
    return replace(
        model,
        encoder=as_restored(model.encoder, training_u, training_pose),
        residual_covariance=covariance,
        training_u=training_u,
        training_pose=training_pose,
        meta=json.loads(json.dumps(model.meta)),
        correction=correction,
        personal_covariance=(
            None if model.personal_covariance is None else single(model.personal_covariance)
        ),
    )


def _anchors(correction: PersonCorrection) -> Array:
    return np.array([bone.anchor for bone in correction.skeleton.bones])


def _lengths(correction: PersonCorrection) -> Array:
    return np.array([bone.length for bone in correction.skeleton.bones])


def _skeleton(anchors: Array, lengths: Array) -> Skeleton:
    """The built-in skeleton with other joint anchors (14, 3) and lengths (14,), m."""
    bones = tuple(
        replace(bone, anchor=(float(a[0]), float(a[1]), float(a[2])), length=float(length))
        for bone, a, length in zip(ADULT.bones, anchors, lengths, strict=True)
    )
    return replace(ADULT, name=f"{ADULT.name}, fitted", bones=bones)


def save_model(model: TrainedModel, path: Path | str, training: bool = True) -> None:
    """Writes a model as npz without pickle: a JSON header, and arrays.

    Arrays of the model are in single precision, those of an external encoder as it returns them.

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
            "anchors": _anchors(model.correction),
            "lengths": _lengths(model.correction),
            "tip_variance": model.correction.tip_variance,
        }
    if model.personal_covariance is not None:
        arrays["personal"] = model.personal_covariance
    ours = {name: array.astype(np.float32) for name, array in arrays.items()}
    write_npz(Path(path), header, model.encoder.arrays() | ours)


def load_model(path: Path | str, capture: Capture | None = None) -> TrainedModel:
    """Reads a model; for an external encoder, also loads the code of its class.

    Args:
        path: The file.
        capture: Training capture, for files that do not contain it.

    Raises:
        EncoderError: The file is missing, damaged, of another version or breaks its contract, or
            the class of its encoder is not on this machine.
    """
    where = str(path)
    header, raw = read_npz(Path(path), None, EncoderError, "a trained model", _REMEDY)
    if raw.keys() >= CAPTURED:
        raise EncoderError(
            "this is a capture, from which a model is trained",
            where=where,
            expected="a trained model",
            remedy=f"`sandbox train --capture {path} --out MODEL.npz` makes one of it",
        )
    if header.get("schema") != SCHEMA:
        raise EncoderError(
            "the model has another version",
            where=where,
            got=header.get("schema"),
            expected=str(SCHEMA),
            remedy="`sandbox train` trains it again on its capture",
        )
    meta, distrust = header.get("meta"), header.get("distrust")
    if not isinstance(meta, dict) or not _is_distrust(distrust):
        raise EncoderError("the header is damaged", where=where, remedy=_REMEDY)
    wanted = ["covariance"]
    if capture is None:
        wanted += ["training_u", "training_pose"]
    if distrust is not None:
        wanted += ["anchors", "lengths", "tip_variance"]
    if "personal" in raw:
        wanted.append("personal")
    arrays = {name: _array(raw, name, where) for name in wanted}
    if capture is not None:
        arrays |= {"training_u": single(capture.u), "training_pose": single(capture.relative)}
    _check(arrays, where)
    learned = {name: array for name, array in raw.items() if name not in MODEL_ARRAYS}
    U, Q = arrays["training_u"], arrays["training_pose"]
    try:
        encoder = _stored_encoder(header, learned, U, Q)
    except EncoderError as error:
        raise EncoderError(
            error.what,
            where=f"{where}: {error.where}" if error.where else where,
            got=error.got,
            expected=error.expected,
            remedy=error.remedy if header.get("kind") == EXTERNAL else _REMEDY,
        ) from error
    correction = None
    if distrust is not None:
        bones = _skeleton(arrays["anchors"], arrays["lengths"])
        correction = PersonCorrection(
            bones, arrays["covariance"], arrays["tip_variance"], float(distrust)
        )
    return TrainedModel(
        str(header.get("name")),
        encoder,
        arrays["covariance"],
        U,
        Q,
        meta,
        correction,
        arrays.get("personal"),
    )


def _stored_encoder(
    header: Mapping[str, Any], learned: Mapping[str, NDArray[Any]], U: Array, Q: Array
) -> Encoder:
    """The encoder that a header describes.

    Raises:
        EncoderError: The header or the arrays are damaged, or the encoder's class has changed.
    """
    name: Any = header.get("kind")
    if name != EXTERNAL:
        kind = ENCODERS.get(name) if isinstance(name, str) else None
        if kind is None:
            raise EncoderError("the header is damaged", where="kind", got=str(name)[:80])
        options = {option: header.get(option) for option in kind().configuration()}
        return restored(kind, options, learned, U, Q)
    source, stored = header.get("from"), header.get("configuration")
    if not isinstance(source, dict) or not isinstance(stored, dict):
        raise EncoderError("the header is damaged", where="from, configuration")
    encoder = restored(class_of_origin(source), stored, learned, U, Q)
    if encoder.digest() != header.get("encoder"):
        raise EncoderError(
            "the encoder is not as it was stored: the file is damaged, or the class has changed",
            where=place_of(source),
            remedy="`sandbox train --encoder` trains it again",
        )
    return encoder


def _array(raw: Mapping[str, NDArray[Any]], name: str, where: str) -> Array:
    if name not in raw:
        raise EncoderError("an array is missing", where=where, expected=name, remedy=_REMEDY)
    if raw[name].dtype.kind != "f":
        raise EncoderError(
            "wrong type", where=f"{where}: {name}", expected="floating point", remedy=_REMEDY
        )
    return raw[name].astype(float)


def _is_distrust(value: Any) -> bool:
    """True for a valid `distrust` of a header, or none."""
    return value is None or (is_ridge(value) and value > 0)


def _check(arrays: Mapping[str, Array], where: str) -> None:
    frames = len(np.atleast_1d(arrays["training_u"]))
    shapes = {
        "covariance": (POSE_SIZE, POSE_SIZE),
        "personal": (POSE_SIZE, POSE_SIZE),
        "training_u": (frames, CONTACT_VECTOR_SIZE),
        "training_pose": (frames, POSE_SIZE),
        "anchors": (BALL_JOINTS, 3),
        "lengths": (BALL_JOINTS,),
        "tip_variance": (3,),
    }
    for name, array in arrays.items():
        if array.shape != shapes[name] or not frames:
            raise EncoderError(
                "wrong shape", where=f"{where}: {name}", got=array.shape, expected=str(shapes[name])
            )
        if not np.isfinite(array).all():
            raise EncoderError("values must be finite", where=f"{where}: {name}")
        if name in ("lengths", "tip_variance") and not (array > 0).all():
            raise EncoderError("values must be above 0", where=f"{where}: {name}")


@cache
def builtin_capture() -> Capture:
    """Capture of the simulated subject, on which all built-in models are trained."""
    return load_capture(builtin_folder() / "capture.npz")


@cache
def builtin(name: str) -> TrainedModel:
    """Loads a built-in model by name.

    Args:
        name: `paper`, `linear`, `quadratic`, `cubic` or `population`.

    Raises:
        EncoderError: The name is unknown.
    """
    if name == POPULATION:
        return load_model(builtin_folder() / f"{name}.npz")
    if name not in BUILTIN:
        known = ", ".join((*BUILTIN, POPULATION))
        raise EncoderError("no such encoder", got=name, expected=known)
    return load_model(builtin_folder() / f"{name}.npz", builtin_capture())


def builtin_folder() -> Path:
    """Folder of the built-in capture and models."""
    return Path(str(files("encoders") / "data"))
