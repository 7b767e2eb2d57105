"""Who has no terminal reads now and then how far a run is, in plain text."""

from __future__ import annotations

from sandbox.regress.console_report import EVERY, PlainLines


def test_time_that_is_left_is_told_from_the_trials_of_this_run_alone() -> None:
    said: list[str] = []
    now = [0.0]
    lines = PlainLines("dial, size=0.8", 100, 50, said.append, lambda: now[0])
    now[0] = 600.0
    lines.update(60, 50)
    assert said == ["dial, size=0.8: 60 of 100 trials, 50 succeeded, about 40 min left"]
    now[0] += EVERY - 1
    lines.update(61, 51)
    assert len(said) == 1
