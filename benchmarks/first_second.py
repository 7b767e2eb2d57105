"""How often all fingers are named right in the first second of a touch, over the tasks.

    python -m benchmarks.first_second
    python -m benchmarks.first_second --seeds 10 --labels history      # a quick look
    python -m benchmarks.first_second --tasks stack --fingers 2 3

The simulated user plays every task with 2, 3, 4 and 5 fingers. From the first touch of each hand
on, every frame of one second counts by the number of fingers that touch in it: right if all of them
have their own names. Frames in which the fingers have no names yet, as a hand is named once its
contacts have stayed the same for 0.1 s, are told apart: one row counts them as wrong. Fewer fingers
touch than the user was asked for where an object has no room for them, and while a hand comes down.
Intervals are over trials. SIMULATED: no person took part.
"""

from __future__ import annotations

import argparse
import os
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, field
from itertools import product
from typing import Literal, get_args

import numpy as np
from rich.console import Console
from rich.progress import Progress
from rich.table import Table

from benchmarks.judged import FIRST
from sandbox.options.scene_options import SceneOptions, plan
from sandbox.session.messages import Snapshot
from sandbox.session.session import Session
from sandbox.trial.driver import open_trial

WINDOW = 1.0
"""s from a hand's first touch on, that count."""
FINGERS = (2, 3, 4, 5)
"""Numbers of touching fingers that are told apart."""
LATEST = 10.0
"""s, at which a trial without any touch is given up."""

Labels = Literal["population", "history"]
Job = tuple[str, int, int, Labels]
"""Task, number of fingers, seed, labels."""


@dataclass
class Counts:
    """Frames of one trial by the number of touching fingers.

    Attributes:
        right: Frames in which all of them are named right.
        named: Frames in which all of them have names.
        all: Frames.
    """

    right: dict[int, int] = field(default_factory=lambda: dict.fromkeys(FINGERS, 0))
    named: dict[int, int] = field(default_factory=lambda: dict.fromkeys(FINGERS, 0))
    all: dict[int, int] = field(default_factory=lambda: dict.fromkeys(FINGERS, 0))


class FirstSeconds:
    """Counts the frames of a trial: a view of its snapshots.

    Args:
        session: The trial's session.

    Attributes:
        counts: Frames so far.
        over: True once every hand has had its second.
    """

    def __init__(self, session: Session) -> None:
        self._devices = [rig.device for rig in session.rigs]
        self._first: list[float | None] = [None] * len(session.rigs)
        self.counts = Counts()
        self.over = False

    def __call__(self, snapshot: Snapshot) -> None:
        """Counts a frame for every hand."""
        now = snapshot.time
        for hand, view in enumerate(snapshot.hands):
            touching = [c for c in view.contacts if c.state == "active"]
            first = self._first[hand]
            if first is None and touching:
                first = self._first[hand] = now
            if first is None or now > first + WINDOW or len(touching) not in self.counts.all:
                continue
            truth = self._devices[hand].truth
            many, named = len(touching), all(c.label is not None for c in touching)
            self.counts.all[many] += 1
            self.counts.named[many] += named
            self.counts.right[many] += named and all(c.label == truth[c.id] for c in touching)
        ends = [LATEST if first is None else first + WINDOW for first in self._first]
        self.over = now > max(ends)


def trial(job: Job) -> Counts:
    """Plays the beginning of one trial."""
    task, fingers, seed, labels = job
    chosen = plan(SceneOptions(task=task, seed=seed, fingers=fingers, labels=labels))
    counting: list[FirstSeconds] = []

    def views(session: Session) -> list[FirstSeconds]:
        counting.append(FirstSeconds(session))
        return counting

    with open_trial(chosen.settings, chosen.makers, views, about=chosen.about) as played:
        played.run(stop=lambda: counting[0].over)
    return counting[0].counts


def share(trials: Sequence[Counts], fingers: int, of_all: bool = False) -> str:
    """Percent of frames that are right, with a 95 % interval over trials, and their number.

    Args:
        trials: Trials.
        fingers: Number of touching fingers.
        of_all: True also counts frames in which they have no names yet.
    """
    of = [t.all[fingers] if of_all else t.named[fingers] for t in trials]
    sums = np.array([(t.right[fingers], n) for t, n in zip(trials, of, strict=True) if n], float)
    if not len(sums):
        return "-"
    rng = np.random.default_rng(0)
    drawn = sums[rng.integers(len(sums), size=(2000, len(sums)))].sum(axis=1)
    low, high = 100 * np.percentile(drawn[:, 0] / drawn[:, 1], [2.5, 97.5])
    right, frames = sums.sum(axis=0)
    return f"{100 * right / frames:.0f} [{low:.0f}, {high:.0f}] of {frames:.0f}"


def main() -> None:
    """Prints the table."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--tasks", nargs="+", choices=FIRST, default=FIRST)
    parser.add_argument("--seeds", type=int, default=20, help="trials: seeds 0 to N - 1 of each")
    parser.add_argument("--fingers", type=int, nargs="+", choices=FINGERS, default=list(FINGERS))
    parser.add_argument("--labels", choices=get_args(Labels), default="population")
    parser.add_argument("--workers", type=int, default=os.cpu_count() or 1)
    options = parser.parse_args()
    jobs = [
        (task, fingers, seed, options.labels)
        for task, seed, fingers in product(options.tasks, range(options.seeds), options.fingers)
    ]
    # One thread a process: the machine's cores are the processes' already.
    os.environ["OMP_NUM_THREADS"] = "1"
    bars = Progress(console=Console(stderr=True))
    with bars, ProcessPoolExecutor(options.workers) as pool:
        counts = list(bars.track(pool.map(trial, jobs), total=len(jobs)))
    names = [f"{fingers} fingers" for fingers in FINGERS]
    table = Table(f"first second, % right, labels {options.labels}", *names)
    for task in options.tasks:
        own = [c for c, job in zip(counts, jobs, strict=True) if job[0] == task]
        table.add_row(task, *(share(own, fingers) for fingers in FINGERS))
    table.add_row("all", *(share(counts, fingers) for fingers in FINGERS), style="bold")
    whole = (share(counts, fingers, of_all=True) for fingers in FINGERS)
    table.add_row("all, with frames without names", *whole)
    Console(width=120).print(table)


if __name__ == "__main__":
    main()
