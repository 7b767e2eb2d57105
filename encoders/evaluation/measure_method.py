"""Measures one method on test captures: errors, labels, smoothness, and the time of one pose."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from time import perf_counter_ns

import numpy as np
from numpy.typing import NDArray

from encoders.capture import Capture
from encoders.evaluation.copas import FOLDS, Copas, copas
from encoders.evaluation.labels import COUNTS, OwnLabels, Verdicts, own_labels, takes
from encoders.evaluation.methods import Method
from encoders.evaluation.pose_errors import (
    PoseErrors,
    Smoothness,
    joined,
    limit_share,
    pose_errors,
    smoothness,
    tip_errors,
)
from models.arithmetic import Array
from models.errors import EncoderError

Progress = Callable[[float], None]

TRUE, OWN = "true_labels", "own_labels"
LABELS = (TRUE, OWN)

_LEFT, _TIMED_FRAMES = 0.5, 200


class Tests:
    """Test captures, one after another; takes of different captures have different numbers."""

    __test__ = False  # pytest would collect a class with this name

    def __init__(self, captures: Sequence[Capture]) -> None:
        if not captures:
            raise EncoderError("there is nothing to test on", expected="one capture or more")
        self.captures = tuple(captures)

    @cached_property
    def source(self) -> NDArray[np.int64]:
        """Index (T,) of every frame's capture."""
        return np.repeat(np.arange(len(self.captures)), [len(c) for c in self.captures])

    @cached_property
    def block(self) -> NDArray[np.int64]:
        """Take (T,) of every frame, numbered consecutively."""
        blocks = [self.take_of(i, c.trial) for i, c in enumerate(self.captures)]
        return np.concatenate(blocks)

    def take_of(self, source: int, trial: NDArray[np.int64]) -> NDArray[np.int64]:
        """Consecutive numbers (n,) of the takes `trial` (n,) of capture `source`."""
        before = sum(len(np.unique(c.trial)) for c in self.captures[:source])
        return before + np.searchsorted(np.unique(self.captures[source].trial), trial)

    @cached_property
    def fingers(self) -> NDArray[np.int64]:
        """Number (T,) of touching fingers."""
        return np.concatenate([c.down.sum(axis=1) for c in self.captures])

    @cached_property
    def q(self) -> Array:
        """Captured poses (T, 48)."""
        return np.concatenate([c.q for c in self.captures])

    @cached_property
    def xy(self) -> Array:
        """Touches (T, 5, 2) m."""
        return np.concatenate([c.xy for c in self.captures])

    def smoothness(self, q: Array) -> Smoothness:
        """Smoothness of poses (T, 48)."""
        parts = np.split(q, np.cumsum([len(c) for c in self.captures])[:-1])
        return joined([smoothness(p, c) for p, c in zip(parts, self.captures, strict=True)])


@dataclass(frozen=True)
class MethodResult:
    """Results of one method on T test frames.

    Attributes:
        name: Name of the method.
        q: (T, 48) estimated poses, by `true_labels` and `own_labels`: the capture's labels, and the
            method's own labels.
        errors: Errors of these poses, by the same keys.
        smoothness: Smoothness of these poses, by the same keys.
        right: (T,) booleans, true if all own labels of the frame are right.
        stayed: Results for single contacts that stayed (`encoders.evaluation.labels`); takes are
            numbered consecutively.
        first: Results for single contacts that came first.
        tips: (contacts,) cm from touch to our fingertip, with true labels.
        limits: Share of joint components outside our hand's ranges, with true labels.
        us_per_pose: Microseconds for one pose, called singly.
        us_in_batch: Microseconds per pose in a batch of 120; None without batch calls.
        timed: Description of the timed call.
        copas: Copas tests `random` and `blocked`; empty where the test does not apply.
    """

    name: str
    q: dict[str, Array]
    errors: dict[str, PoseErrors]
    smoothness: dict[str, Smoothness]
    right: NDArray[np.bool_]
    stayed: Verdicts
    first: Verdicts
    tips: Array
    limits: float
    us_per_pose: float
    us_in_batch: float | None
    timed: str
    copas: dict[str, Copas]


def evaluate_method(
    method: Method,
    tests: Tests,
    training: Capture | None = None,
    progress: Progress | None = None,
    folds: int = FOLDS,
) -> MethodResult:
    """Runs a method over test captures.

    Args:
        method: The trained method.
        tests: Captures on which it was not trained.
        training: Training data for the Copas test; None leaves the test out.
        progress: Called with the share done, 0 to 1.
        folds: Number of folds of the Copas test.
    """
    tested = training if method.fresh is not None else None
    share = _LEFT if tested is not None else 1.0
    own: list[OwnLabels] = []
    q: dict[str, list[Array]] = {TRUE: [], OWN: []}
    done = 0
    for i, capture in enumerate(tests.captures):
        q[TRUE].append(method.estimate(capture.time, capture.trial, capture.xy))

        def part(x: float, before: int = done, size: int = len(capture)) -> None:
            if progress:
                progress(share * (before + x * size) / len(tests.q))

        own.append(own_labels(capture, method.labeller, method.history, i, part))
        q[OWN].append(method.estimate(capture.time, capture.trial, own[-1].xy))
        done += len(capture)
    poses = {labels: np.concatenate(parts) for labels, parts in q.items()}
    single, batch, timed = _timed(method, tests)
    copas_by_part: dict[str, Copas] = {}
    if tested is not None and method.fresh is not None:
        U, Q, trial = tested.u, tested.relative, tested.trial
        for k, (name, blocked) in enumerate((("random", False), ("blocked", True))):

            def fold(x: float, half: int = k) -> None:
                if progress:
                    progress(share + (1.0 - share) * (half + x) / 2)

            copas_by_part[name] = copas(method.fresh, U, Q, trial, blocked, folds, fold)
    return MethodResult(
        method.name,
        poses,
        {labels: pose_errors(p, tests.q) for labels, p in poses.items()},
        {labels: tests.smoothness(p) for labels, p in poses.items()},
        np.concatenate([o.right for o in own]),
        _together(tests, [o.stayed for o in own]),
        _together(tests, [o.first for o in own]),
        tip_errors(poses[TRUE], tests.xy),
        limit_share(poses[TRUE]),
        single,
        batch,
        timed,
        copas_by_part,
    )


def _together(tests: Tests, parts: list[Verdicts]) -> Verdicts:
    return Verdicts(
        np.concatenate([p.right for p in parts]),
        np.concatenate([tests.take_of(i, p.trial) for i, p in enumerate(parts)]),
    )


def _timed(method: Method, tests: Tests) -> tuple[float, float | None, str]:
    """Microseconds per pose in single calls and in a batch, and a description of the call."""
    capture = tests.captures[0]
    if method.encoder is not None:
        predict = method.encoder.predict
        return us_per_call(predict, capture.u), us_in_batch(predict, capture.u), "predict"
    # A method with history is timed over the beginning of a take, as in its normal use.
    frames = next(frames for _, frames in takes(capture))[:_TIMED_FRAMES]
    some = capture.select(frames)

    def whole(_: Array) -> Array:
        return method.estimate(some.time, some.trial, some.xy)

    return us_per_call(whole, np.zeros((1, 1))) / len(some), None, "estimate, frame after frame"


def counts_of(tests: Tests) -> dict[int, int]:
    """Number of frames by number of fingers."""
    return {k: int((tests.fingers == k).sum()) for k in COUNTS}


BATCH = 120
"""Number of poses in a batch: the number of labellings of five contacts."""
BUDGET = 0.5
"""Time (s) spent on each of the two measurements."""
MOST = 3000
"""Largest number of measured calls; more do not improve the median."""


def us_per_call(predict: Callable[[Array], Array], U: Array) -> float:
    """Median time (microseconds) of predicting one frame of inputs (T, width), called singly."""
    predict(U[0])
    spent: list[int] = []
    end = perf_counter_ns() + int(1e9 * BUDGET)
    while len(spent) < MOST and (not spent or perf_counter_ns() < end):
        u = U[len(spent) % len(U)]
        start = perf_counter_ns()
        predict(u)
        spent.append(perf_counter_ns() - start)
    return float(np.median(spent)) / 1e3


def us_in_batch(predict: Callable[[Array], Array], U: Array, batch: int = BATCH) -> float:
    """Median time (microseconds) of one pose of a batch of inputs (T, width)."""
    rows = np.ascontiguousarray(U[np.arange(batch) % len(U)])
    predict(rows)
    spent: list[int] = []
    end = perf_counter_ns() + int(1e9 * BUDGET)
    while len(spent) < MOST and (not spent or perf_counter_ns() < end):
        start = perf_counter_ns()
        predict(rows)
        spent.append(perf_counter_ns() - start)
    return float(np.median(spent)) / 1e3 / batch
