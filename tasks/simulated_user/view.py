"""How simulated users see: with a reaction delay, from the front, or from another seat.

For an upright surface the world is rotated so that the screen lies flat like a table. Right stays
right, up the screen becomes "away", and out of the screen becomes "up". A user written for the
table can therefore play on an upright surface as well, but has to know that gravity pulls down the
screen. A person does not see depth. Users get the depth, rotated like everything else, but do not
use it.

A user who is left-handed, or sits at another side of the screen, is simulated by a right-handed
user at the lower edge, who sees the world mirrored or rotated and whose touches are transformed
back. The reaction delay is the same.
"""

from __future__ import annotations

from collections import deque
from dataclasses import replace
from functools import partial
from math import atan2, cos, sin

import numpy as np

from models.arithmetic import Array, small_product
from models.frames import TouchFrame
from models.objects import Wrench
from models.person import Person, PersonFrame
from models.surface import Surface
from tasks.user import LateSight, Sight, User


class Eye:
    """Delays the content of the screen by the reaction time.

    Args:
        delay: Time (s) between a change on the screen and the user's reaction.
    """

    def __init__(self, delay: float) -> None:
        self.delay = delay
        self._seen: deque[Sight] = deque()

    def observe(self, sight: Sight) -> None:
        """Stores the current content of the screen."""
        self._seen.append(sight)

    def at(self, now: float) -> Sight | None:
        """The newest sight that is old enough for a reaction; None if there is none yet."""
        while len(self._seen) > 1 and self._seen[1].time <= now - self.delay + 1e-9:
            self._seen.popleft()
        if self._seen and self._seen[0].time <= now - self.delay + 1e-9:
            return self._seen[0]
        return None


class FrontView:
    """Transforms between the world and the rotated world in which the screen lies flat.

    Args:
        surface: The screen in any orientation.

    Attributes:
        surface: The same screen, lying flat: x right, y up the screen, z out of it.
    """

    def __init__(self, surface: Surface) -> None:
        self._turn: Array = surface.rotation.T
        x, y, z = small_product(self._turn, np.asarray(surface.origin)).tolist()
        self.surface = replace(surface, origin=(x, y, z), rotation=np.eye(3))

    def point(self, world: Array) -> Array:
        """Transforms a position (3,) m to the view."""
        return np.asarray(small_product(self._turn, world))

    def sight(self, sight: Sight) -> Sight:
        """Transforms everything on the screen to the view.

        Goals keep their yaw, which is about the vertical and invisible from the front.
        """
        objects = {
            name: replace(
                o, position=self.point(o.position), rotation=small_product(self._turn, o.rotation)
            )
            for name, o in sight.objects.items()
        }
        goals = []
        for goal in sight.goals:
            x, y, z = self.point(np.asarray(goal.position)).tolist()
            goals.append(replace(goal, position=(x, y, z)))
        tips = {i: self.point(tip) for i, tip in sight.tips.items()}
        return replace(sight, tips=tips, objects=objects, goals=tuple(goals))


class FrontUser:
    """A simulated user in front of an upright surface.

    Args:
        user: A user made for `view.surface`.
        view: The user's view.
    """

    def __init__(self, user: User, view: FrontView) -> None:
        self.user, self._view = user, view

    def observe(self, sight: Sight) -> None:
        """Shows the user the current content of the screen."""
        self.user.observe(LateSight.of(sight.time, partial(self._view.sight, sight)))

    def touch(self, now: float) -> TouchFrame:
        """Current touches, in the surface's own frame in any orientation."""
        return self.user.touch(now)


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
        # In a mirror image, one of the object's own axes is reversed as well, so that the rotation
        # remains a proper rotation.
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
            long: True for an object whose two ends differ, such as a wrench. Only its sides may be
                swapped then.
        """
        return small_product(
            small_product(self._matrix, world), self._own_of_long if long else self._own
        )

    def yaw(self, yaw: float, long: bool = False) -> float:
        """Transforms a yaw (rad about the vertical) to the user's world."""
        c, s = cos(yaw), sin(yaw)
        seen = self.rotation(np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]]), long)
        return atan2(seen[1, 0], seen[0, 0])

    def sight(self, sight: Sight) -> Sight:
        """Transforms everything on the screen to the user's world."""
        # Imported here because most users need no transformation.
        from models.mjcf_object import MjcfObject

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
    """A simulated user who sits at another side of the screen, or plays with the left hand.

    Args:
        user: A user made for `seat.surface`.
        seat: The user's hand and seat.
    """

    def __init__(self, user: User, seat: Seat) -> None:
        self.user, self._seat = user, seat

    def observe(self, sight: Sight) -> None:
        """Shows the user the current content of the screen."""
        self.user.observe(LateSight.of(sight.time, partial(self._seat.sight, sight)))

    def touch(self, now: float) -> TouchFrame:
        """Current touches on the real screen."""
        return self._seat.frame(self.user.touch(now))
