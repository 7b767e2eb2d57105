"""Processor time of a control step and of a whole trial, against that of another commit, in pairs.

    git worktree add --detach ../before 8b4ef822
    python -m benchmarks.step_ratio ../before --pairs 60

Trials of the simulated user are played in a process of their own, by turns from the other checkout
and from this one: same task, seed and pinned processor, both with `--encoder best`, here with
`--solid fingertips`, which was all there was. A ratio belongs to one pair, and the table gives the
geometric mean with its 95 % interval, by resampling pairs. Use `chrt -f 5` on a machine that has
other work. Users of two commits may move differently, so a trial's time is per control step.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from rich.console import Console
from rich.progress import track
from rich.table import Table

from models.arithmetic.arrays import Array

ROOT = Path(__file__).resolve().parent.parent
TASKS = ("box-to-goal", "stack", "wrench-turn")
PLAYED = """
import contextlib, io, json, os, sys, time
os.sched_setaffinity(0, {int(sys.argv[1])})
import models
from sandbox.cli.main import main
from sandbox.session.session import Session
spent, steps, advance = 0.0, 0, Session.advance
def timed(session):
    global spent, steps
    began = time.process_time()
    try:
        return advance(session)
    finally:
        spent += time.process_time() - began
        steps += 1
Session.advance = timed
with contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(io.StringIO()):
    main(["run", *sys.argv[2:]])
    spent, steps, began = 0.0, 0, time.process_time()
    main(["run", *sys.argv[2:]])
print(json.dumps([spent / steps, (time.process_time() - began) / steps]))
"""
"""Plays a trial twice, the first time to load everything; prints s a control step, and s of
everything else too."""


def played(tree: Path, cpu: int, words: Sequence[str]) -> list[float]:
    """Processor time (s) per control step of a trial: the step alone, and the whole trial."""
    told = subprocess.run(
        [sys.executable, "-c", PLAYED, str(cpu), *words],
        cwd=tree,
        env={**os.environ, "PYTHONPATH": str(tree), "OMP_NUM_THREADS": "1"},
        capture_output=True,
        text=True,
        check=True,
    )
    return [float(x) for x in json.loads(told.stdout)]


def interval(ratios: Array) -> tuple[float, float, float]:
    """Geometric mean of ratios (n,), and its 95 % interval by resampling."""
    logs = np.log(ratios)
    random = np.random.default_rng(1)
    means = logs[random.integers(0, len(logs), (10_000, len(logs)))].mean(axis=1)
    low, high = np.percentile(means, [2.5, 97.5])
    return float(np.exp(logs.mean())), float(np.exp(low)), float(np.exp(high))


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawTextHelpFormatter
    )
    parser.add_argument("before", type=Path, help="checkout of the other commit")
    parser.add_argument("--here", type=Path, default=ROOT, help="instead of this checkout")
    parser.add_argument(
        "--words", default="--solid fingertips", help="what else a trial here is run with"
    )
    parser.add_argument("--pairs", type=int, default=60)
    parser.add_argument("--cpu", type=int, default=max(os.sched_getaffinity(0)))
    options = parser.parse_args()
    before, here, rows = options.before.resolve(), options.here.resolve(), []
    for pair in track(range(options.pairs), "pairs of trials", transient=True):
        words = (TASKS[pair % len(TASKS)], "--seed", str(9000 + pair), "--encoder", "best")
        turns = [(before, words), (here, (*words, *options.words.split()))]
        found = {tree: played(tree, options.cpu, w) for tree, w in turns[:: 1 - 2 * (pair % 2)]}
        rows.append([found[here], found[before]])
    times = np.array(rows)
    table = Table("processor time", "before, us", "here, us", "ratio [95 %]")
    for name, one in zip(("a control step", "a whole trial, a step"), times.T, strict=True):
        ours, theirs = 1e6 * np.median(one, axis=1)
        mean, low, high = interval(one[0] / one[1])
        table.add_row(name, f"{theirs:.0f}", f"{ours:.0f}", f"{mean:.3f} [{low:.3f}, {high:.3f}]")
    Console().print(table)


if __name__ == "__main__":
    main()
