"""Tasks done by a simulated hand in the air over a simulated Leap: success, time, grasps.

    python -m benchmarks.in_air                         # what docs/paalm.md says
    python -m benchmarks.in_air --tasks stack --links 2 # with other rules of what is solid

Development seeds, or with `--judged` those of `benchmarks.judged_air`. Nobody is real: the user is
`sandbox.devices.simulated.air_user`, the device `encoders.paalm.simulated.eye`.
"""

from __future__ import annotations

import argparse
from itertools import pairwise
from typing import Any

import numpy as np

import sandbox.trial.assembly as assembly
from benchmarks.judged_air import air_seeds
from benchmarks.one_line import run
from models.surface import Surface
from sandbox.devices.simulated.leap_disturbance import LeapDisturbance
from sandbox.devices.simulated.leap_user import SimulatedLeap
from sandbox.options.leap_devices import split_by_side
from sandbox.session.messages import Snapshot
from sandbox.session.session import Session
from sandbox.trial.device_makers import DeviceMaker
from sandbox.trial.driver import View
from sandbox.trial.hand_input import UNDER, HandInput
from sandbox.trial.headless import run_trial
from sandbox.trial.result import TrialResult
from sandbox.trial.settings import HandSettings, RunSettings
from tasks.registry import find_task, hands_of
from tasks.task import Task
from tasks.user import UserConfiguration

SHOWS = 0.002
"""m."""
TASKS = ("box-to-goal", "stack", "wrench-slide", "wrench-turn", "carry-together")


class Depth:
    """How deep the links before the last ones are in things, which nothing hinders unless solid.

    Attributes:
        deepest: m.
        inside: Pictures in which any of them is deeper than `SHOWS`.
        pictures: All.
    """

    def __init__(self) -> None:
        self.deepest, self.inside, self.pictures = 0.0, 0, 0

    def watch(self, session: Session) -> list[View]:
        """A view that looks at every fourth picture."""
        model, data = session.scene.model, session.data
        pairs = []
        for hand in session.scene.spec.hands:
            for link, after in pairwise(hand.links):
                if link.finger == after.finger and link is not hand.links[0]:
                    ids = [model.body(k.body).id for k in (link, after)]
                    pairs.append((*ids, link.radius))
        shares = np.linspace(0.0, 1.0, 5)[:, None]

        def look(snapshot: Snapshot) -> None:
            if snapshot.step // session.scene.substeps % 4:
                return
            worst = 0.0
            for a, b, radius in pairs:
                points = data.xpos[a] + shares * (data.xpos[b] - data.xpos[a])
                for thing in session.task.objects:
                    pose = session.scene.object_pose(data, thing.name)
                    worst = max(worst, radius - float(thing.clearance(points, *pose).min()))
            self.pictures += 1
            self.inside += worst > SHOWS
            self.deepest = max(self.deepest, worst)

        return [look]


def play(
    task: str,
    seed: int,
    dialect: str,
    kind: str,
    size: float,
    depth: Depth,
    trouble: LeapDisturbance,
) -> tuple[TrialResult, int]:
    """One trial's result, and how often something was grasped."""
    two = hands_of(find_task(task)) > 1
    sides = ("right", "left") if two else ("right",)
    hands = tuple(HandSettings(side, size, in_air=HandInput()) for side in sides)
    settings = RunSettings(task=task, seed=seed, hands=hands)
    made: list[SimulatedLeap] = []

    def maker(hand: int) -> DeviceMaker:
        def make(drawn: Task, surface: Surface) -> Any:
            user = UserConfiguration(kind=kind)
            person = settings.hands[hand].person
            made.append(
                SimulatedLeap(drawn, user, seed, UNDER, dialect, person, hand, trouble=trouble)
            )
            return made[-1]

        return make

    makers = tuple(map(maker, range(len(hands))))
    if two:
        makers = split_by_side(makers, makers[0], settings)
    result = run_trial(settings, makers, depth.watch)
    return result, sum(device.user.grasps for device in made)


def main() -> None:
    """Prints a line for every task and dialect."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--tasks", nargs="+", default=TASKS)
    parser.add_argument("--dialects", nargs="+", default=("v3", "v1"))
    parser.add_argument("--seeds", type=int, default=20)
    parser.add_argument("--user", default="skilled", choices=("skilled", "idle", "random"))
    parser.add_argument("--links", type=int, default=None, help="solid links of every finger")
    parser.add_argument("--apart", action="store_true", help="fingers become solid one by one")
    parser.add_argument("--noise", type=float, default=1.0, help="times the device's noise")
    parser.add_argument("--lose", type=float, default=0.0, help="s without the hand, in mid-carry")
    parser.add_argument("--judged", action="store_true", help="seeds of the frozen configuration")
    parser.add_argument("--hand-size", type=float, default=1.0)
    options = parser.parse_args()
    if options.links is not None:
        assembly.IN_AIR["links"] = options.links
    if options.apart:
        assembly.IN_AIR["together"] = False
    trouble = LeapDisturbance(options.noise, options.lose)
    seeds = f"{options.seeds} judged seeds" if options.judged else f"seeds 0 to {options.seeds - 1}"
    print(f"SIMULATED user ({options.user}) and device ({trouble}); {seeds}; {assembly.IN_AIR}")
    for task in options.tasks:
        for dialect in options.dialects:
            depth = Depth()
            drawn = air_seeds(options.seeds, task) if options.judged else range(options.seeds)
            found = [
                play(task, seed, dialect, options.user, options.hand_size, depth, trouble)
                for seed in drawn
            ]
            won = [result for result, _ in found if result.success]
            times = [result.time_s for result in won] or [float("nan")]
            grasps = np.mean([count for _, count in found])
            back = sum(result.respawned for result, _ in found)
            print(
                f"{task:15} {dialect}: {len(won)} of {len(found)}, median {np.median(times):.1f} s,"
                f" {grasps:.2f} grasps a trial, {back} things put back,"
                f" other links deeper than {1000 * SHOWS:.0f} mm in"
                f" {100 * depth.inside / depth.pictures:.0f} % of pictures,"
                f" {1000 * depth.deepest:.0f} mm at most",
                flush=True,
            )


if __name__ == "__main__":
    run(main)
