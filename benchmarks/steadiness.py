"""How steadily a solid hand is led clear of things, and what that costs.

    python -m benchmarks.steadiness --tasks books slalom --seeds 9000:9030
    python -m benchmarks.steadiness --tasks books --steady 1000 0.3 0.17 --tau 0.03

Trials of the simulated user on training seeds with `--solid hand`. Each row is one setting of
`sandbox.clearing.clearing`: STEADY, where 1000 is as if there was none, and TAU. *To and fro* is
what the correction of the pose takes back in the next control step, mean over all joints' numbers
added up and over all steps in which the hand is led, mrad; the palm's place counts with 10 rad to a
metre, as in the limit of speed. *At full speed* is the share of those steps in which the correction
changes as fast as it may. The largest push is that of palm and free fingers on things.
"""

from __future__ import annotations

import argparse
import os
from collections.abc import Callable, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from itertools import product
from statistics import mean, median
from typing import NamedTuple

import numpy as np

from benchmarks import methods
from benchmarks.machine import describe_machine
from benchmarks.methods import METHODS, SHIPS, scored_trial
from benchmarks.one_line import run
from benchmarks.solid_hand import Pushes
from models.arithmetic.arrays import Array
from models.pose import ROOT_POSITION
from models.scene import CONTROL_PERIOD
from sandbox.clearing import clearing
from sandbox.regress.plan import parse_seeds
from sandbox.session.messages import Snapshot
from sandbox.session.session import Session
from tasks.registry import TASKS


class Job(NamedTuple):
    """One trial with one setting."""

    task: str
    method: str
    steady: float
    tau: float
    seed: int


class Changes:
    """A view that adds up how the corrections of a session change.

    Attributes:
        steps: Control steps in which a hand was led, as well as in the two before.
        full: Those in which the correction changed as fast as it may.
        back: rad that were taken back, over all of them.
    """

    def __init__(self, session: Session) -> None:
        self._session = session
        self._before: list[list[Array]] = [[] for _ in session.rigs]
        self.steps = self.full = 0
        self.back = 0.0

    def __call__(self, snapshot: Snapshot) -> None:
        """Reads the corrections after a control step."""
        for hand, before in enumerate(self._before):
            correction = self._session.correction(hand)
            if correction is None:
                before.clear()
                continue
            before.append(correction)
            if len(before) == 3:
                last, now = np.diff(before, axis=0)
                for change in (last, now):
                    change[ROOT_POSITION] *= 10.0
                del before[0]
                self.steps += 1
                self.full += bool(np.abs(now).max() > 0.98 * clearing.SPEED * CONTROL_PERIOD)
                turned = last * now < 0.0
                self.back += float(np.minimum(np.abs(last), np.abs(now))[turned].sum())


@dataclass(frozen=True)
class Played:
    """One trial: success, points, s, N of the largest push, and the changes of its corrections."""

    success: bool
    points: float
    seconds: float
    push: float
    steps: int
    full: int
    back: float


def play(job: Job) -> Played:
    """Plays one trial."""
    clearing.STEADY, clearing.TAU = job.steady, job.tau
    seen: list[Changes] = []
    pushes: list[Pushes] = []

    def watch(session: Session) -> Sequence[Callable[[Snapshot], None]]:
        seen.append(Changes(session))
        pushes.append(Pushes(session))
        return [seen[0], pushes[0]]

    done, score = scored_trial(methods.Job(job.task, job.method, "hand", 3, job.seed), watch)
    return Played(
        done.success,
        score,
        done.time_s,
        pushes[0].largest,
        seen[0].steps,
        seen[0].full,
        seen[0].back,
    )


def row(job: Job, plays: Sequence[Played]) -> str:
    """One line of the table."""
    steps = max(sum(p.steps for p in plays), 1)
    pushes = [p.push for p in plays]
    cells = (
        *(job.task, job.method, f"{job.steady:g}", f"{job.tau:g}"),
        f"{sum(p.success for p in plays)}/{len(plays)}",
        f"{mean(p.points for p in plays):.1f}",
        f"{median(p.seconds for p in plays):.1f}",
        f"{mean(pushes):.1f}, {max(pushes):.1f}",
        f"{1000.0 * sum(p.back for p in plays) / steps:.1f}",
        f"{100.0 * sum(p.full for p in plays) / steps:.1f} %",
    )
    return "| " + " | ".join(cells) + " |"


def main() -> None:
    """Prints the table."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--tasks", nargs="+", default=["books", "slalom"], choices=list(TASKS))
    parser.add_argument("--methods", nargs="+", default=[SHIPS], choices=list(METHODS))
    parser.add_argument("--steady", nargs="+", type=float, default=[1000.0, clearing.STEADY])
    parser.add_argument("--tau", nargs="+", type=float, default=[clearing.TAU], help="s")
    parser.add_argument("--seeds", default="9000:9030", help="first and last but one training seed")
    parser.add_argument("--workers", type=int, default=os.cpu_count() or 1)
    options = parser.parse_args()
    seeds = parse_seeds(options.seeds)
    print(describe_machine())
    heads = ("task", "method", "STEADY", "TAU, s", "succeeded", "points", "s")
    print("| " + " | ".join((*heads, "push: mean, max (N)", "to and fro, mrad", "at full speed")))
    print("| --- " * 10 + "|")
    # One thread a process: the machine's cores are the processes' already.
    os.environ["OMP_NUM_THREADS"] = "1"
    with ProcessPoolExecutor(options.workers) as pool:
        for task, method, tau, steady in product(
            options.tasks, options.methods, options.tau, options.steady
        ):
            jobs = [Job(task, method, steady, tau, seed) for seed in seeds]
            print(row(jobs[0], list(pool.map(play, jobs))), flush=True)


if __name__ == "__main__":
    run(main)
