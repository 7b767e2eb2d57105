"""The simulated user in the air as a device: sees snapshots, moves over a simulated Leap."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from encoders.paalm.simulated.eye import LeapEye
from encoders.paalm.simulated.forward import FROZEN_LEAP
from models.frames import HandFrame
from models.person import Person
from models.skeleton import ADULT
from sandbox.devices.simulated.air_user.carrier import AirCarrier
from sandbox.devices.simulated.air_user.holds import check
from sandbox.devices.simulated.air_user.person import AirHabits, AirPerson
from sandbox.devices.simulated.leap_trouble import LeapTrouble
from sandbox.devices.simulated.simulated import NEXT_PERSON
from sandbox.session.device import HandDevice
from sandbox.session.messages import Snapshot
from tasks.registry import hands_of
from tasks.task import Goal, Task
from tasks.user import SeenObject, Sight, UserConfiguration

HOME_OF_TWO = 0.12
"""m from the middle, where each of two hands is at home."""

_CARRIED = 0.6
"""s of carrying after which a hand that is to be lost is lost."""

_MIRROR = np.array([-1.0, 1.0, 1.0])


class SimulatedLeap(HandDevice):
    """A Leap over which a simulated user moves a hand.

    Args:
        task: For the shapes of what is drawn; the user never gets the task itself.
        configuration: What kind of person.
        seed: Of the person and of the device's noise.
        at: m, where the device is in the world.
        dialect: `v3` or `v1`.
        person: Which hand, and how large the drawn one is.
        hand: Which of the scene's hands is theirs.
        habits: How they work.
        trouble: What else goes wrong.

    Raises:
        InputError: They do not know how to hold the task's things.
    """

    name = "simulated leap"
    has_lift = True
    looks = True
    finished = False

    def __init__(
        self,
        task: Task,
        configuration: UserConfiguration,
        seed: int,
        at: tuple[float, float, float],
        dialect: str = "v3",
        person: Person | None = None,
        hand: int = 0,
        habits: AirHabits | None = None,
        trouble: LeapTrouble | None = None,
    ) -> None:
        self._trouble = trouble or LeapTrouble()
        self._carried: float | None = None
        self._away = False
        person = person or Person()
        seed += hand * NEXT_PERSON
        self._hand, self._left, self._at = hand, person.left, np.array(at)
        self._shapes = {thing.name: thing for thing in task.objects}
        two = hands_of(task) > 1
        for thing in task.objects:
            check(thing)
        make = AirCarrier if two else AirPerson
        # In the mirror in which a left hand is a right one, its home is to the right, too.
        home = (HOME_OF_TWO, 0.0) if two or hand else (0.0, 0.0)
        radius = person.skeleton(ADULT).tip_radius
        self.user = make(configuration, seed, radius, habits, home)
        self._eye = LeapEye(seed, person.hand, dialect, self._trouble.applied(FROZEN_LEAP))

    def show(self, snapshot: Snapshot) -> None:
        """Lets the user look at the screen."""
        hand = snapshot.hands[self._hand]
        goals, objects = snapshot.goals, snapshot.objects
        seen = {
            name: SeenObject(self._shapes[name], o.position, o.rotation)
            for name, o in objects.items()
        }
        tips = dict(enumerate(hand.tips))
        if self._left:
            # What a left hand does is what a right one would do in a mirror.
            seen = {name: _mirrored(o) for name, o in seen.items()}
            tips = {f: _MIRROR * tip for f, tip in tips.items()}
            goals = tuple(_mirrored_goal(g) for g in goals)
        done = snapshot.score.held
        self.user.look(Sight(snapshot.time, tips, bool(hand.solid), seen, goals, done))

    def poll(self, now: float) -> Sequence[HandFrame]:
        """What the device sees of the hand now."""
        if self.finished:
            return []
        origin, rotation, joints = self.user.hand(now)
        if self._left:
            origin, rotation = _MIRROR * origin, _MIRROR[:, None] * rotation
        frame = self._eye.see(now, origin - self._at, rotation, joints)
        return [replace(frame, hands=()) if self._gone(now) else frame]

    def _gone(self, now: float) -> bool:
        """Whether the whole hand is out of view now: once, after a moment of carrying."""
        if self._trouble.lose <= 0.0:
            return False
        if self._carried is None:
            if not self.user.carrying:
                return False
            self._carried = now
        since = now - self._carried - _CARRIED
        gone = 0.0 <= since < self._trouble.lose
        if gone and not self._away:
            self._eye.lose()
        self._away = gone
        return gone

    def close(self) -> None:
        """The user leaves."""
        self.finished = True


def _mirrored(seen: SeenObject) -> SeenObject:
    return replace(
        seen,
        position=_MIRROR * seen.position,
        rotation=_MIRROR[:, None] * seen.rotation * _MIRROR,
    )


def _mirrored_goal(goal: Goal) -> Goal:
    x, y, z = goal.position
    return replace(goal, position=(-x, y, z), yaw=-goal.yaw)
