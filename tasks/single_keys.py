"""Press one of five keys with its own finger, after all five fingers have rested on the keys. Only
the history of touches shows the label of this finger.

A single touch does not show which finger makes it. The simulated user first rests five fingers, and
then leaves one of them down. The next touch lands where one of the other fingers was, so the
program can infer its label. If such a press is not accepted, for example because a finger hangs in
the key, the pressing finger itself stays down in the next attempt.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum, auto
from typing import ClassVar

import numpy as np

from models.arithmetic import Array
from models.frames import FINGERS
from models.message import Message
from models.surface import Surface
from tasks.chords import (
    AGAIN,
    KEYS,
    POINT,
    SIZE,
    YAW,
    Chords,
    ChordUser,
    key_name,
    keys_seen,
    own_finger,
    placed,
    pressed,
)
from tasks.sensing import Sensing
from tasks.task import Measure
from tasks.user import Sight, UserConfiguration, UserMaker

_RESTING = 0.9
"""Time (s) for which five fingers rest on their keys once they are seen there; longer than
required."""
_APART = 0.3
"""Interval (s) between two movements of single fingers."""
_PRESSING = 1.0
"""Time (s) for which the user holds a key without success before beginning again."""
_OFF = 0.006
"""Largest offset (m) across the keys at which drawn fingertips count as resting on their keys."""
_LOOK = 0.1
"""Interval (s) between two looks."""


class _Step(Enum):
    AWAY = auto()
    RESTING = auto()
    WAITING = auto()
    PRESSING = auto()
    HOLDING = auto()


class SingleKeyUser(ChordUser):
    """Presses a key after resting five fingers.

    The user rests five fingers on the keys, lifts all but one of the other keys' fingers, presses
    the blue key with its own finger, and lifts the finger that had stayed down. If the press is not
    accepted, the user rests all fingers again, and then lifts all except that of the blue key. The
    kind `demonstrating` always does the latter.

    Args:
        configuration: Settings of the simulated user.
        surface: The tablet.
        seed: Seed of the user's randomness.
    """

    def __init__(self, configuration: UserConfiguration, surface: Surface, seed: int) -> None:
        super().__init__(configuration, surface, seed)
        self._step = _Step.AWAY
        self._stays = 0
        self._failed = configuration.kind == "demonstrating"

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
        # The user waits until the drawn hand has come down.
        self._go(_Step.RESTING, now + self._eye.delay + 0.45 + _RESTING)

    def _leave(self, sight: Sight, now: float) -> None:
        """Lifts all fingers, and corrects the next landing by the observed error."""
        self._lift(sight, now)
        self._go(_Step.AWAY, self._until)

    def _go(self, step: _Step, until: float) -> None:
        self._step, self._until = step, until


@dataclass(frozen=True)
class SingleKeys(Chords):
    """Rest all five fingers on the keys, then press the blue one with its own finger.

    Scene: the row of five sprung keys of `chords`; one of them is blue.
    Goal: the blue key pressed down, the others up.
    Success: in two steps, within 20 s. First, all five keys are down for 0.5 s without a break,
    pressed by any fingers. Afterwards, as in `chords`, the blue key is pressed down by at least 6
    mm and touched by its own finger alone, and the other keys are not down, for 0.5 s without a
    break.
    Start: each of the five keys is blue with equal probability. The row is as in `chords`.
    History: version 1.
    """

    name: ClassVar[str] = "single-keys"
    version: ClassVar[int] = 1
    user: ClassVar[UserMaker | None] = SingleKeyUser

    @classmethod
    def draw(cls, seed: int, surface: Surface) -> SingleKeys:
        """Draws the trial of a seed; the same seed and surface give the same trial.

        Raises:
            SurfaceTooSmallError: The surface has no room for five keys under a hand.
        """
        rng = np.random.default_rng([seed, cls.version, 45])
        asked = (int(rng.integers(KEYS)),)
        size, yaw = float(rng.uniform(*SIZE)), float(rng.uniform(-YAW, YAW))
        objects, goals = placed(cls.name, rng, asked, surface, size, yaw)
        return cls(seed, objects, goals)

    def measure(self, sensing: Sensing) -> Measure:
        """Tests whether the key is pressed by its own finger now, and whether five fingers rest."""
        up = [
            FINGERS[own_finger(key, sensing.hands[0])]
            for key in range(KEYS)
            if sensing.joint(key_name(key)).share < POINT
        ]
        reason: str = ""
        if up:
            reason = Message("chord_up", "not down yet, the key of: {finger}", finger=up)
        return pressed(self.goals, sensing, Measure(not up, 0.0, reason))
