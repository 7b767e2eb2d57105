"""Press one of five keys by its own finger, after all five have rested: a name that only history
tells."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from models.frames import FINGERS
from models.message import Message
from models.surface import Surface
from tasks.mechanisms.chords import POINT, SIZE, YAW, Chords, own_finger, placed, pressed
from tasks.mechanisms.keyboard import KEYS, key_name
from tasks.mechanisms.single_key_user import SingleKeyUser
from tasks.sensing import Sensing
from tasks.task import Measure
from tasks.user import UserMaker


@dataclass(frozen=True)
class SingleKeys(Chords):
    """Rest all five fingers on the keys, then press the blue one with its own finger.

    Scene: the row of five sprung keys of `chords`; one of them is blue.
    Goal: the blue key pressed down, the others up.
    Success: first all five keys are down for 0.5 s without a break, by whatever fingers: five have
    rested. From then on as in `chords`: the blue key is below 6 mm and touched by its own finger
    alone, the others are not, for 0.5 s without a break; all within 20 s.
    Start: any of the five keys, evenly; the row as in `chords`.
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
