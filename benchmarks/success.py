"""How often the simulated user succeeds, and what each part of the pipeline is worth.

Every row is the same judged seeds with one thing changed. Resumable: finished trials are kept in a
file of JSON lines and not run again.

    python -m benchmarks.success --seeds 300 --rows best --out out/success.jsonl
    python -m benchmarks.success --seeds 100 --rows all --out out/success.jsonl --table
"""

from __future__ import annotations

import argparse
import json
import os
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path
from typing import Any

from rich.console import Console
from rich.progress import Progress
from scipy.stats import binomtest

from benchmarks.judged import judged_seeds

ROWS: dict[str, dict[str, Any]] = {
    "best": {},
    "best, true labels": {"tell_labels": True},
    "without fingertip correction": {"without": ("correction",)},
    "without arrival rules": {"without": ("arrival",)},
    "without ghost until clear": {"without": ("ghost",)},
    "all links solid": {"without": ("distal",)},
    "without stitching": {"without": ("stitch",)},
    "a screen that loses touches": {"drop_outs": 0.3},
    "the same, without stitching": {"drop_outs": 0.3, "without": ("stitch",)},
    "paper's labels": {"without": ("history",)},
    "without encoder (mean pose)": {"without": ("encoder",)},
    "without smoothing": {"without": ("smoothing",)},
    "without arrival and ghost rules": {"without": ("arrival", "ghost")},
    "paper (bare), with our arrival rules": {"encoder": "paper"},
    "paper (bare), no rule of ours": {
        "encoder": "paper",
        "without": ("arrival", "ghost", "distal", "stitch"),
    },
    "user does nothing": {"user": "idle"},
    "user touches at random": {"user": "random"},
}
"""Row of the table -> options of `sandbox run` that differ from its defaults."""

FINGERS = (2, 3, 5)


def trial(job: tuple[str, str, int, int]) -> dict[str, Any]:
    """Runs one trial: (task, row, fingers, seed)."""
    from sandbox.cli.scene_options import SceneOptions, plan
    from sandbox.headless import run_trial

    task, row, fingers, seed = job
    chosen = plan(SceneOptions(task=task, seed=seed, fingers=fingers, **ROWS[row]))
    result = run_trial(chosen.settings, chosen.make_device, about=chosen.about)
    kept = ("success", "instant", "final", "status", "progress", "time_s", "reason", "state_hash")
    return {"task": task, "row": row, "fingers": fingers, "seed": seed,
            **{k: result[k] for k in kept}}  # fmt: skip


def wilson(successes: int, n: int) -> tuple[float, float]:
    """95 % Wilson interval of a rate, in percent."""
    interval = binomtest(successes, n).proportion_ci(0.95, method="wilson")
    return 100 * interval.low, 100 * interval.high


def load(path: Path) -> dict[tuple[str, str, int, int], dict[str, Any]]:
    """Finished trials by job; a torn last line is left out."""
    done = {}
    if path.exists():
        for line in path.read_bytes().split(b"\n")[:-1]:
            r = json.loads(line)
            done[r["task"], r["row"], r["fingers"], r["seed"]] = r
    return done


def table(done: dict[Any, dict[str, Any]], task: str, seeds: list[int]) -> Iterator[str]:
    """The result as a Markdown table."""
    yield "| | " + " | ".join(f"{f} fingers" for f in FINGERS) + " |"
    yield "| --- |" + " --- |" * len(FINGERS)
    for row in ROWS:
        cells = []
        for fingers in FINGERS:
            jobs = [(task, row, fingers, s) for s in seeds]
            found = [done[j] for j in jobs if j in done]
            if not found:
                cells.append("")
                continue
            won = [r for r in found if r["success"]]
            low, high = wilson(len(won), len(found))
            cell = f"{len(won)}/{len(found)} [{low:.0f}, {high:.0f}]"
            if won:
                times = sorted(r["time_s"] for r in won)
                cell += f" {times[len(times) // 2]:.1f} s"
            cells.append(cell)
        if any(cells):
            yield f"| {row} | " + " | ".join(cells) + " |"


def main() -> None:
    """Runs what is missing, then prints the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--task", default="box-to-goal")
    parser.add_argument("--seeds", type=int, default=300, help="the first N judged seeds")
    parser.add_argument("--rows", default="best", help="all, or names separated by ;")
    parser.add_argument("--fingers", type=int, nargs="+", default=list(FINGERS))
    parser.add_argument("--workers", type=int, default=os.cpu_count() or 1)
    parser.add_argument("--out", type=Path, default=Path("out/success.jsonl"))
    parser.add_argument("--table", action="store_true", help="only print what is there")
    args = parser.parse_args()
    seeds = judged_seeds(args.seeds)
    rows = list(ROWS) if args.rows == "all" else args.rows.split(";")
    args.out.parent.mkdir(parents=True, exist_ok=True)
    done = load(args.out)
    jobs = [(args.task, r, f, s) for r in rows for f in args.fingers for s in seeds]
    missing = [] if args.table else [j for j in jobs if j not in done]
    # One thread a process: the machine's cores are the processes' already.
    os.environ["OMP_NUM_THREADS"] = "1"
    with (
        args.out.open("ab", buffering=0) as file,
        Progress(console=Console(stderr=True)) as progress,
        ProcessPoolExecutor(args.workers) as pool,
    ):
        for result in progress.track(pool.map(trial, missing), total=len(missing)):
            file.write(json.dumps(result).encode() + b"\n")
    print("\n".join(table(load(args.out), args.task, seeds)))


if __name__ == "__main__":
    main()
