"""Simulated user who presses single keys: rests five fingers, keeps one down, and presses another.

Nobody can tell which finger a single touch is. Who has rested five fingers, and keeps one of them
down, shows it: the touch that comes lands where one of the others was. Where such a press is not
taken, as by a finger that hangs in the key, the asked finger itself stays down.
"""

from __future__ import annotations

from enum import Enum, auto

from models.arithmetic.arrays import Array
from models.frames import FINGERS
from models.surface import Surface
from tasks.mechanisms.chord_user import AGAIN, ChordUser, keys_seen
from tasks.user import Sight, UserConfiguration

_RESTING = 0.9
"""s that five fingers rest on their keys, once they are seen there: longer than they have to."""
_APART = 0.3
"""s between two movements of single fingers."""
_PRESSING = 1.0
"""s that the user holds a key that is not done before beginning again."""
_OFF = 0.006
"""m across the keys, within which the drawn fingertips rest on their keys."""
_LOOK = 0.1
"""s between two looks."""


class _Step(Enum):
    AWAY = auto()
    RESTING = auto()
    WAITING = auto()
    PRESSING = auto()
    HOLDING = auto()


class SingleKeyUser(ChordUser):
    """Rests five fingers on the keys, lifts all but one, presses the asked key with its own
    finger, and lifts the one that had stayed. If that was not taken, the user rests again, and
    lifts all but the asked finger.

    Args:
        configuration: Settings of the simulated user.
        surface: The tablet.
        seed: Seed of the user's randomness.
    """

    def __init__(self, configuration: UserConfiguration, surface: Surface, seed: int) -> None:
        super().__init__(configuration, surface, seed)
        self._step = _Step.AWAY
        self._stays = 0
        self._failed = False

    def _act(self, sight: Sight, now: float) -> None:
        keys, row = keys_seen(sight)
        (asked,) = [keys.index(goal.object) for goal in sight.goals if goal.shown]
        fingers = range(len(FINGERS))
        if self._step is _Step.AWAY:
            if not sight.done and self._tries < self.configuration.attempts:
                self._tries += 1
                self._rest(self._aims(row) + self._error, now)
        elif self._step is _Step.RESTING:
            off = self._seen_off(sight)
            if abs(float((off * row.right).sum())) > _OFF:
                self._leave(sight, now)
                return
            others = [f for f in fingers if f != asked]
            self._stays = asked if self._failed else int(self._rng.choice(others))
            self._fingers.lift_some([f for f in fingers if f != self._stays], now)
            self._since = now
            self._go(_Step.HOLDING if self._failed else _Step.WAITING, now + _APART)
        elif self._step is _Step.WAITING:
            again = self._fingers.places(now)[asked] + self._rng.normal(0.0, AGAIN, 2)
            self._fingers.put_down(asked, again, now)
            self._go(_Step.PRESSING, now + _APART)
        elif self._step is _Step.PRESSING:
            self._fingers.lift_some([self._stays], now)
            self._since = now
            self._go(_Step.HOLDING, now + _LOOK)
        elif sight.done or now - self._since < self._eye.delay + _PRESSING:
            self._until = now + _LOOK
        else:
            self._failed = True
            self._leave(sight, now)

    def _rest(self, places: Array, now: float) -> None:
        """Puts five fingers down."""
        each = self._rng.normal(0.0, self.configuration.finger_error, places.shape)
        self._touching = tuple(range(len(FINGERS)))
        self._fingers.land(places + each, now)
        # The user waits until the hand is seen to come down.
        self._go(_Step.RESTING, now + self._eye.delay + 0.45 + _RESTING)

    def _leave(self, sight: Sight, now: float) -> None:
        """Lifts all fingers, and learns from where they were seen to land."""
        self._lift(sight, now)
        self._go(_Step.AWAY, self._until)

    def _go(self, step: _Step, until: float) -> None:
        self._step, self._until = step, until
