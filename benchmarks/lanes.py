"""Trials side by side, so that inverse kinematics is solved for many of them at once.

100 iterations for one pose are mostly calls of NumPy, and they take longer than all the rest of a
trial. For many poses they cost little more, and every pose is the one that it would be alone, to
the bit (`tests/encoders/regression/test_touch_ik.py`). So each trial has a thread, one of them runs
at a time, and a trial that asks for a pose waits until all of them do. Only touches of the same
fingers are solved together, so the largest such group goes on and the others wait for company, for
a while. Trials end in the state in which they would have ended alone.
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
"""Trials side by side, about 7 MB each; with more, the fingers that few of them touch with still
have company."""
LONGEST_WAIT = 30
"""Rounds; without it, a trial with rare fingers would keep its thread to the very end."""


class _Lane(Thread):
    """A thread for one job. It runs from `resume` until it asks for a pose, or ends."""

    def __init__(self, work: Callable[[], object]) -> None:
        super().__init__(daemon=True)
        self._work, self._mine, self._theirs = work, Semaphore(0), Semaphore(0)
        self.waited = 0
        self.question: Array | None = None
        self.answer: Array | None = None
        self.result: object = None
        self.error: BaseException | None = None

    def resume(self) -> None:
        """Lets it run until it waits again."""
        if self.ident is None:
            self.start()
        self._mine.release()
        self._theirs.acquire()

    def run(self) -> None:
        self._mine.acquire()
        try:
            self.result = self._work()
        except BaseException as error:  # for the thread that waits, which raises it
            self.error = error
        self.question = None
        self._theirs.release()

    def ask(self, u: Array) -> Array:
        """The answer to a question; others run meanwhile."""
        self.question, self.waited = u.copy(), 0
        self._theirs.release()
        self._mine.acquire()
        assert self.answer is not None
        return self.answer


def in_lanes(trial: Callable[[Job], Result], jobs: Iterable[Job]) -> Iterator[Result]:
    """Results of trials with PCA-IK, as they end.

    Raises:
        BaseException: What a trial raised.
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
    """Those of most that ask about the same fingers; or that of one who has waited for too long."""
    groups: dict[bytes, list[_Lane]] = {}
    for lane in running:
        assert lane.question is not None
        groups.setdefault(lane.question[FLAGS:].tobytes(), []).append(lane)

    def urgency(group: list[_Lane]) -> tuple[bool, int]:
        return any(lane.waited > LONGEST_WAIT for lane in group), len(group)

    return max(groups.values(), key=urgency, default=[])
