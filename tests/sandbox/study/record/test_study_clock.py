"""Times of trials come from the monotonic clock, whatever somebody does to the wall clock."""

from __future__ import annotations

from datetime import UTC, datetime, timedelta, tzinfo
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from sandbox.study.record import journal as journal_module
from sandbox.study.record.folder import SIMULATED, StudyFolder
from sandbox.study.record.state import SessionClock
from sandbox.study.report.data import load_study
from sandbox.study.run.simulated_study import run_simulated
from sandbox.study.share.shared_folder import Masking, share_study
from sandbox.study.share.verify import verify
from tests.support.study_files import TRIALS, design, quiet, rows_of


class SetClock(datetime):
    """The wall clock, which is set back by two hours after a number of readings."""

    left = 12

    @classmethod
    def now(cls, tz: tzinfo | None = None) -> datetime:  # type: ignore[override]
        cls.left -= 1
        return datetime.now(tz) - timedelta(hours=2 if cls.left < 0 else 0)


def test_a_clock_that_is_set_back_changes_no_time_of_a_trial_and_is_told(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    study = StudyFolder(tmp_path / "a", design(), SIMULATED)
    monkeypatch.setattr(journal_module, "datetime", SetClock)
    run_simulated(study, 1, quiet)
    monkeypatch.undo()
    rows = rows_of(study.path / "tables/trials.csv")
    times = [float(row[name]) for row in rows for name in ("started_s", "ended_s")]
    assert len(rows) == TRIALS and times == sorted(times)
    assert times[0] > 0.0 and times[-1] < 600.0
    (person,) = rows_of(study.path / "tables/participants.csv")
    assert float(person["clock_steps"]) == pytest.approx(-7200.0, abs=1.0)
    (line,) = load_study(study.path).clock_steps
    assert f"{person['participant']} {person['clock_steps']} s" in line
    assert verify(study.path, replays=False).sound
    share_study(study, tmp_path / "copy", Masking(), quiet)
    (other,) = rows_of(tmp_path / "copy/tables/participants.csv")
    assert other["clock_steps"] == person["clock_steps"]
    copied = rows_of(tmp_path / "copy/tables/trials.csv")
    assert [(r["started_s"], r["ended_s"]) for r in copied] == [
        (r["started_s"], r["ended_s"]) for r in rows
    ]


def record(n: int, kind: str, clock: float, wall: float, boot: str = "") -> dict[str, Any]:
    time = datetime(2026, 11, 21, tzinfo=UTC) + timedelta(seconds=wall)
    return {"n": n, "kind": kind, "clock": clock, "time": time.isoformat(), "boot": boot}


def seconds(*records: dict[str, Any]) -> list[float]:
    clock = SessionClock()
    for some in records:
        clock.take(some)
    return [clock[r["n"]] for r in records]


def test_after_a_break_on_a_machine_that_was_not_restarted_the_same_clock_goes_on() -> None:
    assert seconds(
        record(0, "session", 100.0, 0.0, "one"),
        record(1, "trial", 110.0, -7200.0),
        record(2, "resume", 500.0, -7000.0, "one"),
        record(3, "trial", 501.0, 0.0),
    ) == [0.0, 10.0, 400.0, 401.0]


@pytest.mark.parametrize("boots", [("one", "two"), ("", "")])
@pytest.mark.parametrize(("wall", "between"), [(3610.0, 3600.0), (-100.0, 0.0)])
def test_between_two_starts_of_a_machine_time_is_the_wall_clocks_and_never_goes_back(
    boots: tuple[str, str], wall: float, between: float
) -> None:
    assert seconds(
        record(0, "session", 100.0, 0.0, boots[0]),
        record(1, "trial", 110.0, 10.0),
        record(2, "resume", 5.0, wall, boots[1]),
        record(3, "trial", 6.0, wall),
    ) == [0.0, 10.0, 10.0 + between, 11.0 + between]


@given(st.lists(st.tuples(st.floats(0.0, 1e4), st.floats(-1e6, 1e6)), min_size=1, max_size=20))
def test_whatever_the_wall_clock_says_no_time_in_a_run_depends_on_it(
    steps: list[tuple[float, float]],
) -> None:
    clocks, records = 50.0, [record(0, "session", 50.0, 0.0)]
    for n, (passed, wall) in enumerate(steps, start=1):
        clocks += passed
        records.append(record(n, "trial_end", clocks, wall))
    assert seconds(*records) == [round(r["clock"] - 50.0, 6) for r in records]
