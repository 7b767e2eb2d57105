"""A trained encoder with what else it learned: how wrong it is, and what it was trained on.

The built-in models are trained on a capture of the *simulated* subject; none of them has seen a
person.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cache, cached_property
from hashlib import blake2b
from importlib.resources import files
from math import comb
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from encoders.capture import Capture
from encoders.contact_vector import CONTACT_VECTOR_SIZE
from encoders.npz import read_npz, write_npz
from encoders.polynomial import PolynomialEncoder, ridge_path
from encoders.store import load_capture
from models.errors import EncoderError
from models.pose import POSE_SIZE, ROOT_POSITION, joint_vectors

Array = NDArray[np.float64]

SCHEMA = 1
"""Version of the file's layout."""

FOLDS = 10
"""Of the cross-validation blocked by trial; the paper validates tenfold, too."""

RIDGES = (1e-4, 3e-4, 1e-3, 3e-3, 1e-2, 3e-2, 1e-1, 3e-1, 1.0, 3.0)
"""Penalties that validation chooses from."""

BUILTIN: dict[str, tuple[int, float | None]] = {
    "paper": (2, 0.0),
    "linear": (1, None),
    "quadratic": (2, None),
    "cubic": (3, None),
    "best": (2, None),
}
"""Name -> degree and ridge (None: chosen by validation) of the built-in models."""

_LARGEST_LENGTH = 4.0
"""Robust standard deviations that one frame's error may count in the covariance."""


@dataclass(frozen=True)
class TrainedModel:
    """An encoder ready for use.

    Attributes:
        name: `paper`, `best`, ... or what its maker called it.
        encoder: The fitted polynomial.
        residual_covariance: (48, 48) of the relative pose's error, m and rad, on trials that the
            encoder had not seen.
        training_u: (T, 15) contact vectors it was trained on.
        training_pose: (T, 48) relative poses it was trained on.
        meta: Where the capture came from, whether it was simulated, degree and ridge; JSON values.
    """

    name: str
    encoder: PolynomialEncoder
    residual_covariance: Array
    training_u: Array
    training_pose: Array
    meta: dict[str, Any] = field(default_factory=dict)

    @cached_property
    def digest(self) -> str:
        """BLAKE2b over arrays and meta, hexadecimal; two models are the same if theirs is."""
        hash_ = blake2b(digest_size=16)
        for array in (
            self.encoder.coef_,
            self.residual_covariance,
            self.training_u,
            self.training_pose,
        ):
            hash_.update(np.ascontiguousarray(array, np.float32).tobytes())
        hash_.update(json.dumps(self.meta, sort_keys=True).encode())
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

    Raises:
        EncoderError: Degree or ridge are none, or the capture has one trial only.
    """
    U, Q = capture.u, capture.relative
    if ridge is None:
        candidates = _blocked_residuals(capture, degree, RIDGES)
        best = int(np.argmin([_badness(e) for e in candidates]))
        ridge, residuals = RIDGES[best], candidates[best]
    else:
        residuals = _blocked_residuals(capture, degree, [ridge])[0]
    meta = {
        "simulated": bool(capture.meta.get("simulated", False)),
        "capture": capture.meta,
        "degree": degree,
        "ridge": ridge,
    }
    encoder = PolynomialEncoder(degree, ridge).fit(U, Q)
    return _rounded(TrainedModel(name, encoder, _robust_covariance(residuals), U, Q, meta))


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


def _blocked_residuals(capture: Capture, degree: int, ridges: Sequence[float]) -> Array:
    """(len(ridges), T, 48) errors of predictions of frames whose trial the encoder had not seen."""
    U, Q = capture.u, capture.relative
    fold = trial_folds(capture.trial)
    residuals = np.empty((len(ridges), *Q.shape))
    for k in np.unique(fold):
        out = fold == k
        if out.all():
            raise EncoderError("one trial alone cannot be validated", expected="2 trials or more")
        encoder = PolynomialEncoder(degree, ridges[0]).fit(U[~out], Q[~out])
        coefs = [encoder.coef_]
        if len(ridges) > 1:
            coefs = list(ridge_path(encoder.terms(U[~out]), Q[~out], ridges))
        X = encoder.terms(U[out])
        for i, coef in enumerate(coefs):
            residuals[i, out] = Q[out] - X @ coef
    return residuals


def _badness(residuals: Array) -> float:
    """Mean distance of the wrist times mean angle of the joints, the paper's two measures.

    A product needs no rate of exchange between metres and radians. (Standardised squares of all 48
    numbers would: most of them cannot be told from touches, and they would drown the wrist.)
    """
    wrist = np.linalg.norm(residuals[:, ROOT_POSITION], axis=1).mean()
    joints = np.linalg.norm(joint_vectors(residuals), axis=2).mean()
    return float(wrist * joints)


def _robust_covariance(residuals: Array) -> Array:
    """Second moments of errors, each frame's length bounded.

    A few frames on which plain least squares explodes would otherwise make it seem that nothing is
    known about the pose anywhere.
    """
    spread = np.median(np.abs(residuals), axis=0) * 1.4826 + 1e-9
    length = np.sqrt(np.mean((residuals / spread) ** 2, axis=1))
    bound = np.minimum(1.0, _LARGEST_LENGTH / np.maximum(length, 1e-9))
    bounded = residuals * bound[:, None]
    return bounded.T @ bounded / len(bounded)


def _single(array: Array) -> Array:
    """The values as single precision keeps them."""
    return np.asarray(array, np.float32).astype(float)


def _rounded(model: TrainedModel) -> TrainedModel:
    """The model as it comes back from a file, so that a saved one predicts alike to the bit."""
    encoder = PolynomialEncoder(model.encoder.degree, model.encoder.ridge)
    encoder.load(_single(model.encoder.coef_), model.encoder.n_inputs_)
    return replace(
        model,
        encoder=encoder,
        residual_covariance=_single(model.residual_covariance),
        training_u=_single(model.training_u),
        training_pose=_single(model.training_pose),
        meta=json.loads(json.dumps(model.meta)),
    )


def save_model(model: TrainedModel, path: Path, training: bool = True) -> None:
    """Writes a model as npz, single precision, without pickle.

    Args:
        model: The model.
        path: The file.
        training: Whether to write the training data, too. Built-in models leave it out: it is the
            built-in capture, and that is in the package already.
    """
    header = {"schema": SCHEMA, "name": model.name, "degree": model.encoder.degree,
              "ridge": model.encoder.ridge, "meta": model.meta}  # fmt: skip
    arrays = {"coef": model.encoder.coef_, "covariance": model.residual_covariance}
    if training:
        arrays |= {"training_u": model.training_u, "training_pose": model.training_pose}
    write_npz(path, header, {name: a.astype(np.float32) for name, a in arrays.items()})


def load_model(path: Path, capture: Capture | None = None) -> TrainedModel:
    """Reads a model.

    Args:
        path: The file.
        capture: Of what the model was trained on, where the file does not hold it.

    Raises:
        EncoderError: The file is missing, damaged, of another version or breaks its contract.
    """
    where = str(path)
    names = ["coef", "covariance", *(() if capture else ("training_u", "training_pose"))]
    remedy = "`sandbox train --out FILE` makes a sound one"
    header, raw = read_npz(path, names, EncoderError, "a trained model", remedy)
    if header.get("schema") != SCHEMA:
        raise EncoderError(
            "another version's model", where=where, got=header.get("schema"), expected=str(SCHEMA)
        )
    degree: Any = header.get("degree")
    ridge: Any = header.get("ridge")
    meta: Any = header.get("meta")
    sound = isinstance(ridge, int | float) and 0 <= ridge < np.inf and isinstance(meta, dict)
    if degree not in (1, 2, 3) or not sound:
        raise EncoderError("the header is damaged", where=where, got=(degree, ridge), remedy=remedy)
    if any(array.dtype.kind != "f" for array in raw.values()):
        raise EncoderError("wrong type", where=where, expected="floating point", remedy=remedy)
    arrays = {name: array.astype(float) for name, array in raw.items()}
    if capture:
        arrays |= {"training_u": _single(capture.u), "training_pose": _single(capture.relative)}
    _check(arrays, degree, where)
    encoder = PolynomialEncoder(degree, ridge).load(arrays["coef"], CONTACT_VECTOR_SIZE)
    return TrainedModel(
        str(header.get("name")),
        encoder,
        arrays["covariance"],
        arrays["training_u"],
        arrays["training_pose"],
        meta,
    )


def _check(arrays: dict[str, Array], degree: int, where: str) -> None:
    frames = len(np.atleast_1d(arrays["training_u"]))
    shapes = {
        "covariance": (POSE_SIZE, POSE_SIZE),
        "training_u": (frames, CONTACT_VECTOR_SIZE),
        "training_pose": (frames, POSE_SIZE),
        "coef": (comb(CONTACT_VECTOR_SIZE + degree, degree), POSE_SIZE),
    }
    for name, shape in shapes.items():
        if arrays[name].shape != shape or not frames:
            raise EncoderError(
                "wrong shape", where=f"{where}: {name}", got=arrays[name].shape, expected=str(shape)
            )
        if not np.isfinite(arrays[name]).all():
            raise EncoderError("values must be finite", where=f"{where}: {name}")


@cache
def builtin_capture() -> Capture:
    """The capture of the simulated subject that all built-in models are trained on."""
    return load_capture(builtin_folder() / "capture.npz")


@cache
def builtin(name: str) -> TrainedModel:
    """A built-in model by name, as it comes with the package.

    Raises:
        EncoderError: There is no such model.
    """
    if name not in BUILTIN:
        raise EncoderError("no such encoder", got=name, expected=", ".join(BUILTIN))
    return load_model(builtin_folder() / f"{name}.npz", builtin_capture())


def builtin_folder() -> Path:
    """Where the built-in capture and models are."""
    return Path(str(files("encoders") / "data"))
