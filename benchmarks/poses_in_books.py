"""Which part of the encoder's pose is inside of a book in the task `books`, by method.

    python -m benchmarks.poses_in_books [--seeds 9000:9040]

Trials of the simulated user on training seeds, three fingers, the whole hand solid. In every
control step in which the hand is down, the encoder's pose is looked at as it is before the hand is
led clear of things: which of its parts is deepest inside of a book? Ends of fingers that touch do
not count. The own joints of a free finger can lead it out. The palm and a finger that touches are
harder to lead out, as the fingertips are to stay. `at full speed` is the share of these steps in
which the correction that leads the hand clear changes as fast as it may.
"""

from __future__ import annotations

import argparse
import os
from collections import Counter
from collections.abc import Iterable, Sequence
from concurrent.futures import ProcessPoolExecutor
from itertools import product
from statistics import mean, median
from typing import NamedTuple

import numpy as np

from benchmarks.machine import describe_machine
from benchmarks.methods import METHODS
from benchmarks.one_line import run
from models.arithmetic.arrays import Array
from models.frames import FINGERS
from models.pose import ROOT_POSITION
from models.scene import CONTROL_PERIOD, Scene
from sandbox.clearing.clearing import SPEED
from sandbox.clearing.hand_distances import HandDistances
from sandbox.options.scene_options import SceneOptions, plan
from sandbox.regress.plan import parse_seeds
from sandbox.session.session import Session
from sandbox.trial.headless import run_trial

COMPARED = ("mean pose", "linear", "quadratic", "cubic", "what ships")

_FASTEST = 0.99 * SPEED * CONTROL_PERIOD
"""rad (and a tenth of it, m): such a change in a control step counts as at full speed."""


class Job(NamedTuple):
    """A trial to be played."""

    method: str
    seed: int


class Seen(NamedTuple):
    """What was seen of the encoder's poses in a trial.

    Attributes:
        success: The goal was held.
        depths: mm, of the part that is deepest inside of a book; one for each control step.
        parts: `palm`, or the name of its finger; one for each control step with a depth above 0.
        fast: Number of steps in which the correction changed as fast as it may.
    """

    success: bool
    depths: list[float]
    parts: Counter[str]
    fast: int


class Look:
    """A view that looks at the encoder's poses.

    Args:
        session: The session.
    """

    def __init__(self, session: Session) -> None:
        self._session = session
        # The session's own scene has ghosts already.
        scene = Scene(session.scene.spec)
        self._scene, self._distances = scene, HandDistances(scene, 0)
        model, hand = scene.model, scene.spec.hands[0]
        links = {link.finger: link for link in hand.links}
        self._ends = {model.geom(link.tip_geom).id: finger for finger, link in links.items()}
        self._finger = {
            model.geom(name).id: FINGERS[link.finger]
            for link in hand.links
            for name in (link.geom, link.tip_geom)
        }
        self._books = {
            geom
            for geom in range(model.ngeom)
            if model.body(model.geom_bodyid[geom]).name.startswith("book")
        }
        self._offset: Array | None = None
        self.depths: list[float] = []
        self.parts: Counter[str] = Counter()
        self.fast = 0

    def __call__(self, snapshot: object) -> None:
        """Looks at the pose of a control period."""
        now = self._session.reconstructions[0]
        pose = self._session.first_rig.reconstructor.commanded
        offset = now.q - pose
        before, self._offset = self._offset, offset
        if not now.down or not now.touches:
            return
        if before is not None:
            change = np.abs(offset - before)
            change[ROOT_POSITION] *= 10.0
            self.fast += bool(change.max() > _FASTEST)
        near = self._distances.near(self._session.data, self._scene.pose_to_qpos(0, pose))
        inside = [
            (distance, part)
            for part, distance, thing in zip(*near, strict=True)
            if thing in self._books and self._ends.get(part) not in now.touches
        ]
        distance, part = min(inside, default=(0.0, -1))
        self.depths.append(max(0.0, -1000 * distance))
        if distance < 0.0:
            self.parts[self._finger.get(part, "palm")] += 1


def play(job: Job) -> Seen:
    """Plays a trial and looks."""
    looks: list[Look] = []

    def watch(session: Session) -> Sequence[Look]:
        looks.append(Look(session))
        return looks

    options = {"solid": "hand", "fingers": 3, **METHODS[job.method]}
    chosen = plan(SceneOptions(task="books", seed=job.seed, **options))
    done = run_trial(chosen.settings, chosen.makers, watch, about=chosen.about)
    (look,) = looks
    return Seen(done.success, look.depths, look.parts, look.fast)


def rows(seen: dict[str, list[Seen]]) -> Iterable[str]:
    """The table, one line a method."""
    heads = ("method", "succeeded", "deepest, mm, median", "palm", *FINGERS, "at full speed")
    yield "| " + " | ".join(heads) + " |"
    yield "| --- " * len(heads) + "|"
    for method, trials in seen.items():
        parts = sum((trial.parts for trial in trials), Counter[str]())
        steps = sum(len(trial.depths) for trial in trials)
        cells = [method, f"{sum(trial.success for trial in trials)} of {len(trials)}"]
        cells.append(f"{median(max(trial.depths) for trial in trials):.0f}")
        cells += [f"{100 * parts[part] / steps:.0f} %" for part in ("palm", *FINGERS)]
        cells.append(f"{100 * mean(trial.fast / len(trial.depths) for trial in trials):.0f} %")
        yield "| " + " | ".join(cells) + " |"


def main() -> None:
    """Plays the trials and prints the table."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--seeds", default="9000:9040", help="first and last but one training seed")
    parser.add_argument("--methods", nargs="+", default=list(COMPARED), choices=list(METHODS))
    parser.add_argument("--workers", type=int, default=os.cpu_count() or 1)
    options = parser.parse_args()
    seeds = parse_seeds(options.seeds)
    jobs = [Job(*each) for each in product(options.methods, seeds)]
    os.environ["OMP_NUM_THREADS"] = "1"
    seen: dict[str, list[Seen]] = {}
    with ProcessPoolExecutor(options.workers) as pool:
        for job, trial in zip(jobs, pool.map(play, jobs), strict=True):
            seen.setdefault(job.method, []).append(trial)
    print(describe_machine())
    print("\n".join(rows(seen)))


if __name__ == "__main__":
    run(main)
