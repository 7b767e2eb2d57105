"""Replays recordings of another machine here, and measures how far states differ.

    python -m benchmarks.other_machines /tmp/rec --record 8    # on one machine
    python -m benchmarks.other_machines /tmp/rec               # on the other

The first command records trials of the simulated user: N seeds of each of the papers' tasks by
touch and in the air over both versions of the Leap. The second command replays every recording of
the folder and prints a table. Recordings contain poses with a limited resolution, so that even an
exact replay differs from them by up to 0.02 mm and 0.01 degrees. Differences up to this size count
as zero.

Other values of libm on the same machine: GLIBC_TUNABLES=glibc.cpu.hwcaps=-AVX2,-FMA,-FMA4
"""

from __future__ import annotations

import argparse
from collections import defaultdict
from pathlib import Path

from rich.progress import track

from benchmarks.machine import describe_machine
from benchmarks.one_line import run
from models.errors import InputError
from sandbox.recording.recording import Recording, load_recording
from sandbox.recording.versions import versions
from sandbox.trial.replay import Verification, replay
from sandbox.trial.settings import recorded_settings

DEVICES = ("simulated", "leap-simulated", "leap-simulated:v1")
COLUMNS = (
    "task, device, encoder",
    "recordings",
    "exact",
    "agree",
    "other outcome",
    "objects mm",
    "objects degrees",
    "hands mm",
    "hands degrees",
)


def record(folder: Path, seeds: int) -> None:
    """Records trials of the simulated user. Existing recordings are not changed."""
    from benchmarks.judged import FIRST
    from sandbox.trial.driver import play_trial
    from sandbox.trial.trial_options import TrialOptions, trial_settings

    folder.mkdir(parents=True, exist_ok=True)
    jobs = [(task, device, seed) for task in FIRST for device in DEVICES for seed in range(seeds)]
    for task, device, seed in track(jobs, "recording"):
        file = folder / f"{task}-{device.replace(':', '-')}-{seed}.jsonl"
        if not file.exists():
            chosen = trial_settings(TrialOptions(task=task, seed=seed, device=device))
            play_trial(chosen, record=file)


def row(name: str, found: list[Verification]) -> str:
    """Returns a row of the table: counts, and the largest differences of replays that are not
    exact."""
    agreements = [v.agreement for v in found if v.agreement is not None]
    largest = [
        max((getattr(a, field) for a in agreements), default=0.0)
        for field in ("objects_mm", "objects_degrees", "hands_mm", "hands_degrees")
    ]
    counts = (
        len(found),
        sum(v.exact for v in found),
        sum(a.holds for a in agreements),
        sum(a.same_outcome is False for a in agreements),
    )
    cells = [name, *map(str, counts), *(f"{value:.3f}" for value in largest)]
    return f"| {' | '.join(cells)} |"


def kind(recording: Recording) -> str:
    """Returns the group of a recording: task, device and encoder."""
    made = recorded_settings(recording.header)
    return ", ".join((made.task, made.device.name, made.pipeline.encoder))


def main() -> None:
    """Records or replays."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("folder", type=Path)
    parser.add_argument("--record", type=int, metavar="N", help="record N seeds of each")
    options = parser.parse_args()
    if options.record:
        record(options.folder, options.record)
        return
    found: dict[str, list[Verification]] = defaultdict(list)
    there: set[str] = set()
    files = sorted(options.folder.glob("*.jsonl"))
    if not files:
        raise InputError(
            "the folder has no recordings",
            where=str(options.folder),
            expected="files *.jsonl",
            remedy="Record some: `python -m benchmarks.other_machines FOLDER --record 3`",
        )
    for file in track(files, "replaying"):
        recording = load_recording(file)
        there.add(recording.header["versions"]["libm"])
        found[kind(recording)].append(replay(recording)[1])
    print(describe_machine())
    print(f"libm here: {versions()['libm']}; of the recordings: {'; '.join(sorted(there))}\n")
    print(f"| {' | '.join(COLUMNS)} |")
    print(f"|{' --- |' * len(COLUMNS)}")
    for name in sorted(found):
        print(row(name, found[name]))
    print(row("all", [v for group in found.values() for v in group]))


if __name__ == "__main__":
    run(main)
