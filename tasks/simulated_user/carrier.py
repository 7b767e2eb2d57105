"""Simulated user who carries one end of a tray: takes the handle on their side, and watches the
other end.

The two users do not communicate. Each sees on the screen how high the other end of the tray is and
whether it follows, and does not move far ahead of it.
"""

from __future__ import annotations

from dataclasses import replace
from math import cos, sin

import numpy as np

from models.arithmetic import Array, length
from models.frames import TouchFrame
from models.objects import Box, Tray
from models.surface import Surface
from tasks.simulated_user.grasp import Grasp, grasp_across, wrapped
from tasks.simulated_user.handling import BoxHandling
from tasks.simulated_user.user import SkilledUser, Slider
from tasks.simulated_user.user_hand import Hand
from tasks.task import Goal
from tasks.user import SeenObject, Sight, UserConfiguration

_AHEAD = 0.020
"""Height (m) by which a user raises their own end above the other end."""
_UP = 0.6
"""A tray is carried along only if its ends are above this share of the goal's height."""
_STEP, _STEP_TURN = 0.025, float(np.deg2rad(8.0))
"""Largest shift (m) and turn (rad) before the user looks at the other end again."""
_IN_PLACE, _STRAIGHT, _LEVEL = 0.005, float(np.deg2rad(3.0)), 0.004
"""Errors in position (m), turn (rad) and height (m) below which the user leaves an end as it is."""
_FALLEN, _BEHIND = 0.014, 0.008
"""Heights (m). An end counts as slipped if it lags behind the rising hand by more than the first
height, and behind the other end by more than the second."""
_RESTS = 0.004
"""A handle counts as lying on the table if it is less than this height (m) above its place."""
_ASIDE = 0.030
"""A handle counts as slipped if its horizontal distance (m) from the fingers is larger."""
_PATIENCE = 10.0
"""Time (s) for which the user holds an end and waits for the other end, before letting go."""
_FOLLOWS = 0.30
"""Time (s) in which the simulated hand follows the slider to its end."""
_LOOK = 0.10
"""Interval (s) between two looks at the screen while waiting."""


class HandleHandling(BoxHandling):
    """Handling of a tray's handle: grasped across, with the thumb on the more comfortable side."""

    # The handle has to be held even if it is at its goal.
    enough = (0.0, 0.0)

    def grasp(
        self, seen: SeenObject, turn: float, hand: Hand, failed: Grasp | None = None
    ) -> Grasp:
        """Grasp with the thumb on one long side and the fingers on the other."""
        assert isinstance(seen.shape, Box)
        length, width, _ = seen.shape.half_size
        sides = [seen.yaw + side for side in (np.pi / 2, -np.pi / 2)]
        axis = min(sides, key=lambda a: abs(wrapped(a - hand.natural_axis)))
        return grasp_across(axis, 2 * width, 2 * length, hand)


class Carrier(SkilledUser):
    """Lifts and carries one end of a tray whose other end another user holds.

    Args:
        configuration: Settings of the simulated user.
        surface: The user's tablet.
        seed: Seed of the user's randomness.
        reach: Height (m) by which the hand rises over the slider's full travel.
        home: (2,) m, the middle of the user's part of the screen, in the world as the user sees it.
            The user takes the handle that is nearer to `home`. None: the middle of `surface`.
        patient: True waits for the other end; False lifts and carries without waiting.
    """

    def __init__(
        self,
        configuration: UserConfiguration,
        surface: Surface,
        seed: int,
        reach: float,
        home: Array | None = None,
        patient: bool = True,
    ) -> None:
        super().__init__(configuration, surface, seed)
        self._slider = Slider(reach, np.random.default_rng([seed, 7_008]))
        self._handling = HandleHandling()
        self._home = surface.to_world(surface.size / 2)[:2] if home is None else home
        self.patient = patient
        self._side = 0
        self._other = 0.0
        self._waiting: float | None = None
        self._leaving = False

    def touch(self, now: float) -> TouchFrame:
        """Touches of the fingers and position of the slider at the time `now` (s)."""
        return replace(super().touch(now), lift=self._slider.control(now))

    def _act(self, sight: Sight, now: float) -> None:
        goal = sight.goals[0]
        tray = sight.objects[goal.object]
        assert isinstance(tray.shape, Tray)
        if not self._side:
            ends = {side: _end(tray, side).position[:2] for side in (1, -1)}
            self._side = min(ends, key=lambda s: length(ends[s] - self._home))
        mine = _end(tray, self._side)
        self._other = _height(_end(tray, -self._side))
        c, s = cos(goal.yaw), sin(goal.yaw)
        x, y, z = np.asarray(goal.position) + self._side * tray.shape.grip * np.array([c, s, 0.0])
        end_goal = Goal(goal.object, (float(x), float(y), float(z)), goal.yaw)
        super()._act(replace(sight, objects={goal.object: mine}, goals=(end_goal,)), now)

    def _missing(self, sight: Sight, box: SeenObject) -> tuple[Array, float]:
        """Remaining shift (2,) m and turn (rad) of the user's handle to its goal."""
        goal = sight.goals[0]
        return np.asarray(goal.position[:2]) - box.position[:2], wrapped(goal.yaw - box.yaw)

    def _reach(self, sight: Sight, box: SeenObject, now: float) -> None:
        """Moves the slider to its end, then puts the fingers down around the handle."""
        if self._slider.height(now) > _RESTS:
            self._wait(self._slider.move(0.0, now) - now + _FOLLOWS, now)
            return
        self._waiting, self._leaving = None, False
        super()._reach(sight, box, now)

    def _drag(self, sight: Sight, box: SeenObject, now: float) -> None:
        """Raises the user's end and carries it along, as far as the other end allows."""
        assert self._grasp is not None
        slid = self._slider.height(now)
        height, top = _height(box), sight.goals[0].position[2] - _half(box)
        held = self._grasp.middle(box) + self._drawn_offset(sight)
        aside = length(held - self._middle(now))
        lags = slid - height > _FALLEN
        # An end that does not rise while the other end rises has slipped. It has not slipped if its
        # hand does not rise either: two users who share a lift control wait for each other.
        slipped = lags and self._other - height > _BEHIND
        lost = slipped or aside > _ASIDE or not sight.solid
        if self._leaving or lost or self._tired(now):
            self._let_go(now)
            return
        wanted = min(top, self._other + _AHEAD) if self.patient else top
        arrivals = []
        if abs(wanted - height) > _LEVEL and (wanted < height or not lags):
            arrivals.append(self._slider.move(slid + wanted - height, now) + _FOLLOWS)
        up = min(height, self._other) if self.patient else height
        if up > _UP * top:
            self._waiting = None
            off, turn = self._missing(sight, box)
            steps = max(length(off) / _STEP, abs(turn) / _STEP_TURN, 1.0)
            near, straight = _IN_PLACE, _STRAIGHT
            if length(off) > near or abs(turn) > straight:
                pivot = np.array(box.position[:2])
                arrivals.append(self._fingers.carry(off / steps, turn / steps, pivot, now))
        elif self._waiting is None:
            self._waiting = now
        if arrivals:
            self._watch(max(arrivals))
        else:
            self._wait(_LOOK, now)

    def _tired(self, now: float) -> bool:
        """True once the user has waited long enough for the other end."""
        return self._waiting is not None and now - self._waiting > _PATIENCE

    def _let_go(self, now: float) -> None:
        """Lowers the handle and then lets go of it."""
        if not self._leaving and self._slider.height(now) > _RESTS:
            self._leaving = True
            self._wait(self._slider.move(0.0, now) - now + _FOLLOWS, now)
            return
        super()._let_go(now)


def _end(tray: SeenObject, side: int) -> SeenObject:
    """One handle of a tray as an object: the handle on the side of the tray's x axis, or the
    opposite one."""
    shape = tray.shape
    assert isinstance(shape, Tray)
    place = tray.position + side * shape.grip * tray.rotation[:, 0]
    x, y, z = place.tolist()
    handle = Box("handle", shape.handle, shape.mass / 2, (x, y, z))
    return SeenObject(handle, place, tray.rotation)


def _half(end: SeenObject) -> float:
    """Half the height (m) of a handle."""
    assert isinstance(end.shape, Box)
    return end.shape.half_size[2]


def _height(end: SeenObject) -> float:
    """Height (m) of a handle above its place on the table."""
    return float(end.position[2]) - _half(end)
