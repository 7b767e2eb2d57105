"""A simulated user who is left-handed, or sits at another side of the screen.

Such a person is the right-handed one at the lower edge who sees the world mirrored or turned, and
whose touches go the same way back. What is seen is the same, and no less late.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from models.frames import TouchFrame
from models.mjcf_thing import MjcfThing
from models.objects import Wrench
from models.person import Person, PersonFrame
from models.surface import Surface
from tasks.user import Sight, User

Array = NDArray[np.float64]


class Seat:
    """Between the world and the one that a right-handed user at the lower edge would see.

    Args:
        person: Hand and seat; their hand's size makes no difference to what they see.
        surface: The screen.

    Attributes:
        surface: The screen as that user finds it: turned about its own middle.
    """

    def __init__(self, person: Person, surface: Surface) -> None:
        self._frame = PersonFrame(replace(person, hand_size=1.0), surface)
        self._real = surface
        middle = surface.to_world(surface.size / 2)
        turned = replace(self._frame.surface, rotation=surface.rotation)
        self.surface = turned.centred_at(middle)
        flip = np.diag([1.0, -1.0])
        matrix = np.eye(3)
        matrix[:2, :2] = flip @ self._frame.matrix @ flip
        self._matrix: Array = surface.rotation @ matrix @ surface.rotation.T
        # Mirrored things are drawn mirrored: one of their own axes turns round; all stay solids.
        flip_own = -1.0 if person.left else 1.0
        self._own = np.diag([flip_own, 1.0, 1.0])
        self._own_of_long = np.diag([1.0, flip_own, 1.0])

    def point(self, world: Array) -> Array:
        """A place (3,) m as that user sees it."""
        height = float((world - np.asarray(self._real.origin)) @ self._real.rotation[:, 2])
        return self.surface.to_world(self._frame.inwards(self._real.to_surface(world)), height)

    def rotation(self, world: Array, long: bool = False) -> Array:
        """A rotation (3, 3) as that user sees it.

        Args:
            world: As it is.
            long: Of a thing whose two ends differ, such as a wrench: only its sides may change.
        """
        return self._matrix @ world @ (self._own_of_long if long else self._own)

    def yaw(self, yaw: float, long: bool = False) -> float:
        """rad about the vertical, as that user sees it."""
        c, s = np.cos(yaw), np.sin(yaw)
        seen = self.rotation(np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]]), long)
        return float(np.arctan2(seen[1, 0], seen[0, 0]))

    def sight(self, sight: Sight) -> Sight:
        """All that is on the screen."""
        long = {n: isinstance(o.shape, Wrench | MjcfThing) for n, o in sight.objects.items()}
        objects = {
            name: replace(
                o, position=self.point(o.position), rotation=self.rotation(o.rotation, long[name])
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
        """That user's touches as the real screen feels them."""
        contacts = []
        for contact in frame.contacts:
            x, y = self._frame.outwards((contact.x, contact.y)).tolist()
            contacts.append(replace(contact, x=x, y=y))
        return replace(frame, contacts=tuple(contacts))


class SeatedUser:
    """Any simulated user, on another seat or with the other hand.

    Args:
        user: Who was made for `seat.surface`.
        seat: From where they look.
    """

    def __init__(self, user: User, seat: Seat) -> None:
        self.user, self._seat = user, seat
        self.configuration = user.configuration

    def look(self, sight: Sight) -> None:
        """Takes in what is on the screen now."""
        seat = self._seat  # Who keeps what they see would keep themselves, were they in it.
        self.user.look(Sight.later(lambda: vars(seat.sight(sight)), time=sight.time))

    def touch(self, now: float) -> TouchFrame:
        """What the fingers do on the real screen now."""
        return self._seat.frame(self.user.touch(now))
