"""Measures tasks with several free things: success, points and things toppled, both solidities.

    python -m benchmarks.clutter [--tasks TASK...] [--fingers N...] [--seeds 6100:6130]
                                 [--rooms F...] [--users skilled idle random] [--solid ...]

Trials of the simulated user on training seeds, `population` as it ships. Every row is one task,
one number of fingers, one user and one factor on the task's room; its trials are played with
`--solid fingertips` and with `--solid hand`. Points are those of `tasks.score.points`. `toppled`
are trials that ended because a thing was toppled; `came back` are things that left the surface and
were put back. Times are simulated.
"""

from __future__ import annotations

import argparse
import os
from concurrent.futures import ProcessPoolExecutor
from functools import partial
from statistics import mean, median
from typing import Literal, get_args

from benchmarks.one_line import run
from benchmarks.success import wilson
from sandbox.options.scene_options import SceneOptions, plan
from sandbox.regress.plan import parse_seeds
from sandbox.trial.headless import run_trial
from sandbox.trial.result import TrialResult
from tasks.registry import find_task
from tasks.score import Status, points

TASKS = ("slalom", "gather", "books")
Solid = Literal["fingertips", "hand"]
Kind = Literal["skilled", "idle", "random"]
SOLID: tuple[Solid, ...] = ("fingertips", "hand")
HEADS = ("success [95 %]", "points", "s", "toppled", "came back", "failed seeds")


def play(task: str, fingers: int, user: Kind, room: float, solid: Solid, seed: int) -> TrialResult:
    """Plays one trial."""
    vary = f"room={room:g}" if room != 1.0 else ""
    options = SceneOptions(task=task, seed=seed, fingers=fingers, user=user, solid=solid, vary=vary)
    chosen = plan(options)
    return run_trial(chosen.settings, chosen.makers, about=chosen.about)


def cells(results: list[TrialResult]) -> list[str]:
    """What the trials of one row and one solidity gave, as in `HEADS`."""
    won = [r.time_s for r in results if r.success]
    low, high = wilson(len(won), len(results))
    scores = [
        points(r.success, r.progress, r.time_s, find_task(r.task).time_limit) for r in results
    ]
    return [
        f"{len(won)}/{len(results)} [{low:.0f}, {high:.0f}]",
        f"{mean(scores):.0f}",
        f"{median(won):.1f}" if won else "",
        str(sum(r.status is Status.FAILED for r in results)),
        str(sum(r.respawned for r in results)),
        " ".join(str(r.seed) for r in results if not r.success) if len(won) > 0 else "all",
    ]


def main() -> None:
    """Prints the table."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--tasks", nargs="+", default=TASKS)
    parser.add_argument("--fingers", nargs="+", type=int, default=[3])
    parser.add_argument("--seeds", default="6100:6130", help="first and last but one training seed")
    parser.add_argument("--rooms", nargs="+", type=float, default=[1.0])
    parser.add_argument("--solid", nargs="+", choices=SOLID, default=SOLID)
    parser.add_argument("--users", nargs="+", choices=get_args(Kind), default=["skilled"])
    parser.add_argument("--workers", type=int, default=os.cpu_count() or 1)
    options = parser.parse_args()
    seeds = parse_seeds(options.seeds)
    heads = ["task", "user", "fingers", "room", "solid", *HEADS]
    print("| " + " | ".join(heads) + " |")
    print("| --- " * len(heads) + "|")
    for task in options.tasks:
        for user in options.users:
            for fingers in options.fingers:
                for room in options.rooms:
                    for solid in options.solid:
                        one = partial(play, task, fingers, user, room, solid)
                        with ProcessPoolExecutor(options.workers) as pool:
                            results = list(pool.map(one, seeds))
                        row = [task, user, str(fingers), f"{room:g}", solid, *cells(results)]
                        print("| " + " | ".join(row) + " |", flush=True)


if __name__ == "__main__":
    run(main)
