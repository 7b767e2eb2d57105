"""Plays trials concurrently, so that inverse kinematics is solved for many of them at once.

The 100 iterations for one pose are mostly overhead of NumPy calls, and take longer than the rest of
a trial. For many poses they take little more time, and every pose is equal to the bit to the pose
that is solved alone (`tests/encoders/regression/test_every_encoder.py`). Each trial therefore has a
thread. One thread runs at a time, and a trial that needs a pose waits until all of them wait. Only
touches of the same fingers are solved together: the largest such group is solved, and the others
wait for more trials, up to a limit. Trials end in the same state as alone.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterable, Iterator
from threading import Semaphore, Thread, current_thread
from typing import TypeVar

import numpy as np

from encoders.regression.model_registry import pca_ik_model
from encoders.regression.polynomial import FLAGS
from models.arithmetic import Array

Job = TypeVar("Job")
Result = TypeVar("Result")

AT_ONCE = 120
"""Number of concurrent trials, of about 7 MB each. It is large so that rare sets of fingers also
form groups."""
LONGEST_WAIT = 30
"""Number of rounds after which a group is solved first. Without it, a trial with a rare set of
fingers would wait until the end."""


class _Lane(Thread):
    """A thread for one job. It runs from `resume` until it needs a pose or ends."""

    def __init__(self, work: Callable[[], object]) -> None:
        super().__init__(daemon=True)
        self._work, self._mine, self._theirs = work, Semaphore(0), Semaphore(0)
        self.waited = 0
        self.question: Array | None = None
        self.answer: Array | None = None
        self.result: object = None
        self.error: BaseException | None = None

    def resume(self) -> None:
        """Runs the thread until it waits again or ends."""
        if self.ident is None:
            self.start()
        self._mine.release()
        self._theirs.acquire()

    def run(self) -> None:
        self._mine.acquire()
        try:
            self.result = self._work()
        except BaseException as error:  # `in_lanes` raises it in the main thread
            self.error = error
        self.question = None
        self._theirs.release()

    def ask(self, u: Array) -> Array:
        """Returns the pose for an input `u`. Other threads run in the meantime."""
        self.question, self.waited = u.copy(), 0
        self._theirs.release()
        self._mine.acquire()
        assert self.answer is not None
        return self.answer


def in_lanes(trial: Callable[[Job], Result], jobs: Iterable[Job]) -> Iterator[Result]:
    """Yields the results of trials with PCA-IK in the order in which they end.

    Args:
        trial: Plays one job.
        jobs: The jobs.

    Raises:
        BaseException: The error that a trial raised.
    """
    encoder = pca_ik_model().encoder
    alone = encoder.predict

    def predict(u: Array) -> Array:
        lane = current_thread()
        return lane.ask(u) if isinstance(lane, _Lane) else alone(u)

    waiting, running = deque(jobs), list[_Lane]()
    encoder.predict = predict  # type: ignore[method-assign, assignment]
    try:
        while waiting or running:
            moving = _next_group(running)
            for lane in running:
                lane.waited += 1
            if moving:
                answers = alone(np.array([lane.question for lane in moving]))
                for lane, answer in zip(moving, answers, strict=True):
                    lane.answer = answer
            while waiting and len(running) < AT_ONCE:
                job = waiting.popleft()
                running.append(_Lane(lambda job=job: trial(job)))  # type: ignore[misc]
                moving.append(running[-1])
            for lane in moving:
                lane.resume()
                if lane.question is None:
                    running.remove(lane)
                    if lane.error is not None:
                        raise lane.error
                    yield lane.result  # type: ignore[misc]
    finally:
        del encoder.predict


def _next_group(running: list[_Lane]) -> list[_Lane]:
    """Returns the largest group of threads that need a pose for the same fingers. A group with a
    thread that has waited longer than `LONGEST_WAIT` comes first."""
    groups: dict[bytes, list[_Lane]] = {}
    for lane in running:
        assert lane.question is not None
        groups.setdefault(lane.question[FLAGS:].tobytes(), []).append(lane)

    def urgency(group: list[_Lane]) -> tuple[bool, int]:
        return any(lane.waited > LONGEST_WAIT for lane in group), len(group)

    return max(groups.values(), key=urgency, default=[])
