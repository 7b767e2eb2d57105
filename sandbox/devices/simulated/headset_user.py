"""The simulated user in the air as a headset would see them: 25 joints, with a little noise."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from encoders.paalm.hand_pose import PALM_CENTRE
from models.arithmetic.arrays import Array
from models.arithmetic.products import small_product
from models.frames import HandFrame
from models.person import Person
from sandbox.devices.simulated import NEXT_PERSON
from sandbox.devices.simulated.leap_user import SimulatedLeap
from sandbox.devices.webxr.joints import FINGER_JOINTS, seen_hand
from sandbox.server.protocol import JOINTS_OF_A_HAND, SeenJoints
from tasks.task import Task
from tasks.user import UserConfiguration

NOISE = 0.0005
"""m, standard deviation of every joint along every axis, from frame to frame. Assumed: no headset
was measured."""
_METACARPALS = (5, 10, 15, 20)


class SimulatedHeadset(SimulatedLeap):
    """A headset that sees the hand of a simulated user.

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
        """WebXR's 25 joints of the own hand in the world, m, as the headset sees them now."""
        origin, rotation, joints = self.own_hand(now)
        places = webxr_joints(origin, rotation, joints)
        places += self._rng.normal(0.0, NOISE, places.shape)
        return SeenJoints(
            "left" if self._side == "left" else "right",
            [(float(x), float(y), float(z)) for x, y, z in places],
        )

    def poll(self, now: float) -> Sequence[HandFrame]:
        """The hand frame that the headset sees now."""
        if self.finished:
            return []
        hand = seen_hand(self.joints(now))
        return [HandFrame(now, () if hand is None else (hand,), self.name)]


def webxr_joints(origin: Array, rotation: Array, joints: Array) -> Array:
    """(25, 3) m in the world, WebXR's joints of a hand.

    Args:
        origin: (3,) m, centre of the palm.
        rotation: (3, 3) world from palm; a reflection for a left hand.
        joints: (5, 4, 3) m in the palm; a thumb without an IP joint has its tip twice.
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
