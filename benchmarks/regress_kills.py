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

Every kill is kept in a file. Started again with the same file, it goes on with the kills that are
not in it.

    python -m benchmarks.regress_kills --kills 20
    python -m benchmarks.regress_kills --kills 0 out/regress_kills.jsonl    # shows what is kept
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


class Kill(NamedTuple):
    """A run that is killed.

    Attributes:
        kind: Name of a kind.
        seeds: Trials of the run.
        number: Which of the kind's kills; its moment depends on it.
    """

    kind: str
    seeds: int
    number: int


@dataclass(frozen=True)
class Outcome:
    """What became of a run that was killed and resumed.

    Attributes:
        in_time: It was killed before it had ended.
        same: Every seed is in its report once, and the report is that of a run nobody killed.
        kept: The file of trials begins with what was in it when the run was killed.
        ended: Trials that had ended by then.
        crashed: Trials that had crashed by then.
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


def kill_once(kind: Kind, run: Run, seeds: int, chance: random.Random) -> Outcome:
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
    return Outcome(
        in_time=in_time,
        same=found == list(range(seeds)) and run.report() == expected,
        kept=run.trials.read_bytes().startswith(before),
        ended=len(trials) - crashed,
        crashed=crashed,
    )


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


def one_turn(turn: Kill) -> Outcome:
    """A run in a folder of its own."""
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
        "file", type=Path, nargs="?", default=Path("out/regress_kills.jsonl"), help="keeps kills"
    )
    parser.add_argument("--kills", type=int, default=20, help="of each kind")
    parser.add_argument("--seeds", type=int, default=40, help="trials of each run")
    parser.add_argument("--only", default="", help="kinds whose name contains this")
    options = parser.parse_args()
    console = Console()
    console = Console(width=max(console.width, 140))
    kept = KeptTrials(Kill, Outcome, [options.file])
    tried = [kind.name for kind in kinds() if options.only in kind.name]
    # Kinds take turns, so that what is kept when it is stopped is balanced.
    turns = [Kill(kind, options.seeds, number) for number in range(options.kills) for kind in tried]
    with suppress(KeyboardInterrupt):
        kept.play(one_turn, turns, 1)
    console.print(describe_machine(), highlight=False)
    for seeds in sorted({turn.seeds for turn in kept.done}):
        console.print(table(kept.done, seeds))


def table(done: Mapping[Kill, Outcome], seeds: int) -> Table:
    """Counts of the runs of so many seeds, a row for each kind."""
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
