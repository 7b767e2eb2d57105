"""Measures robots' hands in the place of ours: tips, processor time, and success of trials.

    python -m benchmarks.robots --seeds 25

Everything is simulated. *Tips*: every frame of the first takes of the simulated subject, in order,
retargeted as in a session, with the fingers that touch named; a tip is out of reach if it is more
than 5 mm off. *Trials*: the simulated user with three fingers, seeds of training from --first on.
*The other hand*: the same model fitted to a person's left hand, which it is not. Prints Markdown.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator
from time import process_time
from typing import Any

import numpy as np

from benchmarks.machine import describe_machine
from encoders import builtin_capture
from models.arithmetic.arrays import Array
from models.robot.known import ROBOTS, find_robot
from models.robot.mapping_fit import fit_mapping
from models.robot.retargeting import REACHED
from models.robot.robot_hand import RobotHand
from sandbox import run_trial
from sandbox.regress.statistics import wilson

TASKS = ("box-to-goal", "wrench-slide", "stack")


def tips(robot: str, frames: int) -> dict[str, Any]:
    """m, distances of fingertips from their places in a movement, and s of a frame."""
    capture = builtin_capture()
    hand = RobotHand("right", find_robot(robot))
    retargeter = hand.retargeter()
    touching: list[Array] = []
    in_the_air: list[Array] = []
    retargeter.follow(capture.q[0])
    begun, take = process_time(), capture.trial[0]
    for q, down, trial in zip(
        capture.q[:frames], capture.down[:frames], capture.trial[:frames], strict=True
    ):
        if trial != take:
            retargeter.reset()
            take = trial
        retargeter.follow(q, np.flatnonzero(down).tolist())
        touching.append(retargeter.off[down])
        in_the_air.append(retargeter.off[~down])
    spent = process_time() - begun
    return {
        "touching": np.concatenate(touching),
        "in the air": np.concatenate(in_the_air),
        "frame": spent / min(frames, len(capture)),
    }


def tip_rows(frames: int) -> Iterator[str]:
    yield "| hand | tips | number | median, mm | 95 %, mm | out of reach, % | ms a frame |"
    yield "| --- | --- | --- | --- | --- | --- | --- |"
    for robot in ROBOTS:
        found = tips(robot, frames)
        for which in ("touching", "in the air"):
            off = found[which]
            middle, most = np.percentile(off, (50, 95)) * 1e3
            yield (
                f"| {robot} | {which} | {len(off)} | {middle:.3f} | {most:.2f} | "
                f"{100 * np.mean(off > REACHED):.2f} | {found['frame'] * 1e3:.2f} |"
            )


def other_hand_rows() -> Iterator[str]:
    yield (
        "| hand | as it is, mm | as the other hand, mm | ratio | volume, from that of a person's "
        "hand | from the other | ratio |"
    )
    yield "| --- | --- | --- | --- | --- | --- | --- |"
    for robot in ROBOTS:
        mapping = find_robot(robot)
        fit = fit_mapping(mapping.path, mapping.tips, model=mapping.model)
        ratio = fit.mirrored / fit.shape
        sides = f"{fit.side:.3f} | {fit.other_side:.3f} | {fit.other_side / fit.side:.1f}"
        yield (
            f"| {robot} | {fit.shape * 1e3:.1f} | {fit.mirrored * 1e3:.1f} | {ratio:.1f} | "
            f"{sides} |"
        )


def trial_rows(seeds: range) -> Iterator[str]:
    yield (
        "| hand | task | held | 95 % interval, % | median time, s | unreached, % | "
        "processor s a trial | failed seeds |"
    )
    yield "| --- | --- | --- | --- | --- | --- | --- | --- |"
    for robot in ROBOTS:
        for task in TASKS:
            begun = process_time()
            runs = [
                run_trial(task, seed, robot=robot, fingers=3, trajectories=False) for seed in seeds
            ]
            spent = (process_time() - begun) / len(runs)
            won = [run for run in runs if run.success]
            low, high = (100 * end for end in wilson(len(won), len(runs)))
            time = np.median([run.score.time for run in won]) if won else np.nan
            unreached = 100 * np.mean([run.result["unreached"] for run in runs])
            lost = [str(s) for s, run in zip(seeds, runs, strict=True) if not run.success]
            yield (
                f"| {robot} | {task} | {len(won)}/{len(runs)} | {low:.1f} to {high:.1f} | "
                f"{time:.1f} | {unreached:.2f} | {spent:.1f} | {', '.join(lost) or 'none'} |"
            )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--seeds", type=int, default=25, help="trials a hand and task")
    parser.add_argument("--first", type=int, default=5000, help="the first seed")
    parser.add_argument("--frames", type=int, default=6000, help="frames of the subject")
    options = parser.parse_args()
    print(f"{describe_machine()}\n", flush=True)
    for rows in (
        tip_rows(options.frames),
        other_hand_rows(),
        trial_rows(range(options.first, options.first + options.seeds)),
    ):
        for row in rows:
            print(row, flush=True)
        print(flush=True)


if __name__ == "__main__":
    main()
