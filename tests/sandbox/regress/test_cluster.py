"""A cluster gets its trials little by little, and gives all of them back."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest

from sandbox.regress import cluster
from sandbox.regress.cluster import JOBS_PER_CORE, Cluster
from sandbox.regress.run_plan import RegressionPlan

CORES = 2


def test_a_cluster_has_at_most_four_jobs_a_core_at_a_time(monkeypatch: pytest.MonkeyPatch) -> None:
    pending, counts = list[int](), list[int]()

    def submit(job: Any) -> int:
        pending.append(job.seed)
        counts.append(len(pending))
        return pending[-1]

    def wait(jobs: list[int], num_returns: int, timeout: float) -> tuple[list[int], list[int]]:
        """A job is done when it is waited for."""
        assert set(jobs) == set(pending) and num_returns == 1
        return [pending.pop(0)], pending

    ray = SimpleNamespace(
        exceptions=SimpleNamespace(RayError=RuntimeError),
        init=lambda **options: None,
        shutdown=lambda: None,
        cluster_resources=lambda: {"CPU": float(CORES)},
        remote=lambda **options: lambda function: SimpleNamespace(remote=submit),
        wait=wait,
        get=lambda job: {"seed": job},
    )
    monkeypatch.setattr(cluster, "need_ray", lambda: ray)
    jobs = RegressionPlan(("box-to-goal",), tuple(range(50))).jobs()
    trials = list(Cluster(CORES).run(jobs))
    assert sorted(trial["seed"] for trial in trials) == list(range(50))
    assert max(counts) == JOBS_PER_CORE * CORES == 8
