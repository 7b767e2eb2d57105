"""Who has no terminal reads now and then how far a run is, in plain text."""

from __future__ import annotations

import pytest

from sandbox.cli.main import main
from sandbox.regress.plan import registered
from sandbox.regress.show import EVERY, FIRST, PlainLines
from tests.support.regress_tasks import Quick


def test_lines_come_when_they_are_due_and_at_the_end() -> None:
    said: list[str] = []
    now = [0.0]
    lines = PlainLines("", 4, write=said.append, clock=lambda: now[0])
    for time, ended, succeeded in ((FIRST - 1, 1, 1), (FIRST, 2, 1), (FIRST + 1, 3, 2)):
        now[0] = time
        lines.update(ended, succeeded)
    assert said == ["2 of 4 trials, 1 succeeded, about 1 min left"]
    lines.update(4, 3)
    assert said[1:] == ["4 of 4 trials, 3 succeeded"]


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


def test_a_run_without_a_terminal_tells_its_progress_on_standard_error(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    # Some CI servers ask for colours; a bar that moves would fill their logs.
    monkeypatch.setenv("FORCE_COLOR", "1")
    with registered(Quick):
        words = ["--tasks", "quick", "--seeds", "0:3", "--executor", "serial"]
        assert main(["regress", *words]) == 0
        assert capsys.readouterr().err == "3 of 3 trials, 2 succeeded\n"
        assert main(["regress", *words, "--vary", "mass=2"]) == 0
    assert capsys.readouterr().err == (
        "quick, nothing varied: 3 of 3 trials, 2 succeeded\n"
        "quick, mass=2: 3 of 3 trials, 2 succeeded\n"
    )
