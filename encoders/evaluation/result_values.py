"""Results as JSON values: the numbers of the tables under fixed names.

The report has means over frames, standard errors as in the paper, and 95 % intervals. Missing
values are null, for example the Copas test of a method that cannot be refitted.

Frames of one take depend on each other. A standard error that treats frames as independent is too
small by a factor of five or more; it is computed only because the paper prints it. The intervals
resample whole takes.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from encoders.capture import Capture
from encoders.evaluation import paper_results as paper
from encoders.evaluation.copas import RULES, Copas
from encoders.evaluation.labels import COUNTS, SEVERAL, Verdicts
from encoders.evaluation.measure_method import LABELS, TRUE, MethodResult, Tests, counts_of
from encoders.evaluation.pose_errors import Smoothness, limit_share, tip_errors, variance_shares
from models.arithmetic import Array
from models.pose import JOINTS

SCHEMA = 1
"""Version of the report's layout."""

ALL = "all"
"""Key for two to five fingers together."""


def report(
    results: Mapping[str, MethodResult],
    tests: Tests,
    training: Capture,
    configuration: Mapping[str, Any],
) -> dict[str, Any]:
    """The whole report.

    Args:
        results: Results by name.
        tests: The test captures.
        training: The training data.
        configuration: Settings of the evaluation; JSON values.
    """
    captures = [*tests.captures, training]
    return plain(
        {
            "schema": SCHEMA,
            "simulated": all(bool(c.meta.get("simulated", False)) for c in captures),
            "configuration": dict(configuration),
            "training": _described(training) | {"pca_variance_percent": pca_variance(training)},
            "tests": [_described(c) for c in tests.captures],
            "test_frames": {str(k): n for k, n in counts_of(tests).items()} | {ALL: len(tests.q)},
            "truth": {
                "tip_cm": float(tip_errors(tests.q, tests.xy).mean()),
                "limit_violations": limit_share(tests.q),
                **_smooth(tests.smoothness(tests.q)),
            },
            "encoders": {name: method_report(r, tests) for name, r in results.items()},
            "paper": {
                "note": "another data set: one person, one day, never published",
                "table_1": {k: list(v) for k, v in paper.TABLE_1.items()},
                "table_2": {k: list(v) for k, v in paper.TABLE_2.items()},
                "overfitted_joints": paper.OVERFITTED_JOINTS,
                "us_per_pose": paper.US_PER_POSE,
                "pca_variance_percent": {str(k): v for k, v in paper.PCA_VARIANCE.items()},
            },
        }
    )


def method_report(result: MethodResult, tests: Tests) -> dict[str, Any]:
    """One method's part of the report."""
    out: dict[str, Any] = {}
    measures: dict[str, dict[str, Array]] = {
        name: {labels: getattr(result.errors[labels], part) for labels in LABELS}
        for name, part in (
            ("wrist_cm", "wrist"),
            ("angle_deg", "angle"),
            ("component_deg", "component"),
            ("wrist_turn_deg", "turn"),
        )
    }
    for name, by_labels in measures.items():
        out[name] = {labels: float(v.mean()) for labels, v in by_labels.items()}
        out[f"{name}_interval"] = {
            labels: block_interval(v, tests.block) for labels, v in by_labels.items()
        }
    # The paper averages over all joint angles, so its standard error counts every joint.
    for name, part in (("wrist_sem", "wrist"), ("angle_sem", "joints")):
        out[name] = {
            labels: standard_error(getattr(result.errors[labels], part)) for labels in LABELS
        }
    out["component_sem"] = {
        labels: standard_error(result.errors[labels].components) for labels in LABELS
    }
    out |= _labels(result, tests)
    smooth = {labels: _smooth(result.smoothness[labels]) for labels in LABELS}
    out |= smooth[TRUE]
    out["smoothness"] = smooth
    out["tip_cm"] = float(result.tips.mean())
    out["limit_violations"] = result.limits
    out["us_per_pose"] = result.us_per_pose
    out["us_per_pose_batch"] = result.us_in_batch
    out["timed"] = result.timed
    test = result.copas.get("random")
    out["overfitted_joints"] = test.count(RULES[0]) if test else None
    out["copas"] = {name: _copas(c) for name, c in result.copas.items()}
    out["by_fingers"] = {
        str(k): {
            name: {labels: _mean(v[tests.fingers == k]) for labels, v in by_labels.items()}
            for name, by_labels in measures.items()
        }
        | {
            f"{name}_interval": {
                labels: block_interval(v[tests.fingers == k], tests.block[tests.fingers == k])
                for labels, v in by_labels.items()
            }
            for name, by_labels in measures.items()
        }
        for k in COUNTS
    }
    out["by_capture"] = [
        {
            name: {labels: _mean(v[tests.source == i]) for labels, v in by_labels.items()}
            for name, by_labels in measures.items()
        }
        | {"labels_percent": _mean(100.0 * result.right[(tests.source == i) & (tests.fingers > 1)])}
        for i in range(len(tests.captures))
    ]
    return out


def pca_variance(capture: Capture) -> dict[str, dict[str, float]]:
    """Percentage of a capture's variance that the first k principal components explain, for each k
    of the paper.

    `joints`: the 42 components of the ball joints (rad), as in the paper's synergies.
    `pose`: all 48 numbers of the relative pose (m and rad).
    """
    counts = tuple(paper.PCA_VARIANCE)
    vectors = {"joints": capture.relative[:, JOINTS], "pose": capture.relative}
    return {
        name: {str(k): share for k, share in variance_shares(v, counts).items()}
        for name, v in vectors.items()
    }


def plain(value: Any) -> Any:
    """Converts nested numbers to JSON values; numbers that are not finite become None."""
    if isinstance(value, Mapping):
        return {str(k): plain(v) for k, v in value.items()}
    if isinstance(value, list | tuple | np.ndarray):
        return [plain(v) for v in value]
    if isinstance(value, bool | np.bool_):
        return bool(value)
    if isinstance(value, int | np.integer):
        return int(value)
    if isinstance(value, float | np.floating):
        return float(value) if np.isfinite(value) else None
    return value


def _labels(result: MethodResult, tests: Tests) -> dict[str, Any]:
    verdicts = {
        str(k): Verdicts(result.right[tests.fingers == k], tests.block[tests.fingers == k])
        for k in SEVERAL
    }
    several = np.isin(tests.fingers, SEVERAL)
    verdicts = {"1": result.stayed} | verdicts
    verdicts[ALL] = Verdicts(result.right[several], tests.block[several])
    verdicts["1_first"] = result.first
    shares = {name: 100.0 * v.right.astype(np.float64) for name, v in verdicts.items()}
    return {
        "labels_percent": {name: _mean(v) for name, v in shares.items()},
        "labels_percent_interval": {
            name: block_interval(shares[name], v.trial) for name, v in verdicts.items()
        },
        "labels_judged": {name: len(v.right) for name, v in verdicts.items()},
    }


def _smooth(smoothness: Smoothness) -> dict[str, float]:
    return {
        "jump_deg": _mean(smoothness.jump),
        "jump_largest_deg": _largest(smoothness.jump),
        "joint_jump_largest_deg": _largest(smoothness.largest_joint),
        "joint_jump_deg": _mean(smoothness.largest_joint),
        "wrist_jump_cm": _mean(smoothness.wrist_jump),
        "wrist_jump_largest_cm": _largest(smoothness.wrist_jump),
        "acceleration_deg_s2": _mean(smoothness.acceleration),
        "contact_changes": len(smoothness.jump),
    }


def _copas(test: Copas) -> dict[str, Any]:
    per_fold = {rule: [int(fold.overfitted[rule].sum()) for fold in test.folds] for rule in RULES}
    return {
        "overfitted_joints": {rule: test.count(rule) for rule in RULES},
        "per_fold": per_fold,
        "median_slope": test.median_slope,
    }


def _described(capture: Capture) -> dict[str, Any]:
    known = ("subject", "seed", "day", "side", "skeleton", "rate_hz", "file")
    return {
        "frames": len(capture),
        "takes": len(np.unique(capture.trial)),
        "simulated": bool(capture.meta.get("simulated", False)),
        **{key: capture.meta[key] for key in known if key in capture.meta},
    }


def _mean(values: Array) -> float:
    return float(np.mean(values)) if len(values) else float("nan")


def _largest(values: Array) -> float:
    return float(np.max(values)) if len(values) else float("nan")


RESAMPLES = 2000
LEVEL = 0.95


def standard_error(values: Array) -> float:
    """Standard error of the mean if all values were independent; 0 for a single value."""
    values = np.ravel(values)
    if len(values) < 2:
        return 0.0
    return float(values.std(ddof=1) / np.sqrt(len(values)))


def block_interval(
    values: Array, block: NDArray[np.int64], resamples: int = RESAMPLES, seed: int = 0
) -> tuple[float, float]:
    """Interval of the mean by a bootstrap over blocks.

    Each resample draws as many blocks as exist, with replacement, and averages all values of the
    drawn blocks. With takes as blocks, the interval covers the variation between takes and days of
    one subject, but not between subjects.

    Args:
        values: (T,) values.
        block: (T,) block of every value; values of one block are drawn together.
        resamples: Number of resampled means.
        seed: Seed; equal arguments give equal intervals.

    Returns:
        Lower and upper end of the central 95 %; NaN with fewer than two blocks.
    """
    blocks, index = np.unique(block, return_inverse=True)
    if len(blocks) < 2:
        return float("nan"), float("nan")
    counts = np.bincount(index).astype(float)
    sums = np.bincount(index, np.asarray(values, float))
    picks = np.random.default_rng(seed).integers(0, len(counts), (resamples, len(counts)))
    means = sums[picks].sum(axis=1) / counts[picks].sum(axis=1)
    tail = 50.0 * (1.0 - LEVEL)
    low, high = np.percentile(means, [tail, 100.0 - tail])
    return float(low), float(high)
