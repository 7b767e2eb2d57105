"""A trained encoder with what else it learned: how wrong it is, and what it was trained on.

The built-in models are trained on a capture of the *simulated* subject; none of them has seen a
person.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Mapping, Sequence
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
from encoders.input_vector import CONTACT_VECTOR_SIZE
from encoders.npz import read_npz, write_npz
from encoders.regression.person_correction import PersonCorrection
from encoders.regression.polynomial import PolynomialEncoder, ridge_path
from encoders.regression.turned import SPREADS, TurnedEncoder
from encoders.store import load_capture
from encoders.validation import badness, robust_covariance, trial_folds
from models.errors import EncoderError
from models.pose import BALL_JOINTS, POSE_SIZE
from models.skeleton import ADULT, Skeleton

Array = NDArray[np.float64]

SCHEMA = 2
"""Version of the file's layout."""

RIDGES = (1e-4, 3e-4, 1e-3, 3e-3, 1e-2, 3e-2, 1e-1, 3e-1, 1.0, 3.0)
"""Penalties that validation chooses from."""

POLYNOMIALS: dict[str, tuple[int, float | None]] = {
    "paper": (2, 0.0),
    "linear": (1, None),
    "quadratic": (2, None),
    "cubic": (3, None),
}
"""Name -> degree and ridge (None: chosen by validation) of the built-in polynomials."""

BUILTIN = (*POLYNOMIALS, "best")
"""Names of the built-in models; `encoders.evaluation.best` trains the last one."""


@dataclass(frozen=True)
class TrainedModel:
    """An encoder ready for use.

    Attributes:
        name: `paper`, `best`, ... or what its maker called it.
        encoder: The fitted encoder.
        residual_covariance: (48, 48) of the relative pose's error, m and rad, on trials that the
            encoder had not seen.
        training_u: (T, 15) contact vectors it was trained on.
        training_pose: (T, 48) relative poses it was trained on.
        meta: Where the capture came from, whether it was simulated, degree and ridge; JSON values.
        correction: By the touches, of the estimate of the captured person's pose. It says nothing
            about our hand, and no session uses it.
    """

    name: str
    encoder: PolynomialEncoder | TurnedEncoder
    residual_covariance: Array
    training_u: Array
    training_pose: Array
    meta: dict[str, Any] = field(default_factory=dict)
    correction: PersonCorrection | None = None

    @cached_property
    def digest(self) -> str:
        """BLAKE2b over arrays and meta, hexadecimal; two models are the same if theirs is."""
        hash_ = blake2b(digest_size=16)
        arrays = [
            self.encoder.coef_,
            self.residual_covariance,
            self.training_u,
            self.training_pose,
        ]
        if self.correction is not None:
            variance = self.correction.tip_variance
            arrays += [_anchors(self.correction), _lengths(self.correction), variance]
        for array in arrays:
            hash_.update(np.ascontiguousarray(array, np.float32).tobytes())
        hash_.update(json.dumps(self.meta, sort_keys=True).encode())
        hash_.update(json.dumps(_kind(self.encoder), sort_keys=True).encode())
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
        best = int(np.argmin([badness(Q - e, Q) for e in candidates]))
        ridge, residuals = RIDGES[best], candidates[best]
    else:
        residuals = _blocked_residuals(capture, degree, [ridge])[0]
    meta = origin(capture) | {"degree": degree, "ridge": ridge}
    encoder = PolynomialEncoder(degree, ridge).fit(U, Q)
    return rounded(TrainedModel(name, encoder, robust_covariance(residuals), U, Q, meta))


def origin(capture: Capture) -> dict[str, Any]:
    """What a model's `meta` says about the capture it was trained on."""
    return {"simulated": bool(capture.meta.get("simulated", False)), "capture": capture.meta}


def _blocked_residuals(capture: Capture, degree: int, ridges: Sequence[float]) -> Array:
    """(len(ridges), T, 48) errors of predictions of frames whose trial the encoder had not seen."""
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
    """The values as single precision keeps them."""
    return np.asarray(array, np.float32).astype(float)


def rounded(model: TrainedModel) -> TrainedModel:
    """The model as it comes back from a file, so that a saved one predicts alike to the bit."""
    training_u, covariance = single(model.training_u), single(model.residual_covariance)
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
        encoder=_encoder(_kind(model.encoder), single(model.encoder.coef_), training_u),
        residual_covariance=covariance,
        training_u=training_u,
        training_pose=single(model.training_pose),
        meta=json.loads(json.dumps(model.meta)),
        correction=correction,
    )


def _kind(encoder: PolynomialEncoder | TurnedEncoder) -> dict[str, Any]:
    """What an encoder is, as JSON values; with its coefficients, all of it."""
    if isinstance(encoder, TurnedEncoder):
        return {"kind": "turned", "ridge": encoder.ridge, "turned_ridge": encoder.turned_ridge}
    return {"kind": "polynomial", "degree": encoder.degree, "ridge": encoder.ridge}


def _encoder(
    kind: Mapping[str, Any], coef: Array, training_u: Array
) -> PolynomialEncoder | TurnedEncoder:
    if kind["kind"] == "turned":
        return TurnedEncoder(kind["ridge"], kind["turned_ridge"]).load(coef)
    encoder = PolynomialEncoder(kind["degree"], kind["ridge"])
    return encoder.load(coef, CONTACT_VECTOR_SIZE, training_u)


def _anchors(correction: PersonCorrection) -> Array:
    return np.array([bone.anchor for bone in correction.skeleton.bones])


def _lengths(correction: PersonCorrection) -> Array:
    return np.array([bone.length for bone in correction.skeleton.bones])


def _skeleton(anchors: Array, lengths: Array) -> Skeleton:
    """The table's hand with other knuckles (14, 3) and lengths (14,), m."""
    bones = tuple(
        replace(bone, anchor=(float(a[0]), float(a[1]), float(a[2])), length=float(length))
        for bone, a, length in zip(ADULT.bones, anchors, lengths, strict=True)
    )
    return replace(ADULT, name=f"{ADULT.name}, fitted", bones=bones)


def save_model(model: TrainedModel, path: Path, training: bool = True) -> None:
    """Writes a model as npz, single precision, without pickle.

    Args:
        model: The model.
        path: The file.
        training: Whether to write the training data, too. Built-in models leave it out: it is the
            built-in capture, and that is in the package already.
    """
    header = {"schema": SCHEMA, "name": model.name, "meta": model.meta, **_kind(model.encoder)}
    arrays = {"coef": model.encoder.coef_, "covariance": model.residual_covariance}
    if training:
        arrays |= {"training_u": model.training_u, "training_pose": model.training_pose}
    if model.correction is not None:
        header["distrust"] = model.correction.distrust
        arrays |= {
            "anchors": _anchors(model.correction),
            "lengths": _lengths(model.correction),
            "tip_variance": model.correction.tip_variance,
        }
    write_npz(path, header, {name: a.astype(np.float32) for name, a in arrays.items()})


def load_model(path: Path, capture: Capture | None = None) -> TrainedModel:
    """Reads a model.

    Args:
        path: The file.
        capture: Of what the model was trained on, where the file does not hold it.

    Raises:
        EncoderError: The file is missing, damaged, of another version or breaks its contract.
    """
    where, what = str(path), "a trained model"
    names = ["coef", "covariance", *(() if capture else ("training_u", "training_pose"))]
    remedy = "`sandbox train --out FILE` makes a sound one"
    header, raw = read_npz(path, names, EncoderError, what, remedy)
    if header.get("schema") != SCHEMA:
        raise EncoderError(
            "another version's model",
            where=where,
            got=header.get("schema"),
            expected=str(SCHEMA),
            remedy="`sandbox train` makes it anew from its capture",
        )
    meta: Any = header.get("meta")
    if not _sound(header) or not isinstance(meta, dict):
        raise EncoderError("the header is damaged", where=where, remedy=remedy)
    distrust: Any = header.get("distrust")
    if distrust is not None:
        names = ["anchors", "lengths", "tip_variance"]
        raw |= read_npz(path, names, EncoderError, what, remedy)[1]
    if any(array.dtype.kind != "f" for array in raw.values()):
        raise EncoderError("wrong type", where=where, expected="floating point", remedy=remedy)
    arrays = {name: array.astype(float) for name, array in raw.items()}
    if capture:
        arrays |= {"training_u": single(capture.u), "training_pose": single(capture.relative)}
    _check(arrays, header, where)
    correction = None
    if distrust is not None:
        bones = _skeleton(arrays["anchors"], arrays["lengths"])
        correction = PersonCorrection(
            bones, arrays["covariance"], arrays["tip_variance"], float(distrust)
        )
    return TrainedModel(
        str(header.get("name")),
        _encoder(header, arrays["coef"], arrays["training_u"]),
        arrays["covariance"],
        arrays["training_u"],
        arrays["training_pose"],
        meta,
        correction,
    )


def _sound(header: Mapping[str, Any]) -> bool:
    """Whether a header describes an encoder."""

    def number(name: str) -> bool:
        value: Any = header.get(name)
        real = isinstance(value, int | float) and not isinstance(value, bool)
        # Whole numbers of JSON may be larger than any float.
        return real and bool(0 <= value <= sys.float_info.max)

    if header.get("distrust") is not None and not (number("distrust") and header["distrust"] > 0):
        return False
    if header.get("kind") == "turned":
        return number("ridge") and number("turned_ridge")
    degree: Any = header.get("degree")
    polynomial = header.get("kind") == "polynomial" and type(degree) is int and degree in (1, 2, 3)
    return polynomial and number("ridge")


def _check(arrays: dict[str, Array], header: Mapping[str, Any], where: str) -> None:
    frames = len(np.atleast_1d(arrays["training_u"]))
    turned = header["kind"] == "turned"
    degree = 2 if turned else int(header["degree"])
    coef: tuple[int, ...] = (comb(CONTACT_VECTOR_SIZE + degree, degree), POSE_SIZE)
    if turned:
        coef = (1 + len(SPREADS), *coef)
    shapes = {
        "covariance": (POSE_SIZE, POSE_SIZE),
        "training_u": (frames, CONTACT_VECTOR_SIZE),
        "training_pose": (frames, POSE_SIZE),
        "coef": coef,
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
