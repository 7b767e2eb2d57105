"""`sandbox evaluate` of strangers: what it prints and writes, and what it refuses."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from sandbox.cli.evaluate.asked import is_about_strangers
from sandbox.cli.main import main
from training.population import save_population, simulate_population


def evaluated(capsys: pytest.CaptureFixture[str], *line: str) -> dict[str, Any]:
    assert main(["evaluate", *line, "--json", "-"]) == 0
    said = capsys.readouterr().out
    return json.loads(said[said.index("{") :])


def test_the_options_say_who_is_meant() -> None:
    assert is_about_strangers(["--train", "population"])
    assert is_about_strangers(["--train=population"])
    assert is_about_strangers(["--hold-out=second"]) and is_about_strangers(["--people", "3"])
    assert not is_about_strangers(["--train", "own", "--encoders", "population"])


def test_people_on_whom_nothing_was_trained_are_judged_with_and_without_a_look_at_them(
    capsys: pytest.CaptureFixture[str],
) -> None:
    found = evaluated(capsys, "--train", "population", "--people", "8", "--no-names", "--rest", "6")
    assert found["simulated"] is True
    plain, seen = found["strangers"].values()
    assert 2 <= plain["people"] == seen["people"] <= 8
    for key in ("wrist_cm", "angle_deg"):
        low, high = plain[f"{key}_interval"]
        assert low <= plain[key] <= high
    assert seen["angle_deg"] < plain["angle_deg"] and seen["wrist_cm"] < plain["wrist_cm"]


@pytest.mark.slow
def test_one_persons_models_are_judged_on_the_same_people(
    capsys: pytest.CaptureFixture[str],
) -> None:
    line = ("--people", "4", "--no-names")
    population = evaluated(capsys, "--train", "population", *line)["strangers"]
    own = evaluated(capsys, "--train", "own", *line)["strangers"]
    (first,), (second,) = population.values(), own.values()
    assert first["frames"] == second["frames"] and first["angle_deg"] < second["angle_deg"]


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
    ("line", "told"),
    (
        (["--train", "population", "--people", "0"], "nobody to judge"),
        (["--train", "population", "--rest", "99"], "out of range"),
        (["--train", "own", "--people", "2", "--rest", "3"], "cannot use a rest posture"),
        (["--train", "own", "--hold-out", "first", "--no-names"], "trained on the first subject"),
        (["--hold-out", "second", "--population", "none.npz"], "no such file"),
    ),
)
def test_what_cannot_be_judged_costs_one_line(
    capsys: pytest.CaptureFixture[str], line: list[str], told: str
) -> None:
    assert main(["evaluate", *line]) == 2
    assert told in capsys.readouterr().err


@pytest.mark.slow
def test_own_is_another_day_of_the_same_person(capsys: pytest.CaptureFixture[str]) -> None:
    line = ("--encoders", "mean", "--days", "1", "--no-copas")
    found = evaluated(capsys, *line, "--train", "own")
    assert found["training"]["day"] == 0 != found["tests"][0]["day"]
    assert found["training"]["seed"] == found["tests"][0]["seed"]
