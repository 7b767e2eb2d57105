"""Measures tasks with hinges and slides: success and score by what is solid and by how fingers are
named.

    python -m benchmarks.mechanisms [--tasks TASK...] [--seeds 6000:6025] [--fingers N]

Trials of the simulated user on training seeds. Rows are the names of fingers that are compared,
all with the same encoder, correction and filter; columns are what of the hand is solid. Points are
those of `tasks.score.points`. *Named at once*: at the first moment of a trial when a hand is down,
all of its touches have their true names. The control arms do nothing, or touch at random.
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from dataclasses import dataclass
from statistics import mean, median
from typing import Any, Literal

from benchmarks.machine import describe_machine
from benchmarks.one_line import run
from sandbox.devices.simulated.simulated import SimulatedDevice
from sandbox.options.scene_options import SceneOptions, plan
from sandbox.regress.plan import parse_seeds
from sandbox.session.messages import Snapshot
from sandbox.session.session import Session
from sandbox.trial.headless import run_trial
from tasks.registry import find_task
from tasks.score import points

TASKS = ("chords", "dial")

SOLID: tuple[Literal["fingertips", "hand"], ...] = ("fingertips", "hand")

ROWS: dict[str, dict[str, Any]] = {
    "as it ships": {},
    "true names": {"tell_labels": True},
    "the paper's names": {"labels": "paper"},
    "idle": {"user": "idle"},
    "random": {"user": "random"},
}
"""Options of a trial by the name of a row."""


@dataclass(frozen=True)
class Played:
    """One trial: success, points, s until it ended, and whether its first touch was named right;
    None if it was not named, or nobody knows."""

    success: bool
    points: float
    seconds: float
    named: bool | None


class Names:
    """A view that compares the names of a trial's first touch with the true ones.

    Args:
        session: The session.

    Attributes:
        right: All touches had their true names when the hand was first down; None before.
    """

    def __init__(self, session: Session) -> None:
        self._device = session.first_rig.device
        self.right: bool | None = None

    def __call__(self, snapshot: Snapshot) -> None:
        """Looks at the hand after a control period."""
        hand, device = snapshot.hands[0], self._device
        named = [c for c in hand.contacts if c.label is not None]
        if self.right is not None or hand.phase != "down" or not named:
            return
        if isinstance(device, SimulatedDevice) and device.truth:
            self.right = all(device.truth.get(c.id) == c.label for c in named)


def play(task: str, seed: int, options: dict[str, Any]) -> Played:
    """Plays one trial."""
    watched: list[Names] = []

    def watch(session: Session) -> Sequence[Names]:
        watched.append(Names(session))
        return watched

    chosen = plan(SceneOptions(task=task, seed=seed, **options))
    done = run_trial(chosen.settings, chosen.makers, watch, about=chosen.about)
    limit = find_task(task).time_limit
    score = points(done.success, done.progress, done.time_s, limit)
    return Played(done.success, score, done.time_s, watched[0].right)


def row(task: str, name: str, seeds: Sequence[int], fingers: int) -> str:
    """One line of the table."""
    cells = [task, name]
    for solid in SOLID:
        options = {"solid": solid, "fingers": fingers, **ROWS[name]}
        plays = [play(task, seed, options) for seed in seeds]
        named = [p.named for p in plays if p.named is not None]
        done = [p.seconds for p in plays if p.success]
        cells += [
            f"{sum(p.success for p in plays)}/{len(plays)}",
            f"{mean(p.points for p in plays):.0f}",
            f"{median(done):.1f}" if done else "",
            f"{sum(named)}/{len(named)}" if named else "",
        ]
    return "| " + " | ".join(cells) + " |"


def main() -> None:
    """Prints the table."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--tasks", nargs="+", default=TASKS)
    parser.add_argument("--rows", nargs="+", default=list(ROWS), choices=list(ROWS))
    parser.add_argument("--fingers", type=int, default=3)
    parser.add_argument("--seeds", default="6000:6025", help="first and last but one training seed")
    options = parser.parse_args()
    seeds = parse_seeds(options.seeds)
    print(describe_machine())
    heads = [
        f"{what}, {solid}"
        for solid in SOLID
        for what in ("success", "points", "median s of successes", "named at once")
    ]
    print("| task | names | " + " | ".join(heads) + " |")
    print("| --- " * (2 + len(heads)) + "|")
    for task in options.tasks:
        for name in options.rows:
            print(row(task, name, seeds, options.fingers), flush=True)


if __name__ == "__main__":
    run(main)
