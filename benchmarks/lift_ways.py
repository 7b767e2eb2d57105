"""How well boxes are stacked with each way to lift: a slider, a wheel, keys.

    python -m benchmarks.lift_ways                          # 20 seeds of stack with each way
    python -m benchmarks.lift_ways --tasks stack-three --first 500
    python -m benchmarks.lift_ways --table                  # what has been played so far

The page has a slider beside the touch rectangle, which the wheel of a mouse and keys move as well;
in the window, keys move it for as long as they are held. One simulated user plays the same trials
with each of them; only the other hand differs. The slider is that of the frozen user, whose hand
trembles and misses. A wheel and keys move in steps of `LIFT_NOTCH` and `LIFT_KEY`, which do not
tremble; the user counts as many as are seen to be missing. How quickly steps follow each other, and
how exactly a key is let go of, is assumed. SIMULATED: no person took part.
"""

from __future__ import annotations

import argparse
import os
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import product
from pathlib import Path
from statistics import median
from typing import NamedTuple

import numpy as np
from rich.console import Console
from rich.table import Table

from benchmarks.kept_trials import KeptTrials
from models.surface import Surface
from sandbox.devices.simulated.simulated import SimulatedDevice
from sandbox.devices.wrappers.lift_keys import SPEED
from sandbox.options.scene_options import SceneOptions, plan
from sandbox.regress.statistics import wilson
from sandbox.server.protocol.protocol import LIFT_KEY, LIFT_NOTCH, LIFT_PAGE
from sandbox.session.device import Device
from sandbox.trial.device_makers import DeviceMaker, with_first
from sandbox.trial.headless import run_trial
from tasks.simulated_user.lift import Slider
from tasks.simulated_user.stacker import Stacker
from tasks.stack import Stack, StackThree
from tasks.task import Task

REACH_FOR = 0.30
"""s until the first step, as of the slider."""
NOTCH_EVERY, TAP_EVERY = 0.10, 0.15
"""s from one notch of the wheel to the next, and from one tap on a key to the next. Assumed."""
LET_GO = 0.05
"""s, standard deviation of the moment at which a held key is let go of. Assumed."""


class Steps(Slider):
    """A control that moves by whole steps: notches of a wheel, or taps on keys.

    Args:
        reach, rng: As of `Slider`.
        step: Share of the whole travel that a step moves.
        every: s from one step to the next.
        large: Steps that one large step is worth; 1 without any.
    """

    def __init__(
        self, reach: float, rng: np.random.Generator, step: float, every: float, large: int = 1
    ) -> None:
        super().__init__(reach, rng)
        self._step, self._every, self._large = step, every, large

    def move(self, height: float, now: float) -> float:
        start = self._at(now)
        steps = round((np.clip(height / self._reach, 0.0, 1.0) - start) / self._step)
        self._start, self._end = start, float(np.clip(start + steps * self._step, 0.0, 1.0))
        presses = abs(steps) // self._large + abs(steps) % self._large
        self._begin, self._duration = now + REACH_FOR, max(presses * self._every, 1e-9)
        return self._begin + self._duration

    def control(self, now: float) -> float:
        return self._at(now)

    def _at(self, now: float) -> float:
        share = min(max((now - self._begin) / self._duration, 0.0), 1.0)
        way = self._end - self._start
        whole = np.floor(share * abs(way) / self._step + 1e-9) * self._step
        return self._end if share >= 1.0 else self._start + float(np.sign(way) * whole)


class HeldKeys(Slider):
    """Keys that move the control while they are held, as in the window."""

    def move(self, height: float, now: float) -> float:
        start = self._at(now)
        end = float(np.clip(height / self._reach, 0.0, 1.0))
        held = max(abs(end - start) / SPEED + float(self._rng.normal(0.0, LET_GO)), 0.0)
        if end == 0.0:
            held = start / SPEED  # It stops by itself.
        way = float(np.sign(end - start)) * held * SPEED
        self._start, self._end = start, float(np.clip(start + way, 0.0, 1.0))
        self._begin, self._duration = now + REACH_FOR, max(held, 1e-9)
        return self._begin + self._duration

    def control(self, now: float) -> float:
        return self._at(now)

    def _at(self, now: float) -> float:
        share = min(max((now - self._begin) / self._duration, 0.0), 1.0)
        return self._start + share * (self._end - self._start)


def _keys(reach: float, rng: np.random.Generator) -> Slider:
    return Steps(reach, rng, LIFT_KEY, TAP_EVERY, round(LIFT_PAGE / LIFT_KEY))


def _wheel(reach: float, rng: np.random.Generator) -> Slider:
    return Steps(reach, rng, LIFT_NOTCH, NOTCH_EVERY)


WAYS: dict[str, Callable[[float, np.random.Generator], Slider]] = {
    "slider": Slider,
    "wheel": _wheel,
    "keys of the page": _keys,
    "held keys of the window": HeldKeys,
}
"""The other hand's control, of the reach of the lift in m."""
TASKS = (Stack.name, StackThree.name)


class Job(NamedTuple):
    """One trial: the way to lift, the task and its seed."""

    way: str
    task: str
    seed: int


@dataclass(frozen=True)
class Outcome:
    """Whether a trial succeeded, and its time in s."""

    success: bool
    time: float


def trial(job: Job) -> Outcome:
    """Plays one trial."""
    chosen = plan(SceneOptions(task=job.task, seed=job.seed))

    def lifting(maker: DeviceMaker) -> DeviceMaker:
        def make(task: Task, surface: Surface) -> Device:
            device = maker(task, surface)
            assert isinstance(device, SimulatedDevice) and isinstance(device.user, Stacker)
            rng = np.random.default_rng([job.seed, 7_005])
            device.user.slider = WAYS[job.way](type(task).lift_range, rng)
            return device

        return make

    result = run_trial(chosen.settings, with_first(chosen.makers, lifting), about=chosen.about)
    return Outcome(result.success, result.time_s)


def add_row(table: Table, name: str, found: Sequence[Outcome]) -> None:
    """Adds the row of some trials."""
    if not found:
        return
    times = [o.time for o in found if o.success]
    low, high = wilson(len(times), len(found))
    table.add_row(
        name,
        f"{len(times)} of {len(found)}",
        f"{100 * len(times) / len(found):.0f} [{100 * low:.0f}, {100 * high:.0f}]",
        f"{median(times):.1f}" if times else "-",
    )


def main() -> None:
    """Plays what is missing, and prints the table."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--tasks", nargs="+", choices=TASKS, default=["stack"])
    parser.add_argument("--ways", nargs="+", choices=list(WAYS), default=list(WAYS))
    parser.add_argument("--seeds", type=int, default=20, help="of every task")
    parser.add_argument("--first", type=int, default=0, help="the first seed")
    parser.add_argument("--workers", type=int, default=os.cpu_count() or 1)
    parser.add_argument("--files", type=Path, nargs="+", default=[Path("out/lift_ways.jsonl")])
    parser.add_argument("--table", action="store_true", help="only print what is there")
    options = parser.parse_args()
    seeds = range(options.first, options.first + options.seeds)
    kept = KeptTrials(Job, Outcome, options.files)
    if not options.table:
        jobs = [Job(*job) for job in product(options.ways, options.tasks, seeds)]
        kept.play(trial, jobs, options.workers)
    table = Table("way to lift", "done", "%", "s, median")
    for task in options.tasks:
        for way in options.ways:
            found = [o for j, o in kept.done.items() if (j.way, j.task) == (way, task)]
            add_row(table, f"{task}, {way}", found)
    Console(width=100).print(table)


if __name__ == "__main__":
    main()
