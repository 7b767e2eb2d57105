"""Tasks for two hands: how often two succeed, and that nobody does who is alone.

python -m benchmarks.two_hands --seeds 40 --arms pair
python -m benchmarks.two_hands --task close-case --first 6400 --seeds 25 --solid hand
"""

from __future__ import annotations

import argparse
import time
from typing import Any, Literal, get_args

from benchmarks.success import wilson
from models.surface import Surface
from sandbox.options.scene_options import SceneOptions, plan
from sandbox.session.device import Device
from sandbox.trial.device_makers import DeviceMaker, with_first
from sandbox.trial.headless import run_trial
from sandbox.trial.result import TrialResult
from tasks.task import Task

CARRY = "carry-together"
Solid = Literal["fingertips", "hand"]

ARMS: dict[str, dict[str, Any]] = {
    "pair": {},
    "pair, both right hands": {"second_hand": "right"},
    "pair on one surface": {"one_surface": True, "surface": "15.52x5.82in"},
    "one alone": {"second_user": "idle"},
    "the other one alone": {"user": "idle", "second_user": "skilled"},
    "two at random": {"user": "random"},
    "nobody": {"user": "idle"},
}
"""Options of `sandbox run`, by what they are called in the table."""


def impatient(make_device: DeviceMaker) -> DeviceMaker:
    """Opens a device whose simulated user waits for nobody at the other end."""

    def make(task: Task, surface: Surface) -> Device:
        device: Any = make_device(task, surface)
        device.user.patient = False
        opened: Device = device
        return opened

    return make


def trial(task: str, arm: str, seed: int, solid: Solid) -> TrialResult:
    """The result of a trial."""
    chosen = plan(SceneOptions(task=task, seed=seed, solid=solid, **ARMS[arm]))
    makers = chosen.makers
    if arm == "one alone" and task == CARRY:
        makers = with_first(makers, impatient)
    return run_trial(chosen.settings, makers, about=chosen.about)


def main() -> None:
    """Prints a table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--task", default=CARRY)
    parser.add_argument("--seeds", type=int, default=40, help="number of them, of every arm")
    parser.add_argument("--first", type=int, default=0, help="the first seed")
    parser.add_argument("--solid", default="fingertips", choices=get_args(Solid))
    parser.add_argument("--arms", nargs="+", default=list(ARMS), choices=list(ARMS))
    args = parser.parse_args()
    print("| arm | success | 95 % interval | median time |")
    print("|---|---|---|---|")
    for arm in args.arms:
        began = time.monotonic()
        results = [
            trial(args.task, arm, seed, args.solid)
            for seed in range(args.first, args.first + args.seeds)
        ]
        won = sum(r.success for r in results)
        low, high = wilson(won, args.seeds)
        times = sorted(r.time_s for r in results if r.success)
        median = f"{times[len(times) // 2]:.1f} s" if times else "-"
        print(
            f"| {arm} | {won}/{args.seeds} | {low:.1f} % to {high:.1f} % | {median} |", flush=True
        )
        failed = [r.seed for r in results if not r.success]
        if won and failed:
            print(f"failed seeds: {failed}; {time.monotonic() - began:.0f} s")


if __name__ == "__main__":
    main()
