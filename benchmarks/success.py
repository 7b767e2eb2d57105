"""Measures the success rate of the simulated user, with each encoder and without each part.

Every row has the same test seeds and one change. Finished trials are saved in a file of JSON lines
and not played again. An interrupted row counts up to its first missing seed. Trials with PCA-IK run
last, concurrently in one process.

    python -m benchmarks.success --tasks all --seeds 600 --rows shipped
    python -m benchmarks.success --tasks all --seeds 100 --rows encoders
    python -m benchmarks.success --tasks box-to-goal --fingers 2 3 5 --seeds 100 --rows parts
    python -m benchmarks.success --tasks all --seeds 600 --rows "whole hand"
    python -m benchmarks.success --tasks all --rows encoders --table
    python -m benchmarks.success --pinned benchmarks/pinned.json --seeds 200 --out out/after.jsonl \
        --against out/before.jsonl

Seeds come from the frozen configuration, or with `--pinned` from a file, so that they stay the same
after a change of the configuration. `--against` compares with the trials of an earlier run by exact
McNemar tests for losses on the seeds that both have, with Holm over all lines.
"""

from __future__ import annotations

import argparse
import json
import os
from collections import Counter
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from itertools import chain, takewhile
from pathlib import Path
from statistics import median
from typing import Any

from rich.console import Console
from rich.progress import Progress

from benchmarks.judged import JUDGED, judged_seeds
from benchmarks.kept_trials import lines_of, not_these, whole_lines
from benchmarks.lanes import in_lanes
from benchmarks.one_line import run
from models.errors import InputError
from sandbox.regress.statistics import holm, mcnemar, wilson
from tasks.registry import TASKS

ENCODERS: dict[str, dict[str, Any]] = {
    "shipped": {},
    "cubic": {"encoder": "cubic"},
    "quadratic": {"encoder": "quadratic"},
    "linear": {"encoder": "linear"},
    "pca-ik": {"encoder": "pca-ik"},
    "bare": {"bare": True},
    "paper": {"encoder": "paper"},
}
"""Row -> options of `sandbox run` that differ from its defaults. `paper` includes `bare`. Both
still have our rules of arrival."""

CONTROLS: dict[str, dict[str, Any]] = {
    "user does nothing": {"user": "idle"},
    "user touches at random": {"user": "random"},
}

PARTS: dict[str, dict[str, Any]] = {
    "shipped": {},
    "true labels": {"labels": "device"},
    "without fingertip correction": {"correction": False},
    "without arrival rules": {"arrival": False},
    "without ghost until clear": {"ghost_until_clear": False},
    "all links solid": {"distal_only": False},
    "without stitching": {"stitch": False},
    "a screen that loses touches": {"drop_outs": 0.3},
    "the same, without stitching": {"drop_outs": 0.3, "stitch": False},
    "paper's labels": {"labels": "paper"},
    "without encoder (mean pose)": {"encode": False},
    "without smoothing": {"smoothing": False},
    "without arrival and ghost rules": {"arrival": False, "ghost_until_clear": False},
    "paper (bare), with our arrival rules": {"encoder": "paper"},
    "paper (bare), no rule of ours": {
        "encoder": "paper",
        "arrival": False,
        "ghost_until_clear": False,
        "distal_only": False,
        "stitch": False,
    },
}

SOLID: dict[str, dict[str, Any]] = {
    "whole hand": {"solid": "hand"},
    "whole hand, true labels": {"solid": "hand", "labels": "device"},
    "whole hand, user does nothing": {"solid": "hand", "user": "idle"},
    "whole hand, user touches at random": {"solid": "hand", "user": "random"},
}
"""Rows with palm and all links solid: the default; the user's fingers known, as an upper bound; and
control arms. These rows have their own test seeds."""

GROUPS = {"encoders": ENCODERS, "controls": CONTROLS, "parts": PARTS, "solid": SOLID}
ROWS = PARTS | ENCODERS | CONTROLS | SOLID

Job = tuple[str, str, int, int]
"""Task, row, number of fingers, seed."""


def trial(job: Job) -> dict[str, Any]:
    """Plays one trial, and returns its line of the file."""
    from sandbox.trial.driver import play_trial
    from sandbox.trial.trial_options import TrialOptions, trial_settings

    task, row, fingers, seed = job
    chosen = trial_settings(TrialOptions(task=task, seed=seed, fingers=fingers, **ROWS[row]))
    result = play_trial(chosen).as_json()
    kept = ("success", "instant", "final", "status", "progress", "time_s", "reason", "state_hash")
    return {
        "task": task,
        "row": row,
        "fingers": fingers,
        "seed": seed,
        **{k: result[k] for k in kept},
    }


def load(*paths: Path) -> dict[Job, dict[str, Any]]:
    """Reads the finished trials of files, by job. An incomplete last line is left out.

    Raises:
        InputError: A file cannot be read, or has other contents.
    """
    done = {}
    for path in paths:
        for r in lines_of(path):
            try:
                done[r["task"], r["row"], r["fingers"], r["seed"]] = r
            except (KeyError, TypeError) as error:
                raise not_these(path, error) from None
    return done


def cell(found: list[dict[str, Any]]) -> str:
    """Returns successes, their Wilson interval, and the median time of successful trials."""
    if not found:
        return ""
    won = [r["time_s"] for r in found if r["success"]]
    low, high = (100 * end for end in wilson(len(won), len(found)))
    rate = f"{len(won)}/{len(found)} = {100 * len(won) / len(found):.1f} % [{low:.1f}, {high:.1f}]"
    return f"{rate} {median(won):.1f} s" if won else rate


def table(
    done: dict[Job, dict[str, Any]], fingers: list[int], seeds: dict[tuple[str, str], list[int]]
) -> Iterator[str]:
    """Yields a Markdown table with a column for each task and number of fingers.

    Args:
        done: Trials by job.
        fingers: Numbers of fingers.
        seeds: (Task, row) -> seeds.
    """
    tasks, rows = (list(dict.fromkeys(keys)) for keys in zip(*seeds, strict=True))
    columns = [(task, f) for task in tasks for f in fingers]
    names = [task if len(fingers) == 1 else f"{task}, {f} fingers" for task, f in columns]
    yield "| | " + " | ".join(names) + " |"
    yield "| --- |" + " --- |" * len(columns)
    for row in rows:
        found = [counted(done, task, row, f, seeds[task, row]) for task, f in columns]
        if any(found):
            yield f"| {row} | " + " | ".join(map(cell, found)) + " |"


def counted(
    done: dict[Job, dict[str, Any]], task: str, row: str, fingers: int, seeds: list[int]
) -> list[dict[str, Any]]:
    """Returns the trials up to the first missing seed. Later trials do not count, since of parallel
    trials the quick ones end first."""
    jobs = [(task, row, fingers, seed) for seed in seeds]
    return [done[job] for job in takewhile(done.__contains__, jobs)]


def failures(
    done: dict[Job, dict[str, Any]], fingers: list[int], seeds: dict[tuple[str, str], list[int]]
) -> Iterator[str]:
    """Yields a Markdown table of the reasons for which trials failed, with the number of trials of
    each."""
    yield "| task | row | fingers | failed | why |"
    yield "| --- | --- | --- | --- | --- |"
    for (task, row), chosen in seeds.items():
        for f in fingers:
            found = counted(done, task, row, f, chosen)
            reasons = Counter(trial["reason"] for trial in found if not trial["success"])
            for reason, n in reasons.most_common():
                yield f"| {task} | {row} | {f} | {n} | {reason} |"


def against(done: dict[Job, dict[str, Any]], before: dict[Job, dict[str, Any]]) -> Iterator[str]:
    """Yields a Markdown table that compares successes with an earlier run on the same seeds.

    P values are of exact McNemar tests for losses, after Holm over all lines.

    Args:
        done: Trials by job.
        before: Trials of the earlier run by job.
    """
    pairs: dict[tuple[str, str, int], list[tuple[bool, bool]]] = {}
    hashes: Counter[tuple[str, str, int]] = Counter()
    for job in done:
        if job in before:
            pairs.setdefault(job[:3], []).append((done[job]["success"], before[job]["success"]))
            hashes[job[:3]] += done[job]["state_hash"] == before[job]["state_hash"]
    lost = {key: sum(b and not a for a, b in found) for key, found in pairs.items()}
    won = {key: sum(a and not b for a, b in found) for key, found in pairs.items()}
    after = holm({str(key): mcnemar(lost[key], won[key]) for key in pairs})
    yield "| task | row | fingers | pairs | before | now | lost, won | p | equal hashes |"
    yield "| --- " * 9 + "|"
    for (task, row, fingers), found in sorted(pairs.items()):
        key = (task, row, fingers)
        sums = sum(b for _, b in found), sum(a for a, _ in found)
        cells = [task, row, str(fingers), str(len(found)), *map(str, sums)]
        cells += [f"{lost[key]}, {won[key]}", f"{after[str(key)]:.3g}", str(hashes[key])]
        yield "| " + " | ".join(cells) + " |"


def seeds_of(row: str, task: str, n: int, left_out: int) -> list[int]:
    """Returns n test seeds of a task after the first `left_out`, for the solidity of a row."""
    return judged_seeds(left_out + n, task, "hand" if row in SOLID else "fingertips")[left_out:]


def pinned_seeds(path: Path) -> dict[tuple[str, str], list[int]]:
    """Reads seeds of a file, by task and row.

    Args:
        path: JSON file: row of the table -> task -> seeds.

    Raises:
        InputError: The file cannot be read, or has other contents.
    """
    try:
        rows = json.loads(path.read_text(encoding="utf-8"))
        return {
            (task, row): [int(seed) for seed in seeds]
            for row, tasks in rows.items()
            for task, seeds in tasks.items()
        }
    except (OSError, ValueError, TypeError, AttributeError) as error:
        raise InputError(
            "the file of pinned seeds cannot be read",
            where=str(path),
            got=str(error),
            expected='{"row": {"task": [seed, ...]}}',
        ) from None


def chosen_rows(text: str) -> list[str]:
    """Returns the rows of a text: `all`, or names of rows and groups with `;` between them."""
    names = ROWS if text == "all" else [r for t in text.split(";") for r in GROUPS.get(t, [t])]
    return list(names)


def main() -> None:
    """Plays the missing trials, then prints successes and the reasons of failures."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--tasks", nargs="+", default=["all"], help="all, or names of tasks")
    parser.add_argument("--seeds", type=int, default=600, help="number of test seeds")
    parser.add_argument(
        "--leave-out", type=int, default=0, metavar="M", help="start after the first M test seeds"
    )
    parser.add_argument(
        "--rows",
        default="shipped",
        help="all, encoders, controls, parts, solid, or names of rows, with ; between them",
    )
    parser.add_argument("--pinned", type=Path, help="file of pinned seeds with tasks and rows")
    parser.add_argument("--fingers", type=int, nargs="+", default=[3])
    parser.add_argument("--workers", type=int, default=os.cpu_count() or 1)
    parser.add_argument("--out", type=Path, default=Path("out/success.jsonl"))
    parser.add_argument(
        "--kept", type=Path, nargs="+", default=[], help="files with trials that were played before"
    )
    parser.add_argument(
        "--against", type=Path, metavar="FILE", help="compare with the trials of an earlier run"
    )
    parser.add_argument("--table", action="store_true", help="only print finished trials")
    args = parser.parse_args()
    for path in (*args.kept, *filter(None, [args.against])):
        if not path.is_file():
            parser.error(f"no such file: {path}")
    if args.pinned:
        pinned = pinned_seeds(args.pinned)
        tasks, rows = (list(dict.fromkeys(keys)) for keys in zip(*pinned, strict=True))
        seeds = {key: found[args.leave_out :][: args.seeds] for key, found in pinned.items()}
    else:
        tasks = list(JUDGED) if args.tasks == ["all"] else args.tasks
        rows = chosen_rows(args.rows)
    for given, known in ((tasks, TASKS if args.pinned else JUDGED), (rows, ROWS)):
        if unknown := [name for name in given if name not in known]:
            parser.error(f"there is no {', '.join(unknown)}; there are {', '.join(known)}")
    if not args.pinned:
        seeds = {
            (task, row): seeds_of(row, task, args.seeds, args.leave_out)
            for task in tasks
            for row in rows
        }
    args.out.parent.mkdir(parents=True, exist_ok=True)
    done = load(args.out, *args.kept)
    # Seed by seed, so that an interrupted run has equally many seeds of all tasks and rows.
    jobs = [
        (t, r, f, seeds[t, r][i])
        for i in range(args.seeds)
        for t, r in seeds
        for f in args.fingers
        if i < len(seeds[t, r])
    ]
    missing = [] if args.table else [j for j in jobs if j not in done]
    # One thread in each process, since the processes use all cores already.
    os.environ["OMP_NUM_THREADS"] = "1"
    if missing:
        with (
            args.out.open("ab", buffering=0) as file,
            Progress(console=Console(stderr=True)) as progress,
            ProcessPoolExecutor(args.workers) as pool,
        ):
            file.truncate(whole_lines(args.out))
            results = chain(
                pool.map(trial, [j for j in missing if j[1] != "pca-ik"]),
                in_lanes(trial, [j for j in missing if j[1] == "pca-ik"]),
            )
            for result in progress.track(results, total=len(missing)):
                file.write(json.dumps(result).encode() + b"\n")
    done = load(args.out, *args.kept)
    print("\n".join(table(done, args.fingers, seeds)))
    print()
    print("\n".join(failures(done, args.fingers, seeds)))
    if args.against:
        print()
        print("\n".join(against(done, load(args.against))))


if __name__ == "__main__":
    run(main)
