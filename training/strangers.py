"""Measures poses, finger labels and the labels' probabilities on people who were not trained on.

Every take of a person is judged from its beginning. The pose is estimated with true labels.
Intervals are from a bootstrap over people (or over days of one person), since frames and takes of
one person do not show how much people differ.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from encoders.capture import Capture
from encoders.evaluation.labels import takes
from encoders.evaluation.person_model import estimated
from encoders.evaluation.pose_errors import pose_errors
from encoders.evaluation.result_values import block_interval
from encoders.labels.belief import BeliefLabels
from encoders.regression.trained import TrainedModel
from models.arithmetic import Array

BINS = 10
"""Number of bins of the reliability curve, equally wide from 0 to 1."""

SURE = 0.99
"""Least probability of a sure answer."""

Progress = Callable[[float], None]


@dataclass(frozen=True)
class StrangerResult:
    """Results of one person or day, T frames.

    Attributes:
        fingers: (T,) number of contacts.
        wrist: (T,) cm, error of the wrist's position with true labels.
        angle: (T,) degrees, mean error of the ball joints with true labels.
        right: (T,) true for frames in which all contacts have correct labels.
        claimed: (T,) probability of the labels according to the labeller; NaN for frames without
            labels.
    """

    fingers: NDArray[np.int64]
    wrist: Array
    angle: Array
    right: NDArray[np.bool_]
    claimed: Array


def judge_stranger(
    capture: Capture, model: TrainedModel, labeller: BeliefLabels | None
) -> StrangerResult:
    """Judges a model and a labeller on a person.

    Args:
        capture: The person, at the trained hand's size.
        model: Encoder with its correction.
        labeller: Labels the contacts, with the help of earlier frames; None judges no labels.
    """
    frames = len(capture)
    right, claimed = np.zeros(frames, bool), np.full(frames, np.nan)
    if labeller is not None:
        _name(capture, labeller, right, claimed)
    errors = pose_errors(estimated(model, capture), capture.q)
    fingers = capture.down.sum(axis=1)
    return StrangerResult(fingers, errors.wrist, errors.angle, right, claimed)


def _name(
    capture: Capture, labeller: BeliefLabels, right: NDArray[np.bool_], claimed: Array
) -> None:
    rng = np.random.default_rng(0)
    for _, frames in takes(capture):
        labeller.restart()
        for t in frames:
            fingers = rng.permutation(np.flatnonzero(capture.down[t]))
            places = {
                int(capture.ids[t, f]): (float(capture.xy[t, f, 0]), float(capture.xy[t, f, 1]))
                for f in fingers
            }
            labelling = labeller.assign(places, {})
            truth = {int(capture.ids[t, f]): int(f) for f in fingers}
            right[t] = labelling.labels == truth
            claimed[t] = labelling.probability


def summary(people: Sequence[StrangerResult]) -> dict[str, Any]:
    """Means over all frames, with intervals from a bootstrap over people, as JSON values."""
    person = np.repeat(np.arange(len(people)), [len(p.fingers) for p in people])
    wrist, angle, right, claimed, fingers = (
        np.concatenate([getattr(p, name) for p in people])
        for name in ("wrist", "angle", "right", "claimed", "fingers")
    )
    out: dict[str, Any] = {"people": len(people), "frames": len(person)}
    for name, values in (("wrist_cm", wrist), ("angle_deg", angle)):
        out[name] = float(values.mean())
        out[f"{name}_interval"] = block_interval(values, person)
    named = ~np.isnan(claimed)
    if not named.any():
        return out
    share = 100.0 * right
    parts = {str(k): fingers == k for k in range(2, 6)} | {"all": fingers > 1}
    out["labels_percent"] = {k: _mean(share[frames]) for k, frames in parts.items()}
    out["labels_percent_interval"] = {
        k: block_interval(share[frames], person[frames]) for k, frames in parts.items()
    }
    sure = claimed >= SURE
    out["sure"] = {
        "right_percent": _mean(share[sure]),
        "share_percent": 100.0 * float(sure.mean()),
        "share_of_three_and_more_percent": 100.0 * _mean(sure[fingers > 2].astype(float)),
    }
    curve = reliability(claimed[named], right[named])
    out["reliability"] = curve
    out["calibration_error_percent"] = calibration_error(curve)
    return out


def reliability(claimed: Array, right: NDArray[np.bool_]) -> list[dict[str, float]]:
    """Reliability curve: mean claimed probability and share of correct frames, for each bin of the
    claimed probability.

    A frame is correct if all its fingers have correct labels. Bins without frames are left out.

    Args:
        claimed: (n,) claimed probabilities, 0 to 1.
        right: (n,) true for correct frames.
    """
    bins = np.minimum((BINS * claimed).astype(int), BINS - 1)
    return [
        {
            "from": b / BINS,
            "to": (b + 1) / BINS,
            "share": float((bins == b).mean()),
            "claimed": float(claimed[bins == b].mean()),
            "right": float(right[bins == b].mean()),
        }
        for b in np.unique(bins).tolist()
    ]


def calibration_error(curve: Sequence[dict[str, float]]) -> float:
    """Mean difference (percent) between claimed probability and share of correct frames over the
    bins, weighted by frames."""
    return 100.0 * sum(b["share"] * abs(b["claimed"] - b["right"]) for b in curve)


def _mean(values: Array) -> float:
    return float(values.mean()) if len(values) else float("nan")
