"""The model that `sandbox train` makes from one person's capture, and its estimate of the pose.

Candidate encoders are compared by tenfold cross-validation blocked by trial, each with a correction
by the touches (`PersonCorrection`). The best candidate is trained on all data. The weight of the
touches in its correction is then chosen by validation, too.
"""

from __future__ import annotations

import json
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from hashlib import blake2b
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from encoders.capture import Capture
from encoders.encoder import Encoder
from encoders.input_vector import contact_vectors
from encoders.reconstruction.hand_motion import PoseFilter, rigid_motion
from encoders.regression.bone_fit import blocked_variance, fitted_skeleton, train_correction
from encoders.regression.model_registry import cache_folder, keep_model
from encoders.regression.polynomial import PolynomialEncoder
from encoders.regression.trained import PersonCorrection, TrainedModel, load_model
from encoders.regression.training import blocked_predictions, origin, rounded
from encoders.regression.yaw_normalised import YawNormalisedEncoder
from encoders.validation import error_product, robust_covariance
from models.arithmetic import Array
from models.errors import EncoderError
from models.pose import absolute_pose
from models.skeleton import ADULT

CANDIDATES: dict[str, Callable[[], Encoder]] = {
    "quadratic, ridge 0.01": lambda: PolynomialEncoder(2, 0.01),
    "quadratic, ridge 0.03": lambda: PolynomialEncoder(2, 0.03),
    "quadratic, ridge 0.1": lambda: PolynomialEncoder(2, 0.1),
    "cubic, ridge 0.1": lambda: PolynomialEncoder(3, 0.1),
    "cubic, ridge 0.3": lambda: PolynomialEncoder(3, 0.3),
    "turned, ridge 0.03": lambda: YawNormalisedEncoder(0.03, 0.03),
    "turned, ridge 0.1": lambda: YawNormalisedEncoder(0.03, 0.1),
    "turned, ridge 0.3": lambda: YawNormalisedEncoder(0.03, 0.3),
}
"""Candidate encoders. Kernel regression, a Kalman filter over time and pair distances as further
terms were tried during design without a lasting gain (docs/encoding.md)."""

POSTURE_TAU = 0.05
"""Time constant (s) of the estimate's posture filter. Changes of posture are delayed by this time;
a hand that moves or turns with its touches has no delay."""


_CODE = Path(__file__).parents[2]
"""Folder of the packages on whose code a model depends."""


@dataclass(frozen=True)
class PersonEstimate:
    """An estimate of a person's pose: encoder, correction by the person's bones, posture filter.

    Attributes:
        model: Trained encoder and correction.
        tau: Time constant of the posture filter (s); 0 switches it off.
    """

    model: TrainedModel
    tau: float = POSTURE_TAU

    def estimate(self, time: Array, trial: NDArray[np.int64], xy: Array) -> Array:
        """Estimates poses of all frames; the filter is reset at every new trial.

        Args:
            time: (T,) s.
            trial: (T,) take of every frame.
            xy: (T, 5, 2) m on the surface by label, NaN where lifted; at least one touch in each
                frame.

        Returns:
            Poses (T, 48) in the 3-D surface frame.
        """
        return _estimated(self.model, self.tau, time, trial, xy)


def estimated(model: TrainedModel, capture: Capture) -> Array:
    """Poses (T, 48) of a capture by a model, from true labels, in the 3-D surface frame."""
    return _estimated(model, POSTURE_TAU, capture.time, capture.trial, capture.xy)


def _estimated(
    model: TrainedModel, tau: float, time: Array, trial: NDArray[np.int64], xy: Array
) -> Array:
    u, leftmost = contact_vectors(xy)
    q = absolute_pose(model.encoder.predict(u), leftmost)
    if model.correction is not None:
        q = model.correction.correct(q, xy)
    out = np.empty_like(q)
    posture = PoseFilter(tau)
    for t in range(len(q)):
        if t == 0 or trial[t] != trial[t - 1]:
            posture.reset()
            out[t] = posture.step(q[t], (0.0, 0.0), 0.0)
            continue
        motion = rigid_motion(xy[t - 1], xy[t])
        out[t] = posture.step(
            q[t], motion.carried, time[t] - time[t - 1], motion.turn, motion.about
        )
    return out


def train_person(
    capture: Capture, name: str, progress: Callable[[float], None] | None = None
) -> TrainedModel:
    """Trains the winner among `CANDIDATES` on a capture.

    Args:
        capture: Labelled contacts and poses of one person.
        name: Name of the model.
        progress: Called with the share done, 0 to 1.

    Raises:
        EncoderError: The capture has one trial only.
    """
    U, Q = capture.u, capture.relative
    scores: dict[str, tuple[float, float]] = {}
    predicted, covariances = {}, {}
    # All candidates use the same bones. The bones are estimated from all trials, validation trials
    # included, so using them gives no candidate an advantage.
    bones, variance = fitted_skeleton(capture, ADULT), blocked_variance(capture, ADULT)
    for i, (candidate, make) in enumerate(CANDIDATES.items()):
        q = predicted[candidate] = blocked_predictions(make, capture)
        covariance = covariances[candidate] = robust_covariance(Q - q)
        correction = PersonCorrection(bones, covariance, variance)
        corrected = correction.correct(absolute_pose(q, capture.leftmost), capture.xy)
        scores[candidate] = (error_product(q, Q), error_product(corrected, capture.q))
        if progress:
            progress((i + 1) / (len(CANDIDATES) + 1))
    winner = min(scores, key=lambda name: scores[name][1])
    correction = train_correction(capture, predicted[winner], covariances[winner], ADULT)
    meta = origin(capture) | {"winner": winner, "validated": _in_cm_degrees(scores)}
    encoder = CANDIDATES[winner]().fit(U, Q)
    return rounded(TrainedModel(name, encoder, covariances[winner], U, Q, meta, correction))


def _in_cm_degrees(errors: dict[str, tuple[float, float]]) -> dict[str, Any]:
    """Wrist error times joint angle of every candidate in cm x degrees, without and with the
    correction."""
    scale = 100 * float(np.rad2deg(1.0))
    return {name: [round(scale * value, 3) for value in pair] for name, pair in errors.items()}


def person_model(capture: Capture, progress: Callable[[float], None] | None = None) -> TrainedModel:
    """The model of `train_person`. It is trained once and then read from the user's cache.

    If the cache folder is missing or cannot be written, the model is trained each time.

    Args:
        capture: Labelled contacts and poses of one person.
        progress: Called with the share done, 0 to 1.

    Raises:
        EncoderError: The capture has one trial only.
    """
    try:
        path = cache_folder() / f"{_key(capture)}.npz"
    except EncoderError:
        return train_person(capture, "trained", progress)
    if path.exists():
        with suppress(EncoderError):
            return load_model(path, capture)
    model = train_person(capture, "trained", progress)
    keep_model(model, path)
    return model


def _key(capture: Capture) -> str:
    """Digest of the capture and of the code that makes a model of it."""
    hash_ = blake2b(json.dumps(capture.meta, sort_keys=True).encode(), digest_size=16)
    for array in (capture.time, capture.trial, capture.ids, capture.xy, capture.q):
        hash_.update(np.ascontiguousarray(array).tobytes())
    for package in ("encoders", "models"):
        for source in sorted((_CODE / package).rglob("*.py")):
            hash_.update(source.read_bytes())
    return hash_.hexdigest()
