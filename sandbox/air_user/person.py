"""A person who brings things to their goals with a hand in the air: above, around, pinch, lift,
carry, lower, let go, look again.

They see what the screen shows a reaction time ago, and nothing else: where the drawn fingertips
are, and where things are. What the drawn hand does wrong is corrected by moving the own one.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from enum import Enum, auto

import numpy as np
from numpy.typing import NDArray

from models.objects import Box
from sandbox.air_user.body import AXIS, PINCHING, Body, Pinch
from sandbox.air_user.motion import Motion
from tasks.goals import flat_yaw
from tasks.simulated_user.configuration import UserConfiguration
from tasks.simulated_user.sight import Eye, SeenObject, Sight
from tasks.task import Goal

Array = NDArray[np.float64]

_QUARTER = np.pi / 2


@dataclass(frozen=True)
class AirHabits:
    """What a hand in the air does otherwise than one on a screen. Lengths in m.

    Attributes:
        over: Height of the tips over things while the hand goes about.
        opening: By which each side of the open hand is away from what it is going to hold.
        squeeze: By which each side closes beyond its faces.
        grip: Height of the tips over the middle of what is held.
        lift: Height over everything around at which things are carried.
        good: Error of the drawn tips at which the user is content before closing.
        placed, straight: Error of what is carried, m and rad, at which it is lowered.
        press: By which it is lowered below its place.
        looks: Corrections before the user goes on all the same.
        attempts: Grasps before giving up.
        share: Of an error that one correction takes away.
        settle: s that the user watches what a movement has done, beyond the reaction time.
    """

    over: float = 0.035
    opening: float = 0.012
    squeeze: float = 0.008
    grip: float = 0.004
    lift: float = 0.020
    good: float = 0.005
    placed: float = 0.004
    straight: float = float(np.deg2rad(5.0))
    press: float = 0.002
    looks: int = 7
    attempts: int = 10
    share: float = 0.8
    settle: float = 0.12


class _Stage(Enum):
    LOOKING = auto()
    ABOVE = auto()
    AROUND = auto()
    CLOSED = auto()
    LIFTED = auto()
    LOWERED = auto()
    OPENED = auto()
    CONTENT = auto()


class AirPerson:
    """Brings boxes to their goals, on the table or on each other.

    Args:
        configuration: Reaction, speed, tremor.
        seed: Whose hand, and all that is chance.
        habits: How they work.
        radius: (5,) m, of the drawn fingertips, as they know them by sight.
    """

    def __init__(
        self,
        configuration: UserConfiguration,
        seed: int,
        radius: Array,
        habits: AirHabits | None = None,
    ) -> None:
        rng = np.random.default_rng([seed, 7_011])
        self.body = Body(seed)
        self.habits = habits or AirHabits()
        self._eye = Eye(float(rng.uniform(*configuration.reaction)))
        start = Pinch(np.array([0.0, -0.03, 0.10]), 0.0, 0.09, np.zeros((3, 3)))
        self._motion = Motion(start, configuration, rng)
        self._radius = radius
        self._stage, self._until = _Stage.LOOKING, 0.6
        self._name: str | None = None
        self._tries = self._grasps = 0
        self._idle = configuration.kind == "idle"
        self._held = self._stood = self._gap = 0.0
        # By how much the own pinch is off from where the drawn one is wanted.
        self._offset = np.zeros(3)

    def look(self, sight: Sight) -> None:
        """Takes in what is on the screen now."""
        self._eye.look(sight)

    def hand(self, now: float) -> tuple[Array, Array, Array]:
        """Palm centre (3,), rotation (3, 3) and joints (5, 4, 3) of the own hand now."""
        sight = self._eye.at(now)
        if sight is not None and now >= self._until - 1e-9 and not self._idle:
            self._act(sight, now)
        return self.body.joints(self._motion.at(now))

    def _act(self, sight: Sight, now: float) -> None:
        act = {
            _Stage.LOOKING: self._choose,
            _Stage.ABOVE: self._above,
            _Stage.AROUND: self._around,
            _Stage.CLOSED: self._lift,
            _Stage.LIFTED: self._carry,
            _Stage.LOWERED: self._lower,
            _Stage.OPENED: self._leave,
            _Stage.CONTENT: lambda *_: None,
        }
        act[self._stage](sight, now)

    # What is to be done next.

    def _choose(self, sight: Sight, now: float) -> None:
        wrong = [g for g in sight.goals if not _there(sight.objects[g.object], g)]
        if sight.done or not wrong or self._grasps >= self.habits.attempts:
            self._until = now + 0.2
            return
        self._name = wrong[0].object
        self._grasps += 1
        self._tries = 0
        box = sight.objects[self._name]
        goal = self._goal(sight)
        yaw = self._comfortable(box, goal, sight)
        # The correction of the drawn fingers that was learned stays.
        bent = self._motion.aim.bent
        self._gap = _width(box) + 2.0 * self.habits.opening
        over = max(_top(o) for o in sight.objects.values()) + self.habits.over
        centre = np.array([*box.position[:2], over]) + self._offset
        self._go(Pinch(centre, yaw, self._centres(self._gap), bent), _Stage.ABOVE, now)

    def _above(self, sight: Sight, now: float) -> None:
        box = self._box(sight)
        wanted = np.array([*box.position[:2], self._motion.aim.centre[2] - self._offset[2]])
        if self._correct(sight, wanted, 2.0 * self.habits.good, now):
            return
        self._tries = 0
        aim = self._motion.aim
        z = float(box.position[2]) + self.habits.grip + self._offset[2]
        self._go(replace(aim, centre=np.array([*aim.centre[:2], z])), _Stage.AROUND, now)

    def _around(self, sight: Sight, now: float) -> None:
        box = self._box(sight)
        wanted = box.position + _up(self.habits.grip)
        if self._correct(sight, wanted, self.habits.good, now):
            return
        aim = self._motion.aim
        gap = self._centres(_width(box) - 2.0 * self.habits.squeeze)
        self._offset = aim.centre - wanted
        self._go(replace(aim, gap=gap), _Stage.CLOSED, now, 1.3)

    def _lift(self, sight: Sight, now: float) -> None:
        box = self._box(sight)
        self._stood = float(box.position[2])
        around = [_top(o) for name, o in sight.objects.items() if name != self._name]
        goal = self._goal(sight)
        top = max(max(around, default=0.0), goal.position[2] - _half(box))
        rise = top + self.habits.lift - (float(box.position[2]) - _half(box))
        self._held, self._tries = rise, 0
        aim = self._motion.aim
        self._go(replace(aim, centre=aim.centre + _up(rise)), _Stage.LIFTED, now, 1.2)

    def _carry(self, sight: Sight, now: float) -> None:
        box, goal = self._box(sight), self._goal(sight)
        if float(box.position[2]) - self._stood < 0.5 * self._held:
            self._open(now)
            return
        off = np.asarray(goal.position[:2]) - box.position[:2]
        turn = _quarter(goal.yaw - flat_yaw(box.rotation))
        near = float(np.linalg.norm(off)) < self.habits.placed and abs(turn) < self.habits.straight
        if near or self._tries >= self.habits.looks:
            self._tries, self._stage = 0, _Stage.LOWERED
            self._lower(sight, now)
            return
        self._tries += 1
        aim = self._motion.aim
        # The box turns about the pinch, not about its own middle.
        arm = box.position[:2] - (aim.centre - self._offset)[:2]
        c, s = np.cos(turn), np.sin(turn)
        shift = off + arm - np.array([[c, -s], [s, c]]) @ arm
        centre = aim.centre + np.append(shift, 0.0)
        self._go(replace(aim, centre=centre, yaw=aim.yaw + turn), _Stage.LIFTED, now, 1.2)

    def _lower(self, sight: Sight, now: float) -> None:
        box, goal = self._box(sight), self._goal(sight)
        above = float(box.position[2]) - goal.position[2]
        if above < 0.003 or self._tries >= self.habits.looks:
            self._open(now)
            return
        self._tries += 1
        aim = self._motion.aim
        centre = aim.centre - _up(above + self.habits.press)
        self._go(replace(aim, centre=centre), _Stage.LOWERED, now, 1.2)

    def _open(self, now: float) -> None:
        aim = self._motion.aim
        self._go(replace(aim, gap=self._centres(self._gap)), _Stage.OPENED, now, 1.3)

    def _leave(self, sight: Sight, now: float) -> None:
        aim = self._motion.aim
        top = max(_top(o) for o in sight.objects.values()) + self.habits.over
        centre = np.array([*aim.centre[:2], max(top, float(aim.centre[2])) + 0.02])
        self._go(replace(aim, centre=centre), _Stage.LOOKING, now)

    # How the drawn hand is brought where it is wanted.

    def _correct(self, sight: Sight, wanted: Array, good: float, now: float) -> bool:
        """Begins a correction of the drawn tips; False where none is needed, or helps."""
        aim = self._motion.aim
        rotation = aim.rotation
        ideal = replace(aim, centre=wanted).tips()
        error = (ideal - np.array([sight.tips[f] for f in PINCHING])) @ rotation
        if np.linalg.norm(error, axis=1).max() < good or self._tries >= self.habits.looks:
            return False
        self._tries += 1
        error *= self.habits.share
        common = (error[0] + error[1:].mean(axis=0)) / 2.0
        bent = np.clip(aim.bent + error - common, -0.03, 0.03)
        centre = aim.centre + rotation @ common
        self._go(replace(aim, centre=centre, bent=bent), self._stage, now)
        return True

    def _go(self, aim: Pinch, stage: _Stage, now: float, slowness: float = 1.0) -> None:
        self._stage = stage
        self._until = self._motion.go(aim, now, slowness) + self._eye.delay + self.habits.settle

    # What is seen.

    def _box(self, sight: Sight) -> SeenObject:
        assert self._name is not None
        return sight.objects[self._name]

    def _goal(self, sight: Sight) -> Goal:
        return next(g for g in sight.goals if g.object == self._name)

    def _centres(self, width: float) -> float:
        """m between the tips' centres for pads that are so far apart."""
        return width + float(self._radius[0] + self._radius[1:3].mean())

    def _comfortable(self, box: SeenObject, goal: Goal, sight: Sight) -> float:
        """rad, turn of a hand that closes on two faces; where there is room, and little to turn."""
        yaw = flat_yaw(box.rotation)
        turn = _quarter(goal.yaw - yaw)
        best = (np.inf, 0.0)
        for side in range(4):
            hand = (yaw + side * _QUARTER - AXIS + np.pi) % (2 * np.pi) - np.pi
            gap = self._centres(_width(box) + 2.0 * self.habits.opening)
            tips = Pinch(box.position, hand, gap, np.zeros((3, 3))).tips()
            room = min(
                (
                    float(np.min(o.shape.clearance(tips, o.position, o.rotation)))
                    for name, o in sight.objects.items()
                    if name != self._name
                ),
                default=1.0,
            )
            cost = max(abs(hand), abs(hand + turn)) + 40.0 * max(0.018 - room, 0.0)
            best = min(best, (cost, hand))
        return best[1]


def _there(seen: SeenObject, goal: Goal) -> bool:
    off = seen.position - np.asarray(goal.position)
    turn = abs(_quarter(goal.yaw - flat_yaw(seen.rotation)))
    near = 0.008 if goal.on is None else 0.2 * _width(seen)
    straight = goal.on is not None or turn < np.deg2rad(8.0)
    return bool(np.linalg.norm(off[:2]) < near and abs(off[2]) < 0.004 and straight)


def _up(height: float) -> Array:
    return np.array([0.0, 0.0, height])


def _quarter(angle: float) -> float:
    """rad, the same to a cube, and smallest."""
    return float((angle + _QUARTER / 2) % _QUARTER - _QUARTER / 2)


def _half(seen: SeenObject) -> float:
    assert isinstance(seen.shape, Box)
    return seen.shape.half_size[2]


def _width(seen: SeenObject) -> float:
    assert isinstance(seen.shape, Box)
    return 2.0 * seen.shape.half_size[0]


def _top(seen: SeenObject) -> float:
    return float(seen.position[2]) + _half(seen)
