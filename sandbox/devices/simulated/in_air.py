"""The simulated user in the air as a device: over a simulated Leap, or in a headset."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields, replace
from math import isfinite

import numpy as np

from encoders.paalm.hand_pose import PALM_CENTRE
from encoders.paalm.simulated.forward import DIALECTS, FROZEN_LEAP, ForwardLeap, LeapConfiguration
from models.arithmetic import Array, small_product
from models.errors import InputError
from models.frames import HandFrame
from models.person import Person
from models.skeleton import ADULT
from sandbox.devices.device import HandDevice
from sandbox.devices.simulated import NEXT_PERSON
from sandbox.devices.simulated.air_person import AirCarrier, AirPerson, check_holdable
from sandbox.devices.webxr.joints import FINGER_JOINTS, seen_hand
from sandbox.server.protocol import JOINTS_OF_A_HAND, SeenJoints
from sandbox.session.messages import Snapshot
from tasks.registry import hands_of
from tasks.task import Goal, Task
from tasks.user import SeenObject, Sight, UserConfiguration

_NOISY = (
    "joint",
    "palm_place",
    "palm_turn",
    "length_slow",
    "tip",
    "length",
    "direction",
    "aside",
    "centre_wanders",
    "centre_place",
    "centre_turn",
    "lost_rate",
)
MOST_NOISE, LONGEST = 20.0, 10.0
"""Largest factor on the noise, and longest time (s) for which the hand may be lost."""


@dataclass(frozen=True)
class LeapDisturbance:
    """Disturbances that are added to a simulated Leap.

    Attributes:
        noise: Factor on the noise of positions, lengths and directions, and on the rate of lost
            fingers.
        lose: Time (s) for which the whole hand is out of the device's view, once, while it carries
            an object; 0 means never.
    """

    noise: float = 1.0
    lose: float = 0.0

    def __post_init__(self) -> None:
        for name, most in (("noise", MOST_NOISE), ("lose", LONGEST)):
            value = getattr(self, name)
            if not (isfinite(value) and 0.0 <= value <= most):
                raise InputError(
                    "a disturbance of the simulated Leap is out of range",
                    where=name,
                    got=value,
                    expected=f"0 to {most:g}",
                )

    def applied(self, to: LeapConfiguration) -> LeapConfiguration:
        """Returns the configuration with its noise multiplied by `noise`."""
        if self.noise == 1.0:
            return to
        return replace(to, **{name: self.noise * getattr(to, name) for name in _NOISY})


def parse_simulated(text: str) -> tuple[str, LeapDisturbance]:
    """Reads the text after `leap-simulated:`, such as `v1,noise=2,lose=1`.

    Returns:
        Dialect and disturbance.

    Raises:
        InputError: The dialect or a disturbance is unknown.
    """
    dialect, values = DIALECTS[0], {}
    known = [f.name for f in fields(LeapDisturbance)]
    for part in filter(None, text.split(",")):
        name, equals, value = part.partition("=")
        try:
            if not equals and name in DIALECTS:
                dialect = name
                continue
            if not equals or name not in known:
                raise ValueError
            values[name] = float(value)
        except ValueError:
            raise InputError(
                "no such simulated Leap",
                where="--device",
                got=f"leap-simulated:{text}",
                expected=f"leap-simulated:{{{','.join(DIALECTS)}}}, with noise=TIMES or lose=S",
            ) from None
    return dialect, LeapDisturbance(**values)


HOME_OF_TWO = 0.12
"""Distance (m) from the centre to the resting position of each of two hands."""

_CARRIED = 0.6
"""Time (s) of carrying after which `LeapDisturbance.lose` begins."""

_MIRROR = np.array([-1.0, 1.0, 1.0])


class SimulatedLeap(HandDevice):
    """A Leap over which a simulated user moves a hand.

    Args:
        task: The drawn task, for the shapes of its objects; the user does not get the task itself.
        configuration: Configuration of the simulated user.
        seed: Seed of the person and of the device's noise.
        at: (3,) m, position of the device in the world.
        dialect: `v3` or `v1`.
        person: Side and size of the drawn hand.
        hand: Index of the user's hand in the scene.
        trouble: Disturbances of the device.

    Raises:
        InputError: The user cannot hold one of the task's objects.
    """

    name = "simulated leap"
    lift = True
    takes_snapshots = True

    def __init__(
        self,
        task: Task,
        configuration: UserConfiguration,
        seed: int,
        at: tuple[float, float, float],
        dialect: str = "v3",
        person: Person | None = None,
        hand: int = 0,
        trouble: LeapDisturbance | None = None,
    ) -> None:
        self._trouble = trouble or LeapDisturbance()
        self._carried: float | None = None
        self._away = False
        person = person or Person()
        seed += hand * NEXT_PERSON
        self._hand, self._left, self._at = hand, person.left, np.array(at)
        self._shapes = {thing.name: thing for thing in task.objects}
        two = hands_of(task) > 1
        for thing in task.objects:
            check_holdable(thing)
        make = AirCarrier if two else AirPerson
        # A left hand is simulated as a mirrored right hand, with its home on the right.
        home = (HOME_OF_TWO, 0.0) if two or hand else (0.0, 0.0)
        radius = person.skeleton(ADULT).tip_radius
        self.user = make(configuration, seed, radius, home)
        self._leap = ForwardLeap(seed, person.hand, dialect, self._trouble.applied(FROZEN_LEAP))

    def show(self, snapshot: Snapshot) -> None:
        """Shows the snapshot to the user."""
        hand = snapshot.hands[self._hand]
        goals, objects = snapshot.goals, snapshot.objects
        seen = {
            name: SeenObject(self._shapes[name], o.position, o.rotation)
            for name, o in objects.items()
        }
        tips = dict(enumerate(hand.tips))
        if self._left:
            # A left hand is simulated as a mirrored right hand.
            seen = {name: _mirrored(o) for name, o in seen.items()}
            tips = {f: _MIRROR * tip for f, tip in tips.items()}
            goals = tuple(_mirrored_goal(g) for g in goals)
        done = snapshot.score.held
        self.user.observe(Sight(snapshot.time, tips, bool(hand.solid), seen, goals, done))

    def poll(self, now: float) -> Sequence[HandFrame]:
        """Returns the Leap's hand frame at the time `now`."""
        if self.finished:
            return []
        origin, rotation, joints = self.own_hand(now)
        frame, _ = self._leap.see(now, origin - self._at, rotation, joints)
        return [replace(frame, hands=()) if self._gone(now) else frame]

    def own_hand(self, now: float) -> tuple[Array, Array, Array]:
        """Returns the pose of the user's own hand at the time `now`.

        Returns:
            Palm centre (3,) m and rotation (3, 3) in the world, and joints (5, 4, 3) m in palm
            coordinates. For a left hand, the rotation matrix includes a reflection.
        """
        origin, rotation, joints = self.user.hand(now)
        if self._left:
            origin, rotation = _MIRROR * origin, _MIRROR[:, None] * rotation
        return origin, rotation, joints

    def _gone(self, now: float) -> bool:
        """True while the whole hand is out of view: once, after `_CARRIED` of carrying."""
        if self._trouble.lose <= 0.0:
            return False
        if self._carried is None:
            if not self.user.carrying:
                return False
            self._carried = now
        since = now - self._carried - _CARRIED
        gone = 0.0 <= since < self._trouble.lose
        if gone and not self._away:
            self._leap.lose()
        self._away = gone
        return gone


def _mirrored(seen: SeenObject) -> SeenObject:
    return replace(
        seen,
        position=_MIRROR * seen.position,
        rotation=_MIRROR[:, None] * seen.rotation * _MIRROR,
    )


def _mirrored_goal(goal: Goal) -> Goal:
    x, y, z = goal.position
    return replace(goal, position=(-x, y, z), yaw=-goal.yaw)


NOISE = 0.0005
"""Standard deviation (m) of the noise of every joint along every axis, independent for each frame.
The value is assumed: no headset was measured."""
_METACARPALS = (5, 10, 15, 20)


class SimulatedHeadset(SimulatedLeap):
    """A headset that reports the hand of a simulated user.

    Args:
        task: The drawn task, for the shapes of its objects; the user does not get the task itself.
        configuration: Configuration of the simulated user.
        seed: Seed of the person and of the noise.
        person: Side and size of the drawn hand.
        hand: Index of the user's hand in the scene.

    Raises:
        InputError: The user cannot hold one of the task's objects.
    """

    name = "simulated headset"

    def __init__(
        self,
        task: Task,
        configuration: UserConfiguration,
        seed: int,
        person: Person | None = None,
        hand: int = 0,
    ) -> None:
        super().__init__(task, configuration, seed, (0.0, 0.0, 0.0), person=person, hand=hand)
        self._side = (person or Person()).hand
        self._rng = np.random.default_rng([seed + hand * NEXT_PERSON, 0x4E5E])

    def joints(self, now: float) -> SeenJoints:
        """Returns the 25 joints (WebXR) of the user's hand, m in the world, with noise."""
        origin, rotation, joints = self.own_hand(now)
        places = webxr_joints(origin, rotation, joints)
        places += self._rng.normal(0.0, NOISE, places.shape)
        return SeenJoints(
            "left" if self._side == "left" else "right",
            [(float(x), float(y), float(z)) for x, y, z in places],
        )

    def poll(self, now: float) -> Sequence[HandFrame]:
        """Returns the headset's hand frame at the time `now`."""
        if self.finished:
            return []
        hand = seen_hand(self.joints(now))
        return [HandFrame(now, () if hand is None else (hand,), self.name)]


def webxr_joints(origin: Array, rotation: Array, joints: Array) -> Array:
    """Returns WebXR's joints (25, 3) of a hand, m in the world.

    Args:
        origin: (3,) m, centre of the palm.
        rotation: (3, 3) world from palm; with a reflection for a left hand.
        joints: (5, 4, 3) m in palm coordinates. The thumb has no IP joint: its third joint is
            replaced by the midpoint between the second joint and the tip.
    """
    own = joints.copy()
    own[0, 2] = 0.5 * (own[0, 1] + own[0, 3])
    places = np.zeros((JOINTS_OF_A_HAND, 3))
    places[0] = -np.array(PALM_CENTRE)
    for finger, indices in enumerate(FINGER_JOINTS):
        places[list(indices)] = own[finger]
    for metacarpal in _METACARPALS:
        places[metacarpal] = 0.5 * (places[0] + places[metacarpal + 1])
    return origin + small_product(places, rotation.T)
