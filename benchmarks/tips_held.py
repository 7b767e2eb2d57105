"""How exactly touching fingertips stay where they are while a solid hand is led clear of things.

    python -m benchmarks.tips_held --tasks books slalom --seeds 7001:7013 --impulse safe

Trials of the simulated user on training seeds with `--solid hand`, three fingers, what ships. The
correction of the pose is sought where touching fingertips stay, and follows a moment late. *Moved*
is how far the commanded tip of a touching finger is from where it would be without the correction,
in the control steps in which a hand is led; the largest of the touching fingers counts. *Fastest*
is how fast any joint of the commanded pose turns from one of these steps to the next.
"""

from __future__ import annotations

import argparse
import os
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np

from benchmarks.machine import describe_machine
from benchmarks.one_line import run
from models.limits import GENTLE
from models.one_pose import OnePose
from models.pose import JOINTS
from models.scene import CONTROL_PERIOD
from sandbox.options.scene_options import SceneOptions, plan
from sandbox.regress.plan import parse_seeds
from sandbox.session.messages import Snapshot
from sandbox.session.session import Session
from sandbox.trial.headless import run_trial
from tasks.registry import TASKS

MOVED = 0.001
"""m, from which on a fingertip counts as moved."""

FAST = GENTLE.angular
"""rad/s, the limit of a joint's speed with `--impulse safe`, before a hand is led."""


class Job(NamedTuple):
    """One trial."""

    task: str
    impulse: str
    seed: int


@dataclass
class Held:
    """What was seen in trials.

    Attributes:
        succeeded: Trials that did.
        moved: m, in each control step in which a hand was led and a finger touched.
        speeds: rad/s, of each pair of steps in which a hand was led.
    """

    succeeded: int = 0
    moved: list[float] = field(default_factory=list)
    speeds: list[float] = field(default_factory=list)


class Tips:
    """A view that compares commanded fingertips with those of the pose without its correction.

    Args:
        session: The session.
        held: What takes the measurements.
    """

    def __init__(self, session: Session, held: Held) -> None:
        self._session, self._held = session, held
        self._before: list[Any] = [None for _ in session.rigs]

    def __call__(self, snapshot: Snapshot) -> None:
        """Reads the poses after a control step."""
        for hand, rig in enumerate(self._session.rigs):
            if self._session.correction(hand) is None:
                self._before[hand] = None
                continue
            reconstruction = self._session.reconstructions[hand]
            q = reconstruction.q
            fingers, skeleton = tuple(sorted(reconstruction.touches)), rig.hand.skeleton
            if fingers and skeleton is not None:
                kinematics = OnePose(skeleton, fingers)
                apart = kinematics.tips(q) - kinematics.tips(rig.reconstructor.commanded)
                self._held.moved.append(float(np.linalg.norm(apart, axis=1).max()))
            if self._before[hand] is not None:
                change = (q[JOINTS] - self._before[hand]).reshape(-1, 3)
                fastest = float(np.linalg.norm(change, axis=1).max())
                self._held.speeds.append(fastest / CONTROL_PERIOD)
            self._before[hand] = q[JOINTS].copy()


def play(job: Job) -> Held:
    """Plays one trial."""
    held = Held()
    options = SceneOptions(task=job.task, seed=job.seed, solid="hand", impulse=job.impulse)
    chosen = plan(options)
    done = run_trial(
        chosen.settings, chosen.makers, lambda session: [Tips(session, held)], about=chosen.about
    )
    held.succeeded = int(done.success)
    return held


def row(task: str, plays: Sequence[Held]) -> str:
    """One line of the table."""
    moved = np.array([each for held in plays for each in held.moved])
    speeds = np.array([each for held in plays for each in held.speeds])
    cells = (
        task,
        f"{sum(held.succeeded for held in plays)}/{len(plays)}",
        f"{len(moved)}",
        f"{1000.0 * np.median(moved):.2f}, {1000.0 * moved.max():.1f}",
        f"{np.count_nonzero(moved > MOVED)}",
        f"{speeds.max():.1f}",
        f"{np.count_nonzero(speeds > FAST)}",
    )
    return "| " + " | ".join(cells) + " |"


def main() -> None:
    """Prints the table."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--tasks", nargs="+", default=["books", "slalom"], choices=list(TASKS))
    parser.add_argument("--seeds", default="7001:7013", help="first and last but one training seed")
    parser.add_argument("--impulse", default="safe", help="paper, safe, or N s of an impulse")
    parser.add_argument("--workers", type=int, default=os.cpu_count() or 1)
    options = parser.parse_args()
    seeds = parse_seeds(options.seeds)
    print(describe_machine())
    heads = ("task", "succeeded", "steps", "moved: median, most (mm)", "moved by more than 1 mm")
    print("| " + " | ".join((*heads, "fastest, rad/s", f"faster than {FAST:g} rad/s")) + " |")
    print("| --- " * 7 + "|")
    # One thread a process: the machine's cores are the processes' already.
    os.environ["OMP_NUM_THREADS"] = "1"
    with ProcessPoolExecutor(options.workers) as pool:
        for task in options.tasks:
            jobs = [Job(task, options.impulse, seed) for seed in seeds]
            print(row(task, list(pool.map(play, jobs))), flush=True)


if __name__ == "__main__":
    run(main)
