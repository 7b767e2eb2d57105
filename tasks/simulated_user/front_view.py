"""Lets simulated users play on an upright surface, seen from the front.

The world is rotated so that the upright screen lies flat like a table: right stays right, up the
screen becomes "away", and out of the screen becomes "up". So a user made for the table plays here
as well. Only gravity pulls down the screen, which users of this view have to know. A person does
not see depth: users get it rotated like everything else, and none of them uses it.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from models.arithmetic.arrays import Array
from models.arithmetic.products import small_product
from models.frames import TouchFrame
from models.surface import Surface
from tasks.user import Sight, User


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

    def look(self, sight: Sight) -> None:
        """Shows the user the current content of the screen."""
        view = (
            self._view
        )  # Without references to this user: a user that stores its sights would keep itself alive.
        self.user.look(Sight.deferred(lambda: vars(view.sight(sight)), time=sight.time))

    def touch(self, now: float) -> TouchFrame:
        """Current touches, in the surface's own frame in any orientation."""
        return self.user.touch(now)
