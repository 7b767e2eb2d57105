"""How far a free wrench moves when it is let go of, by lifting the fingers and by spreading them.

    python -m benchmarks.releases                   # 200 releases of each kind
    python -m benchmarks.releases --trials 20       # a quick look
    python -m benchmarks.releases --first 20 --trials 180
    python -m benchmarks.releases --table --files A B      # one table of what two runs have kept

Two or three fingers close on a wrench of 1.5 to 3 times the size, until the thumb presses with a
force drawn from 10 to 70 N, or touches would be nearer to each other than fingers are wide. They
carry it 20 mm and turn it by 15 degrees, rest, and let go: either all fingers are lifted within
33 ms, or they spread until they are 10 mm beside the faces, and are lifted then. Touches tremble by
0.3 mm. What counts is how far the wrench has moved along the table, and turned about the vertical,
0.8 s after the last finger has left, from where it was when the release began. A strong grip raises
and tilts the wrench, which falls back as it is let go of; how much is told beside, and the largest
step of a drawn fingertip in a control period, beyond that of its touch.

SIMULATED fingers: no person took part.

Trials are kept in `--files` as they end, and not played again: after a change of the program, begin
another file.
"""

from __future__ import annotations

import argparse
import os
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import product
from pathlib import Path
from typing import NamedTuple

import mujoco
import numpy as np
from rich.console import Console
from rich.table import Table

from benchmarks.kept_trials import KeptTrials
from benchmarks.near_faces import LAND, NOISE, STAGGER, TIP, DrawnSteps, share
from benchmarks.touched_things import LargeWrenchOnTable, seed_of
from models.arithmetic.arrays import Array
from models.frames import Contact, TouchFrame
from models.scene import CONTROL_PERIOD
from models.surface import Surface
from sandbox.session.device import Device
from sandbox.session.session import Session
from sandbox.trial.assembly import build
from sandbox.trial.settings import RULES, RunSettings
from tasks.simulated_user.grasp import wrapped
from tasks.simulated_user.hand import NARROWEST
from tasks.task import Task

KINDS = {"lifting": 0.0, "spreading": 0.12, "spreading slowly": 0.03}
"""m/s of each finger that spreads, on its way, by the kind of the release."""
FORCE = (10.0, 70.0)
"""N of the thumb, across the face."""
CLOSED_BY, CLOSING = 2.5, 0.04
"""s after which the fingers close no more, and m/s of each finger that closes."""
CARRY, REST, AFTER = 0.8, 0.3, 0.8
"""s."""
WAY, TURN = 0.020, np.deg2rad(15.0)
"""m and rad, of the carrying."""
BESIDE = 0.010
"""m beside the faces, where spread fingers end."""
GOOD_WAY, GOOD_TURN = 5.0, 5.0
"""mm and degrees, below which a release is clean."""


class Job(NamedTuple):
    """One trial."""

    kind: str
    fingers: int
    number: int
    rules: int


@dataclass(frozen=True)
class Outcome:
    """What happened in one trial.

    Attributes:
        grip: N of the thumb when the release began.
        sideways: N, largest force along a face of any finger then.
        moved, turned: mm along the table and degrees about the vertical at the end.
        raised, tilted: mm and degrees, when the release began.
        step: mm, largest step of a drawn fingertip beyond that of its touch since it began.
        lost: The hand did not hold the wrench when the release began.
    """

    grip: float
    sideways: float
    moved: float
    turned: float
    raised: float
    tilted: float
    step: float
    lost: bool


class Releasing(Device):
    """Fingers that land, close with a force, carry, rest and let go.

    Args:
        task: The wrench.
        surface: Surface of the touches.
        kind: One of `KINDS`.
    """

    def __init__(self, task: LargeWrenchOnTable, surface: Surface, kind: str) -> None:
        self._surface, self._grip, self._kind = surface, task.grip(), kind
        self._rng = np.random.default_rng([task.seed, list(KINDS).index(kind), 61_009])
        count = len(self._grip.points)
        self._down = LAND + self._rng.permutation(np.linspace(0.0, STAGGER, count))
        self._up = self._rng.permutation(np.linspace(0.0, STAGGER, count))
        self._ids = self._rng.permutation(count)
        # Drawn the same for both kinds.
        drawn = np.random.default_rng([task.seed, 61_011])
        self.force = float(drawn.uniform(*FORCE))
        self._turn = float(drawn.choice((-TURN, TURN)))
        way = drawn.uniform(-np.pi, np.pi)
        self._shift = WAY * np.array([np.cos(way), np.sin(way)])
        self._landed, self._gap = self._grip.points.mean(axis=0), 0.012
        self._width = float(np.ptp(self._grip.points @ self._grip.axis))
        self._gripped = np.inf
        self.feel: Callable[[], float] = lambda: 0.0

    @property
    def release(self) -> float:
        """s at which the fingers begin to let go; infinite while that is not known."""
        return self._gripped + CARRY + 2 * REST

    @property
    def spread(self) -> float:
        """s that the spreading takes."""
        way, speed = BESIDE + TIP - self._gap, KINDS[self._kind]
        return max(way / speed, 0.1) if speed else 0.0

    @property
    def gone(self) -> float:
        """s at which the last finger has left."""
        return self.release + self.spread + STAGGER

    def _places(self, now: float) -> Array:
        gap = self._gap
        if self.spread > 0.0:
            gap += (BESIDE + TIP - gap) * share((now - self.release) / self.spread)
        places = self._grip.points + gap * self._grip.outwards
        done = share((now - self._gripped - REST) / CARRY)
        c, s = np.cos(done * self._turn), np.sin(done * self._turn)
        turn = np.array([[c, s], [-s, c]])
        return self._landed + done * self._shift + (places - self._landed) @ turn

    def poll(self, now: float) -> list[TouchFrame]:
        if now > 1.2 and self._gripped == np.inf:
            nearest = self._width + 2 * self._gap <= NARROWEST
            if self.feel() >= self.force or nearest or now > 1.2 + CLOSED_BY:
                self._gripped = now
            else:
                self._gap -= CLOSING * CONTROL_PERIOD
        places = self._places(now) + self._rng.normal(0.0, NOISE, self._grip.points.shape)
        world = np.column_stack([places, np.zeros(len(places))])
        left = now - self.release - self.spread
        contacts = tuple(
            Contact(int(i), *at)
            for i, at, down, up in zip(
                self._ids,
                self._surface.to_surface(world).tolist(),
                self._down,
                self._up,
                strict=True,
            )
            if now >= down and not left >= up
        )
        return [TouchFrame(now, contacts)]


def finger_forces(session: Session) -> dict[str, tuple[float, float]]:
    """N across and along the face, of every part of a hand that touches the thing."""
    model, data = session.scene.model, session.data
    forces: dict[str, tuple[float, float]] = {}
    found = np.zeros(6)
    for i in range(data.ncon):
        names = [model.body(model.geom_bodyid[g]).name for g in data.contact[i].geom]
        if "thing" in names and "world" not in names:
            part = names[1 - names.index("thing")]
            mujoco.mj_contactForce(model, data, i, found)
            across, along = forces.get(part, (0.0, 0.0))
            forces[part] = across + float(found[0]), along + float(np.hypot(found[1], found[2]))
    return forces


def trial(job: Job) -> Outcome:
    """Plays one trial."""
    devices: list[Releasing] = []

    def make(task: Task, surface: Surface) -> Releasing:
        assert isinstance(task, LargeWrenchOnTable)
        devices.append(Releasing(task, surface, job.kind))
        return devices[-1]

    settings = RunSettings(
        task=f"{LargeWrenchOnTable.__module__}:{LargeWrenchOnTable.__name__}",
        seed=seed_of(0, job.fingers, job.number),
        labels="population",
        rules=job.rules,
    )
    session = build(settings, (make,))
    device = devices[0]

    def strongest() -> float:
        return max((across for across, _ in finger_forces(session).values()), default=0.0)

    device.feel = strongest
    try:
        while session.time < device.release:
            session.advance()
        forces = finger_forces(session)
        begin = session.scene.object_pose(session.data, "thing")
        steps = DrawnSteps()
        while session.time < device.gone + AFTER:
            steps(session.advance().hands[0])
        end = session.scene.object_pose(session.data, "thing")
    finally:
        session.close()
    across, along = zip(*forces.values(), strict=True) if forces else ((0.0,), (0.0,))
    moved = 1000 * float(np.linalg.norm((end[0] - begin[0])[:2]))
    resting = session.task.objects[0].position[2]
    return Outcome(
        max(across),
        max(along),
        moved,
        abs(np.rad2deg(wrapped(yaw_of(end[1]) - yaw_of(begin[1])))),
        1000 * float(begin[0][2] - resting),
        float(np.rad2deg(np.arccos(min(begin[1][2, 2], 1.0)))),
        1000 * steps.largest,
        len(forces) < 2,
    )


def yaw_of(rotation: Array) -> float:
    """rad about the vertical, of a rotation (3, 3)."""
    return float(np.arctan2(rotation[1, 0], rotation[0, 0]))


def add_row(table: Table, name: str, found: Sequence[Outcome]) -> None:
    """Adds the row of some releases."""
    if not found:
        return

    def spread(values: Sequence[float]) -> str:
        low, middle, high = np.percentile(values, [5, 50, 95])
        return f"{middle:.0f} ({low:.0f} to {high:.0f})"

    def worst(values: Sequence[float]) -> str:
        return f"{np.percentile(values, 95):.1f}, {max(values):.1f}"

    clean = sum(o.moved < GOOD_WAY and o.turned < GOOD_TURN for o in found)
    table.add_row(
        name,
        f"{clean}/{len(found)}",
        worst([o.moved for o in found]),
        worst([o.turned for o in found]),
        worst([o.raised for o in found]),
        worst([o.tilted for o in found]),
        worst([o.step for o in found]),
        spread([o.grip for o in found]),
        spread([o.sideways for o in found]),
    )


def main() -> None:
    """Prints the table."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--trials", type=int, default=200, help="of each kind")
    parser.add_argument("--first", type=int, default=0, help="of each kind, left out before")
    parser.add_argument("--fingers", type=int, nargs="+", choices=(2, 3, 5), default=(2, 3))
    parser.add_argument("--rules", type=int, choices=RULES, default=RULES[-1])
    parser.add_argument("--workers", type=int, default=os.cpu_count() or 1)
    parser.add_argument("--files", type=Path, nargs="+", default=[Path("out/releases.jsonl")])
    parser.add_argument("--table", action="store_true", help="only print what is there")
    parser.add_argument("--failures", action="store_true", help="list releases that are not clean")
    options = parser.parse_args()
    first, each = (-(-n // len(options.fingers)) for n in (options.first, options.trials))
    # Number by number, so that what is cut short has every kind to the same extent.
    numbers = range(first, first + each)
    jobs = [
        Job(kind, fingers, number, options.rules)
        for number, kind, fingers in product(numbers, KINDS, options.fingers)
    ]
    kept = KeptTrials(Job, Outcome, options.files)
    if not options.table:
        kept.play(trial, jobs, options.workers)
    done = [
        (j, o)
        for j, o in kept.done.items()
        if j.fingers in options.fingers and j.rules == options.rules
    ]
    table = Table(
        "release",
        "clean",
        "moved, mm: 95 %, most",
        "turned, degrees",
        "raised before, mm",
        "tilted, degrees",
        "step of a tip, mm",
        "grip, N: median (5 to 95 %)",
        "sideways, N",
    )
    for kind in KINDS:
        for fingers in options.fingers:
            rows = [o for j, o in done if (j.kind, j.fingers) == (kind, fingers) and not o.lost]
            add_row(table, f"{kind}, {fingers} fingers", rows)
        add_row(table, kind, [o for j, o in done if j.kind == kind and not o.lost])
    Console(width=165).print(table)
    print(f"{sum(o.lost for _, o in done)} of {len(done)} not held when the release began")
    if options.failures:
        for job, o in done:
            if o.lost or not (o.moved < GOOD_WAY and o.turned < GOOD_TURN):
                print(tuple(job), o)


if __name__ == "__main__":
    main()
