"""`python -m training strangers`: what it prints and writes, and what it refuses."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from training.cli.main import main
from training.population import save_population, simulate_population


def evaluated(capsys: pytest.CaptureFixture[str], *line: str) -> dict[str, Any]:
    assert main(["strangers", *line, "--json", "-"]) == 0
    said = capsys.readouterr().out
    return json.loads(said[said.index("{") :])


def test_people_on_whom_nothing_was_trained_are_judged_with_and_without_a_look_at_them(
    capsys: pytest.CaptureFixture[str],
) -> None:
    found = evaluated(capsys, "--people", "8", "--no-names", "--rest", "6")
    assert found["simulated"] is True
    plain, seen = found["strangers"].values()
    assert 2 <= plain["people"] == seen["people"] <= 8
    for key in ("wrist_cm", "angle_deg"):
        low, high = plain[f"{key}_interval"]
        assert low <= plain[key] <= high
    assert seen["angle_deg"] < plain["angle_deg"] and seen["wrist_cm"] < plain["wrist_cm"]


@pytest.mark.slow
def test_a_generator_is_held_out(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    # People who are posed cost least.
    groups = {"train": {"posed": 30, "second": 1}}
    save_population(simulate_population("held", groups), tmp_path / "p.npz")
    file = str(tmp_path / "p.npz")
    line = ("--hold-out", "second", "--population", file, "--days", "1", "--no-names")
    found = evaluated(capsys, *line)
    (name,) = found["strangers"]
    assert name == "second subject, generator held out"
    assert found["configuration"]["hold_out"] == "second"


@pytest.mark.parametrize(
    "line",
    (
        ["--people", "0"],
        ["--rest", "99"],
        ["--population", "kept.json", "--json", "kept.json"],
        ["--hold-out", "second", "--population", "none.npz"],
    ),
)
def test_what_cannot_be_judged_costs_one_line(
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    line: list[str],
) -> None:
    monkeypatch.chdir(tmp_path)
    assert main(["strangers", *line]) == 2
    assert capsys.readouterr().err.count("\n") == 1
