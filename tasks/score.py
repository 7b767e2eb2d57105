"""Measures and scores a trial: goal reached once, held, and still reached a second later."""

from __future__ import annotations

from dataclasses import dataclass, replace
from enum import StrEnum
from math import isfinite, nan

from models.errors import HandSandboxError, InputError
from models.plugins import failure
from tasks.registry import is_built_in
from tasks.sensing import Sensing
from tasks.task import Measure, Task

AFTERMATH = 1.0
"""Time (s) for which a trial continues after success, to test whether the goal remains reached."""


class Status(StrEnum):
    """State or end of a trial. `failed`: the person did something that ends the trial."""

    RUNNING = "running"
    HELD = "held"
    TIMEOUT = "timeout"
    FAILED = "failed"
    DIVERGED = "diverged"
    INPUT_ENDED = "input_ended"


def ending(status: str, success: bool) -> str:
    """How a trial ended, as a text of one or two words."""
    if status == "running":
        # A trial runs for another second after success, and may be left during this time.
        return "done" if success else "broken off"
    return "done" if success else status.replace("_", " ")


@dataclass(frozen=True)
class Score:
    """The result of a trial so far.

    Attributes:
        instant: True if the goal was reached at some moment.
        held: True if the goal was reached for the hold time without a break; this is success.
        final: True if the goal was reached at the last measure of the trial. After success, this is
            a second after the goal was held.
        status: State or end of the trial.
        progress: Progress, 0 to 1, at the end.
        reason: Text for people that names the missing condition; empty after success.
        time: Simulated time (s) until the goal was held, or until the trial ended.
    """

    instant: bool = False
    held: bool = False
    final: bool = False
    status: Status = Status.RUNNING
    progress: float = 0.0
    reason: str = ""
    time: float = 0.0

    @property
    def success(self) -> bool:
        """True if the goal was held: the main result of a trial."""
        return self.held


def points(success: bool, progress: float, seconds: float, limit: float) -> float:
    """Points, 0 to 100, for a trial.

    They depend only on objects and time. A successful trial has 50 points, and up to 50 more for
    the remaining time. Any other trial has 50 times the progress at its end.

    Args:
        success: True if the goal was held.
        progress: Progress, 0 to 1, at the end.
        seconds: Time (s) until the goal was held, or until the trial ended.
        limit: The task's time limit (s).
    """
    if not success:
        return 50.0 * progress
    return 50.0 + 50.0 * max(1.0 - seconds / limit, 0.0)


def measure(task: Task, sensing: Sensing) -> Measure:
    """Calls a task's `measure`, and checks its result.

    A progress below 0 or above 1 is clipped.

    Raises:
        InputError: `measure` of an external task fails, does not return a valid `Measure`, or tries
            to end the program.
    """
    try:
        result = task.measure(sensing)
    except HandSandboxError:
        raise
    except (Exception, SystemExit) as error:
        if is_built_in(type(task)):
            raise
        ends = isinstance(error, SystemExit)
        raise InputError(
            "`measure` ends the program" if ends else "`measure` of this task fails",
            where=task.name,
            got=failure(error),
            expected="a Measure, such as `return judge(...)`" if ends else None,
        ) from error
    if not isinstance(result, Measure):
        raise InputError(
            "`measure` did not return a Measure",
            where=task.name,
            got=repr(result)[:80],
            expected="a Measure, such as `return judge(...)`",
            remedy="Every branch of `measure` needs a `return`",
        )
    return result if _plain(result) else _made_plain(result, task.name)


def _plain(result: Measure) -> bool:
    """True if all values have Python's own types and are valid."""
    return (
        type(result.reached) is bool
        and type(result.lost) is bool
        and type(result.progress) is float
        and 0.0 <= result.progress <= 1.0
        and isinstance(result.reason, str)
        and (result.first is None or (isinstance(result.first, Measure) and _plain(result.first)))
    )


def _made_plain(result: Measure, task: str) -> Measure:
    """The same measure with values of Python's own types; NumPy's cannot be written to a recording.

    Raises:
        InputError: `reached` or `lost` is neither true nor false, `progress` is not a finite
            number, or `reason` is not text.
    """
    first, returned = result.first, "of the returned Measure"
    if first is not None and not isinstance(first, Measure):
        raise InputError(
            f"`first` {returned} is not a Measure",
            where=task,
            got=repr(first)[:80],
            expected="a Measure",
        )
    if not isinstance(result.reason, str):
        raise InputError(
            f"`reason` {returned} is not text",
            where=task,
            got=repr(result.reason)[:80],
            expected="text",
        )
    try:
        reached, lost = bool(result.reached), bool(result.lost)
    except ValueError:
        raise InputError(
            f"`reached` or `lost` {returned} is neither true nor false",
            where=task,
            got=f"{result.reached!r} and {result.lost!r}"[:80],
            expected="true or false for each",
            remedy="Combine the values of an array with `(...).all()`",
        ) from None
    try:
        progress = float(result.progress)
    except (TypeError, ValueError):
        progress = nan
    if not isfinite(progress):
        raise InputError(
            f"`progress` {returned} is not a finite number",
            where=task,
            got=repr(result.progress)[:80],
            expected="0 to 1",
            remedy="Look for a division by zero",
        )
    return Measure(
        reached,
        min(max(progress, 0.0), 1.0),
        result.reason,
        lost,
        None if first is None else _made_plain(first, task),
    )


class Scorer:
    """Scores one trial, one measure after another."""

    def __init__(self, task: Task) -> None:
        self._task = task
        self._since: float | None = None
        self._held_at: float | None = None
        self._begun = False
        self.score = Score()

    @property
    def over(self) -> bool:
        """True once the trial has ended."""
        return self.score.status is not Status.RUNNING

    def update(self, time: float, measure: Measure) -> Score:
        """Adds the measure at a time (s since the trial's start); returns the score so far."""
        if self.over:
            return self.score
        first = None if self._begun else measure.first
        if first is not None:
            measure = replace(first, reached=False, lost=measure.lost or first.lost)
            if self._lasted(time, first.reached):
                self._begun, self._since = True, None
        elif self._held_at is None and self._lasted(time, measure.reached):
            self._held_at = time
        held = self._held_at is not None
        self.score = Score(
            instant=self.score.instant or measure.reached,
            held=held,
            final=measure.reached,
            progress=measure.progress,
            reason=measure.reason,
            time=time if self._held_at is None else self._held_at,
        )
        if self._held_at is not None and time - self._held_at >= AFTERMATH - 5e-7:
            self._end(Status.HELD)
        elif not held and measure.lost:
            self._end(Status.FAILED)
        elif not held and time >= self._task.time_limit:
            self._end(Status.TIMEOUT)
        return self.score

    def _lasted(self, time: float, reached: bool) -> bool:
        """True once a condition was reached for the hold time without a break."""
        if not reached:
            self._since = None
            return False
        if self._since is None:
            self._since = time
        # Times are sums of steps, so the rule tolerates half a microsecond.
        return time - self._since >= self._task.hold_time - 5e-7

    def abort(self, status: Status, reason: str) -> Score:
        """Ends the trial for a reason outside the task: no more input, or a diverged simulation."""
        if not self.over:
            if self.score.held:
                # A success remains a success; only the test a second later is missing.
                status, reason = Status.HELD, self.score.reason
            self._end(status, reason)
        return self.score

    def _end(self, status: Status, reason: str | None = None) -> None:
        old = self.score
        self.score = Score(
            old.instant,
            old.held,
            old.final,
            status,
            old.progress,
            old.reason if reason is None else reason,
            old.time,
        )
