"""Simulated users who stack boxes, on the table or on an upright screen seen from the front.

On the table one hand grasps and carries, and the other hand moves the lift slider. The user takes
the boxes in the order of the goals on the screen. After every release the user looks at all boxes
again, and stacks fallen boxes again.

In front of an upright screen the user knows common facts: a released box falls, a box has to be
lifted over obstacles, and a box on a table can only be gripped from its sides. The user does not
see depth.
"""

from __future__ import annotations

from dataclasses import replace
from enum import Enum, auto
from math import cos, sin

import numpy as np

from models.arithmetic import Array, length
from models.frames import TouchFrame
from models.objects import Box
from models.surface import Surface
from tasks.simulated_user.grasp import Grasp, Surroundings, grasp_across, roomiest_grasp
from tasks.simulated_user.handling import BoxHandling
from tasks.simulated_user.user import SkilledUser, Slider
from tasks.simulated_user.user_hand import Hand
from tasks.task import Goal, flat_yaw
from tasks.user import SeenObject, Sight, UserConfiguration

_OVER, _HARDLY_OVER = 0.014, 0.006
"""Heights (m) above all other objects: the height at which a box is carried, and the height below
which it is raised again."""
_IN_PLACE = 0.004
"""Horizontal distance (m) from its goal within which a carried box is lowered."""
_STRAIGHT = float(np.deg2rad(8.0))
"""Acceptable rotation (rad) relative to the box below."""
_RESTS = 0.004
"""A box counts as standing if it is less than this height (m) above its place."""
_PRESS = 0.002
"""Depth (m) below its place to which a box is lowered, for safety."""
_FALLEN = 0.010
"""Height (m) by which a box may lag behind the rising hand before it counts as slipped."""
_DRAGS = 7
"""Number of corrections above the box's place before the user lowers the box anyway."""
_ENOUGH = 0.2
"""Distance from the goal, as a share of the box's edge, within which a standing box stays."""
_FOLLOWS = 0.30
"""Time (s) in which the simulated hand follows the slider to its end."""


class _Stage(Enum):
    """The user's current action with a grasped box."""

    GRASPED = auto()
    RAISED = auto()
    OVER = auto()


class StackHandling(BoxHandling):
    """Handling of a box on the table with neighbours."""

    good = (_IN_PLACE, _STRAIGHT)
    enough = (0.0, 0.0)
    patience = 8

    def __init__(self, surface: Surface) -> None:
        self.around = Surroundings(surface)

    def grasp(
        self, seen: SeenObject, turn: float, hand: Hand, failed: Grasp | None = None
    ) -> Grasp:
        """Grasp across the faces with the best compromise between room and comfort."""
        return roomiest_grasp(seen, turn, hand, self.around, failed)


class Stacker(SkilledUser):
    """Puts boxes on each other with touches and a slider.

    Args:
        configuration: Settings of the simulated user.
        surface: The tablet.
        seed: Seed of the user's randomness.
        reach: Height (m) by which the hand rises over the slider's full travel.

    Attributes:
        slider: The lift control, which the other hand moves.
    """

    def __init__(
        self, configuration: UserConfiguration, surface: Surface, seed: int, reach: float
    ) -> None:
        super().__init__(configuration, surface, seed)
        self.slider = Slider(reach, np.random.default_rng([seed, 7_005]))
        self._boxes = StackHandling(surface)
        self._handling = self._boxes
        self._name: str | None = None
        self._stage = _Stage.GRASPED
        self._from = self._stood = self._lowest = 0.0

    def touch(self, now: float) -> TouchFrame:
        """Touches of the fingers and position of the slider at the time `now` (s)."""
        frame = super().touch(now)
        return TouchFrame(now, frame.contacts, self.slider.control(now), source=frame.source)

    def _act(self, sight: Sight, now: float) -> None:
        # A cube is gripped and turned in the same way on any of its faces.
        seen = {name: _upright(o) for name, o in sight.objects.items()}
        if not self.grasping:
            wrong = [g.object for g in sight.goals if not _stands(sight.objects[g.object], g)]
            if not wrong or sight.done:
                self._wait(0.1, now)
                return
            if wrong[0] != self._name:
                self._name, self._grasps = wrong[0], 0
        goal = next(g for g in sight.goals if g.object == self._name)
        self._boxes.around = replace(
            self._boxes.around,
            neighbours=tuple(o for name, o in seen.items() if name != self._name),
            goal=np.asarray(goal.position[:2]),
        )
        self._lowest = _lowest(sight.objects[goal.object])
        super()._act(replace(sight, objects=seen, goals=(goal,)), now)

    def _reach(self, sight: Sight, box: SeenObject, now: float) -> None:
        """Moves the slider to the height of the box, then puts the fingers down around it."""
        height = _bottom(box) if _bottom(box) > _RESTS else 0.0
        if abs(height - self.slider.height(now)) > _RESTS:
            self._wait(self.slider.move(height, now) - now + _FOLLOWS, now)
            return
        self._stage = _Stage.GRASPED
        super()._reach(sight, box, now)

    def _drag(self, sight: Sight, box: SeenObject, now: float) -> None:
        """Raises the box over all others, carries it over its place, and lowers it until it rests.

        Every look is followed by one movement. A box that does not follow, or a hand that turns
        into a ghost, ends the drag.
        """
        rise = self.slider.height(now) - self._from
        lost = self._stage is not _Stage.GRASPED and _bottom(box) - self._stood < rise - _FALLEN
        if lost or not sight.solid:
            self._let_go(now)
        elif self._stage is _Stage.GRASPED:
            self._raise(box, now)
        elif self._stage is _Stage.RAISED:
            self._carry(sight, box, now)
        else:
            self._lower(sight.goals[0], box, now)

    def _raise(self, box: SeenObject, now: float) -> None:
        self._from, self._stood = self.slider.height(now), _bottom(box)
        self._stage = _Stage.RAISED
        self._slide(self._from + max(self._highest() + _OVER - self._stood, 0.0), now)

    def _highest(self) -> float:
        """Height (m) of the highest other object."""
        return max((_top(other) for other in self._boxes.around.neighbours), default=0.0)

    def _carry(self, sight: Sight, box: SeenObject, now: float) -> None:
        low = self._highest() + _HARDLY_OVER - self._lowest
        if low > 0.0 and self._tries < _DRAGS:
            # The box is tilted or has slipped a little. If it were lowered now, it would push the
            # other boxes over.
            self._tries += 1
            self._slide(self.slider.height(now) + low + _OVER - _HARDLY_OVER, now)
            return
        off, turn = self._missing(sight, box)
        near = length(off) < _IN_PLACE and abs(turn) < _STRAIGHT
        if near or self._tries >= _DRAGS:
            self._tries = 0
            self._stage = _Stage.OVER
            self._lower(sight.goals[0], box, now)
            return
        self._tries += 1
        self._watch(self._fingers.carry(off, turn, self._boxes.pivot(box), now))

    def _lower(self, goal: Goal, box: SeenObject, now: float) -> None:
        above = float(box.position[2]) - goal.position[2]
        if above < _RESTS or self._tries >= _DRAGS:
            self._let_go(now)
            return
        self._tries += 1
        self._slide(self.slider.height(now) - above - _PRESS, now)

    def _slide(self, height: float, now: float) -> None:
        """Moves the slider, and acts again once its effect is visible."""
        self._watch(self.slider.move(height, now) + _FOLLOWS)


def _stands(seen: SeenObject, goal: Goal) -> bool:
    """True if a box stands in its place, as far as the user sees."""
    off = seen.position - np.asarray(goal.position)
    near = length(off[:2]) < _ENOUGH * 2 * _half(seen)
    return near and abs(float(off[2])) < _RESTS and seen.upright


def _upright(seen: SeenObject) -> SeenObject:
    """The box described as standing on its current lower face."""
    yaw = flat_yaw(seen.rotation)
    c, s = cos(yaw), sin(yaw)
    return replace(seen, rotation=np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]]))


def _half(seen: SeenObject) -> float:
    """Half the edge (m) of a cube."""
    assert isinstance(seen.shape, Box)
    return seen.shape.half_size[2]


def _bottom(seen: SeenObject) -> float:
    return float(seen.position[2]) - _half(seen)


def _lowest(seen: SeenObject) -> float:
    """Height (m) of the lowest corner of a box in any rotation."""
    return float(seen.position[2] - np.abs(seen.rotation[2]).sum() * _half(seen))


def _top(seen: SeenObject) -> float:
    return float(seen.position[2]) + _half(seen)


_QUARTER = np.pi / 2
_OVER_PLACE = 0.012
"""Height (m) above its place at which a box is carried."""
_ASIDE = 0.005
"""Sideways distance (m) from its place within which a box is lowered."""
_DOWN = 0.002
"""Height (m) above its place at which the user lets go of a box, which stands or falls a negligible
distance."""
_SLIPPED = 0.015
"""Distance (m) by which a box may lag behind the fingers before it counts as slipped."""
_MOVES = 14
"""Largest number of movements in one grasp; then the user lets go and grasps again."""
_OPEN = 0.010
"""Distance (m) by which each finger moves sideways off a box before it lifts. Without it, the
fingers that lift last would push the box."""


class FrontBoxHandling(BoxHandling):
    """Handling of a box that is gripped from its left and right side."""

    enough = (0.006, float(np.deg2rad(2.0)))

    def grasp(
        self, seen: SeenObject, turn: float, hand: Hand, failed: Grasp | None = None
    ) -> Grasp:
        """Grasp with the thumb to the left and the fingers to the right."""
        assert isinstance(seen.shape, Box)
        edge = 2 * seen.shape.half_size[0]
        return grasp_across(roll(seen), edge, edge, hand)


class FrontStacker(SkilledUser):
    """Puts a box on another one in the upright plane of the screen.

    Args:
        configuration: Settings of the simulated user.
        surface: The screen as the user sees it: lying flat (see `FrontView`).
        seed: Seed of the user's randomness.
    """

    def __init__(self, configuration: UserConfiguration, surface: Surface, seed: int) -> None:
        super().__init__(configuration, surface, seed)
        self._handling = FrontBoxHandling()
        self._opening = False

    def _act(self, sight: Sight, now: float) -> None:
        if self._opening:
            self._opening = False
            super()._let_go(now)
            return
        seen = {name: in_picture(o) for name, o in sight.objects.items()}
        super()._act(replace(sight, objects=seen), now)

    def _missing(self, sight: Sight, box: SeenObject) -> tuple[Array, float]:
        """Remaining shift (2,) m and turn (rad) from the box as seen to its place, where it stands
        straight."""
        return np.asarray(sight.goals[0].position[:2]) - box.position[:2], -roll(box)

    def _drag(self, sight: Sight, box: SeenObject, now: float) -> None:
        """Moves the box up, across or down, depending on its position."""
        assert self._grasp is not None
        off, turn = self._missing(sight, box)
        held = self._grasp.middle(box) + self._drawn_offset(sight)
        slipped = self._tries > 0 and length(held - self._middle(now)) > _SLIPPED
        there = abs(off[0]) < _ASIDE and abs(off[1]) < _DOWN
        if there or slipped or self._tries >= _MOVES or not sight.solid:
            self._let_go(now)
            return
        self._tries += 1
        shift = off
        if abs(off[0]) > _ASIDE:
            rise = off[1] + _OVER_PLACE
            # The box moves up first and then across, which also covers the rest of the rise.
            shift = np.array([0.0 if rise > 0.5 * _OVER_PLACE else off[0], rise])
        self._watch(self._fingers.carry(shift, turn, self._middle(now), now))

    def _let_go(self, now: float) -> None:
        """Opens the fingers, and lifts them once they are open."""
        places = self._fingers.places(now)
        aside = np.sign(places[:, :1] - self._middle(now)[0]) * [1.0, 0.0]
        self._until = self._fingers.move(places + _OPEN * aside, now)
        self._opening = True


def in_picture(seen: SeenObject) -> SeenObject:
    """A box as seen from the front, with its rotation in the picture only."""
    turn = flat_yaw(seen.rotation)
    c, s = cos(turn), sin(turn)
    return replace(seen, rotation=np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]]))


def roll(seen: SeenObject) -> float:
    """Signed least rotation (rad) in the picture from a pose in which the box stands on a face."""
    return float((seen.yaw + _QUARTER / 2) % _QUARTER - _QUARTER / 2)
