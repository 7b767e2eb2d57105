"""What is measured of strangers, from Python and by `python -m training strangers`."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from encoders.evaluation.person_model import PersonEstimate, estimated
from encoders.labels.belief import builtin_population_belief
from encoders.regression.trained import builtin
from training.cli.main import main
from training.cli.strangers import (
    StrangerResult,
    calibration_error,
    judge_stranger,
    reliability,
    summary,
)
from training.population import save_population, simulate_population
from training.pose import at_trained_size


def result(right: list[bool], claimed: list[float], error: float = 1.0) -> StrangerResult:
    n = len(right)
    fingers = np.full(n, 3)
    errors = np.full(n, error)
    return StrangerResult(fingers, errors, 10 * errors, np.array(right), np.array(claimed))


def test_true_probabilities_have_no_calibration_error_and_boasting_has_one() -> None:
    rng = np.random.default_rng(0)
    claimed = rng.random(200_000)
    right = rng.random(len(claimed)) < claimed
    assert calibration_error(reliability(claimed, right)) < 0.5
    assert calibration_error(reliability(np.ones(len(claimed)), right)) == pytest.approx(50, abs=1)


def test_intervals_are_over_people() -> None:
    alike = summary([result([True, False] * 50, [0.9] * 100) for _ in range(5)])
    assert alike["labels_percent"]["all"] == 50.0
    assert alike["labels_percent_interval"]["all"] == (50.0, 50.0)
    apart = summary([result([good] * 100, [0.9] * 100, 1.0 + good) for good in (True, False) * 3])
    low, high = apart["labels_percent_interval"]["all"]
    assert low < 30 and high > 70
    assert apart["wrist_cm"] == 1.5 and apart["wrist_cm_interval"][0] < 1.3


def test_a_stranger_is_judged_by_the_estimate_of_the_model() -> None:
    one = simulate_population("strangers", {"judge": {"second": 3}}).people[0]
    capture = at_trained_size(one, one.meta["size"])
    capture = capture.select(capture.trial == capture.trial[0])
    found = judge_stranger(capture, builtin("population"), builtin_population_belief())
    q = estimated(builtin("population"), capture)
    known = PersonEstimate(builtin("population"))
    np.testing.assert_array_equal(q, known.estimate(capture.time, capture.trial, capture.xy))
    wrist = 100 * np.linalg.norm((q - capture.q)[:, :3], axis=1)
    np.testing.assert_allclose(found.wrist, wrist)
    assert ((found.claimed >= 0) & (found.claimed <= 1)).all() and len(found.right) == len(capture)
    without = judge_stranger(capture, builtin("population"), None)
    np.testing.assert_array_equal(without.angle, found.angle)
    assert np.isnan(without.claimed).all()


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
