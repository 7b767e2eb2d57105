"""Trials of all tasks that are played anew by their seeds, whose measures are frozen.

    python -m tests.support.measured_trials      # plays all of them and writes FROZEN again

The measures in `FROZEN` are those of the program before measures became functions of arrays, which
computed them from columns of text. They are written again only where the states of trials have
changed, and then say what measures are since.
"""

from __future__ import annotations

import gzip
import json
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from sandbox.recording.versions import versions
from sandbox.study.design.conditions import run_settings
from sandbox.study.measures.arrays import TrialArrays
from sandbox.study.measures.measures import Measured, measure_trial
from sandbox.study.measures.movement import throughput
from sandbox.study.run.players import HeadlessPlayer, PlayedAttempt, TrialRequest
from sandbox.study.run.simulated_study import simulated_hand
from tasks.registry import TASKS, find_task
from tasks.user import UserConfiguration

FROZEN = Path(__file__).parents[1] / "sandbox" / "study" / "measures" / "measured_trials.json.gz"
LONGEST = 20.0
"""s of simulated time that a trial takes at most."""
SEEDS = (1, 2, 3, 4, 5)
CLUMSY = replace(
    UserConfiguration(), fingers=3, reaction=(0.4, 0.7), end_noise=0.3, aim_error=0.025
)
"""Who plays the last two seeds of every task, and more often fails."""


def play(task: str, seed: int, folder: Path) -> PlayedAttempt:
    """Plays a trial and leaves its recording in a folder."""
    settings = run_settings({"task": task}, seed)
    user = CLUMSY if seed > SEEDS[2] else UserConfiguration()
    makers = tuple(
        simulated_hand(user, settings, hand, seed) for hand in range(len(settings.hands))
    )
    limit = min(LONGEST, float(find_task(task).time_limit))
    recording = folder / f"{task}-{seed}.jsonl"
    request = TrialRequest(settings, makers, recording, {}, limit, lambda: "", lambda: False)
    return HeadlessPlayer().play(request)


def measured(attempt: PlayedAttempt) -> Measured:
    """The measures of a played trial, computed from the file of its frames."""
    return measure_trial(TrialArrays.read(attempt.table.data()), attempt.result)


def throughput_of(trials: list[Measured]) -> float | None:
    """The throughput of the successful ones of some trials."""
    moves = [(*t.moved, t.values["time_s"]) for t in trials if t.moved and t.values["success"]]
    amplitudes, errors, times = zip(*moves, strict=True) if moves else ((), (), ())
    return throughput(amplitudes, errors, times)


def frozen() -> dict[str, Any]:
    """The frozen measures: `fingerprint` of the machine, `trials`, and `throughput` by task."""
    return dict(json.loads(gzip.decompress(FROZEN.read_bytes())))


def main() -> None:
    """Plays all trials and writes `FROZEN`."""
    trials: list[dict[str, Any]] = []
    through: dict[str, float | None] = {}
    with TemporaryDirectory() as folder:
        for task in TASKS:
            found = []
            for seed in SEEDS:
                attempt = play(task, seed, Path(folder))
                found.append(measured(attempt))
                about = {"task": task, "seed": seed, "state_hash": attempt.result.state_hash}
                trials.append({**about, "measures": found[-1].values})
            through[task] = throughput_of(found)
    made = {"fingerprint": versions()["fingerprint"], "trials": trials, "throughput": through}
    FROZEN.write_bytes(gzip.compress(json.dumps(made).encode(), mtime=0))


if __name__ == "__main__":
    main()
