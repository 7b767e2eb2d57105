"""What a comparison would find is said before it is made, from the baseline's own scatter."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from sandbox.cli.regress import main as regress
from sandbox.regress.baseline import Baseline, BaselineTask, BaselineTrial, load_baseline
from sandbox.regress.comparison import compared
from sandbox.regress.detectable_changes import power_of
from sandbox.regress.run_plan import Origin, registered
from tests.support.regress_tasks import Quick

LIMITS = {"quick": 30.0, "other": 30.0}


def baseline(spread: float, n: int = 40, repeats: int = 40) -> Baseline:
    """Two tasks whose times scatter by a share when they are repeated."""
    rng = np.random.default_rng(0)
    tasks = {}
    for name in LIMITS:
        trials = {s: BaselineTrial(True, 1.0, float(rng.uniform(4, 8)), "00") for s in range(n)}
        again = {
            s: BaselineTrial(True, 1.0, trials[s].time_s * float(np.exp(rng.normal(0, spread))), "")
            for s in range(repeats)
        }
        tasks[name] = BaselineTask(1, "here", trials, {}, again)
    return Baseline(Origin({}, {}), tasks, Path("base.json"))


def test_more_seeds_and_less_scatter_find_smaller_changes() -> None:
    few, many = (power_of(baseline(0.05), [*LIMITS], range(n), LIMITS) for n in (20, 80))
    calm = power_of(baseline(0.02), [*LIMITS], range(20), LIMITS)
    for a, b, c in zip(few, many, calm, strict=True):
        assert a.time is not None and b.time is not None and c.time is not None
        assert b.time < 0.6 * a.time and c.time < 0.6 * a.time
    assert few[-1].task == "all tasks" and few[-1].time < min(row.time or 1 for row in few[:-1])


def test_a_change_of_time_of_the_reported_size_is_found_four_times_in_five() -> None:
    made, rng = baseline(0.05, 400, 400), np.random.default_rng(1)
    made = replace(made, tasks={"quick": made.tasks["quick"]})
    (row,) = power_of(made, ["quick"], range(40), LIMITS)
    assert row.time is not None
    kept = [made.tasks["quick"].trials[seed].time_s for seed in range(40)]
    found = 0
    for _ in range(200):
        times = (1.0 + row.time) * np.exp(rng.normal(0.0, 0.05, 40)) * kept
        trials = [
            {"task": "quick", "seed": seed, "success": True, "status": "held"}
            | {"progress": 1.0, "time_s": time}
            for seed, time in enumerate(times.tolist())
        ]
        comparisons, _ = compared({"quick": trials}, made, LIMITS, {}, states=False)
        found += comparisons["quick"].significant
    assert found / 200 == pytest.approx(0.8, abs=0.1)


def test_the_command_repeats_trials_and_names_what_it_would_find(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    words = ["--tasks", "quick", "--seeds", "0:12", "--executor", "serial"]
    words += ["--baseline", str(tmp_path / "base.json")]
    with registered(Quick):
        assert regress([*words, "--update-baseline"]) == 0
        repeats = load_baseline(tmp_path / "base.json").tasks["quick"].repeats
        assert [*repeats] == list(range(10))
        capsys.readouterr()
        assert regress([*words, "--plan", "--json", str(tmp_path / "plan.json")]) == 0
    assert "quick" in capsys.readouterr().out
    (row,) = json.loads((tmp_path / "plan.json").read_text())["power"]
    assert row["pairs"] == 12 and row["time"] > 0.0
