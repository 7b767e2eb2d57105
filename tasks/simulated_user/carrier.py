"""One of two who carry a tray: takes the handle on their side, and watches the other end.

The two do not talk. Each sees the tray on the screen, and so how high the other end is and whether
it comes along; nobody goes far ahead of what the other does.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from models.frames import TouchFrame
from models.objects import Box, Tray
from models.surface import Surface
from tasks.simulated_user.grasp import Grasp
from tasks.simulated_user.handling import BoxHandling
from tasks.simulated_user.lift import Slider
from tasks.simulated_user.user import SkilledUser
from tasks.task import Goal
from tasks.user import SeenObject, Sight, UserConfiguration

Array = NDArray[np.float64]

_AHEAD = 0.020
"""m by which one's own end is raised above the other one."""
_UP = 0.6
"""Of the way up: the share at which an end is up, so that the tray may be carried along."""
_STEP, _STEP_TURN = 0.025, float(np.deg2rad(8.0))
"""m and rad of one movement to the side, after which one looks what the other does."""
_IN_PLACE, _STRAIGHT, _LEVEL = 0.005, float(np.deg2rad(3.0)), 0.004
"""m from its place to the side, rad, and m in height at which an end is left in peace."""
_FALLEN, _BEHIND = 0.014, 0.008
"""m by which an end may lag behind the rising hand, and behind the other end, before it is taken to
have slipped."""
_RESTS = 0.004
"""m above the table, below which a handle is taken to lie on it."""
_ASIDE = 0.030
"""m by which a handle may be beside the fingers before it is taken to have slipped."""
_PATIENCE = 10.0
"""s for which one holds an end and waits for the other, before letting go to look afresh."""
_FOLLOWS = 0.30
"""s that a hand on the screen takes to follow the slider to its end."""
_LOOK = 0.10
"""s between two looks of one who waits."""


class HandleHandling(BoxHandling):
    """A handle is grasped across, with the thumb on the side that is more comfortable."""

    # It has to be held, also where it lies in its place.
    enough = (0.0, 0.0)

    def grasp(
        self, seen: SeenObject, turn: float, c: UserConfiguration, failed: Grasp | None = None
    ) -> Grasp:
        """Thumb on one long side, fingers on the other."""
        assert isinstance(seen.shape, Box)
        length, width, _ = seen.shape.half_size
        sides = [seen.yaw + side for side in (np.pi / 2, -np.pi / 2)]
        axis = min(sides, key=lambda a: abs(_wrapped(a - c.natural_axis)))
        return Grasp(axis, 2 * width, 2 * length)


class Carrier(SkilledUser):
    """Lifts and carries one end of a tray that somebody else holds at the other end.

    Args:
        configuration: What kind of person.
        surface: Their tablet.
        seed: Of everything this person does by chance.
        reach: m by which the hand rises over the slider's whole way.
        home: (2,) m in the world as they see it, the middle of their part of the screen: the handle
            that is nearer to it is theirs.
        patient: They wait for the other end; otherwise they lift and carry whatever the other does.
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
        """What the fingers do on the screen, and where the slider is, now, s."""
        return replace(super().touch(now), lift=self._slider.control(now))

    def _act(self, sight: Sight, now: float) -> None:
        goal = sight.goals[0]
        tray = sight.objects[goal.object]
        assert isinstance(tray.shape, Tray)
        if not self._side:
            ends = {side: _end(tray, side).position[:2] for side in (1, -1)}
            self._side = min(ends, key=lambda s: float(np.linalg.norm(ends[s] - self._home)))
        mine = _end(tray, self._side)
        self._other = _height(_end(tray, -self._side))
        c, s = np.cos(goal.yaw), np.sin(goal.yaw)
        x, y, z = np.asarray(goal.position) + self._side * tray.shape.grip * np.array([c, s, 0.0])
        end_goal = Goal(goal.object, (float(x), float(y), float(z)), goal.yaw)
        super()._act(replace(sight, objects={goal.object: mine}, goals=(end_goal,)), now)

    def _missing(self, sight: Sight, box: SeenObject) -> tuple[Array, float]:
        """Shift (2,) and turn of the own handle."""
        goal = sight.goals[0]
        return np.asarray(goal.position[:2]) - box.position[:2], _wrapped(goal.yaw - box.yaw)

    def _reach(self, sight: Sight, box: SeenObject, now: float) -> None:
        """Brings the slider to its end, and then the fingers down around the handle."""
        if self._slider.height(now) > _RESTS:
            self._wait(self._slider.move(0.0, now) - now + _FOLLOWS, now)
            return
        self._waiting, self._leaving = None, False
        super()._reach(sight, box, now)

    def _drag(self, sight: Sight, box: SeenObject, now: float) -> None:
        """Raises the own end and carries it along, as far as the other end allows."""
        assert self._grasp is not None
        slid = self._slider.height(now)
        height, top = _height(box), sight.goals[0].position[2] - _half(box)
        held = self._grasp.middle(box) + self._drawn_offset(sight, now)
        aside = float(np.linalg.norm(held - self._middle(now)))
        lags = slid - height > _FALLEN
        # An end that lies still while the other one rises has slipped; one whose hand does not rise
        # at all has not: two who share a lift control wait for each other.
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
            steps = max(float(np.linalg.norm(off)) / _STEP, abs(turn) / _STEP_TURN, 1.0)
            near, straight = _IN_PLACE, _STRAIGHT
            if np.linalg.norm(off) > near or abs(turn) > straight:
                pivot = np.array(box.position[:2])
                arrivals.append(self._fingers.carry(off / steps, turn / steps, pivot, now))
        elif self._waiting is None:
            self._waiting = now
        if arrivals:
            self._watch(max(arrivals))
        else:
            self._wait(_LOOK, now)

    def _tired(self, now: float) -> bool:
        """Whether the other end has been waited for long enough."""
        return self._waiting is not None and now - self._waiting > _PATIENCE

    def _let_go(self, now: float) -> None:
        """Lowers what is held, and then lets go of it."""
        if not self._leaving and self._slider.height(now) > _RESTS:
            self._leaving = True
            self._wait(self._slider.move(0.0, now) - now + _FOLLOWS, now)
            return
        super()._let_go(now)


def _end(tray: SeenObject, side: int) -> SeenObject:
    """A handle of a tray by itself: that in the direction of the tray's x axis, or the other."""
    shape = tray.shape
    assert isinstance(shape, Tray)
    place = tray.position + side * shape.grip * tray.rotation[:, 0]
    x, y, z = place.tolist()
    handle = Box("handle", shape.handle, shape.mass / 2, (x, y, z))
    return SeenObject(handle, place, tray.rotation)


def _half(end: SeenObject) -> float:
    """m, half the height of a handle."""
    assert isinstance(end.shape, Box)
    return end.shape.half_size[2]


def _height(end: SeenObject) -> float:
    """m by which a handle is above where it lies on the table."""
    return float(end.position[2]) - _half(end)


def _wrapped(angle: float) -> float:
    return float((angle + np.pi) % (2 * np.pi) - np.pi)
