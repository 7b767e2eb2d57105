"""Trials that share an encoder's work are told what each would be told alone."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

from benchmarks.lanes import in_lanes
from encoders.regression.model_registry import pca_ik_model
from encoders.regression.trained import builtin_capture


@cache
def touches() -> np.ndarray:
    return builtin_capture().u[::301]


def walk(job: tuple[int, int]) -> tuple[int, list[bytes]]:
    """A trial of so many steps from a start, whose touches depend on the pose before."""
    start, steps = job
    encoder, poses, at = pca_ik_model().encoder, list[bytes](), start
    for _ in range(steps):
        q = encoder.predict(touches()[at % len(touches())])
        poses.append(q.tobytes())
        at += 1 + int(abs(q[6]) * 1e6) % 7
    return start, poses


def test_every_trial_sees_the_poses_that_it_sees_alone() -> None:
    jobs = [(start, 2 + start % 3) for start in range(10)] + [(99, 0)]
    together = dict(in_lanes(walk, jobs))
    assert together == dict(map(walk, jobs))


def test_an_error_in_a_trial_is_passed_on_and_leaves_the_encoder_unchanged() -> None:
    encoder = pca_ik_model().encoder
    before = encoder.predict(touches()[0])

    def breaks(job: int) -> int:
        encoder.predict(touches()[job])
        raise ValueError(f"trial {job}")

    with pytest.raises(ValueError, match="trial 3"):
        list(in_lanes(breaks, [3]))
    assert "predict" not in vars(encoder)
    np.testing.assert_array_equal(encoder.predict(touches()[0]), before)
