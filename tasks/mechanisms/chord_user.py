"""Simulated user who presses chords: puts the asked fingers down on their keys, looks, tries again.

The user sees the keys, which of them are asked for, the drawn fingertips and whether the task is
done. The first touch misses by the error of a hand that is not seen over the screen; who has seen
where a hand landed puts it down again nearly there.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from enum import Enum, auto

import numpy as np

from models.arithmetic.arrays import Array
from models.arithmetic.products import length
from models.frames import FINGERS, TouchFrame
from models.objects import MechanismPart
from models.surface import Surface
from tasks.simulated_user.eye import Eye
from tasks.simulated_user.fingers import Fingers
from tasks.simulated_user.hand import Hand
from tasks.user import FingersKnown, SeenObject, Sight, UserConfiguration

AGAIN = 0.003
"""m per axis, error of a hand that is put down again where it was seen to land; assumed."""
THUMB_BELOW = 0.034
"""m by which a relaxed thumb's tip is nearer to the person than the index finger's: of the layout
of the skeleton's relaxed hand (`tasks.simulated_user.spreads`)."""
SPREAD = 0.004
"""m, standard deviation of how far along its key a finger lands, from hand to hand."""

_OFF = 0.004
"""m, error of the drawn fingertips across the keys that the user corrects."""
_PRESSING = 0.75
"""s that the user holds a chord that is not done before trying again: longer than it has to be
held."""
_RESTING = 0.8
"""s that all five fingers rest on the keys."""
_LOOK = 0.1
"""s between two looks at a chord that is held."""


class _Doing(Enum):
    READY = auto()
    PRESSING = auto()
    RESTING = auto()
    LIFTED = auto()


@dataclass(frozen=True)
class _Row:
    """The row of keys as seen: a place (2,) m on each, its direction and that along keys."""

    middles: Array
    right: Array
    along: Array


class ChordUser(FingersKnown):
    """Presses the asked keys, each by its own finger.

    After a chord that was not taken though its fingers were on their keys, the user shows the
    program the whole hand: all five fingers rest on the keys, and are lifted.

    Args:
        configuration: Settings of the simulated user; the number of fingers is that of the keys.
        surface: The tablet.
        seed: Seed of the user's randomness.
    """

    def __init__(self, configuration: UserConfiguration, surface: Surface, seed: int) -> None:
        self.configuration, self.surface = configuration, surface
        self._rng = np.random.default_rng([seed, 7_040])
        self._eye = Eye(float(self._rng.uniform(*configuration.reaction)))
        self._fingers = Fingers(replace(configuration, fingers=len(FINGERS)), self._rng)
        self._hand = Hand.draw(configuration, seed)
        # How far along the keys each finger reaches, seen from the index finger.
        tips = [y for _, y in self._hand.tips]
        reach = np.array([-THUMB_BELOW * configuration.hand_size, *tips])
        self._reach: Array = reach + self._rng.normal(0.0, SPREAD, len(FINGERS))
        self._doing = _Doing.READY
        self._until = 0.0
        self._since = 0.0
        self._error: Array = self._rng.normal(0.0, configuration.aim_error, 2)
        self._touching: tuple[int, ...] = ()
        self._tries = 0
        self._show_hand = False

    def finger_of(self, contact: int) -> int | None:
        """Finger of a contact of the last touch."""
        ids = self._fingers.ids()
        return self._touching[ids.index(contact)] if contact in ids[: len(self._touching)] else None

    def look(self, sight: Sight) -> None:
        """Shows the user the screen; the user reacts to it a reaction time later."""
        self._eye.look(sight)

    def touch(self, now: float) -> TouchFrame:
        """Touches on the screen at the time now, s."""
        sight = self._eye.at(now)
        if sight is not None and now >= self._until - 1e-9:
            self._act(sight, now)
        return TouchFrame(now, self._fingers.touches(now, self.surface), source="simulated user")

    def _act(self, sight: Sight, now: float) -> None:
        if self._doing is _Doing.PRESSING:
            self._hold(sight, now)
        elif self._doing is _Doing.RESTING:
            self._lift(sight, now)
        elif self._doing is _Doing.LIFTED:
            self._doing = _Doing.READY
        elif not sight.done and self._tries < self.configuration.attempts:
            self._press(sight, now)

    def _press(self, sight: Sight, now: float) -> None:
        """Puts down the asked fingers, or all five to show the hand."""
        keys, row = keys_seen(sight)
        asked = {goal.object for goal in sight.goals if goal.shown}
        rests, self._show_hand = self._show_hand, False
        fingers = [f for f, name in enumerate(keys) if rests or name in asked]
        self._touching = tuple(fingers)
        places = self._aims(row)[fingers] + self._error
        each = self._rng.normal(0.0, self.configuration.finger_error, places.shape)
        self._fingers.land(places + each, now)
        self._doing = _Doing.RESTING if rests else _Doing.PRESSING
        self._tries += not rests
        self._since = now
        # The user waits until the hand is seen to come down.
        self._until = now + (_RESTING if rests else 0.0) + self._eye.delay + 0.45

    def _hold(self, sight: Sight, now: float) -> None:
        """Holds a chord that is done, and one that is not for a while."""
        if sight.done or now - self._since < self._eye.delay + 0.45 + _PRESSING:
            self._until = now + _LOOK
            return
        _, row = keys_seen(sight)
        across = abs(float((self._seen_off(sight) * row.right).sum()))
        # Fingers that were on their keys, and the chord was not taken: the hand was not known.
        self._show_hand = across < _OFF
        self._lift(sight, now)

    def _lift(self, sight: Sight, now: float) -> None:
        """Lifts the fingers, and learns from where they were seen to land."""
        error = self._error - self._seen_off(sight)
        self._error = error + self._rng.normal(0.0, AGAIN, 2)
        self._fingers.lift(now)
        self._doing = _Doing.LIFTED
        self._until = now + self._eye.delay + 0.3

    def _aims(self, row: _Row) -> Array:
        """Intended places (5, 2) m of the fingers, in the middle of the keys as a group."""
        lowest, highest = float(self._reach.min()), float(self._reach.max())
        along = self._reach - 0.5 * (lowest + highest)
        return np.asarray(row.middles + along[:, None] * row.along)

    def _seen_off(self, sight: Sight) -> Array:
        """Mean offset (2,) m of the drawn fingertips from their aims; 0 while they are not seen."""
        ids = self._fingers.ids()[: len(self._touching)]
        if any(i not in sight.tips for i in ids):
            return np.zeros(2)
        _, row = keys_seen(sight)
        drawn = np.array([sight.tips[i][:2] for i in ids])
        return np.asarray((drawn - self._aims(row)[list(self._touching)]).mean(axis=0))


def keys_seen(sight: Sight) -> tuple[list[str], _Row]:
    """Names of the keys from the thumb's on, as the person sees them, and their row."""
    seen: dict[str, SeenObject] = {
        name: thing
        for name, thing in sight.objects.items()
        if isinstance(thing.shape, MechanismPart) and thing.shape.joint is not None
    }
    names = sorted(seen, key=lambda name: float(seen[name].position[0]))
    middles = np.array([seen[name].position[:2] for name in names])
    right = middles[-1] - middles[0]
    right = right / length(right)
    return names, _Row(middles, right, np.array([-right[1], right[0]]))
