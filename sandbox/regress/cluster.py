"""Runs trials on a cluster with Ray. It needs the extra `ray`."""

from __future__ import annotations

import os
import signal
import socket
import threading
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from itertools import chain, islice
from time import monotonic
from typing import Any

from models.errors import HandSandboxError, InputError
from sandbox.regress.execute import (
    SIGNALS,
    STOPS_WITHIN,
    Stopped,
    Trial,
    Trials,
    attempt,
    crashed,
)
from sandbox.regress.run_plan import TrialJob
from sandbox.trial.driver import never

CONNECT_TIMEOUT = 5.0
"""Time (s) to wait for a cluster's answer."""
LOST_AFTER = 300.0
"""Time (s) without any core in the cluster after which the remaining trials are given up. A cluster
that replaces lost machines does so within minutes."""
LOOK_EVERY = 1.0
"""Time (s) between two counts of the cluster's cores."""
JOBS_PER_CORE = 4
"""Number of jobs given to the cluster at a time, per core of the cluster. Ray answers more slowly
with more jobs in a request."""


def need_ray() -> Any:
    """The module `ray`.

    Raises:
        InputError: It is not installed.
    """
    # Ray sends usage statistics to its developers, unless they are disabled before its import.
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
    """Runs trials as tasks of Ray, one core each, on this machine or on a cluster.

    Every machine needs the same version of the sandbox, and the encoder's file if the encoder is a
    file. Different kinds of machines may give different states; every trial has its own
    fingerprint. Ray opens ports to the network, through which any program can run code. Do not use
    Ray on machines without a firewall.

    If a worker or a machine is lost, its trial is reported with its seed, and the run continues
    with the remaining machines.

    Args:
        workers: Number of workers if Ray is started here; a running cluster uses all its workers.
        address: Address of a running cluster, such as `ray://host:10001` or `auto`; None starts Ray
            on this machine.
    """

    name = "ray"

    def __init__(self, workers: int, address: str | None = None) -> None:
        self._ray = need_ray()
        self.workers, self.address = workers, address

    def run(self, jobs: Sequence[TrialJob], stopped: Stopped = never) -> Trials:
        """Yields the trials as they end."""
        ray = self._ray
        self._connect()
        try:
            remote = ray.remote(num_cpus=1, max_retries=0)(attempt)
            waiting, pending = iter(jobs), dict[Any, TrialJob]()
            cores = _Cores(ray)
            while not stopped():
                room = max(JOBS_PER_CORE * cores.count(), 1) - len(pending)
                pending |= {remote.remote(job): job for job in islice(waiting, max(room, 0))}
                if not pending:
                    return
                done, _ = ray.wait(list(pending), num_returns=1, timeout=STOPS_WITHIN)
                for ready in done:
                    yield self._trial(ready, pending.pop(ready))
                if not done and cores.lost():
                    for job in chain(pending.values(), waiting):
                        yield crashed(job, "the cluster has no machine left to run it")
                    return
        except ConnectionError as error:
            raise InputError(
                "the cluster is gone",
                where="--executor ray",
                got=_first_line(error),
                remedy="Start it again; --resume then runs the remaining trials",
            ) from None
        finally:
            ray.shutdown()

    def _trial(self, ready: Any, job: TrialJob) -> Trial:
        try:
            trial = self._ray.get(ready)
        except self._ray.exceptions.RayError as error:
            return crashed(job, f"{type(error).__name__}: {_first_line(error)}")
        if isinstance(trial, HandSandboxError):
            raise trial
        ended: Trial = trial
        return ended

    def _connect(self) -> None:
        options: dict[str, Any] = {"log_to_driver": False, "logging_level": "ERROR"}
        if self.address is None:
            options |= {"num_cpus": self.workers, "include_dashboard": False}
        else:
            options["address"] = _reachable(self.address)
        # Ray installs its own signal handlers, which end this process.
        ours = {number: signal.getsignal(number) for number in SIGNALS}
        try:
            with _blocked_below():
                self._ray.init(**options)
        except (ConnectionError, ValueError, RuntimeError) as error:
            raise InputError(
                "this cluster cannot be reached",
                where="--address",
                got=str(error).partition("\n")[0],
                expected="such as auto or ray://host:10001",
            ) from None
        finally:
            if threading.current_thread() is threading.main_thread():
                for number, how in ours.items():
                    signal.signal(number, how)


@contextmanager
def _blocked_below() -> Iterator[None]:
    """Blocks SIGINT and SIGTERM for all processes that are started in this context.

    A scheduler sends SIGTERM to the whole process group. Without the block, Ray's processes would
    end in any order while this process still waits for their answers, possibly for ever. Ray itself
    blocks SIGINT in the same way.
    """
    before = signal.pthread_sigmask(signal.SIG_BLOCK, SIGNALS)
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


class _Cores:
    """Counts the cores of a cluster, at most every `LOOK_EVERY` seconds.

    It detects when a cluster has had no core for a long time.
    """

    def __init__(self, ray: Any) -> None:
        self._ray = ray
        self._looked = float("-inf")
        self._count = 0
        self._since: float | None = None
        self._seen = False

    def count(self) -> int:
        """The number of cores at the last count."""
        self._count_workers()
        return self._count

    def lost(self) -> bool:
        """True once there has been no core for `LOST_AFTER` seconds."""
        now = self._count_workers()
        return self._since is not None and now - self._since > LOST_AFTER

    def _count_workers(self) -> float:
        now = monotonic()
        if now - self._looked >= LOOK_EVERY:
            self._looked = now
            self._count = int(self._ray.cluster_resources().get("CPU", 0.0))
            if self._count:
                self._seen, self._since = True, None
            elif self._seen and self._since is None:
                self._since = now
        return now


def _first_line(error: Exception) -> str:
    return next(iter(str(error).splitlines()), "")


def _reachable(address: str) -> str:
    """Checks that a server listens at the address. Without a server, Ray would end this process."""
    host, colon, port = address.removeprefix("ray://").rpartition(":")
    if not colon:
        # Ray itself finds `auto` and `local`.
        return address
    try:
        socket.create_connection((host, int(port)), CONNECT_TIMEOUT).close()
    except (OSError, ValueError, OverflowError) as error:
        raise InputError(
            "no server answers at this address",
            where="--address",
            got=f"{address}: {error}",
            expected="such as auto or ray://host:10001",
        ) from None
    return address
