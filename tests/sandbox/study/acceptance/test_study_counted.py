"""Whatever an experimenter does with trials, each finished one has exactly one attempt that counts,
and no wall clock changes a time."""

from __future__ import annotations

from datetime import UTC, datetime, timedelta
from functools import cache
from typing import Any

from hypothesis import settings
from hypothesis import strategies as st
from hypothesis.stateful import RuleBasedStateMachine, initialize, invariant, precondition, rule

from sandbox.study.design.session_plan import TrialStep, session_plan, trials_of
from sandbox.study.record.state import SessionState
from sandbox.study.tables.trial_table import trial_rows
from sandbox.trial.result import ResultRecord
from tests.support.study_files import design, trial_result


@cache
def plan() -> list[TrialStep]:
    """The trials of a session."""
    return trials_of(session_plan(design(), 1, 1))


RESULT = trial_result().values_for(ResultRecord.JOURNAL)


class Session(RuleBasedStateMachine):
    """A session whose records are made up, beside a model of what counts in it."""

    @initialize()
    def begin(self) -> None:
        self.records: list[dict[str, Any]] = []
        self.clock, self.wall = 0.0, 0.0
        self.attempts: dict[int, int] = {}
        self.counted: dict[int, int] = {}
        self.excluded: set[int] = set()
        self.running = 0
        self.times: list[float] = []
        self.add("session", **ABOUT)

    def add(self, kind: str, **values: Any) -> None:
        """Writes a record a second after the one before."""
        self.clock += 1.0
        time = datetime(2026, 11, 21, tzinfo=UTC) + timedelta(seconds=self.clock + self.wall)
        head = {"n": len(self.records), "time": time.isoformat(), "clock": self.clock, "kind": kind}
        self.records.append({**head, **values})

    def about(self, trial: int) -> dict[str, Any]:
        step = plan()[trial - 1]
        file = f"trials/T{trial:03d}.a{self.attempts[trial]}.jsonl"
        return {"step": step.id, "trial": trial, "attempt": self.attempts[trial], "file": file}

    @rule(seconds=st.floats(-3600.0, 3600.0))
    def set_clock(self, seconds: float) -> None:
        self.wall += seconds

    @precondition(lambda self: not self.running)
    @rule(trial=st.deferred(lambda: st.integers(1, len(plan()))))
    def start(self, trial: int) -> None:
        if trial in self.counted:
            return
        step = plan()[trial - 1]
        self.attempts[trial] = self.attempts.get(trial, 0) + 1
        self.add(
            "trial",
            **self.about(trial),
            block=step.block,
            in_block=step.in_block,
            repetition=step.repetition,
            practice=step.practice,
            levels=step.levels,
            values=step.values,
            seed=step.seed,
        )
        self.running = trial
        self.times.append(self.clock)

    @precondition(lambda self: self.running)
    @rule()
    def end(self) -> None:
        self.add("trial_end", **self.about(self.running), result=RESULT)
        self.times.append(self.clock)
        self.counted[self.running] = self.attempts[self.running]
        self.running = 0

    @precondition(lambda self: self.running)
    @rule(crash=st.booleans())
    def break_off(self, crash: bool) -> None:
        if crash:
            self.add("resume", **ABOUT)
        self.add("trial_end", **self.about(self.running), why="it ended")
        self.excluded.discard(self.running)
        self.running = 0

    @precondition(lambda self: not self.running and self.counted)
    @rule(data=st.data())
    def repeat(self, data: st.DataObject) -> None:
        trial = data.draw(st.sampled_from(sorted(self.counted)))
        self.add(
            "command", command="repeat", step=plan()[trial - 1].id, trial=trial, reason="again"
        )
        del self.counted[trial]
        self.excluded.discard(trial)

    @precondition(lambda self: self.counted)
    @rule(data=st.data())
    def exclude(self, data: st.DataObject) -> None:
        trial = data.draw(st.sampled_from(sorted(self.counted)))
        self.add("command", command="exclude", trial=trial, reason="a cat")
        self.excluded.add(trial)

    @invariant()
    def each_finished_trial_counts_once(self) -> None:
        state = SessionState.of(self.records)
        rows = trial_rows(design(), state)
        found = {r["trial"]: r["attempt"] for r in rows if r["counted"]}
        assert found == self.counted
        assert sum(r["counted"] for r in rows) == len(self.counted)
        assert {r["trial"] for r in rows if r["counted"] and r["excluded"]} == self.excluded
        since = [time - 1.0 for time in self.times]
        assert all(r["started_s"] in since and r["ended_s"] in since for r in rows)
        assert all(r["ended_s"] >= r["started_s"] for r in rows)


ABOUT: dict[str, Any] = {
    "experiment": "quick",
    "mode": "simulated",
    "design": "",
    "session": 1,
    "boot": "one",
    "ppid": "ABCDEF",
    "number": 1,
    "hand": "right",
    "hand_size": 1.0,
    "language": "en",
    "user": None,
}
Session.TestCase.settings = settings(max_examples=25, stateful_step_count=20, deadline=None)
TestSession = Session.TestCase
