"""Press two or three of five keys at once, each with its own finger. Success depends on correct
labels of the fingers.

The five sprung keys form a row like those of a piano, with one key for each finger of a hand.

The simulated user sees the keys, which of them to press, the drawn fingertips and whether the task
is done. The first touch has the large error of a hand that is not seen over the screen. Once the
user has seen where the hand landed, further touches have a small error.
"""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass, replace
from enum import Enum, auto
from itertools import combinations
from typing import ClassVar

import numpy as np

from models.arithmetic import Array, length
from models.errors import SurfaceTooSmallError
from models.frames import FINGERS, TouchFrame
from models.mechanism import Mechanism
from models.message import Message
from models.objects import MechanismPart, SceneObject
from models.surface import Surface
from tasks.sensing import Sensing
from tasks.simulated_user.user_hand import Fingers, Hand
from tasks.simulated_user.view import Eye
from tasks.task import Goal, Measure, TaskDefaults
from tasks.user import FingersKnown, SeenObject, Sight, UserConfiguration, UserMaker

NAME = "keys"
KEYS = len(FINGERS)
PITCH = 0.0235
"""Distance (m) from key to key: the width of a piano's white keys (165 mm for an octave of
seven)."""
GAP = 0.001
"""Gap (m) between two keys."""
LENGTH = 0.150
"""Visible length (m) of a piano's white key."""
DIP = 0.010
"""Distance (m) by which a key can be pressed down, as on a piano."""
LIGHTEST, HEAVIEST = 0.5, 0.8
"""Forces (N) needed to move a key from rest, and to hold it at the bottom. A piano key sinks under
a weight of about 50 g."""
MASS = 0.050
"""Moving mass (kg) of a key. Its weight is balanced."""
DAMPING = 0.5
"""Damping (N s/m) of a key."""
TOP = 0.028
"""Height (m) of the keys' tops above the table."""

_HEIGHT = 0.018
"""Thickness (m) of a key, whose lower side reaches the table when the key is pressed down."""
_IVORY, _ASKED, _WOOD = ".93 .92 .88 1", ".20 .55 .78 1", ".16 .15 .15 1"


def keyboard(
    position: tuple[float, float], yaw: float, asked: Collection[int], size: float
) -> Mechanism:
    """A row of five keys that is fixed on the table; `key_name` gives their names.

    Args:
        position: (2,) m, middle of the row.
        yaw: Yaw (rad) about the vertical; at 0 the first key is the leftmost.
        asked: Indices of the blue keys.
        size: Factor on the distance from key to key.
    """
    pitch = PITCH * size
    stiffness = (HEAVIEST - LIGHTEST) / DIP
    keys = []
    for key in range(KEYS):
        x, half = (key - (KEYS - 1) / 2) * pitch, (pitch - GAP) / 2
        keys.append(
            f'<body name="{key}" pos="{x:.6f} 0 0" gravcomp="1">'
            f'<joint type="slide" axis="0 0 -1" range="0 {DIP}" stiffness="{stiffness:g}"'
            f' springref="{-LIGHTEST / stiffness:.6f}" damping="{DAMPING}"/>'
            f'<geom type="box" size="{half:.6f} {LENGTH / 2} {_HEIGHT / 2}"'
            f' pos="0 0 {-_HEIGHT / 2}" mass="{MASS}" rgba="{_ASKED if key in asked else _IVORY}"/>'
            "</body>"
        )
    # A rail behind the keys, which nothing touches.
    width = KEYS * pitch / 2 + 0.006
    rail = (
        f'<geom type="box" size="{width:.6f} .006 {TOP / 2 + 0.002}" contype="0" conaffinity="0"'
        f' pos="0 {LENGTH / 2 + 0.008} {-TOP / 2 + 0.002}" rgba="{_WOOD}"/>'
    )
    mjcf = f"<mujoco><worldbody><body>{rail}{''.join(keys)}</body></worldbody></mujoco>"
    # The origin is at the keys' tops, so that their height does not change with the row's size.
    return Mechanism(NAME, mjcf, (*position, TOP), yaw)


def key_name(key: int) -> str:
    """Name of a key among the objects, 0 for the leftmost."""
    return f"{NAME}/{key}"


AGAIN = 0.003
"""Standard deviation (m per axis) of the error of a hand that is put down again after the user saw
its first landing; assumed."""
THUMB_BELOW = 0.034
"""Distance (m) by which a relaxed thumb's tip is nearer to the person than the index fingertip,
from the layout of the skeleton's relaxed hand (`sandbox.devices.simulated.spreads`)."""
SPREAD = 0.004
"""Standard deviation (m), over hands, of the position along its key at which a finger lands."""

_OFF = 0.004
"""The fingers count as on their keys if the drawn fingertips are off by less than this distance (m)
across the keys."""
_PRESSING = 0.75
"""Time (s) for which the user holds an unsuccessful chord before trying again; longer than the hold
time."""
_RESTING = 0.8
"""Time (s) for which all five fingers rest on the keys."""
_LOOK = 0.1
"""Interval (s) between two looks at a chord that is held."""


class _Doing(Enum):
    READY = auto()
    PRESSING = auto()
    RESTING = auto()
    LIFTED = auto()


@dataclass(frozen=True)
class _Row:
    """The row of keys as seen.

    Attributes:
        middles: (5, 2) m, positions of the keys.
        right: (2,) unit vector from the first key to the last key.
        along: (2,) unit vector along the keys, away from the person.
    """

    middles: Array
    right: Array
    along: Array


class ChordUser(FingersKnown):
    """Presses the blue keys, each by its own finger.

    If the task does not accept a chord although the fingers were on their keys, the user shows the
    program the whole hand: all five fingers rest on the keys, and are lifted.

    The kind `demonstrating` always begins with five fingers, and then lifts those of the white
    keys.

    Args:
        configuration: Settings of the simulated user. Its number of fingers has no effect: there is
            a finger for every key.
        surface: The tablet.
        seed: Seed of the user's randomness.
    """

    def __init__(self, configuration: UserConfiguration, surface: Surface, seed: int) -> None:
        self.configuration, self.surface = configuration, surface
        self._rng = np.random.default_rng([seed, 7_040])
        self._eye = Eye(float(self._rng.uniform(*configuration.reaction)))
        self._fingers = Fingers(replace(configuration, fingers=len(FINGERS)), self._rng)
        self._hand = Hand.draw(configuration, seed)
        # How far along the keys each finger reaches, relative to the index finger.
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
        self._demonstrates = configuration.kind == "demonstrating"

    def finger_of(self, contact: int) -> int | None:
        """Finger of a contact of the last touch."""
        ids = self._fingers.ids()
        return self._touching[ids.index(contact)] if contact in ids[: len(self._touching)] else None

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
        if self._doing is _Doing.PRESSING:
            self._hold(sight, now)
        elif self._doing is _Doing.RESTING:
            if self._demonstrates and self._on_keys(sight):
                self._leave_blue(sight, now)
            else:
                self._lift(sight, now)
        elif self._doing is _Doing.LIFTED:
            self._doing = _Doing.READY
        elif not sight.done and self._tries < self.configuration.attempts:
            self._press(sight, now)

    def _press(self, sight: Sight, now: float) -> None:
        """Puts down the fingers of the blue keys, or all five fingers to show the hand."""
        keys, row = keys_seen(sight)
        asked = {goal.object for goal in sight.goals if goal.shown}
        rests, self._show_hand = self._show_hand or self._demonstrates, False
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

    def _leave_blue(self, sight: Sight, now: float) -> None:
        """Lifts the fingers of the white keys."""
        keys, _ = keys_seen(sight)
        asked = {goal.object for goal in sight.goals if goal.shown}
        self._fingers.lift_some([f for f, name in enumerate(keys) if name not in asked], now)
        self._tries += 1
        self._since = now
        self._doing, self._until = _Doing.PRESSING, now + _LOOK

    def _hold(self, sight: Sight, now: float) -> None:
        """Holds a chord: until the end if it is accepted, otherwise for a limited time."""
        if sight.done or now - self._since < self._eye.delay + 0.45 + _PRESSING:
            self._until = now + _LOOK
            return
        # If a chord is not accepted although its fingers were on their keys, their labels were
        # probably wrong.
        self._show_hand = self._on_keys(sight)
        self._lift(sight, now)

    def _on_keys(self, sight: Sight) -> bool:
        """True if the drawn fingertips are seen on their keys."""
        _, row = keys_seen(sight)
        return abs(float((self._seen_off(sight) * row.right).sum())) < _OFF

    def _lift(self, sight: Sight, now: float) -> None:
        """Lifts the fingers, and corrects the next landing by the observed error."""
        error = self._error - self._seen_off(sight)
        self._error = error + self._rng.normal(0.0, AGAIN, 2)
        self._fingers.lift(now)
        self._doing = _Doing.LIFTED
        self._until = now + self._eye.delay + 0.3

    def _aims(self, row: _Row) -> Array:
        """Intended positions (5, 2) m of the fingers. As a group they are centred along the
        keys."""
        lowest, highest = float(self._reach.min()), float(self._reach.max())
        along = self._reach - 0.5 * (lowest + highest)
        return np.asarray(row.middles + along[:, None] * row.along)

    def _seen_off(self, sight: Sight) -> Array:
        """Mean offset (2,) m of the drawn fingertips from their intended positions; 0 while some
        are not drawn."""
        ids = self._fingers.ids()[: len(self._touching)]
        if any(i not in sight.tips for i in ids):
            return np.zeros(2)
        _, row = keys_seen(sight)
        drawn = np.array([sight.tips[i][:2] for i in ids])
        return np.asarray((drawn - self._aims(row)[list(self._touching)]).mean(axis=0))


def keys_seen(sight: Sight) -> tuple[list[str], _Row]:
    """Names of the keys from left to right as the user sees them, and their row.

    A user sees the thumb's key at the left. Left hands are simulated by a mirror image.
    """
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


SIZE = (0.92, 1.08)
"""Range of the distance from key to key relative to a piano's, for smaller and larger hands."""
YAW = float(np.deg2rad(8.0))
"""Largest turn (rad) of the row relative to the surface."""
POINT = 0.6
"""A key counts as pressed from this share of its travel, at which an electric piano sounds."""
BORDER = 0.006
"""Least distance (m) of the outermost key from the surface's border."""
REACH = 0.085
"""Height (m) of the surface that a hand needs, from the thumb to the middle finger."""

PRESSED_AT = TOP - 0.008
"""Height (m) of the touch plane. The fingertip's lowest point is then about 9 mm under the top of a
key at rest, and 1 mm above the bottom of the key's travel."""


@dataclass(frozen=True)
class Chords(TaskDefaults):
    """Press the blue keys, each with its own finger.

    Scene: a row of five sprung keys on the table, 15 cm long, with a travel of 10 mm. The distance
    from key to key is that of a piano, 23.5 mm, times 0.92 to 1.08. A key needs a force of 0.5 N to
    move, and of 0.8 N to stay at the bottom. Keys are in the order of the hand's fingers, with the
    thumb of a left hand at the right. Two or three keys are blue.
    Goal: the blue keys pressed down, the others up.
    Success: every blue key is pressed down by at least 6 mm and touched by its own finger alone,
    and the other keys are not down, for 0.5 s without a break, within 20 s. Hands turn solid on
    their way down, so a finger that is put down on a key presses it. If the fingers are labelled
    wrong, the hand presses with a wrong finger, which does not count.
    Start: two or three keys are blue with equal probability, and so is every set of that many keys.
    The middle is uniform where the row fits on the surface, the yaw is uniform within 8 degrees,
    and all keys are up.
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
    fewest_fingers: ClassVar[int] = len(FINGERS)
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
    """Label of a key's own finger, for a right or a left hand according to the hand's name."""
    return KEYS - 1 - key if hand.startswith("left") else key


def placed(
    task: str,
    rng: np.random.Generator,
    asked: Collection[int],
    surface: Surface,
    size: float,
    yaw: float,
) -> tuple[tuple[SceneObject, ...], tuple[Goal, ...]]:
    """A row of keys at a random place of a surface, some of them blue, and its goals.

    Args:
        task: Name of the task, for error messages.
        rng: Source of randomness for the position.
        asked: Indices of the keys to press.
        surface: The surface.
        size: Factor on the distance from key to key, within `SIZE`.
        yaw: Yaw (rad) of the row relative to the surface.

    Raises:
        SurfaceTooSmallError: The surface has no room for five keys under a hand.
    """
    # The bounds leave room for the largest row in any orientation.
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

    With two hands, the own finger of either hand counts. The reason refers to the first hand.

    Args:
        goals: Goals of all keys; those of the blue keys are shown.
        sensing: The simulation.
        first: Measure of a condition that has to be held first; None if there is none.
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
        reason = Message("chord_other_key", "a white key is down: lift its finger")
    # Only success is 1.
    progress = 1.0 if not reason else min(right / len(asked), 0.99)
    return Measure(not reason, progress, reason, first=first)
