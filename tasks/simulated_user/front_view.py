"""A simulated user who looks at an upright surface from the front.

To such a person the screen is what a table is to one who looks down on it: right is right, up the
screen is "away", and what comes out of the screen is "up". So the user of the table plays here as
well, in a world that is turned for them; only gravity pulls down the screen, which users of this
view have to know. Depth is what they do not see: they get it turned like all else, and none of
them makes use of it.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from models.frames import TouchFrame
from models.surface import Surface
from tasks.user import Sight, User

Array = NDArray[np.float64]


class FrontView:
    """Between the world and the one in which the screen lies flat.

    Args:
        surface: The screen, however it stands.

    Attributes:
        surface: The same, lying flat: x right, y up the screen, z out of it.
    """

    def __init__(self, surface: Surface) -> None:
        self._turn: Array = surface.rotation.T
        x, y, z = (self._turn @ np.asarray(surface.origin)).tolist()
        self.surface = replace(surface, origin=(x, y, z), rotation=np.eye(3))

    def point(self, world: Array) -> Array:
        """A place (3,) m as it is seen on the screen."""
        return np.asarray(self._turn @ world)

    def sight(self, sight: Sight) -> Sight:
        """All that is on the screen.

        Goals keep the turn that they have: it is about the vertical, which nobody sees from here.
        """
        objects = {
            name: replace(o, position=self.point(o.position), rotation=self._turn @ o.rotation)
            for name, o in sight.objects.items()
        }
        goals = []
        for goal in sight.goals:
            x, y, z = self.point(np.asarray(goal.position)).tolist()
            goals.append(replace(goal, position=(x, y, z)))
        tips = {i: self.point(tip) for i, tip in sight.tips.items()}
        return replace(sight, tips=tips, objects=objects, goals=tuple(goals))


class FrontUser:
    """Any simulated user, before an upright surface.

    Args:
        user: Who was made for `view.surface`.
        view: What they see.
    """

    def __init__(self, user: User, view: FrontView) -> None:
        self.user, self._view = user, view
        self.configuration = user.configuration

    def look(self, sight: Sight) -> None:
        """Takes in what is on the screen now."""
        view = self._view  # Who keeps what they see would keep themselves, were they in it.
        self.user.look(Sight.later(lambda: vars(view.sight(sight)), time=sight.time))

    def touch(self, now: float) -> TouchFrame:
        """What the fingers do now; touches are the surface's own, however it stands."""
        return self.user.touch(now)
