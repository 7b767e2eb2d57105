"""Kills regression runs at random times, resumes them, and compares with an undisturbed run.

The kinds of kills are: SIGKILL of a worker; SIGTERM to the main process, or to all of its process
group, as some schedulers send it; SIGKILL of the main process. With the extra `ray` these signals
are also sent to a run on Ray, and a Ray cluster on this machine loses a node. Every run has quick
trials in two processes, of which one in three fails. Prints for every kind:

- how many runs were killed before they had ended;
- in how many of these the resumed report has every seed once and is equal to that of an undisturbed
  run, apart from executor, workers and duration;
- in how many of these the file of trials still begins with its content at the kill;
- how many trials had ended at the kill, and how many had crashed.

Every kill is saved in a file. A later run with the same file only adds the kills that are not in
it.

    python -m benchmarks.regress_kills --kills 20
    python -m benchmarks.regress_kills --kills 0 out/regress_kills.jsonl    # prints the saved kills
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
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path
from statistics import median
from tempfile import TemporaryDirectory
from typing import Any, NamedTuple

from rich.console import Console
from rich.table import Table

from benchmarks.kept_trials import KeptTrials
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
"""Time (s) after which a run is ended."""
HOW = ("executor", "workers", "wall_s")
"""Keys of the report that may differ from those of an undisturbed run."""


@dataclass
class Kind:
    """A way to kill a run.

    Attributes:
        name: Name in the table.
        kill: Kills the run or a part of it.
        status: Exit status of a run that was killed before it had ended.
        executor: Executor of the run.
    """

    name: str
    kill: Callable[[Run], None]
    status: int
    executor: str = "processes"


class Kill(NamedTuple):
    """A run that is killed.

    Attributes:
        kind: Name of a kind.
        seeds: Number of trials of the run.
        number: Number of the kill within its kind. The time of the kill depends on it.
    """

    kind: str
    seeds: int
    number: int


@dataclass(frozen=True)
class Outcome:
    """Result of a run that was killed and resumed.

    Attributes:
        in_time: It was killed before it had ended.
        same: Its report has every seed once, and is equal to that of an undisturbed run.
        kept: The file of trials begins with its content at the kill.
        ended: Number of trials that had ended at the kill.
        crashed: Number of trials that had crashed at the kill.
    """

    in_time: bool
    same: bool
    kept: bool
    ended: int
    crashed: int


class Run:
    """A run of the command in a folder."""

    def __init__(self, folder: Path, seeds: int, executor: str, *more: str) -> None:
        self.folder, self.executor = folder, executor
        self.trials = folder / "out.trials.jsonl"
        task = folder / "quick.py"
        task.write_text(TASK)
        words = ["--tasks", str(task), "--arm", "plain", "--seeds", f"0:{seeds}", "--workers", "2"]
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
    """Sends SIGKILL to the process that ran a trial last."""
    text = (run.folder / "worker.pid").read_text()
    while not text:
        text = (run.folder / "worker.pid").read_text()
    os.kill(int(text), signal.SIGKILL)


def main_process(number: int) -> Callable[[Run], None]:
    """Returns a function that sends a signal to the main process."""

    def kill(run: Run) -> None:
        assert run.process is not None
        run.process.send_signal(number)

    return kill


def whole_group(number: int) -> Callable[[Run], None]:
    """Returns a function that sends a signal to all processes of the run."""

    def kill(run: Run) -> None:
        assert run.process is not None
        os.killpg(run.process.pid, number)

    return kill


def lose_node(run: Run) -> None:
    """Kills a node of the Ray cluster with its workers."""
    cluster, node = run.nodes
    cluster.remove_node(node, allow_graceful=False)


def kinds() -> list[Kind]:
    """Returns all kinds of kills that are possible on this machine."""
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
    """Starts a Ray cluster of two nodes on this machine. Yields the cluster, the node to kill, and
    the address."""
    from ray.cluster_utils import Cluster

    cluster = Cluster(initialize_head=True, head_node_args={"num_cpus": 1})
    try:
        yield cluster, cluster.add_node(num_cpus=1), cluster.address
    finally:
        cluster.shutdown()


def kill_once(kind: Kind, run: Run, seeds: int, chance: random.Random) -> Outcome:
    """Starts a run, kills it at a random time, and resumes it until it has every trial."""
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
    # A run that ended before the kill has status 0.
    assert status in (0, kind.status), (run.folder / "log.txt").read_text()
    in_time = status == kind.status
    run.start("--resume")
    assert run.end() == 0, (run.folder / "log.txt").read_text()
    found = [t["seed"] for t in run.report()["trials"]]
    expected = reference(seeds)
    return Outcome(
        in_time=in_time,
        same=found == list(range(seeds)) and run.report() == expected,
        kept=run.trials.read_bytes().startswith(before),
        ended=len(trials) - crashed,
        crashed=crashed,
    )


_REFERENCE: dict[int, dict[str, Any]] = {}


def reference(seeds: int) -> dict[str, Any]:
    """Returns the report of an undisturbed run."""
    if seeds not in _REFERENCE:
        with TemporaryDirectory() as folder:
            run = Run(Path(folder), seeds, "serial")
            run.start()
            assert run.end() == 0, (run.folder / "log.txt").read_text()
            _REFERENCE[seeds] = run.report()
    return _REFERENCE[seeds]


def one_turn(turn: Kill) -> Outcome:
    """Kills and resumes a run in a temporary folder."""
    kind = next(kind for kind in kinds() if kind.name == turn.kind)
    seeds, chance = turn.seeds, random.Random(f"{kind.name} {turn.number}")
    with TemporaryDirectory() as folder:
        if kind.kill is not lose_node:
            return kill_once(kind, Run(Path(folder), seeds, kind.executor), seeds, chance)
        with two_nodes() as (cluster, node, address):
            run = Run(Path(folder), seeds, kind.executor, "--address", address)
            run.nodes = [cluster, node]
            return kill_once(kind, run, seeds, chance)


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument(
        "file", type=Path, nargs="?", default=Path("out/regress_kills.jsonl"), help="file of kills"
    )
    parser.add_argument("--kills", type=int, default=20, help="number of kills of each kind")
    parser.add_argument("--seeds", type=int, default=40, help="number of trials of each run")
    parser.add_argument("--only", default="", help="kinds whose name contains this text")
    options = parser.parse_args()
    console = Console()
    console = Console(width=max(console.width, 140))
    kept = KeptTrials(Kill, Outcome, [options.file])
    tried = [kind.name for kind in kinds() if options.only in kind.name]
    # Kinds take turns, so that an interrupted run has equally many kills of each kind.
    turns = [Kill(kind, options.seeds, number) for number in range(options.kills) for kind in tried]
    with suppress(KeyboardInterrupt):
        kept.play(one_turn, turns, 1)
    console.print(describe_machine(), highlight=False)
    for seeds in sorted({turn.seeds for turn in kept.done}):
        console.print(table(kept.done, seeds))


def table(done: Mapping[Kill, Outcome], seeds: int) -> Table:
    """Makes the table of the runs with `seeds` seeds, with a row for each kind."""
    shown = Table(title=f"runs of {seeds} seeds")
    names = ("runs", "every seed once, same report", "nothing written is lost")
    for name in ("kind", *names, "ended before (median)", "crashed in all"):
        shown.add_column(name, justify="left" if name == "kind" else "right")
    for kind in dict.fromkeys(turn.kind for turn in done if turn.seeds == seeds):
        mine = [o for turn, o in done.items() if turn.kind == kind and turn.seeds == seeds]
        killed = [outcome for outcome in mine if outcome.in_time]
        shown.add_row(
            kind,
            str(len(killed)),
            f"{sum(o.same for o in killed)} of {len(killed)}",
            f"{sum(o.kept for o in killed)} of {len(killed)}",
            f"{median(o.ended for o in mine):.0f}",
            str(sum(o.crashed for o in mine)),
        )
    return shown


if __name__ == "__main__":
    main()
