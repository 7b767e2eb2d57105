"""Checks that judged trials still end in the states in which they once ended.

    python -m benchmarks.same_states                 # ten judged seeds of every task
    python -m benchmarks.same_states --seeds 600     # all that judged_states.json holds
    python -m benchmarks.same_states --air 6         # also hands in the air, six seeds of each
    python -m benchmarks.same_states --write out/success.jsonl --air 3    # writes today's states

`judged_states.json` was made at the commit that it names, with the fingerprint that it names. With
another fingerprint (MuJoCo, libm or architecture) states may differ, and the command says so.
"""

from __future__ import annotations

import argparse
import json
import os
import sys
from concurrent.futures import ProcessPoolExecutor
from itertools import chain, takewhile
from pathlib import Path
from subprocess import run

from rich.console import Console
from rich.progress import track

from benchmarks.in_air import Depth
from benchmarks.in_air import play as play_in_air
from benchmarks.judged import JUDGED, judged_seeds
from benchmarks.judged_air import air_seeds
from benchmarks.success import load, trial
from sandbox.devices.simulated.leap_disturbance import LeapDisturbance
from sandbox.recording.versions import versions

STATES = Path(__file__).with_name("judged_states.json")
"""Commit, fingerprint, and 12 digits of each trial's state hash, by task (and dialect)."""

MOST = 600
"""Judged seeds of a task, at most."""

DIGITS = 12
"""Digits of a state hash that are kept."""

IN_AIR = ("box-to-goal", "stack", "wrench-slide", "wrench-turn", "carry-together")
"""Tasks whose trials in the air are kept."""

Job = tuple[str, int, str]
"""Task, or task and dialect of a Leap; seed; digits of the hash that is expected."""


def touch_job(job: Job) -> bool:
    """True where a trial of the simulated user on a tablet ends in the expected state."""
    task, seed, expected = job
    return bool(trial((task, "shipped", 3, seed))["state_hash"].startswith(expected))


def air_state(job: tuple[str, int]) -> str:
    """State hash of a trial of the simulated user in the air: (task and dialect, seed)."""
    task, dialect = job[0].split()
    result, _ = play_in_air(task, job[1], dialect, "skilled", 1.0, Depth(), LeapDisturbance())
    return result.state_hash


def air_job(job: Job) -> bool:
    """True where a trial of the simulated user in the air ends in the expected state."""
    return air_state(job[:2]).startswith(job[2])


def write(judged: Path, air: int, workers: int) -> None:
    """Writes the states of today's code.

    Args:
        judged: Trials of the judged seeds by `benchmarks.success`, made with this code.
        air: How many seeds in the air to run for each task and dialect.
        workers: Processes.
    """
    done = load(judged)
    touch = {}
    for task in JUDGED:
        jobs = [(task, "shipped", 3, seed) for seed in judged_seeds(MOST, task)]
        touch[task] = [done[j]["state_hash"][:DIGITS] for j in takewhile(done.__contains__, jobs)]
    keys = [f"{task} {dialect}" for task in IN_AIR for dialect in ("v3", "v1")]
    jobs_in_air = [(key, seed) for key in keys for seed in air_seeds(air, key.split()[0])]
    with ProcessPoolExecutor(workers) as pool:
        ended = list(track(pool.map(air_state, jobs_in_air), total=len(jobs_in_air)))
    in_air: dict[str, list[str]] = {key: [] for key in keys}
    for (key, _), state in zip(jobs_in_air, ended, strict=True):
        in_air[key].append(state[:DIGITS])
    commit = run(
        ["git", "rev-parse", "--short=7", "HEAD"], capture_output=True, text=True, check=True
    )
    known = {"commit": commit.stdout.strip(), "fingerprint": versions()["fingerprint"]}
    STATES.write_text(json.dumps(known | {"touch": touch, "air": in_air}, indent=1) + "\n")


def main() -> int:
    """Runs the trials; exit status 1 where one ends in another state."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--seeds", type=int, default=10, help="the first N judged seeds")
    parser.add_argument("--air", type=int, default=0, help="the first N judged seeds in the air")
    parser.add_argument("--workers", type=int, default=os.cpu_count() or 1)
    parser.add_argument(
        "--write", type=Path, metavar="JSONL", help="write states: trials by benchmarks.success"
    )
    options = parser.parse_args()
    os.environ["OMP_NUM_THREADS"] = "1"
    if options.write is not None:
        write(options.write, options.air, options.workers)
        return 0
    known = json.loads(STATES.read_text())
    here = versions()["fingerprint"]
    if here != known["fingerprint"]:
        print(
            f"made with fingerprint {known['fingerprint']}, this machine has {here}: "
            "states may differ",
            file=sys.stderr,
        )
    touch: list[Job] = [
        (task, seed, expected)
        for task, states in known["touch"].items()
        for seed, expected in zip(judged_seeds(options.seeds, task), states, strict=False)
    ]
    air: list[Job] = [
        (key, seed, expected)
        for key, states in known["air"].items()
        for seed, expected in zip(air_seeds(options.air, key.split()[0]), states, strict=False)
    ]
    with ProcessPoolExecutor(options.workers) as pool:
        results = chain(pool.map(touch_job, touch), pool.map(air_job, air))
        same = list(track(results, console=Console(stderr=True), total=len(touch) + len(air)))
    for (key, seed, _), equal in zip([*touch, *air], same, strict=True):
        if not equal:
            print(f"{key}, seed {seed}: another state")
    print(f"{sum(same)} of {len(same)} trials end in the states of commit {known['commit']}")
    return int(not all(same))


if __name__ == "__main__":
    sys.exit(main())
