"""Measures robot hands in the place of ours: fingertips, processor time, and success of trials.

    python -m benchmarks.robots --seeds 25
    python -m benchmarks.robots --judged 600 --only trials
    python -m benchmarks.robots --fit FILE.xml th_tip,ff_tip,mf_tip --fit OTHER.urdf th,ff,mf ends

Everything is simulated. The tables are Markdown.

- *Tips*: frames of the simulated subject, in order, are retargeted as in a session, with the
  touching fingers known. A tip counts as out of reach if its error is more than 5 mm. Fingers that
  a hand lacks are left out.
- *Sides*: the mapping is fitted to the correct side of a person's hand and to the other side.
- *Trials*: the simulated user plays with three fingers, on training seeds from `--first` on, or
  with `--judged` on the first test seeds. Finished trials are saved in a file of JSON lines and not
  played again.
- *Fit*: models of other people are fitted, and compared with their own model in a scene at 1,000
  random angles: the largest distance of a fingertip, and the largest error of coupled joints.
  Refused models have their error in the table.

The Inspire Hand needs `pip install --no-deps robosuite==1.5.2` besides the extra, and Allegro and
LEAP need mujoco_menagerie.
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from time import process_time
from typing import Any

import numpy as np

from benchmarks.judged import judged_seeds
from benchmarks.machine import describe_machine
from benchmarks.one_line import run
from encoders import builtin_capture
from models.arithmetic import Array
from models.errors import InputError
from models.robot.mapping import ROBOTS, find_robot, located
from models.robot.mapping_fit import fit_mapping
from models.robot.retargeting import REACHED
from models.robot.robot_hand import RobotHand
from sandbox import run_trial
from sandbox.regress.statistics import wilson
from tests.support.robot_tips import greatest_break, greatest_distance

ANGLES = 1000
"""Number of random angles at which a hand is compared with its own model."""
TASKS = ("box-to-goal", "wrench-slide", "stack")


def tips(robot: str, frames: int) -> dict[str, Any]:
    """Returns the errors (m) of fingertips of a robot hand in a movement, "touching" and "in the
    air", and the processor time (s) of a "frame"."""
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
        own = down[: len(retargeter.off)]
        touching.append(retargeter.off[own])
        in_the_air.append(retargeter.off[~own])
    spent = process_time() - begun
    return {
        "touching": np.concatenate(touching),
        "in the air": np.concatenate(in_the_air),
        "frame": spent / min(frames, len(capture)),
    }


def tip_rows(robots: Sequence[str], frames: int) -> Iterator[str]:
    yield "| hand | tips | number | median, mm | 95 %, mm | out of reach, % | ms a frame |"
    yield "| --- | --- | --- | --- | --- | --- | --- |"
    for robot in robots:
        found = tips(robot, frames)
        for which in ("touching", "in the air"):
            off = found[which]
            middle, most = np.percentile(off, (50, 95)) * 1e3
            yield (
                f"| {robot} | {which} | {len(off)} | {middle:.3f} | {most:.2f} | "
                f"{100 * np.mean(off > REACHED):.2f} | {found['frame'] * 1e3:.2f} |"
            )


def other_hand_rows(robots: Sequence[str]) -> Iterator[str]:
    yield (
        "| hand | as it is, mm | as the other hand, mm | ratio | volume, from that of a person's "
        "hand | from the other | ratio |"
    )
    yield "| --- | --- | --- | --- | --- | --- | --- |"
    for robot in robots:
        mapping = find_robot(robot)
        fit = fit_mapping(
            mapping.path, mapping.tips, model=mapping.model, ends=bool(mapping.places)
        )
        ratio = fit.mirrored / fit.shape
        sides = f"{fit.side:.3f} | {fit.other_side:.3f} | {fit.other_side / fit.side:.1f}"
        yield (
            f"| {robot} | {fit.shape * 1e3:.1f} | {fit.mirrored * 1e3:.1f} | {ratio:.1f} | "
            f"{sides} |"
        )


def fit_rows(models: Sequence[Sequence[str]]) -> Iterator[str]:
    """Yields the table of other people's models.

    Args:
        models: Words of each model: FILE, TIPS, and perhaps `ends`, `left` or `right`.
    """
    yield (
        "| model | side | joints | coupled | fingertips, mm | couplings, rad | "
        "off a person's, mm | not followed |"
    )
    yield "| --- | --- | --- | --- | --- | --- | --- | --- |"
    for model, tips, *words in models:
        file = located(model, Path())
        name = "/".join(file.parts[-2:])
        side = "".join({"left", "right"} & set(words))
        try:
            fit = fit_mapping(
                file, tips.split(","), model=str(file), ends="ends" in words, hand=side
            )
        except InputError as error:
            yield f"| {name} | refused: {error} |"
            continue
        hand = RobotHand("fit", fit.mapping)
        yield (
            f"| {name} | {fit.mapping.side} | {len(hand.robot.joints)} | "
            f"{len(fit.mapping.coupled)} | {greatest_distance(hand, ANGLES) * 1e3:.6f} | "
            f"{greatest_break(hand, ANGLES):.1e} | {np.median(fit.errors) * 1e3:.2f} | "
            f"{'; '.join(fit.not_followed) or 'none'} |"
        )


class Trials:
    """Finished trials in a file of JSON lines.

    Args:
        file: The file. An incomplete last line is removed.
    """

    def __init__(self, file: Path) -> None:
        self._file = file
        lines = file.read_bytes().split(b"\n") if file.exists() else [b""]
        self._done = {tuple(row["job"]): row for row in map(json.loads, lines[:-1])}
        if lines[-1]:
            file.write_bytes(b"".join(line + b"\n" for line in lines[:-1]))

    def run(self, robot: str, task: str, seed: int) -> dict[str, Any]:
        """Returns the result of a trial. The trial is played if the file does not have it."""
        job = (robot, task, seed)
        if job not in self._done:
            begun = process_time()
            trial = run_trial(task, seed, robot=robot, fingers=3, trajectories=False)
            self._done[job] = {
                "job": job,
                "success": trial.success,
                "time": trial.score.time,
                "unreached": trial.result["unreached"],
                "state_hash": trial.result["state_hash"],
                "cpu": process_time() - begun,
            }
            self._file.parent.mkdir(parents=True, exist_ok=True)
            with self._file.open("ab") as file:
                file.write(json.dumps(self._done[job]).encode() + b"\n")
        return self._done[job]


def trial_rows(
    trials: Trials, robots: Sequence[str], seeds: Mapping[str, Sequence[int]]
) -> Iterator[str]:
    """Yields the table of trials.

    Args:
        trials: Finished trials.
        robots: Names of robot hands.
        seeds: Task -> seeds.
    """
    yield (
        "| hand | task | held | 95 % interval, % | median time, s | unreached, % | "
        "processor s a trial | failed seeds |"
    )
    yield "| --- | --- | --- | --- | --- | --- | --- | --- |"
    for robot in robots:
        for task in seeds:
            runs = [trials.run(robot, task, seed) for seed in seeds[task]]
            won = [run for run in runs if run["success"]]
            low, high = (100 * end for end in wilson(len(won), len(runs)))
            time = np.median([run["time"] for run in won]) if won else np.nan
            unreached, spent = (np.mean([run[k] for run in runs]) for k in ("unreached", "cpu"))
            lost = [str(run["job"][2]) for run in runs if not run["success"]]
            yield (
                f"| {robot} | {task} | {len(won)}/{len(runs)} | {low:.1f} to {high:.1f} | "
                f"{time:.1f} | {100 * unreached:.2f} | {spent:.1f} | {', '.join(lost) or 'none'} |"
            )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--seeds", type=int, default=25, help="number of trials per hand and task")
    parser.add_argument("--first", type=int, default=5000, help="the first seed")
    parser.add_argument("--frames", type=int, default=6000, help="number of frames of the subject")
    parser.add_argument("--judged", type=int, default=0, help="use the first N test seeds instead")
    parser.add_argument("--only", choices=["tips", "sides", "trials"], help="print this table only")
    parser.add_argument("--out", type=Path, default=Path("out/robots.jsonl"))
    parser.add_argument("--tasks", nargs="+", choices=TASKS, default=list(TASKS))
    parser.add_argument("--robots", nargs="+", choices=ROBOTS, default=list(ROBOTS))
    parser.add_argument(
        "--fit",
        nargs="+",
        action="append",
        metavar="WORD",
        help="FILE TIPS, and perhaps ends, left or right; only print the table of this model",
    )
    options = parser.parse_args()
    if options.fit:
        print(describe_machine(), *fit_rows(options.fit), sep="\n", flush=True)
        return
    robots: Sequence[str] = options.robots
    training = range(options.first, options.first + options.seeds)
    seeds = {
        task: judged_seeds(options.judged, task) if options.judged else training
        for task in options.tasks
    }
    print(f"{describe_machine()}\n", flush=True)
    tables = {
        "tips": tip_rows(robots, options.frames),
        "sides": other_hand_rows(robots),
        "trials": trial_rows(Trials(options.out), robots, seeds),
    }
    for name, rows in tables.items():
        if options.only not in (None, name):
            continue
        for row in rows:
            print(row, flush=True)
        print(flush=True)


if __name__ == "__main__":
    run(main)
