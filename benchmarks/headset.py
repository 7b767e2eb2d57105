"""Tasks done by a simulated hand in a simulated headset: `python -m benchmarks.headset`.

Prints how many trials of each task succeed, and how long those took. Nobody is real: the user is
`sandbox.devices.simulated.air_user`, and the headset is that user's joints with an assumed noise
(`sandbox.devices.simulated.headset_user`). The browser's part is tested in
tests/system/browser/test_headset_chromium.py.

    python -m benchmarks.headset [--tasks box-to-goal stack] [--seeds 20]
"""

from __future__ import annotations

import argparse
from statistics import median

from benchmarks.one_line import run
from sandbox.devices.simulated.headset_user import NOISE
from sandbox.options.headset_devices import SIMULATED
from sandbox.options.scene_options import SceneOptions, plan
from sandbox.trial.headless import run_trial
from tasks.registry import find_task, hands_of


def main() -> None:
    """Runs the trials and prints the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--tasks", nargs="+", default=["box-to-goal", "stack"])
    parser.add_argument("--seeds", type=int, default=20, help="seeds from 0")
    asked = parser.parse_args()
    print(f"simulated headset, assumed noise {1000 * NOISE:g} mm; seeds 0 to {asked.seeds - 1}\n")
    print("| task | held | median time |\n| --- | --- | --- |")
    for task in asked.tasks:
        times = []
        second = SIMULATED if hands_of(find_task(task)) > 1 else None
        for seed in range(asked.seeds):
            options = SceneOptions(task=task, device=SIMULATED, second_device=second, seed=seed)
            chosen = plan(options)
            result = run_trial(chosen.settings, chosen.makers)
            if result.success:
                times.append(result.time_s)
        took = f"{median(times):.1f} s" if times else "-"
        print(f"| {task} | {len(times)} of {asked.seeds} | {took} |", flush=True)


if __name__ == "__main__":
    run(main)
