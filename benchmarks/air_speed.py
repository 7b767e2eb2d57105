"""What hands in the air cost in processor time: one step of two hands, and a replay.

    python -m benchmarks.air_speed

A step is everything between a hand frame and the commanded poses: PAALM, the pose, smoothing, the
table, the rate limit. A replay is the verification of a recording of `box-to-goal`, one hand in the
air, simulated; its speed is session time by processor time. Times are medians.
"""

from __future__ import annotations

import tempfile
from functools import partial
from pathlib import Path
from time import perf_counter, process_time
from typing import Any

import numpy as np

from benchmarks.machine import describe_machine
from encoders.paalm import Paalm
from encoders.paalm.hand_reconstructor import HandReconstructor
from encoders.paalm.simulated.air import simulate_air
from encoders.paalm.simulated.forward import LeapTake, seen
from models.surface import Surface
from sandbox.devices.simulated.leap_user import SimulatedLeap
from sandbox.recording.recording import load_recording
from sandbox.trial.hand_input import UNDER, HandInput
from sandbox.trial.headless import run_trial
from sandbox.trial.replay import replay
from sandbox.trial.settings import RunSettings
from tasks.task import Task
from tasks.user import UserConfiguration

SIDES = ("right", "left")
TIMES = 5


def step_ms(takes: dict[str, LeapTake]) -> float:
    """ms for one moment of two hands, each followed by a reconstructor of its own."""
    followed = []
    for side in SIDES:
        paalm = Paalm()
        # 100 frames of the open hand are enough for its speed.
        paalm.calibrate(takes[side].frames, side, 100)  # type: ignore[arg-type]
        paalm.reset()
        followed.append(HandReconstructor(paalm, side))
    spent = []
    for pair in zip(*(takes[side].frames for side in SIDES), strict=True):
        start = perf_counter()
        for one, frame in zip(followed, pair, strict=True):
            one.step(frame)
        spent.append(perf_counter() - start)
    return 1e3 * float(np.median(spent))


def _leap(dialect: str, task: Task, surface: Surface) -> Any:
    return SimulatedLeap(task, UserConfiguration(), 0, UNDER, dialect)


def main() -> None:
    """Prints both."""
    print(f"{describe_machine()}; SIMULATED hands and device")
    for dialect in ("v1", "v3"):
        takes = {s: seen(simulate_air(i, s), i, dialect) for i, s in enumerate(SIDES)}
        found = [step_ms(takes) for _ in range(TIMES)]
        print(f"{dialect}: {np.median(found):.2f} ms for a frame with two hands")
        settings = RunSettings(in_air=HandInput())
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "air.jsonl"
            run_trial(settings, partial(_leap, dialect), record=path)
            recording = load_recording(path)
            seconds = max(e.frame.time for e in recording.inputs[0])
            speeds = []
            for _ in range(TIMES):
                start = process_time()
                _, verification = replay(recording)
                assert verification.exact
                speeds.append(seconds / (process_time() - start))
        print(f"{dialect}: replay of {seconds:.1f} s at {np.median(speeds):.1f} times real time")


if __name__ == "__main__":
    main()
