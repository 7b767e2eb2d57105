"""Success over many seeds; its long runs are those of `.ci/run --full`."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from benchmarks.judged import configuration, freeze, frozen_seeds, judged_seeds
from benchmarks.success import trial, wilson
from models.errors import InputError


def test_the_wilson_interval_is_the_published_one() -> None:
    # Newcombe (1998), Statistics in Medicine 17, table I: 81 of 263 and 0 of 20, method 3.
    assert np.allclose(np.array(wilson(81, 263)) / 100, (0.2553, 0.3662), atol=5e-5)
    assert np.allclose(np.array(wilson(0, 20)) / 100, (0.0, 0.1611), atol=5e-5)


def test_judged_seeds_follow_from_the_frozen_configuration_alone() -> None:
    seeds = judged_seeds(20, "box-to-goal")
    assert seeds == judged_seeds(30, "box-to-goal")[:20]
    assert len(set(seeds)) == 20
    assert not {*seeds} & {*judged_seeds(20, "stack")}
    assert not {*seeds} & {*judged_seeds(20, "box-to-goal", "hand")}


def test_only_the_frozen_configuration_is_judged(tmp_path: Path) -> None:
    frozen = tmp_path / "frozen.json"
    freeze(frozen, configuration())
    seeds = frozen_seeds(5, "stack", "hand", frozen, configuration())
    other_task = configuration()
    other_task["tasks"]["box-to-goal"] += 1
    assert frozen_seeds(5, "stack", "hand", frozen, other_task) == seeds
    changed = configuration()
    changed["settings"]["physics"]["impulse"] *= 2.0
    for now, task in ((changed, "stack"), (other_task, "box-to-goal"), (other_task, "no-such")):
        with pytest.raises(InputError, match=r"benchmarks\.judged --freeze"):
            frozen_seeds(5, task, "hand", frozen, now)


@pytest.mark.full
@pytest.mark.parametrize("fingers", [2, 3, 5])
def test_what_ships_succeeds_in_95_of_100_judged_trials(fingers: int) -> None:
    results = [trial(("box-to-goal", "shipped", fingers, seed)) for seed in judged_seeds(100)]
    assert sum(r["success"] for r in results) >= 95


@pytest.mark.full
@pytest.mark.parametrize("row", ["user does nothing", "user touches at random"])
def test_control_users_succeed_in_under_5_of_100_judged_trials(row: str) -> None:
    results = [trial(("box-to-goal", row, 3, seed)) for seed in judged_seeds(100)]
    assert sum(r["success"] for r in results) < 5
