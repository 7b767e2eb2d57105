"""Measures the time of a physics step: hand alone, with a held box, and with boxes around it.

The reference is the hand alone in the same run: times are also given as ratios to it. Scenes take
turns, so that a changing load of the machine affects all of them, and every time is a median.
Processor time is the time of the steps themselves. Wall time also includes waiting for other
programs on the same cores.

The last scene is that of the simulation notes (a pinched box with boxes around it, nv 66). Their
34 us a step on one core were measured on another machine with another table and other boxes. The
scene runs on one and on two threads (`mujoco.rollout`), beside the figures of the notes.

    python -m benchmarks.physics
"""

from __future__ import annotations

import argparse
import time
from copy import copy
from statistics import median

import mujoco
import numpy as np
from mujoco import rollout

from benchmarks.machine import describe_machine
from benchmarks.pinch import pinch_poses
from models.hand import SERVOS, Hand
from models.objects import Box
from models.scene import CONTROL_PERIOD, Scene, SceneSpec

CUBE = Box("cube", (0.025, 0.025, 0.025), 0.15, (0.0, 0.0, 0.025), 0.3)
OTHERS = (
    Box("low", (0.04, 0.02, 0.01), 0.05, (0.15, 0.05, 0.01), -0.4),
    Box("heavy", (0.03, 0.03, 0.03), 0.5, (-0.15, -0.04, 0.03), 1.0),
)
LIFT = 0.05
"""Height (m) by which the hand lifts the box."""
STEPS = 500
"""Number of physics steps in one round of one scene."""
COPIES = 4
"""Number of copies of the scene that runs on one and two threads."""
NOTES = {1: 29_700, 2: 56_000}
"""Number of threads -> steps a second, from the simulation notes (section 4, a quiet machine)."""


class Bench:
    """One scene in a steady state.

    Args:
        name: Name in the table.
        boxes: Boxes in the scene.
        held: The hand has lifted the first box between thumb and index finger. Otherwise the hand
            is a ghost high above the table.
        servo: Kind of the hand's servos.
        timestep: Timestep (s).
    """

    def __init__(
        self, name: str, boxes: tuple[Box, ...], held: bool, servo: str, timestep: float
    ) -> None:
        self.name = name
        self.scene = Scene(SceneSpec((Hand(servo=servo),), boxes, timestep=timestep))
        self.model, self.data = self.scene.model, mujoco.MjData(self.scene.model)
        self.times: list[float] = []
        self.own: list[float] = []
        up = LIFT * np.eye(48)[2]
        if held:
            opened, closed = pinch_poses(boxes[0])
            self._go(opened, opened)
            self.scene.set_solid(0, frozenset({0, 1}))
            self._go(opened, closed)
            self._go(closed, closed + up)
        else:
            self.scene.set_solid(0, frozenset())
            self._go(6 * up, 6 * up)
        mujoco.mj_step(self.model, self.data, round(1.0 / timestep))

    def _go(self, start: np.ndarray, end: np.ndarray) -> None:
        if not self.data.time:
            self.data.qpos[self.scene.qpos_slice(0)] = self.scene.pose_to_qpos(0, start)
        for share in np.linspace(0.0, 1.0, 30):
            self.data.ctrl[:] = start + share * (end - start)
            mujoco.mj_step(self.model, self.data, round(CONTROL_PERIOD / self.model.opt.timestep))

    def round(self) -> None:
        """Times one round of steps."""
        begin, own = time.perf_counter(), time.process_time()
        mujoco.mj_step(self.model, self.data, STEPS)
        self.times.append((time.perf_counter() - begin) / STEPS)
        self.own.append((time.process_time() - own) / STEPS)


class Threads:
    """Copies of one scene that are stepped in parallel.

    Args:
        bench: The scene, in the state from which all copies start.
        threads: Number of threads.
    """

    def __init__(self, bench: Bench, threads: int) -> None:
        self.threads, self._model = threads, bench.model
        self._data = [copy(bench.data) for _ in range(threads)]
        kind = mujoco.mjtState.mjSTATE_FULLPHYSICS
        state = np.empty(mujoco.mj_stateSize(bench.model, kind))
        mujoco.mj_getState(bench.model, bench.data, state, kind)
        self._start = np.tile(state, (COPIES, 1))
        self._warm = np.tile(bench.data.qacc_warmstart, (COPIES, 1))
        self._control = np.tile(bench.data.ctrl, (COPIES, STEPS, 1))
        self._pool = rollout.Rollout(nthread=threads)
        self.times: list[float] = []
        self.own: list[float] = []

    def round(self) -> None:
        """Times one round of steps of all copies."""
        begin, own = time.perf_counter(), time.process_time()
        self._pool.rollout(
            self._model, self._data, self._start, self._control, initial_warmstart=self._warm
        )
        self.times.append((time.perf_counter() - begin) / (COPIES * STEPS))
        self.own.append((time.process_time() - own) / (COPIES * STEPS))

    def close(self) -> None:
        """Ends the threads."""
        self._pool.close()


def main() -> None:
    """Prints a table."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--servo", choices=SERVOS, default=SERVOS[0])
    parser.add_argument("--timestep", type=float, default=0.002, help="s")
    parser.add_argument("--rounds", type=int, default=30)
    args = parser.parse_args()
    common = (args.servo, args.timestep)
    benches = [
        Bench("hand alone", (), False, *common),
        Bench("1 box on the table", (CUBE,), False, *common),
        Bench("1 box held", (CUBE,), True, *common),
        Bench("3 boxes on the table", (CUBE, *OTHERS), False, *common),
        Bench("3 boxes, 1 of them held", (CUBE, *OTHERS), True, *common),
    ]
    threads = [Threads(benches[-1], n) for n in NOTES]
    for _ in range(args.rounds):
        for each in [*(b.round for b in benches), *(t.round for t in threads)]:
            each()
    for thread in threads:
        thread.close()
    print(describe_machine(), end="\n\n")
    print(
        f"{args.servo} servos, {1000 * args.timestep:g} ms; "
        f"medians of {args.rounds} rounds of {STEPS} steps; in brackets: against hand alone\n"
    )
    print("| scene | nv | contacts | step, processor | step, wall | times real time (processor) |")
    print("|" + " --- |" * 6)
    alone = median(benches[0].own)
    for bench in benches:
        own, wall = median(bench.own), median(bench.times)
        print(
            f"| {bench.name} | {bench.model.nv} | {bench.data.ncon} "
            f"| {1e6 * own:.1f} us ({own / alone:.2f}) | {1e6 * wall:.1f} us "
            f"| {args.timestep / own:.0f} |"
        )
    print(f"\n{benches[-1].name}, steps of {COPIES} copies by `mujoco.rollout`; in brackets: times")
    print("one thread of the same column\n")
    print("| threads | steps/s, wall | steps/s of a thread's processor time | the notes' steps/s |")
    print("|" + " --- |" * 4)
    first = threads[0]
    for thread in threads:
        cells = [
            (1 / median(thread.times), 1 / median(first.times)),
            (1 / median(thread.own), 1 / median(first.own)),
            (float(NOTES[thread.threads]), float(NOTES[1])),
        ]
        text = " | ".join(f"{each:.0f} ({each / one:.2f})" for each, one in cells)
        print(f"| {thread.threads} | {text} |")


if __name__ == "__main__":
    main()
