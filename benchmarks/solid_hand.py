"""Measures a hand that is solid all over: success, unwanted pushes, and what a control step costs.

    python -m benchmarks.solid_hand [--tasks TASK...] [--fingers N...] [--seeds 0:20]

Trials of the simulated user on training seeds, each played twice: with `--solid
fingertips` and with `--solid hand`. An unwanted push
is the force between an object and the palm or a finger that does not touch, or, counted apart, an
inner link of one that does; it is read at the end of every control period. Processor time of a
control step is that of whole trials, and the ratio is of trials with the same seed in one run.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Sequence
from dataclasses import dataclass
from statistics import median
from typing import Literal

import mujoco
import numpy as np
from numpy.typing import NDArray

from benchmarks.machine import describe_machine
from benchmarks.one_line import run
from sandbox.options.scene_options import SceneOptions, plan
from sandbox.regress.plan import parse_seeds
from sandbox.session.session import Session
from sandbox.trial.headless import run_trial

TASKS = ("box-to-goal", "wrench-turn", "wrench-slide", "stack", "stack-vertical")

SOLID: tuple[Literal["fingertips", "hand"], ...] = ("fingertips", "hand")

FELT = 1.0
"""N, from which on a push counts as lasting."""


class Pushes:
    """A view that reads the unwanted pushes of a session.

    Args:
        session: The session.

    Attributes:
        largest: N, the largest one so far, of palm and free fingers.
        inner: N, the largest one so far of inner links of touching fingers.
        lasting: s for which one was larger than `FELT`.
        steps: Control periods so far.
    """

    def __init__(self, session: Session) -> None:
        self._session = session
        model, spec = session.scene.model, session.scene.spec
        self._part = np.full(model.ngeom, -1)
        self._last = np.full(model.ngeom, -1)
        self._finger = np.full(model.ngeom, -1)
        for i, hand in enumerate(spec.hands):
            self._part[session.scene.parts(i)] = i
            for link in hand.links:
                for name in (link.geom, link.tip_geom):
                    self._finger[model.geom(name).id] = link.finger
            for link in {k.finger: k for k in hand.links}.values():
                for name in (link.geom, link.tip_geom):
                    self._last[model.geom(name).id] = link.finger
        of_things = model.geom_contype & 2
        self._thing: NDArray[np.bool_] = (of_things > 0) & (self._part < 0)
        self.largest = self.inner = self.lasting = 0.0
        self.steps = 0

    def __call__(self, snapshot: object) -> None:
        """Reads the state after a control period."""
        self.steps += 1
        free, inner = self._forces()
        now = max(free, default=0.0)
        self.inner = max([self.inner, *inner])
        self.largest = max(self.largest, now)
        if now > FELT:
            self.lasting += self._session.scene.substeps * self._session.scene.spec.timestep

    def _forces(self) -> tuple[list[float], list[float]]:
        """N, of every contact of palm and free fingers, and of inner links of touching ones."""
        session = self._session
        model, data = session.scene.model, session.data
        touching = [r.fingers for r in session.reconstructions]
        free: list[float] = []
        inner: list[float] = []
        force = np.zeros(6)
        for k, (a, b) in enumerate(data.contact.geom.tolist()):
            part, thing = (a, b) if self._part[a] >= 0 else (b, a)
            hand = int(self._part[part])
            if hand < 0 or not self._thing[thing] or int(self._last[part]) in touching[hand]:
                continue
            mujoco.mj_contactForce(model, data, k, force)
            of_touching = int(self._finger[part]) in touching[hand]
            (inner if of_touching else free).append(float(np.linalg.norm(force[:3])))
        return free, inner


@dataclass(frozen=True)
class Played:
    """One trial: success, s until it ended, largest pushes in N, s of pushes, us a control step."""

    success: bool
    seconds: float
    push: float
    inner: float
    lasting: float
    step_us: float


def play(task: str, fingers: int, seed: int, solid: Literal["fingertips", "hand"]) -> Played:
    """Plays one trial."""
    watched: list[Pushes] = []

    def watch(session: Session) -> Sequence[Pushes]:
        watched.append(Pushes(session))
        return () if solid == SOLID[0] else watched

    chosen = plan(SceneOptions(task=task, seed=seed, fingers=fingers, solid=solid))
    begin = time.process_time()
    result = run_trial(chosen.settings, chosen.makers, watch, about=chosen.about)
    spent = time.process_time() - begin
    steps = result.time_s / 0.016
    return Played(
        result.success,
        result.time_s,
        watched[0].largest,
        watched[0].inner,
        watched[0].lasting,
        1e6 * spent / max(steps, 1.0),
    )


def row(task: str, fingers: int, seeds: Sequence[int]) -> str:
    """One line of the table."""
    plays = {solid: [play(task, fingers, seed, solid) for seed in seeds] for solid in SOLID}
    ours, peer = plays[SOLID[1]], plays[SOLID[0]]
    pushes = [p.push for p in ours]
    ratio = median(a.step_us / b.step_us for a, b in zip(ours, peer, strict=True))
    cells = (
        task,
        str(fingers),
        *(f"{sum(p.success for p in plays[s])}/{len(seeds)}" for s in SOLID),
        *(f"{median(p.seconds for p in plays[s]):.1f}" for s in SOLID),
        f"{median(pushes):.1f}, {max(pushes):.1f}",
        f"{max(p.inner for p in ours):.1f}",
        f"{sum(p.lasting for p in ours) / len(ours):.2f}",
        str([seed for seed, p in zip(seeds, ours, strict=True) if not p.success]),
        f"{ratio:.2f}",
    )
    return "| " + " | ".join(cells) + " |"


def main() -> None:
    """Prints the table."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n", 1)[0] if __doc__ else "")
    parser.add_argument("--tasks", nargs="+", default=TASKS)
    parser.add_argument("--fingers", nargs="+", type=int, default=[3])
    parser.add_argument("--seeds", default="0:20", help="first and last but one training seed")
    options = parser.parse_args()
    seeds = parse_seeds(options.seeds)
    print(describe_machine())
    print(
        "| task | fingers | success, fingertips | success, hand | s, fingertips | s, hand "
        "| largest push of free parts: median, max (N) | of inner links: max (N) | s above 1 N "
        "| failed, hand "
        "| control step, hand to fingertips |"
    )
    print("| --- " * 11 + "|")
    for fingers in options.fingers:
        for task in options.tasks:
            print(row(task, fingers, seeds), flush=True)


if __name__ == "__main__":
    run(main)
