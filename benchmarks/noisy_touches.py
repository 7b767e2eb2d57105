"""What noise of a screen costs: how long a hand waits over its touches, and whether tasks succeed.

    python -m benchmarks.noisy_touches --out out/noisy_touches.jsonl

Trials of the simulated user on training seeds, the whole hand solid, three fingers. White noise is
added to every report of every touch, beside the user's own 0.3 mm. By rules 2 touches rest while
they are slow from step to step; by rules 3 also while they stay where they are.
"""

from __future__ import annotations

import argparse
import os
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from statistics import median
from typing import NamedTuple

from benchmarks.kept_trials import KeptTrials
from benchmarks.machine import describe_machine
from benchmarks.one_line import run
from benchmarks.success import wilson
from encoders.reconstruction.arrival import Phase
from sandbox.options.scene_options import SceneOptions, plan
from sandbox.regress.plan import parse_seeds
from sandbox.session.messages import Snapshot
from sandbox.session.session import Session
from sandbox.trial.headless import run_trial
from tasks.registry import TASKS

NOISES = (0.0, 0.2, 0.5, 1.0, 2.0, 3.0, 5.0)
"""mm, standard deviations of both coordinates."""

RULES = (2, 3)


class Job(NamedTuple):
    """One trial to be played."""

    task: str
    noise: float
    rules: int
    seed: int


@dataclass(frozen=True)
class Played:
    """What a trial gave.

    Attributes:
        success: The goal was held.
        seconds: s until it was held, or until the trial ended.
        waits: s from the moment in which fingers had names until the hand came down, each time.
    """

    success: bool
    seconds: float
    waits: list[float]


class Waits:
    """A view that notes how long the first hand waits over its touches.

    Args:
        session: The session that is watched.
    """

    def __init__(self, session: Session) -> None:
        self._session, self._since, self._before = session, 0.0, Phase.AWAY
        self.waits: list[float] = []

    def __call__(self, snapshot: Snapshot) -> None:
        phase = self._session.reconstructions[0].phase
        if phase is Phase.ABOVE and self._before is not Phase.ABOVE:
            self._since = snapshot.time
        if phase is Phase.COMING_DOWN and self._before is Phase.ABOVE:
            self.waits.append(round(snapshot.time - self._since, 6))
        self._before = phase


def play(job: Job) -> Played:
    """Plays one trial."""
    watched: list[Waits] = []

    def watch(session: Session) -> Sequence[Waits]:
        watched.append(Waits(session))
        return watched

    vary = f"noise={job.noise:g}" if job.noise else ""
    options = SceneOptions(task=job.task, seed=job.seed, fingers=3, solid="hand", vary=vary)
    chosen = plan(options)
    settings = replace(chosen.settings, rules=job.rules)
    done = run_trial(settings, chosen.makers, watch, about=chosen.about)
    return Played(done.success, done.time_s, watched[0].waits)


def rows(done: dict[Job, Played]) -> Iterator[str]:
    """A table of all trials, one line a task, noise and rules."""
    heads = ("task", "noise, mm", "rules", "success [95 %]", "median time, s", "median wait, s")
    yield "| " + " | ".join((*heads, "longest, s")) + " |"
    yield "| --- " * 7 + "|"
    cells: dict[tuple[str, float, int], list[Played]] = {}
    for job in sorted(done):
        cells.setdefault((job.task, job.noise, job.rules), []).append(done[job])
    for (task, noise, rules), trials in cells.items():
        won = [trial for trial in trials if trial.success]
        low, high = wilson(len(won), len(trials))
        waits = [wait for trial in trials for wait in trial.waits]
        time = f"{median(trial.seconds for trial in won):.1f}" if won else ""
        waited = f"{median(waits):.2f} | {max(waits):.2f}" if waits else "|"
        yield (
            f"| {task} | {noise:g} | {rules} | {len(won)}/{len(trials)} "
            f"[{low:.0f}, {high:.0f}] | {time} | {waited} |"
        )


def main() -> None:
    """Plays what is missing, then prints the table."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    tasks = ["box-to-goal", "chords", "gather", "insert"]
    parser.add_argument("--tasks", nargs="+", default=tasks, choices=list(TASKS))
    parser.add_argument("--noise", nargs="+", type=float, default=list(NOISES), help="mm")
    parser.add_argument("--seeds", default="7300:7320", help="first and last but one training seed")
    parser.add_argument("--workers", type=int, default=os.cpu_count() or 1)
    parser.add_argument("--out", type=Path, default=Path("out/noisy_touches.jsonl"))
    options = parser.parse_args()
    jobs = [
        Job(task, noise, rules, seed)
        for seed in parse_seeds(options.seeds)
        for task in options.tasks
        for noise in options.noise
        for rules in RULES
    ]
    kept = KeptTrials(Job, Played, [options.out])
    kept.play(play, jobs, options.workers)
    print(describe_machine())
    print("\n".join(rows(kept.done)))


if __name__ == "__main__":
    run(main)
