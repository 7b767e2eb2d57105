"""What one physics step costs, with a hand alone and with boxes that it holds and that lie around.

The peer is the bare hand in the same run: what a task adds is the ratio to it. Scenes take turns,
so that a machine that gets busier does so for all of them, and every time is a median.

    python -m benchmarks.physics
"""

from __future__ import annotations

import argparse
import time
from statistics import median

import mujoco
import numpy as np

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
"""m."""
STEPS = 500
"""Physics steps in one round of one scene."""


class Bench:
    """One scene in a steady state.

    Args:
        name: In the table.
        boxes: Of the scene.
        held: The hand has lifted the first box between thumb and index; otherwise it is a ghost
            high above the table.
        servo: Of the hand.
        timestep: s.
    """

    def __init__(
        self, name: str, boxes: tuple[Box, ...], held: bool, servo: str, timestep: float
    ) -> None:
        self.name = name
        self.scene = Scene(SceneSpec((Hand(servo=servo),), boxes, timestep=timestep))
        self.model, self.data = self.scene.model, mujoco.MjData(self.scene.model)
        self.times: list[float] = []
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
        begin = time.perf_counter()
        mujoco.mj_step(self.model, self.data, STEPS)
        self.times.append((time.perf_counter() - begin) / STEPS)


def main() -> None:
    """Prints a table."""
    parser = argparse.ArgumentParser(description=__doc__)
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
    for _ in range(args.rounds):
        for bench in benches:
            bench.round()
    print(describe_machine())
    print(
        f"{args.servo} servos, {1000 * args.timestep:g} ms; "
        f"medians of {args.rounds} rounds of {STEPS} steps, one core"
    )
    print("| scene | contacts | steps/s | times real time | time of a step against hand alone |")
    print("|" + " --- |" * 5)
    alone = median(benches[0].times)
    for bench in benches:
        step = median(bench.times)
        print(
            f"| {bench.name} | {bench.data.ncon} | {1 / step:.0f} | {args.timestep / step:.0f} "
            f"| {step / alone:.2f} |"
        )


if __name__ == "__main__":
    main()
