"""Time since the start of a session, from the monotonic clock in the records of its journal."""

from __future__ import annotations

from datetime import datetime
from typing import Any

CLOCK_STEPS = "clock_steps"
"""Column of `participants.csv` with the steps of the wall clock."""
RUNS = ("session_start", "session_resume")
"""Kinds of the records with which a run of the program begins."""


class SessionClock:
    """Seconds since the session's start, of every record.

    Within a run of the program, and between runs on a machine that was not restarted, time is that
    of the monotonic clock, so that nobody who sets the clock changes it. That clock begins anew
    when a machine starts: the time between two such runs is the wall clock's, and 0 if that went
    backwards.
    """

    def __init__(self) -> None:
        self.of: dict[int, float] = {}
        self._offset: float | None = None
        self._boot = ""
        self._last: dict[str, Any] = {}

    def __getitem__(self, n: int) -> float:
        return self.of[n]

    def take(self, record: dict[str, Any]) -> None:
        """Takes the next record of the journal."""
        if record["kind"] in RUNS:
            self._begin(record)
        if self._offset is not None:
            self.of[record["n"]] = round(record["clock"] + self._offset, 6)
            self._last = record

    def _begin(self, record: dict[str, Any]) -> None:
        boot = record.get("boot", "")
        if self._offset is None:
            self._offset = -record["clock"]
        elif not boot or boot != self._boot:
            wall = datetime.fromisoformat(record["time"]) - datetime.fromisoformat(
                self._last["time"]
            )
            now = self.of[self._last["n"]] + max(0.0, wall.total_seconds())
            self._offset = now - record["clock"]
        self._boot = boot
