"""The simulated user in the air as a device: sees snapshots, moves a hand over a simulated Leap."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from encoders.paalm.simulated.forward import ForwardLeap
from encoders.paalm.simulated.leap_configuration import FROZEN_LEAP
from models.arithmetic.arrays import Array
from models.frames import HandFrame
from models.person import Person
from models.skeleton import ADULT
from sandbox.devices.device import HandDevice
from sandbox.devices.simulated import NEXT_PERSON
from sandbox.devices.simulated.air_user.carrier import AirCarrier
from sandbox.devices.simulated.air_user.holds import check_holdable
from sandbox.devices.simulated.air_user.patient import PATIENT, PatientPerson
from sandbox.devices.simulated.air_user.person import AirHabits, AirPerson
from sandbox.devices.simulated.leap_disturbance import LeapDisturbance
from sandbox.session.messages import Snapshot
from tasks.registry import hands_of
from tasks.task import Goal, Task
from tasks.user import SeenObject, Sight, UserConfiguration

HOME_OF_TWO = 0.12
"""m from the centre, resting position of each of two hands."""

_CARRIED = 0.6
"""s of carrying after which `LeapDisturbance.lose` begins."""

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
        habits: Parameters of the user's way of working.
        patient: The user works as `PatientPerson` does, by default with the habits `PATIENT`; for
            tasks of one hand.
        trouble: Disturbances of the device.

    Raises:
        InputError: The user cannot hold one of the task's objects.
    """

    name = "simulated leap"
    lift = True
    wants_snapshots = True

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
        trouble: LeapDisturbance | None = None,
        patient: bool = False,
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
        make = AirCarrier if two else PatientPerson if patient else AirPerson
        # A left hand is simulated as a mirrored right one, with its home on the right.
        home = (HOME_OF_TWO, 0.0) if two or hand else (0.0, 0.0)
        radius = person.skeleton(ADULT).tip_radius
        if patient:
            habits = habits or PATIENT
        self.user = make(configuration, seed, radius, habits, home)
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
        self.user.look(Sight(snapshot.time, tips, bool(hand.solid), seen, goals, done))

    def poll(self, now: float) -> Sequence[HandFrame]:
        """The hand frame that the device sees now."""
        if self.finished:
            return []
        origin, rotation, joints = self.own_hand(now)
        frame, _ = self._leap.see(now, origin - self._at, rotation, joints)
        return [replace(frame, hands=()) if self._gone(now) else frame]

    def own_hand(self, now: float) -> tuple[Array, Array, Array]:
        """Palm centre (3,) m and rotation (3, 3) in the world, and joints (5, 4, 3) m in the palm,
        of the user's own hand now; the rotation of a left hand is a reflection."""
        origin, rotation, joints = self.user.hand(now)
        if self._left:
            origin, rotation = _MIRROR * origin, _MIRROR[:, None] * rotation
        return origin, rotation, joints

    def _gone(self, now: float) -> bool:
        """True while the whole hand is out of view: once, after a moment of carrying."""
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
