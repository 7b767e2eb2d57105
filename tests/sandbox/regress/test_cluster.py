"""A cluster gets its trials little by little, and gives all of them back."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from types import SimpleNamespace
from typing import Any

import pytest

from sandbox.regress import cluster
from sandbox.regress.cluster import JOBS_PER_CORE, Cluster
from sandbox.regress.run_plan import RegressionPlan

CORES = 2


class FakeRay:
    """The part of Ray that a cluster needs; a job is done when it is waited for.

    Attributes:
        most: Largest number of jobs that were submitted and not yet done.
    """

    exceptions = SimpleNamespace(RayError=RuntimeError)

    def __init__(self) -> None:
        self.pending: list[Any] = []
        self.most = 0

    def init(self, **options: Any) -> None:
        """Connects to nothing."""

    def shutdown(self) -> None:
        """Ends nothing."""

    def cluster_resources(self) -> dict[str, float]:
        """The cores of the cluster."""
        return {"CPU": float(CORES)}

    def remote(self, **options: Any) -> Callable[[Any], Any]:
        """A decorator of functions that run elsewhere."""
        return lambda function: SimpleNamespace(remote=self._submit)

    def wait(
        self, jobs: Sequence[Any], num_returns: int, timeout: float
    ) -> tuple[list[Any], list[Any]]:
        """The first job, done, and the others."""
        assert set(jobs) == set(self.pending)
        done = self.pending[:num_returns]
        self.pending = self.pending[num_returns:]
        return done, self.pending

    def get(self, job: int) -> dict[str, Any]:
        """The result of a job."""
        return {"seed": job}

    def _submit(self, job: Any) -> int:
        self.pending.append(job.seed)
        self.most = max(self.most, len(self.pending))
        return int(job.seed)


def test_a_cluster_has_at_most_four_jobs_a_core_at_a_time(monkeypatch: pytest.MonkeyPatch) -> None:
    ray = FakeRay()
    monkeypatch.setattr(cluster, "need_ray", lambda: ray)
    jobs = RegressionPlan(("box-to-goal",), tuple(range(50))).jobs()
    trials = list(Cluster(CORES).run(jobs))
    assert sorted(trial["seed"] for trial in trials) == list(range(50))
    assert ray.most == JOBS_PER_CORE * CORES == 8
