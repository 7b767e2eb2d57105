"""Simulated user who brings an object to its goal.

The user repeats a cycle until the object is in place: look, reach, adjust, grasp, drag, let go.
"""

from __future__ import annotations

from dataclasses import replace
from enum import Enum, auto
from typing import ClassVar

import numpy as np

from models.arithmetic import Array, length, squared_lengths
from models.frames import TouchFrame
from models.surface import Surface
from tasks.simulated_user.grasp import Grasp
from tasks.simulated_user.handling import Handling, handling_of
from tasks.simulated_user.user_hand import (
    Fingers,
    Hand,
    beyond_border,
    minimum_jerk,
    stopped_at_border,
)
from tasks.simulated_user.view import Eye
from tasks.user import FingersKnown, SeenObject, Sight, UserConfiguration

_IN_PLACE = 0.004
"""Largest error (m) of the fingers' positions at which the user closes the fingers."""
_SLIPPED = 0.015
"""Distance (m) by which the box may lag behind the fingers before it counts as slipped."""
_HARDLY = 0.001
"""Tolerance (m) when grasps are compared by how far they reach beyond the screen's border."""
_BLUR = 0.004
"""Blur (m) of a fingertip on the screen; a person does not notice smaller errors."""
_SETTLE = 0.08
"""Time (s) for which the user watches the effect of a movement, after the reaction time."""


class _Doing(Enum):
    LOOKING = auto()
    ADJUSTING = auto()
    CLOSING = auto()
    DRAGGING = auto()
    LIFTING = auto()
    CONTENT = auto()


class SkilledUser(FingersKnown):
    """Brings one object to its goal with touches only.

    Args:
        configuration: Settings of the simulated user.
        surface: The tablet.
        seed: Seed of the user's randomness.

    Attributes:
        drags: Largest number of movements in one grasp; then the user lets go and grasps again.
    """

    drags: ClassVar[int] = 7

    def __init__(self, configuration: UserConfiguration, surface: Surface, seed: int) -> None:
        self.configuration, self.surface = configuration, surface
        self._rng = np.random.default_rng([seed, 7_001])
        self._eye = Eye(float(self._rng.uniform(*configuration.reaction)))
        self._fingers = Fingers(configuration, self._rng)
        self._hand = Hand.draw(configuration, seed)
        self._doing = _Doing.LOOKING
        self._until = 0.0
        self._grasp: Grasp | None = None
        self._handling: Handling | None = None
        self._failed: Grasp | None = None
        self._grasps = 0
        self._tries = 0

    @property
    def grasping(self) -> bool:
        """True if the fingers are on the screen, or have only just left it."""
        return self._doing not in (_Doing.LOOKING, _Doing.CONTENT)

    def finger_ids(self) -> list[int]:
        """Contact ids of the last touch, in the order thumb, index, and so on."""
        return self._fingers.ids()

    def finger_of(self, contact: int) -> int | None:
        """Finger, thumb 0 to little 4, of a contact id; None if the last touch had no such id."""
        ids = self.finger_ids()
        return ids.index(contact) if contact in ids else None

    def observe(self, sight: Sight) -> None:
        """Shows the user the screen; the user responds after the reaction time."""
        self._eye.observe(sight)

    def touch(self, now: float) -> TouchFrame:
        """Touches on the screen at the time `now` (s)."""
        sight = self._eye.at(now)
        if sight is not None and now >= self._until - 1e-9:
            self._act(sight, now)
        return TouchFrame(now, self._fingers.touches(now, self.surface), source="simulated user")

    def _act(self, sight: Sight, now: float) -> None:
        name = sight.goals[0].object
        box = sight.objects[name]
        self._handling = self._handling or handling_of(box.shape)
        if self._doing is _Doing.LOOKING:
            self._reach(sight, box, now)
        elif self._doing is _Doing.ADJUSTING:
            self._adjust(sight, box, now)
        elif self._doing is _Doing.CLOSING:
            self._begin_drag(sight, box, now)
        elif self._doing is _Doing.DRAGGING:
            self._drag(sight, box, now)
        elif self._doing is _Doing.LIFTING:
            self._doing = _Doing.LOOKING

    def _reach(self, sight: Sight, box: SeenObject, now: float) -> None:
        """Puts the fingers down around the box, with random errors of aim."""
        off, turn = self._missing(sight, box)
        assert self._handling is not None
        near, straight = self._handling.enough
        content = length(off) < near and abs(turn) < straight
        if sight.done or (content and box.upright):
            self._wait(_SETTLE, now)
            return
        c = self.configuration
        if self._grasps >= c.attempts:
            self._doing = _Doing.CONTENT
            return
        self._grasps += 1
        grasp = self._handling.grasp(box, turn, self._hand, self._failed)
        centre = grasp.middle(box)
        self._grasp = self._on_screen(grasp, centre)
        error = self._rng.normal(0.0, c.aim_error, 2)
        places = self._grasp.places(centre, self._grasp.opening(self._hand), self._hand)
        each = self._rng.normal(0.0, c.finger_error, places.shape)
        self._fingers.land(places + error + each, now)
        self._doing, self._tries = _Doing.ADJUSTING, 0
        # The user waits until the drawn hand has come down.
        self._wait(self._eye.delay + 0.45, now)

    def _on_screen(self, grasp: Grasp, centre: Array) -> Grasp:
        """The same grasp, with fewer fingers if some would be beyond the screen's border."""
        beyond = {}
        for fingers in range(grasp.fingers, min(grasp.fingers, 3) - 1, -1):
            fewer = replace(grasp, fingers=fingers)
            places = fewer.places(centre, grasp.opening(self._hand), self._hand)
            beyond[fingers] = beyond_border(places, self.surface)
        room = min(beyond.values()) + _HARDLY
        return replace(grasp, fingers=max(n for n, off in beyond.items() if off <= room))

    def _adjust(self, sight: Sight, box: SeenObject, now: float) -> None:
        """Moves the fingers until the drawn hand is around the box."""
        assert self._grasp is not None and self._handling is not None
        c = self.configuration
        middle = self._grasp.middle(box)
        opening = self._grasp.opening(self._hand)
        wanted = self._grasp.places(middle, opening, self._hand) + self._drawn_offset(sight)
        wanted = stopped_at_border(wanted, self.surface)
        off = float(np.sqrt(squared_lengths(wanted - self._fingers.places(now))).max())
        self._tries += 1
        if off > _IN_PLACE and self._tries <= 8:
            self._watch(self._fingers.move(wanted, now))
            return
        if not sight.solid:
            if self._tries > self._handling.patience:
                self._failed = self._grasp
                self._let_go(now)
                return
            # The hand is still a ghost, perhaps because a finger is inside the box: open the
            # fingers a little wider and look again.
            if self._tries > 4:
                wider = self._grasp.places(middle, opening + 0.004, self._hand)
                self._watch(self._fingers.move(wider + self._drawn_offset(sight), now))
            else:
                self._wait(0.1, now)
            return
        closed = self._grasp.places(middle, -c.squeeze, self._hand)
        closed = closed + self._drawn_offset_of_each(sight)
        self._failed = None
        self._doing = _Doing.CLOSING
        self._watch(self._fingers.move(closed, now))

    def _begin_drag(self, sight: Sight, box: SeenObject, now: float) -> None:
        self._doing, self._tries = _Doing.DRAGGING, 0
        self._drag(sight, box, now)

    def _drag(self, sight: Sight, box: SeenObject, now: float) -> None:
        """Drags the box towards the goal, or lets go at the goal, after a slip or when the grasp
        has used up its movements."""
        assert self._grasp is not None and self._handling is not None
        off, turn = self._missing(sight, box)
        held = self._grasp.middle(box) + self._drawn_offset(sight)
        lag = length(held - self._middle(now))
        near, straight = self._handling.good
        now_turn = self._handling.reach(box, self._grasp, turn, self._hand)
        # `now_turn` is the part of the turn that the wrist's range allows in this grasp.
        good = length(off) < near and abs(now_turn) < straight
        slipped = self._tries > 0 and lag > _SLIPPED
        if good or slipped or self._tries >= self.drags or not sight.solid:
            self._let_go(now)
            return
        self._tries += 1
        shift, turn = self._leg(sight, box, off, now_turn)
        self._watch(self._fingers.carry(shift, turn, self._handling.pivot(box), now))

    def _leg(self, sight: Sight, box: SeenObject, off: Array, turn: float) -> tuple[Array, float]:
        """Shift (2,) m and turn (rad) of the next movement: here the whole remaining movement."""
        return off, turn

    def _let_go(self, now: float) -> None:
        self._fingers.lift(now)
        self._doing = _Doing.LIFTING
        self._wait(self._eye.delay + 0.45, now)

    def _missing(self, sight: Sight, box: SeenObject) -> tuple[Array, float]:
        """Shift (2,) m and turn (rad) that bring the object from its seen pose to its goal."""
        assert self._handling is not None
        return self._handling.missing(box, sight.goals[0])

    def _middle(self, now: float) -> Array:
        """Point (2,) m in the middle of the pinch."""
        return _pinch_middle(self._fingers.places(now))

    def _drawn_offset(self, sight: Sight) -> Array:
        """Offset (2,) m that, added to the fingers, brings the *drawn* hand to the intended place.

        A person watches the drawn hand rather than their own fingers, and so corrects any constant
        error of the reconstruction. The offset is zero if a fingertip is not drawn.
        """
        ids = self._fingers.ids()
        if any(i not in sight.tips for i in ids):
            return np.zeros(2)
        drawn = np.array([sight.tips[i][:2] for i in ids])
        off = _pinch_middle(self._seen_places(sight)) - _pinch_middle(drawn)
        return off if length(off) > _BLUR else np.zeros(2)

    def _drawn_offset_of_each(self, sight: Sight) -> Array:
        """Offsets (n, 2) m for each finger, so that every drawn fingertip presses on its face.

        The session draws fingers beside an object away from their touches
        (`sandbox.session.tip_offsets`). A user who closes the fingers sees when each drawn
        fingertip reaches its face of the object.
        """
        common = self._drawn_offset(sight)
        ids = self._fingers.ids()
        if any(i not in sight.tips for i in ids):
            return np.zeros((len(ids), 2))
        off = self._seen_places(sight) - np.array([sight.tips[i][:2] for i in ids])
        apart = np.sqrt(squared_lengths(off - common))
        return np.where(apart[:, None] > _BLUR, off, common)

    def _seen_places(self, sight: Sight) -> Array:
        """Positions of the fingers at the time of the sight."""
        return self._fingers.places(sight.time)

    def _watch(self, arrival: float) -> None:
        """Waits until the effect of a movement that ends at the time `arrival` (s) is visible."""
        self._until = arrival + self._eye.delay + _SETTLE

    def _wait(self, seconds: float, now: float) -> None:
        self._until = now + seconds


def _pinch_middle(tips: Array) -> Array:
    """Point (2,) m halfway between the thumb and the outermost of the other fingers (n, 2) m."""
    return 0.5 * (tips[0] + 0.5 * (tips[1] + tips[-1]))


class IdleUser:
    """Touches nothing."""

    def __init__(self, configuration: UserConfiguration, surface: Surface, seed: int) -> None:
        self.configuration = configuration

    def observe(self, sight: Sight) -> None:
        """Ignores the screen."""

    def touch(self, now: float) -> TouchFrame:
        """No contact."""
        return TouchFrame(now, source="simulated user")


class RandomUser:
    """Touches at random: puts fingers down, drags and lifts them anywhere."""

    def __init__(self, configuration: UserConfiguration, surface: Surface, seed: int) -> None:
        self.configuration, self.surface = configuration, surface
        self._rng = np.random.default_rng([seed, 7_002])
        self._fingers = Fingers(configuration, self._rng)
        self._until = 0.0
        self._moves = 0

    def observe(self, sight: Sight) -> None:
        """Ignores the screen."""

    def touch(self, now: float) -> TouchFrame:
        """Random touches."""
        if now >= self._until - 1e-9:
            self._act(now)
        return TouchFrame(now, self._fingers.touches(now, self.surface), source="simulated user")

    def _act(self, now: float) -> None:
        c = self.configuration
        if self._moves == 0:
            middle = self.surface.to_world(self._rng.uniform(0.0, 1.0, 2) * self.surface.size)[:2]
            spread = self._rng.uniform(-0.05, 0.05, (c.fingers, 2))
            self._fingers.land(middle + spread, now)
            self._until = now + 0.5
        elif self._moves < 4:
            shift = self._rng.uniform(-0.06, 0.06, 2)
            pivot = self._fingers.places(now).mean(axis=0)
            turn = float(self._rng.uniform(-0.8, 0.8))
            self._until = self._fingers.carry(shift, turn, pivot, now) + 0.1
        else:
            self._fingers.lift(now)
            self._until = now + 0.5
        self._moves = (self._moves + 1) % 5


NOISE = 0.03
"""Standard deviation of each reading, as a share of the slider's travel. A slider at rest at its
lower end has no noise."""
_MISS = 0.03
"""Standard deviation of a movement's error, as a share of the movement's length."""
_BASE, _RATE = 0.30, 0.8
"""A movement takes `_BASE` seconds plus its length divided by `_RATE`. Lengths are shares of the
slider's travel."""
_STOP = 0.004
"""Reading, as a share of the slider's travel, below which the slider rests at its lower end."""


class Slider:
    """A lift control in the user's other hand.

    Args:
        reach: Height (m) by which the simulated hand rises over the slider's full travel, which
            the user has learned by practice.
        rng: The user's source of randomness.
    """

    def __init__(self, reach: float, rng: np.random.Generator) -> None:
        self._reach, self._rng = reach, rng
        self._start = self._end = 0.0
        self._begin, self._duration = 0.0, 1e-9

    def height(self, now: float) -> float:
        """Intended height of the hand (m)."""
        return self._reach * self._at(now)

    def move(self, height: float, now: float) -> float:
        """Moves the slider towards a height (m); returns the time of arrival (s)."""
        start = self._at(now)
        end = float(np.clip(height / self._reach, 0.0, 1.0))
        if end > _STOP:
            end += float(self._rng.normal(0.0, _MISS * abs(end - start)))
        self._start, self._end = start, float(np.clip(end, 0.0, 1.0))
        self._begin, self._duration = now, _BASE + abs(self._end - start) / _RATE
        return now + self._duration

    def control(self, now: float) -> float:
        """Reading of the device, 0 to 1."""
        share = self._at(now)
        if share <= _STOP:
            return 0.0
        return min(max(share + float(self._rng.normal(0.0, NOISE)), 0.0), 1.0)

    def _at(self, now: float) -> float:
        share = minimum_jerk((now - self._begin) / self._duration)
        return self._start + share * (self._end - self._start)


class IdleLiftUser(IdleUser):
    """Baseline user that touches nothing and leaves the slider at rest.

    Args:
        configuration: Settings of the simulated user.
        surface: The tablet.
        seed: Seed of the user's randomness.
        reach: See `Slider`.
    """

    def __init__(
        self, configuration: UserConfiguration, surface: Surface, seed: int, reach: float
    ) -> None:
        super().__init__(configuration, surface, seed)


class RandomLiftUser(RandomUser):
    """Baseline user that touches at random and moves the slider at random.

    Args:
        configuration: Settings of the simulated user.
        surface: The tablet.
        seed: Seed of the user's randomness.
        reach: See `Slider`.
    """

    def __init__(
        self, configuration: UserConfiguration, surface: Surface, seed: int, reach: float
    ) -> None:
        super().__init__(configuration, surface, seed)
        self._other = np.random.default_rng([seed, 7_004])
        self._slider = Slider(reach, self._other)
        self._reach = reach
        self._moved = 0.0

    def touch(self, now: float) -> TouchFrame:
        """Random touches and a random position of the slider."""
        if now >= self._moved:
            height = float(self._other.uniform(-0.5, 1.0)) * self._reach
            arrival = self._slider.move(max(height, 0.0), now)
            self._moved = arrival + float(self._other.uniform(0.0, 1.0))
        frame = super().touch(now)
        return TouchFrame(now, frame.contacts, self._slider.control(now), source=frame.source)
