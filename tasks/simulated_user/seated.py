"""Simulated users who are left-handed, or sit at another side of the screen.

Such a user is a right-handed one at the lower edge, who sees the world mirrored or rotated and
whose touches are transformed back. The delay of what they see is unchanged.
"""

from __future__ import annotations

from dataclasses import replace
from math import atan2, cos, sin

import numpy as np

from models.arithmetic.arrays import Array
from models.arithmetic.products import small_product
from models.frames import TouchFrame
from models.mjcf_object import MjcfObject
from models.objects import Wrench
from models.person import Person, PersonFrame
from models.surface import Surface
from tasks.user import Sight, User


class Seat:
    """Transforms between the world and the world that a right-handed user at the lower edge sees.

    Args:
        person: Hand and seat; the hand's size has no effect here.
        surface: The screen.

    Attributes:
        surface: The screen in that user's world: rotated about its own middle.
    """

    def __init__(self, person: Person, surface: Surface) -> None:
        self._frame = PersonFrame(replace(person, hand_size=1.0), surface)
        self._real = surface
        middle = surface.to_world(surface.size / 2)
        turned = replace(self._frame.surface, rotation=surface.rotation)
        self.surface = turned.centred_at(middle)
        flip = np.diag([1.0, -1.0])
        matrix = np.eye(3)
        matrix[:2, :2] = small_product(small_product(flip, self._frame.matrix), flip)
        self._matrix: Array = small_product(
            small_product(surface.rotation, matrix), surface.rotation.T
        )
        # Objects in a mirror image have one of their own axes reversed, so that rotations stay
        # proper.
        flip_own = -1.0 if person.left else 1.0
        self._mirrors = person.left
        self._own = np.diag([flip_own, 1.0, 1.0])
        self._own_of_long = np.diag([1.0, flip_own, 1.0])

    def point(self, world: Array) -> Array:
        """Transforms a position (3,) m to the user's world."""
        height = float(
            small_product(world - np.asarray(self._real.origin), self._real.rotation[:, 2])
        )
        return self.surface.to_world(self._frame.inwards(self._real.to_surface(world)), height)

    def rotation(self, world: Array, long: bool = False) -> Array:
        """Transforms a rotation (3, 3) to the user's world.

        Args:
            world: The rotation in the world.
            long: True for an object whose two ends differ, such as a wrench: only its sides may be
                swapped.
        """
        return small_product(
            small_product(self._matrix, world), self._own_of_long if long else self._own
        )

    def yaw(self, yaw: float, long: bool = False) -> float:
        """Transforms a yaw, rad about the vertical, to the user's world."""
        c, s = cos(yaw), sin(yaw)
        seen = self.rotation(np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]]), long)
        return atan2(seen[1, 0], seen[0, 0])

    def sight(self, sight: Sight) -> Sight:
        """Transforms everything on the screen to the user's world."""
        long = {n: isinstance(o.shape, Wrench | MjcfObject) for n, o in sight.objects.items()}
        objects = {
            name: replace(
                o,
                position=self.point(o.position),
                rotation=self.rotation(o.rotation, long[name]),
                mirrored=self._mirrors and isinstance(o.shape, MjcfObject),
            )
            for name, o in sight.objects.items()
        }
        goals = []
        for goal in sight.goals:
            x, y, z = self.point(np.asarray(goal.position)).tolist()
            yaw = self.yaw(goal.yaw, long[goal.object])
            goals.append(replace(goal, position=(x, y, z), yaw=yaw))
        tips = {i: self.point(tip) for i, tip in sight.tips.items()}
        return replace(sight, tips=tips, objects=objects, goals=tuple(goals))

    def frame(self, frame: TouchFrame) -> TouchFrame:
        """Transforms the user's touches to the real screen."""
        contacts = []
        for contact in frame.contacts:
            x, y = self._frame.outwards((contact.x, contact.y)).tolist()
            contacts.append(replace(contact, x=x, y=y))
        return replace(frame, contacts=tuple(contacts))


class SeatedUser:
    """A simulated user on another seat or with the other hand.

    Args:
        user: A user made for `seat.surface`.
        seat: The user's hand and seat.
    """

    def __init__(self, user: User, seat: Seat) -> None:
        self.user, self._seat = user, seat

    def look(self, sight: Sight) -> None:
        """Shows the user the current content of the screen."""
        seat = (
            self._seat
        )  # Without references to this user: a user that stores its sights would keep itself alive.
        self.user.look(Sight.deferred(lambda: vars(seat.sight(sight)), time=sight.time))

    def touch(self, now: float) -> TouchFrame:
        """Current touches on the real screen."""
        return self._seat.frame(self.user.touch(now))
