"""A simulated person who brings objects to their goals with a hand in the air.

The steps are: move the hand above an object, then around it, pinch, lift, carry, lower, open, look
again. The person sees only the drawn fingertips and the objects, as the screen showed them a
reaction time ago. They correct errors of the drawn hand by moving their own hand. `Hold` is the
block of an object that the fingers pinch. The functions at the end compute holds, and the movements
that bring an object to its goal.
"""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass, replace
from enum import Enum, auto
from math import cos, sin

import numpy as np

from models.arithmetic import Array, length, small_product, squared_lengths, total
from models.errors import InputError
from models.objects import Box, SceneObject, Tray, Wrench
from sandbox.devices.simulated.air_hand import (
    AXIS,
    PINCHING,
    STRETCHED,
    Body,
    HandMovement,
    Pinch,
)
from tasks.simulated_user.view import Eye
from tasks.task import Goal, flat_yaw
from tasks.user import SeenObject, Sight, UserConfiguration

_ASIDE = 0.025
"""An object has slipped if it is farther than this (m) from the line between drawn thumb and
fingers."""
_MOST_BENT = 0.03
"""Largest shift (m) of a tip from its usual position in a pinch, along each axis."""
_ROOM, _ROOM_WEIGHT = 0.018, 40.0
"""Desired clearance (m) of a fingertip from other objects, and cost (rad of rotation) of each m by
which the clearance is smaller."""


@dataclass(frozen=True)
class AirHabits:
    """Parameters of the way a person works with a hand in the air.

    Attributes:
        over: m, height of the tips above objects while the open hand moves.
        opening: m, gap on each side between the open hand and the object to be held.
        squeeze: m, distance by which each side closes beyond the object's faces.
        grip: m, height of the tips above the centre of an object that is lifted.
        clear: m, height of the tips above the table for an object that is not lifted. It is small:
            fingers that push a flat object near its upper side slide over it.
        lift: m, height above all surrounding objects at which an object is carried.
        good: m, error of the drawn tips that the user accepts before closing.
        placed, straight: m and rad, error of a carried object at which it is lowered.
        press: m, distance by which an object is lowered below its goal.
        looks: Number of corrections after which the user continues in any case.
        attempts: Number of grasps before the user gives up.
        share: Share of an error that one correction removes.
        follows, stuck: The drawn hand counts as blocked if more than the share `follows` of an
            error remains after a correction, and the error is above `stuck` (m) before and after.
        settle: s, time for which the user watches the effect of a movement, after the reaction
            time. The user judges by the mean position of the fingertips during this time.
    """

    over: float = 0.035
    opening: float = 0.012
    squeeze: float = 0.008
    grip: float = 0.004
    clear: float = 0.002
    lift: float = 0.020
    good: float = 0.005
    placed: float = 0.004
    straight: float = float(np.deg2rad(5.0))
    press: float = 0.002
    looks: int = 7
    attempts: int = 10
    share: float = 0.8
    follows: float = 0.8
    stuck: float = 0.012
    settle: float = 0.12


class Stage(Enum):
    """Last completed step of a person in the air."""

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
        configuration: Reaction time, speed and tremor.
        seed: Seed of the person's hand and of all random numbers.
        radius: (5,) m, radii of the drawn fingertips.
        home: (2,) m in the world, as seen from the person's seat: resting position of the hand. Of
            two handles, the person takes the one nearer to this position.

    Attributes:
        grasps: Number of grasps so far.
    """

    def __init__(
        self,
        configuration: UserConfiguration,
        seed: int,
        radius: Array,
        home: tuple[float, float] = (0.0, 0.0),
    ) -> None:
        rng = np.random.default_rng([seed, 7_011])
        self.body = Body(seed)
        self.habits = AirHabits()
        self._eye = Eye(float(rng.uniform(*configuration.reaction)))
        self._lately: deque[Sight] = deque()
        self._home = np.array(home)
        start = Pinch(np.array([home[0], home[1] - 0.03, 0.10]), 0.0, 0.09, np.zeros((3, 3)))
        self._movement = HandMovement(start, configuration, rng)
        self._radius = radius
        self._stage, self._until = Stage.LOOKING, 0.6
        self._name: str | None = None
        self._tries = self.grasps = 0
        self._kind, self._rng = configuration.kind, rng
        self._held = self._stood = self._gap = self._off = 0.0
        self._bent = start.bent
        # Offset of the own pinch from the target position of the drawn pinch.
        self._offset = np.zeros(3)

    @property
    def carrying(self) -> bool:
        """True while an object is lifted and carried."""
        return self._stage is Stage.LIFTED

    def observe(self, sight: Sight) -> None:
        """Stores the snapshot that is on the screen now."""
        self._eye.observe(sight)
        self._lately.append(sight)

    def hand(self, now: float) -> tuple[Array, Array, Array]:
        """Returns the own hand's palm centre (3,) m and rotation (3, 3) in the world, and joints
        (5, 4, 3) m in palm coordinates, at the time `now`."""
        sight = self._eye.at(now)
        if sight is not None and now >= self._until - 1e-9 and self._kind != "idle":
            self._anywhere(now) if self._kind == "random" else self._act(self._watched(sight), now)
        return self.body.joints(self._movement.at(now))

    def _watched(self, sight: Sight) -> Sight:
        """Returns a sight with the mean positions of the fingertips over the last `settle` seconds.

        A single picture of a trembling hand would be too noisy.
        """
        seen = self._lately
        while seen[0].time < sight.time - self.habits.settle:
            seen.popleft()
        watched = [s.tips for s in seen if s.time <= sight.time]
        tips = {f: np.mean([t[f] for t in watched], axis=0) for f in sight.tips}
        return replace(sight, tips=tips)

    def _act(self, sight: Sight, now: float) -> None:
        act = {
            Stage.LOOKING: self._choose,
            Stage.ABOVE: self._above,
            Stage.AROUND: self._around,
            Stage.CLOSED: self._lift,
            Stage.LIFTED: self._carry,
            Stage.LOWERED: self._lower,
            Stage.OPENED: self._leave,
            Stage.CONTENT: lambda *_: None,
        }
        act[self._stage](sight, now)

    def _anywhere(self, now: float) -> None:
        """Moves, opens and closes the hand at random: the control condition of user `random`."""
        low, high = (-0.10, -0.08, 0.01), (0.10, 0.08, 0.10)
        centre = self._rng.uniform(low, high) + np.append(self._home, 0.0)
        yaw, gap = self._rng.uniform((-0.8, 0.02), (0.8, 0.09)).tolist()
        self._go(Pinch(centre, yaw, gap, np.zeros((3, 3))), Stage.LOOKING, now)

    # The next step.

    def _choose(self, sight: Sight, now: float) -> None:
        wrong = [g for g in sight.goals if not at_goal(sight.objects[g.object], g)]
        if sight.done or not wrong or self.grasps >= self.habits.attempts:
            self._until = now + 0.2
            return
        self._name = wrong[0].object
        self.grasps += 1
        self._tries = 0
        hold = self._hold(sight)
        yaw = self._comfortable(hold, sight)
        # The correction of the drawn fingers from earlier grasps is used again.
        bent = self._bent = self._movement.aim.bent
        self._gap = hold.width + 2.0 * self.habits.opening
        over = self._highest(sight) + self.habits.over
        centre = np.array([*hold.position[:2], over]) + self._offset
        self._go(Pinch(centre, yaw, self._centres(self._gap), bent), Stage.ABOVE, now)

    def _above(self, sight: Sight, now: float) -> None:
        hold = self._hold(sight)
        wanted = np.array([*hold.position[:2], self._highest(sight) + self.habits.over])
        if self._correct(sight, wanted, 2.0 * self.habits.good, now):
            return
        self._tries = 0
        aim = self._movement.aim
        z = self._grip(hold, sight)[2] + self._offset[2]
        self._go(replace(aim, centre=np.array([*aim.centre[:2], z])), Stage.AROUND, now)

    def _around(self, sight: Sight, now: float) -> None:
        hold = self._hold(sight)
        wanted = self._grip(hold, sight)
        if self._correct(sight, wanted, self.habits.good, now):
            return
        aim = self._movement.aim
        if self._off > self.habits.stuck:
            # The drawn hand is blocked: raise the hand again, without rotation or opening.
            self._offset = np.zeros(3)
            centre = np.array([*wanted[:2], self._highest(sight) + self.habits.over])
            self._go(replace(aim, centre=centre, bent=self._bent), Stage.LOOKING, now)
            return
        gap = self._centres(hold.width - 2.0 * self.habits.squeeze)
        self._offset = aim.centre - wanted
        self._go(replace(aim, gap=gap), Stage.CLOSED, now, 1.3)

    def _lift(self, sight: Sight, now: float) -> None:
        hold, goal = self._hold(sight), self._goal(sight)
        self._stood, self._held, self._tries = float(hold.position[2]), 0.0, 0
        if stays_down(self._seen_object(sight).shape):
            self._stage = Stage.LIFTED
            self._carry(sight, now)
            return
        top = max(self._highest(sight, others=True), goal.position[2] - hold.half)
        self._held = top + self.habits.lift - (float(hold.position[2]) - hold.half)
        aim = self._movement.aim
        self._go(replace(aim, centre=aim.centre + _up(self._held)), Stage.LIFTED, now, 1.2)

    def _carry(self, sight: Sight, now: float) -> None:
        thing, goal, habits = self._seen_object(sight), self._goal(sight), self.habits
        aim, hold = self._movement.aim, self._hold(sight)
        pinch = aim.centre - self._offset
        if float(hold.position[2]) - self._stood < 0.5 * self._held or self._slipped(hold, sight):
            self._open(now)
            return
        off, turn = remaining_motion(thing, goal)
        near = length(off) < habits.placed and abs(turn) < habits.straight
        if near or self._tries >= habits.looks:
            self._tries, self._stage = 0, Stage.LOWERED
            self._lower(sight, now)
            return
        self._tries += 1
        # The object turns about the pinch, not about its own centre.
        shift, turn = pinch_motion(thing, goal, pinch[:2])
        centre = aim.centre + np.append(shift, 0.0)
        self._go(replace(aim, centre=centre, yaw=aim.yaw + turn), Stage.LIFTED, now, 1.2)

    def _slipped(self, hold: Hold, sight: Sight) -> bool:
        """True if an object moved on the table is no longer between the drawn fingers."""
        if self._held > 0.0:
            return False
        thumb, fingers = _pads(sight)
        gap, way = (fingers - thumb)[:2], (hold.position - thumb)[:2]
        share = float(small_product(way, gap)) / max(float(small_product(gap, gap)), 1e-9)
        aside = length(way - share * gap)
        return not 0.0 < share < 1.0 or aside > _ASIDE

    def _lower(self, sight: Sight, now: float) -> None:
        above = float(self._seen_object(sight).position[2]) - self._goal(sight).position[2]
        if above < 0.003 or self._tries >= self.habits.looks or self._held == 0.0:
            self._open(now)
            return
        self._tries += 1
        aim = self._movement.aim
        centre = aim.centre - _up(above + self.habits.press)
        self._go(replace(aim, centre=centre), Stage.LOWERED, now, 1.2)

    def _open(self, now: float) -> None:
        aim = self._movement.aim
        self._go(replace(aim, gap=self._centres(self._gap)), Stage.OPENED, now, 1.3)

    def _leave(self, sight: Sight, now: float) -> None:
        aim = self._movement.aim
        top = max(self._highest(sight) + self.habits.over, float(aim.centre[2]))
        self._go(replace(aim, centre=np.array([*aim.centre[:2], top + 0.02])), Stage.LOOKING, now)

    # Corrections of the drawn hand.

    def _correct(self, sight: Sight, wanted: Array, good: float, now: float) -> bool:
        """Begins a correction of the drawn tips; False if none is needed or it would not help."""
        aim = self._movement.aim
        rotation = aim.rotation
        ideal = replace(aim, centre=wanted).tips()
        error = small_product(ideal - np.array([sight.tips[f] for f in PINCHING]), rotation)
        before, self._off = self._off, float(np.sqrt(squared_lengths(error)).max())
        # A drawn hand that does not follow is blocked, and further movement does not help.
        stuck = (
            self._tries > 1
            and min(self._off, before) > self.habits.stuck
            and self._off > self.habits.follows * before
        )
        if self._off < good or stuck or self._tries >= self.habits.looks:
            return False
        self._tries += 1
        error *= self.habits.share
        common = (error[0] + error[1:].mean(axis=0)) / 2.0
        bent = np.clip(aim.bent + error - common, -_MOST_BENT, _MOST_BENT)
        centre = aim.centre + small_product(rotation, common)
        self._go(replace(aim, centre=centre, bent=bent), self._stage, now)
        return True

    def _go(self, aim: Pinch, stage: Stage, now: float, slowness: float = 1.0) -> None:
        self._stage = stage
        self._until = self._movement.go(aim, now, slowness) + self._eye.delay + self.habits.settle

    # What the person sees.

    def _seen_object(self, sight: Sight) -> SeenObject:
        assert self._name is not None
        return sight.objects[self._name]

    def _hold(self, sight: Sight) -> Hold:
        return hold_of(self._seen_object(sight), self._home)

    def _grip(self, hold: Hold, sight: Sight) -> Array:
        """Returns the target midpoint (3,) between the tips when they close, m."""
        x, y, z = hold.position.tolist()
        if stays_down(self._seen_object(sight).shape):
            return np.array([x, y, float(self._radius[list(PINCHING)].max()) + self.habits.clear])
        return np.array([x, y, z + self.habits.grip])

    def _goal(self, sight: Sight) -> Goal:
        return next(g for g in sight.goals if g.object == self._name)

    def _highest(self, sight: Sight, others: bool = False) -> float:
        """Returns the top (m) of the highest object; `others` leaves out the held object."""
        seen = [o for name, o in sight.objects.items() if not others or name != self._name]
        return max((hold_of(o, self._home).top for o in seen), default=0.0)

    def _centres(self, width: float) -> float:
        """Returns the distance (m) between the tips' centres for a gap between the finger pads."""
        return width + float(self._radius[0] + self._radius[1:3].mean())

    def _comfortable(self, hold: Hold, sight: Sight) -> float:
        """Returns the yaw (rad) of the hand for a hold.

        This yaw leaves space for the fingers beside other objects, and needs little rotation of the
        hand now and at the goal.
        """
        _, turn = remaining_motion(self._seen_object(sight), self._goal(sight))
        best = (np.inf, 0.0)
        for side in range(0, 4, 1 if hold.quarter else 2):
            hand = (hold.yaw + side * np.pi / 2 - AXIS + np.pi) % (2 * np.pi) - np.pi
            gap = self._centres(hold.width + 2.0 * self.habits.opening)
            tips = Pinch(hold.position, hand, gap, np.zeros((3, 3))).tips()
            tips = np.concatenate([tips, hold.position + self._idle_tips(sight, hand)])
            room = min(
                (
                    float(np.min(o.shape.clearance(tips, o.position, o.rotation)))
                    for name, o in sight.objects.items()
                    if name != self._name
                ),
                default=1.0,
            )
            cost = max(abs(hand), abs(hand + turn)) + _ROOM_WEIGHT * max(_ROOM - room, 0.0)
            best = min(best, (cost, hand))
        return best[1]

    def _idle_tips(self, sight: Sight, yaw: float) -> Array:
        """Returns the tips (2, 3) of ring and little finger, m from the pinch's centre.

        They are those of the drawn hand, rotated to a yaw.
        """
        thumb, fingers = _pads(sight)
        pinch = (thumb + fingers) / 2.0
        turn = replace(self._movement.aim, yaw=yaw - self._movement.aim.yaw).rotation
        return np.array([small_product(turn, sight.tips[f] - pinch) for f in STRETCHED])


def _pads(sight: Sight) -> tuple[Array, Array]:
    """Returns the tip of the drawn thumb and the midpoint of index and middle fingertip, (3,) m."""
    return sight.tips[0], (sight.tips[1] + sight.tips[2]) / 2.0


def _up(height: float) -> Array:
    return np.array([0.0, 0.0, height])


_AHEAD = 0.020
"""Height (m) by which the own end is raised above the other end."""
_UP = 0.6
"""If both ends are above this share of the lift, the tray may be carried to its goal."""
_STEP, _STEP_TURN = 0.025, float(np.deg2rad(8.0))
"""Largest horizontal shift (m) and rotation (rad) before the user looks at the other end again."""
_IN_PLACE, _STRAIGHT, _LEVEL = 0.005, float(np.deg2rad(3.0)), 0.004
"""Tolerances within which an end is not corrected: horizontal (m), rotation (rad), height (m)."""
_GONE = 0.030
"""A handle has slipped if it is farther than this (m) from the drawn fingers."""
_LOOK = 0.10
"""Time (s) between two observations by a waiting user."""
_FELT = 0.35
"""Share of an observed error that is corrected at once; small, since both users correct it."""


class AirCarrier(AirPerson):
    """A simulated person who carries the nearer end of a tray to its goal and holds it there."""

    def _lift(self, sight: Sight, now: float) -> None:
        self._stage = Stage.LIFTED
        self._carry(sight, now)

    def _carry(self, sight: Sight, now: float) -> None:
        thing, goal = self._seen_object(sight), self._goal(sight)
        assert isinstance(thing.shape, Tray)
        aim, hold = self._movement.aim, self._hold(sight)
        if length(hold.position - (aim.centre - self._offset)) > _GONE:
            self._open(now)
            return
        low = thing.shape.handle[2]
        height, other = hold.half_above(low), _far_end(thing, hold).half_above(low)
        top = goal.position[2] - low
        wanted = min(top, other + _AHEAD)
        step = np.zeros(3)
        if abs(wanted - height) > _LEVEL:
            step[2] = wanted - height if height < _UP * top else _FELT * (wanted - height)
        turn = 0.0
        if min(height, other) > _UP * top:
            shift, turn = self._aside(thing, hold, sight)
            step[:2] = shift
        if not step.any() and turn == 0.0:
            self._until = now + _LOOK
            return
        self._go(replace(aim, centre=aim.centre + step, yaw=aim.yaw + turn), Stage.LIFTED, now, 1.2)

    def _aside(self, thing: SeenObject, hold: Hold, sight: Sight) -> tuple[Array, float]:
        """Returns the horizontal shift (2,) m and the rotation (rad) of the own end."""
        goal = self._goal(sight)
        assert isinstance(thing.shape, Tray)
        along = np.array([cos(goal.yaw), sin(goal.yaw)])
        side = np.sign(small_product((hold.position - thing.position)[:2], along))
        place = np.asarray(goal.position[:2]) + side * thing.shape.grip * along
        off = _FELT * (place - hold.position[:2])
        turn = _FELT * float((goal.yaw - thing.yaw + np.pi) % (2 * np.pi) - np.pi)
        steps = max(length(off) / _STEP, abs(turn) / _STEP_TURN, 1.0)
        if length(off) < _FELT * _IN_PLACE:
            off = np.zeros(2)
        return off / steps, turn / steps if abs(turn) > _FELT * _STRAIGHT else 0.0


def _far_end(thing: SeenObject, hold: Hold) -> Hold:
    """Returns the handle at the other end."""
    return replace(hold, position=2.0 * thing.position - hold.position)


_BOLT_TURN = float(np.deg2rad(25.0))
"""Largest rotation (rad) in one movement of an object that turns about a bolt."""
_WRENCH_GRIP = 0.040
"""Distance (m) from the origin, along the handle, at which a wrench of size 1 is held. It is large,
so that the lever is long."""


@dataclass(frozen=True)
class Hold:
    """The block of an object that the fingers pinch.

    Attributes:
        position: (3,) m, centre of the block.
        yaw: rad, direction along which thumb and fingers close on the block.
        width: m, distance between the pinched faces.
        top: m, height of the block's upper side.
        quarter: True if any two opposite faces can be pinched.
    """

    position: Array
    yaw: float
    width: float
    top: float
    quarter: bool

    @property
    def half(self) -> float:
        """Distance (m) from its centre to its upper side."""
        return self.top - float(self.position[2])

    def half_above(self, low: float) -> float:
        """Height (m) of its centre above `low`."""
        return float(self.position[2]) - low


def check_holdable(thing: SceneObject) -> None:
    """Checks that the simulated user in the air can hold an object.

    Raises:
        InputError: The object is not a box, wrench or tray.
    """
    if not isinstance(thing, Box | Wrench | Tray):
        raise InputError(
            "the simulated user in the air cannot hold this object",
            got=thing.name,
            expected="boxes, wrenches and trays",
            remedy="Use --device leap, with your own hand",
        )


def hold_of(seen: SeenObject, near: Array) -> Hold:
    """Returns the hold of an object.

    Args:
        seen: The object.
        near: (2,) m; a tray is held by the handle that is nearer to this point.
    """
    shape, position, yaw = seen.shape, seen.position, flat_yaw(seen.rotation)
    if isinstance(shape, Box):
        half = shape.half_size[2]
        return Hold(position, yaw, 2.0 * shape.half_size[0], float(position[2]) + half, True)
    along = np.array([cos(seen.yaw), sin(seen.yaw), 0.0])
    across = seen.yaw + np.pi / 2
    if isinstance(shape, Tray):
        along = seen.rotation[:, 0]
        ends = [position + side * shape.grip * along for side in (1.0, -1.0)]
        place = min(ends, key=lambda e: length(e[:2] - near))
        _, half_width, half_height = shape.handle
        return Hold(place, across, 2.0 * half_width, float(place[2]) + half_height, False)
    assert isinstance(shape, Wrench)
    out = shape.size * _WRENCH_GRIP if shape.bolt is not None else total(shape.handle) / 2.0
    place = position + out * along
    top = float(place[2]) + shape.thickness / 2.0
    return Hold(place, across, shape.handle_width, top, False)


def remaining_motion(seen: SeenObject, goal: Goal) -> tuple[Array, float]:
    """Returns shift (2,) m and rotation (rad) from an object's pose to its goal."""
    off = np.asarray(goal.position[:2]) - seen.position[:2]
    if isinstance(seen.shape, Box):
        return off, quarter_turn(goal.yaw - flat_yaw(seen.rotation))
    return off, float((goal.yaw - seen.yaw + np.pi) % (2 * np.pi) - np.pi)


def pinch_motion(seen: SeenObject, goal: Goal, pinch: Array) -> tuple[Array, float]:
    """Returns shift (2,) m and rotation (rad) of a pinch that bring the held object to its goal.

    Args:
        seen: The object.
        goal: Its goal.
        pinch: (2,) m, position of the pinch.
    """
    off, turn = remaining_motion(seen, goal)
    pivot, shape = seen.position[:2], seen.shape
    if isinstance(shape, Wrench) and shape.bolt is not None:
        pivot, off = np.array(shape.bolt_place(pivot, seen.yaw)), np.zeros(2)
        turn = float(np.clip(turn, -_BOLT_TURN, _BOLT_TURN))
    arm, (c, s) = pinch - pivot, (cos(turn), sin(turn))
    return off + small_product(np.array([[c, -s], [s, c]]), arm) - arm, turn


def stays_down(shape: SceneObject) -> bool:
    """True if the object is pulled or turned on the table instead of being lifted."""
    return isinstance(shape, Wrench)


def at_goal(seen: SeenObject, goal: Goal) -> bool:
    """True if an object is at its goal, within the precision of the user's sight."""
    off, turn = remaining_motion(seen, goal)
    if isinstance(seen.shape, Wrench):
        near = seen.shape.bolt is not None or length(off) < 0.006
        return near and abs(turn) < np.deg2rad(4.0)
    height = abs(float(seen.position[2]) - goal.position[2])
    if goal.on is not None:
        assert isinstance(seen.shape, Box)
        return bool(length(off) < 0.4 * seen.shape.half_size[0] and height < 0.004)
    return bool(length(off) < 0.008 and height < 0.004 and abs(turn) < np.deg2rad(8.0))


def quarter_turn(angle: float) -> float:
    """Returns the smallest angle (rad) that differs from an angle by whole quarter turns."""
    return float((angle + np.pi / 4) % (np.pi / 2) - np.pi / 4)
