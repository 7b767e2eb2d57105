"""A trained encoder with what else it learned: how wrong it is, and what it was trained on.

The built-in models are trained on a capture of the *simulated* subject; none of them has seen a
person.
"""

from __future__ import annotations

import json
import zipfile
from dataclasses import dataclass, field
from functools import cache, cached_property
from hashlib import blake2b
from importlib.resources import files
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from encoders.capture import Capture
from encoders.contact_vector import CONTACT_VECTOR_SIZE
from encoders.polynomial import PolynomialEncoder
from encoders.store import load_capture
from models.errors import EncoderError
from models.pose import POSE_SIZE

Array = NDArray[np.float64]

SCHEMA = 1
"""Version of the file's layout."""

FOLDS = 10
"""Of the cross-validation blocked by trial."""

RIDGES = (1e-4, 3e-4, 1e-3, 3e-3, 1e-2, 3e-2, 1e-1, 3e-1, 1.0)
"""Penalties that validation chooses from."""

BUILTIN: dict[str, tuple[int, float | None]] = {
    "paper": (2, 0.0),
    "linear": (1, None),
    "quadratic": (2, None),
    "cubic": (3, None),
    "best": (2, None),
}
"""Name -> degree and ridge (None: chosen by validation) of the built-in models."""


@dataclass(frozen=True)
class TrainedModel:
    """An encoder ready for use.

    Attributes:
        name: `paper`, `best`, ... or its file's name.
        encoder: The fitted polynomial.
        residual_covariance: (48, 48) of the relative pose's error, m and rad, on trials that the
            encoder had not seen.
        training_u: (T, 15) contact vectors it was trained on.
        training_pose: (T, 48) relative poses it was trained on.
        meta: Where the capture came from, degree and ridge; JSON values.
    """

    name: str
    encoder: PolynomialEncoder
    residual_covariance: Array
    training_u: Array
    training_pose: Array
    meta: dict[str, Any] = field(default_factory=dict)

    @cached_property
    def digest(self) -> str:
        """BLAKE2b over everything that decides a prediction or a label, hexadecimal."""
        hash_ = blake2b(digest_size=16)
        for array in (self.encoder.coef_, self.residual_covariance):
            hash_.update(np.ascontiguousarray(array, np.float32).tobytes())
        for array in (self.training_u, self.training_pose):
            hash_.update(np.ascontiguousarray(array, np.float32).tobytes())
        hash_.update(str(self.encoder.degree).encode())
        return hash_.hexdigest()


def train(capture: Capture, name: str, degree: int, ridge: float | None) -> TrainedModel:
    """Trains an encoder on a capture.

    Args:
        capture: Labelled contacts and poses.
        name: Of the model.
        degree: 1, 2 or 3.
        ridge: Penalty; 0 is least squares, None chooses among `RIDGES` by cross-validation blocked
            by trial. Random frames would leak: neighbours in time are nearly equal.
    """
    U, Q = capture.u, capture.relative
    if ridge is None:
        errors = [_blocked_residuals(capture, degree, r) for r in RIDGES]
        scale = Q.std(axis=0)
        ridge = RIDGES[int(np.argmin([np.mean((e / scale) ** 2) for e in errors]))]
    residuals = _blocked_residuals(capture, degree, ridge)
    encoder = PolynomialEncoder(degree, ridge).fit(U, Q)
    meta = {"capture": capture.meta, "degree": degree, "ridge": ridge}
    covariance = _robust_covariance(residuals)
    return _rounded(TrainedModel(name, encoder, covariance, U, Q, meta))


def trial_folds(trial: NDArray[np.int64], folds: int = FOLDS) -> NDArray[np.int64]:
    """(T,) fold of every frame; frames of one trial share a fold, folds are about equally large."""
    trials, counts = np.unique(trial, return_counts=True)
    loads = np.zeros(folds, int)
    fold_of = {}
    for i in np.argsort(-counts, kind="stable"):
        fold = int(np.argmin(loads))
        fold_of[int(trials[i])] = fold
        loads[fold] += counts[i]
    return np.array([fold_of[int(t)] for t in trial])


def _blocked_residuals(capture: Capture, degree: int, ridge: float) -> Array:
    """(T, 48) errors of predictions of frames whose trial the encoder had not seen."""
    U, Q = capture.u, capture.relative
    fold = trial_folds(capture.trial)
    residuals = np.empty_like(Q)
    for k in np.unique(fold):
        out = fold == k
        if out.all():
            raise EncoderError("one trial alone cannot be validated", expected="2 trials or more")
        encoder = PolynomialEncoder(degree, ridge).fit(U[~out], Q[~out])
        residuals[out] = Q[out] - encoder.predict(U[out])
    return residuals


def _robust_covariance(residuals: Array) -> Array:
    """Second moments of errors, each frame's length bounded.

    A few frames on which plain least squares explodes would otherwise make it seem that nothing is
    known about the pose anywhere.
    """
    spread = np.median(np.abs(residuals), axis=0) * 1.4826 + 1e-9
    length = np.sqrt(np.mean((residuals / spread) ** 2, axis=1))
    bound = np.minimum(1.0, 4.0 / np.maximum(length, 1e-9))
    bounded = residuals * bound[:, None]
    return bounded.T @ bounded / len(bounded)


def _rounded(model: TrainedModel) -> TrainedModel:
    """The model as it comes back from a file, so that a saved one predicts alike to the bit."""
    single = [
        np.asarray(a, np.float32).astype(float)
        for a in (model.residual_covariance, model.training_u, model.training_pose)
    ]
    coef = np.asarray(model.encoder.coef_, np.float32).astype(float)
    encoder = PolynomialEncoder(model.encoder.degree, model.encoder.ridge)
    encoder.load(coef, model.encoder.n_inputs_)
    return TrainedModel(model.name, encoder, *single, model.meta)


def save_model(model: TrainedModel, path: Path) -> None:
    """Writes a model as npz, single precision, without pickle."""
    header = {"schema": SCHEMA, "name": model.name, "degree": model.encoder.degree,
              "ridge": model.encoder.ridge, "meta": model.meta}  # fmt: skip
    with path.open("wb") as file:
        np.savez_compressed(
            file,
            header=np.frombuffer(json.dumps(header).encode(), np.uint8),
            coef=model.encoder.coef_.astype(np.float32),
            covariance=model.residual_covariance.astype(np.float32),
            training_u=model.training_u.astype(np.float32),
            training_pose=model.training_pose.astype(np.float32),
        )


def load_model(path: Path) -> TrainedModel:
    """Reads a model.

    Raises:
        EncoderError: The file is missing, damaged, of another version or breaks its contract.
    """
    where = str(path)
    names = ("coef", "covariance", "training_u", "training_pose")
    try:
        with np.load(path, allow_pickle=False) as file:
            arrays = {n: np.asarray(file[n], float) for n in names}
            header = json.loads(bytes(file["header"].tobytes()).decode())
        degree, ridge = int(header["degree"]), float(header["ridge"])
        name, meta, schema = str(header["name"]), dict(header["meta"]), header["schema"]
    except FileNotFoundError:
        raise EncoderError("there is no such file", where=where) from None
    except (OSError, ValueError, KeyError, TypeError, EOFError, zipfile.BadZipFile) as error:
        raise EncoderError(
            "this is not a trained model, or it is damaged",
            where=where,
            got=str(error),
            remedy="`sandbox train --out FILE` makes a sound one",
        ) from error
    if schema != SCHEMA:
        raise EncoderError("another version's model", where=where, got=schema, expected=str(SCHEMA))
    _check(arrays, where)
    encoder = PolynomialEncoder(degree, ridge).load(arrays["coef"], CONTACT_VECTOR_SIZE)
    return TrainedModel(
        name, encoder, arrays["covariance"], arrays["training_u"], arrays["training_pose"], meta
    )


def _check(arrays: dict[str, Array], where: str) -> None:
    frames = len(arrays["training_u"])
    shapes = {
        "covariance": (POSE_SIZE, POSE_SIZE),
        "training_u": (frames, CONTACT_VECTOR_SIZE),
        "training_pose": (frames, POSE_SIZE),
        "coef": (len(arrays["coef"]), POSE_SIZE),
    }
    for name, shape in shapes.items():
        if arrays[name].shape != shape:
            raise EncoderError(
                "wrong shape", where=f"{where}: {name}", got=arrays[name].shape, expected=str(shape)
            )
        if not np.isfinite(arrays[name]).all():
            raise EncoderError("values must be finite", where=f"{where}: {name}")


@cache
def builtin_capture() -> Capture:
    """The capture of the simulated subject that all built-in models are trained on."""
    return load_capture(_data("capture.npz"))


@cache
def builtin(name: str) -> TrainedModel:
    """A built-in model by name.

    `best` and `paper` come ready from the package; the others are trained on the spot.

    Raises:
        EncoderError: There is no such model.
    """
    if name not in BUILTIN:
        raise EncoderError("no such encoder", got=name, expected=", ".join(BUILTIN))
    path = _data(f"{name}.npz")
    if path.exists():
        stored = _load_slim(path)
        return stored
    degree, ridge = BUILTIN[name]
    return train(builtin_capture(), name, degree, ridge)


def _load_slim(path: Path) -> TrainedModel:
    """A built-in model, whose training data is the built-in capture and stored only once."""
    with np.load(path, allow_pickle=False) as file:
        header = json.loads(bytes(file["header"].tobytes()).decode())
        coef, covariance = np.asarray(file["coef"], float), np.asarray(file["covariance"], float)
    capture = builtin_capture()
    encoder = PolynomialEncoder(header["degree"], header["ridge"]).load(coef, CONTACT_VECTOR_SIZE)
    single = [np.asarray(a, np.float32).astype(float) for a in (capture.u, capture.relative)]
    return TrainedModel(header["name"], encoder, covariance, *single, header["meta"])


def save_builtin(model: TrainedModel, folder: Path) -> None:
    """Writes a built-in model without its training data."""
    header = {"name": model.name, "degree": model.encoder.degree, "ridge": model.encoder.ridge,
              "meta": model.meta}  # fmt: skip
    with (folder / f"{model.name}.npz").open("wb") as file:
        np.savez_compressed(
            file,
            header=np.frombuffer(json.dumps(header).encode(), np.uint8),
            coef=model.encoder.coef_.astype(np.float32),
            covariance=model.residual_covariance.astype(np.float32),
        )


def _data(name: str) -> Path:
    return Path(str(files("encoders") / "data" / name))
