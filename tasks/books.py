"""Push a box farther in between two standing books, with the wrist turned.

The simulated user holds the box and slides it along, with a hand that points in the direction of
movement.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import atan2, cos, pi, radians, sin
from typing import ClassVar

import numpy as np

from models.arithmetic import Array, distance, length
from models.errors import SurfaceTooSmallError
from models.message import Message
from models.objects import Box
from models.surface import Surface, inside
from tasks.box_to_goal import BORDER, POSITION_TOLERANCE, missing
from tasks.sensing import Sensing
from tasks.simulated_user.grasp import Grasp, grasp_across, wrapped
from tasks.simulated_user.handling import BoxHandling
from tasks.simulated_user.user import SkilledUser
from tasks.simulated_user.user_hand import Hand
from tasks.task import Goal, Measure, TaskDefaults
from tasks.user import SeenObject, Sight, UserConfiguration, UserMaker

POINTS = pi / 4
"""Angle (rad) from the line from thumb to fingers, across a box, to the direction in which the hand
points. The median of eleven simulated people with thumb, index and middle finger on a screen is 42
degrees."""
_STEP = 0.030
"""Distance (m) by which the user slides a box before the next look."""


class PointingHandling(BoxHandling):
    """Handling of a box by a hand that points in the direction of movement, as far as possible.

    The box is grasped across the two faces for which the hand's direction is nearest to the
    direction of movement.

    Attributes:
        way: Direction (rad) from start to goal; None until the user has seen both.
    """

    way: float | None = None

    def grasp(
        self, seen: SeenObject, turn: float, hand: Hand, failed: Grasp | None = None
    ) -> Grasp:
        """Grasp with a hand that points in the direction of movement."""
        assert isinstance(seen.shape, Box) and self.way is not None
        half = seen.shape.half_size
        wanted = self.way - POINTS
        quarter = min(range(4), key=lambda q: abs(wrapped(seen.yaw + q * pi / 2 - wanted)))
        axis = seen.yaw + quarter * pi / 2
        width, face = (half[0], half[1]) if quarter % 2 == 0 else (half[1], half[0])
        return replace(grasp_across(axis, 2 * width, 2 * face, hand), skew=0.0)


class BooksUser(SkilledUser):
    """Slides a box to its goal in short steps, with a look after each.

    Args:
        configuration: Settings of the simulated user.
        surface: The tablet.
        seed: Seed of the user's randomness.
    """

    drags = 12

    def __init__(self, configuration: UserConfiguration, surface: Surface, seed: int) -> None:
        super().__init__(configuration, surface, seed)
        self._pointing = PointingHandling()
        self._handling = self._pointing

    def _act(self, sight: Sight, now: float) -> None:
        if self._pointing.way is None:
            (goal,) = sight.goals
            x, y = (np.array(goal.position) - sight.objects[goal.object].position)[:2].tolist()
            self._pointing.way = atan2(y, x)
        super()._act(sight, now)

    def _leg(self, sight: Sight, box: SeenObject, off: Array, turn: float) -> tuple[Array, float]:
        """Shift (2,) m and turn (rad) of the next step along a straight way."""
        return off * min(1.0, _STEP / max(length(off), 1e-9)), turn


EDGE = 0.040
"""Edge (m) of the box, equal to the smallest box of the stacking tasks."""
MASS = (0.050, 0.150)
"""Range of the box's mass (kg)."""

BOOK = (0.110, 0.020, 0.178)
"""Length, thickness and height (m) of a standing paperback of 350 pages; 110 x 178 mm is a usual
format. The book falls when it is tilted sideways by 6 degrees."""
BOOK_MASS = 0.200
"""Mass (kg) of a book."""
COLOURS = ((0.34, 0.71, 0.91), (0.90, 0.62, 0.0))
"""Colours of the books."""

GAP = 0.100
"""Gap (m) between the books; a hand with its thumb is about as wide."""
BEHIND = 0.100
"""Distance (m) from the goal back to the near ends of the books, so that the palm starts outside
the gap."""
WAY = 0.060
"""Distance (m) from start to goal."""
ASKEW = pi / 4
"""Angle (rad) between the way and the box's faces."""
TO_THE_LEFT = (radians(60.0), radians(75.0))
"""Range of the angle (rad) between the direction away from the person and the direction of the gap.
A right hand that points along the gap is turned to the left by 30 to 45 degrees from its most
comfortable direction."""

MOVED = POSITION_TOLERANCE
"""Largest distance (m) by which a book may be moved."""

_TRIES = 20_000
"""Number of draws after which a surface is reported as too small."""


@dataclass(frozen=True)
class Books(TaskDefaults):
    """Push a box farther in between two standing books, without pushing one away.

    Scene: two paperbacks stand on the table with a gap of 10 cm. A box of 4 cm, 50 to 150 g, stands
    4 cm inside of the gap. The friction coefficient against the table is 0.5.
    Goal: the box's ghost, 6 cm farther in.
    Success: the box is at its goal as in `box-to-goal`: centre within 1 cm, yaw within 10 degrees
    of the nearest equivalent, tilt under 5 degrees, on the table, slower than 1 cm/s and touched by
    no hand, all for 0.5 s without a break, within 30 s. The trial is lost once the middle of a book
    is more than 1 cm from its start, which includes a book that falls.
    Start: the place is uniform. The gap leads away from the person and is turned to the left by 60
    to 75 degrees, uniform, so that a right hand has to turn its wrist. All are redrawn until start
    and goal are at least 42 mm from the border, and the middles of the books are on the surface.
    The box's faces are at 45 degrees to the direction of the gap, so that a hand that holds two of
    them points into the gap.
    History: version 1.
    """

    name: ClassVar[str] = "books"
    version: ClassVar[int] = 1
    time_limit: ClassVar[float] = 30.0
    hold_time: ClassVar[float] = 0.5
    table_friction: ClassVar[float] = 0.5
    touch_height: ClassVar[float] = 0.022
    lift_range: ClassVar[float] = 0.0
    plane: ClassVar[str] = "table"
    user: ClassVar[UserMaker | None] = BooksUser

    seed: int
    objects: tuple[Box, ...]
    goals: tuple[Goal, ...]

    @classmethod
    def draw(cls, seed: int, surface: Surface) -> Books:
        """Draws the trial of a seed; the same seed and surface give the same trial.

        Raises:
            SurfaceTooSmallError: The surface has no room for the books and the way between them.
        """
        rng = np.random.default_rng([seed, cls.version, 47])
        size = surface.size
        for _ in range(_TRIES):
            goal = rng.uniform((0.0, 0.0), size)
            angle = pi / 2 + float(rng.uniform(*TO_THE_LEFT))
            # On the surface, y points towards the person.
            way = np.array([cos(angle), -sin(angle)])
            across = np.array([-way[1], way[0]])
            start = goal - WAY * way
            books = [
                goal + (BOOK[0] / 2 - BEHIND) * way + side * (GAP + BOOK[1]) / 2 * across
                for side in (1.0, -1.0)
            ]
            if inside(np.stack([start, goal]), BORDER, size) and inside(np.stack(books), 0.0, size):
                break
        else:
            raise SurfaceTooSmallError(
                cls.name, (surface.width_in, surface.height_in), "two books", (7.8, 5.9)
            )
        mass = float(rng.uniform(*MASS))
        places = surface.to_world(np.stack([start, goal, *books]))[:, :2].tolist()
        half, yaw = EDGE / 2, angle - ASKEW
        box = Box("box", (half, half, half), mass, (*places[0], half), yaw)
        length_, thickness, height = (edge / 2 for edge in BOOK)
        standing = tuple(
            Box(
                f"book{i + 1}",
                (length_, thickness, height),
                BOOK_MASS,
                (*place, height),
                angle,
                colour,
            )
            for i, (place, colour) in enumerate(zip(places[2:], COLOURS, strict=True))
        )
        return cls(seed, (box, *standing), (Goal("box", (*places[1], half), yaw),))

    def shifted(self) -> tuple[str, ...]:
        """Only the box; the books stay where they are."""
        return ("box",)

    def with_room(self, factor: float) -> Books:
        """The same trial with the gap between the books multiplied by a factor."""
        one, other = (np.array(book.position) for book in self.objects[1:])
        middle, wider = (one + other) / 2, (factor * GAP + BOOK[1]) / (GAP + BOOK[1])
        books = [
            replace(book, position=tuple((middle + wider * (place - middle)).tolist()))
            for book, place in zip(self.objects[1:], (one, other), strict=True)
        ]
        return replace(self, objects=(self.objects[0], *books))

    def measure(self, sensing: Sensing) -> Measure:
        """Tests whether the box is at its goal now, and no book has been moved."""
        box, goal = sensing.object("box"), self.goals[0]
        moved = max(
            length(sensing.object(book.name).position - np.array(book.position))
            for book in self.objects[1:]
        )
        lost = moved > MOVED
        reason: str = missing(box, goal)
        if lost:
            reason = Message("book_moved", "a book has been moved")
        off = distance(box.position.tolist(), goal.position)
        travelled = 1.0 - max(off - POSITION_TOLERANCE, 0.0) / (WAY - POSITION_TOLERANCE)
        progress = 1.0 if not reason else min(max(travelled, 0.0), 0.99)
        return Measure(not reason, progress, reason, lost)
