"""Whether fingers that are put against a thing give a solid hand that holds it.

    python -m benchmarks.near_faces                       # all of it, about 40 minutes on 2 cores
    python -m benchmarks.near_faces --each 2              # a quick look
    python -m benchmarks.near_faces --first 2 --each 3    # numbers 2, 3 and 4 of every combination
    python -m benchmarks.near_faces --table --files A B   # one table of what two runs have kept
    python -m benchmarks.near_faces --cost                # of a control step with no thing near

Two, three and five fingers land beside the faces that they are to hold, with no room at all up to
14 mm, of boxes, wrenches and mugs that are turned by 0 to 45 degrees against the hand. All fingers
land within 33 ms, and tremble by 0.3 mm. 0.7 s after the last touch the hand has to be solid, every
touching finger of it. Then the fingers close, from wherever the drawn tips are beside the faces to
4 mm inside, and drag the thing 30 mm across the line between them. It is held if the hand has
stayed solid for these 2 s, and the thing has come along with the drag, within 5 mm and 10 degrees.

Beside the share that is solid and holds: how far the thing was moved before the fingers close; the
largest step of a drawn fingertip along the surface in one control period of 16 ms, beyond the step
of its touch, while the hand comes down or is down; and how long it took to become solid. SIMULATED
fingers: no person took part.

Trials are kept in `--files` as they end, and not played again: after a change of the program, begin
another file.
"""

from __future__ import annotations

import argparse
import os
import time
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product
from pathlib import Path
from typing import NamedTuple

import numpy as np
from rich.console import Console
from rich.table import Table

from benchmarks.kept_trials import KeptTrials
from benchmarks.machine import describe_machine
from benchmarks.touched_things import FINGERS, THINGS, TURNS, OneThing, seed_of
from models.arithmetic.arrays import Array
from models.frames import Contact, TouchFrame
from models.kinematics import Kinematics
from models.scene import CONTROL_PERIOD
from models.skeleton import ADULT
from models.surface import Surface
from sandbox.regress.statistics import wilson
from sandbox.session.device import Device
from sandbox.session.messages import HandView
from sandbox.session.session import Session
from sandbox.trial.assembly import build
from sandbox.trial.settings import RULES, RunSettings
from tasks.task import Task

DISTANCES = tuple(range(0, 16, 2))
"""mm from the faces to the touches."""
LAND, STAGGER = 0.2, 0.033
"""s, when the first finger may land, and within which all do."""
SOLID_BY, HOLD = 0.7, 2.0
"""s from the last touch until the hand has to be solid, and from then on that it has to hold."""
CLOSE, WAIT, DRAG = 0.3, 0.1, 1.2
"""s that the fingers close, rest and drag."""
TIP, SQUEEZE, WAY = 0.008, 0.004, 0.030
"""m, radius of a fingertip, way inside a face, and way of the drag."""
NOISE = 0.0003
"""m, of each touch in each control period."""
SLIP, SPIN = 0.005, 10.0
"""m and degrees that a thing may lag behind the fingers."""


class Job(NamedTuple):
    """One trial: its thing, fingers, turn in degrees, distance in mm, number, and rules."""

    thing: str
    fingers: int
    turn: int
    distance: float
    number: int
    rules: int


@dataclass(frozen=True)
class Outcome:
    """What happened in one trial.

    Attributes:
        solid: Every touching finger was solid in time.
        held: They stayed so, and the thing came along.
        moved: m that the thing had moved before the fingers closed.
        step: m, largest step of a drawn fingertip beyond that of its touch.
        after: s from the last touch until the hand was solid; infinite if it never was.
        notice: What the person was told, at the time when the hand has to be solid.
    """

    solid: bool
    held: bool
    moved: float
    step: float
    after: float
    notice: str


class Touching(Device):
    """Fingers that land beside a thing, close on it and drag it, whatever happens.

    Args:
        task: The thing.
        surface: Surface of the touches.
        distance: m from its faces to the touches as they land.
    """

    def __init__(self, task: OneThing, surface: Surface, distance: float) -> None:
        self._surface, self._grip = surface, task.grip()
        self._rng = np.random.default_rng([task.seed, round(1e6 * distance), 61_007])
        count = len(self._grip.points)
        down = LAND + self._rng.permutation(np.linspace(0.0, STAGGER, count))
        self._down = np.ceil(down / CONTROL_PERIOD) * CONTROL_PERIOD
        self._ids = self._rng.permutation(count)
        self._distance = distance
        self.last = float(self._down.max())
        # The thing slides within the surface: towards its middle from wherever it is.
        across = np.array([-self._grip.axis[1], self._grip.axis[0]])
        middle = surface.to_world(surface.size / 2)[:2]
        off = float(np.sign((middle - self._grip.points.mean(axis=0)) @ across))
        self.across = across * (off or 1.0)

    def places(self, now: float) -> Array:
        """(n, 2) m in the world, where the fingers are meant to be."""
        since = now - self.last - SOLID_BY
        inwards = (max(self._distance - TIP, 0.0) + SQUEEZE) * share(since / CLOSE)
        shift = WAY * share((since - CLOSE - WAIT) / DRAG) * self.across
        return self._grip.points + (self._distance - inwards) * self._grip.outwards + shift

    def poll(self, now: float) -> list[TouchFrame]:
        places = self.places(now) + self._rng.normal(0.0, NOISE, self._grip.points.shape)
        world = np.column_stack([places, np.zeros(len(places))])
        xy = self._surface.to_surface(world).tolist()
        contacts = tuple(
            Contact(int(i), *at)
            for i, at, down in zip(self._ids, xy, self._down, strict=True)
            if now >= down - 1e-9
        )
        return [TouchFrame(now, contacts)]


def share(part: float) -> float:
    """Share of a smooth movement's way after a part of its time."""
    s = min(max(part, 0.0), 1.0)
    return s * s * (3.0 - 2.0 * s)


def trial(job: Job) -> Outcome:
    """Plays one trial."""
    devices: list[Touching] = []

    def make(task: Task, surface: Surface) -> Touching:
        assert isinstance(task, OneThing)
        devices.append(Touching(task, surface, 0.001 * job.distance))
        return devices[-1]

    kind = THINGS[job.thing]
    settings = RunSettings(
        task=f"{kind.__module__}:{kind.__name__}",
        seed=seed_of(job.turn, job.fingers, job.number),
        labels="population",
        rules=job.rules,
    )
    session = build(settings, (make,))
    try:
        return _watched(session, devices[0])
    finally:
        session.close()


class DrawnSteps:
    """Steps of the drawn fingertips along the surface, while a hand comes down or is down.

    Attributes:
        largest: m, the largest step of a fingertip in one control period beyond that of its touch.
    """

    def __init__(self) -> None:
        self._tips = Kinematics(ADULT).tips
        self._before: tuple[Array, dict[int, Array]] | None = None
        self.largest = 0.0

    def __call__(self, hand: HandView) -> None:
        """Looks at the next picture of the hand."""
        before, self._before = self._before, None
        if hand.phase not in ("coming down", "down"):
            return
        drawn = self._tips(hand.target)
        touches = {c.label: c.position for c in hand.contacts if c.label is not None}
        self._before = drawn, touches
        for finger, place in touches.items():
            if before is not None and finger in before[1]:
                tip, touch = (drawn - before[0])[finger], place - before[1][finger]
                further = np.linalg.norm(tip[:2]) - np.linalg.norm(touch[:2])
                self.largest = max(self.largest, float(further))


def _watched(session: Session, device: Touching) -> Outcome:
    begin, _ = session.scene.object_pose(session.data, "thing")
    steps, deadline = DrawnSteps(), device.last + SOLID_BY
    moved = 0.0
    after, solid, stayed, notice = np.inf, False, True, ""
    closed = session.scene.object_pose(session.data, "thing")
    while session.time < deadline + HOLD:
        snapshot = session.advance()
        now, hand = snapshot.time, snapshot.hands[0]
        every = len(hand.solid) == len(device.places(now))
        position, rotation = session.scene.object_pose(session.data, "thing")
        if now <= deadline:
            moved = max(moved, float(np.linalg.norm(position - begin)))
            notice = snapshot.notice
            solid = every
            if every and now > device.last:
                after = min(after, now - device.last)
        else:
            stayed &= every
        if now <= deadline + CLOSE + WAIT:
            closed = position, rotation
        steps(hand)
    lag = position[:2] - closed[0][:2] - WAY * device.across
    spin = turned(closed[1], rotation)
    held = stayed and float(np.linalg.norm(lag)) < SLIP and spin < SPIN
    return Outcome(solid, solid and held, moved, steps.largest, after, notice)


def turned(before: Array, after: Array) -> float:
    """degrees between two rotations (3, 3)."""
    cosine = (np.trace(before.T @ after) - 1.0) / 2.0
    return float(np.rad2deg(np.arccos(np.clip(cosine, -1.0, 1.0))))


def cost(steps: int = 4000) -> tuple[float, float, float]:
    """us of a control step with three solid fingers away from all things, by either rules, and the
    median ratio of steps side by side."""
    sessions = []
    for rules in RULES:
        settings = RunSettings(task="box-to-goal", seed=1, labels="population", rules=rules)
        sessions.append(build(settings, (Away,)))
    times: Array = np.empty((steps, len(RULES)))
    for step in range(-100, steps):
        # In turns, so that neither gets the quieter machine.
        for which in (0, 1) if step % 2 else (1, 0):
            begin = time.perf_counter()
            sessions[which].advance()
            if step >= 0:
                times[step, which] = time.perf_counter() - begin
    assert all(len(session.solid(0)) == 3 for session in sessions)
    for session in sessions:
        session.close()
    before, now = 1e6 * np.median(times, axis=0)
    return float(before), float(now), float(np.median(times[:, 1] / times[:, 0]))


class Away(Device):
    """Three fingers that tremble in the corner farthest from the first object.

    Args:
        task: The objects.
        surface: Surface of the touches.
    """

    def __init__(self, task: Task, surface: Surface) -> None:
        at = surface.to_surface(task.objects[0].position)
        size, border = surface.size, np.array([0.04, 0.03])
        corner = np.where(at > size / 2, border, size - border)
        self._places = np.add(corner, [[-0.025, 0.0], [0.020, -0.010], [0.020, 0.010]])
        self._rng = np.random.default_rng(61_013)

    def poll(self, now: float) -> list[TouchFrame]:
        places = self._places + self._rng.normal(0.0, NOISE, self._places.shape)
        return [TouchFrame(now, tuple(Contact(i, *xy) for i, xy in enumerate(places.tolist())))]


def add_row(table: Table, name: str, found: Sequence[Outcome]) -> None:
    """Adds the row of some trials."""
    if not found:
        return
    cells = []
    for won in ([o.solid for o in found], [o.held for o in found]):
        low, high = wilson(sum(won), len(won))
        cells.append(f"{100 * np.mean(won):.0f} [{100 * low:.0f}, {100 * high:.0f}]")
    moved, step = [1000 * o.moved for o in found], [1000 * o.step for o in found]
    after = [o.after for o in found if np.isfinite(o.after)]
    table.add_row(
        name,
        str(len(found)),
        *cells,
        f"{np.percentile(moved, 95):.1f}, {max(moved):.1f}",
        f"{np.percentile(step, 95):.1f}, {max(step):.1f}",
        f"{np.percentile(after, 50):.2f}, {max(after):.2f}" if after else "-",
    )


def main() -> None:
    """Prints the table."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--things", nargs="+", choices=list(THINGS), default=list(THINGS))
    parser.add_argument("--fingers", type=int, nargs="+", choices=FINGERS, default=FINGERS)
    parser.add_argument("--turns", type=int, nargs="+", choices=TURNS, default=TURNS)
    parser.add_argument("--distances", type=float, nargs="+", default=DISTANCES, help="mm")
    parser.add_argument("--each", type=int, default=20, help="trials of every combination")
    parser.add_argument("--first", type=int, default=0, help="number of the first trial")
    parser.add_argument("--rules", type=int, choices=RULES, default=RULES[-1])
    parser.add_argument("--workers", type=int, default=os.cpu_count() or 1)
    parser.add_argument("--files", type=Path, nargs="+", default=[Path("out/near_faces.jsonl")])
    parser.add_argument("--table", action="store_true", help="only print what is there")
    parser.add_argument("--failures", action="store_true", help="list trials that fail")
    parser.add_argument("--cost", action="store_true", help="time control steps instead")
    options = parser.parse_args()
    if options.cost:
        before, now, ratio = cost()
        print(describe_machine())
        print(f"a control step: {before:.0f} us by rules 1, {now:.0f} us by rules 2: {ratio:.3f}")
        return
    # Number by number, so that what is cut short has every combination to the same extent.
    numbers = range(options.first, options.first + options.each)
    jobs = [
        Job(thing, fingers, turn, distance, number, options.rules)
        for number, thing, fingers, turn, distance in product(
            numbers, options.things, options.fingers, options.turns, options.distances
        )
    ]
    wanted = {job[:4] for job in jobs}
    kept = KeptTrials(Job, Outcome, options.files)
    if not options.table:
        kept.play(trial, jobs, options.workers)
    done = [(j, o) for j, o in kept.done.items() if j[:4] in wanted and j.rules == options.rules]
    table = Table(
        "touches",
        "trials",
        "solid in time, %",
        "and held, %",
        "thing moved, mm: 95 %, most",
        "step of a tip, mm: 95 %, most",
        "solid after, s: median, most",
    )
    for distance in options.distances:
        add_row(table, f"{distance:g} mm away", [o for j, o in done if j.distance == distance])
    for turn in options.turns:
        add_row(table, f"turned {turn} degrees", [o for j, o in done if j.turn == turn])
    for fingers in options.fingers:
        add_row(table, f"{fingers} fingers", [o for j, o in done if j.fingers == fingers])
    for thing in options.things:
        add_row(table, thing, [o for j, o in done if j.thing == thing])
    add_row(table, "all", [o for _, o in done])
    Console(width=150).print(table)
    if options.failures:
        for job, outcome in done:
            if not outcome.held:
                print(tuple(job), outcome)


if __name__ == "__main__":
    main()
