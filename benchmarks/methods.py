"""Compares methods that turn touches into a hand, in every task: who differs from what ships?

    python -m benchmarks.methods --seeds 7000:7150 --out out/methods.jsonl
    python -m benchmarks.methods --tasks insert slalom --methods "mean pose" --seeds 7000:7010
    python -m benchmarks.methods --table out/methods.jsonl [MORE.jsonl ...]

Trials of the simulated user on training seeds. Mean pose, linear, quadratic, cubic, what ships and
true labels have the labels, correction and filter of what ships, and differ in the encoder or in
the names of fingers; PCA-IK has them, too. Bare is what ships without correction and filter, and
the paper's method is the paper's alone; both keep our rules of arrival. Columns: success with its
Wilson interval; points of `tasks.score.points` with a t interval of their mean; median time of
successes; trials that ended because something was toppled; things that left the surface and were
put back; the largest push, N, of palm and free fingers on things: median and largest of trials.

Every method is compared with what ships, on the seeds that both have played: exact McNemar tests of
success and Wilcoxon signed-rank tests of points, two-sided, and Holm over all of them together.
Trials are kept as they end, so that a run can be stopped, resumed and split.
"""

from __future__ import annotations

import argparse
import os
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import product
from math import sqrt
from pathlib import Path
from statistics import mean, median, stdev
from typing import Any, NamedTuple

import numpy as np
from scipy.stats import binomtest, t, wilcoxon

from benchmarks.kept_trials import KeptTrials
from benchmarks.machine import describe_machine
from benchmarks.one_line import run
from benchmarks.solid_hand import Pushes
from benchmarks.success import wilson
from sandbox.options.scene_options import SceneOptions, plan
from sandbox.regress.statistics import holm
from sandbox.session.session import Session
from sandbox.trial.driver import ViewMaker
from sandbox.trial.headless import run_trial
from sandbox.trial.result import TrialResult
from tasks.registry import TASKS, find_task
from tasks.score import Status, points

SHIPS = "what ships"
METHODS: dict[str, dict[str, Any]] = {
    "mean pose": {"without": ("encoder",)},
    "linear": {"encoder": "linear"},
    "quadratic": {"encoder": "quadratic"},
    "cubic": {"encoder": "cubic"},
    SHIPS: {},
    "true labels": {"tell_labels": True},
    "pca-ik": {"encoder": "pca-ik"},
    "bare": {"bare": True},
    "the paper's": {"encoder": "paper"},
}
"""Options of a trial by the name of a method."""

SOLID = ("fingertips", "hand")


class Job(NamedTuple):
    """One trial to be played."""

    task: str
    method: str
    solid: str
    fingers: int
    seed: int


@dataclass(frozen=True)
class Played:
    """What a trial gave.

    Attributes:
        success: The goal was held.
        points: 0 to 100.
        seconds: s until it was held, or until the trial ended.
        toppled: It ended because a thing was toppled.
        back: Number of things that left the surface and were put back.
        push: N, the largest one of palm and free fingers on things.
    """

    success: bool
    points: float
    seconds: float
    toppled: bool
    back: int
    push: float


def scored_trial(job: Job, make_views: ViewMaker) -> tuple[TrialResult, float]:
    """Plays one trial: its result, and its points of `tasks.score.points`."""
    options = {"solid": job.solid, "fingers": job.fingers, **METHODS[job.method]}
    chosen = plan(SceneOptions(task=job.task, seed=job.seed, **options))
    done = run_trial(chosen.settings, chosen.makers, make_views, about=chosen.about)
    limit = find_task(job.task).time_limit
    return done, points(done.success, done.progress, done.time_s, limit)


def play(job: Job) -> Played:
    """Plays one trial."""
    watched: list[Pushes] = []

    def watch(session: Session) -> Sequence[Pushes]:
        watched.append(Pushes(session))
        return watched

    done, score = scored_trial(job, watch)
    return Played(
        done.success,
        score,
        done.time_s,
        done.status is Status.FAILED,
        done.respawned,
        watched[0].largest,
    )


def interval(values: Sequence[float]) -> tuple[float, float]:
    """95 % t interval of the mean of some values; the value itself where there is only one."""
    middle = mean(values)
    if len(values) < 2:
        return middle, middle
    half = float(t.ppf(0.975, len(values) - 1)) * stdev(values) / sqrt(len(values))
    return middle - half, middle + half


@dataclass(frozen=True)
class Difference:
    """A method against what ships, on the same seeds.

    Attributes:
        pairs: Number of seeds.
        won, lost: Seeds on which only the method succeeded, and only what ships.
        points: Mean difference of points, method less what ships.
        low, high: 95 % t interval of it.
        by_success, by_points: p values before Holm.
    """

    pairs: int
    won: int
    lost: int
    points: float
    low: float
    high: float
    by_success: float
    by_points: float


def difference(method: Sequence[Played], ships: Sequence[Played]) -> Difference:
    """Compares a method with what ships.

    Args:
        method: Trials of the method.
        ships: Those of what ships, of the same seeds in the same order.
    """
    won = sum(a.success and not b.success for a, b in zip(method, ships, strict=True))
    lost = sum(b.success and not a.success for a, b in zip(method, ships, strict=True))
    apart = [a.points - b.points for a, b in zip(method, ships, strict=True)]
    low, high = interval(apart)
    unequal = won + lost
    return Difference(
        len(apart),
        won,
        lost,
        mean(apart),
        low,
        high,
        float(binomtest(won, unequal).pvalue) if unequal else 1.0,
        float(wilcoxon(apart).pvalue) if np.any(apart) else 1.0,
    )


def rows(done: dict[Job, Played]) -> Iterator[str]:
    """A table of all trials, one line a task, solidity, number of fingers and method."""
    heads = ("task", "solid", "fingers", "method", "success [95 %]", "points [95 %]", "s")
    yield "| " + " | ".join((*heads, "toppled", "put back", "push, N")) + " |"
    yield "| --- " * 10 + "|"
    for (task, solid, fingers), methods in _cells(done).items():
        for method, trials in methods.items():
            plays = list(trials.values())
            won = [each.seconds for each in plays if each.success]
            low, high = wilson(len(won), len(plays))
            scores = [each.points for each in plays]
            least, most = interval(scores)
            pushes = [each.push for each in plays]
            cells = [
                *(task, solid, str(fingers), method),
                f"{len(won)}/{len(plays)} [{low:.0f}, {high:.0f}]",
                f"{mean(scores):.1f} [{least:.1f}, {most:.1f}]",
                f"{median(won):.1f}" if won else "",
                str(sum(each.toppled for each in plays)),
                str(sum(each.back for each in plays)),
                f"{median(pushes):.1f}, {max(pushes):.1f}",
            ]
            yield "| " + " | ".join(cells) + " |"


def differences(done: dict[Job, Played]) -> Iterator[str]:
    """A table of every method against what ships, with p values after Holm over all of them."""
    compared: dict[tuple[str, str, int, str], Difference] = {}
    for (task, solid, fingers), methods in _cells(done).items():
        ships = methods.get(SHIPS, {})
        for method, trials in methods.items():
            seeds = [seed for seed in trials if seed in ships]
            if method != SHIPS and seeds:
                pairs = [trials[s] for s in seeds], [ships[s] for s in seeds]
                compared[task, solid, fingers, method] = difference(*pairs)
    raw = {}
    for (task, solid, fingers, method), one in compared.items():
        for what, p in (("success", one.by_success), ("points", one.by_points)):
            raw[f"{task}/{solid}/{fingers}/{method}/{what}"] = p
    corrected = holm(raw)
    heads = ("task", "solid", "fingers", "method", "pairs", "only it, only what ships")
    yield "| " + " | ".join((*heads, "points more [95 %]", "p of success", "p of points")) + " |"
    yield "| --- " * 9 + "|"
    for (task, solid, fingers, method), one in compared.items():
        name = f"{task}/{solid}/{fingers}/{method}"
        cells = [
            *(task, solid, str(fingers), method, str(one.pairs), f"{one.won}, {one.lost}"),
            f"{one.points:+.1f} [{one.low:+.1f}, {one.high:+.1f}]",
            *(f"{corrected[f'{name}/{what}']:.3g}" for what in ("success", "points")),
        ]
        yield "| " + " | ".join(cells) + " |"


def _cells(
    done: dict[Job, Played],
) -> dict[tuple[str, str, int], dict[str, dict[int, Played]]]:
    """Trials by task, solidity and number of fingers, by method, and by seed; in the order of the
    registry and of `METHODS`."""
    order = {name: i for i, name in enumerate((*TASKS, *METHODS))}
    cells: dict[tuple[str, str, int], dict[str, dict[int, Played]]] = {}
    for job in sorted(done, key=lambda j: (order[j.task], j.solid, j.fingers, order[j.method], j)):
        methods = cells.setdefault((job.task, job.solid, job.fingers), {})
        methods.setdefault(job.method, {})[job.seed] = done[job]
    return cells


def main() -> None:
    """Plays what is missing, then prints both tables."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--tasks", nargs="+", default=list(TASKS), choices=list(TASKS))
    parser.add_argument("--methods", nargs="+", default=list(METHODS), choices=list(METHODS))
    parser.add_argument("--solid", nargs="+", default=list(SOLID), choices=SOLID)
    parser.add_argument("--fingers", nargs="+", type=int, default=[3])
    parser.add_argument("--seeds", default="7000:7150", help="first and last but one training seed")
    parser.add_argument("--workers", type=int, default=os.cpu_count() or 1)
    parser.add_argument("--out", type=Path, default=Path("out/methods.jsonl"))
    parser.add_argument(
        "--kept", type=Path, nargs="+", default=[], help="files with trials that were played before"
    )
    parser.add_argument("--table", type=Path, nargs="+", help="only prints what these files have")
    options = parser.parse_args()
    for path in [*(options.table or ()), *options.kept]:
        if not path.is_file():
            parser.error(f"no such file: {path}")
    kept = KeptTrials(Job, Played, options.table or [options.out, *options.kept])
    if not options.table:
        first, end = map(int, options.seeds.split(":"))
        # Seed by seed, so that what is cut short has all tasks and methods to the same extent.
        chosen = (options.tasks, options.methods, options.solid, options.fingers)
        jobs = [Job(*each, seed) for seed in range(first, end) for each in product(*chosen)]
        kept.play(play, jobs, options.workers)
    print(describe_machine())
    print("\n".join(rows(kept.done)))
    print()
    print("\n".join(differences(kept.done)))


if __name__ == "__main__":
    run(main)
