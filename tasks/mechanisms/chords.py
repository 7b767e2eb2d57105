"""Press two or three of five keys at once, each by its own finger: names of fingers decide."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass
from itertools import combinations
from typing import ClassVar

import numpy as np

from models.errors import SurfaceTooSmallError
from models.frames import FINGERS
from models.message import Message
from models.objects import SceneObject
from models.surface import Surface
from tasks.mechanisms.chord_user import ChordUser
from tasks.mechanisms.keyboard import DIP, KEYS, PITCH, TOP, key_name, keyboard
from tasks.sensing import Sensing
from tasks.task import Goal, Measure, TaskDefaults
from tasks.user import UserMaker

SIZE = (0.92, 1.08)
"""Distance from key to key relative to a piano's: the row lies under smaller and larger hands."""
YAW = float(np.deg2rad(8.0))
"""rad, largest turn of the row against the surface."""
POINT = 0.6
"""Share of its dip from which on a key counts as pressed; an electric piano's sounds there."""
BORDER = 0.006
"""m from the surface's border to the outermost key, at least."""
REACH = 0.085
"""m, height of the surface that a hand needs, from the thumb to the middle finger."""

PRESSED_AT = TOP - 0.008
"""m, height of the touch plane: the fingertip's lowest point is then about 9 mm under the top of a
key at rest, 1 mm above the bottom of its dip."""


@dataclass(frozen=True)
class Chords(TaskDefaults):
    """Press the blue keys, each with its own finger.

    Scene: a row of five sprung keys on the table, 23.5 mm from key to key as a piano's (times 0.92
    to 1.08), 15 cm long, with a dip of 10 mm; 0.5 N press a key down, 0.8 N hold it at the bottom.
    Keys are in the order of the hand's fingers, a left hand's thumb at the right. Two or three of
    them are blue.
    Goal: the blue keys pressed down, the others up.
    Success: every blue key is below 6 mm and touched by its own finger alone, the others are not,
    for 0.5 s without a break, within 20 s. Hands turn solid on their way down, so that a finger
    that is put down on a key presses it. A hand whose fingers are named wrong presses with the
    wrong finger, which does not count.
    Start: two or three keys, evenly, then any that many of the five; middle uniform where the row
    fits on the surface; yaw uniform within 8 degrees; all keys up.
    History: version 1.
    """

    name: ClassVar[str] = "chords"
    version: ClassVar[int] = 1
    time_limit: ClassVar[float] = 20.0
    hold_time: ClassVar[float] = 0.5
    table_friction: ClassVar[float] = 0.5
    touch_height: ClassVar[float] = PRESSED_AT
    lift_range: ClassVar[float] = 0.0
    plane: ClassVar[str] = "table"
    pressed: ClassVar[bool] = True
    user: ClassVar[UserMaker | None] = ChordUser

    seed: int
    objects: tuple[SceneObject, ...]
    goals: tuple[Goal, ...]

    @classmethod
    def draw(cls, seed: int, surface: Surface) -> Chords:
        """Draws the trial of a seed; the same seed and surface give the same trial.

        Raises:
            SurfaceTooSmallError: The surface has no room for five keys under a hand.
        """
        rng = np.random.default_rng([seed, cls.version, 40])
        size, yaw = float(rng.uniform(*SIZE)), float(rng.uniform(-YAW, YAW))
        count = int(rng.integers(2, 4))
        chords = list(combinations(range(KEYS), count))
        asked = chords[int(rng.integers(len(chords)))]
        objects, goals = placed(cls.name, rng, asked, surface, size, yaw)
        return cls(seed, objects, goals)

    def measure(self, sensing: Sensing) -> Measure:
        """Tests whether the chord is pressed by the right fingers now."""
        return pressed(self.goals, sensing)


def own_finger(key: int, hand: str) -> int:
    """Label of the finger that a key belongs to, for a right or a left hand, by the hand's name."""
    return KEYS - 1 - key if hand.startswith("left") else key


def placed(
    task: str,
    rng: np.random.Generator,
    asked: Collection[int],
    surface: Surface,
    size: float,
    yaw: float,
) -> tuple[tuple[SceneObject, ...], tuple[Goal, ...]]:
    """A row of keys anywhere on a surface, some of them blue, and its goals.

    Args:
        task: Name of the task, for messages.
        rng: Source of the place.
        asked: Indices of the keys that are to be pressed.
        surface: The surface.
        size: Factor on the distance from key to key, within `SIZE`.
        yaw: rad, of the row against the surface.

    Raises:
        SurfaceTooSmallError: The surface has no room for five keys under a hand.
    """
    # The largest row fits, however it is turned.
    half = KEYS * PITCH * SIZE[1] / 2 + BORDER
    low, high = np.array([half, REACH / 2]), surface.size - (half, REACH / 2)
    if np.any(high < low):
        raise SurfaceTooSmallError(
            task, (surface.width_in, surface.height_in), "five keys and a hand", (5.7, 3.5)
        )
    x, y, _ = surface.to_world(rng.uniform(low, high)).tolist()
    row = keyboard((x, y), yaw, asked, size)
    goals = []
    for key in range(KEYS):
        position, _ = row.part(str(key)).placed(DIP if key in asked else 0.0)
        goals.append(Goal(key_name(key), position, yaw, shown=key in asked))
    return row.parts, tuple(goals)


def pressed(goals: tuple[Goal, ...], sensing: Sensing, first: Measure | None = None) -> Measure:
    """Tests whether the blue keys, and no others, are pressed now, each by its own finger alone.

    With two hands a key's own finger is that of either; what is missing is said of the first.

    Args:
        goals: Goals of all keys; those of blue ones are shown.
        sensing: The simulation.
        first: What has to be held before.
    """
    asked = {goal.object for goal in goals if goal.shown}
    hands = sensing.hands
    up, by_others, wrong = [], [], False
    for key in range(KEYS):
        name, finger = key_name(key), own_finger(key, hands[0])
        down = sensing.joint(name).share >= POINT
        if name not in asked:
            wrong |= down
        elif not down:
            up.append(FINGERS[finger])
        elif sensing.fingers(name) not in [{(hand, own_finger(key, hand))} for hand in hands]:
            by_others.append(FINGERS[finger])
    right = len(asked) - len(up) - len(by_others)
    reason: str = ""
    if up:
        reason = Message("chord_up", "not down yet, the key of: {finger}", finger=up)
    elif by_others:
        reason = Message(
            "chord_other_finger",
            "another finger presses the key of: {finger}",
            finger=by_others,
        )
    elif wrong:
        reason = Message("chord_other_key", "a key is down that is not blue")
    # Only success is 1.
    progress = 1.0 if not reason else min(right / len(asked), 0.99)
    return Measure(not reason, progress, reason, first=first)
