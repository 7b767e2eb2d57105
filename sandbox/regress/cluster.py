"""Runs trials on a cluster with Ray; the extra `ray`."""

from __future__ import annotations

import os
import socket
from collections.abc import Iterator, Sequence
from typing import Any

from models.errors import HandSandboxError, InputError
from sandbox.regress.execute import HEARD_WITHIN, Stopped, Trial, attempt, crashed, never
from sandbox.regress.plan import TrialJob

CONNECT_TIMEOUT = 5.0
"""s to wait for a cluster's answer."""


def need_ray() -> Any:
    """The module `ray`.

    Raises:
        InputError: It is not installed.
    """
    # Ray tells its makers how it is used, unless it is told not to before it is imported.
    os.environ.setdefault("RAY_USAGE_STATS_ENABLED", "0")
    try:
        import ray
    except ImportError:
        raise InputError(
            "Ray is not installed",
            where="--executor ray",
            remedy="pip install 'hand-sandbox[ray]'",
        ) from None
    return ray


class Cluster:
    """Trials as tasks of Ray, one core each, on this machine or on a cluster.

    Every machine needs the same version of the sandbox, and the encoder's file where it is one.
    Different kinds of machines may give different states: every trial has its own fingerprint.
    Ray opens ports that the network can reach, and whoever reaches them may run code: not for
    machines without a firewall.

    Args:
        workers: Number of workers of a Ray started here; a cluster uses all its workers.
        address: Address of a running cluster, such as `ray://host:10001` or `auto`; None starts Ray
            here.
    """

    name = "ray"

    def __init__(self, workers: int, address: str | None = None) -> None:
        self._ray = need_ray()
        self.workers, self.address = workers, address

    def run(self, jobs: Sequence[TrialJob], stopped: Stopped = never) -> Iterator[Trial]:
        """The trials as they end."""
        ray = self._ray
        self._connect()
        try:
            remote = ray.remote(num_cpus=1, max_retries=0)(attempt)
            pending = {remote.remote(job): job for job in jobs}
            while pending and not stopped():
                done, _ = ray.wait(list(pending), num_returns=1, timeout=HEARD_WITHIN)
                if not done:
                    continue
                ready = done[0]
                job = pending.pop(ready)
                try:
                    trial = ray.get(ready)
                except ray.exceptions.RayError as error:
                    trial = crashed(job, f"{type(error).__name__}: {str(error).splitlines()[0]}")
                if isinstance(trial, HandSandboxError):
                    raise trial
                yield trial
        finally:
            ray.shutdown()

    def _connect(self) -> None:
        options: dict[str, Any] = {"log_to_driver": False, "logging_level": "ERROR"}
        if self.address is None:
            options |= {"num_cpus": self.workers, "include_dashboard": False}
        else:
            options["address"] = _reachable(self.address)
        try:
            self._ray.init(**options)
        except (ConnectionError, ValueError, RuntimeError) as error:
            raise InputError(
                "this cluster cannot be reached",
                where="--address",
                got=str(error).partition("\n")[0],
                expected="such as auto or ray://host:10001",
            ) from None


def _reachable(address: str) -> str:
    """Checks that a server listens at the address: Ray itself would end this process if not."""
    host, colon, port = address.removeprefix("ray://").rpartition(":")
    if not colon:
        # `auto` and `local` are for Ray to find.
        return address
    try:
        socket.create_connection((host, int(port)), CONNECT_TIMEOUT).close()
    except (OSError, ValueError, OverflowError) as error:
        raise InputError(
            "nobody answers there",
            where="--address",
            got=f"{address}: {error}",
            expected="such as auto or ray://host:10001",
        ) from None
    return address
