"""Trained models: an encoder with the covariance of its errors and its training data.

This module reads models from files; `encoders.regression.training` trains and writes them. The
built-in models are trained on a *simulated* subject or on *simulated* people, not on real people.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cache, cached_property
from hashlib import blake2b
from importlib.resources import files
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from encoders.correction import tip_targets
from encoders.encoder import Encoder
from encoders.input_vector import CONTACT_VECTOR_SIZE
from encoders.npz import read_npz
from encoders.regression.encoder_registry import (
    ENCODER_PLUGINS,
    ENCODERS,
    builtin_name,
    find_encoder,
    source_digest,
)
from encoders.regression.polynomial import is_ridge
from models.arithmetic import Array
from models.errors import EncoderError
from models.frames import FINGERS
from models.kinematics import Kinematics
from models.plugins import how_to_get, place_of
from models.pose import BALL_JOINTS, POSE_SIZE, within_limits
from models.skeleton import ADULT, Skeleton

if TYPE_CHECKING:
    from encoders.capture import Capture

SCHEMA = 2
"""Version of the file's layout."""

CAPTURED = frozenset(("time", "trial", "ids", "xy", "q"))
"""Arrays of a capture. They show that a user gave a capture in place of a model."""

_REMEDY = "`sandbox train --out FILE` makes a valid one"

POLYNOMIALS: dict[str, tuple[int, float | None]] = {
    "paper": (2, 0.0),
    "linear": (1, None),
    "quadratic": (2, None),
    "cubic": (3, None),
}
"""Name -> degree and ridge of the built-in polynomials; a ridge of None is chosen by validation."""

BUILTIN = tuple(POLYNOMIALS)
"""Names of the models trained on the built-in capture."""

POPULATION = "population"
"""Name of the built-in model for any person; `python -m training population` makes it."""

EXTERNAL = "outside"
"""Value of `kind` in the header of a model with an external encoder."""

MODEL_ARRAYS = (
    "header",
    "covariance",
    "personal",
    "training_u",
    "training_pose",
    "anchors",
    "lengths",
    "tip_variance",
)
"""Names of the arrays in a model's file that do not belong to its encoder."""

_STEPS = 3
"""Number of Gauss-Newton steps after which tips are as exact as the variance of touches
requires."""

_LIFTED_VARIANCE = 1e6
"""Variance (m2) of fingertips that do not touch, whose position is unknown."""


@dataclass(frozen=True)
class TrainedModel:
    """An encoder ready for use: `model.encoder.predict(u)` gives relative poses.

    Attributes:
        name: Name of a built-in model, such as `paper`, or any other name.
        encoder: The fitted encoder.
        residual_covariance: (48, 48) covariance of the relative pose's error, m and rad, on unseen
            trials.
        training_u: (T, 15) contact vectors of the training data.
        training_pose: (T, 48) relative poses of the training data.
        meta: Origin of the capture, simulated or not, degree and ridge; JSON values.
        correction: Corrects estimated poses of the captured person by the touches, for evaluations.
            Sessions do not use it, since the simulated hand has other bones.
        personal_covariance: (48, 48) part of the covariance due to errors that are constant for a
            person. It is given in the frame that turns with the hand. None for a model of one
            person.
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
            arrays += [self.correction.anchors, self.correction.lengths, variance]
        if self.personal_covariance is not None:
            arrays.append(self.personal_covariance)
        for array in arrays:
            hash_.update(np.ascontiguousarray(array, np.float32).tobytes())
        hash_.update(json.dumps(self.meta, sort_keys=True).encode())
        hash_.update(json.dumps(header_fields(self.encoder), sort_keys=True).encode())
        return hash_.hexdigest()


@dataclass(frozen=True)
class PersonCorrection:
    """Kalman-like update of predicted poses by the touches.

    `encoders.correction` makes the tips of our own hand meet the touches exactly. Here the pose of
    the person's hand is estimated. The person has other bones. How accurately a touch measures the
    pose therefore depends on how well those bones are known (`encoders.regression.bone_fit`).

    Attributes:
        skeleton: The person's skeleton as far as it is known.
        covariance: (48, 48) covariance of prediction errors on unseen trials, m and rad.
        tip_variance: (3,) m2, measured variance of touches about the skeleton's fingertips,
            multiplied by `distrust`.
        distrust: Factor that validation chose; with 1, the measured variance is used.
    """

    skeleton: Skeleton
    covariance: Array
    tip_variance: Array
    distrust: float = 1.0

    @property
    def anchors(self) -> Array:
        """Anchors (14, 3) m of the skeleton's bones."""
        return np.array([bone.anchor for bone in self.skeleton.bones])

    @property
    def lengths(self) -> Array:
        """Lengths (14,) m of the skeleton's bones."""
        return np.array([bone.length for bone in self.skeleton.bones])

    def correct(self, q: Array, xy: Array) -> Array:
        """Most likely poses (T, 48), given predicted poses and touches.

        Args:
            q: (T, 48) predictions, 3-D surface frame.
            xy: (T, 5, 2) m on the surface by label, NaN where lifted.
        """
        kinematics = Kinematics(self.skeleton)
        down = np.repeat(~np.isnan(xy[..., 0]), 3, axis=1)
        targets = np.nan_to_num(tip_targets(xy)).reshape(len(q), -1)
        noise = np.where(down, np.tile(self.tip_variance, len(FINGERS)), _LIFTED_VARIANCE)
        rows = np.arange(down.shape[1])
        out = q
        for _ in range(_STEPS):
            tips, J = kinematics.tips_and_jacobian(out)
            J = J.reshape(len(q), -1, POSE_SIZE) * down[..., None]
            off = (targets - tips.reshape(len(q), -1)) * down
            off = off + (J @ (out - q)[..., None])[..., 0]
            spread = J @ self.covariance
            S = spread @ np.swapaxes(J, 1, 2)
            S[:, rows, rows] += noise
            gain = np.linalg.solve(S, off[..., None])
            out = q + (np.swapaxes(spread, 1, 2) @ gain)[..., 0]
        return within_limits(out, self.skeleton)


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
            "this is a capture, not a trained model",
            where=where,
            expected="a trained model",
            remedy=f"`sandbox train --capture {path} --out MODEL.npz` trains a model on it",
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
        bones = skeleton_of(arrays["anchors"], arrays["lengths"])
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
    encoder = restored(_class_of_origin(source), stored, learned, U, Q)
    if encoder.digest() != header.get("encoder"):
        raise EncoderError(
            "the encoder is not as it was stored: the file is damaged, or the class has changed",
            where=place_of(source),
            remedy="`sandbox train --encoder` trains it again",
        )
    return encoder


def restored(
    kind: type[Encoder],
    options: Mapping[str, Any],
    arrays: Mapping[str, NDArray[Any]],
    U: Array,
    Q: Array,
) -> Encoder:
    """Restores a stored encoder.

    Args:
        kind: Class of the encoder.
        options: Its configuration.
        arrays: Its learned arrays.
        U: (T, 15) contact vectors of the training frames, in single precision.
        Q: (T, 48) relative poses of the training frames, in single precision.

    Raises:
        EncoderError: The encoder cannot be restored.
    """
    with ENCODER_PLUGINS.guarded(kind.__qualname__, "the encoder does not take its own options"):
        encoder = kind(**options)
    with ENCODER_PLUGINS.guarded(
        kind.__qualname__, "the encoder cannot be restored from its arrays"
    ):
        complete: Encoder = encoder.restore(arrays, U.copy("K"), Q.copy("K"))
    return complete


def _class_of_origin(source: Mapping[str, Any]) -> type[Encoder]:
    """Loads the encoder class that the origin in a header names.

    The origin is described at `encoders.regression.encoder_registry.origin`.

    Raises:
        EncoderError: The class does not exist on this machine.
    """
    place = place_of(source)
    try:
        return find_encoder(place)
    except EncoderError as error:
        raise EncoderError(
            "its encoder is not on this machine",
            got=str(error),
            expected=place,
            remedy=how_to_get(source),
        ) from error


def header_fields(encoder: Encoder) -> dict[str, Any]:
    """Header fields of an encoder, as JSON values. Together with the encoder's arrays, they define
    it completely."""
    ours = builtin_name(encoder)
    if ours is not None:
        return {"kind": ours, **encoder.configuration()}
    return {
        "kind": EXTERNAL,
        "class": type(encoder).__qualname__,
        "source": source_digest(type(encoder)),
        "configuration": encoder.configuration(),
        "encoder": encoder.digest(),
    }


def _array(raw: Mapping[str, NDArray[Any]], name: str, where: str) -> Array:
    if name not in raw:
        raise EncoderError("an array is missing", where=where, expected=name, remedy=_REMEDY)
    if raw[name].dtype.kind != "f":
        raise EncoderError(
            "wrong type", where=f"{where}: {name}", expected="floating point", remedy=_REMEDY
        )
    return raw[name].astype(float)


def _is_distrust(value: Any) -> bool:
    """True for a valid value of `distrust` in a header, or for None."""
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


def single(array: Array) -> Array:
    """Values rounded to single precision."""
    return np.asarray(array, np.float32).astype(float)


def skeleton_of(anchors: Array, lengths: Array) -> Skeleton:
    """The built-in skeleton with given joint anchors (14, 3) m and bone lengths (14,) m."""
    bones = tuple(
        replace(bone, anchor=(float(a[0]), float(a[1]), float(a[2])), length=float(length))
        for bone, a, length in zip(ADULT.bones, anchors, lengths, strict=True)
    )
    return replace(ADULT, name=f"{ADULT.name}, fitted", bones=bones)


@cache
def builtin_capture() -> Capture:
    """Capture of the simulated subject, on which the models in `BUILTIN` are trained."""
    from encoders.capture import load_capture

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
