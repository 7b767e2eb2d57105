"""Kills regression runs at random moments, resumes them, and compares with a run nobody killed.

Kinds: a worker is killed; SIGTERM to the main process, and to all of its process group, as some
schedulers send it; SIGKILL of the main process; with the extra `ray` also these signals to a run on
Ray, and a lost node of a Ray cluster on this machine. Every
run has quick trials in two processes; one of three fails. Prints for every kind:

- how many runs were killed before they had ended;
- in how many of these every seed was in the resumed report once, and the report was that of a run
  that nobody killed, apart from how it was run;
- in how many the file of trials began, after all, with what was in it when the run was killed;
- how many trials had ended by then, and how many crashed.

    python -m benchmarks.regress_kills --kills 20
"""

from __future__ import annotations

import argparse
import json
import os
import random
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from importlib.util import find_spec
from pathlib import Path
from statistics import median
from tempfile import TemporaryDirectory
from typing import Any

from rich.console import Console
from rich.progress import track
from rich.table import Table

from benchmarks.machine import describe_machine

TASK = """
import os
from pathlib import Path
from typing import ClassVar

from tasks.box_to_goal import BoxToGoal
from tasks.task import Measure


class Quick(BoxToGoal):
    name: ClassVar[str] = "quick"
    time_limit: ClassVar[float] = 0.3
    hold_time: ClassVar[float] = 0.1

    def measure(self, sensing):
        Path(__file__).with_name("worker.pid").write_text(str(os.getpid()))
        return Measure(self.seed % 3 > 0, 0.25 if self.seed % 3 == 0 else 1.0, "this seed fails")
"""
LONGEST = 300.0
"""s after which a run is given up."""
HOW = ("executor", "workers", "wall_s")
"""Keys of the report that say how it was run."""


@dataclass
class Kind:
    """A way to kill a run.

    Attributes:
        name: For the table.
        kill: Kills the run, or a part of it.
        status: Exit status of a run that was killed in time.
        executor: Where trials run.
    """

    name: str
    kill: Callable[[Run], None]
    status: int
    executor: str = "processes"
    killed: int = 0
    same: int = 0
    kept: int = 0
    ended: list[int] = field(default_factory=list)
    crashed: int = 0


class Run:
    """A run of the command in a folder."""

    def __init__(self, folder: Path, seeds: int, executor: str, *more: str) -> None:
        self.folder, self.executor = folder, executor
        self.trials = folder / "out.trials.jsonl"
        task = folder / "quick.py"
        task.write_text(TASK)
        words = ["--tasks", str(task), "--seeds", f"0:{seeds}", "--workers", "2"]
        self.command = [sys.executable, "-m", "sandbox.cli.main", "regress", *words, *more]
        self.process: subprocess.Popen[bytes] | None = None
        self.nodes: list[Any] = []

    def start(self, *more: str) -> None:
        out = ["--executor", self.executor, "--json", str(self.folder / "out.json"), *more]
        log = (self.folder / "log.txt").open("ab")
        self.process = subprocess.Popen(
            [*self.command, *out], stdout=log, stderr=log, start_new_session=True
        )

    def end(self) -> int:
        assert self.process is not None
        return self.process.wait(LONGEST)

    def lines(self) -> int:
        return self.trials.read_bytes().count(b"\n") if self.trials.exists() else 0

    def report(self) -> dict[str, Any]:
        report: dict[str, Any] = json.loads((self.folder / "out.json").read_text())
        report["tasks"]["quick"]["failed"] = [
            {k: v for k, v in each.items() if k != "command"}
            for each in report["tasks"]["quick"]["failed"]
        ]
        return {k: v for k, v in report.items() if k not in HOW}


def kill_worker(run: Run) -> None:
    """SIGKILL of the process that ran a trial last."""
    text = (run.folder / "worker.pid").read_text()
    while not text:
        text = (run.folder / "worker.pid").read_text()
    os.kill(int(text), signal.SIGKILL)


def main_process(number: int) -> Callable[[Run], None]:
    """A signal to the main process."""

    def kill(run: Run) -> None:
        assert run.process is not None
        run.process.send_signal(number)

    return kill


def whole_group(number: int) -> Callable[[Run], None]:
    """A signal to all processes of the run."""

    def kill(run: Run) -> None:
        assert run.process is not None
        os.killpg(run.process.pid, number)

    return kill


def lose_node(run: Run) -> None:
    """SIGKILL of a node with its workers."""
    cluster, node = run.nodes
    cluster.remove_node(node, allow_graceful=False)


def kinds() -> list[Kind]:
    """All that this machine can try."""
    found = [
        Kind("a worker is killed", kill_worker, 1),
        Kind("SIGTERM", main_process(signal.SIGTERM), 143),
        Kind("SIGTERM to the process group", whole_group(signal.SIGTERM), 143),
        Kind("SIGKILL of the main process", main_process(signal.SIGKILL), -9),
    ]
    if find_spec("ray") is not None:
        found += [
            Kind("Ray, SIGTERM", main_process(signal.SIGTERM), 143, "ray"),
            Kind("Ray, SIGTERM to the process group", whole_group(signal.SIGTERM), 143, "ray"),
            Kind("Ray, SIGKILL of the main process", main_process(signal.SIGKILL), -9, "ray"),
            Kind("Ray, a lost node", lose_node, 1, "ray"),
        ]
    return found


@contextmanager
def two_nodes() -> Iterator[tuple[Any, Any, str]]:
    """A Ray cluster of two nodes on this machine: (cluster, the one to lose, address)."""
    from ray.cluster_utils import Cluster

    cluster = Cluster(initialize_head=True, head_node_args={"num_cpus": 1})
    try:
        yield cluster, cluster.add_node(num_cpus=1), cluster.address
    finally:
        cluster.shutdown()


def kill_once(kind: Kind, run: Run, seeds: int, chance: random.Random) -> None:
    """Starts a run, kills it at some moment and resumes it until it has every trial."""
    run.start()
    wanted, began = 1 + chance.randrange(seeds * 3 // 4), time.monotonic()
    assert run.process is not None
    while run.lines() < wanted or not (run.folder / "worker.pid").exists():
        assert run.process.poll() is None and time.monotonic() < began + LONGEST, kind.name
        time.sleep(0.001)
    time.sleep(chance.uniform(0.0, 0.05))
    if run.process.poll() is None:
        kind.kill(run)
    status = run.end()
    before = run.trials.read_bytes()
    before = before[: before.rfind(b"\n") + 1]
    records = [json.loads(line) for line in before.splitlines()]
    trials = [record["trial"] for record in records if "trial" in record]
    crashed = sum(trial["status"] == "crashed" for trial in trials)
    # A run that ended before has status 0.
    assert status in (0, kind.status), (run.folder / "log.txt").read_text()
    in_time = status == kind.status
    run.start("--resume")
    assert run.end() == 0, (run.folder / "log.txt").read_text()
    found = [t["seed"] for t in run.report()["trials"]]
    expected = reference(seeds)
    kind.killed += in_time
    kind.crashed += crashed
    kind.ended.append(len(trials) - crashed)
    kind.same += in_time and found == list(range(seeds)) and run.report() == expected
    kind.kept += in_time and run.trials.read_bytes().startswith(before)


_REFERENCE: dict[int, dict[str, Any]] = {}


def reference(seeds: int) -> dict[str, Any]:
    """The report of a run that nobody killed."""
    if seeds not in _REFERENCE:
        with TemporaryDirectory() as folder:
            run = Run(Path(folder), seeds, "serial")
            run.start()
            assert run.end() == 0, (run.folder / "log.txt").read_text()
            _REFERENCE[seeds] = run.report()
    return _REFERENCE[seeds]


def one_turn(kind: Kind, seeds: int, chance: random.Random) -> None:
    """A run in a folder of its own."""
    with TemporaryDirectory() as folder:
        if kind.kill is not lose_node:
            kill_once(kind, Run(Path(folder), seeds, kind.executor), seeds, chance)
            return
        with two_nodes() as (cluster, node, address):
            run = Run(Path(folder), seeds, kind.executor, "--address", address)
            run.nodes = [cluster, node]
            kill_once(kind, run, seeds, chance)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--kills", type=int, default=20, help="of each kind")
    parser.add_argument("--seeds", type=int, default=40, help="trials of each run")
    parser.add_argument("--only", default="", help="kinds whose name contains this")
    options = parser.parse_args()
    console = Console()
    console = Console(width=max(console.width, 140))
    reference(options.seeds)
    tried = [kind for kind in kinds() if options.only in kind.name]
    # Kinds take turns, so that what is printed after Ctrl-C is balanced.
    turns = [(number, kind) for number in range(options.kills) for kind in tried]
    with suppress(KeyboardInterrupt):
        for number, kind in track(turns, "killing", console=Console(stderr=True)):
            one_turn(kind, options.seeds, random.Random(f"{kind.name} {number}"))
    console.print(describe_machine(), highlight=False)
    table = Table(title=f"runs of {options.seeds} seeds")
    names = ("runs", "every seed once, same report", "nothing written is lost")
    for name in ("kind", *names, "ended before (median)", "crashed in all"):
        table.add_column(name, justify="left" if name == "kind" else "right")
    for kind in tried:
        counts = (f"{kind.same} of {kind.killed}", f"{kind.kept} of {kind.killed}")
        crashed = str(kind.crashed)
        table.add_row(kind.name, str(kind.killed), *counts, f"{median(kind.ended):.0f}", crashed)
    console.print(table)


if __name__ == "__main__":
    main()
